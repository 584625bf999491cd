"""Phases of several drives on their shaft for the best torque, within the spacings of their timing.

The total torque is T(θ) = Σ T_i(θ - φ_i). Phases are searched globally on a grid of samples, then refined on the exact
curves: the highest of T (or of |T|, or highest and lowest of ∫(T - T̄)dθ) is a maximum of smooth functions of the
phases, each step a linear programme in a trust region. The root mean square is refined by its gradient.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from itertools import combinations, product
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from core.errors import KindynaError
from core.frozen import frozen
from core.motion import TURN
from core.numerics.lazy import checkpoint
from core.shaft.curve import LoadCurve, locate, powers
from core.shaft.flywheel import torque_deviation

GRID = {1: 1, 2: 360, 3: 120, 4: 60}
"""Number of drives -> phases of each in the full grid; with more drives two are changed at a time."""
PAIRWISE = 36
PER_STEP = 2  # samples between two phases of the grid
BLOCK = 2_000_000  # numbers in memory at a time
CANDIDATES, REFINED = 24, 3  # points of the grid that are candidates; of these, refined on the exact curves
FINE = 720  # samples of the exact curves, between which extremes are refined
FIRST_RADIUS = np.deg2rad(0.5)
NEAR = 0.7  # extremes below this fraction of the highest do not become the highest in one step
FIRST_STEPS, STEPS, LEAST_STEP = 10, 50, 1e-8  # [rad]
FLAT = 1e-10  # of the value: a step with a smaller expected gain is the last
ROUNDING = 1e-12  # [rad] tolerance of a spacing


class Spacing(NamedTuple):
    """Spacing between events of two drives, by their numbers.

    ``spare`` [rad] is by how much the second event comes later after the first than required at the current phases,
    within half a turn; negative where the requirement is violated.
    """

    first: int
    second: int
    spare: float


class _Aim(NamedTuple):
    """Property of T, or of ∫(T - T̄)dθ (``integrated``); value: samples (..., n) over the turn -> (...)."""

    integrated: bool
    value: Callable[[np.ndarray], np.ndarray]


AIMS: Mapping[str, _Aim] = MappingProxyType(
    {
        "peak": _Aim(False, lambda v: np.maximum(v.max(axis=-1), -v.min(axis=-1))),
        "rms": _Aim(False, lambda v: np.sqrt(np.einsum("...n,...n->...", v, v) / v.shape[-1])),
        "fluctuation": _Aim(True, lambda v: v.max(axis=-1) - v.min(axis=-1)),
    }
)
"""Quantities to minimise: the greatest |T| [N m], its root mean square [N m], the energy swing [J] for a flywheel."""


@frozen(eq=False)
class Phases:
    """Best phases.

    Attributes
    ----------
    rotations : ndarray (n,) [rad]
        Rotation of each drive from its current phase, 0 ... 2π; 0 for the first.
    value : float
        The aim at these phases [N m or J].
    """

    rotations: np.ndarray
    value: float


def best_phases(loads: Sequence[LoadCurve], spacings: Sequence[Spacing], aim: str) -> Phases:
    """Rotations of the drives that minimise the aim; the first drive keeps its phase.

    Parameters
    ----------
    loads : sequence of LoadCurve
        Load of each drive by the machine angle, at its current phase.
    spacings : sequence of Spacing
    aim : str
        Key of ``AIMS``.

    Returns
    -------
    Phases

    Raises
    ------
    KindynaError
        Where no phases satisfy the spacings.
    """
    curves = _Curves(loads, AIMS[aim])
    search = _on_grid if len(loads) in GRID else _pairwise
    starts = [start for start in search(curves, spacings) if start is not None]
    starts = sorted({tuple(np.round(s, 12)): s for s in starts}.values(), key=lambda s: float(curves.value(s)))
    candidates = [phases for start in starts[:CANDIDATES] if (phases := _nearest_valid(start, spacings)) is not None]
    if not candidates:
        raise KindynaError("no phases of the drives satisfy their timing: remove one of its rows, or reduce its angle")
    candidates.sort(key=curves.exact)
    near = min((_refine(curves, phases, spacings, FIRST_STEPS) for phases in candidates[:REFINED]), key=curves.exact)
    best = _refine(curves, near, spacings, STEPS, FIRST_RADIUS)
    return Phases(np.mod(best, TURN), curves.exact(best))


def aim_along(
    loads: Sequence[LoadCurve], rotations: np.ndarray, number: int, change: np.ndarray, aim: str
) -> np.ndarray:
    """The aim while one drive is rotated further and the others keep their phases.

    Parameters
    ----------
    loads : sequence of LoadCurve
        Of n drives.
    rotations : ndarray (n,) [rad]
        Rotations of the drives.
    number : int
        Index of the drive that is rotated.
    change : ndarray (m,) [rad]
        Its further rotations.
    aim : str
        Key of ``AIMS``.

    Returns
    -------
    ndarray (m,) [N m or J]
    """
    return _Curves(loads, AIMS[aim]).along(rotations, number, change)


class _Curves:
    """Exact torques (or energies) of the drives, and samples of them."""

    def __init__(self, loads: Sequence[LoadCurve], aim: _Aim) -> None:
        self.aim, self.count = aim, len(loads)
        self._panels = [_values(load) for load in loads] if not aim.integrated else [_energies(load) for load in loads]
        self.grid = GRID.get(self.count, PAIRWISE)
        self.samples = self.sampled(max(PER_STEP * self.grid, 2))

    def sampled(self, count: int) -> np.ndarray:
        theta = np.arange(count) * (TURN / count)
        return np.array([panels.at(theta)[0] for panels in self._panels])

    def value(self, rotations: np.ndarray) -> np.ndarray:
        """The aim by samples, at rotations (..., n) rounded to them."""
        size = self.samples.shape[1]
        shift = np.rint(rotations * (size / TURN)).astype(int)
        sample = np.arange(size) - shift[..., None]
        total = sum(self.samples[i].take(sample[..., i, :], mode="wrap") for i in range(self.count))
        return self.aim.value(np.asarray(total))

    @cached_property
    def _shifted(self) -> np.ndarray:
        """Samples of each drive at all phases of the grid (n, grid, size)."""
        size = self.samples.shape[1]
        return self.samples[:, (np.arange(size) - PER_STEP * np.arange(self.grid)[:, None]) % size]

    def of_pair(self, rotations: np.ndarray, i: int, j: int) -> np.ndarray:
        """The aim by samples with drives i and j at all phases of the grid (grid²,), those of i changing faster."""
        size = self.samples.shape[1]
        shift = np.rint(rotations * (size / TURN)).astype(int)
        others = sum(np.roll(self.samples[k], shift[k]) for k in range(self.count) if k not in (i, j))
        return self.aim.value(self._shifted[j][:, None] + (others + self._shifted[i])).ravel()

    def parts(self, theta: np.ndarray, rotations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Value and slope (n, m) of each drive at machine angles (m,)."""
        rows = [
            panels.at(np.mod(theta - rotation, TURN)) for panels, rotation in zip(self._panels, rotations, strict=True)
        ]
        return np.array([row[0] for row in rows]), np.array([row[1] for row in rows])

    def along(self, rotations: np.ndarray, number: int, change: np.ndarray) -> np.ndarray:
        """The aim by samples of the exact curves, with one drive rotated further by ``change`` (m,)."""
        theta = np.arange(FINE) * (TURN / FINE)
        parts, _ = self.parts(theta, rotations)
        rotated, _ = self._panels[number].at(np.mod(theta - rotations[number] - change[:, None], TURN).ravel())
        others = parts.sum(axis=0) - parts[number]
        return self.aim.value(others + rotated.reshape(change.size, FINE))

    def exact(self, rotations: np.ndarray) -> float:
        return float(self.pieces(rotations)[0])

    def pieces(self, rotations: np.ndarray) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
        """The aim; sign, value and gradient by the rotations of the pieces that determine it: (k,), (k,), (k, n)."""
        theta = np.arange(FINE) * (TURN / FINE)
        parts, slopes = self.parts(theta, rotations)
        if self.aim is AIMS["rms"]:
            total = parts.sum(axis=0)
            rms = float(np.sqrt(total @ total / FINE))
            return rms, np.ones(1), np.array([rms]), -(slopes @ total)[None, :] / (FINE * max(rms, 1e-300))
        total = parts.sum(axis=0)
        pieces = []
        for sign in (1.0, -1.0):
            value = sign * total
            left, right = np.roll(value, 1), np.roll(value, -1)
            peak = np.flatnonzero((value >= left) & (value >= right))
            second_difference = left[peak] - 2.0 * value[peak] + right[peak]
            offset = np.where(
                second_difference < 0.0,
                0.5 * (left[peak] - right[peak]) / np.where(second_difference < 0.0, second_difference, 1.0),
                0.0,
            )
            angles = theta[peak] + np.clip(offset, -1.0, 1.0) * (TURN / FINE)
            refined, rate = self.parts(angles, rotations)
            better = sign * refined.sum(axis=0) >= value[peak]
            refined, rate = np.where(better, refined, parts[:, peak]), np.where(better, rate, slopes[:, peak])
            pieces.append((np.full(peak.size, sign), sign * refined.sum(axis=0), -sign * rate.T))
        signs, values, gradients = (np.concatenate(rows) for rows in zip(*pieces, strict=True))
        tops = [float(values[signs == sign].max()) for sign in (1.0, -1.0)]
        return (tops[0] + tops[1] if self.aim.integrated else max(tops)), signs, values, gradients


class _Panels(NamedTuple):
    """Polynomials of one drive on panels: coefficients (k, m) of the value and of its slope by angle."""

    start: np.ndarray
    width: np.ndarray
    value: np.ndarray
    slope: np.ndarray

    def at(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        panel, r = locate(self.start, self.width, theta)
        terms = powers(r, self.value.shape[0])
        slope = (self.slope[:, panel] * terms[: self.slope.shape[0]]).sum(axis=0)
        return (self.value[:, panel] * terms).sum(axis=0), slope


def _values(load: LoadCurve) -> _Panels:
    k = np.arange(1, load.torque.shape[0])[:, None]
    return _Panels(load.start, load.width, load.torque, k * load.torque[1:] / load.width)


def _energies(load: LoadCurve) -> _Panels:
    power = torque_deviation(load)
    integral = load.width * power / np.arange(1, power.shape[0] + 1)[:, None]
    begins = np.concatenate(([0.0], np.cumsum(integral.sum(axis=0))[:-1]))
    return _Panels(load.start, load.width, np.vstack((begins, integral)), power)


# -- search on a grid -----------------------------------------------------------------------------------------


def _on_grid(curves: _Curves, spacings: Sequence[Spacing]) -> list[np.ndarray]:
    """Local optima of the grid that satisfy the spacings to a step of it, the best first."""
    grid, count, size = curves.grid, curves.count, curves.samples.shape[1]
    axes = np.meshgrid(*[np.arange(grid)] * (count - 1), indexing="ij", sparse=True) if count > 1 else []
    shape = (grid,) * (count - 1)
    valid = np.ones(shape, dtype=bool)
    steps = [np.zeros(1, dtype=int), *axes]
    for spacing in spacings:
        spare = spacing.spare + (steps[spacing.second] - steps[spacing.first]) * (TURN / grid)
        valid = valid & (
            (np.mod(spare + 0.5 * TURN, TURN) >= 0.5 * TURN - TURN / grid)
            | (np.mod(spare, TURN) > TURN * (1.0 - 1.0 / grid))
        )
    samples = curves.samples.astype(np.float32)
    shifts = (np.arange(size) - PER_STEP * np.arange(grid)[:, None]) % size
    value = np.full(shape, np.inf, dtype=np.float32).reshape(-1, grid if count > 1 else 1)
    partial = samples[:1]
    for row in samples[1:-1]:
        partial = (partial[:, None, :] + row[shifts][None]).reshape(-1, size)
    candidates = np.flatnonzero(valid.reshape(value.shape).any(axis=1))
    last = samples[-1][shifts] if count > 1 else np.zeros((1, size), dtype=np.float32)
    for part in np.array_split(candidates, max(1, candidates.size * last.size // BLOCK)):
        checkpoint()
        value[part] = curves.aim.value(partial[part][:, None, :] + last[None])
    value = np.where(valid, value.reshape(shape), np.inf)
    lowest = np.isfinite(value)
    for axis, shift in product(range(count - 1), (-1, 1)):
        lowest &= value <= np.roll(value, shift, axis=axis)
    optima = np.flatnonzero(lowest)
    order = optima[np.argsort(value.ravel()[optima], kind="stable")][: 4 * CANDIDATES]
    points = np.array(np.unravel_index(order, shape)).T if shape else np.zeros((1, 0))
    return [np.concatenate(([0.0], row * (TURN / grid))) for row in points]


def _pairwise(curves: _Curves, spacings: Sequence[Spacing]) -> list[np.ndarray]:
    """Optima for many drives: two drives at a time are set to the best of all their phases, while that helps."""
    step, optima = TURN / curves.grid, []
    pairs = list(combinations(range(1, curves.count), 2))
    first, second = (axis.ravel() * step for axis in np.meshgrid(np.arange(curves.grid), np.arange(curves.grid)))
    for number in range(CANDIDATES):
        rotations = np.concatenate(([0.0], TURN * np.mod(number * np.sqrt(np.arange(2, curves.count + 1) * 1.37), 1.0)))
        start = _nearest_valid(np.rint(rotations / step) * step, spacings)
        if start is None:
            continue
        is_improved = True
        while is_improved:
            is_improved = False
            for i, j in pairs:
                checkpoint()
                trials = np.repeat(start[None], first.size, axis=0)
                trials[:, i], trials[:, j] = first, second
                values = np.where(_is_valid(trials, spacings), curves.of_pair(start, i, j), np.inf)
                best = int(np.argmin(values))
                if values[best] < curves.value(start) * (1.0 - 1e-9):
                    start, is_improved = trials[best], True
        optima.append(start)
    return optima


def _is_valid(rotations: np.ndarray, spacings: Sequence[Spacing]) -> np.ndarray:
    """Mask (m,) of the rotations (m, n) that satisfy all spacings."""
    valid = np.ones(rotations.shape[0], dtype=bool)
    for spacing in spacings:
        spare = spacing.spare + rotations[:, spacing.second] - rotations[:, spacing.first]
        valid &= np.mod(spare + 0.5 * TURN, TURN) >= 0.5 * TURN - ROUNDING
    return valid


# -- refinement on the exact curves ------------------------------------------------------------------------


def _rows(rotations: np.ndarray, spacings: Sequence[Spacing]) -> tuple[np.ndarray, np.ndarray]:
    """The spacings as A d <= b of a change d (n - 1,) of all phases but the first, each on its nearer side."""
    count = rotations.size - 1
    sides = np.zeros((2 * len(spacings), count + 1))
    bounds = np.zeros(2 * len(spacings))
    for k, spacing in enumerate(spacings):
        spare = spacing.spare + rotations[spacing.second] - rotations[spacing.first]
        spare = np.mod(spare + 0.5 * TURN, TURN) - 0.5 * TURN  # -π ... π
        if spare < -0.25 * TURN:
            spare += TURN  # beyond the far side
        sides[2 * k, spacing.first] += 1.0
        sides[2 * k, spacing.second] -= 1.0
        sides[2 * k + 1] = -sides[2 * k]
        bounds[2 * k : 2 * k + 2] = spare, 0.5 * TURN - 1e-9 - spare
    return sides[:, 1:], bounds


def _programme(
    cost: np.ndarray, sides: np.ndarray, limits: np.ndarray, bounds: list[tuple[float | None, float | None]]
) -> np.ndarray | None:
    from scipy.optimize import linprog

    result = linprog(cost, A_ub=sides, b_ub=limits, bounds=bounds, method="highs")
    return np.asarray(result.x) if result.status == 0 else None


def _nearest_valid(rotations: np.ndarray, spacings: Sequence[Spacing]) -> np.ndarray | None:
    """The nearest rotations that satisfy the spacings; None where none are near."""
    if _is_valid(rotations[None], spacings)[0]:
        return rotations
    sides, limits = _rows(rotations, spacings)
    count = rotations.size - 1
    eye = np.eye(count)
    matrix = np.block([[sides, np.zeros((sides.shape[0], count))], [eye, -eye], [-eye, -eye]])
    change = _programme(
        np.concatenate((np.zeros(count), np.ones(count))),
        matrix,
        np.concatenate((limits, np.zeros(2 * count))),
        [(None, None)] * count + [(0.0, None)] * count,
    )
    if change is None:
        return None
    shifted = rotations + np.concatenate(([0.0], change[:count]))
    return shifted if _is_valid(shifted[None], spacings)[0] else None


def _refine(
    curves: _Curves, rotations: np.ndarray, spacings: Sequence[Spacing], steps: int, radius: float = np.inf
) -> np.ndarray:
    """Local optimum from a start, by linear programmes on tangent planes of the highest pieces in a trust region."""
    count = curves.count - 1
    if not count:
        return rotations
    radius = min(radius, TURN / curves.grid)
    value, signs, values, gradients = curves.pieces(rotations)
    for _ in range(steps):
        checkpoint()
        tops = np.array([values[signs == sign].max(initial=-np.inf) for sign in (1.0, -1.0)])
        top = tops if curves.aim.integrated else np.full(2, tops.max())
        near = values >= np.where(signs > 0.0, top[0], top[1]) - (1.0 - NEAR) * np.abs(value)
        up, own_gradients = signs[near] > 0.0, gradients[near][:, 1:]
        level = np.column_stack(
            (-up.astype(float), -(~up).astype(float)) if curves.aim.integrated else (-np.ones(up.size),)
        )
        sides, limits = _rows(rotations, spacings)
        matrix = np.vstack(
            (
                np.column_stack((own_gradients, level)),
                np.column_stack((sides, np.zeros((sides.shape[0], level.shape[1])))),
            )
        )
        step = _programme(
            np.concatenate((np.zeros(count), np.ones(level.shape[1]))),
            matrix,
            np.concatenate((-values[near], limits)),
            [(-radius, radius)] * count + [(None, None)] * level.shape[1],
        )
        if step is None:
            break
        trial = rotations + np.concatenate(([0.0], step[:count]))
        trial_pieces = curves.pieces(trial)
        expected = value - float(step[count:].sum())
        if trial_pieces[0] < value - 0.1 * expected and _is_valid(trial[None], spacings)[0]:
            is_accurate = value - trial_pieces[0] > 0.75 * expected
            rotations, (value, signs, values, gradients) = trial, trial_pieces
            radius *= 2.0 if is_accurate else 0.5 if value else 1.0
        else:
            radius *= 0.25
        if radius < LEAST_STEP or expected <= FLAT * abs(value):
            break
    return rotations
