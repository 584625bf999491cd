"""Links that stand still, in a linkage that moves: as any other in tables, report and explain, with the forces of statics."""

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linkages import KINDS, Builder, Poor, four_bar, link, slider_crank
from sampled import spread

from core.__main__ import main
from core.design import (
    Attachment,
    Design,
    Driver,
    Link,
    LinkForce,
    LinkMass,
    LinkPoint,
    Motion,
    NamedCurve,
    PointSpring,
    Process,
    SecondDriver,
    Segment,
    faults,
    with_drive,
)
from core.project import save

GRAVITY = -9.80665j


def moving(kind: str) -> Design:
    """A linkage that moves, its links numbered below 10."""
    bar = four_bar(100.0, 30.0, 90.0, 70.0)
    linkage = bar.drive.linkage
    if kind == "slide":
        return slider_crank(30.0, 100.0, 5.0)
    if kind in ("motion", "dwell"):
        curve, rise = NamedCurve("cycloidal"), 30.0 if kind == "motion" else 0.0
        segments = (Segment(180.0, rise, curve), Segment(180.0, -rise, curve)) if rise else (Segment(360.0, 0.0),)
        return with_drive(
            bar, mechanism=replace(linkage, driver=Driver(2, "motion", 60.0)), motion=Motion(40.0, segments, "deg")
        )
    if kind == "ratio 0":
        first, *others = linkage.links
        first = replace(first, points=(*first.points, LinkPoint("P", -60.0, -40.0)))
        links = (first, *others, link(5, P=(0, 0), R=(40, 5)))
        return with_drive(
            bar,
            mechanism=replace(linkage, links=links, drivers=(SecondDriver(link=5, on=1, ratio=0.0, offset_deg=33.0),)),
        )
    return bar


def spring(point: str, link: int, to: str, rate: float, free: float) -> PointSpring:
    """From a point of the coupler."""
    ends = {"from_": Attachment(link=3, point=point), "to": Attachment(link=link, point=to)}
    return PointSpring(**ends, rate_n_per_mm=rate, free_length_mm=free)


def with_links_at_rest(seed: int, kind: str) -> Design:
    """That linkage with one to three dyads on the frame, or on what stands there, and loads on them."""
    rng, base = np.random.default_rng(seed), moving(kind)
    while True:
        builder = Builder(rng)
        builder.poses[9], builder.points[9] = (0j, 0.0), {}  # so that new links are numbered from 10
        builder.two_known = lambda among=builder.poses: tuple(rng.choice([n for n in among if n != 9], 2).tolist())  # type: ignore
        try:
            for _ in range(rng.integers(1, 4)):
                getattr(builder, str(rng.choice(KINDS)))()
            break
        except Poor:
            continue
    linkage, loads = base.drive.linkage, base.drive.loads
    names = {
        n: {f"K{name}": at for name, at in points.items()} or {f"T{n}": 5 + 2j} for n, points in builder.points.items()
    }
    points = {
        n: tuple(LinkPoint(name, z.real, z.imag) for name, z in row.items()) for n, row in names.items() if n != 9
    }
    first, *others = linkage.links
    links = (
        replace(first, points=(*first.points, *points.pop(1))), *others, *(Link(n, row) for n, row in sorted(points.items())),
    )  # fmt: skip
    branch = (
        *linkage.branch,
        *(replace(s, joint=s.joint if s.joint.isdecimal() else f"K{s.joint}") for s in builder.sides),
    )
    last = max(points)
    at = points[last][0].name
    loads = replace(
        loads,
        masses=tuple(
            LinkMass(link=n, mass_kg=rng.uniform(0.1, 2.0), centre_x_mm=rng.uniform(-30.0, 30.0)) for n in points
        ),
        forces=(LinkForce(link=last, point=at, x_n=20.0, y_n=-7.0, torque_nm=0.4),),
        springs=(spring("A", last, at, 1.5, 40.0),),
        process=(Process(link=last, point=at, direction_deg=30.0, cam_from_deg=20.0, cam_to_deg=120.0, force_n=25.0),),
    )
    made = replace(linkage, links=links, sliders=(*linkage.sliders, *builder.sliders), branch=branch)
    return with_drive(base, mechanism=made, loads=loads)


def tables(design: Design, folder: Path) -> dict[str, np.ndarray]:
    """The columns of linkage.csv and dynamics.csv."""
    save(design, folder / "design.toml")
    assert main(["export", str(folder / "design.toml"), "--out", str(folder), "--samples", "24"]) in (0, 1)
    columns: dict[str, np.ndarray] = {}
    for name in ("linkage.csv", "dynamics.csv"):
        with (folder / name).open(encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        columns |= {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}
    return columns


MEMBERS = [(seed, kind) for seed in range(30) for kind in ("crank", "slide", "motion", "dwell", "ratio 0")]


@pytest.mark.parametrize(("seed", "kind"), spread(MEMBERS, 3))
def test_links_at_rest_are_written_reported_and_explained_as_any_other(
    seed: int, kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    design = with_links_at_rest(seed, kind)
    assert faults(design) == []
    columns = tables(design, tmp_path)
    file = str(tmp_path / "design.toml")
    assert main(["report", file, "--samples", "24"]) in (0, 1)
    assert "NOT KEPT" not in capsys.readouterr().out
    still = {f"link{n}" for n in design.drive.linkage.by_number if n >= 10}
    own = [name for name in columns if name.partition("_")[0] in still and not name.endswith("power_w")]
    assert not any(columns[name].any() for name in own if name.endswith(("rad_s", "rad_s2", "mm_s", "mm_s2")))
    for name in own[::4]:
        assert main(["explain", file, name, "--at", "30"]) == 0
        value = float(capsys.readouterr().out.partition(" at 30°: ")[2].split()[0].replace("−", "-"))
        assert value == pytest.approx(columns[name][2], rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("seed", spread(list(range(20)), 2))
def test_a_triangle_on_the_frame_bears_what_statics_says(seed: int, tmp_path: Path) -> None:
    """Two bars between two pivots, with weights, a force, and a spring to the coupler: six equations of equilibrium at each angle. The
    driver feels nothing but the spring."""
    rng = np.random.default_rng(seed)
    pivots = (-50 - 80j, 70 - 90j)
    pin = complex(rng.uniform(-60.0, 60.0), rng.uniform(-40.0, 20.0))
    bars = [pin - pivot for pivot in pivots]
    base = four_bar(100.0, 30.0, 90.0, 70.0)
    first, *others = base.drive.linkage.links
    links = (
        replace(first, points=(*first.points, *(LinkPoint(f"Q{i}", p.real, p.imag) for i, p in enumerate(pivots)))), *others,
        *(link(5 + i, **{f"Q{i}": (0, 0), "T": (abs(bar), 0)}) for i, bar in enumerate(bars)),
    )  # fmt: skip
    side = 1 if ((pivots[1] - pivots[0]).conjugate() * (pin - pivots[0])).imag > 0.0 else -1
    branch = (*base.drive.linkage.branch, replace(base.drive.linkage.branch[0], joint="T", side=side))
    masses = tuple(
        LinkMass(link=5 + i, mass_kg=rng.uniform(0.5, 3.0), centre_x_mm=rng.uniform(0.0, 60.0), centre_y_mm=4.0)
        for i in (0, 1)
    )
    rate, free = 2.0, 30.0
    loads = replace(
        base.drive.loads, masses=masses, forces=(LinkForce(link=5, point="T", x_n=11.0, y_n=5.0, torque_nm=0.7),),
        springs=(spring("B", 6, "T", rate, free),),
    )  # fmt: skip
    columns = tables(
        with_drive(base, mechanism=replace(base.drive.linkage, links=links, branch=branch), loads=loads), tmp_path
    )
    b = columns["B_x_mm"] + 1j * columns["B_y_mm"]
    pull = rate * (np.abs(b - pin) - free) * (b - pin) / np.abs(b - pin)  # on link 6, at T
    matrix, right = np.zeros((6, 6)), np.zeros((6, b.size))
    for i, (bar, mass) in enumerate(zip(bars, masses, strict=True)):
        weight = mass.mass_kg * GRAVITY
        load = weight + (11 + 5j if i == 0 else pull)
        arm = complex(mass.centre_x_mm, mass.centre_y_mm) * bar / abs(bar)
        moment = (arm.conjugate() * weight).imag + (
            700.0 + (bar.conjugate() * (11 + 5j)).imag if i == 0 else (bar.conjugate() * pull).imag
        )
        sign = 1.0 - 2.0 * i  # the pin's force on the first bar
        matrix[3 * i, [2 * i, 4]] = 1.0, sign
        matrix[3 * i + 1, [2 * i + 1, 5]] = 1.0, sign
        matrix[3 * i + 2, [4, 5]] = -sign * bar.imag, sign * bar.real
        right[3 * i], right[3 * i + 1], right[3 * i + 2] = -np.real(load), -np.imag(load), -moment
    forces = np.linalg.solve(matrix, right)
    size = np.abs(forces).max()
    for i, name in enumerate(("Q0", "Q1")):  # by the frame on the bars
        assert np.abs(columns[f"{name}_x_n"] - forces[2 * i]).max() < 1e-9 * size
        assert np.abs(columns[f"{name}_y_n"] - forces[2 * i + 1]).max() < 1e-9 * size
    assert np.abs(np.abs(columns["T_n"]) - np.hypot(forces[4], forces[5])).max() < 1e-9 * size
    speed = math.tau
    given = columns["driver_torque_nm"] * speed
    rates = (columns["B_vx_mm_s"] + 1j * columns["B_vy_mm_s"]) * 1e-3
    assert given == pytest.approx(np.real(np.conj(pull) * rates), abs=1e-9 * np.abs(given).max())
