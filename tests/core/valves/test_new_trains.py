"""Valve trains from a cam card: printed cards in their three forms, the design of a card, and the card of a design."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from core.design import Design, Motion, Segment, edited, faults
from core.design.engine import LobeClosing, LobeRow
from core.errors import DesignError, KindynaError
from core.findings import ERROR
from core.project import dumps, load, loads
from core.study import Study, findings_of
from core.valves import valve_data, valve_pairs, valve_timings
from core.valves.cam_card import (
    DURATIONS,
    TRAINS,
    VALVE_VALUES,
    TrainCard,
    ValveCard,
    card_centres,
    card_events,
    duration_and_centre,
    separation_and_advance,
)
from core.valves.new_trains import card_of, followed, new_train, with_card

EXAMPLE = Path(__file__).parents[3] / "resources" / "examples" / "valve_train.toml"


def card(train: str = "direct", of: str = "lobe", ratio: float | None = None, **both: Any) -> TrainCard:
    valve = ValveCard(**both)
    return TrainCard(train=train, of=of, ratio=ratio, inlet=valve, exhaust=valve)


@pytest.mark.parametrize(
    ("near", "far", "duration", "centre"), [(23.0, 67.0, 270.0, 112.0), (32.0, 65.0, 277.0, 106.5)]
)
def test_printed_events_are_duration_and_centre(near: float, far: float, duration: float, centre: float) -> None:
    """Piper 23/67 is 270° at 112°; 277° at 106.5° is 32/65; the exhaust 67/23 is their mirror image."""
    assert duration_and_centre(near, far) == (duration, centre)
    assert card_events(duration, centre) == (near, far)
    lift = {"second_deg": duration, "first_deg": duration + 50.0, "centre_deg": centre, "lift_mm": 11.0}
    inlet, exhaust = valve_data(valve_timings(new_train(card(**lift))), (1.27,))["valves"]
    event = inlet["events"][0]
    assert (event["opens_deg"], event["closes_deg"]) == pytest.approx((-near, 180.0 + far), abs=1e-9)
    event = exhaust["events"][0]
    assert (event["opens_deg"], event["closes_deg"]) == pytest.approx((-180.0 - far, near), abs=1e-9)


def test_a_printed_separation_and_advance_are_centres() -> None:
    """A separation of 102° advanced by 4° is 98° and 106°."""
    assert card_centres(102.0, 4.0) == (98.0, 106.0)
    assert separation_and_advance(98.0, 106.0) == (102.0, 4.0)
    (pair,) = valve_pairs(valve_timings(new_train(card().with_centres(102.0, 4.0))))
    assert (pair.inlet.centre, pair.exhaust.centre) == (98.0, -106.0)
    assert (pair.separation, pair.advance) == (102.0, 4.0)


def test_an_event_changes_duration_and_centre_and_keeps_the_other_event() -> None:
    valve = VALVE_VALUES["second_near_tdc"].write(ValveCard(first_deg=290.0, second_deg=250.0, centre_deg=110.0), 23.0)
    assert valve.events("second") == (23.0, 55.0)
    assert (valve.second_deg, valve.centre_deg, valve.first_deg) == (258.0, 106.0, 290.0)
    assert valve.events("first") == (39.0, 71.0)
    valve = VALVE_VALUES["second_near_bdc"].write(valve, 67.0)
    assert valve.events("second") == (23.0, 67.0)


def test_the_overlap_of_the_card_is_that_of_the_lobes() -> None:
    made = card().with_centres(104.0, 2.0)
    rows = valve_data(valve_timings(new_train(made)), (0.1524, 1.27))["pairs"][0]["overlap"]
    lobes = {row["at_mm"]: row["deg"] for row in rows if row["of"] == "lobe"}
    assert made.overlap_deg("first") == pytest.approx(lobes[0.1524], abs=1e-9)
    assert made.overlap_deg("second") == pytest.approx(lobes[1.27], abs=1e-9)


def test_lifts_of_the_valve_have_the_lash_taken_off() -> None:
    """A duration at 1 mm of the valve is one at 1.2 mm of the lobe of a direct valve with a lash of 0.2 mm."""
    made = card(
        of="valve", lift_mm=8.8, lash_mm=0.2, first_at_mm=0.1, first_deg=256.0, second_at_mm=1.0, second_deg=214.0
    )
    inlet = valve_timings(new_train(made))[0]
    event = inlet.event("valve", 1.0)
    assert event is not None
    assert event.duration_deg == pytest.approx(214.0, abs=1e-9)
    assert (inlet.greatest_valve_lift, inlet.greatest_lobe_lift) == pytest.approx((8.8, 9.0), abs=1e-12)


@pytest.mark.parametrize("lash", [0.0, 0.05, 0.1, 0.2, 0.25, 0.3])
def test_the_lash_proposes_a_ramp_on_which_the_valve_seats(lash: float) -> None:
    inlet = valve_timings(new_train(card(lash_mm=lash)))[0]
    lobe = inlet.motion.lobe
    assert lobe is not None
    assert lobe.ramp_mm > lash
    assert lobe.ramp_mm == (0.1 if lash < 0.08 else pytest.approx(lash + 0.02, abs=1e-12))
    if lash:
        opening, seating = inlet.velocities_at_lash or (math.nan, math.nan)
        assert (opening, seating) == pytest.approx((lobe.ramp_mm_per_deg * 6.0 * 1000.0,) * 2, rel=1e-9)


def test_a_typed_ramp_is_kept() -> None:
    lobe = valve_timings(new_train(card(lash_mm=0.1, ramp_mm=0.15)))[0].motion.lobe
    assert lobe is not None
    assert (lobe.ramp_mm, lobe.ramp_mm_per_deg) == (0.15, 0.01)


@pytest.mark.parametrize("train", TRAINS)
def test_every_kind_of_valve_train_is_a_design_without_errors(train: str) -> None:
    made = card(train, of="valve").with_centres(108.0, 2.0)
    design = new_train(made)
    assert [drive.name for drive in design.drives] == ["Inlet", "Exhaust"]
    assert faults(design) == []
    study = Study(design)
    assert [finding for finding in findings_of(study) if finding.severity == ERROR] == []
    (inlet, _) = valve_data(valve_timings(design), (1.0,))["valves"]
    assert inlet["springs"][0]["rate_n_per_mm"] == pytest.approx(29.9029378, abs=1e-7)
    assert inlet["springs"][0]["bind_mm"] > 0.0
    assert inlet["float_rpm"] > 3000.0
    assert inlet["clearance"]["least_mm"] > 0.0
    again = loads(dumps(design))
    assert again == design
    read = card_of(again)
    assert with_card(design, read) == design
    assert (read.inlet.second_deg, read.exhaust.centre_deg) == (218.0, 110.0)


@pytest.mark.parametrize("train", [word for word, row in TRAINS.items() if row.arm])
def test_the_rocker_ratio_sets_the_arm_of_the_pad(train: str) -> None:
    lobe, valve = (new_train(card(train, of, 1.6)).drives[0] for of in ("lobe", "valve"))
    for drive in (lobe, valve):
        follower: Any = drive.follower
        assert follower.pad_mm == pytest.approx(1.6 * getattr(follower, TRAINS[train].arm), abs=1e-6)
    assert lobe.motion is not None and lobe.motion.lobe is not None  # noqa: PT018
    assert valve.motion is not None and valve.motion.lobe is not None  # noqa: PT018
    assert lobe.motion.lobe.lift_mm / valve.motion.lobe.lift_mm == pytest.approx(1.6, rel=1e-12)


def test_the_card_of_a_design_is_the_card_that_made_it() -> None:
    valve = ValveCard(lift_mm=10.5, lash_mm=0.2, first_deg=276.0, second_deg=230.0, centre_deg=104.5)
    made = TrainCard(inlet=valve, exhaust=replace(valve, lash_mm=0.25, centre_deg=111.5, second_deg=233.0))
    assert card_of(loads(dumps(new_train(made)))) == made


def test_a_lash_above_a_typed_lift_is_read_as_a_card_of_lobes() -> None:
    """The example's exhaust has a lash of 0.18 mm and a duration at 0.15 mm, where its valve is still closed."""
    design = load(EXAMPLE)
    read = card_of(design)
    assert (read.of, read.exhaust.lash_mm) == ("lobe", 0.18)
    assert read.exhaust.first_at_mm == pytest.approx(0.15 / read.rocker_ratio, abs=1e-12)
    assert with_card(design, read) == design


def test_a_card_changes_lobes_centres_and_lash_and_nothing_else() -> None:
    design = edited(edited(new_train(card()), "drives[0].cam.base_radius_mm", 21.0), "engine.stroke_mm", 90.0)
    changed = with_card(design, card_of(design).with_centres(110.0, 0.0))
    assert changed == edited(edited(design, "drives[0].valve.centre_deg", 110.0), "drives[1].valve.centre_deg", -110.0)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"second_deg": 262.0}, "168.577 ... 246.428 deg"),
        ({"second_deg": 270.0}, "not less than at 0.1524 mm"),
        ({"lift_mm": 1.0}, "at or above the lift"),
        ({"second_deg": -1.0}, "inlet.second_deg = -1"),
        ({"centre_deg": 0.0}, "inlet.centre_deg = 0"),
        ({"lash_mm": 9.5, "ramp_mm": 0.1}, "the valve stays closed"),
    ],
)
def test_a_card_without_a_lobe_is_refused(values: dict[str, float], words: str) -> None:
    with pytest.raises(DesignError) as raised:
        new_train(card(**values))
    assert words in str(raised.value)


def test_durations_that_contradict_each_other_are_said_in_the_lifts_of_the_card() -> None:
    """The motion of the finger is the valve's, twice as high as the lobe of the card."""
    with pytest.raises(DesignError) as raised:
        new_train(card("finger", ratio=2.0, lift_mm=5.0, first_at_mm=0.08, second_at_mm=0.6, second_deg=270.0))
    (first, second) = raised.value.faults
    assert (first.path, second.path) == ("inlet.second_deg", "exhaust.second_deg")
    assert (first.value, first.problem, first.allowed) == (270.0, "not less than at 0.08 mm", "< 268 deg")


def test_a_design_without_a_pair_of_valves_has_no_card() -> None:
    design = new_train(card())
    with pytest.raises(KindynaError, match="no inlet and exhaust valve"):
        card_of(replace(design, drives=design.drives[:1]))
    plain = Motion(start=0.0, unit="mm", segments=(Segment(360.0, 0.0),))
    with pytest.raises(KindynaError, match="a card needs lobes"):
        card_of(replace(design, drives=(replace(design.drives[0], motion=plain), design.drives[1])))


# -- lobes by other values, and with another closing side -------------------------------------------------------


def with_lobe(**values: Any) -> Design:
    """The new design with another lobe of the inlet."""
    design = new_train(card(lift_mm=9.0))
    motion = design.drives[0].motion
    assert motion is not None
    assert motion.lobe is not None
    lobe = replace(motion.lobe, **{"duration": (), **values})
    drive = replace(design.drives[0], motion=replace(motion, lobe=lobe))
    return replace(design, drives=(drive, design.drives[1]))


ROW, AT_1_27 = LobeRow(0.1524, 268.0), LobeRow(1.27, 210.0)
OTHERS = {
    "velocity": {"duration": (AT_1_27,), "velocity_mm_per_deg": 0.24},
    "low row": {"duration": (ROW,), "velocity_mm_per_deg": 0.22},
    "accelerations": {"acceleration_mm_per_deg2": 0.02, "nose_acceleration_mm_per_deg2": 0.0065},
    "to nose": {"to_nose": (LobeRow(0.1524, 134.0), LobeRow(1.27, 109.0))},
    "closing": {
        "duration": (LobeRow(0.15, 270.0), AT_1_27), "ramp_mm": 0.2, "ramp_runup_deg": 8.0,
        "closing": LobeClosing(ramp_mm=0.25, ramp_mm_per_deg=0.007, to_nose=(LobeRow(1.27, 108.0),)),
    },
}  # fmt: skip


@pytest.mark.parametrize("name", OTHERS)
def test_any_lobe_opens_in_a_card_which_keeps_it(name: str) -> None:
    design = with_lobe(**OTHERS[name])
    read = card_of(design)
    assert with_card(design, read) == design
    changed = with_card(design, read.with_centres(110.0, 0.0))
    assert changed.drives[0].motion == design.drives[0].motion
    (timing, _) = valve_timings(design)
    for row in ("first", "second"):
        event = timing.event("lobe", getattr(read.inlet, f"{row}_at_mm"))
        assert event is not None
        assert read.inlet.duration(row) == pytest.approx(event.duration_deg, abs=1e-8)
        near, far = read.inlet.events(row)
        assert (-near, far + 180.0) == pytest.approx((event.opens_deg, event.closes_deg), abs=1e-8)
    figures = valve_data([timing], ())["valves"][0]
    assert read.inlet.velocity_mm_per_deg == pytest.approx(max(figures["velocity_mm_per_deg"]), rel=1e-2)
    assert read.inlet.is_fixed == (name in ("to nose", "closing"))


def test_an_exhaust_with_another_closing_side_has_its_events() -> None:
    design = with_lobe(**OTHERS["closing"])
    drives = design.drives
    swapped = replace(design, drives=(drives[1], replace(drives[0], valve=drives[1].valve, name="Out")))
    swapped = replace(swapped, drives=(replace(drives[1], valve=drives[0].valve), swapped.drives[1]))
    read = card_of(swapped)
    event = valve_timings(swapped)[1].event("lobe", read.exhaust.second_at_mm)
    assert event is not None
    near, far = read.exhaust.events("second")
    assert (near, -far - 180.0) == pytest.approx((event.closes_deg, event.opens_deg), abs=1e-8)


def test_the_last_two_typed_values_drive_and_the_others_follow() -> None:
    """A greatest velocity, typed after both durations, takes the place of the first of them, which follows."""
    start = followed(card(lift_mm=9.0))
    assert start.inlet.velocity_mm_per_deg == pytest.approx(0.2098, abs=1e-3)
    typed = start.with_valve("inlet", start.inlet.driven("velocity_mm_per_deg", 0.213))
    assert typed.inlet.typed == ("second_deg", "velocity_mm_per_deg")
    after = followed(typed)
    assert (after.inlet.second_deg, after.inlet.velocity_mm_per_deg) == (218.0, 0.213)
    assert after.inlet.first_deg != 268.0
    lobe = new_train(after).drives[0].motion.lobe  # type: ignore[union-attr]
    assert lobe is not None
    assert [row.at_mm for row in lobe.duration] == [1.27]
    assert (lobe.velocity_mm_per_deg, lobe.acceleration_mm_per_deg2) == (0.213, None)
    back = followed(after.with_valve("inlet", after.inlet.driven("first_deg", 268.0)))
    assert back.inlet.typed == ("velocity_mm_per_deg", "first_deg")
    assert followed(back.with_valve("inlet", back.inlet.driven("velocity_mm_per_deg", None))).inlet.typed == DURATIONS


@pytest.mark.parametrize(
    ("train", "of", "motion_per_lift"),
    [("rocker", "lobe", 1.6), ("rocker", "valve", 1.0), ("pushrod", "lobe", 1.0), ("pushrod", "valve", 1.0 / 1.6)],
)
def test_velocity_and_accelerations_are_of_the_lobe_or_the_valve_as_the_lifts(
    train: str, of: str, motion_per_lift: float
) -> None:
    """The motion of a rocker is the valve's, that of a pushrod the tappet's; a ratio of 1.6 multiplies velocities as lifts."""
    start = followed(card(train, of, 1.6, lift_mm=8.0))

    def motion_velocity(train_card: TrainCard) -> float:
        timing = valve_timings(new_train(train_card))[0]
        return float(valve_data([timing], ())["valves"][0]["velocity_mm_per_deg"][1])

    velocity = start.inlet.velocity_mm_per_deg
    assert velocity is not None
    assert motion_velocity(start) == pytest.approx(motion_per_lift * velocity, rel=1e-6)
    faster = round(1.02 * velocity, 6)
    typed = start.with_valve("inlet", start.inlet.driven("velocity_mm_per_deg", faster))
    assert motion_velocity(typed) == pytest.approx(motion_per_lift * faster, rel=1e-6)
    for name in ("velocity_mm_per_deg", "acceleration_mm_per_deg2", "nose_acceleration_mm_per_deg2"):
        driven = start.inlet.driven(name, getattr(start.inlet, name))
        design = new_train(start.with_valve("inlet", driven))
        assert with_card(design, card_of(design)) == design
