"""Cranks that swing with a second input, against a bisection of the loop's closure; linkages that return after several turns."""

import cmath
import csv
import math
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from linkages import four_bar, link
from sampled import spread

from core.__main__ import main
from core.design import (
    Design,
    Drawn,
    Drive,
    Driver,
    Linkage,
    LinkageLoads,
    LinkMass,
    LinkPoint,
    Motion,
    NamedCurve,
    NamedMotion,
    SecondDriver,
    Segment,
    faults,
)
from core.project import save
from core.study import Study, certificate_of, findings_of

RATIOS = {"half": -0.5, "equal": 1.0, "three halves": 1.5, "no fraction": math.sqrt(2.0)}
ADVANCES = {"returns": 0.0, "advances a turn": 360.0, "advances a third": 120.0}


class Swing(NamedTuple):
    """A five-bar whose crank swings: low, high [deg] its ends; second [deg] the angle of the second input; joint where B is."""

    design: Design
    low: float
    high: float
    second: Callable[[float], float]
    joint: Callable[[float], complex]


def cycloidal(u: float) -> float:
    return u - math.sin(math.tau * u) / math.tau


def swing(rng: np.random.Generator, kind: str) -> Swing | None:
    """A crank at O, the second input at ``ground`` mm, their ends joined by two rods; None where the crank turns fully."""
    crank, rod, other = rng.uniform(30.0, 80.0), *rng.uniform(40.0, 90.0, 2)
    ground, arm, offset = rng.uniform(80.0, 130.0), rng.uniform(10.0, 40.0), rng.uniform(-180.0, 180.0)
    start, rise, first, dwell = *rng.uniform(-60.0, 60.0, 2), rng.uniform(60.0, 150.0), rng.uniform(10.0, 60.0)
    advance = ADVANCES.get(kind, 0.0)

    def second(q: float) -> float:
        if kind in RATIOS:
            return RATIOS[kind] * q + offset
        turns = math.floor(q / 360.0)
        at = q - 360.0 * turns
        back = (at - first - dwell) / (360.0 - first - dwell)
        up = rise * cycloidal(at / first) if at < first else rise
        return start + offset + advance * turns + up + ((advance - rise) * cycloidal(back) if back > 0.0 else 0.0)

    def ends(q: float) -> tuple[complex, complex]:
        return cmath.rect(crank, math.radians(q)), ground + cmath.rect(arm, math.radians(second(q)))

    def room(q: float) -> float:
        distance = abs(ends(q)[1] - ends(q)[0])
        return min(rod + other - distance, distance - abs(rod - other))

    drawn = next((q for q in rng.uniform(-180.0, 180.0, 40).tolist() if room(q) > 2.0), None)
    if drawn is None:
        return None
    side = rng.choice([-1.0, 1.0])

    def joint(q: float) -> complex:
        a, d = ends(q)
        distance = abs(d - a)
        along = (distance**2 + rod**2 - other**2) / (2.0 * distance)
        return a + (d - a) / distance * complex(along, side * math.sqrt(max(0.0, rod**2 - along**2)))

    limits = []
    for step in (-0.02, 0.02):
        good = drawn
        while room(good + step) > 0.0:
            good += step
            if abs(good - drawn) > 2000.0:
                return None
        bad = good + step
        while (middle := 0.5 * (good + bad)) not in (good, bad):
            good, bad = (middle, bad) if room(middle) > 0.0 else (good, middle)
        limits.append(good)

    row, motions = SecondDriver(link=5, on=1, offset_deg=offset, ratio=RATIOS.get(kind)), ()
    if kind not in RATIOS:
        curve = NamedCurve("cycloidal")
        segments = (
            Segment(first, rise, curve), Segment(dwell, 0.0), Segment(360.0 - first - dwell, advance - rise, curve),
        )  # fmt: skip
        row = SecondDriver(link=5, on=1, offset_deg=offset, motion="feed")
        motions = (NamedMotion("feed", Motion(start, segments, "deg", advance or None)),)
    links = (
        link(1, O=(0, 0), P=(ground, 0)), link(2, O=(0, 0), A=(crank, 0)), link(3, A=(0, 0), B=(rod, 0)),
        link(4, D=(0, 0), B=(other, 0)), link(5, P=(0, 0), D=(arm, 0)),
    )  # fmt: skip
    a, d = ends(drawn)
    pins = {"A": a, "D": d, "B": joint(drawn)}
    at = Drawn(drawn, None, tuple(LinkPoint(name, z.real, z.imag) for name, z in pins.items()))
    masses = tuple(LinkMass(link=n, mass_kg=1.0, inertia_kg_m2=1e-3, centre_x_mm=15.0) for n in (3, 4, 5))
    linkage = Linkage(links, (), Driver(2), (), at, (row,), motions)
    design = Design("swing", None, (Drive(None, linkage, None, LinkageLoads(masses=masses)),))
    return Swing(design, limits[0], limits[1], second, joint)


def table(design: Design, folder: Path, samples: int = 72, code: int = 0) -> list[dict[str, float]]:
    """The rows of linkage.csv."""
    save(design, folder / "design.toml")
    assert main(["export", str(folder / "design.toml"), "--out", str(folder), "--samples", str(samples)]) == code
    with (folder / "linkage.csv").open(encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


MEMBERS = [(kind, seed) for kind in (*ADVANCES, *RATIOS) for seed in range(8)]


@pytest.mark.parametrize(("kind", "seed"), spread(MEMBERS, 4))
def test_a_crank_that_cannot_turn_swings_between_the_ends_of_its_circuit(kind: str, seed: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed)
    case = next(found for _ in range(200) if (found := swing(rng, kind)) is not None)
    assert faults(case.design) == []
    study = Study(case.design, 72)
    (note,) = [f for f in findings_of(study) if f.code == "swinging-driver"]
    assert note.values["low"] == pytest.approx(case.low, abs=1e-6)
    assert note.values["high"] == pytest.approx(case.high, abs=1e-6)
    assert all(residual.kept for residual in certificate_of(study).values())
    rows = table(case.design, tmp_path)
    assert [row["cycle_deg"] for row in rows] == [5.0 * i for i in range(72) if i not in (0, 36)], (
        "in order, but for the ends"
    )
    for row in rows:
        part = min(row["cycle_deg"], 360.0 - row["cycle_deg"]) / 180.0
        q = row["driver_angle_deg"]
        assert q == pytest.approx(case.low + (case.high - case.low) * part, abs=1e-6)
        assert math.remainder(row["link5_deg"] - case.second(q), 360.0) == pytest.approx(0.0, abs=1e-9)
        assert complex(row["B_x_mm"], row["B_y_mm"]) == pytest.approx(case.joint(q), abs=1e-6)
    forth, back = rows[:35], rows[:34:-1]
    assert [row["link5_rad_s"] for row in forth] == pytest.approx([-row["link5_rad_s"] for row in back], abs=1e-9)


def kite(short: float, long: float, side: int = 1) -> Design:
    """Frame and crank alike, coupler and rocker alike: the rocker turns once while the crank turns twice."""
    return four_bar(short, short, long, long, side)


@pytest.mark.parametrize(
    ("short", "long", "side"),
    spread(
        [
            (*np.random.default_rng(seed).uniform((20.0, 61.0), (60.0, 150.0)).tolist(), 1 - 2 * (seed % 2))
            for seed in range(20)
        ],
        2,
    ),
)
def test_a_kite_returns_after_two_turns_of_its_crank(short: float, long: float, side: int, tmp_path: Path) -> None:
    """B stays as far from A as from O4, and link 4 turns once, without a jump."""
    design = kite(short, long, side)
    rows = table(design, tmp_path)
    assert main(["check", str(tmp_path / "design.toml")]) == 0
    assert [row["cycle_deg"] for row in rows] == [5.0 * i for i in range(72)]
    turned = np.unwrap(np.deg2rad([row["link4_deg"] for row in rows]))
    assert abs(turned[-1] - turned[0]) > math.tau * 0.95
    assert np.abs(np.diff(turned)).max() < 0.3
    for row in rows:
        assert row["driver_angle_deg"] == pytest.approx(2.0 * row["cycle_deg"], abs=1e-9)
        a, b = cmath.rect(short, math.radians(row["driver_angle_deg"])), complex(row["B_x_mm"], row["B_y_mm"])
        assert abs(b - a) == pytest.approx(long, rel=1e-9)
        assert abs(b - short) == pytest.approx(long, rel=1e-9)


@pytest.mark.parametrize(("ratio", "turns"), [(2.0, 2), (0.5, 2), (2.0 / 3.0, 6), (-1.0 / 5.0, 10)])
def test_a_geared_chain_with_a_kite_returns_after_the_turns_of_both(ratio: float, turns: int, tmp_path: Path) -> None:
    """A second input with a dyad between it and the rocker of a kite."""
    drive = kite(40.0, 100.0).drive
    _, *others = drive.linkage.links
    links = (
        link(1, O2=(0, 0), O4=(40, 0), P=(0, -150)), *others, link(5, P=(0, 0), G=(20, 0)), link(6, G=(0, 0), H=(190, 0)),
        link(7, H=(0, 0), B=(180, 0)),
    )  # fmt: skip
    row = SecondDriver(link=5, on=1, ratio=ratio)
    linkage = Linkage(links, (), Driver(2), drive.linkage.branch, None, (row,))
    design = Design("geared kite", None, (Drive(None, linkage, None, LinkageLoads()),))
    save(design, tmp_path / "design.toml")
    assert main(["check", str(tmp_path / "design.toml")]) == 0
    study = Study(design, 360)
    assert study.turns == turns
    ends = study.at_theta(np.array([0.0, math.tau * (1.0 - 1e-9)])).linkage.bodies
    for body in ends.values():
        assert body.z[0][0] == pytest.approx(body.z[0][1], abs=1e-6)


def test_what_needs_four_turns_shows_one_and_says_so(tmp_path: Path) -> None:
    """A kite that is driven by the rocker of another."""
    drive = kite(40.0, 100.0).drive
    _, second, third, _ = drive.linkage.links
    links = (
        link(1, O2=(0, 0), O4=(40, 0), O6=(70, 0)), second, third, link(4, O4=(0, 0), B=(100, 0), C=(18, 24)),
        link(5, C=(0, 0), D=(80, 0)), link(6, O6=(0, 0), D=(80, 0)),
    )  # fmt: skip
    linkage = Linkage(links, (), Driver(2), drive.linkage.branch)
    design = Design("kites", None, (Drive(None, linkage, None, LinkageLoads()),))
    rows = table(design, tmp_path)
    assert next(iter(rows[0])) == "driver_angle_deg"
    (note,) = [f for f in findings_of(Study(design)) if f.code == "no-common-period"]
    assert (note.severity, note.field) == ("note", "linkage.links")
    assert "within 2 turns of the driver: the first turn is shown" in note.message
    assert not [f for f in findings_of(Study(design)) if f.severity == "error"]
