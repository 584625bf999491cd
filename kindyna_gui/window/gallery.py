"""Gallery, circuits."""

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
from core.design.topology import driver_turns
from core.followers.cam_slider import LAYOUT_LENGTHS, in_layout
from core.frozen import frozen
from core.mechanism.drivers import Circuit
from core.project import load
from kindyna_gui.dialogs import give_help
from kindyna_gui.documents.texts import add_copy
from kindyna_gui.files.beginnings import beginning, dwell_first, with_motion_kept
from kindyna_gui.labels import choice_text, choice_tip
from kindyna_gui.look import coloured
from kindyna_gui.pictures.painter import thumbnail
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.places import FIRST_EXAMPLE, example, single_examples
from kindyna_gui.requirements import lists_links
from kindyna_gui.window.base import Window

# -- gallery ---------------------------------------------------------------------------------------------

THUMBS = (
    QSize(200, 140),
    QSize(168, 118),
    QSize(136, 96),
)  # the smaller ones where the screen has no room for all of the others
MOST_COLUMNS = 6
BESIDE, BELOW = (
    QSize(14, 30),
    QSize(230, 146),
)  # room for gaps and captions; of the dialog for list, margins and buttons
LIST_WIDTH, LINE_HEIGHT = 170, 28

ROLLER, OPEN, LINKAGES = "roller", "open", "Linkages"
RISE, DWELL = "the rise", "the dwell below"
ORDERS: Mapping[str, Callable[[Design], Design]] = MappingProxyType({RISE: lambda design: design, DWELL: dwell_first})
"""What the motion of a new design can begin with."""


@frozen
class GalleryChoice:
    """One picture: its caption, what it is, and the design that it begins; title: what it is called outside its group;
    keeps_motion: it can go with the motion that was there before; ordered: its own motion can begin with one of ``ORDERS``."""

    name: str
    tip: str
    design: Callable[[], Design]
    title: str = ""
    keeps_motion: bool = False
    ordered: bool = False

    @property
    def called(self) -> str:
        """The name of the step that takes it."""
        return self.title or self.name

    def begun(self, motion: Motion | None) -> Design:
        """The design, with the motion that is there where it suits."""
        return with_motion_kept(self.design(), motion) if self.keeps_motion else self.design()

    def beginning_with(self, order: str) -> GalleryChoice:
        """The same with its own motion in this order, where it has any."""
        return replace(self, design=lambda: ORDERS[order](self.design())) if self.ordered else self


def kinds() -> Iterator[tuple[str, list[GalleryChoice]]]:
    """Every kind of follower with every face, and with every form of a cam under a roller; those that have layouts, first
    with these."""
    for kind, row in FOLLOWER_KINDS.items():
        letters = layouts() if any(field.name == "layout" for field in fields(row.follower)) else []
        words = [("follower.face", word) for word in row.faces if not (letters and word == ROLLER)]
        words += [("cam.form", word) for word in row.forms if word != OPEN]
        yield row.label, [*letters, *(_variant(kind, path, word) for path, word in words)]


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


SHARP, LESS_MM = "efgh", 10.0
"""Layouts in which the lift's own roller would leave its cam sharper than usual, and by how much it is smaller there on a base circle that
is larger by as much: the pitch curve stays."""


def layout_design(letter: str) -> Design:
    """The lift in another layout. The guide's place is assumed."""
    lift = load(example(FIRST_EXAMPLE))
    made = in_layout(lift, letter)
    if letter in SHARP:
        for path, change in (("cam.base_radius_mm", LESS_MM), ("cam.roller_radius_mm", -LESS_MM)):
            made = edited(made, path, get(made, path) + change)
    return lift if made == lift else replace(made, name=f"Cam slider, layout {letter}")


def layouts() -> list[GalleryChoice]:
    """One choice for each layout of a cam slider."""
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
    """The linkages among the examples; read once, for a gallery is opened again and again."""
    designs = ((name, path, load(path)) for name, path in single_examples())
    return tuple(
        GalleryChoice(name, design.name, partial(_loaded, path))
        for name, path, design in designs
        if lists_links(design)
    )


def groups() -> Iterator[tuple[str, Sequence[GalleryChoice]]]:
    """All choices, by the group that they stand in."""
    yield from kinds()
    yield LINKAGES, presets()


def _loaded(path: Path) -> Design:
    design: Design = load(path)
    return design


class Pictures(QListWidget):
    """Pictures with captions, side by side; they are painted one after the other once the dialog is on the screen."""

    def __init__(self, choices: Sequence[GalleryChoice], thumb: QSize = THUMBS[0]) -> None:
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
        size = (self._thumb.width(), self._thumb.height())
        image = thumbnail(self.choices[at].design(), *size, self.devicePixelRatioF())
        self.item(at).setIcon(QIcon(QPixmap.fromImage(image)))
        return True


@frozen
class GalleryLayout:
    """How the pictures of a group are laid out: their size, how many stand beside each other, and in how many rows at most."""

    thumb: QSize
    columns: int
    rows: int

    @property
    def size(self) -> QSize:
        """Of the dialog that shows a group whole."""
        grid = self.thumb + BESIDE
        return QSize(self.columns * grid.width(), self.rows * grid.height()) + BELOW


def plan(room: QSize, most: int) -> GalleryLayout:
    """The largest pictures of which a group of so many can be seen whole in a room [pixels], in as few columns as that takes;
    else the small ones, in as many columns as there are."""
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
    """Groups on the left, the pictures of the chosen one beside them; a double click or Enter on a picture begins with it.
    room: of the screen, where None [pixels]; first: the group that is shown at first; offers: the design begins with a motion of its
    own, whose order can be chosen."""

    def __init__(self, parent: QWidget, room: QSize | None = None, first: str = "", offers: bool = False) -> None:
        super().__init__(parent)
        give_help(self, "tour#begins with another follower")
        self.setWindowTitle("Choose a mechanism")
        room = self.screen().availableGeometry().size() - QSize(20, 40) if room is None else room
        found = dict(groups())
        laid = plan(room, max(len(choices) for choices in found.values()))
        self.groups = {title: Pictures(choices, laid.thumb) for title, choices in found.items()}
        self.chosen: GalleryChoice | None = None
        self.resize(laid.size.boundedTo(room))
        hint = QLabel(
            "The design begins with the lengths of the picture; it has no file until it is saved. "
            "Undo brings the design before back."
        )
        coloured(hint, SCREEN.quiet)
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
        beside = QHBoxLayout()
        beside.addWidget(self.names)
        beside.addWidget(self._stack, 1)
        column = QVBoxLayout(self)
        column.addLayout(beside, 1)
        self.orders = {order: QRadioButton(order) for order in ORDERS}
        self._order = QWidget()
        self._order.setVisible(offers)
        row = QHBoxLayout(self._order)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(QLabel("The motion begins with"))
        for button in self.orders.values():
            row.addWidget(button)
        row.addStretch(1)
        self.orders[RISE].setChecked(True)
        column.addWidget(self._order)
        column.addWidget(hint)
        column.addWidget(self.buttons)
        self._soon = QTimer(self, interval=0)
        self._soon.timeout.connect(self._paint)
        self.show_group(first if first in self.groups else next(iter(self.groups)))

    def show_group(self, title: str) -> None:
        """Show the pictures of a group."""
        self.names.setCurrentRow(list(self.groups).index(title))

    @property
    def shown(self) -> Pictures:
        """The pictures that are seen."""
        return list(self.groups.values())[self._stack.currentIndex()]

    def _show(self, row: int) -> None:
        self._stack.setCurrentIndex(row)
        self._soon.start()
        self._choose(self.shown, self.shown.currentRow())

    def _paint(self) -> None:
        if not self.shown.paint_next():
            self._soon.stop()

    def _choose(self, pictures: Pictures, row: int) -> None:
        """The picture that is chosen among those that are seen."""
        self.chosen = pictures.choices[row] if row >= 0 else None
        self.ok.setEnabled(self.chosen is not None)
        self._order.setEnabled(self.chosen is None or self.chosen.ordered)

    @property
    def wanted(self) -> GalleryChoice | None:
        """What is chosen, with its motion in the order that is."""
        order = next(order for order, button in self.orders.items() if button.isChecked())
        return None if self.chosen is None else self.chosen.beginning_with(order)


def mechanism_wanted(window: Window, offers: bool = False) -> GalleryChoice | None:
    """Ask for a mechanism, beginning with the group of the one that is there; None where the user thinks better of it.
    offers: with what its motion begins is asked, too."""
    row = FOLLOWER_KINDS.get(window.session.design.drive.kind)
    dialog = Gallery(window, first=row.label if row else LINKAGES, offers=offers)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    wanted = dialog.wanted if accepted else None
    dialog.deleteLater()
    return wanted


def new_mechanism_wanted(window: Window) -> GalleryChoice | None:
    """The same for a design that begins, whose motion can begin with its rise or its dwell."""
    return mechanism_wanted(window, offers=True)


# -- the circuits of a linkage as pictures, of which one is chosen ---------------------------------------


def _choice(number: int, circuit: Circuit) -> GalleryChoice:
    ends = np.array([circuit.range.low, circuit.range.high])
    turns = driver_turns(circuit.design.drive.linkage)
    low, high = np.rad2deg(ends) if turns else 1e3 * ends
    span = f"driver {low:.4g} ... {high:.4g} {'°' if turns else 'mm'}"
    own = " (as it is now)" if circuit.is_current else ""
    return GalleryChoice(f"{number}: {span}{own}", f"Circuit {number}: {span}{own}", lambda: circuit.design)


class CircuitsDialog(QDialog):
    """A picture of each circuit with the range of its driver; chosen: the circuit whose picture was double clicked or taken."""

    def __init__(self, parent: QWidget, found: Sequence[Circuit]) -> None:
        super().__init__(parent)
        give_help(self, "linkages#Circuits")
        self.setWindowTitle("Circuits of the linkage")
        self._found = found
        self.pictures = Pictures([_choice(i, circuit) for i, circuit in enumerate(found, 1)], THUMBS[0])
        self.pictures.setAccessibleName("Circuits")
        while self.pictures.paint_next():
            pass
        hint = QLabel("The ways to put these links together; the driver takes none of them into another.")
        coloured(hint, SCREEN.quiet)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        add_copy(buttons, parent, "circuits", lambda: ("taken.toml", ["--take", str(self.pictures.currentRow() + 1)]))
        self.pictures.itemActivated.connect(lambda _: self.accept())
        column = QVBoxLayout(self)
        column.addWidget(self.pictures, 1)
        column.addWidget(hint)
        column.addWidget(buttons)
        columns = min(len(found), MOST_COLUMNS - 2)
        rows = -(-len(found) // max(columns, 1))
        grid = THUMBS[0] + BESIDE
        self.resize(max(columns, 2) * grid.width() + 60, min(rows, 3) * grid.height() + BELOW.height())
        self.pictures.setCurrentRow(next((i for i, circuit in enumerate(found) if circuit.is_current), 0))

    @property
    def chosen(self) -> Circuit:
        """The circuit whose picture is marked."""
        return self._found[self.pictures.currentRow()]


def circuit_wanted(parent: QWidget, found: Sequence[Circuit]) -> Design | None:
    """Ask for a circuit; None where the user stays with the one that is there."""
    dialog = CircuitsDialog(parent, found)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    chosen = dialog.chosen
    dialog.deleteLater()
    return chosen.design if accepted and not chosen.is_current else None
