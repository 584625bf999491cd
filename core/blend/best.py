"""The gentlest of all blended motions: least peak acceleration, jerk or inertia torque over what is left free."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from math import log
from types import MappingProxyType

import numpy as np

from core.blend.curves import CONSTANT
from core.blend.family import Solution
from core.blend.gentlest import least_acceleration
from core.blend.metering import Meter, law_of
from core.blend.refusal import refusal
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
from core.blend.search import Gauge, Ground, least, starts
from core.blend.solver import Place, Problem
from core.blend.wishes import Wish, equation
from core.cancellation import checkpoint
from core.laws import peaks

GONE = 1e-6  # a stretch of constant velocity shorter than this share of the stroke is none

Goal = tuple[int, int, int]
"""Which peak coefficient of a curve counts, and the powers of height and of span in it: c h^i / β^k."""

GOALS: Mapping[str, Goal] = MappingProxyType({"acceleration": (0, 1, 2), "jerk": (1, 1, 3), "torque": (2, 2, 3)})


@lru_cache(maxsize=64)
def _coefficients(curve: str) -> tuple[float, float, float]:
    found = peaks(law_of(curve))
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
        checkpoint()
        found = _of_candidate(request, candidate, goal)
        if found is not None and (winner is None or found[0] < winner[0] * (1.0 - 1e-9)):
            winner = found[0], candidate, found[1]
    if winner is None:
        raise _nothing(request)
    _, candidate, solution = winner
    if _has_lost_a_constant_velocity(solution):
        raise BlendError(f"best {goal}: the gentlest has no constant velocity left; give its length or height")
    return answered(request, candidate, solution)


def _has_lost_a_constant_velocity(solution: Solution) -> bool:
    rows = list(zip(solution.sequence.curves, solution.heights, strict=True))
    return any(h <= GONE * max(solution.heights) for name, h in rows if name in CONSTANT)


def _of_candidate(request: Request, candidate: Candidate, goal: str) -> tuple[float, Solution] | None:
    """The best of a sequence, its length let go but for the least that it may be."""
    least_length = request.settings.get("length", 0.0)
    asked = replace(request, settings={n: v for n, v in request.settings.items() if n != "length"})
    wishes = wishes_of(asked)
    if candidate.freedom < len(wishes) or not means_something(candidate, wishes_of(request)):
        return None
    return _best_of(problem_of(asked, candidate, wishes), goal, least_length)


def _nothing(request: Request) -> BlendError:
    """Why no sequence does it: what the last setting may be while the others stay."""
    wishes = wishes_of(request)
    able = [c for c in candidates(request) if c.freedom >= len(wishes) and means_something(c, wishes)]
    if not able:
        return BlendError(f"no sequence of this motion takes these settings: {', '.join(request.settings)}")
    return refusal(request, able, wishes)


def _best_of(problem: Problem, goal: str, least_length: float) -> tuple[float, Solution] | None:
    """The best over the free numbers that the wishes leave; None where they leave nothing."""
    if problem.family.freedom == len(problem.wishes):
        rows = [(peak_of(GOALS[goal], s), s) for s in problem.solutions() if _length(s) >= least_length * (1.0 - 1e-12)]
        return min(rows, key=lambda p: p[0], default=None)
    place = _best_place(problem, goal, least_length / problem.task.span)
    if place is None:
        return None
    solution = problem.solution_at(place)
    return peak_of(GOALS[goal], solution), solution


def _best_place(problem: Problem, goal: str, length: float) -> Place | None:
    """t, x of the best: exact for an acceleration beside linear wishes, else searched from there."""
    meter, linear = problem.meter, all(w.linear for w in problem.wishes)
    floors = [equation(Wish("length", length), meter.family, meter.equations)] if length else []
    gentlest = least_acceleration(meter, problem.rows, floors) if linear else None
    if linear and (goal == "acceleration" or gentlest is None):
        return gentlest and gentlest[1]
    rank = partial(_rank, meter, GOALS[goal])
    begin = [gentlest[1], *starts(meter, problem.wishes, rank, 1)] if gentlest else starts(meter, problem.wishes, rank)
    goals = tuple(_log_peak(meter, GOALS[goal], row) for row in meter.curves if _coefficients(row[0])[GOALS[goal][0]])
    return least(Ground(meter, problem.wishes, goals, (_no_shorter(meter, length),) if length else ()), begin)[1]


def _no_shorter(meter: Meter, length: float) -> Gauge:
    """How much the constant velocity lasts longer than it must."""
    wish = Wish("length", length)

    def gauge(values: np.ndarray, slopes: np.ndarray) -> tuple[float, np.ndarray]:
        value, slope = meter.of_values(wish, values, slopes)
        return value / length - 1.0, slope / length

    return gauge


def _log_peak(meter: Meter, goal: Goal, curve: tuple[str, str, str]) -> Gauge:
    """Logarithm of a curve's peak: the search is the same for slow and fast motions."""
    which, power, root = goal
    factor = _coefficients(curve[0])[which]

    def gauge(values: np.ndarray, slopes: np.ndarray) -> tuple[float, np.ndarray]:
        (h, dh), (span, slope) = meter.height_and_span(curve, values, slopes)
        if not (h > 0.0 and span > 0.0):
            return np.nan, np.zeros_like(dh)
        return log(factor) + power * log(h) - root * log(span), power * dh / h - root * slope / span

    return gauge


def _rank(meter: Meter, goal: Goal, t: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The goal at many points (n,)."""
    heights, spans = meter.parts(t, x)
    return peaks_by_curve(goal, meter.family.sequence.curves, heights, spans).max(axis=0)


def _length(solution: Solution) -> float:
    """Span of the constant velocity [deg]: of the rise where it has one."""
    rows = zip(solution.sequence.curves, solution.spans, strict=True)
    return next((span for name, span in rows if name in CONSTANT), 0.0)
