"""Why a value of an example is what it is: the table ``reasons.toml`` of the resources."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from functools import lru_cache

from core.design import Design, all_paths, drive_at, get
from core.errors import KindynaError
from core.frozen import frozen
from core.resources import resources


@frozen
class Reason:
    """designs: names of designs, or of drives on a shaft; path of the value, or of what holds assumed values; value that it holds for,
    None: whatever it is."""

    designs: tuple[str, ...]
    path: str
    text: str
    value: float | None = None


@lru_cache(maxsize=1)
def reasons() -> tuple[Reason, ...]:
    """All rows."""
    table = tomllib.loads((resources() / "reasons.toml").read_text("utf-8"))
    return tuple(Reason(tuple(row.pop("designs")), **row) for row in table["reason"])


def reason(design: Design, path: str) -> str:
    """Why the value at a path is what it is; empty where nothing is said, or another value stands there now."""
    own = drive_at(path)
    name, inside = (design.name, path) if own is None else (design.drives[own[0]].name or "", own[1])
    for row in reasons():
        there = row.path == inside or (inside.startswith((f"{row.path}.", f"{row.path}[")) and path in design.assumed)
        if there and name in row.designs and (row.value is None or _is(design, path, row.value)):
            return row.text
    return ""


def _is(design: Design, path: str, value: float) -> bool:
    try:
        return bool(get(design, path) == value)
    except KindynaError:
        return False


def reasons_of(design: Design) -> Iterator[tuple[str, str]]:
    """Path and reason of every value of a design for which there is one, in the order of its file."""
    for path in all_paths(design):
        text = reason(design, path)
        if text:
            yield path, text
