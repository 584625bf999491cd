"""The session: the design being worked on, its undo stack and its file. Views pull from it; nothing else owns these."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoCommand, QUndoStack

from core.design import Design, edited, faults
from core.errors import DesignError, Fault, KindynaError, NoAnswer
from core.project import load, save
from core.study import Study

SAMPLES = 1800
"""Cam angles per turn on the screen."""


class ChangeDesign(QUndoCommand):
    """One step of the undo stack: the design before and after. Steps of one gesture at one path become one."""

    def __init__(self, session: Session, after: Design, text: str, path: str, gesture: int) -> None:
        super().__init__(text)
        self._session = session
        self._before, self._after = session.design, after
        self._path, self._gesture = path, gesture

    def redo(self) -> None:
        self._session._show(self._after)

    def undo(self) -> None:
        self._session._show(self._before)

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


class Session(QObject):
    """Owns the design and the undo stack.

    design_changed   another design is in place
    refused          (path, message): an edit was wrong; the last good design stays
    accepted         (path): an edit was right
    file_changed     path or saved state changed
    """

    design_changed = Signal()
    refused = Signal(str, str)
    accepted = Signal(str)
    file_changed = Signal()

    def __init__(self, design: Design, path: Path | None = None) -> None:
        super().__init__()
        self.stack = QUndoStack(self)
        self.design = design
        self.path = path
        self._gesture = 0
        self._study: Study | None = None
        self.stages_on_screen: Callable[[], Iterable[str]] = tuple
        self.stack.cleanChanged.connect(lambda _: self.file_changed.emit())

    # -- what views pull ----------------------------------------------------------------------------------

    @property
    def study(self) -> Study:
        """The study of the design in place; its stages are computed when a view asks."""
        if self._study is None:
            self._study = Study(self.design, SAMPLES)
        return self._study

    @property
    def modified(self) -> bool:
        return not self.stack.isClean()

    # -- editing ------------------------------------------------------------------------------------------

    def edit(self, path: str, value: Any, label: str) -> bool:
        """Change the value at a path, with what goes with it; label names the step: ``Change rod to 850 mm``.

        A wrong value, or one for which a stage on screen has no answer, is refused and nothing changes. Steps at the
        same path become one until ``end_gesture``.
        """
        return self.put(edited(self.design, path, value), label, path)

    def put(self, design: Design, label: str, path: str = "") -> bool:
        """Put another design in place as one step; False where it is refused."""
        if design == self.design:
            self.accepted.emit(path)
            return True
        wrong = self._why_not(design)
        if wrong is not None:
            self.refused.emit(path or wrong[0], wrong[1])
            return False
        self.stack.push(ChangeDesign(self, design, label, path, self._gesture))
        self.accepted.emit(path)
        return True

    def end_gesture(self) -> None:
        """What comes next is a step of its own."""
        self._gesture += 1

    def _why_not(self, design: Design) -> tuple[str, str] | None:
        found: list[Fault] = faults(design)
        if found:
            return found[0].path, "\n".join(str(f) for f in found)
        study = Study(design, SAMPLES)
        try:
            # only what is on screen: it is computed anyway once the design is in place
            for stage in self.stages_on_screen():
                getattr(study, stage)
        except NoAnswer as error:
            return error.field, str(error)
        return None

    def _show(self, design: Design) -> None:
        self.design = design
        self._study = None
        self.design_changed.emit()

    # -- files --------------------------------------------------------------------------------------------

    def open(self, path: Path) -> None:
        """Open a file; the undo stack starts anew. Raises DesignError, FileError; then nothing changes."""
        self.start(load(path), path)

    def start(self, design: Design, path: Path | None = None) -> None:
        """Begin with a design; path None: it has no file yet."""
        self.path = path
        self.stack.clear()
        self.end_gesture()
        self._show(design)
        self.file_changed.emit()

    def save(self, path: Path | None = None) -> None:
        """Write the design, to its own file where none is named. Raises FileError."""
        target = path or self.path
        if target is None:
            raise KindynaError("no file name; choose one")
        save(self.design, target)
        self.path = target
        self.stack.setClean()
        self.end_gesture()
        self.file_changed.emit()


__all__ = ["SAMPLES", "ChangeDesign", "DesignError", "Session"]
