"""How several drives stand to each other on their shaft so that its torque is best, within what their timing leaves.

The torque of the whole is T(θ) = Σ T_i(θ - φ_i). Phases are searched globally on a grid of samples, then refined on the exact
curves: the highest of T (or of |T|, or highest and lowest of ∫(T - T̄)dθ) is a maximum of smooth functions of the phases, each step a
linear programme within a radius that is trusted. The root mean square goes the same way, its own gradient the only plane.
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
from core.shaft.curve import LoadCurve, placed, powers
from core.shaft.flywheel import unbalanced

GRID = {1: 1, 2: 360, 3: 120, 4: 60}
"""Drives -> phases of each that are tried, all with all; of more drives two are moved at a time."""
PAIRWISE = 36
PER_STEP = 2  # samples between two phases tried
BLOCK = 2_000_000  # numbers held at once
CANDIDATES, REFINED = 24, 3  # places of the grid looked at closer; those of them refined on the exact curves
FINE = 720  # samples of the exact curves, between which extremes are refined
FIRST_RADIUS = np.deg2rad(0.5)
NEAR = 0.7  # extremes of less than this share of the highest do not become the highest in one step
FIRST_STEPS, STEPS, LEAST_STEP = 10, 50, 1e-8  # [rad]
FLAT = 1e-10  # of what is reached: a step that cannot gain more is the last
ROUNDING = 1e-12  # [rad] by which a spacing that is kept may miss


class Spacing(NamedTuple):
    """A distance between events of two drives: numbers of the drives, and by how much more than it must the second comes after the
    first with the phases as they are [rad], within half a turn; negative where it is broken."""

    first: int
    second: int
    spare: float


class _Aim(NamedTuple):
    """integrated: of ∫(T - T̄)dθ instead of T; reached: values (..., n) of it over the turn -> (...)."""

    integrated: bool
    reached: Callable[[np.ndarray], np.ndarray]


AIMS: Mapping[str, _Aim] = MappingProxyType(
    {
        "peak": _Aim(False, lambda v: np.maximum(v.max(axis=-1), -v.min(axis=-1))),
        "rms": _Aim(False, lambda v: np.sqrt(np.einsum("...n,...n->...", v, v) / v.shape[-1])),
        "fluctuation": _Aim(True, lambda v: v.max(axis=-1) - v.min(axis=-1)),
    }
)
"""What may be least: the greatest |T| [N m], its root mean square [N m], the swing of the energy [J] that a flywheel levels."""


@frozen(eq=False)
class Phases:
    """turned: how much further on each drive stands than it did (n,) [rad], 0 ... 2π, 0 the first; reached: what is least there."""

    turned: np.ndarray
    reached: float


def best_phases(loads: Sequence[LoadCurve], spacings: Sequence[Spacing], aim: str) -> Phases:
    """The drives' loads, each by the machine angle as it stands now, turned so that the aim is least.

    The first drive stays. Raises KindynaError where no phases keep the spacings.
    """
    curves = _Curves(loads, AIMS[aim])
    search = _on_grid if len(loads) in GRID else _pairwise
    starts = [start for start in search(curves, spacings) if start is not None]
    starts = sorted({tuple(np.round(s, 12)): s for s in starts}.values(), key=lambda s: float(curves.reached(s)))
    kept = [each for start in starts[:CANDIDATES] if (each := _within(start, spacings)) is not None]
    if not kept:
        raise KindynaError("no phases of the drives keep their timing: take one of its rows away, or make it less")
    kept.sort(key=curves.exact)
    near = min((_refined(curves, each, spacings, FIRST_STEPS) for each in kept[:REFINED]), key=curves.exact)
    best = _refined(curves, near, spacings, STEPS, FIRST_RADIUS)
    return Phases(np.mod(best, TURN), curves.exact(best))


def reached_along(loads: Sequence[LoadCurve], turned: np.ndarray, number: int, by: np.ndarray, aim: str) -> np.ndarray:
    """What the aim reaches (m,) with one drive turned on by so much more (m,) [rad], the others as they stand."""
    return _Curves(loads, AIMS[aim]).along(turned, number, by)


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

    def reached(self, turned: np.ndarray) -> np.ndarray:
        """By samples, at phases (..., n) to the next of them."""
        size = self.samples.shape[1]
        shift = np.rint(turned * (size / TURN)).astype(int)
        at = np.arange(size) - shift[..., None]
        return self.aim.reached(
            np.asarray(sum(self.samples[i].take(at[..., i, :], mode="wrap") for i in range(self.count)))
        )

    @cached_property
    def _moved(self) -> np.ndarray:
        """The samples of each drive at all phases of the grid (n, grid, size)."""
        size = self.samples.shape[1]
        return self.samples[:, (np.arange(size) - PER_STEP * np.arange(self.grid)[:, None]) % size]

    def of_pair(self, turned: np.ndarray, i: int, j: int) -> np.ndarray:
        """What is reached by samples with two drives at all phases of the grid, those of the first changing sooner (grid²,), and the
        others as they stand."""
        size = self.samples.shape[1]
        shift = np.rint(turned * (size / TURN)).astype(int)
        others = sum(np.roll(self.samples[k], shift[k]) for k in range(self.count) if k not in (i, j))
        return self.aim.reached(self._moved[j][:, None] + (others + self._moved[i])).ravel()

    def parts(self, theta: np.ndarray, turned: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What each drive gives, and its slope (n, m), at machine angles (m,)."""
        rows = [panels.at(np.mod(theta - by, TURN)) for panels, by in zip(self._panels, turned, strict=True)]
        return np.array([row[0] for row in rows]), np.array([row[1] for row in rows])

    def along(self, turned: np.ndarray, number: int, by: np.ndarray) -> np.ndarray:
        """By samples of the exact curves, with one drive turned on by so much more (m,)."""
        theta = np.arange(FINE) * (TURN / FINE)
        parts, _ = self.parts(theta, turned)
        moved, _ = self._panels[number].at(np.mod(theta - turned[number] - by[:, None], TURN).ravel())
        others = parts.sum(axis=0) - parts[number]
        return self.aim.reached(others + moved.reshape(by.size, FINE))

    def exact(self, turned: np.ndarray) -> float:
        return float(self.pieces(turned)[0])

    def pieces(self, turned: np.ndarray) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
        """What is reached; sign, value and gradient by the phases of the pieces that make it: (k,), (k,), (k, n)."""
        theta = np.arange(FINE) * (TURN / FINE)
        parts, slopes = self.parts(theta, turned)
        if self.aim is AIMS["rms"]:
            total = parts.sum(axis=0)
            rms = float(np.sqrt(total @ total / FINE))
            return rms, np.ones(1), np.array([rms]), -(slopes @ total)[None, :] / (FINE * max(rms, 1e-300))
        total = parts.sum(axis=0)
        found = []
        for sign in (1.0, -1.0):
            value = sign * total
            left, right = np.roll(value, 1), np.roll(value, -1)
            top = np.flatnonzero((value >= left) & (value >= right))
            bend = left[top] - 2.0 * value[top] + right[top]
            by = np.where(bend < 0.0, 0.5 * (left[top] - right[top]) / np.where(bend < 0.0, bend, 1.0), 0.0)
            at = theta[top] + np.clip(by, -1.0, 1.0) * (TURN / FINE)
            there, rate = self.parts(at, turned)
            better = sign * there.sum(axis=0) >= value[top]
            there, rate = np.where(better, there, parts[:, top]), np.where(better, rate, slopes[:, top])
            found.append((np.full(top.size, sign), sign * there.sum(axis=0), -sign * rate.T))
        signs, values, gradients = (np.concatenate(rows) for rows in zip(*found, strict=True))
        tops = [float(values[signs == sign].max()) for sign in (1.0, -1.0)]
        return (tops[0] + tops[1] if self.aim.integrated else max(tops)), signs, values, gradients


class _Panels(NamedTuple):
    """Polynomials of one drive: coefficients (k, m) of the value and of its slope by angle, on panels."""

    start: np.ndarray
    width: np.ndarray
    value: np.ndarray
    slope: np.ndarray

    def at(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        panel, r = placed(self.start, self.width, theta)
        reach = powers(r, self.value.shape[0])
        return (self.value[:, panel] * reach).sum(axis=0), (self.slope[:, panel] * reach[: self.slope.shape[0]]).sum(
            axis=0
        )


def _values(load: LoadCurve) -> _Panels:
    k = np.arange(1, load.torque.shape[0])[:, None]
    return _Panels(load.start, load.width, load.torque, k * load.torque[1:] / load.width)


def _energies(load: LoadCurve) -> _Panels:
    power = unbalanced(load)
    given = load.width * power / np.arange(1, power.shape[0] + 1)[:, None]
    begins = np.concatenate(([0.0], np.cumsum(given.sum(axis=0))[:-1]))
    return _Panels(load.start, load.width, np.vstack((begins, given)), power)


# -- on a grid ----------------------------------------------------------------------------------------------


def _on_grid(curves: _Curves, spacings: Sequence[Spacing]) -> list[np.ndarray]:
    """The best of all phases on a grid, those that keep the spacings to a step of it: local optima, the best first."""
    grid, count, size = curves.grid, curves.count, curves.samples.shape[1]
    axes = np.meshgrid(*[np.arange(grid)] * (count - 1), indexing="ij", sparse=True) if count > 1 else []
    shape = (grid,) * (count - 1)
    kept = np.ones(shape, dtype=bool)
    steps = [np.zeros(1, dtype=int), *axes]
    for each in spacings:
        spare = each.spare + (steps[each.second] - steps[each.first]) * (TURN / grid)
        kept = kept & (
            (np.mod(spare + 0.5 * TURN, TURN) >= 0.5 * TURN - TURN / grid)
            | (np.mod(spare, TURN) > TURN * (1.0 - 1.0 / grid))
        )
    samples = curves.samples.astype(np.float32)
    shifts = (np.arange(size) - PER_STEP * np.arange(grid)[:, None]) % size
    value = np.full(shape, np.inf, dtype=np.float32).reshape(-1, grid if count > 1 else 1)
    partial = samples[:1]
    for row in samples[1:-1]:
        partial = (partial[:, None, :] + row[shifts][None]).reshape(-1, size)
    some = np.flatnonzero(kept.reshape(value.shape).any(axis=1))
    last = samples[-1][shifts] if count > 1 else np.zeros((1, size), dtype=np.float32)
    for part in np.array_split(some, max(1, some.size * last.size // BLOCK)):
        checkpoint()
        value[part] = curves.aim.reached(partial[part][:, None, :] + last[None])
    value = np.where(kept, value.reshape(shape), np.inf)
    lowest = np.isfinite(value)
    for axis, by in product(range(count - 1), (-1, 1)):
        lowest &= value <= np.roll(value, by, axis=axis)
    places = np.flatnonzero(lowest)
    order = places[np.argsort(value.ravel()[places], kind="stable")][: 4 * CANDIDATES]
    found = np.array(np.unravel_index(order, shape)).T if shape else np.zeros((1, 0))
    return [np.concatenate(([0.0], row * (TURN / grid))) for row in found]


def _pairwise(curves: _Curves, spacings: Sequence[Spacing]) -> list[np.ndarray]:
    """Of many drives: from several starts two drives at a time take the best of all their phases, as long as that helps."""
    step, found = TURN / curves.grid, []
    pairs = list(combinations(range(1, curves.count), 2))
    first, second = (each.ravel() * step for each in np.meshgrid(np.arange(curves.grid), np.arange(curves.grid)))
    for number in range(CANDIDATES):
        turned = np.concatenate(([0.0], TURN * np.mod(number * np.sqrt(np.arange(2, curves.count + 1) * 1.37), 1.0)))
        start = _within(np.rint(turned / step) * step, spacings)
        if start is None:
            continue
        improved = True
        while improved:
            improved = False
            for i, j in pairs:
                checkpoint()
                tried = np.repeat(start[None], first.size, axis=0)
                tried[:, i], tried[:, j] = first, second
                reached = np.where(_keeps(tried, spacings), curves.of_pair(start, i, j), np.inf)
                best = int(np.argmin(reached))
                if reached[best] < curves.reached(start) * (1.0 - 1e-9):
                    start, improved = tried[best], True
        found.append(start)
    return found


def _keeps(turned: np.ndarray, spacings: Sequence[Spacing]) -> np.ndarray:
    """Which phases (m, n) keep all spacings."""
    kept = np.ones(turned.shape[0], dtype=bool)
    for each in spacings:
        spare = each.spare + turned[:, each.second] - turned[:, each.first]
        kept &= np.mod(spare + 0.5 * TURN, TURN) >= 0.5 * TURN - ROUNDING
    return kept


# -- on the exact curves ------------------------------------------------------------------------------------


def _rows(turned: np.ndarray, spacings: Sequence[Spacing]) -> tuple[np.ndarray, np.ndarray]:
    """The spacings as A d <= b of a change d (n - 1,) of all phases but the first, each on the side where it is nearest to be kept."""
    count = turned.size - 1
    sides = np.zeros((2 * len(spacings), count + 1))
    room = np.zeros(2 * len(spacings))
    for k, each in enumerate(spacings):
        spare = each.spare + turned[each.second] - turned[each.first]
        spare = np.mod(spare + 0.5 * TURN, TURN) - 0.5 * TURN  # -π ... π
        if spare < -0.25 * TURN:
            spare += TURN  # beyond the far side
        sides[2 * k, each.first] += 1.0
        sides[2 * k, each.second] -= 1.0
        sides[2 * k + 1] = -sides[2 * k]
        room[2 * k : 2 * k + 2] = spare, 0.5 * TURN - 1e-9 - spare
    return sides[:, 1:], room


def _programme(
    cost: np.ndarray, sides: np.ndarray, room: np.ndarray, bounds: list[tuple[float | None, float | None]]
) -> np.ndarray | None:
    from scipy.optimize import linprog

    found = linprog(cost, A_ub=sides, b_ub=room, bounds=bounds, method="highs")
    return np.asarray(found.x) if found.status == 0 else None


def _within(turned: np.ndarray, spacings: Sequence[Spacing]) -> np.ndarray | None:
    """The nearest phases that keep the spacings; None where none do nearby."""
    if _keeps(turned[None], spacings)[0]:
        return turned
    sides, room = _rows(turned, spacings)
    count = turned.size - 1
    eye = np.eye(count)
    both = np.block([[sides, np.zeros((sides.shape[0], count))], [eye, -eye], [-eye, -eye]])
    found = _programme(
        np.concatenate((np.zeros(count), np.ones(count))),
        both,
        np.concatenate((room, np.zeros(2 * count))),
        [(None, None)] * count + [(0.0, None)] * count,
    )
    if found is None:
        return None
    moved = turned + np.concatenate(([0.0], found[:count]))
    return moved if _keeps(moved[None], spacings)[0] else None


def _refined(
    curves: _Curves, turned: np.ndarray, spacings: Sequence[Spacing], steps: int, radius: float = np.inf
) -> np.ndarray:
    """The local optimum beside: planes of the highest pieces, a linear programme within a radius, which shrinks where it fails."""
    count = curves.count - 1
    if not count:
        return turned
    radius = min(radius, TURN / curves.grid)
    reached, signs, values, gradients = curves.pieces(turned)
    for _ in range(steps):
        checkpoint()
        tops = np.array([values[signs == sign].max(initial=-np.inf) for sign in (1.0, -1.0)])
        top = tops if curves.aim.integrated else np.full(2, tops.max())
        near = values >= np.where(signs > 0.0, top[0], top[1]) - (1.0 - NEAR) * np.abs(reached)
        up, own = signs[near] > 0.0, gradients[near][:, 1:]
        level = np.column_stack(
            (-up.astype(float), -(~up).astype(float)) if curves.aim.integrated else (-np.ones(up.size),)
        )
        sides, room = _rows(turned, spacings)
        both = np.vstack(
            (np.column_stack((own, level)), np.column_stack((sides, np.zeros((sides.shape[0], level.shape[1])))))
        )
        step = _programme(
            np.concatenate((np.zeros(count), np.ones(level.shape[1]))),
            both,
            np.concatenate((-values[near], room)),
            [(-radius, radius)] * count + [(None, None)] * level.shape[1],
        )
        if step is None:
            break
        tried = turned + np.concatenate(([0.0], step[:count]))
        made = curves.pieces(tried)
        expected = reached - float(step[count:].sum())
        if made[0] < reached - 0.1 * expected and _keeps(tried[None], spacings)[0]:
            whole = reached - made[0] > 0.75 * expected
            turned, (reached, signs, values, gradients) = tried, made
            radius *= 2.0 if whole else 0.5 if reached else 1.0
        else:
            radius *= 0.25
        if radius < LEAST_STEP or expected <= FLAT * abs(reached):
            break
    return turned
