"""Figures of cams in space against rigid bodies in motion: sliding, play, undercut, and rollers that enter and leave the blank."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.project import load
from core.spatial import AHEAD, BEHIND, SIDES, Machine, MotionRows, flank, roller_axis, sliding, turned
from core.study import Study

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
MACHINES = {
    "barrel": Machine("barrel", "mm", 0.008, 0.0, 0.04, 0.052, 1, 0.0, 0.0, 0.0, None, False),
    "arm": Machine("barrel", "deg", 0.008, 0.0, 0.04, 0.052, 1, 0.07, 0.0, 0.0, None, False),
    "globoid": Machine("globoidal", "deg", 0.008, 0.0, 0.03, 0.042, 6, 0.08, 0.0, 0.0, None, False),
}
HEIGHT = {"barrel": 0.015, "arm": 0.3, "globoid": 0.35}
THETA = np.linspace(0.1, 6.1, 13)


def motion(name: str, theta: np.ndarray) -> MotionRows:
    h = HEIGHT[name]
    return MotionRows(theta, h * np.sin(theta), h * np.cos(theta), -h * np.sin(theta))


def dwell(name: str, theta: np.ndarray) -> MotionRows:
    return MotionRows(theta, 0.0 * theta, 0.0 * theta, 0.0 * theta)


def along(machine: Machine, rows: int) -> np.ndarray:
    return np.linspace(machine.inner, machine.outer, rows)[:, None]


# -- pressure angle -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_pressure_angle_of_a_roller_on_an_arm_in_closed_form(sense: float) -> None:
    """Parallel axes: tan ψ = |A φ' + d u sin φ|/(u cos φ)."""
    machine, rows = MACHINES["arm"], motion("arm", THETA)
    u = along(machine, 5)
    expected = np.arctan(np.abs(0.07 * rows.y_1 + sense * u * np.sin(rows.y)) / (u * np.cos(rows.y)))
    for side in SIDES:
        assert flank(machine, rows, u, sense, side).pressure_angle == pytest.approx(expected, abs=1e-14)


# -- sliding ------------------------------------------------------------------------------------------------------


def surface_points(name: str, machine: Machine, theta: np.ndarray, sense: float, marks) -> np.ndarray:
    """Points of a roller that does not turn about its axis, in the frame of the cam: ``marks`` are u and components along t and s."""
    u, on_t, on_s = marks
    line = roller_axis(machine, motion(name, theta).y)
    s = np.cross(line.a, line.t, axis=0)
    point = line.c[:, None] + u * line.a[:, None] + on_t * line.t[:, None] + on_s * s[:, None]
    return turned(point, -sense * theta)


@pytest.mark.parametrize(
    ("name", "taper", "side", "sense"), list(itertools.product(MACHINES, (0.0, 0.12, -0.09), SIDES, (1.0, -1.0)))
)
def test_sliding_is_the_velocity_of_a_rolling_body_against_the_cam(name, taper, side, sense):
    """Points of the roller's surface are followed by differences; its spin makes the middle roll around."""
    machine = replace(MACHINES[name], taper=taper)
    u, h = np.concatenate(([[machine.middle]], along(machine, 5))), 1e-4
    known = flank(machine, motion(name, THETA), u, sense, side)
    marks = u, known.radius * known.e_t, known.radius * known.e_s

    def at(step: float) -> np.ndarray:
        return surface_points(name, machine, THETA + step, sense, marks)

    carried = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h)
    axis = turned(roller_axis(machine, motion(name, THETA).y).a, -sense * THETA)
    normal = known.in_cam(known.normal)
    around = np.cross(axis[:, None], normal, axis=0)
    around /= np.linalg.norm(around, axis=0)
    spin = -np.einsum("imn,imn->mn", carried, around)[0] / known.radius[0]
    slip = carried + spin * known.radius * around
    assert np.abs(np.einsum("imn,imn->mn", slip, normal)).max() < 1e-9  # it neither presses in nor lifts off
    middle = flank(machine, motion(name, THETA), np.array([[machine.middle]]), sense, side)
    assert sliding(known, middle) == pytest.approx(np.linalg.norm(slip, axis=0), abs=1e-9)


def test_a_cone_with_its_apex_on_the_axis_of_the_cam_rolls_in_a_dwell() -> None:
    """A cylinder slides by the difference of the distances from the axis, |u - u_m|; the cone does not slide."""
    cylinder = MACHINES["barrel"]
    u = along(cylinder, 5)
    for machine, expected in (
        (cylinder, np.abs(u - cylinder.middle)),
        (replace(cylinder, taper=-float(np.arctan(0.008 / 0.04))), 0.0 * u),
    ):
        for side in SIDES:
            known, middle = (
                flank(machine, dwell("barrel", THETA), v, 1.0, side) for v in (u, np.array([[machine.middle]]))
            )
            assert sliding(known, middle) == pytest.approx(expected + 0.0 * THETA, abs=1e-16)


# -- play ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "taper", "sense"), list(itertools.product(MACHINES, (0.0, 0.12), (1.0, -1.0))))
def test_the_play_of_a_groove_is_between_the_roller_and_the_flank_behind(name, taper, sense):
    """Least distance of each point from the roller over the turn: the play on the flank behind, none on the flank ahead."""
    play = 0.0004
    machine = replace(MACHINES[name], taper=taper, play=play)
    theta = np.linspace(0.0, 2.0 * np.pi, 2881)[:-1]
    rows = motion(name, theta)
    line = roller_axis(machine, rows.y)
    c, a = turned(line.c, -sense * theta), turned(line.a, -sense * theta)
    for side, expected in ((AHEAD, 0.0), (BEHIND, play)):
        known = flank(machine, rows, along(machine, 3), sense, side)
        points = known.cam_point[:, :, ::96].reshape(3, -1)
        away = points[:, :, None] - c[:, None]
        on_axis = np.einsum("ipt,it->pt", away, a)
        distance = np.sqrt(np.maximum(np.einsum("ipt,ipt->pt", away, away) - on_axis**2, 0.0))
        gap = distance - machine.roller_radius(on_axis)  # of a cone across its axis, as its play
        gap[(on_axis < machine.inner - 1e-6) | (on_axis > machine.outer + 1e-6)] = np.inf
        assert gap.min(axis=1) == pytest.approx(np.full(points.shape[1], expected), abs=1e-9)


# -- undercut -----------------------------------------------------------------------------------------------------


def deepest(name: str, machine: Machine, side: str, sense: float) -> float:
    """Greatest depth [m] of a point of a flank inside of the roller at any cam angle near its own."""
    theta = np.linspace(0.0, 2.0 * np.pi, 721)[:-1]
    known = flank(machine, motion(name, theta), along(machine, 3), sense, side)
    near = theta[::4, None] + np.linspace(-0.6, 0.6, 241)
    line = roller_axis(machine, motion(name, near.ravel()).y)
    c, a = (turned(v, -sense * near.ravel()).reshape(3, 1, *near.shape) for v in (line.c, line.a))
    away = known.cam_point[:, :, ::4, None] - c
    on_axis = (away * a).sum(axis=0)
    distance = np.sqrt(np.maximum((away**2).sum(axis=0) - on_axis**2, 0.0))
    depth = machine.roller_radius(on_axis) - distance
    depth[(on_axis < machine.inner) | (on_axis > machine.outer)] = 0.0
    return float(depth.max())


@pytest.mark.parametrize(("name", "side", "sense"), list(itertools.product(MACHINES, SIDES, (1.0, -1.0))))
def test_a_flank_is_undercut_where_the_roller_cuts_into_it_again(name, side, sense):
    """The least margin vanishes at the roller from which on points of the flank are inside of it at another angle."""

    def least(radius: float) -> float:
        machine = replace(MACHINES[name], radius=radius)
        theta = np.linspace(0.0, 2.0 * np.pi, 1441)
        return float(flank(machine, motion(name, theta), along(machine, 9), sense, side).margin.min())

    low, high = 0.001, 0.6
    assert least(high) < 0.0 < least(low)
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if least(middle) > 0.0 else (low, middle)
    assert deepest(name, replace(MACHINES[name], radius=0.98 * low), side, sense) < 1e-9
    assert deepest(name, replace(MACHINES[name], radius=1.1 * low), side, sense) > 1e-6


# -- rollers in the blank -----------------------------------------------------------------------------------------


def test_rollers_enter_and_leave_the_blank_of_an_indexer() -> None:
    """Counted roller by roller: those whose middle, at 56 mm from the turret's axis, is within 50 mm of the middle of the blank."""
    design = load(EXAMPLES / "globoidal_indexer.toml")
    study = Study(design, 1440)
    turret = np.rad2deg(study.motion.displacement[0])
    angle = np.mod(turret + 60.0 * np.arange(6)[:, None] + 180.0, 360.0) - 180.0
    inside = (np.abs(56.0 * np.sin(np.deg2rad(angle))) <= 50.0) & (np.abs(angle) < 90.0)
    shape = study.surface
    assert shape.touching.tolist() == inside.sum(axis=0).tolist()
    assert set(shape.touching.tolist()) == {2, 3}  # a dwell has two, in the middle of a step there are three
    assert inside[shape.number - 1, np.arange(turret.size)].all()
    # the pieces of searches end where a roller enters or leaves: 2 rollers at both ends, and one takes over from another
    changes = np.flatnonzero(np.diff(shape.touching)) + 0.5
    for change in np.deg2rad(changes * 360.0 / turret.size):
        assert np.abs(np.asarray(study.program.starts) - change).min() < np.deg2rad(0.25)
