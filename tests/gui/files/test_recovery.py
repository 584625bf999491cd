"""Unsaved work is on the disk while the window is open, and is offered once its process has died."""

from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtWidgets import QListWidget, QTableWidget
from window_user import Open, User, settle, wait_for

from core.design import edited
from core.project import dumps, load
from core.project.recovery import RecoveryFile, Unsaved
from kindyna_gui.documents.edits import IncompleteDesign
from kindyna_gui.files.recovery import recovery_folder
from kindyna_gui.places import example

LIFT = load(example("transfer_lift"))
LONGER = edited(LIFT, "follower.rod_mm", 850.0)
LeftBehind = Callable[[Unsaved], Path]


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    """A design file of the user's own."""
    path = tmp_path / "mine.toml"
    path.write_text(dumps(LIFT), "utf-8")
    return path


@pytest.fixture
def left_behind(tmp_path: Path) -> LeftBehind:
    """Puts unsaved work where a dead process would have left it; its file."""

    def leave(unsaved: Unsaved) -> Path:
        file = RecoveryFile(tmp_path / "elsewhere")
        file.write(unsaved)
        (path,) = (tmp_path / "elsewhere").glob("*.toml")
        recovery_folder().mkdir(parents=True, exist_ok=True)
        left = path.rename(recovery_folder() / path.name)  # its lock stays behind
        file.close()
        return left

    return leave


def kept() -> list[Path]:
    """The recovery files there are."""
    return sorted(recovery_folder().glob("*.toml"))


def rows(table: QTableWidget) -> list[tuple[str, ...]]:
    return [tuple(table.item(i, j).text() for j in range(3)) for i in range(table.rowCount())]


def offer(user: User) -> None:
    """As at the start, before anything is done."""
    user.window.recovery.offer()
    settle()


def test_unsaved_work_is_on_the_disk_until_it_is_saved(open_user: Open, mine: Path) -> None:
    user: User = open_user(mine)
    assert not recovery_folder().exists(), "nothing is unsaved"
    user.enter("follower.rod_mm", "850")
    wait_for(lambda: bool(kept()))
    assert load(kept()[0]) == user.design == LONGER
    user.enter("cam.base_radius_mm", "410")
    wait_for(lambda: load(kept()[0]) == user.design)
    user.choose("File", "Save")
    wait_for(lambda: not kept())
    user.window.session.stack.undo()
    wait_for(lambda: bool(kept()))
    assert load(kept()[0]) == LONGER
    user.window.session.stack.redo()
    wait_for(lambda: not kept())


def test_a_clean_close_leaves_nothing(open_user: Open, mine: Path) -> None:
    user: User = open_user(mine)
    user.enter("follower.rod_mm", "850")
    wait_for(lambda: bool(kept()))
    user.clicks("Cancel")
    user.window.close()
    assert kept(), "the window stays"
    user.clicks("Discard")
    user.window.close()
    assert list(recovery_folder().iterdir()) == []


def test_recover(open_user: Open, mine: Path, left_behind: LeftBehind) -> None:
    left = left_behind(Unsaved(dumps(LONGER), mine, None, 1.7e9))
    user: User = open_user()
    seen: list[tuple[str, ...]] = []
    title = user.clicks("Recover", before=lambda box: seen.extend(rows(box.findChild(QTableWidget))))
    offer(user)
    assert title == ["Unsaved work"]
    assert seen == [("Rod L2", "845 mm", "850 mm")]
    assert user.design == LONGER
    assert user.session.path == mine
    assert user.session.modified
    assert load(mine) == LIFT, "until it is saved"
    assert not left.exists()
    assert [load(path) for path in kept()] == [LONGER], "it is on the disk all the while"
    user.choose("File", "Save")
    assert load(mine) == LONGER
    wait_for(lambda: not kept())


def test_later_discard_and_the_file_as_it_is(open_user: Open, mine: Path, left_behind: LeftBehind) -> None:
    left = left_behind(Unsaved(dumps(LONGER), mine))
    user: User = open_user()
    user.clicks("Later")
    offer(user)
    assert left.exists()
    assert user.session.path is None
    user.clicks("Open the file as it is")
    user.choose("File", "Recover unsaved work...")
    assert user.design == LIFT
    assert user.session.path == mine
    assert left.exists(), "it is offered again"
    user.clicks("Discard")
    user.choose("File", "Recover unsaved work...")
    assert list(recovery_folder().iterdir()) == []
    user.choose("File", "Recover unsaved work...")
    assert user.window.status.currentMessage() == "No unsaved work from an earlier run"


def test_several_the_latest_first(open_user: Open, mine: Path, left_behind: LeftBehind) -> None:
    old = left_behind(Unsaved(dumps(LONGER), mine, None, 1.0e9))
    new = left_behind(Unsaved(dumps(edited(LIFT, "name", "Untitled work")), None, None, 1.7e9))
    user: User = open_user()
    titles: list[str] = []

    def note(box: QListWidget) -> None:
        works = box.findChild(QListWidget)
        titles.append(", ".join(works.item(i).text().partition(",")[0] for i in range(works.count())))

    user.clicks("Discard", "Recover", before=note)
    offer(user)
    assert titles == ["Untitled work, mine.toml", "mine.toml"]
    assert not new.exists()
    assert not old.exists()
    assert user.design == LONGER


@pytest.mark.stress
def test_an_untitled_design_with_an_unfinished_motion(open_user: Open, left_behind: LeftBehind) -> None:
    user: User = open_user()
    user.enter_cell(1, 3, "300")
    draft = user.session.incomplete
    assert draft is not None, "the motion does not make a turn"
    state = user.session.state()
    wait_for(lambda: bool(kept()) and "span_deg = 300.0" in kept()[0].read_text("utf-8"))
    text = kept()[0].read_text("utf-8")
    user.session.stack.setIndex(0)
    wait_for(lambda: not kept())
    recovery_folder().joinpath("dead.toml").write_text(text, "utf-8")
    seen: list[tuple[str, ...]] = []
    user.clicks("Recover", before=lambda box: seen.extend(rows(box.findChild(QTableWidget))))
    offer(user)
    assert ("Rod L2", "none", "845 mm") in seen, "it has no file: all its values"
    assert ("Segment 2", "none", "law modified-sine, span_deg 300, rise_mm −150") in seen
    assert user.session.state() == state
    assert user.session.incomplete == draft
    assert isinstance(user.session.incomplete, IncompleteDesign)


@pytest.mark.stress
def test_an_unfinished_motion_of_one_of_several_drives(open_user: Open) -> None:
    user: User = open_user(example("transfer_unit"))
    session = user.session
    assert session.choose_drive(2)
    assert session.edit("motion.segments[0].span_deg", 300.0, "Change span")
    assert session.incomplete is not None, "the motion does not make a turn"
    state = session.state()
    wait_for(lambda: bool(kept()))
    text = kept()[0].read_text("utf-8")
    session.stack.setIndex(0)
    wait_for(lambda: not kept())
    assert session.choose_drive(0)
    recovery_folder().joinpath("dead.toml").write_text(text, "utf-8")
    user.clicks("Recover")
    offer(user)
    assert session.state() == state


def test_what_the_file_holds_already_is_not_offered(open_user: Open, mine: Path, left_behind: LeftBehind) -> None:
    left_behind(Unsaved(dumps(LIFT), mine))
    user: User = open_user()
    offer(user)
    assert kept() == []


@pytest.mark.stress
def test_of_another_window_nothing_is_offered(open_user: Open, mine: Path) -> None:
    first: User = open_user(mine)
    first.enter("follower.rod_mm", "850")
    wait_for(lambda: bool(kept()))
    second: User = open_user(mine)
    offer(second)
    assert second.design == LIFT
    assert load(kept()[0]) == LONGER


def test_damaged_work_is_kept_until_it_is_discarded(open_user: Open, left_behind: LeftBehind) -> None:
    left = left_behind(Unsaved("nonsense", None))
    user: User = open_user()
    user.clicks("Recover")
    offer(user)
    assert user.faults[0][0] == "This work cannot be recovered."
    assert user.design == LIFT
    assert left.exists()


@pytest.mark.stress
def test_where_nothing_can_be_written(open_user: Open, mine: Path) -> None:
    recovery_folder().parent.mkdir(parents=True, exist_ok=True)
    recovery_folder().write_text("a file where the folder should be", "utf-8")
    user: User = open_user(mine)
    user.enter("follower.rod_mm", "850")
    wait_for(lambda: user.window.status.currentMessage().startswith("Unsaved work cannot be written"))
    recovery_folder().unlink()
    user.enter("cam.base_radius_mm", "410")
    assert user.window.recovery.write_now()
    assert load(kept()[0]) == user.design
