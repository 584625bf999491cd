"""The motion that drives a linkage is edited, blended and measured as that of a cam: the same motion comes of it."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mechanisms import LIFT

from core.__main__ import main
from core.blend import Request, blend
from core.blend.best import with_blend, with_blend_as_motion, with_blend_between
from core.design import (
    Design,
    edited,
    faults,
    insert_segment,
    mirror_stroke,
    motion_of,
    move_join,
    remove_segment,
    require_motion,
    with_assumed,
    with_motion,
)
from core.errors import DesignError
from core.motion.split import add_point, copy_segment, split_segment
from core.project import load, save
from core.study import Study, certificate_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
LINKAGE = load(EXAMPLES / "cam_slider_linkage.toml")  # the lift, seen as a linkage: it has the lift's motion
COUPLER = load(EXAMPLES / "four_bar_coupler_cam.toml")
CRANK = load(EXAMPLES / "four_bar.toml")

CHANGES: dict[str, Callable[[Design], Design]] = {
    "insert": lambda design: insert_segment(design, 1),
    "remove": lambda design: remove_segment(design, 2),
    "mirror": lambda design: mirror_stroke(edited(design, "motion.segments[1].span_deg", 50.0), 1),
    "split": lambda design: split_segment(design, 1, 50.0),
    "copy": lambda design: copy_segment(design, 1),
    "join": lambda design: move_join(design, 2, 80.0, 5.0),
    "law": lambda design: edited(design, "motion.segments[1].law", "cycloidal"),
    "rise": lambda design: edited(design, "motion.segments[1].rise_mm", -120.0),
    "stroke": lambda design: edited(design, "motion.stroke_mm", 160.0),
    "point": lambda design: add_point(edited(design, "motion.segments[1].law", "spline"), 1, 50.0),
}


@pytest.mark.parametrize("name", CHANGES)
def test_an_edit_makes_the_same_motion_of_a_linkage_as_of_a_cam(name: str) -> None:
    change = CHANGES[name]
    assert motion_of(LINKAGE) == motion_of(LIFT)
    linkage, cam = change(LINKAGE), change(LIFT)
    assert motion_of(linkage) == motion_of(cam) != motion_of(LIFT)
    assert linkage.drive.is_linkage
    assert linkage.drive.mechanism == LINKAGE.drive.mechanism  # type: ignore[union-attr]
    assert faults(linkage) == []


def test_what_is_assumed_of_a_segment_goes_where_it_goes() -> None:
    marked = with_assumed(with_assumed(COUPLER, "motion.segments[1].rise_deg", True), "motion.segments[3].law", True)
    grown = insert_segment(marked, 0)
    motion_marks = [p for p in grown.assumed if p.startswith("motion.")]
    assert motion_marks == ["motion.segments[2].rise_deg", "motion.segments[4].law"]
    assert [p for p in grown.assumed if not p.startswith("motion.")] == list(COUPLER.assumed)
    assert remove_segment(grown, 1) == marked
    doubled = copy_segment(marked, 1)
    assert [p for p in doubled.assumed if p.startswith("motion.")] == [
        "motion.segments[1].rise_deg",
        "motion.segments[2].rise_deg",
        "motion.segments[4].law",
    ]


@pytest.mark.parametrize(
    "change", [lambda d: insert_segment(d, 0), lambda d: split_segment(d, 0), lambda d: move_join(d, 1, 20.0)]
)
def test_a_crank_at_speed_has_no_motion_to_change(change: Callable[[Design], Design]) -> None:
    assert motion_of(CRANK) is None
    with pytest.raises(DesignError, match=r"linkage\.driver\.kind = 'crank': turns at constant speed"):
        change(CRANK)
    with pytest.raises(DesignError):
        require_motion(CRANK)


def test_the_speed_is_that_of_the_shaft_either_way_round() -> None:
    assert LIFT.speed_rpm == LIFT.shaft.speed_rpm
    assert edited(COUPLER, "linkage.driver.speed_rpm", -45.0).speed_rpm == 45.0


def test_a_blend_goes_into_a_linkage_and_its_cam_follows() -> None:
    blended = blend(Request(type="DRD", stroke=10.0, start=60.0, end=160.0, unit="deg"))
    changed = with_blend_between(COUPLER, blended)
    assert [s.curve.law for s in require_motion(changed).segments] == [
        "dwell",
        *(c.lower() for c in blended.curves),
        "dwell",
        "cycloidal",
    ]
    assert faults(changed) == []
    study, before = Study(changed, 360), Study(COUPLER, 360)
    assert np.abs(study.cam.flank.profile - before.cam.flank.profile).max() > 1e-5
    assert all(r.kept for r in certificate_of(study).values())
    with pytest.raises(DesignError, match="unit"):
        with_blend(COUPLER, replace(blended, request=replace(blended.request, unit="mm")))
    whole = blend(Request(type="DRRD", stroke=10.0, start=30.0, end=330.0, unit="deg"))
    lifted = edited(COUPLER, "motion.start_deg", 5.0)  # the link swings from 5 to 17 degrees
    motion = require_motion(with_blend_as_motion(lifted, whole))
    assert len(motion.segments) == len(whole.segments) + 2
    assert motion.start == 5.0, "a link goes on from its own angle; only a cam has a base circle at 0"
    assert Study(with_motion(lifted, motion), 72).linkage.residual.max() < 1e-12


def test_a_measured_swing_goes_into_a_linkage(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A table of the rocker's angles, from the command line; what was assumed of the motion before is gone."""
    theta = np.arange(0.0, 360.0, 5.0)
    rows = "\n".join(f"{t:g},{6.0 - 6.0 * np.cos(np.radians(t)):.6f}" for t in theta)
    (tmp_path / "swing.csv").write_text(f"cam_angle_deg,displacement_deg\n{rows}\n", encoding="utf-8")
    path = tmp_path / "design.toml"
    save(with_assumed(COUPLER, "motion.start_deg", True), path)
    assert main(["measured", str(tmp_path / "swing.csv"), "--error", "0.0001", "--into", str(path)]) == 0
    assert "deg" in capsys.readouterr().out
    changed = load(path)
    motion = require_motion(changed)
    assert (motion.unit, motion.segments[0].curve.law) == ("deg", "simple-harmonic")
    assert [p for p in changed.assumed if p.startswith("motion.")] == []
    study = Study(changed, 72)
    assert np.rad2deg(study.motion.y[0]) == pytest.approx(6.0 - 6.0 * np.cos(study.theta), abs=1e-3)
    assert study.cam.flank.profile.size == 72
