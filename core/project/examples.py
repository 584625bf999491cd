"""The designs that come with the program: the table ``examples.toml`` of the resources, which menus, welcome page and tests walk."""

from __future__ import annotations

import tomllib
from functools import lru_cache
from pathlib import Path

from core.frozen import frozen
from core.resources import resources


@frozen
class Example:
    """file: its name without the ending; name, as menus show it; text: what it shows, in a sentence; paper: slug of the paper that
    it belongs to, empty where there is none."""

    file: str
    name: str
    text: str
    paper: str = ""

    @property
    def path(self) -> Path:
        """The example's file."""
        return resources() / "examples" / f"{self.file}.toml"


@lru_cache(maxsize=1)
def subjects() -> tuple[tuple[str, tuple[Example, ...]], ...]:
    """Title of each subject with its examples, in the order in which they are offered."""
    table = tomllib.loads((resources() / "examples.toml").read_text("utf-8"))
    return tuple(
        (subject["title"], tuple(Example(**row) for row in subject["example"])) for subject in table["subject"]
    )
