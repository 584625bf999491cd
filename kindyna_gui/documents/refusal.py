"""Why an edit is refused: faults of the design, or a stage that has no answer."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType

from core.design import Design, faults
from core.errors import DesignError, Fault, KindynaError
from core.frozen import frozen
from core.study import Study
from kindyna_gui.labels import Reasons, reasons, sentence

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


__all__ = ["SAMPLES", "Reasons", "Refusal", "Texts", "fault_reasons", "fault_texts", "refusal_reasons"]
