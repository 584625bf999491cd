"""Writes unsaved work beside the window, however busy that is."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Event, Thread
from time import monotonic

from core.project.recovery import RecoveryFile, Unsaved

PAUSE = 0.5  # seconds from one writing to the next
PAUSE_AFTER_FAILURE = 5.0

Work = Callable[[], Unsaved]
"""Makes the text of unsaved work, in the writer's thread: it may not touch an object of Qt."""


class RecoveryWriter(Thread):
    """Keeps the recovery file at the latest work that was handed over; work that is replaced within a pause is skipped.

    The queue alone connects it with the window: a put is complete even where a signal's handler cuts in.

    failure   why the work at hand is not on the disk; empty where it is
    """

    def __init__(self, folder: Path) -> None:
        super().__init__(name="recovery", daemon=True)
        self.failure = ""
        self._file = RecoveryFile(folder)
        self._queue: SimpleQueue[tuple[Work | None] | Event | str] = SimpleQueue()

    def hand(self, work: Work | None) -> None:
        """From now on this is the unsaved work; None where nothing is unsaved."""
        self._queue.put((work,))

    def flush(self, patience: float = 10.0) -> bool:
        """Write what has been handed over without pause; False where it is not on the disk."""
        done = Event()
        self._queue.put(done)
        return done.wait(patience) and not self.failure

    def close(self, patience: float = 10.0) -> None:
        """End, and remove the recovery file: nothing is unsaved."""
        self.leave("close")
        self.join(patience)

    def leave(self, how: str = "leave") -> None:
        """End once what has been handed over is written."""
        self._queue.put(how)

    def run(self) -> None:
        waiting: tuple[Work | None] | None = None
        due = 0.0
        while True:
            try:
                item = self._queue.get(timeout=None if waiting is None else max(due - monotonic(), 0.0))
            except Empty:
                item = None
            if isinstance(item, tuple):
                waiting = item
                if monotonic() < due:
                    continue
            if waiting is not None and item != "close":
                due = monotonic() + (PAUSE if self._write(waiting[0]) else PAUSE_AFTER_FAILURE)
                waiting = waiting if self.failure else None
            if isinstance(item, Event):
                item.set()
            elif isinstance(item, str):
                if item == "close":
                    self._file.close()
                return

    def _write(self, work: Work | None) -> bool:
        try:
            if work is None:
                self._file.clear()
            else:
                self._file.write(work())
        except Exception as error:  # the thread goes on: the next work may be written
            self.failure = str(error) or type(error).__name__
        else:
            self.failure = ""
        return not self.failure


__all__ = ["RecoveryWriter", "Work"]
