"""What a design can plot, table and export: the rows of ``core.study.quantities`` as this design has them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType

from core.design import Design
from core.study import QUANTITIES, Quantity, Study, names_of, quantity
from core.study.extremes import exists
from core.study.quantities import KINEMATICS, ORBIT, PROFILE, SERVO

ANGLES: Mapping[str, str] = MappingProxyType(
    {PROFILE: "cam_angle_deg", KINEMATICS: "cam_angle_deg", SERVO: "cam_angle_deg", ORBIT: "input_angle_deg"}
)
"""First column of the tables whose angle is one and the same in every kind of design: the cam's, or that of a flexible shaft's input."""


@lru_cache(maxsize=64)  # an edit of a length changes no name
def _rows_named(unit: str, names: tuple[str, ...]) -> tuple[Quantity, ...]:
    """First the rows that any design may have, then those of its links, with the unit of the motion and the face's formula."""
    shared = tuple(
        replace(row, slug=row.slug.format(m=unit)) for row in QUANTITIES.values() if row.slug and row.name in names
    )
    if "contact_on_face" in names:
        shared = tuple(
            replace(row, equation=row.flat, source="support function of the face") if row.flat else row
            for row in shared
        )
    return (*shared, *(quantity(name) for name in names if name not in QUANTITIES))


def channels(design: Design, stages: Iterable[str] = ()) -> tuple[Quantity, ...]:
    """A row for each quantity of this very design that a reader can see, of the named stages or of all, in the order of the tables."""
    rows, wanted = _rows_named(design.drive.motion_unit, names_of(design)), tuple(stages)
    return tuple(row for row in rows if not wanted or row.stage in wanted)


def channel(design: Design, slug: str) -> Quantity:
    """One row of a design by its slug. Raises KeyError."""
    rows = channels(design)
    for row in rows:
        if row.slug == slug:
            return row
    raise KeyError(f"{slug}: no such channel; allowed: {', '.join(row.slug for row in rows)}")


def existing(study: Study, rows: Iterable[Quantity]) -> list[Quantity]:
    """Those rows that this very design has."""
    return [row for row in rows if exists(study, row)]
