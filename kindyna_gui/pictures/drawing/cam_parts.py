"""The cam: filled outline with its zero mark, pitch curve, base circle, shaft, sense of rotation; and where it
touches: normal and instant centre."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QLineF
from PySide6.QtWidgets import QGraphicsLineItem

from core.mechanism.kinematics import REVOLUTE, SLIDING
from kindyna_gui.pictures.drawing.items import Loop, Outline, Part, Tag, pinned, turning
from kindyna_gui.pictures.drawing.geometry import Joint, Reading
from kindyna_gui.pictures.drawing.shapes import arc_arrow, at, bearing, circle, cross, joined, segments
from kindyna_gui.pictures.style import CHAIN, DOTTED, OUTLINE, SPARSE, THIN, Theme, brush

Z_CAM, Z_CURVES, Z_SHAFT, Z_NORMAL = 2.0, 2.5, 3.5, 8.0
ARROW_START, ARROW_SPAN = 200.0, 80.0  # of the arrow of rotation, deg


def cam(reading: Reading, theme: Theme) -> Iterator[Part]:
    """All that turns with the camshaft, and the shaft in its bearing."""
    if not reading.with_cam:
        return
    if reading.profile.size:
        item = Loop(reading.profile, theme.pen(theme.cam_line, OUTLINE), brush(theme.cam))
        yield Part("cam", item, ("cam",), Z_CAM, turning(item, reading.turned))
        yield from _zero_mark(reading, theme)
        pitch = Loop(reading.pitch, theme.pen(theme.quiet, THIN, CHAIN))
        yield Part("pitch", pitch, ("pitch",), Z_CURVES, turning(pitch, reading.turned))
    yield Part(
        "base", Outline(circle(reading.base_radius), theme.pen(theme.cam_line, THIN, DOTTED)), ("base",), Z_CURVES
    )
    yield from _shaft(reading, theme)


def _zero_mark(reading: Reading, theme: Theme) -> Iterator[Part]:
    """A radial tick up to where the cam's own +x leaves the outline."""
    edge, inner = edge_radius(reading.profile), 0.76 * reading.bearing_room
    tick = Outline(segments([(inner + 0j, edge + 0j)]), theme.pen(theme.cam_line, THIN))
    yield Part("zero", tick, ("cam",), Z_CURVES, turning(tick, reading.turned))
    tag = Tag("0°", theme.cam_line, theme)
    track = inner * np.exp(1j * np.deg2rad(reading.turned))
    yield Part("zero.text", tag, ("cam", "labels"), Z_CURVES, _inwards(tag, track))


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


def shaft_radius(reading: Reading) -> float:
    """Of the camshaft's bearing [mm]."""
    return min(2.0 * reading.unit, 0.3 * reading.bearing_room)


def sense_arc(reading: Reading) -> tuple[float, float, float]:
    """The arrow that tells the sense of rotation: radius [mm], start and span [deg]."""
    radius = max(1.6 * shaft_radius(reading), 0.5 * reading.bearing_room)
    start = ARROW_START if reading.sense > 0 else ARROW_START + ARROW_SPAN
    return radius, start, reading.sense * ARROW_SPAN


def _shaft(reading: Reading, theme: Theme) -> Iterator[Part]:
    outer = shaft_radius(reading)
    bush, lines, shaft = bearing(0.55 * outer, outer)
    yield Part("shaft.bush", Outline(bush, theme.pen(theme.ink, THIN), brush(theme.paper)), ("ground",), Z_SHAFT)
    yield Part("shaft.hatching", Outline(lines, theme.pen(theme.quiet, THIN)), ("ground",), Z_SHAFT + 0.1)
    yield Part("shaft", Outline(shaft, theme.pen(theme.ink, THIN), brush(theme.shaft)), ("cam",), Z_SHAFT + 0.2)
    radius, start, span = sense_arc(reading)
    line, head = arc_arrow(radius, start, span, min(1.6 * reading.unit, 0.3 * radius))
    yield Part("sense", Outline(line, theme.pen(theme.cam_line, THIN)), ("cam",), Z_SHAFT)
    yield Part("sense.head", Outline(head, theme.pen(theme.cam_line, THIN), brush(theme.cam_line)), ("cam",), Z_SHAFT)


def contact(reading: Reading, theme: Theme) -> Iterator[Part]:
    """The common normal from the contact through the roller's centre to the instant centre, which lies on it."""
    if reading.shape is None:
        return
    line = QGraphicsLineItem()
    line.setPen(theme.pen(theme.quiet, THIN))
    yield Part("normal", line, ("normal",), Z_NORMAL, _normal_move(line, reading))
    dot = Outline(circle(0.35 * reading.unit), theme.pen(theme.ink, THIN), brush(theme.ink))
    yield Part("contact", dot, ("normal",), Z_NORMAL + 0.1, pinned(dot, reading.contact))
    size = 0.8 * reading.unit
    mark = Outline(joined(cross(1.5 * size), circle(0.55 * size)), theme.pen(theme.limit, OUTLINE))
    yield Part("centre", mark, ("centre",), Z_NORMAL + 2.0, pinned(mark, _within_reach(reading)))
    ground = next((j for j in reading.joints if j.name == reading.kinematics.ground), None)
    if ground is None:  # the roller's link is held by no pair of its own: the line turns with its pole
        return
    ends = CENTRE_LINES[ground.pair.kind](ground, reading)
    yield Part(
        "centre.line", Outline(segments([ends]), theme.pen(theme.quiet, THIN, SPARSE)), ("centre",), Z_NORMAL - 0.5
    )


def _reach(reading: Reading) -> float:
    low, high = reading.core_box
    return 4.0 * abs(high - low)


def _within_reach(reading: Reading) -> np.ndarray:
    """The instant centre (n,) [mm], infinite also where it is too far to be drawn."""
    q = reading.centre
    near = np.abs(np.where(np.isfinite(q), q, 0.0)) < 10.0 * _reach(reading)
    return np.where(np.isfinite(q) & near, q, complex(np.inf, np.inf))


def _normal_move(line: QGraphicsLineItem, reading: Reading) -> Callable[[int], None]:
    assert reading.shape is not None
    normal, start = reading.shape.flank.normal, reading.reference
    with np.errstate(invalid="ignore"):
        along = ((reading.centre - start) * normal.conjugate()).real
    finite, reach = np.isfinite(along), _reach(reading)
    overshoot = 2.0 * reading.unit
    along = np.clip(np.where(finite, along, 0.0), -reach, reach)
    low = np.where(finite, np.minimum(along, -overshoot), -reach)
    high = np.where(finite, np.maximum(along, reading.face_radius), reach)
    one, other = start + low * normal, start + high * normal

    def move(i: int) -> None:
        line.setLine(QLineF(at(one[i]), at(other[i])))

    return move


def _line_of_centres(ground: Joint, reading: Reading) -> tuple[complex, complex]:
    return 0j, complex(ground.track[0])


def _across_the_guide(ground: Joint, reading: Reading) -> tuple[complex, complex]:
    reach = float(np.abs(reading.near_centres).max(initial=0.0)) + 6.0 * reading.unit
    return -1j * reach * ground.line, 1j * reach * ground.line


CENTRE_LINES: Mapping[str, Callable[[Joint, Reading], tuple[complex, complex]]] = MappingProxyType(
    {REVOLUTE: _line_of_centres, SLIDING: _across_the_guide}
)
"""The line on which the instant centre stays (Kennedy), by the kind of pair that holds the follower."""
