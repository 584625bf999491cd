"""Side view and end view of a cam in space in the drawing of its output, in third-angle projection.

The side view has the section through the axis of the cam, the material before and behind it, and the edges of the flanks that face the
viewer; the end view is seen from +z. A slide moves along +x of the drawing, an arm or a turret turns about its origin.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import pairwise
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from core.frozen import frozen
from core.spatial.contact import AHEAD
from core.spatial.kinds import Machine, roller_axis
from core.spatial.picture import (
    TURN,
    Blank,
    State,
    elevation,
    flank_patches,
    greatest_elevation,
    roller_tracks,
    with_run_out,
)
from core.spatial.shape import turret_limit

NEAR_END = 0.015  # from the ends of the blank to the ends of the lines on it, by its length
ROWS = 3  # lines on a flank of a globoidal cam
ANGLES = 240  # steps of the edges around the turn
RIM = DIRECTIONS = 48  # points of a roller's rim, directions in which the outline of a roller is searched
COSINES, SINES = np.cos(TURN * np.arange(DIRECTIONS) / DIRECTIONS), np.sin(TURN * np.arange(DIRECTIONS) / DIRECTIONS)
ARC = 12  # points of an arc of a globoidal blank
STAND_OFF = 0.3  # of a slide's guide from the blank, by the blank's radius
GAP = 0.25  # between both views, by the blank's radius


class ViewAxes(NamedTuple):
    """How a kind of motion is drawn.

    Attributes
    ----------
    side, end : ndarray (3,) complex, dimensionless
        Drawing of the unit vectors x, y and z of the frame in the side view and the end view.
    viewer : ndarray (3,), dimensionless
        Direction towards the viewer of the side view.
    section : float [rad]
        Polar angle of the section in the frame.
    """

    side: np.ndarray
    end: np.ndarray
    viewer: np.ndarray
    section: float


AXES: Mapping[tuple[str, str], ViewAxes] = MappingProxyType(
    {
        ("barrel", "mm"): ViewAxes(np.array([1j, 0, 1]), np.array([1j, -1, 0]), np.array([0.0, 1.0, 0.0]), 0.0),
        ("barrel", "deg"): ViewAxes(
            np.array([0, 1, 1j]), np.array([-1j, 1, 0]), np.array([1.0, 0.0, 0.0]), 0.5 * np.pi
        ),
        ("globoidal", "deg"): ViewAxes(np.array([-1, 0, 1j]), np.array([-1, -1j, 0]), np.array([0.0, 1.0, 0.0]), 0.0),
    }
)
"""Kind and unit of the motion -> drawing: a slide above the cam, an arm seen along its roller, a turret to the left of a globoidal cam."""


class RollerOutline(NamedTuple):
    """Outline of a roller in both views.

    Attributes
    ----------
    number : int
    in_blank : bool
        Whether the cam can touch it.
    side, end : ndarray (k,) complex [m]
        Corners of its outline.
    """

    number: int
    in_blank: bool
    side: np.ndarray
    end: np.ndarray


class _Track(NamedTuple):
    """Groove, or rib of a slide: polar angle (n,) [rad] and elevation (n,) of its lower and upper edge, at the surface and at the floor."""

    surface: tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
    floor: tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


class FlankLine(NamedTuple):
    """Line along a flank, at one distance u along the roller.

    Attributes
    ----------
    number, side : roller and side of the flank
    is_top : bool
        Whether it is an edge of the blank's surface or of a rib.
    u : float [m]
    theta, pressure_angle : ndarray (n,) [rad]
    point : ndarray (3, n) [m]
        In the frame of the cam.
    """

    number: int
    side: str
    is_top: bool
    u: float
    theta: np.ndarray
    pressure_angle: np.ndarray
    point: np.ndarray


class EdgePoint(NamedTuple):
    """Point of an edge in the side view: its line, the number of the point on it, and its position [m]."""

    line: FlankLine
    sample: int
    position: complex


@frozen(eq=False)
class CamViews:
    """Both views of a cam in space.

    Attributes
    ----------
    machine, blank, sense : of the cam
    axes : how it is drawn
    origin, end_origin : complex [m]
        Points of the drawing at the origin of the frame, in the side view and the end view.
    ends : (float, float) [m]
        Least and greatest height of the blank.
    lines : tuple of FlankLine
    edges : ndarray (3, n) [m]
        Points of all lines, one after the other.
    edge : ndarray (n,) int, dimensionless
        Index of the line of each point.
    tracks : grooves or ribs
    """

    machine: Machine
    blank: Blank
    sense: float
    axes: ViewAxes
    origin: complex
    end_origin: complex
    ends: tuple[float, float]
    elevations: tuple[float, float]
    lines: tuple[FlankLine, ...]
    edges: np.ndarray
    edge: np.ndarray
    tracks: tuple[_Track, ...]

    def meridian(self, at: np.ndarray, on_floor: bool) -> np.ndarray:
        """Height + i·radius of the surface of the blank, or of the floor of its grooves.

        Parameters
        ----------
        at : ndarray (n,) [m or rad]
            Height on a barrel, angle about the turret's axis on a globoidal cam.
        on_floor : bool

        Returns
        -------
        ndarray (n,) complex [m]
        """
        machine = self.machine
        if machine.is_cylindrical:
            radius = machine.inner if on_floor != _is_slide_rib(machine) else self.blank.outer
            return np.asarray(at + 1j * radius)
        u = machine.outer if on_floor else machine.inner
        return np.asarray(u * np.sin(at) + 1j * (machine.lever - u * np.cos(at)))

    @property
    def radii(self) -> tuple[float, float]:
        """Greatest radius of the blank, and the least of its surface or floor [m]."""
        machine = self.machine
        if machine.is_cylindrical:
            return self.blank.outer, machine.inner
        return machine.lever - machine.inner * float(np.cos(self.elevations[1])), machine.lever - machine.inner

    @property
    def guide(self) -> float:
        """Distance of a slide's guide from the cam's axis [m]; 0 for an arm or a turret."""
        return -self.origin.imag if self.machine.slides else 0.0

    def section(self, polar: float) -> np.ndarray:
        """Contour of the half section at a polar angle of the cam, from the axis to the axis.

        Parameters
        ----------
        polar : float [rad]

        Returns
        -------
        ndarray (k,) complex [m]
            Height + i·radius.
        """
        low, high = self.elevations
        cuts = sorted(cut for track in self.tracks for cut in _cuts(track, polar))
        contour, start = [np.array([complex(self.ends[0]), self._end(low)])], low
        for below, above, floor_below, floor_above in cuts:
            contour += [self._arc(start, below, False), self._arc(floor_below, floor_above, True)]
            start = above
        contour += [self._arc(start, high, False), np.array([self._end(high), complex(self.ends[1])])]
        return np.concatenate(contour)

    def _end(self, at: float) -> complex:
        """Rim of an end, on the floor of a globoidal cam."""
        rims = [complex(self.meridian(np.array([at]), on_floor)[0]) for on_floor in (False, True)]
        return complex(rims[1].real, min(rim.imag for rim in rims))

    def _arc(self, start: float, end: float, on_floor: bool) -> np.ndarray:
        start, end = (min(max(value, self.elevations[0]), self.elevations[1]) for value in (start, end))
        count = 2 if self.machine.is_cylindrical else ARC
        return self.meridian(np.linspace(start, end, count), on_floor)

    def outline(self, angle: float) -> np.ndarray:
        """Outline of the section through the axis in the side view at an angle of the cam.

        Parameters
        ----------
        angle : float [rad]
            About +z.

        Returns
        -------
        ndarray (k,) complex [m]
        """
        polar = self.axes.section - angle
        halves = self.section(polar), self.section(polar + np.pi)[::-1]
        along, across = self.axes.side[2], _drawn(self.axes.side, _radial(self.axes.section))
        parts = [
            self.origin + half.real * along + way * half.imag * across
            for half, way in zip(halves, (1.0, -1.0), strict=True)
        ]
        return np.concatenate(parts)

    def edges_at(self, angle: float) -> tuple[tuple[bool, np.ndarray], ...]:
        """Edges, and on a globoidal cam lines on its flanks, in the side view at an angle of the cam.

        Parameters
        ----------
        angle : float [rad]

        Returns
        -------
        tuple of (bool, ndarray (k,) complex [m])
            Whether the line is an edge that faces the viewer, and its points.
        """
        in_front, drawn = self._seen(angle)
        ends = np.flatnonzero((in_front[1:] != in_front[:-1]) | (self.edge[1:] != self.edge[:-1])) + 1
        return tuple(
            (bool(in_front[start] and self.lines[self.edge[start]].is_top), drawn[start:end])
            for start, end in pairwise((0, *ends.tolist(), in_front.size))
            if end - start > 1
        )

    def _seen(self, angle: float) -> tuple[np.ndarray, np.ndarray]:
        """Whether the points of all lines face the viewer (n,), and their positions (n,) [m] in the side view."""
        cos, sin = float(np.cos(angle)), float(np.sin(angle))
        x, y, z = self.edges
        points = np.stack((cos * x - sin * y, sin * x + cos * y, z))
        return self.axes.viewer @ points >= 0.0, self.origin + self.axes.side @ points

    def nearest_edge(self, angle: float, position: complex, reach: float) -> EdgePoint | None:
        """Point of a visible edge that is nearest to a position of the side view; None beyond a distance [m]."""
        in_front, drawn = self._seen(angle)
        is_edge = np.array([line.is_top for line in self.lines], dtype=bool)[self.edge]
        distance = np.where(in_front & is_edge, np.abs(drawn - position), np.inf)
        if not distance.size or distance.min() > reach:
            return None
        i = int(np.argmin(distance))
        line = int(self.edge[i])
        return EdgePoint(self.lines[line], i - int(np.searchsorted(self.edge, line)), complex(drawn[i]))

    def down_to_axis(self, edge: np.ndarray) -> tuple[np.ndarray, ...]:
        """Areas between an edge and the axis: material in front of the section or behind it, seen through a groove.

        Each area is on one side of the axis under a part of the edge that does not turn back, so that it does not cross itself.

        Parameters
        ----------
        edge : ndarray (k,) complex [m]

        Returns
        -------
        tuple of ndarray (m,) complex [m]
            Corners, counter-clockwise.
        """
        along = complex(self.axes.side[2])
        frame = (edge - self.origin) * along.conjugate()
        steps, is_above = np.diff(frame.real) > 0.0, frame.imag > 0.0
        crosses = is_above[1:] != is_above[:-1]
        cuts = [
            0,
            *(np.flatnonzero((steps[1:] != steps[:-1]) | crosses[1:] | crosses[:-1]) + 1).tolist(),
            edge.size - 1,
        ]
        return tuple(
            area if steps[start] != is_above[start] else area[::-1]
            for start, end in pairwise(cuts)
            if not crosses[start]
            for area in [self.origin + along * np.concatenate([frame[start : end + 1], frame[[end, start]].real])]
        )

    def rollers(self, y: float) -> Iterator[RollerOutline]:
        """Outlines of all rollers at a position y of the motion [m or rad]."""
        machine = self.machine
        tracks = roller_tracks(machine)
        at = y + np.array([track.offset for track in tracks])
        line = roller_axis(machine, at)
        u, around = np.array([machine.inner, machine.outer])[:, None], np.linspace(0.0, TURN, RIM, endpoint=False)
        across = np.cross(line.a, line.t, axis=0)
        circles = np.cos(around)[:, None] * line.t[:, None] + np.sin(around)[:, None] * across[:, None]
        middles = line.c[:, None] + u * line.a[:, None]
        rims = np.concatenate([
            middles[:, k : k + 1] + float(machine.roller_radius(float(u[k, 0]))) * circles for k in range(2)
        ], axis=1)  # fmt: skip
        limit = turret_limit(machine) if machine.is_turret else np.inf
        in_blank = np.abs(np.mod(at + np.pi, TURN) - np.pi) <= limit
        side, end = (
            origin + np.tensordot(axes, rims, 1)
            for origin, axes in ((self.origin, self.axes.side), (self.end_origin, self.axes.end))
        )
        for k, track in enumerate(tracks):
            yield RollerOutline(track.number, bool(in_blank[k]), _hull(side[:, k]), _hull(end[:, k]))

    @property
    def turret_reach(self) -> float:
        """Greatest distance of a turret's rollers from its axis [m]."""
        machine = self.machine
        return (
            machine.lever + machine.radius if machine.is_cylindrical else float(np.hypot(machine.outer, machine.radius))
        )

    def roller_track(self, y: np.ndarray) -> np.ndarray:
        """Middle of the first roller in the side view.

        Parameters
        ----------
        y : ndarray (n,) [m or rad]
            Motion.

        Returns
        -------
        ndarray (n,) complex [m]
        """
        line = roller_axis(self.machine, y + roller_tracks(self.machine)[0].offset)
        return np.asarray(self.origin + self.axes.side @ (line.c + self.machine.middle * line.a))

    @property
    def boxes(self) -> tuple[tuple[complex, complex], ...]:
        """Lower left and upper right corner of the cam in the side view and the end view [m]."""
        outer, (low, high) = self.radii[0], self.ends
        across = _drawn(self.axes.side, _radial(self.axes.section))
        corners = [
            self.origin + z * complex(self.axes.side[2]) + r * across for z in (low, high) for r in (-outer, outer)
        ]
        side = np.array(corners)
        return (
            (complex(side.real.min(), side.imag.min()), complex(side.real.max(), side.imag.max())),
            (self.end_origin - complex(outer, outer), self.end_origin + complex(outer, outer)),
        )


def cam_views(machine: Machine, state: State, sense: float, blank: Blank) -> CamViews:
    """Views of a cam in space.

    Parameters
    ----------
    machine : Machine
    state : callable
        Motion at cam angles.
    sense : float
        Sense of rotation, ±1.
    blank : Blank

    Returns
    -------
    CamViews
    """
    axes = AXES[machine.kind, machine.unit]
    if machine.is_cylindrical:
        machine = replace(machine, outer=min(machine.outer, blank.outer))
    patches = list(flank_patches(with_run_out(machine), state, sense, ANGLES, ROWS, beyond=1))
    on_surface = -1 if machine.is_cylindrical != _is_slide_rib(machine) else 0
    if machine.is_cylindrical and not machine.is_turret:
        ends = elevations = _ends(machine, blank) or blank.ends(machine, patches)
    else:
        limit = greatest_elevation(machine, state)
        height = limit if machine.is_cylindrical else machine.outer * float(np.sin(limit))
        elevations, ends = (-limit, limit), (-height, height)
    rows = (-1,) if machine.is_cylindrical else range(ROWS)  # the walls of a barrel are radial
    tracks, lines = [], list[FlankLine]()
    for ahead, behind in zip(patches[::2], patches[1::2], strict=True):
        low, high = (ahead, behind) if _is_slide_rib(machine) else (behind, ahead)
        assert ahead.side == AHEAD
        levels = [
            tuple(_polar(machine, patch.point[:, row]) for patch in (low, high))
            for row in (on_surface, -1 - on_surface)
        ]
        tracks.append(_Track(levels[0], levels[1]))  # type: ignore[arg-type]
        lines += [
            FlankLine(
                patch.number, patch.side, row == rows[0], float(patch.u[row]), patch.theta[run], patch.pressure_angle[row, run],
                patch.point[:, row, run],
            )
            for patch in (low, high) for row in rows for run in _inside(machine, patch.point[:, row], elevations)
        ]  # fmt: skip
    outer = blank.outer if machine.is_cylindrical else machine.lever - machine.inner * float(np.cos(elevations[1]))
    lever = machine.lever
    origin = -1j * (max(outer, machine.outer) + STAND_OFF * outer) if machine.slides else complex(lever)
    away = (1.0 + GAP) * outer + ends[1]
    end_origin = origin + complex(axes.side[2]) * away
    number = np.repeat(np.arange(len(lines)), [line.theta.size for line in lines])
    return CamViews(
        machine=machine, blank=blank, sense=sense, axes=axes, origin=origin, end_origin=end_origin, ends=ends, elevations=elevations,
        lines=tuple(lines), edges=np.concatenate([np.zeros((3, 0)), *(line.point for line in lines)], axis=1), edge=number,
        tracks=tuple(tracks),
    )  # fmt: skip


def _ends(machine: Machine, blank: Blank) -> tuple[float, float] | None:
    """Ends of a blank of known length [m], where a groove may leave it."""
    half = 0.5 * (machine.length or 0.0)
    return (blank.middle - half, blank.middle + half) if half else None


def _is_slide_rib(machine: Machine) -> bool:
    return machine.is_rib and not machine.is_turret


def _radial(polar: float) -> np.ndarray:
    return np.array([np.cos(polar), np.sin(polar), 0.0])


def _drawn(axes: np.ndarray, vector: np.ndarray) -> complex:
    return complex(axes @ vector)


def _inside(machine: Machine, points: np.ndarray, elevations: tuple[float, float]) -> Iterator[np.ndarray]:
    """Indices (k,) of each part of an edge (3, n) between the ends of the blank, whose lines stay visible."""
    height, margin = elevation(machine, points), NEAR_END * (elevations[1] - elevations[0])
    inside = (height >= elevations[0] + margin) & (height <= elevations[1] - margin)
    for run in np.split(np.arange(inside.size), np.flatnonzero(np.diff(inside)) + 1):
        if run.size > 1 and inside[run[0]]:
            yield run


def _polar(machine: Machine, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Polar angle (n,) [rad], ascending, and elevation (n,) of points (3, n)."""
    polar = np.unwrap(np.arctan2(points[1], points[0]))
    order = np.argsort(polar, kind="stable")
    return polar[order], elevation(machine, points)[order]


def _cuts(track: _Track, polar: float) -> Iterator[tuple[float, float, float, float]]:
    """Elevations of the edges of a track at a polar angle: lower and upper at the surface, lower and upper at the floor."""
    angles, _ = track.surface[0]
    first = float(np.ceil((angles[0] - polar) / TURN - 1e-9))
    for k in np.arange(first, (angles[-1] - polar) / TURN - 1e-9):
        at = polar + k * TURN
        low, high, floor_low, floor_high = (
            float(np.interp(at, *edge)) for level in (track.surface, track.floor) for edge in level
        )
        yield min(low, high), max(low, high), min(floor_low, floor_high), max(floor_low, floor_high)


def _hull(points: np.ndarray) -> np.ndarray:
    """Corners (k,) of the convex outline of points (n,) complex, counter-clockwise."""
    farthest = np.argmax(np.outer(COSINES, points.real) + np.outer(SINES, points.imag), axis=1)
    return points[farthest[farthest != np.append(farthest[-1], farthest[:-1])]]


__all__ = ["AXES", "CamViews", "EdgePoint", "FlankLine", "RollerOutline", "ViewAxes", "cam_views"]
