"""The steps of the undo stack."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtGui import QUndoCommand

from core.design import Design
from kindyna_gui.documents.draft import Draft

if TYPE_CHECKING:
    from kindyna_gui.documents.session import Session

Work = tuple[Design, Draft | None, int]
"""A whole design, what has been typed of a motion that is not finished, and the number of the drive that it was typed in; one step
of the undo stack changes all, so that undo shows the drive that it changes."""


class ChangeDesign(QUndoCommand):
    """One step of the undo stack: the work before and after. Steps of one gesture at one path become one."""

    def __init__(self, session: Session, after: Work, text: str, path: str, gesture: int) -> None:
        super().__init__(text)
        self._session = session
        self._before, self._after = (session.whole, session.draft, session.chosen), after
        self._path, self._gesture = path, gesture
        self._new = True

    def redo(self) -> None:
        self._session._show(*self._after, restored=not self._new)
        self._new = False

    def undo(self) -> None:
        self._session._show(*self._before, restored=True)

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

    def __init__(self, session: Session, design: Design, path: Path | None, text: str) -> None:
        super().__init__(text)
        self._session, self._after = session, (design, path)
        self._before = (session.whole, session.path, session.draft, session.chosen)

    def redo(self) -> None:
        self._session._begin(*self._after)

    def undo(self) -> None:
        self._session._begin(*self._before)


__all__ = ["BeginDesign", "ChangeDesign", "Work"]
