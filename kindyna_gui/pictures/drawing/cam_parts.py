"""The cam: filled outline with its zero mark, pitch curve, base circle, shaft, sense of rotation; and where it
touches: normal and instant centre."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QLineF
from PySide6.QtGui import QPainterPath
from PySide6.QtWidgets import QGraphicsLineItem

from core.cam import OUTER, SECOND
from core.mechanism.kinematics import REVOLUTE, SLIDING
from kindyna_gui.pictures.drawing.geometry import MM, Geometry, Joint
from kindyna_gui.pictures.items import DrawnPart, Loop, Outline, Tag, pinned, turning
from kindyna_gui.pictures.shapes import arc_arrow, at, bearing, circle, cross, joined, outline, segments
from kindyna_gui.pictures.style import CHAIN, DASHED, DOTTED, OUTLINE, SPARSE, THIN, Theme, brush

Z_CAM, Z_CURVES, Z_SHAFT, Z_NORMAL = 2.0, 2.5, 3.5, 8.0
RIM = 1.2  # of the plate of a grooved cam beyond its groove, in units
ARROW_START, ARROW_SPAN = 200.0, 80.0  # of the arrow of rotation, deg


def cam(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """All that turns with the camshaft, and the shaft in its bearing."""
    if not geometry.with_cam:
        return
    if geometry.profile.size:
        item = Loop(geometry.profile, theme.pen(theme.cam_line, OUTLINE), brush(theme.cam))
        yield DrawnPart("cam", item, ("cam",), Z_CAM, turning(item, geometry.turned))
        yield from _zero_mark(geometry, theme)
        for name, radius in geometry.bored:
            path = _bore(geometry.keyway) if name == "bore" and geometry.keyway else circle(radius)
            edge = Outline(path, theme.pen(theme.cam_line, THIN))
            yield DrawnPart(name, edge, ("cam",), Z_CURVES, turning(edge, geometry.turned))
        for flank in geometry.further:
            yield from FURTHER[flank.name](flank.profile * MM, geometry, theme)
        if geometry.pitch.size:
            pitch = Loop(geometry.pitch, theme.pen(theme.quiet, THIN, CHAIN))
            yield DrawnPart("pitch", pitch, ("pitch",), Z_CURVES, turning(pitch, geometry.turned))
    yield DrawnPart(
        "base", Outline(circle(geometry.base_radius), theme.pen(theme.cam_line, THIN, DOTTED)), ("base",), Z_CURVES
    )
    yield from _shaft(geometry, theme)


def _bore(keyway: Sequence[complex]) -> QPainterPath:
    """A bore with its keyway, by the corners of that: round from its last to its first."""
    first, last = keyway[0], keyway[-1]
    span = float(np.mod(np.angle(first / last), 2.0 * np.pi))
    return outline(np.append(last * np.exp(1j * np.linspace(0.0, span, 360)), keyway[:-1]))


def _groove(profile: np.ndarray, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """The plate outside the groove, whose rim the design leaves open, and the outer flank."""
    rim = float(np.abs(profile).max()) + RIM * geometry.unit
    plate = Outline(joined(circle(rim), outline(profile)), None, brush(theme.cam, 0.5))
    yield DrawnPart("plate", plate, ("cam",), Z_CAM - 0.2, turning(plate, geometry.turned))
    yield DrawnPart("rim", Outline(circle(rim), theme.pen(theme.cam_line, THIN, SPARSE)), ("cam",), Z_CAM - 0.1)
    line = Loop(profile, theme.pen(theme.cam_line, OUTLINE))
    yield DrawnPart("outer", line, ("cam",), Z_CAM, turning(line, geometry.turned))


def _second_cam(profile: np.ndarray, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """The other cam of a conjugate pair, behind the first; where that hides it, its edge is dashed."""
    item = Loop(profile, theme.pen(theme.second_line, OUTLINE), brush(theme.second))
    yield DrawnPart("second", item, ("cam",), Z_CAM - 0.5, turning(item, geometry.turned))
    hidden = Loop(profile, theme.pen(theme.second_line, THIN, DASHED))
    yield DrawnPart("second.hidden", hidden, ("cam",), Z_CAM + 0.1, turning(hidden, geometry.turned))


FURTHER: Mapping[str, Callable[[np.ndarray, Geometry, Theme], Iterator[DrawnPart]]] = MappingProxyType(
    {OUTER: _groove, SECOND: _second_cam}
)
"""Flank of a cam besides the first -> how it is drawn."""


def _zero_mark(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """A radial tick up to where the cam's own +x leaves the outline."""
    edge, inner = edge_radius(geometry.profile), 0.76 * geometry.bearing_room
    tick = Outline(segments([(inner + 0j, edge + 0j)]), theme.pen(theme.cam_line, THIN))
    yield DrawnPart("zero", tick, ("cam",), Z_CURVES, turning(tick, geometry.turned))
    tag = Tag("0°", theme.cam_line, theme)
    track = inner * np.exp(1j * np.deg2rad(geometry.turned))
    yield DrawnPart("zero.text", tag, ("cam", "labels"), Z_CURVES, _inwards(tag, track))


def _inwards(tag: Tag, track: np.ndarray) -> Callable[[int], None]:
    """The text stands a constant number of pixels towards the centre from its place."""
    move, towards = pinned(tag, track), -track / np.abs(track)

    def follow(i: int) -> None:
        move(i)
        tag.shift(13.0 * towards.real[i], -10.0 * towards.imag[i])

    return follow


def edge_radius(profile: np.ndarray) -> float:
    """Where the cam's +x axis leaves the outline [mm]."""
    after = np.roll(profile, -1)
    cut = np.flatnonzero((profile.imag <= 0.0) != (after.imag <= 0.0))
    one, other = profile[cut], after[cut]
    return float((one.real - one.imag * (other.real - one.real) / (other.imag - one.imag)).max())


def shaft_radius(geometry: Geometry) -> float:
    """Of the camshaft's bearing [mm]."""
    return min(2.0 * geometry.unit, 0.3 * geometry.bearing_room)


def sense_arc(geometry: Geometry) -> tuple[float, float, float]:
    """The arrow that shows the sense of rotation: radius [mm], start and span [deg]."""
    radius = max(1.6 * shaft_radius(geometry), 0.5 * geometry.bearing_room)
    for _, other in geometry.bored:  # it must not look like a part of them
        radius = 1.25 * other if 0.85 * other < radius < 1.2 * other else radius
    start = ARROW_START if geometry.sense > 0 else ARROW_START + ARROW_SPAN
    return radius, start, geometry.sense * ARROW_SPAN


def _shaft(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    outer = shaft_radius(geometry)
    bush, lines, shaft = bearing(0.55 * outer, outer)
    yield DrawnPart("shaft.bush", Outline(bush, theme.pen(theme.ink, THIN), brush(theme.paper)), ("ground",), Z_SHAFT)
    yield DrawnPart("shaft.hatching", Outline(lines, theme.pen(theme.quiet, THIN)), ("ground",), Z_SHAFT + 0.1)
    yield DrawnPart("shaft", Outline(shaft, theme.pen(theme.ink, THIN), brush(theme.shaft)), ("cam",), Z_SHAFT + 0.2)
    radius, start, span = sense_arc(geometry)
    line, head = arc_arrow(radius, start, span, min(1.6 * geometry.unit, 0.3 * radius))
    yield DrawnPart("sense", Outline(line, theme.pen(theme.cam_line, THIN)), ("cam",), Z_SHAFT)
    yield DrawnPart(
        "sense.head", Outline(head, theme.pen(theme.cam_line, THIN), brush(theme.cam_line)), ("cam",), Z_SHAFT
    )


def contact(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """The common normal from the contact through the roller's centre to the instant centre, which lies on it."""
    if geometry.shape is None:
        return
    line = QGraphicsLineItem()
    line.setPen(theme.pen(theme.quiet, THIN))
    yield DrawnPart("normal", line, ("normal",), Z_NORMAL, _normal_move(line, geometry))
    dot = Outline(circle(0.35 * geometry.unit), theme.pen(theme.ink, THIN), brush(theme.ink))
    yield DrawnPart("contact", dot, ("normal",), Z_NORMAL + 0.1, pinned(dot, geometry.contact))
    size = 0.8 * geometry.unit
    mark = Outline(joined(cross(1.5 * size), circle(0.55 * size)), theme.pen(theme.limit, OUTLINE))
    yield DrawnPart("centre", mark, ("centre",), Z_NORMAL + 2.0, pinned(mark, centre_within_reach(geometry)))
    ground = next((j for j in geometry.joints if j.name == geometry.kinematics.ground), None)
    if ground is None:  # the roller's link is held by no pair of its own: the line turns with its pole
        return
    ends = CENTRE_LINES[ground.pair.kind](ground, geometry)
    yield DrawnPart(
        "centre.line", Outline(segments([ends]), theme.pen(theme.quiet, THIN, SPARSE)), ("centre",), Z_NORMAL - 0.5
    )


def _reach(geometry: Geometry) -> float:
    low, high = geometry.core_box
    return 4.0 * abs(high - low)


def centre_within_reach(geometry: Geometry) -> np.ndarray:
    """The instant centre (n,) [mm], infinite also where it is too far to be drawn."""
    q = geometry.centre
    near = np.abs(np.where(np.isfinite(q), q, 0.0)) < 10.0 * _reach(geometry)
    return np.where(np.isfinite(q) & near, q, complex(np.inf, np.inf))


def _normal_move(line: QGraphicsLineItem, geometry: Geometry) -> Callable[[int], None]:
    assert geometry.shape is not None
    normal, start = geometry.shape.flank.normal, geometry.contact - geometry.face_radius * geometry.shape.flank.normal
    with np.errstate(invalid="ignore"):
        along = ((geometry.centre - start) * normal.conjugate()).real
    finite, reach = np.isfinite(along), _reach(geometry)
    overshoot = 2.0 * geometry.unit
    along = np.clip(np.where(finite, along, 0.0), -reach, reach)
    low = np.where(finite, np.minimum(along, -overshoot), -reach)
    high = np.where(finite, np.maximum(along, geometry.face_radius), reach)
    one, other = start + low * normal, start + high * normal

    def move(i: int) -> None:
        line.setLine(QLineF(at(one[i]), at(other[i])))

    return move


def _line_of_centres(ground: Joint, geometry: Geometry) -> tuple[complex, complex]:
    return 0j, complex(ground.track[0])


def _across_the_guide(ground: Joint, geometry: Geometry) -> tuple[complex, complex]:
    reach = float(np.abs(geometry.near_centres).max(initial=0.0)) + 6.0 * geometry.unit
    return -1j * reach * ground.line, 1j * reach * ground.line


CENTRE_LINES: Mapping[str, Callable[[Joint, Geometry], tuple[complex, complex]]] = MappingProxyType(
    {REVOLUTE: _line_of_centres, SLIDING: _across_the_guide}
)
"""The line on which the instant centre stays (Kennedy), by the kind of pair that holds the follower."""
