"""The profile of a cam as a closed chain of arcs, with its largest distance from the exact profile."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from core.cam import CamShape
from core.motion import Angles
from core.motion.extremes import Pieces
from core.numerics.derivatives import cross, dot

FIRST = np.deg2rad(15.0)  # [rad] of the cam between the first joints
DEVIATION = 1e-7  # [m] at which spans are no longer halved
HALVINGS = 8
PARTS = np.linspace(0.0, 1.0, 9)[1:-1]  # of a span, at which its deviation is measured
MARGIN = 1.25  # of the deviation, which is measured at a few angles


class ArcChain(NamedTuple):
    """A closed chain of arcs, counter-clockwise or clockwise.

    Attributes
    ----------
    start, end : ndarray (k,) complex [m]
    bulge : ndarray (k,), dimensionless
        Tangent of a quarter of the sweep, positive where the arc turns left.
    deviation : float [m]
        Largest distance from the exact curve.
    """

    start: np.ndarray
    end: np.ndarray
    bulge: np.ndarray
    deviation: float


def profile_arcs(shape_at: Callable[[Angles], CamShape], turn: Pieces) -> ArcChain:
    """Chain of pairs of arcs through points of the first flank, with its tangents there.

    Of all pairs of arcs with a common tangent, those with equally long tangents d to their joint: with v = q - p and t = t₁ + t₂,
    d = v²/(v·t + √((v·t)² + 2(1 - t₁·t₂)v²)).

    Parameters
    ----------
    shape_at : callable
        Angles -> CamShape.
    turn : Pieces
        Pieces of the motion.

    Returns
    -------
    ArcChain
    """
    counts = np.maximum(np.ceil((turn.ends - turn.starts) / FIRST), 1.0).astype(int)
    ends = [np.linspace(*row) for row in zip(turn.starts, turn.ends, (counts + 1).tolist(), strict=True)]
    low, high = (np.concatenate([row[part] for row in ends]) for part in (slice(None, -1), slice(1, None)))
    piece = np.repeat(np.arange(counts.size), counts)
    done: list[tuple[np.ndarray, ...]] = []
    for halving in range(HALVINGS + 1):
        rows, deviation = _biarcs(shape_at, low, high, piece)
        ready = (deviation <= DEVIATION) if halving < HALVINGS else np.ones(low.size, dtype=bool)
        done.append((low[ready], *(row[:, ready] for row in rows), deviation[ready]))
        low, high, piece = low[~ready], high[~ready], piece[~ready]
        if not low.size:
            break
        middle = 0.5 * (low + high)
        low, high, piece = np.concatenate((low, middle)), np.concatenate((middle, high)), np.tile(piece, 2)
    at, start, end, bulge, deviation = (np.concatenate(rows, axis=-1) for rows in zip(*done, strict=True))
    order = np.argsort(at)
    starts, ends_of_arcs, bulges = (row[:, order].T.ravel() for row in (start, end, bulge))
    return ArcChain(starts, ends_of_arcs, bulges, MARGIN * float(deviation.max()))


def _biarcs(
    shape_at: Callable[[Angles], CamShape], low: np.ndarray, high: np.ndarray, piece: np.ndarray
) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
    """Starts, ends and bulges (2, m) of the pairs of arcs of spans (m,), and their deviations (m,) [m]."""
    parts = np.array([0.0, *PARTS, 1.0])
    theta = low + (high - low) * parts[:, None]
    shape = shape_at(Angles(theta.ravel(), np.tile(piece, parts.size)))
    z = shape.flank.profile.reshape(theta.shape)
    normal = np.broadcast_to(shape.flank.normal, theta.size).reshape(theta.shape)
    tangent = 1j * normal * np.exp(-1j * shape.rotation_sign * theta)
    p, q, first, last = z[0], z[-1], tangent[0], tangent[-1]
    first, last = (t * np.where(dot(t, q - p) < 0.0, -1.0, 1.0) for t in (first, last))
    joint, bulges = _joint(p, q, first, last)
    start, end = np.array([p, joint]), np.array([joint, q])
    deviation = np.zeros(p.size)
    before = dot(z[1:-1] - joint, last + first) < 0.0
    for number, of_arc in enumerate((before, ~before)):
        distance = _circle_distance(start[number], end[number], bulges[number], z[1:-1])
        deviation = np.maximum(deviation, np.where(of_arc, distance, 0.0).max(axis=0))
    return (start, end, bulges), deviation


def _joint(p: np.ndarray, q: np.ndarray, first: np.ndarray, last: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Joints (m,) [m] of pairs of arcs, and the bulges (2, m) of both."""
    v, t = q - p, first + last
    square, along = dot(v, v), dot(v, t)
    root = along + np.sqrt(along * along + 2.0 * np.maximum(1.0 - dot(first, last), 0.0) * square)
    d = square / np.where(root > 0.0, root, np.inf)
    joint = 0.5 * (p + q + d * (first - last))
    return joint, np.array([_bulge(p, joint, first), -_bulge(q, joint, -last)])


def _bulge(p: np.ndarray, q: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """Bulge of the arc from p to q that starts along a tangent, tan(δ/2) with the angle δ from tangent to chord."""
    chord = q - p
    base = np.abs(tangent) * np.abs(chord) + dot(tangent, chord)
    return np.asarray(cross(tangent, chord) / np.where(base > 0.0, base, np.inf))


def _circle_distance(p: np.ndarray, q: np.ndarray, bulge: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Distance of points (..., m) from the circles of arcs (m,) [m]: |b(x² + y² - x) - ½(1 - b²)y|/|∇| in the chord's frame."""
    chord = np.where(q != p, q - p, 1.0)
    w = (z - p) / chord
    x, y = w.real, w.imag
    value = bulge * (x * x + y * y - x) - 0.5 * (1.0 - bulge**2) * y
    slope = np.hypot(bulge * (2.0 * x - 1.0), 2.0 * bulge * y - 0.5 * (1.0 - bulge**2))
    # the exact distance from a circle: 2 value/(slope + √(slope² - 4 b value))
    root = np.sqrt(np.maximum(slope**2 - 4.0 * bulge * value, 0.0))
    return np.abs(chord) * np.abs(2.0 * value) / (slope + root)
