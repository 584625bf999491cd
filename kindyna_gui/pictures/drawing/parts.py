"""Layers of the drawing, and its links, pairs, rollers, wheels and flexible shaft.

Symbols are sized in units of the geometry, a fixed fraction of the mechanism's size.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QRectF
from PySide6.QtGui import QPainterPath

from core.design.linkage import BELT, RACK
from core.errors import NoSolution, ResultPending
from core.frozen import frozen
from core.mechanism import body_name
from core.mechanism.drivers import Wheel, WheelPair
from core.mechanism.kinematics import REVOLUTE, SLIDING
from core.output.drawing.palette import VERMILION
from core.output.drawing.scales import nice_below
from core.study import Study
from kindyna_gui.pictures.drawing.cam_parts import edge_radius
from kindyna_gui.pictures.drawing.geometry import Body, Geometry, Joint
from kindyna_gui.pictures.items import DrawnPart, Outline, Silhouette, Tag, pinned, riding, turning
from kindyna_gui.pictures.shapes import (
    EYE,
    HATCH,
    PIN,
    at,
    circle,
    cross,
    hatched_box,
    hatching,
    joined,
    lever,
    link,
    outline,
    pedestal,
    plate,
    polyline,
    scaled,
    segments,
    stem,
)
from kindyna_gui.pictures.style import CHAIN, DASHED, OUTLINE, TEXT, THIN, Theme, brush
from kindyna_gui.pictures.units import digits, typed
from kindyna_gui.requirements import lists_links

if TYPE_CHECKING:
    from core.stability import SteadyTurn


# -- layers --------------------------------------------------------------------------------------------


@frozen
class Layer:
    """One layer: its label on the menu, and whether it is shown at first."""

    label: str
    shown: bool = True


OUTLINE_LAYER = ("outlines",)
DIMENSIONS, TWIST, MODULO, COUPLER = "dimensions", "twist", "modulo", "coupler"

LAYERS: Mapping[str, Layer] = MappingProxyType(
    {
        "ground": Layer("Ground"),
        "guide": Layer("Guide"),
        "cam": Layer("Cam"),
        "pitch": Layer("Pitch curve"),
        "base": Layer("Base circle"),
        "roller": Layer("Roller"),
        "linkage": Layer("Linkage"),
        "normal": Layer("Contact normal"),
        "centre": Layer("Instant centre"),
        "outlines": Layer("Outlines and least clearance"),
        "loads": Layer("Springs and loads"),
        "masses": Layer("Centres of mass", shown=False),
        "velocities": Layer("Velocities", shown=False),
        "forces": Layer("Forces", shown=False),
        "inertia": Layer("Weight and inertia forces", shown=False),
        "pressure_colours": Layer("Profile coloured by pressure angle", shown=False),
        "curvature_colours": Layer("Profile coloured by curvature", shown=False),
        "stress_colours": Layer("Profile coloured by contact pressure", shown=False),
        TWIST: Layer("Flexible shaft and its twist", shown=False),
        DIMENSIONS: Layer("Dimensions", shown=False),
        MODULO: Layer("Position modulo the advance", shown=False),
        "labels": Layer("Labels"),
        "scale": Layer("Scale bar"),
    }
)

GHOST_POSES: Mapping[str, int] = MappingProxyType({f"poses{n}": n for n in (10, 15, 30, 45, 90)})
"""Angle between the ghost poses of a layer [deg]."""

LINKAGE_LAYERS: Mapping[str, Layer] = MappingProxyType(
    {
        "centres": Layer("Instant centres of all links", shown=False),
        "kennedy": Layer("Kennedy's construction", shown=False),
        "ratios": Layer("Velocity ratios to the driver", shown=False),
        "chain": Layer("Velocity ratios from link to link", shown=False),
        COUPLER: Layer("Coupler curves", shown=False),
        **{name: Layer(f"Ghost poses every {n}°", shown=False) for name, n in GHOST_POSES.items()},
    }
)
"""Further layers for general linkages."""

STEP_LAYERS = ("centres", "kennedy")
"""Layers that a step of the circle diagram needs."""

COLOUR_LAYERS = ("pressure_colours", "curvature_colours", "stress_colours")
"""Colour layers, of which at most one is shown at a time."""

BODY_FORCE_LAYERS = ("forces", "inertia")
"""Layers of the forces on bodies."""

FORCE_LAYERS = (*BODY_FORCE_LAYERS, "stress_colours")
"""Layers that depend on the forces."""

LOAD_LAYERS = ("loads", "masses")
"""Layers that depend on the loads only."""

_CAM_LAYERS = ("cam", "pitch", "base", "roller", "normal", "centre", *COLOUR_LAYERS)
_SPATIAL_LAYERS = {"cam", "roller"}
EVERY_LAYER: Mapping[str, Layer] = MappingProxyType({**LAYERS, **LINKAGE_LAYERS})


def has_advance(study: Study) -> bool:
    """Whether the motion has an advance, so that each turn begins further on."""
    motion = study.design.drive.motion
    return motion is not None and bool(motion.gain)


def available_layers(study: Study) -> tuple[str, ...]:
    """Layers that apply to a design."""
    shaft = study.design.shaft
    omitted = {
        *(() if study.has_disk else set(_CAM_LAYERS) - (_SPATIAL_LAYERS if study.has_surface else set())),
        *(() if has_advance(study) else (MODULO,)),
        *(() if study.design.outlines else ("outlines",)),
        *(() if shaft is not None and shaft.elastic is not None else (TWIST,)),
    }
    rows = EVERY_LAYER if lists_links(study.design) else LAYERS
    return tuple(name for name in rows if name not in omitted)


# -- links and pairs -----------------------------------------------------------------------------------

BLOCK_LENGTH, BLOCK_HEIGHT = 5.2, 3.2  # size of a slider, in units
STEM = 0.65  # half the width of a stem, by the radius of an eye
BUSH = 1.75  # thickness of the bush around a stem, in units
SPRING_ROOM = 6.0  # from the face in its highest position to the bush, where a spring is between them, in units
Z_BEHIND, Z_GROUND, Z_GUIDE, Z_ROLLER, Z_BODY, Z_PIN = 0.5, 3.0, 1.0, 4.0, 5.0, 9.0
_DOWN_FIRST = (-1j, -1 + 0j, 1 + 0j, 1j)


def linkage(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Bodies as bars, levers and plates, and the pins and slides between them."""
    numbers = {name: n for n, name in geometry.study.mechanism.bodies.items()} if geometry.has_numbered_links else {}
    for number, body in enumerate(geometry.moving.values()):
        fill = brush(theme.link(numbers.get(body.name, number + 2)))
        pieces = body_pieces(body, geometry)
        if pieces:
            item = Silhouette(pieces, theme.pen(theme.ink, OUTLINE), fill)
            z = Z_BEHIND if passes_shaft(body, geometry) else Z_BODY
            yield DrawnPart(f"body.{body.name}", item, ("linkage",), z + 0.1 * number, riding(item, body.z, body.turn))
    for joint in drawn_joints(geometry):
        yield from JOINTS[joint.pair.kind](joint, geometry, theme)


def drawn_joints(geometry: Geometry) -> Iterator[Joint]:
    """The pairs to be drawn; several links on one pin have one pin."""
    seen: set[tuple[str, str]] = set()
    for joint in geometry.joints:
        key = (joint.pair.kind, joint.pair.point)
        if not geometry.has_numbered_links or key not in seen:
            seen.add(key)
            yield joint


def body_pieces(body: Body, geometry: Geometry) -> tuple[QPainterPath, ...]:
    """Outline of a body: a bar between two points, a lever about its fixed pivot, or a plate; empty with one point."""
    nodes = geometry.nodes(body)
    points = tuple(nodes.values())
    if len(points) < 2:
        return ()
    if len(points) == 2:
        return link(points, geometry.unit)
    hubs = [
        j.pair.point for j in geometry.joints if j.is_fixed and j.pair.kind == REVOLUTE and j.pair.body == body.name
    ]
    if hubs and hubs[0] in nodes:
        hub = nodes[hubs[0]]
        return lever(hub, tuple(p for p in points if p != hub), geometry.unit)
    return plate(points, geometry.unit)


def passes_shaft(body: Body, geometry: Geometry) -> bool:
    """Whether a bar crosses the camshaft during the turn, so that it is drawn behind the cam."""
    points = tuple(geometry.nodes(body).values())
    if not geometry.has_cam or len(points) != 2:
        return False
    start, end = (body.track(point) for point in points)
    along = end - start
    part = np.clip(-(start * along.conj()).real / np.abs(along) ** 2, 0.0, 1.0)
    return bool(np.abs(start + part * along).min() < EYE * geometry.unit)


def _pin(joint: Joint, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    item = Outline(circle(PIN * geometry.unit), theme.pen(theme.ink, OUTLINE), brush(theme.paper))
    yield DrawnPart(f"pin.{joint.name}", item, ("linkage",), Z_PIN, pinned(item, joint.track))
    if joint.is_fixed:
        yield from _pedestal(joint, geometry, theme)


def _pedestal(joint: Joint, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    turn = 1j * ground_direction(joint, geometry)  # the symbol is drawn downwards
    pivot = complex(joint.track[0])
    triangle, ground = (scaled(path, geometry.unit, pivot, turn) for path in pedestal())
    yield DrawnPart(
        f"pedestal.{joint.name}",
        Outline(triangle, theme.pen(theme.ink, THIN), brush(theme.paper)),
        ("ground",),
        Z_GROUND,
    )
    yield DrawnPart(f"ground.{joint.name}", Outline(ground, theme.pen(theme.quiet, THIN)), ("ground",), Z_GROUND)


def ground_direction(joint: Joint, geometry: Geometry) -> complex:
    """Direction of the ground symbol of a fixed pivot: downwards, unless a link is in the way during the turn."""
    step = max(1, geometry.samples // 24)
    body = geometry.bodies[joint.pair.body]
    links = [body.track(p)[::step] - joint.track[::step] for p in body.nodes.values()]
    away = [z / np.abs(z) for z in links if np.abs(z).min() > 1e-9 * geometry.unit]
    if not away:
        return _DOWN_FIRST[0]
    worst = [max(float((z * complex(d).conjugate()).real.max()) for z in away) for d in _DOWN_FIRST]
    return _DOWN_FIRST[next((i for i, w in enumerate(worst) if w < 0.4), int(np.argmin(worst)))]


def _slide(joint: Joint, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """A stem in a bush for a body with the follower's face, else a block between rails."""
    if is_stem(joint, geometry):
        yield from _stem(joint, geometry, theme)
    else:
        yield from _block(joint, geometry, theme)


def is_stem(joint: Joint, geometry: Geometry) -> bool:
    """Whether the sliding body has the follower's face."""
    is_follower = joint.is_fixed and joint.pair.body == geometry.kinematics.follower_body
    return is_follower and not geometry.has_numbered_links and not geometry.is_motion_only


def bush_start(joint: Joint, geometry: Geometry) -> float:
    """Start of a stem's bush, outwards from the joint's root, in units; a spring before it has its room."""
    room = SPRING_ROOM if geometry.has_spring else 1.5
    return joint.farthest / geometry.unit + geometry.face_radius / geometry.unit + room


def bush_length(joint: Joint, geometry: Geometry) -> float:
    """Length of the bush of a stem, in units."""
    return max(6.0, 0.8 * (joint.high - joint.low) / geometry.unit)


def behind_face(geometry: Geometry, line: complex) -> float:
    """Distance from the follower's reference point to the back of its face, along an outward direction [mm]."""
    return geometry.face_radius or max(0.0, (geometry.face_attachment * line.conjugate()).real)


def _block(joint: Joint, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    unit, body = geometry.unit, geometry.bodies[joint.pair.body]
    half_length, half_height = 0.5 * BLOCK_LENGTH, 0.5 * BLOCK_HEIGHT
    box = QPainterPath()
    box.addRect(QRectF(-half_length, -half_height, BLOCK_LENGTH, BLOCK_HEIGHT))
    path = scaled(box, unit, body.points[joint.pair.point], joint.body_line)
    item = Outline(path, theme.pen(theme.ink, OUTLINE), brush(theme.slider))
    z = Z_BODY - 0.5 if joint.is_fixed else Z_BODY + 0.8
    yield DrawnPart(f"block.{joint.name}", item, ("linkage",), z, riding(item, body.z, body.turn))
    low, high = joint.low / unit - half_length - 1.6, joint.high / unit + half_length + 1.6
    yield from _rails(joint, geometry, theme, low, high, half_height)


def _rails(
    joint: Joint, geometry: Geometry, theme: Theme, low: float, high: float, half_gap: float
) -> Iterator[DrawnPart]:
    """Two lines along the travel of a slide, hatched where the slide is on the ground; lengths in units."""
    ends = [(complex(low, side), complex(high, side)) for side in (half_gap, -half_gap)]
    lines = scaled(segments(ends), geometry.unit, joint.root, joint.line)
    item = Outline(lines, theme.pen(theme.ink, THIN))
    if not joint.is_fixed:
        on = geometry.bodies[joint.pair.on]
        yield DrawnPart(f"rails.{joint.name}", item, ("guide",), Z_BODY + 0.7, riding(item, on.z, on.turn))
        return
    yield DrawnPart(f"rails.{joint.name}", item, ("guide",), Z_GUIDE)
    upper, lower = ends
    hatched = joined(hatching(upper[1], upper[0], 0.85, HATCH), hatching(*lower, 0.85, HATCH))
    path = scaled(hatched, geometry.unit, joint.root, joint.line)
    yield DrawnPart(f"ground.{joint.name}", Outline(path, theme.pen(theme.quiet, THIN)), ("ground", "guide"), Z_GUIDE)


def _stem(joint: Joint, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Stem from the face through a hatched bush beyond the highest position."""
    unit, body = geometry.unit, geometry.bodies[joint.pair.body]
    sign = joint.outward_sign
    line, body_line = joint.line * sign, joint.body_line * sign
    start, length = bush_start(joint, geometry), bush_length(joint, geometry)
    low = (joint.low if sign > 0 else -joint.high) / unit
    eye = min(EYE, 0.4 * geometry.face_radius / unit) if geometry.has_rolling_face else 0.0
    half = STEM * (eye or EYE)
    # a face that is not round is held on its back
    back = max(0.0, (geometry.face_attachment * body_line.conjugate()).real) / unit
    shapes = stem(start + length - low + 1.8 - back, half, eye)
    end = body.points[joint.pair.point] + back * unit * body_line
    pieces = [scaled(path, unit, end, body_line) for path in shapes]
    item = Silhouette(pieces, theme.pen(theme.ink, OUTLINE), brush(theme.links[0]))
    yield DrawnPart(f"stem.{joint.name}", item, ("linkage",), Z_BODY, riding(item, body.z, body.turn))
    walls, strokes = QPainterPath(), QPainterPath()
    for inner, outer in ((half + 0.25, half + BUSH), (-half - BUSH, -half - 0.25)):
        walls.addRect(QRectF(start, inner, length, outer - inner))
        strokes.addPath(hatched_box(start, start + length, inner, outer, HATCH))
    box, lines = scaled(walls, unit, joint.root, line), scaled(strokes, unit, joint.root, line)
    yield DrawnPart(
        f"rails.{joint.name}", Outline(box, theme.pen(theme.ink, THIN), brush(theme.paper)), ("guide",), Z_GUIDE
    )
    yield DrawnPart(
        f"ground.{joint.name}", Outline(lines, theme.pen(theme.quiet, THIN)), ("ground", "guide"), Z_GUIDE + 0.1
    )


def roller(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Follower's face, a roller with its centre mark or another outline, and the rollers on the other flanks."""
    if geometry.has_rolling_face and geometry.face_radius:
        yield from _roller("roller", geometry.reference, geometry.face_radius, geometry, theme)
    elif geometry.face_outline.size:
        item = Outline(outline(geometry.face_outline), theme.pen(theme.ink, OUTLINE), brush(theme.links[0]))
        yield DrawnPart("roller", item, ("roller",), Z_ROLLER, riding(item, geometry.reference, geometry.face_turn))
    for name, track, radius in geometry.other_rollers:
        yield from _roller(f"roller.{name}", track, radius, geometry, theme)


def _roller(key: str, track: np.ndarray, radius: float, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    item = Outline(circle(radius), theme.pen(theme.ink, OUTLINE), brush(theme.roller, 0.75))
    yield DrawnPart(key, item, ("roller",), Z_ROLLER, pinned(item, track))
    eye = min(PIN * geometry.unit, 0.3 * radius)
    mark = joined(circle(eye), cross(min(2.2 * eye, 0.8 * radius)))
    centre = Outline(mark, theme.pen(theme.ink, THIN), brush(theme.paper, 0.6))
    yield DrawnPart(f"{key}.centre", centre, ("roller",), Z_PIN, pinned(centre, track))


JOINTS: Mapping[str, Callable[[Joint, Geometry, Theme], Iterator[DrawnPart]]] = MappingProxyType(
    {REVOLUTE: _pin, SLIDING: _slide}
)


# -- flexible shaft ------------------------------------------------------------------------------------

# The pulley is ahead of the cam by the wind-up of the steady response times a round magnification, which a text gives.

SHOWN_TWIST = 30.0  # [deg] the largest twist is magnified to this angle at most
COILS, POINTS = 3, 240  # turns of the spring at rest, and points of its line
INNER, OUTER = 0.3, 0.66  # radii of the spring's ends, by the free radius around the cam centre
BEYOND, RIM = 1.06, 0.95  # outer radius of the pulley's rim by the cam's, and its inner radius by its outer
Z_PULLEY, Z_SPRING, Z_TWIST = 0.5, 3.2, 8.5


def shaft(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Pulley, spring and twist; a sentence instead where there is no steady response."""
    turn, reason = _steady(geometry)
    curves = [curve for curve in (geometry.profile, geometry.pitch) if curve.size]
    rim = BEYOND * max((float(np.abs(curve).max()) for curve in curves), default=geometry.base_radius)
    below = float(geometry.reference.imag.mean()) >= 0.0  # away from the follower
    note = Tag("", theme.text_colour(VERMILION), theme, TEXT, lean=(0.5, 0.0 if below else 1.0), backing=True)
    note.setPos(0.0, -BEYOND * rim if below else BEYOND * rim)
    if turn is None:
        note.set_text(reason)
        yield DrawnPart("twist.text", note, (TWIST,), Z_TWIST)
        return
    twist = np.rad2deg(turn.wind_up_at_cam(geometry.study.theta))
    times = magnification(twist)
    shown_twist = geometry.rotation_sign * times * twist
    ahead = geometry.cam_rotation + shown_twist
    room = geometry.bearing_room
    pulley = Outline(joined(circle(rim), circle(RIM * rim)), theme.pen(theme.quiet, OUTLINE))
    yield DrawnPart("twist.pulley", pulley, (TWIST,), Z_PULLEY)
    spoke = Outline(segments([(OUTER * room + 0j, rim + 0j)]), theme.pen(theme.seen(VERMILION), OUTLINE))
    yield DrawnPart("twist.input", spoke, (TWIST,), Z_SPRING, turning(spoke, ahead))
    behind = Outline(
        segments([(edge_radius(geometry.profile) + 0j, rim + 0j)]), theme.pen(theme.cam_line, THIN, DASHED)
    )
    fixed = Outline(
        circle(0.4 * geometry.unit, INNER * room + 0j),
        theme.pen(theme.seen(VERMILION), THIN),
        brush(theme.seen(VERMILION)),
    )
    yield DrawnPart("twist.fixed", fixed, (TWIST,), Z_SPRING, turning(fixed, geometry.cam_rotation))
    yield DrawnPart("twist.cam", behind, (TWIST,), Z_SPRING, turning(behind, geometry.cam_rotation))
    spring, arc = (Outline(QPainterPath(), theme.pen(theme.seen(VERMILION), width)) for width in (THIN, 3.0))

    def move(i: int) -> None:
        # in the frame of the cam: the spring's inner end is on the cam, its outer end and the arc's on the pulley
        spring.redraw(_spiral(INNER * room, OUTER * room, geometry.rotation_sign * 360.0 * COILS + shown_twist[i]))
        arc.redraw(_spiral(RIM * rim, RIM * rim, shown_twist[i]))
        for item in (spring, arc):
            item.setRotation(float(geometry.cam_rotation[i]))
        note.set_text(
            f"Twist {digits(twist[i], 3)}\N{DEGREE SIGN}, drawn {typed(times)} \N{MULTIPLICATION SIGN} as large"
        )

    yield DrawnPart("twist.spring", spring, (TWIST,), Z_SPRING, move)
    yield DrawnPart("twist.arc", arc, (TWIST,), Z_TWIST)
    yield DrawnPart("twist.text", note, (TWIST,), Z_TWIST)
    name = Tag("input", theme.text_colour(VERMILION), theme, backing=True)
    yield DrawnPart(
        "twist.name", name, (TWIST, "labels"), Z_TWIST, pinned(name, BEYOND * rim * np.exp(1j * np.deg2rad(ahead)))
    )


def magnification(twist: np.ndarray) -> float:
    """Round number that makes the largest twist (n,) [deg] visible; 1 where the twist is large enough."""
    largest = float(np.abs(twist).max(initial=0.0))
    return max(1.0, nice_below(SHOWN_TWIST / largest)) if largest > 0.0 else 1.0


def _steady(geometry: Geometry) -> tuple[SteadyTurn | None, str]:
    """Steady response, or the reason why there is none."""
    if geometry.profile.size:
        try:
            return geometry.study.steady_turn, ""
        except ResultPending as error:
            return None, f"{error.problem[:1].upper()}{error.problem[1:]}"
        except NoSolution:
            pass
    return None, "The flexible shaft has no steady response"


def _spiral(inner: float, outer: float, span: float) -> QPainterPath:
    """Spiral about the origin from a radius at angle 0 to another at the angle ``span`` [deg]."""
    part = np.linspace(0.0, 1.0, POINTS)
    return polyline((inner + (outer - inner) * part) * np.exp(1j * np.deg2rad(span) * part))


# -- wheels --------------------------------------------------------------------------------------------

Z_WHEELS = 0.6


def wheels(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Wheels of a linkage with known radii, with their rack or belt."""
    for number, pair in enumerate(geometry.wheels, 1):
        for name, wheel in zip(("first", "second"), pair.circles, strict=False):
            body = geometry.bodies[body_name(wheel.link)]
            item = Outline(_wheel(wheel, body.points[wheel.point]), theme.pen(theme.ink, THIN, CHAIN))
            key = f"wheel{number}.{name}"
            yield DrawnPart(key, item, ("linkage",), Z_WHEELS, riding(item, body.z, body.turn))
        if pair.kind == RACK:
            rack = geometry.bodies[body_name(pair.second.link)]
            item = Outline(_rack(pair, geometry), theme.pen(theme.ink, THIN, CHAIN))
            yield DrawnPart(f"wheel{number}.rack", item, ("linkage",), Z_WHEELS, riding(item, rack.z, rack.turn))
        if pair.kind == BELT:
            carrier = geometry.bodies[body_name(pair.carrier)]
            item = Outline(_belt(pair, geometry), theme.pen(theme.ink, OUTLINE))
            yield DrawnPart(f"wheel{number}.belt", item, ("linkage",), Z_WHEELS, riding(item, carrier.z, carrier.turn))


def _wheel(wheel: Wheel, centre: complex) -> QPainterPath:
    """Pitch circle with its radius along the link's x axis."""
    path = circle(wheel.radius, centre)
    path.moveTo(at(centre))
    path.lineTo(at(centre + wheel.radius))
    return path


def _belt(pair: WheelPair, geometry: Geometry) -> QPainterPath:
    """Both straight parts of an open belt, in the frame of the wheels' carrier."""
    carrier = geometry.bodies[body_name(pair.carrier)]
    back = carrier.turn[0].conjugate()
    first, second = (
        complex((geometry.centre_of(wheel)[0] - carrier.z[0]) * back) for wheel in (pair.first, pair.second)
    )
    along = second - first
    lean = (pair.first.radius - pair.second.radius) / abs(along)
    path = QPainterPath()
    for side in (1.0, -1.0):
        across = along / abs(along) * (lean + 1j * side * np.sqrt(max(1.0 - lean * lean, 0.0)))
        path.moveTo(at(first + pair.first.radius * across))
        path.lineTo(at(second + pair.second.radius * across))
    return path


def _rack(pair: WheelPair, geometry: Geometry) -> QPainterPath:
    """Pitch line of a rack in the rack's frame, over the pinion's range and half a radius more, with a start mark."""
    carrier, rack = (geometry.bodies[body_name(n)] for n in (pair.carrier, pair.second.link))
    along = pair.along * carrier.turn
    contact = geometry.centre_of(pair.first) - 1j * along * pair.first.radius
    back = rack.turn.conj()
    local, line = (contact - rack.z) * back, complex((along * back).flat[0])
    travel = (local * line.conjugate()).real
    base = 1j * line * float((local * line.conjugate()).imag.flat[0])
    ends = [base + line * s for s in (travel.min() - 0.5 * pair.first.radius, travel.max() + 0.5 * pair.first.radius)]
    path = QPainterPath()
    path.moveTo(at(ends[0] - 1j * line * 0.2 * pair.first.radius))
    path.lineTo(at(ends[0]))
    path.lineTo(at(ends[1]))
    return path
