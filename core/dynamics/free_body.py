"""Free bodies: all forces on each body, inertia forces included, so that they close a polygon (d'Alembert)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from core.cam import CamShape
from core.dynamics.elements import Element, Inertia, Load, Mass, OutputForce, Rate, SpringDamper, combined_inertia
from core.dynamics.forces import BEARING, Forces
from core.dynamics.loading import Loading
from core.dynamics.walk import input_loads, input_of
from core.frozen import frozen
from core.mechanism.kinematics import CAM, FRAME, REVOLUTE, Kinematics
from core.numerics.derivatives import cross, dot, spread

REACTION, CONTACT, FRICTION, DRIVE, SPRING, LOAD, WEIGHT, INERTIA = (
    "reaction", "contact", "friction", "drive", "spring", "load", "weight", "inertia"
)  # fmt: skip
KINDS = (REACTION, CONTACT, FRICTION, DRIVE, SPRING, LOAD, WEIGHT, INERTIA)
MASS_KINDS = (WEIGHT, INERTIA)


@frozen(eq=False)
class ForceOnBody:
    """One force on a body.

    Attributes
    ----------
    kind : str
        Row of ``KINDS``: reaction of a pair (normal to a slide with friction), normal force of the cam, friction of
        either, drive, spring or damper, other force element, weight m g, inertia force -m a with the couple -I α̈.
    name : str
        Of the pair, flank, force element or body that it comes from.
    body : str
        On which it acts.
    partner : str
        The second body of the pair or contact; empty for other forces.
    at : ndarray (n,) complex [m]
        Point of application in the global frame.
    force : ndarray (n,) complex [N]
    couple : ndarray (n,) [N m]
        Counter-clockwise.
    """

    kind: str
    name: str
    body: str
    partner: str
    at: np.ndarray
    force: np.ndarray
    couple: np.ndarray


@np.errstate(invalid="ignore")  # inf - inf where friction jams
def free_bodies(
    kinematics: Kinematics, shape: CamShape | None, loading: Loading, forces: Forces
) -> Mapping[str, tuple[ForceOnBody, ...]]:
    """Body -> all forces on it, for every moving body, and for ``cam`` where there is one; their sums ΣF and ΣM are 0.

    They are in the order in which a polygon is drawn: first the applied forces (weight, inertia, springs, loads), then
    the reactions.
    """
    rows_of: dict[str, list[ForceOnBody]] = {body: [] for body in kinematics.bodies if body != FRAME}
    if shape is not None:
        rows_of[CAM] = []
    applied = list(_applied(kinematics, loading, forces.omega))
    if loading.contact_window is not None:
        acting = loading.acting(kinematics)
        applied = [replace(row, force=acting * row.force, couple=acting * row.couple) for row in applied]
    for row in (*applied, *_reactions(kinematics, shape, forces)):
        if row.body in rows_of:
            rows_of[row.body].append(row)
    return MappingProxyType({body: tuple(rows) for body, rows in rows_of.items() if rows})


def _applied(kinematics: Kinematics, loading: Loading, omega: float) -> Iterator[ForceOnBody]:
    """Weight and inertia force of every body, and the loads of each force element, at constant speed [rad/s]."""
    n, rate = kinematics.theta.size, Rate(omega)
    for body, inertia in body_inertias(loading).items():
        gravity = next((mass.gravity for mass in loading.masses if mass.body == body and mass.gravity), 0j)
        if gravity:
            yield from _forces(WEIGHT, body, Mass(body, inertia, gravity).loads(kinematics, Rate(0.0)), n)
        yield from _forces(INERTIA, body, Mass(body, inertia).loads(kinematics, rate), n)
    for element in loading.others:
        if element.is_active:
            yield from element_forces(element, kinematics, omega)


def body_inertias(loading: Loading) -> Mapping[str, Inertia]:
    """Body -> combined inertia of its masses, for every body with a mass."""
    bodies = dict.fromkeys(mass.body for mass in loading.masses if mass.is_active)
    return MappingProxyType(
        {body: combined_inertia([mass.inertia for mass in loading.masses if mass.body == body]) for body in bodies}
    )


def element_forces(element: Element, kinematics: Kinematics, omega: float) -> Iterator[ForceOnBody]:
    """Forces of one force element on the bodies, at constant speed [rad/s]."""
    is_spring = isinstance(element, SpringDamper) or (isinstance(element, OutputForce) and element.rate)
    loads = element.loads(kinematics, Rate(omega))
    yield from _forces(SPRING if is_spring else LOAD, element.name, loads, kinematics.theta.size)


def _forces(kind: str, name: str, loads: Iterator[Load], n: int) -> Iterator[ForceOnBody]:
    for load in loads:
        at, force = (spread(np.asarray(part, dtype=complex), n) for part in (load.at, load.force))
        yield ForceOnBody(kind, name, load.body, "", at, force, spread(np.atleast_1d(load.couple), n))


def _reactions(kinematics: Kinematics, shape: CamShape | None, forces: Forces) -> Iterator[ForceOnBody]:
    """Reactions, friction, drive, and the forces of the cam."""
    n = kinematics.theta.size
    zero_force, zero = np.zeros(n, dtype=complex), np.zeros(n)
    for name, pair in kinematics.pairs.items():
        at = spread(kinematics.bodies[pair.body if pair.body in kinematics.bodies else pair.on].position(pair.point), n)
        force, couple = forces.pairs[name], forces.couples.get(name, zero)
        parts = [(REACTION, force, couple)]
        if pair.kind != REVOLUTE and name in forces.friction_power_by_pair:
            line = kinematics.line(pair)
            friction = spread(dot(line, force) * line, n)
            parts = [(REACTION, force - friction, couple), (FRICTION, friction, zero)]
        elif name in forces.friction_power_by_pair:
            parts = [(REACTION, force, zero), (FRICTION, zero_force, couple)]
        if name == kinematics.driver_name and shape is None:
            turns = pair.kind == REVOLUTE
            push = zero_force if turns else spread(forces.driver * kinematics.line(pair), n)
            sign = 1.0 if pair.body == kinematics.output else -1.0
            parts.append((DRIVE, sign * push, sign * forces.driver if turns else zero))
        for kind, vector, moment in parts:
            yield ForceOnBody(kind, name, pair.body, pair.on, at, vector, moment)
            yield ForceOnBody(kind, name, pair.on, pair.body, at, -vector, -moment)
    for dyad in kinematics.dyads:
        if dyad.on:  # driven against a link, and from the driver by its ratio
            name = input_of(dyad.bodies[0])
            for partner, load in input_loads(kinematics, dyad, forces.couples[name]):
                at, force = spread(load.at, n), spread(load.force, n)
                yield ForceOnBody(DRIVE, name, load.body, partner, at, force, spread(np.asarray(load.couple), n))
    if shape is None:
        return
    for flank, contact in zip(shape.flanks, forces.contacts, strict=True):
        normal = contact.force * flank.normal
        friction = contact.force * contact.direction - normal
        for kind, vector in ((CONTACT, normal), (FRICTION, friction)):
            if kind == CONTACT or contact.direction is not flank.normal:
                yield ForceOnBody(kind, flank.name, flank.body, CAM, contact.at, -vector, zero)
                yield ForceOnBody(kind, flank.name, CAM, flank.body, contact.at, vector, zero)
    yield ForceOnBody(REACTION, BEARING, CAM, FRAME, zero_force, forces.pairs[BEARING], zero)


def imbalance(rows: tuple[ForceOnBody, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Sum of a body's forces and of their moments about the origin: rounding alone, but for the torque of the cam.

    Parameters
    ----------
    rows : tuple of ForceOnBody
        All forces on the body.

    Returns
    -------
    force, moment : ndarray (n,) [N], [N m]
    """
    force = np.sum([row.force for row in rows], axis=0)
    moment = np.sum([cross(row.at, row.force) + row.couple for row in rows], axis=0)
    return np.abs(force), moment
