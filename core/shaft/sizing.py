"""The flywheel that a wanted fluctuation of speed takes, by the true speed of the motor; and figures of a shaft against its speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import exp, log, pi

import numpy as np

from core.design import Shaft, si
from core.frozen import frozen
from core.numerics.cancellation import checkpoint
from core.numerics.search import BracketEnds, bracketed_root
from core.shaft.curve import LoadCurve
from core.shaft.energy import energy_range
from core.shaft.linear import levels, motor_inertia
from core.shaft.several import peaks, rms
from core.shaft.speed import deviation_range, speed_fluctuation, steady_speed

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
