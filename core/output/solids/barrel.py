"""Solid of a barrel cam with the groove of one roller: a blank with the groove, its bore and its keyway.

The walls of the groove are the flanks, cut by the cylinders of the floor and of the blank: their second parameter is the distance from the
axis of the cam. At two cam angles a seam across the floor joins both walls, and seams along the blank join them to its ends.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from itertools import pairwise
from math import ceil

import numpy as np

from core.design import Design
from core.errors import NoCam
from core.frozen import frozen
from core.motion import TURN
from core.number_text import result_text, rounded_up
from core.numerics.roots import gauss
from core.output.solids.blank import BLANK_RADIUS, blank_heights, floor_radius
from core.output.solids.body import Body, BodyBuilder, CylinderSurface, reversed_loop
from core.output.solids.disk import hole_outline, required
from core.output.solids.outline import Outline, area
from core.output.solids.patches import (
    BETWEEN,
    MM,
    WIDEST,
    Patch,
    Run,
    TooFine,
    fit_patches,
    grid_steps,
    patch_grid,
    patch_points,
    spline_value,
)
from core.output.solids.prism import UP
from core.output.solids.step import ACCURACY
from core.output.solids.strips import Strip, add_strip, require_smooth, strip_runs
from core.output.solids.turned import (
    Halves,
    add_band,
    add_ends,
    chord_angle,
    circle_points,
    circle_rim,
    cylinder_seam,
    end_triangles,
    paired_triangles,
    zipped_triangles,
)
from core.output.solids.walls import GrooveWall
from core.study import Study
from core.study.spatial_checks import axis_heights

SAMPLES = 65  # of a rim
BACK = 1e-9  # [rad] step back that counts as rounding
FIRST, TIGHTER, ATTEMPTS = 4e-7, 0.2, 4  # tolerance [mm], and its factor until the rims are on their cylinders
NARROWER = 0.5  # factor of the widest span h: in a dwell rims of the radius R deviate as R h⁶, and only in their plane


@frozen(eq=False)
class BarrelSolid:
    """A blank with a groove, and the largest distance of the exact walls from its walls.

    Attributes
    ----------
    walls : patches of the flank ahead and of the flank behind
    middle : index of the patch at whose start the second seam is; the first is at the start of the first patch
    radii, heights : of the floor and of the blank, and of both ends [mm]
    hole : outline of the bore with its keyway
    sense : sense of rotation
    deviation : float [mm]
    """

    walls: tuple[tuple[Patch, ...], tuple[Patch, ...]]
    middle: int
    radii: tuple[float, float]
    heights: tuple[float, float]
    hole: Outline
    sense: float
    deviation: float
    points: Mapping[str, np.ndarray] = field(default_factory=dict)

    @property
    def volume(self) -> float:
        """Volume [mm³]: of the blank with its bore, and the flux of z through the walls."""
        low, high = self.heights
        enclosed = np.pi * self.radii[1] ** 2 + area(self.hole)
        return float(enclosed * (high - low)) + sum(_flux(patch) for wall in self.walls for patch in wall)

    @property
    def bodies(self) -> tuple[Body, ...]:
        """The one body."""
        builder, starts = BodyBuilder(), (0, self.middle)
        ahead, behind = (add_strip(builder, wall, is_closed=True) for wall in self.walls)
        floor, blank = (CylinderSurface(np.zeros(3), UP, radius) for radius in self.radii)
        rims: list[Halves] = []
        for height, strip in zip(self.heights, (behind, ahead), strict=True):
            corners = [strip.corners[1][i] for i in starts]
            angles = [float(np.arctan2(*builder.point(corner)[1::-1])) for corner in corners]
            circle, rim = circle_rim(builder, self.radii[1], height, angles)
            lower, upper, ends = rim, self._halves(strip.rims[1]), list(zip(circle, corners, strict=True))
            if strip is ahead:
                lower, upper, ends = upper, lower, [pair[::-1] for pair in ends]
            add_band(builder, blank, lower, upper, [cylinder_seam(builder, *pair) for pair in ends])
            rims.append(rim)
        seams = [cylinder_seam(builder, behind.corners[0][i], ahead.corners[0][i]) for i in starts]
        add_band(builder, floor, self._halves(behind.rims[0]), self._halves(ahead.rims[0]), seams)
        add_ends(builder, (rims[0], rims[1]), self.heights, self.hole)
        return (builder.body("barrel", is_closed=True),)

    def _halves(self, rim: tuple[int, ...]) -> Halves:
        """A rim of a wall counter-clockwise seen from +z, the sense of growing cam angles of a cam that turns clockwise."""
        first, second = (tuple((edge, True) for edge in part) for part in (rim[: self.middle], rim[self.middle :]))
        return (first, second) if self.sense < 0.0 else (reversed_loop(second), reversed_loop(first))

    def triangles(self, tolerance: float) -> np.ndarray:
        """Triangles, counter-clockwise seen from outside.

        Parameters
        ----------
        tolerance : float [mm]
            Largest distance of the faces from the triangles.

        Returns
        -------
        ndarray (n, 3, 3) [mm]
        """
        ahead, behind = (self._rings(wall, tolerance) for wall in self.walls)
        low, high = (circle_points(self.radii[1], height, tolerance) for height in self.heights)
        return np.concatenate([
            zipped_triangles(low, behind[-1]),
            *(paired_triangles(*pair) for pair in pairwise(behind[::-1])),
            zipped_triangles(behind[0], ahead[0]),
            *(paired_triangles(*pair) for pair in pairwise(ahead)),
            zipped_triangles(ahead[-1], high),
            end_triangles(low, high, self.hole, tolerance),
        ])  # fmt: skip

    def _rings(self, wall: tuple[Patch, ...], tolerance: float) -> np.ndarray:
        """Corners (m, n, 3) [mm] of triangles of a wall on m cylinders from floor to blank, counter-clockwise seen from +z."""
        steps = [grid_steps(patch, tolerance) for patch in wall]
        along = max(m for _, m in steps)
        widest = chord_angle(self.radii[1], tolerance)
        parts = []
        for patch, (count, _) in zip(wall, steps, strict=True):
            x, y, _ = patch_grid(patch, SAMPLES - 1, 1).transpose(2, 0, 1)
            step = np.abs(np.diff(np.unwrap(np.arctan2(y, x), axis=0), axis=0)).max()
            least = ceil(BETWEEN * (SAMPLES - 1) * step / widest)  # so that the faces on the cylinders keep it too
            parts.append(patch_grid(patch, max(count, least), along)[:-1])
        rows = np.concatenate(parts).transpose(1, 0, 2)
        return rows if self.sense < 0.0 else rows[:, ::-1]


def barrel_solid(study: Study, tolerance: float) -> BarrelSolid:
    """Solid of a barrel cam with the groove of one roller, which slides along the axis of the cam or is on an arm.

    Raises
    ------
    NoCam
        A dimension is missing, the groove leaves the blank or misses its floor, a flank has an edge, or the cam is too
        large for the accuracy of the file.
    """
    from core.spatial import AHEAD, BEHIND

    cam = study.design.drive.cam
    radii = floor_radius(study), required(cam, "outer_radius_mm", BLANK_RADIUS)
    heights = blank_heights(study)
    study.surface  # noqa: B018 - raises where the cam does not exist
    require_smooth(study)
    hole = hole_outline(cam)
    runs = strip_runs(study, Strip(AHEAD, 1, 0.0, 0.0, TURN, True))
    walls = [GrooveWall(study, side, ends=radii) for side in (AHEAD, BEHIND)]
    _require_ends(study, heights, *(_largest_radius(wall, runs) for wall in walls))
    (ahead, first), (behind, second) = (_fit_wall(wall, runs, tolerance) for wall in walls)
    starts = np.array([run[0][0] for run in runs])
    middle = 1 + int(np.abs(starts[1:] - starts[0] - 0.5 * TURN).argmin())
    return BarrelSolid((ahead, behind), middle, radii, heights, hole, study.sense, max(first, second))


def has_closed_groove(design: Design) -> bool:
    """Whether a design has a barrel cam with the groove of one roller that returns every turn."""
    cam, motion = design.drive.cam, design.drive.motion
    is_groove = design.drive.has_surface and cam.kind == "barrel" and cam.form.form == "groove" and cam.rollers == 1
    return bool(is_groove and motion is not None and not motion.gain)


# -- walls ------------------------------------------------------------------------------------------------------


def _largest_radius(wall: GrooveWall, runs: Sequence[Run]) -> float:
    """Largest radius [mm] of the roller at the rims of a wall. Raises NoCam where it has an edge or runs back around the cam."""
    wall.require_no_edge(runs)
    rims = wall.rims(runs)
    polar = -rims.sense * np.unwrap(np.arctan2(rims.cam_point[1], rims.cam_point[0]), axis=1)
    back = (np.diff(polar, axis=1) < -BACK).any(axis=0)
    if back.any():
        raise wall.edge(float(rims.theta[back.argmax()]), "runs back around the cam")
    return float(MM * rims.radius.max())


def _fit_wall(exact: GrooveWall, runs: Sequence[Run], tolerance: float) -> tuple[tuple[Patch, ...], float]:
    """Patches of a wall, whose rims are on the cylinders of floor and blank within the accuracy of the file, and its deviation."""
    limit, widest = min(tolerance, FIRST), WIDEST
    for _ in range(ATTEMPTS):
        try:
            patches, deviation = fit_patches(exact, runs, limit, widest)
        except TooFine:
            if limit == tolerance:
                raise
            break
        if max(_rim_error(patch, exact.ends) for patch in patches) <= ACCURACY:
            return patches, deviation
        limit, widest = TIGHTER * limit, NARROWER * widest
    raise NoCam(
        f"{exact.ends[1]:g} mm: the rims of the groove cannot be written within the accuracy of a STEP file, {ACCURACY:g} mm",
        "cam.outer_radius_mm",
        "choose a smaller cam, or write its flanks without a solid",
    )


def _rim_error(patch: Patch, radii: tuple[float, float]) -> float:
    """Largest distance [mm] of the rims of a wall from their cylinders."""
    knots = patch.by_angle.knots
    theta = np.concatenate([np.linspace(a, b, 9) for a, b in pairwise(knots)])
    errors = []
    for radius, end in zip(radii, (0, -1), strict=True):
        x, y, _ = spline_value(patch.by_angle, patch.points[:, end], theta).T
        errors.append(np.abs(np.hypot(x, y) - radius).max())
    return float(max(errors))


def _require_ends(study: Study, heights: tuple[float, float], ahead: float, behind: float) -> None:
    """Raises NoCam where the groove leaves the blank through one of its ends.

    The outermost contacts are above and below the roller's axis, where the motion stops, at its largest radius ahead and behind [mm].
    """
    low, high = (MM * end.value for end in axis_heights(study))
    middle = 0.5 * sum(heights)
    reach = max(high + ahead - middle, middle - low + behind)
    if reach >= heights[1] - middle:
        raise NoCam(
            f"{heights[1] - heights[0]:g} mm: the groove reaches {result_text(reach)} mm from the middle of the blank",
            "cam.length_mm",
            f"choose more than {rounded_up(2.0 * reach, 4):g} mm",
        )


def _flux(patch: Patch) -> float:
    """Flux ∫z n_z dA [mm³] through a wall, n out of the material."""

    def nodes(knots: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
        t, weights = gauss(count)
        spans = np.diff(knots)[:, None]
        return (knots[:-1, None] + spans * t).ravel(), (spans * weights).ravel()

    (theta, by_theta), (radius, by_radius) = nodes(patch.by_angle.knots, 8), nodes(patch.along.knots, 5)
    z = patch_points(patch, theta, radius)[:, :, 2]
    normal = np.cross(patch_points(patch, theta, radius, (1, 0)), patch_points(patch, theta, radius, (0, 1)))[:, :, 2]
    flux = float(by_theta @ (z * normal) @ by_radius)
    return flux if patch.is_along else -flux
