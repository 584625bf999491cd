"""What a motion of a family measures at one point, with its derivatives, and at many points at once."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache

import numpy as np

from core.blend.curves import ELEMENTS
from core.blend.family import RETURN, RISE, SPEEDS, Family, Task, named
from core.blend.wishes import POINT, Wish, ratio
from core.cancellation import checkpoint
from core.laws import Law, find_law

STEPS = 12
MET = 1e-11  # how well a wish is met: its share, that of the stroke for a point ...
EPS = 16 * 2.0**-53  # ... or as well as the rounding of the numbers lets it
ROUNDED = 4 * 2.0**-53 / MET  # a wish that is missed by no more than its roundings gains nothing
ALONE = 1e-11  # directions in which wishes grow that differ by less are the same
ROUNDING = 1e-13  # a height of constant velocity that misses 0 by less is 0


@lru_cache(maxsize=64)
def law_of(curve: str) -> Law:
    law = find_law(curve.lower())
    assert law is not None
    return law


class Meter:
    """A family, its equations and what lies below its foot; all for a stroke of the rise and a span of 1."""

    def __init__(self, family: Family, task: Task) -> None:
        self.family, self.equations = family, family.equations(task)
        self._foot = max(0.0, task.back / task.rise - 1.0) if family.sequence.back else 0.0

    @cached_property
    def curves(self) -> list[tuple[str, str, str]]:
        """Curve, name of its height, name of its speed; the one curve of a return has no speed."""
        rise, back = self.family.sequence.rise, self.family.sequence.back
        rows = [(c, n, "W") for c, n in zip(rise, named(rise, RISE), strict=True)]
        if self.family.single_back:
            return [*rows, (back[0], "h4", "")]
        return rows + [(c, n, "R") for c, n in zip(back, named(back, RETURN) if back else (), strict=True)]

    # -- at one point -------------------------------------------------------------------------------------

    def measure(self, wish: Wish, t: float, x: Sequence[float] | np.ndarray) -> tuple[float, np.ndarray]:
        """What is asked and its derivatives by t, x1, ... (1 + numbers,)."""
        with np.errstate(all="ignore"):
            return self.of_values(wish, *self.equations.unguarded_slopes(t, x))

    def of_values(self, wish: Wish, values: np.ndarray, slopes: np.ndarray) -> tuple[float, np.ndarray]:
        """The same from all forms and their derivatives."""
        if wish.name == POINT:
            return self._level(wish.at, values, slopes)
        if wish.name == "acceleration":
            return max((self.bend(i, values, slopes) for i in range(len(self.family.bends))), key=lambda row: row[0])
        above, below = self._quotient(wish.name)
        if below < 0:
            return float(values[above]), slopes[above]
        value = values[above] / values[below]
        return float(value), (slopes[above] - value * slopes[below]) / values[below]

    def bend(self, i: int, values: np.ndarray, slopes: np.ndarray) -> tuple[float, np.ndarray]:
        """The largest acceleration of the i-th of the curves that may have the largest."""
        row = self.family.bends[i]
        s, h = self.equations.place_of(row.speed), self.equations.place_of(row.height)
        value = row.factor * values[s] ** 2 / values[h]
        return float(value), value * (2.0 * slopes[s] / values[s] - slopes[h] / values[h])

    def _quotient(self, name: str) -> tuple[int, int]:
        """Rows of what is divided by what, -1 for 1."""
        above, below = ratio(name, self.family)
        return self.equations.place_of(above), self.equations.place_of(below) if below else -1

    def _level(self, at: float, values: np.ndarray, slopes: np.ndarray) -> tuple[float, np.ndarray]:
        """Displacement above the lowest level at a share of the span."""
        none = np.zeros(slopes.shape[1])
        start, level = (0.0, none), (self._foot, none)
        for row in self.curves:
            (h, dh), (span, slope) = self.height_and_span(row, values, slopes)
            way = ELEMENTS[row[0]].way
            if at <= start[0] + span or row is self.curves[-1]:
                u = min(max((at - start[0]) / span, 0.0), 1.0)
                shape = law_of(row[0])(np.array([u]))[:2, 0]
                du = -(start[1] + u * slope) / span
                return float(level[0] + way * h * shape[0]), level[1] + way * (dh * shape[0] + h * shape[1] * du)
            start, level = (start[0] + span, start[1] + slope), (level[0] + way * h, level[1] + way * dh)
        raise AssertionError

    def height_and_span(
        self, curve: tuple[str, str, str], values: np.ndarray, slopes: np.ndarray
    ) -> tuple[tuple[float, np.ndarray], tuple[float, np.ndarray]]:
        """Of one of ``curves``, each with its derivatives."""
        name, height, speed = curve
        place = self.equations.place_of(height)
        h, dh = values[place], slopes[place]
        if not speed:
            up, w = self.equations.place_of("up"), self.equations.place_of("W")
            rise = values[up] / values[w]
            return (h, dh), (1.0 - rise, (rise * slopes[w] - slopes[up]) / values[w])
        s = self.equations.place_of(speed)
        span = SPEEDS[name] * h / values[s]
        return (h, dh), (span, (SPEEDS[name] * dh - span * slopes[s]) / values[s])

    def polished(
        self, wishes: Sequence[Wish], t: float, x: Sequence[float] | np.ndarray, enough: float = 0.0
    ) -> tuple[float, tuple[float, ...], bool]:
        """Newton's method on all wishes at once, while it gains and they are missed by more than is enough [``MET``]: the
        point and whether it meets them."""
        if not wishes or (enough and self._are_met(wishes, t, x, enough * MET)):
            return float(t), tuple(map(float, x)), True
        z = best = np.array([t, *x])
        least = np.inf
        with np.errstate(all="ignore"):
            for _ in range(STEPS):
                miss, slopes = self._missed(wishes, z)
                size = np.abs(z)
                # a number that is none makes every comparison false
                worst = float((np.abs(miss) / (MET + EPS * np.abs(slopes) @ size)).max())
                if not worst < 0.5 * least or not np.isfinite(slopes).all():
                    break
                best, least = z, worst
                if worst <= enough:
                    break
                z = z - np.linalg.lstsq(slopes * size, miss, rcond=1e-14)[0] * size
                if not z[0] > 0.0:
                    break
        return float(best[0]), tuple(float(v) for v in best[1:]), least <= 1.0

    def _are_met(self, wishes: Sequence[Wish], t: float, x: Sequence[float] | np.ndarray, share: float) -> bool:
        """Whether linear wishes are missed by less than a share of theirs; without derivatives, which rarely are needed."""
        if not all(w.linear for w in wishes):
            return False
        names = [name for w in wishes for name in ratio(w.name, self.family)]
        values = iter(self.equations.at(names, t, x))
        for wish, above, below in zip(wishes, values, values, strict=True):
            if not abs(above - wish.value * below) < share * (wish.value or 1.0) * abs(below):
                return False
        return True

    def is_alone(self, wishes: Sequence[Wish], t: float, x: Sequence[float]) -> bool:
        """Whether no other points that meet the wishes lie beside one."""
        z = np.array([t, *x])
        with np.errstate(all="ignore"):
            slopes = self._missed(wishes, z)[1] * np.abs(z)
        sizes = np.linalg.norm(slopes, axis=1)
        if not np.isfinite(slopes).all() or not (sizes > 0.0).all():
            return False
        return bool(np.linalg.svd(slopes / sizes[:, None], compute_uv=False)[-1] > ALONE)

    def _missed(self, wishes: Sequence[Wish], z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        values, slopes = self.equations.unguarded_slopes(z[0], z[1:])
        rows = [self.of_values(w, values, slopes) for w in wishes]
        sizes = np.array([1.0 if w.name == POINT else w.value or 1.0 for w in wishes])
        return (
            np.array([m - w.value for (m, _), w in zip(rows, wishes, strict=True)]) / sizes,
            np.array([g for _, g in rows]) / sizes[:, None],
        )

    def is_feasible(self, t: float, x: Sequence[float] | np.ndarray, least: float = 0.0) -> bool:
        """Whether every height is above 0, or above a share of the stroke; of constant velocity not below 0, but for
        rounding."""
        positive, constant = self.family.positive, self.family.constant
        terms = self.equations.terms((*positive, *constant), t, x)
        for row in terms[: len(positive)]:
            if not sum(row) > max(least, EPS * sum(map(abs, row))):
                return False
        return all(sum(row) >= -ROUNDING for row in terms[len(positive) :])

    # -- at many points -----------------------------------------------------------------------------------

    def many(self, wish: Wish, t: np.ndarray, x: np.ndarray) -> np.ndarray:
        """What is asked at t (n,) and x (numbers, n)."""
        checkpoint()
        values = self.equations.values(t, x)
        with np.errstate(all="ignore"):
            if wish.name == POINT:
                return self._levels(wish.at, values)
            if wish.name == "acceleration":
                return np.max(self.bends(values), axis=0)
            above, below = self._quotient(wish.name)
            return values[above] / values[below] if below >= 0 else values[above]

    def bends(self, values: np.ndarray) -> np.ndarray:
        """Largest accelerations (bends, n)."""
        place = self.equations.place_of
        rows = self.family.bends
        return np.array([b.factor * values[place(b.speed)] ** 2 / values[place(b.height)] for b in rows])

    def feasible(self, t: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Whether every height is above 0, of constant velocity not below (n,)."""
        values = self.equations.values(t, x)
        place = self.equations.place_of
        positive = [values[place(n)] > 0.0 for n in self.family.positive]
        return np.all([*positive, *(values[place(n)] >= 0.0 for n in self.family.constant)], axis=0)

    def parts(self, t: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Heights and spans of the curves (curves, n) each."""
        return self._parts(self.equations.values(t, x))

    def _parts(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        place = self.equations.place_of
        heights = np.array([values[place(height)] for _, height, _ in self.curves])
        with np.errstate(all="ignore"):
            spans = [
                SPEEDS[name] * h / values[place(speed)] if speed else 1.0 - values[place("up")] / values[place("W")]
                for (name, _, speed), h in zip(self.curves, heights, strict=True)
            ]
        return heights, np.array(spans)

    def _levels(self, at: float, values: np.ndarray) -> np.ndarray:
        start = np.zeros(values.shape[1])
        level = np.full(values.shape[1], self._foot)
        made = level.copy()
        for (curve, _, _), h, span in zip(self.curves, *self._parts(values), strict=True):
            way = ELEMENTS[curve].way
            u = np.where(span > 0.0, (at - start) / np.where(span > 0.0, span, 1.0), 1.0)
            reached = level + way * h * law_of(curve)(np.clip(np.nan_to_num(u), 0.0, 1.0))[0]
            made = np.where(at >= start, reached, made)
            start, level = start + span, level + way * h
        return made
