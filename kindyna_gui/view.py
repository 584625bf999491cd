"""Base classes of the views: when a view refreshes, and what it shows in place of a missing result.

A view refreshes only while something of it can be seen. Where a stage has no solution it shows the reason, where the
view itself fails it shows the fault.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from PySide6.QtCore import QElapsedTimer, QEvent, QObject, Qt, Signal
from PySide6.QtGui import QAction, QHideEvent, QShowEvent
from PySide6.QtWidgets import (
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
from kindyna_gui.background import Background, attempt
from kindyna_gui.documents.session import Session
from kindyna_gui.fault_log import short
from kindyna_gui.labels import reason
from kindyna_gui.look import ThemedPart, on_paper
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import STRETCH, call_soon, connect_all, fill, is_in_sight, single_shot, widget_with
from kindyna_gui.requirements import Suggestion, Unavailable, suggestions_for
from kindyna_gui.settings import DISPLAY, is_default

if TYPE_CHECKING:  # imported when first used
    from kindyna_gui.drawing_overlay import MechanismDrawing

AFTER_DRAG_MS = 50  # from the end of a drag until the views with a pause refresh
FRAME_MS = 16  # while the mouse drags something: from one drawing of its view to the next
TURN_MS = 32  # and from the refresh of another view to that of the next

# -- queue of refreshes ----------------------------------------------------------------------------------


class RefreshQueue(QObject):
    """Queue of the refreshes that may lag behind a drag of the mouse or steps by key, one queue for all views of a session.

    The jobs run one at a time, the oldest first; while the mouse drags something, ``TURN_MS`` apart, and while keys step a
    number, once they rest. Mouse moves that arrived meanwhile are handled after each job.
    """

    @staticmethod
    def of(session: Session) -> RefreshQueue:
        """Return the queue of a session."""
        return session.findChild(RefreshQueue) or RefreshQueue(session)

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._session = session
        self._waiting: dict[Callable[[], None], QObject] = {}
        self._next = single_shot(self, self._run_next)
        self._last = started_clock()
        session.drag_ended.connect(self._go_on)
        session.steps_ended.connect(self._go_on)

    def append(self, owner: QObject, job: Callable[[], None]) -> None:
        """Append a job, which is skipped if its owner is deleted first; a job in the queue keeps its position."""
        self._waiting.setdefault(job, owner)
        if not self._next.isActive():
            self._go_on()

    def _go_on(self) -> None:
        if self._session.is_stepping:
            self._next.stop()
        elif self._waiting:
            self._next.start(0 if self._session.drag_source is None else rest(self._last, TURN_MS))

    def _run_next(self) -> None:
        job, owner = next(iter(self._waiting.items()))
        del self._waiting[job]
        if isValid(owner):
            job()
        self._last.restart()
        self._go_on()


def started_clock() -> QElapsedTimer:
    """Return a clock that runs."""
    clock = QElapsedTimer()
    clock.start()
    return clock


def rest(clock: QElapsedTimer, pause_ms: int) -> int:
    """Return how much of a pause has not yet passed on a clock [ms]."""
    return max(0, pause_ms - clock.elapsed())


# -- page in place of a view's content -------------------------------------------------------------------


class ReasonPage(QScrollArea):
    """A centred text that scrolls where it is too long, with buttons for the remedies below it.

    ``retry``: called by a button "Try again"; None: no such button.
    """

    def __init__(self, retry: Callable[[], None] | None = None) -> None:
        super().__init__(widgetResizable=True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setMinimumSize(1, 1)  # else a long sentence takes its height and moves the docks
        self.label = QLabel(
            wordWrap=True,
            alignment=Qt.AlignmentFlag.AlignCenter,
            textInteractionFlags=Qt.TextInteractionFlag.TextSelectableByMouse,
        )
        self._offered: list[Suggestion] = []
        self._buttons = fill(QVBoxLayout(), spacing=4)
        if retry is not None:
            self._add("Try again", retry)
        paper = widget_with(fill(QVBoxLayout(), STRETCH, self.label, self._buttons, STRETCH))
        self.setWidget(paper)
        for widget in (self.viewport(), paper):
            widget.setAutoFillBackground(False)

    def _add(self, text: str, action: Callable[[], None]) -> None:
        button = QPushButton(text)
        button.clicked.connect(lambda: action())
        self._buttons.addWidget(button, 0, Qt.AlignmentFlag.AlignHCenter)

    def height_for(self, width: int) -> int:
        """Height at which all of it is shown in this width [pixels]."""
        paper: Any = self.widget()
        height: int = paper.layout().totalHeightForWidth(width)
        return height

    def offer(self, suggestions: Sequence[Suggestion], host: ViewHost) -> None:
        """Offer a button for each suggestion that this design allows."""
        offered = [suggestion for suggestion in suggestions if host.can(suggestion.entry)]
        if offered == self._offered:  # new buttons would lay out and paint the page again, after each edit
            return
        self._offered = offered
        while (item := self._buttons.takeAt(0)) is not None:
            button: Any = item.widget()
            button.hide()
            button.deleteLater()
        for suggestion in offered:
            self._add(suggestion.text, partial(host.do, suggestion.entry))


# -- what a view requires of its window ------------------------------------------------------------------


@frozen
class ExplainableNumber:
    """A number that can be explained.

    ``name``: its column, or its key in the summary. ``theta``: cam or crank angle [rad], machine angle for a number of
    all drives; None: the current angle.
    """

    name: str
    theta: float | None = None


class ViewHost(Protocol):
    """What a view can request from the window that shows it."""

    def show_message(self, text: str) -> None:
        """Show in the status line, for a while, what has been done."""

    def ask(self, text: str) -> None:
        """Show in the status line what the user does next, until ``answered`` is called."""

    def answered(self, how: str) -> None:
        """Remove the request of ``ask``: it is done, or cancelled."""

    def focus_field(self, path: str) -> None:
        """Show the field of a path, or of a section, and give it the focus."""

    def drawing(self, in_front: bool = False) -> MechanismDrawing:
        """Return the drawing of the mechanism, and bring it to the front."""

    def close_view(self, name: str) -> None:
        """Close the dock of a view."""

    def show_fields(self, section: str) -> None:
        """Show the page of a section if the parameters are in sight; the focus does not change."""

    def open_design(self, path: Path) -> bool:
        """Open a design file in place of the current design; False where the user cancels or it cannot be read."""

    def explain(self, number: ExplainableNumber) -> None:
        """Show how a number is calculated."""

    def show_result(self, result: str) -> None:
        """Bring the curve of a result to the front: of a column, with the slug of its drive before a dot, or of a figure."""

    def pin(self, design: Design | None = None) -> None:
        """Pin a design, by default the current one, to compare later changes with it."""

    def apply_remedy(self, remedy: Remedy) -> None:
        """Apply the remedy of a finding."""

    def can(self, entry: str) -> bool:
        """Whether a menu entry is enabled for the current design."""

    def do(self, entry: str) -> None:
        """Trigger a menu entry by its key; a menu opens under the mouse."""

    def add_drive_by_picture(self) -> None:
        """Add a drive that the user selects by its picture."""

    def add_load(self, name: str) -> None:
        """Add a row to one of the lists of loads."""

    def pick_load(self, path: str, key: str) -> None:
        """Let the user select in the drawing where a load is attached."""

    def show_search(self, what: str) -> None:
        """Open Find with this search selected, where the design has it."""

    def open_load(self, path: str) -> None:
        """Show the form of a load; empty: the fields that belong to no row."""

    def enable_segment_edits(self, able: dict[str, bool]) -> None:
        """Enable the edits of a segment that are possible now."""


# -- view ------------------------------------------------------------------------------------------------


class View(ThemedPart):
    """A widget that shows results of the session's study.

    Subclasses name in ``stages`` the stages they read, and implement ``refresh`` (the design changed) and ``follow``
    (the cam angle changed). Neither is called while the view is hidden or tabbed behind another; the view then only
    notes that it is out of date. Where a stage has no solution the view shows the reason in place of its content.
    Where the view itself fails it shows the fault, raises the exception again, and waits for "Try again" or another
    design.

    While the mouse drags something in one view, that view follows every move. All other views refresh through the
    ``RefreshQueue``, as can parts of the first one (``refresh_in_turn``). While keys step a number, so does a view that
    ``is_slow``.

    - status_message (str): what has been done, for the status line
    - ``is_design_wide``: shows all drives, so it refreshes after a change of any drive
    - ``is_unavailable``: this kind of design has nothing for the view, which shows a sentence instead
    - ``pause_ms``: refresh once editing pauses that long, and soon after the mouse releases what it drags; 0: after each step
    - ``arranges_itself``: its parts are next to each other only where they have room, so that ``minimumSizeHint`` follows the
      width
    - ``reading_ms``: shortest time between two angles shown while the cam turns; 0: every angle
    """

    status_message = Signal(str)
    stages: tuple[str, ...] = ()
    pause_ms: int = 0
    reading_ms: int = 0
    is_design_wide: bool = False
    arranges_itself: bool = False

    def __init__(self, session: Session, player: Player, content: QWidget | None = None) -> None:
        super().__init__()
        self.session, self.player = session, player
        self._stale, self.is_unavailable = True, False
        self._shown: Study | None = None  # the study of the content, or of the reason in its place
        self._shown_parts: Hashable = None  # of that study, what the content depends on
        self._fault: ReasonPage | None = None
        self._trouble: ReasonPage | None = None
        # shows the results, without the pages for reasons and faults
        self.content = content if content is not None else QWidget()
        self._stack = fill(QStackedLayout(self), self.content, margins=0)
        self._pause = single_shot(self, self._pull_if_seen, self.pause_ms)
        self._soon = single_shot(self, self._pull_if_seen)
        self._last_pull = started_clock()
        self._queue = RefreshQueue.of(session)
        self._preparing = Background(self)
        self._preparing.result.connect(self._prepared)
        self._reading = single_shot(self, self._catch_up, self.reading_ms)
        self._followed = player.theta
        self._host: ViewHost | None = None
        self._awaits = False  # a result that it reads is being calculated, or was cancelled
        connect_all(
            (session.pending.known, self._read_again),
            (session.drag_ended, self._drag_ended),
            (session.started, self._forget_fault),
            (session.drive_chosen, self._forget_fault),
            (session.full_design_changed if self.is_design_wide else session.design_changed, self._design_changed),
            (DISPLAY.changed, self.invalidate),
            (player.angle_changed, self._angle_changed),
            (player.playing_changed, self._show_last_angle),
        )

    def set_content_layout(self, layout: QLayout) -> None:
        """Set the layout of the content."""
        self.content.setLayout(layout)

    def set_column(self, *rows: QWidget | QLayout, grows: QWidget, spacing: int = 0) -> None:
        """Fill the content with rows, without margins; ``grows`` takes the remaining height."""
        parts = ((row, 1) if row is grows else row for row in rows)
        self.set_content_layout(fill(QVBoxLayout(), *parts, margins=0, spacing=spacing))

    # -- for subclasses -----------------------------------------------------------------------------------

    def belong_to(self, window: ViewHost) -> None:
        """Connect the view's requests to the window that shows it."""
        self._host = window
        self.status_message.connect(window.show_message)

    def refresh(self, study: Study) -> None:
        """Show this study."""

    def follow(self, theta: float) -> None:
        """Show this cam angle [rad]."""

    def shown_parts(self, study: Study) -> Hashable:
        """Return all that the content depends on; an edit that leaves it equal does not refresh the view. None: every edit does."""
        return None

    def preparation(self) -> Callable[[], Any] | None:
        """Return a slow calculation whose results ``refresh`` reads from the caches; None: ``refresh`` is fast.

        It runs in a worker thread before ``refresh``, must not use a Qt object, and is dropped for a newer design.
        """
        return None

    @property
    def is_slow(self) -> bool:
        """Whether the view shows results that are too slow for each step by key."""
        return False

    def show_outdated(self) -> None:
        """Remove the values of an earlier design, until the view refreshes; what is not a value may stay."""

    def fit(self) -> None:
        """Zoom to show all of the drawing."""

    def selected_number(self) -> ExplainableNumber | None:
        """Return the number that Shift+F1 and the context menu explain."""
        return None

    @property
    def host(self) -> ViewHost | None:
        """The window that shows the view."""
        return self._host

    def offer_explanation(self, widget: QWidget, text: str = "Explain this value") -> None:
        """Add an entry to a widget's context menu that explains the selected number."""
        widget.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)
        action = QAction(text, widget)
        action.triggered.connect(self._explain)
        widget.addAction(action)

    def _explain(self) -> None:
        number = self.selected_number()
        if number is None:
            self.status_message.emit("Select a computed value to explain it")
        elif self._host is not None:
            self._host.explain(number)

    def layer_actions(self) -> list[QAction]:
        """Return checkable actions that show and hide parts of the drawing, for the menu View > Layers."""
        return []

    @property
    def no_picture(self) -> str:
        """Why the view cannot be exported as a picture, in a sentence; empty where it can."""
        if not self.in_trouble:
            return ""
        page = self._stack.currentWidget()
        return page.label.text() if page is self._trouble else "This view has failed. Press Try again, or see the log."

    def picture(self, ending: str) -> bytes:
        """Return the content as an image file, ``.png`` or ``.svg``."""
        from kindyna_gui.pictures.painter import png, svg

        return self.on_paper(self.content, svg if ending == ".svg" else png)

    def on_paper(self, part: QWidget, paint: Callable[[QWidget], bytes]) -> bytes:
        """Paint a part of the view in the colours and units of files; the view itself does not change."""
        self.show_theme()
        if is_default() and not SCREEN.is_dark:
            return paint(part)
        with on_paper(part):
            self.invalidate()
            self.pull()
            content = paint(part)
        self.invalidate()
        return content

    def show_reason(self, error: KindynaError) -> None:
        """Show the reason for a missing result in place of the content."""
        self.is_unavailable = isinstance(error, Unavailable)
        if self._trouble is None:
            self._trouble = ReasonPage()
            self._stack.addWidget(self._trouble)
        self._trouble.label.setText(str(error) if self.is_unavailable else reason(self.session.design, error))
        if self._host is not None:
            self._trouble.offer(suggestions_for(str(error)), self._host)
        self._stack.setCurrentWidget(self._trouble)

    def refresh_in_turn(self, job: Callable[[], None]) -> None:
        """Run this part of ``refresh`` between two moves of the mouse."""
        self._queue.append(self, job)

    # -- time of a refresh ----------------------------------------------------------------------------------

    @property
    def _is_drag_elsewhere(self) -> bool:
        """Whether the mouse drags something in another view."""
        source = self.session.drag_source
        is_here = source is self or (isinstance(source, QWidget) and self.isAncestorOf(source))
        return source is not None and not is_here

    @property
    def _is_queued(self) -> bool:
        """Whether the view refreshes through the queue: the mouse drags something in another view, or keys step a number."""
        return not self.pause_ms and (self._is_drag_elsewhere or self._waits_for_keys)

    @property
    def _waits_for_keys(self) -> bool:
        return self.session.is_stepping and self.is_slow

    @property
    def _waits_for_release(self) -> bool:
        """Whether the view refreshes only after the end of a drag."""
        return self.pause_ms > 0 and self._is_drag_elsewhere

    @property
    def up_to_date(self) -> bool:
        """Whether the view shows the current study."""
        return not self._stale and self._shown is self.session.study

    def on_screen(self) -> bool:
        """Whether something of the view can be seen."""
        return is_in_sight(self)

    def invalidate(self) -> None:
        """Refresh now, or once editing pauses, if the view is on screen; else when it is shown."""
        is_first, self._stale = not self._stale, True
        self._preparing.stop()
        if self._is_queued:
            if is_first and self._waits_for_keys and self.on_screen():
                self.show_outdated()
            self._queue.append(self, self._refresh_from_queue)
        elif self.on_screen():
            if self.pause_ms:
                self._pause.start(self.pause_ms)
            elif self.session.drag_source is None:
                self.pull()
            elif not self._soon.isActive():
                self._pull_in_time()

    def _pull_in_time(self) -> None:
        """Refresh during a drag: now, or once the mouse has had its time."""
        if wait := rest(self._last_pull, FRAME_MS):
            self._soon.start(wait)
        else:
            self.pull()

    def _design_changed(self) -> None:
        """Refresh the view, unless the change concerns nothing that it shows."""
        study = self.session.study
        parts = None if self._stale or self._shown_parts is None else self.shown_parts(study)
        if parts is None or parts != self._shown_parts:
            self.invalidate()
        else:
            self._shown = study
            self._catch_up()

    def _drag_ended(self) -> None:
        if not self._stale or not self.on_screen():
            return
        if self.pause_ms:
            self._pause.start(AFTER_DRAG_MS)
        elif self._soon.isActive():
            self.pull()

    def pull(self) -> None:
        """Refresh if the view is out of date."""
        if not self._stale:
            self._catch_up()
        if not self._stale or self._fault is not None:
            return
        self._stale, self.is_unavailable = False, False
        self._soon.stop()
        self._preparing.stop()
        self._shown, self._shown_parts = self.session.study, None
        try:
            self.session.require_laws()
            with postponing(self._later):
                self.refresh(self._shown)
                self._shown_parts = self.shown_parts(self._shown)
                self._stack.setCurrentWidget(self.content)
                self._followed = self.player.theta
                self.follow(self._followed)
        except KindynaError as error:
            self.show_reason(error)
        except Exception as error:
            self._fail(error)
            raise
        self._last_pull.restart()

    def _follow(self) -> None:
        """Show the current cam angle."""
        self._followed = self.player.theta
        try:
            with postponing(self._later):
                self.follow(self._followed)
        except Exception as error:
            self._fail(error)
            raise

    def _later(self, key: Hashable, compute: Callable[[], Any]) -> str:
        """Calculate a slow result in the background; the view refreshes once it is known."""
        state = self.session.pending.later(key, compute)
        self._awaits = self._awaits or bool(state)
        return state

    def _read_again(self) -> None:
        if self._awaits:
            self._awaits = False
            self.invalidate()

    def _fail(self, error: Exception) -> None:
        """Show the fault in place of the content."""
        if self._fault is None:
            self._fault = ReasonPage(self._try_again)
            self._fault.label.setText(f"This view has failed ({short(error)}). The rest of the window still works.")
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
        """Run now what waits for a pause in editing."""
        self._show_last_angle()

    def leave(self) -> None:
        """Stop all calculations in the background, because the window closes."""
        self._preparing.close()

    @property
    def busy(self) -> bool:
        """Whether something shown is being calculated in the background, or waits for the cam to stop."""
        return self._preparing.busy or (self._reading.isActive() and self._followed != self.player.theta)

    @property
    def in_trouble(self) -> bool:
        """Whether the view shows a reason or a fault in place of its content."""
        return self._stack.currentWidget() is not self.content

    def wake(self) -> None:
        """Refresh a view that may have come into sight, once the current events are handled.

        Views with a ``pause_ms`` refresh after all others are painted.
        """
        if self.on_screen():
            self.show_theme()
        if self._stale and self._is_queued:
            self._queue.append(self, self._refresh_from_queue)
        elif self.pause_ms and self._stale:
            call_soon(self, partial(self._soon.start, 0))
        else:
            self._soon.start(0)

    def _angle_changed(self, theta: float) -> None:
        # a design with other ranges moves the angle before the views know it; then ``pull`` follows
        if self._reading.isActive():
            return
        if self.up_to_date and not self.in_trouble and self.on_screen():
            if self.reading_ms:
                self._reading.start()
            self._follow()

    def _show_last_angle(self) -> None:
        self._reading.stop()
        self._catch_up()

    def _catch_up(self) -> None:
        """Show the current angle if it was skipped."""
        if self._followed != self.player.theta:
            self._angle_changed(self.player.theta)

    def _refresh_from_queue(self) -> None:
        if self._stale and self.on_screen():
            self.pull()

    def _pull_if_seen(self) -> None:
        if self._waits_for_release or not self.on_screen():
            return
        if self._stale:
            self._pull_prepared()
        elif not self.in_trouble:
            self._follow()

    def _pull_prepared(self) -> None:
        """Refresh once the slow part is calculated."""
        compute = self.preparation() if self.session.has_laws else None
        if compute is None:
            self.pull()
        elif not self._preparing.busy:
            self._preparing.start([(self.session.full_study, partial(attempt, compute))])

    def _prepared(self, study: Study, _: object) -> None:
        if study is self.session.full_study and self.on_screen() and not self._waits_for_release:
            self.pull()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        self._preparing.stop()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self.wake()

    def event(self, event: QEvent) -> bool:
        # coming to the front of a stack sends no showEvent, but paints
        is_painted = event.type() == QEvent.Type.Paint
        if is_painted and self._stale and not self._pause.isActive() and not self._waits_for_release:
            self.wake()
        return super().event(event)


# -- background view -------------------------------------------------------------------------------------


class BackgroundView(View):
    """A view whose ``refresh`` starts jobs in the background.

    A change of the design, a reason in place of the content, and hiding the view stop the jobs.
    """

    def __init__(self, session: Session, player: Player, poll_ms: int | None = None) -> None:
        super().__init__(session, player)
        self._work = Background(self) if poll_ms is None else Background(self, poll_ms)

    def _stop_work(self) -> None:
        """Stop the calculation in the background."""
        self._work.stop()

    def invalidate(self) -> None:
        self._stop_work()
        super().invalidate()

    def show_reason(self, error: KindynaError) -> None:
        self._stop_work()
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
            self._stop_work()
            self._stale = True
