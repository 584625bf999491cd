"""core.design: what is assumed of a linkage, point by point or as a whole."""

from pathlib import Path

from core.design import is_assumed, with_assumed
from core.project import load

COUPLER_CAM = Path(__file__).parents[3] / "resources" / "examples" / "four_bar_coupler_cam.toml"


def test_a_coordinate_is_assumed_with_the_points_of_its_link() -> None:
    design = load(COUPLER_CAM)
    assert is_assumed(design, "linkage.links[2].points.C.x_mm")
    assert not is_assumed(design, "linkage.driver.speed_rpm")


def test_a_coordinate_is_known_while_the_others_of_its_link_stay_assumed() -> None:
    design = load(COUPLER_CAM)
    known = with_assumed(design, "linkage.links[2].points.C.x_mm", False)
    assert not is_assumed(known, "linkage.links[2].points.C.x_mm")
    for path in ("C.y_mm", "A.x_mm", "B.y_mm"):
        assert is_assumed(known, f"linkage.links[2].points.{path}")
    assert is_assumed(known, "linkage.links[3].points.B.x_mm")


def test_what_is_marked_is_added_to_what_was() -> None:
    design = with_assumed(load(COUPLER_CAM), "linkage.driver.speed_rpm", True)
    assert set(design.assumed) == {*load(COUPLER_CAM).assumed, "linkage.driver.speed_rpm"}
