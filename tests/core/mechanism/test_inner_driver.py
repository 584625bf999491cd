"""A driver between two moving links: a cylinder under a boom, a motor on an arm; against closed forms, and by power."""

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linkages import link

from core.__main__ import main
from core.design import (
    CRANK,
    MOTION,
    NO_DRIVER,
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
    Segment,
    Slider,
    faults,
    put,
    with_drive,
)
from core.errors import NoPosition
from core.linkage_programs import read_linkage
from core.mechanism.drawing_edits import with_driving_link, without
from core.mechanism.drivers import circuits, with_drawn_pose, with_signs
from core.mechanism.unfinished import mobility
from core.project import load, save
from core.study import Study, certificate_of, extremes_of, findings_of, many

G = 9.80665
LAW = NamedCurve("cycloidal")


def boom() -> Design:
    """A boom of 600 mm on O2, held up by a cylinder from O3 that goes from 600 to 800 mm."""
    links = (
        link(1, O2=(0, 0), O3=(400, -200)),
        link(2, O2=(0, 0), B=(600, 0), T=(1500, 0)),
        link(3, O3=(0, 0), S=(300, 0)),
        link(4, B=(0, 0)),
    )
    masses = (
        LinkMass(link=2, mass_kg=50.0, inertia_kg_m2=4.0, centre_x_mm=700.0, centre_y_mm=20.0),
        LinkMass(link=3, mass_kg=8.0, inertia_kg_m2=0.1, centre_x_mm=150.0),
        LinkMass(link=4, mass_kg=5.0, inertia_kg_m2=0.1, centre_x_mm=-100.0),
    )
    motion = Motion(600.0, (Segment(60.0, 0.0), Segment(120.0, 200.0, LAW), Segment(180.0, -200.0, LAW)), "mm")
    drawn = Drawn(points=(LinkPoint("B", 500.0, 300.0),))
    driver = Driver(4, MOTION, 10.0, on=3)
    rows = LinkageLoads(masses=masses, forces=(LinkForce(link=2, point="T", y_n=-1000.0),))
    return Design(
        "boom", None, (Drive(motion, Linkage(links, (Slider(link=4, on=3),), driver, (), drawn), None, rows),)
    )


def test_a_boom_is_where_the_cosine_rule_has_it_and_the_cylinder_does_its_work(tmp_path: Path) -> None:
    design = boom()
    assert faults(design) == []
    assert mobility(design.drive.linkage).is_finished
    save(design, tmp_path / "boom.toml")
    assert load(tmp_path / "boom.toml") == design
    assert "on = 3" in (tmp_path / "boom.toml").read_text("utf-8")
    study = Study(design, 180)
    length = study.linkage.motion.displacement[0]
    base = 0.4 - 0.2j
    between = np.arccos((0.6**2 + abs(base) ** 2 - length**2) / (2.0 * 0.6 * abs(base)))
    assert np.abs(study.linkage.bodies["link2"].angle[0] - np.angle(base) - between).max() < 1e-12
    assert all(residual.kept for residual in certificate_of(study).values())
    # what the cylinder gives: F l' = d(energy)/dt - power of weights and load, at the angle where it goes out fastest
    omega, bodies, power = study.omega, study.linkage.bodies, np.zeros(180)
    for mass in design.drive.loads.masses:
        body = bodies[f"link{mass.link}"]
        at = body.fixed_point(complex(mass.centre_x_mm, mass.centre_y_mm) * 1e-3)
        v, a = at[1] * omega, at[2] * omega**2
        power += (mass.mass_kg * (a + G * 1j).conj() * v).real
        power += mass.inertia_kg_m2 * body.turn[2] * body.turn[1] * omega**3
    power += 1000.0 * (bodies["link2"].position("T", 1) * omega).imag
    given = study.dynamics.driver * study.linkage.motion.displacement[1] * omega
    assert np.abs(given - power).max() <= 1e-12 * np.abs(power).max()
    # in the dwell: moments about O2 of a boom that stands; the cylinder's own weight is carried by both its pins
    still, rod = 0, study.linkage.bodies["link4"]
    along = rod.unit[still]
    for rows in study.free_bodies.values():
        assert abs(sum(row.force[still] for row in rows)) < 1e-9 * 1500.0
    push = study.dynamics.pairs["4"][still]
    assert abs((push * along.conjugate()).real) < 1e-9 * abs(push)  # the slide itself pushes across only


@pytest.mark.stress
def test_many_booms_are_as_each_alone() -> None:
    """Some whose cylinder does not reach give the reason that each alone gives."""
    design, path = boom(), "linkage.links[1].points.B.x_mm"
    reach = np.array([560.0, 600.0, 650.0, 1500.0])
    asked = ("driver_force_n:max", "driver_force_n:min")
    found = many(design, {path: reach}, list(asked))
    for i, at in enumerate(reach):
        study = Study(put(design, path, float(at)))
        if found.reason[i]:
            assert i == 3
            with pytest.raises(NoPosition):
                _ = study.linkage
            continue
        extremes = extremes_of(study, "dynamics", ("driver_force",))["driver_force"]
        wanted = (extremes.high.value, extremes.low.value)
        assert [found.value[q][i] for q in asked] == pytest.approx(wanted, rel=1e-9), at
    assert found.reason[3]


def test_a_motor_on_an_arm_turns_against_it(tmp_path: Path) -> None:
    """A four-bar led at the pin between crank and coupler: the relative angle runs as the motion says."""
    links = (
        link(1, O2=(0, 0), O4=(100, 0)),
        link(2, O2=(0, 0), A=(40, 0)),
        link(3, A=(0, 0), B=(90, 0)),
        link(4, O4=(0, 0), B=(70, 0)),
    )
    motion = Motion(-60.0, (Segment(90.0, 30.0, LAW), Segment(90.0, 0.0), Segment(180.0, -30.0, LAW)), "deg")
    drawn = Drawn(points=(LinkPoint("A", 0.0, 40.0), LinkPoint("B", 80.0, 65.0)))
    masses = LinkageLoads(masses=(LinkMass(link=3, mass_kg=1.0, inertia_kg_m2=1e-3, centre_x_mm=45.0),))
    linkage = Linkage(links, (), Driver(3, MOTION, 30.0, on=2), (), drawn)
    design = Design("arm", None, (Drive(motion, linkage, None, masses),))
    assert faults(design) == []
    study = Study(design, 120)
    turned = study.linkage.bodies["link3"].angle - study.linkage.bodies["link2"].angle
    wanted = study.linkage.motion.displacement
    for order in range(4):
        off = np.abs(
            turned[order]
            - wanted[order]
            - (2 * math.pi * round((turned[0][0] - wanted[0][0]) / 2 / math.pi) if not order else 0.0)
        )
        assert off.max() < 1e-11 * max(1.0, np.abs(np.asarray(wanted[order])).max())
    assert all(residual.kept for residual in certificate_of(study).values())
    assert [f.code for f in findings_of(study) if f.severity == "error"] == []
    save(design, tmp_path / "arm.toml")
    assert main(["export", str(tmp_path / "arm.toml"), "--out", str(tmp_path), "--samples", "36"]) == 0
    with (tmp_path / "linkage.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["link3_deg"]) - float(row["link2_deg"]) for row in rows] == pytest.approx(
        np.rad2deg(wanted[0])[::120 // 36 * 1][: len(rows)] if len(wanted[0]) == len(rows) else
        np.rad2deg(Study(design, 36).linkage.motion.displacement[0]), abs=1e-9,
    )  # fmt: skip
    with (tmp_path / "dynamics.csv").open(encoding="utf-8") as file:
        assert "driver_torque_nm" in next(csv.reader(file))


def test_what_cannot_drive_is_named() -> None:
    design = boom()
    linkage = design.drive.linkage
    for driver, path in (
        (Driver(4, MOTION, 10.0, on=9), "linkage.driver.on"),
        (Driver(4, MOTION, 10.0, on=4), "linkage.driver.on"),
        (Driver(4, MOTION, 10.0, on=2, ), "linkage.driver.link"),
        (Driver(4, CRANK, 10.0, on=3), "linkage.driver.kind"),
    ):  # fmt: skip
        made = with_drive(design, mechanism=replace(linkage, driver=driver))
        if driver.on == 2:  # pinned to it: that is a driver
            assert not [f for f in faults(made) if f.path == path]
        else:
            assert path in [f.path for f in faults(made)]


def test_signs_and_circuits_of_a_boom() -> None:
    design = boom()
    assert [c.is_current for c in circuits(design)] == [True, False]
    signed = with_signs(design)
    assert signed.drive.linkage.drawn is None
    one, other = (Study(each, 24).linkage.bodies["link2"].z for each in (design, signed))
    assert one == pytest.approx(other, abs=1e-12)


ACTUATOR = """<linkage2><program units="Millimeters" scalefactor="1"/>
<connector id="0" x="0" y="0" anchor="true"/><connector id="1" x="500" y="300"/>
<connector id="2" x="400" y="-200" anchor="true"/><connector id="3" x="900" y="500"/>
<Link id="0"><connector id="0"/><connector id="1"/><connector id="3"/></Link>
<Link id="1" actuator="true" throw="120" cpm="6"><connector id="2"/><connector id="1"/></Link></linkage2>"""


def test_an_actuator_of_linkage_drives_by_its_length() -> None:
    made = read_linkage(ACTUATOR)
    assert [each.what for each in made.left_out] == ["law of actuator 1"]
    assert made.inputs == ()
    assert faults(made.design) == []
    linkage = made.design.drive.linkage
    assert (linkage.driver.kind, linkage.driver.speed_rpm) == (MOTION, 6.0)
    study = Study(made.design, 36)
    b = study.linkage.bodies[study.linkage.body_of("C1")].position("C1")
    pixel = 25.4e-3 / 96.0
    way = 1.0 - np.abs(1.0 - study.theta / np.pi)  # out and back at constant speed
    length = pixel * (abs(100 + 500j) + 120.0 * way)
    assert np.abs(np.abs(b - pixel * (400 - 200j)) - length).max() < 1e-12
    assert np.abs(np.abs(b) - pixel * abs(500 + 300j)).max() < 1e-12
    driven = read_linkage(ACTUATOR.replace('id="0" x="0" y="0"', 'id="0" x="0" y="0" input="true"'))
    assert any("another input drives" in each.why for each in driven.left_out)


def test_a_cylinder_is_drawn_made_the_driver_and_taken_away() -> None:
    """As the tools of Draw do it: the rod is chosen to drive, rests where it is drawn, and goes with its tube."""
    drawn = with_drawn_pose(boom(), Study(boom(), 24).at_theta(np.zeros(1)).linkage)
    linkage = replace(drawn.drive.linkage, driver=NO_DRIVER)
    made = with_driving_link(with_drive(drawn, motion=None, mechanism=linkage), 4)
    driver = made.drive.linkage.driver
    assert (driver.link, driver.on, driver.kind) == (4, 3, MOTION)
    assert faults(made) == []
    assert made.drive.motion.start == pytest.approx(600.0, abs=1e-5)
    assert without(made, links=[3]).drive.linkage.driver == NO_DRIVER
