"""Arithmetic of which the rounding is known."""

from __future__ import annotations


def two_sum(a: float, b: float) -> tuple[float, float]:
    """a + b rounded, and what rounding took (Knuth)."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)
