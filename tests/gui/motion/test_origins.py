"""A motion that follows from other files in the window: greyed, saved as typed, noticed where a file changes, made its own."""

from pathlib import Path

import pytest
from feeds import FEED
from window_user import Open, User, settle, wait_for

from core.project import load

SUM = 'format = 1\nname = "Sum"\n\n[motion]\nsum = ["a.toml", "b.toml"]\n'


@pytest.fixture
def user(same_window: Open, tmp_path: Path) -> User:
    (tmp_path / "a.toml").write_text(FEED, encoding="utf-8")
    (tmp_path / "b.toml").write_text(FEED.replace("300.0", "100.0").replace("150.0", "50.0"), encoding="utf-8")
    (tmp_path / "sum.toml").write_text(SUM, encoding="utf-8")
    return same_window(tmp_path / "sum.toml")


def test_a_motion_that_follows_from_files_is_shown_greyed_and_can_be_made_its_own(user: User, tmp_path: Path) -> None:
    view = user.motion()
    assert view.head.origin.text() == "Sum of the motions of a.toml, b.toml"
    assert not view.table.isEnabled()
    assert not any(field.editor.isEnabled() for field in view.head.fields.values())
    assert not any(button.isEnabled() for button in view.bar.buttons.values())
    assert not user.session.modified
    user.choose("File", "Save")
    assert (tmp_path / "sum.toml").read_text(encoding="utf-8").count("a.toml") == 1
    view.head.own_button.click()
    settle()
    assert user.steps == ["Make the motion its own"]
    assert view.table.isEnabled()
    assert view.head.own_button.isHidden() or not view.head.own_button.isVisible()
    user.choose("File", "Save")
    assert load(tmp_path / "sum.toml").drive.motion.follows is None
    assert load(tmp_path / "sum.toml").drive.motion.advance == 400.0


def test_a_file_that_a_motion_follows_from_is_noticed_when_it_changes(user: User, tmp_path: Path) -> None:
    changed = FEED.replace("300.0", "200.0").replace("150.0", "100.0")
    (tmp_path / "b.toml").write_text(changed, encoding="utf-8")
    wait_for(user.window.disk.isVisible)
    user.choose("File", "Reload")
    assert user.design.drive.motion.advance == 500.0
