"""What the mark at the mouse shows is what a click joins: pins, bars, and what comes to lie on them by any means."""

from __future__ import annotations

import cmath
import math
import random
from collections.abc import Iterator
from itertools import combinations

import pytest
from pen import CTRL, NONE, SHIFT, Key, Pen, four_bar, start
from PySide6.QtCore import QPointF, Qt
from PySide6.QtTest import QTest
from sampled import stressed
from window_user import Open, settle

from kindyna_gui.linkage.snapping import Snap


def snap(pen: Pen) -> Snap:
    """The mark at the mouse."""
    mark = pen.user.drawing().drawing.snap
    assert mark is not None
    return mark


def zoom(pen: Pen, scale: float, middle: complex = 0j) -> None:
    """Show the drawing at a scale in pixels per mm."""
    pen.canvas.show_region(QPointF(middle.real, middle.imag), scale)
    settle()


def coincident(pen: Pen) -> list[tuple[str, str]]:
    """Pairs of points within a millionth of a millimetre."""
    return [(a, b) for a, b in combinations(pen.places, 2) if abs(pen.places[a] - pen.places[b]) <= 1e-6]


def owners(pen: Pen, name: str) -> set[int]:
    """The links that have a point."""
    return {link.number for link in pen.design.drive.linkage.links if name in link.places}


def test_the_reach_of_a_pin_covers_its_cell_of_the_grid(open_user: Open) -> None:
    """At 2.3 pixels per mm a cell has 23 pixels: 11 to 14 pixels off a pin the grid leads to that pin."""
    pen = start(open_user)
    zoom(pen, 2.3)
    pen.drag(0j, 40 + 0j)
    for i, (way, far) in enumerate(((1, 11), (1j, 11), (1 + 1j, 14), (1 - 1j, 14), (-1j, 11))):
        off = 40 + far * way / abs(way) / 2.3
        pen.hover(off)
        assert snap(pen).point == "B"
        pen.drag(off, 60 + 30j - 15j * i)
        assert coincident(pen) == []
        assert owners(pen, "B") == set(range(2, 4 + i))


def test_pins_that_would_overlap_are_one(open_user: Open) -> None:
    """A pin off the grid: the crossing of the grid next to it, and the end of a ray, are that pin."""
    pen = start(open_user)
    zoom(pen, 2.3)
    pen.click(0j, CTRL)
    pen.click(27.3 + 31.6j, CTRL)
    end = pen.places["B"]
    pen.click(-40 + 0j)
    pen.hover(34 + 27j)
    assert snap(pen).point == "B"
    for angle in range(0, 360, 5):
        pen.hover(end + cmath.rect(7.0, math.radians(angle)))
        assert snap(pen).point == "B" or abs(snap(pen).at - end) * 2.3 > 8.0


@pytest.mark.parametrize("seed", [0, *map(stressed, range(1, 4))])
def test_whatever_is_clicked_joins_what_its_mark_shows(open_user: Open, seed: int) -> None:
    """Bars at several scales, ends near pins, bars and rays: the mark names the pin or the link that the end joins."""
    pen, dice = start(open_user), random.Random(seed)
    for scale in (0.4, 2.3, 3.1, 11.0):
        zoom(pen, scale)
        for _ in range(9 if seed else 5):
            wanted = list(_ends(pen, dice, scale))
            marks = []
            for at, modifier in wanted:
                pen.hover(at)
                if modifier == CTRL:
                    QTest.mouseMove(pen.canvas.viewport(), pen.at(at))
                pen.click(at, modifier)
                marks.append(snap(pen) if modifier == NONE else None)
            links = pen.design.drive.linkage.links
            assert coincident(pen) == [], (scale, wanted)
            if pen.user.drawing().drawing.tool_input.snaps:
                pen.key(Key.Key_Escape)
            elif pen.user.steps and pen.user.session.stack.canUndo() and len(links) > 1:
                _check_bar(pen, marks)
        while pen.user.session.stack.canUndo():
            pen.user.session.stack.undo()


def _ends(pen: Pen, dice: random.Random, scale: float) -> Iterator[tuple[complex, Qt.KeyboardModifier]]:
    """Two ends: anywhere, or a few pixels off a pin or off a bar."""
    for _ in range(2):
        off = cmath.rect(dice.uniform(0.0, 16.0), dice.uniform(0.0, 2 * math.pi)) / scale
        places = list(pen.places.values())
        bars = [link for link in pen.design.drive.linkage.links if link.number != 1 and len(link.points) > 1]
        kind = dice.random()
        if places and kind < 0.5:
            at = dice.choice(places) + off
        elif bars and kind < 0.8:
            link = dice.choice(bars)
            first, second = (pen.places[name] for name in list(link.places)[:2])
            at = first + dice.random() * (second - first) + off
        else:
            at = complex(dice.uniform(-240, 240), dice.uniform(-180, 180)) / scale
        yield at, CTRL if dice.random() < 0.15 else NONE


def _check_bar(pen: Pen, marks: list[Snap | None]) -> None:
    """The ends of the last bar are on what their marks have shown, unless it was refused."""
    link = pen.design.drive.linkage.links[-1]
    for name, mark in zip(link.places, marks, strict=False):
        if mark is None or abs(pen.places[name] - mark.at) > 1e-6:
            continue
        others = owners(pen, name) - {link.number}
        if mark.point:
            assert name == mark.point
        elif mark.link is not None:
            assert mark.link in others
        else:
            assert others == set(), (name, mark)


@pytest.mark.stress
@pytest.mark.parametrize("seed", range(3))
def test_no_tool_puts_a_pin_on_another(open_user: Open, seed: int) -> None:
    """Bars, plates, pins, pivots, points, sliders, forces, drags and numbers near pins, at several scales."""
    pen, dice = start(open_user), random.Random(seed)
    clicks = {
        Key.Key_B: 2,
        Key.Key_L: 3,
        Key.Key_S: 2,
        Key.Key_G: 1,
        Key.Key_P: 1,
        Key.Key_T: 1,
        Key.Key_F: 1,
        Key.Key_V: 0,
    }
    for scale in (0.7, 2.3, 5.0):
        zoom(pen, scale)
        for _ in range(22):
            key = dice.choice([*[Key.Key_B] * 3, *clicks])
            pen.key(key)
            for _ in range(clicks[key]):
                pen.click(next(_ends(pen, dice, scale))[0])
            if key == Key.Key_V and len(pen.places) > 1:
                first, second = dice.sample(list(pen.places.values()), 2)
                pen.drag(first, second + cmath.rect(dice.uniform(0.0, 14.0), dice.uniform(0.0, 6.3)) / scale)
            if dice.random() < 0.1:
                pen.type(str(5 * dice.randint(-9, 9)), str(5 * dice.randint(-9, 9)))
            assert coincident(pen) == [], (scale, key, pen.user.steps[-1])
            if pen.user.drawing().drawing.typed.boxes.open:
                pen.key(Key.Key_Escape)
            while pen.user.drawing().drawing.tool_input.snaps:
                pen.key(Key.Key_Escape)
        while pen.user.session.stack.canUndo():
            pen.user.session.stack.undo()


def test_typed_numbers_join_the_pin_or_the_bar_on_which_they_are(open_user: Open) -> None:
    """A length with an angle that ends on a pin, on a bar, and a pivot typed by coordinates."""
    pen = start(open_user)
    pen.drag(0j, 60 + 0j)
    pen.click(60 + 80j)
    pen.type("80", "-90")
    assert set(pen.shape(3)) == {"C", "B"}
    pen.click(30 + 40j)
    pen.type("40", "-90")
    assert owners(pen, "E") == {2, 4}
    assert pen.places["E"] == pytest.approx(30 + 0j, abs=1e-9)
    pen.key(Key.Key_G)
    pen.type("60", "80")
    assert owners(pen, "C") == {1, 3}
    pen.type("15", "0")
    assert owners(pen, "F") == {1, 2}
    assert coincident(pen) == []


def test_a_point_dragged_or_typed_onto_a_pin_joins_it(open_user: Open) -> None:
    """While it is dragged the mark names the pin; dragged on, it is free again; one step of undo takes it back."""
    pen = start(open_user)
    pen.drag(0j, 60 + 0j)
    pen.drag(80 + 30j, 120 + 30j)
    pen.key(Key.Key_Escape)
    sheet, here = pen.canvas.viewport(), pen.at("C")
    QTest.mousePress(sheet, Qt.MouseButton.LeftButton, NONE, here)
    for at in (70 + 10j, 61 + 1j, 80 - 20j, 61 - 1j):
        QTest.mouseMove(sheet, pen.at(at))
        settle()
        assert ("C" in pen.places) == (abs(at - 60) > 10)
    QTest.mouseRelease(sheet, Qt.MouseButton.LeftButton, NONE, pen.at(61 - 1j))
    settle()
    assert owners(pen, "B") == {2, 3}
    assert pen.user.steps[-1] == "Move C"
    pen.key(Key.Key_Z, CTRL)
    assert pen.places["C"] == 80 + 30j
    pen.click("D")
    pen.key(Key.Key_Return, SHIFT)
    pen.type("-20", "-30")  # in the frame of its bar
    assert owners(pen, "B") == {2, 3}
    assert coincident(pen) == []


@pytest.mark.stress
def test_what_is_pasted_twice_is_not_on_itself(open_user: Open) -> None:
    pen = four_bar(open_user)
    pen.key(Key.Key_A, CTRL)
    pen.key(Key.Key_C, CTRL)
    pen.key(Key.Key_V, CTRL)
    pen.key(Key.Key_V, CTRL)
    assert len(pen.places) == 12
    assert coincident(pen) == []
