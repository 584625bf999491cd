"""Numbers typed while drawing: the boxes at the mouse are those that the tool names, and no value is refused silently."""

from __future__ import annotations

import math

import pytest
from pen import NONE, Key, Pen, four_bar, start
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QLineEdit
from window_user import Open, settle


def asked(pen: Pen, text: str = "1") -> list[str]:
    """Labels and units of the boxes that a digit opens; they are closed again."""
    QTest.keyClicks(pen.canvas, text)
    settle()
    boxes = pen.user.drawing().drawing.typed.boxes
    labels = [part for part in boxes.findChildren(QLabel) if not part.isHidden()] if boxes.open else []
    words = [part.text() for part in sorted(labels, key=lambda part: part.x())]
    if boxes.open:
        pen.key(Key.Key_Escape)
    return words


def told(pen: Pen) -> str:
    """The message in the status line."""
    return str(pen.user.window.status.currentMessage())


def test_the_boxes_are_those_that_the_tool_names(open_user: Open) -> None:
    pen = four_bar(open_user)
    pen.click(180 - 60j)
    middle = (pen.places["A"] + pen.places["B"]) / 2.0
    position, line = ["x", "mm", "y", "mm"], ["length", "mm", "angle", "°"]
    seen = {}
    for key, clicks in ((Key.Key_P, 0), (Key.Key_G, 0), (Key.Key_B, 1), (Key.Key_L, 2), (Key.Key_S, 1), (Key.Key_T, 0),
                        (Key.Key_K, 1), (Key.Key_M, 0), (Key.Key_F, 0)):  # fmt: skip
        pen.key(key)
        pen.hover(middle)
        seen[key] = [asked(pen)]
        for i in range(clicks):
            pen.click(180 + 20j * i)
            pen.hover(180 + 20j * i + 30)
            seen[key].append(asked(pen))
        pen.key(Key.Key_Escape)
    assert seen == {
        Key.Key_P: [position],
        Key.Key_G: [position],
        Key.Key_B: [position, line],
        Key.Key_L: [position, line, line],
        Key.Key_S: [position, ["angle", "°"]],
        Key.Key_T: [position],
        Key.Key_K: [position, position],
        Key.Key_M: [["mass", "kg", "inertia", "kg·m²", "x", "mm", "y", "mm"]],
        Key.Key_F: [["x", "N", "y", "N"]],
    }
    for key in (Key.Key_R, Key.Key_W, Key.Key_C):
        pen.key(key)
        assert asked(pen) == []
        assert "click" in told(pen)


def test_a_slider_asks_its_angle(open_user: Open) -> None:
    """From a block, and from a pivot through which its line goes; 0 is an angle."""
    pen = start(open_user)
    pen.key(Key.Key_S)
    pen.click(40 + 20j)
    pen.type("0")
    (slider,) = pen.design.drive.linkage.sliders
    assert (slider.angle_deg, slider.through_x_mm, slider.through_y_mm) == (0.0, 40.0, 20.0)
    pen.key(Key.Key_G)
    pen.click(0j)
    pen.key(Key.Key_B)
    pen.drag(-60 + 30j, -20 - 10j)
    pen.key(Key.Key_S)
    pen.click("O1")
    pen.hover(-40 + 10j)
    mark = pen.user.drawing().drawing.snap
    assert mark is not None
    assert mark.link is None, "the direction joins nothing"
    pen.hover(-50 + 10j)
    pen.type("120")
    slider = pen.design.drive.linkage.sliders[-1]
    assert slider.angle_deg == 120.0
    (block,) = pen.shape(slider.link)
    assert math.degrees(math.atan2(pen.places[block].imag, pen.places[block].real)) == pytest.approx(120.0)


def test_a_point_and_a_mass_are_typed_on_the_link_under_the_mouse(open_user: Open) -> None:
    pen = four_bar(open_user)
    middle = (pen.places["A"] + pen.places["B"]) / 2.0
    pen.key(Key.Key_T)
    pen.hover(middle)
    pen.type("45", "40")
    assert pen.shape(3)["C"] == pytest.approx(45 + 40j, abs=1e-9)
    pen.key(Key.Key_M)
    pen.hover((pen.places["B"] + pen.places["O2"]) / 2.0)
    pen.type("2.5")
    (mass,) = pen.design.drive.loads.masses
    assert (mass.link, mass.mass_kg) == (4, 2.5)
    assert pen.user.steps[-1] == "Give link 4 a mass"


def test_a_value_that_is_refused_says_why(open_user: Open) -> None:
    """In the status line too; a value that is then right is taken."""
    pen = start(open_user)
    pen.click(0j)
    pen.type("0")
    assert "above 0" in told(pen)
    edit = QApplication.focusWidget()
    assert isinstance(edit, QLineEdit)
    assert edit.styleSheet()
    edit.setText("12x")
    pen.key(Key.Key_Return)
    assert told(pen).startswith("length: enter a number")
    edit.setText("12")
    pen.key(Key.Key_Return)
    assert abs(pen.places["B"]) == pytest.approx(12.0)


def test_a_refused_value_stays_with_a_sentence_below_the_boxes_and_a_button_back(open_user: Open) -> None:
    pen = start(open_user)
    pen.drag(0j, 60 + 0j)
    before = pen.user.steps
    drawing = pen.user.drawing().drawing
    drawing.choose(links=(pen.design.drive.linkage.links[-1].number,))
    boxes = drawing.typed.boxes
    drawing.typed.ask_length(pen.design.drive.linkage.links[-1].number, "A", "B")
    QTest.keyClicks(QApplication.focusWidget(), "6o")
    pen.key(Key.Key_Return)
    line = boxes.refusal
    assert line.isVisible()
    assert not line.visibleRegion().isEmpty()
    assert "nter a number" in line.text()
    edit = QApplication.focusWidget()
    assert isinstance(edit, QLineEdit)
    assert (edit.text(), bool(edit.styleSheet())) == ("6o", True)
    QTest.mouseClick(line.buttons["Back to 60 mm"], Qt.MouseButton.LeftButton)
    settle()
    assert (edit.text(), edit.styleSheet(), line.isVisible(), edit.hasFocus()) == ("60", "", False, True)
    pen.key(Key.Key_Escape)
    assert pen.user.steps == before


def test_a_value_that_the_design_refuses_keeps_its_boxes_open(open_user: Open) -> None:
    """A mass below 0, and a bar of no length: not only a number that cannot be read."""
    pen = four_bar(open_user)
    before, drawing = pen.user.steps, pen.user.drawing().drawing
    pen.key(Key.Key_M)
    pen.hover((pen.places["B"] + pen.places["O2"]) / 2.0)
    pen.type("-3")
    assert drawing.typed.boxes.refusal.isVisible()
    assert "allowed: ≥ 0 kg" in drawing.typed.boxes.refusal.text()
    edit = QApplication.focusWidget()
    assert isinstance(edit, QLineEdit)
    assert (edit.text(), bool(edit.styleSheet())) == ("-3", True)
    edit.selectAll()
    pen.type("3")
    assert not drawing.typed.boxes.open
    assert pen.design.drive.loads.masses[0].mass_kg == 3.0
    assert pen.user.steps == [*before, "Give link 4 a mass"]
    pen.key(Key.Key_Escape)
    drawing.typed.ask_length(4, "B", "O2")
    pen.type("0")
    assert drawing.typed.boxes.refusal.isVisible()
    edit = QApplication.focusWidget()
    assert isinstance(edit, QLineEdit)
    assert edit.text() == "0"
    pen.key(Key.Key_Escape)
    assert pen.user.steps == [*before, "Give link 4 a mass"]


def test_the_mark_shows_what_the_typed_numbers_join(open_user: Open) -> None:
    """Before Enter; after Esc it is at the mouse again."""
    pen = start(open_user)
    pen.drag(0j, 60 + 0j)
    pen.click(60 + 40j)
    pen.hover(20 + 40j)
    drawing = pen.user.drawing().drawing
    before = drawing.snap
    QTest.keyClicks(pen.canvas, "4")
    QTest.keyClicks(QApplication.focusWidget(), "0")
    QTest.keyClick(QApplication.focusWidget(), Key.Key_Tab)
    QTest.keyClicks(QApplication.focusWidget(), "-90")
    assert drawing.snap is not None
    assert drawing.snap.point == "B"
    pen.key(Key.Key_Escape)
    assert drawing.snap == before
    QTest.keyClick(pen.canvas, Key.Key_Escape, NONE)
