"""What the designer asks for, solved over a family. In all free numbers but one the equations are linear; the one left
is a bracketed root. Every refusal knows the range that would have been accepted."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from math import inf, isfinite, nan

import numpy as np

from core.blend.family import Family, Solution, Task
from core.blend.roots import Interval, existing_intervals, extent, roots

HEIGHTS = ("h1", "h2", "h3", "h4", "h5", "h6")
SETTINGS = (*HEIGHTS, "vcv", "vcv2", "length", "peak", "acceleration")
Found = Mapping[str, float]
_At = Callable[[float], Found | None]


class Infeasible(Exception):
    """No curve does what is asked. ``setting`` and ``value`` name the wish; ``allowed`` (low, high) is what it may be
    while the other settings stay, None where these leave nothing. An open end can only be approached."""

    def __init__(self, setting: str, value: float, allowed: tuple[float, float] | None) -> None:
        super().__init__(setting)
        self.setting, self.value, self.allowed = setting, value, allowed


class Problem:
    """A family, a task and as many settings as the family has free numbers."""

    def __init__(self, family: Family, task: Task, settings: Mapping[str, float]) -> None:
        self.family, self.task, self.settings = family, task, dict(settings)

    # -- equations ----------------------------------------------------------------------------------------

    def measure(self, name: str, found: Found) -> float:
        """The value of a setting in a point of the family."""
        if name in HEIGHTS:
            return found.get(name, 0.0)
        speed = found["W"] / self.task.span
        if name == "vcv":
            return speed
        if name == "vcv2":
            return found["r"] * speed
        if name == "length":
            constant_rise = self.family.has_constant_rise
            return found["h2"] / speed if constant_rise else found["h5"] / (found["r"] * speed)
        if name == "peak":
            return self.family.rise_work(found) / speed
        return self.family.solution(self.task, found).peak_acceleration

    def _miss(self, name: str, value: float, found: Found) -> float:
        """The setting's equation multiplied out: linear in the linear numbers (but for the acceleration)."""
        span = self.task.span
        if name in HEIGHTS:
            return found.get(name, 0.0) - value
        if name == "vcv":
            return found["W"] - value * span
        if name == "vcv2":
            return found["r"] * found["W"] - value * span
        if name == "peak":
            return self.family.rise_work(found) * span - value * found["W"]
        if self.family.has_constant_rise:
            return found["h2"] * span - value * found["W"]
        return found["h5"] * span - value * found["r"] * found["W"]

    def feasible(self, found: Found) -> bool:
        """All heights positive, those of constant velocity perhaps zero."""
        return all(found[n] > 0.0 for n in self.family.positive) and all(found[n] >= 0.0 for n in self.family.constant)

    # -- points -------------------------------------------------------------------------------------------

    def _point(self, bent: Mapping[str, float], settings: Sequence[tuple[str, float]]) -> Found | None:
        """The point with the bent number given and the linear ones found from as many settings."""
        names = self.family.linear
        if not names:
            return self.family.solve(self.task, bent)
        scale = self.task.rise
        zero = dict.fromkeys(names, 0.0)
        at_zero = self.family.solve(self.task, {**bent, **zero})
        start = np.array([self._miss(n, v, at_zero) for n, v in settings])
        slope = np.empty((len(settings), len(names)))
        for j, name in enumerate(names):
            there = self.family.solve(self.task, {**bent, **zero, name: scale})
            slope[:, j] = [self._miss(n, v, there) for n, v in settings]
        slope -= start[:, None]
        size = np.abs(slope).max(axis=1, initial=0.0) + np.abs(start)
        if not np.isfinite(size).all() or (size == 0.0).any():
            return None
        matrix = slope / size[:, None]
        if abs(np.linalg.det(matrix)) < 1e-12:
            return None
        solved = np.linalg.solve(matrix, -start / size) * scale
        exact = dict(settings)
        free = {n: exact.get(n, float(x)) for n, x in zip(names, solved, strict=True)}
        return self.family.solve(self.task, {**bent, **free})

    def _bent_value(self, x: float) -> float:
        """The bent number from 0 ... 1; a ratio of speeds may be anything above 0."""
        if self.family.bent == "r":
            return x / (1.0 - x) if x < 1.0 else inf
        return x * self.task.rise

    def _curve(self, settings: Sequence[tuple[str, float]]) -> _Curve:
        bent = self.family.bent

        def at(x: float) -> Found | None:
            value = self._bent_value(x)
            if not isfinite(value) or (bent == "r" and not 1e-9 <= value <= 1e9) or (bent == "s" and value <= 0.0):
                return None
            return self._point({bent: value}, settings)

        return _Curve(at, self)

    # -- solving ------------------------------------------------------------------------------------------

    def solve(self) -> list[Solution]:
        """Every solution, the gentlest first. Raises Infeasible."""
        points = [p for p in self._points() if self.feasible(p)]
        if not points:
            raise self._refusal()
        solutions = [self.family.solution(self.task, p) for p in points]
        return sorted(solutions, key=lambda s: s.peak_acceleration)

    def at_bent(self) -> Solution | None:
        """The solution where the bent number is among the settings and the others are linear; None where it is not
        feasible."""
        rest = [(n, v) for n, v in self.settings.items() if n != self.family.bent]
        point = self._point({self.family.bent: self.settings[self.family.bent]}, rest)
        return self.family.solution(self.task, point) if point is not None and self.feasible(point) else None

    def _points(self) -> list[Found]:
        asked = list(self.settings.items())
        if not self.family.bent:
            return [self.family.solve(self.task, {})]
        if self.family.bent in self.settings:
            rest = [(n, v) for n, v in asked if n != self.family.bent]
            if not any(n == "acceleration" for n, _ in rest):
                point = self._point({self.family.bent: self.settings[self.family.bent]}, rest)
                if point is not None or len(rest) == 0:
                    return [] if point is None else [point]
        for (name, value), others in self._splits(asked):
            curve = self._curve(others)
            intervals = curve.intervals()
            if intervals or name == asked[-1][0]:
                return [p for i in intervals for p in curve.where(name, value, i)]
        return []

    def _splits(self, asked: list[tuple[str, float]]) -> list[tuple[tuple[str, float], list[tuple[str, float]]]]:
        """Ways to choose the setting that the root is found for; the others must be independent. An acceleration is
        never linear, so it is that one."""
        order = sorted(range(len(asked)), key=lambda i: asked[i][0] != "acceleration")
        if any(n == "acceleration" for n, _ in asked):
            order = order[:1]
        splits = []
        for i in order:
            others = asked[:i] + asked[i + 1 :]
            if self._independent(others):
                splits.append((asked[i], others))
        return splits

    def _independent(self, settings: Sequence[tuple[str, float]]) -> bool:
        probes = (0.31, 0.5, 0.13, 0.83)
        return any(self._curve(settings).at(x) is not None for x in probes)

    # -- ranges -------------------------------------------------------------------------------------------

    def range_of(self, name: str) -> tuple[float, float] | None:
        """What this setting may be while the others stay; None where they leave nothing, or do not determine it."""
        others = [(n, v) for n, v in self.settings.items() if n != name]
        if any(n == "acceleration" for n, _ in others) or not self.family.bent:
            return None
        bent = self.family.bent
        if bent in dict(others):
            return self._range_beside_bent(name, dict(others))
        if not self._independent(others):
            return None
        curve = self._curve(others)
        return _hull([extent(partial(curve.measure, name), i) for i in curve.intervals()])

    def _range_beside_bent(self, name: str, others: dict[str, float]) -> tuple[float, float] | None:
        """The same where the bent number itself is given: the family left over is looked along a linear one."""
        bent = {self.family.bent: others.pop(self.family.bent)}
        rest = list(others.items())
        names = [n for n in self.family.linear if n not in others]
        for along in names:

            def at(x: float, along: str = along) -> Found | None:
                return self._point(bent, [*rest, (along, x * self.task.rise)])

            if all(at(x) is None for x in (0.31, 0.5)):
                continue
            curve = _Curve(at, self)
            return _hull([extent(partial(curve.measure, name), i) for i in curve.intervals()])
        return None

    def _refusal(self) -> Infeasible:
        """The last setting to which the others leave a range, and that range; else the first that is out of all
        bounds."""
        for name in reversed(self.settings):
            allowed = self.range_of(name)
            if allowed is not None:
                return Infeasible(name, self.settings[name], allowed)
        limits = {"length": self.task.span, "peak": self.task.span, **dict.fromkeys(HEIGHTS[:3], self.task.rise)}
        limits.update(dict.fromkeys(HEIGHTS[3:], self.task.back))
        for name, value in self.settings.items():
            if name in limits and not 0.0 < value < limits[name]:
                return Infeasible(name, value, (0.0, limits[name]))
        name = next(reversed(self.settings))
        return Infeasible(name, self.settings[name], None)


class _Curve:
    """The points of a family that meet all settings but one, along a number from 0 to 1."""

    def __init__(self, at: _At, problem: Problem) -> None:
        self.at, self._problem = at, problem

    def intervals(self) -> list[Interval]:
        """Where the points are feasible."""
        return existing_intervals(self._exists, 0.0, 1.0)

    def _exists(self, x: float) -> bool:
        point = self.at(x)
        return point is not None and self._problem.feasible(point)

    def measure(self, name: str, x: float) -> float:
        point = self.at(x)
        return nan if point is None else self._problem.measure(name, point)

    def where(self, name: str, value: float, interval: Interval) -> list[Found]:
        """The points of an interval at which a setting has its value."""
        found = [self.at(x) for x in roots(lambda x: self.measure(name, x) - value, interval)]
        return [p for p in found if p is not None]


def _hull(ranges: Sequence[tuple[float, float]]) -> tuple[float, float] | None:
    return (min(a for a, _ in ranges), max(b for _, b in ranges)) if ranges else None
