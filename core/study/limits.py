"""Limits of a cam and of the contact with its follower, one row each.

A row has the figure, the side of the limit, the typical value with its reason, and the findings that report an excess.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
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
from core.number_text import result_text
from core.study.drive_forces import pairings
from core.study.extremes import extremes_of, has_quantity
from core.study.quantities import names_of, quantities_of, quantity
from core.study.quantity_requests import allowable_pressure
from core.study.study import Study
from core.units import quantity_kind, split_unit

# -- the user's limits of quantities -----------------------------------------------------------------------------


USER_BOUNDS: Mapping[str, tuple[Info, Bounds]] = MappingProxyType(
    {field.name: (info, info.bounds) for field in fields(Limits) if (info := info_of(field)) and info.bounds}
)
"""Key in [limits] -> info of its field, and the quantities it bounds."""


def finding_code(key: str) -> str:
    """Code of the finding that reports an excess of the limit."""
    return split_unit(key)[0].replace("_", "-")


def bounded_stage(key: str) -> str:
    """Stage of the quantities that a limit bounds."""
    return quantity(USER_BOUNDS[key][1].quantities[0]).stage


def bounded_quantities(design: Design, key: str) -> tuple[str, ...]:
    """Quantities bounded by a limit that the design has in the unit of the limit (a jerk is of a length or an angle)."""
    kind = quantity_kind(split_unit(key)[1].symbol)
    names = (name for name in USER_BOUNDS[key][1].quantities if name in names_of(design))
    slugs = {name: quantity(name).slug.format(m=design.drive.motion_unit) for name in names}
    return tuple(name for name, slug in slugs.items() if quantity_kind(split_unit(slug)[1].symbol) == kind)


def worst_values(study: Study, stage: str) -> Iterator[tuple[str, float, Extreme]]:
    """Key, limit and worst extreme in the unit of the limit, of every limit of the user that bounds quantities of a stage.

    Leaves out limits with a separate check, and limits of forces where there are no forces. Raises NoSolution where the stage has none.
    """
    for key, (_, bounds) in USER_BOUNDS.items():
        limit = getattr(study.design.drive.limits, key)
        if (
            limit is None
            or not bounds.remedy
            or bounded_stage(key) != stage
            or (stage == "dynamics" and not _has_forces(study))
        ):
            continue
        rows = quantities_of(study, stage)
        names = tuple(
            name for name in bounded_quantities(study.design, key) if name in rows and has_quantity(study, rows[name])
        )
        if not names:
            continue
        factor = split_unit(key)[1].factor
        ends = [
            Extreme(abs(end.value) / factor if bounds.most else end.value / factor, end.theta)
            for extremes in extremes_of(study, stage, names).values()
            for end in (extremes.low, extremes.high)
        ]
        yield key, limit, (max if bounds.most else min)(ends, key=lambda end: end.value)


def _has_forces(study: Study) -> bool:
    return not study.loading.is_empty and study.jam is None


def limit_findings(study: Study, stage: str) -> list[Finding]:
    """Quantities of a stage that exceed the user's limits."""
    findings = []
    for key, limit, worst in worst_values(study, stage):
        info, bounds = USER_BOUNDS[key]
        is_exceeded = worst.value > limit * (1.0 + ROUNDING) if bounds.most else worst.value < limit * (1.0 - ROUNDING)
        if is_exceeded:
            texts = {"what": info.in_sentence, "unit": split_unit(key)[1].symbol, "remedy": bounds.remedy}
            values: dict[str, float | str] = {"value": worst.value, "limit": limit, **texts}
            findings.append(Finding(finding_code(key), WARNING, f"limits.{key}", degrees(worst.theta), values))
    return findings


# -- typical values, and the figures that are limited -----------------------------------------------------------


ROLLER_PART = 0.5  # of the roller's radius: least convex radius of the profile under a roller
SLIDING_RADIUS_MM = 3.0  # least convex radius under a face that slides on the cam
TORSION_MPA = 25.0  # allowable stress of an unknown shaft: steel, with keyways, alternating load
HUB_PART = 1.8  # hub over shaft
HUB_CLEARANCE_MM = 2.0  # between hub and profile, for cutter and roller
WALL_PART, FLOOR_PART = 0.25, 0.125  # of the bore: the wall around it, and over the floor of its keyway
ROLLER_OF_BASE = 0.5  # greatest roller over base circle; 0.1 to 0.5 are typical
SPEED_RESERVE = 1.1  # of the design's speed: inertia forces are 1.2 times as large
FORCE_PART = 0.02  # of the largest contact force
RATE_PART = 0.25  # of the preload: least growth of the spring's force over the stroke
MPA = 1e6  # [Pa]

ANY_PRESSURE, CONVEX, POLAR = "pressure_angle_deg", "convex_radius_mm", "polar_radius_mm"
FORCE = "loads.least_contact_force_n"
BASE, ROLLER = "cam.base_radius_mm", "cam.roller_radius_mm"
SPEEDS = ("shaft.speed_rpm", "linkage.driver.speed_rpm")
SPRINGS: Mapping[str, tuple[str, float]] = MappingProxyType(
    {"spring_rate_n_per_mm": ("preload_n", 1e3), "spring_rate_nm_per_rad": ("preload_nm", 1.0)}
)
"""Rate -> preload, and a stroke of 1 [m or rad] in the unit of the rate."""
USER = "own"
"""Source of a limit that the user gives."""


@frozen
class LimitValue:
    """Value of a limit in the unit of the file, its reason, and its source as tables name it."""

    value: float
    reason: str
    source: str


class Curve(NamedTuple):
    """A figure of one flank over the turn, which is worse the greater it is.

    Attributes
    ----------
    value : ndarray (n,)
        Figure at the cam angles of a study; NaN where the limit does not apply.
    reached : callable
        Figure in the unit of the limit, from value and size.
    margin : callable
        Part of the limit that is left, negative where it is exceeded, from value, limit and size.
    size : ndarray (n,) or float
        Further quantity on which both depend.
    whose : str
        Words that name the flank, where it is not the first.
    """

    value: np.ndarray
    reached: Callable[[float, float], float]
    margin: Callable[[float, float, float], float]
    size: np.ndarray | float = 1.0
    whose: str = ""


def _nothing_missing(study: Study) -> str:
    return ""


def _no_typical(study: Study) -> LimitValue | None:
    return None


class Limit(NamedTuple):
    """A limit of a figure.

    Attributes
    ----------
    unit : str
        Unit in the file.
    is_upper : bool
        Whether it is an upper limit.
    curves : callable
        Figures of the flanks of a study.
    typical : callable
        Typical value for a study, used where neither the design nor a search gives one; it uses the study's cam angles only.
    help : str
        The typical value in words, for any design; a search applies a typical value only if its row has these words.
    findings : tuple of str
        Codes of findings that report an excess.
    missing : callable
        Inputs without which the design does not have the figure, in words; empty where none is missing.
    """

    unit: str
    is_upper: bool
    curves: Callable[[Study], Iterator[Curve]]
    typical: Callable[[Study], LimitValue | None] = _no_typical
    help: str = ""
    findings: tuple[str, ...] = ()
    missing: Callable[[Study], str] = _nothing_missing

    @property
    def needs_forces(self) -> bool:
        """Whether the figure needs the stage ``dynamics``, and not only the cam."""
        return self.missing is not _nothing_missing


class FieldBound(NamedTuple):
    """A limit of a field, in a search: typical, help and findings as of ``Limit``."""

    typical: Callable[[Study], LimitValue | None]
    help: str
    findings: tuple[str, ...] = ()


# -- figures -----------------------------------------------------------------------------------------------


def _pressure(study: Study, sign: float | None) -> Iterator[Curve]:
    """Pressure angle [deg] of every flank: over the full turn, or where the motion rises (+1) or returns (-1)."""
    if study.has_surface:
        angle = np.rad2deg(study.surface.pressure_angle)
        if sign is not None:
            angle = np.where(study.drive.velocity_sign == sign, angle, np.nan)
        yield Curve(angle, _same, lambda angle, limit, _: (limit - angle) / limit)
        return
    for flank in _flanks(study.cam):
        angle = np.rad2deg(flank.pressure_angle)
        if sign is not None:
            angle = np.where(study.drive.velocity_sign == sign, angle, np.nan)
        roller = " of the second roller" if flank.name == SECOND else ""
        yield Curve(angle, _same, lambda angle, limit, _: (limit - angle) / limit, whose=roller)


def _flanks(shape: CamShape) -> Iterator[Flank]:
    """The flanks; of a groove the inner one, since both have the same normal and the outer one surrounds it."""
    return (flank for flank in shape.flanks if flank.name != OUTER)


def _curvature(study: Study, concave: bool) -> Iterator[Curve]:
    """Curvature of every flank where it is convex, or where it is concave.

    A profile at the signed distance o (the roller's radius; outwards negative) from a pitch curve of curvature κ has the radius
    1/κ - o. The material of a groove's outer flank is on the other side. Of a cam in space it is the most convex curvature.
    """
    if study.has_surface:
        if not concave:
            yield Curve(study.surface.curvature, _profile_radius, _curvature_margin, 0.0)
            # an edge, where a flank is undercut, violates every limit; elsewhere the radius decides
            margin = study.surface.margin
            excess = np.where(margin > 0.0, -1.0, 1.0 - margin)
            yield Curve(excess, lambda share, _: 0.0 if share >= 1.0 else math.inf, lambda share, *_: 1.0 - share)
        return
    for flank in study.cam.flanks:
        if flank.straight:
            if not concave:
                yield _lower_limit(-flank.profile_radius, np.abs(flank.support))
            continue
        side = -1.0 if concave != (flank.name == OUTER) else 1.0
        yield Curve(side * flank.pitch_curvature, _profile_radius, _curvature_margin, side * flank.offset)


def _polar(study: Study) -> Iterator[Curve]:
    """Distance [m] of every profile from the cam centre, as its negative."""
    if study.has_surface:
        return
    for flank in _flanks(study.cam):
        distance = np.abs(flank.profile)
        yield _lower_limit(-distance, distance)


def _same(value: float, size: float) -> float:
    return float(value)


def _lower_limit(negative: np.ndarray, size: np.ndarray) -> Curve:
    """A length with a lower limit [mm], as its negative (n,) [m]; its margins are parts of the cam's size (n,) [m]."""
    return Curve(
        negative,
        lambda negative, _: -1e3 * negative,
        lambda negative, limit, size: (-negative - 1e-3 * limit) / size,
        size,
    )


def _profile_radius(curvature: float, offset: float) -> float:
    """Radius 1/κ - o [mm] of the profile at an offset from the pitch curve; infinite where κ is not positive."""
    return 1e3 * (1.0 / curvature - offset) if curvature > 0.0 else math.inf


def _curvature_margin(curvature: float, limit: float, offset: float) -> float:
    """Margin 1 - κ (limit + o), negative where the profile's radius is below the limit [mm]."""
    pitch_radius = 1e-3 * limit + offset
    return 1.0 - curvature * pitch_radius if pitch_radius > 0.0 else 1.0


def _upper_margin(value: float, limit: float, unit: float) -> float:
    """Part of an upper limit that is left; ``unit`` is the size of the limit's unit in that of the figure."""
    return 1.0 - value / (unit * limit)


def _lower_margin(negative: float, limit: float, unit: float) -> float:
    """Excess of a value, as its negative, over a lower limit as a part of it; over the limit 0 the value itself."""
    return (-negative - limit) / (limit or 1.0)


def _on_face(study: Study) -> Iterator[Curve]:
    """Distance [mm] of the contact on a flat face from the face's centre."""
    if study.has_surface:
        return
    for flank in study.cam.flanks:
        if flank.straight:
            centre = getattr(study.design.drive.face, "face_centre_mm", 0.0)
            yield Curve(np.abs(1e3 * flank.on_face - centre), _same, _upper_margin)


def _contact_force(study: Study) -> Iterator[Curve]:
    """Size of the force [N] on every flank."""
    if study.has_surface:
        yield Curve(np.abs(study.dynamics.contact), _same, _upper_margin)
    for contact in study.dynamics.contacts:
        yield Curve(np.abs(contact.force), _same, _upper_margin)


def _contact_pressure(study: Study) -> Iterator[Curve]:
    """Hertz pressure [Pa] on every flank."""
    for stress in study.stress.values():
        yield Curve(stress.pressure, lambda value, unit: value / unit, _upper_margin, MPA)


def _quantity_curves(study: Study, key: str) -> Iterator[Curve]:
    """Size, or for a lower limit the negative, of every bounded quantity of the design, in the unit of the limit."""
    bounds, factor = USER_BOUNDS[key][1], split_unit(key)[1].factor
    for name in bounded_quantities(study.design, key):
        value = quantity(name).value(study) / factor
        if bounds.most:
            yield Curve(np.abs(value), _same, _upper_margin)
        else:
            yield Curve(-value, lambda negative, _: -negative, _lower_margin)


def _missing_loads(study: Study) -> str:
    return "masses or a spring in [loads]" if study.loading.is_empty else ""


def _missing_contact(study: Study) -> str:
    if missing := _missing_loads(study):
        return missing
    return "" if pairings(study) else "the thickness of the cam and the materials of cam and follower"


# -- typical values ----------------------------------------------------------------------------------------


def _typical_pressure(study: Study) -> LimitValue:
    """By the pair between follower and frame; the lower limit where the linkage has no solution."""
    try:
        linkage = study.linkage
        pair = linkage.pairs.get(linkage.ground)
        kind = pair.kind if pair else REVOLUTE
    except NoSolution:
        kind = SLIDING
    motion = "slides" if kind == SLIDING else "swings"
    return LimitValue(PRESSURE_LIMITS[kind], f"typical where the follower {motion}", PRESSURE_SOURCE)


def _typical_convex(study: Study) -> LimitValue:
    """Half the radius of the largest roller; a sliding face or an edge wears off a sharper profile."""
    drive = study.design.drive
    if study.has_surface:
        return _reasoned(ROLLER_PART * drive.cam.roller_radius_mm, "half the roller's radius")
    if row_of(drive.face).rolls:
        largest = max(face.radius_mm for face in faces_of(drive.face, drive.cam).values())
        return _reasoned(ROLLER_PART * largest, "half the roller's radius")
    return _reasoned(SLIDING_RADIUS_MM, f"a sharper profile wears off under a {drive.face.noun}")


def _typical_polar(study: Study) -> LimitValue | None:
    """Room for hub, bore and keyway where one of them is given, else for the hub of a shaft that transmits the torque."""
    cam = study.design.drive.cam
    if study.has_surface:
        return None
    rows = []
    if cam.hub_mm is not None:
        reason = f"the hub of {cam.hub_mm:g} mm and a clearance of {HUB_CLEARANCE_MM:g} mm"
        rows.append((0.5 * cam.hub_mm + HUB_CLEARANCE_MM, reason))
    if cam.bore_mm is not None:
        reason = f"the bore of {cam.bore_mm:g} mm and a wall of a quarter of that"
        rows.append(((0.5 + WALL_PART) * cam.bore_mm, reason))
        if floor := 1e3 * keyway_reach(cam):
            reason = f"the floor of the keyway and an eighth of the bore of {cam.bore_mm:g} mm"
            rows.append((floor + FLOOR_PART * cam.bore_mm, reason))
    if rows:
        return _reasoned(*max(rows))
    torque = _greatest_torque(study)
    if not torque or not math.isfinite(torque):
        return None
    shaft = 1e3 * math.cbrt(16.0 * torque / (math.pi * TORSION_MPA * MPA))
    reason = (
        f"a shaft of {result_text(shaft, 3)} mm transmits {result_text(torque)} N·m at {TORSION_MPA:g} MPa (assumed), and its hub is "
        f"{HUB_PART:g} times as wide"
    )
    return _reasoned(0.5 * HUB_PART * shaft, reason)


def _greatest_torque(study: Study) -> float:
    """Greatest torque of the drive in size [N m]: refined, or at the study's cam angles; 0 where it has no forces."""
    if not _has_forces(study):
        return 0.0
    if study.full_turn is not study:
        return float(np.abs(study.shaft_torque).max())
    torque = extremes_of(study, "dynamics", ("drive_torque",))["drive_torque"]
    return max(abs(torque.low.value), abs(torque.high.value))


def _typical_face(study: Study) -> LimitValue | None:
    half = None if study.has_surface else getattr(study.design.drive.face, "face_half_width_mm", None)
    return None if half is None else _reasoned(half, "half the face's width")


def _typical_force(study: Study) -> LimitValue | None:
    """The design's limit, else a part of the largest contact force up to the reserve speed."""
    limit = getattr(study.design.drive.loads, FORCE.rpartition(".")[2], None)
    if limit:
        return LimitValue(limit, "the design's limit", USER)
    largest = study.contact_force.greatest(SPEED_RESERVE * abs(study.omega))
    return _reasoned(FORCE_PART * largest, f"{100.0 * FORCE_PART:g} % of the largest contact force")


def _typical_speed(study: Study) -> LimitValue:
    return _reasoned(
        SPEED_RESERVE * study.design.speed_rpm,
        f"{SPEED_RESERVE:g} times the design's speed, where inertia forces are 1.2 times as large",
    )


def _typical_base(study: Study) -> LimitValue | None:
    drive = study.design.drive
    if not row_of(drive.face).rolls:
        return None
    return _reasoned(drive.face.radius_mm / ROLLER_OF_BASE, "twice the roller's radius")


def _typical_roller(study: Study) -> LimitValue | None:
    """Half the base radius, which a cam under a linkage lacks."""
    base = getattr(study.design.drive.cam, "base_radius_mm", None)
    return None if base is None else _reasoned(ROLLER_OF_BASE * base, "half the base radius")


def _typical_rate(study: Study, rate: str) -> LimitValue | None:
    """Rate by which the force grows by a quarter of the preload over the stroke; None without a preload."""
    loads, (preload, unit) = study.design.drive.loads, SPRINGS[rate]
    present, displacement = getattr(loads, rate), extremes_of(study, "motion", ("displacement",))["displacement"]
    stroke = unit * (displacement.high.value - displacement.low.value)
    if not stroke or getattr(loads, preload, 0.0) <= 0.0:
        return None
    softest, strokes = RATE_PART * getattr(loads, preload) / stroke, 1.0 / RATE_PART
    if 0.0 < present < softest:
        return _reasoned(present, f"the current spring is already preloaded by more than {strokes:g} strokes")
    return _reasoned(softest, f"a softer spring must be preloaded by more than {strokes:g} strokes")


def _typical_contact_pressure(study: Study) -> LimitValue | None:
    """Allowable pressure of the weaker material, where known."""
    allowable, source = allowable_pressure(study)
    return None if allowable is None else LimitValue(allowable / MPA, source, source)


def _reasoned(value: float, reason: str) -> LimitValue:
    return LimitValue(value, reason, reason)


# -- the rows ----------------------------------------------------------------------------------------------

_STEEP = ("pressure-angle", "roller-pressure-angle", "second-pressure-angle")
_RISE, _RETURN = "pressure-angle-rise", "pressure-angle-return"
_BY_PAIR = "30 where the follower slides, 45 where it swings"

_ROWS: Mapping[str, Limit] = MappingProxyType(
    {
        ANY_PRESSURE: Limit("deg", True, partial(_pressure, sign=None), findings=(*_STEEP, _RISE, _RETURN)),
        "pressure_angle_rise_deg": Limit("deg", True, partial(_pressure, sign=1.0), _typical_pressure, _BY_PAIR, (*_STEEP, _RISE)),
        "pressure_angle_return_deg": Limit("deg", True, partial(_pressure, sign=-1.0), _typical_pressure, _BY_PAIR, (*_STEEP, _RETURN)),
        CONVEX: Limit(
            "mm", False, partial(_curvature, concave=False), _typical_convex,
            f"half the roller's radius; {SLIDING_RADIUS_MM:g} under a flat face, a shoe or an edge", ("convex-radius",),
        ),
        "concave_radius_mm": Limit("mm", False, partial(_curvature, concave=True), findings=("concave-radius",)),
        POLAR: Limit(
            "mm", False, _polar, _typical_polar,
            f"least distance of the profile from the cam centre: the hub and {HUB_CLEARANCE_MM:g} mm, the bore and a quarter of it, else "
            f"{0.5 * HUB_PART:g} times a shaft that transmits the torque at {TORSION_MPA:g} MPa",
            ("polar-radius",),
        ),
        "contact_on_face_mm": Limit(
            "mm", True, _on_face, _typical_face, "distance of the contact from the centre of a flat face: half its width",
            ("face-too-narrow",),
        ),
        "contact_force_n": Limit("N", True, _contact_force, findings=("contact-force",), missing=_missing_loads),
        "contact_pressure_mpa": Limit(
            "MPa", True, _contact_pressure, _typical_contact_pressure, findings=("contact-pressure", "material-pressure"),
            missing=_missing_contact,
        ),
    }
)  # fmt: skip


def _quantity_row(key: str) -> Limit:
    """Row of a limit of the user that has none in ``_ROWS``, from its field."""
    missing = _missing_loads if bounded_stage(key) == "dynamics" else _nothing_missing
    is_upper, unit = USER_BOUNDS[key][1].most, split_unit(key)[1].symbol
    return Limit(unit, is_upper, partial(_quantity_curves, key=key), findings=(finding_code(key),), missing=missing)


LIMITS: Mapping[str, Limit] = MappingProxyType(
    {**_ROWS, **{key: _quantity_row(key) for key in USER_BOUNDS if key not in _ROWS}}
)
"""Key -> limit: the keys of [limits], the pressure angle over the full turn, and the contact on a flat face.

Radii are those of the profile; a limit of 0 for the convex radius requires that the cam is not undercut.
"""

_LIFT_OFF = ("separation", "contact-force-low", "elastic-separation")
BOUNDS: Mapping[str, FieldBound] = MappingProxyType(
    {
        f"{FORCE}_min": FieldBound(
            _typical_force, f"the design's limit, else {100.0 * FORCE_PART:g} % of the largest contact force", _LIFT_OFF
        ),
        **{
            f"{path}_max": FieldBound(_typical_speed, f"{SPEED_RESERVE:g} times the design's speed", _LIFT_OFF)
            for path in SPEEDS
        },
        f"{BASE}_min": FieldBound(_typical_base, "twice the roller's radius"),
        f"{ROLLER}_max": FieldBound(_typical_roller, "half the base radius"),
        **{
            f"loads.{rate}_min": FieldBound(
                partial(_typical_rate, rate=rate), f"{RATE_PART:g} of the preload over the stroke"
            )
            for rate in SPRINGS
        },
    }
)
"""Path of a field with _min or _max -> its limit in a search."""


def needs_torque(study: Study) -> bool:
    """Whether the room for the shaft follows from the torque, since neither hub, bore nor limit is given."""
    drive = study.design.drive
    if study.has_surface:
        return False
    return drive.limits.polar_radius_mm is drive.cam.hub_mm is drive.cam.bore_mm is None


def limits_in_force(study: Study) -> Mapping[str, LimitValue]:
    """Typical limits that apply since the design states none: key in [limits] -> value and reason."""
    if study.design.drive.cam is None:
        return {}
    limits = {}
    for key in (row.name for row in fields(Limits) if getattr(study.design.drive.limits, row.name) is None):
        with suppress(NoSolution):
            if (value := LIMITS[key].typical(study)) is not None:
                limits[key] = value
    return limits


def limit_of(study: Study, key: str) -> LimitValue | None:
    """Limit of a row of ``LIMITS`` where a search gives none: the user's limit in the design, else the typical one."""
    limit = getattr(study.design.drive.limits, key, None)
    return LIMITS[key].typical(study) if limit is None else LimitValue(limit, "the design's limit", USER)
