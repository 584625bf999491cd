"""Hertz stress where the follower touches the cam, its limits, and the rolling life of the follower's rollers.

Sources: H. Hertz 1881; K. L. Johnson, *Contact Mechanics*, ch. 4.2 (line contact of two cylinders); ISO 281 (rolling life).
"""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees, inf, pi, sqrt
from types import MappingProxyType
from typing import Any

import numpy as np

from core.cam import OUTER, SECOND, Flank, form_row, row_of
from core.cam.forms import ROUNDING
from core.design import Limits
from core.findings import NOTE, WARNING, Finding
from core.frozen import frozen
from core.materials import MATERIALS
from core.mechanism.kinematics import Kinematics
from core.motion import TURN
from core.motion.extremes import Extreme

GPA, MPA, MM, HOUR, MILLION = 1e9, 1e6, 1e-3, 3600.0, 1e6
_GOLDEN = 0.5 * (1.0 + sqrt(5.0))
SHEAR_DEPTH = _GOLDEN**-0.5
"""Depth of the largest shear in half widths, 0.786151: p (z - z²/√(1 + z²)) is largest where z⁴ + z² = 1."""
SHEAR = _GOLDEN**-2.5
"""Largest shear as a fraction of the contact pressure, 0.300283."""
METAL_POISSON_RATIO = 0.3
"""Poisson's ratio for a typed modulus without one."""
LIFE_EXPONENT = 10.0 / 3.0
"""Exponent of the life of roller bearings, ISO 281."""
_PRESSURE_LIMIT = "limits.contact_pressure_mpa"


# -- materials of a contact -----------------------------------------------------------------------------------


@frozen
class Surface:
    """One of the two bodies of a contact.

    Attributes
    ----------
    path : str
        Field of the design that chooses its material.
    noun : str
        "cam", or the follower's face in words, for messages.
    modulus : float [Pa]
        Young's modulus E.
    ratio : float, dimensionless
        Poisson's ratio ν.
    allowable : float or None [Pa]
        Allowable contact pressure; None where none is published.
    name, source : str
        Material, and the publication of its allowable pressure.
    """

    path: str
    noun: str
    modulus: float
    ratio: float
    allowable: float | None = None
    name: str = ""
    source: str = ""


@frozen
class Pairing:
    """Two surfaces in line contact over the width b [m]."""

    width: float
    surfaces: tuple[Surface, Surface]

    @property
    def modulus(self) -> float:
        """Contact modulus E* [Pa]: 1/E* = Σ (1 - ν²)/E."""
        return 1.0 / sum((1.0 - surface.ratio**2) / surface.modulus for surface in self.surfaces)


_MATERIAL_FIELDS = ("material", "youngs_modulus_gpa", "poisson_ratio")
_Tables = tuple[tuple[str, Any], ...]


def _tables_by_flank(cam: Any) -> Mapping[str, _Tables]:
    """Flank -> the (path, table) pairs of its inputs, first match wins: a second cam inherits what it does not state."""
    first = (("cam", cam),)
    second = (("cam.second", cam.form.second), *first) if SECOND in form_row(cam.form).flanks else first
    return {flank: second if flank == SECOND else first for flank in form_row(cam.form).flanks}


def _input(tables: _Tables, key: str) -> tuple[str, Any]:
    """Path and value of an input; of the last table, with None, where no table states it."""
    for path, table in tables:
        if (value := getattr(table, key, None)) is not None:
            return f"{path}.{key}", value
    return f"{tables[-1][0]}.{key}", None


def _surface(tables: _Tables, prefix: str, noun: str) -> Surface | None:
    """The cam's surface (prefix "") or the roller's ("roller_"); None where its modulus is unknown."""
    path, slug = _input(tables, f"{prefix}material")
    modulus_path, modulus = _input(tables, f"{prefix}youngs_modulus_gpa")
    _, ratio = _input(tables, f"{prefix}poisson_ratio")
    material = MATERIALS.get(slug) if slug is not None else None
    if material is None:
        if modulus is None:
            return None
        return Surface(modulus_path, noun, GPA * modulus, METAL_POISSON_RATIO if ratio is None else ratio)
    pressure = material.contact_pressure_mpa
    return Surface(
        path,
        noun,
        GPA * (material.youngs_modulus_gpa if modulus is None else modulus),
        material.poisson_ratio if ratio is None else ratio,
        None if pressure is None else MPA * pressure,
        material.name,
        material.pressure_source,
    )


def is_line_contact(face: Any) -> bool:
    """Whether the face touches along a line, so that Hertz's equations hold: a knife edge does not."""
    return bool(face.straight or face.radius_mm)


def missing_inputs(face: Any, cam: Any) -> Mapping[str, str]:
    """Field path -> the input in words, of every input without which a flank has no stress."""
    missing: dict[str, str] = {}
    for tables in _tables_by_flank(cam).values():
        path, width = _input(tables, "thickness_mm")
        if width is None:
            missing[path] = "the thickness of the cam"
        for prefix, noun in (("", "cam"), ("roller_", face.noun)):
            if _surface(tables, prefix, noun) is None:
                missing[f"{tables[-1][0]}.{prefix}material"] = f"the material of the {noun}, or its Young's modulus"
    return missing


def pairings(face: Any, cam: Any) -> Mapping[str, Pairing]:
    """Flank -> its contact; empty for a knife edge, or where an input is missing."""
    if not is_line_contact(face) or missing_inputs(face, cam):
        return MappingProxyType({})
    result = {}
    for flank, tables in _tables_by_flank(cam).items():
        surfaces = _surface(tables, "", "cam"), _surface(tables, "roller_", face.noun)
        assert surfaces[0] is not None and surfaces[1] is not None, "no input is missing"  # noqa: PT018
        result[flank] = Pairing(MM * _input(tables, "thickness_mm")[1], (surfaces[0], surfaces[1]))
    return MappingProxyType(result)


def load_ratings(face: Any, cam: Any) -> Mapping[str, float]:
    """Roller ("first", "second") -> dynamic load rating C of its bearing [N], where stated; empty for a sliding face."""
    if not row_of(face).rolls:
        return MappingProxyType({})
    ratings = {
        "second" if flank == SECOND else "first": _input(tables, "roller_load_rating_n")[1]
        for flank, tables in _tables_by_flank(cam).items()
    }
    return MappingProxyType({roller: rating for roller, rating in ratings.items() if rating is not None})


def is_stress_requested(cam: Any, limits: Limits) -> bool:
    """Whether the design states a pressure limit, or a material of cam or roller."""
    tables = [table for rows in _tables_by_flank(cam).values() for _, table in rows]
    keys = [prefix + key for prefix in ("", "roller_") for key in _MATERIAL_FIELDS]
    return limits.contact_pressure_mpa is not None or any(getattr(t, key) is not None for t in tables for key in keys)


# -- Hertz ----------------------------------------------------------------------------------------------------


@frozen(eq=False)
class ContactStress:
    """Stresses on one flank; 0 without contact force, NaN where the face does not fit the profile.

    Attributes
    ----------
    pressure : ndarray (n,) [Pa]
        Contact pressure p in the middle of the contact.
    shear : ndarray (n,) [Pa]
        Largest shear below the surface.
    depth : ndarray (n,) [m]
        Depth of the largest shear.
    half_width : ndarray (n,) [m]
        Half the width a of the contact.
    """

    pressure: np.ndarray
    shear: np.ndarray
    depth: np.ndarray
    half_width: np.ndarray


def relative_curvature(flank: Flank) -> np.ndarray:
    """Relative curvature of a flank and the face on it, positive where convex.

    1/r + κ on the inner flank, 1/r - κ on the outer one, whose material lies on the other side; 1/ρ under a straight face.
    Written with the profile's offset o from the pitch curve, κ = κ_p/(1 - o κ_p), so that nothing cancels:
    [1 - (o ∓ r) κ_p]/[r (1 - o κ_p)].

    Parameters
    ----------
    flank : Flank
        With pitch curvature κ_p (n,) [1/m], offset o and face radius r [m].

    Returns
    -------
    ndarray (n,) [1/m]
        Not positive where the profile is undercut; infinite for an edge.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        if flank.straight:
            return np.asarray(1.0 / flank.profile_radius)
        side = -1.0 if flank.name == OUTER else 1.0
        curvature, offset, radius = flank.pitch_curvature, flank.offset, flank.radius
        return np.asarray((1.0 - (offset - side * radius) * curvature) / (radius * (1.0 - offset * curvature)))


def contact_pressure(force: np.ndarray, curvature: np.ndarray, pairing: Pairing) -> np.ndarray:
    """Contact pressure in the middle of the line contact, p = √(F E* κ_rel/(π b)).

    Parameters
    ----------
    force : ndarray (n,) [N]
        Contact force F; the pressure is 0 where F ≤ 0.
    curvature : ndarray (n,) [1/m]
        Relative curvature κ_rel; the pressure is NaN where it is not positive.
    pairing : Pairing
        Contact modulus E* and width b.

    Returns
    -------
    ndarray (n,) [Pa]

    References
    ----------
    Johnson, *Contact Mechanics*, eq. (4.45).
    Hertz, line contact.
    """
    positive = np.where(curvature > 0.0, curvature, np.nan)
    return np.sqrt(np.maximum(force, 0.0) * pairing.modulus * positive / (pi * pairing.width))


def contact_stress(flank: Flank, force: np.ndarray, pairing: Pairing) -> ContactStress:
    """Pressure, largest shear, its depth and the contact's half width a = 2p/(E* κ_rel) under a force.

    Parameters
    ----------
    flank : Flank
    force : ndarray (n,) [N]
        Contact force that presses on the flank.
    pairing : Pairing

    Returns
    -------
    ContactStress

    References
    ----------
    Johnson, *Contact Mechanics*, eqs. (4.43), (4.45), and the stresses on the axis in ch. 4.2.
    Hertz, line contact.
    """
    curvature = relative_curvature(flank)
    pressure = contact_pressure(force, curvature, pairing)
    with np.errstate(divide="ignore", invalid="ignore"):
        half_width = np.asarray(2.0 * pressure / (pairing.modulus * curvature))
    return ContactStress(pressure, SHEAR * pressure, SHEAR_DEPTH * half_width, half_width)


# -- rolling life ---------------------------------------------------------------------------------------------


@frozen
class RollerLife:
    """Life of one roller, infinite without load.

    Attributes
    ----------
    roller : str
        "first" or "second".
    load : float [N]
        Equivalent load P.
    rpm : float [1/min]
        Mean speed of the roller about its axis.
    million_turns, hours : float [10⁶ turns], [h]
        Life L10.
    """

    roller: str
    load: float
    rpm: float
    million_turns: float
    hours: float


def roller_speed(kinematics: Kinematics, flank: Flank, sense: float) -> np.ndarray:
    """Speed ratio ω_r/ω of a roller about its axis, which rolls on a flank without slip.

    ω_r/ω = d - α' ∓ d|t|/r on the inner and outer flank: t the velocity of the roller's centre relative to the cam, by cam
    angle, α the angle of its arm, r its radius, d the sense of rotation. In a groove with play the roller rolls on the flank
    in contact.

    Returns
    -------
    ndarray (n,), dimensionless

    References
    ----------
    Rolling without slip.
    """
    side = -1.0 if flank.name == OUTER else 1.0
    radius = getattr(flank, "radius", 0.0)
    arm_speed = kinematics.bodies[flank.body].turn[1]
    return np.asarray(sense - arm_speed - side * sense * np.abs(flank.relative_velocity) / radius)


@np.errstate(divide="ignore", invalid="ignore")
def rolling_life(
    rating: Any, force: np.ndarray, speed_ratio: np.ndarray, weights: np.ndarray, omega: Any
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Life L10 = (C/P)^(10/3) of a roller, P^(10/3) = ∫F^(10/3)|ω_r|dt/∫|ω_r|dt.

    Parameters
    ----------
    rating : float or ndarray (...,) [N]
        Dynamic load rating C.
    force : ndarray (..., n) [N]
        Force on the roller at the nodes of `turn_quadrature`; leading axes are designs.
    speed_ratio : ndarray (..., n), dimensionless
        Speed ratio ω_r/ω of the roller, from `roller_speed`.
    weights : ndarray (n,) [rad]
        Weights of the quadrature.
    omega : float or ndarray (...,) [rad/s]
        Speed of the shaft.

    Returns
    -------
    load, rpm, million_turns, hours : ndarray (...,) [N], [1/min], [10⁶ turns], [h]
        Equivalent load P, mean speed of the roller, L10; infinite without load.

    References
    ----------
    ISO 281, roller bearings; the equivalent load of a load that varies over the turn.
    """
    rolled = np.abs(speed_ratio) * weights
    roller_angle = rolled.sum(axis=-1)  # [rad] that the roller turns in one turn of the shaft
    mean_power = (np.maximum(force, 0.0) ** LIFE_EXPONENT * rolled).sum(axis=-1) / roller_angle
    load = np.where(roller_angle > 0.0, mean_power, 0.0) ** (1.0 / LIFE_EXPONENT)
    roller_omega = roller_angle / TURN * omega
    million_turns = np.where(load > 0.0, (rating / load) ** LIFE_EXPONENT, inf)
    hours = np.where(load > 0.0, million_turns * MILLION * TURN / roller_omega / HOUR, inf)
    return load, roller_omega * 30.0 / pi, million_turns, hours


# -- findings -------------------------------------------------------------------------------------------------


def pressure_findings(worst: Mapping[str, Extreme], pairings: Mapping[str, Pairing], limits: Limits) -> list[Finding]:
    """Pressures beyond the user's limit, or without one the allowable one of a material; worst: flank -> greatest pressure [Pa]."""
    findings = []
    greatest, limit = max(worst.values(), key=lambda extreme: extreme.value), limits.contact_pressure_mpa
    if limit is not None and greatest.value > MPA * limit * (1.0 + ROUNDING):
        values: dict[str, float | str] = {"value": greatest.value / MPA, "limit": limit}
        findings.append(Finding("contact-pressure", WARNING, _PRESSURE_LIMIT, degrees(greatest.theta), values))
    if limit is not None:
        return findings
    surfaces = {surface.path: surface for pairing in pairings.values() for surface in pairing.surfaces}
    for path, surface in surfaces.items():
        flanks = [flank for flank in worst if any(s.path == path for s in pairings[flank].surfaces)]
        if not flanks or surface.allowable is None:
            continue
        extreme = max((worst[flank] for flank in flanks), key=lambda extreme: extreme.value)
        if extreme.value > surface.allowable * (1.0 + ROUNDING):
            values = {
                "value": extreme.value / MPA,
                "limit": surface.allowable / MPA,
                "what": surface.noun,
                "material": surface.name,
                "source": surface.source,
            }
            findings.append(Finding("material-pressure", WARNING, path, degrees(extreme.theta), values))
    return findings


def missing_input_findings(face: Any, cam: Any, limits: Limits) -> list[Finding]:
    """Reason why a requested stress has no value: a knife edge has none, or an input is missing."""
    if not is_stress_requested(cam, limits):
        return []
    has_limit = limits.contact_pressure_mpa is not None
    severity = WARNING if has_limit else NOTE
    if not is_line_contact(face):
        field = _PRESSURE_LIMIT if has_limit else "cam.material"
        return [Finding("no-contact-pressure-edge", severity, field, None, {"face": face.noun})]
    missing = missing_inputs(face, cam)
    if not missing:
        return []
    values: dict[str, float | str] = {"missing": ", and ".join(missing.values()), "fields": ", ".join(missing)}
    return [Finding("no-contact-pressure", severity, next(iter(missing)), None, values)]


def undercut_finding(face_noun: str, limits: Limits) -> Finding:
    """Finding that the profile is undercut, so that it has no stress."""
    severity = NOTE if limits.contact_pressure_mpa is None else WARNING
    return Finding("no-contact-pressure-undercut", severity, "cam", None, {"face": face_noun})
