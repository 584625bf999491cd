"""The wheels of second inputs: where their pitch circles are, and how large."""

from __future__ import annotations

from collections.abc import Iterator
from math import radians

from core.design import FRAME_LINK, Linkage
from core.design.linkage import BELT, GEAR, INTERNAL, RACK, SecondDriver
from core.design.topology import INPUT, driver_pair, input_slides, is_pin, solving_order
from core.frozen import frozen
from core.numerics.vectors import heading


@frozen
class Wheel:
    """A pitch circle: the link that it is fixed to, the point of that link at its centre, its radius [mm]; of a rack 0, and no point."""

    link: int
    point: str
    radius: float


@frozen
class WheelPair:
    """Two wheels that roll on each other, or carry a belt; carrier: the link on which both their centres are. along: the way in which a
    rack, the second, goes where its pinion turns counter-clockwise, in the frame of the carrier."""

    kind: str
    first: Wheel
    second: Wheel
    carrier: int
    along: complex = 0j

    @property
    def round(self) -> tuple[Wheel, ...]:
        """Those that are circles."""
        return tuple(wheel for wheel in (self.first, self.second) if wheel.radius)


def apart(pair: WheelPair, linkage: Linkage) -> float:
    """How far the pitch circles are from touching [mm], less than 0 where they cross; of a belt only how far its pulleys
    cross. A rack lies where its pinion is."""
    if pair.kind == RACK:
        return 0.0
    places = linkage.by_number[pair.carrier].places
    distance = abs(places[pair.second.point] - places[pair.first.point])
    one, other = pair.first.radius, pair.second.radius
    if pair.kind == INTERNAL:
        return abs(one - other) - distance
    return min(distance - one - other, 0.0) if pair.kind == BELT else distance - one - other


def wheel_pairs(linkage: Linkage) -> Iterator[WheelPair]:
    """The wheels of every second input whose radii follow from radius_mm, or from teeth and a module: the first turns with the
    driver, or stands on the frame where the driver's link carries the second."""
    pivot = driver_pair(linkage)
    if pivot is None:
        return
    pins = {step.links[0]: step.joint for step in solving_order(linkage).steps if step.kind == INPUT}
    driver = linkage.driver.link
    for each in linkage.drivers:
        radii = each.pitch_radii
        if radii is not None and each.kind == RACK:
            yield from _rack(linkage, each, pivot, pins.get(each.link, ""), radii)
            continue
        if radii is None or not is_pin(pivot) or each.on not in (FRAME_LINK, driver) or each.link not in pins:
            continue
        first = Wheel(driver if each.on == FRAME_LINK else FRAME_LINK, pivot, radii[0])
        yield WheelPair(each.kind or GEAR, first, Wheel(each.link, pins[each.link], radii[1]), each.on)


def _rack(
    linkage: Linkage, row: SecondDriver, driving: str, driven: str, radii: tuple[float, float]
) -> Iterator[WheelPair]:
    """The pinion of a rack that slides along a line of the link that carries both: the driver's wheel, or that of the second input."""
    slides = input_slides(linkage, row)
    rack, pin = (row.link, driving) if slides else (linkage.driver.link, driven)
    lines = [s for s in linkage.sliders if (s.link, s.on) == (rack, row.on)]
    if not lines or not pin or not is_pin(pin) or pin not in linkage.by_number[row.on].places:
        return
    turns = (linkage.driver.link if row.on == FRAME_LINK else FRAME_LINK) if slides else row.link
    sense = -1.0 if linkage.ratios[row.link] < 0.0 else 1.0
    along = heading(radians(lines[0].angle_deg)) * sense
    yield WheelPair(RACK, Wheel(turns, pin, max(radii)), Wheel(rack, "", 0.0), row.on, along)


__all__ = ["Wheel", "WheelPair", "apart", "wheel_pairs"]
