"""Speed of a camshaft with a flywheel: the periodic solution of the nonlinear equation of motion.

E = ½(I + J_e(θ))ω², dE/dθ = T_m(ω) - T_s(θ), with the motor's T_m = T̄ + k(ω̄ - ω) and the static torque T_s of the
load. The torque at constant speed is T_c = T_s + ½ω̄² J_e', so that the energy above that of the mean speed,
e = E - ½(I + J_e)ω̄², obeys

    e' = k(ω̄ - ω) - (T_c - T̄),    ω = √(ω̄² + 2e/(I + J_e)),

which loses no digit where the speed hardly changes. Where a turn is too short for the motor to follow, e = U + f with
the energy U of the load alone, U' = -(T_c - T̄), and f' = k(ω̄ - ω), so that next to a torque of any size no digit of
the motor's is lost. T_c, and so the friction μ|N| in T_s, are those of the mean speed: the change of |N| with the speed
is neglected. Where J_e jumps, which it does only with the motion's velocity, the impulse is neglected in e as in T_c.

The right-hand side decreases with e and is convex in it: there is at most one periodic solution with ω > 0. Where there
is none the machine stalls.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from core.frozen import frozen
from core.motion import TURN
from core.shaft.curve import (
    LoadCurve,
    TurnExtremes,
    by_blocks,
    by_panel,
    first_panels,
    locate,
    locate_in_turns,
    panels_of,
    polyval,
    powers,
    ratio_extremes,
    to_powers,
)

NODES = 10  # of a panel, Radau's: the last one is the panel's end, so that a fast decay stays a decay
ROUNDING = 1e-12  # of the largest torque: tolerance of the mean
STANDSTILL = 1e-6  # of ω²/ω̄²: below a thousandth of the mean speed the shaft counts as standing still
CLOSE = 1e-7  # of the mean speed: Newton's steps double their digits, so that the next one is rounding
RESOLVED = 1e-11  # of the motor's torque: largest last coefficients of a resolved panel
STEEP = 1.0  # decay over a panel, as an exponent, from which on its linear system is solved
ITERATIONS, ROUNDS = 60, 12
MOST_PANELS = 6  # times those of the load
FINEST_HALVING = 40


@frozen(eq=False)
class SpeedCurve:
    """Speed over one turn.

    Attributes
    ----------
    start, width : ndarray (m,) [rad]
        Of the panels, those of the load or parts of them.
    energy : ndarray (NODES + 1, m) [J]
        Coefficients of r**k, r = (θ - start)/width, of the energy e above that of the mean speed.
    bodies : ndarray (NODES, m) [kg m²]
        Coefficients of J_e.
    flywheel : float
        Inertia I [kg m²].
    mean : float
        Mean speed ω̄ [rad/s].
    """

    start: np.ndarray
    width: np.ndarray
    energy: np.ndarray
    bodies: np.ndarray
    flywheel: float
    mean: float

    def deviation(self, theta: np.ndarray) -> np.ndarray:
        """Deviation ω - ω̄ from the mean speed.

        Parameters
        ----------
        theta : ndarray (n,) [rad]

        Returns
        -------
        ndarray (n,) [rad/s]
        """
        return by_blocks(self._deviation, theta)

    def _deviation(self, theta: np.ndarray) -> np.ndarray:
        panel, r = locate(self.start, self.width, theta)
        r = powers(r, NODES + 1)
        energy = (self.energy[:, panel] * r).sum(axis=0)
        bodies = (self.bodies[:, panel] * r[:-1]).sum(axis=0)
        deviation, _ = _above_mean(energy, self.flywheel + np.maximum(bodies, 0.0), self.mean)
        return deviation


def deviation_extremes(speeds: Sequence[SpeedCurve]) -> TurnExtremes:
    """Extremes of the deviation ω - ω̄, by the polynomials of the panels.

    Parameters
    ----------
    speeds : sequence of SpeedCurve
        m speeds, at least one.

    Returns
    -------
    TurnExtremes
    """
    turn, start, width, energy, inertia = panels_of(speeds, "energy", "bodies")
    inertia[0] += np.array([speed.flywheel for speed in speeds])[turn]
    return _extremes(turn, start, width, energy, inertia, np.array([speed.mean for speed in speeds]))


def deviation_range(speed: SpeedCurve) -> tuple[float, float]:
    """Least and greatest ω - ω̄ over the turn [rad/s]."""
    extremes = deviation_extremes([speed])
    return float(extremes.low[0]), float(extremes.high[0])


def speed_fluctuation(speed: SpeedCurve) -> float:
    """Fluctuation (ω_max - ω_min)/ω̄ over the turn."""
    low, high = deviation_range(speed)
    return (high - low) / speed.mean


def _extremes(
    turn: np.ndarray, start: np.ndarray, width: np.ndarray, energy: np.ndarray, inertia: np.ndarray, mean: np.ndarray
) -> TurnExtremes:
    """Extremes of the deviation over every turn with mean speed ``mean`` (m,): those of e/(I + J_e) on its panels (n,)."""
    ratio = ratio_extremes(turn, start, width, energy, inertia)
    one = np.ones(mean.size)
    low, high = (_above_mean(value, one, mean)[0] for value in (ratio.low, ratio.high))
    return TurnExtremes(low, high, ratio.low_at, ratio.high_at)


@frozen(eq=False)
class _Panels:
    """Parts of the panels of several loads, turn after turn, with the loads at their nodes.

    Attributes
    ----------
    turn : (m,) number of the turn
    parent, low, share : (m,) panel of the loads, begin of the part in it, and its fraction of it, 0...1
    width : (m,) [rad]
    torque, bodies : (NODES, m) T_c - T̄ [N m] less U', and J_e [kg m²]
    load_energy : (NODES, m) U at the nodes [J]
    power : (NODES + 1, m) coefficients of the powers of U
    motor_energy, slope : (NODES, m) f [J] and its slope f' [N m] at the nodes
    begin : (m,) f at the begin [J]
    """

    turn: np.ndarray
    parent: np.ndarray
    low: np.ndarray
    share: np.ndarray
    width: np.ndarray
    torque: np.ndarray
    bodies: np.ndarray
    load_energy: np.ndarray
    power: np.ndarray
    motor_energy: np.ndarray
    slope: np.ndarray
    begin: np.ndarray

    def at(self, which: np.ndarray) -> _Panels:
        """Some of the panels, by numbers or a mask."""
        numbers = which.nonzero()[0] if which.dtype == bool else which
        return _Panels(*(row.take(numbers, axis=-1) for row in vars(self).values()))

    def of(self, turns: np.ndarray) -> _Panels:
        """Panels of some turns, given by their mask."""
        return self if turns.all() else self.at(turns[self.turn])

    @classmethod
    def joined(cls, parts: Sequence[_Panels]) -> _Panels:
        """Panels of several turns, in the order of the turns."""
        rows = zip(*(vars(part).values() for part in parts if part.turn.size), strict=True)
        # by_panel rounds differently in another order of memory
        joined = cls(*(np.ascontiguousarray(np.concatenate(row, axis=-1)) for row in rows))
        return (
            joined.at(np.argsort(joined.turn, kind="stable")) if (joined.turn[1:] < joined.turn[:-1]).any() else joined
        )

    def put(self, which: np.ndarray, panels: _Panels) -> None:
        """Overwrite the solution of some panels, given by their numbers."""
        for name in ("motor_energy", "slope", "begin"):
            getattr(self, name)[..., which] = getattr(panels, name)

    def firsts(self) -> tuple[np.ndarray, np.ndarray]:
        """First panel of every turn, and the number of the turn."""
        first = first_panels(self.turn)
        return first, self.turn[first]

    def motor_power(self) -> np.ndarray:
        """Coefficients (NODES + 1, m) of the powers of f."""
        _, _, _, integral = collocation()
        power = self.width * by_panel(integral, self.slope)
        power[0] += self.begin
        return power

    def energy_power(self) -> np.ndarray:
        """Coefficients (NODES + 1, m) of the powers of e."""
        return self.power + self.motor_power()

    def bodies_power(self) -> np.ndarray:
        """Coefficients (NODES, m) of the powers of J_e."""
        _, _, to_chebyshev, _ = collocation()
        return by_panel(to_powers(NODES) @ to_chebyshev, self.bodies)


@lru_cache(maxsize=1)
def collocation() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Radau's nodes of 0...1, the last of them 1, and matrices on values at them (NODES,).

    Returns
    -------
    nodes : ndarray (NODES,), dimensionless
    integrals : ndarray (NODES, NODES), dimensionless
        To integrals from 0 to each node.
    to_chebyshev : ndarray (NODES, NODES), dimensionless
        To Chebyshev coefficients.
    integral : ndarray (NODES + 1, NODES), dimensionless
        To power coefficients of the integral.
    """
    x = _radau(NODES)
    chebyshev = np.cos(np.arccos(x)[:, None] * np.arange(NODES + 1))
    to_chebyshev = np.linalg.inv(chebyshev[:, :-1])
    integral = 0.5 * _integrals(NODES) @ to_chebyshev
    return 0.5 + 0.5 * x, chebyshev @ integral, to_chebyshev, to_powers(NODES + 1) @ integral


def _radau(count: int) -> np.ndarray:
    """Radau's nodes (count,) of -1 ... 1, the last of them 1.

    The others are zeros of the orthogonal polynomials of the weight 1 - x: eigenvalues of the matrix of their
    recurrence.
    """
    k = np.arange(count - 1.0)
    matrix = np.diag(-1.0 / ((2.0 * k + 1.0) * (2.0 * k + 3.0)))
    matrix += np.diag(np.sqrt(k * (k + 1.0))[1:] / (2.0 * k + 1.0)[1:], -1)
    return np.append(np.linalg.eigvalsh(matrix), 1.0)


def _integrals(count: int) -> np.ndarray:
    """Chebyshev coefficients (count + 1, count) of the integrals from -1 of T_0 ... T_(count - 1)."""
    k = np.arange(1.0, count + 1.0)
    matrix = np.zeros((count + 1, count))
    matrix[1:] = np.diag(0.5 / k)
    matrix[1, 0] = 1.0
    matrix[1:-2, 2:] -= np.diag(0.5 / k[:-2])
    matrix[0] = -((-1.0) ** k) @ matrix[1:]
    return matrix


def _above_mean(energy: np.ndarray, inertia: np.ndarray, mean: Any) -> tuple[np.ndarray, np.ndarray]:
    """ω - ω̄ and its derivative by e.

    From ``STANDSTILL`` down it continues as a straight line, so that a solution always exists and stays convex; the
    machine runs if the solution is above.
    """
    change = 2.0 * (energy / mean / mean) / inertia  # (ω/ω̄)² - 1
    rise = np.maximum(change, STANDSTILL - 1.0)
    root = np.sqrt(1.0 + rise)
    return mean * (rise / (1.0 + root) + 0.5 * (change - rise) / root), 1.0 / (inertia * mean * root)


def steady_speed(load: LoadCurve, flywheel: float, slope: float, mean: float) -> SpeedCurve | None:
    """Speed that repeats each turn, with a flywheel and a motor of linear characteristic; None where the motor stalls.

    load: torque and inertia; flywheel: I [kg m²], positive; slope: k, increase of the motor's torque per decrease of
    the speed [N m s/rad]; mean: ω̄ [rad/s].
    """
    turns = SteadyTurns([load], np.array([slope]), np.array([mean]))
    return turns.speed(0) if turns.solve(np.array([flywheel]))[0] else None


class SteadyTurns:
    """Speeds of m shafts that repeat each turn, with flywheels and motors of linear characteristic.

    Collocation at Radau's nodes of each panel, the panels of all shafts at once; Newton's method on the equation itself
    (each step a linear one, closed over the turn). As the equation is convex, the steps rise to the solution from the
    second one on, from any start: the last solution, or that of a motor without influence. Panels whose last
    coefficients are significant are divided, and the solution is the first guess on the new ones. The speed of a shaft
    does not depend on the others.
    """

    def __init__(self, loads: Sequence[LoadCurve], slope: np.ndarray, mean: np.ndarray) -> None:
        """Set up the shafts.

        Parameters
        ----------
        loads : sequence of LoadCurve
            m loads, at least one.
        slope : ndarray (m,) [N m s/rad]
            Slopes k of the motors, increase of the torque per decrease of the speed.
        mean : ndarray (m,) [rad/s]
            Mean speeds ω̄.
        """
        self.slope, self.mean = slope, mean
        self.flywheel = np.zeros(len(loads))
        panels = panels_of(loads, "torque", "inertia")
        self._load_turn, self._start, self._width, self._torque, self._inertia = panels
        self._counts = np.bincount(self._load_turn)
        self._mean_torque = np.array([load.mean for load in loads])
        self._is_split = np.zeros(len(loads), dtype=bool)  # turns whose U is the energy of the torque about its mean
        none = np.zeros((NODES, 0))
        empty, numbers = none[0], np.zeros(0, dtype=int)
        power = np.zeros((NODES + 1, 0))
        self._panels = _Panels(numbers, numbers, empty, empty, empty, none, none, none, power, none, none, empty)

    @np.errstate(over="ignore", invalid="ignore", divide="ignore")  # with a flywheel of nearly 0
    def solve(self, flywheel: np.ndarray, turns: np.ndarray | None = None) -> np.ndarray:
        """Solve the equation for given flywheels.

        Parameters
        ----------
        flywheel : ndarray (m,) [kg m²]
            Inertias I, positive.
        turns : ndarray (m,) or None, dimensionless
            Mask of the shafts to solve; the others keep their last solution. None: all.

        Returns
        -------
        ndarray (m,), dimensionless
            Mask of the shafts that are solved, and run; in the others of these the motor stalls.
        """
        solved = np.ones(self.mean.size, dtype=bool) if turns is None else turns
        self.flywheel = np.where(solved, flywheel, self.flywheel)
        is_split = np.where(solved, self.slope * TURN < self.flywheel * self.mean, self._is_split)
        begins = solved & ((is_split != self._is_split) | (self._panels.turn.size == 0))
        self._is_split = is_split
        if begins.any():
            parent = np.flatnonzero(begins[self._load_turn])
            self._replace(begins, self._begin(self._panels_of(parent, np.zeros(parent.size), np.ones(parent.size))))
        runs, active = solved.copy(), solved
        for attempt in range(ROUNDS):
            self._newton(active)
            panels = self._panels.of(active)
            first, at = panels.firsts()
            inertia, mean = panels.bodies + self.flywheel[panels.turn], self.mean[panels.turn]
            energy = panels.load_energy + panels.motor_energy
            deviation, gain = _above_mean(energy, inertia, mean)
            rough = self._unresolved(panels, self.slope[panels.turn] * deviation)
            # NaN counts as stalled
            runs[at] = (
                np.minimum.reduceat((1.0 + 2.0 * (energy / mean / mean) / inertia).min(axis=0), first) > STANDSTILL
            )
            has_room = np.diff(first, append=rough.size) < MOST_PANELS * self._counts[at]
            refines = np.logical_or.reduceat(rough, first) & has_room
            if attempt:  # stalled on refined panels too
                refines &= runs[at]
            if attempt == ROUNDS - 1 or not refines.any():
                break
            active = np.zeros_like(active)
            active[at[refines]] = True
            which = active[panels.turn]
            rate = self.slope[panels.turn] * gain.max(axis=0)
            self._replace(active, self._divided(panels.at(which), rough[which], rate[which]))
        return runs

    def speed(self, number: int) -> SpeedCurve:
        """Speed of a shaft by its last solution."""
        panels = self._panels.of(np.arange(self.mean.size) == number)
        start, bodies = self._start_of(panels), panels.bodies_power()
        return SpeedCurve(
            start, panels.width, panels.energy_power(), bodies, float(self.flywheel[number]), float(self.mean[number])
        )

    def extremes(self, turns: np.ndarray) -> TurnExtremes:
        """Extremes of the deviation from the mean speed, by the last solution.

        Parameters
        ----------
        turns : ndarray (m,), dimensionless
            Mask of k shafts, at least one.

        Returns
        -------
        TurnExtremes
            Of k shafts.
        """
        panels = self._panels.of(turns)
        start = self._start_of(panels)
        inertia = panels.bodies_power()
        inertia[0] += self.flywheel[panels.turn]
        return _extremes(panels.turn, start, panels.width, panels.energy_power(), inertia, self.mean[turns])

    def deviations(self, turns: np.ndarray, theta: np.ndarray) -> np.ndarray:
        """Deviation ω - ω̄ from the mean speed, by the last solution.

        Parameters
        ----------
        turns : ndarray (m,), dimensionless
            Mask of k shafts.
        theta : ndarray (k, n) [rad]
            Machine angles of every shaft.

        Returns
        -------
        ndarray (k, n) [rad/s]
        """
        panels = self._panels.of(turns)
        number = np.repeat(np.flatnonzero(turns), theta.shape[1])
        panel, r = locate_in_turns(panels.turn, self._start_of(panels), panels.width, number, theta.ravel())
        energy, bodies = (polyval(r, power[:, panel]) for power in (panels.energy_power(), panels.bodies_power()))
        inertia = self.flywheel[number] + np.maximum(bodies, 0.0)
        return _above_mean(energy, inertia, self.mean[number])[0].reshape(theta.shape)

    def _start_of(self, panels: _Panels) -> np.ndarray:
        """Machine angles (n,) [rad] of the begins of panels."""
        return np.asarray(self._start[panels.parent] + panels.low * self._width[panels.parent])

    def _replace(self, turns: np.ndarray, panels: _Panels) -> None:
        """Replace the panels of some turns, given by their mask."""
        self._panels = _Panels.joined([self._panels.of(~turns), panels])

    def _panels_of(self, parent: np.ndarray, low: np.ndarray, share: np.ndarray) -> _Panels:
        """Parts (n,) of the loads' panels, for complete turns; U is 0 where the motor follows within a turn."""
        x, integrals, _, integral = collocation()
        turn, width = self._load_turn[parent], share * self._width[parent]
        r = low + x[:, None] * share
        torque = polyval(r, self._torque[:, None, parent]) - self._mean_torque[turn]
        bodies = np.maximum(polyval(r, self._inertia[:, None, parent]), 0.0)  # no rounding below 0
        none = np.zeros(torque.shape)
        power = np.zeros((NODES + 1, turn.size))
        panels = _Panels(turn, parent, low, share, width, torque, bodies, none, power, none, none, none[0])
        is_split = self._is_split[turn]
        if not is_split.any():
            return panels
        first, at = panels.firsts()
        work = width * by_panel(integrals, torque)
        mean = np.zeros(self.mean.size)
        mean[at] = np.add.reduceat(work[-1], first) / TURN
        work, torque = work - mean[turn] * (width * x[:, None]), torque - mean[turn]
        largest = np.zeros(self.mean.size)
        largest[at] = np.maximum.reduceat(np.abs(torque).max(axis=0), first)
        _, ends = _along_turns(np.zeros(turn.size), work[-1], _shifts(turn))
        begins = work[-1] - ends
        power = -width * by_panel(integral, torque)
        power[0] += begins
        rest = np.where(np.abs(mean) > ROUNDING * largest, mean, 0.0)[turn]
        return replace(
            panels,
            torque=np.where(is_split, rest, panels.torque),
            load_energy=np.where(is_split, begins - work, 0.0),
            power=np.where(is_split, power, 0.0),
        )

    def _begin(self, panels: _Panels) -> _Panels:
        """The panels with a first guess: f constant, so that the mean of e is 0."""
        _, integrals, _, _ = collocation()
        first, at = panels.firsts()
        guess = np.zeros(self.mean.size)
        area = panels.width * by_panel(integrals[-1:], panels.load_energy)[0]
        guess[at] = -np.add.reduceat(area, first) / TURN
        start = guess[panels.turn]
        return replace(panels, motor_energy=np.tile(start, (NODES, 1)), begin=start)

    def _newton(self, active: np.ndarray) -> None:
        """Newton's method for some turns, given by their mask.

        One step: with c = k dω/de and the slope s = f' at the nodes, s + δs = -(T_c - T̄ + U') - k(ω - ω̄) - c δf, which
        is linear; over a panel that begins with δb it gives δf = p δb + d at the nodes, and δb follows from panel to
        panel, closed over the turn. 1 - p at the end is computed from the decay itself, so that no digit is lost where
        hardly anything decays.
        """
        _, integrals, _, _ = collocation()
        which = active[self._panels.turn].nonzero()[0]
        panels = self._panels.of(active)
        shifts = _shifts(panels.turn)
        for _ in range(ITERATIONS):
            turn, f, s, b = panels.turn, panels.motor_energy, panels.slope, panels.begin
            k, mean = self.slope[turn], self.mean[turn]
            deviation, gain = _above_mean(panels.load_energy + f, panels.bodies + self.flywheel[turn], mean)
            rate, target = k * gain, -(k * deviation + panels.torque)
            steep, decay, forced, lost = _responses(panels.width, rate, target - s)
            # f at the end less that at the begin, which next to a large f would lose its digits
            gained = np.where(steep, f[-1] - b, panels.width * by_panel(integrals[-1:], s)[0])
            losses, ends = _along_turns(lost, gained + lost * b + forced[-1], shifts)
            begins = _begins(losses, ends, turn)
            step = decay * (begins - b) + forced
            slope = target - rate * step
            step = np.where(steep, step, begins - b + panels.width * by_panel(integrals, slope - s))
            panels = replace(panels, motor_energy=f + step, slope=slope, begin=begins)
            first, _ = panels.firsts()
            change = np.maximum.reduceat(np.abs(gain * step).max(axis=0), first)
            rests = change <= CLOSE * mean[first]
            if rests.any():
                rests = np.repeat(rests, np.diff(first, append=turn.size))
                self._panels.put(which[rests], panels.at(rests))
                if rests.all():
                    return
                which, panels = which[~rests], panels.at(~rests)
                shifts = _shifts(panels.turn)
        self._panels.put(which, panels)

    def _unresolved(self, panels: _Panels, torque: np.ndarray) -> np.ndarray:
        """Mask (n,) of panels where the last two Chebyshev coefficients of the motor's torque (NODES, n) are significant.

        The torque that a balance cam leaves is rounding relative to the mean, which no panel resolves.
        """
        _, _, to_chebyshev, _ = collocation()
        first, at = panels.firsts()
        largest = np.maximum.reduceat(np.abs(torque).max(axis=0), first) + np.abs(self._mean_torque[at])
        last = np.abs(by_panel(to_chebyshev[-2:], torque)).max(axis=0)
        return np.asarray(last > RESOLVED * np.repeat(largest, np.diff(first, append=last.size)))

    def _divided(self, panels: _Panels, rough: np.ndarray, rate: np.ndarray) -> _Panels:
        """The panels with the rough ones (n,) divided, and f at their nodes from its polynomials on the old ones.

        A rough panel is halved; one with a fast decay is halved towards its start as often as needed, for after a jump
        of the torque the motor follows there. rate: (n,) greatest decay [1/rad].
        """
        x, _, to_chebyshev, _ = collocation()
        depth = np.ceil(np.log2(np.maximum(rate * panels.width, 1.0))).astype(int) + 1
        depth = np.where(rough, np.clip(depth, 1, FINEST_HALVING), 0)
        old = np.repeat(np.arange(depth.size), depth + 1)
        part = np.arange(old.size) - np.repeat(
            np.cumsum(depth + 1) - depth - 1, depth + 1
        )  # 0 at the old panel's start
        share = np.where(part == 0, 0.5 ** depth[old], 0.5 ** (depth[old] - part + 1.0))
        low = np.where(part == 0, 0.0, share)
        divided = self._panels_of(
            panels.parent[old], panels.low[old] + low * panels.share[old], share * panels.share[old]
        )
        energy = panels.motor_power()[:, None, old]
        slope = by_panel(to_powers(NODES) @ to_chebyshev, panels.slope)[:, None, old]
        r = low + x[:, None] * share
        return replace(
            divided, motor_energy=polyval(r, energy), slope=polyval(r, slope), begin=polyval(low, energy[:, 0])
        )


def _responses(width: np.ndarray, rate: np.ndarray, forcing: np.ndarray) -> tuple[np.ndarray, ...]:
    """Solution x = p b + d of x' + c x = g over panels of widths h (n,), from c and g at the nodes (NODES, n).

    Where little decays p = e^(-C) and d = e^(-C) ∫ e^C g with C = ∫ c, on the same nodes; elsewhere the linear system of
    the collocation is solved. Returns the mask of these panels (n,), p, d (NODES, n), and the part 1 - p lost at the end (n,).
    """
    _, integrals, _, _ = collocation()
    steep = ~((rate * width).max(axis=0) <= STEEP)
    exponent = np.where(steep, 0.0, width * by_panel(integrals, rate))
    decay, lost = np.exp(-exponent), -np.expm1(-exponent[-1])
    forced = decay * (width * by_panel(integrals, forcing / decay))
    if steep.any():
        c, g = rate[:, steep].T, forcing[:, steep].T
        scaled = width[steep, None, None] * integrals
        matrix = scaled * c[:, None, :]
        matrix[:, np.arange(NODES), np.arange(NODES)] += 1.0
        sides = np.stack((np.ones_like(g), np.einsum("mij,mj->mi", scaled, g)), axis=2)
        p, d = np.moveaxis(np.linalg.solve(matrix, sides), 2, 0)
        decay[:, steep], forced[:, steep] = p.T, d.T
        lost[steep] = np.einsum("mj,mj->m", scaled[:, -1], c * p)
    return steep, decay, forced, lost


_Shift = tuple[slice | np.ndarray, slice | np.ndarray]


def _shifts(turn: np.ndarray) -> list[_Shift]:
    """Panels with one, two, four, ... panels before them in their turn (n,), and those so far before."""
    first = first_panels(turn)
    number = np.arange(turn.size) - np.repeat(first, np.diff(first, append=turn.size))
    shifts: list[_Shift] = []
    reach = 1
    while reach <= number.max():
        at = (number >= reach).nonzero()[0]
        is_single = first.size == 1  # slices are faster
        shifts.append((slice(reach, None), slice(-reach)) if is_single else (at, at - reach))
        reach *= 2
    return shifts


def _along_turns(lost: np.ndarray, gained: np.ndarray, shifts: Sequence[_Shift]) -> tuple[np.ndarray, np.ndarray]:
    """Loss and gain from the begin of a turn to the end of every panel (n,), from b -> (1 - lost) b + gained of every panel.

    The panels are combined with the one before, then with the two, four, ... before.
    """
    lost, gained = lost.copy(), gained.copy()
    for at, before in shifts:
        loss = lost[at]
        gained[at] += gained[before] - loss * gained[before]
        lost[at] = lost[before] + (1.0 - lost[before]) * loss
    return lost, gained


def _begins(lost: np.ndarray, gained: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Values at the begins of the panels (n,) that repeat each turn, from loss and gain up to their ends."""
    first = first_panels(turn)
    last = np.append(first[1:], turn.size) - 1
    begin = np.repeat(gained[last] / lost[last], last - first + 1)
    begins = np.empty(turn.size)
    begins[1:] = gained[:-1] + (1.0 - lost[:-1]) * begin[1:]
    begins[first] = begin[first]
    return begins
