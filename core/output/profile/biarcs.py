"""Circular arcs: two of them that join two points with given tangents, distances from them, arcs of one circle made one.

An arc is given as DXF gives it: by its ends p, q and its bulge b = tan(turn/4), positive where it turns left; 0 is a line.
"""

from __future__ import annotations

from cmath import phase
from math import atan, pi, tan

import numpy as np

from core.numerics.vectors import cross, dot

SAME_TURN = 1e-9  # relative: half a turn may be so much more
SAME_TANGENT = 1e-11  # [rad] and
SAME_PLACE = 1e-12  # relative: arcs of one circle may be this far from it


def bulge(p: np.ndarray, q: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """Bulge (n,) of the arc from p to q that starts along the tangent (n,): the turn is twice the angle between tangent and
    chord."""
    chord = q - p
    # tan(δ/2) of the angle δ from tangent to chord
    along = dot(tangent, chord)
    return cross(tangent, chord) / (np.abs(tangent) * np.abs(chord) + along)


def biarc(
    p: np.ndarray, q: np.ndarray, start: np.ndarray, end: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Two arcs with a common tangent where they join: from p along ``start`` to q along ``end``, unit tangents (n,).

    Of all such pairs the one whose tangents, drawn on to where they meet the common one, are equally long (d):
    v = q - p, t = start + end, d = v² / (v·t + √((v·t)² + 2(1 - start·end)v²)); they join at (p + q + d(start - end))/2.
    Returns the joint and both bulges (n,).
    """
    v, t = q - p, start + end
    square, along = dot(v, v), dot(v, t)
    d = square / (along + np.sqrt(along * along + 2.0 * np.maximum(1.0 - dot(start, end), 0.0) * square))
    joint = 0.5 * (p + q + d * (start - end))
    return joint, bulge(p, joint, start), -bulge(q, joint, -end)


def distance(p: np.ndarray, q: np.ndarray, b: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Distance of points z from arcs; all of one shape, or made so.

    In the chord's frame, p = 0 and q = 1, the arc's circle is b(x² + y² - x) - (1 - b²)y/2 = 0, also where it is a line.
    """
    chord = q - p
    size = np.abs(chord)
    with np.errstate(invalid="ignore", divide="ignore"):
        local = (z - p) / chord
    x, y = local.real, local.imag
    level = b * (x * x + y * y - x) - 0.5 * (1.0 - b * b) * y
    from_centre = np.hypot(b * (x - 0.5), b * y - 0.25 * (1.0 - b * b))
    off = np.abs(level) / (0.25 * (1.0 + b * b) + from_centre)
    # beside the arc: seen from the centre the point lies between its ends; a centre at infinity sees x
    inside = _between(x, y, b)
    ends = np.minimum(np.abs(z - p), np.abs(z - q))
    return np.where(inside & (size > 0.0), off * size, ends)


def _between(x: np.ndarray, y: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Whether points of the chord's frame lie in the sector of the arc: on its side of both normals at its ends, for arcs of at
    most half a turn."""
    cosine, sine = 1.0 - b * b, 2.0 * b  # of half the turn, times 1 + b²; the tangents are turned by it from the chord
    return (x * cosine - y * sine >= 0.0) & ((1.0 - x) * cosine - y * sine >= 0.0)


def joined(p: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A closed chain of arcs, from p_i (n,) to the next, with neighbours of one circle made one, of at most half a turn.

    Between arcs of one circle there is no tangent break, and none comes of it. The first point stays.
    """
    size = float(np.abs(p).max())
    ends, bulges = np.roll(p, -1).tolist(), b.tolist()
    done: list[tuple[complex, complex, float]] = []
    for start, end, turn in zip(p.tolist(), ends, bulges, strict=True):
        whole = _one(*done[-1], end, turn, size) if done else None
        if whole is None:
            done.append((start, end, turn))
        else:
            done[-1] = (done[-1][0], end, whole)
    return np.array([start for start, _, _ in done]), np.array([turn for _, _, turn in done])


def _one(p: complex, middle: complex, first: float, q: complex, second: float, size: float) -> float | None:
    """Bulge of the arc from p over the middle to q, where both halves lie on it; None where they do not, or it would be more
    than half a turn."""
    half = atan(first) + atan(second)  # of the whole turn, a quarter of it each
    if p == q or abs(half) > 0.25 * pi * (1.0 + SAME_TURN):
        return None
    whole = tan(half)
    off = float(distance(np.array(p), np.array(q), np.array(whole), np.array(middle)))
    # the chord seen from both tangents: the turn that the whole arc must have
    starts = phase((middle - p) / (q - p)) - 2.0 * atan(first) + 2.0 * half
    ends = phase((q - middle) / (q - p)) + 2.0 * atan(second) - 2.0 * half
    return whole if off <= SAME_PLACE * size and max(abs(starts), abs(ends)) <= SAME_TANGENT else None
