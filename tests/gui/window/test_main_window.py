"""kindyna_gui.window.main_window, documents, settings: files, questions, layout, and what is computed for whom."""

import gc
import shutil
import weakref
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import (
    QAbstractAnimation,
    QCoreApplication,
    QEvent,
    QMimeData,
    QPoint,
    QPointF,
    Qt,
    QTimer,
    QUrl,
)
from PySide6.QtGui import QColor, QDragEnterEvent, QDropEvent, QPalette
from PySide6.QtWidgets import QApplication, QFileDialog, QMessageBox, QWidget
from sampled import spread
from window_user import Open, User, settle, wait_for

from core.project import load
from kindyna_gui import dialogs
from kindyna_gui.dialogs import SaveAnswer, ask_to_save, show_faults
from kindyna_gui.places import example
from kindyna_gui.settings import Settings, settings_file
from kindyna_gui.window.docks import VIEWS
from kindyna_gui.window.main_window import MainWindow, open_window

LIFT, PICKER = example("transfer_lift"), example("card_picker")
ROD = "follower.rod_mm"

DESIGN_TO_SAVE = dialogs.design_to_save


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    """A file of the user's own."""
    path = tmp_path / "mine.toml"
    shutil.copy(LIFT, path)
    return path


# -- what stands there at first ---------------------------------------------------------------------------


def test_views_are_made_when_they_are_first_seen(whole: User) -> None:
    made = {name for name in VIEWS if whole.window.view(name) is not None}
    assert made == {"mechanism", "motion", "parameters", "findings"}


def test_a_new_window_has_the_focus_in_its_drawing(open_user: Open) -> None:
    user = open_user(whole=True)
    assert QApplication.focusWidget() is user.drawing().canvas


@pytest.mark.stress
def test_no_other_window_flashes_up(whole: User) -> None:
    """A widget that is shown before it has its place is a window for a moment."""
    seen: list[str] = []

    def watch(window: object) -> None:
        if window is not None and window is not whole.window.windowHandle():
            seen.append(str(window))

    QApplication.instance().focusWindowChanged.connect(watch)  # type: ignore[union-attr]
    for name in VIEWS:
        whole.window.show_view(name)
        settle()
    whole.choose("File", "Examples", "Card picker")
    QApplication.instance().focusWindowChanged.disconnect(watch)  # type: ignore[union-attr]
    assert seen == []


@pytest.mark.parametrize("waited", spread([True, False], 1), ids=["at rest", "at once"])
def test_a_closed_window_leaves_nothing_behind(app: QApplication, waited: bool) -> None:
    window = open_window(app)
    window.show()
    if waited:
        settle()
    window.status.ask("Click a second pin")
    window.status.clearMessage()  # the question would be shown again at the next event
    remembered = [weakref.ref(each) for each in (window, window.session, window.player, window.docks["torque"])]
    window.close()
    window.deleteLater()
    del window
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    gc.collect()
    assert [each() for each in remembered] == [None] * 4


def test_docks_and_bars_are_in_their_places_at_once(open_user: Open) -> None:
    """One that still moves while it is deleted takes the process with it."""
    window = open_user(whole=True).window
    for change in (lambda: window.begin_tutorial("lift"), lambda: window.show_task("make"), window.reset_layout):
        change()
        assert window.findChildren(QAbstractAnimation) == []


# -- opening and saving -----------------------------------------------------------------------------------


def test_the_window_begins_with_the_lift_paused_at_zero(user: User) -> None:
    assert user.design == load(LIFT)
    assert (user.window.player.theta, user.window.player.playing) == (0.0, False)
    assert user.window.windowTitle() == "Transfer unit, lift drive[*] \u2013 KINDYNA"
    assert not user.window.isWindowModified()


def test_open_edit_save_and_open_again(user: User, mine: Path) -> None:
    user.picks("design_to_open", mine)
    user.choose("File", "Open...")
    assert user.window.windowTitle() == "mine.toml[*] \u2013 KINDYNA"
    user.enter(ROD, "850")
    assert user.window.isWindowModified()
    user.choose("File", "Save")
    assert not user.window.isWindowModified()
    expected = LIFT.read_text(encoding="utf-8").replace("rod_mm = 845.0", "rod_mm = 850.0")
    assert mine.read_text(encoding="utf-8") == expected
    user.choose("Edit", "Undo Change rod L2 to 850 mm")
    assert user.window.isWindowModified()
    user.answers(SaveAnswer.DISCARD)
    user.choose("File", "Open...")
    assert user.number(ROD).text() == "850"


def test_saving_takes_what_is_being_typed(user: User, mine: Path) -> None:
    user.window.documents.open_path(mine)
    user.number(ROD)
    user.type("850")
    user.press(Qt.Key.Key_S, modifier=Qt.KeyboardModifier.ControlModifier)
    assert "rod_mm = 850.0" in mine.read_text(encoding="utf-8")
    assert user.number(ROD).hasFocus()


def test_an_example_asks_for_a_name_when_it_is_saved(user: User, tmp_path: Path) -> None:
    before = LIFT.read_text(encoding="utf-8")
    user.enter(ROD, "850")
    suggested = user.picks("design_to_save", tmp_path / "new.toml")
    user.choose("File", "Save")
    assert suggested[0].name == "Transfer unit, lift drive.toml"
    assert user.session.path == tmp_path / "new.toml"
    assert LIFT.read_text(encoding="utf-8") == before
    assert user.window.statusBar().currentMessage() == f"Saved {tmp_path / 'new.toml'}"


def test_save_as_that_is_cancelled_changes_nothing(user: User) -> None:
    user.enter(ROD, "850")
    user.picks("design_to_save", None)
    user.choose("File", "Save as...")
    assert user.session.path is None
    assert user.window.isWindowModified()


def test_a_bad_file_is_told_with_all_its_faults(user: User, tmp_path: Path) -> None:
    bad = tmp_path / "bad.toml"
    text = LIFT.read_text(encoding="utf-8").replace("rod_mm = 845.0", "rod_mm = -845.0").replace("speed_rpm", "speed")
    bad.write_text(text, encoding="utf-8")
    user.picks("design_to_open", bad)
    user.choose("File", "Open...")
    what, lines = user.faults[0]
    assert what == "bad.toml cannot be opened."
    assert any(line.startswith("follower.rod_mm = -845.0") for line in lines)
    assert any("shaft.speed" in line for line in lines)
    assert user.design == load(LIFT)
    assert user.session.path is None


def test_a_file_that_cannot_be_written_is_told(user: User, tmp_path: Path) -> None:
    user.picks("design_to_save", tmp_path / "nowhere" / "new.toml")
    user.choose("File", "Save as...")
    assert user.faults[0][0] == "new.toml cannot be saved."
    assert user.session.path is None


def test_faults_are_shown_in_a_box(user: User) -> None:
    shown: list[tuple[str, str, str]] = []

    def look() -> None:
        box = QApplication.activeModalWidget()
        assert isinstance(box, QMessageBox)
        shown.append((box.text(), box.informativeText(), box.detailedText()))
        box.accept()

    lines = [f"fault {i}" for i in range(20)]
    QTimer.singleShot(0, user.window, look)
    show_faults(user.window, "bad.toml cannot be opened.", lines)
    assert shown[0][0] == "bad.toml cannot be opened."
    assert shown[0][1].endswith("fault 11\n... and 8 more")
    assert shown[0][2].splitlines() == lines


def test_the_box_about_unsaved_changes(user: User) -> None:
    for answer in SaveAnswer:

        def press(button: str = answer.name.capitalize()) -> None:
            box = QApplication.activeModalWidget()
            assert isinstance(box, QMessageBox)
            assert box.text() == "mine.toml has unsaved changes."
            box.button(QMessageBox.StandardButton[button]).click()

        QTimer.singleShot(0, user.window, press)
        assert ask_to_save(user.window, "mine.toml") is answer


def test_names_of_files_get_their_ending(user: User) -> None:
    def named(*words: Any) -> Path | None:
        return dialogs.with_suffix(user.window, *words)

    assert named("", ".toml") is None
    assert named("a/b", ".toml") == Path("a/b.toml")
    assert named("a/b.toml", ".toml") == Path("a/b.toml")
    assert named("b.v2", ".toml") == Path("b.v2.toml")
    assert named("b.SVG", ".png", (".png", ".svg")) == Path("b.SVG")


def test_a_file_that_is_there_with_its_ending_is_not_replaced_unasked(
    user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The file dialog looks for the name as it was typed, without the ending."""
    theirs = tmp_path / "lift.toml"
    theirs.write_text("theirs", "utf-8")
    monkeypatch.setattr(dialogs, "design_to_save", DESIGN_TO_SAVE)
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(tmp_path / "lift"), ""))
    asked = user.clicks("No")
    user.choose("File", "Save as...")
    assert "lift.toml already exists" in asked[0]
    assert theirs.read_text("utf-8") == "theirs"
    user.clicks("Yes")
    user.choose("File", "Save as...")
    assert load(theirs) == user.design


def test_a_design_is_dropped_on_the_window(user: User, mine: Path) -> None:
    def drop(path: Path) -> bool:
        data = QMimeData()
        data.setUrls([QUrl.fromLocalFile(str(path))])
        what = (Qt.DropAction.CopyAction, data, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier)
        enter = QDragEnterEvent(QPoint(5, 5), *what)
        enter.setAccepted(False)
        QApplication.sendEvent(user.window, enter)
        if enter.isAccepted():
            QApplication.sendEvent(user.window, QDropEvent(QPointF(5.0, 5.0), *what))
        return enter.isAccepted()

    assert not drop(mine.with_suffix(".txt"))
    assert drop(mine)
    assert user.session.path == mine


# -- unsaved changes --------------------------------------------------------------------------------------


LEAVING = {
    "open": lambda user: user.choose("File", "Open..."),
    "new": lambda user: user.choose("File", "New by type", "Translating follower"),
    "example": lambda user: user.choose("File", "Examples", "Card picker"),
    "drop": lambda user: user.window.documents.open_path(PICKER),
    "close": lambda user: user.window.close(),
}


def changed(user: User) -> None:
    """Leave a change behind."""
    user.session.edit("name", f"{user.design.name}, changed", "Change name")
    assert user.window.isWindowModified()


def left(user: User, way: str) -> bool:
    return not user.window.isVisible() if way == "close" else not user.window.isWindowModified()


def test_cancel_stays(user: User) -> None:
    user.picks("design_to_open", PICKER)
    asked = user.answers(SaveAnswer.CANCEL)
    changed(user)
    for way, leave in LEAVING.items():
        leave(user)
        assert not left(user, way), way
    assert asked == ["Transfer unit, lift drive, changed"] * len(LEAVING)
    assert user.steps == ["Change name"]


def test_discard_leaves(user: User) -> None:
    user.picks("design_to_open", PICKER)
    asked = user.answers(SaveAnswer.DISCARD)
    for way, leave in LEAVING.items():
        changed(user)
        leave(user)
        assert left(user, way), way
    assert len(asked) == len(LEAVING)


def test_save_saves_and_leaves(user: User, tmp_path: Path) -> None:
    user.picks("design_to_open", PICKER)
    user.answers(SaveAnswer.SAVE)
    for way, leave in LEAVING.items():
        path = tmp_path / f"{way}.toml"
        shutil.copy(LIFT, path)
        user.session.open(path)
        changed(user)
        leave(user)
        assert left(user, way), way
        assert 'name = "Transfer unit, lift drive, changed"' in path.read_text(encoding="utf-8")


def test_saving_that_fails_stays(user: User) -> None:
    user.enter(ROD, "850")
    user.answers(SaveAnswer.SAVE)
    user.picks("design_to_save", None)
    user.window.close()
    assert user.window.isVisible()


def test_without_changes_nothing_is_asked(user: User) -> None:
    asked = user.answers(SaveAnswer.CANCEL)
    user.choose("File", "Examples", "Card picker")
    user.window.close()
    assert asked == []
    assert not user.window.isVisible()


# -- recent files -----------------------------------------------------------------------------------------


def test_recent_files_are_offered_the_latest_first(open_user: Open, tmp_path: Path) -> None:
    user = open_user()
    assert not user.action("File", "Open recent").isEnabled()
    paths = [tmp_path / f"design{i}.toml" for i in range(10)]
    for path in paths:
        shutil.copy(LIFT, path)
        user.window.documents.open_path(path)
    user.window.documents.open_path(paths[5])
    names = ["design5.toml", *(p.name for p in reversed(paths) if p != paths[5])]
    entries = user.entries("File", "Open recent")
    assert 5 <= len(entries) - 1 < len(paths), "the menu stays short"
    names = names[: len(entries) - 1]
    assert entries == [*(f"{i}  {name}" for i, name in enumerate(names, 1)), "Clear list"]
    user.choose("File", "Open recent", entries[2])
    assert user.session.path == tmp_path / names[2]
    assert Settings().folder == tmp_path
    user.choose("File", "Open recent", "Clear list")
    assert not user.action("File", "Open recent").isEnabled()


def test_a_recent_file_that_has_gone_is_told_and_dropped(open_user: Open, mine: Path) -> None:
    user = open_user()
    user.window.documents.open_path(mine)
    mine.unlink()
    asked = user.answers(SaveAnswer.DISCARD)
    user.choose("File", "Open recent", "1  mine.toml")
    assert asked == ["mine.toml"], "it is nowhere but in the window"
    assert user.faults[0][0] == "mine.toml cannot be opened."
    assert not user.action("File", "Open recent").isEnabled()


# -- layout -----------------------------------------------------------------------------------------------


def shown(window: MainWindow) -> set[str]:
    return {name for name, dock in window.docks.items() if not dock.isHidden()}


def test_the_layout_is_kept_and_can_be_reset(open_user: Open) -> None:
    whole = open_user(whole=True)
    first = shown(whole.window)
    whole.window.docks["findings"].close()
    whole.window.show_view("certificate")
    whole.window.close()
    again = open_user(size=None)
    assert shown(again.window) == first - {"findings"} | {"certificate"}
    wait_for(lambda: again.window.view("certificate") is not None)
    assert again.window.view("findings") is None
    again.choose("View", "Reset layout")
    assert shown(again.window) == first
    wait_for(lambda: again.window.view("findings") is not None)


@pytest.mark.stress
def test_a_layout_of_another_version_is_forgotten(whole: User, open_user: Open) -> None:
    first = shown(whole.window)
    whole.window.docks["motion"].close()
    earlier = whole.window.saveState(2)
    whole.window.close()
    kept = settings_file()
    kept.clear()
    kept.setValue("window/state", earlier)  # where an earlier version of the program had it
    kept.sync()
    again = open_user(size=None)
    assert shown(again.window) == first
    again.window.close()
    assert kept.value("window/state") == earlier, "that version may still be used"
    task = again.window.layouts.current
    (key,) = (key for key in kept.allKeys() if key.endswith(f"{task}/docks"))
    kept.setValue(key, b"of another program")
    kept.sync()
    assert shown(open_user(size=None).window) == first


@pytest.mark.stress
def test_tabs_need_no_titles(whole: User) -> None:
    whole.press(Qt.Key.Key_3, modifier=Qt.KeyboardModifier.ControlModifier)

    def bare() -> set[str]:
        return {
            name
            for name, dock in whole.window.docks.items()
            if not dock.isHidden() and dock.titleBarWidget() is not None
        }

    wait_for(lambda: bare() == shown(whole.window) - {"parameters", "findings"})
    for name in ("velocity", "acceleration", "jerk"):
        whole.window.docks[name].hide()
    wait_for(lambda: whole.window.docks["displacement"].titleBarWidget() is None)


def test_the_look_does_not_follow_a_dark_desktop(app: QApplication, open_user: Open) -> None:
    dark = QPalette(QColor("#202020"))
    assert dark.windowText().color().lightnessF() > 0.8
    app.setPalette(dark)
    window = open_user().window
    picture = window.grab().toImage()
    edge = [picture.pixelColor(x, picture.height() - 4) for x in range(4, picture.width(), 50)]
    assert sum(colour.lightnessF() > 0.8 for colour in edge) > 0.9 * len(edge)
    for child in window.findChildren(QWidget):
        text, ground = child.palette().windowText().color(), child.palette().window().color()
        assert text.lightnessF() < ground.lightnessF(), type(child).__name__
