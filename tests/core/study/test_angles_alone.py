"""A quantity at one angle has the bits that it has among other angles: files do not depend on what a view computed before."""

from __future__ import annotations

import numpy as np
import pytest

import kindyna as kd

ALONE = range(0, 360, 7)


@pytest.mark.parametrize(
    "channel", ["phi_deg", "beta_deg", "pressure_angle_deg", "instant_centre_mm", "instant_centre_velocity_mm_s"]
)
def test_a_single_angle_has_the_bits_of_the_turn(channel: str) -> None:
    """Single angles and arrays take different code of numpy, which must not round differently."""
    study = kd.example("transfer_lift").study()
    alone = [study.at([study.angle_deg[i]])[channel][0] for i in ALONE]
    assert np.array_equal(alone, study[channel][list(ALONE)])
