"""The command ``compare``: two designs held against each other."""

from __future__ import annotations

from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import as_json, ending_with, studied
from core.errors import KindynaError, NoAnswer
from core.frozen import frozen
from core.output.compare import Side, as_csv, as_document, as_rows, as_text, compared, side_of
from core.output.summary import to_json
from core.project import load
from core.project.files import write
from core.requests import typed


@frozen(kw_only=True)
class Arguments:
    """Which designs, and where to."""

    a: Path = typed("design file (.toml)", "A", type=Path)
    b: Path = typed("design file to hold against it", "B", type=Path)
    out: Path | None = typed(
        "also write what differs there", default=None, type=ending_with("a comparison", ".csv", ".html"), metavar="FILE"
    )
    json: bool = as_json()


def run(arguments: Arguments, painter: Painter | None) -> int:
    """What differs, on the terminal, and as a file where one is named."""
    found = compared(_side(arguments.a), _side(arguments.b))
    if arguments.out is not None:
        if arguments.out.suffix.lower() == ".csv":
            write(arguments.out, as_csv(found).encode())
        else:
            from core.output.report.html import html

            write(arguments.out, html(as_document(found), {}).encode())
    print(to_json(as_rows(found)) if arguments.json else as_text(found), end="")
    return DONE


def _side(path: Path) -> Side:
    """Raises KindynaError naming the file: of two designs either may have no answer."""
    design = load(path)
    try:
        return side_of(studied(design))
    except NoAnswer as error:
        raise KindynaError(f"{path}: {error}") from error
