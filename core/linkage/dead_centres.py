"""Where arm and rod lie in line, and the triangle between them by its distance from there."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Context, Decimal
from functools import lru_cache

import numpy as np

_DIGITS = Context(prec=160)  # holds the squares of floats exactly


@dataclass(frozen=True)
class Square:
    """The square of a slider's place on its guide [m²], and its root to twice the digits of a float: root + rest.
    A square below 0 has none: the slider never comes there."""

    value: float
    root: float
    rest: float

    def less(self, slider: np.ndarray) -> np.ndarray:
        """The square less that of ``slider`` (n,) [m²], to a few eps of itself however small it is."""
        if self.value <= 0.0:
            return self.value - slider * slider
        far = np.abs(slider)
        return ((self.root - far) + self.rest) * (self.root + far)


def _square(value: Decimal) -> Square:
    if value <= 0:
        return Square(float(value), 0.0, 0.0)
    exact = _DIGITS.sqrt(value)
    root = float(exact)
    return Square(float(value), root, float(_DIGITS.subtract(exact, Decimal(root))))


@dataclass(frozen=True)
class DeadCentres:
    """Arm and rod in one line: the slider stands at ±stretched one behind the other, at ±folded one upon the other."""

    stretched: Square
    folded: Square

    def area4(self, slider: np.ndarray) -> np.ndarray:
        """K = 4 x area of the triangle pivot, arm pin, slider pin (n,) [m²], 0 in line, NaN where there is none.

        K² = [(L1+L2)² - r²][r² - (L1-L2)²] with r² = L² + H²: the brackets are stretched² - L² and L² - folded². Kahan's
        formula without r, whose rounding alone would cost S/K eps of K near a dead centre; here it is 4 eps anywhere.
        """
        with np.errstate(invalid="ignore"):
            return np.sqrt(-self.stretched.less(slider) * self.folded.less(slider))


@lru_cache(maxsize=64)
def dead_centres(arm: float, rod: float, height: float) -> DeadCentres:
    """For arm L1, rod L2 and the guide's height H above the pivot [m]."""
    if not all(map(math.isfinite, (arm, rod, height))):
        return DeadCentres(Square(-math.inf, 0.0, 0.0), Square(math.inf, 0.0, 0.0))
    l1, l2, h = Decimal(arm), Decimal(rod), Decimal(height)
    both, difference, high = (
        _DIGITS.multiply(side, side) for side in (_DIGITS.add(l1, l2), _DIGITS.subtract(l1, l2), h)
    )
    return DeadCentres(_square(_DIGITS.subtract(both, high)), _square(_DIGITS.subtract(difference, high)))
