"""Settings of the motions of a family at points (t, x1, ...), with their derivatives by these numbers.

Quantities are arrays (rows, n) for n points: the value, and below it, where derivatives are wanted, one row for each of
t, x1, ... Everything is for a stroke of the rise and a span of 1.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property

import numpy as np

from core.blend.equations import RETURN, RISE, SPEEDS, BlendTask, Family, SolutionSpace, named, solution_spaces
from core.blend.polynomials import UNIT, to_integer
from core.blend.request import POINT, SIZES, Constraint, height_of, ratio
from core.blend.sequences import ELEMENTS
from core.laws import LAWS, Law
from core.numerics.lazy import checkpoint

STEPS = 100
SHORTEST = 0.01  # part of a step
MET = 1e-11  # how well a constraint is met: share of its size ...
EPS = 16 * 2.0**-53  # ... or as well as the rounding of the numbers lets it
ALONE = 1e-11  # directions in which constraints grow that differ by less are the same
ROUNDING = 1e-13  # a height of constant velocity that misses 0 by less is 0
Place = tuple[float, tuple[float, ...]]
"""A point of a family: t and x1, x2, ..."""


def law_of(curve: str) -> Law:
    """The law of a curve of Yang's Table 1: ``C1`` -> row ``c1``. Raises KeyError for any other name."""
    return LAWS[curve.lower()]


class Evaluator:
    """The quantities of a family for the strokes of a task: settings, heights and spans at points (t, x1, ...)."""

    def __init__(self, family: Family, task: BlendTask) -> None:
        self.family, self.equations = family, family.equations(task)
        self._start_level = max(0.0, task.back / task.rise - 1.0) if family.sequence.back else 0.0

    @cached_property
    def curves(self) -> list[tuple[str, str, str]]:
        """Curve, name of its height, name of its speed; the one curve of a return has no speed."""
        rise, back = self.family.sequence.rise, self.family.sequence.back
        rows = [(c, n, "W") for c, n in zip(rise, named(rise, RISE), strict=True)]
        if self.family.single_back:
            return [*rows, (back[0], "h4", "")]
        return rows + [(c, n, "R") for c, n in zip(back, named(back, RETURN) if back else (), strict=True)]

    def spaces(self, constraints: Iterable[Constraint]) -> list[SolutionSpace]:
        """All points, feasible or not, that meet the linear ones among constraints, which become equations without any
        rounding: form - value · other form = 0."""
        rows = []
        for constraint in constraints:
            if constraint.linear:
                above, below = (self.equations.exact[name] for name in ratio(constraint.name, self.family))
                value = to_integer(constraint.value)
                rows.append(tuple([UNIT * a - value * b for a, b in zip(above, below, strict=True)]))
        return solution_spaces(self.equations, rows)

    # -- quantities ---------------------------------------------------------------------------------------

    def forms(self, t: np.ndarray, x: np.ndarray, slopes: bool = False) -> np.ndarray:
        """All forms of the family, which the quantities below are made of, at t (n,) and x (numbers, n)."""
        checkpoint()
        return self.equations.evaluate(t, x, slopes)

    def form(self, name: str, forms: np.ndarray) -> np.ndarray:
        """One quantity's form, out of the forms of all quantities (k, ...)."""
        return forms[self.equations.row_index[name]]

    @np.errstate(all="ignore")
    def setting(self, constraint: Constraint, forms: np.ndarray) -> np.ndarray:
        """What the setting of a constraint is; nan or infinite where it does not exist."""
        if constraint.name == POINT:
            return self._level(constraint.at, forms)
        if constraint.name == "acceleration":
            rows = np.array([self.acceleration(i, forms) for i in range(len(self.family.accelerations))])
            return np.take_along_axis(rows, np.argmax(rows[:, :1], axis=0)[None], axis=0)[0]
        if constraint.name in SIZES:
            return self.acceleration(self.family.acceleration_of(height_of(constraint.name)), forms)
        above, below = ratio(constraint.name, self.family)
        value = self.form(above, forms)
        return quotient(value, self.form(below, forms)) if below else value

    def missed(self, constraint: Constraint, forms: np.ndarray) -> np.ndarray:
        """By how much a constraint is missed, as a share of its size."""
        return (self.setting(constraint, forms) - constant(constraint.value, forms)) / constraint.size

    def values(self, constraint: Constraint, t: np.ndarray, x: np.ndarray) -> np.ndarray:
        """The same alone (n,) at t (n,) and x (numbers, n)."""
        return self.setting(constraint, self.forms(t, x))[0]

    def value_at(self, constraint: Constraint, place: Place) -> float:
        """The same at one point."""
        z = column(place)
        return float(self.values(constraint, z[0], z[1:])[0])

    def acceleration(self, i: int, forms: np.ndarray) -> np.ndarray:
        """factor S²/h of the i-th of the curves that may have the largest acceleration."""
        row = self.family.accelerations[i]
        speed = self.form(row.speed, forms)
        return row.factor * quotient(product(speed, speed), self.form(row.height, forms))

    def height_and_span(self, curve: tuple[str, str, str], forms: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Of one of ``curves``: span = c h/S, of a single one what the rise leaves."""
        name, height, speed = curve
        h = self.form(height, forms)
        if speed:
            return h, SPEEDS[name] * quotient(h, self.form(speed, forms))
        span = -quotient(self.form("up", forms), self.form("W", forms))
        span[0] += 1.0
        return h, span

    def _level(self, at: float, forms: np.ndarray) -> np.ndarray:
        """Displacement above the lowest level at a share of the span: on the first curve that reaches there."""
        start, level, result = (np.zeros_like(forms[0]) for _ in range(3))
        level[0] = self._start_level
        waiting = np.ones(forms.shape[2], dtype=bool)
        for curve in self.curves:
            height, span = self.height_and_span(curve, forms)
            sign = ELEMENTS[curve[0]].velocity_sign
            here = waiting & (at <= start[0] + span[0]) if curve is not self.curves[-1] else waiting
            if here.any():
                h, b, begin = height[:, here], span[:, here], start[:, here]
                u = np.clip((at - begin[0]) / b[0], 0.0, 1.0)
                s, slope = law_of(curve[0])(np.where(np.isfinite(u), u, 0.0))[:2]
                rise = h * s - h[0] * slope * (begin + u * b) / b[0]
                rise[0] = h[0] * s
                result[:, here] = level[:, here] + sign * rise
                waiting &= ~here
            start, level = start + span, level + sign * height
        return result

    # -- constraints --------------------------------------------------------------------------------------

    def at(self, names: Sequence[str], place: Place) -> list[float]:
        """Forms at one point."""
        z = column(place)
        forms = self.equations.evaluate(z[0], z[1:])
        return [float(forms[self.equations.row_index[name], 0, 0]) for name in names]

    def is_feasible(self, place: Place, least: float = 0.0) -> bool:
        """Whether every height is above 0, or above a share of the stroke; of constant velocity not below 0, but for
        rounding."""
        above, above_or_zero = (self.at(names, place) for names in (self.family.positive, self.family.constant))
        return all(h > max(least, EPS) for h in above) and all(h >= -ROUNDING for h in above_or_zero)

    def solved(self, constraints: Sequence[Constraint], place: Place) -> tuple[Place, bool]:
        """The point nearby that meets all constraints, and whether it does."""
        if not constraints:
            return place, True
        z, met = self.solved_at_all(constraints, column(place))
        return (float(z[0, 0]), tuple([float(v) for v in z[1:, 0]])), bool(met[0])

    def solved_at_all(self, constraints: Sequence[Constraint], z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Newton's method on all constraints at once from points (1 + numbers, n), the least step where they leave some
        freedom, shortened where it does not gain: the points and whether they meet them (n,)."""
        best, step = z.copy(), np.zeros_like(z)
        least, part = np.full(z.shape[1], np.inf), np.ones(z.shape[1])
        going = np.arange(z.shape[1])
        with np.errstate(all="ignore"):
            for _ in range(STEPS):
                trial = (best * (1.0 - part * step))[:, going]
                miss, slopes = self._slopes(constraints, trial)
                worst = (np.abs(miss) / (MET + EPS * np.abs(slopes).sum(axis=2))).max(axis=1)
                better = np.isfinite(slopes).all(axis=(1, 2)) & (trial[0] > 0.0)
                better &= worst < (1.0 - 0.5 * part[going]) * least[going]
                gained = going[better]
                if gained.size:
                    best[:, gained], least[gained] = trial[:, better], worst[better]
                    step[:, gained] = np.einsum("nzc,nc->zn", np.linalg.pinv(slopes[better], rcond=1e-14), miss[better])
                part[going] = np.where(better, 1.0, 0.5 * part[going])
                going = going[better | ((least[going] > 1.0) & (part[going] > SHORTEST) & np.isfinite(least[going]))]
                if not going.size:
                    break
        return best, least <= 1.0

    def are_independent(self, constraints: Sequence[Constraint], z: np.ndarray) -> np.ndarray:
        """Whether no other points that meet the constraints lie beside points (1 + numbers, n), as many constraints as free
        numbers (n,)."""
        with np.errstate(all="ignore"):
            slopes = self._slopes(constraints, z)[1]
            slopes = slopes / np.linalg.norm(slopes, axis=2, keepdims=True)
        known = np.isfinite(slopes).all(axis=(1, 2))
        result = np.linalg.svd(np.where(known[:, None, None], slopes, 0.0), compute_uv=False)[:, -1]
        return known & (result > ALONE)

    def _slopes(self, constraints: Sequence[Constraint], z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """By how much constraints are missed at points (1 + numbers, n), as a share of their size (n, constraints), and how
        that grows with a share of each number (n, constraints, 1 + numbers)."""
        forms = self.forms(z[0], z[1:], slopes=True)
        rows = np.array([self.missed(c, forms) for c in constraints])
        return rows[:, 0].T, (rows[:, 1:] * np.abs(z)).transpose(2, 0, 1)


def column(place: Place) -> np.ndarray:
    """A point as an array (1 + numbers, 1)."""
    return np.array([[place[0]], *([v] for v in place[1])])


def constant(value: float, forms: np.ndarray) -> np.ndarray:
    """A constant as a quantity (rows, 1) beside forms: its derivatives are 0."""
    return value * np.eye(forms.shape[1], 1)


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Of two quantities, with its derivatives."""
    made = a * b[0] + b * a[0]
    made[0] = a[0] * b[0]
    return made


def quotient(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a/b of two quantities, with its derivatives."""
    value = a[0] / b[0]
    made = (a - value * b) / b[0]
    made[0] = value
    return made


def logarithm(quantity: np.ndarray) -> np.ndarray:
    """Of a quantity, with its derivatives."""
    made = quantity / quantity[0]
    made[0] = np.log(quantity[0])
    return made
