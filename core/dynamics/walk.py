"""One walk of forces through a mechanism: from its outermost dyad or group to the driver, every reaction on the way.

A dyad is cut open where its loop was closed: the force F there does no work in its two coordinates but against the loads,
dot(c1, F) = -Q1, dot(c2, F) = -Q2, with the columns c1, c2 of the kinematic loop; all other reactions follow by balance.
Each kind of dyad is one row. A body that nothing loads is passed by.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from core.dynamics.elements import Load
from core.mechanism.kinematics import FRAME, REVOLUTE, Dyad, Kinematics
from core.numerics.derivatives import cross, dot, opposite

Number = float | np.ndarray
_NOTHING = np.zeros(1, dtype=complex)


def input_of(body: str) -> str:
    """What a second driver gives a body is called so among the couples."""
    return f"{body}_input"


def input_loads(kinematics: Kinematics, dyad: Dyad, effort: np.ndarray) -> Iterator[tuple[str, Load]]:
    """What a second driver does with an effort (n,): a torque [N m], or of what slides a force [N] along its line. By whom, and the load:
    on its body, on the link against which that is driven, and, by the ratio, on the driver.

    References
    ----------
    Moments of the link about its pin; forces of the link along its line.
    """
    (body,), (name,) = dyad.bodies, dyad.pairs
    for of, by, joint, share in (
        (body, dyad.on, name, 1.0),
        (dyad.on, body, name, -1.0),
        (kinematics.output, body, kinematics.driver_name, -dyad.ratio),
    ):
        pair = kinematics.pairs[joint]
        at = kinematics.bodies[pair.body if pair.body in kinematics.bodies else pair.on].place(pair.point)
        if pair.kind == REVOLUTE:
            yield by, Load(of, at, np.zeros(1, dtype=complex), share * effort)
        else:
            yield by, Load(of, at, share * effort * kinematics.line(pair))


class Walk:
    """Loads on each body, reactions of what is solved included.

    needed   (n,) what the driver must be given: torque [N m] where it is pinned to the frame, force [N] along its line
    names    of the pairs that something passes through; what it is, is made when it is read: see ``carried`` and ``couple``
    """

    def __init__(self, kinematics: Kinematics, loads: Iterable[Load], places: dict[Any, Any] | None = None) -> None:
        """places: where pairs stand, and what else of a dyad no load changes; what one walk finds serves the next one."""
        self.kinematics = kinematics
        self.places = {} if places is None else places
        self._loads: dict[str, list[Load]] = {}
        self._inner = np.zeros(1)
        self._pairs: dict[str, np.ndarray | Callable[[], np.ndarray]] = {}
        self._couples: dict[str, np.ndarray | Callable[[], np.ndarray]] = {}
        own = list(loads)
        for load in own:
            self.load(load)
        for dyad in kinematics.dyads:
            if any(body in self._loads for body in dyad.bodies):
                STATICS[dyad.kind](self, dyad)
        self.needed = self._driver()
        if own and any(dyad.redundant for dyad in kinematics.dyads):  # whatever its reactions are
            self.needed = _by_virtual_power(kinematics, own)
            for dyad in (each for each in kinematics.dyads if each.by_motion):
                body, on = (kinematics.by_driver[name].turn[1] for name in (dyad.bodies[0], dyad.on))
                given = self.couple(input_of(dyad.bodies[0]))
                self.needed = self.needed - (0.0 if given is None else given * (body - on))

    @property
    def names(self) -> Iterable[str]:
        return self._pairs.keys()

    def carried(self, name: str) -> np.ndarray | None:
        """What a pair carries (n,) [N] by ``on`` on ``body``, friction not in it: the force at the body's point of a pin, the normal
        force along line + 90 deg of a sliding pair; None where there is none."""
        return _made(self._pairs, name)

    def couple(self, name: str) -> np.ndarray | None:
        """The couple (n,) [N m] of a sliding pair, likewise."""
        return _made(self._couples, name)

    def _driver(self) -> np.ndarray:
        if self.kinematics.driver_on != FRAME:
            return self._inner
        driver, name = self.kinematics.output, self.kinematics.driver_name
        if driver not in self._loads:
            return np.zeros(1)
        at, loads = self.at(name), self._loads[driver]  # what is made later must not hold the walk, which holds it
        if self.kinematics.pairs[name].kind == REVOLUTE:
            self._record(name, driver, lambda: opposite(_total(loads)))
            return -_moment(loads, at)
        line, force = self.along(name), _total(loads)
        self._record(name, driver, lambda: -dot(1j * line, force), lambda: -_moment(loads, at))
        return -dot(line, force)

    def load(self, load: Load) -> None:
        """Put a load on its body; the frame bears anything."""
        body = load.body
        if body == FRAME:
            return
        self._loads.setdefault(body, []).append(load)

    def loaded(self, body: str) -> bool:
        """Whether anything acts on a body."""
        return body in self._loads

    def force(self, body: str) -> np.ndarray:
        """The resultant on a body (n,) [N]."""
        return _total(self._loads.get(body, []))

    def at(self, name: str) -> np.ndarray:
        """Where the body has its point of a pair (n,) complex [m]."""
        pair = self.kinematics.pairs[name]
        found: np.ndarray | None = self.places.get(pair.point)
        if found is None:
            found = self.places[pair.point] = self.kinematics.bodies[pair.body].place(pair.point)
        return found

    def along(self, name: str) -> np.ndarray:
        """Unit vector (n,) complex along a sliding pair."""
        return self.kinematics.line(self.kinematics.pairs[name])

    def about(self, body: str, at: np.ndarray) -> np.ndarray:
        """Moment of a body's loads about a place: of each the arm from there, since about a far origin it would lose digits."""
        return _moment(self._loads.get(body, []), at)

    def react(self, name: str, body: str, force: np.ndarray) -> None:
        """The force of a pin on ``body``, one of its two bodies, and the opposite on the other."""
        at = self.at(name)
        self.load(Load(body, at, force))
        self.pass_on(name, body, at, force)

    def hold(self, name: str, body: str) -> None:
        """The last pair of ``body`` takes all that is left of its loads and hands it on to the other body."""
        pair, loads = self.kinematics.pairs[name], self._loads.get(body, [])
        other = pair.on if body == pair.body else pair.body
        if pair.kind == REVOLUTE:
            if other == FRAME:
                self._record(name, body, lambda: opposite(_total(loads)))
            else:
                total = _total(loads)
                self._record(name, body, lambda: opposite(total))
                self.load(Load(other, self.at(name), total))
            return
        at, across = self.at(name), 1j * self.along(name)  # nothing is left along its line but rounding
        if other == FRAME:
            self._record(name, body, lambda: -dot(across, _total(loads)), lambda: -_moment(loads, at))
        else:
            self.pass_on(name, body, at, -dot(across, _total(loads)), -_moment(loads, at))

    def pass_on(self, name: str, body: str, at: np.ndarray, carried: np.ndarray, couple: Number = 0.0) -> None:
        """Record what a pair carries on ``body``, see ``carried``, and its couple; load the pair's other body with their opposites."""
        pair = self.kinematics.pairs[name]
        self._record(name, body, lambda: carried, lambda: np.asarray(couple))
        other = pair.on if body == pair.body else pair.body
        if other != FRAME:
            force = carried if pair.kind == REVOLUTE else 1j * self.along(name) * carried
            self.load(Load(other, at, opposite(force), -couple))

    def drive_inside(self, needed: np.ndarray) -> None:
        """What the driver must be given where it is between two bodies that move."""
        self._inner = needed

    def drive(self, body: str, torque: np.ndarray) -> None:
        """Record what drives a body beside the driver."""
        self._couples[input_of(body)] = torque

    def _record(
        self, name: str, body: str, carried: Callable[[], np.ndarray], couple: Callable[[], np.ndarray] | None = None
    ) -> None:
        """Into the tables, as by ``on`` on ``body`` of the pair."""
        pair = self.kinematics.pairs[name]
        turned = body != pair.body
        self._pairs[name] = (lambda: opposite(carried())) if turned else carried
        if pair.kind != REVOLUTE and couple is not None:
            self._couples[name] = (lambda: -couple()) if turned else couple


def _by_virtual_power(kinematics: Kinematics, loads: Iterable[Load]) -> np.ndarray:
    """What the driver must be given against loads (n,): -Σ (F · ∂z/∂q + M ∂θ/∂q), q its coordinate."""
    needed: Any = np.zeros(1)
    for load in loads:
        if load.body != FRAME:
            body = kinematics.by_driver[load.body]
            speed = body.origin[1] + 1j * body.turn[1] * (load.at - body.origin[0])
            needed = needed - dot(load.force, speed) - load.couple * body.turn[1]
    return np.asarray(needed)


def _total(loads: list[Load]) -> np.ndarray:
    if not loads:
        return _NOTHING
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


def _made(table: dict[str, np.ndarray | Callable[[], np.ndarray]], name: str) -> np.ndarray | None:
    """An entry, kept once it was made."""
    entry = table.get(name)
    if callable(entry):
        entry = table[name] = entry()
    return entry


def _cut_force(c1: np.ndarray, c2: np.ndarray, q1: np.ndarray, q2: np.ndarray) -> np.ndarray:
    """F with dot(c1, F) = -q1 and dot(c2, F) = -q2."""
    inverse = 1.0 / cross(c1, c2)
    return 1j * (c2 * (q1 * inverse) - c1 * (q2 * inverse))


def _rrr(walk: Walk, dyad: Dyad) -> None:
    (a, b), (outer_a, inner, outer_b) = dyad.bodies, dyad.pairs
    pin_a, joint, pin_b = (walk.at(name) for name in dyad.pairs)
    known = walk.places.get(dyad.pairs)
    if known is None:
        arm_a, arm_b = joint - pin_a, joint - pin_b  # the columns are i times these, the second one with a minus
        known = walk.places[dyad.pairs] = arm_a, arm_b, -1.0 / cross(arm_a, arm_b)
    arm_a, arm_b, per = known
    parts = [
        arm * (walk.about(body, pin) * per)
        for body, pin, arm in ((a, pin_a, arm_b), (b, pin_b, arm_a))
        if walk.loaded(body)
    ]
    walk.react(inner, a, parts[0] + parts[1] if len(parts) == 2 else parts[0])
    walk.hold(outer_a, a)
    walk.hold(outer_b, b)


def _rrp(walk: Walk, dyad: Dyad) -> None:
    (a, b), (outer, inner, guide) = dyad.bodies, dyad.pairs
    pin, joint, t = walk.at(outer), walk.at(inner), walk.along(guide)
    walk.react(inner, a, _cut_force(1j * (joint - pin), -t, walk.about(a, pin), dot(t, walk.force(b))))
    walk.hold(outer, a)
    walk.hold(guide, b)


def _rpr(walk: Walk, dyad: Dyad) -> None:
    (a, b), (outer_a, inner, outer_b) = dyad.bodies, dyad.pairs
    pin_a, pin_b, t = walk.at(outer_a), walk.at(outer_b), walk.along(inner)
    turning = walk.about(a, pin_b) + walk.about(b, pin_b)
    walk.react(outer_a, a, _cut_force(1j * (pin_a - pin_b), t, turning, dot(t, walk.force(a))))
    walk.hold(inner, a)
    walk.hold(outer_b, b)


def _prp(walk: Walk, dyad: Dyad) -> None:
    (a, b), (guide_a, inner, guide_b) = dyad.bodies, dyad.pairs
    t1, t2 = walk.along(guide_a), walk.along(guide_b)
    walk.react(inner, a, _cut_force(t1, -t2, dot(t1, walk.force(a)), dot(t2, walk.force(b))))
    walk.hold(guide_a, a)
    walk.hold(guide_b, b)


def _rpp(walk: Walk, dyad: Dyad) -> None:
    (a, b), (outer, inner, guide) = dyad.bodies, dyad.pairs
    t1, t2 = walk.along(inner), walk.along(guide)
    walk.react(outer, a, _cut_force(t1, t2, dot(t1, walk.force(a)), dot(t2, walk.force(a) + walk.force(b))))
    walk.hold(inner, a)
    walk.hold(guide, b)


def _group(walk: Walk, dyad: Dyad) -> None:
    """All reactions of a group at once, by the balance of each of its bodies, and what drives there; where more pairs hold it than need
    be the smallest ones that balance it."""
    kinematics, near = walk.kinematics, walk.at(dyad.pairs[0])
    drives = int(bool(dyad.driven))
    matrix = np.zeros((kinematics.theta.size, 3 * len(dyad.bodies), 2 * len(dyad.pairs) + drives))
    if drives:
        pair, at = kinematics.pairs[dyad.driven], walk.at(dyad.driven) - near
        pull = np.zeros_like(at) if pair.kind == REVOLUTE else walk.along(dyad.driven) * np.ones_like(at)
        for body, sign in ((pair.body, 1.0), (pair.on, -1.0)):
            if body in dyad.bodies:
                row = 3 * dyad.bodies.index(body)
                matrix[:, row, -1], matrix[:, row + 1, -1] = sign * pull.real, sign * pull.imag
                matrix[:, row + 2, -1] = sign * (1.0 if pair.kind == REVOLUTE else cross(at, pull))
    columns: list[tuple[str, np.ndarray, np.ndarray]] = []
    for i, name in enumerate(dyad.pairs):
        pair, at = kinematics.pairs[name], walk.at(name) - near
        one = np.ones_like(at)
        pulls = (
            ((one, 0.0), (1j * one, 0.0)) if pair.kind == REVOLUTE else ((1j * walk.along(name), 0.0), (0.0 * one, 1.0))
        )
        for k, (pull, couple) in enumerate(pulls):
            for body, sign in ((pair.body, 1.0), (pair.on, -1.0)):
                if body in dyad.bodies:
                    row = 3 * dyad.bodies.index(body)
                    matrix[:, row, 2 * i + k], matrix[:, row + 1, 2 * i + k] = sign * pull.real, sign * pull.imag
                    matrix[:, row + 2, 2 * i + k] = sign * (cross(at, pull) + couple)
        columns.append((name, *(pull for pull, _ in pulls)))  # type: ignore[arg-type]
    forces = [(walk.force(b), walk.about(b, near)) for b in dyad.bodies]
    loads = [part for force, moment in forces for part in (force.real, force.imag, moment)]
    found = _balanced(matrix, -np.array(np.broadcast_arrays(*loads)).T[..., None])[..., 0].T
    if drives:
        walk.drive_inside(found[-1])
    for i, (name, first, second) in enumerate(columns):
        pair = kinematics.pairs[name]
        turns = pair.kind == REVOLUTE
        carried = found[2 * i] * first + found[2 * i + 1] * second if turns else found[2 * i]
        walk.pass_on(name, pair.body, walk.at(name), carried, 0.0 if turns else found[2 * i + 1])


def _balanced(matrix: np.ndarray, loads: np.ndarray) -> np.ndarray:
    """What balances loads (n, m, 1) by columns (n, m, k); where there are more columns than rows the smallest."""
    if matrix.shape[1] == matrix.shape[2]:
        return np.linalg.solve(matrix, loads)
    q, r = np.linalg.qr(matrix.transpose(0, 2, 1))
    return np.asarray(q @ np.linalg.solve(r.transpose(0, 2, 1), loads))


def _input(walk: Walk, dyad: Dyad) -> None:
    """A body that is driven too: what it takes comes from the link against which it is driven, and from the driver by the ratio."""
    (body,), (pair,) = dyad.bodies, dyad.pairs
    turns = walk.kinematics.pairs[pair].kind == REVOLUTE
    effort = -walk.about(body, walk.at(pair)) if turns else -dot(walk.along(pair), walk.force(body))
    own, *others = (load for _, load in input_loads(walk.kinematics, dyad, effort))
    if turns:
        walk.hold(pair, body)
        walk.load(own)
    else:  # its line bears what is left
        walk.load(own)
        walk.hold(pair, body)
    walk.drive(body, effort)
    for load in others:
        walk.load(load)


STATICS: Mapping[str, Callable[[Walk, Dyad], None]] = MappingProxyType(
    {"RRR": _rrr, "RRP": _rrp, "RPR": _rpr, "PRP": _prp, "RPP": _rpp, "group": _group, "input": _input}
)
