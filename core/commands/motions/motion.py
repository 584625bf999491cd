"""The command ``motion``: the motion of a design by itself, or in another design, begun elsewhere in its turn."""

from __future__ import annotations

from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import drive_name
from core.design import alone, only, with_motion_of, with_only
from core.design.fields import number
from core.errors import KindynaError
from core.frozen import frozen
from core.motion.split import shift_motion
from core.output.cycle import begun_text
from core.project import load, load_one, number_of, save
from core.requests import asked, typed


@frozen(kw_only=True)
class Arguments:
    """Whose motion, and where it goes: to a file of its own, or into a design, which may be the same one."""

    design: Path = typed("design, or file of a motion (.toml)", "DESIGN", type=Path)
    drive: str = drive_name()
    shift_deg: float = asked(
        number(
            "Shift", -360.0, 360.0, default=0.0, help="the same so much later: the motion at DEG is what it was at 0"
        )
    )
    out: Path | None = typed("file of the motion alone to write", default=None, type=Path, metavar="FILE.toml")
    into: Path | None = typed("design file that takes the motion", default=None, type=Path, metavar="DESIGN")
    into_drive: str = typed("which drive of that design takes it", "--into-drive", default="", metavar="NAME")


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The motion written, and its peaks on the terminal."""
    if (arguments.out is None) == (arguments.into is None):
        raise KindynaError("motion: wanted: --out FILE.toml, or --into DESIGN")
    source = load_one(arguments.design, arguments.drive)
    moved = shift_motion(alone(source), arguments.shift_deg)
    if arguments.out is not None:
        save(moved, arguments.out)
    elif arguments.into is not None:
        whole = load(arguments.into)
        index = number_of(whole, arguments.into_drive)
        save(with_only(whole, index, with_motion_of(only(whole, index), moved)), arguments.into, in_place=True)
    print(begun_text(moved))
    return DONE
