"""The values of the curves beside the cursor."""

from __future__ import annotations

from collections.abc import Sequence

import pyqtgraph as pg
from PySide6.QtCore import QRectF
from PySide6.QtGui import QPainterPath

from kindyna_gui.pictures.items import Outline, Tag
from kindyna_gui.pictures.plots.frame import Z_CURSOR, Frame
from kindyna_gui.pictures.style import SMALL, Theme, brush
from kindyna_gui.pictures.units import DisplayUnit, measure
from kindyna_gui.preferences.units import sized

SIDE = 6.0  # of a text from the cursor's line, pixels
LIFT = 9.0  # of its middle above the value, so that a level curve is not covered


class Readout:
    """A curve's value beside the cursor, with a dot on the curve."""

    def __init__(self, view: pg.ViewBox, theme: Theme) -> None:
        self._theme, self._colour = theme, ("", "")
        dot = QPainterPath()
        dot.addEllipse(QRectF(-3.0, -3.0, 6.0, 6.0))
        self.dot = Outline(dot, theme.pen(theme.paper))
        self.dot.setFlag(self.dot.GraphicsItemFlag.ItemIgnoresTransformations)
        self.tag = Tag("", theme.ink, theme, SMALL, (0.0, 0.5), backing=True)
        self.hide()
        for item in (self.dot, self.tag):
            item.setZValue(Z_CURSOR)
            view.addItem(item, ignoreBounds=True)

    def set_colour(self, colour: str) -> None:
        if (colour, self._theme.paper) != self._colour:
            self._colour = (colour, self._theme.paper)
            self.dot.setBrush(brush(colour))
            self.tag.set_colour(self._theme.letters(colour))

    def hide(self) -> None:
        self.dot.setVisible(False)
        self.tag.setVisible(False)

    def remove(self, view: pg.ViewBox) -> None:
        view.removeItem(self.dot)
        view.removeItem(self.tag)


def place_readouts(
    readouts: Sequence[Readout],
    at: float,
    values: Sequence[float],
    rung: DisplayUnit,
    frame: Frame,
    others: Sequence[QRectF] = (),
) -> list[QRectF]:
    """Write the values beside the cursor at this place of the x axis: on its right, on its left where there is no room, one
    above the other in their order, all within the frame and, where there is room, clear of other texts (boxes as of
    ``LimitLine.box``); the boxes that they take."""
    rows = []
    for reading, value in zip(readouts, values, strict=True):
        known = abs(value) < float("inf")
        reading.tag.set_text(measure(value, rung.symbol))
        reading.dot.setVisible(known)
        reading.tag.setVisible(True)
        if known:
            reading.dot.setPos(at, value)
        rows.append((frame.pixel(value) + sized(LIFT) if known else frame.height / 2, reading.tag))
    widest = max((tag.size[0] for _, tag in rows), default=0.0)
    line = (at - frame.first) / (frame.last - frame.first) * frame.width
    right = line + SIDE + widest + 4.0 <= frame.width
    reach = (line, line + SIDE + widest + 2.0) if right else (line - SIDE - widest - 2.0, line)
    boxes = [box for box in others if reach[0] < box.right() and box.left() < reach[1]]
    taken = [(box.top(), box.bottom()) for box in boxes]
    heights = beside(taken, [row[0] for row in rows], rows[0][1].size[1] if rows else 0.0, frame.height)
    for (_, tag), height in zip(rows, heights, strict=True):
        tag.set_lean(0.0 if right else 1.0, 0.5)
        tag.shift(SIDE if right else -SIDE, 0.0)
        tag.setPos(at, frame.value(height))
    lefts = [line + SIDE if right else line - SIDE - tag.size[0] for _, tag in rows]
    return [
        QRectF(left, height - tag.size[1] / 2.0, *tag.size)
        for left, height, (_, tag) in zip(lefts, heights, rows, strict=True)
    ]


def beside(taken: Sequence[tuple[float, float]], middles: Sequence[float], height: float, room: float) -> list[float]:
    """``stacked`` in what is left of 0 ... room besides what is taken (from, to); in all of it where that is too
    little."""
    gaps, low = [], 0.0
    for start, end in [*sorted(taken), (room, room)]:
        if start - low >= height + 2.0:
            gaps.append((low, start))
        low = max(low, end)
    if not taken or not gaps:
        return stacked(middles, height, room)
    chosen: dict[tuple[float, float], list[int]] = {gap: [] for gap in gaps}
    for i, middle in enumerate(middles):
        free = [gap for gap in gaps if (len(chosen[gap]) + 1) * height + 2.0 <= gap[1] - gap[0]]
        if not free:
            return stacked(middles, height, room)
        near = min(free, key=lambda gap: max(gap[0] + height / 2 - middle, middle - gap[1] + height / 2, 0.0))
        chosen[near].append(i)
    placed = list(middles)
    for (low, high), inside in chosen.items():
        heights = stacked([middles[i] - low for i in inside], height, high - low)
        for i, at in zip(inside, heights, strict=True):
            placed[i] = at + low
    return placed


def stacked(middles: Sequence[float], height: float, room: float) -> list[float]:
    """Middles of boxes of one height, moved apart and into 0 ... room as little as that needs."""
    order = sorted(range(len(middles)), key=lambda i: middles[i])
    placed = [min(max(middles[i], height / 2 + 1.0), room - height / 2 - 1.0) for i in order]
    for i in range(1, len(placed)):
        placed[i] = max(placed[i], placed[i - 1] + height)
    over = placed[-1] - (room - height / 2 - 1.0) if placed else 0.0
    if over > 0.0:
        placed[-1] -= over
        for i in range(len(placed) - 2, -1, -1):
            placed[i] = min(placed[i], placed[i + 1] - height)
    back = dict(zip(order, placed, strict=True))
    return [back[i] for i in range(len(middles))]
