"""The command ``surface``: surfaces and solids of a cam."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from core.commands import DONE, Painter
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
from core.study import Study


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
    request, design = arguments.request, load(arguments.design)
    if request.of and arguments.drive:
        request = replace(request, of=f"{arguments.drive}.{request.of}")
    study = Study(design) if request.of else one_studied(design, arguments.drive)
    job = surface_job(study, arguments.out, request)
    paths = write_surface(job, arguments.out)
    if arguments.json:
        print(facts_text(job), end="")
    else:
        print("\n".join([*map(str, paths), summary(job)]))
    return DONE if request.of else verdict(study, ("cam",))
