"""Heights and speeds of a family as sums of terms c t^e x_j: polynomials in one number t, linear in all others."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from math import inf

import numpy as np

from core.blend.polynomials import Polynomial, shortened, whole

POWERS = (-2, -1, 0, 1, 2)
Form = np.ndarray
"""Coefficients of t^e x_j, e in ``POWERS``, x_0 = 1: (powers, 1 + numbers)."""
Row = tuple[Polynomial, ...]
"""An equation p0(t) + p1(t) x1 + ... = 0."""


def term(numbers: int, j: int = 0, e: int = 0) -> Form:
    """t^e x_j beside so many numbers."""
    form = np.zeros((len(POWERS), 1 + numbers))
    form[POWERS.index(e), j] = 1.0
    return form


def times_t(form: Form, powers: int) -> Form:
    """A form times t to so many powers, which stay within ``POWERS``."""
    return np.roll(form, powers, axis=0)


class Equations:
    """Forms by name, for a stroke of the rise and a span of 1.

    numbers    names of x_1, x_2, ...
    top, tops  t lies between 0 and top, x_j between 0 and tops[j - 1]
    """

    def __init__(self, forms: Mapping[str, Form], numbers: Sequence[str], top: float, tops: Sequence[float]) -> None:
        self.numbers, self.top, self.tops = tuple(numbers), top, tuple(tops)
        self.place = {name: i for i, name in enumerate(forms)}
        """Of each form its row in what ``evaluated`` returns."""
        with_one = {**forms, "": term(len(self.numbers))}
        self._terms = {
            name: [(float(form[i, j]), POWERS[i], int(j)) for i, j in np.argwhere(form)] for name, form in with_one.items()
        }
        self._raised = max(0, *(-e for terms in self._terms.values() for _, e, _ in terms))
        self._powers = np.array([e for e in POWERS if e >= -self._raised], dtype=float)
        self._tensor = np.array(list(forms.values()))[:, -self._powers.size :]

    # -- exactly ------------------------------------------------------------------------------------------

    @cached_property
    def _rows(self) -> Mapping[str, Row]:
        width, polynomials = len(self.numbers) + 1, []
        for terms in self._terms.values():
            rows = [[0] * len(POWERS) for _ in range(width)]
            for c, e, j in terms:
                rows[j][e + self._raised] += whole(c)
            polynomials += [Polynomial(row) for row in rows]
        short = shortened(polynomials)
        return {name: tuple(short[i * width :][:width]) for i, name in enumerate(self._terms)}

    def exact(self, name: str) -> Row:
        """A form, or 1 for an empty name, times a power of t: polynomials by 1, x_1, ..., all of them times the same."""
        return self._rows[name]

    # -- in floating point --------------------------------------------------------------------------------

    def terms(self, names: Iterable[str], t: float, x: Iterable[float]) -> list[list[float]]:
        """Forms, or 1 for an empty name, at one point, term by term. In plain floats: of so few terms quicker than arrays."""
        inverse = 1.0 / t if t else inf
        powers = (1.0, t, t * t, inverse * inverse, inverse)  # negative ones counted from the end
        with_one = (1.0, *x)
        return [[c * powers[e] * with_one[j] for c, e, j in self._terms[name]] for name in names]

    def at(self, names: Iterable[str], t: float, x: Iterable[float]) -> list[float]:
        """Forms, or 1 for an empty name, at one point."""
        return [sum(form) for form in self.terms(names, t, x)]

    def evaluated(self, t: np.ndarray, x: np.ndarray, slopes: bool = False) -> np.ndarray:
        """All forms at t (n,) and x (numbers, n): (forms, 1, n); with their derivatives by t, x_1, ... behind the value:
        (forms, 2 + numbers, n)."""
        with_one = np.concatenate((np.ones((1, t.size)), x))
        with np.errstate(all="ignore"):
            powers = t ** self._powers[:, None]
            columns = np.einsum("fej,en->fjn", self._tensor, powers)
            values = np.einsum("fjn,jn->fn", columns, with_one)[:, None]
            if not slopes:
                return values
            by_t = np.einsum("fej,en,jn->fn", self._tensor, self._powers[:, None] * powers / t, with_one)[:, None]
        return np.concatenate((values, by_t, columns[:, 1:]), axis=1)
