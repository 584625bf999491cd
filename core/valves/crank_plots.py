"""Lift, velocity and acceleration of an inlet and an exhaust valve over the crank."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from core.plot import Plot, PlotCurve
from core.valves.pairs import ValvePair
from core.valves.timing import ValveTiming

ACROSS = "Crank angle from TDC of overlap, °"
MARKS = ((-180.0, "BDC"), (0.0, "TDC"), (180.0, "BDC"))
CYCLE = 720.0
ANGLES = 1441  # of a cycle, with both ends


def crank_plots(pair: ValvePair) -> tuple[Plot, Plot, Plot]:
    """Lift of both valves, or of the lobes of valves that are not moved directly, velocity and acceleration of the lobes."""
    is_direct = pair.inlet.is_direct and pair.exhaust.is_direct
    rows: tuple[tuple[str, Callable[[ValveTiming, np.ndarray], np.ndarray]], ...] = (
        ("Valve lift, mm", ValveTiming.valve_lift) if is_direct else ("Lobe lift, mm", ValveTiming.lobe_lift),
        ("Velocity, mm/° of the cam", partial(ValveTiming.lobe_derivative, order=1)),
        ("Acceleration, mm/°²", partial(ValveTiming.lobe_derivative, order=2)),
    )
    crank = np.linspace(-0.5 * CYCLE, 0.5 * CYCLE, ANGLES)
    lift, velocity, acceleration = (
        Plot(
            ACROSS,
            title,
            tuple(
                PlotCurve(crank, values(timing, crank), timing.name, row)
                for row, timing in enumerate((pair.inlet, pair.exhaust))
            ),
            MARKS,
            quiet=True,
        )
        for title, values in rows
    )
    return lift, velocity, acceleration
