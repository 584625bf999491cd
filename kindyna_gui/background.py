"""Work beside the window."""

from __future__ import annotations

import gc
from collections.abc import Callable, Hashable, Iterator, Sequence
from contextlib import contextmanager
from queue import Empty, SimpleQueue
from threading import Event, Thread
from typing import TYPE_CHECKING, Any, TypeVar

from PySide6.QtCore import QEventLoop, QObject, Qt, QTimer, Signal
from PySide6.QtWidgets import QApplication, QProgressDialog, QWidget

from core.errors import KindynaError
from core.numerics.lazy import Cancelled, cancellable, checkpoint

if TYPE_CHECKING:
    from PySide6.QtWidgets import QApplication


# -- background ------------------------------------------------------------------------------------------

# What may take its time is not computed in the window's own thread, and what is no longer wanted not to its end.
#
# The other threads never touch an object of Qt: results wait in a queue that the window polls. Nor do they collect
# garbage (see ``gc_timer``).

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


# -- awaited ---------------------------------------------------------------------------------------------

FIRST_WAIT_S = 0.25  # seconds that are waited for it at first


class PendingResult(QObject):
    """The last thing that was not there when it was read; another one takes its place.

    changed   it is being computed, or no longer
    known     who read it should read it again
    """

    changed = Signal()
    known = Signal()

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._job: Job | None = None
        self._failed: Job | None = None  # raises an error of its own
        self._beginning = False
        self.given_up = False
        self._work = Background(self)
        self._work.result.connect(self._ended)

    @property
    def busy(self) -> bool:
        return self._work.busy

    def later(self, key: Hashable, compute: Callable[[], Any]) -> str:
        """As ``core.numerics.lazy.postponing`` takes it."""
        if self._failed is not None and self._failed[0] == key:
            return ""
        if self._job is None or self._job[0] != key:
            self._job = key, compute
            self._begin()
        return self._state()

    def _state(self) -> str:
        """What has become of what is looked for; empty where it is known."""
        if self._job is None:
            return ""
        return "was given up" if self.given_up else "is being looked for"

    def _begin(self) -> None:
        assert self._job is not None
        self.given_up, self._beginning = False, True
        self._work.start([self._job])
        self._work.wait(FIRST_WAIT_S)
        self._beginning = False
        self.changed.emit()

    def _ended(self, _: Hashable, result: object) -> None:
        self._failed = self._job if isinstance(result, KindynaError) else None
        self._job = None
        if not self._beginning:
            self._tell()

    def _tell(self) -> None:
        self.changed.emit()
        self.known.emit()

    def give_up(self) -> None:
        """End it; it is not begun again before ``again``, or before something else is read."""
        self._work.stop()
        self.given_up = True
        self._tell()

    def again(self) -> None:
        """Begin anew what was given up."""
        if self._job is not None:
            self._begin()
            self.known.emit()

    def drop(self) -> None:
        """Nobody reads it any longer."""
        if self._job is not None:
            self._work.stop()
            self._job, self.given_up = None, False
            self.changed.emit()

    def close(self) -> None:
        """Drop it, and be sure that nothing is computed any longer."""
        self.drop()
        self._work.close()


# -- gc timer --------------------------------------------------------------------------------------------

EVERY_MS = 500


def tidy() -> None:
    """Collect the oldest generation that has reached Python's own threshold."""
    for generation in (2, 1, 0):
        if gc.get_count()[generation] > gc.get_threshold()[generation]:
            gc.collect(generation)
            return


def tidy_in_this_thread(app: QApplication) -> None:
    """Collect by a timer of the application's thread alone, from now on until the application ends."""
    from PySide6.QtCore import QTimer

    gc.disable()
    timer = QTimer(app, interval=EVERY_MS)
    timer.timeout.connect(tidy)
    timer.start()


# -- waiting ---------------------------------------------------------------------------------------------

DIALOG_DELAY_S = 0.3  # seconds: what is done by then shows no dialog

Result = TypeVar("Result")


def beside(parent: QWidget, text: str, compute: Callable[[], Result]) -> Result | None:
    """Compute something in another thread, so that the window stays alive; None where it was cancelled.

    What takes long shows a dialog, in front of which nothing else can be done, with Cancel; what is computed must not touch an
    object of Qt, and ends at its next checkpoint. Its exceptions are raised here.
    """
    work, loop = Background(parent), QEventLoop()
    results: list[Any] = []

    def attempt() -> tuple[Result | None, Exception | None]:
        try:
            return compute(), None
        except Cancelled:
            raise
        except Exception as error:  # of any kind: it is the caller's
            return None, error

    def take(_: object, result: object) -> None:
        results.append(result)
        loop.quit()

    def cancel() -> None:
        work.cancel()
        dialog.setLabelText("Stopping")
        dialog.setCancelButton(None)
        dialog.show()  # until it has stopped, for it hides itself

    work.result.connect(take)
    work.start([("", attempt)])
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
    """A dialog that can be cancelled; the function it yields takes the steps done and returns whether to go on."""
    dialog = QProgressDialog(text, "Cancel", 0, steps, parent)
    dialog.setWindowTitle("KINDYNA")
    dialog.setWindowModality(Qt.WindowModality.WindowModal)
    dialog.setMinimumDuration(400)
    dialog.setAutoReset(False)

    def go_on(done: int) -> bool:
        if done == dialog.value():  # then the dialog itself would not look after its events
            QApplication.processEvents()
        dialog.setValue(done)
        return not dialog.wasCanceled()

    try:
        yield go_on
    finally:
        dialog.close()
        dialog.deleteLater()
