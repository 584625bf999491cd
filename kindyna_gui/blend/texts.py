"""Texts of the blend wizard: feasible ranges, the answer's figures, what it changes in the motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context
from math import isfinite

from core.blend import BlendResult, SettingRange
from core.design import UNITS, Motion
from core.output.lines import shortest
from core.output.texts import changed_beside, curve_rows, flat_rows
from kindyna_gui.labels import law_label
from kindyna_gui.pictures.units import MINUS, brief, measure, number, readable, short
from kindyna_gui.preferences.units import size_of

SAME = 1e-9  # a range narrower than this is one value
DIGITS = 6
UNASKED = "…"


def rounded(value: float, inwards: bool, down: bool = False) -> float:
    """A few digits; an end that is reached is rounded inwards, so that it can be typed, unless it misses a round number
    by no more than rounding."""
    nearest = float(Context(prec=DIGITS, rounding=ROUND_HALF_EVEN).create_decimal(value))
    if not inwards or abs(nearest - value) <= SAME * abs(value):
        return nearest
    return float(Context(prec=DIGITS, rounding=ROUND_FLOOR if down else ROUND_CEILING).create_decimal(value))


def _text(value: float) -> str:
    return shortest(value).replace("-", MINUS)


def is_one(ranges: Sequence[SettingRange]) -> bool:
    """Whether the ranges hold a single value."""
    low, high = (ranges[0].low, ranges[-1].high) if ranges else (0.0, 1.0)
    return isfinite(high) and high - low <= SAME * max(abs(low), abs(high))


def range_text(ranges: Sequence[SettingRange], name: str, size: float = 1.0) -> str:
    """``0 < h1 ≤ 19``, in a unit of this size; a text of its own where the other settings leave no value, or a single one."""
    if not ranges:
        return "nothing fits"
    ranges = [replace(each, low=each.low / size, high=each.high / size) for each in ranges]
    if is_one(ranges):
        return f"= {_text(rounded(ranges[0].low, False))}, given by the rest"
    return " or ".join(_interval_text(interval, name) for interval in ranges)


def _interval_text(interval: SettingRange, name: str) -> str:
    least = 0.0 if isfinite(interval.high) and abs(interval.low) <= SAME * abs(interval.high) else interval.low
    low = rounded(least, not interval.low_open)
    less, most = "<" if interval.low_open else "≤", "<" if interval.high_open else "≤"
    if not isfinite(interval.high):
        return f"{name} {'>' if interval.low_open else '≥'} {_text(low)}"
    return f"{_text(low)} {less} {name} {most} {_text(rounded(interval.high, not interval.high_open, down=True))}"


def begin_of(ranges: Sequence[SettingRange], share: float) -> float | None:
    """A round value inside the widest of the ranges, at about that share of it; None where there is none."""
    if not ranges:
        return None
    if is_one(ranges):
        return rounded(ranges[0].low, False)
    widest = max(ranges, key=lambda r: r.high - r.low)
    low, high = widest.low, widest.high
    if not isfinite(high):
        return rounded(low * 3.0 if low > 0.0 else 1.0, False)
    wanted = low + share * (high - low)
    for digits in (1, 2, 3, 6):
        value = float(Context(prec=digits, rounding=ROUND_HALF_EVEN).create_decimal(wanted))
        if low < value < high:
            return value
    return wanted


def reason(error: Exception) -> str:
    """Why there is no such motion; a small letter stays small, for h1 is a height and H1 a curve."""
    return str(error).replace(">=", "≥").replace("<=", "≤")


# -- the answer -------------------------------------------------------------------------------------------

HEADINGS = ("Curve", "Height {u}", "Span °", "From °", "To °", "From {u}", "To {u}")


def table(blended: BlendResult) -> list[tuple[str, ...]]:
    """Rows as Yang's Fig. 4 has them: curve, height, span, and where it starts and ends."""
    size = size_of(UNITS[blended.request.unit].symbol)
    return [
        (
            row.curve,
            number(abs(row.rise) / size, 4),
            *(number(value, 4) for value in (row.span, row.angle, row.angle + row.span)),
            *(number(value / size, 4) for value in (row.level, row.level + row.rise)),
        )
        for row in curve_rows(blended)
    ]


def figures(blended: BlendResult, rpm: float) -> list[str]:
    """Constant velocities and the largest acceleration, by cam angle and at the speed of the shaft."""
    unit, rate = UNITS[blended.request.unit].symbol, 6.0 * rpm  # degrees of cam angle in a second
    rows = []
    for segment in blended.segments:
        if segment.curve.law in ("cv1", "cv2"):
            speed = abs(segment.rise) / segment.span_deg
            shown = _at_speed(speed * rate, f"{unit}/s")
            rows.append(
                f"{segment.curve.law.upper()} runs at {brief(speed, f'{unit}/°')} ({shown}) for {short(segment.span_deg)}°"
            )
    for flat in flat_rows(blended):
        shown = _at_speed(flat.acceleration * rate**2, f"{unit}/s²")
        size = brief(flat.acceleration, f"{unit}/°²").replace("-", MINUS)
        rows.append(
            f"{flat.curve}: constant acceleration {size} ({shown}) over {short(flat.span)}° from {short(flat.angle)}°"
        )
    peak = blended.solution.peak_acceleration
    rows.append(
        f"Largest acceleration {brief(peak, f'{unit}/°²')} ({_at_speed(peak * rate**2, f'{unit}/s²')} at {short(rpm)} rpm)"
    )
    return rows


def _at_speed(value: float, symbol: str) -> str:
    rung = readable(symbol, value)
    return measure(value / rung.size, rung.symbol)


def effect(before: Motion, after: Motion, blended: BlendResult) -> str:
    """What else of the motion is changed by the blend, in a sentence."""
    if not any(s.rise and s not in blended.segments for s in after.segments):
        return "These curves and the dwells about them make the whole turn."
    if not any(s.rise for s in before.segments):
        return "Nothing else moves yet, so the same curves run backwards bring the follower back."
    changed = changed_beside(before, after, blended)
    if changed is None:
        return "The rest of the motion stays."
    n, segment = changed
    height = brief(round(segment.rise, 6), UNITS[after.unit].symbol, 10)
    return f"The rest stays, but segment {n}, {law_label(segment.curve.law)}, then rises by {height} to come back."


__all__ = [
    "HEADINGS",
    "UNASKED",
    "begin_of",
    "effect",
    "figures",
    "is_one",
    "range_text",
    "reason",
    "rounded",
    "table",
]
