"""Derivatives of extremes, means and totals by numbers of the design, against refined differences and a closed form."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from sampled import spread

from core.design import Design, edited, get, put, row_at
from core.project import load
from core.study import Study, extremes_of, many, sensitivity

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"


def example(name: str) -> Design:
    return load(EXAMPLES / f"{name}.toml")


def asked_one_by_one(design: Design, quantity: str, of: str) -> float:
    """From the refined extremes of a study, in SI."""
    study = Study(design)
    stage = "cam" if quantity == "pressure_angle" else "motion" if quantity == "acceleration" else "dynamics"
    found = extremes_of(study, stage, (quantity,))[quantity]
    ends = {"max": found.high.value, "min": found.low.value, "range": found.high.value - found.low.value}
    return ends.get(of, max(abs(found.low.value), abs(found.high.value)))


def refined_difference(design: Design, path: str, quantity: str, of: str) -> float:
    """Of two step sizes, extrapolated."""
    kept = {row_at(path)[1]} if path.startswith("motion") else set()
    own, step = get(design, path), 2e-4 * abs(get(design, path))
    at = [asked_one_by_one(edited(design, path, own + k * step, kept), quantity, of) for k in (-2, -1, 1, 2)]
    return (8.0 * (at[2] - at[1]) - (at[3] - at[0])) / (12.0 * step)


@pytest.mark.parametrize(
    ("name", "paths"),
    spread(
        [
            ("transfer_lift", ("cam.base_radius_mm", "follower.pivot_x_mm", "shaft.speed_rpm", "loads.friction")),
            ("rocker_cam", ("follower.arm_mm", "cam.roller_radius_mm", "motion.segments[1].span_deg")),
            ("tappet_knife", ("cam.base_radius_mm", "motion.segments[1].span_deg", "motion.segments[1].rise_mm")),
        ],
        1,
    ),
)
def test_derivatives_are_those_of_refined_extremes(name: str, paths: tuple[str, ...]) -> None:
    """In the middle of pieces, and at their ends, which go with the spans."""
    design = example(name)
    if name == "transfer_lift":
        design = put(design, "loads.friction", 0.05)
    if name == "tappet_knife":  # else two segments reach the same acceleration
        design = edited(design, "motion.segments[1].span_deg", 0.97 * design.drive.motion.segments[1].span_deg)
    asked = {
        "pressure_angle_deg:max": ("pressure_angle", "max", np.pi / 180.0),
        "contact_force_n:min": ("contact_force", "min", 1.0),
        "contact_force_n:range": ("contact_force", "range", 1.0),
        "drive_torque_nm:abs": ("drive_torque", "abs", 1.0),
    }
    if name != "transfer_lift":  # of which two segments do, too
        asked[f"acceleration_{design.drive.motion_unit}_s2:max"] = (
            "acceleration", "max", 1e-3 if design.drive.motion_unit == "mm" else np.pi / 180.0
        )  # fmt: skip
    found = sensitivity(Study(design), paths, list(asked))
    assert found.shape == (len(paths), len(asked))
    for i, path in enumerate(paths):
        for j, (quantity, of, unit) in enumerate(asked.values()):
            size = asked_one_by_one(design, quantity, "abs") / abs(get(design, path))
            expected = refined_difference(design, path, quantity, of)
            assert found[i, j] * unit == pytest.approx(expected, rel=1e-6, abs=1e-7 * size), (path, quantity, of)


def test_the_pressure_angle_of_a_translating_roller_falls_as_its_closed_form() -> None:
    """tan ψ = (y' + dε)/S, S = √((Br + Rr)² - ε²) + y, d = 1 as the cam turns counter-clockwise."""
    design = put(example("dwell_rise_dwell"), "follower.offset_mm", 5.0)
    study = Study(design)
    steepest = extremes_of(study, "cam", ("pressure_angle",))["pressure_angle"].high
    y, rate = study.at_theta(np.array([steepest.theta])).motion.displacement.all[:2, 0]
    offset, pitch = 5e-3, 1e-3 * (get(design, "cam.base_radius_mm") + get(design, "cam.roller_radius_mm"))
    base = np.sqrt(pitch**2 - offset**2)
    top, bottom = rate + offset, base + y
    by_radius = -top / (top**2 + bottom**2) * pitch / base
    by_offset = (bottom + top * offset / base) / (top**2 + bottom**2)
    assert abs(np.arctan2(top, bottom)) == pytest.approx(steepest.value, rel=1e-9)
    expected = np.sign(top) * np.rad2deg(1e-3 * np.array([by_radius, by_offset]))
    found = sensitivity(study, ["cam.base_radius_mm", "follower.offset_mm"], ["pressure_angle_deg:max"])
    assert found[:, 0] == pytest.approx(expected, rel=1e-8)


def test_at_the_end_of_its_range_a_number_is_changed_to_the_inside() -> None:
    """No friction is the least there can be: the torque's slope is that with friction."""
    design = example("dwell_rise_dwell")
    (found,) = sensitivity(Study(design), ["loads.friction"], ["drive_torque_nm:abs", "drive_torque_nm:mean"])
    beside = many(design, {"loads.friction": np.array([0.0, 1e-4])}, ["drive_torque_nm:abs", "drive_torque_nm:mean"])
    assert found == pytest.approx([np.diff(row)[0] / 1e-4 for row in beside.value.values()], rel=1e-3)
    assert (found != 0.0).all()


def test_means_are_compared_and_nothing_is_made_of_what_is_not_there() -> None:
    design = put(example("transfer_lift"), "loads.friction", 0.05)
    found = sensitivity(Study(design), ["cam.base_radius_mm"], ["drive_torque_nm:rms", "drive_torque_nm:mean"])
    radius = get(design, "cam.base_radius_mm")
    values = {"cam.base_radius_mm": radius + np.array([-0.01, 0.01])}
    beside = many(design, values, ["drive_torque_nm:rms", "drive_torque_nm:mean"])
    assert found[0] == pytest.approx([np.diff(row)[0] / 0.02 for row in beside.value.values()], rel=1e-5)
    jammed = put(example("dwell_rise_dwell"), "loads.friction", 9.0)
    lost = sensitivity(Study(jammed), ["cam.base_radius_mm"], ["pressure_angle_deg:max", "drive_torque_nm:abs"])
    assert np.isfinite(lost).tolist() == [[True, False]]
    with pytest.raises(ValueError, match=r"cam\.no_such_mm: no such number"):
        sensitivity(Study(design), ["cam.no_such_mm"], ["drive_torque_nm:abs"])
    with pytest.raises(ValueError, match=r"cam\.bore_mm: has no value"):
        sensitivity(Study(example("tappet_knife")), ["cam.bore_mm"], ["drive_torque_nm:abs"])


def test_drives_on_a_shaft_and_linkages_have_derivatives() -> None:
    """Of one drive's own quantity, 0 by what belongs to another; of the sum of all; and of a coupler cam's linkage."""
    cases = {
        "transfer_unit": (
            ("drives[0].cam.base_radius_mm", "shaft.speed_rpm", "drives[1].phase_deg"),
            ("drives[0].pressure_angle_deg:max", "torque_nm:max", "energy_j"),
        ),
        "four_bar_coupler_cam": (
            ("linkage.links[1].points.A.x_mm", "cam.roller_radius_mm", "linkage.driver.speed_rpm"),
            ("pressure_angle_deg:max", "B_n:max", "contact_force_n:min"),
        ),
    }
    for name, (paths, keys) in cases.items():
        design = example(name)
        own, steps = (
            np.array([get(design, path) for path in paths]),
            1e-4 * np.array([get(design, path) for path in paths]),
        )
        rows = own[:, None] + np.kron(np.diag(steps), [-1.0, 1.0])
        beside = many(design, dict(zip(paths, rows, strict=True)), keys)
        expected = np.array([np.diff(beside.value[key].reshape(-1, 2))[:, 0] for key in keys]).T / (
            2.0 * steps[:, None]
        )
        found = sensitivity(Study(design), paths, keys)
        size = np.array([np.abs(beside.value[key]).max() for key in keys]) / own[:, None]
        assert (np.abs(found - expected) <= 1e-4 * np.abs(expected) + 1e-5 * size).all(), name
