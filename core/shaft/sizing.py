"""The flywheel that a wanted fluctuation of speed takes, by the true speed of the motor; and figures of a shaft against its speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import exp, log, pi

import numpy as np

from core.design import Shaft, si
from core.frozen import frozen
from core.motion import TURN
from core.numerics.cancellation import checkpoint
from core.numerics.search import Ends, bracketed_root
from core.shaft.curve import LoadCurve
from core.shaft.energy import energy_range
from core.shaft.flywheel import levels
from core.shaft.linear import motor_inertia
from core.shaft.several import peaks, rms
from core.shaft.speed import SAMPLES, speed_fluctuation, steady_speed, top

LEAST = 1e-6  # of the flywheel by energy: with less it does nothing
MOST = 1e6
FINEST = 1e-12
ROUNDING = 1e-12


def even(load: LoadCurve) -> bool:
    """Whether the torque is its mean but for rounding, as a balance cam leaves it: then nothing makes the speed fluctuate."""
    low, high = energy_range(load)
    return high - low <= ROUNDING * abs(load.mean)


def reached_with(load: LoadCurve, shaft: Shaft, inertia: float) -> float:
    """The fluctuation of speed with flywheel and motor of so much inertia [kg m²]; infinite where the motor stalls."""
    s = si(shaft)
    speed = steady_speed(load, inertia, s.motor_slope, s.speed)
    return np.inf if speed is None else speed_fluctuation(speed)


def inertia_for(load: LoadCurve, shaft: Shaft, fluctuation: float) -> float:
    """The least inertia of flywheel and motor [kg m²] with which the true speed fluctuates by no more; 0 where it need not be any.

    By energy it is ΔE/(C_s ω̄²): the motor, which helps, and the moved bodies, which are a flywheel themselves, make another.
    """
    if even(load):
        return 0.0
    s = si(shaft)
    low, high = energy_range(load)
    guess = (high - low) / fluctuation / s.speed / s.speed

    def spare(x: float) -> float:
        checkpoint()
        reached = reached_with(load, shaft, guess * exp(x))
        return log(fluctuation / reached) if reached > 0.0 else np.inf

    good, bad = 0.0, 0.0
    while not spare(good) >= 0.0 and good < log(MOST):
        bad, good = good, good + log(2.0)
    while bad == good or (spare(bad) >= 0.0 and bad > log(LEAST)):
        good, bad = bad, bad - log(4.0)
    if spare(bad) >= 0.0:
        return 0.0
    root = bracketed_root(spare, Ends(bad, spare(bad), good, spare(good)), FINEST)
    return float(guess * exp(root.b))


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
    motor = load.mean - s.motor_slope * speed.deviation(np.arange(SAMPLES) * (TURN / SAMPLES))
    return speed_fluctuation(speed), max(top(motor), top(-motor))
