"""Files of a cam's surfaces and solids: the request, a row for each format, and the facts about a file."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np

from core.cam import OUTER, form_row
from core.design.fields import choice, flag, length, whole
from core.errors import KindynaError
from core.frozen import frozen
from core.motion import degrees
from core.number_text import result_text, rounded_up
from core.numerics.lazy import checkpoint
from core.output.export import csv_header, csv_lines
from core.output.files.fitted_curve import CERTAIN
from core.output.files.profile_curve import MM
from core.output.files.profile_files import SENSES
from core.output.files.profile_request import ALL_FLANKS, AT_ONCE, Machining
from core.output.solids.barrel import BarrelSolid, barrel_solid, has_closed_groove
from core.output.solids.barrel_path import barrel_path, gcode_bytes
from core.output.solids.blank import UncutBlank, uncut_blank
from core.output.solids.disk import Prisms, disk_sheets, disk_solids, thickness
from core.output.solids.mesh import stl_bytes, stl_rounding
from core.output.solids.patches import TooFine
from core.output.solids.plates import body_plates
from core.output.solids.step import step_bytes
from core.output.solids.strips import Strips, spatial_rows, spatial_strips
from core.output.summary import to_json
from core.project.files import write_all
from core.requests import option, request_fields, text_option
from core.study import Study

# -- the request ------------------------------------------------------------------------------------------------

TOLERANCE = 0.002  # mm
SIDES, BOTH = ("ahead", "behind"), "both"
"""Flanks of a cam in space; both flanks of a cam that has two."""
MOST_ROWS = 5_000_000  # of a table


@frozen
class SurfaceRequest:
    """Surfaces of a cam in a file.

    Attributes
    ----------
    flank : name of one of the cam's flanks; empty: all
    solid : whether the file holds the solid cam instead of its flanks, or an uncut blank next to them
    of : name of a body with outlines, whose plate is written instead of the cam
    tolerance_mm : largest distance of the exact surface from the file
    samples, along : numbers of cam angles and of points across the cam in a table
    machining : machining data of a cutter's path
    """

    flank: str = option(
        choice("Flank", (*ALL_FLANKS, *SIDES, BOTH), default="", help="which flank of the cam"),
        default_text="all flanks",
    )
    solid: bool = flag(
        "Solid",
        help="the solid cam with bore, keyway and hub instead of its flanks; where a cam in space has none, the uncut blank next to them",
    )
    tolerance_mm: float = length(
        "Tolerance", default=TOLERANCE, help="largest distance of the exact surface from that of the file"
    )
    of: str = text_option(
        "the plate of a body with [[outlines]] and a layer, such as 'link 3' or feed.arm, instead of the cam",
        "--of",
        default="",
        metavar="BODY",
    )
    samples: int = option(
        whole("Cam angles", 3, 1_000_000, default=3600, help="equally spaced cam angles of a table"), "--samples"
    )
    along: int = option(
        whole("Points across", 2, 10_000, default=21, help="points of a table at every cam angle, from end to end"),
        "--along",
    )
    machining: Machining = Machining()


Surfaces: TypeAlias = Prisms | Strips | BarrelSolid | UncutBlank


# -- a job ------------------------------------------------------------------------------------------------------


@frozen(eq=False)
class SurfaceJob:
    """Content of a file of surfaces.

    Attributes
    ----------
    study : the study of the design
    request : the requested surfaces
    content : the file
    surfaces : the bodies in it; None for a table or a path
    deviation : largest distance of the exact surfaces from the file [mm]
    faces : number of faces, of a table or a path its number of flanks
    about_points : points of a table or a path in a sentence
    """

    study: Study
    request: SurfaceRequest
    content: bytes
    surfaces: Surfaces | None
    deviation: float
    faces: int
    about_points: str = ""

    @property
    def volume(self) -> float | None:
        """Volume of all solids [mm³]; None without a solid."""
        return None if self.surfaces is None else self.surfaces.volume

    @property
    def is_uncut(self) -> bool:
        """Whether the flanks are next to a blank that they do not cut."""
        return isinstance(self.surfaces, UncutBlank)


def _flanks(study: Study, request: SurfaceRequest) -> tuple[str, ...]:
    """The requested flanks. Raises KindynaError."""
    if "cam" not in study.stages:
        raise KindynaError("surface: this design has no cam; allowed: one with [cam]")
    flanks = SIDES if study.has_surface else form_row(study.design.drive.cam.form).flanks
    if request.solid and request.flank not in ("", BOTH):
        raise KindynaError(
            f"flank {request.flank!r} cannot be combined with a solid, which has all flanks; leave one out"
        )
    allowed = (*flanks, BOTH) if len(flanks) == 2 else flanks
    if request.flank and request.flank not in allowed:
        raise KindynaError(f"flank {request.flank!r}: this cam has none of that name; allowed: {', '.join(allowed)}")
    return (request.flank,) if request.flank in flanks else flanks


def _surfaces(study: Study, request: SurfaceRequest, tolerance: float) -> Surfaces:
    if request.of:
        if request.flank:
            raise KindynaError(f"flank {request.flank!r} cannot be combined with a plate; leave one out")
        return body_plates(study, request.of)
    flanks = _flanks(study, request)
    if study.has_surface:
        if request.solid:
            return (barrel_solid if has_closed_groove(study.design) else uncut_blank)(study, tolerance)
        return spatial_strips(study, flanks, tolerance)
    return disk_solids(study, tolerance) if request.solid else disk_sheets(study, flanks, tolerance)


def drawn_surfaces(job: SurfaceJob) -> Surfaces:
    """Bodies for a drawing of the file: those in it, of a table or a path the flanks. Raises as `surface_job`."""
    return job.surfaces or _surfaces(job.study, job.request, TOLERANCE)


def _job(study: Study, request: SurfaceRequest, surfaces: Surfaces, content: bytes, deviation: float) -> SurfaceJob:
    faces = sum(len(body.faces) for body in surfaces.bodies)
    return SurfaceJob(study, request, content, surfaces, deviation, faces)


UNCUT = "Flanks and blank side by side, the blank not cut,"


def _about(study: Study, request: SurfaceRequest, surfaces: Surfaces) -> list[str]:
    """Facts about the file in lines, for its header."""
    deviation = surfaces.deviation
    if request.of:
        kind = f"Plate of {request.of}, in its frame, z across its plane"
        return [kind, "Units: mm", f"Deviation from the exact outline: at most {rounded_up(deviation, 4)!r} mm"]
    kind = f"{study.design.drive.cam.kind} cam" if study.has_surface else "disk cam"
    what = UNCUT if isinstance(surfaces, UncutBlank) else "Solid" if request.solid else "Flanks"
    return [
        f"{what} of a {kind}; it turns {SENSES[study.sense][1]} seen from +z",
        "Units: mm; origin: cam centre; the x axis is the global one at cam angle 0",
        f"Deviation from the exact surface: at most {rounded_up(deviation, 4)!r} mm",
    ]


def _step(study: Study, request: SurfaceRequest) -> SurfaceJob:
    surfaces = _surfaces(study, request, request.tolerance_mm)
    about = _about(study, request, surfaces)
    content = step_bytes(study.design.name, about, surfaces.bodies, surfaces.points)
    return _job(study, request, surfaces, content, surfaces.deviation)


CHORDS = 0.8
"""Part of the tolerance that the triangles of an STL file may use; a tenth is for the surface, the rest for rounding."""


def _stl(study: Study, request: SurfaceRequest) -> SurfaceJob:
    chords = CHORDS * request.tolerance_mm
    try:
        surfaces = _surfaces(study, request, 0.1 * request.tolerance_mm)
        triangles = surfaces.triangles(chords)
    except TooFine as error:  # of a part of the tolerance
        raise TooFine(request.tolerance_mm, error.requirement, error.remedy) from None
    deviation = surfaces.deviation + chords + stl_rounding(triangles)
    if deviation > request.tolerance_mm:
        least = 10.0 * stl_rounding(triangles)
        raise KindynaError(
            f"tolerance {request.tolerance_mm:g} mm: below the accuracy of an STL file of this size; "
            f"allowed: {rounded_up(least, 1):g} mm and more, or a STEP file"
        )
    return _job(study, request, surfaces, stl_bytes(study.design.name, triangles), deviation)


# -- tables -----------------------------------------------------------------------------------------------------


COLUMNS = (
    "flank", "roller", "cam_angle_deg", "u_mm", "x_mm", "y_mm", "z_mm", "nx", "ny", "nz", "pressure_angle_deg",
    "curvature_per_mm",
)  # fmt: skip


def _csv(study: Study, request: SurfaceRequest) -> SurfaceJob:
    """Points of the flanks as a table: a row for every cam angle and every place across the cam."""
    if request.solid or request.of:
        raise KindynaError("a table holds flanks, not a solid; leave the solid out, or write a STEP or STL file")
    flanks = _flanks(study, request)
    if request.samples * request.along > MOST_ROWS:
        raise KindynaError(
            f"{request.samples} cam angles times {request.along} points are more than {MOST_ROWS} rows; choose fewer"
        )
    angles, parts, size, rows = degrees(request.samples), [csv_header(COLUMNS)], 0.0, 0
    step = max(AT_ONCE // request.along, 1)
    blocks = [angles[first : first + step] for first in range(0, angles.size, step)]
    table = spatial_rows if study.has_surface else _disk_rows
    for flank in flanks:
        by_roller: dict[int, list[bytes]] = {}
        for roller, block in table(study, flank, blocks, request.along):
            checkpoint()
            size, rows = max(size, float(np.abs(block[2:5]).max(initial=0.0))), rows + block[0].size
            lines = csv_lines(COLUMNS[2:], block).splitlines(keepends=True) if block[0].size else []
            by_roller.setdefault(roller, []).extend(f"{flank},{roller},".encode() + line for line in lines)
        parts += [line for roller in sorted(by_roller) for line in by_roller[roller]]
    return SurfaceJob(
        study,
        request,
        b"".join(parts),
        None,
        CERTAIN * size,
        len(flanks),
        f"{rows} points with their normals, on the exact surface",
    )


def _disk_rows(
    study: Study, flank: str, blocks: list[np.ndarray], along: int
) -> Iterator[tuple[int, list[np.ndarray]]]:
    """Roller, and columns behind it, for each block of cam angles [deg], at equal heights on the cam."""
    heights = np.linspace(0.0, thickness(study, flank), along)
    convex = -1.0 if flank == OUTER else 1.0  # the material of a groove is around its outer flank
    for angles in blocks:
        cam_angles = study.program.angles(np.deg2rad(angles))
        samples = study.at(cam_angles).cam.only(flank).flank
        z = samples.profile * MM
        normal = samples.normal * (cam_angles.unit.conj() if study.sense > 0.0 else cam_angles.unit)
        values = (angles, z.real, z.imag, normal.real, normal.imag, np.rad2deg(samples.pressure_angle))
        angle, x, y, nx, ny, pressure = (np.repeat(value, heights.size) + 0.0 for value in values)
        curvature = np.repeat(convex * samples.profile_curvature / MM, heights.size) + 0.0
        u = np.tile(heights, angles.size)
        yield 1, [angle, u, x, y, u, nx, ny, np.zeros(u.size), pressure, curvature]


# -- the path of a cutter ---------------------------------------------------------------------------------------


def _nc(study: Study, request: SurfaceRequest) -> SurfaceJob:
    """Path of a cutter as large as the roller, for both flanks of the groove of a barrel cam."""
    if request.solid or request.of:
        raise KindynaError(
            "G-code has the path of a cutter, no solid; leave the solid out, or write a STEP or STL file"
        )
    if "cam" in study.stages and not study.has_surface:
        raise KindynaError("surface: G-code of a disk cam is written by the command profile")
    flanks = _flanks(study, request)
    if len(flanks) == 1:
        raise KindynaError(f"flank {request.flank!r}: the path cuts both flanks of a groove; leave the flank out")
    path = barrel_path(study, request.tolerance_mm, request.machining)
    about = f"{path.points} points of the cutter's path, flanks at most {rounded_up(path.deviation, 4):g} mm from the exact ones"
    return SurfaceJob(study, request, gcode_bytes(path), None, path.deviation, len(flanks), about)


# -- formats ----------------------------------------------------------------------------------------------------


@frozen
class SurfaceFormat:
    """One row of ``SURFACE_FORMATS``.

    Attributes
    ----------
    label : name of the format
    job : function that builds its content
    fields : fields of the request that only some formats have
    has_solids : whether it holds solids
    has_disks : whether it holds surfaces of disk cams
    """

    label: str
    job: Callable[[Study, SurfaceRequest], SurfaceJob]
    fields: tuple[str, ...] = ("tolerance_mm",)
    has_solids: bool = False
    has_disks: bool = True


MACHINING = tuple(part.name for part in request_fields(Machining))
SURFACE_FORMATS: Mapping[str, SurfaceFormat] = MappingProxyType(
    {
        ".step": SurfaceFormat("STEP AP214", _step, has_solids=True),
        ".stl": SurfaceFormat("STL, binary", _stl, has_solids=True),
        ".csv": SurfaceFormat("CSV table of points and normals", _csv, ("samples", "along")),
        ".nc": SurfaceFormat("G-code with a rotary axis", _nc, ("tolerance_mm", *MACHINING), has_disks=False),
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
    """Facts about the file: deviation, number of faces, volume of solids, and of a blank that it is not cut."""
    volume = {} if job.volume is None else {"volume_mm3": job.volume}
    uncut = {"blank_is_cut": False} if job.is_uncut else {}
    return {"deviation_mm": job.deviation, "faces": job.faces, **volume, **uncut}


def facts_text(job: SurfaceJob) -> str:
    """Facts about the file, as JSON."""
    return to_json(facts(job))


def summary(job: SurfaceJob) -> str:
    """Facts about the file in a sentence."""
    if job.surfaces is None:
        return job.about_points
    volume = "" if job.volume is None else f", {result_text(job.volume, 6)} mm³"
    uncut = "; flanks and blank are side by side: the blank is not cut" if job.is_uncut else ""
    return f"{job.faces} faces{volume}, at most {rounded_up(job.deviation, 4):g} mm from the exact surface{uncut}"


def write_surface(job: SurfaceJob, path: Path) -> list[Path]:
    """Write the file and return its path. Raises FileError, and then nothing has changed."""
    write_all(path.parent, {path.name: job.content})
    return [path]
