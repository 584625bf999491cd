"""The cam's shape as results: its flanks, and the relative motion that they follow from."""

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
from core.numerics.derivatives import BINOMIAL, Derivatives, between_lines, cross, dot
from core.numerics.lazy import Lazy, once

# -- the cam's shape as results ---------------------------------------------------------------------------------


INNER, OUTER, SECOND = "inner", "outer", "second"


def _none(flank: Flank) -> np.ndarray:
    return np.zeros(0, dtype=complex)


@frozen(eq=False, kw_only=True)
class Flank:
    """One side of the cam that the follower touches, at n cam angles; each may be given as a function.

    straight  under a straight face; else under a roller, a shoe or an edge, which has a pitch curve: the path of its centre
    name      ``inner`` of the first cam, ``outer`` of a groove, ``second`` of the other cam of a conjugate pair
    body      body of the kinematics that the cam's force acts on
    reference          (n,) complex [m], the reference point R of what touches it, in the global frame
    relative_velocity  (n,) complex [m] by cam angle: its velocity t relative to the cam
    centre             instant centre Q of what touches it and the cam
    profile  (n,) complex [m] in the cam's own frame, which is the global frame at cam angle 0
    contact  (n,) complex [m], where they touch, in the global frame
    normal   (n,) complex unit vector in the global frame, from the follower into the cam
    pressure_angle     (n,) [rad], unsigned, 0 ... π/2
    profile_curvature  (n,) [1/m], positive where the cam is convex
    profile_velocity   (n,) complex [m] by cam angle: the profile's derivative, in the cam's own frame
    sliding  (n,) [m] by cam angle: speed of the follower's point that touches relative to the cam's, along i d n

    Under a round alone, else empty:
    radius           [m] of the round
    offset           [m] from the pitch curve to the profile along -i d t: radius and play; less than 0 of an outer flank
    pitch            (n,) complex [m] in the cam's own frame
    pitch_curvature  (n,) [1/m], positive where the cam is convex; ``pitch_curvature_slope`` (n,) its derivative by cam angle

    Under a straight face alone, else empty:
    support         (n,) [m] distance of the face from the cam centre, and ``support_angle`` (n,) complex unit vector of its
                    normal in the cam's own frame, from the cam to the face
    profile_radius  (n,) [m] radius of curvature, positive where the cam is convex: it goes through 0 at a cusp
    on_face         (n,) [m] where the contact lies on the face, along i m from the reference point
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
    pitch: Lazy[np.ndarray] = Lazy(_none)
    pitch_curvature: Lazy[np.ndarray] = Lazy(_none)
    pitch_curvature_slope: Lazy[np.ndarray] = Lazy(_none)
    support: Lazy[np.ndarray] = Lazy(_none)
    support_angle: Lazy[np.ndarray] = Lazy(_none)
    profile_radius: Lazy[np.ndarray] = Lazy(_none)
    on_face: Lazy[np.ndarray] = Lazy(_none)


class FaceOutline(NamedTuple):
    """How a face looks, in the frame of the follower's body: its closed outline (m,) [m], and ``held``, the place [m] from where
    the follower holds it."""

    points: np.ndarray
    held: complex


@frozen(eq=False)
class CamShape:
    """The cam at n cam angles: its flanks (one for an open cam), the first one first; of that the reference point R, its
    velocity t relative to the cam and the instant centre Q. sense: d = +1 where it turns counter-clockwise, -1 clockwise."""

    flanks: tuple[Flank, ...]
    sense: float

    @property
    def flank(self) -> Flank:
        """The first flank, the only one of an open cam."""
        return self.flanks[0]

    @property
    def reference(self) -> np.ndarray:
        """The reference point R on the first flank (n,) [m], in the global frame."""
        return self.flank.reference

    @property
    def relative_velocity(self) -> np.ndarray:
        """Velocity (n,) [m per rad] of the follower relative to the cam at the reference point of the first flank."""
        return self.flank.relative_velocity

    @property
    def centre(self) -> Centres:
        """The instant centre of follower and cam, on the first flank."""
        return self.flank.centre

    @property
    def extent(self) -> float:
        """Farthest that a reference point, or what it carries to the cam, comes from the cam centre [m]."""
        return max(float(np.abs(place).max()) for flank in self.flanks for place in (flank.reference, flank.contact))

    def only(self, name: str) -> CamShape:
        """The cam with one of its flanks as the first and only one."""
        return CamShape(tuple(flank for flank in self.flanks if flank.name == name), self.sense)


def relative_motion(kinematics: Kinematics, sense: float) -> Derivatives:
    """The pitch curve's derivatives, turned into the global frame: the reference point R, its velocity t = R' - idR relative
    to the cam, w = R'' - 2idR' - R and x = R''' - 3idR'' - 3R' + idR, by Leibniz of R e^{-idθ}."""
    r = kinematics.follower.origin

    def row(order: int) -> np.ndarray:
        terms = [c * (-1j * sense) ** (order - k) * r[k] for k, c in enumerate(BINOMIAL[order][:-1])]
        return np.asarray(sum(terms, r[order]))

    return Derivatives(row)


def turned_back(kinematics: Kinematics, sense: float) -> Callable[[], np.ndarray]:
    """e^{-idθ} (n,), made once: from the global frame into the cam's."""

    @once
    def back() -> np.ndarray:
        turned = kinematics.motion.angles.unit
        return turned.conj() if sense > 0.0 else turned

    return back


def sliding(
    kinematics: Kinematics, motion: Derivatives, contact: np.ndarray, normal: np.ndarray, sense: float
) -> np.ndarray:
    """Speed of the follower relative to the cam where they touch (n,) [m] by cam angle, along i d n: the velocity
    t + i(φ' - d)(C - R) of the follower's point there has no part along the normal."""
    turn = kinematics.follower.turn[1] - sense
    return sense * cross(normal, motion[1] + 1j * turn * (contact - motion[0]))


def curvature(motion: Derivatives, sense: float) -> np.ndarray:
    """κ_p = -d Im(t̄ w)/|t|³ (n,) [1/m], convex positive for both senses."""
    speed = np.abs(motion[1])
    return -sense * cross(motion[1], motion[2]) / (speed * speed * speed)


def curvature_slope(motion: Derivatives, sense: float) -> np.ndarray:
    """κ_p' (n,) [1/m per rad]."""
    t, w, x = (motion[order] for order in (1, 2, 3))
    square = dot(t, t)
    bend = cross(t, x) - 3.0 * cross(t, w) * dot(t, w) / square
    return -sense * bend / (square * np.sqrt(square))


# -- which entries of the design set the size of cam and face, by the class of the cam --------------------------


class SizeEntries(NamedTuple):
    """pressure: code of the finding; size: field that makes the cam larger; hint: how, ``{smaller}`` for what else helps where
    the face has a radius; faces: table that holds the entries of a face other than a roller; gentler: what lessens the pressure
    angle on the rise or on the return."""

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
# a cam under a linkage has the size that the linkage gives it
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
    """field that places the second roller of a conjugate pair; remedy: what to do with it where its pressure angle is too large."""

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
    """Where the second roller of a conjugate pair is placed; None of other cams."""
    return _SECOND.get(type(getattr(mechanism, "second", None) or getattr(cam.form, "second", None)))


def size_of(cam: object, name: str, radius: float) -> tuple[str, str]:
    """The field that sets the cam's size, and what to do with it; name: of the face, radius: it has one that may be smaller."""
    row = ENTRIES[type(cam)]
    return row.size, row.hint.format(name=name, smaller=row.smaller.format(name=name) if radius else "")


def face_table(cam: object, face: Face) -> str:
    """The table of the file that holds the face's own entries: a roller's radius is always the cam's."""
    return "cam" if isinstance(face, Roller) else ENTRIES[type(cam)].faces


# -- A round on the cam - roller, shoe, or an edge of radius 0 - as an envelope, with its limits, ---------------


POINTS = 181  # of an outline
_WORDS: Mapping[type, Mapping[str, str]] = MappingProxyType({Shoe: {"face": Shoe.face}})
SPARE = 0.3  # of a drawn shoe beyond where it touches [rad]
_OF_SECOND = ("second roller", "cam.second.roller_radius_mm", "make it smaller, or put the second roller farther out")
WEDGE = 0.12  # length of a drawn edge, parts of the cam's size


def envelope(kinematics: Kinematics, face: RoundFace, cam: object, sense: float) -> CamShape:
    """Profile of a disk cam under a round of radius Rr: n = -i d t/|t|, profile (R + Rr n) e^{-idθ}.

    Takes the place of Shin1995 (19), (20), which are written for one quadrant; Q stays a check (18).
    Raises NoCam where it covers the cam centre or stands still on the cam (a cusp).
    """
    return CamShape((round_envelope(kinematics, face, cam, sense, 1e-3 * face.radius_mm),), sense)


def round_envelope(
    kinematics: Kinematics, face: RoundFace, cam: object, sense: float, offset: float, name: str = INNER
) -> Flank:
    """The flank beside the pitch curve of the reference point: (R + offset n) e^{-idθ}, with the curvature κ_p/(1 - offset κ_p).

    offset [m]: Rr; of the outer flank of a groove -(Rr + play), where the follower pushes along -n. Raises as ``envelope``.
    """
    motion, side = relative_motion(kinematics, sense), 1.0 if name != OUTER else -1.0
    reference, t = motion[0], motion[1]
    of_cam = size_of(cam, face.noun, face.radius_mm)
    _require_cam(
        kinematics, reference, t, 1e-3 * face.radius_mm, *(_OF_SECOND if name == SECOND else (face.noun, *of_cam))
    )
    speed = np.abs(t)
    normal = np.empty(t.shape, dtype=complex)  # -i d t/|t|
    np.divide(t.imag, sense * speed, out=normal.real)
    np.divide(t.real, -sense * speed, out=normal.imag)
    back = turned_back(kinematics, sense)
    bend = once(lambda: curvature(motion, sense))
    return Flank(
        name=name,
        body=kinematics.carrier,
        reference=reference,
        relative_velocity=t,
        centre=lambda: cam_follower_centre(kinematics, sense),
        profile=lambda: (reference + offset * normal) * back(),
        contact=lambda: reference + offset * normal,
        normal=side * normal,
        pressure_angle=lambda: between_lines(normal, kinematics.travel),
        profile_curvature=lambda: _beyond(bend(), offset),
        profile_velocity=lambda: t * (1.0 - offset * bend()) * back(),
        sliding=lambda: sliding(kinematics, motion, reference + offset * normal, side * normal, sense),
        radius=1e-3 * face.radius_mm,
        offset=offset,
        pitch=lambda: reference * back(),
        pitch_curvature=bend,
        pitch_curvature_slope=lambda: curvature_slope(motion, sense),
    )


@np.errstate(divide="ignore")
def _beyond(pitch_curvature: np.ndarray, offset: float) -> np.ndarray:
    """Curvature of the curve that runs beside, by the offset on the convex side's inside."""
    return pitch_curvature / (1.0 - offset * pitch_curvature)


def _require_cam(
    kinematics: Kinematics, reference: np.ndarray, t: np.ndarray, radius: float, name: str, field: str, hint: str
) -> None:
    """Raises NoCam; name: of the round, field, hint: which entry makes the cam larger, and how."""
    distance = np.abs(reference)
    bad = distance <= radius
    NoCam.raise_where(
        bad,
        lambda: NoCam(
            f"the {name} covers the cam centre: its own centre comes as near as {distance.min() * 1e3:.9g} mm, "
            f"less than the {name} radius {radius * 1e3:.9g} mm, so the cam's radius turns negative",
            field,
            hint,
            angle_ranges(kinematics.theta, bad),
        ),
    )
    still = t == 0.0
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
    """Whether the pitch curve is somewhere no blunter than the round: there the profile has a cusp, or crosses itself."""
    return 1e-3 * face.radius_mm * extremes["pitch_curvature"].high.value >= 1.0


def own_distance(shape: CamShape, face: RoundFace) -> np.ndarray:
    """Distance of the profile's own points from the round (n,) [m]."""
    flank = shape.flank
    return np.abs(np.abs(shape.flank.profile - flank.pitch) - 1e-3 * face.radius_mm)


def gaps(shape: CamShape, face: RoundFace, positions: int) -> np.ndarray:
    """Least distance from the centre to all profile points, less the radius [m], by brute force at ``positions`` cam
    positions (m,): negative where the profile enters the round, positive where it stays away from it."""
    pitch, profile, radius = shape.flank.pitch, shape.flank.profile, 1e-3 * face.radius_mm
    step = max(1, pitch.size // positions)
    # one by one, so that memory stays small for a million points
    return np.array([float(np.abs(profile - centre).min()) - radius for centre in pitch[::step]])


def outline(shape: CamShape, face: RoundFace, kinematics: Kinematics) -> FaceOutline:
    """A roller as a circle; a shoe as half of one, or as much more as the contact wanders, held at its centre; an edge as a wedge
    whose point lies there, held at its back."""
    radius, away = 1e-3 * face.radius_mm, -shape.flank.normal / kinematics.follower.unit
    middle = complex(away.mean())
    middle /= abs(middle) or 1.0
    if not radius:
        length = WEDGE * float(np.abs(shape.reference).max()) * middle
        return FaceOutline(np.array([0.0, length * (1.0 + 0.4j), length * (1.0 - 0.4j), 0.0]), length)
    half = np.pi
    if face.slides:
        half = min(np.pi, max(np.pi / 2.0, float(np.abs(np.angle(away / middle)).max()) + SPARE))
    return FaceOutline(-radius * middle * np.exp(1j * np.linspace(-half, half, POINTS)), 0j)


def findings(extremes: Mapping[str, Extremes], face: RoundFace, cam: object, least_at: object) -> list[Finding]:
    """The pitch curve's smallest radius against that of the round."""
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
