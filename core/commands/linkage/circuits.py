"""The command ``circuits``: the ways to put a linkage together, and a design of one of them, as drawn or by signs."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from core.commands import DONE, Painter
from core.commands.common import as_json, design_file, ending_with
from core.design import Design, require_linkage
from core.design.fields import choice, whole
from core.design.topology import driver_turns
from core.errors import KindynaError
from core.frozen import frozen
from core.mechanism.circuits import Circuit, circuits
from core.mechanism.drivers import redrawn, with_signs
from core.output.summary import to_json
from core.project import dumps, load_one
from core.project.files import write
from core.requests import asked, typed
from core.study import Study

DRAWN, SIGNS = "drawn", "signs"


@frozen(kw_only=True)
class Arguments:
    """Of which design, and what is written."""

    design: Path = design_file()
    take: int = asked(whole("Circuit", 1, 999, default=1, help="its number in the list; 1 is the design's own"))
    told: str = asked(
        choice("Told by", (DRAWN, SIGNS), default=DRAWN, help="how the file says which circuit it is in"), "--as"
    )
    out: Path | None = typed(
        "design to write, in the circuit taken",
        default=None,
        usual="none",
        type=ending_with("a design", ".toml"),
        metavar="DESIGN.toml",
    )
    json: bool = as_json()


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The circuits by number with the range of the driver in each; a design in one of them."""
    design = require_linkage(load_one(arguments.design))
    found = circuits(design)
    if arguments.take > len(found):
        raise KindynaError(f"circuit = {arguments.take}: there is none of this number; allowed: 1 ... {len(found)}")
    if arguments.out is not None:
        write(arguments.out, dumps(_as(found[arguments.take - 1], arguments.told)))
    rows = [_row(design, i, circuit) for i, circuit in enumerate(found, 1)]
    print(to_json({"circuits": rows}) if arguments.json else "".join(map(_line, rows)), end="")
    return DONE


def _as(circuit: Circuit, told: str) -> Design:
    design = circuit.design
    if told == SIGNS:
        return with_signs(design)
    return (
        design
        if design.drive.linkage.drawn is not None
        else redrawn(design, Study(design).at_theta(np.zeros(1)).linkage)
    )


def _row(design: Design, number: int, circuit: Circuit) -> dict[str, object]:
    turns = driver_turns(design.drive.linkage)
    ends = [float(np.rad2deg(end)) if turns else 1e3 * end for end in (circuit.range.low, circuit.range.high)]
    return {"number": number, "here": circuit.here, "driver_deg" if turns else "driver_mm": ends}


def _line(row: dict[str, object]) -> str:
    key = next(key for key in row if key.startswith("driver"))
    low, high = row[key]  # type: ignore[misc]
    own = ", the design's own" if row["here"] else ""
    return f"{row['number']}: driver {low:.6g} ... {high:.6g} {key.removeprefix('driver_')}{own}\n"  # type: ignore[has-type]
