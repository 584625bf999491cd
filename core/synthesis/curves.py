"""Coupler curves: of one four-bar in closed form, and a list of sampled ones with descriptors by which similar curves are found.

The descriptor of a closed curve are the complex Fourier coefficients ±1 … ±8 of its points, evenly spaced by length, turned and shifted
so that those of ±1 are real and positive: position, size, direction and first point do not matter.

Source: J. R. McGarva, G. Mullineux, *Harmonic representation of closed curves*, Appl. Math. Modelling 17 (1993) 213-218.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from core.frozen import frozen

SAMPLES = 64  # points of a curve, evenly by length
CURVES = 20_000
ANGLES = 96  # crank angles at which a curve is traced
HARMONICS = 8
LONGEST = 5.0  # of the crank: links of sampled four-bars
FARTHEST = 1.5  # of the coupler: tracer of sampled four-bars, from the coupler's middle
MARGIN = 0.05  # of the crank: sampled four-bars stay clear of change points


class Bars(NamedTuple):
    """Four-bars, as numbers or arrays.

    The tracer is u + iv from the crank's pin, u along the coupler; the side of the assembly is ±1.
    """

    crank: Any
    coupler: Any
    rocker: Any
    frame: Any
    tracer: Any
    side: Any


def trace(bars: Bars, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Tracer of a four-bar whose crank's pivot is 0 and whose frame is along x, its derivative, and the coupler's direction.

    Parameters
    ----------
    bars : Bars
        Numbers, or arrays that broadcast with the angles [mm].
    angle : ndarray (..., n) [rad]
        Angles of the crank.

    Returns
    -------
    tuple of ndarray (..., n) complex [mm], [mm/rad], dimensionless
        NaN where the links do not meet.
    """
    unit = np.exp(1j * angle)
    pin = bars.crank * unit
    across = bars.frame - pin
    square = np.abs(across) ** 2
    along = 0.5 * (square + bars.coupler**2 - bars.rocker**2)
    with np.errstate(invalid="ignore", divide="ignore"):
        height = np.sqrt(bars.coupler**2 * square - along**2)
        direction = across * (along + 1j * bars.side * height) / (square * bars.coupler)
        rocker = pin + bars.coupler * direction - bars.frame
        speed = 1j * pin
        turn = -(np.conj(rocker) * speed).real / (np.conj(rocker) * 1j * bars.coupler * direction).real
        return pin + bars.tracer * direction, speed + 1j * turn * bars.tracer * direction, direction


@frozen(eq=False)
class SampledCurves:
    """Coupler curves of many four-bars with a crank of length 1 that turns fully.

    Attributes
    ----------
    bars : Bars
        Arrays (m,).
    points : ndarray (m, SAMPLES) complex
        Points evenly spaced by length.
    angles : ndarray (m, SAMPLES) [rad]
        Angles of the crank there.
    descriptors : ndarray (m, 2 HARMONICS) complex
    """

    bars: Bars
    points: np.ndarray
    angles: np.ndarray
    descriptors: np.ndarray


@lru_cache(maxsize=1)
def sampled_curves() -> SampledCurves:
    """The list of coupler curves, the same one in every run."""
    generator = np.random.default_rng(1)
    bars = _random_bars(generator, CURVES)
    angles = np.linspace(0.0, 2.0 * np.pi, ANGLES + 1)
    rows, at = [], []
    for first in range(0, CURVES, 2000):
        part = Bars(*(values[first : first + 2000, None] for values in bars))
        points, _, _ = trace(part, angles)
        even, where = evenly_spaced(points, np.broadcast_to(angles, points.shape), SAMPLES)
        rows.append(even)
        at.append(where)
    points, where = np.concatenate(rows), np.concatenate(at)
    return SampledCurves(bars, points, where, descriptor(points))


def _random_bars(generator: np.random.Generator, count: int) -> Bars:
    """Four-bars with a crank of length 1 that turns fully: crank-rockers and double cranks, clear of change points."""
    parts: list[np.ndarray] = []
    size = 0
    while size < count:
        lengths = 1.0 + (LONGEST - 1.0) * generator.random((4 * count, 3))
        lengths = np.where(generator.random((4 * count, 1)) < 0.1, lengths * [1.0, 1.0, 0.2], lengths)  # shorter frames
        coupler, rocker, frame = lengths.T
        outer, inner = frame + 1.0, np.abs(frame - 1.0)
        turns = (outer < coupler + rocker - MARGIN) & (inner > np.abs(coupler - rocker) + MARGIN)
        parts.append(lengths[turns])
        size += int(turns.sum())
    coupler, rocker, frame = np.concatenate(parts)[:count].T
    radius, turn = FARTHEST * np.sqrt(generator.random(count)), 2.0 * np.pi * generator.random(count)
    tracer = coupler * (0.5 + radius * np.exp(1j * turn))
    return Bars(np.ones(count), coupler, rocker, frame, tracer, np.ones(count))


def evenly_spaced(
    points: np.ndarray, angles: np.ndarray, count: int, *, closed: bool = True
) -> tuple[np.ndarray, np.ndarray]:
    """Points evenly spaced by length along curves.

    Parameters
    ----------
    points : ndarray (m, n) complex [mm]
    angles : ndarray (m, n) [rad]
        Rising parameter of the points.
    count : int
    closed : bool
        The last point of a curve repeats the first, and is left out.

    Returns
    -------
    points : ndarray (m, count) complex [mm]
    angles : ndarray (m, count) [rad]
    """
    length = np.zeros(points.shape)
    np.cumsum(np.abs(np.diff(points, axis=1)), axis=1, out=length[:, 1:])
    total = length[:, -1:]
    at = total * np.arange(count) / (count if closed else count - 1)
    # all rows in one search: each row is shifted behind the one before it
    shift = 2.0 * np.arange(points.shape[0])[:, None]
    flat = (length / total + shift).ravel()
    index = np.searchsorted(flat, (at / total + shift).ravel(), side="right") - 1
    index = np.minimum(index, flat.size - 2)
    part = ((at / total + shift).ravel() - flat[index]) / np.where(
        flat[index + 1] > flat[index], flat[index + 1] - flat[index], 1.0
    )
    z, a = points.ravel(), angles.ravel()
    even = z[index] + part * (z[index + 1] - z[index])
    where = a[index] + part * (a[index + 1] - a[index])
    return even.reshape(points.shape[0], count), where.reshape(points.shape[0], count)


def descriptor(points: np.ndarray) -> np.ndarray:
    """Descriptor of closed curves.

    Parameters
    ----------
    points : ndarray (m, n) complex [mm]
        Evenly spaced by length, in either direction.

    Returns
    -------
    ndarray (m, 2 HARMONICS) complex, dimensionless
        Coefficients 1 … HARMONICS, then -1 … -HARMONICS, of a curve that is passed so that the first one is the larger.
    """
    coefficients = np.fft.fft(points, axis=-1) / points.shape[-1]
    orders = np.arange(1, HARMONICS + 1)
    forward, backward = coefficients[:, orders], coefficients[:, -orders]
    swap = np.abs(backward[:, 0]) > np.abs(forward[:, 0])
    forward, backward = (
        np.where(swap[:, None], backward, forward),
        np.where(swap[:, None], forward, backward),
    )
    first, second = np.angle(forward[:, 0]), np.angle(backward[:, 0])
    turn, shift = -0.5 * (first + second), -0.5 * (first - second)
    factor = np.exp(1j * (turn[:, None] + orders * shift[:, None]))
    other = np.exp(1j * (turn[:, None] - orders * shift[:, None]))
    rows = np.concatenate((forward * factor, backward * other), axis=1)
    rows /= np.linalg.norm(rows, axis=1)[:, None]
    return rows


def nearest_descriptors(rows: np.ndarray, target: np.ndarray, count: int) -> list[tuple[int, bool]]:
    """Curves with the descriptors nearest to that of a target, or of its mirror image.

    Turn and shift are defined up to π of both, so that two descriptors describe a curve.

    Parameters
    ----------
    rows : ndarray (m, 2 HARMONICS) complex, dimensionless
    target : ndarray (2 HARMONICS,) complex, dimensionless
    count : int

    Returns
    -------
    list of (int, bool)
        Index of a curve, and whether its mirror image is similar to the target; the most similar first.
    """
    orders = np.arange(1, HARMONICS + 1)
    half_turn = np.tile((-1.0) ** (orders + 1), 2)
    rated = []
    for mirrored in (False, True):
        wanted = np.conj(target) if mirrored else target
        distance = np.minimum(*(np.linalg.norm(rows - wanted * sign, axis=1) for sign in (1.0, half_turn)))
        rated += [(float(distance[i]), int(i), mirrored) for i in np.argpartition(distance, count)[:count]]
    return [(i, mirrored) for _, i, mirrored in sorted(rated)[:count]]


def similar(points: np.ndarray, target: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Similarity of curves to a target, point by point: scale and turn α, shift β, and relative error of α z + β.

    Parameters
    ----------
    points : ndarray (..., n) complex [mm]
    target : ndarray (n,) complex [mm]

    Returns
    -------
    tuple of ndarray (...) complex, dimensionless, [mm] and dimensionless
    """
    mean, middle = points.mean(axis=-1, keepdims=True), target.mean()
    centred, wanted = points - mean, target - middle
    square = (np.abs(centred) ** 2).sum(axis=-1)
    inner = (np.conj(centred) * wanted).sum(axis=-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        alpha = inner / square
        error = 1.0 - np.abs(inner) ** 2 / (square * (np.abs(wanted) ** 2).sum())
    return alpha, middle - alpha * mean[..., 0], error
