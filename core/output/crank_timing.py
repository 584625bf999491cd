"""Valve lifts over the crank as numbers: a curve for each drive that moves a valve, and the overlap of inlet and exhaust."""

from __future__ import annotations

from contextlib import suppress
from math import cos, radians

import numpy as np

from core.design import Design
from core.design.engine import HALF_CYCLE, PARALLEL, within_cycle
from core.errors import NoSolution
from core.frozen import frozen
from core.study import Study, names_of, quantity
from core.study.valve_findings import least_clearance
from core.valves import LobeEdge, ValvePair, ValveTiming, lobe_edges, valve_pairs, valve_timings
from core.valves.timing import CRANK_ANGLES, MM

VALVE_LIFT, LOBE_LIFT = "valve lift", "lobe lift"


@frozen(eq=False)
class CrankCurve:
    """Lift of a valve over the crank of the engine.

    Attributes
    ----------
    drive : number of the drive
    timing : its timing
    crank : (n,) crank angles from TDC of overlap of the first cylinder, -360 to 360, ascending [deg]
    quantity : what the lift is: ``valve lift``, or ``lobe lift`` where the motion of the valve is not known
    lift : (n,) [mm]
    centre : crank angle of the greatest lift, -360 to 360 [deg]
    clearance : (n,) distance between valve and piston, None without [mm]
    piston : (n,) lift at which the valve would touch the piston, None without [mm]
    edges : edges of the lobe at its typed rows, each with its crank angle and lift in the curve
    """

    drive: int
    timing: ValveTiming
    crank: np.ndarray
    quantity: str
    lift: np.ndarray
    centre: float
    edges: tuple[tuple[LobeEdge, float, float], ...]
    clearance: np.ndarray | None = None
    piston: np.ndarray | None = None

    @property
    def least_clearance(self) -> float | None:
        """Least distance between valve and piston, refined [mm]."""
        least = None if self.clearance is None else least_clearance(Study(self.timing.design))
        return None if least is None else MM * least.value


def crank_curves(design: Design) -> tuple[CrankCurve, ...]:
    """Lifts of all valves of a design, in the order of its drives. Raises KindynaError where no drive moves a valve."""
    return tuple(map(_curve, valve_timings(design)))


def _curve(timing: ValveTiming) -> CrankCurve:
    later = timing.valve.cylinder_deg
    edges = [(edge, within_cycle(edge.crank_deg + later)) for edge in lobe_edges(timing)]
    centre = within_cycle(timing.centre + later)
    crank = np.unique([*np.linspace(-HALF_CYCLE, HALF_CYCLE, CRANK_ANGLES), centre, *(angle for _, angle in edges)])
    name, lift = _lift(timing, crank - later)
    clearance = _clearance(timing, crank - later)
    piston = None if clearance is None else lift + clearance / _along_valve(timing)
    for array in (crank, lift):
        array.setflags(write=False)
    points = tuple((edge, angle, float(lift[np.searchsorted(crank, angle)])) for edge, angle in edges)
    return CrankCurve(timing.number, timing, crank, name, lift, centre, points, clearance, piston)


def _lift(timing: ValveTiming, crank: np.ndarray) -> tuple[str, np.ndarray]:
    """Name and values [mm] of the lift at crank angles (n,) from TDC of overlap of the cylinder [deg]."""
    if timing.has_valve_lift:
        with suppress(NoSolution):
            return VALVE_LIFT, timing.valve_lift(crank)
    return LOBE_LIFT, timing.lobe_lift(crank)


def _clearance(timing: ValveTiming, crank: np.ndarray) -> np.ndarray | None:
    """Distance between valve and piston at crank angles (n,) from TDC of overlap of the cylinder [deg], in mm."""
    if "piston_clearance" not in names_of(timing.design):
        return None
    try:
        return quantity("piston_clearance").values(Study(timing.design).at_theta(timing.cam_angle(crank)))
    except NoSolution:
        return None


def _along_valve(timing: ValveTiming) -> float:
    """Change of the clearance per lift of the valve: a flat crown is measured along the cylinder's axis."""
    return 1.0 if timing.valve.pocket == PARALLEL else cos(radians(timing.valve.angle_deg or 0.0))


def crank_pairs(curves: tuple[CrankCurve, ...]) -> tuple[tuple[CrankCurve, CrankCurve, ValvePair], ...]:
    """Inlet and exhaust valve of every cylinder that has both."""
    by_timing = {curve.timing: curve for curve in curves}
    pairs = valve_pairs([curve.timing for curve in curves])
    return tuple((by_timing[pair.inlet], by_timing[pair.exhaust], pair) for pair in pairs)
