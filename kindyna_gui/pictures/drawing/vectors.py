"""Velocities and forces as arrows, to one scale over the whole turn."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from core.dynamics import BEARING, CONTACT, OF_MASSES, REACTION, SPRING, ForceOnBody
from core.errors import NoSolution
from core.frozen import frozen
from core.mechanism.kinematics import CAM
from kindyna_gui.pictures.drawing.cam_parts import centre_within_reach
from kindyna_gui.pictures.drawing.geometry import MM, Geometry
from kindyna_gui.pictures.items import Arrow, DrawnPart, Move
from kindyna_gui.pictures.style import DASHED, OUTLINE, Theme

LONGEST, HEAD = 16.0, 1.8  # longest arrow and its head, in units
Z_ARROW = 11.0
NO_VECTOR = 1e-9  # a vector below this part of the largest is no vector


@frozen(eq=False)
class Field:
    """Vectors at moving places, in SI.

    rows   key, place (n,) [mm], vector (n,) [SI]
    peak   what the scale is made for [SI]: of several fields to one scale the largest of all; 0: of these vectors
    """

    family: str
    unit: str
    rows: tuple[tuple[str, np.ndarray, np.ndarray], ...]
    peak: float = 0.0

    @property
    def largest(self) -> float:
        """Size of the largest vector that is not near infinity [SI]."""
        sizes = [np.abs(vector[np.isfinite(vector)]) for _, _, vector in self.rows]
        finite = np.concatenate(sizes) if sizes else np.zeros(0)
        if not finite.size:
            return 0.0
        top, usual = float(finite.max()), float(np.percentile(finite, 98.0))
        return top if top < 20.0 * usual or usual == 0.0 else usual

    def mm_per_unit(self, geometry: Geometry) -> float:
        """Length of an arrow [mm] for one unit (SI)."""
        peak = self.peak or self.largest
        return LONGEST * geometry.unit / peak if peak > 0.0 else 0.0


def velocities(geometry: Geometry) -> Field:
    """Velocity of every point of every body that moves; points that stay together count once. Of a cam's follower also V_Q = Q θ̇ of the
    instant centre (Shin1995 (15)), which may move far away: the scale is made for the others."""
    rows: list[tuple[str, np.ndarray, np.ndarray]] = []
    for name, pose in geometry.kinematics.bodies.items():
        for point in geometry.bodies[name].nodes:
            track = pose.point(point)
            place, speed = track[0] * MM, track[1] * geometry.study.omega
            if not any(np.abs(place - other).max() <= NO_VECTOR * geometry.unit for _, other, _ in rows):
                rows.append((f"{name}.{point}", place, speed))
    field = _moving(Field("velocity", "m/s", tuple(rows)))
    if geometry.shape is None:
        return field
    q = centre_within_reach(geometry)
    q = np.where(np.isfinite(q), q, 0.0)
    turning = 1j * geometry.study.sense * geometry.study.omega * q / MM
    return _moving(replace(field, rows=(*field.rows, ("centre", q, turning)), peak=field.largest))


def forces(geometry: Geometry) -> Field:
    """What pairs and cam answer with, friction, springs and other loads; to the scale of all that acts."""
    return _acting(geometry, lambda row: row.kind not in OF_MASSES)


def inertia(geometry: Geometry) -> Field:
    """Weight and inertia force of every body, at its centre of mass; to the same scale."""
    return _acting(geometry, lambda row: row.kind in OF_MASSES)


def _acting(geometry: Geometry, wanted: Callable[[ForceOnBody], bool]) -> Field:
    """Those forces on the bodies that are wanted: of a pair by ``on`` on ``body``, of the cam on the follower."""
    try:
        bodies = geometry.study.free_bodies
    except NoSolution:
        return Field("force", "N", ())
    pairs = geometry.kinematics.pairs
    carried = {name: pair.body if pair.body in bodies else pair.on for name, pair in pairs.items()}
    rows = [
        (row, (_key(row, geometry), row.at * MM, row.force))
        for body, acting in bodies.items()
        for row in acting
        if (carried[row.name] == body if row.name in carried else body != CAM or row.name == BEARING)
    ]
    peak = Field("force", "N", tuple(drawn for _, drawn in rows)).largest
    return _moving(Field("force", "N", tuple(drawn for row, drawn in rows if wanted(row)), peak))


def _key(row: ForceOnBody, geometry: Geometry) -> str:
    """A pair's name for its reaction; else the kind and whose it is, of the first flank the kind alone."""
    shape = geometry.shape
    if row.kind == REACTION:
        return row.name
    if shape is not None and row.kind == CONTACT and row.name == shape.flank.name:
        return row.kind
    return f"{row.kind}.{row.name}" + (f".{row.body}" if row.kind == SPRING else "")


def _moving(field: Field) -> Field:
    """Without the vectors that stay zero; infinite ones, which have no arrow, become zero."""
    rows = tuple((key, place, np.where(np.isfinite(v), v, 0.0)) for key, place, v in field.rows)
    least = NO_VECTOR * (field.peak or field.largest)
    return replace(field, rows=tuple(row for row in rows if np.abs(row[2]).max(initial=0.0) > least))


def arrows(field: Field, layer: str, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """One arrow for each row."""
    scale = field.mm_per_unit(geometry)
    for key, place, vector in field.rows:
        dash = DASHED if layer == "inertia" else ()
        item = Arrow(theme.pen(theme.family(field.family), OUTLINE, dash), HEAD * geometry.unit)
        yield DrawnPart(f"{layer}.{key}", item, (layer,), Z_ARROW, _follow(item, place, vector * scale))


def _follow(item: Arrow, place: np.ndarray, vector: np.ndarray) -> Move:
    return lambda i: item.point(complex(place[i]), complex(vector[i]))


FIELDS: Mapping[str, Callable[[Geometry], Field]] = MappingProxyType(
    {"velocities": velocities, "forces": forces, "inertia": inertia}
)
"""Layers of vectors, computed when first shown."""


def strokes(field: Field, geometry: Geometry) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Where arrows start and end (n,), (n,) [mm]."""
    scale = field.mm_per_unit(geometry)
    for _, place, vector in field.rows:
        yield place, place + vector * scale
