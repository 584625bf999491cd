"""What a flywheel does: its sizing by energy, the speed and the motor's torque with the one fitted."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from math import floor, log10

import numpy as np

from core.design import Shaft, si
from core.errors import NoAnswer
from core.findings import ERROR, NOTE, Finding
from core.frozen import frozen
from core.motion import TURN, Angles
from core.shaft.curve import LoadCurve
from core.shaft.energy import energy_range, highest_at
from core.shaft.linear import filtered, lag, levels, motor_inertia
from core.shaft.speed import SpeedCurve, deviation_range, steady_speed

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
        """T̄ [N m]."""
        return self.load.mean

    @cached_property
    def energy_swing(self) -> float:
        """ΔE = max - min of ∫(T_c - T̄)dθ [J]."""
        low, high = energy_range(self.load)
        return high - low

    @cached_property
    def needed_inertia(self) -> float:
        """The least flywheel [kg m²] with which the true speed keeps the wanted fluctuation, less what the motor has itself."""
        from core.shaft.sizing import inertia_for

        needed = inertia_for(self.load, self.shaft, si(self.shaft).speed_fluctuation)
        return max(needed - motor_inertia(self.shaft), 0.0)

    @property
    def estimated_inertia(self) -> float:
        """The textbook's estimate of it, ΔE/(C_s ω̄²) [kg m²], less what the motor has itself."""
        from core.shaft.sizing import inertia_by_energy

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
        """(ω_max - ω_min)/ω̄ with the flywheel fitted; 0 without one. Raises NoAnswer where the motor stalls."""
        low, high = self._deviations
        return float((high - low) / si(self.shaft).speed)

    @property
    def speed_range(self) -> tuple[float, float]:
        """The least and the greatest ω [rad/s]. Raises NoAnswer where the motor stalls."""
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
            raise NoAnswer(
                "the motor stalls, this flywheel does not carry the load over its peak",
                "shaft.flywheel_inertia_kg_m2",
                "enlarge it, or motor_slope_nm_s_per_rad",
            )
        return self._steady

    def speed(self, angles: Angles) -> np.ndarray:
        """ω (n,) [rad/s]. Raises NoAnswer where the motor stalls."""
        return si(self.shaft).speed + self._deviation(angles)

    def motor_torque(self, angles: Angles) -> np.ndarray:
        """T_m = T̄ + k(ω̄ - ω) (n,) [N m]; without a flywheel T_c. Raises NoAnswer where the motor stalls."""
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
