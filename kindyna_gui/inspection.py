"""Inspection."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from PySide6.QtCore import QModelIndex, QPointF, QRectF, QSize, Qt, QTimer
from PySide6.QtGui import QPainter, QPaintEvent, QTransform
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from core.design import Design
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
from kindyna_gui.forms.fields import Amount
from kindyna_gui.forms.request_form import PAUSE_MS, WAITING, ComputedDialog, RequestForm, accepted, flanks
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import reason, sentence
from kindyna_gui.look import coloured, sign
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.pictures.shapes import at, circle, outline, polyline, segments
from kindyna_gui.pictures.style import CHAIN, DASHED, OUTLINE, SCREEN, THIN, brush, no_pen

# -- form ------------------------------------------------------------------------------------------------

A_RADIUS = 5.0  # mm, where the cam's own follower has none


class ProbeForm(RequestForm):
    """Each flank begins with the probe that is its own follower; a probe without a radius is asked for none."""

    def __init__(self, design: Design) -> None:
        first = {"direction_deg": follower_direction(design), "radius_mm": A_RADIUS}
        super().__init__(InspectionRequest, flanks(design), first)
        self._design = design
        self.boxes["tolerance_mm"].setPrefix("± ")
        self.boxes["probe"].removeItem(0)  # that of the cam's own follower is named
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
        request: InspectionRequest = super().request
        return request


# -- export dialog ---------------------------------------------------------------------------------------

ANGLE = "Cam angle, °"


class InspectionDialog(ComputedDialog):
    """``made`` is the inspection that the file will hold."""

    command, ending, help_page = "inspection", ".csv", "tour#Export > Inspection table"

    def __init__(self, parent: QWidget, design: Design) -> None:
        self._design = design
        self.lift, self.band = XYPlot(ANGLE, "Lift, mm"), XYPlot(ANGLE, "Band, µm")
        plots = QVBoxLayout()
        plots.addWidget(self.lift, 3)
        plots.addWidget(self.band, 2)
        for plot in (self.lift, self.band):
            plot.setMinimumSize(420, 130)
        super().__init__(parent, "inspection table", ProbeForm(design), plots)
        self.resize(960, 560)
        self.changed()

    def job(self) -> Callable[[], Inspection]:
        return partial(_computed, self._design, self.form.request)

    def show_result(self, made: Inspection | None) -> str:
        if made is None:
            self.lift.show_message("")
            self.band.show_message("")
            return ""
        self._show(made)
        return _summary(made)

    def _show(self, made: Inspection) -> None:
        """The lift, and below it the band about it: beside the lift itself it could not be seen."""
        table = made.table
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
    made = inspection(Study(design), request)
    made.setup.findings  # noqa: B018 - here, not in the window's thread
    return made


def _summary(made: Inspection) -> str:
    """What the table will hold."""
    at = made.setup
    first = (
        f"{made.table.degrees.size} rows; largest lift {made.table.lift.max():.6g} mm. Lift 0 stands at {at.base:.6g} mm from the cam "
        "centre."
    )
    return "\n".join([first, *(f"{sentence(found.message)}." for found in at.findings)])


def inspection_wanted(parent: QWidget, design: Design) -> Inspection | None:
    """Ask what an inspection table shall hold; computed, None where the user cancels."""
    made: Inspection | None = accepted(InspectionDialog(parent, design))
    return made


# -- picture ---------------------------------------------------------------------------------------------

DRAWN = 1440  # points of the profile
MARGIN = 44  # pixels, in which the cam angles stand
DOT, RING, CROSS = 2.4, 8.0, 5.0  # pixels
STEP_DEG = 30
GAP, REACH = 6.0, 18.0  # from what is drawn to the end of the strokes and to the names of cam angles, pixels
WIDE_GAP = 10.0  # deg without a row, across which no line is drawn


@frozen(eq=False)
class ShownComparison:
    """A comparison with the profile: its points (n,) [mm] and normals away from the cam (n,)."""

    comparison: ProfileComparison
    profile: np.ndarray
    normal: np.ndarray


def shown(comparison: ProfileComparison) -> ShownComparison:
    """Everything that is drawn, computed."""
    at_probe = comparison.setup
    there = at_probe.exact(at_probe.study.program.angles(TURN * np.arange(DRAWN) / DRAWN))
    comparison.findings  # noqa: B018 - here, not in the window's thread
    return ShownComparison(comparison, there.z, at_probe.side * 1j * there.tangent)


def magnified(result: ProfileComparison, factor: float) -> np.ndarray:
    """The measured rows (n,) [mm] in the cam's own frame, so many times as far from the profile as they are."""
    return np.asarray(
        result.table.contact + factor * result.setup.outward * result.normal_deviation * result.table.normal
    )


class DeviationPicture(QWidget):
    """Draws the last comparison, faintly while another is computed; ``factor``: how many times larger deviations are drawn."""

    def __init__(self) -> None:
        super().__init__()
        self.shown: ShownComparison | None = None
        self.factor = 100.0
        self.message = ""
        self._faint, self._chosen = False, -1
        self.setAccessibleName("Deviations from the profile, magnified")
        self.setMinimumSize(420, 380)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def sizeHint(self) -> QSize:
        return QSize(560, 560)

    def show_comparison(self, made: ShownComparison | None, message: str = "") -> None:
        """Draw what was measured beside the profile; None: the message alone."""
        self.shown, self.message, self._faint, self._chosen = made, message, False, -1
        self.update()

    def magnify(self, factor: float) -> None:
        """Draw deviations so many times as large as they are."""
        self.factor = factor
        self.update()

    def point_out(self, row: int) -> None:
        """Ring a row, none where negative."""
        self._chosen = row
        self.update()

    def wait(self) -> None:
        self._faint = True
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), brush(SCREEN.paper))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self._faint:
            painter.setOpacity(0.35)
        if self.shown is not None:
            self._draw(painter, self.shown)
        elif self.message:
            painter.setPen(SCREEN.pen(SCREEN.quiet))
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, self.message)
        painter.end()

    # -- what is drawn -------------------------------------------------------------------------------------------

    def _draw(self, painter: QPainter, made: ShownComparison) -> None:
        result, factor = made.comparison, self.factor
        band = result.setup.request.tolerance_mm * factor
        sides = [made.profile + sign * band * made.normal for sign in (-1.0, 1.0)]
        outward = result.setup.outward
        measured = magnified(result, factor)
        largest = max(band, factor * float(np.abs(result.normal_deviation).max()))
        outer = made.profile + outward * largest * made.normal
        mm = self._scale(outer)
        painter.setPen(SCREEN.pen(SCREEN.cam_line, THIN))
        painter.setBrush(brush(SCREEN.cam) if outward > 0.0 else Qt.BrushStyle.NoBrush)
        painter.drawPath(mm.map(outline(made.profile)))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(SCREEN.pen(SCREEN.limit, THIN))
        for curve in sides:
            painter.drawPath(mm.map(outline(curve)))
        self._name_angles(painter, result, mm, outer)
        painter.setPen(SCREEN.pen(SCREEN.family("displacement"), OUTLINE))
        for stretch in _stretches(result.table.degrees):
            painter.drawPath(mm.map(polyline(measured[stretch].tolist())))
        painter.setPen(no_pen())
        painter.setBrush(brush(SCREEN.limit))
        for place in measured[result.is_outside].tolist():
            painter.drawEllipse(mm.map(at(place)), DOT, DOT)
        self._mark(painter, result, mm, measured)
        painter.setPen(SCREEN.pen(SCREEN.quiet))
        place = self.rect().adjusted(8, 4, -8, -4)
        painter.drawText(
            place,
            Qt.AlignmentFlag.AlignBottom | Qt.AlignmentFlag.AlignLeft,
            f"Deviation × {factor:g} (blue), tolerance (red), cam angles",
        )

    def _mark(self, painter: QPainter, result: ProfileComparison, mm: QTransform, measured: np.ndarray) -> None:
        """The largest deviation with its value and angle, and the row that was pointed out."""
        painter.setBrush(Qt.BrushStyle.NoBrush)
        if 0 <= self._chosen < measured.size and self._chosen != result.worst_row:
            chosen = mm.map(at(complex(measured[self._chosen])))
            painter.strokePath(circle(RING, complex(chosen.x(), chosen.y())), SCREEN.pen(SCREEN.ink, OUTLINE))
        row = result.worst_row
        place, centre = mm.map(at(complex(measured[row]))), mm.map(QPointF(0.0, 0.0))
        spot = complex(place.x(), place.y())
        inwards = complex(centre.x(), centre.y()) - spot
        inwards /= abs(inwards) or 1.0
        colour = SCREEN.limit if result.is_outside[row] else SCREEN.ink
        text = f"{1e3 * result.normal_deviation[row]:+.4g} µm at {result.table.degrees[row]:.4g}°"
        size = painter.fontMetrics().size(0, text)
        foot = spot + inwards * (RING + 26.0)
        painter.strokePath(circle(RING, spot), SCREEN.pen(colour, OUTLINE))
        painter.strokePath(segments([(spot + inwards * RING, foot)]), SCREEN.pen(colour, THIN))
        # the text lies further inwards, where the cam is plain
        middle = foot + complex(inwards.real * (0.5 * size.width() + 4.0), inwards.imag * (0.5 * size.height() + 4.0))
        box = QRectF(
            middle.real - 0.5 * size.width() - 3.0, middle.imag - 0.5 * size.height(), size.width() + 6.0, size.height()
        )
        painter.fillRect(box, brush(SCREEN.paper))
        painter.setPen(SCREEN.pen(colour))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def _name_angles(self, painter: QPainter, result: ProfileComparison, mm: QTransform, outer: np.ndarray) -> None:
        """Where each cam angle is measured, just outside of all that is drawn; the cam centre with its mark."""
        centre = mm.map(QPointF(0.0, 0.0))
        place, setup = complex(centre.x(), centre.y()), result.setup
        painter.setPen(SCREEN.pen(SCREEN.quiet, THIN))
        painter.drawPath(segments([(place - CROSS, place + CROSS), (place - 1j * CROSS, place + 1j * CROSS)]))
        around = np.angle(outer)
        order = np.argsort(around)
        for degrees in range(0, 360, STEP_DEG):
            turned = setup.direction - setup.study.sense * np.deg2rad(degrees)
            line = complex(np.cos(turned), -np.sin(turned))  # pixels run downwards
            reach = mm.m11() * float(np.interp(turned, around[order], np.abs(outer[order]), period=TURN))
            painter.setPen(SCREEN.pen(SCREEN.faint, THIN, CHAIN))
            painter.drawPath(segments([(place, place + (reach + GAP) * line)]))
            painter.setPen(SCREEN.pen(SCREEN.quiet, THIN))
            tip = place + (reach + REACH) * line
            painter.drawText(
                QRectF(tip.real - 20.0, tip.imag - 8.0, 40.0, 16.0), Qt.AlignmentFlag.AlignCenter, f"{degrees}°"
            )

    def _scale(self, outer: np.ndarray) -> QTransform:
        """From mm, y upwards, to pixels: all that is drawn in sight."""
        z = np.append(outer, 0.0)
        low, high = complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())
        size, middle = high - low, 0.5 * (low + high)
        scale = min((self.width() - 2 * MARGIN) / size.real, (self.height() - 2 * MARGIN) / size.imag)
        made = QTransform().translate(0.5 * self.width(), 0.5 * self.height())
        return made.scale(scale, -scale).translate(-middle.real, -middle.imag)


def _stretches(degrees: np.ndarray) -> list[np.ndarray]:
    """Rows in the order of their cam angles, cut where a gap is too wide for a line; the last joins the first."""
    order = np.argsort(degrees, kind="stable")
    if not order.size:
        return []
    closed = np.append(order, order[0])
    steps = np.diff(np.append(degrees[order], degrees[order[0]] + 360.0))
    wide = steps > max(WIDE_GAP, 3.0 * float(np.median(steps)))
    return [part for part in np.split(closed, np.flatnonzero(wide) + 1) if part.size > 1]


# -- measured dialog -------------------------------------------------------------------------------------

LEFT_WIDTH, USUAL, LEAST = 340, QSize(1080, 700), QSize(880, 540)
MOST_ROWS = 100  # of the worst
TABLES = "Tables (*.csv *.txt *.dat *.tsv *.asc)"
HEADINGS = (
    TableHeading("Line", number=True), TableHeading("Cam angle, °", number=True), TableHeading("Normal, µm", number=True),
    TableHeading("In lift, µm", number=True),
)  # fmt: skip


class MeasuredCamDialog(QDialog):
    """``comparison`` is the last comparison, None while there is none; what was shown stays while a file cannot be read."""

    def __init__(self, parent: QWidget, design: Design, path: Path, data: bytes) -> None:
        super().__init__(parent)
        give_help(self, "tour#Inspect a measured cam")
        self.setWindowTitle("Inspect a measured cam")
        self.comparison: ProfileComparison | None = None
        self._over = parent
        self._design, self._path, self._data, self._work = design, path, data, Background(self)
        self._order: np.ndarray = np.zeros(0, dtype=int)
        self.form, self.factor, self.fit = (
            ProbeForm(design),
            Amount(),
            QCheckBox("Fit the zero marks of angle and lift"),
        )
        self.fit.setToolTip("By least squares, where the table counts its angles or its lift from another place")
        self.factor.setDecimals(0)
        self.factor.setRange(1.0, 1e5)
        self.factor.setPrefix("× ")
        self.factor.setValue(100.0)
        self.form.rows.setRowVisible(self.form.boxes["samples"], False)  # the table has its own
        self.form.rows.addRow("Drawn", self.factor)
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
        self._pause = QTimer(self, interval=PAUSE_MS, singleShot=True)
        self._pause.timeout.connect(self._compute)
        self._work.result.connect(self._take)
        self.form.changed.connect(self._changed)
        self.fit.toggled.connect(self._changed)
        self.factor.valueChanged.connect(self.picture.magnify)
        self.again.clicked.connect(self._read_again)
        self.rows.clicked.connect(self._point_out)
        self.rows.activated.connect(self._point_out)
        self.finished.connect(self._work.close)
        self._changed()

    def _lay_out(self) -> None:
        self.again = QPushButton("&Read again")
        self.again.setToolTip("After the file was mended, or measured anew")
        self.again.setAutoDefault(False)
        name = QLabel(self._path.name)
        name.setToolTip(str(self._path))
        head = QHBoxLayout()
        head.addWidget(name, 1)
        head.addWidget(self.again)
        left = QVBoxLayout()
        left.setContentsMargins(0, 0, 0, 0)
        left.addLayout(head)
        left.addWidget(self.form)
        left.addSpacing(6)
        left.addWidget(self.verdict)
        left.addWidget(self.notes)
        left.addWidget(self.rows, 1)
        side = QWidget()
        side.setLayout(left)
        side.setFixedWidth(LEFT_WIDTH)
        middle = QHBoxLayout()
        middle.setSpacing(12)
        middle.addWidget(side)
        middle.addWidget(self.picture, 1)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        add_copy(buttons, self._over, "inspection", self._asked, of_drive=True)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addLayout(middle, 1)
        column.addWidget(buttons)
        self.setMinimumSize(LEAST)
        self.resize(USUAL.boundedTo(self.screen().availableGeometry().size() - QSize(40, 60)))

    def _asked(self) -> tuple[str, list[str]]:
        from core.commands.cams import InspectionArguments

        own = {"measured": self._path, "fit": self.fit.isChecked(), "samples": None}  # the table has its own angles
        return ".csv", command_words(InspectionArguments, {**self.form.values, **own})

    # -- what comes of it ----------------------------------------------------------------------------------------

    def _changed(self) -> None:
        self._work.stop()
        self.picture.wait()
        self._tell(WAITING, SCREEN.quiet)
        self._pause.start()

    def _compute(self) -> None:
        job = partial(_compared, self._design, self.form.request, self._data, self._path.name, self.fit.isChecked())
        self._work.start([("", job)])

    def _read_again(self) -> None:
        try:
            self._data = read_bytes(self._path)
        except KindynaError as error:  # what is shown stays
            self._tell(reason(self._design, error), SCREEN.limit)
        else:
            self._changed()

    def _take(self, _: object, result: ShownComparison | KindynaError) -> None:
        if isinstance(result, ShownComparison):
            self._show(result)
            return
        self.comparison = None
        lines = str(result).splitlines()
        self._tell(lines[0], SCREEN.limit)
        self.notes.setText("\n".join(lines[1:6]) + (f"\nand {len(lines) - 6} more" if len(lines) > 6 else ""))
        self.rows.show_rows([])
        self.picture.show_comparison(None, "Nothing can be drawn before the table can be read and measured")

    def _show(self, made: ShownComparison) -> None:
        self.comparison = result = made.comparison
        self.picture.show_comparison(made)
        self._tell(verdict(result), SCREEN.good if result.is_in_tolerance else SCREEN.limit)
        self.notes.setText("\n".join(notes(result)))
        self._order = np.argsort(-np.abs(result.normal_deviation), kind="stable")[:MOST_ROWS]
        self.rows.show_rows(
            [
                TableRow(
                    (
                        str(result.lines[i]),
                        f"{result.table.degrees[i]:.6g}",
                        f"{1e3 * result.normal_deviation[i]:+.3f}",
                        f"{1e3 * result.deviation[i]:+.3f}",
                    ),
                    sign(ERROR) if result.is_outside[i] else None,
                    "Click to see it in the picture",
                )
                for i in self._order.tolist()
            ]
        )

    def _point_out(self, index: QModelIndex) -> None:
        self.picture.point_out(int(self._order[index.row()]))

    def _tell(self, text: str, colour: str) -> None:
        self.verdict.setText(text)
        coloured(self.verdict, colour)


def _compared(design: Design, request: InspectionRequest, data: bytes, name: str, fit: bool) -> ShownComparison:
    measured = read_lift(data, name)
    return shown(compare(set_up_probe(Study(design), request), measured, fit))


def verdict(result: ProfileComparison) -> str:
    """In words."""
    row, band = result.worst_row, 1e3 * result.setup.request.tolerance_mm
    deviation = f"{1e3 * result.normal_deviation[row]:+.4g} µm normal to the profile"
    largest = f"{deviation} at {result.table.degrees[row]:.5g}°, line {result.lines[row]}"
    if result.is_in_tolerance:
        return f"In tolerance, ± {band:g} µm: the largest deviation is {largest}."
    count = int(result.is_outside.sum())
    return (
        f"Out of tolerance, ± {band:g} µm, in {count} of {result.lines.size} rows: the largest deviation is {largest}."
    )


def notes(result: ProfileComparison) -> list[str]:
    """What was fitted, how the table was read, what was not measured."""
    lines = []
    if result.is_fitted:
        lines.append(
            f"Fitted: cam angle = angle {result.angle_offset:+.6g}°, lift = measured {-result.lift_offset:+.6g} mm."
        )
    lines += [f"{sentence(found.message)}." for found in result.findings if found.severity != ERROR]
    return lines + [f"{sentence(note)}." for note in result.notes]


def inspect_measured(parent: QWidget, design: Design) -> MeasuredCamDialog | None:
    """Ask for a table and open the dialog over a window; it is deleted once closed."""
    opened = dialogs.opened_file(parent, "Inspect a measured cam", TABLES)
    if opened is None:
        return None
    dialog = MeasuredCamDialog(parent, design, *opened)
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    dialog.open()
    return dialog
