"""Heights and speeds of a family of motions as sums of terms c t^e x_j, and the points where such sums are 0.

The terms are polynomials in one variable t and linear in x1, x2, ...; the points (t, x1, ...) where they vanish are
rational functions of t, or isolated values of t.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property, lru_cache
from math import inf, pi, sqrt

import numpy as np

from core.blend.polynomials import (
    ONE,
    UNIT,
    ZERO,
    Polynomial,
    evaluate,
    is_negligible,
    roots,
    size_at,
    to_floats,
    to_integer,
    without_common_factor,
)
from core.blend.sequences import CONSTANT, ELEMENTS, KAPPA, CurveSequence
from core.frozen import frozen

# -- heights and speeds of a family as sums of terms c t^e x_j --------------------------------------------------


POWERS = (-2, -1, 0, 1, 2)
Form = np.ndarray
"""Coefficients (powers, 1 + numbers) of t^e x_j, e in ``POWERS``, x_0 = 1; dimensionless."""
Row = tuple[Polynomial, ...]
"""Coefficients p0(t), p1(t), ... of an equation p0(t) + p1(t) x1 + ... = 0."""
VANISHING = 1e-9  # residual of an equation relative to its terms, at which it is satisfied
SINGULAR = 1e-11  # a smaller pivot is 0; the equations have size 1


def term(numbers: int, j: int = 0, e: int = 0) -> Form:
    """Form of the single term t^e x_j, for a given count of variables x."""
    form = np.zeros((len(POWERS), 1 + numbers))
    form[POWERS.index(e), j] = 1.0
    return form


def times_t(form: Form, powers: int) -> Form:
    """Product of a form and a power of t; the result must stay within ``POWERS``."""
    return np.roll(form, powers, axis=0)


class FamilyEquations:
    """Forms by name, for a stroke of the rise and a span of 1.

    Attributes
    ----------
    numbers : names of x_1, x_2, ...
    top, tops : upper limits of t, and of each x_j; the lower limits are 0
    row_index : name of a form -> its row in the result of ``evaluate``
    """

    def __init__(self, forms: Mapping[str, Form], numbers: Sequence[str], top: float, tops: Sequence[float]) -> None:
        self.numbers, self.top, self.tops = tuple(numbers), top, tuple(tops)
        self.row_index = {name: i for i, name in enumerate(forms)}
        self._forms = {**forms, "": term(len(self.numbers))}
        used = np.any(list(self._forms.values()), axis=(0, 2))
        self._powers = np.array(POWERS[int(used.argmax()) :], dtype=float)
        self._tensor = np.array(list(forms.values()))[:, -self._powers.size :]

    @cached_property
    def exact(self) -> Mapping[str, Row]:
        """Form -> its polynomials by 1, x_1, ..., all times the same power of t; the empty name is the form 1."""
        width, count = len(self.numbers) + 1, self._powers.size
        columns = [column for form in self._forms.values() for column in form[-count:].T.tolist()]
        reduced = without_common_factor(Polynomial(map(to_integer, column)) for column in columns)
        return {name: tuple(reduced[i * width :][:width]) for i, name in enumerate(self._forms)}

    def evaluate(self, t: np.ndarray, x: np.ndarray, slopes: bool = False) -> np.ndarray:
        """Values of all forms, with or without derivatives by t, x_1, ....

        Parameters
        ----------
        t : ndarray (n,), dimensionless
        x : ndarray (numbers, n), dimensionless
        slopes : bool
            Also compute the derivatives.

        Returns
        -------
        ndarray (forms, 1, n) or (forms, 2 + numbers, n), dimensionless
            Value, then the derivatives.
        """
        with_one = np.concatenate((np.ones((1, t.size)), x))
        with np.errstate(all="ignore"):
            powers = t ** self._powers[:, None]
            columns = np.einsum("fej,en->fjn", self._tensor, powers)
            values = np.einsum("fjn,jn->fn", columns, with_one)[:, None]
            if not slopes:
                return values
            by_t = np.einsum("fej,en,jn->fn", self._tensor, self._powers[:, None] * powers / t, with_one)[:, None]
        return np.concatenate((values, by_t, columns[:, 1:]), axis=1)


# -- zeros of forms ---------------------------------------------------------------------------------------


@frozen
class SolutionSpace:
    """Points x_j = (x[j][0] + x[j][1] y1 + ...)/below over the free variables y; polynomials in t, or numbers at one t.

    Attributes
    ----------
    t : value of t that the equations determine; None where t is free
    free : the j of the free x_j, which are y1, y2, ...
    """

    equations: FamilyEquations
    t: float | None
    free: tuple[int, ...]
    x: tuple[Row, ...]
    below: Polynomial

    @property
    def freedom(self) -> int:
        """Number of free variables."""
        return len(self.free) + (self.t is None)

    @property
    def only(self) -> tuple[float, ...]:
        """The x_j where no variable is free."""
        *rows, below = to_floats([*(r[0] for r in self.x), self.below])
        return tuple([row[0] / below[0] if row else 0.0 for row in rows])

    def along(self, first: int = 0) -> PointFamily:
        """The same points over one variable p, which is t where t is free, else the free variable ``first``."""
        if self.t is None:
            return PointFamily(self.equations, None, self.x, self.below, self.equations.top)
        others = [i for i in range(len(self.free)) if i != first]
        rows = tuple([(r[0] + r[1 + first].times_power(1), *(r[1 + i] for i in others)) for r in self.x])
        return PointFamily(self.equations, self.t, rows, self.below, self.equations.tops[self.free[first] - 1])


@frozen
class PointFamily:
    """Points over a variable p, 0 < p < top, and others: x_j = (x[j-1][0](p) + x[j-1][1](p) y1 + ...)/below(p).

    Attributes
    ----------
    t : value of t; None where p is t
    """

    equations: FamilyEquations
    t: float | None
    x: tuple[Row, ...]
    below: Polynomial
    top: float

    def form(self, name: str) -> Row:
        """A form by 1, y1, ... as polynomials in p, all forms times the same one; the empty name is the form 1."""
        row = self.equations.exact[name]
        if self.t is not None:
            powers = [to_integer(self.t**e) for e in range(max(map(len, row)))]
            row = tuple([Polynomial([sum(c * p for c, p in zip(r.coefficients, powers, strict=False))]) for r in row])
        result = [row[0] * self.below, *[ZERO] * (len(self.x[0]) - 1 if self.x else 0)]
        for factor, numerators in zip(row[1:], self.x, strict=True):
            if factor:
                result = [m + factor * n if n else m for m, n in zip(result, numerators, strict=True)]
        return tuple(result)

    def t_at(self, p: np.ndarray) -> np.ndarray:
        """Values of t.

        Parameters
        ----------
        p : ndarray (n,), dimensionless

        Returns
        -------
        ndarray (n,), dimensionless
        """
        return p if self.t is None else np.full_like(p, self.t)


def solution_spaces(equations: FamilyEquations, rows: Iterable[Row]) -> list[SolutionSpace]:
    """All points that satisfy the equations."""
    rows = [_lowered(row) for row in rows]
    pivots, below, remaining = _eliminated(rows, len(equations.numbers))
    conditions = [row[0] for row in remaining if row[0]]
    if conditions:
        first, *others = sorted(conditions, key=len)
        float_coefficients = [to_floats([p])[0] for p in others]
        values = [
            t
            for t in roots(first, 0.0, equations.top)
            if all(is_negligible(p, t, VANISHING) for p in float_coefficients)
        ]
        return [space for t in values for space in _at_one_t(equations, rows, t)]
    result = [_space(equations, None, pivots, below)]
    for t in roots(below, 0.0, equations.top):  # a line of solutions may exist at such t
        result += [s for s in _at_one_t(equations, rows, t) if len(s.free) > len(result[0].free)]
    return result


def _lowered(row: Row) -> Row:
    """An equation without a common power of t."""
    lowest = min([p.lowest_power for p in row if p], default=0)
    return tuple([p.times_power(-lowest) for p in row]) if lowest else row


def _eliminated(rows: list[Row], k: int) -> tuple[dict[int, Row], Polynomial, list[Row]]:
    """Rows that each give one x_j and share one factor; that factor; and the remaining rows without any x.

    Fraction-free elimination (Bareiss 1968): every division is exact.
    """
    waiting, columns = list(rows), set(range(1, k + 1))
    done: dict[int, Row] = {}
    factor = ONE
    while choices := [(_cost(row[j]), i, j) for i, row in enumerate(waiting) for j in columns if row[j]]:
        _, i, j = min(choices)
        pivot, last = waiting.pop(i), factor
        factor = pivot[j]
        columns.remove(j)
        waiting = [_without(row, pivot, j, last) for row in waiting]
        done = {**{n: _without(row, pivot, j, last) for n, row in done.items()}, j: pivot}
    return done, factor, waiting


def _cost(pivot: Polynomial) -> tuple[int, int]:
    """Cost of a pivot: the number of its missing powers, then its length; a pivot of one term keeps the degrees low."""
    return len(pivot) - pivot.coefficients.count(0), len(pivot)


def _without(row: Row, pivot: Row, j: int, last: Polynomial) -> Row:
    return tuple([(pivot[j] * a - row[j] * b) // last for a, b in zip(row, pivot, strict=True)])


def _space(equations: FamilyEquations, t: float | None, pivots: Mapping[int, Row], below: Polynomial) -> SolutionSpace:
    """The points where below x_j + pivots[j][0] + Σ pivots[j][n] x_n = 0, n the variables without a pivot."""
    columns = range(1, len(equations.numbers) + 1)
    free = tuple([j for j in columns if j not in pivots])
    alone = {j: (ZERO, *(below if n == j else ZERO for n in free)) for j in free}
    rows = [alone[j] if j in alone else tuple([-1 * pivots[j][n] for n in (0, *free)]) for j in columns]
    reduced = _lowered(tuple(without_common_factor((below, *(p for row in rows for p in row)))))
    width = len(free) + 1
    return SolutionSpace(
        equations, t, free, tuple(reduced[1 + i * width :][:width] for i in range(len(rows))), reduced[0]
    )


def _at_one_t(equations: FamilyEquations, rows: list[Row], t: float) -> list[SolutionSpace]:
    """Solutions at one t by elimination with the largest pivot; none where the rows contradict each other."""
    k = len(equations.numbers)
    polynomials = [to_floats(row) for row in rows]
    sizes = [max(size_at(p, t) for p in row) or 1.0 for row in polynomials]
    waiting = [np.array([evaluate(p, t) / size for p in row]) for row, size in zip(polynomials, sizes, strict=True)]
    solved: dict[int, np.ndarray] = {}
    while waiting:
        size, i, j = max(
            ((abs(r[j]), i, j) for i, r in enumerate(waiting) for j in range(1, k + 1)), default=(0.0, 0, 0)
        )
        if size <= SINGULAR:
            break
        pivot = waiting.pop(i)
        pivot = pivot / pivot[j]
        waiting = [r - r[j] * pivot for r in waiting]
        solved = {**{n: r - r[j] * pivot for n, r in solved.items()}, j: pivot}
    if any(abs(r[0]) > VANISHING for r in waiting):
        return []
    exact = {j: tuple([Polynomial([to_integer(c)]) for c in row.tolist()]) for j, row in solved.items()}
    return [_space(equations, t, exact, Polynomial([UNIT]))]


# -- sequence of curves as a family of motions ------------------------------------------------------------------


RISE, RETURN = ("h1", "h2", "h3"), ("h4", "h5", "h6")
MIRRORED = dict(zip(RISE, reversed(RETURN), strict=True))
SPEEDS = {name: row.speed for name, row in ELEMENTS.items()}
"""Factor c in span = c h/V of a curve with speed V at one end."""
_SINGLE = {"P2": KAPPA, "H6": pi / sqrt(2.0)}
"""Factor c in span = c √(g h3)/V of a return of one curve, whose acceleration at the top equals that of H2."""


@frozen
class BlendTask:
    """Strokes of rise and return [mm or deg], 0 where the motion has none, and the total span [deg]."""

    rise: float
    back: float
    span: float


@frozen
class BlendSolution:
    """A blended motion, curve by curve in the order of the sequence.

    Attributes
    ----------
    heights : magnitudes of the heights [mm or deg]
    spans : spans [deg]
    speed, back_speed : speeds of rise and return [per deg], 0 where the motion has none
    flats : spans of constant acceleration [deg] inside the curves; empty where there are none
    """

    sequence: CurveSequence
    heights: tuple[float, ...]
    spans: tuple[float, ...]
    speed: float
    back_speed: float
    flats: tuple[float, ...] = ()

    @property
    def peak_acceleration(self) -> float:
        """Largest |acceleration| [per deg²]; 0 of a constant velocity alone."""
        parts = zip(self.sequence.curves, self.heights, self.spans, strict=True)
        flats = self.flats or (0.0,) * len(self.spans)
        rows = ((peak_of(name, flat / b if b else 0.0), h, b) for (name, h, b), flat in zip(parts, flats, strict=True))
        return max((c * h / (b * b) if b * b else inf for c, h, b in rows if c), default=0.0)


def peak_of(curve: str, flat: float) -> float:
    """Factor c in the largest |a| = c h/β² of a curve with constant acceleration over a fraction of its span.

    The area under the acceleration is the velocity 2h/β; under a quarter sine it is 2/π of the peak.
    """
    return 2.0 / (flat + (1.0 - flat) * 2.0 / pi) if flat else ELEMENTS[curve].peak


@frozen
class PeakAcceleration:
    """Largest acceleration of a curve, factor S²/height, S its speed form ``W`` or ``R``, for a stroke and a span of 1.

    For a curve with constant acceleration over a span λ, height is h + λ (π - 2)/4 S.
    """

    speed: str
    height: str
    factor: float


@frozen
class Family:
    """All motions of a sequence for one ratio of the strokes.

    Attributes
    ----------
    mirrored : the return is the rise run backwards
    flats : heights of half cycloids with constant acceleration, and its fraction of the total span; of a mirrored
        family those of the rise
    """

    sequence: CurveSequence
    mirrored: bool = False
    flats: tuple[tuple[str, float], ...] = ()

    @cached_property
    def has_constant_rise(self) -> bool:
        """Whether the rise contains a curve of constant velocity."""
        return any(name in CONSTANT for name in self.sequence.rise)

    @cached_property
    def has_constant_return(self) -> bool:
        """Whether the return contains a curve of constant velocity."""
        return any(name in CONSTANT for name in self.sequence.back)

    @cached_property
    def positive(self) -> tuple[str, ...]:
        """Forms that must be positive: heights, and the ramps of a curve with constant acceleration."""
        if len(self.sequence.rise) == 1:
            return ()
        ramps = tuple(_ramps(height) for height, _ in self.flats)
        return ("h1", "h3", *(("h4", "h6") if len(self.sequence.back) > 1 else ()), *ramps)

    @cached_property
    def constant(self) -> tuple[str, ...]:
        """Heights of constant velocity, which may be 0."""
        return (*(("h2",) if self.has_constant_rise else ()), *(("h5",) if self.has_constant_return else ()))

    @cached_property
    def heights(self) -> tuple[str, ...]:
        """Names of the heights of the curves, without that of a single curve of a stroke."""
        rise, back = self.sequence.rise, self.sequence.back
        return (*(named(rise, RISE) if len(rise) > 1 else ()), *(named(back, RETURN) if len(back) > 1 else ()))

    @cached_property
    def single_back(self) -> str:
        """The only curve of the return, empty where it has several."""
        return self.sequence.back[0] if len(self.sequence.back) == 1 else ""

    @cached_property
    def harmonic(self) -> bool:
        """Whether the motion never dwells: accelerations at the bottom are equal, too."""
        return self.sequence.curves[0] == "H1"

    @cached_property
    def parameter(self) -> str:
        """Meaning of the variable t, in which the family is not linear; empty where nothing is free."""
        if len(self.sequence.rise) == 1:
            return ""
        if self.single_back:
            return "root of h3" if self.has_constant_rise or self.single_back == "P2" else ""
        if not self.sequence.back or self.mirrored:
            return "h3"
        constant = self.has_constant_rise or self.has_constant_return
        return "h1" if self.harmonic and not constant else "r"

    @cached_property
    def linear(self) -> tuple[str, ...]:
        """The other free variables: at given t, every height and W are linear in them."""
        if self.parameter == "r":
            h3 = self.has_constant_return or not self.harmonic
            h6 = self.has_constant_return and not self.harmonic
            rows = (("h1", self.has_constant_rise), ("h3", h3), ("h6", h6))
            return tuple([name for name, free in rows if free])
        is_single = self.parameter == "h3" or self.single_back == "P2"
        return ("h1",) if is_single and self.has_constant_rise else ()

    @cached_property
    def freedom(self) -> int:
        """Number of free variables."""
        return (1 if self.parameter else 0) + len(self.linear)

    @cached_property
    def accelerations(self) -> tuple[PeakAcceleration, ...]:
        """Accelerations that may be the largest: half cycloid π h/β², half harmonic π²/4 h/β², β = c h/V.

        Curves whose acceleration equals that of another curve are omitted.
        """
        first, last = (ELEMENTS[name] for name in (self.sequence.rise[0], self.sequence.rise[-1]))
        rows = [
            PeakAcceleration("W", self._effective_height("h1"), first.peak / first.speed**2),
            PeakAcceleration("W", self._effective_height("h3"), last.peak / last.speed**2),
        ]
        if len(self.sequence.back) > 1 and not self.mirrored and not self.harmonic:
            row = ELEMENTS[self.sequence.back[-1]]
            rows.append(PeakAcceleration("R", self._effective_height("h6"), row.peak / row.speed**2))
        return tuple(rows)

    def _effective_height(self, height: str) -> str:
        """Name of the form that replaces a height in its peak acceleration."""
        return f"{height} effective" if height in dict(self.flats) else height

    def acceleration_of(self, height: str) -> int:
        """Index in ``accelerations`` of the curve of a height."""
        return next(i for i, row in enumerate(self.accelerations) if row.height == self._effective_height(height))

    def equations(self, task: BlendTask) -> FamilyEquations:
        """Equations for the ratio of the strokes of a task."""
        return _equations(self, task.back / task.rise)

    def solution(
        self, task: BlendTask, t: float, heights: Iterable[float], given: Mapping[str, float]
    ) -> BlendSolution:
        """Motion from t and its ``heights`` for a stroke of 1.

        Heights that equal the ``given`` ones to rounding receive the given values.
        """
        if not self.heights:
            return BlendSolution(self.sequence, *_without_freedom(self.sequence, task), 0.0, 0.0)
        height_by_name = {name: max(h * task.rise, 0.0) for name, h in zip(self.heights, heights, strict=True)}
        if self.parameter == "r":
            height_by_name.update(self._return_heights(task, height_by_name, t * t))
        for name, value in given.items():
            if abs(value - height_by_name[name]) <= min(1e-14 * task.rise, 1e-13 * value):
                height_by_name[name] = value
        return self._with_speeds(task, height_by_name, self._speed_ratio(task, t))

    def _return_heights(self, task: BlendTask, rise: Mapping[str, float], square: float) -> dict[str, float]:
        """Heights of the return from those of the rise, with exactly equal accelerations at the joins; square = r²."""
        h4 = square * rise["h3"]
        h6 = square * rise["h1"] if self.harmonic else rise["h6"] if self.has_constant_return else task.back - h4
        middle = {"h5": max(task.back - h4 - h6, 0.0)} if self.has_constant_return else {}
        return {"h4": h4, **middle, "h6": h6}

    def _speed_ratio(self, task: BlendTask, t: float) -> float:
        """Ratio r of the speed of the return to that of the rise."""
        return t if self.parameter == "r" else sqrt(task.back / task.rise) if self.parameter == "h1" else 1.0

    def _with_speeds(self, task: BlendTask, height_by_name: Mapping[str, float], ratio: float) -> BlendSolution:
        """Solution with speeds from the heights; spans add up and joins are continuous to rounding."""
        rises, heights = len(self.sequence.rise), tuple([height_by_name[name] for name in self.heights])
        works = [SPEEDS[curve] * h for curve, h in zip(self.sequence.curves, heights, strict=not self.single_back)]
        if self.single_back:
            heights += (task.back,)
            works.append(_SINGLE[self.single_back] * sqrt(task.back * height_by_name["h3"]))
        works[rises:] = [work / ratio for work in works[rises:]]
        speed = sum(works) / task.span
        back_speed = ratio * speed if len(self.sequence.back) > 1 else 0.0
        flats = self._flat_spans(task) if self.flats else ()
        return BlendSolution(self.sequence, heights, tuple([work / speed for work in works]), speed, back_speed, flats)

    def _flat_spans(self, task: BlendTask) -> tuple[float, ...]:
        """Span of the constant acceleration [deg] of each curve."""
        rise, back = self.sequence.rise, self.sequence.back
        names = (*(named(rise, RISE) if len(rise) > 1 else rise), *(named(back, RETURN) if len(back) > 1 else back))
        spans = {name: share * task.span for name, share in self.flats}
        spans.update({MIRRORED[name]: span for name, span in spans.items()} if self.mirrored else {})
        return tuple(spans.get(name, 0.0) for name in names)


def _ramps(height: str) -> str:
    return f"{height} ramps"


def named(curves: tuple[str, ...], names: tuple[str, str, str]) -> tuple[str, ...]:
    """Names of the heights of the curves of one stroke."""
    return names if len(curves) == 3 else names[::2]


def _without_freedom(sequence: CurveSequence, task: BlendTask) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Heights and spans of C5; C6; P1-P2 and H5-H6, whose accelerations at the top are equal: β1/β2 = √(h/g)."""
    if not sequence.back:
        return (task.rise,), (task.span,)
    first = task.span * sqrt(task.rise) / (sqrt(task.rise) + sqrt(task.back))
    return (task.rise, task.back), (first, task.span - first)


# -- equations of a family --------------------------------------------------------------------------------


@lru_cache(maxsize=256)
def _equations(family: Family, g: float) -> FamilyEquations:
    """Forms of all heights, of W, R and ``up``, the span of the rise times its speed; g: ratio of the strokes."""
    numbers = family.linear
    free = {name: term(len(numbers), j) for j, name in enumerate(("", *numbers))}
    one = free[""]
    forms = _rise(family, free, g)
    forms["up"] = _work(family.sequence.rise, forms, RISE)
    if family.single_back:
        forms["h4"] = g * one
        root = times_t(one, 1) if family.parameter else sqrt(0.5) * one  # √h3
        forms["W"] = forms["up"] + _SINGLE[family.single_back] * sqrt(g) * root
    elif family.sequence.back:
        forms.update(_back(family, forms, free, g))
        down = _work(family.sequence.back, forms, RETURN)
        if family.parameter == "r":
            forms["W"], forms["R"] = forms["up"] + times_t(down, -1), times_t(forms["up"], 1) + down
        else:
            r = sqrt(g) if family.parameter == "h1" else 1.0
            forms["W"], forms["R"] = forms["up"] + down / r, forms["up"] * r + down
    else:
        forms["W"] = forms["up"]
    for height, share in family.flats:  # 2h/S must exceed λ; effective height h + λ (π - 2)/4 S
        speed = forms["W" if height in RISE else "R"]
        forms[_ramps(height)] = 2.0 * forms[height] - share * speed
        forms[f"{height} effective"] = forms[height] + share * (pi - 2.0) / 4.0 * speed
    tops = [g if name == "h6" else 1.0 for name in numbers]
    return FamilyEquations(forms, numbers, inf if family.parameter == "r" else 1.0, tops)


def _work(curves: tuple[str, ...], forms: Mapping[str, Form], names: tuple[str, str, str]) -> Form:
    """Span times speed of one stroke, Σ c h."""
    rows = zip(curves, named(curves, names), strict=True)
    return np.sum([SPEEDS[curve] * forms[name] for curve, name in rows], axis=0)


def _rise(family: Family, free: Mapping[str, Form], g: float) -> dict[str, Form]:
    """Forms of h1, h2, h3; ``free``: the free variables x by name, and 1 under an empty name."""
    parameter, one = family.parameter, free[""]
    if family.single_back == "H6":
        h1 = h3 = times_t(one, 2) if parameter else 0.5 * one
    elif parameter == "h1":
        h1 = times_t(one, 1)
        h3 = one - h1
    elif parameter == "r":
        # of a motion that never dwells, without constant velocity on the return: r² (h1 + h3) = g
        h3 = free["h3"] if "h3" in free else g * times_t(one, -2) - free["h1"]
        h1 = free["h1"] if "h1" in free else one - h3
    else:
        h3 = times_t(one, 2 if parameter == "root of h3" else 1)
        h1 = free["h1"] if "h1" in free else one - h3
    middle = {"h2": one - h1 - h3} if family.has_constant_rise else {}
    return {"h1": h1, **middle, "h3": h3}


def _back(family: Family, rise: Mapping[str, Form], free: Mapping[str, Form], g: float) -> dict[str, Form]:
    """Forms of h4, h5, h6: equal acceleration at the top, h4 = r² h3; where the motion never dwells also h6 = r² h1."""
    stroke = g * free[""]
    if family.mirrored:
        h4, h6 = rise["h3"], rise["h1"]
    elif family.parameter == "h1":
        h4, h6 = g * rise["h3"], g * rise["h1"]
    else:
        h4 = times_t(rise["h3"], 2)
        h6 = times_t(rise["h1"], 2) if family.harmonic else free.get("h6", stroke - h4)
    middle = {"h5": stroke - h4 - h6} if family.has_constant_return else {}
    return {"h4": h4, **middle, "h6": h6}
