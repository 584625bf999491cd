"""The camshaft as a rigid flywheel with a motor of linear characteristic: its load, its speed, its sizing."""

from typing import TYPE_CHECKING

from core.process import lazy_attributes
from core.shaft.curve import (
    NODES,
    LoadCurve,
    combined_load,
    combined_loads,
    load_curve,
    load_extremes,
    panel_angles,
    peaks,
    rms,
    torque_at,
)
from core.shaft.flywheel import Flywheel, findings, has_flywheel, lag, motor_inertia, periodic_response
from core.shaft.speed import SpeedCurve, SteadyTurns, speed_fluctuation, steady_speed

if TYPE_CHECKING:
    from core.shaft.balancer import balance_drive, balance_drives, first_balancer, with_balancer
    from core.shaft.flywheel import (
        AgainstSpeed,
        against_speed,
        fluctuation_with,
        inertia_by_energy,
        inertia_for,
        inertias_for,
        is_even,
        load_by_speed,
    )
    from core.shaft.phases import AIMS, Phases, Spacing, aim_along, best_phases
    from core.shaft.servo import MotorLoad, best_ratio, lever, motor_load, motor_torque, moved_mass
else:
    __getattr__ = lazy_attributes(__name__, "balancer", "flywheel", "phases", "servo")

__all__ = [
    "AIMS",
    "NODES",
    "AgainstSpeed",
    "Flywheel",
    "LoadCurve",
    "MotorLoad",
    "Phases",
    "Spacing",
    "SpeedCurve",
    "SteadyTurns",
    "against_speed",
    "aim_along",
    "balance_drive",
    "balance_drives",
    "best_phases",
    "best_ratio",
    "combined_load",
    "combined_loads",
    "findings",
    "first_balancer",
    "fluctuation_with",
    "has_flywheel",
    "inertia_by_energy",
    "inertia_for",
    "inertias_for",
    "is_even",
    "lag",
    "lever",
    "load_by_speed",
    "load_curve",
    "load_extremes",
    "motor_inertia",
    "motor_load",
    "motor_torque",
    "moved_mass",
    "panel_angles",
    "peaks",
    "periodic_response",
    "rms",
    "speed_fluctuation",
    "steady_speed",
    "torque_at",
    "with_balancer",
]  # fmt: skip
