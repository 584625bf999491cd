"""core.design.edits: what one change asks of its neighbours is done in the same step."""

import math
from pathlib import Path

import pytest
import strategies
from hypothesis import assume, given
from hypothesis import strategies as st

from core.design import (
    Design,
    Motion,
    NamedCurve,
    Segment,
    edited,
    faults,
    get,
    insert_segment,
    part_faults,
    put,
    remove_segment,
    stroke,
    with_assumed,
    with_drive,
    with_law,
    with_layout,
    with_rise,
    with_segment_inserted,
    with_span,
    with_stroke,
    without_segment,
)
from core.laws import LAWS
from core.project import load

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
LIFT: Design = load(EXAMPLES / "transfer_lift.toml")
PICKER: Design = load(EXAMPLES / "card_picker.toml")
MOTION = LIFT.drive.motion
EPS = 2.0**-52


def spans(motion: Motion) -> list[float]:
    return [s.span_deg for s in motion.segments]


def rises(motion: Motion) -> list[float]:
    return [s.rise for s in motion.segments]


def laws(motion: Motion) -> list[str]:
    return [s.curve.law for s in motion.segments]


def joins(motion: Motion) -> list[float]:
    """Cam angles of the joins [deg], without 0 and 360."""
    return [math.fsum(spans(motion)[: i + 1]) for i in range(len(motion.segments) - 1)]


def indices(motion: Motion) -> st.SearchStrategy[int]:
    return st.integers(0, len(motion.segments) - 1)


# -- spans ------------------------------------------------------------------------------------------------


def test_next_segment_gives_the_span() -> None:
    assert spans(with_span(MOTION, 1, 50.0)) == [35.0, 50.0, 198.5, 41.5, 35.0]


def test_last_segment_takes_from_the_first() -> None:
    assert spans(with_span(MOTION, 4, 40.0)) == [30.0, 41.5, 207.0, 41.5, 40.0]


def test_a_span_in_decimals_leaves_decimals() -> None:
    # 360 - 35.1 - ... in binary is 206.89999999999998
    assert spans(with_span(MOTION, 0, 35.1)) == [35.1, 41.4, 207.0, 41.5, 35.0]


def test_span_too_large_is_a_fault_of_the_next() -> None:
    changed = edited(LIFT, "motion.segments[1].span_deg", 300.0)
    assert [f.path for f in faults(changed)] == ["motion.segments[2].span_deg"]


def test_the_only_segment_keeps_to_itself() -> None:
    alone = Motion(0.0, (Segment(360.0, 0.0, NamedCurve("dwell")),))
    assert spans(with_span(alone, 0, 300.0)) == [300.0]
    assert "must make one turn" in part_faults(with_span(alone, 0, 300.0), "motion")[0].problem


@given(st.data())
def test_spans_always_make_a_turn(data: st.DataObject) -> None:
    motion = data.draw(strategies.motions())
    assume(len(motion.segments) > 1)
    index = data.draw(indices(motion))
    other = (index + 1) % len(motion.segments)
    changed = with_span(motion, index, data.draw(st.floats(0.0, 720.0)))
    assert math.fsum(spans(changed)) == pytest.approx(360.0, abs=1e-9)
    untouched = [i for i in range(len(motion.segments)) if i not in (index, other)]
    assert [changed.segments[i] for i in untouched] == [motion.segments[i] for i in untouched]


@pytest.mark.parametrize("span", [math.inf, -math.inf, 1e308])
def test_absurd_spans_are_faults(span: float) -> None:
    assert faults(edited(LIFT, "motion.segments[1].span_deg", span))


# -- rises ------------------------------------------------------------------------------------------------


def test_next_segment_that_moves_brings_the_follower_back() -> None:
    assert rises(with_rise(MOTION, 1, -120.0)) == [0.0, -120.0, 0.0, 120.0, 0.0]
    assert rises(with_rise(MOTION, 3, 120.0)) == [0.0, -120.0, 0.0, 120.0, 0.0]


def test_a_dwell_has_no_rise() -> None:
    changed = edited(LIFT, "motion.segments[0].rise_mm", 10.0)
    assert [(f.path, f.problem) for f in faults(changed)] == [("motion.segments[0].rise_mm", "a dwell does not rise")]


@given(st.data())
def test_rises_always_come_back(data: st.DataObject) -> None:
    motion = data.draw(strategies.motions())
    moving = [i for i, s in enumerate(motion.segments) if not LAWS[s.curve.law].is_dwell]
    assume(len(moving) > 1)
    changed = with_rise(motion, data.draw(st.sampled_from(moving)), data.draw(st.floats(-1e5, 1e5)))
    assert math.fsum(rises(changed)) == pytest.approx(0.0, abs=1e-9)
    assert spans(changed) == spans(motion)


@pytest.mark.parametrize("rise", [math.inf, 1e308])
def test_absurd_rises_are_faults(rise: float) -> None:
    assert faults(edited(LIFT, "motion.segments[1].rise_mm", rise))


# -- laws -------------------------------------------------------------------------------------------------


def test_a_law_changes_alone() -> None:
    changed = edited(LIFT, "motion.segments[1].law", "cycloidal").drive.motion
    assert laws(changed) == ["dwell", "cycloidal", "dwell", "modified-sine", "dwell"]
    assert (spans(changed), rises(changed)) == (spans(MOTION), rises(MOTION))


def test_what_becomes_a_dwell_loses_its_rise() -> None:
    changed = with_law(MOTION, 1, "dwell")
    assert rises(changed) == [0.0, 0.0, 0.0, 0.0, 0.0]
    assert part_faults(changed, "motion") == []


def test_an_unknown_law_is_a_fault() -> None:
    assert [f.path for f in faults(edited(LIFT, "motion.segments[1].law", "wobble"))] == ["motion.segments[1].law"]


# -- stroke -----------------------------------------------------------------------------------------------


def test_stroke_is_highest_minus_lowest() -> None:
    assert stroke(MOTION) == 150.0
    up_and_down = Motion(5.0, (Segment(120.0, 30.0), Segment(120.0, -50.0), Segment(120.0, 20.0)))
    assert stroke(up_and_down) == 50.0


def test_start_and_rises_grow_with_the_stroke() -> None:
    changed = with_stroke(MOTION, 160.0)
    assert (changed.start, rises(changed)) == (160.0, [0.0, -160.0, 0.0, 160.0, 0.0])
    assert edited(LIFT, "motion.stroke_mm", 160.0).drive.motion == changed


def test_without_a_stroke_there_is_nothing_to_scale() -> None:
    flat = Motion(7.0, (Segment(360.0, 0.0),))
    assert with_stroke(flat, 10.0) == flat


@given(strategies.motions(), st.floats(1e-3, 1e4))
def test_stroke_becomes_what_is_wanted(motion: Motion, wanted: float) -> None:
    assume(stroke(motion) > 1.0)
    changed = with_stroke(motion, wanted)
    height = max(abs(changed.start), wanted)  # the levels it is the difference of
    assert stroke(changed) == pytest.approx(wanted, abs=64 * EPS * height)


# -- segments come and go ---------------------------------------------------------------------------------


def test_inserted_segment_is_a_dwell_of_half_the_span() -> None:
    changed = with_segment_inserted(MOTION, 2)
    assert spans(changed) == [35.0, 41.5, 103.5, 103.5, 41.5, 35.0]
    assert laws(changed) == ["dwell", "modified-sine", "dwell", "dwell", "modified-sine", "dwell"]
    assert rises(changed) == [0.0, -150.0, 0.0, 0.0, 150.0, 0.0]


def test_removed_segment_leaves_its_span_to_the_one_before() -> None:
    changed = without_segment(MOTION, 2)
    assert spans(changed) == [35.0, 248.5, 41.5, 35.0]
    assert rises(changed) == [0.0, -150.0, 150.0, 0.0]


def test_first_segment_leaves_its_span_to_the_second() -> None:
    assert spans(without_segment(MOTION, 0)) == [76.5, 207.0, 41.5, 35.0]


def test_removed_rise_is_given_back() -> None:
    assert rises(without_segment(MOTION, 1)) == [0.0, 0.0, 0.0, 0.0]
    three = Motion(0.0, tuple(Segment(120.0, r, NamedCurve("cycloidal")) for r in (10.0, 20.0, -30.0)))
    assert rises(without_segment(three, 1)) == [10.0, -10.0]
    assert rises(without_segment(three, 2)) == [-20.0, 20.0]


def test_the_only_segment_stays() -> None:
    alone = Motion(0.0, (Segment(360.0, 0.0),))
    assert without_segment(alone, 0) is alone
    design = with_drive(LIFT, motion=alone)
    assert remove_segment(design, 0) is design


@given(st.data())
def test_other_joins_stay_where_they_are(data: st.DataObject) -> None:
    motion = data.draw(strategies.motions())
    index = data.draw(indices(motion))
    grown = with_segment_inserted(motion, index)
    assert math.fsum(spans(grown)) == pytest.approx(360.0, abs=1e-9)
    assert [pytest.approx(a, abs=1e-9) for a in joins(motion)] == [a for i, a in enumerate(joins(grown)) if i != index]
    assert part_faults(grown, "motion") == []
    if len(motion.segments) > 1:
        shrunk = without_segment(motion, index)
        lost = max(index - 1, 0)
        assert joins(shrunk) == [pytest.approx(a, abs=1e-8) for i, a in enumerate(joins(motion)) if i != lost]
        assert math.fsum(spans(shrunk)) == pytest.approx(360.0, abs=1e-9)


@given(st.data())
def test_inserted_and_removed_is_as_before(data: st.DataObject) -> None:
    motion = data.draw(strategies.motions())
    index = data.draw(indices(motion))
    back = without_segment(with_segment_inserted(motion, index), index + 1)
    assert spans(back) == pytest.approx(spans(motion), abs=1e-9)
    assert rises(back) == rises(motion)


def test_what_is_assumed_keeps_its_segment() -> None:
    guessed = with_assumed(with_assumed(PICKER, "motion.segments[1].law", True), "motion.segments[2].law", True)
    assert guessed.assumed[:3] == ("motion.segments[1].law", "motion.segments[2].law", "cam.roller_radius_mm")
    grown = insert_segment(guessed, 0)
    assert grown.assumed[:3] == ("motion.segments[2].law", "motion.segments[3].law", "cam.roller_radius_mm")
    assert get(grown, "motion.segments[3].law") == get(guessed, "motion.segments[2].law")
    shrunk = remove_segment(guessed, 1)
    assert shrunk.assumed[:2] == ("motion.segments[1].law", "cam.roller_radius_mm")
    assert remove_segment(grown, 1) == guessed


# -- layout, assumption, plain values ---------------------------------------------------------------------


def test_the_pivot_changes_sides_with_the_layout() -> None:
    follower = LIFT.drive.mechanism
    for letter in "abcdefgh":
        changed = with_layout(follower, letter)  # type: ignore[arg-type]
        assert abs(changed.pivot_x_mm) == 873.746
        assert part_faults(changed, "follower") == []
    assert edited(LIFT, "follower.layout", "c").drive.mechanism == with_layout(follower, "c")  # type: ignore[arg-type]


def test_assumed_paths_stand_in_the_order_of_the_file() -> None:
    more = with_assumed(LIFT, "follower.rod_mm", True)
    assert more.assumed == ("follower.rod_mm", *LIFT.assumed)
    law = with_assumed(more, "motion.segments[1].law", True)
    assert law.assumed[:2] == ("motion.segments[1].law", "follower.rod_mm")
    assert with_assumed(with_assumed(law, "follower.rod_mm", False), "motion.segments[1].law", False) == LIFT
    assert with_assumed(more, "follower.rod_mm", True) == more


@pytest.mark.parametrize("path", LIFT.assumed)
def test_assumed_and_not_is_as_before(path: str) -> None:
    without = with_assumed(LIFT, path, False)
    assert without.assumed == tuple(p for p in LIFT.assumed if p != path)
    assert sorted(with_assumed(without, path, True).assumed) == sorted(LIFT.assumed)


def test_every_other_path_is_simply_put() -> None:
    changed = edited(LIFT, "follower.rod_mm", 900.0)
    assert get(changed, "follower.rod_mm") == 900.0
    assert edited(changed, "follower.rod_mm", 845.0) == LIFT
    with pytest.raises(KeyError, match="no such entry"):
        edited(LIFT, "follower.rod", 900.0)


# -- an entry alone --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "missing"),
    [
        ("transfer_lift", ["cam.second.roller_radius_mm", "follower.second"]),
        ("card_picker", ["cam.second.roller_radius_mm", "follower.second"]),
        ("rocker_cam", ["cam.second.roller_radius_mm", "follower.second"]),
        ("four_bar_coupler_cam", ["cam.second.link", "cam.second.roller_radius_mm"]),
    ],
)
def test_a_conjugate_pair_without_its_second_roller_is_a_fault(name: str, missing: list[str]) -> None:
    design = put(load(EXAMPLES / f"{name}.toml"), "cam.form", "conjugate")
    assert [fault.path for fault in faults(design)] == missing
