"""Edits of the list of drives, each one undo step, and the strip of buttons that selects a drive."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from types import MappingProxyType

from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QAction, QActionGroup, QColor, QIcon, QPainter, QPen, QPixmap, QResizeEvent, QShowEvent
from PySide6.QtWidgets import QHBoxLayout, QMenu, QSizePolicy, QToolButton, QWidget

from core.design import (
    RESERVED,
    Design,
    add_drive,
    as_list,
    copy_drive,
    move_drive,
    only,
    remove_drive,
    slug,
    with_mechanism,
    with_shaft,
)
from core.errors import KindynaError, NoSolution
from core.findings import ERROR
from core.frozen import frozen
from kindyna_gui.documents.session import BALANCER, Session
from kindyna_gui.labels import reason
from kindyna_gui.look import described, sign, tool_bar
from kindyna_gui.pictures.style import BALANCE, SCREEN
from kindyna_gui.rebuilt import fill

# -- edits of the list -----------------------------------------------------------------------------------


def add(session: Session, design: Design, name: str = "") -> bool:
    """Add the drives of a design and select the first of them; False where this is refused.

    A session with one drive becomes a shaft with a list of drives.
    """
    edited_design, first = _with_shaft(session.full_design), len(session.full_design.drives)
    names = []
    try:
        for index in range(len(design.drives)):
            edited_design = add_drive(edited_design, only(design, index), name)
            names.append(edited_design.drives[-1].name or "")
    except KindynaError as error:
        session.refuse("drives", reason(edited_design, error))
        return False
    return _put(session, edited_design, f"Add {', '.join(names)}", first)


def listed(design: Design, name: str) -> Design:
    """Return a shaft of this name whose list has the drive of a design as its first."""
    return replace(as_list(_with_shaft(design), usable_name(design.name)), name=name)


def list_them(session: Session) -> bool:
    """Put the session's single drive on a shaft with a list of drives."""
    name = session.full_design.name
    return _put(session, listed(session.full_design, name), f"Put {name} on a shaft with several drives", 0)


def usable_name(name: str) -> str:
    """Return the name where a drive can have it, else ``Drive``."""
    return name if slug(name).strip("_") and slug(name) not in RESERVED else "Drive"


def add_balancer(session: Session) -> bool:
    """Add a balance cam and select it; False where the shaft has one already, or nothing can be balanced."""
    from core.shaft import with_balancer  # loaded when a balance cam is added

    design = session.full_design
    try:
        balanced = with_balancer(design, session.shaft.flywheel.energy_swing)
    except KindynaError as error:
        session.refuse(BALANCER, reason(design, error))
        return False
    return design.balancer is None and _put(session, balanced, "Add a balance cam", len(design.drives))


def _with_shaft(design: Design) -> Design:
    """Add a shaft to a single linkage, whose driver states the speed otherwise."""
    return with_shaft(design) if design.shaft is None else design


def copy(session: Session) -> bool:
    """Duplicate the selected drive, behind it in the list."""
    index = session.chosen
    return _put(session, copy_drive(session.full_design, index), f"Duplicate {session.names[index]}", index + 1)


def replace_chosen(session: Session, design: Design, label: str) -> bool:
    """Replace the mechanism of the selected drive, which keeps its name and its position on the shaft."""
    return _put(session, with_mechanism(session.full_design, session.chosen, design), label, session.chosen)


def remove(session: Session) -> bool:
    """Remove the selected drive or the balance cam; the last drive cannot be removed."""
    index, name = session.chosen, session.names[session.chosen]
    if session.is_on_balancer:
        assumed = tuple(path for path in session.full_design.assumed if not path.startswith(f"{BALANCER}."))
        return _put(session, replace(session.full_design, balancer=None, assumed=assumed), f"Remove {name}", 0)
    last = len(session.full_design.drives) - 2
    return _put(session, remove_drive(session.full_design, index), f"Remove {name}", min(index, last))


def move(session: Session, by: int) -> bool:
    """Move the selected drive up or down in the list."""
    index, to = session.chosen, session.chosen + by
    if session.is_on_balancer or not 0 <= to < len(session.full_design.drives):
        return False
    label = f"Move {session.names[index]} {'up' if by < 0 else 'down'}"
    return _put(session, move_drive(session.full_design, index, to), label, to)


def rename(session: Session, index: int, name: str) -> bool:
    """Rename a drive, also in the sequence conditions."""
    session.end_gesture()
    return session.edit(f"drives[{index}].name", name, f"Rename {session.names[index]} to {name}")


def _put(session: Session, full_design: Design, label: str, chosen: int) -> bool:
    """Put a design of all drives as one undo step, and select a drive."""
    with session.one_step():
        return session.put_full_design(full_design, label, chosen=max(chosen, 0))


# -- rows ------------------------------------------------------------------------------------------------


@frozen
class DriveRow:
    """Name and colour of a drive or the balance cam, and why it cannot be assembled; empty where it can."""

    name: str
    colour: str
    problem: str = ""

    @property
    def icon(self) -> QIcon:
        """Swatch of the colour, or the sign of an error."""
        return sign(ERROR) if self.problem else swatch(self.colour)


def drive_rows(session: Session) -> tuple[DriveRow, ...]:
    """Return the drives in the order of the list; only their positions are calculated."""
    rows = []
    for number, study in enumerate(session.shaft.drives.values()):
        problem = ""
        try:
            _ = study.linkage
        except NoSolution as error:
            problem = reason(study.design, error)
        rows.append(DriveRow(session.names[number], SCREEN.drive(number), problem))
    return (*rows, *(DriveRow(name, SCREEN.seen(BALANCE)) for name in session.names[len(rows) :]))


@lru_cache(maxsize=64)
def swatch(colour: str) -> QIcon:
    """Return a small square of a colour."""
    icon = QIcon()
    for scale in (1, 2):
        picture = QPixmap(16 * scale, 16 * scale)
        picture.setDevicePixelRatio(scale)
        picture.fill(Qt.GlobalColor.transparent)
        painter = QPainter(picture)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(Qt.PenStyle.NoPen))
        painter.setBrush(QColor(colour))
        painter.drawRoundedRect(QRectF(2.0, 2.0, 12.0, 12.0), 3.0, 3.0)
        painter.end()
        for mode in (QIcon.Mode.Normal, QIcon.Mode.Selected):  # the selection must not tint it
            icon.addPixmap(picture, mode)
    return icon


# -- strip -----------------------------------------------------------------------------------------------

ONE, SIDE_BY_SIDE, ON_SHAFT = "one", "beside", "shaft"
ARRANGEMENTS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        ONE: ("One", "Draw the selected drive alone, with all its layers; its joints can be dragged"),
        SIDE_BY_SIDE: (
            "Side by side",
            "Draw all drives side by side, to one scale, at one machine angle; click a drive to select it",
        ),
        ON_SHAFT: (
            "On the shaft",
            "Draw all drives about their common shaft, seen from this end; click a drive to select it",
        ),
    }
)
"""Arrangements of the drives in the drawing: text and tip."""


LEAST_NAME, LEAST_LETTER = 28, 12  # width of a name that ends in …, and of its first letter alone, pixels
AROUND = 12  # margins of the strip, and the frame of its bar, pixels


class DriveStrip(QWidget):
    """A button for each drive, and at the right end the arrangement of the drives in the drawing.

    Where they have no room next to each other the arrangements are in a list, then the names of the drives are shortened.

    - chosen (number): a drive was clicked
    - arranged (name in ``ARRANGEMENTS``): an arrangement was clicked
    """

    chosen = Signal(int)
    arranged = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self._rows: tuple[DriveRow, ...] = ()
        self.bar = tool_bar("Drives on the shaft", self)
        self.arrangement_bar = tool_bar("Arrangement of the drives", self)
        self.bar.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.bar.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.bar.setIconSize(QSize(14, 14))
        self._group: QActionGroup | None = None
        arrangements = QActionGroup(self)
        self.arrangements: dict[str, QAction] = {}
        for name, (text, tip) in ARRANGEMENTS.items():
            action = arrangements.addAction(text)
            action.setCheckable(True)
            action.setToolTip(tip)
            action.setStatusTip(tip)
            action.triggered.connect(partial(self._arrange, name))
            self.arrangements[name] = action
            self.arrangement_bar.addAction(action)
        self.arrangements[ONE].setChecked(True)
        self.arrangement_list = described(
            QToolButton(autoRaise=True, popupMode=QToolButton.ToolButtonPopupMode.InstantPopup),
            name="Arrangement of the drives",
            tip="Arrange the drives in the drawing",
        )
        menu = QMenu(self.arrangement_list)
        menu.addActions(list(self.arrangements.values()))
        self.arrangement_list.setMenu(menu)
        self.arrangement_list.hide()
        arrangements.triggered.connect(self._fit)
        layout = QHBoxLayout(self)
        fill(layout, (self.bar, 1), self.arrangement_bar, self.arrangement_list, margins=(4, 1, 4, 1), spacing=0)
        self.hide()

    def _arrange(self, name: str, *_: object) -> None:
        self.arranged.emit(name)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._fit()

    def _fit(self, *_: object) -> None:
        """Put the arrangements in a list where the strip is narrow, and shorten the longest names until all have room."""
        advance, names = self.fontMetrics().horizontalAdvance, [row.name for row in self._rows]
        buttons = [self.bar.widgetForAction(action) for action in self.actions_of_drives]
        texts = [action.iconText() for action in self.actions_of_drives]
        around = sum(b.sizeHint().width() - advance(text) for b, text in zip(buttons, texts, strict=True))
        around += AROUND + self.bar.layout().spacing() * len(buttons)  # type: ignore[union-attr]
        widths = [advance(name) for name in names]
        is_narrow = sum(widths) + around + self.arrangement_bar.sizeHint().width() > self.width()
        chosen = next(action for action in self.arrangements.values() if action.isChecked())
        self.arrangement_list.setText(chosen.text())
        self.arrangement_bar.setVisible(not is_narrow)
        self.arrangement_list.setVisible(is_narrow)
        right = self.arrangement_list if is_narrow else self.arrangement_bar
        most = _widest(widths, self.width() - around - right.sizeHint().width())
        for name, action in zip(names, self.actions_of_drives, strict=True):
            shown = name
            if advance(name) > most:
                elided = self.fontMetrics().elidedText(name, Qt.TextElideMode.ElideRight, most)
                shown = elided if most >= LEAST_NAME else name[:1]
            action.setIconText(shown.replace("&", "&&"))

    def show_drives(self, rows: Sequence[DriveRow], chosen: int) -> None:
        """Show these drives, and the selected one."""
        if tuple(rows) != self._rows:
            self._rows = tuple(rows)
            self._build()
        if self._group is not None and chosen < len(rows):
            self._group.actions()[chosen].setChecked(True)

    @property
    def actions_of_drives(self) -> list[QAction]:
        """Actions of the drives, in their order."""
        return [] if self._group is None else self._group.actions()

    def _build(self) -> None:
        self.bar.clear()
        if self._group is not None:
            self._group.deleteLater()
        self._group = QActionGroup(self)
        for number, row in enumerate(self._rows):
            action = self._group.addAction(row.icon, row.name.replace("&", "&&"))
            action.setCheckable(True)
            tip = row.problem or f"Show {row.name} in the forms and plots"
            action.setToolTip(tip)
            action.setStatusTip(tip)
            action.triggered.connect(partial(self._choose, number))
            self.bar.addAction(action)
        self._fit()

    def _choose(self, number: int, *_: object) -> None:
        self.chosen.emit(number)


def _widest(widths: Sequence[int], room: int) -> int:
    """Largest width of a name with which all names have room; at least that of a letter."""
    left = sorted(widths)
    while left and left[0] * len(left) <= room:
        room -= left.pop(0)
    return max(room // len(left), LEAST_LETTER) if left else max(widths, default=LEAST_NAME)
