"""What is done once the events at hand are done."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QObject, QTimer


def soon(owner: QObject, deed: Callable[[], Any]) -> None:
    """Do it when the event loop comes round again, unless its owner has gone by then.

    ``QTimer.singleShot`` keeps what it is to call for ever where the owner goes first, and with a method all that its object reaches:
    a timer of the owner goes with it.
    """
    timer = QTimer(owner, singleShot=True)
    timer.timeout.connect(deed)
    timer.timeout.connect(timer.deleteLater)
    timer.start()
