"""What takes long: computed beside the window, or step by step, behind a dialog that can cancel it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

from PySide6.QtCore import QEventLoop, Qt
from PySide6.QtWidgets import QApplication, QProgressDialog, QWidget

from core.numerics.lazy import Cancelled
from kindyna_gui.background import Background

AT_ONCE = 0.3  # seconds: what is done by then shows no dialog

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
    if not work.wait(AT_ONCE):
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
