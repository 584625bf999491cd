"""Springs, dampers, torsion springs, friction of pairs and process forces, in every kind of design."""

import cmath
import copy
import math
import tomllib
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core import followers
from core.design import (
    FOLLOWER_LINKS,
    Design,
    faults,
    get,
    load_lists,
    with_assumed,
    with_new_row,
    with_rows_in_order,
)
from core.dynamics import imbalance
from core.errors import DesignError, NoStability
from core.output.channels import channels
from core.output.report import report
from core.project import dumps, from_table
from core.study import Study, certificate_of, extremes_of, findings_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
SAMPLES = 72

BETWEEN = {  # example -> a spring and a torsion spring, friction, and process forces that it can have
    "slider_crank": {
        "springs": [{"from": {"link": 1, "at": [150.0, 60.0]}, "to": {"link": 3, "at": [70.0, 9.0]}}],
        "torsion_springs": [{"link": 3, "on": 1}],
        "pair_friction": [
            {"pair": "A", "radius_mm": 9.0},
            {"pair": "4", "length_mm": 40.0},
            {"pair": "O2", "radius_mm": 12.0},
        ],
        "process": [
            {
                "link": 4,
                "point": "B",
                "direction_deg": 20.0,
                "force_n": -300.0,
                "cam_from_deg": 310.0,
                "cam_to_deg": 25.0,
            },
            {"link": 3, "points": [[10.0, 2.0], [95.0, -3.0], [200.0, 1.0]]},
        ],
    },
    "transfer_lift": {
        "springs": [{"from": {"link": 1, "point": "pivot"}, "to": {"link": 4, "point": "slider_pin"}}],
        "torsion_springs": [{"link": 3, "on": 2}],
        "pair_friction": [{"pair": "pivot", "radius_mm": 40.0}, {"pair": "slider_pin", "radius_mm": 30.0}],
        "process": [{"force_n": -4000.0, "position_from_mm": 20.0, "position_to_mm": 90.0}],
    },
    "card_picker": {
        "springs": [{"from": {"link": 1, "at": [30.0, 10.0]}, "to": {"link": 2, "point": "roller"}}],
        "torsion_springs": [],
        "pair_friction": [],
        "process": [{"force_n": -40.0, "cam_from_deg": 60.0, "cam_to_deg": 300.0}],
    },
    "rocker_cam": {
        "springs": [{"from": {"link": 1, "at": [30.0, 160.0]}, "to": {"link": 2, "at": [20.0, 5.0]}}],
        "torsion_springs": [{"link": 2, "on": 1, "free_angle_deg": 210.0}],
        "pair_friction": [{"pair": "pivot", "radius_mm": 8.0}],
        "process": [{"torque_nm": -4.0, "position_from_deg": 3.0, "position_to_deg": 9.0}],
    },
    "rocker_flat": {  # its face rubs on the cam
        "springs": [{"from": {"link": 1, "at": [30.0, 160.0]}, "to": {"link": 2, "at": [20.0, 5.0]}}],
        "torsion_springs": [{"link": 2, "on": 1, "free_angle_deg": 130.0}],
        "pair_friction": [{"pair": "pivot", "radius_mm": 8.0}],
        "process": [{"points": [[0.0, -1.0], [120.0, -4.0], [360.0, -1.0]]}],
    },
}
SPRING = {"rate_n_per_mm": 3.0, "free_length_mm": 35.0, "damping_n_s_per_mm": 0.04}
TORSION = {"rate_nm_per_rad": 60.0, "free_angle_deg": 12.0, "damping_nm_s_per_rad": 0.7}


@lru_cache(maxsize=32)
def _example(name: str) -> dict[str, Any]:
    return tomllib.loads((EXAMPLES / f"{name}.toml").read_text(encoding="utf-8"))


def table(name: str, **loads: Any) -> dict[str, Any]:
    """The tables of an example with these entries of its loads."""
    made = copy.deepcopy(_example(name))
    made["assumed"] = []
    made.setdefault("loads", {}).update(loads)
    return made


def design(name: str, **loads: Any) -> Design:
    return from_table(table(name, **loads))


@lru_cache(maxsize=8)
def full(name: str) -> Study:
    """An example with all that it can have."""
    rows = BETWEEN[name]
    loads: dict[str, Any] = {"process": rows["process"]}
    loads["springs"] = [row | SPRING for row in rows["springs"]]
    loads["torsion_springs"] = [TORSION | row for row in rows["torsion_springs"]]
    loads["pair_friction"] = [row | {"coefficient": 0.06} for row in rows["pair_friction"]]
    return Study(design(name, **loads), SAMPLES)


# -- in every kind of design -----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", BETWEEN)
def test_every_element_balances_and_survives_its_file(name: str) -> None:
    study = full(name)
    assert dumps(from_table(tomllib.loads(dumps(study.design)))) == dumps(study.design)
    for code, residual in certificate_of(study, ("dynamics",)).items():
        assert residual.value <= 1e-12, code
    powers = [row for row in channels(study.design, ("dynamics",)) if row.slug.endswith("_power_w")]
    elements = study.design.drive.loads
    count = sum(len(getattr(elements, key)) for key in ("springs", "torsion_springs", "process", "pair_friction"))
    assert len(powers) >= count
    rubbed = [row.values(study) for row in powers if row.slug.startswith("friction")]
    assert all(power.max() <= 0.0 > power.min() for power in rubbed)
    # what drive, weight and elements give raises the kinetic energy
    assert {"drive_power_w", "gravity_power_w"} <= {row.slug for row in powers}
    cam = np.linspace(3.0, 5.9, 7)
    energy = next(row for row in channels(study.design) if row.slug == "kinetic_energy_j")
    step = 1e-5
    here, before, after = (study.at_theta(cam + d) for d in (0.0, -step, step))
    rise = (energy.values(after) - energy.values(before)) / (2.0 * step) * study.omega
    given = sum(row.values(here) for row in powers)
    assert np.abs(given - rise).max() <= 1e-6 * np.abs([row.values(here) for row in powers]).max()


@pytest.mark.parametrize("name", BETWEEN)
def test_all_that_acts_on_a_body_is_nothing_together(name: str) -> None:
    """Forces and moments of every body, inertia included; what the channels name stands among them."""
    study = full(name)
    bodies = study.free_bodies
    assert set(bodies) - {"cam"} == set(study.linkage.bodies) - {"frame", "roller"}
    for body, rows in bodies.items():
        force, moment = imbalance(rows)
        largest = max(np.abs(row.force).max() for row in rows)
        arms = max((np.abs(row.at) * np.abs(row.force) + np.abs(row.couple)).max() for row in rows)
        assert force.max() <= 1e-13 * largest, body
        left = study.dynamics.torque if body == "cam" else 0.0  # is what turns the camshaft
        assert np.abs(moment + left).max() <= 1e-13 * arms, body
    acting = [row for rows in bodies.values() for row in rows]
    assert {row.kind for row in acting} >= {"reaction", "friction", "spring", "weight", "inertia"} - (
        {"friction"} if name == "card_picker" else set()
    )
    for element in ("spring1", "process1"):
        power = next(row for row in channels(study.design) if row.slug == f"{element}_power_w").values(study)
        poses = study.linkage.bodies
        given = np.zeros(SAMPLES)
        for row in acting:
            if row.name == element:
                pose = poses[row.body]
                speed = pose.origin[1] + 1j * pose.turn[1] * (row.at - pose.origin[0])
                given += ((row.force * speed.conj()).real + row.couple * pose.turn[1]) * study.omega
        assert given == pytest.approx(power, abs=1e-12 * np.abs(power).max())


@pytest.mark.parametrize("name", BETWEEN)
def test_potentials_are_those_of_the_lengths(name: str) -> None:
    """V' and V'' of every spring against differences of k (l - l0)²/2 and k (φ - φ0)²/2; V'' of every element against V'."""
    study, cam, step = full(name), np.linspace(0.35, 5.4, 6), 1e-5
    at = [study.at_theta(cam + d * step).linkage for d in (-1.0, 0.0, 1.0)]
    for row in study.loading.named.values():
        first, second = row.potential(at[1])
        scale = np.abs(first).max() + np.abs(second).max()
        slope = [row.potential(k)[0] for k in (at[0], at[2])]
        assert np.abs((slope[1] - slope[0]) / (2.0 * step) - second).max() <= 1e-6 * scale, row.name
        if row.name.startswith(("spring", "torsion")):
            size = [row.angle(k) if row.name[0] == "t" else np.abs(row.between(k)) - row.length for k in at]
            low, middle, high = (0.5 * row.rate * s * s for s in size)
            assert np.abs((high - low) / (2.0 * step) - first).max() <= 1e-6 * scale, row.name
            assert middle.max() > 0.0


@pytest.mark.parametrize("name", ["transfer_lift", "card_picker", "rocker_cam", "rocker_flat"])
def test_a_followers_links_are_those_that_it_builds(name: str) -> None:
    drive = design(name).drive
    built, known = followers.built(drive.mechanism, drive.cam), FOLLOWER_LINKS[type(drive.mechanism)]
    assert {n: set(points) for n, (_, points) in known.links.items()} == {
        n: set(points) for n, points in built.plan.points.items()
    }
    joints = {name: (joint.revolute, {joint.first.link, joint.second.link}) for joint, name in built.pair_names.items()}
    assert joints == {name: (pin, set(links)) for name, (pin, links) in known.pairs.items()}
    assert all(built.bodies.get(n, "frame") == body for n, (body, _) in known.links.items())


def test_a_torsion_spring_about_the_pivot_is_the_closing_spring() -> None:
    """Its free angle is one of the global frame: 0.5 rad beyond the arm in the base position, from the triangle 90, 57, |P| mm."""
    pivot, reach, arm = complex(95.0, 30.0), 45.0 + 12.0, 90.0
    cosine = (arm**2 + abs(pivot) ** 2 - reach**2) / (2.0 * arm * abs(pivot))
    base = cmath.phase(-pivot * cmath.exp(-1j * math.acos(cosine)))
    own = Study(design("rocker_cam", spring_rate_nm_per_rad=40.0, preload_nm=20.0), SAMPLES)
    spring = {"link": 2, "on": 1, "rate_nm_per_rad": 40.0, "free_angle_deg": math.degrees(base + 0.5)}
    other = Study(design("rocker_cam", spring_rate_nm_per_rad=0.0, preload_nm=0.0, torsion_springs=[spring]), SAMPLES)
    assert other.dynamics.contact == pytest.approx(own.dynamics.contact, rel=1e-12)
    assert other.dynamics.pairs["pivot"] == pytest.approx(own.dynamics.pairs["pivot"], rel=1e-12)


def test_a_spring_of_points_along_the_guide_is_the_closing_spring() -> None:
    closing = Study(design("card_picker", spring_rate_n_per_mm=2.0, preload_n=30.0), SAMPLES)
    roller = complex(closing.linkage.bodies["follower"].position("roller")[0])  # in the dwell at 0
    spring = {"from": {"link": 1, "at": [0.0, 1e3 * roller.imag - 85.0]}, "to": {"link": 2, "point": "roller"}}
    rows = [spring | {"rate_n_per_mm": 2.0, "free_length_mm": 70.0}]
    pulled = Study(design("card_picker", springs=rows, spring_rate_n_per_mm=0.0, preload_n=0.0), SAMPLES)
    for name in ("contact", "torque"):
        one, other = getattr(closing.dynamics, name), getattr(pulled.dynamics, name)
        assert np.abs(one - other).max() <= 1e-12 * np.abs(one).max()


# -- against forces found otherwise ----------------------------------------------------------------------------


def newton_euler_by_hand(theta: float, omega: float) -> tuple[float, np.ndarray]:
    """Torque and reactions of a slider-crank r = 40, l = 140 mm, whose rod and slider have mass, with a spring and a damper from a
    fixed place to a place beside the slider, friction in the coupler's pin and of a long slide; nine equations of three bodies."""
    from scipy.optimize import root

    r, size, m3, i3, m4 = 0.040, 0.140, 0.6, 0.0013, 0.5
    s, c = math.sin(theta), math.cos(theta)
    beta = -math.asin(r * s / size)
    b1 = -r * c / (size * math.cos(beta))  # by the crank's angle
    b2 = (r * s + size * math.sin(beta) * b1 * b1) / (size * math.cos(beta))
    x1 = -r * s - size * math.sin(beta) * b1
    x2 = -r * c - size * (math.cos(beta) * b1 * b1 + math.sin(beta) * b2)
    pin, joint = r * complex(c, s), r * complex(c, s) + size * complex(math.cos(beta), math.sin(beta))
    g = 45.0 / 140.0
    mass = (1.0 - g) * pin + g * joint
    a3 = omega**2 * ((1.0 - g) * -pin + g * x2)
    held, end = complex(0.21, 0.05), joint.real + 0.02j
    d = end - held
    length = abs(d)
    pull = 4000.0 * (length - 0.06) + 50.0 * (d.real * x1 * omega) / length
    spring = -pull * d / length
    slip, sliding = np.sign(omega * (b1 - 1.0)), np.sign(omega * x1)

    def equations(v: np.ndarray) -> list[float]:
        a, b = complex(v[0], v[1]), complex(v[2], v[3])  # by the crank on the rod, by the rod on the slider
        normal, couple, o, torque = v[4], v[5], complex(v[6], v[7]), v[8]
        rub = 0.12 * 0.006 * abs(a) * slip
        slide = 0.09 * (abs(normal / 2 + couple / 0.05) + abs(normal / 2 - couple / 0.05)) * sliding
        rod = a - b - 0.6j * 9.80665 - m3 * a3
        turn = ((pin - mass).conjugate() * a - (joint - mass).conjugate() * b).imag - rub - i3 * b2 * omega**2
        block = b + spring + 1j * normal - slide - m4 * (9.80665j + x2 * omega**2) - 200.0
        about = couple + ((end - joint).conjugate() * spring).imag
        crank = o - a
        on_crank = torque - (pin.conjugate() * a).imag + rub
        return [rod.real, rod.imag, turn, block.real, block.imag, about, crank.real, crank.imag, on_crank]

    found = root(equations, np.ones(9), tol=1e-14).x
    assert np.abs(equations(found)).max() <= 1e-9
    return float(found[8]), found


def test_slider_crank_with_spring_damper_and_friction_against_nine_equations() -> None:
    held = {"from": {"link": 1, "at": [210.0, 50.0]}, "to": {"link": 4, "at": [0.0, 20.0]}}
    study = Study(
        design(
            "slider_crank",
            springs=[held | {"rate_n_per_mm": 4.0, "free_length_mm": 60.0, "damping_n_s_per_mm": 0.05}],
            pair_friction=[
                {"pair": "A", "coefficient": 0.12, "radius_mm": 6.0},
                {"pair": "4", "coefficient": 0.09, "length_mm": 50.0},
            ],
        )
    )
    cam = np.array([0.4, 1.3, 2.2, 3.0, 3.9, 4.6, 5.8])
    forces = study.at_theta(cam).dynamics
    for i, theta in enumerate(cam.tolist()):
        torque, found = newton_euler_by_hand(theta, study.omega)
        assert forces.driver[i] == pytest.approx(torque, rel=1e-9)
        assert forces.pairs["4"][i].imag == pytest.approx(found[4], rel=1e-8)
        assert forces.couples["4"][i] == pytest.approx(found[5], rel=1e-8)


# -- over the turn ---------------------------------------------------------------------------------------------


def torque_on_crank(**row: Any) -> Study:
    loads = {"masses": [], "forces": [], "gravity_m_s2": 0.0, "process": [{"link": 2, **row}]}
    return Study(design("slider_crank", **loads), 360)


def test_a_torque_over_a_part_of_the_turn_jumps_where_it_switches() -> None:
    study = torque_on_crank(torque_nm=-5.0, cam_from_deg=300.25, cam_to_deg=45.0)
    degrees = study.angle_degrees
    on = (degrees >= 300.25) | (degrees < 45.0)
    assert np.abs(study.shaft_torque - np.where(on, 5.0, 0.0)).max() <= 1e-15
    assert study.load_curve.mean == pytest.approx(5.0 * 104.75 / 360.0, rel=1e-13)
    assert extremes_of(study, "dynamics", ("driver_torque",))["driver_torque"].high.value == pytest.approx(
        5.0, rel=1e-14
    )


def test_a_table_is_linear_and_periodic() -> None:
    rows = [[30.0, 1.0], [90.0, 7.0], [200.0, -2.0]]
    study = torque_on_crank(points=rows)
    at, values = zip(*rows, strict=True)
    expected = np.interp(study.angle_degrees, at, values, period=360.0)
    assert np.abs(study.shaft_torque + expected).max() <= 1e-13
    found = extremes_of(study, "dynamics", ("driver_torque",))["driver_torque"]
    assert (found.low.value, math.degrees(found.low.theta)) == pytest.approx((-7.0, 90.0), rel=1e-12)
    mean = (60.0 * 4.0 + 110.0 * 2.5 + 190.0 * -0.5) / 360.0
    assert study.load_curve.mean == pytest.approx(-mean, rel=1e-12)


def test_a_force_against_position_switches_at_the_roots_of_the_motion() -> None:
    none = {"follower_mass_kg": 0.0, "friction": 0.0, "spring_rate_n_per_mm": 0.0, "preload_n": 0.0}
    study = Study(
        design("card_picker", **none, process=[{"force_n": -50.0, "position_from_mm": 5.0, "position_to_mm": 12.5}]),
        720,
    )
    y = 1e3 * study.motion.displacement[0]
    on = (y >= 5.0) & (y <= 12.5)
    expected = np.where(on, 50.0 * study.motion.displacement[1], 0.0)
    assert np.abs(study.dynamics.torque - expected).max() <= 1e-14
    assert abs(study.load_curve.mean) <= 1e-15  # what the rise takes the return gives
    swing = study.flywheel.energy_swing
    assert swing == pytest.approx(50.0 * 0.0075, rel=1e-12)


# -- stability -------------------------------------------------------------------------------------------------

ELASTIC = {"camshaft_inertia_kg_m2": 0.02, "stiffness_nm_per_rad": 900.0}


def flexible(**loads: Any) -> Study:
    made = table("card_picker", **loads)
    made["shaft"] |= ELASTIC
    return Study(from_table(made), SAMPLES)


def test_springs_enter_stability_and_dampers_and_friction_do_not() -> None:
    spring = {"from": {"link": 1, "at": [0.0, 300.0]}, "to": {"link": 2, "point": "roller"}, "rate_n_per_mm": 2.0}
    plain, sprung = flexible().flexible_shaft(), flexible(springs=[spring]).flexible_shaft()
    damped = flexible(springs=[spring | {"damping_n_s_per_mm": 3.0}]).flexible_shaft()
    rows = [each.coefficients.panels.values[2] for each in (plain, sprung, damped)]
    assert np.abs(rows[1] - rows[0]).max() > 1e-3
    assert (rows[1] == rows[2]).all()


def test_a_force_that_switches_in_motion_leaves_no_word_on_stability() -> None:
    with pytest.raises(NoStability, match="switches while") as caught:
        flexible(process=[{"force_n": -50.0, "cam_from_deg": 100.0, "cam_to_deg": 200.0}]).flexible_shaft()
    assert caught.value.field == "loads.process"
    flexible(process=[{"force_n": -50.0, "cam_from_deg": 340.0, "cam_to_deg": 20.0}]).flexible_shaft()


# -- bad designs -----------------------------------------------------------------------------------------------

HELD = {"link": 1, "at": [10.0, 0.0]}
WRONG = [
    ("slider_crank", "springs", {"from": {"link": 1, "point": "O2"}, "to": {"link": 2, "point": "O2"}}, "to.point", "no length"),
    ("slider_crank", "springs", {"from": HELD, "to": {"link": 1, "point": "O2"}}, "to.link", "one link"),
    ("slider_crank", "springs", {"from": HELD, "to": {"link": 4, "point": "C"}}, "to.point", "B | at"),
    ("slider_crank", "springs", {"from": HELD, "to": {"link": 7, "point": "B"}}, "to.link", "no such link"),
    ("slider_crank", "springs", {"from": HELD, "to": {"link": 4}}, "to.point", "is missing"),
    ("slider_crank", "springs", {"from": HELD}, "to", "missing"),
    ("transfer_lift", "springs", {"from": HELD, "to": {"link": 5, "point": "B"}}, "to.link", "3 (rod)"),
    ("rocker_cam", "torsion_springs", {"link": 2, "on": 2}, "on", "relative to itself"),
    ("slider_crank", "pair_friction", {"pair": "C", "coefficient": 0.1}, "pair", "O2 | A | B | 4"),
    ("slider_crank", "pair_friction", {"pair": "A", "coefficient": 0.1}, "radius_mm", "of the pin"),
    ("slider_crank", "pair_friction", {"pair": "4", "coefficient": 0.1, "radius_mm": 3.0}, "radius_mm", "is a slide"),
    ("slider_crank", "pair_friction", {"pair": "A", "links": [2, 4], "coefficient": 0.1, "radius_mm": 3.0}, "links", "[2, 3]"),
    ("transfer_lift", "pair_friction", {"pair": "guide", "coefficient": 0.1}, "pair", "Guide friction = 0.1"),
    ("card_picker", "process", {"force_n": 1.0}, "cam_from_deg", "the time at which it acts"),
    ("card_picker", "process", {"force_n": 1.0, "cam_from_deg": 10.0}, "cam_to_deg", "missing"),
    ("card_picker", "process", {"force_n": 1.0, "cam_from_deg": 10.0, "cam_to_deg": 10.0}, "cam_to_deg", "never acts"),
    ("card_picker", "process", {"force_n": 1.0, "position_from_mm": 9.0, "position_to_mm": 2.0}, "position_to_mm", "> 9 mm"),
    ("rocker_cam", "process", {"torque_nm": 1.0, "position_from_mm": 1.0, "position_to_mm": 2.0}, "position_from_mm", "_deg"),
    ("rocker_cam", "process", {"force_n": 1.0, "cam_from_deg": 1.0, "cam_to_deg": 2.0}, "force_n", "torque_nm"),
    ("card_picker", "process", {"points": [[0.0, 1.0], [90.0, 2.0], [360.0, 3.0]]}, "points[2].value", "not closed"),
    ("card_picker", "process", {"points": [[50.0, 1.0], [40.0, 2.0]]}, "points[1].deg", "not sorted"),
    ("slider_crank", "process", {"force_n": 1.0, "cam_from_deg": 1.0, "cam_to_deg": 2.0}, "link", "2 | 3 | 4"),
    ("slider_crank", "process", {"link": 4, "point": "B", "force_n": 1.0, "cam_from_deg": 1.0, "cam_to_deg": 2.0}, "direction_deg",
     "has a direction"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("name", "rows", "row", "path", "says"), WRONG, ids=[f"{w[1]}-{w[3]}-{i}" for i, w in enumerate(WRONG)]
)
def test_what_cannot_act_is_named(name: str, rows: str, row: dict[str, Any], path: str, says: str) -> None:
    with pytest.raises(DesignError) as caught:
        design(name, **{rows: [row]})
    assert [fault.path for fault in caught.value.faults] == [f"loads.{rows}[0].{path}"]
    assert says in str(caught.value)


@pytest.mark.parametrize(
    ("rows", "code", "field"),
    [
        ({"springs": [{"from": {"link": 1, "point": "O2"}, "to": {"link": 2, "point": "A"}, "damping_n_s_per_mm": 1.0}]},
         "damper-still", "loads.springs[0].damping_n_s_per_mm"),
        ({"springs": [{"from": {"link": 1, "at": [140.0, 40.0]}, "to": {"link": 3, "point": "B"}, "rate_n_per_mm": 1.0}]}, None, ""),
        ({"springs": [{"from": {"link": 1, "at": [140.0, 0.0]}, "to": {"link": 4, "point": "B"}, "rate_n_per_mm": 1.0,
                       "free_length_mm": 9.0}]}, "spring-ends-meet", "loads.springs[0]"),
        ({"springs": [{"from": {"link": 1, "at": [0.0, 0.0]}, "to": {"link": 2, "point": "O2"}, "rate_n_per_mm": 1.0}]},
         "spring-no-length", "loads.springs[0]"),
        ({"torsion_springs": [{"link": 3, "on": 1}]}, "spring-idle", "loads.torsion_springs[0]"),
        ({"torsion_springs": [{"link": 2, "on": 1, "rate_nm_per_rad": 1.0}]}, "spring-winds-up", "loads.torsion_springs[0]"),
        ({"torsion_springs": [{"link": 4, "on": 1, "rate_nm_per_rad": 1.0}]}, "torsion-still", "loads.torsion_springs[0]"),
        ({"pair_friction": [{"pair": "A", "coefficient": 0.1, "radius_mm": 2.0}, {"pair": "B", "coefficient": 3.0, "radius_mm": 90.0}]},
         "pair-jamming", "loads.pair_friction[1].coefficient"),
    ],
)  # fmt: skip
def test_findings_name_the_element(rows: dict[str, Any], code: str | None, field: str) -> None:
    found = findings_of(Study(design("slider_crank", **rows), SAMPLES), ("dynamics",))
    assert [(f.code, f.field) for f in found] == ([] if code is None else [(code, field)])
    assert all(f.message for f in found)


def test_the_report_names_every_row_with_where_it_holds_on() -> None:
    text = report(full("rocker_cam"))
    for title in (
        "Spring 1: frame at (30, 160) – arm at (20, 5)",
        "Torsion spring 1: arm – frame",
        "Friction at pivot",
        "Process force 1: output, along its motion",
    ):
        assert f"\n{title}\n" in text
    assert "\nForce at C of link 3\n" in report(
        Study(design("four_bar", forces=[{"link": 3, "point": "C", "x_n": 5.0}]), 12)
    )


def test_a_process_force_that_never_works_is_named() -> None:
    rows = [
        {"force_n": -4.0, "position_from_mm": 200.0, "position_to_mm": 300.0},
        {"force_n": -4.0, "position_from_mm": 19.9, "position_to_mm": 300.0},
        {"cam_from_deg": 10.0, "cam_to_deg": 10.001, "force_n": 2.0},
        {"cam_from_deg": 10.0, "cam_to_deg": 50.0},
        {"points": [[0.0, 0.0], [90.0, 0.0]]},
    ]
    found = [
        f
        for f in findings_of(Study(design("card_picker", process=rows), SAMPLES), ("dynamics",))
        if f.code.startswith("process")
    ]
    assert {f.field: f.code for f in found} == {
        "loads.process[0]": "process-never",
        "loads.process[3]": "process-idle",
        "loads.process[4]": "process-idle",
    }
    assert all("process force" in f.message for f in found)


def test_a_torsion_spring_comes_where_a_link_turns() -> None:
    assert "torsion_springs" not in load_lists(design("card_picker").drive)
    kept = design("card_picker", torsion_springs=[{"link": 2, "on": 1, "rate_nm_per_rad": 1.0}])
    assert "torsion_springs" in load_lists(kept.drive), "so that it can be taken away"
    assert "torsion-still" in [finding.code for finding in findings_of(Study(kept, SAMPLES), ("dynamics",))]
    for name, link in (("slider_crank", 3), ("transfer_lift", 3), ("rocker_cam", 2)):
        assert get(with_new_row(design(name), "loads.torsion_springs"), "loads.torsion_springs[0].link") == link


# -- edits -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [*BETWEEN, "lecture_six_bar", "four_bar_coupler_cam"])
def test_new_rows_act_at_once_and_leave_as_they_came(name: str) -> None:
    made = before = design(name, friction=0.0) if name in ("transfer_lift", "card_picker") else design(name)
    paths = [f"loads.{key}" for key in load_lists(made.drive) if key != "masses" or not made.drive.loads.masses]
    for path in paths:
        made = with_new_row(made, path)
        assert faults(made) == [], path
    made = with_assumed(with_rows_in_order(made, "loads.springs", (0, 0)), "loads.springs[1].rate_n_per_mm", True)
    for residual in certificate_of(Study(made, 36), ("dynamics",)).values():
        assert residual.kept
    made = with_rows_in_order(made, "loads.springs", (1,))
    assert "loads.springs[0].rate_n_per_mm" in made.assumed
    for path in paths:
        made = with_rows_in_order(made, path, range(len(get(before, path))))
    assert made == before
