"""The flywheel for a wanted fluctuation by the true speed, and figures against the machine's speed."""

import math
from dataclasses import replace

import numpy as np
import pytest
from mechanisms import LIFT, PUSHER, levels, with_loads
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from core.design import Shaft
from core.motion import TURN, CompiledMotion
from core.shaft import LoadCurve, against_speed, fluctuation_with, inertia_for, load_by_speed, load_curve
from core.study import Study

HALVES = CompiledMotion(levels(0.0, (180.0, 10.0, "cycloidal"), (180.0, 0.0, "cycloidal")))
SHAFT = Shaft("ccw", 60.0, 0.0, 0.02, 30.0)


def sine(amplitude: float, bodies: float = 0.0) -> LoadCurve:
    return load_curve(lambda a: np.array([20.0 + amplitude * np.sin(a.theta), np.full(a.theta.size, bodies)]), HALVES)


def test_the_flywheel_of_a_sine_by_the_closed_form_of_small_fluctuations() -> None:
    """Harmonics -T/(k + i I ω̄): a swing of 2a/√(k² + I²ω̄²), so that C_s ω̄ = that; the error is of second order."""
    a, share = 10.0, 1e-3
    omega = TURN
    wanted = math.sqrt((2.0 * a / (share * omega)) ** 2 - 30.0**2) / omega
    assert inertia_for(sine(a), SHAFT, share) == pytest.approx(wanted, rel=1e-5)
    assert inertia_for(sine(a, bodies=3.0), SHAFT, share) == pytest.approx(wanted - 3.0, rel=1e-5)


@pytest.mark.stress
def test_the_flywheel_of_a_large_fluctuation_by_an_integrated_motor() -> None:
    found = inertia_for(sine(300.0), SHAFT, 0.3)

    def fluctuation(inertia: float) -> float:
        def rate(theta: float, w: np.ndarray) -> np.ndarray:
            return (30.0 * (TURN - w) - 300.0 * np.sin(theta)) / (inertia * w)

        run = solve_ivp(rate, (0.0, 35 * TURN), [TURN], "DOP853", rtol=1e-10, dense_output=True)
        speed = run.sol(np.linspace(34 * TURN, 35 * TURN, 4001))[0]
        return float(np.ptp(speed)) / TURN

    assert found == pytest.approx(
        brentq(lambda i: fluctuation(i) - 0.3, 0.8 * found, 1.2 * found, xtol=1e-6 * found), rel=1e-5
    )
    assert fluctuation_with(sine(300.0), SHAFT, found) == pytest.approx(0.3, rel=1e-9)


def test_no_flywheel_where_the_motor_alone_holds_the_speed() -> None:
    """Without any the speed swings by 2a/k."""
    assert inertia_for(sine(1.0), SHAFT, 0.5) == 0.0
    assert inertia_for(sine(0.0), SHAFT, 0.01) == 0.0


def test_figures_against_speed_are_those_of_designs_at_these_speeds() -> None:
    """A load without friction is of a static part and of one that grows with the speed squared; with friction each speed is solved."""
    for design, rubs in ((with_loads(PUSHER, friction=0.0), False), (LIFT, True)):
        shaft = replace(design.shaft, flywheel_inertia_kg_m2=4000.0, motor_slope_nm_s_per_rad=200.0)

        def at(rpm: float, design=design, shaft=shaft) -> Study:  # type: ignore[no-untyped-def]
            return Study(replace(design, shaft=replace(shaft, speed_rpm=rpm)))

        def load(omega: float, at=at) -> LoadCurve:  # type: ignore[no-untyped-def]
            return at(omega * 30.0 / math.pi).flywheel.load  # type: ignore[no-any-return]

        rpm = np.array([12.0, 40.0])
        found = against_speed(load if rubs else load_by_speed(load, shaft.speed_rpm * math.pi / 30.0), shaft, rpm)
        for i, speed in enumerate(rpm):
            study = at(float(speed))
            torque, motor = study.shaft_torque, study.flywheel.motor_torque(study.angles)
            assert found.peak[i] == pytest.approx(np.abs(torque).max(), rel=1e-5)
            assert found.mean[i] == pytest.approx(torque.mean(), rel=1e-5, abs=1e-6 * found.peak[i])
            assert found.rms[i] == pytest.approx(np.sqrt((torque**2).mean()), rel=1e-5)
            assert found.motor_peak[i] == pytest.approx(np.abs(motor).max(), rel=1e-5)
            assert found.fluctuation[i] == pytest.approx(
                np.ptp(study.flywheel.speed(study.angles)) / study.omega, rel=1e-4
            )
