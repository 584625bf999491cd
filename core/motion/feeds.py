"""Motions to begin with that need no mechanism: an indexer, which goes on from stop to stop, and a flying shear, which runs along with its
material and comes back."""

from __future__ import annotations

from core.design.fields import choice, number, whole
from core.design.linkage import MOTION_SPEED
from core.design.parts import OUTPUT_LOADS, Motion, NamedCurve, Output, Segment, Shaft
from core.design.rules import CLOSING
from core.design.whole import Design, Drive
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.laws import LAWS

REST_TO_REST = tuple(slug for slug, law in LAWS.items() if law.symmetric and not law.rises)
LEAST_RAMP = 0.5  # [deg] that a flying shear must have left to speed up in
ASSUMED = ("shaft.rotation",)


@frozen(kw_only=True)
class Indexer:
    """stops: of a whole turn of the table; index_deg, dwell_deg: of the shaft, for a step and a rest."""

    stops: int = whole("Stops", 1, 1000, default=6, help="of a whole turn of the table")
    index_deg: float = number("Index angle", 1.0, 360.0, default=270.0, step=5.0, help="of the shaft, for one step")
    dwell_deg: float = number("Dwell", 0.0, 359.0, default=90.0, step=5.0, help="of the shaft, at each stop")
    law: str = choice("Law", REST_TO_REST, default="modified-sine")
    speed_rpm: float = number("Speed", 0.0, 1e5, open_low=True, default=MOTION_SPEED, step=5.0, help="of the shaft")


@frozen(kw_only=True)
class FlyingShear:
    """length_mm: of a cut, which the material runs in a turn of the shaft; window_deg: over which the shear runs with it; return_deg: for
    the way back. Speeding up and slowing down share what is left."""

    length_mm: float = number("Length", 0.0, 1e6, open_low=True, default=500.0, step=10.0, help="of a cut, a turn")
    window_deg: float = number("Synchronous window", 1.0, 357.0, default=60.0, step=5.0, help="at the material's speed")
    return_deg: float = number("Return", 1.0, 357.0, default=160.0, step=5.0, help="for the way back")
    law: str = choice("Law of the return", REST_TO_REST, default="modified-sine")
    speed_rpm: float = number("Speed", 0.0, 1e5, open_low=True, default=MOTION_SPEED, step=5.0, help="cuts a minute")


def indexer(wanted: Indexer) -> Design:
    """Steps of 360°/stops, a whole number of them in a turn of the shaft. Raises DesignError where no whole number fits."""
    cycle = wanted.index_deg + wanted.dwell_deg
    steps = round(360.0 / cycle)
    if steps < 1 or abs(steps * cycle - 360.0) > CLOSING:
        raise _refused("dwell_deg", wanted.dwell_deg, f"index angle and dwell make {cycle:g} deg",
                       "360 deg, or a half, a third ... of it")  # fmt: skip
    step = Segment(wanted.index_deg, 360.0 / wanted.stops, NamedCurve(wanted.law))
    rest = (Segment(wanted.dwell_deg, 0.0),) if wanted.dwell_deg else ()
    motion = Motion(0.0, (step, *rest) * steps, "deg", steps * 360.0 / wanted.stops)
    return _axis(f"Indexer of {wanted.stops} stops", motion, wanted.speed_rpm)


def flying_shear(wanted: FlyingShear) -> Design:
    """C1 - CV1 - C2 and a return: half a cycloid up to the material's speed v = length/360°, of height v β/2, that speed over the window,
    half a cycloid to rest. Raises DesignError where nothing is left to speed up in."""
    ramp = 0.5 * (360.0 - wanted.window_deg - wanted.return_deg)
    if ramp < LEAST_RAMP:
        raise _refused("return_deg", wanted.return_deg, f"leaves {2.0 * ramp:g} deg to speed up and to slow down",
                       f"at most {360.0 - wanted.window_deg - 2.0 * LEAST_RAMP:g} deg beside this window")  # fmt: skip
    v = wanted.length_mm / 360.0
    rises = (
        (ramp, 0.5 * v * ramp, "c1"),
        (wanted.window_deg, v * wanted.window_deg, "cv1"),
        (ramp, 0.5 * v * ramp, "c2"),
    )
    back = (wanted.return_deg, -sum(rise for _, rise, _ in rises), wanted.law)
    segments = tuple(Segment(span, rise, NamedCurve(law)) for span, rise, law in (*rises, back))
    return _axis("Flying shear", Motion(0.0, segments), wanted.speed_rpm)


def _axis(name: str, motion: Motion, speed: float) -> Design:
    drive = Drive(motion, Output(motion.unit), None, OUTPUT_LOADS[motion.unit]())
    return Design(name, Shaft("ccw", speed), (drive,), ASSUMED)


def _refused(field: str, value: float, problem: str, allowed: str) -> DesignError:
    return DesignError([Fault(field, value, problem, allowed)])


__all__ = ["REST_TO_REST", "FlyingShear", "Indexer", "flying_shear", "indexer"]
