"""Edits of a linkage that is drawn: links, pins, sliders, and the driver."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import partial
from itertools import combinations
from typing import Any

from core.design.design import Design, with_drive
from core.design.linkage import (
    CRANK,
    FRAME_LINK,
    MOTION,
    NO_DRIVER,
    Drawn,
    Driver,
    Link,
    Linkage,
    LinkMass,
    LinkPoint,
    Slider,
)
from core.design.motions import Motion, Segment
from core.design.topology import driver_pair, input_slides, is_pin, pins
from core.mechanism.drawing_references import loads_of, pruned, renamed
from core.mechanism.drawing_targets import JOINED, DrawingTarget, coincident_point, joined, links_with
from core.mechanism.drawn import (
    DECIMALS,
    SAME,
    PointPositions,
    angle_degrees,
    checked,
    fault,
    frame_link,
    link_point,
    link_pose,
    new_name,
    new_number,
    point_positions,
    slider_line,
    unit_vector,
    with_links,
    with_positions,
    without_bare_pins,
)

# -- new links, pins and points ---------------------------------------------------------------------------------


def empty_linkage() -> Linkage:
    """A linkage with nothing but a frame without points."""
    return Linkage((Link(FRAME_LINK),), drawn=Drawn())


def with_link(design: Design, targets: Sequence[DrawingTarget], length_mm: float | None = None) -> Design:
    """The design with a bar between two targets, or a plate through more.

    The frame of the link has the first point as origin and the second on the x axis. A target on a pin is that pin, a target on
    a link becomes a pin there.
    length_mm: typed length of a bar; by default it is measured.

    Raises
    ------
    DesignError
        Two points coincide, or two links would share two pins.
    """
    linkage = design.drive.linkage
    places, names = point_positions(linkage), list[str]()
    for target in targets:
        linkage, name = _with_target(linkage, places, target, links_with(linkage, names))
        names.append(name)
    if len(set(names)) < len(names) or len(names) < 2:
        raise fault("a link needs two different points", "another position of its end")
    if any(abs(places[a] - places[b]) < SAME for i, a in enumerate(names) for b in names[:i]):
        raise fault(f"{names[0]} and {names[1]} coincide", "different positions")
    number = new_number(linkage)
    link = _normal_link(number, {name: places[name] for name in names})
    if length_mm is not None:
        link = Link(number, (link.points[0], LinkPoint(link.points[1].name, length_mm, 0.0), *link.points[2:]))
    return checked(with_positions(design, places, without_bare_pins(replace(linkage, links=(*linkage.links, link)))))


def _with_target(
    linkage: Linkage, places: dict[str, complex], target: DrawingTarget, barred: Collection[int] = ()
) -> tuple[Linkage, str]:
    """Name of the point at a target; a new point is added to the link that it joins, and its position to `places`."""
    target = joined(linkage, places, target, barred)
    if target.point:
        return linkage, target.point
    name = new_name(linkage, fixed=target.link == FRAME_LINK, taken=places)
    places[name] = target.at
    return (linkage if target.link is None else _with_point(linkage, target.link, name, places)), name


def _with_point(linkage: Linkage, number: int, name: str, places: PointPositions) -> Linkage:
    """The linkage with a further point on a link, at its position."""
    origin, axis = link_pose(linkage, number, {n: at for n, at in places.items() if n != name})
    local = (places[name] - origin) * axis.conjugate()
    link = linkage.by_number.get(number, Link(number))
    return with_links(linkage, {number: Link(number, (*link.points, link_point(name, local)))})


def _normal_link(number: int, places: PointPositions) -> Link:
    """A link whose frame has the first point as origin and the second on the x axis."""
    first, second = list(places.values())[:2]
    turn = (second - first).conjugate() / abs(second - first)
    points = [link_point(name, (at - first) * turn) for name, at in places.items()]
    return Link(number, (points[0], LinkPoint(points[1].name, round(abs(second - first), DECIMALS), 0.0), *points[2:]))


def with_slider(
    design: Design, target: DrawingTarget, through: complex, angle_deg: float, on: int = FRAME_LINK
) -> Design:
    """The design with a block at a target that slides on a link, along the line through a position [mm] of the drawing at an angle."""
    linkage = design.drive.linkage
    places = point_positions(linkage)
    linkage, name = _with_target(linkage, places, target)
    number = new_number(linkage)
    origin, axis = link_pose(linkage, on, places)
    local = (through - origin) * axis.conjugate()
    local_angle = angle_deg if on == FRAME_LINK else angle_degrees(unit_vector(angle_deg) * axis.conjugate())
    line = link_point("", local)
    slider = Slider(link=number, on=on, through_x_mm=line.x_mm, through_y_mm=line.y_mm, angle_deg=local_angle)
    along = unit_vector(angle_deg)
    places[name] = through + along * ((places[name] - through) * along.conjugate()).real
    block = Link(number, (LinkPoint(name, 0.0, 0.0),))
    linkage = without_bare_pins(replace(linkage, links=(*linkage.links, block), sliders=(*linkage.sliders, slider)))
    before = {n: at for n, at in places.items() if n != name}
    return checked(with_positions(design, places, _reshaped(linkage, design, {name: places[name]}, before)))


def with_ground(design: Design, target: DrawingTarget) -> Design:
    """The design with a pivot of the frame at a target, joined to the links that have the point."""
    linkage = design.drive.linkage
    places = point_positions(linkage)
    target = joined(linkage, places, target, links_with(linkage, frame_link(linkage).places))
    on = FRAME_LINK if target.link is None else target.link
    linkage, name = _with_target(linkage, places, replace(target, link=on))
    if name not in frame_link(linkage).places:
        linkage = _with_point(linkage, FRAME_LINK, name, places)
    return checked(with_positions(design, places, without_bare_pins(linkage)))


def with_pin(design: Design, target: DrawingTarget, links: Sequence[int] = ()) -> Design:
    """The design with a pin that joins links at a target; on empty paper a bare pin, which a link can take later."""
    linkage = design.drive.linkage
    places = point_positions(linkage)
    target = joined(linkage, places, target)
    if not target.point and not links and target.link is None:
        name = new_name(linkage, taken=places)
        places[name] = target.at
        bare = Link(new_number(linkage), (LinkPoint(name, 0.0, 0.0),))
        return with_positions(design, places, replace(linkage, links=(*linkage.links, bare)))
    on: Sequence[int | None] = links or [target.link]
    first, *others = on
    linkage, name = _with_target(linkage, places, target if target.point else replace(target, link=first))
    for number in others if not target.point else links:
        if number is not None and name not in linkage.by_number[number].places:
            linkage = _with_point(linkage, number, name, places)
    return checked(with_positions(design, places, linkage))


def with_traced_point(design: Design, target: DrawingTarget) -> Design:
    """The design with a further point on a link.

    Raises
    ------
    DesignError
        The target is not a free position on a link.
    """
    linkage = design.drive.linkage
    places = point_positions(linkage)
    target = joined(linkage, places, target)
    if target.link is None or target.point:
        raise fault("a point must be on a link, away from its pins", "a position on the face of a link")
    linkage, _ = _with_target(linkage, places, target)
    return with_positions(design, places, linkage)


def with_driving_link(design: Design, number: int, speed_rpm: float | None = None) -> Design:
    """The design with a link as its driver.

    The link is pinned to the frame, slides on it, or slides on a moving link as the rod of a cylinder does. Where the driver needs
    a motion and the design has none, it rests in its drawn position.

    Raises
    ------
    DesignError
        The link cannot drive.
    """
    linkage, old = design.drive.linkage, design.drive.linkage.driver
    driven = replace(linkage, driver=replace(old, link=number, on=FRAME_LINK))
    slider = next((s for s in linkage.sliders if number in (s.link, s.on) and FRAME_LINK not in (s.link, s.on)), None)
    if driver_pair(driven) is None and slider is not None:
        driven = replace(driven, driver=replace(driven.driver, link=slider.link, on=slider.on))
        number = slider.link
    pair = driver_pair(driven) if number in driven.by_number and number != FRAME_LINK else None
    if pair is None:
        raise fault(
            f"link {number} is not joined to the frame by one pair", "a link pinned to the frame, or sliding on it"
        )
    turns, drive = is_pin(pair), design.drive
    has_motion = drive.motion is not None and drive.motion.unit == ("deg" if turns else "mm")
    kind = CRANK if turns and not has_motion and not drive.has_disk else MOTION
    driver = Driver(number, kind, old.speed_rpm if speed_rpm is None else speed_rpm, driven.driver.on)
    if kind == CRANK:
        design = with_drive(design, motion=None)
    drawn = pruned(with_positions(design, point_positions(linkage), replace(linkage, driver=driver)))
    if kind == CRANK or has_motion:
        return drawn
    at = drawn.drive.linkage.drawn or Drawn()
    unit, start = ("mm", at.driver_mm) if at.driver_deg is None else ("deg", at.driver_deg)
    return with_drive(drawn, motion=Motion(start or 0.0, (Segment(360.0, 0.0),), unit))


# -- other positions, lengths and names ---------------------------------------------------------------------------


def with_moved(design: Design, to: PointPositions) -> Design:
    """The design with points at new positions: only the links that have them change.

    A block stays on its line; a point of the frame moves on the frame. A point that comes to lie on another joins it.

    Raises
    ------
    DesignError
        Two points of a link would coincide, or two links would share two pins.
    """
    return _with_coincident_joined(_moved(design, to), to, point_positions(design.drive.linkage))


def with_local_point(design: Design, number: int, name: str, at: complex) -> Design:
    """The design with a point of one link at new coordinates [mm] in the frame of the link; on another point it joins that one.

    Raises
    ------
    DesignError
        Two points of the link would coincide.
    """
    linkage = design.drive.linkage
    before = point_positions(linkage)
    origin, axis = link_pose(linkage, number, before)
    link = linkage.by_number[number]
    points = tuple(LinkPoint(name, at.real, at.imag) if p.name == name else p for p in link.points)
    changed = with_links(linkage, {number: replace(link, points=points)})
    result = with_positions(design, {**before, name: origin + at * axis}, changed)
    return _with_coincident_joined(result, [name], before)


def _with_coincident_joined(design: Design, moved: Collection[str], before: PointPositions) -> Design:
    """The design with moved points joined to the points on which they are now, but were not before."""
    for name in moved:
        places = point_positions(design.drive.linkage)
        if name in places:
            apart = {n: at for n, at in places.items() if abs(before[n] - before[name]) > JOINED}
            if other := coincident_point(apart, places[name]):
                design = with_joined(design, other, name)
    return design


def _moved(design: Design, to: PointPositions) -> Design:
    linkage = design.drive.linkage
    before = point_positions(linkage)
    to = {name: _on_lines(linkage, name, at, before) for name, at in to.items() if name in before}
    after = {**before, **to}
    for link in linkage.links:
        if link.number == FRAME_LINK:
            continue
        for first, second in combinations([name for name in link.places if name in after], 2):
            if {first, second} & set(to) and abs(after[first] - after[second]) < SAME:
                raise fault(f"{second} would coincide with {first} of the same link", "different positions")
    return with_positions(design, after, _reshaped(linkage, design, to, before))


def _on_lines(linkage: Linkage, name: str, at: complex, places: PointPositions) -> complex:
    """The position of a point, moved onto the line of the block that has it."""
    for slider in linkage.sliders:
        if name in linkage.by_number[slider.link].places and len(linkage.by_number[slider.link].points) == 1:
            through, along = slider_line(linkage, slider, places)
            return through + along * ((at - through) * along.conjugate()).real
    return at


def _reshaped(linkage: Linkage, design: Design, to: PointPositions, before: PointPositions) -> Linkage:
    """The linkage with some points at new positions; the coordinates of a link that only moves or turns do not change."""
    after = {**before, **to}
    changed: dict[int, Link] = {}
    for link in linkage.links:
        names = [name for name in link.places if name in to]
        if names and (link.number == FRAME_LINK or not _has_same_shape(link, after)):
            changed[link.number] = _with_points_at(linkage, design, link, names, after, before)
    return with_links(linkage, changed)


def _has_same_shape(link: Link, places: PointPositions) -> bool:
    known = [(at, places[name]) for name, at in link.places.items() if name in places]
    if len(known) < 2:
        return True
    (a, p), (b, q), *others = known
    if abs(abs(b - a) - abs(q - p)) > SAME or a == b:
        return False
    turn = (q - p) / (b - a)
    return all(abs(p + (c - a) * turn - r) <= SAME for c, r in others)


def _with_points_at(
    linkage: Linkage, design: Design, link: Link, names: Sequence[str], after: PointPositions, before: PointPositions
) -> Link:
    if link.number != FRAME_LINK and _has_normal_frame(design, link):
        return _normal_link(link.number, {name: after[name] for name in link.places})
    origin, axis = link_pose(linkage, link.number, before)
    new = {name: link_point(name, (after[name] - origin) * axis.conjugate()) for name in names}
    return Link(link.number, tuple(new.get(p.name, p) for p in link.points))


def _has_normal_frame(design: Design, link: Link) -> bool:
    """Whether a link's frame has its first point as origin and its second on the x axis, and only points are given in it."""
    rows = _rows_in_frame(design, link.number)
    if rows or any(link.number in (s.link, s.on) for s in design.drive.linkage.sliders) or len(link.points) < 2:
        return len(link.points) == 2 and link.points[0].x_mm == link.points[0].y_mm == link.points[1].y_mm == 0.0
    first, second, *_ = link.places.values()
    return first == 0 and second.imag == 0.0 and second.real > 0.0


def _rows_in_frame(design: Design, number: int) -> list[Any]:
    """Rows of the loads that are given by coordinates in a link's frame."""
    loads = design.drive.loads
    ends = [end for spring in loads.springs for end in (spring.from_, spring.to)]
    return [row for row in (*loads.masses, *ends) if row.link == number and getattr(row, "point", None) is None]


def with_length(design: Design, number: int, first: str, second: str, length_mm: float) -> Design:
    """The design with a new distance between two points of a link; the second moves along their line.

    The drawing is not assembled again; see `core.mechanism.drawn.assembled`.

    Raises
    ------
    DesignError
        The length is not positive, or the points coincide.
    """
    linkage = design.drive.linkage
    link = linkage.by_number[number]
    a, b = link.places[first], link.places[second]
    if not length_mm > 0.0 or a == b:
        raise fault(f"a length of {length_mm:g} mm", "> 0")
    along = (b - a) / abs(b - a)
    end = a + along * length_mm
    x, y = (end.real, end.imag)
    if along.imag == 0.0:
        x, y = a.real + math.copysign(length_mm, along.real), a.imag
    elif along.real == 0.0:
        x, y = a.real, a.imag + math.copysign(length_mm, along.imag)
    points = tuple(LinkPoint(second, x + 0.0, y + 0.0) if p.name == second else p for p in link.points)
    return with_drive(design, mechanism=with_links(linkage, {number: Link(number, points)}))


def without(design: Design, points: Collection[str] = (), links: Collection[int] = ()) -> Design:
    """The design without some points and links, and without all that depends on them.

    A bar is removed with either of its pins, a block with its pin or with the link on which it slides; a link with two pins or
    more only loses its line.
    """
    linkage = design.drive.linkage
    places = point_positions(linkage)
    removed = set(links) - {FRAME_LINK}
    remaining: list[Link] = []
    for link in linkage.links:
        left = tuple(p for p in link.points if p.name not in points)
        too_few = len(left) < min(2, len(link.points))
        if link.number == FRAME_LINK or (link.number not in removed and not (too_few and left != link.points)):
            remaining.append(replace(link, points=left))
    sliders, before = linkage.sliders, -1
    while len(remaining) != before:
        before, numbers = len(remaining), {link.number for link in remaining}
        sliders = tuple(s for s in sliders if {s.link, s.on} <= numbers)
        without_line = {s.link for s in linkage.sliders} - {s.link for s in sliders}
        remaining = [link for link in remaining if link.number not in without_line or len(link.points) > 1]
    reduced = replace(linkage, links=tuple(remaining), sliders=sliders)
    numbers, driver = {link.number for link in remaining}, linkage.driver
    pinned = {number for pin in pins(reduced) for number in pin.links}
    drivers = tuple(
        d for d in linkage.drivers if {d.link, d.on} <= numbers and (d.link in pinned or input_slides(reduced, d))
    )
    if not {driver.link, driver.on} <= numbers or (driver_pair(linkage) and not driver_pair(reduced)):
        driver = NO_DRIVER
    return pruned(with_positions(design, places, replace(reduced, drivers=drivers, driver=driver)))


def with_joined(design: Design, first: str, second: str) -> Design:
    """The design with two pins joined at the position of the first, or of the one that is on the frame.

    Raises
    ------
    DesignError
        Both pins are on one link, or two links would share two pins.
    """
    linkage = design.drive.linkage
    before = point_positions(linkage)
    if second in frame_link(linkage).places and first not in frame_link(linkage).places:
        first, second = second, first
    for link in linkage.links:
        if link.number != FRAME_LINK and {first, second} <= set(link.places):
            raise fault(f"{first} and {second} are both on link {link.number}", "pins of two links")
    frame = replace(frame_link(linkage), points=tuple(p for p in frame_link(linkage).points if p.name != second))
    moved = _moved(design, {second: before[first]})
    one = with_drive(moved, mechanism=with_links(moved.drive.linkage, {FRAME_LINK: frame}))
    one = renamed(one, {second: first})
    places = {**point_positions(one.drive.linkage), first: before[first]}
    return checked(with_positions(one, places, without_bare_pins(one.drive.linkage)))


def with_split(design: Design, name: str) -> Design:
    """The design with a pin divided: the first link keeps its point, every other link gets a new one at the same position.

    Raises
    ------
    DesignError
        The pin joins no links.
    """
    linkage = design.drive.linkage
    places = point_positions(linkage)
    links = [link for link in linkage.links if name in link.places]
    if len(links) < 2:
        raise fault(f"{name} joins no links", "a pin of two links or more")
    for link in links[1:]:
        new = new_name(linkage, taken=places)
        places[new] = places[name]
        points = tuple(replace(p, name=new) if p.name == name else p for p in link.points)
        linkage = with_links(linkage, {link.number: Link(link.number, points)})
        design = with_drive(design, loads=loads_of(design, partial(_split_reference, name, link.number, new)))
    return with_positions(design, places, linkage)


def _split_reference(name: str, link: int, new: str, number: int, point: str) -> tuple[int, str]:
    """New link and point of a reference to the divided pin `name`, which is `new` on one link."""
    return number, new if number == link and point == name else point


def with_welded(design: Design, first: int, second: int) -> Design:
    """The design with two links welded into one in their drawn position; the first keeps its number and frame, masses are combined.

    Raises
    ------
    DesignError
        The links are not two different ones, or the second slides on a third.
    """
    if FRAME_LINK in (first, second):
        first, second = FRAME_LINK, max(first, second)
    linkage = design.drive.linkage
    places = point_positions(linkage)
    if first == second or not {first, second} <= set(linkage.by_number):
        raise fault("one link", "two links")
    to, old = link_pose(linkage, first, places), link_pose(linkage, second, places)
    turn = old[1] * to[1].conjugate()
    transformed = lambda at: (old[0] + at * old[1] - to[0]) * to[1].conjugate()  # noqa: E731
    base = linkage.by_number[first]
    second_points = linkage.by_number[second].places
    added = tuple(link_point(n, transformed(at)) for n, at in second_points.items() if n not in base.places)
    sliders = []
    for s in linkage.sliders:
        if {s.link, s.on} == {first, second}:
            continue
        if s.link == second:
            raise fault(f"link {second} slides on link {s.on}", "links that do not slide, or weld the other to it")
        if s.on == second:
            through = link_point("", transformed(complex(s.through_x_mm, s.through_y_mm)))
            s = replace(s, on=first, through_x_mm=through.x_mm, through_y_mm=through.y_mm,
                        angle_deg=round(s.angle_deg + angle_degrees(turn), DECIMALS) + 0.0)  # fmt: skip
        sliders.append(s)
    links = tuple(
        replace(link, points=(*base.points, *added)) if link.number == first else link
        for link in linkage.links
        if link.number != second
    )
    driver = linkage.driver
    driver = replace(driver, link=first) if driver.link == second != first != FRAME_LINK else driver
    driver = replace(driver, on=first) if driver.on == second and driver.link != first else driver
    number = lambda n: first if n == second else n  # noqa: E731
    renumbered = (replace(d, link=number(d.link), on=number(d.on)) for d in linkage.drivers)
    drivers = tuple(d for d in renumbered if d.link not in (d.on, FRAME_LINK))
    welded = replace(linkage, links=links, sliders=tuple(sliders), driver=driver, drivers=drivers)
    loads = loads_of(design, lambda n, p: (number(n), p), lambda n, at: transformed(at) if n == second else at)
    masses = [m for m in loads.masses if m.link != FRAME_LINK]
    pair = [m for m in masses if m.link == first]
    if len(pair) == 2:
        masses = [_combined_mass(*pair) if m is pair[0] else m for m in masses if m is not pair[1]]
    loads = replace(loads, masses=tuple(masses), forces=tuple(f for f in loads.forces if f.link != FRAME_LINK))
    return pruned(with_positions(with_drive(design, loads=loads), places, welded))


def _combined_mass(a: LinkMass, b: LinkMass) -> LinkMass:
    """Two masses of one link as one about their common centre, by Steiner's theorem."""
    mass = a.mass_kg + b.mass_kg
    p, q = complex(a.centre_x_mm, a.centre_y_mm), complex(b.centre_x_mm, b.centre_y_mm)
    centre = (p * a.mass_kg + q * b.mass_kg) / mass if mass else p
    steiner = (a.mass_kg * abs(p - centre) ** 2 + b.mass_kg * abs(q - centre) ** 2) * 1e-6
    at = link_point("", centre)
    return replace(a, mass_kg=mass, inertia_kg_m2=a.inertia_kg_m2 + b.inertia_kg_m2 + steiner,
                   centre_x_mm=at.x_mm, centre_y_mm=at.y_mm)  # fmt: skip


def with_name(design: Design, old: str, new: str) -> Design:
    """The design with a point renamed wherever it occurs.

    Raises
    ------
    DesignError
        The new name is taken, or is no name.
    """
    taken = {name for link in design.drive.linkage.links for name in link.places}
    if not new.isidentifier() or (new in taken and new != old):
        raise fault(
            f"{new!r} is {'taken' if new in taken else 'no name of a point'}", "letters, digits and _, a letter first"
        )
    return renamed(design, {old: new})


def with_mirrored(design: Design, links: Collection[int], through: complex, along: complex) -> Design:
    """The design with links mirrored in a line [mm], with the points they share with other links, and the lines of their sliders."""
    linkage = design.drive.linkage
    before = point_positions(linkage)
    flip = lambda at: through + along * ((at - through) / along).conjugate()  # noqa: E731
    moving = set(links) - {FRAME_LINK}
    names = {name for n in moving for name in linkage.by_number[n].places if name in before}
    flipped = {n: Link(n, tuple(replace(p, y_mm=-p.y_mm + 0.0) for p in linkage.by_number[n].points)) for n in moving}
    to = {name: flip(before[name]) for name in names}
    rest = replace(linkage, links=tuple(link for link in linkage.links if link.number not in moving))
    neighbours = _reshaped(rest, design, to, before).by_number
    mirrored = replace(
        linkage, links=tuple(flipped.get(link.number) or neighbours[link.number] for link in linkage.links)
    )
    sliders = []
    for s in linkage.sliders:
        if s.on in moving:  # the line is given in the mirrored frame
            s = replace(s, through_y_mm=-s.through_y_mm + 0.0, angle_deg=-s.angle_deg + 0.0)
        elif s.link in moving and s.on == FRAME_LINK:
            line = link_point("", flip(complex(s.through_x_mm, s.through_y_mm)))
            angle = angle_degrees(along * (unit_vector(s.angle_deg) / along).conjugate())
            s = replace(s, through_x_mm=line.x_mm, through_y_mm=line.y_mm, angle_deg=angle)
        sliders.append(s)
    loads = loads_of(design, lambda n, p: (n, p), lambda n, at: at.conjugate() if n in moving else at)
    after = {**before, **to}
    result = with_positions(with_drive(design, loads=loads), after, replace(mirrored, sliders=tuple(sliders)))
    return _with_coincident_joined(result, to, before)
