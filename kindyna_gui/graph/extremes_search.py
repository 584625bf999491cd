"""Refined extremes of what plots show: looked for beside the window once editing pauses, and marked unless that is switched off."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtGui import QAction

from core.errors import KindynaError
from core.motion.extremes import Extremes
from core.study import Quantity, Study
from kindyna_gui.background import Background
from kindyna_gui.documents.session import Session
from kindyna_gui.pictures.plots.curves import channel_extremes

PAUSE_MS = 250  # of editing
NAME = "mark extremes"


def marks_action(session: Session) -> QAction:
    """Whether the plots of a window mark extremes: one switch for all of them."""
    action = session.findChild(QAction, NAME)
    if not isinstance(action, QAction):
        action = QAction("Mark extremes", session, checkable=True, checked=True)
        action.setObjectName(NAME)
        action.setStatusTip("Mark the highest and the lowest value of each curve")
    return action


class ExtremesSearch(QObject):
    """The extremes of the channels that one view shows, of the last design that was wanted.

    found   quantity -> its extremes
    """

    found = Signal(object)

    def __init__(self, parent: QObject, session: Session) -> None:
        super().__init__(parent)
        self._session = session
        self._wanted: tuple[Study, tuple[Quantity, ...]] | None = None
        self._done = False
        self._background = Background(self)
        self._background.result.connect(self._answered)
        self._pause = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._pause.timeout.connect(self._begin)

    @property
    def busy(self) -> bool:
        return self._pause.isActive() or self._background.busy

    def want(self, study: Study, rows: Sequence[Quantity]) -> None:
        """Look for the extremes of these channels once editing pauses; those wanted before are given up."""
        self._background.stop()
        self._wanted, self._done = (study, tuple(rows)), not rows
        self._pause.start() if rows else self._pause.stop()

    def resume(self) -> None:
        """Go on where it was given up."""
        if self._wanted is not None and not self._done and not self.busy:
            self._pause.start()

    def settle(self) -> None:
        """Do now what waits for a pause."""
        if self._pause.isActive():
            self._pause.stop()
            self._begin()

    def stop(self) -> None:
        """Give up what is not found yet."""
        self._pause.stop()
        self._background.stop()

    def close(self) -> None:
        """Give it up, and be sure that nothing is computed any longer."""
        self.stop()
        self._background.close()

    def _begin(self) -> None:
        if self._session.held is not None:  # the mouse draws on: the design at hand is soon another
            self._pause.start()
        elif self._wanted is not None:
            self._background.start([(self._wanted[0], partial(channel_extremes, *self._wanted))])

    def _answered(self, study: Study, made: Mapping[str, Extremes] | KindynaError) -> None:
        if self._wanted is not None and study is self._wanted[0] and not isinstance(made, Exception):
            self._done = True
            self.found.emit(made)


__all__ = ["ExtremesSearch", "marks_action"]
