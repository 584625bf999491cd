"""A mechanism at one position: its instant centres, links, and points; as tables, data of the command ``centres``, and drawings.

Links of a [linkage] are named by their numbers, links of a follower and the cam by their names.
"""

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
    CAM,
    CHAINS,
    Centres,
    CentreTable,
    RatioArms,
    angular_ratio,
    mechanical_advantage,
    ratio_arms,
    velocity_differences,
)
from core.instant_centres.construction import Key
from core.mechanism import body_name, link_number
from core.mechanism.kinematics import FRAME
from core.output.channels import channels
from core.study import Study, quantities_of, quantity
from core.study.quantities import TRANSMISSION, member_of, shape_of

_MM = 1e3

# -- position of a mechanism ------------------------------------------------------------------------------------


Link = int | str
Links = tuple[Link, Link]


@frozen
class CentreRow:
    """Instant centre of two links; neither point nor direction without relative motion.

    Attributes
    ----------
    point : position [m]
    direction : direction of a centre at infinity [rad]
    lines : third links whose lines determine it by Kennedy's theorem; empty for a centre at a pair, a single one where the
        contact normal is the other line
    """

    links: Links
    point: complex | None
    direction: float | None
    lines: tuple[Link, ...] = ()


@frozen
class LinkRow:
    """A moving link.

    Attributes
    ----------
    omega : angular velocity [rad/s]
    ratio : its ratio to the angular velocity of the driver or cam
    advantage : mechanical advantage to the driver, NaN where the driver slides, or a cam drives
    """

    link: Link
    omega: float
    ratio: float
    advantage: float


@frozen
class PointRow:
    """A named point: position [m] and velocity [m/s]."""

    name: str
    position: complex
    velocity: complex


@frozen
class DifferenceRow:
    """A triangle of the velocity polygon, V_P = V_A + V_PA [m/s].

    A and P are points of one link (``link`` = ``on``), or coincide while ``link`` slides on ``on``.
    """

    kind: str
    link: Link
    on: Link
    a: str
    p: str
    v_a: complex
    v_pa: complex
    v_p: complex


@frozen(eq=False)
class Position:
    """A mechanism at the first angle of a study, as tables in the order of links and names, the cam last.

    Tables are computed when read, and raise NoPosition where the linkage cannot be assembled.
    """

    study: Study

    @cached_property
    def centres(self) -> tuple[CentreRow, ...]:
        """Rows of the instant centres."""
        return tuple(_centres(self.study))

    @cached_property
    def links(self) -> tuple[LinkRow, ...]:
        """Rows of the moving links."""
        return tuple(_links(self.study))

    @cached_property
    def points(self) -> tuple[PointRow, ...]:
        """Rows of the named points."""
        return tuple(PointRow(name, complex(z[0]), complex(v[0])) for name, (z, v) in _points(self.study).items())

    @cached_property
    def transmission(self) -> tuple[tuple[str, float], ...]:
        """Joint and the angle between its links [rad]."""
        names = [n for n in quantities_of(self.study, "linkage") if shape_of(n) == TRANSMISSION]
        return tuple((member_of(n), float(quantity(n).value(self.study)[0])) for n in names)

    @cached_property
    def differences(self) -> tuple[DifferenceRow, ...]:
        """Rows of the velocity polygon's triangles."""
        return tuple(_differences(self.study))

    def distance(self, first: Links, second: Links) -> float:
        """Distance of two centres [m], infinite where one is at infinity. Raises KeyError for unknown links."""
        a, b = self._centre_points[first], self._centre_points[second]
        return abs(a - b) if a is not None and b is not None else float("inf")

    @cached_property
    def _centre_points(self) -> dict[Links, complex | None]:
        return {row.links: row.point for row in self.centres}


def _label(study: Study, body: str) -> Link:
    """Label of a body; links of a [linkage] have their numbers."""
    return link_number(body) if study.design.drive.links and body != CAM else body


def _points(study: Study) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    if study.design.drive.links:
        return study.points()
    poses = {name: pose for pose in study.linkage.bodies.values() for name in pose.points}
    return {name: (pose.position(name), pose.position(name, 1) * study.omega) for name, pose in poses.items()}


def _differences(study: Study) -> Iterator[DifferenceRow]:
    for d in velocity_differences(study.linkage):
        v_a, v_pa, v_p = (complex(v[0]) * study.omega for v in (d.v_a, d.v_pa, d.v_p))
        yield DifferenceRow(d.kind, _label(study, d.body), _label(study, d.on), d.a, d.p, v_a, v_pa, v_p)


def _tables(study: Study) -> Iterator[tuple[CentreTable, tuple[Key, ...]]]:
    """Centres of the links, and centres of a cam with all links, with the keys of each table."""
    links = study.design.drive.links
    if links:
        yield study.centres, tuple(combinations(study.centres.bodies, 2))
    if study.has_disk:
        table = study.cam_centres
        yield table, tuple(key for key in combinations(table.bodies, 2) if CAM in key or not links)


def _centres(study: Study) -> Iterator[CentreRow]:
    for table, keys in _tables(study):
        lines = {
            step.key: tuple(_label(study, triangle.third) for triangle in step.triangles)
            for step in table.construction.steps
        }
        if CAM in table.bodies:
            lines[table.key(study.linkage.carrier, CAM)] = (_label(study, FRAME),)
        for key in keys:
            point, direction = _point_or_direction(table.centres[key], table.size)
            yield CentreRow((_label(study, key[0]), _label(study, key[1])), point, direction, lines.get(key, ()))


def _point_or_direction(centre: Centres, size: float) -> tuple[complex | None, float | None]:
    if centre.weight[0] == 0.0 and centre.point[0] == 0.0:
        return None, None
    if centre.is_far(size)[0]:
        return None, float(centre.direction[0])
    return complex(centre.finite[0]), None


def _links(study: Study) -> Iterator[LinkRow]:
    """Moving links; ratios of a follower's links to the speed of the cam."""
    if not study.design.drive.links:
        yield from (
            LinkRow(body, omega, omega / (study.sense * study.omega), math.nan)
            for body, omega in _velocities(study).items()
            if body != FRAME
        )
        return
    driver = body_name(study.design.drive.linkage.driver.link)
    for number, speed in study.angular_velocities().items():
        body = body_name(number)
        if body == FRAME:
            continue
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = 1.0 if body == driver else float(angular_ratio(study.centres, body, driver)[0])
            advantage = 1.0 if body == driver else float(mechanical_advantage(study.centres, body, driver)[0])
        yield LinkRow(number, float(speed[0]), ratio, advantage)


def _velocities(study: Study) -> dict[Link, float]:
    """Angular velocities [rad/s], counter-clockwise, at the first angle: of frame, links and cam."""
    if study.design.drive.links:
        velocities: dict[Link, float] = {n: float(w[0]) for n, w in study.angular_velocities().items()}
    else:
        bodies = study.linkage.bodies
        velocities = {
            FRAME: 0.0,
            **{name: float(bodies[name].turn[1][0]) * study.omega for name in study.cam_centres.bodies[1:-1]},
        }
    return velocities | ({CAM: study.sense * study.omega} if study.has_disk else {})


# -- command ``centres`` ------------------------------------------------------------------------------------


@frozen(eq=False)
class Snapshot:
    """A linkage at one driver angle [deg], for a drawing with its centres and its velocity polygon."""

    study: Study
    angle_deg: float


def snapshot(study: Study, angle_deg: float) -> Snapshot:
    """Snapshot of a linkage. Raises DesignError for a design that is no linkage."""
    require_linkage(study.design)
    return Snapshot(study, angle_deg)


def centres_data(study: Study, angle_deg: float) -> dict[str, Any]:
    """Position of a mechanism at an angle of driver or cam [deg], as data.

    A centre is [x, y] in mm, or its direction where it is at infinity; null without relative motion. A velocity difference is
    V_to = V_from + V_difference, of two points of one link, or of two links that slide on each other at the same point. Raises
    NoPosition where the linkage cannot be assembled.
    """
    position = study.at_theta(np.array([math.radians(angle_deg)]))
    rows = Position(position)
    return {
        "angular_velocity_rad_s": {str(n): w for n, w in _velocities(position).items()},
        "centres": {f"{row.links[0]},{row.links[1]}": _centre(row) for row in rows.centres},
        **({"instant_centre": _cam_velocities(position)} if position.has_disk else {}),
        "points": {
            row.name: {
                "x_mm": row.position.real * _MM,
                "y_mm": row.position.imag * _MM,
                "vx_mm_s": row.velocity.real * _MM,
                "vy_mm_s": row.velocity.imag * _MM,
            }
            for row in rows.points
        },
        "velocity_ratios": {
            f"{_label(position, body)},{_label(position, base)}": _ratio(ratio_arms(table, body, base))
            for table, body, base in _chains(position)
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


def _chains(study: Study) -> Iterator[tuple[CentreTable, str, str]]:
    """Pairs of bodies whose velocities are compared: of a linkage to the driver and from link to link, of a follower to the cam."""
    if study.design.drive.links:
        table, driver = study.centres, body_name(study.design.drive.linkage.driver.link)
        yield from (
            (table, body, base)
            for body, base in dict.fromkeys(pair for pairs in CHAINS.values() for pair in pairs(table, driver))
        )
    else:
        table = study.cam_centres
        yield from ((table, body, CAM) for body in table.bodies[1:-1])


_CAM_QUANTITIES = ("instant_centre", "instant_centre_velocity", "reference_velocity")
"""Quantities of cam and follower (Shin1995 (15) to (18))."""


def _cam_velocities(study: Study) -> dict[str, float]:
    """Q, V_Q and V_R, as far as the follower has them."""
    return {
        row.slug: float(row.values(study)[0]) for row in channels(study.design, ("cam",)) if row.name in _CAM_QUANTITIES
    }


def _ratio(arms: RatioArms) -> dict[str, float]:
    """ω_body/ω_base and the directed distances that determine it; infinite for a link that does not rotate."""
    lengths = {"base_arm_mm": arms.base_arm, "body_arm_mm": arms.body_arm}
    return {"ratio": float(arms.ratio[0]), **{name: float(arm[0]) * _MM for name, arm in lengths.items()}}


def _vector(vector: complex) -> list[float]:
    return [vector.real * _MM, vector.imag * _MM]


def _centre(row: CentreRow) -> list[float] | dict[str, float] | None:
    if row.direction is not None:
        return {"direction_deg": math.degrees(row.direction)}
    return None if row.point is None else _vector(row.point)
