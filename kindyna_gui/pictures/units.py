"""Numbers and curves for display: preferred units, nearest samples, and plots in words."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Mapping
from math import pi
from types import MappingProxyType

import numpy as np

from core.number_text import RESULT_DIGITS, fixed_text, input_text, result_text, signed_text
from core.output.drawing.scales import DisplayUnit, readable_unit
from kindyna_gui.settings import point, size_of, symbol_of

PER_SCALE = 2.0  # a line thinned for one scale is used down to a scale so many times smaller
TURN = 2.0 * pi
NOTHING_DRAWN = "Nothing is drawn yet"  # description of an empty plot
ROUNDED_ZERO = 5e-13  # a smaller value is the rounding error of zero


def level(scale: float) -> float:
    """Scale that a line is thinned for: the next power of two from ``scale`` on.

    While a drawing is zoomed gradually its lines are thinned again only at these levels.
    """
    return float(PER_SCALE ** np.ceil(np.log2(scale)))


def nearest(theta: np.ndarray, angle: float) -> int:
    """Index of the sample nearest to an angle [rad], across the end of the turn too; theta (n,) is ascending [rad]."""
    n = theta.size
    at = int(np.searchsorted(theta, angle))
    before, after = (at - 1) % n, at % n
    gaps = [abs((float(theta[i]) - angle + pi) % TURN - pi) for i in (before, after)]
    return before if gaps[0] < gaps[1] else after


# -- units and numbers -----------------------------------------------------------------------------------


def readable(symbol: str, peak: float) -> DisplayUnit:
    """Unit that shows values up to ``peak`` (in ``symbol``) without an exponent; the preferred one where there is one."""
    if (preferred := symbol_of(symbol)) != symbol:
        return DisplayUnit(preferred, size_of(symbol), 0.0)
    return readable_unit(symbol, peak)


_DOTS: Mapping[str, str] = MappingProxyType({"\u0307": "", "\u0308": "²", "\u20db": "³"})
_DOTTED = re.compile(f"(.)([{''.join(_DOTS)}])(²?)")


def _derivative(match: re.Match[str]) -> str:
    symbol, dots, power = match[1], match[2], match[3]
    text = f"d{_DOTS[dots]}{symbol}/dt{_DOTS[dots]}"
    return f"({text}){power}" if power else text


def legible(text: str) -> str:
    """Write out the derivatives of a formula whose dots are combining characters, which some fonts lose."""
    return _DOTTED.sub(_derivative, unicodedata.normalize("NFC", text))


def number(value: float, decimals: int) -> str:
    """Value with fixed decimals, and never minus zero."""
    return fixed_text(value, decimals).replace(".", point())


def digits(value: float, most: int = RESULT_DIGITS) -> str:
    """Value with ``most`` significant digits, for columns and readings that change."""
    return _shown(value, most, padded=True)


def short(value: float, most: int = RESULT_DIGITS) -> str:
    """Value with at most ``most`` significant digits, without trailing zeros."""
    return _shown(value, most, padded=False)


def _shown(value: float, most: int, padded: bool) -> str:
    value = 0.0 if abs(value) < ROUNDED_ZERO else value
    return result_text(value, most, padded).replace(".", point())


def signed(value: float, most: int = RESULT_DIGITS) -> str:
    """Difference with its sign."""
    return signed_text(value, most).replace(".", point())


def typed(value: float) -> str:
    """Input with all its digits."""
    return input_text(value).replace(".", point())


def measure(value: float, symbol: str, most: int = RESULT_DIGITS) -> str:
    """Value with its unit, in the preferred unit; no space before a degree sign."""
    return with_unit(digits(value / size_of(symbol), most), symbol_of(symbol))


def brief(value: float, symbol: str, most: int = RESULT_DIGITS) -> str:
    """Value with its unit, in the preferred unit, without trailing zeros."""
    return with_unit(short(value / size_of(symbol), most), symbol_of(symbol))


def readable_text(value: float, symbol: str, most: int = RESULT_DIGITS) -> str:
    """Value in the unit in which it needs no exponent, with at most ``most`` significant digits."""
    unit = readable(symbol, abs(value))
    return with_unit(short(value / unit.size, most), unit.symbol)


def with_unit(text: str, symbol: str) -> str:
    """Append a unit to a number; no space before a degree sign."""
    return f"{text}{'' if symbol == '°' else ' '}{symbol}".rstrip()


# -- plots in words, for screen readers ----------------------------------------------------------------------


def curve_words(name: str, unit: str, low: float, high: float, at: float, at_unit: str) -> str:
    """A curve in words: its range, and the position of its largest value."""
    text = f"{name}, " if name else ""
    text += with_unit(f"{digits(low)} to {digits(high)}", unit)
    return text + ("" if low == high else f", largest at {with_unit(digits(at), at_unit)}")


def lines_words(lines: Iterable[tuple[str, np.ndarray, np.ndarray]], across: str, upwards: str) -> str:
    """Curves in words, each (name, x (n,), y (n,)), on axes with these titles; curves without finite values are omitted."""
    (_, _, at_unit), (quantity, _, unit) = across.rpartition(", "), upwards.rpartition(", ")
    rows = []
    for name, x, y in lines:
        known = np.isfinite(x) & np.isfinite(y)
        if known.any():
            values, label = y[known], name or quantity
            ends = float(values.min()), float(values.max()), float(x[known][int(np.abs(values).argmax())])
            rows.append(curve_words(label[:1].lower() + label[1:], unit if quantity else "", *ends, at_unit))
    return "; ".join(rows)
