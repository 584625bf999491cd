"""A family's equations as sums of terms c t^e x_j: polynomials in one number t, linear in all others."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf

import numpy as np

from core.blend.polynomials import Exact, shortened, trimmed, whole

Row = tuple[Exact, ...]
"""An equation p0(t) + p1(t) x1 + ... = 0."""


@dataclass(frozen=True)
class Form:
    """Sum of c t^e x_j; terms {(j, e): c}, x_0 = 1."""

    terms: Mapping[tuple[int, int], float]

    def __add__(self, other: Form | float) -> Form:
        made = dict(self.terms)
        for key, c in _form(other).terms.items():
            made[key] = made.get(key, 0.0) + c
        return Form({k: c for k, c in made.items() if c != 0.0})

    def __mul__(self, factor: float) -> Form:
        return Form({k: factor * c for k, c in self.terms.items()})

    def __sub__(self, other: Form | float) -> Form:
        return self + _form(other) * -1.0

    def __rsub__(self, other: float) -> Form:
        return _form(other) + self * -1.0

    def by_t(self, power: int = 1) -> Form:
        """Times t^power."""
        return Form({(j, e + power): c for (j, e), c in self.terms.items()})


def number(j: int) -> Form:
    """x_j, or 1 for j = 0."""
    return Form({(j, 0): 1.0})


def power(e: int) -> Form:
    """t^e."""
    return Form({(0, e): 1.0})


def constant(value: float) -> Form:
    return Form({(0, 0): value} if value != 0.0 else {})


def _powers(t: float) -> tuple[float, ...]:
    """1, t, t² and, counted from the end, 1/t, 1/t²: products, which unlike powers may become infinite."""
    inverse = 1.0 / t if t else inf
    return 1.0, t, t * t, inverse * inverse, inverse


def _form(value: Form | float) -> Form:
    return value if isinstance(value, Form) else constant(value)


@dataclass(frozen=True)
class Equations:
    """forms of all that can be measured, for a stroke of the rise and a span of 1.

    numbers  names of x_1, x_2, ...; bounds: t lies between 0 and ``top``, x_j between 0 and ``tops``
    """

    forms: Mapping[str, Form]
    numbers: tuple[str, ...]
    top: float
    tops: tuple[float, ...]

    @cached_property
    def _index(self) -> Mapping[str, int]:
        return {name: i for i, name in enumerate(self.forms)}

    def place_of(self, name: str) -> int:
        """Its row in what ``values`` returns."""
        return self._index[name]

    @cached_property
    def _with_one(self) -> Mapping[str, Form]:
        """The forms, and 1 under an empty name."""
        return {**self.forms, "": power(0)}

    @cached_property
    def raised(self) -> int:
        """The power of t that makes polynomials of all forms."""
        return max(0, *(-e for f in self.forms.values() for _, e in f.terms))

    @cached_property
    def _rows(self) -> Mapping[str, Row]:
        rows = [self._row(form) for form in self._with_one.values()]
        short, width = shortened(p for row in rows for p in row), len(self.numbers) + 1
        return {name: short[i * width :][:width] for i, name in enumerate(self._with_one)}

    def exact(self, name: str) -> Row:
        """A form, or 1 for an empty name, times t^raised: polynomials by x_0, x_1, ... in whole numbers, all
        of them times the same one."""
        return self._rows[name]

    def _row(self, form: Form) -> Row:
        rows = [[0] * (self.raised + 8) for _ in range(len(self.numbers) + 1)]
        for (j, e), c in form.terms.items():
            rows[j][e + self.raised] += whole(c)
        return tuple(trimmed(r) for r in rows)

    @cached_property
    def _exponents(self) -> np.ndarray:
        return np.array(sorted({e for f in self.forms.values() for _, e in f.terms} | {0}), dtype=float)

    @cached_property
    def _tensor(self) -> np.ndarray:
        """Coefficients (exponents, forms, 1 + numbers)."""
        exponents = list(self._exponents)
        made = np.zeros((len(exponents), len(self.forms), len(self.numbers) + 1))
        for i, form in enumerate(self.forms.values()):
            for (j, e), c in form.terms.items():
                made[exponents.index(e), i, j] = c
        return made

    @cached_property
    def _matrix(self) -> np.ndarray:
        """The tensor as a matrix over the exponents."""
        return self._tensor.reshape(len(self._exponents), -1)

    def values(self, t: np.ndarray, x: np.ndarray) -> np.ndarray:
        """All forms (forms, n) at t (n,) and x (numbers, n)."""
        with_one = np.concatenate((np.ones((1, t.size)), x))
        with np.errstate(all="ignore"):
            powers = t[None, :] ** self._exponents[:, None]
            return np.einsum("en,ekn->kn", powers, self._tensor @ with_one)

    @cached_property
    def _terms(self) -> Mapping[str, list[tuple[float, int, int]]]:
        return {name: [(c, e, j) for (j, e), c in form.terms.items()] for name, form in self._with_one.items()}

    def terms(self, names: Iterable[str], t: float, x: Iterable[float]) -> list[list[float]]:
        """Forms, or 1 for an empty name, at one point, term by term. In plain floats: of so few terms quicker than arrays."""
        powers, with_one = _powers(float(t)), (1.0, *map(float, x))
        return [[c * powers[e] * with_one[j] for c, e, j in self._terms[name]] for name in names]

    def at(self, names: Iterable[str], t: float, x: Iterable[float]) -> list[float]:
        """Forms, or 1 for an empty name, at one point."""
        return [sum(form) for form in self.terms(names, t, x)]

    def columns(self, t: float) -> np.ndarray:
        """All forms by 1, x1, x2, ... at t (forms, 1 + numbers)."""
        return (t**self._exponents @ self._matrix).reshape(len(self.forms), -1)

    def slopes(self, t: float, x: Sequence[float] | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """All forms (forms,) at one point, and their derivatives by t, x1, x2, ... (forms, 1 + numbers)."""
        with np.errstate(all="ignore"):
            return self.unguarded_slopes(t, x)

    def unguarded_slopes(self, t: float, x: Sequence[float] | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The same where floating-point errors are seen to already."""
        with_one = np.array([1.0, *x])
        powers = t**self._exponents
        columns = (powers @ self._matrix).reshape(len(self.forms), -1)
        by_t = ((self._exponents * powers / t) @ self._matrix).reshape(len(self.forms), -1)
        values = columns @ with_one
        columns[:, 0] = by_t @ with_one
        return values, columns
