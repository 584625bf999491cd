"""The lift that a probe measures on the exact profile over the cam angle, with the band that a tolerance leaves it.

The probe moves on a line through the cam centre while the cam turns. A round probe's centre runs along the curve beside the profile
at its radius r, so that its lift is the distance at which that curve meets the line, less that at the base circle; a flat face across
the line measures the profile's support function. A profile that is off by ± t normal to itself is measured as the curve at r ± t.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from core.cam import INNER, OUTER, faces_of
from core.design import Design
from core.errors import KindynaError, NoCam, angle_ranges
from core.findings import NOTE, Finding
from core.frozen import frozen
from core.motion import Angles
from core.motion.extremes import Extreme, find_extremes, piecewise_angles
from core.numerics.vectors import cross, dot
from core.output.inspection.probe import PROBES, ProbeKind, Readings, Stretches, readings, stretches
from core.output.inspection.request import Request
from core.output.profile.curve import Exact, ProfileCurve, side
from core.output.profile.cutter import hollow
from core.output.profile.made import exact_curve
from core.output.profile.request import Request as Profile
from core.requests import require
from core.study import Study

USUAL_DEG = 90.0  # where the follower has no direction
LITTLE = 1e-6  # mm that nobody measures
FLAT = 1e-9  # of the curvature of the base circle: what bends less is straight


@frozen(eq=False)
class LiftTable:
    """Lift over the cam angle.

    degrees       (n,) cam angle
    lift          (n,) [mm] of the exact profile, above the base
    lower, upper  (n,) [mm] of a profile that is off by the tolerance either way
    slope         (n,) [mm/rad] of the lift by the cam angle
    cosine        (n,) of the angle between the profile's normal and the line of measurement
    place         (n,) complex [mm] where the profile is touched, in the cam's own frame
    normal        (n,) complex unit vector there, away from the cam
    """

    degrees: np.ndarray
    lift: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    slope: np.ndarray
    cosine: np.ndarray
    place: np.ndarray
    normal: np.ndarray


@frozen(eq=False)
class Probing:
    """A probe set to a cam.

    kind       row of ``PROBES``
    radius     [mm] of a round probe, 0 of others
    direction  [rad] of the line of measurement, from the cam centre
    exact      the profile, and on which side of it the probe runs (+1 left of its tangent)
    outward    +1 where that is away from the cam centre, -1 on the outer flank of a groove
    """

    study: Study
    request: Request
    kind: ProbeKind
    radius: float
    direction: float
    exact: Exact
    side: float
    outward: float

    # -- what is fixed for all angles --------------------------------------------------------------------------

    @cached_property
    def curve(self) -> ProfileCurve:
        """The profile with its arc length."""
        return ProfileCurve(self.exact, self.study.program.starts, self.study.program.ends)

    @cached_property
    def least_radius(self) -> Extreme:
        """Of the profile, its distance from the cam centre [mm]."""
        return find_extremes(lambda angles: {"": np.abs(self.exact(angles).z)}, self.study.program)[""].low

    @property
    def base(self) -> float:
        """Distance of the probe's centre or face from the cam centre [mm] at which the lift is 0."""
        return self.least_radius.value + self.outward * self.radius

    @cached_property
    def bends(self) -> tuple[Extreme, Extreme]:
        """The profile's most convex and most hollow curvature [1/mm], hollow being positive."""
        found = find_extremes(lambda angles: {"": self.side * self.exact(angles).curvature}, self.study.program)[""]
        return found.low, found.high

    @cached_property
    def _parts(self) -> dict[float, Stretches]:
        return {}

    # -- measuring ---------------------------------------------------------------------------------------------

    def readings(self, theta: np.ndarray, beside: float = 0.0) -> Readings:
        """What the probe measures at cam angles (n,) [rad] on the profile moved ``beside`` [mm] towards it.

        Raises NoCam where the line of measurement does not meet the cam.
        """
        guide = self.kind.guide(self.exact, self.side, self.radius + beside)
        if beside not in self._parts:
            self._parts[beside] = stretches(guide, self.study.program)
        directions = self.direction - self.study.sense * theta
        made = readings(self.kind, guide, self.exact, self._parts[beside], directions, self.outward)
        missed = ~np.isfinite(made.distance)
        if missed.any():
            raise NoCam(
                "the probe's line does not meet the profile",
                "cam.base_radius_mm",
                "enlarge the base radius, so that the cam centre lies inside the cam",
                angle_ranges(theta, missed),
            )
        return made

    def lift(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lift [mm] and its derivative by the cam angle [mm/rad] (n,) at any cam angles (n,) [rad]."""
        made = self.readings(theta)
        return made.distance - self.base, -self.study.sense * made.slope

    def table(self, degrees: np.ndarray) -> LiftTable:
        """Everything at cam angles (n,) [deg]."""
        theta = np.deg2rad(degrees)
        made, band = self.readings(theta), self.request.tolerance_mm
        lower, upper = (
            made.distance if not band else self.readings(theta, sign * self.outward * band).distance
            for sign in (-1.0, 1.0)
        )
        normal = self.side * 1j * made.contact.tangent
        cosine = self.outward * dot(normal, np.exp(1j * (self.direction - self.study.sense * theta)))
        return LiftTable(
            degrees,
            made.distance - self.base,
            lower - self.base,
            upper - self.base,
            -self.study.sense * made.slope,
            cosine,
            made.contact.z,
            normal,
        )

    # -- what it does not measure --------------------------------------------------------------------------------

    def _angle(self, direction: complex) -> float:
        """Cam angle [deg] at which a direction of the cam's own frame comes to the line of measurement."""
        angle = self.study.sense * (self.direction - np.angle(direction))
        return float(np.mod(np.rad2deg(angle), 360.0)) % 360.0

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """Where the probe does not reach, at its cam angles: notes, for what it measures is right all the same."""
        found = (self._bridged(),) if self.kind.flat else (self._hollow(), self._overhang())
        return tuple(each for each in found if each is not None)

    def _hollow(self) -> Finding | None:
        """A round probe that is too large for a hollow; a point, and one no larger than the follower, reaches everywhere."""
        if self.radius <= own_probe(self.study.design, self.request.flank)[1]:
            return None
        found = hollow(self.curve, self.exact, self.study.program, self.side, self.radius)
        if found is None:
            return None
        there = self.exact(self.study.program.angles(np.deg2rad([found.begin])))
        centre = complex(there.z[0] + self.side * self.radius * 1j * there.tangent[0])
        left = f", which leaves {found.left:.3g} mm between them" if found.left > LITTLE else ""
        return self._not_reached(centre, found.radius, left)

    def _bridged(self) -> Finding | None:
        """A flat face over any hollow."""
        sharpest = self.bends[1]
        if sharpest.value <= FLAT / self.least_radius.value:
            return None
        there = self.exact(self.study.program.angles(np.array([sharpest.theta])))
        return self._not_reached(complex(self.side * 1j * there.tangent[0]), 1.0 / sharpest.value, "")

    def _not_reached(self, direction: complex, radius: float, left: str) -> Finding:
        least = f", of radius {radius:.5g} mm," if np.isfinite(radius) else " between two parts of it"
        probe = self.kind.label + (f", radius {self.radius:.6g} mm" if self.kind.radius else "")
        values: dict[str, float | str] = {"probe": probe, "hollow": least, "left": left, "radius_mm": radius}
        return Finding("probe-hollow", NOTE, "inspection.radius_mm", self._angle(direction), values)

    def _overhang(self) -> Finding | None:
        """Where the path of a round probe's centre turns back over itself."""

        def facing(angles: Angles) -> np.ndarray:
            there = self.exact(angles)
            normal = self.side * 1j * there.tangent
            place = there.z + self.radius * normal
            return np.asarray(self.outward * dot(normal, place) / np.abs(place))

        lowest = find_extremes(lambda angles: {"": facing(angles)}, self.study.program)[""].low
        if lowest.value > 0.0:
            return None
        there = self.exact(self.study.program.angles(np.array([lowest.theta])))
        centre = complex(there.z[0] + self.side * self.radius * 1j * there.tangent[0])
        return Finding("probe-overhang", NOTE, "inspection.radius_mm", self._angle(centre), {})


@frozen(eq=False)
class Inspection:
    """The table of a probe over one turn."""

    probing: Probing
    table: LiftTable


def probing(study: Study, request: Request) -> Probing:
    """A probe set to the study's cam.

    Raises NoSuchStage, NoCam as ``core.output.profile.job_of`` does, and KindynaError for a probe, radius or tolerance that cannot
    be.
    """
    flank = Profile(request.flank, samples=request.samples, fit="polyline")
    exact = exact_curve(study, flank)
    usual, own = own_probe(study.design, request.flank)
    name = request.probe or usual
    if name not in PROBES:
        raise KindynaError(f"probe {name!r}: none of that name; allowed: {', '.join(PROBES)}")
    kind = PROBES[name]
    require(request)
    radius = _radius(request, kind, own)
    on = side(study, study_flank(study, request.flank))
    direction = np.deg2rad(own_direction(study.design) if request.direction_deg is None else request.direction_deg)
    z = exact(piecewise_angles(study.program)).z
    area = float(cross(z, np.roll(z, -1)).sum())
    made = Probing(study, request, kind, radius, float(direction), exact, on, -float(np.sign(area)) * on)
    _require_room(made)
    _require_tolerance(made)
    return made


def own_probe(design: Design, flank: str) -> tuple[str, float]:
    """The row of ``PROBES`` that touches a flank as the cam's own follower does, and its radius [mm]; of an outer flank with play
    the roller that is there, which is smaller than the one that the flank is made for."""
    face = faces_of(design.drive.face, design.drive.cam)[INNER if flank == OUTER else flank]
    alike = (slug for slug, kind in PROBES.items() if (kind.flat, kind.radius) == (face.straight, face.radius_mm > 0.0))
    return next(alike), face.radius_mm


def study_flank(study: Study, name: str) -> int:
    """Its place among the flanks of the cam."""
    return [each.name for each in study.at(Angles(np.zeros(1), np.zeros(1, dtype=int))).cam.flanks].index(name)


def own_direction(design: Design) -> float:
    """Where the follower stands, seen from the cam centre [deg], where it has a direction; else 90."""
    return float(getattr(design.drive.mechanism, "direction_deg", USUAL_DEG))


def _radius(request: Request, kind: ProbeKind, own: float) -> float:
    given = request.radius_mm
    if not kind.radius:
        if given:
            raise KindynaError(f"radius {given:g} mm: a {kind.label} has none; leave it out, or take a roller")
        return 0.0
    radius = own if given is None else given
    if not (np.isfinite(radius) and radius > 0.0):
        said = "a roller of what radius? the cam's own follower has none" if given is None else f"radius {given:g} mm"
        raise KindynaError(f"{said}; allowed: above 0 (a point has none)")
    return radius


def _require_room(made: Probing) -> None:
    """Inside a groove there is room for the probe."""
    if made.outward > 0.0:
        return
    if made.kind.flat:
        raise KindynaError("probe flat: it does not get at a flank that surrounds it; take a roller or a point")
    faces = faces_of(made.study.design.drive.face, made.study.design.drive.cam)
    room = 0.5 * sum(face.radius_mm for face in faces.values()) if OUTER in faces else np.inf
    if made.radius > room:
        raise KindynaError(
            f"radius {made.radius:g} mm: the probe does not go into the groove; allowed: at most {room:.9g} mm"
        )


def _require_tolerance(made: Probing) -> None:
    """A profile that is off by so much is still a profile."""
    band = made.request.tolerance_mm
    if not (np.isfinite(band) and band >= 0.0):
        raise KindynaError(f"tolerance {band:g} mm: allowed: 0 or more")
    convex = -made.bends[0].value
    most = min(made.least_radius.value, 1.0 / convex if convex > 0.0 else np.inf)
    if band >= most:
        raise KindynaError(
            f"tolerance {band:g} mm: as large as the profile's least convex radius or its distance from the cam centre; "
            f"allowed: below {most:.5g} mm"
        )


def inspection(study: Study, request: Request) -> Inspection:
    """The table at equally spaced cam angles; raises as ``probing`` does."""
    made = probing(study, request)
    return Inspection(made, made.table(360.0 * np.arange(request.samples) / request.samples))


__all__ = ["Inspection", "LiftTable", "Probing", "inspection", "own_direction", "own_probe", "probing"]
