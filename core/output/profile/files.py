"""Files that hold a cam's profile, or the path of a cutter. One row a format."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from core.errors import KindynaError
from core.frozen import frozen
from core.output.beside import SUMMARY, require_own
from core.output.profile import dxf, gcode, svg, table
from core.output.profile.drawing import Job, comment, facts, layers
from core.output.profile.made import exact_curve, fitted
from core.output.profile.request import Request
from core.output.summary import to_json
from core.project.files import write_all
from core.study import Study


@frozen
class Format:
    """One row.

    label     what it is called
    fits      what may run from point to point, the usual first
    sampling  the usual one, with its value
    least_mm  finest tolerance that its readers can tell
    content   the file of a job
    summary   whether the file cannot say itself what it is, and a summary stands beside it
    machined  whether a machine follows it, as the request's ``machining`` says
    rounding_mm  by which its points are off, at most
    require   raises KindynaError for what it cannot hold
    """

    label: str
    fits: tuple[str, ...]
    sampling: tuple[str, float]
    least_mm: float
    content: Callable[[Job], bytes]
    summary: bool = False
    machined: bool = False
    rounding_mm: float = 0.0
    require: Callable[[Study, Request], None] = lambda study, request: None


FORMATS: Mapping[str, Format] = MappingProxyType(
    {
        ".csv": Format("CSV table", ("polyline",), ("samples", 3600), 1e-9, table.written, summary=True),
        ".dxf": Format(
            "DXF drawing", ("spline", "polyline", "arcs"), ("tolerance", 1e-3), 1e-9,
            lambda job: dxf.written(comment(job), layers(job)),
        ),
        ".svg": Format(  # viewers reckon with seven digits
            "SVG drawing", ("spline", "polyline", "arcs"), ("tolerance", 1e-3), 1e-6,
            lambda job: svg.written(comment(job), layers(job)),
        ),
        ".nc": Format(
            "G-code, ISO 6983", ("polyline",), ("tolerance", 1e-3), 2.0 * gcode.ROUNDING, gcode.written, machined=True,
            rounding_mm=gcode.ROUNDING, require=gcode.require,
        ),
    }
)  # fmt: skip
"""By the ending of the file's name."""


def format_of(path: Path) -> Format:
    """The row of a file's ending. Raises KindynaError."""
    row = FORMATS.get(path.suffix.lower())
    if row is None:
        raise KindynaError(f"{path}: no profile is written as {path.suffix or 'a name without ending'}; allowed: {', '.join(FORMATS)}")
    return row


def job_of(study: Study, path: Path, request: Request) -> Job:
    """What a file of this name will hold: computed, nothing written.

    Raises NoSuchStage, NoAnswer, KindynaError.
    """
    row = format_of(path)
    if request.fit not in row.fits:
        raise KindynaError(f"{path.suffix} holds no {request.fit}; allowed: {', '.join(row.fits)}")
    row.require(study, request)
    main = fitted(study, exact_curve(study, request), request, row.least_mm, row.rounding_mm)
    return Job(study, request, main)


def files(job: Job, path: Path) -> dict[str, bytes]:
    """File name -> content: the file itself, and a summary beside it where it needs one."""
    row = format_of(path)
    made = {path.name: row.content(job)}
    if row.summary:
        made[SUMMARY] = to_json({"file": path.name, **facts(job)}).encode()
    return made


def write(job: Job, path: Path) -> list[Path]:
    """Write the file, and what stands beside it; the paths. Raises FileError, and then nothing has changed."""
    made = files(job, path)
    if SUMMARY in made:
        require_own(path.parent / SUMMARY, ("file", "deviation_mm"))
    write_all(path.parent, made)
    return [path.parent / name for name in made]


__all__ = ["FORMATS", "Format", "files", "format_of", "job_of", "write"]
