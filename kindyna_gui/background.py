"""Computation in the background, while the window stays responsive.

Slow computations run in worker threads, and stop at their next checkpoint when their result is no longer needed. Workers
never use a Qt object: results wait in a queue that the window polls. Nor do they collect garbage, which only a timer of the
window's thread does.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Hashable, Iterator, Sequence
from contextlib import contextmanager, suppress
from queue import Empty, SimpleQueue
from threading import Event, Thread
from typing import TYPE_CHECKING, Any, TypeVar

from PySide6.QtCore import QEventLoop, QObject, Qt, QTimer, Signal
from PySide6.QtWidgets import QApplication, QProgressDialog, QWidget

from core.errors import KindynaError
from core.numerics.lazy import Cancelled, cancellable, checkpoint

if TYPE_CHECKING:
    from PySide6.QtWidgets import QApplication


Job = tuple[Any, Callable[[], Any]]
"""A key, and the function that computes the result; neither may refer to a Qt object."""
POLL_MS = 3
PATIENCE = 5.0  # seconds until a stopped worker reaches its next checkpoint; it may be importing a module
FIRST_WAIT_S = 0.25  # seconds to wait for a result before it is pending
EVERY_MS = 500  # between two collections of garbage
DIALOG_DELAY_S = 0.3  # seconds before a dialog is shown
Result = TypeVar("Result")

# -- jobs in worker threads ------------------------------------------------------------------------------


class Worker(Thread):
    """Runs jobs one after the other; once ``cancelled`` is set the current job ends at its next checkpoint, and no other starts."""

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
    """Jobs in the background; starting others cancels those that run.

    ``poll_ms`` is the interval at which results are fetched; each fetch interrupts the worker for a moment. Signal:
    ``result`` with the key of a job, and its result, the KindynaError it raised, or Cancelled after ``cancel``.
    """

    result = Signal(object, object)

    def __init__(self, parent: QObject | None = None, poll_ms: int = POLL_MS) -> None:
        super().__init__(parent)
        self._worker: Worker | None = None
        self._running: list[Worker] = []  # and those that are about to end
        self._open = 0
        self._is_closed = False
        self._poll = QTimer(self, interval=poll_ms)
        self._poll.timeout.connect(self._fetch)

    @property
    def busy(self) -> bool:
        """Whether results are outstanding."""
        return self._open > 0

    def start(self, jobs: Sequence[Job]) -> None:
        """Cancel the running jobs and start others; none after ``close``."""
        self.stop()
        if not jobs or self._is_closed:
            return
        self._open, self._worker = len(jobs), Worker(jobs)
        self._running.append(self._worker)
        self._worker.start()
        self._poll.start()

    def wait(self, seconds: float) -> bool:
        """Block until all results are present, at most some seconds, and return whether they are."""
        if self._worker is not None:
            self._worker.join(seconds)
            if not self._worker.is_alive():
                self._fetch()
        return not self.busy

    def cancel(self) -> None:
        """End the jobs at their next checkpoint; their results, or Cancelled, are still emitted."""
        if self._worker is not None:
            self._worker.cancelled.set()

    def stop(self) -> None:
        """Cancel the running jobs; none of their results is emitted."""
        if self._worker is not None:
            self._worker.cancelled.set()
        self._worker, self._open = None, 0

    def close(self) -> None:
        """Stop for good, and wait until no job is running."""
        self._is_closed = True
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
            self._open = 0 if isinstance(result, Cancelled) else self._open - 1  # no other job starts then
            if isinstance(result, Exception) and not isinstance(result, KindynaError | Cancelled):
                raise result
            self.result.emit(key, result)
        self._running = [worker for worker in self._running if worker.is_alive()]
        if not self._running and not self._open:
            self._poll.stop()


def attempt(compute: Callable[[], Any]) -> None:
    """Compute what fills the caches; who reads the result later meets its exception."""
    with suppress(Exception):
        compute()


# -- a result that is not known yet ----------------------------------------------------------------------


class PendingResult(QObject):
    """The last result that was not known when it was read; reading another one replaces it.

    ``what`` names the result, and ``tip`` says what it is for.

    Signals: ``changed`` when its computation starts or ends; ``known`` when views should read it again.
    """

    changed = Signal()
    known = Signal()

    def __init__(self, parent: QObject, what: str, tip: str) -> None:
        super().__init__(parent)
        self.what, self.tip = what, tip
        self._job: Job | None = None
        self._failed: Job | None = None  # its computation raised an error
        self._is_starting = False
        self.is_cancelled = False
        self._work = Background(self)
        self._work.result.connect(self._ended)

    @property
    def busy(self) -> bool:
        """Whether the result is being computed."""
        return self._work.busy

    def later(self, key: Hashable, compute: Callable[[], Any]) -> str:
        """Compute a result in the background, as ``core.numerics.lazy.postponing`` requires; return its state, '' when known."""
        if self._failed is not None and self._failed[0] == key:
            return ""
        if self._job is None or self._job[0] != key:
            self._job = key, compute
            self._start()
        return self._state()

    def _state(self) -> str:
        """Return the state of the result in words; empty where it is known."""
        if self._job is None:
            return ""
        return "was cancelled" if self.is_cancelled else "is being calculated"

    def _start(self) -> None:
        assert self._job is not None
        self.is_cancelled, self._is_starting = False, True
        self._work.start([self._job])
        self._work.wait(FIRST_WAIT_S)
        self._is_starting = False
        self.changed.emit()

    def _ended(self, _: Hashable, result: object) -> None:
        self._failed = self._job if isinstance(result, KindynaError) else None
        self._job = None
        if not self._is_starting:
            self._emit_known()

    def _emit_known(self) -> None:
        self.changed.emit()
        self.known.emit()

    def cancel(self) -> None:
        """Cancel the computation; only ``again``, or reading another result, starts one."""
        self._work.stop()
        self.is_cancelled = True
        self._emit_known()

    def again(self) -> None:
        """Start the cancelled computation again."""
        if self._job is not None:
            self._start()
            self.known.emit()

    def drop(self) -> None:
        """Drop the result, when no view reads it any longer."""
        if self._job is not None:
            self._work.stop()
            self._job, self.is_cancelled = None, False
            self.changed.emit()

    def close(self) -> None:
        """Drop the result, and wait until nothing is computed."""
        self.drop()
        self._work.close()


# -- garbage collection ----------------------------------------------------------------------------------


def tidy() -> None:
    """Collect the oldest generation that has reached Python's threshold, unless the mouse holds something."""
    if QApplication.mouseButtons():
        return
    for generation in (2, 1, 0):
        if gc.get_count()[generation] > gc.get_threshold()[generation]:
            gc.collect(generation)
            return


def tidy_in_this_thread(app: QApplication) -> None:
    """Collect garbage only by a timer of the application's thread, until the application ends."""
    from PySide6.QtCore import QTimer

    gc.disable()
    timer = QTimer(app, interval=EVERY_MS)
    timer.timeout.connect(tidy)
    timer.start()


# -- waiting with a dialog -------------------------------------------------------------------------------


def in_background(parent: QWidget, text: str, compute: Callable[[], Result]) -> Result | None:
    """Compute a result in another thread, while the window is repainted; None where the user cancels.

    After a moment a modal dialog with Cancel is shown. The function must not use a Qt object, and ends at its next
    checkpoint when cancelled. Its exceptions are raised here.
    """
    work, loop = Background(parent), QEventLoop()
    results: list[Any] = []

    def outcome() -> tuple[Result | None, Exception | None]:
        try:
            return compute(), None
        except Cancelled:
            raise
        except Exception as error:  # of any kind: raised again for the caller
            return None, error

    def take(_: object, result: object) -> None:
        results.append(result)
        loop.quit()

    def cancel() -> None:
        work.cancel()
        dialog.setLabelText("Stopping")
        dialog.setCancelButton(None)
        dialog.show()  # until the job has stopped, for the dialog hides itself

    work.result.connect(take)
    work.start([("", outcome)])
    if not work.wait(DIALOG_DELAY_S):
        dialog = QProgressDialog(text, "Cancel", 0, 0, parent)
        dialog.setWindowTitle("KINDYNA")
        dialog.setWindowModality(Qt.WindowModality.WindowModal)
        dialog.canceled.connect(cancel)
        dialog.show()
        loop.exec()
        dialog.close()
        dialog.deleteLater()
    work.close()
    work.deleteLater()
    if isinstance(results[0], Cancelled):
        return None
    result, error = results[0]
    if error is not None:
        raise error
    return result


@contextmanager
def progress(parent: QWidget, text: str, steps: int) -> Iterator[Callable[[int], bool]]:
    """Show a dialog of progress with Cancel; yield a function of the finished steps that returns whether to continue."""
    dialog = QProgressDialog(text, "Cancel", 0, steps, parent)
    dialog.setWindowTitle("KINDYNA")
    dialog.setWindowModality(Qt.WindowModality.WindowModal)
    dialog.setMinimumDuration(400)
    dialog.setAutoReset(False)

    def go_on(done: int) -> bool:
        if done == dialog.value():  # the dialog does not process its events then
            QApplication.processEvents()
        dialog.setValue(done)
        return not dialog.wasCanceled()

    try:
        yield go_on
    finally:
        dialog.close()
        dialog.deleteLater()
