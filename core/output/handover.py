"""All of a design that its workshop, its controls engineer and its buyer ask for: one folder or archive with a list of contents."""

from __future__ import annotations

import base64
import hashlib
import io
import json
import os
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from core.cam import keyway_corners, row_of
from core.design import Design
from core.design.fields import number
from core.errors import KindynaError, NoSolution
from core.findings import ERROR
from core.frozen import frozen
from core.mechanism.kinematics import FRAME, SLIDING
from core.output.channels import channels, existing
from core.output.controllers.deviation import facts
from core.output.controllers.rows import controller
from core.output.controllers.slave import EcamRequest, drive_slave
from core.output.controllers.table import ecam
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
from core.output.summary import to_json
from core.process import resources
from core.project import dumps
from core.project.files import is_folder, read_own, remove_listed, write, write_into
from core.project.origins import with_own_motions
from core.requests import option, text_option
from core.study import Study, findings_of
from core.study.quantities import shape_of

# -- A design as one web page that needs nothing beside it ------------------------------------------------------


ANGLES = 720
"""Positions of a turn that are stored."""
SECONDS = 6.0
"""That a turn takes where the page opens."""
PLACE_DIGITS, CURVE_DIGITS = 9, 7
"""Decimals of a place in mm and of an angle in degrees; digits of a curve's values."""
SHOWN = ("displacement", "acceleration", "pressure_angle", "contact_force", "drive_torque", "driver_torque")
OF_LINKS, FEWEST = ("link.{}_velocity", "transmission.{}"), 2
"""Curves that stand there where the page opens, those that are 0 throughout aside; those of links where there are fewer than that; the
others by choice."""
PARTS, FINDINGS = ("inputs", "certificate"), "Findings"
"""What of the report stands below."""
PAGE, PROGRAM = "web_page.html.jinja", "web_page.js"
_MM = 1e3


def web_page(study: Study) -> str:
    """The page as HTML. Raises NoSolution where the design, or each of its drives, has no mechanism.

    Nothing is asked of any server: styles and program stand inside, and a content security policy allows these alone.
    """
    program = (resources() / PROGRAM).read_text("utf-8")
    digest = base64.b64encode(hashlib.sha256(program.encode()).digest()).decode()
    made = document(study, PARTS)
    return template_of(PAGE).render(
        document=made,
        chapters=list(_chapters(made)),
        findings=[(each.severity, finding_line(each, study.angle_name)) for each in findings_of(study)],
        data=_json(stored(study)),
        program=program,
        policy=f"default-src 'none'; style-src 'unsafe-inline'; script-src 'sha256-{digest}'; base-uri 'none'; form-action 'none'",
    )


def _chapters(made: Document) -> Iterator[tuple[str, Section, list[Section]]]:
    """Those in which something is left to read: the findings stand above all, and pictures are left to the page's program."""
    for count, chapter, inside in numbered_chapters(made):
        sections = [each for each in inside if each.title != FINDINGS]
        if sections or any(not isinstance(block, ReportPicture) for block in chapter.blocks):
            yield count, chapter, sections


def write_page(study: Study, path: Path) -> tuple[Path]:
    """The page as a file. Raises as ``web_page``; FileError where it cannot be written."""
    write(path, web_page(study).encode())
    return (path,)


def _json(data: Any) -> str:
    """As it may stand inside of a script element: no name in it can end that."""
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


# -- what the page holds ----------------------------------------------------------------------------------


def stored(study: Study, angles: int = ANGLES) -> dict[str, Any]:
    """What the page's program reads: machines with the places of their bodies, and the curves of each, at equally spaced angles of the
    shaft or crank; of drives that are listed each by the machine's angle."""
    machines = [
        {"name": printable(name), **_machine(each, phase)} for name, phase, each in _drives(Study(study.design, angles))
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
    for (name, each), drive in zip(study.drives.items(), study.design.drives, strict=True):
        if name not in study.camshaft.failures:
            yield name, drive.phase_deg, each


def _machine(study: Study, phase: float) -> dict[str, Any]:
    """Angles and places by the drive's own angle; phase: by which it lags behind the machine's [deg]."""
    kinematics = study.linkage
    sliding = [pair for pair in kinematics.pairs.values() if pair.kind == SLIDING]
    bodies = [
        {
            "name": name,
            "fixed": name == FRAME,
            "slides": any(pair.body == name for pair in sliding),
            "stem": _stem(study) if name == kinematics.carrier and len(kinematics.pairs) == 1 and sliding else None,
            "points": [[point, *_place(at)] for point, at in pose.points.items()],
            **_track(pose.origin[0], pose.turn[0]),
        }
        for name, pose in kinematics.bodies.items()
    ]
    return {
        "phase": phase,
        "sense": study.sense,
        "angles": _rounded(study.angle_degrees),
        "whole": study.angle_degrees.size == study.samples,
        "cam": _cam(study),
        "bodies": bodies,
        "fixed": _fixed(study),
        "curves": _with_curves_shown(list(_curves(study)), study),
    }


def _stem(study: Study) -> list[float]:
    """Where the stem of a follower that slides in the frame ends, in its own frame: away from the cam, as long as the cam is large."""
    kinematics = study.linkage
    (pair,) = kinematics.pairs.values()
    pose = kinematics.bodies[pair.body]
    outwards = 1.0 if (pose.origin[0][0] * pair.axis.conjugate()).real >= 0.0 else -1.0
    return _place(outwards * pair.axis * np.exp(-1j * pose.turn[0][0]) * float(np.abs(pose.origin[0]).max()))


def _fixed(study: Study) -> list[dict[str, Any]]:
    """Pins and guides on the frame."""
    kinematics, rows = study.linkage, []
    for name, pair in kinematics.pairs.items():
        if pair.on != FRAME:
            continue
        track = kinematics.bodies[pair.body].position(pair.point)
        row: dict[str, Any] = {"name": name, "at": _place(track[0])}
        if pair.kind == SLIDING:
            along = ((track - track[0]) * pair.axis.conjugate()).real
            row["guide"] = [_place(track[0] + pair.axis * end) for end in (along.min(), along.max())]
        rows.append(row)
    return rows


def _cam(study: Study) -> dict[str, Any] | None:
    """Outlines in the cam's own frame, and what touches them: the face around its reference point, further rollers."""
    if "cam" not in study.stages:
        return None
    try:
        shape = study.cam
    except NoSolution:
        return None
    cam, face = study.design.drive.cam, study.design.drive.face
    outline = row_of(face).outline(shape, face, study.linkage).points
    turn = study.linkage.bodies[study.linkage.follower_body].turn[0]
    further = [flank for flank in shape.flanks[1:] if flank.reference is not shape.reference]
    return {
        "flanks": [[_place(at) for at in flank.profile] for flank in shape.flanks],
        "keyway": [[_short(at.real), _short(at.imag)] for at in keyway_corners(cam)],
        "circles": [_short(0.5 * size) for size in (cam.hub_mm, cam.bore_mm) if size],
        "face": {"outline": [_place(at) for at in outline], **_track(shape.reference, turn)},
        "rollers": [{"radius": _short(flank.radius * _MM), **_track(flank.reference, 0.0 * turn)} for flank in further],
    }


def _with_curves_shown(rows: list[dict[str, Any]], study: Study) -> list[dict[str, Any]]:
    """The curves with enough of them to open with."""
    if sum(row["shown"] for row in rows) < FEWEST:
        of_links = {row.slug for row in channels(study.design) if shape_of(row.name) in OF_LINKS}
        rows = [{**row, "shown": row["shown"] or row["slug"] in of_links} for row in rows]
    return rows


def _curves(study: Study) -> Iterator[dict[str, Any]]:
    """Every channel that is no angle that goes round, and has a value at every angle."""
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
    return round(float(value), PLACE_DIGITS) + 0.0


def _place(at: complex) -> list[float]:
    """[m] as x, y [mm]."""
    return [_short(at.real * _MM), _short(at.imag * _MM)]


def _rounded(values: Iterable[float]) -> list[float]:
    return [_short(value) for value in values]


def _track(origin: np.ndarray, turn: np.ndarray) -> Mapping[str, list[float]]:
    """Where a body is: x, y [mm], turn [deg]."""
    return {
        "x": _rounded(origin.real * _MM),
        "y": _rounded(origin.imag * _MM),
        "turn": _rounded(np.rad2deg(turn) + 0.0 * origin.real),
    }


# -- all of a design that its workshop, its controls engineer and its buyer ask for -----------------------------


CONTENTS, ARCHIVE = "contents.json", ".zip"
EARLIEST = (1980, 1, 1, 0, 0, 0)  # that an archive can hold: the same design gives the same bytes


@frozen
class HandoverRequest(Cover):
    """What else is wanted: what stands on report and drawings, for which controller, G-code, and how exact curves are."""

    controller: str = text_option("row of the table of controllers: a table of each drive", default="", metavar="SLUG")
    error_mm: float = option(
        number("Largest error", 0.0, 1.0, open_low=True, default=1e-3, help="of profiles, and of a controller's table"),
        "--error",
        metavar="MM",
    )
    gcode: bool = text_option("also G-code of every cam", default=False, action="store_true")


@frozen(eq=False)
class HandoverFile:
    """name: with its folder; what: in words; deviation: largest from the exact curve, with its unit; None where nothing is fitted."""

    name: str
    what: str
    data: bytes
    deviation: tuple[float, str] | None = None


@frozen(eq=False)
class Handover:
    """The files, and what could not be made of this design: what and why."""

    files: tuple[HandoverFile, ...]
    left_out: tuple[tuple[str, str], ...]

    def with_files(self, more: Iterable[HandoverFile], left_out: Iterable[tuple[str, str]] = ()) -> Handover:
        """Beside these others, such as what only a program with fonts paints; in order of their names."""
        files = sorted((*self.files, *more), key=lambda each: each.name)
        return Handover(tuple(files), (*self.left_out, *left_out))

    @property
    def contents(self) -> dict[str, Any]:
        """As ``contents.json`` lists them: name, what, deviation, sha256; and what was left out."""
        rows = [
            {
                "name": each.name,
                "what": each.what,
                "deviation": None if each.deviation is None else each.deviation[0],
                "unit": None if each.deviation is None else each.deviation[1],
                "sha256": hashlib.sha256(each.data).hexdigest(),
            }
            for each in self.files
        ]
        return {"files": rows, "left_out": [{"what": what, "why": why} for what, why in self.left_out]}

    def write(self, out: Path) -> None:
        """As a folder that is empty or new, or as a zip archive; a hand-over in that place is replaced where it is as it was written.
        Raises KindynaError, FileError, and then nothing has changed."""
        made: dict[str, str | bytes] = {each.name: each.data for each in self.files}
        made[CONTENTS] = to_json(self.contents)
        archive = out.suffix.lower() == ARCHIVE
        there = os.path.lexists(out) if archive else out.is_dir() and any(out.iterdir())
        before = (_names_in_archive if archive else _names_in_folder)(out) if there else []
        if before is None:
            what = "file is there already" if archive else "folder is not empty"
            other = "another name" if archive else "an empty or new one, or NAME.zip"
            raise KindynaError(f"{out}: this {what} and it, or a part of it, is no hand-over; allowed: {other}")
        if archive:
            write(out, _packed(made))
        else:
            write_into(out, made)
            remove_listed(out, set(before) - made.keys())


# -- a hand-over that is replaced ---------------------------------------------------------------------------

MOST_UNPACKED = 1 << 28
"""Bytes; no hand-over is as large."""


def _names_in_archive(path: Path) -> list[str] | None:
    """The files of a hand-over, which is as it was written; None for any other archive: with a comment, a folder, a file twice."""
    with suppress(Exception):  # archives from anywhere fail in many ways
        data = read_own(path)
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            rows = archive.infolist()
            size = 22 + sum(76 + 2 * len(row.filename.encode()) + row.compress_size for row in rows)
            if size == len(data) and sum(row.file_size for row in rows) <= MOST_UNPACKED:
                return _own([row.filename for row in rows], archive.read)
    return None


def _names_in_folder(path: Path) -> list[str] | None:
    """The files of a hand-over, which is as it was written; None for any other folder, and for a link to one."""
    with suppress(Exception):  # as lists of contents from anywhere do
        if is_folder(path):
            return _own(_files_in(path), lambda name: read_own(path / name))
    return None


def _files_in(path: Path) -> Iterator[str]:
    """Names of files, links among them, and with a stroke behind those of links to folders and of empty folders."""
    for place, folders, names in os.walk(path):
        inside = Path(place).relative_to(path)
        yield from ((inside / name).as_posix() for name in names)
        yield from (f"{inside / name}/" for name in folders if not is_folder(Path(place, name)))
        if not folders and not names:
            yield f"{inside}/"


def _own(names: Iterable[str], read: Callable[[str], bytes]) -> list[str] | None:
    """The names, where the list of contents has each of them, but itself, with the sha256 of what is read."""
    hashes = {row["name"]: row["sha256"] for row in json.loads(read(CONTENTS))["files"]}
    same = sorted(names) == sorted([*hashes, CONTENTS]) and all(
        hashlib.sha256(read(name)).hexdigest() == value for name, value in hashes.items()
    )
    return [*hashes] if same else None


def _packed(files: dict[str, str | bytes]) -> bytes:
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            archive.writestr(zipfile.ZipInfo(name, EARLIEST), files[name], zipfile.ZIP_DEFLATED)
    return target.getvalue()


def handover(design: Design, request: HandoverRequest) -> Handover:
    """What needs no fonts: profiles, inspection tables, tables of a controller, web page, the design itself.

    Raises KindynaError for a controller that is not known, NoSolution where the whole has none.
    """
    if request.controller:
        controller(request.controller)
    files = [
        HandoverFile("design.toml", "the design itself, to be opened again", dumps(with_own_motions(design)).encode())
    ]
    left_out: list[tuple[str, str]] = []
    study = Study(design)
    for folder, name, each in drives_of(study):
        for what, made in _makers(design, folder, name, each, request):
            try:
                files += made()
            except KindynaError as error:
                left_out.append((f"{what}, {name}" if name else what, str(error)))
    files.append(HandoverFile("machine.html", "a page that plays the machine in any browser", web_page(study).encode()))
    return Handover((), tuple(left_out)).with_files(files)


def drives_of(study: Study) -> Iterator[tuple[str, str, Study]]:
    """Folder with its stroke, name, and study of each drive; of a single one both are empty."""
    if not study.design.listed:
        yield "", "", study
        return
    camshaft = study.camshaft
    for name, each in study.drives.items():
        yield f"{camshaft.slugs[name]}/", name, each


def _makers(
    design: Design, folder: str, name: str, study: Study, request: HandoverRequest
) -> Iterator[tuple[str, Callable[[], Sequence[HandoverFile]]]]:
    of = f" of {name}" if name else ""
    if "cam" in study.stages:
        yield "profile", lambda: _profile(study, folder, of, request, ".dxf")
        if request.gcode:
            yield "G-code", lambda: _profile(study, folder, of, request, ".nc")
        yield "inspection table", lambda: _inspection(study, folder, of)
    if request.controller:
        yield "table of the controller", lambda: _controller(design, folder, name, request)


def _profile(study: Study, folder: str, of: str, request: HandoverRequest, ending: str) -> list[HandoverFile]:
    path = Path(f"profile{ending}")
    fit = "arcs" if ending == ".nc" else ""
    job = profile_job(study, path, ProfileRequest(tolerance_mm=request.error_mm, fit=fit))
    deviation = float(profile_facts(job)["deviation_mm"]), "mm"
    return [
        HandoverFile(
            folder + name,
            f"profile of the cam{of}" if name == path.name else f"what {path.name} is, as JSON",
            data,
            deviation if name == path.name else None,
        )
        for name, data in profile_files(job, path).items()
    ]


def _inspection(study: Study, folder: str, of: str) -> list[HandoverFile]:
    made = inspection_of(study, InspectionRequest())
    if wrong := [each.message for each in made.setup.findings if each.severity == ERROR]:
        raise KindynaError(wrong[0])
    texts = inspection_files(made, Path("inspection.csv"))
    words = {"inspection.csv": f"lift that a probe measures on the cam{of}, with its tolerance"}
    facts = "which probe and tolerance inspection.csv is for, as JSON"
    return [HandoverFile(folder + name, words.get(name, facts), data) for name, data in texts.items()]


def _controller(design: Design, folder: str, name: str, request: HandoverRequest) -> list[HandoverFile]:
    row, wanted = controller(request.controller), EcamRequest(error=request.error_mm)
    slave, title, speed = drive_slave(design, name, wanted)
    made = ecam(slave, row, wanted, title, speed)
    deviation = None if made.deviation is None else (float(made.deviation.values[0]), slave.unit)
    of = f" of {name}" if name else ""
    return [
        HandoverFile(f"{folder}controller{row.extension}", f"table for {row.label}{of}", made.content, deviation),
        HandoverFile(f"{folder}controller.json", "its certificate, as JSON", to_json(facts(made)).encode()),
    ]
