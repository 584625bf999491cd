"""Copies of links, and loads, marks and the cam that refer to the links and points of a drawing."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from typing import Any

from core.design.design import Design, with_drive
from core.design.linkage import FRAME_LINK, Link, LinkMass
from core.design.loads import Attachment
from core.design.paths import all_paths
from core.design.topology import is_pin
from core.mechanism.drawing_targets import coincident_point
from core.mechanism.drawn import (
    frame_link,
    link_point,
    new_name,
    new_number,
    point_positions,
    with_links,
    with_positions,
)

# -- loads, marks and cam that refer to points and links --------------------------------------------------------


_Names = Callable[[int, str], tuple[int, str]]


def loads_of(design: Design, names: _Names, at: Callable[[int, complex], complex] | None = None) -> Any:
    """The loads of a design with new references.

    names: new link and point from the old ones; at: new coordinates [mm] in a link's frame from link and old coordinates.
    """
    loads = design.drive.loads
    move = at or (lambda _, position: position)

    def attachment(end: Attachment) -> Attachment:
        if end.point is None and end.x_mm is not None and end.y_mm is not None:
            old = complex(end.x_mm, end.y_mm)
            new = move(end.link, old)
            if new != old:
                rounded = link_point("", new)
                end = replace(end, x_mm=rounded.x_mm, y_mm=rounded.y_mm)
        number, point = names(end.link, end.point or "")
        return replace(end, link=number, point=point or None)

    def mass(row: LinkMass) -> LinkMass:
        old = complex(row.centre_x_mm, row.centre_y_mm)
        new = move(row.link, old)
        rounded = link_point("", new)
        centre = {} if new == old else {"centre_x_mm": rounded.x_mm, "centre_y_mm": rounded.y_mm}
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
        springs=tuple(replace(s, from_=attachment(s.from_), to=attachment(s.to)) for s in loads.springs),
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
    """The design without the loads, the cam and the marks whose link or point is missing."""
    drive = design.drive
    points = {link.number: set(link.places) for link in drive.linkage.links}
    pairs = {name for names in points.values() for name in names} | {str(s.link) for s in drive.linkage.sliders}

    def exists(number: int | None, point: str | None = None) -> bool:
        return number is None or (number in points and (point is None or point in points[number]))

    loads = drive.loads
    remaining = replace(
        loads,
        masses=tuple(m for m in loads.masses if exists(m.link)),
        forces=tuple(f for f in loads.forces if exists(f.link, f.point)),
        process=tuple(p for p in loads.process if exists(p.link, p.point)),
        springs=tuple(s for s in loads.springs if all(exists(e.link, e.point) for e in (s.from_, s.to))),
        torsion_springs=tuple(s for s in loads.torsion_springs if exists(s.link) and exists(s.on) and s.link != s.on),
        pair_friction=tuple(r for r in loads.pair_friction if r.pair in pairs and exists(r.link) and exists(r.other)),
    )
    cam = drive.cam if drive.has_disk and exists(drive.cam.link, drive.cam.point) else None
    result = with_drive(design, loads=remaining, cam=cam)
    if not design.assumed:
        return result
    paths = set(all_paths(result)) if remaining == loads and len(points) else set(_unchanged_paths(design, result))
    return replace(result, assumed=tuple(mark for mark in design.assumed if mark in paths))


def _unchanged_paths(before: Design, after: Design) -> Iterator[str]:
    """Paths with the same value as before; rows behind a removed one have new numbers."""
    from core.design.paths import get

    old = set(all_paths(before))
    for path in all_paths(after):
        if path in old and get(before, path) == get(after, path):
            yield path


def renamed(design: Design, names: Mapping[str, str]) -> Design:
    """The design with points renamed, old name -> new name, wherever they occur."""
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
    linkage = replace(linkage, links=links, branch=branch, drawn=drawn)
    return with_drive(design, mechanism=linkage, cam=cam, loads=replace(loads, pair_friction=friction), assumed=marks)


def _mark_renamed(mark: str, names: Mapping[str, str]) -> str:
    link, separator, name = mark.rpartition(".points.")
    return f"{link}{separator}{names.get(name, name)}" if link.startswith("linkage.links") else mark


# -- copies of links --------------------------------------------------------------------------------------------


def part_of(design: Design, links: Collection[int]) -> Design:
    """Some links of a design as a separate design, with their pivots on the frame, the lines of their sliders, and their loads."""
    linkage = design.drive.linkage
    chosen = set(links) - {FRAME_LINK}
    names = {name for n in chosen for name in linkage.by_number[n].places}
    frame = Link(FRAME_LINK, tuple(p for p in frame_link(linkage).points if p.name in names))
    part = replace(
        linkage,
        links=(frame, *(link for link in linkage.links if link.number in chosen)),
        sliders=tuple(s for s in linkage.sliders if s.link in chosen and s.on in {*chosen, FRAME_LINK}),
        drivers=(),
    )
    places = {name: at for name, at in point_positions(linkage).items() if name in names}
    bare = replace(with_drive(design, motion=None, cam=None), assumed=())
    return pruned(with_positions(bare, places, part))


def with_part(design: Design, part: Design, shift: complex = 0j) -> tuple[Design, tuple[int, ...]]:
    """The design with the links and loads of another one added, and the numbers of the added links.

    shift: displacement of the added links [mm], repeated until none of their points is on another point.
    """
    linkage, other = design.drive.linkage, part.drive.linkage
    places, part_places = point_positions(linkage), point_positions(other)
    step = shift
    while step and any(coincident_point(places, at + shift) for at in part_places.values()):
        shift += step
    fixed, names, numbers = frame_link(other).places, dict[str, str](), {FRAME_LINK: FRAME_LINK}
    for name in part_places:
        names[name] = new_name(linkage, name in fixed, (*places, *names.values()))
    for link in other.links:
        if link.number != FRAME_LINK:
            numbers[link.number] = new_number(linkage) + len(numbers) - 1
    copy = renamed(part, names)
    places |= {names[name]: at + shift for name, at in part_places.items()}
    links = tuple(
        Link(numbers[link.number], link.points) for link in copy.drive.linkage.links if link.number != FRAME_LINK
    )
    frame = Link(
        FRAME_LINK, (*frame_link(linkage).points, *(link_point(names[n], at + shift) for n, at in fixed.items()))
    )
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
    with_frame = with_links(linkage, {FRAME_LINK: frame})
    combined = replace(with_frame, links=(*with_frame.links, *links), sliders=(*linkage.sliders, *sliders))
    added = loads_of(copy, lambda n, p: (numbers[n], p), lambda n, at: at + shift if n == FRAME_LINK else at)
    loads = design.drive.loads
    lists = {
        name: (*getattr(loads, name), *getattr(added, name))
        for name in ("masses", "forces", "springs", "torsion_springs", "pair_friction", "process")
    }
    result = with_positions(with_drive(design, loads=replace(loads, **lists)), places, combined)
    return result, tuple(n for n in numbers.values() if n != FRAME_LINK)
