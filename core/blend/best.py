"""The gentlest of all blended motions: least peak acceleration, jerk or inertia torque over what is left free."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from core.blend.curves import CONSTANT
from core.blend.family import Solution
from core.blend.ranges import refusal
from core.blend.request import (
    Blended,
    BlendError,
    Candidate,
    Request,
    answered,
    candidates,
    means_something,
    problem_of,
    require_sense,
    wishes_of,
)
from core.blend.sheet import slack
from core.blend.solver import Determined, Problem
from core.blend.wishes import Found, Wish, measure
from core.laws import find_law, peaks

GRIDS = {1: 401, 2: 61, 3: 15}  # points of a free number looked at first
SPREAD = 4000  # points for four and more numbers
STARTS = 4  # of these points the best are refined
RESTARTS = 4
GONE = 1e-6  # a stretch of constant velocity shorter than this share of the stroke is none

Goal = tuple[int, int, int]
"""Which peak coefficient of a curve counts, and the powers of height and of span in it: c h^i / β^k."""

GOALS: Mapping[str, Goal] = MappingProxyType({"acceleration": (0, 1, 2), "jerk": (1, 1, 3), "torque": (2, 2, 3)})


@lru_cache(maxsize=64)
def _coefficients(curve: str) -> tuple[float, float, float]:
    law = find_law(curve.lower())
    assert law is not None
    found = peaks(law)
    return found.ca, found.cj, found.cm


def peaks_by_curve(goal: Goal, curves: Sequence[str], heights: np.ndarray, spans: np.ndarray) -> np.ndarray:
    """Largest |a| [per deg²], |jerk| inside the curve [per deg³] or |v a|, to which the inertia torque on the camshaft is
    proportional, of each curve that has any; heights and spans (curves, n)."""
    which, power, root = goal
    rows = zip(curves, heights, spans, strict=True)
    return np.array([c * h**power / b**root for name, h, b in rows if (c := _coefficients(name)[which])])


def peak_of(goal: Goal, solution: Solution) -> float:
    """The same of a solution."""
    heights, spans = (np.array(rows)[:, None] for rows in (solution.heights, solution.spans))
    return float(peaks_by_curve(goal, solution.sequence.curves, heights, spans).max())


def best(request: Request, goal: str) -> Blended:
    """The gentlest motion by a goal of ``GOALS`` among all sequences of the request, its settings kept; ``length`` is the
    least that is asked for.

    Raises BlendError; also where a constant velocity is asked for and the gentlest would have none.
    """
    if goal not in GOALS:
        raise BlendError(f"best {goal!r}: unknown; allowed: {' | '.join(GOALS)}")
    require_sense(request)
    winner: tuple[float, Candidate, Solution] | None = None
    for candidate in candidates(request):
        for value, solution in _of_candidate(request, candidate, GOALS[goal]):
            if winner is None or value < winner[0] * (1.0 - 1e-9):
                winner = value, candidate, solution
    if winner is None:
        raise _nothing(request)
    _, candidate, solution = winner
    if _has_lost_a_constant_velocity(solution):
        raise BlendError(f"best {goal}: the gentlest has no constant velocity left; give its length or height")
    return answered(request, candidate, solution)


def _has_lost_a_constant_velocity(solution: Solution) -> bool:
    rows = list(zip(solution.sequence.curves, solution.heights, strict=True))
    return any(h <= GONE * max(solution.heights) for name, h in rows if name in CONSTANT)


def _of_candidate(request: Request, candidate: Candidate, goal: Goal) -> list[tuple[float, Solution]]:
    """The best of a sequence with the length as it is asked, and the best where it is longer."""
    found = []
    for asked, least in _readings(request):
        wishes = wishes_of(asked)
        if candidate.freedom < len(wishes) or not means_something(candidate, wishes_of(request)):
            continue
        problem = problem_of(asked, candidate, wishes)
        answer = _best_of(problem, goal, least)
        if answer is not None:
            found.append(answer)
    return found


def _readings(request: Request) -> list[tuple[Request, float]]:
    """The request as it stands; and with the length let go, and the least that it may be."""
    if "length" not in request.settings:
        return [(request, 0.0)]
    others = {n: v for n, v in request.settings.items() if n != "length"}
    return [(request, 0.0), (replace(request, settings=others), request.settings["length"])]


def _nothing(request: Request) -> BlendError:
    """Why no sequence does it: what the last setting may be while the others stay."""
    wishes = wishes_of(request)
    able = [c for c in candidates(request) if c.freedom >= len(wishes) and means_something(c, wishes)]
    if not able:
        return BlendError(f"no sequence of this motion takes these settings: {', '.join(request.settings)}")
    return refusal(request, able, wishes)


def _best_of(problem: Problem, goal: Goal, least_length: float) -> tuple[float, Solution] | None:
    """The best over the free numbers that the wishes leave; None where they leave nothing."""
    family, task, n = problem.family, problem.task, len(problem.family.free) - len(problem.wishes)
    if n == 0:
        try:
            solutions = problem.solutions()
        except Determined:
            return None
        rows = [(peak_of(goal, s), s) for s in solutions if _length(s) >= least_length * (1.0 - 1e-12)]
        return min(rows, key=lambda p: p[0], default=None)
    tops = [_search(_Ground(problem, sheet, goal, least_length), n) for sheet in problem.spaces()]
    able = [(value, at) for value, at in tops if np.isfinite(value)]
    if not able:
        return None
    value, found = min(able, key=lambda t: t[0])
    return value, family.solution(task, found)


def _length(solution: Solution) -> float:
    """Span of the constant velocity [deg]: of the rise where it has one."""
    rows = zip(solution.sequence.curves, solution.spans, strict=True)
    return next((span for name, span in rows if name in CONSTANT), 0.0)


class _Ground:
    """What is searched: points over the open unit cube, what is asked of them, and how good they are."""

    def __init__(self, problem: Problem, at: Callable[[np.ndarray], Found], goal: Goal, least_length: float) -> None:
        self.problem, self.at, self.goal, self.least_length = problem, at, goal, least_length

    def __call__(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Logarithms of the curves' peaks (curves, n); margins (m, n), below 0 where not feasible."""
        family, task = self.problem.family, self.problem.task
        with np.errstate(all="ignore"):
            found = self.at(x)
            rows = np.log(peaks_by_curve(self.goal, family.sequence.curves, *family.parts(task, found)))
            margins = [slack(family, task, found)]
            margins += [found[name] / task.rise for name in (*family.positive, *family.constant)]
            if self.least_length:
                margins.append(measure(Wish("length", 0.0), family, task, found) / self.least_length - 1.0)
        return rows, np.array(margins)

    def values(self, x: np.ndarray) -> np.ndarray:
        """The goal (n,), infinite where not feasible."""
        rows, margins = self(x)
        with np.errstate(all="ignore"):
            good = (margins[0] >= 0.0) & (margins[-1] >= -1e-13) & np.isfinite(rows).all(axis=0)
            return np.where(good, np.exp(rows.max(axis=0)), np.inf)


def _search(ground: _Ground, n: int) -> tuple[float, Found]:
    """The best of a grid, refined as a smooth problem: the least t that no curve's peak exceeds."""
    points = _grid(n)
    values = ground.values(points)
    best, at = np.inf, points[:, 0]
    for i in np.argsort(values)[:STARTS]:
        if not np.isfinite(values[i]):
            break
        x = _refined(ground, points[:, i], float(values[i]))
        value = float(ground.values(x[:, None])[0])
        if value < best:
            best, at = value, x
    return best, ground.at(at[:, None])


def _grid(n: int) -> np.ndarray:
    """Points (n, many) of the open unit cube."""
    if n in GRIDS:
        axis = (np.arange(GRIDS[n]) + 0.5) / GRIDS[n]
        return np.array(np.meshgrid(*[axis] * n)).reshape(n, -1)
    return np.random.default_rng(1995).random((n, SPREAD))


def _refined(ground: _Ground, x: np.ndarray, value: float) -> np.ndarray:
    """Sequential quadratic programming begun anew until it gains nothing."""
    from scipy.optimize import minimize

    for _ in range(RESTARTS):
        z = np.append(x, np.log(value))
        limits = {"type": "ineq", "fun": lambda z: _limits(ground, z), "jac": lambda z: _slopes(ground, z)}
        downwards = np.append(np.zeros(x.size), 1.0)
        bounds = [(1e-9, 1.0 - 1e-9)] * x.size + [(None, None)]
        with np.errstate(all="ignore"):
            found = minimize(
                lambda z: z[-1],
                z,
                jac=lambda z, d=downwards: d,
                method="SLSQP",
                bounds=bounds,
                constraints=[limits],
                options={"ftol": 1e-15, "maxiter": 200},
            )
        near = np.clip(found.x[:-1], 1e-9, 1.0 - 1e-9)
        reached = float(ground.values(near[:, None])[0])
        if not reached < value:
            break
        gained, x, value = value - reached, near, reached
        if gained <= 1e-13 * value:
            break
    return x


def _limits(ground: _Ground, z: np.ndarray) -> np.ndarray:
    """t - log peak of every curve, and the margins: all at least 0."""
    rows, margins = ground(z[:-1, None])
    return np.nan_to_num(np.concatenate((z[-1] - rows[:, 0], margins[1:, 0])), nan=-1.0, posinf=-1.0, neginf=-1.0)


def _slopes(ground: _Ground, z: np.ndarray) -> np.ndarray:
    """Their derivatives by x and t: central differences, all in one call."""
    n = z.size - 1
    step = 1e-6 * np.minimum(z[:-1], 1.0 - z[:-1])
    x = np.concatenate((z[:-1, None] + np.diag(step), z[:-1, None] - np.diag(step)), axis=1)
    rows, margins = ground(x)
    both = np.concatenate((-rows, margins[1:]))
    slopes = (both[:, :n] - both[:, n:]) / (2.0 * step)
    last = np.append(np.ones(rows.shape[0]), np.zeros(margins.shape[0] - 1))
    return np.nan_to_num(np.column_stack((slopes, last)), nan=0.0, posinf=0.0, neginf=0.0)
