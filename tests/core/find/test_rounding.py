"""Rounded results of ``find`` and ``optimise``: multiples of a step with which every limit holds, judged again."""

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

from core.__main__ import main
from core.design import edited, get
from core.find import rounded_values
from core.process import resources
from core.project import load, save
from core.study import Study, extremes_of, findings_of

EXAMPLES, STUDIES = resources() / "examples", resources() / "studies"
LIFT = EXAMPLES / "transfer_lift.toml"
BASE = "cam.base_radius_mm"


def result(capsys: pytest.CaptureFixture[str], *words: Any, code: int = 0) -> dict[str, Any]:
    assert main([*map(str, words), "--json"]) == code
    return json.loads(capsys.readouterr().out)


def is_multiple(value: float, step: float) -> bool:
    return math.isclose(value / step, round(value / step), abs_tol=1e-9)


def convex_radius(base: float) -> float:
    design = edited(load(LIFT), BASE, base)
    return 1e3 / extremes_of(Study(design), "cam", ("profile_curvature",))["profile_curvature"].high.value


def test_the_smallest_cam_is_rounded_to_the_side_on_which_its_limit_holds(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Half the roller's radius, 75 mm, limits the convex radius: 326.92 mm is not enough at 326.9, and at 327.0 it is."""
    into = tmp_path / "taken.toml"
    exact = result(capsys, "find", LIFT, "base-radius")
    told = result(capsys, "find", LIFT, "base-radius", "--round", "--into", into)
    assert told["exact"] == exact["answer"]
    assert told["answer"] == {BASE: 327.0}
    assert told["rounding"] == {BASE: 0.1}
    assert convex_radius(326.9) < 75.0 < convex_radius(327.0) == pytest.approx(told["reached"]["convex_radius_mm"])
    assert told["cost"]["convex_radius_mm"] == [
        exact["reached"]["convex_radius_mm"],
        told["reached"]["convex_radius_mm"],
    ]
    torque = [
        max(abs(end.value) for end in (ends.low, ends.high))
        for radius in (exact["answer"][BASE], 327.0)
        for ends in [
            extremes_of(Study(edited(load(LIFT), BASE, radius)), "dynamics", ("drive_torque",))["drive_torque"]
        ]
    ]
    assert told["cost"]["drive_torque_nm"] == pytest.approx(torque)
    assert main(["find", str(LIFT), "base-radius", "--round"]) == 0
    ends = extremes_of(Study(load(LIFT)), "dynamics", ("drive_torque",))["drive_torque"]
    now = max(abs(ends.low.value), abs(ends.high.value))
    assert f"  drive_torque_nm = {torque[1]:.4g}, now {now:.4g}\n" in capsys.readouterr().out
    taken = load(into)
    assert get(taken, BASE) == 327.0
    assert get(taken, "shaft.flywheel_inertia_kg_m2") == told["taken"]["shaft.flywheel_inertia_kg_m2"] == 35200.0
    assert [f.code for f in findings_of(Study(taken)) if f.severity == "error"] == []
    assert not {"exact", "rounding", "cost"} & set(exact), "without --round as before"


@pytest.mark.parametrize(
    ("room", "step"), [(0.2, 0.1), (0.08, 0.1), (0.07, 0.01), (0.0008, 0.001), (0.00068, 0.001), (0.00009, 0.0001)]
)
@pytest.mark.stress
def test_a_tenth_of_the_step_serves_where_none_of_its_multiples_is_within_the_limits(
    room: float, step: float, capsys: pytest.CaptureFixture[str]
) -> None:
    """Between 326.9234156 mm and an upper bound: 327.0 is 0.0766 mm above it, 326.93 0.0066 mm, 326.924 0.0006 mm."""
    least = result(capsys, "find", LIFT, "base-radius")["answer"][BASE]
    told = result(capsys, "find", LIFT, "base-radius", "--limit", f"{BASE}_max={least + room}", "--round")
    assert told["rounding"] == {BASE: step}
    assert is_multiple(told["answer"][BASE], step)
    assert least <= told["answer"][BASE] <= least + room
    assert told["besides"] == []


def test_where_no_step_serves_the_exact_value_is_used_with_a_note(capsys: pytest.CaptureFixture[str]) -> None:
    least = result(capsys, "find", LIFT, "base-radius")["answer"][BASE]
    told = result(capsys, "find", LIFT, "base-radius", "--limit", f"{BASE}_max={least + 1e-6}", "--round")
    assert told["answer"] == told["exact"]
    assert told["rounding"] == {}
    assert told["besides"] == ["no rounded values satisfy every limit, so that the exact ones are used"]


@pytest.mark.parametrize(
    ("words", "step"),
    [
        (("transfer_lift", "base-radius", "--round", "5"), 5.0),
        (("transfer_lift", "lift-off-speed", "--round"), 0.1),
        (("transfer_lift", "span", "--round"), 0.1),
        pytest.param(("transfer_lift", "pivot", "--round", "0.5"), 0.5, marks=pytest.mark.stress),
        (("rocker_cam", "spring", "--round"), 0.01),
        (("transfer_unit", "phases", "--round"), 0.1),
        (("transfer_unit", "flywheel", "--round"), 10.0),
        pytest.param(("transfer_unit", "balancer", "--round"), 1.0, marks=pytest.mark.stress),
    ],
)
def test_every_search_rounds_all_its_numbers_and_keeps_its_limits(
    words: Sequence[str], step: float, capsys: pytest.CaptureFixture[str]
) -> None:
    name, *rest = words
    told = result(capsys, "find", EXAMPLES / f"{name}.toml", *rest)
    assert set(told["rounding"].values()) == {step}
    for path, exact in told["exact"].items():
        assert is_multiple(told["answer"][path], step)
        assert abs(told["answer"][path] - exact) < step
    upper = ("pressure_angle", "shaft.speed_fluctuation")
    for key, limit in told["limits"].items():
        side = -1.0 if key.startswith(upper) else 1.0
        assert side * told["reached"][key] >= side * limit - 1e-9 * abs(limit), key


def test_the_best_design_has_numbers_that_can_be_made_and_says_what_they_cost(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    into = tmp_path / "best.toml"
    told = result(capsys, "optimise", STUDIES / "lift_smallest_cam.toml", "--round", "--into", into)
    assert set(told["rounding"].values()) == {0.1}
    for path, value in told["answer"].items():
        assert is_multiple(value, 0.1)
        assert get(load(into), path) == value
    assert told["cost"]["radius_mm:max"][1] == told["goal"] > told["cost"]["radius_mm:max"][0]
    assert told["cost"]["pressure_angle_deg:max"][1] <= 30.0
    assert told["cost"]["profile_curvature_per_mm:max"][1] <= 1.0 / 75.0
    ends = extremes_of(Study(load(into)), "cam", ("radius",))["radius"]
    assert told["goal"] == pytest.approx(1e3 * ends.high.value, rel=1e-9)


@pytest.mark.parametrize("step", ["0", "-1", "nan", "tenth"])
def test_a_step_that_is_none_is_refused_in_one_line(step: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["find", str(LIFT), "base-radius", f"--round={step}"]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "allowed: above 0" in told


def test_all_combinations_are_tried_from_the_nearest_on() -> None:
    """Two numbers of which the sum must not fall, and none may rise alone."""
    tried: list[tuple[float, ...]] = []

    def judged(values: Mapping[str, float]) -> bool | None:
        tried.append(tuple(values.values()))
        return True if tried[-1] == (2.0, 4.0) else None

    found = rounded_values({"a": 1.2, "b": 3.4}, judged, 1.0)
    assert found is not None
    assert tried == [(1.0, 3.0), (1.0, 4.0), (2.0, 3.0), (2.0, 4.0)]
    assert found.values == {"a": 2.0, "b": 4.0}


def test_the_flywheel_that_a_result_needs_is_rounded_up(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A result that needs a flywheel writes it with three digits, on the side of more."""
    save(load(LIFT), tmp_path / "lift.toml")
    exact = result(capsys, "find", tmp_path / "lift.toml", "base-radius")["taken"]["shaft.flywheel_inertia_kg_m2"]
    taken = result(capsys, "find", tmp_path / "lift.toml", "base-radius", "--round")["taken"]
    assert exact < taken["shaft.flywheel_inertia_kg_m2"] < 1.005 * exact


def test_a_step_above_a_size_does_not_round_it_to_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    for name, step in (("kim_1990", "2000"), ("transfer_lift", "1000000")):
        found = result(capsys, "find", EXAMPLES / f"{name}.toml", "lift-off-speed", "--round", step)
        assert found["answer"]["shaft.speed_rpm"] > 0.0


@pytest.mark.stress
def test_a_position_may_be_rounded_to_0_where_its_field_allows_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["find", str(LIFT), "pivot", "--round", "500"]) == 0
    assert "follower.pivot_y_mm = 0\n" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (
            ("kim_1990", "lift-off-speed", "--round", "2000"),
            "(no multiple of 2000 satisfies every limit, so that it is one of 200)",
        ),
        (("kim_1990", "lift-off-speed", "--round", "200"), ""),
        (
            ("transfer_lift", "base-radius", "--limit", f"{BASE}_max=326.95", "--round"),
            "(no multiple of 0.1 satisfies every limit, so that it is one of 0.01)",
        ),
        (("transfer_lift", "base-radius", "--round"), ""),
    ],
)
def test_the_text_names_a_step_that_is_finer_than_requested(
    words: Sequence[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    name, *rest = words
    assert main(["find", str(EXAMPLES / f"{name}.toml"), *rest]) == 0
    text = capsys.readouterr().out
    assert told in text
    assert ("no multiple" in text) == bool(told)
