"""Uncaught exceptions: they are logged and shown, and the design returns to its state before the action.

Python passes an exception of a slot, an event handler or a timer to ``sys.excepthook``, one that it cannot raise, as in
a finalizer, to ``sys.unraisablehook``, and one of a thread to ``threading.excepthook``. All three call a window's
``Faults``.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from types import TracebackType
from typing import Any
from weakref import ref

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QApplication, QDialog
from shiboken6 import isValid

from core.frozen import frozen
from kindyna_gui.documents.edits import Refusal
from kindyna_gui.documents.session import Work
from kindyna_gui.fault_log import FaultLog, short
from kindyna_gui.look import Note
from kindyna_gui.rebuilt import connect_all, single_shot
from kindyna_gui.view import View
from kindyna_gui.window.base import Window, title_of
from kindyna_gui.window.docks import VIEWS


@frozen
class _State:
    """A state of the design without a fault: its document, and its index on the undo stack."""

    document: int
    index: int
    work: Work


class Faults(QObject):
    """The faults of one window, until it is closed.

    A design is good once the event that changed it has ended without a fault. After a fault the undo stack goes back to
    the last good design, so that Redo repeats the step. A document that was opened stays open.

    Signal ``status_message``: a sentence that says what failed.
    """

    status_message = Signal(str)
    _in_thread = Signal(str)

    def __init__(self, window: Window) -> None:
        super().__init__(window)
        self._window, self._session = window, window.session
        self.log = FaultLog()
        self._good = self._current()
        self._action = ""  # menu entry of the current event
        self._failures: list[tuple[str, str]] = []  # of the current event: title of the view, exception in one line
        self._going_back = False
        self._event_end = single_shot(self, self._settle)
        connect_all(
            (self._session.stack.indexChanged, self._step_taken),
            (self._session.design_changed, self._event_end.start),
            (self._session.incomplete_changed, self._event_end.start),
            (self._session.refused, self._refused),
            (window.menuBar().triggered, self._chosen),
            (self._in_thread, self._report),
        )
        _install(self)

    # -- actions of the user, for the log -----------------------------------------------------------------

    def _chosen(self, action: QAction) -> None:
        self._action = action.text().replace("&&", "\0").replace("&", "").replace("\0", "&").rstrip(".")
        self.log.note(f"Menu: {self._action}")
        self._event_end.start()

    def _step_taken(self, index: int) -> None:
        if index:
            self.log.note(f"Step {index}: {self._session.stack.text(index - 1)}")
        self._event_end.start()

    def _refused(self, refusal: Refusal) -> None:
        self.log.note(f"Refused: {refusal.path}")

    # -- faults -------------------------------------------------------------------------------------------

    def handle(self, error: BaseException) -> None:
        """Handle an exception raised in the window's own thread."""
        if not self._going_back:  # else one is shown already
            self._failures.append((self._view_of(error.__traceback__), short(error)))
            self._event_end.start()
        self.log.write(error, self._state())

    def handle_in_thread(self, error: BaseException, thread: str) -> None:
        """Handle an exception raised in another thread, from which no widget may be used."""
        self.log.write(error, f"In the thread {thread}")
        self._in_thread.emit(f"A calculation in the background failed ({short(error)}). See Help > Log.")

    def _view_of(self, trace: TracebackType | None) -> str:
        """The title of the innermost view in a traceback; empty where there is none."""
        title = ""
        while trace is not None:
            view = trace.tb_frame.f_locals.get("self")
            if isinstance(view, View):
                title = next((title_of(n, self._session.design) for n in VIEWS if self._window.view(n) is view), title)
            trace = trace.tb_next
        return title

    def _state(self) -> str:
        session, focus = self._session, QApplication.focusWidget()
        rows = {
            "Design": f"{session.full_design.name}, {session.path or 'without a file'}, step {session.stack.index()}",
            "Angle": f"{self._window.player.theta:.9g} rad{', playing' if self._window.player.playing else ''}",
            "Focus": f"{type(focus).__name__} {focus.objectName() or focus.accessibleName()}"
            if focus is not None
            else "none",
        }
        return "\n".join(f"{name}: {text}" for name, text in rows.items())

    # -- at the end of the event --------------------------------------------------------------------------

    def _current(self) -> _State:
        return _State(self._session.document, self._session.stack.index(), self._session.work)

    def _settle(self) -> None:
        """Accept the design if the event had no fault, else go back and report."""
        failures, self._failures = self._failures, []
        action, self._action = self._action, ""
        if failures:
            self._going_back = True
            try:
                step, again = self._go_back()
            finally:
                self._going_back = False
                self._good = self._current()  # also where going back failed: it is not tried again
            sentence = _sentence(failures, step or action, again)
            if step:
                self.log.add(sentence)
            self._report(sentence)
        else:
            self._good = self._current()

    def _go_back(self) -> tuple[str, str]:
        """Return to the last good design.

        Returns the name of the step undone and the menu entry that repeats it, empty where the design has not changed.
        """
        session, stack, good = self._session, self._session.stack, self._good
        if session.document != good.document or all(
            now is then for now, then in zip(self._session.work, good.work, strict=True)
        ):
            return "", ""
        index = stack.index()
        step, again = (f"Undo {stack.redoText()}", "Undo") if index < good.index else (stack.undoText(), "Redo")
        stack.setIndex(good.index)
        if self._session.work != good.work:  # a later part of a gesture, which is one step with its beginning
            session.step_to(good.work, step)
            again = "Undo"
        session.end_gesture()
        return step, again

    def _report(self, sentence: str) -> None:
        """Show a sentence in the front dialog, if any, and in the status line."""
        front = QApplication.activeModalWidget() or QApplication.activeWindow()
        if isinstance(front, QDialog) and (layout := front.layout()) is not None:
            note = front.findChild(Note, "fault")
            if note is None:
                note = Note()
                note.setObjectName("fault")
                layout.addWidget(note)
            note.show_message(sentence)
        self._window.status.show_fault(sentence)
        log_view = self._window.view("log")
        if log_view is not None:
            log_view.invalidate()
        self.status_message.emit(sentence)


def _sentence(failures: list[tuple[str, str]], action: str, again: str) -> str:
    """Say what failed, where, why, and that the design is as before."""
    view, why = failures[0]
    what = f"{action} failed in {view}" if action and view else f"{action or view or 'The window'} failed"
    more = f", and {len(failures) - 1} more" if len(failures) > 1 else ""
    end = f"; {again} repeats the change" if again else ""
    return f"{what} ({why}{more}). The design is as it was before{end}. See Help > Log."


# -- Python's hooks -------------------------------------------------------------------------------------------


def _install(faults: Faults) -> None:
    """Set Python's three hooks to call the previous hooks and then the window, while it exists."""
    window = ref(faults)

    def forward(error: BaseException | None, report: Callable[[Faults, BaseException], None]) -> None:
        listener = window()
        if error is None or isinstance(error, KeyboardInterrupt | SystemExit):
            return
        if listener is not None and isValid(listener):
            report(listener, error)

    def uncaught(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        before[0](kind, error, trace)
        forward(error, Faults.handle)
        for name in ("last_type", "last_value", "last_traceback"):  # their frames would keep widgets alive
            vars(sys).pop(name, None)

    def unraisable(args: Any) -> None:
        before[1](args)
        in_main = threading.current_thread() is threading.main_thread()
        forward(
            args.exc_value,
            Faults.handle if in_main else lambda f, e: f.handle_in_thread(e, threading.current_thread().name),
        )

    def in_thread(args: Any) -> None:
        before[2](args)
        forward(
            args.exc_value,
            lambda f, e: f.handle_in_thread(e, args.thread.name if args.thread is not None else "unknown"),
        )

    before: tuple[Any, Any, Any] = (sys.excepthook, sys.unraisablehook, threading.excepthook)
    after = (uncaught, unraisable, in_thread)
    sys.excepthook, sys.unraisablehook, threading.excepthook = after

    def restore(_: object = None) -> None:
        """Restore the previous hooks, except those that were replaced since."""
        if sys.excepthook is uncaught:
            sys.excepthook = before[0]
        if sys.unraisablehook is unraisable:
            sys.unraisablehook = before[1]
        if threading.excepthook is in_thread:
            threading.excepthook = before[2]

    faults.destroyed.connect(restore)


__all__ = ["Faults"]
