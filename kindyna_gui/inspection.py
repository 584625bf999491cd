"""Inspection of a cam: dialogs to export the lift table of a probe, and to compare a measured cam with the design."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from PySide6.QtCore import QModelIndex, QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QPainter, QTransform
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from core.design import Design, Info
from core.errors import KindynaError
from core.findings import ERROR
from core.frozen import frozen
from core.motion import TURN
from core.output.files.inspection import (
    Inspection,
    ProfileComparison,
    compare,
    follower_direction,
    follower_probe,
    inspection,
    read_lift,
    set_up_probe,
)
from core.output.files.probe import PROBES, InspectionRequest
from core.project.files import read_bytes
from core.requests import command_words
from core.study import Study
from kindyna_gui import dialogs
from kindyna_gui.background import Background
from kindyna_gui.dialogs import give_help
from kindyna_gui.documents.texts import add_copy
from kindyna_gui.forms.number_box import LiveBox
from kindyna_gui.forms.refusal import FloatingRefusal, judge_number
from kindyna_gui.forms.request_form import PAUSE_MS, WAITING, ComputedDialog, RequestForm, accepted, flanks
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import reason, sentence
from kindyna_gui.look import Picture, coloured, described, sign
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.pictures.shapes import at, circle, cross, fit_transform, outline, polyline, segments
from kindyna_gui.pictures.style import CHAIN, DASHED, OUTLINE, SCREEN, THIN, brush, no_pen
from kindyna_gui.pictures.units import short, signed, typed
from kindyna_gui.rebuilt import connect_all, fill, single_shot, widget_with

# -- form of the probe -----------------------------------------------------------------------------------

DEFAULT_RADIUS = 5.0  # of the probe where the follower has no radius, mm


class ProbeForm(RequestForm):
    """Form of a probe; each flank begins with a probe like the follower on it."""

    def __init__(self, design: Design) -> None:
        initial = {"direction_deg": follower_direction(design), "radius_mm": DEFAULT_RADIUS}
        super().__init__(InspectionRequest, flanks(design), initial)
        self._design = design
        self.name_row("tolerance_mm", "Tolerance ±")
        self.boxes["probe"].removeItem(0)  # the row "as the follower": its probe is selected by name
        self._begin()
        self.boxes["flank"].currentIndexChanged.connect(self._begin)
        self.boxes["probe"].currentIndexChanged.connect(self._offer_radius)

    def _begin(self) -> None:
        name, radius = follower_probe(self._design, self.boxes["flank"].currentData())
        self.show_value("probe", name)
        if radius > 0.0:
            self.show_value("radius_mm", radius)
        self._offer_radius()

    def _offer_radius(self) -> None:
        self.boxes["radius_mm"].setEnabled(PROBES[self.boxes["probe"].currentData()].radius)

    @property
    def request(self) -> InspectionRequest:
        """The probe that the form describes."""
        request: InspectionRequest = super().request
        return request


# -- export dialog ---------------------------------------------------------------------------------------

ANGLE = "Cam angle, °"


class InspectionDialog(ComputedDialog):
    """Dialog for the inspection table of a cam, with the lift and its tolerance band."""

    command, ending, help_page = "inspection", ".csv", "tour#Export > Inspection table"

    def __init__(self, parent: QWidget, design: Design) -> None:
        self._design = design
        self.lift, self.band = XYPlot(ANGLE, "Lift, mm"), XYPlot(ANGLE, "Band, µm")
        plots = fill(QVBoxLayout(), (self.lift, 3), (self.band, 2))
        for plot in (self.lift, self.band):
            plot.setMinimumSize(420, 130)
        super().__init__(parent, "inspection table", ProbeForm(design), plots)
        self.resize(960, 560)
        self.changed()

    def job(self) -> Callable[[], Inspection]:
        return partial(_computed, self._design, self.form.request)

    def show_result(self, computed: Inspection | None) -> str:
        if computed is None:
            self.lift.show_message("")
            self.band.show_message("")
            return ""
        self._show(computed)
        return _summary(computed)

    def _show(self, result: Inspection) -> None:
        """Plot the lift, and below it the tolerance band about it."""
        table = result.table
        x = np.append(table.degrees, 360.0)
        lift, lower, upper = (np.append(y, y[0]) for y in (table.lift, table.lower, table.upper))
        self.lift.show_lines([Line(x, lift, SCREEN.family("displacement"))])
        self.band.show_lines(
            [
                Line(x, 1e3 * (upper - lift), SCREEN.limit, "Upper"),
                Line(x, 0.0 * x, SCREEN.family("displacement"), "Lift"),
                Line(x, 1e3 * (lower - lift), SCREEN.limit, "Lower", DASHED),
            ]
        )


def _computed(design: Design, request: InspectionRequest) -> Inspection:
    result = inspection(Study(design), request)
    result.setup.findings  # noqa: B018 - calculated here, not in the thread of the window
    return result


def _summary(result: Inspection) -> str:
    """Number of rows, largest lift and findings of a table."""
    first = (
        f"{result.table.degrees.size} rows; largest lift {short(result.table.lift.max())} mm. "
        f"Lift 0 is {short(result.setup.base)} mm from the cam centre."
    )
    return "\n".join([first, *(f"{sentence(finding.message)}." for finding in result.setup.findings)])


def ask_inspection(parent: QWidget, design: Design) -> Inspection | None:
    """Ask for an inspection table and return it; None where the user cancels."""
    result: Inspection | None = accepted(InspectionDialog(parent, design))
    return result


# -- drawing of the deviations ---------------------------------------------------------------------------

PROFILE_POINTS = 1440  # drawn points of the profile
MARGIN = 44  # around the drawing, with the cam angles, pixels
DOT, RING, CROSS = 2.4, 8.0, 5.0  # pixels
STEP_DEG = 30
GAP, REACH = 6.0, 18.0  # from the drawing to the ends of the strokes and to the cam angles, pixels
WIDE_GAP = 10.0  # a gap between rows across which no line is drawn, degrees


@frozen(eq=False)
class ShownComparison:
    """A comparison with the points (n,) [mm] of the profile and its outward unit normals (n,), both complex."""

    comparison: ProfileComparison
    profile: np.ndarray
    normal: np.ndarray


def shown(comparison: ProfileComparison) -> ShownComparison:
    """Calculate everything that is drawn of a comparison."""
    setup = comparison.setup
    profile = setup.exact(setup.study.program.angles(TURN * np.arange(PROFILE_POINTS) / PROFILE_POINTS))
    comparison.findings  # noqa: B018 - calculated here, not in the thread of the window
    return ShownComparison(comparison, profile.z, setup.side * 1j * profile.tangent)


def magnified(result: ProfileComparison, factor: float) -> np.ndarray:
    """Return the measured points (n,) [mm] in the frame of the cam, with their deviations times a factor."""
    return np.asarray(
        result.table.contact + factor * result.setup.outward * result.normal_deviation * result.table.normal
    )


class DeviationPicture(Picture):
    """Drawing of the last comparison; deviations are drawn times ``factor``."""

    def __init__(self) -> None:
        super().__init__("Deviations from the profile, magnified", QSize(420, 380), QSize(560, 560))
        self.factor = 100.0
        self._chosen = -1

    def show_picture(self, shown: ShownComparison | None, message: str = "") -> None:
        self._chosen = -1
        super().show_picture(shown, message)

    def magnify(self, factor: float) -> None:
        """Draw deviations times this factor."""
        self.factor = factor
        self.update()

    def point_out(self, row: int) -> None:
        """Mark a row with a ring; negative: none."""
        self._chosen = row
        self.update()

    def draw(self, painter: QPainter) -> None:
        shown: ShownComparison = self.shown
        result, factor = shown.comparison, self.factor
        band = result.setup.request.tolerance_mm * factor
        limits = [shown.profile + side * band * shown.normal for side in (-1.0, 1.0)]
        outward = result.setup.outward
        measured = magnified(result, factor)
        largest = max(band, factor * float(np.abs(result.normal_deviation).max()))
        outer = shown.profile + outward * largest * shown.normal
        mm = fit_transform(np.append(outer, 0.0), self.size(), MARGIN)
        painter.setPen(SCREEN.pen(SCREEN.cam_line, THIN))
        painter.setBrush(brush(SCREEN.cam) if outward > 0.0 else Qt.BrushStyle.NoBrush)
        painter.drawPath(mm.map(outline(shown.profile)))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(SCREEN.pen(SCREEN.limit, THIN))
        for curve in limits:
            painter.drawPath(mm.map(outline(curve)))
        self._name_angles(painter, result, mm, outer)
        painter.setPen(SCREEN.pen(SCREEN.family("displacement"), OUTLINE))
        for stretch in _stretches(result.table.degrees):
            painter.drawPath(mm.map(polyline(measured[stretch].tolist())))
        painter.setPen(no_pen())
        painter.setBrush(brush(SCREEN.limit))
        for point in measured[result.is_outside].tolist():
            painter.drawEllipse(mm.map(at(point)), DOT, DOT)
        self._mark(painter, result, mm, measured)
        painter.setPen(SCREEN.pen(SCREEN.quiet))
        painter.drawText(
            self.rect().adjusted(8, 4, -8, -4),
            Qt.AlignmentFlag.AlignBottom | Qt.AlignmentFlag.AlignLeft,
            f"Deviation × {typed(factor)} (blue), tolerance (red), cam angles",
        )

    def _mark(self, painter: QPainter, result: ProfileComparison, mm: QTransform, measured: np.ndarray) -> None:
        """Mark the largest deviation with its value and angle, and the selected row."""
        painter.setBrush(Qt.BrushStyle.NoBrush)
        if 0 <= self._chosen < measured.size and self._chosen != result.worst_row:
            chosen = mm.map(at(complex(measured[self._chosen])))
            painter.strokePath(circle(RING, complex(chosen.x(), chosen.y())), SCREEN.pen(SCREEN.ink, OUTLINE))
        row = result.worst_row
        worst, centre = mm.map(at(complex(measured[row]))), mm.map(QPointF(0.0, 0.0))
        spot = complex(worst.x(), worst.y())
        inwards = complex(centre.x(), centre.y()) - spot
        inwards /= abs(inwards) or 1.0
        colour = SCREEN.limit if result.is_outside[row] else SCREEN.ink
        text = f"{signed(1e3 * result.normal_deviation[row])} µm at {short(result.table.degrees[row])}°"
        size = painter.fontMetrics().size(0, text)
        end = spot + inwards * (RING + 26.0)
        painter.strokePath(circle(RING, spot), SCREEN.pen(colour, OUTLINE))
        painter.strokePath(segments([(spot + inwards * RING, end)]), SCREEN.pen(colour, THIN))
        # the text is further inwards, where nothing else is drawn
        middle = end + complex(inwards.real * (0.5 * size.width() + 4.0), inwards.imag * (0.5 * size.height() + 4.0))
        box = QRectF(
            middle.real - 0.5 * size.width() - 3.0, middle.imag - 0.5 * size.height(), size.width() + 6.0, size.height()
        )
        painter.fillRect(box, brush(SCREEN.paper))
        painter.setPen(SCREEN.pen(colour))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def _name_angles(self, painter: QPainter, result: ProfileComparison, mm: QTransform, outer: np.ndarray) -> None:
        """Write the cam angles outside the drawing, where they are measured, and mark the cam centre."""
        centre = mm.map(QPointF(0.0, 0.0))
        origin, setup = complex(centre.x(), centre.y()), result.setup
        painter.setPen(SCREEN.pen(SCREEN.quiet, THIN))
        painter.drawPath(cross(CROSS, origin))
        around = np.angle(outer)
        order = np.argsort(around)
        for degrees in range(0, 360, STEP_DEG):
            angle = setup.direction - setup.study.sense * np.deg2rad(degrees)
            direction = complex(np.cos(angle), -np.sin(angle))  # in pixels, downwards
            reach = mm.m11() * float(np.interp(angle, around[order], np.abs(outer[order]), period=TURN))
            painter.setPen(SCREEN.pen(SCREEN.faint, THIN, CHAIN))
            painter.drawPath(segments([(origin, origin + (reach + GAP) * direction)]))
            painter.setPen(SCREEN.pen(SCREEN.quiet, THIN))
            tip = origin + (reach + REACH) * direction
            painter.drawText(
                QRectF(tip.real - 20.0, tip.imag - 8.0, 40.0, 16.0), Qt.AlignmentFlag.AlignCenter, f"{degrees}°"
            )


def _stretches(degrees: np.ndarray) -> list[np.ndarray]:
    """Return the rows in the order of their cam angles, split at wide gaps; the last row joins the first."""
    order = np.argsort(degrees, kind="stable")
    if not order.size:
        return []
    closed = np.append(order, order[0])
    steps = np.diff(np.append(degrees[order], degrees[order[0]] + 360.0))
    wide = steps > max(WIDE_GAP, 3.0 * float(np.median(steps)))
    return [part for part in np.split(closed, np.flatnonzero(wide) + 1) if part.size > 1]


# -- dialog of a measured cam ----------------------------------------------------------------------------

LEFT_WIDTH, DEFAULT_SIZE, LEAST_SIZE = 340, QSize(1080, 700), QSize(880, 540)
MOST_ROWS = 100  # rows with the largest deviations that are listed
TABLES = "Tables (*.csv *.txt *.dat *.tsv *.asc)"
HEADINGS = (
    TableHeading("Line", number=True), TableHeading("Cam angle, °", number=True), TableHeading("Normal, µm", number=True),
    TableHeading("In lift, µm", number=True),
)  # fmt: skip


MAGNIFICATION = Info("Magnification", "of the drawn deviations", 1, 100_000, whole=True)


class MeasuredCamDialog(QDialog):
    """Dialog that compares a measured cam with the design; ``comparison``: the last result, or None."""

    def __init__(self, parent: QWidget, design: Design, path: Path, data: bytes) -> None:
        super().__init__(parent)
        give_help(self, "tour#Inspect a measured cam")
        self.setWindowTitle("Inspect a measured cam")
        self.comparison: ProfileComparison | None = None
        self._window = parent
        self._design, self._path, self._data, self._work = design, path, data, Background(self)
        self._order: np.ndarray = np.zeros(0, dtype=int)
        self.form, self.factor, self.fit = (
            ProbeForm(design),
            LiveBox(MAGNIFICATION),
            QCheckBox("Fit the zero marks of angle and lift"),
        )
        self.fit.setToolTip("Fit the zero of angle and lift by least squares, where the table has other zero marks")
        self.factor.set_number(100.0)
        self.factor_refusal = FloatingRefusal(self.factor)
        self.form.rows.setRowVisible(self.form.boxes["samples"], False)  # the table has its own angles
        self.form.rows.addRow("Drawn ×", self.factor)
        self.form.rows.addRow("", self.fit)
        self.verdict, self.notes = QLabel(wordWrap=True), QLabel(wordWrap=True)
        for label in (self.verdict, self.notes):
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        font = self.verdict.font()
        font.setBold(True)
        self.verdict.setFont(font)
        coloured(self.notes, SCREEN.quiet)
        self.picture, self.rows = DeviationPicture(), RowsTable(HEADINGS)
        self._lay_out()
        self._pause = single_shot(self, self._compute, PAUSE_MS)
        connect_all(
            (self._work.result, self._take),
            (self.form.changed, self._changed),
            (self.fit.toggled, self._changed),
            (self.factor.changed, self._magnify),
            (self.again.clicked, self._read_again),
            (self.rows.clicked, self._point_out),
            (self.rows.activated, self._point_out),
            (self.finished, self._work.close),
        )
        self._changed()

    def _lay_out(self) -> None:
        self.again = described(
            QPushButton("&Read again", autoDefault=False),
            tip="Read the file again after it was corrected or measured again",
        )
        name = described(QLabel(self._path.name), tip=str(self._path))
        header = fill(QHBoxLayout(), (name, 1), self.again)
        left = fill(QVBoxLayout(), header, self.form, 6, self.verdict, self.notes, (self.rows, 1), margins=0)
        side = widget_with(left)
        side.setFixedWidth(LEFT_WIDTH)
        middle = fill(QHBoxLayout(), side, (self.picture, 1), spacing=12)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        self.copy = add_copy(buttons, self._window, "inspection", self._command_options, of_drive=True)
        buttons.rejected.connect(self.reject)
        fill(QVBoxLayout(self), (middle, 1), buttons)
        self.setMinimumSize(LEAST_SIZE)
        self.resize(DEFAULT_SIZE.boundedTo(self.screen().availableGeometry().size() - QSize(40, 60)))

    def _command_options(self) -> tuple[str, list[str]]:
        from core.commands.cams import InspectionArguments

        options = {
            "measured": self._path,
            "fit": self.fit.isChecked(),
            "samples": None,
        }  # the table has its own angles
        return ".csv", command_words(InspectionArguments, {**self.form.values, **options})

    # -- result ---------------------------------------------------------------------------------------------

    def _magnify(self) -> None:
        if judge_number(self.factor_refusal, self.factor) and self.factor.number is not None:
            self.picture.magnify(self.factor.number)

    def _changed(self) -> None:
        self._work.stop()
        self._pause.stop()
        self.picture.wait()
        is_valid = self.form.is_valid
        self.copy.setEnabled(is_valid)
        self._show_verdict(WAITING if is_valid else "", SCREEN.quiet)
        if is_valid:
            self._pause.start()

    def _compute(self) -> None:
        job = partial(_compared, self._design, self.form.request, self._data, self._path.name, self.fit.isChecked())
        self._work.start([("", job)])

    def _read_again(self) -> None:
        try:
            self._data = read_bytes(self._path)
        except KindynaError as error:  # the last result stays
            self._show_verdict(reason(self._design, error), SCREEN.limit)
        else:
            self._changed()

    def _take(self, _: object, result: ShownComparison | KindynaError) -> None:
        if isinstance(result, ShownComparison):
            self._show(result)
            return
        self.comparison = None
        lines = str(result).splitlines()
        self._show_verdict(lines[0], SCREEN.limit)
        self.notes.setText("\n".join(lines[1:6]) + (f"\nand {len(lines) - 6} more" if len(lines) > 6 else ""))
        self.rows.show_rows([])
        self.picture.show_picture(None, "No drawing: the table cannot be read or compared")

    def _show(self, shown: ShownComparison) -> None:
        self.comparison = result = shown.comparison
        self.picture.show_picture(shown)
        self._show_verdict(verdict(result), SCREEN.good if result.is_in_tolerance else SCREEN.limit)
        self.notes.setText("\n".join(notes(result)))
        self._order = np.argsort(-np.abs(result.normal_deviation), kind="stable")[:MOST_ROWS]
        self.rows.show_rows(
            [
                TableRow(
                    (
                        str(result.lines[i]),
                        short(result.table.degrees[i]),
                        signed(1e3 * result.normal_deviation[i], 3),
                        signed(1e3 * result.deviation[i], 3),
                    ),
                    sign(ERROR) if result.is_outside[i] else None,
                    "Click to mark it in the drawing",
                )
                for i in self._order.tolist()
            ]
        )

    def _point_out(self, index: QModelIndex) -> None:
        self.picture.point_out(int(self._order[index.row()]))

    def _show_verdict(self, text: str, colour: str) -> None:
        self.verdict.setText(text)
        coloured(self.verdict, colour)


def _compared(design: Design, request: InspectionRequest, data: bytes, name: str, fit: bool) -> ShownComparison:
    measured = read_lift(data, name)
    return shown(compare(set_up_probe(Study(design), request), measured, fit))


def verdict(result: ProfileComparison) -> str:
    """Whether the cam is in tolerance, with the largest deviation, in words."""
    row, band = result.worst_row, 1e3 * result.setup.request.tolerance_mm
    deviation = f"{signed(1e3 * result.normal_deviation[row])} µm normal to the profile"
    largest = f"{deviation} at {short(result.table.degrees[row])}°, line {result.lines[row]}"
    if result.is_in_tolerance:
        return f"In tolerance, ± {typed(band)} µm: the largest deviation is {largest}."
    count = int(result.is_outside.sum())
    return f"Out of tolerance, ± {typed(band)} µm, in {count} of {result.lines.size} rows: the largest deviation is {largest}."


def notes(result: ProfileComparison) -> list[str]:
    """Return notes on the fit, the reading of the table, and the parts that were not measured."""
    lines = []
    if result.is_fitted:
        lines.append(
            f"Fitted: cam angle = angle {signed(result.angle_offset)}°, lift = measured {signed(-result.lift_offset)} mm."
        )
    lines += [f"{sentence(finding.message)}." for finding in result.findings if finding.severity != ERROR]
    return lines + [f"{sentence(note)}." for note in result.notes]


def inspect_measured(parent: QWidget, design: Design) -> MeasuredCamDialog | None:
    """Ask for a table and open the dialog; it is deleted once closed."""
    opened = dialogs.opened_file(parent, "Inspect a measured cam", TABLES)
    if opened is None:
        return None
    dialog = MeasuredCamDialog(parent, design, *opened)
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    dialog.open()
    return dialog
