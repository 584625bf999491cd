"""The camshaft as a rigid flywheel with a motor of straight characteristic: its load, its speed, its sizing."""

from typing import TYPE_CHECKING

from core.process import lazy_attributes
from core.shaft.curve import NODES, LoadCurve, combined, load_curve, panel_angles, peaks, rms, value
from core.shaft.flywheel import Flywheel, filtered, findings, lag, levels, motor_inertia, rounded_up
from core.shaft.speed import SpeedCurve, speed_fluctuation, steady_speed

if TYPE_CHECKING:
    from core.shaft.balancer import balance_drive, balance_drives, first_balancer, with_balancer
    from core.shaft.flywheel import (
        AgainstSpeed,
        against_speed,
        even,
        inertia_by_energy,
        inertia_for,
        reached_with,
        separated,
    )
    from core.shaft.phases import AIMS, Phases, Spacing, best_phases, reached_along
else:
    __getattr__ = lazy_attributes(__name__, "balancer", "flywheel", "phases")

__all__ = [
    "AIMS",
    "NODES",
    "AgainstSpeed",
    "Flywheel",
    "LoadCurve",
    "Phases",
    "Spacing",
    "SpeedCurve",
    "against_speed",
    "balance_drive",
    "balance_drives",
    "best_phases",
    "combined",
    "even",
    "filtered",
    "findings",
    "first_balancer",
    "inertia_by_energy",
    "inertia_for",
    "lag",
    "levels",
    "load_curve",
    "motor_inertia",
    "panel_angles",
    "peaks",
    "reached_along",
    "reached_with",
    "rms",
    "rounded_up",
    "separated",
    "speed_fluctuation",
    "steady_speed",
    "value",
    "with_balancer",
]  # fmt: skip
