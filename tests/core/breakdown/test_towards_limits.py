"""Towards dead centres, rods at 180 degrees, centres at infinity, undercut, jamming, tiny spans and strokes: the error
stays below what the condition of fifty-digit values allows."""

import math

import numpy as np
import pytest
from references import EPS
from sampled import spread
from stress_cases import CASES, Case, many_segments

from core.dynamics import Inertia, combined_inertia
from core.study import Study, certificate_of, extremes_of, findings_of

LOOKED_AT = [
    pytest.param(
        case, value, id=f"{case.name}, {value:.0e}", marks=[] if value == case.some[-1] else pytest.mark.stress
    )
    for case in CASES
    for value in case.some
]
"""In every run the worst of each case."""
NAMED = {case.name: case for case in CASES}


@pytest.mark.parametrize(("case", "value"), spread(LOOKED_AT, 5))
def test_the_error_keeps_below_what_the_condition_allows(case: Case, value: float) -> None:
    sample = case.look(value)
    assert sample.ratio <= 1.0, sample
    # far below it, so that a lost digit is seen, and above nothing: a bound that nothing can break guards nothing
    assert sample.ratio <= case.part, sample
    assert sample.bound >= 0.5 * EPS


@pytest.mark.parametrize("short", [1e-3, 1e-6, 1e-9, 1e-12, 0.0])
def test_where_the_printed_formula_loses_its_digits_ours_keeps_them(short: float) -> None:
    """The tangent of the half angle of one branch is 0/0 where the rod of the other stands at 180 degrees."""
    sample = NAMED["Other branch's rod at 180°"].look(short)
    assert sample.error <= 4 * EPS
    assert sample.printed >= min(1e-3, 0.1 * EPS / max(short, 1e-300))


GIVEN = {"Dead centre, stretched": 4, "Dead centre, folded": 4, "Arm like rod, slider at the pivot": 4, "Rods of a dyad in line": 16,
         "Guide of a dyad across": 16}  # fmt: skip
"""Roundings that are made on the way; of the dyads there are derivatives too."""


@pytest.mark.parametrize("name", spread(GIVEN, 1))
def test_of_sides_that_are_given_no_digit_is_lost_at_a_dead_centre(name: str) -> None:
    """Closer than a rounding of the distance could tell: the area is taken from the slider's own place."""
    for value in NAMED[name].values:
        assert NAMED[name].look(value).error <= GIVEN[name] * EPS, value


@pytest.mark.stress
def test_a_thousand_segments_keep_motion_linkage_and_forces_in_balance() -> None:
    study = Study(many_segments(1000))
    proof = certificate_of(study)
    assert all(residual.kept for residual in proof.values())
    assert proof["roller_tangency"].left_out > 0, "it is undercut, and said to be"
    assert {f.code for f in findings_of(study)} >= {"undercut"}
    assert len(study.program.joins) == 1000
    assert not any(j.jumps.any() for j in study.program.joins if j.theta) or "jump-acceleration" not in {
        f.code for f in findings_of(study)
    }
    found = extremes_of(study, "motion")["displacement"]
    assert found.high.value == pytest.approx(0.1e-3, rel=1e-12)
    assert found.low.value == pytest.approx(0.0, abs=1e-18)
    assert np.isfinite(study.flywheel.energy_swing)
    assert math.isfinite(study.flywheel.mean_torque)


@pytest.mark.parametrize("after", [1e-3, 1e-6, 1e-9])
def test_a_pressure_angle_near_zero_keeps_its_digits(after: float) -> None:
    """By its cosine alone half of them would be lost."""
    sample = NAMED["Pressure angle to 0°"].look(after)
    assert sample.ratio <= 1.0, sample


def test_masses_far_from_the_pivot_and_near_each_other_keep_their_inertia() -> None:
    """About their common centre, not by the difference of two much larger ones about the pivot."""
    apart = 2.0**-14
    one = combined_inertia([Inertia(1.5, 1000.1 + 0j), Inertia(1.5, 1000.1 + apart)])
    assert one.about_centre == pytest.approx(0.75 * apart**2, rel=8 * EPS)
