"""The path of a cutter's centre as G-code (ISO 6983): straight moves, or arcs, in millimetres, absolute, Z at fields of the request."""

from __future__ import annotations

import re
from cmath import rect
from collections.abc import Iterator, Mapping, Sequence
from math import atan, ceil, sin, sqrt
from types import MappingProxyType
from unicodedata import name, normalize

import numpy as np

from core.cam import OUTER, faces_of
from core.errors import KindynaError
from core.numerics.vectors import cross
from core.output.profile.curve import profile
from core.output.profile.drawing import ProfileDrawing, comment
from core.output.profile.fits import Arcs
from core.output.profile.made import cutting_side, flank_number
from core.output.profile.request import Request
from core.requests import require as in_range
from core.study import Study

DIGITS = 4  # behind the point of a coordinate, mm
_POINT = 0.5 * 2.0**0.5 * 10.0**-DIGITS  # by which a rounded point is off, at most, mm
ROUNDING: Mapping[str, float] = MappingProxyType({"polyline": _POINT, "arcs": (2.0 + 2.0**0.5) * _POINT})
"""By which the moves of a fit are off, at most [mm]. Rounded ends take an arc of up to half a turn along by √2 times as much; its
rounded centre is nearer to one end than to the other by up to twice as much, which machines spread over the arc, or make at an end."""
MOST_RADIUS = 9999.0  # mm: a flatter arc, whose centre machines of few digits lose, is made of straight moves
DEPTH = 10.0  # mm, of a cam whose thickness is not given
LEAD = 1.0  # of the cutter's radius: how far beside the path it goes down, where there is room
CLEAR = 1e-3  # of the cutter's radius: by which it may be nearer to the profile beside the path than on it
LOOKED_AT = 8192  # points of the profile


def require(study: Study, request: Request) -> None:
    """Raises KindynaError for what no path can be made of."""
    if not request.cutter_mm:
        raise KindynaError(
            "cutter: G-code leads the centre of a cutter, and none is given; allowed: a radius above 0 mm"
        )
    in_range(request.machining)


def written(job: ProfileDrawing) -> bytes:
    """The program, in ASCII."""
    return ("\n".join(_lines(job)) + "\n").encode("ascii")


def _lines(job: ProfileDrawing) -> Iterator[str]:
    how, ring, depths, down = job.request.machining, _ring(job), _depths(job), _down(job)
    up = f"G0 Z{_number(how.safe_mm)}"
    yield "%"
    yield from (_remark(line) for line in (*comment(job), *_head(job, ring, depths, down)))
    yield "G21 G17 G90 G94 G40 G80"
    yield up
    yield f"M0 {_remark('Start spindle and coolant')}"
    yield f"G0 {_at(ring[0][0] if down is None else down)}"
    for number, depth in enumerate(depths, 1):
        if len(depths) > 1:
            yield _remark(f"Pass {number} of {len(depths)}")
        yield f"G1 Z{_number(-depth)} F{_number(how.plunge_mm_min)}"
        moves = list(_around(ring))
        if down is not None:
            moves = [f"G1 {_at(ring[0][0])}", *moves, f"G1 {_at(down)}"]
        first, *others = moves
        yield f"{first} F{_number(how.feed_mm_min)}"
        yield from others
    yield up
    yield f"M0 {_remark('Stop spindle and coolant')}"
    yield "M30"
    yield "%"


def _head(job: ProfileDrawing, ring: Sequence[_Arc], depths: Sequence[float], down: complex | None) -> list[str]:
    how, radius = job.request.machining, job.request.cutter_mm
    path = np.array(
        [z for p, q, b in ring for z in (p, 0.5 * (p + q - 1j * b * (q - p)))]
    )  # and the middle of each move
    around = "counter-clockwise" if float(cross(path, np.roll(path, -1)).sum()) > 0.0 else "clockwise"
    where = (
        "on the path: there is no room beside it"
        if down is None
        else "beside the path, and comes to it at right angles"
    )
    bent = any(bulge for _, _, bulge in ring)
    return [
        "ISO 6983, absolute; zero point of the active offset: X0 Y0 the cam centre, Z0 the face of the blank",
        f"Cutter: radius {radius!r} mm; the path is that of its centre, without compensation",
        f"Direction: {around} around the cam seen from above, {'conventional' if how.conventional else 'climb'} milling with M3",
        f"Feed {_number(how.feed_mm_min)} mm/min, plunge {_number(how.plunge_mm_min)} mm/min, rapid moves at Z{_number(how.safe_mm)}",
        f"Depth {_number(depths[-1])} mm in {len(depths)} pass{'es' * (len(depths) > 1)}; the cutter goes down {where}",
        *(["Arcs: G2 and G3, with I and J from the start of an arc to its centre"] if bent else []),
        "Tool, spindle and coolant are left to the machinist: the program stops for them",
    ]


def _depths(job: ProfileDrawing) -> list[float]:
    """Below the face [mm]: equal steps, none larger than the one asked for."""
    how = job.request.machining
    depth = how.depth_mm or job.study.design.drive.cam.thickness_mm or DEPTH
    count = ceil(depth / how.step_mm * (1.0 - 1e-9)) if how.step_mm else 1
    return [depth * number / count for number in range(1, count + 1)]


_Arc = tuple[complex, complex, float]
"""Start, end [mm] and bulge of a move; bulge 0 is straight."""


def _ring(job: ProfileDrawing) -> list[_Arc]:
    """Once around from cam angle 0, in the direction in which it is cut."""
    chain, side = job.main.chain, cutting_side(job.study, job.request)
    assert isinstance(chain, Arcs)
    p = chain.vertices
    ring = list(zip(p.tolist(), np.roll(p, -1).tolist(), chain.b.ravel().tolist(), strict=True))
    if (side > 0.0) == job.request.machining.conventional:  # with M3 a cutter on the left of its way climbs
        ring = [(end, start, -bulge) for start, end, bulge in reversed(ring)]
    return ring


def _around(ring: Sequence[_Arc]) -> Iterator[str]:
    """The moves along it. Ends that round to one point need none, and an arc between them would be a whole turn."""
    here = _rounded(ring[0][0])
    for start, end, bulge in ring:
        for there, bend in _held(start, end, bulge):
            after = _rounded(there)
            if after == here:
                continue
            if bend:
                middle = 0.5 * (here + after) + 0.25j * (after - here) * (1.0 / bend - bend)
                centre = middle - here
                yield f"G{3 if bend > 0.0 else 2} {_at(after)} I{_number(centre.real)} J{_number(centre.imag)}"
            else:
                yield f"G1 {_at(after)}"
            here = after


def _held(start: complex, end: complex, bulge: float) -> Iterator[tuple[complex, float]]:
    """Ends and bulges of the moves that an arc is made of: itself, or chords of an arc that is too flat."""
    chord = end - start
    if not bulge or abs(chord) * (1.0 + bulge * bulge) <= 4.0 * abs(bulge) * MOST_RADIUS:
        yield end, bulge
        return
    half = 2.0 * atan(bulge)  # of the turn
    count = ceil(sqrt(0.5 * abs(chord * bulge) / _POINT))  # so that none is more than rounding off
    for i in range(1, count + 1):
        yield start + chord * sin(half * i / count) / sin(half) * rect(1.0, half * (i / count - 1.0)), 0.0


def _down(job: ProfileDrawing) -> complex | None:
    """The place beside the path where the cutter goes down [mm], where there is one."""
    ends, side = job.main.points.ends, cutting_side(job.study, job.request)
    lead = _lead(job, side)
    return complex(ends.z[0] + lead * side * 1j * ends.tangent[0]) if lead else None


def _lead(job: ProfileDrawing, side: float) -> float:
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
    """A comment: in ASCII, without what ends it or the program on some machine, or is obeyed there."""
    return f"({''.join(map(_letter, text))})"


_INSTEAD: Mapping[str, str] = MappingProxyType(
    {"(": "[", ")": "]", ";": ",", "%": " percent", "°": " deg", **dict.fromkeys('!?~$"\\`^{}|', "_")}
)  # ! ? ~ are obeyed by Grbl wherever they stand


def _letter(c: str) -> str:
    """A character as ASCII: without its accents, else by its name, as 캠 is HANGUL SYLLABLE KAEM; a sign that has no letter is _."""
    if c in _INSTEAD or c.isascii():
        return _INSTEAD.get(c, c)
    plain = "".join(_INSTEAD.get(each, each) for each in normalize("NFKD", c) if each.isascii())
    if plain:
        return plain
    called = re.search(r"(?: LETTER| SYLLABLE| IDEOGRAPH-)(.+?)(?: WITH .*)?$", name(c, ""))
    return called[1].strip().replace(" ", "-") if called else "-" if name(c, "").endswith(" DASH") else "_"


def _number(value: float) -> str:
    """With a point, without zeros behind its digits, and without minus zero."""
    text = f"{value:.{DIGITS}f}".rstrip("0")
    return "0." if text == "-0." else text


def _rounded(z: complex) -> complex:
    return complex(round(z.real, DIGITS), round(z.imag, DIGITS))


def _at(z: complex) -> str:
    return f"X{_number(z.real)} Y{_number(z.imag)}"


__all__ = ["DIGITS", "ROUNDING", "require", "written"]
