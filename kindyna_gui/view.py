"""What every view shares."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Protocol

from PySide6.QtCore import QEvent, QObject, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QHideEvent, QShowEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QFrame,
    QLabel,
    QLayout,
    QPushButton,
    QScrollArea,
    QStackedLayout,
    QVBoxLayout,
    QWidget,
)
from shiboken6 import isValid

from core.design import Design
from core.errors import KindynaError
from core.findings import Remedy
from core.frozen import frozen
from core.numerics.lazy import postponing
from core.study import Study
from kindyna_gui.background import Background
from kindyna_gui.documents.session import Session
from kindyna_gui.fault_log import short
from kindyna_gui.labels import reason
from kindyna_gui.look import on_paper
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import soon
from kindyna_gui.requirements import Suggestion, Unavailable, suggestions_for
from kindyna_gui.settings import TOLD, is_default

# -- view ------------------------------------------------------------------------------------------------


def in_sight(widget: QWidget) -> bool:
    """True where something of a widget can be seen.

    A dock tabbed behind another answers isVisible() all the same; it stands beyond the edge of its window. Nor does
    visibleRegion() help: it leaves out what the widget's own opaque children cover.
    """
    if not widget.isVisible():
        return False
    rect, at = widget.rect(), widget
    while not rect.isEmpty() and not at.isWindow():
        within = at.parentWidget()
        assert within is not None
        rect, at = rect.translated(at.pos()) & within.rect(), within
    return not rect.isEmpty()


def scroll_to(widget: QWidget | None) -> None:
    """Bring what has got the keys into sight in all that scrolls around it, which Qt does only where they come from beside it."""
    around = None if widget is None or widget.isWindow() else widget.parentWidget()
    while widget is not None and around is not None and not around.isWindow():
        if isinstance(around, QScrollArea):
            around.ensureWidgetVisible(widget)
        elif isinstance(around, QAbstractItemView):
            around.scrollTo(around.indexAt(widget.mapTo(around.viewport(), widget.rect().center())))
        around = around.parentWidget()


class Turns(QObject):
    """What need not keep pace while the mouse draws something, in the views of a session: one thing after another, what waits longest
    first. After each of them a move of the mouse that has come meanwhile is taken up, so that none of its moves waits for all."""

    @staticmethod
    def of(session: Session) -> Turns:
        return session.findChild(Turns) or Turns(session)

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._waiting: dict[Callable[[], None], QObject] = {}
        self._next = QTimer(self, singleShot=True, interval=0)
        self._next.timeout.connect(self._take)

    def wait(self, owner: QObject, do: Callable[[], None]) -> None:
        """Do this in its turn, unless its owner has gone by then; what waits already keeps its place."""
        self._waiting.setdefault(do, owner)
        if not self._next.isActive():
            self._next.start()

    def _take(self) -> None:
        do, owner = next(iter(self._waiting.items()))
        del self._waiting[do]
        if self._waiting:
            self._next.start()
        if isValid(owner):
            do()


class ReasonPage(QScrollArea):
    """A text in the middle, which can be rolled where it finds no room; below it buttons that do what helps.

    again    try again, where that may help
    """

    def __init__(self, again: Callable[[], None] | None = None) -> None:
        super().__init__(widgetResizable=True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setMinimumSize(1, 1)  # else a long sentence takes its height and moves the docks
        self.label = QLabel(wordWrap=True, alignment=Qt.AlignmentFlag.AlignCenter)
        self.label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        paper = QWidget()
        column = QVBoxLayout(paper)
        column.addStretch(1)
        column.addWidget(self.label)
        self._buttons = QVBoxLayout()
        self._buttons.setSpacing(4)
        column.addLayout(self._buttons)
        if again is not None:
            self._add("Try again", again)
        column.addStretch(1)
        self.setWidget(paper)
        for widget in (self.viewport(), paper):
            widget.setAutoFillBackground(False)

    def _add(self, text: str, act: Callable[[], None]) -> None:
        button = QPushButton(text)
        button.clicked.connect(lambda: act())
        self._buttons.addWidget(button, 0, Qt.AlignmentFlag.AlignHCenter)

    def offer(self, suggestions: Sequence[Suggestion], host: ViewHost) -> None:
        """Offer a button for each suggestion that this design allows."""
        while (item := self._buttons.takeAt(0)) is not None:
            button: Any = item.widget()
            button.hide()
            button.deleteLater()
        for suggestion in suggestions:
            if host.can(suggestion.entry):
                self._add(suggestion.text, partial(host.do, suggestion.entry))


@frozen
class NumberAtHand:
    """A number that can be explained: its column or figure of the summary, and where it stands: at this angle of the cam or crank, of the
    machine where it is one of the whole shaft [rad]; None: at the angle at hand."""

    name: str
    theta: float | None = None


class ViewHost(Protocol):
    """What a view may ask of the window that shows it."""

    def show_message(self, text: str) -> None:
        """What has been done, in the status line, for a while."""

    def ask(self, text: str) -> None:
        """What is to be done next, in the status line, until it is ``answered``."""

    def answered(self, how: str) -> None:
        """It is done, or given up."""

    def focus_field(self, path: str) -> None:
        """Bring the field of a path, or of a section, before the reader."""

    def show_fields(self, section: str) -> None:
        """Bring the page of a section of the parameters to the front, where they are in sight; the keys stay where they are."""

    def open_design(self, path: Path) -> bool:
        """Open the file of a design in place of the one at hand; False where the user would not, or it cannot be read."""

    def explain(self, number: NumberAtHand) -> None:
        """Show where a number comes from."""

    def pin(self, design: Design | None = None) -> None:
        """Keep a design as it is, that at hand where none is named, and hold what is changed against it."""

    def mend(self, remedy: Remedy) -> None:
        """Do what mends a finding."""

    def can(self, entry: str) -> bool:
        """Whether an entry of the menus can be chosen for the design at hand."""

    def do(self, entry: str) -> None:
        """Choose an entry of the menus, by its key there; of a menu, open it under the mouse."""

    def add_drive_by_picture(self) -> None:
        """One drive more, chosen by its picture."""

    def add_load(self, name: str) -> None:
        """A row more in one of the lists of the loads."""

    def pick_load(self, path: str, key: str) -> None:
        """Let a row of the loads hold on elsewhere, chosen in the drawing."""

    def show_search(self, what: str) -> None:
        """Find, with this wanted where the design has it."""

    def open_load(self, path: str) -> None:
        """Bring the form of a row of the loads before the reader; empty: what belongs to no row."""

    def enable_segment_edits(self, able: dict[str, bool]) -> None:
        """Which edits of a segment make sense now."""


class View(QWidget):
    """A widget over the session's study.

    Subclasses state ``stages``, the stages they read, and implement ``refresh`` (the design changed) and
    ``follow`` (the cam angle changed). Neither is called while the view is hidden or tabbed behind another: it then
    only remembers that it is out of date. Where a stage has no answer the view shows why in place of its content. Where it
    fails itself it shows that there, passes the exception on, and rests until it is tried again or another design begins.

    status_message (str): what has been done, for the status line

    ``of_whole``: it shows something of all drives, so that it follows each step, though the drive at hand stays the same.
    ``not_here``: this kind of design has nothing for the view, which shows a sentence instead.
    ``pause_ms``: a view that is read rather than watched may wait until editing pauses that long; 0 follows each step.
    While the mouse draws in one view, that keeps pace with it; every other follows in its turn (see ``Turns``), and so may parts of
    this one (``in_turn``).
    ``reading_ms``: nor need it show every angle while the cam turns, but one in so long, and the last; 0 shows each.
    """

    status_message = Signal(str)
    stages: tuple[str, ...] = ()
    pause_ms: int = 0
    reading_ms: int = 0
    of_whole: bool = False

    def __init__(self, session: Session, player: Player, content: QWidget | None = None) -> None:
        super().__init__()
        self.session, self.player = session, player
        self._stale, self.not_here = True, False
        self._shown: Study | None = None  # what the content, or the reason in its place, is of
        self._fault: ReasonPage | None = None
        self._trouble: ReasonPage | None = None
        self._content = content if content is not None else QWidget()
        self._stack = QStackedLayout(self)
        self._stack.setContentsMargins(0, 0, 0, 0)
        self._stack.addWidget(self._content)
        self._pause = QTimer(self, singleShot=True, interval=self.pause_ms)
        self._pause.timeout.connect(self._pull_if_seen)
        self._soon = QTimer(self, singleShot=True, interval=0)
        self._soon.timeout.connect(self._pull_if_seen)
        self._turns = Turns.of(session)
        self._reading = QTimer(self, singleShot=True, interval=self.reading_ms)
        self._reading.timeout.connect(self._catch_up)
        self._followed = player.theta
        self._host: ViewHost | None = None
        self._awaits = False  # something that it reads is being computed, or was given up
        session.pending.known.connect(self._read_again)
        session.started.connect(self._forget_fault)
        session.drive_chosen.connect(self._forget_fault)
        (session.full_design_changed if self.of_whole else session.design_changed).connect(self.invalidate)
        TOLD.changed.connect(self.invalidate)
        player.angle_changed.connect(self._angle_changed)
        player.playing_changed.connect(self._cam_rests)

    @property
    def content(self) -> QWidget:
        """What the view shows when nothing is in the way, without the page of reasons."""
        return self._content

    def set_content_layout(self, layout: QLayout) -> None:
        self._content.setLayout(layout)

    def set_column(self, *rows: QWidget | QLayout, grows: QWidget, spacing: int = 0) -> None:
        """The content: these one below the other up to its edges; ``grows`` gets the height that the others leave."""
        column = QVBoxLayout()
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(spacing)
        for row in rows:
            if isinstance(row, QLayout):
                column.addLayout(row)
            else:
                column.addWidget(row, 1 if row is grows else 0)
        self.set_content_layout(column)

    # -- for subclasses -----------------------------------------------------------------------------------

    def belong_to(self, window: ViewHost) -> None:
        """Lead to the window what the view asks of it."""
        self._host = window
        self.status_message.connect(window.show_message)

    def refresh(self, study: Study) -> None:
        """Show this study."""

    def follow(self, theta: float) -> None:
        """Show this cam angle [rad]."""

    def fit(self) -> None:
        """Bring the whole picture into sight."""

    def number_at_hand(self) -> NumberAtHand | None:
        """What Shift+F1 explains here, and the entry of the context menu."""
        return None

    @property
    def host(self) -> ViewHost | None:
        """The window that shows it."""
        return self._host

    def offer_explanation(self, widget: QWidget, text: str = "Explain this value") -> None:
        """An entry of a widget's context menu that explains the number at hand."""
        widget.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)
        action = QAction(text, widget)
        action.triggered.connect(self._explain)
        widget.addAction(action)

    def _explain(self) -> None:
        number = self.number_at_hand()
        if number is None:
            self.status_message.emit("Nothing is computed here that could be explained")
        elif self._host is not None:
            self._host.explain(number)

    def layer_actions(self) -> list[QAction]:
        """Checkable actions that show and hide parts of the picture, for the menu View > Layers."""
        return []

    @property
    def no_picture(self) -> str:
        """Why there is nothing that could be exported as a picture, in a sentence; empty where there is."""
        if not self.in_trouble:
            return ""
        shown = self._stack.currentWidget()
        return (
            shown.label.text() if shown is self._trouble else "This view has failed; Try again in it, or read the log."
        )

    def picture(self, ending: str) -> bytes:
        """What is shown as a file: ``.png`` or ``.svg``."""
        from kindyna_gui.pictures.painter import png, svg

        return self.on_paper(self._content, svg if ending == ".svg" else png)

    def on_paper(self, part: QWidget, paint: Callable[[QWidget], bytes]) -> bytes:
        """A part of the view as a file has it; the view itself is as before."""
        if is_default() and not SCREEN.is_dark:
            return paint(part)
        with on_paper(part):
            self.invalidate()
            self.pull()
            made = paint(part)
        self.invalidate()
        return made

    def show_reason(self, error: KindynaError) -> None:
        """Show in place of the content why there is none."""
        self.not_here = isinstance(error, Unavailable)
        if self._trouble is None:
            self._trouble = ReasonPage()
            self._stack.addWidget(self._trouble)
        self._trouble.label.setText(str(error) if self.not_here else reason(self.session.design, error))
        if self._host is not None:
            self._trouble.offer(suggestions_for(str(error)), self._host)
        self._stack.setCurrentWidget(self._trouble)

    def in_turn(self, do: Callable[[], None]) -> None:
        """Do this part of ``refresh`` between two moves of the mouse."""
        self._turns.wait(self, do)

    # -- when ---------------------------------------------------------------------------------------------

    @property
    def _waits_its_turn(self) -> bool:
        """Whether the mouse draws something in another view than this."""
        at = self.session.drag_source
        return not (at is None or self.pause_ms or at is self or (isinstance(at, QWidget) and self.isAncestorOf(at)))

    @property
    def up_to_date(self) -> bool:
        """False also while a design is in place that the view does not show yet."""
        return not self._stale and self._shown is self.session.study

    def on_screen(self) -> bool:
        """True where something of the view can be seen."""
        return in_sight(self)

    def invalidate(self) -> None:
        """The design changed: refresh now, or when editing pauses, if on screen; else when shown."""
        self._stale = True
        if self._waits_its_turn:
            self._turns.wait(self, self._take_turn)
        elif self.on_screen():
            if self.pause_ms:
                self._pause.start()
            else:
                self.pull()

    def pull(self) -> None:
        """Refresh if out of date."""
        if not self._stale or self._fault is not None:
            return
        self._stale, self.not_here = False, False
        self._soon.stop()
        self._shown = self.session.study
        try:
            with postponing(self._later):
                self.refresh(self._shown)
                self._stack.setCurrentWidget(self._content)
                self._followed = self.player.theta
                self.follow(self._followed)
        except KindynaError as error:
            self.show_reason(error)
        except Exception as error:
            self._fail(error)
            raise

    def _follow(self) -> None:
        """Show the cam angle at hand."""
        self._followed = self.player.theta
        try:
            with postponing(self._later):
                self.follow(self._followed)
        except Exception as error:
            self._fail(error)
            raise

    def _later(self, key: Hashable, compute: Callable[[], Any]) -> str:
        """What is read may take long: it is computed beside the window, and shown once it is there."""
        state = self.session.pending.later(key, compute)
        self._awaits = self._awaits or bool(state)
        return state

    def _read_again(self) -> None:
        if self._awaits:
            self._awaits = False
            self.invalidate()

    def _fail(self, error: Exception) -> None:
        """Show in place of the content that the view has failed."""
        if self._fault is None:
            self._fault = ReasonPage(self._try_again)
            self._fault.label.setText(f"This view has failed ({short(error)}). The rest of the window works on.")
            self._stack.addWidget(self._fault)
        self._stack.setCurrentWidget(self._fault)

    def _forget_fault(self) -> None:
        if self._fault is not None:
            self._stack.removeWidget(self._fault)
            self._fault.deleteLater()
            self._fault = None

    def _try_again(self) -> None:
        self._forget_fault()
        self._stale = True
        self.pull()

    def settle(self) -> None:
        """Do now what waits for a pause."""
        self._cam_rests()

    def leave(self) -> None:
        """The window closes: nothing may be computed beside it any longer."""

    @property
    def busy(self) -> bool:
        """Whether something shown is still being computed beside the window, or waits for the cam to rest."""
        return self._reading.isActive() and self._followed != self.player.theta

    @property
    def in_trouble(self) -> bool:
        """Whether the view shows why it has nothing to show."""
        return self._stack.currentWidget() is not self._content

    def wake(self) -> None:
        """The view may have come into sight: catch up once the events at hand are done, what is read rather than watched
        after all others have been painted."""
        if self._stale and self._waits_its_turn:
            self._turns.wait(self, self._take_turn)
        elif self.pause_ms and self._stale:
            soon(self, self._soon.start)
        else:
            self._soon.start()

    def _angle_changed(self, theta: float) -> None:
        # a design with other ranges moves the angle before the views know it; then ``pull`` follows
        if self._reading.isActive():
            return
        if self.up_to_date and not self.in_trouble and self.on_screen():
            if self.reading_ms:
                self._reading.start()
            self._follow()

    def _cam_rests(self) -> None:
        self._reading.stop()
        self._catch_up()

    def _catch_up(self) -> None:
        """Show the angle at hand where it has been left out so far."""
        if self._followed != self.player.theta:
            self._angle_changed(self.player.theta)

    def _take_turn(self) -> None:
        if self._stale and self.on_screen():
            self.pull()

    def _pull_if_seen(self) -> None:
        if not self.on_screen():
            return
        if self._stale:
            self.pull()
        elif not self.in_trouble:
            self._follow()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self.wake()

    def event(self, event: QEvent) -> bool:
        # coming to the front of a stack sends no showEvent, but paints
        if event.type() == QEvent.Type.Paint and self._stale and not self._pause.isActive():
            self.wake()
        return super().event(event)


# -- background view -------------------------------------------------------------------------------------


class BackgroundView(View):
    """``refresh`` starts the jobs. Another design, a reason for nothing, or a view that is hidden ends what is being computed."""

    def __init__(self, session: Session, player: Player, poll_ms: int | None = None) -> None:
        super().__init__(session, player)
        self._work = Background(self) if poll_ms is None else Background(self, poll_ms)

    def _rest(self) -> None:
        """Nothing is being computed any longer."""
        self._work.stop()

    def invalidate(self) -> None:
        self._rest()
        super().invalidate()

    def show_reason(self, error: KindynaError) -> None:
        self._rest()
        super().show_reason(error)

    @property
    def busy(self) -> bool:
        return self._pause.isActive() or self._work.busy

    def settle(self) -> None:
        super().settle()
        if self._pause.isActive():
            self._pause.stop()
            self.pull()

    def leave(self) -> None:
        self._work.close()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        if self._work.busy:
            self._rest()
            self._stale = True
