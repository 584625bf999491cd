"""The lecture on velocity analysis in the window: its figures opened, read off the screen and set in motion.

Print against screen: pages 6, 7, 8 (centres), 9, 10 (velocities), 11 (the six-bar's numbers), 12 (the suspension).
"""

import re

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QTableView
from sampled import spread, stressed
from window_user import Open, User, settle, wait_for

from kindyna_gui.linkage.centres_view import CentresView, CircleView
from kindyna_gui.linkage.mechanism_view import MechanismView
from kindyna_gui.places import example

PRINT = 0.02  # cm, rpm, cm/s: the print rounds its intermediates
ON_SCREEN = 1e-3  # of what is computed from the four digits on the screen
FIGURES = {"Four bar": 6, "Slider crank": 6, "Lecture six bar": 15, "Rear suspension": 6}


@pytest.fixture
def open_user(same_window: Open) -> Open:
    """One window for all tests of this file."""
    return same_window


def opened(open_user: Open, name: str) -> User:
    """With its tables beside it."""
    user: User = open_user(example(name.lower().replace(" ", "_")))
    user.choose("Compo", "Instant centres")
    view = centres(user)
    wait_for(lambda: view.up_to_date and view.on_screen())
    return user


def centres(user: User) -> CentresView:
    view = user.window.view("centres")
    assert isinstance(view, CentresView)
    wait_for(lambda: not view.busy)
    return view


def at(user: User, degrees: str) -> None:
    """Typed into the box of the player."""
    box = user.window.bar.angle
    box.setFocus()
    box.selectAll()
    user.type(degrees)
    user.press(Qt.Key.Key_Return)


def number(text: str) -> float:
    return float(re.sub(r"[^0-9.\-]", "", text.replace("\u2212", "-")))


def table(view: QTableView) -> dict[str, dict[str, str]]:
    """What stands in the cells: first cell -> heading -> text."""
    model = view.model()
    heads = [str(model.headerData(c, Qt.Orientation.Horizontal)) for c in range(model.columnCount())]
    rows = [[str(model.index(r, c).data()) for c in range(model.columnCount())] for r in range(model.rowCount())]
    return {row[0]: dict(zip(heads[1:], row[1:], strict=True)) for row in rows}


def places(user: User) -> dict[str, complex]:
    """Points and finite centres as the cells have them [mm]."""
    view = centres(user)
    found = {}
    for rows in (table(view.page("points")), table(view.page("centres"))):
        for name, row in rows.items():
            if row["x, mm"] not in ("at infinity", "none"):
                found[name] = complex(number(row["x, mm"]), number(row["y, mm"]))
    return found


def distance(user: User, one: str, other: str) -> float:
    """Chosen in the two boxes below the table, read from the label [cm]."""
    view = centres(user)
    for box, text in ((view.first, one), (view.second, other)):
        box.setCurrentIndex(box.findText(text))
        box.activated.emit(box.currentIndex())
    return number(view.distance.text()) / 10.0


def off_line(a: complex, b: complex, c: complex) -> float:
    """How far a lies from the line through b and c, of its distance to them."""
    return abs(((a - b) / (c - b)).imag * abs(c - b)) / (abs(a - b) + abs(c - b))


@pytest.mark.stress
def test_page_11_stands_on_the_screen(open_user: Open) -> None:
    """20.07, 16.39 cm; 6.64, 20.57, 20.57 rpm; 22.39 cm/s, signs being the print's arrows."""
    user = open_user()
    user.choose("File", "Examples", "Lecture six bar")
    user.choose("Compo", "Instant centres")
    wait_for(lambda: centres(user).up_to_date and centres(user).on_screen())
    at(user, "45")
    assert distance(user, "I12", "I13") == pytest.approx(20.07, abs=PRINT)
    assert distance(user, "I14", "I13") == pytest.approx(16.39, abs=PRINT)
    assert distance(user, "I12", "I14") == pytest.approx(6.0, abs=PRINT)
    rpm = {link: number(row["ω, rpm"]) for link, row in table(centres(user).page("links")).items()}
    assert rpm["2"] == pytest.approx(60.0, abs=1e-6)
    assert [rpm[link] for link in "345"] == pytest.approx([-6.64, 20.57, -20.57], abs=PRINT)
    slider = table(centres(user).page("points"))["D"]
    assert number(slider["vx, mm/s"]) / 10.0 == pytest.approx(-22.39, abs=PRINT)
    assert number(slider["vy, mm/s"]) == 0.0
    assert number(slider["|v|, mm/s"]) / 10.0 == pytest.approx(22.38, abs=PRINT)


def test_the_centres_of_page_11_outside_the_picture_come_into_it(open_user: Open) -> None:
    user = opened(open_user, "Lecture six bar")
    at(user, "45")
    drawing = user.drawing()
    there = {name: place for name, place in places(user).items() if name.startswith("I")}
    assert len(there) == FIGURES["Lecture six bar"] - 1

    def outside() -> int:
        visible = drawing.canvas.visible
        return sum(not visible.contains(place.real, place.imag) for place in there.values())

    user.choose("View", "Fit drawing")
    assert outside() >= 2  # I13 and I15 stand above it
    user.choose("Compo", "Fit centres")
    assert outside() == 0
    assert drawing.scene.layer_shown("centres")
    user.choose("View", "Fit drawing")
    assert outside() >= 2


def test_the_ratios_on_page_9_are_distances_on_the_screen(open_user: Open) -> None:
    """ω4/ω2 = (I12I24)/(I14I24), ω3/ω2 = (I12I23)/(I13I23), ω4/ω3 = (I13I34)/(I14I34)."""
    user = opened(open_user, "Four bar")
    at(user, "70")
    rpm = {link: number(row["ω, rpm"]) for link, row in table(centres(user).page("links")).items()}
    for base, body in ("24", "23", "34"):
        common = f"I{base}{body}"
        by_distance = distance(user, f"I1{base}", common) / distance(user, f"I1{body}", common)
        assert by_distance == pytest.approx(abs(rpm[body] / rpm[base]), rel=ON_SCREEN)


def test_the_sliders_velocity_on_page_10_is_a_distance_times_the_cranks(open_user: Open) -> None:
    user = opened(open_user, "Slider crank")
    at(user, "50")
    crank = number(table(centres(user).page("links"))["2"]["ω, rad/s"])
    speed = number(table(centres(user).page("points"))["B"]["|v|, mm/s"]) / 10.0
    assert distance(user, "I12", "I24") * crank == pytest.approx(speed, rel=ON_SCREEN)


@pytest.mark.parametrize("name", spread(FIGURES, 2))
def test_centres_stand_where_the_lecture_constructs_them(name: str, open_user: Open) -> None:
    """Each that is not known at sight lies on the two lines that its row names."""
    user = opened(open_user, name)
    for degrees in ("20", "200"):
        at(user, degrees)
        there, tried = places(user), 0
        rows = table(centres(user).page("centres"))
        assert len(rows) == FIGURES[name]
        for centre, row in rows.items():
            for line in row["Construction"].split(" × ") if row["Construction"] != "at sight" else ():
                one, other = line.split("–")
                if {centre, one, other} <= set(there):
                    tried += 1
                    assert off_line(there[centre], there[one], there[other]) < ON_SCREEN, (centre, line)
        assert tried >= 2


def test_the_suspension_on_page_12_steers_by_what_the_screen_says(open_user: Open) -> None:
    """The wheel goes across the line to I13, and so a little along the car."""
    user = opened(open_user, "Rear suspension")
    at(user, "30")
    there, wheel = places(user), table(centres(user).page("points"))["W"]
    velocity = complex(number(wheel["vx, mm/s"]), number(wheel["vy, mm/s"]))
    arm = there["W"] - there["I13"]
    assert abs((velocity * arm.conjugate()).real) < ON_SCREEN * abs(velocity) * abs(arm)
    assert abs(velocity.real) > 1.0


@pytest.mark.parametrize("name", spread(FIGURES, 1))
def test_each_figure_moves_with_all_that_is_drawn_on_it(name: str, open_user: Open) -> None:
    """Space plays; drawing, table and construction go along, and Space stops."""
    user = opened(open_user, name)
    view = user.window.view("mechanism")
    assert isinstance(view, MechanismView)
    for layer in (
        "Instant centres of all links",
        "Kennedy's construction",
        "Velocities",
        "Velocity ratios to the driver",
    ):
        user.choose("View", "Layers of the drawing", layer)
    at(user, "40")
    before, index = table(centres(user).page("centres")), view.scene.index
    view.canvas.setFocus()
    user.press(Qt.Key.Key_Space)
    assert user.window.player.playing
    wait_for(lambda: view.scene.index != index and table(centres(user).page("centres")) != before)
    user.press(Qt.Key.Key_Space)
    assert not user.window.player.playing
    settle()
    assert view.scene.linkage_layers is not None
    assert view.scene.linkage_layers.marks is not None
    there = places(user)
    for mark in view.scene.linkage_layers.marks.marks:
        if mark.dot.isVisible():
            drawn = complex(mark.dot.pos().x(), mark.dot.pos().y())
            told = there[f"I{mark.name}"]
            assert abs(drawn - told) < 0.05 * (abs(told) + 100.0), "within the step of the drawing's samples"


@pytest.mark.parametrize(
    ("name", "steps"),
    [
        ("Four bar", 2),
        stressed("Slider crank", 2),
        stressed("Lecture six bar", 8),
        ("Rear suspension", 2),
    ],
)
def test_the_circle_diagram_is_played_to_its_end(name: str, steps: int, open_user: Open) -> None:
    """After the last step every line is solid but the one just found; in the drawing all centres are there."""
    user = open_user(example(name.lower().replace(" ", "_")))
    user.choose("Compo", "Circle diagram")
    view = user.window.view("circle")
    assert isinstance(view, CircleView)
    wait_for(lambda: view.up_to_date and view.on_screen())
    n = len(view.diagram.bodies)
    assert len(view.diagram.solid) + steps == n * (n - 1) // 2
    for step in range(1, steps + 1):
        view.next.click()
        settle()
        assert view.diagram.target is not None
        assert len(view.diagram.dotted) == steps - step + 1
        lines = re.findall(r"(\d+)–(\d+)", view.text.text())
        solid = {"".join(str(1 if b == "frame" else b[-1]) for b in key) for key in view.diagram.solid}
        assert len(lines) == 2
        assert {name for line in lines for name in line} <= solid
    scene = user.window.view("mechanism").scene  # type: ignore[union-attr]
    shown = [m for m in scene.linkage_layers.marks.marks if m.dot.isVisible() or m.arrow.isVisible()]
    assert len(shown) == n * (n - 1) // 2
