"""A form for what a command asks for, made from the metadata of its request's fields, as its options are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import Field
from html import escape
from typing import Any, TypeVar

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QCheckBox, QComboBox, QFormLayout, QLayout, QWidget

from core.design.fields import Info, info_of, unit_of
from core.requests import build_request, option_info, request_fields
from kindyna_gui.forms.amount import Amount, fill_choices
from kindyna_gui.labels import sentence

Kind = TypeVar("Kind")

DECIMALS = 6


class RequestForm(QWidget):
    """One box for each field of a request that has a label; of alternatives a box that says which, and the chosen one's. Files and
    texts are no part of it.

    changed  another value stands in a box
    boxes    by the field's name, alternatives' choices by that of their group
    rows     the layout, for what a dialog asks besides
    offered  field -> its choices, where not all of the request's; a single one is not asked for
    first    field -> the value it begins with, where not its default
    above    what a dialog asks before these, with labels; Tab goes through it first
    """

    changed = Signal()

    def __init__(
        self,
        kind: type,
        offered: Mapping[str, Sequence[str]] | None = None,
        first: Mapping[str, Any] | None = None,
        above: Sequence[tuple[str, QWidget | QLayout]] = (),
    ) -> None:
        super().__init__()
        self.kind = kind
        self.boxes: dict[str, Any] = {}
        self.rows = QFormLayout(self)
        self.rows.setContentsMargins(0, 0, 0, 0)
        for label, field in above:
            self.rows.addRow(label, field)
        self._fields = {each.name: each for each in request_fields(kind) if info_of(each) is not None}
        self._groups: dict[str, list[str]] = {}
        for name, each in self._fields.items():
            self._add(each, tuple((offered or {}).get(name, ())), (first or {}).get(name, each.default))
        for group in self._groups:
            self._choose(group)

    def _add(self, each: Field[Any], offered: Sequence[str], value: Any) -> None:
        info, how = info_of(each) or Info(""), option_info(each)
        group, way = how.one_of
        if group and group not in self.boxes:
            self._groups[group] = []
            self.boxes[group] = QComboBox(self)
            self.rows.addRow(group, self.boxes[group])
            self.boxes[group].currentIndexChanged.connect(lambda _: self._choose(group))
        label = info.label
        if info.flag:
            box: Any = QCheckBox(info.label)
            box.toggled.connect(self.changed)
            label = ""
        elif info.choices:
            box = QComboBox(self)
            words = {word: how.words.get(word, word[:1].upper() + word[1:]) for word in offered or info.choices}
            usual: dict[Any, str] = (
                {} if each.default in info.choices else {each.default: sentence(how.default_text or "as usual")}
            )
            fill_choices(box, {**usual, **words})
            box.currentIndexChanged.connect(self.changed)
        else:
            box = Amount()
            _limit(box, each, info)
            box.valueChanged.connect(self.changed)
        box.setAccessibleName(info.label)
        tip = [sentence(info.help)] if info.help else []
        if not info.flag and not info.choices:
            tip.append(sentence(f"allowed: {info.allowed(unit_of(each))}"))
        box.setToolTip("<br>".join(map(escape, tip)))
        self.boxes[each.name] = box
        self.rows.addRow("" if group else label, box)
        if group:
            self._groups[group].append(each.name)
            self.boxes[group].addItem(way, each.name)
        self.show_value(each.name, value)
        if info.choices and len(offered) == 1:
            self.rows.setRowVisible(box, False)

    def _choose(self, group: str) -> None:
        """Show the chosen one's box."""
        chosen = self.boxes[group].currentData()
        for name in self._groups[group]:
            self.rows.setRowVisible(self.boxes[name], name == chosen)
        self.changed.emit()

    def name_row(self, name: str, label: str) -> None:
        """Call a field otherwise."""
        row: Any = self.rows.labelForField(self.boxes[name])
        row.setText(label)
        self.boxes[name].setAccessibleName(label)

    # -- values ---------------------------------------------------------------------------------------------

    @property
    def values(self) -> dict[str, Any]:
        """By field, of alternatives the chosen one's."""
        left_out = {name for group, names in self._groups.items() for name in names if name != self.chosen(group)}
        return {name: self._value(name) for name in self._fields if name not in left_out}

    @property
    def request(self) -> Any:
        """What is wanted."""
        return build_request(self.kind, self.values)

    def chosen(self, group: str) -> str:
        """The field of a group that is given."""
        name: str = self.boxes[group].currentData()
        return name

    def choose(self, group: str, name: str) -> None:
        """Give this field of a group."""
        self.boxes[group].setCurrentIndex(self.boxes[group].findData(name))

    def _value(self, name: str) -> Any:
        box, each = self.boxes[name], self._fields[name]
        if not box.isEnabledTo(self):  # what makes no sense beside the others
            return each.default
        if isinstance(box, QCheckBox):
            return box.isChecked()
        if isinstance(box, QComboBox):
            return box.currentData()
        if box.specialValueText() and box.value() == box.minimum():
            return each.default
        info = info_of(each)
        return int(box.value()) if info is not None and info.whole else box.value()

    def show_value(self, name: str, value: Any) -> None:
        """Show a value in a field's box."""
        box = self.boxes[name]
        if isinstance(box, QCheckBox):
            box.setChecked(value)
        elif isinstance(box, QComboBox):
            box.setCurrentIndex(box.findData(value))
        elif value is not None:
            box.setValue(value)
        else:
            box.setValue(box.minimum())


def _limit(box: Amount, each: Field[Any], info: Info) -> None:
    """Range, decimals and unit of a number; where nothing may be given, the lowest stands for that."""
    usual = option_info(each).default_text
    may_be_none = bool(usual) and (each.default is None or each.default == info.low)
    box.setDecimals(0 if info.whole else DECIMALS)
    least = info.low if may_be_none or not info.open_low else info.low + 10.0**-DECIMALS
    box.setRange(least, info.high)
    symbol = unit_of(each).symbol
    box.setSuffix(symbol if symbol in ("", "°") else f" {symbol}")
    box.setSpecialValueText(usual if may_be_none else "")


__all__ = ["RequestForm"]
