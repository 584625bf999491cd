"""Python in pages and notebooks: where it is, and what it shows when it runs."""

import ast
import doctest
import inspect
import io
import json
import re
from collections.abc import Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

FENCE = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Cell:
    """A cell of a notebook: its kind, ``code`` or ``markdown``, and its text."""

    kind: str
    text: str


def notebook(path: Path) -> list[Cell]:
    """Cells of a notebook. Raises ValueError where outputs are stored, or a cell is not Python alone."""
    cells = []
    for number, row in enumerate(json.loads(path.read_text("utf-8"))["cells"], 1):
        text = "".join(row["source"])
        if row["cell_type"] == "code" and (row["outputs"] or row["execution_count"] is not None):
            raise ValueError(f"{path.name}, cell {number}: outputs are stored; clear them")
        if row["cell_type"] == "code" and re.search(r"^\s*[%!]", text, re.MULTILINE):
            raise ValueError(f"{path.name}, cell {number}: % and ! are not Python")
        cells.append(Cell(row["cell_type"], text))
    return cells


def blocks(text: str) -> list[str]:
    """Python of a page of Markdown, block by block."""
    return FENCE.findall(text)


class Kernel:
    """Runs cells one after the other, as Jupyter does."""

    def __init__(self) -> None:
        self.names: dict[str, Any] = {"__name__": "__main__"}

    def run(self, code: str, place: str) -> tuple[str, Any]:
        """Return what a cell prints, and the value of its last expression; None where it has none."""
        tree = ast.parse(code, place)
        last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
        printed, value = io.StringIO(), None
        with redirect_stdout(printed):
            exec(compile(tree, place, "exec"), self.names)
            if last is not None:
                value = eval(compile(ast.Expression(last.value), place, "eval"), self.names)
        return printed.getvalue(), value


def shown(printed: str, value: Any) -> str:
    """Return the output of a cell as HTML; empty where it shows nothing."""
    parts = [f"<pre>{escape(printed)}</pre>"] if printed else []
    for name in ("_repr_html_", "_repr_svg_"):
        if hasattr(value, name):
            parts.append(re.sub(r"^<\?xml.*?\?>\s*", "", getattr(value, name)()))
            break
    else:
        parts += [] if value is None else [f"<pre>{escape(repr(value))}</pre>"]
    return f'<div class="output">\n{"".join(parts)}\n</div>' if parts else ""


def docstring_examples(library: Any) -> Iterator[doctest.DocTest]:
    """Examples in the docstrings of the public names of a library and of their members."""
    parser = doctest.DocTestParser()
    for name in library.__all__:
        for member, item in ((name, getattr(library, name)), *members(getattr(library, name))):
            place = member if member == name else f"{name}.{member}"
            yield parser.get_doctest(item.__doc__ or "", {}, place, None, None)


def members(kind: Any) -> list[tuple[str, Any]]:
    """Name -> method or property of a class, of a field its type as it is written; only those that the library defines."""
    result: dict[str, Any] = {}
    for base in reversed(getattr(kind, "__mro__", ())):
        if base.__module__.partition(".")[0] in ("core", "kindyna"):
            result |= {name: item for name, item in vars(base).items() if callable(item) or isinstance(item, property)}
            result |= inspect.get_annotations(base)
    return [(name, item) for name, item in result.items() if not name.startswith("_")]
