"""Mechanisms to choose from as pictures: the eight layouts of the cam slider, and the linkages that come with the program."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from math import ceil
from pathlib import Path
from types import MappingProxyType

from PySide6.QtCore import QPoint, QRect, QSize, Qt, QTimer
from PySide6.QtGui import QIcon, QPainter, QPixmap
from PySide6.QtWidgets import (
    QAbstractItemView,
    QDialog,
    QDialogButtonBox,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QVBoxLayout,
    QWidget,
)

from core.design import Design, edited, get
from core.errors import KindynaError
from core.followers import LAYOUT_TABLE
from core.project import load
from core.study import Study
from kindyna_gui.labels import choice_tip
from kindyna_gui.look import QUIET, coloured
from kindyna_gui.pictures.drawing.mechanism import EVERY_LAYER, MechanismScene
from kindyna_gui.pictures.files import Sheet
from kindyna_gui.places import FIRST_EXAMPLE, example, examples
from kindyna_gui.requirements import lists_links

THUMB, SMALL_THUMB = QSize(168, 118), QSize(136, 96)  # the small ones where the screen has no room for all of the others
MOST_COLUMNS = 8  # the layouts in one row
BESIDE, BELOW = QSize(14, 44), QSize(60, 176)  # room for gaps and captions; of the dialog for margins, headings and buttons
SAMPLES = 180  # of a thumbnail's turn
_LEFT_OUT = ("labels", "scale", "pitch", "base", "normal", "centre")

LAYOUT_LENGTHS: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "a": (1300.0, 43.637), "b": (1300.0, 43.637), "c": (-1300.0, 130.0), "d": (-1300.0, 130.0),
        "e": (1300.0, 110.0), "f": (1300.0, 130.0), "g": (-1300.0, 60.0), "h": (-1300.0, 60.0),
    }
)  # fmt: skip
"""Layout -> guide height [mm] and fixed angle [deg] with which the lift's other lengths make a sound mechanism."""

FORCE = "loads.external_force_n"
"""Of the cylinder on the slider, along the guide."""


@dataclass(frozen=True)
class Choice:
    """One picture: its caption, what it is, and the design that it begins."""

    name: str
    tip: str
    design: Callable[[], Design]


def layout_design(letter: str) -> Design:
    """The lift's lengths in another layout, its guide moved to where the arm can reach it. The guide's place is assumed.

    A roller below the line from cam to pivot is pressed on by turning the arm the other way: the cylinder, which pulls
    the slider in the layouts with the roller above, pushes it in those.
    """
    height, angle = LAYOUT_LENGTHS[letter]
    design: Design = load(example(FIRST_EXAMPLE))
    original, force = design, float(get(design, FORCE))
    for path, value in (
        ("follower.layout", letter), ("follower.guide_height_mm", height), ("follower.fixed_angle_deg", angle),
        (FORCE, force if LAYOUT_TABLE[letter].roller_above else -force),
    ):  # fmt: skip
        design = edited(design, path, value)
    return original if design == original else replace(design, name=f"Cam slider, layout {letter}")


def layouts() -> list[Choice]:
    return [
        Choice(f"{letter}", f"Layout {letter}: {choice_tip(letter)}", partial(layout_design, letter))
        for letter in LAYOUT_LENGTHS
    ]


def presets() -> list[Choice]:
    """The linkages among the examples."""
    choices = []
    for name, path in examples():
        design = load(path)
        if lists_links(design):
            choices.append(Choice(name, design.name, partial(_loaded, path)))
    return choices


def _loaded(path: Path) -> Design:
    design: Design = load(path)
    return design


def thumbnail(design: Design, size: QSize = THUMB, ratio: float = 1.0) -> QPixmap:
    """A small picture of the mechanism, without texts; empty where it has no position."""
    picture = QPixmap(size * ratio)
    picture.setDevicePixelRatio(ratio)
    picture.fill(Qt.GlobalColor.white)
    try:
        scene = MechanismScene()
        for layer in EVERY_LAYER:
            scene.set_layer(layer, layer not in _LEFT_OUT and EVERY_LAYER[layer].shown)
        scene.update_study(Study(design, SAMPLES))
    except KindynaError:
        return picture
    assert scene.overlay is not None
    scene.overlay.angle.hide()
    scene.set_fraction(0.125)
    sheet = Sheet(scene, size.width(), size.height(), scene.fill(size.width(), size.height()))
    sheet.grab(QRect(0, 0, 1, 1))  # sizes are settled by drawing once
    painter = QPainter(picture)
    QWidget.render(sheet, painter, QPoint())
    painter.end()
    sheet.deleteLater()
    return picture


class Pictures(QListWidget):
    """Pictures with captions, side by side; they are painted one after the other once the dialog is on the screen."""

    def __init__(self, choices: list[Choice], thumb: QSize = THUMB) -> None:
        super().__init__()
        self.choices, self._thumb = choices, thumb
        self.setViewMode(QListWidget.ViewMode.IconMode)
        self.setResizeMode(QListWidget.ResizeMode.Adjust)
        self.setMovement(QListWidget.Movement.Static)
        self.setIconSize(thumb)
        self.setGridSize(thumb + BESIDE)
        self.setWordWrap(True)
        self.setUniformItemSizes(True)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        blank = QPixmap(thumb)
        blank.fill(Qt.GlobalColor.white)
        for choice in choices:
            item = QListWidgetItem(QIcon(blank), choice.name, self)
            item.setToolTip(choice.tip)
            item.setTextAlignment(Qt.AlignmentFlag.AlignHCenter)
        self._next = 0

    def paint_next(self) -> bool:
        """Paint one more picture; False where all are painted."""
        if self._next >= len(self.choices):
            return False
        at, self._next = self._next, self._next + 1
        self.item(at).setIcon(QIcon(thumbnail(self.choices[at].design(), self._thumb, self.devicePixelRatioF())))
        return True


@dataclass(frozen=True)
class Plan:
    """How pictures are laid out: their size, how many stand beside each other, rows of each group."""

    thumb: QSize
    columns: int
    rows: tuple[int, ...]

    @property
    def size(self) -> QSize:
        """Of the dialog that shows them all."""
        grid = self.thumb + BESIDE
        return QSize(self.columns * grid.width(), sum(self.rows) * grid.height()) + BELOW


def plan(room: QSize, counts: tuple[int, ...]) -> Plan:
    """The largest pictures that can all be seen in a room [pixels], in as few columns as that takes; else the small ones,
    in as many columns as there are."""
    best = Plan(SMALL_THUMB, 1, counts)
    for thumb in (THUMB, SMALL_THUMB):
        for columns in range(2, MOST_COLUMNS + 1):
            candidate = Plan(thumb, columns, tuple(ceil(count / columns) for count in counts))
            if candidate.size.width() > room.width():
                break
            best = candidate
            if candidate.size.height() <= room.height():
                return candidate
    return best


class Gallery(QDialog):
    """Layouts above, linkages below; a double click or Enter chooses. room: of the screen, where None [pixels]."""

    def __init__(self, parent: QWidget, room: QSize | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle("Choose a mechanism")
        room = self.screen().availableGeometry().size() - QSize(20, 40) if room is None else room
        above, below = layouts(), presets()
        laid = plan(room, (len(above), len(below)))
        self.layouts, self.presets = Pictures(above, laid.thumb), Pictures(below, laid.thumb)
        self.chosen: Choice | None = None
        self.resize(laid.size.boundedTo(room))
        hint = QLabel(
            "The design begins with the lengths of the picture; it has no file until it is saved. "
            "Undo brings the design before back."
        )
        coloured(hint, QUIET)
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.ok = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.ok.setText("Begin")
        self.ok.setEnabled(False)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        groups = (("Layouts of the cam slider", self.layouts), ("Linkages", self.presets))
        for (title, pictures), rows in zip(groups, laid.rows, strict=True):
            column.addWidget(QLabel(f"<b>{title}</b>"))
            column.addWidget(pictures, rows)
            pictures.currentRowChanged.connect(partial(self._choose, pictures))
            pictures.itemActivated.connect(lambda _: self.accept())
        column.addWidget(hint)
        column.addWidget(self.buttons)
        self._soon = QTimer(self, interval=0)
        self._soon.timeout.connect(self._paint)
        self._soon.start()

    def _paint(self) -> None:
        if not self.layouts.paint_next() and not self.presets.paint_next():
            self._soon.stop()

    def _choose(self, pictures: Pictures, row: int) -> None:
        if row < 0:
            return
        self.chosen = pictures.choices[row]
        self.ok.setEnabled(True)
        other = self.presets if pictures is self.layouts else self.layouts
        other.setCurrentRow(-1)
        other.clearSelection()


def mechanism_wanted(parent: QWidget) -> Choice | None:
    """Ask for a mechanism; None where the user thinks better of it."""
    dialog = Gallery(parent)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    chosen = dialog.chosen if accepted else None
    dialog.deleteLater()
    return chosen
