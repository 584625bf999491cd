"""The first two questions of the blend wizard: which motion, as pictures, and where its velocity is constant."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from types import MappingProxyType

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QButtonGroup,
    QHBoxLayout,
    QRadioButton,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.blend import CONSTANT_VELOCITY, MOTION_TYPES
from kindyna_gui.blend.fields import quiet
from kindyna_gui.blend.icons import TYPE_SIZE, type_icon
from kindyna_gui.blend.request import constants
from kindyna_gui.look import text_button
from kindyna_gui.note import bold_label

TYPES: Mapping[str, str] = MappingProxyType(
    {"DRD": "Rise", "DRD-return": "Return", "DRRD": "Rise, return", "RRR": "No dwell"}
)
"""Type of motion -> what stands under its picture."""


class KindChoice(QWidget):
    """Type of motion and constant velocity.

    type_chosen   another type
    changed       another constant velocity
    """

    type_chosen = Signal()
    changed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.label = quiet()
        self.types: dict[str, QToolButton] = {}
        self.constants: dict[str, QRadioButton] = {}
        head = QHBoxLayout()
        head.addWidget(bold_label("Motion type"))
        head.addSpacing(8)
        head.addWidget(self.label, 1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(6)
        column.addLayout(head)
        column.addLayout(self._pictures())
        column.addLayout(self._strokes())
        self.answer("DRRD", "none")

    def _pictures(self) -> QHBoxLayout:
        group = QButtonGroup(self)
        row = QHBoxLayout()
        row.setSpacing(4)
        for name, text in TYPES.items():
            button = text_button(text, checks=True)
            button.setIcon(type_icon(name))
            button.setIconSize(TYPE_SIZE)
            button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextUnderIcon)
            button.setToolTip(f"{MOTION_TYPES[name].label} ({name}): displacement, velocity, acceleration")
            button.setAccessibleName(MOTION_TYPES[name].label)
            button.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
            button.setMinimumHeight(72)
            button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
            button.clicked.connect(partial(self._choose, name))
            group.addButton(button)
            row.addWidget(button, 1)
            self.types[name] = button
        return row

    def _strokes(self) -> QHBoxLayout:
        group = QButtonGroup(self)
        row = QHBoxLayout()
        row.addWidget(bold_label("Constant velocity"))
        row.addSpacing(8)
        for name in CONSTANT_VELOCITY:
            button = QRadioButton(name.capitalize())
            button.setToolTip("No stretch of constant velocity" if name == "none" else f"A stretch of it: {name}")
            button.clicked.connect(self.changed)
            group.addButton(button)
            row.addWidget(button)
            self.constants[name] = button
        row.addStretch(1)
        return row

    @property
    def type(self) -> str:
        return next(name for name, button in self.types.items() if button.isChecked())

    @property
    def constant(self) -> str:
        """The constant that is chosen, by its name."""
        return next(name for name, button in self.constants.items() if button.isChecked())

    def answer(self, motion_type: str, constant: str) -> None:
        """Show these choices, without emitting a signal."""
        self.types[motion_type].setChecked(True)
        self.constants[constant].setChecked(True)
        self._show_type()

    def _choose(self, name: str, *_: object) -> None:
        self._show_type()
        self.type_chosen.emit()

    def _show_type(self) -> None:
        """Only strokes that the motion has can have a constant velocity; a choice of the other stroke goes to the stroke there is."""
        able, was = constants(self.type), self.constant
        self.label.setText(MOTION_TYPES[self.type].label)
        for name, button in self.constants.items():
            button.setEnabled(name in able)
        if was not in able:
            self.constants[next(name for name in able if name != "none")].setChecked(True)


__all__ = ["TYPES", "KindChoice"]
