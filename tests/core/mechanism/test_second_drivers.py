"""A second input by a ratio: gears, planets, an arm on an arm; against closed forms, and by what power flows through them."""

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linkages import four_bar, link

from core.__main__ import main
from core.design import (
    MOTION,
    Design,
    Drawn,
    Drive,
    Driver,
    Linkage,
    LinkageLoads,
    LinkForce,
    LinkMass,
    LinkPoint,
    Motion,
    NamedCurve,
    NamedMotion,
    SecondDriver,
    Segment,
    Side,
    faults,
    get,
    of_motion,
    put,
    with_drive,
)
from core.errors import NoPosition
from core.mechanism.unfinished import mobility
from core.project import load, save
from core.study import Study, certificate_of, extremes_of, findings_of, many, quantity

FIVE_BAR = (
    link(1, O2=(0, 0), O5=(60, 0)),
    link(2, O2=(0, 0), A=(20, 0)),
    link(3, A=(0, 0), C=(50, 0)),
    link(4, B=(0, 0), C=(45, 0)),
    link(5, O5=(0, 0), B=(15, 0)),
)
LOADS = LinkageLoads(
    masses=tuple(
        LinkMass(link=n, mass_kg=0.1 * n, inertia_kg_m2=1e-4, centre_x_mm=10.0, centre_y_mm=3.0) for n in (2, 3, 4, 5)
    ),
    forces=(LinkForce(link=4, point="C", x_n=7.0, y_n=-5.0, torque_nm=0.3),),
)


def five_bar(**second: object) -> Design:
    row = SecondDriver(link=5, **second)  # type: ignore[arg-type]
    linkage = Linkage(FIVE_BAR, (), Driver(2), (Side("C", 1),), None, (row,))
    return Design("geared five-bar", None, (Drive(None, linkage, None, LOADS),))


def planet(ratio: float | None = None, **wheels: object) -> Design:
    """An arm of 30 mm, on it a planet with a point P, 30 mm from its centre."""
    links = (link(1, O=(0, 0)), link(2, O=(0, 0), A=(30, 0)), link(3, A=(0, 0), P=(30, 0)))
    row = SecondDriver(link=3, on=2, ratio=ratio, **wheels)  # type: ignore[arg-type]
    loads = LinkageLoads(masses=(LinkMass(link=3, mass_kg=2.0, inertia_kg_m2=1e-3, centre_x_mm=4.0),))
    return Design("planet", None, (Drive(None, Linkage(links, (), Driver(2), (), None, (row,)), None, loads),))


@pytest.mark.parametrize(
    ("ratio", "offset", "turns"), [(-1.0, 120.0, 1), (2.0, 30.0, 1), (-0.5, 10.0, 2), (2 / 3, 20.0, 3)]
)
def test_a_geared_five_bar_closes_after_its_turns_and_its_coupler_point_is_where_two_circles_meet(
    ratio: float, offset: float, turns: int, tmp_path: Path
) -> None:
    design = five_bar(ratio=ratio, offset_deg=offset)
    assert faults(design) == []
    save(design, tmp_path / "gears.toml")
    assert load(tmp_path / "gears.toml") == design
    assert main(["export", str(tmp_path / "gears.toml"), "--out", str(tmp_path), "--samples", "240"]) == 0
    with (tmp_path / "linkage.csv").open(encoding="utf-8") as file:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    assert len(rows) == 240
    assert rows[60]["driver_angle_deg"] == pytest.approx(90.0 * turns, abs=1e-10)
    for row in rows:
        q = math.radians(row["driver_angle_deg"])
        a = 20.0 * np.exp(1j * q)
        b = 60.0 + 15.0 * np.exp(1j * (ratio * q + math.radians(offset)))
        c = complex(row["C_x_mm"], row["C_y_mm"])
        assert abs(abs(c - a) - 50.0) < 1e-11
        assert abs(abs(c - b) - 45.0) < 1e-11
        assert ((b - a).conjugate() * (c - a)).imag > 0.0
    assert not [f for f in findings_of(Study(design)) if f.code in ("no-common-period",)]
    first, last = rows[0], rows[-1]
    assert math.hypot(first["C_x_mm"] - last["C_x_mm"], first["C_y_mm"] - last["C_y_mm"]) < 10.0


@pytest.mark.parametrize(("ratio", "offset"), [(-1.0, 120.0), (2.0, 30.0), (-0.5, 10.0)])
def test_the_driver_gives_what_masses_and_loads_take(ratio: float, offset: float) -> None:
    """T ω = d(kinetic energy)/dt - power of gravity and of the load, all from where the links are."""
    study = Study(five_bar(ratio=ratio, offset_deg=offset), 360)
    kinematics, omega = study.linkage, study.omega
    power = np.zeros(360)
    for mass in LOADS.masses:
        body = kinematics.bodies[f"link{mass.link}"]
        at = body.fixed_point(complex(mass.centre_x_mm, mass.centre_y_mm) * 1e-3)
        v, a = at[1] * omega, at[2] * omega**2
        force = mass.mass_kg * (a + 9.80665j)
        power += (force.conj() * v).real + mass.inertia_kg_m2 * body.turn[2] * omega**2 * body.turn[1] * omega
    coupler = kinematics.bodies["link4"]
    power -= ((7.0 + 5.0j) * coupler.position("C", 1) * omega).real + 0.3 * coupler.turn[1] * omega
    speed = 2.0 * math.pi
    torque = study.dynamics.driver
    assert np.abs(torque * speed - power).max() <= 1e-12 * np.abs(power).max()
    body, pin = kinematics.bodies["link5"], kinematics.bodies["link5"].position("O5")
    mass = LOADS.masses[-1]
    at = body.fixed_point(complex(mass.centre_x_mm, mass.centre_y_mm) * 1e-3)
    inertia = mass.mass_kg * (at[2] * omega**2 + 9.80665j)
    rod = study.dynamics.pairs["B"]  # by link 5 on link 4
    turning = mass.inertia_kg_m2 * body.turn[2] * omega**2 + ((at[0] - pin).conj() * inertia).imag
    given = quantity("link5_input_torque").value(study)
    turning += ((body.position("B") - pin).conj() * rod).imag * (1.0 if kinematics.pairs["B"].on == "link5" else -1.0)
    assert given == pytest.approx(turning, abs=1e-12 * float(np.abs(given).max()))
    for rows in study.free_bodies.values():
        moment = sum(row.couple + (row.at.conj() * row.force).imag for row in rows)
        size = max(float(np.abs(row.couple).max() + np.abs(row.at * row.force).max()) for row in rows)
        assert np.abs(moment).max() <= 1e-12 * size
    proof = certificate_of(study)
    assert all(residual.kept for residual in proof.values()), proof


def test_a_link_led_by_a_motion_leads_another_by_a_ratio(tmp_path: Path) -> None:
    """As drawn, under a motion of the driver: where two circles meet; the driver gives what the masses and the load take."""
    design = five_bar(ratio=-0.5, offset_deg=100.0)
    spans = (Segment(40.0, 0.0), Segment(140.0, 90.0, NamedCurve("cycloidal")), Segment(180.0, -90.0, NamedCurve("c2")))
    drawn = Drawn(points=(LinkPoint("C", 40.0, 55.0),))
    linkage = replace(design.drive.linkage, driver=Driver(2, MOTION, 60.0), branch=(), drawn=drawn)
    design = with_drive(design, mechanism=linkage, motion=Motion(20.0, spans, "deg"))
    assert faults(design) == []
    save(design, tmp_path / "led.toml")
    assert load(tmp_path / "led.toml") == design
    study = Study(design, 360)
    kinematics, omega = study.linkage, study.omega
    q = kinematics.motion.displacement
    a, b = 0.02 * np.exp(1j * q[0]), 0.06 + 0.015 * np.exp(1j * (-0.5 * q[0] + math.radians(100.0)))
    c = kinematics.bodies["link4"].position("C")
    assert np.abs(np.abs(c - a) - 0.05).max() < 1e-15
    assert np.abs(np.abs(c - b) - 0.045).max() < 1e-15
    assert c.imag.min() > 0.03
    power = -((7.0 + 5.0j) * kinematics.bodies["link4"].position("C", 1) * omega).real
    power -= 0.3 * kinematics.bodies["link4"].turn[1] * omega
    for mass in LOADS.masses:
        body = kinematics.bodies[f"link{mass.link}"]
        at = body.fixed_point(complex(mass.centre_x_mm, mass.centre_y_mm) * 1e-3)
        force = mass.mass_kg * (at[2] * omega**2 + 9.80665j)
        power += (force.conj() * at[1] * omega).real + mass.inertia_kg_m2 * body.turn[2] * body.turn[1] * omega**3
    given = study.dynamics.driver * q[1] * omega
    assert np.abs(given - power).max() <= 1e-12 * np.abs(power).max()
    assert all(residual.kept for residual in certificate_of(study).values())


def test_cardan_circles_draw_a_straight_line_and_the_wheels_say_the_ratio(tmp_path: Path) -> None:
    rings = planet(kind="internal", teeth_first=48, teeth_second=24)
    save(rings, tmp_path / "rings.toml")
    assert "teeth = [48, 24]" in (tmp_path / "rings.toml").read_text("utf-8").replace("48.0", "48")
    for design in (planet(-2.0), load(tmp_path / "rings.toml")):
        path = Study(design, 360).linkage.bodies["link3"].position("P")
        assert np.abs(path.imag).max() < 1e-12 * 0.06
        assert np.abs(path.real - 0.06 * np.cos(np.deg2rad(np.arange(360.0)))).max() < 1e-12 * 0.06
    wrong = planet(-1.0, kind="internal", teeth_first=48, teeth_second=24)
    assert [fault.path for fault in faults(wrong)] == ["linkage.drivers[0].ratio"]


def test_an_arm_on_an_arm_measured_against_the_frame_keeps_its_angle() -> None:
    """Ratio 0 against the frame: a platform that does not turn."""
    design = planet(0.0)
    row = replace(design.drive.linkage.drivers[0], on=1)
    still = with_drive(design, mechanism=replace(design.drive.linkage, drivers=(row,)))
    study = Study(still, 90)
    assert np.abs(study.linkage.bodies["link3"].angle[0]).max() < 1e-15
    arm = 30e-3 * np.cos(study.theta)
    assert study.dynamics.driver == pytest.approx(2.0 * 9.80665 * arm, abs=1e-12)


@pytest.mark.parametrize(
    ("wheels", "gap"),
    [
        ({"kind": "gear", "teeth_first": 20, "teeth_second": 40, "module_mm": 2.0}, None),
        ({"kind": "gear", "teeth_first": 20, "teeth_second": 40, "module_mm": 1.9}, (3.0, "apart")),
        ({"kind": "gear", "radius_first_mm": 21.0, "radius_second_mm": 42.0}, (3.0, "into each other")),
        ({"kind": "internal", "radius_first_mm": 90.0, "radius_second_mm": 30.0}, None),
        ({"kind": "internal", "radius_first_mm": 90.0, "radius_second_mm": 45.0}, (15.0, "into each other")),
        ({"kind": "belt", "radius_first_mm": 10.0, "radius_second_mm": 20.0}, None),
    ],
)
def test_wheels_that_do_not_touch_are_said(wheels: dict[str, object], gap: tuple[float, str] | None) -> None:
    """Centres 60 mm apart: two wheels touch at r1 + r2 = 60, a ring and its pinion at r1 - r2 = 60."""
    found = [f for f in findings_of(Study(five_bar(**wheels), 24), ("linkage",)) if f.code == "wheels-apart"]
    assert [(f.severity, f.field) for f in found] == ([("warning", "linkage.drivers[0]")] if gap else [])
    if gap:
        assert (found[0].values["gap"], found[0].values["how"]) == (pytest.approx(gap[0]), gap[1])
        assert f"{gap[0]:.3g} mm {gap[1]}" in found[0].message


def test_no_common_period_is_said_and_a_pin_too_few_is_a_fault() -> None:
    found = findings_of(Study(five_bar(ratio=-math.sqrt(2.0)), 90))
    assert [f.severity for f in found if f.code == "no-common-period"] == ["note"]
    bar = four_bar(60.0, 20.0, 50.0, 40.0)
    over = with_drive(bar, mechanism=replace(bar.drive.linkage, drivers=(SecondDriver(link=4, ratio=1.0),)))
    assert faults(over) == []
    with pytest.raises(NoPosition, match="too many"):
        _ = Study(over, 24).linkage
    assert mobility(five_bar(ratio=-1.0).drive.linkage).is_finished
    unsaid = five_bar()
    assert [fault.path for fault in faults(unsaid)] == ["linkage.drivers[0].ratio"]


def test_many_designs_with_a_second_input_are_as_each_alone() -> None:
    design = five_bar(ratio=-1.0, offset_deg=120.0)
    offsets = np.array([110.0, 125.0])
    found = many(
        design, {"linkage.drivers[0].offset_deg": offsets}, ["driver_torque_nm:max", "link5_input_torque_nm:min"]
    )
    for i, offset in enumerate(offsets):
        alone = Study(put(design, "linkage.drivers[0].offset_deg", float(offset)))
        extremes = extremes_of(alone, "dynamics", ("driver_torque", "link5_input_torque"))
        assert found.value["driver_torque_nm:max"][i] == pytest.approx(extremes["driver_torque"].high.value, rel=1e-9)
        least = extremes["link5_input_torque"].low.value
        assert found.value["link5_input_torque_nm:min"][i] == pytest.approx(least, rel=1e-9)
    assert list(found.reason) == ["", ""]


FEED = Motion(100.0, (Segment(40.0, 0.0), Segment(140.0, 60.0, NamedCurve("cycloidal")),
                      Segment(180.0, -60.0, NamedCurve("modified-sine"))), "deg")  # fmt: skip


def test_a_second_input_follows_its_own_motion_and_both_inputs_give_what_the_links_take(tmp_path: Path) -> None:
    """The coupler point is where two circles meet about the crank's end and that of the arm, which goes by its own motion; each
    input's torque times its speed makes up the power, d(kinetic energy)/dt less that of gravity and load."""
    design = five_bar(motion="feed", offset_deg=5.0)
    linkage = replace(design.drive.linkage, motions=(NamedMotion("feed", FEED),))
    design = with_drive(design, mechanism=linkage)
    assert faults(design) == []
    save(design, tmp_path / "feed.toml")
    text = (tmp_path / "feed.toml").read_text("utf-8")
    assert 'motion = "feed"' in text
    assert "[motions.feed]" in text
    assert load(tmp_path / "feed.toml") == design
    assert get(design, "motions.feed.segments[1].rise_deg") == 60.0
    study = Study(design, 360)
    assert study.turns == 1
    kinematics, omega = study.linkage, study.omega
    q = study.theta
    part = np.clip((np.rad2deg(q) - 40.0) / 140.0, 0.0, 1.0)
    back = Study(of_motion(FEED, "feed", 60.0), 360).motion.y[0]
    arm = math.radians(105.0) + math.radians(60.0) * (part - np.sin(2.0 * np.pi * part) / (2.0 * np.pi))
    arm = np.where(q < np.pi, arm, back + math.radians(5.0))
    body = kinematics.bodies["link5"]
    assert np.abs(np.exp(1j * body.angle[0]) - np.exp(1j * arm)).max() < 1e-13
    rise = slice(41, 180)
    span = math.radians(140.0)
    rates = [(1.0 - np.cos(2.0 * np.pi * part)) / span, 2.0 * np.pi * np.sin(2.0 * np.pi * part) / span**2,
             4.0 * np.pi**2 * np.cos(2.0 * np.pi * part) / span**3]  # fmt: skip
    for order, rate in enumerate(rates, 1):
        assert body.turn[order][rise] == pytest.approx(math.radians(60.0) * rate[rise], abs=1e-12)
    c = kinematics.bodies["link4"].position("C")
    assert np.abs(np.abs(c - 0.02 * np.exp(1j * q)) - 0.05).max() < 1e-15
    assert np.abs(np.abs(c - 0.06 - 0.015 * np.exp(1j * arm)) - 0.045).max() < 1e-14
    power = -((7.0 + 5.0j) * kinematics.bodies["link4"].position("C", 1) * omega).real
    power -= 0.3 * kinematics.bodies["link4"].turn[1] * omega
    for mass in LOADS.masses:
        each = kinematics.bodies[f"link{mass.link}"]
        at = each.fixed_point(complex(mass.centre_x_mm, mass.centre_y_mm) * 1e-3)
        force = mass.mass_kg * (at[2] * omega**2 + 9.80665j)
        power += (force.conj() * at[1] * omega).real + mass.inertia_kg_m2 * each.turn[2] * each.turn[1] * omega**3
    arms = quantity("link5_input_torque").value(study) * body.turn[1] * omega
    assert np.abs(arms).max() > 0.01 * np.abs(power).max()
    assert np.abs(study.dynamics.driver * omega + arms - power).max() <= 1e-12 * np.abs(power).max()
    proof = certificate_of(study)
    assert all(residual.kept for residual in proof.values()), proof
    joins = {round(math.degrees(at), 9) for at in study.program.starts}
    assert {0.0, 40.0, 180.0} <= joins
    assert main(["report", str(tmp_path / "feed.toml"), "--out", str(tmp_path / "feed.html")]) == 0


def test_a_motion_that_is_not_there_or_that_nothing_follows_is_a_fault() -> None:
    assert [fault.path for fault in faults(five_bar(motion="feed"))] == ["linkage.drivers[0].motion"]
    idle = five_bar(ratio=1.0)
    idle = with_drive(idle, mechanism=replace(idle.drive.linkage, motions=(NamedMotion("feed", FEED),)))
    assert [fault.path for fault in faults(idle)] == ["motions.feed"]
