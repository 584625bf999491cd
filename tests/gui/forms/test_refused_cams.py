"""Cams that cannot be, or exceed a limit, as the user types them: named in the form or among the findings, the last good one stays."""

from pathlib import Path

import pytest
from sampled import spread
from window_user import Open, wait_for

from kindyna_gui.findings import FindingsView

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"

# example, field, what is typed, what the form says
NONE = [
    ("rocker_cam", "follower.pivot_x_mm", "300", "cannot reach the base circle"),
    ("rocker_flat", "cam.base_radius_mm", "200", "cannot lie on the base circle"),
    ("tappet_knife", "follower.offset_mm", "90", "must stay within"),
    ("globoidal_indexer", "cam.rollers", "12", "rollers than fit on the turret"),
    ("barrel_feeder", "cam.roller_radius_mm", "71", "smaller than the roller's distance"),
]
# ... and the finding
FOUND = [
    ("tappet_flat", "cam.base_radius_mm", "5", "Undercut: under the flat face"),
    ("tappet_flat", "follower.face_half_width_mm", "3", "The contact leaves the flat face at"),
    ("groove", "cam.base_radius_mm", "2", "groove"),
    ("globoidal_indexer", "cam.centre_distance_mm", "92", "enlarge the centre distance"),
    ("groove", "cam.cutter_radius_mm", "20", "The cutter's radius of 20 mm is more than half the width of the groove"),
    ("transfer_lift", "limits.pressure_angle_return_deg", "15", "your limit 15 deg"),
]


@pytest.fixture
def open_user(same_window: Open) -> Open:
    """One window for all tests of this file."""
    return same_window


@pytest.mark.parametrize(("name", "path", "text", "says"), spread(NONE, 1), ids=[row[0] for row in NONE])
def test_a_cam_that_cannot_be_is_named_and_the_last_good_one_stays(
    name: str, path: str, text: str, says: str, open_user: Open
) -> None:
    user = open_user(EXAMPLES / f"{name}.toml")
    before = user.session.study
    user.enter(path, text)
    assert user.session.study is before
    assert says in user.field(path).trouble
    assert user.number(path).text() == text, "it stays as typed"


@pytest.mark.parametrize(("name", "path", "text", "says"), spread(FOUND, 2), ids=[row[1] for row in FOUND])
def test_what_a_cam_exceeds_is_listed_with_its_field(
    name: str, path: str, text: str, says: str, open_user: Open
) -> None:
    user = open_user(EXAMPLES / f"{name}.toml")
    view = user.window.show_view("findings")
    assert isinstance(view, FindingsView)
    user.enter(path, text)
    wait_for(lambda: view.up_to_date)
    listed = [finding for finding in view.findings if says.lower() in finding.message.lower()]
    assert listed, [finding.message for finding in view.findings]
    user.enter(path, "" if path.startswith("limits") else text)
    wait_for(lambda: view.up_to_date)
    assert bool([f for f in view.findings if says.lower() in f.message.lower()]) != path.startswith("limits")
