"""core.mechanism: linkages decomposed into dyads and solved; every reference comes from outside the code."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from assembled import cases, coordinates
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from linkages import (
    INSIDE_OUT,
    KINDS,
    SLIDING_GROUP,
    assembly,
    closure,
    complex_step,
    four_bar,
    in_digits,
    in_series,
    link,
    plain_turn,
    sides,
    slider_crank,
)
from references import EPS, MP
from sampled import spread

from core.design import CRANK, Design, Drive, Driver, Linkage, LinkageLoads, Slider, put, with_drive
from core.design.topology import mobility, solving_order
from core.errors import NoPosition
from core.mechanism import (
    CrankMotion,
    body_name,
    driver_ranges_of,
    mechanism_of,
    plan_of,
    solve_mechanism,
    unit_speed_kinematics,
)
from core.mechanism.branches import four_bar as four_bar_of
from core.mechanism.kinematics import FRAME, Kinematics
from core.mechanism.mechanism import at_driver, error_bounds
from core.numerics.derivatives import Derivatives

TURN = 2.0 * math.pi
DEG = math.pi / 180.0


def kinematics_at(design: Design, *angles: float) -> Kinematics:
    """The linkage at driver positions [rad or m], derivatives by the driver's coordinate."""
    ends = () if design.drive.mechanism.driver.kind == CRANK else (min(angles) - 1e-3, max(angles) + 1e-3)
    return unit_speed_kinematics(
        design.drive.mechanism, np.array(angles), driver_ranges_of(design.drive.mechanism, *ends)
    )


# -- the structure ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_of_dyad_is_recognised(kind: str) -> None:
    for seed in range(15):
        design, _ = assembly(seed, (kind,))
        order = solving_order(design.drive.mechanism)
        assert [step.kind for step in order.steps] == [kind.upper()]
        assert not order.redundant
        assert not order.undetermined
        assert mobility(design.drive.mechanism) == 1


def test_links_that_hang_on_nothing_known_are_solved_as_a_group() -> None:
    (step,) = solving_order(INSIDE_OUT.drive.mechanism).steps
    assert (step.kind, step.links) == ("group", (2, 3, 4, 5))


def test_the_order_does_not_depend_on_the_order_of_the_links() -> None:
    design = four_bar(100.0, 30.0, 90.0, 70.0)
    turned = with_drive(design, mechanism=replace(design.drive.mechanism, links=design.drive.mechanism.links[::-1]))
    assert solving_order(turned.drive.mechanism).steps == solving_order(design.drive.mechanism).steps


def test_three_links_on_one_pin_are_two_pairs() -> None:
    """A fourth link hangs on the same pin as coupler and rocker."""
    base = four_bar(100.0, 30.0, 90.0, 70.0).drive.mechanism
    links = (
        link(1, O2=(0, 0), O4=(100, 0), O6=(150, 60)),
        *base.links[1:],
        link(5, B=(0, 0), D=(60, 0)),
        link(6, O6=(0, 0), D=(50, 0)),
    )
    design = Design(
        "compound pin", None, (Drive(None, Linkage(links, (), Driver(2), sides(B=1, D=1)), None, LinkageLoads()),)
    )
    assert mobility(design.drive.mechanism) == 1
    kinematics = kinematics_at(design, *np.linspace(0.0, 6.0, 50))
    b = [kinematics.bodies[body_name(n)].point("B")[0] for n in (3, 4, 5)]
    assert np.abs(b[0] - b[1]).max() < 1e-16
    assert np.abs(b[2] - b[1]).max() < 1e-16
    assert {pair.point for pair in kinematics.pairs.values()} == {"O2", "A", "B", "O4", "D", "O6"}
    assert len(kinematics.pairs) == 7


# -- positions and derivatives ----------------------------------------------------------------------------


@pytest.mark.parametrize("kind", spread(KINDS, 2))
def test_any_linkage_closes_and_stands_where_it_was_drawn(kind: str) -> None:
    for case in cases(kind):
        assert case.kinematics.residual.max() <= 1e-13, case.name
        miss = np.array(closure(case.design, case.q, list(case.x), plain_turn), dtype=float)
        assert np.abs(miss).max() <= 1e-11, case.name  # [mm], lengths of some hundred


@pytest.mark.parametrize("kind", KINDS)
def test_velocities_are_complex_step_derivatives(kind: str) -> None:
    for case in cases(kind):
        x, rates = case.x, coordinates(case.kinematics, 1)[:, 0]
        expected = complex_step(case.design, case.q, x)
        scale = np.where(np.arange(x.size) % 3 == 2, 1.0, 100.0) + np.abs(expected).max()
        assert np.abs((rates - expected) / scale).max() <= 1e-12, case.name


@pytest.mark.parametrize("kind", spread(KINDS, 2))
def test_three_derivatives_are_those_of_a_power_series(kind: str) -> None:
    """To 50 digits, for a driver that does not run evenly."""
    for case in cases(kind)[1::4]:
        solved = case.driver_ranges.solve(Derivatives.of(np.array([[case.q], [1.3], [-0.7], [0.4]])))
        expected = in_series(case.design, case.q, case.x, (1.3, -0.7, 0.4))
        for i, n in enumerate(sorted(n for n in solved.poses if n != 1)):
            pose = solved.poses[n]
            for order in range(4):
                told = (pose.z[order, 0].real * 1e3, pose.z[order, 0].imag * 1e3, pose.angle[order, 0])
                for k, value in enumerate(told):
                    exact = expected[3 * i + k][order]
                    size = max(1.0 if k == 2 else 100.0, max(abs(float(r[order])) for r in expected))
                    assert abs(float(MP.mpf(float(value)) - exact)) <= 1e-11 * size, case.name


@pytest.mark.parametrize("design", spread([INSIDE_OUT, SLIDING_GROUP], 1), ids=lambda design: design.name)
def test_a_group_is_solved_like_the_others(design: Design) -> None:
    """Positions close, velocities are complex steps, third derivatives those of a power series."""
    driver_ranges = driver_ranges_of(design.drive.mechanism)
    only = driver_ranges.ranges[0]
    angles = np.linspace(only.low + 0.05, only.high - 0.05, 40)
    kinematics = unit_speed_kinematics(design.drive.mechanism, angles, driver_ranges)
    assert kinematics.residual.max() <= 1e-13
    for i in (0, 17, 39):
        x, rates = coordinates(kinematics)[:, i], coordinates(kinematics, 1)[:, i]
        expected = complex_step(design, float(angles[i]), x)
        assert np.abs(rates - expected).max() <= 1e-11 * np.abs(expected).max()
    exact = in_series(design, float(angles[17]), coordinates(kinematics)[:, 17])
    for order in (2, 3):
        rates = coordinates(kinematics, order)[:, 17]
        size = max(abs(float(row[order])) for row in exact)
        assert max(abs(float(row[order]) - value) for row, value in zip(exact, rates, strict=True)) <= 1e-10 * size


def test_a_group_goes_on_smoothly_and_ends_before_its_dead_centres() -> None:
    driver_ranges = driver_ranges_of(INSIDE_OUT.drive.mechanism)
    (only,) = driver_ranges.ranges
    assert (only.low_joint, only.high_joint) == ("2-3-4-5", "2-3-4-5")
    angles = np.linspace(only.low, only.high, 4001)[1:-1]
    kinematics = unit_speed_kinematics(INSIDE_OUT.drive.mechanism, angles, driver_ranges)
    for name, pose in kinematics.bodies.items():
        steps = np.abs(np.diff(pose.angle[0])) - np.abs(pose.angle[1, :-1]) * np.diff(angles)
        assert steps.max() < 0.2, name


def started(side: int) -> tuple[Kinematics, np.ndarray]:
    """The group begun with A on this side, at the driver angles tried that lie in its range."""
    linkage = replace(INSIDE_OUT.drive.mechanism, branch=sides(A=side))
    (only,) = driver_ranges_of(linkage).ranges
    tried = np.linspace(0.0, TURN, 25)[:-1]
    inside = tried[(tried > only.low) & (tried < only.high)]
    return unit_speed_kinematics(linkage, inside, driver_ranges_of(linkage)), inside


def test_the_two_sides_of_a_group_are_two_assemblies() -> None:
    """A left or right of the line from O2 to B, as stated, at the first driver angle tried that has such an assembly."""
    links = []
    for side in (1, -1):
        kinematics, at = started(side)
        o, a, b = (kinematics.bodies["link3" if name == "B" else "link2"].point(name)[0] for name in ("O2", "A", "B"))
        assert side in np.sign(((b - o).conjugate() * (a - o)).imag)
        assert kinematics.residual.max() < 1e-13
        links.append(dict(zip(at, kinematics.bodies["link2"].angle[0], strict=True)))
    one, other = links
    both = one.keys() & other.keys()
    assert both
    assert max(abs(one[at] - other[at]) for at in both) > 0.1


@pytest.mark.parametrize(("side", "stands"), spread([(1, False), (-1, True)], 1))
def test_a_side_on_which_a_group_never_stands_has_no_range(side: int, stands: bool) -> None:
    assert bool(driver_ranges_of(replace(INSIDE_OUT.drive.mechanism, branch=sides(B=side))).ranges) == stands


# -- sides ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("side", [1, -1])
def test_plus_one_is_left_of_the_line_between_the_known_ends(side: int) -> None:
    kinematics = kinematics_at(four_bar(100.0, 30.0, 90.0, 70.0, side), *np.linspace(0.0, 6.2, 30))
    a, b = kinematics.bodies["link3"].point("A")[0], kinematics.bodies["link3"].point("B")[0]
    assert (np.sign(((0.1 - a).conjugate() * (b - a)).imag) == side).all()


@pytest.mark.parametrize("side", [1, -1])
def test_plus_one_of_a_guide_is_forward_along_it(side: int) -> None:
    kinematics = kinematics_at(slider_crank(40.0, 140.0, 10.0, side), *np.linspace(0.0, 6.2, 30))
    a, b = kinematics.bodies["link3"].point("A")[0], kinematics.bodies["link4"].point("B")[0]
    assert (np.sign(b.real - a.real) == side).all()
    assert np.abs(b.imag - 0.01).max() < 1e-17


@pytest.mark.parametrize("side", [1, -1])
def test_plus_one_of_a_sliding_link_has_its_pin_ahead(side: int) -> None:
    links = (
        link(1, O2=(0, 0), O4=(0, -90)),
        link(2, O2=(0, 0), A=(40, 0)),
        link(3, A=(0, 0)),
        link(4, O4=(0, 0), B=(160, 0)),
    )
    design = Design(
        "inverted",
        None,
        (Drive(None, Linkage(links, (Slider(link=3, on=4),), Driver(2), sides()), None, LinkageLoads()),),
    )
    linkage = replace(design.drive.mechanism, branch=(*sides(), *(replace(s, joint="3") for s in sides(B=side))))
    kinematics = unit_speed_kinematics(linkage, np.linspace(0.0, 6.2, 30), driver_ranges_of(linkage))
    arm = kinematics.bodies["link4"]
    along = (kinematics.bodies["link3"].point("A")[0] - arm.point("O4")[0]) / np.exp(1j * arm.angle[0])
    assert np.abs(along.imag).max() < 1e-16
    assert (np.sign(along.real) == side).all()


def test_a_slider_may_be_said_from_either_side() -> None:
    """The arm slides on the block, or the block on the arm: the same motion."""
    links = (
        link(1, O2=(0, 0), O4=(0, -90)),
        link(2, O2=(0, 0), A=(40, 0)),
        link(3, A=(0, 0)),
        link(4, O4=(0, 0), B=(160, 0)),
    )
    one = Linkage(links, (Slider(link=3, on=4),), Driver(2))
    other = Linkage(links, (Slider(link=4, on=3),), Driver(2), tuple(replace(s, joint="4") for s in sides(B=-1)))
    angles = np.linspace(0.0, 6.2, 30)
    arms = [unit_speed_kinematics(each, angles, driver_ranges_of(each)).bodies["link4"] for each in (one, other)]
    assert np.abs(arms[0].angle - arms[1].angle).max() < 1e-13


# -- ranges and dead centres ------------------------------------------------------------------------------


def exact_limit(ground: float, crank: float, coupler: float, rocker: float) -> float:
    """The crank angle at which coupler and rocker lie in line, by the law of cosines at 50 digits."""
    g, c, a, b = (MP.mpf(v) for v in (ground, crank, coupler, rocker))
    return float(MP.acos((g * g + c * c - (a + b) ** 2) / (2 * g * c)))


def test_a_crank_that_cannot_turn_moves_between_two_dead_centres() -> None:
    design = four_bar(100.0, 80.0, 60.0, 70.0)
    (only,) = (
        driver_ranges_of(design.drive.mechanism).ranges
        if len(driver_ranges_of(design.drive.mechanism).ranges) == 1
        else (None,)
    )
    limit = exact_limit(100.0, 80.0, 60.0, 70.0)
    ranges = driver_ranges_of(design.drive.mechanism).ranges
    assert only is None
    # open at 0: through 0 it goes from -limit to limit
    assert [(r.low_joint, r.high_joint) for r in ranges] == [("", "B"), ("B", "")]
    assert ranges[0].high == pytest.approx(limit, rel=0.0, abs=4.0 * EPS)
    assert ranges[1].low == pytest.approx(TURN - limit, rel=0.0, abs=8.0 * EPS)


def test_two_ranges_of_a_double_rocker_end_at_dead_centres() -> None:
    """Shortest link the coupler: the crank swings on either side of the frame, on separate circuits."""
    ground, crank, coupler, rocker = 70.0, 60.0, 30.0, 55.0
    ranges = driver_ranges_of(four_bar(ground, crank, coupler, rocker).drive.mechanism).ranges
    g, c, a, b = (MP.mpf(v) for v in (ground, crank, coupler, rocker))
    near, far = (float(MP.acos((g * g + c * c - r * r) / (2 * g * c))) for r in (b - a, a + b))
    expected = [(near, far), (TURN - far, TURN - near)]
    assert len(ranges) == 2
    for r, (low, high) in zip(ranges, expected, strict=True):
        assert (r.low, r.high) == pytest.approx((low, high), rel=0.0, abs=16.0 * EPS)
        assert (r.low_joint, r.high_joint) == ("B", "B")


def test_a_gap_between_samples_is_found() -> None:
    """The crank misses being able to turn by a hair's breadth: a gap of two thousandths of a degree."""
    crank, rod = 40.0, 40.0 - 2e-8
    design = put(slider_crank(crank, rod), "linkage.sliders[0].angle_deg", 0.2)
    (first, second, third) = driver_ranges_of(design.drive.mechanism).ranges
    half = float(MP.acos(MP.mpf(rod) / MP.mpf(crank)))
    assert second.low - first.high == pytest.approx(2.0 * half, rel=1e-6)
    assert half < 0.01 * TURN / 721
    assert np.degrees(0.5 * (first.high + second.low)) == pytest.approx(90.2), "between two half degrees"
    assert third.high == TURN


@pytest.mark.parametrize("side", [1, -1])
@settings(max_examples=15, derandomize=True, database=None)
@given(st.floats(20.0, 200.0), st.floats(20.0, 200.0), st.floats(20.0, 200.0), st.floats(20.0, 200.0))
def test_a_four_bar_turns_where_grashof_says_so(
    side: int, ground: float, crank: float, coupler: float, rocker: float
) -> None:
    lengths = sorted((ground, crank, coupler, rocker))
    assume(lengths[3] < 0.99 * sum(lengths[:3]))  # else it cannot be assembled at all
    surplus = lengths[0] + lengths[3] - lengths[1] - lengths[2]
    assume(abs(surplus) > 1e-3)
    design = four_bar(ground, crank, coupler, rocker, side)
    ranges = driver_ranges_of(design.drive.mechanism).ranges
    turns = surplus < 0.0 and lengths[0] in (ground, crank)
    assert (len(ranges) == 1 and ranges[0].is_free) == turns
    kind = four_bar_of(plan_of(design.drive.mechanism))
    assert kind is not None
    assert (kind.kind in ("crank-rocker", "double crank")) == turns
    assert (kind.ground, kind.crank, kind.coupler, kind.rocker) == pytest.approx(
        (ground * 1e-3, crank * 1e-3, coupler * 1e-3, rocker * 1e-3), rel=1e-15
    )


def test_outside_its_ranges_a_linkage_says_where_it_can_stand() -> None:
    design = four_bar(100.0, 80.0, 60.0, 70.0)
    with pytest.raises(NoPosition) as caught:
        kinematics_at(design, math.pi)
    told = str(caught.value)
    assert "links 3 and 4 do not meet at B at driver angle 180 deg" in told
    assert f"0...{math.degrees(exact_limit(100.0, 80.0, 60.0, 70.0)):.4g}" in told
    assert caught.value.field == "linkage.links"


def test_where_nothing_meets_there_are_no_ranges() -> None:
    assert driver_ranges_of(four_bar(300.0, 30.0, 60.0, 70.0).drive.mechanism).ranges == ()


# -- near dead centres ------------------------------------------------------------------------------------


def exact_four_bar(design: Design, q: float, side: int) -> tuple[float, float, float]:
    """Coupler and rocker angle and the condition 1 + S/K, by two circles at 50 digits."""
    places = {
        n: {p.name: MP.mpc(p.x_mm, p.y_mm) for p in k.points} for n, k in design.drive.mechanism.by_number.items()
    }
    a, b = places[2]["A"] * MP.expj(MP.mpf(q)), places[1]["O4"]
    la, lb = abs(places[3]["B"]), abs(places[4]["B"])
    d = b - a
    r = abs(d)
    x = (r * r + la * la - lb * lb) / (2 * r)
    h = side * MP.sqrt(la * la - x * x)
    joint = a + d / r * MP.mpc(x, h)
    area = 2 * r * abs(h)
    reach = (abs(a) + abs(b)) ** 2 + la * la + lb * lb
    return MP.arg(joint - a), MP.arg(joint - b), float(1 + reach / area)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("away", [1e-1, 1e-3, 1e-6, 1e-9, 1e-12, 1e-14])
def test_near_a_dead_centre_errors_stay_below_condition_times_four_eps(away: float, side: int) -> None:
    design = four_bar(100.0, 80.0, 60.0, 70.0, side)
    end = driver_ranges_of(design.drive.mechanism).ranges[0].high
    for q in (end - away, end - 0.37 * away):
        kinematics = kinematics_at(design, q)
        coupler, rocker, condition = exact_four_bar(design, q, side)
        for name, exact in (("link3", coupler), ("link4", rocker)):
            error = abs(float(MP.mpf(float(kinematics.bodies[name].angle[0, 0])) - exact))
            error = min(error, abs(error - TURN))
            assert error <= 4.0 * EPS * condition


@pytest.mark.parametrize("away", [1e-1, 1e-4, 1e-8, 1e-12])
def test_near_a_dead_centre_a_slider_keeps_its_digits(away: float) -> None:
    """Crank longer than the rod: the slider locks where the rod stands across the guide."""
    design = slider_crank(60.0, 45.0)
    end = driver_ranges_of(design.drive.mechanism).ranges[0].high
    assert end == pytest.approx(float(MP.asin(MP.mpf(45) / 60)), abs=4.0 * EPS)
    q = end - away
    pin = 60 * MP.expj(MP.mpf(q))
    run = MP.sqrt(45**2 - pin.imag**2)
    kinematics = kinematics_at(design, q)
    exact = MP.arg(MP.mpc(run, -pin.imag))
    condition = float(1 + (45 + 60 + abs(pin)) / run)
    assert abs(float(MP.mpf(float(kinematics.bodies["link3"].angle[0, 0])) - exact)) <= 4.0 * EPS * condition
    assert (
        abs(float(MP.mpf(float(kinematics.bodies["link4"].x[0, 0])) * 1000 - pin.real - run))
        <= 4.0 * EPS * 60.0 * condition
    )


@pytest.mark.parametrize("kind", spread(KINDS, 2))
def test_the_stated_condition_bounds_the_error(kind: str) -> None:
    for case in cases(kind):
        exact = in_digits(case.design, case.q, case.x)
        bound = error_bounds(case.driver_ranges.plan, case.driver_ranges.solve(at_driver(np.array([case.q]))))
        for i, n in enumerate(sorted(n for n in case.design.drive.mechanism.by_number if n != 1)):
            pose = case.kinematics.bodies[body_name(n)]
            off = [
                float(MP.mpf(float(v)) - exact[3 * i + k] * s)
                for k, (v, s) in enumerate(
                    ((pose.x[0, 0], MP.mpf("0.001")), (pose.y[0, 0], MP.mpf("0.001")), (pose.angle[0, 0], 1))
                )
            ]
            turn = abs(math.remainder(off[2], TURN))
            assert math.hypot(off[0], off[1]) <= 4.0 * EPS * float(np.ravel(bound[n].origin)[0]), case.name
            assert turn <= 4.0 * EPS * (float(np.ravel(bound[n].angle)[0]) + 2.0), case.name


# -- change points ----------------------------------------------------------------------------------------


def test_a_parallelogram_stays_one_through_its_change_points() -> None:
    """Coupler parallel to the frame at every angle, both where all links lie in line too; three derivatives are 0."""
    design = four_bar(100.0, 40.0, 100.0, 40.0)
    driver_ranges = driver_ranges_of(design.drive.mechanism)
    assert [c.at for c in driver_ranges.changes] == pytest.approx([0.0, math.pi], abs=1e-7)
    assert [r.is_free for r in driver_ranges.ranges] == [True]
    angles = np.linspace(0.0, TURN, 721)[:-1]
    kinematics = unit_speed_kinematics(design.drive.mechanism, angles, driver_ranges)
    rocker = kinematics.bodies["link4"].angle
    assert np.abs(kinematics.bodies["link3"].angle[0]).max() < 1e-12
    assert np.abs(np.remainder(rocker[0] - angles + 1.0, TURN) - 1.0).max() < 1e-12
    assert np.abs(rocker[1] - 1.0).max() < 1e-10
    assert np.abs(rocker[2]).max() < 1e-7
    assert kinematics.residual.max() < 1e-13


def test_an_antiparallelogram_stays_one_too() -> None:
    kinematics = kinematics_at(four_bar(100.0, 40.0, 100.0, 40.0, -1), *np.linspace(0.0, TURN, 360)[:-1])
    assert kinematics.bodies["link4"].angle[1].max() < 0.0, "crank and rocker turn against each other"
    assert kinematics.residual.max() < 1e-13


def test_a_slider_goes_on_through_the_pivot() -> None:
    """Crank and rod of one length: x = 2 r cos θ for the whole turn, its three derivatives with it."""
    design = slider_crank(50.0, 50.0)
    driver_ranges = driver_ranges_of(design.drive.mechanism)
    assert [c.at for c in driver_ranges.changes] == pytest.approx([0.5 * math.pi, 1.5 * math.pi], abs=1e-7)
    angles = np.linspace(0.0, TURN, 1441)[:-1]
    x = unit_speed_kinematics(design.drive.mechanism, angles, driver_ranges).bodies["link4"].x
    exact = 0.1 * np.array([np.cos(angles), -np.sin(angles), -np.cos(angles), np.sin(angles)])
    for order, bound in enumerate((1e-14, 1e-12, 1e-9, 1e-6)):
        assert np.abs(x[order] - exact[order]).max() < bound


# -- angles go on without jumps ---------------------------------------------------------------------------


def test_angles_do_not_jump_within_the_turn() -> None:
    """Also where a link passes 180 deg, or goes round with the crank."""
    double = four_bar(30.0, 80.0, 70.0, 90.0)  # drag link: both go round
    for design in (double, four_bar(100.0, 30.0, 90.0, 70.0, -1), slider_crank(40.0, 140.0, 0.0, -1)):
        kinematics = kinematics_at(design, *np.linspace(0.0, TURN, 2881)[:-1])
        for name, pose in kinematics.bodies.items():
            assert np.abs(np.diff(pose.angle[0])).max() < 0.1, name
    turning = driver_ranges_of(double.drive.mechanism).angles
    assert turning[3].rotates
    assert turning[4].rotates


def test_an_angle_does_not_depend_on_what_is_asked_with_it() -> None:
    design = four_bar(30.0, 80.0, 70.0, 90.0)
    angles = np.linspace(0.0, TURN, 100)[:-1]
    together = kinematics_at(design, *angles).bodies["link4"].angle[0]
    alone = [kinematics_at(design, q).bodies["link4"].angle[0, 0] for q in angles]
    assert np.abs(together - alone).max() <= 8.0 * EPS


# -- drivers ----------------------------------------------------------------------------------------------


def test_a_sliding_driver_pushes_the_slider_crank_backwards() -> None:
    """The slider-crank driven by its slider: the crank angle comes back."""
    forward = kinematics_at(slider_crank(40.0, 140.0), 0.9)
    s = float(forward.bodies["link4"].x[0, 0])
    base = slider_crank(40.0, 140.0).drive.mechanism
    linkage = replace(base, driver=Driver(4, "motion", 60.0), branch=sides(A=1))
    kinematics = unit_speed_kinematics(linkage, np.array([s]), driver_ranges_of(linkage, s - 0.01, s + 0.01))
    both = [float(np.remainder(kinematics.bodies["link2"].angle[0, 0], TURN))]
    other = replace(linkage, branch=sides(A=-1))
    turned = unit_speed_kinematics(other, np.array([s]), driver_ranges_of(other, s - 0.01, s + 0.01)).bodies["link2"]
    both.append(float(np.remainder(turned.angle[0, 0], TURN)))
    assert sorted(both) == pytest.approx([0.9, TURN - 0.9], abs=1e-14)
    rate = kinematics.bodies["link2"].angle[1, 0]
    assert abs(rate) == pytest.approx(abs(1.0 / forward.bodies["link4"].x[1, 0]), rel=1e-13)


def test_a_crank_program_has_a_piece_for_each_range() -> None:
    run = CrankMotion(driver_ranges_of(four_bar(70.0, 60.0, 30.0, 55.0).drive.mechanism))
    degrees = run.degrees(360)
    assert 0 < degrees.size < 360
    assert run.is_assembled(np.deg2rad(degrees)).all()
    assert run.angles(np.deg2rad(degrees)).piece.max() == 1
    state = run.state(run.angles(np.array([1.0])))
    assert state.y[:, 0].tolist() == [1.0, 1.0, 0.0, 0.0]


STILL: dict[str, Callable[[], Design]] = {
    "four-bar": lambda: four_bar(100.0, 30.0, 90.0, 70.0),
    "slider": lambda: slider_crank(40.0, 140.0, 10.0),
}


@pytest.mark.parametrize("design", STILL)
def test_every_link_is_a_body_and_every_pair_joins_two(design: str) -> None:
    linkage = STILL[design]().drive.linkage
    driver_ranges = driver_ranges_of(linkage)
    run = CrankMotion(driver_ranges)
    kinematics = solve_mechanism(mechanism_of(linkage), run.state(run.angles(np.arange(6.0))), driver_ranges)
    assert list(kinematics.bodies) == [FRAME, "link2", "link3", "link4"]
    for pair in kinematics.pairs.values():
        assert {pair.on, pair.body} <= set(kinematics.bodies)
        assert np.abs(kinematics.bodies[pair.body].point(pair.point)[0]).max() < 1.0
    assert kinematics.output == "link2"
    assert kinematics.ground == "O2"
    assert [dyad.kind for dyad in kinematics.dyads] == (["RRR"] if design == "four-bar" else ["RRP"])
