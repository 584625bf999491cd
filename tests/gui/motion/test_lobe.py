"""The lobe of a valve train in the window: its fields above the motion, its segments greyed, or made ordinary ones."""

from pathlib import Path

import pytest
from valve_trains import FLAT_TAPPET, LOBE_A
from window_user import Open, User, settle

from core.project import load

LOBE = (
    'format = 1\nname = "Lobe"\n'
    + LOBE_A
    + FLAT_TAPPET
    + """[shaft]
rotation = "ccw"
speed_rpm = 1000.0
"""
)


@pytest.fixture
def user(same_window: Open, tmp_path: Path) -> User:
    (tmp_path / "lobe.toml").write_text(LOBE, encoding="utf-8")
    return same_window(tmp_path / "lobe.toml")


def test_a_lobe_is_edited_by_its_fields_and_becomes_segments(user: User, tmp_path: Path) -> None:
    view = user.motion()
    assert view.header.origin.text() == "Follows from a lobe"
    assert not view.table.isEnabled()
    assert user.session.edit("motion.lobe.duration[1].crank_deg", 212.0, "Change")
    settle()
    assert view.header.fields["motion.lobe.duration[1].crank_deg"].editor.value == 212.0
    user.session.end_gesture()
    user.session.edit("motion.lobe.duration[1].crank_deg", 90.0, "Change")
    settle()
    assert user.session.incomplete is not None, "no lobe has it: the last one remains"
    assert user.design.drive.motion.lobe.duration[1].crank_deg == 212.0
    user.choose("Edit", "Undo Change")
    user.choose("File", "Save")
    text = (tmp_path / "lobe.toml").read_text(encoding="utf-8")
    assert "212.0" in text
    assert "segments" not in text
    user.choose("Make", "Lobe to segments")
    assert user.steps[-1] == "Lobe to segments"
    assert view.table.isEnabled()
    assert not view.header.unlink_button.isVisible()
    user.choose("File", "Save")
    saved = load(tmp_path / "lobe.toml").drive.motion
    assert saved.lobe is None
    assert [segment.curve.law for segment in saved.segments][:3] == ["dwell", "c1", "cv1"]
    user.choose("Edit", "Undo Lobe to segments")
    settle()
    assert view.header.origin.isVisible()
    assert user.design.drive.motion.lobe is not None


def test_the_page_of_the_motion_shows_the_lobe_without_fields_of_segments(user: User) -> None:
    """Segments of a lobe are no entries of the file."""
    view = user.parameters()
    form = view.pages["motion"]
    view.tabs.setCurrentWidget(form)
    settle()
    assert form.isVisible()
    assert "motion.lobe.lift_mm" in form.fields
    assert not [path for path in form.fields if path.startswith("motion.segments")]
    user.choose("Make", "Lobe to segments")
    settle()
    assert "motion.segments[0].law" in form.fields


def test_the_sides_of_a_lobe_have_the_names_of_their_parts(user: User) -> None:
    view = user.motion()
    names = [view.model.data(view.model.index(row, 0)) for row in range(4)]
    assert names == ["Dwell", "run-up, ramp, flank, nose", "nose, flank, ramp, run-down", "Dwell"]
    page = user.parameters().pages["motion"]
    user.parameters().tabs.setCurrentWidget(page)
    settle()
    assert page.segment.itemText(1).startswith("2  run-up, ramp, flank, nose, ")
    assert page.segment.itemText(2).startswith("3  nose, flank, ramp, run-down, ")


def test_all_fields_of_a_lobe_are_within_the_page(user: User) -> None:
    """At the width of the parameters no field and no button is cut off at the right."""
    view = user.parameters()
    page = view.pages["motion"]
    view.tabs.setCurrentWidget(page)
    settle()
    right = page.viewport().width()
    parts = [field.editor for field in page.header.fields.values()] + [page.header.unlink_button]
    assert max(part.mapTo(page.viewport(), part.rect().topRight()).x() for part in parts) < right
