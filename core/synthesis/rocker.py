"""Crank-rockers of a given swing and time ratio.

The rocker of length c swings by Ψ between B₁ and B₂. The crank's pivot sees the chord B₁B₂ under α = 180°(q - 1)/(q + 1), so that it is
on a circle through B₁ and B₂, for q = 1 on their line. With l₁ < l₂ its distances from both, the crank is (l₂ - l₁)/2, the coupler
(l₂ + l₁)/2. On the circle the crank-rocker of best transmission angle within the ratio of lengths is chosen.

Source: VDI 2130, *Getriebe für Hub- und Schwingbewegungen*; J. Volmer, *Getriebetechnik*, crank-rockers by dead centres.
"""

from __future__ import annotations

import cmath
from collections.abc import Iterator
from math import acos, ceil, floor, inf, log10, pi, radians, sin, tan

import numpy as np

from core.errors import DesignError, Fault
from core.mechanism.kinematics import Kinematics
from core.mechanism.mechanism import body_name
from core.synthesis.candidates import FOUR_BAR, SIDE_LINK, Candidate, Errors, linkage_of
from core.synthesis.dyads import PIN, Dyad
from core.synthesis.task import Task

GRID = 2001  # positions of the crank's pivot before the minimisation


def candidates(task: Task) -> Iterator[tuple[Candidate, ...]]:
    """Crank-rockers of best transmission angle, one for each half of the two circles, with the frame along x."""
    swing = task.rocker
    assert swing is not None
    psi = radians(swing.swing_deg)
    alpha = pi * (swing.time_ratio - 1.0) / (swing.time_ratio + 1.0)
    limit = task.longest_to_shortest or inf
    pivots = [_best_pivot(psi, alpha, side, low, high, limit) for side, low, high in _arcs(alpha)]
    if not any(pivots) and (least := _least_ratio(psi, alpha)) < inf:
        problem = "no crank-rocker of this swing and time ratio has so similar links"
        raise DesignError([Fault("limits.length_ratio_max", limit, problem, f">= {_rounded_up(least):g}")])
    yield from ((_candidate(pivot, psi, swing.frame_mm),) for pivot in pivots if pivot is not None)


def _rounded_up(ratio: float) -> float:
    """The ratio with four digits, not below it."""
    step = 10.0 ** (floor(log10(ratio)) - 3)
    return ceil(ratio / step) * step


def _least_ratio(psi: float, alpha: float) -> float:
    """Least ratio of the longest to the shortest link of the crank-rockers of a swing; infinite where there is none."""
    least = inf
    for side, low, high in _arcs(alpha):
        for t in np.linspace(low, high, GRID):
            pivot = _pivot(psi, alpha, side, float(t))
            if _least_transmission(pivot, psi, inf) >= 0.0:
                crank, *others = _lengths(pivot, psi)
                least = min(least, max(*others, 1.0) / crank)
    return least


def _pivot(psi: float, alpha: float, side: float, t: float) -> complex:
    """Position of the crank's pivot for a rocker of length 1 about 0, whose chord is across x at cos(Ψ/2).

    t is an angle on the circle, or the reciprocal distance from the chord's middle where α = 0; the centre of the circle is beyond
    the chord (side 1), or on the side of the rocker's pivot (-1).
    """
    half = sin(0.5 * psi)
    middle = complex((1.0 - half * half) ** 0.5)
    if alpha == 0.0:
        return middle + 1j * half / t
    return middle + side * half * (1.0 / tan(alpha) + cmath.exp(1j * t) / sin(alpha))


def _arcs(alpha: float) -> list[tuple[float, float, float]]:
    """Side, and range of t, of the half arcs on which the pivot sees the chord under α; its ends are at ±(π - α)."""
    if alpha == 0.0:
        return [(1.0, 1e-3, 1.0 - 1e-6)]
    edge = pi - alpha - 1e-6
    return [(side, low, high) for side in (1.0, -1.0) for low, high in ((0.0, edge), (-edge, 0.0))]


def _lengths(pivot: complex, psi: float) -> tuple[float, float, float]:
    """Crank, coupler and frame of a rocker of length 1."""
    ends = [abs(pivot - cmath.exp(0.5j * s * psi)) for s in (-1.0, 1.0)]
    return 0.5 * abs(ends[1] - ends[0]), 0.5 * sum(ends), abs(pivot)


def _least_transmission(pivot: complex, psi: float, limit: float) -> float:
    """Least transmission angle [rad]; negative where it is no crank-rocker within the ratio of lengths."""
    a, b, d = _lengths(pivot, psi)
    lengths = sorted((a, b, 1.0, d))
    if a <= 0.0 or lengths[0] != a or lengths[3] > limit * lengths[0] or lengths[0] + lengths[3] > sum(lengths[1:3]):
        return -1.0
    if not 0.5 * psi < abs(cmath.phase(pivot)) < pi - 0.5 * psi:
        return -1.0  # its ends on both sides of the frame would be two assemblies
    return min(_acute(b, (d + sign * a)) for sign in (1.0, -1.0))


def _acute(b: float, across: float) -> float:
    """Acute angle between coupler b and rocker 1 for the distance of their ends."""
    cosine = (b * b + 1.0 - across * across) / (2.0 * b)
    return acos(min(1.0, abs(cosine)))


def _best_pivot(psi: float, alpha: float, side: float, low: float, high: float, limit: float) -> complex | None:
    """Position of the crank's pivot with the largest least transmission angle on a part of the circle."""
    from scipy.optimize import minimize_scalar  # imported here to save start-up time

    grid = np.linspace(low, high, GRID)
    values = [_least_transmission(_pivot(psi, alpha, side, float(t)), psi, limit) for t in grid]
    best = int(np.argmax(values))
    if values[best] < 0.0:
        return None
    ends = grid[max(best - 1, 0)], grid[min(best + 1, GRID - 1)]

    def loss(t: float) -> float:
        return -_least_transmission(_pivot(psi, alpha, side, float(t)), psi, limit)

    result = minimize_scalar(loss, bounds=ends, method="bounded", options={"xatol": 1e-12})
    t = float(result.x) if -float(result.fun) >= values[best] else float(grid[best])
    return _pivot(psi, alpha, side, t)


def _candidate(pivot: complex, psi: float, frame: float) -> Candidate:
    """The crank-rocker with its crank pivot at 0, its rocker pivot on x."""
    scale = frame / abs(pivot)
    turn = -cmath.phase(-pivot)
    rotation = cmath.exp(1j * turn)

    def placed(z: complex) -> complex:
        return (z - pivot) * rotation * scale

    ends = [placed(cmath.exp(0.5j * s * psi)) for s in (-1.0, 1.0)]
    near, far = sorted(ends, key=abs)
    a = 0.5 * (abs(far) - abs(near))
    pin = a * far / abs(far)  # crank and coupler in one line
    body = cmath.phase(far - pin)
    first = Dyad(PIN, 0j, 0j)
    second = Dyad(PIN, complex(frame), (far - pin) * cmath.exp(-1j * body))
    linkage = linkage_of(first, second, pin, body, tracer=False)
    angles = np.array([cmath.phase(end - frame) for end in (far, near)])
    positions = np.array([cmath.phase(far), cmath.phase(-near)])
    return Candidate(linkage, FOUR_BAR, positions, _end_errors(angles))


def _end_errors(angles: np.ndarray) -> Errors:
    """Errors of the rocker's angle at its ends."""

    def errors(kinematics: Kinematics) -> tuple[np.ndarray, np.ndarray]:
        rocker = kinematics.bodies[body_name(SIDE_LINK)]
        turn = np.angle(np.exp(1j * (rocker.angle[0] - angles)))
        return np.zeros(angles.size), np.abs(np.rad2deg(turn))

    return errors
