"""A cam in space as facets: flanks of every roller over the turn, lands, floor and ends of the blank, and the rollers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from core.design.spatial import SpatialCam
from core.spatial.contact import AHEAD, BEHIND, MotionRows, flank, turned
from core.spatial.kinds import MM, Machine, lever_arm, roller_axis
from core.spatial.shape import RollerAt, SpatialShape, rollers_at, turret_limit

TURN = 2.0 * np.pi
AROUND = 20  # facets around a roller

State = Callable[[np.ndarray], MotionRows]
"""Motion at cam angles (n,) [rad]."""


class RollerTrack(NamedTuple):
    """A roller that the cam touches: its number from 1, its motion less that of the design [m or rad], and its flanks."""

    number: int
    offset: float
    sides: tuple[str, ...]


def roller_tracks(machine: Machine) -> tuple[RollerTrack, ...]:
    """Rollers of a machine with their flanks; the two rollers on the rib of a slide have one each."""
    if machine.is_turret:
        return tuple(RollerTrack(k + 1, k * machine.pitch, (AHEAD, BEHIND)) for k in range(machine.rollers))
    if machine.is_rib:
        half = 0.5 * machine.distance
        return RollerTrack(1, -half, (AHEAD,)), RollerTrack(2, half, (BEHIND,))
    return (RollerTrack(1, 0.0, (AHEAD, BEHIND)),)


class FlankPatch(NamedTuple):
    """A coherent part of a flank in the frame of the cam.

    Attributes
    ----------
    number, side : roller and side of the flank
    theta : ndarray (n,) [rad]
        Cam angles, the last one a turn after the first where the flank is closed.
    u : ndarray (m,) [m]
        Distances along the roller.
    point, normal : ndarray (3, m, n) [m], dimensionless
        Points, and normals into the cam.
    pressure_angle : ndarray (m, n) [rad]
    """

    number: int
    side: str
    theta: np.ndarray
    u: np.ndarray
    point: np.ndarray
    normal: np.ndarray
    pressure_angle: np.ndarray


def flank_patches(
    machine: Machine, state: State, sense: float, angles: int, along: int, beyond: int = 0
) -> Iterator[FlankPatch]:
    """Parts of all flanks over one turn; of a turret where the roller is in the blank.

    Parameters
    ----------
    machine : Machine
    state : callable
        Motion at cam angles.
    sense : float
        Sense of rotation, ±1.
    angles, along : int
        Number of steps around the turn, and of points along the roller.
    beyond : int
        Steps by which a part reaches beyond the blank.

    Yields
    ------
    FlankPatch
    """
    theta = np.linspace(0.0, TURN, angles + 1)
    motion, u = state(theta), np.linspace(machine.inner, machine.outer, along)
    for track in roller_tracks(machine):
        moved = motion.shifted(track.offset)
        inside = np.ones(theta.size, dtype=bool)
        if machine.is_turret:
            angle = np.mod(moved.y + np.pi, TURN) - np.pi
            moved, inside = (
                moved._replace(y=angle),
                np.abs(angle) <= min(turret_limit(machine), 0.499 * np.pi) * (1.0 + 1e-9),
            )
        for start, end in _runs(inside, beyond):
            rows = MotionRows(*(row[start:end] for row in moved))
            for side in track.sides:
                surface = flank(machine, rows, u[:, None], sense, side)
                yield FlankPatch(
                    track.number,
                    side,
                    rows.theta,
                    u,
                    surface.cam_point,
                    surface.in_cam(surface.normal),
                    surface.pressure_angle,
                )


def _runs(inside: np.ndarray, beyond: int = 0) -> Iterator[tuple[int, int]]:
    """First index and end of every run of at least two, its end later by some steps."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], inside, [False])).astype(int)))
    for start, end in edges.reshape(-1, 2).tolist():
        if min(end + beyond, inside.size) - start > 1:
            yield start, min(end + beyond, inside.size)


# -- facets -----------------------------------------------------------------------------------------------------

FLANK, BLANK, ROLLER = range(3)
"""Sorts of facets."""


class Facets(NamedTuple):
    """Quadrangles of a picture.

    Attributes
    ----------
    corners : ndarray (k, 4, 3) [m]
    normals : ndarray (k, 3), dimensionless
        Unit normals out of the body.
    sort : ndarray (k,) int, dimensionless
        ``FLANK``, ``BLANK`` or ``ROLLER``.
    pressure_angle : ndarray (k,) [rad]
        Of a flank; NaN on other facets.
    """

    corners: np.ndarray
    normals: np.ndarray
    sort: np.ndarray
    pressure_angle: np.ndarray

    def moved(self, angle: float) -> Facets:
        """Facets rotated about the z axis by an angle [rad]."""
        corners = np.moveaxis(turned(np.moveaxis(self.corners, -1, 0), np.array(angle)), 0, -1)
        return self._replace(corners=corners, normals=turned(self.normals.T, np.array(angle)).T)


def joined(parts: list[Facets]) -> Facets:
    """Facets of several bodies together."""
    return Facets(*(np.concatenate(rows) for rows in zip(*parts, strict=True)))


def _quads(grid: np.ndarray, outwards: np.ndarray, sort: int, value: np.ndarray | None = None) -> Facets:
    """Facets of a grid of points (3, m, n) [m]; ``outwards``: directions (3, m, n) that the normals follow."""
    corners = np.stack([grid[:, :-1, :-1], grid[:, 1:, :-1], grid[:, 1:, 1:], grid[:, :-1, 1:]])
    corners = np.moveaxis(corners, (0, 1), (2, 3)).reshape(-1, 4, 3)
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = normal / np.where(size > 0.0, size, 1.0)
    towards = np.moveaxis(
        0.25 * (outwards[:, :-1, :-1] + outwards[:, 1:, :-1] + outwards[:, 1:, 1:] + outwards[:, :-1, 1:]), 0, -1
    )
    normal *= np.where((normal * towards.reshape(-1, 3)).sum(axis=1) < 0.0, -1.0, 1.0)[:, None]
    angle = (
        np.full(len(corners), np.nan)
        if value is None
        else (0.25 * (value[:-1, :-1] + value[1:, :-1] + value[1:, 1:] + value[:-1, 1:])).ravel()
    )
    return Facets(corners, normal, np.full(len(corners), sort), angle)


def _radial(grid: np.ndarray) -> np.ndarray:
    return np.stack((grid[0], grid[1], np.zeros_like(grid[2])))


class Blank(NamedTuple):
    """Blank of a cam: radius of a barrel, radius of the bore, and height of its middle [m]."""

    outer: float
    bore: float
    middle: float

    def ends(self, machine: Machine, flanks: Iterable[FlankPatch]) -> tuple[float, float]:
        """Least and greatest height of a barrel with one roller [m]; at least so that its flanks are inside."""
        reach = max(
            0.5 * (machine.length or 0.0),
            *(abs(patch.point[2] - self.middle).max() + machine.radius for patch in flanks),
        )
        return self.middle - reach, self.middle + reach


def blank_of(shape: SpatialShape, cam: SpatialCam) -> Blank:
    """Blank of a design's cam; where its radius is not known, up to the roller's outer end."""
    y = shape.motion.y
    return Blank(
        MM * cam.outer_radius_mm if cam.outer_radius_mm else shape.machine.outer,
        0.5 * MM * (cam.bore_mm or 0.0),
        0.5 * float(y.min() + y.max()) if shape.machine.slides else 0.0,
    )


def greatest_elevation(machine: Machine, state: State) -> float:
    """Greatest height on a barrel of a turret [m], or angle about the turret's axis on a globoidal blank [rad]."""
    limit = turret_limit(machine)
    if not machine.is_turret and machine.length is None:
        largest = float(np.abs(state(np.linspace(0.0, TURN, AROUND * AROUND)).y).max())
        limit = largest + 2.0 * float(np.arcsin(min(1.0, machine.radius / machine.inner)))
    limit = min(limit, 0.45 * np.pi)
    return machine.lever * float(np.sin(limit)) if machine.is_cylindrical else limit


def with_run_out(machine: Machine) -> Machine:
    """Machine of a turret whose rollers count until they have left the blank, as the cutter does."""
    if not machine.is_turret:
        return machine
    beyond = float(np.arcsin(min(1.0, machine.radius / lever_arm(machine, machine.inner))))
    limit = min(turret_limit(machine) + beyond, 0.49 * np.pi)
    return replace(machine, length=2.0 * lever_arm(machine, machine.middle) * float(np.sin(limit)))


def cam_facets(machine: Machine, state: State, sense: float, blank: Blank, angles: int) -> Facets:
    """Facets of the cam in its own frame.

    Parameters
    ----------
    machine : Machine
    state : callable
        Motion at cam angles.
    sense : float
    blank : Blank
    angles : int
        Number of steps around the turn.

    Returns
    -------
    Facets
    """
    if machine.is_cylindrical:  # the roller may reach out of the blank
        machine = replace(machine, outer=min(machine.outer, blank.outer))
    wide = with_run_out(machine)
    patches = list(flank_patches(wide, state, sense, angles, 3, beyond=1))
    parts = [_quads(patch.point, -patch.normal, FLANK, patch.pressure_angle) for patch in patches]
    if machine.is_cylindrical and not machine.is_turret:
        return joined([*parts, *_blank_of_barrel(machine, {patch.side: patch for patch in patches}, blank)])
    body = _TurretBlank(wide, blank, greatest_elevation(machine, state))
    inside = [body.contains(np.moveaxis(part.corners.mean(axis=1), -1, 0)) for part in parts]
    parts = [Facets(*(row[kept] for row in part)) for part, kept in zip(parts, inside, strict=True)]
    return joined([*parts, *body.floor(angles), *body.lands(state(np.linspace(0.0, TURN, angles + 1)), sense)])


def elevation(machine: Machine, points: np.ndarray) -> np.ndarray:
    """Height of points on a barrel, or their angle about the turret's axis on a globoidal blank.

    Parameters
    ----------
    machine : Machine
    points : ndarray (3, ...) [m]

    Returns
    -------
    ndarray (...) [m or rad]
    """
    x, y, z = points
    return np.asarray(z if machine.is_cylindrical else np.arctan2(z, machine.lever - np.hypot(x, y)))


class _TurretBlank:
    """Blank of a turret's cam: a cylinder, or a torus about the axis of the turret.

    A point of it has a polar angle, and an elevation: its height on a cylinder, on a torus its angle about the turret.
    """

    def __init__(self, machine: Machine, blank: Blank, limit: float) -> None:
        self._machine, self._outer, self._bore = machine, blank.outer, blank.bore
        self._limit = limit

    def contains(self, points: np.ndarray) -> np.ndarray:
        """Whether points (3, n) [m] are between the ends of the blank."""
        return np.asarray(np.abs(elevation(self._machine, points)) <= self._limit)

    def _point(self, polar: np.ndarray, at: np.ndarray, on_floor: bool) -> tuple[np.ndarray, np.ndarray]:
        """Point (3, ...) [m] of the surface or of the floor, and the direction (3, ...) out of the body."""
        machine = self._machine
        if machine.is_cylindrical:
            radius, height = (machine.inner if on_floor else self._outer) + 0.0 * at, at
            out = np.ones_like(at), np.zeros_like(at)
        else:
            u = machine.outer if on_floor else machine.inner
            radius, height = machine.lever - u * np.cos(at), u * np.sin(at)
            out = np.cos(at), -np.sin(at)
        cos, sin = np.cos(polar), np.sin(polar)
        return np.stack((radius * cos, radius * sin, height + 0.0 * cos)), np.stack(
            (out[0] * cos, out[0] * sin, out[1] + 0.0 * cos)
        )

    def floor(self, angles: int) -> Iterator[Facets]:
        """Floor that the ends of the rollers sweep, and the flat ends down to the bore."""
        polar, heights = np.linspace(0.0, TURN, angles + 1), np.linspace(-self._limit, self._limit, 9)[:, None]
        grid, out = self._point(polar + 0.0 * heights, heights + 0.0 * polar, on_floor=True)
        yield _quads(grid, out, BLANK)
        for row, way in ((0, -1.0), (8, 1.0)):
            rim = grid[:, row]
            hole = self._bore / np.hypot(rim[0], rim[1])
            disc = np.stack((rim, np.stack((rim[0] * hole, rim[1] * hole, rim[2]))), axis=1)
            yield _quads(disc, np.broadcast_to(np.array([0.0, 0.0, way])[:, None, None], disc.shape), BLANK)
        yield _bore_wall(self._bore, grid[2, 0, 0], grid[2, -1, 0], angles)

    def lands(self, motion: MotionRows, sense: float) -> Iterator[Facets]:
        """Surface between the flanks of neighbouring rollers, and between the outermost flanks and the ends."""
        rollers = _passing(self._machine, motion.y)
        nowhere = RollerAt(rollers[0].number, rollers[0].offset, np.zeros(motion.y.size, dtype=bool))
        for lower, upper in pairwise((nowhere, *rollers, nowhere)):
            low, high = (self._edge(motion, sense, roller, side) for roller, side in ((lower, AHEAD), (upper, BEHIND)))
            for touches, ends in (
                (lower.touches & upper.touches, (low, high)),
                (lower.touches & ~upper.touches, (low, (low[0], self._limit + 0.0 * low[1]))),
                (~lower.touches & upper.touches, ((high[0], -self._limit + 0.0 * high[1]), high)),
            ):
                for start, end in _runs(touches, beyond=1):
                    yield from self._land(*((polar[start:end], elevation[start:end]) for polar, elevation in ends))

    def _edge(self, motion: MotionRows, sense: float, roller: RollerAt, side: str) -> tuple[np.ndarray, np.ndarray]:
        """Polar angle and elevation (n,) of the edge of a flank at the surface of the blank."""
        machine = self._machine
        u = machine.outer if self._machine.is_cylindrical else machine.inner
        points = flank(machine, motion.shifted(roller.offset), np.array([[u]]), sense, side).cam_point[:, 0]
        return np.unwrap(np.arctan2(points[1], points[0])), np.clip(
            elevation(machine, points), -self._limit, self._limit
        )

    def _land(self, low: tuple[np.ndarray, np.ndarray], high: tuple[np.ndarray, np.ndarray]) -> Iterator[Facets]:
        """Surface between two edges, and the wall of the blank where one of them is its end."""
        part = np.linspace(0.0, 1.0, 4)[:, None]
        turn = np.mod(high[0] - low[0] + np.pi, TURN) - np.pi
        grid, out = self._point(low[0] + part * turn, low[1] + part * (high[1] - low[1]), on_floor=False)
        yield _quads(grid, out, BLANK)
        for row, level, way in ((0, low[1], -1.0), (-1, high[1], 1.0)):
            if np.all(level == way * self._limit):
                polar = (low, high)[row][0]
                below, _ = self._point(polar, level, on_floor=True)
                wall = np.stack((grid[:, row], below), axis=1)
                yield _quads(wall, np.broadcast_to(np.array([0.0, 0.0, way])[:, None, None], wall.shape), BLANK)


def _passing(machine: Machine, y: np.ndarray) -> tuple[RollerAt, ...]:
    """Rollers that pass the blank over the turn, the lowest first, each one of them all the time."""
    if not machine.is_turret:
        return rollers_at(machine, y)
    pitch, limit = machine.pitch, turret_limit(machine)
    first, last = np.ceil((-limit - y.max()) / pitch), np.floor((limit - y.min()) / pitch)
    return tuple(
        RollerAt(np.full(y.size, k % machine.rollers + 1), np.full(y.size, k * pitch), np.abs(y + k * pitch) <= limit)
        for k in range(int(first), int(last) + 1)
    )


def _bore_wall(radius: float, low: float, high: float, angles: int) -> Facets:
    """Wall of the bore between two heights [m]."""
    polar, height = np.linspace(0.0, TURN, angles // 3 + 1), np.array([[low], [high]])
    grid = np.stack(np.broadcast_arrays(radius * np.cos(polar), radius * np.sin(polar), height))
    return _quads(grid, -_radial(grid), BLANK)


def _blank_of_barrel(machine: Machine, flanks: dict[str, FlankPatch], blank: Blank) -> Iterator[Facets]:
    """Lands, floor and ends of a barrel, whose edges are those of its flanks."""
    outer, bore, middle = blank
    ends = blank.ends(machine, flanks.values())
    ahead, behind = flanks[AHEAD].point, flanks[BEHIND].point
    low, high = (
        (ahead, behind) if machine.is_rib else (behind, ahead)
    )  # below and above the middle of the groove or rib
    radii = (machine.inner, outer) if machine.is_rib else (outer, machine.inner)  # outside, between
    edges = [edge[:, 0 if machine.is_rib else -1] for edge in (low, high)]
    inner_edges = [edge[:, -1 if machine.is_rib else 0] for edge in (low, high)]
    for edge, end in zip(edges, ends, strict=True):
        part = np.linspace(0.0, 1.0, 5)[:, None]
        angle = np.arctan2(edge[1], edge[0])
        grid = np.stack(np.broadcast_arrays(
            radii[0] * np.cos(angle), radii[0] * np.sin(angle), edge[2] + part * (end - edge[2])
        ))  # fmt: skip
        yield _quads(grid, _radial(grid), BLANK)
        rim = grid[:, -1]
        disc = np.stack((rim, rim * np.array([[bore / radii[0]], [bore / radii[0]], [1.0]])), axis=1)
        yield _quads(disc, np.broadcast_to(np.array([0.0, 0.0, end - middle])[:, None, None], disc.shape), BLANK)
    yield _bore_wall(bore, *ends, ahead.shape[-1])
    floor = np.stack(inner_edges, axis=1)
    scale = radii[1] / np.hypot(floor[0], floor[1])
    floor = np.stack((floor[0] * scale, floor[1] * scale, floor[2]))
    yield _quads(floor, _radial(floor), BLANK)


def roller_facets(machine: Machine, y: float) -> Facets:
    """Facets of the rollers near the cam in the global frame, at a position y of the motion [m or rad]."""
    parts = []
    u, around = np.array([machine.inner, machine.outer])[:, None], np.linspace(0.0, TURN, AROUND + 1)
    for track in roller_tracks(machine):
        at = np.array([y + track.offset])
        line = roller_axis(machine, at)
        a, t = line.a[:, :1, None], line.t[:, :1, None]
        s = np.cross(a, t, axis=0)
        out = np.cos(around) * t + np.sin(around) * s
        grid = line.c[:, :1, None] + u * a + machine.roller_radius(u) * out
        parts.append(_quads(grid, np.broadcast_to(out, grid.shape), ROLLER))
        for k, way in ((0, -1.0), (1, 1.0)):
            rim = grid[:, k : k + 1]
            centre = np.broadcast_to(line.c[:, :1, None] + u[k] * a, rim.shape)
            parts.append(
                _quads(np.concatenate((rim, centre), axis=1), np.broadcast_to(way * a, (3, 2, around.size)), ROLLER)
            )
    if machine.is_turret:
        parts += _turret_disc(machine)
    return joined(parts)


def _turret_disc(machine: Machine) -> Iterator[Facets]:
    """Disc that carries the rollers of a turret: about +y inside them, or about +x at their outer ends."""
    around, radius = np.linspace(0.0, TURN, 2 * AROUND + 1), machine.radius
    if machine.is_cylindrical:
        rim, (low, high) = machine.lever + radius, (machine.outer, machine.outer + radius)
        centre, axis, across = (0.0, -machine.lever, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    else:
        rim, (low, high) = machine.inner, (-0.6 * radius, 0.6 * radius)
        centre, axis, across = (machine.lever, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)
    along, first = (np.array(row)[:, None, None] for row in (axis, across))
    out = np.cos(around) * first + np.sin(around) * np.cross(along, first, axis=0)
    wall = np.array(centre)[:, None, None] + np.array([low, high])[:, None] * along + rim * out
    yield _quads(wall, np.broadcast_to(out, wall.shape), ROLLER)
    for k, way in ((0, -1.0), (1, 1.0)):
        edge = wall[:, k : k + 1]
        middle = edge - rim * out
        rings = np.concatenate([middle + part * (edge - middle) for part in (0.0, 0.5, 1.0)], axis=1)
        yield _quads(rings, np.broadcast_to(way * along, rings.shape), ROLLER)
