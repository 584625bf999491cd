"""The command ``linkage-from``: a linkage from another program's text."""

from __future__ import annotations

import os
from pathlib import Path

from core.bounds import PROGRAM_BYTES
from core.commands import DONE, Painter
from core.commands.common import as_json, ending_with
from core.design.fields import choice, flag
from core.frozen import frozen
from core.linkage_programs import FORMATS, Made, read_linkage
from core.linkage_programs.read import UNITS, decoded
from core.output.lines import printable
from core.output.summary import to_json
from core.project import dumps
from core.project.files import read_bytes, write
from core.requests import asked, typed


@frozen(kw_only=True)
class Arguments:
    """What is read, and how."""

    text: str = typed(
        "a .linkage2 file, a file with a Pyslvs expression or the address of PMKS+, or one of these two itself",
        "FILE|TEXT",
    )
    out: Path = typed("design file to write", type=ending_with("a design", ".toml"), metavar="DESIGN.toml")
    format: str = asked(choice("Program", tuple(FORMATS), default="", help="whose text it is"), usual="as it begins")
    units: str = asked(choice("Units", tuple(UNITS), default="", help="of lengths"), usual="as it says, else mm")
    mirror: bool = asked(flag("Mirror", help="turn it over about the x axis: for programs whose y points down"))
    inputs: tuple[str, ...] = typed(
        "a joint that is driven; again for another", "--input", default=(), action="append", metavar="JOINT"
    )
    json: bool = as_json()


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The design as a file; how many links and joints it has, and what was left out."""
    text, name = arguments.text, ""
    if len(text) < 4096 and "\n" not in text and os.path.exists(text):
        name = Path(text).stem
        text = decoded(read_bytes(text, PROGRAM_BYTES))
    made = read_linkage(
        text, arguments.format, name=name, units=arguments.units, mirror=arguments.mirror, inputs=arguments.inputs
    )
    write(arguments.out, dumps(made.design))
    print(to_json(_data(made)) if arguments.json else _text(made), end="")
    return DONE


def _data(made: Made) -> dict[str, object]:
    left = [{"what": each.what, "why": each.why} for each in made.left_out]
    return {"links": made.links, "joints": made.joints, "left_out": left}


def _text(made: Made) -> str:
    lines = [f"{printable(made.design.name)}: {made.links} links, {made.joints} joints"]
    lines += [f"left out: {printable(each.what)}: {printable(each.why)}" for each in made.left_out]
    return "\n".join(lines) + "\n"
