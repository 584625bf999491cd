"""Python's garbage collector works in the window's own thread alone: what it takes away may be a widget, which no other thread
may touch. By default it runs in whichever thread happens to allocate memory."""

from __future__ import annotations

import gc
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from PySide6.QtWidgets import QApplication

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
