"""Cams under every follower and face, drawn at random; and whether the face touches the profile and enters it nowhere, by the
lengths of the design alone: no formula of ``core`` but the motion and the pose of the follower's body stands here."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from mechanisms import LAYOUT_DESIGNS, levels

from core.design import (
    ContactFriction,
    Design,
    DiskCam,
    Drive,
    Knife,
    LinkageLoads,
    OffsetFlat,
    Oscillating,
    OscillatingFlat,
    OscillatingFlatLoads,
    OscillatingLoads,
    Pushrod,
    PushrodLoads,
    Rocker,
    RockerLoads,
    Roller,
    RollerCam,
    Rolling,
    Shaft,
    Shoe,
    TiltedFlat,
    Translating,
    TranslatingLoads,
    with_drive,
)
from core.project import load
from core.study import Study

COUPLER = load(Path(__file__).parents[1] / "resources" / "examples" / "four_bar_coupler_cam.toml")
FACES = {
    "translating": ("roller", "flat", "knife", "shoe"),
    "oscillating": ("roller", "flat", "knife", "shoe"),
    "cam-slider": ("roller", "knife", "shoe"),
    "rocker": ("roller", "shoe"),
    "pushrod": ("roller", "flat", "knife", "shoe"),
    "linkage": ("roller", "knife", "shoe"),
}
CASES = [(follower, face, sense) for follower, faces in FACES.items() for face in faces for sense in ("ccw", "cw")]
SMOOTH = ("cycloidal", "modified-sine", "simple-harmonic", "3-4-5", "modified-trapezoid")


def random_design(rng: np.random.Generator, follower: str, face: str, sense: str) -> Design:
    """A design of usual proportions; some of them undercut."""
    made = MAKERS[follower](rng, face)
    turned = made if made.shaft is None else replace(made, shaft=replace(made.shaft, rotation=sense))
    if made.shaft is None:
        linkage = made.drive.linkage
        speed = abs(linkage.driver.speed_rpm) * (1.0 if sense == "ccw" else -1.0)
        turned = with_drive(made, mechanism=replace(linkage, driver=replace(linkage.driver, speed_rpm=speed)))
    if face == "roller":
        return turned
    contact = ContactFriction(float(rng.uniform(0.02, 0.25)))
    return with_drive(turned, loads=replace(turned.drive.loads, contact=contact))


def _motion(rng: np.random.Generator, stroke: float, unit: str) -> object:
    rise, back, low = (float(span) for span in rng.uniform(70.0, 115.0, 3))
    laws = [str(law) for law in rng.choice(SMOOTH, 2)]
    steps = (
        (low, 0.0, "dwell"),
        (rise, stroke, laws[0]),
        (360.0 - low - rise - back, stroke, "dwell"),
        (back, 0.0, laws[1]),
    )
    return replace(levels(0.0, *steps), unit=unit)


def _translating(rng: np.random.Generator, face: str) -> Design:
    base = float(rng.uniform(25.0, 60.0))
    radius = float(base * rng.uniform(0.15, 0.6))
    tilt = {"face_tilt_deg": float(rng.uniform(-25.0, 25.0))}
    part = {"roller": Rolling(), "flat": TiltedFlat(**tilt), "knife": Knife(), "shoe": Shoe(radius)}[face]
    follower = Translating(
        face=part, offset_mm=float(base * rng.uniform(-0.3, 0.3)), direction_deg=float(rng.uniform(-180.0, 180.0))
    )
    loads = TranslatingLoads(
        follower_mass_kg=1.3, spring_rate_n_per_mm=6.0, preload_n=150.0, friction=float(rng.uniform(0.0, 0.15))
    )
    motion = _motion(rng, float(base * rng.uniform(0.2, 1.1)), "mm")
    cam = RollerCam(base, radius) if face == "roller" else DiskCam(base)
    return Design("translating", Shaft("ccw", 240.0), (Drive(motion, follower, cam, loads),))  # type: ignore[arg-type]


def _oscillating(rng: np.random.Generator, face: str) -> Design:
    base = float(rng.uniform(25.0, 60.0))
    radius = float(base * rng.uniform(0.15, 0.6))
    pivot = base * rng.uniform(1.9, 3.0) * np.exp(1j * rng.uniform(-math.pi, math.pi))
    where = {
        "pivot_x_mm": float(pivot.real),
        "pivot_y_mm": float(pivot.imag),
        "side": str(rng.choice(("left", "right"))),
    }
    masses = {"arm_mass_kg": 0.9, "arm_inertia_kg_m2": 0.002, "arm_centre_mm": 30.0, "arm_centre_angle_deg": 12.0}
    spring = {"spring_rate_nm_per_rad": 30.0, "preload_nm": 9.0}
    motion = _motion(rng, float(rng.uniform(5.0, 16.0)), "deg")
    shaft = Shaft("ccw", 240.0)
    if face == "flat":
        flat = OscillatingFlat(face=OffsetFlat(face_offset_mm=float(base * rng.uniform(-0.3, 0.3))), **where)
        return Design("rocker", shaft, (Drive(motion, flat, DiskCam(base), OscillatingFlatLoads(**masses, **spring)),))  # type: ignore[arg-type]
    part = {"roller": Rolling(), "knife": Knife(), "shoe": Shoe(radius)}[face]
    arm = Oscillating(face=part, arm_mm=float(abs(pivot) * rng.uniform(0.8, 1.1)), **where)  # type: ignore[arg-type]
    cam = RollerCam(base, radius) if face == "roller" else DiskCam(base)
    loads = OscillatingLoads(**masses, **spring, roller_mass_kg=0.2, roller_inertia_kg_m2=1e-5)
    return Design("rocker", shaft, (Drive(motion, arm, cam, loads),))  # type: ignore[arg-type]


def _cam_slider(rng: np.random.Generator, face: str) -> Design:
    """The reach stays, so that the follower comes to its base position; its stroke varies."""
    made = LAYOUT_DESIGNS[str(rng.choice(list("abcdefgh")))]
    cam, motion = made.drive.cam, made.drive.motion
    assert motion is not None
    reach, share = cam.base_radius_mm + cam.roller_radius_mm, float(rng.uniform(0.1, 0.35))
    part = {"roller": Rolling(), "knife": Knife(), "shoe": Shoe(reach * share)}[face]
    size = 0.0 if face == "knife" else reach * share
    by = float(rng.uniform(0.6, 1.1))
    segments = tuple(replace(s, rise=s.rise * by) for s in motion.segments)
    return with_drive(
        made,
        motion=replace(motion, start=motion.start * by, segments=segments),
        mechanism=replace(made.drive.follower, face=part),
        cam=RollerCam(reach - size, size) if face == "roller" else DiskCam(reach - size),
    )


def _linkage(rng: np.random.Generator, face: str) -> Design:
    """The coupler point of a four-bar, elsewhere on its link."""
    cam, linkage = COUPLER.drive.cam, COUPLER.drive.linkage
    radius = float(cam.face.radius_mm * rng.uniform(0.5, 1.2))
    part = {"roller": Roller(radius), "knife": Knife(), "shoe": Shoe(radius)}[face]

    def moved(place: object) -> object:
        if place.name != cam.point:  # type: ignore[attr-defined]
            return place
        return replace(place, x_mm=place.x_mm * rng.uniform(0.9, 1.1), y_mm=place.y_mm * rng.uniform(0.9, 1.1))  # type: ignore

    links = tuple(
        replace(link, points=tuple(moved(p) for p in link.points)) if link.number == cam.link else link
        for link in linkage.links
    )
    loads = COUPLER.drive.loads
    assert isinstance(loads, LinkageLoads)
    return with_drive(COUPLER, mechanism=replace(linkage, links=links), cam=replace(cam, face=part))


def _rocker(rng: np.random.Generator, face: str) -> Design:
    """A rocker whose pad's arm is about square to the valve."""
    base = float(rng.uniform(15.0, 30.0))
    radius = float(base * rng.uniform(0.2, 0.6))
    pivot = base * rng.uniform(1.9, 3.0) * np.exp(1j * rng.uniform(-math.pi, math.pi))
    arm, side, pad_angle = float(abs(pivot) * rng.uniform(0.8, 1.1)), str(rng.choice(("left", "right"))), 170.0
    sign = 1.0 if side == "left" else -1.0
    corner = math.acos((arm**2 + abs(pivot) ** 2 - (base + radius) ** 2) / (2.0 * arm * abs(pivot)))
    pad = np.degrees(np.angle(-pivot) + sign * corner) + pad_angle
    follower = Rocker(
        face={"roller": Rolling(), "shoe": Shoe(radius)}[face],
        arm_mm=arm,
        pivot_x_mm=float(pivot.real),
        pivot_y_mm=float(pivot.imag),
        side=side,
        pad_mm=float(arm * rng.uniform(0.8, 1.7)),
        pad_angle_deg=pad_angle,
        pad_radius_mm=10.0,
        valve_direction_deg=float((pad + sign * rng.uniform(75.0, 105.0)) % 360.0),
    )
    loads = RockerLoads(
        valve_mass_kg=0.1,
        rocker_inertia_kg_m2=3e-5,
        roller_mass_kg=0.03,
        roller_inertia_kg_m2=1e-6,
        spring_rate_n_per_mm=30.0,
        preload_n=300.0,
    )
    motion = _motion(rng, float(base * rng.uniform(0.15, 0.35)), "mm")
    cam = RollerCam(base, radius) if face == "roller" else DiskCam(base)
    return Design("finger", Shaft("ccw", 240.0), (Drive(motion, follower, cam, loads),))  # type: ignore[arg-type]


def _pushrod(rng: np.random.Generator, face: str) -> Design:
    """The tappet of a translating follower, under a rocker whose arms are about square to pushrod and valve."""
    tappet = _translating(rng, face)
    under, base = tappet.drive.mechanism, tappet.drive.cam.base_radius_mm
    assert isinstance(under, Translating)
    reach = base + tappet.drive.face.radius_mm
    tilt = math.radians(getattr(under.face, "face_tilt_deg", 0.0))
    start = (base - under.offset_mm * math.sin(tilt)) / math.cos(tilt)
    if face != "flat":
        start = math.sqrt(reach**2 - under.offset_mm**2)
    side = str(rng.choice(("left", "right")))
    sign, arm, rod = (1.0 if side == "left" else -1.0), 1.5 * base, 5.0 * base
    seat = complex(*(base * rng.uniform(-0.2, 0.2, 2)))
    lower = complex(start, under.offset_mm) + seat
    pivot = lower + rod * np.exp(0.05j) - 1j * sign * arm * np.exp(1j * rng.uniform(-0.2, 0.2))
    at = pivot * np.exp(1j * math.radians(under.direction_deg))
    follower = Pushrod(
        face=under.face,
        offset_mm=under.offset_mm,
        direction_deg=under.direction_deg,
        seat_x_mm=seat.real,
        seat_y_mm=seat.imag,
        pushrod_mm=rod,
        pivot_x_mm=float(at.real),
        pivot_y_mm=float(at.imag),
        push_arm_mm=arm,
        side=side,
        pad_mm=1.4 * arm,
        pad_angle_deg=float(rng.uniform(165.0, 195.0)),
        pad_radius_mm=10.0,
        valve_direction_deg=float((under.direction_deg + rng.uniform(160.0, 200.0)) % 360.0),
    )
    loads = PushrodLoads(
        valve_mass_kg=0.1,
        rocker_inertia_kg_m2=6e-5,
        tappet_mass_kg=0.09,
        pushrod_mass_kg=0.06,
        spring_rate_n_per_mm=30.0,
        preload_n=300.0,
    )
    motion = _motion(rng, float(base * rng.uniform(0.2, 0.5)), "mm")
    return Design("pushrod", tappet.shaft, (Drive(motion, follower, tappet.drive.cam, loads),))  # type: ignore[arg-type]


MAKERS = {
    "translating": _translating,
    "oscillating": _oscillating,
    "cam-slider": _cam_slider,
    "rocker": _rocker,
    "pushrod": _pushrod,
    "linkage": _linkage,
}


# -- the face, from the lengths of the design --------------------------------------------------------------


@dataclass(frozen=True)
class Placed:
    """The face in the cam's own frame at n cam angles, [mm]: the centre of a round and its radius, or the normal of a line,
    from the cam to the face, and its distance from the cam centre."""

    centre: np.ndarray | None = None
    radius: float = 0.0
    normal: np.ndarray | None = None
    distance: np.ndarray | None = None

    @property
    def can_undercut(self) -> bool:
        """An edge follows any smooth curve."""
        return self.centre is None or self.radius > 0.0

    def gaps(self, points: np.ndarray) -> np.ndarray:
        """Least distance of any point (m,) [mm] from the face at each angle (n,), negative where it lies beyond."""
        if self.centre is not None:
            return np.abs(points[None, :] - self.centre[:, None]).min(axis=1) - self.radius
        assert self.normal is not None
        assert self.distance is not None
        return self.distance - (self.normal.conj()[:, None] * points[None, :]).real.max(axis=1)

    def gaps_at(self, own: np.ndarray) -> np.ndarray:
        """Distance of one point (n,) [mm] for each angle from the face there (n,)."""
        if self.centre is not None:
            return np.abs(own - self.centre) - self.radius
        assert self.normal is not None
        assert self.distance is not None
        return self.distance - (self.normal.conj() * own).real


def placed(study: Study) -> Placed:
    """The face of a study at its angles."""
    drive = study.design.drive
    back = np.exp(-1j * study.sense * study.theta)
    y = study.motion.y[0]
    if drive.face.face != "flat":
        return Placed(study.linkage.follower.origin[0] * 1e3 * back, drive.face.radius_mm)
    follower, base = drive.mechanism, drive.cam.base_radius_mm
    if isinstance(follower, Translating | Pushrod):
        tilt = math.radians(follower.face.face_tilt_deg)  # type: ignore[union-attr]
        normal = np.exp(1j * (math.radians(follower.direction_deg) + tilt)) * back
        return Placed(normal=normal, distance=base + 1e3 * y * math.cos(tilt))
    pivot, offset = complex(follower.pivot_x_mm, follower.pivot_y_mm), follower.face.face_offset_mm
    side = 1.0 if follower.side == "left" else -1.0
    angle = np.angle(pivot) - side * math.acos((base - offset) / abs(pivot)) + side * y
    normal = np.exp(1j * angle)
    return Placed(normal=normal * back, distance=(normal.conj() * pivot).real + offset)
