"""The command ``export``: tables and summary into a folder."""

from __future__ import annotations

from pathlib import Path

from core.commands import Painter
from core.commands.common import design_file, out_folder, samples_per_turn, studied, verdict
from core.frozen import frozen
from core.output.export import bounded_study, export
from core.project import load
from core.requests import text_option


@frozen(kw_only=True)
class ExportArguments:
    """Arguments of ``export``: a design, a folder and the stages."""

    design: Path = design_file()
    samples: int = samples_per_turn()
    out: Path = out_folder("folder to write to", default=Path("out"))
    only: tuple[str, ...] = text_option("stages to compute and write", default=(), nargs="+", metavar="STAGE")


def run_export(arguments: ExportArguments, painter: Painter | None) -> int:
    """Write tables and summary into a folder."""
    study = studied(load(arguments.design), arguments.samples)
    for path in export(study, arguments.out, arguments.only):
        print(path)
    return verdict(bounded_study(study), arguments.only)
