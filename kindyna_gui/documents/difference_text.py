"""A value that differs between two designs, as the window shows it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from core.design import NO_UNIT, Design, Unit, split_unit
from core.errors import MISSING
from core.project import Difference
from kindyna_gui.labels import choice_text, name_of, value_text

NAMES = {"assumed": "Assumed values", "follower.kind": "Kind of follower"}
"""Of keys that no form shows."""


def difference_text(before: Design | None, after: Design, difference: Difference) -> tuple[str, str, str]:
    """A value that differs between two designs: its name, what stands in the one, what in the other."""
    design = before if before is not None and difference.after is MISSING else after
    name = NAMES.get(difference.path) or name_of(design, difference.path)
    unit = split_unit(difference.path.rpartition(".")[2])[1] or NO_UNIT
    return name, _any_text(difference.before, unit), _any_text(difference.after, unit)


def _any_text(value: Any, unit: Unit) -> str:
    """A value of a file: a number, a word, a list or a table."""
    if value is MISSING:
        return "nothing"
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {_any_text(each, NO_UNIT)}" for key, each in value.items())
    if isinstance(value, list | tuple):
        return f"({', '.join(_any_text(each, NO_UNIT) for each in value)})"
    if isinstance(value, float):
        return value_text(value, unit)
    return choice_text(value) if isinstance(value, str) else str(value)


__all__ = ["difference_text"]
