"""Flanks of a cam in space as B-spline surfaces, quintic by cam angle and cubic along the roller, within a tolerance."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import field
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from core.errors import NoCam
from core.frozen import frozen
from core.motion import TURN
from core.output.solids.body import Body, BodyBuilder, Loop, SplineCurve, SplineSurface, reversed_loop
from core.output.solids.patches import (
    MM,
    SAME,
    ExactFlank,
    Patch,
    Run,
    fit_patches,
    is_cut,
    motion_rows,
    patch_triangles,
)
from core.study import Study

if TYPE_CHECKING:
    from core.spatial import SpatialFlank

SHORTEST = 1e-6  # [rad] a shorter part of a piece of the motion is left out
BISECTIONS = 60


@frozen
class Strip:
    """Part of a flank: the side, the number and the offset [m or rad] of its roller, and its cam angles [rad].

    ``is_closed``: it runs around the cam and ends where it begins.
    """

    side: str
    roller: int
    offset: float
    low: float
    high: float
    is_closed: bool


@frozen(eq=False)
class Strips:
    """Flanks of a cam in space, and the largest distance [mm] of the exact flanks from them."""

    strips: tuple[Strip, ...]
    patches: tuple[tuple[Patch, ...], ...]
    deviation: float
    volume: None = None
    points: Mapping[str, np.ndarray] = field(default_factory=dict)

    @property
    def bodies(self) -> tuple[Body, ...]:
        """An open sheet for each strip, named by its side and roller."""
        return tuple(_sheet(strip, patches) for strip, patches in zip(self.strips, self.patches, strict=True))

    def triangles(self, tolerance: float) -> np.ndarray:
        """Triangles of all sheets, counter-clockwise seen from outside the cam.

        Parameters
        ----------
        tolerance : float [mm]
            Largest distance of the B-spline surfaces from the triangles.

        Returns
        -------
        ndarray (n, 3, 3) [mm]
        """
        return np.concatenate([patch_triangles(patch, tolerance) for patches in self.patches for patch in patches])


def spatial_strips(
    study: Study,
    sides: tuple[str, ...],
    tolerance: float,
    limit: float | None = None,
    exact: Callable[[Study, str, float], ExactFlank] = ExactFlank,
) -> Strips:
    """Flanks of a cam in space, of a turret up to a limit of its angle [rad]; without one while its rollers are in the blank.

    ``exact`` gives the exact flank of a study, a side and an offset of the roller: from end to end of the roller unless it is
    a wall of the groove.

    Raises
    ------
    NoCam
        The velocity of the motion jumps, or the roller is too large, so that a flank has an edge; or no roller is in the blank.
    KindynaError
        The tolerance requires too many spans.
    """
    study.surface  # noqa: B018 - raises where no roller is in the blank, or one has no line of contact
    require_smooth(study)
    strips = [strip for strip in flank_strips(study, limit) if strip.side in sides]
    fits = [
        fit_patches(exact(study, strip.side, strip.offset), strip_runs(study, strip), tolerance) for strip in strips
    ]
    patches = tuple(fit[0] for fit in fits)
    return Strips(tuple(strips), patches, max(deviation for _, deviation in fits))


def require_smooth(study: Study) -> None:
    """Raises NoCam where the velocity of the motion jumps."""
    for i, join in enumerate(study.program.joins):
        if join.jumps[1]:
            angle = float(np.rad2deg(join.theta))
            raise NoCam(
                "the velocity jumps, so the flank has an edge",
                f"motion.segments[{(i + 1) % len(study.program.joins)}]",
                "choose a law, or an end condition, without a jump of velocity",
                [(angle, angle)],
            )


# -- strips -----------------------------------------------------------------------------------------------------


def flank_strips(study: Study, limit: float | None) -> Iterator[Strip]:
    """Parts of the flanks that the cam has: around the cam, of a turret where the angle of a roller is within the limit [rad].

    A strip ends at cam angle 0 too; the next roller continues it there.
    """
    from core.spatial import AHEAD, BEHIND, SIDES, rollers_at, turret_limit

    machine = study.machine
    if not machine.is_turret:
        rollers = rollers_at(machine, np.zeros(1))
        sides = ((AHEAD,), (BEHIND,)) if len(rollers) == 2 else (SIDES,)
        for roller, touched in zip(rollers, sides, strict=True):
            for side in touched:
                yield Strip(side, int(roller.number[0]), float(roller.offset[0]), 0.0, TURN, True)
        return
    motion = study.design.drive.motion
    comes_back = motion is not None and not motion.gain
    for number, offset, low, high in _turret_ranges(study, turret_limit(machine) if limit is None else limit):
        for side in SIDES:
            yield Strip(side, number, offset, low, high, comes_back and high - low >= TURN)


def _turret_ranges(study: Study, limit: float) -> Iterator[tuple[int, float, float, float]]:
    """Number and offset [rad] of each roller, and the cam angles [rad] between which its angle is within the limit [rad]."""
    machine, program = study.machine, study.program
    limit = min(limit * (1.0 + SAME), 0.5 * np.pi * (1.0 - SAME))
    grid = [np.linspace(low, high, 33) for low, high in zip(program.starts, program.ends, strict=True)]
    theta = np.concatenate(grid)
    piece = np.repeat(np.arange(len(grid)), 33)
    y = motion_rows(study, theta, piece).y
    least, most = np.ceil((-limit - y.max()) / machine.pitch), np.floor((limit - y.min()) / machine.pitch)
    for step in range(int(least), int(most) + 1):
        offset = step * machine.pitch
        inside = np.abs(y + offset) <= limit
        edges = np.flatnonzero(np.diff(np.concatenate(([0], inside.astype(int), [0]))))
        for first, after in edges.reshape(-1, 2).tolist():
            low = (
                theta[first]
                if first == 0
                else _crossing(study, offset, limit, theta[first], theta[first - 1], piece[first])
            )
            last = after - 1
            high = (
                theta[last]
                if after == y.size
                else _crossing(study, offset, limit, theta[last], theta[after], piece[last])
            )
            if high - low > SHORTEST:
                yield step % machine.rollers + 1, offset, float(low), float(high)


def _crossing(study: Study, offset: float, limit: float, inside: float, outside: float, piece: int) -> float:
    """Cam angle [rad] at which a roller enters or leaves, by bisection."""
    for _ in range(BISECTIONS):
        middle = 0.5 * (inside + outside)
        y = motion_rows(study, np.array([middle]), np.array([piece])).y[0] + offset
        inside, outside = (middle, outside) if abs(y) <= limit else (inside, middle)
    return inside


def strip_runs(study: Study, strip: Strip) -> tuple[Run, ...]:
    """Parts of the motion under the patches of a strip, which is cut where segments join and where the acceleration jumps."""
    program = study.program
    low, high = np.maximum(program.starts, strip.low), np.minimum(program.ends, strip.high)
    pieces = np.flatnonzero(high - low > SHORTEST)
    parts = np.split(pieces, 1 + np.flatnonzero([is_cut(study, a, b) for a, b in pairwise(pieces.tolist())]))
    runs: list[Run] = [[(float(low[i]), float(high[i]), int(i)) for i in part] for part in parts]
    if strip.is_closed and len(runs) == 1:  # a surface does not end where it begins
        *before, (first, last, piece) = runs[0]
        middle = 0.5 * (first + last)
        runs = [[*before, (first, middle, piece)], [(middle, last, piece)]]
    return tuple(runs)


# -- bodies -----------------------------------------------------------------------------------------------------


@frozen
class StripEdges:
    """Edges and vertices of a strip in a body, in the order of cam angles, each at the inner and at the outer end of the roller.

    Attributes
    ----------
    rims : edges along both rims, one for each patch
    corners : vertices at which the patches start
    """

    rims: tuple[tuple[int, ...], tuple[int, ...]]
    corners: tuple[tuple[int, ...], tuple[int, ...]]


def add_strip(builder: BodyBuilder, patches: tuple[Patch, ...], is_closed: bool) -> StripEdges:
    """Add the faces of consecutive patches, whose common edges are single."""
    lines = [patch.points[0] for patch in patches] + ([] if is_closed else [patches[-1].points[-1]])
    corners = [[builder.vertex(line[end]) for end in (0, -1)] for line in lines]
    across = [
        builder.edge(SplineCurve(patches[0].along, line), *pair) for line, pair in zip(lines, corners, strict=True)
    ]
    rims = []
    for i, patch in enumerate(patches):
        after = (i + 1) % len(lines)
        inner, outer = (
            builder.edge(SplineCurve(patch.by_angle, patch.points[:, -end]), corners[i][end], corners[after][end])
            for end in (0, 1)
        )
        loop: Loop = ((inner, True), (across[after], True), (outer, False), (across[i], False))
        surface = SplineSurface(patch.by_angle, patch.along, patch.points)
        builder.face(surface, loop if patch.is_along else reversed_loop(loop), is_along=patch.is_along)
        rims.append((inner, outer))
    inner_rim, outer_rim = zip(*rims, strict=True)
    inner_corners, outer_corners = zip(*corners, strict=True)
    return StripEdges((inner_rim, outer_rim), (inner_corners, outer_corners))


def _sheet(strip: Strip, patches: tuple[Patch, ...]) -> Body:
    builder = BodyBuilder()
    add_strip(builder, patches, strip.is_closed)
    return builder.body(f"{strip.side} {strip.roller}", is_closed=False)


# -- tables -----------------------------------------------------------------------------------------------------


def spatial_rows(
    study: Study, side: str, blocks: list[np.ndarray], along: int
) -> Iterator[tuple[int, list[np.ndarray]]]:
    """Points of a flank under each roller, as columns of a table: of a turret only those whose axis point is in the blank.

    Parameters
    ----------
    study : Study
    side : str
        ``ahead`` or ``behind``.
    blocks : list of ndarray (n,) [deg]
        Cam angles.
    along : int
        Number of points along the roller, from end to end.

    Returns
    -------
    iterator of int, list of ndarray (m,) [deg], [mm], [1/mm]
        Number of the roller; cam angle, u, x, y, z, normal, pressure angle, curvature.
    """
    from core.spatial import flank

    machine, program = study.machine, study.program
    u = np.linspace(machine.inner, machine.outer, along)
    for angles in blocks:
        at = program.angles(np.deg2rad(angles))
        motion = motion_rows(study, at.theta, at.piece)
        for number, offset in _rollers(machine, motion.y, side):
            surface = flank(machine, motion.shifted(offset), u[:, None], study.sense, side)
            points, normal = MM * surface.cam_point, surface.in_cam(surface.normal)
            inside = _in_blank(machine, motion.y + offset, surface).T
            columns = [
                np.broadcast_to(column, (along, angles.size)).T[inside] + 0.0
                for column in (
                    angles, MM * u[:, None], *points, *normal, np.rad2deg(surface.pressure_angle), surface.curvature / MM
                )
            ]  # fmt: skip
            yield number, columns


def _rollers(machine: Any, y: np.ndarray, side: str) -> Iterator[tuple[int, np.ndarray | float]]:
    """Number of every roller that this side touches, and its motion less that of the design, of a turret within half a turn."""
    from core.spatial import AHEAD, rollers_at

    if machine.is_turret:
        for k in range(machine.rollers):
            angle = np.mod(y + k * machine.pitch + 0.5 * TURN, TURN) - 0.5 * TURN
            yield k + 1, angle - y
        return
    rollers = rollers_at(machine, y)
    for roller in rollers if len(rollers) == 1 else rollers[:1] if side == AHEAD else rollers[1:]:
        yield int(roller.number[0]), float(roller.offset[0])


def _in_blank(machine: Any, angle: np.ndarray, surface: SpatialFlank) -> np.ndarray:
    """Whether points of the roller's axis (m, n) are in the blank; always where the roller is not on a turret."""
    z = surface.axis[2] + 0.0 * surface.e_t
    if not machine.is_turret:
        return np.ones(z.shape, dtype=bool)
    limit = np.inf if machine.length is None else 0.5 * machine.length * (1.0 + SAME)
    widest = machine.pitch * (1.0 + SAME) if machine.length is None else np.inf
    near = (np.abs(angle) <= widest) & (np.abs(angle) < 0.5 * np.pi * (1.0 - SAME))
    return np.asarray((np.abs(z) <= limit) & near)
