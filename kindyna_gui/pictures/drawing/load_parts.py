"""Drawing of the loads: springs, dampers, forces, torques and centres of mass.

Symbols are sized in units of the geometry; arrows grow with the force.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from types import MappingProxyType
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QPainterPath, QPen, QTransform

from core.dynamics import (
    Element,
    ForceOnBody,
    OutputForce,
    OutputFriction,
    PointForce,
    ScheduledForce,
    Spring,
    Torsion,
    element_forces,
)
from core.mechanism.kinematics import REVOLUTE, SLIDING
from kindyna_gui.pictures.drawing.geometry import MM, Geometry, Joint
from kindyna_gui.pictures.drawing.parts import BLOCK_LENGTH, behind_face, bush_start, is_stem
from kindyna_gui.pictures.items import Arrow, DrawnPart, Outline, Tag, pinned
from kindyna_gui.pictures.shapes import HATCH, PIN, arc_arrow, circle, hatching, joined, polyline, scaled, segments
from kindyna_gui.pictures.style import DASHED, OUTLINE, SMALL, THIN, Theme, brush
from kindyna_gui.pictures.units import readable_text, short

# -- springs and dampers -------------------------------------------------------------------------------

LAYER = ("loads",)
COILS = 11
HALF_WIDTH, OFFSET = 1.3, 2.0  # half width of a spring; offset of spring and damper from their common line, in units
START, END = 0.2, 0.8  # range of the coils, as fractions of the length
INNER, OUTER, TURNS, POINTS = 1.3, 3.1, 2.0, 64  # spiral: radii in units, turns at rest, points of the line
STEM_WIDTH, STEM_COILS = 1.35, 6  # coils around a stem: half width by that of other springs, and number
BEYOND = 8.0  # from the farthest position of a block to the wall behind its spring, in units
WALL, DEEP = 2.6, 0.9  # half the width of that wall, and the depth of its hatching, in units
Z_SPRING, Z_SPIRAL = 8.0, 8.5


def spring(element: Spring, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Coils for a spring rate, a piston in a cylinder for damping, and a dashed tick at the free length."""
    start, end = (MM * point for point in element.ends(geometry.kinematics))
    path = spring_symbol(bool(element.rate), bool(element.damping), geometry.unit)
    yield _stretched(f"spring.{element.name}", path, start, end, theme)
    if element.rate and element.length:
        size = np.abs(end - start)
        along = (end - start) / np.where(size > 0.0, size, 1.0)
        path = segments([(0j, 1 + 0j), (1 - 1.6j * geometry.unit, 1 + 1.6j * geometry.unit)])
        free = start + along * element.length * MM
        yield _stretched(f"free.{element.name}", path, end, free, theme, theme.pen(theme.quiet, THIN, DASHED))


def _stretched(
    key: str, path: QPainterPath, start: np.ndarray, end: np.ndarray, theme: Theme, line: QPen | None = None
) -> DrawnPart:
    """Stretch a symbol from (0, 0) to (1, 0), with widths in mm, between two paths (n,) [mm] at constant width."""
    item = Outline(path, theme.pen(theme.ink, OUTLINE) if line is None else line)
    along = end - start

    def move(i: int) -> None:
        x, y, size = along.real[i], along.imag[i], abs(along[i]) or 1.0
        item.setTransform(QTransform(x, y, -y / size, x / size, start.real[i], start.imag[i]))

    return DrawnPart(key, item, LAYER, Z_SPRING, move)


def torsion(element: Torsion, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Spiral about the pin of two bodies, with a dashed circle for damping."""
    (track,) = spirals(element, geometry)
    yield from _spiral(
        element.name,
        track,
        element.angle(geometry.kinematics),
        geometry,
        theme,
        bool(element.rate),
        bool(element.damping),
    )


def spirals(element: Element, geometry: Geometry) -> list[np.ndarray]:
    """Paths of the centres (n,) [mm] of the spirals of an element; empty where it has none."""
    if isinstance(element, Torsion):
        bodies = {element.body, element.on}
        pins = [j for j in geometry.joints if j.pair.kind == REVOLUTE and {j.pair.body, j.pair.on} == bodies]
        return [pins[0].track if pins else geometry.bodies[element.body].z]
    if not isinstance(element, OutputForce):
        return []
    joint = _sprung_joint(element, geometry)
    return [joint.track] if geometry.is_closing_spring(element) and joint.pair.kind != SLIDING else []


def _sprung_joint(element: OutputForce, geometry: Geometry) -> Joint:
    """The joint along which a closing spring acts."""
    name = element.pair or geometry.kinematics.driver_name
    return next(joint for joint in geometry.joints if joint.name == name)


def _spiral(
    name: str,
    track: np.ndarray,
    angle: np.ndarray,
    geometry: Geometry,
    theme: Theme,
    has_rate: bool = True,
    has_damping: bool = False,
) -> Iterator[DrawnPart]:
    """Spiral that is wound by the deviation of the angle (n,) [rad] from the middle of its range."""
    middle, part = 0.5 * (float(angle.min()) + float(angle.max())), np.linspace(0.0, 1.0, POINTS)
    radius = geometry.unit * (INNER + (OUTER - INNER) * part)
    item = Outline(QPainterPath(), theme.pen(theme.ink, OUTLINE))

    def move(i: int) -> None:
        rotation = 2.0 * np.pi * TURNS - (angle[i] - middle)
        item.redraw(polyline((track[i] + radius * np.exp(1j * (angle[i] + part * rotation))).tolist()))

    if has_rate:
        yield DrawnPart(f"spring.{name}", item, LAYER, Z_SPIRAL, move)
    if has_damping:
        ring = Outline(circle((OUTER + 0.6) * geometry.unit), theme.pen(theme.ink, THIN, DASHED))
        yield DrawnPart(f"damper.{name}", ring, LAYER, Z_SPIRAL, lambda i: ring.setPos(track.real[i], track.imag[i]))


def closing_spring(element: OutputForce, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Spring that holds the follower on the cam: coils on a stem, coils behind a block, or a spiral at a pivot."""
    kinematics = geometry.kinematics
    joint = _sprung_joint(element, geometry)
    if joint.pair.kind != SLIDING:
        yield from _spiral(
            element.name, joint.track, np.deg2rad(geometry.bodies[kinematics.output].angle), geometry, theme
        )
        return
    unit, stem = geometry.unit, is_stem(joint, geometry)
    offset = float(np.mean(((joint.track - geometry.middle) * joint.line.conjugate()).real))
    is_preloaded = hasattr(geometry.study.design.drive.loads, "preload_n")  # a spring that a positive motion compresses
    sign = joint.outward_sign if stem or not offset else 1.0 if is_preloaded else float(np.sign(offset))
    line = joint.line * sign
    if stem:
        near, far = behind_face(geometry, line), bush_start(joint, geometry)
    else:
        near = 0.5 * BLOCK_LENGTH * unit
        far = max(sign * joint.low, sign * joint.high) / unit + 0.5 * BLOCK_LENGTH + BEYOND
    end = joint.root + line * far * unit
    path = spring_symbol(True, False, unit, STEM_WIDTH if stem else 1.0, STEM_COILS if stem else COILS)
    yield _stretched(f"spring.{element.name}", path, joint.track + line * near, np.full(geometry.samples, end), theme)
    if not stem:
        wall = [(complex(0.0, -WALL), complex(0.0, WALL))]
        path = joined(segments(wall), hatching(1j * WALL, -1j * WALL, DEEP, HATCH))
        item = Outline(scaled(path, unit, end, line), theme.pen(theme.quiet, THIN))
        yield DrawnPart(f"ground.{element.name}", item, LAYER, Z_SPRING)


def spring_symbol(coiled: bool, damped: bool, unit: float, width: float = 1.0, coils: int = COILS) -> QPainterPath:
    """Spring, damper, or both side by side, from (0, 0) to (1, 0), with widths in mm; ``width`` scales the coils."""
    offset = OFFSET * unit if coiled and damped else 0.0
    parts = []
    if coiled:
        x = np.linspace(START, END, 2 * coils + 1)
        y = np.where(np.arange(x.size) % 2, 1.0, -1.0) * HALF_WIDTH * width * unit
        y[0] = y[-1] = 0.0
        line = [
            complex(0.5 * START, 0.0),
            *(complex(a, b) for a, b in zip(x, y, strict=True)),
            complex(1.0 - 0.5 * START, 0.0),
        ]
        parts.append(polyline([z + 1j * offset for z in line]))
    if damped:
        half, low = 1j * HALF_WIDTH * unit, -1j * offset
        cup = [0.65 + half, 0.4 + half, 0.4 - half, 0.65 - half]
        parts += [
            polyline([z + low for z in cup]),
            segments(
                [
                    (0.5 * START + low, 0.4 + low),
                    (0.55 + 0.7 * half + low, 0.55 - 0.7 * half + low),
                    (0.55 + low, 0.9 + low),
                ]
            ),
        ]
    ends = [(0j, complex(0.5 * START)), (complex(1.0 - 0.5 * START), 1.0 + 0j)]
    if offset:
        ends += [(x + 1j * offset, x - 1j * offset) for x in (0.5 * START, 1.0 - 0.5 * START)]
    return joined(*parts, segments(ends))


# -- forces, torques and masses ------------------------------------------------------------------------

LONGEST, SHORTEST, ARROW_HEAD = 9.0, 3.5, 2.0  # longest and shortest arrow of a load, and its head, in units
ARC, SPAN = 3.6, 250.0  # radius of a torque's arc in units, and its span [deg]
PULL_GAP = 2.9  # from a point to an arrow that pulls at it, clear of a block, in units
DIGITS = 4
CENTRE = 1.15  # radius of a centre of mass, in units
Z_LOAD, Z_VALUE, Z_CENTRE = 9.5, 12.5, 9.2


def loads(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """All force elements but the masses."""
    for element in geometry.elements:
        yield from LOAD_PARTS[type(element)](element, geometry, theme)


def masses(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Quartered circle at the centre of mass of each body, with the mass."""
    for body, inertia in geometry.inertias.items():
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


def has_same_loads(first: Geometry, second: Geometry, masses: bool) -> bool:
    """Whether two geometries have the same drawing of the loads; ``masses`` includes the centres of mass."""
    if (first.elements, first.external) != (second.elements, second.external):
        return False
    return not masses or first.study.design.drive.loads == second.study.design.drive.loads


def load_strokes(geometry: Geometry, shown: Callable[[str], bool]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Strokes from (n,) to (n,) [mm] that labels avoid: arrows of forces, springs and centres of mass."""
    strokes: list[tuple[np.ndarray, np.ndarray]] = []
    unit = geometry.unit
    for element in geometry.elements if shown("loads") else ():
        if isinstance(element, PointForce | ScheduledForce | OutputForce):
            rows = element_forces(element, geometry.kinematics, geometry.study.omega)
            strokes += [_arrow(row, geometry)[1:] for row in rows if np.abs(row.force).any()]
        for track in spirals(element, geometry):
            corners = OUTER * unit * np.exp(2j * np.pi * np.arange(9) / 8)
            strokes += [(track + start, track + end) for start, end in pairwise(corners)]
    for _, start, end in geometry.springs if shown("loads") else ():
        along = end - start
        half_width = HALF_WIDTH * unit * along * 1j / np.where(along == 0.0, 1.0, np.abs(along))
        strokes += [(start + offset, end + offset) for offset in (-half_width, half_width)]
    for body, inertia in geometry.inertias.items() if shown("masses") else ():
        if inertia.mass:
            track = geometry.bodies[body].track(inertia.centre * MM)
            strokes += [
                (track - 1.5 * unit, track + 1.5 * unit),
                (track + (1.0 + 1.6j) * unit, track + (6.0 + 1.6j) * unit),
            ]
    return strokes


def _quarters(radius: float) -> QPainterPath:
    """Two opposite quarters of a disc."""
    parts = []
    for start in (0.0, 180.0):
        path = QPainterPath(QPointF(0.0, 0.0))
        path.arcTo(QRectF(-radius, -radius, 2.0 * radius, 2.0 * radius), start, 90.0)
        path.closeSubpath()
        parts.append(path)
    return joined(*parts)


def external(element: Any, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Forces as arrows at their points, torques as arcs about them; hidden while they are zero."""
    for row in element_forces(element, geometry.kinematics, geometry.study.omega):
        yield from _force(row, geometry, theme)
        yield from _torque(row, geometry, theme)


def _force(row: ForceOnBody, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    size, unit = np.abs(row.force), geometry.unit
    if not size.any():
        return
    along, tail, tip = _arrow(row, geometry)
    item = Arrow(theme.pen(theme.family("force"), OUTLINE), ARROW_HEAD * unit)
    yield DrawnPart(
        f"load.{row.name}", item, LAYER, Z_LOAD, lambda i: item.point(complex(tail[i]), complex(tip[i] - tail[i]))
    )
    pulls = np.abs(tip - row.at * MM) > np.abs(tail - row.at * MM)
    yield _tag(f"load_value.{row.name}", size, "N", np.where(pulls, tip, tail), np.where(pulls, along, -along), theme)


def _arrow(row: ForceOnBody, geometry: Geometry) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Direction, start and end (n,) of the arrow of a force [mm].

    The arrow ends at the point of the force, or starts there where it would cross the mechanism.
    """
    size, unit = np.abs(row.force), geometry.unit
    along = row.force / np.where(size > 0.0, size, 1.0)
    length = np.where(size > 0.0, (SHORTEST + (LONGEST - SHORTEST) * size / float(size.max())) * unit, 0.0)
    at = row.at * MM
    pulls = float(np.mean(((at - geometry.middle) * along.conj()).real)) > 0.0
    start = at + along * (PULL_GAP * unit if pulls else -PIN * unit - length)
    return along, start, start + along * length


def _torque(row: ForceOnBody, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    size, unit = np.abs(row.couple), geometry.unit
    if not size.any():
        return
    colour = theme.family("torque")
    arcs = {
        sign: joined(*arc_arrow(ARC * unit, 90.0 - sign * 0.5 * SPAN, sign * SPAN, 1.6 * unit)) for sign in (1.0, -1.0)
    }
    item = Outline(arcs[1.0], theme.pen(colour, OUTLINE))
    track = row.at * MM
    shown = [1.0]

    def move(i: int) -> None:
        item.setOpacity(1.0 if size[i] else 0.0)
        item.setPos(QPointF(track.real[i], track.imag[i]))
        sign = -1.0 if row.couple[i] < 0.0 else 1.0
        if sign != shown[0]:
            shown[0] = sign
            item.redraw(arcs[sign])

    yield DrawnPart(f"torque.{row.name}", item, LAYER, Z_LOAD, move)
    yield _tag(f"torque_value.{row.name}", size, "N·m", track + 1j * ARC * unit, np.full(size.size, 1j), theme)


def _tag(key: str, size: np.ndarray, unit: str, track: np.ndarray, away: np.ndarray, theme: Theme) -> DrawnPart:
    """A value (n,) next to a path (n,) [mm], on the side ``away`` (n,)."""
    tag = Tag(readable_text(float(size[0]), unit), theme.ink, theme, SMALL, backing=True)

    def move(i: int) -> None:
        tag.setOpacity(1.0 if size[i] else 0.0)
        tag.set_text(readable_text(float(size[i]), unit))
        side = -1.0 if tag.sceneTransform().m11() < 0.0 else 1.0  # -1 for a drive seen from its other end
        x, y = side * round(float(away[i].real), 2), round(float(away[i].imag), 2)
        tag.set_lean(0.5 - 0.5 * x, 0.5 + 0.5 * y)
        tag.shift(4.0 * float(np.sign(x)), -2.0 * float(np.sign(y)))
        tag.setPos(QPointF(track.real[i], track.imag[i]))

    return DrawnPart(key, tag, LAYER, Z_VALUE, move)


def output_force(element: OutputForce, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Spring that holds the follower on the cam, and the external force on the output."""
    if geometry.is_closing_spring(element):
        yield from closing_spring(element, geometry, theme)
    if geometry.external:
        yield from external(OutputForce(geometry.external, 0.0, element.sign, element.name), geometry, theme)


LOAD_PARTS: Mapping[type, Callable[[Any, Geometry, Theme], Iterator[DrawnPart]]] = MappingProxyType(
    {Spring: spring, Torsion: torsion, OutputForce: output_force, PointForce: external, ScheduledForce: external,
     OutputFriction: lambda *_: iter(())}
)  # fmt: skip
