"""The switch between rounded and exact results: one for all views that take over a result."""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QCheckBox

from kindyna_gui.settings import Settings


class _Exact(QObject):
    """Signals ``changed`` when exact results are switched on or off."""

    changed = Signal()


EXACT = _Exact()


def takes_exact() -> bool:
    """Whether results are taken over with all their digits."""
    return Settings().exact


class ExactSwitch(QCheckBox):
    """Check box *Exact*; every one of the window shows the same state."""

    def __init__(self) -> None:
        super().__init__("Exact")
        self.setToolTip(
            "Take over all digits of the result. Else lengths are rounded to 0.1 mm, angles to 0.1°, other numbers to three "
            "significant digits, to the side on which every limit holds"
        )
        self.setChecked(takes_exact())
        self.clicked.connect(self._switch)
        EXACT.changed.connect(self._follow)

    def _switch(self, on: bool) -> None:
        Settings().exact = on
        EXACT.changed.emit()

    def _follow(self) -> None:
        self.setChecked(takes_exact())
