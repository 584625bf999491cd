"""Where a flank of a cam crosses itself: two far parts of it may, although every curvature is right."""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np

from core.cam.shape import Flank
from core.frozen import frozen
from core.numerics.vectors import cross

TURN = 2.0 * pi
PANEL = 8  # points
MOST = 1440  # points
PAIRS = 64  # of points: a profile of more is undercut all over
NEAR = 1.25  # two parts may cross where points of them are no farther apart than so many times their steps together
FAR = 1.5  # and part of a bend: along the curve they are apart by more than so many times that
CLOSEST = 1e-5  # [rad] between two points
FINER = 8  # times, around such pairs
STEPS = 24  # of Newton's method
CLOSED = 1e-12  # of the cam's size: two points coincide
DISTINCT = 1e-7  # [rad]

FlankAt = Callable[[np.ndarray], Flank]


@frozen
class Crossing:
    """A place [m] in the cam's own frame where the profile passes twice, at two cam angles [rad], the smaller first."""

    first: float
    second: float
    place: complex


def crossings(flank_at: FlankAt, theta: np.ndarray, place: np.ndarray) -> tuple[Crossing, ...]:
    """All crossings of a closed profile with itself, by cam angle.

    flank_at: the flank at any cam angles; theta: rising (n,) [rad], so dense that the profile bends little between two of them;
    place: its points there (n,) [m]. A profile whose polar angle goes round once, and never back, cannot cross
    itself. Else wherever two of the polyline's steps cross, their ends are no farther apart than the steps are long together: such
    pairs that are not neighbours along the curve are taken where the steps cross, and of those beside each other the nearest;
    there the curve is sampled more densely, and P(θ₁) = P(θ₂) is solved by Newton's method. Of more than ``PAIRS`` such pairs
    those farthest apart by cam angle are taken: the others belong to loops of an undercut.
    """
    alone = np.diff(theta, append=TURN) > CLOSEST
    every = slice(None, None, max(1, -(-int(alone.sum()) // MOST)))
    theta, place = theta[alone][every], place[alone][every]
    turned = np.angle(np.roll(place, -1) * place.conj())
    if ((turned > 0.0).all() or (turned < 0.0).all()) and abs(turned.sum()) < 1.5 * TURN:
        return ()
    i, j = _near(place)
    if not i.size:
        return ()
    if i.size > PAIRS:
        apart = np.abs(theta[i] - theta[j])
        farthest = np.argsort(-np.minimum(apart, TURN - apart), kind="stable")[:PAIRS]
        i, j = i[farthest], j[farthest]
    widest = float(np.diff(theta).max())
    first, second = _closer(flank_at, theta[i], theta[j], widest)
    if not first.size:
        return ()
    return _solved(flank_at, first, second, float(np.abs(place).max()), widest)


def _near(place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of points (m,), (m,) near which the polyline may cross itself."""
    step = np.abs(np.roll(place, -1) - place)
    reach = np.maximum(step, np.roll(step, 1))
    starts = np.arange(0, place.size, PANEL)
    middle = np.add.reduceat(place, starts) / np.diff(np.append(starts, place.size))
    radius = np.maximum.reduceat(np.abs(place - np.repeat(middle, PANEL)[: place.size]) + NEAR * reach, starts)
    one, other = np.nonzero(np.triu(np.abs(middle[:, None] - middle) <= radius[:, None] + radius))
    inside = np.arange(PANEL)
    i = (starts[one][:, None, None] + inside[:, None]) + 0 * inside
    j = (starts[other][:, None, None] + inside) + 0 * inside[:, None]
    valid = (i < j) & (j < place.size)
    i, j = i[valid], j[valid]
    distance = np.abs(place[i] - place[j])
    along = np.append(0.0, np.cumsum(step))
    apart = np.abs(along[i] - along[j])
    apart = np.minimum(apart, along[-1] - apart)
    wanted = (distance <= NEAR * (reach[i] + reach[j])) & (apart > FAR * distance)
    i, j = i[wanted], j[wanted]
    chosen = _nearest(i, j, distance[wanted], place.size) | _steps_cross(place, i, j)
    return i[chosen], j[chosen]


def _steps_cross(place: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Whether the steps from points i and j (m,) of the polyline to the next ones cross each other (m,)."""
    one, other = (place[(k + 1) % place.size] - place[k] for k in (i, j))
    gap, area = place[j] - place[i], cross(one, other)
    with np.errstate(divide="ignore", invalid="ignore"):
        along, across = cross(gap, other) / area, cross(gap, one) / area
    return np.asarray((along >= 0.0) & (along <= 1.0) & (across >= 0.0) & (across <= 1.0))


def _nearest(i: np.ndarray, j: np.ndarray, distance: np.ndarray, size: int) -> np.ndarray:
    """Whether no pair beside a pair (m,) is nearer (m,)."""
    held = dict(zip(zip(i.tolist(), j.tolist(), strict=True), distance.tolist(), strict=True))
    beside = [(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if a or b]
    least = [
        all(held.get(((a + da) % size, (b + db) % size), np.inf) >= d for da, db in beside)
        for (a, b), d in held.items()
    ]
    return np.array(least, dtype=bool)


def _closer(flank_at: FlankAt, first: np.ndarray, second: np.ndarray, widest: float) -> tuple[np.ndarray, np.ndarray]:
    """Cam angles (m,), (m,) to begin Newton's method from: around each pair the curve is sampled once more, ``FINER`` times as
    densely, where two crossings may lie within one step: every place where steps cross, else the nearest points if they all but
    touch."""
    offsets = widest * np.linspace(-1.5, 1.5, 3 * FINER + 1)
    near = np.concatenate((first, second))[:, None] + offsets
    place = flank_at(near.ravel() % TURN).profile.reshape(near.shape)
    one, other = np.split(place, 2)
    own, its = np.diff(one)[:, :, None], np.diff(other)[:, None, :]
    gap, area = other[:, None, :-1] - one[:, :-1, None], cross(own, its)
    with np.errstate(divide="ignore", invalid="ignore"):
        along, across = cross(gap, its) / area, cross(gap, own) / area
    k, a, b = np.nonzero((along >= 0.0) & (along <= 1.0) & (across >= 0.0) & (across <= 1.0))
    distance = np.abs(other[:, None, :] - one[:, :, None]).reshape(first.size, -1)
    touch = distance.min(axis=1) <= np.abs(own).max(axis=(1, 2)) + np.abs(its).max(axis=(1, 2))
    touch[k] = False
    p, q = np.unravel_index(distance.argmin(axis=1), (offsets.size, offsets.size))
    ours = np.concatenate(((first + offsets[p])[touch], first[k] + offsets[a]))
    return ours, np.concatenate(((second + offsets[q])[touch], second[k] + offsets[b]))


def _solved(
    flank_at: FlankAt, first: np.ndarray, second: np.ndarray, size: float, widest: float
) -> tuple[Crossing, ...]:
    """Newton's method on both angles of all pairs at once; what runs together, or does not close, is no crossing."""
    count = first.size
    for _ in range(STEPS):
        flank = flank_at(np.concatenate((first, second)) % TURN)
        place, speed = flank.profile, flank.profile_velocity
        gap = place[count:] - place[:count]
        if (np.abs(gap) <= CLOSED * size).all():
            break
        one, other = speed[:count], speed[count:]
        area = cross(one, other)
        with np.errstate(divide="ignore", invalid="ignore"):  # parallel: no crossing there
            steps = np.array([cross(gap, other) / area, cross(gap, one) / area])
        steps = np.clip(np.nan_to_num(steps), -widest, widest)
        first, second = first + steps[0], second + steps[1]
    first, second = first % TURN, second % TURN
    apart = np.abs(first - second)
    good = (np.abs(gap) <= 16.0 * CLOSED * size) & (np.minimum(apart, TURN - apart) > DISTINCT)
    rows = zip(
        np.minimum(first, second)[good].tolist(),
        np.maximum(first, second)[good].tolist(),
        place[:count][good].tolist(),
        strict=True,
    )
    found: list[Crossing] = []
    for low, high, at in sorted(rows, key=lambda row: row[:2]):
        if not any(abs(low - known.first) < DISTINCT and abs(high - known.second) < DISTINCT for known in found):
            found.append(Crossing(low, high, at))
    return tuple(found)
