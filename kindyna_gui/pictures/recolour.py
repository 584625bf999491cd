"""What is open changes its colours where it stands, when the theme does.

All colours that anything is drawn with come from a ``Theme``: each that is in place gives way to the one of the same tone.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import fields
from functools import partial
from typing import Any

import pyqtgraph as pg
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

from kindyna_gui.pictures.plots.plot import Axis
from kindyna_gui.pictures.style import BALANCE, DRIVES, FAMILIES, Theme, made_for, shade

_HEX = re.compile(r"#[0-9A-Fa-f]{6}\b")
_SHADES = 4  # of a colour of curves


def _tones(theme: Theme) -> Iterator[str]:
    """Every colour that is drawn with in a theme, in one order for all."""
    for each in fields(Theme):
        value = getattr(theme, each.name)
        yield from (value,) if isinstance(value, str) else value if isinstance(value, tuple) else ()
    for hue in (*FAMILIES.values(), *DRIVES, BALANCE):
        seen = theme.seen(hue)
        shades = [theme.seen(shade(seen, number)) for number in range(_SHADES)]
        yield from (seen, *shades, *(theme.letters(each) for each in shades))


def _below(item: QTreeWidgetItem) -> Iterator[QTreeWidgetItem]:
    for child in (item.child(number) for number in range(item.childCount())):
        yield child
        yield from _below(child)


class Swap:
    """The colours of one theme for those of another."""

    def __init__(self, before: Theme, after: Theme) -> None:
        self._after: dict[str, str] = {}
        for one, other in zip(_tones(before), _tones(after), strict=True):
            self._after.setdefault(one.lower(), other)

    def colour(self, colour: QColor) -> QColor:
        """That of the same tone, as transparent; what belongs to no theme stays."""
        after = self._after.get(colour.name())
        if after is None:
            return colour
        made = QColor(after)
        made.setAlpha(colour.alpha())
        return made

    def text(self, text: str) -> str:
        """A style sheet, or rich text."""
        return _HEX.sub(lambda found: self._after.get(found[0].lower(), found[0]), text)

    def pen(self, pen: QPen) -> QPen:
        made = QPen(pen)
        made.setColor(self.colour(pen.color()))
        return made

    def brush(self, brush: QBrush) -> QBrush:
        made = QBrush(brush)
        if brush.style() == Qt.BrushStyle.SolidPattern:
            made.setColor(self.colour(brush.color()))
        return made

    def widget(self, widget: QWidget) -> None:
        """What a widget itself keeps of colours: palette, style sheet, rich text, icons, the cells of a list, the items of a scene."""
        if widget.testAttribute(Qt.WidgetAttribute.WA_SetPalette):
            widget.setPalette(self._palette(widget.palette()))
        if sheet := widget.styleSheet():
            widget.setStyleSheet(self.text(sheet))
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
            before = widget.blockSignals(True)  # nobody has edited a cell
            self._lists(widget)
            widget.blockSignals(before)

    def _lists(self, widget: QListWidget | QTableWidget | QTreeWidget) -> None:
        if isinstance(widget, QListWidget):
            self._cells((widget.item(row), ()) for row in range(widget.count()))
        elif isinstance(widget, QTableWidget):
            cells = (widget.item(row, i) for row in range(widget.rowCount()) for i in range(widget.columnCount()))
            self._cells((cell, ()) for cell in cells if cell is not None)
        else:
            rows = _below(widget.invisibleRootItem())
            self._cells((row, (i,)) for row in rows for i in range(widget.columnCount()))

    def _palette(self, palette: QPalette) -> QPalette:
        made = QPalette(palette)
        for group in (QPalette.ColorGroup.Active, QPalette.ColorGroup.Inactive, QPalette.ColorGroup.Disabled):
            for role in (role for role in QPalette.ColorRole if role != QPalette.ColorRole.NColorRoles):
                if palette.isBrushSet(group, role):
                    made.setBrush(group, role, self.brush(palette.brush(group, role)))
        return made

    @staticmethod
    def _icon(icon: QIcon, put: Callable[[QIcon], Any]) -> None:
        again = made_for(icon.cacheKey())
        if again is not None:
            put(again())

    def _cells(self, items: Iterator[tuple[Any, tuple[int, ...]]]) -> None:
        """Of lists that keep what they show; a model that is asked for it answers anew. Each item with its column where it has some."""
        for item, column in items:
            self._icon(item.icon(*column), partial(item.setIcon, *column))
            if (ink := item.foreground(*column)).style() != Qt.BrushStyle.NoBrush:
                item.setForeground(*column, self.brush(ink))

    def item(self, item: QGraphicsItem) -> None:
        """Lines, fills and texts of a scene."""
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
            for name, put, change in (("pen", item.setPen, self.pen), ("brush", item.setBrush, self.brush)):
                put([change(each) for each in (getattr(spot, name)() for spot in item.points())])
        elif isinstance(item, pg.PlotCurveItem) and isinstance(item.opts["pen"], QPen):
            item.setPen(self.pen(item.opts["pen"]))


__all__ = ["Swap"]
