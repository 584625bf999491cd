"""Arithmetic of which the rounding is known: sums and squares in two parts, high + low."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

F = TypeVar("F", float, np.ndarray)
_SPLITTER = 134217729.0  # 2^27 + 1: halves of a float's digits (Veltkamp)


def two_sum(a: F, b: F) -> tuple[F, F]:
    """a + b rounded, and what rounding took (Knuth)."""
    total = a + b
    part = total - a
    rest = b - part
    part -= total
    part += a
    rest += part
    return total, rest


def _square(a: F) -> tuple[F, F]:
    """a² rounded, and what rounding took (Dekker)."""
    high = _SPLITTER * a
    high -= high - a
    low = a - high
    square = a * a
    rest = high * high
    rest -= square
    high *= 2.0 * low
    rest += high
    low *= low
    rest += low
    return square, rest


def square_of(high: F, low: F) -> tuple[F, F]:
    """(high + low)² for a small ``low``."""
    square, rest = _square(high)
    return square, rest + 2.0 * high * low


def squares_of(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """x² + y² (n,)."""
    (x2, x_rest), (y2, y_rest) = _square(x), _square(y)
    square, rest = two_sum(x2, y2)
    rest += x_rest + y_rest
    return square, rest
