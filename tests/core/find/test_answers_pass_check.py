"""An answer of ``find`` passes ``check``: written into a file, it is complained of nothing that its design is not, whatever is sought."""

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from face_cases import CASES, random_design
from mechanisms import with_cam
from sampled import spread, stressed

from core.__main__ import main
from core.design import Design, edited, get, only
from core.errors import KindynaError
from core.find import CAM_SEARCHES, SEARCHES, SHAFT_SEARCHES, available_searches, available_shaft_searches, find
from core.project import load
from core.study import Study, extremes_of, findings_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
SPEED = "shaft.speed_rpm"
RANDOM = 300


@cache
def example(name: str) -> Design:
    return load(EXAMPLES / f"{name}.toml")


def requests() -> Iterator[tuple[str, str, str]]:
    """Every example, each of its drives, and what is offered there."""
    for path in sorted(EXAMPLES.glob("*.toml")):
        whole = example(path.stem)
        names = [drive.name or "" for drive in whole.drives]
        yield from (
            (path.stem, name, what) for i, name in enumerate(names) for what in available_searches(only(whole, i))
        )
        yield from ((path.stem, "", what) for what in available_shaft_searches(whole))
    yield "transfer_unit", "", "balancer"


def parts(design: Design) -> tuple[type, ...]:
    """Follower or linkage, cam, face and form."""
    drive = design.drive
    holders = (drive.mechanism, drive.cam)
    return tuple(
        type(part)
        for part in (*holders, *(getattr(holder, name, None) for holder in holders for name in ("face", "form")))
    )


def cases() -> Iterator[Any]:
    """All requests; in every run each goal once, and one of each kind of follower, face and form; under stress each goal with
    each kind of these, and the first goal of each drive of several."""
    seen: set[tuple[Any, ...]] = set()
    for name, drive, what in requests():
        whole = example(name)
        several = len(whole.drives) > 1
        key = (name, drive or what) if several else (what, *parts(whole))
        first = {(what,)} if several else {(what,), parts(whole)}
        marks = [pytest.mark.fuzz] if key in seen else [] if first - seen else [pytest.mark.stress]
        yield pytest.param(name, drive, what, marks=marks)
        seen |= {key, *first}


def findings(design: Design) -> dict[tuple[str, str], str]:
    return {(each.code, each.field): f"{each.severity}: {each.message}" for each in findings_of(Study(design))}


def new(before: Design, after: Design) -> dict[tuple[str, str], str]:
    had = findings(before)
    return {key: text for key, text in findings(after).items() if key not in had}


def test_every_goal_is_sought_somewhere() -> None:
    sought = {what for _, _, what in requests()} | {"gear-ratio"}  # of a servo, which no example has: in test_servo
    assert sought == SEARCHES.keys() == {*CAM_SEARCHES, *SHAFT_SEARCHES}


@pytest.mark.parametrize(("name", "drive", "what"), spread(list(cases()), 4))
def test_an_answer_adds_nothing_to_what_check_finds(
    name: str, drive: str, what: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, into = EXAMPLES / f"{name}.toml", tmp_path / "answer.toml"
    code = main(["find", str(path), what, *(["--drive", drive] if drive else []), "--into", str(into)])
    said = capsys.readouterr()
    if name in REFUSED.get(what, {}):
        assert (code, into.exists()) == (2, False)
        assert REFUSED[what][name] in said.err
        return
    assert code == 0, said.err
    assert not new(load(path), load(into))
    assert "traceback" not in said.err.lower()


REFUSED = {
    "offset": {"tappet_flat": "does not depend on"},
    "lift-off-speed": {"cam_slider_linkage": "nothing presses the follower"},
}


@pytest.mark.parametrize("rpm", [stressed(1500.0), 1762.0, stressed(2293.0)])
@pytest.mark.parametrize("what", ["spring", "preload"])
def test_a_spring_for_more_speed_keeps_the_follower_at_that_speed(rpm: float, what: str) -> None:
    """By the force of 0, which rounding must not decide; and by the usual one, 2 % of the largest up to 1.1 times the speed."""
    fast = edited(load(EXAMPLES / "rocker_cam.toml"), SPEED, rpm)
    just = find(fast, what, {"loads.least_contact_force_n_min": 0.0, f"{SPEED}_max": rpm}).machine
    force = extremes_of(Study(just), "dynamics", ("contact_force",))["contact_force"]
    assert 1e-11 < force.low.value / force.high.value < 1e-9, "kept, by more than rounding"
    usual = find(fast, what, {})
    assert usual.is_valid
    assert usual.reasons["loads.least_contact_force_n"].startswith("2 % of the largest")
    assert usual.reasons["loads.least_contact_force_n"].endswith(f"up to {1.1 * rpm:.4g} rpm")
    for made in (just, usual.machine):
        assert "separation" not in [each.code for each in findings_of(Study(made), ("dynamics",))]
    faster = extremes_of(Study(edited(usual.machine, SPEED, 1.1 * rpm)), "dynamics", ("contact_force",))[
        "contact_force"
    ]
    assert faster.low.value == pytest.approx(0.02 * faster.high.value, rel=1e-6)
    assert faster.low.value >= 0.02 * faster.high.value * (1.0 - 1e-12)


@pytest.mark.parametrize(
    "name", spread(["rocker_cam", "rocker_flat", "tappet_knife", "transfer_lift", "four_bar_coupler_cam"], 2)
)
def test_the_speed_of_lift_off_is_a_fact_and_one_below_it_is_taken_over(name: str) -> None:
    design = load(EXAMPLES / f"{name}.toml")
    solution = find(design, "lift-off-speed", {})
    ((path, rpm),) = solution.answer.items()
    lost = findings_of(Study(edited(design, path, rpm * (1.0 + 1e-9))), ("dynamics",))
    assert "separation" in [each.code for each in lost]
    taken = get(solution.machine, path)
    assert rpm * (1.0 - 1e-9) <= taken < rpm
    assert dict(solution.applied) == {path: taken}
    assert not new(design, solution.machine)


# -- what check says of a cam that nobody would cut --------------------------------------------------------


def codes(design: Design) -> list[str]:
    return [each.code for each in findings_of(Study(design))]


def test_a_profile_sharper_than_half_its_roller_is_complained_of() -> None:
    """Under a roller of 12 mm less than 6, under what slides less than 3; a limit of one's own takes the place of that."""
    rocker, tappet = load(EXAMPLES / "transfer_lift.toml"), load(EXAMPLES / "tappet_flat.toml")
    for design, limit, base in ((rocker, 75.0, 300.0), (tappet, 3.0, 11.0)):
        assert "convex-radius" not in codes(design)
        small = with_cam(design, base_radius_mm=base)
        (found,) = [each for each in findings_of(Study(small)) if each.code == "convex-radius"]
        assert (found.severity, found.field, found.values["limit"]) == ("warning", "cam.base_radius_mm", limit)
        assert f"limit {limit:g} mm (" in found.message
        least = float(found.values["value"])
        assert least < limit
        assert "convex-radius" not in codes(edited(small, "limits.convex_radius_mm", 0.9 * least))
        (own,) = [
            each
            for each in findings_of(Study(edited(small, "limits.convex_radius_mm", 1.1 * least)))
            if each.code == "convex-radius"
        ]
        assert "your limit" in own.message
    undercut = codes(with_cam(tappet, base_radius_mm=8.0))
    assert "undercut" in undercut
    assert "convex-radius" not in undercut, "said once"


def test_a_base_circle_without_room_for_its_shaft_is_complained_of() -> None:
    """7.6 mm under a roller of 12: d³ = 16 T/(π 25 MPa), a hub of 1.8 d."""
    small = with_cam(load(EXAMPLES / "rocker_cam.toml"), base_radius_mm=7.6)
    (found,) = [each for each in findings_of(Study(small)) if each.code == "polar-radius"]
    torque = extremes_of(Study(small), "dynamics", ("drive_torque",))["drive_torque"]
    largest = max(abs(torque.low.value), abs(torque.high.value))
    shaft = 1e3 * (16.0 * largest / (np.pi * 25e6)) ** (1.0 / 3.0)
    assert (found.severity, found.field) == ("warning", "cam.base_radius_mm")
    assert found.values["limit"] == pytest.approx(0.9 * shaft, rel=1e-9)
    assert found.values["value"] == pytest.approx(7.6, rel=1e-9)
    assert "at 25 MPa (assumed)" in found.message
    assert "polar-radius" not in codes(with_cam(small, base_radius_mm=1.001 * 0.9 * shaft))
    assert "polar-radius" not in codes(with_cam(small, bore_mm=8.0)), (
        "the bore is the shaft: a quarter of it is left around it"
    )
    assert "polar-radius" in codes(with_cam(small, bore_mm=10.5))
    assert "polar-radius" in codes(with_cam(small, base_radius_mm=12.0, hub_mm=21.0)), "2 mm beside the hub"
    assert "polar-radius" not in codes(with_cam(small, base_radius_mm=12.6, hub_mm=21.0))
    assert "polar-radius" not in codes(edited(small, "limits.polar_radius_mm", 7.0))


# -- random designs ----------------------------------------------------------------------------------------


@pytest.mark.fuzz
@pytest.mark.parametrize("seed", range(RANDOM))
def test_answers_for_random_designs_add_nothing_either(seed: int) -> None:
    design = random_design(np.random.default_rng([seed, 26]), *CASES[seed % len(CASES)])
    goals = (*available_searches(design), *available_shaft_searches(design))
    for what in {goals[seed % len(goals)], goals[(seed // len(goals) + 3) % len(goals)]}:
        try:
            solution = find(design, what, {})
        except KindynaError:
            continue
        if solution.is_valid:
            added = new(design, solution.machine)
            assert not added or (solution.notes and all(text.startswith("note: ") for text in added.values())), what
