"""The steps of the undo stack."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from PySide6.QtGui import QUndoCommand

from core.design import Design
from kindyna_gui.documents.draft import Draft

Work = tuple[Design, Draft | None, int]
"""A whole design, what has been typed of a motion that is not finished, and the number of the drive that it was typed in; one step
of the undo stack changes all, so that undo shows the drive that it changes."""


class Show(Protocol):
    """Puts a piece of work in place; restored: it has been in place before."""

    def __call__(self, whole: Design, draft: Draft | None, chosen: int, *, restored: bool) -> None: ...


class ChangeDesign(QUndoCommand):
    """One step of the undo stack: the work before and after. Steps of one gesture at one path become one."""

    def __init__(self, show: Show, before: Work, after: Work, text: str, path: str, gesture: int) -> None:
        super().__init__(text)
        self._show, self._before, self._after = show, before, after
        self._path, self._gesture = path, gesture
        self._new = True

    def redo(self) -> None:
        self._show(*self._after, restored=not self._new)
        self._new = False

    def undo(self) -> None:
        self._show(*self._before, restored=True)

    def id(self) -> int:
        return 1

    def mergeWith(self, other: QUndoCommand) -> bool:
        if not isinstance(other, ChangeDesign):
            return False
        if (other._path, other._gesture) != (self._path, self._gesture) or not self._path:
            return False
        self._after = other._after
        self.setText(other.text())
        self.setObsolete(self._after == self._before)
        return True


class BeginDesign(QUndoCommand):
    """Another design, with its file where it has one; undone, the one before comes back with its own."""

    def __init__(
        self,
        begin: Callable[[Work, Path | None], None],
        before: tuple[Work, Path | None],
        design: Design,
        path: Path | None,
        text: str,
    ) -> None:
        super().__init__(text)
        self._begin, self._before, self._after = begin, before, ((design, None, 0), path)

    def redo(self) -> None:
        self._begin(*self._after)

    def undo(self) -> None:
        self._begin(*self._before)


__all__ = ["BeginDesign", "ChangeDesign", "Work"]
