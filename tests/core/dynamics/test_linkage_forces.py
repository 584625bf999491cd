"""core.dynamics of linkages: every reaction against the multipliers of the loop equations, and against balances."""

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from linkages import INSIDE_OUT, SLIDING_GROUP, assemblies, four_bar, jacobian, lift_twice, slider_crank
from sampled import spread

from core.__main__ import main
from core.design import (
    Design,
    Drive,
    Driver,
    ElasticShaft,
    LinkageLoads,
    LinkForce,
    LinkMass,
    Motion,
    NamedCurve,
    Segment,
    with_drive,
)
from core.dynamics import link_loading, momentum_residual, newton_euler, power_residual
from core.mechanism import body_name, driver_ranges_of, unit_speed_kinematics
from core.mechanism.kinematics import FRAME, REVOLUTE, Kinematics
from core.project import load, save
from core.study import Study, certificate_of, findings_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
OMEGA = 7.0


def loaded(design: Design, seed: int) -> Design:
    """Every link with mass, and forces and torques on all."""
    rng = np.random.default_rng(seed)
    moving = sorted(n for n in design.drive.mechanism.by_number if n != 1)
    masses = tuple(
        LinkMass(link=n, mass_kg=float(m), inertia_kg_m2=float(i), centre_x_mm=float(x), centre_y_mm=float(y))
        for n, (m, i, x, y) in zip(
            moving, rng.uniform([0.1, 1e-4, -50, -50], [3.0, 1e-2, 50, 50], (len(moving), 4)), strict=True
        )
    )
    forces = tuple(
        LinkForce(
            link=n,
            point=design.drive.mechanism.by_number[n].points[0].name,
            x_n=float(x),
            y_n=float(y),
            torque_nm=float(t),
        )
        for n, (x, y, t) in zip(moving, rng.uniform(-100.0, 100.0, (len(moving), 3)) * [1.0, 1.0, 0.1], strict=True)
        if design.drive.mechanism.by_number[n].points
    )
    return with_drive(design, loads=LinkageLoads(masses=masses, forces=forces, gravity_angle_deg=-70.0))


def multipliers(design: Design, kinematics: Kinematics, q: float) -> np.ndarray:
    """λ of J'λ = -Q, lengths in mm: the loop equations' own reactions, the driver's row last."""
    numbers = sorted(n for n in design.drive.mechanism.by_number if n != 1)
    poses = [kinematics.bodies[body_name(n)] for n in numbers]
    x = np.array([v for p in poses for v in (p.x[0, 0] * 1e3, p.y[0, 0] * 1e3, p.angle[0, 0])])
    load_on = np.zeros(x.size)
    gravity = 9.80665 * complex(math.cos(math.radians(-70.0)), math.sin(math.radians(-70.0)))
    for mass in design.drive.loads.masses:
        i, pose = numbers.index(mass.link), kinematics.bodies[body_name(mass.link)]
        arm = complex(mass.centre_x_mm, mass.centre_y_mm) * np.exp(1j * pose.angle[0, 0])
        spin = pose.angle[:, 0] * OMEGA ** np.arange(4)
        acceleration = pose.z[2, 0] * OMEGA**2 + (1j * spin[2] - spin[1] ** 2) * arm * 1e-3
        force = mass.mass_kg * (gravity - acceleration)
        moment = (arm.conjugate() * force).imag - mass.inertia_kg_m2 * spin[2] * 1e3
        load_on[3 * i : 3 * i + 3] += (force.real, force.imag, moment)
    for each in design.drive.loads.forces:
        i, pose = numbers.index(each.link), kinematics.bodies[body_name(each.link)]
        arm = (pose.point(each.point)[0, 0] - pose.z[0, 0]) * 1e3
        force = complex(each.x_n, each.y_n)
        load_on[3 * i : 3 * i + 3] += (force.real, force.imag, (arm.conjugate() * force).imag + each.torque_nm * 1e3)
    return np.linalg.solve(jacobian(design, q, x).T, -load_on)


def check_against_multipliers(design: Design, kinematics: Kinematics, q: float, bound: float) -> None:
    forces = newton_euler(kinematics, None, link_loading(design.drive.loads), OMEGA)
    found = multipliers(design, kinematics, q)
    scale = np.abs(found).max()
    row = 0
    where: dict[str, list[int]] = {}
    for link in design.drive.mechanism.links:
        for place in link.points:
            where.setdefault(place.name, []).append(link.number)
    for name, links in where.items():
        for one, other in pairwise(links):
            pair = kinematics.pairs[name]
            sign = 1.0 if pair.body == body_name(other) else -1.0
            assert {pair.on, pair.body} == {body_name(one), body_name(other)}
            force = sign * complex(found[row], found[row + 1])
            assert abs(forces.pairs[name][0] - force) <= bound * scale, name
            row += 2
    for slider in design.drive.mechanism.sliders:
        pair = kinematics.pairs[str(slider.link)]
        line = kinematics.bodies[body_name(slider.link)]
        sign = 1.0 if pair.body == body_name(slider.link) else -1.0
        normal = 1j * np.exp(1j * line.angle[0, 0]) * found[row]
        assert abs(forces.pairs[str(slider.link)][0] - sign * normal) <= bound * scale
        if sign > 0.0:
            assert abs(forces.couples[str(slider.link)][0] * 1e3 - found[row + 1]) <= bound * scale
        row += 2
    assert abs(forces.driver[0] * 1e3 - found[row]) <= bound * scale


@settings(max_examples=15, derandomize=True, database=None)
@given(assemblies(), st.integers(0, 1000))
def test_every_reaction_is_a_multiplier_of_the_loop_equations(drawn: tuple[Design, float], seed: int) -> None:
    design, q = drawn
    design = loaded(design, seed)
    kinematics = unit_speed_kinematics(design.drive.mechanism, np.array([q]), driver_ranges_of(design.drive.mechanism))
    check_against_multipliers(design, kinematics, q, 1e-10)


@pytest.mark.parametrize("design", spread([INSIDE_OUT, SLIDING_GROUP], 1), ids=lambda design: design.name)
def test_a_groups_reactions_too(design: Design) -> None:
    design = loaded(design, 1)
    driver_ranges = driver_ranges_of(design.drive.mechanism)
    for q in np.linspace(driver_ranges.ranges[0].low + 0.3, driver_ranges.ranges[0].high - 0.3, 2):
        check_against_multipliers(
            design, unit_speed_kinematics(design.drive.mechanism, np.array([q]), driver_ranges), float(q), 1e-9
        )


@settings(max_examples=13, derandomize=True, database=None)
@given(assemblies(most=3), st.integers(0, 1000))
def test_power_and_momentum_balance(drawn: tuple[Design, float], seed: int) -> None:
    design, q = drawn
    design = loaded(design, seed)
    kinematics = unit_speed_kinematics(design.drive.mechanism, np.array([q]), driver_ranges_of(design.drive.mechanism))
    loading = link_loading(design.drive.loads)
    forces = newton_euler(kinematics, None, loading, -OMEGA)
    assert power_residual(kinematics, None, forces, loading).max() <= 1e-11
    assert momentum_residual(kinematics, None, forces, loading).max() <= 1e-11


def test_a_balance_sees_a_wrong_torque_and_a_wrong_pin() -> None:
    design = loaded(four_bar(100.0, 30.0, 90.0, 70.0), 3)
    kinematics = unit_speed_kinematics(
        design.drive.mechanism, np.linspace(0.0, 6.0, 20), driver_ranges_of(design.drive.mechanism)
    )
    loading = link_loading(design.drive.loads)
    forces = newton_euler(kinematics, None, loading, OMEGA)
    wrong = replace(forces, driver=forces.driver * 1.001)
    assert power_residual(kinematics, None, wrong, loading).max() > 1e-5
    pins = {**forces.pairs, "O4": forces.pairs["O4"] + 0.1}
    assert momentum_residual(kinematics, None, replace(forces, pairs=pins), loading).max() > 1e-5
    assert power_residual(kinematics, None, replace(forces, pairs=pins), loading).max() < 1e-12, (
        "which power cannot see"
    )


def test_a_press_at_rest_holds_its_force_by_the_lever() -> None:
    """Slider-crank at right angles, no masses: torque = F r, guide force = F tan of the rod's slope."""
    crank, rod, push = 40.0, 140.0, 300.0
    design = slider_crank(crank, rod)
    loads = LinkageLoads(gravity_m_s2=0.0, forces=(LinkForce(link=4, point="B", x_n=-push),))
    kinematics = unit_speed_kinematics(
        design.drive.mechanism, np.array([0.5 * math.pi]), driver_ranges_of(design.drive.mechanism)
    )
    forces = newton_euler(kinematics, None, link_loading(loads), 1e-9)
    slope = crank / math.sqrt(rod**2 - crank**2)
    assert kinematics.bodies["link4"].x[1, 0] < 0.0, "the slider goes back, the force helps, the crank must be held"
    assert forces.driver[0] == pytest.approx(-push * crank * 1e-3, rel=1e-14)
    assert abs(forces.pairs["4"][0]) == pytest.approx(push * slope, rel=1e-13)
    assert abs(forces.pairs["B"][0]) == pytest.approx(push * math.hypot(1.0, slope), rel=1e-13)
    assert forces.couples["4"][0] == pytest.approx(0.0, abs=1e-13)


# -- with a cam -------------------------------------------------------------------------------------------


def coupler_cam() -> Design:
    design = load(EXAMPLES / "four_bar_coupler_cam.toml")
    assert design.drive.is_linkage
    return design


def test_the_cam_takes_the_place_of_the_driver() -> None:
    """Power: T_c ω = F_c·(roller's way) = what the driver alone would give; reactions balance with the roller's force."""
    design = coupler_cam()
    study = Study(design, 360)
    assert study.design.drive.is_linkage
    forces, kinematics = study.dynamics, study.linkage
    assert np.abs(forces.driver).max() == 0.0
    alone = newton_euler(kinematics, None, study.loading, study.omega)
    driver = alone.driver * kinematics.motion.y[1]
    assert np.abs(driver - forces.torque).max() <= 1e-12 * np.abs(forces.torque).max()
    for name in ("power_balance", "momentum_balance"):
        residual = certificate_of(study)[name]
        assert residual.value <= residual.bound <= 1e-10
    dwell = kinematics.motion.y[1] == 0.0
    assert (forces.contact[dwell] > 100.0).all(), "known in a dwell too, where nothing moves"


def test_the_roller_leaves_the_cam_where_its_force_turns_negative() -> None:
    design = coupler_cam()
    lifted = with_drive(design, loads=replace(design.drive.loads, forces=(LinkForce(link=4, point="D", y_n=150.0),)))
    found = findings_of(Study(lifted, 36), ("dynamics",))
    assert [(f.code, f.severity) for f in found] == [("separation", "error")]
    assert found[0].values["force_n"] < 0.0


def test_the_lift_as_a_linkage_has_the_lifts_forces() -> None:
    """The same masses, no friction: contact force, torque and pins of the cam slider."""
    theirs, ours = (Study(each, 720).dynamics for each in lift_twice())
    for one, other in (
        (ours.contact, theirs.contact),
        (ours.torque, theirs.torque),
        (ours.pairs["P"], theirs.pairs["pivot"]),
        (ours.pairs["2"], theirs.pairs["guide"]),
    ):
        assert np.abs(one - other).max() <= 1e-11 * np.abs(other).max()


@pytest.mark.stress
def test_the_lift_as_a_linkage_has_the_lifts_motor_flywheel_and_stability() -> None:
    """On a shaft with a flywheel too small for it, which twists."""
    plain, linkage = lift_twice()
    shaft = replace(plain.shaft, flywheel_inertia_kg_m2=3000.0, elastic=ElasticShaft(1000.0, 5e4, 0.01))
    theirs, ours = (Study(replace(each, shaft=shaft), 720) for each in (plain, linkage))
    torque = theirs.flywheel.motor_torque(theirs.angles)
    assert np.abs(ours.flywheel.motor_torque(ours.angles) - torque).max() <= 1e-9 * np.abs(torque).max()
    assert ours.flywheel.needed_inertia == pytest.approx(theirs.flywheel.needed_inertia, rel=1e-9)
    assert ours.flywheel.fluctuation == pytest.approx(theirs.flywheel.fluctuation, rel=1e-9)
    one, other = ours.flexible_shaft(), theirs.flexible_shaft()
    edges = [[(band.n, band.eta_lo, band.eta_hi, band.growth) for band in each.bands] for each in (one, other)]
    assert len(edges[1]) > 3
    assert np.array(edges[0]) == pytest.approx(np.array(edges[1]), rel=1e-9)
    for mine, wanted in zip(one.own_verdicts, other.own_verdicts, strict=True):
        assert (mine.model, mine.state) == (wanted.model, wanted.state)
        assert mine.trace == pytest.approx(wanted.trace, rel=1e-9)


def test_stability_of_a_linkage_asks_for_its_cam_on_a_shaft(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["stability", str(EXAMPLES / "cam_slider_linkage.toml")]) == 2
    assert "no shaft turns a cam or a crank in this design; allowed: one with [shaft]" in capsys.readouterr().err


@pytest.mark.stress
def test_stability_of_a_linkage_is_answered_as_any_cams(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plain, linkage = lift_twice()
    path = tmp_path / "linkage.toml"
    save(replace(linkage, shaft=replace(plain.shaft, elastic=ElasticShaft(1000.0, 5e4, 0.01))), path)
    assert main(["stability", str(path)]) == 0
    assert "Forbidden speeds" in capsys.readouterr().out


def test_a_driver_that_slides_is_given_a_force() -> None:
    base = slider_crank(40.0, 140.0)
    motion = Motion(
        130.0, (Segment(180.0, 30.0, NamedCurve("cycloidal")), Segment(180.0, -30.0, NamedCurve("cycloidal"))), "mm"
    )
    linkage = replace(
        base.drive.linkage, driver=Driver(4, "motion", 60.0), branch=(replace(base.drive.linkage.branch[0], joint="A"),)
    )
    design = loaded(Design("pushed", None, (Drive(motion, linkage, None, LinkageLoads()),)), 5)
    study = Study(design, 90)
    assert study.design.drive.is_linkage
    forces = study.dynamics
    power = forces.driver * study.motion.y[1] * study.omega
    assert np.abs(power).max() > 1.0
    assert power_residual(study.linkage, None, forces, study.loading).max() < 1e-12
    assert certificate_of(study)["momentum_balance"].kept
    assert study.linkage.pairs["4"].kind != REVOLUTE
    assert FRAME in (study.linkage.pairs["4"].on, study.linkage.pairs["4"].body)
