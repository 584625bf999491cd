"""Which columns of a sheet are meant and in which units: what the user chooses, else the header, else a stated guess."""

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
from core.requests import text_option


@frozen
class ColumnChoice:
    """What the user says of a table; empty = detected.

    column, angle_column   a column's name, or its number from 1
    angle_unit             key of ``ANGLE_UNITS`` or ``TIME_UNITS``
    value_unit             mm, in, mm/s, mm/deg2, ...
    quantity               one of ``QUANTITIES``
    columns                letters s, v, a with a column's name or number each; no other is read then
    trust                  letters of the columns that make the motion, where columns contradict each other; the others are compared only
    counts                 of an encoder a turn, which the angles are; 0: they are none
    half                   the angles are a crank's, two turns of which are one of the cam
    """

    column: str = text_option("of the values: its name, or number from 1", default="", metavar="NAME")
    angle_column: str = text_option("of the angles or times", default="", metavar="NAME")
    angle_unit: str = choice(
        "Unit of the angles", (*ANGLE_UNITS, *TIME_UNITS), default="", help="where the header does not say"
    )
    value_unit: str = text_option("mm, in, mm/s, mm/deg2, g, ...", default="", metavar="UNIT")
    quantity: str = choice("Quantity", tuple(QUANTITIES), default="", help="what was measured")
    columns: str = text_option(
        "the columns that are fitted, no others: of displacement, velocity, acceleration",
        default="",
        metavar="s=NAME,v=NAME,a=NAME",
    )
    trust: str = text_option(
        "which columns make the motion where they contradict each other; the others are compared with it only",
        default="",
        default_text="each that agrees with the one before it",
        metavar="s,v,a",
    )
    counts: int = amount("Counts a turn", 0, default=0, help="the angles are counts of an encoder, so many a turn")
    half: bool = flag("Crank angles", help="the angles are those of a crank that turns twice a turn of the cam")


@frozen
class OtherColumn:
    """A column of another quantity than the one that is fitted, by its header alone: number from 0, name, quantity, unit."""

    column: int
    name: str
    quantity: str
    unit: ValueUnit

    @property
    def order(self) -> int:
        """Of the derivative that it holds."""
        return DERIVATIVES.index(self.quantity)


@frozen
class ColumnLayout:
    """What the columns of a sheet mean, and which of it is a guess.

    angle_column, value_column   from 0
    guesses                      a sentence for each
    guessed                      of ``ColumnChoice`` what they are of
    beside                       columns of the other quantities
    name                         of the column of values
    trusted                      quantities that the motion is made of, as the user chose; empty: those that agree
    turn                         degrees in a count of an encoder; part: of a turn of the angles that is one of the cam
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
        """Of the derivative that was measured."""
        return DERIVATIVES.index(self.quantity)


LONGEST, USUAL, SHORTEST = (
    1000.0,
    8.0,
    0.1,
)  # strokes of cams: above the first no mm are guessed, nor in inches below the last
COUNTS = "counts"  # of an encoder
MOST_COLUMNS = 1000
LONGEST_NAME = 80  # characters of a column's name in messages
LETTERS = {"s": "displacement", "v": "velocity", "a": "acceleration"}
ALL_DETECTED = ColumnChoice()


def layout(
    sheet: Worksheet, choice: ColumnChoice = ALL_DETECTED, motion_unit: str = "mm", speed_rpm: float | None = None
) -> ColumnLayout:
    """What the columns mean: what is chosen, else what the header says, else a guess that is stated.

    motion_unit  of the motion to be made, mm or deg; speed_rpm: of the shaft, None where there is none

    Raises TableError where there is no such column or the unit does not belong to the motion.
    """
    return _Detection(sheet, choice, motion_unit, speed_rpm).layout()


def column_name(sheet: Worksheet, index: int) -> str:
    """A column as messages name it: its number from 1, and what stands above it."""
    name = sheet.names[index]
    name = name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 3]}..."
    return f"column {index + 1} ({name})" if name else f"column {index + 1}"


@dataclass
class _Detection:
    """One layout in the making: headings are what the names above the columns say."""

    sheet: Worksheet
    choice: ColumnChoice
    motion_unit: str
    speed_rpm: float | None
    guesses: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.sheet.columns > MOST_COLUMNS:
            self._refuse(f"{self.sheet.columns} columns; wanted: at most {MOST_COLUMNS}, and a row for each cam angle")
        self.headings = [meaning(name) for name in self.sheet.names]

    def layout(self) -> ColumnLayout:
        trusted = self._trusted()
        choice = self._with_columns(trusted)
        self.choice, wanted = choice, choice.angle_unit
        angle = self._angle_column()
        value = self._value_column(angle)
        quantity = self._quantity(value)
        if wanted and wanted not in (*ANGLE_UNITS, *TIME_UNITS):
            self._refuse(f"unit {wanted!r} is none of an angle; allowed: {', '.join((*ANGLE_UNITS, *TIME_UNITS))}")
        angle_unit = choice.angle_unit or (COUNTS if choice.counts else self._angle_unit(angle))
        unit = self._value_unit(value, quantity)
        timed = angle_unit in TIME_UNITS
        if self.speed_rpm is None and (unit.per == "s" or timed):
            what = f"{self._name(angle)} is a time" if timed else f"{unit.name} is counted by time"
            self._refuse(f"{what}; the shaft's speed is wanted to turn it into cam angles")
        if timed:
            self.guesses["time"] = f"time 0 is taken for cam angle 0, and the shaft turns at {self.speed_rpm:g} rpm"
        other_columns = tuple(self._beside(angle, value, quantity))
        there = {quantity, *(each.quantity for each in other_columns)}
        if trusted and quantity not in trusted:
            self._refuse(
                f"trust {self.choice.trust!r}: the motion is made of the {quantity}; trust it, or choose another"
            )
        if missing := set(trusted) - there:
            self._refuse(
                f"trust: no column of {', '.join(sorted(missing))} is read; there are: {', '.join(sorted(there))}"
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
        """The quantities that the user trusts, in their order."""
        letters = {each.strip() for each in self.choice.trust.split(",")} - {""}
        if letters - set(LETTERS):
            self._refuse(f"trust {self.choice.trust!r}; wanted: {', '.join(LETTERS)}, one of them or more, as s,v")
        return tuple(quantity for letter, quantity in LETTERS.items() if letter in letters)

    def _with_columns(self, trusted: tuple[str, ...]) -> ColumnChoice:
        """The choice with the column that the motion is made of, where letters name them or tell which is trusted."""
        self.letters: dict[str, int] = {}
        if not self.choice.columns:
            return replace(self.choice, quantity=trusted[0]) if trusted and not self.choice.quantity else self.choice
        for text in self.choice.columns.split(","):
            letter, there, column = (part.strip() for part in text.partition("="))
            if letter not in LETTERS or not there or not column:
                self._refuse(f"columns {text.strip()!r}; wanted: s=NAME,v=NAME,a=NAME, one of them or more")
            self.letters[LETTERS[letter]] = self._chosen(column)
        first = next(quantity for quantity in (*trusted, *QUANTITIES) if quantity in self.letters)
        return replace(self.choice, column=str(self.letters[first] + 1), quantity=first)

    def _beside(self, angle: int, value: int, fitted: str) -> Iterator[OtherColumn]:
        """The columns that letters name, in the unit of their header or the usual one; without letters the first column of each other
        quantity whose header names quantity and unit. What is not read for want of a speed or a unit is told."""
        found = {fitted}
        chosen = {column: quantity for quantity, column in self.letters.items()}
        timed: dict[str, str] = {}
        for column, heading in enumerate(self.headings):
            quantity = chosen.get(column, "") if chosen else heading.quantity
            if column in (angle, value) or quantity not in DERIVATIVES or quantity in found:
                continue
            order, name = DERIVATIVES.index(quantity), heading.unit
            if chosen and not name:
                name = self._usual_unit(quantity)
                self.guesses[f"unit of {quantity}"] = f"{self._name(column)} is taken for {name}"
            unit = value_unit(name, self.motion_unit) if name else None
            if unit is None or unit.order != order:
                if chosen:
                    allowed = ", ".join(value_units(quantity, self.motion_unit))
                    self._refuse(
                        f"{self._name(column)}: {name!r} is no unit of the {quantity} here; allowed: {allowed}"
                    )
            elif unit.per == "s" and self.speed_rpm is None:
                timed.setdefault(quantity, self._name(column))
            else:
                found.add(quantity)
                yield OtherColumn(column, self._name(column), quantity, unit)
        if names := ", ".join(name for quantity, name in timed.items() if quantity not in found):
            text = f"{names}: counted by time; the shaft's speed is wanted to read"
            if chosen:
                self._refuse(f"{text} them")
            self.guesses["speed"] = f"{text} them beside the {fitted}"

    def _usual_unit(self, quantity: str) -> str:
        """The unit of a quantity whose header tells none: by degrees where the speed is not known."""
        order, per = DERIVATIVES.index(quantity), "deg" if self.speed_rpm is None else "s"
        return self.motion_unit + (f"/{per}{order if order > 1 else ''}" if order else "")

    def _refuse(self, text: str) -> NoReturn:
        raise TableError(self.sheet.name, [RowFault(0, text)])

    def _name(self, column: int) -> str:
        return column_name(self.sheet, column)

    def _chosen(self, text: str) -> int:
        """The column of this number or name, or the only one whose name begins so."""
        if chosen := number_from_one(text, self.sheet.columns):
            return chosen - 1
        names, word = [name.casefold().strip() for name in self.sheet.names], text.casefold().strip()
        result = [i for i, name in enumerate(names) if name == word] or [
            i for i, name in enumerate(names) if word and name.startswith(word)
        ]
        if len(result) != 1:
            there = ", ".join(f"{i + 1} {name[:60]}".strip() for i, name in enumerate(self.sheet.names[:100]))
            self._refuse(f"column {text!r}: {'several' if result else 'none'} of that name; there are: {there}")
        return result[0]

    def _angle_column(self) -> int:
        if self.choice.angle_column:
            return self._chosen(self.choice.angle_column)
        taken = self._chosen(self.choice.column) if self.choice.column else -1
        free = [i for i in range(self.sheet.columns) if i != taken]
        fitting: tuple[Callable[[ColumnMeaning], bool], ...] = (
            lambda m: m.quantity == ANGLE,
            lambda m: m.quantity == TIME,
            lambda m: not m.quantity and (m.unit in ANGLE_UNITS or m.unit in TIME_UNITS),
        )
        result = [i for fits in fitting for i in free if fits(self.headings[i])]
        if not free:
            self._refuse("only one column of numbers; a column of angles or times is wanted beside it")
        if not result:
            self.guesses["angle_column"] = f"{self._name(free[0])} is taken for the cam angle"
        return (result or free)[0]

    def _value_column(self, angle: int) -> int:
        choice = self.choice
        if choice.column:
            chosen = self._chosen(choice.column)
            if chosen == angle:
                self._refuse(f"{self._name(chosen)} cannot be angle and value at once; name another")
            return chosen
        others = [i for i in range(self.sheet.columns) if i != angle]
        if not others:
            self._refuse("only one column of numbers; a column of values is wanted beside the angles")
        quantities = (choice.quantity,) if choice.quantity else QUANTITIES
        result = [i for quantity in quantities for i in others if self.headings[i].quantity == quantity]
        if not result and choice.trust:
            self._refuse(f"trust {choice.trust!r}: no column's header says {' or '.join(quantities)}; name the columns")
        if not result and (len(others) > 1 or choice.quantity):
            self.guesses["column"] = f"{self._name(others[0])} is taken for the values"
        return (result or others)[0]

    def _quantity(self, column: int) -> str:
        stated = self.choice.quantity or self.headings[column].quantity
        if stated in QUANTITIES:
            return stated
        unit = value_unit(self.choice.value_unit, self.motion_unit) if self.choice.value_unit else None
        quantity = QUANTITIES[unit.order if unit and unit.order < len(QUANTITIES) else 0]
        if unit is None:
            self.guesses["quantity"] = f"{self._name(column)} is taken for the {quantity}"
        return quantity

    def _reach(self, column: int) -> tuple[float, float, int]:
        """The least and the largest number of a column, and how many there are."""
        sheet = self.sheet
        if sheet.numbers is not None:
            values = sheet.numbers[:, column]
            return float(values.min()), float(values.max()), values.size
        cells = (row.cells[column] for row in sheet.rows if len(row.cells) > column)
        known = [value for cell in cells if (value := number(cell, sheet.decimal)) is not None] or [0.0]
        return min(known), max(known), len(known)

    def _scale(self, column: int) -> str:
        """The unit of displacements that no header tells: mm, unless a stroke in mm is no cam's. Those of grinders are in 1e-4 in or µm, or
        in inches to four places."""
        low, high, _ = self._reach(column)
        stroke = high - low
        to_four = all(
            len(row.cells[column].partition(".")[2]) >= 4 for row in self.sheet.rows[:20] if len(row.cells) > column
        )
        if stroke > LONGEST:
            name = min(("1e-4in", "um"), key=lambda unit: abs(log(stroke * BASES["mm"][unit] / USUAL)))
        elif SHORTEST < stroke < 1.0 and to_four and self.sheet.decimal == "point":
            name = "in"
        else:
            return "mm"
        made = stroke * BASES["mm"][name]
        self.guesses["value_unit"] = (
            f"the displacement is taken for {name}, a stroke of {made:.4g} mm; as mm it is {stroke:.4g} mm"
        )
        return name

    def _angle_unit(self, column: int) -> str:
        heading = self.headings[column]
        if heading.unit in ANGLE_UNITS or heading.unit in TIME_UNITS:
            return heading.unit
        if heading.quantity == TIME:
            self.guesses["angle_unit"] = "the time is taken for seconds"
            return "s"
        low, high, count = self._reach(column)
        unit = "turns" if high - low <= 1.01 else "rad" if high - low <= 6.35 else "deg"
        step = f", a row every {(high - low) / (count - 1):.4g}" if count > 1 else ""
        self.guesses["angle_unit"] = f"angles from {low:g} to {high:g} are taken for {unit}{step}"
        return unit

    def _value_unit(self, column: int, quantity: str) -> ValueUnit:
        motion_unit, name = self.motion_unit, self.choice.value_unit or self.headings[column].unit
        allowed = value_units(quantity, motion_unit)
        if name not in allowed:
            if self.choice.value_unit:
                self._refuse(f"unit {name!r} is none of a {quantity} here; allowed: {', '.join(allowed)}")
            if any(value_unit(name, other) is not None for other in BASES if other != motion_unit):
                kind = "slides: lengths are wanted" if motion_unit == "mm" else "swings: angles are wanted"
                self._refuse(f"{self._name(column)} is measured in {name}, but the follower {kind}")
            if unknown := unknown_unit(self.sheet.names[column]):
                units = ", ".join(allowed)
                self._refuse(
                    f"{self._name(column)}: the unit {unknown!r} is not known; say which it is, allowed: {units}"
                )
            name = self._usual_unit(quantity)
            self.guesses["value_unit"] = f"the {quantity} is taken for {name}"
            if name == "mm":
                name = self._scale(column)
        unit = value_unit(name, motion_unit)
        assert unit is not None  # it is one of those allowed
        return unit
