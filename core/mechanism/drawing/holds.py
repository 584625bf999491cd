"""What holds on to the points and links of a linkage: loads, cam and marks, when these get other names or are gone."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from core.design.elements import Attachment
from core.design.linkage import LinkMass
from core.design.paths import all_paths
from core.design.topology import is_pin
from core.design.whole import Design, with_drive
from core.mechanism.drawing.sheet import point_at

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
