"""Dimensions of a linkage from places: a joint is put where it is wanted at one position, the links that meet there change."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from core.design import FRAME_LINK, Design, Link
from core.mechanism.kinematics import Kinematics
from core.mechanism.mechanism import body_name

_MM = 1e-3


def movable_points(design: Design) -> Mapping[str, str]:
    """The points that can be put elsewhere, with the path of their coordinates in the first link that has them: all but those
    of a driver that slides, whose place the motion gives."""
    linkage = design.drive.linkage
    sliding, driver = {s.link for s in linkage.sliders}, linkage.driver.link
    given = set(linkage.by_number[driver].places) if driver in sliding else set()
    found: dict[str, str] = {}
    for i, link in enumerate(linkage.links):
        for name in link.places:
            if name not in given:
                found.setdefault(name, f"linkage.links[{i}].points.{name}")
    return found


def point_changes(design: Design, kinematics: Kinematics, name: str, to: complex) -> dict[str, tuple[float, float]]:
    """Path -> coordinates [mm], unrounded, with which a named point is at ``to`` [m] in the position that ``kinematics`` shows
    (n = 1).

    A point of the frame moves alone, all links keep their lengths. Of any other the links that have it change where it
    stands in them, all else staying where it is at this position; on the driver it keeps to its line from the pivot, on a
    link that slides to the guide. A link whose frame begins at its first point, with the second on its x axis, keeps it so.
    """
    linkage = design.drive.linkage
    having = [link for link in linkage.links if name in link.places]
    having = [link for link in having if link.number == FRAME_LINK] or having
    sliding = {s.link for s in linkage.sliders}
    for link in having:
        if link.number in sliding:
            to = _along_guide(kinematics, link.number, name, to)
        elif link.number == linkage.driver.link:
            to = _along_crank(linkage.by_number[FRAME_LINK], link, kinematics, name, to)
    return {
        f"linkage.links[{i}].points.{point}": (at.real, at.imag)
        for i, link in enumerate(linkage.links)
        if link in having and link.number not in sliding
        for point, at in _moved(design, link, kinematics, name, to).items()
    }


def _pose(kinematics: Kinematics, link: int) -> tuple[complex, complex]:
    """Origin [m] and x axis."""
    body = kinematics.bodies[body_name(link)]
    return complex(body.z[0, 0]), complex(np.exp(1j * body.angle[0, 0]))


def _along_guide(kinematics: Kinematics, link: int, name: str, to: complex) -> complex:
    old, (_, axis) = complex(kinematics.bodies[body_name(link)].point(name)[0, 0]), _pose(kinematics, link)
    return old + axis * ((to - old) * axis.conjugate()).real


def _along_crank(frame: Link, link: Link, kinematics: Kinematics, name: str, to: complex) -> complex:
    pivots = [p for p in link.places if p in frame.places]
    if not pivots or name in pivots:
        return to
    body = kinematics.bodies[body_name(link.number)]
    start, old = complex(body.point(pivots[0])[0, 0]), complex(body.point(name)[0, 0])
    along = (old - start) / abs(old - start)
    return start + along * ((to - start) * along.conjugate()).real


def _moved(design: Design, link: Link, kinematics: Kinematics, name: str, to: complex) -> dict[str, complex]:
    """The points of a link that change, in its frame [mm]."""
    origin, axis = _pose(kinematics, link.number)
    place = (to - origin) * axis.conjugate() / _MM
    if not _is_tidy(design, link):
        return {name: place}
    places = {**link.places, name: place}
    first, second = list(places.values())[:2]
    turn = (second - first).conjugate() / abs(second - first) if second != first else 1.0
    return {point: (at - first) * turn for point, at in places.items()}


def _is_tidy(design: Design, link: Link) -> bool:
    """Whether a link's frame begins at its first point and leads to the second, and nothing else stands in it."""
    linkage = design.drive.linkage
    fixed = (
        {FRAME_LINK, linkage.driver.link}
        | {s.on for s in linkage.sliders}
        | {m.link for m in design.drive.loads.masses}
    )
    first, *others = link.places.values()
    return link.number not in fixed and first == 0 and bool(others) and others[0].imag == 0.0 and others[0].real > 0.0
