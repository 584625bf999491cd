"""Parts of a plot: its frame in pixels, legend, curves, limit lines, cursor and shaded bands of machines."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from html import escape
from itertools import product

import numpy as np
from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPainterPath, QPen
from PySide6.QtWidgets import QGraphicsItem, QGraphicsTextItem, QGraphicsWidget, QStyleOptionGraphicsItem, QWidget

from core.frozen import frozen
from core.output.drawing.scales import needed
from kindyna_gui.pictures.items import Outline, Tag
from kindyna_gui.pictures.plots.library import pg
from kindyna_gui.pictures.shapes import segments
from kindyna_gui.pictures.style import SMALL, Theme, brush, font
from kindyna_gui.settings import sized

LEFT_WIDTH, TOP_HEIGHT, BOTTOM_HEIGHT = 66, 17, 38  # of the axes, pixels
Z_BANDS, Z_GRID, Z_ZERO, Z_LIMIT, Z_REFERENCE, Z_CURVE, Z_CURSOR = -90.0, -80.0, -70.0, 5.0, 8.0, 10.0, 20.0
LEGEND_HEIGHT = 18.0  # of the first line, pixels
MIN_LINES = 2  # lines that a legend may always have
ELLIPSIS = "…"
NAME_GAP = "\u00a0\u00a0 "  # between names
TEXT_POSITIONS = (1.0, 0.0, 0.75, 0.5, 0.25, *(i / 16.0 for i in range(1, 16) if i % 4))  # of a text along its line
TEXT_LIFT = 2.0  # of that text from a curve, or from its line where a curve runs on it, pixels
TEXT_SHIFT = 4.0  # of that text inwards from the ends of the line, pixels
BAND_OPACITY = (0.16, 0.3)  # of the outer band, of the inner one above it
DASHED_MARK, LINE_MARK = "– –", "─"  # of a dashed curve, of a straight line
MACHINES = "90 and 99.73 % of machines"

# -- frame -----------------------------------------------------------------------------------------------


@frozen
class Frame:
    """Range and size of a plot.

    Attributes
    ----------
    low, high : values at the lower and upper end, in the unit of the axis
    width, height : size in pixels
    first, last : ends of the x axis; by default one turn of the cam [deg]
    """

    low: float
    high: float
    width: float
    height: float
    first: float = 0.0
    last: float = 360.0

    def pixel(self, value: float) -> float:
        """Height of a value above the lower end [pixels]."""
        return (value - self.low) / (self.high - self.low) * self.height

    def value(self, pixel: float) -> float:
        """Value at a height above the lower end [pixels]."""
        return self.low + pixel / self.height * (self.high - self.low)

    def vertical(self, x: float) -> QPainterPath:
        """Vertical line over the full height of the plot."""
        return segments([(complex(x, self.low), complex(x, self.high))])

    def horizontal(self, value: float) -> QPainterPath:
        """Horizontal line over the full width of the plot."""
        return segments([(complex(self.first, value), complex(self.last, value))])

    def box(self, angle: float, value: float, box: QRectF) -> QRectF:
        """Box around a point, given in pixels from the point, y downwards.

        Returns
        -------
        QRectF
            The box in pixels from the frame's lower left corner, y upwards.
        """
        x, y = (angle - self.first) / (self.last - self.first) * self.width, self.pixel(value)
        return QRectF(x + box.left(), y - box.bottom(), box.width(), box.height())


def add_item(view: pg.ViewBox, item: QGraphicsItem, z: float) -> None:
    """Add an item to a plot, in the coordinates of its axes."""
    item.setZValue(z)
    view.addItem(item, ignoreBounds=True)


class PlotMark:
    """Part of a plot that consists of a line or a sign and a text; both are removed together."""

    def __init__(self, view: pg.ViewBox, *items: tuple[QGraphicsItem, float]) -> None:
        self._items = tuple(item for item, _ in items)
        for item, z in items:
            add_item(view, item, z)

    def remove(self, view: pg.ViewBox) -> None:
        """Remove it from the plot."""
        for item in self._items:
            view.removeItem(item)


# -- legend ----------------------------------------------------------------------------------------------


@frozen
class Entry:
    """A name in the legend, with the colour of its curve and a sign for its stroke."""

    colour: str
    name: str
    mark: str = "—"


def legend_rows(widths: Sequence[float], gap: float, room: float, max_rows: int) -> list[list[int]]:
    """Numbers of the entries on each line of a legend.

    Each line is filled as far as the room allows. Where that needs more than ``max_rows`` lines, the entries are
    divided equally among so many.
    """
    rows: list[list[int]] = []
    used = 0.0
    for i, width in enumerate(widths):
        if rows and used + gap + width <= room:
            rows[-1].append(i)
            used += gap + width
        else:
            rows.append([i])
            used = width
    if len(rows) <= max_rows:
        return rows
    count = -(-len(widths) // max_rows)
    return [list(range(i, min(i + count, len(widths)))) for i in range(0, len(widths), count)]


def cut(text: str, room: float, advance: Callable[[str], float]) -> str:
    """Shorten a text that is wider than the room, with an ellipsis at its end."""
    if advance(text) <= room:
        return text
    length = next((n for n in range(len(text) - 1, 0, -1) if advance(text[:n].rstrip() + ELLIPSIS) <= room), 1)
    return text[:length].rstrip() + ELLIPSIS


class Legend(QGraphicsTextItem):
    """Names of the curves above a plot; laid out again only where its entries or its room have changed."""

    def __init__(self, parent: QGraphicsWidget, ink: str, centred: bool = False) -> None:
        super().__init__(parent)
        self._entries: tuple[Entry, ...] = ()
        self._note, self._centred = "", centred
        self._layout: tuple[object, ...] = ()
        self.setDefaultTextColor(QColor(ink))
        self.height = 0.0
        self.update_font()

    def update_font(self) -> None:
        """Use the font size that is set now; `fit` lays the text out again."""
        self.setFont(font(SMALL))
        self._metrics = QFontMetricsF(self.font())
        self.setPlainText(NAME_GAP)
        self._line_height = self.boundingRect().height()
        self.setPlainText("")
        self._layout = ()

    @property
    def text(self) -> str:
        """Legend as plain text."""
        return self.toPlainText()

    def set_entries(self, entries: Sequence[Entry], note: str = "") -> None:
        """Set the names; the note follows the last name where one line has room for all."""
        self._entries, self._note = tuple(entries), note

    def fit(self, room: QRectF) -> None:
        """Lay the names out at the top of a room and set ``height``.

        More than two lines are used only where the room is high enough. A name that has no room is cut.
        """
        max_rows = max(MIN_LINES, 1 + int((room.height() - sized(LEGEND_HEIGHT)) / self._metrics.lineSpacing()))
        layout = (self._entries, self._note, room.width(), max_rows)
        if layout != self._layout:
            self._layout = layout
            self._write(room.width() - 2.0 * self.document().documentMargin(), max_rows)
        box = self.boundingRect()
        if self._centred:
            box.moveCenter(QRectF(room.left(), room.top(), room.width(), self.height).center())
            self.setPos(box.topLeft())
        else:
            self.setPos(room.topLeft())

    def _write(self, room: float, max_rows: int) -> None:
        advance = self._metrics.horizontalAdvance
        widths, gap = [advance(f"{e.mark} {e.name}") for e in self._entries], advance(NAME_GAP)
        rows = legend_rows(widths, gap, room, max_rows)
        parts = []
        for row in rows:
            row_room = room - gap * (len(row) - 1)
            share = row_room if sum(widths[i] for i in row) <= row_room else row_room / len(row)
            parts.append([self._html(self._entries[i], share) for i in row])
        if self._note and sum(widths) + gap * len(widths) + advance(self._note) <= room:
            parts = [[*(part for row in parts for part in row), escape(self._note)]]
        self.setHtml("<br>".join(NAME_GAP.join(row) for row in parts))
        further_lines = self.boundingRect().height() - self._line_height
        self.height = sized(LEGEND_HEIGHT) + max(further_lines, 0.0) if rows else 0.0

    def _html(self, entry: Entry, room: float) -> str:
        advance = self._metrics.horizontalAdvance
        name = cut(entry.name, room - advance(f"{entry.mark} "), advance)
        return f'<span style="color:{entry.colour};font-weight:bold">{entry.mark}</span> {escape(name)}'


# -- curves, limit lines and cursor ----------------------------------------------------------------------


class CurveLine(Outline):
    """Curve over one turn; on the screen it is drawn through no more points than its size needs.

    Attributes
    ----------
    x, y : ndarray (n,), all its points, in the units of the axes
    drawn : how many of them the path passes through
    """

    x: np.ndarray  # type: ignore[assignment]
    y: np.ndarray  # type: ignore[assignment]

    def __init__(self, view: pg.ViewBox) -> None:
        super().__init__(QPainterPath())
        self.x = self.y = np.zeros(0)
        self.drawn, self._is_finite = 0, True
        self._layout: tuple[object, ...] = ()
        view.addItem(self, ignoreBounds=True)

    def show_points(self, x: np.ndarray, y: np.ndarray, pen: QPen, z: float) -> None:
        """Set the points (n,); there is a gap where y is NaN. ``lay`` draws them, unless they are the same as before."""
        if not ((x is self.x or np.array_equal(x, self.x)) and np.array_equal(y, self.y, equal_nan=True)):
            self.x, self.y, self._is_finite = x, y, bool(np.isfinite(y).all())
            self._layout = ()
        if pen != self.pen():
            self.setPen(pen)
        self.setZValue(z)

    def remove(self, view: pg.ViewBox) -> None:
        """Remove the curve from the plot."""
        view.removeItem(self)

    def lay(self, frame: Frame, unseen: float) -> None:
        """Draw the curve with an error of at most ``unseen`` pixels; through all points where that is 0."""
        layout = (frame, unseen)
        if layout == self._layout:
            return
        self._layout = layout
        pixels = self.x * (frame.width / 360.0) + 1j * self.y * (frame.height / (frame.high - frame.low))
        indices = needed(pixels, unseen)
        self.drawn = int(indices.size)
        connect = "all" if self._is_finite else "finite"
        self.redraw(pg.arrayToQPath(self.x[indices], self.y[indices], connect, finiteCheck=not self._is_finite))

    def enters(self, box: QRectF, frame: Frame) -> bool:
        """Whether the curve enters a box in the frame [pixels from its lower left corner, y upwards]."""
        first, last = np.searchsorted(self.x, np.array([box.left(), box.right()]) / frame.width * 360.0)
        part = self.y[max(first - 1, 0) : last + 1]
        part = part if self._is_finite else part[np.isfinite(part)]
        low, high = frame.value(box.top()), frame.value(box.bottom())
        return bool(part.size) and not (part.max() < low or part.min() > high)

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        super().paint(painter, option, widget)


def enters(points: np.ndarray, box: QRectF) -> bool:
    """Whether a line through points enters a box.

    Parameters
    ----------
    points : ndarray (n,) complex
        Points x + iy of the line, with gaps where they are NaN [pixels].
    box : QRectF
        In the same coordinates.
    """
    start, end = points[:-1], points[1:]
    begins, ends = np.zeros(start.size), np.ones(start.size)
    sides = ((start.real, end.real, box.left(), box.right()), (start.imag, end.imag, box.top(), box.bottom()))
    with np.errstate(divide="ignore", invalid="ignore"):
        for at, to, low, high in sides:  # parts of each segment between the two sides
            first, last = (low - at) / (to - at), (high - at) / (to - at)
            within = (low <= at) & (at <= high)
            first = np.where(to == at, np.where(within, 0.0, 2.0), first)
            last = np.where(to == at, np.where(within, 1.0, 2.0), last)
            begins, ends = np.maximum(begins, np.minimum(first, last)), np.minimum(ends, np.maximum(first, last))
    return bool((begins <= ends).any())


class LimitLine(PlotMark):
    """A thin red line over the full turn, with its text next to it, or in the legend where that finds no room."""

    def __init__(self, view: pg.ViewBox, theme: Theme, value: float = 0.0, text: str = "") -> None:
        path = QPainterPath()
        path.lineTo(360.0, 0.0)
        self._line = Outline(path, theme.pen(theme.limit))
        self._tag = Tag("", theme.limit, theme, SMALL, (1.0, 1.0), backing=True)
        super().__init__(view, (self._line, Z_LIMIT), (self._tag, Z_CURSOR + 1.0))
        self.set_value(value, text)

    def set_value(self, value: float, text: str, shorter: Sequence[str] = (), field: str = "") -> None:
        """Set value and text; shorter ones are used where the text would cover a curve; field: path of the limit."""
        self.value, self.text, self.field = value, text, field
        self._texts = tuple(dict.fromkeys((text, *shorter)))
        self._tag.set_text(text)
        self._line.setPos(0.0, value)
        self._tag.setPos(360.0, value)

    def lay_clear(self, frame: Frame, curves: Sequence[CurveLine], occupied: Sequence[QRectF] = ()) -> bool:
        """Put the text where it covers no curve and no occupied box: further left, below the line, or shortened.

        Returns False where there is no such place.
        """
        above = (frame.high - self.value) / (frame.high - frame.low) * frame.height > self._tag.size[1] + 2.0
        room = QRectF(-1.0, 0.0, frame.width + 2.0, frame.height)
        for lift, text in product((0.0, TEXT_LIFT), self._texts):
            self._tag.set_text(text)
            for over, part in product((above, not above), TEXT_POSITIONS):
                box = self._box_at(frame, part, over, lift).adjusted(0.0, lift - TEXT_LIFT, 0.0, TEXT_LIFT - lift)
                is_free = room.contains(box) and not any(map(box.intersects, occupied))
                if is_free and not any(curve.enters(box, frame) for curve in curves):
                    self._put_text(part, over, lift)
                    self._tag.setVisible(True)
                    return True
        return False

    def hide_text(self) -> None:
        """Hide the text until there is room for it."""
        self._tag.set_text(self.name)
        self._tag.setVisible(False)

    @property
    def name(self) -> str:
        """Text in the legend, without the value."""
        return self._texts[min(1, len(self._texts) - 1)]

    def _put_text(self, part: float, above: bool, lift: float) -> None:
        """Put the text at a fraction of the line's length, above or below it, so many pixels from it."""
        self._tag.setPos(360.0 * part, self.value)
        self._tag.set_lean(part, 1.0 if above else 0.0)
        self._tag.shift(TEXT_SHIFT * (1.0 - 2.0 * part), -lift if above else lift)

    def _box_at(self, frame: Frame, part: float, above: bool, lift: float) -> QRectF:
        """Box that the text would have, as ``box``; parameters as for ``_put_text``."""
        width, height = self._tag.size
        left = TEXT_SHIFT * (1.0 - 2.0 * part) - part * width
        return frame.box(360.0 * part, self.value, QRectF(left, -height - lift if above else lift, width, height))

    def box(self, frame: Frame) -> QRectF:
        """Box of the text in the frame [pixels from its lower left corner, y upwards]; empty where it is hidden."""
        if not self._tag.isVisible():
            return QRectF()
        return frame.box(self._tag.pos().x(), self.value, self._tag.pixel_box())


class Cursor(Outline):
    """Vertical line at the cam angle."""

    def __init__(self, view: pg.ViewBox, theme: Theme) -> None:
        super().__init__(segments([(0j, 1j)]), theme.pen(theme.quiet))
        add_item(view, self, Z_CURSOR)

    def span(self, frame: Frame) -> None:
        """Draw the line over the full height of the frame."""
        self.redraw(frame.vertical(0.0))

    def value(self) -> float:
        """Cam angle of the cursor [deg]."""
        return float(self.pos().x())


# -- bands of machines -----------------------------------------------------------------------------------


def closed_band(band: np.ndarray, gain: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Cam angles [deg] (n + 1,) to the end of the turn, and the percentiles (5, n + 1) there.

    A value grows by ``gain`` in one turn.
    """
    return np.linspace(0.0, 360.0, band.shape[1] + 1), np.column_stack([band, band[:, :1] + gain])


def band_outlines(x: np.ndarray, percentiles: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray, float]]:
    """Outlines of the two areas of a band: x (m,), values (m,) and opacity.

    The outer area is between the first and the last percentile (5, n), the inner one between the second and the fourth.
    """
    for i, opacity in enumerate(BAND_OPACITY):
        known = np.isfinite(x) & np.isfinite(percentiles[i]) & np.isfinite(percentiles[-1 - i])
        known_x, low, high = x[known], percentiles[i][known], percentiles[-1 - i][known]
        yield np.append(known_x, known_x[::-1]), np.append(low, high[::-1]), opacity


def band_items(x: np.ndarray, percentiles: np.ndarray, colour: str) -> Iterator[Outline]:
    """Items that shade the two areas of a band, the outer one faintly."""
    for across, upwards, opacity in band_outlines(x, percentiles):
        item = Outline(pg.arrayToQPath(across, upwards), fill=brush(colour, opacity))
        item.setZValue(Z_REFERENCE - 1.0)
        yield item


def reference_entry(name: str, theme: Theme) -> Entry:
    """Legend entry of the dashed curves of another design."""
    return Entry(theme.quiet, name, DASHED_MARK)


def band_entry(theme: Theme, text: str = MACHINES) -> Entry:
    """Legend entry of the shaded bands."""
    return Entry(theme.quiet, text, "▒")
