"""Settings of the motions of a family at points (t, x1, ...), with their derivatives by these variables.

Quantities are arrays (rows, n) for n points: the value and, where derivatives are requested, one row for each of
t, x1, .... Everything is for a stroke of the rise and a span of 1, and so dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property, lru_cache
from types import MappingProxyType

import numpy as np

from core.blend.equations import RETURN, RISE, SPEEDS, BlendTask, Family, SolutionSpace, named, solution_spaces
from core.blend.polynomials import UNIT, to_integer
from core.blend.request import POINT, SIZES, Constraint, height_of, ratio
from core.blend.sequences import ELEMENTS
from core.laws import LAWS, Law, peaks
from core.numerics.lazy import checkpoint

STEPS = 100
SHORTEST = 0.01  # shortest fraction of a Newton step
MET = 1e-11  # residual of a satisfied constraint relative to its size
EPS = 16 * 2.0**-53  # rounding of the variables, which is added to it
INDEPENDENT = 1e-11  # least singular value of independent constraints
ROUNDING = 1e-13  # a smaller height of constant velocity is 0
Point = tuple[float, tuple[float, ...]]
"""A point of a family: t and (x1, x2, ...)."""


def law_of(curve: str) -> Law:
    """Law of a curve of Yang's Table 1, ``C1`` -> row ``c1``. Raises KeyError for any other name."""
    return LAWS[curve.lower()]


GOALS: Mapping[str, tuple[str, int, int]] = MappingProxyType(
    {"acceleration": ("ca", 1, 2), "jerk": ("cj", 1, 3), "torque": ("cm", 2, 3)}
)
"""Largest |a| [per deg²], |jerk| inside the curves [per deg³], and |v a|, which is proportional to the inertia torque.

Each with the peak coefficient c of a curve, and the powers i, k of height and span: c h^i / β^k.
"""


@lru_cache(maxsize=64)
def peak_coefficient(curve: str, coefficient: str) -> float:
    """Peak coefficient of a curve, ``ca``, ``cj`` or ``cm``."""
    return float(getattr(peaks(law_of(curve)), coefficient))


class Evaluator:
    """Settings, heights and spans of a family at points (t, x1, ...), for the strokes of a task."""

    def __init__(self, family: Family, task: BlendTask) -> None:
        self.family, self.equations = family, family.equations(task)
        self._start_level = max(0.0, task.back / task.rise - 1.0) if family.sequence.back else 0.0

    @cached_property
    def curves(self) -> list[tuple[str, str, str]]:
        """Curve, name of its height, name of its speed form; the single curve of a return has no speed."""
        rise, back = self.family.sequence.rise, self.family.sequence.back
        rows = [(c, height, "W") for c, height in zip(rise, named(rise, RISE), strict=True)]
        if self.family.single_back:
            return [*rows, (back[0], "h4", "")]
        return rows + [(c, height, "R") for c, height in zip(back, named(back, RETURN) if back else (), strict=True)]

    def spaces(self, constraints: Iterable[Constraint]) -> list[SolutionSpace]:
        """All points, feasible or not, that satisfy the linear ones among the constraints.

        These become exact equations: numerator - value · denominator = 0.
        """
        rows = []
        for constraint in constraints:
            if constraint.linear:
                numerator, denominator = (self.equations.exact[name] for name in ratio(constraint.name, self.family))
                value = to_integer(constraint.value)
                rows.append(tuple([UNIT * a - value * b for a, b in zip(numerator, denominator, strict=True)]))
        return solution_spaces(self.equations, rows)

    # -- quantities ---------------------------------------------------------------------------------------

    def forms(self, t: np.ndarray, x: np.ndarray, slopes: bool = False) -> np.ndarray:
        """Values of all forms of the family.

        Parameters
        ----------
        t : ndarray (n,), dimensionless
        x : ndarray (numbers, n), dimensionless
        slopes : bool
            Also compute the derivatives by t, x1, ....

        Returns
        -------
        ndarray (forms, 1, n) or (forms, 2 + numbers, n), dimensionless
        """
        checkpoint()
        return self.equations.evaluate(t, x, slopes)

    def form(self, name: str, forms: np.ndarray) -> np.ndarray:
        """Value of one form.

        Parameters
        ----------
        name : str
        forms : ndarray (forms, rows, n), dimensionless
            Values of `forms`.

        Returns
        -------
        ndarray (rows, n), dimensionless
        """
        return forms[self.equations.row_index[name]]

    @np.errstate(all="ignore")
    def setting(self, constraint: Constraint, forms: np.ndarray) -> np.ndarray:
        """Value of the setting of a constraint; NaN or infinite where it does not exist.

        Parameters
        ----------
        constraint : Constraint
        forms : ndarray (forms, rows, n), dimensionless
            Values of `forms`.

        Returns
        -------
        ndarray (rows, n), dimensionless
        """
        if constraint.name == POINT:
            return self._level(constraint.at, forms)
        if constraint.name == "acceleration":
            rows = np.array([self.acceleration(i, forms) for i in range(len(self.family.accelerations))])
            return np.take_along_axis(rows, np.argmax(rows[:, :1], axis=0)[None], axis=0)[0]
        if constraint.name in SIZES:
            return self.acceleration(self.family.acceleration_of(height_of(constraint.name)), forms)
        numerator, denominator = ratio(constraint.name, self.family)
        value = self.form(numerator, forms)
        return quotient(value, self.form(denominator, forms)) if denominator else value

    def residual(self, constraint: Constraint, forms: np.ndarray) -> np.ndarray:
        """Residual of a constraint relative to its size.

        Parameters
        ----------
        constraint : Constraint
        forms : ndarray (forms, rows, n), dimensionless
            Values of `forms`.

        Returns
        -------
        ndarray (rows, n), dimensionless
        """
        return (self.setting(constraint, forms) - constant(constraint.value, forms)) / constraint.size

    def values(self, constraint: Constraint, t: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Value of the setting of a constraint, without derivatives.

        Parameters
        ----------
        constraint : Constraint
        t : ndarray (n,), dimensionless
        x : ndarray (numbers, n), dimensionless

        Returns
        -------
        ndarray (n,), dimensionless
        """
        return self.setting(constraint, self.forms(t, x))[0]

    def value_at(self, constraint: Constraint, point: Point) -> float:
        """Value of the setting of a constraint at one point."""
        z = column(point)
        return float(self.values(constraint, z[0], z[1:])[0])

    def acceleration(self, i: int, forms: np.ndarray) -> np.ndarray:
        """Acceleration factor S²/h of the i-th of the curves that may have the largest one.

        Parameters
        ----------
        i : int
        forms : ndarray (forms, rows, n), dimensionless
            Values of `forms`.

        Returns
        -------
        ndarray (rows, n), dimensionless
        """
        row = self.family.accelerations[i]
        speed = self.form(row.speed, forms)
        return row.factor * quotient(product(speed, speed), self.form(row.height, forms))

    def height_and_span(self, curve: tuple[str, str, str], forms: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Height and span of one of ``curves``: span = c h/S, of a single curve the remainder of the span.

        Parameters
        ----------
        curve : tuple of str
            Row of ``curves``.
        forms : ndarray (forms, rows, n), dimensionless
            Values of `forms`.

        Returns
        -------
        height, span : ndarray (rows, n), dimensionless
        """
        name, height, speed = curve
        h = self.form(height, forms)
        if speed:
            return h, SPEEDS[name] * quotient(h, self.form(speed, forms))
        span = -quotient(self.form("up", forms), self.form("W", forms))
        span[0] += 1.0
        return h, span

    def _level(self, at: float, forms: np.ndarray) -> np.ndarray:
        """Displacement above the lowest level at a fraction of the span, on the first curve that reaches it."""
        start, level, result = (np.zeros_like(forms[0]) for _ in range(3))
        level[0] = self._start_level
        waiting = np.ones(forms.shape[2], dtype=bool)
        for curve in self.curves:
            height, span = self.height_and_span(curve, forms)
            sign = ELEMENTS[curve[0]].velocity_sign
            on_curve = waiting & (at <= start[0] + span[0]) if curve is not self.curves[-1] else waiting
            if on_curve.any():
                h, b, begin = height[:, on_curve], span[:, on_curve], start[:, on_curve]
                u = np.clip((at - begin[0]) / b[0], 0.0, 1.0)
                s, slope = law_of(curve[0])(np.where(np.isfinite(u), u, 0.0))[:2]
                rise = h * s - h[0] * slope * (begin + u * b) / b[0]
                rise[0] = h[0] * s
                result[:, on_curve] = level[:, on_curve] + sign * rise
                waiting &= ~on_curve
            start, level = start + span, level + sign * height
        return result

    # -- constraints --------------------------------------------------------------------------------------

    def at(self, names: Sequence[str], point: Point) -> list[float]:
        """Values of forms at one point."""
        z = column(point)
        forms = self.equations.evaluate(z[0], z[1:])
        return [float(forms[self.equations.row_index[name], 0, 0]) for name in names]

    def is_feasible(self, point: Point, least: float = 0.0) -> bool:
        """Whether every height is positive, or above a fraction of the stroke; constant velocities may be 0."""
        above, above_or_zero = (self.at(names, point) for names in (self.family.positive, self.family.constant))
        return all(h > max(least, EPS) for h in above) and all(h >= -ROUNDING for h in above_or_zero)

    def solve(self, constraints: Sequence[Constraint], point: Point) -> tuple[Point, bool]:
        """Nearby point that satisfies all constraints, and whether it does."""
        if not constraints:
            return point, True
        z, is_met = self.solve_all(constraints, column(point))
        return (float(z[0, 0]), tuple([float(v) for v in z[1:, 0]])), bool(is_met[0])

    def solve_all(self, constraints: Sequence[Constraint], z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Damped Newton's method for all constraints from many points; of several solutions of a step the shortest.

        Parameters
        ----------
        constraints : sequence of Constraint
        z : ndarray (1 + numbers, n), dimensionless
            Points t, x1, ... from which to start.

        Returns
        -------
        points : ndarray (1 + numbers, n), dimensionless
        is_met : ndarray (n,), dimensionless
            Whether each point satisfies the constraints.
        """
        best, step = z.copy(), np.zeros_like(z)
        least, fraction = np.full(z.shape[1], np.inf), np.ones(z.shape[1])
        active = np.arange(z.shape[1])
        with np.errstate(all="ignore"):
            for _ in range(STEPS):
                trial = (best * (1.0 - fraction * step))[:, active]
                residuals, slopes = self._slopes(constraints, trial)
                error = (np.abs(residuals) / (MET + EPS * np.abs(slopes).sum(axis=2))).max(axis=1)
                is_better = np.isfinite(slopes).all(axis=(1, 2)) & (trial[0] > 0.0)
                is_better &= error < (1.0 - 0.5 * fraction[active]) * least[active]
                gained = active[is_better]
                if gained.size:
                    best[:, gained], least[gained] = trial[:, is_better], error[is_better]
                    step[:, gained] = np.einsum(
                        "nzc,nc->zn", np.linalg.pinv(slopes[is_better], rcond=1e-14), residuals[is_better]
                    )
                fraction[active] = np.where(is_better, 1.0, 0.5 * fraction[active])
                active = active[
                    is_better | ((least[active] > 1.0) & (fraction[active] > SHORTEST) & np.isfinite(least[active]))
                ]
                if not active.size:
                    break
        return best, least <= 1.0

    def are_independent(self, constraints: Sequence[Constraint], z: np.ndarray) -> np.ndarray:
        """Whether points are isolated solutions of as many constraints as free variables.

        Parameters
        ----------
        constraints : sequence of Constraint
        z : ndarray (1 + numbers, n), dimensionless
            Points t, x1, ....

        Returns
        -------
        ndarray (n,), dimensionless
        """
        with np.errstate(all="ignore"):
            slopes = self._slopes(constraints, z)[1]
            slopes = slopes / np.linalg.norm(slopes, axis=2, keepdims=True)
        is_finite = np.isfinite(slopes).all(axis=(1, 2))
        least = np.linalg.svd(np.where(is_finite[:, None, None], slopes, 0.0), compute_uv=False)[:, -1]
        return is_finite & (least > INDEPENDENT)

    def _slopes(self, constraints: Sequence[Constraint], z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residuals (n, constraints), and derivatives by relative changes (n, constraints, 1 + numbers)."""
        forms = self.forms(z[0], z[1:], slopes=True)
        rows = np.array([self.residual(c, forms) for c in constraints])
        return rows[:, 0].T, (rows[:, 1:] * np.abs(z)).transpose(2, 0, 1)


def column(point: Point) -> np.ndarray:
    """A point as an array.

    Parameters
    ----------
    point : Point

    Returns
    -------
    ndarray (1 + numbers, 1), dimensionless
    """
    return np.array([[point[0]], *([v] for v in point[1])])


def constant(value: float, forms: np.ndarray) -> np.ndarray:
    """A constant as a quantity, whose derivatives are 0.

    Parameters
    ----------
    value : float
    forms : ndarray (forms, rows, n), dimensionless
        Forms with as many rows.

    Returns
    -------
    ndarray (rows, 1), dimensionless
    """
    return value * np.eye(forms.shape[1], 1)


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Product of two quantities with its derivatives.

    Parameters
    ----------
    a, b : ndarray (rows, n), dimensionless

    Returns
    -------
    ndarray (rows, n), dimensionless
    """
    result = a * b[0] + b * a[0]
    result[0] = a[0] * b[0]
    return result


def quotient(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Quotient a/b of two quantities with its derivatives.

    Parameters
    ----------
    a, b : ndarray (rows, n), dimensionless

    Returns
    -------
    ndarray (rows, n), dimensionless
    """
    value = a[0] / b[0]
    result = (a - value * b) / b[0]
    result[0] = value
    return result


def logarithm(quantity: np.ndarray) -> np.ndarray:
    """Natural logarithm of a quantity with its derivatives.

    Parameters
    ----------
    quantity : ndarray (rows, n), dimensionless

    Returns
    -------
    ndarray (rows, n), dimensionless
    """
    result = quantity / quantity[0]
    result[0] = np.log(quantity[0])
    return result
