"""What a drawing of the profile holds, layer by layer; written by ``dxf`` and ``svg``. One row a layer."""

from __future__ import annotations

import io
import re
from cmath import rect
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import field, replace
from datetime import datetime
from functools import partial
from itertools import pairwise
from math import atan, ceil, sin, sqrt
from types import MappingProxyType
from typing import Any, TypeAlias
from unicodedata import name, normalize
from xml.sax.saxutils import escape

import numpy as np

from core.cam import OUTER, SECOND, faces_of, form_row, keyway_corners, keyway_unknown
from core.errors import KindynaError, NoCam
from core.frozen import frozen
from core.numerics.derivatives import cross
from core.output.files.made import FittedCurve, beside, cutting_side, exact_curve, fitted, flank_number, touching
from core.output.files.profile_curve import MM, profile
from core.output.files.profile_fit import FITS, Arcs, Cubics
from core.output.files.profile_request import SAMPLINGS, ProfileRequest, rounded_up
from core.requests import require_in_range as in_range
from core.study import Study

# -- what a drawing of the profile holds, layer by layer --------------------------------------------------------


ZERO = (
    0.75,
    0.95,
)  # of the way from the centre to the profile: the angle-zero mark, which ends on no curve, or CAD would chain them
SENSES: Mapping[float, tuple[str, str]] = MappingProxyType(
    {1.0: ("ccw", "counter-clockwise"), -1.0: ("cw", "clockwise")}
)


@frozen
class CircleShape:
    """About the cam centre [mm]."""

    radius: float


@frozen
class LineShape:
    """From point to point [mm]."""

    start: complex
    end: complex


Shape: TypeAlias = "Arcs | Cubics | CircleShape | LineShape"


@frozen(eq=False)
class ProfileDrawing:
    """The study, what was asked of it, and the curve that came of it; profiles: flank -> its profile, of all flanks of the cam, where
    a drawing is to be made."""

    study: Study
    request: ProfileRequest
    main: FittedCurve
    profiles: Mapping[str, FittedCurve] = field(default_factory=dict)

    @property
    def profile(self) -> np.ndarray:
        """Points (n,) complex [mm] of the profile, at the angles of the study."""
        return self.study.cam.only(self.request.flank).flank.profile * MM


def drawn_profiles(study: Study, request: ProfileRequest, main: FittedCurve, least_mm: float) -> dict[str, FittedCurve]:
    """The profiles of ``ProfileDrawing``, sampled and fitted as its curve. Raises NoCam, which names the flank, KindynaError."""

    def made(flank: str) -> FittedCurve:
        if flank == request.flank and not request.cutter_mm:
            return main
        alone = replace(request, flank=flank, cutter_mm=0.0)
        try:
            return fitted(study, exact_curve(study, alone), alone, least_mm)
        except NoCam as error:
            raise NoCam(f"{flank} flank: {error.problem}", error.field, error.hint, error.cam_angles) from None

    return {flank: made(flank) for flank in _flanks(study)}


def _flanks(study: Study) -> tuple[str, ...]:
    return form_row(study.design.drive.cam.form).flanks


def _layer(study: Study, flank: str) -> str:
    """Where its profile stands: the walls of a groove have their names, of a pair the second cam has."""
    return "PROFILE" if flank == _flanks(study)[0] and OUTER not in _flanks(study) else f"PROFILE_{flank.upper()}"


@frozen
class DrawingLayer:
    """One row: its DXF colour, its colour in SVG, its line type, and what stands on it, which may be nothing."""

    colour: int
    stroke: str
    line: str
    shapes: Callable[[ProfileDrawing], Iterator[Shape]]


def _profile(layer: str, job: ProfileDrawing) -> Iterator[Shape]:
    """Beside a cutter's path it is drawn for comparison."""
    yield from (drawn.chain for flank, drawn in job.profiles.items() if _layer(job.study, flank) == layer)


def _cutter(job: ProfileDrawing) -> Iterator[Shape]:
    if job.request.cutter_mm:
        yield job.main.chain


def _pitch(second: bool, job: ProfileDrawing) -> Iterator[Shape]:
    """Both walls of a groove have one, each cam of a pair its own."""
    if second and SECOND not in _flanks(job.study):
        return
    request = replace(job.request, flank=SECOND if second else _flanks(job.study)[0])
    radius = touching(job.study, request).radius_mm
    if radius:
        yield beside(job.study, request, radius)


def _base(job: ProfileDrawing) -> Iterator[Shape]:
    radius: float | None = getattr(
        job.study.design.drive.cam, "base_radius_mm", None
    )  # a linkage gives its cam the size
    if radius is not None:
        yield CircleShape(radius)


def _bore(job: ProfileDrawing) -> Iterator[Shape]:
    diameter = job.study.design.drive.cam.bore_mm
    if diameter is not None:
        yield CircleShape(0.5 * diameter)


def _keyway(job: ProfileDrawing) -> Iterator[Shape]:
    """The sides and the bottom of the keyway, from the bore outwards."""
    yield from (LineShape(start, end) for start, end in pairwise(keyway_corners(job.study.design.drive.cam)))


def _zero(job: ProfileDrawing) -> Iterator[Shape]:
    """A radial line towards the nearest profile, along the cam's own x axis, which is the global one at cam angle 0."""
    edge = min(_edge(flank.profile * MM) for flank in job.study.cam.flanks)
    yield LineShape(complex(ZERO[0] * edge), complex(ZERO[1] * edge))


def _edge(z: np.ndarray) -> float:
    """Where the x axis leaves a closed curve through points (n,)."""
    after = np.roll(z, -1)
    cut = np.flatnonzero((z.imag <= 0.0) != (after.imag <= 0.0))
    one, other = z[cut], after[cut]
    return float((one.real - one.imag * (other.real - one.real) / (other.imag - one.imag)).max())


PROFILES = ("PROFILE", "PROFILE_INNER", "PROFILE_OUTER", "PROFILE_SECOND")
LAYERS: Mapping[str, DrawingLayer] = MappingProxyType(
    {
        **{name: DrawingLayer(7, "#000000", "CONTINUOUS", partial(_profile, name)) for name in PROFILES},
        "CUTTER": DrawingLayer(1, "#d55e00", "CONTINUOUS", _cutter),
        "PITCH": DrawingLayer(5, "#0072b2", "CENTER", partial(_pitch, False)),
        "PITCH_SECOND": DrawingLayer(5, "#0072b2", "CENTER", partial(_pitch, True)),
        "BASE": DrawingLayer(8, "#808080", "DASHED", _base),
        "BORE": DrawingLayer(7, "#000000", "CONTINUOUS", _bore),
        "KEYWAY": DrawingLayer(7, "#000000", "CONTINUOUS", _keyway),
        "ZERO": DrawingLayer(3, "#009e73", "CONTINUOUS", _zero),
    }
)


def layers(job: ProfileDrawing) -> dict[str, list[Shape]]:
    """Name -> what stands on it; those with nothing on them are left out."""
    drawn = {name: list(row.shapes(job)) for name, row in LAYERS.items()}
    return {name: shapes for name, shapes in drawn.items() if shapes}


def reach(drawn: Mapping[str, Sequence[Shape]]) -> float:
    """Largest distance of anything drawn from the cam centre [mm]; of curves that of their points."""
    return max(_reach(shape) for shapes in drawn.values() for shape in shapes)


def _reach(shape: Shape) -> float:
    if isinstance(shape, CircleShape):
        return shape.radius
    return abs(shape.end) if isinstance(shape, LineShape) else float(np.abs(shape.vertices).max())


def facts(job: ProfileDrawing) -> dict[str, Any]:
    """What the file is, as JSON says it: on the terminal, and beside the file."""
    request, main = job.request, job.main
    several = {_layer(job.study, flank): {"flank": flank, **_figures(drawn)} for flank, drawn in job.profiles.items()}
    return {
        "design": job.study.design.name,
        "curve": "path of the cutter's centre" if request.cutter_mm else "profile",
        "flank": request.flank,
        "cutter_radius_mm": request.cutter_mm or None,
        "rotation": SENSES[job.study.sense][0],
        "units": {"length": "mm", "angle": "deg"},
        "origin": "cam centre; the x axis is the global one at cam angle 0",
        "sampling": SAMPLINGS[request.sampling].text.format(value=request.value),
        "fit": FITS[request.fit].label,
        **_figures(main),
        "tolerance_mm": request.tolerance_mm,
        **({"layers": several} if len(several) > 1 else {}),
    }


def _figures(drawn: FittedCurve) -> dict[str, Any]:
    return {"points": drawn.count, "length_mm": drawn.curve.length, "deviation_mm": drawn.deviation}


def _one_line(text: str) -> str:
    """Without what ends a line, and what no drawing may hold."""
    return "".join(c if c.isprintable() else "?" for c in " ".join(text.split()))


def comment(job: ProfileDrawing) -> list[str]:
    """The same in lines, for a drawing."""
    stated = facts(job)
    radius = f", radius {job.request.cutter_mm!r} mm" if job.request.cutter_mm else ""
    allowed = "" if stated["tolerance_mm"] is None else f", tolerance {stated['tolerance_mm']!r} mm"
    missing = ", ".join(f"cam.{name}" for name in keyway_unknown(job.study.design.drive.cam))
    keyway = [f"Keyway: not drawn, as not given: {missing}"] if missing else []
    return [
        f"Design: {_one_line(stated['design'])}",
        f"Curve: {stated['curve']}{radius}, {stated['flank']} flank",
        f"Cam turns {SENSES[job.study.sense][1]} ({stated['rotation']}) as drawn",
        f"Units: mm; origin: {stated['origin']}",
        f"Points: {stated['points']}, {stated['sampling']}; {stated['fit']}",
        f"Length: {stated['length_mm']:.9g} mm",
        f"Deviation from the exact curve: at most {rounded_up(stated['deviation_mm'], 4)!r} mm{allowed}",
        *(
            f"Layer {name}: profile, {row['flank']} flank, {row['points']} points, at most {rounded_up(row['deviation_mm'], 4)!r} mm"
            for name, row in stated.get("layers", {}).items()
        ),
        *keyway,
    ]


# -- A drawing as DXF, written by ezdxf -------------------------------------------------------------------------


VERSION = "R2010"
COMMENT = 999  # group code
MILLIMETRES, METRIC = 4, 1  # of $INSUNITS, $MEASUREMENT
PLANAR = 8  # flag of a spline; ends that meet close it: the flag for that makes some programs move its control points
VIEW = 2.2  # height of what is seen first, times the drawing's reach
LINES: Mapping[str, tuple[str, list[float]]] = MappingProxyType(
    {"CENTER": ("Center ____ _ ____", [12.0, 8.0, -1.5, 1.0, -1.5]), "DASHED": ("Dashed __ __", [4.0, 2.5, -1.5])}
)
"""Line types: description, then length of the pattern and its dashes and gaps [mm]."""


@contextmanager
def without_clock() -> Iterator[None]:
    """Files name neither a time nor a random number."""
    import ezdxf

    before = ezdxf.options.write_fixed_meta_data_for_testing
    ezdxf.options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = before


def dxf_bytes(comment: Sequence[str], layers: Mapping[str, Sequence[Shape]]) -> bytes:
    """The file: comments, then a header with units and origin, then the shapes on their layers."""
    import ezdxf
    from ezdxf.tools.juliandate import juliandate

    with without_clock():
        drawing = ezdxf.new(VERSION)
        drawing.header["$INSUNITS"] = MILLIMETRES
        drawing.header["$MEASUREMENT"] = METRIC
        drawing.header["$INSBASE"] = (0.0, 0.0, 0.0)
        for name in ("$TDCREATE", "$TDUCREATE"):
            drawing.header[name] = juliandate(datetime(2000, 1, 1))
        for name, (text, pattern) in LINES.items():
            drawing.linetypes.add(name, pattern, description=text)
        half = reach(layers)
        drawing.set_modelspace_vport(VIEW * half)
        space = drawing.modelspace()
        space.reset_extents((-half, -half, 0.0), (half, half, 0.0))
        for name, shapes in layers.items():
            drawing.layers.add(name, color=LAYERS[name].colour, linetype=LAYERS[name].line)
            for shape in shapes:
                DXF_SHAPES[type(shape)](space, shape, {"layer": name})
        for kind in sorted(drawing.entitydb.dxf_types_in_use()):  # else in the order of a set, which changes
            drawing.classes.add_class(kind)
        stream = io.StringIO()
        drawing.write(stream)
    head = "".join(f"{COMMENT}\n{line}\n" for line in comment)
    return (head + stream.getvalue()).encode("utf-8", "replace")


def _polyline(space: Any, shape: Arcs, attributes: dict[str, Any]) -> None:
    rows = np.column_stack((shape.vertices.real, shape.vertices.imag, shape.b.ravel()))
    space.add_lwpolyline(rows.tolist(), format="xyb", close=True, dxfattribs=attributes)


def _spline(space: Any, shape: Cubics, attributes: dict[str, Any]) -> None:
    """One cubic B-spline with double knots, whose control points are those of the Bézier pieces without the common ones."""
    inner = shape.points[:, 1:3].ravel()
    points = np.concatenate((shape.points[:1, 0], inner, shape.points[:1, 0]))
    ends = np.append(0.0, np.cumsum(shape.lengths))
    knots = np.concatenate(([0.0, 0.0], np.repeat(ends, 2), [ends[-1]] * 2))
    made = space.add_spline(dxfattribs={**attributes, "degree": 3, "flags": PLANAR, "extrusion": (0.0, 0.0, 1.0)})
    made.knots = knots.tolist()
    made.control_points = [(z.real, z.imag, 0.0) for z in points.tolist()]


def _dxf_circle(space: Any, shape: CircleShape, attributes: dict[str, Any]) -> None:
    space.add_circle((0.0, 0.0), shape.radius, dxfattribs=attributes)


def _dxf_line(space: Any, shape: LineShape, attributes: dict[str, Any]) -> None:
    space.add_line((shape.start.real, shape.start.imag), (shape.end.real, shape.end.imag), dxfattribs=attributes)


DXF_SHAPES: Mapping[type, Callable[[Any, Any, dict[str, Any]], None]] = MappingProxyType(
    {Arcs: _polyline, Cubics: _spline, CircleShape: _dxf_circle, LineShape: _dxf_line}
)


# -- the path of a cutter's centre as G-code (ISO 6983) ---------------------------------------------------------


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


def require(study: Study, request: ProfileRequest) -> None:
    """Raises KindynaError for what no path can be made of."""
    if not request.cutter_mm:
        raise KindynaError(
            "cutter: G-code leads the centre of a cutter, and none is given; allowed: a radius above 0 mm"
        )
    in_range(request.machining)


def gcode_bytes(job: ProfileDrawing) -> bytes:
    """The program, in ASCII."""
    return ("\n".join(_gcode_lines(job)) + "\n").encode("ascii")


def _gcode_lines(job: ProfileDrawing) -> Iterator[str]:
    how, ring, depths, down = job.request.machining, _ring(job), _depths(job), _down(job)
    up = f"G0 Z{_number(how.safe_mm)}"
    yield "%"
    yield from (_remark(line) for line in (*comment(job), *_head(job, ring, depths, down)))
    yield "G21 G17 G90 G94 G40 G80"
    yield up
    yield f"M0 {_remark('Start spindle and coolant')}"
    yield f"G0 {_gcode_point(ring[0][0] if down is None else down)}"
    for number, depth in enumerate(depths, 1):
        if len(depths) > 1:
            yield _remark(f"Pass {number} of {len(depths)}")
        yield f"G1 Z{_number(-depth)} F{_number(how.plunge_mm_min)}"
        moves = list(_around(ring))
        if down is not None:
            moves = [f"G1 {_gcode_point(ring[0][0])}", *moves, f"G1 {_gcode_point(down)}"]
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
                yield f"G{3 if bend > 0.0 else 2} {_gcode_point(after)} I{_number(centre.real)} J{_number(centre.imag)}"
            else:
                yield f"G1 {_gcode_point(after)}"
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


def _gcode_point(z: complex) -> str:
    return f"X{_number(z.real)} Y{_number(z.imag)}"


# -- A drawing as SVG to scale ----------------------------------------------------------------------------------


MARGIN = 0.05  # of the drawing's size, around it
STROKE = 0.25  # mm
DASHES: Mapping[str, str] = MappingProxyType({"CENTER": "8 1.5 1 1.5", "DASHED": "2.5 1.5"})
"""Of a line type."""


def _svg_point(z: complex) -> str:
    """A point; no minus zero."""
    return f"{z.real + 0.0!r} {0.0 - z.imag!r}"


def _arcs(shape: Arcs) -> str:
    """Chords are lines; an arc that turns left runs clockwise on paper whose y axis points down, of sweep 0."""
    vertices, ends = shape.vertices.tolist(), np.roll(shape.vertices, -1).tolist()
    parts = [f"M {_svg_point(vertices[0])}"]
    for start, end, bulge in zip(vertices, ends, shape.b.ravel().tolist(), strict=True):
        if bulge:
            radius = 0.5 * abs(end - start) / abs(sin(2.0 * atan(bulge)))
            parts.append(f"A {radius!r} {radius!r} 0 0 {0 if bulge > 0.0 else 1} {_svg_point(end)}")
        else:
            parts.append(f"L {_svg_point(end)}")
    return _path([*parts, "Z"])


def _cubics(shape: Cubics) -> str:
    parts = [f"C {_svg_point(a)} {_svg_point(b)} {_svg_point(c)}" for _, a, b, c in shape.points.tolist()]
    return _path([f"M {_svg_point(complex(shape.points[0, 0]))}", *parts, "Z"])


def _path(parts: Sequence[str]) -> str:
    lines = "\n".join(parts)
    return f'<path d="{lines}"/>'


def _svg_circle(shape: CircleShape) -> str:
    return f'<circle cx="0" cy="0" r="{shape.radius!r}"/>'


def _svg_line(shape: LineShape) -> str:
    (a, b), (c, d) = _svg_point(shape.start).split(), _svg_point(shape.end).split()
    return f'<line x1="{a}" y1="{b}" x2="{c}" y2="{d}"/>'


SVG_SHAPES: Mapping[type, Callable[[Any], str]] = MappingProxyType(
    {Arcs: _arcs, Cubics: _cubics, CircleShape: _svg_circle, LineShape: _svg_line}
)


def svg_bytes(comment: Sequence[str], layers: Mapping[str, Sequence[Shape]]) -> bytes:
    """The file: a comment, a title, a group for each layer."""
    return "\n".join(_svg_lines(comment, layers)).encode("utf-8", "replace")


def _svg_lines(comment: Sequence[str], layers: Mapping[str, Sequence[Shape]]) -> Iterator[str]:
    half = (1.0 + MARGIN) * reach(layers)
    half = float(np.ceil(half))
    yield '<?xml version="1.0" encoding="UTF-8"?>'
    yield from ("<!--", *(re.sub("-(?=-)", "- ", line) for line in comment), "-->")  # two hyphens end a comment
    size = f'width="{2.0 * half:g}mm" height="{2.0 * half:g}mm" viewBox="{-half:g} {-half:g} {2.0 * half:g} {2.0 * half:g}"'
    yield f'<svg xmlns="http://www.w3.org/2000/svg" {size} fill="none" stroke-width="{STROKE:g}">'
    yield f"<title>{escape(comment[0])}</title>"
    yield f"<desc>{escape('; '.join(comment[1:]))}</desc>"
    for layer, shapes in layers.items():
        row = LAYERS[layer]
        dashes = f' stroke-dasharray="{DASHES[row.line]}"' if row.line in DASHES else ""
        yield f'<g id="{layer}" stroke="{row.stroke}"{dashes}>'
        yield from (SVG_SHAPES[type(shape)](shape) for shape in shapes)
        yield "</g>"
    yield "</svg>\n"
