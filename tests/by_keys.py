"""A window by the keys alone: where Tab leads, what it never comes to, and whether one sees where the keys are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from accessible import way
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from window_user import settle

from kindyna_gui.rebuilt import is_in_sight

MOST = 400
AROUND = 3  # pixels: frames around what has the keys stand outside of it


@dataclass
class Round:
    """What Tab passes: the stops in their order, and what is wrong with them."""

    stops: list[QWidget] = field(default_factory=list)
    wrong: list[str] = field(default_factory=list)


def stops(root: QWidget) -> Iterator[QWidget]:
    """What can have the keys by Tab, in sight."""
    for each in root.findChildren(QWidget):
        by_tab = each.focusPolicy().value & Qt.FocusPolicy.TabFocus.value
        if by_tab and each.isVisible() and each.isEnabled() and each.focusProxy() is None and each.window() is root:
            part = each
            while part.parentWidget() is not root:
                part = part.parentWidget()
            if is_in_sight(part):
                yield each


def looks(widget: QWidget) -> QImage:
    """It, with a narrow strip around it."""
    window = widget.window()
    there = QRect(widget.mapTo(window, QPoint()), widget.size()).adjusted(-AROUND, -AROUND, AROUND, AROUND)
    return window.grab(there & window.rect()).toImage()


def go_round(root: QWidget, known: set[type]) -> Round:
    """Tab through a window until it comes round; of each kind of stop that is not yet known one is looked at."""
    passed = Round()
    root.activateWindow()
    if root.focusWidget() is None:
        root.focusNextChild()
    settle()
    for _ in range(MOST):
        at = QApplication.focusWidget()
        if at is None:
            passed.wrong.append("the keys go nowhere")
            return passed
        if at in passed.stops:
            left = [each for each in passed.stops[: passed.stops.index(at)] if each in list(stops(root))]
            passed.wrong += [f"Tab does not come back to {way(each)} {each.accessibleName()}" for each in left]
            break
        passed.stops.append(at)
        if not is_in_sight(at):
            passed.wrong.append(f"out of sight: {way(at)} {at.accessibleName()}")
        with_keys = looks(at) if type(at) not in known and at.isVisible() and len(passed.stops) > 1 else None
        QTest.keyClick(at, Qt.Key.Key_Tab)
        settle()
        if QApplication.focusWidget() is at:
            if len(list(stops(root))) > 1:
                passed.wrong.append(f"keeps the keys: {way(at)}")
            return passed
        if with_keys is not None and at.isVisible():
            known.add(type(at))
            if looks(at) == with_keys:
                passed.wrong.append(f"nobody sees that it has the keys: {way(at)} {at.accessibleName()}")
    missed = [each for each in stops(root) if each not in passed.stops]
    passed.wrong += [f"not reached: {way(each)} {each.accessibleName()}" for each in missed]
    for before, after in zip(passed.stops, passed.stops[1:], strict=False):
        if before.parentWidget() is after.parentWidget() is not None:
            one, other = before.geometry(), after.geometry()
            if other.bottom() <= one.top() and other.left() < one.right():
                passed.wrong.append(f"upwards: {way(before)} to {way(after)}")
    return passed


__all__ = ["Round", "go_round"]
