"""core.stability: the periodic coefficients follow from energies, and the contact force from the same inverse dynamics."""

import numpy as np
import pytest
from mechanisms import LAYOUT_DESIGNS, LIFT, PUSHER, levels, with_drive, with_loads
from references import MP, masses, push_on_output, solved
from shafts import HARD, KIM, coefficients, kim_table, of, with_elastic

from core.design import Design
from core.errors import NoStability
from core.stability.coefficients import CENTRIPETAL, CURVATURE, INERTIA, LOAD, LOAD_SLOPE, is_dwell
from core.stability.panels import fit
from core.study import Study, certificate_of, extremes_of, findings_of

C, ANGLES = LAYOUT_DESIGNS["c"], (0.9, 2.5, 3.6)
TRAINS = {"pusher": PUSHER, "c": C, "f": LAYOUT_DESIGNS["f"], "lift": LIFT}


def energies(design: Design, theta: float) -> tuple[list[MP.mpf], list[MP.mpf]]:
    """J, J', J'' and V', V'' from the bodies' motions with fifty digits."""
    there = solved(design, theta)
    gravity = MP.convert(complex(Study(design, 4).loading.masses[0].gravity))
    j, height = MP.zero, MP.zero
    for body in masses(design, there).values():
        speed = body.centre.slope()
        j = (speed * speed.conjugate()).real * body.mass + body.angle.slope() ** 2 * body.inertia + j
        height = (body.centre * MP.conj(gravity)).real * body.mass + height
    y = there.y
    push, rate = push_on_output(design, y.c[0]), MP.convert(design.drive.loads.spring_rate_n_per_mm * 1e3)
    first = -height.derivative(1) - push * y.derivative(1)
    second = -height.derivative(2) - push * y.derivative(2) + rate * y.derivative(1) ** 2
    return [j.derivative(k) for k in range(3)], [first, second]


@pytest.mark.parametrize("theta", ANGLES)
@pytest.mark.parametrize("name", TRAINS)
def test_inertia_and_load_of_a_mechanism_are_those_of_its_bodies(name: str, theta: float) -> None:
    design = TRAINS[name]
    there = Study(design, 4).at_theta(np.array([theta]))
    j, v = energies(design, theta)
    whole = Study(design, 720)
    for values, exact, largest in (
        (there.loading.inertia(there.linkage), j, np.abs(whole.loading.inertia(whole.linkage)).max(axis=1)),
        (there.loading.potential(there.linkage), v, np.abs(whole.loading.potential(whole.linkage)).max(axis=1)),
    ):
        for value, wanted, most in zip(values[:, 0], exact, largest, strict=True):
            assert abs(value - float(wanted)) <= 1e-12 * most


@pytest.mark.parametrize("name", TRAINS)
def test_at_constant_speed_they_are_the_torque_of_the_cam(name: str) -> None:
    """T_c = ω² J'/2 + V', friction left out: found by energies here and dyad by dyad there."""
    study = Study(with_loads(TRAINS[name], friction=0.0), 360)
    _, slope, _ = study.loading.inertia(study.linkage)
    expected = 0.5 * study.omega**2 * slope + study.loading.potential(study.linkage)[0]
    torque = study.dynamics.torque
    assert np.abs(torque - expected).max() <= 1e-12 * np.abs(torque).max()


def test_a_translating_mass_is_kims_single_mass() -> None:
    """J = M X'², to the last bits, and with it C, κ and ψ of Kim1990 (13), (19)."""
    study = Study(KIM, 720)
    _, y1, y2, y3 = study.motion.y
    mass = KIM.drive.loads.follower_mass_kg
    assert np.array_equal(study.loading.inertia(study.linkage)[0], mass * (y1 * y1))
    expected = np.array([y1 * y1, y1 * y2, y2 * y2 + y1 * y3]) * mass * np.array([[1.0], [2.0], [2.0]])
    assert np.abs(study.loading.inertia(study.linkage) - expected).max() <= 1e-15 * np.abs(expected).max()
    found = coefficients(KIM)
    table = kim_table(found.panels.theta)
    assert np.abs(found.panels.values - table).max() <= 1e-12


@pytest.mark.parametrize("name", HARD)
def test_rows_are_each_others_derivatives_and_have_the_right_size(name: str) -> None:
    """d up to 1, C = d'/2, κ = C', ψ = U', by differentiating the polynomials."""
    panels = coefficients(HARD[name]).panels
    powers = np.moveaxis(panels.powers, 1, 0)
    count = powers.shape[-1]
    slope = powers[..., 1:] * np.arange(1, count) * (2.0 / panels.width)[:, None]
    t = np.linspace(-0.9, 0.9, 7)
    for function, derivative, factor in (
        (INERTIA, CENTRIPETAL, 0.5),
        (CENTRIPETAL, CURVATURE, 1.0),
        (LOAD, LOAD_SLOPE, 1.0),
    ):
        by_hand = factor * np.einsum("mk,kt->mt", slope[function], t ** np.arange(count - 1)[:, None])
        table = np.einsum("mk,kt->mt", powers[derivative], t ** np.arange(count)[:, None])
        assert np.abs(by_hand - table).max() <= 1e-9 * np.abs(table).max()
    largest = max(panels.values[INERTIA].max(), panels.at(panels.start, 1)[INERTIA].max())
    assert largest == pytest.approx(1.0, abs=1e-3)
    assert largest <= 1.0 + 1e-13
    assert panels.tail < 1e-12


def test_panels_cross_no_join_and_take_up_the_turn() -> None:
    for design in HARD.values():
        panels = coefficients(design).panels
        program = Study(design, 4).program
        assert np.allclose(panels.start + panels.width, np.append(panels.start[1:], 2.0 * np.pi), rtol=0.0, atol=1e-15)
        assert set(np.round(program.starts, 12)) <= set(np.round(panels.start, 12))
        assert (panels.width <= np.deg2rad(30.0) * (1.0 + 1e-12)).all()
    still_ones = is_dwell(coefficients(KIM).panels)
    assert still_ones.sum() * np.deg2rad(30.0) == pytest.approx(np.pi)


def test_a_function_that_is_steep_gets_short_panels() -> None:
    panels = fit(lambda angles: np.array([1.0 / (1.01 - np.cos(angles.theta))]), Study(KIM, 4).program, 1)
    assert panels.width.min() < np.deg2rad(8.0)
    theta = np.linspace(0.0, 6.28, 999)
    exact = 1.0 / (1.01 - np.cos(theta))
    assert np.abs(panels.at(theta, 1)[0] - exact).max() < 1e-11 * exact.max()
    finer = panels.split(np.full(panels.count, np.deg2rad(3.0)))
    assert finer.width.max() <= np.deg2rad(3.0) * (1.0 + 1e-9)
    assert np.abs(finer.at(theta, 1)[0] - exact).max() < 1e-11 * exact.max()


# -- scale and springs ------------------------------------------------------------------------------------


def test_neither_the_size_nor_the_place_of_the_stroke_matters() -> None:
    """X_m cancels, and so does where the follower stands at rest."""
    large = with_drive(
        KIM, motion=levels(4.0, (90.0, 94.0, "simple-harmonic"), (90.0, 4.0, "simple-harmonic"), (180.0, 4.0, "dwell"))
    )
    one, other = coefficients(KIM), coefficients(large)
    theta = np.linspace(0.001, 6.28, 500)
    assert np.abs(one.panels.at(theta, 5) - other.panels.at(theta, 5)).max() < 1e-11
    assert other.q == pytest.approx(100.0 * one.q, rel=1e-14)


def test_a_fixed_spring_as_stiff_as_kims_is_kims_at_its_own_speed() -> None:
    """K_v = a M X''m ω²/X_m of the retuned spring as the design's own rate, from rest at the lowest place, no weight: then
    η² U of the one is U of the other."""
    omega, mass = Study(KIM, 4).omega, KIM.drive.loads.follower_mass_kg
    rate = 1.5 * mass * 2.0 * omega**2
    fixed = with_elastic(
        with_loads(KIM, spring_rate_n_per_mm=rate * 1e-3, preload_n=0.0, gravity_m_s2=0.0), spring="fixed"
    )
    eta = of(KIM).machine.eta
    one, other = coefficients(KIM).panels.values, coefficients(fixed).panels.values
    for row in (LOAD, LOAD_SLOPE):
        assert np.abs(eta**2 * other[row] - one[row]).max() < 1e-12 * np.abs(one[row]).max()
    for row in (INERTIA, CENTRIPETAL, CURVATURE):
        assert np.array_equal(one[row], other[row])


# -- contact ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["pusher", "c", "f"])
def test_the_contact_force_of_an_even_turn_is_that_of_the_dynamics(name: str) -> None:
    design = with_elastic(with_loads(TRAINS[name], friction=0.0), spring="fixed")
    found, study = of(design), Study(design, 360)
    assert found.contact is not None
    theta = study.theta + 1e-4  # between the joins
    force = found.contact.force(found.contact.panels.at(theta, 3), found.machine.eta, np.ones(360), np.zeros(360))
    exact = study.at_theta(theta).dynamics.contact
    assert np.abs(force * found.contact.unit * study.omega**2 - exact).max() <= 1e-11 * np.abs(exact).max()


@pytest.mark.parametrize("name", ["pusher", "c"])
def test_what_acceleration_adds_to_the_contact_force_turns_the_mechanism(name: str) -> None:
    """Its torque about the cam centre is J for θ̈ = 1."""
    design = with_elastic(TRAINS[name], spring="fixed")
    found, study = of(design), Study(design, 4)
    theta = np.linspace(0.05, 6.2, 97)
    there = study.at_theta(theta)
    assert found.contact is not None
    force = found.contact.panels.at(theta, 3)[2] * found.contact.unit
    reference, normal = there.cam.reference, there.cam.flank.normal
    torque = -there.cam.rotation_sign * (reference.conjugate() * (force * normal)).imag
    expected = there.loading.inertia(there.linkage)[0]
    assert np.abs(torque - expected).max() <= 1e-11 * expected.max()


def test_kims_contact_force_is_spring_and_mass() -> None:
    """(3): M X'' θ̇² + M X' θ̈ + K_v X, over M X''m ω², which the pressure angle enlarges; nothing in the dwell."""
    contact = of(KIM).contact
    assert contact is not None
    theta = np.linspace(0.01, 3.1, 50)
    stroke, base = 9.0, 40.0
    along = np.cos(np.arctan2(stroke * np.sin(2.0 * theta), base + stroke * (1.0 - np.cos(2.0 * theta)) / 2.0))
    rows = contact.panels.at(theta, 3) * along
    assert np.abs(rows[0] - 1.5 * (1.0 - np.cos(2.0 * theta)) / 2.0).max() < 1e-13
    assert np.abs(rows[1] - np.cos(2.0 * theta)).max() < 1e-12
    assert np.abs(rows[2] - np.sin(2.0 * theta) / 2.0).max() < 1e-13
    assert not contact.panels.at(np.array([4.0, 6.0]), 3).any()
    assert contact.moves[0, contact.panels.index(np.array([0.5, 2.0, 4.0]))].tolist() == [True, True, False]


# -- no answer --------------------------------------------------------------------------------------------

SILENT = {
    "rigid": (PUSHER, "rigid"),
    "still": (with_drive(KIM, motion=levels(0.0, (360.0, 0.0, "dwell"))), "nothing moves"),
    "massless": (with_loads(KIM, follower_mass_kg=0.0), "mass"),
    "a blow": (
        with_drive(KIM, motion=levels(0.0, (90.0, 9.0, "constant-velocity"), (270.0, 0.0, "cycloidal"))), "velocity jumps"
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SILENT)
def test_without_an_answer_the_stage_is_none_and_the_reason_is_told(name: str) -> None:
    design, reason = SILENT[name]
    study = Study(design, 8)
    assert study.stability is None
    with pytest.raises(NoStability, match=reason):
        study.flexible_shaft()
    told = findings_of(study, ("stability",))
    assert [f.code for f in told] == ([] if name == "rigid" else ["no-stability"])
    assert all(reason in f.message for f in told)
    assert certificate_of(study, ("stability",)) == {}
    assert extremes_of(study, "stability") == {}
