"""Why an entry was refused, with buttons for its remedies: in a layout, or floating at the editor of the entry."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QEvent, QObject, QPoint, QRect, Qt
from PySide6.QtGui import QColor, QCursor, QPainter, QPaintEvent, QPalette, QResizeEvent
from PySide6.QtWidgets import QApplication, QHBoxLayout, QScrollArea, QToolButton, QVBoxLayout, QWidget
from shiboken6 import isValid

from core.design import Info
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.labels import typographic
from kindyna_gui.look import MessageLabel, coloured, text_button
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import STRETCH, connect_all, fill
from kindyna_gui.view import View

Remedies = Mapping[str, Callable[[], object]]
"""Text of a button -> what it does."""
Misfit = tuple[str, Info]
"""Why a number in its range does not fit the other ones, and the range in which it would."""
NO_REMEDIES: Remedies = MappingProxyType({})
WIDTH = 360  # of a floating refusal, pixels
MOST_BESIDE = 0.45  # of the width, for a button beside the sentence
GAP = 2  # between the editor and the refusal that floats at it, pixels
_MOVES = frozenset({QEvent.Type.Resize, QEvent.Type.Move, QEvent.Type.Hide, QEvent.Type.Show})


def value_remedies(
    text: Callable[[Any], str],
    nearest: float | None,
    valid: Any,
    use: Callable[[float], object],
    back: Callable[[], object],
) -> Remedies:
    """Return the remedies of a refused value: the nearest allowed one, None where there is none, and the last valid one.

    ``text`` gives the text of a value with its unit.
    """
    near = {} if nearest in (None, valid) else {f"Use {text(nearest)}": partial(use, nearest)}
    return {**near, "Leave it empty" if valid is None else f"Back to {text(valid)}": back}


def nearest_value(session: Session, path: str, info: Info, typed: float | None) -> float | None:
    """Return the allowed value nearest to a typed number, where the other values admit it; None for a text."""
    nearest = None if typed is None else info.nearest(typed)
    return nearest if nearest is not None and session.fits(path, nearest) else None


def with_value(text: str, typed: str) -> str:
    """Return the sentence about a value outside its range with that value, if given: ``allowed: 0 ... 90°, not 120°``."""
    return f"{text}, not {typed}" if typed and "utside its range; allowed: " in text and "\n" not in text else text


def box_remedies(box: NumberBox, info: Info | None = None) -> Remedies:
    """Return the remedies of a refused number box: the nearest number that the range allows, and the last valid one."""
    nearest = None if box.number is None else (info or box.info).nearest(box.number)
    near = None if nearest == box.number else nearest
    return value_remedies(box.with_unit, near, box.value, box.use, box.withdraw)


def refuse_number(line: RefusalLine, box: NumberBox, why: str = "", info: Info | None = None, name: str = "") -> None:
    """Frame the number of a box and show in a line why it is refused, with its remedies.

    Without a reason it is no number, or outside the range of the box or of ``info``. ``name`` is that of the box, where
    the line belongs to several.
    """
    box.set_refused(True)
    why = why or box.fault(info)
    line.show_refusal(f"{name}: {why}" if name else why[:1].upper() + why[1:], box_remedies(box, info))


def judge_number(line: RefusalLine, box: NumberBox, name: str = "") -> bool:
    """Refuse in a line what a box holds, or clear its refusal; return whether it is allowed."""
    if is_wrong := bool(box.fault()):
        refuse_number(line, box, name=name)
    else:
        box.set_refused(False)
        line.show_refusal("")
    return not is_wrong


def accept_in_range(box: NumberBox, line: RefusalLine, accept: Callable[[Any], object], name: str = "") -> None:
    """Accept the numbers of a box that its range allows, and refuse the others in a line.

    ``accept`` returns why a number does not fit the other ones, with the range in which it would, if it does not.
    """

    def enter(value: Any) -> None:
        if not judge_number(line, box, name):
            return
        misfit = accept(value)
        if isinstance(misfit, tuple):
            why, info = misfit
            refuse_number(line, box, why, info, name)
        elif not box.is_refused:  # by a check of its own
            box.show_value(value)

    connect_all(
        (box.entered, enter),
        (box.unreadable, lambda: refuse_number(line, box, name=name)),
        (box.withdrawn, lambda: line.show_refusal("")),
    )


class RefusalLine(QWidget):
    """A sentence that says why an entry was refused, and a button for each remedy; hidden without a sentence.

    A single button is beside the sentence unless that leaves too little room for it, several are below it.
    """

    def __init__(self, margins: tuple[int, int, int, int] = (6, 3, 4, 3)) -> None:
        super().__init__()
        self._sentence = MessageLabel(SCREEN.limit)
        self._sentence.setMinimumWidth(1)
        self._beside = fill(QHBoxLayout(), (self._sentence, 1), spacing=4)
        self._below = fill(QHBoxLayout(), STRETCH, spacing=4)
        self._column = fill(QVBoxLayout(self), self._beside, self._below, margins=margins, spacing=3)
        self._buttons: list[QToolButton] = []
        self._remedies: Remedies = NO_REMEDIES
        self.hide()

    def text(self) -> str:
        """The sentence that is shown."""
        return self._sentence.text()

    @property
    def buttons(self) -> dict[str, QToolButton]:
        """Buttons of the remedies that are shown, by their texts."""
        return dict(zip(self._remedies, self._buttons, strict=False))

    def show_refusal(self, text: str, remedies: Remedies = NO_REMEDIES, *, is_wrong: bool = True) -> None:
        """Show this sentence with the remedies, or hide both where it is empty; quietly where nothing is wrong."""
        coloured(self._sentence, SCREEN.limit if is_wrong else SCREEN.quiet)
        self._remedies = remedies if text else NO_REMEDIES
        while len(self._buttons) < len(self._remedies):
            button = text_button("")
            button.setParent(self)
            button.setFocusPolicy(Qt.FocusPolicy.TabFocus)  # a click leaves the focus in the entry
            button.clicked.connect(partial(self._apply, len(self._buttons)))
            self._buttons.append(button)
        for button, name in zip(self._buttons, self._remedies, strict=False):
            button.setText(name)
        for i, button in enumerate(self._buttons):
            button.setVisible(i < len(self._remedies))
        self._sentence.show_message(typographic(text))
        self._arrange(self.width())
        self._update_visible()

    def _arrange(self, width: int) -> None:
        """Put the buttons beside the sentence, or below it, in a line of this width [pixels]."""
        count = len(self._remedies)
        is_below = count > 1 or (count == 1 and self._buttons[0].sizeHint().width() > MOST_BESIDE * width)
        for i, button in enumerate(self._buttons):
            if is_below:
                self._below.insertWidget(i, button)
            else:
                self._beside.addWidget(button, 0, Qt.AlignmentFlag.AlignTop)
        for layout in (self._beside, self._below, self._column):
            layout.invalidate()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        if event.size().width() != event.oldSize().width():
            self._arrange(event.size().width())

    def _update_visible(self) -> None:
        self.setVisible(bool(self.text()))

    def _apply(self, number: int, _: bool = False) -> None:
        list(self._remedies.values())[number]()


def _is_viewport(widget: QWidget) -> bool:
    area = widget.parentWidget()
    return isinstance(area, QScrollArea) and area.viewport() is widget


class FloatingRefusal(RefusalLine):
    """A refusal that floats at its editor, below or above it, so that it moves nothing.

    It covers neither what is under the mouse nor what has the focus, and is hidden while the editor is out of sight.
    """

    def __init__(self, editor: QWidget) -> None:
        super().__init__()
        self._editor = editor
        self._watched: list[QWidget] = []
        self._is_above = False
        self.setAutoFillBackground(True)
        self.setBackgroundRole(QPalette.ColorRole.ToolTipBase)
        editor.destroyed.connect(self._end)

    def _end(self) -> None:
        """Watch nothing more: the editor has been deleted."""
        self._watch(())
        self.deleteLater()

    def _update_visible(self) -> None:
        if not self.text():
            self._watch(())
            self.hide()
            return
        parents, at = [self._editor], self._editor.parentWidget()
        while at is not None and not (at.isWindow() or isinstance(at, View) or _is_viewport(at)):
            parents.append(at)
            at = at.parentWidget()
        if at is None:  # the editor belongs to no window yet
            self._watch(parents)
            return
        if self.parentWidget() is not at:
            self.setParent(at)
        self._watch((*parents, at))
        self._place()

    def _watch(self, widgets: Any) -> None:
        for widget in filter(isValid, self._watched):
            widget.removeEventFilter(self)
        app = QApplication.instance()
        assert isinstance(app, QApplication)
        if bool(widgets) != bool(self._watched):
            (app.focusChanged.connect if widgets else app.focusChanged.disconnect)(self._place)
        self._watched = list(widgets)
        for widget in self._watched:
            widget.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() in _MOVES:
            self._place()
        elif event.type() == QEvent.Type.ParentChange:
            self._update_visible()
        return False

    def _place(self, *_: object) -> None:
        """Put it below the editor, or above where it would cover what is under the mouse or has the focus."""
        host, editor = self.parentWidget(), self._editor
        if host is None or not isValid(editor) or not editor.isVisible() or editor.visibleRegion().isEmpty():
            self.hide()
            return
        box = QRect(editor.mapTo(host, QPoint()), editor.size())
        width = min(WIDTH, host.width() - 2 * GAP)
        if width != self.width():
            self._arrange(width)
        height = max(self.heightForWidth(width), self.minimumSizeHint().height())
        left = max(GAP, min(box.left(), host.width() - GAP - width))
        below = QRect(left, box.bottom() + 1 + GAP, width, height)
        above = QRect(left, box.top() - GAP - height, width, height)
        focused, mouse = QApplication.focusWidget(), host.mapFromGlobal(QCursor.pos())

        def is_free(place: QRect) -> bool:
            covers = (
                focused is not None
                and focused is not editor
                and host.isAncestorOf(focused)
                and not self.isAncestorOf(focused)
                and not editor.isAncestorOf(focused)
                and place.intersects(QRect(focused.mapTo(host, QPoint()), focused.size()))
            )
            under_mouse = place.contains(mouse) and not (self.isVisible() and self.geometry().contains(mouse))
            return host.rect().contains(place) and not covers and not under_mouse

        places = (above, below) if self._is_above and self.isVisible() else (below, above)
        place = next(filter(is_free, places), below if host.rect().contains(below) else above)
        self._is_above = place == above
        self.setGeometry(place)
        self.show()
        self.raise_()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setPen(QColor(SCREEN.limit))
        painter.drawRect(self.rect().adjusted(0, 0, -1, -1))
        painter.end()


__all__ = [
    "NO_REMEDIES",
    "FloatingRefusal",
    "Misfit",
    "RefusalLine",
    "Remedies",
    "accept_in_range",
    "box_remedies",
    "judge_number",
    "nearest_value",
    "refuse_number",
    "value_remedies",
    "with_value",
]
