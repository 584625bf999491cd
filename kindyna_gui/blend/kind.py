"""Motion type and constant velocity of a blend, with icons of types and curves."""

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
from kindyna_gui.pictures.style import SCREEN, cached_by_theme

# -- icons -----------------------------------------------------------------------------------------------

TYPE_SIZE, CURVE_SIZE = QSize(96, 46), QSize(72, 26)
QUANTITIES = ("displacement", "velocity", "acceleration")
MARGIN, GAP, LINE_WIDTH = 2.0, 4.0, 1.5  # [pixels]
LEAST_HEIGHT = 1e-9  # of a curve that is not constant


@cached_by_theme
def type_icon(motion_type: str) -> QIcon:
    """Icon of a motion type: its three curves, one below the other."""
    return _icon(type_shape(motion_type), TYPE_SIZE, is_column=True)


@cached_by_theme
def curve_icon(curve: str) -> QIcon:
    """Icon of an elementary curve: displacement, velocity and acceleration side by side."""
    return _icon(curve_shape(curve), CURVE_SIZE, is_column=False)


def _icon(shape: np.ndarray, size: QSize, is_column: bool) -> QIcon:
    icon = QIcon()
    for ratio in (1, 2):
        pixmap = QPixmap(size * ratio)
        pixmap.setDevicePixelRatio(ratio)
        pixmap.fill(Qt.GlobalColor.transparent)
        painter = QPainter(pixmap)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        width, height = size.width() - 2.0 * MARGIN, size.height() - 2.0 * MARGIN
        for k, quantity in enumerate(QUANTITIES):
            if is_column:
                part = (height - 2.0 * GAP) / 3.0
                box = (MARGIN, MARGIN + k * (part + GAP), width, part)
            else:
                part = (width - 2.0 * GAP) / 3.0
                box = (MARGIN + k * (part + GAP), MARGIN, part, height)
            _draw(painter, shape[0], shape[k + 1], box, SCREEN.family(quantity))
        painter.end()
        icon.addPixmap(pixmap)
    return icon


def _draw(painter: QPainter, x: np.ndarray, y: np.ndarray, box: tuple[float, float, float, float], colour: str) -> None:
    """Draw a curve into its box (left, top, width, height), with a line at 0."""
    left, top, width, height = box
    low, high = min(0.0, float(y.min())), max(0.0, float(y.max()))
    size, above = (high - low, high) if high - low > LEAST_HEIGHT else (2.0, 1.0)  # a constant 0 is in the middle
    across = left + width * (x - x[0]) / (x[-1] - x[0])
    down = top + height * (above - y) / size
    zero = top + height * above / size
    painter.setPen(QPen(QColor(SCREEN.faint), 1.0))
    painter.drawLine(QPointF(left, zero), QPointF(left + width, zero))
    painter.setPen(QPen(QColor(colour), LINE_WIDTH))
    painter.drawPolyline(QPolygonF([QPointF(a, b) for a, b in zip(across.tolist(), down.tolist(), strict=True)]))


# -- motion type and constant velocity -------------------------------------------------------------------

TYPES: Mapping[str, str] = MappingProxyType(
    {"DRD": "Rise", "DRD-return": "Return", "DRRD": "Rise, return", "RRR": "No dwell"}
)
"""Motion type -> text below its icon."""


class KindChoice(QWidget):
    """Buttons for the motion type and for the strokes with a constant velocity.

    Signals: ``type_chosen`` when the type changes, ``changed`` when the constant velocity does.
    """

    type_chosen = Signal()
    changed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.label = quiet()
        self.types: dict[str, QToolButton] = {}
        self.constants: dict[str, QRadioButton] = {}
        header = QHBoxLayout()
        header.addWidget(bold_label("Motion type"))
        header.addSpacing(8)
        header.addWidget(self.label, 1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(6)
        column.addLayout(header)
        column.addLayout(self._type_row())
        column.addLayout(self._constant_row())
        self.set_choice("DRRD", "none")

    def _type_row(self) -> QHBoxLayout:
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

    def _constant_row(self) -> QHBoxLayout:
        group = QButtonGroup(self)
        row = QHBoxLayout()
        row.addWidget(bold_label("Constant velocity"))
        row.addSpacing(8)
        for name in CONSTANT_VELOCITY:
            button = QRadioButton(name.capitalize())
            button.setToolTip("No constant velocity" if name == "none" else f"Constant velocity: {name}")
            button.clicked.connect(self.changed)
            group.addButton(button)
            row.addWidget(button)
            self.constants[name] = button
        row.addStretch(1)
        return row

    @property
    def type(self) -> str:
        """Key of the selected motion type."""
        return next(name for name, button in self.types.items() if button.isChecked())

    @property
    def constant(self) -> str:
        """Key of the strokes with a constant velocity."""
        return next(name for name, button in self.constants.items() if button.isChecked())

    def set_choice(self, motion_type: str, constant: str) -> None:
        """Select type and constant velocity without emitting a signal."""
        self.types[motion_type].setChecked(True)
        self.constants[constant].setChecked(True)
        self._show_type()

    def _choose(self, name: str, *_: object) -> None:
        self._show_type()
        self.type_chosen.emit()

    def _show_type(self) -> None:
        """Enable the strokes that the type has; a selected stroke that it does not have becomes one that it has."""
        available, previous = constants(self.type), self.constant
        self.label.setText(MOTION_TYPES[self.type].label)
        for name, button in self.constants.items():
            button.setEnabled(name in available)
        if previous not in available:
            self.constants[next(name for name in available if name != "none")].setChecked(True)
