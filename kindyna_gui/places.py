"""Where the program's own files are: inside the installed package, else in the checkout."""

from __future__ import annotations

import tomllib
from pathlib import Path

from core.process import resources
from core.project.reading_faults import subjects

FIRST_EXAMPLE = "transfer_lift"
LESSONS = ("lift", "linkage", "camshaft")
"""Tutorials, as they are offered; others follow by their names."""

CHANGES = "changes"
"""The page of the help that is the changelog, beside the resources in the package as in the checkout."""


def example(name: str) -> Path:
    """The file of one of the designs that come with the program."""
    return resources() / "examples" / f"{name}.toml"


def examples() -> list[tuple[str, Path]]:
    """All designs that come with the program, in the order in which they are offered: name for the user, file."""
    return [(row.name, row.path) for _, rows in subjects() for row in rows]


def single_examples() -> list[tuple[str, Path]]:
    """Those of one drive."""
    return [(name, path) for name, path in examples() if "\n[[drives]]\n" not in path.read_text("utf-8")]


def default_design() -> Path:
    """The design that is opened where none is named."""
    return example(FIRST_EXAMPLE)


def lesson_files() -> list[Path]:
    """Of the lessons that come with the program, in the order in which they are offered."""
    found = sorted((resources() / "tutorials").glob("*.toml"))
    return sorted(found, key=lambda file: LESSONS.index(file.stem) if file.stem in LESSONS else len(LESSONS))


def lessons() -> list[tuple[str, str]]:
    """Name and title of each of them."""
    return [(file.stem, str(tomllib.loads(file.read_text("utf-8"))["title"])) for file in lesson_files()]


def icon_file(name: str) -> str:
    """The file of an icon; empty where there is none."""
    path = resources() / "icons" / f"{name}.svg"
    return str(path) if path.is_file() else ""


def help_text(name: str) -> str:
    """A page of the help (Markdown); a sentence about it where the page is missing."""
    path = resources().parent / "CHANGELOG.md" if name == CHANGES else resources() / "help" / f"{name}.md"
    return path.read_text(encoding="utf-8") if path.is_file() else f"The page {name} is missing."


def state_folder() -> Path:
    """The user's folder for what the program keeps between its runs: log and recovery. It need not exist yet."""
    from PySide6.QtCore import QStandardPaths

    return Path(QStandardPaths.writableLocation(QStandardPaths.StandardLocation.GenericStateLocation)) / "kindyna"
