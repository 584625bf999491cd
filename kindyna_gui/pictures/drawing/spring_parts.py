"""Springs and dampers: between points along the line of their ends, as long as these are apart; at pins as a spiral that winds; the
closing spring of a follower behind it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from PySide6.QtGui import QPainterPath, QPen, QTransform

from core.dynamics import Element, OutputForce, Spring, Torsion
from core.mechanism.kinematics import REVOLUTE, SLIDING
from kindyna_gui.pictures.drawing.geometry import MM, Geometry, Joint
from kindyna_gui.pictures.drawing.parts import BLOCK_LENGTH, behind_face, bush_start, is_stem
from kindyna_gui.pictures.items import DrawnPart, Outline
from kindyna_gui.pictures.shapes import HATCH, circle, hatching, joined, polyline, scaled, segments
from kindyna_gui.pictures.style import DASHED, OUTLINE, THIN, Theme

COILS = 11
HALF_WIDTH, APART = 1.3, 2.0  # of a spring; of spring and damper from their common line, in units
START, END = 0.2, 0.8  # of the length: what of it is coiled
Z_SPRING, Z_SPIRAL = 8.0, 8.5


LAYER = ("loads",)
INNER, OUTER, TURNS, POINTS = 1.3, 3.1, 2.0, 64  # of a spiral: radii in units, windings at rest, points of its line
AROUND, FEW = 1.35, 6  # of the coils around a stem: half width, in parts of those of other springs, and number
BEYOND = 8.0  # from the farthest place of a block to the wall that its spring stands on, in units
WALL, DEEP = 2.6, 0.9  # half the width of that wall and the depth of its hatching, in units


def spring(element: Spring, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Coils where it has a rate, a piston in its cylinder where it damps; a dashed tick where its end stands without force."""
    one, other = (MM * end for end in element.ends(geometry.kinematics))
    path = symbol(bool(element.rate), bool(element.damping), geometry.unit)
    yield _stretched(f"spring.{element.name}", path, one, other, theme)
    if element.rate and element.length:
        size = np.abs(other - one)
        along = (other - one) / np.where(size > 0.0, size, 1.0)
        path = segments([(0j, 1 + 0j), (1 - 1.6j * geometry.unit, 1 + 1.6j * geometry.unit)])
        free = one + along * element.length * MM
        yield _stretched(f"free.{element.name}", path, other, free, theme, theme.pen(theme.quiet, THIN, DASHED))


def _stretched(
    key: str, path: QPainterPath, one: np.ndarray, other: np.ndarray, theme: Theme, line: QPen | None = None
) -> DrawnPart:
    """A symbol from (0, 0) to (1, 0), widths in mm, along the line of its ends (n,), as wide as ever."""
    item = Outline(path, theme.pen(theme.ink, OUTLINE) if line is None else line)
    along = other - one

    def move(i: int) -> None:
        x, y, size = along.real[i], along.imag[i], abs(along[i]) or 1.0
        item.setTransform(QTransform(x, y, -y / size, x / size, one.real[i], one.imag[i]))

    return DrawnPart(key, item, LAYER, Z_SPRING, move)


def torsion(element: Torsion, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """A spiral about the pin of the two bodies, a dashed circle around it where it damps."""
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
    """Where the spiral of an element stands (n,) [mm], of one that has one."""
    if isinstance(element, Torsion):
        bodies = {element.body, element.on}
        pins = [j for j in geometry.joints if j.pair.kind == REVOLUTE and {j.pair.body, j.pair.on} == bodies]
        return [pins[0].track if pins else geometry.bodies[element.body].z]
    joint = next(joint for joint in geometry.joints if joint.name == geometry.kinematics.driver_name)
    wound = isinstance(element, OutputForce) and geometry.closes(element) and joint.pair.kind != SLIDING
    return [joint.track] if wound else []


def _spiral(
    name: str,
    track: np.ndarray,
    angle: np.ndarray,
    geometry: Geometry,
    theme: Theme,
    wound: bool = True,
    damped: bool = False,
) -> Iterator[DrawnPart]:
    """Wound by what the angle (n,) [rad] differs from the middle of its range."""
    middle, part = 0.5 * (float(angle.min()) + float(angle.max())), np.linspace(0.0, 1.0, POINTS)
    radius = geometry.unit * (INNER + (OUTER - INNER) * part)
    item = Outline(QPainterPath(), theme.pen(theme.ink, OUTLINE))

    def move(i: int) -> None:
        turned = 2.0 * np.pi * TURNS - (angle[i] - middle)
        item.redraw(polyline((track[i] + radius * np.exp(1j * (angle[i] + part * turned))).tolist()))

    if wound:
        yield DrawnPart(f"spring.{name}", item, LAYER, Z_SPIRAL, move)
    if damped:
        ring = Outline(circle((OUTER + 0.6) * geometry.unit), theme.pen(theme.ink, THIN, DASHED))
        yield DrawnPart(f"damper.{name}", ring, LAYER, Z_SPIRAL, lambda i: ring.setPos(track.real[i], track.imag[i]))


def closing(element: OutputForce, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """The spring that acts on the output along its motion: coils around the stem up to its bush, coils from a block to a wall behind
    it, a spiral at a pivot."""
    kinematics = geometry.kinematics
    joint = next(joint for joint in geometry.joints if joint.name == kinematics.driver_name)
    if joint.pair.kind != SLIDING:
        yield from _spiral(
            element.name, joint.track, np.deg2rad(geometry.bodies[kinematics.output].angle), geometry, theme
        )
        return
    unit, stem = geometry.unit, is_stem(joint, geometry)
    from_middle = float(np.mean(((joint.track - geometry.middle) * joint.line.conjugate()).real))
    outwards = joint.outwards if stem or not from_middle else float(np.sign(from_middle))
    line = joint.line * outwards
    near = behind_face(geometry, line) if stem else 0.5 * BLOCK_LENGTH * unit
    far = (
        bush_start(joint, geometry)
        if stem
        else max(outwards * joint.low, outwards * joint.high) / unit + 0.5 * BLOCK_LENGTH + BEYOND
    )
    end = joint.root + line * far * unit
    path = symbol(True, False, unit, AROUND if stem else 1.0, FEW if stem else COILS)
    yield _stretched(f"spring.{element.name}", path, joint.track + line * near, np.full(geometry.samples, end), theme)
    if not stem:
        yield from _wall(element.name, joint, geometry, theme, end, line)


def _wall(
    name: str, joint: Joint, geometry: Geometry, theme: Theme, end: complex, line: complex
) -> Iterator[DrawnPart]:
    wall = [(complex(0.0, -WALL), complex(0.0, WALL))]
    path = joined(segments(wall), hatching(1j * WALL, -1j * WALL, DEEP, HATCH))
    item = Outline(scaled(path, geometry.unit, end, line), theme.pen(theme.quiet, THIN))
    yield DrawnPart(f"ground.{name}", item, LAYER, Z_SPRING)


def symbol(coiled: bool, damped: bool, unit: float, wide: float = 1.0, coils: int = COILS) -> QPainterPath:
    """From (0, 0) to (1, 0), widths in mm; wide: of the coils, in parts of the usual."""
    beside = APART * unit if coiled and damped else 0.0
    parts = []
    if coiled:
        x = np.linspace(START, END, 2 * coils + 1)
        y = np.where(np.arange(x.size) % 2, 1.0, -1.0) * HALF_WIDTH * wide * unit
        y[0] = y[-1] = 0.0
        line = [
            complex(0.5 * START, 0.0),
            *(complex(a, b) for a, b in zip(x, y, strict=True)),
            complex(1.0 - 0.5 * START, 0.0),
        ]
        parts.append(polyline([z + 1j * beside for z in line]))
    if damped:
        half, low = 1j * HALF_WIDTH * unit, -1j * beside
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
    if beside:
        ends += [(x + 1j * beside, x - 1j * beside) for x in (0.5 * START, 1.0 - 0.5 * START)]
    return joined(*parts, segments(ends))
