"""Life of a roller on its own bearing (ISO 281), by its own speed over the turn."""

from __future__ import annotations

from itertools import pairwise
from math import ceil, inf, pi, radians
from typing import Any

import numpy as np

from core.cam import OUTER, Flank
from core.frozen import frozen
from core.mechanism.kinematics import Kinematics
from core.motion import TURN, Angles
from core.motion.extremes import Pieces
from core.numerics.gauss import gauss_legendre

EXPONENT = 10.0 / 3.0
"""Of roller bearings, in ISO 281."""
PANEL, NODES = radians(2.0), 8  # width and points of a Gauss panel
MILLION, HOUR = 1e6, 3600.0


@frozen
class RollerLife:
    """roller: ``first`` or ``second``; load: the equivalent P [N]; rpm: its mean speed about its own axis; L10 in million turns of
    the roller and in hours, infinite where nothing loads it."""

    roller: str
    load: float
    rpm: float
    million_turns: float
    hours: float


def roller_speed(kinematics: Kinematics, flank: Flank, sense: float) -> np.ndarray:
    """ω_r/ω (n,): the turn of a roller that rolls on a flank, about its own axis, by cam angle.

    d - α' ∓ d|t|/r (inner, outer flank): t the velocity of its centre relative to the cam, α the angle of what carries it. In a
    groove with play the roller is taken to roll without slip on the flank that carries.
    """
    radius = getattr(flank, "radius", 0.0)
    side = -1.0 if flank.name == OUTER else 1.0
    carried = kinematics.bodies[flank.body].turn[1]
    return np.asarray(sense - carried - side * sense * np.abs(flank.relative_velocity) / radius)


def turn_nodes(program: Pieces, breaks: tuple[float, ...], longest: float = PANEL) -> tuple[Angles, np.ndarray]:
    """Angles (n,) and weights (n,) [rad] by which the values there are integrated over the turn: panels of Gauss within the pieces
    of the motion and between further breaks [rad]; longest: [rad] a panel."""
    x, w = gauss_legendre(NODES)
    theta, weight, piece = [], [], []
    for number, (a, b) in enumerate(zip(program.starts.tolist(), program.ends.tolist(), strict=True)):
        inner = [a, *sorted(each for each in breaks if a < each < b), b]
        for start, end in pairwise(inner):
            edges = np.linspace(start, end, max(1, ceil((end - start) / longest)) + 1)
            half = 0.5 * np.diff(edges)[:, None]
            theta.append((edges[:-1, None] + half * (1.0 + x)).ravel())
            weight.append((half * w).ravel())
            piece.append(np.full(theta[-1].size, number))
    return Angles(np.concatenate(theta), np.concatenate(piece)), np.concatenate(weight)


def life_of(
    roller: str, rating: float, force: np.ndarray, speed: np.ndarray, weight: np.ndarray, omega: float
) -> RollerLife:
    """That of a roller, as by ``lives_of``."""
    return RollerLife(roller, *(float(each) for each in lives_of(rating, force, speed, weight, omega)))


@np.errstate(divide="ignore", invalid="ignore")
def lives_of(
    rating: Any, force: np.ndarray, speed: np.ndarray, weight: np.ndarray, omega: Any
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """L10 = (C/P)^(10/3) million turns, P^(10/3) = ∫F^(10/3)|ω_r|dt/∫|ω_r|dt (ISO 281): P [N], rpm of the roller, L10 in million turns and
    in hours.

    rating C [N]; force (..., n) [N] on the roller and its speed ω_r/ω (..., n), by cam angle, with the weights [rad] of a turn; omega
    [rad/s] of the shaft; rating and omega one or (...,)
    """
    turning = np.abs(speed) * weight
    whole = turning.sum(axis=-1)  # [rad] of the roller in a turn of the shaft
    power = (np.maximum(force, 0.0) ** EXPONENT * turning).sum(axis=-1) / whole
    load, rpm = np.where(whole > 0.0, power, 0.0) ** (1.0 / EXPONENT), whole / TURN * omega * 30.0 / pi
    turns = np.where(load > 0.0, (rating / load) ** EXPONENT, inf)
    return load, rpm, turns, np.where(load > 0.0, turns * MILLION * TURN / (whole / TURN * omega) / HOUR, inf)
