"""What views read and what may take long: it is computed beside the window, and can be given up and begun anew."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any

from PySide6.QtCore import QObject, Signal

from core.errors import KindynaError
from kindyna_gui.background import Background, Job

AT_ONCE = 0.25  # seconds that are waited for it at first


class Awaited(QObject):
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
        self._work.wait(AT_ONCE)
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


__all__ = ["Awaited"]
