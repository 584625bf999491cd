"""Stability chart: tongues of instability over frequency ratio and inertia ratio, with the machine's operating point."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import isfinite
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QPainterPath
from PySide6.QtWidgets import QWidget

from core.frozen import frozen
from core.output.drawing.palette import BLUE, VERMILION
from core.stability import APPROXIMATE, EXACT, Chart, ForbiddenBand, Machine
from kindyna_gui.pictures.items import Outline, Tag, text_size
from kindyna_gui.pictures.plots.lines import Entry
from kindyna_gui.pictures.plots.plot import LEAST_ACROSS, FixedPlot, value_ticks
from kindyna_gui.pictures.shapes import joined
from kindyna_gui.pictures.style import DASHED, SCREEN, SMALL, Theme, brush
from kindyna_gui.pictures.units import short

LEAST_ETA = 0.42  # η at the end of the rpm axis, beyond the first tongue ...
SPEED_MULTIPLES = (1.25, 8.0)  # ... but the end is between these multiples of the machine's speed
Z_TONGUE, Z_PATH, Z_POINT = 0.0, 10.0, 20.0
PATH_OPACITY, FADED = 0.55, 0.35
NAMES = (
    Entry(VERMILION, "unstable: linearised, exact (21)"),
    Entry(BLUE, "edges: linearised, approximate (22)", "– –"),
)
PLAIN_NAMES = (Entry(VERMILION, "forbidden: the twist of the shaft grows"),)
BESIDE, LEAST_ROOM = 0.08, 0.01  # room beside the nearest bands, as a share of their range, and of the machine's speed


@frozen
class AxisQuantity:
    """Quantity of an axis of the chart.

    Attributes
    ----------
    label, title : short name, and title of the axis
    from_ratio : value of the axis for η or Q (n,) of a machine
    to_ratio : η or Q for a value of the axis
    """

    label: str
    title: str
    from_ratio: Callable[[np.ndarray, Machine], np.ndarray]
    to_ratio: Callable[[float, Machine], float]


def _rpm(eta: np.ndarray, machine: Machine) -> np.ndarray:
    with np.errstate(divide="ignore"):
        return machine.rpm(1.0) / eta


ACROSS: Mapping[str, AxisQuantity] = MappingProxyType(
    {
        "eta": AxisQuantity("η", "Frequency ratio η = ω₀/ω", lambda e, m: e, lambda x, m: x),
        "rpm": AxisQuantity("rpm", "Speed, rpm", _rpm, lambda x, m: m.rpm(1.0) / max(x, 1e-300)),
    }
)
UPWARDS: Mapping[str, AxisQuantity] = MappingProxyType(
    {
        "q": AxisQuantity("Q", "Inertia ratio Q", lambda q, m: q, lambda y, m: y),
        "mass": AxisQuantity("masses", "Moving masses, × current", lambda q, m: q / m.q, lambda y, m: y * m.q),
    }
)


class ChartPlot(FixedPlot):
    """Plot of a stability chart; ``position`` and ``point_at`` convert (η, Q) to the axes and from pixels.

    Attributes
    ----------
    chart : chart that is drawn, None before the first one
    machine_point : dot at the machine's operating point
    ring : circle around the selected point
    is_plain : whether it is drawn over the machine's speed, without the ratios of the paper
    """

    def __init__(self, parent: QWidget | None = None, theme: Theme = SCREEN) -> None:
        super().__init__(parent, theme, top=True)
        self.setAntialiasing(True)
        self.setAccessibleName("Chart of stability")
        self.chart: Chart | None = None
        self._across, self._upwards = "eta", "q"
        self.is_plain = False
        self._orders: tuple[int, ...] = ()  # numbers of the bands that are named; empty: all
        exact, approximate = theme.seen(VERMILION), theme.seen(BLUE)
        self._hull = self._outline(exact, Z_TONGUE - 1.0, fill=brush(exact, 0.12))
        self._exact = self._outline(exact, Z_TONGUE, fill=brush(exact, 0.22))
        self._approximate = self._outline(approximate, Z_TONGUE - 0.5, DASHED)
        self._marked = self._outline(theme.quiet, Z_PATH - 1.0, (2.0, 4.0))
        self._path = self._outline(theme.ink, Z_PATH)
        self._path.setOpacity(PATH_OPACITY)
        dot, ring = QPainterPath(), QPainterPath()
        dot.addEllipse(QRectF(-4.5, -4.5, 9.0, 9.0))
        ring.addEllipse(QRectF(-6.0, -6.0, 12.0, 12.0))
        self.machine_point = self._dot(dot, theme.ink, Z_POINT)
        self.ring = self._dot(ring, "", Z_POINT + 1.0)
        self._tag = Tag("", theme.ink, theme, SMALL, (0.0, 1.0), backing=True)
        self._include(self._tag, Z_POINT)
        self.ring.hide()
        self.machine_point.hide()
        self._name(NAMES)

    def _dot(self, path: QPainterPath, colour: str, z: float) -> Outline:
        item = Outline(path, self._theme.pen(self._theme.ink, 1.5), brush(colour) if colour else None)
        item.setFlag(item.GraphicsItemFlag.ItemIgnoresTransformations)
        self._include(item, z)
        return item

    # -- chart ----------------------------------------------------------------------------------------------

    def show_chart(self, chart: Chart, across: str = "eta", upwards: str = "q") -> None:
        """Draw a chart with the axes ``across`` and ``upwards``, keys of ``ACROSS`` and ``UPWARDS``."""
        if chart.machine is None:
            across, upwards = "eta", "q"
        self._across, self._upwards, self.is_plain, self.chart = across, upwards, False, chart
        self._orders = ()
        last = self._x(np.array([chart.eta_max]))[0] if across == "eta" else self._fastest(chart)
        self._name(NAMES)
        self._show((0.0, float(last)))

    def show_speeds(self, chart: Chart, bands: Sequence[ForbiddenBand]) -> None:
        """Draw the chart of a machine over its speed, from the lowest to the highest of some bands and the machine's speed."""
        assert chart.machine is not None
        self._across, self._upwards, self.is_plain, self.chart = "rpm", "mass", True, chart
        self._orders = tuple(sorted(band.n for band in bands))
        speed = chart.machine.rpm(chart.machine.eta)
        speeds = [speed, *(end for band in bands for end in (band.rpm_lo, band.rpm_hi) if isfinite(end))]
        low, high = (min(speeds), max(speeds)) if len(speeds) > 1 else (0.0, 2.0 * speed)
        room = max(BESIDE * (high - low), LEAST_ROOM * speed)
        self._name(PLAIN_NAMES)
        self._show((max(low - room, 0.0), high + room))

    def _show(self, across: tuple[float, float]) -> None:
        """Draw the chart over this range of the horizontal axis."""
        chart = self.chart
        assert chart is not None
        top = float(chart.q[-1]) if chart.q.size > 1 else 1.2 * float(chart.q[0])
        self._view.setRange(xRange=across, yRange=(0.0, float(self._y(np.array([top]))[0])), padding=0.0)
        self._exact.redraw(self._tongues(chart, EXACT))
        self._approximate.redraw(QPainterPath() if self.is_plain else self._tongues(chart, APPROXIMATE))
        self._hull.redraw(self._bottom(chart))
        self._marked.redraw(self._rows(chart))
        self._draw_machine(chart.machine)
        self.setAccessibleDescription(
            f"{ACROSS[self._across].title} across, {UPWARDS[self._upwards].title} upwards; {self._tag.text}"
        )
        self._lay()

    def _fastest(self, chart: Chart) -> float:
        """End of the rpm axis."""
        assert chart.machine is not None
        speed = chart.machine.rpm(chart.machine.eta)
        least, greatest = (multiple * speed for multiple in SPEED_MULTIPLES)
        return min(max(chart.machine.rpm(LEAST_ETA), least), greatest)

    def _x(self, eta: np.ndarray) -> np.ndarray:
        return ACROSS[self._across].from_ratio(eta, self._machine)

    def _y(self, q: np.ndarray) -> np.ndarray:
        return UPWARDS[self._upwards].from_ratio(q, self._machine)

    @property
    def _machine(self) -> Machine:
        assert self.chart is not None
        return self.chart.machine  # type: ignore[return-value]  # axes that need a machine are not selected without

    def _tongues(self, chart: Chart, equation: str) -> QPainterPath:
        path = QPainterPath()
        if equation not in chart.tongues:
            return path
        tongues, machine = chart.tongues[equation], chart.machine
        # the coarse chart lacks damping: of its tongues only those of the bands are open at the machine's masses
        is_undamped = self.is_plain and machine is not None and tongues.damping < machine.damping
        for n in self._orders if is_undamped else range(1, tongues.count + 1):
            for polygon in chart.outline(n, equation):
                self._add(path, polygon)
        return path

    def _add(self, path: QPainterPath, polygon: np.ndarray) -> None:
        """Add a polygon (n, 2) of (η, Q), clipped near the ends of the axis so that no point is at infinity."""
        (low, high), _ = self._view.viewRange()
        x = np.clip(self._x(polygon[:, 0]), low - 1.0 * (high - low), high + 1.0 * (high - low))
        y = self._y(polygon[:, 1])
        for i, (a, b) in enumerate(zip(x.tolist(), y.tolist(), strict=True)):
            path.lineTo(a, b) if i else path.moveTo(a, b)
        if len(polygon):
            path.closeSubpath()

    def _bottom(self, chart: Chart) -> QPainterPath:
        """Area below the lowest edge, where every design is unstable."""
        path = QPainterPath()
        exact = chart.tongues.get(EXACT)
        if exact is not None and (exact.bottom > 0.0).any():
            q, edge = chart.q, exact.bottom
            zero = np.full(q.size, 1e-9)
            polygon = np.concatenate((np.column_stack((edge, q)), np.column_stack((zero, q))[::-1]))
            self._add(path, polygon)
        return path

    def _rows(self, chart: Chart) -> QPainterPath:
        """Horizontal lines at the marked values of Q."""
        frame = self.frame()
        return joined(*(frame.horizontal(float(self._y(np.array([q]))[0])) for q in chart.marked))

    def fade(self, on: bool) -> None:
        """Fade the chart while another one is computed in the background."""
        items = (self._hull, self._exact, self._approximate, self.machine_point)
        for item, opacity in (*((item, 1.0) for item in items), (self._path, PATH_OPACITY)):
            item.setOpacity(FADED * opacity if on else opacity)

    def _draw_machine(self, machine: Machine | None) -> None:
        """Draw the operating point, and the run-up to it from standstill, η = ∞."""
        self.machine_point.setVisible(machine is not None)
        self._tag.setVisible(machine is not None)
        path = QPainterPath()
        if machine is not None:
            at = self.position(machine.eta, machine.q)
            (low, high), (_, top) = self._view.viewRange()
            start = high if self._across == "eta" else low
            if low <= at.x() <= high:
                path.moveTo(start, at.y())
                path.lineTo(at)
            self.machine_point.setPos(at)
            self.machine_point.setVisible(low <= at.x() <= high and at.y() <= top)
            beyond = " →" if at.x() > high else " ↑" if at.y() > top else ""
            ratios = "" if self.is_plain else f", η = {short(machine.eta, 3)}, Q = {short(machine.q, 3)}{beyond}"
            self._tag.set_text(f"{short(machine.rpm(machine.eta))} rpm{ratios}")
            right = (high - at.x()) / (high - low) * self._view.width() > self._tag.size[0] + 14.0
            self._tag.set_lean(0.0 if right else 1.0, 1.0)
            self._tag.shift(7.0 if right else -7.0, -6.0)
            self._tag.setPos(min(max(at.x(), low), high), min(at.y(), top))
        self._path.redraw(path)

    def move_machine_point(self, eta: float, q: float) -> None:
        """Draw the machine's point at other ratios until the chart is shown again."""
        self.machine_point.setPos(self.position(eta, q))
        self._tag.setVisible(False)

    def ring_point(self, eta: float | None, q: float = 0.0) -> None:
        """Draw a circle around the selected point, or none."""
        self.ring.setVisible(eta is not None)
        if eta is not None:
            self.ring.setPos(self.position(eta, q))

    # -- coordinates ----------------------------------------------------------------------------------------

    def position(self, eta: float, q: float) -> QPointF:
        """Coordinates of a point (η, Q) on the axes."""
        return QPointF(float(self._x(np.array([eta]))[0]), float(self._y(np.array([q]))[0]))

    def pixel(self, eta: float, q: float) -> QPointF:
        """Pixel of a point (η, Q) in the widget."""
        return self.to_pixel(self.position(eta, q))

    def point_at(self, pixel: QPointF) -> tuple[float, float] | None:
        """η and Q at a pixel of the widget; None outside the chart."""
        if self.chart is None:
            return None
        at = self.to_axes(pixel)
        (low, high), (bottom, top) = self._view.viewRange()
        if not (low < at.x() <= high and bottom < at.y() <= top):
            return None
        across, upwards = ACROSS[self._across], UPWARDS[self._upwards]
        return across.to_ratio(at.x(), self._machine), upwards.to_ratio(at.y(), self._machine)

    # -- layout ---------------------------------------------------------------------------------------------

    def _lay(self, *_: object) -> None:
        frame = self.frame()
        across = value_ticks(frame.first, frame.last, frame.width, LEAST_ACROSS)
        self.draw_axes(frame, across, value_ticks(frame.low, frame.high, frame.height))
        self._axes["bottom"].show_title(ACROSS[self._across].title, self._theme.ink)
        self._axes["left"].show_title(UPWARDS[self._upwards].title, self._theme.ink)
        self._axes["top"].show_ticks(self._numbers(frame.first, frame.last, frame.width))
        if self.chart is not None:
            self._draw_machine(self.chart.machine)

    def _numbers(self, low: float, high: float, width: float) -> list[tuple[float, str]]:
        """Ticks with the numbers of the tongues, or of the nearest bands, over their tips, where there is room."""
        if self.chart is None or EXACT not in self.chart.tongues:
            return []
        rows: list[tuple[float, str]] = []
        for n in self._orders or range(1, self.chart.tongues[EXACT].count + 1):
            x = float(self._x(np.array([0.5 * n]))[0])
            text = str(n) if n > 1 else f"order {n}" if self.is_plain else f"n = {n}"
            half = 0.5 * text_size(text)[0] * (high - low) / width
            is_free = all(abs(x - previous) > 2.6 * half for previous, _ in rows)
            if low + half < x < high - half and is_free:
                rows.append((x, text))
        return rows


__all__ = ["ACROSS", "UPWARDS", "AxisQuantity", "ChartPlot"]
