"""Lift, velocity and acceleration of an inlet and an exhaust valve over the crank."""

from __future__ import annotations

import numpy as np

from core.design.engine import HALF_CYCLE
from core.plot import Plot, PlotCurve
from core.study import Study
from core.study.member_quantities import valve_lift
from core.valves.pairs import ValvePair
from core.valves.timing import CRANK_ANGLES, MM, ValveTiming

ACROSS = "Crank angle from TDC of overlap, °"
TITLES = ("Valve lift, mm", "Velocity, mm/° of the cam", "Acceleration, mm/°²")
MARKS = ((-180.0, "BDC"), (0.0, "TDC"), (180.0, "BDC"))


def crank_plots(pair: ValvePair) -> tuple[Plot, ...]:
    """Lift of both valves with the lash taken off, and velocity and acceleration by cam angle, over one cycle.

    Raises
    ------
    NoSolution
        Where a valve train cannot be assembled.
    """
    crank = np.linspace(-HALF_CYCLE, HALF_CYCLE, CRANK_ANGLES)
    motions = [(timing.name, _motion(timing, crank)) for timing in (pair.inlet, pair.exhaust)]
    return tuple(
        Plot(
            ACROSS,
            title,
            tuple(PlotCurve(crank, motion[order], name, row) for row, (name, motion) in enumerate(motions)),
            MARKS,
            quiet=True,
        )
        for order, title in enumerate(TITLES)
    )


def _motion(timing: ValveTiming, crank: np.ndarray) -> list[np.ndarray]:
    """Lift of a valve and its two derivatives by cam angle [mm/deg^order] at crank angles (n,) [deg]."""
    study = Study(timing.design).at_theta(timing.cam_angle(crank))
    per_degree = np.deg2rad(1.0) / study.omega
    return [valve_lift(study, order) * MM * per_degree**order for order in range(len(TITLES))]
