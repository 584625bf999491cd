"""The part of an unfinished drawing that its driver leads, as it moves; the rest hangs on it."""

from __future__ import annotations

import numpy as np

from core.design import CRANK, Design
from core.errors import KindynaError
from core.frozen import frozen
from core.mechanism.assembly import solve_mechanism
from core.mechanism.drawing.settling import closed
from core.mechanism.drawing.sheet import Places, frame_of, places_of
from core.mechanism.drawn import drawn_place
from core.mechanism.driver_ranges import DriverRanges, driver_ranges_of
from core.mechanism.driving import CrankProgram, swept
from core.mechanism.mechanism import Mechanism, body_name, mechanism_of
from core.mechanism.unfinished import Unfinished, led_part
from core.motion import Program, program

_AS_DRAWN = 1e-9  # rad or m: the driver stands where it is drawn


@frozen(eq=False)
class LedPart:
    """What moves with the driver of a drawing that is no mechanism yet."""

    design: Design
    mechanism: Mechanism
    ranges: DriverRanges
    runs: CrankProgram | Program

    @property
    def drawn_theta(self) -> float | None:
        """The angle [rad] of the crank, or of the cycle, at which the driver stands as it is drawn; None of one that follows a motion."""
        drawn = self.mechanism.linkage.drawn
        return self.runs.theta(drawn_place(drawn)) if drawn and isinstance(self.runs, CrankProgram) else None

    def places(self, theta: float) -> Places:
        """Where all points stand [mm] at an angle [rad] of the crank, the cycle or the cam.

        Those of the rest are moved from where they are drawn, as little as need be.
        """
        linkage, part = self.design.drive.linkage, self.mechanism.linkage
        as_drawn = places_of(linkage)
        state = self.runs.state(self.runs.angles(np.array([theta])))
        if linkage.drawn and abs(float(state.displacement[0][0]) - drawn_place(linkage.drawn)) < _AS_DRAWN:
            return as_drawn
        kinematics = solve_mechanism(self.mechanism, state, self.ranges)
        fixed = frame_of(linkage).places
        led = {
            name: complex(kinematics.bodies[body_name(link.number)].place(name)[0]) * 1e3
            for link in part.links
            for name in link.places
            if name not in fixed
        }
        places = {**as_drawn, **led}
        try:
            return closed(linkage, places, {*fixed, *led})
        except KindynaError:  # the rest does not reach: it stays where it is drawn
            return places


def led_part_of(design: Design, lack: Unfinished) -> LedPart | None:
    """What moves with the driver of an unfinished drawing; None where nothing does."""
    part = led_part(design.drive.linkage, lack)
    if part is None or part.drawn is None:
        return None
    motion, crank = design.drive.motion, part.driver.kind == CRANK
    if not crank and motion is None:
        return None
    try:
        ranges = driver_ranges_of(part) if crank else driver_ranges_of(part, *swept(program(motion)))
    except KindynaError:
        return None
    if not ranges.ranges:
        return None
    return LedPart(design, mechanism_of(part), ranges, CrankProgram(ranges) if crank else program(motion))


__all__ = ["LedPart", "led_part_of"]
