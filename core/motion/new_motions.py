"""Motions that begin a design without a mechanism: an indexing table, a flying shear."""

from __future__ import annotations

from core.design import Motion, NamedCurve, Segment
from core.design.design import Design, Drive
from core.design.fields import choice, number, whole
from core.design.linkage import MOTION_SPEED
from core.design.parts import OUTPUT_LOADS, Output, Shaft
from core.design.rules import CLOSING
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.laws import LAWS

REST_TO_REST = tuple(slug for slug, law in LAWS.items() if law.is_symmetric and not law.rises)
LEAST_RAMP = 0.5  # [deg] shortest acceleration of a flying shear
ASSUMED = ("shaft.rotation",)


@frozen(kw_only=True)
class Indexer:
    """Inputs of an indexing table: stops per turn of the table; index and dwell angle of the shaft per step."""

    stops: int = whole("Stops", 1, 1000, default=6, help="per turn of the table")
    index_deg: float = number("Index angle", 1.0, 360.0, default=270.0, step=5.0, help="of the shaft, per step")
    dwell_deg: float = number("Dwell", 0.0, 359.0, default=90.0, step=5.0, help="of the shaft, per stop")
    law: str = choice("Law", REST_TO_REST, default="modified-sine")
    speed_rpm: float = number("Speed", 0.0, 1e5, open_low=True, default=MOTION_SPEED, step=5.0, help="of the shaft")


@frozen(kw_only=True)
class FlyingShear:
    """Inputs of a flying shear: cut length per turn of the shaft, synchronous window, return.

    Acceleration and deceleration share the remaining angle equally.
    """

    length_mm: float = number(
        "Length", 0.0, 1e6, open_low=True, default=500.0, step=10.0, help="of a cut; one cut per turn"
    )
    window_deg: float = number("Synchronous window", 1.0, 357.0, default=60.0, step=5.0, help="at the material's speed")
    return_deg: float = number("Return angle", 1.0, 357.0, default=160.0, step=5.0, help="of the shaft")
    law: str = choice("Law of the return", REST_TO_REST, default="modified-sine")
    speed_rpm: float = number("Speed", 0.0, 1e5, open_low=True, default=MOTION_SPEED, step=5.0, help="cuts per minute")


def indexer(inputs: Indexer) -> Design:
    """Design of an indexer: steps of 360°/stops, an integer number of them per turn of the shaft.

    Raises DesignError where the turn is no integer multiple of index angle plus dwell.
    """
    cycle = inputs.index_deg + inputs.dwell_deg
    steps = round(360.0 / cycle)
    if steps < 1 or abs(steps * cycle - 360.0) > CLOSING:
        raise _refused("dwell_deg", inputs.dwell_deg, f"index angle and dwell add up to {cycle:g} deg",
                       "360 deg, or a half, a third ... of it")  # fmt: skip
    step = Segment(inputs.index_deg, 360.0 / inputs.stops, NamedCurve(inputs.law))
    dwell = (Segment(inputs.dwell_deg, 0.0),) if inputs.dwell_deg else ()
    motion = Motion(0.0, (step, *dwell) * steps, "deg", steps * 360.0 / inputs.stops)
    return _axis(f"Indexer of {inputs.stops} stops", motion, inputs.speed_rpm)


def flying_shear(inputs: FlyingShear) -> Design:
    """Design of a flying shear: C1 - CV1 - C2 and a return.

    C1 and C2 are half cycloids of span β and height v β/2, CV1 runs at the material's speed v = length/360°. Raises
    DesignError where the angle left for C1 and C2 is too short.
    """
    ramp = 0.5 * (360.0 - inputs.window_deg - inputs.return_deg)
    if ramp < LEAST_RAMP:
        raise _refused("return_deg", inputs.return_deg, f"leaves {2.0 * ramp:g} deg to accelerate and to decelerate",
                       f"at most {360.0 - inputs.window_deg - 2.0 * LEAST_RAMP:g} deg with this window")  # fmt: skip
    v = inputs.length_mm / 360.0
    rises = (
        (ramp, 0.5 * v * ramp, "c1"),
        (inputs.window_deg, v * inputs.window_deg, "cv1"),
        (ramp, 0.5 * v * ramp, "c2"),
    )
    back = (inputs.return_deg, -sum(rise for _, rise, _ in rises), inputs.law)
    segments = tuple(Segment(span, rise, NamedCurve(law)) for span, rise, law in (*rises, back))
    return _axis("Flying shear", Motion(0.0, segments), inputs.speed_rpm)


def _axis(name: str, motion: Motion, speed: float) -> Design:
    drive = Drive(motion, Output(motion.unit), None, OUTPUT_LOADS[motion.unit]())
    return Design(name, Shaft("ccw", speed), (drive,), ASSUMED)


def _refused(field: str, value: float, problem: str, allowed: str) -> DesignError:
    return DesignError([Fault(field, value, problem, allowed)])
