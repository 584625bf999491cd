"""Tutorials."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any
from weakref import WeakSet

from PySide6.QtCore import QPoint, QRect, Qt, QTimer
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSizePolicy, QToolBar, QWidget
from shiboken6 import isValid

from core.design import get
from core.errors import KindynaError
from core.frozen import frozen
from core.study import extremes_of, findings_of, quantity
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.places import example, lesson_files
from kindyna_gui.rebuilt import remove_part
from kindyna_gui.window.base import Window
from kindyna_gui.window.tutorial_steps import DEEDS, CannotDo, place_of, play, settle, wait_for

# -- what must be so at the end of a step: rows that read the window -------------------------------------

NEAR = 1e-9  # of a number's size: as typed


def _path(window: Window, wanted: list[Any]) -> bool:
    """``[path, value]``: the value of a field of the whole file."""
    path, value = wanted
    try:
        there = get(window.session.typed_full_design, path)
    except KeyError:
        return False
    if isinstance(value, str) or isinstance(there, str) or there is None:
        return bool(there == value)
    return abs(float(there) - float(value)) <= NEAR * max(1.0, abs(float(value)))


def _quantity(window: Window, wanted: Mapping[str, Any]) -> bool:
    """``{name, above, below}``: the largest absolute value of a quantity, in its column's unit."""
    row = quantity(wanted["name"])
    try:
        found = extremes_of(window.session.study, row.stage, (row.name,))[row.name]
    except (KindynaError, KeyError):
        return False
    value = max(abs(found.low.value), abs(found.high.value)) / row.unit.factor
    return bool(wanted.get("above", 0.0) <= value <= wanted.get("below", float("inf")))


def _finding(window: Window, wanted: str) -> bool:
    """The code of a finding; with ``no`` before it, there is none of it."""
    code = wanted.removeprefix("no ")
    try:
        found = findings_of(window.session.full_study, tuple(window.stages_on_screen()))
    except KindynaError:
        return False
    return any(each.code == code for each in found) == (code == wanted)


def _view(window: Window, wanted: str) -> bool:
    """A view is on the screen."""
    view = window.view(wanted)
    return view is not None and view.on_screen()


CONDITIONS: Mapping[str, Callable[[Window, Any], bool]] = MappingProxyType(
    {
        "path": _path,
        "quantity": _quantity,
        "finding": _finding,
        "view": _view,
        "task": lambda window, wanted: bool(window.actions_by_key[f"show_task:{wanted}"].isChecked()),
        "playing": lambda window, wanted: window.player.playing is wanted,
        "drives": lambda window, wanted: len(window.session.typed_full_design.drives) == wanted,
        "links": lambda window, wanted: len(window.session.typed.drive.links) == wanted,
        "points": lambda window, wanted: set(wanted) <= _points(window),
        "runs": lambda window, wanted: _runs(window) is wanted,
    }
)
"""Key of ``until`` -> whether it is so."""


def _runs(window: Window) -> bool:
    """Whether what is typed or drawn is a mechanism that moves."""
    try:
        return window.session.incomplete is None and bool(window.session.study.linkage.bodies)
    except KindynaError:
        return False


def _points(window: Window) -> set[str]:
    """Names of all points of the linkage that is drawn."""
    return {name for link in window.session.typed.drive.links for name in link.places}


def met(window: Window, until: Mapping[str, Any]) -> bool:
    """Whether all that a step is done by is so."""
    return all(CONDITIONS[key](window, wanted) for key, wanted in until.items())


# -- lessons ---------------------------------------------------------------------------------------------


@frozen
class Step:
    """One step.

    text    what to do and why, as the reader sees it
    do      deed of ``deeds.DEEDS`` -> its object; done in this order
    until   condition of ``conditions.CONDITIONS`` -> what it is compared with; all of them must be so
    """

    text: str
    do: Mapping[str, Any]
    until: Mapping[str, Any]

    @property
    def plain(self) -> str:
        """The text without its marks."""
        return re.sub(r"</?[bi]>", "", self.text)


@frozen
class Lesson:
    """The steps of one file, with its name there and its title; design: the example it begins with, empty for the one at hand."""

    name: str
    title: str
    steps: tuple[Step, ...]
    design: str = ""


def read(name: str) -> Lesson:
    """A lesson by its name, or by the path of its file. Raises KindynaError where there is none, or where a step is not one."""
    shipped = {file.stem: file for file in lesson_files()}
    path = shipped.get(name, Path(name))
    try:
        table = tomllib.loads(path.read_text("utf-8"))
    except OSError:
        raise KindynaError(f"tutorial {name}: there is none of this name; there are {', '.join(shipped)}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise KindynaError(f"{path}: {error}") from None
    steps = tuple(_step(row, f"{path.name}: steps[{i}]") for i, row in enumerate(table.get("steps", ())))
    if not steps:
        raise KindynaError(f"{path}: has no [[steps]]")
    return Lesson(path.stem, str(table.get("title", path.stem)), steps, str(table.get("design", "")))


def _step(row: Mapping[str, Any], where: str) -> Step:
    text, do, until = row.get("text"), row.get("do"), row.get("until")
    if not isinstance(text, str) or not isinstance(do, dict) or not isinstance(until, dict) or not do or not until:
        raise KindynaError(f"{where}: needs text, do = {{...}} and until = {{...}}")
    for table, known in ((do, DEEDS), (until, CONDITIONS)):
        for key in table:
            if key not in known:
                raise KindynaError(f"{where}: {key} is unknown; there are {', '.join(known)}")
    return Step(text, do, until)


# -- strip -----------------------------------------------------------------------------------------------

LOOK_MS = 150  # how often it is looked whether a step is done
LINES = 3  # of text that have room
EDGE = 4  # pixels between a mark and what it marks


class Mark(QWidget):
    """A frame around a place of a window, dialog or menu, which it belongs to and goes with; the mouse goes through it."""

    def __init__(self, top: QWidget) -> None:
        super().__init__(top)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAccessibleName("Place of this step")

    def put(self, widget: QWidget, rect: QRect) -> None:
        """Around a part of a widget, in front of its window."""
        top = self.window()
        wanted = QRect(widget.mapTo(top, QPoint(0, 0)) + rect.topLeft(), rect.size())
        wanted = wanted.adjusted(-EDGE, -EDGE, EDGE, EDGE) & top.rect()
        if self.geometry() != wanted or not self.isVisible():
            self.setGeometry(wanted)
            self.show()
            self.raise_()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(SCREEN.assumed), 3.0))
        painter.drawRoundedRect(self.rect().adjusted(2, 2, -2, -2), 5.0, 5.0)


class TutorialStrip(QToolBar):
    """One lesson in one window."""

    def __init__(self, window: Window, lesson: Lesson) -> None:
        super().__init__("Tutorial", window)
        self.host, self.lesson, self.number = window, lesson, 0
        self.setObjectName("tutorial")
        self.setMovable(False)
        self.toggleViewAction().setVisible(False)
        self.count, self.text = QLabel(), QLabel(wordWrap=True, textFormat=Qt.TextFormat.RichText)
        self.text.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.where, self.done, self.next, self.leave = (
            QPushButton("Show where"), QPushButton("Do it for me"), QPushButton("Next"), QPushButton("Leave"),
        )  # fmt: skip
        self.where.setToolTip("Bring the place of this step into sight")
        self.done.setToolTip("Mouse and keys do this step by themselves")
        self.next.setToolTip("On, where this is so already")
        self.leave.setToolTip("End the lesson; the design stays")
        content = QWidget()
        content.setFixedHeight(LINES * self.fontMetrics().lineSpacing() + 10)
        row = QHBoxLayout(content)
        row.setContentsMargins(8, 4, 8, 4)
        row.addWidget(self.count)
        row.addWidget(self.text, 1)
        for button, act in (
            (self.where, self._show_where), (self.done, self._do), (self.next, self.go_on), (self.leave, self.end),
        ):  # fmt: skip
            button.clicked.connect(act)
            row.addWidget(button)
        self.addWidget(content)
        self._marks: WeakSet[Mark] = WeakSet()
        self._met_before = self._plays = self.ended = False
        self._look = QTimer(self, interval=LOOK_MS)
        self._look.timeout.connect(self.look)
        self._begin()
        self._look.start()

    @property
    def marks(self) -> list[Mark]:
        """Those whose windows are still there."""
        return [mark for mark in self._marks if isValid(mark)]

    @property
    def step(self) -> Step | None:
        """The one at hand; None once all are done."""
        return self.lesson.steps[self.number] if self.number < len(self.lesson.steps) else None

    def _begin(self) -> None:
        step, count = self.step, len(self.lesson.steps)
        self._met_before = step is not None and met(self.host, step.until)
        self.count.setText(f"<b>{self.lesson.title}</b><br>{min(self.number + 1, count)} of {count}")
        self.text.setText("That was all. The design is yours now." if step is None else step.text)
        for button in (self.where, self.done, self.next):
            button.setVisible(step is not None)
        self.leave.setText("Close" if step is None else "Leave")
        self.show_mark()

    def hold(self) -> None:
        """No longer go on by itself: another leads."""
        self._look.stop()

    def look(self) -> None:
        """Go on where the step is done; else mark its place."""
        step = self.step
        if step is None:
            return
        so = met(self.host, step.until)
        if so and not self._met_before:
            self.go_on()
            return
        self._met_before = so
        self.next.setEnabled(so)
        self.show_mark()

    def show_mark(self) -> None:
        """Where the step is done, as far as that is in sight."""
        place = place_of(self.host, self.step.do) if self.step is not None else None
        top = None if place is None else place[0].window()
        for mark in self.marks:
            if mark.parentWidget() is not top:
                mark.hide()
        if place is not None and top is not None:
            mark = next((each for each in self.marks if each.parentWidget() is top), None) or Mark(top)
            self._marks.add(mark)
            mark.put(*place)

    def go_on(self) -> None:
        """The next step."""
        self.number += 1
        self._begin()

    def _show_where(self) -> None:
        if self.step is not None:
            for key, what in self.step.do.items():
                DEEDS[key].show(self.host, what)
            self.show_mark()

    def _do(self) -> None:
        if self.step is None:
            return
        if self.isAncestorOf(self.host.focusWidget()):
            self.host.setFocus()  # the keys that are played are not for the button that was clicked
        self.setEnabled(False)
        self._plays = True
        try:
            play(self.host, self.step.do)
        except CannotDo as error:
            self.host.status.show_message(str(error))
        self._plays = False
        self.setEnabled(True)
        if self.ended:
            remove_part(self)
        else:
            self.look()

    def end(self) -> None:
        """Take the strip away, or let it go once it has played; the design stays as it is."""
        self.ended = True
        self._look.stop()
        for mark in self.marks:
            remove_part(mark)
        self.host.removeToolBar(self)
        if not self._plays:
            remove_part(self)


def begin(window: Window, lesson: Lesson) -> TutorialStrip:
    """Begin a lesson, in place of the one at hand."""
    for before in window.findChildren(TutorialStrip):
        before.end()
    if lesson.design:
        window.documents.open_example(example(lesson.design))
    strip = TutorialStrip(window, lesson)
    window.addToolBarBreak()
    window.addToolBar(Qt.ToolBarArea.TopToolBarArea, strip)
    strip.show()
    return strip


# -- play ------------------------------------------------------------------------------------------------


def steps_played(strip: TutorialStrip) -> Iterator[tuple[int, Step]]:
    """Number, from 1, and step, each when it is done and before the strip goes on. Raises CannotDo with the step that fails."""
    window = strip.host
    strip.hold()
    while (step := strip.step) is not None:
        number = strip.number + 1
        try:
            if met(window, step.until):
                raise CannotDo("what it ends with is so before it is done")
            play(window, step.do)
            wait_for(partial(met, window, step.until), "what must be so")
        except CannotDo as error:
            raise CannotDo(f"step {number} of {len(strip.lesson.steps)}: {error}") from None
        settle()
        strip.show_mark()
        yield number, step
        strip.go_on()
