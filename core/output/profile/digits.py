"""Numbers in sentences that promise something: rounded to the side on which the promise stays true."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, floor, log10


def rounded_up(value: float, digits: int) -> float:
    """A positive number to so many digits, not below it; 0 stays."""
    return _rounded(value, digits, ceil)


def rounded_down(value: float, digits: int) -> float:
    """A positive number to so many digits, not above it; 0 stays."""
    return _rounded(value, digits, floor)


def _rounded(value: float, digits: int, side: Callable[[float], int]) -> float:
    if not value:
        return 0.0
    places = digits - 1 - floor(log10(value))
    return float(f"{side(value * 10.0**places)}e{-places}")


__all__ = ["rounded_down", "rounded_up"]
