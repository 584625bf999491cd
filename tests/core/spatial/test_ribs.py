"""Thickness of ribs against the least distance of points of both flanks, by a search over cam angle and length of the roller."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial import cKDTree

from core.__main__ import main
from core.design import put
from core.project import loads
from core.spatial import AHEAD, BEHIND, Machine, MotionRows, flank, rib_thickness
from core.study import Study, findings_of
from core.study.cam_checks import limit_rows

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
SLIDE = Machine("barrel", "mm", 0.008, 0.0, 0.04, 0.052, 1, 0.0, 0.0, 0.026, None, True)
TURRET = Machine("barrel", "deg", 0.008, 0.0, 0.04, 0.052, 8, 0.035, 0.0, 0.0, None, False)
GLOBOID = Machine("globoidal", "deg", 0.008, 0.0, 0.03, 0.042, 6, 0.08, 0.0, 0.0, None, True)
MACHINES = {
    "slide": SLIDE,
    "slide, cone": replace(SLIDE, taper=0.12),
    "turret with play": replace(TURRET, play=0.0005),
    "globoid": GLOBOID,
    "globoid, cone": replace(GLOBOID, taper=-0.09),
}


def motion(machine: Machine, theta: np.ndarray) -> MotionRows:
    """A slide moves by a sine; a turret advances by a pitch a turn, with a wave."""
    if machine.slides:
        return MotionRows(theta, 0.02 * np.sin(theta), 0.02 * np.cos(theta), -0.02 * np.sin(theta))
    even = machine.pitch / (2.0 * np.pi)
    wave = 0.7 * even
    return MotionRows(theta, even * theta + wave * np.sin(theta), even + wave * np.cos(theta), -wave * np.sin(theta))


def least_distance(machine: Machine, theta: float, sense: float) -> float:
    """Least distance of points of a flank behind from points of the flank ahead at a cam angle, of every pair of neighbours."""
    y = motion(machine, np.array([theta])).y[0]
    below = -0.5 * machine.distance if machine.slides else -np.floor(y / machine.pitch) * machine.pitch
    pairs = [below] if machine.slides else [below - machine.pitch, below, below + machine.pitch]
    limit = machine.pitch * (1.0 + 1e-9)
    distances = []
    for low in pairs:
        high = low + (machine.distance or machine.pitch)
        if not machine.slides and max(abs(y + low), abs(y + high)) > limit:
            continue

        def point(at, u, offset, side):
            rows = motion(machine, np.atleast_1d(at)).shifted(offset)
            return flank(machine, rows, np.atleast_2d(u), sense, side).cam_point

        def separation(x, low=low, high=high):  # [mm²], by parts of a radian and of the roller's length
            u = machine.inner + (machine.outer - machine.inner) * x[1:]
            apart = point(theta + x[0], u[0], high, BEHIND) - point(theta, u[1], low, AHEAD)
            return float(((1e3 * apart) ** 2).sum())

        parts, turns = np.linspace(0.0, 1.0, 9), np.linspace(-1.2, 1.2, 121)
        u = machine.inner + (machine.outer - machine.inner) * parts[:, None]
        near, far = point(theta, u, low, AHEAD)[:, :, 0], point(theta + turns, u, high, BEHIND)
        apart = np.linalg.norm(far[:, None] - near[:, :, None, None], axis=0)
        first, second, turn = np.unravel_index(np.argmin(apart), apart.shape)
        start, bounds = (turns[turn], parts[second], parts[first]), ((-1.3, 1.3), (0.0, 1.0), (0.0, 1.0))
        nearest = minimize(separation, start, bounds=bounds, options={"ftol": 1e-15, "gtol": 1e-10})
        distances.append(1e-3 * nearest.fun**0.5)
    return min(distances)


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("name", MACHINES)
def test_a_rib_is_as_thick_as_its_flanks_are_apart(name: str, sense: float) -> None:
    machine, theta = MACHINES[name], np.array([0.2, 1.0, 2.6, 4.0, 5.5])
    thickness = rib_thickness(machine, motion(machine, theta), lambda at: motion(machine, at), sense)
    assert thickness == pytest.approx([least_distance(machine, at, sense) for at in theta], rel=1e-6)


def test_the_thickness_in_the_summary_is_that_of_the_points_of_the_surfaces(tmp_path) -> None:
    """Every point of a flank ahead against every point of the flank behind the next roller, as the command writes them."""
    design = str(EXAMPLES / "globoidal_indexer.toml")
    assert main(["surface", design, "--out", str(tmp_path / "flanks.csv"), "--samples", "720", "--along", "5"]) == 0
    assert main(["export", design, "--out", str(tmp_path), "--samples", "360"]) == 0
    with (tmp_path / "flanks.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    points = {
        (side, roller): np.array([
            [float(row[f"{axis}_mm"]) for axis in "xyz"] for row in rows if (row["flank"], int(row["roller"])) == (side, roller)
        ])
        for side in (AHEAD, BEHIND)
        for roller in range(1, 7)
    }  # fmt: skip
    pairs = [(points[AHEAD, roller], points[BEHIND, roller % 6 + 1]) for roller in range(1, 7)]
    least = min(cKDTree(far).query(near)[0].min() for near, far in pairs if near.size and far.size)
    limits = json.loads((tmp_path / "summary.json").read_text("utf-8"))["limits"]
    thickness = {row["name"]: row["value"] for row in limits}["rib_thickness_mm"]
    assert thickness <= least
    assert thickness == pytest.approx(least, abs=0.01)  # points are half a millimetre apart


def test_a_rib_that_vanishes_goes_through_zero() -> None:
    """Two rollers on a slide: the thickness grows by the same amount with every part of their distance, also where flanks cross."""
    text = (EXAMPLES / "barrel_feeder.toml").read_text("utf-8")
    text = text.replace('form = "groove"\nplay_mm = 0.02', 'form = "rib"\nroller_distance_mm = 30.0')
    design, values = loads(text, "rib"), []
    for distance in (22.55, 22.65, 22.75, 22.85, 22.95):
        study = Study(put(design, "cam.roller_distance_mm", distance))
        (thickness,) = (row.value for row in limit_rows(study, ("cam",)) if row.name == "rib_thickness_mm")
        values.append(thickness)
        assert ("rib-vanishes" in {finding.code for finding in findings_of(study)}) == (thickness <= 0.0)
    assert values[0] < 0.0 < values[-1]
    steps = np.diff(values)
    assert steps == pytest.approx(steps.mean(), rel=0.01)
