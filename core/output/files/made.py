"""The curve of a file: its points, what runs through them, and how far that is from the exact curve."""

from __future__ import annotations

import numpy as np

from core.cam import INNER, OUTER, faces_of, form_row
from core.cam.shape import size_entry
from core.design import Face
from core.errors import KindynaError, NoCam
from core.frozen import frozen
from core.motion import Angles
from core.motion.extremes import find_extremes
from core.numerics.derivatives import dot
from core.numerics.lazy import checkpoint
from core.output.files.fewest import largest
from core.output.files.profile_curve import Exact, ProfileCurve, hollow, offset, profile, side
from core.output.files.profile_fit import FITS, Arcs, Cubics
from core.output.files.profile_request import Points, ProfileRequest, points, rounded_down, rounded_up
from core.study import Study

CERTAIN = 1e-11  # of the curve's size: its digits
LITTLE = 1e-6  # mm that nobody measures
TRIES, MISSED = 6, 1e-4  # a tolerance that is just missed is made so much smaller, so often at most


@frozen(eq=False)
class FittedCurve:
    """A curve as a file describes it.

    curve      the exact one
    points     on it
    chain      what runs from point to point
    deviation  [mm] the largest distance of the exact curve from the chain, and ``worst`` the curve's point there [mm]
    """

    curve: ProfileCurve
    points: Points
    chain: Arcs | Cubics
    deviation: float
    worst: complex

    @property
    def count(self) -> int:
        """Points that the file lists: with tangent arcs also those where two of them meet."""
        return int(self.chain.vertices.size)


def exact_curve(study: Study, request: ProfileRequest) -> Exact:
    """The profile, or the path of the cutter, in closed form.

    Raises NoSuchStage for a design without cam, KindynaError for a flank that its cam does not have, NoCam where the profile has
    corners or cusps, crosses itself, or keeps the cutter out.
    """
    flank = flank_number(study, request)
    _require_smooth(study, flank)
    exact = profile(study, flank)
    curve = ProfileCurve(exact, study.program.starts, study.program.ends)
    rolling, cutting = side(study, flank), request.cutter_mm
    face = touching(study, request)
    if face.radius_mm > 0.0:
        _require_whole(study, curve, rolling, face)
    if cutting:
        _require_room(study, cutting)
        _require_reach(study, curve, rolling, cutting)
    return offset(exact, rolling * cutting) if cutting else exact


def touching(study: Study, request: ProfileRequest) -> Face:
    """What touches the flank; of a flank with play it is so much larger."""
    return faces_of(study.design.drive.face, study.design.drive.cam)[request.flank]


def flank_number(study: Study, request: ProfileRequest) -> int:
    """Its place among the flanks of the cam."""
    study.require_stage("cam")
    there = form_row(study.design.drive.cam.form).flanks
    if request.flank not in there:
        raise KindynaError(f"flank {request.flank!r}: this cam has none of that name; allowed: {', '.join(there)}")
    return there.index(request.flank)


def cutting_side(study: Study, request: ProfileRequest) -> float:
    """On which side of the flank the cutter runs: +1 left of its tangent, -1 right."""
    return side(study, flank_number(study, request))


def _require_smooth(study: Study, flank: int) -> None:
    """Neither corners nor cusps: the motion's velocity does not jump, and the contact runs along the profile one way only."""
    for i, join in enumerate(study.program.joins):
        if join.jumps[:2].any():
            angle = float(np.rad2deg(join.theta))
            raise NoCam(
                "the velocity jumps, so the profile has a corner",
                f"motion.segments[{(i + 1) % len(study.program.joins)}]",
                "take a law, or another end, that joins without a jump",
                [(angle, angle)],
            )

    def speed(angles: Angles) -> np.ndarray:
        there = study.at(angles).cam.flanks[flank]
        unit = angles.unit.conj() if study.sense > 0.0 else angles.unit
        return dot(there.profile_velocity, 1j * there.normal * unit)

    found = find_extremes(lambda angles: {"": speed(angles)}, study.program)[""]
    if found.low.value <= 0.0 <= found.high.value:
        worst = min(found.low, found.high, key=lambda extreme: abs(extreme.value))
        angle = float(np.rad2deg(worst.theta))
        face = study.design.drive.face
        raise NoCam(
            "the profile is undercut: it runs backwards, so no file can hold what would be cut",
            *size_entry(study.design.drive.cam, face.noun, face.radius_mm),
            [(angle, angle)],
        )


def _require_whole(study: Study, curve: ProfileCurve, rolling: float, face: Face) -> None:
    """The roller or shoe touches the whole profile."""
    found = hollow(curve, curve.exact, study.program, rolling, face.radius_mm)
    if found is not None:
        raise NoCam(
            f"the profile crosses itself: the {face.noun} cannot touch it",
            *size_entry(study.design.drive.cam, face.noun, face.radius_mm),
            [(found.begin, found.end)],
        )


def _require_room(study: Study, cutting: float) -> None:
    """The cutter is no wider than a groove."""
    faces = faces_of(study.design.drive.face, study.design.drive.cam)
    if OUTER not in faces:
        return
    width = faces[INNER].radius_mm + faces[OUTER].radius_mm
    if 2.0 * cutting > width:
        raise KindynaError(
            f"cutter: a radius of {cutting:g} mm does not go into the groove, which is {width:.9g} mm wide; "
            f"allowed: at most {0.5 * width:.9g} mm"
        )


def _require_reach(study: Study, curve: ProfileCurve, rolling: float, cutting: float) -> None:
    """The cutter touches the whole profile."""
    found = hollow(curve, curve.exact, study.program, rolling, cutting)
    if found is None:
        return
    concave = f"whose concave radius of curvature is {found.radius:.5g} mm there, " if np.isfinite(found.radius) else ""
    advice = (
        f"take one of at most {rounded_down(found.radius, 5):.5g} mm"
        if np.isfinite(found.radius)
        else "take a smaller one"
    )
    left = f"{found.left:.3g} mm" if found.left >= LITTLE else f"less than {LITTLE:g} mm"
    raise NoCam(
        f"a radius of {cutting:g} mm does not get into the profile, {concave}and leaves {left} standing",
        "cutter",
        advice,
        [(found.begin, found.end)],
    )


def fitted(
    study: Study, exact: Exact, request: ProfileRequest, least_mm: float = 0.0, rounding_mm: float = 0.0
) -> FittedCurve:
    """A curve sampled and fitted as the request says; rounding_mm: by which a file's points are off, at most, which is a part of the
    tolerance and of the deviation.

    Raises KindynaError where the points are too few or too many, or the tolerance is below ``least_mm`` or the curve's own digits.
    """
    curve, fit = ProfileCurve(exact, study.program.starts, study.program.ends), FITS[request.fit]
    by_tolerance = request.sampling == "tolerance"
    least = max(least_mm, CERTAIN * curve.size)
    if by_tolerance and not request.value >= least:
        raise KindynaError(
            f"tolerance {request.value:g} mm: below the certain digits of such a file; allowed: {rounded_up(least, 1):g} mm and more"
        )
    asked = request.value - rounding_mm if by_tolerance else request.value
    for _ in range(TRIES):
        checkpoint()
        at = points(curve, study.program, request.sampling, fit, asked)
        chain = fit.pieces(*at.spans(curve.length))
        deviation, place = largest(curve, chain, at.ends.s)
        deviation += rounding_mm
        if not by_tolerance or deviation <= request.value:
            break
        asked *= request.value / deviation * (1.0 - MISSED)
    else:
        raise KindynaError(
            f"tolerance {request.value:g} mm: not kept, {deviation:g} mm is reached; choose a larger one"
        )
    return FittedCurve(curve, at, chain.simplified(), deviation, complex(curve.at(np.array([place]))[0]))


def beside(study: Study, request: ProfileRequest, by_mm: float) -> Arcs | Cubics:
    """The curve that runs so far beside the profile on the follower's side, 0 being the profile itself and the roller's radius the
    pitch curve; sampled and fitted alike."""
    flank = flank_number(study, request)
    return fitted(study, offset(profile(study, flank), side(study, flank) * by_mm), request).chain
