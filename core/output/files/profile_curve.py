"""A closed curve of the cam: exact by cam angle, and from a table of the same accuracy by arc length."""

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

# -- curves in closed form -------------------------------------------------------------------------------------


MM = 1e3
STEP = np.deg2rad(1.0)  # widest panel of the table
LEAST_PANELS = 3  # in a piece of the motion
ACCURACY = 1e-13  # of the table, relative to the curve's size
HALVINGS = 8  # at most, of a panel that misses the accuracy
PANEL_ROUNDING = 0.25  # of a panel's error: where halving leaves more than this, the error is rounding
NEWTON_STEPS = 6  # from arc length to cam angle


@frozen(eq=False)
class CurveSamples:
    """A curve at n cam angles.

    Attributes
    ----------
    z : (n,) complex points in the cam's own frame [mm]
    tangent : (n,) complex unit vectors in the direction of rising cam angle
    curvature : (n,) curvature, positive where the curve turns to the left [1/mm]
    speed : (n,) derivative of the arc length by the cam angle [mm/rad]
    """

    z: np.ndarray
    tangent: np.ndarray
    curvature: np.ndarray
    speed: np.ndarray


@frozen(eq=False)
class SpanEnds:
    """Points of a curve at which spans begin or end.

    Attributes
    ----------
    z : (n,) complex points [mm]
    tangent : (n,) complex unit vectors
    s : (n,) arc length from cam angle 0 [mm]
    """

    z: np.ndarray
    tangent: np.ndarray
    s: np.ndarray


ExactCurve = Callable[[Angles], CurveSamples]
"""A curve in closed form."""


def exact_profile(study: Study, flank: int) -> ExactCurve:
    """Profile of one flank of the study's cam, in closed form."""
    rotation_sign = study.sense

    def at(angles: Angles) -> CurveSamples:
        samples = study.at(angles).cam.flanks[flank]
        velocity = samples.profile_velocity * MM
        speed = np.abs(velocity)
        return CurveSamples(
            samples.profile * MM, velocity / speed, -rotation_sign * samples.profile_curvature / MM, speed
        )

    return at


def follower_side(study: Study, flank: int) -> float:
    """Side of the profile on which the follower runs, and with it a cutter: +1 left of its tangent, -1 right."""
    samples = study.at(Angles(np.zeros(1), np.zeros(1, dtype=int))).cam.flanks[flank]
    # at cam angle 0 the cam's own frame is the global one; the normal points to the contact
    return float(np.sign(dot(1j * samples.profile_velocity, -samples.normal))[0])


def offset_curve(exact: ExactCurve, by: float) -> ExactCurve:
    """Curve at a distance ``by`` [mm] to the left of the tangent of another (to the right where negative), z + i by t.

    It is regular where 1 - by·curvature > 0.
    """

    def at(angles: Angles) -> CurveSamples:
        samples = exact(angles)
        stretch = 1.0 - by * samples.curvature
        return CurveSamples(
            samples.z + 1j * by * samples.tangent, samples.tangent, samples.curvature / stretch, samples.speed * stretch
        )

    return at


# -- arc length: Gauss-Lobatto quadrature, whose nodes include both ends and the middle of a panel -------------

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
    """m sections of the curve, each within one piece of the motion.

    Attributes
    ----------
    low, high : (m,) cam angles of both ends [rad]
    piece : (m,) piece of the motion
    lengths : (m, 8) coefficients of the arc length from the panel's start [mm] in x = -1 ... 1
    length : (m,) arc length [mm]
    positions : (m, 6) complex coefficients of z [mm] in s/length = 0 ... 1
    turning : (m,) ∫|curvature| ds [rad]
    error : (m,) distance of the polynomial from the curve in the middle [mm]
    """

    low: np.ndarray
    high: np.ndarray
    piece: np.ndarray
    lengths: np.ndarray
    length: np.ndarray
    positions: np.ndarray
    turning: np.ndarray
    error: np.ndarray

    def __getitem__(self, rows: np.ndarray) -> _Panels:
        return _Panels(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))

    def joined(self, others: _Panels) -> _Panels:
        names = self.__dataclass_fields__
        return _Panels(*(np.concatenate((getattr(self, name), getattr(others, name))) for name in names))


def _panels(exact: ExactCurve, low: np.ndarray, high: np.ndarray, piece: np.ndarray) -> _Panels:
    """Panels with a quintic Hermite polynomial in arc length: point, tangent and curvature are exact at both ends."""
    half = 0.5 * (high - low)
    theta = 0.5 * (low + high)[:, None] + half[:, None] * _NODES
    theta[:, 0], theta[:, -1] = low, high
    samples = exact(Angles(theta.ravel(), np.repeat(piece, _NODES.size)))
    z, tangent, curvature, speed = (
        values.reshape(theta.shape) for values in (samples.z, samples.tangent, samples.curvature, samples.speed)
    )
    lengths = polynomial.polyint((speed * half[:, None] @ _FIT.T).T, lbnd=-1.0).T
    length = lengths.sum(axis=1)
    sides = [
        part
        for end in (0, -1)
        for part in (z[:, end], tangent[:, end] * length, 1j * curvature[:, end] * tangent[:, end] * length**2)
    ]
    positions = np.stack(sides, axis=1) @ _QUINTIC
    middle = lengths[:, 0] / length
    error = np.abs(_horner(positions, middle) - z[:, _MIDDLE])
    turning = polynomial.polyint((np.abs(curvature) * speed * half[:, None] @ _FIT.T).T, lbnd=-1.0).sum(axis=0)
    return _Panels(low, high, piece, lengths, length, positions, np.maximum(turning, 0.0), error)


def _horner(coefficients: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Polynomials (m, k), lowest order first, at x (m,) or (m, j): a row of x belongs to a polynomial."""
    columns = [c.reshape(c.shape + (1,) * (x.ndim - 1)) for c in coefficients.T]
    value = columns[-1]
    for column in columns[-2::-1]:
        value = value * x + column
    return np.asarray(value)


class ProfileCurve:
    """A closed curve over one turn of the cam.

    Attributes
    ----------
    exact : the curve in closed form, by cam angle
    length : arc length of the full curve [mm]
    size : largest distance from the cam centre [mm]
    error : largest error of the table by arc length [mm]
    """

    def __init__(self, exact: ExactCurve, starts: np.ndarray, ends: np.ndarray) -> None:
        """Tabulate the curve over the pieces of the motion, inside which it is smooth.

        Parameters
        ----------
        exact : ExactCurve
        starts, ends : ndarray (p,) [rad]
            Cam angles at which the pieces begin and end.
        """
        self.exact = exact
        low, high, piece = _cut(starts, ends)
        accepted: _Panels | None = None
        before = np.full(low.size, np.inf)  # error of the panel that was halved
        for halving in range(HALVINGS + 1):
            checkpoint()
            panels = _panels(exact, low, high, piece)
            if not halving:
                self.size = float(np.abs(panels.positions[:, 0]).max())
            bad = (
                (panels.error > ACCURACY * self.size) & (panels.error < PANEL_ROUNDING * before) & (halving < HALVINGS)
            )
            good = panels[~bad]
            accepted = good if accepted is None else accepted.joined(good)
            if not bad.any():
                break
            middle = 0.5 * (low[bad] + high[bad])
            low, high = np.concatenate((low[bad], middle)), np.concatenate((middle, high[bad]))
            piece, before = np.tile(piece[bad], 2), np.tile(panels.error[bad], 2)
        assert accepted is not None
        self._panels = accepted[np.lexsort((accepted.low, accepted.piece))]
        self.error = float(self._panels.error.max())
        self._ends = np.cumsum(self._panels.length)
        self._starts = np.append(0.0, self._ends[:-1])
        self._turning = np.append(0.0, np.cumsum(self._panels.turning))
        self.length = float(self._ends[-1])

    # -- by arc length ---------------------------------------------------------------------------------------

    def _panel(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Panel of each arc length [mm], and the position along it, 0 ... 1."""
        s = np.mod(s, self.length)
        panel = np.searchsorted(self._starts, s, side="right") - 1
        return panel, (s - self._starts[panel]) / self._panels.length[panel]

    def at(self, s: np.ndarray) -> np.ndarray:
        """Points at given arc lengths from cam angle 0.

        Parameters
        ----------
        s : ndarray (...) [mm]
            Arc lengths of any size: the curve is periodic.

        Returns
        -------
        ndarray (...) complex [mm]
        """
        panel, x = self._panel(np.ravel(s))
        return _horner(self._panels.positions[panel], x).reshape(np.shape(s))

    def tangent(self, s: np.ndarray) -> np.ndarray:
        """Unit tangents at given arc lengths from cam angle 0.

        Parameters
        ----------
        s : ndarray (...) [mm]
            Arc lengths of any size.

        Returns
        -------
        ndarray (...) complex, dimensionless
        """
        panel, x = self._panel(np.ravel(s))
        slope = _horner(self._panels.positions[panel, 1:] * np.arange(1.0, 6.0), x)
        return (slope / np.abs(slope)).reshape(np.shape(s))

    def ends(self, s: np.ndarray) -> SpanEnds:
        """Points and tangents at arc lengths where spans begin or end.

        Parameters
        ----------
        s : ndarray (n,) [mm]
            Arc lengths from cam angle 0.

        Returns
        -------
        SpanEnds
        """
        return SpanEnds(self.at(s), self.tangent(s), s)

    def theta(self, s: np.ndarray) -> np.ndarray:
        """Cam angles at given arc lengths, by Newton's method.

        Parameters
        ----------
        s : ndarray (n,) [mm]
            Arc lengths from cam angle 0.

        Returns
        -------
        ndarray (n,) [rad]
        """
        panel, x = self._panel(s)
        rows, target = self._panels.lengths[panel], x * self._panels.length[panel]
        x = 2.0 * x - 1.0
        for _ in range(NEWTON_STEPS):
            slope = _horner(rows[:, 1:] * np.arange(1.0, rows.shape[1]), x)
            x = np.clip(x - (_horner(rows, x) - target) / slope, -1.0, 1.0)
        low, high = self._panels.low[panel], self._panels.high[panel]
        return np.asarray(0.5 * (low + high) + 0.5 * (high - low) * x)

    def arc_length(self, theta: np.ndarray) -> np.ndarray:
        """Arc lengths from cam angle 0 at given cam angles.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Cam angles from 0 to 2π.

        Returns
        -------
        ndarray (n,) [mm]
        """
        p = self._panels
        panel = np.clip(np.searchsorted(p.low, theta, side="right") - 1, 0, p.low.size - 1)
        x = np.clip((2.0 * theta - p.low[panel] - p.high[panel]) / (p.high[panel] - p.low[panel]), -1.0, 1.0)
        return np.asarray(self._starts[panel] + _horner(p.lengths[panel], x))

    def end_of_turning(self, s: np.ndarray, turning: float) -> np.ndarray:
        """Arc lengths up to which the tangent turns by an angle, ∫|curvature| ds = turning, at most one turn of the cam ahead.

        Parameters
        ----------
        s : ndarray (n,) [mm]
            Arc lengths from which the angle counts.
        turning : float [rad]

        Returns
        -------
        ndarray (n,) [mm]
        """
        nodes = np.append(0.0, self._ends)
        twice = np.append(nodes, self.length + nodes[1:])
        sums = np.append(self._turning, self._turning[-1] + self._turning[1:])
        rising = sums + EPS * np.arange(sums.size)  # strictly rising, also where the curve is straight
        begin = np.mod(s, self.length)
        end = np.interp(np.interp(begin, twice, rising) + turning, rising, twice)
        return np.asarray(s + np.minimum(end - begin, self.length))


def _cut(starts: np.ndarray, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cam angles of both ends [rad] and piece of equal panels, at most ``STEP`` wide."""
    counts = np.maximum(np.ceil((ends - starts) / STEP), LEAST_PANELS).astype(int)
    piece = np.repeat(np.arange(starts.size), counts)
    part = np.concatenate([np.arange(count) for count in counts])
    step = ((ends - starts) / counts)[piece]
    low = starts[piece] + part * step
    high = np.where(part + 1 == counts[piece], ends[piece], starts[piece] + (part + 1) * step)
    return low, high, piece


# -- hollows that a cutter or roller does not reach -------------------------------------------------------------


POINTS = 8192  # samples of the profile
CUTTER_ROUNDING = 1e-11  # relative to radius and profile: a cutter that enters it by less touches it
RUN, RUNS_AT_ONCE = 64, 512  # points in a run, centres that are compared with all runs at once
WINDOW, WINDOWS = 2048, 3  # points in windows, each smaller than the last, about the sharpest hollow
STEPS = 40  # of Newton's method for the position in which a cutter touches twice
BETWEEN = 4001  # points between both contacts


@frozen
class UncutHollow:
    """A part of the profile that a cutter does not reach.

    Attributes
    ----------
    begin, end : cam angles of both ends [deg]
    uncut : largest distance of this part from the cutter [mm]
    radius : smallest concave radius of curvature of the profile [mm]; infinite where two different parts stop the cutter
    """

    begin: float
    end: float
    uncut: float
    radius: float


def find_uncut_hollow(
    curve: ProfileCurve, exact: ExactCurve, motion: Any, side: float, radius: float
) -> UncutHollow | None:
    """Deepest hollow that a cutter does not reach; None where it touches the profile everywhere.

    In a hollow the path of its centre runs backwards where radius·curvature > 1. Another part of the curve may stop the
    cutter too, where it is nearer to the centre than the radius. The cutter then touches twice, and the largest distance of
    the curve between both contacts from the cutter remains uncut.

    Parameters
    ----------
    curve : ProfileCurve
    exact : ExactCurve
    motion : CompiledMotion
    side : float
        Side of the curve on which the cutter runs: +1 left, -1 right.
    radius : float
        Radius of the cutter [mm].
    """
    sharpest = find_above(lambda angles: side * exact(angles).curvature, motion, 1.0 / radius)
    s = curve.length * np.arange(POINTS) / POINTS
    contacts = _deepest_contacts(curve, s, side, radius)
    if contacts is None and sharpest is None:
        return None
    concave_radius = np.inf if sharpest is None else 1.0 / sharpest.value
    if sharpest is not None:
        middle, width = float(curve.arc_length(np.array([sharpest.theta]))[0]), curve.length / POINTS * 16.0
        for _ in range(WINDOWS):
            if contacts is not None:
                break
            contacts = _deepest_contacts(curve, middle + width * np.linspace(-1.0, 1.0, WINDOW), side, radius)
            width /= 8.0
        if contacts is None:
            angle = float(np.rad2deg(sharpest.theta))
            return UncutHollow(angle, angle, 0.0, concave_radius)
    assert contacts is not None
    angles, centre = _double_contact(
        offset_curve(exact, side * radius), motion, *curve.theta(np.mod(contacts, curve.length))
    )
    begin, end = angles.tolist()
    between = exact(motion.angles(np.linspace(begin, end, BETWEEN))).z
    uncut = float(np.abs(between - centre).max()) - radius
    return UncutHollow(float(np.rad2deg(begin)), float(np.rad2deg(end)), max(uncut, 0.0), concave_radius)


def _deepest_contacts(curve: ProfileCurve, s: np.ndarray, side: float, radius: float) -> tuple[float, float] | None:
    """Approximate arc lengths [mm] of both contacts about the point that the cutter enters deepest; None where it enters none."""
    z = curve.at(s)
    distance, nearest = _nearest(z, z + side * radius * 1j * curve.tangent(s), radius)
    depth = radius - distance
    entered = depth > CUTTER_ROUNDING * (radius + curve.size)
    if not entered.any():
        return None
    count = s.size
    deepest = int(np.argmax(depth))
    from_deepest = np.roll(entered, -deepest)
    ahead = int(np.argmin(from_deepest)) if not from_deepest.all() else count // 2
    back = int(np.argmin(from_deepest[::-1])) if not from_deepest.all() else count // 2
    last, first = deepest + ahead, deepest - back - 1
    pairs = [(index, int(nearest[(index + inwards) % count])) for index, inwards in ((first, 1), (last, -1))]
    step = s[1] - s[0]

    def separation(pair: tuple[int, int]) -> float:
        return abs(float(np.mod((pair[1] - pair[0]) * step + 0.5 * curve.length, curve.length)) - 0.5 * curve.length)

    first_contact, second_contact = max(pairs, key=separation)
    return float(s[0] + first_contact * step), float(s[0] + second_contact * step)


def _nearest(z: np.ndarray, centre: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Distance (n,) [mm] of a cutter's centres (n,) from the nearest of the points z (n,), and the index of that point.

    Both are in order along the curve. A point farther away than the radius does not count, except the one that belongs to
    the centre. Only runs of points whose circle about their mean comes within the radius are compared.
    """
    runs = z.reshape(-1, RUN)
    middle = runs.mean(axis=1)
    reach = np.abs(runs - middle[:, None]).max(axis=1)
    is_near = np.abs(centre[:, None] - middle) < radius + reach
    is_near[np.arange(z.size), np.arange(z.size) // RUN] = True
    distance, nearest = np.empty(z.size), np.empty(z.size, dtype=int)
    for first in range(0, z.size, RUNS_AT_ONCE):
        checkpoint()
        which, run = np.nonzero(is_near[first : first + RUNS_AT_ONCE])
        away = np.abs(runs[run] - centre[first + which, None])
        index = np.argmin(away, axis=1)
        least = away[np.arange(which.size), index]
        order = np.lexsort((least, which))
        best = order[np.searchsorted(which, np.arange(which[-1] + 1))]  # the nearest point of a centre comes first
        part = slice(first, first + best.size)
        distance[part], nearest[part] = least[best], run[best] * RUN + index[best]
    return distance, nearest


def _double_contact(path: ExactCurve, motion: Any, first: float, second: float) -> tuple[np.ndarray, complex]:
    """Cam angles [rad] (2,) of both contacts of a cutter that touches twice, and its centre [mm].

    Its path crosses itself there: Newton's method from the cam angles ``first``, ``second``.
    """
    start = np.array([first, first + float(np.mod(second - first + pi, TURN)) - pi])
    angles = start = np.sort(start)
    reach = 0.25 * float(np.diff(start)[0])
    for _ in range(STEPS):
        samples = path(motion.angles(angles))
        miss, slope = samples.z[1] - samples.z[0], samples.speed * samples.tangent
        turn = float(cross(slope[0], slope[1]))
        if abs(miss) <= CUTTER_ROUNDING * abs(samples.z[0]) or turn == 0.0:  # converged, or parallel
            break
        move = np.array([cross(miss, slope[1]), cross(miss, slope[0])]) / turn
        angles = angles + np.clip(move, -reach, reach)
    if abs(miss) > 1e-9 * abs(samples.z[0]) or not angles[1] - angles[0] > 0.1 * (start[1] - start[0]):
        angles = start  # no crossing nearby: keep the approximation
    return angles, complex(path(motion.angles(angles)).z.mean())
