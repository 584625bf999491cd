"""A closed curve of the cam, exactly by cam angle and, from a table that is as good, by arc length."""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from typing import Any

import numpy as np
from numpy.polynomial import legendre, polynomial

from core.frozen import frozen
from core.motion import EPS, TURN, Angles
from core.motion.extremes import find_above
from core.numerics.derivatives import cross, dot
from core.numerics.lazy import checkpoint
from core.study import Study

# -- A closed curve of the cam, exactly by cam angle and, from a table that is as good, by arc length -----------


MM = 1e3
STEP = np.deg2rad(1.0)  # widest panel of the table
LEAST_PANELS = 3  # of a piece of the motion
ACCURACY = 1e-13  # of the table, relative to the curve's size
HALVINGS = 8  # at most, of a panel that is not as good
PANEL_ROUNDING = 0.25  # of a panel's error: where halving leaves more, that is rounding
NEWTON = 6  # steps from arc length to cam angle


@frozen(eq=False)
class CurveSamples:
    """A curve at n cam angles.

    z          (n,) complex [mm], in the cam's own frame
    tangent    (n,) complex unit vector in the direction of rising cam angle
    curvature  (n,) [1/mm], positive where the curve bends to the left of its tangent
    speed      (n,) [mm/rad], arc length by cam angle
    """

    z: np.ndarray
    tangent: np.ndarray
    curvature: np.ndarray
    speed: np.ndarray


@frozen(eq=False)
class SpanEnds:
    """n points of a curve: z (n,) complex [mm], unit tangent (n,), arc length s (n,) [mm] from cam angle 0."""

    z: np.ndarray
    tangent: np.ndarray
    s: np.ndarray


Exact = Callable[[Angles], CurveSamples]
"""A curve in closed form."""


def profile(study: Study, flank: int) -> Exact:
    """The profile of one flank of the study's cam."""
    sense = study.sense

    def at(angles: Angles) -> CurveSamples:
        there = study.at(angles).cam.flanks[flank]
        velocity = there.profile_velocity * MM
        speed = np.abs(velocity)
        return CurveSamples(there.profile * MM, velocity / speed, -sense * there.profile_curvature / MM, speed)

    return at


def side(study: Study, flank: int) -> float:
    """On which side of the profile the follower runs, and with it a cutter: +1 left of its tangent, -1 right."""
    there = study.at(Angles(np.zeros(1), np.zeros(1, dtype=int))).cam.flanks[flank]
    # at cam angle 0 the cam's own frame is the global one; the normal points to the contact
    return float(np.sign(dot(1j * there.profile_velocity, -there.normal))[0])


def offset(exact: Exact, by: float) -> Exact:
    """The curve beside another, ``by`` [mm] to the left of its tangent, less to the right: z + i by t.

    It runs on while 1 - by·curvature > 0.
    """

    def at(angles: Angles) -> CurveSamples:
        there = exact(angles)
        stretch = 1.0 - by * there.curvature
        return CurveSamples(
            there.z + 1j * by * there.tangent, there.tangent, there.curvature / stretch, there.speed * stretch
        )

    return at


# -- Gauss-Lobatto quadrature: both ends and the middle of a panel are among its nodes ----------------------

_NODES = np.concatenate(([-1.0], legendre.legroots(legendre.legder([0.0] * 6 + [1.0])), [1.0]))
_NODES[3] = 0.0
_FIT = np.linalg.inv(polynomial.polyvander(_NODES, 6))  # values at the nodes -> coefficients in x, -1 ... 1
_MIDDLE = 3
# z, dz/ds, d²z/ds² at both ends of 0 ... 1 -> coefficients of the quintic
_QUINTIC = np.linalg.inv(
    np.array([[1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0], [0, 0, 2, 0, 0, 0],
              [1, 1, 1, 1, 1, 1], [0, 1, 2, 3, 4, 5], [0, 0, 2, 6, 12, 20]], dtype=float)
).T  # fmt: skip


@frozen(eq=False)
class _Panels:
    """m stretches of the curve, each within one piece of the motion.

    low, high  (m,) cam angles [rad];  piece (m,)
    lengths    (m, 8) coefficients of the arc length from the panel's start [mm] in x = -1 ... 1
    length     (m,) [mm]
    places     (m, 6) complex coefficients of z in s/length = 0 ... 1
    turning    (m,) ∫|curvature| ds [rad]
    error      (m,) how far the middle is off [mm]
    """

    low: np.ndarray
    high: np.ndarray
    piece: np.ndarray
    lengths: np.ndarray
    length: np.ndarray
    places: np.ndarray
    turning: np.ndarray
    error: np.ndarray

    def __getitem__(self, rows: np.ndarray) -> _Panels:
        return _Panels(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))

    def joined(self, other: _Panels) -> _Panels:
        names = self.__dataclass_fields__
        return _Panels(*(np.concatenate((getattr(self, name), getattr(other, name))) for name in names))


def _panels(exact: Exact, low: np.ndarray, high: np.ndarray, piece: np.ndarray) -> _Panels:
    """Quintic Hermite in arc length, whose ends have the exact place, tangent and curvature."""
    half = 0.5 * (high - low)
    theta = 0.5 * (low + high)[:, None] + half[:, None] * _NODES
    theta[:, 0], theta[:, -1] = low, high
    there = exact(Angles(theta.ravel(), np.repeat(piece, _NODES.size)))
    z, tangent, curvature, speed = (
        values.reshape(theta.shape) for values in (there.z, there.tangent, there.curvature, there.speed)
    )
    lengths = polynomial.polyint((speed * half[:, None] @ _FIT.T).T, lbnd=-1.0).T
    length = lengths.sum(axis=1)
    sides = [
        part
        for end in (0, -1)
        for part in (z[:, end], tangent[:, end] * length, 1j * curvature[:, end] * tangent[:, end] * length**2)
    ]
    places = np.stack(sides, axis=1) @ _QUINTIC
    middle = lengths[:, 0] / length
    error = np.abs(_horner(places, middle) - z[:, _MIDDLE])
    turning = polynomial.polyint((np.abs(curvature) * speed * half[:, None] @ _FIT.T).T, lbnd=-1.0).sum(axis=0)
    return _Panels(low, high, piece, lengths, length, places, np.maximum(turning, 0.0), error)


def _horner(coefficients: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Polynomials (m, k), lowest order first, each at its own x (m,) or (m, j)."""
    columns = [c.reshape(c.shape + (1,) * (x.ndim - 1)) for c in coefficients.T]
    value = columns[-1]
    for column in columns[-2::-1]:
        value = value * x + column
    return np.asarray(value)


class ProfileCurve:
    """A closed curve over one turn of the cam.

    exact   the curve in closed form, by cam angle
    length  [mm], around
    size    [mm], largest distance from the cam centre
    error   [mm], of the table by arc length
    """

    def __init__(self, exact: Exact, starts: np.ndarray, ends: np.ndarray) -> None:
        """starts, ends: (p,) cam angles [rad] of the pieces of the motion, inside which the curve is smooth."""
        self.exact = exact
        low, high, piece = _cut(starts, ends)
        kept: _Panels | None = None
        before = np.full(low.size, np.inf)  # the error of what a panel is half of
        for halving in range(HALVINGS + 1):
            checkpoint()
            made = _panels(exact, low, high, piece)
            if not halving:
                self.size = float(np.abs(made.places[:, 0]).max())
            bad = (made.error > ACCURACY * self.size) & (made.error < PANEL_ROUNDING * before) & (halving < HALVINGS)
            good = made[~bad]
            kept = good if kept is None else kept.joined(good)
            if not bad.any():
                break
            middle = 0.5 * (low[bad] + high[bad])
            low, high = np.concatenate((low[bad], middle)), np.concatenate((middle, high[bad]))
            piece, before = np.tile(piece[bad], 2), np.tile(made.error[bad], 2)
        assert kept is not None
        self._panels = kept[np.lexsort((kept.low, kept.piece))]
        self.error = float(self._panels.error.max())
        self._ends = np.cumsum(self._panels.length)
        self._starts = np.append(0.0, self._ends[:-1])
        self._turning = np.append(0.0, np.cumsum(self._panels.turning))
        self.length = float(self._ends[-1])

    # -- by arc length ---------------------------------------------------------------------------------------

    def _panel(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Panel of each arc length, and how far along it, 0 ... 1."""
        s = np.mod(s, self.length)
        panel = np.searchsorted(self._starts, s, side="right") - 1
        return panel, (s - self._starts[panel]) / self._panels.length[panel]

    def at(self, s: np.ndarray) -> np.ndarray:
        """Points at arc lengths from cam angle 0 [mm], of any shape; beyond one turn it goes on."""
        panel, x = self._panel(np.ravel(s))
        return _horner(self._panels.places[panel], x).reshape(np.shape(s))

    def tangent(self, s: np.ndarray) -> np.ndarray:
        """Unit tangents, complex, at arc lengths from cam angle 0 [mm], of the same shape."""
        panel, x = self._panel(np.ravel(s))
        slope = _horner(self._panels.places[panel, 1:] * np.arange(1.0, 6.0), x)
        return (slope / np.abs(slope)).reshape(np.shape(s))

    def ends(self, s: np.ndarray) -> SpanEnds:
        """Points and tangents at arc lengths (n,), as spans begin and end there."""
        return SpanEnds(self.at(s), self.tangent(s), s)

    def theta(self, s: np.ndarray) -> np.ndarray:
        """Cam angles [rad] (n,) at arc lengths (n,)."""
        panel, x = self._panel(s)
        rows, wanted = self._panels.lengths[panel], x * self._panels.length[panel]
        x = 2.0 * x - 1.0
        for _ in range(NEWTON):
            slope = _horner(rows[:, 1:] * np.arange(1.0, rows.shape[1]), x)
            x = np.clip(x - (_horner(rows, x) - wanted) / slope, -1.0, 1.0)
        low, high = self._panels.low[panel], self._panels.high[panel]
        return np.asarray(0.5 * (low + high) + 0.5 * (high - low) * x)

    def reached(self, theta: np.ndarray) -> np.ndarray:
        """Arc lengths [mm] (n,) at cam angles (n,) [rad], 0 ... 2π."""
        p = self._panels
        panel = np.clip(np.searchsorted(p.low, theta, side="right") - 1, 0, p.low.size - 1)
        x = np.clip((2.0 * theta - p.low[panel] - p.high[panel]) / (p.high[panel] - p.low[panel]), -1.0, 1.0)
        return np.asarray(self._starts[panel] + _horner(p.lengths[panel], x))

    def turned(self, s: np.ndarray, turning: float) -> np.ndarray:
        """The arc lengths (n,) up to which the tangent turns by so much [rad], either way, from those given (n,); at most one
        turn further."""
        nodes = np.append(0.0, self._ends)
        twice = np.append(nodes, self.length + nodes[1:])
        sums = np.append(self._turning, self._turning[-1] + self._turning[1:])
        rising = sums + EPS * np.arange(sums.size)  # straight stretches turn nothing
        begin = np.mod(s, self.length)
        end = np.interp(np.interp(begin, twice, rising) + turning, rising, twice)
        return np.asarray(s + np.minimum(end - begin, self.length))


def _cut(starts: np.ndarray, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Every piece into equal panels."""
    counts = np.maximum(np.ceil((ends - starts) / STEP), LEAST_PANELS).astype(int)
    piece = np.repeat(np.arange(starts.size), counts)
    part = np.concatenate([np.arange(count) for count in counts])
    step = ((ends - starts) / counts)[piece]
    low = starts[piece] + part * step
    high = np.where(part + 1 == counts[piece], ends[piece], starts[piece] + (part + 1) * step)
    return low, high, piece


# -- whether a cutter, or the roller itself, gets into every hollow of a profile, and what it leaves ------------


POINTS = 8192  # of the profile that are looked at together
CUTTER_ROUNDING = 1e-11  # relative to radius and profile: a cutter so much inside it touches it
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
    entered = depth > CUTTER_ROUNDING * (radius + curve.size)
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
        if abs(miss) <= CUTTER_ROUNDING * abs(here.z[0]) or turn == 0.0:  # both are as well as found
            break
        move = np.array([cross(miss, slope[1]), cross(miss, slope[0])]) / turn
        touches = touches + np.clip(move, -reach, reach)
    if abs(miss) > 1e-9 * abs(here.z[0]) or not touches[1] - touches[0] > 0.1 * (first[1] - first[0]):
        touches = first  # no crossing near: about where it was seen
    return touches, complex(path(program.angles(touches)).z.mean())
