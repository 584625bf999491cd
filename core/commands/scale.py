"""The command ``scale``: a design of another size."""

from __future__ import annotations

import argparse
from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import design_file, number
from core.design import rescaled, scale_text
from core.errors import KindynaError
from core.project import load, save


def options(parser: argparse.ArgumentParser) -> None:
    design_file(parser)
    factor = number("the factor of all lengths", "above 0", lambda value: value > 0.0)
    parser.add_argument("factor", type=factor, metavar="FACTOR", help="of all lengths, with a decimal point: 0.1")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.toml", help="design file to write")
    keep = "leave masses and moments of inertia as they are; else they grow by FACTOR^3 and FACTOR^5, as parts of the same material do"
    parser.add_argument("--keep-masses", action="store_true", help=keep)


def run(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """The scaled design as a file, and on the terminal what was scaled."""
    masses = not arguments.keep_masses
    if arguments.out.resolve() == arguments.design.resolve():
        raise KindynaError(f"--out {arguments.out}: is the design that is read; choose another file")
    save(rescaled(load(arguments.design), arguments.factor, masses=masses), arguments.out)
    print(scale_text(arguments.factor, masses))
    return DONE
