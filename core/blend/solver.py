"""Constraints solved over a family of motions.

Linear constraints and an acceleration are polynomials of one variable with all their roots. A point to pass is a smooth
function of one variable; two points are solved by Newton's method from a sample of all feasible motions. What several
variables leave free together with a point or an acceleration is searched.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property, lru_cache, partial
from math import inf, log

import numpy as np

from core.blend.equations import RETURN, RISE, BlendSolution, BlendTask, Family, named
from core.blend.evaluator import Evaluator, Point, column, constant, logarithm
from core.blend.region import MIXES, OPEN, Region, RegionCurve
from core.blend.request import HEIGHTS, POINT, BlendResult, Constraint, Request, SettingRange, in_units, merged, unit_of
from core.blend.sequences import CONSTANT, ELEMENTS, MOTION_TYPES, CurveSequence, sequences
from core.blend.tracks import Track, acceleration_tracks
from core.design import NamedCurve, Segment
from core.frozen import frozen

# -- minimum of a smooth quantity over the motions of a family -------------------------------------------------


Quantity = Callable[[np.ndarray], np.ndarray]
"""Value and derivatives (rows, n) from the values of all forms (forms, rows, n) of a family at n points; dimensionless."""

STARTS = 3  # points of the sample from which a search starts
RESTARTS = 4
LEAST = 1e-12  # least height relative to the stroke
LIMIT_TOLERANCE = 1e-11  # largest violation of a height or a limit
MET = 1e-9  # residual of a satisfied constraint relative to its size
_OUTSIDE = 1e3  # violation where a quantity has no value
_LOG_MOST = 40.0  # bound of the logarithms


@frozen
class Subproblem:
    """Minimise the largest of ``goals`` where ``zero`` are 0, and heights and ``limits`` are not negative."""

    evaluator: Evaluator
    goals: tuple[Quantity, ...]
    limits: tuple[Quantity, ...]
    zero: tuple[Quantity, ...]

    def minimise(self, start: Point) -> tuple[float, Point] | None:
        """Run one search (SLSQP); None where it ends at no feasible point.

        Unknowns are log t, log x1, ... and the upper bound of all goals: speeds and heights are sums of products of
        powers, so that most quantities are convex in the logarithms.
        """
        from scipy.optimize import minimize

        z = np.log(np.maximum([start[0], *start[1]], LEAST))
        top = self.greatest_goal(z)
        if not np.isfinite(top):
            return None
        rows = lru_cache(1)(lambda y: self._rows(np.frombuffer(y)))  # shared by values and derivatives
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
        inequalities, equations = self._rows(np.append(z, 0.0))
        value = self.greatest_goal(z)
        if not (
            np.isfinite(value)
            and (inequalities[len(self.goals) :, 0] >= -LIMIT_TOLERANCE).all()
            and (np.abs(equations[:, 0]) <= MET).all()
        ):
            return None
        t, *x = np.exp(z)
        return value, (float(t), tuple(map(float, x)))

    def _forms(self, z: np.ndarray) -> np.ndarray:
        """Values of all forms and their derivatives by log t, log x1, ...."""
        point = np.exp(np.minimum(z, _LOG_MOST))
        forms = self.evaluator.forms(point[:1], point[1:, None], slopes=True)
        forms[:, 1:, 0] *= point
        return forms

    @np.errstate(all="ignore")
    def greatest_goal(self, z: np.ndarray) -> float:
        """Largest goal at one point.

        Parameters
        ----------
        z : ndarray (1 + numbers,), dimensionless
            log t, log x1, ....

        Returns
        -------
        float
        """
        forms = self._forms(z)
        return max(float(goal(forms)[0, 0]) for goal in self.goals)

    @np.errstate(all="ignore")
    def _rows(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Inequalities and equations, each a row of its value and its derivatives by y.

        The inequalities are the bound, the last of y, minus each goal; heights; limits.
        """
        evaluator, forms = self.evaluator, self._forms(y[:-1])
        inequalities = [-goal(forms) for goal in self.goals]
        inequalities += [evaluator.form(name, forms) - constant(LEAST, forms) for name in evaluator.family.positive]
        inequalities += [evaluator.form(name, forms) for name in evaluator.family.constant]
        inequalities += [limit(forms) for limit in self.limits]
        result = _stacked(inequalities, y.size + 1), _stacked([quantity(forms) for quantity in self.zero], y.size + 1)
        result[0][: len(self.goals), 0] += y[-1]
        result[0][: len(self.goals), -1] = 1.0
        for rows in result:
            rows[~np.isfinite(rows).all(axis=1)] = [-_OUTSIDE, *[0.0] * y.size]
        return result


def _stacked(quantities: Sequence[np.ndarray], size: int) -> np.ndarray:
    """Quantities at one point as rows (size,), padded with 0."""
    rows = np.zeros((len(quantities), size))
    for row, quantity in zip(rows, quantities, strict=True):
        row[:-1] = quantity[:, 0]
    return rows


def least(
    evaluator: Evaluator,
    constraints: Sequence[Constraint],
    goals: Sequence[Quantity],
    limits: Sequence[Quantity] = (),
) -> tuple[float, Point] | None:
    """Minimum of the largest goal over the points that satisfy constraints and limits, and its point.

    Parameters
    ----------
    evaluator : Evaluator
    constraints : sequence of Constraint
    goals, limits : sequences of Callable[[ndarray (forms, rows, n)], ndarray (rows, n)], dimensionless
        The limits must not be negative.

    Returns
    -------
    tuple of float and Point, or None
        None where no start leads to a feasible point.
    """
    subproblems = _subproblems(evaluator, constraints, tuple(goals), tuple(limits))
    best: tuple[float, Point] | None = None
    for start in _starts(evaluator, constraints, goals, limits):
        for subproblem in subproblems:
            result = subproblem.minimise(start)
            for _ in range(RESTARTS):
                if result is None or (best is not None and best[0] - result[0] <= 1e-13 * abs(best[0])):
                    break
                best = result
                result = subproblem.minimise(best[1])
    if best is None:
        return None
    point, is_met = evaluator.solve(constraints, best[1])
    return (subproblems[0].greatest_goal(np.log(np.maximum([point[0], *point[1]], LEAST))), point) if is_met else best


def _subproblems(
    evaluator: Evaluator, constraints: Sequence[Constraint], goals: tuple[Quantity, ...], limits: tuple[Quantity, ...]
) -> list[Subproblem]:
    """One subproblem; where an acceleration is prescribed, one for each curve that may have it."""
    prescribed = [c for c in constraints if c.name == "acceleration"]
    zero = tuple(partial(evaluator.residual, c) for c in constraints if c not in prescribed)
    if not prescribed:
        return [Subproblem(evaluator, goals, limits, zero)]
    room = [partial(_room, quantity, prescribed[0].value) for quantity in log_accelerations(evaluator)]
    return [
        Subproblem(evaluator, goals, (*limits, *(r for r in room if r is not active)), (*zero, active))
        for active in room
    ]


def _room(log_acceleration: Quantity, value: float, forms: np.ndarray) -> np.ndarray:
    """Logarithm of the ratio of an acceleration to that of a curve."""
    return constant(log(value), forms) - log_acceleration(forms)


def log_accelerations(evaluator: Evaluator) -> list[Quantity]:
    """Logarithms of the accelerations of the curves that may have the largest one."""
    return [partial(_log_acceleration, evaluator, i) for i in range(len(evaluator.family.accelerations))]


def _log_acceleration(evaluator: Evaluator, i: int, forms: np.ndarray) -> np.ndarray:
    return logarithm(evaluator.acceleration(i, forms))


def sample(evaluator: Evaluator, constraints: Sequence[Constraint]) -> np.ndarray:
    """Points that satisfy the linear constraints, moved to nearby points that satisfy all; NaN where there are none.

    Parameters
    ----------
    evaluator : Evaluator
    constraints : sequence of Constraint

    Returns
    -------
    ndarray (1 + numbers, n), dimensionless
    """
    z = Region(evaluator, [c for c in constraints if c.linear]).sample()
    if all(c.linear for c in constraints):
        return z
    z, is_met = evaluator.solve_all(constraints, z)
    return np.where(is_met, z, np.nan)


def _starts(
    evaluator: Evaluator, constraints: Sequence[Constraint], goals: Sequence[Quantity], limits: Sequence[Quantity]
) -> list[Point]:
    """Best points that satisfy the constraints, at different t."""
    z = sample(evaluator, constraints)
    forms = evaluator.forms(z[0], z[1:])
    with np.errstate(all="ignore"):
        ranks = np.max([goal(forms)[0] for goal in goals], axis=0)
        ranks += sum(_OUTSIDE * np.maximum(-limit(forms)[0], 0.0) for limit in limits)
    chosen: dict[int, Point] = {}
    for i in np.argsort(ranks, kind="stable"):
        point = float(z[0, i]), tuple(map(float, z[1:, i]))
        if len(chosen) == STARTS or not np.isfinite(ranks[i]):
            break
        if i // MIXES not in chosen and evaluator.is_feasible(point):
            chosen[i // MIXES] = point
    return list(chosen.values())


# -- solutions and ranges ---------------------------------------------------------------------------------------


_MIRROR = {
    "C1": "C4", "C2": "C3", "C3": "C2", "C4": "C1", "C5": "C6", "C6": "C5", "CV1": "CV2", "CV2": "CV1",
    "H1": "H4", "H2": "H3", "H3": "H2", "H4": "H1", "H5": "H6", "H6": "H5", "P1": "P2", "P2": "P1",
}  # fmt: skip
_MIRRORED_SETTING = {
    "h1": "h6", "h2": "h5", "h3": "h4", "h4": "h3", "h5": "h2", "h6": "h1", "vcv": "vcv2", "vcv2": "vcv",
    "a1": "a6", "a3": "a4", "a4": "a3", "a6": "a1",
    "span1": "span6", "span3": "span4", "span4": "span3", "span6": "span1",
}  # fmt: skip
_CURVES = {name: NamedCurve(name.lower()) for name in ELEMENTS}
HALF_CYCLOIDS = ("C1", "C2", "C3", "C4")
ROUNDING = 1e-13  # fraction of the span, below which a constant velocity is omitted
_ENDLESS = 1e6  # a greater speed or acceleration, for a stroke and a span of 1, has no upper end
_EQUAL = 1e-9  # relative difference of equal points


class Problem:
    """A family, a task and constraints; internally stroke of the rise and span are 1."""

    def __init__(self, family: Family, task: BlendTask, constraints: Sequence[Constraint]) -> None:
        self.family, self.task = family, task
        self.constraints = tuple(in_units(c, task) for c in constraints)
        self._given = {c.name: c.value for c in constraints if c.name in HEIGHTS}

    @cached_property
    def evaluator(self) -> Evaluator:
        """Evaluator of the family for the strokes of the task."""
        return Evaluator(self.family, self.task)

    def _curves(self, constraints: Sequence[Constraint]) -> list[RegionCurve]:
        """Curves of the points that satisfy linear constraints, where these leave one variable free."""
        return RegionCurve.of(self.family, self.evaluator.spaces(constraints))

    # -- solutions ----------------------------------------------------------------------------------------

    def solutions(self) -> list[BlendSolution]:
        """All solutions where there are as many constraints as free variables, the smallest peak acceleration first.

        Equal ones are ordered by t, x1, .... Empty where the constraints leave a variable free.
        """
        points = sorted(self._points(), key=lambda point: [float(f"{v:.12g}") for v in (point[0], *point[1])])
        result = [self.solution_at(point) for point in points]
        return sorted(result, key=lambda s: float(f"{s.peak_acceleration:.12g}")) if len(result) > 1 else result

    def solution_at(self, point: Point) -> BlendSolution:
        """Motion at a point."""
        heights = self.evaluator.at(self.family.heights, point) if self.family.heights else ()
        return self.family.solution(self.task, point[0], heights, self._given)

    def _points(self) -> list[Point]:
        """Feasible points that satisfy all constraints, each once."""
        if not self.family.parameter:
            return [(1.0, ())]
        result: list[Point] = []
        for start in self._candidates():
            point, is_met = self.evaluator.solve(self.constraints, start)
            is_new = is_met and self.evaluator.is_feasible(point) and not any(_is_equal(point, p) for p in result)
            if is_new and self._is_isolated(point):
                result.append(point)
        return result

    def _is_isolated(self, point: Point) -> bool:
        """Whether a point is an isolated solution.

        Elsewhere a precision point follows from the other constraints, and infinitely many motions pass it.
        """
        has_point = any(c.name == POINT for c in self.constraints)
        return not has_point or bool(self.evaluator.are_independent(self.constraints, column(point))[0])

    def _candidates(self) -> Iterator[Point]:
        """Points where all constraints may be satisfied."""
        nonlinear = [c for c in self.constraints if not c.linear]
        precision_points = [c for c in nonlinear if c.name == POINT]
        if not nonlinear:
            for space in self.evaluator.spaces(self.constraints):
                if space.freedom == 0 and space.t is not None:
                    yield space.t, space.only
        elif not precision_points and len(nonlinear) == 1:
            for curve in self._curves(self.constraints):
                yield from (curve.point_at(p) for p in curve.solutions_at(nonlinear[0]))
        elif len(precision_points) < 2:
            smooth = (precision_points or nonlinear)[0]
            for track in self._tracks([c for c in self.constraints if c is not smooth]):
                yield from track.solutions_at(partial(self.evaluator.values, smooth), smooth.value)
        else:
            samples = sample(self.evaluator, self.constraints)
            samples = samples[:, self.evaluator.are_independent(self.constraints, samples)]
            while samples.size:  # each once
                first = samples[:, :1]
                yield float(first[0, 0]), tuple(map(float, first[1:, 0]))
                samples = samples[:, (np.abs(samples - first) > _EQUAL * (np.abs(samples) + np.abs(first))).any(axis=0)]

    def _tracks(self, constraints: Sequence[Constraint]) -> list[Track]:
        """Feasible points that satisfy constraints, at most one of them an acceleration, with one free variable."""
        acceleration = next((c for c in constraints if not c.linear), None)
        if acceleration is None:
            return [Track.along(curve, interval) for curve in self._curves(constraints) for interval in curve.intervals]
        return acceleration_tracks(self.evaluator, constraints, acceleration)

    # -- ranges -------------------------------------------------------------------------------------------

    def ranges(self, i: int) -> list[SettingRange]:
        """Ranges of the i-th setting under the other constraints; empty where these have no solution."""
        setting, others = self.constraints[i], [*self.constraints[:i], *self.constraints[i + 1 :]]
        missing = self.family.freedom - len(others)
        if missing < 1:
            return []
        nonlinear = [c.name for c in others if not c.linear]
        if not nonlinear and (setting.linear or (missing == 1 and setting.name != POINT)):
            result = Region(self.evaluator, others).ranges(setting.name)
        elif missing == 1 and POINT not in nonlinear:
            values = partial(self.evaluator.values, setting)
            result = [r for track in self._tracks(others) for r in track.ranges(values)]
        else:
            result = self._searched(setting, others)
        return merged(r.times(unit_of(setting.name, self.task)) for r in result)

    def _searched(self, setting: Constraint, others: Sequence[Constraint]) -> list[SettingRange]:
        """Range of a setting by search for its least and greatest value."""
        low, high = (least(self.evaluator, others, self._goals(setting, sign)) for sign in (1.0, -1.0))
        if low is None:
            return []
        least_value, greatest = (
            self.evaluator.value_at(setting, end[1]) if end is not None else inf for end in (low, high)
        )
        if high is None or greatest > _ENDLESS:
            return [SettingRange(least_value, inf, self._is_open(low[1]), True)]
        return [SettingRange(least_value, greatest, self._is_open(low[1]), self._is_open(high[1]))]

    def _is_open(self, point: Point) -> bool:
        """Whether a height is 0 that must be positive."""
        return min(self.evaluator.at(self.family.positive, point)) <= OPEN

    def _goals(self, setting: Constraint, sign: float) -> list[Quantity]:
        """Goals whose minimum is that of a setting (sign 1) or of its negative (-1); logarithms of an acceleration."""
        evaluator = self.evaluator
        if setting.name == "acceleration":
            return (
                log_accelerations(evaluator)
                if sign > 0.0
                else [lambda forms: -logarithm(evaluator.setting(setting, forms))]
            )
        return [lambda forms: sign * evaluator.setting(setting, forms)]


def _is_equal(a: Point, b: Point) -> bool:
    return all(abs(v - w) <= _EQUAL * (abs(v) + abs(w)) for v, w in zip((a[0], *a[1]), (b[0], *b[1]), strict=True))


# -- candidate sequences ----------------------------------------------------------------------------------


@frozen
class BlendCandidate:
    """A sequence with the family that solves it; ``backwards``: the family is that of the motion run backwards."""

    sequence: CurveSequence
    family: Family
    backwards: bool

    @property
    def freedom(self) -> int:
        """Number of free variables of the family."""
        return self.family.freedom

    @cached_property
    def names(self) -> frozenset[str]:
        """Names of the settings of its curves."""
        rise, back = self.sequence.rise, self.sequence.back
        names = {"acceleration", *((POINT,) if not self.family.flats else ())}
        flats = [_MIRRORED_SETTING[height] if self.backwards else height for height, _ in self.family.flats]
        names |= {f"a{height[-1]}" for height in flats}
        if len(rise) > 1:
            names |= {"h1", "h3", "vcv", *(("h2", "length") if len(rise) == 3 else ())}
        if len(back) > 1:
            names |= {
                "h4",
                "h6",
                "vcv2",
                *(("h5", "length2" if len(rise) == 3 else "length") if len(back) == 3 else ()),
            }
        if rise and back:
            names.add("peak")
        return frozenset(names)

    def has_settings(self, constraints: Iterable[Constraint]) -> bool:
        """Whether the sequence has the curves of every constraint."""
        return {c.name for c in constraints} <= self.names

    def accepts(self, constraints: list[Constraint]) -> bool:
        """Whether the sequence has the curves of every constraint, and the constraints do not exceed its freedom."""
        return len(constraints) <= self.freedom and self.has_settings(constraints)

    def problem(self, request: Request, constraints: Iterable[Constraint]) -> Problem:
        """Problem with strokes, span and constraints for its family, whose time may run backwards."""
        row, span = MOTION_TYPES[request.type], request.end - request.start
        rise, back = (
            stroke if ends else 0.0 for stroke, ends in zip(request.strokes, (row.rise, row.back), strict=True)
        )
        if not self.backwards:
            return Problem(self.family, BlendTask(rise, back, span), list(constraints))
        return Problem(self.family, BlendTask(back, rise, span), [_run_backwards(c, span) for c in constraints])

    def result(self, request: Request, solution: BlendSolution) -> BlendResult:
        """A solution of its family in the order of time, as segments; a constant velocity without length is omitted."""
        heights, spans, flats = solution.heights, solution.spans, solution.flats
        if self.backwards:
            heights, spans, flats = heights[::-1], spans[::-1], flats[::-1]
            solution = BlendSolution(self.sequence, heights, spans, solution.back_speed, solution.speed, flats)
        shortest = ROUNDING * sum(spans)
        segments = [
            Segment(span, ELEMENTS[name].velocity_sign * height, _curve(name, flat, span))
            for name, height, span, flat in zip(
                self.sequence.curves, heights, spans, flats or [0.0] * len(spans), strict=True
            )
            if span > (shortest if name in CONSTANT else 0.0)
        ]
        return BlendResult(request, solution, tuple(segments))


def candidates(request: Request) -> list[BlendCandidate]:
    """Sequences of a type of motion with their families, fewest curves first. Raises BlendError without room.

    A request for any sequence has none.
    """
    if not request.type:
        return []
    request.validate_angles()
    rise, back = request.strokes
    flats = tuple((height, value / (request.end - request.start)) for height, value in sorted(request.flats.items()))
    return list(
        _candidates(request.type, request.constant, request.sequence.upper(), request.mirrored, rise == back, flats)
    )


@lru_cache(maxsize=64)
def _candidates(
    motion_type: str,
    constant: str,
    only: str,
    mirrored: bool | None,
    equal: bool,
    flats: tuple[tuple[str, float], ...],
) -> tuple[BlendCandidate, ...]:
    result = []
    for sequence in sequences(motion_type, constant):
        if only and only != str(sequence):
            continue
        if not {height for height, _ in flats} <= set(flat_heights(sequence)):
            continue
        backwards = len(sequence.rise) < 2 and (len(sequence.back) > 1 or not sequence.rise)
        solved_sequence = _mirror(sequence) if backwards else sequence
        own_flats = tuple((_MIRRORED_SETTING[height], share) for height, share in flats) if backwards else flats
        if (
            _mirror(solved_sequence) == solved_sequence
            and len(solved_sequence.rise) > 1
            and mirrored is not False
            and all(height in RISE for height, _ in own_flats)
        ):
            mirrored_family = Family(solved_sequence, True, own_flats)
            if mirrored_family.freedom < Family(solved_sequence).freedom and equal:
                result.append(BlendCandidate(sequence, mirrored_family, backwards))
        if mirrored is not True:
            result.append(BlendCandidate(sequence, Family(solved_sequence, False, own_flats), backwards))
    return tuple(result)


def flat_heights(sequence: CurveSequence) -> dict[str, str]:
    """Height -> curve of the half cycloids, in strokes of several curves, that may have a constant acceleration."""
    strokes = ((sequence.rise, RISE), (sequence.back, RETURN))
    rows = [
        (n, c)
        for curves, names in strokes
        if len(curves) > 1
        for n, c in zip(named(curves, names), curves, strict=True)
    ]
    return {height: curve for height, curve in rows if curve in HALF_CYCLOIDS}


def _curve(name: str, flat: float, span: float) -> NamedCurve:
    return NamedCurve(name.lower(), flat_fraction=min(flat / span, 1.0)) if flat else _CURVES[name]


def _mirror(sequence: CurveSequence) -> CurveSequence:
    """Curves of the motion run backwards."""
    rise, back = (tuple(_MIRROR[name] for name in reversed(stroke)) for stroke in (sequence.back, sequence.rise))
    return CurveSequence(rise, back)


def _run_backwards(constraint: Constraint, span: float) -> Constraint:
    """Constraint of the motion run backwards."""
    name, value, at = constraint
    return Constraint(
        _MIRRORED_SETTING.get(name, name),
        span - value if name == "peak" else value,
        span - at if name == POINT else 0.0,
    )
