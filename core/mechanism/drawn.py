"""A linkage as it is drawn: where the driver stands there, which assembly is nearest, and the same told by signs."""

from __future__ import annotations

import cmath
import math
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import count
from math import degrees, inf, radians

import numpy as np

from core.design import FRAME_LINK, Design, Drawn, Linkage, LinkPoint
from core.design.design import with_drive
from core.design.linkage import NO_DRIVER, RACK, Link, SecondDriver, Slider
from core.design.topology import SolutionStep, driver_pair, driver_turns, input_slides, is_pin, pins, slider_of
from core.errors import DesignError, Fault, NoPosition
from core.frozen import frozen
from core.mechanism.branches import Branch
from core.mechanism.kinematics import Pose
from core.mechanism.linkage import SolutionPlan
from core.mechanism.mechanism import at_driver, solve
from core.motion import motion_at, program

# -- where the points and the links of a drawn linkage stand on the sheet ---------------------------------------


Places = Mapping[str, complex]
"""Name of a point -> where it stands on the sheet [mm]."""
LinkPose = tuple[complex, complex]
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


def pose_of(linkage: Linkage, number: int, places: Places) -> LinkPose:
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


def line_of_slider(linkage: Linkage, slider: Slider, places: Places) -> LinkPose:
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


# -- second inputs of a linkage that is drawn -------------------------------------------------------------------


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
    there = motion_at(program(motion), at_driver(np.deg2rad([driver])))[0]
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


# -- A drawing put together -------------------------------------------------------------------------------------


STEPS = 60
_CLOSED = 1e-12  # of the size
_LONGEST = 0.2  # of the size: what one step may move a point


def settled(design: Design, keeps_driver: bool = True) -> Design:
    """The design drawn so that its links fit: by Newton's method from where it is drawn, each step the shortest that closes it.

    keeps_driver: the driver keeps its angle, where one is pinned to the frame, and what follows it by a ratio its own.
    Raises NoPosition where the links do not meet.
    """
    linkage = design.drive.linkage
    places = places_of(linkage)
    fixed = set(frame_of(linkage).places)
    if keeps_driver and linkage.driver.on == FRAME_LINK and (pivot := driver_pair(linkage)) in fixed:
        crank = linkage.by_number[linkage.driver.link]
        axis = pose_of(linkage, crank.number, places)[1]
        places |= {name: places[pivot] + (at - crank.places[pivot]) * axis for name, at in crank.places.items()}
        fixed |= set(crank.places)
        places, fixed = second_inputs_set(linkage, places, fixed)
    return with_places(design, closed(linkage, places, fixed))


def closed(linkage: Linkage, places: Mapping[str, complex], fixed: Collection[str]) -> dict[str, complex]:
    """The places [mm] moved, but for those of the fixed points, so that the links fit. Raises NoPosition where they do not meet."""
    free = [name for name in places if name not in fixed]
    size = max([1e-9, *(abs(at) for link in linkage.links for at in link.places.values())])
    z = np.array([places[name] for name in free], dtype=complex)

    def now(z: np.ndarray) -> dict[str, complex]:
        return {**places, **dict(zip(free, map(complex, z), strict=True))}

    index = {name: i for i, name in enumerate(free)}
    for _ in range(STEPS):
        rows = list(_equations(linkage, now(z)))
        open_ = np.array([value for value, _ in rows])
        if not rows or np.max(np.abs(open_)) <= _CLOSED * size:
            return now(z)
        slopes = np.zeros((len(rows), 2 * len(free)))
        for i, (_, row) in enumerate(rows):
            for name, (x, y) in row.items():
                if name in index:
                    slopes[i, 2 * index[name]] += x
                    slopes[i, 2 * index[name] + 1] += y
        step = np.linalg.lstsq(slopes, -open_, rcond=1e-9)[0]
        moved = step[0::2] + 1j * step[1::2]
        worst = float(np.max(np.abs(moved), initial=0.0))
        z = z + moved * min(1.0, _LONGEST * size / worst if worst else 1.0)
    worst = float(np.max(np.abs(open_)))
    if worst <= 1e-9 * size:
        return now(z)
    raise NoPosition(
        f"the links do not meet: as near as they come, {worst:.6g} mm are left open",
        "linkage",
        "another length, or place",
    )


Row = tuple[float, dict[str, tuple[float, float]]]
"""What is open [mm], and its slopes by x and y of the points."""


def _equations(linkage: Linkage, places: dict[str, complex]) -> Iterator[Row]:
    for link in linkage.links:
        known = [(name, at) for name, at in link.places.items() if name in places]
        if link.number == FRAME_LINK or len(known) < 2:
            continue
        (a, p), *others = known
        b, q = max(others, key=lambda row: abs(row[1] - p))
        length = abs(q - p)
        if not length:
            continue
        along = places[b] - places[a]
        unit = along / abs(along) if along else 1.0 + 0j
        yield abs(along) - length, {a: (-unit.real, -unit.imag), b: (unit.real, unit.imag)}
        for c, r in others:
            if c == b:
                continue
            k = (r - p) / (q - p)  # c = a + k (b - a)
            gap = places[c] - places[a] - k * along
            yield gap.real, {c: (1.0, 0.0), a: (k.real - 1.0, -k.imag), b: (-k.real, k.imag)}
            yield gap.imag, {c: (0.0, 1.0), a: (k.imag, k.real - 1.0), b: (-k.imag, -k.real)}
    yield from _on_lines(linkage, places)


def _on_lines(linkage: Linkage, places: dict[str, complex]) -> Iterator[Row]:
    """Points of what slides are on the line, seen from the link that carries it; a link of two points is not turned against it."""
    for slider in linkage.sliders:
        heading = complex(np.exp(1j * np.radians(slider.angle_deg)))
        through = complex(slider.through_x_mm, slider.through_y_mm)
        mine = linkage.by_number[slider.link].places
        for name, at in mine.items():
            if name not in places:
                continue
            if slider.on == FRAME_LINK:
                normal = 1j * heading
                offset = at.imag
                gap = ((places[name] - through) * normal.conjugate()).real - offset
                yield gap, {name: (normal.real, normal.imag)}
                continue
            base = [(n, l) for n, l in linkage.by_number[slider.on].places.items() if n in places]
            if len(base) < 2:
                continue
            (a, p), *others = base
            b, q = max(others, key=lambda row: abs(row[1] - p))
            k = (1j * heading) / (q - p)  # normal = k (b - a), of length 1
            m = (through - p) / (q - p)  # a place of the line = a + m (b - a)
            along = places[b] - places[a]
            normal, beside = k * along, places[name] - places[a] - m * along
            gap = (beside * normal.conjugate()).real - at.imag
            # d gap = Re(d beside · n*) + Re(beside · (k d along)*)
            own, carried = normal, -m.conjugate() * normal + beside * k.conjugate()
            yield (
                gap,
                {
                    name: (own.real, own.imag),
                    b: (carried.real, carried.imag),
                    a: (-own.real - carried.real, -own.imag - carried.imag),
                },
            )


# -- A linkage as it is drawn -----------------------------------------------------------------------------------


_MM = 1e-3
_TIE = 1e-9  # of the size: assemblies that miss what is drawn by as much
_DIGITS = 6  # of a millimetre, and of a degree, that are drawn


def drawn_place(drawn: Drawn) -> float:
    """Where the driver stands in the drawn pose [rad or m]."""
    if drawn.driver_mm is not None:
        return drawn.driver_mm * _MM
    return radians(drawn.driver_deg or 0.0)


def as_drawn(linkage: Linkage, place: float, poses: Mapping[int, Pose]) -> Linkage:
    """The linkage with what stands in these poses (n = 1) as drawn, instead of its signs; place: of its driver [rad or m]."""
    drawn: dict[str, LinkPoint] = {}
    for link in linkage.links:
        for name, at in link.places.items() if link.number != FRAME_LINK else ():
            z = complex(poses[link.number].carried(at * _MM)[0][0]) / _MM
            drawn.setdefault(name, LinkPoint(name, round(z.real, _DIGITS) + 0.0, round(z.imag, _DIGITS) + 0.0))
    fixed = linkage.by_number[FRAME_LINK].places
    points = tuple(point for name, point in drawn.items() if name not in fixed)
    if driver_turns(linkage):
        return replace(linkage, branch=(), drawn=Drawn(round(degrees(place), _DIGITS) + 0.0, None, points))
    return replace(linkage, branch=(), drawn=Drawn(None, round(place / _MM, _DIGITS) + 0.0, points))


def misses(plan: SolutionPlan, poses: Mapping[int, Pose], links: Iterable[int]) -> np.ndarray:
    """How far the drawn points of these links are from where they stand in the poses (n,) [m]: root of the sum of squares."""
    assert plan.linkage.drawn is not None
    places = plan.linkage.drawn.places
    squares = [
        np.abs(poses[link].carried(at)[0] - places[name] * _MM) ** 2
        for link in links
        for name, at in plan.points[link].items()
        if name in places
    ]
    return np.sqrt(sum(squares, np.zeros(1)))


def choose_side(plan: SolutionPlan, index: int, branch: Branch, place: float) -> None:
    """Let the dyad be assembled as is nearest to what is drawn, with the driver at ``place``. Raises NoPosition where both ways are as
    near."""
    step, _ = plan.steps[index]
    missed = []
    for side in (1.0, -1.0):
        branch.chosen[index] = (side, place)
        poses = solve(plan, at_driver(np.array([place])), branch, index + 1).poses
        missed.append(float(misses(plan, poses, step.links)[0]))
    if abs(missed[0] - missed[1]) <= _TIE * plan.size:
        raise _tie(step)
    branch.chosen[index] = (1.0 if missed[0] < missed[1] else -1.0, place)


def nearest(plan: SolutionPlan, step: SolutionStep, poses: Mapping[int, Pose]) -> int:
    """Which of the assemblies (n,) of a group is nearest to what is drawn. Raises NoPosition where two are as near."""
    missed = misses(plan, poses, step.links)
    order = np.argsort(missed)
    apart = inf if order.size < 2 else missed[order[1]] - missed[order[0]]
    if apart <= _TIE * plan.size:
        raise _tie(step)
    return int(order[0])


def _tie(step: SolutionStep) -> NoPosition:
    links = ", ".join(map(str, step.links))
    where = f" at {step.joint}" if len(step.links) == 2 and is_pin(step.joint) else ""
    return NoPosition(
        f"two ways to assemble links {links}{where} are as near to what is drawn",
        "linkage.drawn",
        "draw a point of theirs that tells them apart, or another position of the driver",
    )
