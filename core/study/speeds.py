"""A shaft at other speeds than its own: torque, motor and fluctuation against the machine's speed."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from core.design import Design
from core.motion.program import ShaftPosition
from core.shaft import AgainstSpeed, LoadCurve, against_speed, combined, separated
from core.study.stages import evaluations
from core.study.study import Study


def at_speeds(design: Design, rpm: np.ndarray) -> AgainstSpeed:
    """Figures of a design's shaft at machine speeds (n,) [rpm], all of its drives together; a balance cam is made for the design's own
    speed and stays as it is. Raises NoSolution where a drive has no torque.

    Where nothing rubs the load is of a static part and of one that grows with the speed squared; else it is solved at each speed.
    """
    evaluations["against speed"] += 1
    shaft = design.camshaft
    own = shaft.speed_rpm * pi / 30.0
    study = Study(design)
    balance = study.camshaft.balancer
    place = (
        ShaftPosition()
        if design.balancer is None
        else ShaftPosition(float(np.deg2rad(design.balancer.phase_deg % 360.0)))
    )

    def cams(omega: float) -> LoadCurve:
        there = replace(design, shaft=replace(shaft, speed_rpm=omega * 30.0 / pi))
        return Study(there).camshaft.cams_load

    load_at = cams if any(each.loading.has_friction for each in study.drives.values()) else separated(cams, own)
    if balance is None:
        return against_speed(load_at, shaft, rpm)
    held = balance.load_curve
    return against_speed(lambda omega: combined([(load_at(omega), ShaftPosition()), (held, place)]), shaft, rpm)
