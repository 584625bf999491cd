"""Random linkages of every way of driving, with every kind of load; drawn backwards from a pose, so that they can be assembled there."""

import cmath
import math
from dataclasses import replace

import numpy as np
from linkages import FRAME, KINDS, Builder, Poor

from core.design import (
    Design,
    Drawn,
    Driver,
    LinkageLoads,
    LinkForce,
    LinkMass,
    LinkPoint,
    Motion,
    NamedCurve,
    NamedMotion,
    SecondDriver,
    Segment,
    Slider,
    faults,
    with_drive,
)
from core.design.loads import Attachment, PairFriction, PointSpring, Process, TorsionSpring
from core.errors import KindynaError
from core.study import Study

DRIVES = ("crank", "branch", "geared", "arm", "motor", "rack", "slide", "pin", "cylinder", "joint", "two")


def strokes(start: float, rise: float, unit: str) -> Motion:
    """There, a dwell, and back."""
    segments = (
        Segment(110.0, rise, NamedCurve("cycloidal")),
        Segment(30.0, 0.0),
        Segment(220.0, -rise, NamedCurve("3-4-5")),
    )
    return Motion(start=start, segments=segments, unit=unit)


def slide_of(builder: Builder, link: int) -> tuple[Slider, float]:
    """The slider of a link, and where it stands along its line [mm]."""
    row = next(each for each in builder.sliders if each.link == link)
    z, angle = builder.poses[row.on]
    through = z + complex(row.through_x_mm, row.through_y_mm) * cmath.rect(1.0, angle)
    return row, ((builder.poses[link][0] - through) * cmath.rect(1.0, -builder.poses[link][1])).real


def degrees_between(builder: Builder, link: int, on: int) -> float:
    return math.degrees(builder.poses[link][1] - builder.poses[on][1])


class Drive:
    """What drives a linkage in the making: the driver, its motion, and second inputs."""

    def __init__(self, builder: Builder, kind: str) -> None:
        self.builder, self.kind, self.rng = builder, kind, builder.rng
        self.motion: Motion | None = None
        self.seconds: tuple[SecondDriver, ...] = ()
        self.motions: tuple[NamedMotion, ...] = ()
        self.speed = float(self.rng.uniform(40.0, 200.0) * self.rng.choice([-1.0, 1.0]))
        getattr(self, f"_{kind}")()

    def _crank(self) -> None:
        crank = self._pinned(FRAME)
        self.driver = Driver(link=crank, speed_rpm=self.speed)

    _branch = _crank

    def _pinned(self, on: int) -> int:
        at = self.builder.place()
        link = self.builder.new(z=at - self.rng.uniform(0.0, 20.0) * cmath.rect(1.0, self.rng.uniform(-3.0, 3.0)))
        self.builder.pin(on, link, at)
        return link

    def _second(self, on: int, **given: object) -> None:
        self._crank()
        link = self._pinned(on)
        ratio = float(self.rng.choice([-2.0, -1.0, 0.5, 1.0]))
        offset = degrees_between(self.builder, link, on) - ratio * self.q
        self.seconds = (SecondDriver(link=link, on=on, ratio=ratio, offset_deg=offset),)

    def _geared(self) -> None:
        self._second(FRAME)

    def _arm(self) -> None:
        self._second(2)

    def _motor(self) -> None:
        self._crank()
        link = self._pinned(FRAME)
        own = strokes(degrees_between(self.builder, link, FRAME), float(self.rng.uniform(-15.0, 15.0)), "deg")
        self.seconds = (SecondDriver(link=link, motion="feed"),)
        self.motions = (NamedMotion("feed", own),)

    def _rack(self) -> None:
        self._crank()
        link = self.builder.new()
        self.builder.slide(link, FRAME)
        ratio = float(self.rng.uniform(-0.05, 0.05))
        offset = slide_of(self.builder, link)[1] - ratio * self.q
        self.seconds = (SecondDriver(link=link, ratio=ratio, offset_mm=offset),)

    def _moved(self, link: int, on: int, start: float, rise: float, unit: str) -> None:
        self.motion = strokes(start, rise, unit)
        self.driver = Driver(link=link, kind="motion", speed_rpm=abs(self.speed), on=on)

    def _slide(self) -> None:
        link = self.builder.new()
        self.builder.slide(link, FRAME)
        self._moved(link, FRAME, slide_of(self.builder, link)[1], float(self.rng.uniform(-12.0, 12.0)), "mm")

    def _pin(self) -> None:
        link = self._pinned(FRAME)
        turn = float(self.rng.uniform(-20.0, 20.0))
        self._moved(link, FRAME, degrees_between(self.builder, link, FRAME), turn, "deg")

    def _two(self) -> None:
        """A motion, and a second link that goes with it by a ratio."""
        self._pin()
        link = self._pinned(FRAME)
        ratio = float(self.rng.choice([-2.0, -1.0, 0.5, 1.0]))
        offset = degrees_between(self.builder, link, FRAME) - ratio * self.q
        self.seconds = (SecondDriver(link=link, ratio=ratio, offset_deg=offset),)

    def _cylinder(self) -> None:
        arm = self._pinned(FRAME)
        bar, rod = self.builder.new(), self.builder.new()
        self.builder.pin(FRAME, bar, self.builder.place())
        self.builder.pin(arm, rod, self.builder.place())
        self.builder.slide(rod, bar)
        self._moved(rod, bar, slide_of(self.builder, rod)[1], float(self.rng.uniform(-12.0, 12.0)), "mm")

    def _joint(self) -> None:
        arm, second = self._pinned(FRAME), self.builder.new()
        rod = self._pinned(arm)
        self.builder.pin(FRAME, second, self.builder.place())
        self.builder.pin(rod, second, self.builder.place())
        turn = float(self.rng.uniform(-12.0, 12.0))
        self._moved(rod, arm, degrees_between(self.builder, rod, arm), turn, "deg")

    @property
    def q(self) -> float:
        """The crank's angle in the pose [deg]."""
        return math.degrees(self.builder.poses[2][1])


def random_linkage(seed: int, drive: str) -> Design:
    """One that is driven so, goes through all or part of a turn, and whose forces are known."""
    rng = np.random.default_rng(seed)
    while True:
        builder = Builder(rng)
        try:
            driven = Drive(builder, drive)
            for kind in rng.choice(KINDS, int(rng.integers(1, 3))):
                getattr(builder, kind)()
        except Poor:
            continue
        for number, own in builder.points.items():
            own |= {} if own else {f"T{number}": 5.0 + 3.0j}  # a file has a point of each link
        bare = builder.design()
        points = tuple(
            LinkPoint(name, at.real, at.imag)
            for number, own in builder.points.items()
            for name, at in ((n, builder.poses[number][0] + p * cmath.rect(1.0, builder.poses[number][1])) for n, p in own.items())
        )  # fmt: skip
        drawn = Drawn(
            driver_deg=None if driven.motion else driven.q, points=tuple({p.name: p for p in points}.values())
        )
        linkage = replace(
            bare.drive.mechanism,
            driver=driven.driver,
            drivers=driven.seconds,
            motions=driven.motions,
            **({} if drive == "branch" else {"branch": (), "drawn": drawn}),
        )
        design = with_drive(bare, motion=driven.motion, mechanism=linkage)
        design = with_drive(design, loads=_loads(rng, design))
        if faults(design):
            continue
        try:
            study = Study(design, 24)
            if study.theta.size and study.jam is None and np.isfinite(study.dynamics.driver).all():
                return design
        except KindynaError:
            continue


def _loads(rng: np.random.Generator, design: Design) -> LinkageLoads:
    mechanism = design.drive.mechanism
    moving = [link for link in mechanism.links if link.number != FRAME]
    numbers = [link.number for link in moving]
    pins = [link for link in moving if link.points]

    def at(scale: float = 50.0) -> tuple[float, float]:
        x, y = rng.uniform(-scale, scale, 2)
        return float(x), float(y)

    def one(links: list) -> object:
        return links[int(rng.integers(len(links)))]

    masses = tuple(
        LinkMass(link=n, mass_kg=float(m), inertia_kg_m2=float(i), centre_x_mm=float(x), centre_y_mm=float(y))
        for n, (m, i, x, y) in zip(
            numbers, rng.uniform([0.1, 0.0, -50, -50], [3.0, 0.01, 50, 50], (len(numbers), 4)), strict=True
        )
        if rng.random() < 0.9
    )
    pushed, pulled = one(pins), one(pins)
    x, y = at(60.0)
    torque = float(rng.uniform(-2.0, 2.0))
    forces = (LinkForce(link=pushed.number, point=pushed.points[0].name, x_n=x, y_n=y, torque_nm=torque),)
    x, y = at(200.0)
    springs = (
        PointSpring(
            from_=Attachment(link=FRAME, x_mm=x, y_mm=y),
            to=Attachment(link=pulled.number, point=pulled.points[-1].name),
            rate_n_per_mm=float(rng.uniform(0.1, 2.0)),
            free_length_mm=100.0,
            damping_n_s_per_mm=float(rng.choice([0.0, 0.002])),
        ),
    )
    torsion = (TorsionSpring(link=one(numbers), on=FRAME, rate_nm_per_rad=2.0, damping_nm_s_per_rad=0.01),)
    friction = ()
    if rng.random() < 0.5:
        shared = [p.name for link in moving for p in link.points]
        single = [n for n in dict.fromkeys(shared) if sum(p.name == n for k in mechanism.links for p in k.points) == 2]
        friction = (PairFriction(pair=one(single), coefficient=0.05, radius_mm=4.0),)
        if mechanism.sliders:
            friction += (PairFriction(pair=str(mechanism.sliders[0].link), coefficient=0.05),)
    working = one(pins)
    process = (
        Process(
            cam_from_deg=30.0, cam_to_deg=300.0, force_n=float(rng.uniform(-90.0, 90.0)), link=working.number,
            point=working.points[0].name, direction_deg=float(rng.uniform(-180.0, 180.0)),
        ),
    )  # fmt: skip
    return LinkageLoads(
        masses=masses, forces=forces, springs=springs, torsion_springs=torsion, pair_friction=friction,
        process=process if rng.random() < 0.5 else (), gravity_angle_deg=float(rng.uniform(-180.0, 180.0)),
    )  # fmt: skip
