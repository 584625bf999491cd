"""Totals of many designs, and several drives on a shaft, against the study of each."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sampled import spread

from core.design import Design, get, put
from core.project import load
from core.study import Study, batch, extremes_of, many, roller_lives
from core.study.batch import is_batchable
from core.study.quantity_requests import quantity_request
from core.study.stages import clear_caches
from core.study.stages_of_many import DesignBlock
from core.varying import with_values

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
TOTALS = ("energy_j", "flywheel_inertia_kg_m2")


def example(name: str) -> Design:
    return load(EXAMPLES / f"{name}.toml")


def near(design: Design, paths: tuple[str, ...], count: int, seed: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    return {path: get(design, path) * rng.uniform(0.97, 1.03, count) for path in paths}


def one_of(design: Design, values: Mapping[str, np.ndarray], k: int) -> Design:
    return with_values(design, {path: float(row[k]) for path, row in values.items()})


@pytest.mark.parametrize(
    ("name", "paths"),
    spread(
        [
            ("dwell_rise_dwell", ("cam.base_radius_mm", "loads.friction", "motion.segments[1].span_deg")),
            ("transfer_lift", ("cam.base_radius_mm", "shaft.speed_rpm", "shaft.speed_fluctuation")),
            ("groove", ("cam.base_radius_mm", "shaft.speed_rpm")),
        ],
        1,
    ),
)
def test_energy_and_flywheel_are_those_of_each_study(name: str, paths: tuple[str, ...]) -> None:
    """Where friction turns round in the guide, and where spans differ, too."""
    design = example(name)
    if name == "dwell_rise_dwell":
        design = put(design, "loads.friction", 0.1)
    values = near(design, paths, 3, 4)
    assert all(is_batchable(design, paths, quantity_request(design, key)) for key in TOTALS)
    found = many(design, values, TOTALS)
    assert set(found.reason) == {""}
    for k in range(3):
        wheel = Study(one_of(design, values, k)).flywheel
        assert found.value["energy_j"][k] == pytest.approx(wheel.energy_swing, rel=1e-9)
        assert found.value["flywheel_inertia_kg_m2"][k] == pytest.approx(wheel.needed_inertia, rel=1e-8, abs=1e-12)
    turned = many(design, {path: row[::-1] for path, row in values.items()}, TOTALS)
    assert all(turned.value[key][::-1].tobytes() == found.value[key].tobytes() for key in TOTALS)


def test_the_life_of_rollers_is_that_of_each_study() -> None:
    design = put(example("dwell_rise_dwell"), "cam.roller_load_rating_n", 5000.0)
    paths = ("cam.base_radius_mm", "cam.roller_load_rating_n", "shaft.speed_rpm", "motion.segments[1].span_deg")
    values = near(design, paths, 3, 2)
    found = many(design, values, ["life_hours"])
    expected = [roller_lives(Study(one_of(design, values, k)))[0].hours for k in range(3)]
    assert found.value["life_hours"] == pytest.approx(expected, rel=1e-9)
    unrated = many(example("dwell_rise_dwell"), {"shaft.speed_rpm": [60.0]}, ["life_hours"])
    assert np.isnan(unrated.value["life_hours"][0])
    assert unrated.reason.tolist() == ["no-value"]


def test_a_design_without_forces_has_no_totals() -> None:
    design = example("dwell_rise_dwell")
    found = many(design, {"loads.friction": [0.0, 9.0], "follower.offset_mm": [0.0, 5.0]}, TOTALS)
    assert found.reason.tolist() == ["", "jamming"]
    assert np.isfinite(found.value["energy_j"]).tolist() == [True, False]


def test_drives_on_a_shaft_are_taken_at_once_and_summed() -> None:
    """Phases, spans and lengths of several drives and the speed of all."""
    design = example("transfer_unit")
    paths = (
        "drives[0].cam.base_radius_mm",
        "drives[1].phase_deg",
        "drives[2].motion.segments[1].span_deg",
        "shaft.speed_rpm",
    )
    values = near(design, paths, 3, 8)
    keys = [
        "torque_nm:max",
        "torque_nm:abs",
        "torque_nm:rms",
        "torque_nm:mean",
        "energy_j",
        "drives[0].pressure_angle_deg:max",
    ]
    assert all(is_batchable(design, paths, quantity_request(design, key)) for key in keys)
    with ThreadPoolExecutor(2) as threads:
        found = many(design, values, keys, executor=threads)
    for k in range(3):
        study = Study(one_of(design, values, k))
        shaft, first = study.camshaft, next(iter(study.drives.values()))
        angle = extremes_of(first, "cam", ("pressure_angle",))["pressure_angle"].high.value
        expected = [
            shaft.peaks.high.value, abs(shaft.peak_torque.value), shaft.rms_torque, shaft.mean_torque,
            shaft.flywheel.energy_swing, np.rad2deg(angle),
        ]  # fmt: skip
        assert [found.value[key][k] for key in keys] == pytest.approx(expected, rel=1e-8)
        assert found.angle_deg["torque_nm:abs"][k] == pytest.approx(np.rad2deg(shaft.peak_torque.theta), abs=1e-3)
    assert set(found.reason) == {""}


def test_drives_that_no_number_changes_are_solved_once_for_all_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    design, key, blocks = example("transfer_unit"), "torque_nm:abs", list[str]()
    values = near(design, ("drives[2].cam.base_radius_mm",), 6, 8)

    def counted(drive: Design, *numbers: Any) -> DesignBlock:
        blocks.append(drive.name)
        return DesignBlock(drive, *numbers)

    monkeypatch.setattr(batch, "DesignBlock", counted)
    clear_caches()
    together = many(design, values, [key]).value[key]
    assert len(blocks) == len(design.drives)
    blocks.clear()
    apart = [many(design, {path: row[k : k + 2] for path, row in values.items()}, [key]).value[key] for k in (0, 2, 4)]
    assert (np.concatenate(apart) == together).all()
    assert len(blocks) == len(apart), "of the drive that differs"


def test_a_drive_that_cannot_be_built_takes_the_sum_with_it_and_nothing_else() -> None:
    design = example("transfer_unit")
    found = many(
        design,
        {"drives[0].follower.arm_mm": [get(design, "drives[0].follower.arm_mm"), 1.0]},
        ["torque_nm:max", "drives[0].pressure_angle_deg:max", "drives[1].pressure_angle_deg:max"],
    )
    assert found.reason.tolist() == ["", "no-assembly"]
    assert [np.isfinite(row).tolist() for row in found.value.values()] == [[True, False], [True, False], [True, True]]
    with pytest.raises(ValueError, match=r"drives\[9\].pressure_angle_deg:max: allowed are torque_nm:max"):
        many(design, {"shaft.speed_rpm": [60.0]}, ["drives[9].pressure_angle_deg:max"])


def test_totals_of_a_shaft_need_one() -> None:
    with pytest.raises(ValueError, match=r"energy_j: this design has no \[shaft\]"):
        many(example("slider_crank"), {"linkage.driver.speed_rpm": [60.0]}, ["energy_j"])
