"""What must be so at the end of a step: rows that read the window."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from core.design import get
from core.errors import KindynaError
from core.study import extremes_of, findings_of, quantity
from kindyna_gui.window.base import Window

NEAR = 1e-9  # of a number's size: as typed


def _path(window: Window, wanted: list[Any]) -> bool:
    """``[path, value]``: the value of a field of the whole file."""
    path, value = wanted
    try:
        there = get(window.session.typed_whole, path)
    except KeyError:
        return False
    if isinstance(value, str) or isinstance(there, str) or there is None:
        return bool(there == value)
    return abs(float(there) - float(value)) <= NEAR * max(1.0, abs(float(value)))


def _quantity(window: Window, wanted: Mapping[str, Any]) -> bool:
    """``{name, above, below}``: the largest absolute value of a quantity, in its column's unit."""
    row = quantity(wanted["name"])
    try:
        found = extremes_of(window.session.study, row.stage, (row.name,))[row.name]
    except (KindynaError, KeyError):
        return False
    value = max(abs(found.low.value), abs(found.high.value)) / row.unit.factor
    return bool(wanted.get("above", 0.0) <= value <= wanted.get("below", float("inf")))


def _finding(window: Window, wanted: str) -> bool:
    """The code of a finding; with ``no`` before it, there is none of it."""
    code = wanted.removeprefix("no ")
    try:
        found = findings_of(window.session.whole_study, tuple(window.stages_on_screen()))
    except KindynaError:
        return False
    return any(each.code == code for each in found) == (code == wanted)


def _view(window: Window, wanted: str) -> bool:
    """A view is on the screen."""
    view = window.view(wanted)
    return view is not None and view.on_screen()


CONDITIONS: Mapping[str, Callable[[Window, Any], bool]] = MappingProxyType(
    {
        "path": _path,
        "quantity": _quantity,
        "finding": _finding,
        "view": _view,
        "task": lambda window, wanted: bool(window.actions_by_key[f"show_task:{wanted}"].isChecked()),
        "playing": lambda window, wanted: window.player.playing is wanted,
        "drives": lambda window, wanted: len(window.session.typed_whole.drives) == wanted,
        "links": lambda window, wanted: len(window.session.typed.drive.links) == wanted,
        "points": lambda window, wanted: set(wanted) <= _points(window),
        "runs": lambda window, wanted: _runs(window) is wanted,
    }
)
"""Key of ``until`` -> whether it is so."""


def _runs(window: Window) -> bool:
    """Whether what is typed or drawn is a mechanism that moves."""
    try:
        return window.session.draft is None and bool(window.session.study.linkage.bodies)
    except KindynaError:
        return False


def _points(window: Window) -> set[str]:
    """Names of all points of the linkage that is drawn."""
    return {name for link in window.session.typed.drive.links for name in link.places}


def met(window: Window, until: Mapping[str, Any]) -> bool:
    """Whether all that a step is done by is so."""
    return all(CONDITIONS[key](window, wanted) for key, wanted in until.items())
