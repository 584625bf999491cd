"""Flywheel: the motor's torque of the lift with a fitted flywheel, from the cam's torque and inertia at any angle."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks.exact import FITTED
from benchmarks.plain import turn
from benchmarks.table import Channels, Kernel, Method

from core.design import si
from core.motion import TURN, Angles
from core.shaft import load_curve, steady_speed
from core.study import Study

SHAFT = si(FITTED.shaft)
SLOPE, MEAN, FLYWHEEL = SHAFT.motor_slope, SHAFT.speed, SHAFT.flywheel_inertia


def given(theta: np.ndarray) -> SimpleNamespace:
    study = Study(FITTED)

    def load(angles: Angles) -> np.ndarray:
        there = study.at(angles)
        return np.array([there.dynamics.torque, there.loading.inertia(there.linkage)[0]])

    return SimpleNamespace(theta=theta, program=study.program, load=load)


def our_load(there: Any, setting: None) -> Any:
    """Torque and inertia as polynomials on panels."""
    return load_curve(there.load, there.program)


def ours(there: Any, curve: Any) -> Channels:
    """The speed by collocation."""
    speed = steady_speed(curve, FLYWHEEL, SLOPE, MEAN)
    assert speed is not None
    return (curve.mean - SLOPE * speed.deviation(there.theta),)


def _above(energy: Any, inertia: Any) -> Any:
    """ω - ω̄ at e = ½(I + J)(ω² - ω̄²)."""
    return 2.0 * energy / inertia / (MEAN + np.sqrt(np.maximum(MEAN**2 + 2.0 * energy / inertia, 0.0)))


# -- harmonics --------------------------------------------------------------------------------------------


def _load(there: Any, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Torque and I + J."""
    torque, inertia = there.load(there.program.angles(theta))
    return torque, inertia + FLYWHEEL


# -- polynomials from join to join ------------------------------------------------------------------------


def collocated(there: Any, nodes: int) -> Any:
    """Torque and inertia at so many of Gauss's nodes between two joins of the motion, integrals to the nodes and values at the
    given cam angles of the polynomial through values at them."""
    from numpy.polynomial.legendre import leggauss, legvander

    ends = np.append(np.asarray(there.program.starts, dtype=float), TURN)
    half, middle = np.diff(ends) / 2.0, (ends[1:] + ends[:-1]) / 2.0
    x, weights = leggauss(nodes)
    number = np.arange(nodes)
    values = legvander(x, nodes)
    to_nodes = np.concatenate((x[:, None] + 1.0, (values[:, 2:] - values[:, :-2]) / (2 * number[1:] + 1)), axis=1)
    coefficients = (values[:, :nodes] * weights[:, None]).T * (number[:, None] + 0.5)
    theta = middle[:, None] + half[:, None] * x
    torque, worth = (row.reshape(theta.shape) for row in _load(there, theta.ravel()))
    mean = float((half[:, None] * weights * torque).sum()) / TURN
    within, whole = half[:, None, None] * (to_nodes @ coefficients), half[:, None] * weights
    where = np.searchsorted(ends, there.theta, side="right") - 1
    at = [(there.theta[where == i] - middle[i]) / half[i] for i in range(half.size)]
    between = [legvander(row, nodes - 1) @ coefficients for row in at]
    return mean, torque - mean, worth, within, whole, between, _load(there, there.theta)[1]


def collocation(there: Any, kept: Any) -> Channels:
    """e' = -(T - T̄) - k (ω - ω̄) at the nodes by Newton's method, the stretches joined and the turn closed in every step."""
    mean, drive, worth, within, whole, between, at_angles = kept
    e, identity = np.zeros(drive.shape), np.eye(drive.shape[1])
    for _ in range(12):
        above = _above(e, worth)
        slope = -SLOPE / (worth * (MEAN + above))
        rest = -drive - SLOPE * above - slope * e
        sides = np.stack((np.ones(e.shape), (within @ rest[:, :, None])[:, :, 0]), axis=-1)
        solved = np.linalg.solve(
            identity - within * slope[:, None, :], sides
        )  # e is the first of its begin, and the second
        gains = np.stack(
            (1.0 + (whole * slope * solved[:, :, 0]).sum(1), (whole * (rest + slope * solved[:, :, 1])).sum(1)), axis=1
        )
        kept_share, gained = 1.0, 0.0
        for share, gain in gains.tolist():
            kept_share, gained = kept_share * share, gained * share + gain
        begins = [gained / (1.0 - kept_share)]
        for share, gain in gains[:-1].tolist():
            begins.append(begins[-1] * share + gain)
        after = np.array(begins)[:, None] * solved[:, :, 0] + solved[:, :, 1]
        moved, e = float(np.abs(after - e).max()), after
        if moved <= 1e-8 * float(np.abs(e).max()):  # and the square of it is left
            break
    told = np.concatenate([rows @ row for rows, row in zip(between, e, strict=True)])
    return (mean - SLOPE * _above(told, at_angles),)


NODES = (16, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 18, 20)


KERNEL = Kernel(
    "flywheel",
    "Motor torque with a flywheel",
    given=given,
    grid=turn,
    methods=(
        Method("KINDYNA", ours, ours=True, keeps=our_load),
        Method("collocation from join to join", collocation, NODES, "nodes", keeps=collocated),
    ),
    handed="a function that gives the cam's torque and inertia at any cam angles, and the joins of the motion",
    rival=("collocation from join to join", 16),
    warm="torque and inertia: samples, polynomials, matrices of integrals",
)
