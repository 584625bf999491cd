"""The command ``scale``: a design of another size."""

from __future__ import annotations

from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import design_file
from core.design import rescaled, scale_text
from core.design.fields import flag, number
from core.errors import KindynaError
from core.frozen import frozen
from core.project import load, save
from core.requests import asked, typed


@frozen(kw_only=True)
class Arguments:
    """Of which design, by which factor, and where to."""

    design: Path = design_file()
    factor: float = asked(
        number("Factor of all lengths", 0.0, open_low=True, help="0.1 or 1/10 makes the machine ten times smaller"),
        "FACTOR",
        help="of all lengths, with a decimal point: 0.1",
    )
    out: Path = typed("design file to write", type=Path, metavar="FILE.toml")
    masses: bool = asked(
        flag("Masses and inertias grow along, as of the same material", default=True),
        "--keep-masses",
        help="leave masses and moments of inertia as they are; else they grow by FACTOR^3 and FACTOR^5, as parts of the same "
        "material do",
    )


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The scaled design as a file, and on the terminal what was scaled."""
    if arguments.out.resolve() == arguments.design.resolve():
        raise KindynaError(f"--out {arguments.out}: is the design that is read; choose another file")
    save(rescaled(load(arguments.design), arguments.factor, masses=arguments.masses), arguments.out)
    print(scale_text(arguments.factor, arguments.masses))
    return DONE
