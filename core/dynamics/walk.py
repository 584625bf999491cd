"""One walk of forces: the reactions of all pairs and the driver effort, from the outermost dyad or group to the driver.

A dyad is cut open at the joint that closes its loop: the force F there balances the loads in the dyad's two
coordinates, dot(c1, F) = -Q1, dot(c2, F) = -Q2: Q1, Q2 are the generalised forces of the loads, c1, c2 the derivatives of the
loop by the coordinates. All other reactions follow by balance. Each kind of dyad is one row of ``STATICS``. A body without
loads is skipped.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from core.dynamics.elements import Load
from core.mechanism.kinematics import FRAME, REVOLUTE, Dyad, Kinematics
from core.numerics.derivatives import cross, dot, negated

Number = float | np.ndarray
_ZERO_FORCE = np.zeros(1, dtype=complex)


def input_of(body: str) -> str:
    """Name of the effort of a second driver on a body, among the couples."""
    return f"{body}_input"


def input_loads(kinematics: Kinematics, dyad: Dyad, effort: np.ndarray) -> Iterator[tuple[str, Load]]:
    """Loads of a second driver with a given effort, each with the name of the body that exerts it.

    They act on its body, on the link against which it is driven, and, by the ratio, on the driver.

    Parameters
    ----------
    kinematics : Kinematics
        At n cam angles.
    dyad : Dyad
        The body with a second driver.
    effort : ndarray (n,) [N m or N]
        Torque, or force along the line of a slide.

    Yields
    ------
    body, load : str, Load

    References
    ----------
    Moments of the link about its pin; forces of the link along its line.
    """
    (body,), (name,) = dyad.bodies, dyad.pairs
    for on, partner, joint, share in (
        (body, dyad.on, name, 1.0),
        (dyad.on, body, name, -1.0),
        (kinematics.output, body, kinematics.driver_name, -dyad.ratio),
    ):
        pair = kinematics.pairs[joint]
        at = kinematics.bodies[pair.body if pair.body in kinematics.bodies else pair.on].position(pair.point)
        if pair.kind == REVOLUTE:
            yield partner, Load(on, at, np.zeros(1, dtype=complex), share * effort)
        else:
            yield partner, Load(on, at, share * effort * kinematics.line(pair))


class Walk:
    """Reactions and driver effort of a mechanism under one set of loads.

    Attributes
    ----------
    effort : ndarray (n,) [N m or N]
        Driver effort that balances the loads: torque where the driver is pinned to the frame, force along its line.
    names : iterable of str
        Pairs with a reaction, which `reaction` and `couple` evaluate.
    """

    def __init__(self, kinematics: Kinematics, loads: Iterable[Load], points: dict[Any, Any] | None = None) -> None:
        """Solve all dyads and the driver; points: cache of the pairs' points and dyads' constants, shared by walks of one mechanism."""
        self.kinematics = kinematics
        self.points = {} if points is None else points
        self._loads: dict[str, list[Load]] = {}
        self._inner = np.zeros(1)
        self._pairs: dict[str, np.ndarray | Callable[[], np.ndarray]] = {}
        self._couples: dict[str, np.ndarray | Callable[[], np.ndarray]] = {}
        applied = list(loads)
        for load in applied:
            self.add_load(load)
        for dyad in kinematics.dyads:
            if not self._loads.keys().isdisjoint(dyad.bodies):
                STATICS[dyad.kind](self, dyad)
        self.effort = self._driver()
        if applied and kinematics.is_redundant:  # its reactions are not unique
            self.effort = _by_virtual_power(kinematics, applied)
            for dyad in (dyad for dyad in kinematics.dyads if dyad.by_motion):
                body, on = (kinematics.by_driver[name].turn[1] for name in (dyad.bodies[0], dyad.on))
                couple = self.couple(input_of(dyad.bodies[0]))
                self.effort = self.effort - (0.0 if couple is None else couple * (body - on))

    @property
    def names(self) -> Iterable[str]:
        """Pairs with a reaction."""
        return self._pairs.keys()

    def reaction(self, name: str) -> np.ndarray | None:
        """Reaction of a pair by ``on`` on ``body``, without friction; None where it has none.

        Parameters
        ----------
        name : str
            Name of the pair.

        Returns
        -------
        ndarray (n,) [N] or None
            Force at a pin, complex; normal force of a sliding pair, along its line + 90°.
        """
        return _evaluate(self._pairs, name)

    def couple(self, name: str) -> np.ndarray | None:
        """Couple of a sliding pair, or effort of a second driver, by ``on`` on ``body``; None where it has none.

        Parameters
        ----------
        name : str
            Name of the pair, or of the effort.

        Returns
        -------
        ndarray (n,) [N m] or None
        """
        return _evaluate(self._couples, name)

    def _driver(self) -> np.ndarray:
        if self.kinematics.driver_on != FRAME:
            return self._inner
        driver, name = self.kinematics.output, self.kinematics.driver_name
        if driver not in self._loads:
            return np.zeros(1)
        at, loads = self.at(name), self._loads[driver]  # the functions must not refer to the walk, which keeps them
        if self.kinematics.pairs[name].kind == REVOLUTE:
            self._record(name, driver, lambda: negated(_total(loads)))
            return -_moment(loads, at)
        line, force = self.along(name), _total(loads)
        self._record(name, driver, lambda: -dot(1j * line, force), lambda: -_moment(loads, at))
        return -dot(line, force)

    def add_load(self, load: Load) -> None:
        """Add a load to its body; the frame needs none."""
        body = load.body
        if body == FRAME:
            return
        self._loads.setdefault(body, []).append(load)

    def is_loaded(self, body: str) -> bool:
        """Whether a body has loads."""
        return body in self._loads

    def force(self, body: str) -> np.ndarray:
        """Resultant force on a body.

        Parameters
        ----------
        body : str

        Returns
        -------
        ndarray (n,) complex [N]
        """
        return _total(self._loads.get(body, []))

    def at(self, name: str) -> np.ndarray:
        """Point of a pair on its body.

        Parameters
        ----------
        name : str
            Name of the pair.

        Returns
        -------
        ndarray (n,) complex [m]
        """
        pair = self.kinematics.pairs[name]
        point: np.ndarray | None = self.points.get(pair.point)
        if point is None:
            point = self.points[pair.point] = self.kinematics.bodies[pair.body].position(pair.point)
        return point

    def along(self, name: str) -> np.ndarray:
        """Unit vector along a sliding pair.

        Parameters
        ----------
        name : str
            Name of the pair.

        Returns
        -------
        ndarray (n,) complex, dimensionless
        """
        return self.kinematics.line(self.kinematics.pairs[name])

    def moment(self, body: str, at: np.ndarray) -> np.ndarray:
        """Moment of a body's loads about a point, by their lever arms about that point: a far origin would cost digits.

        Parameters
        ----------
        body : str
        at : ndarray (n,) complex [m]

        Returns
        -------
        ndarray (n,) [N m]
        """
        return _moment(self._loads.get(body, []), at)

    def add_pin_force(self, name: str, body: str, force: np.ndarray) -> None:
        """Add the force of a pin to ``body``, one of its two bodies, and the opposite force to the second body.

        Parameters
        ----------
        name : str
            Name of the pin.
        body : str
        force : ndarray (n,) complex [N]
        """
        at = self.at(name)
        self.add_load(Load(body, at, force))
        self.transmit(name, body, at, force)

    def balance(self, name: str, body: str) -> None:
        """Balance the loads of ``body`` by the reaction of its last pair; the opposite reaction loads the second body."""
        pair, loads = self.kinematics.pairs[name], self._loads.get(body, [])
        partner = pair.on if body == pair.body else pair.body
        if pair.kind == REVOLUTE:
            if partner == FRAME:
                self._record(name, body, lambda: negated(_total(loads)))
            else:
                total = _total(loads)
                self._record(name, body, lambda: negated(total))
                self.add_load(Load(partner, self.at(name), total))
            return
        at, across = self.at(name), 1j * self.along(name)  # the force along its line is rounding
        if partner == FRAME:
            self._record(name, body, lambda: -dot(across, _total(loads)), lambda: -_moment(loads, at))
        else:
            self.transmit(name, body, at, -dot(across, _total(loads)), -_moment(loads, at))

    def transmit(self, name: str, body: str, at: np.ndarray, reaction: np.ndarray, couple: Number = 0.0) -> None:
        """Record the reaction and couple of a pair on ``body``, and load the pair's second body with their opposites.

        Parameters
        ----------
        name : str
            Name of the pair.
        body : str
        at : ndarray (n,) complex [m]
            Point of the pair.
        reaction : ndarray (n,) [N]
            As `reaction` returns it.
        couple : float or ndarray (n,) [N m]
        """
        pair = self.kinematics.pairs[name]
        self._record(name, body, lambda: reaction, lambda: np.asarray(couple))
        partner = pair.on if body == pair.body else pair.body
        if partner != FRAME:
            force = reaction if pair.kind == REVOLUTE else 1j * self.along(name) * reaction
            self.add_load(Load(partner, at, negated(force), -couple))

    def set_inner_effort(self, effort: np.ndarray) -> None:
        """Set the effort of a driver between two moving bodies.

        Parameters
        ----------
        effort : ndarray (n,) [N m or N]
        """
        self._inner = effort

    def set_input(self, body: str, effort: np.ndarray) -> None:
        """Set the effort of a second driver on a body.

        Parameters
        ----------
        body : str
        effort : ndarray (n,) [N m or N]
        """
        self._couples[input_of(body)] = effort

    def _record(
        self, name: str, body: str, reaction: Callable[[], np.ndarray], couple: Callable[[], np.ndarray] | None = None
    ) -> None:
        """Record reaction and couple of a pair on one of its bodies, with the sign for ``on`` on ``body``."""
        pair = self.kinematics.pairs[name]
        is_reversed = body != pair.body
        self._pairs[name] = (lambda: negated(reaction())) if is_reversed else reaction
        if pair.kind != REVOLUTE and couple is not None:
            self._couples[name] = (lambda: -couple()) if is_reversed else couple


def _by_virtual_power(kinematics: Kinematics, loads: Iterable[Load]) -> np.ndarray:
    """Driver effort that balances loads (n,), by virtual power: -Σ (F · ∂z/∂q + M ∂θ/∂q), q the driver's coordinate."""
    effort: Any = np.zeros(1)
    for load in loads:
        if load.body != FRAME:
            body = kinematics.by_driver[load.body]
            speed = body.origin[1] + 1j * body.turn[1] * (load.at - body.origin[0])
            effort = effort - dot(load.force, speed) - load.couple * body.turn[1]
    return np.asarray(effort)


def _total(loads: list[Load]) -> np.ndarray:
    if not loads:
        return _ZERO_FORCE
    total = loads[0].force
    for load in loads[1:]:
        total = total + load.force
    return total


def _moment(loads: list[Load], at: np.ndarray) -> np.ndarray:
    parts = [load.couple for load in loads if isinstance(load.couple, np.ndarray) or load.couple]
    parts += [cross(load.at - at, load.force) for load in loads if load.at is not at]
    moment: Any = parts[0] if parts else 0.0
    for part in parts[1:]:
        moment = moment + part
    return moment if isinstance(moment, np.ndarray) else np.array([moment])


def _evaluate(table: dict[str, np.ndarray | Callable[[], np.ndarray]], name: str) -> np.ndarray | None:
    """Value of an entry, computed once."""
    entry = table.get(name)
    if callable(entry):
        entry = table[name] = entry()
    return entry


def _cut_force(c1: np.ndarray, c2: np.ndarray, q1: np.ndarray, q2: np.ndarray) -> np.ndarray:
    """Force F with dot(c1, F) = -q1 and dot(c2, F) = -q2."""
    inverse = 1.0 / cross(c1, c2)
    return 1j * (c2 * (q1 * inverse) - c1 * (q2 * inverse))


def _rrr(walk: Walk, dyad: Dyad) -> None:
    (a, b), (outer_a, inner, outer_b) = dyad.bodies, dyad.pairs
    pin_a, joint, pin_b = [walk.at(name) for name in dyad.pairs]
    cached = walk.points.get(dyad.pairs)
    if cached is None:
        arm_a, arm_b = joint - pin_a, joint - pin_b  # the columns are i times these, the second one with a minus
        cached = walk.points[dyad.pairs] = arm_a, arm_b, -1.0 / cross(arm_a, arm_b)
    arm_a, arm_b, factor = cached
    parts = [
        arm * (walk.moment(body, pin) * factor)
        for body, pin, arm in ((a, pin_a, arm_b), (b, pin_b, arm_a))
        if walk.is_loaded(body)
    ]
    walk.add_pin_force(inner, a, parts[0] + parts[1] if len(parts) == 2 else parts[0])
    walk.balance(outer_a, a)
    walk.balance(outer_b, b)


def _rrp(walk: Walk, dyad: Dyad) -> None:
    (a, b), (outer, inner, guide) = dyad.bodies, dyad.pairs
    pin, joint, t = walk.at(outer), walk.at(inner), walk.along(guide)
    walk.add_pin_force(inner, a, _cut_force(1j * (joint - pin), -t, walk.moment(a, pin), dot(t, walk.force(b))))
    walk.balance(outer, a)
    walk.balance(guide, b)


def _rpr(walk: Walk, dyad: Dyad) -> None:
    (a, b), (outer_a, inner, outer_b) = dyad.bodies, dyad.pairs
    pin_a, pin_b, t = walk.at(outer_a), walk.at(outer_b), walk.along(inner)
    moments = walk.moment(a, pin_b) + walk.moment(b, pin_b)
    walk.add_pin_force(outer_a, a, _cut_force(1j * (pin_a - pin_b), t, moments, dot(t, walk.force(a))))
    walk.balance(inner, a)
    walk.balance(outer_b, b)


def _prp(walk: Walk, dyad: Dyad) -> None:
    (a, b), (guide_a, inner, guide_b) = dyad.bodies, dyad.pairs
    t1, t2 = walk.along(guide_a), walk.along(guide_b)
    walk.add_pin_force(inner, a, _cut_force(t1, -t2, dot(t1, walk.force(a)), dot(t2, walk.force(b))))
    walk.balance(guide_a, a)
    walk.balance(guide_b, b)


def _rpp(walk: Walk, dyad: Dyad) -> None:
    (a, b), (outer, inner, guide) = dyad.bodies, dyad.pairs
    t1, t2 = walk.along(inner), walk.along(guide)
    walk.add_pin_force(outer, a, _cut_force(t1, t2, dot(t1, walk.force(a)), dot(t2, walk.force(a) + walk.force(b))))
    walk.balance(inner, a)
    walk.balance(guide, b)


def _group(walk: Walk, dyad: Dyad) -> None:
    """All reactions of a group at once, by the balance of its bodies, and its driver's effort.

    Where the group has redundant pairs the smallest reactions that balance it.
    """
    kinematics, centre = walk.kinematics, walk.at(dyad.pairs[0])
    has_driver = int(bool(dyad.driven))
    matrix = np.zeros((kinematics.theta.size, 3 * len(dyad.bodies), 2 * len(dyad.pairs) + has_driver))
    if has_driver:
        pair, at = kinematics.pairs[dyad.driven], walk.at(dyad.driven) - centre
        force = np.zeros_like(at) if pair.kind == REVOLUTE else walk.along(dyad.driven) * np.ones_like(at)
        for body, sign in ((pair.body, 1.0), (pair.on, -1.0)):
            if body in dyad.bodies:
                row = 3 * dyad.bodies.index(body)
                matrix[:, row, -1], matrix[:, row + 1, -1] = sign * force.real, sign * force.imag
                matrix[:, row + 2, -1] = sign * (1.0 if pair.kind == REVOLUTE else cross(at, force))
    columns: list[tuple[str, np.ndarray, np.ndarray]] = []
    for i, name in enumerate(dyad.pairs):
        pair, at = kinematics.pairs[name], walk.at(name) - centre
        unit = np.ones_like(at)
        unit_loads = (
            ((unit, 0.0), (1j * unit, 0.0))
            if pair.kind == REVOLUTE
            else ((1j * walk.along(name), 0.0), (0.0 * unit, 1.0))
        )
        for k, (force, couple) in enumerate(unit_loads):
            for body, sign in ((pair.body, 1.0), (pair.on, -1.0)):
                if body in dyad.bodies:
                    row = 3 * dyad.bodies.index(body)
                    matrix[:, row, 2 * i + k], matrix[:, row + 1, 2 * i + k] = sign * force.real, sign * force.imag
                    matrix[:, row + 2, 2 * i + k] = sign * (cross(at, force) + couple)
        columns.append((name, *(force for force, _ in unit_loads)))  # type: ignore[arg-type]
    forces = [(walk.force(b), walk.moment(b, centre)) for b in dyad.bodies]
    loads = [part for force, moment in forces for part in (force.real, force.imag, moment)]
    reactions = _balanced(matrix, -np.array(np.broadcast_arrays(*loads)).T[..., None])[..., 0].T
    if has_driver:
        walk.set_inner_effort(reactions[-1])
    for i, (name, first, second) in enumerate(columns):
        pair = kinematics.pairs[name]
        is_pin = pair.kind == REVOLUTE
        reaction = reactions[2 * i] * first + reactions[2 * i + 1] * second if is_pin else reactions[2 * i]
        walk.transmit(name, pair.body, walk.at(name), reaction, 0.0 if is_pin else reactions[2 * i + 1])


def _balanced(matrix: np.ndarray, loads: np.ndarray) -> np.ndarray:
    """Forces that balance loads (n, m, 1) by columns (n, m, k), the smallest ones for more columns than rows."""
    if matrix.shape[1] == matrix.shape[2]:
        return np.linalg.solve(matrix, loads)
    q, r = np.linalg.qr(matrix.transpose(0, 2, 1))
    return np.asarray(q @ np.linalg.solve(r.transpose(0, 2, 1), loads))


def _input(walk: Walk, dyad: Dyad) -> None:
    """A body with a second driver, whose effort acts between it, the link that it is driven against, and the driver."""
    (body,), (pair,) = dyad.bodies, dyad.pairs
    is_pin = walk.kinematics.pairs[pair].kind == REVOLUTE
    effort = -walk.moment(body, walk.at(pair)) if is_pin else -dot(walk.along(pair), walk.force(body))
    on_body, *others = (load for _, load in input_loads(walk.kinematics, dyad, effort))
    if is_pin:
        walk.balance(pair, body)
        walk.add_load(on_body)
    else:  # the slide balances the remaining loads
        walk.add_load(on_body)
        walk.balance(pair, body)
    walk.set_input(body, effort)
    for load in others:
        walk.add_load(load)


STATICS: Mapping[str, Callable[[Walk, Dyad], None]] = MappingProxyType(
    {"RRR": _rrr, "RRP": _rrp, "RPR": _rpr, "PRP": _prp, "RPP": _rpp, "group": _group, "input": _input}
)
