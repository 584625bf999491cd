"""Flywheel of a shaft: its sizing by energy and by the true speed, and speed and motor torque with a given flywheel.

Source: Shin, Kim and Ha 1995, Figs. 19 and 20, for the linear response of flywheel and motor.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from math import log, pi

import numpy as np

from core.design import Shaft, si
from core.errors import NoSolution
from core.findings import ERROR, NOTE, Finding
from core.frozen import frozen
from core.motion import TURN, Angles
from core.number_text import rounded_up
from core.numerics.derivatives import distinct
from core.numerics.lazy import checkpoint
from core.shaft.curve import NODES, LoadCurve, by_blocks, locate, peaks, polyval, powers, rms
from core.shaft.speed import SpeedCurve, SteadyTurns, deviation_range, speed_fluctuation, steady_speed

# -- linear response of flywheel and motor, for small changes of speed ------------------------------------------


SWITCH = 4.0  # z at which the recurrence of ``phi`` changes its direction


def motor_inertia(shaft: Shaft) -> float:
    """Inertia of the motor reduced to the camshaft, I_m times the gear ratio squared [kg m²]."""
    s = si(shaft)
    ratio = 1.0 if s.gear_ratio is None else s.gear_ratio
    inertia: float = (s.motor_inertia or 0.0) * ratio * ratio  # with many designs a column
    return inertia


def lag(shaft: Shaft) -> float:
    """Rate k/(I ω̄) [1/rad] at which the motor follows the torque, I of flywheel and motor; infinite for I = 0."""
    s = si(shaft)
    momentum = (s.flywheel_inertia + motor_inertia(shaft)) * s.speed
    return float(s.motor_slope / momentum) if momentum else np.inf


def has_flywheel(shaft: Shaft) -> bool:
    """Whether flywheel or motor has an inertia; without one the speed is constant, and the motor gives T_c."""
    return lag(shaft) < np.inf


def phi(z: np.ndarray) -> np.ndarray:
    """Functions k! φ_{k+1}(-z) = ∫_0^1 e^{-z(1-s)} s^k ds for k = 0 ... NODES-1.

    They satisfy the recurrence z I_k = 1 - k I_{k-1}: downwards it multiplies errors by z/k, upwards by k/z. Either
    direction loses at most fifteen roundings on its side of z = 4; 22 steps above NODES - 1 reduce the error of the
    first guess, (z/k)², to nothing.

    Parameters
    ----------
    z : ndarray (n,), dimensionless
        Not negative.

    Returns
    -------
    ndarray (NODES, n), dimensionless
    """
    small, large = np.minimum(z, SWITCH), np.maximum(z, SWITCH)
    down, up = np.empty((NODES, z.size)), np.empty((NODES, z.size))
    first = NODES + 21
    value = (1.0 - small / (first + 2.0)) / (first + 1.0)
    for k in range(first, 0, -1):
        value = (1.0 - small * value) / k
        if k <= NODES:
            down[k - 1] = value
    up[0] = -np.expm1(-large) / large
    for k in range(1, NODES):
        up[k] = (1.0 - k * up[k - 1]) / large
    return np.where(z <= SWITCH, down, up)


def periodic_response(curve: LoadCurve, rate: float) -> Callable[[np.ndarray], np.ndarray]:
    """The periodic solution of x' + rate x = T - T̄, or ∫(T - T̄)dθ from 0 where the rate is 0.

    Panel by panel: x(θ+h) = e^{-rate h} x(θ) + h ∫ e^{-rate h (1-s)} (T - T̄)(s) ds, exact for polynomials.

    Parameters
    ----------
    curve : LoadCurve
    rate : float
        [1/rad].

    Returns
    -------
    function ndarray (n,) [rad] -> ndarray (n,) [N m rad]
    """
    power = curve.torque.copy()
    power[0] -= curve.mean
    decay = np.exp(-rate * curve.width)
    gain = curve.width * (power * phi(rate * curve.width)).sum(axis=0)
    end, starts = 0.0, []
    for factor, increment in zip(decay.tolist(), gain.tolist(), strict=True):
        starts.append(end)
        end = factor * end + increment
    begins = np.array(starts)
    if rate > 0.0:
        begins += end / -np.expm1(-rate * TURN) * np.exp(-rate * curve.start)

    def solution(theta: np.ndarray) -> np.ndarray:
        return by_blocks(block, theta)

    def block(theta: np.ndarray) -> np.ndarray:
        panel, r = locate(curve.start, curve.width, theta)
        h = theta - curve.start[panel]
        terms = power[:, panel] * powers(r)
        return np.exp(-rate * h) * begins[panel] + h * (terms * phi(rate * h)).sum(axis=0)

    return solution


# -- energy W = ∫(T - T̄)dθ of a shaft's torque ------------------------------------------------------------------


def torque_deviation(curve: LoadCurve) -> np.ndarray:
    """Deviation of the torque from its mean, T - T̄, as coefficients of r**k on the panels.

    Parameters
    ----------
    curve : LoadCurve
        With m panels.

    Returns
    -------
    ndarray (NODES, m) [N m]
    """
    power = curve.torque.copy()
    power[0] -= curve.mean
    return power


def sign_changes(power: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sign changes of polynomials of r = 0 ... 1, to the square of the sampling error.

    Parameters
    ----------
    power : ndarray (k, m) [any unit]
        Coefficients of r**k.

    Returns
    -------
    panel, r : ndarray (n,), dimensionless
    """
    r = np.linspace(0.0, 1.0, 4 * NODES + 1)
    near = np.flatnonzero(np.abs(power[0]) <= np.abs(power[1:]).sum(axis=0))  # the others have one sign
    values = polyval(r, power[:, near, None])  # (m, points)
    panel, cell = np.nonzero(values[:, :-1] * values[:, 1:] < 0.0)
    before, after = values[panel, cell], values[panel, cell + 1]
    panel = near[panel]
    # two steps suffice: the integral has an extreme there, so its error is of second order in the root's
    root = r[cell] + (r[cell + 1] - r[cell]) * before / (before - after)
    slope = polyval(root, np.arange(1, power.shape[0])[:, None] * power[1:, panel])
    residual = polyval(root, power[:, panel])
    return panel, np.clip(root - residual / np.where(slope == 0.0, np.inf, slope), r[cell], r[cell + 1])


def turning_points(curve: LoadCurve) -> np.ndarray:
    """Machine angles among which W has its extremes: starts of panels, and roots of T - T̄ inside them.

    Parameters
    ----------
    curve : LoadCurve

    Returns
    -------
    ndarray (n,) [rad]
    """
    panel, root = sign_changes(torque_deviation(curve))
    return np.concatenate((curve.start, curve.start[panel] + root * curve.width[panel]))


def energy_range(curve: LoadCurve) -> tuple[float, float]:
    """The least and the greatest W [J]."""
    low, high = energy_ranges([curve])
    return float(low[0]), float(high[0])


def energy_ranges(curves: Sequence[LoadCurve]) -> tuple[np.ndarray, np.ndarray]:
    """The least and the greatest W of each of m loads.

    Parameters
    ----------
    curves : sequence of LoadCurve

    Returns
    -------
    low, high : ndarray (m,) [J]
    """
    counts = np.array([curve.width.size for curve in curves])
    power = np.concatenate([curve.torque for curve in curves], axis=1)
    power[0] -= np.repeat([curve.mean for curve in curves], counts)
    width = np.concatenate([curve.width for curve in curves])
    integral = np.concatenate((np.zeros((1, width.size)), power / np.arange(1, NODES + 1)[:, None]))
    ends = width * polyval(np.ones(width.size), integral)
    first, begins = np.cumsum(counts) - counts, np.zeros(width.size)
    for count in distinct(counts).tolist():  # loads with equally many panels at once
        panels = first[counts == count][:, None] + np.arange(count)
        begins[panels[:, 1:]] = np.cumsum(ends[panels[:, :-1]], axis=1)
    panel, root = sign_changes(power)
    inside = begins[panel] + width[panel] * polyval(root, integral[:, panel])
    low, high = np.minimum.reduceat(begins, first), np.maximum.reduceat(begins, first)
    owner = np.repeat(np.arange(counts.size), counts)[panel]
    np.minimum.at(low, owner, inside)
    np.maximum.at(high, owner, inside)
    return low, high


def highest_at(curve: LoadCurve) -> float:
    """Machine angle [rad] of the greatest W, 0 ... 2π, where the shaft is slowest."""
    angles = turning_points(curve)
    return float(angles[int(np.argmax(periodic_response(curve, 0.0)(angles)))] % TURN)


# -- flywheel of a shaft ----------------------------------------------------------------------------------------


TOLERANCE = 1e-4  # of the limit on the fluctuation: a flywheel typed with five digits satisfies it
SEARCH_WIDTH = 1e-4  # relative, at which the search for the least flywheel ends; three digits are shown


@frozen(eq=False)
class Flywheel:
    """Flywheel and motor under the load of one turn; each figure is computed when it is read.

    torque: Angles (n,) -> torque of the load at constant speed, T_c (n,) [N m]; load: by the rotation of the shaft;
    rotation_sign: -1 of a crank whose angle decreases as the shaft turns.
    """

    torque: Callable[[Angles], np.ndarray]
    load: LoadCurve
    shaft: Shaft
    rotation_sign: float = 1.0

    def _shaft_angle(self, angles: Angles) -> np.ndarray:
        """Rotation of the shaft (n,) [rad]."""
        return angles.theta if self.rotation_sign > 0.0 else np.mod(-angles.theta, TURN)

    # -- sizing -------------------------------------------------------------------------------------------

    @property
    def mean_torque(self) -> float:
        """Mean torque of a turn, T̄ = W/(2 π) [N m]."""
        return self.load.mean

    @cached_property
    def energy_swing(self) -> float:
        """Swing of energy ΔE = W_M - W_m of W = ∫(T_c - T̄) dθ [J]."""
        low, high = energy_range(self.load)
        return high - low

    @cached_property
    def needed_inertia(self) -> float:
        """Least flywheel whose true speed keeps its limit of fluctuation, I = I_C - I_m [kg m²], I_m of the motor."""
        needed = inertia_for(self.load, self.shaft, si(self.shaft).speed_fluctuation)
        return max(needed - motor_inertia(self.shaft), 0.0)

    @property
    def estimated_inertia(self) -> float:
        """Textbook estimate of the flywheel, I = max(ΔE/(C_s ω̄²) - I_m, 0) [kg m²]."""
        estimate = inertia_by_energy(self.load, self.shaft, si(self.shaft).speed_fluctuation)
        return max(estimate - motor_inertia(self.shaft), 0.0)

    @cached_property
    def least_inertia(self) -> float:
        """Least flywheel [kg m²] without stalling, rounded up to three digits; 0 where the given one does not stall."""
        if self.runs:
            return 0.0
        s, motor = si(self.shaft), motor_inertia(self.shaft)
        low = s.flywheel_inertia + motor
        high = max(2.0 * low, self.energy_swing / s.speed / s.speed)
        while self._speed_with(high) is None:
            low, high = high, 2.0 * high
        while high - low > SEARCH_WIDTH * high:
            middle = (low * high) ** 0.5 if high > 4.0 * low > 0.0 else 0.5 * (low + high)
            low, high = (low, middle) if self._speed_with(middle) else (middle, high)
        return rounded_up(max(high - motor, SEARCH_WIDTH * high), 3)

    # -- with the given flywheel --------------------------------------------------------------------------

    def _speed_with(self, inertia: float) -> SpeedCurve | None:
        s = si(self.shaft)
        return steady_speed(self.load, inertia, s.motor_slope, s.speed)

    @cached_property
    def _steady(self) -> SpeedCurve | None:
        return self._speed_with(si(self.shaft).flywheel_inertia + motor_inertia(self.shaft))

    @cached_property
    def _deviations(self) -> tuple[float, float]:
        """Least and greatest ω - ω̄ [rad/s]."""
        return deviation_range(self._curve) if has_flywheel(self.shaft) else (0.0, 0.0)

    @property
    def fluctuation(self) -> float:
        """Fluctuation of speed, C = (ω_M - ω_m)/ω̄; 0 without a flywheel. Raises NoSolution where the motor stalls."""
        low, high = self._deviations
        return float((high - low) / si(self.shaft).speed)

    @property
    def speed_range(self) -> tuple[float, float]:
        """Lowest speed, n = ω_m, and highest speed, n = ω_M [rad/s]. Raises NoSolution where the motor stalls."""
        low, high = self._deviations
        return si(self.shaft).speed + low, si(self.shaft).speed + high

    @property
    def runs(self) -> bool:
        """Whether a speed exists that repeats each turn; otherwise the motor stalls."""
        return not has_flywheel(self.shaft) or self._steady is not None

    def _deviation(self, angles: Angles) -> np.ndarray:
        return (
            self._curve.deviation(self._shaft_angle(angles))
            if has_flywheel(self.shaft)
            else np.zeros(angles.theta.size)
        )

    @property
    def _curve(self) -> SpeedCurve:
        if self._steady is None:
            raise NoSolution(
                "the motor stalls, this flywheel does not carry the load over its peak",
                "shaft.flywheel_inertia_kg_m2",
                "enlarge it, or motor_slope_nm_s_per_rad",
            )
        return self._steady

    def speed(self, angles: Angles) -> np.ndarray:
        """Speed ω by the energy of the shaft, d/dθ[½(I + J_e) ω²] = T_m - T_s.

        Parameters
        ----------
        angles : Angles
            n cam angles.

        Returns
        -------
        ndarray (n,) [rad/s]

        Raises
        ------
        NoSolution
            Where the motor stalls.
        """
        return si(self.shaft).speed + self._deviation(angles)

    def motor_torque(self, angles: Angles) -> np.ndarray:
        """Motor torque T_m = T̄ + k (ω̄ - ω); without a flywheel T_c.

        Parameters
        ----------
        angles : Angles
            n cam angles.

        Returns
        -------
        ndarray (n,) [N m]

        Raises
        ------
        NoSolution
            Where the motor stalls.
        """
        if not has_flywheel(self.shaft):
            return self.torque(angles)
        return self.load.mean - si(self.shaft).motor_slope * self._deviation(angles)

    def linear_motor_torque(self, angles: Angles) -> np.ndarray:
        """Motor torque for small changes of speed, from I ω̄ dω/dθ + k(ω - ω̄) = -(T_c - T̄).

        Its harmonics are T_n/(1 + i n I ω̄/k).

        Parameters
        ----------
        angles : Angles
            n cam angles.

        Returns
        -------
        ndarray (n,) [N m]

        References
        ----------
        Shin, Kim and Ha 1995, Figs. 19 and 20.
        """
        if not has_flywheel(self.shaft):
            return self.torque(angles)
        return self.load.mean + lag(self.shaft) * self._linear(self._shaft_angle(angles))

    @cached_property
    def _linear(self) -> Callable[[np.ndarray], np.ndarray]:
        return periodic_response(self.load, lag(self.shaft))


# -- findings ------------------------------------------------------------------------------------------------


def findings(wheel: Flywheel) -> list[Finding]:
    """Finding where the motor stalls, at the angle after the peak of the load, or the speed fluctuates too much."""
    if wheel.runs:
        return _fluctuation_findings(wheel)
    values: dict[str, float | str] = {
        "inertia_kg_m2": wheel.shaft.flywheel_inertia_kg_m2,
        "least_kg_m2": wheel.least_inertia,
        "swing_j": wheel.energy_swing,
    }
    angle = float(np.rad2deg(np.mod(wheel.rotation_sign * highest_at(wheel.load), TURN)))
    return [Finding("motor-stalls", ERROR, "shaft.flywheel_inertia_kg_m2", angle, values)]


def _fluctuation_findings(wheel: Flywheel) -> list[Finding]:
    fluctuation, limit = wheel.fluctuation, si(wheel.shaft).speed_fluctuation
    if fluctuation <= limit * (1.0 + TOLERANCE):
        return []
    values = {"percent": 100.0 * fluctuation, "wanted_percent": 100.0 * limit, "inertia_kg_m2": wheel.needed_inertia}
    return [Finding("speed-fluctuates", NOTE, "shaft.flywheel_inertia_kg_m2", None, values)]


# -- flywheel for a limit on the fluctuation, by the true speed of the motor ------------------------------------


NEGLIGIBLE = 1e-9  # of the flywheel by energy: replaces an inertia of 0, with the same result to as many digits
FINEST = 1e-10  # last step of the logarithm of the inertia, by which the result is on the safe side
LONGEST = log(4.0)  # step of this logarithm
SMALLEST, LARGEST = -log(3.0), log(1e6)  # of this logarithm: less is searched only if the motor alone does not suffice
LEAST_SLOPE = 1e-3  # of a secant: between it and its inverse
SECANTS, MOST_STEPS = 30, 90  # after so many steps of the secant the bracket is halved
PANELS_AT_A_TIME = 10_000
ROUNDING = 1e-12


def is_even(load: LoadCurve) -> bool:
    """Whether the torque is its mean but for rounding, as with a balance cam: then the speed does not fluctuate."""
    low, high = energy_range(load)
    return high - low <= ROUNDING * abs(load.mean)


def inertia_by_energy(load: LoadCurve, shaft: Shaft, fluctuation: float) -> float:
    """Textbook estimate of the inertia of flywheel and motor, ΔE/(C_s ω̄²) [kg m²].

    It neglects the motor's torque, and the inertia of the moved bodies.
    """
    low, high = energy_range(load)
    speed: float = si(shaft).speed
    return (high - low) / fluctuation / speed / speed  # one by one: their product may be 0


def fluctuation_with(load: LoadCurve, shaft: Shaft, inertia: float) -> float:
    """Fluctuation of speed with a given inertia of flywheel and motor [kg m²]; infinite where the motor stalls."""
    if is_even(load):
        return 0.0
    return _fluctuation(load, shaft, inertia or NEGLIGIBLE * inertia_by_energy(load, shaft, shaft.speed_fluctuation))


def _fluctuation(load: LoadCurve, shaft: Shaft, inertia: float) -> float:
    s = si(shaft)
    speed = steady_speed(load, inertia, s.motor_slope, s.speed)
    return np.inf if speed is None else speed_fluctuation(speed)


def inertia_for(load: LoadCurve, shaft: Shaft, fluctuation: float) -> float:
    """Least inertia of flywheel and motor [kg m²] with which the true speed satisfies the fluctuation.

    0 where none is needed, infinite where none suffices.
    """
    s = si(shaft)
    return float(inertias_for([load], *(np.array([value]) for value in (s.motor_slope, s.speed, fluctuation)))[0])


def inertias_for(
    loads: Sequence[LoadCurve], slope: np.ndarray, speed: np.ndarray, fluctuation: np.ndarray
) -> np.ndarray:
    """Least inertia of flywheel and motor with which the true speed of each of m shafts satisfies its fluctuation.

    Parameters
    ----------
    loads : sequence of LoadCurve
        m loads.
    slope : ndarray (m,) [N m s/rad]
        Slopes k of the motors.
    speed : ndarray (m,) [rad/s]
        Mean speeds ω̄.
    fluctuation : ndarray (m,), dimensionless
        Limits of the fluctuation C.

    Returns
    -------
    ndarray (m,) [kg m²]
        0 where no flywheel is needed, infinite where none suffices.
    """
    low, high = energy_ranges(loads)
    swing, mean = high - low, np.array([load.mean for load in loads])
    result, uneven = np.zeros(len(loads)), np.flatnonzero(swing > ROUNDING * np.abs(mean))
    guess = swing / fluctuation / speed / speed  # one by one: their product may be 0
    for part in by_panels([loads[k] for k in uneven.tolist()]):
        which = uneven[part]
        search = _InertiaSearch([loads[k] for k in which.tolist()], slope[which], speed[which], fluctuation[which])
        result[which] = search.inertia(guess[which])
    return result


def by_panels(loads: Sequence[LoadCurve]) -> Iterator[slice]:
    """Slices of the loads that are solved at a time."""
    first, count = 0, 0
    for i, load in enumerate(loads):
        if count and count + load.start.size > PANELS_AT_A_TIME:
            yield slice(first, i)
            first, count = i, 0
        count += load.start.size
    if count:
        yield slice(first, len(loads))


class _InertiaSearch:
    """Search for the inertias of m shafts by the secant of log C over log I, which is nearly a line of slope -1."""

    def __init__(
        self, loads: Sequence[LoadCurve], slope: np.ndarray, speed: np.ndarray, fluctuation: np.ndarray
    ) -> None:
        self._loads, self._slope, self._speed, self._fluctuation = loads, slope, speed, fluctuation
        self._turns = SteadyTurns(loads, slope, speed)

    def _margins(self, turns: SteadyTurns, inertia: np.ndarray, active: np.ndarray) -> np.ndarray:
        """log(limit/C) with these inertias (m,) in the active shafts; -∞ where the motor stalls, ∞ where C is 0."""
        checkpoint()
        runs = turns.solve(inertia, active)
        margins = np.full(active.size, -np.inf)
        if runs.any():
            extremes = turns.extremes(runs)
            reached = (extremes.high - extremes.low) / turns.mean[runs]
            with np.errstate(divide="ignore"):
                margins[runs] = np.log(self._fluctuation[runs] / reached)
        return margins

    def inertia(self, guess: np.ndarray) -> np.ndarray:
        """Least inertias (m,) [kg m²], searched from first guesses (m,)."""
        x, result, active = np.zeros(guess.size), np.full(guess.size, np.inf), np.ones(guess.size, dtype=bool)
        low, high = np.full(guess.size, -np.inf), np.full(guess.size, np.inf)
        last_x, last = np.full(guess.size, np.nan), np.full(guess.size, np.nan)
        for number in range(MOST_STEPS):
            margin = self._margins(self._turns, guess * np.exp(x), active)
            low, high = np.where(active & (margin < 0.0), x, low), np.where(active & (margin >= 0.0), x, high)
            with np.errstate(invalid="ignore", divide="ignore"):
                slope = (margin - last) / (x - last_x)
                step = -margin / np.where((slope > LEAST_SLOPE) & (slope < 1.0 / LEAST_SLOPE), slope, 1.0)
            next_x = x + np.clip(step, -LONGEST, LONGEST)
            middle = 0.5 * (low + high)
            outside = np.isfinite(middle) & (~(next_x > low) | ~(next_x < high) | (number >= SECANTS))
            next_x = np.where(outside, middle, next_x)
            rests = active & ((np.abs(next_x - x) <= FINEST) | (high - low <= FINEST))
            result[rests] = (guess * np.exp(np.where(outside, high, next_x) + FINEST))[rests]
            active &= ~rests & ~(next_x > LARGEST)
            unneeded = active & (next_x < SMALLEST) & (low == -np.inf)
            if unneeded.any():  # whether the motor alone keeps the speed
                alone = self._alone(unneeded, guess)
                result[alone] = 0.0
                active &= ~alone
                low[unneeded] = log(NEGLIGIBLE)
                next_x = np.where(unneeded, SMALLEST, next_x)
            if not active.any():
                break
            last_x, last, x = x, margin, next_x
        return result

    def _alone(self, shafts: np.ndarray, guess: np.ndarray) -> np.ndarray:
        """Mask (m,) of those of the shafts whose motor keeps the limit without a flywheel."""
        loads = [load for load, chosen in zip(self._loads, shafts.tolist(), strict=True) if chosen]
        turns = SteadyTurns(loads, self._slope[shafts], self._speed[shafts])
        search = _InertiaSearch(loads, self._slope[shafts], self._speed[shafts], self._fluctuation[shafts])
        result = np.zeros_like(shafts)
        result[shafts] = search._margins(turns, NEGLIGIBLE * guess[shafts], np.ones(len(loads), dtype=bool)) >= 0.0
        return result


# -- figures over the machine's speed -------------------------------------------------------------------------


@frozen(eq=False)
class AgainstSpeed:
    """Figures of a shaft at machine speeds.

    Attributes
    ----------
    rpm : ndarray (n,) [1/min]
    peak, mean, rms : ndarray (n,) [N m]
        Torque at constant speed: peak of |T|, mean, root mean square.
    fluctuation : ndarray (n,), dimensionless
        Of the true speed; NaN where the motor stalls.
    motor_peak : ndarray (n,) [N m]
        The motor's greatest |torque|; NaN where it stalls.
    """

    rpm: np.ndarray
    peak: np.ndarray
    mean: np.ndarray
    rms: np.ndarray
    fluctuation: np.ndarray
    motor_peak: np.ndarray


def load_by_speed(load_at: Callable[[float], LoadCurve], omega: float) -> Callable[[float], LoadCurve]:
    """The load at any speed [rad/s], T = T_static + ω² T_inertia, from two speeds; holds without friction."""
    first, second = load_at(omega), load_at(2.0 * omega)
    inertial = (second.torque - first.torque) / (3.0 * omega * omega)
    mean = (second.mean - first.mean) / (3.0 * omega * omega)

    def load(speed: float) -> LoadCurve:
        difference = speed * speed - omega * omega
        return replace(first, torque=first.torque + difference * inertial, mean=first.mean + difference * mean)

    return load


def against_speed(load_at: Callable[[float], LoadCurve], shaft: Shaft, rpm: np.ndarray) -> AgainstSpeed:
    """Figures of a shaft with flywheel and motor over the machine's speed.

    Parameters
    ----------
    load_at : function
        Speed [rad/s] -> LoadCurve.
    shaft : Shaft
    rpm : ndarray (n,) [1/min]

    Returns
    -------
    AgainstSpeed
    """
    rows = []
    for speed in rpm.tolist():
        checkpoint()
        load = load_at(speed * pi / 30.0)
        extremes = peaks(load)
        peak = max(-extremes.low.value, extremes.high.value)
        rows.append((peak, load.mean, rms(load), *_with_motor(load, replace(shaft, speed_rpm=speed), peak)))
    return AgainstSpeed(rpm, *np.array(rows).reshape(-1, 5).T)


def _with_motor(load: LoadCurve, shaft: Shaft, peak: float) -> tuple[float, float]:
    """Fluctuation, and the motor's greatest torque [N m]."""
    if not has_flywheel(shaft):
        return 0.0, peak
    s = si(shaft)
    speed = steady_speed(load, s.flywheel_inertia + motor_inertia(shaft), s.motor_slope, s.speed)
    if speed is None:
        return np.nan, np.nan
    low, high = deviation_range(speed)
    return (high - low) / speed.mean, max(load.mean - s.motor_slope * low, s.motor_slope * high - load.mean)
