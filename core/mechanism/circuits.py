"""The circuits of a linkage: every way to put its links together, and through which places of its driver each can go."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice, product

import numpy as np

from core.design import CRANK, Design, Side, with_drive
from core.design.linkage_rules import sided_joints
from core.errors import NoPosition
from core.frozen import frozen
from core.mechanism.assembly import unit_speed_kinematics
from core.mechanism.drawn import as_drawn
from core.mechanism.driver_ranges import TURN, DriverRange, DriverRanges, driver_ranges_of
from core.mechanism.drivers import MOST_SIDES, SAME_PLACE, apart
from core.mechanism.driving import swept
from core.mechanism.kinematics import Kinematics
from core.mechanism.mechanism import body_name
from core.motion import program
from core.numerics.cancellation import checkpoint


@frozen
class Circuit:
    """One of them: the design drawn in it, with the range of its driver [rad or m]; here: the design is in it now."""

    design: Design
    range: DriverRange
    here: bool


def circuits(design: Design) -> tuple[Circuit, ...]:
    """The circuits of a linkage, its own first; of one that follows a motion those that let it go through all of that.

    Two assemblies are one circuit where the driver takes the links from one to the other, over change points too. Raises
    NoPosition where its own links do not meet.
    """
    linkage = with_drive(design, mechanism=design.drive.posed).drive.linkage
    low, high = (0.0, TURN) if linkage.driver.kind == CRANK else swept(program(design.drive.motion))
    plain = replace(linkage, drawn=None, branch=())
    joints = sided_joints(plain)
    found: list[tuple[Circuit, DriverRanges]] = []
    own = driver_ranges_of(linkage, low, high)
    if not own.ranges:
        raise NoPosition("its links cannot be put together", "linkage.links", "change their lengths")
    found += [(Circuit(design, r, i == 0), own) for i, r in enumerate(own.ranges)]
    for sides in islice(product((1, -1), repeat=len(joints)), MOST_SIDES):
        checkpoint()
        tried = replace(plain, branch=tuple(Side(joint, side) for joint, side in zip(joints, sides, strict=True)))
        ranges = driver_ranges_of(tried, low, high)
        for each in ranges.ranges:
            if linkage.driver.kind != CRANK and not each.free:
                continue
            place = 0.5 * (each.low + each.high)
            kinematics = unit_speed_kinematics(tried, np.array([place]), ranges)
            turns = (-TURN, 0.0, TURN) if linkage.driver.kind == CRANK else (0.0,)
            if any(_goes_there(circuit, known, kinematics, place + turn) for circuit, known in found for turn in turns):
                continue
            made = as_drawn(plain, place, {n: kinematics.bodies[body_name(n)] for n in plain.by_number})
            try:
                whole = driver_ranges_of(made, low, high)
            except NoPosition:  # two assemblies as near to each other: no drawing tells them apart
                continue
            if whole.ranges:
                found.append((Circuit(with_drive(design, mechanism=made), whole.ranges[0], False), whole))
    return tuple(circuit for circuit, _ in found)


def _goes_there(circuit: Circuit, ranges: DriverRanges, kinematics: Kinematics, place: float) -> bool:
    """Whether the links of a circuit stand so (n = 1) with the driver at this place."""
    if not circuit.range.low <= place <= circuit.range.high:
        return False
    return apart(ranges, kinematics, place) < SAME_PLACE * ranges.plan.size


__all__ = ["Circuit", "circuits"]
