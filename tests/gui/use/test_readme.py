"""The five minutes of README.md, played with mouse and keys: each name in italics is on the screen, or is an entry of a menu."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QApplication, QDockWidget, QLabel, QMenu, QTabBar, QWidget
from window_user import Open, User, plain, settle, wait_for

from kindyna_gui import export_dialogs
from kindyna_gui.export_dialogs import TablesRequest
from kindyna_gui.find import FindView
from kindyna_gui.findings import FindingsView
from kindyna_gui.motion.segments_view import SegmentsView

README = Path(__file__).parents[3] / "README.md"
LEFT, NO_KEYS = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier


def steps() -> list[str]:
    """Return the numbered list under *Five minutes*."""
    part = README.read_text(encoding="utf-8").partition("## Five minutes")[2].partition("\n\nEverything")[0]
    return [" ".join(text.split()) for text in re.split(r"^\d+\. ", part, flags=re.MULTILINE)[1:]]


def texts(widget: QWidget) -> Iterator[str]:
    """Yield the texts of a widget."""
    if isinstance(widget, QTabBar):
        yield from (widget.tabText(i) for i in range(widget.count()))
    elif isinstance(widget, QLabel | QAbstractButton):
        yield widget.text()
    elif isinstance(widget, QDockWidget) or widget.isWindow():
        yield widget.windowTitle()


def on_screen() -> set[str]:
    """Return every name that can be read in a window."""
    shown = (each for each in QApplication.allWidgets() if each.isVisible() and not each.visibleRegion().isEmpty())
    return {plain(text).removesuffix("...") for each in shown for text in texts(each)}


def is_entry(user: User, way: list[str]) -> bool:
    """Whether menus lead to an entry that can be chosen."""
    place: QWidget = user.window.menuBar()
    for text in way:
        action = next((a for a in place.actions() if plain(a.text()).removesuffix("...") == text), None)
        if action is None or not action.isEnabled():
            return False
        menu = action.menu()
        if isinstance(menu, QMenu):
            menu.aboutToShow.emit()
            place = menu
    return True


def click(widget: QWidget, at: QPoint | None = None) -> None:
    QTest.mouseClick(widget, LEFT, pos=widget.rect().center() if at is None else at)
    settle()


def button(user: User, text: str) -> QAbstractButton:
    return next(
        each
        for each in user.window.findChildren(QAbstractButton)
        if plain(each.text()) == text and not each.visibleRegion().isEmpty()
    )


def tab(user: User, text: str) -> None:
    """Click a tab."""
    bar, number = next(
        (bar, i)
        for bar in user.window.findChildren(QTabBar)
        for i in range(bar.count())
        if bar.tabText(i) == text and not bar.visibleRegion().isEmpty()
    )
    click(bar, bar.tabRect(number).center())


def play_the_lift(user: User) -> Iterator[None]:
    yield
    page = user.window.welcome
    assert page is not None
    QTest.keyClick(page, Qt.Key.Key_Escape)
    assert not page.isVisible()
    assert QTest.qWaitForWindowActive(user.window)
    user.press(Qt.Key.Key_Space)
    assert user.window.player.playing
    user.press(Qt.Key.Key_Space)
    before = user.window.player.theta
    user.press(Qt.Key.Key_Right)
    assert user.window.player.theta > before
    yield


def change_the_stroke(user: User) -> Iterator[None]:
    yield
    user.enter("motion.stroke_mm", "160")
    assert user.design.drive.motion.segments[1].rise == -160.0
    user.press(Qt.Key.Key_Z, modifier=Qt.KeyboardModifier.ControlModifier)
    assert user.design.drive.motion.segments[1].rise == -150.0


def turn_the_wheel(user: User) -> Iterator[None]:
    yield
    click(button(user, "Kine"))
    yield
    tab(user, "Cam")
    yield
    box, before = user.number("cam.base_radius_mm"), user.design.drive.cam.base_radius_mm
    where, notch = QPointF(5.0, 5.0), QPoint(0, 120)
    scroll = Qt.MouseButton.NoButton, NO_KEYS, Qt.ScrollPhase.NoScrollPhase, False
    turn = QWheelEvent(where, box.mapToGlobal(where), QPoint(), notch, *scroll)
    box.setFocus()
    QApplication.sendEvent(box, turn)
    settle()
    after = user.design.drive.cam.base_radius_mm
    assert after > before
    user.enter("cam.base_radius_mm", "-3")
    assert box.text() == "-3"
    assert user.design.drive.cam.base_radius_mm == after
    user.press(Qt.Key.Key_Escape)


def drag_a_join(user: User) -> Iterator[None]:
    yield
    click(button(user, "Make"))
    yield
    view = user.see("motion")
    assert isinstance(view, SegmentsView)
    paper, before = view.diagram.viewport(), user.design
    start = view.diagram.position_of_join(2)
    QTest.mousePress(paper, LEFT, pos=start.toPoint())
    for part in (5.0, 10.0, 15.0):
        at = start + QPointF(part, 0.0)
        move = QMouseEvent(QEvent.Type.MouseMove, at, paper.mapToGlobal(at), Qt.MouseButton.NoButton, LEFT, NO_KEYS)
        QApplication.sendEvent(paper, move)
        settle()
    QTest.mouseRelease(paper, LEFT, pos=(start + QPointF(15.0, 0.0)).toPoint())
    settle()
    assert user.design.drive.motion.segments[1].span_deg > before.drive.motion.segments[1].span_deg


def read_the_limits(user: User) -> Iterator[None]:
    yield
    tab(user, "Limits")
    user.enter("limits.pressure_angle_return_deg", "15")
    yield
    view = user.see("findings")
    assert isinstance(view, FindingsView)
    wait_for(lambda: view.table.model().rowCount() > 0)
    user.turn(0.0)
    click(view.table.viewport(), view.table.visualRect(view.table.model().index(0, 0)).center())
    assert user.window.player.theta != 0.0
    user.choose("View", "Docks", "Certificate")
    yield


def find_a_dimension(user: User) -> Iterator[None]:
    tab(user, "Parameters")  # the certificate is in front of them
    user.choose("Kine", "Find")
    view = user.see("find")
    assert isinstance(view, FindView)
    wait_for(lambda: not view.busy)
    yield
    before = user.design
    click(button(user, "Take over"))
    assert user.design != before


def export_the_tables(user: User) -> Iterator[None]:
    yield
    user.press(Qt.Key.Key_E, modifier=Qt.KeyboardModifier.ControlModifier)


PLAYS: tuple[Callable[[User], Iterator[None]], ...] = (
    play_the_lift, change_the_stroke, turn_the_wheel, drag_a_join, read_the_limits, find_a_dimension, export_the_tables,
)  # fmt: skip


def test_the_five_minutes_of_readme_are_true_word_by_word(
    open_user: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(export_dialogs, "ask_tables", lambda *_: TablesRequest(tmp_path / "tables", 360))
    user = open_user(size=(1440, 900), whole=True)
    user.window.greet()
    settle()
    assert len(steps()) == len(PLAYS)
    for text, play in zip(steps(), PLAYS, strict=True):
        names = re.findall(r"\*([^*]+)\*", text)
        missing = {name for name in names if " > " not in name}
        for _ in play(user):
            settle()
            missing -= on_screen()
        settle()
        missing -= on_screen()
        assert missing == set(), f"not on the screen in: {text}"
        assert [name for name in names if " > " in name and not is_entry(user, name.split(" > "))] == []
    for name in re.findall(r"`(\w+\.(?:csv|json))`", steps()[-1]):
        assert (tmp_path / "tables" / name).is_file()
    assert user.faults == []
