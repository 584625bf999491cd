"""Harmonics of the valve's lift at the engine speeds at which they meet a valve spring, and the force at resonance."""

import math
from pathlib import Path

import numpy as np
import pytest

from core.design import put
from core.design.camshaft import only
from core.project import load
from core.study import Study
from core.valves.spring_speeds import engine_rpm, resonances, spring_forces

EXAMPLE = Path(__file__).parents[3] / "resources" / "examples" / "valve_train.toml"


@pytest.fixture(scope="module")
def study() -> Study:
    return Study(only(load(EXAMPLE), 0), samples=2048)


def test_a_harmonic_resonates_where_it_meets_the_spring(study: Study) -> None:
    """Natural frequency of the example's spring: 471.952192 Hz, 120 f/n rpm of the engine."""
    (rows,) = resonances(study)
    assert engine_rpm(study) == pytest.approx(5000.0)
    assert [row.n * row.engine_rpm for row in rows] == pytest.approx([120.0 * 471.952192] * 100, rel=1e-8)
    lift = np.maximum(1e3 * study.motion.displacement[0] - 0.12, 0.0)
    amplitude = 2.0 * np.abs(np.fft.rfft(lift)) / lift.size
    assert [row.lift_mm for row in rows[:20]] == pytest.approx(amplitude[1:21].tolist(), abs=2e-5)


@pytest.mark.parametrize("n", [9, 10])
def test_the_force_at_resonance_is_that_of_the_surge_there(study: Study, n: int) -> None:
    """The design at that speed: amplitude of the force's harmonic by a discrete Fourier transform."""
    row = resonances(study)[0][n - 1]
    at_resonance = Study(put(study.design, "shaft.speed_rpm", 0.5 * row.engine_rpm), samples=2048)
    _, true = spring_forces(at_resonance)
    force = 2.0 * abs(np.fft.rfft(true)[n]) / true.size
    assert force == pytest.approx(row.force_n, rel=1e-9)
    assert force == pytest.approx(29.9029378 * row.lift_mm / 0.02, rel=2e-3)  # k c/ζ


def test_a_spring_without_damping_has_no_finite_force_at_resonance(study: Study) -> None:
    undamped = Study(put(study.design, "loads.valve_springs[0].damping_ratio", 0.0))
    assert math.isinf(resonances(undamped)[0][9].force_n)
    static, true = spring_forces(undamped)
    assert np.isfinite(true).all()
    assert static.min() == pytest.approx(313.9808, abs=1e-4)
