"""Limits of the contact's stress: the user's own, that of the materials, and what is missing to know it."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from math import ceil, degrees, inf, pi, radians, sqrt
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
from core.motion import TURN, Angles
from core.motion.extremes import Extreme, Pieces
from core.numerics.roots import gauss_legendre

# -- life of a roller on its own bearing (ISO 281), by its own speed over the turn ------------------------------


EXPONENT = 10.0 / 3.0
"""Of roller bearings, in ISO 281."""
PANEL, NODES = radians(2.0), 8  # width and points of a Gauss panel
MILLION, HOUR = 1e6, 3600.0


@frozen
class RollerLife:
    """roller: ``first`` or ``second``; load: the equivalent P [N]; rpm: its mean speed about its own axis; L10 in million turns of
    the roller and in hours, infinite where nothing loads it."""

    roller: str
    load: float
    rpm: float
    million_turns: float
    hours: float


def roller_speed(kinematics: Kinematics, flank: Flank, sense: float) -> np.ndarray:
    """ω_r/ω (n,): the turn of a roller that rolls on a flank, about its own axis, by cam angle.

    d - α' ∓ d|t|/r (inner, outer flank): t the velocity of its centre relative to the cam, α the angle of what carries it. In a
    groove with play the roller is taken to roll without slip on the flank that carries.
    """
    radius = getattr(flank, "radius", 0.0)
    side = -1.0 if flank.name == OUTER else 1.0
    carried = kinematics.bodies[flank.body].turn[1]
    return np.asarray(sense - carried - side * sense * np.abs(flank.relative_velocity) / radius)


def turn_nodes(program: Pieces, breaks: tuple[float, ...], longest: float = PANEL) -> tuple[Angles, np.ndarray]:
    """Angles (n,) and weights (n,) [rad] by which the values there are integrated over the turn: panels of Gauss within the pieces
    of the motion and between further breaks [rad]; longest: [rad] a panel."""
    x, w = gauss_legendre(NODES)
    theta, weight, piece = [], [], []
    for number, (a, b) in enumerate(zip(program.starts.tolist(), program.ends.tolist(), strict=True)):
        inner = [a, *sorted(each for each in breaks if a < each < b), b]
        for start, end in pairwise(inner):
            edges = np.linspace(start, end, max(1, ceil((end - start) / longest)) + 1)
            half = 0.5 * np.diff(edges)[:, None]
            theta.append((edges[:-1, None] + half * (1.0 + x)).ravel())
            weight.append((half * w).ravel())
            piece.append(np.full(theta[-1].size, number))
    return Angles(np.concatenate(theta), np.concatenate(piece)), np.concatenate(weight)


def life_of(
    roller: str, rating: float, force: np.ndarray, speed: np.ndarray, weight: np.ndarray, omega: float
) -> RollerLife:
    """That of a roller, as by ``lives_of``."""
    return RollerLife(roller, *(float(each) for each in lives_of(rating, force, speed, weight, omega)))


@np.errstate(divide="ignore", invalid="ignore")
def lives_of(
    rating: Any, force: np.ndarray, speed: np.ndarray, weight: np.ndarray, omega: Any
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """L10 = (C/P)^(10/3) million turns, P^(10/3) = ∫F^(10/3)|ω_r|dt/∫|ω_r|dt (ISO 281): P [N], rpm of the roller, L10 in million turns and
    in hours.

    rating C [N]; force (..., n) [N] on the roller and its speed ω_r/ω (..., n), by cam angle, with the weights [rad] of a turn; omega
    [rad/s] of the shaft; rating and omega one or (...,)
    """
    turning = np.abs(speed) * weight
    whole = turning.sum(axis=-1)  # [rad] of the roller in a turn of the shaft
    power = (np.maximum(force, 0.0) ** EXPONENT * turning).sum(axis=-1) / whole
    load, rpm = np.where(whole > 0.0, power, 0.0) ** (1.0 / EXPONENT), whole / TURN * omega * 30.0 / pi
    turns = np.where(load > 0.0, (rating / load) ** EXPONENT, inf)
    return load, rpm, turns, np.where(load > 0.0, turns * MILLION * TURN / (whole / TURN * omega) / HOUR, inf)


# -- what touches on each flank of a cam ------------------------------------------------------------------------


USUAL_RATIO = 0.3
"""Poisson's ratio of a typed modulus without one: that of metals."""
GPA, MPA, MM = 1e9, 1e6, 1e-3
_CAM, _ROLLER = "", "roller_"


@frozen
class Surface:
    """path: the field that chooses it; what: cam or roller, in messages; modulus [Pa], ratio; allowable pressure [Pa] with its
    source, None where none is known; name: of the material."""

    path: str
    what: str
    modulus: float
    ratio: float
    allowable: float | None = None
    name: str = ""
    source: str = ""


@frozen
class Pairing:
    """Two surfaces that touch in a line of this width [m]."""

    width: float
    surfaces: tuple[Surface, Surface]

    @property
    def modulus(self) -> float:
        """E* [Pa]: 1/E* = Σ (1 - ν²)/E."""
        return 1.0 / sum((1.0 - each.ratio**2) / each.modulus for each in self.surfaces)


def _tables(cam: Any) -> Mapping[str, tuple[tuple[str, Any], ...]]:
    """Flank -> the tables that its entries stand in, with their paths: what the second cam does not state is as of the first."""
    first = (("cam", cam),)
    return {
        name: (("cam.second", cam.form.second), *first) if name == SECOND else first
        for name in form_row(cam.form).flanks
    }


def _entry(tables: tuple[tuple[str, Any], ...], key: str) -> tuple[str, Any]:
    """The path and value of an entry in the first table that states it; in the last, where none does."""
    return next(
        ((f"{path}.{key}", value) for path, table in tables if (value := getattr(table, key, None)) is not None),
        (f"{tables[-1][0]}.{key}", None),
    )


def _surface(tables: tuple[tuple[str, Any], ...], prefix: str, what: str) -> Surface | None:
    """One of the two surfaces; None where its modulus is not known."""
    path, slug = _entry(tables, f"{prefix}material")
    typed_path, typed = _entry(tables, f"{prefix}youngs_modulus_gpa")
    ratio = _entry(tables, f"{prefix}poisson_ratio")[1]
    known = MATERIALS.get(slug) if slug is not None else None
    if known is None:
        return (
            None if typed is None else Surface(typed_path, what, GPA * typed, USUAL_RATIO if ratio is None else ratio)
        )
    return Surface(
        path,
        what,
        GPA * (known.youngs_modulus_gpa if typed is None else typed),
        known.poisson_ratio if ratio is None else ratio,
        None if known.contact_pressure_mpa is None else MPA * known.contact_pressure_mpa,
        known.name,
        known.pressure_source,
    )


def has_width(face: Any) -> bool:
    """Whether a face touches in a line that Hertz's equations hold for: an edge does not."""
    return bool(face.straight or face.radius_mm)


def missing(face: Any, cam: Any) -> Mapping[str, str]:
    """Field -> what must be given there for a stress on every flank; empty where all is known."""
    found: dict[str, str] = {}
    for tables in _tables(cam).values():
        path, width = _entry(tables, "thickness_mm")
        if width is None:
            found[path] = "the thickness of the cam"
        for prefix, what in ((_CAM, "cam"), (_ROLLER, face.noun)):
            if _surface(tables, prefix, what) is None:
                found[f"{tables[-1][0]}.{prefix}material"] = f"the material of the {what}, or its Young's modulus"
    return found


def pairings(face: Any, cam: Any) -> Mapping[str, Pairing]:
    """Flank -> what touches there; empty where anything is missing, or the face is an edge."""
    if not has_width(face) or missing(face, cam):
        return MappingProxyType({})
    found = {}
    for flank, tables in _tables(cam).items():
        one, other = _surface(tables, _CAM, "cam"), _surface(tables, _ROLLER, face.noun)
        assert one is not None, "nothing is missing"
        assert other is not None, "nothing is missing"
        found[flank] = Pairing(MM * _entry(tables, "thickness_mm")[1], (one, other))
    return MappingProxyType(found)


def ratings(face: Any, cam: Any) -> Mapping[str, float]:
    """Roller, ``first`` or ``second``, -> the dynamic load rating C of its bearing [N], where it is stated; none of a face that
    slides."""
    if not row_of(face).rolls:
        return MappingProxyType({})
    names = {"second" if flank == SECOND else "first": tables for flank, tables in _tables(cam).items()}
    stated = {name: _entry(tables, "roller_load_rating_n")[1] for name, tables in names.items()}
    return MappingProxyType({name: value for name, value in stated.items() if value is not None})


_ASKING = (
    "material",
    "roller_material",
    "youngs_modulus_gpa",
    "roller_youngs_modulus_gpa",
    "poisson_ratio",
    "roller_poisson_ratio",
)


def asked_for(cam: Any, limits: Limits) -> bool:
    """Whether the user wants to know a stress: a limit of it is stated, or what cam or roller are made of."""
    tables = [table for rows in _tables(cam).values() for _, table in rows]
    return limits.contact_pressure_mpa is not None or any(
        getattr(table, key) is not None for table in tables for key in _ASKING
    )


# -- limits of the contact's stress -----------------------------------------------------------------------------


_LIMIT = "limits.contact_pressure_mpa"


def pressure_findings(worst: Mapping[str, Extreme], pairing: Mapping[str, Pairing], limits: Limits) -> list[Finding]:
    """A pressure beyond the user's own limit, or beyond what one of the materials bears; worst: flank -> the greatest [Pa] there."""
    found = []
    most, own = max(worst.values(), key=lambda extreme: extreme.value), limits.contact_pressure_mpa
    if own is not None and most.value > MPA * own * (1.0 + ROUNDING):
        values: dict[str, float | str] = {"value": most.value / MPA, "limit": own}
        found.append(Finding("contact-pressure", WARNING, _LIMIT, degrees(most.theta), values))
    by_surface: dict[str, Extreme] = {}
    surfaces = {each.path: each for pair in pairing.values() for each in pair.surfaces}
    for flank, extreme in worst.items():
        for each in pairing[flank].surfaces:
            known = by_surface.get(each.path)
            by_surface[each.path] = extreme if known is None or extreme.value > known.value else known
    for path, extreme in by_surface.items():
        surface = surfaces[path]
        if surface.allowable is not None and extreme.value > surface.allowable * (1.0 + ROUNDING):
            values = {
                "value": extreme.value / MPA, "limit": surface.allowable / MPA, "what": surface.what, "material": surface.name,
                "source": surface.source,
            }  # fmt: skip
            found.append(Finding("material-pressure", WARNING, path, degrees(extreme.theta), values))
    return found


def missing_findings(face: Any, cam: Any, limits: Limits) -> list[Finding]:
    """Why there is no stress where one is asked for: an edge has none, or what must be given."""
    if not asked_for(cam, limits):
        return []
    severity = NOTE if limits.contact_pressure_mpa is None else WARNING
    if not has_width(face):
        return [
            Finding(
                "no-contact-pressure-edge",
                severity,
                _LIMIT if severity == WARNING else "cam.material",
                None,
                {"face": face.noun},
            )
        ]
    lacking = missing(face, cam)
    if not lacking:
        return []
    values: dict[str, float | str] = {"missing": ", and ".join(lacking.values()), "fields": ", ".join(lacking)}
    return [Finding("no-contact-pressure", severity, next(iter(lacking)), None, values)]


def unfit_finding(noun: str, limits: Limits) -> Finding:
    """There is no stress where the profile is undercut."""
    severity = NOTE if limits.contact_pressure_mpa is None else WARNING
    return Finding("no-contact-pressure-undercut", severity, "cam", None, {"face": noun})


# -- hertz's line contact of two cylinders, one of which may be hollow (Hertz 1881 ------------------------------


_GOLDEN = 0.5 * (1.0 + sqrt(5.0))
DEPTH = _GOLDEN**-0.5
"""Of the largest shear, in half widths of the contact: 0.786151. With z in half widths the principal shear below the middle is
p (z - z²/√(1 + z²)), largest where z⁴ + z² = 1."""
SHEAR = _GOLDEN**-2.5
"""The largest shear there, in parts of the pressure: 0.300283."""


@frozen(eq=False)
class ContactStress:
    """On one flank at n cam angles: pressure in the middle of the contact and the largest shear below it [Pa], the depth of that
    and half the width of the contact [m]; 0 where nothing presses, NaN where what touches does not fit the profile."""

    pressure: np.ndarray
    shear: np.ndarray
    depth: np.ndarray
    half_width: np.ndarray


def relative_curvature(flank: Flank) -> np.ndarray:
    """κ_rel (n,) [1/m] of a flank and what touches it, convex positive: 1/r + κ of the inner flank, 1/r - κ of the outer one,
    whose material lies on the other side; 1/ρ under a straight face.

    With the offset o of the profile κ = κ_p/(1 - o κ_p), so that nothing cancels: [1 - (o ∓ r) κ_p]/[r (1 - o κ_p)], which is
    1/[r (1 - r κ_p)] without play. At most 0 where what touches is undercut, infinite for an edge.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        if flank.straight:
            return np.asarray(1.0 / flank.profile_radius)
        side = -1.0 if flank.name == OUTER else 1.0
        bend, offset, radius = flank.pitch_curvature, flank.offset, flank.radius
        return np.asarray((1.0 - (offset - side * radius) * bend) / (radius * (1.0 - offset * bend)))


def pressure(force: np.ndarray, curvature: np.ndarray, pairing: Pairing) -> np.ndarray:
    """p = √(F E* κ_rel/(π b)) (n,) [Pa] of the force F (n,) [N] on a line of length b; 0 where F does not press, NaN where the
    relative curvature (n,) [1/m] is not positive: what touches does not fit there."""
    fits = np.where(curvature > 0.0, curvature, np.nan)
    return np.sqrt(np.maximum(force, 0.0) * pairing.modulus * fits / (pi * pairing.width))


def half_width(pressure: np.ndarray, curvature: np.ndarray, pairing: Pairing) -> np.ndarray:
    """a = 2p/(E* κ_rel) (n,) [m], which is √(4F/(π b E* κ_rel))."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(2.0 * pressure / (pairing.modulus * curvature))


def shear_depth(half_width: np.ndarray) -> np.ndarray:
    """Depth (n,) [m] of the largest shear."""
    return DEPTH * half_width


def contact_stresses(flank: Flank, force: np.ndarray, pairing: Pairing) -> ContactStress:
    """The stresses on a flank under the force (n,) [N] that presses on it."""
    curvature = relative_curvature(flank)
    pressed = pressure(force, curvature, pairing)
    half = half_width(pressed, curvature, pairing)
    return ContactStress(pressed, SHEAR * pressed, shear_depth(half), half)
