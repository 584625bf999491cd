"""Items of a drawing: outlines, closed curves, texts of constant size and arrows; how they move; the visible region."""

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
from core.output.drawing.scales import UNSEEN, needed
from kindyna_gui.pictures.shapes import joined, outline
from kindyna_gui.pictures.style import SMALL, Theme, brush, font, no_pen
from kindyna_gui.pictures.units import level
from kindyna_gui.settings import sized

Move = Callable[[int], None]
"""Function that moves an item to its position at the sample with this index."""

# -- items -----------------------------------------------------------------------------------------------


class Outline(QGraphicsPathItem):
    """Path with a cosmetic pen, whose bounds are those of the path.

    Qt would interpret the pen's width in mm and stroke the full path to determine the bounds.
    """

    def __init__(self, path: QPainterPath, line: QPen | None = None, fill: QBrush | None = None) -> None:
        super().__init__(path)
        self.setPen(line if line is not None else no_pen())
        if fill is not None:
            self.setBrush(fill)
        self._bounds = path.controlPointRect()

    def boundingRect(self) -> QRectF:
        return self._bounds

    def redraw(self, path: QPainterPath) -> None:
        """Replace the path."""
        self.prepareGeometryChange()
        self._bounds = path.controlPointRect()
        self.setPath(path)


class Loop(Outline):
    """Closed line through many points (n,) [mm]; after ``look``, drawn through no more of them than its scale needs."""

    def __init__(self, points: np.ndarray, line: QPen, fill: QBrush | None = None) -> None:
        super().__init__(outline(points), line, fill)
        self._points = np.append(points, points[:1])
        self._level = 0.0

    def look(self, scale: float) -> None:
        """Thin the line for a scale [dots per mm]."""
        needed_level = level(scale)
        if needed_level != self._level:
            self._level = needed_level
            # the bounds are unchanged: those of the thinned line differ by less than can be seen
            self.setPath(outline(self._points[needed(self._points, UNSEEN / needed_level)[:-1]]))


class Silhouette(Outline):
    """Overlapping pieces drawn as one: first the edges of all pieces, then the fills."""

    def __init__(self, pieces: Sequence[QPainterPath], line: QPen, fill: QBrush) -> None:
        path = joined(*pieces)
        path.setFillRule(Qt.FillRule.WindingFill)
        super().__init__(path, line, fill)
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
    """Text of constant size at a position of the scene, upright at every zoom.

    Parameters
    ----------
    pixels : int
        Font size.
    lean : tuple of float
        Position in the text's box: (0, 0) is its top left corner, (1, 1) its bottom right corner.
    backing : bool
        Draw paper under the text.
    """

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
        """Draw nothing; the text is a child item."""

    @property
    def text(self) -> str:
        """Text that is shown."""
        return self._text.text()

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the text [pixels]."""
        box = self._text.boundingRect()
        return box.width(), box.height()

    def set_text(self, text: str) -> None:
        """Set the text."""
        if text != self._text.text():
            self._text.setText(text)
            self._lay()

    def set_lean(self, x: float, y: float) -> None:
        """Set the position in the text's box, (0, 0) at its top left corner."""
        if (x, y) != self._lean:
            self._lean = (x, y)
            self._lay()

    def set_colour(self, colour: str) -> None:
        """Set the colour of the text."""
        self._text.setBrush(brush(colour))

    def update_font(self) -> bool:
        """Use the font size that is set now; returns whether it is another one."""
        if self._text.font() == font(self._pixels):
            return False
        self._text.setFont(font(self._pixels))
        self._lay()
        return True

    def shift(self, x: float, y: float) -> None:
        """Shift the text from its position [pixels, y downwards]."""
        if (x, y) != self._shift:
            self._shift = (x, y)
            self._lay()

    def lead(self, shown: bool) -> None:
        """Show or hide a thin line from the position to the text."""
        self._line.setVisible(bool(shown))
        box = self.pixel_box().adjusted(-2.0, 0.0, 2.0, 0.0)
        x, y = min(max(0.0, box.left()), box.right()), min(max(0.0, box.top()), box.bottom())
        self._line.setLine(0.0, 0.0, x, y)

    def pixel_box(self) -> QRectF:
        """Box of the text relative to its position [pixels, y downwards]."""
        return QRectF(self._text.pos(), self._text.boundingRect().size())

    def _lay(self) -> None:
        width, height = self.size
        self._text.setPos(self._shift[0] - self._lean[0] * width, self._shift[1] - self._lean[1] * height)
        if self._backing is not None:
            self._backing.setRect(self.pixel_box().adjusted(-2.0, 0.0, 2.0, 0.0))


class Arrow(Outline):
    """Vector with a line and a filled arrowhead [mm]; nothing is drawn where it is very short."""

    def __init__(self, line: QPen, head_length: float) -> None:
        super().__init__(QPainterPath(), line, QBrush(QColor(line.color())))
        self._head_length = head_length

    def point(self, start: complex, vector: complex) -> None:
        """Draw the arrow from ``start`` along ``vector`` [mm]."""
        path, length = QPainterPath(), abs(vector)
        if math.isfinite(length) and length > 0.05 * self._head_length:
            along, head_length = vector / length, min(self._head_length, 0.6 * length)
            tip, neck = start + vector, start + vector - along * head_length
            side = 1j * along * head_length * 0.3
            path.moveTo(start.real, start.imag)
            path.lineTo(neck.real, neck.imag)
            for corner in (neck + side, tip, neck - side, neck):
                path.lineTo(corner.real, corner.imag)
        self.redraw(path)


@frozen(eq=False)
class DrawnPart:
    """Part of a drawing.

    Attributes
    ----------
    key : name of the part
    item : graphics item
    layers : layers that must all be shown
    z : order of drawing
    move : how the item moves, None where it is fixed
    """

    key: str
    item: QGraphicsItem
    layers: tuple[str, ...]
    z: float
    move: Move | None = None


def riding(item: QGraphicsItem, z: np.ndarray, turn: np.ndarray) -> Move:
    """Motion of an item with a body: origin z (n,) [mm], unit vector of its x axis (n,)."""

    def move(i: int) -> None:
        origin = complex(z[i])
        item.setPos(origin.real, origin.imag)
        item.setRotation(math.degrees(cmath.phase(turn[i])))

    return move


def turning(item: QGraphicsItem, angle: np.ndarray) -> Move:
    """Rotation of an item about the scene's origin by angle (n,) [deg]."""
    return lambda i: item.setRotation(float(angle[i]))


def pinned(item: QGraphicsItem, track: np.ndarray) -> Move:
    """Motion of an upright item along positions (n,) [mm]; it is hidden where the position is infinite."""
    return standing_at(item, track.__getitem__)


def standing_at(item: QGraphicsItem, position_at: Callable[[int], complex]) -> Move:
    """Motion of an upright item to the position [mm] at a sample's index; it is hidden where that is infinite."""

    def move(i: int) -> None:
        position = complex(position_at(i))
        is_finite = cmath.isfinite(position)
        item.setOpacity(1.0 if is_finite else 0.0)
        if is_finite:
            item.setPos(position.real, position.imag)

    return move


def text_size(text: str, pixels: int = SMALL) -> tuple[float, float]:
    """Width and height of a text [pixels] in a font size."""
    return _text_size(text, pixels, sized(pixels))


@lru_cache(maxsize=1024)
def _text_size(text: str, pixels: int, shown: float) -> tuple[float, float]:
    metrics = QFontMetricsF(font(pixels))
    return metrics.horizontalAdvance(text), metrics.height()


def wrapped(text: str, width: float, pixels: int = SMALL) -> str:
    """Break a text between words into lines of at most this width [pixels]; only a longer word exceeds it."""
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


# -- visible region --------------------------------------------------------------------------------------


class Viewport:
    """Visible region of a scene, which the scene updates.

    Attributes
    ----------
    visible : rectangle [mm], y upwards
    scale : pixels per mm
    """

    def __init__(self) -> None:
        self.visible, self.scale = QRectF(-100.0, -100.0, 200.0, 200.0), 1.0

    @property
    def centre(self) -> complex:
        """Centre of the region, x + iy [mm]."""
        centre = self.visible.center()
        return complex(centre.x(), centre.y())

    def holds(self, point: complex, margin: float = 0.0) -> bool:
        """Whether a point [mm] is visible, with a margin to the edge [pixels]."""
        room = margin / self.scale
        box = self.visible.adjusted(room, room, -room, -room)
        return box.left() <= point.real <= box.right() and box.top() <= point.imag <= box.bottom()

    def edge(self, towards: complex, margin: float) -> complex:
        """Point [mm] where the ray from the centre in a direction meets the edge, less a margin [pixels]."""
        room = margin / self.scale
        half = complex(self.visible.width() / 2.0 - room, self.visible.height() / 2.0 - room)
        direction = towards / abs(towards)
        reach = min(
            half.real / abs(direction.real) if abs(direction.real) > 1e-12 else np.inf,
            half.imag / abs(direction.imag) if abs(direction.imag) > 1e-12 else np.inf,
        )
        return self.centre + reach * direction

    def across(self, line: np.ndarray) -> tuple[complex, complex] | None:
        """Ends [mm] of the visible part of the line a x + b y + c = 0, (a, b, c) with c in mm; None where there is none."""
        a, b, c = (float(part) for part in line)
        length = float(np.hypot(a, b))
        if length == 0.0 or not np.isfinite(length + c):
            return None
        normal = complex(a, b) / length
        middle = self.centre - normal * ((normal.conjugate() * self.centre).real + c / length)
        along = 1j * normal
        low, high = -np.inf, np.inf
        sides = (
            (middle.real, along.real, self.visible.left(), self.visible.right()),
            (middle.imag, along.imag, self.visible.top(), self.visible.bottom()),
        )
        for start, rate, least, greatest in sides:
            if abs(rate) < 1e-12:
                if not least <= start <= greatest:
                    return None
                continue
            ends = sorted(((least - start) / rate, (greatest - start) / rate))
            low, high = max(low, ends[0]), min(high, ends[1])
        return (middle + low * along, middle + high * along) if low < high else None
