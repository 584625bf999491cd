"""Links of a linkage copied: beside themselves, or into another design."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
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
from core.design.loads import Attachment
from core.design.parts import Motion, Segment
from core.design.paths import all_paths
from core.design.topology import driver_pair, input_slides, is_pin, pins
from core.mechanism.drawn import (
    DECIMALS,
    SAME,
    Places,
    Spot,
    checked,
    degrees_of,
    fault,
    frame_of,
    heading_of,
    line_of_slider,
    new_name,
    new_number,
    places_of,
    point_at,
    pose_of,
    with_links,
    with_places,
    without_bare,
)

# -- what holds on to the points and links of a linkage ---------------------------------------------------------


_Names = Callable[[int, str], tuple[int, str]]


def loads_of(design: Design, names: _Names, at: Callable[[int, complex], complex] | None = None) -> Any:
    """The loads of which each row holds on to a link and a point as ``names`` says, and to a place in a link's frame as ``at``."""
    loads = design.drive.loads
    move = at or (lambda _, place: place)

    def held(end: Attachment) -> Attachment:
        if end.point is None and end.x_mm is not None and end.y_mm is not None:
            old = complex(end.x_mm, end.y_mm)
            new = move(end.link, old)
            if new != old:
                place = point_at("", new)
                end = replace(end, x_mm=place.x_mm, y_mm=place.y_mm)
        number, point = names(end.link, end.point or "")
        return replace(end, link=number, point=point or None)

    def mass(row: LinkMass) -> LinkMass:
        old = complex(row.centre_x_mm, row.centre_y_mm)
        new = move(row.link, old)
        place = point_at("", new)
        centre = {} if new == old else {"centre_x_mm": place.x_mm, "centre_y_mm": place.y_mm}
        return replace(row, link=names(row.link, "")[0], **centre)

    def force(row: Any) -> Any:
        if row.link is None:
            return row
        number, point = names(row.link, row.point or "")
        return replace(row, link=number, point=point or row.point)

    number = lambda n: n if n is None else names(n, "")[0]  # noqa: E731
    return replace(
        loads,
        masses=tuple(map(mass, loads.masses)),
        forces=tuple(map(force, loads.forces)),
        process=tuple(map(force, loads.process)),
        springs=tuple(replace(s, from_=held(s.from_), to=held(s.to)) for s in loads.springs),
        torsion_springs=tuple(replace(s, link=number(s.link), on=number(s.on)) for s in loads.torsion_springs),
        pair_friction=tuple(
            replace(
                row,
                pair=row.pair if is_pin(row.pair) else str(number(int(row.pair))),
                link=number(row.link),
                other=number(row.other),
            )
            for row in loads.pair_friction
        ),
    )


def pruned(design: Design) -> Design:
    """The design without rows of loads, cam and marks that hold on to what is not there."""
    drive = design.drive
    points = {link.number: set(link.places) for link in drive.linkage.links}
    pairs = {name for names in points.values() for name in names} | {str(s.link) for s in drive.linkage.sliders}

    def there(number: int | None, point: str | None = None) -> bool:
        return number is None or (number in points and (point is None or point in points[number]))

    loads = drive.loads
    kept = replace(
        loads,
        masses=tuple(m for m in loads.masses if there(m.link)),
        forces=tuple(f for f in loads.forces if there(f.link, f.point)),
        process=tuple(p for p in loads.process if there(p.link, p.point)),
        springs=tuple(s for s in loads.springs if all(there(e.link, e.point) for e in (s.from_, s.to))),
        torsion_springs=tuple(s for s in loads.torsion_springs if there(s.link) and there(s.on) and s.link != s.on),
        pair_friction=tuple(r for r in loads.pair_friction if r.pair in pairs and there(r.link) and there(r.other)),
    )
    cam = drive.cam if drive.cam is not None and there(drive.cam.link, drive.cam.point) else None
    made = with_drive(design, loads=kept, cam=cam)
    if not design.assumed:
        return made
    paths = set(all_paths(made)) if kept == loads and len(points) else set(_unmoved(design, made))
    return replace(made, assumed=tuple(mark for mark in design.assumed if mark in paths))


def _unmoved(before: Design, after: Design) -> Iterator[str]:
    """The paths of what has the same value as before: rows behind one that is gone have other numbers."""
    from core.design.paths import get

    old = set(all_paths(before))
    for path in all_paths(after):
        if path in old and get(before, path) == get(after, path):
            yield path


def renamed(design: Design, names: Mapping[str, str]) -> Design:
    linkage, cam = design.drive.linkage, design.drive.cam
    links = tuple(
        replace(link, points=tuple(replace(p, name=names.get(p.name, p.name)) for p in link.points))
        for link in linkage.links
    )
    branch = tuple(replace(side, joint=names.get(side.joint, side.joint)) for side in linkage.branch)
    drawn = linkage.drawn
    if drawn is not None:
        points = {names.get(p.name, p.name): replace(p, name=names.get(p.name, p.name)) for p in reversed(drawn.points)}
        drawn = replace(drawn, points=tuple(points.values())[::-1])
    loads = loads_of(design, lambda number, point: (number, names.get(point, point)))
    if cam is not None:
        cam = replace(cam, point=names.get(cam.point, cam.point))
        second = getattr(cam.form, "second", None)
        if second is not None:
            cam = replace(
                cam, form=replace(cam.form, second=replace(second, point=names.get(second.point, second.point)))
            )
    friction = tuple(replace(row, pair=names.get(row.pair, row.pair)) for row in loads.pair_friction)
    marks = tuple(_mark_renamed(mark, names) for mark in design.assumed)
    made = replace(linkage, links=links, branch=branch, drawn=drawn)
    return with_drive(design, mechanism=made, cam=cam, loads=replace(loads, pair_friction=friction), assumed=marks)


def _mark_renamed(mark: str, names: Mapping[str, str]) -> str:
    head, found, name = mark.rpartition(".points.")
    return f"{head}{found}{names.get(name, name)}" if head.startswith("linkage.links") else mark


# -- links of a linkage copied ----------------------------------------------------------------------------------


def part_of(design: Design, links: Collection[int]) -> Design:
    """Some links of a design as one of their own: with their points on the frame, the lines they slide on, and their loads."""
    linkage = design.drive.linkage
    chosen = set(links) - {FRAME_LINK}
    names = {name for n in chosen for name in linkage.by_number[n].places}
    frame = Link(FRAME_LINK, tuple(p for p in frame_of(linkage).points if p.name in names))
    kept = replace(
        linkage,
        links=(frame, *(link for link in linkage.links if link.number in chosen)),
        sliders=tuple(s for s in linkage.sliders if s.link in chosen and s.on in {*chosen, FRAME_LINK}),
        drivers=(),
    )
    places = {name: at for name, at in places_of(linkage).items() if name in names}
    bare = replace(with_drive(design, motion=None, cam=None), assumed=())
    return pruned(with_places(bare, places, kept))


def with_part(design: Design, part: Design, shift: complex = 0j) -> tuple[Design, tuple[int, ...]]:
    """Another design's links, with their loads, put into this one beside its own, moved by so much [mm]; and their numbers here."""
    linkage, other = design.drive.linkage, part.drive.linkage
    places, own = places_of(linkage), places_of(other)
    fixed, names, numbers = frame_of(other).places, dict[str, str](), {FRAME_LINK: FRAME_LINK}
    for name in own:
        names[name] = new_name(linkage, name in fixed, (*places, *names.values()))
    for link in other.links:
        if link.number != FRAME_LINK:
            numbers[link.number] = new_number(linkage) + len(numbers) - 1
    copy = renamed(part, names)
    places |= {names[name]: at + shift for name, at in own.items()}
    links = tuple(
        Link(numbers[link.number], link.points) for link in copy.drive.linkage.links if link.number != FRAME_LINK
    )
    frame = Link(FRAME_LINK, (*frame_of(linkage).points, *(point_at(names[n], at + shift) for n, at in fixed.items())))
    sliders = tuple(
        replace(
            s,
            link=numbers[s.link],
            on=numbers[s.on],
            through_x_mm=s.through_x_mm + (shift.real if s.on == FRAME_LINK else 0.0),
            through_y_mm=s.through_y_mm + (shift.imag if s.on == FRAME_LINK else 0.0),
        )
        for s in other.sliders
    )
    made = replace(
        with_links(linkage, {FRAME_LINK: frame}),
        links=(*with_links(linkage, {FRAME_LINK: frame}).links, *links),
        sliders=(*linkage.sliders, *sliders),
    )
    moved = loads_of(copy, lambda n, p: (numbers[n], p), lambda n, at: at + shift if n == FRAME_LINK else at)
    loads = design.drive.loads
    lists = {
        name: (*getattr(loads, name), *getattr(moved, name))
        for name in ("masses", "forces", "springs", "torsion_springs", "pair_friction", "process")
    }
    whole = with_places(with_drive(design, loads=replace(loads, **lists)), places, made)
    return whole, tuple(n for n in numbers.values() if n != FRAME_LINK)


# -- edits of a linkage that is drawn ---------------------------------------------------------------------------


def empty_linkage() -> Linkage:
    """An empty sheet: the frame without a point."""
    return Linkage((Link(FRAME_LINK),), drawn=Drawn())


def with_link(design: Design, spots: Sequence[Spot], length_mm: float | None = None) -> Design:
    """A bar between two spots, or a plate through more: its frame begins at the first, with the second on the x axis. A spot on a
    link gets a pin there. length_mm: of a bar, as typed; else it is measured."""
    linkage = design.drive.linkage
    places, names = places_of(linkage), []
    for spot in spots:
        linkage, name = _set(linkage, places, spot)
        names.append(name)
    if len(set(names)) < len(names) or len(names) < 2:
        raise fault("a link needs two places apart", "another place for its end")
    if any(abs(places[a] - places[b]) < SAME for i, a in enumerate(names) for b in names[:i]):
        raise fault(f"{names[0]} and {names[1]} lie on each other", "places apart")
    number = new_number(linkage)
    link = _tidy(number, {name: places[name] for name in names})
    if length_mm is not None:
        link = Link(number, (link.points[0], LinkPoint(link.points[1].name, length_mm, 0.0), *link.points[2:]))
    return checked(with_places(design, places, without_bare(replace(linkage, links=(*linkage.links, link)))))


def _set(linkage: Linkage, places: dict[str, complex], spot: Spot) -> tuple[Linkage, str]:
    """The name of the point at a spot, made on the link there where it is new; its place is added."""
    if spot.point:
        return linkage, spot.point
    name = new_name(linkage, fixed=spot.link == FRAME_LINK, taken=places)
    places[name] = spot.at
    return (linkage if spot.link is None else _with_point(linkage, spot.link, name, places)), name


def _with_point(linkage: Linkage, number: int, name: str, places: Places) -> Linkage:
    """A point more on a link, where it stands."""
    origin, axis = pose_of(linkage, number, {n: at for n, at in places.items() if n != name})
    local = (places[name] - origin) * axis.conjugate()
    link = linkage.by_number.get(number, Link(number))
    made = Link(number, (*link.points, point_at(name, local)))
    return with_links(linkage, {number: made})


def _tidy(number: int, places: Places) -> Link:
    first, second = list(places.values())[:2]
    turn = (second - first).conjugate() / abs(second - first)
    points = [point_at(name, (at - first) * turn) for name, at in places.items()]
    return Link(number, (points[0], LinkPoint(points[1].name, round(abs(second - first), DECIMALS), 0.0), *points[2:]))


def with_slider(design: Design, spot: Spot, through: complex, angle_deg: float, on: int = FRAME_LINK) -> Design:
    """A block at a spot that slides on a link, along a line through a place of the sheet at this angle on it."""
    linkage = design.drive.linkage
    places = places_of(linkage)
    linkage, name = _set(linkage, places, spot)
    number = new_number(linkage)
    origin, axis = pose_of(linkage, on, places)
    local = (through - origin) * axis.conjugate()
    turned = angle_deg if on == FRAME_LINK else degrees_of(heading_of(angle_deg) * axis.conjugate())
    line = point_at("", local)
    slider = Slider(link=number, on=on, through_x_mm=line.x_mm, through_y_mm=line.y_mm, angle_deg=turned)
    along = heading_of(angle_deg)
    places[name] = through + along * ((places[name] - through) * along.conjugate()).real
    block = Link(number, (LinkPoint(name, 0.0, 0.0),))
    made = replace(linkage, links=(*linkage.links, block), sliders=(*linkage.sliders, slider))
    moved = _reshaped(without_bare(made), design, {name: places[name]}, {n: a for n, a in places.items() if n != name})
    return checked(with_places(design, places, moved))


def with_ground(design: Design, spot: Spot) -> Design:
    """A pivot of the frame at a spot: what has a point there is fixed to it."""
    linkage = design.drive.linkage
    places = places_of(linkage)
    on = FRAME_LINK if spot.link is None else spot.link
    linkage, name = _set(linkage, places, replace(spot, link=on))
    if name not in frame_of(linkage).places:
        linkage = _with_point(linkage, FRAME_LINK, name, places)
    return checked(with_places(design, places, without_bare(linkage)))


def with_pin(design: Design, spot: Spot, links: Sequence[int] = ()) -> Design:
    """A pin that joins these links at a spot; on the sheet one that waits for links."""
    linkage = design.drive.linkage
    places = places_of(linkage)
    if not spot.point and not links and spot.link is None:
        name = new_name(linkage, taken=places)
        places[name] = spot.at
        bare = Link(new_number(linkage), (LinkPoint(name, 0.0, 0.0),))
        return with_places(design, places, replace(linkage, links=(*linkage.links, bare)))
    on: Sequence[int | None] = links or [spot.link]
    first, *others = on
    linkage, name = _set(linkage, places, spot if spot.point else replace(spot, link=first))
    for number in others if not spot.point else links:
        if number is not None and name not in linkage.by_number[number].places:
            linkage = _with_point(linkage, number, name, places)
    return checked(with_places(design, places, linkage))


def with_traced_point(design: Design, spot: Spot) -> Design:
    """A point more on a link."""
    if spot.link is None or spot.point:
        raise fault("a point stands on a link, beside its others", "a place on the face of a link")
    linkage = design.drive.linkage
    places = places_of(linkage)
    linkage, _ = _set(linkage, places, spot)
    return with_places(design, places, linkage)


def with_driving_link(design: Design, number: int, speed_rpm: float | None = None) -> Design:
    """The design led by a link that is pinned to the frame, at speed, or slides on it, by the motion; else by one that slides on a link
    that moves, as the rod of a cylinder does. Where there is no motion yet, it rests as it is drawn."""
    linkage, old = design.drive.linkage, design.drive.linkage.driver
    made = replace(linkage, driver=replace(old, link=number, on=FRAME_LINK))
    slider = next((s for s in linkage.sliders if number in (s.link, s.on) and FRAME_LINK not in (s.link, s.on)), None)
    if driver_pair(made) is None and slider is not None:
        made = replace(made, driver=replace(made.driver, link=slider.link, on=slider.on))
        number = slider.link
    pair = driver_pair(made) if number in made.by_number and number != FRAME_LINK else None
    if pair is None:
        raise fault(
            f"link {number} is not held on the frame by one pair", "a link pinned to the frame, or sliding on it"
        )
    turns, drive = is_pin(pair), design.drive
    suits = drive.motion is not None and drive.motion.unit == ("deg" if turns else "mm")
    kind = CRANK if turns and not suits and drive.cam is None else MOTION
    driver = Driver(number, kind, old.speed_rpm if speed_rpm is None else speed_rpm, made.driver.on)
    if kind == CRANK:
        design = with_drive(design, motion=None)
    drawn = pruned(with_places(design, places_of(linkage), replace(linkage, driver=driver)))
    if kind == CRANK or suits:
        return drawn
    at = drawn.drive.linkage.drawn or Drawn()
    unit, start = ("mm", at.driver_mm) if at.driver_deg is None else ("deg", at.driver_deg)
    return with_drive(drawn, motion=Motion(start or 0.0, (Segment(360.0, 0.0),), unit))


def with_moved(design: Design, to: Places) -> Design:
    """Points put elsewhere: the links that have them change, all else stays where it is. What slides keeps to its line; a point of
    the frame is moved on it."""
    linkage = design.drive.linkage
    before = places_of(linkage)
    to = {name: _on_lines(linkage, name, at, before) for name, at in to.items() if name in before}
    after = {**before, **to}
    for link in linkage.links:
        if link.number == FRAME_LINK:
            continue
        for one, other in combinations([name for name in link.places if name in after], 2):
            if {one, other} & set(to) and abs(after[one] - after[other]) < SAME:
                raise fault(f"{other} would lie on {one} of the same link", "points apart from each other")
    return with_places(design, after, _reshaped(linkage, design, to, before))


def _on_lines(linkage: Linkage, name: str, at: complex, places: Places) -> complex:
    """The place on the line of a block that has the point, where one has it."""
    for slider in linkage.sliders:
        if name in linkage.by_number[slider.link].places and len(linkage.by_number[slider.link].points) == 1:
            through, along = line_of_slider(linkage, slider, places)
            return through + along * ((at - through) * along.conjugate()).real
    return at


def _reshaped(linkage: Linkage, design: Design, to: Places, before: Places) -> Linkage:
    """The links with those of their points elsewhere; one that is only moved or turned keeps its numbers."""
    after = {**before, **to}
    made: dict[int, Link] = {}
    for link in linkage.links:
        names = [name for name in link.places if name in to]
        if names and (link.number == FRAME_LINK or not _same_shape(link, after)):
            made[link.number] = _with_points_at(linkage, design, link, names, after, before)
    return with_links(linkage, made)


def _same_shape(link: Link, places: Places) -> bool:
    known = [(at, places[name]) for name, at in link.places.items() if name in places]
    if len(known) < 2:
        return True
    (a, p), (b, q), *others = known
    if abs(abs(b - a) - abs(q - p)) > SAME or a == b:
        return False
    turn = (q - p) / (b - a)
    return all(abs(p + (c - a) * turn - r) <= SAME for c, r in others)


def _with_points_at(
    linkage: Linkage, design: Design, link: Link, names: Sequence[str], after: Places, before: Places
) -> Link:
    if link.number != FRAME_LINK and _is_tidy(design, link):
        return _tidy(link.number, {name: after[name] for name in link.places})
    origin, axis = pose_of(linkage, link.number, before)
    new = {name: point_at(name, (after[name] - origin) * axis.conjugate()) for name in names}
    return Link(link.number, tuple(new.get(p.name, p) for p in link.points))


def _is_tidy(design: Design, link: Link) -> bool:
    """Whether a link's frame begins at its first point and leads to the second, and nothing else stands in it."""
    rows = _rows_on(design, link.number)
    if rows or any(link.number in (s.link, s.on) for s in design.drive.linkage.sliders) or len(link.points) < 2:
        return len(link.points) == 2 and link.points[0].x_mm == link.points[0].y_mm == link.points[1].y_mm == 0.0
    first, second, *_ = link.places.values()
    return first == 0 and second.imag == 0.0 and second.real > 0.0


def _rows_on(design: Design, number: int) -> list[Any]:
    """Rows of the loads that hold on to a place of a link in its frame."""
    loads = design.drive.loads
    ends = [end for spring in loads.springs for end in (spring.from_, spring.to)]
    return [row for row in (*loads.masses, *ends) if row.link == number and getattr(row, "point", None) is None]


def with_length(design: Design, number: int, one: str, other: str, length_mm: float) -> Design:
    """A link on which two points are so far apart: the second goes along their line. Where the others stand then is for
    ``core.mechanism.drawn.settled`` to find."""
    linkage = design.drive.linkage
    link = linkage.by_number[number]
    a, b = link.places[one], link.places[other]
    if not length_mm > 0.0 or a == b:
        raise fault(f"a length of {length_mm:g} mm", "> 0")
    along = (b - a) / abs(b - a)
    there = a + along * length_mm
    x, y = (there.real, there.imag)
    if along.imag == 0.0:
        x, y = a.real + math.copysign(length_mm, along.real), a.imag
    elif along.real == 0.0:
        x, y = a.real, a.imag + math.copysign(length_mm, along.imag)
    made = Link(number, tuple(LinkPoint(other, x + 0.0, y + 0.0) if p.name == other else p for p in link.points))
    return with_drive(design, mechanism=with_links(linkage, {number: made}))


def without(design: Design, points: Collection[str] = (), links: Collection[int] = ()) -> Design:
    """Points and links taken away, with what holds on to them, and so on down the chain. A bar ends with either of its pins, a block with
    its own pin or with the link that it slides on; a link with two pins or more stays without its line."""
    linkage = design.drive.linkage
    places = places_of(linkage)
    gone = set(links) - {FRAME_LINK}
    kept: list[Link] = []
    for link in linkage.links:
        left = tuple(p for p in link.points if p.name not in points)
        few = len(left) < min(2, len(link.points))
        if link.number == FRAME_LINK or (link.number not in gone and not (few and left != link.points)):
            kept.append(replace(link, points=left))
    sliders, before = linkage.sliders, -1
    while len(kept) != before:
        before, numbers = len(kept), {link.number for link in kept}
        sliders = tuple(s for s in sliders if {s.link, s.on} <= numbers)
        lost = {s.link for s in linkage.sliders} - {s.link for s in sliders}
        kept = [link for link in kept if link.number not in lost or len(link.points) > 1]
    made = replace(linkage, links=tuple(kept), sliders=sliders)
    remaining, driver = {link.number for link in kept}, linkage.driver
    pinned = {number for pin in pins(made) for number in pin.links}
    drivers = tuple(
        d for d in linkage.drivers if {d.link, d.on} <= remaining and (d.link in pinned or input_slides(made, d))
    )
    if not {driver.link, driver.on} <= remaining or (driver_pair(linkage) and not driver_pair(made)):
        driver = NO_DRIVER
    return pruned(with_places(design, places, replace(made, drivers=drivers, driver=driver)))


def with_joined(design: Design, one: str, other: str) -> Design:
    """Two pins made one, at the place of the first; on the frame where either is."""
    linkage = design.drive.linkage
    before = places_of(linkage)
    if other in frame_of(linkage).places and one not in frame_of(linkage).places:
        one, other = other, one
    for link in linkage.links:
        if link.number != FRAME_LINK and {one, other} <= set(link.places):
            raise fault(f"{one} and {other} are both on link {link.number}", "pins of two links")
    frame = replace(frame_of(linkage), points=tuple(p for p in frame_of(linkage).points if p.name != other))
    moved = with_moved(design, {other: before[one]})
    made = renamed(with_drive(moved, mechanism=with_links(moved.drive.linkage, {FRAME_LINK: frame})), {other: one})
    places = {**places_of(made.drive.linkage), one: before[one]}
    return checked(with_places(made, places, without_bare(made.drive.linkage)))


def with_split(design: Design, name: str) -> Design:
    """A pin taken apart: the first link keeps its name, each other gets a point of its own at the place."""
    linkage = design.drive.linkage
    places = places_of(linkage)
    on = [link for link in linkage.links if name in link.places]
    if len(on) < 2:
        raise fault(f"{name} joins no links", "a pin of two links or more")
    for link in on[1:]:
        own = new_name(linkage, taken=places)
        places[own] = places[name]
        points = tuple(replace(p, name=own) if p.name == name else p for p in link.points)
        linkage = with_links(linkage, {link.number: Link(link.number, points)})
        design = with_drive(design, loads=loads_of(design, partial(_apart, name, link.number, own)))
    return with_places(design, places, linkage)


def _apart(name: str, of: int, own: str, number: int, point: str) -> tuple[int, str]:
    """Link and point of what held on to a pin that is split."""
    return number, own if number == of and point == name else point


def with_welded(design: Design, one: int, other: int) -> Design:
    """Two links made one plate as they stand: the first keeps its number and its frame, masses are put together."""
    if FRAME_LINK in (one, other):
        one, other = FRAME_LINK, max(one, other)
    linkage = design.drive.linkage
    places = places_of(linkage)
    if one == other or not {one, other} <= set(linkage.by_number):
        raise fault("one link", "two links")
    to, own = pose_of(linkage, one, places), pose_of(linkage, other, places)
    turn = own[1] * to[1].conjugate()
    carried = lambda at: (own[0] + at * own[1] - to[0]) * to[1].conjugate()  # noqa: E731
    here = linkage.by_number[one]
    added = tuple(point_at(n, carried(at)) for n, at in linkage.by_number[other].places.items() if n not in here.places)
    sliders = []
    for s in linkage.sliders:
        if {s.link, s.on} == {one, other}:
            continue
        if s.link == other:
            raise fault(f"link {other} slides on link {s.on}", "links that do not slide, or weld the other to it")
        if s.on == other:
            through = point_at("", carried(complex(s.through_x_mm, s.through_y_mm)))
            s = replace(s, on=one, through_x_mm=through.x_mm, through_y_mm=through.y_mm,
                        angle_deg=round(s.angle_deg + degrees_of(turn), DECIMALS) + 0.0)  # fmt: skip
        sliders.append(s)
    links = tuple(
        replace(link, points=(*here.points, *added)) if link.number == one else link
        for link in linkage.links
        if link.number != other
    )
    driver = replace(linkage.driver, link=one) if linkage.driver.link == other != one != FRAME_LINK else linkage.driver
    driver = replace(driver, on=one) if driver.on == other and driver.link != one else driver
    renumbered = (
        replace(d, link=one if d.link == other else d.link, on=one if d.on == other else d.on) for d in linkage.drivers
    )
    drivers = tuple(d for d in renumbered if d.link not in (d.on, FRAME_LINK))
    made = replace(linkage, links=links, sliders=tuple(sliders), driver=driver, drivers=drivers)
    loads = loads_of(
        design, lambda n, p: (one if n == other else n, p), lambda n, at: carried(at) if n == other else at
    )
    masses = [m for m in loads.masses if m.link != FRAME_LINK]
    pair = [m for m in masses if m.link == one]
    if len(pair) == 2:
        masses = [_as_one(*pair) if m is pair[0] else m for m in masses if m is not pair[1]]
    loads = replace(loads, masses=tuple(masses), forces=tuple(f for f in loads.forces if f.link != FRAME_LINK))
    return pruned(with_places(with_drive(design, loads=loads), places, made))


def _as_one(a: LinkMass, b: LinkMass) -> LinkMass:
    """Two masses of one link: about the common centre, by Steiner."""
    mass = a.mass_kg + b.mass_kg
    p, q = complex(a.centre_x_mm, a.centre_y_mm), complex(b.centre_x_mm, b.centre_y_mm)
    centre = (p * a.mass_kg + q * b.mass_kg) / mass if mass else p
    steiner = (a.mass_kg * abs(p - centre) ** 2 + b.mass_kg * abs(q - centre) ** 2) * 1e-6
    at = point_at("", centre)
    return replace(a, mass_kg=mass, inertia_kg_m2=a.inertia_kg_m2 + b.inertia_kg_m2 + steiner,
                   centre_x_mm=at.x_mm, centre_y_mm=at.y_mm)  # fmt: skip


def with_name(design: Design, old: str, new: str) -> Design:
    """A point that is called otherwise, wherever it is named."""
    taken = {name for link in design.drive.linkage.links for name in link.places}
    if not new.isidentifier() or (new in taken and new != old):
        raise fault(
            f"{new!r} is {'taken' if new in taken else 'no name of a point'}", "letters, digits and _, a letter first"
        )
    return renamed(design, {old: new})


def with_mirrored(design: Design, links: Collection[int], through: complex, along: complex) -> Design:
    """Links mirrored in a line through a place, with the points that they share with others, and the lines they slide on."""
    linkage = design.drive.linkage
    before = places_of(linkage)
    flip = lambda at: through + along * ((at - through) / along).conjugate()  # noqa: E731
    moving = set(links) - {FRAME_LINK}
    names = {name for n in moving for name in linkage.by_number[n].places if name in before}
    flipped = {n: Link(n, tuple(replace(p, y_mm=-p.y_mm + 0.0) for p in linkage.by_number[n].points)) for n in moving}
    to = {name: flip(before[name]) for name in names}
    rest = replace(linkage, links=tuple(link for link in linkage.links if link.number not in moving))
    around = _reshaped(rest, design, to, before)
    made = replace(
        linkage, links=tuple(flipped.get(link.number) or around.by_number[link.number] for link in linkage.links)
    )
    sliders = []
    for s in linkage.sliders:
        if s.on in moving:  # the line lies in the frame that is mirrored
            s = replace(s, through_y_mm=-s.through_y_mm + 0.0, angle_deg=-s.angle_deg + 0.0)
        elif s.link in moving and s.on == FRAME_LINK:
            line = point_at("", flip(complex(s.through_x_mm, s.through_y_mm)))
            turned = degrees_of(along * (heading_of(s.angle_deg) / along).conjugate())
            s = replace(s, through_x_mm=line.x_mm, through_y_mm=line.y_mm, angle_deg=turned)
        sliders.append(s)
    loads = loads_of(design, lambda n, p: (n, p), lambda n, at: at.conjugate() if n in moving else at)
    after = {**before, **to}
    return with_places(with_drive(design, loads=loads), after, replace(made, sliders=tuple(sliders)))
