"""Files of a cam's surfaces and solids: the request, a row for each format, and the facts about a file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from core.cam import form_row
from core.design.fields import choice, flag, length, whole
from core.errors import KindynaError
from core.frozen import frozen
from core.motion import degrees
from core.number_text import result_text, rounded_up
from core.numerics.lazy import checkpoint
from core.output.export import csv_header, csv_lines
from core.output.files.fitted_curve import CERTAIN, flank_number
from core.output.files.profile_curve import MM
from core.output.files.profile_files import SENSES
from core.output.files.profile_request import ALL_FLANKS, AT_ONCE, ProfileRequest
from core.output.solids.disk import Prisms, disk_sheets, disk_solids, thickness
from core.output.solids.mesh import prism_triangles, stl_bytes, stl_rounding
from core.output.solids.prism import Prism
from core.output.solids.step import step_bytes
from core.output.summary import to_json
from core.project.files import write_all
from core.requests import option
from core.study import Study

# -- the request ------------------------------------------------------------------------------------------------

TOLERANCE = 0.002  # mm
MOST_ROWS = 5_000_000  # of a table


@frozen
class SurfaceRequest:
    """Surfaces of a cam in a file.

    Attributes
    ----------
    flank : name of one of the cam's flanks; empty: all
    solid : whether the file holds the solid cam instead of its flanks
    tolerance_mm : largest distance of the exact surface from the file
    samples, along : numbers of cam angles and of points across the cam in a table
    """

    flank: str = option(
        choice("Flank", ALL_FLANKS, default="", help="which flank of the cam"), default_text="all flanks"
    )
    solid: bool = flag("Solid", help="the solid cam with bore, keyway and hub instead of its flanks")
    tolerance_mm: float = length(
        "Tolerance", default=TOLERANCE, help="largest distance of the exact surface from that of the file"
    )
    samples: int = option(
        whole("Cam angles", 3, 1_000_000, default=3600, help="equally spaced cam angles of a table"), "--samples"
    )
    along: int = option(
        whole("Points across", 2, 10_000, default=21, help="points of a table at every cam angle, from end to end"),
        "--along",
    )


# -- a job ------------------------------------------------------------------------------------------------------


@frozen(eq=False)
class SurfaceJob:
    """Content of a file of surfaces.

    Attributes
    ----------
    study : the study of the design
    request : the requested surfaces
    content : the file
    prisms : the bodies in it; empty for a table
    deviation : largest distance of the exact surfaces from the file [mm]
    faces : number of faces, of a table its number of flanks
    volume : of all solids [mm³]; None without a solid
    """

    study: Study
    request: SurfaceRequest
    content: bytes
    prisms: tuple[Prism, ...]
    deviation: float
    faces: int
    volume: float | None = None


def _flanks(study: Study, request: SurfaceRequest) -> tuple[str, ...]:
    """The requested flanks. Raises NoSuchStage, KindynaError."""
    study.require_stage("cam")
    if request.flank:
        flank_number(study, ProfileRequest(flank=request.flank))
        return (request.flank,)
    return form_row(study.design.drive.cam.form).flanks


def _prisms(study: Study, request: SurfaceRequest, tolerance: float) -> Prisms:
    flanks = _flanks(study, request)
    if request.solid:
        if request.flank:
            raise KindynaError(
                f"flank {request.flank!r} cannot be combined with a solid, which has all flanks; leave one out"
            )
        return disk_solids(study, tolerance)
    return disk_sheets(study, flanks, tolerance)


def _job(study: Study, request: SurfaceRequest, prisms: Prisms, content: bytes, deviation: float) -> SurfaceJob:
    volume = sum(prism.volume for prism in prisms.prisms) if request.solid else None
    faces = sum(len(prism.body.faces) for prism in prisms.prisms)
    return SurfaceJob(study, request, content, prisms.prisms, deviation, faces, volume)


def shown_prisms(job: SurfaceJob) -> tuple[Prism, ...]:
    """Bodies of a drawing of the file: those in it, of a table the flanks. Raises as `surface_job`."""
    return job.prisms or _prisms(job.study, job.request, TOLERANCE).prisms


def _about(study: Study, request: SurfaceRequest, deviation: float) -> list[str]:
    """Facts about the file in lines, for its header."""
    return [
        f"{'Solid' if request.solid else 'Flanks'} of a disk cam; it turns {SENSES[study.sense][1]} seen from +z",
        "Units: mm; origin: cam centre; the x axis is the global one at cam angle 0",
        f"Deviation from the exact surface: at most {rounded_up(deviation, 4)!r} mm",
    ]


def _step(study: Study, request: SurfaceRequest) -> SurfaceJob:
    prisms = _prisms(study, request, request.tolerance_mm)
    bodies = [prism.body for prism in prisms.prisms]
    content = step_bytes(study.design.name, _about(study, request, prisms.deviation), bodies, {})
    return _job(study, request, prisms, content, prisms.deviation)


CHORDS = 0.8
"""Part of the tolerance that the triangles of an STL file may use; a tenth is for the curve, the rest for rounding."""


def _stl(study: Study, request: SurfaceRequest) -> SurfaceJob:
    prisms = _prisms(study, request, 0.1 * request.tolerance_mm)
    chords = CHORDS * request.tolerance_mm
    triangles = np.concatenate([prism_triangles(prism, chords) for prism in prisms.prisms])
    deviation = prisms.deviation + chords + stl_rounding(triangles)
    if deviation > request.tolerance_mm:
        least = 10.0 * stl_rounding(triangles)
        raise KindynaError(
            f"tolerance {request.tolerance_mm:g} mm: below the accuracy of an STL file of this size; "
            f"allowed: {rounded_up(least, 1):g} mm and more, or a STEP file"
        )
    return _job(study, request, prisms, stl_bytes(study.design.name, triangles), deviation)


COLUMNS = (
    "flank", "roller", "cam_angle_deg", "u_mm", "x_mm", "y_mm", "z_mm", "nx", "ny", "nz", "pressure_angle_deg",
    "curvature_per_mm",
)  # fmt: skip


def _csv(study: Study, request: SurfaceRequest) -> SurfaceJob:
    """Points of the flanks as a table: a row for every cam angle and every height on the cam."""
    if request.solid:
        raise KindynaError("a table holds flanks, not a solid; leave the solid out, or write a STEP or STL file")
    flanks = _flanks(study, request)
    if request.samples * request.along > MOST_ROWS:
        raise KindynaError(
            f"{request.samples} cam angles times {request.along} points are more than {MOST_ROWS} rows; choose fewer"
        )
    parts, size = [csv_header(COLUMNS)], 0.0
    for flank in flanks:
        heights = np.linspace(0.0, thickness(study, flank), request.along)
        angles, start = degrees(request.samples), f"{flank},1,".encode()
        step = max(AT_ONCE // request.along, 1)
        for first in range(0, angles.size, step):
            checkpoint()
            columns = _rows(study, flank, angles[first : first + step], heights)
            size = max(size, float(np.abs(columns[2:4]).max()))
            parts += [start + line for line in csv_lines(COLUMNS[2:], columns).splitlines(keepends=True)]
    return SurfaceJob(study, request, b"".join(parts), (), CERTAIN * size, len(flanks))


def _rows(study: Study, flank: str, angles: np.ndarray, heights: np.ndarray) -> list[np.ndarray]:
    """Columns behind flank and roller, for each of n cam angles [deg] and m heights [mm]."""
    cam_angles = study.program.angles(np.deg2rad(angles))
    samples = study.at(cam_angles).cam.only(flank).flank
    z = samples.profile * MM
    normal = samples.normal * (cam_angles.unit.conj() if study.sense > 0.0 else cam_angles.unit)
    convex = -1.0 if flank == "outer" else 1.0  # the material of a groove is around its outer flank
    values = (angles, z.real, z.imag, normal.real, normal.imag, np.rad2deg(samples.pressure_angle))
    angle, x, y, nx, ny, pressure = (np.repeat(value, heights.size) + 0.0 for value in values)
    curvature = np.repeat(convex * samples.profile_curvature / MM, heights.size) + 0.0
    u = np.tile(heights, angles.size)
    return [angle, u, x, y, u, nx, ny, np.zeros(u.size), pressure, curvature]


# -- formats ----------------------------------------------------------------------------------------------------


@frozen
class SurfaceFormat:
    """One row of ``SURFACE_FORMATS``: its name, whether it holds solids, and the function that builds its content."""

    label: str
    has_solids: bool
    job: Callable[[Study, SurfaceRequest], SurfaceJob]


SURFACE_FORMATS: Mapping[str, SurfaceFormat] = MappingProxyType(
    {
        ".step": SurfaceFormat("STEP AP214", True, _step),
        ".stl": SurfaceFormat("STL, binary", True, _stl),
        ".csv": SurfaceFormat("CSV table of points and normals", False, _csv),
    }
)
"""Ending of the file's name -> its format."""


def surface_job(study: Study, path: Path, request: SurfaceRequest) -> SurfaceJob:
    """Surfaces for a file of this name.

    Raises
    ------
    NoSuchStage, NoCam, KindynaError
        The design has no cam, or not this flank; a dimension is missing; the profile cannot be cut; the format does not exist
        or cannot hold the request.
    """
    row = SURFACE_FORMATS.get(path.suffix.lower())
    if row is None:
        raise KindynaError(
            f"{path}: no format of surfaces for {path.suffix or 'a name without ending'}; "
            f"allowed: {', '.join(SURFACE_FORMATS)}"
        )
    return row.job(study, request)


def facts(job: SurfaceJob) -> dict[str, Any]:
    """Facts about the file: deviation, number of faces, volume of solids."""
    volume = {} if job.volume is None else {"volume_mm3": job.volume}
    return {"deviation_mm": job.deviation, "faces": job.faces, **volume}


def facts_text(job: SurfaceJob) -> str:
    """Facts about the file, as JSON."""
    return to_json(facts(job))


def summary(job: SurfaceJob) -> str:
    """Facts about the file in a sentence."""
    if not job.prisms:
        return f"{job.faces * job.request.samples * job.request.along} points with their normals, on the exact surface"
    volume = "" if job.volume is None else f", {result_text(job.volume, 6)} mm³"
    return f"{job.faces} faces{volume}, at most {rounded_up(job.deviation, 4):g} mm from the exact surface"


def write_surface(job: SurfaceJob, path: Path) -> list[Path]:
    """Write the file and return its path. Raises FileError, and then nothing has changed."""
    write_all(path.parent, {path.name: job.content})
    return [path]
