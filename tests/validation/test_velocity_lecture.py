"""The lecture on velocity analysis (Velocity, chapter 6): four-bar, slider-crank, and the six-bar's printed figures.

The print rounds its intermediates, and its coupler of 6.9 cm is not the one of its figures: a rocker at 60 deg asks for
6.897436 cm.
"""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from linkages import four_bar, slider_crank
from paper_claims import at as claim_at
from references import MP

from core.__main__ import main
from core.instant_centres import (
    CentreTable,
    all_centres,
    angular_ratio,
    mechanical_advantage,
    ratio_arms,
    velocity_polygon,
)
from core.instant_centres.velocities import link_by_link
from core.mechanism import body_name, driver_ranges_of, unit_speed_kinematics
from core.project import load
from core.study import Study

EXAMPLES = Path(__file__).parents[2] / "resources" / "examples"
SIX_BAR = EXAMPLES / "lecture_six_bar.toml"
CM = 0.01
RPM = math.pi / 30.0


def six_bar() -> Study:
    study = Study(load(SIX_BAR)).at_theta(np.array([math.radians(45.0)]))
    assert study.design.drive.is_linkage
    return study


def centre(table: CentreTable, a: int, b: int) -> complex:
    return complex(table.centre(body_name(a), body_name(b)).finite[0])


FIGURES = {
    "I12I13": (20.076391, 20.07), "I14I13": (16.392305, 16.39), "I14I12": (6.0, 6.0), "w3": (-6.638493, -6.64),
    "w4": (20.566558, 20.57), "w5": (-20.566558, -20.57), "slider": (-22.382166, -22.39),
}  # fmt: skip
"""Derived again, and as printed (the print leaves signs to its arrows)."""


def measured() -> dict[str, float]:
    study = six_bar()
    table = study.centres
    speeds = {n: float(w[0]) / RPM for n, w in study.angular_velocities().items()}
    return {
        "I12I13": abs(centre(table, 1, 2) - centre(table, 1, 3)) / CM,
        "I14I13": abs(centre(table, 1, 4) - centre(table, 1, 3)) / CM,
        "I14I12": abs(centre(table, 1, 4) - centre(table, 1, 2)) / CM,
        "w3": speeds[3],
        "w4": speeds[4],
        "w5": speeds[5],
        "slider": float(study.points()["D"][1][0].real) / CM,
    }


@pytest.mark.parametrize("name", FIGURES)
def test_the_six_bars_figures(name: str) -> None:
    exact, printed = FIGURES[name]
    assert measured()[name] == pytest.approx(exact, abs=1e-6)
    assert measured()[name] == pytest.approx(printed, abs=0.02)


def test_the_six_bars_figures_follow_from_the_law_of_sines() -> None:
    """As the lecture computes them, at fifty digits: the triangle O1, O2, I13 has angles 45, 120 and 15 deg."""
    base, sin = 6, lambda degrees: MP.sin(MP.mpf(degrees) * MP.pi / 180)
    i12, i14 = base * sin(120) / sin(15), base * sin(45) / sin(15)
    w3 = -60 * 2 / (i12 - 2)
    w4 = -w3 * (i14 - 4) / 4
    told = measured()
    for name, exact in (("I12I13", i12), ("I14I13", i14), ("w3", w3), ("w4", w4), ("w5", -w4)):
        assert told[name] == pytest.approx(float(exact), rel=1e-13)
    # I15 stands above D where the line of link 4 meets the guide's normal; v6 = ω5·I15I56
    high = 2 * 6 * sin(60)
    assert told["slider"] == pytest.approx(float(-w4 * MP.pi / 30 * high), rel=1e-13)


def test_the_rocker_stands_at_60_degrees_and_the_slider_at_12_centimetres() -> None:
    study = six_bar()
    assert math.degrees(study.linkage.bodies["link4"].angle[0, 0]) == pytest.approx(60.0, abs=1e-12)
    assert study.points()["D"][0][0] == pytest.approx(0.12, abs=1e-15)


@pytest.mark.parametrize(("example", "count"), [("four_bar", 6), ("slider_crank", 6), ("lecture_six_bar", 15)])
def test_the_number_of_centres(example: str, count: int) -> None:
    study = Study(load(EXAMPLES / f"{example}.toml"), 24)
    assert study.design.drive.is_linkage
    table = study.centres
    n = len(table.bodies)
    assert len(table.centres) == count == n * (n - 1) // 2
    plan = table.construction
    assert len(plan.known) + len(plan.steps) == count
    assert plan.unreachable == ()


def test_the_circle_diagram_of_the_four_bar() -> None:
    """Example 6.2: I13 from the triangles with 2 and 4, I24 from those with 1 and 3."""
    study = Study(load(EXAMPLES / "four_bar.toml"), 8)
    assert study.design.drive.is_linkage
    steps = {step.key: [t.third for t in step.triangles] for step in study.centres.construction.steps}
    assert steps == {("frame", "link3"): ["link2", "link4"], ("link2", "link4"): ["frame", "link3"]}


def test_the_circle_diagram_of_the_slider_crank() -> None:
    """Example 6.3: the same triangles; I14 is a direction, known at sight."""
    study = Study(load(EXAMPLES / "slider_crank.toml"), 8)
    assert study.design.drive.is_linkage
    table = study.centres
    assert ("frame", "link4") in table.primary
    assert table.centre("frame", "link4").is_far(table.size).all()
    assert table.centre("frame", "link4").direction == pytest.approx(0.5 * math.pi)
    steps = {step.key: [t.third for t in step.triangles] for step in table.construction.steps}
    assert steps == {("frame", "link3"): ["link2", "link4"], ("link2", "link4"): ["frame", "link3"]}


def crossing(a: complex, b: complex, c: complex, d: complex) -> complex:
    """Where the lines ab and cd cross, by Cramer's rule at fifty digits."""
    a, b, c, d = (MP.mpc(z) for z in (a, b, c, d))
    u, v, w = b - a, d - c, c - a
    t = (MP.conj(w) * v).imag / (MP.conj(u) * v).imag
    return a + t * u


@pytest.mark.parametrize("degrees", [7.0, 45.0, 130.0, 222.0, 301.0])
def test_four_bar_centres_are_where_its_lines_cross(degrees: float) -> None:
    design = four_bar(100.0, 30.0, 90.0, 70.0)
    kinematics = unit_speed_kinematics(
        design.drive.mechanism, np.array([math.radians(degrees)]), driver_ranges_of(design.drive.mechanism)
    )
    table = all_centres(kinematics, 0.1)
    o2, o4 = 0j, 0.1 + 0j
    a, b = (complex(kinematics.bodies["link3"].point(name)[0, 0]) for name in "AB")
    for (i, j), exact in {(1, 3): crossing(o2, a, o4, b), (2, 4): crossing(o2, o4, a, b)}.items():
        assert abs(centre(table, i, j) - complex(exact)) <= 1e-12 * (0.1 + abs(complex(exact)))
    for (i, j), at in {(1, 2): o2, (1, 4): o4, (2, 3): a, (3, 4): b}.items():
        assert abs(centre(table, i, j) - at) <= 1e-16


@pytest.mark.parametrize("degrees", [7.0, 45.0, 130.0, 222.0, 301.0])
@pytest.mark.parametrize("offset", [0.0, 12.0])
def test_slider_crank_centres_are_where_its_lines_cross(degrees: float, offset: float) -> None:
    """I13 above the slider's pin, I24 above the crank's pivot, on lines across the guide."""
    design = slider_crank(40.0, 140.0, offset)
    kinematics = unit_speed_kinematics(
        design.drive.mechanism, np.array([math.radians(degrees)]), driver_ranges_of(design.drive.mechanism)
    )
    table = all_centres(kinematics, 0.14)
    a, b = (complex(kinematics.bodies["link3"].point(name)[0, 0]) for name in "AB")
    for (i, j), exact in {(1, 3): crossing(0j, a, b, b + 1j), (2, 4): crossing(0j, 1j, a, b)}.items():
        assert abs(centre(table, i, j) - complex(exact)) <= 1e-12 * (0.1 + abs(complex(exact)))


def test_velocity_ratios_with_directed_distances_are_the_lectures() -> None:
    """ω4/ω2 = (I12I24)/(I14I24), ω3/ω2 = (I12I23)/(I13I23): 6.4."""
    study = six_bar()
    table = study.centres
    for n in (3, 4, 5):
        by_centres = float(angular_ratio(table, body_name(n), "link2")[0])
        assert by_centres == pytest.approx(measured()[f"w{n}"] / 60.0, rel=1e-13)
        assert float(mechanical_advantage(table, body_name(n), "link2")[0]) == pytest.approx(
            1.0 / by_centres, rel=1e-13
        )
    assert angular_ratio(table, "link6", "link2")[0] == 0.0
    i24 = centre(table, 2, 4)
    assert float(angular_ratio(table, "link4", "link2")[0]) == pytest.approx(
        (i24 - 0.0).real / (i24 - 0.06).real, rel=1e-13
    )


def test_velocity_differences_of_the_six_bar() -> None:
    """Velocity, p. 3: V_P = V_A + V_PA. At fifty digits, from the angles 45 and 60 deg alone [cm/s]."""
    study = six_bar()
    polygon = velocity_polygon(study.linkage)
    told = {side.end[0] + side.start[0]: complex(side.vector[0]) * study.omega / CM for side in polygon.sides}
    e = lambda degrees: MP.expj(MP.mpf(degrees) * MP.pi / 180)  # noqa: E731
    a, b, c, d = 2 * e(45), 6 + 4 * e(60), 6 + 6 * e(60), MP.mpf(12)
    v_a = MP.mpc(0, 1) * 2 * MP.pi * a
    # the coupler keeps its length: V_B - V_A is across B - A, and V_B across the rocker
    w4 = (v_a * MP.conj(b - a)).real / (MP.mpc(0, 1) * (b - 6) * MP.conj(b - a)).real
    v_b, v_c = (MP.mpc(0, 1) * w4 * (p - 6) for p in (b, c))
    v_d = (v_c * MP.conj(d - c)).real / MP.conj(d - c).real  # along the guide
    exact = {"A": v_a, "B": v_b, "C": v_c, "D": v_d, "BA": v_b - v_a, "CB": v_c - v_b, "DC": v_d - v_c}
    assert set(told) == set(exact)
    for name, value in exact.items():
        assert abs(told[name] - complex(value)) <= 1e-13 * 25.0, name
    assert told["D"] == pytest.approx(-22.39, abs=0.02)


def test_the_lectures_way_through_the_six_bar() -> None:
    """P. 11: ω3 from the crank by I23, ω4 by I34, ω5 by I45, v6 by I56, each by two distances as printed [cm]."""
    table = six_bar().centres
    chain = link_by_link(table, "link2")
    assert chain == (("link3", "link2"), ("link4", "link3"), ("link5", "link4"), ("link6", "link5"))
    arms = [ratio_arms(table, body, base) for body, base in chain]
    lengths = [(float(r.base_arm[0]) / CM, float(r.body_arm[0]) / CM) for r in arms]
    printed = [(2.0, -(20.07 - 2.0)), (16.39 - 4.0, -4.0), (6.0, -6.0)]
    for told, print_ in zip(lengths, printed, strict=False):
        assert told == pytest.approx(print_, abs=0.02)
    assert lengths[3] == (pytest.approx(6.0 * math.sqrt(3.0), rel=1e-13), math.inf)


def test_the_command_prints_the_printed_figures(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["centres", str(SIX_BAR), "--angle", "45"]) == 0
    told = json.loads(capsys.readouterr().out)
    speeds = {n: w / RPM for n, w in told["angular_velocity_rad_s"].items()}
    assert {n: round(w, 6) for n, w in speeds.items()} == {
        "1": 0.0,
        "2": 60.0,
        "3": -6.638493,
        "4": 20.566558,
        "5": -20.566558,
        "6": 0.0,
    }
    assert told["centres"]["1,6"] == {"direction_deg": 90.0}
    x, y = told["centres"]["1,3"]
    assert math.hypot(x, y) == pytest.approx(200.76391, abs=1e-5)
    assert len(told["centres"]) == 15
    assert told["velocity_ratios"]["4,3"] == pytest.approx(
        {"ratio": -3.098076, "base_arm_mm": 123.923048, "body_arm_mm": -40.0}, abs=1e-6
    )
    slide = next(row for row in told["velocity_differences"] if row["kind"] == "sliding")
    assert (slide["link"], slide["on"], slide["from"], slide["to"]) == (6, 1, "D", "D")
    assert slide["v_difference_mm_s"] == pytest.approx([-223.82166, 0.0], abs=1e-5)
    assert told["points"]["D"] == pytest.approx(
        {"x_mm": 120.0, "y_mm": 0.0, "vx_mm_s": -223.82166, "vy_mm_s": 0.0}, abs=1e-5
    )


def test_the_suspensions_axle_turns_about_where_its_arms_meet_and_steers() -> None:
    """The wheel moves across the line to I13: where that does not lie level with it, a bump pushes it along the car."""
    study = Study(load(EXAMPLES / "rear_suspension.toml"), 36)
    assert study.design.drive.is_linkage
    bodies = study.linkage.bodies
    lower, upper, wheel = bodies["link2"], bodies["link4"], bodies["link3"].point("W")
    pole = study.centres.centre("frame", "link3").finite
    for i in range(1, 36, 5):
        exact = crossing(
            *(complex(p[0, i]) for p in (lower.point("O2"), lower.point("A"), upper.point("O4"), upper.point("B")))
        )
        assert abs(pole[i] - complex(exact)) <= 1e-11 * abs(complex(exact))
        arm = wheel[0, i] - pole[i]
        assert abs((wheel[1, i] * arm.conjugate()).real) <= 1e-12 * abs(wheel[1, i]) * abs(arm)
    assert np.ptp(wheel[0].imag) > 0.1, "over a bump of more than 100 mm"
    assert np.ptp(wheel[0].real) > 0.01, "the wheel goes more than 10 mm along the car"


def test_the_axle_steers_by_what_two_intersected_circles_say() -> None:
    """Both wheels from the lengths of the example: A on its circle about O2, B where two circles meet, W beside them; the other wheel
    with its arm at rest, and as far the other way."""
    lower, upper, carrier, held = 480.0, 340.0, complex(30.0, 160.0), complex(-90.0, 190.0)

    def wheel(turned: float) -> complex:
        a = lower * np.exp(1j * np.radians(182.0 + turned))
        way = held - a
        part = (abs(carrier) ** 2 - upper**2 + abs(way) ** 2) / (2.0 * abs(way))
        sides = [
            a + way / abs(way) * complex(part, side * np.sqrt(abs(carrier) ** 2 - part**2)) for side in (1.0, -1.0)
        ]
        b = max(sides, key=lambda z: z.imag)
        return complex(a + complex(20.0, 60.0) * (b - a) / carrier)

    def cycloid(u: float) -> float:
        return u - math.sin(2.0 * math.pi * u) / (2.0 * math.pi)

    claim = claim_at("velocity", "p. 12")
    track = claim.numbers["track"]
    rows = {name: np.asarray(column) for name, column in zip(claim.table.names, claim.table.columns, strict=True)}
    arms = {
        30.0: -9.0 * cycloid(1 / 3),
        90.0: -9.0,
        150.0: 18.0 * cycloid(1 / 3) - 9.0,
        285.0: 9.0 - 9.0 * cycloid(1 / 6),
    }
    for angle, turned in arms.items():
        here, there = wheel(turned), wheel(-turned)
        row = {name: float(column[rows["driver_angle_deg"] == angle][0]) for name, column in rows.items()}
        standing, opposite = (math.degrees(math.atan((here - other).real / track)) for other in (wheel(0.0), there))
        assert (row["along_mm"], row["up_mm"]) == pytest.approx((here.real, here.imag), abs=1e-9)
        assert (row["steer_other_standing_deg"], row["steer_opposite_bump_deg"]) == pytest.approx(
            (standing, opposite), abs=1e-9
        )
