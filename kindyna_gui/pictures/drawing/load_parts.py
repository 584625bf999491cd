"""Force elements in the drawing, one row for each class: springs and dampers, external forces and torques with their values; and the
centres of mass."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from types import MappingProxyType
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QPainterPath

from core.dynamics import (
    ForceOnBody,
    OutputForce,
    OutputFriction,
    PointForce,
    ScheduledForce,
    Spring,
    Torsion,
    acting_of,
    masses_of,
)
from core.errors import NoSolution
from kindyna_gui.pictures.drawing.geometry import MM, Geometry
from kindyna_gui.pictures.drawing.spring_parts import HALF_WIDTH, LAYER, OUTER, closing, spirals, spring, torsion
from kindyna_gui.pictures.items import Arrow, DrawnPart, Outline, Tag, pinned
from kindyna_gui.pictures.shapes import PIN, arc_arrow, circle, joined
from kindyna_gui.pictures.style import OUTLINE, SMALL, Theme, brush
from kindyna_gui.pictures.units import readable, short, with_unit

LONG, LEAST, HEAD = 9.0, 3.5, 2.0  # longest and shortest arrow of a load, and its head, in units
ARC, SPAN = 3.6, 250.0  # radius of a torque's arc in units, and how far it goes round [deg]
OFF = 2.9  # of an arrow that pulls, from where it acts, in units: clear of a block
DIGITS = 4
CENTRE = 1.15  # radius of a centre of mass, in units
Z_LOAD, Z_VALUE, Z_CENTRE = 9.5, 12.5, 9.2


def loads(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """All force elements."""
    for element in geometry.elements:
        yield from DRAWN[type(element)](element, geometry, theme)


def masses(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """The textbook's quartered circle at the centre of each body that has a mass, with the mass."""
    try:
        bodies = masses_of(geometry.study.loading)
    except NoSolution:
        return
    for body, inertia in bodies.items():
        if not inertia.mass:
            continue
        track = geometry.bodies[body].track(inertia.centre * MM)
        radius = CENTRE * geometry.unit
        rim = Outline(circle(radius), theme.pen(theme.ink, OUTLINE), brush(theme.paper))
        quarters = Outline(_quarters(radius), None, brush(theme.ink))
        quarters.setParentItem(rim)
        yield DrawnPart(f"mass.{body}", rim, ("masses",), Z_CENTRE, pinned(rim, track))
        tag = Tag(f"{short(inertia.mass, DIGITS)} kg", theme.ink, theme, SMALL, lean=(0.0, 1.0), backing=True)
        tag.shift(8.0, -6.0)
        yield DrawnPart(f"mass_value.{body}", tag, ("masses",), Z_VALUE, pinned(tag, track))


def same_loads(one: Geometry, other: Geometry, masses: bool) -> bool:
    """Whether what is drawn of the loads is the same; masses: with the centres of mass."""
    if (one.elements, one.external) != (other.elements, other.external):
        return False
    return not masses or one.study.design.drive.loads == other.study.design.drive.loads


def strokes(geometry: Geometry, shown: Callable[[str], bool]) -> list[tuple[np.ndarray, np.ndarray]]:
    """What names keep clear of, from (n,) to (n,) [mm]: the arrows of forces, springs at pins, centres of mass."""
    found: list[tuple[np.ndarray, np.ndarray]] = []
    unit = geometry.unit
    for element in geometry.elements if shown("loads") else ():
        if isinstance(element, PointForce | ScheduledForce | OutputForce):
            rows = acting_of(element, geometry.kinematics, geometry.study.omega)
            found += [_arrow(row, geometry)[1:] for row in rows if np.abs(row.force).any()]
        for track in spirals(element, geometry):
            corners = OUTER * unit * np.exp(2j * np.pi * np.arange(9) / 8)
            found += [(track + one, track + other) for one, other in pairwise(corners)]
    for _, one, other in geometry.springs if shown("loads") else ():
        along = other - one
        wide = HALF_WIDTH * unit * along * 1j / np.where(along == 0.0, 1.0, np.abs(along))
        found += [(one + beside, other + beside) for beside in (-wide, wide)]
    for body, inertia in masses_of(geometry.study.loading).items() if shown("masses") else ():
        if inertia.mass:
            track = geometry.bodies[body].track(inertia.centre * MM)
            found += [
                (track - 1.5 * unit, track + 1.5 * unit),
                (track + (1.0 + 1.6j) * unit, track + (6.0 + 1.6j) * unit),
            ]
    return found


def _quarters(radius: float) -> QPainterPath:
    """Two opposite quarters of a disc."""
    parts = []
    for start in (0.0, 180.0):
        path = QPainterPath(QPointF(0.0, 0.0))
        path.arcTo(QRectF(-radius, -radius, 2.0 * radius, 2.0 * radius), start, 90.0)
        path.closeSubpath()
        parts.append(path)
    return joined(*parts)


def _value(size: float, unit: str) -> str:
    rung = readable(unit, size)
    return with_unit(short(size / rung.size, DIGITS), rung.symbol)


def external(element: Any, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """A force as an arrow that ends where it acts, a torque as an arc about there; gone while it is nothing."""
    for row in acting_of(element, geometry.kinematics, geometry.study.omega):
        yield from _force(row, geometry, theme)
        yield from _torque(row, geometry, theme)


def _force(row: ForceOnBody, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    size, unit = np.abs(row.force), geometry.unit
    if not size.any():
        return
    along, tail, tip = _arrow(row, geometry)
    item = Arrow(theme.pen(theme.family("force"), OUTLINE), HEAD * unit)
    yield DrawnPart(
        f"load.{row.name}", item, LAYER, Z_LOAD, lambda i: item.point(complex(tail[i]), complex(tip[i] - tail[i]))
    )
    pulls = np.abs(tip - row.at * MM) > np.abs(tail - row.at * MM)
    yield _tag(f"load_value.{row.name}", size, "N", np.where(pulls, tip, tail), np.where(pulls, along, -along), theme)


def _arrow(row: ForceOnBody, geometry: Geometry) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Direction, start and end (n,) of the arrow of a force [mm]: it ends where the force acts, or starts there where it would lie
    across the mechanism."""
    size, unit = np.abs(row.force), geometry.unit
    along = row.force / np.where(size > 0.0, size, 1.0)
    length = np.where(size > 0.0, (LEAST + (LONG - LEAST) * size / float(size.max())) * unit, 0.0)
    at = row.at * MM
    pulls = float(np.mean(((at - geometry.middle) * along.conj()).real)) > 0.0
    start = at + along * (OFF * unit if pulls else -PIN * unit - length)
    return along, start, start + along * length


def _torque(row: ForceOnBody, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    size, unit = np.abs(row.couple), geometry.unit
    if not size.any():
        return
    colour = theme.family("torque")
    ways = {
        sign: joined(*arc_arrow(ARC * unit, 90.0 - sign * 0.5 * SPAN, sign * SPAN, 1.6 * unit)) for sign in (1.0, -1.0)
    }
    item = Outline(ways[1.0], theme.pen(colour, OUTLINE))
    track = row.at * MM
    shown = [1.0]

    def move(i: int) -> None:
        item.setOpacity(1.0 if size[i] else 0.0)
        item.setPos(QPointF(track.real[i], track.imag[i]))
        sign = -1.0 if row.couple[i] < 0.0 else 1.0
        if sign != shown[0]:
            shown[0] = sign
            item.redraw(ways[sign])

    yield DrawnPart(f"torque.{row.name}", item, LAYER, Z_LOAD, move)
    yield _tag(f"torque_value.{row.name}", size, "N·m", track + 1j * ARC * unit, np.full(size.size, 1j), theme)


def _tag(key: str, size: np.ndarray, unit: str, place: np.ndarray, away: np.ndarray, theme: Theme) -> DrawnPart:
    """The value (n,) beside a place (n,) [mm], on the side ``away`` (n,); the text of a force that stays is set once."""
    tag = Tag(_value(float(size[0]), unit), theme.ink, theme, SMALL, backing=True)

    def move(i: int) -> None:
        tag.setOpacity(1.0 if size[i] else 0.0)
        tag.set_text(_value(float(size[i]), unit))
        side = -1.0 if tag.sceneTransform().m11() < 0.0 else 1.0  # of a drive seen from its other end
        x, y = side * round(float(away[i].real), 2), round(float(away[i].imag), 2)
        tag.set_lean(0.5 - 0.5 * x, 0.5 + 0.5 * y)
        tag.shift(4.0 * float(np.sign(x)), -2.0 * float(np.sign(y)))
        tag.setPos(QPointF(place.real[i], place.imag[i]))

    return DrawnPart(key, tag, LAYER, Z_VALUE, move)


def output_force(element: OutputForce, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """The closing spring of a follower, and its external force."""
    if geometry.closes(element):
        yield from closing(element, geometry, theme)
    if geometry.external:
        yield from external(OutputForce(geometry.external, 0.0, element.sense, element.name), geometry, theme)


DRAWN: Mapping[type, Callable[[Any, Geometry, Theme], Iterator[DrawnPart]]] = MappingProxyType(
    {Spring: spring, Torsion: torsion, OutputForce: output_force, PointForce: external, ScheduledForce: external,
     OutputFriction: lambda *_: iter(())}
)  # fmt: skip
