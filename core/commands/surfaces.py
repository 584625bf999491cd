"""The command ``surface``: surfaces and solids of a cam."""

from __future__ import annotations

from pathlib import Path

from core.commands import Painter
from core.commands.common import DriveArguments, as_json, one_studied, verdict
from core.frozen import frozen
from core.output.solids.surface import (
    SURFACE_FORMATS,
    SurfaceRequest,
    facts_text,
    summary,
    surface_job,
    write_surface,
)
from core.project import load
from core.requests import text_option


@frozen(kw_only=True)
class SurfaceArguments(DriveArguments):
    """Arguments of ``surface``: a cam and the content of the file."""

    out: Path = text_option(
        f"file to write, with one of the endings {'|'.join(SURFACE_FORMATS)}", type=Path, metavar="FILE"
    )
    request: SurfaceRequest = SurfaceRequest()
    json: bool = as_json("print deviation, number of faces and volume as JSON")


def run_surface(arguments: SurfaceArguments, painter: Painter | None) -> int:
    """Write the file, and print its deviation."""
    study = one_studied(load(arguments.design), arguments.drive)
    job = surface_job(study, arguments.out, arguments.request)
    paths = write_surface(job, arguments.out)
    if arguments.json:
        print(facts_text(job), end="")
    else:
        print("\n".join([*map(str, paths), summary(job)]))
    return verdict(study, ("cam",))
