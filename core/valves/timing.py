"""Timing of one valve: lift of its lobe and of the valve over the crank, and the angles at which it passes a lift.

Lobe lift is the motion of the drive above its lowest position; valve lift is that of the valve, with the lash taken off.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import TYPE_CHECKING

import numpy as np

from core.design import Design, Valve, drive_names, nose_deg, only
from core.design.engine import CRANK_PER_CAM, within_cycle
from core.errors import KindynaError
from core.frozen import frozen
from core.motion import Angles, CompiledMotion, program
from core.numerics.derivatives import Derivatives
from core.numerics.lazy import lazy
from core.numerics.roots import BracketEnds, bracketed_root
from core.study import Study
from core.study.valve_travel import ValveTravel

if TYPE_CHECKING:
    from core.design import Motion

MM = 1e3
CRANK_ANGLES = 1441  # of a cycle drawn over the crank, with both ends
LIFTS = (0.1524, 1.27, 1.0)
"""Lifts at which events are given by default [mm]: 0.006 and 0.050 inch, and 1 mm."""
LOBE, VALVE = "lobe", "valve"


@frozen
class Event:
    """Opening and closing at a lift.

    Attributes
    ----------
    of : ``lobe`` or ``valve``
    at_mm : lift [mm]
    opens_deg, closes_deg : crank angles from TDC of overlap of the cylinder [deg]
    """

    of: str
    at_mm: float
    opens_deg: float
    closes_deg: float

    @property
    def duration_deg(self) -> float:
        """Duration [crank deg]."""
        return self.closes_deg - self.opens_deg


class ValveTiming:
    """Timing of the valve of one drive.

    Attributes
    ----------
    design : the drive as a design by itself
    name, number : of the drive
    valve, motion : valve and motion as typed
    """

    def __init__(self, design: Design, name: str, number: int) -> None:
        drive = design.drive
        assert drive.valve is not None, "the drive moves no valve"
        assert drive.motion is not None, "the rules of a design require a motion"
        self.design, self.name, self.number = design, name, number
        self.valve: Valve = drive.valve
        self.motion: Motion = drive.motion

    @lazy
    def compiled(self) -> CompiledMotion:
        """The compiled motion."""
        return program(self.motion)

    @property
    def centre(self) -> float:
        """Crank angle of the nose from TDC of overlap [deg]."""
        return self.valve.centre_deg

    @property
    def cylinder(self) -> float:
        """Crank angle by which the cylinder's TDC of overlap comes later, -360 to 360 [deg]: equal of one cylinder."""
        return float(within_cycle(self.valve.cylinder_deg))

    @lazy
    def nose(self) -> float:
        """Cam angle of the nose [deg]."""
        return nose_deg(self.motion)

    @lazy
    def base(self) -> float:
        """Lowest position of the motion [mm]."""
        return self.compiled.position_range[0] * MM

    @lazy
    def travel(self) -> ValveTravel:
        """Travel of the valve."""
        return Study(self.design).valve

    @property
    def has_lobe_lift(self) -> bool:
        """Whether the motion is a lift in mm, not the angle of a lever."""
        return self.motion.unit == "mm"

    @lazy
    def train_error(self) -> KindynaError | None:
        """Why the train does not open the valve; None where it does."""
        if self.design.drive.is_alone:
            return None
        try:
            if self.design.drive.is_valve_motion:
                _ = [self.travel.at(y) for y in self.compiled.position_range]
            else:
                self.travel.lash  # noqa: B018
        except KindynaError as error:
            return error
        return None

    @property
    def has_valve_lift(self) -> bool:
        """Whether the motion is that of the valve, or the train between them opens it."""
        return self.design.drive.is_valve_motion or self.train_error is None

    def lobe_lift_at(self, travel: float) -> float:
        """Lobe lift [mm] at which the valve has moved by a travel [mm], the lash included; infinite where it never does."""
        if self.design.drive.is_valve_motion:
            return travel
        return self.travel.motion_at(travel / MM) * MM - self.base

    def cam_angle(self, crank: np.ndarray) -> np.ndarray:
        """Cam angle at crank angles from TDC of overlap.

        Parameters
        ----------
        crank : ndarray (n,) [deg]

        Returns
        -------
        ndarray (n,) [rad]
        """
        return np.deg2rad(self.nose + (np.asarray(crank) - self.centre) / CRANK_PER_CAM)

    def crank_angle(self, from_nose: float) -> float:
        """Crank angle from TDC of overlap [deg] at a cam angle from the nose [deg]."""
        return self.centre + CRANK_PER_CAM * from_nose

    def lobe_lift(self, crank: np.ndarray) -> np.ndarray:
        """Lobe lift at crank angles from TDC of overlap.

        Parameters
        ----------
        crank : ndarray (n,) [deg]

        Returns
        -------
        ndarray (n,) [mm]
        """
        return self.compiled.state(self.compiled.angles(self.cam_angle(crank))).displacement[0] * MM - self.base

    def valve_lift(self, crank: np.ndarray) -> np.ndarray:
        """Lift of the valve at crank angles from TDC of overlap, the lash taken off.

        Parameters
        ----------
        crank : ndarray (n,) [deg]

        Returns
        -------
        ndarray (n,) [mm]
        """
        return np.maximum(self._valve_travel(crank)[0] * MM - self.valve.lash_mm, 0.0)

    def _valve_travel(self, crank: np.ndarray) -> Derivatives:
        """Travel of the valve (n,) [m] from where it is closed, and its derivatives by cam angle."""
        cam = self.cam_angle(crank)
        if self.design.drive.is_valve_motion:
            motion, closed = self.compiled.state(self.compiled.angles(cam)).displacement, self.base / MM
        else:
            study = Study(self.design).at_theta(cam)
            motion, closed = study.valve.position(study.linkage), self.travel.closed
        return Derivatives.of((motion[0] - closed, *(motion[order] for order in (1, 2, 3))))

    @lazy
    def greatest_lobe_lift(self) -> float:
        """Greatest lobe lift [mm]."""
        return float(self.lobe_lift(np.array([self.centre]))[0])

    @property
    def greatest_valve_lift(self) -> float:
        """Greatest lift of the valve [mm]."""
        return float(self.valve_lift(np.array([self.centre]))[0])

    def passes(self, lift: float) -> tuple[float, float] | None:
        """Crank angles at which the lobe passes a lift [mm], next to the nose on both sides [deg]; None where it does not."""
        compiled = self.compiled
        pieces = np.arange(compiled.starts.size)
        low, high = (
            compiled.state(Angles(ends, pieces)).displacement[0] * MM - self.base - lift
            for ends in (compiled.starts, compiled.ends)
        )
        before, after = [], []
        for k in np.flatnonzero((low < 0.0) & (high >= 0.0)).tolist():
            before.append((self.nose - degrees(self._crossing(k, low[k], high[k], lift))) % 360.0)
        for k in np.flatnonzero((low >= 0.0) & (high < 0.0)).tolist():
            after.append((degrees(self._crossing(k, low[k], high[k], lift)) - self.nose) % 360.0)
        if not before or not after:
            return None
        return self.crank_angle(-min(before)), self.crank_angle(min(after))

    def _crossing(self, piece: int, low: float, high: float, lift: float) -> float:
        """Cam angle [rad] at which a piece of the motion passes a lift [mm]."""
        at = np.array([piece])

        def error(theta: float) -> float:
            state = self.compiled.state(Angles(np.array([theta]), at))
            return float(state.displacement[0][0]) * MM - self.base - lift

        start, end = float(self.compiled.starts[piece]), float(self.compiled.ends[piece])
        ends = bracketed_root(error, BracketEnds(start, low, end, high))
        return ends.a if abs(ends.fa) < abs(ends.fb) else ends.b

    def event(self, of: str, lift: float) -> Event | None:
        """Opening and closing at a lift [mm] of the lobe or the valve; None where it does not pass this lift, or has none."""
        if not (self.has_valve_lift if of == VALVE else self.has_lobe_lift):
            return None
        if of == VALVE:
            lift_of_lobe = self.lobe_lift_at(lift + self.valve.lash_mm)
        ends = self.passes(lift_of_lobe if of == VALVE else lift)
        return None if ends is None else Event(of, lift, *ends)

    def duration(self, lift: float) -> float | None:
        """Duration of the lobe at a lift [crank deg]."""
        event = self.event(LOBE, lift)
        return None if event is None else event.duration_deg

    @lazy
    def velocities_at_lash(self) -> tuple[float, float] | None:
        """Velocities of the valve [mm/s], positive, at which it opens and seats; None where it never closes."""
        if not self.has_valve_lift:
            return None
        if self.valve.lash_mm == 0.0:
            return 0.0, 0.0
        ends = self.passes(self.lobe_lift_at(self.valve.lash_mm))
        if ends is None:
            return None
        velocity = self._valve_travel(np.array(ends))[1] * MM * self.design.speed_rpm * np.pi / 30.0
        return abs(float(velocity[0])), abs(float(velocity[1]))


def valve_timings(design: Design) -> tuple[ValveTiming, ...]:
    """Timings of all drives of a design that move a valve.

    Raises
    ------
    KindynaError
        No drive moves a valve.
    """
    rows = [
        ValveTiming(only(design, i), name, i)
        for i, (name, drive) in enumerate(zip(drive_names(design), design.drives, strict=True))
        if drive.valve is not None
    ]
    if not rows:
        raise KindynaError("valve: no drive of this design moves a valve; allowed: one with [valve] and [engine]")
    return tuple(rows)


def require_opening(timings: Sequence[ValveTiming]) -> None:
    """Require that the trains open their valves. Raises KindynaError for the first one that does not."""
    for error in filter(None, (timing.train_error for timing in timings)):
        raise error
