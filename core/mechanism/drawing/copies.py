"""Links of a linkage copied: beside themselves, or into another design."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from core.design.linkage import FRAME_LINK, Link
from core.design.whole import Design, with_drive
from core.mechanism.drawing.holds import loads_of, pruned, renamed
from core.mechanism.drawing.sheet import frame_of, new_name, new_number, places_of, point_at, with_links, with_places


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
