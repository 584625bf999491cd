"""Linkages drawn by mouse and keys alone, from an empty window: what comes out is what its file says, and it runs."""

from __future__ import annotations

import cmath
import math
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from counting import calls
from pen import CTRL, NONE, SHIFT, Key, Pen, four_bar, start
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QInputDialog, QLabel, QLineEdit
from sampled import stressed
from window_user import Open, answering, plain, settle

from core.design import Design, faults, only
from core.project import load, loads
from core.study import Study
from kindyna_gui.export_dialogs import TablesDialog
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.places import example
from kindyna_gui.window.gallery import CircuitsDialog


def crank_rod_and_rocker(pen: Pen) -> None:
    """Of 30, 90 and 70 mm, between the pivots O1 and O2 that are there."""
    pen.key(Key.Key_B)
    pen.click("O1")
    pen.type("30", "60")
    pen.drag("A", 90 + 65j)
    pen.type("90")
    pen.drag("B", "O2")
    pen.type("70")


def same(drawn: Design, file: Design) -> None:
    """Links, sliders, driver and loads to the last digit."""
    one, other = drawn.drive.linkage, file.drive.linkage
    assert {n: dict(link.places) for n, link in one.by_number.items()} == {
        n: dict(link.places) for n, link in other.by_number.items()
    }
    assert one.sliders == other.sliders
    assert one.driver == other.driver
    assert one.drivers == other.drivers
    assert drawn.drive.loads == file.drive.loads


def runs_alike(drawn: Design, file: Design) -> None:
    """Every point stands in every position where that of the file does."""
    one, other = (Study(design, 90).linkage for design in (drawn, file))
    for name, body in other.bodies.items():
        for point in body.points:
            assert one.bodies[name].position(point) == pytest.approx(body.position(point), abs=1e-9), point


FOUR_BAR = """
format = 1
name = "Four-bar"
[linkage]
driver = { link = 2, kind = "crank", speed_rpm = 60.0 }
[linkage.drawn]
driver_deg = 60.0
A = [15.0, 25.98]
B = [87.0, 69.0]
[[linkage.links]]
number = 1
points = { O1 = [0.0, 0.0], O2 = [100.0, 0.0] }
[[linkage.links]]
number = 2
points = { O1 = [0.0, 0.0], A = [30.0, 0.0] }
[[linkage.links]]
number = 3
points = { A = [0.0, 0.0], B = [90.0, 0.0], C = [45.0, 40.0] }
[[linkage.links]]
number = 4
points = { B = [0.0, 0.0], O2 = [70.0, 0.0] }
[[loads.masses]]
link = 3
mass_kg = 2.5
centre = [40.0, 0.0]
[[loads.forces]]
link = 3
point = "C"
x_n = -120.0
"""


@pytest.mark.stress
def test_a_four_bar_with_coupler_point_mass_and_load_in_25_actions(open_user: Open, tmp_path: Path) -> None:
    """From an empty window to torque, pin forces and the exported curve; no file is opened, no form is filled in."""
    pen = start(open_user, whole=True)
    pen.key(Key.Key_G)
    pen.click(0j)
    pen.click(100 + 0j)
    crank_rod_and_rocker(pen)
    pen.key(Key.Key_T)
    pen.click((pen.places["A"] + pen.places["B"]) / 2.0)
    pen.type("45", "40")
    pen.key(Key.Key_M)
    pen.click((2 * pen.places["A"] + pen.places["B"]) / 3.0)
    pen.type("2.5", "0", "40", "0")
    pen.key(Key.Key_F)
    pen.click("C")
    pen.type("-120", "0")
    file = loads(FOUR_BAR)
    assert pen.user.session.incomplete is None
    same(pen.design, file)
    runs_alike(pen.design, file)
    for entry, view in (("Driver torque", "torque"), ("Joint forces", "contact_force")):
        pen.choose("Dyna", entry)
        assert not pen.user.see(view).in_trouble
    pen.actions += 2  # the folder with Enter, and the key that opens the dialog

    def answer(dialog: TablesDialog) -> None:
        dialog.folder.setText(str(tmp_path / "curve"))
        dialog.accept()

    with answering(TablesDialog, answer):
        pen.user.choose("Graph", "Export numbers...")
    assert pen.actions <= 25, pen.actions
    header, *rows = (tmp_path / "curve" / "linkage.csv").read_text("utf-8").splitlines()
    column = header.split(",").index("C_x_mm")
    wanted = next(body for body in Study(file, len(rows)).linkage.bodies.values() if "C" in body.points).position("C")
    assert [float(row.split(",")[column]) for row in rows] == pytest.approx(wanted.real * 1e3, abs=1e-9)
    forces = (tmp_path / "curve" / "dynamics.csv").read_text("utf-8").splitlines()[0].split(",")
    assert {"driver_torque_nm", "B_x_n", "O1_x_n"} <= set(forces), forces


SLIDER_CRANK = """
format = 1
name = "Slider-crank with a spring"
[linkage]
driver = { link = 3, kind = "crank", speed_rpm = 60.0 }
[linkage.drawn]
driver_deg = 60.0
A = [156.0, 0.0]
B = [20.0, 34.6]
[[linkage.links]]
number = 1
points = { O1 = [0.0, 0.0] }
[[linkage.links]]
number = 2
points = { A = [0.0, 0.0] }
[[linkage.links]]
number = 3
points = { O1 = [0.0, 0.0], B = [40.0, 0.0] }
[[linkage.links]]
number = 4
points = { B = [0.0, 0.0], A = [140.0, 0.0] }
[[linkage.sliders]]
link = 2
on = 1
through = [0.0, 0.0]
angle_deg = 0.0
[[loads.springs]]
from = { link = 1, at = [-60.0, -40.0] }
to = { link = 2, point = "A" }
rate_n_per_mm = 5.0
free_length_mm = 80.0
"""


@pytest.mark.stress
def test_a_slider_crank_with_a_spring_is_drawn(open_user: Open) -> None:
    pen = start(open_user)
    pen.key(Key.Key_G)
    pen.click(0j)
    pen.key(Key.Key_S)
    pen.drag("O1", 100 + 0j)
    pen.key(Key.Key_B)
    pen.click("O1")
    pen.type("40", "60")
    pen.drag("B", "A")
    pen.type("140")
    pen.key(Key.Key_K)
    pen.drag(-60 - 40j, "A")
    pen.type("5", "80")
    file = loads(SLIDER_CRANK)
    same(pen.design, file)
    runs_alike(pen.design, file)
    assert pen.user.steps == [
        "Ground O1", "Draw slider A", "Draw bar O1-B", "Draw bar B-A", "Make B-A 140 mm long",
        "Draw spring", "Set spring",
    ]  # fmt: skip
    for _ in pen.user.steps:
        pen.key(Key.Key_Z, CTRL)
    assert pen.places == {}


@pytest.mark.stress
def test_the_six_bar_of_the_lecture_is_drawn(open_user: Open) -> None:
    pen, file = start(open_user), load(example("lecture_six_bar"))
    pen.key(Key.Key_G)
    pen.click(0j)
    pen.click(60 + 0j)
    pen.key(Key.Key_B)
    pen.click("O1")
    pen.type("20", "40")
    pen.drag("A", 50 + 40j)
    pen.type("68.97436047612022")
    pen.drag("O2", "B")
    pen.type("40")
    pen.key(Key.Key_T)
    pen.click((pen.places["O2"] + pen.places["B"]) / 2.0)
    pen.type("60", "0")
    pen.key(Key.Key_B)
    pen.drag("C", 120 + 0j)
    pen.key(Key.Key_S)
    pen.drag("O1", "D")
    pen.key(Key.Key_Escape)
    pen.click(pen.length("C", "D"))
    pen.type("60")
    pen.key(Key.Key_M)
    for mass in file.drive.loads.masses:
        one, other = list(pen.shape(mass.link))[:2]
        pen.click(0.55 * pen.places[one] + 0.45 * pen.places[other])
        pen.type(*(repr(v) for v in (mass.mass_kg, mass.inertia_kg_m2, mass.centre_x_mm, mass.centre_y_mm)))
    same(pen.design, file)
    runs_alike(pen.design, file)


GEARED = """
format = 1
name = "Geared five-bar"
[linkage]
driver = { link = 2, kind = "crank", speed_rpm = 60.0 }
[linkage.drawn]
driver_deg = 60.0
A = [10.0, 17.3]
B = [60.0, 15.0]
C = [55.0, 55.0]
[[linkage.drivers]]
link = 3
"""
GEARED_LINKS = """
[[linkage.links]]
number = 1
points = { O1 = [0.0, 0.0], O2 = [60.0, 0.0] }
[[linkage.links]]
number = 2
points = { O1 = [0.0, 0.0], A = [20.0, 0.0] }
[[linkage.links]]
number = 3
points = { O2 = [0.0, 0.0], B = [15.0, 0.0] }
[[linkage.links]]
number = 4
points = { A = [0.0, 0.0], C = [50.0, 0.0] }
[[linkage.links]]
number = 5
points = { B = [0.0, 0.0], C = [45.0, 0.0] }
"""


@pytest.mark.stress
@pytest.mark.parametrize(
    ("typed", "row", "turns"),
    [
        stressed(("1",), "ratio = 1.0\noffset_deg = 30.0", 1),
        stressed(("2",), "ratio = 2.0\noffset_deg = -30.0", 1),
        stressed(("-.5", "100"), "ratio = -0.5\noffset_deg = 100.0", 2),
        (
            ("", "", "18", "36", "2.5", "gear"),
            'offset_deg = 120.0\nkind = "gear"\nteeth = [18, 36]\nmodule_mm = 2.5',
            2,
        ),
    ],
)
def test_a_geared_five_bar_is_drawn(open_user: Open, typed: tuple[str, ...], row: str, turns: int) -> None:
    """Two cranks, one of which the other leads by a ratio or by wheels: it stays as drawn, unless its offset is typed."""
    pen = start(open_user)
    pen.key(Key.Key_G)
    pen.click(0j)
    pen.click(60 + 0j)
    pen.key(Key.Key_B)
    pen.click("O1")
    pen.type("20", "60")
    pen.click("O2")
    pen.type("15", "90")
    pen.key(Key.Key_W)
    pen.click((pen.places["O2"] + pen.places["B"]) / 2.0)
    pen.key(Key.Key_Return, SHIFT)
    pen.type(*typed)
    pen.key(Key.Key_B)
    pen.drag("A", 55 + 55j)
    pen.type("50")
    pen.drag("B", "C")
    pen.type("45")
    file = loads(GEARED + row + GEARED_LINKS)
    assert pen.user.session.incomplete is None
    same(pen.design, file)
    runs_alike(pen.design, file)
    assert Study(pen.design, 90).turns == turns
    angle = math.degrees(cmath.phase(pen.places["B"] - 60))
    pen.key(Key.Key_Escape)
    pen.drag("B", 60 + 20j)  # what is dragged is drawn elsewhere: it follows from there
    offset = pen.design.drive.linkage.drivers[0].offset_deg - file.drive.linkage.drivers[0].offset_deg
    assert pen.places["B"] == pytest.approx(60 + 20j)
    assert offset == pytest.approx(90.0 - angle, abs=1e-8)


def test_a_rack_is_drawn_and_stays_where_it_is(open_user: Open) -> None:
    """Its pinion's radius is typed, and 0 for the rack; a typed offset moves it."""
    pen = start(open_user)
    pen.key(Key.Key_G)
    pen.click(0j)
    pen.key(Key.Key_B)
    pen.click("O1")
    pen.type("20", "90")
    pen.key(Key.Key_S)
    pen.drag(45 - 15j, 75 - 15j)
    (block,) = pen.design.drive.linkage.links[-1].places
    here = pen.places[block]
    pen.key(Key.Key_W)
    pen.click(block)
    pen.key(Key.Key_Return, SHIFT)
    pen.type("", "", "20", "0")
    (row,) = pen.design.drive.linkage.drivers
    assert (row.kind, row.radius_first_mm, row.radius_second_mm, row.ratio) == ("rack", 20.0, 0.0, None)
    assert row.offset_mm == pytest.approx(-20.0 * math.pi / 2.0, abs=1e-6)
    assert pen.places[block] == pytest.approx(here)
    pen.key(Key.Key_Return, SHIFT)
    pen.type("", "0")
    assert pen.places[block] == pytest.approx(here + 20.0 * math.pi / 2.0)


WATT_II = """
format = 1
name = "Watt II"
[linkage]
driver = { link = 2, kind = "crank", speed_rpm = 60.0 }
[linkage.drawn]
driver_deg = 60.0
A = [15.0, 26.0]
B = [87.0, 69.0]
D = [190.0, 57.0]
[[linkage.links]]
number = 1
points = { O1 = [0.0, 0.0], O2 = [100.0, 0.0], O3 = [200.0, 0.0] }
[[linkage.links]]
number = 2
points = { O1 = [0.0, 0.0], A = [30.0, 0.0] }
[[linkage.links]]
number = 3
points = { A = [0.0, 0.0], B = [90.0, 0.0] }
[[linkage.links]]
number = 4
points = { B = [0.0, 0.0], O2 = [70.0, 0.0], C = [35.0, 40.0] }
[[linkage.links]]
number = 5
points = { C = [0.0, 0.0], D = [70.0, 0.0] }
[[linkage.links]]
number = 6
points = { D = [0.0, 0.0], O3 = [60.0, 0.0] }
[[loads.masses]]
link = 4
mass_kg = 1.75
inertia_kg_m2 = 0.0011
centre = [31.5, 12.25]
[[loads.masses]]
link = 5
mass_kg = 0.6
centre = [35.0, 0.0]
[[loads.forces]]
link = 5
point = "D"
x_n = 40.0
y_n = -85.5
"""


@pytest.mark.stress
def test_watt_ii_with_masses_and_a_load_is_drawn(open_user: Open) -> None:
    pen = start(open_user)
    pen.key(Key.Key_G)
    for pivot in (0j, 100 + 0j, 200 + 0j):
        pen.click(pivot)
    crank_rod_and_rocker(pen)
    pen.key(Key.Key_T)
    pen.click((pen.places["B"] + pen.places["O2"]) / 2.0)
    pen.type("35", "40")
    pen.key(Key.Key_B)
    pen.drag("C", 190 + 60j)
    pen.type("70")
    pen.drag("D", "O3")
    pen.type("60")
    pen.key(Key.Key_M)
    pen.click((pen.places["B"] + pen.places["O2"] + pen.places["C"]) / 3.0)
    pen.type("1.75", "0.0011", "31.5", "12.25")
    pen.click(0.6 * pen.places["C"] + 0.4 * pen.places["D"])
    pen.type("0.6", "0", "35", "0")
    pen.key(Key.Key_F)
    pen.click("D")
    pen.type("40", "-85.5")
    file = loads(WATT_II)
    assert pen.user.session.incomplete is None
    same(pen.design, file)
    runs_alike(pen.design, file)
    assert Study(pen.design, 90).dynamics.driver == pytest.approx(Study(file, 90).dynamics.driver, abs=1e-9)


def test_what_is_no_mechanism_yet_is_saved_opened_and_undone(open_user: Open, tmp_path: Path) -> None:
    """A strip says what to do; the file holds it as it is; another window opens it and goes on."""
    pen = start(open_user)
    pen.user.window.show_view("velocity")  # of an empty sheet there is none, and nothing fails
    pen.canvas.setFocus()
    strip = pen.user.drawing().drawing.bar.state
    assert "canvas is empty" in strip.text()
    pen.key(Key.Key_G)
    pen.click(0j)
    pen.key(Key.Key_B)
    pen.drag("O1", 30j)
    assert "linkage moves" in strip.text()
    pen.drag("A", 60 + 50j)
    assert strip.text() == "1 degree of freedom without a driver: B hangs loose: join it or ground it"
    pen.user.picks("design_to_save", tmp_path / "half.toml")
    pen.user.choose("File", "Save as...")
    assert not pen.user.session.modified
    drawn = pen.design
    other = open_user(tmp_path / "half.toml")
    assert other.session.typed.drive.mechanism == drawn.drive.mechanism
    assert other.drawing().shows_layout
    assert "B hangs loose" in other.drawing().note.text()
    again = Pen(other)
    again.user.drawing().canvas.setFocus()
    again.key(Key.Key_D)
    again.key(Key.Key_G)
    again.click(100 + 0j)
    again.key(Key.Key_B)
    again.drag("B", "O2")
    assert faults(again.design) == []
    assert not other.session.is_incomplete_linkage
    again.key(Key.Key_Escape)
    again.key(Key.Key_Escape)
    assert not other.drawing().shows_layout
    assert {"A", "B", "O1", "O2"} <= set(other.drawing().scene.geometry.handles(0))
    assert other.session.state()["modified"]
    other.session.restore(other.session.state())
    assert other.session.typed.drive.mechanism == again.design.drive.mechanism


def test_drawing_ends_where_a_design_without_links_is_opened(open_user: Open) -> None:
    pen = start(open_user)
    assert pen.user.drawing().draws
    pen.user.session.open(example("dwell_rise_dwell"))
    settle()
    assert not pen.user.drawing().draws
    pen.user.window.player.set_theta(1.0)
    pen.user.session.open(example("lecture_six_bar"))
    settle()
    assert not pen.user.drawing().draws


@pytest.mark.stress
def test_the_part_that_is_led_moves_and_the_rest_hangs_on_it(open_user: Open) -> None:
    """A crank with a loose rod: the crank goes round, the rod keeps its length; grey is what the driver does not lead."""
    pen = start(open_user)
    pen.key(Key.Key_G)
    pen.click(0j)
    pen.key(Key.Key_B)
    pen.drag("O1", 30j)
    pen.drag("A", 60 + 50j)
    rod = abs(pen.places["B"] - pen.places["A"])
    pen.key(Key.Key_Escape)
    pen.key(Key.Key_Escape)
    view, player = pen.user.drawing(), pen.user.window.player
    assert view.shows_layout
    assert view.drawing.static_links == {1, 3}
    assert player.theta == pytest.approx(math.pi / 2.0)
    for theta in (2.0, 4.0, 6.0):
        player.set_theta(theta)
        settle()
        assert pen.places["A"] == pytest.approx(30.0 * cmath.exp(1j * theta), abs=1e-9)
        assert abs(pen.places["B"] - pen.places["A"]) == pytest.approx(rod, abs=1e-8)
    assert pen.design.drive.linkage.drawn.driver_deg == pytest.approx(90.0)


@pytest.mark.stress
def test_another_circuit_is_chosen_by_its_picture_and_saved_as_signs(open_user: Open) -> None:
    pen = four_bar(open_user)
    pen.key(Key.Key_Escape)
    b = pen.places["B"]
    seen: list[str] = []

    def answer(dialog: CircuitsDialog) -> None:
        seen.extend(dialog.pictures.item(i).text() for i in range(dialog.pictures.count()))
        images = [dialog.pictures.item(i).icon().pixmap(200, 140).toImage() for i in range(2)]
        assert images[0] != images[1]
        dialog.pictures.setCurrentRow(1)
        dialog.accept()

    with answering(CircuitsDialog, answer):
        pen.choose("Compo", "Circuits...")
    assert len(seen) == 2
    assert "current" in seen[0]
    assert pen.user.steps[-1] == "Choose another circuit"
    assert pen.places["B"].imag < 0.0 < b.imag
    pen.choose("Compo", "Save as signs")
    linkage = pen.design.drive.linkage
    assert linkage.drawn is None
    assert [(s.joint, s.side) for s in linkage.branch] == [("B", -1)]


def test_what_is_chosen_is_moved_deleted_copied_and_welded(open_user: Open) -> None:
    pen = four_bar(open_user)
    before = pen.design
    middle = (pen.places["A"] + pen.places["B"]) / 2.0
    pen.drag("B", 90 + 60j)
    assert pen.places["B"] == pytest.approx(90 + 60j)
    assert pen.shape(2) == {"O1": 0j, "A": 30 + 0j}
    assert pen.user.steps[-1] == "Move B"
    pen.key(Key.Key_Z, CTRL)
    assert pen.design.drive.mechanism == before.drive.mechanism
    pen.click(middle)
    pen.key(Key.Key_D, CTRL)
    assert pen.shape(5) == {"C": 0j, "D": pen.shape(3)["B"]}
    pen.key(Key.Key_Delete)
    assert pen.user.steps[-2:] == ["Duplicate link 3", "Delete link 5"]
    assert 5 not in pen.design.drive.linkage.by_number
    pen.click(middle)
    pen.click((pen.places["B"] + pen.places["O2"]) / 2.0, SHIFT)
    pen.key(Key.Key_W, CTRL)
    assert set(pen.shape(3)) == {"A", "B", "O2"}
    assert pen.user.steps[-1] == "Weld link 4 to link 3"
    pen.key(Key.Key_Z, CTRL)
    pen.click("B")
    pen.key(Key.Key_J, CTRL | SHIFT)
    assert {name: pen.places[name] for name in "BC"} == pytest.approx({"B": 80 + 70j, "C": 80 + 70j})
    assert pen.user.steps[-1] == "Split B"
    pen.key(Key.Key_A, CTRL)
    pen.key(Key.Key_M, CTRL | SHIFT)
    assert pen.places["O1"] == pytest.approx(100 + 0j)


def test_a_pin_that_a_typed_length_moves_away_is_no_longer_under_the_mouse(open_user: Open) -> None:
    pen = start(open_user)
    pen.key(Key.Key_B)
    pen.drag(0j, 50 + 0j)
    pen.hover("B")
    assert pen.user.drawing().drawing.snap.point == "B"
    pen.type("30")
    assert abs(pen.places["B"] - pen.places["A"]) == pytest.approx(30.0)
    assert pen.user.drawing().drawing.snap is None


def test_escape_takes_back_what_is_dragged_and_goes_on_drawing(open_user: Open) -> None:
    pen = four_bar(open_user)
    before, theta = pen.design, pen.user.window.player.theta
    sheet, start = pen.canvas.viewport(), pen.at("A")
    QTest.mousePress(sheet, Qt.MouseButton.LeftButton, NONE, start)
    for way in (QPoint(20, -20), QPoint(40, -30)):
        QTest.mouseMove(sheet, start + way)
        settle()
    assert pen.design != before
    pen.key(Key.Key_Escape)
    QTest.mouseMove(sheet, start + QPoint(60, -10))
    QTest.mouseRelease(sheet, Qt.MouseButton.LeftButton, NONE, start + QPoint(60, -10))
    settle()
    assert pen.design == before
    assert pen.user.window.player.theta == theta
    assert not pen.user.session.drag_source
    assert pen.user.drawing().drawing.active, "only a second Escape leaves the drawing"


def test_pins_are_joined_grounded_renamed_and_locked(open_user: Open) -> None:
    pen = start(open_user)
    pen.drag(0j, 50 + 0j)
    pen.drag(60 + 20j, 100 + 20j)
    pen.key(Key.Key_Escape)
    pen.click("B")
    pen.click("C", SHIFT)
    pen.key(Key.Key_J, CTRL)
    assert set(pen.places) == {"A", "B", "D"}
    pen.click("A")
    pen.key(Key.Key_G, CTRL | SHIFT)
    assert pen.shape(1) == {"A": 0j}
    pen.click("D")
    pen.key(Key.Key_F2)
    edit = QApplication.focusWidget()
    assert isinstance(edit, QLineEdit)
    assert edit.text() == "D"
    QTest.keyClicks(edit, "Tip")
    pen.key(Key.Key_Return)
    assert set(pen.places) == {"A", "B", "Tip"}
    pen.key(Key.Key_L, CTRL | SHIFT)
    where = pen.places["Tip"]
    pen.drag("Tip", where + 20j)
    assert pen.places["Tip"] == where
    pen.click(pen.places["B"] / 2.0)
    pen.key(Key.Key_L, CTRL | SHIFT)
    pen.drag("B", 80 + 0j)
    assert pen.places["B"] == 50 + 0j
    assert pen.user.steps[-1] == "Rename D to Tip"


@pytest.mark.stress
def test_links_are_pasted_into_another_design(open_user: Open) -> None:
    pen = four_bar(open_user)
    pen.key(Key.Key_A, CTRL)
    pen.key(Key.Key_C, CTRL)
    links = pen.design.drive.linkage.links
    other = start(open_user)
    other.key(Key.Key_V, CTRL)
    assert [list(link.places.values()) for link in other.design.drive.linkage.links[1:]] == [
        list(link.places.values()) for link in links[1:]
    ]
    assert other.user.steps == ["Paste links 2, 3, 4"]
    assert math.isclose(abs(other.places["O2"] - other.places["O1"]), 100.0)


@pytest.mark.stress
def test_outside_of_drawing_a_link_that_is_dragged_runs_the_machine(open_user: Open) -> None:
    """The grip stays under the mouse, no length changes; Esc and D leave and begin to draw."""
    pen = four_bar(open_user)
    pen.key(Key.Key_Escape)
    view = pen.user.drawing()
    assert not view.draws
    before = pen.design
    grip = 15j  # on the crank, which stands upright
    pen.user.drag(grip, 15 * cmath.exp(1j * math.radians(40.0)))
    assert math.degrees(pen.user.window.player.theta) == pytest.approx(40.0, abs=1.5)
    assert pen.design == before
    pen.key(Key.Key_D)
    assert view.draws
    assert pen.user.action("Compo", "Draw").isChecked()
    assert abs(pen.places["A"] - 30 * cmath.exp(1j * pen.user.window.player.theta)) < 1e-6
    pen.key(Key.Key_D)
    assert not view.draws


def test_drawing_adds_nothing_to_a_frame_while_it_is_not_used(open_user: Open) -> None:
    """A frame of the machine calls as many functions after something was drawn as it does before that."""
    user = open_user(example("lecture_six_bar"), whole=False)
    pen, player, canvas = Pen(user), user.window.player, user.drawing().canvas

    def frame() -> int:
        counts = []
        for i in range(5):
            player.set_theta(1.0 + 0.1 * i)
            canvas.grab()
            counts.append(calls(lambda at=1.05 + 0.1 * i: (player.set_theta(at), canvas.grab())))
        return min(counts)

    canvas.setFocus()
    before = frame()
    pen.key(Key.Key_D)
    assert user.drawing().draws
    pen.click("A")
    pen.key(Key.Key_Escape)
    assert not user.drawing().draws
    assert frame() <= before


def test_the_eighth_loose_bar_costs_at_most_twice_the_first(open_user: Open) -> None:
    """With the forms at its side, which get fields for the new bar alone."""
    pen = start(open_user, whole=True, size=(1440, 900))
    strokes = [calls(lambda y=y: pen.drag(complex(-60, y), complex(-20, y))) for y in range(40, -40, -10)]
    assert len(pen.places) == 16
    fields = pen.user.parameters().forms["linkage"].fields
    assert fields["linkage.links[8].points.Q.x_mm"].editor.text() == "40"
    assert strokes[-1] <= 2.0 * strokes[0]
    pen.user.session.stack.undo()
    assert "linkage.links[8].points.Q.x_mm" not in pen.user.parameters().forms["linkage"].fields


@pytest.mark.stress
def test_a_point_on_the_line_of_a_bar_leaves_its_face(open_user: Open) -> None:
    """A link is hit anywhere on its face, also where its three points lie in line."""
    pen = four_bar(open_user)
    pen.key(Key.Key_T)
    pen.click((pen.places["A"] + pen.places["B"]) / 2.0)
    view = pen.user.drawing()
    transform = view.canvas.viewportTransform()
    for share in (0.2, 0.4, 0.6, 0.8):
        at = pen.places["A"] + share * (pen.places["B"] - pen.places["A"])
        assert view.drawing.sketch.link_at(transform.map(QPointF(at.real, at.imag))) == 3


def test_every_tool_and_deed_has_its_entry_and_its_menu(open_user: Open) -> None:
    """The menu bar offers all; the menu at a pin, a link and the sheet begins a tool there."""
    pen = four_bar(open_user)
    offered = pen.user.entries("Compo", "Drawing")
    view = pen.user.drawing()
    assert view.drawing.group.objectName() == "Draw"
    assert view.drawing.group.isExclusive()
    assert [action.text() for action in view.drawing.group.actions()] == offered[: len(view.drawing.group.actions())]
    transform = view.canvas.viewportTransform()

    def menu_at(where: complex) -> dict[str, Any]:
        place = transform.map(QPointF(where.real, where.imag))
        return {plain(a.text()): a for a in view.drawing.menu_at(place).actions() if not a.isSeparator()}

    link = menu_at((pen.places["A"] + pen.places["B"]) / 2.0)
    assert {"Attach a bar", "Trace a point", "Drive", "Mass here", "Delete", "Weld links", "Type values..."} <= set(
        link
    )
    pin = menu_at(pen.places["B"])
    assert {"Attach a bar", "Ground", "Force here", "Split pin", "Rename...", "Delete"} <= set(pin)
    assert "Paste" in menu_at(20 - 40j)
    menu_at((pen.places["A"] + pen.places["B"]) / 2.0)["Trace a point"].trigger()
    assert "C" in pen.shape(3)
    assert pen.user.steps[-1] == "Point C on link 3"


@pytest.mark.stress
def test_while_a_line_is_drawn_the_mouse_is_drawn_to_what_is_there(open_user: Open) -> None:
    """Points, lines, perpendiculars, 15° steps, the grid; Ctrl frees it."""
    pen = four_bar(open_user)
    drawing = pen.user.drawing().drawing
    pen.canvas.show_region(QPointF(50.0, 20.0), 4.0)
    pen.key(Key.Key_B)
    marks = {}
    pen.hover(pen.places["A"] + 1.0)
    marks["point"] = drawing.snap
    pen.hover((3.0 * pen.places["A"] + pen.places["B"]) / 4.0 + 0.5j)
    marks["line"] = drawing.snap
    pen.click(60 + 0j)
    a, b = pen.places["A"], pen.places["B"]
    upright = a + (b - a) * (((60 - a) * (b - a).conjugate()).real / abs(b - a) ** 2)
    pen.hover(upright + 0.5)
    marks["perpendicular"] = drawing.snap
    pen.hover(60 + 23 * cmath.exp(1j * math.radians(-30.5)))
    marks["angle"] = drawing.snap
    assert {name: snap.mark for name, snap in marks.items()} == {name: name for name in marks}
    assert marks["perpendicular"].at == pytest.approx(upright)
    assert math.degrees(cmath.phase(marks["angle"].at - 60)) == pytest.approx(-30.0)


@pytest.mark.stress
def test_any_order_of_tools_keys_and_undo_is_borne(open_user: Open) -> None:
    """Nothing fails, whatever is drawn, split, welded, deleted, pasted and undone; all of it can be undone to the empty sheet."""
    pen, dice = start(open_user), random.Random(7)
    keys = [(key, NONE) for key in (Key.Key_Delete, Key.Key_Return, *map(Qt.Key, b"VPBLSGTRMFKC"))]
    keys += [(key, CTRL) for key in map(Qt.Key, b"DJWRACVZ")] + [(key, CTRL | SHIFT) for key in map(Qt.Key, b"MJGLZ")]

    def place() -> complex:
        there = list(pen.places.values())
        return dice.choice(there) if there and dice.random() < 0.6 else complex(*dice.choices(range(-60, 65, 5), k=2))

    for _ in range(50):
        way = dice.random()
        if way < 0.4:
            pen.key(*dice.choice(keys))
        elif way < 0.65:
            pen.click(place(), dice.choice((NONE, NONE, SHIFT)))
        elif way < 0.92:
            pen.drag(place(), place())
        else:
            pen.type("35", "20") if pen.user.drawing().drawing.tool.clicks else pen.key(Key.Key_Escape)
        if not pen.user.drawing().draws:
            pen.user.choose("Compo", "Draw")
    while pen.user.session.stack.canUndo():
        pen.user.session.stack.undo()
    assert pen.places == {}


@pytest.mark.stress
def test_the_feed_of_the_transfer_unit_is_drawn(open_user: Open) -> None:
    """An arm with its roller under a cam, from an empty sheet: the same cam as the file's."""
    unit = load(example("transfer_unit"))
    feed = only(unit, next(i for i, drive in enumerate(unit.drives) if drive.name == "Feed"))
    pen = start(open_user, whole=True)
    pen.key(Key.Key_G)
    pen.type("620", "0")
    between = math.degrees(math.acos((620.0**2 + 500.0**2 - 390.0**2) / (2.0 * 620.0 * 500.0)))
    pen.key(Key.Key_B)
    pen.click("O1")
    pen.type("500", repr(180.0 + between))
    pen.key(Key.Key_Escape)
    pen.choose("Compo", "Driver", "Link 2 follows a motion")
    begin = pen.design.drive.motion.start
    pen.user.picks("design_to_open", example("transfer_unit"))

    def act(dialog: QInputDialog) -> None:
        dialog.setTextValue("Feed")
        dialog.accept()

    with answering(QInputDialog, act):
        pen.choose("Make", "Motion from a design or file...")
    pen.user.window.activateWindow()
    pen.user.enter("motion.start_deg", repr(begin))
    pen.choose("Compo", "Cam roller", "A on link 2")
    pen.user.enter("cam.roller_radius_mm", "60")
    drawn, there = (Study(each, 360).shape.flanks[0] for each in (pen.design, feed))
    assert pen.actions <= 25
    # drawn below the pivot's line it is the mirror image of the file's
    assert np.abs(drawn.profile) == pytest.approx(np.abs(there.profile), abs=1e-8)


def test_a_bar_begun_on_a_link_that_is_then_deleted_begins_anew(open_user: Open) -> None:
    """The place of its first end lies on nothing any longer."""
    pen = start(open_user)
    pen.key(Key.Key_B)
    pen.drag(0j, 40 + 0j)
    pen.drag(40 + 0j, 80 + 60j)
    drawn = len(pen.design.drive.linkage.links)
    pen.click(60 + 30j)  # on the second bar, which is chosen still
    pen.key(Key.Key_Delete)
    assert len(pen.design.drive.linkage.links) == drawn - 1
    pen.click(20 + 60j)
    assert len(pen.design.drive.linkage.links) == drawn - 1
    pen.click(20 + 90j)
    assert len(pen.design.drive.linkage.links) == drawn


def test_a_drawing_that_cannot_be_put_together_is_not_copied_and_says_why(open_user: Open) -> None:
    pen = start(open_user)
    pen.choose("Edit", "Copy picture")
    assert pen.user.window.status.currentMessage().startswith("Nothing was copied.")


def test_a_drawing_behind_a_tab_is_not_painted_after_a_follower_is_opened(open_user: Open) -> None:
    """It comes to the front, and is painted, before it has followed the new design."""
    pen = start(open_user)
    view = pen.user.drawing()
    view.draw(False)
    assert view.shows_layout
    view.hide()
    pen.user.window.documents.open_example(example("tappet_flat"))
    view.show()
    pen.user.window.grab()
    pen.user.window.grab()
    settle()
    assert view.up_to_date
    assert not view.shows_layout


def test_a_finished_linkage_with_a_value_that_is_refused_says_which(open_user: Open) -> None:
    """Not, in red, that the linkage moves."""
    pen = four_bar(open_user)
    pen.user.choose("Compo", "Draw")
    pen.user.enter("linkage.driver.speed_rpm", "0")
    note = pen.user.drawing().note
    assert note.isVisible()
    assert note.text().startswith("Speed of link 2: must not be 0; allowed: > 0")


def test_no_field_is_framed_while_a_drawing_only_lacks_something(open_user: Open) -> None:
    """A block more, which still hangs loose: neither its coordinates nor those of the four-bar are at fault."""
    pen = four_bar(open_user)
    view = pen.user.parameters()
    pen.key(Key.Key_S)
    pen.click(180 - 60j)
    pen.type("0")
    assert "hangs loose" in view.incomplete_bar.findChildren(QLabel)[0].text()
    boxes = [box for box in view.findChildren(NumberBox) if not box.visibleRegion().isEmpty()]
    assert len(boxes) > 5
    assert [box.accessibleName() for box in boxes if box.is_waiting] == []
