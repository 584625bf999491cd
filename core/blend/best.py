"""The gentlest of all blended motions: least peak acceleration, jerk or inertia torque over what is left free."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from itertools import product
from math import inf
from types import MappingProxyType

import numpy as np

from core.blend.family import Solution, Task
from core.blend.request import Blended, BlendError, Candidate, Request, answered, candidates, prepared
from core.blend.solver import Infeasible, Problem
from core.laws import find_law, peaks

GRIDS = {1: 41, 2: 11}  # points of a free number looked at first
RESTARTS = 4


@lru_cache(maxsize=64)
def _coefficients(curve: str) -> tuple[float, float, float]:
    law = find_law(curve)
    assert law is not None
    found = peaks(law)
    return found.ca, found.cj, found.cm


def peak_acceleration(solution: Solution) -> float:
    """Largest |a| [per deg²]."""
    return solution.peak_acceleration


def _peak(solution: Solution, order: int, heights: int, spans: int) -> float:
    parts = zip(solution.sequence.curves, solution.heights, solution.spans, strict=True)
    return max((_coefficients(n.lower())[order] * h**heights / b**spans if b > 0.0 else 0.0) for n, h, b in parts)


def peak_jerk(solution: Solution) -> float:
    """Largest |jerk| inside the curves [per deg³]."""
    return _peak(solution, 1, 1, 3)


def peak_torque(solution: Solution) -> float:
    """Largest |v a|, to which the inertia torque on the camshaft is proportional."""
    return _peak(solution, 2, 2, 3)


GOALS: Mapping[str, Callable[[Solution], float]] = MappingProxyType(
    {"acceleration": peak_acceleration, "jerk": peak_jerk, "torque": peak_torque}
)


def best(request: Request, goal: str) -> Blended:
    """The gentlest motion by a goal of ``GOALS`` among all sequences of the request, its settings kept.

    With a constant velocity asked for, its length wants a setting (``length`` or ``h2``): else the least would be none.
    Raises BlendError.
    """
    if goal not in GOALS:
        raise BlendError(f"best {goal!r}: unknown; allowed: {' | '.join(GOALS)}")
    winner: tuple[float, Candidate, Solution] | None = None
    refusal: BlendError | None = None
    for candidate in candidates(request):
        if candidate.freedom < len(request.settings):
            continue
        try:
            value, solution = _best_of(request, candidate, GOALS[goal])
        except BlendError as error:
            refusal = refusal or error
            continue
        if winner is None or value < winner[0] * (1.0 - 1e-12):
            winner = value, candidate, solution
    if winner is None:
        raise refusal or BlendError("no sequence of this motion takes these settings")
    return answered(request, winner[1], winner[2])


def _best_of(request: Request, candidate: Candidate, goal: Callable[[Solution], float]) -> tuple[float, Solution]:
    """The best over the free numbers that the settings leave."""
    task, wanted = prepared(request, candidate)
    family = candidate.family
    # with the bent number given, settings and the rest are linear: no root is needed
    plain = bool(family.bent) and family.bent not in wanted and len(wanted) <= len(family.linear)
    plain = plain and "acceleration" not in wanted
    names = _open_names(candidate, wanted, plain)

    def at(x: np.ndarray) -> tuple[float, Solution | None]:
        if (x <= 0.0).any() or (x >= 1.0).any():
            return inf, None
        numbers = {n: _number(n, float(v), task) for n, v in zip(names, x, strict=True)}
        problem = Problem(family, task, {**wanted, **numbers})
        try:
            solution = problem.at_bent() if plain else problem.solve()[0]
        except Infeasible:
            return inf, None
        return (goal(solution), solution) if solution is not None else (inf, None)

    if not names:
        value, solution = at(np.array([]))
        if solution is None:
            raise BlendError("these settings are not feasible together")
        return value, solution
    return _search(at, len(names))


def _number(name: str, x: float, task: Task) -> float:
    return x / (1.0 - x) if name == "r" else x * (task.back if name == "h6" else task.rise)


def _open_names(candidate: Candidate, wanted: Mapping[str, float], plain: bool) -> list[str]:
    """Which free numbers to vary: as many as the settings leave, those that are set being left out."""
    family = candidate.family
    if plain:
        others = [n for n in family.linear if n not in wanted]
        return [family.bent, *others[: len(family.linear) - len(wanted)]]
    left = [n for n in family.free if n not in wanted]
    return left[len(left) - (candidate.freedom - len(wanted)) :]


def _search(at: Callable[[np.ndarray], tuple[float, Solution | None]], n: int) -> tuple[float, Solution]:
    """The best of a grid, refined by the simplex method: the goal is the larger of several smooth ones, so it has
    edges; the simplex is begun anew until it finds nothing better."""
    from scipy.optimize import minimize

    axis = (np.arange(GRIDS[n]) + 0.5) / GRIDS[n] if n in GRIDS else None
    points = _spread(n) if axis is None else [np.array(p) for p in product(axis, repeat=n)]
    x = min(points, key=lambda p: at(p)[0])
    value, solution = at(x)
    if solution is None:
        raise BlendError("these settings leave nothing feasible")
    size = 0.5 / GRIDS.get(n, 8)
    for _ in range(RESTARTS):
        simplex = np.clip(np.vstack([x, x + size * np.eye(n)]), 1e-9, 1.0 - 1e-9)
        options = {"initial_simplex": simplex, "xatol": 1e-10, "fatol": 1e-13 * value, "maxfev": 150 * n}
        found = minimize(lambda p: at(p)[0], x, method="Nelder-Mead", options=options)
        gained = value - found.fun
        if found.fun < value:
            x, value = found.x, float(found.fun)
        if gained <= 1e-12 * value:
            break
    solution = at(x)[1]
    assert solution is not None
    return value, solution


def _spread(n: int) -> list[np.ndarray]:
    """Points of a Sobol-like spread for three and more numbers."""
    generator = np.random.default_rng(1995)
    return list(generator.random((200, n)))


__all__ = ["GOALS", "best", "peak_acceleration", "peak_jerk", "peak_torque"]
