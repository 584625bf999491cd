"""core.dynamics: against bodies cut free one by one, against energy, and against what a pencil finds for single loads."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from mechanisms import (
    ANGLES,
    LAYOUT_DESIGNS,
    LIFT,
    PUSHER,
    buildable,
    levels,
    mirrored,
    with_drive,
    with_follower,
    with_loads,
    with_shaft,
)
from references import (
    EPS,
    MP,
    Jammed,
    Series,
    Solved,
    cam_shape,
    free_bodies,
    gravity_of,
    masses,
    off,
    placed,
    sensitivity,
    solved,
    speed_of,
    torque_by_energy,
)
from sampled import spread
from scipy.optimize import minimize_scalar

from core.design import Design
from core.dynamics import (
    Friction,
    Inertia,
    combined_inertia,
    guide_reaction,
    loading_of,
    momentum_residual,
    newton_euler,
    power_residual,
    with_infinities,
)
from core.dynamics.forces import Contact
from core.errors import NoSolution
from core.findings import ERROR, NOTE
from core.study import Study, certificate_of, findings_of

DESIGNS = {**LAYOUT_DESIGNS, "lift": LIFT, "pusher": PUSHER}
TURNED = {f"{name} turned round": with_shaft(d, rotation="cw" if d.shaft.rotation == "ccw" else "ccw")
          for name, d in DESIGNS.items() if name in ("c", "lift", "pusher")}  # fmt: skip
ALL = {**DESIGNS, **TURNED}

# 34 of positions and accelerations, 22 of the normal (test_linkage, test_cam), and on the way through rod, slider and
# arm to the torque about 6 in each of 5 sums.
ROUNDINGS = 34 + 22 + 30
LOADED = ("follower", "cam", "shaft", "loads")
NAMES = {True: ("slider_pin", "arm_pin", "pivot", "guide", "bearing", "normal", "contact", "torque", "follower_torque"),
         False: ("guide", "bearing", "normal", "contact", "torque", "follower_torque")}  # fmt: skip


def at(study: Study, there: Study) -> Solved:
    y = map(float, there.motion.y[:, 0])
    return placed(study.design, float(there.theta[0]), Series([v / math.factorial(k) for k, v in enumerate(y)]))


def computed(study: Study) -> dict[str, Any]:
    f = study.dynamics
    return {
        **f.pairs,
        "normal": f.guide.normal,
        "contact": f.contact,
        "torque": f.torque,
        "follower_torque": f.follower_torque,
    }


def check_forces(design: Design, theta: float) -> None:
    there = Study(design).at_theta(np.array([theta]))
    way = int(there.motion.velocity_sign[0])
    names = NAMES["arm" in there.linkage.bodies]

    def reactions(design: Design, solved: Solved) -> list[object]:
        told = free_bodies(design, solved, way)
        return [told[name] for name in names]

    exact, size = sensitivity(reactions, design, theta, there.motion.y[:, 0], LOADED)
    got = computed(there)
    sizes = {name: reach + float(abs(reference)) for name, reference, reach in zip(names, exact, size, strict=True)}
    # a pin that bears nothing has the rounding of the forces beside it
    largest = max(
        (float(abs(reference)) for name, reference in zip(names, exact, strict=True) if "torque" not in name),
        default=0.0,
    )
    sizes |= {name: size + 6 * largest / ROUNDINGS for name, size in sizes.items() if "torque" not in name}
    # a lever that vanishes in a dwell leaves the rounding of the product it is taken from
    sizes["torque"] += float(abs(exact[names.index("contact")])) * abs(there.cam.reference[0])
    for name, reference in zip(names, exact, strict=True):
        assert off(complex(got[name][0]), reference) <= ROUNDINGS * EPS * sizes[name], name


PLACES = [(name, theta) for name in ALL for theta in (0.3, 1.5, 4.3) if name in ("c", "pusher") or theta == 1.5]
"""A rise or return of each layout; a dwell and another of two of them."""


@pytest.mark.parametrize(("name", "theta"), spread(PLACES, 2))
def test_every_reaction_is_that_of_bodies_cut_free(name: str, theta: float) -> None:
    check_forces(ALL[name], theta)


@settings(max_examples=8)
@given(buildable(), ANGLES)
def test_every_reaction_of_any_mechanism_is_that_of_bodies_cut_free(design: Design, theta: float) -> None:
    jam = float(Study(design).at_theta(np.array([theta])).dynamics.guide.jam[0])
    assume(jam < 0.9)
    check_forces(design, theta)


@pytest.mark.parametrize("name", ALL)
def test_the_torque_is_what_the_energy_asks_for(name: str) -> None:
    """T_c = d(KE + PE)/dθ - F y' + μ|N||y'|, the energies differentiated at fifty digits."""
    design = ALL[name]
    study = Study(design, 3600)
    peak = np.abs(study.dynamics.torque).max()
    for theta in (0.9, 1.5, 2.0, 2.9, 4.4, 5.2):
        there = study.at_theta(np.array([theta]))
        wanted = torque_by_energy(design, at(study, there), there.dynamics.guide.normal[0])
        # relative to the peak: conditions of position, velocity and acceleration, of which a torque is made
        bound = ROUNDINGS * EPS * float(study.linkage.condition.max()) * peak
        assert off(float(there.dynamics.torque[0]), wanted) <= bound


# -- balances ---------------------------------------------------------------------------------------------


STILL = with_drive(with_follower(PUSHER, direction_deg=33.0), motion=levels(3.0, (360.0, 3.0, "dwell")))


@settings(max_examples=30)
@given(buildable())
@example(STILL)
@example(with_drive(LIFT, motion=levels(3.0, (100.0, 3.0, "dwell"), (260.0, 3.0, "dwell"))))
@example(with_drive(PUSHER, motion=levels(0.0, (180.0, 1e-4, "cycloidal"), (180.0, 0.0, "cycloidal"))))
def test_power_and_momentum_balance_to_a_millionth_of_a_millionth(design: Design) -> None:
    study = Study(design, 90)
    assume(study.dynamics.guide.jam.max() < 0.9)
    parts = (study.linkage, study.cam, study.dynamics, study.loading)
    assert power_residual(*parts).max() <= 1e-12
    assert momentum_residual(*parts).max() <= 1e-12
    proof = certificate_of(study, ("dynamics",))
    assert proof["power_balance"].kept
    assert proof["momentum_balance"].kept


@pytest.mark.parametrize(
    ("part", "by_power", "by_momentum"),
    [("torque", True, False), ("contact", False, True), ("guide", False, True), ("pivot", False, True)],
)
def test_the_balances_see_a_force_that_is_off_by_a_millionth(part: str, by_power: bool, by_momentum: bool) -> None:
    study = Study(LAYOUT_DESIGNS["c"], 90)
    f = study.dynamics
    if part == "torque":
        wrong = replace(f, torque=f.torque * (1 + 1e-6))
    elif part == "contact":
        (contact,) = f.contacts
        wrong = replace(
            f, contacts=(Contact(contact.at, contact.direction, contact.force * (1 + 1e-6), contact.lever),)
        )
    else:
        wrong = replace(f, pairs={**f.pairs, part: f.pairs[part] * (1 + 1e-6)})
    parts = (study.linkage, study.cam, wrong, study.loading)
    assert (power_residual(*parts).max() > 1e-8) == by_power
    assert (momentum_residual(*parts).max() > 1e-8) == by_momentum


@pytest.mark.parametrize("name", ["b", "g", "lift", "pusher"])
def test_the_balances_see_a_load_that_was_left_out(name: str) -> None:
    """Forces of one design held against the loads of another: each term is in the balance."""
    study = Study(DESIGNS[name], 90)
    loads = study.design.drive.loads
    changes: dict[str, float] = {"spring_rate_n_per_mm": 3.0, "gravity_m_s2": 9.0, "gravity_angle_deg": -80.0}
    if name == "pusher":
        changes |= {"follower_mass_kg": 1.6, "preload_n": 110.0}
    else:
        changes |= {
            "slider_mass_kg": loads.slider_mass_kg * 1.1,
            "rod_mass_kg": loads.rod_mass_kg * 1.1,
            "rod_inertia_kg_m2": loads.rod_inertia_kg_m2 * 1.1,
            "rod_centre": 0.45,
            "arm_mass_kg": loads.arm_mass_kg * 1.1,
            "arm_inertia_kg_m2": loads.arm_inertia_kg_m2 * 1.1,
            "arm_centre_mm": 70.0,
            "arm_centre_angle_deg": 26.0,
            "roller_mass_kg": 0.9,
            "roller_inertia_kg_m2": 6e-3,
            "external_force_n": -210.0,
        }
    for key, value in changes.items():
        still = name == "lift" and key in ("arm_mass_kg", "arm_centre_angle_deg")  # its arm's centre is the pivot
        if still and key == "arm_centre_angle_deg":
            continue
        other = loading_of(study.design.drive.mechanism, replace(loads, **{key: value}))
        parts = (study.linkage, study.cam, study.dynamics, other)
        assert (power_residual(*parts).max() > 1e-9) != still, key
        # the roller's inertia and others show in the moments too
        assert momentum_residual(*parts).max() > 1e-9, key


def test_the_kinetic_energy_is_that_of_the_single_bodies() -> None:
    for name in ("a", "f", "lift", "pusher"):
        design = DESIGNS[name]
        study = Study(design, 36)
        energy = 0.5 * study.omega**2 * study.loading.inertia(study.linkage)[0]
        for i in (3, 14, 29):
            here = solved(design, study.theta[i])
            total = MP.zero
            for m in masses(design, here).values():
                v = abs(m.centre.derivative(1)) * speed_of(design)
                total += m.mass * v**2 / 2 + m.inertia * (m.angle.derivative(1) * speed_of(design)) ** 2 / 2
            assert off(energy[i], total) <= 64 * EPS * float(study.linkage.condition.max()) ** 2 * energy.max()


def test_masses_on_one_body_combine_about_their_common_centre() -> None:
    """Two discs and a point, against the definition: sum of m |r - c|² and of the discs' own inertia."""
    parts = [Inertia(2.0, 0.3 + 0.1j, 0.05), Inertia(3.0, -0.2 + 0.4j, 0.02), Inertia(0.5, 1.0 - 1.0j)]
    one = combined_inertia(parts)
    mass = 5.5
    centre = (2.0 * (0.3 + 0.1j) + 3.0 * (-0.2 + 0.4j) + 0.5 * (1 - 1j)) / mass
    about = 0.07 + sum(p.mass * abs(p.centre - centre) ** 2 for p in parts)
    assert one.mass == mass
    assert one.centre == pytest.approx(centre, rel=4 * EPS)
    assert one.about_centre == pytest.approx(about, rel=8 * EPS)
    assert combined_inertia([Inertia(0.0, 0.0, 0.4), Inertia(0.0)]) == Inertia(0.0, 0j, 0.4)


# -- single loads -----------------------------------------------------------------------------------------

NOTHING = {"slider_mass_kg": 0.0, "rod_mass_kg": 0.0, "rod_inertia_kg_m2": 0.0, "arm_mass_kg": 0.0, "arm_inertia_kg_m2": 0.0,
           "roller_mass_kg": 0.0, "roller_inertia_kg_m2": 0.0, "friction": 0.0, "external_force_n": 0.0,
           "spring_rate_n_per_mm": 0.0}  # fmt: skip
LINEAR = [key for key in NOTHING if key != "friction"]


@pytest.mark.parametrize("name", ["a", "d", "h", "lift"])
def test_without_friction_the_loads_add_up(name: str) -> None:
    """Each mass, inertia and force alone; what they give together is the sum."""
    design = with_loads(DESIGNS[name], friction=0.0)
    whole = computed(Study(design, 72))
    total = {key: np.zeros_like(value) for key, value in whole.items()}
    size = dict.fromkeys(whole, 0.0)
    for key in LINEAR:
        alone = with_loads(design, **{**NOTHING, key: getattr(design.drive.loads, key)})
        for force, value in computed(Study(alone, 72)).items():
            total[force] = total[force] + value
            size[force] += np.abs(value).max()
    for force, value in whole.items():
        assert np.abs(total[force] - value).max() <= 4 * len(LINEAR) * EPS * size[force] * 8, force
        assert np.abs(value).max() > 0.0


@pytest.mark.parametrize("name", ["a", "d", "h", "lift", "pusher"])
def test_inertia_alone_grows_with_the_square_of_the_speed(name: str) -> None:
    design = with_loads(
        DESIGNS[name],
        friction=0.0,
        gravity_m_s2=0.0,
        spring_rate_n_per_mm=0.0,
        **({"preload_n": 0.0} if name == "pusher" else {"external_force_n": 0.0}),
    )
    slow, fast = (computed(Study(with_shaft(design, speed_rpm=n), 72)) for n in (50.0, 150.0))
    for key, value in slow.items():
        assert np.abs(fast[key] - 9.0 * value).max() <= 256 * EPS * np.abs(value).max() * 9.0, key


@pytest.mark.parametrize("name", ALL)
def test_standing_still_the_torque_is_that_of_virtual_work(name: str) -> None:
    """At a millionth of a revolution per minute nothing is left but weight, spring and external force."""
    design = with_loads(with_shaft(ALL[name], speed_rpm=1e-6), friction=0.0)
    study = Study(design, 36)
    g = gravity_of(design)
    peak = np.abs(study.dynamics.torque).max()
    for i in (5, 9, 17, 28):
        here = solved(design, study.theta[i])
        work = MP.zero
        for m in masses(design, here).values():
            work -= m.mass * MP.re(MP.conj(g) * m.centre.derivative(1))
        loads: Any = design.drive.loads
        pull = MP.mpf(getattr(loads, "external_force_n", -getattr(loads, "preload_n", 0.0)))
        work -= (pull - loads.spring_rate_n_per_mm * 1000 * here.y.c[0]) * here.y.derivative(1)
        # inertia: ω² of (1e-7 rad/s)², some 1e-14 of the weights
        assert (
            off(float(study.dynamics.torque[i]), work)
            <= (ROUNDINGS * EPS * float(study.linkage.condition.max()) + 1e-13) * peak
        )


def test_weight_alone_on_an_upright_follower() -> None:
    """Contact mg/cos ψ, guide mg tan ψ, torque mg s': with a pencil."""
    design = with_loads(
        with_follower(PUSHER, direction_deg=90.0), friction=0.0, spring_rate_n_per_mm=0.0, preload_n=0.0
    )
    study = Study(with_shaft(design, speed_rpm=1e-5), 72)
    f, psi = study.dynamics, study.cam.flank.pressure_angle
    weight = 1.5 * 9.80665
    assert f.contact == pytest.approx(weight / np.cos(psi), rel=1e-11)
    assert f.torque == pytest.approx(weight * study.motion.y[1], abs=1e-11 * weight * 0.02)
    assert np.abs(f.guide.normal) == pytest.approx(weight * np.tan(psi), abs=1e-11 * weight)
    assert np.abs(f.pairs["bearing"]) == pytest.approx(f.contact, rel=4 * EPS)
    assert (f.pairs["bearing"].imag > 0.0).all(), "the frame carries the camshaft"


def test_a_spring_alone_presses_on_the_cam_and_gives_back_what_it_takes() -> None:
    design = with_loads(PUSHER, friction=0.0, gravity_m_s2=0.0, follower_mass_kg=0.0)
    study = Study(design, 72)
    force = 120.0 + 4e3 * study.motion.y[0]
    assert study.dynamics.contact * np.cos(study.cam.flank.pressure_angle) == pytest.approx(force, rel=32 * EPS)
    assert study.dynamics.torque == pytest.approx(force * study.motion.y[1], abs=32 * EPS * 200.0 * 0.05)


def test_a_cylinder_that_pulls_the_lifts_slider_back_keeps_its_sign() -> None:
    """-20 kN along the guide on a slider that does not move: the rod holds +20 kN against it."""
    study = Study(with_loads(LIFT, **{**NOTHING, "external_force_n": -20000.0}), 36)
    pin = study.dynamics.pairs["slider_pin"]
    assert pin.real == pytest.approx(20000.0, rel=8 * EPS)
    beta = study.linkage.coordinates["beta"][0]
    assert pin.imag == pytest.approx(20000.0 * np.tan(beta), abs=1e-11 * 20000.0), "along the rod"
    assert study.dynamics.guide.normal == pytest.approx(-20000.0 * np.tan(beta), abs=1e-11 * 20000.0)
    assert study.dynamics.torque == pytest.approx(20000.0 * study.motion.y[1], abs=1e-11 * 20000.0 * 0.4)
    spring = Study(with_loads(LIFT, **{**NOTHING, "spring_rate_n_per_mm": 2.0}), 36)
    assert spring.dynamics.pairs["slider_pin"].real == pytest.approx(2000.0 * spring.motion.y[0], abs=1e-9)


# -- friction ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rotation", ["ccw", "cw"])
@pytest.mark.parametrize("friction", [0.0, 0.12, 0.9])
def test_friction_adds_on_the_rise_and_helps_on_the_return(friction: float, rotation: str) -> None:
    """In-line follower with weightless parts: spring/(cos ψ - μ sin ψ) going up, spring/(cos ψ + μ sin ψ) coming down."""
    design = with_loads(with_follower(PUSHER, offset_mm=0.0), friction=friction, follower_mass_kg=0.0)
    study = Study(with_shaft(design, rotation=rotation), 360)
    psi, way = study.cam.flank.pressure_angle, study.motion.velocity_sign
    force = 120.0 + 4e3 * study.motion.y[0]
    contact = force / (np.cos(psi) - friction * way * np.sin(psi))
    assert study.dynamics.contact == pytest.approx(contact, rel=128 * EPS)
    assert np.abs(study.dynamics.guide.normal) == pytest.approx(contact * np.sin(psi), abs=128 * EPS * contact.max())
    assert study.dynamics.guide.friction == pytest.approx(
        -way * friction * contact * np.sin(psi), abs=128 * EPS * contact.max()
    )


@settings(max_examples=20)
@given(buildable())
def test_friction_never_gives_power_and_rests_in_a_dwell(design: Design) -> None:
    study = Study(design, 180)
    guide, way = study.dynamics.guide, study.motion.velocity_sign
    finite = np.isfinite(guide.normal)
    friction = design.drive.loads.friction
    assert (guide.friction[finite] * way[finite] <= 0.0).all()
    assert (guide.friction[way == 0.0] == 0.0).all()
    moving = finite & (way != 0.0)
    # a normal force that nearly vanishes has the rounding of the forces beside it
    size = np.abs(study.dynamics.contact[moving]).max(initial=1.0)
    expected = friction * np.abs(guide.normal[moving])
    assert np.abs(guide.friction[moving]) == pytest.approx(expected, rel=4 * EPS, abs=1e-11 * size)


def test_rounding_does_not_turn_friction_round_beside_a_dwell() -> None:
    """A millionth of a degree into the rise the velocity is 1e-24 of the peak, and its sign still that of the rise."""
    study = Study(LIFT)
    for join, way in ((35.0, -1.0), (76.5, -1.0), (283.5, 1.0), (325.0, 1.0)):
        inside = 1.0 if join in (35.0, 283.5) else -1.0
        angles = np.deg2rad(join + inside * np.array([1e-9, 1e-7, 1e-5, 1e-3]))
        there = study.at_theta(angles)
        assert (there.motion.velocity_sign == way).all()
        assert (np.sign(there.dynamics.guide.friction) == -way).all()
        beside = study.at_theta(np.deg2rad(join - inside * np.array([1e-9, 1e-5])))
        assert (beside.dynamics.guide.friction == 0.0).all()


def test_several_pairs_that_rub_are_solved_together() -> None:
    """A pin that rubs without friction leaves the guide's closed form; one with friction takes power, and all balances."""
    study = Study(with_loads(LIFT, friction=0.2), 360)
    parts = (study.linkage, study.cam)
    for coefficient in (0.0, 0.3):
        loading = replace(study.loading, frictions=(*study.loading.frictions, Friction("arm_pin", coefficient, 0.02)))
        forces = newton_euler(*parts, loading, study.omega)
        assert power_residual(*parts, forces, loading).max() <= 1e-12
        assert momentum_residual(*parts, forces, loading).max() <= 1e-12
        more = forces.friction_power - study.dynamics.friction_power
        if coefficient:
            size = np.abs(forces.pairs["arm_pin"])
            assert (
                np.abs(np.abs(forces.couples["arm_pin"]) - 0.006 * size * np.abs(study.motion.velocity_sign)).max()
                <= 1e-12 * size.max()
            )
            assert more.min() >= 0.0
        else:
            assert np.abs(more).max() <= 1e-12 * np.abs(forces.friction_power).max()
            assert forces.contact == pytest.approx(study.dynamics.contact, rel=1e-12)


@pytest.mark.parametrize("n0", [-3.0, 5.0, 0.0])
@pytest.mark.parametrize("way", [-1.0, 0.0, 1.0])
@pytest.mark.parametrize("slope", [-4.0, -0.5, 0.0, 0.5, 4.0])
@pytest.mark.parametrize("coefficient", [0.0, 0.1, 0.2499, 0.2501, 1.9])
def test_the_guide_solves_its_equation_or_jams(n0: float, way: float, slope: float, coefficient: float) -> None:
    """N + μ sgn(L̇) slope |N| = N0, by trying both signs of N."""
    solved_ = guide_reaction(np.array([n0]), np.array([way]), np.array([slope]), coefficient)
    normal = float(with_infinities(solved_.normal)[0])
    factor = coefficient * way * slope
    answers = [
        n0 / (1 + sign * factor) for sign in (1, -1) if 1 + sign * factor and sign * n0 / (1 + sign * factor) > 0
    ]
    if n0 == 0.0:
        assert normal == 0.0
    elif not answers:
        assert math.isinf(normal)
        assert math.copysign(1.0, normal) == math.copysign(1.0, n0)
    else:
        assert min(abs(normal - a) for a in answers) <= 4 * EPS * abs(normal)
        assert normal * n0 > 0.0
        assert normal + factor * abs(normal) == pytest.approx(n0, rel=8 * EPS * (1 + abs(factor)))
    assert float(solved_.jam[0]) == pytest.approx(abs(coefficient * slope), rel=EPS)


def _slope(design: Design, theta: float) -> float:
    """Slope of the guide's equation at fifty digits: tan β, or the tangent of the pressure angle."""
    here = solved(design, theta)
    if "beta" in here.angles:
        return float(abs(MP.tan(here.angles["beta"].c[0])))
    return float(MP.tan(cam_shape(design, here).pressure_angle))


def _steepest(design: Design) -> float:
    """The largest of them over the turn."""
    grid = np.linspace(0.0, 2 * math.pi, 181)[:-1]
    best = max(grid, key=lambda theta: _slope(design, theta))
    found = minimize_scalar(
        lambda theta: -_slope(design, theta),
        bounds=(best - 0.04, best + 0.04),
        method="bounded",
        options={"xatol": 1e-10},
    )
    return -float(found.fun)


@pytest.mark.parametrize("name", spread(["c", "lift", "pusher"], 1))
def test_jamming_is_told_from_the_limit_on_and_not_before(name: str) -> None:
    design = DESIGNS[name]
    worst = _steepest(design)
    for factor, told in ((1 - 1e-9, False), (1 + 1e-9, True)):
        study = Study(with_loads(design, friction=factor / worst))
        found = [f for f in findings_of(study, ("dynamics",)) if f.code == "jamming"]
        assert bool(found) == told, factor
        for f in found:
            assert (f.severity, f.field) == (ERROR, "loads.friction")
            assert f.values["factor"] == pytest.approx(factor, rel=1e-11)
            assert _slope(design, math.radians(f.cam_angle_deg)) == pytest.approx(worst, rel=1e-11), "and it is there"


def test_where_the_guide_jams_the_forces_are_infinite_and_no_motor_torque_exists() -> None:
    """μ tan ψ passes 1 on the rise: there is no answer there, and there is one everywhere else."""
    design = with_loads(with_follower(PUSHER, offset_mm=0.0), friction=3.5, follower_mass_kg=0.0)
    study = Study(design, 720)
    rises = study.motion.velocity_sign > 0
    jams = rises & (3.5 * np.tan(study.cam.flank.pressure_angle) >= 1.0)
    assert jams.any()
    assert (np.isinf(study.dynamics.contact) == jams).all()
    assert (study.dynamics.contact[jams] > 0.0).all()
    assert np.isfinite(study.dynamics.torque[~jams]).all()
    assert not np.isfinite(study.dynamics.torque[jams]).any()
    with pytest.raises(NoSolution) as caught:
        _ = study.flywheel
    ((worst, same),) = caught.value.cam_angles
    assert worst == same
    assert np.tan(study.at_theta(np.array([np.deg2rad(worst)])).cam.flank.pressure_angle[0]) == pytest.approx(
        np.tan(study.cam.flank.pressure_angle).max(), rel=1e-4
    )
    there = study.at_theta(np.array([study.theta[jams][0]]))
    with pytest.raises(Jammed):
        free_bodies(design, at(study, there), 1)
    assert "jamming" in [f.code for f in findings_of(study)]


def test_a_rod_that_jams_its_slider_makes_every_force_on_its_way_infinite() -> None:
    study = Study(with_loads(LAYOUT_DESIGNS["b"], friction=5.0), 720)
    lost = ~np.isfinite(study.dynamics.contact)
    tau = 5.0 * np.abs(np.tan(study.linkage.coordinates["beta"][0]))
    assert lost.any()
    assert (tau[lost] >= 1.0).all()
    assert (study.motion.velocity_sign[lost] != 0.0).all()
    worst = [f for f in findings_of(study) if f.code == "jamming"]
    assert worst[0].values["factor"] == pytest.approx(tau.max(), rel=1e-4)


# -- separation and nothing at all ------------------------------------------------------------------------


def test_separation_is_told_from_the_speed_on_where_the_spring_no_longer_follows() -> None:
    """The limit by a pencil: where m ω² y'' + k y + P + mg touches zero, which also is where its derivative does."""
    design = with_loads(PUSHER, friction=0.0, gravity_angle_deg=-110.0)  # straight along the follower
    spring, given, weight = 4e3, 120.0, 1.5 * MP.mpf("9.80665")
    # the end of the cycloidal rise of 20 mm in 100 degrees from 60 on brakes hardest, the 3-4-5 return being longer

    def spare(theta: object) -> list[object]:
        y = solved(design, theta, 1).y
        held = spring * y.c[0] + given + weight
        return [-held / (1.5 * y.derivative(2)), spring * y.derivative(1) * y.derivative(2) - held * y.derivative(3)]

    worst = MP.findroot(lambda t: spare(t)[1], (math.radians(130.0), math.radians(140.0)), tol=1e-30)
    limit = MP.sqrt(spare(worst)[0])
    assert 100.0 < math.degrees(worst) < 160.0
    for factor, told in ((1 - 1e-9, False), (1 + 1e-9, True)):
        study = Study(with_shaft(design, speed_rpm=float(factor * limit * 30 / MP.pi)))
        found = [f for f in findings_of(study, ("dynamics",)) if f.code == "separation"]
        assert bool(found) == told
        for f in found:
            assert (f.severity, f.field) == (ERROR, "loads")
            assert f.cam_angle_deg == pytest.approx(math.degrees(worst), abs=1e-3)  # flat: 1e-9 of it is 3e-5 wide
            assert -1e-6 < f.values["force_n"] <= 0.0


def test_a_design_without_loads_says_so_and_has_no_forces() -> None:
    for design in (
        with_loads(LIFT, **NOTHING),
        with_loads(PUSHER, follower_mass_kg=0.0, spring_rate_n_per_mm=0.0, preload_n=0.0),
    ):
        study = Study(design, 36)
        (found,) = findings_of(study, ("dynamics",))
        assert (found.code, found.severity, found.cam_angle_deg) == ("no-load", NOTE, None)
        assert all(np.abs(value).max() == 0.0 for value in computed(study).values())
        assert study.flywheel.energy_swing == 0.0
    weight = with_loads(LIFT, **{**NOTHING, "roller_inertia_kg_m2": 1e-9})
    assert "no-load" not in [f.code for f in findings_of(Study(weight, 36), ("dynamics",))]


# -- mirrors ----------------------------------------------------------------------------------------------


@settings(max_examples=13)
@given(buildable())
def test_any_mirrored_design_has_the_forces_of_the_mirror_image(design: Design) -> None:
    one, other = Study(design, 24), Study(mirrored(design), 24)
    assume(one.dynamics.guide.jam.max() < 0.9)
    a, b = computed(one), computed(other)
    t = one.cam.relative_velocity
    bend = float(one.linkage.condition.max()) * float(np.abs(one.cam.reference).max() / np.abs(t).min())
    lever = float(1.0 / np.abs(np.cos(one.cam.flank.pressure_angle)).min())
    for key in a:
        # what the body on the cam turns by is counted counter-clockwise, the motor's torque with the cam's sense, the
        # slider's guide force along guide + 90 deg, which a mirror keeps for it and turns round for the follower
        arm = "arm" in one.linkage.bodies
        image = {"contact": 1, "torque": 1, "normal": 1 if arm else -1, "follower_torque": -1 if arm else 1}
        expected = image[key] * a[key] if key in image else -a[key].conjugate()
        size = max(np.abs(v).max() for v in a.values() if v.dtype == a[key].dtype)
        assert np.abs(expected - b[key]).max() <= 4 * ROUNDINGS * EPS * bend**2 * lever * size, key


def test_turning_the_whole_machine_turns_its_forces() -> None:
    turned = with_loads(with_follower(PUSHER, direction_deg=130.0), gravity_angle_deg=-30.0)
    a, b = computed(Study(PUSHER, 72)), computed(Study(turned, 72))
    by = np.exp(1j * math.radians(60.0))
    for key in ("guide", "bearing"):
        assert np.abs(a[key] * by - b[key]).max() <= 128 * EPS * np.abs(a[key]).max()
    for key in ("contact", "torque", "normal", "follower_torque"):
        assert np.abs(a[key] - b[key]).max() <= 128 * EPS * np.abs(a[key]).max()


def test_moving_a_mass_to_the_pivot_takes_its_moment_away() -> None:
    """An arm whose centre of mass is the pivot puts its weight on the pivot and nothing on the cam."""
    light = with_loads(LIFT, arm_mass_kg=0.0)
    a, b = Study(LIFT, 36).dynamics, Study(light, 36).dynamics
    assert a.contact == pytest.approx(b.contact, rel=64 * EPS)
    difference = a.pairs["pivot"] - b.pairs["pivot"]
    assert difference == pytest.approx(np.full(36, 664.0 * 9.80665j), abs=64 * EPS * np.abs(a.pairs["pivot"]).max())
