"""Reactions to unit loads, one newton of contact force or of friction: they depend on neither the loads nor the speed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from core.cam import CamShape, Flank
from core.dynamics.elements import Load
from core.dynamics.friction import JAMMED, JAMS
from core.dynamics.walk import Walk
from core.frozen import frozen
from core.mechanism.kinematics import REVOLUTE, Kinematics
from core.numerics.derivatives import cross, negated, replace_nan, spread
from core.numerics.lazy import lazy, self_locking


class LoadCase:
    """One set of loads: the contact force (n,) that balances it if a cam drives, else the effort (n,) of the driver."""

    def __init__(self, walk: Walk, unit_contact: Walk | None) -> None:
        self.walk, self.unit_contact = walk, unit_contact
        self.contact = np.zeros(1) if unit_contact is None else -walk.effort / unit_contact.effort
        self.driver = walk.effort if unit_contact is None else np.zeros(1)
        self._reactions: dict[str, np.ndarray] = {}

    def reaction(self, name: str) -> np.ndarray:
        """Force of a pin, or normal force of a slide, from the loads and their contact force; computed once.

        Returns
        -------
        ndarray (n,) [N]
            Complex for a pin.
        """
        reaction = self._reactions.get(name)
        if reaction is None:
            reaction = self._reactions[name] = self._with_contact(Walk.reaction, name)
        return reaction

    def couple(self, name: str) -> np.ndarray:
        """Couple of a sliding pair, from the loads and their contact force.

        Returns
        -------
        ndarray (n,) [N m]
        """
        return self._with_contact(Walk.couple, name)

    def _with_contact(self, part: Callable[[Walk, str], np.ndarray | None], name: str) -> np.ndarray:
        load_share = part(self.walk, name)
        unit_share = None if self.unit_contact is None else part(self.unit_contact, name)
        if unit_share is None:
            return np.zeros(1) if load_share is None else load_share
        return self.contact * unit_share if load_share is None else load_share + self.contact * unit_share


@self_locking
@frozen(eq=False)
class UnitLoads:
    """Reactions of a mechanism to unit loads at n cam angles; they depend on neither the loads nor the speed.

    Attributes
    ----------
    contacts : tuple of Walk
        For each flank: reactions to one newton of contact force.
    contact_points : tuple of ndarray (n,) complex [m]
        For each flank: point of contact C in the global frame.
    directions : tuple of ndarray (n,) complex, dimensionless
        For each flank: force on the cam per newton of contact, n + μ v̂ (normal and friction of a sliding face).
    contact_jam : ndarray (n,), dimensionless
        Share of the lever of the contact's normal force that its friction cancels.
    frictions : mapping of str to Walk
        Pair -> reactions to one newton of friction, or one newton metre in a pin.
    slip_signs : mapping of str to ndarray (n,), dimensionless
        Pair -> sign of its slip where the shaft turns forward.
    points : dict
        Points of the pairs and constants of the dyads, shared by all walks at these positions.
    """

    contacts: tuple[Walk, ...]
    contact_points: tuple[np.ndarray, ...]
    directions: tuple[np.ndarray, ...]
    contact_jam: np.ndarray
    frictions: Mapping[str, Walk]
    slip_signs: Mapping[str, np.ndarray]
    points: dict[Any, Any]

    def friction_case(self, pair: str, unit_contact: Walk | None) -> LoadCase:
        """One newton of friction in a pair, balanced by the contact force of a flank, or by the driver where it is None."""
        key = pair, unit_contact
        case: LoadCase | None = self._friction_cases.get(key)
        if case is None:
            case = self._friction_cases[key] = LoadCase(self.frictions[pair], unit_contact)
        return case

    @lazy
    def torque_arms(self) -> tuple[np.ndarray, ...]:
        """For each flank: moment about the cam centre per newton of contact, C × (n + μ v̂) (n,) [m]."""
        return tuple([cross(at, direction) for at, direction in zip(self.contact_points, self.directions, strict=True)])

    @lazy
    def _friction_cases(self) -> dict[tuple[str, Walk | None], LoadCase]:
        return {}


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def unit_loads(
    kinematics: Kinematics, shape: CamShape | None, contact_friction: float, pairs: tuple[str, ...]
) -> UnitLoads:
    """Reactions to one newton of contact force on each flank, and to one newton of friction in each of these pairs.

    Parameters
    ----------
    kinematics : Kinematics
        At n cam angles.
    shape : CamShape or None
        The cam; None without one.
    contact_friction : float
        Coefficient of friction of a face that slides on the cam.
    pairs : tuple of str
        Pairs with friction.

    Returns
    -------
    UnitLoads
    """
    flanks = () if shape is None else shape.flanks
    directions = tuple([_contact_direction(flank, shape.rotation_sign, contact_friction) for flank in flanks if shape])
    points: dict[Any, Any] = {}
    contacts = tuple(
        [
            Walk(kinematics, [Load(flank.body, flank.contact, negated(direction))], points)
            for flank, direction in zip(flanks, directions, strict=True)
        ]
    )
    n = kinematics.count
    contact_jam = np.zeros(n)
    if contact_friction and shape is not None:
        normal_load = Load(kinematics.carrier, shape.flank.contact, negated(shape.flank.normal))
        frictionless = Walk(kinematics, [normal_load], points).effort
        contact_jam = spread(replace_nan(1.0 - contacts[0].effort / frictionless, nan=0.0), n)
        if (jams := contact_jam >= JAMS).any():
            contacts[0].effort = np.where(jams, frictionless / JAMMED, contacts[0].effort)
    return UnitLoads(
        contacts,
        tuple([flank.contact for flank in flanks]),
        directions,
        contact_jam,
        {pair: Walk(kinematics, unit_friction(kinematics, pair), points) for pair in pairs},
        {pair: _slip_sign(kinematics, pair) for pair in pairs},
        points,
    )


def _contact_direction(flank: Flank, rotation_sign: float, friction: float) -> np.ndarray:
    """Force on the cam per newton of contact, n + μ v̂ (n,), v̂ = ± i d n the direction of the relative motion."""
    if not friction:
        return flank.normal
    tangential = rotation_sign * friction * np.sign(flank.sliding)
    factor = np.empty(np.shape(tangential), dtype=complex)
    factor.real, factor.imag = 1.0, tangential
    # a named factor: numpy swaps products with large temporaries, which changes their last bits
    return flank.normal * factor


def unit_friction(kinematics: Kinematics, name: str) -> list[Load]:
    """One newton of friction (one newton metre in a pin) on ``body`` against positive slip, the opposite on ``on``."""
    pair = kinematics.pairs[name]
    at = kinematics.bodies[pair.body].position(pair.point)
    force = np.zeros(1, dtype=complex) if pair.kind == REVOLUTE else -kinematics.line(pair)
    couple = -1.0 if pair.kind == REVOLUTE else 0.0
    return [Load(pair.body, at, force, couple), Load(pair.on, at, -force, -couple)]


def _slip_sign(kinematics: Kinematics, name: str) -> np.ndarray:
    """Sign of a pair's slip (n,): -1, 0, 1, from the motion's segment, so that it is exact near a dwell."""
    forward = kinematics.driver_sign * kinematics.motion.velocity_sign
    return forward if name == kinematics.driver_name else np.asarray(forward * np.sign(kinematics.slip(name)))
