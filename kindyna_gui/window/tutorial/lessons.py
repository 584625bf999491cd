"""The lessons of ``resources/tutorials``: what is to be done at each step, and what is so once it is done."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.errors import KindynaError
from core.frozen import frozen
from kindyna_gui.places import lesson_files
from kindyna_gui.window.tutorial.conditions import CONDITIONS
from kindyna_gui.window.tutorial.deeds import DEEDS


@frozen
class Step:
    """One step.

    text    what to do and why, as the reader sees it
    do      deed of ``deeds.DEEDS`` -> its object; done in this order
    until   condition of ``conditions.CONDITIONS`` -> what it is compared with; all of them must be so
    """

    text: str
    do: Mapping[str, Any]
    until: Mapping[str, Any]

    @property
    def plain(self) -> str:
        """The text without its marks."""
        return re.sub(r"</?[bi]>", "", self.text)


@frozen
class Lesson:
    """The steps of one file, with its name there and its title; design: the example it begins with, empty for the one at hand."""

    name: str
    title: str
    steps: tuple[Step, ...]
    design: str = ""


def read(name: str) -> Lesson:
    """A lesson by its name, or by the path of its file. Raises KindynaError where there is none, or where a step is not one."""
    shipped = {file.stem: file for file in lesson_files()}
    path = shipped.get(name, Path(name))
    try:
        table = tomllib.loads(path.read_text("utf-8"))
    except OSError:
        raise KindynaError(f"tutorial {name}: there is none of this name; there are {', '.join(shipped)}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise KindynaError(f"{path}: {error}") from None
    steps = tuple(_step(row, f"{path.name}: steps[{i}]") for i, row in enumerate(table.get("steps", ())))
    if not steps:
        raise KindynaError(f"{path}: has no [[steps]]")
    return Lesson(path.stem, str(table.get("title", path.stem)), steps, str(table.get("design", "")))


def _step(row: Mapping[str, Any], where: str) -> Step:
    text, do, until = row.get("text"), row.get("do"), row.get("until")
    if not isinstance(text, str) or not isinstance(do, dict) or not isinstance(until, dict) or not do or not until:
        raise KindynaError(f"{where}: needs text, do = {{...}} and until = {{...}}")
    for table, known in ((do, DEEDS), (until, CONDITIONS)):
        for key in table:
            if key not in known:
                raise KindynaError(f"{where}: {key} is unknown; there are {', '.join(known)}")
    return Step(text, do, until)
