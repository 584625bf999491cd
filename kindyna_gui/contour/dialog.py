"""A drawn curve becomes the motion: how it is read on the left, the curve and what comes of it on the right, with every change."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QModelIndex, QSize
from PySide6.QtWidgets import QComboBox, QFormLayout, QHBoxLayout, QLabel, QVBoxLayout, QWidget

from core.commands.motions import MotionFromArguments
from core.contour import GAP_MM, UNITS, TracedMotion, read_contour, trace
from core.design import Info, require_motion
from core.errors import KindynaError
from core.findings import ERROR, WARNING
from core.output.lines import digits
from core.output.texts import figures
from core.requests import command_words, field_info
from core.units import UNITS as SYMBOLS
from kindyna_gui import dialogs
from kindyna_gui.contour.picture import CurvePicture, show_motion
from kindyna_gui.documents.as_command import add_copy_of, of_session, spelled
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.forms.put_dialog import PutDialog
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import reason, sentence
from kindyna_gui.look import sign
from kindyna_gui.note import bold_label
from kindyna_gui.pictures.plots.xy import XYPlot

DRAWINGS = "DXF drawings (*.dxf)"
GAP = field_info(MotionFromArguments, "gap_mm")
LEFT_WIDTH, TABLE_WIDTH, USUAL, LEAST = 280, 340, QSize(1080, 720), QSize(900, 560)
JUMPS = {1: ("Velocity", "/°", ERROR), 2: ("Acceleration", "/°²", WARNING)}


class CurveDialog(PutDialog):
    """Shows a curve and the motion that the design's follower has on it, and puts that into the design as one step."""

    help_page = "making#A cam that is drawn"

    def __init__(self, session: Session, path: Path, data: bytes, parent: QWidget | None = None) -> None:
        super().__init__(session, "Motion from a DXF curve", parent)
        self._path, self._data = path, data
        self.traced: TracedMotion | None = None
        self.unit = QComboBox(self)
        self.unit.addItem("as the drawing states", "")
        for name in UNITS:
            self.unit.addItem(name, name)
        self.centre = [NumberBox(Info(label)) for label in ("Cam centre x", "Cam centre y")]
        self.gap = NumberBox(GAP, SYMBOLS["mm"])
        self.gap.show_value(GAP_MM)
        self.picture, self.plot = CurvePicture(), XYPlot("", "")
        self.jumps = RowsTable(
            (
                TableHeading("Angle, °", number=True),
                TableHeading("Jumps", wide=True),
                TableHeading("From", number=True),
                TableHeading("To", number=True),
                TableHeading("Unit"),
            )
        )
        self.jumps.setMinimumWidth(TABLE_WIDTH)
        self._lay_out()
        add_copy_of(self.buttons, self._as_command)
        self.unit.currentIndexChanged.connect(self.read_and_roll)
        for box in (*self.centre, self.gap):
            box.entered.connect(lambda value, box=box: self._take(box, value))
            box.unreadable.connect(lambda box=box: box.set_refused(True))
        self.jumps.clicked.connect(self._point_out)
        self.jumps.activated.connect(self._point_out)
        self.read_and_roll()

    def _lay_out(self) -> None:
        form = QFormLayout()
        form.setVerticalSpacing(4)
        name = bold_label(self._path.name)
        name.setToolTip(str(self._path))
        form.addRow(name)
        form.addRow("&Unit", self.unit)
        for text, box in zip(("Cam centre &x", "Cam centre &y"), self.centre, strict=True):
            box.setToolTip("Where the cam turns about, in the drawing's own units")
            form.addRow(text, box)
        self.gap.setToolTip(sentence(GAP.help))
        form.addRow("&Gap, mm", self.gap)
        left = QVBoxLayout()
        left.addLayout(form)
        left.addSpacing(8)
        left.addWidget(bold_label("Result"))
        self.figures = QFormLayout()
        self.figures.setVerticalSpacing(3)
        self._figures: dict[str, QLabel] = {}
        left.addLayout(self.figures)
        left.addStretch(1)
        above = QHBoxLayout()
        above.setSpacing(6)
        above.addWidget(self.picture, 1)
        above.addWidget(self.jumps, 1)
        right = QVBoxLayout()
        right.setSpacing(6)
        right.addLayout(above, 5)
        right.addWidget(self.plot, 4)
        self.frame(left, LEFT_WIDTH, right, USUAL, LEAST)

    def _take(self, box: NumberBox, value: float) -> None:
        box.show_value(value)
        self.read_and_roll()

    # -- reading --------------------------------------------------------------------------------------------

    def read_and_roll(self, *_: object) -> None:
        """Read the curve as requested, roll the follower over it, and show the result."""
        x, y = (box.value or 0.0 for box in self.centre)
        try:
            gap = GAP_MM if self.gap.value is None else self.gap.value
            contour = read_contour(self._data, self._path.name, self.unit.currentData(), complex(x, y), gap)
            self.traced = trace(self._session.design, contour)
        except KindynaError as error:
            self.traced = None
            self._show_fault(reason(self._session.design, error))
        else:
            self._show(self.traced)
        self.put_button.setEnabled(self.traced is not None)

    def _show(self, traced: TracedMotion) -> None:
        self.picture.show_traced(traced)
        show_motion(self.plot, traced)
        self._show_figures(dict(figures(traced)))
        unit = SYMBOLS[require_motion(traced.design).unit].symbol
        rows = []
        for jump in traced.jumps:
            name, per, severity = JUMPS[jump.order]
            values = (digits(jump.before, 4), digits(jump.after, 4))
            rows.append(
                TableRow(
                    (f"{jump.angle:.3f}", name, *values, f"{unit}{per}"), sign(severity), "Click to see it on the curve"
                )
            )
        self.jumps.show_rows(rows or [TableRow(("", "Nothing jumps", "", "", ""))])
        self.show_message("Motion and base radius of the design are replaced; Undo brings them back.")

    def _show_fault(self, text: str) -> None:
        self.picture.show_traced(None)
        self.plot.show_message("Nothing can be drawn before the curve can be followed")
        self._show_figures({})
        self.jumps.show_rows([])
        self.show_message(sentence(text.removeprefix(sentence(f"{self._path.name}: "))), wrong=True)

    def _show_figures(self, shown: dict[str, str]) -> None:
        for name in shown:
            if name not in self._figures:
                self._figures[name] = QLabel(wordWrap=True)
                self.figures.addRow(sentence(name), self._figures[name])
        for name, label in self._figures.items():
            label.setText(sentence(shown.get(name, "")) if name == "motion" else shown.get(name, ""))

    def _point_out(self, index: QModelIndex) -> None:
        if self.traced is not None and index.row() < len(self.traced.jumps):
            self.picture.point_out(index.row())
            self.plot.point_out(self.traced.jumps[index.row()].angle)

    # -- the end --------------------------------------------------------------------------------------------

    def _as_command(self) -> str:
        place = of_session(self._session)
        x, y = (box.value or 0.0 for box in self.centre)
        asked = {
            "design": place["into"],
            "drive": place["drive"],
            "curve": self._path,
            "out": f"{self._path.stem}.toml",
            "units": self.unit.currentData(),
            "centre": f"{x!r},{y!r}" if x or y else None,
            "gap_mm": GAP_MM if self.gap.value is None else self.gap.value,
        }
        return spelled("motion-from", command_words(MotionFromArguments, asked))

    def accept(self) -> None:
        """Put motion and base radius into the design, where the curve gives them."""
        if self.traced is not None:
            self.put(self.traced.design, f"Motion from {self._path.name}")


def motion_from_curve(session: Session, parent: QWidget) -> CurveDialog | None:
    """Ask for a drawing and open the dialog over a window; it is deleted once closed."""
    opened = dialogs.opened_file(parent, "Motion from a DXF curve", DRAWINGS)
    if opened is None:
        return None
    dialog = CurveDialog(session, *opened, parent)
    dialog.open_once()
    return dialog


__all__ = ["CurveDialog", "motion_from_curve"]
