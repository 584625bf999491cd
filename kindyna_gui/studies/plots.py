"""Survey plots."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainterPath, QPen

from core.frozen import frozen
from core.varying import Survey
from kindyna_gui.pictures.items import Outline, Tag, wrapped
from kindyna_gui.pictures.plots.xy import REACH, Dots, DraggablePoint, Line, Rule, XYPlot
from kindyna_gui.pictures.style import PURPLE, SCREEN, SMALL, rgb
from kindyna_gui.pictures.units import short, ticks, with_unit

# -- lines of one level over a grid of values ------------------------------------------------------------


def level_line(x: np.ndarray, y: np.ndarray, z: np.ndarray, level: float) -> tuple[np.ndarray, np.ndarray]:
    """Where values z (m, n) at x (n,) and y (m,), linear on the two triangles of each cell, reach a level: x and y of pieces of two
    points, parted by NaN. A triangle with a corner that has no value has no line."""
    corners = np.stack([*np.meshgrid(x, y), z], axis=-1)
    a, b, c, d = corners[:-1, :-1], corners[:-1, 1:], corners[1:, 1:], corners[1:, :-1]
    every = np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)]).reshape(-1, 3, 3)
    above = every[..., 2] > level
    through = np.isfinite(every[..., 2]).all(axis=1) & above.any(axis=1) & ~above.all(axis=1)
    cut, above = every[through], above[through]
    alone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), above.argmin(axis=1))  # on its side of the level
    row = np.arange(alone.size)
    ends = np.full((alone.size, 3, 2), np.nan)
    first = cut[row, alone]
    for i in (1, 2):
        other = cut[row, (alone + i) % 3]
        part = (level - first[:, 2]) / (other[:, 2] - first[:, 2])
        ends[:, i - 1] = first[:, :2] + part[:, None] * (other - first)[:, :2]
    return ends[..., 0].ravel(), ends[..., 1].ravel()


# -- plots -----------------------------------------------------------------------------------------------

FAINT, FULL, PASSED = 0.08, 0.72, 0.3  # opacity of the least value, of the greatest; what of it is left beyond a limit
LEVELS = 7
CROSS, GAP = 11.0, 3.5  # pixels
Z_OWN = 60.0
OF_LEVELS, OF_LIMITS = (0.72, 0.3), (0.24, 0.72)  # parts of width and height near which their texts stand
LABEL_FIGURES = 4
WIDE = 44.0  # pixels between upright axes, from which on their ends have four digits
THROUGH = 0.3  # opacity of the lines of kept designs


@frozen
class Measured:
    """A quantity as a survey shows it: key, name, unit, colour, and the limits that it is held to, None where there are none."""

    key: str
    name: str
    unit: str
    colour: str
    least: float | None = None
    most: float | None = None

    @property
    def title(self) -> str:
        return f"{self.name}, {self.unit}" if self.unit else self.name

    @property
    def limits(self) -> tuple[float, ...]:
        return tuple(limit for limit in (self.least, self.most) if limit is not None)

    def kept(self, value: np.ndarray) -> np.ndarray:
        """Whether each value keeps the limits."""
        low, high = -np.inf if self.least is None else self.least, np.inf if self.most is None else self.most
        return np.asarray((value >= low) & (value <= high))

    def text(self, value: float) -> str:
        return with_unit(short(value, LABEL_FIGURES + 1), self.unit)


class SurveyPlot(DraggablePoint, XYPlot):
    """A plot in which the design stands as a cross, or, where the plot is over one number, as an upright line."""

    def __init__(self, upright: bool = False) -> None:
        super().__init__("", "")
        self._upright = upright
        self.own: tuple[float, float] | None = None
        self._cross = Outline(_cross(), self._theme.pen(self._theme.ink, 1.8))
        self._cross.setFlag(self._cross.GraphicsItemFlag.ItemIgnoresTransformations)
        self._line = self._outline(self._theme.ink, Z_OWN)
        self._include(self._cross, Z_OWN)
        self._texts: list[Tag] = []
        self._boxes: list[QRectF] = []  # of them, in pixels from the lower left corner
        self._path = self._outline(self._theme.ink, Z_OWN - 2.0)
        self._path.setPen(self._theme.pen(self._theme.seen(PURPLE), 1.6))
        self.path = np.zeros((0, 2))
        self.place_own(None)

    def place_own(self, at: tuple[float, float] | None, refused: bool = False) -> None:
        """Where the design stands; None: nowhere that is seen. refused: it cannot be built there."""
        self.own = at
        (low, high), (bottom, top) = self._view.viewRange()
        seen = at is not None and self._filled and low <= at[0] <= high and (self._upright or bottom <= at[1] <= top)
        pen = self._theme.pen(self._theme.limit if refused else self._theme.ink, 1.8)
        self._cross.setPen(pen)
        self._line.setPen(pen)
        self._cross.setVisible(seen and not self._upright)
        self._line.setVisible(seen and self._upright)
        if at is not None and seen:
            self._cross.setPos(*at)
            path = QPainterPath(QPointF(at[0], bottom))
            path.lineTo(at[0], top)
            self._line.redraw(path)

    def show_path(self, points: np.ndarray, starts: np.ndarray) -> None:
        """The way of a search (m, 2), and which start each of its points comes from (m,)."""
        self.path, path = points, QPainterPath()
        if points.shape[1:] == (2,) and self._filled:
            for i, (x, y) in enumerate(points.tolist()):
                path.lineTo(x, y) if i and starts[i] == starts[i - 1] else path.moveTo(x, y)
        self._path.redraw(path)

    def point_at(self, pixel: QPointF) -> tuple[float, float] | None:
        if not self._filled:
            return None
        at = self._view.mapSceneToView(self.mapToScene(pixel.toPoint()))
        (low, high), (bottom, top) = self._view.viewRange()
        inside = low <= at.x() <= high and bottom <= at.y() <= top
        if self._is_dragging:  # the mouse may leave the plot; the point stays at its edge
            return min(max(at.x(), low), high), min(max(at.y(), bottom), top)
        return (at.x(), at.y()) if inside else None

    def pixel(self, x: float, y: float) -> QPointF:
        """Where a point stands in the widget."""
        return QPointF(self.mapFromScene(self._view.mapViewToScene(QPointF(x, y))))

    def own_pixel(self) -> QPointF | None:
        shown = self._line if self._upright else self._cross
        return self.pixel(*self.own) if self.own is not None and shown.isVisible() else None

    def _is_over_point(self, place: QPointF) -> bool:
        own = self.own_pixel()
        if own is None or not self._upright:
            return super()._is_over_point(place)
        return abs(own.x() - place.x()) <= REACH

    # -- over one number -------------------------------------------------------------------------------------

    def show_curve(self, x: np.ndarray, y: np.ndarray, of: Measured, across: str) -> None:
        """A quantity over the number, with its limits."""
        self._forget_texts()
        if not np.isfinite(y).any():
            self.show_message(f"{of.name}: no design between the bounds has a value.")
            return
        self.name_axes(across, of.title, of.colour)
        rules = [Rule(limit, of.text(limit), self._theme.limit, level=True) for limit in of.limits]
        shown = np.where(np.isfinite(y), y, np.nan)
        pins = Dots(np.full(len(of.limits), x[0]), np.array(of.limits), self._theme.limit, size=0.0)
        self.show_lines([Line(x, shown, of.colour)], rules=rules, dots=[pins] if of.limits else [], fit=True)
        self.show_range((float(x[0]), float(x[-1])))
        self.place_own(self.own)

    # -- over two --------------------------------------------------------------------------------------------

    def show_map(
        self,
        found: Survey,
        shown: Measured,
        others: Sequence[Measured],
        titles: tuple[str, str],
    ) -> None:
        """A quantity as colour and lines of one level over two numbers x (n,) and y (m,); the limits of all as lines with their value,
        beyond them the colour is pale; grey where nothing can be built. Limits and colours are those of the finer cells."""
        (x, y), fine_axes = found.axes(), found.axes(found.is_refined)
        self._forget_texts()
        self.name_axes(*titles)
        own = np.where(found.reason == "", found.value[shown.key], np.nan)
        z, fine = found.grid(own), found.grid(own, found.is_refined)
        lines, texts = [], []
        for level in _levels(z):
            cut = level_line(x, y, z, level)
            lines.append(Line(*cut, self._theme.ink))
            texts.append((short(level, LABEL_FIGURES), self._theme.ink, cut, OF_LEVELS))
        within = np.ones(fine.shape, dtype=bool)
        for each in others:
            value = found.grid(np.where(found.reason == "", found.value[each.key], np.nan), found.is_refined)
            within &= each.kept(value) | ~np.isfinite(value)
            for limit in each.limits:
                cut = level_line(*fine_axes, value, limit)
                if cut[0].size:
                    lines.append(Line(*cut, self._theme.limit, width=2))
                    texts.append((f"{each.name} {each.text(limit)}", self._theme.limit, cut, OF_LIMITS))
        named = Line(x[[0, -1]], np.array([y[0], np.nan]), shown.colour, _note(shown, z))
        self.show_lines([named, *(line for line in lines if line.x.size)], fit=True)
        for item in self._drawn:  # of short pieces, between which there would be gaps
            pen = QPen(item.opts["pen"])
            pen.setCapStyle(Qt.PenCapStyle.RoundCap)
            item.setPen(pen)
        half_x, half_y = (0.5 * (each[1] - each[0]) for each in fine_axes)
        place = QRectF(x[0] - half_x, y[0] - half_y, x[-1] - x[0] + 2.0 * half_x, y[-1] - y[0] + 2.0 * half_y)
        self.show_image(_coloured(fine, within, shown.colour), place)
        self.show_range((float(x[0]), float(x[-1])), (float(y[0]), float(y[-1])))
        for text, colour, cut, near in reversed(texts):  # limits first
            self._write_on(text, colour, cut, near)
        self.place_own(self.own)

    def _write_on(self, text: str, colour: str, cut: tuple[np.ndarray, np.ndarray], near: tuple[float, float]) -> None:
        """A text on a line, where it comes nearest to a part of width and height and no other text stands."""
        (low, high), (bottom, top) = self._view.viewRange()
        across, up = (cut[0] - low) / (high - low), (cut[1] - bottom) / (top - bottom)
        away = np.hypot(across - near[0], up - near[1])
        tag = Tag(text, colour, self._theme, SMALL, (0.5, 0.5), backing=True)
        half = 0.5 * tag.size[0] / self._view.width()
        for at in np.argsort(away)[: int(np.isfinite(away).sum())].tolist():
            middle = min(max(float(across[at]), half), 1.0 - half)
            tag.set_lean(0.5 + (float(across[at]) - middle) / (2.0 * half), 0.5)
            box = tag.pixel_box().translated(across[at] * self._view.width(), -up[at] * self._view.height())
            if not any(box.intersects(other) for other in self._boxes):
                self._boxes.append(box.adjusted(-4.0, -2.0, 4.0, 2.0))
                self._include(tag, Z_OWN - 1.0)
                tag.setPos(float(cut[0][at]), float(cut[1][at]))
                self._texts.append(tag)
                return

    @property
    def texts(self) -> list[str]:
        """What stands on the lines of the map."""
        return [tag.text for tag in self._texts]

    def _forget_texts(self) -> None:
        for tag in self._texts:
            self._view.removeItem(tag)
        self._texts, self._boxes = [], []

    def show_message(self, text: str) -> None:
        if hasattr(self, "_texts"):  # not while the plot is being made
            self._forget_texts()
        super().show_message(text)
        if hasattr(self, "_texts"):
            self.place_own(None)


def _cross() -> QPainterPath:
    path = QPainterPath()
    for x, y in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
        path.moveTo(GAP * x, GAP * y)
        path.lineTo(CROSS * x, CROSS * y)
    path.addEllipse(QPointF(0.0, 0.0), 0.6 * CROSS, 0.6 * CROSS)
    return path


def _levels(z: np.ndarray) -> list[float]:
    """Round values, most of which some designs reach: those next to infinity do not count."""
    there = z[np.isfinite(z)]
    if there.size < 3:
        return []
    low, high = np.percentile(there, (0.5, 95.0))
    return ticks(float(low), float(high), LEVELS)[0] if high > low else []


def _scale(z: np.ndarray) -> tuple[float, float]:
    """Between which values colours differ; those next to infinity do not count."""
    there = z[np.isfinite(z)]
    low, high = (float(each) for each in np.percentile(there, (0.0, 98.0))) if there.size else (0.0, 1.0)
    return low, high if high > low else low + 1.0


def _note(of: Measured, z: np.ndarray) -> str:
    there = z[np.isfinite(z)]
    return f"{of.name} {of.text(float(there.min()))} … {of.text(float(there.max()))}" if there.size else of.name


def _coloured(z: np.ndarray, within: np.ndarray, colour: str) -> np.ndarray:
    """Colours (n, m, 4) of values (m, n)."""
    low, high = _scale(z[within] if np.isfinite(z[within]).any() else z)
    part = np.clip((z - low) / (high - low), 0.0, 1.0)
    made = np.empty((*z.shape, 4), dtype=np.ubyte)
    made[..., :3] = rgb(colour)
    strength = (FAINT + (FULL - FAINT) * np.nan_to_num(part)) * np.where(within, 1.0, PASSED)
    made[..., 3] = np.round(255.0 * strength)
    made[~np.isfinite(z)] = (*rgb(SCREEN.line), 255)
    return made.transpose(1, 0, 2)


class ParallelPlot(XYPlot):
    """Parallel coordinates: an upright axis for each number and each quantity, a line across all for each design. An axis is brushed by
    drawing along it; a click on it takes its brush away.

    brushes   number of the axis -> from where to where, in its unit
    brushed   another part of an axis counts
    hovered   (object): number of the design whose line is nearest to the mouse, None
    picked    (int): the same, clicked
    """

    brushed = Signal()
    hovered = Signal(object)
    picked = Signal(int)

    def __init__(self) -> None:
        super().__init__("", "")
        self.brushes: dict[int, tuple[float, float]] = {}
        self._rows = np.zeros((0, 0))
        self._ends = np.zeros((0, 2))
        self._kept = np.zeros(0, dtype=bool)
        self._titles_of: tuple[str, ...] = ()
        self._from: tuple[int, float] | None = None
        self._bars = self._outline(SCREEN.ink, Z_OWN)
        self._bars.setPen(self._theme.pen(self._theme.ink, 5.0))
        self._bars.setOpacity(0.45)
        self._path = self._outline(self._theme.ink, Z_OWN - 1.0)
        self._path.setPen(self._theme.pen(self._theme.seen(PURPLE), 1.2))
        self._path.setOpacity(0.6)
        self.path = np.zeros((0, 0))
        self._numbers: list[Tag] = []
        self.setMouseTracking(True)
        self.viewport().setMouseTracking(True)

    def show_designs(
        self,
        titles: Sequence[str],
        rows: np.ndarray,
        bounds: Sequence[tuple[float, float]],
        limits: Sequence[tuple[float, ...]],
        kept: np.ndarray,
        own: Sequence[float],
        colour: str,
    ) -> None:
        """Designs as rows of numbers (axes, m), NaN where there is none; bounds of the first axes; limits by axis; those that are kept
        in colour, the others faint; the design at hand in ink."""
        further = zip(rows[len(bounds) :], own[len(bounds) :], strict=True)
        ends = np.array([*bounds, *(_scale(np.append(row, here)) for row, here in further)])
        if tuple(titles) != self._titles_of:
            self.brushes = {}
        self._rows, self._ends, self._titles_of = rows, ends, tuple(titles)
        for i, (low, high) in self.brushes.items():
            kept = kept & (rows[i] >= low) & (rows[i] <= high)
        self._kept = kept
        part = (rows - ends[:, :1]) / (ends[:, 1:] - ends[:, :1])
        at = np.arange(len(titles), dtype=float)
        here = (np.array(own) - ends[:, 0]) / (ends[:, 1] - ends[:, 0])
        tint = QColor(colour)
        tint.setAlphaF(THROUGH)
        groups = ((~kept, self._theme.faint), (kept, tint.name(QColor.NameFormat.HexArgb)))
        lines = [Line(*_across(at, part[:, which]), each) for which, each in groups if which.any()]
        lines += [Line(np.full(2, i), np.array([0.0, 1.0]), self._theme.quiet) for i in at]
        lines.append(Line(at, here, self._theme.ink, "the design", width=2))
        for i, row in enumerate(limits):
            for limit in row:
                level = (limit - ends[i, 0]) / (ends[i, 1] - ends[i, 0])
                if 0.0 <= level <= 1.0:
                    lines.append(
                        Line(np.array([i - 0.08, i + 0.08]), np.array([level, level]), self._theme.limit, width=2)
                    )
        self.name_axes("", "")
        note = f"{int(kept.sum())} of {kept.size} designs kept"
        self.show_lines(lines, fit=True, note=note)
        self.show_range((-0.5, len(titles) - 0.5), (-0.24, 1.08))
        self.show_ticks([], [])
        for tag in self._numbers:
            self._view.removeItem(tag)
        self._numbers = []
        room = self._view.width() / len(titles) - 6.0
        digits = 4 if room > WIDE else 3
        for i, (row, title) in enumerate(zip(ends, titles, strict=True)):
            first, last = (short(float(end), digits) for end in row)
            for level, text, lean in ((0.0, f"{first}\n{wrapped(title, room)}", 0.0), (1.0, last, 1.0)):
                tag = Tag(text, self._theme.ink, self._theme, SMALL, (0.5, lean), backing=True)
                self._include(tag, Z_OWN)
                tag.setPos(float(i), level)
                self._numbers.append(tag)
        self._draw_brushes()

    def show_path(self, points: np.ndarray, starts: np.ndarray) -> None:
        """The way of a search (m, numbers), across the axes of the numbers."""
        self.path, path = points, QPainterPath()
        count = points.shape[1]
        if self._filled and 0 < count <= len(self._ends):
            low, high = self._ends[:count].T
            for row in ((points - low) / (high - low)).tolist():
                for axis, level in enumerate(row):
                    path.lineTo(float(axis), level) if axis else path.moveTo(0.0, level)
        self._path.redraw(path)

    @property
    def kept(self) -> np.ndarray:
        """Numbers of the designs that limits and brushes leave."""
        return np.flatnonzero(self._kept)

    def _draw_brushes(self) -> None:
        path = QPainterPath()
        for i, (low, high) in self.brushes.items():
            for j, value in enumerate((low, high)):
                level = (value - self._ends[i, 0]) / (self._ends[i, 1] - self._ends[i, 0])
                path.lineTo(float(i), level) if j else path.moveTo(float(i), level)
        self._bars.redraw(path)

    # -- the mouse -------------------------------------------------------------------------------------------

    def pixel(self, axis: int, value: float) -> QPointF:
        """Where a value of an axis stands in the widget."""
        low, high = self._ends[axis]
        return QPointF(self.mapFromScene(self._view.mapViewToScene(QPointF(float(axis), (value - low) / (high - low)))))

    def _place(self, event: QMouseEvent) -> QPointF:
        return self._view.mapSceneToView(self.mapToScene(event.position().toPoint()))

    def _axis_at(self, event: QMouseEvent) -> int | None:
        axis = round(self._place(event).x())
        if not 0 <= axis < len(self._titles_of):
            return None
        return axis if abs(self.pixel(axis, self._ends[axis, 0]).x() - event.position().x()) <= REACH else None

    def _value(self, axis: int, event: QMouseEvent) -> float:
        low, high = self._ends[axis]
        return float(low + min(max(self._place(event).y(), 0.0), 1.0) * (high - low))

    def _line_at(self, event: QMouseEvent) -> int | None:
        """The kept design whose line passes next to the mouse."""
        at, kept = self._place(event), self.kept
        i = int(np.floor(at.x()))
        if not (kept.size and 0 <= i < len(self._titles_of) - 1):
            return None
        part = (self._rows[:, kept] - self._ends[:, :1]) / (self._ends[:, 1:] - self._ends[:, :1])
        away = np.abs(part[i] + (part[i + 1] - part[i]) * (at.x() - i) - at.y())
        if not np.isfinite(away).any():
            return None
        best = int(np.nanargmin(away))
        return int(kept[best]) if away[best] * self.frame().height <= 2.0 * REACH else None

    def mousePressEvent(self, event: QMouseEvent) -> None:
        event.accept()
        if event.button() != Qt.MouseButton.LeftButton or not self._titles_of:
            return
        axis = self._axis_at(event)
        if axis is not None:
            self._from = axis, self._value(axis, event)
            return
        line = self._line_at(event)
        if line is not None:
            self.picked.emit(line)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._from is None:
            self.viewport().setCursor(
                Qt.CursorShape.SizeVerCursor if self._axis_at(event) is not None else Qt.CursorShape.CrossCursor
            )
            self.hovered.emit(self._line_at(event))
            return
        axis, start = self._from
        now = self._value(axis, event)
        self.brushes[axis] = min(start, now), max(start, now)
        self._draw_brushes()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        event.accept()
        if self._from is None:
            return
        axis, start = self._from
        self._from = None
        if self._value(axis, event) == start:
            self.brushes.pop(axis, None)
        self.brushed.emit()


class FrontPlot(XYPlot):
    """Designs none of which is worse in both of two goals; picked (int): a click on one."""

    picked = Signal(int)

    def __init__(self) -> None:
        super().__init__("", "")
        self.points = np.zeros((2, 0))
        self.setMouseTracking(True)
        self.viewport().setMouseTracking(True)

    def show_front(self, points: np.ndarray, first: Measured, second: Measured) -> None:
        """Points (2, m) by two goals."""
        self.points = points
        self.name_axes(first.title, second.title, second.colour)
        line = Line(points[0], points[1], self._theme.quiet)
        dots = Dots(points[0], points[1], second.colour, size=2.0 * REACH - 8.0)
        self.show_lines([line], dots=[dots], fit=True, note=f"front of {points.shape[1]} designs: click one")
        free = 0.05 * float(np.ptp(points[0])) or 1.0
        self.show_range((float(points[0].min()) - free, float(points[0].max()) + free))

    def pixel(self, number: int) -> QPointF:
        """Where a design stands in the widget."""
        return QPointF(self.mapFromScene(self._view.mapViewToScene(QPointF(*self.points[:, number].tolist()))))

    def _at(self, event: QMouseEvent) -> int | None:
        away = [(self.pixel(i) - event.position()).manhattanLength() for i in range(self.points.shape[1])]
        best = int(np.argmin(away)) if away else 0
        return best if away and away[best] <= 2.0 * REACH else None

    def mousePressEvent(self, event: QMouseEvent) -> None:
        event.accept()
        number = self._at(event)
        if event.button() == Qt.MouseButton.LeftButton and number is not None:
            self.picked.emit(number)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        over = self._at(event) is not None
        self.viewport().setCursor(Qt.CursorShape.PointingHandCursor if over else Qt.CursorShape.CrossCursor)


def _across(at: np.ndarray, part: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lines of many designs (axes, m) as one, parted by NaN."""
    count = part.shape[1]
    y = np.concatenate([part, np.full((1, count), np.nan)]).T.ravel()
    return np.tile(np.append(at, np.nan), count), y
