"""What the designer asks for, solved over a family. Linear wishes and an acceleration are polynomials of one number, all
of whose roots are found; a point to pass is a smooth function of one number."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from math import inf

import numpy as np

from core.blend.arcs import arcs
from core.blend.crossings import crossings
from core.blend.curve import OPEN, Curve, Extreme, Stretch
from core.blend.equations import Row
from core.blend.family import Family, Solution, Task
from core.blend.flats import flats
from core.blend.gentlest import least_acceleration
from core.blend.metering import ROUNDED, Meter
from core.blend.range import Range, merged, tied
from core.blend.region import Region
from core.blend.search import Ground, least, no_more, starts
from core.blend.smooth import resolved
from core.blend.wishes import HEIGHTS, POINT, Wish, equation, in_units, size_of

Place = tuple[float, tuple[float, ...]]
"""t and the other numbers of a family."""
_INSIDE = 1e-12  # how far from the ends of a feasible stretch it is looked
_TOGETHER = 8  # so many motions beside each other are a whole line of them
_SHARP = 1e-4  # an extreme that moves by more of its value has become another one
_ENDLESS = 1e6  # an acceleration that gets so many times greater than the least has no upper end


@dataclass(frozen=True)
class Track:
    """Feasible points along a number z from low to high."""

    places: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    low: float
    high: float
    low_open: bool = False
    high_open: bool = False


class Problem:
    """A family, a task and what is wished; inside, stroke of the rise and span are 1."""

    def __init__(self, family: Family, task: Task, wishes: Sequence[Wish]) -> None:
        self.family, self.task, self.asked = family, task, tuple(wishes)
        self.wishes = tuple(in_units(w, task) for w in wishes)

    @cached_property
    def meter(self) -> Meter:
        return Meter(self.family, self.task)

    @cached_property
    def rows(self) -> list[Row]:
        """The equations of the linear wishes."""
        return self._rows(self.wishes)

    def _rows(self, wishes: Sequence[Wish]) -> list[Row]:
        return [equation(w, self.family, self.meter.equations) for w in wishes if w.linear]

    def curves(self, wishes: Sequence[Wish]) -> list[Curve]:
        """The points that meet linear wishes where these leave one number free."""
        found = flats(self.meter.equations, self._rows(wishes))
        return [Curve.of(self.family, f) for f in found if f.freedom == 1]

    # -- solutions ----------------------------------------------------------------------------------------

    def solutions(self) -> list[Solution]:
        """Every solution where there are as many wishes as free numbers, the gentlest first, of equally gentle ones that of
        the least t; none where the wishes leave something free."""
        found = [self.solution_at(place) for place in sorted(self._met())]
        return sorted(found, key=lambda s: float(f"{s.peak_acceleration:.12g}")) if len(found) > 1 else found

    def solution_at(self, place: Place) -> Solution:
        """The motion at a point."""
        exact = {w.name: w.value for w in self.asked if w.name in HEIGHTS}
        heights = self.meter.equations.at(self.family.heights, *place) if self.family.heights else ()
        return self.family.solution(self.task, place[0], heights, exact)

    def _met(self) -> list[Place]:
        """The points that meet all wishes and are feasible, each once."""
        if not self.family.bent:
            return [(1.0, ())]
        found: list[Place] = []
        together = 0
        for start in self._candidates():
            t, x, met = self.meter.polished(self.wishes, *start, ROUNDED)
            if not met or not self.meter.is_feasible(t, x) or any(_alike((t, x), p) for p in found):
                continue
            if self._is_alone(t, x):
                found.append((t, x))
            elif (together := together + 1) > _TOGETHER:
                break
        return found

    def _is_alone(self, t: float, x: tuple[float, ...]) -> bool:
        """A point to pass may follow from the other wishes where it lies: then many motions pass it, and none is meant."""
        return all(w.name != POINT for w in self.wishes) or self.meter.is_alone(self.wishes, t, x)

    def _candidates(self) -> Iterator[Place]:
        """Points where all wishes may be met."""
        bent = [w for w in self.wishes if not w.linear]
        names = [w.name for w in bent]
        if not bent:
            for flat in flats(self.meter.equations, self._rows(self.wishes)):
                if flat.freedom == 0 and flat.t is not None:
                    yield flat.t, tuple(row[0] for row in flat.numbers)
        elif names == ["acceleration"]:
            for curve in self.curves(self.wishes):
                yield from (curve.place(p) for p in curve.where(bent[0]))
        elif names.count(POINT) == 1:
            point = next(w for w in bent if w.name == POINT)
            for track in self._tracks([w for w in self.wishes if w is not point]):
                yield from self._where(point, track)
        else:
            yield from crossings(self.meter, Region(self.family, self.meter, self.rows), bent)

    def _tracks(self, wishes: Sequence[Wish]) -> list[Track]:
        """The feasible points that meet wishes, at most one of them an acceleration, that leave one number free."""
        bent = next((w for w in wishes if not w.linear), None)
        if bent is None:
            return [_along(c, s) for c in self.curves(wishes) for s in c.stretches]
        found, lines = arcs(self.family, self.meter, self._rows(wishes), bent.value)
        return [Track(a.places, 0.0, 1.0) for a in found] + [_along(c, s) for c in lines for s in c.stretches]

    def _value(self, wish: Wish, track: Track, z: np.ndarray) -> np.ndarray:
        return self.meter.many(wish, *track.places(z))

    def _where(self, wish: Wish, track: Track) -> Iterator[Place]:
        """Places on a track where a wish may be met."""
        for series in resolved(partial(self._value, wish, track), track.low, track.high, 1.0):
            t, x = track.places(series.where(wish.value))
            yield from ((float(a), tuple(float(v) for v in b)) for a, b in zip(t, x.T, strict=True))

    # -- ranges -------------------------------------------------------------------------------------------

    def ranges(self, i: int) -> list[Range]:
        """What the i-th wish may be while the others stay; empty where they leave nothing. The fewer the others, the
        more that is free."""
        mine, others = self.wishes[i], [*self.wishes[:i], *self.wishes[i + 1 :]]
        missing = self.family.freedom - len(others)
        if missing < 1:
            return []
        bent = [w.name for w in others if not w.linear]
        size = size_of(mine.name, self.task)
        if missing > 1 and not bent and mine.name == "acceleration":
            found = self._accelerations(others)
        elif POINT in bent or (missing > 1 and (bent or not mine.linear)):
            found = self._searched(mine, others)
        elif missing > 1:
            found = Region(self.family, self.meter, self._rows(others)).ranges(mine.name)
        elif bent or mine.name == POINT:
            found = [r for track in self._tracks(others) for r in self._followed(mine, track)]
        else:
            found = [r for curve in self.curves(others) for r in self._measured(mine, others, curve)]
        return merged(r.times(size) for r in found)

    def _measured(self, wish: Wish, others: Sequence[Wish], curve: Curve) -> Iterator[Range]:
        """What a wish may be on a curve, stretch by stretch."""
        for stretch in curve.stretches:
            found = curve.extremes(curve.quotients(wish.name), stretch)
            low, high = min(found, key=lambda e: e.value), max(found, key=lambda e: e.value)
            yield Range(
                self._sharpened(wish, others, curve, low),
                self._sharpened(wish, others, curve, high),
                all(e.open for e in found if tied(e.value, low.value)),
                all(e.open for e in found if tied(e.value, high.value)),
            )

    def _sharpened(self, wish: Wish, others: Sequence[Wish], curve: Curve, end: Extreme) -> float:
        """An extreme as exact as the wishes themselves, not only as the curve's number: Newton's method on these, and on
        the heights that are 0 there."""
        if not 0.0 < end.p < curve.top or not 0.0 < end.value < inf:
            return end.value
        gone = [Wish(n, 0.0) for n in curve.heights if abs(curve.height(n, end.p)) <= OPEN]
        if not (others or gone):
            return end.value
        t, x, met = self.meter.polished([*others, *gone], *curve.place(end.p))
        value = self.meter.measure(wish, t, x)[0]
        return value if met and abs(value - end.value) <= _SHARP * end.value else end.value

    def _followed(self, wish: Wish, track: Track) -> Iterator[Range]:
        """What a wish may be on a track: at its ends and at every turn of a series."""
        series = resolved(partial(self._value, wish, track), track.low, track.high, 1.0)
        width = track.high - track.low
        ends = np.array([track.low + _INSIDE * width, track.high - _INSIDE * width])
        places = np.concatenate([ends, *(s.turns() for s in series), *([s.low, s.high] for s in series[1:-1])])
        values = self._value(wish, track, places)
        open_ = np.array([track.low_open, track.high_open, *[False] * (places.size - 2)])
        good = np.isfinite(values)
        if good.any():
            values, open_ = values[good], open_[good]
            low, high = float(values.min()), float(values.max())
            near = 1e-9 * max(abs(low), abs(high))
            yield Range(low, high, bool(open_[values <= low + near].all()), bool(open_[values >= high - near].all()))

    def _searched(self, wish: Wish, others: Sequence[Wish]) -> list[Range]:
        """What a wish may be at the least and at the most, by search."""
        found = [self._end(wish, others, sign) for sign in (1.0, -1.0)]
        if any(place is None for _, place in found):
            return []
        (low, first), (high, last) = found
        if wish.name == "acceleration" and -high > _ENDLESS * low:
            return [Range(low, inf, False, True)]
        return [Range(low, -high, *(not self.meter.is_feasible(*place, OPEN) for place in (first, last) if place))]

    def _end(self, wish: Wish, others: Sequence[Wish], sign: float) -> tuple[float, Place | None]:
        """The least of a measure, or of its negative. An acceleration beside it counts as the most that any curve may
        have: of the points with less of it some lie beyond those that have it, unless there is no more to be had."""
        meter, bends = self.meter, range(len(self.family.bends))

        def goal(values: np.ndarray, slopes: np.ndarray) -> tuple[float, np.ndarray]:
            value, slope = meter.of_values(wish, values, slopes)
            return sign * value, sign * slope

        gentle = wish.name == "acceleration" and sign > 0.0
        goals = tuple(partial(meter.bend, i) for i in bends) if gentle else (goal,)
        ground = Ground(meter, tuple(others), goals)
        bent = [w for w in others if not w.linear]
        if [w.name for w in bent] != ["acceleration"]:
            return least(ground, starts(meter, others, lambda t, x: sign * meter.many(wish, t, x)))
        linear = tuple(w for w in others if w.linear)
        gentlest = least_acceleration(meter, self._rows(linear))
        if gentlest is None or gentlest[0] > bent[0].value:
            return inf, None
        limits = tuple(no_more(meter, i, bent[0].value) for i in bends)
        found = least(Ground(meter, linear, goals, limits), [gentlest[1]])
        reached = found[1] is not None and meter.measure(bent[0], *found[1])[0]
        return found if reached and reached > bent[0].value * (1.0 - 1e-6) else least(ground, [gentlest[1]])

    def _accelerations(self, others: Sequence[Wish]) -> list[Range]:
        """From the least, which is exact, to the greatest, which is infinite where a height may become 0."""
        rows = self._rows(others)
        least_one = least_acceleration(self.meter, rows)
        if least_one is None:
            return []
        high = max((r.high for r in Region(self.family, self.meter, rows).ranges("acceleration")), default=inf)
        return [Range(least_one[0], high, False, high == inf)]


def _along(curve: Curve, stretch: Stretch) -> Track:
    """A feasible part of a curve; a number without end is counted as z = p/(1 + p)."""
    open_ = curve.is_open(stretch.low), curve.is_open(stretch.high)
    if curve.top < inf:
        return Track(curve.places, stretch.low, stretch.high, *open_)
    low, high = (1.0 if p == inf else p / (1.0 + p) for p in (stretch.low, stretch.high))
    return Track(lambda z: curve.places(z / (1.0 - z)), low, high, *open_)


def _alike(a: Place, b: Place) -> bool:
    return all(abs(v - w) <= 1e-9 * (abs(v) + abs(w)) for v, w in zip((a[0], *a[1]), (b[0], *b[1]), strict=True))
