"""The command ``indexer``: an indexer as a design."""

from __future__ import annotations

from pathlib import Path

from core.commands import Painter
from core.commands.motions import begin
from core.frozen import frozen
from core.motion.feeds import Indexer, indexer
from core.requests import typed


@frozen(kw_only=True)
class Arguments:
    """What is wanted, and where it goes."""

    wanted: Indexer = Indexer()
    out: Path = typed("design file to write", type=Path, metavar="FILE.toml")


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The design as a file, and on the terminal its peaks."""
    return begin(arguments, indexer)
