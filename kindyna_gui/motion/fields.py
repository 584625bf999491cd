"""Entries of a segment's curve: their paths, names and units, and a number that may be left open."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import Field as DataField
from dataclasses import fields, replace
from typing import Any

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget

from core.design import NO_UNIT, UNITS, Design, Info, Motion, PolynomialEnd, SplinePoint, Unit, get, info_of
from kindyna_gui.forms.fields import Field, FieldSpec
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.labels import name_of, value_text

_PER = {"value": "", "velocity": "/°", "acceleration": "/°²", "jerk": "/°³"}
_STEP = {"at_deg": 1.0, "value": 1.0, "velocity": 0.1, "acceleration": 0.01, "jerk": 0.001}
"""A step of an entry that stands at 0."""


def motion_unit(name: str, motion: Motion) -> Unit:
    """The unit of an entry of a curve: ``velocity`` is in the motion's unit per degree."""
    if name == "at_deg":
        return UNITS["deg"]
    return Unit(UNITS[motion.unit].symbol + _PER[name], 1.0) if name in _PER else NO_UNIT


def entry_info(field: DataField[Any]) -> Info:
    """Label, range and help of an entry, with a step where its own magnitude gives none."""
    info = info_of(field)
    assert info is not None
    return replace(info, step=info.step or _STEP.get(field.name, 0.0))


def end_specs(motion: Motion, path: str) -> Iterator[FieldSpec]:
    """The rows of one end of a polynomial; path: ``motion.segments[1].start``."""
    for field in fields(PolynomialEnd):
        yield _spec(field, f"{path}.{field.name}", motion)


def point_columns(motion: Motion) -> list[tuple[str, Info, Unit]]:
    """The entries of a spline's point: name, what is known of it, unit."""
    return [(field.name, entry_info(field), motion_unit(field.name, motion)) for field in fields(SplinePoint)]


def _spec(field: DataField[Any], path: str, motion: Motion) -> FieldSpec:
    return FieldSpec(path, entry_info(field), motion_unit(field.name, motion), reader(path), can_be_assumed=False)


def reader(path: str) -> Any:
    """What stands at a path of a design."""
    return lambda design: get(design, path)


class OptionalBox(NumberBox):
    """A number that may be left open, by an empty text.

    emptied   an empty text was confirmed
    """

    emptied = Signal()

    def __init__(self, info: Info, unit: Unit = NO_UNIT, parent: QWidget | None = None, hint: str = "free") -> None:
        self._open = False
        super().__init__(info, unit, parent)
        self.lineEdit().setPlaceholderText(hint)

    def show_value(self, value: float | None) -> None:
        self._open = value is None
        super().show_value(0.0 if value is None else value)
        if value is None:
            self._tried = ""
            self.lineEdit().clear()

    @property
    def pending(self) -> bool:
        return bool(self.text()) if self._open else super().pending

    def confirm(self) -> None:
        if self.text().strip():
            super().confirm()
        elif self._open:
            self.show_value(None)
        else:
            self._tried = self.text()
            self.emptied.emit()

    def withdraw(self) -> None:
        if self._open:
            self.show_value(None)
            self.withdrawn.emit()
        else:
            super().withdraw()


class CurveField(Field):
    """A row of a curve's form: its steps name the segment."""

    def _step(self, value: Any) -> str:
        name = described(self.session.typed, self.spec.path)
        return f"Change {name} to {value_text(value, self.spec.unit)}"


class EndField(CurveField):
    """One entry of an end of a polynomial; its row is laid out by who makes it. A jerk may be left open."""

    def _number_box(self) -> NumberBox:
        if not self.spec.info.optional:
            return super()._number_box()
        box = OptionalBox(self.spec.info, self.spec.unit)
        box.entered.connect(self._enter)
        box.emptied.connect(self._leave_open)
        box.unreadable.connect(lambda: self.session.refuse(self.spec.path, "a number is wanted, or nothing"))
        box.withdrawn.connect(lambda: self.session.take_back(self.spec.path))
        box.finished.connect(self.session.end_gesture)
        self.label.dragged.connect(box.stepBy)
        self.label.released.connect(self._label_released)
        return box

    def _leave_open(self) -> None:
        self.edit(None, f"Leave {described(self.session.typed, self.spec.path)} free")


def described(design: Design, path: str) -> str:
    """The name of an entry inside of a sentence."""
    name = name_of(design, path)
    return f"{name[:1].lower()}{name[1:]}"


__all__ = [
    "CurveField",
    "EndField",
    "OptionalBox",
    "described",
    "end_specs",
    "entry_info",
    "motion_unit",
    "point_columns",
    "reader",
]
