"""A design's file that another program changes, replaces or takes away while the window is open."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QMessageBox
from sampled import spread
from window_user import Open, User, wait_for

from core.design import edited
from core.project import load, save
from kindyna_gui.places import example

Change = Callable[[Path], None]


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    """A design file of the user's own."""
    path = tmp_path / "mine.toml"
    path.write_bytes(example("transfer_lift").read_bytes())
    return path


def by_another(path: Path, rod: float = 812.5) -> str:
    """Another program gives the rod another length; the new text."""
    return save(edited(load(path), "follower.rod_mm", rod), path)


def in_place(path: Path) -> None:
    """As programs do that write into the file itself."""
    text = path.read_text("utf-8").replace("rod_mm = 845.0", "rod_mm = 812.5")
    with open(path, "r+", encoding="utf-8") as file:
        file.write(text)
        file.truncate()


def by_a_new_file(path: Path) -> None:
    """As editors do."""
    other = path.with_suffix(".swp")
    other.write_text(path.read_text("utf-8").replace("rod_mm = 845.0", "rod_mm = 812.5"), "utf-8")
    os.replace(other, path)


def by_moving_away(path: Path) -> None:
    """As editors do that keep the old file."""
    text = path.read_text("utf-8")
    path.rename(path.with_suffix(".bak"))
    path.write_text(text.replace("rod_mm = 845.0", "rod_mm = 812.5"), "utf-8")


def test_overwrite_only_when_chosen(open_user: Open, mine: Path) -> None:
    user: User = open_user(mine)
    user.enter("cam.base_radius_mm", "410")
    theirs = by_another(mine)
    box = user.clicks("Cancel")
    user.choose("File", "Save")
    assert box == ["mine.toml has been changed by another program since it was read."]
    assert mine.read_text("utf-8") == theirs
    assert user.session.modified
    user.clicks("Overwrite")
    user.choose("File", "Save")
    assert load(mine).drive.cam.base_radius_mm == 410.0
    assert load(mine).drive.mechanism.rod_mm == 845.0
    assert not user.session.modified


def test_what_differs_is_listed(open_user: Open, mine: Path) -> None:
    user: User = open_user(mine)
    user.enter("cam.base_radius_mm", "410")
    by_another(mine)
    seen: list[str] = []
    user.clicks("Cancel", before=lambda box: seen.append(box.informativeText()))
    user.choose("File", "Save")
    assert seen == ["Rod L2: 812.5 mm in the file, 845 mm here\nBase radius Br: 400 mm in the file, 410 mm here"]


def test_save_as_leaves_the_other_file_alone(open_user: Open, mine: Path, tmp_path: Path) -> None:
    user: User = open_user(mine)
    user.enter("cam.base_radius_mm", "410")
    theirs = by_another(mine)
    user.clicks("Save as...")
    user.picks("design_to_save", tmp_path / "other.toml")
    user.choose("File", "Save")
    assert mine.read_text("utf-8") == theirs
    assert load(tmp_path / "other.toml").drive.cam.base_radius_mm == 410.0
    assert user.session.path == tmp_path / "other.toml"
    assert user.window.disk.isHidden()


def test_reload_can_be_undone(open_user: Open, mine: Path) -> None:
    user: User = open_user(mine)
    user.enter("cam.base_radius_mm", "410")
    own = user.design
    by_another(mine)
    user.clicks("Reload the file")
    user.choose("File", "Save")
    assert user.design == load(mine)
    assert not user.session.modified
    user.window.session.stack.undo()
    assert user.design == own
    assert user.session.path == mine
    assert user.session.modified
    user.choose("File", "Save")  # what the file holds has been seen: nothing to ask
    assert load(mine) == own


@pytest.mark.stress
def test_leaving_with_save_asks_too(open_user: Open, mine: Path) -> None:
    user: User = open_user(mine)
    user.enter("cam.base_radius_mm", "410")
    theirs = by_another(mine)
    user.clicks("Save", "Cancel")
    user.window.close()
    assert user.window.isVisible(), "nothing was decided: the window stays"
    assert mine.read_text("utf-8") == theirs


@pytest.mark.parametrize("change", spread([in_place, by_a_new_file, by_moving_away], 1))
def test_a_change_is_noticed_and_reloaded(open_user: Open, mine: Path, change: Change) -> None:
    user: User = open_user(mine)
    for rod in (812.5, 845.0):
        assert user.window.disk.isHidden()
        if rod == 812.5:
            change(mine)
        else:
            by_another(mine, rod)  # a second time, though the first file may be another by now
        wait_for(user.window.disk.isVisible)
        assert user.window.disk.text() == "changed on disk"
        assert "mine.toml has been changed by another program" in user.window.status.currentMessage()
        reload = user.window.disk.menu().actions()[0]
        assert reload.isVisible()
        reload.trigger()
        assert user.design == load(mine)
        assert user.design.drive.mechanism.rod_mm == rod
        assert not user.session.modified


def test_touched_or_saved_here_is_no_change(open_user: Open, mine: Path) -> None:
    user: User = open_user(mine)
    mine.touch()
    user.enter("cam.base_radius_mm", "410")
    user.choose("File", "Save")
    user.window.watch.compare()
    assert user.window.disk.isHidden()
    assert load(mine).drive.cam.base_radius_mm == 410.0


def test_changed_and_changed_back(open_user: Open, mine: Path) -> None:
    user: User = open_user(mine)
    text = mine.read_text("utf-8")
    by_another(mine)
    wait_for(user.window.disk.isVisible)
    mine.write_text(text, "utf-8")
    wait_for(user.window.disk.isHidden)


def test_a_file_that_is_gone_is_written_again(open_user: Open, mine: Path) -> None:
    user: User = open_user(mine)
    mine.unlink()
    wait_for(user.window.disk.isVisible)
    assert user.window.disk.text() == "file is gone"
    reload, _, write = user.window.disk.menu().actions()
    assert not reload.isVisible()
    write.trigger()
    assert load(mine) == user.design
    assert user.window.disk.isHidden()


@pytest.mark.stress
def test_save_does_not_bring_a_file_back_that_is_gone_without_a_word(
    open_user: Open, mine: Path, tmp_path: Path
) -> None:
    user: User = open_user(mine)
    user.enter("cam.base_radius_mm", "410")
    mine.rename(tmp_path / "moved.toml")
    asked = user.clicks("Cancel")
    user.press(Qt.Key.Key_S, modifier=Qt.KeyboardModifier.ControlModifier)
    assert asked == ["mine.toml has been moved or deleted by another program since it was read."]
    assert not mine.exists()
    assert user.session.modified, "nothing is lost"
    user.picks("design_to_save", tmp_path / "other.toml")
    user.clicks("Save as...")
    user.choose("File", "Save")
    assert load(tmp_path / "other.toml") == user.design
    assert not mine.exists()
    (tmp_path / "other.toml").unlink()
    user.clicks("Write it again")
    user.choose("File", "Save")
    assert load(tmp_path / "other.toml") == user.design
    assert not user.session.modified
    (tmp_path / "other.toml").unlink()
    asked = user.clicks("Save")
    assert user.window.close()
    assert len(asked) == 1, "it is asked once"
    assert load(tmp_path / "other.toml") == user.design


def test_a_file_that_is_no_design_any_more(open_user: Open, mine: Path) -> None:
    user: User = open_user(mine)
    before = user.design
    mine.write_text("nonsense", "utf-8")
    wait_for(user.window.disk.isVisible)
    user.choose("File", "Reload")
    assert user.faults[0][0] == "mine.toml cannot be reloaded."
    assert user.design == before
    user.clicks("Overwrite", before=lambda box: isinstance(box, QMessageBox))
    user.choose("File", "Save")
    assert load(mine) == before


@pytest.mark.parametrize(
    ("change", "says"), [(Path.unlink, "is no longer on the disk"), (in_place, "has been changed on the disk")]
)
def test_a_design_that_is_nowhere_but_in_the_window_is_not_left_unasked(
    open_user: Open, mine: Path, change: Change, says: str
) -> None:
    user: User = open_user(mine)
    change(mine)
    asked = user.clicks("Cancel")
    assert not user.window.close()
    assert says in asked[0]
    user.clicks("Discard")
    assert user.window.close()


def test_save_as_onto_its_own_file_asks_as_save_does(
    open_user: Open, mine: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    user: User = open_user(mine)
    theirs = by_another(mine)
    monkeypatch.setattr("kindyna_gui.dialogs.design_to_save", lambda *_: mine)
    asked = user.clicks("Cancel")
    user.choose("File", "Save as...")
    assert asked == ["mine.toml has been changed by another program since it was read."]
    assert mine.read_text("utf-8") == theirs
