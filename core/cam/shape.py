"""Shape of the cam: profile, normal, pressure angle and curvature of each flank, from the motion of the follower relative to the cam."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import degrees
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from core.design import (
    DiskCam,
    Face,
    LinkageCam,
    Roller,
    RollerCam,
    RoundFace,
    SecondArm,
    SecondLinkRoller,
    SecondPlace,
    Shoe,
)
from core.errors import NoCam, angle_ranges
from core.findings import ERROR, Finding
from core.frozen import frozen
from core.instant_centres import Centres, cam_follower_centre
from core.mechanism.kinematics import Kinematics
from core.motion.extremes import Extremes
from core.number_text import result_text
from core.numerics.derivatives import BINOMIAL, Derivatives, between_lines, cross, dot
from core.numerics.lazy import Lazy, once

# -- flanks and shape of a cam ----------------------------------------------------------------------------------


INNER, OUTER, SECOND = "inner", "outer", "second"


def _empty(flank: Flank) -> np.ndarray:
    return np.zeros(0, dtype=complex)


@frozen(eq=False, kw_only=True)
class Flank:
    """One side of the cam that the follower touches, at n cam angles.

    A result that is given as a function is computed when it is first read. "By cam angle" means the derivative by the cam angle θ;
    d = ±1 is the sense of rotation, t the relative velocity, m the normal of a straight face, n that of the flank.

    Attributes
    ----------
    straight : bool
        Whether the face is straight. A roller, shoe or edge is round: it has a pitch curve, the path of its centre.
    name : str
        ``inner`` of the first cam, ``outer`` of a groove, ``second`` of the second cam of a conjugate pair.
    body : str
        Body of the kinematics that the cam's force acts on.
    reference : ndarray (n,) complex [m]
        Reference point R of the face on the flank, in the global frame.
    relative_velocity : ndarray (n,) complex [m/rad]
        Velocity t of R relative to the cam, by cam angle.
    centre : Centres
        Instant centre Q of the face and the cam.
    profile : ndarray (n,) complex [m]
        Point of contact in the cam's frame, which is the global frame at cam angle 0.
    contact : ndarray (n,) complex [m]
        Point of contact in the global frame.
    normal : ndarray (n,) complex, dimensionless
        Unit vector in the global frame, from the follower into the cam.
    pressure_angle : ndarray (n,) [rad]
        Angle ψ between the normal and the direction in which the follower moves, at the centre of a round face or at the
        contact of a straight one: unsigned, 0 ... π/2.
    profile_curvature : ndarray (n,) [1/m]
        Positive where the cam is convex.
    profile_velocity : ndarray (n,) complex [m/rad]
        Derivative of the profile by cam angle, in the cam's frame.
    sliding : ndarray (n,) [m/rad]
        Velocity of the follower's point at the contact, relative to the cam, by cam angle; positive along i d n.
    radius : float [m]
        Radius of a round face.
    offset : float [m]
        Distance from the pitch curve to the profile along -i d t: the radius, or for an outer flank -(radius + play).
    pitch : ndarray (n,) complex [m]
        Pitch curve in the cam's frame; empty under a straight face.
    pitch_curvature, pitch_curvature_slope : ndarray (n,) [1/m], [1/(m rad)]
        Positive where the cam is convex, and its derivative by cam angle; empty under a straight face.
    support : ndarray (n,) [m]
        Distance of a straight face from the cam centre; empty under a round face.
    support_angle : ndarray (n,) complex, dimensionless
        Normal m of a straight face in the cam's frame, from the cam to the face; empty under a round face.
    profile_radius : ndarray (n,) [m]
        Radius of curvature, positive where the cam is convex, 0 at a cusp; empty under a round face.
    on_face : ndarray (n,) [m]
        Position of the contact on a straight face, along i m from the reference point; empty under a round face.
    """

    straight: bool = False
    name: str
    body: str
    reference: np.ndarray
    relative_velocity: Lazy[np.ndarray] = Lazy()
    centre: Lazy[Centres] = Lazy()
    profile: Lazy[np.ndarray] = Lazy()
    contact: Lazy[np.ndarray] = Lazy()
    normal: Lazy[np.ndarray] = Lazy()
    pressure_angle: Lazy[np.ndarray] = Lazy()
    profile_curvature: Lazy[np.ndarray] = Lazy()
    profile_velocity: Lazy[np.ndarray] = Lazy()
    sliding: Lazy[np.ndarray] = Lazy()
    radius: float = 0.0
    offset: float = 0.0
    pitch: Lazy[np.ndarray] = Lazy(_empty)
    pitch_curvature: Lazy[np.ndarray] = Lazy(_empty)
    pitch_curvature_slope: Lazy[np.ndarray] = Lazy(_empty)
    support: Lazy[np.ndarray] = Lazy(_empty)
    support_angle: Lazy[np.ndarray] = Lazy(_empty)
    profile_radius: Lazy[np.ndarray] = Lazy(_empty)
    on_face: Lazy[np.ndarray] = Lazy(_empty)


class FaceOutline(NamedTuple):
    """Outline of a face in the frame of the follower's body.

    Attributes
    ----------
    points : ndarray (m,) complex [m]
        The closed outline.
    attachment : complex [m]
        Point where the follower carries the face.
    """

    points: np.ndarray
    attachment: complex


@frozen(eq=False)
class CamShape:
    """Flanks of the cam at n cam angles; an open cam has one.

    ``rotation_sign`` is d = +1 where the cam turns counter-clockwise, -1 where it turns clockwise.
    """

    flanks: tuple[Flank, ...]
    rotation_sign: float

    @property
    def flank(self) -> Flank:
        """The first flank, the only one of an open cam."""
        return self.flanks[0]

    @property
    def reference(self) -> np.ndarray:
        """Reference point R on the first flank (n,) complex [m], in the global frame."""
        return self.flank.reference

    @property
    def relative_velocity(self) -> np.ndarray:
        """Velocity t (n,) complex [m/rad] of the follower relative to the cam at R, by cam angle."""
        return self.flank.relative_velocity

    @property
    def centre(self) -> Centres:
        """Instant centre Q of follower and cam, on the first flank."""
        return self.flank.centre

    @property
    def extent(self) -> float:
        """Largest distance of a reference point or contact from the cam centre [m]."""
        return max(float(np.abs(p).max()) for flank in self.flanks for p in (flank.reference, flank.contact))

    def only(self, name: str) -> CamShape:
        """The cam with the flank of this name only."""
        return CamShape(tuple(flank for flank in self.flanks if flank.name == name), self.rotation_sign)


def relative_motion(kinematics: Kinematics, rotation_sign: float) -> Derivatives:
    """Derivatives by cam angle θ of the pitch curve R e^{-idθ}, turned into the global frame.

    Of orders 0 to 3, by Leibniz's rule: the reference point R, its velocity t = R' - idR relative to the cam,
    w = R'' - 2idR' - R and x = R''' - 3idR'' - 3R' + idR.
    """
    r = kinematics.follower.origin

    def row(order: int) -> np.ndarray:
        total = r[order]
        for k, c in enumerate(BINOMIAL[order][:-1]):
            term = c * (-1j * rotation_sign) ** (order - k) * r[k]
            total = np.add(total, term, out=term if term.shape == total.shape else None)
        return np.asarray(total)

    return Derivatives(row)


def cam_frame_rotation(kinematics: Kinematics, rotation_sign: float) -> Callable[[], np.ndarray]:
    """Function that returns the rotation e^{-idθ} from the global frame into the cam's; the value is computed once.

    Parameters
    ----------
    kinematics : Kinematics
    rotation_sign : float
        d = ±1.

    Returns
    -------
    function () -> ndarray (n,) complex, dimensionless
    """

    @once
    def rotation() -> np.ndarray:
        unit = kinematics.motion.angles.unit
        return unit.conj() if rotation_sign > 0.0 else unit

    return rotation


def sliding(
    kinematics: Kinematics, motion: Derivatives, contact: np.ndarray, normal: np.ndarray, rotation_sign: float
) -> np.ndarray:
    """Velocity of the follower relative to the cam at the contact C, by cam angle: v = t + i(φ' - d)(C - R), along i d n.

    t is the relative velocity of the reference point R, φ' the rotation of the follower; v has no component along the normal n.

    Parameters
    ----------
    kinematics : Kinematics
    motion : Derivatives
        The derivatives of `relative_motion`.
    contact : ndarray (n,) complex [m]
        Point of contact C in the global frame.
    normal : ndarray (n,) complex, dimensionless
        Unit vector n from the follower into the cam.
    rotation_sign : float
        d = ±1.

    Returns
    -------
    ndarray (n,) [m/rad]
    """
    turn = kinematics.follower.turn[1] - rotation_sign
    return rotation_sign * cross(normal, motion[1] + 1j * turn * (contact - motion[0]))


def curvature(motion: Derivatives, rotation_sign: float) -> np.ndarray:
    """Curvature of the pitch curve, κ_p = -d Im(t̄ w)/|t|³, positive where convex in both senses of rotation.

    Parameters
    ----------
    motion : Derivatives
        The derivatives of `relative_motion`: t and w.
    rotation_sign : float
        d = ±1.

    Returns
    -------
    ndarray (n,) [1/m]

    References
    ----------
    Curvature of a plane curve, κ_p = -d (t × w)/|t|³.
    """
    speed = np.abs(motion[1])
    result = cross(motion[1], motion[2])
    result *= -rotation_sign
    result /= speed * speed * speed
    return result


def curvature_slope(motion: Derivatives, rotation_sign: float) -> np.ndarray:
    """Derivative of the pitch curve's curvature by cam angle, κ_p'.

    Parameters
    ----------
    motion : Derivatives
        The derivatives of `relative_motion`: t, w and x.
    rotation_sign : float
        d = ±1.

    Returns
    -------
    ndarray (n,) [1/(m rad)]
    """
    t, w, x = (motion[order] for order in (1, 2, 3))
    square = dot(t, t)
    numerator = cross(t, x) - 3.0 * cross(t, w) * dot(t, w) / square
    return -rotation_sign * numerator / (square * np.sqrt(square))


# -- entries of the design that set the size of cam and face, by the class of the cam ---------------------------


class SizeEntries(NamedTuple):
    """Entries of the design that set the size of a cam.

    Attributes
    ----------
    pressure : code of the finding on the pressure angle
    size : field that makes the cam larger
    hint : how it does; ``{smaller}`` is replaced where the face has a radius, which may be made smaller
    smaller : text that replaces ``{smaller}``
    faces : table that holds the entries of a face other than a roller
    gentler : what reduces the pressure angle on the rise or on the return
    """

    pressure: str
    size: str
    hint: str
    smaller: str
    faces: str
    gentler: str


_DISK = SizeEntries(
    "pressure-angle",
    "cam.base_radius_mm",
    "make it larger,{smaller} or lower the motion",
    " or the {name} smaller,",
    "follower",
    "enlarge the base radius, or lengthen the {stretch}",
)
# the linkage determines the size of its cam
_UNDER_LINKAGE = SizeEntries(
    "roller-pressure-angle",
    "cam.point",
    "let the {name} run farther from the frame's origin{smaller}",
    ", or make it smaller",
    "cam",
    "let the cam act on another point, or lengthen the {stretch}",
)
ENTRIES: Mapping[type, SizeEntries] = MappingProxyType({RollerCam: _DISK, DiskCam: _DISK, LinkageCam: _UNDER_LINKAGE})


class SecondEntry(NamedTuple):
    """Field that places the second roller of a conjugate pair, and the remedy where its pressure angle is too large."""

    field: str
    remedy: str


_SECOND: Mapping[type, SecondEntry] = MappingProxyType(
    {
        SecondArm: SecondEntry("follower.second.angle_deg", "turn the second roller's arm, or change its length"),
        SecondPlace: SecondEntry("follower.second.distance_mm", "put the second roller farther away"),
        SecondLinkRoller: SecondEntry("cam.second.point", "let the second roller run at another point"),
    }
)


def second_entry(mechanism: Any, cam: Any) -> SecondEntry | None:
    """Entry that places the second roller of a conjugate pair; None for other cams."""
    return _SECOND.get(type(getattr(mechanism, "second", None) or getattr(cam.form, "second", None)))


def size_entry(cam: object, name: str, radius: float) -> tuple[str, str]:
    """The field that sets the cam's size, and the remedy.

    name: the face in words; radius: of the face [m], 0 where it has none that may be smaller.
    """
    row = ENTRIES[type(cam)]
    return row.size, row.hint.format(name=name, smaller=row.smaller.format(name=name) if radius else "")


def face_table(cam: object, face: Face) -> str:
    """Table of the file that holds the face's entries; a roller's radius is always in the cam's."""
    return "cam" if isinstance(face, Roller) else ENTRIES[type(cam)].faces


# -- envelope of a round face: roller, shoe, or an edge of radius 0 ---------------------------------------------


POINTS = 181  # of a drawn outline
_WORDS: Mapping[type, Mapping[str, str]] = MappingProxyType({Shoe: {"face": Shoe.face}})
SPARE = 0.3  # [rad] of a drawn shoe beyond its contacts
_SECOND_ROLLER = (
    "second roller",
    "cam.second.roller_radius_mm",
    "make it smaller, or put the second roller farther out",
)
WEDGE = 0.12  # length of a drawn edge, relative to the cam's size


def envelope(kinematics: Kinematics, face: RoundFace, cam: object, rotation_sign: float) -> CamShape:
    """Cam under a round face of radius Rr: n = -i d t/|t|, profile (R + Rr n) e^{-idθ}, ψ the angle from n to the travel.

    R is the face's reference point in the global frame, t its velocity relative to the cam, by cam angle.

    Parameters
    ----------
    kinematics : Kinematics
    face : RoundFace
    cam : RollerCam, DiskCam or LinkageCam
        The design's table ``cam``, which names the field in a fault.
    rotation_sign : float
        d = +1 where the cam turns counter-clockwise, -1 clockwise.

    Returns
    -------
    CamShape

    Raises
    ------
    NoCam
        Where the face covers the cam centre, or stands still on the cam (a cusp).

    References
    ----------
    Shin, Kim and Ha 1995, eqs. (18) to (20), written there for one quadrant; the instant centre Q (18) remains a check.
    """
    return CamShape((round_envelope(kinematics, face, cam, rotation_sign, 1e-3 * face.radius_mm),), rotation_sign)


def round_envelope(
    kinematics: Kinematics, face: RoundFace, cam: object, rotation_sign: float, offset: float, name: str = INNER
) -> Flank:
    """Flank parallel to the pitch curve: n = -i d t/|t|, profile (R + offset n) e^{-idθ}, κ = κ_p/(1 - offset κ_p).

    R is the face's reference point in the global frame, t its velocity relative to the cam, by cam angle. The pressure angle
    ψ is the angle between the lines of n and of the follower's travel (the direction of R').

    Parameters
    ----------
    kinematics : Kinematics
    face : RoundFace
    cam : RollerCam, DiskCam or LinkageCam
        The design's table ``cam``, which names the field in a fault.
    rotation_sign : float
        d = ±1.
    offset : float
        Radius Rr [m]; for the outer flank of a groove -(Rr + play), where the follower pushes along -n.
    name : str
        ``inner``, ``outer`` or ``second``.

    Returns
    -------
    Flank

    Raises
    ------
    NoCam
        Where the face covers the cam centre, or stands still on the cam (a cusp).

    References
    ----------
    Shin, Kim and Ha 1995, §3, (19), (20), for any pose; parallel curve; for a groove the second envelope of the roller.
    """
    motion, side = relative_motion(kinematics, rotation_sign), 1.0 if name != OUTER else -1.0
    reference, t = motion[0], motion[1]
    speed = np.abs(t)
    entry = _SECOND_ROLLER if name == SECOND else (face.noun, *size_entry(cam, face.noun, face.radius_mm))
    _require_cam(kinematics, reference, speed, 1e-3 * face.radius_mm, *entry)
    normal = np.empty(t.shape, dtype=complex)  # -i d t/|t|
    np.divide(t.imag, rotation_sign * speed, out=normal.real)
    np.divide(t.real, -rotation_sign * speed, out=normal.imag)
    rotation = cam_frame_rotation(kinematics, rotation_sign)
    pitch_curvature = once(lambda: curvature(motion, rotation_sign))
    return Flank(
        name=name,
        body=kinematics.carrier,
        reference=reference,
        relative_velocity=t,
        centre=lambda: cam_follower_centre(kinematics, rotation_sign),
        profile=lambda: (reference + offset * normal) * rotation(),
        contact=lambda: reference + offset * normal,
        normal=side * normal,
        pressure_angle=lambda: between_lines(normal, kinematics.travel),
        profile_curvature=lambda: _offset_curvature(pitch_curvature(), offset),
        profile_velocity=lambda: t * (1.0 - offset * pitch_curvature()) * rotation(),
        sliding=lambda: sliding(kinematics, motion, reference + offset * normal, side * normal, rotation_sign),
        radius=1e-3 * face.radius_mm,
        offset=offset,
        pitch=lambda: reference * rotation(),
        pitch_curvature=pitch_curvature,
        pitch_curvature_slope=lambda: curvature_slope(motion, rotation_sign),
    )


@np.errstate(divide="ignore")
def _offset_curvature(pitch_curvature: np.ndarray, offset: float) -> np.ndarray:
    """Curvature of the parallel curve at the offset, positive on the inside of the convex side."""
    return pitch_curvature / (1.0 - offset * pitch_curvature)


def _require_cam(
    kinematics: Kinematics, reference: np.ndarray, speed: np.ndarray, radius: float, name: str, field: str, hint: str
) -> None:
    """Raise NoCam.

    speed: |t| (n,) [m/rad]; name: the round face in words; field, hint: the entry that makes the cam larger, and how to change it.
    """
    distance = np.abs(reference)
    covered = distance <= radius
    NoCam.raise_where(
        covered,
        lambda: NoCam(
            f"the {name} covers the cam centre: the least distance of their centres is {result_text(distance.min() * 1e3, 6)} mm, "
            f"less than the {name} radius {result_text(radius * 1e3, 6)} mm, so the cam's radius would be negative",
            field,
            hint,
            angle_ranges(kinematics.theta, covered),
        ),
    )
    still = speed == 0.0
    NoCam.raise_where(
        still,
        lambda: NoCam(
            f"the {name} stands still on the cam (cusp of the pitch curve)",
            field,
            "change it",
            angle_ranges(kinematics.theta, still),
        ),
    )


def is_undercut(extremes: Mapping[str, Extremes], face: RoundFace) -> bool:
    """Whether the profile has a cusp, or crosses itself: the face's radius is not smaller than the pitch curve's."""
    return 1e-3 * face.radius_mm * extremes["pitch_curvature"].high.value >= 1.0


def contact_distance(shape: CamShape, face: RoundFace) -> np.ndarray:
    """Distance of the profile's points from the round face, each at the cam angle at which it is in contact.

    Parameters
    ----------
    shape : CamShape
    face : RoundFace

    Returns
    -------
    ndarray (n,) [m]
    """
    flank = shape.flank
    return np.abs(np.abs(shape.flank.profile - flank.pitch) - 1e-3 * face.radius_mm)


def gaps(shape: CamShape, face: RoundFace, positions: int) -> np.ndarray:
    """Least distance of all profile points from the round face, by brute force; negative where the profile enters it.

    Parameters
    ----------
    shape : CamShape
    face : RoundFace
    positions : int
        Number m of cam positions.

    Returns
    -------
    ndarray (m,) [m]
    """
    pitch, profile, radius = shape.flank.pitch, shape.flank.profile, 1e-3 * face.radius_mm
    step = max(1, pitch.size // positions)
    # a loop, so that memory stays small for a million points
    return np.array([float(np.abs(profile - centre).min()) - radius for centre in pitch[::step]])


def outline(shape: CamShape, face: RoundFace, kinematics: Kinematics) -> FaceOutline:
    """Outline of a roller as a circle, of a shoe as half a circle or more, of an edge as a wedge.

    A shoe covers the range of its contacts; a wedge has its tip at the reference point and is attached at its back.
    """
    radius, from_cam = 1e-3 * face.radius_mm, -shape.flank.normal / kinematics.follower.unit
    middle = complex(from_cam.mean())
    middle /= abs(middle) or 1.0
    if not radius:
        length = WEDGE * float(np.abs(shape.reference).max()) * middle
        return FaceOutline(np.array([0.0, length * (1.0 + 0.4j), length * (1.0 - 0.4j), 0.0]), length)
    half = np.pi
    if face.slides:
        half = min(np.pi, max(np.pi / 2.0, float(np.abs(np.angle(from_cam / middle)).max()) + SPARE))
    return FaceOutline(-radius * middle * np.exp(1j * np.linspace(-half, half, POINTS)), 0j)


def findings(extremes: Mapping[str, Extremes], face: RoundFace, cam: object, least_at: object) -> list[Finding]:
    """Finding where the pitch curve's smallest radius is not larger than the face's."""
    if not is_undercut(extremes, face):
        return []
    sharpest = extremes["pitch_curvature"].high
    key = f"{face.face}_radius_mm"
    values: dict[str, float | str] = {
        "pitch_radius_mm": 1e3 / sharpest.value,
        key: face.radius_mm,
        **_WORDS.get(type(face), {}),
    }
    return [Finding("undercut", ERROR, f"{face_table(cam, face)}.{key}", degrees(sharpest.theta), values)]
