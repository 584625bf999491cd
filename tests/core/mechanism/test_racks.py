"""A second input that slides: a rack led by its pinion, a pinion led by its rack, a slide on an arm; against closed forms and power."""

import math
from pathlib import Path

import numpy as np
import pytest

from core.design import Design, faults, get
from core.errors import DesignError
from core.mechanism.drivers import wheel_pairs
from core.mechanism.unfinished import mobility
from core.project import dumps, load, loads, save
from core.study import Study, certificate_of, extremes_of, findings_of, many, quantity

LED = """
format = 1
name = "Rack"

[motion]
{start}

[linkage]
driver = {{ link = 2, kind = "motion" }}

[[linkage.drivers]]
{row}

[[linkage.links]]
number = 1
points = {{ O = [0.0, 0.0], Q = [0.0, 80.0] }}
[[linkage.links]]
number = {turns}
points = {{ O = [0.0, 0.0], P = [20.0, 0.0] }}
[[linkage.links]]
number = {slides}
points = {{ A = [10.0, 5.0] }}
[[linkage.links]]
number = 4
points = {{ A = [0.0, 0.0], B = [120.0, 0.0] }}
[[linkage.links]]
number = 5
points = {{ Q = [0.0, 0.0], B = [70.0, 0.0] }}

[[linkage.sliders]]
link = {slides}
on = {on}
through = [0.0, -20.0]
angle_deg = 10.0

[[loads.masses]]
link = {slides}
mass_kg = 2.0
centre = [4.0, 3.0]
[[loads.masses]]
link = {turns}
mass_kg = 0.3
inertia_kg_m2 = 2e-4
centre = [20.0, 0.0]
[[loads.masses]]
link = 4
mass_kg = 0.5
inertia_kg_m2 = 1e-3
[[loads.forces]]
link = 5
point = "B"
x_n = 10.0
y_n = -20.0
"""
TO_AND_FRO = """start_{unit} = {start}
[[motion.segments]]
law = "cycloidal"
span_deg = 180.0
rise_{unit} = {rise}
[[motion.segments]]
law = "3-4-5"
span_deg = 180.0
rise_{unit} = -{rise}"""
RACK = """link = 3
on = 1
kind = "rack"
"""
LINE = np.exp(1j * math.radians(10.0))


def led(row: str = RACK + "radius_mm = [20.0, 0.0]\noffset_mm = 30.0", *, pinion: bool = False, on: int = 1) -> Design:
    """A rack led by its pinion, which turns through 90°; pinion: the rack leads, and goes 30 mm."""
    motion = TO_AND_FRO.format(
        **({"unit": "mm", "start": 25.0, "rise": 30.0} if pinion else {"unit": "deg", "start": -40.0, "rise": 90.0})
    )
    numbers = {"turns": 3, "slides": 2} if pinion else {"turns": 2, "slides": 3}
    return loads(LED.format(start=motion, row=row, on=on, **numbers))


def balanced(design: Design) -> Study:
    """A study whose driver gives what masses and the load take, from where the links are; every proof is kept."""
    assert faults(design) == []
    study = Study(design, 360)
    kinematics, omega = study.linkage, study.omega
    power = -((10.0 + 20.0j) * kinematics.bodies["link5"].position("B", 1) * omega).real
    for mass in design.drive.loads.masses:
        body = kinematics.bodies[f"link{mass.link}"]
        at = body.fixed_point(complex(mass.centre_x_mm, mass.centre_y_mm) * 1e-3)
        force = mass.mass_kg * (at[2] * omega**2 + 9.80665j)
        power += (force.conj() * at[1] * omega).real + mass.inertia_kg_m2 * body.turn[2] * body.turn[1] * omega**3
    given = study.dynamics.driver * kinematics.motion.displacement[1] * omega
    assert np.abs(given - power).max() <= 1e-12 * np.abs(power).max()
    proof = certificate_of(study)
    assert all(residual.kept for residual in proof.values()), proof
    for rows in study.free_bodies.values():
        assert np.abs(sum(row.force for row in rows)).max() <= 1e-11 * max(np.abs(row.force).max() for row in rows)
    return study


def test_a_pinion_leads_a_rack_and_what_hangs_on_it(tmp_path: Path) -> None:
    design = led()
    save(design, tmp_path / "rack.toml")
    assert load(tmp_path / "rack.toml") == design
    study = balanced(design)
    kinematics = study.linkage
    q, rack = kinematics.motion.displacement, kinematics.bodies["link3"]
    assert np.abs(rack.origin[0] - (-0.02j + LINE * (0.02 * q[0] + 0.03))).max() < 1e-16
    assert np.abs(rack.origin[3] - 0.02 * LINE * q[3]).max() < 1e-15
    a = rack.origin[0] + (0.01 + 0.005j) * LINE
    b = kinematics.bodies["link4"].position("B")
    assert np.abs(np.abs(b - a) - 0.12).max() < 1e-15
    # what pushes the rack is what its mass and the rod ask along the line
    inertia = 2.0 * (rack.fixed_point(0.004 + 0.003j)[2] * study.omega**2 + 9.80665j)
    rod = study.dynamics.pairs["A"] * (1.0 if kinematics.pairs["A"].on == "link3" else -1.0)
    push = ((inertia + rod) * LINE.conjugate()).real
    given = quantity("link3_input_force").value(study)
    assert given == pytest.approx(push, abs=1e-12 * float(np.abs(push).max()))
    assert {f.code for f in findings_of(study)} == set()
    assert mobility(design.drive.linkage).is_finished


def test_a_ratio_below_0_has_the_pinion_on_the_other_side_and_teeth_say_the_radius() -> None:
    for row, ratio in (
        ("teeth = [16, 0]\nmodule_mm = 2.5", 1.0),
        ("radius_mm = [20.0, 0.0]\nratio = -0.3490658503988659", -1.0),
    ):
        design = led(RACK + "offset_mm = 30.0\n" + row)
        rack = Study(design, 36).linkage.bodies["link3"]
        q = Study(design, 36).linkage.motion.displacement
        assert np.abs(rack.origin[1] - 0.02 * ratio * LINE * q[1]).max() < 1e-15
        (pair,) = wheel_pairs(design.drive.linkage)
        assert (pair.first.point, pair.first.radius, pair.along) == ("O", 20.0, pytest.approx(ratio * LINE))


def test_a_rack_leads_its_pinion() -> None:
    study = balanced(led('link = 3\non = 1\nkind = "rack"\nradius_mm = [0.0, 40.0]\noffset_deg = 15.0', pinion=True))
    s = study.linkage.motion.displacement
    pinion = study.linkage.bodies["link3"]
    assert np.abs(pinion.turn[0] - s[0] / 0.04 - math.radians(15.0)).max() < 1e-15
    assert np.abs(pinion.turn[2] - s[2] / 0.04).max() < 1e-13
    torque = extremes_of(study, "dynamics", ("link3_input_torque",))["link3_input_torque"]
    assert torque.high.value > 0.0 > torque.low.value


def test_a_link_slides_along_an_arm_that_turns() -> None:
    study = balanced(led("link = 3\non = 2\nratio = 0.1\noffset_mm = 40.0", on=2))
    q, arm = study.linkage.motion.displacement, study.linkage.bodies["link2"]
    there = np.exp(1j * q[0]) * (-0.02j + LINE * (0.1e-3 * np.rad2deg(q[0]) + 0.04))
    assert np.abs(study.linkage.bodies["link3"].origin[0] - there).max() < 1e-16
    assert np.abs(study.linkage.bodies["link3"].turn[1] - arm.turn[1]).max() == 0.0


def test_many_racks_are_as_each_alone() -> None:
    radii = np.array([18.0, 20.0, 22.0])
    design, path = led(), "linkage.drivers[0].radius_first_mm"
    assert get(design, path) == 20.0
    found = many(design, {path: radii}, ["driver_torque_nm:max", "link3_input_force_n:max"])
    for i, radius in enumerate(radii):
        alone = Study(led(RACK + f"radius_mm = [{radius}, 0.0]\noffset_mm = 30.0"))
        for column, name in (("driver_torque_nm", "driver_torque"), ("link3_input_force_n", "link3_input_force")):
            high = extremes_of(alone, "dynamics", (name,))[name].high.value
            assert found.value[f"{column}:max"][i] == pytest.approx(high, rel=1e-9)
    assert list(found.reason) == ["", "", ""]


@pytest.mark.parametrize(
    ("row", "said"),
    [
        (RACK, r"drivers\[0\]\.ratio.* missing.*radius_mm, or teeth and module_mm, of the pinion, and 0 of the rack"),
        (RACK + "radius_mm = [20.0, 0.0]\nratio = 1.0", r"drivers\[0\]\.ratio = 1.*another ratio"),
        (RACK + "radius_mm = [0.0, 20.0]", r"drivers\[0\]\.radius_mm.*0 is the radius of the link that turns.*\[pinion, 0\]"),
        (RACK + "radius_mm = [20.0, 0.0]\noffset_deg = 5.0", r"drivers\[0\]\.offset_deg = 5.*link 3 slides.*offset_mm"),
        ("link = 3\non = 1\nkind = \"gear\"\nteeth = [20, 40]", r"drivers\[0\]\.kind = .gear.*link 3 slides.*rack"),
    ],
)  # fmt: skip
def test_a_row_that_is_no_rack_is_a_fault_of_one_line(row: str, said: str) -> None:
    with pytest.raises(DesignError, match=said):
        led(row)


def test_a_file_of_gears_is_written_as_it_was() -> None:
    assert "offset_mm" not in dumps(led(RACK + "radius_mm = [20.0, 0.0]"))
