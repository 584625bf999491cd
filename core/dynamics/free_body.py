"""Free bodies: every force on each body at each angle, inertia forces included, so that they close a polygon (d'Alembert)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType

import numpy as np

from core.cam import CamShape
from core.dynamics.elements import Element, Inertia, Load, Loading, Mass, OutputForce, Rate, Spring, Torsion, combined
from core.dynamics.forces import BEARING, Forces
from core.dynamics.walk import input_loads, input_of
from core.frozen import frozen
from core.mechanism.kinematics import CAM, FRAME, REVOLUTE, Kinematics
from core.numerics.derivatives import cross, dot, spread

REACTION, CONTACT, FRICTION, DRIVE, SPRING, LOAD, WEIGHT, INERTIA = (
    "reaction", "contact", "friction", "drive", "spring", "load", "weight", "inertia"
)  # fmt: skip
KINDS = (REACTION, CONTACT, FRICTION, DRIVE, SPRING, LOAD, WEIGHT, INERTIA)
OF_MASSES = (WEIGHT, INERTIA)


@frozen(eq=False)
class ForceOnBody:
    """One force on a body.

    kind    row of ``KINDS``: reaction of a pair (normal to a slide that rubs), normal force of the cam, friction of either, what
            drives, spring or damper, other force element, weight m g, inertia force -m a with the couple -I α̈
    name    of the pair, flank, force element or body that it comes from
    body    on which it acts; by: the other body of a pair or a contact, else empty
    at      (n,) complex [m], global frame
    force   (n,) complex [N]
    couple  (n,) [N m], counter-clockwise
    """

    kind: str
    name: str
    body: str
    by: str
    at: np.ndarray
    force: np.ndarray
    couple: np.ndarray


@np.errstate(invalid="ignore")  # inf - inf where friction jams
def free_bodies(
    kinematics: Kinematics, shape: CamShape | None, loading: Loading, forces: Forces
) -> Mapping[str, tuple[ForceOnBody, ...]]:
    """Body -> all that acts on it, for every body that moves, and ``cam`` where there is one; of each ΣF = 0 and ΣM = 0.

    The order is the one in which a polygon is drawn: what is given first (weight, inertia, springs, loads), then what answers.
    """
    found: dict[str, list[ForceOnBody]] = {body: [] for body in kinematics.bodies if body != FRAME}
    if shape is not None:
        found[CAM] = []
    for acting in (*given(kinematics, loading, forces.omega), *_answering(kinematics, shape, forces)):
        if acting.body in found:
            found[acting.body].append(acting)
    return MappingProxyType({body: tuple(rows) for body, rows in found.items() if rows})


def given(kinematics: Kinematics, loading: Loading, omega: float) -> Iterator[ForceOnBody]:
    """Weight and inertia force of every body, and what each force element puts on it, at constant speed [rad/s]."""
    n, rate = kinematics.theta.size, Rate(omega)
    for body, whole in masses_of(loading).items():
        gravity = next((mass.gravity for mass in loading.masses if mass.body == body and mass.gravity), 0j)
        if gravity:
            yield from _acting(WEIGHT, body, Mass(body, whole, gravity).loads(kinematics, Rate(0.0)), n)
        yield from _acting(INERTIA, body, Mass(body, whole).loads(kinematics, rate), n)
    for element in loading.others:
        if element.acts:
            yield from acting_of(element, kinematics, omega)


def masses_of(loading: Loading) -> Mapping[str, Inertia]:
    """Body -> its masses as one, of those that have any."""
    bodies = dict.fromkeys(mass.body for mass in loading.masses if mass.acts)
    return MappingProxyType(
        {body: combined([mass.inertia for mass in loading.masses if mass.body == body]) for body in bodies}
    )


def acting_of(element: Element, kinematics: Kinematics, omega: float) -> Iterator[ForceOnBody]:
    """What one force element puts on the bodies, at constant speed [rad/s]."""
    yield from _acting(kind_of(element), element.name, element.loads(kinematics, Rate(omega)), kinematics.theta.size)


def kind_of(element: Element) -> str:
    """Spring or damper, or another force element."""
    return (
        SPRING if isinstance(element, Spring | Torsion) or (isinstance(element, OutputForce) and element.rate) else LOAD
    )


def _acting(kind: str, name: str, loads: Iterator[Load], n: int) -> Iterator[ForceOnBody]:
    for load in loads:
        at, force = (spread(np.asarray(part, dtype=complex), n) for part in (load.at, load.force))
        yield ForceOnBody(kind, name, load.body, "", at, force, spread(np.atleast_1d(load.couple), n))


def _answering(kinematics: Kinematics, shape: CamShape | None, forces: Forces) -> Iterator[ForceOnBody]:
    """Reactions, friction, what drives, and the cam."""
    n = kinematics.theta.size
    still, none = np.zeros(n, dtype=complex), np.zeros(n)
    for name, pair in kinematics.pairs.items():
        at = spread(kinematics.bodies[pair.body if pair.body in kinematics.bodies else pair.on].position(pair.point), n)
        force, couple = forces.pairs[name], forces.couples.get(name, none)
        parts = [(REACTION, force, couple)]
        if pair.kind != REVOLUTE and name in forces.rubbing:
            line = kinematics.line(pair)
            rubs = spread(dot(line, force) * line, n)
            parts = [(REACTION, force - rubs, couple), (FRICTION, rubs, none)]
        elif name in forces.rubbing:
            parts = [(REACTION, force, none), (FRICTION, still, couple)]
        if name == kinematics.driver_name and shape is None:
            turns = pair.kind == REVOLUTE
            push = still if turns else spread(forces.driver * kinematics.line(pair), n)
            sign = 1.0 if pair.body == kinematics.output else -1.0
            parts.append((DRIVE, sign * push, sign * forces.driver if turns else none))
        for kind, vector, moment in parts:
            yield ForceOnBody(kind, name, pair.body, pair.on, at, vector, moment)
            yield ForceOnBody(kind, name, pair.on, pair.body, at, -vector, -moment)
    for dyad in (
        each for each in kinematics.dyads if each.on
    ):  # driven against a link, and from the driver by its ratio
        name = input_of(dyad.bodies[0])
        for by, load in input_loads(kinematics, dyad, forces.couples[name]):
            at, force = spread(load.at, n), spread(load.force, n)
            yield ForceOnBody(DRIVE, name, load.body, by, at, force, spread(np.asarray(load.couple), n))
    if shape is None:
        return
    for flank, contact in zip(shape.flanks, forces.contacts, strict=True):
        normal = contact.force * flank.normal
        rubs = contact.force * contact.pressing - normal
        for kind, vector in ((CONTACT, normal), (FRICTION, rubs)):
            if kind == CONTACT or contact.pressing is not flank.normal:
                yield ForceOnBody(kind, flank.name, flank.body, CAM, contact.at, -vector, none)
                yield ForceOnBody(kind, flank.name, CAM, flank.body, contact.at, vector, none)
    yield ForceOnBody(REACTION, BEARING, CAM, FRAME, still, forces.pairs[BEARING], none)


def unbalanced(rows: tuple[ForceOnBody, ...]) -> tuple[np.ndarray, np.ndarray]:
    """What is left of a body's forces (n,) [N] and of their moments about the origin (n,) [N m]: rounding alone; of ``cam`` the
    moment is what drives it."""
    force = np.sum([row.force for row in rows], axis=0)
    moment = np.sum([cross(row.at, row.force) + row.couple for row in rows], axis=0)
    return np.abs(force), moment
