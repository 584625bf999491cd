"""The camshaft as a rigid flywheel with a motor of straight characteristic: its load, its speed, its sizing."""

from core.shaft.balancer import balance_drive, balance_motion
from core.shaft.curve import NODES, LoadCurve, load_curve, panel_angles
from core.shaft.flywheel import Flywheel, findings, levels
from core.shaft.linear import filtered, lag, motor_inertia
from core.shaft.phases import AIMS, Phases, Spacing, best_phases
from core.shaft.several import combined, peaks, rms, value
from core.shaft.speed import SpeedCurve, steady_speed

__all__ = [
    "AIMS", "NODES", "Flywheel", "LoadCurve", "Phases", "Spacing", "SpeedCurve", "balance_drive", "balance_motion", "best_phases",
    "combined", "filtered", "findings", "lag", "levels", "load_curve", "motor_inertia", "panel_angles", "peaks", "rms", "steady_speed",
    "value",
]  # fmt: skip
