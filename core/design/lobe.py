"""The two sides of a lobe, from its typed values in cam and crank degrees, and its faults."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass, replace
from functools import lru_cache
from typing import Any

from core.design.engine import CRANK_PER_CAM, Lobe, LobeClosing
from core.design.fields import info_of
from core.errors import MISSING, DesignError, Fault
from core.frozen import frozen
from core.laws.lobe import (
    ACCELERATION,
    HEIGHT,
    NOSE_ACCELERATION,
    VELOCITY,
    Condition,
    NoLobe,
    Side,
    SideForm,
    solve_side,
)
from core.number_text import result_text, rounded_down, rounded_up

# -- sides ------------------------------------------------------------------------------------------------------


@frozen
class TypedValue:
    """A typed value of a side: its path in the lobe, the condition, and crank degrees per degree from the nose (else 1)."""

    path: str
    value: float
    condition: Condition
    factor: float = 1.0

    @property
    def unit(self) -> str:
        """Unit of the value, in a text."""
        return {HEIGHT: "deg", VELOCITY: "mm/deg"}.get(self.condition.kind, "mm/deg2")


_SCALARS = (
    ("velocity_mm_per_deg", VELOCITY),
    ("acceleration_mm_per_deg2", ACCELERATION),
    ("nose_acceleration_mm_per_deg2", NOSE_ACCELERATION),
)
_ROWS = (("duration", 2.0 * CRANK_PER_CAM), ("to_nose", CRANK_PER_CAM))


def typed_values(part: Any, prefix: str = "") -> list[TypedValue]:
    """Typed values of a side: rows by their lift, then the others in the order of the file."""
    rows = [
        TypedValue(f"{prefix}{key}[{i}]", row.crank_deg, Condition(HEIGHT, row.crank_deg / factor, row.at_mm), factor)
        for key, factor in _ROWS
        for i, row in enumerate(getattr(part, key, ()))
    ]
    scalars = [
        TypedValue(f"{prefix}{key}", value, Condition(kind, value))
        for key, kind in _SCALARS
        if (value := getattr(part, key, None)) is not None
    ]
    return [*sorted(rows, key=lambda row: row.condition.height), *scalars]


def _form(lobe: Lobe, room: float) -> SideForm:
    return SideForm(
        lobe.lift_mm,
        lobe.ramp_mm,
        lobe.ramp_mm_per_deg,
        lobe.ramp_runup_deg,
        lobe.flank_flat,
        lobe.nose_flat,
        room,
    )


def _closing_lobe(lobe: Lobe) -> Lobe:
    """The lobe with ramp and flats of its closing side."""
    closing = lobe.closing or LobeClosing()
    names = [field.name for field in fields(LobeClosing) if field.name != "to_nose"]
    values: dict[str, Any] = {name: v for name in names if (v := getattr(closing, name)) is not None}
    return replace(lobe, **values)


def _last_of_closing(lobe: Lobe) -> TypedValue:
    """The value that the closing side has together with the acceleration of the nose: its own, else that of the opening side."""
    closing = typed_values(lobe.closing, "closing.")
    opening = [value for value in typed_values(lobe) if value.condition.kind != NOSE_ACCELERATION]
    rows = [value for value in opening if value.condition.kind == HEIGHT]
    return (closing or rows[-1:] or opening[-1:])[-1]


@lru_cache(maxsize=64)
def lobe_sides(lobe: Lobe) -> tuple[Side, Side]:
    """Opening and closing side.

    Raises
    ------
    DesignError
        With the first fault of the values, whose path is in the lobe; without one where a value is outside its range.
    """
    if not _is_in_range(lobe):
        raise DesignError([])
    for fault in _contradictions(lobe):
        raise DesignError([fault])
    opening = closing = _solved(_form(lobe, 180.0 if lobe.closing is None else 360.0), *typed_values(lobe))
    if not lobe.is_symmetric:
        nose = TypedValue("", 0.0, Condition(NOSE_ACCELERATION, opening.nose_acceleration))
        closing = _solved(_form(_closing_lobe(lobe), 360.0 - opening.span), nose, _last_of_closing(lobe))
    if (span := opening.span + closing.span) > 360.0:
        value, allowed = f"{result_text(span)} deg of the cam", "at most 360 deg: a shorter duration, or a faster ramp"
        raise DesignError([Fault("", value, "longer than the turn", allowed)])
    return opening, closing


def _solved(form: SideForm, first: TypedValue, last: TypedValue) -> Side:
    """The side with two typed values. Raises DesignError."""
    try:
        return solve_side(form, first.condition, last.condition)
    except NoLobe as error:
        if error.low <= error.high:
            allowed = f"{_inwards(error.low * last.factor, error.high * last.factor)} {last.unit}"
            raise DesignError([Fault(last.path, last.value, "no lobe has it with the other values", allowed)]) from None
        raise DesignError([_ramp_fault(form, first, last)]) from None


def _inwards(low: float, high: float) -> str:
    """Text of a range, rounded inwards."""
    return f"{rounded_up(low, DIGITS):.{DIGITS}g} ... {rounded_down(high, DIGITS):.{DIGITS}g}"


DIGITS = 6  # of a range
RAMPS = 60  # heights of the ramp that are tried


def _ramp_fault(form: SideForm, first: TypedValue, last: TypedValue) -> Fault:
    """Fault of a side that exists with another height of the ramp at most: the range of such heights."""
    path = "closing.ramp_mm" if not first.path or last.path.startswith("closing.") else "ramp_mm"

    def serves(ramp: float) -> bool:
        try:
            solve_side(replace(form, ramp=ramp), first.condition, last.condition)
        except NoLobe:
            return False
        return True

    least = 0.5 * form.slope * form.runup
    heights = [least + (form.lift - least) * (k / RAMPS) ** 2 for k in range(RAMPS)]
    good = [k for k, height in enumerate(heights) if serves(height)]
    if not good:
        return Fault(
            first.path or last.path,
            first.value or last.value,
            "no lobe has it, whatever its ramp",
            "another value or lift",
        )
    k = min(good, key=lambda i: abs(heights[i] - form.ramp))
    low = high = k
    while low - 1 in good:
        low -= 1
    while high + 1 in good:
        high += 1
    ends = (_edge(serves, heights[low], heights[low - 1]) if low else heights[0],
            _edge(serves, heights[high], heights[high + 1]) if high + 1 < RAMPS else heights[high])  # fmt: skip
    return Fault(path, form.ramp, "no lobe has the other values with this ramp", f"{_inwards(*ends)} mm")


def _edge(serves: Callable[[float], bool], inside: float, outside: float) -> float:
    for _ in range(24):
        middle = 0.5 * (inside + outside)
        inside, outside = (middle, outside) if serves(middle) else (inside, middle)
    return inside


# -- faults -----------------------------------------------------------------------------------------------------

VALUES = "two of duration, to_nose, velocity_mm_per_deg, acceleration_mm_per_deg2, nose_acceleration_mm_per_deg2"


def lobe_fault(lobe: Lobe) -> Fault | None:
    """First fault of values that are in their ranges but make no lobe, with its path in the lobe; None where there is none."""
    try:
        lobe_sides(lobe)
    except DesignError as error:
        return next(iter(error.faults), None)
    return None


def _contradictions(lobe: Lobe) -> Iterator[Fault]:
    """Faults of values that no lobe can have, whatever the others are."""
    typed = typed_values(lobe)
    if len(typed) != 2:
        noun = "value" if len(typed) == 1 else "values"
        yield Fault("", MISSING, f"{len(typed)} {noun} besides the lift, and a lobe has two", VALUES)
    closing = lobe.closing or LobeClosing()
    if len(closing.to_nose) > 1:
        yield Fault("closing.to_nose", len(closing.to_nose), "the closing side has one row", "one row, or none")
    yield from _ramp_faults(lobe, "")
    if lobe.closing is not None:
        yield from _ramp_faults(_closing_lobe(lobe), "closing.")
    rows = [value for value in typed if value.condition.kind == HEIGHT]
    for row in [*rows, *typed_values(closing, "closing.")]:
        if not row.condition.height < lobe.lift_mm:
            yield Fault(f"{row.path}", row.condition.height, "at or above the lift", f"< {lobe.lift_mm:g} mm")
    if len(rows) == 2:
        low, high = rows
        if high.condition.height == low.condition.height:
            yield Fault(high.path, high.condition.height, "the lift is given twice", "each lift once")
        elif not high.condition.value < low.condition.value:
            most = low.condition.value * high.factor
            yield Fault(
                high.path, high.value, f"not less than at {low.condition.height:g} mm", f"< {result_text(most)} deg"
            )
        elif high.condition.height <= lobe.ramp_mm:
            problem = "both lifts are on the ramp, and leave flank and nose undetermined"
            yield Fault(high.path, high.condition.height, problem, f"> {lobe.ramp_mm:g} mm")


def _ramp_faults(lobe: Lobe, prefix: str) -> Iterator[Fault]:
    """The run-up ends below the ramp's height, the ramp below the lift."""
    if not lobe.ramp_mm < lobe.lift_mm:
        yield Fault(f"{prefix}ramp_mm", lobe.ramp_mm, "not lower than the lift", f"< {lobe.lift_mm:g} mm")
    rise = 0.5 * lobe.ramp_mm_per_deg * lobe.ramp_runup_deg
    if not rise <= lobe.ramp_mm * (1.0 + 1e-12):
        problem = f"the run-up rises {result_text(rise)} mm, higher than the ramp of {lobe.ramp_mm:g} mm"
        most = 2.0 * lobe.ramp_mm / lobe.ramp_mm_per_deg
        yield Fault(f"{prefix}ramp_runup_deg", lobe.ramp_runup_deg, problem, f"<= {result_text(most)} deg")


def _is_in_range(part: Any) -> bool:
    """Whether all values of a lobe and of its parts are in the ranges of their fields."""
    for field in fields(part):
        value, info = getattr(part, field.name), info_of(field)
        if info is not None and not info.admits(value):
            return False
        parts = [row for row in (value if isinstance(value, tuple) else (value,)) if is_dataclass(row)]
        if not all(map(_is_in_range, parts)):
            return False
    return True
