"""Cam lobe of a valve train: each side is run-up, ramp of constant velocity, flank and nose, given by its acceleration.

Angles are degrees of the cam. A side runs from rest to the nose, where the velocity is 0 again and the acceleration least.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from math import cos, inf, isfinite, pi, sin, sqrt

from core.errors import KindynaError
from core.frozen import frozen
from core.laws.pieces import Acceleration, Piece, integrate, stretched
from core.numerics.derivatives import QUARTER
from core.numerics.roots import BracketEnds, bounded_minimum, bracketed_root

# -- one side of a lobe -----------------------------------------------------------------------------------------


@frozen
class SideForm:
    """What is given of a side before its flank and nose are solved.

    Attributes
    ----------
    lift : height of the nose [mm]
    ramp : height at which the ramp ends [mm]
    slope : velocity of the ramp [mm/deg]
    runup : span from rest to the ramp [deg]
    flank_flat, nose_flat : part of flank and nose at constant acceleration, 0 ... 1
    room : greatest span of the side among those of which the range of a value is given [deg]
    """

    lift: float
    ramp: float
    slope: float
    runup: float
    flank_flat: float = 0.0
    nose_flat: float = 0.0
    room: float = 360.0

    @property
    def above(self) -> float:
        """Lift above the ramp [mm]."""
        return self.lift - self.ramp

    @property
    def ramp_span(self) -> float:
        """Span of the ramp's constant velocity [deg]."""
        return (self.ramp - 0.5 * self.slope * self.runup) / self.slope

    @cached_property
    def flank_mean(self) -> float:
        """Mean over greatest acceleration of the flank."""
        return self.flank_flat + (1.0 - self.flank_flat) * 2.0 / pi

    @cached_property
    def nose_mean(self) -> float:
        """Mean over greatest acceleration of the nose."""
        return self.nose_flat + (1.0 - self.nose_flat) * 2.0 / pi

    @cached_property
    def nose_rise(self) -> float:
        """Rise κ of the nose over the product of greatest velocity and span."""
        return self.nose(1.0)[0] / self.nose_mean

    def flank(self, x: float) -> tuple[float, float]:
        """Rise and velocity of the flank at the part x of its span, for a gain of velocity of 1 over a span of 1."""
        if x > 0.5:
            rise, velocity = self.flank(1.0 - x)
            return rise + x - 0.5, 1.0 - velocity
        quarter, mean = 0.5 * (1.0 - self.flank_flat), self.flank_mean
        unit = 2.0 * quarter / pi
        if x < quarter:
            return unit * (x - unit * sin(x / unit)) / mean, unit * (1.0 - cos(x / unit)) / mean
        u = x - quarter
        return (unit * (quarter - unit) + unit * u + 0.5 * u * u) / mean, (unit + u) / mean

    def nose(self, x: float) -> tuple[float, float]:
        """Drop from the nose and velocity at the part x of its span, for a greatest acceleration of 1 over a span of 1."""
        flat = self.nose_flat
        if x <= flat:
            return 0.5 * x * x, x
        unit = 2.0 * (1.0 - flat) / pi
        wave = (x - flat) / unit
        return 0.5 * flat * flat + flat * (x - flat) + unit * unit * (1.0 - cos(wave)), flat + unit * sin(wave)

    def top_velocity(self, flank: float, nose: float) -> float:
        """Greatest velocity V [mm/deg] with which spans of flank and nose [deg] reach the lift."""
        return (self.above - 0.5 * self.slope * flank) / (0.5 * flank + self.nose_rise * nose)

    def ramp_distance(self, height: float) -> float:
        """Span [deg] from a height at or below the end of the ramp to the end of the ramp."""
        low = 0.5 * self.slope * self.runup
        if height >= low:
            return (self.ramp - height) / self.slope

        def missing(x: float) -> float:
            return 0.5 * self.slope * (x - self.runup / pi * sin(pi * x / self.runup)) - height

        at = _root(missing, 0.0, self.runup)
        return self.ramp_span + self.runup - at


@frozen
class Side:
    """A solved side: its form, and the spans of flank and nose [deg]."""

    form: SideForm
    flank: float
    nose: float

    @property
    def span(self) -> float:
        """Span from rest to the nose [deg]."""
        return self.form.runup + self.form.ramp_span + self.flank + self.nose

    @cached_property
    def velocity(self) -> float:
        """Greatest velocity V [mm/deg]."""
        return self.form.top_velocity(self.flank, self.nose)

    @property
    def acceleration(self) -> float:
        """Greatest acceleration of the flank A [mm/deg²]."""
        return (self.velocity - self.form.slope) / (self.flank * self.form.flank_mean)

    @property
    def nose_acceleration(self) -> float:
        """Greatest deceleration of the nose N [mm/deg²]."""
        return self.velocity / (self.nose * self.form.nose_mean)

    def lift_and_growth(self, distance: float) -> tuple[float, float]:
        """Lift [mm] at a distance from the nose [deg], and its derivative by the span of the nose [mm/deg].

        The distance must be on nose or flank. The derivative is that at a constant lift of the nose and span of the flank.
        """
        form, v, nose = self.form, self.velocity, self.nose
        growth = -form.nose_rise / (0.5 * self.flank + form.nose_rise * nose)  # of V, relative
        if distance <= nose:
            part = distance / nose
            drop, speed = form.nose(part)
            size = v / form.nose_mean
            return form.lift - size * nose * drop, -size * (drop + nose * growth * drop - part * speed)
        at, gain = self.flank + nose - distance, v - form.slope
        rise, speed = form.flank(at / self.flank)
        lift = form.ramp + form.slope * at + gain * self.flank * rise
        return lift, form.slope + gain * speed + growth * v * self.flank * rise

    def distance(self, height: float) -> float:
        """Distance from the nose [deg] at which the side has a height [mm]."""
        form, above = self.form, self.flank + self.nose
        if height <= form.ramp:
            return above + form.ramp_distance(height)
        return _root(lambda x: self.lift_and_growth(x)[0] - height, 0.0, above)

    def accelerations(self) -> tuple[Acceleration, ...]:
        """Sections of the acceleration [mm/deg²] from rest to the nose, with spans in deg."""
        form = self.form
        flank, flat = 0.5 * (1.0 - form.flank_flat) * self.flank, form.flank_flat * self.flank
        nose, top = (1.0 - form.nose_flat) * self.nose, form.nose_flat * self.nose
        return (
            Acceleration(form.runup, 0.0, pi * form.slope / (2.0 * form.runup), pi / form.runup),
            Acceleration(form.ramp_span),
            *_quarters(flank, flat, self.acceleration),
            _quarter(nose, -self.nose_acceleration),
            Acceleration(top, -self.nose_acceleration),
        )

    def pieces(self, *, closing: bool = False) -> tuple[Piece, ...]:
        """Displacement [mm] from the start of the side over u = 0 ... 1; ``closing``: from the nose to rest."""
        rows = self.accelerations()
        rows = tuple(_backwards(row) for row in reversed(rows)) if closing else rows
        span = self.span
        unit = tuple(replace(row, width=row.width / span, frequency=row.frequency * span) for row in rows)
        lift = self.form.lift
        return tuple(stretched(integrate(unit), 0.0, 1.0, 0.0, -lift if closing else lift, 0.0))


def _quarter(width: float, peak: float, phase: float = 0.0) -> Acceleration:
    """A quarter of a sine wave."""
    return Acceleration(width, 0.0, peak, QUARTER / width if width > 0.0 else 1.0, phase)


def _quarters(width: float, flat: float, peak: float) -> tuple[Acceleration, ...]:
    """Quarter sine, constant acceleration, quarter cosine."""
    return _quarter(width, peak), Acceleration(flat, peak), _quarter(width, peak, QUARTER)


def _backwards(row: Acceleration) -> Acceleration:
    """The section in the opposite direction of time, sin(f (w - x) + p); every wave is a quarter or a half of a sine."""
    if not row.amplitude or row.frequency * row.width > 2.0 * QUARTER - 1e-9:
        return row
    return replace(row, phase=QUARTER - row.phase)


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Zero of a function that changes its sign between two arguments."""
    first, last = function(low), function(high)
    if first == 0.0:
        return low
    ends = bracketed_root(function, BracketEnds(low, first, high, last))
    return ends.a if abs(ends.fa) < abs(ends.fb) else ends.b


# -- solution of a side from two of its values ------------------------------------------------------------------

HEIGHT, VELOCITY, ACCELERATION, NOSE_ACCELERATION = "height", "velocity", "acceleration", "nose_acceleration"


@frozen
class Condition:
    """A value that a side must have.

    Attributes
    ----------
    kind : ``height``, or the name of an attribute of ``Side``
    value : the distance from the nose at a height [deg], a velocity [mm/deg] or an acceleration [mm/deg²]
    height : lift at which the distance is given [mm]
    """

    kind: str
    value: float
    height: float = 0.0

    def of(self, side: Side) -> float:
        """Value of the condition that a side has."""
        return side.distance(self.height) if self.kind == HEIGHT else float(getattr(side, self.kind))


class NoLobe(KindynaError):
    """No side has the values.

    Attributes
    ----------
    low, high : range of the last value that a side can have together with the first; ``low > high`` where there is none
    """

    def __init__(self, low: float = inf, high: float = -inf) -> None:
        super().__init__("no lobe has these values")
        self.low, self.high = low, high


LEAST_FLANK, MOST_FLANK, FLANKS = 0.01, 360.0, 36  # [deg], and the number of spans that are tried
CLOSE = 1e-6  # relative accuracy of the ends of ranges
QUADRATIC = 1e-8  # relative step of Newton's method after which the next one would be rounding


def solve_side(form: SideForm, first: Condition, last: Condition) -> Side:
    """The side with two values; of several the one with the least acceleration of the flank.

    The first value gives the span of the nose for each span of the flank; the second one is a root in the span of the flank.

    Raises
    ------
    NoLobe
        No side has both values.
    """
    curve = _Curve(form, first)
    residual = _residual(form, last)
    sides = curve.sides()
    roots = [curve.at(flank) for flank in _roots(curve, sides, residual)]
    solutions = [side for side in roots if side is not None]
    if not solutions:
        curve = _Curve(form, first, form.room)
        raise NoLobe(*_range(curve, curve.sides(), last))
    return min(solutions, key=lambda side: side.acceleration)


def _residual(form: SideForm, last: Condition) -> Callable[[Side], float]:
    """Function of a side whose sign changes where the side has a value."""
    if last.kind != HEIGHT:
        return lambda side: float(getattr(side, last.kind)) - last.value
    if last.height <= form.ramp:
        above = last.value - form.ramp_distance(last.height)
        return lambda side: side.flank + side.nose - above

    def lift_error(side: Side) -> float:
        if last.value >= side.flank + side.nose:
            return form.ramp - last.height - (last.value - side.flank - side.nose) * form.slope
        return side.lift_and_growth(last.value)[0] - last.height

    return lift_error


class _Curve:
    """Sides with one value and a span of at most ``room`` [deg], by the span of the flank."""

    def __init__(self, form: SideForm, condition: Condition, room: float = inf) -> None:
        self._form, self._condition, self._room, self._guess = form, condition, room, 0.0
        self._nose = getattr(self, f"_by_{condition.kind}")

    def at(self, flank: float) -> Side | None:
        """The side with a span of the flank; None where there is none whose flank accelerates."""
        nose = self._nose(flank)
        if not (isfinite(nose) and nose > 0.0):
            return None
        side = Side(self._form, flank, nose)
        return side if side.velocity > self._form.slope and side.span <= self._room else None

    def sides(self) -> list[Side]:
        """Sides with spans of the flank over the range in which there are any, with its ends."""
        ratio = (MOST_FLANK / LEAST_FLANK) ** (1.0 / FLANKS)
        spans = [LEAST_FLANK * ratio**k for k in range(FLANKS + 1)]
        tried = [(span, self.at(span)) for span in spans]
        result: list[Side] = []
        for (a, before), (b, after) in pairwise(tried):
            if before is not None:
                result.append(before)
            if (before is None) != (after is None):
                result.append(self._edge(a, before, b, after))
        last = tried[-1][1]
        return result if last is None else [*result, last]

    def _edge(self, a: float, before: Side | None, b: float, after: Side | None) -> Side:
        """The last side next to spans that have none."""
        inside, outside, side = (b, a, after) if before is None else (a, b, before)
        assert side is not None
        while abs(inside - outside) > CLOSE * inside:
            middle = 0.5 * (inside + outside)
            candidate = self.at(middle)
            inside, outside, side = (inside, middle, side) if candidate is None else (middle, outside, candidate)
        return side

    def _by_velocity(self, flank: float) -> float:
        form, v = self._form, self._condition.value
        return ((form.above - 0.5 * form.slope * flank) / v - 0.5 * flank) / form.nose_rise

    def _by_acceleration(self, flank: float) -> float:
        form = self._form
        v = form.slope + self._condition.value * flank * form.flank_mean
        return ((form.above - 0.5 * form.slope * flank) / v - 0.5 * flank) / form.nose_rise

    def _by_nose_acceleration(self, flank: float) -> float:
        """Positive root of N m c (b/2 + κ c) = L - h - v b/2."""
        form = self._form
        square = self._condition.value * form.nose_mean * form.nose_rise
        half = 0.25 * self._condition.value * form.nose_mean * flank
        rest = form.above - 0.5 * form.slope * flank
        return rest / (half + sqrt(half * half + square * rest)) if rest > 0.0 else -1.0

    def _by_height(self, flank: float) -> float:
        """Newton's method in a bracket: the lift at a distance from the nose grows with the span of the nose."""
        form, height, at = self._form, self._condition.height, self._condition.value
        if height <= form.ramp:
            return at - form.ramp_distance(height) - flank
        low, high = max(at - flank, 0.0), (form.above / form.slope - flank) / form.nose_rise
        if not high > low:
            return -1.0
        most = high
        nose = self._guess if low < self._guess < high else min(low + 0.5 * flank, 0.5 * (low + high))
        for _ in range(100):
            lift, slope = Side(form, flank, nose).lift_and_growth(at)
            low, high = (nose, high) if lift < height else (low, nose)
            step = (height - lift) / slope if slope > 0.0 else inf
            if abs(step) <= QUADRATIC * nose:
                nose += step
                break
            nose = nose + step if low < nose + step < high else 0.5 * (low + high)
            if high - low <= 1e-12 * most:
                break
        self._guess = nose
        return nose if 1e-11 * most < nose < most * (1.0 - 1e-11) else -1.0


def _roots(curve: _Curve, sides: Sequence[Side], residual: Callable[[Side], float]) -> Iterator[float]:
    """Spans of the flank at which a residual of the sides of a curve is zero."""
    values = [residual(side) for side in sides]

    def at(flank: float) -> float:
        side = curve.at(flank)
        return inf if side is None else residual(side)

    for (a, fa), (b, fb) in pairwise(zip((side.flank for side in sides), values, strict=True)):
        if fa == 0.0:
            yield a
        elif fa * fb < 0.0:
            yield _narrowed(at, a, fa, b, fb)
    if values and values[-1] == 0.0:
        yield sides[-1].flank
    for k in range(1, len(sides) - 1):  # two zeros between two spans that were tried
        sign = 1.0 if values[k] > 0.0 else -1.0
        near = [sign * value for value in values[k - 1 : k + 2]]
        if near[1] < near[0] and near[1] <= near[2] and min(near) > 0.0:
            low, high = sides[k - 1].flank, sides[k + 1].flank
            middle, least = bounded_minimum(lambda x, s=sign: s * at(x), low, high, CLOSE * high)  # type: ignore[misc]
            if least <= 0.0:
                value = sign * least
                yield _narrowed(at, low, values[k - 1], middle, value)
                yield _narrowed(at, high, values[k + 1], middle, value)


def _narrowed(function: Callable[[float], float], a: float, fa: float, b: float, fb: float) -> float:
    ends = bracketed_root(function, BracketEnds(a, fa, b, fb))
    return ends.a if abs(ends.fa) < abs(ends.fb) else ends.b


def _range(curve: _Curve, sides: Sequence[Side], last: Condition) -> tuple[float, float]:
    """Range of a value over the sides of a curve; (∞, -∞) where there are none."""
    if not sides:
        return inf, -inf
    values = [last.of(side) for side in sides]
    ends = []
    for sign in (1.0, -1.0):
        k = min(range(len(values)), key=lambda i, s=sign: s * values[i])  # type: ignore[misc]
        best = values[k]
        if 0 < k < len(values) - 1:

            def height(flank: float, sign: float = sign) -> float:
                side = curve.at(flank)
                return inf if side is None else sign * last.of(side)

            best = sign * min(
                bounded_minimum(height, sides[k - 1].flank, sides[k + 1].flank, 1e-6 * sides[k].flank)[1], sign * best
            )
        ends.append(best)
    return ends[0], ends[1]
