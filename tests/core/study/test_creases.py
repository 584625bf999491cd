"""Extremes where a quantity has a crease: the transmission angle at 90°, the unsigned pressure angle at 0; of one design and of many."""

import math
from pathlib import Path

import numpy as np
import pytest
from linkages import four_bar

from core.design import get, put
from core.project import load
from core.study import Study, extremes_of, many

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
COUPLER = "linkage.links[2].points.B.x_mm"


def test_the_transmission_angle_is_90_where_the_triangle_has_a_right_angle() -> None:
    """c² + k² = g² + r² - 2 g r cos θ."""
    ground, crank, rocker = 100.0, 30.0, 80.0
    couplers = np.array([62.0, 70.0, 81.3, 90.0])
    at = np.degrees(np.arccos((ground**2 + crank**2 - couplers**2 - rocker**2) / (2.0 * ground * crank)))
    base = four_bar(ground, crank, couplers[0], rocker)
    for coupler, angle in zip(couplers, at, strict=True):
        high = extremes_of(Study(put(base, COUPLER, float(coupler))), "linkage")["transmission.B"].high
        assert math.degrees(high.value) == pytest.approx(90.0, abs=1e-11)
        assert math.degrees(high.theta) == pytest.approx(angle, abs=1e-9)
    together = many(base, {COUPLER: couplers}, ["transmission_B_deg:max"])
    assert together.value["transmission_B_deg:max"] == pytest.approx(np.full(4, 90.0), abs=1e-11)
    assert together.angle_deg["transmission_B_deg:max"] == pytest.approx(at, abs=1e-9)


@pytest.mark.parametrize("name", ["transfer_lift", "conjugate", "tappet_knife"])
def test_the_pressure_angle_is_0_where_the_normal_lies_along_the_travel(name: str) -> None:
    design = load(EXAMPLES / f"{name}.toml")
    radii = float(get(design, "cam.base_radius_mm")) + np.array([0.0, 1.1, 2.3])
    together = many(design, {"cam.base_radius_mm": radii}, ["pressure_angle_deg:min"])
    assert np.abs(together.value["pressure_angle_deg:min"]).max() <= 1e-11
    for radius in radii:
        low = extremes_of(Study(put(design, "cam.base_radius_mm", float(radius))), "cam")["pressure_angle"].low
        assert math.degrees(low.value) <= 1e-11
