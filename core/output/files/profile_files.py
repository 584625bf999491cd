"""Drawings of a profile as DXF and SVG, layer by layer, and the path of a cutter as G-code."""

from __future__ import annotations

from cmath import rect
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from datetime import datetime
from functools import partial
from itertools import pairwise
from math import atan, ceil, sin, sqrt
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np

from core.cam import OUTER, SECOND, faces_of, form_row, keyway_corners, keyway_unknown
from core.errors import KindynaError, NoCam
from core.frozen import frozen
from core.number_text import result_text, rounded_up
from core.numerics.derivatives import cross
from core.output.drawing import svg
from core.output.drawing.dxf import dxf_file
from core.output.files.fitted_curve import (
    FittedCurve,
    contact_face,
    cutting_side,
    exact_curve,
    fit_curve,
    flank_number,
    parallel_curve,
)
from core.output.files.gcode import DIGITS, coordinate, remark
from core.output.files.profile_curve import MM, exact_profile
from core.output.files.profile_fit import FITS, Arcs, Cubics
from core.output.files.profile_request import SAMPLINGS, ProfileRequest
from core.requests import require_in_range as in_range
from core.study import Study

# -- layers of a drawing ----------------------------------------------------------------------------------------


ZERO = 0.75, 0.95
"""Ends of the angle-zero mark, parts of the distance from centre to profile: it touches no curve, or CAD would join them."""
SENSES: Mapping[float, tuple[str, str]] = MappingProxyType(
    {1.0: ("ccw", "counter-clockwise"), -1.0: ("cw", "clockwise")}
)


@frozen
class CircleShape:
    """Circle about the cam centre [mm]."""

    radius: float


@frozen
class LineShape:
    """Straight line from point to point [mm]."""

    start: complex
    end: complex


Shape: TypeAlias = "Arcs | Cubics | CircleShape | LineShape"


@frozen(eq=False)
class ProfileDrawing:
    """A profile or a cutter's path for a file.

    Attributes
    ----------
    study : the study of the design
    request : the requested curve
    main : the curve as the file describes it
    profiles : flank -> its profile, for every flank of the cam; empty where the format is no drawing
    """

    study: Study
    request: ProfileRequest
    main: FittedCurve
    profiles: Mapping[str, FittedCurve] = field(default_factory=dict)

    @property
    def profile(self) -> np.ndarray:
        """Points of the profile (n,), complex [mm], at the cam angles of the study."""
        return self.study.cam.only(self.request.flank).flank.profile * MM


def drawn_profiles(study: Study, request: ProfileRequest, main: FittedCurve, least_mm: float) -> dict[str, FittedCurve]:
    """Flank -> its profile, sampled and fitted like ``main``. Raises KindynaError; NoCam, which names the flank."""

    def profile(flank: str) -> FittedCurve:
        if flank == request.flank and not request.cutter_mm:
            return main
        flank_request = replace(request, flank=flank, cutter_mm=0.0)
        try:
            return fit_curve(study, exact_curve(study, flank_request), flank_request, least_mm)
        except NoCam as error:
            raise NoCam(f"{flank} flank: {error.problem}", error.field, error.hint, error.cam_angles) from None

    return {flank: profile(flank) for flank in _flanks(study)}


def _flanks(study: Study) -> tuple[str, ...]:
    return form_row(study.design.drive.cam.form).flanks


def _layer(study: Study, flank: str) -> str:
    """Layer of a profile: named by the flank in a groove and for the second cam of a pair, else PROFILE."""
    return "PROFILE" if flank == _flanks(study)[0] and OUTER not in _flanks(study) else f"PROFILE_{flank.upper()}"


@frozen
class DrawingLayer:
    """One row of ``LAYERS``.

    Attributes
    ----------
    colour : colour number in DXF
    stroke : colour in SVG
    line : line type
    shapes : the shapes of a job on this layer; may be empty
    """

    colour: int
    stroke: str
    line: str
    shapes: Callable[[ProfileDrawing], Iterator[Shape]]


def _profile(layer: str, job: ProfileDrawing) -> Iterator[Shape]:
    """Profiles; next to the path of a cutter they are drawn for comparison."""
    yield from (drawn.chain for flank, drawn in job.profiles.items() if _layer(job.study, flank) == layer)


def _cutter(job: ProfileDrawing) -> Iterator[Shape]:
    if job.request.cutter_mm:
        yield job.main.chain


def _pitch(second: bool, job: ProfileDrawing) -> Iterator[Shape]:
    """Pitch curves: one for both walls of a groove, one for each cam of a pair."""
    if second and SECOND not in _flanks(job.study):
        return
    request = replace(job.request, flank=SECOND if second else _flanks(job.study)[0])
    radius = contact_face(job.study, request).radius_mm
    if radius:
        yield parallel_curve(job.study, request, radius)


def _circle(field: str, radius: float, job: ProfileDrawing) -> Iterator[Shape]:
    """Circle of a cam's dimension, a radius (1) or a diameter (½); a linkage has no base radius."""
    size = getattr(job.study.design.drive.cam, field, None)
    if size is not None:
        yield CircleShape(radius * size)


def _keyway(job: ProfileDrawing) -> Iterator[Shape]:
    """Sides and bottom of the keyway, from the bore outwards."""
    yield from (LineShape(start, end) for start, end in pairwise(keyway_corners(job.study.design.drive.cam)))


def _zero(job: ProfileDrawing) -> Iterator[Shape]:
    """Angle-zero mark: a radial line towards the nearest profile along the cam's x axis, the global one at cam angle 0."""
    edge = min(_edge(flank.profile * MM) for flank in job.study.cam.flanks)
    yield LineShape(complex(ZERO[0] * edge), complex(ZERO[1] * edge))


def _edge(z: np.ndarray) -> float:
    """Largest x [mm] at which the x axis crosses a closed curve through points (n,)."""
    following = np.roll(z, -1)
    cut = np.flatnonzero((z.imag <= 0.0) != (following.imag <= 0.0))
    start, end = z[cut], following[cut]
    return float((start.real - start.imag * (end.real - start.real) / (end.imag - start.imag)).max())


PROFILES = ("PROFILE", "PROFILE_INNER", "PROFILE_OUTER", "PROFILE_SECOND")
LAYERS: Mapping[str, DrawingLayer] = MappingProxyType(
    {
        **{name: DrawingLayer(7, "#000000", "CONTINUOUS", partial(_profile, name)) for name in PROFILES},
        "CUTTER": DrawingLayer(1, "#d55e00", "CONTINUOUS", _cutter),
        "PITCH": DrawingLayer(5, "#0072b2", "CENTER", partial(_pitch, False)),
        "PITCH_SECOND": DrawingLayer(5, "#0072b2", "CENTER", partial(_pitch, True)),
        "BASE": DrawingLayer(8, "#808080", "DASHED", partial(_circle, "base_radius_mm", 1.0)),
        "BORE": DrawingLayer(7, "#000000", "CONTINUOUS", partial(_circle, "bore_mm", 0.5)),
        "KEYWAY": DrawingLayer(7, "#000000", "CONTINUOUS", _keyway),
        "ZERO": DrawingLayer(3, "#009e73", "CONTINUOUS", _zero),
    }
)


def layers(job: ProfileDrawing) -> dict[str, list[Shape]]:
    """Layer -> its shapes; empty layers are omitted."""
    drawn = {name: list(row.shapes(job)) for name, row in LAYERS.items()}
    return {name: shapes for name, shapes in drawn.items() if shapes}


def reach(drawn: Mapping[str, Sequence[Shape]]) -> float:
    """Largest distance [mm] of any shape from the cam centre; for curves that of their points."""
    return max(_reach(shape) for shapes in drawn.values() for shape in shapes)


def _reach(shape: Shape) -> float:
    if isinstance(shape, CircleShape):
        return shape.radius
    return abs(shape.end) if isinstance(shape, LineShape) else float(np.abs(shape.vertices).max())


def facts(job: ProfileDrawing) -> dict[str, Any]:
    """Facts about the file for its JSON summary and for the terminal."""
    request, main = job.request, job.main
    by_layer = {_layer(job.study, flank): {"flank": flank, **_figures(drawn)} for flank, drawn in job.profiles.items()}
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
        **({"layers": by_layer} if len(by_layer) > 1 else {}),
    }


def _figures(drawn: FittedCurve) -> dict[str, Any]:
    return {"points": drawn.count, "length_mm": drawn.curve.length, "deviation_mm": drawn.deviation}


def one_line(text: str) -> str:
    """Text in one line, without characters that cannot be printed."""
    return "".join(c if c.isprintable() else "?" for c in " ".join(text.split()))


def comment(job: ProfileDrawing) -> list[str]:
    """Facts about the file in lines, for a comment in it."""
    values = facts(job)
    radius = f", radius {job.request.cutter_mm!r} mm" if job.request.cutter_mm else ""
    allowed = "" if values["tolerance_mm"] is None else f", tolerance {values['tolerance_mm']!r} mm"
    missing = ", ".join(f"cam.{name}" for name in keyway_unknown(job.study.design.drive.cam))
    keyway = [f"Keyway: not drawn, not given: {missing}"] if missing else []
    return [
        f"Design: {one_line(values['design'])}",
        f"Curve: {values['curve']}{radius}, {values['flank']} flank",
        f"Cam turns {SENSES[job.study.sense][1]} ({values['rotation']}) as drawn",
        f"Units: mm; origin: {values['origin']}",
        f"Points: {values['points']}, {values['sampling']}; {values['fit']}",
        f"Length: {result_text(values['length_mm'], 6)} mm",
        f"Deviation from the exact curve: at most {rounded_up(values['deviation_mm'], 4)!r} mm{allowed}",
        *(
            f"Layer {name}: profile, {row['flank']} flank, {row['points']} points, at most {rounded_up(row['deviation_mm'], 4)!r} mm"
            for name, row in values.get("layers", {}).items()
        ),
        *keyway,
    ]


# -- DXF, written by ezdxf --------------------------------------------------------------------------------------


PLANAR = 8  # flag of a spline; its ends meet, as the flag of a closed one makes some programs move control points
VIEW = 2.2  # height of the initial view, relative to the drawing's reach
LINES: Mapping[str, tuple[str, list[float]]] = MappingProxyType(
    {"CENTER": ("Center ____ _ ____", [12.0, 8.0, -1.5, 1.0, -1.5]), "DASHED": ("Dashed __ __", [4.0, 2.5, -1.5])}
)
"""Line types: description, then length of the pattern and its dashes and gaps [mm]."""


def dxf_bytes(comment: Sequence[str], layers: Mapping[str, Sequence[Shape]]) -> bytes:
    """A drawing as DXF: comments, a header with units and origin, the shapes on their layers."""
    from ezdxf.tools.juliandate import juliandate

    def draw(drawing: Any) -> None:
        drawing.header["$INSBASE"] = (0.0, 0.0, 0.0)
        drawing.header["$TDCREATE"] = drawing.header["$TDUCREATE"] = juliandate(datetime(2000, 1, 1))
        for line, (text, pattern) in LINES.items():
            drawing.linetypes.add(line, pattern, description=text)
        half = reach(layers)
        drawing.set_modelspace_vport(VIEW * half)
        space = drawing.modelspace()
        space.reset_extents((-half, -half, 0.0), (half, half, 0.0))
        for layer, shapes in layers.items():
            drawing.layers.add(layer, color=LAYERS[layer].colour, linetype=LAYERS[layer].line)
            for shape in shapes:
                DXF_SHAPES[type(shape)](space, shape, {"layer": layer})
        for kind in sorted(drawing.entitydb.dxf_types_in_use()):  # the order of a set varies
            drawing.classes.add_class(kind)

    return dxf_file(comment, draw)


def _polyline(space: Any, shape: Arcs, attributes: dict[str, Any]) -> None:
    rows = np.column_stack((shape.vertices.real, shape.vertices.imag, shape.b.ravel()))
    space.add_lwpolyline(rows.tolist(), format="xyb", close=True, dxfattribs=attributes)


def _spline(space: Any, shape: Cubics, attributes: dict[str, Any]) -> None:
    """One cubic B-spline with double knots; its control points are the inner Bézier points."""
    inner = shape.points[:, 1:3].ravel()
    points = np.concatenate((shape.points[:1, 0], inner, shape.points[:1, 0]))
    ends = np.append(0.0, np.cumsum(shape.lengths))
    knots = np.concatenate(([0.0, 0.0], np.repeat(ends, 2), [ends[-1]] * 2))
    entity = space.add_spline(dxfattribs={**attributes, "degree": 3, "flags": PLANAR, "extrusion": (0.0, 0.0, 1.0)})
    entity.knots = knots.tolist()
    entity.control_points = [(z.real, z.imag, 0.0) for z in points.tolist()]


def _dxf_line(space: Any, shape: LineShape, attributes: dict[str, Any]) -> None:
    space.add_line((shape.start.real, shape.start.imag), (shape.end.real, shape.end.imag), dxfattribs=attributes)


DXF_SHAPES: Mapping[type, Callable[[Any, Any, dict[str, Any]], None]] = MappingProxyType(
    {
        Arcs: _polyline,
        Cubics: _spline,
        CircleShape: lambda space, shape, attributes: space.add_circle((0.0, 0.0), shape.radius, dxfattribs=attributes),
        LineShape: _dxf_line,
    }
)


# -- G-code (ISO 6983): the path of a cutter's centre -----------------------------------------------------------


_POINT = 0.5 * 2.0**0.5 * 10.0**-DIGITS  # largest error of a rounded point, mm
ROUNDING: Mapping[str, float] = MappingProxyType({"polyline": _POINT, "arcs": (2.0 + 2.0**0.5) * _POINT})
"""Fit -> largest error [mm] of its moves by rounding. Rounded ends move an arc of up to half a turn by √2 times the error of a point.
A rounded centre is nearer to one end by up to twice that error, which machines spread over the arc or correct at an end."""
MOST_RADIUS = 9999.0  # mm: flatter arcs become straight moves, as machines with few digits cannot represent the centre
DEPTH = 10.0  # mm, for a cam without a thickness
LEAD = 1.0  # distance from the path at which the cutter plunges, where there is room, in cutter radii
CLEAR = 1e-3  # tolerance of its distance from the profile there, in cutter radii
PROFILE_POINTS = 8192


def require(study: Study, request: ProfileRequest) -> None:
    """Raises KindynaError for a request that cannot be written as G-code."""
    if not request.cutter_mm:
        raise KindynaError("cutter: G-code needs the radius of a cutter, and none is given; allowed: above 0 mm")
    in_range(request.machining)


def gcode_bytes(job: ProfileDrawing) -> bytes:
    """The G-code program of a job, in ASCII."""
    return ("\n".join(_gcode_lines(job)) + "\n").encode("ascii")


def _gcode_lines(job: ProfileDrawing) -> Iterator[str]:
    machining, path, depths, plunge_point = job.request.machining, _cutting_path(job), _depths(job), _plunge_point(job)
    up = f"G0 Z{coordinate(machining.safe_mm)}"
    yield "%"
    yield from (remark(line) for line in (*comment(job), *_header(job, path, depths, plunge_point)))
    yield "G21 G17 G90 G94 G40 G80"
    yield up
    yield f"M0 {remark('Start spindle and coolant')}"
    yield f"G0 {_gcode_point(path[0][0] if plunge_point is None else plunge_point)}"
    for number, depth in enumerate(depths, 1):
        if len(depths) > 1:
            yield remark(f"Pass {number} of {len(depths)}")
        yield f"G1 Z{coordinate(-depth)} F{coordinate(machining.plunge_mm_min)}"
        moves = list(_moves(path))
        if plunge_point is not None:
            moves = [f"G1 {_gcode_point(path[0][0])}", *moves, f"G1 {_gcode_point(plunge_point)}"]
        first, *following = moves
        yield f"{first} F{coordinate(machining.feed_mm_min)}"
        yield from following
    yield up
    yield f"M0 {remark('Stop spindle and coolant')}"
    yield "M30"
    yield "%"


def _header(
    job: ProfileDrawing, path: Sequence[_Arc], depths: Sequence[float], plunge_point: complex | None
) -> list[str]:
    machining, radius = job.request.machining, job.request.cutter_mm
    z = np.array([point for p, q, b in path for point in (p, 0.5 * (p + q - 1j * b * (q - p)))])  # ends and middles
    direction = "counter-clockwise" if float(cross(z, np.roll(z, -1)).sum()) > 0.0 else "clockwise"
    where = (
        "on the path: there is no room next to it"
        if plunge_point is None
        else "next to the path, and approaches it at right angles"
    )
    has_arcs = any(bulge for _, _, bulge in path)
    return [
        "ISO 6983, absolute; zero point of the active offset: X0 Y0 the cam centre, Z0 the face of the blank",
        f"Cutter: radius {radius!r} mm; path of its centre, without compensation",
        f"Direction: {direction} around the cam seen from above, {'conventional' if machining.conventional else 'climb'} milling with M3",
        f"Feed {coordinate(machining.feed_mm_min)} mm/min, plunge {coordinate(machining.plunge_mm_min)} mm/min, "
        f"rapid moves at Z{coordinate(machining.safe_mm)}",
        f"Depth {coordinate(depths[-1])} mm in {len(depths)} pass{'es' * (len(depths) > 1)}; the cutter plunges {where}",
        *(["Arcs: G2 and G3, with I and J from the start of an arc to its centre"] if has_arcs else []),
        "Tool, spindle and coolant are left to the machinist: the program stops for them",
    ]


def _depths(job: ProfileDrawing) -> list[float]:
    """Depths below the face [mm]: equal steps, none larger than requested."""
    machining = job.request.machining
    depth = machining.depth_mm or job.study.design.drive.cam.thickness_mm or DEPTH
    count = ceil(depth / machining.step_mm * (1.0 - 1e-9)) if machining.step_mm else 1
    return [depth * number / count for number in range(1, count + 1)]


_Arc = tuple[complex, complex, float]
"""Start, end [mm] and bulge of a move; bulge 0 is straight."""


def _cutting_path(job: ProfileDrawing) -> list[_Arc]:
    """The full path from cam angle 0, in the direction of cutting."""
    chain, side = job.main.chain, cutting_side(job.study, job.request)
    assert isinstance(chain, Arcs)
    p = chain.vertices
    path = list(zip(p.tolist(), np.roll(p, -1).tolist(), chain.b.ravel().tolist(), strict=True))
    if (side > 0.0) == job.request.machining.conventional:  # with M3, a cutter left of the profile climbs
        path = [(end, start, -bulge) for start, end, bulge in reversed(path)]
    return path


def _moves(path: Sequence[_Arc]) -> Iterator[str]:
    """Moves along the path. Ends that round to one point need no move: an arc between them would be a full turn."""
    position = _rounded(path[0][0])
    for start, end, bulge in path:
        for target, move_bulge in _split_arc(start, end, bulge):
            rounded = _rounded(target)
            if rounded == position:
                continue
            if move_bulge:
                middle = 0.5 * (position + rounded) + 0.25j * (rounded - position) * (1.0 / move_bulge - move_bulge)
                centre = middle - position
                yield f"G{3 if move_bulge > 0.0 else 2} {_gcode_point(rounded)} I{coordinate(centre.real)} J{coordinate(centre.imag)}"
            else:
                yield f"G1 {_gcode_point(rounded)}"
            position = rounded


def _split_arc(start: complex, end: complex, bulge: float) -> Iterator[tuple[complex, float]]:
    """Ends and bulges of the moves of an arc: one, or chords where the arc is too flat."""
    chord = end - start
    if not bulge or abs(chord) * (1.0 + bulge * bulge) <= 4.0 * abs(bulge) * MOST_RADIUS:
        yield end, bulge
        return
    half = 2.0 * atan(bulge)  # half of the turn
    count = ceil(sqrt(0.5 * abs(chord * bulge) / _POINT))  # chords within the rounding
    yield from (
        (start + chord * sin(half * i / count) / sin(half) * rect(1.0, half * (i / count - 1.0)), 0.0)
        for i in range(1, count + 1)
    )


def _plunge_point(job: ProfileDrawing) -> complex | None:
    """Point next to the path where the cutter plunges [mm]; None where it plunges on the path."""
    ends, side = job.main.points.ends, cutting_side(job.study, job.request)
    lead = _lead(job, side)
    return complex(ends.z[0] + lead * side * 1j * ends.tangent[0]) if lead else None


def _lead(job: ProfileDrawing, side: float) -> float:
    """Distance of that point from the path [mm]: 0 in a groove, and where another part of the profile is too near."""
    study, radius = job.study, job.request.cutter_mm
    if OUTER in faces_of(study.design.drive.face, study.design.drive.cam):
        return 0.0
    exact = exact_profile(study, flank_number(study, job.request))
    z = exact(study.program.angles(np.arange(PROFILE_POINTS) * 2.0 * np.pi / PROFILE_POINTS)).z
    ends = job.main.points.ends
    for part in (0.25, 0.5, 0.75, 1.0):
        point = ends.z[0] + part * LEAD * radius * side * 1j * ends.tangent[0]
        if float(np.abs(z - point).min()) < radius * (1.0 - CLEAR):
            return 0.0
    return LEAD * radius


def _rounded(z: complex) -> complex:
    return complex(round(z.real, DIGITS), round(z.imag, DIGITS))


def _gcode_point(z: complex) -> str:
    return f"X{coordinate(z.real)} Y{coordinate(z.imag)}"


# -- SVG to scale -----------------------------------------------------------------------------------------------


MARGIN = 0.05  # around the drawing, relative to its size
STROKE = 0.25  # mm
DASHES: Mapping[str, str] = MappingProxyType({"CENTER": "8 1.5 1 1.5", "DASHED": "2.5 1.5"})
"""Line type -> its dashes."""


def _arcs(shape: Arcs) -> str:
    """Path of arcs. The y axis of paper points down: an arc that turns left runs clockwise, sweep 0."""
    vertices, ends = shape.vertices.tolist(), np.roll(shape.vertices, -1).tolist()
    parts = [f"M {svg.point(vertices[0])}"]
    for start, end, bulge in zip(vertices, ends, shape.b.ravel().tolist(), strict=True):
        if bulge:
            radius = 0.5 * abs(end - start) / abs(sin(2.0 * atan(bulge)))
            parts.append(f"A {radius!r} {radius!r} 0 0 {0 if bulge > 0.0 else 1} {svg.point(end)}")
        else:
            parts.append(f"L {svg.point(end)}")
    return svg.element("path", d="\n".join([*parts, "Z"]))


def _cubics(shape: Cubics) -> str:
    parts = [f"C {svg.point(a)} {svg.point(b)} {svg.point(c)}" for _, a, b, c in shape.points.tolist()]
    return svg.element("path", d="\n".join([f"M {svg.point(complex(shape.points[0, 0]))}", *parts, "Z"]))


SVG_SHAPES: Mapping[type, Callable[[Any], str]] = MappingProxyType(
    {
        Arcs: _arcs,
        Cubics: _cubics,
        CircleShape: lambda shape: svg.circle(0j, shape.radius),
        LineShape: lambda shape: svg.line(shape.start, shape.end),
    }
)


def svg_bytes(comment: Sequence[str], layers: Mapping[str, Sequence[Shape]]) -> bytes:
    """A drawing as SVG: a comment, a title, a group for each layer."""
    half = ceil((1.0 + MARGIN) * reach(layers))
    lines: list[str] = []
    for layer, shapes in layers.items():
        row = LAYERS[layer]
        drawn = (SVG_SHAPES[type(shape)](shape) for shape in shapes)
        lines += svg.group(drawn, id=layer, stroke=row.stroke, stroke_dasharray=DASHES.get(row.line))
    box, size = (-half, -half, 2.0 * half, 2.0 * half), f"{2.0 * half:g}mm"
    about = "; ".join(comment[1:])
    text = svg.document(lines, box, (size, size), comment[0], about, comment, fill="none", stroke_width=f"{STROKE:g}")
    return text.encode("utf-8", "replace")
