"""Whether a cutter, or the roller itself, gets into every hollow of a profile, and what it leaves standing where it does not."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

from core.frozen import frozen
from core.motion import TURN
from core.motion.extremes import find_above
from core.numerics.cancellation import checkpoint
from core.numerics.vectors import cross
from core.output.profile.curve import Exact, ProfileCurve, offset

POINTS = 8192  # of the profile that are looked at together
ROUNDING = 1e-11  # relative to radius and profile: a cutter so much inside it touches it
RUN, RUNS_AT_ONCE = 64, 512  # points that are looked through together, centres for which they are
WINDOW, WINDOWS = 2048, 3  # points of ever closer looks at a hollow too small to be seen
STEPS = 40  # of the search for the place where a cutter touches twice
BETWEEN = 4001  # points between its touches


@frozen
class UncutHollow:
    """Where a cutter does not get in: cam angles [deg] at both ends of the part that it cannot touch, the largest distance that
    is left standing there [mm], and the profile's smallest concave radius of curvature [mm], infinite where the cutter is held up
    by two different parts."""

    begin: float
    end: float
    left: float
    radius: float


def hollow(curve: ProfileCurve, exact: Exact, program: Any, side: float, radius: float) -> UncutHollow | None:
    """The worst place where a cutter of this radius [mm], running on that side of the curve (+1 left), does not touch it; None
    where it touches everywhere.

    In a hollow its centre's path runs backwards where radius·curvature > 1; and wherever another part of the curve is nearer to
    the centre than the radius, the cutter is held up before it touches. Between its two touches there what is left is the
    largest distance from the cutter.
    """
    sharpest = find_above(lambda angles: side * exact(angles).curvature, program, 1.0 / radius)
    s = curve.length * np.arange(POINTS) / POINTS
    found = _seen(curve, s, side, radius)
    if found is None and sharpest is None:
        return None
    bend = np.inf if sharpest is None else 1.0 / sharpest.value
    if sharpest is not None:
        middle, width = float(curve.reached(np.array([sharpest.theta]))[0]), curve.length / POINTS * 16.0
        for _ in range(WINDOWS):
            if found is not None:
                break
            found = _seen(curve, middle + width * np.linspace(-1.0, 1.0, WINDOW), side, radius)
            width /= 8.0
        if found is None:
            angle = float(np.rad2deg(sharpest.theta))
            return UncutHollow(angle, angle, 0.0, bend)
    assert found is not None
    touches, centre = _touches(offset(exact, side * radius), program, *curve.theta(np.mod(found, curve.length)))
    begin, end = touches.tolist()
    between = exact(program.angles(np.linspace(begin, end, BETWEEN))).z
    left = float(np.abs(between - centre).max()) - radius
    return UncutHollow(float(np.rad2deg(begin)), float(np.rad2deg(end)), max(left, 0.0), bend)


def _seen(curve: ProfileCurve, s: np.ndarray, side: float, radius: float) -> tuple[float, float] | None:
    """About where the cutter touches on both sides of the part that it enters deepest, of points at arc lengths s (n,); None
    where it enters nothing."""
    z = curve.at(s)
    distance, nearest = _nearest(z, z + side * radius * 1j * curve.tangent(s), radius)
    depth = radius - distance
    entered = depth > ROUNDING * (radius + curve.size)
    if not entered.any():
        return None
    count = s.size
    # from the deepest point to either side, as far as the cutter enters
    away = np.roll(entered, -int(np.argmax(depth)))
    ahead = int(np.argmin(away)) if not away.all() else count // 2
    back = int(np.argmin(away[::-1])) if not away.all() else count // 2
    last, first = int(np.argmax(depth)) + ahead, int(np.argmax(depth)) - back - 1
    pairs = [(place, int(nearest[(place + inwards) % count])) for place, inwards in ((first, 1), (last, -1))]
    step = s[1] - s[0]

    def apart(pair: tuple[int, int]) -> float:
        return abs(float(np.mod((pair[1] - pair[0]) * step + 0.5 * curve.length, curve.length)) - 0.5 * curve.length)

    one, other = max(pairs, key=apart)
    return float(s[0] + one * step), float(s[0] + other * step)


def _nearest(z: np.ndarray, centre: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Distance (n,) of each centre (n,) from the nearest of the points z (n,) in their order along a curve, and which that is; no
    point farther away than the radius counts, but its own, which is so far away.

    Only runs of points are looked through whose circle about their middle comes within the radius.
    """
    runs = z.reshape(-1, RUN)
    middle = runs.mean(axis=1)
    reach = np.abs(runs - middle[:, None]).max(axis=1)
    near = np.abs(centre[:, None] - middle) < radius + reach
    near[np.arange(z.size), np.arange(z.size) // RUN] = True
    distance, nearest = np.empty(z.size), np.empty(z.size, dtype=int)
    for first in range(0, z.size, RUNS_AT_ONCE):
        checkpoint()
        which, run = np.nonzero(near[first : first + RUNS_AT_ONCE])
        away = np.abs(runs[run] - centre[first + which, None])
        place = np.argmin(away, axis=1)
        least = away[np.arange(which.size), place]
        order = np.lexsort((least, which))
        best = order[np.searchsorted(which, np.arange(which[-1] + 1))]  # the first of each centre
        part = slice(first, first + best.size)
        distance[part], nearest[part] = least[best], run[best] * RUN + place[best]
    return distance, nearest


def _touches(path: Exact, program: Any, one: float, other: float) -> tuple[np.ndarray, complex]:
    """Both cam angles [rad] (2,) at which the cutter touches when it stands so deep that it touches twice, near the angles
    given, and its centre there [mm]: where its path crosses itself, by Newton's method."""
    first = np.array([one, one + float(np.mod(other - one + pi, TURN)) - pi])
    touches = first = np.sort(first)
    reach = 0.25 * float(np.diff(first)[0])
    for _ in range(STEPS):
        here = path(program.angles(touches))
        miss, slope = here.z[1] - here.z[0], here.speed * here.tangent
        turn = float(cross(slope[0], slope[1]))
        if abs(miss) <= ROUNDING * abs(here.z[0]) or turn == 0.0:  # both are as well as found
            break
        move = np.array([cross(miss, slope[1]), cross(miss, slope[0])]) / turn
        touches = touches + np.clip(move, -reach, reach)
    if abs(miss) > 1e-9 * abs(here.z[0]) or not touches[1] - touches[0] > 0.1 * (first[1] - first[0]):
        touches = first  # no crossing near: about where it was seen
    return touches, complex(path(program.angles(touches)).z.mean())
