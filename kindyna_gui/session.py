"""The session: the design being worked on, its undo stack and its file. Views pull from it; nothing else owns these."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoCommand, QUndoStack

from core.design import Design, edited, faults, motion_of
from core.errors import Fault, KindynaError, NoAnswer
from core.project.on_disk import DesignFiles, OnDisk
from core.study import Study
from kindyna_gui.wording import name_of, named, sentence

SAMPLES = 1800
"""Cam angles per turn on the screen."""


@dataclass(frozen=True)
class Refusal:
    """An edit that was wrong: the path it was made at, and (path, name, sentence) of every field it is wrong for."""

    path: str
    told: tuple[tuple[str, str, str], ...]

    def at(self, path: str) -> str:
        """What is to be read beside the field of this path; empty where it has no part in it.

        The field that was edited tells everything: first what concerns itself, the rest with the other's name.
        """
        own = [sentence(text) for field, _, text in self.told if field == path]
        others = [f"{name}: {text}" for field, name, text in self.told if field != path] if path == self.path else []
        return "\n".join(own + others)


def _told(fault: Fault) -> str:
    return f"{fault.problem}; allowed: {fault.allowed}" if fault.allowed else fault.problem


class ChangeDesign(QUndoCommand):
    """One step of the undo stack: the design before and after. Steps of one gesture at one path become one."""

    def __init__(self, session: Session, after: Design, text: str, path: str, gesture: int) -> None:
        super().__init__(text)
        self._session = session
        self._before, self._after = session.design, after
        self._path, self._gesture = path, gesture
        self._new = True

    def redo(self) -> None:
        self._session._show(self._after, restored=not self._new)
        self._new = False

    def undo(self) -> None:
        self._session._show(self._before, restored=True)

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
        self._before = (session.design, session.path)

    def redo(self) -> None:
        self._session._begin(*self._after)

    def undo(self) -> None:
        self._session._begin(*self._before)


class Session(QObject):
    """Owns the design and the undo stack.

    design_changed   another design is in place
    started          another design begins; what was chosen or zoomed for the one before is void
    restored         it was not typed: undo, redo, or another file; what was typed and refused is void
    refused          (Refusal): an edit was wrong; the last good design stays
    mended           what was refused last has been put right, or taken back, by hand
    accepted         (path): nothing is wrong any longer with what was typed there
    file_changed     path or saved state changed
    segment_chosen   another segment of the motion is the chosen one
    step_changed     another step of the circle diagram is shown
    """

    design_changed = Signal()
    started = Signal()
    restored = Signal()
    refused = Signal(Refusal)
    mended = Signal()
    accepted = Signal(str)
    file_changed = Signal()
    segment_chosen = Signal()
    step_changed = Signal()

    def __init__(self, design: Design, path: Path | None = None) -> None:
        super().__init__()
        self.stack = QUndoStack(self)
        self.design: Any = design
        self.path = path
        self.document = 0  # its number: opening or beginning anew counts, a step of the undo stack does not
        self._gesture = 0
        self._segment = 0
        self._running = ("", -1)  # path and gesture of the last step
        self._before: Design | None = None
        self.step: int | None = None
        self._study: Study | None = None
        self._at: tuple[float, Study] | None = None
        self.stages_on_screen: Callable[[], Iterable[str]] = tuple
        self._unchanged: list[tuple[Design, Path | None]] = [(design, path)]
        self._files = DesignFiles()
        if path is not None:
            self._files.note(path)
        self.stack.cleanChanged.connect(self.file_changed)
        self.stack.indexChanged.connect(self._step_taken)

    # -- what views pull ----------------------------------------------------------------------------------

    @property
    def study(self) -> Study:
        """The study of the design in place; its stages are computed when a view asks."""
        if self._study is None:
            self._study = Study(self.design, SAMPLES)
        return self._study

    def at(self, theta: float) -> Study:
        """The same at one cam angle [rad], for exact readings there; views that follow the cam share it."""
        if self._at is None or self._at[0] != theta:
            self._at = (theta, self.study.at_theta(np.array([theta])))
        return self._at[1]

    def choose_step(self, step: int | None) -> None:
        """The step of the circle diagram that views show: 0 what is known at sight, then a centre each; None: none."""
        if step != self.step:
            self.step = step
            self.step_changed.emit()

    @property
    def before(self) -> Design | None:
        """The design before the last step, or before the gesture that runs; None after undo, redo or another file."""
        return self._before

    @property
    def segment(self) -> int:
        """The number of the chosen segment, from 0: the one that the user works on, whichever view it was chosen in."""
        motion = motion_of(self.design)
        return min(self._segment, len(motion.segments) - 1) if motion is not None else 0

    def choose_segment(self, number: int) -> None:
        """Choose a segment by its number, from 0."""
        if number != self._segment:
            self._segment = number
            self.segment_chosen.emit()

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
            self.take_back(path)
            return True
        wrong = self._why_not(design)
        if wrong:
            self.refused.emit(Refusal(path or wrong[0][0], wrong))
            return False
        if not path or (path, self._gesture) != self._running:
            self._before = self.design
        self._running = (path, self._gesture)
        self.stack.push(ChangeDesign(self, design, label, path, self._gesture))
        self.take_back(path)
        return True

    def refuse(self, path: str, why: str) -> None:
        """Something was typed at a path that cannot even be tried."""
        self.refused.emit(Refusal(path, ((path, name_of(self.design, path), why),)))

    def withdraw(self, path: str) -> None:
        """What was refused at a path is void, for no field holds it; the reader may still want to know why."""
        self.accepted.emit(path)

    def take_back(self, path: str) -> None:
        """What was typed at a path and refused is mended, or taken back, by hand."""
        self.mended.emit()
        self.accepted.emit(path)

    def end_gesture(self) -> None:
        """What comes next is a step of its own."""
        self._gesture += 1

    def _why_not(self, design: Design) -> tuple[tuple[str, str, str], ...]:
        found = faults(design)
        if found:
            return tuple((f.path, name_of(design, f.path), named(design, _told(f))) for f in found)
        study = Study(design, SAMPLES)
        try:
            # only what is on screen: it is computed anyway once the design is in place
            for stage in self.stages_on_screen():
                if stage in study.stages:  # another kind of linkage may lack what is shown now
                    getattr(study, stage)
        except NoAnswer as error:
            told = named(design, str(error).removeprefix(f"{error.field}: "))
            return ((error.field, name_of(design, error.field), told),)
        except KindynaError as error:  # a curve that there is none of
            field, _, why = str(error).partition(": ")
            return ((field, name_of(design, field), why or field),)
        return ()

    def _show(self, design: Design, restored: bool) -> None:
        self.design = design
        self._study = self._at = None
        if restored:
            self._before = None
            self.end_gesture()
            self.restored.emit()
        self.design_changed.emit()

    # -- files --------------------------------------------------------------------------------------------

    def open(self, path: Path) -> None:
        """Open a file; the undo stack starts anew. Raises DesignError, FileError; then nothing changes."""
        self.start(self._files.read(path), path)

    def start(self, design: Design, path: Path | None = None) -> None:
        """Begin with a design; path None: it has no file yet."""
        self.document += 1
        self.stack.clear()
        self._unchanged = [(design, path)]
        self._begin(design, path)

    def begin(self, design: Design, text: str) -> None:
        """Begin with a design that has no file yet, as a step that can be undone; text names it."""
        self._unchanged.append((design, None))
        self.stack.push(BeginDesign(self, design, None, text))

    def reload(self) -> None:
        """Read the design's file again, as a step that can be undone. Raises DesignError, FileError; then nothing
        changes."""
        path = self._file()
        design = self._files.read(path)
        self._is_in_file(design, path)
        if design != self.design:
            self.stack.push(BeginDesign(self, design, path, f"Reload {path.name}"))
        self.stack.setClean()
        self.file_changed.emit()

    def _begin(self, design: Design, path: Path | None) -> None:
        self.path = path
        self.choose_step(None)
        self.started.emit()
        self._show(design, restored=True)
        self.file_changed.emit()

    def _step_taken(self, *_: object) -> None:
        """What stands as its file has it, or as it was begun, asks for no saving, whichever way it was reached."""
        if (self.design, self.path) in self._unchanged:
            self.stack.setClean()

    def _is_in_file(self, design: Design, path: Path) -> None:
        self._unchanged = [each for each in self._unchanged if each[1] != path] + [(design, path)]

    def _file(self) -> Path:
        if self.path is None:
            raise KindynaError("no file name; choose one")
        return self.path

    def save(self, path: Path | None = None) -> None:
        """Write the design, to its own file where none is named. Raises FileError, DesignError."""
        target = path or self._file()
        self._files.write(self.design, target)
        self.path = target
        self._is_in_file(self.design, target)
        self.stack.setClean()
        self.end_gesture()
        self.file_changed.emit()

    def on_disk(self) -> OnDisk:
        """Whether the design's file is as it was read or written last."""
        return OnDisk.SAME if self.path is None else self._files.state(self.path)


__all__ = ["SAMPLES", "ChangeDesign", "Refusal", "Session"]
