"""Flywheel, motor torque and speed of many random shafts, against the study of each."""

from __future__ import annotations

import math

import numpy as np
import pytest
from face_cases import CASES, random_design
from mechanisms import with_shaft
from sampled import spread

from core.design import Design, get, put
from core.errors import NoSolution
from core.study import Study, extremes_of, many

OF_MOTOR = {"motor_torque": "motor_torque_nm", "camshaft_speed": "speed_rpm"}
KEYS = (
    "energy_j",
    "flywheel_inertia_kg_m2",
    *(f"{column}:{of}" for column in OF_MOTOR.values() for of in ("min", "max", "abs", "range", "mean", "rms")),
)
WITH_SHAFT = [case for case in CASES if case[0] != "linkage"]
COUNT = 4
NEAR = 1e-9


def random_shaft(rng: np.random.Generator) -> tuple[Design, dict[str, np.ndarray]]:
    """A design with flywheel and motor, some without either, some that stall or jam, and numbers of four designs like it."""
    design = random_design(rng, *WITH_SHAFT[int(rng.integers(len(WITH_SHAFT)))])
    try:
        wheel = Study(design).flywheel
        inertia, peak = wheel.estimated_inertia, float(np.abs(wheel.torque(Study(design, 72).angles)).max())
    except NoSolution:  # it jams
        inertia, peak = 1.0, 1.0
    slope = peak / Study(design).omega * 10.0 ** rng.uniform(-3.0, 1.5)
    fluctuation, wheel_share = 10.0 ** rng.uniform(-2.0, -0.5), 10.0 ** rng.uniform(-2.0, 0.5)
    given = {"motor_slope_nm_s_per_rad": slope, "speed_fluctuation": fluctuation}
    if rng.random() < 0.8:
        given["flywheel_inertia_kg_m2"] = inertia * wheel_share
    if rng.random() < 0.3:
        given |= {"motor_inertia_kg_m2": inertia * 0.02, "gear_ratio": 3.0}
    design = with_shaft(design, **given)
    paths = ["cam.base_radius_mm", "shaft.speed_rpm", *(f"shaft.{name}" for name in given)]
    values = {path: get(design, path) * rng.uniform(0.97, 1.03, COUNT) for path in paths}
    if "shaft.flywheel_inertia_kg_m2" in values:
        values["shaft.flywheel_inertia_kg_m2"][-1] *= 1e-3  # mostly too small
    return design, values


@np.errstate(invalid="ignore", over="ignore")
def assert_shafts_are_those_of_their_studies(design: Design, values: dict[str, np.ndarray]) -> None:
    found = many(design, values, KEYS)
    turned = many(design, {path: row[::-1] for path, row in values.items()}, KEYS)
    assert all(turned.value[key][::-1].tobytes() == found.value[key].tobytes() for key in KEYS)
    for k in range(COUNT):
        one = design
        for path, row in values.items():
            one = put(one, path, float(row[k]))
        study = Study(one)
        of = {key: float(found.value[key][k]) for key in KEYS}
        if study.jam is not None:
            assert np.isnan(list(of.values())).all()
            assert found.reason[k].endswith("jamming")
            continue
        wheel = study.flywheel
        assert of["energy_j"] == pytest.approx(wheel.energy_swing, rel=NEAR)
        # where the motor nearly suffices the fluctuation hardly depends on the flywheel
        near = NEAR * max(wheel.needed_inertia, wheel.estimated_inertia)
        assert of["flywheel_inertia_kg_m2"] == pytest.approx(wheel.needed_inertia, rel=NEAR, abs=near), k
        if not wheel.runs:
            assert np.isnan([of[key] for key in KEYS[2:]]).all()
            assert found.reason[k] == "no-value"
            continue
        assert found.reason[k] in ("", "undercut")
        ends = extremes_of(study, "dynamics", tuple(OF_MOTOR))
        for name, column in OF_MOTOR.items():
            factor = 30.0 / math.pi if name == "camshaft_speed" else 1.0
            low, high = ends[name].low.value * factor, ends[name].high.value * factor
            size = max(abs(low), abs(high))
            assert of[f"{column}:min"] == pytest.approx(low, abs=NEAR * size), k
            assert of[f"{column}:max"] == pytest.approx(high, abs=NEAR * size), k
            assert of[f"{column}:abs"] == pytest.approx(size, abs=NEAR * size), k
            assert of[f"{column}:range"] == pytest.approx(high - low, abs=2.0 * NEAR * size), k
            assert (
                low - NEAR * size <= of[f"{column}:mean"] <= of[f"{column}:rms"] + NEAR * size <= size * (1 + 2 * NEAR)
            )
        at = study.at_theta(np.deg2rad([found.angle_deg["motor_torque_nm:max"][k]]))
        torque = wheel.motor_torque(at.angles) if study.levels_torque else at.shaft_torque
        assert float(torque[0]) == pytest.approx(of["motor_torque_nm:max"], rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("seed", spread(range(200), 3))
def test_flywheel_and_motor_are_those_of_each_study(seed: int) -> None:
    assert_shafts_are_those_of_their_studies(*random_shaft(np.random.default_rng([seed, 50])))
