"""Best phases of several drives on one shaft, against dense scans of their sampled torques."""

import math
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from mechanisms import LIFT, levels, with_drive
from sampled import spread

from core.errors import KindynaError
from core.motion import TURN, degrees
from core.shaft import AIMS, LoadCurve, Spacing, best_phases
from core.study import Study

SAMPLES = 1440
DRIVES = (
    LIFT,
    with_drive(
        LIFT, motion=levels(0.0, (100.0, 150.0, "cycloidal"), (60.0, 150.0, "dwell"), (200.0, 0.0, "modified-sine"))
    ),
    with_drive(
        LIFT,
        motion=levels(
            0.0, (60.0, 80.0, "3-4-5"), (20.0, 80.0, "dwell"), (60.0, 0.0, "cycloidal"), (220.0, 0.0, "dwell")
        ),
    ),
    with_drive(
        LIFT,
        motion=levels(
            0.0, (120.0, 50.0, "cycloidal"), (120.0, 0.0, "cycloidal"), (60.0, 60.0, "3-4-5"), (60.0, 0.0, "3-4-5")
        ),
    ),
)

REACHED: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "peak": lambda torque: np.abs(torque).max(axis=-1),
    "rms": lambda torque: np.sqrt((torque**2).mean(axis=-1)),
    "fluctuation": lambda torque: (
        np.ptp(np.cumsum(torque - torque.mean(axis=-1, keepdims=True), axis=-1), axis=-1) * (TURN / SAMPLES)
    ),
}
SAMPLED = 2e-4  # by this much samples of a quarter of a degree may miss a peak or a sum


@cache
def load(index: int) -> LoadCurve:
    return Study(DRIVES[index]).flywheel.load


@cache
def torque(index: int) -> np.ndarray:
    """Of one drive by its own angle (SAMPLES,)."""
    return np.asarray(Study(DRIVES[index], SAMPLES).shaft_torque)


def at_phases(phases: np.ndarray) -> np.ndarray:
    """The torque of all by the machine angle, by the drives' own studies."""
    machine = np.deg2rad(degrees(SAMPLES))
    return np.asarray(sum(Study(DRIVES[i]).at_theta(machine - phase).shaft_torque for i, phase in enumerate(phases)))


@pytest.mark.parametrize("aim", AIMS)
def test_two_drives_stand_best_of_all_phases(aim: str) -> None:
    found = best_phases([load(0), load(1)], [], aim)
    shifts = (np.arange(SAMPLES) - np.arange(SAMPLES)[:, None]) % SAMPLES
    scan = float(REACHED[aim](torque(0) + torque(1)[shifts]).min())
    reached = float(REACHED[aim](at_phases(found.rotations)))
    assert reached == pytest.approx(found.value, rel=SAMPLED)
    assert reached <= scan * (1.0 + SAMPLED)


@pytest.mark.parametrize("aim", spread(AIMS, 1))
def test_three_drives_stand_best_of_all_phases_that_keep_their_timing(aim: str) -> None:
    """The second event comes 17° after the first more than it must, and is to stay behind it."""
    spacings = [Spacing(0, 1, math.radians(17.0)), Spacing(1, 2, math.radians(2.0))]
    found = best_phases([load(i) for i in range(3)], spacings, aim)
    spares = [
        (math.degrees(s.spare + found.rotations[s.second] - found.rotations[s.first]) + 180.0) % 360.0 - 180.0
        for s in spacings
    ]
    assert min(spares) >= -1e-9
    steps = np.arange(0, SAMPLES, 12)  # 3°
    shifts = (np.arange(SAMPLES) - steps[:, None]) % SAMPLES
    scan = math.inf
    for k in steps:
        if (17.0 + k / 4.0) % 360.0 < 180.0:
            kept = ((2.0 + (steps - k) / 4.0) % 360.0) < 180.0
            scan = min(scan, float(REACHED[aim](torque(0) + np.roll(torque(1), k) + torque(2)[shifts[kept]]).min()))
    reached = float(REACHED[aim](at_phases(found.rotations)))
    assert reached == pytest.approx(found.value, rel=SAMPLED)
    assert reached <= scan * (1.0 + SAMPLED)


@pytest.mark.stress
def test_four_drives_stand_better_than_at_any_phases_nearby_or_tried_at_random() -> None:
    found = best_phases([load(i) for i in range(4)], [], "peak")
    random = np.random.default_rng(17).uniform(0.0, TURN, (3000, 4))
    near = found.rotations + np.random.default_rng(18).uniform(-0.02, 0.02, (1000, 4))
    samples = np.array([torque(i) for i in range(4)])
    for phases in np.concatenate((random, near)):
        shift = np.rint((phases - phases[0]) * (SAMPLES / TURN)).astype(int)
        assert np.abs(sum(np.roll(samples[i], shift[i]) for i in range(4))).max() >= found.value * (1.0 - SAMPLED)


def test_timing_that_no_phases_keep_is_refused() -> None:
    """Three half turns, a third of a turn apart: any two of them meet, all three do not."""
    rows = [Spacing(0, 1, math.radians(spare)) for spare in (0.0, 120.0, -120.0)]
    with pytest.raises(KindynaError, match="no phases of the drives satisfy their timing"):
        best_phases([load(0), load(1)], rows, "peak")


def test_one_drive_stands_as_it_is() -> None:
    found = best_phases([load(0)], [], "peak")
    assert found.rotations.tolist() == [0.0]
    assert found.value == pytest.approx(float(np.abs(torque(0)).max()), rel=SAMPLED)
