"""Meaning and units of the columns of a sheet: the user's choice, else the header, else a stated guess."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from math import log
from typing import NoReturn

from core.bounds import number_from_one
from core.design.fields import choice, flag
from core.design.fields import number as amount
from core.frozen import frozen
from core.measured.sheet import RowFault, TableError, Worksheet, number
from core.measured.units import (
    ANGLE,
    ANGLE_UNITS,
    BASES,
    DERIVATIVES,
    QUANTITIES,
    TIME,
    TIME_UNITS,
    ColumnMeaning,
    ValueUnit,
    meaning,
    unknown_unit,
    value_unit,
    value_units,
)
from core.number_text import result_text
from core.requests import text_option


@frozen
class ColumnChoice:
    """The user's choices for a table; an empty one is detected.

    Attributes
    ----------
    column, angle_column : name of a column, or its number from 1
    angle_unit : key of ``ANGLE_UNITS`` or ``TIME_UNITS``
    value_unit : mm, in, mm/s, mm/deg2, ...
    quantity : element of ``QUANTITIES``
    columns : letters s, v, a, each with the name or number of its column; only these columns are read
    trust : letters of the columns that determine the motion where columns contradict each other
    counts : counts per turn of the encoder that gives the angles; 0 for other angles
    half : whether the angles belong to a crank that turns twice per turn of the cam
    """

    column: str = text_option("column of the values: its name, or its number from 1", default="", metavar="NAME")
    angle_column: str = text_option("column of the angles or times", default="", metavar="NAME")
    angle_unit: str = choice(
        "Unit of the angles", (*ANGLE_UNITS, *TIME_UNITS), default="", help="where the header does not state it"
    )
    value_unit: str = text_option("mm, in, mm/s, mm/deg2, g, ...", default="", metavar="UNIT")
    quantity: str = choice("Quantity", tuple(QUANTITIES), default="", help="what was measured")
    columns: str = text_option(
        "the only columns to fit, of displacement, velocity, acceleration",
        default="",
        metavar="s=NAME,v=NAME,a=NAME",
    )
    trust: str = text_option(
        "columns that determine the motion where columns contradict each other; the others are only compared with it",
        default="",
        default_text="all that agree with the previous one",
        metavar="s,v,a",
    )
    counts: int = amount(
        "Counts per turn", 0, default=0, help="the angles are counts of an encoder with this many per turn"
    )
    half: bool = flag("Crank angles", help="the angles are those of a crank that turns twice per turn of the cam")


@frozen
class OtherColumn:
    """Column of a quantity other than the fitted one, recognised by its header: number from 0, name, quantity, unit."""

    column: int
    name: str
    quantity: str
    unit: ValueUnit

    @property
    def order(self) -> int:
        """Order of the derivative in the column."""
        return DERIVATIVES.index(self.quantity)


@frozen
class ColumnLayout:
    """Meaning of the columns of a sheet.

    Attributes
    ----------
    angle_column, value_column : numbers of the columns, from 0
    guesses : a sentence for each guess
    guessed_options : options of ``ColumnChoice`` that are guesses
    other_columns : columns of the other quantities
    name : name of the column of values
    turn : degrees per count of an encoder; 1 for other angles
    part : turns of the cam per turn of the angles
    trusted : quantities that determine the motion, by the user's choice; empty: those that agree
    """

    angle_column: int
    value_column: int
    angle_unit: str
    unit: ValueUnit
    quantity: str
    guesses: tuple[str, ...] = ()
    guessed_options: tuple[str, ...] = ()
    other_columns: tuple[OtherColumn, ...] = ()
    name: str = ""
    turn: float = 1.0
    part: float = 1.0
    trusted: tuple[str, ...] = ()

    @property
    def order(self) -> int:
        """Order of the measured derivative."""
        return DERIVATIVES.index(self.quantity)


LONGEST, TYPICAL, SHORTEST = (
    1000.0,
    8.0,
    0.1,
)  # strokes of cams [mm]: largest accepted as mm, typical, smallest accepted as inches
COUNTS = "counts"  # unit of an encoder
MOST_COLUMNS = 1000
LONGEST_NAME = 80  # characters of a column's name in a message
LETTERS = {"s": "displacement", "v": "velocity", "a": "acceleration"}
ALL_DETECTED = ColumnChoice()


def layout(
    sheet: Worksheet, choice: ColumnChoice = ALL_DETECTED, motion_unit: str = "mm", speed_rpm: float | None = None
) -> ColumnLayout:
    """Meaning of the columns: the user's choice, else the header, else a stated guess.

    Parameters
    ----------
    sheet : Worksheet
    choice : ColumnChoice
    motion_unit : str
        Unit of the motion, mm or deg.
    speed_rpm : float [rpm], optional
        Speed of the shaft.

    Returns
    -------
    ColumnLayout

    Raises
    ------
    TableError
        Where a column does not exist, or its unit does not belong to the motion.
    """
    return _Detection(sheet, choice, motion_unit, speed_rpm).layout()


def column_name(sheet: Worksheet, index: int) -> str:
    """Name of a column in messages: its number from 1, and its header."""
    name = sheet.names[index]
    name = name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 3]}..."
    return f"column {index + 1} ({name})" if name else f"column {index + 1}"


@dataclass
class _Detection:
    """Detection of a layout; ``headings`` are the meanings of the headers."""

    sheet: Worksheet
    choice: ColumnChoice
    motion_unit: str
    speed_rpm: float | None
    guesses: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.sheet.columns > MOST_COLUMNS:
            self._refuse(
                f"{self.sheet.columns} columns; allowed: at most {MOST_COLUMNS}, with a row for each cam angle"
            )
        self.headings = [meaning(name) for name in self.sheet.names]

    def layout(self) -> ColumnLayout:
        trusted = self._trusted()
        choice = self._with_columns(trusted)
        self.choice, angle_option = choice, choice.angle_unit
        angle = self._angle_column()
        value = self._value_column(angle)
        quantity = self._quantity(value)
        if angle_option and angle_option not in (*ANGLE_UNITS, *TIME_UNITS):
            self._refuse(
                f"unit {angle_option!r} is no unit of an angle; allowed: {', '.join((*ANGLE_UNITS, *TIME_UNITS))}"
            )
        angle_unit = choice.angle_unit or (COUNTS if choice.counts else self._angle_unit(angle))
        unit = self._value_unit(value, quantity)
        is_time = angle_unit in TIME_UNITS
        if self.speed_rpm is None and (unit.per == "s" or is_time):
            what = f"{self._name(angle)} is a time" if is_time else f"{unit.name} is a rate by time"
            self._refuse(f"{what}; the shaft's speed is required to convert it into cam angles")
        if is_time:
            self.guesses["time"] = (
                f"time 0 is assumed to be cam angle 0, and the shaft to turn at {self.speed_rpm:g} rpm"
            )
        other_columns = tuple(self._find_other_columns(angle, value, quantity))
        quantities = {quantity, *(column.quantity for column in other_columns)}
        if trusted and quantity not in trusted:
            self._refuse(
                f"trust {self.choice.trust!r}: the motion is computed from the {quantity}; trust it, or choose another column"
            )
        if missing := set(trusted) - quantities:
            self._refuse(
                f"trust: no column of {', '.join(sorted(missing))} is read; columns: {', '.join(sorted(quantities))}"
            )
        return ColumnLayout(
            angle,
            value,
            angle_unit,
            unit,
            quantity,
            tuple(self.guesses.values()),
            tuple(self.guesses),
            other_columns,
            self._name(value),
            360.0 / choice.counts if choice.counts else 1.0,
            0.5 if choice.half else 1.0,
            trusted,
        )

    def _trusted(self) -> tuple[str, ...]:
        """Quantities that the user trusts, in their order."""
        letters = {letter.strip() for letter in self.choice.trust.split(",")} - {""}
        if letters - set(LETTERS):
            self._refuse(f"trust {self.choice.trust!r}; allowed: one or more of {', '.join(LETTERS)}, as s,v")
        return tuple(quantity for letter, quantity in LETTERS.items() if letter in letters)

    def _with_columns(self, trusted: tuple[str, ...]) -> ColumnChoice:
        """Choice with the column that determines the motion, where letters name the columns or the trusted quantity."""
        self.letters: dict[str, int] = {}
        if not self.choice.columns:
            return replace(self.choice, quantity=trusted[0]) if trusted and not self.choice.quantity else self.choice
        for text in self.choice.columns.split(","):
            letter, equals, column = (part.strip() for part in text.partition("="))
            if letter not in LETTERS or not equals or not column:
                self._refuse(f"columns {text.strip()!r}; allowed: one or more of s=NAME,v=NAME,a=NAME")
            self.letters[LETTERS[letter]] = self._chosen(column)
        first = next(quantity for quantity in (*trusted, *QUANTITIES) if quantity in self.letters)
        return replace(self.choice, column=str(self.letters[first] + 1), quantity=first)

    def _find_other_columns(self, angle: int, value: int, fitted: str) -> Iterator[OtherColumn]:
        """Columns named by letters, in the unit of their header or by default; else one of each quantity with a unit.

        Columns that cannot be read without a speed or a unit are reported.
        """
        known = {fitted}
        quantity_by_column = {column: quantity for quantity, column in self.letters.items()}
        skipped: dict[str, str] = {}
        for column, heading in enumerate(self.headings):
            quantity = quantity_by_column.get(column, "") if quantity_by_column else heading.quantity
            if column in (angle, value) or quantity not in DERIVATIVES or quantity in known:
                continue
            order, name = DERIVATIVES.index(quantity), heading.unit
            if quantity_by_column and not name:
                name = self._default_unit(quantity)
                self.guesses[f"unit of {quantity}"] = f"{self._name(column)} is assumed to be in {name}"
            unit = value_unit(name, self.motion_unit) if name else None
            if unit is None or unit.order != order:
                if quantity_by_column:
                    allowed = ", ".join(value_units(quantity, self.motion_unit))
                    self._refuse(
                        f"{self._name(column)}: {name!r} is no unit of the {quantity} here; allowed: {allowed}"
                    )
            elif unit.per == "s" and self.speed_rpm is None:
                skipped.setdefault(quantity, self._name(column))
            else:
                known.add(quantity)
                yield OtherColumn(column, self._name(column), quantity, unit)
        if names := ", ".join(name for quantity, name in skipped.items() if quantity not in known):
            text = f"{names}: rates by time; the shaft's speed is required to read"
            if quantity_by_column:
                self._refuse(f"{text} them")
            self.guesses["speed"] = f"{text} them in addition to the {fitted}"

    def _default_unit(self, quantity: str) -> str:
        """Unit of a quantity without one in the header: by degrees where the speed is unknown."""
        order, per = DERIVATIVES.index(quantity), "deg" if self.speed_rpm is None else "s"
        return self.motion_unit + (f"/{per}{order if order > 1 else ''}" if order else "")

    def _refuse(self, text: str) -> NoReturn:
        raise TableError(self.sheet.name, [RowFault(0, text)])

    def _name(self, column: int) -> str:
        return column_name(self.sheet, column)

    def _chosen(self, text: str) -> int:
        """Column with this number or name, or the only one whose name begins so."""
        if chosen := number_from_one(text, self.sheet.columns):
            return chosen - 1
        names, word = [name.casefold().strip() for name in self.sheet.names], text.casefold().strip()
        result = [i for i, name in enumerate(names) if name == word] or [
            i for i, name in enumerate(names) if word and name.startswith(word)
        ]
        if len(result) != 1:
            columns = ", ".join(f"{i + 1} {name[:60]}".strip() for i, name in enumerate(self.sheet.names[:100]))
            self._refuse(
                f"column {text!r}: {'several columns have' if result else 'no column has'} this name; columns: {columns}"
            )
        return result[0]

    def _angle_column(self) -> int:
        if self.choice.angle_column:
            return self._chosen(self.choice.angle_column)
        value_column = self._chosen(self.choice.column) if self.choice.column else -1
        free = [i for i in range(self.sheet.columns) if i != value_column]
        criteria: tuple[Callable[[ColumnMeaning], bool], ...] = (
            lambda m: m.quantity == ANGLE,
            lambda m: m.quantity == TIME,
            lambda m: not m.quantity and (m.unit in ANGLE_UNITS or m.unit in TIME_UNITS),
        )
        result = [i for is_match in criteria for i in free if is_match(self.headings[i])]
        if not free:
            self._refuse("only one column of numbers; a column of angles or times is required, too")
        if not result:
            self.guesses["angle_column"] = f"{self._name(free[0])} is assumed to be the cam angle"
        return (result or free)[0]

    def _value_column(self, angle: int) -> int:
        choice = self.choice
        if choice.column:
            chosen = self._chosen(choice.column)
            if chosen == angle:
                self._refuse(f"{self._name(chosen)} cannot be angle and value at once; choose another column")
            return chosen
        free = [i for i in range(self.sheet.columns) if i != angle]
        if not free:
            self._refuse("only one column of numbers; a column of values is required, too")
        quantities = (choice.quantity,) if choice.quantity else QUANTITIES
        result = [i for quantity in quantities for i in free if self.headings[i].quantity == quantity]
        if not result and choice.trust:
            self._refuse(
                f"trust {choice.trust!r}: no column's header states {' or '.join(quantities)}; name the columns"
            )
        if not result and (len(free) > 1 or choice.quantity):
            self.guesses["column"] = f"{self._name(free[0])} is assumed to be the values"
        return (result or free)[0]

    def _quantity(self, column: int) -> str:
        stated = self.choice.quantity or self.headings[column].quantity
        if stated in QUANTITIES:
            return stated
        unit = value_unit(self.choice.value_unit, self.motion_unit) if self.choice.value_unit else None
        quantity = QUANTITIES[unit.order if unit and unit.order < len(QUANTITIES) else 0]
        if unit is None:
            self.guesses["quantity"] = f"{self._name(column)} is assumed to be the {quantity}"
        return quantity

    def _extent(self, column: int) -> tuple[float, float, int]:
        """Smallest and largest number of a column, and the count of its numbers."""
        sheet = self.sheet
        if sheet.numbers is not None:
            values = sheet.numbers[:, column]
            return float(values.min()), float(values.max()), values.size
        cells = (row.cells[column] for row in sheet.rows if len(row.cells) > column)
        known = [value for cell in cells if (value := number(cell, sheet.decimal)) is not None] or [0.0]
        return min(known), max(known), len(known)

    def _scale(self, column: int) -> str:
        """Unit of displacements without one in the header: mm, unless that gives no stroke of a cam.

        Grinding tables are in 1e-4 in or µm, or in inches to four decimals.
        """
        low, high, _ = self._extent(column)
        stroke = high - low
        has_four_decimals = all(
            len(row.cells[column].partition(".")[2]) >= 4 for row in self.sheet.rows[:20] if len(row.cells) > column
        )
        if stroke > LONGEST:
            name = min(("1e-4in", "um"), key=lambda unit: abs(log(stroke * BASES["mm"][unit] / TYPICAL)))
        elif SHORTEST < stroke < 1.0 and has_four_decimals and self.sheet.decimal == "point":
            name = "in"
        else:
            return "mm"
        converted = stroke * BASES["mm"][name]
        self.guesses["value_unit"] = (
            f"the displacement is assumed to be in {name}, a stroke of {result_text(converted)} mm; as mm it is {result_text(stroke)} mm"
        )
        return name

    def _angle_unit(self, column: int) -> str:
        heading = self.headings[column]
        if heading.unit in ANGLE_UNITS or heading.unit in TIME_UNITS:
            return heading.unit
        if heading.quantity == TIME:
            self.guesses["angle_unit"] = "the time is assumed to be in seconds"
            return "s"
        low, high, count = self._extent(column)
        unit = "turns" if high - low <= 1.01 else "rad" if high - low <= 6.35 else "deg"
        step = f", a row every {result_text((high - low) / (count - 1))}" if count > 1 else ""
        self.guesses["angle_unit"] = f"angles from {low:g} to {high:g} are assumed to be in {unit}{step}"
        return unit

    def _value_unit(self, column: int, quantity: str) -> ValueUnit:
        motion_unit, name = self.motion_unit, self.choice.value_unit or self.headings[column].unit
        allowed = value_units(quantity, motion_unit)
        if name not in allowed:
            if self.choice.value_unit:
                self._refuse(f"unit {name!r} is no unit of {quantity} here; allowed: {', '.join(allowed)}")
            if any(value_unit(name, base) is not None for base in BASES if base != motion_unit):
                kind = "slides: lengths are required" if motion_unit == "mm" else "swings: angles are required"
                self._refuse(f"{self._name(column)} is measured in {name}, but the follower {kind}")
            if unknown := unknown_unit(self.sheet.names[column]):
                units = ", ".join(allowed)
                self._refuse(f"{self._name(column)}: unknown unit {unknown!r}; choose its unit, allowed: {units}")
            name = self._default_unit(quantity)
            self.guesses["value_unit"] = f"the {quantity} is assumed to be in {name}"
            if name == "mm":
                name = self._scale(column)
        unit = value_unit(name, motion_unit)
        assert unit is not None  # its name is allowed
        return unit
