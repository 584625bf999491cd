"""A linkage at one position, as tables: its instant centres, what its links do, where its points are and go."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from core.instant_centres import Centres, angular_ratio, mechanical_advantage, velocity_differences
from core.mechanism import body_name, link_number
from core.mechanism.kinematics import FRAME
from core.study import Study, quantity

Links = tuple[int, int]


@dataclass(frozen=True)
class CentreRow:
    """The instant centre of two links: ``place`` [m], or ``direction`` [rad] where it is at infinity; neither where the
    two do not move against each other. lines: the third links by whose lines Kennedy's theorem finds it, empty where a
    pair shows it at sight."""

    links: Links
    place: complex | None
    direction: float | None
    lines: tuple[int, ...] = ()


@dataclass(frozen=True)
class LinkRow:
    """A moving link: angular velocity [rad/s]; its ratio to the driver's and the mechanical advantage there, NaN where
    the driver slides."""

    link: int
    omega: float
    ratio: float
    advantage: float


@dataclass(frozen=True)
class PointRow:
    """A named point: place [m] and velocity [m/s]."""

    name: str
    place: complex
    velocity: complex


@dataclass(frozen=True)
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


@dataclass(frozen=True)
class Position:
    """Rows by links and by names, in rising order; ``transmission`` joint -> angle between its links [rad]."""

    centres: tuple[CentreRow, ...]
    links: tuple[LinkRow, ...]
    points: tuple[PointRow, ...]
    transmission: tuple[tuple[str, float], ...]
    differences: tuple[DifferenceRow, ...]

    def distance(self, one: Links, other: Links) -> float:
        """Between two centres [m], infinite where one of them is at infinity. Raises KeyError for links there are none of."""
        places = {row.links: row.place for row in self.centres}
        a, b = places[one], places[other]
        return abs(a - b) if a is not None and b is not None else float("inf")


def position(study: Study, angle: float) -> Position:
    """At this driver angle [rad]. Raises NoPosition where the linkage cannot stand there."""
    there = study.at_theta(np.array([angle]))
    names = [n for n in there.quantities("linkage") if n.startswith("transmission.")]
    return Position(
        tuple(_centres(there)),
        tuple(_links(there)),
        tuple(PointRow(name, complex(z[0]), complex(v[0])) for name, (z, v) in there.points().items()),
        tuple((n.removeprefix("transmission."), float(quantity(n).value(there)[0])) for n in names),
        tuple(differences(there)),
    )


def differences(study: Study) -> Iterator[DifferenceRow]:
    """The velocity differences of a linkage at the first of its angles."""
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
