"""Computing beside the window: new jobs stop those that are still being computed.

What may take its time is not computed in the window's own thread, and what is no longer wanted not to its end.

The other threads never touch an object of Qt: results wait in a queue that the window polls. Nor do they collect
garbage (see ``gc_timer``).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from queue import Empty, SimpleQueue
from threading import Event, Thread
from typing import Any

from PySide6.QtCore import QObject, QTimer, Signal

from core.errors import KindynaError
from core.numerics.lazy import Cancelled, cancellable, checkpoint

Job = tuple[Any, Callable[[], Any]]
"""A key, and what computes the result; neither may hold an object of Qt."""
POLL_MS = 3
PATIENCE = 5.0  # seconds for a stopped worker to come to its next checkpoint: it may be importing a module


class Worker(Thread):
    """Jobs one after the other. Once ``cancelled`` is set the job at hand ends at its next checkpoint, and no other begins."""

    def __init__(self, jobs: Sequence[Job]) -> None:
        super().__init__(daemon=True)
        self.results: SimpleQueue[tuple[Any, Any]] = SimpleQueue()
        self.cancelled = Event()
        self._jobs = tuple(jobs)

    def run(self) -> None:
        with cancellable(self.cancelled):
            for key, compute in self._jobs:
                try:
                    checkpoint()
                    result = compute()
                except Cancelled as error:
                    self.results.put((key, error))
                    return
                except Exception as error:  # raised again in the window's thread, where its hook handles it
                    result = error
                self.results.put((key, result))


class Background(QObject):
    """Jobs beside the window, of which only the last that were started count.

    poll_ms: how often results are fetched; each time the worker is held up for a moment.

    result   (key of the job; its result, the KindynaError it raised, or Cancelled after ``cancel``)
    """

    result = Signal(object, object)

    def __init__(self, parent: QObject | None = None, poll_ms: int = POLL_MS) -> None:
        super().__init__(parent)
        self._worker: Worker | None = None
        self._running: list[Worker] = []  # with those that are about to end
        self._open = 0
        self._poll = QTimer(self, interval=poll_ms)
        self._poll.timeout.connect(self._fetch)

    @property
    def busy(self) -> bool:
        """Whether results are outstanding."""
        return self._open > 0

    def start(self, jobs: Sequence[Job]) -> None:
        """Cancel what is being computed and compute these."""
        self.stop()
        if not jobs:
            return
        self._open, self._worker = len(jobs), Worker(jobs)
        self._running.append(self._worker)
        self._worker.start()
        self._poll.start()

    def wait(self, seconds: float) -> bool:
        """Block until all results are there, at most so many seconds; whether they are."""
        if self._worker is not None:
            self._worker.join(seconds)
            if not self._worker.is_alive():
                self._fetch()
        return not self.busy

    def cancel(self) -> None:
        """Let the jobs end at their next checkpoint, and go on waiting for their results."""
        if self._worker is not None:
            self._worker.cancelled.set()

    def stop(self) -> None:
        """Cancel what is being computed; no result of it is emitted."""
        if self._worker is not None:
            self._worker.cancelled.set()
        self._worker, self._open = None, 0

    def close(self) -> None:
        """Stop, and be sure that nothing of it is running any longer."""
        self.stop()
        for worker in self._running:
            worker.join(PATIENCE)
        self._fetch()

    def _fetch(self) -> None:
        worker = self._worker
        while worker is not None and worker is self._worker:
            try:
                key, result = worker.results.get_nowait()
            except Empty:
                break
            self._open = 0 if isinstance(result, Cancelled) else self._open - 1  # no other job begins then
            if isinstance(result, Exception) and not isinstance(result, KindynaError | Cancelled):
                raise result
            self.result.emit(key, result)
        self._running = [worker for worker in self._running if worker.is_alive()]
        if not self._running and not self._open:
            self._poll.stop()


__all__ = ["Background", "Job", "Worker"]
