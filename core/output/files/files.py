"""File formats of a cam's profile or of a cutter's path, a row each."""

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
from core.output.files.fitted_curve import exact_curve, fit_curve
from core.output.files.profile_files import ProfileDrawing, comment, drawn_profiles, facts, layers
from core.output.files.profile_request import ProfileRequest
from core.output.summary import to_json
from core.project.files import require_own_json, write_into
from core.study import Study

# -- CSV --------------------------------------------------------------------------------------------------------


COLUMNS = ("cam_angle_deg", "x_mm", "y_mm", "radius_mm", "polar_angle_deg")


def csv_bytes(job: ProfileDrawing) -> bytes:
    """Points of the curve as CSV, to be read as a closed polyline."""
    at = job.main.points
    z = at.ends.z
    polar = np.mod(np.rad2deg(np.angle(z)), 360.0)
    columns = [at.degrees, z.real, z.imag, np.abs(z), np.where(polar >= 360.0, 0.0, polar)]
    return csv(COLUMNS, [column + 0.0 for column in columns]).encode()  # no minus zero


# -- formats ----------------------------------------------------------------------------------------------------


@frozen
class Format:
    """One row of ``FORMATS``.

    Attributes
    ----------
    label : name of the format
    fits : rows of ``FITS`` that it can hold, the default first
    sampling : the default: a field of the request, and its value
    least_mm : finest tolerance that its readers resolve [mm]
    content : bytes of the file of a job
    drawn : whether it shows all flanks of the cam
    machined : whether a machine follows it, as ``machining`` of the request states
    rounding_mm : fit -> largest error by rounded coordinates [mm]
    require : raises KindynaError for a request that the format cannot hold
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
        ".csv": Format("CSV table", ("polyline",), ("samples", 3600), 1e-9, csv_bytes),
        ".dxf": Format(
            "DXF drawing", ("spline", "polyline", "arcs"), ("tolerance_mm", 1e-3), 1e-9,
            lambda job: profile_files.dxf_bytes(comment(job), layers(job)), drawn=True,
        ),
        ".svg": Format(  # viewers compute with seven digits
            "SVG drawing", ("spline", "polyline", "arcs"), ("tolerance_mm", 1e-3), 1e-6,
            lambda job: profile_files.svg_bytes(comment(job), layers(job)), drawn=True,
        ),
        ".nc": Format(
            "G-code, ISO 6983", ("polyline", "arcs"), ("tolerance_mm", 1e-3), 0.0, profile_files.gcode_bytes, machined=True,
            rounding_mm=profile_files.ROUNDING, require=profile_files.require,
        ),
    }
)  # fmt: skip
"""Ending of the file's name -> its format."""


def format_row(path: Path) -> Format:
    """Format for the ending of a file's name. Raises KindynaError."""
    row = FORMATS.get(path.suffix.lower())
    if row is None:
        raise KindynaError(
            f"{path}: no profile format for {path.suffix or 'a name without ending'}; allowed: {', '.join(FORMATS)}"
        )
    return row


def profile_job(study: Study, path: Path, request: ProfileRequest) -> ProfileDrawing:
    """Curve for a file of this name, with the defaults of its format where the request leaves something open.

    Raises NoSuchStage, NoCam, KindynaError.
    """
    row = format_row(path)
    sampling: dict[str, Any] = {} if request.sampling else dict([row.sampling])
    request = replace(request, fit=request.fit or row.fits[0], **sampling)
    if request.fit not in row.fits:
        raise KindynaError(f"{path.suffix} holds no {request.fit}; allowed: {', '.join(row.fits)}")
    row.require(study, request)
    rounding = row.rounding_mm.get(request.fit, 0.0)
    main = fit_curve(study, exact_curve(study, request), request, max(row.least_mm, 2.0 * rounding), rounding)
    return ProfileDrawing(study, request, main, drawn_profiles(study, request, main, row.least_mm) if row.drawn else {})


def facts_text(job: ProfileDrawing, path: Path) -> str:
    """Facts about the file, as JSON."""
    return to_json({"file": path.name, **facts(job)})


def files(job: ProfileDrawing, path: Path) -> dict[str, bytes]:
    """File name -> content: the file, and its facts as JSON."""
    return {path.name: format_row(path).content(job), f"{path.name}.json": facts_text(job, path).encode()}


def write_profile(job: ProfileDrawing, path: Path) -> list[Path]:
    """Write the file and its facts and return their paths. Raises FileError, and then nothing has changed."""
    contents = files(job, path)
    require_own_json(path.parent / f"{path.name}.json", {"file", "deviation_mm"})
    write_into(path.parent, contents, typed=path.name)
    return [path.parent / name for name in contents]
