"""A linkage at one position: its instant centres, what its links do, where its points are and go; as tables, as what the
command ``centres`` prints, and to be drawn."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np

from core.design import require_linkage
from core.frozen import frozen
from core.instant_centres import (
    CHAINS,
    Centres,
    RatioArms,
    angular_ratio,
    mechanical_advantage,
    ratio_arms,
    velocity_differences,
)
from core.mechanism import body_name, link_number
from core.mechanism.kinematics import FRAME
from core.study import Study, quantity

Links = tuple[int, int]
_MM = 1e3


@frozen
class CentreRow:
    """The instant centre of two links: ``place`` [m], or ``direction`` [rad] where it is at infinity; neither where the
    two do not move against each other. lines: the third links by whose lines Kennedy's theorem finds it, empty where a
    pair shows it at sight."""

    links: Links
    place: complex | None
    direction: float | None
    lines: tuple[int, ...] = ()


@frozen
class LinkRow:
    """A moving link: angular velocity [rad/s]; its ratio to the driver's and the mechanical advantage there, NaN where
    the driver slides."""

    link: int
    omega: float
    ratio: float
    advantage: float


@frozen
class PointRow:
    """A named point: place [m] and velocity [m/s]."""

    name: str
    place: complex
    velocity: complex


@frozen
class DifferenceRow:
    """One triangle of the velocity polygon, V_P = V_A + V_PA [m/s]: A and P are points of one link (``link`` = ``on``), or
    coincide while ``link`` slides on ``on``."""

    kind: str
    link: int
    on: int
    a: str
    p: str
    v_a: complex
    v_pa: complex
    v_p: complex


@frozen(eq=False)
class Position:
    """A linkage at the first angle of a study, in tables that are made when they are read: rows by links and by names, in
    rising order. Each raises NoPosition where the linkage cannot stand there."""

    study: Study

    @cached_property
    def centres(self) -> tuple[CentreRow, ...]:
        return tuple(_centres(self.study))

    @cached_property
    def links(self) -> tuple[LinkRow, ...]:
        return tuple(_links(self.study))

    @cached_property
    def points(self) -> tuple[PointRow, ...]:
        return tuple(PointRow(name, complex(z[0]), complex(v[0])) for name, (z, v) in self.study.points().items())

    @cached_property
    def transmission(self) -> tuple[tuple[str, float], ...]:
        """joint -> angle between its links [rad]"""
        names = [n for n in self.study.quantities("linkage") if n.startswith("transmission.")]
        return tuple((n.removeprefix("transmission."), float(quantity(n).value(self.study)[0])) for n in names)

    @cached_property
    def differences(self) -> tuple[DifferenceRow, ...]:
        return tuple(_differences(self.study))

    def distance(self, one: Links, other: Links) -> float:
        """Between two centres [m], infinite where one of them is at infinity. Raises KeyError for links there are none of."""
        a, b = self._places[one], self._places[other]
        return abs(a - b) if a is not None and b is not None else float("inf")

    @cached_property
    def _places(self) -> dict[Links, complex | None]:
        return {row.links: row.place for row in self.centres}


def _differences(study: Study) -> Iterator[DifferenceRow]:
    for d in velocity_differences(study.linkage):
        v_a, v_pa, v_p = (complex(v[0]) * study.omega for v in (d.v_a, d.v_pa, d.v_p))
        yield DifferenceRow(d.kind, link_number(d.body), link_number(d.on), d.a, d.p, v_a, v_pa, v_p)


def _centres(study: Study) -> Iterator[CentreRow]:
    table = study.centres
    lines = {
        wanted.key: tuple(link_number(triangle.third) for triangle in wanted.triangles) for wanted in table.construction.steps
    }
    for key in combinations(table.bodies, 2):
        links = (link_number(key[0]), link_number(key[1]))
        place, direction = _where(table.centres[key], table.size)
        yield CentreRow(links, place, direction, lines.get(key, ()))


def _where(centre: Centres, size: float) -> tuple[complex | None, float | None]:
    if centre.weight[0] == 0.0 and centre.point[0] == 0.0:
        return None, None
    if centre.far(size)[0]:
        return None, float(centre.direction[0])
    return complex(centre.finite[0]), None


def _links(study: Study) -> Iterator[LinkRow]:
    driver = body_name(study.design.drive.linkage.driver.link)
    for number, omega in study.angular_velocities().items():
        body = body_name(number)
        if body == FRAME:
            continue
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = 1.0 if body == driver else float(angular_ratio(study.centres, body, driver)[0])
            advantage = 1.0 if body == driver else float(mechanical_advantage(study.centres, body, driver)[0])
        yield LinkRow(number, float(omega[0]), ratio, advantage)


# -- what the command ``centres`` prints, and what is painted beside it ------------------------------------


@frozen(eq=False)
class Snapshot:
    """A linkage at one driver angle [deg], to be drawn with its centres and its velocity polygon."""

    study: Study
    angle_deg: float


def snapshot(study: Study, angle_deg: float) -> Snapshot:
    """Raises DesignError for a design that is no linkage."""
    require_linkage(study.design)
    return Snapshot(study, angle_deg)


def centres_data(study: Study, angle_deg: float) -> dict[str, Any]:
    """At this driver angle [deg]; links by their numbers, the frame included.

    A centre is [x, y] in mm, or its direction where it is at infinity; null where the links have no motion against each
    other. A velocity difference is V_to = V_from + V_difference, of two points of one link, or of two links that slide on
    each other at the same place. Raises NoPosition where the linkage cannot stand there, DesignError for a design that is no linkage.
    """
    require_linkage(study.design)
    there = study.at_theta(np.array([math.radians(angle_deg)]))
    rows, table = Position(there), there.centres
    driver = body_name(there.design.drive.linkage.driver.link)
    return {
        "angular_velocity_rad_s": {str(n): float(w[0]) for n, w in there.angular_velocities().items()},
        "centres": {f"{row.links[0]},{row.links[1]}": _centre(row) for row in rows.centres},
        "points": {
            row.name: {
                "x_mm": row.place.real * _MM,
                "y_mm": row.place.imag * _MM,
                "vx_mm_s": row.velocity.real * _MM,
                "vy_mm_s": row.velocity.imag * _MM,
            }
            for row in rows.points
        },
        "velocity_ratios": {
            f"{link_number(body)},{link_number(base)}": _ratio(ratio_arms(table, body, base))
            for body, base in dict.fromkeys(pair for pairs in CHAINS.values() for pair in pairs(table, driver))
        },
        "velocity_differences": [
            {
                "kind": row.kind,
                "link": row.link,
                "on": row.on,
                "from": row.a,
                "to": row.p,
                "v_from_mm_s": _vector(row.v_a),
                "v_difference_mm_s": _vector(row.v_pa),
                "v_to_mm_s": _vector(row.v_p),
            }
            for row in rows.differences
        ],
    }


def _ratio(arms: RatioArms) -> dict[str, float]:
    """ω_body/ω_base and the directed distances that tell it; infinite, as of a link that does not turn."""
    lengths = {"base_arm_mm": arms.base_arm, "body_arm_mm": arms.body_arm}
    return {"ratio": float(arms.ratio[0]), **{name: float(arm[0]) * _MM for name, arm in lengths.items()}}


def _vector(vector: complex) -> list[float]:
    return [vector.real * _MM, vector.imag * _MM]


def _centre(row: CentreRow) -> list[float] | dict[str, float] | None:
    if row.direction is not None:
        return {"direction_deg": math.degrees(row.direction)}
    return None if row.place is None else _vector(row.place)
