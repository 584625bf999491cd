"""A motion that follows from other files in the window: greyed, saved as typed, noticed where a file changes, made its own."""

import math
from pathlib import Path

import pytest
from feeds import FEED
from PySide6.QtWidgets import QInputDialog
from window_user import Open, User, answering, settle, wait_for

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
    assert view.header.origin.text() == "Sum of the motions of a.toml, b.toml"
    assert not view.table.isEnabled()
    assert not any(field.editor.isEnabled() for field in view.header.fields.values())
    assert not any(button.isEnabled() for button in view.bar.buttons.values())
    assert not user.session.modified
    user.choose("File", "Save")
    assert (tmp_path / "sum.toml").read_text(encoding="utf-8").count("a.toml") == 1
    view.header.unlink_button.click()
    settle()
    assert user.steps == ["Unlink the motion from its files"]
    assert view.table.isEnabled()
    assert view.header.unlink_button.isHidden() or not view.header.unlink_button.isVisible()
    user.choose("File", "Save")
    assert load(tmp_path / "sum.toml").drive.motion.follows is None
    assert load(tmp_path / "sum.toml").drive.motion.advance == 400.0


def test_a_file_that_a_motion_follows_from_is_noticed_when_it_changes(user: User, tmp_path: Path) -> None:
    changed = FEED.replace("300.0", "200.0").replace("150.0", "100.0")
    (tmp_path / "b.toml").write_text(changed, encoding="utf-8")
    wait_for(user.window.disk.isVisible)
    assert user.window.disk.text() == "source changed"
    assert "b.toml, which a motion follows from, has been changed" in user.window.status.currentMessage()
    assert [each.text() for each in user.window.disk.menu().actions() if each.isVisible()] == [
        "&Reload it",
        "&Save as...",
    ]
    user.choose("File", "Save")  # its own file is as it was: no question, and what it follows from is still another
    assert user.window.disk.text() == "source changed"
    user.choose("File", "Reload")
    assert user.design.drive.motion.advance == 500.0
    assert not user.window.disk.isVisible()


SLIDER_CRANK = """format = 1
name = "Press"

[linkage]
driver = { link = 2, kind = "crank", speed_rpm = 60.0 }
[[linkage.links]]
number = 1
points = { O = [0.0, 0.0] }
[[linkage.links]]
number = 2
points = { O = [0.0, 0.0], A = [50.0, 0.0] }
[[linkage.links]]
number = 3
points = { A = [0.0, 0.0], B = [180.0, 0.0] }
[[linkage.links]]
number = 4
points = { B = [0.0, 0.0] }
[[linkage.sliders]]
link = 4
on = 1
"""
STROKE = """format = 1
name = "Stroke"

[motion]
start_mm = 150.0
[[motion.segments]]
law = "modified-sine"
span_deg = 180.0
rise_mm = 60.0
[[motion.segments]]
law = "3-4-5"
span_deg = 180.0
rise_mm = -60.0
"""


def test_files_are_picked_that_the_motion_follows_from(user: User, same_window: Open, tmp_path: Path) -> None:
    (tmp_path / "alone.toml").write_text(FEED.replace("300.0", "200.0").replace("150.0", "100.0"), encoding="utf-8")
    user = same_window(tmp_path / "alone.toml")
    user.picks("motion_files_to_open", [tmp_path / "a.toml", tmp_path / "b.toml"])
    user.choose("Make", "Motion that follows from files...")
    assert user.steps == ["Follow a.toml, b.toml"]
    assert user.design.drive.motion.advance == 400.0
    user.choose("File", "Save")
    assert load(tmp_path / "alone.toml").drive.motion.follows.origin.sum == ("a.toml", "b.toml")
    user.picks("motion_files_to_open", [tmp_path / "alone.toml"])
    user.choose("Make", "Motion that follows from files...")
    assert "the files go in a circle: alone.toml > alone.toml" in user.window.statusBar().currentMessage()
    assert user.steps == ["Follow a.toml, b.toml"]


@pytest.mark.stress
def test_a_crank_does_what_is_typed_of_its_slider(same_window: Open, tmp_path: Path) -> None:
    (tmp_path / "press.toml").write_text(SLIDER_CRANK, encoding="utf-8")
    (tmp_path / "stroke.toml").write_text(STROKE, encoding="utf-8")
    user = same_window(tmp_path / "stroke.toml")
    user.picks("motion_files_to_open", [tmp_path / "press.toml"])

    def act(dialog: QInputDialog) -> None:
        (row,) = [text for text in dialog.comboBoxItems() if "link 4" in text]
        dialog.setTextValue(row)
        dialog.accept()

    with answering(QInputDialog, act):
        user.choose("Make", "Motion that follows from files...")
    motion = user.design.drive.motion
    assert (motion.unit, motion.follows.origin.inverse.output) == ("deg", "4")
    # where the slider is 150 mm off, by the cosine rule
    assert abs(motion.start) == pytest.approx(
        math.degrees(math.acos((50.0**2 + 150.0**2 - 180.0**2) / (2 * 50.0 * 150.0)))
    )
    user.choose("File", "Save")
    assert load(tmp_path / "stroke.toml").drive.motion == motion


def test_a_table_is_picked_that_the_motion_follows_from(same_window: Open, tmp_path: Path) -> None:
    (tmp_path / "stroke.toml").write_text(STROKE, encoding="utf-8")
    rows = "".join(f"{a},{10.0 - 10.0 * math.cos(math.radians(a)):.6f}\n" for a in range(0, 360, 5))
    (tmp_path / "lift.csv").write_text("angle [deg],s [mm]\n" + rows, encoding="utf-8")
    user = same_window(tmp_path / "stroke.toml")
    user.picks("motion_files_to_open", [tmp_path / "lift.csv"])
    user.choose("Make", "Motion that follows from files...")
    assert user.motion().header.origin.text().endswith("lift.csv")
    assert max(user.session.study.drive.displacement[0]) == pytest.approx(0.02, abs=1e-7)
