"""Random linkages that can be assembled, solved once and shared by the tests: every kind of dyad, every pair of kinds
after one another, some chains of three; each at the driver angle at which it was drawn."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from linkages import KINDS, assembly

from core.design import Design
from core.instant_centres import CentreTable, all_centres
from core.mechanism import DriverRanges, driver_ranges_of, unit_speed_kinematics
from core.mechanism.kinematics import FRAME, Kinematics

SIZE = 0.1  # of the linkages [m]
TWICE = 2  # linkages of each chain


@dataclass(frozen=True, eq=False)
class Case:
    """A linkage at one driver angle q [rad], its driver at unit speed."""

    name: str
    design: Design
    q: float
    driver_ranges: DriverRanges
    kinematics: Kinematics

    @cached_property
    def table(self) -> CentreTable:
        return all_centres(self.kinematics, SIZE)

    @cached_property
    def x(self) -> np.ndarray:
        """x, y [mm] and angle of every moving link (3m,)."""
        return coordinates(self.kinematics)[:, 0]


def coordinates(kinematics: Kinematics, order: int = 0) -> np.ndarray:
    """x, y [mm] and angle of every moving link (3m, n), or their derivatives."""
    rows = []
    for name, pose in kinematics.bodies.items():
        if name != FRAME:
            rows += [pose.x[order] * 1e3, pose.y[order] * 1e3, pose.angle[order]]
    return np.array(rows)


def _chains(first: str, most: int) -> list[tuple[str, ...]]:
    chains: list[tuple[str, ...]] = [(first,), *((first, second) for second in KINDS)]
    if most > 2:
        chains += [(first, second, KINDS[(i + len(first)) % len(KINDS)]) for i, second in enumerate(KINDS)]
    return chains


@lru_cache(maxsize=256)
def case(kinds: tuple[str, ...], number: int) -> Case:
    """A linkage whose dyads are of these kinds, hung on what is there before them."""
    name = f"{'-'.join(kinds)}/{number}"
    design, q = assembly(zlib.crc32(name.encode()), kinds)
    driver_ranges = driver_ranges_of(design.drive.mechanism)
    return Case(
        name, design, q, driver_ranges, unit_speed_kinematics(design.drive.mechanism, np.array([q]), driver_ranges)
    )


def cases(first: str, most: int = 2) -> list[Case]:
    """Twelve linkages that begin with a dyad of this kind; with chains of three twenty-two."""
    return [case(kinds, number) for kinds in _chains(first, most) for number in range(TWICE)]
