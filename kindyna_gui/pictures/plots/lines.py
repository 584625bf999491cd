"""Lines, legend, mouse."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from html import escape
from itertools import product

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPainterPath, QPen
from PySide6.QtWidgets import QGraphicsTextItem, QGraphicsWidget, QStyleOptionGraphicsItem, QWidget

from core.frozen import frozen
from kindyna_gui.pictures.items import Outline, Tag
from kindyna_gui.pictures.style import SMALL, Theme, brush, font
from kindyna_gui.pictures.units import needed
from kindyna_gui.settings import sized

# -- frame -----------------------------------------------------------------------------------------------

LEFT_WIDTH, TOP_HEIGHT, BOTTOM_HEIGHT = 66, 17, 38  # of the axes, pixels
Z_BANDS, Z_GRID, Z_ZERO, Z_LIMIT, Z_REFERENCE, Z_CURVE, Z_CURSOR = -90.0, -80.0, -70.0, 5.0, 8.0, 10.0, 20.0


@frozen
class Frame:
    """What a plot shows at which size: values from low to high over first ... last, a turn of the cam [deg] by
    default, on width x height pixels."""

    low: float
    high: float
    width: float
    height: float
    first: float = 0.0
    last: float = 360.0

    def pixel(self, value: float) -> float:
        """Height of a value above the axis, pixels."""
        return (value - self.low) / (self.high - self.low) * self.height

    def value(self, pixel: float) -> float:
        return self.low + pixel / self.height * (self.high - self.low)


# -- legend ----------------------------------------------------------------------------------------------

LEGEND_HEIGHT = 18.0  # of the first line, pixels
LEAST_LINES = 2  # may always be taken
CUT = "…"
APART = "\u00a0\u00a0 "  # between names


@frozen
class Entry:
    """A name, with the colour of its curve and what stands for its stroke."""

    colour: str
    name: str
    mark: str = "—"


def rows_of(widths: Sequence[float], apart: float, room: float, most: int) -> list[list[int]]:
    """What stands on each line, by number: one beside the other as far as there is room; as many on each line as it
    takes where that would be more than so many lines."""
    rows = _filled(widths, apart, room)
    if len(rows) <= most:
        return rows
    each = -(-len(widths) // most)
    return [list(range(i, min(i + each, len(widths)))) for i in range(0, len(widths), each)]


def _filled(widths: Sequence[float], apart: float, room: float) -> list[list[int]]:
    rows: list[list[int]] = []
    used = 0.0
    for i, width in enumerate(widths):
        if rows and used + apart + width <= room:
            rows[-1].append(i)
            used += apart + width
        else:
            rows.append([i])
            used = width
    return rows


def cut(text: str, room: float, advance: Callable[[str], float]) -> str:
    """A text, its end left out where it is wider than the room."""
    if advance(text) <= room:
        return text
    kept = next((n for n in range(len(text) - 1, 0, -1) if advance(text[:n].rstrip() + CUT) <= room), 1)
    return text[:kept].rstrip() + CUT


class Legend(QGraphicsTextItem):
    """The entries laid out in the room they are given; nothing is done where neither changes."""

    def __init__(self, parent: QGraphicsWidget, ink: str, centred: bool = False) -> None:
        super().__init__(parent)
        self._entries: tuple[Entry, ...] = ()
        self._note, self._centred = "", centred
        self._laid: tuple[object, ...] = ()
        self.setDefaultTextColor(QColor(ink))
        self.height = 0.0
        self.update_font()

    def update_font(self) -> None:
        """Use the font size that is set now; `fit` lays the text out again."""
        self.setFont(font(SMALL))
        self._metrics = QFontMetricsF(self.font())
        self.setPlainText(APART)
        self._line = self.boundingRect().height()
        self.setPlainText("")
        self._laid = ()

    @property
    def text(self) -> str:
        """The legend as plain text."""
        return self.toPlainText()

    def set_entries(self, entries: Sequence[Entry], note: str = "") -> None:
        """note: behind the last name, where one line has room for all."""
        self._entries, self._note = tuple(entries), note

    def fit(self, room: QRectF) -> None:
        """Stand at the top of this room, no wider, and no higher if more than two lines; ``height`` is what that
        takes. A name that has no room is cut."""
        most = max(LEAST_LINES, 1 + int((room.height() - sized(LEGEND_HEIGHT)) / self._metrics.lineSpacing()))
        wanted = (self._entries, self._note, room.width(), most)
        if wanted != self._laid:
            self._laid = wanted
            self._write(room.width() - 2.0 * self.document().documentMargin(), most)
        box = self.boundingRect()
        if self._centred:
            box.moveCenter(QRectF(room.left(), room.top(), room.width(), self.height).center())
            self.setPos(box.topLeft())
        else:
            self.setPos(room.topLeft())

    def _write(self, room: float, most: int) -> None:
        advance = self._metrics.horizontalAdvance
        widths, apart = [advance(f"{e.mark} {e.name}") for e in self._entries], advance(APART)
        rows = rows_of(widths, apart, room, most)
        shares = [self._share([widths[i] for i in row], room - apart * (len(row) - 1)) for row in rows]
        parts = [[self._html(self._entries[i], share) for i in row] for row, share in zip(rows, shares, strict=True)]
        if self._note and sum(widths) + apart * len(widths) + advance(self._note) <= room:
            parts = [[*(part for row in parts for part in row), escape(self._note)]]
        self.setHtml("<br>".join(APART.join(row) for row in parts))
        more = self.boundingRect().height() - self._line
        self.height = sized(LEGEND_HEIGHT) + max(more, 0.0) if rows else 0.0

    @staticmethod
    def _share(widths: Sequence[float], room: float) -> float:
        """How wide an entry on a line may be: as it is where all have room."""
        return room if sum(widths) <= room else room / len(widths)

    def _html(self, entry: Entry, room: float) -> str:
        advance = self._metrics.horizontalAdvance
        name = cut(entry.name, room - advance(f"{entry.mark} "), advance)
        return f'<span style="color:{entry.colour};font-weight:bold">{entry.mark}</span> {escape(name)}'


# -- lines -----------------------------------------------------------------------------------------------

PLACES = (1.0, 0.0, 0.75, 0.5, 0.25)  # along a limit's line, for its text
BAND_STRENGTH = (0.16, 0.3)  # opacity of the outer band, of the inner one above it


class CurveLine(Outline):
    """A curve over the turn; on the screen it is drawn from those of its points that its size there needs.

    x, y    all its points (n,), in the units of the axes
    drawn   how many of them the path goes through
    """

    x: np.ndarray  # type: ignore[assignment]
    y: np.ndarray  # type: ignore[assignment]

    def __init__(self, view: pg.ViewBox) -> None:
        super().__init__(QPainterPath())
        self.x = self.y = np.zeros(0)
        self.drawn, self._whole = 0, True
        self._laid: tuple[object, ...] = ()
        view.addItem(self, ignoreBounds=True)

    def show_points(self, x: np.ndarray, y: np.ndarray, pen: QPen, z: float) -> None:
        """Be a curve through these points; a gap where y is NaN. To be laid before it is drawn."""
        self.x, self.y, self._whole = x, y, bool(np.isfinite(y).all())
        self._laid = ()
        self.setPen(pen)
        self.setZValue(z)

    def lay(self, frame: Frame, unseen: float) -> None:
        """Take the points that a plot of this size needs to be off by no more than ``unseen`` pixels; all where it is
        0."""
        wanted = (frame, unseen)
        if wanted == self._laid:
            return
        self._laid = wanted
        pixels = self.x * (frame.width / 360.0) + 1j * self.y * (frame.height / (frame.high - frame.low))
        kept = needed(pixels, unseen)
        self.drawn = int(kept.size)
        connect = "all" if self._whole else "finite"
        self.redraw(pg.arrayToQPath(self.x[kept], self.y[kept], connect, finiteCheck=not self._whole))

    def enters(self, box: QRectF, frame: Frame) -> bool:
        """Whether the curve comes into a box in the frame [pixels from its lower left corner, y upwards]."""
        first, last = np.searchsorted(self.x, np.array([box.left(), box.right()]) / frame.width * 360.0)
        part = self.y[max(first - 1, 0) : last + 1]
        part = part if self._whole else part[np.isfinite(part)]
        low, high = frame.value(box.top()), frame.value(box.bottom())
        return bool(part.size) and not (part.max() < low or part.min() > high)

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        super().paint(painter, option, widget)


class LimitLine:
    """A thin red line over the whole turn with its value at the right end."""

    def __init__(self, view: pg.ViewBox, theme: Theme, value: float = 0.0, text: str = "") -> None:
        path = QPainterPath()
        path.lineTo(360.0, 0.0)
        self._line = Outline(path, theme.pen(theme.limit))
        self._tag = Tag("", theme.limit, theme, SMALL, (1.0, 1.0), backing=True)
        self._items = (self._line, self._tag)
        for item, z in zip(self._items, (Z_LIMIT, Z_CURSOR + 1.0), strict=True):
            item.setZValue(z)
            view.addItem(item, ignoreBounds=True)
        self.set_value(value, text)

    def set_value(self, value: float, text: str, short: str = "", field: str = "") -> None:
        """Stand at this value with this text, or with the short one where it would cover a curve; field: where it is stated."""
        self.value, self.text, self._short, self.field = value, text, short, field
        self._tag.set_text(text)
        self._line.setPos(0.0, value)
        self._tag.setPos(360.0, value)

    def lay(self, low: float, high: float, height: float) -> None:
        """The text stands above the line at its right end, below it where there is no room."""
        self._stand(1.0, self._above(low, high, height))

    def lay_clear(self, frame: Frame, curves: Sequence[CurveLine], taken: Sequence[QRectF] = ()) -> None:
        """The same, but further left, below the line, or in short where it would cover a curve otherwise, or one of the boxes taken."""
        above = self._above(frame.low, frame.high, frame.height)
        room = QRectF(-1.0, 0.0, frame.width + 2.0, frame.height)
        for text, over, part in product((self.text, self._short), (above, not above), PLACES):
            self._tag.set_text(text)
            self._stand(part, over)
            box = self.box(frame).adjusted(0.0, -2.0, 0.0, 2.0)
            covers = any(curve.enters(box, frame) for curve in curves) or any(map(box.intersects, taken))
            if text and room.contains(box) and not covers:
                return
        self._tag.set_text(self.text)
        if self._short and self._tag.size[0] + 8.0 > frame.width:
            self._tag.set_text(self._short)
        self._stand(1.0, above)

    def _above(self, low: float, high: float, height: float) -> bool:
        return (high - self.value) / (high - low) * height > self._tag.size[1] + 2.0

    def _stand(self, part: float, above: bool) -> None:
        """At a part of the line's length, above or below it."""
        self._tag.setPos(360.0 * part, self.value)
        self._tag.set_lean(part, 1.0 if above else 0.0)
        self._tag.shift(4.0 - 8.0 * part, 0.0)

    def box(self, frame: Frame) -> QRectF:
        """Where the text stands in the frame, pixels from its lower left corner, y upwards."""
        box, place = self._tag.pixel_box(), frame.pixel(self.value)
        x = self._tag.pos().x() / 360.0 * frame.width
        return QRectF(x + box.left(), place - box.bottom(), box.width(), box.height())

    def remove(self, view: pg.ViewBox) -> None:
        for item in self._items:
            view.removeItem(item)


class Cursor(Outline):
    """The upright line at the cam angle."""

    def __init__(self, view: pg.ViewBox, theme: Theme) -> None:
        path = QPainterPath()
        path.lineTo(0.0, 1.0)
        super().__init__(path, theme.pen(theme.quiet))
        self.setZValue(Z_CURSOR)
        view.addItem(self, ignoreBounds=True)

    def span(self, low: float, high: float) -> None:
        """Reach over the values that are shown."""
        path = QPainterPath()
        path.moveTo(0.0, low)
        path.lineTo(0.0, high)
        self.redraw(path)

    def value(self) -> float:
        """The cam angle [deg]."""
        return float(self.pos().x())


def closed(band: np.ndarray, gain: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Cam angles [deg] (n + 1,) to the end of the turn, and the percentiles (5, n + 1) there, which grow by ``gain`` in a turn."""
    return np.linspace(0.0, 360.0, band.shape[1] + 1), np.column_stack([band, band[:, :1] + gain])


def rings(x: np.ndarray, ends: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray, float]]:
    """Round the area from the first to the last percentile (5, n), and from the second to the last but one: x, value (m,), opacity."""
    for i, strength in enumerate(BAND_STRENGTH):
        known = np.isfinite(x) & np.isfinite(ends[i]) & np.isfinite(ends[-1 - i])
        there, low, high = x[known], ends[i][known], ends[-1 - i][known]
        yield np.append(there, there[::-1]), np.append(low, high[::-1]), strength


def shades(x: np.ndarray, ends: np.ndarray, colour: str) -> Iterator[Outline]:
    """These areas, the outer one faint, as drawn."""
    for across, upwards, strength in rings(x, ends):
        item = Outline(pg.arrayToQPath(across, upwards), fill=brush(colour, strength))
        item.setZValue(Z_REFERENCE - 1.0)
        yield item


MACHINES = "90 and 99.73 % of machines"


def shades_entry(theme: Theme, text: str = MACHINES) -> Entry:
    """What the legend says of them."""
    return Entry(theme.quiet, text, "▒")
