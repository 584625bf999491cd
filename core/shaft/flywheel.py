"""What a flywheel does: its sizing by energy, the speed and the motor's torque with the one fitted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from math import exp, floor, log, log10, pi

import numpy as np

from core.design import Shaft, si
from core.errors import NoSolution
from core.findings import ERROR, NOTE, Finding
from core.frozen import frozen
from core.motion import TURN, Angles
from core.numerics.lazy import checkpoint
from core.numerics.roots import BracketEnds, bracketed_root
from core.shaft.curve import NODES, LoadCurve, by_blocks, peaks, placed, polyval, powers, rms
from core.shaft.speed import SpeedCurve, deviation_range, speed_fluctuation, steady_speed

# -- the linear answer of flywheel and motor, small changes of speed assumed (Shin1995 Figs ---------------------


PARTED = 4.0  # z at which the recurrence of ``phi`` changes its direction


def motor_inertia(shaft: Shaft) -> float:
    """The motor's own inertia as it is felt at the camshaft, I_m times the gear ratio squared [kg m²]."""
    s = si(shaft)
    ratio = 1.0 if s.gear_ratio is None else s.gear_ratio
    return float((s.motor_inertia or 0.0) * ratio * ratio)


def lag(shaft: Shaft) -> float:
    """k/(I ω̄) [per radian], at which the motor follows the torque, I of flywheel and motor; infinite where both have none."""
    s = si(shaft)
    momentum = (s.flywheel_inertia + motor_inertia(shaft)) * s.speed
    return float(s.motor_slope / momentum) if momentum else np.inf


def levels(shaft: Shaft) -> bool:
    """Whether a flywheel is fitted; without one the speed is taken as constant, and the motor gives the cam's torque."""
    return lag(shaft) < np.inf


def phi(z: np.ndarray) -> np.ndarray:
    """k! φ_{k+1}(-z) for k = 0 ... NODES-1 (NODES, n): I_k = ∫_0^1 e^{-z(1-s)} s^k ds, z >= 0.

    By the recurrence z I_k = 1 - k I_{k-1}: downwards it multiplies errors by z/k, upwards by k/z. Where they part, at 4,
    either way makes at most fifteen roundings of one; 22 steps above NODES - 1 let the error of the first guess, (z/k)²,
    vanish.
    """
    small, large = np.minimum(z, PARTED), np.maximum(z, PARTED)
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
    return np.where(z <= PARTED, down, up)


def filtered(curve: LoadCurve, rate: float) -> Callable[[np.ndarray], np.ndarray]:
    """The periodic solution of x' + rate·x = T - T̄, or ∫(T - T̄)dθ from 0 where rate is 0, at any cam angles (n,).

    Panel by panel: x(θ+h) = e^{-rate h} x(θ) + h ∫ e^{-rate h (1-s)} (T - T̄)(s) ds, exact for polynomials.
    """
    power = curve.torque.copy()
    power[0] -= curve.mean
    decay = np.exp(-rate * curve.width)
    gain = curve.width * (power * phi(rate * curve.width)).sum(axis=0)
    end, starts = 0.0, []
    for left, added in zip(decay.tolist(), gain.tolist(), strict=True):
        starts.append(end)
        end = left * end + added
    begins = np.array(starts)
    if rate > 0.0:
        begins += end / -np.expm1(-rate * TURN) * np.exp(-rate * curve.start)

    def solution(theta: np.ndarray) -> np.ndarray:
        return by_blocks(block, theta)

    def block(theta: np.ndarray) -> np.ndarray:
        at, r = placed(curve.start, curve.width, theta)
        h = theta - curve.start[at]
        reach = power[:, at] * powers(r)
        return np.exp(-rate * h) * begins[at] + h * (reach * phi(rate * h)).sum(axis=0)

    return solution


# -- what the torque of a shaft, less its mean, gives and takes over the turn -----------------------------------


def unbalanced(curve: LoadCurve) -> np.ndarray:
    """Coefficients (NODES, m) of r**k on the panels, of T - T̄ [N m]."""
    power = curve.torque.copy()
    power[0] -= curve.mean
    return power


def roots_of(power: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where polynomials (k, m) of r = 0 ... 1 change their sign: panel and r (n,), to the square of a sample's error."""
    r = np.linspace(0.0, 1.0, 4 * NODES + 1)
    values = polyval(r, power[:, :, None])  # (m, points)
    panel, cell = np.nonzero(values[:, :-1] * values[:, 1:] < 0.0)
    before, after = values[panel, cell], values[panel, cell + 1]
    # two steps are enough: what has an extreme there is flat, its error is of second order in the root's
    root = r[cell] + (r[cell + 1] - r[cell]) * before / (before - after)
    slope = polyval(root, np.arange(1, power.shape[0])[:, None] * power[1:, panel])
    rest = polyval(root, power[:, panel])
    return panel, np.clip(root - rest / np.where(slope == 0.0, np.inf, slope), r[cell], r[cell + 1])


def turning_points(curve: LoadCurve) -> np.ndarray:
    """Machine angles (n,) among which W has its extremes [rad]: starts of panels, and roots of T - T̄ inside them."""
    panel, root = roots_of(unbalanced(curve))
    return np.concatenate((curve.start, curve.start[panel] + root * curve.width[panel]))


def energy_range(curve: LoadCurve) -> tuple[float, float]:
    """The least and the greatest W [J]."""
    low, high = energy_ranges([curve])
    return float(low[0]), float(high[0])


def energy_ranges(curves: Sequence[LoadCurve]) -> tuple[np.ndarray, np.ndarray]:
    """The same of m loads, both (m,)."""
    power = np.concatenate([unbalanced(curve) for curve in curves], axis=1)
    width = np.concatenate([curve.width for curve in curves])
    integral = np.concatenate((np.zeros((1, width.size)), power / np.arange(1, NODES + 1)[:, None]))
    ends = width * polyval(np.ones(width.size), integral)
    counts = [curve.width.size for curve in curves]
    first = np.append(0, np.cumsum(counts)[:-1])
    begins = np.concatenate([np.append(0.0, np.cumsum(part)[:-1]) for part in np.split(ends, first[1:])])
    panel, root = roots_of(power)
    inside = begins[panel] + width[panel] * polyval(root, integral[:, panel])
    low, high, of = (
        np.minimum.reduceat(begins, first),
        np.maximum.reduceat(begins, first),
        np.repeat(np.arange(len(curves)), counts),
    )
    np.minimum.at(low, of[panel], inside)
    np.maximum.at(high, of[panel], inside)
    return low, high


def highest_at(curve: LoadCurve) -> float:
    """The machine angle of the greatest W [rad], 0 ... 2π: there the shaft has given most, and runs slowest."""
    at = turning_points(curve)
    return float(at[int(np.argmax(filtered(curve, 0.0)(at)))] % TURN)


# -- what a flywheel does ---------------------------------------------------------------------------------------


TOLERATED = 1e-4  # of the wanted fluctuation of speed, beyond it: a flywheel typed with five digits comes so near
SEARCH = 1e-4  # relative width at which the search for the least flywheel ends; three digits are shown


def rounded_up(value: float, digits: int) -> float:
    """A size to so many digits, never less than it is."""
    near = float(f"{value:.{digits}g}")
    return near if near >= value else float(f"{near + 10.0 ** (floor(log10(value)) + 1 - digits):.{digits}g}")


@frozen(eq=False)
class Flywheel:
    """Made of the load over one turn and the shaft; each figure when it is read.

    torque  call with Angles: that of the load at constant speed, T_c (n,) [N m]
    load    by the angle that the shaft has turned through
    sense   -1 of a crank whose angle falls as the shaft turns: then angles are turned round for the load
    """

    torque: Callable[[Angles], np.ndarray]
    load: LoadCurve
    shaft: Shaft
    sense: float = 1.0

    def _turned(self, angles: Angles) -> np.ndarray:
        """How far the shaft has turned (n,) [rad]."""
        return angles.theta if self.sense > 0.0 else np.mod(-angles.theta, TURN)

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
        """Least flywheel with which the true speed keeps its target of fluctuation, I = I_C - I_m with the motor's inertia I_m [kg m²]."""
        needed = inertia_for(self.load, self.shaft, si(self.shaft).speed_fluctuation)
        return max(needed - motor_inertia(self.shaft), 0.0)

    @property
    def estimated_inertia(self) -> float:
        """Textbook's estimate of the flywheel, I = max(ΔE/(C_s ω̄²) - I_m, 0) [kg m²]."""
        estimate = inertia_by_energy(self.load, self.shaft, si(self.shaft).speed_fluctuation)
        return max(estimate - motor_inertia(self.shaft), 0.0)

    @cached_property
    def least_inertia(self) -> float:
        """The least flywheel [kg m²] with which the motor does not stall, rounded up to three digits; 0 where the one
        fitted does not."""
        if self.runs:
            return 0.0
        s, own = si(self.shaft), motor_inertia(self.shaft)
        low = s.flywheel_inertia + own
        high = max(2.0 * low, self.energy_swing / s.speed / s.speed)
        while self._speed_with(high) is None:
            low, high = high, 2.0 * high
        while high - low > SEARCH * high:
            middle = (low * high) ** 0.5 if high > 4.0 * low > 0.0 else 0.5 * (low + high)
            low, high = (low, middle) if self._speed_with(middle) else (middle, high)
        return rounded_up(max(high - own, SEARCH * high), 3)

    # -- with the flywheel fitted -------------------------------------------------------------------------

    def _speed_with(self, inertia: float) -> SpeedCurve | None:
        s = si(self.shaft)
        return steady_speed(self.load, inertia, s.motor_slope, s.speed)

    @cached_property
    def _steady(self) -> SpeedCurve | None:
        return self._speed_with(si(self.shaft).flywheel_inertia + motor_inertia(self.shaft))

    @cached_property
    def _deviations(self) -> tuple[float, float]:
        """The least and the greatest ω - ω̄ [rad/s]."""
        return deviation_range(self._curve) if levels(self.shaft) else (0.0, 0.0)

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
        """Whether there is a speed that repeats each turn; else the motor stalls."""
        return not levels(self.shaft) or self._steady is not None

    def _deviation(self, angles: Angles) -> np.ndarray:
        return self._curve.deviation(self._turned(angles)) if levels(self.shaft) else np.zeros(angles.theta.size)

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
        """Speed ω (n,) [rad/s] by the energy of the shaft, d/dθ[½(I + J_e) ω²] = T_m - T_s. Raises NoSolution where the motor stalls."""
        return si(self.shaft).speed + self._deviation(angles)

    def motor_torque(self, angles: Angles) -> np.ndarray:
        """T_m = T̄ + k (ω̄ - ω) (n,) [N m]; without a flywheel T_c. Raises NoSolution where the motor stalls."""
        if not levels(self.shaft):
            return self.torque(angles)
        return self.load.mean - si(self.shaft).motor_slope * self._deviation(angles)

    def linear_motor_torque(self, angles: Angles) -> np.ndarray:
        """The same for small changes of speed: I ω̄ dω/dθ + k(ω - ω̄) = -(T_c - T̄), whose harmonics are
        T_n/(1 + i n I ω̄/k) (Shin1995 Figs. 19, 20) (n,) [N m]."""
        if not levels(self.shaft):
            return self.torque(angles)
        return self.load.mean + lag(self.shaft) * self._linear(self._turned(angles))

    @cached_property
    def _linear(self) -> Callable[[np.ndarray], np.ndarray]:
        return filtered(self.load, lag(self.shaft))


# -- limits: standing still ---------------------------------------------------------------------------------


def findings(wheel: Flywheel) -> list[Finding]:
    """Whether the motor stalls, by the angle after the hardest stretch of the load, and with which flywheel it would not; where it does
    not, whether the speed fluctuates by more than wanted."""
    if wheel.runs:
        return _uneven(wheel)
    values: dict[str, float | str] = {
        "inertia_kg_m2": wheel.shaft.flywheel_inertia_kg_m2,
        "least_kg_m2": wheel.least_inertia,
        "swing_j": wheel.energy_swing,
    }
    angle = float(np.rad2deg(np.mod(wheel.sense * highest_at(wheel.load), TURN)))
    return [Finding("motor-stalls", ERROR, "shaft.flywheel_inertia_kg_m2", angle, values)]


def _uneven(wheel: Flywheel) -> list[Finding]:
    reached, wanted = wheel.fluctuation, si(wheel.shaft).speed_fluctuation
    if reached <= wanted * (1.0 + TOLERATED):
        return []
    values = {"percent": 100.0 * reached, "wanted_percent": 100.0 * wanted, "inertia_kg_m2": wheel.needed_inertia}
    return [Finding("speed-fluctuates", NOTE, "shaft.flywheel_inertia_kg_m2", None, values)]


# -- the flywheel that a wanted fluctuation of speed takes, by the true speed of the motor ----------------------


NONE = 1e-9  # of the flywheel by energy: so little stands for none, whose answer it has to as many digits
FINEST = 1e-11  # relative width of the last bracket
STEPS = (1e-3, log(4.0))  # of the logarithm of the inertia, towards a bracket: the shortest and the longest
MOST = log(1e6)  # of it, how far the search goes up
ROUNDING = 1e-12


def even(load: LoadCurve) -> bool:
    """Whether the torque is its mean but for rounding, as a balance cam leaves it: then nothing makes the speed fluctuate."""
    low, high = energy_range(load)
    return high - low <= ROUNDING * abs(load.mean)


def inertia_by_energy(load: LoadCurve, shaft: Shaft, fluctuation: float) -> float:
    """The textbook's estimate of the inertia of flywheel and motor, ΔE/(C_s ω̄²) [kg m²]: it leaves out the motor, which helps, and
    that the moved bodies are a flywheel themselves."""
    low, high = energy_range(load)
    speed: float = si(shaft).speed
    return (high - low) / fluctuation / speed / speed  # one by one: their product may be 0


def reached_with(load: LoadCurve, shaft: Shaft, inertia: float) -> float:
    """The fluctuation of speed with flywheel and motor of so much inertia [kg m²]; infinite where the motor stalls."""
    if even(load):
        return 0.0
    return _reached(load, shaft, inertia or NONE * inertia_by_energy(load, shaft, shaft.speed_fluctuation))


def _reached(load: LoadCurve, shaft: Shaft, inertia: float) -> float:
    s = si(shaft)
    speed = steady_speed(load, inertia, s.motor_slope, s.speed)
    return np.inf if speed is None else speed_fluctuation(speed)


def inertia_for(load: LoadCurve, shaft: Shaft, fluctuation: float) -> float:
    """The least inertia of flywheel and motor [kg m²] with which the true speed fluctuates by no more; 0 where it need not be any,
    infinite where none does."""
    if even(load):
        return 0.0
    guess = inertia_by_energy(load, shaft, fluctuation)

    def spare(x: float) -> float:
        checkpoint()
        reached = _reached(load, shaft, guess * exp(x))
        return log(fluctuation / reached) if 0.0 < reached < np.inf else -reached or np.inf

    x, left = 0.0, spare(0.0)
    if left >= 0.0 and spare(log(NONE)) >= 0.0:
        return 0.0
    beside, there = x, left
    while (there >= 0.0) == (left >= 0.0):  # the fluctuation goes nearly with 1/I: so far away is its root
        x, left = beside, there
        beside = x - float(np.copysign(np.clip(1.1 * abs(left), *STEPS), left))
        if beside > MOST:
            return np.inf
        there = spare(beside)
    ends = BracketEnds(beside, there, x, left) if left >= 0.0 else BracketEnds(x, left, beside, there)
    return float(guess * exp(bracketed_root(spare, ends, FINEST).b))


# -- against the machine's speed ----------------------------------------------------------------------------


@frozen(eq=False)
class AgainstSpeed:
    """Figures of a shaft at machine speeds, each (n,): torque at constant speed (peak of |T|, mean, root mean square) [N m], fluctuation
    of the true speed, the motor's greatest |torque| [N m]; both NaN where the motor stalls."""

    rpm: np.ndarray
    peak: np.ndarray
    mean: np.ndarray
    rms: np.ndarray
    fluctuation: np.ndarray
    motor_peak: np.ndarray


def separated(load_at: Callable[[float], LoadCurve], omega: float) -> Callable[[float], LoadCurve]:
    """The load at any speed [rad/s] of what it is at two: T = T_static + ω² T_inertia, as it is where nothing rubs."""
    first, second = load_at(omega), load_at(2.0 * omega)
    inertial = (second.torque - first.torque) / (3.0 * omega * omega)
    mean = (second.mean - first.mean) / (3.0 * omega * omega)

    def load(speed: float) -> LoadCurve:
        more = speed * speed - omega * omega
        return replace(first, torque=first.torque + more * inertial, mean=first.mean + more * mean)

    return load


def against_speed(load_at: Callable[[float], LoadCurve], shaft: Shaft, rpm: np.ndarray) -> AgainstSpeed:
    """load_at: speed [rad/s] -> the load at it; rpm (n,) the speeds, with flywheel and motor of the shaft."""
    rows = []
    for speed in rpm.tolist():
        checkpoint()
        load = load_at(speed * pi / 30.0)
        at = peaks(load)
        peak = max(-at.low.value, at.high.value)
        rows.append((peak, load.mean, rms(load), *_with_motor(load, replace(shaft, speed_rpm=speed), peak)))
    return AgainstSpeed(rpm, *np.array(rows).reshape(-1, 5).T)


def _with_motor(load: LoadCurve, shaft: Shaft, peak: float) -> tuple[float, float]:
    """Fluctuation and the motor's greatest torque."""
    if not levels(shaft):
        return 0.0, peak
    s = si(shaft)
    speed = steady_speed(load, s.flywheel_inertia + motor_inertia(shaft), s.motor_slope, s.speed)
    if speed is None:
        return np.nan, np.nan
    low, high = deviation_range(speed)
    return (high - low) / speed.mean, max(load.mean - s.motor_slope * low, s.motor_slope * high - load.mean)
