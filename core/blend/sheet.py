"""Sheets: the points of a family that meet linear wishes. With the bent number given, all other equations are linear."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import combinations

import numpy as np

from core.blend.family import Family, Task
from core.blend.roots import Interval, roots
from core.blend.wishes import Found, Wish, miss

SINGULAR = 1e-12
PROBES = np.array([0.31, 0.5, 0.13, 0.83, 0.047])
_RATIOS = (1e-9, 1e9)  # of the speeds of return and rise
TINY = 1e-300
ROUNDING = 1e-13


class Sheet:
    """Points over coordinates 0 ... 1: the bent number first unless it is given, then the linear ones ``along``."""

    def __init__(
        self, family: Family, task: Task, wishes: Sequence[Wish], along: Sequence[str] = (), bent: float | None = None
    ) -> None:
        self._family, self._task, self._bent = family, task, bent
        self._wishes, self._along = tuple(wishes), tuple(along)

    @property
    def coordinates(self) -> int:
        return len(self._along) + (self._bent is None and bool(self._family.bent))

    def at(self, x: np.ndarray) -> Found:
        """The points at coordinates (k, n); nan where there is none."""
        family, task = self._family, self._task
        if not family.bent:
            return family.solve(task, {})
        n = x.shape[1]
        bent = np.full(n, self._bent) if self._bent is not None else _bent_value(family, task, x[0])
        offset = x.shape[0] - len(self._along)
        exact = {w.name: np.full(n, w.value) for w in self._wishes}
        exact.update({name: x[offset + i] * _scale(name, task) for i, name in enumerate(self._along)})
        with np.errstate(all="ignore"):
            free = _linear_numbers(family, task, bent, self._wishes, exact)
            return family.solve(task, {family.bent: bent, **free})


def slack(family: Family, task: Task, found: Found) -> np.ndarray:
    """The least height as a share of the stroke: below 0 where a height is negative, or 0 where it must not be, nan where
    there is no point. A height of constant velocity that is 0 but for rounding is 0."""
    if not family.positive:
        return np.ones(1)
    rows = [np.where(found[n] == 0.0, -TINY, found[n]) for n in family.positive]
    rows += [np.where(np.abs(found[n]) <= ROUNDING * task.rise, 0.0, found[n]) for n in family.constant]
    least = np.min(rows, axis=0) / task.rise
    return np.where(np.isfinite(found["W"]), least, np.nan)


def _bent_value(family: Family, task: Task, x: np.ndarray) -> np.ndarray:
    """The bent number from 0 ... 1; a ratio of speeds may be anything above 0."""
    if family.bent == "r":
        with np.errstate(divide="ignore"):
            ratio = x / (1.0 - x)
        return np.where((ratio >= _RATIOS[0]) & (ratio <= _RATIOS[1]), ratio, np.nan)
    return np.where(x > 0.0, x * task.rise, np.nan)


def _scale(name: str, task: Task) -> float:
    return task.back if name == "h6" else task.rise


def _rows(family: Family, task: Task, bent: np.ndarray, wishes: Sequence[Wish]) -> tuple[np.ndarray, np.ndarray]:
    """The wishes' equations, slope · x + start = 0 with x the linear numbers as shares of the stroke of the rise:
    slope (n, wishes, numbers), start (n, wishes)."""
    names = family.linear
    zero = dict.fromkeys(names, np.zeros_like(bent))
    at_zero = family.solve(task, {family.bent: bent, **zero})
    start = np.array([np.broadcast_to(miss(w, family, task, at_zero), bent.shape) for w in wishes])
    slope = np.empty((len(wishes), len(names), bent.size))
    for j, name in enumerate(names):
        there = family.solve(task, {family.bent: bent, **zero, name: np.full_like(bent, task.rise)})
        for i, wish in enumerate(wishes):
            slope[i, j] = miss(wish, family, task, there) - start[i]
    return np.moveaxis(slope, 2, 0), start.T


def _linear_numbers(
    family: Family, task: Task, bent: np.ndarray, wishes: Sequence[Wish], exact: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """The linear numbers: those that are given, the others from the wishes' equations."""
    names = family.linear
    open_names = [j for j, n in enumerate(names) if n not in exact]
    if not open_names:
        return {n: exact[n] for n in names}
    equations = [w for w in wishes if w.name not in names]
    if len(equations) != len(open_names):
        return {n: np.full_like(bent, np.nan) for n in names}
    slope, start = _rows(family, task, bent, equations)
    for j, name in enumerate(names):
        if name in exact:
            start = start + slope[:, :, j] * (exact[name] / task.rise)[:, None]
    size = np.abs(slope).max(axis=2, initial=0.0) + np.abs(start)
    size = np.where((size > 0.0) & np.isfinite(size), size, np.nan)
    x = _solved(slope[:, :, open_names] / size[:, :, None], -start / size) * task.rise
    found = {names[j]: x[:, i] for i, j in enumerate(open_names)}
    return {n: exact[n] if n in exact else found[n] for n in names}


def _solved(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """x (n, m) of matrix (n, m, m); nan where the equations do not determine it."""
    m = matrix.shape[1]
    if m == 1:
        pivot = matrix[:, 0, 0]
        return (right[:, 0] / np.where(np.abs(pivot) > SINGULAR, pivot, np.nan))[:, None]
    if m == 2:
        (a, b), (c, d) = matrix[:, 0].T, matrix[:, 1].T
        det = a * d - b * c
        det = np.where(np.abs(det) > SINGULAR, det, np.nan)
        return np.stack([(right[:, 0] * d - b * right[:, 1]) / det, (a * right[:, 1] - c * right[:, 0]) / det], axis=1)
    bad = ~(np.abs(np.linalg.det(np.nan_to_num(matrix))) > SINGULAR) | ~np.isfinite(matrix).all(axis=(1, 2))
    solved = np.linalg.solve(np.where(bad[:, None, None], np.eye(m), matrix), np.nan_to_num(right)[:, :, None])[:, :, 0]
    return np.where(bad[:, None], np.nan, solved)


def sheets(family: Family, task: Task, wishes: Sequence[Wish], coordinates: int) -> list[Sheet]:
    """Sheets of that many coordinates on which the points that meet linear wishes lie; several where the wishes pin the
    bent number to several values, none where one follows from the others, or they contradict each other."""
    rest = [w for w in wishes if w.name != family.bent]
    if len(rest) < len(wishes):
        pinned = [next(w.value for w in wishes if w.name == family.bent)]
        return _with_bent(family, task, rest, coordinates, pinned)
    free = [n for n in family.linear if n not in {w.name for w in wishes}]
    for along in combinations(reversed(free), coordinates - 1) if coordinates else ():
        sheet = Sheet(family, task, rest, along)
        if np.isfinite(sheet.at(np.vstack([PROBES] * coordinates))["W"]).any():
            return [sheet]
    return _with_bent(family, task, rest, coordinates, _pinned(family, task, rest))


def _with_bent(family: Family, task: Task, rest: list[Wish], coordinates: int, values: list[float]) -> list[Sheet]:
    """Sheets with the bent number given; an equation too many is one that gave it."""
    wanted = len(family.linear) - coordinates
    found = []
    for bent in values:
        for kept in combinations(rest, wanted):
            free = [n for n in family.linear if n not in {w.name for w in kept}]
            sheet = next(
                (
                    made
                    for along in combinations(reversed(free), coordinates)
                    if np.isfinite((made := Sheet(family, task, kept, along, bent)).at(_probes(coordinates))["W"]).any()
                ),
                None,
            )
            if sheet is not None:
                found.append(sheet)
                break
    return found


def _probes(coordinates: int) -> np.ndarray:
    return np.vstack([PROBES] * coordinates) if coordinates else np.empty((0, 1))


def _pinned(family: Family, task: Task, wishes: list[Wish]) -> list[float]:
    """Values of the bent number at which equations that are dependent for all others agree: h3 and h4 give the ratio of
    the speeds. With all rows of the slope dependent, a minor bordered by the right sides must vanish."""
    m, names = len(wishes), family.linear

    def minor(columns: tuple[int, ...], x: np.ndarray) -> np.ndarray:
        with np.errstate(all="ignore"):
            slope, start = _rows(family, task, _bent_value(family, task, x), wishes)
            bordered = np.concatenate((slope[:, :, list(columns)], start[:, :, None]), axis=2) / sizes[:, None]
            finite = np.isfinite(bordered).all(axis=(1, 2))
            return np.where(finite, np.linalg.det(np.nan_to_num(bordered)), np.nan)

    if not 1 <= m <= len(names) + 1:
        return []
    slope, start = _rows(family, task, _bent_value(family, task, PROBES), wishes)
    sizes = np.abs(slope).max(axis=(0, 2), initial=0.0) + np.abs(start).max(axis=0)
    for columns in combinations(range(len(names)), m - 1):
        if np.nanmax(np.abs(minor(columns, PROBES)), initial=0.0) > 1e-9:
            found = roots(partial(minor, columns), Interval(1e-9, 1.0 - 1e-9), 0.0)
            return [float(_bent_value(family, task, np.array([x]))[0]) for x in found]
    return []
