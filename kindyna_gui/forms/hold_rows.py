"""Where a row of the loads holds on, in its form: chosen from a list of what has a name, or in the drawing."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QPushButton, QWidget

from core.design import LINK, AttachedEnd, Attachment, Design, Held, get, holds_of, places_for, with_held
from core.errors import KindynaError
from core.output.load_text import attachment_text, row_name
from kindyna_gui.documents.refusal import Refusal
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.field_parts import NameLabel
from kindyna_gui.forms.fields import COLUMNS
from kindyna_gui.forms.number_box import WordBox, row_height
from kindyna_gui.labels import reason
from kindyna_gui.look import coloured
from kindyna_gui.pictures.style import SCREEN


class HoldRows(QWidget):
    """The holds of one row of the loads, one below the other.

    picked   (key): one is to be chosen in the drawing
    """

    picked = Signal(str)

    def __init__(self, session: Session, path: str) -> None:
        super().__init__()
        self._session, self._path = session, path
        self._name = path.partition(".")[2].partition("[")[0]
        self._shown: tuple[object, ...] | None = None
        self.boxes: dict[str, WordBox] = {}
        self.buttons: dict[str, QPushButton] = {}
        self._messages: dict[str, QLabel] = {}
        self._values: dict[str, list[Held | None]] = {}
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 3)
        grid.setHorizontalSpacing(6)
        grid.setVerticalSpacing(3)
        grid.setColumnStretch(1, 1)
        for number, hold in enumerate(self._holds(session.typed)):
            self._add(grid, 2 * number, hold)
        session.refused.connect(self._refused)
        session.accepted.connect(self._accepted)
        session.restored.connect(self._restored)

    def _holds(self, design: Design) -> tuple[AttachedEnd, ...]:
        return holds_of(design.drive, self._name)

    def _add(self, grid: QGridLayout, row: int, hold: AttachedEnd) -> None:
        label, box, button = NameLabel(hold.label, False), WordBox(), QPushButton("Pick")
        box.setAccessibleName(hold.label)
        box.activated.connect(partial(self._choose, hold))
        box.withdrawn.connect(partial(self._take_back, hold))
        label.setBuddy(box)
        button.setFixedSize(button.fontMetrics().horizontalAdvance(button.text()) + 24, row_height(box))
        button.setToolTip(f"{hold.label}: choose it in the drawing")
        button.setStatusTip(button.toolTip())
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        button.clicked.connect(partial(self._pick, hold.key))
        message = QLabel(wordWrap=True)
        coloured(message, SCREEN.limit)
        message.hide()
        grid.addWidget(label, row, 0)
        grid.addWidget(box, row, 1)
        grid.addWidget(button, row, 2)
        grid.addWidget(message, row + 1, 0, 1, COLUMNS)
        self.boxes[hold.key], self.buttons[hold.key], self._messages[hold.key] = box, button, message

    def _pick(self, key: str, *_: object) -> None:
        self.picked.emit(key)

    @property
    def editors(self) -> list[QWidget]:
        """In the order of Tab."""
        return [editor for key in self.boxes for editor in (self.boxes[key], self.buttons[key])]

    # -- from the session ---------------------------------------------------------------------------------

    def refresh(self, design: Design) -> None:
        """Show where the row holds on, unless what was chosen there was refused, and what does not fit of it."""
        row = get(design, self._path)
        shown = (design.drive.mechanism, [hold.read(row) for hold in self._holds(design)], self._session.draft)
        if shown == self._shown:
            return
        self._shown = shown
        for hold in self._holds(design):
            if not self.boxes[hold.key].refused:
                self._show(hold, design, hold.read(row))
                self._show_misfit(hold)

    def _show_misfit(self, hold: AttachedEnd) -> None:
        own = self._own(hold)
        self._say(hold.key, "\n".join(text for path, _, text in self._session.misfit.reasons if path in own))
        self.boxes[hold.key].set_waits(self._session.waits(own[0], lambda design: hold.read(get(design, self._path))))

    def _show(self, hold: AttachedEnd, design: Design, now: Held | None) -> None:
        box = self.boxes[hold.key]
        values: list[Held | None] = [*((None,) if hold.output else ()), *places_for(design.drive, hold)]
        if isinstance(now, Attachment) and hold.what == LINK:  # the place on the link has fields of its own
            now = Attachment(link=now.link)
        if now not in values:
            values.insert(0, now)
        with QSignalBlocker(box):
            if values != self._values.get(hold.key):
                self._values[hold.key] = values
                box.clear()
                box.addItems([attachment_text(design, value) for value in values])
            box.setCurrentIndex(values.index(now))

    def _refused(self, refusal: Refusal) -> None:
        for hold in self._holds(self._session.typed):
            own = self._own(hold)
            if refusal.path == own[0]:
                self.boxes[hold.key].set_refused(True)
                self._say(hold.key, "\n".join(f"{name}: {text}" for _, name, text in refusal.reasons))

    def _own(self, hold: AttachedEnd) -> tuple[str, ...]:
        """The path at which a hold is edited, then those of its parts."""
        parts = ("link", "point", "at", "links", "pair")
        keys = (hold.key, *(f"{hold.key}.{part}" for part in parts), *(own for _, own in hold.fields))
        own = [f"{self._path}.{key}" for key in (*keys, *(("links",) if hold.key == "pair" else ()))]
        return tuple(dict.fromkeys(own))

    def _accepted(self, path: str) -> None:
        for hold in self._holds(self._session.typed):
            if path in self._own(hold):
                self._shown = None
                self.boxes[hold.key].set_refused(False)
                self._say(hold.key, "")

    def _restored(self) -> None:
        self._shown = None
        for key, box in self.boxes.items():
            box.set_refused(False)
            self._say(key, "")

    def _say(self, key: str, text: str) -> None:
        self._messages[key].setText(text)
        self._messages[key].setVisible(bool(text))

    # -- by the user ----------------------------------------------------------------------------------------

    def _choose(self, hold: AttachedEnd, index: int) -> None:
        held = self._values[hold.key][index]
        put_held(self._session, self._path, hold, held)

    def _take_back(self, hold: AttachedEnd) -> None:
        self._session.take_back(self._own(hold)[0])
        self._shown = None
        self.refresh(self._session.typed)


def put_held(session: Session, path: str, hold: AttachedEnd, held: Held | None) -> bool:
    """Let a row of the loads hold on elsewhere, as one step; False where that is refused."""
    design, at = session.typed, f"{path}.{hold.key}"
    session.end_gesture()
    try:
        changed = with_held(design, path, hold.key, held)
    except KindynaError as error:
        session.refuse(at, reason(design, error))
        return False
    label = f"{row_name(design, path)}: {hold.label[:1].lower()}{hold.label[1:]} {attachment_text(design, held)}"
    done = session.lay_out(changed, label, at)
    session.end_gesture()
    return done


__all__ = ["HoldRows", "put_held"]
