"""A drawing put together: its points are moved as little as need be until every link has its lengths and every block is on its line."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

import numpy as np

from core.design import FRAME_LINK, Design, Linkage
from core.design.topology import driver_pair
from core.errors import NoPosition
from core.mechanism.drawing.inputs import second_inputs_set
from core.mechanism.drawing.sheet import frame_of, places_of, pose_of, with_places

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


__all__ = ["closed", "settled"]
