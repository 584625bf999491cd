"""The shaft of a design at other speeds: torque, motor and speed fluctuation over the speed of the machine."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from core.design import Design
from core.motion.program import ShaftPosition
from core.shaft import AgainstSpeed, LoadCurve, against_speed, combined_load, load_by_speed
from core.study.stages import evaluations
from core.study.study import Study


def at_speeds(design: Design, rpm: np.ndarray) -> AgainstSpeed:
    """Torque, motor and speed fluctuation of a design's shaft, with all its drives, over the machine's speed.

    Without friction the load is the sum of a static part and one that grows with the speed squared; with friction it is solved
    at every speed. A balance cam keeps the shape that it has at the speed of the design.

    Parameters
    ----------
    design : Design
    rpm : ndarray (n,) [rpm]
        Speeds of the machine.

    Returns
    -------
    AgainstSpeed

    Raises
    ------
    NoSolution
        Where a drive has no torque.
    """
    evaluations["against speed"] += 1
    shaft = design.camshaft
    study = Study(design)
    balance = study.camshaft.balancer

    def cams_load(omega: float) -> LoadCurve:
        at_speed = replace(design, shaft=replace(shaft, speed_rpm=omega * 30.0 / pi))
        return Study(at_speed).camshaft.cams_load

    has_friction = any(drive.loading.has_friction for drive in study.drives.values())
    load_at = cams_load if has_friction else load_by_speed(cams_load, shaft.speed_rpm * pi / 30.0)
    if balance is None:
        return against_speed(load_at, shaft, rpm)
    phase = 0.0 if design.balancer is None else float(np.deg2rad(design.balancer.phase_deg % 360.0))
    balance_load = balance.load_curve, ShaftPosition(phase)
    return against_speed(lambda omega: combined_load([(load_at(omega), ShaftPosition()), balance_load]), shaft, rpm)
