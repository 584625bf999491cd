"""Four-bars whose coupler traces a path: sampled curves that are similar, refined by least squares, with their cognates.

Source: F. Freudenstein, G. N. Sandor, *Synthesis of path-generating mechanisms*, Trans. ASME 81 (1959) 159-168, for the unknowns;
S. Roberts, *Three-bar motion in plane space*, Proc. London Math. Soc. 7 (1875) 14-23, for the cognates.
"""

from __future__ import annotations

import cmath
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from core.errors import DesignError
from core.numerics.lazy import checkpoint
from core.synthesis.candidates import FOUR_BAR, Candidate, linkage_of
from core.synthesis.curves import SAMPLES, Bars, descriptor, evenly_spaced, nearest_descriptors, sampled_curves, similar
from core.synthesis.dyads import PIN, Dyad
from core.synthesis.fitting import PathFit, PlacedBars, distinct
from core.synthesis.judge import position_errors
from core.synthesis.task import Task, point_faults, task_size

SIMILAR, STEPS, BEST = 300, 100, 12
"""Curves that are placed over the path, steps of their refinement, and different four-bars that are proposed."""
MOST_FITTED = 48
"""Points of a path that are fitted; of more, evenly chosen ones."""
OPEN_CURVES, OPEN_POINTS = 5000, 16
WINDOWS = (0.12, 0.2, 0.32, 0.5, 0.75)
"""Lengths of the parts of closed curves that are compared with an open path."""
BEST_OF_WINDOW = 4
"""Curves that are retained from each comparison."""
WIDEST_RATIO = 8.0
"""Ratio of the longest to the shortest link within which four-bars are refined, where the task has no limit of it."""
NEAREST, NEAREST_STEPS = 720, 6
"""Positions of the crank from which the nearest point of a curve is refined, and steps of it."""
LEAST_COGNATE = 1e-6  # of a four-bar: the size of its cognates


def with_points(task: Task) -> Task:
    """The task with the points of its file in place of the file.

    Raises
    ------
    FileError
        The file cannot be read.
    DesignError
        The points of the file are no path.
    """
    if task.path is None or not task.path.file:
        return task
    from core.synthesis.path_points import read_path  # imported here to save start-up time

    path = task.path
    drawn = read_path(task.folder / path.file, closed=path.closed, point=path.point)
    if faults := list(point_faults(task, [point.z for point in drawn.points])):
        raise DesignError(faults)
    return replace(task, path=replace(path, file="", point="", points=drawn.points, closed=drawn.closed))


def _points(task: Task) -> list[complex]:
    assert task.path is not None
    return [point.z for point in task.path.points]


def size(task: Task) -> float:
    """Size of a task's path [mm]."""
    return task_size(_points(task))


def candidates(task: Task) -> Iterator[tuple[Candidate, ...]]:
    """Four-bars for the path of a task with points, the best fit first."""
    path = task.path
    assert path is not None
    points = np.array(_points(task))
    fitted = np.unique(np.linspace(0, points.size - 1, min(points.size, MOST_FITTED)).round().astype(int))
    timing = np.deg2rad(np.array(path.driver_deg)) if path.driver_deg else None
    weights = np.sqrt(np.array(path.weights) / max(path.weights)) if path.weights else np.ones(points.size)
    part, ratio = None if timing is None else timing[fitted], task.longest_to_shortest or WIDEST_RATIO
    fit = PathFit(points[fitted], weights[fitted], part, ratio)
    starts = _closed_starts(points) if path.closed else _open_starts(points)
    placed, squares = fit.refined(starts.with_angles(starts.angles[:, fitted]), STEPS)
    placed = placed.rows([i for i in np.argsort(squares).tolist() if np.isfinite(squares[i])])
    rows = (_at_all(placed.rows([i]), points, timing) for i in distinct(placed, BEST))
    yield from sorted((_driven(row, points, timing is not None) for row in rows), key=lambda driven: driven[0].expected)


# -- starts -----------------------------------------------------------------------------------------------------


class _Similar(NamedTuple):
    """A curve of the list that is similar to a path by α z + β, mirrored or not, and the crank's angles along it."""

    error: float
    curve: int
    mirrored: bool
    alpha: complex
    beta: complex
    angles: np.ndarray


def _closed_starts(points: np.ndarray) -> PlacedBars:
    """Four-bars with the most similar closed curves, placed over the points."""
    even, at = _spaced(points, SAMPLES, closed=True)
    curves = sampled_curves()
    rated = []
    for index, mirrored in nearest_descriptors(curves.descriptors, descriptor(even[None])[0], SIMILAR):
        z = np.conj(curves.points[index]) if mirrored else curves.points[index]
        for step in (1, -1):
            order = (np.arange(SAMPLES)[:, None] + step * np.arange(SAMPLES)) % SAMPLES  # all first points
            alpha, beta, error = similar(z[order], even)
            best = int(np.argmin(error))
            angles = np.unwrap(curves.angles[index][order[best]])
            angles = np.append(angles, angles[0] + np.sign(angles[1] - angles[0]) * 2.0 * np.pi)
            rated.append(_Similar(error[best], index, mirrored, alpha[best], beta[best], angles))
    return _placed(rated, at)


def _open_starts(points: np.ndarray) -> PlacedBars:
    """Four-bars of which a part of the curve is most similar to an open path."""
    even, at = _spaced(points, OPEN_POINTS, closed=False)
    curves = sampled_curves()
    z, crank = curves.points[:OPEN_CURVES], curves.angles[:OPEN_CURVES]
    rated = []
    for window in WINDOWS:
        checkpoint()
        inside = window * SAMPLES * np.arange(OPEN_POINTS) / (OPEN_POINTS - 1)
        for first in range(0, SAMPLES, 2):
            index = (first + np.round(inside).astype(int)) % SAMPLES
            for mirrored in (False, True):
                part = np.conj(z[:, index]) if mirrored else z[:, index]
                for step in (1, -1):
                    alpha, beta, error = similar(part, even[::step])
                    for k in np.argpartition(error, BEST_OF_WINDOW)[:BEST_OF_WINDOW]:
                        angles = np.unwrap(crank[k][index[::step]])
                        rated.append(_Similar(error[k], int(k), mirrored, alpha[k], beta[k], angles))
    return _placed(rated, at)


def _spaced(points: np.ndarray, count: int, closed: bool) -> tuple[np.ndarray, np.ndarray]:
    """Points (count,) evenly spaced by length along a smooth curve through the given ones, and the part of the length of each of these."""
    from scipy.interpolate import CubicSpline  # imported here to save start-up time

    z = np.append(points, points[0]) if closed else points
    z = z[np.append(True, np.abs(np.diff(z)) > 0.0)]
    chord = np.append(0.0, np.cumsum(np.abs(np.diff(z))))
    spline = CubicSpline(chord, np.column_stack((z.real, z.imag)), bc_type="periodic" if closed else "natural")
    fine = np.linspace(0.0, chord[-1], 16 * SAMPLES + 1)
    xy = spline(fine)
    curve = xy[:, 0] + 1j * xy[:, 1]
    even, _ = evenly_spaced(curve[None], fine[None], count, closed=closed)
    length = np.append(0.0, np.cumsum(np.abs(np.diff(curve))))
    original = np.append(0.0, np.cumsum(np.abs(np.diff(points))))
    return even[0], np.interp(original, fine, length) / length[-1]


def _placed(rated: list[_Similar], at: np.ndarray) -> PlacedBars:
    """The four-bars of the most similar curves, each once, scaled and turned by α, shifted by β, with the crank's angles at the points."""
    best: dict[int, _Similar] = {}
    for row in sorted(rated, key=lambda row: row.error):
        best.setdefault(row.curve, row)
    rows = list(best.values())[:SIMILAR]
    curves = [row.curve for row in rows]
    alpha, beta = (np.array([getattr(row, name) for row in rows])[:, None] for name in ("alpha", "beta"))
    mirrored = np.array([row.mirrored for row in rows])[:, None]
    angles = np.array([np.interp(at, np.linspace(0.0, 1.0, row.angles.size), row.angles) for row in rows])
    *lengths, tracer, side = (values[curves][:, None] for values in sampled_curves().bars)
    tracer = np.where(mirrored, np.conj(tracer), tracer)
    crank, coupler, rocker, frame, tracer = (np.abs(alpha) * length for length in (*lengths, tracer))
    bars = Bars(crank, coupler, rocker, frame, tracer, np.where(mirrored, -side, side))
    return PlacedBars(bars, beta, np.angle(alpha), np.where(mirrored, -angles, angles))


def _at_all(placed: PlacedBars, points: np.ndarray, timing: np.ndarray | None) -> PlacedBars:
    """A four-bar with the crank's angles at all points: the nearest positions, or those of the timing."""
    if timing is not None:
        return placed.with_angles(timing + placed.angles[:, :1] - timing[0])
    grid = 2.0 * np.pi / NEAREST * np.arange(NEAREST)
    curve, _, _ = placed.at(grid[None])
    distance = np.abs(curve - points[:, None])
    angles = grid[None, np.nanargmin(distance, axis=1)]
    if placed.angles.size == points.size:  # keeps the branch of a curve that crosses itself
        fitted = np.abs(placed.at(placed.angles)[0] - points)
        angles = np.where(fitted <= np.nanmin(distance, axis=1), placed.angles, angles)
    distance = np.abs(placed.at(angles)[0] - points)
    for _ in range(NEAREST_STEPS):
        z, slope, _ = placed.at(angles)
        with np.errstate(invalid="ignore", divide="ignore"):
            step = (np.conj(slope) * (z - points)).real / np.abs(slope) ** 2
        nearer = angles - np.where(np.isfinite(step), np.clip(step, -0.05, 0.05), 0.0)
        new_distance = np.abs(placed.at(nearer)[0] - points)
        is_nearer = new_distance < distance
        angles, distance = np.where(is_nearer, nearer, angles), np.where(is_nearer, new_distance, distance)
    return placed.with_angles(angles)


# -- linkages ---------------------------------------------------------------------------------------------------


_Side = tuple[complex, np.ndarray]
"""Fixed pivot of a side link, and the positions (n,) of its pin [mm]."""


def _driven(placed: PlacedBars, points: np.ndarray, is_timed: bool) -> tuple[Candidate, ...]:
    """A four-bar driven by its crank, and by its rocker unless the path is timed, with its cognates.

    With k = (P - A)/(B - A) the third fixed pivot is C = O₂ + k(O₄ - O₂). The cognate at O₂ and C has the pins O₂ + P - A and that plus
    k(A - O₂); the one at O₄ and C the pins O₄ + P - B and that plus (1 - k)(B - O₄). Their links at C turn as the crank.
    """
    bars, o2 = placed.bars, complex(placed.pivot.item())
    o4 = o2 + bars.frame.item() * cmath.exp(1j * placed.direction.item())
    p, _, direction = (row[0] for row in placed.at(placed.angles))
    a = p - bars.tracer.item() * direction
    b = a + bars.coupler.item() * direction
    k = bars.tracer.item() / bars.coupler.item()
    c, near, far = o2 + k * (o4 - o2), o2 + p - a, o4 + p - b
    sides: list[tuple[_Side, _Side]] = [((o2, a), (o4, b))]
    if abs(k) > LEAST_COGNATE:
        sides.append(((c, near + k * (a - o2)), (o2, near)))
    if abs(1.0 - k) > LEAST_COGNATE:
        sides.append(((c, far + (1.0 - k) * (b - o4)), (o4, far)))
    errors, expected = position_errors(points, None), float(np.abs(p - points).max())

    def linkage(first: _Side, second: _Side) -> Candidate:
        (pivot, pin), (_, other) = first, second
        body = cmath.phase(complex(other[0] - pin[0]))
        dyads = [Dyad(PIN, z, complex(at[0] - p[0]) * cmath.exp(-1j * body)) for z, at in (first, second)]
        drawn = linkage_of(dyads[0], dyads[1], complex(p[0]), body)
        return Candidate(drawn, FOUR_BAR, np.angle(pin - pivot), errors, expected)

    linkages = [tuple(linkage(*rows) for rows in ((x, y), (y, x))[: 1 if is_timed else 2]) for x, y in sides]
    return tuple(replace(candidate, cognates=tuple(linkages[1:])) for candidate in linkages[0])
