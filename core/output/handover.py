"""A hand-over: all files for the workshop, the controls engineer and the buyer, as one folder or archive with a table of contents."""

from __future__ import annotations

import base64
import hashlib
import io
import json
import os
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from core.design import Design
from core.design.fields import number
from core.errors import KindynaError, NoCam, NoSolution
from core.findings import ERROR
from core.frozen import frozen
from core.mechanism.kinematics import FRAME
from core.output.channels import channels, existing
from core.output.controllers.deviation import facts
from core.output.controllers.rows import controller
from core.output.controllers.slave import EcamRequest, drive_slave
from core.output.controllers.table import ecam
from core.output.drawing.scene import MM, Scene, SceneBody, Slide
from core.output.files.files import files as profile_files
from core.output.files.files import profile_job
from core.output.files.inspection import files as inspection_files
from core.output.files.inspection import inspection as inspection_of
from core.output.files.probe import InspectionRequest
from core.output.files.profile_files import facts as profile_facts
from core.output.files.profile_request import ProfileRequest
from core.output.lines import finding_line, printable
from core.output.report.document import Cover, Document, document, numbered_chapters, template_of
from core.output.report.parts import ROUNDING, ReportPicture, Section
from core.output.solids.barrel import has_closed_groove
from core.output.solids.disk import has_solid
from core.output.solids.surface import SurfaceRequest, surface_job
from core.output.summary import to_json
from core.process import resources
from core.project import dumps
from core.project.files import is_folder, read_own, remove_listed, write, write_into
from core.project.origins import with_unlinked_motions
from core.requests import option, text_option
from core.spatial.views import CamViews
from core.study import Study, findings_of
from core.study.quantities import shape_of
from core.study.spatial_views import spatial_views

# -- web page ---------------------------------------------------------------------------------------------------


ANGLES = 720
POSES, EDGE_STEP = 120, 6  # of the side view of a cam in space over the turn; points of its edges from one to the next
"""Number of stored positions in a turn."""
SECONDS = 6.0
"""Initial duration of a turn."""
POSITION_DECIMALS, CURVE_DIGITS = 9, 7
"""Decimals of a position in mm and of an angle in degrees; digits of a curve's values."""
SHOWN = ("displacement", "acceleration", "pressure_angle", "contact_force", "drive_torque", "driver_torque")
LINK_CURVES, FEWEST = ("link.{}_velocity", "transmission.{}"), 2
"""Curves that are initially visible unless they are 0; with fewer than ``FEWEST`` of them, also those of links."""
PARTS, FINDINGS = ("inputs", "certificate"), "Findings"
"""Parts of the report below the curves."""
PAGE, PROGRAM = "web_page.html.jinja", "web_page.js"


def web_page(study: Study) -> str:
    """A web page with an animated model as HTML, without any request to a server.

    Styles and program are included, and a content security policy allows only these. Raises NoSolution where the design, or each
    of its drives, has no mechanism.
    """
    program = (resources() / PROGRAM).read_text("utf-8")
    digest = base64.b64encode(hashlib.sha256(program.encode()).digest()).decode()
    report = document(study, PARTS)
    return template_of(PAGE).render(
        document=report,
        chapters=list(_chapters(report)),
        findings=[(finding.severity, finding_line(finding, study.angle_name)) for finding in findings_of(study)],
        data=_json(page_data(study)),
        program=program,
        policy=f"default-src 'none'; style-src 'unsafe-inline'; script-src 'sha256-{digest}'; base-uri 'none'; form-action 'none'",
    )


def _chapters(report: Document) -> Iterator[tuple[str, Section, list[Section]]]:
    """Chapters with text: findings are above all of them, and plots are drawn by the page's program."""
    for count, chapter, inside in numbered_chapters(report):
        sections = [section for section in inside if section.title != FINDINGS]
        if sections or any(not isinstance(block, ReportPicture) for block in chapter.blocks):
            yield count, chapter, sections


def write_page(study: Study, path: Path) -> tuple[Path]:
    """Write the page. Raises as `web_page`; FileError where it cannot be written."""
    write(path, web_page(study).encode())
    return (path,)


def _json(data: Any) -> str:
    """JSON for a script element: no text in it can end the element."""
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


# -- data of the page --------------------------------------------------------------------------------------


def page_data(study: Study, angles: int = ANGLES) -> dict[str, Any]:
    """Data of the page's program: machines with the positions of their bodies and their curves, at equally spaced angles.

    The angles are those of shaft or crank, for listed drives those of the machine.
    """
    machines = [
        {"name": printable(name), **_machine_data(drive, phase)}
        for name, phase, drive in _drives(Study(study.design, angles))
    ]
    return {
        "name": printable(study.design.name),
        "angle": "machine angle" if study.design.listed else study.angle_name,
        "seconds": SECONDS,
        "machines": machines,
    }


def _drives(study: Study) -> Iterator[tuple[str, float, Study]]:
    if not study.design.listed:
        yield "", 0.0, study
        return
    yield from (
        (name, drive.phase, drive_study)
        for (name, drive_study), drive in zip(study.drives.items(), study.design.drives, strict=True)
        if name not in study.camshaft.failures
    )


def _machine_data(study: Study, phase: float) -> dict[str, Any]:
    """Angles and positions by the drive's angle, which lags behind the machine by ``phase`` [deg]."""
    scene, views = Scene(study), _views(study)
    stem, blocks = scene.stem, {slide.body for slide in scene.slides}
    bodies = [
        {
            "name": name,
            "fixed": name == FRAME,
            "slides": name in blocks,
            "stem": _stem(scene, stem) if stem is not None and stem.body == name else None,
            "points": [[point, *_xy(at)] for point, at in body.points.items()],
            "rollers": [] if views is None or name == FRAME else _rollers(views, study, body),
            **_track(body.z, body.angle),
        }
        for name, body in scene.bodies.items()
    ]
    return {
        "phase": phase,
        "sense": study.sense,
        "angles": _rounded(study.angle_degrees),
        "whole": study.angle_degrees.size == study.samples,
        "cam": _cam(scene),
        "space": None if views is None else _space(views, study),
        "bodies": bodies,
        "fixed": _fixed(scene),
        "curves": _with_initial_curves(list(_curves(study)), study),
    }


def _stem(scene: Scene, slide: Slide) -> list[float]:
    """End of the stem of a translating follower in its frame: away from the cam, as long as the cam is large."""
    body = scene.bodies[slide.body]
    return _xy(complex(slide.outwards * slide.line[0] * np.exp(-1j * body.angle[0])) * float(np.abs(body.z).max()))


def _fixed(scene: Scene) -> list[dict[str, Any]]:
    """Pins and guides on the frame."""
    pins = [{"name": name, "at": _xy(at)} for name, at in scene.pivots.items()]
    guides = [
        {"name": slide.name, "at": _xy(slide.z[0]), "guide": [_xy(slide.z[0] + slide.line[0] * end) for end in ends]}
        for slide in scene.slides
        for ends in [(slide.low, slide.high)]
        if slide.on == FRAME
    ]
    return [*pins, *guides]


def _cam(scene: Scene) -> dict[str, Any] | None:
    """Outlines in the cam's frame, and the follower's face around its reference point with further rollers."""
    face = scene.face
    if face is None:
        return None
    body = scene.face_body
    return {
        "flanks": [[_xy(at) for at in profile] for profile in scene.flanks.values()],
        "keyway": [_xy(at) for at in scene.keyway],
        "circles": [_short(radius) for radius in scene.circles.values()],
        "face": {"outline": [_xy(at) for at in face.outline], **_track(body.z, body.angle)},
        "rollers": [{"radius": _short(radius), **_track(z, 0.0 * body.angle)} for radius, z in scene.further_rollers],
    }


def _views(study: Study) -> CamViews | None:
    """Side view and end view of a cam in space; None where there is none."""
    try:
        return spatial_views(study) if study.has_surface else None
    except NoSolution:
        return None


def _rollers(views: CamViews, study: Study, body: SceneBody) -> list[list[list[float]]]:
    """Outlines of the rollers in the side view, in the frame of the output that carries them."""
    outlines = (roller.side * MM for roller in views.rollers(float(study.surface.motion.y[0])))
    return [[_xy(at) for at in ((points - body.z[0]) * body.unit[0].conjugate()).tolist()] for points in outlines]


def _space(views: CamViews, study: Study) -> dict[str, Any]:
    """End view of a cam in space, and its side view in poses of equal angles: the outline, then the visible edges."""
    outer, inner = views.radii
    angles = study.sense * 2.0 * np.pi * np.arange(POSES) / POSES
    return {
        "at": _xy(views.end_origin * MM),
        "start": _short(np.rad2deg(np.angle(views.axes.end[0]))),
        "radii": [_short(outer * MM), _short(inner * MM)],
        "poses": [[_line(views.outline(angle), 1), *_edges(views, angle)] for angle in angles.tolist()],
    }


def _edges(views: CamViews, angle: float) -> list[list[list[float]]]:
    return [_line(edge, EDGE_STEP) for is_visible, edge in views.edges_at(angle) if is_visible]


def _line(points: np.ndarray, step: int) -> list[list[float]]:
    """Every ``step``-th point [mm] of a line, to a hundredth of a millimetre, and its end."""
    kept = np.append(points[:-1:step], points[-1:]) * MM
    return [[round(at.real, 2) + 0.0, round(at.imag, 2) + 0.0] for at in kept.tolist()]


def _with_initial_curves(rows: list[dict[str, Any]], study: Study) -> list[dict[str, Any]]:
    """Curves, of which enough are initially visible."""
    if sum(row["shown"] for row in rows) < FEWEST:
        of_links = {row.slug for row in channels(study.design) if shape_of(row.name) in LINK_CURVES}
        rows = [{**row, "shown": row["shown"] or row["slug"] in of_links} for row in rows]
    return rows


def _curves(study: Study) -> Iterator[dict[str, Any]]:
    """Channels with a value at every angle, except angles that rotate continuously."""
    for row in existing(study, channels(study.design, [stage for stage in study.stages if stage != "stability"])):
        if row.is_periodic:
            continue
        try:
            values = row.values(study)
        except NoSolution:  # no forces where a guide jams
            continue
        if np.isfinite(values).all():
            values = np.where(np.abs(values) > ROUNDING * np.abs(values).max(), values, 0.0)
            yield {
                "slug": row.slug,
                "label": row.label,
                "symbol": row.symbol,
                "unit": row.unit.symbol,
                "shown": row.name in SHOWN and bool(values.any()),
                "values": [float(f"{value:.{CURVE_DIGITS}g}") for value in values.tolist()],
            }


def _short(value: float) -> float:
    return round(float(value), POSITION_DECIMALS) + 0.0


def _xy(at: complex) -> list[float]:
    """Point as x, y."""
    return [_short(at.real), _short(at.imag)]


def _rounded(values: Iterable[float]) -> list[float]:
    return [_short(value) for value in values]


def _track(origin: np.ndarray, turn: np.ndarray) -> Mapping[str, list[float]]:
    """Position of a body: x, y, turn [deg]."""
    return {"x": _rounded(origin.real), "y": _rounded(origin.imag), "turn": _rounded(np.rad2deg(turn))}


# -- hand-over --------------------------------------------------------------------------------------------------


CONTENTS, ARCHIVE = "contents.json", ".zip"
EARLIEST = (1980, 1, 1, 0, 0, 0)  # earliest time in an archive: the same design gives the same bytes


@frozen
class HandoverRequest(Cover):
    """Options of a hand-over: entries of report and drawings, controller, G-code, accuracy."""

    controller: str = text_option(
        "controller (row of controllers.toml) for a table of each drive", default="", metavar="SLUG"
    )
    error_mm: float = option(
        number("Largest error", 0.0, 1.0, open_low=True, default=1e-3, help="of profiles, and of a controller's table"),
        "--error",
        metavar="MM",
    )
    gcode: bool = text_option("also G-code of every cam", default=False, action="store_true")


@frozen(eq=False)
class HandoverFile:
    """A file of a hand-over.

    Attributes
    ----------
    name : name with its folder
    what : description
    deviation : largest deviation from the exact curve, with its unit; None where nothing is fitted
    """

    name: str
    what: str
    data: bytes
    deviation: tuple[float, str] | None = None


@frozen(eq=False)
class Handover:
    """Files of a hand-over, and files that this design cannot have: description and reason."""

    files: tuple[HandoverFile, ...]
    left_out: tuple[tuple[str, str], ...]

    def with_files(self, added: Iterable[HandoverFile], left_out: Iterable[tuple[str, str]] = ()) -> Handover:
        """Hand-over with further files, such as drawings that need fonts; in order of their names."""
        files = sorted((*self.files, *added), key=lambda file: file.name)
        return Handover(tuple(files), (*self.left_out, *left_out))

    @property
    def contents(self) -> dict[str, Any]:
        """Contents of ``contents.json``: name, what, deviation, sha256 of each file; and the files left out."""
        rows = [
            {
                "name": file.name,
                "what": file.what,
                "deviation": None if file.deviation is None else file.deviation[0],
                "unit": None if file.deviation is None else file.deviation[1],
                "sha256": hashlib.sha256(file.data).hexdigest(),
            }
            for file in self.files
        ]
        return {"files": rows, "left_out": [{"what": what, "why": why} for what, why in self.left_out]}

    def write(self, out: Path) -> None:
        """Write an empty or new folder, or a zip archive; an unchanged earlier hand-over is replaced.

        Raises KindynaError, FileError; then nothing has changed.
        """
        contents: dict[str, str | bytes] = {file.name: file.data for file in self.files}
        contents[CONTENTS] = to_json(self.contents)
        archive = out.suffix.lower() == ARCHIVE
        exists = os.path.lexists(out) if archive else out.is_dir() and any(out.iterdir())
        previous = (_names_in_archive if archive else _names_in_folder)(out) if exists else []
        if previous is None:
            problem = "file exists already" if archive else "folder is not empty"
            allowed = "another name" if archive else "an empty or new one, or NAME.zip"
            raise KindynaError(f"{out}: this {problem} and is not, or not only, a hand-over; allowed: {allowed}")
        if archive:
            write(out, _zip_bytes(contents))
        else:
            write_into(out, contents)
            remove_listed(out, set(previous) - contents.keys())


# -- earlier hand-over --------------------------------------------------------------------------------------

MOST_UNPACKED = 1 << 28
"""Bytes; every hand-over is smaller."""


def _names_in_archive(path: Path) -> list[str] | None:
    """Files of an unchanged hand-over; None for any other archive: with a comment, a folder, a file twice."""
    with suppress(Exception):  # archives from anywhere fail in many ways
        data = read_own(path)
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            rows = archive.infolist()
            size = 22 + sum(76 + 2 * len(row.filename.encode()) + row.compress_size for row in rows)
            if size == len(data) and sum(row.file_size for row in rows) <= MOST_UNPACKED:
                return _verified_names([row.filename for row in rows], archive.read)
    return None


def _names_in_folder(path: Path) -> list[str] | None:
    """Files of an unchanged hand-over; None for any other folder, and for a link to one."""
    with suppress(Exception):  # lists of contents from anywhere fail in many ways
        if is_folder(path):
            return _verified_names(_files_in(path), lambda name: read_own(path / name))
    return None


def _files_in(path: Path) -> Iterator[str]:
    """Names of files and links; names of empty folders and of links to folders end with a slash."""
    for folder, folders, names in os.walk(path):
        inside = Path(folder).relative_to(path)
        yield from ((inside / name).as_posix() for name in names)
        yield from (f"{inside / name}/" for name in folders if not is_folder(Path(folder, name)))
        if not folders and not names:
            yield f"{inside}/"


def _verified_names(names: Iterable[str], read: Callable[[str], bytes]) -> list[str] | None:
    """Names in the list of contents, where it has all names except itself, with their sha256."""
    hashes = {row["name"]: row["sha256"] for row in json.loads(read(CONTENTS))["files"]}
    is_same = sorted(names) == sorted([*hashes, CONTENTS]) and all(
        hashlib.sha256(read(name)).hexdigest() == value for name, value in hashes.items()
    )
    return [*hashes] if is_same else None


def _zip_bytes(files: dict[str, str | bytes]) -> bytes:
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            archive.writestr(zipfile.ZipInfo(name, EARLIEST), files[name], zipfile.ZIP_DEFLATED)
    return target.getvalue()


def handover(study: Study, request: HandoverRequest) -> Handover:
    """Files without fonts: profiles, inspection tables, tables of a controller, web page, the design.

    Raises KindynaError for an unknown controller, NoSolution where the design has none.
    """
    if request.controller:
        controller(request.controller)
    files = [
        HandoverFile(
            "design.toml", "the design, to open in KINDYNA", dumps(with_unlinked_motions(study.design)).encode()
        )
    ]
    left_out: list[tuple[str, str]] = []
    for folder, name, drive in drive_folders(study):
        for description, build in _file_builders(study.design, folder, name, drive, request):
            try:
                files += build()
            except KindynaError as error:
                left_out.append((f"{description}, {name}" if name else description, str(error)))
    files.append(HandoverFile("machine.html", "a page that plays the machine in any browser", web_page(study).encode()))
    return Handover((), tuple(left_out)).with_files(files)


def drive_folders(study: Study) -> Iterator[tuple[str, str, Study]]:
    """Folder with its slash, name, and study of each drive; folder and name of a single drive are empty."""
    if not study.design.listed:
        yield "", "", study
        return
    camshaft = study.camshaft
    yield from ((f"{camshaft.slugs[name]}/", name, drive_study) for name, drive_study in study.drives.items())


def _file_builders(
    design: Design, folder: str, name: str, study: Study, request: HandoverRequest
) -> Iterator[tuple[str, Callable[[], Sequence[HandoverFile]]]]:
    of_drive = f" of {name}" if name else ""
    if study.has_disk:
        yield "profile", lambda: _profile(study, folder, of_drive, request, ".dxf")
        if request.gcode:
            yield "G-code", lambda: _profile(study, folder, of_drive, request, ".nc")
        yield "inspection table", lambda: _inspection(study, folder, of_drive)
    if study.has_surface or (study.has_disk and has_solid(study.design.drive.cam)):
        yield "surfaces", lambda: _surfaces(study, folder, of_drive, request)
    if study.has_surface and request.gcode:
        yield "G-code", lambda: _barrel_path(study, folder, of_drive, request)
    if request.controller:
        yield "table of the controller", lambda: _controller(design, folder, name, request)


def _profile(study: Study, folder: str, of_drive: str, request: HandoverRequest, ending: str) -> list[HandoverFile]:
    path = Path(f"profile{ending}")
    fit = "arcs" if ending == ".nc" else ""
    job = profile_job(study, path, ProfileRequest(tolerance_mm=request.error_mm, fit=fit))
    deviation = float(profile_facts(job)["deviation_mm"]), "mm"
    return [
        HandoverFile(
            folder + name,
            f"profile of the cam{of_drive}" if name == path.name else f"facts about {path.name}, as JSON",
            data,
            deviation if name == path.name else None,
        )
        for name, data in profile_files(job, path).items()
    ]


def _surfaces(study: Study, folder: str, of_drive: str, request: HandoverRequest) -> list[HandoverFile]:
    """The solid of a disk cam or of a barrel groove whose blank contains it, otherwise the flanks of a cam in space."""
    path, reason = Path("cam.step"), ""
    flanks = SurfaceRequest(tolerance_mm=request.error_mm)
    is_solid = study.has_disk or has_closed_groove(study.design)
    try:
        job = surface_job(study, path, replace(flanks, solid=is_solid))
    except NoCam as error:
        if study.has_disk or not is_solid:
            raise
        job, is_solid, reason = surface_job(study, path, flanks), False, f"; no solid: {error}"
    what = "solid" if is_solid else "flanks"
    return [
        HandoverFile(
            f"{folder}cam.step", f"{what} of the cam{of_drive}, STEP AP214{reason}", job.content, (job.deviation, "mm")
        )
    ]


def _barrel_path(study: Study, folder: str, of_drive: str, request: HandoverRequest) -> list[HandoverFile]:
    job = surface_job(study, Path("cam.nc"), SurfaceRequest(tolerance_mm=request.error_mm))
    what = f"path of a cutter as large as the roller{of_drive}, G-code with a rotary axis"
    return [HandoverFile(f"{folder}cam.nc", what, job.content, (job.deviation, "mm"))]


def _inspection(study: Study, folder: str, of_drive: str) -> list[HandoverFile]:
    table = inspection_of(study, InspectionRequest())
    if errors := [finding.message for finding in table.setup.findings if finding.severity == ERROR]:
        raise KindynaError(errors[0])
    texts = inspection_files(table, Path("inspection.csv"))
    words = {"inspection.csv": f"lift that a probe measures on the cam{of_drive}, with its tolerance"}
    facts = "probe and tolerance of inspection.csv, as JSON"
    return [HandoverFile(folder + name, words.get(name, facts), data) for name, data in texts.items()]


def _controller(design: Design, folder: str, name: str, request: HandoverRequest) -> list[HandoverFile]:
    row, ecam_request = controller(request.controller), EcamRequest(error=request.error_mm)
    slave, title, speed = drive_slave(design, name, ecam_request)
    table = ecam(slave, row, ecam_request, title, speed)
    deviation = None if table.deviation is None else (float(table.deviation.values[0]), slave.unit)
    of_drive = f" of {name}" if name else ""
    return [
        HandoverFile(
            f"{folder}controller{row.extension}", f"table for {row.label}{of_drive}", table.content, deviation
        ),
        HandoverFile(f"{folder}controller.json", "its certificate, as JSON", to_json(facts(table)).encode()),
    ]
