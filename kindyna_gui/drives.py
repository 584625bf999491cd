"""Drives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from types import MappingProxyType

from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QAction, QActionGroup, QColor, QIcon, QPainter, QPen, QPixmap
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QWidget

from core.design import (
    RESERVED,
    Design,
    add_drive,
    as_list,
    copy_drive,
    edited,
    move_drive,
    only,
    remove_drive,
    slug,
    with_only,
    with_shaft,
)
from core.errors import KindynaError, NoSolution
from core.findings import ERROR
from core.frozen import frozen
from kindyna_gui.documents.session import BALANCER, Session
from kindyna_gui.labels import reason
from kindyna_gui.look import sign, tool_bar
from kindyna_gui.pictures.style import BALANCE, SCREEN

# -- edits of the list of drives, each one step of the undo stack ----------------------------------------


def add(session: Session, design: Design, name: str = "") -> bool:
    """The drives of a design behind those that there are; the first of them is chosen. Where the session's design is of one
    drive, it becomes the first of a list. False where it is refused."""
    whole, first = _with_shaft(session.full_design), len(session.full_design.drives)
    names = []
    try:
        for index in range(len(design.drives)):
            whole = add_drive(whole, only(design, index), name)
            names.append(whole.drives[-1].name or "")
    except KindynaError as error:
        session.refuse("drives", reason(whole, error))
        return False
    return _done(session, whole, f"Add {', '.join(names)}", first)


def listed(design: Design, name: str) -> Design:
    """A design of one drive as a shaft of this name with it as the first of a list."""
    return replace(as_list(_with_shaft(design), free_slug(design.name)), name=name)


def list_them(session: Session) -> bool:
    """The session's design, of one drive, as the first of a list."""
    whole = listed(session.full_design, session.full_design.name)
    return _done(session, whole, f"Put {session.full_design.name} on a shaft of several", 0)


def free_slug(name: str) -> str:
    """The name, where a drive may be called so; else one that it may be called."""
    wanted = slug(name).strip("_")
    return name if wanted and slug(name) not in RESERVED else "Drive"


def add_balancer(session: Session) -> bool:
    """A balance cam to begin with, which is then chosen. False where there is one, or nothing can be balanced."""
    from core.shaft import with_balancer

    whole = session.full_design
    try:
        made = with_balancer(whole, session.shaft.flywheel.energy_swing)
    except KindynaError as error:
        session.refuse(BALANCER, reason(whole, error))
        return False
    return whole.balancer is None and _done(session, made, "Add a balance cam", len(whole.drives))


def _with_shaft(design: Design) -> Design:
    """A linkage alone says by its driver how fast it turns; on a shaft with others the shaft does."""
    return with_shaft(design) if design.shaft is None else design


def copy(session: Session) -> bool:
    """The chosen drive once more, behind it."""
    index = session.chosen
    return _done(session, copy_drive(session.full_design, index), f"Copy {session.names[index]}", index + 1)


def replace_chosen(session: Session, design: Design, label: str) -> bool:
    """Another mechanism in place of the chosen drive's, which keeps its name and its place on the shaft."""
    alone = replace(design, name=session.design.name, shaft=session.design.shaft)
    whole = with_only(session.full_design, session.chosen, alone)
    whole = edited(
        whole, "shaft.speed_rpm", session.full_design.camshaft.speed_rpm
    )  # a linkage's driver turns as the shaft does
    return _done(session, whole, label, session.chosen)


def remove(session: Session) -> bool:
    """The chosen drive, or the balance cam, taken away; the last drive stays."""
    index, name = session.chosen, session.names[session.chosen]
    if session.on_balancer:
        kept = tuple(path for path in session.full_design.assumed if not path.startswith(f"{BALANCER}."))
        return _done(session, replace(session.full_design, balancer=None, assumed=kept), f"Remove {name}", 0)
    return _done(
        session,
        remove_drive(session.full_design, index),
        f"Remove {name}",
        min(index, len(session.full_design.drives) - 2),
    )


def move(session: Session, by: int) -> bool:
    """The chosen drive further up or down in the list."""
    index, to = session.chosen, session.chosen + by
    if session.on_balancer or not 0 <= to < len(session.full_design.drives):
        return False
    way = "up" if by < 0 else "down"
    return _done(session, move_drive(session.full_design, index, to), f"Move {session.names[index]} {way}", to)


def rename(session: Session, index: int, name: str) -> bool:
    """Another name of a drive, in the timing too."""
    session.end_gesture()
    return session.edit(f"drives[{index}].name", name, f"Rename {session.names[index]} to {name}")


def _done(session: Session, whole: Design, label: str, chosen: int) -> bool:
    session.end_gesture()
    done = session.put_full_design(whole, label, chosen=max(chosen, 0))
    session.end_gesture()
    return done


# -- rows ------------------------------------------------------------------------------------------------


@frozen
class DriveRow:
    """One drive, or the balance cam behind them: its name, its colour, and why it cannot be assembled, empty where it can."""

    name: str
    colour: str
    problem: str = ""

    @property
    def icon(self) -> QIcon:
        """A swatch of its colour, or the sign of an error."""
        return sign(ERROR) if self.problem else swatch(self.colour)


def drive_rows(session: Session) -> tuple[DriveRow, ...]:
    """The drives in the order of the list. Of each only where its bodies stand is computed."""
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
    """A small square of a colour."""
    made = QIcon()
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
        for mode in (QIcon.Mode.Normal, QIcon.Mode.Selected):  # a chosen row must not tint it
            made.addPixmap(picture, mode)
    return made


# -- strip -----------------------------------------------------------------------------------------------

ONE, BESIDE, ON_SHAFT = "one", "beside", "shaft"
ARRANGEMENTS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        ONE: ("One", "Draw the chosen drive alone, with all its layers; its joints can be dragged"),
        BESIDE: (
            "Side by side",
            "Draw all drives beside each other, to one scale, at one machine angle; a click chooses",
        ),
        ON_SHAFT: ("On the shaft", "Draw all drives about their common shaft, as seen from this end; a click chooses"),
    }
)
"""How the drives are drawn: text and tip of each way."""


class DriveStrip(QWidget):
    """A button for each drive, the chosen one down; at the right end how they are drawn.

    chosen    (number): a drive was clicked
    arranged  (name in ``ARRANGEMENTS``): another way to draw them was clicked
    """

    chosen = Signal(int)
    arranged = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self._rows: tuple[DriveRow, ...] = ()
        self.bar, self.ways = tool_bar("Drives on the shaft", self), tool_bar("How the drives are drawn", self)
        self.bar.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.bar.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.bar.setIconSize(QSize(14, 14))
        self._group: QActionGroup | None = None
        ways = QActionGroup(self)
        self.arrangements: dict[str, QAction] = {}
        for name, (text, tip) in ARRANGEMENTS.items():
            action = ways.addAction(text)
            action.setCheckable(True)
            action.setToolTip(tip)
            action.setStatusTip(tip)
            action.triggered.connect(partial(self._arrange, name))
            self.arrangements[name] = action
            self.ways.addAction(action)
        self.arrangements[ONE].setChecked(True)
        row = QHBoxLayout(self)
        row.setContentsMargins(4, 1, 4, 1)
        row.setSpacing(0)
        row.addWidget(self.bar, 1)
        row.addWidget(self.ways)
        self.hide()

    def _arrange(self, name: str, *_: object) -> None:
        self.arranged.emit(name)

    def show_drives(self, rows: Sequence[DriveRow], chosen: int) -> None:
        """Name these drives, of which one is chosen."""
        if tuple(rows) != self._rows:
            self._rows = tuple(rows)
            self._build()
        if self._group is not None and chosen < len(rows):
            self._group.actions()[chosen].setChecked(True)

    @property
    def actions_of_drives(self) -> list[QAction]:
        """One for each drive, in their order."""
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

    def _choose(self, number: int, *_: object) -> None:
        self.chosen.emit(number)
