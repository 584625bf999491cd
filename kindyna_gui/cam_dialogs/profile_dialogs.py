"""Dialogs of the exports of a cam: profile with its preview, workshop drawing, and controller table with its errors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QEvent, QObject, QPointF, QSize, Qt
from PySide6.QtGui import QMouseEvent, QPainter
from PySide6.QtWidgets import QComboBox, QGridLayout, QWidget

from core.design import Design
from core.frozen import frozen
from core.number_text import rounded_up
from core.output.controllers.deviation import ErrorCurves, error_curve, errors_over_turn, text
from core.output.controllers.rows import INTERPOLATIONS, Controller, controllers
from core.output.controllers.slave import EQUAL, PLACED, EcamRequest, drive_slave, slave_choices
from core.output.controllers.table import NOT_PUBLISHED, Ecam, ecam
from core.output.files.cam_drawing import drawing
from core.output.files.files import FORMATS, profile_job
from core.output.files.profile_files import ProfileDrawing
from core.output.files.profile_fit import FITS
from core.output.files.profile_request import Machining, ProfileRequest
from core.output.files.sheet import DrawingRequest, DrawingSheet, Letterhead
from core.requests import build_request, command_words, request_fields
from core.study import Study
from kindyna_gui.export_dialogs import saved_cover
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.request_form import ComputedDialog, RequestForm, accepted, flanks
from kindyna_gui.labels import sentence
from kindyna_gui.look import Picture
from kindyna_gui.pictures.paper.sheets import paint_sheet
from kindyna_gui.pictures.plots.xy import Dots, Line, Rule, XYPlot
from kindyna_gui.pictures.shapes import at, circle, cross, fit_transform, outline
from kindyna_gui.pictures.style import CHAIN, DASHED, OUTLINE, SCREEN, THIN, brush, no_pen
from kindyna_gui.pictures.units import short, typed

# -- profile preview -------------------------------------------------------------------------------------

CURVE_POINTS = 1440  # drawn points of the curve
MARGIN = 24  # pixels
MOST_DOTS = 2000  # more dots would overlap
DOT, RING = 2.2, 8.0  # radii, pixels
CROSS = 5.0  # half the size of the mark of the cam centre, pixels


@frozen(eq=False)
class Preview:
    """Curves of a profile file, complex [mm]: its curve (n,), its points (m,), and the point of largest deviation.

    ``profiles``: other profiles (k,): the profile of a cutter's path, or the other flanks of a drawing.
    """

    job: ProfileDrawing
    curve: np.ndarray
    points: np.ndarray
    worst: complex
    profiles: tuple[np.ndarray, ...]


def preview(job: ProfileDrawing) -> Preview:
    """Return the curves of a profile file for its drawing."""
    main, part = job.main, np.arange(CURVE_POINTS) / CURVE_POINTS
    profiles = [drawn.curve.at(drawn.curve.length * part) for drawn in job.profiles.values() if drawn is not main]
    if job.request.cutter_mm and not profiles:
        profiles = [job.profile]
    return Preview(job, main.curve.at(main.curve.length * part), main.chain.vertices, main.worst, tuple(profiles))


class PreviewPicture(Picture):
    """Drawing of the last preview."""

    def __init__(self) -> None:
        super().__init__("Picture of the profile", QSize(300, 300), QSize(420, 420))

    def draw(self, painter: QPainter) -> None:
        shown: Preview = self.shown
        mm = fit_transform(np.concatenate((shown.curve, *shown.profiles, [0.0])), self.size(), MARGIN)
        painter.setPen(SCREEN.pen(SCREEN.quiet, THIN, CHAIN))
        for profile in shown.profiles:
            painter.drawPath(mm.map(outline(profile)))
        painter.setPen(SCREEN.pen(SCREEN.ink, OUTLINE))
        painter.drawPath(mm.map(outline(shown.curve)))
        centre = mm.map(QPointF(0.0, 0.0))
        painter.setPen(SCREEN.pen(SCREEN.quiet, THIN))
        painter.drawPath(cross(CROSS, complex(centre.x(), centre.y())))
        painter.setPen(no_pen())
        painter.setBrush(brush(SCREEN.family("displacement")))
        for z in shown.points[:: 1 + shown.points.size // MOST_DOTS].tolist():
            painter.drawEllipse(mm.map(at(z)), DOT, DOT)
        worst = mm.map(at(shown.worst))
        painter.strokePath(circle(RING, complex(worst.x(), worst.y())), SCREEN.pen(SCREEN.limit, OUTLINE))


# -- profile dialog --------------------------------------------------------------------------------------

FIRST = {"samples": 360, "spacing_mm": 1.0, "tolerance_mm": 1e-3}


class ProfileDialog(ComputedDialog):
    """Dialog for the format, points and tolerance of a profile file, with a preview."""

    command, help_page = "profile", "tour#Export > Profile"

    def __init__(self, parent: QWidget, design: Design) -> None:
        self._design, self.format, self.picture = design, QComboBox(), PreviewPicture()
        cutter = getattr(design.drive.cam, "cutter_radius_mm", None) or 0.0
        form = RequestForm(ProfileRequest, flanks(design), {**FIRST, "cutter_mm": cutter}, [("Format", self.format)])
        super().__init__(parent, "profile", form, self.picture)
        fill_choices(self.format, {ending: f"{row.label} ({ending})" for ending, row in FORMATS.items()})
        self.format.setCurrentIndex(self.format.findData(".dxf"))
        form.choose("Points", FORMATS[".dxf"].sampling[0])
        self.format.currentIndexChanged.connect(self._show_format)
        self._show_format()

    @property
    def ending(self) -> str:  # type: ignore[override]
        """Ending of the selected format: ``.dxf``."""
        ending: str = self.format.currentData()
        return ending

    def _show_format(self) -> None:
        """Show the fields that the selected format has."""
        row = FORMATS[self.ending]
        for field in request_fields(Machining):
            self.form.rows.setRowVisible(self.form.boxes[field.name], row.machined)
        fit = self.form.boxes["fit"]
        fit.blockSignals(True)
        fill_choices(fit, {name: FITS[name].label.capitalize() for name in row.fits})
        fit.blockSignals(False)
        self.changed()

    def job(self) -> Callable[[], Preview]:
        return partial(_profile_preview, self._design, self.ending, self.form.request)

    def show_waiting(self) -> None:
        self.picture.wait()

    def show_result(self, computed: Preview | None) -> str:
        self.picture.show_picture(computed)
        return "" if computed is None else _summary(computed.job)


def _profile_preview(design: Design, ending: str, request: ProfileRequest) -> Preview:
    return preview(profile_job(Study(design), Path(f"profile{ending}"), request))


def _summary(job: ProfileDrawing) -> str:
    """Number of points and deviation of the file."""
    main = job.main
    return (
        f"{main.count} points on {short(main.curve.length)} mm, at most {typed(rounded_up(main.deviation, 3))} mm from the exact curve "
        "(red ring)."
    )


def ask_profile(parent: QWidget, design: Design) -> tuple[ProfileDrawing, str] | None:
    """Ask for a profile file; return its content and ending, None where the user cancels."""
    dialog = ProfileDialog(parent, design)
    result: Preview | None = accepted(dialog)
    return None if result is None else (result.job, dialog.ending)


# -- drawing dialog --------------------------------------------------------------------------------------


class SheetPicture(Picture):
    """The last drawing sheet."""

    def __init__(self) -> None:
        super().__init__("Drawing sheet", QSize(420, 300), QSize(840, 594))

    def draw(self, painter: QPainter) -> None:
        paint_sheet(painter, self.shown, self.rect())


class DrawingDialog(ComputedDialog):
    """Dialog for a workshop drawing, with the sheet."""

    command, ending, help_page = "drawing", ".pdf", "tour#Export > Drawing"

    def __init__(self, parent: QWidget, design: Design) -> None:
        self._design, self.picture = design, SheetPicture()
        saved = saved_cover()
        self._letterhead = {field.name: saved[field.name] for field in fields(Letterhead)}
        super().__init__(parent, "drawing", RequestForm(DrawingRequest, flanks(design)), self.picture)
        self.changed()

    @property
    def _values(self) -> dict[str, Any]:
        return {**self._letterhead, **self.form.values}

    def command_options(self) -> tuple[str, list[str]]:
        return self.ending, command_words(DrawingRequest, self._values)

    def job(self) -> Callable[[], DrawingSheet]:
        return partial(_sheet, self._design, build_request(DrawingRequest, self._values))

    def show_waiting(self) -> None:
        self.picture.wait()

    def show_result(self, computed: DrawingSheet | None) -> str:
        self.picture.show_picture(computed)
        return "" if computed is None else "\n".join(filter(None, (computed.about, computed.missing)))


def _sheet(design: Design, request: DrawingRequest) -> DrawingSheet:
    return drawing(Study(design), request)


def ask_drawing(parent: QWidget, design: Design) -> DrawingSheet | None:
    """Ask for a workshop drawing; return its sheet, None where the user cancels."""
    sheet: DrawingSheet | None = accepted(DrawingDialog(parent, design))
    return sheet


# -- controller dialog -----------------------------------------------------------------------------------

ANGLE = "Master, °"
FAMILIES = ("displacement", "velocity", "acceleration")
COUNTS, MOST_DECADES = (10, 30, 100, 300, 1000, 3000), 14  # on the axes
ROWS, POINTS = "Number of rows", "points"


@frozen(eq=False)
class TableResult:
    """A controller table, its errors over the turn, and the largest errors of other numbers of rows, (n,) by column."""

    table: Ecam
    errors: ErrorCurves | None
    curve: Mapping[str, np.ndarray]


class ControllerDialog(ComputedDialog):
    """Dialog for a controller table, with its errors over the turn and over the number of rows."""

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
        self.curve.setToolTip("Click to set the number of rows")
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
        self.controller.currentIndexChanged.connect(self._show_controller)
        self.of.currentIndexChanged.connect(self.changed)
        self.resize(1180, 640)
        self._show_controller()

    @property
    def row(self) -> Controller:
        """The selected controller."""
        return self._rows[self.controller.currentData()]

    def _show_controller(self) -> None:
        """Show the interpolations and row positions of the selected controller."""
        row, form = self.row, self.form
        default: dict[Any, str] = {} if row.interpolation_asked else {None: "Its default"}
        known = {name: sentence(name.replace("-", " ")) for name in INTERPOLATIONS if name in row.interpolation}
        for name, choices in (("interpolation", {**default, **known}), ("placing", self._placings())):
            form.boxes[name].blockSignals(True)
            fill_choices(form.boxes[name], choices)
            form.boxes[name].blockSignals(False)
            form.rows.setRowVisible(form.boxes[name], len(choices) > 1)
        form.rows.setRowVisible(form.boxes["segment"], row.last_is_one)
        form.boxes["segment"].setEnabled(row.last_is_one)
        self.changed()

    def _placings(self) -> dict[Any, str]:
        words: dict[Any, str] = {PLACED: "Placed for the smallest error", EQUAL: "At equal steps"}
        return {None: words[EQUAL]} if self.row.equal_steps else {None: "As the controller requires", **words}

    def job(self) -> Callable[[], TableResult]:
        request: EcamRequest = self.form.request
        return partial(_table_result, self._design, self._drive, self.row, request, self.of.currentData())

    # -- result ---------------------------------------------------------------------------------------------

    def show_result(self, computed: TableResult | None) -> str:
        if computed is None or computed.errors is None:
            for plot in (*self.plots, self.curve):
                plot.show_message("" if computed is None else NOT_PUBLISHED)
            return "" if computed is None else text(computed.table)
        self._show_errors(computed.table, computed.errors)
        self._show_curve(computed.table, computed.curve)
        return text(computed.table)

    def _show_errors(self, ecam: Ecam, errors: ErrorCurves) -> None:
        limits = ecam.request.limits if ecam.request.points is None else (np.inf,) * 3
        for plot, name, symbol, limit, shown in zip(self.plots, FAMILIES, "sva", limits, errors.curves, strict=True):
            if shown is None:
                plot.show_message("Linear interpolation has no acceleration")
                continue
            plot.name_axes(ANGLE if plot is self.plots[-1] else "", f"Error of {symbol}, {shown.unit}")
            rows = Dots(ecam.table.x, np.zeros(ecam.table.x.size), SCREEN.ink, 4.0)
            line = Line(errors.x, shown.values * shown.factor, SCREEN.family(name), read=True)
            ends = np.array([0.0, 360.0])
            limit_lines = [
                Line(ends, np.full(2, end * shown.factor), SCREEN.limit, dash=DASHED)
                for end in (limit, -limit)
                if np.isfinite(end)
            ]
            plot.show_lines([*limit_lines, line], dots=[rows])

    def _show_curve(self, ecam: Ecam, curve: Mapping[str, np.ndarray]) -> None:
        unit, times = ("µm", "") if ecam.slave.unit == "mm" else ("0.001°", "× ")
        self.curve.name_axes("Rows", f"Largest error, {unit}")
        positive = curve["deviation"] > 0.0
        x, y = np.log10(curve["rows"][positive]), np.log10(1e3 * curve["deviation"][positive])
        assert ecam.deviation is not None
        point = np.log10([ecam.rows, max(1e3 * ecam.deviation.values[0], 1e-12)])
        dots = Dots(point[:1], point[1:], SCREEN.limit, 9.0)
        label = f"{ecam.rows} rows: {short(1e3 * ecam.deviation.values[0], 3)} {times}{unit}"
        rule = Rule(float(point[0]), label, SCREEN.ink)
        self.curve.show_lines([Line(x, y, SCREEN.family("displacement"))], fit=True, dots=[dots], rules=[rule])
        low, high = int(np.ceil(y.min())), int(np.floor(y.max()))
        decades = range(low, high + 1, 1 + (high - low) // MOST_DECADES)
        self.curve.show_ticks([(float(np.log10(n)), f"{n}") for n in COUNTS if x[0] <= np.log10(n) <= x[-1]],
                              [(float(k), typed(10.0**k)) for k in decades])  # fmt: skip

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Set the number of rows by a click on the curve."""
        if event.type() == QEvent.Type.MouseButtonPress and isinstance(event, QMouseEvent):
            if event.button() == Qt.MouseButton.LeftButton and self.computed is not None and self.computed.curve:
                self._take_rows(10.0 ** self.curve.across_at(event.position().toPoint()))
            return True
        return super().eventFilter(watched, event)

    def _take_rows(self, rows: float) -> None:
        plotted = self.computed.curve["rows"]
        least, most = max(plotted[0], self.row.rows[0]), min(plotted[-1], self.row.rows[1])
        self.form.choose(ROWS, POINTS)
        for name in ("velocity_error", "acceleration_error"):
            self.form.show_value(name, None)
        self.form.show_value(POINTS, round(float(np.clip(rows, least, most))))


@lru_cache(maxsize=8)
def _curve(
    design: Design, drive: str, request: EcamRequest, kind: str, placing: str, closing: bool
) -> Mapping[str, np.ndarray]:
    return error_curve(drive_slave(design, drive, request)[0], kind, placing, closing=closing)


def _table_result(design: Design, drive: str, row: Controller, request: EcamRequest, of: str) -> TableResult:
    request = replace(request, of=of)
    slave, name, speed = drive_slave(design, drive, request)
    table = ecam(slave, row, request, name, speed)
    slave_only = EcamRequest(of=of, reverse=request.reverse, shift_deg=request.shift_deg, segment=request.segment)
    curve = _curve(design, drive, slave_only, table.interpolation, table.placing, row.has_both_ends)
    return TableResult(table, None if table.deviation is None else errors_over_turn(table), curve)


def ask_controller_table(parent: QWidget, design: Design, drive: str) -> Ecam | None:
    """Ask for a controller table and return it; None where the user cancels."""
    result: TableResult | None = accepted(ControllerDialog(parent, design, drive))
    return None if result is None else result.table
