"""What the servo's motor cannot give: its peak, its rated torque as rms, its rated speed; one row each."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import degrees, pi

from core.findings import ERROR, WARNING, Finding
from core.motion.extremes import Extreme
from core.study.extremes import extremes_of
from core.study.quantities import names_of
from core.study.servo import has_servo, servo_part, servo_turn
from core.study.study import Study

ROUNDING = 1e-9  # of a limit: less above it is none


def _largest(study: Study, *names: str) -> Extreme:
    """Of the quantities that the servo has, the largest size [SI]."""
    there = names_of(study.design)
    found = extremes_of(study, "dynamics", tuple(name for name in names if name in there))
    return max((end for each in found.values() for end in (each.low, each.high)), key=lambda end: abs(end.value))


def _peak(study: Study) -> tuple[float, float | None]:
    worst = _largest(study, "servo_torque", "servo_force")
    return abs(worst.value), degrees(worst.theta)


def _rms(study: Study) -> tuple[float, float | None]:
    return servo_turn(study).rms, None


def _speed(study: Study) -> tuple[float, float | None]:
    worst = _largest(study, "servo_speed")
    return abs(worst.value) * RPM, degrees(worst.theta)


RPM = 30.0 / pi  # of one rad/s
LIMITS: tuple[tuple[str, str, str, str, Callable[[Study], tuple[float, float | None]]], ...] = (
    ("servo-peak", ERROR, "peak_torque_nm", "N·m", _peak),
    ("servo-rms", ERROR, "rated_torque_nm", "N·m", _rms),
    ("servo-speed", WARNING, "rated_rpm", "rpm", _speed),
)
"""Code, severity, field of [servo], unit, and what reaches it with its cam angle [deg]."""


def servo_findings(study: Study) -> Iterator[Finding]:
    """The limits of the motor that a design passes. Raises NoAnswer as the stage dynamics does."""
    if not has_servo(study.design) or study.jam is not None:
        return
    servo = servo_part(study)
    for code, severity, field, unit, reach in LIMITS:
        limit = getattr(servo, field)
        if limit is None:
            continue
        value, angle = reach(study)
        if value > limit * (1.0 + ROUNDING):
            yield Finding(code, severity, f"servo.{field}", angle, {"value": value, "limit": limit, "unit": unit})


__all__ = ["servo_findings"]
