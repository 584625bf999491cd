"""The command ``flying-shear``: a flying shear as a design."""

from __future__ import annotations

from pathlib import Path

from core.commands import Painter
from core.commands.motions import begin
from core.frozen import frozen
from core.motion.feeds import FlyingShear, flying_shear
from core.requests import typed


@frozen(kw_only=True)
class Arguments:
    """What is wanted, and where it goes."""

    wanted: FlyingShear = FlyingShear()
    out: Path = typed("design file to write", type=Path, metavar="FILE.toml")


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The design as a file, and on the terminal its peaks."""
    return begin(arguments, flying_shear)
