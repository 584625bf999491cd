"""The same machine from micrometres to kilometres: every figure the same but for its power of the scale."""

import math

import numpy as np
import pytest
from mechanisms import LAYOUT_DESIGNS, LIFT, with_shaft
from references import EPS
from sampled import spread
from stress_cases import FORCE_ROUNDINGS, figures, scaled

from core.design import Design, faults
from core.study import Study, certificate_of, extremes_of, findings_of

DESIGNS = {"lift": LIFT, "c": LAYOUT_DESIGNS["c"], "f": LAYOUT_DESIGNS["f"]}


KINEMATIC = ("y", "roller", "profile", "pressure_angle", "pitch_curvature", "profile_curvature", "phi 0", "beta 2")


@pytest.mark.parametrize("power", [-20, -10, -1, 1, 8, 19])
@pytest.mark.parametrize("name", DESIGNS)
def test_twice_as_large_is_the_same_to_the_last_bit(name: str, power: int) -> None:
    """Powers of two round nowhere: what differs then would come of a length that stands in the program. Beyond some
    hundred metres masses leave their range; lengths go on."""
    by, design = 2.0**power, DESIGNS[name]
    larger = scaled(design, by)
    beyond = {f.path.partition(".")[0] for f in faults(larger)}
    assert beyond == ({"loads"} if power > 8 else set())
    one, other = figures(design, 1.0), figures(larger, by)
    assert [n for n in (one if power <= 8 else KINEMATIC) if not np.array_equal(one[n], other[n])] == []


@pytest.mark.parametrize("power", [-20, 8])
@pytest.mark.parametrize("name", spread(list(DESIGNS), 1))
def test_findings_extremes_certificate_and_flywheel_scale_too(name: str, power: int) -> None:
    by = 2.0**power
    wheel = {"lift": 3000.0}.get(name, 0.3)  # enough for the motor not to stall
    design = with_shaft(DESIGNS[name], flywheel_inertia_kg_m2=wheel, motor_slope_nm_s_per_rad=50.0)
    larger = with_shaft(scaled(design, by), motor_slope_nm_s_per_rad=50.0 * by**5)
    one, other = Study(design, 24), Study(larger, 24)
    found, grown = (
        [(f.code, f.cam_angle_deg) for f in findings_of(each) if f.code != "polar-radius"] for each in (one, other)
    )
    assert found == grown, "but for the shaft, whose steel does not bear more when all grows"
    for stage, powers in {
        "linkage": 0,
        "cam": {"pressure_angle": 0, "pitch_curvature": -1},
        "dynamics": {"contact_force": 4, "drive_torque": 5, "motor_torque": 5},
    }.items():
        a, b = extremes_of(one, stage), extremes_of(other, stage)
        for quantity, grows in powers.items() if isinstance(powers, dict) else [("phi", 0), ("dead-centre", 0)]:
            assert (b[quantity].high.value / by**grows, b[quantity].high.theta) == (
                a[quantity].high.value,
                a[quantity].high.theta,
            )
    assert other.flywheel.mean_torque / by**5 == one.flywheel.mean_torque
    assert other.flywheel.energy_swing / by**5 == one.flywheel.energy_swing
    for key, residual in certificate_of(one).items():
        told = certificate_of(other)[key]
        assert told.kept
        assert told.value == residual.value, key
    motor = one.flywheel.motor_torque(one.angles)
    assert (other.flywheel.motor_torque(other.angles) / by**5).tolist() == motor.tolist()


@pytest.mark.parametrize("power", [-6, -3, 2])
@pytest.mark.parametrize("name", DESIGNS)
def test_a_thousand_times_as_large_differs_by_the_roundings_of_its_numbers(name: str, power: int) -> None:
    """Micrometres, millimetres, a hundred metres: each number of the design is rounded anew."""
    design: Design = DESIGNS[name]
    one, other = figures(design, 1.0), figures(scaled(design, 10.0**power), 10.0**power)
    study = Study(design, 24)
    speed = np.abs(study.cam.relative_velocity).min() / np.abs(study.cam.reference).max()
    jam = 1.0 / (1.0 - float(study.dynamics.guide.jam.max()))
    condition = (float(study.linkage.condition.max()) / min(1.0, float(speed))) ** 2 * jam
    for key, value in one.items():
        assert np.abs(other[key] - value).max() <= 2 * FORCE_ROUNDINGS * EPS * condition * np.abs(value).max(), key
    assert math.isfinite(condition)
