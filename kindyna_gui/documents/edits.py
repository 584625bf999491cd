"""Edits through the session; refused edits."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any, Generic, Protocol, TypeVar

from PySide6.QtGui import QUndoCommand

from core.design import Design, drive_at, faults, only
from core.errors import DesignError, Fault, KindynaError
from core.frozen import frozen
from core.project import dumps, loads
from core.study import Study
from kindyna_gui.labels import Reasons, name_of, reasons, sentence

# -- refusal ---------------------------------------------------------------------------------------------

SAMPLES = 1800
"""Cam angles per turn on the screen."""
Texts = tuple[tuple[str, str], ...]
"""Path in the whole file and sentence."""

NEEDED: Mapping[str, str] = MappingProxyType({"stability": "linkage"})
"""Stage -> what alone refuses a design for it: a shaft without a chart is shown with the reason, and none waits for the chart."""


@frozen
class Refusal:
    """An edit that was wrong: the path it was made at, and (path, name, sentence) of every field it is wrong for."""

    path: str
    reasons: Reasons

    def at(self, path: str) -> str:
        """The message beside the field of this path; empty where the refusal does not concern it.

        The field that was edited shows all reasons: first its own, then those of others with their names.
        """
        own = [sentence(text) for field, _, text in self.reasons if field == path]
        others = [f"{name}: {text}" for field, name, text in self.reasons if field != path] if path == self.path else []
        return "\n".join(own + others)


def fault_reasons(design: Design, items: Iterable[Fault]) -> Reasons:
    """Faults as the forms name them: path, name of the field, sentence."""
    return reasons(design, DesignError(items))


def fault_texts(design: Design, items: Iterable[Fault]) -> Texts:
    """Faults of all that a file has."""
    return tuple((path, text) for path, _, text in fault_reasons(design, items))


def refusal_reasons(design: Design, stages: Iterable[str]) -> Reasons:
    """Why a design cannot be put in place: its faults, else the first of these stages that has no answer; empty: it can."""
    wrong = fault_reasons(design, faults(design))
    if wrong:
        return wrong
    study = Study(design, SAMPLES)
    try:
        # only what is on screen: it is computed anyway once the design is in place
        for stage in stages:
            if stage in study.stages:  # another kind of design may not have it
                getattr(study, NEEDED.get(stage, stage))
    except KindynaError as error:
        return reasons(design, error)
    return ()


# -- draft -----------------------------------------------------------------------------------------------


@frozen
class IncompleteDesign:
    """All that is typed.

    design    every drive, as typed; no value is outside of its own range
    path      the value typed last, '' where none is
    reasons   path in the whole file, and sentence, of what does not fit together
    """

    design: Design
    path: str = ""
    reasons: Texts = ()

    def refusal(self, chosen: int) -> Refusal:
        """Path typed last and reasons as the forms of the chosen drive name them."""
        rows = ((*self._own(path, chosen), text) for path, text in self.reasons)
        return Refusal(
            self._own(self.path, chosen)[0], tuple((path, name_of(design, path), text) for path, design, text in rows)
        )

    def _own(self, path: str, chosen: int) -> tuple[str, Design]:
        """The path in the design of the chosen drive, where it leads into that; else in the whole file."""
        own = drive_at(path)
        return (own[1], only(self.design, chosen)) if own is not None and own[0] == chosen else (path, self.design)

    def state(self) -> dict[str, Any]:
        """As a plain dictionary of text and lists."""
        return {"design": dumps(self.design), "path": self.path, "reasons": [list(row) for row in self.reasons]}

    @classmethod
    def from_state(cls, state: Mapping[str, Any]) -> IncompleteDesign:
        """Raises DesignError where the dictionary holds no design."""
        try:
            reasons = tuple((str(path), str(text)) for path, text in state["reasons"])
            return cls(loads(str(state["design"]), unfinished=True), str(state["path"]), reasons)
        except (KeyError, TypeError, ValueError) as error:
            raise DesignError(
                [Fault("draft", str(error), "cannot be read", "what IncompleteDesign.state() gives")]
            ) from error


# -- the step of an undo stack ---------------------------------------------------------------------------

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
