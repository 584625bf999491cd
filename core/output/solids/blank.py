"""Blanks of cams in space, which leave next to the flanks without being cut by them: cylinders, and tori about a turret's axis.

The blank of a globoidal cam is turned along the inner ends of the rollers, an arc about the axis of the turret, and its grooves end at the
floor, the arc along their outer ends. With a blank radius a cylinder limits both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from functools import partial
from itertools import pairwise
from math import acos, asin, atan2, ceil, hypot, pi, sqrt

import numpy as np

from core.design.spatial import GloboidalCam
from core.errors import NoCam
from core.frozen import frozen
from core.output.solids.body import Body, BodyBuilder, CircleCurve, CylinderSurface, LineCurve, TorusSurface
from core.output.solids.disk import hole_outline, required
from core.output.solids.outline import Outline, area
from core.output.solids.patches import MM
from core.output.solids.prism import UP
from core.output.solids.strips import Strips, spatial_strips
from core.output.solids.turned import (
    Halves,
    add_band,
    add_ends,
    chord_angle,
    circle_points,
    circle_rim,
    end_triangles,
    paired_triangles,
)
from core.output.solids.walls import GrooveWall
from core.study import Study
from core.study.spatial_checks import axis_heights

BLANK_RADIUS = "the radius of the blank"
BEYOND = 0.02  # of the depth of the grooves by which flanks extend beyond them
SEAMS = 0.0, pi  # polar angles
SHORTEST = 1e-6  # [mm] a lower cylinder is left out


# -- turned surfaces --------------------------------------------------------------------------------------------


@frozen
class Zone:
    """Part of a turned surface between two circles about the axis: a cylinder, or a torus.

    Attributes
    ----------
    low, high : radius and height of both circles [mm]
    major_radius, minor_radius : of a torus [mm]; 0: a cylinder
    """

    low: tuple[float, float]
    high: tuple[float, float]
    major_radius: float = 0.0
    minor_radius: float = 0.0

    @property
    def volume(self) -> float:
        """Volume [mm³] about the axis, ∫π ρ² dz, on a torus with ρ = D - √(r² - z²)."""
        if not self.minor_radius:
            return pi * self.low[0] ** 2 * (self.high[1] - self.low[1])
        r, d = self.minor_radius, self.major_radius

        def integral(z: float) -> float:
            return (d * d + r * r) * z - z**3 / 3.0 - d * (z * sqrt(max(r * r - z * z, 0.0)) + r * r * asin(z / r))

        return pi * (integral(self.high[1]) - integral(self.low[1]))

    def add(
        self, builder: BodyBuilder, lower: tuple[tuple[int, int], Halves], upper: tuple[tuple[int, int], Halves]
    ) -> None:
        """Add its faces between rims."""
        pairs = list(zip(lower[0], upper[0], strict=True))
        if not self.minor_radius:
            surface = CylinderSurface(np.zeros(3), UP, self.low[0])
            add_band(builder, surface, lower[1], upper[1], [builder.edge(LineCurve(), *pair) for pair in pairs])
            return
        seams = []
        for angle, pair in zip(SEAMS, pairs, strict=True):
            cos, sin = np.cos(angle), np.sin(angle)
            arc = CircleCurve(
                self.major_radius * np.array([cos, sin, 0.0]), np.array([-sin, cos, 0.0]), self.minor_radius
            )
            seams.append(builder.edge(arc, *pair))
        torus = TorusSurface(np.zeros(3), UP, self.major_radius, self.minor_radius)
        add_band(builder, torus, lower[1], upper[1], seams, is_along=False)

    def circles(self, tolerance: float) -> list[tuple[float, float]]:
        """Radius and height [mm] of circles between which cones keep half of a tolerance [mm], without the last one."""
        if not self.minor_radius:
            return [self.low]
        r, d = self.minor_radius, self.major_radius
        first, last = (asin(z / r) for _, z in (self.low, self.high))
        count = ceil((last - first) / chord_angle(r, 0.5 * tolerance))
        angles = [first + (last - first) * k / count for k in range(1, count)]
        return [self.low, *((d - r * np.cos(angle), r * np.sin(angle)) for angle in angles)]


def _turned(builder: BodyBuilder, zones: tuple[Zone, ...]) -> tuple[Halves, Halves]:
    """Add the faces of consecutive zones, and return the rims at both ends."""
    circles = [zones[0].low, *(zone.high for zone in zones)]
    rims = [circle_rim(builder, *circle, SEAMS) for circle in circles]
    for zone, (lower, upper) in zip(zones, pairwise(rims), strict=True):
        zone.add(builder, lower, upper)
    return rims[0][1], rims[-1][1]


def _rings(zones: tuple[Zone, ...], tolerance: float) -> list[np.ndarray]:
    """Corners (n, 3) [mm] of triangles on circles from the lower to the upper end."""
    circles = [*(circle for zone in zones for circle in zone.circles(tolerance)), zones[-1].high]
    widest = max(radius for radius, _ in circles)
    count = len(circle_points(widest, 0.0, 0.5 * tolerance))
    return [circle_points(radius, height, tolerance, count) for radius, height in circles]


# -- blank and flanks -------------------------------------------------------------------------------------------


@frozen(eq=False)
class UncutBlank:
    """Flanks of a cam in space, its blank as a solid that they do not cut, and the floor of its grooves.

    Attributes
    ----------
    strips : the flanks
    side : zones of the blank, from the lower to the upper end
    floor : zone of the floor
    hole : outline of the bore with its keyway
    """

    strips: Strips
    side: tuple[Zone, ...]
    floor: Zone
    hole: Outline
    points: Mapping[str, np.ndarray] = field(default_factory=dict)

    @property
    def deviation(self) -> float:
        """Largest distance [mm] of the exact flanks from the sheets; blank and floor are exact."""
        return self.strips.deviation

    @property
    def volume(self) -> float:
        """Volume of the blank [mm³]."""
        height = self.side[-1].high[1] - self.side[0].low[1]
        return sum(zone.volume for zone in self.side) + area(self.hole) * height

    @property
    def bodies(self) -> tuple[Body, ...]:
        """The blank, a sheet for the floor, and one for each flank."""
        blank, floor = BodyBuilder(), BodyBuilder()
        add_ends(blank, _turned(blank, self.side), (self.side[0].low[1], self.side[-1].high[1]), self.hole)
        _turned(floor, (self.floor,))
        return blank.body("blank", is_closed=True), floor.body("floor", is_closed=False), *self.strips.bodies

    def triangles(self, tolerance: float) -> np.ndarray:
        """Triangles of all bodies, counter-clockwise seen from outside.

        Parameters
        ----------
        tolerance : float [mm]
            Largest distance of their faces from the triangles.

        Returns
        -------
        ndarray (n, 3, 3) [mm]
        """
        side = _rings(self.side, tolerance)
        bands = [paired_triangles(*pair) for pair in pairwise(side)]
        ends = end_triangles(side[0], side[-1], self.hole, tolerance)
        return np.concatenate([*bands, ends, self.sheet_triangles(tolerance)])

    def sheet_triangles(self, tolerance: float) -> np.ndarray:
        """Triangles of the floor and the flanks, as those of all bodies.

        Parameters
        ----------
        tolerance : float [mm]

        Returns
        -------
        ndarray (n, 3, 3) [mm]
        """
        bands = [paired_triangles(*pair) for pair in pairwise(_rings((self.floor,), tolerance))]
        return np.concatenate([*bands, self.strips.triangles(tolerance)])

    def rims(self, tolerance: float) -> tuple[np.ndarray, ...]:
        """Closed polygons on the circles between the zones of the blank.

        Parameters
        ----------
        tolerance : float [mm]

        Returns
        -------
        tuple of ndarray (n, 3) [mm]
        """
        circles = [self.side[0].low, *(zone.high for zone in self.side)]
        return tuple(circle_points(radius, height, tolerance) for radius, height in circles)


def uncut_blank(study: Study, tolerance: float) -> UncutBlank:
    """Flanks of a cam in space next to its blank.

    The flanks extend a little beyond the blank and the floor, those of a turret to where the roller is out of the blank, so that
    they can cut it.

    Raises
    ------
    KindynaError
        The tolerance requires too many spans.
    NoCam
        A dimension of the blank is missing, the rollers are outside of it, or a flank has an edge.
    """
    from core.spatial import SIDES

    cam = study.design.drive.cam
    low, high = blank_heights(study)
    if isinstance(cam, GloboidalCam):
        side, floor = _globoid(study, cam, 0.5 * (high - low))
    else:
        radius, inner = required(cam, "outer_radius_mm", BLANK_RADIUS), floor_radius(study)
        side, floor = (Zone((radius, low), (radius, high)),), Zone((inner, low), (inner, high))
    walls = partial(GrooveWall, ends=_depths(study))
    return UncutBlank(
        spatial_strips(study, SIDES, tolerance, _limit(study, side), walls), side, floor, hole_outline(cam)
    )


def blank_heights(study: Study) -> tuple[float, float]:
    """Ends of the blank [mm], about the middle of a motion in mm, else about z = 0. Raises NoCam without a length."""
    length, middle = required(study.design.drive.cam, "length_mm", "the length of the blank"), 0.0
    if study.machine.slides:
        middle = 0.5 * MM * sum(end.value for end in axis_heights(study))
    return middle - 0.5 * length, middle + 0.5 * length


def floor_radius(study: Study) -> float:
    """Distance [mm] of the floor of the grooves from the axis of the cam, of a globoidal cam in the middle."""
    cam, machine = study.design.drive.cam, study.machine
    if isinstance(cam, GloboidalCam):
        return float(cam.centre_distance_mm - MM * (machine.outer + machine.play))
    return float(MM * (machine.inner - machine.play))


def _depths(study: Study) -> tuple[float, float]:
    """Depths of the walls of the grooves [mm], a part of their difference beyond the blank and beyond the floor."""
    cam, floor = study.design.drive.cam, floor_radius(study)
    if isinstance(cam, GloboidalCam):
        low, high = cam.roller_inner_mm, cam.centre_distance_mm - floor
    else:
        low, high = floor, cam.outer_radius_mm
    beyond = BEYOND * (high - low)
    return low - beyond, high + beyond


def _limit(study: Study, side: tuple[Zone, ...]) -> float:
    """Angle [rad] of the turret at which a roller has left the blank: that of its corner and of the roller's radius.

    A roller of a barrel leaves the cylinder of the blank through an end, or sideways.
    """
    cam, radius = study.design.drive.cam, MM * study.machine.radius
    (end, high), (_, low) = side[-1].high, side[0].low
    half = 0.5 * (high - low)
    if isinstance(cam, GloboidalCam):
        away = cam.centre_distance_mm - end
        return atan2(half, away) + asin(min(1.0, radius / hypot(away, half)))
    if not study.machine.is_turret:
        return 0.5 * pi
    arm, aside = MM * study.machine.lever, sqrt(end**2 - cam.roller_inner_mm**2) + radius
    return min(asin(min(1.0, (half + radius) / arm)), acos(max(0.0, 1.0 - aside / arm)))


# -- globoidal cams ---------------------------------------------------------------------------------------------


def _globoid(study: Study, cam: GloboidalCam, half: float) -> tuple[tuple[Zone, ...], Zone]:
    """Side of the blank of a half length [mm], and floor of the grooves. Raises NoCam where the rollers are outside of the blank."""
    throat = floor_radius(study)
    if cam.outer_radius_mm is not None and cam.outer_radius_mm <= throat:
        raise NoCam(
            f"{cam.outer_radius_mm:g} mm: the rollers do not reach into the blank",
            "cam.outer_radius_mm",
            f"choose more than {throat:g} mm",
        )
    side, tip = _arc_zones(cam, half), cam.centre_distance_mm - throat
    return side, _torus(cam, tip, min(half, _height(cam, tip)))


def _torus(cam: GloboidalCam, distance: float, height: float) -> Zone:
    """Torus at a distance [mm] from the axis of the turret, up to a height [mm] on both sides."""
    radius = cam.centre_distance_mm - sqrt(distance**2 - height**2)
    return Zone((radius, -height), (radius, height), cam.centre_distance_mm, distance)


def _height(cam: GloboidalCam, distance: float) -> float:
    """Height [mm] at which the torus at this distance from the axis of the turret meets the cylinder of the blank, or ends."""
    cylinder = cam.centre_distance_mm if cam.outer_radius_mm is None else cam.outer_radius_mm
    return sqrt(max(distance**2 - max(cam.centre_distance_mm - cylinder, 0.0) ** 2, 0.0))


def _arc_zones(cam: GloboidalCam, half: float) -> tuple[Zone, ...]:
    """Torus along the rollers' inner ends between cylinders of the blank radius. Raises NoCam where both do not meet."""
    radius, centre_distance, inner = cam.outer_radius_mm, cam.centre_distance_mm, cam.roller_inner_mm
    if radius is not None and radius <= centre_distance - inner:
        return (Zone((radius, -half), (radius, half)),)
    height = _height(cam, inner)
    if half < min(height + SHORTEST, inner):
        return (_torus(cam, inner, half),)
    if radius is None or radius >= centre_distance:
        raise NoCam(
            f"{'missing' if radius is None else f'{radius:g} mm'}: the arc about the turret's axis ends {inner:g} mm from the middle, "
            f"before the blank, whose half length is {half:g} mm",
            "cam.outer_radius_mm",
            f"give a radius below {centre_distance:g} mm, or shorten the blank",
        )
    torus = _torus(cam, inner, height)
    return Zone((radius, -half), (radius, -height)), torus, Zone((radius, height), (radius, half))
