"""The path of a cutter's centre as G-code (ISO 6983): straight moves in millimetres, absolute, Z at fields of the request."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import ceil

import numpy as np

from core.cam import OUTER, faces_of
from core.errors import KindynaError
from core.numerics.vectors import cross
from core.output.profile.curve import profile
from core.output.profile.drawing import Job, comment
from core.output.profile.made import cutting_side, flank_number
from core.output.profile.request import MACHINING, Request
from core.study import Study

DIGITS = 4  # behind the point of a coordinate, mm
ROUNDING = 0.5 * 2.0**0.5 * 10.0**-DIGITS  # by which a rounded point is off, at most, mm
DEPTH = 10.0  # mm, of a cam whose thickness is not given
LEAD = 1.0  # of the cutter's radius: how far beside the path it goes down, where there is room
CLEAR = 1e-3  # of the cutter's radius: by which it may be nearer to the profile beside the path than on it
LOOKED_AT = 8192  # points of the profile


def require(study: Study, request: Request) -> None:
    """Raises KindynaError for what no path can be made of."""
    if not request.cutter_mm:
        raise KindynaError("cutter: G-code leads the centre of a cutter, and none is given; allowed: a radius above 0 mm")
    for row in MACHINING:
        value = getattr(request.machining, row.name)
        if not row.low <= value <= row.high:
            raise KindynaError(f"{row.label.lower()} {value:g} {row.unit}: allowed: {row.low:g} ... {row.high:g} {row.unit}")


def written(job: Job) -> bytes:
    """The program; in ASCII, what has no letter there as ?"""
    return ("\n".join(_lines(job)) + "\n").encode("ascii", "replace")


def _lines(job: Job) -> Iterator[str]:
    how, path = job.request.machining, _path(job)
    start, depths = path[0], _depths(job)
    up = f"G0 Z{_number(how.safe_mm)}"
    yield "%"
    yield from (_remark(line) for line in (*comment(job), *_head(job, path, depths)))
    yield "G21 G17 G90 G94 G40 G80"
    yield up
    yield f"M0 {_remark('Start spindle and coolant')}"
    yield f"G0 {_at(start)}"
    for number, depth in enumerate(depths, 1):
        if len(depths) > 1:
            yield _remark(f"Pass {number} of {len(depths)}")
        yield f"G1 Z{_number(-depth)} F{_number(how.plunge_mm_min)}"
        first, *others = path[1:].tolist()
        yield f"G1 {_at(first)} F{_number(how.feed_mm_min)}"
        yield from (f"G1 {_at(z)}" for z in others)
    yield up
    yield f"M0 {_remark('Stop spindle and coolant')}"
    yield "M30"
    yield "%"


def _head(job: Job, path: np.ndarray, depths: Sequence[float]) -> list[str]:
    how, radius = job.request.machining, job.request.cutter_mm
    around = "counter-clockwise" if float(cross(path, np.roll(path, -1)).sum()) > 0.0 else "clockwise"
    beside = path[0] != job.main.points.ends.z[0]
    down = "beside the path, and comes to it at right angles" if beside else "on the path: there is no room beside it"
    return [
        "ISO 6983, absolute; zero point of the active offset: X0 Y0 the cam centre, Z0 the face of the blank",
        f"Cutter: radius {radius!r} mm; the path is that of its centre, without compensation",
        f"Direction: {around} around the cam seen from above, {'conventional' if how.conventional else 'climb'} milling with M3",
        f"Feed {_number(how.feed_mm_min)} mm/min, plunge {_number(how.plunge_mm_min)} mm/min, rapid moves at Z{_number(how.safe_mm)}",
        f"Depth {_number(depths[-1])} mm in {len(depths)} pass{'es' * (len(depths) > 1)}; the cutter goes down {down}",
        "Tool, spindle and coolant are left to the machinist: the program stops for them",
    ]


def _depths(job: Job) -> list[float]:
    """Below the face [mm]: equal steps, none larger than the one asked for."""
    how = job.request.machining
    depth = how.depth_mm or job.study.design.drive.cam.thickness_mm or DEPTH
    count = ceil(depth / how.step_mm * (1.0 - 1e-9)) if how.step_mm else 1
    return [depth * number / count for number in range(1, count + 1)]


def _path(job: Job) -> np.ndarray:
    """Once around from cam angle 0; before and behind that the place beside it where the cutter goes down [mm], where there is one."""
    ends, side = job.main.points.ends, cutting_side(job.study, job.request)
    around = np.append(ends.z, ends.z[0])
    if (side > 0.0) == job.request.machining.conventional:  # with M3 a cutter on the left of its way climbs
        around = around[::-1]
    lead = _lead(job, side)
    down = ends.z[0] + lead * side * 1j * ends.tangent[0]
    return np.concatenate(([down], around, [down])) if lead else around


def _lead(job: Job, side: float) -> float:
    """How far beside its path, away from the profile, the cutter goes down [mm]: 0 in a groove, and where another part of the profile is
    in the way."""
    study, radius = job.study, job.request.cutter_mm
    if OUTER in faces_of(study.design.drive.face, study.design.drive.cam):
        return 0.0
    edge = profile(study, flank_number(study, job.request))
    z = edge(study.program.angles(np.arange(LOOKED_AT) * 2.0 * np.pi / LOOKED_AT)).z
    ends = job.main.points.ends
    for part in (0.25, 0.5, 0.75, 1.0):
        place = ends.z[0] + part * LEAD * radius * side * 1j * ends.tangent[0]
        if float(np.abs(z - place).min()) < radius * (1.0 - CLEAR):
            return 0.0
    return LEAD * radius


def _remark(text: str) -> str:
    """A comment, which holds no parentheses of its own."""
    return f"({text.replace('(', '[').replace(')', ']')})"


def _number(value: float) -> str:
    """With a point, without zeros behind its digits, and without minus zero."""
    text = f"{value:.{DIGITS}f}".rstrip("0")
    return "0." if text == "-0." else text


def _at(z: complex) -> str:
    return f"X{_number(z.real)} Y{_number(z.imag)}"


__all__ = ["DIGITS", "ROUNDING", "require", "written"]
