"""The command ``figures``: the figures and tables of the papers, and what they say against what comes out here."""

from __future__ import annotations

import sys
from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import as_json, folder
from core.design.fields import choice
from core.frozen import frozen
from core.output.paper_files import claims_text, rows_data, table_file, tables_of
from core.output.summary import to_json
from core.papers import PAPERS, Claim, Examples, claims
from core.project.files import write_into
from core.requests import asked, typed

ALL = "all"


@frozen(kw_only=True)
class Arguments:
    """Which paper, and where to."""

    paper: str = asked(choice("Paper", (*PAPERS, ALL), help=" | ".join((*PAPERS, ALL))), "PAPER")
    out: Path = typed("write tables and pictures there", type=folder, metavar="DIR")
    json: bool = as_json("print the rows as JSON")


def run(arguments: Arguments, painter: Painter | None) -> int:
    """Every row with its verdict on the terminal; its figure or table as CSV and, where someone paints, as SVG and PNG."""
    wanted = tuple(PAPERS) if arguments.paper == ALL else (arguments.paper,)
    examples = Examples()
    found = {paper: claims(paper, examples) for paper in wanted}
    rows = [claim for each in found.values() for claim in each]
    made: dict[str, str | bytes] = {**tables_of(rows), **_painted(rows, painter)}
    if arguments.json:
        text = to_json(rows_data(rows))
    else:
        text = "\n".join(
            claims_text(f"{PAPERS[paper].label}: {PAPERS[paper].title}", each) for paper, each in found.items()
        )
    write_into(arguments.out, made)
    print(text, end="")
    return DONE


def _painted(rows: list[Claim], painter: Painter | None) -> dict[str, bytes]:
    """Pictures beside the tables, each once; where nobody paints, a line says so."""
    if painter is None:
        print("pictures left out: they need kindyna --headless", file=sys.stderr)
        return {}
    made: dict[str, bytes] = {}
    first = {table_file(claim): claim for claim in reversed(rows)}
    for name in dict.fromkeys(table_file(claim) for claim in rows):
        for picture, data in painter(first[name].drawing).items():
            made[name.removesuffix(".csv") + picture[picture.rindex(".") :]] = data
    return made
