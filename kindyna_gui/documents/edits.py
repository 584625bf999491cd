"""Why edits are refused, the incomplete design, and the step of the undo stack."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any, Generic, Protocol, TypeVar

from PySide6.QtGui import QUndoCommand

from core.design import Design, drive_at, faults, only
from core.errors import DesignError, Fault, KindynaError
from core.frozen import frozen
from core.project import loads
from core.study import Study
from kindyna_gui.labels import Reasons, name_of, reasons, sentence

SAMPLES = 1800
"""Cam angles per turn on the screen."""
Texts = tuple[tuple[str, str], ...]
"""Path in the full design, and sentence."""

NEEDED: Mapping[str, str] = MappingProxyType({"stability": "linkage"})
"""Stage -> the stage that is checked instead: a shaft without a stability chart is shown with the reason."""

# -- refusals --------------------------------------------------------------------------------------------


@frozen
class Refusal:
    """A refused edit: its path, and (path, name, sentence) of every field with a reason."""

    path: str
    reasons: Reasons

    def at(self, path: str) -> str:
        """Return the message below the field of a path; empty where the refusal does not concern it.

        The edited field shows all reasons: first those of the field, then those of other fields with their names.
        """
        texts = [sentence(text) for field, _, text in self.reasons if field == path]
        others = (
            [sentence(f"{name}: {text}") for field, name, text in self.reasons if field != path]
            if path == self.path
            else []
        )
        return "\n".join(texts + others)


def fault_reasons(design: Design, items: Iterable[Fault]) -> Reasons:
    """Return faults as the forms name them: path, name of the field, sentence."""
    return reasons(design, DesignError(items))


def fault_texts(design: Design, items: Iterable[Fault]) -> Texts:
    """Return the path and sentence of each fault."""
    return tuple((path, text) for path, _, text in fault_reasons(design, items))


def refusal_reasons(study: Study, stages: Iterable[str]) -> Reasons:
    """Return why a design is refused: its faults, else the first of these stages without a solution; empty where it is valid."""
    design = study.design
    wrong = fault_reasons(design, faults(design))
    if wrong:
        return wrong
    try:
        _evaluate(study, stages)
    except KindynaError as error:
        return reasons(design, error)
    return ()


def fits_together(study: Study, stages: Iterable[str]) -> bool:
    """Whether a design has no faults, and each of these stages a solution."""
    if faults(study.design):
        return False
    try:
        _evaluate(study, stages)
    except KindynaError:
        return False
    return True


def _evaluate(study: Study, stages: Iterable[str]) -> None:
    """Evaluate the stages on screen, which are computed for the new design anyway."""
    for stage in stages:
        if stage in study.stages:  # another kind of design may not have it
            getattr(study, NEEDED.get(stage, stage))


# -- the incomplete design -------------------------------------------------------------------------------


@frozen
class IncompleteDesign:
    """Everything typed while it does not fit together.

    ``design`` has every drive as typed, each value within its range; ``path`` is that of the value typed last, or '';
    ``reasons`` are path in the full design and sentence of what does not fit. ``waits``: whether it fits is not known until the
    optimal laws of its motions are solved. ``stands_for`` is the valid design where its own laws are not solved yet, and a
    design with other laws stands in for it.
    """

    design: Design
    path: str = ""
    reasons: Texts = ()
    waits: bool = False
    stands_for: Design | None = None

    def refusal(self, chosen: int) -> Refusal:
        """Return the path typed last and the reasons, as the forms of the selected drive name them."""
        rows = ((*self._in_drive(path, chosen), text) for path, text in self.reasons)
        return Refusal(
            self._in_drive(self.path, chosen)[0],
            tuple((path, name_of(design, path), text) for path, design, text in rows),
        )

    def _in_drive(self, path: str, chosen: int) -> tuple[str, Design]:
        """Return a path in the design of the selected drive, where it belongs to that; else in the full design."""
        drive = drive_at(path)
        return (
            (drive[1], only(self.design, chosen)) if drive is not None and drive[0] == chosen else (path, self.design)
        )

    def state(self) -> dict[str, Any]:
        """Return a plain dictionary of text and lists."""
        from core.project import dumps  # loaded when a design is first written

        reasons = [list(row) for row in self.reasons]
        return {"design": dumps(self.design), "path": self.path, "reasons": reasons, "waits": self.waits}

    @classmethod
    def from_state(cls, state: Mapping[str, Any]) -> IncompleteDesign:
        """Return the incomplete design of a dictionary. Raises DesignError where it has no design."""
        try:
            reasons = tuple((str(path), str(text)) for path, text in state["reasons"])
            waits = bool(state.get("waits", False))
            return cls(loads(str(state["design"]), unfinished=True), str(state["path"]), reasons, waits)
        except (KeyError, TypeError, ValueError) as error:
            raise DesignError(
                [Fault("draft", str(error), "cannot be read", "what IncompleteDesign.state() gives")]
            ) from error


# -- the step of the undo stack --------------------------------------------------------------------------

State = TypeVar("State")
StateIn = TypeVar("StateIn", contravariant=True)


class PutState(Protocol[StateIn]):
    """A function that puts a state in place; ``restored`` where undo or redo calls it."""

    def __call__(self, state: StateIn, /, *, restored: bool) -> None: ...


class UndoStep(QUndoCommand, Generic[State]):
    """The states before and after an edit; steps of one gesture at one path become one, unless the path is empty."""

    def __init__(
        self, put: PutState[State], before: State, after: State, text: str, path: str = "", gesture: int = 0
    ) -> None:
        super().__init__(text)
        self._put, self._before, self._after = put, before, after
        self._path, self._gesture = path, gesture
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
        if (other._path, other._gesture) != (self._path, self._gesture) or not self._path:
            return False
        self._after = other._after
        self.setText(other.text())
        self.setObsolete(self._after == self._before)
        return True
