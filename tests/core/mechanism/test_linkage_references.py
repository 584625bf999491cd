"""What is claimed of linkages, against what stands outside of the code: branch by continuity, transmission angle and
mechanical advantage by triangles and forces, Newton's residual in the certificate."""

import math
from pathlib import Path

import numpy as np
import pytest
from assembled import SIZE, cases, coordinates
from linkages import INSIDE_OUT, KINDS, SLIDING_GROUP, four_bar, in_digits, link, slider_crank
from references import EPS, MP
from sampled import spread

from core.design import Design, Drive, Driver, Linkage, LinkageLoads, LinkForce, Slider, with_drive
from core.instant_centres import all_centres, mechanical_advantage
from core.mechanism import driver_ranges_of, unit_speed_kinematics
from core.mechanism.mechanism import at_driver, error_bounds
from core.study import Study, certificate_of, extremes_of, findings_of, quantity

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"


def study(design: Design, samples: int = 72) -> Study:
    made = Study(design, samples)
    assert made.design.drive.is_linkage
    return made


@pytest.mark.parametrize("kind", KINDS)
def test_a_branch_is_kept_by_continuity(kind: str) -> None:
    """As far as no dyad comes to its dead centre (two guides that turn parallel send their block to infinity), every
    body goes from sample to sample as its velocity and acceleration say (Hermite's rule): another assembly would lie
    elsewhere."""
    tried = 0
    for case in cases(kind)[::3]:
        here = next(r for r in case.driver_ranges.ranges if r.low <= case.q <= r.high)
        room = 0.02 * (here.high - here.low)
        angles = np.linspace(here.low + room, here.high - room, 1201)
        step = angles[1] - angles[0]
        kinematics = unit_speed_kinematics(case.design.drive.mechanism, angles, case.driver_ranges)
        shut = np.flatnonzero(np.min(list(kinematics.singular.values()), axis=0) < 0.02)
        at = int(np.searchsorted(angles, case.q))
        low, high = (
            max((i for i in shut if i < at), default=-1) + 1,
            min((i for i in shut if i >= at), default=angles.size),
        )
        for pose in kinematics.bodies.values():
            z, v, a = pose.z[:3, low:high]
            if z.size < 2:
                continue
            ahead = z[:-1] + step * (v[:-1] + v[1:]) / 2.0 + step * step * (a[:-1] - a[1:]) / 12.0
            gentle = step * np.abs(v[:-1]) + step**2 * np.abs(a[:-1]) < 0.05 * SIZE
            assert np.abs(ahead - z[1:])[gentle].max(initial=0.0) < 1e-3 * SIZE, case.name
            tried += int(gentle.sum())
    assert tried > 3000


@pytest.mark.parametrize("design", [slider_crank(2.0, 9e4), slider_crank(2.0, 7e4, 3.0)], ids=("central", "offset"))
def test_the_stated_doubt_counts_the_rods_themselves(design: Design) -> None:
    """A rod of many metres on a short crank: what rounding leaves of them is told by their own size, not by that of the crank."""
    driver_ranges = driver_ranges_of(design.drive.mechanism)
    angles = np.linspace(0.1, 6.1, 8)
    kinematics = unit_speed_kinematics(design.drive.mechanism, angles, driver_ranges)
    stated = error_bounds(driver_ranges.plan, driver_ranges.solve(at_driver(angles)))
    x = coordinates(kinematics)
    for i, q in enumerate(angles):
        exact = in_digits(design, float(q), x[:, i])
        for k, n in enumerate((2, 3, 4)):
            gap = [float(MP.mpf(float(x[3 * k + j, i])) - exact[3 * k + j]) * 1e-3 for j in (0, 1)]
            told = float(np.broadcast_to(stated[n].origin, angles.shape)[i])
            assert math.hypot(*gap) <= 4.0 * EPS * told + 1e-18
            assert told <= 50.0 * driver_ranges.plan.size, "and no more than needed"


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("lengths", [(100.0, 30.0, 90.0, 70.0), (30.0, 80.0, 70.0, 90.0)])
def test_the_transmission_angle_is_that_of_the_triangle(lengths: tuple[float, float, float, float], side: int) -> None:
    """Between coupler and rocker, by the law of cosines on the line from the crank's pin to the far pivot."""
    ground, crank, coupler, rocker = lengths
    made = study(four_bar(*lengths, side=side))
    d2 = ground**2 + crank**2 - 2.0 * ground * crank * np.cos(made.theta)
    angle = np.arccos((coupler**2 + rocker**2 - d2) / (2.0 * coupler * rocker))
    told = quantity("transmission.B").value(made)
    assert np.abs(told - np.minimum(angle, math.pi - angle)).max() < 1e-13
    lowest = extremes_of(made, "linkage", ("transmission.B",))["transmission.B"].low
    fine = study(four_bar(*lengths, side=side), 36000)
    assert lowest.value <= quantity("transmission.B").value(fine).min() + 1e-12


@pytest.mark.parametrize("link", [3, 4])
def test_the_mechanical_advantage_is_that_of_the_forces(link: int) -> None:
    """A torque of 1 on a link is held by its share of 1 at the driver: forces know nothing of centres."""
    base = four_bar(100.0, 30.0, 90.0, 70.0)
    loaded = with_drive(
        base, loads=LinkageLoads(forces=(LinkForce(link=link, point="B", torque_nm=1.0),), gravity_m_s2=0.0)
    )
    made = study(loaded, 24)
    torque = made.dynamics.driver
    advantage = mechanical_advantage(made.centres, f"link{link}", "link2")
    assert np.abs(torque + 1.0 / advantage).max() < 1e-12


def test_near_a_toggle_the_advantage_grows_without_limit() -> None:
    """Crank and coupler in line: the rocker stands still, its centre I24 falls on I12."""
    design = four_bar(100.0, 30.0, 90.0, 70.0)
    toggle = math.acos((100.0**2 + 120.0**2 - 70.0**2) / (2.0 * 100.0 * 120.0))
    angles = toggle + np.array([1e-2, 1e-4, 1e-6])
    table = all_centres(
        unit_speed_kinematics(design.drive.mechanism, angles, driver_ranges_of(design.drive.mechanism)), SIZE
    )
    grown = np.abs(mechanical_advantage(table, "link4", "link2"))
    assert list(grown[1:] / grown[:-1]) == pytest.approx([100.0, 100.0], rel=0.05)


@pytest.mark.parametrize("design", spread([INSIDE_OUT, SLIDING_GROUP], 1), ids=lambda design: design.name)
def test_newtons_residual_stands_in_the_certificate(design: Design) -> None:
    """It is the gap of the loops at worst, found here from the poses, and its bound is a few roundings."""
    made = study(design, 90)
    told = certificate_of(made, ("linkage",))["loop_closure"]
    gap = np.zeros(made.theta.size)
    for pair in made.linkage.pairs.values():
        if pair.kind == "revolute":
            one, other = (made.linkage.bodies[name].point(pair.point)[0] for name in (pair.on, pair.body))
            gap = np.maximum(gap, np.abs(one - other))
    assert told.value <= told.bound
    assert gap.max() / made.driver_ranges.plan.size <= made.linkage.residual.max() * (1.0 + 1e-6) + 1e-18
    assert made.linkage.residual.max() < 1e-13


def test_dead_centres_open_ranges_and_circuits_are_told_with_their_angles() -> None:
    """A double rocker driven by its long crank: two circuits, four dead centres, one finding with all of them."""
    made = study(four_bar(70.0, 60.0, 30.0, 55.0))
    (told,) = [f for f in findings_of(made, ("linkage",)) if f.code == "crank-cannot-turn"]
    ends = [math.degrees(end) for r in made.driver_ranges.ranges for end in (r.low, r.high)]
    g, c, a, b = 70.0, 60.0, 30.0, 55.0
    near, far = (math.degrees(math.acos((g * g + c * c - r * r) / (2 * g * c))) for r in (b - a, a + b))
    assert ends == pytest.approx([near, far, 360.0 - far, 360.0 - near], abs=1e-9)
    for end in ends:
        assert f"{end:.4g}" in str(told.values["ranges"])
    assert told.cam_angle_deg == pytest.approx(near, abs=1e-9)
    assert told.values["joints"] == "B"


def test_change_points_are_told_where_the_circuits_meet() -> None:
    made = study(four_bar(100.0, 40.0, 100.0, 40.0))
    changes = [f for f in findings_of(made, ("linkage",)) if f.code == "change-point"]
    assert [f.cam_angle_deg for f in changes] == pytest.approx([0.0, 180.0], abs=1e-5)


@pytest.mark.parametrize(("crank", "rod"), [(40.0, 60.0), (33.3, 57.7)])
def test_a_rod_that_is_just_long_enough_has_its_change_point_to_the_last_digits(crank: float, rod: float) -> None:
    """A slider-crank whose rod is as long as crank and offset: at 270 deg it is square to the slider's line, and passes over."""
    found = driver_ranges_of(slider_crank(crank, rod, rod - crank).drive.linkage)
    assert [math.degrees(change.at) for change in found.changes] == pytest.approx([270.0, 630.0], abs=1e-9)
    assert [r.is_free for r in found.ranges] == [True]


@pytest.mark.parametrize(("on_crank", "on_frame"), [(20.0, 65.0), (13.7, 65.1), (1.234, 147.9), (100.3, 31.7)])
def test_guides_that_turn_parallel_are_a_dead_centre_with_its_angle(on_crank: float, on_frame: float) -> None:
    """A block on a guide of the crank and on one of the frame: where both are parallel it runs off to infinity."""
    links = (link(1, O=(0, 0)), link(2, O=(0, 0)), link(3, P=(0, 0)), link(4, P=(0, 0)))
    sliders = (Slider(link=3, on=2, angle_deg=on_crank), Slider(link=4, on=1, through_y_mm=50.0, angle_deg=on_frame))
    made = study(Design("two guides", None, (Drive(None, Linkage(links, sliders, Driver(2)), None, LinkageLoads()),)))
    first = (on_frame - on_crank) % 180.0
    ends = [math.degrees(end) for r in made.driver_ranges.ranges for end in (r.low, r.high)]
    assert ends == pytest.approx([0.0, first, first, first + 180.0, first + 180.0, 360.0], abs=1e-9)
    (found,) = [f for f in findings_of(made, ("linkage",)) if f.code == "crank-cannot-turn"]
    assert found.severity == "error"
    assert found.cam_angle_deg == pytest.approx(first, abs=1e-9)


def test_a_slider_cranks_grashof_is_whether_its_crank_goes_round() -> None:
    assert [r.is_free for r in driver_ranges_of(slider_crank(40.0, 140.0, 12.0).drive.linkage).ranges] == [True]
    assert not any(r.is_free for r in driver_ranges_of(slider_crank(60.0, 45.0).drive.linkage).ranges)
