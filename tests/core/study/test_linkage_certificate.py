"""The certificate of a linkage: every example, led by any of its links and with the roller anywhere, keeps its bounds."""

import math
from pathlib import Path

import numpy as np
import pytest
from linkages import assembly
from sampled import spread

from core.design import CRANK, Design, Driver, LinkageLoads, LinkMass, with_drive
from core.errors import NoCam, NoPosition
from core.instant_centres import collinearity
from core.mechanism.drivers import drivers, roller_points, with_driver, with_roller
from core.project import load
from core.study import Study, certificate_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
LINKAGES = sorted(p.stem for p in EXAMPLES.glob("*.toml") if "\n[linkage]\n" in p.read_text("utf-8"))


def led(name: str, theta: float, driver: Driver) -> Design:
    """An example led by another link from where its own driver stands at theta, every link with a mass."""
    design = load(EXAMPLES / f"{name}.toml")
    assert design.drive.is_linkage
    here = Study(design).at_theta(np.array([theta]))
    assert here.design.drive.is_linkage
    masses = tuple(
        LinkMass(link=n, mass_kg=float(n), inertia_kg_m2=0.01 * n, centre_x_mm=3.0)
        for n in design.drive.mechanism.by_number
        if n != 1
    )
    return with_drive(with_driver(design, driver, here.linkage), loads=LinkageLoads(masses=masses))


def beyond(design: Design) -> dict[str, tuple[float, float]]:
    told = certificate_of(Study(design, 180))
    return {name: (r.value, r.bound) for name, r in told.items() if not r.kept}


@pytest.mark.parametrize("name", spread(LINKAGES, 3))
def test_whichever_link_leads_and_wherever_the_roller_is_the_bounds_hold(name: str) -> None:
    rng = np.random.default_rng(6)
    design = load(EXAMPLES / f"{name}.toml")
    assert design.drive.is_linkage
    proven = 0
    for driver in rng.permutation(np.array(list(drivers(design)), dtype=object))[:3]:
        try:
            changed = led(name, rng.uniform(0.0, 2.0 * math.pi), driver)
        except NoPosition:
            continue  # stood where it cannot lead
        places = roller_points(changed) if driver.kind != CRANK else ()
        if places:
            changed = with_roller(changed, *places[rng.integers(len(places))])
        try:
            assert beyond(changed) == {}, driver
            proven += 1
        except NoCam:
            continue  # the roller covers the cam's centre, or goes round it
    assert proven > 0


def test_a_crank_that_stops_at_a_dead_centre_has_a_certificate() -> None:
    """At the dead centre itself no bound holds, and none is broken: it is infinite, not undefined."""
    design = led("lecture_six_bar", 1.0, Driver(4, CRANK, 60.0))
    assert beyond(design) == {}
    assert not np.isnan(Study(design, 180).linkage.condition).any()


@pytest.mark.parametrize(
    ("name", "theta", "driver", "roller"),
    [
        ("rear_suspension", 1.0, 4, (3, "B")),
        ("rear_suspension", 1.0, 4, (3, "W")),
        ("four_bar", 1.4692117491048986, 4, (3, "C")),
    ],
)
def test_a_pole_far_away_is_as_certain_as_its_lines(
    name: str, theta: float, driver: int, roller: tuple[int, str]
) -> None:
    """The bound of the cam's instant centre knows how flat the lines cross which find it, and stays far from telling
    nothing."""
    samples = 720 if name == "four_bar" else 180  # which come near to where two lines are parallel
    study = Study(with_roller(led(name, theta, Driver(driver, "motion", 60.0)), *roller), samples)
    residual = certificate_of(study, ("cam",))["instant_centre"]
    assert residual.kept
    assert residual.bound < 1e-6
    error_bound = np.asarray(study.cam.centre.error_bound)
    assert error_bound.min() >= 1.0
    assert float(np.median(error_bound)) < 300.0


@pytest.mark.parametrize(
    ("theta", "driver", "roller"), [(3.604293830618288, 2, (3, "B")), (0.7742172426483569, 4, (3, "C"))]
)
def test_a_force_through_a_steep_cam_is_as_certain_as_its_hold(
    theta: float, driver: int, roller: tuple[int, str]
) -> None:
    """Near a pressure angle of 90 degrees, or where the roller hardly moves, a little rounding is much of the force."""
    study = Study(
        with_roller(led("four_bar", theta, Driver(driver, "motion", 60.0)), *roller), 361 if driver == 4 else 180
    )
    assert float(np.abs(study.dynamics.lever).min()) < 1e-4  # metres, of a linkage of 0.1
    for name in ("power_balance", "momentum_balance"):
        residual = certificate_of(study, ("dynamics",))[name]
        assert residual.kept
        assert residual.bound < 1e-8


@pytest.mark.parametrize("name", ["four_bar", "lecture_six_bar"])
def test_a_roller_that_goes_round_the_cam_centre_is_no_cam(name: str) -> None:
    """The crank's pin stays on a circle about the frame's origin: a concentric disk, which moves nothing."""
    design = with_roller(led(name, 1.0, Driver(2, "motion", 60.0)), 2, "A")
    with pytest.raises(NoCam, match=r"cam\.point: the roller keeps its distance from the cam centre"):
        _ = Study(design, 90).cam


def test_a_roller_on_the_pivot_of_its_link_is_no_cam() -> None:
    design = with_roller(led("four_bar", 1.0, Driver(4, "motion", 60.0)), 4, "O4")
    with pytest.raises(NoCam, match=r"cam\.point: the roller keeps its distance from the cam centre"):
        _ = Study(design, 90).cam


def test_centres_of_links_that_move_nearly_alike_are_as_certain_as_what_is_left_of_their_velocities() -> None:
    """Three links that slide on each other turn alike: their centres are at infinity, told by small differences."""
    design, _ = assembly(1173854518, ("rpr", "rpp", "rpp"))
    study = Study(design, 180)
    assert beyond(design) == {}
    assert collinearity(study.centres).max() < 1e-10
    assert certificate_of(study, ("linkage",))["three_centres"].bound < 1e-7
