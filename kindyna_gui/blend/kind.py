"""The first two questions of the blend wizard."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QPointF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QIcon, QPainter, QPen, QPixmap, QPolygonF
from PySide6.QtWidgets import QButtonGroup, QHBoxLayout, QRadioButton, QSizePolicy, QToolButton, QVBoxLayout, QWidget

from core.blend import CONSTANT_VELOCITY, MOTION_TYPES
from core.output.texts import curve_shape, type_shape
from kindyna_gui.blend.request import constants
from kindyna_gui.blend.settings import quiet
from kindyna_gui.look import bold_label, text_button
from kindyna_gui.pictures.style import SCREEN, of_theme

# -- icons -----------------------------------------------------------------------------------------------

TYPE_SIZE, CURVE_SIZE = QSize(96, 46), QSize(72, 26)
QUANTITIES = ("displacement", "velocity", "acceleration")
EDGE, GAP, WIDTH = 2.0, 4.0, 1.5  # around the curves, between them, of a line [pixels]
_NONE = 1e-9


@of_theme
def type_icon(motion_type: str) -> QIcon:
    """The picture of a type of motion, its three curves below each other."""
    return _icon(type_shape(motion_type), TYPE_SIZE, below=True)


@of_theme
def curve_icon(curve: str) -> QIcon:
    """The picture of an elementary curve: displacement, velocity and acceleration side by side, as a row of a table has room."""
    return _icon(curve_shape(curve), CURVE_SIZE, below=False)


def _icon(shape: np.ndarray, size: QSize, below: bool) -> QIcon:
    made = QIcon()
    for ratio in (1, 2):
        picture = QPixmap(size * ratio)
        picture.setDevicePixelRatio(ratio)
        picture.fill(Qt.GlobalColor.transparent)
        painter = QPainter(picture)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        width, height = size.width() - 2.0 * EDGE, size.height() - 2.0 * EDGE
        for k, quantity in enumerate(QUANTITIES):
            if below:
                part = (height - 2.0 * GAP) / 3.0
                box = (EDGE, EDGE + k * (part + GAP), width, part)
            else:
                part = (width - 2.0 * GAP) / 3.0
                box = (EDGE + k * (part + GAP), EDGE, part, height)
            _draw(painter, shape[0], shape[k + 1], box, SCREEN.family(quantity))
        painter.end()
        made.addPixmap(picture)
    return made


def _draw(painter: QPainter, x: np.ndarray, y: np.ndarray, box: tuple[float, float, float, float], colour: str) -> None:
    """One curve in its box (left, top, width, height), on a line at 0."""
    left, top, width, height = box
    low, high = min(0.0, float(y.min())), max(0.0, float(y.max()))
    moves = high - low > _NONE
    size, above = (high - low, high) if moves else (2.0, 1.0)  # what is 0 all along lies in the middle
    across = left + width * (x - x[0]) / (x[-1] - x[0])
    down = top + height * (above - y) / size
    zero = top + height * above / size
    painter.setPen(QPen(QColor(SCREEN.faint), 1.0))
    painter.drawLine(QPointF(left, zero), QPointF(left + width, zero))
    painter.setPen(QPen(QColor(colour), WIDTH))
    painter.drawPolyline(QPolygonF([QPointF(a, b) for a, b in zip(across.tolist(), down.tolist(), strict=True)]))


# -- kind ------------------------------------------------------------------------------------------------

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
