"""Where the points and the links of a drawn linkage stand on the sheet."""

from __future__ import annotations

import cmath
import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from itertools import count

from core.design.linkage import FRAME_LINK, Drawn, Link, Linkage, LinkPoint, Slider
from core.design.topology import driver_pair, is_pin, slider_of
from core.design.whole import Design, with_drive
from core.errors import DesignError, Fault
from core.frozen import frozen

Places = Mapping[str, complex]
"""Name of a point -> where it stands on the sheet [mm]."""
Pose = tuple[complex, complex]
"""Origin [mm] and x axis, of length 1, of a link's frame on the sheet."""

DECIMALS = (
    9  # of coordinates that are measured, mm: a closed loop of them is open by no more than rounding would make it
)
SAME = 1e-9  # mm: places that are one


@frozen
class Spot:
    """Where a tool sets something: a place on the sheet [mm], with the point that stands there, or the link whose face is there."""

    at: complex
    point: str = ""
    link: int | None = None


def places_of(linkage: Linkage) -> dict[str, complex]:
    """Every point whose place is known: those of the frame, those that are drawn, and what these carry along."""
    drawn = linkage.drawn
    places = {} if drawn is None else {p.name: complex(p.x_mm, p.y_mm) for p in drawn.points}
    places |= frame_of(linkage).places
    left = list(linkage.links)
    while ready := [link for link in left if _placed(linkage, link, places)]:
        for link in ready:
            origin, axis = pose_of(linkage, link.number, places)
            for name, at in link.places.items():
                places.setdefault(name, origin + at * axis)
        left = [link for link in left if link not in ready]
    return places


def _placed(linkage: Linkage, link: Link, places: Places) -> bool:
    known = [at for name, at in link.places.items() if name in places]
    sliding = any(s.link == link.number for s in linkage.sliders)
    return any(at != known[0] for at in known) or (bool(known) and (sliding or len(link.points) == 1))


def frame_of(linkage: Linkage) -> Link:
    """The link that stands still; one without points where there is none yet."""
    return linkage.by_number.get(FRAME_LINK, Link(FRAME_LINK))


def pose_of(linkage: Linkage, number: int, places: Places) -> Pose:
    """Where a link's frame stands: by the two of its points that lie farthest apart; of a link with one, along the line on which it
    slides, else unturned."""
    if number == FRAME_LINK:
        return 0j, 1.0 + 0j
    known = [(at, places[name]) for name, at in linkage.by_number[number].places.items() if name in places]
    if not known:
        return 0j, 1.0 + 0j
    local, at = known[0]
    far, there = max(known, key=lambda row: abs(row[0] - local))
    axis = (there - at) / (far - local) if far != local else 1.0 + 0j
    if far == local:
        slider = next((s for s in linkage.sliders if s.link == number and s.on != number), None)
        if slider is not None:
            axis = pose_of(linkage, slider.on, places)[1] * heading_of(slider.angle_deg)
    axis = axis / abs(axis) if axis else 1.0 + 0j
    return at - local * axis, axis


def line_of_slider(linkage: Linkage, slider: Slider, places: Places) -> Pose:
    """A point of the line on which a link slides, and its direction, on the sheet."""
    origin, axis = pose_of(linkage, slider.on, places)
    return origin + complex(slider.through_x_mm, slider.through_y_mm) * axis, axis * heading_of(slider.angle_deg)


def heading_of(degrees: float) -> complex:
    exact = {0.0: 1.0 + 0j, 90.0: 1j, 180.0: -1.0 + 0j, -180.0: -1.0 + 0j, -90.0: -1j, 270.0: -1j}
    return exact.get(degrees, cmath.exp(1j * math.radians(degrees)))


def degrees_of(direction: complex) -> float:
    return round(math.degrees(cmath.phase(direction)), DECIMALS) + 0.0


def with_places(design: Design, places: Places, linkage: Linkage | None = None) -> Design:
    """The design whose points are drawn at these places, the driver as it stands there, and what follows it by a ratio; branches give
    way to what is drawn."""
    linkage = design.drive.linkage if linkage is None else linkage
    fixed = frame_of(linkage).places
    there = {name for link in linkage.links for name in link.places}
    points = tuple(point_at(name, at) for name, at in places.items() if name in there and name not in fixed)
    deg, mm = _driver_at(linkage, places)
    if linkage.drivers and (deg is not None or mm is not None):
        from core.mechanism.drawing.inputs import driver_turned

        at, drivers = driver_turned(linkage, places, deg if deg is not None else mm or 0.0)
        deg = at if deg is not None else None
        linkage = replace(linkage, drivers=drivers)
    followed = {each.motion for each in linkage.drivers}
    linkage = replace(linkage, motions=tuple(each for each in linkage.motions if each.name in followed))
    return with_drive(
        design, mechanism=replace(linkage, drawn=Drawn(driver_deg=deg, driver_mm=mm, points=points), branch=())
    )


def _driver_at(linkage: Linkage, places: Places) -> tuple[float | None, float | None]:
    """Where the driver stands, deg or mm; neither where nothing drives."""
    link = linkage.driver.link
    pair = driver_pair(linkage) if link in linkage.by_number and link != FRAME_LINK else None
    if pair is None:
        return None, None
    if is_pin(pair):
        (_, axis), (_, base) = (pose_of(linkage, n, places) for n in (link, linkage.driver.on))
        return degrees_of(axis * base.conjugate()), None
    slider = slider_of(linkage, pair)
    origin, _ = pose_of(linkage, slider.link, places)
    through, along = line_of_slider(linkage, slider, places)
    return None, round(((origin - through) * along.conjugate()).real, DECIMALS)


def point_at(name: str, at: complex) -> LinkPoint:
    return LinkPoint(name, round(at.real, DECIMALS) + 0.0, round(at.imag, DECIMALS) + 0.0)


def new_name(linkage: Linkage, fixed: bool = False, taken: Collection[str] = ()) -> str:
    """A name that no point has: O1, O2 on the frame, else A, B, C."""
    used = {name for link in linkage.links for name in link.places} | set(taken)
    letters = [chr(ord("A") + i) for i in range(26) if chr(ord("A") + i) != "O"]
    names = (f"O{i}" for i in count(1)) if fixed else (f"{x}{n or ''}" for n in count() for x in letters)
    return next(name for name in names if name not in used)


def new_number(linkage: Linkage) -> int:
    """A number that no link has."""
    return max([FRAME_LINK, *(link.number for link in linkage.links)]) + 1


def with_links(linkage: Linkage, new: Mapping[int, Link]) -> Linkage:
    there = {link.number for link in linkage.links}
    links = tuple(new.get(link.number, link) for link in linkage.links)
    return replace(linkage, links=(*(link for n, link in new.items() if n not in there), *links))


def without_bare(linkage: Linkage) -> Linkage:
    """Without pins that waited for a link, and have one."""
    held = {number for s in linkage.sliders for number in (s.link, s.on)}

    def waits(link: Link) -> bool:
        return len(link.points) == 1 and link.number != FRAME_LINK and link.number not in held

    on = [name for link in linkage.links if not waits(link) for name in link.places]
    return replace(
        linkage, links=tuple(link for link in linkage.links if not (waits(link) and link.points[0].name in on))
    )


def checked(design: Design) -> Design:
    """The design, where no two links share two pins."""
    links = design.drive.linkage.links
    for i, one in enumerate(links):
        for other in links[:i]:
            shared = [name for name in one.places if name in other.places]
            if len(shared) > 1:
                raise fault(
                    f"{' and '.join(shared)} join links {other.number} and {one.number} twice, which makes them one body",
                    "one pin between two links, or weld them",
                )
    return design


def fault(problem: str, allowed: str) -> DesignError:
    return DesignError([Fault("linkage", "drawing", problem, allowed)])


def edges_of(link: Link) -> Iterable[tuple[str, str]]:
    """The pairs of a link's points whose distance is its form: of a bar one, of a plate its outline."""
    names = list(link.places)
    if len(names) == 2:
        return ((names[0], names[1]),)
    return tuple(zip(names, names[1:] + names[:1], strict=True)) if len(names) > 2 else ()
