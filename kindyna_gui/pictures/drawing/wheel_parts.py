"""Wheels of second inputs: pitch circles that touch, or two pulleys with their belt, each with a mark that turns."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from PySide6.QtGui import QPainterPath

from core.design.linkage import BELT, RACK
from core.mechanism import body_name
from core.mechanism.drivers import Wheel, WheelPair
from kindyna_gui.pictures.drawing.geometry import Geometry
from kindyna_gui.pictures.items import DrawnPart, Outline, riding
from kindyna_gui.pictures.shapes import at, circle
from kindyna_gui.pictures.style import CHAIN, OUTLINE, THIN, Theme

Z_WHEELS = 0.6


def wheels(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Of a linkage with wheels whose radii are known."""
    for number, pair in enumerate(geometry.wheels, 1):
        for name, wheel in zip(("first", "second"), pair.circles, strict=False):
            body = geometry.bodies[body_name(wheel.link)]
            item = Outline(_wheel(wheel, body.points[wheel.point]), theme.pen(theme.ink, THIN, CHAIN))
            key = f"wheel{number}.{name}"
            yield DrawnPart(key, item, ("linkage",), Z_WHEELS, riding(item, body.z, body.angle))
        if pair.kind == RACK:
            rack = geometry.bodies[body_name(pair.second.link)]
            item = Outline(_rack(pair, geometry), theme.pen(theme.ink, THIN, CHAIN))
            yield DrawnPart(f"wheel{number}.rack", item, ("linkage",), Z_WHEELS, riding(item, rack.z, rack.angle))
        if pair.kind == BELT:
            carrier = geometry.bodies[body_name(pair.carrier)]
            item = Outline(_belt(pair, geometry), theme.pen(theme.ink, OUTLINE))
            yield DrawnPart(f"wheel{number}.belt", item, ("linkage",), Z_WHEELS, riding(item, carrier.z, carrier.angle))


def _wheel(wheel: Wheel, centre: complex) -> QPainterPath:
    """The pitch circle, and a mark from its centre to it, along the link's x axis."""
    path = circle(wheel.radius, centre)
    path.moveTo(at(centre))
    path.lineTo(at(centre + wheel.radius))
    return path


def _belt(pair: WheelPair, geometry: Geometry) -> QPainterPath:
    """Both straight parts of an open belt, in the frame of the link that carries the wheels."""
    carrier = geometry.bodies[body_name(pair.carrier)]
    turned = np.exp(-1j * np.deg2rad(carrier.angle[0]))
    one, other = (
        complex((geometry.centre_of(wheel)[0] - carrier.z[0]) * turned) for wheel in (pair.first, pair.second)
    )
    way = other - one
    lean = (pair.first.radius - pair.second.radius) / abs(way)
    path = QPainterPath()
    for side in (1.0, -1.0):
        across = way / abs(way) * (lean + 1j * side * np.sqrt(max(1.0 - lean * lean, 0.0)))
        path.moveTo(at(one + pair.first.radius * across))
        path.lineTo(at(other + pair.second.radius * across))
    return path


def _rack(pair: WheelPair, geometry: Geometry) -> QPainterPath:
    """The pitch line of a rack in its own frame, as far as its pinion rolls on it and half a radius more, and a mark where it begins."""
    carrier, rack = (geometry.bodies[body_name(n)] for n in (pair.carrier, pair.second.link))
    along = pair.along * carrier.turn
    touching = geometry.centre_of(pair.first) - 1j * along * pair.first.radius
    turned = rack.turn.conj()
    local, way = (touching - rack.z) * turned, complex((along * turned).flat[0])
    places = (local * way.conjugate()).real
    base = 1j * way * float((local * way.conjugate()).imag.flat[0])
    ends = [base + way * s for s in (places.min() - 0.5 * pair.first.radius, places.max() + 0.5 * pair.first.radius)]
    path = QPainterPath()
    path.moveTo(at(ends[0] - 1j * way * 0.2 * pair.first.radius))
    path.lineTo(at(ends[0]))
    path.lineTo(at(ends[1]))
    return path


__all__ = ["wheels"]
