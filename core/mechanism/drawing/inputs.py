"""Second inputs of a linkage that is drawn: links that follow the driver by a ratio, and where they stand with it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from core.design.linkage import FRAME_LINK, NO_DRIVER, RACK, Linkage, SecondDriver
from core.design.topology import driver_turns, input_slides, pins
from core.design.whole import Design, with_drive
from core.mechanism.drawing.sheet import (
    DECIMALS,
    Places,
    degrees_of,
    fault,
    heading_of,
    line_of_slider,
    places_of,
    pose_of,
    with_places,
)
from core.mechanism.solving import at_driver
from core.motion import at_turn, program

GEARED = -1.0
"""Ratio of a new second input: two wheels as large as each other."""
RACKED = 1.0
"""[mm per degree] of a new rack."""
_SAME_DEG = 1e-7  # a second input this near to where its ratio and offset say stands there


def with_second_input(design: Design, number: int) -> Design:
    """A link that follows the driver by a ratio, from where it is drawn: measured against the frame, where a pin holds it there, else
    against the link whose pin carries it, the driver's where it has one. A link that slides does so along its line, as a rack."""
    linkage = design.drive.linkage
    if linkage.driver == NO_DRIVER:
        raise fault("nothing drives yet", "a driver first, which the second input follows")
    taken = {FRAME_LINK, linkage.driver.link, *(each.link for each in linkage.drivers)}
    if number in taken or number not in linkage.by_number:
        raise fault(
            f"link {number} is driven already" if number in taken else "no link there", "another link, held by a pin"
        )
    sliding = next((s for s in linkage.sliders if s.link == number), None)
    if sliding is not None and sliding.on in (FRAME_LINK, linkage.driver.link):
        rack = SecondDriver(link=number, on=sliding.on, ratio=RACKED)
        return with_places(design, places_of(linkage), replace(linkage, drivers=(*linkage.drivers, rack)))
    beside = {n for pin in pins(linkage) if number in pin.links for n in pin.links} - {number}
    if not beside:
        raise fault(f"no pin holds link {number}", "a link on a pin")
    on = next((n for n in (FRAME_LINK, linkage.driver.link) if n in beside), min(beside))
    row = SecondDriver(link=number, on=on, ratio=GEARED)
    return with_places(design, places_of(linkage), replace(linkage, drivers=(*linkage.drivers, row)))


def input_pin(linkage: Linkage, second: SecondDriver) -> str:
    """The pin about which a second input turns its link: on the link that it is measured against, else the first that holds it; of what
    slides without one its first point."""
    held = [pin for pin in pins(linkage) if second.link in pin.links]
    at = next((pin.name for pin in held if second.on in pin.links), held[0].name if held else "")
    return at or next(iter(linkage.by_number[second.link].places), "")


def with_input_values(design: Design, index: int, row: SecondDriver, offset: float | None = None) -> Design:
    """The second input of this number with other values: a ratio that only its wheels say is left to them. offset: as typed [deg, or mm
    where it slides], and the drawing follows; else it is what holds the link where it is drawn."""
    from core.mechanism.drawing.settling import settled

    linkage = design.drive.linkage
    said = row.ratio_by(linkage.driver.link)
    if row.ratio is None and said is None and not row.motion:
        row = replace(row, ratio=linkage.drivers[index].ratio or GEARED)
    typed = abs(row.ratio) if row.kind == RACK and row.ratio is not None else row.ratio
    if row.ratio is not None and said is not None and abs((typed or 0.0) - said) > 1e-12 * abs(said):
        raise fault(f"a ratio of {row.ratio:g}, and wheels of {said:.6g}", "the ratio or the wheels alone")
    rows = (*linkage.drivers[:index], row, *linkage.drivers[index + 1 :])
    made = with_places(design, places_of(linkage), replace(linkage, drivers=rows))
    if offset is None:
        return made
    drawn = made.drive.linkage
    typed_row = replace(row, offset_mm=offset) if input_slides(drawn, row) else replace(row, offset_deg=offset)
    rows = tuple(typed_row if each.link == row.link else each for each in drawn.drivers)
    return settled(with_drive(made, mechanism=replace(drawn, drivers=rows)))


def driver_turned(linkage: Linkage, places: Places, driver: float) -> tuple[float, tuple[SecondDriver, ...]]:
    """Where the driver stands [deg, mm], by so many whole turns more as bring it where its second inputs stand, and these; one that no
    turn brings there gets the offset that does."""
    known = [each for each in linkage.drivers if each.link in linkage.ratios and _stand(linkage, each, places)]
    if not known:
        return driver, linkage.drivers
    turns = (driver + 360.0 * k for k in range(max(2, linkage.turns or 0) if driver_turns(linkage) else 1))
    at = next((q for q in turns if all(abs(_off(linkage, each, places, q)) < _SAME_DEG for each in known)), driver)
    rows = tuple(
        _offset(linkage, each, off)
        if each in known and abs(off := _off(linkage, each, places, at)) >= _SAME_DEG
        else each
        for each in linkage.drivers
    )
    return at, rows


def _offset(linkage: Linkage, each: SecondDriver, off: float) -> SecondDriver:
    """A second input that stands so much farther on [deg, mm]."""
    if input_slides(linkage, each):
        return replace(each, offset_mm=round(each.offset_mm + off, DECIMALS) + 0.0)
    return replace(each, offset_deg=round((each.offset_deg + off + 180.0) % 360.0 - 180.0, DECIMALS) + 0.0)


def _stand(linkage: Linkage, each: SecondDriver, places: Places) -> bool:
    """Whether it is drawn how both links of a second input are turned, or where one slides."""
    least = {each.link: 0 if input_slides(linkage, each) else 1}
    return all(
        n == FRAME_LINK or sum(name in places for name in linkage.by_number[n].places) > least.get(n, 1)
        for n in (each.link, each.on)
        if n in linkage.by_number
    ) and {each.link, each.on} <= set(linkage.by_number)


def _said(linkage: Linkage, each: SecondDriver, driver: float) -> float:
    """The angle of a second input against what it is measured against [deg], or its place there [mm], by its ratio or its motion, and
    its offset."""
    motion = linkage.own_motions.get(each.link)
    if motion is None:
        offset = each.offset_mm if input_slides(linkage, each) else each.offset_deg
        return linkage.ratios[each.link] * driver + offset
    there = at_turn(program(motion), at_driver(np.deg2rad([driver])))[0]
    return float(np.rad2deg(there[0])) + each.offset_deg


def _off(linkage: Linkage, each: SecondDriver, places: Places, driver: float) -> float:
    """How much farther a second input is turned than its ratio or motion and its offset say [deg], -180 ... 180, or how much farther
    it has slid [mm]."""
    (origin, axis), (_, base) = (pose_of(linkage, n, places) for n in (each.link, each.on))
    said = _said(linkage, each, driver)
    if input_slides(linkage, each):
        point, along = _line(linkage, each, places)
        return float(((origin - point) * along.conjugate()).real) - said
    return (degrees_of(axis * base.conjugate()) - said + 180.0) % 360.0 - 180.0


def second_inputs_set(
    linkage: Linkage, places: dict[str, complex], fixed: Collection[str]
) -> tuple[dict[str, complex], set[str]]:
    """The places with every second input turned as the driver's drawn angle says, its pin being where one of the fixed points is; and
    the points fixed then."""
    drawn, fixed = linkage.drawn, set(fixed)
    driver = None if drawn is None else drawn.driver_deg if drawn.driver_deg is not None else drawn.driver_mm
    if driver is None:
        return places, fixed
    places, left = dict(places), [each for each in linkage.drivers if each.link in linkage.ratios]
    held = lambda each: next((n for n in linkage.by_number[each.link].places if n in fixed), None)  # noqa: E731
    stands = lambda n: n == FRAME_LINK or set(linkage.by_number[n].places) <= fixed  # noqa: E731
    slides = lambda each: input_slides(linkage, each)  # noqa: E731
    while ready := [each for each in left if stands(each.on) and (slides(each) or held(each) is not None)]:
        for each in ready:
            if slides(each):
                point, along = _line(linkage, each, places)
                there = point + _said(linkage, each, driver) * along
                places |= {name: there + at * along for name, at in linkage.by_number[each.link].places.items()}
                fixed |= set(linkage.by_number[each.link].places)
                continue
            pin, own = held(each), linkage.by_number[each.link].places
            assert pin is not None
            said = _said(linkage, each, driver)
            axis = heading_of((said + 180.0) % 360.0 - 180.0) * pose_of(linkage, each.on, places)[1]
            centre = places[pin]
            places |= {name: centre + (at - own[pin]) * axis for name, at in own.items()}
            fixed |= set(own)
        left = [each for each in left if each not in ready]
    return places, fixed


def _line(linkage: Linkage, each: SecondDriver, places: Places) -> tuple[complex, complex]:
    """A point of the line on which a second input slides, and its direction, on the sheet."""
    return line_of_slider(linkage, next(s for s in linkage.sliders if s.link == each.link), places)


__all__ = ["driver_turned", "input_pin", "second_inputs_set", "with_input_values", "with_second_input"]
