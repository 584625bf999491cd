"""A motion by itself: saved, taken over, begun elsewhere in the turn; a rise that becomes a dwell."""

from pathlib import Path

import numpy as np
import pytest
from feeds import DEFAULT_CAM, FEED
from large_designs import EXAMPLES

from core.__main__ import main
from core.design import (
    Motion,
    NamedCurve,
    Segment,
    alone,
    insert_segment,
    missing_of_motion,
    with_motion,
    with_motion_of,
    with_value,
)
from core.errors import DesignError
from core.motion import findings, program
from core.motion.split import shift_motion
from core.project import load, loads

LIFT = load(EXAMPLES / "transfer_lift.toml")


def levels(motion: Motion, degrees: np.ndarray) -> np.ndarray:
    compiled = program(motion)
    return compiled.state(compiled.angles(np.deg2rad(degrees % 360.0))).y[:3]


@pytest.mark.parametrize("by", [10.0, -10.0, 35.0, 180.0, 359.5])
def test_a_shifted_motion_does_the_same_later(by: float) -> None:
    shifted = shift_motion(LIFT, by)
    at = np.linspace(0.0, 359.0, 113)
    there, before = levels(shifted.drive.motion, at), levels(LIFT.drive.motion, at - by)
    assert np.abs(there - before).max() <= 1e-12 * np.abs(before).max()
    again = shift_motion(shifted, -by).drive.motion
    assert [s.span_deg for s in again.segments] == pytest.approx([35.0, 41.5, 207.0, 41.5, 35.0], abs=1e-9)


def test_what_goes_on_is_shifted_with_its_advance() -> None:
    feed = loads(FEED)
    shifted = shift_motion(feed, 200.0).drive.motion
    assert (shifted.start, shifted.advance) == (-140.0, 300.0)  # at rest at 160 mm, a turn before
    assert findings(program(shifted)) == findings(program(feed.drive.motion))
    turned = shift_motion(loads(DEFAULT_CAM), -180.0).drive.motion  # within a constant velocity
    at = np.array([0.0, 30.0, 100.0])
    assert np.rad2deg(levels(turned, at)[0]) == pytest.approx(
        np.rad2deg(levels(loads(DEFAULT_CAM).drive.motion, at + 180.0)[0]), abs=1e-9
    )


def test_a_law_that_has_no_parts_is_not_cut(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(DesignError, match="inside segment 2, whose law cannot be split"):
        shift_motion(LIFT, -50.0)
    assert (
        main(["motion", str(EXAMPLES / "transfer_lift.toml"), "--shift", "-50", "--out", str(tmp_path / "m.toml")]) == 2
    )
    assert capsys.readouterr().err.count("\n") == 1
    assert not (tmp_path / "m.toml").exists()


def test_a_motion_is_saved_and_taken_over_without_loss(tmp_path: Path) -> None:
    source, file, design = EXAMPLES / "transfer_unit.toml", tmp_path / "m.toml", tmp_path / "lift.toml"
    drive = load(source).drives[2]
    assert main(["motion", str(source), "--drive", drive.name, "--out", str(file)]) == 0
    assert load(file).drive.motion == drive.motion
    assert load(file).stages == ("motion",)
    design.write_text((EXAMPLES / "transfer_lift.toml").read_text(encoding="utf-8"), encoding="utf-8")
    assert main(["motion", str(file), "--shift", "-5", "--into", str(design)]) == 0
    assert load(design).drive.motion == shift_motion(load(file), -5.0).drive.motion
    assert load(design).drive.cam == LIFT.drive.cam
    assert main(["motion", str(file)]) == 2
    with pytest.raises(DesignError, match="this design's is in mm"):
        with_motion_of(LIFT, loads(DEFAULT_CAM))
    with pytest.raises(DesignError, match="a disk cam repeats its motion"):
        with_motion_of(LIFT, loads(FEED))
    assert alone(LIFT).shaft.speed_rpm == LIFT.shaft.speed_rpm


def test_a_dwell_is_put_before_a_segment() -> None:
    made = insert_segment(LIFT, 1, before=True).drive.motion
    assert [(s.span_deg, s.rise) for s in made.segments[:3]] == [(35.0, 0.0), (20.75, 0.0), (20.75, -150.0)]


def test_a_rise_that_becomes_a_dwell_leaves_its_return_for_the_way_back() -> None:
    """So that a new design need not begin with its rise."""
    rows = ((120.0, 50.0, "modified-sine"), (60.0, 0.0, "dwell"), (120.0, -50.0, "modified-sine"), (60.0, 0.0, "dwell"))
    new = with_motion(alone(LIFT), Motion(0.0, tuple(Segment(a, b, NamedCurve(c)) for a, b, c in rows)))
    waits = with_value(new, "motion.segments[0].law", "dwell")
    assert [s.rise for s in waits.drive.motion.segments] == [0.0, 0.0, -50.0, 0.0]
    assert len(missing_of_motion(waits)) == 1
    done = with_value(waits, "motion.segments[1].law", "cycloidal")
    assert [s.rise for s in done.drive.motion.segments] == [0.0, 50.0, -50.0, 0.0]
    assert missing_of_motion(done) == []
