"""The curve of a file: its points, the pieces between them, and its deviation from the exact curve."""

from __future__ import annotations

import numpy as np

from core.cam import INNER, OUTER, faces_of, form_row
from core.cam.shape import size_entry
from core.design import Face
from core.errors import KindynaError, NoCam
from core.frozen import frozen
from core.motion import Angles
from core.motion.extremes import find_extremes
from core.number_text import result_text, rounded_down, rounded_up
from core.numerics.derivatives import dot
from core.numerics.lazy import checkpoint
from core.output.files.fewest import largest_deviation
from core.output.files.profile_curve import (
    ExactCurve,
    ProfileCurve,
    exact_profile,
    find_uncut_hollow,
    follower_side,
    offset_curve,
)
from core.output.files.profile_fit import FITS, Arcs, Cubics
from core.output.files.profile_request import Points, ProfileRequest, points
from core.study import Study

CERTAIN = 1e-11  # relative to the curve's size: accuracy of its points
NEGLIGIBLE = 1e-6  # mm, below any measurement
TRIES, MARGIN = 6, 1e-4  # a tolerance that is just exceeded is reduced by this part, at most so often


@frozen(eq=False)
class FittedCurve:
    """A curve as a file describes it.

    Attributes
    ----------
    curve : the exact curve
    points : points on it
    chain : pieces from point to point
    deviation : largest distance of the exact curve from the chain [mm]
    worst : point of the exact curve with this distance [mm]
    """

    curve: ProfileCurve
    points: Points
    chain: Arcs | Cubics
    deviation: float
    worst: complex

    @property
    def count(self) -> int:
        """Number of points in the file; with tangent arcs also those where two arcs meet."""
        return int(self.chain.vertices.size)


def exact_curve(study: Study, request: ProfileRequest) -> ExactCurve:
    """Profile of a flank, or the path of the cutter's centre, in closed form.

    Raises
    ------
    NoSuchStage
        The design has no cam.
    KindynaError
        The cam does not have this flank.
    NoCam
        The profile has corners or cusps, crosses itself, or is too narrow for the cutter.
    """
    if study.has_surface:
        raise KindynaError(f"cam.kind = '{study.kind}': a cam in space has no profile in a plane; allowed: a disk cam")
    flank = flank_number(study, request)
    _require_smooth(study, flank)
    exact = exact_profile(study, flank)
    curve = ProfileCurve(exact, study.program.starts, study.program.ends)
    rolling, cutting = follower_side(study, flank), request.cutter_mm
    face = contact_face(study, request)
    if face.radius_mm > 0.0:
        _require_contact(study, curve, rolling, face)
    if cutting:
        _require_room(study, cutting)
        _require_reach(study, curve, rolling, cutting)
    return offset_curve(exact, rolling * cutting) if cutting else exact


def contact_face(study: Study, request: ProfileRequest) -> Face:
    """Face that touches the flank; its radius includes the play of the flank."""
    return faces_of(study.design.drive.face, study.design.drive.cam)[request.flank]


def flank_number(study: Study, request: ProfileRequest) -> int:
    """Index of the requested flank among the flanks of the cam. Raises NoSuchStage, KindynaError."""
    study.require_stage("cam")
    flanks = form_row(study.design.drive.cam.form).flanks
    if request.flank not in flanks:
        raise KindynaError(f"flank {request.flank!r}: this cam has none of that name; allowed: {', '.join(flanks)}")
    return flanks.index(request.flank)


def cutting_side(study: Study, request: ProfileRequest) -> float:
    """Side of the flank on which the cutter runs: +1 left of its tangent, -1 right."""
    return follower_side(study, flank_number(study, request))


def _require_smooth(study: Study, flank: int) -> None:
    """Raises NoCam for a corner (the motion's velocity jumps) or a cusp (the contact reverses along the profile)."""
    for i, join in enumerate(study.program.joins):
        if join.jumps[:2].any():
            angle = float(np.rad2deg(join.theta))
            raise NoCam(
                "the velocity jumps, so the profile has a corner",
                f"motion.segments[{(i + 1) % len(study.program.joins)}]",
                "choose a law, or an end condition, without a jump of velocity",
                [(angle, angle)],
            )

    def speed(angles: Angles) -> np.ndarray:
        samples = study.at(angles).cam.flanks[flank]
        unit = angles.unit.conj() if study.sense > 0.0 else angles.unit
        return dot(samples.profile_velocity, 1j * samples.normal * unit)

    extremes = find_extremes(lambda angles: {"": speed(angles)}, study.program)[""]
    if extremes.low.value <= 0.0 <= extremes.high.value:
        worst = min(extremes.low, extremes.high, key=lambda extreme: abs(extreme.value))
        angle = float(np.rad2deg(worst.theta))
        face = study.design.drive.face
        raise NoCam(
            "the profile is undercut: it runs backwards, so no file can describe the cut cam",
            *size_entry(study.design.drive.cam, face.noun, face.radius_mm),
            [(angle, angle)],
        )


def _require_contact(study: Study, curve: ProfileCurve, rolling: float, face: Face) -> None:
    """Raises NoCam where the roller or shoe does not touch the profile everywhere."""
    gap = find_uncut_hollow(curve, curve.exact, study.program, rolling, face.radius_mm)
    if gap is not None:
        raise NoCam(
            f"the profile crosses itself: the {face.noun} cannot touch it",
            *size_entry(study.design.drive.cam, face.noun, face.radius_mm),
            [(gap.begin, gap.end)],
        )


def _require_room(study: Study, cutting: float) -> None:
    """Raises KindynaError for a cutter wider than the groove."""
    faces = faces_of(study.design.drive.face, study.design.drive.cam)
    if OUTER not in faces:
        return
    width = faces[INNER].radius_mm + faces[OUTER].radius_mm
    if 2.0 * cutting > width:
        raise KindynaError(
            f"cutter: a radius of {cutting:g} mm does not go into the groove, which is {result_text(width, 6)} mm wide; "
            f"allowed: at most {result_text(0.5 * width, 6)} mm"
        )


def _require_reach(study: Study, curve: ProfileCurve, rolling: float, cutting: float) -> None:
    """Raises NoCam where the cutter does not touch the profile everywhere."""
    gap = find_uncut_hollow(curve, curve.exact, study.program, rolling, cutting)
    if gap is None:
        return
    concave = (
        f"whose concave radius of curvature is {result_text(gap.radius)} mm there, " if np.isfinite(gap.radius) else ""
    )
    remedy = (
        f"choose a radius of at most {result_text(rounded_down(gap.radius, 5), 5)} mm"
        if np.isfinite(gap.radius)
        else "choose a smaller radius"
    )
    uncut = f"{result_text(gap.uncut, 3)} mm" if gap.uncut >= NEGLIGIBLE else f"less than {NEGLIGIBLE:g} mm"
    raise NoCam(
        f"a radius of {cutting:g} mm does not reach all of the profile, {concave}and leaves {uncut} uncut",
        "cutter",
        remedy,
        [(gap.begin, gap.end)],
    )


def fit_curve(
    study: Study, exact: ExactCurve, request: ProfileRequest, least_mm: float = 0.0, rounding_mm: float = 0.0
) -> FittedCurve:
    """Sample a curve and fit pieces through the points, as the request states.

    Parameters
    ----------
    study : Study
    exact : ExactCurve
    request : ProfileRequest
    least_mm : float
        Least tolerance that the file can represent [mm].
    rounding_mm : float
        Largest error of the file by rounded coordinates [mm]; part of the tolerance and of the deviation.

    Returns
    -------
    FittedCurve

    Raises
    ------
    KindynaError
        The points are too few or too many, the tolerance is not reached, or it is below ``least_mm`` or the accuracy of the
        curve.
    """
    curve, fit = ProfileCurve(exact, study.program.starts, study.program.ends), FITS[request.fit]
    by_tolerance = request.sampling == "tolerance"
    least = max(least_mm, CERTAIN * curve.size)
    if by_tolerance and not request.value >= least:
        raise KindynaError(
            f"tolerance {request.value:g} mm: below the accuracy of such a file; allowed: {rounded_up(least, 1):g} mm and more"
        )
    value = request.value - rounding_mm if by_tolerance else request.value
    for _ in range(TRIES):
        checkpoint()
        sampled = points(curve, study.program, request.sampling, fit, value)
        chain = fit.pieces(*sampled.spans(curve.length))
        deviation, worst_at = largest_deviation(curve, chain, sampled.ends.s)
        deviation += rounding_mm
        if not by_tolerance or deviation <= request.value:
            break
        value *= request.value / deviation * (1.0 - MARGIN)
    else:
        raise KindynaError(
            f"tolerance {request.value:g} mm: not reached, the deviation is {deviation:g} mm; choose a larger tolerance"
        )
    return FittedCurve(curve, sampled, chain.simplified(), deviation, complex(curve.at(np.array([worst_at]))[0]))


def parallel_curve(study: Study, request: ProfileRequest, by_mm: float) -> Arcs | Cubics:
    """Curve at a distance [mm] from the profile on the follower's side, sampled and fitted as requested."""
    flank = flank_number(study, request)
    return fit_curve(
        study, offset_curve(exact_profile(study, flank), follower_side(study, flank) * by_mm), request
    ).chain
