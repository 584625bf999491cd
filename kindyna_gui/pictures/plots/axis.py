"""An axis of a plot, with the ticks that it is given."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from html import escape
from types import MappingProxyType

import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QPainter, QPen
from PySide6.QtWidgets import QGraphicsItem

from core.frozen import frozen
from kindyna_gui.pictures.style import SMALL, TEXT, Theme, font
from kindyna_gui.preferences.units import sized

_ROOM = QRectF(0.0, 0.0, 100.0, 100.0)  # a text is measured in
TITLE_BACK = 9.0  # pixels
_SLIM = 0.8  # of the height that is measured: what letters take of it
Line = tuple[QPen, QPointF, QPointF]
Flags = Qt.AlignmentFlag | Qt.TextFlag
Text = tuple[QRectF, Flags, str]


class Axis(pg.AxisItem):
    """An axis that shows the ticks it is given, in the quiet colour of the paper; shown: their values and texts."""

    def __init__(self, orientation: str, theme: Theme, line: bool = True) -> None:
        super().__init__(orientation, pen=theme.pen(theme.quiet), textPen=theme.pen(theme.ink), maxTickLength=-4)
        self._title = ("", "")
        self.shown: list[tuple[float, str]] = []
        self._sizes: dict[str, tuple[float, float]] = {}
        self.setTicks([[]])
        self.enableAutoSIPrefix(False)
        self.setStyle(tickFont=font(SMALL), autoExpandTextSpace=False, hideOverlappingLabels=False, tickTextOffset=4)
        if not line:
            self.setStyle(tickLength=0, tickTextOffset=1)
            self.setPen(theme.pen(theme.faint))
            hidden = theme.pen(theme.faint)
            hidden.setCapStyle(Qt.PenCapStyle.FlatCap)  # a tick without length leaves no dot
            self.setTickPen(hidden)
            self.setTextPen(theme.pen(theme.quiet))

    def letter(self) -> None:
        """Be written in the letters of now."""
        self._sizes = {}
        self.setStyle(tickFont=font(SMALL))
        self.title_anew(str)

    def show_ticks(self, rows: Sequence[tuple[float, str]]) -> None:
        """Ticks at these values with these texts, and no others."""
        if list(rows) != self.shown:  # pyqtgraph would draw the axis anew
            self.shown = list(rows)
            self.setTicks([self.shown])

    def show_title(self, text: str, colour: str) -> None:
        """The axis' name; put in the middle anew, which setLabel alone does not do."""
        style = {"color": colour, "font-size": f"{round(sized(TEXT))}px"}
        if (text, colour) != self._title:
            self._title = (text, colour)
            self.setLabel(re.sub(r"_(\w+)", r"<sub>\1</sub>", escape(text)), **style)
            self.resizeEvent()
            _forget(self.label)

    def title_anew(self, colour: Callable[[str], str]) -> None:
        """The name, its colour and size as they are now."""
        (text, before), self._title = self._title, ("", "")
        self.show_title(text, colour(before))

    def resizeEvent(self, event: object = None) -> None:
        """On the right pyqtgraph would let the title hang over the end."""
        super().resizeEvent(event)
        _forget(self)
        if self.orientation == "right" and getattr(self, "label", None) is not None:
            self.label.moveBy(-sized(TITLE_BACK), 0.0)

    # -- drawing --------------------------------------------------------------------------------------------

    def generateDrawSpecs(self, painter: QPainter) -> tuple[Line, list[Line], list[Text]]:
        """Axis, ticks and texts where pyqtgraph puts them; as the ticks are given, nothing is searched."""
        side, bounds, whole = _SIDES[self.orientation], self.mapRectFromParent(self.geometry()), self.boundingRect()
        low, high = self.range
        pixels = side.length(bounds) / ((high - low) or 1.0)
        ticks_shown = [
            (side.at(bounds, (value - low) * pixels), text) for value, text in self.shown if low <= value <= high
        ]
        pen, reach = self.tickPen(), side.outwards * self.style["tickLength"]
        ticks = [(pen, place, place + reach) for place, _ in ticks_shown]
        texts: list[Text] = []
        if self.style["showValues"]:
            painter.setFont(self.style["tickFont"])
            self._sizes = {text: self._sizes.get(text) or _size(painter, text) for _, text in ticks_shown}
            away = side.outwards * (max(0.0, self.style["tickLength"]) + self.style["tickTextOffset"][side.across])
            boxes = ((side.box(place + away, *self._sizes[text]), text) for place, text in ticks_shown)
            texts = [(box, side.flags, text) for box, text in boxes if whole & box == box]
        return (self.pen(), *side.line(bounds)), ticks, texts

    def wheelEvent(self, event: object) -> None:
        """Left to the view around."""

    def mouseDragEvent(self, event: object) -> None:
        """Left to the view around."""


def _forget(item: QGraphicsItem) -> None:
    """What is kept of an item as pixels: where its size changes Qt would paint the new part only."""
    kept = item.cacheMode()
    item.setCacheMode(item.CacheMode.NoCache)
    item.setCacheMode(kept)


def _size(painter: QPainter, text: str) -> tuple[float, float]:
    box = painter.boundingRect(_ROOM, Qt.AlignmentFlag.AlignCenter, text)
    return box.width(), _SLIM * box.height()


@frozen
class _Side:
    """An axis on one side of the plot. outwards: unit vector; across: 0 where values go upwards, 1 to the right; of a
    rectangle its length, its line from end to end, and a place so many pixels along it; the box of a text of some size
    whose middle is nearest to the axis there, and how it stands in it."""

    outwards: QPointF
    across: int
    length: Callable[[QRectF], float]
    line: Callable[[QRectF], tuple[QPointF, QPointF]]
    at: Callable[[QRectF, float], QPointF]
    box: Callable[[QPointF, float, float], QRectF]
    flags: Flags


_Align, _WHOLE = Qt.AlignmentFlag, Qt.TextFlag.TextDontClip
_SIDES: Mapping[str, _Side] = MappingProxyType(
    {
        "left": _Side(
            QPointF(-1.0, 0.0), 0, QRectF.height,
            lambda r: (r.topRight() + QPointF(-1.0, -1.0), r.bottomRight() + QPointF(-1.0, 1.0)),
            lambda r, along: QPointF(r.right(), r.height() - along),
            lambda at, width, height: QRectF(at.x() - width, at.y() - height / 2.0, width, height),
            _Align.AlignRight | _Align.AlignVCenter | _WHOLE,
        ),
        "right": _Side(
            QPointF(1.0, 0.0), 0, QRectF.height,
            lambda r: (r.topLeft() + QPointF(1.0, -1.0), r.bottomLeft() + QPointF(1.0, 1.0)),
            lambda r, along: QPointF(r.left(), r.height() - along),
            lambda at, width, height: QRectF(at.x(), at.y() - height / 2.0, width, height),
            _Align.AlignLeft | _Align.AlignVCenter | _WHOLE,
        ),
        "bottom": _Side(
            QPointF(0.0, 1.0), 1, QRectF.width,
            lambda r: (r.topLeft() + QPointF(-1.0, 1.0), r.topRight() + QPointF(1.0, 1.0)),
            lambda r, along: QPointF(along, r.top()),
            lambda at, width, height: QRectF(at.x() - width / 2.0, at.y(), width, height),
            _Align.AlignHCenter | _Align.AlignTop | _WHOLE,
        ),
        "top": _Side(
            QPointF(0.0, -1.0), 1, QRectF.width,
            lambda r: (r.bottomLeft() + QPointF(-1.0, -1.0), r.bottomRight() + QPointF(1.0, -1.0)),
            lambda r, along: QPointF(along, r.bottom()),
            lambda at, width, height: QRectF(at.x() - width / 2.0, at.y() - height, width, height),
            _Align.AlignHCenter | _Align.AlignBottom | _WHOLE,
        ),
    }
)  # fmt: skip


__all__ = ["Axis"]
