"""Files that hold a cam's profile, or the path of a cutter. One row a format."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from core.errors import KindynaError
from core.frozen import frozen
from core.output.export import csv
from core.output.files import profile_files
from core.output.files.made import exact_curve, fitted
from core.output.files.profile_files import ProfileDrawing, comment, drawn_profiles, facts, layers
from core.output.files.profile_request import ProfileRequest
from core.output.summary import to_json
from core.project.files import require_own_json, write_into
from core.study import Study

# -- the points as CSV: cam angle, place and polar coordinates --------------------------------------------------


COLUMNS = ("cam_angle_deg", "x_mm", "y_mm", "radius_mm", "polar_angle_deg")


def written(job: ProfileDrawing) -> bytes:
    """The table, to be read as a closed polyline."""
    at = job.main.points
    z = at.ends.z
    polar = np.mod(np.rad2deg(np.angle(z)), 360.0)
    columns = [at.degrees, z.real, z.imag, np.abs(z), np.where(polar >= 360.0, 0.0, polar)]
    return csv(COLUMNS, [column + 0.0 for column in columns]).encode()  # no minus zero


# -- files that hold a cam's profile, or the path of a cutter ---------------------------------------------------


@frozen
class Format:
    """One row.

    label     what it is called
    fits      what may run from point to point, the usual first
    sampling  the usual one: field of the request, and its value
    least_mm  finest tolerance that its readers can tell
    content   the file of a job
    drawn     whether it shows all flanks of the cam
    machined  whether a machine follows it, as the request's ``machining`` says
    rounding_mm  by which what it says is off, at most: by the name of the fit
    require   raises KindynaError for what it cannot hold
    """

    label: str
    fits: tuple[str, ...]
    sampling: tuple[str, float]
    least_mm: float
    content: Callable[[ProfileDrawing], bytes]
    drawn: bool = False
    machined: bool = False
    rounding_mm: Mapping[str, float] = field(default_factory=dict)
    require: Callable[[Study, ProfileRequest], None] = lambda study, request: None


FORMATS: Mapping[str, Format] = MappingProxyType(
    {
        ".csv": Format("CSV table", ("polyline",), ("samples", 3600), 1e-9, written),
        ".dxf": Format(
            "DXF drawing", ("spline", "polyline", "arcs"), ("tolerance_mm", 1e-3), 1e-9,
            lambda job: profile_files.dxf_bytes(comment(job), layers(job)), drawn=True,
        ),
        ".svg": Format(  # viewers reckon with seven digits
            "SVG drawing", ("spline", "polyline", "arcs"), ("tolerance_mm", 1e-3), 1e-6,
            lambda job: profile_files.svg_bytes(comment(job), layers(job)), drawn=True,
        ),
        ".nc": Format(
            "G-code, ISO 6983", ("polyline", "arcs"), ("tolerance_mm", 1e-3), 0.0, profile_files.gcode_bytes, machined=True,
            rounding_mm=profile_files.ROUNDING, require=profile_files.require,
        ),
    }
)  # fmt: skip
"""By the ending of the file's name."""


def format_of(path: Path) -> Format:
    """The row of a file's ending. Raises KindynaError."""
    row = FORMATS.get(path.suffix.lower())
    if row is None:
        raise KindynaError(
            f"{path}: no profile is written as {path.suffix or 'a name without ending'}; allowed: {', '.join(FORMATS)}"
        )
    return row


def job_of(study: Study, path: Path, request: ProfileRequest) -> ProfileDrawing:
    """What a file of this name will hold: computed, nothing written. What the request leaves open is as usual for such a file.

    Raises NoSuchStage, NoSolution, KindynaError.
    """
    row = format_of(path)
    sampling: dict[str, Any] = {} if request.sampling else dict([row.sampling])
    request = replace(request, fit=request.fit or row.fits[0], **sampling)
    if request.fit not in row.fits:
        raise KindynaError(f"{path.suffix} holds no {request.fit}; allowed: {', '.join(row.fits)}")
    row.require(study, request)
    rounding = row.rounding_mm.get(request.fit, 0.0)
    main = fitted(study, exact_curve(study, request), request, max(row.least_mm, 2.0 * rounding), rounding)
    return ProfileDrawing(study, request, main, drawn_profiles(study, request, main, row.least_mm) if row.drawn else {})


def facts_text(job: ProfileDrawing, path: Path) -> str:
    """What the file is, as JSON."""
    return to_json({"file": path.name, **facts(job)})


def files(job: ProfileDrawing, path: Path) -> dict[str, bytes]:
    """File name -> content: the file itself, and what it is as JSON beside it."""
    return {path.name: format_of(path).content(job), f"{path.name}.json": facts_text(job, path).encode()}


def write_profile(job: ProfileDrawing, path: Path) -> list[Path]:
    """Write the file, and what it is beside it; the paths. Raises FileError, and then nothing has changed."""
    made = files(job, path)
    require_own_json(path.parent / f"{path.name}.json", {"file", "deviation_mm"})
    write_into(path.parent, made, typed=path.name)
    return [path.parent / name for name in made]
