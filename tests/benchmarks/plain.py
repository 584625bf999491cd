"""The lift as a reader of the paper would write it down in an afternoon: what alternatives to KINDYNA start from."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import perm
from operator import attrgetter
from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks.exact import FITTED
from benchmarks.table import Method
from mechanisms import LIFT

from core.cam import envelope
from core.design import si
from core.followers import built
from core.mechanism import solve_mechanism
from core.motion import TURN
from core.study import Study

G = si(LIFT.drive.mechanism)
PIVOT = complex(G.pivot_x, G.pivot_y)
ROLLER_RADIUS = si(LIFT.drive.cam).roller_radius
K = 1.0 / (4.0 + np.pi)
SENSE = LIFT.shaft.sense
SPANS = np.deg2rad([s.span_deg for s in LIFT.drive.motion.segments])
JOINS = np.concatenate(([0.0], np.cumsum(SPANS)))
_BASE = Study(LIFT, 8).linkage.base
L0, PHI0, BETA0 = (_BASE[name][0] for name in ("slider", "phi", "beta"))
STROKE = 0.150
SIDE = float(np.sign(L0 * np.sin(PHI0) - G.guide_height * np.cos(PHI0)))
"""+1 where the arm's pin lies left of the line from the pivot to the slider's."""
HAND = SimpleNamespace(**vars(G), pivot=PIVOT, roller_radius=ROLLER_RADIUS, base=L0)
"""What the formulas by hand read of the lift; of many lifts some of it stands as columns (m, 1)."""


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
        theta=theta,
        angles=there.angles,
        motion=there.motion,
        kinematics=kinematics,
        shape=there.cam,
        study=study,
        follower=drive.mechanism,
        cam=drive.cam,
        face=drive.face,
        reach=study.reach,
        loading=study.loading,
        omega=study.omega,
    )


def again(there: SimpleNamespace) -> SimpleNamespace:
    """The same with the linkage solved anew: of every body position, velocity and acceleration, of its angle too, and the
    normal of the cam stand there; what our stages make of these later does not."""
    kinematics = solve_mechanism(built(there.follower, there.cam), there.motion)
    for pose in (*kinematics.bodies.values(), kinematics.follower):
        _ = pose.unit, [(pose.origin[order], pose.turn[order]) for order in range(3)]
    _ = kinematics.travel
    shape = envelope(kinematics, there.face, there.cam, SENSE)
    _ = shape.flank.normal
    return SimpleNamespace(**{**vars(there), "kinematics": kinematics, "shape": shape})


_WAVE, _SHIFT = np.array((4 * np.pi, 4 * np.pi / 3, 4 * np.pi)), np.array((0.0, np.pi / 3, 0.0))
_START, _SIZE = np.array((0.0, 2.0, 4.0)) * K, np.array((0.25, 2.25, 0.25)) * K


def law(u: np.ndarray) -> list[np.ndarray]:
    """s, v, a with one sine and one cosine an angle."""
    branch = (u > 0.125).astype(np.intp) + (u > 0.875)
    wave, size = _WAVE[branch], _SIZE[branch]
    at = wave * u + _SHIFT[branch]
    sine, cosine, bend = np.sin(at), np.cos(at), wave * size
    return [_START[branch] + np.pi * K * u - size * sine, np.pi * K - bend * cosine, wave * bend * sine]


GAIN = STROKE * np.array((0.0, -1.0, 0.0, 1.0, 0.0))
LEVEL = STROKE * np.array((1.0, 1.0, 0.0, 0.0, 1.0))


def _moving(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The segment of each angle; which of them lie in a rise or return; where in it."""
    at = np.mod(theta, TURN)
    segment = np.clip(np.searchsorted(JOINS, at, side="right") - 1, 0, 4)
    moving = np.flatnonzero(GAIN[segment])
    return segment, moving, (at[moving] - JOINS[segment[moving]]) / SPANS[segment[moving]]


def moved(theta: np.ndarray) -> np.ndarray:
    """y, y', y'' (3, n) [m]."""
    segment, moving, u = _moving(theta)
    y = np.zeros((3, theta.size))
    y[0] = LEVEL[segment]
    gain, span = GAIN[segment[moving]], SPANS[segment[moving]]
    for order, values in enumerate(law(u)):
        y[order, moving] += gain * values / span**order
    return y


def motion_at(theta: np.ndarray) -> SimpleNamespace:
    """Cam angles with the motion by hand: what a linkage is handed."""
    return SimpleNamespace(theta=theta, motion=SimpleNamespace(y=moved(theta)))


# -- tables, which are kept ---------------------------------------------------------------------------------

ALSO = "; for tables also the cam angles"
"""What these are handed besides: they know the motion by hand."""

Columns = Callable[[np.ndarray], Sequence[np.ndarray]]
POINTS = (3600, 90, 360, 1200, 6000, 12_000, 36_000)
EVEN = (3600, 360, 12_000, 36_000, 120_000)
NEAREST = (120_000, 3600, 12_000, 36_000)
FEW = (720, 90, 180, 360, 1440, 3600)


def knots(points: int, end: float = TURN) -> np.ndarray:
    return np.arange(points + 1) * (end / points)


def by_table(
    values: Columns, where: Callable[[Any], np.ndarray] = attrgetter("theta"), end: float = TURN
) -> tuple[Method, ...]:
    """Exact values of every channel at even steps: straight lines between them, the place in the table by one multiplication; the
    nearest of them."""

    def steps(there: Any, points: int) -> Any:
        columns = [np.asarray(column) for column in values(knots(points, end))]
        return points / end, [(column, np.diff(column)) for column in columns]

    def between(there: Any, kept: Any) -> list[np.ndarray]:
        after = where(there) * kept[0]
        before = after.astype(np.intp)
        after -= before
        return [column.take(before) + after * steps.take(before) for column, steps in kept[1]]

    def nearest(there: Any, kept: Any) -> list[np.ndarray]:
        at = (where(there) * kept[0] + 0.5).astype(np.intp)
        return [column.take(at) for column, _ in kept[1]]

    return (
        Method("linear table by even steps", between, EVEN, "points", keeps=steps),
        Method("nearest value of a table", nearest, NEAREST, "points", keeps=steps),
    )


@dataclass(frozen=True)
class Quintic:
    """Pieces of degree five between knots at even steps: coefficients by falling powers of the part of a step, each (pieces,)."""

    step: float
    rows: tuple[np.ndarray, ...]

    def at(self, where: np.ndarray, *orders: int) -> list[np.ndarray]:
        """Value (order 0) and derivatives; the piece by one multiplication."""
        x = where * (1.0 / self.step)
        piece = x.astype(np.intp)
        x -= piece
        rows = [row.take(piece) for row in self.rows]
        return [self._of(order, x, rows) for order in orders]

    def _of(self, order: int, x: np.ndarray, rows: Sequence[np.ndarray]) -> np.ndarray:
        weights = [perm(power, order) / self.step**order for power in range(5, order - 1, -1)]
        told = weights[0] * rows[0]
        for weight, row in zip(weights[1:], rows[1:], strict=False):
            told *= x
            told += row if weight == 1.0 else weight * row
        return told


def hermite(at: np.ndarray, s: np.ndarray, v: np.ndarray, a: np.ndarray) -> Quintic:
    """Through values, velocities and accelerations at the knots, which are even."""
    h = float(at[1] - at[0])
    s0, v0, a0 = s[:-1], v[:-1] * h, a[:-1] * h * h / 2.0
    d, e, f = s[1:] - s0 - v0 - a0, v[1:] * h - v0 - 2.0 * a0, a[1:] * h * h / 2.0 - a0
    return Quintic(h, (6.0 * d - 3.0 * e + f, 7.0 * e - 15.0 * d - 2.0 * f, 10.0 * d - 4.0 * e + f, a0, v0, s0))
