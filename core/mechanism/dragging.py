"""Dimensions from places: a joint is put where it is wanted at one position, and the links that meet there change."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.design import FRAME_LINK, Design, Link, Place, Side, with_drive
from core.mechanism.kinematics import Kinematics
from core.mechanism.mechanism import body_name

_MM = 1e-3


def movable(design: Design, name: str) -> bool:
    """Whether a point can be put elsewhere: all but those of a driver that slides, whose place the motion gives."""
    sliding = {s.link for s in design.drive.linkage.sliders}
    driver = design.drive.linkage.driver.link
    return not (driver in sliding and name in design.drive.linkage.by_number[driver].places)


def with_point_at(design: Design, kinematics: Kinematics, name: str, to: complex, decimals: int = 6) -> Design:
    """The design with a named point at ``to`` [m] in the position that ``kinematics`` shows (n = 1).

    A point of the frame moves alone, all links keep their lengths. Of any other the links that have it change where it
    stands in them, all else staying where it is at this position; on the driver it keeps to its line from the pivot, on a
    link that slides to the guide. A link whose frame begins at its first point, with the second on its x axis, keeps it so.
    Coordinates are rounded to so many decimals [mm]. Raises KeyError for a point there is none of.
    """
    linkage = design.drive.linkage
    having = [link for link in linkage.links if name in link.places]
    if not having:
        raise KeyError(name)
    if not movable(design, name):
        return design
    if any(link.number == FRAME_LINK for link in having):
        having = [link for link in having if link.number == FRAME_LINK]
    sliding = {s.link for s in linkage.sliders}
    for link in having:
        if link.number in sliding:
            to = _along_guide(kinematics, link.number, name, to)
        elif link.number == linkage.driver.link:
            to = _along_crank(linkage.by_number[FRAME_LINK], link, kinematics, name, to)
    changed = {link.number: _moved(design, link, kinematics, name, to, decimals) for link in having if link.number not in sliding}
    links = tuple(changed.get(link.number, link) for link in linkage.links)
    return with_drive(design, mechanism=replace(linkage, links=links))


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


def _moved(design: Design, link: Link, kinematics: Kinematics, name: str, to: complex, decimals: int) -> Link:
    origin, axis = _pose(kinematics, link.number)
    places = dict(link.places)
    tidy = _is_tidy(design, link)
    places[name] = (to - origin) * axis.conjugate() / _MM
    if tidy:
        first, second = list(places.values())[:2]
        turn = (second - first).conjugate() / abs(second - first) if second != first else 1.0
        places = {point: (at - first) * turn for point, at in places.items()}
    rounded = tuple(Place(p, round(z.real, decimals) + 0.0, round(z.imag, decimals) + 0.0) for p, z in places.items())
    if not tidy:  # what has not been moved stays to the last bit
        rounded = tuple(new if new.name == name else old for new, old in zip(rounded, link.points, strict=True))
    return replace(link, points=rounded)


def _is_tidy(design: Design, link: Link) -> bool:
    """Whether a link's frame begins at its first point and leads to the second, and nothing else stands in it."""
    linkage = design.drive.linkage
    fixed = {FRAME_LINK, linkage.driver.link} | {s.on for s in linkage.sliders} | {m.link for m in design.drive.loads.masses}
    first, *rest = link.places.values()
    return link.number not in fixed and first == 0 and bool(rest) and rest[0].imag == 0.0 and rest[0].real > 0.0


def other_side(design: Design, joint: str) -> Design:
    """The design assembled the other way at a joint; one that was not stated stood at +1."""
    side = -design.drive.linkage.sides.get(joint, 1)
    kept = tuple(s if s.joint != joint else replace(s, side=side) for s in design.drive.linkage.branch)
    if joint not in design.drive.linkage.sides:
        kept = (*kept, Side(joint, side))
    return with_drive(design, mechanism=replace(design.drive.linkage, branch=kept))
