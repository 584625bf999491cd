"""Tutorials: reading their files, the strip that shows the steps, and playing them without a user.

A tutorial is a TOML file with ``[[steps]]`` of ``text``, ``do`` (see ``tutorial_steps.ACTIONS``) and ``until`` (see
``CONDITIONS``).
"""

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
from PySide6.QtWidgets import QApplication, QHBoxLayout, QLabel, QPushButton, QSizePolicy, QToolBar, QWidget
from shiboken6 import isValid

from core.design import get
from core.errors import KindynaError
from core.frozen import frozen
from core.study import extremes_of, findings_of, quantity
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.places import example, lesson_files
from kindyna_gui.rebuilt import connect_all, fill, remove_part
from kindyna_gui.window.base import Window
from kindyna_gui.window.tutorial_steps import (
    ACTIONS,
    LAST_DIALOG,
    CannotDo,
    note_dialog,
    play,
    region_of,
    settle,
    wait_for,
)

NEAR = 1e-9  # relative difference of equal numbers
CHECK_MS = 150  # between two checks whether a step is done
LINES = 3  # lines of text in the strip
EDGE = 4  # gap between a frame and what it marks [pixels]

# -- conditions at the end of a step ---------------------------------------------------------------------


def _path(window: Window, target: list[Any]) -> bool:
    """Whether the field ``[path, value]`` of the file has this value."""
    path, value = target
    try:
        current = get(window.session.typed_full_design, path)
    except KeyError:
        return False
    if isinstance(value, str) or isinstance(current, str) or current is None:
        return bool(current == value)
    return abs(float(current) - float(value)) <= NEAR * max(1.0, abs(float(value)))


def _quantity(window: Window, limits: Mapping[str, Any]) -> bool:
    """Whether the largest absolute value of ``{name, above, below}`` is within its limits, in the unit of its column."""
    row = quantity(limits["name"])
    try:
        extremes = extremes_of(window.session.study, row.stage, (row.name,))[row.name]
    except (KindynaError, KeyError):
        return False
    value = max(abs(extremes.low.value), abs(extremes.high.value)) / row.unit.factor
    return bool(limits.get("above", 0.0) <= value <= limits.get("below", float("inf")))


def _finding(window: Window, text: str) -> bool:
    """Whether a finding of this code is present; with ``no`` before the code, whether it is absent."""
    code = text.removeprefix("no ")
    try:
        findings = findings_of(window.session.full_study, tuple(window.stages_on_screen()))
    except KindynaError:
        return False
    return any(finding.code == code for finding in findings) == (code == text)


def _view(window: Window, name: str) -> bool:
    """Whether a view is on the screen."""
    view = window.view(name)
    return view is not None and view.on_screen()


CONDITIONS: Mapping[str, Callable[[Window, Any], bool]] = MappingProxyType(
    {
        "path": _path,
        "quantity": _quantity,
        "finding": _finding,
        "view": _view,
        "task": lambda window, name: bool(window.actions_by_key[f"show_task:{name}"].isChecked()),
        "playing": lambda window, on: window.player.playing is on,
        "dialog": lambda window, title: bool(window.property(LAST_DIALOG) == title),
        "drives": lambda window, number: len(window.session.typed_full_design.drives) == number,
        "links": lambda window, number: len(window.session.typed.drive.links) == number,
        "points": lambda window, names: set(names) <= _points(window),
        "runs": lambda window, moves: _runs(window) is moves,
    }
)
"""Key of ``until`` -> whether the window meets its value."""


def _runs(window: Window) -> bool:
    """Whether the typed or drawn design is a mechanism that moves."""
    try:
        return window.session.incomplete is None and bool(window.session.study.linkage.bodies)
    except KindynaError:
        return False


def _points(window: Window) -> set[str]:
    """Names of all points of the typed linkage."""
    return {name for link in window.session.typed.drive.links for name in link.places}


def is_met(window: Window, until: Mapping[str, Any]) -> bool:
    """Whether all conditions of a step are met."""
    return all(CONDITIONS[key](window, value) for key, value in until.items())


# -- files of tutorials ----------------------------------------------------------------------------------


@frozen
class TutorialStep:
    """One step.

    Attributes
    ----------
    text : str
        What to do and why, with marks <b> and <i>.
    do : Mapping
        Key of ``ACTIONS`` -> its argument, in the order of play.
    until : Mapping
        Key of ``CONDITIONS`` -> value to meet; all must be met.
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
    """The steps of one file; it begins with an example, or with the current design where ``design`` is empty."""

    name: str
    title: str
    steps: tuple[TutorialStep, ...]
    design: str = ""


def read(name: str) -> Lesson:
    """Read a tutorial by its name or the path of its file. Raises KindynaError where it is missing or not valid."""
    shipped = {file.stem: file for file in lesson_files()}
    path = shipped.get(name, Path(name))
    try:
        table = tomllib.loads(path.read_text("utf-8"))
    except OSError:
        raise KindynaError(f"tutorial {name}: not found; the tutorials are {', '.join(shipped)}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise KindynaError(f"{path}: {error}") from None
    steps = tuple(_step(row, f"{path.name}: steps[{i}]") for i, row in enumerate(table.get("steps", ())))
    if not steps:
        raise KindynaError(f"{path}: needs [[steps]]")
    return Lesson(path.stem, str(table.get("title", path.stem)), steps, str(table.get("design", "")))


def _step(row: Mapping[str, Any], where: str) -> TutorialStep:
    text, do, until = row.get("text"), row.get("do"), row.get("until")
    if not isinstance(text, str) or not isinstance(do, dict) or not isinstance(until, dict) or not do or not until:
        raise KindynaError(f"{where}: needs text, do = {{...}} and until = {{...}}")
    for table, known in ((do, ACTIONS), (until, CONDITIONS)):
        for key in table:
            if key not in known:
                raise KindynaError(f"{where}: {key} is unknown; allowed are {', '.join(known)}")
    return TutorialStep(text, do, until)


# -- the strip above the drawing -------------------------------------------------------------------------


class Mark(QWidget):
    """A frame around a part of a window, dialog or menu, its parent; it ignores the mouse."""

    def __init__(self, top: QWidget) -> None:
        super().__init__(top, accessibleName="Position of this step")
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)

    def put(self, widget: QWidget, rect: QRect) -> None:
        """Move the frame around a part of a widget."""
        top = self.window()
        frame = QRect(widget.mapTo(top, QPoint(0, 0)) + rect.topLeft(), rect.size())
        frame = frame.adjusted(-EDGE, -EDGE, EDGE, EDGE) & top.rect()
        if self.geometry() != frame or not self.isVisible():
            self.setGeometry(frame)
            self.show()
            self.raise_()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(SCREEN.assumed), 3.0))
        painter.drawRoundedRect(self.rect().adjusted(2, 2, -2, -2), 5.0, 5.0)


class TutorialStrip(QToolBar):
    """The toolbar that shows the steps of a tutorial, and continues when a step is done."""

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
        self.where.setToolTip("Show where this step is done")
        self.done.setToolTip("Perform this step with mouse and keys")
        self.next.setToolTip("Continue, if the step is done already")
        self.leave.setToolTip("End the tutorial and keep the design")
        content = QWidget()
        content.setFixedHeight(LINES * self.fontMetrics().lineSpacing() + 10)
        buttons = (self.where, self.done, self.next, self.leave)
        fill(QHBoxLayout(content), self.count, (self.text, 1), *buttons, margins=(8, 4, 8, 4))
        connect_all(
            (self.where.clicked, self._show_where),
            (self.done.clicked, self._do),
            (self.next.clicked, self.go_on),
            (self.leave.clicked, self.end),
        )
        self.addWidget(content)
        self._marks: WeakSet[Mark] = WeakSet()
        self._met_before = self._plays = self.ended = False
        self._timer = QTimer(self, interval=CHECK_MS)
        self._timer.timeout.connect(self.check)
        self._begin()
        self._timer.start()

    @property
    def marks(self) -> list[Mark]:
        """Frames whose windows still exist."""
        return [mark for mark in self._marks if isValid(mark)]

    @property
    def step(self) -> TutorialStep | None:
        """Current step; None once all are done."""
        return self.lesson.steps[self.number] if self.number < len(self.lesson.steps) else None

    def _begin(self) -> None:
        step, count = self.step, len(self.lesson.steps)
        self.host.setProperty(LAST_DIALOG, "")
        self._met_before = step is not None and is_met(self.host, step.until)
        self.count.setText(f"<b>{self.lesson.title}</b><br>{min(self.number + 1, count)} of {count}")
        self.text.setText("All steps are done. Continue with this design as you like." if step is None else step.text)
        for button in (self.where, self.done, self.next):
            button.setVisible(step is not None)
        self.leave.setText("Close" if step is None else "Leave")
        self.show_mark()

    def stop_checking(self) -> None:
        """Continue only when ``go_on`` is called."""
        self._timer.stop()

    def check(self) -> None:
        """Continue if the step has been done, else mark its position."""
        step = self.step
        if step is None:
            return
        if (dialog := QApplication.activeModalWidget()) is not None:
            note_dialog(self.host, dialog)
        is_done = is_met(self.host, step.until)
        if is_done and not self._met_before:
            self.go_on()
            return
        self._met_before = is_done
        self.next.setEnabled(is_done)
        self.show_mark()

    def show_mark(self) -> None:
        """Mark the position of the step if it is visible."""
        region = region_of(self.host, self.step.do) if self.step is not None else None
        top = None if region is None else region[0].window()
        for mark in self.marks:
            if mark.parentWidget() is not top:
                mark.hide()
        if region is not None and top is not None:
            mark = next((mark for mark in self.marks if mark.parentWidget() is top), None) or Mark(top)
            self._marks.add(mark)
            mark.put(*region)

    def go_on(self) -> None:
        """Show the next step."""
        self.number += 1
        self._begin()

    def _show_where(self) -> None:
        if self.step is not None:
            for key, value in self.step.do.items():
                ACTIONS[key].show(self.host, value)
            self.show_mark()

    def _do(self) -> None:
        if self.step is None:
            return
        if self.isAncestorOf(self.host.focusWidget()):
            self.host.setFocus()  # else the button just clicked would get the keys
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
            self.check()

    def end(self) -> None:
        """Remove the strip, at the end of an action being played; the design is kept."""
        self.ended = True
        self._timer.stop()
        for mark in self.marks:
            remove_part(mark)
        self.host.removeToolBar(self)
        if not self._plays:
            remove_part(self)


def begin(window: Window, lesson: Lesson) -> TutorialStrip:
    """Begin a tutorial; ends one that is running."""
    for running in window.findChildren(TutorialStrip):
        running.end()
    if lesson.design:
        window.documents.open_example(example(lesson.design))
    strip = TutorialStrip(window, lesson)
    window.addToolBarBreak()
    window.addToolBar(Qt.ToolBarArea.TopToolBarArea, strip)
    strip.show()
    return strip


# -- playing without a user ------------------------------------------------------------------------------


def steps_played(strip: TutorialStrip) -> Iterator[tuple[int, TutorialStep]]:
    """Play a tutorial; yields the number, from 1, and the step when it is done. Raises CannotDo with the step that fails."""
    window = strip.host
    strip.stop_checking()
    while (step := strip.step) is not None:
        number = strip.number + 1
        try:
            if is_met(window, step.until):
                raise CannotDo("the conditions of until are met before the step is done")
            play(window, step.do)
            wait_for(partial(is_met, window, step.until), "conditions of until")
        except CannotDo as error:
            raise CannotDo(f"step {number} of {len(strip.lesson.steps)}: {error}") from None
        settle()
        strip.show_mark()
        yield number, step
        strip.go_on()
