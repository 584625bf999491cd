"""Disk cams as bodies: the sheets of their flanks, and solids with bore, keyway, hub and groove."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any

import numpy as np

from core.cam import OUTER, SECOND, form_row, keyway_corners, keyway_unknown
from core.cam.checks import keyway_clearance, keyway_reach
from core.errors import KindynaError, NoCam
from core.frozen import frozen
from core.number_text import result_text, rounded_up
from core.output.lines import finding_line
from core.output.solids.body import Body
from core.output.solids.mesh import prism_triangles
from core.output.solids.outline import Outline, circle, polygon, reversed_outline, slot
from core.output.solids.prism import Cap, Prism, Rim, Wall
from core.output.solids.profile import FittedOutline, fit_profile
from core.study import Study, findings_of

KEYWAY_STEP = 0.01  # mm, between profile and chords where the room for a keyway is checked
_MISSING = "give it in the design"


@frozen(eq=False)
class Prisms:
    """Bodies of a cam or plate, the largest distance [mm] of the exact surfaces from them, and named points (3,) [mm]."""

    prisms: tuple[Prism, ...]
    deviation: float
    points: Mapping[str, np.ndarray] = field(default_factory=dict)

    @property
    def bodies(self) -> tuple[Body, ...]:
        """Their vertices, edges and faces."""
        return tuple(prism.body for prism in self.prisms)

    @property
    def volume(self) -> float | None:
        """Volume of all solids [mm³]; None for sheets."""
        return sum(prism.volume for prism in self.prisms) if all(prism.caps for prism in self.prisms) else None

    def triangles(self, tolerance: float) -> np.ndarray:
        """Triangles of all bodies, counter-clockwise seen from outside.

        Parameters
        ----------
        tolerance : float [mm]
            Largest distance of the walls from the triangles.

        Returns
        -------
        ndarray (n, 3, 3) [mm]
        """
        return np.concatenate([prism_triangles(prism, tolerance) for prism in self.prisms])


def disk_sheets(study: Study, flanks: tuple[str, ...], tolerance: float) -> Prisms:
    """Flanks of a disk cam as open sheets from z = 0 to the thickness of their cam; their normals point out of the material.

    Raises
    ------
    KindynaError
        The cam does not have a flank of this name, or the tolerance is below the accuracy of the curve.
    NoCam
        The thickness is missing, or the profile has corners or cusps, or crosses itself.
    """
    heights = {flank: thickness(study, flank) for flank in flanks}
    fits = {flank: fit_profile(study, flank, tolerance) for flank in flanks}
    sheets = tuple(
        Prism(flank, (Wall(_material_left(flank, fit.outline), 0.0, heights[flank]),)) for flank, fit in fits.items()
    )
    return Prisms(sheets, max(fit.deviation for fit in fits.values()))


def thickness(study: Study, flank: str) -> float:
    """Thickness [mm] of the cam with this flank. Raises NoCam where it is missing."""
    cam = study.design.drive.cam
    second = cam.form.second.thickness_mm if flank == SECOND else None
    return required(cam, "thickness_mm", "the width of the cam along the shaft") if second is None else second


def disk_solids(study: Study, tolerance: float) -> Prisms:
    """Solids of a disk cam from z = 0 on: one, or the two of a conjugate pair next to each other.

    An open cam and each of a pair have the profile as their side; a groove cam is a blank of the outer radius with a groove
    of a depth from its upper face. Bore, keyway and hub are those of the design; a hub rises above the upper face of the
    (second) cam where its length, which counts from z = 0, exceeds the thickness.

    Raises
    ------
    KindynaError
        The tolerance is below the accuracy of the curve, or walls of the groove meet.
    NoCam
        A dimension is missing, or the profile has corners or cusps, crosses itself, or leaves no room for hub, bore or keyway.
    """
    cam = study.design.drive.cam
    flanks = form_row(cam.form).flanks
    heights = {flank: thickness(study, flank) for flank in flanks}
    hole, hub = hole_outline(cam), _hub_radius(cam)
    if OUTER in flanks:
        depth = _groove_depth(cam)
        _require_walls(study)
    fits = {flank: fit_profile(study, flank, tolerance) for flank in flanks}
    low, parts = 0.0, []
    cams = [flank for flank in flanks if flank != OUTER]
    for number, flank in enumerate(cams):
        high = low + heights[flank]
        top = high  # of the bore
        if flank == cams[-1] and hub is not None and cam.hub_length_mm > high:
            top = cam.hub_length_mm
        _require_room(cam, fits[flank], flank, hub if top > high else None, bool(hole))
        part = _Part()
        if OUTER in flanks:
            _require_blank(cam, fits[OUTER])
            side = part.wall(circle(cam.form.outer_radius_mm), low, high)
            outer = part.wall(reversed_outline(fits[OUTER].outline), high - depth, high)
            inner = part.wall(fits[flank].outline, high - depth, high)
            part.cap(True, side.high, outer.high)
            part.cap(True, outer.low, inner.low)
            island = inner.high
        else:
            side = part.wall(fits[flank].outline, low, high)
            island = side.high
        bore = part.wall(hole, low, top) if hole else None
        around_bore = [] if bore is None else [bore.high]
        if top > high and hub is not None:
            collar = part.wall(circle(hub), high, top)
            part.cap(True, island, collar.low)
            part.cap(True, collar.high, *around_bore)
        else:
            part.cap(True, island, *around_bore)
        part.cap(False, side.low, *([] if bore is None else [bore.low]))
        parts.append(part.prism("cam" if len(cams) == 1 else ("first cam", "second cam")[number]))
        low = high
    return Prisms(tuple(parts), max(fit.deviation for fit in fits.values()))


@frozen
class _Rims:
    low: Rim
    high: Rim


class _Part:
    """Walls and caps of one body."""

    def __init__(self) -> None:
        self._walls: list[Wall] = []
        self._caps: list[Cap] = []

    def wall(self, outline: Outline, low: float, high: float) -> _Rims:
        self._walls.append(Wall(outline, low, high))
        index = len(self._walls) - 1
        return _Rims(Rim(index, False), Rim(index, True))

    def cap(self, is_up: bool, *rims: Rim) -> None:
        self._caps.append(Cap(is_up, rims))

    def prism(self, name: str) -> Prism:
        return Prism(name, tuple(self._walls), tuple(self._caps))


def _material_left(flank: str, outline: Outline) -> Outline:
    """The outline of a flank with the material of the cam on its left: that of a groove is around its outer flank."""
    return reversed_outline(outline) if flank == OUTER else outline


def has_solid(cam: Any) -> bool:
    """Whether a disk cam states the dimensions that its solid needs: thickness, of a groove also blank and depth."""
    blank = (cam.form.outer_radius_mm, cam.form.groove_depth_mm) if OUTER in form_row(cam.form).flanks else ()
    return None not in (cam.thickness_mm, *blank)


# -- dimensions -------------------------------------------------------------------------------------------------


def required(table: Any, key: str, what: str, remedy: str = _MISSING) -> float:
    """Dimension [mm] of a cam. Raises NoCam where the design does not state it."""
    value = getattr(table, key)
    if value is None:
        raise NoCam(f"missing: {what}", f"cam.{key}", remedy)
    return float(value)


def _groove_depth(cam: Any) -> float:
    """Depth of the groove [mm], above 0 and below the thickness."""
    further = _MISSING if cam.form.groove_depth_mm is not None else f"{_MISSING}, and cam.groove_depth_mm"
    required(cam.form, "outer_radius_mm", "the radius of the blank around the groove", further)
    return required(cam.form, "groove_depth_mm", "the depth of the groove from the upper face")


def hole_outline(cam: Any) -> Outline:
    """Outline of the bore with its keyway, with the material on its left; empty without a bore."""
    if unknown := keyway_unknown(cam):
        others = "".join(f", and cam.{name}" for name in unknown[1:])
        raise NoCam("missing: the keyway is not complete without it", f"cam.{unknown[0]}", f"{_MISSING}{others}")
    if cam.bore_mm is None:
        return ()
    corners = keyway_corners(cam)
    return reversed_outline(slot(0.5 * cam.bore_mm, corners) if corners else circle(0.5 * cam.bore_mm))


def _hub_radius(cam: Any) -> float | None:
    """Radius of the hub [mm]; None without a length of the hub."""
    if cam.hub_length_mm is None:
        return None
    return 0.5 * required(cam, "hub_mm", "the diameter of the hub, whose length is given")


# -- room -------------------------------------------------------------------------------------------------------


def _require_walls(study: Study) -> None:
    for finding in findings_of(study, ("cam",)):
        if finding.code == "groove-flanks-meet":
            raise KindynaError(finding_line(finding))


def _require_blank(cam: Any, outer: FittedOutline) -> None:
    """Raises NoCam where the groove cuts the edge of the blank."""
    if outer.largest_radius >= cam.form.outer_radius_mm:
        raise NoCam(
            f"{cam.form.outer_radius_mm:g} mm: the groove reaches {result_text(outer.largest_radius)} mm",
            "cam.outer_radius_mm",
            f"choose more than {rounded_up(outer.largest_radius, 4):g} mm",
        )


def _require_room(cam: Any, fit: FittedOutline, flank: str, hub: float | None, has_hole: bool) -> None:
    """Raises NoCam where the profile cuts hub, bore or keyway, or the keyway cuts the hub."""
    which = "second profile" if flank == SECOND else "inner flank" if OUTER in form_row(cam.form).flanks else "profile"
    rows = [("hub_mm", hub), ("bore_mm", 0.5 * cam.bore_mm if has_hole else None)]
    for key, radius in rows:
        if radius is not None and fit.least_radius <= radius:
            raise NoCam(
                f"{2.0 * radius:g} mm: the {which} comes within {result_text(fit.least_radius)} mm of the cam centre",
                f"cam.{key}",
                f"choose less than {result_text(2.0 * fit.least_radius)} mm",
            )
    if not has_hole:
        return
    points = polygon(fit.outline, KEYWAY_STEP)
    if np.angle(np.roll(points, -1) / points).sum() < np.pi:
        raise NoCam(
            f"the {which} does not run around the cam centre, where the bore is", "cam.bore_mm", "leave the bore out"
        )
    reach = 1e3 * keyway_reach(cam)
    if hub is not None and reach >= hub:
        raise NoCam(
            f"{2.0 * hub:g} mm: the keyway reaches {result_text(reach)} mm from the cam centre",
            "cam.hub_mm",
            f"choose more than {rounded_up(2.0 * reach, 4):g} mm, or a shallower keyway",
        )
    if keyway_corners(cam) and fit.least_radius <= reach and keyway_clearance(1e-3 * points, cam).min() <= 0.0:
        raise NoCam(
            f"the {which} cuts into the keyway",
            "cam.keyway_depth_mm",
            "turn the keyway, make it shallower, or make the cam larger",
        )
