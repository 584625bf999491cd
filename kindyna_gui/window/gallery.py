"""Dialogs that choose a mechanism, or a circuit of a linkage, from images.

The gallery has a group for each kind of follower, with one image for each face and form of cam, one for each kind of cam in space, and
one for the linkages among the examples.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields, replace
from functools import cache, partial
from math import ceil
from pathlib import Path
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QSize, Qt, QTimer
from PySide6.QtGui import QIcon, QPixmap
from PySide6.QtWidgets import (
    QAbstractItemView,
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QRadioButton,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from core.design import FOLLOWER_KINDS, Design, Motion, edited, get
from core.design.follower_kinds import KIND_LABELS
from core.design.topology import driver_turns
from core.followers.cam_slider import LAYOUT_LENGTHS, in_layout
from core.frozen import frozen
from core.mechanism.drivers import Circuit
from core.project import load
from kindyna_gui.dialogs import give_help
from kindyna_gui.documents.texts import add_copy
from kindyna_gui.files.beginnings import beginning, dwell_first, with_previous_motion
from kindyna_gui.files.space_beginnings import SPACE_BEGINNINGS, SpaceBeginning
from kindyna_gui.labels import choice_text, choice_tip
from kindyna_gui.look import coloured, described
from kindyna_gui.pictures.painter import thumbnail
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import short
from kindyna_gui.places import FIRST_EXAMPLE, example, single_examples
from kindyna_gui.rebuilt import STRETCH, fill
from kindyna_gui.requirements import lists_links
from kindyna_gui.window.base import Window

THUMBS = (QSize(200, 140), QSize(168, 118), QSize(136, 96))  # sizes of images, the smaller ones for small screens
MOST_COLUMNS = 6
CAPTION = QSize(14, 30)  # room for the gap and the caption of an image
MARGINS = QSize(230, 146)  # room of the dialog for list, margins and buttons
LIST_WIDTH, LINE_HEIGHT = 170, 28
SHARP, LESS_MM = "efgh", 10.0
"""Layouts whose cam would be sharp under the roller of the lift example, and by how much the roller is smaller there; the
base circle is larger by as much, so that the pitch curve does not change."""

ROLLER, OPEN, LINKAGES = "roller", "open", "Linkages"
RISE, DWELL = "the rise", "the dwell below"
ORDERS: Mapping[str, Callable[[Design], Design]] = MappingProxyType({RISE: lambda design: design, DWELL: dwell_first})
"""What the motion of a new design can begin with."""

# -- what can be chosen ----------------------------------------------------------------------------------


@frozen
class GalleryChoice:
    """One image of the gallery.

    Attributes
    ----------
    name, tip : str
        Caption and tip.
    design : Callable
        Makes the design that the choice begins.
    title : str
        Name outside its group; empty: the caption.
    keeps_motion : bool
        Whether the motion of the current design can be kept.
    ordered : bool
        Whether its own motion can begin with one of ``ORDERS``.
    """

    name: str
    tip: str
    design: Callable[[], Design]
    title: str = ""
    keeps_motion: bool = False
    ordered: bool = False

    @property
    def step_name(self) -> str:
        """Name in the undo step."""
        return self.title or self.name

    def with_motion(self, motion: Motion | None) -> Design:
        """Return the design, with this motion where it can be kept."""
        return with_previous_motion(self.design(), motion) if self.keeps_motion else self.design()

    def with_order(self, order: str) -> GalleryChoice:
        """Return the choice with its own motion in this order, where it can be ordered."""
        return replace(self, design=lambda: ORDERS[order](self.design())) if self.ordered else self


def kinds() -> Iterator[tuple[str, list[GalleryChoice]]]:
    """Yield each kind of follower with its choices: layouts, faces, and forms of a cam with a roller."""
    for kind, row in FOLLOWER_KINDS.items():
        letters = layouts() if any(field.name == "layout" for field in fields(row.follower)) else []
        words = [("follower.face", word) for word in row.faces if not (letters and word == ROLLER)]
        words += [("cam.form", word) for word in row.forms if word != OPEN]
        yield row.label, [*letters, *(_variant(kind, path, word) for path, word in words)]


def in_space() -> Iterator[tuple[str, list[GalleryChoice]]]:
    """Yield each kind of cam in space with its choices."""
    for label, rows in SPACE_BEGINNINGS.items():
        yield label, [_space_choice(label, row) for row in rows]


def _space_choice(label: str, row: SpaceBeginning) -> GalleryChoice:
    title = f"{label}, {row.name[:1].lower()}{row.name[1:]}"
    design = partial(_named, row.design, title)
    return GalleryChoice(row.name, title, design, title, keeps_motion=not row.indexes, ordered=not row.indexes)


def _named(make: Callable[[], Design], title: str) -> Design:
    return replace(make(), name=title)


def _variant(kind: str, path: str, word: str) -> GalleryChoice:
    text = choice_text(word)
    title = f"{FOLLOWER_KINDS[kind].label}, {text}"
    return GalleryChoice(
        text[:1].upper() + text[1:],
        title,
        partial(beginning, kind, {path: word}, title),
        title,
        keeps_motion=True,
        ordered=True,
    )


def layout_design(letter: str) -> Design:
    """Return the lift example in another layout; the position of the guide is assumed."""
    lift = load(example(FIRST_EXAMPLE))
    design = in_layout(lift, letter)
    if letter in SHARP:
        for path, change in (("cam.base_radius_mm", LESS_MM), ("cam.roller_radius_mm", -LESS_MM)):
            design = edited(design, path, get(design, path) + change)
    return lift if design == lift else replace(design, name=f"Cam slider, layout {letter}")


def layouts() -> list[GalleryChoice]:
    """Return a choice for each layout of a cam slider."""
    return [
        GalleryChoice(
            f"Layout {letter}",
            f"Layout {letter}: {choice_tip(letter)}",
            partial(layout_design, letter),
            keeps_motion=True,
        )
        for letter in LAYOUT_LENGTHS
    ]


@cache
def presets() -> tuple[GalleryChoice, ...]:
    """Return a choice for each linkage among the examples; read once, as a gallery is opened often."""
    designs = ((name, path, load(path)) for name, path in single_examples())
    return tuple(
        GalleryChoice(name, design.name, partial(_loaded, path))
        for name, path, design in designs
        if lists_links(design)
    )


def groups() -> Iterator[tuple[str, Sequence[GalleryChoice]]]:
    """Yield all groups with their choices."""
    yield from kinds()
    yield from in_space()
    yield LINKAGES, presets()


def _loaded(path: Path) -> Design:
    design: Design = load(path)
    return design


# -- the dialog ------------------------------------------------------------------------------------------


class Pictures(QListWidget):
    """Images with captions, painted one by one once the dialog is on the screen."""

    def __init__(self, choices: Sequence[GalleryChoice], thumb: QSize = THUMBS[0]) -> None:
        super().__init__()
        self.choices, self._thumb = choices, thumb
        self.setViewMode(QListWidget.ViewMode.IconMode)
        self.setResizeMode(QListWidget.ResizeMode.Adjust)
        self.setMovement(QListWidget.Movement.Static)
        self.setIconSize(thumb)
        self.setGridSize(thumb + CAPTION)
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
        """Paint the next image; False where all are painted."""
        if self._next >= len(self.choices):
            return False
        index, self._next = self._next, self._next + 1
        size = (self._thumb.width(), self._thumb.height())
        image = thumbnail(self.choices[index].design(), *size, self.devicePixelRatioF())
        self.item(index).setIcon(QIcon(QPixmap.fromImage(image)))
        return True


@frozen
class GalleryLayout:
    """Size of the images of a group, and the numbers of columns and rows."""

    thumb: QSize
    columns: int
    rows: int

    @property
    def size(self) -> QSize:
        """Size of a dialog that shows all images of the group [pixels]."""
        grid = self.thumb + CAPTION
        return QSize(self.columns * grid.width(), self.rows * grid.height()) + MARGINS


def plan(room: QSize, most: int) -> GalleryLayout:
    """Return the layout with the largest images of which ``most`` fit into a room [pixels], in the fewest columns.

    Where not even the small ones fit, these in as many columns as fit.
    """
    best = GalleryLayout(THUMBS[-1], 1, most)
    for thumb in THUMBS:
        for columns in range(4, MOST_COLUMNS + 1):
            candidate = GalleryLayout(thumb, columns, ceil(most / columns))
            if candidate.size.width() > room.width():
                break
            best = candidate
            if candidate.size.height() <= room.height():
                return candidate
    return best


class Gallery(QDialog):
    """Groups on the left, the images of the selected group on the right; a double click or Enter begins with an image.

    Parameters
    ----------
    room : QSize, optional
        Room on the screen [pixels]; by default the screen's.
    first : str
        Group shown at first.
    asks_order : bool
        Whether the user chooses what the motion of the new design begins with.
    """

    def __init__(self, parent: QWidget, room: QSize | None = None, first: str = "", asks_order: bool = False) -> None:
        super().__init__(parent)
        give_help(self, "tour#begins a design with another follower")
        self.setWindowTitle("Choose a mechanism")
        room = self.screen().availableGeometry().size() - QSize(20, 40) if room is None else room
        choices_by_group = dict(groups())
        layout = plan(room, max(len(choices) for choices in choices_by_group.values()))
        self.groups = {title: Pictures(choices, layout.thumb) for title, choices in choices_by_group.items()}
        self.chosen: GalleryChoice | None = None
        self.resize(layout.size.boundedTo(room))
        hint = coloured(
            QLabel(
                "The new design has the dimensions of the image, and no file until it is saved. "
                "Undo returns to the previous design."
            ),
            SCREEN.quiet,
        )
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.ok = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.ok.setText("Begin")
        self.ok.setEnabled(False)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        self.names, self._stack = QListWidget(), QStackedWidget()
        self.names.setFixedWidth(LIST_WIDTH)
        self.names.setAccessibleName("Kinds of mechanism")
        for title, pictures in self.groups.items():
            self.names.addItem(title)
            self.names.item(self.names.count() - 1).setSizeHint(QSize(0, LINE_HEIGHT))
            pictures.setAccessibleName(title)
            self._stack.addWidget(pictures)
            pictures.currentRowChanged.connect(partial(self._choose, pictures))
            pictures.itemActivated.connect(lambda _: self.accept())
        self.names.currentRowChanged.connect(self._show)
        middle = fill(QHBoxLayout(), self.names, (self._stack, 1))
        self.orders = {order: QRadioButton(order) for order in ORDERS}
        self._order = QWidget()
        self._order.setVisible(asks_order)
        fill(QHBoxLayout(self._order), QLabel("The motion begins with"), *self.orders.values(), STRETCH, margins=0)
        self.orders[RISE].setChecked(True)
        fill(QVBoxLayout(self), (middle, 1), self._order, hint, self.buttons)
        self._soon = QTimer(self, interval=0)
        self._soon.timeout.connect(self._paint)
        self.show_group(first if first in self.groups else next(iter(self.groups)))

    def show_group(self, title: str) -> None:
        """Show the images of a group."""
        self.names.setCurrentRow(list(self.groups).index(title))

    @property
    def shown(self) -> Pictures:
        """Images of the selected group."""
        return list(self.groups.values())[self._stack.currentIndex()]

    def _show(self, row: int) -> None:
        self._stack.setCurrentIndex(row)
        self._soon.start()
        self._choose(self.shown, self.shown.currentRow())

    def _paint(self) -> None:
        if not self.shown.paint_next():
            self._soon.stop()

    def _choose(self, pictures: Pictures, row: int) -> None:
        """Take the selected image of the group as the choice."""
        self.chosen = pictures.choices[row] if row >= 0 else None
        self.ok.setEnabled(self.chosen is not None)
        self._order.setEnabled(self.chosen is None or self.chosen.ordered)

    @property
    def choice(self) -> GalleryChoice | None:
        """Selected choice, its motion in the selected order; None where no image is selected."""
        order = next(order for order, button in self.orders.items() if button.isChecked())
        return None if self.chosen is None else self.chosen.with_order(order)


def ask_mechanism(window: Window, asks_order: bool = False) -> GalleryChoice | None:
    """Ask for a mechanism, showing the group of the current one first; None where the user cancels."""
    label = KIND_LABELS.get(window.session.design.drive.kind, LINKAGES)
    dialog = Gallery(window, first=label, asks_order=asks_order)
    choice = dialog.choice if dialog.exec() == QDialog.DialogCode.Accepted else None
    dialog.deleteLater()
    return choice


def ask_new_mechanism(window: Window) -> GalleryChoice | None:
    """Ask for the mechanism of a new design, and whether its motion begins with the rise or the dwell."""
    return ask_mechanism(window, asks_order=True)


# -- circuits of a linkage -------------------------------------------------------------------------------


def _choice(number: int, circuit: Circuit) -> GalleryChoice:
    ends = np.array([circuit.range.low, circuit.range.high])
    turns = driver_turns(circuit.design.drive.linkage)
    low, high = np.rad2deg(ends) if turns else 1e3 * ends
    span = f"driver {short(low)} ... {short(high)} {'°' if turns else 'mm'}"
    current = " (current)" if circuit.is_current else ""
    return GalleryChoice(f"{number}: {span}{current}", f"Circuit {number}: {span}{current}", lambda: circuit.design)


class CircuitsDialog(QDialog):
    """An image of each circuit with the range of its driver."""

    def __init__(self, parent: QWidget, circuits: Sequence[Circuit]) -> None:
        super().__init__(parent)
        give_help(self, "linkages#Circuits")
        self.setWindowTitle("Circuits of the linkage")
        self._circuits = circuits
        self.pictures = described(
            Pictures([_choice(i, circuit) for i, circuit in enumerate(circuits, 1)], THUMBS[0]), name="Circuits"
        )
        while self.pictures.paint_next():
            pass
        hint = coloured(
            QLabel("Ways to assemble these links. The driver cannot move the linkage from one circuit into another."),
            SCREEN.quiet,
        )
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        add_copy(buttons, parent, "circuits", lambda: ("taken.toml", ["--take", str(self.pictures.currentRow() + 1)]))
        self.pictures.itemActivated.connect(lambda _: self.accept())
        fill(QVBoxLayout(self), (self.pictures, 1), hint, buttons)
        columns = min(len(circuits), MOST_COLUMNS - 2)
        rows = -(-len(circuits) // max(columns, 1))
        grid = THUMBS[0] + CAPTION
        self.resize(max(columns, 2) * grid.width() + 60, min(rows, 3) * grid.height() + MARGINS.height())
        self.pictures.setCurrentRow(next((i for i, circuit in enumerate(circuits) if circuit.is_current), 0))

    @property
    def chosen(self) -> Circuit:
        """Circuit of the selected image."""
        return self._circuits[self.pictures.currentRow()]


def ask_circuit(parent: QWidget, circuits: Sequence[Circuit]) -> Design | None:
    """Ask for a circuit; None where the user cancels or selects the current one."""
    dialog = CircuitsDialog(parent, circuits)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    chosen = dialog.chosen
    dialog.deleteLater()
    return chosen.design if accepted and not chosen.is_current else None
