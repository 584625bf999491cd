"""Numbers and curves for display: thinned lines, samples over a turn, units and ticks, and plots in words."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Iterable, Mapping
from functools import lru_cache
from math import pi
from types import MappingProxyType

import numpy as np

from core.frozen import frozen
from core.motion import Angles
from core.number_text import RESULT_DIGITS, fixed_text, input_text, result_text, signed_text
from core.study import Study
from core.units import display_units
from kindyna_gui.settings import point, size_of, symbol_of

UNSEEN = 0.05  # error of a thinned line, pixels: invisible in an antialiased edge
PIECES = (64, 8, 4)  # numbers of points that one straight piece may replace, in the order of trial
PER_SCALE = 2.0  # a line thinned for one scale is used down to a scale so many times smaller
TURN = 2.0 * pi
NOTHING_DRAWN = "Nothing is drawn yet"  # description of an empty plot
ROUNDED_ZERO = 5e-13  # a smaller value is the rounding error of zero
MOST, FINEST = 1e5, 1e-3  # a peak outside these limits is shown with a power of ten in the unit

# -- thinned lines ---------------------------------------------------------------------------------------


def needed(points: np.ndarray, tolerance: float) -> np.ndarray:
    """Indices of the points that a thinned line needs.

    No omitted point is further than the tolerance from the straight piece that replaces it, so that extremes, corners
    and jumps remain. The first and the last point are needed, and both points at a gap.

    Parameters
    ----------
    points : ndarray (n,) complex
        Points x + iy of the line; NaN in gaps.
    tolerance : float
        In the unit of the points; 0 returns all indices.

    Returns
    -------
    ndarray (m,) of int, ascending
    """
    n = points.size
    if tolerance <= 0.0 or n < 3:
        return np.arange(n)
    is_needed = np.zeros(n, dtype=bool)
    is_needed[-1] = True
    starts = np.arange(0, n - 1, PIECES[0])
    for length, shorter in zip(PIECES, (*PIECES[1:], 1), strict=True):
        near = _near(points, starts, np.minimum(starts + length, n - 1), length, tolerance)
        is_needed[starts[near]] = True
        starts = (starts[~near, None] + np.arange(0, length, shorter)).ravel()
        starts = starts[starts < n - 1]
    is_needed[starts] = True
    return np.flatnonzero(is_needed)


def _near(points: np.ndarray, start: np.ndarray, end: np.ndarray, length: int, tolerance: float) -> np.ndarray:
    """Whether all points between two indices (b,) are near the straight line between them, (b,) of bool."""
    chord = points[end] - points[start]
    size = np.abs(chord)[:, None]
    inner = points[np.minimum(start[:, None] + np.arange(1, length), end[:, None])] - points[start, None]
    local = inner * chord.conj()[:, None]  # components along and across the line, times its length
    room = tolerance * size
    near = (np.abs(local.imag) <= room) & (local.real >= -room) & (np.abs(inner) <= size + tolerance)
    return np.asarray(near.all(axis=1))


def level(scale: float) -> float:
    """Scale that a line is thinned for: the next power of two from ``scale`` on.

    While a drawing is zoomed gradually its lines are thinned again only at these levels.
    """
    return float(PER_SCALE ** np.ceil(np.log2(scale)))


# -- samples over a turn ---------------------------------------------------------------------------------


@frozen(eq=False)
class TurnSamples:
    """Points of a curve over the turn.

    Attributes
    ----------
    angles : ndarray (m,) [deg]
    samples : ndarray (m,) of int, index of each point's sample; -1 in a gap
    """

    angles: np.ndarray
    samples: np.ndarray

    def of(self, values: np.ndarray, gain: float = 0.0) -> np.ndarray:
        """Values (m,) along the curve of samples (n,), NaN in gaps; they increase by ``gain`` in one turn."""
        along = np.where(self.samples < 0, np.nan, values[self.samples])
        return along + gain * (self.angles >= 360.0) if gain else along

    def alike(self, other: TurnSamples | None) -> bool:
        """Whether other samples have the same angles."""
        return other is self or (other is not None and np.array_equal(self.angles, other.angles))


def line_of(study: Study) -> TurnSamples:
    """Points of a study's curves, closed over the turn, with gaps where the mechanism has no position."""
    return _line_at(study.angles, study.samples)


@lru_cache(maxsize=8)  # most studies share their angles
def _line_at(at: Angles, samples_per_turn: int) -> TurnSamples:
    degrees, n = np.rad2deg(at.theta), at.theta.size
    if n == samples_per_turn:
        return TurnSamples(np.append(degrees, 360.0), np.append(np.arange(n), 0))
    cuts = np.flatnonzero(np.diff(degrees) > 1.5 * 360.0 / samples_per_turn) + 1
    angles, samples = degrees, np.arange(n)
    if n and degrees[0] == 0.0 and 360.0 - degrees[-1] < 1.5 * 360.0 / samples_per_turn:
        angles, samples = np.append(angles, 360.0), np.append(samples, 0)
    return TurnSamples(np.insert(angles, cuts, degrees[cuts]), np.insert(samples, cuts, -1))


def nearest(theta: np.ndarray, angle: float) -> int:
    """Index of the sample nearest to an angle [rad], across the end of the turn too; theta (n,) is ascending [rad]."""
    n = theta.size
    at = int(np.searchsorted(theta, angle))
    before, after = (at - 1) % n, at % n
    gaps = [abs((float(theta[i]) - angle + pi) % TURN - pi) for i in (before, after)]
    return before if gaps[0] < gaps[1] else after


# -- units and numbers -----------------------------------------------------------------------------------

_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@frozen
class DisplayUnit:
    """Unit that values are shown in.

    Attributes
    ----------
    symbol : of the unit
    size : in units of the channel
    least : least peak value, in this unit, for which it is used
    """

    symbol: str
    size: float
    least: float


@lru_cache(maxsize=128)
def _display_units(symbol: str) -> tuple[DisplayUnit, ...]:
    """Units in which values of this unit can be shown, the largest first."""
    return tuple(DisplayUnit(*row) for row in display_units(symbol))


def readable(symbol: str, peak: float) -> DisplayUnit:
    """Unit that shows values up to ``peak`` (in ``symbol``) without an exponent; the preferred one where there is one."""
    if (preferred := symbol_of(symbol)) != symbol:
        return DisplayUnit(preferred, size_of(symbol), 0.0)
    units = _display_units(symbol)
    if not 0.0 < peak < math.inf:
        return next((unit for unit in units if unit.size == 1.0), units[-1])
    unit = next((unit for unit in units if peak / unit.size >= unit.least), units[-1])
    shown = peak / unit.size
    if FINEST <= shown < MOST:
        return unit
    power = 3 * math.floor(math.log10(shown) / 3.0)
    factor = f"10{str(power).translate(_SUPERSCRIPT)}"
    return DisplayUnit(f"{factor} {unit.symbol}".rstrip(), unit.size * 10.0**power, 0.0)


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


def decimals_of(step: float) -> int:
    """Number of decimals that ticks with this step need."""
    return max(0, -math.floor(math.log10(step) + 1e-9))


def nice_below(value: float) -> float:
    """Largest of 1, 2, 5 times a power of ten up to ``value`` (> 0)."""
    power = 10.0 ** math.floor(math.log10(value))
    return power * max(step for step in (1.0, 2.0, 5.0) if step * power <= value * (1.0 + 1e-12))


def nice_step(span: float, most: int) -> float:
    """Smallest of 1, 2, 5 times a power of ten that divides ``span`` into at most ``most`` pieces."""
    least = span / max(1, most)
    power = 10.0 ** math.floor(math.log10(least))
    return power * next(step for step in (1.0, 2.0, 5.0, 10.0) if step * power >= least * (1.0 - 1e-12))


def ticks(low: float, high: float, most: int) -> tuple[list[float], float]:
    """Round values from ``low`` to ``high``, at least two, and their step."""
    for pieces in range(max(1, most), max(1, most) + 4):
        step = nice_step(high - low, pieces)
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
        if last > first:
            break
    return [step * i for i in range(first, last + 1)], step


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
