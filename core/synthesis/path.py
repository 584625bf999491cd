"""Four-bars whose coupler traces a path: sampled curves that are similar, refined by least squares.

The unknowns are crank, coupler, rocker, frame, the tracer, the crank's pivot and the frame's direction, and an angle of the crank for each
point; where the driver's angles at the points are given, only their start. Each answer has two cognates with the same path.

Source: F. Freudenstein, G. N. Sandor, *Synthesis of path-generating mechanisms*, Trans. ASME 81 (1959) 159-168, for the unknowns;
S. Roberts, *Three-bar motion in plane space*, Proc. London Math. Soc. 7 (1875) 14-23, for the cognates.
"""

from __future__ import annotations

import cmath
from collections.abc import Iterator
from dataclasses import replace
from math import inf

import numpy as np

from core.errors import DesignError
from core.frozen import frozen
from core.mechanism.driver_ranges import driver_ranges_of
from core.mechanism.mechanism import body_name
from core.mechanism.solving import unit_speed_kinematics
from core.numerics.derivatives import vector
from core.numerics.lazy import checkpoint
from core.synthesis.candidates import (
    COUPLER,
    CRANK_PIN,
    CRANK_PIVOT,
    FOUR_BAR,
    FRAME,
    SIDE_PIN,
    SIDE_PIVOT,
    Candidate,
    linkage_of,
)
from core.synthesis.curves import (
    SAMPLES,
    Bars,
    descriptor,
    evenly_spaced,
    nearest_descriptors,
    sampled_curves,
    similar,
    trace,
)
from core.synthesis.dyads import PIN, Dyad
from core.synthesis.judge import position_errors
from core.synthesis.task import PathPoint, Task, point_faults, task_size

SIMILAR, REFINED = 60, 12
"""Curves that are placed over the path, and those of them that are refined."""
MOST_FITTED = 48
"""Points of a path that are fitted; of more, evenly chosen ones."""
OPEN_CURVES, OPEN_POINTS = 5000, 16
WINDOWS = (0.12, 0.2, 0.32, 0.5, 0.75)
"""Lengths of the parts of closed curves that are compared with an open path."""
STEP = 1e-7  # of the size, of numerical slopes
PENALTY = 1e3  # of the size: residual where the links do not meet
WIDEST_RATIO = 8.0
"""Ratio of the longest to the shortest link within which four-bars are refined, where the task has no limit of it."""
NEAREST = 720  # positions of the crank from which the nearest point of a curve is refined


@frozen(eq=False)
class Placed:
    """A four-bar in the plane: its links, the crank's pivot [mm], the frame's direction [rad], and crank angles [rad] at the points."""

    bars: Bars
    pivot: complex
    direction: float
    angles: np.ndarray

    def at(self, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Tracer, its derivative and the coupler's direction in the plane, as of ``trace``.

        Parameters
        ----------
        angles : ndarray (n,) [rad]
            Angles of the crank.

        Returns
        -------
        tuple of ndarray (n,) complex [mm], [mm/rad], dimensionless
        """
        turn = cmath.exp(1j * self.direction)
        point, slope, coupler = trace(self.bars, angles)
        return self.pivot + turn * point, turn * slope, turn * coupler


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
    from core.synthesis.path_file import read_path  # imported here to save start-up time

    points = read_path(task.folder / task.path.file).tolist()
    if faults := list(point_faults(task, points)):
        raise DesignError(faults)
    return replace(task, path=replace(task.path, file="", points=tuple(PathPoint(z.real, z.imag) for z in points)))


def _points(task: Task) -> list[complex]:
    assert task.path is not None
    return [vector(p.x_mm, p.y_mm) for p in task.path.points]


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
    weights = np.sqrt(np.array(path.weights)) if path.weights else np.ones(points.size)
    starts = _closed_starts(points) if path.closed else _open_starts(points)
    rows = []
    for start in starts[: 2 * REFINED if timing is not None else REFINED]:
        checkpoint()
        part = None if timing is None else timing[fitted]
        ratio = task.longest_to_shortest or WIDEST_RATIO
        placed = _refined(_for_points(start, fitted), points[fitted], weights[fitted], part, ratio)
        if placed is not None:
            whole = _at_all(placed, points, timing)
            rows.append((float(np.abs(whole.at(whole.angles)[0] - points).max()), whole))
    rows.sort(key=lambda row: row[0] if row[0] == row[0] else inf)
    for _, placed in rows[:REFINED]:
        yield (_candidate(placed, points),)


# -- starts -----------------------------------------------------------------------------------------------------


def _closed_starts(points: np.ndarray) -> list[Placed]:
    """Four-bars with the most similar closed curves, placed over the points."""
    even, at = _resampled(points, closed=True)
    curves = sampled_curves()
    rows = nearest_descriptors(curves.descriptors, descriptor(even[None])[0], SIMILAR)
    rated = []
    for index, mirrored in rows:
        z = np.conj(curves.points[index]) if mirrored else curves.points[index]
        for step in (1, -1):
            order = (np.arange(SAMPLES)[:, None] + step * np.arange(SAMPLES)) % SAMPLES  # all first points
            alpha, beta, error = similar(z[order], even)
            best = int(np.argmin(error))
            rated.append((float(error[best]), index, mirrored, complex(alpha[best]), complex(beta[best]), order[best]))
    rated.sort(key=lambda row: row[0])
    seen: set[int] = set()
    result = []
    for _, index, mirrored, scale, shift, order in rated:
        if index in seen:
            continue
        seen.add(index)
        unwrapped = np.unwrap(curves.angles[index][order])
        ends = np.append(unwrapped, unwrapped[0] + np.sign(unwrapped[1] - unwrapped[0]) * 2.0 * np.pi)
        angles = np.interp(at, np.arange(SAMPLES + 1) / SAMPLES, ends)
        result.append(_placed(index, mirrored, scale, shift, angles))
    return result


def _open_starts(points: np.ndarray) -> list[Placed]:
    """Four-bars of which a part of the curve is most similar to an open path."""
    even, at = _resampled(points, closed=False)
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
                    best = int(np.argmin(error))
                    rated.append(
                        (float(error[best]), best, mirrored, complex(alpha[best]), complex(beta[best]), index[::step])
                    )
    rated.sort(key=lambda row: row[0])
    seen: set[int] = set()
    result = []
    for _, curve, mirrored, scale, shift, index in rated:
        if curve in seen:
            continue
        seen.add(curve)
        angles = np.interp(at, np.linspace(0.0, 1.0, OPEN_POINTS), np.unwrap(crank[curve][index]))
        result.append(_placed(curve, mirrored, scale, shift, angles))
    return result


def _resampled(points: np.ndarray, closed: bool) -> tuple[np.ndarray, np.ndarray]:
    """Points evenly spaced by length along a smooth curve through the given ones, and the part of the length (n,) of each of these."""
    from scipy.interpolate import CubicSpline  # imported here to save start-up time

    z = np.append(points, points[0]) if closed else points
    z = z[np.append(True, np.abs(np.diff(z)) > 0.0)]
    chord = np.append(0.0, np.cumsum(np.abs(np.diff(z))))
    spline = CubicSpline(chord, np.column_stack((z.real, z.imag)), bc_type="periodic" if closed else "natural")
    fine = np.linspace(0.0, chord[-1], 16 * SAMPLES + 1)
    xy = spline(fine)
    curve = xy[:, 0] + 1j * xy[:, 1]
    length = np.append(0.0, np.cumsum(np.abs(np.diff(curve))))
    if closed:
        even, _ = evenly_spaced(curve[None], fine[None], SAMPLES)
        even = even[0]
    else:
        even = np.interp(np.linspace(0.0, length[-1], OPEN_POINTS), length, curve)
    original = np.append(0.0, np.cumsum(np.abs(np.diff(points))))
    return even, np.interp(original, fine, length) / length[-1]


def _placed(index: int, mirrored: bool, alpha: complex, beta: complex, angles: np.ndarray) -> Placed:
    """A sampled four-bar scaled and turned by alpha, shifted by beta [mm]."""
    sampled, scale = sampled_curves().bars, abs(alpha)
    tracer = complex(sampled.tracer[index])
    crank, coupler, rocker, frame = (scale * float(lengths[index]) for lengths in sampled[:4])
    side = -1.0 if mirrored else 1.0
    bars = Bars(crank, coupler, rocker, frame, scale * (tracer.conjugate() if mirrored else tracer), side)
    return Placed(bars, beta, cmath.phase(alpha), -angles if mirrored else angles)


def _for_points(start: Placed, chosen: np.ndarray) -> Placed:
    return Placed(start.bars, start.pivot, start.direction, start.angles[chosen])


# -- refinement -------------------------------------------------------------------------------------------------


FIXED_UNKNOWNS = 9
TINY, INSIDE = 1e-12, 0.98  # a length that is 0; the part of the ratio that costs nothing


def _refined(
    start: Placed, points: np.ndarray, weights: np.ndarray, timing: np.ndarray | None, ratio: float
) -> Placed | None:
    """Four-bar of least squares of the distances at the points; None where the links do not meet.

    A larger ratio of the longest to the shortest link costs as much as a distance: without it, some four-bars grow without end.
    """
    from scipy.optimize import least_squares  # imported here to save start-up time

    unit = float(np.abs(points - points.mean()).max())
    bars, side = start.bars, start.bars.side
    lengths = [length / unit for length in bars[:4]]
    place = [complex(bars.tracer) / unit, start.pivot / unit]
    x0 = [*lengths, place[0].real, place[0].imag, place[1].real, place[1].imag, start.direction]
    if timing is None:
        x0 = [*x0, *start.angles]
    else:
        x0.append(cmath.phase(complex(np.exp(1j * (start.angles - timing)).sum())))

    def placed(x: np.ndarray) -> Placed:
        crank, coupler, rocker, frame = unit * x[:4]
        numbers = Bars(crank, coupler, rocker, frame, unit * complex(x[4], x[5]), side)
        angles = x[FIXED_UNKNOWNS:] if timing is None else timing + x[FIXED_UNKNOWNS]
        return Placed(numbers, unit * complex(x[6], x[7]), float(x[8]), angles)

    def values(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        current = placed(x)
        z, slope, _ = current.at(current.angles)
        is_valid = np.isfinite(z) & np.isfinite(slope)
        error = np.where(is_valid, z - points, PENALTY * unit) * weights / unit
        return error, np.where(is_valid, slope, 0.0) * weights / unit

    def excess(x: np.ndarray) -> np.ndarray:
        over = np.log(np.abs(x[:4]).max() / (np.abs(x[:4]).min() + TINY)) - np.log(ratio * INSIDE)
        return np.array([max(over, 0.0)])

    def residual(x: np.ndarray) -> np.ndarray:
        error, _ = values(x)
        return np.concatenate((error.real, error.imag, excess(x)))

    def jacobian(x: np.ndarray) -> np.ndarray:
        error, slope = values(x)
        now = excess(x)
        columns, limits = [], np.zeros((now.size, x.size))
        for i in range(FIXED_UNKNOWNS):
            moved = x.copy()
            moved[i] += STEP
            columns.append((values(moved)[0] - error) / STEP)
            limits[:, i] = (excess(moved) - now) / STEP
        rows = np.column_stack((*columns, np.diag(slope) if timing is None else slope))
        return np.concatenate((rows.real, rows.imag, limits))

    result = least_squares(residual, np.array(x0), jacobian, xtol=1e-12, ftol=1e-12, gtol=1e-14, max_nfev=150)
    answer = placed(result.x)
    return answer if np.isfinite(answer.at(answer.angles)[0]).all() and min(map(abs, answer.bars[:4])) > 0.0 else None


def _at_all(placed: Placed, points: np.ndarray, timing: np.ndarray | None) -> Placed:
    """The four-bar with positive lengths, and the crank's angles at all points: the nearest positions, or those of the timing."""
    if timing is not None:
        start = cmath.phase(complex(np.exp(1j * (placed.angles[0] - timing[0]))))
        return Placed(placed.bars, placed.pivot, placed.direction, timing + start)
    grid = 2.0 * np.pi / NEAREST * np.arange(NEAREST)
    curve, _, _ = placed.at(grid)
    distance = np.abs(curve - points[:, None])
    angles = grid[np.nanargmin(distance, axis=1)]
    if placed.angles.size == points.size:  # keeps the branch of a curve that crosses itself
        own = np.abs(placed.at(placed.angles)[0] - points)
        angles = np.where(own <= np.nanmin(distance, axis=1), placed.angles, angles)
    for _ in range(6):
        z, slope, _ = placed.at(angles)
        with np.errstate(invalid="ignore", divide="ignore"):
            step = (np.conj(slope) * (z - points)).real / np.abs(slope) ** 2
        angles = angles - np.where(np.isfinite(step), np.clip(step, -0.05, 0.05), 0.0)
    return Placed(placed.bars, placed.pivot, placed.direction, angles)


# -- linkages ---------------------------------------------------------------------------------------------------


def _candidate(placed: Placed, points: np.ndarray) -> Candidate:
    """The four-bar as a linkage, its coupler's frame along the coupler, with the tracer as origin."""
    bars, turn = placed.bars, cmath.exp(1j * placed.direction)
    tracer, coupler = complex(bars.tracer), float(bars.coupler)
    first = Dyad(PIN, placed.pivot, -tracer)
    second = Dyad(PIN, placed.pivot + turn * float(bars.frame), coupler - tracer)
    z, _, direction = placed.at(placed.angles)
    linkage = linkage_of(first, second, complex(z[0]), cmath.phase(complex(direction[0])))
    pins = z - tracer * direction - placed.pivot
    expected = float(np.abs(z - points).max())
    return Candidate(linkage, FOUR_BAR, np.angle(pins), position_errors(points, None), expected)


def cognates(candidate: Candidate) -> Iterator[tuple[Candidate, ...]]:
    """The two other four-bars with the path of a four-bar, each with either side link as its driver.

    With k = (P - A)/(B - A) the third fixed pivot is C = O₂ + k(O₄ - O₂). The cognate at O₂ and C has the pins O₂ + P - A and that plus
    k(A - O₂); the one at O₄ and C the pins O₄ + P - B and that plus (1 - k)(B - O₄).
    """
    linkage = candidate.linkage
    frame, coupler = linkage.by_number[FRAME].places, linkage.by_number[COUPLER].places
    o2, o4 = frame[CRANK_PIVOT], frame[SIDE_PIVOT]
    body = unit_speed_kinematics(linkage, candidate.positions, driver_ranges_of(linkage)).bodies[body_name(COUPLER)]
    a, b = (1e3 * body.fixed_point(1e-3 * coupler[name])[0] for name in (CRANK_PIN, SIDE_PIN))
    p = 1e3 * body.fixed_point(0j)[0]
    k = (0.0 - coupler[CRANK_PIN]) / (coupler[SIDE_PIN] - coupler[CRANK_PIN])
    third = o2 + k * (o4 - o2)
    for fixed, near, far in (
        (o2, o2 + p - a, o2 + p - a + k * (a - o2)),
        (o4, o4 + p - b, o4 + p - b + (1.0 - k) * (b - o4)),
    ):
        dyads = Dyad(PIN, fixed, complex(near[0] - p[0])), Dyad(PIN, third, complex(far[0] - p[0]))
        options = []
        for (first, second), pin in ((dyads, near), (dyads[::-1], far)):
            positions = np.angle(pin - first.fixed)
            cognate = linkage_of(first, second, complex(p[0]), 0.0)
            options.append(Candidate(cognate, FOUR_BAR, positions, candidate.errors, candidate.expected))
        yield tuple(options)
