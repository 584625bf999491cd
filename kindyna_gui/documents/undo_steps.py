"""The step of an undo stack."""

from __future__ import annotations

from typing import Generic, Protocol, TypeVar

from PySide6.QtGui import QUndoCommand

State = TypeVar("State")
Taken = TypeVar("Taken", contravariant=True)


class PutState(Protocol[Taken]):
    """Puts a state in place; restored: it has been in place before."""

    def __call__(self, state: Taken, /, *, restored: bool) -> None: ...


class UndoStep(QUndoCommand, Generic[State]):
    """The state before and after. Steps of one gesture at one place become one; where it is empty, none do."""

    def __init__(
        self, put: PutState[State], before: State, after: State, text: str, place: str = "", gesture: int = 0
    ) -> None:
        super().__init__(text)
        self._put, self._before, self._after = put, before, after
        self._place, self._gesture = place, gesture
        self._new = True

    def redo(self) -> None:
        self._put(self._after, restored=not self._new)
        self._new = False

    def undo(self) -> None:
        self._put(self._before, restored=True)

    def id(self) -> int:
        return 1

    def mergeWith(self, other: QUndoCommand) -> bool:
        if not isinstance(other, UndoStep):
            return False
        if (other._place, other._gesture) != (self._place, self._gesture) or not self._place:
            return False
        self._after = other._after
        self.setText(other.text())
        self.setObsolete(self._after == self._before)
        return True


__all__ = ["UndoStep"]
