"""Free flight of the follower from lift-off to landing, and impacts across the play of two flanks."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from core.dynamics.checks import FlankChange, ForcesAt, sign_changes
from core.dynamics.elements import Element, Load, Rate, ScheduledForce
from core.dynamics.forces import Forces, edge_forces, newton_euler
from core.dynamics.friction import JAMS, jam_factor_bound, magnitudes
from core.dynamics.loading import Friction, Loading
from core.dynamics.unit_loads import unit_friction
from core.errors import NoSolution
from core.frozen import frozen
from core.mechanism import Mechanism, driver_ranges_for, solve_mechanism
from core.mechanism.kinematics import Kinematics
from core.motion import TURN, Angles, CompiledMotion, MotionState
from core.numerics.derivatives import Derivatives

# -- free flight ------------------------------------------------------------------------------------------------


NODES = 40  # of the polynomials over the follower's position
ROUNDING = 1e-15  # of the largest coefficient: smaller ones are omitted
MARGIN = 0.5  # of the stroke: first range of the polynomials beyond its ends
LARGEST_MARGIN = 20.0  # strokes: a farther flight has no solution
RTOL, ATOL = 1e-11, 1e-13  # of the integration; the latter relative to the stroke
STEP = math.radians(3.0)
INSIDE = np.concatenate(
    (10.0 ** np.arange(-6.0, -1.0), np.linspace(0.1, 1.0, 13))
)  # of a step, at which the gap is evaluated
NO_GAP = 1e-11  # of the stroke: below it the follower has not left the cam
AT_REST = 1e-5  # of the greatest landing speed: a slower rebound is neglected
SAME = 1e-9  # [rad] largest difference of equal angles of lift-off
MOST_FLIGHTS = 400
FADE = 1e-3  # of the motion's greatest velocity: below it friction in flight fades to 0
PATH = 12  # points of a path in every step


@frozen(eq=False)
class Flight:
    """One flight. Cam angles [rad] increase over the turns.

    Attributes
    ----------
    lift, land : begin and end; ``land`` is infinite where it does not land within the requested turns
    height : greatest distance from the motion of the cam, along the motion [m or rad], at the angle ``highest``
    speed : landing speed relative to the motion of the cam [m/s or rad/s], not negative
    theta : ndarray (k,) [rad]
        Cam angles of the path.
    y : ndarray (k,) [m or rad]
        The follower's motion there.
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
    """All flights within some turns, from the first lift-off on.

    Attributes
    ----------
    flights : in their order
    steady : after a rest the follower leaves the cam at the same angle, so that the flights from ``repeats`` on repeat
    turns : turns of one repetition; 0 where they do not repeat
    """

    flights: tuple[Flight, ...]
    steady: bool
    repeats: int = 0
    turns: int = 0


@frozen
class _UnitFriction(Element):
    """One newton (one newton metre in a pin) of friction against positive slip."""

    friction: Friction
    strengths: ClassVar[tuple[str, ...]] = ("friction",)

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        yield from unit_friction(kinematics, self.friction.pair)


def _chebyshev_fit(rows: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Chebyshev coefficients (k, r) of rows (r, n) at the nodes."""
    coefficients = rows @ np.linalg.inv(chebyshev.chebvander(x, x.size - 1)).T
    significant = np.abs(coefficients) > ROUNDING * x.size * np.abs(coefficients).max(axis=1, keepdims=True)
    last = int(np.flatnonzero(significant.any(axis=0)).max(initial=0)) + 1
    return np.ascontiguousarray(coefficients[:, :last].T)


class _FlightFriction:
    """Friction of the pairs in flight: sizes f = μ|N|, reactions N = N0 + n y'' + Σ s G f, s the direction of slip.

    With y'' = y0'' - Σ s d f/M, d the driver effort of one newton of friction, N is affine in f. Below the speed
    ``fade`` [m/s or rad/s] friction fades to 0.
    """

    def __init__(
        self,
        kinematics: Kinematics,
        cases: Sequence[Forces],
        frictions: Sequence[Friction],
        fade: float,
        x: np.ndarray,
    ) -> None:
        self._frictions, self._fade = frictions, fade
        units = [newton_euler(kinematics, None, Loading((), (_UnitFriction(f),)), 0.0) for f in frictions]
        ones = np.ones(kinematics.theta.size)
        parts = [np.array([part * ones for part in self.edge_forces(kinematics, case)]) for case in (*cases, *units)]
        parts[2] = parts[2] - parts[1] - parts[3]  # of dampers alone
        counts = [len(edge_forces(kinematics, units[0], f)) for f in frictions]
        self._number = np.repeat(np.arange(len(frictions)), counts)
        slips = [1.0 if f.pair == kinematics.driver_name else kinematics.slip(f.pair) for f in frictions]
        table = [part for rows in parts for part in rows]
        table += [unit.driver * ones for unit in units] + [kinematics.driver_sign * slip * ones for slip in slips]
        self._coefficients = np.array([f.coefficient * f.radius for f in frictions])[self._number]
        self._shape, self._rows = (len(parts), self._number.size), _chebyshev_fit(np.array(table), x)

    def edge_forces(self, kinematics: Kinematics, forces: Forces) -> list[np.ndarray]:
        """Reactions (n,) of all pairs with friction."""
        return [part for f in self._frictions for part in edge_forces(kinematics, forces, f)]

    def deceleration(self, x: float, mass: float, free: float, speed: float, more: Sequence[np.ndarray] = ()) -> float:
        """Decrease of y0'' = ``free`` by friction at the position x of the polynomials.

        more: reactions to further loads. Raises NoSolution where friction jams.
        """
        values, count = chebyshev.chebval(x, self._rows), len(self._frictions)
        parts = values[: self._shape[0] * self._shape[1]].reshape(self._shape)
        driver, slips = values[-2 * count : -count].real, values[-count:].real
        signs = np.sign(slips) * math.tanh(speed / self._fade)
        per_friction = (signs * driver)[self._number] / mass
        normals = parts[0] * free + parts[1] * speed * speed + parts[2] * speed + parts[3]
        if more:
            normals = normals + np.array([part[0] for part in more])
        gains = parts[4:][self._number].T * signs[self._number] - parts[0][:, None] * per_friction
        jam = jam_factor_bound(gains[:, :, None], self._coefficients)
        if jam[0] >= JAMS:
            raise NoSolution("friction jams the follower in its flight", self._frictions[0].field, "lower it")
        sizes = magnitudes(normals[:, None], gains[:, :, None], self._coefficients, jam)[:, 0] * self._coefficients
        return float(per_friction @ sizes)


class FreeFollower:
    """Motion y [m or rad] of the follower without its cam, M y'' + H y'² + C y' + S = 0, with polynomials over y.

    The derivatives are by time. Process forces are those at each cam angle. Friction in pairs fades below the speed
    ``fade``.
    """

    def __init__(self, mechanism: Mechanism, loading: Loading, low: float, high: float, fade: float) -> None:
        self._mechanism, self._low, self._high = mechanism, low, high
        self._ranges = driver_ranges_for(mechanism, lambda: (low, high))
        scheduled = tuple(e for e in loading.others if isinstance(e, ScheduledForce) and e.is_active)
        steady = Loading(loading.masses, tuple(e for e in loading.others if e not in scheduled))
        self._scheduled = Loading((), scheduled) if scheduled else None
        loading = replace(loading, contact_window=None)  # the valve ends a flight on its seat
        x = chebyshev.chebpts1(NODES)
        kinematics = self._kinematics(0.5 * (low + high) + 0.5 * (high - low) * x, np.zeros(NODES))
        solve = partial(newton_euler, kinematics, None)
        static, inertia, mass = (
            solve(steady, 0.0),
            solve(loading.inertial, 1.0),
            solve(loading.inertial, 0.0, 1.0),
        )
        moving = solve(steady, 1.0)
        damping = moving.driver - static.driver - inertia.driver
        self._rows = _chebyshev_fit(np.array([mass.driver, inertia.driver, damping, static.driver]), x)
        cases = mass, inertia, moving, static
        self._friction = _FlightFriction(kinematics, cases, loading.frictions, fade, x) if loading.frictions else None

    def _kinematics(self, y: np.ndarray, theta: np.ndarray) -> Kinematics:
        ones, zeros = np.ones(y.size), np.zeros(y.size)
        state = MotionState(
            Angles(np.mod(theta, TURN), np.zeros(y.size, dtype=int)), Derivatives.of((y, ones, zeros, zeros)), ones
        )
        return solve_mechanism(self._mechanism, state, self._ranges)

    def is_in_range(self, y: float, away: float) -> bool:
        """Whether a position is in the range of the polynomials."""
        return y <= self._high if away > 0.0 else y >= self._low

    def acceleration(self, theta: float, y: float, speed: float) -> float:
        """Acceleration y'' by time at a cam angle, position and speed.

        Beyond the range of the polynomials, which a step before a landing may leave, the values at its ends hold.
        """
        x = min(max((y - 0.5 * (self._low + self._high)) / (0.5 * (self._high - self._low)), -1.0), 1.0)
        mass, inertia, damping, static = chebyshev.chebval(x, self._rows)
        reactions: Sequence[np.ndarray] = ()
        if self._scheduled is not None:
            kinematics = self._kinematics(np.array([y]), np.array([theta]))
            forces = newton_euler(kinematics, None, self._scheduled, 0.0)
            static += forces.driver[0]
            reactions = () if self._friction is None else self._friction.edge_forces(kinematics, forces)
        free = float(-(static + speed * (damping + speed * inertia)) / mass)
        return free if self._friction is None else free - self._friction.deceleration(x, mass, free, speed, reactions)


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

    Where F_c falls below zero, or the motion's velocity drops, the follower flies by M y'' + ... = 0, with friction in
    its pairs. It lands where its position returns to the motion s(θ), with the relative speed y' - s', and a valve with
    lash on its seat where s(θ) is lower. It rebounds with
    ``restitution`` times that speed, and rests where the rebound is negligible and the cam presses it. Both events are
    roots.

    Parameters
    ----------
    contact : function
        Angles (n,) -> contact force F_c (n,) [N] on the cam at this speed.
    mechanism : Mechanism
    loading : Loading
    program : CompiledMotion
    omega : float
        Speed of the cam [rad/s].
    away : float
        +1 where a larger motion leads away from the cam, otherwise -1.
    restitution : float
        Coefficient of restitution.
    turns : float
        Turns within which new flights begin.

    Returns
    -------
    Flights

    Raises
    ------
    NoSolution
        Where the cam never presses the follower, or a flight exceeds the range of the mechanism.
    """
    flyer = _Flyer(mechanism, loading, program, omega, away)
    angles = program.angles(np.linspace(0.0, TURN, 3600, endpoint=False))
    force = contact(angles)
    if not (force > 0.0).any():
        raise NoSolution(
            "the cam presses the follower nowhere", "loads", "lower the speed, or give it a stronger spring"
        )
    lifts = sorted({*(theta % TURN for theta, sign in sign_changes(contact, program) if sign < 0.0), *flyer.drops()})
    result: list[Flight] = []
    flight_of_lift: dict[int, int] = {}  # index of a lift-off from rest -> index of its flight
    if not lifts:
        return Flights((), True)
    theta, speed, resting, end, fastest_landing = lifts[0], None, True, lifts[0] + TURN * turns, 0.0
    while theta < end and len(result) < MOST_FLIGHTS:
        if resting:
            key = min(range(len(lifts)), key=lambda i: abs(_difference(lifts[i], theta)))
            if abs(_difference(lifts[key], theta)) < SAME:
                if key in flight_of_lift:
                    first = flight_of_lift[key]
                    return Flights(tuple(result), True, first, max(1, round((theta - result[first].lift) / TURN)))
                flight_of_lift[key] = len(result)
        flight, slope = flyer.fly(theta, speed, end + TURN)
        if flight is None:  # it does not leave the cam
            flight_of_lift = {key: number for key, number in flight_of_lift.items() if number < len(result)}
            theta, speed, resting = _next_lift(lifts, theta), None, True
            continue
        result.append(flight)
        if not math.isfinite(flight.land):
            break
        theta, fastest_landing = flight.land, max(fastest_landing, flight.speed)
        rebound = restitution * flight.speed
        resting = rebound <= AT_REST * fastest_landing
        speed = None if resting else slope + away * rebound / omega
        if resting and float(contact(program.angles(np.array([theta % TURN])))[0]) >= 0.0:
            theta = _next_lift(lifts, theta)
    return Flights(tuple(result), not result)


def _difference(first: float, second: float) -> float:
    return (first - second + math.pi) % TURN - math.pi


def _next_lift(lifts: list[float], theta: float) -> float:
    """The first angle of lift-off after an angle."""
    return min(theta + (lift - theta) % TURN if (lift - theta) % TURN > SAME else theta + TURN for lift in lifts)


class _Flyer:
    """Flights of one follower over one motion."""

    def __init__(self, mechanism: Mechanism, loading: Loading, program: Any, omega: float, away: float) -> None:
        self._mechanism, self._loading, self._program = mechanism, loading, program
        self._omega, self._away = omega, away
        state = program.state(program.angles(np.linspace(0.0, TURN, 721))).displacement
        y, slope = state[0], state[1]
        self._low, self._high = float(y.min()), float(y.max())
        self._stroke = self._high - self._low or 1e-3
        self._fade = FADE * omega * (float(np.abs(slope).max()) or self._stroke)
        window = loading.contact_window
        self._seat = -math.inf if window is None else window.low  # motion at which a valve with lash is on its seat
        self._free = self._free_follower(MARGIN)

    def _free_follower(self, margin: float) -> FreeFollower:
        beyond, small = margin * self._stroke, 1e-3 * self._stroke
        low, high = (small, beyond) if self._away > 0.0 else (beyond, small)
        return FreeFollower(self._mechanism, self._loading, self._low - low, self._high + high, self._fade)

    def drops(self) -> list[float]:
        """Angles [rad] at which the velocity jumps towards the cam, so that the follower leaves it."""
        return [j.theta % TURN for j in self._program.joins if j.jumps[1] and self._away * j.jump[1] < 0.0]

    def motion(self, theta: np.ndarray, order: int = 0) -> np.ndarray:
        """Motion s, or that of a valve on its seat where the cam is below, or its derivative at increasing cam angles.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
        order : int

        Returns
        -------
        ndarray (n,) [m or rad]
        """
        return self._motion(self._program.angles(np.mod(theta, TURN)), order)

    def _motion(self, angles: Angles, order: int) -> np.ndarray:
        displacement = self._program.state(angles).displacement
        return np.where(displacement[0] < self._seat, 0.0 if order else self._seat, displacement[order])

    def _before(self, theta: float) -> tuple[float, float]:
        """Motion s and slope s' at an angle, from its left."""
        angle = theta % TURN or TURN
        piece = max(int(np.searchsorted(self._program.starts, angle - SAME, side="right")) - 1, 0)
        angles = Angles(np.array([angle]), np.array([piece]))
        return float(self._motion(angles, 0)[0]), float(self._motion(angles, 1)[0])

    def fly(self, theta: float, speed: float | None, end: float) -> tuple[Flight | None, float]:
        """Flight from an angle with the slope dy/dθ (None: that of the cam), and s' at its landing.

        The flight is None where the follower does not leave the cam. Raises NoSolution where it exceeds the range of
        the mechanism.
        """
        margin = MARGIN
        while True:
            try:
                return self._fly(theta, speed, end)
            except _OutOfRangeError:
                margin *= 4.0
                degrees = math.degrees(theta % TURN)
                try:
                    self._free = self._free_follower(margin)
                except NoSolution:
                    margin = math.inf
                if margin > LARGEST_MARGIN:
                    hint = "lower the speed, or give it a stronger spring"
                    raise NoSolution(
                        "the follower flies beyond the range of its mechanism", "loads", hint, [(degrees, degrees)]
                    ) from None

    def _fly(self, theta: float, speed: float | None, end: float) -> tuple[Flight | None, float]:
        from scipy.integrate import DOP853
        from scipy.optimize import brentq, minimize_scalar

        def derivative(angle: float, y: np.ndarray) -> tuple[float, float]:
            return y[1], self._free.acceleration(angle, float(y[0]), float(y[1]) * self._omega) / self._omega**2

        y0, slope = self._before(theta)
        start = np.array([y0, slope if speed is None else speed])
        tolerance = ATOL * self._stroke
        solver = DOP853(derivative, theta, start, end, max_step=STEP, rtol=RTOL, atol=tolerance)
        path_theta, path_y, has_left = [np.array([theta])], [np.array([y0])], False
        highest, height = theta, 0.0
        while solver.status == "running":
            solver.step()
            if not self._free.is_in_range(float(solver.y[0]), self._away):
                raise _OutOfRangeError
            dense, begin = solver.dense_output(), solver.t_old

            def gap(angle: float, dense: Any = dense) -> float:
                return float(self._away * (dense(angle)[0] - self.motion(np.array([angle]))[0]))

            points = begin + (solver.t - begin) * INSIDE
            gaps = self._away * (dense(points)[0] - self.motion(points))
            peak = int(np.argmax(gaps))
            beyond_gap = np.maximum.accumulate(gaps) > NO_GAP * self._stroke
            landed = np.flatnonzero((gaps <= 0.0) & (beyond_gap | has_left))
            landing = int(landed[0]) if landed.size else None
            if not has_left and not beyond_gap[-1] and gaps[-1] < 0.0:
                return None, 0.0
            if gaps[peak] > height and (landing is None or peak < landing):
                low, high = (points[peak - 1] if peak else begin), points[min(peak + 1, points.size - 1)]
                minimum = minimize_scalar(
                    lambda angle, gap=gap: -gap(angle), bounds=(low, high), options={"xatol": 1e-9}
                )
                highest, height = float(minimum.x), max(-float(minimum.fun), float(gaps[peak]))
            has_left = has_left or bool(gaps[peak] > NO_GAP * self._stroke)
            land = solver.t
            if landing is not None:
                land = float(brentq(gap, points[landing - 1] if landing else begin, points[landing]))
            angles = np.linspace(begin, land, PATH + 1)[1:]
            path_theta.append(angles)
            path_y.append(dense(angles)[0])
            if landing is not None:
                slope = float(self.motion(np.array([land]), 1)[0])
                impact = max(-self._away * (float(dense(land)[1]) - slope) * self._omega, 0.0)
                flight = Flight(
                    theta, land, height, highest, impact, np.concatenate(path_theta), np.concatenate(path_y)
                )
                return flight, slope
        return Flight(theta, math.inf, height, highest, 0.0, np.concatenate(path_theta), np.concatenate(path_y)), 0.0


class _OutOfRangeError(Exception):
    """The follower has left the range of the polynomials."""


# -- impacts of a follower between the two flanks of a groove or a conjugate pair -------------------------------


PANEL_NODES = 12  # of a panel, on which motion and levers are polynomials
ORDERS = np.arange(PANEL_NODES)
PANEL = math.radians(2.0)
PLAY_STEP = math.radians(1.0)  # of the integration
TIME_FRACTION = 0.2  # of the time constant of the free follower: largest step
ANGLE_TOLERANCE = 1e-11  # [rad] of the landing
LONGEST = 0.125 * TURN  # of a flight: the impact of a longer one is negligible
NEAR, FAR = 1e-5, 0.2  # [rad] first step and range of the search for the loss of contact
BEYOND, PLAYS = 0.02, 20.0  # of the stroke, of the play: range of the polynomials beyond the motion


def with_impacts(
    changes: Sequence[FlankChange],
    at: ForcesAt,
    mechanism: Mechanism,
    loading: Loading,
    program: CompiledMotion,
    omega: float,
    play: float,
) -> tuple[FlankChange, ...]:
    """The changes of flank with the speed of the impact along the normal [m/s].

    The roller on the first flank follows the motion s(θ), on the second one s + play/g₂; g is the gap that a flank
    opens per unit of motion, -g₂ its closing. From the angle at which the flank that it leaves would have to pull it
    the follower flies by M y'' + ... = 0, until the gap g(θ)(y - s) at the second flank has closed. The square of the
    play relative to the radius of curvature is neglected. The speed is None where the follower returns to the flank
    that it left, or friction stops it in the play.
    """
    if not changes or not play > 0.0:
        return tuple(changes)
    motion = program.state(program.angles(np.linspace(0.0, TURN, 721))).displacement
    y, slope = np.asarray(motion[0]), np.asarray(motion[1])
    margin = max(BEYOND * float(np.ptp(y)), PLAYS * play)
    try:
        free = FreeFollower(
            mechanism, loading, y.min() - margin, y.max() + margin, FADE * omega * float(np.abs(slope).max()) or 1.0
        )
        crossing = _Crossing(_Flanks(at, program, mechanism.driver_sign), free, play, omega)
        return tuple(replace(change, impact=crossing.impact(change.theta, change.to)) for change in changes)
    except NoSolution:  # the flight leaves the range of the mechanism, or friction jams
        return tuple(changes)


class _Row(NamedTuple):
    """Motion s and the gaps g of the two flanks per unit of motion at an angle: value and two derivatives."""

    motion: np.ndarray
    opening: tuple[np.ndarray, np.ndarray]


class _Flanks:
    """Motion and gaps by the cam angle, which increases over the turns: polynomials on panels, fitted on demand."""

    def __init__(self, at: ForcesAt, program: CompiledMotion, sign: float) -> None:
        self._at, self._program, self._sign = at, program, sign
        self._panels: dict[tuple[int, int], np.ndarray] = {}

    def bounds(self, theta: float) -> tuple[float, float]:
        """Begin and end of the piece of the motion that contains an angle."""
        turns = math.floor(theta / TURN) * TURN
        piece = self._piece(theta)
        return turns + float(self._program.starts[piece]), turns + float(self._program.ends[piece])

    def _piece(self, theta: float) -> int:
        return max(int(np.searchsorted(self._program.starts, theta % TURN, side="right")) - 1, 0)

    def row(self, theta: float) -> _Row:
        piece, local = self._piece(theta), theta % TURN
        start, end = float(self._program.starts[piece]), float(self._program.ends[piece])
        count = max(1, math.ceil((end - start) / PANEL))
        half = 0.5 * (end - start) / count
        number = min(int((local - start) / (2.0 * half)), count - 1)
        middle = start + (2 * number + 1) * half
        if (piece, number) not in self._panels:
            self._panels[piece, number] = self._fit(piece, middle, half)
        x = min(max((local - middle) / half, -1.0), 1.0)
        motion, first, second = (np.cos(ORDERS * math.acos(x)) @ self._panels[piece, number]).reshape(3, 3).T
        return _Row(motion, (first, second))

    def _fit(self, piece: int, middle: float, half: float) -> np.ndarray:
        """Chebyshev coefficients (NODES, 9) of motion and gaps, of their first and of their second derivatives."""
        x = chebyshev.chebpts1(PANEL_NODES)
        angles = Angles(middle + half * x, np.full(PANEL_NODES, piece))
        _, forces = self._at(angles)
        gaps = [-self._sign * contact.lever for contact in forces.contacts]
        values = np.array([np.asarray(self._program.state(angles).displacement[0]), *gaps])
        coefficients = np.zeros((3, PANEL_NODES, 3))
        coefficients[0] = np.linalg.solve(chebyshev.chebvander(x, PANEL_NODES - 1), values.T)
        for order in (1, 2):
            coefficients[order, :-order] = chebyshev.chebder(coefficients[0], order, 1.0 / half)
        return np.concatenate(list(coefficients), axis=1)


class _Crossing:
    """Flight of a follower across the play."""

    def __init__(self, flanks: _Flanks, free: FreeFollower, play: float, omega: float) -> None:
        self._flanks, self._free, self._omega = flanks, free, omega
        self._clearances = (0.0, play)  # at each flank where the motion is s itself

    def impact(self, theta: float, to: int) -> float | None:
        """Impact speed at the flank ``to`` of a follower that leaves the opposite flank near this angle, or None."""
        begin = self._angle_of_loss(theta, 1 - to)
        if begin is None:
            return None
        place, slope, _ = self._guided(begin, 1 - to)
        theta, state = begin, np.array([place, slope])
        step = self._longest_step(theta, place, slope)

        def gap_after(width: float) -> float:
            return self._gap(theta + width, self._step(theta, state, width), to)[0]

        from scipy.optimize import brentq

        while theta < begin + LONGEST:
            after = self._step(theta, state, step)
            gap = self._gap(theta + step, after, to)[0]
            if gap <= 0.0:
                step = float(brentq(gap_after, 0.0, step, xtol=ANGLE_TOLERANCE))
                return max(-self._gap(theta + step, self._step(theta, state, step), to)[1] * self._omega, 0.0)
            if self._gap(theta + step, after, 1 - to)[0] <= 0.0:
                return None
            theta, state = theta + step, after
        return None

    def _longest_step(self, theta: float, y: float, slope: float) -> float:
        """Largest step that resolves springs and dampers."""
        clearance, change = self._clearances[1] / abs(self._flanks.row(theta).opening[1][0]), 1e-3 * abs(slope) or 1.0
        stiffness = (
            self._acceleration(theta, y + clearance, slope) - self._acceleration(theta, y - clearance, slope)
        ) / (2.0 * clearance)
        damping = (self._acceleration(theta, y, slope + change) - self._acceleration(theta, y, slope - change)) / (
            2.0 * change
        )
        return min(PLAY_STEP, TIME_FRACTION / max(math.sqrt(abs(stiffness)), abs(damping), TIME_FRACTION))

    def _step(self, theta: float, state: np.ndarray, step: float) -> np.ndarray:
        """State y, dy/dθ after a step, by the Runge-Kutta method of order 4."""

        def rate(angle: float, y: np.ndarray) -> np.ndarray:
            return np.array([y[1], self._acceleration(angle, float(y[0]), float(y[1]))])

        k1 = rate(theta, state)
        k2 = rate(theta + 0.5 * step, state + 0.5 * step * k1)
        k3 = rate(theta + 0.5 * step, state + 0.5 * step * k2)
        k4 = rate(theta + step, state + step * k3)
        return np.asarray(state + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4))

    def _acceleration(self, theta: float, y: float, slope: float) -> float:
        """Second derivative y'' of the free follower by cam angle."""
        return self._free.acceleration(theta, y, slope * self._omega) / self._omega**2

    def _gap(self, theta: float, state: np.ndarray, flank: int) -> tuple[float, float]:
        """Gap between follower and flank [m], and its derivative by cam angle."""
        motion, opening = self._flanks.row(theta)
        gain, offset, slope = opening[flank], state[0] - motion[0], state[1] - motion[1]
        return float(self._clearances[flank] + gain[0] * offset), float(gain[0] * slope + gain[1] * offset)

    def _guided(self, theta: float, flank: int) -> tuple[float, float, float]:
        """Motion y of the follower on a flank, and its two derivatives by cam angle."""
        motion, opening = self._flanks.row(theta)
        gain, clearance = opening[flank], self._clearances[flank]
        offset = np.array(
            [-1.0 / gain[0], gain[1] / gain[0] ** 2, gain[2] / gain[0] ** 2 - 2.0 * gain[1] ** 2 / gain[0] ** 3]
        )
        y, slope, second = motion + clearance * offset
        return float(y), float(slope), float(second)

    def _angle_of_loss(self, theta: float, flank: int) -> float | None:
        """Angle at which a flank would have to pull the follower; the given one for the first flank, on which y is s.

        Where the acceleration jumps it is the angle of the jump; None where no angle is near.
        """
        if not self._clearances[flank]:
            return theta

        def leaving(angle: float) -> float:
            y, slope, second = self._guided(angle, flank)
            opening = self._flanks.row(angle).opening[flank][0]
            return float(opening * (self._acceleration(angle, y, slope) - second))

        start, _ = self._flanks.bounds(theta)
        value, step = leaving(theta), NEAR
        side = -1.0 if value > 0.0 else 1.0
        while step < FAR:
            neighbour = theta + side * step
            if neighbour < start:
                return theta
            if (leaving(neighbour) > 0.0) != (value > 0.0):
                from scipy.optimize import brentq

                return float(brentq(leaving, theta, neighbour))
            step *= 2.0
        return None
