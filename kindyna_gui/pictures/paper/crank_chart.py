"""Timing chart of valves: their lifts over the crank, from TDC of overlap, a panel for each cylinder."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from math import hypot
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPolygonF

from core.design import Design, drive_names
from core.design.engine import CRANK_PER_CAM, HALF_CYCLE, within_cycle
from core.errors import KindynaError
from core.output.crank_timing import CrankCurve, crank_curves, crank_pairs
from core.output.drawing.scales import ticks
from core.output.timing import MotionBand
from core.valves import ValvePair, ValveTiming, crank_text
from core.valves.timing import LOBE, VALVE
from kindyna_gui.pictures.paper.timing_chart import (
    NAMES,
    POINT,
    REACH,
    TEXT_HEIGHT,
    TOP,
    ChartHighlights,
    Reference,
    TimingChart,
    tint,
)
from kindyna_gui.pictures.style import DASHED, DOTTED, OUTLINE, SMALL, THIN, Theme, brush, font
from kindyna_gui.pictures.units import brief, short
from kindyna_gui.settings import size_of, sized, symbol_of

DEAD_CENTRES = ((-360, "TDC"), (-180, "BDC"), (0, "TDC"), (180, "BDC"), (360, "TDC"))
LIFTS = 30.0  # space for the numbers of the lift axis, pixels
LIFT_TICKS = 8  # most parts of the lift axis
STEPS = (30, 45, 60, 90, 180)  # of the numbers of the crank axis, degrees
OVERLAP = 0.22  # opacity of the lift that both valves of a cylinder have
NO_BAND = MotionBand("", np.empty(0), np.empty(0), 0.0, "", (), ())


def pair_text(pair: ValvePair) -> str:
    """Separation, advance and overlap of two valves in words."""
    of, lift = _reference(pair.inlet)
    texts = [f"separation {short(pair.separation)}°", f"advance {short(pair.advance)}°"]
    texts += [f"overlap {short(row.deg)}° at {brief(lift, 'mm')}" for row in pair.overlaps([lift]) if row.of == of]
    return ", ".join(texts)


def event_words(timing: ValveTiming) -> str:
    """Centre, opening, closing and duration of a valve in words."""
    of, lift = _reference(timing)
    centre = f"{short(abs(timing.centre))}° {'BTDC' if timing.centre < 0.0 else 'ATDC'}"
    text, event = f"{timing.name}: centre {centre}", timing.event(of, lift)
    if event is None:
        return text
    opens, closes = crank_text(event.opens_deg), crank_text(event.closes_deg)
    return (
        f"{text}, at {brief(lift, 'mm')} {of} lift opens {opens}, closes {closes}, "
        f"duration {short(event.duration_deg)}°"
    )


def _reference(timing: ValveTiming) -> tuple[str, float]:
    """Lift at which events are written: 1 mm of the valve, or 1.27 mm of the lobe of a valve that is not moved directly."""
    return (VALVE, 1.0) if timing.has_valve_lift else (LOBE, 1.27)


class CrankChart(TimingChart):
    """Timing chart over the crank; the parameters are those of ``TimingChart``.

    The joins of a drive are the centre of its valve and the edges of its lobe, as crank angles.
    """

    content = "valve lifts over the crank angle"
    how = (
        "Drag a valve to move its centre, a point on its curve to change the duration at that lift.\n"
        "Ctrl is ten times finer, Esc cancels. Double-click a valve or a point to type the value."
    )

    def __init__(
        self, design: Design, width: float, height: float, unit: str, theme: Theme, reference: Reference | None = None
    ) -> None:
        super().__init__(design, width, height, unit, theme)
        self.curves: dict[int, CrankCurve] = {curve.drive: curve for curve in crank_curves(design)}
        self.pairs = crank_pairs(tuple(self.curves.values()))
        self.others: dict[int, CrankCurve] = {}
        if reference is not None:
            self.others = _same_names(self.curves, reference[0])
            self.reference_name = reference[1] if self.others else ""
        drawn = (*self.curves.values(), *self.others.values())
        self.most = max((float(curve.lift.max()) for curve in drawn), default=0.0) or 1.0
        names = drive_names(design)
        self.bands = tuple(
            self._band(names[i], self.curves[i]) if i in self.curves else NO_BAND for i in range(len(design.drives))
        )
        cylinders = [curve.timing.cylinder for curve in self.curves.values()]
        self.cylinders = tuple(dict.fromkeys(cylinders))
        texts = [text for i, curve in self.curves.items() for text in (self.bands[i].name, _lift_text(curve))]
        widest = max(map(QFontMetricsF(font(SMALL, bold=True)).horizontalAdvance, texts))
        self.left = min(widest, sized(NAMES)) + 18.0 + sized(LIFTS)
        self.band_height = max((height - TOP - self.footer_height) / len(self.cylinders), 24.0)
        self._room = sized(TEXT_HEIGHT) + 4.0

    @staticmethod
    def panel_count(design: Design) -> int:
        """Number of cylinders of a design with valves."""
        return len({curve.timing.cylinder for curve in crank_curves(design)})

    def _band(self, name: str, curve: CrankCurve) -> MotionBand:
        joins = (curve.centre, *(angle for _, angle, _ in curve.edges))
        return MotionBand(name, curve.crank, curve.lift / self.most, float(curve.lift.max()), "mm", joins, ())

    # -- positions -------------------------------------------------------------------------------------

    @property
    def degree(self) -> float:
        """Pixels per degree of the crank."""
        return (self.right - self.left) / (2.0 * HALF_CYCLE)

    def x(self, angle: Any) -> Any:
        """Horizontal position of a crank angle -360 ... 360."""
        return self.left + (angle + HALF_CYCLE) * self.degree

    def angle(self, x: float) -> float:
        """Machine angle at a horizontal position, 0 ... 360."""
        return (self._crank(x) / 2.0) % 360.0

    def _crank(self, x: float) -> float:
        return min(max((x - self.left) / self.degree - HALF_CYCLE, -HALF_CYCLE), HALF_CYCLE)

    def box(self, index: int) -> QRectF:
        """Box of the panel of a drive's cylinder."""
        return self._panel(self.cylinders.index(self.curves[index].timing.cylinder))

    def _panel(self, row: int) -> QRectF:
        return QRectF(self.left, TOP + row * self.band_height, self.right - self.left, self.band_height)

    def y(self, index: int, level: Any) -> Any:
        """Vertical position of a lift, as a fraction of the greatest, in the panel of a drive."""
        box = self.box(index)
        low, high = box.bottom() - 4.0, box.top() + self._room
        return low - level * (low - high)

    def band_at(self, point: QPointF) -> int | None:
        """Number of the drive whose name, or whose lift curve from the axis up, is at a point; of two the nearer centre."""
        for drive, box in self._names:
            if box.contains(point):
                return drive
        if not self.left <= point.x() <= self.right:
            return None
        crank, under = self._crank(point.x()), []
        for drive, curve in self.curves.items():
            level = float(np.interp(crank, curve.crank, curve.lift)) / self.most
            top = self.y(drive, level)
            if level > 0.0 and top - REACH <= point.y() <= self.box(drive).bottom():
                under.append((abs(within_cycle(crank - curve.centre)), drive))
        return min(under)[1] if under else None

    def join_at(self, point: QPointF) -> tuple[int, int] | None:
        """Drive and edge at a point."""
        joins = [
            (hypot(p.x() - point.x(), p.y() - point.y()), (drive, join))
            for drive, curve in self.curves.items()
            for join in range(1, len(curve.edges) + 1)
            for p in (self.join_position(drive, join),)
        ]
        distance, nearest = min(joins, default=(REACH + 1.0, (0, 0)))
        return nearest if distance <= REACH else None

    def row_at(self, point: QPointF) -> int | None:
        """None: sequence conditions are not shown here."""
        return None

    @cached_property
    def _names(self) -> list[tuple[int, QRectF]]:
        """Drive and box of each name, in its panel from the top down."""
        names, height = [], 2.0 * sized(TEXT_HEIGHT) + 6.0
        for row, cylinder in enumerate(self.cylinders):
            drives = [i for i, curve in self.curves.items() if curve.timing.cylinder == cylinder]
            panel = self._panel(row)
            names += [
                (drive, QRectF(0.0, panel.top() + k * height, self.left - sized(LIFTS) - 6.0, height))
                for k, drive in enumerate(drives)
                if (k + 1) * height <= panel.height()
            ]
        return names

    # -- values ----------------------------------------------------------------------------------------

    def lines(self, pair: Sequence[int]) -> list[tuple[str, bool]]:
        """Lines below the chart in a file: timing of each valve, and of inlet and exhaust valve of each cylinder."""
        texts = [event_words(curve.timing) for curve in self.curves.values()]
        texts += [
            f"{curve.timing.name}: least clearance to the piston {brief(curve.least_clearance, 'mm')}"
            for curve in self.curves.values()
            if curve.least_clearance is not None
        ]
        texts += [f"{both.inlet.name} and {both.exhaust.name}: {pair_text(both)}" for _, _, both in self.pairs]
        return [(text, False) for text in texts]

    # -- painting --------------------------------------------------------------------------------------

    def paint(self, painter: QPainter, shown: ChartHighlights) -> None:
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(font(SMALL))
        for drive, curve in self.curves.items():
            for part in self._areas(drive, curve.crank, curve.lift):
                painter.setPen(Qt.PenStyle.NoPen)
                painter.setBrush(QColor(tint(self.theme.drive(drive), self.theme.paper)))
                painter.drawPolygon(part)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        self._paint_axis(painter)
        for row in range(len(self.cylinders)):
            self._paint_lifts(painter, self._panel(row))
        for drive, curve in self.curves.items():
            self._paint_piston(painter, drive, curve)
        self._paint_overlaps(painter)
        for drive, curve in self.others.items():
            self._paint_lift(painter, drive, curve, THIN, DASHED)
        for drive, curve in self.curves.items():
            self._paint_lift(painter, drive, curve, 2.0 if drive == shown.selected else OUTLINE)
        self._paint_names(painter, shown.selected)
        self._paint_points(painter, shown)
        self._paint_label(painter, shown)
        painter.restore()

    def paint_cursor(self, painter: QPainter, machine: float) -> None:
        """Paint a line at a machine angle [deg]."""
        x = self.x(within_cycle(CRANK_PER_CAM * machine))
        painter.setPen(self._pen(self.theme.ink))
        painter.drawLine(QPointF(x, TOP), QPointF(x, self.height - self.footer_height + 4.0))

    def _line(self, drive: int, crank: np.ndarray, lift: np.ndarray) -> QPolygonF:
        x, y = self.x(crank), self.y(drive, lift / self.most)
        return QPolygonF(list(map(QPointF, x.tolist(), y.tolist())))

    def _areas(self, drive: int, crank: np.ndarray, lift: np.ndarray) -> Iterator[QPolygonF]:
        """Areas below a lift, one for each run of angles at which it is positive."""
        is_open = np.concatenate(([False], lift > 0.0, [False]))
        ends = np.flatnonzero(is_open[1:] != is_open[:-1])
        for begin, end in zip(ends[::2].tolist(), ends[1::2].tolist(), strict=True):
            run = slice(max(begin - 1, 0), end + 1)
            area, base = self._line(drive, crank[run], lift[run]), self.y(drive, 0.0)
            area.append(QPointF(area.last().x(), base))
            area.append(QPointF(area.first().x(), base))
            yield area

    def _paint_lift(
        self, painter: QPainter, drive: int, curve: CrankCurve, width: float, dash: tuple[float, ...] = ()
    ) -> None:
        painter.setPen(self._pen(self.theme.drive(drive), width, dash))
        painter.drawPolyline(self._line(drive, curve.crank, curve.lift))

    def _paint_piston(self, painter: QPainter, drive: int, curve: CrankCurve) -> None:
        """Paint the lift at which a valve would touch the piston, and dotted the clearance, as far as they are in the panel."""
        if curve.clearance is None or curve.piston is None:
            return
        painter.save()
        painter.setClipRect(self.box(drive))
        for values, dash in ((curve.piston, ()), (curve.clearance, DOTTED)):
            painter.setPen(self._pen(self.theme.drive(drive), THIN, dash))
            painter.drawPolyline(self._line(drive, curve.crank, np.minimum(values, 2.0 * self.most)))
        painter.restore()

    def _paint_axis(self, painter: QPainter) -> None:
        room = max(int((self.right - self.left) / (self._metrics.horizontalAdvance("-0000") + 14.0)), 4)
        step = next((step for step in STEPS if 2.0 * HALF_CYCLE / step <= room), STEPS[-1])
        half = int(HALF_CYCLE)
        self._paint_marks(painter, [(float(crank), short(crank)) for crank in range(-half, half + 1, step)])
        for row, later in enumerate(self.cylinders):
            self._paint_dead_centres(painter, self._panel(row), later)
        self._paint_axis_name(painter, "Crank angle from TDC of overlap [°]")

    def _paint_dead_centres(self, painter: QPainter, panel: QRectF, later: float) -> None:
        """Mark TDC and BDC of a cylinder; its TDC of overlap is that many crank degrees later than the machine's."""
        centres = {within_cycle(crank + later): text for crank, text in DEAD_CENTRES}
        if -HALF_CYCLE in centres:
            centres[HALF_CYCLE] = centres[-HALF_CYCLE]
        for crank, text in centres.items():
            x, width = self.x(crank), self._metrics.horizontalAdvance(text) + 6.0
            painter.setPen(self._pen(self.theme.quiet))
            painter.drawLine(QPointF(x, panel.top()), QPointF(x, panel.bottom()))
            left = min(max(x - width / 2.0, self.left), self.right - width)
            box = QRectF(left, panel.top(), width, sized(TEXT_HEIGHT))
            painter.fillRect(box, brush(self.theme.paper, 0.85))
            painter.setPen(QColor(self.theme.ink))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def _paint_lifts(self, painter: QPainter, panel: QRectF) -> None:
        """Axis of the lift at the left of a panel, with round values in the preferred unit."""
        low, high = panel.bottom() - 4.0, panel.top() + self._room
        most = self.most / size_of("mm")
        values, _ = ticks(0.0, most, min(max(int((low - high) / (2.0 * sized(TEXT_HEIGHT))), 1), LIFT_TICKS))
        painter.setPen(self._pen(self.theme.quiet))
        painter.drawLine(QPointF(self.left, low), QPointF(self.right, low))
        painter.drawLine(QPointF(self.left, panel.top()), QPointF(self.left, low))
        unit = QRectF(self.left - sized(LIFTS), panel.top(), sized(LIFTS) - 5.0, sized(TEXT_HEIGHT))
        painter.drawText(unit, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, symbol_of("mm"))
        for value in values:
            y = low - value / most * (low - high)
            painter.setPen(self._pen(self.theme.quiet))
            painter.drawLine(QPointF(self.left - 3.0, y), QPointF(self.left, y))
            painter.setPen(QColor(self.theme.ink))
            box = QRectF(self.left - sized(LIFTS), y - 7.0, sized(LIFTS) - 5.0, 14.0)
            painter.drawText(box, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, short(value))

    def _paint_overlaps(self, painter: QPainter) -> None:
        """Shade the smaller of the lifts of inlet and exhaust valve, with separation and overlap above it."""
        for inlet, exhaust, pair in self.pairs:
            crank = np.union1d(inlet.crank, exhaust.crank)
            lift = np.minimum(*(np.interp(crank, curve.crank, curve.lift) for curve in (inlet, exhaust)))
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(brush(self.theme.limit, OVERLAP))
            for area in self._areas(inlet.drive, crank, lift):
                painter.drawPolygon(area)
            painter.setBrush(Qt.BrushStyle.NoBrush)
            self._paint_pair_texts(painter, pair, self.box(inlet.drive).top() + sized(TEXT_HEIGHT) + 2.0)

    def _paint_pair_texts(self, painter: QPainter, pair: ValvePair, top: float) -> None:
        """Write overlap, separation and advance below each other at TDC of overlap, where the lobes leave room at the top."""
        painter.setPen(QColor(self.theme.limit))
        x = self.x(pair.inlet.cylinder)
        *others, longest = pair_text(pair).split(", ")
        for row, text in enumerate((longest, *others)):
            width = self._metrics.horizontalAdvance(text) + 6.0
            left = min(max(x - width / 2.0, self.left), self.right - width)
            box = QRectF(left, top + row * sized(TEXT_HEIGHT), width, sized(TEXT_HEIGHT))
            painter.fillRect(box, brush(self.theme.paper, 0.85))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def _paint_names(self, painter: QPainter, selected: int) -> None:
        for drive, box in self._names:
            curve, colour = self.curves[drive], self.theme.drive(drive)
            painter.fillRect(
                QRectF(0.0, box.top() + 3.0, 6.0 if drive == selected else 4.0, box.height() - 6.0), brush(colour)
            )
            below = _lift_text(curve)
            for text, top, ink, bold in ((self.bands[drive].name, 2.0, self.theme.ink, drive == selected),
                                         (below, 2.0 + sized(TEXT_HEIGHT), self.theme.quiet, False)):  # fmt: skip
                painter.setFont(font(SMALL, bold=bold))
                painter.setPen(QColor(ink))
                row = QRectF(10.0, box.top() + top, box.width() - 10.0, sized(TEXT_HEIGHT))
                cut = self._metrics.elidedText(text, Qt.TextElideMode.ElideRight, row.width())
                painter.drawText(row, Qt.AlignmentFlag.AlignVCenter, cut)
        painter.setFont(font(SMALL))

    def _paint_points(self, painter: QPainter, shown: ChartHighlights) -> None:
        """Paint the edges as points, and the centre as a line where it is highlighted."""
        for drive, curve in self.curves.items():
            colour = self.theme.drive(drive)
            painter.setPen(self._pen(colour, OUTLINE))
            if (drive, 0) in shown.joins:
                x = self.x(curve.centre)
                painter.drawLine(
                    QPointF(x, self.y(drive, float(curve.lift.max()) / self.most)), QPointF(x, self.y(drive, 0.0))
                )
            for join in range(1, len(curve.edges) + 1):
                highlighted, point = (drive, join) in shown.joins, self.join_position(drive, join)
                painter.setBrush(brush(colour if highlighted else self.theme.paper))
                radius = POINT + (1.5 if highlighted else 0.0)
                painter.drawEllipse(point, radius, radius)
        painter.setBrush(Qt.BrushStyle.NoBrush)

    def _label_top(self, drive: int) -> float:
        return self.box(drive).bottom() + 2.0


def _lift_text(curve: CrankCurve) -> str:
    """Greatest lift of a valve, such as ``valve lift 9 mm``."""
    return f"{curve.quantity} {brief(float(curve.lift.max()), 'mm', 4)}"


def _same_names(curves: dict[int, CrankCurve], design: Design) -> dict[int, CrankCurve]:
    """Curves of the valves of another design, by the drives with their names."""
    try:
        named = {curve.timing.name: curve for curve in crank_curves(design)}
    except KindynaError:
        return {}
    return {i: named[curve.timing.name] for i, curve in curves.items() if curve.timing.name in named}
