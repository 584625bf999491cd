"""Which columns of a sheet are meant and in which units: what the user says, else the header, else a stated guess."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NoReturn, cast

from core.measured.sheet import RowFault, Sheet, TableError, number
from core.measured.units import (
    ANGLE,
    ANGLE_UNITS,
    BASES,
    QUANTITIES,
    TIME,
    TIME_UNITS,
    Meaning,
    ValueUnit,
    meaning,
    value_unit,
    value_units,
)


@dataclass(frozen=True)
class Wish:
    """What the user says of a table; empty or None = detected.

    column, angle_column   a column's name, or its number from 1
    angle_unit             key of ``ANGLE_UNITS`` or ``TIME_UNITS``
    value_unit             mm, in, mm/s, mm/deg2, ...
    quantity               one of ``QUANTITIES``
    """

    column: str = ""
    angle_column: str = ""
    angle_unit: str = ""
    value_unit: str = ""
    quantity: str = ""


@dataclass(frozen=True)
class Layout:
    """What the columns of a sheet mean, and which of it is a guess.

    angle_column, value_column   from 0
    guesses                      a sentence for each
    """

    angle_column: int
    value_column: int
    angle_unit: str
    unit: ValueUnit
    quantity: str
    guesses: tuple[str, ...] = ()

    @property
    def order(self) -> int:
        """Of the derivative that was measured."""
        return QUANTITIES.index(self.quantity)


NOTHING_SAID = Wish()


def layout(sheet: Sheet, wish: Wish = NOTHING_SAID, motion_unit: str = "mm", speed_rpm: float | None = None) -> Layout:
    """What the columns mean: what is wished, else what the header says, else a guess that is stated.

    motion_unit  of the motion to be made, mm or deg; speed_rpm: of the shaft, None where there is none

    Raises TableError where there is no such column or the unit does not belong to the motion.
    """
    told = [meaning(name) for name in sheet.names]
    guesses: list[str] = []
    angle = _angle_column(sheet, told, wish, guesses)
    value = _value_column(sheet, told, wish, angle, guesses)
    quantity = wish.quantity or (told[value].quantity if told[value].quantity in QUANTITIES else "")
    wished_unit = value_unit(wish.value_unit, motion_unit) if wish.value_unit else None
    if not quantity:
        quantity = QUANTITIES[wished_unit.order if wished_unit else 0]
        if wished_unit is None:
            guesses.append(f"{column_name(sheet, value)} is taken for the {quantity}")
    if wish.angle_unit and wish.angle_unit not in (*ANGLE_UNITS, *TIME_UNITS):
        _refuse(
            sheet, f"unit {wish.angle_unit!r} is none of an angle; allowed: {', '.join((*ANGLE_UNITS, *TIME_UNITS))}"
        )
    angle_unit = wish.angle_unit or _angle_unit(sheet, told[angle], angle, guesses)
    unit = _value_unit(sheet, told[value], wish, value, quantity, motion_unit, speed_rpm, guesses)
    if speed_rpm is None and (unit.per == "s" or angle_unit in TIME_UNITS):
        what = (
            f"{column_name(sheet, angle)} is a time" if angle_unit in TIME_UNITS else f"{unit.name} is counted by time"
        )
        _refuse(sheet, f"{what}; the shaft's speed is wanted to turn it into cam angles")
    if angle_unit in TIME_UNITS:
        guesses.append(f"time 0 is taken for cam angle 0, and the shaft turns at {speed_rpm:g} rpm")
    return Layout(angle, value, angle_unit, unit, quantity, tuple(guesses))


def _refuse(sheet: Sheet, text: str) -> NoReturn:
    raise TableError(sheet.name, [RowFault(0, text)])


def column_name(sheet: Sheet, index: int) -> str:
    name = sheet.names[index]
    return f"column {index + 1} ({name})" if name else f"column {index + 1}"


def _wished(sheet: Sheet, wish: str) -> int:
    """The column of this number or name, or the only one whose name begins so."""
    if wish.isdecimal() and 1 <= int(wish) <= sheet.columns:
        return int(wish) - 1
    names = [name.casefold().strip() for name in sheet.names]
    word = wish.casefold().strip()
    found = [i for i, name in enumerate(names) if name == word] or [
        i for i, name in enumerate(names) if word and name.startswith(word)
    ]
    if len(found) != 1:
        there = ", ".join(f"{i + 1} {name}".strip() for i, name in enumerate(sheet.names))
        _refuse(sheet, f"column {wish!r}: {'several' if found else 'none'} of that name; there are: {there}")
    return found[0]


def _angle_column(sheet: Sheet, told: Sequence[Meaning], wish: Wish, guesses: list[str]) -> int:
    if wish.angle_column:
        return _wished(sheet, wish.angle_column)
    taken = _wished(sheet, wish.column) if wish.column else -1
    free = [i for i in range(sheet.columns) if i != taken]
    for fits in (
        lambda m: m.quantity == ANGLE,
        lambda m: m.quantity == TIME,
        lambda m: not m.quantity and (m.unit in ANGLE_UNITS or m.unit in TIME_UNITS),
    ):
        found = next((i for i in free if fits(told[i])), None)
        if found is not None:
            return found
    if not free:
        _refuse(sheet, "only one column of numbers; a column of angles or times is wanted beside it")
    guesses.append(f"{column_name(sheet, free[0])} is taken for the cam angle")
    return free[0]


def _value_column(sheet: Sheet, told: Sequence[Meaning], wish: Wish, angle: int, guesses: list[str]) -> int:
    if wish.column:
        found = _wished(sheet, wish.column)
        if found == angle:
            _refuse(sheet, f"{column_name(sheet, found)} cannot be angle and value at once; name another")
        return found
    others = [i for i in range(sheet.columns) if i != angle]
    for quantity in (wish.quantity,) if wish.quantity else QUANTITIES:
        for i in others:
            if told[i].quantity == quantity:
                return i
    if not others:
        _refuse(sheet, "only one column of numbers; a column of values is wanted beside the angles")
    if len(others) > 1 or wish.quantity:
        guesses.append(f"{column_name(sheet, others[0])} is taken for the values")
    return others[0]


def _angle_unit(sheet: Sheet, told: Meaning, column: int, guesses: list[str]) -> str:
    if told.unit in ANGLE_UNITS or told.unit in TIME_UNITS:
        return told.unit
    if told.quantity == TIME:
        guesses.append("the time is taken for seconds")
        return "s"
    found = [number(row.cells[column], sheet.decimal) for row in sheet.rows if len(row.cells) > column]
    known = sorted(value for value in found if value is not None)
    reach = known[-1] - known[0] if known else 0.0
    unit = "turns" if reach <= 1.01 else "rad" if reach <= 6.35 else "deg"
    guesses.append(
        f"angles from {known[0]:g} to {known[-1]:g} are taken for {unit}" if known else "angles are taken for deg"
    )
    return unit


def _value_unit(
    sheet: Sheet,
    told: Meaning,
    wish: Wish,
    column: int,
    quantity: str,
    motion_unit: str,
    speed_rpm: float | None,
    guesses: list[str],
) -> ValueUnit:
    allowed = value_units(quantity, motion_unit)
    kind = "slides: lengths are wanted" if motion_unit == "mm" else "swings: angles are wanted"
    name = wish.value_unit or told.unit
    if name in allowed:
        return cast(ValueUnit, value_unit(name, motion_unit))
    if wish.value_unit:
        _refuse(sheet, f"unit {name!r} is none of a {quantity} here; allowed: {', '.join(allowed)}")
    other = next((m for m in BASES if m != motion_unit), "")
    if value_unit(name, other) is not None:
        _refuse(sheet, f"{column_name(sheet, column)} is measured in {name}, but the follower {kind}")
    per = ("", "/s" if speed_rpm is not None else "/deg", "/s2" if speed_rpm is not None else "/deg2")
    base = motion_unit + per[QUANTITIES.index(quantity)]
    guesses.append(f"the {quantity} is taken for {base}")
    return cast(ValueUnit, value_unit(base, motion_unit))
