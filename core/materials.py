"""Materials of cams and rollers: the table ``materials.toml`` of the resources, each figure with its source."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from types import MappingProxyType

from core.frozen import frozen
from core.process import resources


@frozen
class Material:
    """name as shown; Young's modulus [GPa] and Poisson's ratio with their source; the Hertz pressure [MPa] that it bears for good
    with its source, None where the name of the material does not tell it."""

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
"""Slug -> material, in the order in which they are offered."""
