"""The linkage and what holds it: bodies, pins, slides and fixed pivots, walked by pairs and points."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QRectF
from PySide6.QtGui import QPainterPath

from core.mechanism.kinematics import REVOLUTE, SLIDING
from kindyna_gui.pictures.drawing.geometry import Body, Geometry, Joint
from kindyna_gui.pictures.items import DrawnPart, Outline, Silhouette, pinned, riding
from kindyna_gui.pictures.shapes import (
    EYE,
    HATCH,
    PIN,
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
    scaled,
    segments,
    stem,
)
from kindyna_gui.pictures.style import OUTLINE, THIN, Theme, brush

BLOCK_LENGTH, BLOCK_HEIGHT = 5.2, 3.2  # of a slider, in units
STEM, BUSH = (
    0.65,
    1.75,
)  # half the width of a stem, in parts of an eye, and how much further out its bush ends, in units
COILED = 6.0  # from the face at its highest to the bush, where a spring stands between them, in units
Z_BEHIND, Z_GROUND, Z_GUIDE, Z_ROLLER, Z_BODY, Z_PIN = 0.5, 3.0, 1.0, 4.0, 5.0, 9.0
_DOWN_FIRST = (-1j, -1 + 0j, 1 + 0j, 1j)


def linkage(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Bodies as bars, levers and plates; pins; slides."""
    for number, body in enumerate(geometry.moving.values()):
        fill = brush(theme.links[number % len(theme.links)])
        pieces = body_pieces(body, geometry)
        if pieces:
            item = Silhouette(pieces, theme.pen(theme.ink, OUTLINE), fill)
            z = Z_BEHIND if passes_shaft(body, geometry) else Z_BODY
            yield DrawnPart(f"body.{body.name}", item, ("linkage",), z + 0.1 * number, riding(item, body.z, body.angle))
    for joint in drawn_joints(geometry):
        yield from JOINTS[joint.pair.kind](joint, geometry, theme)


def drawn_joints(geometry: Geometry) -> Iterator[Joint]:
    """Every pair once: several links on one pin are one pin."""
    seen: set[tuple[str, str]] = set()
    for joint in geometry.joints:
        key = (joint.pair.kind, joint.pair.point)
        if not geometry.numbered or key not in seen:
            seen.add(key)
            yield joint


def body_pieces(body: Body, geometry: Geometry) -> tuple[QPainterPath, ...]:
    """A body as a bar between two points, a lever about its fixed pivot, or a plate; none where it has one point."""
    nodes = geometry.nodes(body)
    places = tuple(nodes.values())
    if len(places) < 2:
        return ()
    if len(places) == 2:
        return link(places, geometry.unit)
    hubs = [j.pair.point for j in geometry.joints if j.fixed and j.pair.kind == REVOLUTE and j.pair.body == body.name]
    if hubs and hubs[0] in nodes:
        hub = nodes[hubs[0]]
        return lever(hub, tuple(p for p in places if p != hub), geometry.unit)
    return plate(places, geometry.unit)


def passes_shaft(body: Body, geometry: Geometry) -> bool:
    """Whether a bar runs across the camshaft somewhere in the turn: it is drawn behind the cam."""
    places = tuple(geometry.nodes(body).values())
    if not geometry.with_cam or len(places) != 2:
        return False
    start, end = (body.track(place) for place in places)
    along = end - start
    part = np.clip(-(start * along.conj()).real / np.abs(along) ** 2, 0.0, 1.0)
    return bool(np.abs(start + part * along).min() < EYE * geometry.unit)


def _pin(joint: Joint, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    item = Outline(circle(PIN * geometry.unit), theme.pen(theme.ink, OUTLINE), brush(theme.paper))
    yield DrawnPart(f"pin.{joint.name}", item, ("linkage",), Z_PIN, pinned(item, joint.track))
    if joint.fixed:
        yield from _pedestal(joint, geometry, theme)


def _pedestal(joint: Joint, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    turn = 1j * ground_direction(joint, geometry)  # the symbol is drawn downwards
    place = complex(joint.track[0])
    triangle, ground = (scaled(path, geometry.unit, place, turn) for path in pedestal())
    yield DrawnPart(
        f"pedestal.{joint.name}",
        Outline(triangle, theme.pen(theme.ink, THIN), brush(theme.paper)),
        ("ground",),
        Z_GROUND,
    )
    yield DrawnPart(f"ground.{joint.name}", Outline(ground, theme.pen(theme.quiet, THIN)), ("ground",), Z_GROUND)


def ground_direction(joint: Joint, geometry: Geometry) -> complex:
    """Where the ground of a fixed pivot is drawn: downwards, unless a link comes from there during the turn."""
    step = max(1, geometry.samples // 24)
    body = geometry.bodies[joint.pair.body]
    links = [body.track(p)[::step] - joint.track[::step] for p in body.nodes.values()]
    away = [z / np.abs(z) for z in links if np.abs(z).min() > 1e-9 * geometry.unit]
    if not away:
        return _DOWN_FIRST[0]
    worst = [max(float((z * complex(d).conjugate()).real.max()) for z in away) for d in _DOWN_FIRST]
    return _DOWN_FIRST[next((i for i, w in enumerate(worst) if w < 0.4), int(np.argmin(worst)))]


def _slide(joint: Joint, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """A body that carries the follower's face is a stem in a bush, any other a block between rails."""
    if is_stem(joint, geometry):
        yield from _stem(joint, geometry, theme)
    else:
        yield from _block(joint, geometry, theme)


def is_stem(joint: Joint, geometry: Geometry) -> bool:
    """Whether what slides carries the follower's face."""
    follows = joint.fixed and joint.pair.body == geometry.kinematics.follower_body
    return follows and not geometry.numbered and not geometry.alone


def bush_start(joint: Joint, geometry: Geometry) -> float:
    """Where the bush of a stem begins, from the joint's root outwards, in units; behind a spring there is room for its coils."""
    room = COILED if geometry.sprung else 1.5
    return joint.farthest / geometry.unit + geometry.face_radius / geometry.unit + room


def bush_length(joint: Joint, geometry: Geometry) -> float:
    """Of the bush of a stem, in units."""
    return max(6.0, 0.8 * (joint.high - joint.low) / geometry.unit)


def behind_face(geometry: Geometry, line: complex) -> float:
    """How far behind the follower's reference point its face ends, along a line outwards [mm]."""
    return geometry.face_radius if geometry.face_radius else max(0.0, (geometry.face_held * line.conjugate()).real)


def _block(joint: Joint, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    unit, body = geometry.unit, geometry.bodies[joint.pair.body]
    half_length, half_height = 0.5 * BLOCK_LENGTH, 0.5 * BLOCK_HEIGHT
    box = QPainterPath()
    box.addRect(QRectF(-half_length, -half_height, BLOCK_LENGTH, BLOCK_HEIGHT))
    path = scaled(box, unit, body.points[joint.pair.point], joint.own)
    item = Outline(path, theme.pen(theme.ink, OUTLINE), brush(theme.slider))
    z = Z_BODY - 0.5 if joint.fixed else Z_BODY + 0.8
    yield DrawnPart(f"block.{joint.name}", item, ("linkage",), z, riding(item, body.z, body.angle))
    low, high = joint.low / unit - half_length - 1.6, joint.high / unit + half_length + 1.6
    yield from _rails(joint, geometry, theme, low, high, half_height)


def _rails(
    joint: Joint, geometry: Geometry, theme: Theme, low: float, high: float, half_gap: float
) -> Iterator[DrawnPart]:
    """Two lines along a slide's travel, hatched outside where they are ground; lengths in units."""
    ends = [(complex(low, side), complex(high, side)) for side in (half_gap, -half_gap)]
    lines = scaled(segments(ends), geometry.unit, joint.root, joint.line)
    item = Outline(lines, theme.pen(theme.ink, THIN))
    if not joint.fixed:
        on = geometry.bodies[joint.pair.on]
        yield DrawnPart(f"rails.{joint.name}", item, ("guide",), Z_BODY + 0.7, riding(item, on.z, on.angle))
        return
    yield DrawnPart(f"rails.{joint.name}", item, ("guide",), Z_GUIDE)
    upper, lower = ends
    hatched = joined(hatching(upper[1], upper[0], 0.85, HATCH), hatching(*lower, 0.85, HATCH))
    path = scaled(hatched, geometry.unit, joint.root, joint.line)
    yield DrawnPart(f"ground.{joint.name}", Outline(path, theme.pen(theme.quiet, THIN)), ("ground", "guide"), Z_GUIDE)


def _stem(joint: Joint, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """A stem from the face through a hatched bush beyond the highest position."""
    unit, body = geometry.unit, geometry.bodies[joint.pair.body]
    outwards = joint.outwards
    line, own = joint.line * outwards, joint.own * outwards
    start, length = bush_start(joint, geometry), bush_length(joint, geometry)
    low = (joint.low if outwards > 0 else -joint.high) / unit
    eye = min(EYE, 0.4 * geometry.face_radius / unit) if geometry.face_rolls else 0.0
    half = STEM * (eye or EYE)
    inner = max(0.0, (geometry.face_held * own.conjugate()).real) / unit  # of a face without a round: on its back
    shapes = stem(start + length - low + 1.8 - inner, half, eye)
    pieces = [scaled(path, unit, body.points[joint.pair.point] + inner * unit * own, own) for path in shapes]
    item = Silhouette(pieces, theme.pen(theme.ink, OUTLINE), brush(theme.links[0]))
    yield DrawnPart(f"stem.{joint.name}", item, ("linkage",), Z_BODY, riding(item, body.z, body.angle))
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
    """The follower's face: a roller with its centre mark, else its outline; and the rollers on further flanks."""
    if geometry.face_rolls and geometry.face_radius:
        yield from _roller("roller", geometry.reference, geometry.face_radius, geometry, theme)
    elif geometry.face_outline.size:
        item = Outline(outline(geometry.face_outline), theme.pen(theme.ink, OUTLINE), brush(theme.links[0]))
        yield DrawnPart("roller", item, ("roller",), Z_ROLLER, riding(item, geometry.reference, geometry.face_angle))
    for name, track, radius in geometry.further_rollers:
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
