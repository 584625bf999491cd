"""Change of theme in an open window: each colour is replaced by the one of the same tone in the new theme.

All colours of the window come from a ``Theme``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import fields
from functools import cache, partial
from itertools import product
from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtGui import QBrush, QColor, QIcon, QPalette, QPen
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractGraphicsShapeItem,
    QComboBox,
    QGraphicsItem,
    QGraphicsLineItem,
    QGraphicsTextItem,
    QGraphicsView,
    QLabel,
    QListWidget,
    QTabBar,
    QTableWidget,
    QTreeWidget,
    QTreeWidgetItem,
    QWidget,
)

from core.output.drawing.palette import FAMILIES
from kindyna_gui.pictures.plots.library import pg
from kindyna_gui.pictures.plots.plot import Axis
from kindyna_gui.pictures.style import BALANCE, DRIVES, Theme, icon_maker, shade

_HEX = re.compile(r"#[0-9A-Fa-f]{6}\b")
_SHADES = 4  # of a colour of curves
_BRUSHES = tuple(
    product(
        (QPalette.ColorGroup.Active, QPalette.ColorGroup.Inactive, QPalette.ColorGroup.Disabled),
        [role for role in QPalette.ColorRole if role != QPalette.ColorRole.NColorRoles],
    )
)
"""Group and role of every brush of a palette."""


def _tones(theme: Theme) -> Iterator[str]:
    """All colours that a theme draws with, in the same order for every theme."""
    for field in fields(Theme):
        value = getattr(theme, field.name)
        yield from (value,) if isinstance(value, str) else value if isinstance(value, tuple) else ()
    for hue in (*FAMILIES.values(), *DRIVES, BALANCE):
        seen = theme.seen(hue)
        shades = [theme.seen(shade(seen, number)) for number in range(_SHADES)]
        yield from (seen, *shades, *(theme.text_colour(tone) for tone in shades))


def _descendants(item: QTreeWidgetItem) -> Iterator[QTreeWidgetItem]:
    for child in (item.child(number) for number in range(item.childCount())):
        yield child
        yield from _descendants(child)


@cache
def swap_between(before: Theme, after: Theme) -> Swap:
    """Replacement of the colours of one theme by those of another."""
    return Swap(before, after)


class Swap:
    """Replacement of the colours of one theme by those of another, of which one is enough for each pair."""

    def __init__(self, before: Theme, after: Theme) -> None:
        self._after: dict[str, str] = {}
        self._brushes: dict[int, list[tuple[QPalette.ColorGroup, QPalette.ColorRole]]] = {}
        for old, new in zip(_tones(before), _tones(after), strict=True):
            self._after.setdefault(old.lower(), new)

    def colour(self, colour: QColor) -> QColor:
        """Colour of the same tone and opacity; a colour that belongs to no theme is unchanged."""
        after = self._after.get(colour.name())
        if after is None:
            return colour
        result = QColor(after)
        result.setAlpha(colour.alpha())
        return result

    def text(self, text: str) -> str:
        """Replace the colours of a style sheet or of rich text."""
        return _HEX.sub(lambda match: self._after.get(match[0].lower(), match[0]), text)

    def pen(self, pen: QPen) -> QPen:
        """Pen in the new colour."""
        result = QPen(pen)
        result.setColor(self.colour(pen.color()))
        return result

    def brush(self, brush: QBrush) -> QBrush:
        """Brush in the new colour."""
        result = QBrush(brush)
        if brush.style() == Qt.BrushStyle.SolidPattern:
            result.setColor(self.colour(brush.color()))
        return result

    def widget(self, widget: QWidget) -> None:
        """Replace a widget's colours: palette, style sheet, rich text, icons, cells of a list, items of a scene."""
        if widget.testAttribute(Qt.WidgetAttribute.WA_SetPalette):
            widget.setPalette(self._palette(widget.palette()))
        if (sheet := widget.styleSheet()) != (after := self.text(sheet)):
            widget.setStyleSheet(after)
        for action in widget.actions():
            self._icon(action.icon(), action.setIcon)
        if isinstance(widget, QLabel) and "#" in widget.text():
            widget.setText(self.text(widget.text()))
        elif isinstance(widget, QAbstractButton):
            self._icon(widget.icon(), widget.setIcon)
        elif isinstance(widget, QTabBar):
            for i in range(widget.count()):
                self._icon(widget.tabIcon(i), partial(widget.setTabIcon, i))
        elif isinstance(widget, QComboBox):
            for i in range(widget.count()):
                self._icon(widget.itemIcon(i), partial(widget.setItemIcon, i))
        elif isinstance(widget, QGraphicsView):
            widget.setBackgroundBrush(self.brush(widget.backgroundBrush()))
            if (scene := widget.scene()) is not None:
                scene.setBackgroundBrush(self.brush(scene.backgroundBrush()))
                for item in scene.items():
                    self.item(item)
        elif isinstance(widget, QListWidget | QTableWidget | QTreeWidget):
            before = widget.blockSignals(True)  # no cell was edited
            self._lists(widget)
            widget.blockSignals(before)

    def _lists(self, widget: QListWidget | QTableWidget | QTreeWidget) -> None:
        if isinstance(widget, QListWidget):
            self._cells((widget.item(row), ()) for row in range(widget.count()))
        elif isinstance(widget, QTableWidget):
            cells = (widget.item(row, i) for row in range(widget.rowCount()) for i in range(widget.columnCount()))
            self._cells((cell, ()) for cell in cells if cell is not None)
        else:
            rows = _descendants(widget.invisibleRootItem())
            self._cells((row, (i,)) for row in rows for i in range(widget.columnCount()))

    def _palette(self, palette: QPalette) -> QPalette:
        result, mask = QPalette(palette), palette.resolveMask()
        if mask not in self._brushes:  # the brushes that are set; to look at each of them takes long
            self._brushes[mask] = [brush for brush in _BRUSHES if palette.isBrushSet(*brush)]
        for group, role in self._brushes[mask]:
            result.setBrush(group, role, self.brush(palette.brush(group, role)))
        return result

    @staticmethod
    def _icon(icon: QIcon, set_icon: Callable[[QIcon], Any]) -> None:
        make = icon_maker(icon.cacheKey())
        if make is not None:
            set_icon(make())

    def _cells(self, items: Iterator[tuple[Any, tuple[int, ...]]]) -> None:
        """Replace the colours of list items, each with its column where there are several; models return new colours."""
        for item, column in items:
            self._icon(item.icon(*column), partial(item.setIcon, *column))
            if (ink := item.foreground(*column)).style() != Qt.BrushStyle.NoBrush:
                item.setForeground(*column, self.brush(ink))

    def item(self, item: QGraphicsItem) -> None:
        """Replace the colours of an item in a scene."""
        if isinstance(item, QAbstractGraphicsShapeItem):
            item.setPen(self.pen(item.pen()))
            item.setBrush(self.brush(item.brush()))
        elif isinstance(item, QGraphicsLineItem):
            item.setPen(self.pen(item.pen()))
        elif isinstance(item, QGraphicsTextItem):
            item.setDefaultTextColor(self.colour(item.defaultTextColor()))
        elif isinstance(item, pg.AxisItem):
            item.setPen(self.pen(item.pen()))
            item.setTickPen(self.pen(item.tickPen()))
            item.setTextPen(self.pen(item.textPen()))
            if isinstance(item, Axis):
                item.redraw_title(self.text)
        elif isinstance(item, pg.ScatterPlotItem):
            for name, setter, change in (("pen", item.setPen, self.pen), ("brush", item.setBrush, self.brush)):
                setter([change(getattr(spot, name)()) for spot in item.points()])
        elif isinstance(item, pg.PlotCurveItem) and isinstance(item.opts["pen"], QPen):
            item.setPen(self.pen(item.opts["pen"]))


__all__ = ["Swap", "swap_between"]
