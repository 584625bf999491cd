"""A planar linkage: links with named points in the frames of the links, sliding pairs, drivers, branches.

A point name on several links is a revolute pair; n links on one pin are n - 1 pairs.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite, lcm, pi
from types import MappingProxyType
from typing import ClassVar

from core.design.fields import (
    LARGEST,
    FileLayout,
    brief,
    choice,
    chosen_by_word,
    coordinate,
    number,
    placed,
    seldom,
    whole,
)
from core.design.followers import (
    FACE,
    CamDetails,
    ContactFriction,
    Form,
    Groove,
    Knife,
    LinkageConjugate,
    Open,
    Roller,
    Shoe,
    form_of,
    rubs,
)
from core.design.loads import ForceElements
from core.design.motions import Motion
from core.frozen import frozen
from core.numerics.derivatives import vector
from core.numerics.lazy import lazy

FRAME_LINK = 1
"""Number of the fixed link; its frame is the global frame."""

CRANK, MOTION = "crank", "motion"
MOTION_SPEED = 60.0
"""Default speed of a motion's shaft [rpm]: one turn a second."""
DRIVERS = (CRANK, MOTION)


@frozen
class LinkPoint:
    """A named point of a link, in the frame of the link."""

    name: str
    x_mm: float = coordinate("x", pair="x, y")
    y_mm: float = coordinate("y", pair="x, y")


@frozen
class Link:
    """One rigid body; points of no second link are coupler points."""

    number: int = whole("Number", 1, 999, help="1 = frame")
    points: tuple[LinkPoint, ...] = placed(
        FileLayout(LinkPoint, key="name", whole=True, missing="{ A = [0.0, 0.0], B = [40.0, 0.0] }, in mm"), ()
    )

    @lazy
    def _places(self) -> dict[str, complex]:
        return {p.name: vector(p.x_mm, p.y_mm) for p in self.points}

    @property
    def places(self) -> Mapping[str, complex]:
        """Name -> point in the link's frame [mm]."""
        return MappingProxyType(self._places)


@frozen(kw_only=True)
class Slider:
    """Sliding pair: ``link`` slides along a line of the link ``on`` without turning; its x axis is on the line."""

    link: int = whole("Link", 1, 999, help="the link that slides")
    on: int = whole("On", 1, 999, help="the link that carries the line")
    through_x_mm: float = coordinate("Line through x", pair="through", default=0.0)
    through_y_mm: float = coordinate("Line through y", pair="through", default=0.0)
    angle_deg: float = number("Angle of the line", -360.0, 360.0, default=0.0)


@frozen
class Driver:
    """The driving link: a ``crank`` at constant speed, or a link whose angle or slide follows the ``motion`` of the design.

    ``on`` is its reference link: the frame, or a moving link, as the tube of a cylinder.
    """

    link: int = whole("Driving link", FRAME_LINK, 999)
    kind: str = choice("Driven by", DRIVERS, default=CRANK, missing=" | ".join(DRIVERS))
    speed_rpm: float = number(
        "Speed", -1e5, 1e5, default=60.0, step=1.0,
        missing="of the crank, in rpm; negative = clockwise",
        help="of the crank, or of the shaft if a motion drives; negative = clockwise",
    )  # fmt: skip
    on: int = brief(
        whole(
            "Against link", 1, 999, default=FRAME_LINK, help="1 = the frame; a cylinder drives between two moving links"
        )
    )


NO_DRIVER = Driver(FRAME_LINK)
"""Driver of a linkage without a driver."""


GEAR, INTERNAL, BELT, RACK = "gear", "internal", "belt", "rack"
WHEELS = (GEAR, INTERNAL, BELT, RACK)
"""Pairs of wheels: gears turn in opposite senses, ring and pinion, and pulleys, in the same. A rack has the radius 0; its pinion is on
its left, seen along the line on which it slides."""
MOST_TURNS = 360  # of a cycle


@frozen(kw_only=True)
class SecondDriver:
    """A second driving link: its angle or slide relative to the link ``on`` is a ratio times the driver's, or a motion, plus an offset.

    The ratio of wheels follows from their teeth or radii. The first wheel belongs to the driver; with ``on`` equal to the
    driver's link it is fixed to the frame.
    """

    link: int = whole("Second driving link", 2, 999)
    on: int = whole("Against link", 1, 999, default=FRAME_LINK, help="the link from which its angle is measured")
    ratio: float | None = number(
        "Ratio", -1e6, 1e6, default=None, help="degrees (mm for a slide) per degree or mm of the first driver"
    )
    offset_deg: float = number("Offset", -36000.0, 36000.0, default=0.0)
    offset_mm: float = brief(coordinate("Sliding offset", default=0.0))
    motion: str = placed(FileLayout(brief=True), "")
    kind: str | None = choice("Wheels", WHEELS, default=None)
    teeth_first: int | None = whole("Teeth of the first", 0, 100000, default=None, pair="teeth")
    teeth_second: int | None = whole("Teeth of the second", 0, 100000, default=None, pair="teeth")
    module_mm: float | None = number("Module", 0.0, 1e6, open_low=True, default=None)
    radius_first_mm: float | None = coordinate("Radius of the first", default=None, pair="radius_mm")
    radius_second_mm: float | None = coordinate("Radius of the second", default=None, pair="radius_mm")

    @property
    def wheels(self) -> tuple[float, float] | None:
        """Teeth of both wheels, or their radii; None where neither is given."""
        for first, second in (
            (self.teeth_first, self.teeth_second), (self.radius_first_mm, self.radius_second_mm),
        ):  # fmt: skip
            if first and second:
                return first, second
        return None

    @property
    def pitch_radii(self) -> tuple[float, float] | None:
        """Radii of both pitch circles [mm], by radius or by teeth and module, 0 for a rack; None where they are unknown."""
        radii, teeth = (self.radius_first_mm, self.radius_second_mm), (self.teeth_first, self.teeth_second)
        if self.module_mm and None not in teeth and not any(radii):
            radii = tuple(0.5 * self.module_mm * (count or 0) for count in teeth)  # type: ignore[assignment]
        first, second = (radius or 0.0 for radius in radii)
        known = bool(first) != bool(second) if self.kind == RACK else bool(first and second)
        return (first, second) if known else None

    def ratio_by(self, driver: int) -> float | None:
        """Ratio of the wheels, on the frame or on the driver's link; None where it is unknown."""
        if self.kind == RACK:
            first, second = self.pitch_radii or (0.0, 0.0)
            return pi / 180.0 * first if first else 180.0 / (pi * second) if second else None
        if self.wheels is None or self.on not in (FRAME_LINK, driver):
            return None
        first, second = self.wheels
        sign = -1.0 if (self.kind or GEAR) == GEAR else 1.0
        return (sign if self.on == FRAME_LINK else -sign) * first / second


@frozen
class NamedMotion:
    """Motion of a second driver, ``[motions.NAME]``, over the turn of the driver from its angle 0."""

    name: str
    motion: Motion


@frozen
class Side:
    """Side on which a joint is assembled: +1 left, -1 right.

    ``joint`` names the pin between the two links of a dyad, or, where these slide on each other, is the number of the
    link that slides (as text). Of RRR the line runs from the known end of the lower-numbered link to that of the higher;
    where the known end is a guide, +1 is forward along it; of a link that slides on another, +1 has its pin ahead of
    the other's, along the line. Where the motion passes through change points, the side is that before the first of them: from
    the crank's angle 0, or from the driver's lowest position.
    """

    joint: str
    side: int = whole("Side", -1, 1, numbers=(1, -1))


@frozen
class Drawn:
    """Approximate positions of points at a position of the driver, by default that of cam angle 0; they select the nearest assembly."""

    driver_deg: float | None = number("Driver drawn at", -LARGEST, LARGEST, default=None)
    driver_mm: float | None = coordinate("Driver drawn at", default=None)
    points: tuple[LinkPoint, ...] = placed(FileLayout(LinkPoint, key="name", spread=True), ())

    @lazy
    def _places(self) -> dict[str, complex]:
        return {p.name: vector(p.x_mm, p.y_mm) for p in self.points}

    @property
    def places(self) -> Mapping[str, complex]:
        """Name -> point in the frame [mm]."""
        return MappingProxyType(self._places)


@frozen
class Linkage:
    """Links, sliding pairs, driver and branches, in the order of the file."""

    FILE_ORDER: ClassVar[tuple[str, ...]] = ("driver", "branch", "drawn", "drivers", "links", "sliders")

    links: tuple[Link, ...] = placed(FileLayout(Link, missing="[[linkage.links]] with number and points"))
    sliders: tuple[Slider, ...] = placed(FileLayout(Slider), ())
    driver: Driver = placed(FileLayout(Driver, single=True, brief=True), NO_DRIVER)
    branch: tuple[Side, ...] = placed(FileLayout(Side, key="joint"), ())
    drawn: Drawn | None = placed(FileLayout(Drawn, single=True), None)
    drivers: tuple[SecondDriver, ...] = placed(FileLayout(SecondDriver), ())
    motions: tuple[NamedMotion, ...] = placed(FileLayout(in_file=False), ())  # in separate tables

    @property
    def own_motions(self) -> Mapping[int, Motion]:
        """Link of a second driver -> its motion."""
        named = {row.name: row.motion for row in self.motions}
        return MappingProxyType({d.link: named[d.motion] for d in self.drivers if d.motion in named})

    @property
    def by_number(self) -> Mapping[int, Link]:
        """Link number -> link."""
        return MappingProxyType({link.number: link for link in self.links})

    @property
    def ratios(self) -> Mapping[int, float]:
        """Link of a second driver -> its ratio, in degrees or mm; 0 where it has a motion."""
        ratios = {
            d.link: 0.0 if d.motion else d.ratio if d.ratio is not None else d.ratio_by(self.driver.link)
            for d in self.drivers
        }
        return MappingProxyType({link: ratio for link, ratio in ratios.items() if ratio is not None})

    @property
    def turns(self) -> int | None:
        """Turns of the driver in a period of all drivers; None where it exceeds ``MOST_TURNS``."""
        from fractions import Fraction

        turns, advances = 1, (motion.gain / 360.0 for motion in self.own_motions.values())
        for ratio in (*self.ratios.values(), *advances):
            if not isfinite(ratio):
                return None
            part = Fraction(ratio).limit_denominator(MOST_TURNS)
            if abs(part - ratio) > 1e-12 * max(1.0, abs(ratio)):
                return None
            turns = lcm(turns, part.denominator)
        return turns if turns <= MOST_TURNS else None

    @property
    def sides(self) -> Mapping[str, int]:
        """Joint -> its stated side, +1 or -1."""
        return MappingProxyType({s.joint: s.side for s in self.branch})


@frozen(kw_only=True)
class LinkageCam(CamDetails):
    """Disk cam about the origin of the frame, under a roller, a knife edge or a shoe at a point of a link.

    It drives the linkage by the motion; the path of the point determines its size.
    """

    link: int = whole("Roller on link", 2, 999)
    point: str = placed(FileLayout(missing="the name of a point"))
    face: Roller | Knife | Shoe = placed(
        chosen_by_word(FACE, {"roller": Roller, "knife": Knife, "shoe": Shoe}, "Face", otherwise="roller", brief=True,
                       help="what touches the cam")
    )  # fmt: skip
    form: Form = form_of(Open, Groove, LinkageConjugate)


@frozen(kw_only=True)
class LinkMass:
    """Mass of a link."""

    link: int = whole("Link", 2, 999)
    mass_kg: float = number("Mass", 0.0, default=0.0)
    inertia_kg_m2: float = number("Inertia", 0.0, default=0.0, help="about its centre of mass")
    centre_x_mm: float = coordinate("Centre of mass x", pair="centre", default=0.0, help="in the link's frame")
    centre_y_mm: float = coordinate("Centre of mass y", pair="centre", default=0.0)


@frozen(kw_only=True)
class LinkForce:
    """A constant force at a point of a link, in the frame's directions, and a torque on the link."""

    link: int = whole("Link", 2, 999)
    point: str = placed(FileLayout(missing="the name of a point"))
    x_n: float = number("Force x", default=0.0)
    y_n: float = number("Force y", default=0.0)
    torque_nm: float = number("Torque", default=0.0, help="counter-clockwise")


@frozen(kw_only=True)
class LinkageLoads(ForceElements):
    """Masses of the links and forces on them; ``contact`` is the friction of a sliding face."""

    contact: ContactFriction | None = placed(FileLayout(ContactFriction, choose=rubs), None)
    gravity_m_s2: float = seldom(number("Gravity", 0.0, default=9.80665))
    gravity_angle_deg: float = seldom(number("Gravity direction", -360.0, 360.0, default=-90.0, help="-90 = downwards"))
    masses: tuple[LinkMass, ...] = placed(FileLayout(LinkMass), ())
    forces: tuple[LinkForce, ...] = placed(FileLayout(LinkForce), ())
