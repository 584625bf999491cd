"""New designs, linkages of other programs."""

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
    QDialogButtonBox,
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
    FOLLOWER_KINDS,
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

# -- beginnings ------------------------------------------------------------------------------------------

NEW_LAW = "modified-sine"
"""Of the rise and the return that a new design begins with."""

FIRST_OF_KIND: Mapping[str, str] = MappingProxyType(
    {"cam-slider": "transfer_lift", "translating": "card_picker", "oscillating": "rocker_cam"}
)
"""Kind of follower -> the example whose lengths, stroke and loads a new design of the kind begins with."""

DISTANCE = "follower.second.distance_mm"
OWN_LENGTHS: Mapping[str, float] = MappingProxyType({DISTANCE: 150.0})
"""Path -> value [mm] in new designs that have it: another one than an edit begins with, which would make both cams of a symmetric
motion one."""

SAMPLES = 180  # of a turn, to see whether a motion suits a mechanism


def beginning(kind: str, changes: Mapping[str, str] = MappingProxyType({}), name: str = "") -> Design:
    """A design of this kind of follower with a whole motion; changes: of face and form, path -> word."""
    label = FOLLOWER_KINDS[kind].label
    design: Design = load(example(FIRST_OF_KIND[kind]))
    assumed = tuple(path for path in design.assumed if not path.startswith("motion."))
    design = replace(design, name=name or f"New {label[:1].lower()}{label[1:]}", assumed=assumed)
    assert design.drive.motion is not None
    design = with_drive(design, motion=new_motion(design.drive.motion))
    for path, word in changes.items():
        design = edited(design, path, word)
    for path, length in OWN_LENGTHS.items():
        design = edited(design, path, length) if path in all_paths(design) else design
    return _with_surfaces(design)


def _with_surfaces(design: Design) -> Design:
    """Width and materials that are usual, all assumed, so that the pressure of the contact can be read; of an edge there is none."""
    drive = design.drive
    if not is_line_contact(drive.face):
        return design
    rolls = isinstance(drive.face, Roller)
    width = drive.face.radius_mm if rolls else drive.cam.base_radius_mm / 4.0
    offered = {
        "cam.thickness_mm": float(round(width)),
        "cam.material": "16mncr5",
        "cam.roller_material": "100cr6" if rolls else "16mncr5",
    }
    for path, value in offered.items():
        design = with_assumed(edited(design, path, value), path, True)
    return design


def empty_sheet() -> Design:
    """A linkage of which nothing is drawn yet."""
    return Design("New linkage", None, (Drive(None, empty_linkage(), None, LinkageLoads()),))


def new_motion(motion: Motion) -> Motion:
    """Rise, dwell, return and dwell from the base position over 120, 60, 120 and 60 degrees, with the stroke of a motion."""
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
    return replace(motion, start=0.0, segments=segments)


def dwell_first(design: Design) -> Design:
    """A design to begin with whose motion begins with its dwell at the base position, instead of with the rise."""
    motion = design.drive.motion
    assert motion is not None
    *others, last = motion.segments
    return with_drive(design, motion=replace(motion, segments=(last, *others)))


def with_motion_kept(design: Design, motion: Motion | None) -> Design:
    """The design with the motion that was there before: as it is where it suits, else its levels scaled to the design's own
    stroke, where that suits; where there was none, or neither suits, the design as it is."""
    own = design.drive.motion
    if motion is None or own is None:
        return design
    wanted = [motion] if motion.unit == own.unit else []
    if stroke(motion):
        wanted.append(with_stroke(replace(motion, unit=own.unit), stroke(own)))
    assumed = tuple(path for path in design.assumed if not path.startswith("motion."))
    made = (with_drive(replace(design, assumed=assumed), motion=each) for each in wanted)
    return next((each for each in made if _sound(each)), design)


def _sound(design: Design) -> bool:
    """Whether the follower can go so, on a cam without faults."""
    if faults(design):
        return False
    try:
        return not any(finding.severity == ERROR for finding in findings_of(Study(design, SAMPLES), ("linkage", "cam")))
    except KindynaError:
        return False


# -- linkage dialog --------------------------------------------------------------------------------------

TITLE, FILES = "Import linkage", "Linkages (*.linkage2 *.pyslvs *.txt);;All files (*)"
PICTURE, MOST_SHOWN = QSize(380, 270), 12


class LinkageDialog(QDialog):
    """made: the design that the text is; None where it is none."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        dialogs.give_help(self, "linkages#From other programs")
        self.setWindowTitle(TITLE)
        self._name, self._file = "", ("", "")  # what was opened: its path, and its text
        self.made: LinkageImport | None = None
        self.text, self.units, self.mirror, self.inputs = QPlainTextEdit(), QComboBox(), QCheckBox(), QListWidget()
        self.text.setTabChangesFocus(True)
        self.text.setPlaceholderText("Paste a Pyslvs expression, M[J[R, ...], or the address of PMKS+, or open a file")
        self.open_button = QPushButton("&Open a file...")
        self.units.addItem("as the text says, else mm", "")
        for unit in UNITS:
            self.units.addItem(unit, unit)
        self.mirror.setText("Turn it over about the x axis: where its y points down")
        self.text.setAccessibleName("Text of the linkage")
        self.inputs.setAccessibleName("Inputs")
        self.inputs.setFixedHeight(86)
        self.inputs.setToolTip("The joints that drive; of several the first is the driver, the others turn with it")
        self.picture, self.message = QLabel(), MessageLabel(SCREEN.quiet)
        self.picture.setFixedSize(PICTURE)
        form = QFormLayout()
        form.addRow("Lengths in", self.units)
        form.addRow("Inputs", self.inputs)
        form.addRow(self.mirror)
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.ok = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.ok.setText("Begin")
        add_copy_of_line(self.buttons, self._as_command)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addWidget(bold_label("Of Pyslvs, PMKS+ or Linkage"))
        column.addWidget(self.text, 1)
        column.addWidget(self.open_button)
        column.addLayout(form)
        column.addWidget(self.picture, 0, Qt.AlignmentFlag.AlignHCenter)
        column.addWidget(self.message)
        column.addWidget(self.buttons)
        self.resize(560, 700)
        self.open_button.clicked.connect(self._open)
        self.text.textChanged.connect(self._afresh)
        self.units.currentIndexChanged.connect(self._read)
        self.mirror.toggled.connect(self._read)
        self.inputs.itemChanged.connect(self._read)
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
        asked = {
            "text": path if path and text == read else text.strip(),
            "out": f"{self._name or 'linkage'}.toml",
            "units": self.units.currentData(),
            "mirror": self.mirror.isChecked(),
            "inputs": driven if self.made is not None and tuple(driven) != self.made.inputs else [],
        }
        return command_text("linkage-from", command_words(LinkageFromArguments, asked))

    def _afresh(self) -> None:
        """Another text: its own inputs."""
        self.inputs.clear()
        self._read()

    def _read(self, *_: object) -> None:
        """What the text is, read as asked for."""
        self.made = None
        text = self.text.toPlainText()
        items = [self.inputs.item(i) for i in range(self.inputs.count())]
        inputs = tuple(item.text() for item in items if item.checkState() is Qt.CheckState.Checked)
        try:
            if text.strip():
                units = self.units.currentData()
                self.made = read_linkage(
                    text, name=self._name, units=units, mirror=self.mirror.isChecked(), inputs=inputs
                )
        except KindynaError as error:
            self._say(sentence(str(error).splitlines()[0]), wrong=True)
        self.ok.setEnabled(self.made is not None)
        if self.made is None:
            self.picture.setPixmap(QPixmap())
            if not text.strip():
                self._say("")
            return
        if not items:
            self._list_inputs(self.made)
        self._show(self.made)

    def _list_inputs(self, made: LinkageImport) -> None:
        self.inputs.blockSignals(True)
        for name in made.could_drive:
            item = QListWidgetItem(name, self.inputs)
            item.setCheckState(Qt.CheckState.Checked if name in made.inputs else Qt.CheckState.Unchecked)
        self.inputs.blockSignals(False)

    def _show(self, made: LinkageImport) -> None:
        lines = [f"{made.links} links, {made.joints} joints"]
        lines += [f"Left out: {each.what}: {each.why}" for each in made.left_out[:MOST_SHOWN]]
        if (more := len(made.left_out) - MOST_SHOWN) > 0:
            lines.append(f"and {more} more that are left out")
        picture = QPixmap()
        if faults(made.design):
            lines += [sentence(text) for text in mobility(made.design.drive.linkage).sentences]
        else:
            ratio = self.devicePixelRatioF()
            picture = QPixmap.fromImage(thumbnail(made.design, PICTURE.width(), PICTURE.height(), ratio))
        self.picture.setPixmap(picture)
        self._say("\n".join(lines))

    def _say(self, text: str, wrong: bool = False) -> None:
        coloured(self.message, SCREEN.limit if wrong else SCREEN.quiet)
        self.message.show_message(text)


def linkage_wanted(parent: QWidget) -> LinkageImport | None:
    """Ask for a linkage of another program; None where the user thinks better of it."""
    dialog = LinkageDialog(parent)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    made = dialog.made if accepted else None
    dialog.deleteLater()
    return made
