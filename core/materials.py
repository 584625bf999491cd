"""Materials of cams and rollers, from ``materials.toml`` in the resources, each figure with its source."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from types import MappingProxyType

from core.frozen import frozen
from core.process import resources


@frozen
class Material:
    """Elastic constants of a material, and its allowable contact pressure.

    Attributes
    ----------
    name : as shown to the user
    youngs_modulus_gpa : Young's modulus [GPa]
    poisson_ratio : Poisson's ratio
    source : publication of the elastic constants
    contact_pressure_mpa : allowable Hertz pressure in endurance [MPa], None where it depends on more than the material's name
    pressure_source : publication of the allowable pressure
    """

    name: str
    youngs_modulus_gpa: float
    poisson_ratio: float
    source: str
    contact_pressure_mpa: float | None = None
    pressure_source: str = ""


def _read() -> Mapping[str, Material]:
    table = tomllib.loads((resources() / "materials.toml").read_text("utf-8"))
    return MappingProxyType({row.pop("slug"): Material(**row) for row in table["material"]})


MATERIALS = _read()
"""Slug -> material, in the order of the menus."""
