"""A design as one web page that needs nothing beside it: the machine plays and is turned by its angle, curves with one cursor, findings,
inputs, certificate. What it shows is computed here; the page's own program looks the stored positions up."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from core.cam import keyway_corners, row_of
from core.errors import NoAnswer
from core.mechanism.kinematics import FRAME, SLIDING
from core.output.channels import channels, existing
from core.output.lines import finding_line, printable
from core.output.report.document import Document, document
from core.output.report.html import numbered_chapters, template_of
from core.output.report.parts import ROUNDING, ReportPicture, Section
from core.project.files import write
from core.resources import resources
from core.study import Study, findings_of
from core.study.quantities import shape_of

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
    """The page as HTML. Raises NoAnswer where the design, or each of its drives, has no mechanism.

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
        track = kinematics.bodies[pair.body].place(pair.point)
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
    except NoAnswer:
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
        if row.turns:
            continue
        try:
            values = row.values(study)
        except NoAnswer:  # no forces where a guide jams
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


__all__ = ["stored", "web_page", "write_page"]
