"""New designs: with a follower of a kind, an empty linkage drawing, or a linkage of another program."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QPixmap
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDialog,
    QFormLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QPlainTextEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from core.bounds import PROGRAM_BYTES
from core.design import (
    Design,
    Drive,
    LinkageLoads,
    Motion,
    NamedCurve,
    Segment,
    all_paths,
    edited,
    faults,
    stroke,
    with_assumed,
    with_drive,
    with_stroke,
)
from core.design.follower_kinds import KIND_LABELS
from core.design.followers import Roller
from core.errors import KindynaError
from core.findings import ERROR
from core.linkage_programs import LinkageImport, read_linkage
from core.linkage_programs.design import UNITS, decoded
from core.mechanism.drawing_edits import empty_linkage
from core.mechanism.unfinished import mobility
from core.project import load
from core.requests import command_words
from core.stress import is_line_contact
from core.study import Study, findings_of
from kindyna_gui import dialogs
from kindyna_gui.documents.texts import add_copy_of_line, command_text
from kindyna_gui.labels import sentence
from kindyna_gui.look import MessageLabel, bold_label, coloured
from kindyna_gui.pictures.painter import thumbnail
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.places import example
from kindyna_gui.rebuilt import connect_all, fill

NEW_LAW = "modified-sine"  # of the rise and the return of a new design
FIRST_OF_KIND: Mapping[str, str] = MappingProxyType(
    {
        "cam-slider": "transfer_lift",
        "translating": "card_picker",
        "oscillating": "rocker_cam",
        "rocker": "finger_follower",
        "pushrod": "pushrod_train",
        "barrel": "barrel_feeder",
        "globoidal": "globoidal_indexer",
    }
)
"""Kind of follower, or of cam in space -> the example with the lengths, stroke and loads of a new design."""
DISTANCE = "follower.second.distance_mm"
OWN_LENGTHS: Mapping[str, float] = MappingProxyType({DISTANCE: 150.0})
"""Path -> value [mm] in new designs that have it; with the default of an edit both cams of a symmetric motion would be equal."""
SAMPLES = 180  # of a turn, to check a motion with a mechanism
TITLE, FILES = "Import linkage", "Linkages (*.linkage2 *.pyslvs *.txt);;All files (*)"
PICTURE, MOST_SHOWN = QSize(380, 270), 12

# -- new designs -----------------------------------------------------------------------------------------


def beginning(kind: str, changes: Mapping[str, str] = MappingProxyType({}), name: str = "") -> Design:
    """Return a design of this kind with a complete motion; ``changes`` of face and form: path -> word.

    An indexer keeps the motion of its example, which advances.
    """
    label = KIND_LABELS[kind]
    design: Design = load(example(FIRST_OF_KIND[kind]))
    assumed = tuple(path for path in design.assumed if not path.startswith("motion."))
    design = replace(design, name=name or f"New {label[:1].lower()}{label[1:]}", assumed=assumed)
    assert design.drive.motion is not None
    if not design.drive.motion.gain:
        design = with_drive(design, motion=new_motion(design.drive.motion))
    for path, word in changes.items():
        design = edited(design, path, word)
    for path, length in OWN_LENGTHS.items():
        design = edited(design, path, length) if path in all_paths(design) else design
    return _with_surfaces(design)


def _with_surfaces(design: Design) -> Design:
    """Return the design with typical width and materials, marked as assumed, so that the contact pressure is calculated."""
    drive = design.drive
    if not (drive.has_disk and is_line_contact(drive.face)):
        return design
    is_roller = isinstance(drive.face, Roller)
    width = drive.face.radius_mm if is_roller else drive.cam.base_radius_mm / 4.0
    values = {
        "cam.thickness_mm": float(round(width)),
        "cam.material": "16mncr5",
        "cam.roller_material": "100cr6" if is_roller else "16mncr5",
    }
    for path, value in values.items():
        design = with_assumed(edited(design, path, value), path, True)
    return design


def empty_sheet() -> Design:
    """Return an empty linkage."""
    return Design("New linkage", None, (Drive(None, empty_linkage(), None, LinkageLoads()),))


def new_motion(motion: Motion) -> Motion:
    """Return a motion of rise, dwell, return and dwell over 120°, 60°, 120° and 60°, with the stroke of a motion."""
    height = stroke(motion)
    segments = tuple(
        Segment(span, rise, NamedCurve(law))
        for span, rise, law in (
            (120.0, height, NEW_LAW),
            (60.0, 0.0, "dwell"),
            (120.0, -height, NEW_LAW),
            (60.0, 0.0, "dwell"),
        )
    )
    return replace(motion, start=0.0, segments=segments, lobe=None)


def dwell_first(design: Design) -> Design:
    """Return a new design whose motion begins with its last dwell, instead of with the rise."""
    motion = design.drive.motion
    assert motion is not None
    *others, last = motion.segments
    return with_drive(design, motion=replace(motion, segments=(last, *others)))


def with_previous_motion(design: Design, motion: Motion | None) -> Design:
    """Return a new design with the previous motion, scaled to the new stroke where that is necessary.

    The design is returned unchanged where there was no motion, or where it is not valid with the new follower.
    """
    current = design.drive.motion
    if motion is None or current is None:
        return design
    motions = [motion] if motion.unit == current.unit else []
    if stroke(motion):
        motions.append(with_stroke(replace(motion, unit=current.unit), stroke(current)))
    assumed = tuple(path for path in design.assumed if not path.startswith("motion."))
    designs = (with_drive(replace(design, assumed=assumed), motion=row) for row in motions)
    return next((row for row in designs if _is_valid(row)), design)


def _is_valid(design: Design) -> bool:
    """Whether linkage and cam of a design can be calculated without errors."""
    if faults(design):
        return False
    try:
        return not any(finding.severity == ERROR for finding in findings_of(Study(design, SAMPLES), ("linkage", "cam")))
    except KindynaError:
        return False


# -- linkages of other programs --------------------------------------------------------------------------


class LinkageDialog(QDialog):
    """Reads the text of a linkage of another program; ``linkage`` is the import, None where it cannot be read."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        dialogs.give_help(self, "linkages#From other programs")
        self.setWindowTitle(TITLE)
        self._name, self._file = "", ("", "")  # path and text of the opened file
        self.linkage: LinkageImport | None = None
        self.text, self.units, self.mirror, self.inputs = QPlainTextEdit(), QComboBox(), QCheckBox(), QListWidget()
        self.text.setTabChangesFocus(True)
        self.text.setPlaceholderText("Paste a Pyslvs expression, M[J[R, ...], or the address of PMKS+, or open a file")
        self.open_button = QPushButton("&Open a file...")
        self.units.addItem("as in the text, else mm", "")
        for unit in UNITS:
            self.units.addItem(unit, unit)
        self.mirror.setText("Mirror about the x axis, for programs whose y axis points down")
        self.text.setAccessibleName("Text of the linkage")
        self.inputs.setAccessibleName("Inputs")
        self.inputs.setFixedHeight(86)
        self.inputs.setToolTip("Driving joints: the first is the driver, the others follow it")
        self.picture, self.message = QLabel(), MessageLabel(SCREEN.quiet)
        self.picture.setFixedSize(PICTURE)
        form = fill(QFormLayout(), ("Lengths in", self.units), ("Inputs", self.inputs), self.mirror)
        self.buttons, self.ok = dialogs.accept_buttons(self, "Begin")
        add_copy_of_line(self.buttons, self._as_command)
        fill(
            QVBoxLayout(self),
            bold_label("Linkage from Pyslvs, PMKS+ or Linkage"),
            (self.text, 1),
            self.open_button,
            form,
            (self.picture, 0, Qt.AlignmentFlag.AlignHCenter),
            self.message,
            self.buttons,
        )
        self.resize(560, 700)
        connect_all(
            (self.open_button.clicked, self._open),
            (self.text.textChanged, self._change_text),
            (self.units.currentIndexChanged, self._read),
            (self.mirror.toggled, self._read),
            (self.inputs.itemChanged, self._read),
        )
        self._read()

    def _open(self) -> None:
        opened = dialogs.opened_file(self, TITLE, FILES, PROGRAM_BYTES)
        if opened is not None:
            path, data = opened
            self._name = path.stem
            self.text.setPlainText(decoded(data))
            self._file = str(path), self.text.toPlainText()

    def _as_command(self) -> str:
        from core.commands.linkages import LinkageFromArguments

        (path, read), text = self._file, self.text.toPlainText()
        items = [self.inputs.item(i) for i in range(self.inputs.count())]
        driven = [item.text() for item in items if item.checkState() is Qt.CheckState.Checked]
        options = {
            "text": path if path and text == read else text.strip(),
            "out": f"{self._name or 'linkage'}.toml",
            "units": self.units.currentData(),
            "mirror": self.mirror.isChecked(),
            "inputs": driven if self.linkage is not None and tuple(driven) != self.linkage.inputs else [],
        }
        return command_text("linkage-from", command_words(LinkageFromArguments, options))

    def _change_text(self) -> None:
        """Read another text with its default inputs."""
        self.inputs.clear()
        self._read()

    def _read(self, *_: object) -> None:
        """Read the text with the chosen options, and show the linkage."""
        self.linkage = None
        text = self.text.toPlainText()
        items = [self.inputs.item(i) for i in range(self.inputs.count())]
        inputs = tuple(item.text() for item in items if item.checkState() is Qt.CheckState.Checked)
        try:
            if text.strip():
                units = self.units.currentData()
                self.linkage = read_linkage(
                    text, name=self._name, units=units, mirror=self.mirror.isChecked(), inputs=inputs
                )
        except KindynaError as error:
            self._say(sentence(str(error).splitlines()[0]), wrong=True)
        self.ok.setEnabled(self.linkage is not None)
        if self.linkage is None:
            self.picture.setPixmap(QPixmap())
            if not text.strip():
                self._say("")
            return
        if not items:
            self._list_inputs(self.linkage)
        self._show(self.linkage)

    def _list_inputs(self, linkage: LinkageImport) -> None:
        self.inputs.blockSignals(True)
        for name in linkage.could_drive:
            item = QListWidgetItem(name, self.inputs)
            item.setCheckState(Qt.CheckState.Checked if name in linkage.inputs else Qt.CheckState.Unchecked)
        self.inputs.blockSignals(False)

    def _show(self, linkage: LinkageImport) -> None:
        lines = [f"{linkage.links} links, {linkage.joints} joints"]
        lines += [f"Not imported: {row.what}: {row.why}" for row in linkage.left_out[:MOST_SHOWN]]
        if (more := len(linkage.left_out) - MOST_SHOWN) > 0:
            lines.append(f"and {more} more")
        picture = QPixmap()
        if faults(linkage.design):
            lines += [sentence(text) for text in mobility(linkage.design.drive.linkage).sentences]
        else:
            ratio = self.devicePixelRatioF()
            picture = QPixmap.fromImage(thumbnail(linkage.design, PICTURE.width(), PICTURE.height(), ratio))
        self.picture.setPixmap(picture)
        self._say("\n".join(lines))

    def _say(self, text: str, wrong: bool = False) -> None:
        coloured(self.message, SCREEN.limit if wrong else SCREEN.quiet)
        self.message.show_message(text)


def ask_linkage(parent: QWidget) -> LinkageImport | None:
    """Ask for a linkage of another program; None where the user cancels."""
    dialog = LinkageDialog(parent)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    linkage = dialog.linkage if accepted else None
    dialog.deleteLater()
    return linkage
