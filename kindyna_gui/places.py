"""Files of the program, in the installed package or in the checkout."""

from __future__ import annotations

import tomllib
from pathlib import Path

from core.process import resources
from core.project.reading_faults import subjects

FIRST_EXAMPLE = "transfer_lift"
LESSONS = ("lift", "linkage", "camshaft", "valve_train")
"""Tutorials in their order; others follow in the order of their names."""
CHANGES = "changes"
"""The page of help with the changelog, which is next to the resources in the package and in the checkout."""


def example(name: str) -> Path:
    """Return the file of an example."""
    return resources() / "examples" / f"{name}.toml"


def examples() -> list[tuple[str, Path]]:
    """Return name and file of all examples, in the order in which they are offered."""
    return [(row.name, row.path) for _, rows in subjects() for row in rows]


def ready_tasks() -> list[tuple[str, str, Path]]:
    """Return name, description and file of the ready tasks of *Find a linkage*."""
    paths = sorted((resources() / "tasks").glob("*.toml"))
    lines = (path.read_text("utf-8").partition("\n")[0] for path in paths)
    return [
        (path.stem.replace("_", " ").capitalize(), text.lstrip("# "), path)
        for path, text in zip(paths, lines, strict=True)
    ]


def single_examples() -> list[tuple[str, Path]]:
    """Return name and file of the examples with one drive."""
    return [(name, path) for name, path in examples() if "\n[[drives]]\n" not in path.read_text("utf-8")]


def default_design() -> Path:
    """Return the file of the design that is opened by default."""
    return example(FIRST_EXAMPLE)


def lesson_files() -> list[Path]:
    """Return the files of all tutorials, in the order in which they are offered."""
    files = sorted((resources() / "tutorials").glob("*.toml"))
    return sorted(files, key=lambda file: LESSONS.index(file.stem) if file.stem in LESSONS else len(LESSONS))


def lessons() -> list[tuple[str, str]]:
    """Return name and title of all tutorials."""
    return [(file.stem, str(tomllib.loads(file.read_text("utf-8"))["title"])) for file in lesson_files()]


def icon_file(name: str) -> str:
    """Return the file of an icon; empty where there is none."""
    path = resources() / "icons" / f"{name}.svg"
    return str(path) if path.is_file() else ""


def help_text(name: str) -> str:
    """Return a page of help as Markdown; a sentence where the page is missing."""
    path = resources().parent / "CHANGELOG.md" if name == CHANGES else resources() / "help" / f"{name}.md"
    return path.read_text(encoding="utf-8") if path.is_file() else f"The page {name} is missing."
