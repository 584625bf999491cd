"""Computing beside the window: what is asked anew stops what is still being computed for an older question.

What may take its time is not computed in the window's own thread, and what is no longer wanted not to its end.

The other threads never touch an object of Qt: answers wait in a queue until the window looks. Nor do they tidy up (see
``tidying``).
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from queue import Empty, SimpleQueue
from threading import Lock, Thread
from typing import Any

from PySide6.QtCore import QObject, QTimer, Signal

from core.errors import KindynaError

Job = tuple[Any, Callable[[], Any]]
"""What is asked, and what answers it; neither may hold an object of Qt."""
LOOK_MS = 3  # between looks at the queue
PATIENCE = 5.0  # seconds for a stopped errand to end: it may be waiting for a module to be imported


class Errand(Thread):
    """Jobs one after the other, in a thread that can be ended at any moment."""

    def __init__(self, jobs: Sequence[Job]) -> None:
        super().__init__(daemon=True)
        self.found: SimpleQueue[tuple[Any, Any]] = SimpleQueue()
        self._jobs = tuple(jobs)
        self._gate = Lock()
        self._inside = self._ended = False

    def run(self) -> None:
        try:
            with self._gate:
                self._inside = not self._ended
            if self._inside:
                self._work()
            with self._gate:  # after it nothing can end it any more
                self._inside = False
        except SystemExit:
            pass

    def _work(self) -> None:
        for asked, answer in self._jobs:
            try:
                found = answer()
            except Exception as error:  # raised again in the window's thread, where it is heard
                found = error
            self.found.put((asked, found))

    def end(self) -> None:
        """End it as ``sys.exit`` in its midst would, at its next step of Python."""
        with self._gate:
            inside, self._inside, self._ended = self._inside, False, True
            if inside and self.ident is not None:
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(self.ident), ctypes.py_object(SystemExit))


class Lane(QObject):
    """Errands of which only the last counts.

    answered   (what was asked, the answer or the KindynaError)
    """

    answered = Signal(object, object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._errand: Errand | None = None
        self._running: list[Errand] = []  # with those that are about to end
        self._open = 0
        self._looks = QTimer(self, interval=LOOK_MS)
        self._looks.timeout.connect(self._look)

    @property
    def busy(self) -> bool:
        """Answers are still to come."""
        return self._open > 0

    def ask(self, jobs: Sequence[Job]) -> None:
        """Forget what is being computed and compute these."""
        self.stop()
        if not jobs:
            return
        self._open, self._errand = len(jobs), Errand(jobs)
        self._running.append(self._errand)
        self._errand.start()
        self._looks.start()

    def stop(self) -> None:
        """Forget what is being computed."""
        if self._errand is not None:
            self._errand.end()
        self._errand, self._open = None, 0

    def close(self) -> None:
        """Stop, and be sure that nothing of it is running any longer."""
        self.stop()
        for errand in self._running:
            errand.join(PATIENCE)
        self._look()

    def _look(self) -> None:
        errand = self._errand
        while errand is not None and errand is self._errand:
            try:
                asked, found = errand.found.get_nowait()
            except Empty:
                break
            self._open -= 1
            if isinstance(found, Exception) and not isinstance(found, KindynaError):
                raise found
            self.answered.emit(asked, found)
        self._running = [errand for errand in self._running if errand.is_alive()]
        if not self._running and not self._open:
            self._looks.stop()


__all__ = ["Errand", "Job", "Lane"]
