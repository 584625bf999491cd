"""core.output.position: the tables of one position are the lecture's figures, and what their rows say of each other holds."""

import math
from pathlib import Path

import numpy as np
import pytest
from linkages import slider_crank

from core.output.position import Position
from core.project import load
from core.study import Study

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
RPM = math.pi / 30.0


def study(name: str) -> Study:
    found = Study(load(EXAMPLES / f"{name}.toml"), 24)
    assert found.design.drive.is_linkage
    return found


def position(found: Study, theta: float) -> Position:
    """Of a linkage with its driver at this angle [rad]."""
    return Position(found.at_theta(np.array([theta])))


def test_the_six_bar_of_the_lecture() -> None:
    """Velocity: I12I13 = 20.07 cm, w3 = -6.64, w4 = 20.57, w5 = -20.57 rpm, the slider 22.39 cm/s, exact figures."""
    there = position(study("lecture_six_bar"), math.radians(45.0))
    assert there.distance((1, 2), (1, 3)) == pytest.approx(0.20076391, abs=1e-8)
    assert there.distance((1, 4), (1, 3)) == pytest.approx(0.16392305, abs=1e-8)
    omega = {row.link: row.omega / RPM for row in there.links}
    assert [omega[n] for n in (3, 4, 5)] == pytest.approx([-6.638493, 20.566558, -20.566558], abs=1e-6)
    assert {row.name: row.velocity for row in there.points}["D"].real == pytest.approx(-0.22382166, abs=1e-8)
    assert len(there.centres) == 15
    assert dict(there.transmission)["D"] == pytest.approx(math.radians(30.0), abs=1e-12)


def test_the_ratio_is_that_of_the_angular_velocities_and_the_advantage_its_inverse() -> None:
    for row in position(study("watt_six_bar"), 1.1).links:
        assert row.ratio == pytest.approx(row.omega / (60.0 * RPM), rel=1e-12)
        assert row.advantage * row.ratio == pytest.approx(1.0, rel=1e-14)


def test_a_sliders_centre_lies_at_infinity_across_its_guide() -> None:
    found = Study(slider_crank(30.0, 90.0), 24)
    assert found.design.drive.is_linkage
    there = position(found, 0.7)
    row = next(row for row in there.centres if row.links == (1, 4))
    assert row.point is None
    assert row.direction == pytest.approx(math.pi / 2.0, abs=1e-15)
    assert there.distance((1, 4), (1, 2)) == math.inf
    assert next(row for row in there.links if row.link == 4).ratio == 0.0


def test_what_a_pair_shows_has_no_lines_and_the_others_have_two_or_more() -> None:
    lines = {row.links: row.lines for row in position(study("four_bar"), 1.0).centres}
    assert [lines[key] for key in ((1, 2), (2, 3), (3, 4), (1, 4))] == [()] * 4
    assert lines[(1, 3)] == (2, 4)
    assert lines[(2, 4)] == (1, 3)
