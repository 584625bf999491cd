"""The least of a smooth quantity over the motions of a family that meet constraints: sequential quadratic programming with
exact derivatives, from the best of a sample of points. For what no polynomial answers: the gentlest motion, and ranges
that several numbers, an acceleration or points to pass leave."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from math import log

import numpy as np

from core.blend.evaluator import Evaluator, Place, constant, logarithm
from core.blend.region import MIXES, Region
from core.blend.request import Constraint
from core.frozen import frozen

Quantity = Callable[[np.ndarray], np.ndarray]
"""A value and its derivatives (rows, n) from all forms of the family at n points."""

STARTS = 3  # of the sample so many points are refined
RESTARTS = 4
LEAST = 1e-12  # no height is made smaller: share of the stroke
KEPT = 1e-11  # by how much a height or a limit may be missed
MET = 1e-9  # by how much a constraint may be missed, as a share of its size
_OUTSIDE = 1e3  # what counts as the room that is missing where a quantity has no value
_LOG_MOST = 40.0  # bounds of the logarithms


@frozen
class Subproblem:
    """The greatest of ``goals`` is made least over the points where ``zero`` are 0 and heights and ``limits`` not below."""

    evaluator: Evaluator
    goals: tuple[Quantity, ...]
    limits: tuple[Quantity, ...]
    zero: tuple[Quantity, ...]

    def descended(self, start: Place) -> tuple[float, Place] | None:
        """One run. The unknowns y are log t, log x1, ... and what no goal may exceed: speeds and heights are sums of
        products of powers, so that in logarithms most of the quantities are convex."""
        from scipy.optimize import minimize

        z = np.log(np.maximum([start[0], *start[1]], LEAST))
        top = self.greatest_goal(z)
        if not np.isfinite(top):
            return None
        rows = lru_cache(1)(
            lambda y: self._rows(np.frombuffer(y))
        )  # values and derivatives are read one after the other
        constraints = [
            {
                "type": kind,
                "fun": lambda y, i=i: rows(y.tobytes())[i][:, 0],
                "jac": lambda y, i=i: rows(y.tobytes())[i][:, 1:],
            }
            for i, kind in enumerate(("ineq", "eq") if self.zero else ("ineq",))
        ]
        result = minimize(
            lambda y: (y[-1], np.append(np.zeros(z.size), 1.0)),
            np.append(z, top),
            jac=True,
            method="SLSQP",
            bounds=[
                (-_LOG_MOST, _LOG_MOST),
                *((-_LOG_MOST, log(v)) for v in self.evaluator.equations.tops),
                (None, None),
            ],
            constraints=constraints,
            options={"ftol": 1e-14, "maxiter": 100},
        )
        z = result.x[:-1]
        above, equal = self._rows(np.append(z, 0.0))
        reached = self.greatest_goal(z)
        if not (
            np.isfinite(reached) and (above[len(self.goals) :, 0] >= -KEPT).all() and (np.abs(equal[:, 0]) <= MET).all()
        ):
            return None
        t, *x = np.exp(z)
        return reached, (float(t), tuple(map(float, x)))

    def _forms(self, z: np.ndarray) -> np.ndarray:
        """All forms and their derivatives by log t, log x1, ..."""
        place = np.exp(np.minimum(z, _LOG_MOST))
        forms = self.evaluator.forms(place[:1], place[1:, None], slopes=True)
        forms[:, 1:, 0] *= place
        return forms

    @np.errstate(all="ignore")
    def greatest_goal(self, z: np.ndarray) -> float:
        """At log t, log x1, ..."""
        forms = self._forms(z)
        return max(float(goal(forms)[0, 0]) for goal in self.goals)

    @np.errstate(all="ignore")
    def _rows(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What must not be below 0: the room between goals and the last of y, heights, limits; and what must be 0. Each a
        row with its derivatives by y behind the value."""
        evaluator, forms = self.evaluator, self._forms(y[:-1])
        above = [-goal(forms) for goal in self.goals]
        above += [evaluator.form(name, forms) - constant(LEAST, forms) for name in evaluator.family.positive]
        above += [evaluator.form(name, forms) for name in evaluator.family.constant]
        above += [limit(forms) for limit in self.limits]
        result = _stacked(above, y.size + 1), _stacked([quantity(forms) for quantity in self.zero], y.size + 1)
        result[0][: len(self.goals), 0] += y[-1]
        result[0][: len(self.goals), -1] = 1.0
        for made in result:
            made[~np.isfinite(made).all(axis=1)] = [-_OUTSIDE, *[0.0] * y.size]
        return result


def _stacked(quantities: Sequence[np.ndarray], size: int) -> np.ndarray:
    """Quantities at one point, a row (size,) each, filled up with 0."""
    rows = np.zeros((len(quantities), size))
    for row, quantity in zip(rows, quantities, strict=True):
        row[:-1] = quantity[:, 0]
    return rows


def least(
    evaluator: Evaluator,
    constraints: Sequence[Constraint],
    goals: Sequence[Quantity],
    limits: Sequence[Quantity] = (),
) -> tuple[float, Place] | None:
    """The least of the greatest goal over the points that meet the constraints and keep the limits from falling below 0, and
    its place; None where no start leads to a feasible point."""
    subproblems = _subproblems(evaluator, constraints, tuple(goals), tuple(limits))
    best: tuple[float, Place] | None = None
    for start in _starts(evaluator, constraints, goals, limits):
        for subproblem in subproblems:
            result = subproblem.descended(start)
            for _ in range(RESTARTS):
                if result is None or (best is not None and best[0] - result[0] <= 1e-13 * abs(best[0])):
                    break
                best = result
                result = subproblem.descended(best[1])
    if best is None:
        return None
    place, met = evaluator.solved(constraints, best[1])
    return (subproblems[0].greatest_goal(np.log(np.maximum([place[0], *place[1]], LEAST))), place) if met else best


def _subproblems(
    evaluator: Evaluator, constraints: Sequence[Constraint], goals: tuple[Quantity, ...], limits: tuple[Quantity, ...]
) -> list[Subproblem]:
    """One, or where an acceleration is prescribed one for each of the curves that may have it."""
    given = [c for c in constraints if c.name == "acceleration"]
    zero = tuple(partial(evaluator.missed, c) for c in constraints if c not in given)
    if not given:
        return [Subproblem(evaluator, goals, limits, zero)]
    room = [partial(_room, quantity, given[0].value) for quantity in log_accelerations(evaluator)]
    return [
        Subproblem(evaluator, goals, (*limits, *(r for r in room if r is not reached)), (*zero, reached))
        for reached in room
    ]


def _room(log_acceleration: Quantity, value: float, forms: np.ndarray) -> np.ndarray:
    """How far a curve stays below an acceleration: the logarithm of their ratio."""
    return constant(log(value), forms) - log_acceleration(forms)


def log_accelerations(evaluator: Evaluator) -> list[Quantity]:
    """Logarithms of the largest accelerations of the curves."""
    return [partial(_log_acceleration, evaluator, i) for i in range(len(evaluator.family.accelerations))]


def _log_acceleration(evaluator: Evaluator, i: int, forms: np.ndarray) -> np.ndarray:
    return logarithm(evaluator.acceleration(i, forms))


def sample(evaluator: Evaluator, constraints: Sequence[Constraint]) -> np.ndarray:
    """Points (1 + numbers, n) that meet the linear constraints, and near some of them those that meet all; the others are
    nan."""
    z = Region(evaluator, [c for c in constraints if c.linear]).sample()
    if all(c.linear for c in constraints):
        return z
    z, met = evaluator.solved_at_all(constraints, z)
    return np.where(met, z, np.nan)


def _starts(
    evaluator: Evaluator, constraints: Sequence[Constraint], goals: Sequence[Quantity], limits: Sequence[Quantity]
) -> list[Place]:
    """Of points that meet the constraints the best, each at another t."""
    z = sample(evaluator, constraints)
    forms = evaluator.forms(z[0], z[1:])
    with np.errstate(all="ignore"):
        ranks = np.max([goal(forms)[0] for goal in goals], axis=0)
        ranks += sum(_OUTSIDE * np.maximum(-limit(forms)[0], 0.0) for limit in limits)
    chosen: dict[int, Place] = {}
    for i in np.argsort(ranks, kind="stable"):
        place = float(z[0, i]), tuple(map(float, z[1:, i]))
        if len(chosen) == STARTS or not np.isfinite(ranks[i]):
            break
        if i // MIXES not in chosen and evaluator.is_feasible(place):
            chosen[i // MIXES] = place
    return list(chosen.values())
