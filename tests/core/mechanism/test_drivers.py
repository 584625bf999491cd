"""core.mechanism.drivers: any link leads a linkage, and the cam under a roller on any link makes it follow its motion."""

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linkages import closure, jacobian, plain_turn
from sampled import spread, stressed

from core.design import CRANK, MOTION, Design, Driver, Roller, faults, with_drive
from core.errors import KindynaError, NoPosition
from core.mechanism.drivers import driver_position, drivers, roller_points, with_driver, with_roller, without_roller
from core.project import load
from core.project.writing import to_table
from core.study import Study

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
LINKAGES = sorted(p.stem for p in EXAMPLES.glob("*.toml") if "\n[linkage]\n" in p.read_text("utf-8"))


def example(name: str) -> Design:
    design = load(EXAMPLES / f"{name}.toml")
    assert design.drive.is_linkage
    return design


def at(design: Design, theta: float) -> Study:
    study = Study(design).at_theta(np.array([theta]))
    assert study.design.drive.is_linkage
    return study


def places(study: Study) -> dict[str, complex]:
    return {name: complex(z[0]) for name, (z, _) in study.points().items()}


def led(name: str, theta: float, driver: Driver) -> Design:
    design = example(name)
    return with_driver(design, driver, at(design, theta).linkage)


# -- which link leads -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", spread(LINKAGES, 3))
def test_whatever_leads_the_linkage_goes_on_from_where_it_stands(name: str) -> None:
    """Every point stays; no link jumps into another way of assembly; nothing is wrong with the design."""
    design = example(name)
    before = at(design, 1.0)
    tried = [driver for driver in drivers(design) if driver.link < 6]
    assert {d.kind for d in tried} == {CRANK, MOTION} or name in ("cam_slider_linkage",)
    for driver in tried:
        changed = with_driver(design, driver, before.linkage)
        assert faults(changed) == []
        assert (changed.drive.mechanism.driver.link, changed.drive.mechanism.driver.kind) == (driver.link, driver.kind)
        same = (driver.link, driver.kind) == (design.drive.mechanism.driver.link, design.drive.mechanism.driver.kind)
        theta = (
            driver_position(changed.drive.mechanism, before.linkage) % (2.0 * math.pi) if driver.kind == CRANK else 0.0
        )
        size = Study(changed).driver_ranges.plan.size
        after = places(at(changed, 1.0 if same else theta))
        assert after == pytest.approx(places(before), abs=1e-6 * size), driver  # a motion starts at a rounded place


def test_a_first_motion_goes_as_far_as_the_linkage_lets_it() -> None:
    """Half of the way to the next dead centre at most, towards the side with more room; all of it is assumed."""
    design = led("inverted_slider_crank", 1.0, Driver(4, MOTION, 60.0))
    motion = design.drive.motion
    assert motion is not None
    assert motion.unit == "deg"
    assert [s.span_deg for s in motion.segments] == [60.0, 120.0, 60.0, 120.0]
    assert [s.rise for s in motion.segments] == [0.0, 10.0, 0.0, -10.0]
    assert [p for p in design.assumed if p.startswith("motion.")][:2] == ["motion.start_deg", "motion.segments[0].law"]
    slide = led("slider_crank", 1.0, Driver(4, MOTION, 60.0)).drive.motion
    assert slide is not None
    assert slide.unit == "mm"
    assert slide.start == pytest.approx(157.505736)


def test_a_crank_at_speed_has_neither_motion_nor_cam() -> None:
    design = led("four_bar_coupler_cam", 1.0, Driver(2, CRANK, 60.0))
    assert design.drive.motion is None
    assert design.drive.cam is None
    assert [path for path in design.assumed if path.startswith(("motion", "cam"))] == []
    assert Study(design).stages == ("linkage", "dynamics")


def test_a_link_at_its_dead_centre_leads_nothing() -> None:
    """Where crank and coupler lie in one line the rocker cannot push them on."""
    design = example("four_bar")
    stretched = math.acos((100.0**2 + 120.0**2 - 70.0**2) / (2.0 * 100.0 * 120.0))
    for theta in (stretched, stretched + 0.01):  # in line, and so near that a push would hardly turn the crank
        with pytest.raises(NoPosition, match=r"linkage\.driver\.link"):
            with_driver(design, Driver(4, MOTION, 60.0), at(design, theta).linkage)
    assert with_driver(design, Driver(4, MOTION, 60.0), at(design, stretched + 0.2).linkage).drive.motion is not None


def test_what_cannot_lead_is_not_offered() -> None:
    found = [(d.link, d.kind) for d in drivers(example("lecture_six_bar"))]
    assert found == [(2, CRANK), (2, MOTION), (4, CRANK), (4, MOTION), (6, MOTION)]


# -- where the roller is ----------------------------------------------------------------------------------


def test_a_roller_comes_moves_and_goes() -> None:
    crank = example("four_bar")
    assert roller_points(crank) == ((2, "A"), (3, "B"), (3, "C"))
    with pytest.raises(KindynaError, match=r"linkage\.driver\.kind: a cam needs a motion"):
        with_roller(crank, 3, "C")
    design = led("four_bar", 0.0, Driver(2, MOTION, 60.0))
    first = with_roller(design, 3, "C")
    assert first.drive.cam is not None
    assert (first.drive.cam.link, first.drive.cam.point, first.drive.face.radius_mm) == (3, "C", 8.0)
    assert first.assumed[-1] == "cam.roller_radius_mm"
    larger = with_drive(first, cam=replace(first.drive.cam, face=Roller(11.0)))
    moved = with_roller(larger, 3, "B").drive.cam
    assert moved is not None
    assert (moved.point, moved.face.radius_mm) == ("B", 11.0)
    assert without_roller(first) == design


def test_a_linkage_made_so_is_written_and_read_again(tmp_path: Path) -> None:
    from core.project import save

    design = with_roller(led("watt_six_bar", 1.0, Driver(6, MOTION, 60.0)), 5, "D")
    save(design, tmp_path / "d.toml")
    assert load(tmp_path / "d.toml") == design
    assert to_table(design)["cam"]["point"] == "D"


# -- the cam drives it ------------------------------------------------------------------------------------


def roller_centre(design: Design, q: float, start: np.ndarray) -> complex:
    """Where the roller stands [mm] with the driver at q, by Newton on all loop equations at once, of other code than the
    core's."""
    x = start.copy()
    for _ in range(8):
        x = x - np.linalg.solve(jacobian(design, q, x), np.array(closure(design, q, list(x), plain_turn), dtype=float))
    assert design.drive.cam is not None
    numbers = sorted(link.number for link in design.drive.mechanism.links if link.number != 1)
    i = 3 * numbers.index(design.drive.cam.link)
    local = design.drive.mechanism.by_number[design.drive.cam.link].places[design.drive.cam.point]
    return complex(x[i], x[i + 1]) + local * complex(math.cos(x[i + 2]), math.sin(x[i + 2]))


def distance(outline: np.ndarray, place: complex) -> float:
    """From a place to a closed outline: of the samples about the nearest a parabola through the squares."""
    square = np.abs(outline - place) ** 2
    i = int(square.argmin())
    before, here, after = square[[i - 1, i, (i + 1) % outline.size]]
    return math.sqrt(here - (after - before) ** 2 / (8.0 * (after - 2.0 * here + before)))


def driven(design: Design, angles: tuple[float, ...]) -> Iterator[tuple[float, float]]:
    """Where the cam pushes the driver, and where the motion wants it, at some cam angles [deg]."""
    study = Study(design, 3600)
    assert study.design.drive.is_linkage
    assert design.drive.cam is not None
    scale = 1e3 if design.drive.motion is not None and design.drive.motion.unit == "mm" else 1.0
    numbers = [body for body in study.linkage.bodies if body.startswith("link")]
    for angle in angles:
        i = round(10 * angle)
        outline = study.cam.flank.profile * 1e3 * np.exp(1j * study.sense * study.theta[i])
        poses = [study.linkage.bodies[body] for body in numbers]
        start = np.array([v for p in poses for v in (p.x[0, i] * 1e3, p.y[0, i] * 1e3, p.angle[0, i])])
        wanted = float(study.motion.y[0, i]) * scale
        gap = lambda q: distance(outline, roller_centre(design, q, start)) - design.drive.face.radius_mm  # noqa: B023, E731
        one, other = wanted - 0.02 * scale**0.5, wanted + 0.03 * scale**0.5
        values = gap(one), gap(other)
        for _ in range(12):  # secants
            if values[0] == values[1]:
                break
            one, other = other, other - values[1] * (other - one) / (values[1] - values[0])
            values = values[1], gap(other)
        yield other, wanted


@pytest.mark.parametrize(
    ("name", "theta", "driver", "roller"),
    [
        ("four_bar", 0.0, 2, (3, "C")),
        stressed("lecture_six_bar", 1.0, 6, (3, "B")),
        stressed("watt_six_bar", 1.0, 6, (4, "C")),
        stressed("slider_crank", 1.0, 4, (3, "B")),
        stressed("inverted_slider_crank", 0.0, 2, (4, "B")),
        stressed("stephenson_six_bar", 1.0, 4, (5, "D")),
    ],
)
def test_the_cam_alone_moves_the_linkage_as_its_motion_says(
    name: str, theta: float, driver: int, roller: tuple[int, str]
) -> None:
    """The roller is laid on the profile by brute force: the place of the driver at which it touches is the motion's."""
    design = with_roller(led(name, theta, Driver(driver, MOTION, 60.0)), *roller)
    for found, wanted in driven(design, (30.0, 100.0, 150.0, 260.0, 330.0)):
        assert found == pytest.approx(wanted, abs=2e-6)
