"""The wheels of second inputs: where their pitch circles are, and how large."""

from __future__ import annotations

from collections.abc import Iterator

from core.design import FRAME_LINK, Linkage
from core.design.linkage import BELT, GEAR, INTERNAL
from core.design.topology import INPUT, driver_pair, is_pin, solving_order
from core.frozen import frozen


@frozen
class Wheel:
    """A pitch circle: the link that it is fixed to, the point of that link at its centre, its radius [mm]."""

    link: int
    point: str
    radius: float


@frozen
class WheelPair:
    """Two wheels that roll on each other, or carry a belt; carrier: the link on which both their centres are."""

    kind: str
    first: Wheel
    second: Wheel
    carrier: int


def apart(pair: WheelPair, linkage: Linkage) -> float:
    """How far the pitch circles are from touching [mm], less than 0 where they cross; of a belt only how far its pulleys cross."""
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
    if pivot is None or not is_pin(pivot):
        return
    pins = {step.links[0]: step.joint for step in solving_order(linkage).steps if step.kind == INPUT}
    driver = linkage.driver.link
    for each in linkage.drivers:
        radii = each.pitch_radii
        if radii is None or each.on not in (FRAME_LINK, driver) or each.link not in pins:
            continue
        first = Wheel(driver if each.on == FRAME_LINK else FRAME_LINK, pivot, radii[0])
        yield WheelPair(each.kind or GEAR, first, Wheel(each.link, pins[each.link], radii[1]), each.on)


__all__ = ["Wheel", "WheelPair", "apart", "wheel_pairs"]
