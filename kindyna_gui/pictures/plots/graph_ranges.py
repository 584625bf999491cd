"""Ranges of a graph's axes: from its curves or from typed ends, zoomed and shifted; and the ticks of an axis."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from core.frozen import frozen
from core.number_text import MINUS, NARROW_SPACE
from core.output.drawing.scales import DisplayUnit, nice_step
from core.output.graph import GraphAxis, GraphData, ValueAxis, quantity_kind
from kindyna_gui.pictures.plots.plot import ANGLE_STEPS, LEAST_ACROSS, LEAST_VALUE_PIXELS, Ends, value_ticks
from kindyna_gui.pictures.units import number, readable, short
from kindyna_gui.settings import sized

FREE = 0.05  # of the range, left free above and below the curves
FREE_ACROSS = 0.08  # of the range of x, left free on both sides of curves whose x is not ordered
MOST_DECADES = 15.0  # below the largest value that a logarithmic axis shows without typed ends
TINY = 1e-12  # of the values of an axis: no narrower range is shown
LARGEST = 1e290  # end of an axis that can still be drawn

# -- ranges -------------------------------------------------------------------------------------------------


@frozen
class GraphRange:
    """Ranges of a graph's axes; of a logarithmic axis the powers of ten.

    Attributes
    ----------
    x : ends of the x axis
    values : ends of each axis of values, in its display unit
    """

    x: Ends
    values: tuple[Ends, ...]


def axis_units(data: GraphData) -> tuple[DisplayUnit, ...]:
    """Display unit of each axis of values, in which its values need no exponent."""
    units = []
    for axis in data.axes:
        peaks = [float(np.nanmax(np.abs(data.series[i].y))) for i in axis.series]
        units.append(readable(axis.unit, 1.0 if axis.scale.log else max(peaks)))
    return tuple(units)


def scaled(values: np.ndarray, log: bool, size: float = 1.0) -> np.ndarray:
    """Coordinates (n,) at which values (n,) are drawn; NaN where a logarithm is not defined."""
    if not log:
        return values / size if size != 1.0 else values
    with np.errstate(divide="ignore", invalid="ignore"):
        powers = np.log10(values / size)
    return np.where(np.isfinite(powers), powers, np.nan)


def full_range(data: GraphData, x: GraphAxis, units: Sequence[DisplayUnit]) -> GraphRange:
    """Range of all curves with some room around them; a typed end takes precedence."""
    free = FREE_ACROSS if any(not series.is_ordered for series in data.series) else 0.0
    across = _fitting([scaled(series.x, x.log) for series in data.series], x, 1.0, free)
    if data.x_unit == "°" and not x.log and x.high is None and 350.0 < across[1] < 360.0:
        across = (across[0], 360.0)
    return GraphRange(
        across, tuple(_values_range(data, axis, unit) for axis, unit in zip(data.axes, units, strict=True))
    )


def is_outline(data: GraphData, x: GraphAxis) -> bool:
    """Whether the graph is an outline, lengths over lengths, which needs the same scale on both axes."""
    lengths = (
        quantity_kind(data.x_unit) == "length" and len(data.axes) == 1 and quantity_kind(data.axes[0].unit) == "length"
    )
    scales = (x, data.axes[0].scale) if lengths else ()
    is_free = all(s.low is None and s.high is None and not s.log for s in scales)
    return lengths and is_free and any(not series.is_ordered for series in data.series)


def _values_range(data: GraphData, axis: ValueAxis, unit: DisplayUnit) -> Ends:
    return _fitting(
        [scaled(data.series[i].y, axis.scale.log, unit.size) for i in axis.series], axis.scale, unit.size, FREE
    )


def _fitting(parts: Sequence[np.ndarray], scale: GraphAxis, size: float, free: float) -> Ends:
    """Range of all parts with free room; a typed end replaces its end."""
    finite = [part[np.isfinite(part)] for part in parts]
    filled = [part for part in finite if part.size]
    low, high = (min(float(p.min()) for p in filled), max(float(p.max()) for p in filled)) if filled else (0.0, 1.0)
    if scale.log:
        low = max(low, high - MOST_DECADES)
    low, high = _with_extent(low, high)
    room = free * (high - low)
    low, high = low - room, high + room
    typed = [None if end is None or (scale.log and end <= 0.0) else end / size for end in (scale.low, scale.high)]
    logged = [None if end is None else math.log10(end) if scale.log else end for end in typed]
    low = low if logged[0] is None else logged[0]
    high = high if logged[1] is None else logged[1]
    return _with_extent(low, high if high > low else low)


def _with_extent(low: float, high: float) -> Ends:
    """Widen a range without extent."""
    if high - low > TINY * max(abs(low), abs(high), 1e-300):
        return low, high
    half = 0.5 * abs(low) or 0.5
    return low - half, high + half


def bounded(ends: Ends) -> Ends:
    """Restrict a typed range to numbers that can be drawn."""
    low, high = (min(max(end, -LARGEST), LARGEST) for end in ends)
    return (low, high) if low < high else (0.0, 1.0)


def narrowed(before: Ends, begin: float, end: float) -> Ends:
    """Part of a range between two of its fractions."""
    low, high = min(begin, end), max(begin, end)
    return _with_extent(before[0] + low * (before[1] - before[0]), before[0] + high * (before[1] - before[0]))


def zoomed(before: Ends, at: float, factor: float) -> Ends:
    """Range ``factor`` times as wide, in which the fraction ``at`` keeps its value."""
    fixed, width = before[0] + at * (before[1] - before[0]), factor * (before[1] - before[0])
    return _with_extent(fixed - at * width, fixed + (1.0 - at) * width)


def shifted(before: Ends, fraction: float) -> Ends:
    """Range shifted by a fraction of its width."""
    step = fraction * (before[1] - before[0])
    return before[0] + step, before[1] + step


# -- ticks --------------------------------------------------------------------------------------------------


def ticks_of(
    ends: Ends, pixels: float, log: bool, degrees: bool = False, across: bool = False
) -> list[tuple[float, str]]:
    """Ticks of an axis: coordinates and texts.

    Angles have steps of 15°, 30°, 60° ... where 60° to 720° are shown.
    """
    least = LEAST_ACROSS if across else LEAST_VALUE_PIXELS
    if log:
        return _powers(ends, pixels, least)
    if degrees and 60.0 <= ends[1] - ends[0] <= 720.0:
        step = next(
            (s for s in (15, *ANGLE_STEPS) if pixels * s / (ends[1] - ends[0]) >= sized(least)), ANGLE_STEPS[-1]
        )
        first = math.ceil(ends[0] / step - 1e-9)
        return [(float(step * i), number(step * i, 0)) for i in range(first, math.floor(ends[1] / step + 1e-9) + 1)]
    return value_ticks(*ends, pixels, least)


def _powers(ends: Ends, pixels: float, least: float) -> list[tuple[float, str]]:
    """Ticks at powers of ten, with 2 and 5 between them where there is room; at round values of a narrow range."""
    low, high = ends
    if high - low < 0.7 and high < 300.0:
        values = value_ticks(10.0**low, 10.0**high, pixels, least)
        return [(math.log10(float(_plain(text))), text) for at, text in values if at > 0.0]
    step = max(1, math.ceil(nice_step(high - low, max(2, int(pixels / sized(least)))) - 1e-9))
    rows = []
    for power in range(math.floor(low) - 1, math.ceil(high) + 1):
        if power % step == 0:
            factors = (1.0, 2.0, 5.0) if step == 1 and pixels / (high - low) > 3.0 * least else (1.0,)
            rows += [(power + math.log10(f), _power(f, power)) for f in factors]
    return [(at, text) for at, text in rows if low - 1e-9 <= at <= high + 1e-9]


def _plain(text: str) -> str:
    return text.replace(MINUS, "-").replace(NARROW_SPACE, "")


_UP = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def _power(factor: float, power: int) -> str:
    if -4 <= power <= 4:
        return short(factor * 10.0**power, 6)
    return f"10{str(power).translate(_UP)}" if factor == 1.0 else ""


__all__ = [
    "Ends",
    "GraphRange",
    "axis_units",
    "bounded",
    "full_range",
    "is_outline",
    "narrowed",
    "scaled",
    "shifted",
    "ticks_of",
    "zoomed",
]
