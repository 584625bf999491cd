"""What a screen reader is told of a window: a walk over the accessibility tree, and over what has no place in it of its own."""

from __future__ import annotations

from collections.abc import Iterator

from PySide6.QtCore import QObject
from PySide6.QtGui import QAccessible, QAccessibleInterface
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractSlider,
    QAbstractSpinBox,
    QComboBox,
    QDockWidget,
    QGraphicsView,
    QHeaderView,
    QLineEdit,
    QMainWindow,
    QScrollBar,
    QTabBar,
    QWidget,
)

from kindyna_gui.pictures.plots.plot import FixedPlot

ROLES = QAccessible.Role
CONTROLS = (
    ROLES.Button, ROLES.ButtonDropDown, ROLES.ButtonMenu, ROLES.CheckBox, ROLES.ComboBox, ROLES.EditableText, ROLES.List, ROLES.ProgressBar,
    ROLES.RadioButton, ROLES.Slider, ROLES.SpinBox, ROLES.Table, ROLES.Tree,
)  # fmt: skip
DEEPEST = 40
SPOKEN_BY_QT = (
    QAbstractButton,
    QAbstractSlider,
    QAbstractSpinBox,
    QComboBox,
    QDockWidget,
    QLineEdit,
    QMainWindow,
    QTabBar,
)
BACKDROPS = ("FadedCover", "FocusRing", "Mark", "Panel")  # veil, frame and paper around what is named itself


def interfaces(at: QAccessibleInterface | None, depth: int = 0) -> Iterator[QAccessibleInterface]:
    """All that is told of what is below something, cells of tables left aside."""
    if at is None or not at.isValid() or at.state().invisible:  # type: ignore[attr-defined]
        return
    yield at
    if at.role() not in (ROLES.Table, ROLES.Tree, ROLES.List) and depth < DEEPEST:
        for number in range(at.childCount()):
            yield from interfaces(at.child(number), depth + 1)


def way(thing: QObject | None) -> str:
    """Where a widget stands, from inside out."""
    names = []
    while thing is not None:
        names.append(type(thing).__name__)
        thing = thing.parent()
    return " < ".join(names[:6])


def nameless(root: QWidget) -> list[str]:
    """Controls, tables and pictures in sight that have no name, or do not tell their value."""
    found = []
    for each in interfaces(QAccessible.queryAccessibleInterface(root)):
        widget = each.object()
        if isinstance(widget, QWidget) and (not widget.isVisible() or isinstance(widget, QScrollBar | QHeaderView)):
            continue
        if each.role() in CONTROLS:
            parent = each.parent()
            if (
                parent is not None and parent.role() == ROLES.SpinBox
            ):  # the line of a box for numbers is spoken of as the box
                continue
            if not each.text(QAccessible.Text.Name).strip():
                found.append(f"{each.role().name}: {way(widget)}")
            elif isinstance(widget, QComboBox) and widget.currentText() != each.text(QAccessible.Text.Value):
                found.append(f"without its value: {each.text(QAccessible.Text.Name)}")
            elif isinstance(widget, QAbstractSpinBox) and widget.text() and not each.text(QAccessible.Text.Value):
                found.append(f"without its value: {each.text(QAccessible.Text.Name)}, {widget.text()!r}")
    for picture in pictures(root):
        if not picture.accessibleName():
            found.append(f"picture: {way(picture)}")
        elif not picture.accessibleDescription() and isinstance(picture, FixedPlot):
            found.append(f"plot without words: {picture.accessibleName()}")
    return sorted(set(found))


def pictures(root: QWidget) -> Iterator[QWidget]:
    """What is drawn rather than written: scenes, and widgets that paint themselves and are nothing that Qt speaks of."""
    for widget in (root, *root.findChildren(QWidget)):
        own = next((kind for kind in type(widget).__mro__ if "paintEvent" in vars(kind)), QWidget)
        painted = own.__module__.startswith("kindyna_gui") and not isinstance(widget, SPOKEN_BY_QT)
        if widget.isVisible() and (isinstance(widget, QGraphicsView) or (painted and own.__name__ not in BACKDROPS)):
            yield widget


__all__ = ["interfaces", "nameless", "pictures", "way"]
