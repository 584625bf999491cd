"""Graphics items."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QFontMetricsF, QPainter, QPainterPath, QPen
from PySide6.QtWidgets import (
    QGraphicsItem,
    QGraphicsLineItem,
    QGraphicsPathItem,
    QGraphicsRectItem,
    QGraphicsSimpleTextItem,
    QStyleOptionGraphicsItem,
    QWidget,
)

from core.frozen import frozen
from kindyna_gui.pictures.shapes import joined, outline
from kindyna_gui.pictures.style import SMALL, Theme, brush, font, no_pen
from kindyna_gui.pictures.units import UNSEEN, level, needed
from kindyna_gui.settings import sized

# -- items -----------------------------------------------------------------------------------------------

Move = Callable[[int], None]
"""Puts an item where it belongs at the sample of this index."""


class Outline(QGraphicsPathItem):
    """A path with a cosmetic pen. Qt would take the pen's width for mm and stroke the whole path to find its bounds."""

    def __init__(self, path: QPainterPath, line: QPen | None = None, fill: QBrush | None = None) -> None:
        super().__init__(path)
        self.setPen(line if line is not None else no_pen())
        if fill is not None:
            self.setBrush(fill)
        self._bounds = path.controlPointRect()

    def boundingRect(self) -> QRectF:
        return self._bounds

    def redraw(self, path: QPainterPath) -> None:
        """Draw this path from now on."""
        self.prepareGeometryChange()
        self._bounds = path.controlPointRect()
        self.setPath(path)


class Loop(Outline):
    """A closed line through many points (n,) [mm], drawn from those that its scale needs; from all until ``look`` is called."""

    def __init__(self, points: np.ndarray, line: QPen, fill: QBrush | None = None) -> None:
        super().__init__(outline(points), line, fill)
        self._points = np.append(points, points[:1])
        self._level = 0.0

    def look(self, scale: float) -> None:
        """Be drawn at so many dots per mm."""
        wanted = level(scale)
        if wanted != self._level:
            self._level = wanted
            # the box stays: that of the kept points is the same within what nobody sees
            self.setPath(outline(self._points[needed(self._points, UNSEEN / wanted)[:-1]]))


class Silhouette(Outline):
    """Pieces that overlap, drawn as one: the edges of all, then over them the fill of all."""

    def __init__(self, pieces: Sequence[QPainterPath], line: QPen, fill: QBrush) -> None:
        whole = joined(*pieces)
        whole.setFillRule(Qt.FillRule.WindingFill)
        super().__init__(whole, line, fill)
        self._pieces = tuple(pieces)

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        painter.setBrush(Qt.BrushStyle.NoBrush)
        edge = self.pen()
        edge.setWidthF(2.0 * edge.widthF())  # the fill covers the inner half
        painter.setPen(edge)
        for piece in self._pieces:
            painter.drawPath(piece)
        painter.setBrush(self.brush())
        painter.setPen(Qt.PenStyle.NoPen)
        for piece in self._pieces:
            painter.drawPath(piece)


class Tag(QGraphicsItem):
    """A text of constant size at a place of the scene, upright at every zoom; ``lean``: where the place lies in
    the text's box: (0, 0) top left, (1, 1) bottom right; ``backing``: paper under the text."""

    def __init__(
        self,
        text: str,
        colour: str,
        theme: Theme,
        pixels: int = SMALL,
        lean: tuple[float, float] = (0.5, 0.5),
        backing: bool = False,
    ) -> None:
        super().__init__()
        self._pixels = pixels
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemHasNoContents)
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemIgnoresTransformations)
        self._backing = QGraphicsRectItem(self) if backing else None
        if self._backing is not None:
            self._backing.setPen(no_pen())
            self._backing.setBrush(brush(theme.paper, 0.85))
        self._text = QGraphicsSimpleTextItem(text, self)
        self._text.setFont(font(pixels))
        self._text.setBrush(brush(colour))
        self._line = QGraphicsLineItem(self)
        self._line.setPen(theme.pen(colour))
        self._line.setOpacity(0.5)
        self._line.hide()
        self._lean = lean
        self._shift = (0.0, 0.0)
        self._lay()

    def boundingRect(self) -> QRectF:
        return QRectF()

    def paint(self, *_: object) -> None:
        """Nothing of its own."""

    @property
    def text(self) -> str:
        return self._text.text()

    @property
    def size(self) -> tuple[float, float]:
        """Width and height in pixels."""
        box = self._text.boundingRect()
        return box.width(), box.height()

    def set_text(self, text: str) -> None:
        if text != self._text.text():
            self._text.setText(text)
            self._lay()

    def set_lean(self, x: float, y: float) -> None:
        if (x, y) != self._lean:
            self._lean = (x, y)
            self._lay()

    def set_colour(self, colour: str) -> None:
        self._text.setBrush(brush(colour))

    def update_font(self) -> None:
        """Use the font size that is set now."""
        self._text.setFont(font(self._pixels))
        self._lay()

    def shift(self, x: float, y: float) -> None:
        """Move the text by so many pixels from its place, y downwards."""
        if (x, y) != self._shift:
            self._shift = (x, y)
            self._lay()

    def lead(self, wanted: bool) -> None:
        """Draw or leave out a thin line from the place to the text."""
        self._line.setVisible(bool(wanted))
        box = self.pixel_box().adjusted(-2.0, 0.0, 2.0, 0.0)
        x, y = min(max(0.0, box.left()), box.right()), min(max(0.0, box.top()), box.bottom())
        self._line.setLine(0.0, 0.0, x, y)

    def pixel_box(self) -> QRectF:
        """The text's box in pixels about its place, y downwards."""
        return QRectF(self._text.pos(), self._text.boundingRect().size())

    def _lay(self) -> None:
        width, height = self.size
        self._text.setPos(self._shift[0] - self._lean[0] * width, self._shift[1] - self._lean[1] * height)
        if self._backing is not None:
            self._backing.setRect(self.pixel_box().adjusted(-2.0, 0.0, 2.0, 0.0))


class Arrow(Outline):
    """A vector from a place: shaft and filled head; nothing where it is shorter than a hair."""

    def __init__(self, line: QPen, head: float) -> None:
        super().__init__(QPainterPath(), line, QBrush(QColor(line.color())))
        self._head = head

    def point(self, place: complex, vector: complex) -> None:
        """Draw from ``place`` [mm] along ``vector`` [mm]."""
        path, length = QPainterPath(), abs(vector)
        if math.isfinite(length) and length > 0.05 * self._head:
            along, head = vector / length, min(self._head, 0.6 * length)
            tip, neck = place + vector, place + vector - along * head
            side = 1j * along * head * 0.3
            path.moveTo(place.real, place.imag)
            path.lineTo(neck.real, neck.imag)
            for corner in (neck + side, tip, neck - side, neck):
                path.lineTo(corner.real, corner.imag)
        self.redraw(path)


@frozen(eq=False)
class DrawnPart:
    """One thing drawn: its key, its item, the layers that must all be shown, and how it moves (None: it stands)."""

    key: str
    item: QGraphicsItem
    layers: tuple[str, ...]
    z: float
    move: Move | None = None


def riding(item: QGraphicsItem, z: np.ndarray, angle: np.ndarray) -> Move:
    """The item moves with a body: origin z (n,) [mm], angle (n,) [deg]."""

    def move(i: int) -> None:
        place = complex(z[i])
        item.setPos(place.real, place.imag)
        item.setRotation(float(angle[i]))

    return move


def turning(item: QGraphicsItem, angle: np.ndarray) -> Move:
    """The item turns about the scene's origin by angle (n,) [deg]."""
    return lambda i: item.setRotation(float(angle[i]))


def pinned(item: QGraphicsItem, track: np.ndarray) -> Move:
    """The item stays upright at a moving place (n,) [mm]; it is not seen where the place is infinite."""
    return standing_at(item, track.__getitem__)


def standing_at(item: QGraphicsItem, place_at: Callable[[int], complex]) -> Move:
    """The same of a place that is found for the sample of an index."""

    def move(i: int) -> None:
        place = complex(place_at(i))
        seen = cmath.isfinite(place)
        item.setOpacity(1.0 if seen else 0.0)
        if seen:
            item.setPos(place.real, place.imag)

    return move


def text_size(text: str, pixels: int = SMALL) -> tuple[float, float]:
    """Width and height of a text in pixels."""
    return _text_size(text, pixels, sized(pixels))


@lru_cache(maxsize=1024)
def _text_size(text: str, pixels: int, shown: float) -> tuple[float, float]:
    metrics = QFontMetricsF(font(pixels))
    return metrics.horizontalAdvance(text), metrics.height()


def wrapped(text: str, width: float, pixels: int = SMALL) -> str:
    """A text with its lines broken between words so that none is wider, if it can be helped [pixels]."""
    lines: list[str] = []
    for paragraph in text.split("\n") if text else ():
        line = ""
        for word in paragraph.split(" "):
            longer = f"{line} {word}" if line else word
            if line and text_size(longer, pixels)[0] > width:
                lines.append(line)
                line = word
            else:
                line = longer
        lines.append(line)
    return "\n".join(lines)


# -- viewport --------------------------------------------------------------------------------------------


class Viewport:
    """visible: rectangle [mm], y upwards; scale: pixels per mm. The scene keeps it up to date."""

    def __init__(self) -> None:
        self.visible, self.scale = QRectF(-100.0, -100.0, 200.0, 200.0), 1.0

    @property
    def centre(self) -> complex:
        """Of what is visible, x + iy [mm]."""
        place = self.visible.center()
        return complex(place.x(), place.y())

    def holds(self, place: complex, margin: float = 0.0) -> bool:
        """Whether a place [mm] is visible, and so many pixels away from the edge."""
        room = margin / self.scale
        box = self.visible.adjusted(room, room, -room, -room)
        return box.left() <= place.real <= box.right() and box.top() <= place.imag <= box.bottom()

    def edge(self, towards: complex, margin: float) -> complex:
        """Where the ray from the middle leaves the picture, so many pixels before its edge [mm]."""
        room = margin / self.scale
        half = complex(self.visible.width() / 2.0 - room, self.visible.height() / 2.0 - room)
        direction = towards / abs(towards)
        reach = min(
            half.real / abs(direction.real) if abs(direction.real) > 1e-12 else np.inf,
            half.imag / abs(direction.imag) if abs(direction.imag) > 1e-12 else np.inf,
        )
        return self.centre + reach * direction

    def across(self, line: np.ndarray) -> tuple[complex, complex] | None:
        """The part of the line a x + b y + c = 0 [mm] that is visible; None where none is."""
        a, b, c = (float(part) for part in line)
        length = float(np.hypot(a, b))
        if length == 0.0 or not np.isfinite(length + c):
            return None
        normal = complex(a, b) / length
        foot = self.centre - normal * ((normal.conjugate() * self.centre).real + c / length)
        along = 1j * normal
        low, high = -np.inf, np.inf
        sides = (
            (foot.real, along.real, self.visible.left(), self.visible.right()),
            (foot.imag, along.imag, self.visible.top(), self.visible.bottom()),
        )
        for start, rate, least, most in sides:
            if abs(rate) < 1e-12:
                if not least <= start <= most:
                    return None
                continue
            ends = sorted(((least - start) / rate, (most - start) / rate))
            low, high = max(low, ends[0]), min(high, ends[1])
        return (foot + low * along, foot + high * along) if low < high else None
