"""Linkages that can be assembled, drawn backwards from a pose; and what they do by other code than the core's: Newton on
all loop equations at once, with complex numbers or power series of fifty digits for the driver."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st
from mechanisms import LIFT, with_loads
from references import MP, Series
from references import exp as series_exp

from core.design import (
    Design,
    Drive,
    Driver,
    Link,
    Linkage,
    LinkageLoads,
    LinkForce,
    LinkMass,
    LinkPoint,
    SecondDriver,
    Side,
    Slider,
    faults,
    with_drive,
)
from core.project import load

FRAME = 1
LIFT_LINKAGE = Path(__file__).parents[1] / "resources" / "examples" / "cam_slider_linkage.toml"


def link(number: int, **points: tuple[float, float]) -> Link:
    return Link(number, tuple(LinkPoint(name, float(x), float(y)) for name, (x, y) in points.items()))


def sides(**by_joint: int) -> tuple[Side, ...]:
    return tuple(Side(name, side) for name, side in by_joint.items())


def four_bar(ground: float, crank: float, coupler: float, rocker: float, side: int = 1) -> Design:
    """The frame along x, the crank at its origin."""
    links = (
        link(1, O2=(0, 0), O4=(ground, 0)),
        link(2, O2=(0, 0), A=(crank, 0)),
        link(3, A=(0, 0), B=(coupler, 0)),
        link(4, O4=(0, 0), B=(rocker, 0)),
    )
    return Design("four-bar", None, (Drive(None, Linkage(links, (), Driver(2), sides(B=side)), None, LinkageLoads()),))


def slider_crank(crank: float, rod: float, offset: float = 0.0, side: int = 1) -> Design:
    """The guide along x, ``offset`` above the crank's pin."""
    links = (link(1, O2=(0, 0)), link(2, O2=(0, 0), A=(crank, 0)), link(3, A=(0, 0), B=(rod, 0)), link(4, B=(0, 0)))
    sliders = (Slider(link=4, on=1, through_y_mm=offset),)
    return Design(
        "slider-crank", None, (Drive(None, Linkage(links, sliders, Driver(2), sides(B=side)), None, LinkageLoads()),)
    )


def lift_twice() -> tuple[Design, Design]:
    """The lift without friction, and the same mechanism as a linkage that its cam drives, with the same masses and load."""
    plain = with_loads(LIFT, friction=0.0, roller_mass_kg=0.0, roller_inertia_kg_m2=0.0)
    loads = plain.drive.loads
    design = load(LIFT_LINKAGE)
    assert design.drive.is_linkage
    masses = (
        LinkMass(link=2, mass_kg=loads.slider_mass_kg),
        # the rod's frame starts at the slider's pin
        LinkMass(link=3, mass_kg=loads.rod_mass_kg, inertia_kg_m2=loads.rod_inertia_kg_m2, centre_x_mm=845.0 * 0.5),
        LinkMass(link=4, mass_kg=loads.arm_mass_kg, inertia_kg_m2=loads.arm_inertia_kg_m2),
    )
    push = (LinkForce(link=2, point="S", x_n=loads.external_force_n),)
    return plain, with_drive(design, loads=LinkageLoads(masses=masses, forces=push))


def chain(count: int) -> Design:
    """``count`` links (even): a crank and four-bars in a row, each led by the rocker before it."""
    points: dict[int, dict[str, tuple[float, float]]] = {1: {"O2": (0, 0)}, 2: {"O2": (0, 0), "A": (30, 0)}}
    leading, branch = "A", {}
    for i, (coupler, rocker) in enumerate(zip(range(3, count, 2), range(4, count + 1, 2), strict=True), 1):
        points[1][f"O{rocker}"] = (100.0 * i, 0.0)
        points[coupler] = {leading: (0, 0), f"B{i}": (102, 0)}
        points[rocker] = {f"O{rocker}": (0, 0), f"B{i}": (80, 0), f"C{i}": (60, 5)}
        leading, branch[f"B{i}"] = f"C{i}", 1
    links = tuple(link(n, **at) for n, at in points.items())
    return Design("chain", None, (Drive(None, Linkage(links, (), Driver(2), sides(**branch)), None, LinkageLoads()),))


# Stephenson III driven at its far end: no dyad hangs on the crank, four links must be solved at once
INSIDE_OUT = Design(
    "Stephenson III driven inside",
    None,
    (
        Drive(
            None,
            Linkage(
                (
                    link(1, O2=(0, 0), O4=(60, 0), O6=(110, 10)),
                    link(2, O2=(0, 0), A=(30, 0)),
                    link(3, A=(0, 0), B=(50, 0), C=(60, 20)),
                    link(4, O4=(0, 0), B=(45, 0)),
                    link(5, C=(0, 0), D=(55, 0)),
                    link(6, O6=(0, 0), D=(15, 0)),
                ),
                (),
                Driver(6),
            ),
            None,
            LinkageLoads(),
        ),
    ),
)


# the same with a block on a guide for the rocker, and the driver's rod sliding on the middle link
SLIDING_GROUP = Design(
    "group with guides",
    None,
    (
        Drive(
            None,
            Linkage(
                (
                    link(1, O2=(0, 0), O6=(110, 10)),
                    link(2, O2=(0, 0), A=(40, 0)),
                    link(3, A=(0, 0), B=(60, 10)),
                    link(4, B=(0, 5)),
                    link(5, D=(0, 3)),
                    link(6, O6=(0, 0), D=(12, 0)),
                ),
                (
                    Slider(link=4, on=1, through_x_mm=60.0, through_y_mm=-20.0, angle_deg=10.0),
                    Slider(link=5, on=3, angle_deg=-30.0),
                ),
                Driver(6),
            ),
            None,
            LinkageLoads(),
        ),
    ),
)


# -- drawn backwards from a pose --------------------------------------------------------------------------


class Poor(Exception):
    """What has been drawn stands too near to a dead centre."""


class Builder:
    """A linkage in the making: poses of its links (z [mm], angle), points by link."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng
        self.poses: dict[int, tuple[complex, float]] = {FRAME: (0j, 0.0)}
        self.points: dict[int, dict[str, complex]] = {FRAME: {}}
        self.sliders: list[Slider] = []
        self.sides: list[Side] = []
        self.places: list[complex] = []

    def place(self) -> complex:
        """Somewhere apart from all places before."""
        while True:
            at = complex(*self.rng.uniform(-100.0, 100.0, 2))
            if all(abs(at - other) > 10.0 for other in self.places):
                self.places.append(at)
                return at

    def new(self, z: complex | None = None, angle: float | None = None) -> int:
        number = max(self.poses) + 1
        free = complex(*self.rng.uniform(-100.0, 100.0, 2)) if z is None else z
        self.poses[number] = (free, self.rng.uniform(-math.pi, math.pi) if angle is None else angle)
        self.points[number] = {}
        return number

    def local(self, number: int, at: complex) -> complex:
        z, angle = self.poses[number]
        return (at - z) * cmath.rect(1.0, -angle)

    def pin(self, a: int, b: int, at: complex) -> str:
        name = f"J{len({p for points in self.points.values() for p in points})}"
        for number in (a, b):
            self.points[number][name] = self.local(number, at)
        return name

    def slide(self, moving: int, on: int) -> None:
        """``moving`` slides on ``on`` along its own x axis."""
        z, angle = self.poses[moving]
        through = self.local(on, z - self.rng.uniform(-50.0, 50.0) * cmath.rect(1.0, angle))
        turned = math.degrees(math.remainder(angle - self.poses[on][1], math.tau))
        self.sliders.append(
            Slider(link=moving, on=on, through_x_mm=through.real, through_y_mm=through.imag, angle_deg=turned)
        )

    def two_known(self) -> tuple[int, int]:
        one, other = self.rng.choice(sorted(self.poses), 2, replace=False)
        return int(one), int(other)

    def side(self, joint: str, sign: float, least: float) -> None:
        """sign: sine of the transmission angle, with its sign."""
        if abs(sign) < least:
            raise Poor
        self.sides.append(Side(joint, 1 if sign > 0.0 else -1))

    def rrr(self) -> None:
        (one, other), p, q, joint = self.two_known(), self.place(), self.place(), self.place()
        a, b = self.new(), self.new()
        self.pin(one, a, p)
        self.pin(other, b, q)
        self.side(self.pin(a, b, joint), cross(q - p, joint - p) / (abs(joint - p) * abs(joint - q)), 0.3)

    def rrp(self) -> None:
        (one, rail), p, joint = self.two_known(), self.place(), self.place()
        rod, block = self.new(), self.new()
        t = cmath.rect(1.0, self.poses[block][1])
        self.pin(one, rod, p)
        self.side(self.pin(rod, block, joint), ((joint - p) * t.conjugate()).real / abs(joint - p), 0.3)
        self.slide(block, rail)

    def rpr(self) -> None:
        (one, other), p, q = self.two_known(), self.place(), self.place()
        block, bar = self.new(), self.new()
        t = cmath.rect(1.0, self.poses[block][1])
        self.pin(one, block, p)
        self.pin(other, bar, q)
        self.slide(block, bar)
        self.side(str(block), ((p - q) * t.conjugate()).real / abs(p - q), 0.3)

    def prp(self) -> None:
        one, other = self.two_known()
        a, b = self.new(), self.new()
        self._steep(a, b)
        self.slide(a, one)
        self.slide(b, other)
        self.pin(a, b, self.place())

    def rpp(self) -> None:
        one, rail = self.two_known()
        a, b = self.new(), self.new()
        self._steep(a, b)
        self.pin(one, a, self.place())
        self.slide(a, b)
        self.slide(b, rail)

    def _steep(self, a: int, b: int) -> None:
        if abs(math.sin(self.poses[a][1] - self.poses[b][1])) < 0.3:
            raise Poor

    def design(self) -> Design:
        links = tuple(
            Link(n, tuple(LinkPoint(name, at.real, at.imag) for name, at in self.points[n].items()))
            for n in sorted(self.poses)
        )
        linkage = Linkage(links, tuple(self.sliders), Driver(2), tuple(self.sides))
        return Design("random", None, (Drive(None, linkage, None, LinkageLoads()),))


KINDS = ("rrr", "rrp", "rpr", "prp", "rpp")


def assembly(seed: int, kinds: tuple[str, ...]) -> tuple[Design, float]:
    """A crank with dyads of these kinds, and a driver angle [rad] at which it stands well."""
    rng = np.random.default_rng(seed)
    while True:
        builder, q = Builder(rng), float(rng.uniform(0.3, 5.9))
        pivot = builder.place()
        crank = builder.new(z=pivot - rng.uniform(0.0, 20.0) * cmath.rect(1.0, q), angle=q)
        builder.pin(FRAME, crank, pivot)
        try:
            for kind in kinds:
                getattr(builder, kind)()
        except Poor:
            continue
        design = builder.design()
        if not faults(design):
            return design, q


def assemblies(kinds: tuple[str, ...] = KINDS, most: int = 2) -> st.SearchStrategy[tuple[Design, float]]:
    """One to ``most`` dyads of these kinds."""
    some = st.lists(st.sampled_from(kinds), min_size=1, max_size=most).map(tuple)
    return st.builds(assembly, st.integers(0, 2**32 - 1), some)


def cross(a: complex, b: complex) -> float:
    return (a.conjugate() * b).imag


# -- Newton on all loop equations -------------------------------------------------------------------------


def closure(design: Design, q: Any, x: list[Any], turn: Callable[[Any], tuple[Any, Any]]) -> list[Any]:
    """Every equation of the linkage for the poses x (x, y [mm], angle of every moving link, lowest number first).

    turn gives cosine and sine, so that numbers may be complex or power series: no complex number stands for a vector.
    """
    linkage = design.drive.mechanism
    moving = [n for n in sorted(linkage.by_number) if n != FRAME]
    poses = {FRAME: (0.0, 0.0, 0.0)} | {n: tuple(x[3 * i : 3 * i + 3]) for i, n in enumerate(moving)}

    def at(number: int, px: Any, py: Any) -> tuple[Any, Any]:
        zx, zy, angle = poses[number]
        c, s = turn(angle)
        return zx + c * px - s * py, zy + s * px + c * py

    rows: list[Any] = []
    where: dict[str, list[tuple[Any, Any]]] = {}
    for each in linkage.links:
        for p in each.points:
            where.setdefault(p.name, []).append(at(each.number, p.x_mm, p.y_mm))
    for ends in where.values():
        for (ax, ay), (bx, by) in pairwise(ends):
            rows += [bx - ax, by - ay]
    for slider in linkage.sliders:
        line = poses[slider.on][2] + math.radians(slider.angle_deg)
        c, s = turn(line)
        ox, oy = at(slider.on, slider.through_x_mm, slider.through_y_mm)
        zx, zy, angle = poses[slider.link]
        lc, ls = turn(angle)
        rows += [c * (zy - oy) - s * (zx - ox), c * ls - s * lc]
    driver = linkage.driver.link
    held = next((s for s in linkage.sliders if (s.link, s.on) == (driver, FRAME)), None)
    if held is None:
        rows.append(poses[driver][2] - q)
    else:
        c, s = turn(math.radians(held.angle_deg))
        rows.append(c * (poses[driver][0] - held.through_x_mm) + s * (poses[driver][1] - held.through_y_mm) - q)
    return rows


def plain_turn(angle: Any) -> tuple[Any, Any]:
    return np.cos(angle), np.sin(angle)


def jacobian(design: Design, q: float, x: np.ndarray) -> np.ndarray:
    """By complex steps."""
    columns = []
    for k in range(x.size):
        step = np.array(x, dtype=complex)
        step[k] += 1e-40j
        columns.append(np.imag(np.array(closure(design, q, list(step), plain_turn))) * 1e40)
    return np.array(columns).T


def complex_step(design: Design, q: float, x: np.ndarray) -> np.ndarray:
    """dx/dq: Newton for a driver at q + ih from the real position x; only the imaginary part is followed."""
    h = 1e-40
    matrix = jacobian(design, q, x)
    there = np.array(x, dtype=complex)
    for _ in range(3):
        miss = np.imag(np.array(closure(design, q + 1j * h, list(there), plain_turn)))
        there = there - 1j * np.linalg.solve(matrix, miss)
    return np.imag(there) / h


def in_series(design: Design, q: Any, start: np.ndarray, rates: tuple[float, ...] = (1.0,)) -> list[list[Any]]:
    """Every pose number with its three derivatives at fifty digits: Newton on power series of the driver's q + Σ r t^k/k!.

    start: a position in doubles; the matrix of doubles serves every step, each of which gains fourteen digits.
    """
    exact = _in_digits(design)
    driver = Series([MP.mpf(q)] + [MP.mpf(r) / MP.factorial(k + 1) for k, r in enumerate((*rates, 0.0, 0.0)[:3])])
    x: list[Any] = [Series([MP.mpf(float(v)), 0, 0, 0]) for v in start]
    inverse = MP.matrix(np.linalg.inv(jacobian(design, q, start)).tolist())
    for _ in range(8):
        rows = [r if isinstance(r, Series) else Series([r, 0, 0, 0]) for r in closure(exact, driver, x, _series_turn)]
        changes = [inverse * MP.matrix([r.c[order] for r in rows]) for order in range(4)]
        x = [Series([c - changes[k][i] for k, c in enumerate(v.c)]) for i, v in enumerate(x)]
    return [v.derivatives for v in x]


def in_digits(design: Design, q: Any, start: np.ndarray) -> list[Any]:
    """Every pose number at fifty digits."""
    exact = _in_digits(design)
    x = [MP.mpf(float(v)) for v in start]
    inverse = MP.matrix(np.linalg.inv(jacobian(design, q, start)).tolist())
    for _ in range(5):
        change = inverse * MP.matrix(closure(exact, MP.mpf(q), x, _series_turn))
        x = [v - change[i] for i, v in enumerate(x)]
    return x


def _series_turn(angle: Any) -> tuple[Any, Any]:
    if not isinstance(angle, Series):
        return MP.cos(angle), MP.sin(angle)
    turned = series_exp(angle * Series([MP.mpc(0, 1)] + [0] * (len(angle.c) - 1)))
    return turned.real, turned.imag


def _in_digits(design: Design) -> Design:
    """The numbers of the design as MP's, each the double that it is; angles of lines too."""
    linkage = design.drive.mechanism
    links = tuple(
        replace(k, points=tuple(LinkPoint(p.name, MP.mpf(p.x_mm), MP.mpf(p.y_mm)) for p in k.points))
        for k in linkage.links
    )
    return with_drive(design, mechanism=replace(linkage, links=links))


def geared(**wheels: object) -> Design:
    """A five-bar whose second crank turns by the first: by a ratio or by wheels."""
    links = (
        link(1, O2=(0, 0), O5=(60, 0)),
        link(2, O2=(0, 0), A=(20, 0)),
        link(3, A=(0, 0), C=(50, 0)),
        link(4, B=(0, 0), C=(45, 0)),
        link(5, O5=(0, 0), B=(15, 0)),
    )
    row = SecondDriver(link=5, **wheels)  # type: ignore[arg-type]
    linkage = Linkage(links, (), Driver(2), (Side("C", 1),), None, (row,))
    return Design("geared", None, (Drive(None, linkage, None, LinkageLoads()),))
