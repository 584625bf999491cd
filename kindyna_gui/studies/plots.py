"""Plots of a survey: curves and maps with the current design, parallel coordinates, a front of designs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainterPath, QPen

from core.frozen import frozen
from core.output.drawing.palette import PURPLE
from core.output.drawing.scales import ticks
from core.varying import Survey
from kindyna_gui.pictures.items import Outline, Tag, wrapped
from kindyna_gui.pictures.plots.mouse import REACH, DraggablePoint, PlotMouse
from kindyna_gui.pictures.plots.xy import Dots, Line, Rule, XYPlot
from kindyna_gui.pictures.style import SCREEN, SMALL, rgb
from kindyna_gui.pictures.units import short, with_unit

FAINT, FULL = 0.08, 0.72  # opacity of the least value, of the greatest
BEYOND_LIMIT = 0.3  # factor of the opacity of designs beyond a limit
LEVELS = 7
CROSS, GAP = 11.0, 3.5  # pixels
Z_DESIGN = 60.0
LEVEL_TEXTS, LIMIT_TEXTS = (0.72, 0.3), (0.24, 0.72)  # preferred position of the texts, as parts of width and height
LABEL_FIGURES = 4
CROWDED = 34.0  # pixels between axes, up to which their texts are upright
UPRIGHT_SHARE = -0.9  # of the height of the axes, for upright texts
LONGEST_TITLE = 34  # characters of an upright title
WIDE = 44.0  # pixels between axes, from which on their ends have four digits
LINE_OPACITY = 0.3  # of the designs within the limits

# -- contour lines ---------------------------------------------------------------------------------------


def level_line(x: np.ndarray, y: np.ndarray, z: np.ndarray, level: float) -> tuple[np.ndarray, np.ndarray]:
    """Contour line of values on a grid, interpolated linearly on the two triangles of each cell.

    Parameters
    ----------
    x : ndarray (n,)
    y : ndarray (m,)
    z : ndarray (m, n)
        Values; a triangle with a corner that is not finite has no line.
    level : float

    Returns
    -------
    x, y : ndarray (3 k,)
        Segments of two points, separated by NaN.
    """
    corners = np.stack([*np.meshgrid(x, y), z], axis=-1)
    a, b, c, d = corners[:-1, :-1], corners[:-1, 1:], corners[1:, 1:], corners[1:, :-1]
    triangles = np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)]).reshape(-1, 3, 3)
    above = triangles[..., 2] > level
    is_crossed = np.isfinite(triangles[..., 2]).all(axis=1) & above.any(axis=1) & ~above.all(axis=1)
    crossed, above = triangles[is_crossed], above[is_crossed]
    single = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), above.argmin(axis=1))  # corner alone on its side
    row = np.arange(single.size)
    ends = np.full((single.size, 3, 2), np.nan)
    start = crossed[row, single]
    for i in (1, 2):
        end = crossed[row, (single + i) % 3]
        part = (level - start[:, 2]) / (end[:, 2] - start[:, 2])
        ends[:, i - 1] = start[:, :2] + part[:, None] * (end - start)[:, :2]
    return ends[..., 0].ravel(), ends[..., 1].ravel()


# -- curves and maps -------------------------------------------------------------------------------------


@frozen
class SurveyQuantity:
    """A quantity of a survey, with its unit, its colour in plots, and its limits, None where it has none."""

    key: str
    name: str
    unit: str
    colour: str
    least: float | None = None
    most: float | None = None

    @property
    def title(self) -> str:
        """Title of an axis."""
        return f"{self.name}, {self.unit}" if self.unit else self.name

    @property
    def limits(self) -> tuple[float, ...]:
        """Limits that are given, the least first."""
        return tuple(limit for limit in (self.least, self.most) if limit is not None)

    def is_within(self, value: np.ndarray) -> np.ndarray:
        """Whether each value is within the limits."""
        low, high = -np.inf if self.least is None else self.least, np.inf if self.most is None else self.most
        return np.asarray((value >= low) & (value <= high))

    def text(self, value: float) -> str:
        """Return a value with its unit."""
        return with_unit(short(value, LABEL_FIGURES + 1), self.unit)


class SurveyPlot(DraggablePoint, XYPlot):
    """Plot with the current design as a cross, or as an upright line if one number is varied; the mouse can drag it."""

    def __init__(self, upright: bool = False) -> None:
        super().__init__("", "")
        self._upright = upright
        self.design_point: tuple[float, float] | None = None
        self._cross = Outline(_cross(), self._theme.pen(self._theme.ink, 1.8))
        self._cross.setFlag(self._cross.GraphicsItemFlag.ItemIgnoresTransformations)
        self._line = self._outline(self._theme.ink, Z_DESIGN)
        self._include(self._cross, Z_DESIGN)
        self._texts: list[Tag] = []
        self._boxes: list[QRectF] = []  # of the texts, in pixels from the lower left corner
        self._path = self._outline(self._theme.ink, Z_DESIGN - 2.0)
        self._path.setPen(self._theme.pen(self._theme.seen(PURPLE), 1.6))
        self.path = np.zeros((0, 2))
        self.mark_design(None)

    def mark_design(self, at: tuple[float, float] | None, refused: bool = False) -> None:
        """Mark the current design at a point, None: nowhere; refused: no design can be built at this point."""
        self.design_point = at
        (low, high), (bottom, top) = self._view.viewRange()
        inside = at is not None and self._filled and low <= at[0] <= high and (self._upright or bottom <= at[1] <= top)
        pen = self._theme.pen(self._theme.limit if refused else self._theme.ink, 1.8)
        self._cross.setPen(pen)
        self._line.setPen(pen)
        self._cross.setVisible(inside and not self._upright)
        self._line.setVisible(inside and self._upright)
        if at is not None and inside:
            self._cross.setPos(*at)
            path = QPainterPath(QPointF(at[0], bottom))
            path.lineTo(at[0], top)
            self._line.redraw(path)

    def show_path(self, points: np.ndarray, starts: np.ndarray) -> None:
        """Show the path of a search: points (m, 2), and the number of the start (m,) of each."""
        self.path, path = points, QPainterPath()
        if points.shape[1:] == (2,) and self._filled:
            for i, (x, y) in enumerate(points.tolist()):
                path.lineTo(x, y) if i and starts[i] == starts[i - 1] else path.moveTo(x, y)
        self._path.redraw(path)

    def point_at(self, pixel: QPointF) -> tuple[float, float] | None:
        if not self._filled:
            return None
        at = self.to_axes(pixel)
        (low, high), (bottom, top) = self._view.viewRange()
        inside = low <= at.x() <= high and bottom <= at.y() <= top
        if self.is_dragging:  # outside the plot the point remains at its edge
            return min(max(at.x(), low), high), min(max(at.y(), bottom), top)
        return (at.x(), at.y()) if inside else None

    def pixel(self, x: float, y: float) -> QPointF:
        """Return the position of a point in the widget."""
        return self.to_pixel(QPointF(x, y))

    def own_pixel(self) -> QPointF | None:
        shown = self._line if self._upright else self._cross
        return self.pixel(*self.design_point) if self.design_point is not None and shown.isVisible() else None

    def is_over_point(self, pixel: QPointF) -> bool:
        point = self.own_pixel()
        if point is None or not self._upright:
            return super().is_over_point(pixel)
        return abs(point.x() - pixel.x()) <= REACH

    def show_curve(self, x: np.ndarray, y: np.ndarray, quantity: SurveyQuantity, x_title: str) -> None:
        """Show a quantity y (n,) over one number x (n,), with its limits."""
        self._remove_texts()
        if not np.isfinite(y).any():
            self.show_message(f"{quantity.name}: no design between the bounds has a value.")
            return
        self.name_axes(x_title, quantity.title, quantity.colour)
        limits = quantity.limits
        rules = [Rule(limit, quantity.text(limit), self._theme.limit, level=True) for limit in limits]
        finite = np.where(np.isfinite(y), y, np.nan)
        in_range = Dots(np.full(len(limits), x[0]), np.array(limits), self._theme.limit, size=0.0)
        self.show_lines([Line(x, finite, quantity.colour)], rules=rules, dots=[in_range] if limits else [], fit=True)
        self.show_range((float(x[0]), float(x[-1])))
        self.mark_design(self.design_point)

    def show_map(
        self,
        survey: Survey,
        shown: SurveyQuantity,
        quantities: Sequence[SurveyQuantity],
        titles: tuple[str, str],
    ) -> None:
        """Show a quantity as colours and contour lines over two numbers, with the limits of all quantities.

        Colours are pale beyond a limit, and grey where no design can be built. Colours and limits are those of the finer cells.
        """
        (x, y), fine_axes = survey.axes(), survey.axes(survey.is_refined)
        built = survey.reason == ""
        self._remove_texts()
        self.name_axes(*titles)
        values = np.where(built, survey.value[shown.key], np.nan)
        z, fine = survey.grid(values), survey.grid(values, survey.is_refined)
        lines, texts = [], []
        for level in _levels(z):
            line = level_line(x, y, z, level)
            lines.append(Line(*line, self._theme.ink))
            texts.append((short(level, LABEL_FIGURES), self._theme.ink, line, LEVEL_TEXTS))
        within = np.ones(fine.shape, dtype=bool)
        for quantity in quantities:
            value = survey.grid(np.where(built, survey.value[quantity.key], np.nan), survey.is_refined)
            within &= quantity.is_within(value) | ~np.isfinite(value)
            for limit in quantity.limits:
                line = level_line(*fine_axes, value, limit)
                if line[0].size:
                    lines.append(Line(*line, self._theme.limit, width=2))
                    texts.append((f"{quantity.name} {quantity.text(limit)}", self._theme.limit, line, LIMIT_TEXTS))
        legend = Line(x[[0, -1]], np.array([y[0], np.nan]), shown.colour, _range_text(shown, z))
        self.show_lines([legend, *(line for line in lines if line.x.size)], fit=True)
        for item in self._drawn:  # round caps close the gaps between short segments
            pen = QPen(item.opts["pen"])
            pen.setCapStyle(Qt.PenCapStyle.RoundCap)
            item.setPen(pen)
        half_x, half_y = (0.5 * (axis[1] - axis[0]) for axis in fine_axes)
        area = QRectF(x[0] - half_x, y[0] - half_y, x[-1] - x[0] + 2.0 * half_x, y[-1] - y[0] + 2.0 * half_y)
        self.show_image(_map_image(fine, within, shown.colour), area)
        self.show_range((float(x[0]), float(x[-1])), (float(y[0]), float(y[-1])))
        for row in reversed(texts):  # limits first
            self._write_on(*row)
        self.mark_design(self.design_point)

    def _write_on(self, text: str, colour: str, line: tuple[np.ndarray, np.ndarray], near: tuple[float, float]) -> None:
        """Write a text on a line, as close as possible to a part of width and height, without overlap."""
        (low, high), (bottom, top) = self._view.viewRange()
        across, up = (line[0] - low) / (high - low), (line[1] - bottom) / (top - bottom)
        distance = np.hypot(across - near[0], up - near[1])
        tag = Tag(text, colour, self._theme, SMALL, (0.5, 0.5), backing=True)
        half = 0.5 * tag.size[0] / self._view.width()
        for at in np.argsort(distance)[: int(np.isfinite(distance).sum())].tolist():
            middle = min(max(float(across[at]), half), 1.0 - half)
            tag.set_lean(0.5 + (float(across[at]) - middle) / (2.0 * half), 0.5)
            box = tag.pixel_box().translated(across[at] * self._view.width(), -up[at] * self._view.height())
            if not any(box.intersects(written) for written in self._boxes):
                self._boxes.append(box.adjusted(-4.0, -2.0, 4.0, 2.0))
                self._include(tag, Z_DESIGN - 1.0)
                tag.setPos(float(line[0][at]), float(line[1][at]))
                self._texts.append(tag)
                return

    @property
    def texts(self) -> list[str]:
        """Texts on the lines of the map."""
        return [tag.text for tag in self._texts]

    def _remove_texts(self) -> None:
        for tag in self._texts:
            self._view.removeItem(tag)
        self._texts, self._boxes = [], []

    def show_message(self, text: str) -> None:
        if hasattr(self, "_texts"):  # not during the construction of the base class
            self._remove_texts()
        super().show_message(text)
        if hasattr(self, "_texts"):
            self.mark_design(None)


def _cross() -> QPainterPath:
    path = QPainterPath()
    for x, y in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
        path.moveTo(GAP * x, GAP * y)
        path.lineTo(CROSS * x, CROSS * y)
    path.addEllipse(QPointF(0.0, 0.0), 0.6 * CROSS, 0.6 * CROSS)
    return path


def _levels(z: np.ndarray) -> list[float]:
    """Round values for contour lines; the greatest 5 % of the values, close to infinity, are ignored."""
    finite = z[np.isfinite(z)]
    if finite.size < 3:
        return []
    low, high = np.percentile(finite, (0.5, 95.0))
    return ticks(float(low), float(high), LEVELS)[0] if high > low else []


def _scale(z: np.ndarray) -> tuple[float, float]:
    """Range of the colours; the greatest 2 % of the values, close to infinity, are ignored."""
    finite = z[np.isfinite(z)]
    low, high = np.percentile(finite, (0.0, 98.0)).tolist() if finite.size else (0.0, 1.0)
    return low, high if high > low else low + 1.0


def _range_text(quantity: SurveyQuantity, z: np.ndarray) -> str:
    finite = z[np.isfinite(z)]
    if not finite.size:
        return quantity.name
    return f"{quantity.name} {quantity.text(float(finite.min()))} … {quantity.text(float(finite.max()))}"


def _map_image(z: np.ndarray, within: np.ndarray, colour: str) -> np.ndarray:
    """Colours (n, m, 4) of values (m, n)."""
    low, high = _scale(z[within] if np.isfinite(z[within]).any() else z)
    part = np.clip((z - low) / (high - low), 0.0, 1.0)
    image = np.empty((*z.shape, 4), dtype=np.ubyte)
    image[..., :3] = rgb(colour)
    opacity = (FAINT + (FULL - FAINT) * np.nan_to_num(part)) * np.where(within, 1.0, BEYOND_LIMIT)
    image[..., 3] = np.round(255.0 * opacity)
    image[~np.isfinite(z)] = (*rgb(SCREEN.line), 255)
    return image.transpose(1, 0, 2)


# -- parallel coordinates --------------------------------------------------------------------------------


class ParallelPlot(PlotMouse, XYPlot):
    """Parallel coordinates: an axis for each number and each quantity, a line across all axes for each design.

    Dragging along an axis selects the lines that cross this part; a click on the axis selects all.

    Attributes
    ----------
    brushes : dict of int to (float, float)
        Number of an axis and the selected part of it, in its unit.

    Signals: ``brushed``, the selected part of an axis has changed; ``hovered`` (int or None), number of the design
    whose line is next to the mouse; ``picked`` (int), its line is clicked.
    """

    brushed = Signal()
    hovered = Signal(object)
    picked = Signal(int)

    def __init__(self) -> None:
        super().__init__("", "")
        self.brushes: dict[int, tuple[float, float]] = {}
        self._rows = np.zeros((0, 0))
        self._ends = np.zeros((0, 2))
        self._selected = np.zeros(0, dtype=bool)
        self._axis_titles: tuple[str, ...] = ()
        self._brush_start = 0, 0.0  # axis, and its value at the press
        self._bars = self._outline(SCREEN.ink, Z_DESIGN)
        self._bars.setPen(self._theme.pen(self._theme.ink, 5.0))
        self._bars.setOpacity(0.45)
        self._path = self._outline(self._theme.ink, Z_DESIGN - 1.0)
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
        within: np.ndarray,
        current: Sequence[float],
        colour: str,
    ) -> None:
        """Show designs.

        Parameters
        ----------
        titles : sequence of str
            Titles of the axes.
        rows : ndarray (axes, m)
            Values of m designs, NaN where there is none.
        bounds : sequence of (float, float)
            Ends of the first axes, those of the varied numbers.
        limits : sequence of tuple of float
            Limits on each axis.
        within : ndarray (m,) of bool
            Designs within the limits, drawn in colour; the other ones are faint.
        current : sequence of float
            Values of the current design, drawn in ink.
        colour : str
        """
        further = zip(rows[len(bounds) :], current[len(bounds) :], strict=True)
        ends = np.array([*bounds, *(_scale(np.append(row, value)) for row, value in further)])
        if tuple(titles) != self._axis_titles:
            self.brushes = {}
        self._rows, self._ends, self._axis_titles = rows, ends, tuple(titles)
        for i, (low, high) in self.brushes.items():
            within = within & (rows[i] >= low) & (rows[i] <= high)
        self._selected = within
        part = (rows - ends[:, :1]) / (ends[:, 1:] - ends[:, :1])
        at = np.arange(len(titles), dtype=float)
        levels = (np.array(current) - ends[:, 0]) / (ends[:, 1] - ends[:, 0])
        tint = QColor(colour)
        tint.setAlphaF(LINE_OPACITY)
        groups = ((~within, self._theme.faint), (within, tint.name(QColor.NameFormat.HexArgb)))
        lines = [Line(*_joined_lines(at, part[:, group]), pen) for group, pen in groups if group.any()]
        lines += [Line(np.full(2, i), np.array([0.0, 1.0]), self._theme.quiet) for i in at]
        lines.append(Line(at, levels, self._theme.ink, "current design", width=2))
        for i, row in enumerate(limits):
            for limit in row:
                level = (limit - ends[i, 0]) / (ends[i, 1] - ends[i, 0])
                if 0.0 <= level <= 1.0:
                    lines.append(
                        Line(np.array([i - 0.08, i + 0.08]), np.array([level, level]), self._theme.limit, width=2)
                    )
        self.name_axes("", "")
        note = f"{int(within.sum())} of {within.size} designs selected"
        self.show_lines(lines, fit=True, note=note)
        room = self._view.width() / len(titles) - 6.0
        self.show_range((-0.5, len(titles) - 0.5), (-0.24 if room > CROWDED else UPRIGHT_SHARE, 1.08))
        self.show_ticks([], [])
        for tag in self._numbers:
            self._view.removeItem(tag)
        self._numbers = []
        digits = 4 if room > WIDE else 3
        for i, (row, title) in enumerate(zip(ends, titles, strict=True)):
            low_text, high_text = (short(float(end), digits) for end in row)
            if room > CROWDED:
                self._label(i, 0.0, f"{low_text}\n{wrapped(title, room)}", (0.5, 0.0))
                self._label(i, 1.0, high_text, (0.5, 1.0))
            else:
                name = title if len(title) <= LONGEST_TITLE else f"{title[: LONGEST_TITLE - 1]}…"
                self._label(i, -0.02, f"{name}  {low_text} … {high_text}", (0.0, 0.5)).setRotation(90.0)
        self._draw_brushes()

    def _label(self, axis: int, level: float, text: str, lean: tuple[float, float]) -> Tag:
        """Write a text at an axis."""
        tag = Tag(text, self._theme.ink, self._theme, SMALL, lean, backing=True)
        self._include(tag, Z_DESIGN)
        tag.setPos(float(axis), level)
        self._numbers.append(tag)
        return tag

    def show_path(self, points: np.ndarray, starts: np.ndarray) -> None:
        """Show the path of a search (m, numbers) across the axes of the numbers."""
        self.path, path = points, QPainterPath()
        count = points.shape[1]
        if self._filled and 0 < count <= len(self._ends):
            low, high = self._ends[:count].T
            for row in ((points - low) / (high - low)).tolist():
                for axis, level in enumerate(row):
                    path.lineTo(float(axis), level) if axis else path.moveTo(0.0, level)
        self._path.redraw(path)

    @property
    def selected(self) -> np.ndarray:
        """Indices of the designs within the limits and the brushes."""
        return np.flatnonzero(self._selected)

    def _draw_brushes(self) -> None:
        path = QPainterPath()
        for i, (low, high) in self.brushes.items():
            for j, value in enumerate((low, high)):
                level = (value - self._ends[i, 0]) / (self._ends[i, 1] - self._ends[i, 0])
                path.lineTo(float(i), level) if j else path.moveTo(float(i), level)
        self._bars.redraw(path)

    # -- mouse ----------------------------------------------------------------------------------------------

    def pixel(self, axis: int, value: float) -> QPointF:
        """Return the position of a value of an axis in the widget."""
        low, high = self._ends[axis]
        return self.to_pixel(QPointF(float(axis), (value - low) / (high - low)))

    def _axis_at(self, event: QMouseEvent) -> int | None:
        axis = round(self.to_axes(event.position()).x())
        if not 0 <= axis < len(self._axis_titles):
            return None
        return axis if abs(self.pixel(axis, self._ends[axis, 0]).x() - event.position().x()) <= REACH else None

    def _value(self, axis: int, event: QMouseEvent) -> float:
        low, high = self._ends[axis]
        return float(low + min(max(self.to_axes(event.position()).y(), 0.0), 1.0) * (high - low))

    def _line_at(self, event: QMouseEvent) -> int | None:
        """Index of the selected design whose line is next to the mouse."""
        at, selected = self.to_axes(event.position()), self.selected
        i = int(np.floor(at.x()))
        if not (selected.size and 0 <= i < len(self._axis_titles) - 1):
            return None
        part = (self._rows[:, selected] - self._ends[:, :1]) / (self._ends[:, 1:] - self._ends[:, :1])
        distance = np.abs(part[i] + (part[i + 1] - part[i]) * (at.x() - i) - at.y())
        if not np.isfinite(distance).any():
            return None
        nearest = int(np.nanargmin(distance))
        return int(selected[nearest]) if distance[nearest] * self.frame().height <= 2.0 * REACH else None

    def press(self, event: QMouseEvent) -> bool:
        if event.button() != Qt.MouseButton.LeftButton or not self._axis_titles:
            return False
        axis, line = self._axis_at(event), self._line_at(event)
        if axis is not None:
            self._brush_start = axis, self._value(axis, event)
        elif line is not None:
            self.picked.emit(line)
        return axis is not None

    def hover(self, event: QMouseEvent | None) -> None:
        if event is not None:
            is_over_axis = self._axis_at(event) is not None
            self.viewport().setCursor(Qt.CursorShape.SizeVerCursor if is_over_axis else Qt.CursorShape.CrossCursor)
            self.hovered.emit(self._line_at(event))

    def drag(self, event: QMouseEvent) -> None:
        axis, start = self._brush_start
        now = self._value(axis, event)
        self.brushes[axis] = min(start, now), max(start, now)
        self._draw_brushes()

    def drop(self, event: QMouseEvent) -> None:
        axis, start = self._brush_start
        if self._value(axis, event) == start:
            self.brushes.pop(axis, None)
        self.brushed.emit()


# -- front of two goals ----------------------------------------------------------------------------------


class FrontPlot(PlotMouse, XYPlot):
    """Designs none of which is worse in both of two goals. Signal ``picked`` (int): a design is clicked."""

    picked = Signal(int)

    def __init__(self) -> None:
        super().__init__("", "")
        self.points = np.zeros((2, 0))
        self.setMouseTracking(True)
        self.viewport().setMouseTracking(True)

    def show_front(self, points: np.ndarray, first: SurveyQuantity, second: SurveyQuantity) -> None:
        """Show designs as points (2, m), by the two goals."""
        self.points = points
        self.name_axes(first.title, second.title, second.colour)
        line = Line(points[0], points[1], self._theme.quiet)
        dots = Dots(points[0], points[1], second.colour, size=2.0 * REACH - 8.0)
        self.show_lines(
            [line], dots=[dots], fit=True, note=f"front of {points.shape[1]} designs: click one to apply it"
        )
        free = 0.05 * float(np.ptp(points[0])) or 1.0
        self.show_range((float(points[0].min()) - free, float(points[0].max()) + free))

    def pixel(self, number: int) -> QPointF:
        """Return the position of a design in the widget."""
        return self.to_pixel(QPointF(*self.points[:, number].tolist()))

    def _at(self, event: QMouseEvent) -> int | None:
        distances = [(self.pixel(i) - event.position()).manhattanLength() for i in range(self.points.shape[1])]
        nearest = int(np.argmin(distances)) if distances else 0
        return nearest if distances and distances[nearest] <= 2.0 * REACH else None

    def press(self, event: QMouseEvent) -> bool:
        number = self._at(event)
        if event.button() == Qt.MouseButton.LeftButton and number is not None:
            self.picked.emit(number)
        return False

    def hover(self, event: QMouseEvent | None) -> None:
        is_over = event is not None and self._at(event) is not None
        self.viewport().setCursor(Qt.CursorShape.PointingHandCursor if is_over else Qt.CursorShape.CrossCursor)


def _joined_lines(at: np.ndarray, part: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lines of m designs (axes, m) as one line, separated by NaN."""
    count = part.shape[1]
    y = np.concatenate([part, np.full((1, count), np.nan)]).T.ravel()
    return np.tile(np.append(at, np.nan), count), y
