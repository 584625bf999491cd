"""Readable units, samples, detail."""

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
from core.study import Study
from core.units import display_units
from kindyna_gui.settings import point, size_of, symbol_of

# -- detail ----------------------------------------------------------------------------------------------

UNSEEN = 0.05  # pixels by which a line may be off: next to nothing of what antialiasing makes of an edge
PIECES = (64, 8, 4)  # points that one piece of line may stand for, tried in turn
PER_SCALE = 2.0  # a line thinned for one scale serves others up to so many times smaller


def needed(points: np.ndarray, tolerance: float) -> np.ndarray:
    """Indices (m,), ascending, of those points of a line through ``points`` (n,) complex that have to be kept.

    No point left out lies further than ``tolerance`` from the straight piece that takes its place, so that extremes,
    corners and jumps stay; the first and the last point are kept, all where the tolerance is 0, and all that stand
    beside a gap (NaN).
    """
    n = points.size
    if tolerance <= 0.0 or n < 3:
        return np.arange(n)
    kept = np.zeros(n, dtype=bool)
    kept[-1] = True
    starts = np.arange(0, n - 1, PIECES[0])
    for length, shorter in zip(PIECES, (*PIECES[1:], 1), strict=True):
        near = _near(points, starts, np.minimum(starts + length, n - 1), length, tolerance)
        kept[starts[near]] = True
        starts = (starts[~near, None] + np.arange(0, length, shorter)).ravel()
        starts = starts[starts < n - 1]
    kept[starts] = True
    return np.flatnonzero(kept)


def _near(points: np.ndarray, start: np.ndarray, end: np.ndarray, length: int, tolerance: float) -> np.ndarray:
    """Whether all points between start and end (b,), indices, stand near the straight line between the two (b,)."""
    chord = points[end] - points[start]
    size = np.abs(chord)[:, None]
    inner = points[np.minimum(start[:, None] + np.arange(1, length), end[:, None])] - points[start, None]
    turned = inner * chord.conj()[:, None]  # along the line and beside it, times its length
    room = tolerance * size
    near = (np.abs(turned.imag) <= room) & (turned.real >= -room) & (np.abs(inner) <= size + tolerance)
    return np.asarray(near.all(axis=1))


def level(scale: float) -> float:
    """The scale a line is thinned for where it is drawn at ``scale``: the next power of two from it on, so that a
    picture that is zoomed little by little is not thinned anew each time."""
    return float(PER_SCALE ** np.ceil(np.log2(scale)))


# -- turn ------------------------------------------------------------------------------------------------

TURN = 2.0 * pi


@frozen(eq=False)
class TurnSamples:
    """The points of a curve over the turn: angles (m,) [deg] and the sample of each (m,); -1 is a gap."""

    angles: np.ndarray
    samples: np.ndarray

    def of(self, values: np.ndarray, gain: float = 0.0) -> np.ndarray:
        """Values (n,) along the curve (m,), NaN in gaps; gain: what they grow by in a turn."""
        found = np.where(self.samples < 0, np.nan, values[self.samples])
        return found + gain * (self.angles >= 360.0) if gain else found

    def alike(self, other: TurnSamples | None) -> bool:
        """Whether others stand at the same angles."""
        return other is not None and np.array_equal(self.angles, other.angles)


def line_of(study: Study) -> TurnSamples:
    """Closed over the whole turn; with gaps where the mechanism cannot stand."""
    degrees, n = np.rad2deg(study.theta), study.theta.size
    if n == study.samples:
        return TurnSamples(np.append(degrees, 360.0), np.append(np.arange(n), 0))
    cuts = np.flatnonzero(np.diff(degrees) > 1.5 * 360.0 / study.samples) + 1
    angles, samples = degrees, np.arange(n)
    if n and degrees[0] == 0.0 and 360.0 - degrees[-1] < 1.5 * 360.0 / study.samples:
        angles, samples = np.append(angles, 360.0), np.append(samples, 0)
    return TurnSamples(np.insert(angles, cuts, degrees[cuts]), np.insert(samples, cuts, -1))


def nearest(theta: np.ndarray, angle: float) -> int:
    """The sample (of n angles in rising order [rad]) that is nearest to an angle, round the turn."""
    n = theta.size
    at = int(np.searchsorted(theta, angle))
    before, after = (at - 1) % n, at % n
    gaps = [abs((float(theta[i]) - angle + pi) % TURN - pi) for i in (before, after)]
    return before if gaps[0] < gaps[1] else after


# -- units -----------------------------------------------------------------------------------------------

NOTHING_DRAWN = "Nothing is drawn yet"  # in the words for a plot
MINUS, THIN_SPACE = "\u2212", "\u2009"
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@frozen
class DisplayUnit:
    """A unit to show values in: its symbol, how many of the channel's own unit it is, and the peak value, counted in
    itself, from which it serves."""

    symbol: str
    size: float
    least: float


@lru_cache(maxsize=128)
def _rungs(symbol: str) -> tuple[DisplayUnit, ...]:
    """Those that values in this unit may be shown in, coarsest first."""
    return tuple(DisplayUnit(*each) for each in display_units(symbol))


MOST, FINEST = 1e5, 1e-3  # a peak outside of these takes a power of ten into the unit


def readable(symbol: str, peak: float) -> DisplayUnit:
    """The unit in which values of size ``peak`` (in ``symbol``) are read without an exponent; the one that the user prefers."""
    if (preferred := symbol_of(symbol)) != symbol:
        return DisplayUnit(preferred, size_of(symbol), 0.0)
    rungs = _rungs(symbol)
    if not 0.0 < peak < math.inf:
        return next((rung for rung in rungs if rung.size == 1.0), rungs[-1])
    rung = next((rung for rung in rungs if peak / rung.size >= rung.least), rungs[-1])
    shown = peak / rung.size
    if FINEST <= shown < MOST:
        return rung
    power = 3 * math.floor(math.log10(shown) / 3.0)
    ten = f"10{str(power).translate(_SUPERSCRIPT)}"
    return DisplayUnit(f"{ten} {rung.symbol}".rstrip(), rung.size * 10.0**power, 0.0)


_DOTS: Mapping[str, str] = MappingProxyType({"\u0307": "", "\u0308": "²", "\u20db": "³"})
_DOTTED = re.compile(f"(.)([{''.join(_DOTS)}])(²?)")


def _derivative(match: re.Match[str]) -> str:
    letter, dots, power = match[1], match[2], match[3]
    text = f"d{_DOTS[dots]}{letter}/dt{_DOTS[dots]}"
    return f"({text}){power}" if power else text


def legible(text: str) -> str:
    """A formula with those derivatives written out whose dots fonts lose: over all letters that have no sign of their own with them."""
    return _DOTTED.sub(_derivative, unicodedata.normalize("NFC", text))


def number(value: float, decimals: int) -> str:
    """Fixed decimals, thin spaces between thousands from five digits on, never minus zero."""
    text = f"{abs(value):.{max(0, decimals)}f}"
    whole, _, rest = text.partition(".")
    if len(whole) > 4:
        whole = f"{int(whole):,}".replace(",", THIN_SPACE)
    text = f"{whole}.{rest}" if rest else whole
    if value < 0.0 and text.strip(f"0.{THIN_SPACE}"):
        text = MINUS + text
    return text.replace(".", point())


def digits(value: float, most: int = 4) -> str:
    """A value with so many significant digits."""
    if not math.isfinite(value):
        return "∞" if value > 0.0 else f"{MINUS}∞" if value < 0.0 else "none"
    if value == 0.0:
        return "0"
    size = math.floor(math.log10(abs(value)))
    text = number(value, min(most - 1 - size, 12))
    return text if text.strip("0.,") else "0"  # what rounding leaves of a zero


def short(value: float, most: int = 6) -> str:
    """A value with at most so many significant digits and no needless zeros."""
    text = digits(value, most)
    return text.rstrip("0").rstrip(point()) if point() in text else text


def measure(value: float, symbol: str, most: int = 4) -> str:
    """A value with its unit, in the one that the user prefers; no space before a degree sign."""
    return with_unit(digits(value / size_of(symbol), most), symbol_of(symbol))


def brief(value: float, symbol: str, most: int = 6) -> str:
    """As ``measure``, without needless zeros."""
    return with_unit(short(value / size_of(symbol), most), symbol_of(symbol))


def with_unit(text: str, symbol: str) -> str:
    """No space before a degree sign."""
    return f"{text}{'' if symbol == '°' else ' '}{symbol}".rstrip()


def decimals_of(step: float) -> int:
    """Decimals that a scale of this step needs."""
    return max(0, -math.floor(math.log10(step) + 1e-9))


def nice_below(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above ``value`` (> 0)."""
    power = 10.0 ** math.floor(math.log10(value))
    return power * max(step for step in (1.0, 2.0, 5.0) if step * power <= value * (1.0 + 1e-12))


def nice_step(span: float, most: int) -> float:
    """The smallest of 1, 2, 5 times a power of ten that cuts ``span`` into at most ``most`` pieces."""
    least = span / max(1, most)
    power = 10.0 ** math.floor(math.log10(least))
    return power * next(step for step in (1.0, 2.0, 5.0, 10.0) if step * power >= least * (1.0 - 1e-12))


def ticks(low: float, high: float, most: int) -> tuple[list[float], float]:
    """Round values from ``low`` to ``high`` and their step; two at least."""
    for pieces in range(max(1, most), max(1, most) + 4):
        step = nice_step(high - low, pieces)
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
        if last > first:
            break
    return [step * i for i in range(first, last + 1)], step


# -- for who hears a plot rather than sees it ----------------------------------------------------------------


def curve_words(name: str, unit: str, low: float, high: float, at: float, at_unit: str) -> str:
    """One curve: from where to where it goes, and where it is largest."""
    reach = with_unit(f"{digits(low)} to {digits(high)}", unit)
    named = f"{name}, " if name else ""
    return f"{named}{reach}" + ("" if low == high else f", largest at {with_unit(digits(at), at_unit)}")


def ends_of(x: np.ndarray, y: np.ndarray) -> tuple[float, float, float] | None:
    """Lowest and highest value, and where the largest without its sign stands; None where nothing is finite."""
    known = np.isfinite(x) & np.isfinite(y)
    if not known.any():
        return None
    there, values = x[known], y[known]
    return float(values.min()), float(values.max()), float(there[int(np.abs(values).argmax())])


def lines_words(lines: Iterable[tuple[str, np.ndarray, np.ndarray]], across: str, upwards: str) -> str:
    """Several curves on axes with these titles, each (name, x, y)."""
    (_, _, at_unit), (quantity, _, unit) = across.rpartition(", "), upwards.rpartition(", ")
    rows = []
    for name, x, y in lines:
        ends = ends_of(x, y)
        if ends is not None:
            own = name[:1].lower() + name[1:] if name else quantity[:1].lower() + quantity[1:]
            rows.append(curve_words(own, unit if quantity else "", *ends, at_unit))
    return "; ".join(rows)
