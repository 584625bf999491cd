"""Rules of a linkage, which relate links, pairs, driver, branches, cam and loads.

Every rule is applied whatever the faults of the others, so that it must accept any number, NaN included.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from itertools import combinations

from core.design.design import Drive
from core.design.followers import LinkageConjugate, SecondLinkRoller
from core.design.linkage import (
    CRANK,
    FRAME_LINK,
    GEAR,
    MOTION,
    NO_DRIVER,
    RACK,
    WHEELS,
    Linkage,
    LinkageCam,
    LinkageLoads,
    LinkForce,
    SecondDriver,
)
from core.design.topology import (
    GROUP,
    driver_pair,
    driver_turns,
    input_slides,
    is_pin,
    mobility,
    pair_count,
    pins,
    solving_order,
)
from core.errors import MISSING, Fault

LONGEST_NAME = 40
_WITH_SIDES = ("RRR", "RRP", "RPR")


def _numbers(linkage: Linkage) -> list[int]:
    return sorted(link.number for link in linkage.links)


def _no_moving_link(linkage: Linkage, number: int, path: str) -> Iterator[Fault]:
    """Fault where a link does not exist, or is the frame."""
    moving = [n for n in _numbers(linkage) if n != FRAME_LINK]
    if number not in moving:
        yield Fault(path, number, "no such moving link", " | ".join(map(str, moving)))


def _links(drive: Drive) -> Iterator[Fault]:
    """Every link is given once, the frame among them; points have names for columns, and pins of a link differ."""
    links = drive.linkage.links
    if not any(link.number == FRAME_LINK for link in links):
        yield Fault("linkage.links", MISSING, "no frame", f"a link with number = {FRAME_LINK}")
    seen: set[int] = set()
    for i, link in enumerate(links):
        if link.number in seen:
            yield Fault(f"linkage.links[{i}].number", link.number, "given twice", "each link once")
        seen.add(link.number)
        for point in link.points:
            if not point.name.isidentifier() or len(point.name) > LONGEST_NAME:
                yield Fault(
                    f"linkage.links[{i}].points",
                    point.name,
                    "no name of a point",
                    f"letters, digits and _, a letter first, at most {LONGEST_NAME}",
                )
    yield from _pins_differ(drive.linkage)


def _pins_differ(linkage: Linkage) -> Iterator[Fault]:
    pinned = {pin.name for pin in pins(linkage)}
    points_by_link = [link.places for link in linkage.links]
    for i, points in enumerate(points_by_link):
        for a, b in combinations([name for name in points if name in pinned], 2):
            if points[a] == points[b]:
                yield Fault(
                    f"linkage.links[{i}].points.{b}",
                    [points[b].real, points[b].imag],
                    f"coincides with {a}",
                    "different positions of the pins of a link; links on one pin share its name",
                )
    for (link, points), (second, second_points) in combinations(zip(linkage.links, points_by_link, strict=True), 2):
        shared = [name for name in points if name in second_points]
        if len(shared) > 1 and link.number != second.number:
            i = linkage.links.index(second)
            value = f"{' and '.join(shared)} on links {link.number} and {second.number}"
            yield Fault(f"linkage.links[{i}].points", value, "two pins make them one body", "one shared point")


def _sliders(drive: Drive) -> Iterator[Fault]:
    linkage = drive.linkage
    numbers = set(_numbers(linkage))
    sliding = Counter(s.link for s in linkage.sliders)
    seen: set[int] = set()
    for i, slider in enumerate(linkage.sliders):
        at = f"linkage.sliders[{i}]"
        yield from (
            Fault(f"{at}.{key}", value, "no such link", " | ".join(map(str, _numbers(linkage))))
            for key, value in (("link", slider.link), ("on", slider.on))
            if value not in numbers
        )
        if slider.link == slider.on:
            yield Fault(f"{at}.on", slider.on, "a link cannot slide on itself", "another link")
        if slider.link == FRAME_LINK:
            yield Fault(
                f"{at}.link", slider.link, "the frame does not slide", f"on = {FRAME_LINK}, link = the moving link"
            )
        if slider.link in seen and sliding[slider.link] > 1:
            yield Fault(
                f"{at}.link",
                slider.link,
                "slides twice: its frame can be on one line only",
                f"link = {slider.on}, on = {slider.link}, with the line in link {slider.link}",
            )
        seen.add(slider.link)


def _driver(drive: Drive) -> Iterator[Fault]:
    linkage, driver = drive.linkage, drive.linkage.driver
    if driver == NO_DRIVER:
        return
    if driver.speed_rpm == 0.0:
        yield Fault("linkage.driver.speed_rpm", driver.speed_rpm, "must not be 0", "> 0, or < 0 for clockwise")
    if absent := list(_no_moving_link(linkage, driver.link, "linkage.driver.link")):
        yield from absent
    elif FRAME_LINK in _numbers(linkage):
        pair = driver_pair(linkage)
        if driver.on not in _numbers(linkage) or driver.on == driver.link:
            allowed = " | ".join(str(n) for n in _numbers(linkage) if n != driver.link)
            yield Fault("linkage.driver.on", driver.on, "must be another link", allowed)
        elif pair is not None and driver.kind == CRANK and not is_pin(pair):
            on = "the frame" if driver.on == FRAME_LINK else f"link {driver.on}"
            yield Fault("linkage.driver.kind", driver.kind, f"link {driver.link} slides on {on}", MOTION)


def _undriven(drive: Drive) -> Iterator[Fault]:
    """There is a driver, with one pair to the frame or to the link against which it is driven."""
    linkage, driver = drive.linkage, drive.linkage.driver
    if driver == NO_DRIVER:
        yield Fault("linkage.driver", MISSING, "missing", '{ link = 2, kind = "crank", speed_rpm = 60.0 }')
        return
    if not {driver.link, FRAME_LINK} <= set(_numbers(linkage)) or driver.link == FRAME_LINK:
        return
    if driver_pair(linkage) is None and driver.on in _numbers(linkage):
        on = "the frame" if driver.on == FRAME_LINK else f"link {driver.on}"
        allowed = f"a link pinned to {on}, or sliding on it"
        yield Fault("linkage.driver.link", driver.link, f"has no single pair with {on}", allowed)


def _second_drivers(drive: Drive) -> Iterator[Fault]:
    """Second drivers drive different links with a pin or a line; a ratio is given, or follows from wheels."""
    linkage, seen = drive.linkage, {drive.linkage.driver.link}
    for i, row in enumerate(linkage.drivers):
        at = f"linkage.drivers[{i}]"
        yield from _no_moving_link(linkage, row.link, f"{at}.link")
        if row.link in seen:
            yield Fault(f"{at}.link", row.link, "is driven already", "another link")
        seen.add(row.link)
        if row.on not in _numbers(linkage) or row.on == row.link:
            allowed = " | ".join(str(n) for n in _numbers(linkage) if n != row.link)
            yield Fault(f"{at}.on", row.on, "must be another link", allowed)
        by_wheels = row.ratio_by(linkage.driver.link)
        if row.motion:
            yield from _second_motion(linkage, row, at)
        elif row.ratio is None and by_wheels is None:
            allowed = "a ratio; or teeth or radius_mm of two wheels, on the frame or on the driver's link"
            if row.kind == RACK:
                allowed = "a ratio; or radius_mm, or teeth and module_mm, of the pinion, and 0 of the rack"
            yield Fault(f"{at}.ratio", MISSING, "missing", allowed)
        elif row.ratio is not None and by_wheels is not None and _ratio_error(row, by_wheels) > 1e-12 * abs(by_wheels):
            yield Fault(f"{at}.ratio", row.ratio, "its wheels have another ratio", f"{by_wheels:.12g}, or leave it out")
        yield from _rack(linkage, row, at)
        pinned = any(row.link in pin.links for pin in pins(linkage))
        if not pinned and not any(row.link == s.link for s in linkage.sliders):
            yield Fault(f"{at}.link", row.link, "has no pin", "a link on a pin")
    if linkage.drivers and linkage.driver.on != FRAME_LINK:
        yield Fault(
            "linkage.drivers",
            MISSING,
            "must follow a link on the frame",
            "a driver pinned to the frame, or sliding on it",
        )


def _ratio_error(second: SecondDriver, by_wheels: float) -> float:
    """Difference between a ratio and that of the wheels; for a rack the sign is the side of the pinion."""
    assert second.ratio is not None
    return abs((abs(second.ratio) if second.kind == RACK else second.ratio) - by_wheels)


def _rack(linkage: Linkage, second: SecondDriver, at: str) -> Iterator[Fault]:
    """A rack slides and its pinion turns; an offset is an angle or a length accordingly."""
    slides, led_by_slide = input_slides(linkage, second), not driver_turns(linkage)
    kind = second.kind or (GEAR if second.wheels else None)
    if kind == RACK and slides == led_by_slide:
        problem = "both links slide" if slides else "neither this link nor the driver slides"
        yield Fault(f"{at}.kind", kind, problem, " | ".join(WHEELS[:-1]) if not slides else "a ratio alone")
    elif kind not in (None, RACK) and (slides or led_by_slide):
        yield Fault(f"{at}.kind", kind, f"link {second.link if slides else linkage.driver.link} slides", RACK)
    elif kind == RACK and (radii := second.pitch_radii) and bool(radii[1]) == slides:
        yield Fault(
            f"{at}.radius_mm",
            list(radii),
            "0 is the radius of the link that turns",
            "[pinion, 0]" if slides else "[0, pinion]",
        )
    for key, wrong in (("offset_deg", slides), ("offset_mm", not slides)):
        if wrong and (value := getattr(second, key)):
            allowed = "offset_mm" if slides else "offset_deg"
            yield Fault(f"{at}.{key}", value, f"link {second.link} {'slides' if slides else 'turns'}", allowed)
    if slides and second.motion:
        yield Fault(f"{at}.motion", second.motion, f"link {second.link} slides, and a motion turns a link", "a ratio")


def _second_motion(linkage: Linkage, row: SecondDriver, at: str) -> Iterator[Fault]:
    """A second driver's motion is a table in degrees, without a ratio, and follows a crank."""
    named = {motion.name for motion in linkage.motions}
    if row.motion not in named:
        yield Fault(
            f"{at}.motion", row.motion, "no such motion", " | ".join(sorted(named)) or f"[motions.{row.motion}]"
        )
    yield from (
        Fault(f"{at}.{key}", value, "cannot be combined with a motion", "one of them")
        for key in ("ratio", "kind")
        if (value := getattr(row, key)) is not None
    )
    if linkage.driver.kind != CRANK:
        yield Fault(f"{at}.motion", row.motion, "follows the turn of a crank", f'driver with kind = "{CRANK}"')


def _motions(drive: Drive) -> Iterator[Fault]:
    """Every named motion has a second driver that follows it."""
    for name in (motion.name for motion in drive.motions):
        if all(row.motion != name for row in drive.linkage.drivers):
            yield Fault(f"motions.{name}", MISSING, "no driver follows it", f'motion = "{name}" in [[linkage.drivers]]')


def _structure(drive: Drive) -> Iterator[Fault]:
    """The linkage has one degree of freedom, and every link is joined to others."""
    linkage = drive.linkage
    numbers = _numbers(linkage)
    if not _has_valid_names(linkage):
        return
    for i, link in enumerate(linkage.links):
        joined = any(link.number in pin.links for pin in pins(linkage))
        if not joined and not any(link.number in (s.link, s.on) for s in linkage.sliders):
            yield Fault(f"linkage.links[{i}]", link.number, "is joined to no other link", "a shared point or a slider")
            return
    free, driven = mobility(linkage), 1 + len(linkage.drivers)
    if free > driven:
        value = f"3·({len(numbers)} - 1) - 2·{pair_count(linkage)} = {free}"
        problem = f"mobility (Grübler) is not {driven}: the driver does not determine all links"
        yield Fault("linkage", value, problem, f"3·(links - 1) - 2·pairs = {driven}")
    elif wrong := solving_order(linkage).undetermined:
        value = f"links {', '.join(map(str, wrong))}"
        yield Fault("linkage", value, "not determined by the driver", "one degree of freedom in total")


def _has_valid_names(linkage: Linkage) -> bool:
    """Whether the numbers of links, pairs and driver are consistent, so that mobility and order of solution exist."""
    numbers = _numbers(linkage)
    ends = [n for s in linkage.sliders for n in (s.link, s.on)]
    sliding = [s.link for s in linkage.sliders]
    pair = driver_pair(linkage) if {FRAME_LINK, linkage.driver.link} <= set(numbers) else None
    return (
        len(set(numbers)) == len(numbers)
        and linkage.driver.link != FRAME_LINK
        and set(ends) <= set(numbers)
        and len(set(sliding)) == len(sliding)
        and all(s.link != s.on for s in linkage.sliders)
        and pair is not None
        and (is_pin(pair) or linkage.driver.kind != CRANK)
    )


def sided_joints(linkage: Linkage) -> tuple[str, ...]:
    """Joints whose side a file may state, in the order of solution; for a group its inner pins, whose side starts the iteration."""
    joints: list[str] = []
    for step in solving_order(linkage).steps:
        if step.kind in _WITH_SIDES:
            joints.append(step.joint)
        elif step.kind == GROUP:
            joints += [p.name for p in pins(linkage) if p.name in step.pairs and set(p.links) <= set(step.links)]
    return tuple(joints)


def _branches(drive: Drive) -> Iterator[Fault]:
    linkage = drive.linkage
    if not _has_valid_names(linkage) or mobility(linkage) > 1 + len(linkage.drivers):
        return
    if solving_order(linkage).redundant:  # the lengths decide which links are solved together
        return
    known = sided_joints(linkage)
    for side in linkage.branch:
        if side.joint not in known:
            allowed = " | ".join(known) or "none: it has one assembly only"
            yield Fault(f"linkage.branch.{side.joint}", side.side, "no joint with two sides", allowed)


def _drawn(drive: Drive) -> Iterator[Fault]:
    """Drawn points exist; the driver's position has the unit of its kind; sides are not given too."""
    linkage, drawn = drive.linkage, drive.linkage.drawn
    if drawn is None:
        return
    if linkage.branch:
        yield Fault("linkage.branch", MISSING, "cannot be combined with linkage.drawn", "one of them")
    points = {name for link in linkage.links for name in link.places}
    yield from (
        Fault(f"linkage.drawn.{name}", MISSING, "no link has a point of this name", " | ".join(sorted(points)))
        for name in drawn.places.keys() - points
    )
    if not _has_valid_names(linkage):
        return
    unit = "deg" if driver_turns(linkage) else "mm"
    wrong_unit = "mm" if unit == "deg" else "deg"
    if (value := getattr(drawn, f"driver_{wrong_unit}")) is not None:
        move = "turns" if unit == "deg" else "slides"
        yield Fault(f"linkage.drawn.driver_{wrong_unit}", value, f"the driver {move}", f"driver_{unit}")
    if linkage.driver.kind == CRANK and drawn.driver_deg is None:
        yield Fault("linkage.drawn.driver_deg", MISSING, "missing", "the crank's angle as drawn")


def _motion(drive: Drive) -> Iterator[Fault]:
    driver = drive.linkage.driver
    if driver.kind == MOTION and drive.motion is None:
        yield Fault("motion", MISSING, "missing", "a table [motion] that the driver follows")
    if driver.kind == CRANK and drive.motion is not None:
        yield Fault("motion", "[motion]", "no driver follows it", f'driver with kind = "{MOTION}"')


def _cam(drive: Drive) -> Iterator[Fault]:
    if not drive.has_disk:
        return
    if drive.linkage.driver.kind != MOTION:
        yield Fault("cam", "[cam]", "a cam needs a motion", f'driver with kind = "{MOTION}"')
    yield from _no_point(drive.linkage, drive.cam, "cam")
    if isinstance(drive.cam.form, LinkageConjugate):
        yield from _no_point(drive.linkage, drive.cam.form.second, "cam.second")


def _no_point(linkage: Linkage, at: LinkageCam | SecondLinkRoller | LinkForce, path: str) -> Iterator[Fault]:
    """Fault where a moving link, or its point, does not exist."""
    if absent := list(_no_moving_link(linkage, at.link, f"{path}.link")):
        yield from absent
    elif at.point not in linkage.by_number[at.link].places:
        allowed = " | ".join(linkage.by_number[at.link].places)
        yield Fault(f"{path}.point", at.point, f"link {at.link} has no such point", allowed)


def _loads(drive: Drive) -> Iterator[Fault]:
    loads: LinkageLoads = drive.loads
    seen: set[int] = set()
    for i, mass in enumerate(loads.masses):
        yield from _no_moving_link(drive.linkage, mass.link, f"loads.masses[{i}].link")
        if mass.link in seen:
            yield Fault(f"loads.masses[{i}].link", mass.link, "has its mass already, in another row", "each link once")
        seen.add(mass.link)
    for i, force in enumerate(loads.forces):
        yield from _no_point(drive.linkage, force, f"loads.forces[{i}]")


DRIVE_RULES: tuple[Callable[[Drive], Iterator[Fault]], ...] = (
    _links, _sliders, _driver, _undriven, _second_drivers, _motions, _structure, _branches, _drawn, _motion, _cam, _loads
)  # fmt: skip
"""Rules of a drive with a linkage; a rule must accept any number, NaN included."""


def only_incomplete(drive: Drive, faults: Iterable[Fault]) -> bool:
    """Whether these faults of a drive mean only that its linkage is incomplete."""
    incomplete = (
        {(fault.path, fault.problem) for fault in [*_undriven(drive), *_structure(drive)]} if drive.links else set()
    )
    return {(fault.path, fault.problem) for fault in faults} <= incomplete
