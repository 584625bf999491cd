"""Linkages whose output follows given angles of the driver: four-bars, and slider-cranks.

Four-bar, a, b, c crank, coupler, rocker, d frame, angles from the frame's line: K₁cos ψ - K₂cos φ + K₃ = cos(φ - ψ) with K₁ = d/a,
K₂ = d/c, K₃ = (a² - b² + c² + d²)/(2ac). Slider-crank of offset e: s² = K₁ s cos φ + K₂ sin φ + K₃ with K₁ = 2a, K₂ = 2ae,
K₃ = b² - a² - e². A negative length points the other way.

Source: F. Freudenstein, *Approximate Synthesis of Four-Bar Linkages*, Trans. ASME 77 (1955) 853-861.
"""

from __future__ import annotations

import cmath
from collections.abc import Iterator
from itertools import product
from math import degrees, inf, log, pi, radians

import numpy as np

from core.design import CRANK, Drawn, Driver, Link, Linkage, LinkPoint, Slider
from core.frozen import frozen
from core.mechanism.kinematics import Kinematics
from core.mechanism.mechanism import body_name
from core.numerics.lazy import checkpoint
from core.synthesis.candidates import (
    COUPLER,
    CRANK_LINK,
    CRANK_PIN,
    CRANK_PIVOT,
    FOUR_BAR,
    FRAME,
    SIDE_LINK,
    SIDE_PIN,
    SIDE_PIVOT,
    SLIDER_CRANK,
    SPEED,
    Candidate,
    Errors,
    link_with,
)
from core.synthesis.task import ROCKER_OUTPUT, AnglePairs, Task

EXACT_PAIRS = 3
FREE_STARTS = 12
"""First angles in a turn that are tried where only differences count."""
MOST_CANDIDATES = 24
SAME = 1e-6  # of a parameter: two solutions are one
LEAST_SLOPE = 1e-6
WIDEST_RATIO = 10.0
"""Ratio of the longest to the shortest link within which least squares are searched, where the task has no limit of it."""
INSIDE, RATIO_WEIGHT = 0.99, 10.0
"""Part of that ratio from which it counts in the least squares, and its weight there."""
LINKS = (0.2, 0.5, 1.0, 2.0)
"""Lengths of crank and rocker, of the frame (of the output's reach for a slider), from which least squares start, in both directions."""


@frozen(eq=False)
class FunctionSolution:
    """A linkage that coordinates driver and output.

    Attributes
    ----------
    links : tuple of float
        a, b, c of a four-bar, a, b, e of a slider-crank [unit of the task's output length, mm]; a and c with their sign.
    starts : tuple of float
        Angle of the driver at its typed 0 [rad], and that of the rocker [rad], or position of the slider [mm].
    """

    links: tuple[float, float, float]
    starts: tuple[float, float]


def candidates(task: Task) -> Iterator[tuple[Candidate, ...]]:
    """Linkages that coordinate the pairs of angles of a task: exact for three pairs, else of least output error."""
    angles = task.angles
    assert angles is not None
    driver = np.array([radians(pair.driver_deg) for pair in angles.pairs])
    turns = angles.output == ROCKER_OUTPUT
    output = np.array([radians(pair.output) if turns else pair.output for pair in angles.pairs])
    for solution in _solutions(angles, driver, output, task.longest_to_shortest or WIDEST_RATIO):
        linkage = (_four_bar if turns else _slider_crank)(angles, solution, driver, output)
        kind = FOUR_BAR if turns else SLIDER_CRANK
        yield (Candidate(linkage, kind, driver, _output_errors(solution, output, turns)),)


def are_all(task: Task) -> bool:
    """Whether the candidates of a task are all that there are: the one of three pairs that fix it."""
    angles = task.angles
    assert angles is not None
    if angles.free or len(angles.pairs) != EXACT_PAIRS:
        return False
    turns = angles.output == ROCKER_OUTPUT
    output = np.array([radians(pair.output) if turns else pair.output for pair in angles.pairs])
    driver = np.array([radians(pair.driver_deg) for pair in angles.pairs])
    return _linear(driver, output, angles.frame_mm or 0.0, turns) is not None


def _solutions(angles: AnglePairs, driver: np.ndarray, output: np.ndarray, widest: float) -> list[FunctionSolution]:
    """Solutions that differ, of least output error first, but for one of three pairs within a ratio of the lengths."""
    turns = angles.output == ROCKER_OUTPUT
    frame = angles.frame_mm or 0.0
    starts: list[tuple[float, float]] = [(0.0, 0.0)]
    if angles.free:
        grid = 2.0 * pi / FREE_STARTS * np.arange(FREE_STARTS)
        reach = float(np.ptp(output)) or 1.0
        shifts = grid if turns else reach * np.linspace(-3.0, 3.0, FREE_STARTS)
        starts = [(float(a), float(b)) for a, b in product(grid, shifts)]
    solutions = []
    for start in starts:
        checkpoint()
        links = _linear(driver + start[0], output + start[1], frame, turns)
        if links is not None:
            solutions.append(FunctionSolution(links, start))
    most = max(widest, WIDEST_RATIO)  # beyond the limit of the task they are listed as hidden ones
    if angles.free and driver.size == EXACT_PAIRS:
        solutions = [solution for solution in solutions if _ratio(solution.links, frame) <= most]
    is_exact = driver.size == EXACT_PAIRS and bool(solutions)
    if not is_exact:
        middle = (0.5 * pi - _middle(driver), 0.5 * pi - _middle(output)) if angles.free and turns else (0.0, 0.0)
        solutions += _typical(driver, output, frame, turns, middle)
    rows = _by_error(solutions, driver, output, frame, turns)
    if not is_exact:
        rows = [_refined(row[1], driver, output, angles, frame, widest) for row in rows[: 2 * MOST_CANDIDATES]]
        rows.sort(key=lambda row: row[0])
        rows = [row for row in rows if _ratio(row[1].links, frame) <= most]
    result: list[FunctionSolution] = []
    for _, solution in rows:
        new = np.array((*solution.links, *solution.starts))
        if all(np.abs(new - (*old.links, *old.starts)).max() > SAME * np.abs(new).max() for old in result):
            result.append(solution)
    return result[:MOST_CANDIDATES]


def _middle(values: np.ndarray) -> float:
    return 0.5 * float(values.min() + values.max())


def _typical(
    driver: np.ndarray, output: np.ndarray, frame: float, turns: bool, starts: tuple[float, float]
) -> list[FunctionSolution]:
    """Linkages of typical lengths, with the coupler of least error: Freudenstein's equations can have none, or too many."""
    driver, output = driver + starts[0], output + starts[1]
    unit = frame or float(np.abs(output).max()) or 1.0
    lengths = [sign * unit * length for length in LINKS for sign in (1.0, -1.0)]
    solutions = []
    for a, third in product(lengths, lengths if turns else [0.0, *lengths]):
        pin = a * np.exp(1j * driver)
        rod = np.abs(pin - frame - third * np.exp(1j * output) if turns else pin - output - 1j * third)
        solutions.append(FunctionSolution((a, float(rod.mean()), third), starts))
    return solutions


def _by_error(
    solutions: list[FunctionSolution], driver: np.ndarray, output: np.ndarray, frame: float, turns: bool
) -> list[tuple[float, FunctionSolution]]:
    """Solutions with their largest output error, the least first."""
    rows = []
    for solution in solutions:
        first, second = solution.starts
        error = np.abs(_residual(solution.links, driver + first, output + second, frame, turns)).max()
        if np.isfinite(error):
            rows.append((float(error), solution))
    return sorted(rows, key=lambda row: row[0])


def _ratio(links: tuple[float, float, float], frame: float) -> float:
    """Longest to shortest link: of a four-bar with its frame, of a slider-crank of crank and coupler."""
    lengths = [abs(length) for length in ((*links, frame) if frame else links[:2])]
    return max(lengths) / min(lengths) if min(lengths) else inf


def _linear(driver: np.ndarray, output: np.ndarray, frame: float, turns: bool) -> tuple[float, float, float] | None:
    """Links by Freudenstein's linear equations; None where there are none with real, finite lengths."""
    if turns:
        rows = np.column_stack((np.cos(output), -np.cos(driver), np.ones(driver.size)))
        right = np.cos(driver - output)
    else:
        rows = np.column_stack((output * np.cos(driver), np.sin(driver), np.ones(driver.size)))
        right = output**2
    (k1, k2, k3), _, rank, _ = np.linalg.lstsq(rows, right, rcond=1e-12)
    if rank < 3 or not k1 or (turns and not k2):
        return None
    if turns:
        a, c = frame / k1, frame / k2
        square, third = a * a + c * c + frame * frame - 2.0 * a * c * k3, c
    else:
        a = 0.5 * k1
        third = k2 / k1
        square = k3 + a * a + third * third
    return (float(a), float(np.sqrt(square)), float(third)) if square > 0.0 and np.isfinite(square) else None


def _residual(
    links: tuple[float, float, float], driver: np.ndarray, output: np.ndarray, frame: float, turns: bool
) -> np.ndarray:
    """Output error (n,) [rad or mm] to first order: the error of the coupler's length over its slope by the output."""
    a, b, third = links
    pin = a * np.exp(1j * driver)
    if turns:
        arm = third * np.exp(1j * output)
        rod = pin - frame - arm
        slope = -(np.conj(rod) * 1j * arm).real
    else:
        rod = pin - output - 1j * third
        slope = -rod.real
    length = np.abs(rod)
    slope = slope / np.where(length > 0.0, length, np.nan)
    slope = np.where(np.abs(slope) < LEAST_SLOPE * np.abs(third if turns else b), np.nan, slope)
    return (length - abs(b)) / slope


def _refined(
    solution: FunctionSolution,
    driver: np.ndarray,
    output: np.ndarray,
    angles: AnglePairs,
    frame: float,
    widest: float,
) -> tuple[float, FunctionSolution]:
    """Solution of least squares of the output error, with its largest error."""
    from scipy.optimize import least_squares  # imported here to save start-up time

    turns = angles.output == ROCKER_OUTPUT
    unit = frame or float(np.abs(output).max()) or 1.0
    shift = 1.0 if turns else unit

    def unpacked(x: np.ndarray) -> FunctionSolution:
        first, second = (x[3], x[4] * shift) if angles.free else solution.starts
        return FunctionSolution((x[0] * unit, x[1] * unit, x[2] * unit), (float(first), float(second)))

    def errors(x: np.ndarray) -> np.ndarray:
        current = unpacked(x)
        first, second = current.starts
        values = _residual(current.links, driver + first, output + second, frame, turns)
        excess = max(0.0, log(min(_ratio(current.links, frame), 1e9) / (INSIDE * widest)))
        return np.append(np.where(np.isfinite(values), values, 1e3 * shift) / shift, RATIO_WEIGHT * excess)

    start = [length / unit for length in solution.links]
    if angles.free:
        start += [solution.starts[0], solution.starts[1] / shift]
    result = least_squares(errors, start, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=200)
    return float(np.abs(errors(result.x)[:-1]).max()), unpacked(result.x)


def _output_errors(solution: FunctionSolution, output: np.ndarray, turns: bool) -> Errors:
    """Errors of the output: in degrees of a rocker, whose frame is turned by its start, in mm of a slider."""

    def errors(kinematics: Kinematics) -> tuple[np.ndarray, np.ndarray]:
        body = kinematics.bodies[body_name(SIDE_LINK)]
        zeros = np.zeros(output.size)
        if turns:
            return zeros, np.abs(np.rad2deg(np.angle(np.exp(1j * (body.angle[0] - output)))))
        return np.abs(1e3 * body.fixed_point(0j)[0].real - (output + solution.starts[1])), zeros

    return errors


def _four_bar(angles: AnglePairs, solution: FunctionSolution, driver: np.ndarray, output: np.ndarray) -> Linkage:
    """Four-bar whose links 2 and 4 have the typed angles, drawn at the first pair."""
    (a, b, c), (first, second), frame = solution.links, solution.starts, angles.frame_mm or 0.0
    crank, rocker = a * cmath.exp(1j * first), c * cmath.exp(1j * second)
    pin = crank * cmath.exp(1j * float(driver[0]))
    other = frame + rocker * cmath.exp(1j * float(output[0]))
    links = (
        link_with(FRAME, {CRANK_PIVOT: 0j, SIDE_PIVOT: complex(frame)}),
        link_with(CRANK_LINK, {CRANK_PIVOT: 0j, CRANK_PIN: crank}),
        link_with(COUPLER, {CRANK_PIN: 0j, SIDE_PIN: complex(abs(b))}),
        link_with(SIDE_LINK, {SIDE_PIVOT: 0j, SIDE_PIN: rocker}),
    )
    return _drawn(links, (), float(driver[0]), pin, other)


def _slider_crank(angles: AnglePairs, solution: FunctionSolution, driver: np.ndarray, output: np.ndarray) -> Linkage:
    """Slider-crank along x whose link 2 has the typed angles, drawn at the first pair."""
    (a, b, offset), (first, second) = solution.links, solution.starts
    crank = a * cmath.exp(1j * first)
    pin = crank * cmath.exp(1j * float(driver[0]))
    other = complex(float(output[0]) + second, offset)
    links = (
        link_with(FRAME, {CRANK_PIVOT: 0j}),
        link_with(CRANK_LINK, {CRANK_PIVOT: 0j, CRANK_PIN: crank}),
        link_with(COUPLER, {CRANK_PIN: 0j, SIDE_PIN: complex(abs(b))}),
        link_with(SIDE_LINK, {SIDE_PIN: 0j}),
    )
    sliders = (Slider(link=SIDE_LINK, on=FRAME, through_x_mm=0.0, through_y_mm=offset, angle_deg=0.0),)
    return _drawn(links, sliders, float(driver[0]), pin, other)


def _drawn(links: tuple[Link, ...], sliders: tuple[Slider, ...], angle: float, pin: complex, other: complex) -> Linkage:
    points = (LinkPoint(CRANK_PIN, pin.real, pin.imag), LinkPoint(SIDE_PIN, other.real, other.imag))
    return Linkage(links, sliders, Driver(CRANK_LINK, CRANK, SPEED), drawn=Drawn(degrees(angle), None, points))


def size(task: Task) -> float:
    """Size of a task [mm]: its frame, or the largest position of its slider."""
    assert task.angles is not None
    return task.angles.frame_mm or max(abs(pair.output) for pair in task.angles.pairs) or 1.0
