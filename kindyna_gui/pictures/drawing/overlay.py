"""What stands in the corners of a picture of a mechanism, in pixels: cam angle, values under the mouse, scale bar, scales of
vectors and of colours."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QBrush, QPainterPath
from PySide6.QtWidgets import QGraphicsItem

from core.frozen import frozen
from kindyna_gui.pictures.drawing.profile_colours import ColourScale, bar_width, colour_bar
from kindyna_gui.pictures.items import Outline, Tag, text_size, wrapped
from kindyna_gui.pictures.style import OUTLINE, SMALL, TEXT, THIN, Theme, brush
from kindyna_gui.pictures.units import nice_below, readable, short, with_unit
from kindyna_gui.preferences.units import size_of, sized

MARGIN = 12.0  # from the picture's edge, pixels
TOP_STRIP, BOTTOM_STRIP = 30.0, 44.0  # of a picture, kept free of the mechanism, pixels
BAR_PIXELS, BAR_PART = 190.0, 0.35  # longest scale bar: pixels, part of the picture's width
ARROW_PIXELS = 90.0  # longest arrow of a legend
THICK = 5.0
COLOUR_BAR, COLOUR_HIGH, COLOUR_TICKS, COLOUR_ROW = 190.0, 7.0, 22.0, 46.0  # of a scale of colours, at least, pixels
Z_OVERLAY = 20.0


@frozen
class VectorUnit:
    """A scale of vectors: layer, colour, unit (as a channel spells it), length of the arrow of one unit [mm]."""

    layer: str
    family: str
    unit: str
    mm_per_unit: float


class _Corner(QGraphicsItem):
    """A place of the scene whose children are drawn in pixels, y downwards."""

    def __init__(self) -> None:
        super().__init__()
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemHasNoContents)
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemIgnoresTransformations)
        self.setZValue(Z_OVERLAY)

    def boundingRect(self) -> QRectF:
        return QRectF()

    def paint(self, *_: object) -> None:
        """Nothing of its own."""


class ScaleBar(_Corner):
    """A bar of two fields and a round length, on the lower left."""

    def __init__(self, theme: Theme) -> None:
        super().__init__()
        self._theme = theme
        self._frame = Outline(QPainterPath(), theme.pen(theme.ink, THIN), brush(theme.paper))
        self._field = Outline(QPainterPath(), theme.pen(theme.ink, THIN), brush(theme.ink))
        self._marks = [Tag("", theme.ink, theme, SMALL, (0.5, 1.0)) for _ in range(3)]
        for item in (self._frame, self._field, *self._marks):
            item.setParentItem(self)
        self.length_mm = 0.0

    @property
    def texts(self) -> list[str]:
        """What stands beside the bar."""
        return [mark.text for mark in self._marks]

    def lay(self, scale: float, width: float) -> None:
        """scale: pixels per mm; width: of the picture, pixels."""
        size = size_of("mm")  # round in the unit that is shown
        self.length_mm = nice_below(min(BAR_PIXELS, BAR_PART * width) / scale / size) * size
        width = self.length_mm * scale
        rung = readable("mm", self.length_mm)
        shown = self.length_mm / rung.size
        for path_item, left, right in ((self._frame, 0.0, width), (self._field, 0.0, width / 2)):
            path = QPainterPath()
            path.addRect(QRectF(left, -THICK, right - left, THICK))
            path_item.redraw(path)
        texts = ("0", short(shown / 2), with_unit(short(shown), rung.symbol))
        for part, (mark, text) in enumerate(zip(self._marks, texts, strict=True)):
            mark.set_text(text)
            mark.setPos(QPointF(part * width / 2, -THICK - 2.0))
        apart = width / 2 - 0.5 * (self._marks[1].size[0] + max(self._marks[0].size[0], self._marks[2].size[0]))
        self._marks[1].setVisible(apart > 4.0)


class VectorScale(_Corner):
    """An arrow of a round length with its value, on the lower right."""

    def __init__(self, row: VectorUnit, theme: Theme) -> None:
        super().__init__()
        colour = theme.family(row.family)
        self._row = row
        self._line = Outline(QPainterPath(), theme.pen(colour, OUTLINE), brush(colour))
        self._tag = Tag("", theme.ink, theme, SMALL, (1.0, 0.5))
        self._line.setParentItem(self)
        self._tag.setParentItem(self)

    @property
    def text(self) -> str:
        return self._tag.text

    @property
    def family(self) -> str:
        """The quantity."""
        return self._row.family

    def lay(self, scale: float) -> None:
        """scale: pixels per mm."""
        per_unit = self._row.mm_per_unit * scale
        if per_unit <= 0.0:
            return
        size = size_of(self._row.unit)
        value = nice_below(ARROW_PIXELS / per_unit / size) * size
        width = value * per_unit
        path = QPainterPath(QPointF(-width, 0.0))
        path.lineTo(-9.0, 0.0)
        for x, y in ((-9.0, -3.0), (0.0, 0.0), (-9.0, 3.0), (-9.0, 0.0)):
            path.lineTo(x, y)
        self._line.redraw(path)
        rung = readable(self._row.unit, value * 2.0)
        self._tag.set_text(f"{self._row.family} {with_unit(short(value / rung.size), rung.symbol)}")
        self._tag.setPos(QPointF(-width - 8.0, 0.0))


class ColourBar(_Corner):
    """The colours of a scale with its name and its ticks, on the lower right."""

    def __init__(self, scale: ColourScale, theme: Theme) -> None:
        super().__init__()
        self.width = width = max(COLOUR_BAR, bar_width(scale))
        path = QPainterPath()
        path.addRect(QRectF(0.0, 0.0, width, COLOUR_HIGH))
        self._bar = Outline(path, theme.pen(theme.ink, THIN), QBrush(scale.gradient(width)))
        self._bar.setParentItem(self)
        self._bar.setPos(-width, -COLOUR_HIGH)
        self._tags = [self._tag(scale.title, theme, -width, -COLOUR_HIGH - 2.0, (0.0, 1.0))]
        for x, text in colour_bar(scale, width):
            self._tags.append(self._tag(text, theme, x - width, 2.0, (x / width, 0.0)))

    def _tag(self, text: str, theme: Theme, x: float, y: float, lean: tuple[float, float]) -> Tag:
        tag = Tag(text, theme.ink, theme, SMALL, lean)
        tag.setParentItem(self)
        tag.setPos(x, y)
        return tag

    @property
    def texts(self) -> list[str]:
        """Its name, then its ticks."""
        return [tag.text for tag in self._tags]


class Overlay:
    """All corners of one scene."""

    def __init__(self, theme: Theme, add: Callable[[QGraphicsItem], None]) -> None:
        self._theme, self._add = theme, add
        self.bar = ScaleBar(theme)
        self.angle = _Corner()
        self._text = Tag("", theme.ink, theme, TEXT, (0.0, 0.0))
        self._text.setParentItem(self.angle)
        self.angle_name = "cam angle"
        self.vectors: dict[str, VectorScale] = {}
        self.colours: dict[str, ColourBar] = {}
        self.reading = _Corner()
        self._read = Tag("", theme.ink, theme, SMALL, (1.0, 0.0), backing=True)
        self._read.setParentItem(self.reading)
        self._reading_text, self._reading_room = "", 0.0
        add(self.reading)
        add(self.bar)
        add(self.angle)

    @property
    def text(self) -> str:
        return self._text.text

    def show_angle(self, degrees: float, turn: int = 0) -> None:
        """Write the angle [deg] at hand, and of which turn it is."""
        turns = f" {'+' if turn > 0 else '-'} {abs(turn)} turn{'s' if abs(turn) > 1 else ''}" if turn else ""
        self._text.set_text(f"{self.angle_name.capitalize()} {degrees:.1f}°{turns}")

    @property
    def reading_text(self) -> str:
        """The values under the mouse; empty where there are none."""
        return self._reading_text

    def show_reading(self, text: str) -> None:
        """Values at a place, beside the cam angle; empty: none."""
        if text != self._reading_text:
            self._reading_text = text
            self._read.set_text(wrapped(text, self._reading_room))
            self.reading.setVisible(bool(text))

    def add_colours(self, layer: str, scale: ColourScale) -> None:
        """The scale of a layer of colours."""
        self.colours[layer] = ColourBar(scale, self._theme)
        self._add(self.colours[layer])

    def drop_colours(self, remove: Callable[[QGraphicsItem], None]) -> None:
        """Take all scales of colours away."""
        for bar in self.colours.values():
            remove(bar)
        self.colours = {}

    def add_scale(self, row: VectorUnit) -> None:
        """A line for the length of the vectors of one layer."""
        self.vectors[row.layer] = VectorScale(row, self._theme)
        self._add(self.vectors[row.layer])

    def drop_scales(self, remove: Callable[[QGraphicsItem], None]) -> None:
        """Take the scales of all vectors away."""
        for arrow in self.vectors.values():
            remove(arrow)
        self.vectors = {}

    def show_layers(self, shown: Mapping[str, bool]) -> None:
        """Show what belongs to these layers (name -> shown), vectors of one quantity once."""
        self.bar.setVisible(shown["scale"])
        for layer, item in self.colours.items():
            item.setVisible(shown[layer])
        told: set[str] = set()
        for layer, arrow in self.vectors.items():  # layers of one quantity have one scale
            arrow.setVisible(shown[layer] and arrow.family not in told)
            told |= {arrow.family} if shown[layer] else set()

    def boxes(self, visible: QRectF, scale: float) -> list[QRectF]:
        """Where the corners are taken, in pixels of the whole scene, y downwards."""
        left, right = visible.left() * scale, visible.right() * scale
        top, low = -visible.bottom() * scale, -visible.top() * scale
        widest = text_size(f"{self.angle_name.capitalize()} 360.0°", TEXT)[0]
        boxes = [QRectF(left, top, max(widest, self._text.size[0]) + 2.0 * MARGIN, sized(TOP_STRIP))]
        if self.bar.isVisible():
            boxes.append(
                QRectF(left, low - sized(BOTTOM_STRIP), self.bar.length_mm * scale + 4.0 * MARGIN, sized(BOTTOM_STRIP))
            )
        shown = sum(arrow.isVisible() for arrow in self.vectors.values())
        bars = [bar.width + MARGIN for bar in self.colours.values() if bar.isVisible()]
        if shown or bars:
            high, wide = (
                sized((1.0 + 1.5 * shown) * MARGIN) + len(bars) * sized(COLOUR_ROW),
                max(2.5 * ARROW_PIXELS, *bars, 0.0),
            )
            boxes.append(QRectF(right - wide, low - high, wide, high))
        return boxes

    def lay(self, visible: QRectF, scale: float) -> None:
        """visible: the picture's rectangle [mm]; scale: pixels per mm."""
        edge = MARGIN / scale
        self.angle.setPos(visible.left() + edge, visible.bottom() - 0.7 * edge)
        self.bar.setPos(visible.left() + edge, visible.top() + edge)
        self.bar.lay(scale, visible.width() * scale)
        below = 0.0
        for bar in self.colours.values():
            if bar.isVisible():
                bar.setPos(visible.right() - edge, visible.top() + (below + sized(COLOUR_TICKS)) / scale)
                below += sized(COLOUR_ROW)
        for row, arrow in enumerate(arrow for arrow in self.vectors.values() if arrow.isVisible()):
            arrow.setPos(visible.right() - edge, visible.top() + (1.3 + sized(1.5) * row) * edge + below / scale)
            arrow.lay(scale)
        self.reading.setPos(visible.right() - edge, visible.bottom() - 0.7 * edge)
        self._reading_room = visible.width() * scale - self._text.size[0] - 4.0 * MARGIN
