"""Linkages of other programs: joints stand where they were, stay as far apart on every link, and what is not carried over is listed."""

import csv
import json
from itertools import combinations
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from sampled import spread

from core.__main__ import main
from core.design import faults
from core.errors import DesignError
from core.linkage_programs import read_linkage
from core.project import load
from core.study import Study

JOINTS = (Path(__file__).parent / "pyslvs_joints.txt").read_text("utf-8").splitlines()
"""The examples of Pyslvs: type and angle, place and links of each joint."""
EXAMPLES = {row.split(" | ")[0]: [joint.split(" ") for joint in row.split(" | ")[1].split("; ")] for row in JOINTS}
FOUR_BAR = (
    "00.Fe.A,0.101.6A,A,0,0,0.0B,B,0,VG,0.0C,C,1E8,_W,0.4D,D,1Tm,0,0..YRAB,AB,Fe,Fe,0,0,808080,A,B,,."
    "YRBC,BC,Fe,Fe,0,0,808080,B,C,,.YRCD,CD,Fe,Fe,0,0,808080,C,D,,...Nb"
)
PIXEL = 25.4 / 96.0  # mm: the unit of .linkage2 files
LINKAGE2 = """<linkage2><program units="Millimeters" scalefactor="1"/>
 <connector id="0" x="0" y="0" anchor="true" input="true" rpm="30"/><connector id="1" x="20" y="0"/>
 <connector id="2" x="60" y="40"/><connector id="3" x="60" y="0" anchor="true"/>
 <Link id="0"><connector id="0"/><connector id="1"/></Link><Link id="1"><connector id="1"/><connector id="2"/></Link>
 <Link id="2"><connector id="2"/><connector id="3"/></Link></linkage2>"""


def expression(joints: list[list[str]]) -> str:
    texts = []
    for kind, place, links in joints:
        word, _, angle = kind.partition(":")
        slant = f"A[{angle}], " if angle else ""
        texts.append(f"J[{word}, {slant}color[Green], P[{place}], L[{links.replace('+', ', ')}]]")
    return f"M[{', '.join(texts)},]"


@pytest.mark.parametrize("name", spread([name for name in EXAMPLES if name != "Arm"], 4))
def test_pyslvs_joints_stand_as_read_and_every_link_stays_rigid(name: str) -> None:
    joints = EXAMPLES[name]
    made = read_linkage(expression(joints), name=name)
    assert made.joints == len(joints)
    assert faults(made.design) == []
    drawn = made.design.drive.linkage.drawn
    places = [complex(*map(float, place.split(","))) for _, place, _ in joints]
    size = max(abs(z - w) for z in places for w in places)
    points = drawn.places | made.design.drive.linkage.by_number[1].places
    assert all(points[f"P{i}"] == z for i, z in enumerate(places) if f"P{i}" in points)
    study = Study(made.design, 90)
    assert study.linkage.residual.max() < 1e-12
    kinematics = study.linkage
    curves = {n: kinematics.bodies[kinematics.body_of(n)].position(n) * 1e3 for n in points}
    on: dict[str, list[int]] = {}
    for i, (kind, _, links) in enumerate(joints):
        word, _, angle = kind.partition(":")
        names = links.split("+")
        for link in names[1:] if word == "RP" else names if word == "R" else ():
            on.setdefault(link, []).append(i)
        if word == "RP" and names[0] == "ground":
            across = (curves[f"P{i}"] - places[i]) * np.exp(-1j * np.deg2rad(float(angle)))
            assert np.abs(across.imag).max() < 1e-11 * size
    for rigid in on.values():
        for i, j in combinations(rigid, 2):
            apart = np.abs(curves[f"P{i}"] - curves[f"P{j}"])
            assert np.abs(apart - abs(places[i] - places[j])).max() < 1e-11 * size


def test_two_inputs_of_an_expression_turn_alike_and_it_is_said() -> None:
    places = ("0, 0], L[ground, a", "20, 0], L[a, b", "40, 60], L[b, c", "75, 0], L[c, d", "60, 0], L[ground, d")
    text = f"M[{', '.join(f'J[R, P[{place}]]' for place in places)}]"
    made = read_linkage("#[ geared #]\n" + text, inputs=("P0", "P4"))
    assert [(row.link, row.ratio) for row in made.design.drive.linkage.drivers] == [(5, 1.0)]
    assert "speed of P4" in {each.what for each in made.left_out}
    assert faults(made.design) == []


def test_wheels_of_linkage2_are_a_second_driver_that_stands_where_it_is_drawn() -> None:
    text = """<linkage2><program units="Millimeters"/><connector id="0" x="0" y="0" anchor="true" input="true" rpm="15"/>
    <connector id="1" x="20" y="0"/><connector id="2" x="40" y="60"/><connector id="3" x="60" y="15"/>
    <connector id="4" x="60" y="0" anchor="true"/>
    <Link id="0" gear="true"><connector id="0"/><connector id="1"/></Link><Link id="1"><connector id="1"/><connector id="2"/></Link>
    <Link id="2"><connector id="2"/><connector id="3"/></Link><Link id="3" gear="true"><connector id="3"/><connector id="4"/></Link>
    <ratios><ratio type="gears"><link id="0" size="1"/><link id="3" size="2"/></ratio></ratios></linkage2>"""
    made = read_linkage(text)
    assert made.left_out == ()
    assert [row.ratio for row in made.design.drive.linkage.drivers] == [-0.5]
    study = Study(made.design, 36)
    assert study.turns == 2
    pose = study.at_theta(np.zeros(1)).linkage
    at = {name: complex(pose.bodies[pose.body_of(name)].position(name)[0]) * 1e3 / PIXEL for name in ("C1", "C2", "C3")}
    assert at == pytest.approx({"C1": 20 + 0j, "C2": 40 + 60j, "C3": 60 + 15j}, abs=1e-9)


def test_the_pmks_template_is_as_written_and_its_checksum_is_held() -> None:
    made = read_linkage(f"https://app.pmksplus.com/?{FOUR_BAR}")
    linkage = made.design.drive.linkage
    assert (made.links, made.joints, linkage.driver.speed_rpm) == (4, 4, 10.0)
    assert linkage.drawn.places == {"B": 20j, "C": 50 + 40j}  # centimetres in the address
    assert linkage.by_number[1].places == {"A": 0j, "D": 60 + 0j}
    assert [each.what for each in made.left_out] == ["unit of masses"]
    assert Study(made.design, 36).linkage.residual.max() < 1e-12
    with pytest.raises(DesignError, match="checksum"):
        read_linkage(FOUR_BAR[:-1] + "c")


def test_masses_and_forces_of_pmks_stand_in_the_frames_of_their_links() -> None:
    """2 kg at (30, 30) cm on the crank A(0, 0)-B(0, 20) whose frame looks along y; 50 lbf to the left at (70, 60) of the coupler."""
    letters = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"

    def number(value: float) -> str:
        whole, digits = round(abs(value) * 1000), ""
        while whole:
            whole, digit = divmod(whole, 64)
            digits = (letters + "_-")[digit] + digits
        return ("0" if value < 0.0 else "") + (digits or "0")

    loads = [
        f"2F1,BC,F1,{','.join(map(number, (0.7, 0.6, 0.2, 0.6, 50.0)))}",
        f"3F2,BC,F2,0,0,{number(1.0)},0,{number(9.0)}",
    ]
    crank = f"YRAB,AB,{number(2.0)},{number(0.5)},{number(0.3)},{number(0.3)},808080,A,B,,"
    head, tail = FOUR_BAR[:-1].split("YRAB,AB,Fe,Fe,0,0,808080,A,B,,")
    body = (head + crank + tail).replace("A,0.101", "A,0.200").removesuffix("..N") + ".".join(["", *loads]) + "...N"
    made = read_linkage(body + letters[len(body) % 62])
    linkage, held = made.design.drive.linkage, made.design.drive.loads
    crank_mass = held.masses[0]
    assert linkage.by_number[crank_mass.link].places.keys() == {"A", "B"}
    assert (crank_mass.mass_kg, crank_mass.inertia_kg_m2) == (2.0, 0.5)
    assert (crank_mass.centre_x_mm, crank_mass.centre_y_mm) == pytest.approx((300.0, -300.0), abs=1e-9)
    (force,) = held.forces
    assert (force.x_n, force.y_n) == pytest.approx((-50.0 * 4.4482216152605, 0.0), abs=1e-9)
    assert linkage.drawn.places[force.point] == pytest.approx(700.0 + 600.0j, abs=1e-9)
    assert {"B", "C", force.point} == linkage.by_number[force.link].places.keys()
    assert [each.what for each in made.left_out] == ["unit of masses", "force F2"]
    study = Study(made.design, 36)
    assert study.linkage.residual.max() < 1e-12
    assert np.isfinite(study.dynamics.torque).all()


def test_a_pmks_slider_and_a_weld() -> None:
    rows = "6A,A,0,0,0.0B,B,Fe,0,0.8C,C,1Uy,0,0.0E,E,1Uy,VG,0.5D,D,1Uy,0,0"
    links = ".".join(
        f"Y{kind}{name},{name},0,0,0,0,808080,{','.join(joints)},,"
        for kind, name, joints in (
            ("R", "AB", "AB"), ("R", "BC", "BC"), ("R", "CE", "CE"), ("P", "S", "CD"),
        )
    )  # fmt: skip
    body = f"01.Fe.A,0.001.{rows}..{links}...N"
    letters = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
    pinned = read_linkage(body.replace("8C", "0C") + letters[len(body) % 62])
    assert pinned.links == 5
    assert pinned.design.drive.linkage.driver.speed_rpm == -10.0  # clockwise
    assert pinned.design.drive.linkage.sliders[0].on == 1
    welded = read_linkage(body + letters[len(body) % 62])
    assert welded.links == 3
    assert set(welded.design.drive.linkage.by_number[3].places) == {"B", "C", "E"}


def test_linkage2_with_a_slider_on_a_link_a_gear_and_an_actuator() -> None:
    made = read_linkage(LINKAGE2, mirror=True)
    assert (made.links, made.joints) == (4, 4)
    assert made.design.drive.linkage.driver.speed_rpm == 30.0
    assert made.design.drive.linkage.drawn.places["C2"] == pytest.approx((60 - 40j) * PIXEL, abs=1e-12)
    assert read_linkage(LINKAGE2, units="in").design.drive.linkage.drawn.places["C2"] == (60 + 40j) * 25.4
    slider = LINKAGE2.replace(
        '<connector id="2" x="60" y="40"/><connector id="3" x="60" y="0" anchor="true"/>',
        '<connector id="2" x="60" y="0" slider="true"><slidelimit id="3"/><slidelimit id="4"/></connector>'
        '<connector id="3" x="60" y="0" anchor="true"/><connector id="4" x="90" y="0" anchor="true"/>',
    ).replace('<Link id="2"><connector id="2"/><connector id="3"/></Link>', "")
    crank = read_linkage(slider)
    study = Study(crank.design, 36)
    c2 = study.linkage.bodies[study.linkage.body_of("C2")].position("C2") * 1e3
    a = study.linkage.bodies["link2"].position("C1") * 1e3
    assert np.abs(c2.imag).max() < 1e-12
    assert np.abs(np.abs(c2 - a) - 40.0 * PIXEL).max() < 1e-12
    curved = read_linkage(slider.replace('slider="true"', 'slider="true" slideradius="30"'))
    centre = curved.design.drive.linkage.by_number[1].places[
        "C2_centre"
    ]  # of an arc through (60, 0) and (90, 0), left of them
    assert centre == pytest.approx((75 + 1j * np.sqrt(30**2 - 15**2)) * PIXEL, abs=1e-12)
    driven = read_linkage(LINKAGE2.replace('<Link id="1">', '<Link id="1" actuator="true" throw="5">'))
    assert "actuator 1" in {each.what for each in driven.left_out}


def test_links_that_share_two_pins_are_one_plate() -> None:
    plate = LINKAGE2.replace("</linkage2>", '<connector id="5" x="30" y="60"/><Link id="7"><connector id="1"/>'
                             '<connector id="2"/><connector id="5"/></Link></linkage2>')  # fmt: skip
    made = read_linkage(plate)
    assert made.links == 4
    assert set(made.design.drive.linkage.by_number[3].places) == {"C1", "C2", "C5"}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<!DOCTYPE linkage2 [<!ENTITY a 'b'>]><linkage2/>", "DOCTYPE"),
        ("<linkage2><connector", "no XML"),
        ("M[J[R, P[0, nan], L[ground]]]", "are not numbers"),
        ("M[J[X, P[0, 0], L[ground]]]", "is unknown"),
        ("M[J[R, P[0, 0], L[ground, a]]", "after 0 joints"),
        ("hello world", "no address"),
    ],
)
def test_what_is_no_linkage_is_refused_in_one_line(text: str, said: str) -> None:
    with pytest.raises(DesignError, match=said) as refused:
        read_linkage(text)
    assert "\n" not in str(refused.value)


def test_the_commands_read_a_file_and_write_curves_and_poses(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bar.linkage2").write_text(LINKAGE2, "utf-8")
    design = str(tmp_path / "bar.toml")
    assert main(["linkage-from", str(tmp_path / "bar.linkage2"), "--out", design, "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"links": 4, "joints": 4, "left_out": []}
    assert load(design).name == "bar"
    assert main(["linkage-from", FOUR_BAR, "--out", str(tmp_path / "other.toml"), "--input", "D"]) == 0
    assert load(tmp_path / "other.toml").drive.linkage.driver.link == 4
    assert main(["curves", design, "--out", str(tmp_path / "c.csv"), "--points", "C2", "--samples", "12"]) == 0
    rows = list(csv.reader((tmp_path / "c.csv").read_text("utf-8").splitlines()))
    assert rows[0] == ["driver_angle_deg", "C2_x_mm", "C2_y_mm"]
    assert len(rows) == 13
    curve = np.array([[float(x), float(y)] for _, x, y in rows[1:]])
    assert np.abs(np.hypot(curve[:, 0] - 60.0 * PIXEL, curve[:, 1]) - 40.0 * PIXEL).max() < 1e-12
    for ending in ("dxf", "svg"):
        assert main(["curves", design, "--out", str(tmp_path / f"c.{ending}"), "--time-marks", "6"]) == 0
        assert main(["pose", design, "--angle", "0", "--out", str(tmp_path / f"p.{ending}")]) == 0
    drawing = ezdxf.readfile(tmp_path / "p.dxf")
    (bar,) = drawing.modelspace().query('LWPOLYLINE[layer=="LINK_3"]')
    assert np.abs(np.array(bar.get_points("xy")) / PIXEL - [[20, 0], [60, 40]]).max() < 1e-12
    marks = ezdxf.readfile(tmp_path / "c.dxf").modelspace().query('CIRCLE[layer=="C1"]')
    assert sorted(round(c.dxf.center.x / PIXEL, 9) for c in marks) == [-20, -10, -10, 10, 10, 20]
    svg = (tmp_path / "p.svg").read_text("utf-8")
    assert '<g id="LINK_4"' in svg
    assert main(["curves", design, "--out", str(tmp_path / "c.csv"), "--points", "Q"]) == 2
