"""After lift-off: the follower flies free from the angle at which the contact force vanishes until it lands on the cam again."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from core.dynamics.checks import FlankChange, ForcesAt, sign_changes
from core.dynamics.elements import Friction, Load, Loading, Lossless, Rate, ScheduledForce
from core.dynamics.forces import JAMS, Forces, carried, newton_euler, unit_friction
from core.dynamics.friction import below_jamming, magnitudes
from core.errors import NoSolution
from core.frozen import frozen
from core.mechanism import Mechanism, driver_ranges_for, solve_mechanism
from core.mechanism.kinematics import Kinematics
from core.motion import TURN, Angles, CompiledMotion, MotionState
from core.numerics.derivatives import Derivatives

# -- after lift-off ---------------------------------------------------------------------------------------------


NODES = 40  # of what moves the follower, as polynomials over its place
ROUNDING = 1e-15  # of the largest coefficient: what is left out
ROOM = 0.5  # of the stroke: how far beyond its ends the follower is foreseen to fly at first
FARTHEST = 20.0  # strokes: beyond them it is gone
RTOL, ATOL = 1e-11, 1e-13  # of the integration; the latter of the stroke
STEP = math.radians(3.0)
INSIDE = np.concatenate(
    (10.0 ** np.arange(-6.0, -1.0), np.linspace(0.1, 1.0, 13))
)  # of a step: where the gap is looked at
NO_GAP = 1e-11  # of the stroke: below it the follower has not left the cam
AT_REST = 1e-5  # of the greatest landing speed: a slower rebound is none
SAME = 1e-9  # [rad] angles of lift-off that are one
MOST = 400  # flights
FADES = 1e-3  # of the motion's greatest velocity: below it friction fades in flight
PATH = 12  # points of a path in every step


@frozen(eq=False)
class Flight:
    """One flight. Angles [rad] are counted on over the turns.

    lift, land  where it begins and ends; land is infinite where it does not within the turns asked for
    height      [m or rad] the greatest distance from the motion that the cam asks for, along the motion, at ``highest``
    speed       [m/s or rad/s] of landing, against the motion of the cam, ≥ 0
    theta, y    (k,) the way: angles, and the follower's motion [m or rad]
    """

    lift: float
    land: float
    height: float
    highest: float
    speed: float
    theta: np.ndarray
    y: np.ndarray


@frozen(eq=False)
class Flights:
    """All flights within some turns, from the first lift-off on. steady: after resting it leaves the cam where it did before, so that
    the flights from ``repeats`` on come again; turns: of one repetition, 0 where they do not repeat."""

    flights: tuple[Flight, ...]
    steady: bool
    repeats: int = 0
    turns: int = 0


@frozen
class _OneNewton(Lossless):
    """A newton (a newton metre in a pin) of friction against positive slip, as a load."""

    friction: Friction

    @property
    def acts(self) -> bool:
        return True

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        yield from unit_friction(kinematics, self.friction)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        return np.zeros((2, kinematics.theta.size))


def _fitted(rows: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Chebyshev coefficients (k, r) of rows (r, n) at the nodes."""
    found = rows @ np.linalg.inv(chebyshev.chebvander(x, x.size - 1)).T
    keep = np.abs(found) > ROUNDING * x.size * np.abs(found).max(axis=1, keepdims=True)
    last = int(np.flatnonzero(keep.any(axis=0)).max(initial=0)) + 1
    return np.ascontiguousarray(found[:, :last].T)


class _Rubbing:
    """Friction of the pairs in flight: sizes f = μ|N|, the reactions N = N0 + n y'' + Σ s G f with s the direction of slip. With
    y'' = y0'' - Σ s d f/M, d what one newton asks of the driver, N is affine in f. Slower than ``fades`` friction fades.
    """

    def __init__(
        self,
        kinematics: Kinematics,
        cases: Sequence[Forces],
        frictions: Sequence[Friction],
        fades: float,
        x: np.ndarray,
    ) -> None:
        self._frictions, self._fades = frictions, fades
        units = [newton_euler(kinematics, None, Loading((), (_OneNewton(f),)), 0.0) for f in frictions]
        one = np.ones(kinematics.theta.size)
        parts = [np.array([part * one for part in self.carried(kinematics, case)]) for case in (*cases, *units)]
        parts[2] = parts[2] - parts[1] - parts[3]  # of dampers alone
        self._number = np.repeat(np.arange(len(frictions)), [len(carried(kinematics, units[0], f)) for f in frictions])
        slips = [1.0 if f.pair == kinematics.driver_name else kinematics.slip(f.pair) for f in frictions]
        table = [part for rows in parts for part in rows]
        table += [unit.driver * one for unit in units] + [kinematics.driver_sign * slip * one for slip in slips]
        self._coefficients = np.array([f.coefficient * f.radius for f in frictions])[self._number]
        self._shape, self._rows = (len(parts), self._number.size), _fitted(np.array(table), x)

    def carried(self, kinematics: Kinematics, forces: Forces) -> list[np.ndarray]:
        """What carries the reactions of all pairs that rub, each (n,)."""
        return [part for f in self._frictions for part in carried(kinematics, forces, f)]

    def slowing(self, at: float, mass: float, free: float, speed: float, more: Sequence[np.ndarray] = ()) -> float:
        """What friction takes from y0'' = ``free`` at a place of the polynomials; more: of the reactions, by other loads. Raises
        NoSolution where it jams."""
        found, count = chebyshev.chebval(at, self._rows), len(self._frictions)
        parts = found[: self._shape[0] * self._shape[1]].reshape(self._shape)
        driver, slips = found[-2 * count : -count].real, found[-count:].real
        signs = np.sign(slips) * math.tanh(speed / self._fades)
        asked = (signs * driver)[self._number] / mass
        normals = parts[0] * free + parts[1] * speed * speed + parts[2] * speed + parts[3]
        if more:
            normals = normals + np.array([part[0] for part in more])
        gains = parts[4:][self._number].T * signs[self._number] - parts[0][:, None] * asked
        jam = below_jamming(gains[:, :, None], self._coefficients)
        if jam[0] >= JAMS:
            raise NoSolution("friction jams the follower in its flight", self._frictions[0].field, "lower it")
        sizes = magnitudes(normals[:, None], gains[:, :, None], self._coefficients, jam)[:, 0] * self._coefficients
        return float(asked @ sizes)


class FreeFollower:
    """M y'' + H y'² + C y' + S = 0 of the follower without its cam, y its motion [m or rad] and ' by time: polynomials over y.

    Process forces are taken as they are at each angle. Friction in pairs fades below the speed ``fades``.
    """

    def __init__(self, mechanism: Mechanism, loading: Loading, low: float, high: float, fades: float) -> None:
        self._mechanism, self._low, self._high = mechanism, low, high
        self._course = driver_ranges_for(mechanism, lambda: (low, high))
        timed = tuple(e for e in loading.others if isinstance(e, ScheduledForce) and e.acts)
        steady = Loading(loading.masses, tuple(e for e in loading.others if e not in timed))
        self._timed = Loading((), timed) if timed else None
        x = chebyshev.chebpts1(NODES)
        kinematics = self._kinematics(0.5 * (low + high) + 0.5 * (high - low) * x, np.zeros(NODES))
        solved = partial(newton_euler, kinematics, None)
        standing, inertial, mass = (
            solved(steady, 0.0),
            solved(loading.inertial, 1.0),
            solved(loading.inertial, 0.0, 1.0),
        )
        moving = solved(steady, 1.0)
        damped = moving.driver - standing.driver - inertial.driver
        self._rows = _fitted(np.array([mass.driver, inertial.driver, damped, standing.driver]), x)
        cases = mass, inertial, moving, standing
        self._rubbing = _Rubbing(kinematics, cases, loading.frictions, fades, x) if loading.frictions else None

    def _kinematics(self, y: np.ndarray, theta: np.ndarray) -> Kinematics:
        one, none = np.ones(y.size), np.zeros(y.size)
        state = MotionState(
            Angles(np.mod(theta, TURN), np.zeros(y.size, dtype=int)), Derivatives.of((y, one, none, none)), one
        )
        return solve_mechanism(self._mechanism, state, self._course)

    def reaches(self, y: float, away: float) -> bool:
        """Whether a place is near enough to the cam that the polynomials hold."""
        return y <= self._high if away > 0.0 else y >= self._low

    def acceleration(self, theta: float, y: float, speed: float) -> float:
        """y'' by time; beyond the ends, which a step that is cut off at its landing may pass, as at the ends."""
        at = min(max((y - 0.5 * (self._low + self._high)) / (0.5 * (self._high - self._low)), -1.0), 1.0)
        mass, inertial, damped, standing = chebyshev.chebval(at, self._rows)
        more: Sequence[np.ndarray] = ()
        if self._timed is not None:
            place = self._kinematics(np.array([y]), np.array([theta]))
            forces = newton_euler(place, None, self._timed, 0.0)
            standing += forces.driver[0]
            more = () if self._rubbing is None else self._rubbing.carried(place, forces)
        free = float(-(standing + speed * (damped + speed * inertial)) / mass)
        return free if self._rubbing is None else free - self._rubbing.slowing(at, mass, free, speed, more)


def flights(
    contact: Callable[[Angles], np.ndarray],
    mechanism: Mechanism,
    loading: Loading,
    program: Any,
    omega: float,
    away: float,
    restitution: float = 0.0,
    turns: float = 3.0,
) -> Flights:
    """The flights of the follower of an open cam.

    Where F_c falls below zero, or the motion's velocity drops, the follower flies as M y'' + ... = 0 says, its pairs rubbing; it lands
    where its place has come back to the motion s(θ), with y' - s'. It rebounds with ``restitution`` times that, and rests where no
    rebound is left and the cam presses it. Both events are roots.

    contact   F_c (n,) [N] on the cam at any angles, at this speed
    omega     [rad/s]; away: +1 where a larger motion leads away from the cam, else -1
    turns     within which new flights begin

    Raises NoSolution where the cam never presses the follower, or it flies out of its reach.
    """
    flyer = _Flyer(mechanism, loading, program, omega, away)
    angles = program.angles(np.linspace(0.0, TURN, 3600, endpoint=False))
    pressed = contact(angles)
    if not (pressed > 0.0).any():
        raise NoSolution(
            "the cam presses the follower nowhere", "loads", "lower the speed, or give it a stronger spring"
        )
    lifts = sorted({*(theta % TURN for theta, sign in sign_changes(contact, program) if sign < 0.0), *flyer.drops()})
    found: list[Flight] = []
    rests: dict[int, int] = {}  # lift-off from rest -> number of its flight
    if not lifts:
        return Flights((), True)
    theta, speed, resting, end, fastest = lifts[0], None, True, lifts[0] + TURN * turns, 0.0
    while theta < end and len(found) < MOST:
        if resting:
            key = min(range(len(lifts)), key=lambda i: abs(_apart(lifts[i], theta)))
            if abs(_apart(lifts[key], theta)) < SAME:
                if key in rests:
                    first = rests[key]
                    return Flights(tuple(found), True, first, max(1, round((theta - found[first].lift) / TURN)))
                rests[key] = len(found)
        flight, after = flyer.fly(theta, speed, end + TURN)
        if flight is None:  # it does not get off
            rests = {key: number for key, number in rests.items() if number < len(found)}
            theta, speed, resting = _next(lifts, theta), None, True
            continue
        found.append(flight)
        if not math.isfinite(flight.land):
            break
        theta, fastest = flight.land, max(fastest, flight.speed)
        rebound = restitution * flight.speed
        resting = rebound <= AT_REST * fastest
        speed = None if resting else after + away * rebound / omega
        if resting and float(contact(program.angles(np.array([theta % TURN])))[0]) >= 0.0:
            theta = _next(lifts, theta)
    return Flights(tuple(found), not found)


def _apart(one: float, other: float) -> float:
    return (one - other + math.pi) % TURN - math.pi


def _next(lifts: list[float], theta: float) -> float:
    """The next angle of lift-off after an angle that is counted on."""
    return min(theta + (lift - theta) % TURN if (lift - theta) % TURN > SAME else theta + TURN for lift in lifts)


class _Flyer:
    """Flights of one follower over one motion."""

    def __init__(self, mechanism: Mechanism, loading: Loading, program: Any, omega: float, away: float) -> None:
        self._mechanism, self._loading, self._program, self._omega, self._away = (
            mechanism,
            loading,
            program,
            omega,
            away,
        )
        state = program.state(program.angles(np.linspace(0.0, TURN, 721))).displacement
        y, slope = state[0], state[1]
        self._low, self._high = float(y.min()), float(y.max())
        self._stroke = self._high - self._low or 1e-3
        self._fades = FADES * omega * (float(np.abs(slope).max()) or self._stroke)
        self._free = self._reaching(ROOM)

    def _reaching(self, room: float) -> FreeFollower:
        beyond, small = room * self._stroke, 1e-3 * self._stroke
        low, high = (small, beyond) if self._away > 0.0 else (beyond, small)
        return FreeFollower(self._mechanism, self._loading, self._low - low, self._high + high, self._fades)

    def drops(self) -> list[float]:
        """Angles [rad] at which the velocity jumps towards the cam, so that the follower flies on."""
        return [j.theta % TURN for j in self._program.joins if j.jumps[1] and self._away * j.jump[1] < 0.0]

    def motion(self, theta: np.ndarray, order: int = 0) -> np.ndarray:
        """s or s' (n,) at angles that are counted on."""
        return np.asarray(self._program.state(self._program.angles(np.mod(theta, TURN))).displacement[order])

    def _before(self, theta: float) -> tuple[float, float]:
        """s and s' left of an angle."""
        at = theta % TURN or TURN
        piece = max(int(np.searchsorted(self._program.starts, at - SAME, side="right")) - 1, 0)
        rows = self._program.state(Angles(np.array([at]), np.array([piece]))).displacement
        return float(rows[0][0]), float(rows[1][0])

    def fly(self, theta: float, speed: float | None, end: float) -> tuple[Flight | None, float]:
        """The flight from an angle with dy/dθ, None: that of the cam; and s' where it lands. No flight where it does not get off.

        Raises NoSolution where it flies out of reach."""
        room = ROOM
        while True:
            try:
                return self._fly(theta, speed, end)
            except _OutOfReachError:
                room *= 4.0
                degrees = math.degrees(theta % TURN)
                try:
                    self._free = self._reaching(room)
                except NoSolution:
                    room = math.inf
                if room > FARTHEST:
                    hint = "lower the speed, or give it a stronger spring"
                    raise NoSolution(
                        "the follower flies out of its reach", "loads", hint, [(degrees, degrees)]
                    ) from None

    def _fly(self, theta: float, speed: float | None, end: float) -> tuple[Flight | None, float]:
        from scipy.integrate import DOP853
        from scipy.optimize import brentq, minimize_scalar

        def change(at: float, y: np.ndarray) -> tuple[float, float]:
            return y[1], self._free.acceleration(at, float(y[0]), float(y[1]) * self._omega) / self._omega**2

        place, slope = self._before(theta)
        start = np.array([place, slope if speed is None else speed])
        tolerance = ATOL * self._stroke
        solver = DOP853(change, theta, start, end, max_step=STEP, rtol=RTOL, atol=tolerance)
        path, values, off = [np.array([theta])], [np.array([place])], False
        highest, height = theta, 0.0
        while solver.status == "running":
            solver.step()
            if not self._free.reaches(float(solver.y[0]), self._away):
                raise _OutOfReachError
            dense, begin = solver.dense_output(), solver.t_old

            def gap(at: float, dense: Any = dense) -> float:
                return float(self._away * (dense(at)[0] - self.motion(np.array([at]))[0]))

            points = begin + (solver.t - begin) * INSIDE
            gaps = self._away * (dense(points)[0] - self.motion(points))
            top = int(np.argmax(gaps))
            left = np.maximum.accumulate(gaps) > NO_GAP * self._stroke
            landed = np.flatnonzero((gaps <= 0.0) & (left | off))
            down = int(landed[0]) if landed.size else None
            if not off and not left[-1] and gaps[-1] < 0.0:
                return None, 0.0
            if gaps[top] > height and (down is None or top < down):
                low, high = (points[top - 1] if top else begin), points[min(top + 1, points.size - 1)]
                found = minimize_scalar(lambda at, gap=gap: -gap(at), bounds=(low, high), options={"xatol": 1e-9})
                highest, height = float(found.x), max(-float(found.fun), float(gaps[top]))
            off = off or bool(gaps[top] > NO_GAP * self._stroke)
            land = solver.t
            if down is not None:
                land = float(brentq(gap, points[down - 1] if down else begin, points[down]))
            way = np.linspace(begin, land, PATH + 1)[1:]
            path.append(way)
            values.append(dense(way)[0])
            if down is not None:
                slope = float(self.motion(np.array([land]), 1)[0])
                landing = max(-self._away * (float(dense(land)[1]) - slope) * self._omega, 0.0)
                return Flight(
                    theta, land, height, highest, landing, np.concatenate(path), np.concatenate(values)
                ), slope
        return Flight(theta, math.inf, height, highest, 0.0, np.concatenate(path), np.concatenate(values)), 0.0


class _OutOfReachError(Exception):
    """The follower has come farther than the polynomials reach."""


# -- how hard a follower strikes the other flank of a groove, or the other cam of a conjugate pair --------------


PANEL_NODES = 12  # of a panel, on which motion and levers are polynomials
ORDERS = np.arange(PANEL_NODES)
PANEL = math.radians(2.0)
PLAY_STEP, PART = (
    math.radians(1.0),
    0.2,
)  # of the integration; of the time in which the free follower swings by a radian, or is damped
LAST = 1e-11  # [rad] of the angle of landing
LONGEST = 0.125 * TURN  # of a flight: one that hangs in the play for longer strikes nothing worth naming
NEAR, FAR = 1e-5, 0.2  # [rad] where the angle is looked for at which the contact is lost: first step, farthest
BEYOND, PLAYS = 0.02, 20.0  # of the stroke, and of the play: how far beyond the motion the follower is foreseen to fly


def with_impacts(
    changes: Sequence[FlankChange],
    at: ForcesAt,
    mechanism: Mechanism,
    loading: Loading,
    program: CompiledMotion,
    omega: float,
    play: float,
) -> tuple[FlankChange, ...]:
    """The changes with the speed of impact along the normal [m/s]; None where the follower comes back to the flank that it left, or
    stays in the play as friction has stopped it.

    The roller that keeps to the first flank follows the motion s(θ), to the second one s + play/g₂; g the gap that a flank opens for
    each unit of motion, -g₂ its closing. From the angle at which the flank that it leaves would have to pull it the follower flies as
    M y'' + ... = 0 says, until the gap g(θ)(y - s) at the other one has closed. Of the normal distance the square of the play beside
    the radius of curvature is left out.
    """
    if not changes or not play > 0.0:
        return tuple(changes)
    motion = program.state(program.angles(np.linspace(0.0, TURN, 721))).displacement
    y, slope = np.asarray(motion[0]), np.asarray(motion[1])
    beyond = max(BEYOND * float(np.ptp(y)), PLAYS * play)
    try:
        free = FreeFollower(
            mechanism, loading, y.min() - beyond, y.max() + beyond, FADES * omega * float(np.abs(slope).max()) or 1.0
        )
        crossing = _Crossing(_Flanks(at, program, mechanism.driver_sign), free, play, omega)
        return tuple(replace(change, impact=crossing.impact(change.theta, change.to)) for change in changes)
    except NoSolution:  # it flies where the mechanism cannot stand, or jams
        return tuple(changes)


class _Row(NamedTuple):
    """Motion s and the gaps g that the two flanks open for each unit of it, at an angle: value and two derivatives by it."""

    motion: np.ndarray
    opening: tuple[np.ndarray, np.ndarray]


class _Flanks:
    """Motion and gaps by the cam angle, counted on over the turns: polynomials on panels, made when they are passed."""

    def __init__(self, at: ForcesAt, program: CompiledMotion, sense: float) -> None:
        self._at, self._program, self._sense = at, program, sense
        self._panels: dict[tuple[int, int], np.ndarray] = {}

    def bounds(self, theta: float) -> tuple[float, float]:
        """Where the piece of the motion in which an angle lies begins and ends."""
        turns = math.floor(theta / TURN) * TURN
        piece = self._piece(theta)
        return turns + float(self._program.starts[piece]), turns + float(self._program.ends[piece])

    def _piece(self, theta: float) -> int:
        return max(int(np.searchsorted(self._program.starts, theta % TURN, side="right")) - 1, 0)

    def row(self, theta: float) -> _Row:
        piece, at = self._piece(theta), theta % TURN
        start, end = float(self._program.starts[piece]), float(self._program.ends[piece])
        count = max(1, math.ceil((end - start) / PANEL))
        half = 0.5 * (end - start) / count
        number = min(int((at - start) / (2.0 * half)), count - 1)
        middle = start + (2 * number + 1) * half
        if (piece, number) not in self._panels:
            self._panels[piece, number] = self._made(piece, middle, half)
        x = min(max((at - middle) / half, -1.0), 1.0)
        motion, first, second = (np.cos(ORDERS * math.acos(x)) @ self._panels[piece, number]).reshape(3, 3).T
        return _Row(motion, (first, second))

    def _made(self, piece: int, middle: float, half: float) -> np.ndarray:
        """Chebyshev coefficients (NODES, 9) of motion and gaps, of their first and of their second derivatives."""
        x = chebyshev.chebpts1(PANEL_NODES)
        angles = Angles(middle + half * x, np.full(PANEL_NODES, piece))
        _, forces = self._at(angles)
        gaps = [-self._sense * contact.lever for contact in forces.contacts]
        values = np.array([np.asarray(self._program.state(angles).displacement[0]), *gaps])
        found = np.zeros((3, PANEL_NODES, 3))
        found[0] = np.linalg.solve(chebyshev.chebvander(x, PANEL_NODES - 1), values.T)
        for order in (1, 2):
            found[order, :-order] = chebyshev.chebder(found[0], order, 1.0 / half)
        return np.concatenate(list(found), axis=1)


class _Crossing:
    def __init__(self, flanks: _Flanks, free: FreeFollower, play: float, omega: float) -> None:
        self._flanks, self._free, self._omega = flanks, free, omega
        self._clear = (0.0, play)  # at each flank where the motion is s itself

    def impact(self, theta: float, to: int) -> float | None:
        """The speed at the flank ``to``, of the follower that leaves the other one at about this angle."""
        begin = self._lost(theta, 1 - to)
        if begin is None:
            return None
        place, slope, _ = self._guided(begin, 1 - to)
        theta, state = begin, np.array([place, slope])
        longest = self._longest_step(theta, place, slope)

        def closed(step: float) -> float:
            return self._gap(theta + step, self._flown(theta, state, step), to)[0]

        from scipy.optimize import brentq

        while theta < begin + LONGEST:
            after = self._flown(theta, state, longest)
            left = self._gap(theta + longest, after, to)[0]
            if left <= 0.0:
                step = float(brentq(closed, 0.0, longest, xtol=LAST))
                return max(-self._gap(theta + step, self._flown(theta, state, step), to)[1] * self._omega, 0.0)
            if self._gap(theta + longest, after, 1 - to)[0] <= 0.0:
                return None
            theta, state = theta + longest, after
        return None

    def _longest_step(self, theta: float, y: float, slope: float) -> float:
        """So short that springs and dampers count as what they are."""
        off, faster = self._clear[1] / abs(self._flanks.row(theta).opening[1][0]), 1e-3 * abs(slope) or 1.0
        stiff = (self._acceleration(theta, y + off, slope) - self._acceleration(theta, y - off, slope)) / (2.0 * off)
        damped = (self._acceleration(theta, y, slope + faster) - self._acceleration(theta, y, slope - faster)) / (
            2.0 * faster
        )
        return min(PLAY_STEP, PART / max(math.sqrt(abs(stiff)), abs(damped), PART))

    def _flown(self, theta: float, state: np.ndarray, step: float) -> np.ndarray:
        """y and dy/dθ a step later (Runge and Kutta's)."""

        def rate(at: float, y: np.ndarray) -> np.ndarray:
            return np.array([y[1], self._acceleration(at, float(y[0]), float(y[1]))])

        one = rate(theta, state)
        two = rate(theta + 0.5 * step, state + 0.5 * step * one)
        three = rate(theta + 0.5 * step, state + 0.5 * step * two)
        four = rate(theta + step, state + step * three)
        return np.asarray(state + step / 6.0 * (one + 2.0 * two + 2.0 * three + four))

    def _acceleration(self, theta: float, y: float, slope: float) -> float:
        """y'' of the free follower by the angle."""
        return self._free.acceleration(theta, y, slope * self._omega) / self._omega**2

    def _gap(self, theta: float, state: np.ndarray, flank: int) -> tuple[float, float]:
        """Between follower and flank, and its derivative by the angle [m]."""
        motion, opening = self._flanks.row(theta)
        by, off, drift = opening[flank], state[0] - motion[0], state[1] - motion[1]
        return float(self._clear[flank] + by[0] * off), float(by[0] * drift + by[1] * off)

    def _guided(self, theta: float, flank: int) -> tuple[float, float, float]:
        """y and two derivatives of the follower that keeps to a flank."""
        motion, opening = self._flanks.row(theta)
        by, clear = opening[flank], self._clear[flank]
        off = np.array([-1.0 / by[0], by[1] / by[0] ** 2, by[2] / by[0] ** 2 - 2.0 * by[1] ** 2 / by[0] ** 3])
        y, slope, bend = motion + clear * off
        return float(y), float(slope), float(bend)

    def _lost(self, theta: float, flank: int) -> float | None:
        """The angle at which a flank would have to pull the follower; of the first, which it keeps to as the motion says, the given one.

        Where the acceleration jumps there it is that of the jump; None where it lies far off.
        """
        if not self._clear[flank]:
            return theta

        def leaving(at: float) -> float:
            y, slope, bend = self._guided(at, flank)
            opening = self._flanks.row(at).opening[flank][0]
            return float(opening * (self._acceleration(at, y, slope) - bend))

        start, _ = self._flanks.bounds(theta)
        here, step = leaving(theta), NEAR
        side = -1.0 if here > 0.0 else 1.0
        while step < FAR:
            beside = theta + side * step
            if beside < start:
                return theta
            if (leaving(beside) > 0.0) != (here > 0.0):
                from scipy.optimize import brentq

                return float(brentq(leaving, theta, beside))
            step *= 2.0
        return None
