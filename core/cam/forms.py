"""Forms of a cam, one row each: which flanks there are besides the first, and what touches each.

A form of a disk cam is its class with its word in ``core.design.forms``, named by the cams of ``core.design.parts`` that may have it, and
its row here; a flank of a new name is drawn by a row of ``FURTHER`` in the window's ``cam_parts``. What reads, proves, writes and
explains it follows from these.

A cam that does not turn in the plane of its follower, as a barrel, which slides past it once it is unrolled, is no further row here
alone. How a disk moves past the follower is said by ``relative_motion``, ``turned_back`` and ``sliding`` of ``core.cam.shape``, by the
turning of the face (``rate``) in ``core.cam.flat_face``, by ``_require_cam`` of ``round_face`` and ``flat_face`` and by
``cam_follower_centre``: these would ask the cam. Crossings, walls, the profile's files and its picture take the closed curve about the
origin that a disk has; a cam of another shape brings its own.
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
from core.motion.extremes import Extreme, Range
from core.numerics.derivatives import dot

# -- forms of a cam, one row each -------------------------------------------------------------------------------


class FormRow(NamedTuple):
    """What every form fills; ``form`` is its part of the design.

    flanks     names of its flanks, in the order of ``CamShape.flanks``
    further    kinematics, face, cam, sense -> the flanks besides the first; raises NoCam
    faces      face, form -> what touches each flank: of a groove the outer flank is touched by a roller that is larger by the
               play, of a conjugate pair the second cam by the second roller
    sides      what carries the follower, as messages say it, where it is held from both sides: by the first flank, by the other
    """

    flanks: tuple[str, ...]
    further: Callable[[Kinematics, Any, Any, float], tuple[Flank, ...]]
    faces: Callable[[Any, Any], tuple[Face, ...]]
    sides: tuple[str, ...] = ()


def _outer(kinematics: Kinematics, face: Roller, cam: Any, sense: float) -> tuple[Flank, ...]:
    """R - (Rr + play) n: the roller's centre keeps to the pitch curve of the inner flank."""
    offset = -1e-3 * (face.radius_mm + cam.form.play_mm)
    return (round_envelope(kinematics, face, cam, sense, offset, OUTER),)


def _second(kinematics: Kinematics, face: Roller, cam: Any, sense: float) -> tuple[Flank, ...]:
    """R₂ + (Rr₂ + play) n₂, of the second roller's own relative motion, by the equations of the first."""
    roller = Roller(cam.form.second.roller_radius_mm)
    there = second_kinematics(kinematics, *_place(cam.form))
    return (round_envelope(there, roller, cam, sense, 1e-3 * (roller.radius_mm + cam.form.play_mm), SECOND),)


def _place(form: Conjugate | LinkageConjugate) -> tuple[str, str]:
    """Body and point of the second roller's centre; the body's name empty where it is the one that carries the first."""
    return (
        (body_name(form.second.link), form.second.point) if isinstance(form, LinkageConjugate) else ("", SECOND_ROLLER)
    )


def second_kinematics(kinematics: Kinematics, body: str, point: str) -> Kinematics:
    """The same mechanism, as seen by a cam that acts on another point."""
    carrier = body or kinematics.carrier
    carrying = kinematics.bodies[carrier]
    at = carrying.points[point]
    pose = Pose(carrying.fixed_point(at), carrying.turn, MappingProxyType({point: 0j}), lambda: carrying.unit)

    def travel() -> np.ndarray:
        path = kinematics.by_driver[carrier].fixed_point(at)[1]
        return np.asarray(path / np.abs(path))

    bodies = {
        name: each for name, each in kinematics.bodies.items() if name != kinematics.follower_body or name == carrier
    }
    held = (name for name, pair in kinematics.pairs.items() if {pair.on, pair.body} == {FRAME, carrier})
    return Kinematics(
        kinematics.motion,
        MappingProxyType({**bodies, SECOND: pose}),
        kinematics.pairs,
        kinematics.dyads,
        kinematics.output,
        SECOND,
        next(held, ""),
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


def path_by_driver(kinematics: Kinematics, flank: Flank) -> np.ndarray:
    """Velocity (n,) complex of the reference point of a flank by the driver's coordinate; it exists in dwells too."""
    pose = kinematics.by_driver[flank.body]
    return np.asarray(pose.origin[1] + 1j * pose.turn[1] * (flank.reference - pose.origin[0]))


def forward_push(kinematics: Kinematics, flank: Flank) -> np.ndarray:
    """How much of one newton on a flank's roller pushes the driver forward (n,): -n·v, v the unit vector of where the roller's
    centre goes as the driver's coordinate grows."""
    path = path_by_driver(kinematics, flank)
    return -dot(flank.normal, path) / np.abs(path)


def _grooved(face: Roller, form: Groove) -> tuple[Face, ...]:
    return face, Roller(face.radius_mm + form.play_mm)


def _paired(face: Roller, form: Conjugate | LinkageConjugate) -> tuple[Face, ...]:
    return face, Roller(form.second.roller_radius_mm + form.play_mm)


_PAIR = FormRow((INNER, SECOND), _second, _paired, ("first roller", "second roller"))

FORMS: Mapping[type, FormRow] = MappingProxyType(
    {
        Open: FormRow((INNER,), lambda kinematics, face, cam, sense: (), lambda face, form: (face,)),
        Groove: FormRow((INNER, OUTER), _outer, _grooved, ("inner flank", "outer flank")),
        Conjugate: _PAIR,
        LinkageConjugate: _PAIR,
    }
)


def form_row(form: Any) -> FormRow:
    """The row of a form."""
    return FORMS[type(form)]


def envelope(kinematics: Kinematics, face: Any, cam: Any, sense: float) -> CamShape:
    """The cam that moves the follower body of the kinematics; sense: d = +1 counter-clockwise, -1 clockwise. Raises NoCam."""
    shape = row_of(face).envelope(kinematics, face, cam, sense)
    further = form_row(cam.form).further(kinematics, face, cam, sense)
    return CamShape((*shape.flanks, *further), sense) if further else shape


def faces_of(face: Any, cam: Any) -> Mapping[str, Face]:
    """What touches each flank, by the flank's name."""
    row = form_row(cam.form)
    return MappingProxyType(dict(zip(row.flanks, row.faces(face, cam.form), strict=True)))


# -- limits of the flanks that a cam may have besides its first -------------------------------------------------


Extremes = Mapping[str, Range]
_RADIUS = "cam.second.roller_radius_mm"


class FlankRow(NamedTuple):
    """limits    quantities whose refined extremes its findings are taken from
    undercut  extremes, what touches it -> whether it has a cusp, or crosses itself where it is curved too much
    findings  extremes, what touches it, cam -> what is exceeded, the pressure angle aside
    pressure  its pressure angle, where that is another than the first flank's
    """

    limits: tuple[str, ...]
    undercut: Callable[[Extremes, Any], bool]
    findings: Callable[[Extremes, Any, Any], list[Finding]]
    pressure: str = ""


def _outer_undercut(extremes: Extremes, face: Any) -> bool:
    """Whether the pitch curve is somewhere so hollow that the roller with its play does not fit: κ_p (Rr + play) ≤ -1."""
    return 1e-3 * face.radius_mm * extremes["pitch_curvature"].low.value <= -1.0


def _outer_findings(extremes: Extremes, face: Any, cam: Any) -> list[Finding]:
    if not _outer_undercut(extremes, face):
        return []
    hollow = extremes["pitch_curvature"].low
    values = {"pitch_radius_mm": -1e3 / hollow.value, "roller_radius_mm": face.radius_mm}
    return [Finding("outer-undercut", ERROR, ENTRIES[type(cam)].size, degrees(hollow.theta), values)]


def _second_undercut(extremes: Extremes, face: Any) -> bool:
    return 1e-3 * face.radius_mm * extremes["second_pitch_curvature"].high.value >= 1.0


def _second_findings(extremes: Extremes, face: Any, cam: Any) -> list[Finding]:
    """Undercut, a second roller that meets the shaft or the first cam's hub, and one that does not push back."""
    found = []
    if _second_undercut(extremes, face):
        sharpest = extremes["second_pitch_curvature"].high
        values: dict[str, float | str] = {"pitch_radius_mm": 1e3 / sharpest.value, "roller_radius_mm": face.radius_mm}
        found.append(Finding("second-undercut", ERROR, _RADIUS, degrees(sharpest.theta), values))
    nearest = extremes["second_roller_distance"].low
    diameter, what = (cam.bore_mm, "bore") if cam.hub_mm is None else (cam.hub_mm, "hub")
    if diameter is not None and 2e3 * nearest.value <= diameter:
        values = {"distance_mm": 1e3 * nearest.value, "radius_mm": 0.5 * diameter, "what": what}
        found.append(Finding("second-roller-meets-hub", ERROR, f"cam.{what}_mm", degrees(nearest.theta), values))
    along = extremes["second_push"].high
    if along.value >= 0.0:
        found.append(Finding("second-roller-pushes-along", ERROR, "cam.form", degrees(along.theta), {}))
    return found


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
    """The flanks of a cam besides the first: name, row, and what touches it."""
    faces = faces_of(face, cam)
    return [(name, FLANK_ROWS[name], faces[name]) for name in form_row(cam.form).flanks[1:]]


# -- walls of a groove ------------------------------------------------------------------------------------------


POINTS = 360  # of the turn, at which stretches that come near are looked for
GRID = 4  # points on either side of the middle, as the search closes in
CLOSER = 0.3  # of its width each time
FINEST = 1e-9  # [rad]

ShapeAt = Callable[[np.ndarray], CamShape]


@frozen
class Wall:
    """What is left between two stretches of a groove: its thickness [m], less than 0 where they run into each other, and the two
    cam angles [rad]."""

    thickness: float
    first: float
    second: float


def thinnest_wall(shape_at: ShapeAt, found: CamShape, angles: Angles) -> Wall | None:
    """The thinnest wall that is gone, of two stretches that face each other; None where all stand.

    Two stretches face each other where the distance D of their pitch curves is a local minimum of both cam angles: there it is
    normal to both. Between them stand D less Rr on the side of each inner flank and Rr + play on that of each outer one.
    shape_at: the cam at any cam angles; found, angles: at equally spaced ones, of which some are taken.
    """
    step = max(1, angles.theta.size // POINTS)
    theta = angles.theta[::step]
    place, _, reach = _pitch(found, angles, step)
    distance = np.abs(place[None, :] - place[:, None])
    rows, columns = np.nonzero(np.triu(distance <= 2.0 * max(reach), 1))
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        for sign in (1, -1):
            beside = distance[(rows + sign * down) % theta.size, (columns + sign * right) % theta.size]
            lowest = distance[rows, columns] <= beside
            rows, columns = rows[lowest], columns[lowest]
    if not rows.size:
        return None
    at = int(np.argmin(distance[rows, columns]))
    i, j = rows[at], columns[at]
    wall = _refined(shape_at, float(theta[i]), float(theta[j]), TURN * step / angles.theta.size)
    return (
        Wall(wall.thickness, min(wall.first, wall.second), max(wall.first, wall.second))
        if wall.thickness <= 0.0
        else None
    )


def _pitch(shape: CamShape, angles: Angles, step: int = 1) -> tuple[np.ndarray, np.ndarray, tuple[float, float]]:
    """Pitch curve and normal towards the inner flank, both in the cam's own frame, and how far the flanks are from it."""
    inner = shape.flank
    back = angles.unit.conj() if shape.sense > 0.0 else angles.unit
    return inner.pitch[::step], (inner.normal * back)[::step], (inner.offset, -shape.only(OUTER).flank.offset)


def _thickness(near: np.ndarray, one: np.ndarray, other: np.ndarray, reach: tuple[float, float]) -> np.ndarray:
    """Of the wall between points of the pitch curve with the differences ``near`` (m, n) and normals (m,), (n,)."""
    inner, outer = reach
    first = np.where(dot(one[:, None], near) > 0.0, inner, outer)
    second = np.where(dot(other[None, :], near) < 0.0, inner, outer)
    return np.asarray(np.abs(near) - first - second)


def _refined(shape_at: ShapeAt, first: float, second: float, width: float) -> Wall:
    """The least distance near two cam angles, by a grid that closes in on it."""
    steps = np.arange(-GRID, GRID + 1) / GRID
    thickness = np.inf
    while width > FINEST:
        theta = np.concatenate((first + width * steps, second + width * steps)) % TURN
        shape = shape_at(theta)
        place, towards, reach = _pitch(shape, Angles(theta, np.zeros(theta.size, dtype=int)))
        half = steps.size
        near = place[None, half:] - place[:half, None]
        i, j = np.unravel_index(int(np.argmin(np.abs(near))), near.shape)
        thickness = float(_thickness(near, towards[:half], towards[half:], reach)[i, j])
        first, second, width = float(theta[i]), float(theta[half + j]), width * CLOSER
    return Wall(thickness, first, second)


def wall_findings(wall: Wall | None, cam: Any) -> list[Finding]:
    """Two stretches of a groove that run into each other."""
    if wall is None:
        return []
    values: dict[str, float | str] = {"overlap_mm": -1e3 * wall.thickness, "other_deg": degrees(wall.second)}
    return [Finding("groove-flanks-meet", ERROR, ENTRIES[type(cam)].size, degrees(wall.first), values)]


# -- limits of a cam --------------------------------------------------------------------------------------------


# usual limits for cams in machine shops: VDI 2142, Norton ch. 7; by the pair that holds the follower
PRESSURE_SOURCE = "VDI 2142; Norton ch. 7"
PRESSURE_LIMITS: Mapping[str, float] = MappingProxyType({SLIDING: 30.0, REVOLUTE: 45.0})

ROUNDING = 1e-12  # relative accuracy of a channel: a radius found for the limit itself does not exceed it
NO_DRIVE = 89.0  # from here on the cam cannot move the follower, whatever the force


def findings(extremes: Mapping[str, Range], ground: str, face: Any, cam: Any, least_at: LeastAt) -> list[Finding]:
    """What the refined extremes of pressure angle [rad] and of the face's own quantities exceed; ground: kind of the pair
    that holds the follower; least_at: quantity, base radius [mm] -> its refined least value with that one."""
    found = []
    worst, limit = extremes["pressure_angle"].high, PRESSURE_LIMITS[ground]
    angle = degrees(worst.value)
    if angle > limit * (1.0 + ROUNDING):
        values: dict[str, float | str] = {"value": angle, "limit": limit}
        severity = ERROR if angle > NO_DRIVE else WARNING
        row, (what, field) = ENTRIES[type(cam)], row_of(face).steep
        if what:
            values |= {"face": face.face, "what": what}
        found.append(Finding(row.pressure, severity, field or row.size, degrees(worst.theta), values))
    return found + row_of(face).findings(extremes, face, cam, least_at)


def limits_of(face: Any, cam: Any) -> tuple[str, ...]:
    """The quantities whose refined extremes the findings of a cam are taken from; the radius where hub or bore are known."""
    further = [name for _, row, _ in further_flanks(face, cam) for name in row.limits]
    inside = [] if cam.hub_mm is cam.bore_mm is None else ["radius"]
    return tuple(dict.fromkeys((*row_of(face).limits, *further, *inside)))


def further_findings(
    extremes: Mapping[str, Range], grounds: Mapping[str, str], face: Any, cam: Any, second: SecondEntry | None
) -> list[Finding]:
    """What the flanks besides the first exceed; grounds: kind of the pair that holds what touches each; second: the entry of the second
    roller."""
    found = []
    for name, row, touching in further_flanks(face, cam):
        if row.pressure:
            worst, limit = extremes[row.pressure].high, PRESSURE_LIMITS[grounds[name]]
            angle = degrees(worst.value)
            if angle > limit * (1.0 + ROUNDING) and second is not None:
                severity = ERROR if angle > NO_DRIVE else WARNING
                values: dict[str, float | str] = {"value": angle, "limit": limit, "remedy": second.remedy}
                found.append(Finding(f"{name}-pressure-angle", severity, second.field, degrees(worst.theta), values))
        found += row.findings(extremes, touching, cam)
    return found


def undercut(extremes: Mapping[str, Range], flank: str, face: Any, cam: Any) -> bool:
    """Whether a flank has a cusp, or crosses itself where it is curved too much for what touches it."""
    further = {
        name: row.undercut(extremes, touching) for name, row, touching in further_flanks(face, cam) if name == flank
    }
    return further[flank] if further else row_of(face).undercut(extremes, face)


def require_hold(kinematics: Kinematics, noun: str, shape: CamShape) -> None:
    """The roller of a linkage, or another face of that ``noun``, must come nearer to the cam centre or go away from it somewhere
    in a turn; so must the second roller of a conjugate pair.

    Else the cam is a circle about its own centre, every contact normal goes through that, and no torque of the cam moves
    the linkage: NoCam.
    """
    held = [(noun, "cam.point", kinematics.follower.origin[0], kinematics.travel)]
    held += [
        ("second roller", "cam.second.point", flank.reference, path_by_driver(kinematics, flank))
        for flank in shape.flanks
        if flank.name == SECOND
    ]
    for name, field, reference, path in held:
        with np.errstate(invalid="ignore", divide="ignore"):  # no travel where the roller stands still
            hold = np.abs(dot(path / np.abs(path), reference)) / np.abs(reference)
        if not (hold > 16.0 * EPS * kinematics.condition).any():
            raise NoCam(
                f"the {name} keeps its distance from the cam centre, so no cam can move it",
                field,
                "choose another point",
            )


# -- the smallest radii of curvature of profile and pitch curve, from the refined extremes of what --------------


STRAIGHT = 1e6  # [m] from such a radius on
PITCH, FLAT = "pitch_curvature", "profile_radius"
_PITCH_OF: Mapping[str, str] = {INNER: PITCH, OUTER: PITCH, SECOND: f"{SECOND}_{PITCH}"}


@frozen
class Radius:
    """A smallest radius of curvature [m] with its cam angle.

    curve   ``profile`` of the first cam, ``pitch``, ``outer`` flank of a groove, ``second`` profile, ``second_pitch``
    hollow  where the cam's material is concave, so that a cutter must fit in; else where it is convex
    """

    curve: str
    hollow: bool
    smallest: Extreme

    @property
    def name(self) -> str:
        """``convex_radius``, ``pitch_concave_radius``: the profile's goes without its name."""
        shape = "concave_radius" if self.hollow else "convex_radius"
        return shape if self.curve == "profile" else f"{self.curve}_{shape}"

    @property
    def of_profile(self) -> bool:
        """Whether it is the profile's, not the pitch curve's."""
        return "pitch" not in self.curve


def smallest_radii(extremes: Mapping[str, Range], face: Any, cam: Any) -> tuple[Radius, ...]:
    """Of each curve the smallest radius where it is convex and where it is hollow, as far as it is so anywhere.

    Beside a pitch curve of radius ρ_p lies a profile of ρ_p - Rr where that is convex, ρ_p + Rr where it is hollow, so that its
    smallest radii stand where the pitch curve's do. The material of a groove's outer flank lies on the other side: it is hollow,
    with ρ_p + Rr + play, where the pitch curve is convex. 0 where there is a cusp.
    """
    if FLAT in row_of(face).limits:
        return (Radius("profile", False, _at_least_zero(extremes[FLAT].low)),)
    found: list[Radius] = []
    for name, touching in faces_of(face, cam).items():
        bends, radius = extremes[_PITCH_OF[name]], 1e-3 * touching.radius_mm
        curve = {INNER: "profile"}.get(name, name)
        side = -1.0 if name == OUTER else 1.0
        for convex, end, sign in ((True, bends.high, 1.0), (False, bends.low, -1.0)):
            if sign * end.value * STRAIGHT <= 1.0:
                continue
            own = sign / end.value
            if name != OUTER:
                found.append(Radius("pitch" if name == INNER else f"{name}_pitch", not convex, Extreme(own, end.theta)))
            beside = _at_least_zero(Extreme(own - side * sign * radius, end.theta))
            found.append(Radius(curve, convex == (name == OUTER), beside))
    return tuple(sorted(found, key=lambda each: ("pitch" in each.curve, each.curve != "profile")))


def _at_least_zero(extreme: Extreme) -> Extreme:
    return Extreme(max(extreme.value, 0.0), extreme.theta)


def hollowest(radii: tuple[Radius, ...]) -> Radius | None:
    """The smallest hollow of all profiles; None where none is hollow."""
    return min(
        (each for each in radii if each.of_profile and each.hollow), key=lambda each: each.smallest.value, default=None
    )
