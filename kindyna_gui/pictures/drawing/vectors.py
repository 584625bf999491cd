"""Velocities and forces as arrows, to one scale over the whole turn."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from core.errors import NoAnswer
from core.frozen import frozen
from kindyna_gui.pictures.drawing.geometry import MM, Geometry
from kindyna_gui.pictures.drawing.items import Arrow, Move, Part
from kindyna_gui.pictures.style import OUTLINE, Theme

LONGEST, HEAD = 16.0, 1.8  # longest arrow and its head, in units
Z_ARROW = 11.0
NO_VECTOR = 1e-9  # a vector below this part of the largest is no vector


@frozen(eq=False)
class Field:
    """Vectors at moving places, in SI.

    rows   key, place (n,) [mm], vector (n,) [SI]
    """

    family: str
    unit: str
    rows: tuple[tuple[str, np.ndarray, np.ndarray], ...]

    @property
    def peak(self) -> float:
        """Size of the largest vector that is not near infinity [SI]."""
        sizes = [np.abs(vector[np.isfinite(vector)]) for _, _, vector in self.rows]
        finite = np.concatenate(sizes) if sizes else np.zeros(0)
        if not finite.size:
            return 0.0
        top, usual = float(finite.max()), float(np.percentile(finite, 98.0))
        return top if top < 20.0 * usual or usual == 0.0 else usual

    def mm_per_unit(self, geometry: Geometry) -> float:
        """Length of an arrow [mm] for one unit (SI)."""
        return LONGEST * geometry.unit / self.peak if self.peak > 0.0 else 0.0


def velocities(geometry: Geometry) -> Field:
    """Velocity of every point of every body that moves; points that stay together count once."""
    rows: list[tuple[str, np.ndarray, np.ndarray]] = []
    for name, pose in geometry.kinematics.bodies.items():
        for point in geometry.bodies[name].nodes:
            track = pose.point(point)
            place, speed = track[0] * MM, track[1] * geometry.study.omega
            if not any(np.abs(place - other).max() <= NO_VECTOR * geometry.unit for _, other, _ in rows):
                rows.append((f"{name}.{point}", place, speed))
    return _moving(Field("velocity", "m/s", tuple(rows)))


def forces(geometry: Geometry) -> Field:
    """Forces of the pairs, as the tables of core name them, and of the cam on the follower."""
    try:
        forces = geometry.study.dynamics
        shape = geometry.shape
    except NoAnswer:
        return Field("force", "N", ())
    places = {joint.name: joint.track for joint in geometry.joints}
    centre = np.zeros(geometry.samples, dtype=complex)
    rows = [(name, places.get(name, centre), force) for name, force in forces.pairs.items()]
    for flank, contact in zip(() if shape is None else shape.flanks, forces.contacts, strict=True):
        name = "contact" if shape is not None and flank is shape.flank else f"contact.{flank.name}"
        rows.append((name, flank.contact * MM, -contact.force * flank.normal))
    return _moving(Field("force", "N", tuple(rows)))


def _moving(field: Field) -> Field:
    """Without the vectors that stay zero; infinite ones, which have no arrow, become zero."""
    rows = tuple((key, place, np.where(np.isfinite(v), v, 0.0)) for key, place, v in field.rows)
    least = NO_VECTOR * field.peak
    return Field(field.family, field.unit, tuple(row for row in rows if np.abs(row[2]).max(initial=0.0) > least))


def arrows(field: Field, layer: str, geometry: Geometry, theme: Theme) -> Iterator[Part]:
    """One arrow for each row."""
    scale = field.mm_per_unit(geometry)
    for key, place, vector in field.rows:
        item = Arrow(theme.pen(theme.family(field.family), OUTLINE), HEAD * geometry.unit)
        yield Part(f"{layer}.{key}", item, (layer,), Z_ARROW, _follow(item, place, vector * scale))


def _follow(item: Arrow, place: np.ndarray, vector: np.ndarray) -> Move:
    return lambda i: item.point(complex(place[i]), complex(vector[i]))


def strokes(field: Field, geometry: Geometry) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Where arrows start and end (n,), (n,) [mm]."""
    scale = field.mm_per_unit(geometry)
    for _, place, vector in field.rows:
        yield place, place + vector * scale
