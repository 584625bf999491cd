"""A linkage that is drawn: positions of its points and links, second inputs, assembly by Newton's method, and the drawn pose."""

from __future__ import annotations

import cmath
import math
from collections import Counter
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
from core.mechanism.branches import Branch
from core.mechanism.kinematics import Pose
from core.mechanism.linkage import SolutionPlan
from core.mechanism.mechanism import at_driver, solve
from core.motion import motion_at, program
from core.number_text import result_text

# -- positions of points and links in the drawing ---------------------------------------------------------------


PointPositions = Mapping[str, complex]
"""Position [mm] by the name of a point."""
LinkPose = tuple[complex, complex]
"""Origin [mm] and unit vector of the x axis of a link's frame."""

DECIMALS = 9  # of measured coordinates [mm], so that a loop of them closes within rounding
SAME = 1e-9  # [mm] positions nearer to each other are equal


def point_positions(linkage: Linkage) -> dict[str, complex]:
    """Positions of all points that are known: those of the frame, those drawn, and the other points of the same links."""
    drawn = linkage.drawn
    places = {} if drawn is None else {p.name: complex(p.x_mm, p.y_mm) for p in drawn.points}
    places |= frame_link(linkage).places
    unknown = list(linkage.links)
    while known := [link for link in unknown if _has_pose(linkage, link, places)]:
        for link in known:
            origin, axis = link_pose(linkage, link.number, places)
            for name, at in link.places.items():
                places.setdefault(name, origin + at * axis)
        unknown = [link for link in unknown if link not in known]
    return places


def traced_points(linkage: Linkage) -> frozenset[str]:
    """Points of a drawn linkage that trace a path: points of one moving link alone, which has two further points."""
    if linkage.drawn is None:
        return frozenset()
    counts = Counter(p.name for link in linkage.links for p in link.points)
    names = (p.name for k in linkage.links if k.number != FRAME_LINK and len(k.points) > 2 for p in k.points)
    return frozenset(name for name in names if counts[name] == 1)


def _has_pose(linkage: Linkage, link: Link, places: PointPositions) -> bool:
    """Whether the known points of a link determine its pose."""
    known = [at for name, at in link.places.items() if name in places]
    sliding = any(s.link == link.number for s in linkage.sliders)
    return any(at != known[0] for at in known) or (bool(known) and (sliding or len(link.points) == 1))


def frame_link(linkage: Linkage) -> Link:
    """The frame link, without points where the linkage has none yet."""
    return linkage.by_number.get(FRAME_LINK, Link(FRAME_LINK))


def link_pose(linkage: Linkage, number: int, places: PointPositions) -> LinkPose:
    """Pose of a link from its two points with the greatest distance.

    A link with one known point has the angle of the line on which it slides, or else 0.
    """
    if number == FRAME_LINK:
        return 0j, 1.0 + 0j
    known = [(at, places[name]) for name, at in linkage.by_number[number].places.items() if name in places]
    if not known:
        return 0j, 1.0 + 0j
    local, at = known[0]
    far, far_at = max(known, key=lambda row: abs(row[0] - local))
    axis = (far_at - at) / (far - local) if far != local else 1.0 + 0j
    if far == local:
        slider = next((s for s in linkage.sliders if s.link == number and s.on != number), None)
        if slider is not None:
            axis = link_pose(linkage, slider.on, places)[1] * unit_vector(slider.angle_deg)
    axis = axis / abs(axis) if axis else 1.0 + 0j
    return at - local * axis, axis


def slider_line(linkage: Linkage, slider: Slider, places: PointPositions) -> LinkPose:
    """Point [mm] and direction of the line of a sliding link in the drawing."""
    origin, axis = link_pose(linkage, slider.on, places)
    return origin + complex(slider.through_x_mm, slider.through_y_mm) * axis, axis * unit_vector(slider.angle_deg)


def nearest_on_segment(at: complex, start: complex, end: complex) -> complex:
    """Point of a line segment that is nearest to a position."""
    along = end - start
    size = abs(along) ** 2
    share = 0.0 if size == 0.0 else min(max(((at - start) * along.conjugate()).real / size, 0.0), 1.0)
    return start + share * along


def unit_vector(degrees: float) -> complex:
    """Unit vector of an angle [deg], exact at multiples of 90°."""
    exact = {0.0: 1.0 + 0j, 90.0: 1j, 180.0: -1.0 + 0j, -180.0: -1.0 + 0j, -90.0: -1j, 270.0: -1j}
    return exact.get(degrees, cmath.exp(1j * math.radians(degrees)))


def angle_degrees(direction: complex) -> float:
    """Angle -180 ... 180 [deg] of a vector, rounded."""
    return round(math.degrees(cmath.phase(direction)), DECIMALS) + 0.0


def with_positions(design: Design, places: PointPositions, linkage: Linkage | None = None) -> Design:
    """The design with its points drawn at these positions, the driver position and the second inputs that follow, and no branch signs."""
    linkage = design.drive.linkage if linkage is None else linkage
    fixed = frame_link(linkage).places
    names = {name for link in linkage.links for name in link.places}
    points = tuple(link_point(name, at) for name, at in places.items() if name in names and name not in fixed)
    deg, mm = _driver_at(linkage, places)
    if linkage.drivers and (deg is not None or mm is not None):
        at, drivers = driver_with_turns(linkage, places, deg if deg is not None else mm or 0.0)
        deg = at if deg is not None else None
        linkage = replace(linkage, drivers=drivers)
    used = {row.motion for row in linkage.drivers}
    linkage = replace(linkage, motions=tuple(motion for motion in linkage.motions if motion.name in used))
    return with_drive(
        design, mechanism=replace(linkage, drawn=Drawn(driver_deg=deg, driver_mm=mm, points=points), branch=())
    )


def _driver_at(linkage: Linkage, places: PointPositions) -> tuple[float | None, float | None]:
    """Driver position in deg or in mm; both None without a driver."""
    link = linkage.driver.link
    pair = driver_pair(linkage) if link in linkage.by_number and link != FRAME_LINK else None
    if pair is None:
        return None, None
    if is_pin(pair):
        (_, axis), (_, base) = (link_pose(linkage, n, places) for n in (link, linkage.driver.on))
        return angle_degrees(axis * base.conjugate()), None
    slider = slider_of(linkage, pair)
    origin, _ = link_pose(linkage, slider.link, places)
    through, along = slider_line(linkage, slider, places)
    return None, round(((origin - through) * along.conjugate()).real, DECIMALS)


def link_point(name: str, at: complex) -> LinkPoint:
    """A point with rounded coordinates [mm]."""
    return LinkPoint(name, round(at.real, DECIMALS) + 0.0, round(at.imag, DECIMALS) + 0.0)


def new_name(linkage: Linkage, fixed: bool = False, taken: Collection[str] = ()) -> str:
    """A name that no point has yet: O1, O2 ... on the frame, else A, B, C ..."""
    used = {name for link in linkage.links for name in link.places} | set(taken)
    letters = [chr(ord("A") + i) for i in range(26) if chr(ord("A") + i) != "O"]
    names = (f"O{i}" for i in count(1)) if fixed else (f"{x}{n or ''}" for n in count() for x in letters)
    return next(name for name in names if name not in used)


def new_number(linkage: Linkage) -> int:
    """A number that no link has yet."""
    return max([FRAME_LINK, *(link.number for link in linkage.links)]) + 1


def with_links(linkage: Linkage, new: Mapping[int, Link]) -> Linkage:
    """The linkage with new links, by number, in place of the old ones; further ones are added in front."""
    numbers = {link.number for link in linkage.links}
    links = tuple(new.get(link.number, link) for link in linkage.links)
    return replace(linkage, links=(*(link for n, link in new.items() if n not in numbers), *links))


def without_bare_pins(linkage: Linkage) -> Linkage:
    """The linkage without bare pins that a link has by now; a bare pin is a link of one point that does not slide."""
    sliding = {number for s in linkage.sliders for number in (s.link, s.on)}

    def is_bare(link: Link) -> bool:
        return len(link.points) == 1 and link.number != FRAME_LINK and link.number not in sliding

    names = [name for link in linkage.links if not is_bare(link) for name in link.places]
    links = tuple(link for link in linkage.links if not (is_bare(link) and link.points[0].name in names))
    return replace(linkage, links=links)


def checked(design: Design) -> Design:
    """The same design.

    Raises
    ------
    DesignError
        Two links share two pins.
    """
    links = design.drive.linkage.links
    for i, second in enumerate(links):
        for first in links[:i]:
            shared = [name for name in second.places if name in first.places]
            if len(shared) > 1:
                raise fault(
                    f"{' and '.join(shared)} join links {first.number} and {second.number} twice, which makes them one body",
                    "one pin between two links, or weld them",
                )
    return design


def fault(problem: str, allowed: str) -> DesignError:
    """Error of an edit of the drawing."""
    return DesignError([Fault("linkage", "drawing", problem, allowed)])


def edges_of(link: Link) -> Iterable[tuple[str, str]]:
    """Pairs of a link's points that define its shape: the ends of a bar, the outline of a plate."""
    names = list(link.places)
    if len(names) == 2:
        return ((names[0], names[1]),)
    return tuple(zip(names, names[1:] + names[:1], strict=True)) if len(names) > 2 else ()


# -- second inputs of a linkage that is drawn -------------------------------------------------------------------


GEARED = -1.0
"""Ratio of a new second input: two equal wheels."""
RACKED = 1.0
"""Ratio of a new rack [mm per degree]."""
_SAME_INPUT = 1e-7  # [deg or mm] a second input nearer to the position of its ratio and offset is there


def with_second_input(design: Design, number: int) -> Design:
    """The design with a link that follows the driver by a ratio, from its drawn position.

    Its angle is measured against the frame where a pin joins them, else against the driver, else against another link with a
    common pin. A sliding link moves along its line, as a rack.

    Raises
    ------
    DesignError
        There is no driver, or the link cannot be a second input.
    """
    linkage = design.drive.linkage
    if linkage.driver == NO_DRIVER:
        raise fault("there is no driver yet", "a driver first, which the second input follows")
    driven = {FRAME_LINK, linkage.driver.link, *(row.link for row in linkage.drivers)}
    if number in driven or number not in linkage.by_number:
        raise fault(
            f"link {number} is driven already" if number in driven else f"there is no link {number}",
            "another link on a pin",
        )
    sliding = next((s for s in linkage.sliders if s.link == number), None)
    if sliding is not None and sliding.on in (FRAME_LINK, linkage.driver.link):
        rack = SecondDriver(link=number, on=sliding.on, ratio=RACKED)
        return with_positions(design, point_positions(linkage), replace(linkage, drivers=(*linkage.drivers, rack)))
    neighbours = {n for pin in pins(linkage) if number in pin.links for n in pin.links} - {number}
    if not neighbours:
        raise fault(f"link {number} has no pin with another link", "a link on a pin")
    on = next((n for n in (FRAME_LINK, linkage.driver.link) if n in neighbours), min(neighbours))
    row = SecondDriver(link=number, on=on, ratio=GEARED)
    return with_positions(design, point_positions(linkage), replace(linkage, drivers=(*linkage.drivers, row)))


def input_pin(linkage: Linkage, second: SecondDriver) -> str:
    """The pin about which a second input turns its link: with the reference link, else the link's first pin, else its first point."""
    link_pins = [pin for pin in pins(linkage) if second.link in pin.links]
    at = next((pin.name for pin in link_pins if second.on in pin.links), link_pins[0].name if link_pins else "")
    return at or next(iter(linkage.by_number[second.link].places), "")


def with_input_values(design: Design, index: int, row: SecondDriver, offset: float | None = None) -> Design:
    """The design with other values of a second input.

    Parameters
    ----------
    design : Design
    index : int
        Index of the second input.
    row : SecondDriver
        New values; without a ratio, the wheels define it.
    offset : float, optional
        New offset [deg, or mm where the link slides], to which the drawing is adapted; by default the offset is adapted to the
        drawing.

    Returns
    -------
    Design

    Raises
    ------
    DesignError
        The ratio contradicts the wheels.
    NoPosition
        The links do not meet with the new offset.
    """
    linkage = design.drive.linkage
    wheel_ratio = row.ratio_by(linkage.driver.link)
    if row.ratio is None and wheel_ratio is None and not row.motion:
        row = replace(row, ratio=linkage.drivers[index].ratio or GEARED)
    ratio = abs(row.ratio) if row.kind == RACK and row.ratio is not None else row.ratio
    if (
        row.ratio is not None
        and wheel_ratio is not None
        and abs((ratio or 0.0) - wheel_ratio) > 1e-12 * abs(wheel_ratio)
    ):
        raise fault(
            f"a ratio of {row.ratio:g}, and wheels of {result_text(wheel_ratio)}", "the ratio or the wheels alone"
        )
    rows = (*linkage.drivers[:index], row, *linkage.drivers[index + 1 :])
    changed = with_positions(design, point_positions(linkage), replace(linkage, drivers=rows))
    if offset is None:
        return changed
    drawn = changed.drive.linkage
    with_offset = replace(row, offset_mm=offset) if input_slides(drawn, row) else replace(row, offset_deg=offset)
    rows = tuple(with_offset if old.link == row.link else old for old in drawn.drivers)
    return assembled(with_drive(changed, mechanism=replace(drawn, drivers=rows)))


def driver_with_turns(
    linkage: Linkage, places: PointPositions, driver: float
) -> tuple[float, tuple[SecondDriver, ...]]:
    """Driver position [deg or mm] including the whole turns at which the second inputs are as drawn, and the second inputs.

    Where no whole turn fits, the offsets are adapted to the drawing.
    """
    known = [row for row in linkage.drivers if row.link in linkage.ratios and _is_input_drawn(linkage, row, places)]
    if not known:
        return driver, linkage.drivers
    turns = (driver + 360.0 * k for k in range(max(2, linkage.turns or 0) if driver_turns(linkage) else 1))
    at = next(
        (q for q in turns if all(abs(_input_error(linkage, row, places, q)) < _SAME_INPUT for row in known)), driver
    )
    rows = tuple(
        _with_offset(linkage, row, error)
        if row in known and abs(error := _input_error(linkage, row, places, at)) >= _SAME_INPUT
        else row
        for row in linkage.drivers
    )
    return at, rows


def _with_offset(linkage: Linkage, row: SecondDriver, change: float) -> SecondDriver:
    """A second input with a changed offset [deg or mm]."""
    if input_slides(linkage, row):
        return replace(row, offset_mm=round(row.offset_mm + change, DECIMALS) + 0.0)
    return replace(row, offset_deg=round((row.offset_deg + change + 180.0) % 360.0 - 180.0, DECIMALS) + 0.0)


def _is_input_drawn(linkage: Linkage, row: SecondDriver, places: PointPositions) -> bool:
    """Whether the drawing determines the angles of both links of a second input, or the position of a sliding one."""
    least = {row.link: 0 if input_slides(linkage, row) else 1}
    return all(
        n == FRAME_LINK or sum(name in places for name in linkage.by_number[n].places) > least.get(n, 1)
        for n in (row.link, row.on)
        if n in linkage.by_number
    ) and {row.link, row.on} <= set(linkage.by_number)


def _input_coordinate(linkage: Linkage, row: SecondDriver, driver: float) -> float:
    """Angle [deg] or slide [mm] of a second input against its reference link, by its ratio or motion, and its offset."""
    motion = linkage.own_motions.get(row.link)
    if motion is None:
        offset = row.offset_mm if input_slides(linkage, row) else row.offset_deg
        return linkage.ratios[row.link] * driver + offset
    angle = motion_at(program(motion), at_driver(np.deg2rad([driver])))[0]
    return float(np.rad2deg(angle[0])) + row.offset_deg


def _input_error(linkage: Linkage, row: SecondDriver, places: PointPositions, driver: float) -> float:
    """Drawn coordinate of a second input less that by its ratio or motion and its offset: -180 ... 180 [deg], or [mm]."""
    (origin, axis), (_, base) = (link_pose(linkage, n, places) for n in (row.link, row.on))
    coordinate = _input_coordinate(linkage, row, driver)
    if input_slides(linkage, row):
        point, along = _input_line(linkage, row, places)
        return float(((origin - point) * along.conjugate()).real) - coordinate
    return (angle_degrees(axis * base.conjugate()) - coordinate + 180.0) % 360.0 - 180.0


def with_inputs_set(
    linkage: Linkage, places: dict[str, complex], fixed: Collection[str]
) -> tuple[dict[str, complex], set[str]]:
    """The positions with every second input as the drawn driver position requires, and the points that are fixed then.

    A second input turns about its first point among the fixed ones.
    """
    drawn, fixed = linkage.drawn, set(fixed)
    driver = None if drawn is None else drawn.driver_deg if drawn.driver_deg is not None else drawn.driver_mm
    if driver is None:
        return places, fixed
    places, remaining = dict(places), [row for row in linkage.drivers if row.link in linkage.ratios]
    fixed_pin = lambda row: next((n for n in linkage.by_number[row.link].places if n in fixed), None)  # noqa: E731
    is_fixed = lambda n: n == FRAME_LINK or set(linkage.by_number[n].places) <= fixed  # noqa: E731
    slides = lambda row: input_slides(linkage, row)  # noqa: E731
    while ready := [row for row in remaining if is_fixed(row.on) and (slides(row) or fixed_pin(row) is not None)]:
        for row in ready:
            points, coordinate = linkage.by_number[row.link].places, _input_coordinate(linkage, row, driver)
            if slides(row):
                point, along = _input_line(linkage, row, places)
                origin = point + coordinate * along
                places |= {name: origin + at * along for name, at in points.items()}
            else:
                pin = fixed_pin(row)
                assert pin is not None
                axis = unit_vector((coordinate + 180.0) % 360.0 - 180.0) * link_pose(linkage, row.on, places)[1]
                centre = places[pin]
                places |= {name: centre + (at - points[pin]) * axis for name, at in points.items()}
            fixed |= set(points)
        remaining = [row for row in remaining if row not in ready]
    return places, fixed


def _input_line(linkage: Linkage, row: SecondDriver, places: PointPositions) -> LinkPose:
    """Point [mm] and direction of the line on which a second input slides."""
    return slider_line(linkage, next(s for s in linkage.sliders if s.link == row.link), places)


# -- assembly of a drawing --------------------------------------------------------------------------------------


STEPS = 60
_CLOSED = 1e-12  # of the size
_LONGEST = 0.2  # of the size: largest displacement of a point in one step


def assembled(design: Design, keeps_driver: bool = True) -> Design:
    """The design with its drawing assembled, by Newton's method from the drawn positions with the shortest steps.

    keeps_driver: a driver pinned to the frame, and the second inputs that follow it, keep their angles.

    Raises
    ------
    NoPosition
        The links do not meet.
    """
    linkage = design.drive.linkage
    places = point_positions(linkage)
    fixed = set(frame_link(linkage).places)
    if keeps_driver and linkage.driver.on == FRAME_LINK and (pivot := driver_pair(linkage)) in fixed:
        crank = linkage.by_number[linkage.driver.link]
        axis = link_pose(linkage, crank.number, places)[1]
        places |= {name: places[pivot] + (at - crank.places[pivot]) * axis for name, at in crank.places.items()}
        fixed |= set(crank.places)
        places, fixed = with_inputs_set(linkage, places, fixed)
    return with_positions(design, assembled_positions(linkage, places, fixed))


def assembled_positions(linkage: Linkage, places: Mapping[str, complex], fixed: Collection[str]) -> dict[str, complex]:
    """Positions [mm] of all points with the links assembled; the fixed points do not move.

    Raises
    ------
    NoPosition
        The links do not meet.
    """
    free = [name for name in places if name not in fixed]
    size = max([1e-9, *(abs(at) for link in linkage.links for at in link.places.values())])
    z = np.array([places[name] for name in free], dtype=complex)

    def current(z: np.ndarray) -> dict[str, complex]:
        return {**places, **dict(zip(free, map(complex, z), strict=True))}

    index = {name: i for i, name in enumerate(free)}
    for _ in range(STEPS):
        rows = list(_equations(linkage, current(z)))
        gaps = np.array([value for value, _ in rows])
        if not rows or np.max(np.abs(gaps)) <= _CLOSED * size:
            return current(z)
        slopes = np.zeros((len(rows), 2 * len(free)))
        for i, (_, row) in enumerate(rows):
            for name, (x, y) in row.items():
                if name in index:
                    slopes[i, 2 * index[name]] += x
                    slopes[i, 2 * index[name] + 1] += y
        step = np.linalg.lstsq(slopes, -gaps, rcond=1e-9)[0]
        displacement = step[0::2] + 1j * step[1::2]
        worst = float(np.max(np.abs(displacement), initial=0.0))
        z = z + displacement * min(1.0, _LONGEST * size / worst if worst else 1.0)
    worst = float(np.max(np.abs(gaps)))
    if worst <= 1e-9 * size:
        return current(z)
    raise NoPosition(
        f"the links do not meet: the smallest gap is {result_text(worst)} mm",
        "linkage",
        "another length or position",
    )


Row = tuple[float, dict[str, tuple[float, float]]]
"""Gap [mm], and its derivatives by x and y of the points."""


def _equations(linkage: Linkage, places: dict[str, complex]) -> Iterator[Row]:
    """Gaps of the shape of every link, then of the lines of sliding links."""
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
    """Distances of a sliding link's points from their lines, in the frame of the link that carries the line."""
    for slider in linkage.sliders:
        heading = complex(np.exp(1j * np.radians(slider.angle_deg)))
        through = complex(slider.through_x_mm, slider.through_y_mm)
        for name, at in linkage.by_number[slider.link].places.items():
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
            m = (through - p) / (q - p)  # a point of the line = a + m (b - a)
            along = places[b] - places[a]
            normal, distance = k * along, places[name] - places[a] - m * along
            gap = (distance * normal.conjugate()).real - at.imag
            # d gap = Re(d distance · n*) + Re(distance · (k d along)*)
            by_along = -m.conjugate() * normal + distance * k.conjugate()
            yield (
                gap,
                {
                    name: (normal.real, normal.imag),
                    b: (by_along.real, by_along.imag),
                    a: (-normal.real - by_along.real, -normal.imag - by_along.imag),
                },
            )


# -- the drawn pose and its assembly ----------------------------------------------------------------------------


_MM = 1e-3
_TIE = 1e-9  # of the size: assemblies whose distances from the drawing differ by less are equally near
_DIGITS = 6  # decimals of a drawn coordinate, in mm and in degrees


def drawn_position(drawn: Drawn) -> float:
    """Position of the driver in the drawn pose [rad or m]."""
    if drawn.driver_mm is not None:
        return drawn.driver_mm * _MM
    return radians(drawn.driver_deg or 0.0)


def as_drawn(linkage: Linkage, q: float, poses: Mapping[int, Pose]) -> Linkage:
    """The linkage drawn in given poses (n = 1), instead of branch signs; q: position of its driver [rad or m]."""
    drawn: dict[str, LinkPoint] = {}
    for link in linkage.links:
        for name, at in link.places.items() if link.number != FRAME_LINK else ():
            z = complex(poses[link.number].fixed_point(at * _MM)[0][0]) / _MM
            drawn.setdefault(name, LinkPoint(name, round(z.real, _DIGITS) + 0.0, round(z.imag, _DIGITS) + 0.0))
    fixed = linkage.by_number[FRAME_LINK].places
    points = tuple(point for name, point in drawn.items() if name not in fixed)
    if driver_turns(linkage):
        return replace(linkage, branch=(), drawn=Drawn(round(degrees(q), _DIGITS) + 0.0, None, points))
    return replace(linkage, branch=(), drawn=Drawn(None, round(q / _MM, _DIGITS) + 0.0, points))


def drawing_distance(plan: SolutionPlan, poses: Mapping[int, Pose], links: Iterable[int]) -> np.ndarray:
    """Distance of poses from the drawing: root of the sum of squares over the points of some links.

    Parameters
    ----------
    plan : SolutionPlan
        Of a linkage that is drawn.
    poses : mapping of int to Pose
        Poses (n,) by link.
    links : iterable of int
        Numbers of the links.

    Returns
    -------
    ndarray (n,) [m]
    """
    assert plan.linkage.drawn is not None
    places = plan.linkage.drawn.places
    squares = [
        np.abs(poses[link].fixed_point(at)[0] - places[name] * _MM) ** 2
        for link in links
        for name, at in plan.points[link].items()
        if name in places
    ]
    return np.sqrt(sum(squares, np.zeros(1)))


def choose_side(plan: SolutionPlan, index: int, branch: Branch, q: float) -> None:
    """Set the side of a dyad in `branch` to the assembly nearest to the drawing, with the driver at q [rad or m].

    Raises
    ------
    NoPosition
        Both assemblies are equally near.
    """
    step, _ = plan.steps[index]
    distances = []
    for side in (1.0, -1.0):
        branch.chosen[index] = (side, q)
        poses = solve(plan, at_driver(np.array([q])), branch, index + 1).poses
        distances.append(float(drawing_distance(plan, poses, step.links)[0]))
    if abs(distances[0] - distances[1]) <= _TIE * plan.size:
        raise _tie(step)
    branch.chosen[index] = (1.0 if distances[0] < distances[1] else -1.0, q)


def nearest_assembly(plan: SolutionPlan, step: SolutionStep, poses: Mapping[int, Pose]) -> int:
    """Index of the assembly, among n of a group, that is nearest to the drawing.

    Raises
    ------
    NoPosition
        Two assemblies are equally near.
    """
    distances = drawing_distance(plan, poses, step.links)
    order = np.argsort(distances)
    difference = inf if order.size < 2 else distances[order[1]] - distances[order[0]]
    if difference <= _TIE * plan.size:
        raise _tie(step)
    return int(order[0])


def _tie(step: SolutionStep) -> NoPosition:
    links = ", ".join(map(str, step.links))
    where = f" at {step.joint}" if len(step.links) == 2 and is_pin(step.joint) else ""
    return NoPosition(
        f"two assemblies of links {links}{where} are equally near to the drawing",
        "linkage.drawn",
        "draw another of their points, or another position of the driver",
    )
