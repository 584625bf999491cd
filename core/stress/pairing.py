"""What touches on each flank of a cam: materials, width, and what is missing for a stress."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from core.cam import SECOND, form_row, row_of
from core.design import Limits
from core.frozen import frozen
from core.materials import MATERIALS

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
