"""Solid of a barrel cam whose roller slides along its axis: a blank with a groove, its bore and its keyway.

The walls of the groove are the flanks, cut by the cylinders of the floor and of the blank: their second parameter is the distance from the
axis of the cam. Where the velocity of the motion is 0, both walls are at the same angle around the cam, and a straight line across
floor and blank splits the cylinders into faces.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from core.cam.checks import keyway_reach
from core.design.spatial import SpatialCam
from core.errors import KindynaError, NoCam
from core.frozen import frozen
from core.motion import TURN
from core.number_text import rounded_up
from core.numerics.roots import gauss
from core.output.solids.body import (
    Body,
    CircleCurve,
    CylinderSurface,
    Edge,
    Face,
    LineCurve,
    Loop,
    PlaneSurface,
    SplineCurve,
    SplineSurface,
)
from core.output.solids.disk import hole_outline
from core.output.solids.outline import Outline, area
from core.output.solids.prism import UP, Prism, Wall
from core.output.solids.step import ACCURACY
from core.output.solids.strips import (
    ExactFlank,
    Patch,
    Strip,
    along_basis,
    fit_patch,
    is_cut,
    motion_rows,
    require_smooth,
    spline_value,
)
from core.study import Study

if TYPE_CHECKING:
    from core.spatial import SpatialFlank

MM = 1e3
NEWTON = 12  # steps, more than convergence takes
SAMPLES = 65  # of a piece, between which its velocity changes sign once
STILL = 1e-12  # velocity relative to the largest one that counts as 0
BISECTIONS = 60
FIRST, TIGHTER, ATTEMPTS = 2e-6, 0.2, 4  # tolerance [mm], and its factor until the rims are on their cylinders


@frozen(eq=False)
class BarrelSolid:
    """The solid, the largest distance [mm] of its exact walls from the file, and its volume [mm³]."""

    body: Body
    deviation: float
    volume: float
    points: Mapping[str, np.ndarray] = field(default_factory=dict)

    @property
    def bodies(self) -> tuple[Body, ...]:
        """The one body."""
        return (self.body,)

    def triangles(self, tolerance: float) -> np.ndarray:
        """Raises KindynaError: this solid has no triangles.

        Parameters
        ----------
        tolerance : float [mm]

        Returns
        -------
        ndarray (n, 3, 3) [mm]
        """
        raise KindynaError(
            "surface: the solid of a barrel cam is written as STEP; allowed: .step, or leave the solid out"
        )


class GrooveWall(ExactFlank):
    """A flank as a function of the cam angle and of the distance from the axis of the cam."""

    def __init__(self, study: Study, strip: Strip, floor: float, blank: float) -> None:
        super().__init__(study, strip)
        self.ends = floor, blank

    def flank(self, theta: np.ndarray, piece: np.ndarray, u: np.ndarray) -> SpatialFlank:
        """Exact flank at distances from the axis of the cam, which Newton's method converts to those along the roller.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
        piece : ndarray (n,), dimensionless
        u : ndarray (m,) [mm]
            Distances from the axis of the cam.

        Returns
        -------
        SpatialFlank
        """
        from core.spatial import flank

        machine, rows = self.study.machine, motion_rows(self.study, theta, piece)
        radius = u[:, None] / MM + 0.0 * theta
        distance = radius
        for _ in range(NEWTON):
            surface = flank(machine, rows, distance, self.study.sense, self.strip.side)
            (x, y, _), (x_u, y_u, _) = surface.point, surface.by_u
            size = np.hypot(x, y)
            distance = distance - (size - radius) * size / (x * x_u + y * y_u)
        return flank(machine, rows, distance, self.study.sense, self.strip.side)

    def by_theta(self, theta: float, piece: int, u: np.ndarray) -> np.ndarray:
        """Derivative of the point by cam angle at constant distance from the axis of the cam.

        Parameters
        ----------
        theta : float [rad]
        piece : int, dimensionless
        u : ndarray (m,) [mm]
            Distances from the axis of the cam.

        Returns
        -------
        ndarray (m, 3) [mm/rad]
        """
        surface = self.flank(np.array([theta]), np.array([piece]), u)
        point, by_theta, by_u = surface.point, surface.by_theta, surface.by_u
        share = (point[:2] * by_theta[:2]).sum(axis=0) / (point[:2] * by_u[:2]).sum(axis=0)
        return MM * surface.in_cam(by_theta - share * by_u)[:, :, 0].T


def barrel_solid(study: Study, tolerance: float) -> BarrelSolid:
    """Solid of a barrel cam with a groove of one roller that slides along the axis of the cam.

    Raises
    ------
    KindynaError
        The cam is another one, or the tolerance requires too many spans.
    NoCam
        A dimension is missing, the groove leaves the blank, or a flank has an edge.
    """
    from core.spatial import SIDES

    _require_groove(study)
    study.surface  # noqa: B018 - raises where the cam does not exist
    require_smooth(study)
    cam = study.design.drive.cam
    floor, blank = MM * (study.machine.inner - study.machine.play), cam.outer_radius_mm
    hole = hole_outline(cam)
    if hole and MM * keyway_reach(cam) >= floor:
        raise NoCam(
            f"the keyway reaches {MM * keyway_reach(cam):g} mm from the axis, the floor of the groove is at {floor:g} mm",
            "cam.keyway_depth_mm",
            "make the keyway or the bore smaller",
        )
    runs, seams = _runs(study)
    walls = [_fit_wall(study, side, runs, tolerance) for side in SIDES]
    patches = [wall[0] for wall in walls]
    low, high = _heights(study, patches)
    body = _body(study, patches, seams, (floor, blank), (low, high), hole)
    enclosed = np.pi * blank**2 + area(hole)
    volume = enclosed * (high - low) + sum(_flux(patch) for wall in patches for patch in wall)
    return BarrelSolid(body, max(deviation for _, deviation in walls), volume)


def is_slide_groove(cam: SpatialCam) -> bool:
    """Whether a cam in space is a barrel cam with the groove of a roller that slides."""
    return cam.kind == "barrel" and cam.form.form == "groove" and getattr(cam, "arm_mm", None) is None


def _require_groove(study: Study) -> None:
    cam = study.design.drive.cam
    if not is_slide_groove(cam):
        raise KindynaError(
            f"cam.kind = {cam.kind!r}: only a barrel cam with a groove and a motion in mm has a solid; leave the solid out"
        )
    for key, what in (("outer_radius_mm", "the radius of the blank"), ("length_mm", "the length of the blank")):
        if getattr(cam, key) is None:
            raise NoCam(f"missing: {what}", f"cam.{key}", "give it in the design")


# -- walls ------------------------------------------------------------------------------------------------------


Run = list[tuple[float, float, int]]


def _runs(study: Study) -> tuple[list[Run], tuple[int, int]]:
    """Pieces of the motion by patches, and the two patches that start where the velocity is 0."""
    program = study.program
    pieces = [i for i in range(program.starts.size) if program.ends[i] > program.starts[i]]
    stops = _stops(study, pieces)
    first = stops[0]
    second = min(stops, key=lambda angle: abs(abs(angle - first) - 0.5 * TURN))
    if abs(second - first) < 1e-6:
        raise KindynaError("surface: the solid needs a motion whose velocity is 0 at two cam angles")
    runs: list[Run] = []
    previous: list[int | None] = [None, *pieces[:-1]]
    for before, i in zip(previous, pieces, strict=True):
        low, high = float(program.starts[i]), float(program.ends[i])
        cuts = [low, *sorted(angle for angle in (first, second) if low < angle < high), high]
        spans = [(a, b, i) for a, b in pairwise(cuts)]
        if before is None or is_cut(study, before, i) or low in (first, second):
            runs.append([spans[0]])
        else:
            runs[-1].append(spans[0])
        runs += [[span] for span in spans[1:]]
    starts = [run[0][0] for run in runs]
    return runs, (starts.index(first), starts.index(second))


def _stops(study: Study, pieces: list[int]) -> list[float]:
    """Cam angles [rad] at which the velocity is 0, the starts of pieces among them."""
    program = study.program
    stops: list[float] = []
    largest = max(
        np.abs(_velocity(study, np.linspace(program.starts[i], program.ends[i], SAMPLES), i)).max() for i in pieces
    )
    for i in pieces:
        theta = np.linspace(program.starts[i], program.ends[i], SAMPLES)
        velocity = _velocity(study, theta, i)
        if abs(velocity[0]) <= STILL * largest:
            stops.append(float(theta[0]))
        inner = np.flatnonzero(velocity[1:-2] * velocity[2:-1] < 0.0) + 1
        for k in inner:
            low, high = theta[k], theta[k + 1]
            for _ in range(BISECTIONS):
                middle = 0.5 * (low + high)
                same = _velocity(study, np.array([middle]), i)[0] * velocity[k] > 0.0
                low, high = (middle, high) if same else (low, middle)
            stops.append(float(low))
    if not stops:
        raise KindynaError("surface: the solid needs a motion whose velocity is 0 at two cam angles")
    return stops


def _velocity(study: Study, theta: np.ndarray, piece: int) -> np.ndarray:
    return np.asarray(motion_rows(study, theta, np.full(theta.size, piece)).y_1)


def _fit_wall(study: Study, side: str, runs: list[Run], tolerance: float) -> tuple[list[Patch], float]:
    """Patches of a wall, whose rims are on the cylinders of floor and blank within the accuracy of the file."""
    cam = study.design.drive.cam
    floor = MM * (study.machine.inner - study.machine.play)
    exact = GrooveWall(study, Strip(side, 1, 0.0, 0.0, TURN, True), floor, cam.outer_radius_mm)
    exact.require_no_edge(runs)
    limit = min(tolerance, FIRST)
    for _ in range(ATTEMPTS):
        along = along_basis(exact, runs, limit)
        fits = [fit_patch(exact, run, along, limit) for run in runs]
        if max(_rim_error(patch, exact.ends) for patch, _ in fits) <= ACCURACY:
            return [patch for patch, _ in fits], max(error for _, error in fits)
        limit *= TIGHTER
    raise KindynaError("surface: the rims of the groove cannot be written within the accuracy of a STEP file")


def _rim_error(patch: Patch, radii: tuple[float, float]) -> float:
    """Largest distance [mm] of the rims of a wall from their cylinders."""
    knots = patch.by_angle.knots
    theta = np.concatenate([np.linspace(a, b, 9) for a, b in pairwise(knots)])
    errors = []
    for radius, end in zip(radii, (0, -1), strict=True):
        x, y, _ = spline_value(patch.by_angle, patch.points[:, end], theta).T
        errors.append(np.abs(np.hypot(x, y) - radius).max())
    return float(max(errors))


def _heights(study: Study, walls: list[list[Patch]]) -> tuple[float, float]:
    """Ends of the blank [mm], about the middle of the motion. Raises NoCam where the groove leaves it."""
    program, length = study.program, study.design.drive.cam.length_mm
    rows = [
        motion_rows(study, np.linspace(a, b, SAMPLES), np.full(SAMPLES, i)).y
        for i, (a, b) in enumerate(zip(program.starts, program.ends, strict=True))
    ]
    y = MM * np.concatenate(rows)
    middle = 0.5 * float(y.max() + y.min())
    reach = max(abs(float(patch.points[:, :, 2].max()) - middle) for patch in walls[0])
    reach = max(reach, *(abs(float(patch.points[:, :, 2].min()) - middle) for patch in walls[1]))
    if 2.0 * reach >= length:
        raise NoCam(
            f"{length:g} mm: the groove reaches {reach:.6g} mm from the middle of the blank",
            "cam.length_mm",
            f"choose more than {rounded_up(2.0 * reach, 4):g} mm",
        )
    return middle - 0.5 * length, middle + 0.5 * length


def _flux(patch: Patch) -> float:
    """Flux ∫z n_z dA [mm³] through a wall, n out of the material."""

    def nodes(knots: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
        t, weights = gauss(count)
        spans = np.diff(knots)[:, None]
        return (knots[:-1, None] + spans * t).ravel(), (spans * weights).ravel()

    (theta, by_theta), (radius, by_radius) = nodes(patch.by_angle.knots, 8), nodes(patch.along.knots, 5)

    def derivative(first: int, second: int) -> np.ndarray:
        rows = spline_value(patch.by_angle, patch.points, theta, first)
        return spline_value(patch.along, rows.transpose(1, 0, 2), radius, second)

    z, normal = derivative(0, 0)[:, :, 2], np.cross(derivative(1, 0), derivative(0, 1))[:, :, 2]
    flux = float(by_radius @ (z * normal) @ by_theta)
    return flux if patch.is_along else -flux


# -- the body ---------------------------------------------------------------------------------------------------


def _reversed(loop: Loop) -> Loop:
    return tuple((edge, not is_forward) for edge, is_forward in reversed(loop))


def _body(
    study: Study,
    walls: list[list[Patch]],
    seams: tuple[int, int],
    radii: tuple[float, float],
    heights: tuple[float, float],
    hole: Outline,
) -> Body:
    """The body; vertex 2 (count w + i) + end starts patch i of wall w, at the floor (0) or at the blank (1)."""
    count, sense = len(walls[0]), study.sense
    corners = [patch.points[0][end] for wall in walls for patch in wall for end in (0, -1)]
    angles = [np.angle(complex(*walls[0][i].points[0][-1][:2])) for i in seams]
    rims = [np.array([radii[1] * np.cos(a), radii[1] * np.sin(a), z]) for z in heights for a in angles]
    vertices = [*corners, *rims]
    edges: list[Edge] = []

    def add(edge: Edge) -> int:
        edges.append(edge)
        return len(edges) - 1

    def vertex(wall: int, i: int, end: int) -> int:
        return 2 * (count * wall + i % count) + end

    faces: list[Face] = []
    curves: dict[tuple[int, int, int], int] = {}
    for w, wall in enumerate(walls):
        lines = [
            add(Edge(SplineCurve(p.along, p.points[0]), vertex(w, i, 0), vertex(w, i, 1))) for i, p in enumerate(wall)
        ]
        for i, patch in enumerate(wall):
            for end in (0, 1):
                curve = SplineCurve(patch.by_angle, patch.points[:, -end])
                curves[w, end, i] = add(Edge(curve, vertex(w, i, end), vertex(w, i + 1, end)))
            after = lines[(i + 1) % count]
            loop: Loop = ((curves[w, 0, i], True), (after, True), (curves[w, 1, i], False), (lines[i], False))
            surface = SplineSurface(patch.by_angle, patch.along, patch.points)
            faces.append(Face(surface, (loop if patch.is_along else _reversed(loop),), patch.is_along))
    rim = [[4 * count + 2 * z + k for k in (0, 1)] for z in (0, 1)]
    arcs = [
        [add(Edge(CircleCurve(np.array([0.0, 0.0, h]), -sense * UP, radii[1]), ends[k], ends[1 - k])) for k in (0, 1)]
        for h, ends in zip(heights, rim, strict=True)
    ]
    first, second = seams
    between = [(first + i) % count for i in range((second - first) % count)]
    parts = [between, [(second + i) % count for i in range(count - len(between))]]

    def border(wall: int, end: int) -> list[list[int]]:
        return [[curves[wall, end, i] for i in part] for part in parts]

    bands: tuple[tuple[float, list[list[int]], list[list[int]], list[tuple[int, int]]], ...] = (
        (radii[0], border(1, 0), border(0, 0), [(vertex(1, i, 0), vertex(0, i, 0)) for i in seams]),
        (
            radii[1],
            border(0, 1),
            [[arc] for arc in arcs[1]],
            [(vertex(0, i, 1), rim[1][k]) for k, i in enumerate(seams)],
        ),
        (
            radii[1],
            [[arc] for arc in arcs[0]],
            border(1, 1),
            [(rim[0][k], vertex(1, i, 1)) for k, i in enumerate(seams)],
        ),
    )  # radius; lower and upper border of both faces; vertices of the seams, low and high
    for radius, lower, upper, ends in bands:
        uprights = [add(Edge(LineCurve(), *pair)) for pair in ends]
        cylinder = CylinderSurface(np.zeros(3), UP, radius)
        for k in (0, 1):
            band: Loop = (
                *((edge, True) for edge in lower[k]),
                (uprights[1 - k], True),
                *((edge, False) for edge in reversed(upper[k])),
                (uprights[k], False),
            )
            faces.append(Face(cylinder, (band if sense < 0.0 else _reversed(band),)))
    outer: list[Loop] = [tuple((edge, True) for edge in pair) for pair in arcs]  # with growing cam angle
    low_loops, high_loops = (
        [_reversed(outer[0]) if sense < 0.0 else outer[0]],
        [outer[1] if sense < 0.0 else _reversed(outer[1])],
    )
    if hole:
        bore, base, at = Prism("", (Wall(hole, *heights),)).body, len(edges), len(vertices)
        vertices += list(bore.vertices)
        edges += [Edge(edge.curve, edge.start + at, edge.end + at) for edge in bore.edges]
        for face in bore.faces:
            moved = tuple(tuple((edge + base, is_forward) for edge, is_forward in loop) for loop in face.loops)
            faces.append(Face(face.surface, moved, face.is_along))
        low_loops.append(tuple((base + i, False) for i in reversed(range(len(hole)))))
        high_loops.append(tuple((base + len(hole) + i, True) for i in range(len(hole))))
    for height, normal, loops in ((heights[0], -UP, low_loops), (heights[1], UP, high_loops)):
        faces.append(Face(PlaneSurface(np.array([0.0, 0.0, height]), normal), tuple(loops)))
    return Body("barrel", np.array(vertices), tuple(edges), tuple(faces), True)
