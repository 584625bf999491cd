"""The balance cam: closed forms, and the torque that its follower leaves by the inverse dynamics of any translating follower."""

import math
from dataclasses import replace

import numpy as np
import pytest
from mechanisms import LIFT, levels
from sampled import spread

from core.design import Balancer, Design, Shaft, part_faults
from core.errors import NoSolution
from core.motion import TURN, Angles, CompiledMotion, degrees
from core.shaft import LoadCurve, balance_drive, balance_drives, load_curve
from core.study import Study

SPRING = Balancer(spring_rate_n_per_mm=100.0, preload_n=2000.0, base_radius_mm=150.0, roller_radius_mm=30.0)
HALVES = CompiledMotion(levels(0.0, (180.0, 10.0, "cycloidal"), (180.0, 0.0, "cycloidal")))


def curve_of(torque: object) -> LoadCurve:
    return load_curve(lambda a: np.array([torque(a), np.zeros(a.theta.size)]), HALVES)  # type: ignore[operator]


def study_of(load: LoadCurve, balancer: Balancer, rotation: str = "ccw", speed_rpm: float = 60.0) -> Study:
    return Study(
        Design("balancer", Shaft(rotation, speed_rpm), (balance_drive(load, balancer, speed_rpm * math.pi / 30.0),))
    )


@pytest.mark.parametrize(("rate", "preload", "phase"), [(80.0, 500.0, 0.0), (0.0, 900.0, 100.0), (2.0, 3.0, -77.0)])
def test_a_sine_is_balanced_by_the_spring_in_closed_form(rate: float, preload: float, phase: float) -> None:
    """T = 7 + a sin θ: W = a(1 - cos θ), so that the spring has stored a(1 + cos θ)."""
    a, k = 40.0, 1e3 * rate
    balancer = replace(SPRING, spring_rate_n_per_mm=rate, preload_n=preload, phase_deg=phase)
    y = study_of(curve_of(lambda angles: 7.0 + a * np.sin(angles.theta)), balancer).motion.y
    machine = np.deg2rad(degrees(3600) + phase)
    stored = a * (1.0 + np.cos(machine))
    force = np.sqrt(preload**2 + 2.0 * k * stored)
    rise = 2.0 * stored / (preload + force)
    speed = -a * np.sin(machine) / force
    bend = -(a * np.cos(machine) + k * speed**2) / force
    for reached, wanted in zip(y[:3], (rise, speed, bend), strict=True):
        assert np.abs(reached - wanted).max() <= 1e-11 * np.abs(wanted).max()


@pytest.mark.parametrize("rotation", ["ccw", "cw"])
def test_what_a_balance_cam_leaves_of_the_torque_is_its_mean(rotation: str) -> None:
    """The lift's torque, and that of the balance cam by the forces on its follower, at the same machine angles."""
    lift = Study(replace(LIFT, shaft=replace(LIFT.shaft, rotation=rotation)))
    balance = study_of(lift.flywheel.load, replace(SPRING, phase_deg=33.0), rotation)
    own = np.deg2rad(degrees(720))
    torque = lift.at_theta(np.mod(own + math.radians(33.0), TURN)).shaft_torque
    left = torque + balance.at_theta(own).shaft_torque - lift.flywheel.mean_torque
    assert np.abs(left).max() <= 1e-12 * np.ptp(torque)


def test_a_torque_that_jumps_is_refused_at_its_angles() -> None:
    def step(angles: Angles) -> np.ndarray:
        return np.where(angles.piece == 0, 5.0, -5.0)

    with pytest.raises(NoSolution, match="jumps, by up to 10 N·m, at cam angle 0, 180 deg"):
        balance_drive(curve_of(step), SPRING, 6.0)


def test_a_spring_without_preload_is_refused_by_its_field() -> None:
    (fault,) = part_faults(replace(SPRING, preload_n=0.0), "balancer")
    assert str(fault) == "balancer.preload_n = 0.0: outside its range; allowed: > 0 N"
    with pytest.raises(NoSolution, match=r"balancer.preload_n: with 1e-30 N .* kink .*; enlarge it, to 0.00632 N"):
        balance_drive(curve_of(lambda angles: np.sin(angles.theta)), replace(SPRING, preload_n=1e-30), 6.0)


@pytest.mark.parametrize("mass", spread([0.5, 2.0, 200.0], 1))
def test_a_follower_with_a_mass_takes_part(mass: float) -> None:
    """Its inertia at the lift's speed, by the forces on the follower."""
    lift = Study(LIFT)
    spring = replace(SPRING, follower_mass_kg=mass, phase_deg=33.0)
    balance = study_of(lift.load_curve, spring, LIFT.shaft.rotation, LIFT.shaft.speed_rpm)
    own = np.deg2rad(degrees(720))
    torque = lift.at_theta(np.mod(own + math.radians(33.0), TURN)).shaft_torque
    left = torque + balance.at_theta(own).shaft_torque - lift.flywheel.mean_torque
    assert np.abs(left).max() <= 1e-10 * np.ptp(torque)
    assert balance.motion.y[0].min() >= -1e-9


def test_a_follower_too_heavy_for_its_spring_is_refused() -> None:
    with pytest.raises(NoSolution, match=r"balancer.follower_mass_kg: the follower is too heavy .* at cam angle"):
        balance_drive(
            curve_of(lambda angles: 40.0 * np.sin(angles.theta)),
            replace(SPRING, preload_n=10.0, follower_mass_kg=1e4),
            60.0,
        )


def test_cams_made_side_by_side_are_those_made_alone() -> None:
    load = curve_of(lambda angles: 40.0 * np.sin(angles.theta) + 15.0 * np.cos(3.0 * angles.theta))
    masses, omega = {1.0: 10.0, 2.0: 30.0, 1e4: 10.0, 5.0: 1e-30}, 20.0
    cams = [replace(SPRING, preload_n=preload, follower_mass_kg=mass) for mass, preload in masses.items()]
    light, heavier, heaviest, slack = balance_drives(load, cams, omega)
    assert repr([light, heavier]) == repr([balance_drive(load, cam, omega) for cam in cams[:2]])  # to the last bit
    assert "too heavy" in str(heaviest)
    assert "slack" in str(slack)
