"""Constraints solved over a family of motions. Linear ones and an acceleration are polynomials of one number, all of whose
roots are found; a point to pass is a smooth function of one number, two of them are solved by Newton's method from a sample
of all points; what several numbers leave beside a point or an acceleration is searched."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property, lru_cache, partial
from math import inf, log

import numpy as np

from core.blend.equations import RETURN, RISE, BlendSolution, BlendTask, Family, named
from core.blend.evaluator import Evaluator, Place, column, constant, logarithm
from core.blend.region import MIXES, OPEN, Region, RegionCurve
from core.blend.request import HEIGHTS, POINT, BlendResult, Constraint, Request, SettingRange, in_units, merged, unit_of
from core.blend.sequences import CONSTANT, ELEMENTS, MOTION_TYPES, CurveSequence, sequences
from core.blend.tracks import Track, acceleration_tracks
from core.design import NamedCurve, Segment
from core.frozen import frozen

# -- the least of a smooth quantity over the motions of a family that meet constraints --------------------------


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


# -- constraints solved over a family of motions ----------------------------------------------------------------


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
ROUNDING = 1e-13  # a share of the span; a constant velocity as short is none
_ENDLESS = 1e6  # a speed or an acceleration of so many strokes per span has no upper end
_ALIKE = 1e-9


class Problem:
    """A family, a task and constraints; inside, stroke of the rise and span are 1."""

    def __init__(self, family: Family, task: BlendTask, constraints: Sequence[Constraint]) -> None:
        self.family, self.task = family, task
        self.constraints = tuple(in_units(c, task) for c in constraints)
        self._given = {c.name: c.value for c in constraints if c.name in HEIGHTS}

    @cached_property
    def evaluator(self) -> Evaluator:
        """What evaluates the family for the strokes of this task."""
        return Evaluator(self.family, self.task)

    def _curves(self, constraints: Sequence[Constraint]) -> list[RegionCurve]:
        """The points that meet linear constraints where these leave one number free."""
        return RegionCurve.of(self.family, self.evaluator.spaces(constraints))

    # -- solutions ----------------------------------------------------------------------------------------

    def solutions(self) -> list[BlendSolution]:
        """Every solution where there are as many constraints as free numbers, the gentlest first, of equally gentle ones
        that of the least t, x1, ...; none where the constraints leave something free."""
        places = sorted(self._places(), key=lambda place: [float(f"{v:.12g}") for v in (place[0], *place[1])])
        result = [self.solution_at(place) for place in places]
        return sorted(result, key=lambda s: float(f"{s.peak_acceleration:.12g}")) if len(result) > 1 else result

    def solution_at(self, place: Place) -> BlendSolution:
        """The motion at a point."""
        heights = self.evaluator.at(self.family.heights, place) if self.family.heights else ()
        return self.family.solution(self.task, place[0], heights, self._given)

    def _places(self) -> list[Place]:
        """The points that meet all constraints and are feasible, each once."""
        if not self.family.parameter:
            return [(1.0, ())]
        result: list[Place] = []
        for start in self._candidates():
            place, met = self.evaluator.solved(self.constraints, start)
            is_new = met and self.evaluator.is_feasible(place) and not any(_alike(place, p) for p in result)
            if is_new and self._is_alone(place):
                result.append(place)
        return result

    def _is_alone(self, place: Place) -> bool:
        """A point to pass may follow from the other constraints where it lies: then many motions pass it, and none is
        meant."""
        has_point = any(c.name == POINT for c in self.constraints)
        return not has_point or bool(self.evaluator.are_independent(self.constraints, column(place))[0])

    def _candidates(self) -> Iterator[Place]:
        """Points where all constraints may be met."""
        nonlinear = [c for c in self.constraints if not c.linear]
        points = [c for c in nonlinear if c.name == POINT]
        if not nonlinear:
            for space in self.evaluator.spaces(self.constraints):
                if space.freedom == 0 and space.t is not None:
                    yield space.t, space.only
        elif not points and len(nonlinear) == 1:
            for curve in self._curves(self.constraints):
                yield from (curve.place(p) for p in curve.where(nonlinear[0]))
        elif len(points) < 2:
            smooth = (points or nonlinear)[0]
            for track in self._tracks([c for c in self.constraints if c is not smooth]):
                yield from track.where(partial(self.evaluator.values, smooth), smooth.value)
        else:
            places = sample(self.evaluator, self.constraints)
            places = places[:, self.evaluator.are_independent(self.constraints, places)]
            while places.size:  # each once
                first = places[:, :1]
                yield float(first[0, 0]), tuple(map(float, first[1:, 0]))
                places = places[:, (np.abs(places - first) > _ALIKE * (np.abs(places) + np.abs(first))).any(axis=0)]

    def _tracks(self, constraints: Sequence[Constraint]) -> list[Track]:
        """The feasible points that meet constraints, at most one of them an acceleration, that leave one number free."""
        acceleration = next((c for c in constraints if not c.linear), None)
        if acceleration is None:
            return [Track.along(curve, stretch) for curve in self._curves(constraints) for stretch in curve.stretches]
        return acceleration_tracks(self.evaluator, constraints, acceleration)

    # -- ranges -------------------------------------------------------------------------------------------

    def ranges(self, i: int) -> list[SettingRange]:
        """What the i-th setting may be while the other constraints stay; empty where they leave nothing. The fewer the
        others, the more that is free."""
        mine, others = self.constraints[i], [*self.constraints[:i], *self.constraints[i + 1 :]]
        missing = self.family.freedom - len(others)
        if missing < 1:
            return []
        nonlinear = [c.name for c in others if not c.linear]
        if not nonlinear and (mine.linear or (missing == 1 and mine.name != POINT)):
            result = Region(self.evaluator, others).ranges(mine.name)
        elif missing == 1 and POINT not in nonlinear:
            values = partial(self.evaluator.values, mine)
            result = [r for track in self._tracks(others) for r in track.ranges(values)]
        else:
            result = self._searched(mine, others)
        return merged(r.times(unit_of(mine.name, self.task)) for r in result)

    def _searched(self, mine: Constraint, others: Sequence[Constraint]) -> list[SettingRange]:
        """What a setting may be at the least and at the most, by search."""
        low, high = (least(self.evaluator, others, self._goals(mine, sign)) for sign in (1.0, -1.0))
        if low is None:
            return []
        least_value, most = (self.evaluator.value_at(mine, end[1]) if end is not None else inf for end in (low, high))
        if high is None or most > _ENDLESS:
            return [SettingRange(least_value, inf, self._is_open(low[1]), True)]
        return [SettingRange(least_value, most, self._is_open(low[1]), self._is_open(high[1]))]

    def _is_open(self, place: Place) -> bool:
        """Whether a height is 0 there, but for the search, that must be above."""
        return min(self.evaluator.at(self.family.positive, place)) <= OPEN

    def _goals(self, mine: Constraint, sign: float) -> list[Quantity]:
        """What is least where a setting is least, or greatest; of an acceleration, which may be of any size, logarithms."""
        evaluator = self.evaluator
        if mine.name == "acceleration":
            return (
                log_accelerations(evaluator)
                if sign > 0.0
                else [lambda forms: -logarithm(evaluator.setting(mine, forms))]
            )
        return [lambda forms: sign * evaluator.setting(mine, forms)]


def _alike(a: Place, b: Place) -> bool:
    return all(abs(v - w) <= _ALIKE * (abs(v) + abs(w)) for v, w in zip((a[0], *a[1]), (b[0], *b[1]), strict=True))


# -- the sequences that may meet a request ----------------------------------------------------------------


@frozen
class BlendCandidate:
    """A sequence with the family that solves it; backwards: of which it is the motion run backwards."""

    sequence: CurveSequence
    family: Family
    backwards: bool

    @property
    def freedom(self) -> int:
        """How many numbers of the family are free."""
        return self.family.freedom

    @cached_property
    def names(self) -> frozenset[str]:
        """What can be set of its curves."""
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

    def has(self, constraints: Iterable[Constraint]) -> bool:
        """Whether every constraint is of a curve that it has."""
        return {c.name for c in constraints} <= self.names

    def takes(self, constraints: list[Constraint]) -> bool:
        """The same, and they are not too many."""
        return len(constraints) <= self.freedom and self.has(constraints)

    def problem(self, request: Request, constraints: Iterable[Constraint]) -> Problem:
        """Strokes, span and constraints as its family solves them, whose time may run backwards."""
        row, span = MOTION_TYPES[request.type], request.end - request.start
        rise, back = (
            stroke if ends else 0.0 for stroke, ends in zip(request.strokes, (row.rise, row.back), strict=True)
        )
        if not self.backwards:
            return Problem(self.family, BlendTask(rise, back, span), list(constraints))
        return Problem(self.family, BlendTask(back, rise, span), [_run_backwards(c, span) for c in constraints])

    def answer(self, request: Request, solution: BlendSolution) -> BlendResult:
        """A solution of its family as the request wants it: in the order of time, as segments; a constant velocity of no
        length is none."""
        heights, spans, flats = solution.heights, solution.spans, solution.flats
        if self.backwards:
            heights, spans, flats = heights[::-1], spans[::-1], flats[::-1]
            solution = BlendSolution(self.sequence, heights, spans, solution.back_speed, solution.speed, flats)
        none = ROUNDING * sum(spans)
        segments = [
            Segment(span, ELEMENTS[name].velocity_sign * height, _curve(name, flat, span))
            for name, height, span, flat in zip(
                self.sequence.curves, heights, spans, flats or [0.0] * len(spans), strict=True
            )
            if span > (none if name in CONSTANT else 0.0)
        ]
        return BlendResult(request, solution, tuple(segments))


def candidates(request: Request) -> list[BlendCandidate]:
    """The sequences of a type of motion with their freedoms, fewest curves first. Raises BlendError where it has no room."""
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
    wanted_mirrored: bool | None,
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
        solved = _mirror(sequence) if backwards else sequence
        own = tuple((_MIRRORED_SETTING[height], share) for height, share in flats) if backwards else flats
        if (
            _mirror(solved) == solved
            and len(solved.rise) > 1
            and wanted_mirrored is not False
            and all(height in RISE for height, _ in own)
        ):
            mirrored = Family(solved, True, own)
            if mirrored.freedom < Family(solved).freedom and equal:
                result.append(BlendCandidate(sequence, mirrored, backwards))
        if wanted_mirrored is not True:
            result.append(BlendCandidate(sequence, Family(solved, False, own), backwards))
    return tuple(result)


def flat_heights(sequence: CurveSequence) -> dict[str, str]:
    """Height -> curve of those curves of a sequence that may have a constant acceleration: half cycloids beside other curves of
    their stroke."""
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
    """The curves of the motion run backwards."""
    rise, back = (tuple(_MIRROR[name] for name in reversed(stroke)) for stroke in (sequence.back, sequence.rise))
    return CurveSequence(rise, back)


def _run_backwards(constraint: Constraint, span: float) -> Constraint:
    """The same of the motion run backwards."""
    name, value, at = constraint
    return Constraint(
        _MIRRORED_SETTING.get(name, name),
        span - value if name == "peak" else value,
        span - at if name == POINT else 0.0,
    )
