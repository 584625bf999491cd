"""Motion from a DXF curve: the dialog that rolls the follower over a drawn cam and shows the motion."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
from PySide6.QtCore import QModelIndex, QPointF, QSize
from PySide6.QtGui import QPainter, QTransform
from PySide6.QtWidgets import QComboBox, QFormLayout, QHBoxLayout, QLabel, QVBoxLayout, QWidget

from core.commands.motions import MotionFromArguments
from core.contour import GAP_MM, ContourElement, TracedMotion, read_contour, trace
from core.contour import UNITS as DRAWING_UNITS
from core.design import UNITS, Info, require_motion
from core.errors import KindynaError
from core.findings import ERROR, WARNING
from core.motion import program
from core.output.drawing.turn import shown_range
from core.output.lines import digits
from core.output.texts import traced_figures
from core.requests import command_words, field_info
from core.units import UNITS as SYMBOLS
from kindyna_gui import dialogs
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import add_copy_of_line, command_text, session_options
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.forms.request_form import PutDialog
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import reason, sentence
from kindyna_gui.look import Picture, bold_label, described, sign
from kindyna_gui.pictures.plots.xy import WHOLE_TURN, Dots, Line, XYPlot
from kindyna_gui.pictures.shapes import at, circle, cross, fit_transform, outline
from kindyna_gui.pictures.style import CHAIN, OUTLINE, SCREEN, THIN, brush, no_pen
from kindyna_gui.pictures.units import number, readable
from kindyna_gui.rebuilt import STRETCH, fill

# -- picture ---------------------------------------------------------------------------------------------

ARC_POINTS = 97  # drawn points of an arc
MARGIN = 18  # pixels
DOT, CROSS = 3.0, 5.0  # radius of the mark of a jump, half the size of the mark of the cam centre, pixels
MARK = 8.0  # of a jump in the plot, pixels
PLOT_ANGLES = np.linspace(0.0, 360.0, 2881)  # cam angles of the plotted motion, degrees


def points(elements: Sequence[ContourElement]) -> np.ndarray:
    """Return a chain of lines and arcs as complex points (n,) [mm] for drawing."""
    return np.concatenate(
        [element.at(np.linspace(0.0, 1.0, 2 if element.is_line else ARC_POINTS)) for element in elements]
    )


class CurvePicture(Picture):
    """Drawing of the curve at cam angle 0 [mm], with the path of the follower and the jumps."""

    def __init__(self) -> None:
        super().__init__("The drawn curve, and the follower on it", QSize(240, 240), QSize(380, 380))
        self._chosen: int | None = None
        self._curve = self._path = np.zeros(0, dtype=complex)

    def show_picture(self, shown: TracedMotion | None, message: str = "") -> None:
        self._chosen = None
        if shown is not None:
            self._curve, self._path = points(shown.contour.elements), points(shown.path)
        super().show_picture(shown, message)

    def point_out(self, jump: int | None) -> None:
        """Draw the roller at a jump; None: at none."""
        self._chosen = jump
        self.update()

    def draw(self, painter: QPainter) -> None:
        traced: TracedMotion = self.shown
        radius = traced.design.drive.face.radius_mm
        mm = self._scale(radius)
        if radius:
            painter.setPen(SCREEN.pen(SCREEN.quiet, THIN, CHAIN))
            painter.drawPath(mm.map(outline(self._path)))
        painter.setPen(SCREEN.pen(SCREEN.ink, OUTLINE))
        painter.drawPath(mm.map(outline(self._curve)))
        painter.setPen(SCREEN.pen(SCREEN.quiet, THIN))
        middle = mm.map(QPointF(0.0, 0.0))
        painter.drawPath(cross(CROSS, complex(middle.x(), middle.y())))
        if self._chosen is not None and self._chosen < len(traced.jumps):
            chosen = mm.map(at(traced.jumps[self._chosen].place))
            painter.strokePath(
                circle(max(radius * mm.m11(), 2.0 * DOT), complex(chosen.x(), chosen.y())),
                SCREEN.pen(SCREEN.limit, OUTLINE),
            )
        painter.setPen(no_pen())
        for jump in traced.jumps:
            painter.setBrush(brush(SCREEN.limit if jump.order == 1 else SCREEN.family("acceleration")))
            painter.drawEllipse(mm.map(at(jump.place)), DOT, DOT)

    def _scale(self, radius: float) -> QTransform:
        """Transform from mm, y upwards, to pixels, with room for the roller on all sides."""
        z = np.concatenate((self._curve, self._path, [0.0]))
        room = complex(radius, radius) if radius else 0j
        corners = (complex(z.real.min(), z.imag.min()) - room, complex(z.real.max(), z.imag.max()) + room)
        return fit_transform(np.array(corners), self.size(), MARGIN)


def show_motion(plot: XYPlot, traced: TracedMotion) -> None:
    """Plot the motion over one turn, with a dot where velocity or acceleration jumps."""
    motion = require_motion(traced.design)
    compiled = program(motion)
    angles = np.array([jump.angle for jump in traced.jumps], dtype=float)
    heights = [compiled.state(compiled.angles(np.deg2rad(a))).y[0] / motion.scale for a in (PLOT_ANGLES, angles)]
    display_unit = readable(UNITS[motion.unit].symbol, float(np.abs(heights[0]).max()))
    colour = SCREEN.family("displacement")
    plot.name_axes("Cam angle, °", f"Displacement, {display_unit.symbol}", colour)
    colours = [SCREEN.limit if jump.order == 1 else SCREEN.family("acceleration") for jump in traced.jumps]
    curve = Line(PLOT_ANGLES, heights[0] / display_unit.size, colour)
    plot.show_lines([curve], dots=[Dots(angles, heights[1] / display_unit.size, colours, MARK)])
    plot.point_out(None)
    plot.show_range(WHOLE_TURN, shown_range([curve.y], {"displacement"}, ()))


# -- dialog ----------------------------------------------------------------------------------------------

DRAWINGS = "DXF drawings (*.dxf)"
GAP = field_info(MotionFromArguments, "gap_mm")
LEFT_WIDTH, TABLE_WIDTH, DEFAULT_SIZE, LEAST_SIZE = 280, 340, QSize(1080, 720), QSize(900, 560)
JUMPS = {1: ("Velocity", "/°", ERROR), 2: ("Acceleration", "/°²", WARNING)}


class CurveDialog(PutDialog):
    """Dialog that shows a curve and the motion of the follower on it, and puts the motion into the design."""

    help_page = "making#A cam that is drawn"

    def __init__(self, session: Session, path: Path, data: bytes, parent: QWidget | None = None) -> None:
        super().__init__(session, "Motion from a DXF curve", parent)
        self._path, self._data = path, data
        self.traced: TracedMotion | None = None
        self.unit = QComboBox(self)
        self.unit.addItem("as the drawing states", "")
        for name in DRAWING_UNITS:
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
        add_copy_of_line(self.buttons, self._as_command)
        self.unit.currentIndexChanged.connect(self.read_and_roll)
        for box in (*self.centre, self.gap):
            self.ask_number(box, partial(self._take, box), self.read_and_roll)
        self.jumps.clicked.connect(self._point_out)
        self.jumps.activated.connect(self._point_out)
        self.read_and_roll()

    def _lay_out(self) -> None:
        form = QFormLayout()
        form.setVerticalSpacing(4)
        name = described(bold_label(self._path.name), tip=str(self._path))
        form.addRow(name)
        form.addRow("&Unit", self.unit)
        for text, box in zip(("Cam centre &x", "Cam centre &y"), self.centre, strict=True):
            box.setToolTip("Axis of the cam, in units of the drawing")
            form.addRow(text, box)
        self.gap.setToolTip(sentence(GAP.help))
        form.addRow("&Gap, mm", self.gap)
        self.figures = QFormLayout()
        self.figures.setVerticalSpacing(3)
        self._figures: dict[str, QLabel] = {}
        left = fill(QVBoxLayout(), form, 8, bold_label("Result"), self.figures, STRETCH)
        above = fill(QHBoxLayout(), (self.picture, 1), (self.jumps, 1), spacing=6)
        right = fill(QVBoxLayout(), (above, 5), (self.plot, 4), spacing=6)
        self.frame(left, LEFT_WIDTH, right, DEFAULT_SIZE, LEAST_SIZE)

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
        self.picture.show_picture(traced)
        show_motion(self.plot, traced)
        self._show_figures(dict(traced_figures(traced)))
        unit = SYMBOLS[require_motion(traced.design).unit].symbol
        rows = []
        for jump in traced.jumps:
            name, per, severity = JUMPS[jump.order]
            values = (digits(jump.before, 4), digits(jump.after, 4))
            rows.append(
                TableRow(
                    (number(jump.angle, 3), name, *values, f"{unit}{per}"),
                    sign(severity),
                    "Click to see it on the curve",
                )
            )
        self.jumps.show_rows(rows or [TableRow(("", "No jumps", "", "", ""))])
        self.show_message("Motion and base radius of the design are replaced; Undo restores them.")

    def _show_fault(self, text: str) -> None:
        self.picture.show_picture(None)
        self.plot.show_message("No motion: the follower cannot follow the curve")
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

    # -- result ---------------------------------------------------------------------------------------------

    def _as_command(self) -> str:
        source = session_options(self._session)
        x, y = (box.value or 0.0 for box in self.centre)
        options = {
            "design": source["into"],
            "drive": source["drive"],
            "curve": self._path,
            "out": f"{self._path.stem}.toml",
            "units": self.unit.currentData(),
            "centre": f"{x!r},{y!r}" if x or y else None,
            "gap_mm": GAP_MM if self.gap.value is None else self.gap.value,
        }
        return command_text("motion-from", command_words(MotionFromArguments, options))

    def accept(self) -> None:
        """Put motion and base radius into the design."""
        if self.traced is not None:
            self.put(self.traced.design, f"Motion from {self._path.name}")


def motion_from_curve(session: Session, parent: QWidget) -> CurveDialog | None:
    """Ask for a drawing and open the dialog; it is deleted once closed."""
    opened = dialogs.opened_file(parent, "Motion from a DXF curve", DRAWINGS)
    if opened is None:
        return None
    dialog = CurveDialog(session, *opened, parent)
    dialog.open_once()
    return dialog
