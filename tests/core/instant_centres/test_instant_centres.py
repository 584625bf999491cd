"""core.instant_centres: by Kennedy's theorem, by velocities, and what they tell, for any linkage."""

import math
from dataclasses import replace

import numpy as np
import pytest
from assembled import SIZE, cases
from linkages import INSIDE_OUT, KINDS, four_bar, link, slider_crank
from sampled import spread

from core.design import Design, LinkPoint, with_drive
from core.instant_centres import (
    Centres,
    all_centres,
    angular_ratio,
    collinearity,
    kennedy,
    triangle_line,
)
from core.instant_centres.centres import CentreTable
from core.mechanism import driver_ranges_of, unit_speed_kinematics
from core.mechanism.kinematics import FRAME, Kinematics


def at(design: Design, *angles: float) -> tuple[Kinematics, CentreTable]:
    kinematics = unit_speed_kinematics(
        design.drive.mechanism, np.array(angles), driver_ranges_of(design.drive.mechanism)
    )
    return kinematics, all_centres(kinematics, SIZE)


@pytest.mark.parametrize("kind", spread(KINDS, 2))
def test_any_three_bodies_centres_lie_on_one_line(kind: str) -> None:
    for case in cases(kind, 3):
        n = len(case.kinematics.bodies)
        assert len(case.table.centres) == n * (n - 1) // 2
        assert collinearity(case.table).max() <= 1e-11, case.name


@pytest.mark.parametrize("kind", KINDS)
def test_two_bodies_have_one_velocity_at_their_centre(kind: str) -> None:
    """Where it is at infinity they turn alike, and its direction is across their relative velocity."""
    for case in cases(kind, 3):
        for (a, b), centre in case.table.centres.items():
            one, other = case.kinematics.bodies[a], case.kinematics.bodies[b]
            if centre.is_far(SIZE)[0]:
                assert abs(one.angle[1, 0] - other.angle[1, 0]) <= 1e-9
                across = (centre.point / np.abs(centre.point))[0]
                relative = (other.z[1] - one.z[1] - 1j * one.angle[1] * (other.z[0] - one.z[0]))[0]
                assert abs((relative * across.conjugate()).real) <= 1e-9 * (SIZE + abs(relative)), case.name
                continue
            place = centre.finite
            speeds = [pose.z[1] + 1j * pose.angle[1] * (place - pose.z[0]) for pose in (one, other)]
            scale = SIZE + abs(place[0]) * (1.0 + abs(one.angle[1, 0]) + abs(other.angle[1, 0]))
            assert abs(speeds[0] - speeds[1])[0] <= 1e-10 * scale, case.name


@pytest.mark.parametrize("kind", KINDS)
def test_ratios_by_centres_are_those_of_the_loop_equations(kind: str) -> None:
    told = 0
    for case in cases(kind):
        bodies = case.kinematics.bodies
        for name in [name for name in bodies if name not in (FRAME, "link2")]:
            expected = bodies[name].angle[1, 0] / bodies["link2"].angle[1, 0]
            found = float(angular_ratio(case.table, name, "link2")[0])
            if not math.isnan(found):  # NaN where the three centres coincide, as for a link on the crank's own pivot
                told += 1
                assert found == pytest.approx(expected, rel=1e-9, abs=1e-9), case.name
    assert told > 30


def unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector)


@pytest.mark.parametrize("kind", KINDS)
def test_kennedys_construction_finds_the_centres_that_velocities_give(kind: str) -> None:
    """Each from lines through centres that are known by then; as exactly as those lines are told and cross."""
    for case in cases(kind):
        constructed(case.table)


def constructed(table: CentreTable) -> None:
    known = set(table.construction.known)
    scale = np.array([1.0 / SIZE, 1.0 / SIZE, 1.0])
    for step in table.construction.steps:
        lines, sharp = [], 1.0
        for triangle in step.triangles[:2]:
            assert {triangle.first, triangle.second} <= known
            p, r = (unit(table.centres[key].homogeneous[:, 0] * scale) for key in (triangle.first, triangle.second))
            lines.append(np.cross(p, r))
            sharp = min(sharp, float(np.linalg.norm(lines[-1])))
        known.add(step.key)
        if sharp > 1e-4:
            steep = float(np.linalg.norm(np.cross(unit(lines[0]), unit(lines[1]))))
            one, other = kennedy(table.centres, step, SIZE), table.centres[step.key]
            off = np.cross(unit(one.homogeneous[:, 0] * scale), unit(other.homogeneous[:, 0] * scale))
            assert np.linalg.norm(off) * sharp * steep <= 1e-11
            line = triangle_line(table.centres, step.triangles[0])[:, 0]
            assert abs(unit(line / scale) @ unit(other.homogeneous[:, 0] * scale)) <= 1e-9 / sharp


@pytest.mark.stress
def test_a_linkage_beyond_the_construction_still_has_all_its_centres() -> None:
    """The six-bar driven inside has the same links and pins, and the same fifteen centres."""
    (only,) = driver_ranges_of(INSIDE_OUT.drive.mechanism).ranges
    _, table = at(INSIDE_OUT, *np.linspace(only.low + 0.1, only.high - 0.1, 20))
    assert len(table.centres) == 15
    assert collinearity(table).max() < 1e-11


def test_parallel_cranks_have_a_centre_at_infinity() -> None:
    """A parallelogram's coupler does not turn: I13 lies along the cranks, I24 along the frame."""
    for degrees in (30.0, 75.0, 140.0):
        _, table = at(four_bar(100.0, 40.0, 100.0, 40.0), math.radians(degrees))
        pole = table.centre(FRAME, "link3")
        assert pole.is_far(SIZE)[0]
        assert math.degrees(pole.direction[0]) == pytest.approx(degrees, abs=1e-9)
        assert table.centre("link2", "link4").is_far(SIZE)[0]
        assert float(np.remainder(table.centre("link2", "link4").direction[0] + 0.1, math.pi)) == pytest.approx(
            0.1, abs=1e-9
        )


def test_where_a_slider_turns_back_its_centres_stay() -> None:
    """Crank and rod in line: the slider stands still, and its centre on the frame is at infinity all the same."""
    _, table = at(slider_crank(40.0, 140.0), 0.0, math.pi)
    assert table.centre(FRAME, "link4").is_far(SIZE).all()
    assert np.abs(table.centre("link2", "link4").finite).max() < 1e-15, "I24 falls on I12"
    assert np.abs(table.centre(FRAME, "link3").finite - np.array([0.18, 0.10])).max() < 1e-15, "I13 on the slider's pin"


def test_a_body_at_rest_has_the_limit_of_its_centres() -> None:
    """At a dwell of a link hung on a four-bar's rocker toggle nothing of it moves; beside it, its centres hardly differ."""
    design = four_bar(100.0, 30.0, 90.0, 70.0)
    toggle = math.acos((100.0**2 + 120.0**2 - 70.0**2) / (2.0 * 100.0 * 120.0))
    links = (*design.drive.mechanism.links, link(5, B=(0, 0), D=(60, 0)), link(6, O6=(0, 0), D=(80, 0)))
    frame = replace(links[0], points=(*links[0].points, LinkPoint("O6", 200.0, 30.0)))
    six = with_drive(design, mechanism=replace(design.drive.mechanism, links=(frame, *links[1:])))
    _, table = at(six, toggle - 1e-5, toggle, toggle + 1e-5)
    for key in ((FRAME, "link5"), ("link4", "link5"), ("link4", "link6"), ("link5", "link6")):
        before, there, after = table.centres[key].scaled(SIZE).homogeneous.T
        assert math.hypot(np.linalg.norm(there[:2]) / SIZE, there[2]) == pytest.approx(1.0), key
        middle = before + np.sign(before @ after) * after
        assert np.linalg.norm(np.cross(there, middle)) < 1e-4 * np.linalg.norm(middle), key


def test_a_centre_is_told_from_infinity_by_its_weight() -> None:
    centre = Centres(np.array([1.0 + 2.0j, 3.0j, -1.0 + 0j]), np.array([0.5, 0.0, 0.0]))
    assert centre.finite[0] == 2.0 + 4.0j
    assert np.isinf(centre.finite[1])
    assert centre.is_far(1.0).tolist() == [False, True, True]
    assert np.degrees(centre.direction).tolist()[1:] == [90.0, 0.0]
    assert centre.homogeneous.shape == (3, 3)
    assert np.hypot(np.abs(centre.scaled(2.0).point) / 2.0, centre.scaled(2.0).weight) == pytest.approx(1.0)
