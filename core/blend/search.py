"""The least of a smooth quantity over points of a family that meet wishes: sequential quadratic programming from points
found beforehand, with exact derivatives. For what no polynomial tells: the gentlest motion, and ranges beside an
acceleration or points to pass."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import exp, inf, log, nan

import numpy as np

from core.blend.metering import Meter
from core.blend.region import Region
from core.blend.wishes import POINT, Wish, equation
from core.cancellation import checkpoint

Gauge = Callable[[np.ndarray, np.ndarray], tuple[float, np.ndarray]]
"""A value and its derivatives by t, x1, ... from the values of all forms and their derivatives."""
Rank = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""What is to be small, at many points: t (n,), x (numbers, n)."""
Place = tuple[float, tuple[float, ...]]

STARTS = 3  # of the points drawn the best are refined
RESTARTS = 4
LEAST = 1e-12  # no height is made smaller: share of the stroke
MET = 1e-9
_HALVINGS = 50


@dataclass(frozen=True)
class Ground:
    """What is searched: the points that meet all wishes and keep ``limits`` from falling below 0. The greatest of
    ``goals`` is made least.

    bend  which curve has the acceleration that is wished; None: each in turn
    """

    meter: Meter
    wishes: tuple[Wish, ...]
    goals: tuple[Gauge, ...]
    limits: tuple[Gauge, ...] = ()
    bend: int | None = None

    @cached_property
    def acceleration(self) -> float:
        """The acceleration that is wished, 0 where there is none."""
        return next((w.value for w in self.wishes if w.name == "acceleration"), 0.0)

    @cached_property
    def heights(self) -> tuple[np.ndarray, np.ndarray]:
        """Rows of the heights among the forms, and what they must not fall below."""
        family, place = self.meter.family, self.meter.equations.place_of
        names = (*family.positive, *family.constant)
        return np.array([place(n) for n in names]), np.array([LEAST * (n in family.positive) for n in names])


def least(ground: Ground, starts: Iterable[Place]) -> tuple[float, Place | None]:
    """The least value and its place; infinite and None where no start leads to a feasible point."""
    bends = range(len(ground.meter.family.bends)) if ground.acceleration else (None,)
    best: tuple[float, Place | None] = (inf, None)
    for start in starts:
        for bend in bends:
            here = replace(ground, bend=bend)
            value, place = _descended(here, start)
            if _is_less(value, best[0]):
                best, ground_of = (value, place), here
    for _ in range(RESTARTS):
        if best[1] is None:
            break
        value, place = _descended(ground_of, best[1])
        if not _is_less(value, best[0]):
            break
        gained, best = best[0] - value, (value, place)
        if gained <= 1e-11 * abs(value):
            break
    return best


def _is_less(value: float, than: float) -> bool:
    return value < than and (than == inf or than - value > 1e-13 * abs(than))


# -- where to begin ---------------------------------------------------------------------------------------


def starts(meter: Meter, wishes: Sequence[Wish], rank: Rank, count: int = STARTS) -> list[Place]:
    """Of points that meet the linear wishes and one of the others the best, each at another t."""
    bent = [w for w in wishes if not w.linear]
    groups = Region(meter.family, meter, [equation(w, meter.family, meter.equations) for w in wishes if w.linear]).sample()
    if not groups:
        return []
    t, x = np.concatenate([g[0] for g in groups]), np.concatenate([g[1] for g in groups], axis=1)
    group = np.repeat(np.arange(len(groups)), [g[0].size for g in groups])
    if bent:
        t, x, group = _crossing(meter, bent[0], t, x, group)
    with np.errstate(all="ignore"):
        ranks = np.abs(meter.many(bent[1], t, x) - bent[1].value) if len(bent) > 1 else rank(t, x)
    ranks = np.where(np.isfinite(ranks), ranks, np.inf)
    chosen: list[int] = []
    for i in np.argsort(ranks, kind="stable"):
        if len(chosen) == count or not np.isfinite(ranks[i]):
            break
        if group[i] not in group[chosen]:
            chosen.append(int(i))
    return [(float(t[i]), tuple(float(v) for v in x[:, i])) for i in chosen]


def _crossing(
    meter: Meter, wish: Wish, t: np.ndarray, x: np.ndarray, group: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points between neighbours at the same t where a wish is met; where there are none, the nearest."""
    values = meter.many(wish, t, x) - wish.value
    with np.errstate(invalid="ignore"):
        i = np.flatnonzero((group[1:] == group[:-1]) & (np.sign(values[1:]) * np.sign(values[:-1]) < 0.0))
    if not i.size:
        near = np.argsort(np.abs(values), kind="stable")[:STARTS]
        return t[near], x[:, near], group[near]
    low, high = x[:, i], x[:, i + 1]
    sign = np.sign(values[i])
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        same = np.sign(meter.many(wish, t[i], middle) - wish.value) == sign
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return t[i], low, group[i]


# -- the search -------------------------------------------------------------------------------------------


def _descended(ground: Ground, start: Place) -> tuple[float, Place | None]:
    """One run of the method. y: log t, log x1, ... and what no goal may exceed: speeds and heights are sums of products
    of powers, so that in logarithms most of what is asked is convex."""
    from scipy.optimize import minimize

    z = np.log(np.maximum([start[0], *start[1]], LEAST))
    top = _goal(ground, z)
    if not np.isfinite(top):
        return inf, None
    downwards = np.append(np.zeros(z.size), 1.0)
    with np.errstate(all="ignore"):
        found = minimize(
            lambda y: (y[-1], downwards),
            np.append(z, top),
            jac=True,
            method="SLSQP",
            bounds=[(-40.0, 40.0), *((-40.0, log(v)) for v in ground.meter.equations.tops), (None, None)],
            constraints=_constraints(ground),
            options={"ftol": 1e-14, "maxiter": 100},
        )
    z = found.x[:-1]
    reached = _goal(ground, z)
    if not (np.isfinite(reached) and _is_met(ground, z)):
        return inf, None
    return reached, (exp(z[0]), tuple(exp(v) for v in z[1:]))


def _constraints(ground: Ground) -> list[dict[str, object]]:
    """As the library wants them; values and derivatives are computed together."""
    kept: dict[bytes, tuple[np.ndarray, ...]] = {}

    def row(i: int) -> Callable[[np.ndarray], np.ndarray]:
        def of(y: np.ndarray) -> np.ndarray:
            key = y.tobytes()
            if key not in kept:
                kept.clear()
                values, slopes = _forms(ground, y[:-1])
                kept[key] = *_above(ground, y, values, slopes), *_equal(ground, values, slopes)
            return kept[key][i]

        return of

    made: list[dict[str, object]] = [{"type": "ineq", "fun": row(0), "jac": row(1)}]
    return [*made, {"type": "eq", "fun": row(2), "jac": row(3)}] if ground.wishes else made


def _forms(ground: Ground, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All forms and their derivatives by log t, log x1, ..."""
    checkpoint()
    place = np.exp(np.minimum(z, 40.0))
    values, slopes = ground.meter.equations.slopes(float(place[0]), place[1:])
    return values, slopes * place


def _goal(ground: Ground, z: np.ndarray) -> float:
    values, slopes = _forms(ground, z)
    with np.errstate(all="ignore"):
        return max(float(goal(values, slopes)[0]) for goal in ground.goals)


def _above(
    ground: Ground, y: np.ndarray, values: np.ndarray, slopes: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """What must not be below 0: the room below the last of y for every goal, heights, limits; derivatives by y."""
    goals = [goal(values, slopes) for goal in ground.goals]
    limits = [limit(values, slopes) for limit in ground.limits]
    if ground.bend is not None:
        others = (i for i in range(len(ground.meter.family.bends)) if i != ground.bend)
        limits += [no_more(ground.meter, i, ground.acceleration)(values, slopes) for i in others]
    rows, floors = ground.heights
    top = y[-1]
    made = [top - g[0] for g in goals], values[rows] - floors, [v for v, _ in limits]
    slopes_of = np.zeros((len(goals) + rows.size + len(limits), y.size))
    slopes_of[: len(goals), -1] = 1.0
    for i, (_, slope) in enumerate(goals):
        slopes_of[i, :-1] = -slope
    slopes_of[len(goals) : len(goals) + rows.size, :-1] = slopes[rows]
    for i, (_, slope) in enumerate(limits):
        slopes_of[len(goals) + rows.size + i, :-1] = slope
    return _tidy(np.concatenate(made), slopes_of)


def _equal(ground: Ground, values: np.ndarray, slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What must be 0."""
    meter = ground.meter
    made, slopes_of = np.zeros(len(ground.wishes)), np.zeros((len(ground.wishes), slopes.shape[1] + 1))
    for i, wish in enumerate(ground.wishes):
        if wish.name == "acceleration" and ground.bend is not None:
            value, slope = meter.bend(ground.bend, values, slopes)
        else:
            value, slope = meter.of_values(wish, values, slopes)
        size = 1.0 if wish.name == POINT else wish.value
        made[i], slopes_of[i, :-1] = (value - wish.value) / size, slope / size
    return _tidy(made, slopes_of)


def no_more(meter: Meter, bend: int, acceleration: float) -> Gauge:
    """How far a curve stays below an acceleration: logarithm of what it has left."""

    def gauge(values: np.ndarray, slopes: np.ndarray) -> tuple[float, np.ndarray]:
        value, slope = meter.bend(bend, values, slopes)
        return (log(acceleration) - log(value) if 0.0 < value < inf else nan), -slope / value

    return gauge


def _tidy(values: np.ndarray, slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What does not exist is out of bounds and flat."""
    if np.isfinite(values).all() and np.isfinite(slopes).all():
        return values, slopes
    return np.nan_to_num(values, nan=-1e3, posinf=1e3, neginf=-1e3), np.nan_to_num(slopes, nan=0.0, posinf=0.0, neginf=0.0)


def _is_met(ground: Ground, z: np.ndarray) -> bool:
    """Whether a point is feasible, but for rounding."""
    values, slopes = _forms(ground, z)
    with np.errstate(all="ignore"):
        above, _ = _above(ground, np.append(z, 0.0), values, slopes)
        missed, _ = _equal(ground, values, slopes)
    return bool((above[len(ground.goals) :] >= -1e-11).all() and (np.abs(missed) <= MET).all())
