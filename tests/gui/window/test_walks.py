"""Every dialog and every task, walked through: the keys alone, what a screen reader is told, F1, Copy as command, Ctrl+C, no way
through menus where a button could stand."""

import re
import shlex
from collections.abc import Iterable, Iterator
from pathlib import Path

import pytest
from accessible import nameless
from by_keys import go_round
from every_dialog import each_dialog
from PySide6.QtCore import Qt
from PySide6.QtGui import QAccessible, QKeySequence
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QApplication,
    QLabel,
    QPushButton,
    QTableView,
    QWidget,
)
from sampled import spread, stressed
from window_user import Open, settle

from core.__main__ import parser
from core.commands import COMMANDS
from kindyna_gui.dialogs import HELP, help_on
from kindyna_gui.headless import COMMANDS as PAINTING
from kindyna_gui.help import PAGES, HelpWindow
from kindyna_gui.places import example
from kindyna_gui.screenshots import rest
from kindyna_gui.window.tasks import TASKS

MENU_WAY = re.compile(r"\b(File|Edit|Make|Compo|Kine|Dyna|Stability|Graph|View|Help) > ")
NO_COMMAND = {
    "New...", "Camshaft...", "Add this design to a shaft...", "Preferences...", "Underlay...", "Choose a mechanism...", "Welcome",
}  # fmt: skip
"""Dialogs of which there is nothing for the command line."""


@pytest.fixture(autouse=True)
def heard_by_a_screen_reader() -> Iterator[None]:
    """Qt tells a spoken summary only where somebody listens."""
    QAccessible.setActive(True)
    yield
    QAccessible.setActive(False)


def menu_ways(root: QWidget) -> list[str]:
    """Texts in sight, and tips, that say through which menus to go."""
    found = []
    for each in (root, *root.findChildren(QWidget)):
        if each.isVisible():
            text = each.text() if isinstance(each, QLabel | QAbstractButton) else ""
            found += [words for words in (text, each.toolTip(), each.statusTip()) if MENU_WAY.search(words)]
    return found


def silent_tables(root: QWidget) -> list[str]:
    """Tables that Ctrl+C takes nothing of."""
    found = []
    for table in root.findChildren(QTableView):
        if table.isVisible() and isinstance(table, QAbstractItemView) and table.model().rowCount():
            QApplication.clipboard().setText("before")
            QTest.keySequence(table, QKeySequence(QKeySequence.StandardKey.Copy))
            lines = QApplication.clipboard().text().split("\n")
            if lines == ["before"] or len(lines) < table.model().rowCount():
                found.append(f"Ctrl+C takes nothing of {table.accessibleName()}")
    return found


def unhelped(at: QWidget) -> list[str]:
    """What F1 opens is no page that tells of it; words are found whatever the case of their letters."""
    page, words = help_on(at)
    at.setFocus()
    QTest.keyClick(at, Qt.Key.Key_F1)
    settle()
    front = at.window()
    windows = [each for each in QApplication.topLevelWidgets() if isinstance(each, HelpWindow)]
    shown = next((each for each in windows if each.isVisible()), None)
    if shown is None:
        return [f"F1 opens nothing instead of {page}#{words}"]
    opened = shown.list.currentItem().text(), shown.text.textCursor().selectedText().lower()
    shown.close()
    front.activateWindow()
    settle()
    return [] if opened == (PAGES[page][0], words.lower()) else [f"F1 opens {opened} instead of {page}#{words}"]


def uncopied(name: str, root: QWidget) -> list[str]:
    """What *Copy as command* copies is no command."""
    button = next((each for each in root.findChildren(QPushButton) if each.text() == "Copy as command"), None)
    if button is None:
        return [] if name in NO_COMMAND else ["without Copy as command"]
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    program, headless, *words = shlex.split(QApplication.clipboard().text())
    parser("kindyna", {**COMMANDS, **PAINTING}).parse_args(words)  # else it would end here
    return [] if (program, headless) == ("kindyna", "--headless") else [f"copies {program}"]


@pytest.mark.stress
@pytest.mark.parametrize("name", spread(["transfer_lift", "lecture_six_bar", "transfer_unit"], 1))
def test_every_dialog(open_user: Open, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str) -> None:
    user = open_user(example(name))
    wrong, known = {}, set()

    def look(entry: str, dialog: QWidget) -> None:
        wrong[entry] = [
            *go_round(dialog, known).wrong,
            *nameless(dialog),
            *menu_ways(dialog),
            *silent_tables(dialog),
            *unhelped(QApplication.focusWidget() or dialog),
            *([] if dialog.property(HELP) else ["without a page of the help"]),
            *uncopied(entry, dialog),
        ]

    each_dialog(user, monkeypatch, tmp_path, look)
    assert len(wrong) > 15

    assert {entry: lines for entry, lines in wrong.items() if lines} == {}


@pytest.mark.stress
@pytest.mark.parametrize(
    ("name", "tasks", "least"),
    [
        ("transfer_lift", ("make", "dyna"), 10),
        *(stressed(n, TASKS, 20) for n in ("transfer_lift", "lecture_six_bar", "transfer_unit", "four_bar")),
    ],
)
def test_every_task(open_user: Open, name: str, tasks: Iterable[str], least: int) -> None:
    """least   pages of the help that are met"""
    user = open_user(example(name), whole=True, size=(1440, 900))
    window, pages = user.window, {}
    wrong, known = {}, set()
    window.show_help("fields")
    fields = window.findChild(HelpWindow).text.toPlainText()
    window.findChild(HelpWindow).close()
    for task in tasks:
        window.show_task(task)
        rest(window)
        passed = go_round(window, known)
        wrong[task] = [*passed.wrong, *nameless(window), *menu_ways(window), *silent_tables(window)]
        pages |= {help_on(stop): stop for stop in passed.stops if help_on(stop) not in pages}
        wrong[task] += [f"no help on {path}" for page, path in pages if page == "fields" and path not in fields]
        here = [stop for (page, _), stop in pages.items() if page != "fields" and stop in passed.stops]
        wrong[task] += [line for stop in here for line in unhelped(stop)]
    assert len(pages) > least

    assert {task: lines for task, lines in wrong.items() if lines} == {}
