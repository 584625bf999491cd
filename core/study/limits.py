"""The limits of a cam and of what holds its follower, one row each: the figure, the side on which the limit lies, the value that holds
where nobody states one with its reason, and the findings that say it is exceeded. The checks, Find, the report and the window read them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields
from functools import partial
from math import degrees
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from core.cam import OUTER, PRESSURE_LIMITS, PRESSURE_SOURCE, SECOND, CamShape, Flank, row_of
from core.cam.checks import keyway_reach
from core.cam.forms import ROUNDING, faces_of
from core.design import Design, Limits, info_of
from core.design.fields import Bounds, Info
from core.errors import NoSolution
from core.findings import WARNING, Finding
from core.frozen import frozen
from core.mechanism.kinematics import REVOLUTE, SLIDING
from core.motion.extremes import Extreme
from core.study.drive_forces import pairings
from core.study.extremes import extremes_of, has_quantity
from core.study.quantities import names_of, quantities_of, quantity
from core.study.quantity_requests import allowable_pressure
from core.study.study import Study
from core.units import quantity_kind, split_unit

# -- the user's own limits that bound quantities ----------------------------------------------------------------


OWN_BOUNDS: Mapping[str, tuple[Info, Bounds]] = MappingProxyType(
    {each.name: (info, info.bounds) for each in fields(Limits) if (info := info_of(each)) and info.bounds}
)
"""Key in [limits] -> its field, and of what it is a limit."""


def code_of(key: str) -> str:
    """Of the finding that a limit is passed."""
    return split_unit(key)[0].replace("_", "-")


def stage_of(key: str) -> str:
    """Of the quantities that a limit bounds."""
    return quantity(OWN_BOUNDS[key][1].quantities[0]).stage


def bounded(design: Design, key: str) -> tuple[str, ...]:
    """The quantities that a limit bounds in a design: those that it has and that measure the same, for a follower's jerk is one of
    lengths or of angles."""
    kind = quantity_kind(split_unit(key)[1].symbol)
    there = (name for name in OWN_BOUNDS[key][1].quantities if name in names_of(design))
    slugs = {name: quantity(name).slug.format(m=design.drive.motion_unit) for name in there}
    return tuple(name for name, slug in slugs.items() if quantity_kind(split_unit(slug)[1].symbol) == kind)


def worst_of(study: Study, stage: str) -> Iterator[tuple[str, float, Extreme]]:
    """Key, limit as stated and what comes nearest to it or passes it by most, in its unit, of every limit that the user states for
    quantities of a stage and that has no check of its own; forces only where there are any. Raises NoSolution as the stage does."""
    for key, (_, bounds) in OWN_BOUNDS.items():
        limit = getattr(study.design.drive.limits, key)
        if limit is None or not bounds.remedy or stage_of(key) != stage or (stage == "dynamics" and _forceless(study)):
            continue
        rows = quantities_of(study, stage)
        names = tuple(name for name in bounded(study.design, key) if name in rows and has_quantity(study, rows[name]))
        if not names:
            continue
        factor = split_unit(key)[1].factor
        ends = [
            Extreme(abs(end.value) / factor if bounds.most else end.value / factor, end.theta)
            for found in extremes_of(study, stage, names).values()
            for end in (found.low, found.high)
        ]
        yield key, limit, (max if bounds.most else min)(ends, key=lambda end: end.value)


def _forceless(study: Study) -> bool:
    return study.loading.empty or study.jam is not None


def own_findings(study: Study, stage: str) -> list[Finding]:
    """The quantities of a stage that pass the user's own limits."""
    found = []
    for key, limit, worst in worst_of(study, stage):
        info, bounds = OWN_BOUNDS[key]
        passed = worst.value > limit * (1.0 + ROUNDING) if bounds.most else worst.value < limit * (1.0 - ROUNDING)
        if not passed:
            continue
        words = {
            "what": info.in_sentence,
            "unit": split_unit(key)[1].symbol,
            "remedy": bounds.remedy,
        }
        values: dict[str, float | str] = {"value": worst.value, "limit": limit, **words}
        found.append(Finding(code_of(key), WARNING, f"limits.{key}", degrees(worst.theta), values))
    return found


# -- the limits of a cam and of what holds its follower, one row each -------------------------------------------


ROLLER_PART = 0.5  # of the roller's radius: the least convex radius of the profile under it
SHARPEST_MM = 3.0  # the same under what slides on the cam
TORSION_MPA = 25.0  # of a shaft that nobody has stated: steel, with keyways, loads that alternate
HUB_PART = 1.8  # hub over shaft
BESIDE_HUB_MM = 2.0  # between hub and profile, for cutter and roller
WALL_PART, FLOOR_PART = 0.25, 0.125  # of the bore: the wall around it, and over the floor of its keyway
ROLLER_OF_BASE = 0.5  # the largest roller over the base circle; usual are 0.1 to 0.5
SPEED_SPARE = 1.1  # of the design's speed: inertia is 1.2 times as large there
FORCE_PART = 0.02  # of the largest contact force
SOFTEST = 0.25  # of the preload: the least by which the force of a spring grows over the stroke
MPA = 1e6  # [Pa]

ANY_PRESSURE, CONVEX, POLAR = "pressure_angle_deg", "convex_radius_mm", "polar_radius_mm"
FORCE = "loads.least_contact_force_n"
BASE, ROLLER = "cam.base_radius_mm", "cam.roller_radius_mm"
SPEEDS = ("shaft.speed_rpm", "linkage.driver.speed_rpm")
SPRINGS: Mapping[str, tuple[str, float]] = MappingProxyType(
    {"spring_rate_n_per_mm": ("preload_n", 1e3), "spring_rate_nm_per_rad": ("preload_nm", 1.0)}
)
"""Rate -> preload, and a stroke of 1 [m or rad] in the unit of the rate."""
OWN = "own"


@frozen
class UsualValue:
    """The value that a limit has where a search states none, in the unit of the file, and why; source: as tables name it."""

    value: float
    reason: str
    source: str


class Curve(NamedTuple):
    """A figure of one flank: the higher, the worse.

    value   (n,) at the cam angles of a study; NaN where the limit does not count
    reached what that is in the unit of the limit, beside the size
    margin  how much of the limit is left with the figure, as a part: negative where it is exceeded; figure, limit, size
    size    what both depend on besides: the greatest of these over the turn, (n,) or one number
    whose   of which flank it is, where that is not the first
    """

    value: np.ndarray
    reached: Callable[[float, float], float]
    margin: Callable[[float, float, float], float]
    size: np.ndarray | float = 1.0
    whose: str = ""


def _known(study: Study) -> str:
    return ""


def _none(study: Study) -> UsualValue | None:
    return None


class Limit(NamedTuple):
    """unit     of the file
    most     the limit is an upper one
    curves   study at some cam angles -> the figures of its flanks
    usual    study -> what holds where neither the design nor a search states one; at some cam angles it may read these only
    help     the same in words, for any design; a search holds to what is usual only where it has them
    findings codes by which a check says that the limit is exceeded
    lacking  study -> what the design must be given before there is such a figure, empty where nothing is missing
    """

    unit: str
    most: bool
    curves: Callable[[Study], Iterator[Curve]]
    usual: Callable[[Study], UsualValue | None] = _none
    help: str = ""
    findings: tuple[str, ...] = ()
    lacking: Callable[[Study], str] = _known

    @property
    def of_forces(self) -> bool:
        """Whether it takes the dynamics; else the shape of the cam says it."""
        return self.lacking is not _known


class FieldBound(NamedTuple):
    """The same of a field that a search varies, or that it holds something up to: usual, help and findings as of ``Limit``."""

    usual: Callable[[Study], UsualValue | None]
    help: str
    findings: tuple[str, ...] = ()


# -- figures -----------------------------------------------------------------------------------------------


def _pressure(study: Study, sign: float | None) -> Iterator[Curve]:
    """Pressure angle [deg] of every flank: over the whole turn, or where the motion rises (+1) or returns (-1)."""
    for flank in _flanks(study.cam):
        angle = np.rad2deg(flank.pressure_angle)
        if sign is not None:
            angle = np.where(study.drive.velocity_sign == sign, angle, np.nan)
        whose = " of the second roller" if flank.name == SECOND else ""
        yield Curve(angle, _itself, lambda angle, limit, _: (limit - angle) / limit, whose=whose)


def _flanks(shape: CamShape) -> Iterator[Flank]:
    """The flanks; of a groove the inner one, since both have the same normal and the other lies outside of it."""
    return (flank for flank in shape.flanks if flank.name != OUTER)


def _radius(study: Study, hollow: bool) -> Iterator[Curve]:
    """Curvature of every flank where it is convex, or where its material is hollow.

    Beside a pitch curve of curvature κ, by the signed distance o (the roller's radius; outwards negative), lies a profile of the
    radius 1/κ - o. The material of a groove's outer flank lies on the other side.
    """
    for flank in study.cam.flanks:
        if flank.straight:
            if not hollow:
                yield _least(-flank.profile_radius, np.abs(flank.support))
            continue
        side = -1.0 if hollow != (flank.name == OUTER) else 1.0
        yield Curve(side * flank.pitch_curvature, _beside, _left, side * flank.offset)


def _polar(study: Study) -> Iterator[Curve]:
    """Distance [m] of every profile from the cam centre, as its negative."""
    for flank in _flanks(study.cam):
        distance = np.abs(flank.profile)
        yield _least(-distance, distance)


def _itself(value: float, size: float) -> float:
    return float(value)


def _least(less: np.ndarray, size: np.ndarray) -> Curve:
    """Of a length, given as its negative (n,) [m], that must not fall below a limit [mm]: margins as parts of the cam's size (n,) [m]."""
    return Curve(less, lambda less, _: -1e3 * less, lambda less, limit, size: (-less - 1e-3 * limit) / size, size)


def _beside(bend: float, offset: float) -> float:
    """Radius [mm] of the profile beside a curvature; infinite where it bends the other way."""
    return 1e3 * (1.0 / bend - offset) if bend > 0.0 else math.inf


def _left(bend: float, limit: float, offset: float) -> float:
    """1 - κ (limit + o), which is negative where the profile's radius is below the limit [mm]."""
    room = 1e-3 * limit + offset
    return 1.0 - bend * room if room > 0.0 else 1.0


def _part_left(value: float, limit: float, unit: float) -> float:
    """Of a limit, with a figure whose unit is so large."""
    return 1.0 - value / (unit * limit)


def _on_face(study: Study) -> Iterator[Curve]:
    """Distance [mm] of the contact on a flat face from the face's centre."""
    for flank in study.cam.flanks:
        if flank.straight:
            centre = getattr(study.design.drive.face, "face_centre_mm", 0.0)
            yield Curve(np.abs(1e3 * flank.on_face - centre), _itself, _part_left)


def _contact_force(study: Study) -> Iterator[Curve]:
    """Force [N] on every flank, of whatever side."""
    for contact in study.dynamics.contacts:
        yield Curve(np.abs(contact.force), _itself, _part_left)


def _contact_pressure(study: Study) -> Iterator[Curve]:
    """Hertz pressure [Pa] on every flank."""
    for each in study.stress.values():
        yield Curve(each.pressure, lambda value, unit: value / unit, _part_left, MPA)


def _of_quantities(study: Study, key: str) -> Iterator[Curve]:
    """Size, or less than nothing of a lower limit, of each of the quantities that the design has, in the unit of the limit."""
    bounds, factor = OWN_BOUNDS[key][1], split_unit(key)[1].factor
    for name in bounded(study.design, key):
        value = quantity(name).value(study) / factor
        if bounds.most:
            yield Curve(np.abs(value), _itself, _part_left)
        else:
            yield Curve(-value, lambda less, _: -less, lambda less, limit, _: (-less - limit) / limit)


def _lacks_loads(study: Study) -> str:
    return "masses or a spring in [loads]" if study.loading.empty else ""


def _lacks_contact(study: Study) -> str:
    return _lacks_loads(study) or (
        "" if pairings(study) else "the thickness of the cam and the materials of what touches"
    )


# -- usual values ------------------------------------------------------------------------------------------


def _usual_pressure(study: Study) -> UsualValue:
    """By the pair that holds the follower; the lower one where that cannot be told."""
    try:
        linkage = study.linkage
        pair = linkage.pairs.get(linkage.ground)
        kind = pair.kind if pair else REVOLUTE
    except NoSolution:
        kind = SLIDING
    how = "slides" if kind == SLIDING else "swings"
    return UsualValue(PRESSURE_LIMITS[kind], f"usual where the follower {how}", PRESSURE_SOURCE)


def _usual_convex(study: Study) -> UsualValue:
    """Of the largest of its rollers; what slides, an edge too, wears a sharper flank off."""
    drive = study.design.drive
    if row_of(drive.face).rolls:
        largest = max(face.radius_mm for face in faces_of(drive.face, drive.cam).values())
        return _reasoned(ROLLER_PART * largest, "half the roller's radius")
    return _reasoned(SHARPEST_MM, f"a sharper one wears off under a {drive.face.noun}")


def _usual_polar(study: Study) -> UsualValue | None:
    """The metal that hub, bore and keyway need where one of them is known, else the hub of the shaft that the torque needs."""
    cam = study.design.drive.cam
    rows = []
    if cam.hub_mm is not None:
        rows.append(
            (0.5 * cam.hub_mm + BESIDE_HUB_MM, f"the hub of {cam.hub_mm:g} mm and {BESIDE_HUB_MM:g} mm beside it")
        )
    if cam.bore_mm is not None:
        rows.append(
            ((0.5 + WALL_PART) * cam.bore_mm, f"the bore of {cam.bore_mm:g} mm and a wall of a quarter of that")
        )
        if floor := 1e3 * keyway_reach(cam):
            rows.append(
                (
                    floor + FLOOR_PART * cam.bore_mm,
                    f"the floor of the keyway and an eighth of the bore of {cam.bore_mm:g} mm",
                )
            )
    if rows:
        return _reasoned(*max(rows))
    torque = _greatest_torque(study)
    if not torque or not math.isfinite(torque):
        return None
    shaft = 1e3 * math.cbrt(16.0 * torque / (math.pi * TORSION_MPA * MPA))
    reason = f"a shaft of {shaft:.3g} mm carries {torque:.4g} N·m at {TORSION_MPA:g} MPa (assumed), its hub is {HUB_PART:g} times as wide"
    return _reasoned(0.5 * HUB_PART * shaft, reason)


def _greatest_torque(study: Study) -> float:
    """Of the size of the drive's torque [N m]: refined, or of a study's own cam angles; 0 where nothing loads it or friction jams."""
    if study.loading.empty or study.jam is not None:
        return 0.0
    if study.full_turn is not study:
        return float(np.abs(study.shaft_torque).max())
    found = extremes_of(study, "dynamics", ("drive_torque",))["drive_torque"]
    return max(abs(found.low.value), abs(found.high.value))


def _usual_face(study: Study) -> UsualValue | None:
    half = getattr(study.design.drive.face, "face_half_width_mm", None)
    return None if half is None else _reasoned(half, "half the face's width")


def _usual_force(study: Study) -> UsualValue | None:
    """The design's own, else a part of the largest up to the spare speed."""
    own = getattr(study.design.drive.loads, FORCE.rpartition(".")[2], None)
    if own:
        return UsualValue(own, "the design's own", OWN)
    largest = study.contact_force.greatest(SPEED_SPARE * abs(study.omega))
    return _reasoned(FORCE_PART * largest, f"{100.0 * FORCE_PART:g} % of the largest contact force")


def _usual_speed(study: Study) -> UsualValue:
    return _reasoned(
        SPEED_SPARE * study.design.speed_rpm,
        f"{SPEED_SPARE:g} times the design's speed, where inertia is 1.2 times as large",
    )


def _usual_base(study: Study) -> UsualValue | None:
    """Of what rolls."""
    drive = study.design.drive
    if not row_of(drive.face).rolls:
        return None
    return _reasoned(drive.face.radius_mm / ROLLER_OF_BASE, "twice the roller's radius")


def _usual_roller(study: Study) -> UsualValue | None:
    """A cam under a linkage has no base radius."""
    base = getattr(study.design.drive.cam, "base_radius_mm", None)
    return None if base is None else _reasoned(ROLLER_OF_BASE * base, "half the base radius")


def _usual_rate(study: Study, rate: str) -> UsualValue | None:
    """By which the force grows by a quarter of the preload; none where there is no preload."""
    loads, (preload, unit) = study.design.drive.loads, SPRINGS[rate]
    present, moved = getattr(loads, rate), extremes_of(study, "motion", ("displacement",))["displacement"]
    stroke = unit * (moved.high.value - moved.low.value)
    if not stroke or getattr(loads, preload, 0.0) <= 0.0:
        return None
    softest = SOFTEST * getattr(loads, preload) / stroke
    if 0.0 < present < softest:
        return _reasoned(present, f"the present one is compressed by more than {1.0 / SOFTEST:g} strokes already")
    return _reasoned(softest, f"a softer one is compressed by more than {1.0 / SOFTEST:g} strokes before it works")


def _usual_contact_pressure(study: Study) -> UsualValue | None:
    """What the weaker of the materials bears, as far as that is known."""
    least, source = allowable_pressure(study)
    return None if least is None else UsualValue(least / MPA, source, source)


def _reasoned(value: float, reason: str) -> UsualValue:
    return UsualValue(value, reason, reason)


# -- the rows ----------------------------------------------------------------------------------------------

_STEEP = ("pressure-angle", "roller-pressure-angle", "second-pressure-angle")
_RISE, _RETURN = "pressure-angle-rise", "pressure-angle-return"
_BY_PAIR = "30 where the follower slides, 45 where it swings"

_ROWS: Mapping[str, Limit] = MappingProxyType(
    {
        ANY_PRESSURE: Limit("deg", True, partial(_pressure, sign=None), findings=(*_STEEP, _RISE, _RETURN)),
        "pressure_angle_rise_deg": Limit("deg", True, partial(_pressure, sign=1.0), _usual_pressure, _BY_PAIR, (*_STEEP, _RISE)),
        "pressure_angle_return_deg": Limit("deg", True, partial(_pressure, sign=-1.0), _usual_pressure, _BY_PAIR, (*_STEEP, _RETURN)),
        CONVEX: Limit(
            "mm", False, partial(_radius, hollow=False), _usual_convex,
            f"half the roller's radius; {SHARPEST_MM:g} under a flat face, a shoe or an edge", ("convex-radius",),
        ),
        "concave_radius_mm": Limit("mm", False, partial(_radius, hollow=True), findings=("concave-radius",)),
        POLAR: Limit(
            "mm", False, _polar, _usual_polar,
            f"least distance of the profile from the cam centre: the hub and {BESIDE_HUB_MM:g} mm, the bore and a quarter of it, else "
            f"{0.5 * HUB_PART:g} times a shaft that carries the torque at {TORSION_MPA:g} MPa",
            ("polar-radius",),
        ),
        "contact_on_face_mm": Limit(
            "mm", True, _on_face, _usual_face, "distance of the contact from the centre of a flat face: half its width",
            ("face-too-narrow",),
        ),
        "contact_force_n": Limit("N", True, _contact_force, findings=("contact-force",), lacking=_lacks_loads),
        "contact_pressure_mpa": Limit(
            "MPa", True, _contact_pressure, _usual_contact_pressure, findings=("contact-pressure", "material-pressure"),
            lacking=_lacks_contact,
        ),
    }
)  # fmt: skip


def _row_of_quantities(key: str) -> Limit:
    """What follows from the field of a limit that has no row."""
    lacking = _lacks_loads if stage_of(key) == "dynamics" else _known
    most, unit = OWN_BOUNDS[key][1].most, split_unit(key)[1].symbol
    return Limit(unit, most, partial(_of_quantities, key=key), findings=(code_of(key),), lacking=lacking)


LIMITS: Mapping[str, Limit] = MappingProxyType(
    {**_ROWS, **{key: _row_of_quantities(key) for key in OWN_BOUNDS if key not in _ROWS}}
)
"""Keys as in [limits], radii those of the profile; the pressure angle over the whole turn and the contact on a flat face besides. A
convex radius of 0 says that the cam is not undercut."""

_LOST = ("separation", "contact-force-low", "elastic-separation")
BOUNDS: Mapping[str, FieldBound] = MappingProxyType(
    {
        f"{FORCE}_min": FieldBound(
            _usual_force, f"the design's own, else {100.0 * FORCE_PART:g} % of the largest contact force", _LOST
        ),
        **{
            f"{path}_max": FieldBound(_usual_speed, f"{SPEED_SPARE:g} times the design's speed", _LOST)
            for path in SPEEDS
        },
        f"{BASE}_min": FieldBound(_usual_base, "twice the roller's radius"),
        f"{ROLLER}_max": FieldBound(_usual_roller, "half the base radius"),
        **{
            f"loads.{rate}_min": FieldBound(
                partial(_usual_rate, rate=rate), f"{SOFTEST:g} of the preload over the stroke"
            )
            for rate in SPRINGS
        },
    }
)
"""Path of a field with _min or _max."""


def by_torque(study: Study) -> bool:
    """Whether the room for the shaft follows from the torque, so that the forces must be known."""
    drive = study.design.drive
    return drive.limits.polar_radius_mm is drive.cam.hub_mm is drive.cam.bore_mm is None


def limit_of(study: Study, key: str) -> UsualValue | None:
    """What holds of a row of ``LIMITS`` where a search states nothing: the design's own limit, else the usual one."""
    own = getattr(study.design.drive.limits, key, None)
    return LIMITS[key].usual(study) if own is None else UsualValue(own, "the design's own limit", OWN)
