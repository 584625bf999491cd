"""Obstacles of an optimal law are hatched fields in the displacement diagram, whose edges the mouse drags."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from window_user import Open, User, settle

from core.design import CurveBound, OptimalCurve, edited, require_motion
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.motion.editor import MotionEditor
from kindyna_gui.motion.obstacles import obstacle_fields

PATH = "motion.segments[1]"
LEFT = Qt.MouseButton.LeftButton
NONE = Qt.KeyboardModifier.NoModifier


@pytest.fixture
def user(same_window: Open) -> User:
    user = same_window(size=(1440, 900), whole=True)
    user.choose("View", "Make")
    design = edited(edited(user.design, f"{PATH}.law", "optimal"), f"{PATH}.below", (CurveBound(0.0, 0.4, 0.25),))
    user.session.lay_out(design, "Choose the optimal law")
    user.motion().choose(1)
    settle()
    return user


def bounds(user: User, key: str = "below") -> tuple[CurveBound, ...]:
    curve = require_motion(user.session.typed).segments[1].curve
    assert isinstance(curve, OptimalCurve)
    rows: tuple[CurveBound, ...] = getattr(curve, key)
    return rows


def place(user: User, part: float, rise: float) -> QPoint:
    """Pixel of the diagram at a fraction of the span and of the rise."""
    return user.motion().diagram.position_of(35.0 + 41.5 * part, 150.0 - 150.0 * rise).toPoint()


def drag(diagram: MotionEditor, *way: QPoint, release: bool = True) -> None:
    QTest.mouseMove(diagram.viewport(), way[0])
    QTest.mousePress(diagram.viewport(), LEFT, NONE, way[0])
    for at in way[1:]:
        QTest.mouseMove(diagram.viewport(), at)
        settle()
    if release:
        QTest.mouseRelease(diagram.viewport(), LEFT, NONE, way[-1])
        settle()


def fallen(user: User, end: float) -> float:
    """Largest fraction of the rise up to a fraction of the span."""
    compiled = user.session.study.program
    theta = np.deg2rad(35.0 + 41.5 * np.linspace(1e-9, end, 501))
    return float(((0.150 - compiled.state(compiled.angles(theta)).y[0]) / 0.150).max())


def test_the_field_covers_the_side_that_the_law_avoids(user: User) -> None:
    diagram = user.motion().diagram
    motion = require_motion(user.design)
    ((obstacle, field, level),) = obstacle_fields(motion, diagram.scale_now())
    assert (obstacle.segment, obstacle.key) == (1, "below")
    scale = diagram.scale_now()
    assert (field.left(), field.right()) == pytest.approx((scale.x(35.0), scale.x(35.0 + 0.4 * 41.5)))
    assert level == pytest.approx(scale.y(150.0 - 0.25 * 150.0))
    assert field.bottom() == pytest.approx(scale.bottom), "a return passes below the rise, above the tool"


def test_the_level_is_dragged_and_the_law_follows(user: User) -> None:
    diagram, steps = user.motion().diagram, len(user.steps)
    drag(diagram, place(user, 0.2, 0.25), place(user, 0.2, 0.2), place(user, 0.2, 0.15), release=False)
    assert fallen(user, 0.4) <= bounds(user)[0].rise + 1e-9
    assert bounds(user)[0].rise == pytest.approx(0.15, abs=0.02), "before the button is released"
    QTest.mouseRelease(diagram.viewport(), LEFT, NONE, place(user, 0.2, 0.15))
    settle()
    rise = bounds(user)[0].rise
    assert bounds(user) == (CurveBound(0.0, 0.4, rise),)
    assert user.steps[steps:] == [f"Move rise of obstacle below 1 of segment 2 to {rise:g}"]
    user.choose("Edit", f"Undo {user.steps[-1]}")
    assert bounds(user) == (CurveBound(0.0, 0.4, 0.25),)


def test_the_end_is_dragged(user: User) -> None:
    drag(user.motion().diagram, place(user, 0.4, 0.7), place(user, 0.45, 0.7), place(user, 0.5, 0.7))
    (bound,) = bounds(user)
    assert bound.end == pytest.approx(0.5, abs=0.01)
    assert fallen(user, bound.end) <= 0.25 + 1e-9


def test_escape_restores_the_obstacle(user: User) -> None:
    diagram = user.motion().diagram
    drag(diagram, place(user, 0.2, 0.25), place(user, 0.2, 0.15), release=False)
    diagram.setFocus()
    QTest.keyClick(diagram, Qt.Key.Key_Escape)
    QTest.mouseRelease(diagram.viewport(), LEFT, NONE, place(user, 0.2, 0.15))
    settle()
    assert bounds(user) == (CurveBound(0.0, 0.4, 0.25),)


def test_a_place_that_no_law_passes_is_refused(user: User) -> None:
    before = bounds(user)
    drag(user.motion().diagram, place(user, 0.4, 0.7), place(user, 1.0, 0.7))
    assert bounds(user) == before, "the law is at 1 there"
    assert user.session.incomplete is None


def test_joins_go_before_obstacles(user: User) -> None:
    """The start of the obstacle is at the start of the segment: there the join is dragged."""
    drag(user.motion().diagram, place(user, 0.0, 0.6), place(user, -0.1, 0.6))
    assert require_motion(user.design).segments[0].span_deg < 35.0
    assert bounds(user)[0].start == 0.0


def test_an_obstacle_is_added_from_the_menu_of_the_diagram(user: User) -> None:
    diagram = user.motion().diagram
    diagram.menu_requested.emit(diagram.mapToGlobal(place(user, 0.7, 0.5)), 35.0 + 0.7 * 41.5)
    menu = next(
        menu for menu in diagram.findChildren(type(user.window.menuBar().actions()[0].menu())) if menu.isVisible()
    )
    action = next(action for action in menu.actions() if action.text() == "Add obstacle above")
    action.trigger()
    menu.close()
    settle()
    (bound,) = bounds(user, "above")
    assert bound.start == pytest.approx(0.7, abs=0.01)
    assert bound.end == 1.0
    table = user.motion().curve.points
    assert table is not None
    assert table.list.key == "above"


def test_the_inspector_has_the_rise_of_the_segment_alone(user: User) -> None:
    user.window.show_fields("motion")
    settle()
    texts = [label.accessibleName() for label in user.parameters().findChildren(NumberBox) if label.isVisible()]
    assert texts.count("Rise") == 1
