"""Forms of a cam, one row each: the flanks in addition to the first, and the face on each flank.

A form of a disk cam is a class with its word in ``core.design.followers``, named by the cams of ``core.design.parts``
that may have it, and a row of ``FORMS``; a flank of a new name is drawn by a row of ``FLANK_PARTS`` in
the window's ``cam_parts``. Files, checks, certificate and explanations follow from these.

Cams in space, barrel and globoidal, are no forms of a disk cam: see ``core.spatial``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import degrees
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from core.cam.faces import LeastAt, row_of
from core.cam.shape import ENTRIES, INNER, OUTER, SECOND, CamShape, Flank, SecondEntry, round_envelope
from core.design import Conjugate, Face, Groove, LinkageConjugate, Open, Roller
from core.errors import NoCam
from core.findings import ERROR, WARNING, Finding
from core.followers import SECOND_ROLLER
from core.frozen import frozen
from core.mechanism.kinematics import FRAME, REVOLUTE, SLIDING, Kinematics, Pose
from core.mechanism.mechanism import body_name
from core.motion import EPS, TURN, Angles
from core.motion.extremes import Extreme, Extremes
from core.numerics.derivatives import dot

# -- forms of a cam, one row each -------------------------------------------------------------------------------


class FormRow(NamedTuple):
    """Properties of a form; ``form`` is its table of the design.

    Attributes
    ----------
    flanks : names of its flanks, in the order of ``CamShape.flanks``
    further : kinematics, face, cam, sense of rotation -> the flanks besides the first; raises NoCam
    faces : face, form -> the face that touches each flank: on the outer flank of a groove a roller larger by the play,
        on the second cam of a conjugate pair the second roller
    sides : what drives the follower, in words, where two flanks hold it: at the first flank, at the second
    """

    flanks: tuple[str, ...]
    further: Callable[[Kinematics, Any, Any, float], tuple[Flank, ...]]
    faces: Callable[[Any, Any], tuple[Face, ...]]
    sides: tuple[str, ...] = ()


def _outer(kinematics: Kinematics, face: Roller, cam: Any, rotation_sign: float) -> tuple[Flank, ...]:
    """R - (Rr + play) n: the roller's centre is on the pitch curve of the inner flank."""
    offset = -1e-3 * (face.radius_mm + cam.form.play_mm)
    return (round_envelope(kinematics, face, cam, rotation_sign, offset, OUTER),)


def _second(kinematics: Kinematics, face: Roller, cam: Any, rotation_sign: float) -> tuple[Flank, ...]:
    """R₂ + (Rr₂ + play) n₂ from the second roller's relative motion, by the equations of the first."""
    roller = Roller(cam.form.second.roller_radius_mm)
    if isinstance(cam.form, LinkageConjugate):
        at_second = second_kinematics(kinematics, body_name(cam.form.second.link), cam.form.second.point)
    else:
        at_second = second_kinematics(kinematics, kinematics.carrier, SECOND_ROLLER)
    offset = 1e-3 * (roller.radius_mm + cam.form.play_mm)
    return (round_envelope(at_second, roller, cam, rotation_sign, offset, SECOND),)


def second_kinematics(kinematics: Kinematics, carrier: str, point: str) -> Kinematics:
    """The same mechanism for a cam that acts on another point, of the body ``carrier``."""
    body = kinematics.bodies[carrier]
    local = body.points[point]
    pose = Pose(body.fixed_point(local), body.turn, MappingProxyType({point: 0j}), lambda: body.unit)

    def travel() -> np.ndarray:
        path = kinematics.by_driver[carrier].fixed_point(local)[1]
        return np.asarray(path / np.abs(path))

    bodies = {
        name: pose for name, pose in kinematics.bodies.items() if name != kinematics.follower_body or name == carrier
    }
    grounds = (name for name, pair in kinematics.pairs.items() if {pair.on, pair.body} == {FRAME, carrier})
    return Kinematics(
        kinematics.motion,
        MappingProxyType({**bodies, SECOND: pose}),
        kinematics.pairs,
        kinematics.dyads,
        kinematics.output,
        SECOND,
        next(grounds, ""),
        travel=travel,
        coordinates=lambda: kinematics.coordinates,
        base=lambda: kinematics.base,
        residual=lambda: kinematics.residual,
        condition=lambda: kinematics.condition,
        singular=lambda: kinematics.singular,
        transmission=lambda: kinematics.transmission,
        carrier=carrier,
        by_driver=lambda: kinematics.by_driver,
    )


def velocity_by_driver(kinematics: Kinematics, flank: Flank) -> np.ndarray:
    """Velocity of the reference point of a flank by the driver's coordinate; it exists in dwells too.

    Parameters
    ----------
    kinematics : Kinematics
    flank : Flank

    Returns
    -------
    ndarray (n,) complex [m/rad or dimensionless]
        Per unit of the driver's coordinate.
    """
    pose = kinematics.by_driver[flank.body]
    return np.asarray(pose.origin[1] + 1j * pose.turn[1] * (flank.reference - pose.origin[0]))


def forward_push(kinematics: Kinematics, flank: Flank) -> np.ndarray:
    """Force on the driver along its motion per newton on a flank's roller, -n·v.

    v is the unit vector of the velocity of the roller's centre as the driver's coordinate grows.

    Parameters
    ----------
    kinematics : Kinematics
    flank : Flank

    Returns
    -------
    ndarray (n,), dimensionless
    """
    velocity = velocity_by_driver(kinematics, flank)
    return -dot(flank.normal, velocity) / np.abs(velocity)


def _grooved(face: Roller, form: Groove) -> tuple[Face, ...]:
    return face, Roller(face.radius_mm + form.play_mm)


def _paired(face: Roller, form: Conjugate | LinkageConjugate) -> tuple[Face, ...]:
    return face, Roller(form.second.roller_radius_mm + form.play_mm)


_PAIR = FormRow((INNER, SECOND), _second, _paired, ("first roller", "second roller"))

FORMS: Mapping[type, FormRow] = MappingProxyType(
    {
        Open: FormRow((INNER,), lambda kinematics, face, cam, rotation_sign: (), lambda face, form: (face,)),
        Groove: FormRow((INNER, OUTER), _outer, _grooved, ("inner flank", "outer flank")),
        Conjugate: _PAIR,
        LinkageConjugate: _PAIR,
    }
)


def form_row(form: Any) -> FormRow:
    """The row of a form."""
    return FORMS[type(form)]


def envelope(kinematics: Kinematics, face: Any, cam: Any, rotation_sign: float) -> CamShape:
    """The cam that moves the follower body of the kinematics, with all its flanks.

    rotation_sign: d = +1 counter-clockwise, -1 clockwise. Raises NoCam where a flank does not exist.
    """
    shape = row_of(face).envelope(kinematics, face, cam, rotation_sign)
    further = form_row(cam.form).further(kinematics, face, cam, rotation_sign)
    return CamShape((*shape.flanks, *further), rotation_sign) if further else shape


def faces_of(face: Any, cam: Any) -> Mapping[str, Face]:
    """Name of a flank -> the face that touches it."""
    row = form_row(cam.form)
    return MappingProxyType(dict(zip(row.flanks, row.faces(face, cam.form), strict=True)))


# -- limits of the flanks besides the first ---------------------------------------------------------------------


ExtremesByName = Mapping[str, Extremes]
_RADIUS = "cam.second.roller_radius_mm"


class FlankRow(NamedTuple):
    """Limits of a flank besides the first.

    Attributes
    ----------
    limits : quantities whose refined extremes its findings are taken from
    undercut : extremes, face -> whether it has a cusp, or crosses itself where it is curved too much
    findings : extremes, face, cam -> the findings besides the pressure angle
    pressure : name of its pressure angle, where it differs from the first flank's
    """

    limits: tuple[str, ...]
    undercut: Callable[[ExtremesByName, Any], bool]
    findings: Callable[[ExtremesByName, Any, Any], list[Finding]]
    pressure: str = ""


def _outer_undercut(extremes: ExtremesByName, face: Any) -> bool:
    """Whether the pitch curve is so concave that the roller with its play does not fit: κ_p (Rr + play) ≤ -1."""
    return 1e-3 * face.radius_mm * extremes["pitch_curvature"].low.value <= -1.0


def _outer_findings(extremes: ExtremesByName, face: Any, cam: Any) -> list[Finding]:
    if not _outer_undercut(extremes, face):
        return []
    concave = extremes["pitch_curvature"].low
    values = {"pitch_radius_mm": -1e3 / concave.value, "roller_radius_mm": face.radius_mm}
    return [Finding("outer-undercut", ERROR, ENTRIES[type(cam)].size, degrees(concave.theta), values)]


def _second_undercut(extremes: ExtremesByName, face: Any) -> bool:
    return 1e-3 * face.radius_mm * extremes["second_pitch_curvature"].high.value >= 1.0


def _second_findings(extremes: ExtremesByName, face: Any, cam: Any) -> list[Finding]:
    """Findings for undercut, and for a second roller that meets shaft or hub, or does not push back."""
    findings = []
    if _second_undercut(extremes, face):
        sharpest = extremes["second_pitch_curvature"].high
        values: dict[str, float | str] = {"pitch_radius_mm": 1e3 / sharpest.value, "roller_radius_mm": face.radius_mm}
        findings.append(Finding("second-undercut", ERROR, _RADIUS, degrees(sharpest.theta), values))
    nearest = extremes["second_roller_distance"].low
    diameter, what = (cam.bore_mm, "bore") if cam.hub_mm is None else (cam.hub_mm, "hub")
    if diameter is not None and 2e3 * nearest.value <= diameter:
        values = {"distance_mm": 1e3 * nearest.value, "radius_mm": 0.5 * diameter, "what": what}
        findings.append(Finding("second-roller-meets-hub", ERROR, f"cam.{what}_mm", degrees(nearest.theta), values))
    push = extremes["second_push"].high
    if push.value >= 0.0:
        findings.append(Finding("second-roller-pushes-along", ERROR, "cam.form", degrees(push.theta), {}))
    return findings


FLANK_ROWS: Mapping[str, FlankRow] = MappingProxyType(
    {
        OUTER: FlankRow(("pitch_curvature",), _outer_undercut, _outer_findings),
        SECOND: FlankRow(
            ("second_pressure_angle", "second_pitch_curvature", "second_roller_distance", "second_push"),
            _second_undercut, _second_findings, "second_pressure_angle",
        ),
    }
)  # fmt: skip


def further_flanks(face: Any, cam: Any) -> list[tuple[str, FlankRow, Face]]:
    """The flanks of a cam besides the first: name, row, and the face that touches it."""
    faces = faces_of(face, cam)
    return [(name, FLANK_ROWS[name], faces[name]) for name in form_row(cam.form).flanks[1:]]


# -- walls of a groove ------------------------------------------------------------------------------------------


POINTS = 360  # of the turn, at which near stretches are searched
GRID = 4  # points on either side of the middle of the search
SHRINK = 0.3  # factor on the width of the search per step
FINEST = 1e-9  # [rad]

ShapeAt = Callable[[np.ndarray], CamShape]


@frozen
class Wall:
    """Wall between two stretches of a groove: thickness [m], negative where they overlap, and two cam angles [rad]."""

    thickness: float
    first: float
    second: float


def thinnest_wall(shape_at: ShapeAt, coarse: CamShape, angles: Angles) -> Wall | None:
    """The thinnest wall of negative thickness between two stretches that face each other; None without one.

    Two stretches face each other where the distance D of their pitch curves is a local minimum of both cam angles:
    there it is normal to both. The thickness is D less Rr on the side of an inner flank and Rr + play on that of an
    outer one. shape_at: the cam at any cam angles; coarse, angles: at equally spaced ones, of which a part is used.
    """
    step = max(1, angles.theta.size // POINTS)
    theta = angles.theta[::step]
    pitch, _, reach = _pitch(coarse, angles, step)
    distance = np.abs(pitch[None, :] - pitch[:, None])
    rows, columns = np.nonzero(np.triu(distance <= 2.0 * max(reach), 1))
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        for sign in (1, -1):
            neighbour = distance[(rows + sign * down) % theta.size, (columns + sign * right) % theta.size]
            lowest = distance[rows, columns] <= neighbour
            rows, columns = rows[lowest], columns[lowest]
    if not rows.size:
        return None
    least = int(np.argmin(distance[rows, columns]))
    i, j = rows[least], columns[least]
    wall = _refine_wall(shape_at, float(theta[i]), float(theta[j]), TURN * step / angles.theta.size)
    return (
        Wall(wall.thickness, min(wall.first, wall.second), max(wall.first, wall.second))
        if wall.thickness <= 0.0
        else None
    )


def _pitch(shape: CamShape, angles: Angles, step: int = 1) -> tuple[np.ndarray, np.ndarray, tuple[float, float]]:
    """Pitch curve and normal towards the inner flank in the cam's frame, and the flanks' distances from the curve."""
    inner = shape.flank
    to_cam_frame = angles.unit.conj() if shape.rotation_sign > 0.0 else angles.unit
    return inner.pitch[::step], (inner.normal * to_cam_frame)[::step], (inner.offset, -shape.only(OUTER).flank.offset)


def _thickness(gap: np.ndarray, first: np.ndarray, second: np.ndarray, reach: tuple[float, float]) -> np.ndarray:
    """Thickness of the wall between points of the pitch curve, from their differences ``gap`` (m, n) and normals."""
    inner, outer = reach
    first_reach = np.where(dot(first[:, None], gap) > 0.0, inner, outer)
    second_reach = np.where(dot(second[None, :], gap) < 0.0, inner, outer)
    return np.asarray(np.abs(gap) - first_reach - second_reach)


def _refine_wall(shape_at: ShapeAt, first: float, second: float, width: float) -> Wall:
    """The least distance near two cam angles, by a grid that shrinks around it."""
    steps = np.arange(-GRID, GRID + 1) / GRID
    thickness = np.inf
    while width > FINEST:
        theta = np.concatenate((first + width * steps, second + width * steps)) % TURN
        shape = shape_at(theta)
        pitch, normals, reach = _pitch(shape, Angles(theta, np.zeros(theta.size, dtype=int)))
        half = steps.size
        gap = pitch[None, half:] - pitch[:half, None]
        i, j = np.unravel_index(int(np.argmin(np.abs(gap))), gap.shape)
        thickness = float(_thickness(gap, normals[:half], normals[half:], reach)[i, j])
        first, second, width = float(theta[i]), float(theta[half + j]), width * SHRINK
    return Wall(thickness, first, second)


def wall_findings(wall: Wall | None, cam: Any) -> list[Finding]:
    """Finding where two stretches of a groove overlap."""
    if wall is None:
        return []
    values: dict[str, float | str] = {"overlap_mm": -1e3 * wall.thickness, "other_deg": degrees(wall.second)}
    return [Finding("groove-flanks-meet", ERROR, ENTRIES[type(cam)].size, degrees(wall.first), values)]


# -- limits of a cam --------------------------------------------------------------------------------------------


# typical limits in machine shops: VDI 2142, Norton ch. 7; by the pair that holds the follower
PRESSURE_SOURCE = "VDI 2142; Norton ch. 7"
PRESSURE_LIMITS: Mapping[str, float] = MappingProxyType({SLIDING: 30.0, REVOLUTE: 45.0})

ROUNDING = 1e-12  # relative accuracy of a channel: a radius computed for the limit satisfies it
NO_DRIVE = 89.0  # [deg] from which on no force of the cam moves the follower


def findings(extremes: Mapping[str, Extremes], ground: str, face: Any, cam: Any, least_at: LeastAt) -> list[Finding]:
    """Findings of the pressure angle [rad] and of the face's quantities, from their refined extremes.

    ground: kind of the pair that joins the follower to the frame; least_at: quantity, base radius [mm] -> its refined
    least value at this base radius.
    """
    result = []
    worst, limit = extremes["pressure_angle"].high, PRESSURE_LIMITS[ground]
    angle = degrees(worst.value)
    if angle > limit * (1.0 + ROUNDING):
        values: dict[str, float | str] = {"value": angle, "limit": limit}
        severity = ERROR if angle > NO_DRIVE else WARNING
        row, (what, field) = ENTRIES[type(cam)], row_of(face).steep
        if what:
            values |= {"face": face.face, "what": what}
        result.append(Finding(row.pressure, severity, field or row.size, degrees(worst.theta), values))
    return result + row_of(face).findings(extremes, face, cam, least_at)


def limits_of(face: Any, cam: Any) -> tuple[str, ...]:
    """Quantities whose refined extremes the findings of a cam need; the radius where hub or bore are known."""
    further = [name for _, row, _ in further_flanks(face, cam) for name in row.limits]
    inside = [] if cam.hub_mm is cam.bore_mm is None else ["radius"]
    return tuple(dict.fromkeys((*row_of(face).limits, *further, *inside)))


def further_findings(
    extremes: Mapping[str, Extremes], grounds: Mapping[str, str], face: Any, cam: Any, second: SecondEntry | None
) -> list[Finding]:
    """Findings of the flanks besides the first.

    grounds: flank -> kind of the pair that joins its roller's body to the frame; second: entry of the second roller.
    """
    findings = []
    for name, row, face_on in further_flanks(face, cam):
        if row.pressure:
            worst, limit = extremes[row.pressure].high, PRESSURE_LIMITS[grounds[name]]
            angle = degrees(worst.value)
            if angle > limit * (1.0 + ROUNDING) and second is not None:
                severity = ERROR if angle > NO_DRIVE else WARNING
                values: dict[str, float | str] = {"value": angle, "limit": limit, "remedy": second.remedy}
                findings.append(Finding(f"{name}-pressure-angle", severity, second.field, degrees(worst.theta), values))
        findings += row.findings(extremes, face_on, cam)
    return findings


def undercut(extremes: Mapping[str, Extremes], flank: str, face: Any, cam: Any) -> bool:
    """Whether a flank has a cusp, or crosses itself where it is curved too much for the face that touches it."""
    for name, row, face_on in further_flanks(face, cam):
        if name == flank:
            return row.undercut(extremes, face_on)
    return row_of(face).undercut(extremes, face)


def require_drivable(kinematics: Kinematics, noun: str, shape: CamShape) -> None:
    """Raise NoCam where the distance of a roller, or of another face named ``noun``, from the cam centre is constant.

    Then the cam is a circle about its centre, every contact normal passes through it, and no torque of the cam moves
    the linkage. The second roller of a conjugate pair is checked too.
    """
    rows = [(noun, "cam.point", kinematics.follower.origin[0], kinematics.travel)]
    rows += [
        ("second roller", "cam.second.point", flank.reference, velocity_by_driver(kinematics, flank))
        for flank in shape.flanks
        if flank.name == SECOND
    ]
    for name, field, reference, direction in rows:
        with np.errstate(invalid="ignore", divide="ignore"):  # no travel where the roller stands still
            radial = np.abs(dot(direction / np.abs(direction), reference)) / np.abs(reference)
        if not (radial > 16.0 * EPS * kinematics.condition).any():
            raise NoCam(
                f"the {name} keeps its distance from the cam centre, so no cam can move it",
                field,
                "choose another point",
            )


# -- smallest radii of curvature of profile and pitch curve -----------------------------------------------------


STRAIGHT = 1e6  # [m] least radius of a curve that counts as straight
PITCH, FLAT = "pitch_curvature", "profile_radius"
_PITCH_OF: Mapping[str, str] = {INNER: PITCH, OUTER: PITCH, SECOND: f"{SECOND}_{PITCH}"}


@frozen
class Radius:
    """A smallest radius of curvature [m] with its cam angle.

    Attributes
    ----------
    curve : ``profile`` of the first cam, ``pitch``, ``outer`` flank of a groove, ``second`` profile, ``second_pitch``
    is_concave : where the cam's material is concave, so that a cutter must fit in; otherwise where it is convex
    smallest : radius [m] and cam angle
    """

    curve: str
    is_concave: bool
    smallest: Extreme

    @property
    def name(self) -> str:
        """Name of the quantity, as ``convex_radius`` or ``pitch_concave_radius``; the profile's has no prefix."""
        kind = "concave_radius" if self.is_concave else "convex_radius"
        return kind if self.curve == "profile" else f"{self.curve}_{kind}"

    @property
    def is_on_profile(self) -> bool:
        """Whether it belongs to a profile, not to a pitch curve."""
        return "pitch" not in self.curve


def smallest_radii(extremes: Mapping[str, Extremes], face: Any, cam: Any) -> tuple[Radius, ...]:
    """Smallest radius of each curve where it is convex and where it is concave, as far as it is so anywhere.

    A profile has the radius ρ_p - Rr where its pitch curve of radius ρ_p is convex, ρ_p + Rr where that is concave, so
    that its smallest radii have the same cam angles. The material of a groove's outer flank is on the other side: it is
    concave, with ρ_p + Rr + play, where the pitch curve is convex. The radius is 0 at a cusp.
    """
    if FLAT in row_of(face).limits:
        return (Radius("profile", False, _at_least_zero(extremes[FLAT].low)),)
    radii: list[Radius] = []
    for name, touching in faces_of(face, cam).items():
        curvature, face_radius = extremes[_PITCH_OF[name]], 1e-3 * touching.radius_mm
        curve = {INNER: "profile"}.get(name, name)
        side = -1.0 if name == OUTER else 1.0
        for is_convex, end, sign in ((True, curvature.high, 1.0), (False, curvature.low, -1.0)):
            if sign * end.value * STRAIGHT <= 1.0:
                continue
            pitch = Extreme(sign / end.value, end.theta)
            if name != OUTER:
                radii.append(Radius("pitch" if name == INNER else f"{name}_pitch", not is_convex, pitch))
            profile = _at_least_zero(Extreme(pitch.value - side * sign * face_radius, end.theta))
            radii.append(Radius(curve, is_convex == (name == OUTER), profile))
    return tuple(sorted(radii, key=lambda radius: ("pitch" in radius.curve, radius.curve != "profile")))


def _at_least_zero(extreme: Extreme) -> Extreme:
    return Extreme(max(extreme.value, 0.0), extreme.theta)


def smallest_concave(radii: tuple[Radius, ...]) -> Radius | None:
    """The smallest concave radius of all profiles; None where none is concave."""
    concave = (radius for radius in radii if radius.is_on_profile and radius.is_concave)
    return min(concave, key=lambda radius: radius.smallest.value, default=None)
