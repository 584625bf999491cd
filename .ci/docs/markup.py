"""Pages as Markdown: texts with a place for a table, lists of pages, cells that stay as they are, equations."""

import re
from collections.abc import Iterable
from pathlib import Path

from core.output.report.formula import mathml

TEXTS = Path(__file__).parent / "texts"
MARKS = str.maketrans({mark: f"&#{ord(mark)};" for mark in "|*_`[]\\<>&"})
"""Signs that would be Markdown or HTML in a cell of a table."""


def text(name: str, table: str = "") -> str:
    """Text of a page, completed with its table."""
    return (TEXTS / f"{name}.md").read_text("utf-8").replace("{table}", table)


def write_page(path: Path, text: str) -> None:
    """Write a page, with its folder."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, "utf-8", newline="\n")


def contents(names: Iterable[str], *options: str) -> str:
    """List of the pages of a folder, as Sphinx reads it."""
    return "\n".join(["```{toctree}", ":maxdepth: 1", *options, "", *names, "```", ""])


def table(header: str, rows: Iterable[Iterable[str]]) -> str:
    """Table of Markdown; the cells are Markdown or HTML already."""
    count = header.count("|") + 1
    return "\n".join([f"| {header} |", "|---" * count + "|", *(f"| {' | '.join(row)} |" for row in rows), ""])


def words(text: str) -> str:
    """A text as it is, in a cell of a table."""
    return text.translate(MARKS)


def code(text: str) -> str:
    """A name or a word of a file, in a cell of a table."""
    return f"<code>{words(text)}</code>" if text else ""


def equation(lines: Iterable[str]) -> str:
    """Lines of an equation, in a cell of a table."""
    marked = (mathml(line).replace('display="block"', 'displaystyle="true"') for line in lines)
    return "<br>".join(re.sub(r"[|*_`\[\]\\]", lambda mark: f"&#{ord(mark[0])};", line) for line in marked)
