"""The value of one field nearest to the typed one with which a design fits together."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress

from core.design import Design, edited, entry_at
from core.errors import KindynaError
from core.numerics.lazy import checkpoint

FIRST, GROWTH, STEPS = 1e-3, 1.1, 146  # of the search on both sides of the value: up to a thousand times the value
CLOSE = 1e-7  # of the last interval, relative to the value
LEAST_DIGITS, MOST_DIGITS = 4, 8  # of the result


def nearest_fitting_value(
    design: Design, path: str, fits: Callable[[Design], bool], valid: float | None = None
) -> float | None:
    """Value of a field nearest to the present one with which a design fits together, rounded to the fitting side.

    Parameters
    ----------
    design : Design
        Values that do not fit together.
    path : str
        Path of a number.
    fits : callable
        Design -> whether its values fit together.
    valid : float, optional
        Value that did fit once, tried too.

    Returns
    -------
    float or None
        None where the field is no number, or no value fits.
    """
    entry = entry_at(design, path)
    if entry is None or not isinstance(entry.value, float):
        return None

    def is_fitting(number: float) -> bool:
        with suppress(KindynaError, KeyError):
            return entry.info.admits(number) and fits(edited(design, path, number))
        return False

    return nearest_fitting(entry.value, is_fitting, valid)


def nearest_fitting(value: float, fits: Callable[[float], bool], valid: float | None = None) -> float | None:
    """Fitting number nearest to a value that does not fit, rounded to the fitting side.

    Parameters
    ----------
    value : float
        It does not fit.
    fits : callable
        Number -> whether it fits.
    valid : float, optional
        Number that did fit once, tried too.

    Returns
    -------
    float or None
        None where the value is not finite, or no number fits.
    """
    if not math.isfinite(value):
        return None
    size = abs(value) or 1.0

    def is_fitting(number: float) -> bool:
        checkpoint()
        return fits(number)

    known = valid if valid is not None and is_fitting(valid) else None
    most = math.inf if known is None else abs(known - value)
    distances = [distance for k in range(STEPS) if (distance := size * FIRST * GROWTH**k) < most]
    for last, distance in zip([0.0, *distances], distances, strict=False):
        for side in (-1.0, 1.0):
            if is_fitting(value + side * distance):
                return _edge(value + side * last, value + side * distance, CLOSE * size, is_fitting)
    return None if known is None else _edge(value, known, CLOSE * size, is_fitting)


def _edge(outside: float, inside: float, close: float, fits: Callable[[float], bool]) -> float:
    """End of the fitting values between one that does not fit and one that does, with as few digits as fit."""
    start, side = outside, math.copysign(1.0, inside - outside)
    while abs(inside - outside) > close:
        middle = 0.5 * (outside + inside)
        if fits(middle):
            inside = middle
        else:
            outside = middle
    for digits in range(LEAST_DIGITS, MOST_DIGITS + 1):
        unit = 10.0 ** (math.floor(math.log10(abs(inside) or 1.0)) + 1 - digits)
        rounded = float(f"{math.ceil(side * inside / unit) * side * unit:.{digits}g}")
        if rounded != start and fits(rounded):
            return rounded
    return inside


__all__ = ["nearest_fitting", "nearest_fitting_value"]
