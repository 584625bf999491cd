"""How a measured table is read: delimiter, columns and units as detected, each of which can be corrected."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QWidget

from core.measured import (
    ANGLE_UNITS,
    DECIMALS,
    DELIMITERS,
    QUANTITIES,
    TIME_UNITS,
    ColumnChoice,
    ColumnLayout,
    Worksheet,
    value_units,
)
from core.measured.columns import LETTERS
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.labels import sentence
from kindyna_gui.measured.request import TableRequest, symbol

_WORDS: Mapping[str, str] = MappingProxyType(
    {"deg": "degrees", "rad": "radians", "turns": "turns", "s": "seconds", "ms": "milliseconds"}
)
_ROWS = (
    (("delimiter", "&Between cells"), ("decimal", "decimal")),
    (("angle_column", "Cam an&gle"), ("angle_unit", "in")),
    (("column", "&Values"), ("value_unit", "in")),
    (("quantity", "are"),),
    (("trust", "Tr&ust"),),
)


class ReadingForm(QWidget):
    """One box for each property that is detected.

    changed   the user has corrected one
    """

    changed = Signal()

    def __init__(self, motion_unit: str) -> None:
        super().__init__()
        self._motion_unit = motion_unit
        self._choices: dict[str, str] = {}
        self.boxes: dict[str, WordBox] = {}
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(4)
        for row, places in enumerate(_ROWS):
            line = QHBoxLayout()
            line.setSpacing(6)
            grid.addLayout(line, row, 1)
            for name, label in places:
                box = self.boxes[name] = WordBox()
                caption = QLabel(label)
                caption.setBuddy(box)
                if name == "trust":
                    self._trust_label = caption
                if line.count():
                    line.addWidget(caption)
                else:
                    grid.addWidget(caption, row, 0)
                line.addWidget(box, 2 if line.count() else 3)
                box.activated.connect(lambda _, name=name: self._choice_made(name))
        grid.setColumnStretch(1, 1)
        self._fill("delimiter", [(key, f"{key.capitalize()}") for key in DELIMITERS])
        self._fill("decimal", [(key, f"{key.capitalize()}  ( {mark} )") for key, mark in DECIMALS.items()])
        self._fill("angle_unit", [(unit, _WORDS[unit]) for unit in (*ANGLE_UNITS, *TIME_UNITS)])
        self._fill("quantity", [(name, f"{name}s" if name != "velocity" else "velocities") for name in QUANTITIES])

    def request(self, request: TableRequest) -> TableRequest:
        """The given request with the user's corrections in it."""
        choices = self._choices
        chosen: dict[str, Any] = {
            name: choices.get(name, "")
            for name in ("column", "angle_column", "angle_unit", "value_unit", "quantity", "trust")
        }
        columns = ColumnChoice(**chosen)
        return replace(
            request, delimiter=choices.get("delimiter", ""), decimal=choices.get("decimal", ""), columns=columns
        )

    def show_read(self, sheet: Worksheet | None, how: ColumnLayout | None) -> None:
        """Show what was detected in the boxes; what was guessed waits in a dashed frame to be confirmed, or corrected."""
        if sheet is not None:
            self._choose("delimiter", sheet.delimiter)
            self._choose("decimal", sheet.decimal)
            names = [(str(i + 1), f"{i + 1}  {name}".rstrip()) for i, name in enumerate(sheet.names)]
            for name in ("angle_column", "column"):
                self._fill(name, names)
        self._choose("angle_column", str(how.angle_column + 1) if how else self._choices.get("angle_column", ""))
        self._choose("column", str(how.value_column + 1) if how else self._choices.get("column", ""))
        quantity = how.quantity if how else self._choices.get("quantity", "")
        self._choose("angle_unit", how.angle_unit if how else self._choices.get("angle_unit", ""))
        self._choose("quantity", quantity)
        units = value_units(quantity or QUANTITIES[0], self._motion_unit)
        self._fill("value_unit", [(unit, symbol(unit)) for unit in units])
        self._choose("value_unit", how.unit.name if how else self._choices.get("value_unit", ""))
        for name, box in self.boxes.items():
            box.set_waits(how is not None and name in how.guessed_options)

    def ask_trust(self, how: ColumnLayout | None, contradicted: bool) -> None:
        """Ask which column makes the motion where they contradict each other; go on asking where one was chosen."""
        read = () if how is None else (how.quantity, *(each.quantity for each in how.other_columns))
        names = [(letter, sentence(quantity)) for letter, quantity in LETTERS.items() if quantity in read]
        self._fill("trust", [("", "Each that agrees with the one before"), *names])
        self._choose("trust", self._choices.get("trust", ""))
        for widget in (self._trust_label, self.boxes["trust"]):
            widget.setVisible(contradicted or bool(self._choices.get("trust")))
        self.boxes["trust"].set_waits(contradicted and not self._choices.get("trust"))

    def forget(self) -> None:
        """Drop the corrections: all as detected."""
        self._choices.clear()

    def _choice_made(self, name: str) -> None:
        """A correction voids the corrections of the properties that depend on it."""
        self._choices[name] = self.boxes[name].currentData()
        void: Mapping[str, Sequence[str]] = {
            "delimiter": ("column", "angle_column", "angle_unit", "value_unit", "quantity", "trust"),
            "column": ("value_unit", "quantity", "trust"),
            "angle_column": ("angle_unit",),
            "quantity": ("value_unit", "trust"),
            "trust": ("column", "value_unit", "quantity"),
        }
        for other in void.get(name, ()):
            self._choices.pop(other, None)
        self.changed.emit()

    def _fill(self, name: str, rows: Sequence[tuple[str, str]]) -> None:
        box = self.boxes[name]
        if [(box.itemData(i), box.itemText(i)) for i in range(box.count())] != list(rows):
            box.clear()
            for data, text in rows:
                box.addItem(text, data)

    def _choose(self, name: str, data: str) -> None:
        self.boxes[name].setCurrentIndex(self.boxes[name].findData(data))
