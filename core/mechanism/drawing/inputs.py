"""Second inputs of a linkage that is drawn: links that follow the driver by a ratio, and where they stand with it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from core.design.linkage import FRAME_LINK, NO_DRIVER, Linkage, SecondDriver
from core.design.topology import pins
from core.design.whole import Design, with_drive
from core.mechanism.drawing.sheet import (
    DECIMALS,
    Places,
    degrees_of,
    fault,
    heading_of,
    places_of,
    pose_of,
    with_places,
)
from core.mechanism.solving import at_driver
from core.motion import at_turn, program

GEARED = -1.0
"""Ratio of a new second input: two wheels as large as each other."""
_SAME_DEG = 1e-7  # a second input this near to where its ratio and offset say stands there


def with_second_input(design: Design, number: int) -> Design:
    """A link that follows the driver by a ratio, from where it is drawn: measured against the frame, where a pin holds it there, else
    against the link whose pin carries it, the driver's where it has one."""
    linkage = design.drive.linkage
    if linkage.driver == NO_DRIVER:
        raise fault("nothing drives yet", "a driver first, which the second input follows")
    taken = {FRAME_LINK, linkage.driver.link, *(each.link for each in linkage.drivers)}
    if number in taken or number not in linkage.by_number:
        raise fault(
            f"link {number} is driven already" if number in taken else "no link there", "another link, held by a pin"
        )
    beside = {n for pin in pins(linkage) if number in pin.links for n in pin.links} - {number}
    if not beside:
        raise fault(f"no pin holds link {number}", "a link on a pin")
    on = next((n for n in (FRAME_LINK, linkage.driver.link) if n in beside), min(beside))
    row = SecondDriver(link=number, on=on, ratio=GEARED)
    return with_places(design, places_of(linkage), replace(linkage, drivers=(*linkage.drivers, row)))


def input_pin(linkage: Linkage, second: SecondDriver) -> str:
    """The pin about which a second input turns its link: on the link that it is measured against, else the first that holds it."""
    held = [pin for pin in pins(linkage) if second.link in pin.links]
    return next((pin.name for pin in held if second.on in pin.links), held[0].name if held else "")


def with_input_values(design: Design, index: int, row: SecondDriver, offset_deg: float | None = None) -> Design:
    """The second input of this number with other values: a ratio that only its wheels say is left to them. offset_deg: as typed,
    and the drawing follows; else it is what holds the link where it is drawn."""
    from core.mechanism.drawing.settling import settled

    linkage = design.drive.linkage
    said = row.ratio_by(linkage.driver.link)
    if row.ratio is None and said is None and not row.motion:
        row = replace(row, ratio=linkage.drivers[index].ratio or GEARED)
    if row.ratio is not None and said is not None and abs(row.ratio - said) > 1e-12 * abs(said):
        raise fault(f"a ratio of {row.ratio:g}, and wheels of {said:.6g}", "the ratio or the wheels alone")
    rows = (*linkage.drivers[:index], row, *linkage.drivers[index + 1 :])
    made = with_places(design, places_of(linkage), replace(linkage, drivers=rows))
    if offset_deg is None:
        return made
    drawn = made.drive.linkage
    rows = tuple(replace(each, offset_deg=offset_deg) if each.link == row.link else each for each in drawn.drivers)
    return settled(with_drive(made, mechanism=replace(drawn, drivers=rows)))


def driver_turned(linkage: Linkage, places: Places, driver_deg: float) -> tuple[float, tuple[SecondDriver, ...]]:
    """The driver's angle [deg], by so many whole turns more as bring it where its second inputs stand, and these; one that no turn
    brings there gets the offset that does."""
    known = [each for each in linkage.drivers if each.link in linkage.ratios and _stand(linkage, each, places)]
    if not known:
        return driver_deg, linkage.drivers
    turns = (driver_deg + 360.0 * k for k in range(max(2, linkage.turns or 0)))
    at = next((q for q in turns if all(abs(_off(linkage, each, places, q)) < _SAME_DEG for each in known)), driver_deg)
    rows = tuple(
        replace(each, offset_deg=_round(each.offset_deg + off))
        if each in known and abs(off := _off(linkage, each, places, at)) >= _SAME_DEG
        else each
        for each in linkage.drivers
    )
    return at, rows


def _round(offset_deg: float) -> float:
    return round((offset_deg + 180.0) % 360.0 - 180.0, DECIMALS) + 0.0


def _stand(linkage: Linkage, each: SecondDriver, places: Places) -> bool:
    """Whether it is drawn how both links of a second input are turned."""
    return all(
        n == FRAME_LINK or sum(name in places for name in linkage.by_number[n].places) > 1
        for n in (each.link, each.on)
        if n in linkage.by_number
    ) and {each.link, each.on} <= set(linkage.by_number)


def _said(linkage: Linkage, each: SecondDriver, driver_deg: float) -> float:
    """The angle of a second input against what it is measured against [deg], by its ratio or its motion, and its offset."""
    motion = linkage.own_motions.get(each.link)
    if motion is None:
        return linkage.ratios[each.link] * driver_deg + each.offset_deg
    there = at_turn(program(motion), at_driver(np.deg2rad([driver_deg])))[0]
    return float(np.rad2deg(there[0])) + each.offset_deg


def _off(linkage: Linkage, each: SecondDriver, places: Places, driver_deg: float) -> float:
    """How much farther a second input is turned than its ratio or motion and its offset say [deg], -180 ... 180."""
    (_, axis), (_, base) = (pose_of(linkage, n, places) for n in (each.link, each.on))
    said = _said(linkage, each, driver_deg)
    return (degrees_of(axis * base.conjugate()) - said + 180.0) % 360.0 - 180.0


def second_inputs_set(
    linkage: Linkage, places: dict[str, complex], fixed: Collection[str]
) -> tuple[dict[str, complex], set[str]]:
    """The places with every second input turned as the driver's drawn angle says, its pin being where one of the fixed points is; and
    the points fixed then."""
    drawn, fixed = linkage.drawn, set(fixed)
    if drawn is None or drawn.driver_deg is None:
        return places, fixed
    places, left = dict(places), [each for each in linkage.drivers if each.link in linkage.ratios]
    held = lambda each: next((n for n in linkage.by_number[each.link].places if n in fixed), None)  # noqa: E731
    stands = lambda n: n == FRAME_LINK or set(linkage.by_number[n].places) <= fixed  # noqa: E731
    while ready := [each for each in left if stands(each.on) and held(each) is not None]:
        for each in ready:
            pin, own = held(each), linkage.by_number[each.link].places
            assert pin is not None
            said = _said(linkage, each, drawn.driver_deg)
            axis = heading_of((said + 180.0) % 360.0 - 180.0) * pose_of(linkage, each.on, places)[1]
            centre = places[pin]
            places |= {name: centre + (at - own[pin]) * axis for name, at in own.items()}
            fixed |= set(own)
        left = [each for each in left if each not in ready]
    return places, fixed


__all__ = ["driver_turned", "input_pin", "second_inputs_set", "with_input_values", "with_second_input"]
