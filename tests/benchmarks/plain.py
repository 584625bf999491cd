"""The lift as a reader of the paper would write it down in an afternoon: what alternatives to KINDYNA start from."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks.exact import FITTED
from mechanisms import LIFT

from core.design import si
from core.motion import TURN
from core.study import Study

G = si(LIFT.drive.mechanism)
PIVOT = complex(G.pivot_x, G.pivot_y)
ROLLER_RADIUS = si(LIFT.drive.cam).roller_radius
K = 1.0 / (4.0 + np.pi)
SENSE = LIFT.shaft.sense
_SPANS = np.deg2rad([s.span_deg for s in LIFT.drive.motion.segments])
JOINS = np.concatenate(([0.0], np.cumsum(_SPANS)))
_BASE = Study(LIFT, 8).linkage.base
L0, PHI0, BETA0 = (_BASE[name][0] for name in ("slider", "phi", "beta"))
STROKE = 0.150


def turn(n: int) -> np.ndarray:
    return np.arange(n) * (TURN / n)


def given(theta: np.ndarray, fitted: bool = False) -> SimpleNamespace:
    """Motion, kinematics, cam and forces at these angles, as our own stages give them: what a kernel is handed."""
    study = Study(FITTED if fitted else LIFT)
    there = study.at(study.program.angles(theta))
    kinematics = there.linkage
    # what methods share is made beforehand
    _ = kinematics.follower.z, there.motion.angles.unit, there.cam.flank.normal, kinematics.travel
    drive = LIFT.drive
    return SimpleNamespace(
        theta=theta, angles=there.angles, motion=there.motion, kinematics=kinematics, shape=there.cam, study=study,
        follower=drive.mechanism, cam=drive.cam, face=drive.face, reach=study.reach, loading=study.loading, omega=study.omega,
    )  # fmt: skip


def modified_sine(u: np.ndarray) -> np.ndarray:
    """Displacement of the law, branch by branch."""
    return np.select(
        [u <= 0.125, u <= 0.875],
        [K * (np.pi * u - np.sin(4 * np.pi * u) / 4), K * (2 + np.pi * u - 9 / 4 * np.sin(4 * np.pi * u / 3 + np.pi / 3))],
        K * (4 + np.pi * u - np.sin(4 * np.pi * u) / 4),
    )


def displacement(theta: np.ndarray) -> np.ndarray:
    """y [m] at any cam angles."""
    at = np.mod(theta, TURN)
    segment = np.clip(np.searchsorted(JOINS, at, side="right") - 1, 0, 4)
    s = modified_sine((at - JOINS[segment]) / _SPANS[segment])
    return np.select([segment == 1, segment == 2, segment == 3], [STROKE * (1.0 - s), 0.0, STROKE * s], STROKE)


def arm_pin(y: np.ndarray) -> np.ndarray:
    """Where the circles about pivot and slider pin meet, left of the line between them or right as at the base [m]."""
    to_slider = L0 + y + 1j * G.guide_height
    square = np.abs(to_slider) ** 2
    along = (square + G.slider_arm**2 - G.rod**2) / (2.0 * square)
    across = np.sqrt(np.maximum(G.slider_arm**2 / square - along**2, 0.0))
    side = np.sign(L0 * np.sin(PHI0) - G.guide_height * np.cos(PHI0))
    return PIVOT + to_slider * (along + 1j * side * across)


def roller(y: np.ndarray) -> np.ndarray:
    """The roller centre [m], on the arm with the pin."""
    return PIVOT + (arm_pin(y) - PIVOT) * (G.roller_arm / G.slider_arm) * np.exp(1j * G.fixed_angle)


def pitch(theta: np.ndarray) -> np.ndarray:
    """The pitch curve in the cam's frame [m]."""
    return roller(displacement(theta)) * np.exp(-1j * SENSE * theta)


def differences(function: Callable[[np.ndarray], np.ndarray], theta: np.ndarray, step: float) -> tuple[np.ndarray, ...]:
    """Value and two derivatives by central differences."""
    before, here, after = function(theta - step), function(theta), function(theta + step)
    return here, (after - before) / (2.0 * step), (after - 2.0 * here + before) / step**2


def tabled(points: int, values: Callable[[np.ndarray], list[np.ndarray]], theta: np.ndarray) -> list[np.ndarray]:
    """Straight lines between ``points`` exact values over the turn."""
    knots = turn(points + 1) * (points + 1) / points
    return [np.interp(theta, knots, column) for column in values(knots)]


def splined(points: int, column: Callable[[np.ndarray], np.ndarray]) -> Any:
    """A cubic spline through values over the turn."""
    from scipy.interpolate import CubicSpline

    knots = turn(points + 1) * (points + 1) / points
    return CubicSpline(knots, column(knots))
