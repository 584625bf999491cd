"""A picture of the points of a profile file on its curve, with the place where it deviates most."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QEvent, QObject, QPointF, QSize, Qt
from PySide6.QtGui import QMouseEvent, QPainter, QPaintEvent, QTransform
from PySide6.QtWidgets import QComboBox, QGridLayout, QSizePolicy, QWidget

from core.design import Design
from core.frozen import frozen
from core.output.controllers.deviation import ErrorCurves, error_curve, errors_over_turn, text
from core.output.controllers.rows import INTERPOLATIONS, Controller, controllers
from core.output.controllers.slave import EQUAL, PLACED, EcamRequest, drive_slave, slave_choices
from core.output.controllers.table import NOT_PUBLISHED, Ecam, ecam
from core.output.files.cam_drawing import drawing
from core.output.files.files import FORMATS, profile_job
from core.output.files.profile_files import ProfileDrawing
from core.output.files.profile_fit import FITS
from core.output.files.profile_request import Machining, ProfileRequest, rounded_up
from core.output.files.sheet import DrawingRequest, DrawingSheet, Letterhead
from core.requests import build_request, command_words, request_fields
from core.study import Study
from kindyna_gui.export_dialogs import kept_cover
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.request_form import ComputedDialog, RequestForm, accepted, flanks
from kindyna_gui.labels import sentence
from kindyna_gui.pictures.paper.sheets import paint_sheet
from kindyna_gui.pictures.plots.xy import Dots, Line, Rule, XYPlot
from kindyna_gui.pictures.shapes import at, circle, outline, segments
from kindyna_gui.pictures.style import CHAIN, DASHED, OUTLINE, SCREEN, THIN, brush, no_pen

# -- profile preview -------------------------------------------------------------------------------------

DRAWN = 1440  # points of the curve
MARGIN = 24  # pixels
MOST_DOTS = 2000  # beyond these they are too close to be told apart
DOT, RING = 2.2, 8.0  # radii, pixels
CROSS = 5.0  # half the size of the cam centre's mark, pixels


@frozen(eq=False)
class Preview:
    """What is shown, all in mm: the curve of the file (n,), its points (m,), where it deviates most, and the profiles beside it: of
    a cutter's path its own, of a drawing those of all flanks, each (k,)."""

    job: ProfileDrawing
    curve: np.ndarray
    points: np.ndarray
    worst: complex
    profiles: tuple[np.ndarray, ...]


def preview(job: ProfileDrawing) -> Preview:
    """The picture of a job."""
    main, part = job.main, np.arange(DRAWN) / DRAWN
    beside = [drawn.curve.at(drawn.curve.length * part) for drawn in job.profiles.values() if drawn is not main]
    if job.request.cutter_mm and not beside:
        beside = [job.profile]
    return Preview(job, main.curve.at(main.curve.length * part), main.chain.vertices, main.worst, tuple(beside))


class PreviewPicture(QWidget):
    """Draws the last preview, faintly while another is computed."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.shown: Preview | None = None
        self._faint = False
        self.setAccessibleName("Picture of the profile")
        self.setMinimumSize(300, 300)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def sizeHint(self) -> QSize:
        return QSize(420, 420)

    def show_preview(self, shown: Preview | None) -> None:
        """Draw this profile; None: nothing."""
        self.shown, self._faint = shown, False
        self.update()

    def wait(self) -> None:
        self._faint = True
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), brush(SCREEN.paper))
        if self.shown is None:
            return
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self._faint:
            painter.setOpacity(0.35)
        self._draw(painter, self.shown)

    def _draw(self, painter: QPainter, shown: Preview) -> None:
        mm = self._scale(shown)
        painter.setPen(SCREEN.pen(SCREEN.quiet, THIN, CHAIN))
        for profile in shown.profiles:
            painter.drawPath(mm.map(outline(profile)))
        painter.setPen(SCREEN.pen(SCREEN.ink, OUTLINE))
        painter.drawPath(mm.map(outline(shown.curve)))
        centre = mm.map(QPointF(0.0, 0.0))
        painter.setPen(SCREEN.pen(SCREEN.quiet, THIN))
        place = complex(centre.x(), centre.y())
        painter.drawPath(segments([(place - CROSS, place + CROSS), (place - 1j * CROSS, place + 1j * CROSS)]))
        painter.setPen(no_pen())
        painter.setBrush(brush(SCREEN.family("displacement")))
        some = shown.points[:: 1 + shown.points.size // MOST_DOTS]
        for dot in (mm.map(at(z)) for z in some.tolist()):
            painter.drawEllipse(dot, DOT, DOT)
        worst = mm.map(at(shown.worst))
        painter.strokePath(circle(RING, complex(worst.x(), worst.y())), SCREEN.pen(SCREEN.limit, OUTLINE))

    def _scale(self, shown: Preview) -> QTransform:
        """From mm, y upwards, to pixels: all of the picture in sight."""
        z = np.concatenate((shown.curve, *shown.profiles, [0.0]))
        low, high = complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())
        size, middle = high - low, 0.5 * (low + high)
        scale = min((self.width() - 2 * MARGIN) / size.real, (self.height() - 2 * MARGIN) / size.imag)
        made = QTransform().translate(0.5 * self.width(), 0.5 * self.height())
        return made.scale(scale, -scale).translate(-middle.real, -middle.imag)


# -- profile dialog --------------------------------------------------------------------------------------

FIRST = {"samples": 360, "spacing_mm": 1.0, "tolerance_mm": 1e-3}


class ProfileDialog(ComputedDialog):
    """What the file shall hold; ``job`` is what was computed for it, None while there is none."""

    command, help_page = "profile", "tour#Export > Profile"

    def __init__(self, parent: QWidget, design: Design) -> None:
        self._design, self.format, self.picture = design, QComboBox(), PreviewPicture()
        cutter = getattr(design.drive.cam, "cutter_radius_mm", None) or 0.0
        form = RequestForm(ProfileRequest, flanks(design), {**FIRST, "cutter_mm": cutter}, [("Format", self.format)])
        super().__init__(parent, "profile", form, self.picture)
        fill_choices(self.format, {ending: f"{row.label} ({ending})" for ending, row in FORMATS.items()})
        self.format.setCurrentIndex(self.format.findData(".dxf"))
        form.choose("Points", FORMATS[".dxf"].sampling[0])
        self.format.currentIndexChanged.connect(self._suit_format)
        self._suit_format()

    @property
    def ending(self) -> str:  # type: ignore[override]
        """The kind of file that is chosen: ``.dxf``."""
        ending: str = self.format.currentData()
        return ending

    def _suit_format(self) -> None:
        """What the format can hold, and how a machine that follows it goes."""
        row = FORMATS[self.ending]
        for each in request_fields(Machining):
            self.form.rows.setRowVisible(self.form.boxes[each.name], row.machined)
        fit = self.form.boxes["fit"]
        fit.blockSignals(True)
        fill_choices(fit, {name: FITS[name].label.capitalize() for name in row.fits})
        fit.blockSignals(False)
        self.changed()

    def job(self) -> Callable[[], Preview]:
        return partial(_profile_preview, self._design, self.ending, self.form.request)

    def show_waiting(self) -> None:
        self.picture.wait()

    def show_result(self, made: Preview | None) -> str:
        self.picture.show_preview(made)
        return "" if made is None else _summary(made.job)


def _profile_preview(design: Design, ending: str, request: ProfileRequest) -> Preview:
    return preview(profile_job(Study(design), Path(f"profile{ending}"), request))


def _summary(job: ProfileDrawing) -> str:
    """What the file will hold."""
    main = job.main
    return (
        f"{main.count} points on {main.curve.length:.6g} mm, at most {rounded_up(main.deviation, 3):g} mm from the exact curve "
        "(red ring)."
    )


def profile_wanted(parent: QWidget, design: Design) -> tuple[ProfileDrawing, str] | None:
    """Ask what a profile file shall hold, computed, and the ending of its name; None where the user cancels."""
    dialog = ProfileDialog(parent, design)
    made: Preview | None = accepted(dialog)
    return None if made is None else (made.job, dialog.ending)


# -- drawing dialog --------------------------------------------------------------------------------------


class SheetPicture(QWidget):
    """A sheet as large as there is room; faint while another is computed."""

    def __init__(self) -> None:
        super().__init__()
        self.shown: DrawingSheet | None = None
        self.faint = False
        self.setAccessibleName("The sheet")
        self.setMinimumSize(420, 300)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def sizeHint(self) -> QSize:
        return QSize(840, 594)

    def show_sheet(self, sheet: DrawingSheet | None) -> None:
        """Draw this sheet; None: nothing."""
        self.shown, self.faint = sheet, False
        self.update()

    def wait(self) -> None:
        self.faint = True
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        if self.shown is None:
            return
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setOpacity(0.4 if self.faint else 1.0)
        paint_sheet(painter, self.shown, self.rect())
        painter.end()


class DrawingDialog(ComputedDialog):
    """``made`` is the sheet for the choices, None while there is none."""

    command, ending, help_page = "drawing", ".pdf", "tour#Export > Drawing"

    def __init__(self, parent: QWidget, design: Design) -> None:
        self._design, self.picture = design, SheetPicture()
        kept = kept_cover()
        self._head = {each.name: kept[each.name] for each in fields(Letterhead)}
        super().__init__(parent, "drawing", RequestForm(DrawingRequest, flanks(design)), self.picture)
        self.changed()

    @property
    def _values(self) -> dict[str, Any]:
        return {**self._head, **self.form.values}

    def command_options(self) -> tuple[str, list[str]]:
        return self.ending, command_words(DrawingRequest, self._values)

    def job(self) -> Callable[[], DrawingSheet]:
        return partial(_sheet, self._design, build_request(DrawingRequest, self._values))

    def show_waiting(self) -> None:
        self.picture.wait()

    def show_result(self, made: DrawingSheet | None) -> str:
        self.picture.show_sheet(made)
        return "" if made is None else "\n".join(filter(None, (made.about, made.missing)))


def _sheet(design: Design, request: DrawingRequest) -> DrawingSheet:
    return drawing(Study(design), request)


def drawing_wanted(parent: QWidget, design: Design) -> DrawingSheet | None:
    """Ask what a drawing shall be like; the sheet, None where the user cancels."""
    sheet: DrawingSheet | None = accepted(DrawingDialog(parent, design))
    return sheet


# -- controller dialog -----------------------------------------------------------------------------------

ANGLE = "Master, °"
FAMILIES = ("displacement", "velocity", "acceleration")
COUNTS, MOST_DECADES = (10, 30, 100, 300, 1000, 3000), 14  # on the axes
ROWS, POINTS = "Number of rows", "points"


@frozen(eq=False)
class Computed:
    """A table, its errors over the turn, and those of tables with other numbers of rows (column -> (n,))."""

    made: Ecam
    errors: ErrorCurves | None
    curve: Mapping[str, np.ndarray]


class ControllerDialog(ComputedDialog):
    """``made`` is the table that the file will hold, with what is shown of it."""

    command, ending, help_page = "ecam", ".csv", "controllers#Rows"

    def command_options(self) -> tuple[str, list[str]]:
        words = command_words(EcamRequest, {**self.form.values, "of": self.of.currentData()})
        return self.ending, ["--controller", self.controller.currentData(), *words]

    def __init__(self, parent: QWidget, design: Design, drive: str) -> None:
        self._design, self._drive, self._rows = design, drive, controllers()
        self.controller, self.of = QComboBox(), QComboBox()
        self.plots = [XYPlot("" if i < 2 else ANGLE, "") for i in range(3)]
        self.curve = XYPlot("Rows", "")
        grid = QGridLayout()
        for i, plot in enumerate(self.plots):
            plot.setMinimumSize(420, 120)
            grid.addWidget(plot, i, 0)
        self.curve.setMinimumSize(300, 200)
        self.curve.setToolTip("Click: a table with so many rows")
        grid.addWidget(self.curve, 0, 1, 3, 1)
        grid.setColumnStretch(0, 3)
        grid.setColumnStretch(1, 2)
        form = RequestForm(EcamRequest, above=[("Controller", self.controller), ("Slave", self.of)])
        super().__init__(parent, "controller table", form, grid)
        self.curve.viewport().installEventFilter(self)
        fill_choices(self.controller, {slug: row.label for slug, row in self._rows.items()})
        self.controller.setMinimumContentsLength(24)
        self.controller.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        fill_choices(self.of, {name: sentence(label) for name, label in slave_choices(design, drive).items()})
        self.controller.currentIndexChanged.connect(self._suit_controller)
        self.of.currentIndexChanged.connect(self.changed)
        self.resize(1180, 640)
        self._suit_controller()

    @property
    def row(self) -> Controller:
        """The controller that is chosen."""
        return self._rows[self.controller.currentData()]

    def _suit_controller(self) -> None:
        """What it can be set to run, and where it takes rows."""
        row, form = self.row, self.form
        usual: dict[Any, str] = {} if row.interpolation_asked else {None: "What it usually runs"}
        known = {name: sentence(name.replace("-", " ")) for name in INTERPOLATIONS if name in row.interpolation}
        for name, choices in (("interpolation", {**usual, **known}), ("placing", self._placings())):
            form.boxes[name].blockSignals(True)
            fill_choices(form.boxes[name], choices)
            form.boxes[name].blockSignals(False)
            form.rows.setRowVisible(form.boxes[name], len(choices) > 1)
        form.rows.setRowVisible(form.boxes["segment"], row.last_is_one)
        form.boxes["segment"].setEnabled(row.last_is_one)
        self.changed()

    def _placings(self) -> dict[Any, str]:
        words: dict[Any, str] = {PLACED: "Placed for the least error", EQUAL: "At equal steps"}
        return {None: words[EQUAL]} if self.row.equal_steps else {None: "As the controller takes them", **words}

    def job(self) -> Callable[[], Computed]:
        request: EcamRequest = self.form.request
        return partial(_table, self._design, self._drive, self.row, request, self.of.currentData())

    # -- what comes of it -----------------------------------------------------------------------------------

    def show_result(self, made: Computed | None) -> str:
        if made is None or made.errors is None:
            for plot in (*self.plots, self.curve):
                plot.show_message("" if made is None else NOT_PUBLISHED)
            return "" if made is None else text(made.made)
        self._show_errors(made.made, made.errors)
        self._show_curve(made.made, made.curve)
        return text(made.made)

    def _show_errors(self, made: Ecam, errors: ErrorCurves) -> None:
        limits = made.request.limits if made.request.points is None else (np.inf,) * 3
        for plot, name, symbol, limit, shown in zip(self.plots, FAMILIES, "sva", limits, errors.curves, strict=True):
            if shown is None:
                plot.show_message("straight lines have no acceleration")
                continue
            plot.name_axes(ANGLE if plot is self.plots[-1] else "", f"Error of {symbol}, {shown.unit}")
            rows = Dots(made.table.x, np.zeros(made.table.x.size), SCREEN.ink, 4.0)
            line = Line(errors.x, shown.values * shown.factor, SCREEN.family(name), read=True)
            ends = np.array([0.0, 360.0])
            kept = [
                Line(ends, np.full(2, end * shown.factor), SCREEN.limit, dash=DASHED)
                for end in (limit, -limit)
                if np.isfinite(end)
            ]
            plot.show_lines([*kept, line], dots=[rows])

    def _show_curve(self, made: Ecam, curve: Mapping[str, np.ndarray]) -> None:
        unit, times = ("µm", "") if made.slave.unit == "mm" else ("0.001°", "× ")
        self.curve.name_axes("Rows", f"Largest error, {unit}")
        seen = curve["deviation"] > 0.0
        x, y = np.log10(curve["rows"][seen]), np.log10(1e3 * curve["deviation"][seen])
        assert made.deviation is not None
        here = np.log10([made.rows, max(1e3 * made.deviation.values[0], 1e-12)])
        dots = Dots(here[:1], here[1:], SCREEN.limit, 9.0)
        rule = Rule(float(here[0]), f"{made.rows} rows: {1e3 * made.deviation.values[0]:.3g} {times}{unit}", SCREEN.ink)
        self.curve.show_lines([Line(x, y, SCREEN.family("displacement"))], fit=True, dots=[dots], rules=[rule])
        low, high = int(np.ceil(y.min())), int(np.floor(y.max()))
        decades = range(low, high + 1, 1 + (high - low) // MOST_DECADES)
        self.curve.show_ticks([(float(np.log10(n)), f"{n}") for n in COUNTS if x[0] <= np.log10(n) <= x[-1]],
                              [(float(k), f"{10.0**k:g}") for k in decades])  # fmt: skip

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """A click on the curve takes a number of rows."""
        if event.type() == QEvent.Type.MouseButtonPress and isinstance(event, QMouseEvent):
            if event.button() == Qt.MouseButton.LeftButton and self.computed is not None and self.computed.curve:
                self._take_rows(10.0 ** self.curve.across_at(event.position().toPoint()))
            return True
        return super().eventFilter(watched, event)

    def _take_rows(self, rows: float) -> None:
        there = self.computed.curve["rows"]
        least, most = max(there[0], self.row.rows[0]), min(there[-1], self.row.rows[1])
        self.form.choose(ROWS, POINTS)
        for name in ("velocity_error", "acceleration_error"):
            self.form.show_value(name, None)
        self.form.boxes[POINTS].setValue(round(float(np.clip(rows, least, most))))


@lru_cache(maxsize=8)
def _curve(
    design: Design, drive: str, request: EcamRequest, kind: str, placing: str, closing: bool
) -> Mapping[str, np.ndarray]:
    return error_curve(drive_slave(design, drive, request)[0], kind, placing, closing=closing)


def _table(design: Design, drive: str, row: Controller, request: EcamRequest, of: str) -> Computed:
    request = replace(request, of=of)
    slave, name, speed = drive_slave(design, drive, request)
    made = ecam(slave, row, request, name, speed)
    alike = EcamRequest(of=of, reverse=request.reverse, shift_deg=request.shift_deg, segment=request.segment)
    curve = _curve(design, drive, alike, made.interpolation, made.placing, row.has_both_ends)
    return Computed(made, None if made.deviation is None else errors_over_turn(made), curve)


def table_wanted(parent: QWidget, design: Design, drive: str) -> Ecam | None:
    """Ask what a controller's table shall hold; computed, None where the user cancels."""
    made: Computed | None = accepted(ControllerDialog(parent, design, drive))
    return None if made is None else made.made
