"""What part of a graph is shown: the range of each axis, as found from its curves, drawn with the mouse or stepped back to."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from core.frozen import frozen
from core.output.graph import GraphAxis, GraphData, ValueAxis, quantity_kind
from core.units import conversion_factor
from kindyna_gui.pictures.plots.plot import ANGLE_STEPS, LEAST_ACROSS, LEAST_VALUE_PIXELS, value_ticks
from kindyna_gui.pictures.units import MINUS, DisplayUnit, nice_step, number, readable, short
from kindyna_gui.settings import sized

FREE = 0.05  # of the range, left free above and below the curves
BESIDE = 0.08  # of the range of x, free on both sides of curves that go back
MOST_DECADES = 15.0  # below the largest value that a logarithmic axis shows by itself
TINY = 1e-12  # of an axis: no narrower range is shown
LARGEST = 1e290  # what an axis can reach
Ends = tuple[float, float]


@frozen
class Shown:
    """Ranges as they are drawn, powers of ten on logarithmic axes: of x, and of each axis of values in its rung."""

    x: Ends
    values: tuple[Ends, ...]


def rungs(found: GraphData) -> tuple[DisplayUnit, ...]:
    """The unit that each axis of values is read in without an exponent."""
    made = []
    for axis in found.axes:
        peaks = [float(np.nanmax(np.abs(found.series[i].y))) for i in axis.series]
        made.append(readable(axis.unit, 1.0 if axis.scale.log else max(peaks)))
    return tuple(made)


def scaled(values: np.ndarray, log: bool, size: float = 1.0) -> np.ndarray:
    """Values as they are drawn; nan where a logarithm has none."""
    if not log:
        return values / size if size != 1.0 else values
    with np.errstate(divide="ignore", invalid="ignore"):
        made = np.log10(values / size)
    return np.where(np.isfinite(made), made, np.nan)


def whole(found: GraphData, x: GraphAxis, sizes: Sequence[DisplayUnit]) -> Shown:
    """All that is typed, or is to be seen. Of values above and below something is left free, and beside curves that go back."""
    beside = BESIDE if any(not each.is_ordered for each in found.series) else 0.0
    across = _fitting([scaled(each.x, x.log) for each in found.series], x, 1.0, beside)
    if found.x_unit == "°" and not x.log and x.high is None and 350.0 < across[1] < 360.0:
        across = (across[0], 360.0)
    return Shown(across, tuple(_of(found, axis, rung) for axis, rung in zip(found.axes, sizes, strict=True)))


def is_outline(found: GraphData, x: GraphAxis) -> bool:
    """Whether lengths stand over lengths, and the curves go back: an outline, which wants one scale for both."""
    lengths = (
        quantity_kind(found.x_unit) == "length"
        and len(found.axes) == 1
        and quantity_kind(found.axes[0].unit) == "length"
    )
    scales = (x, found.axes[0].scale) if lengths else ()
    free = all(s.low is None and s.high is None and not s.log for s in scales)
    return lengths and free and any(not each.is_ordered for each in found.series)


def evenly(shown: Shown, found: GraphData, size: float, width: float, height: float) -> Shown:
    """The same and more, with one scale along both axes of an outline; size: of the rung of its values."""
    (ends,) = shown.values
    up = size * conversion_factor(found.axes[0].unit, found.x_unit)
    per = max((shown.x[1] - shown.x[0]) / width, up * (ends[1] - ends[0]) / height)
    return Shown(_about(shown.x, per * width), (_about(ends, per * height / up),))


def _about(ends: Ends, wide: float) -> Ends:
    middle = 0.5 * (ends[0] + ends[1])
    return middle - 0.5 * wide, middle + 0.5 * wide


def _of(found: GraphData, axis: ValueAxis, rung: DisplayUnit) -> Ends:
    return _fitting(
        [scaled(found.series[i].y, axis.scale.log, rung.size) for i in axis.series], axis.scale, rung.size, FREE
    )


def _fitting(parts: Sequence[np.ndarray], scale: GraphAxis, size: float, free: float) -> Ends:
    """Over all parts; a typed end stands where it is typed."""
    finite = [part[np.isfinite(part)] for part in parts]
    filled = [part for part in finite if part.size]
    low, high = (min(float(p.min()) for p in filled), max(float(p.max()) for p in filled)) if filled else (0.0, 1.0)
    if scale.log:
        low = max(low, high - MOST_DECADES)
    low, high = _apart(low, high)
    room = free * (high - low)
    low, high = low - room, high + room
    typed = [None if end is None or (scale.log and end <= 0.0) else end / size for end in (scale.low, scale.high)]
    logged = [None if end is None else math.log10(end) if scale.log else end for end in typed]
    low = low if logged[0] is None else logged[0]
    high = high if logged[1] is None else logged[1]
    return _apart(low, high if high > low else low)


def _apart(low: float, high: float) -> Ends:
    """Never without an extent."""
    if high - low > TINY * max(abs(low), abs(high), 1e-300):
        return low, high
    half = 0.5 * abs(low) or 0.5
    return low - half, high + half


def bounded(ends: Ends) -> Ends:
    """Numbers that can be drawn, whatever was typed."""
    low, high = (min(max(end, -LARGEST), LARGEST) for end in ends)
    return (low, high) if low < high else (0.0, 1.0)


def narrower(before: Ends, begin: float, end: float) -> Ends:
    """The part of a range between two of its fractions."""
    low, high = min(begin, end), max(begin, end)
    return _apart(before[0] + low * (before[1] - before[0]), before[0] + high * (before[1] - before[0]))


def about(before: Ends, at: float, factor: float) -> Ends:
    """A range so many times as wide, whose fraction ``at`` stays where it is."""
    middle, wide = before[0] + at * (before[1] - before[0]), factor * (before[1] - before[0])
    return _apart(middle - at * wide, middle + (1.0 - at) * wide)


def moved(before: Ends, by: float) -> Ends:
    """A range so many of its widths further."""
    step = by * (before[1] - before[0])
    return before[0] + step, before[1] + step


# -- ticks --------------------------------------------------------------------------------------------------


def ticks_of(
    ends: Ends, pixels: float, log: bool, degrees: bool = False, across: bool = False
) -> list[tuple[float, str]]:
    """Places, as drawn, and their texts; of degrees where a turn or a good part of it is shown at the usual steps."""
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
    """Powers of ten; between them 2 and 5 where there is room; round values where less than a power is shown."""
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
    return text.replace(MINUS, "-").replace("\u2009", "")


_UP = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def _power(factor: float, power: int) -> str:
    if -4 <= power <= 4:
        return short(factor * 10.0**power, 6)
    return f"10{str(power).translate(_UP)}" if factor == 1.0 else ""


__all__ = [
    "Ends",
    "Shown",
    "about",
    "bounded",
    "evenly",
    "is_outline",
    "moved",
    "narrower",
    "rungs",
    "scaled",
    "ticks_of",
    "whole",
]
