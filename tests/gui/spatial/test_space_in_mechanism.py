"""A cam in space in the drawing of the mechanism: side view and end view, parts under the mouse, several drives."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QContextMenuEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu
from window_user import Open, User, pixel, settle, wait_for

from kindyna_gui.drives import ON_SHAFT, SIDE_BY_SIDE
from kindyna_gui.places import example

LEFT = Qt.MouseButton.LeftButton


def figures(user: User) -> dict[str, object]:
    return user.drawing().scene.parts


def box(user: User, key: str):
    return user.drawing().scene.item(key).sceneBoundingRect()


def middle(user: User, key: str) -> complex:
    at = box(user, key).center()
    return complex(at.x(), at.y())


def click(user: User, at: complex) -> None:
    canvas = user.drawing().canvas
    QTest.mouseClick(canvas.viewport(), LEFT, pos=pixel(canvas, at))
    settle()


def menu_texts(user: User, at: complex) -> list[str]:
    view = user.drawing()
    viewport = view.canvas.viewport()
    spot: QPoint = pixel(view.canvas, at)
    QApplication.sendEvent(
        viewport, QContextMenuEvent(QContextMenuEvent.Reason.Mouse, spot, viewport.mapToGlobal(spot))
    )
    settle()
    (menu,) = (menu for menu in view.findChildren(QMenu) if menu.isVisible())
    result = [action.text() for action in menu.actions() if action.text()]
    menu.close()
    return result


def test_the_drawing_has_the_views_to_scale_and_moves_with_the_cam(open_user: Open) -> None:
    """Barrel feeder: blank 110 x 164 mm, roller of radius 10 mm, rise of 40 mm, middle of the roller at 0 ... 40 mm."""
    user = open_user(example("barrel_feeder"))
    user.turn(0.0)
    user.drawing()
    items = {key: part.item for key, part in figures(user).items()}
    body, end = box(user, "cam"), box(user, "cam.end")
    assert (body.width(), body.height(), end.width()) == pytest.approx((110.0, 164.0, 164.0), abs=0.01)
    assert body.center().y() == pytest.approx(end.center().y())
    assert end.left() > body.right()
    assert box(user, "roller1").width() == pytest.approx(20.0, abs=0.05)
    start = middle(user, "roller1")
    assert body.center().x() - start.real == pytest.approx(20.0, abs=1e-6)
    user.turn(150.0)
    assert middle(user, "roller1") - start == pytest.approx(40.0, abs=1e-6)
    assert middle(user, "stem.roller1").real == pytest.approx(middle(user, "roller1").real)
    assert user.drawing().scene.item("zero").rotation() % 360.0 == pytest.approx((90.0 + 150.0) % 360.0)
    assert {key: part.item for key, part in figures(user).items()} == items


def test_material_behind_other_material_leaves_no_gap(open_user: Open) -> None:
    """Half a turn from the rollers the walls of an indexer run across: the areas of the side view overlap there."""
    user = open_user(example("globoidal_indexer"))
    user.turn(100.0)
    user.drawing()
    path = user.drawing().scene.item("cam.rest").path()
    areas, room = path.toSubpathPolygons(), path.boundingRect()
    overlaps = 0
    for x, y in np.random.default_rng(1).uniform(0.0, 1.0, (400, 2)):
        point = QPointF(room.left() + x * room.width(), room.top() + y * room.height())
        count = sum(area.containsPoint(point, Qt.FillRule.OddEvenFill) for area in areas)
        assert path.contains(point) == (count > 0)
        overlaps += count > 1
    assert overlaps > 40


def test_the_turret_of_an_indexer_turns_about_its_pivot(open_user: Open) -> None:
    user = open_user(example("globoidal_indexer"))
    for degrees, turret in ((0.0, 30.0), (300.0, 60.0)):
        user.turn(degrees)
        user.drawing()
        assert np.angle(middle(user, "roller1"), deg=True) == pytest.approx(turret, abs=0.05)
    user.turn(0.0)
    assert abs(middle(user, "roller1")) == pytest.approx(56.0, abs=0.05)
    assert middle(user, "cam.end").real == pytest.approx(120.0)


def test_parts_under_the_mouse_have_names_and_open_their_fields(open_user: Open) -> None:
    user = open_user(example("barrel_feeder"))
    user.turn(150.0)
    user.drawing()
    roller, cam = middle(user, "roller1"), middle(user, "cam")
    assert menu_texts(user, roller)[:4] == [
        "Roller", "Edit Roller radius", "Find Roller radius...", "Vary Roller radius"
    ]  # fmt: skip
    texts = menu_texts(user, cam + 20.0)
    assert texts[:3] == ["Barrel cam", "Edit Inner distance", "Find Inner distance..."]
    assert "Explain pressure angle here" in texts
    assert "Export solid and surfaces..." in texts
    for at, path in ((roller, "cam.roller_radius_mm"), (middle(user, "cam.end") + 60.0, "cam.roller_inner_mm")):
        user.field("shaft.speed_rpm")
        click(user, at)
        focus = QApplication.focusWidget()
        field = user.parameters().field(path)
        assert field is not None
        assert focus is not None
        assert focus is field.editor or field.editor.isAncestorOf(focus)


def test_the_mouse_reads_the_pressure_angle_on_an_edge(open_user: Open) -> None:
    """Where the cycloidal rise of 40 mm over 120° is steepest, at its middle: tan ψ = 2 h/(β u) at the blank's radius of 82 mm."""
    user = open_user(example("barrel_feeder"))
    user.turn(120.0)
    canvas, views = user.drawing().canvas, user.drawing().scene.geometry.space
    angle = np.deg2rad(120.0)
    line = next(line for line in views.lines if line.side == "ahead")
    k = int(np.argmin(np.abs(line.theta - np.deg2rad(60.0))))
    x, y, z = line.point[:, k]
    assert np.sin(angle) * x + np.cos(angle) * y > 0.0, "it faces the viewer"
    at = 1e3 * (views.origin + z + 1j * (np.cos(angle) * x - np.sin(angle) * y))
    QTest.mouseMove(canvas.viewport(), pixel(canvas, at))
    settle()
    steepest = np.rad2deg(np.arctan(2.0 * 40.0 / np.deg2rad(120.0) / 82.0))
    reading = user.drawing().scene.overlay.reading_text
    number = re.search(r"Flank ahead at (\d+\.\d)°: pressure angle (\d+\.\d)°, u 82", reading)
    assert number is not None, reading
    assert float(number[2]) == pytest.approx(steepest, abs=0.3)
    assert float(number[1]) == pytest.approx(60.0, abs=6.0)


def test_circles_of_a_barrel_are_dragged_in_one_step_each(open_user: Open) -> None:
    user = open_user(example("barrel_feeder"))
    user.turn(150.0)
    before = user.design
    axis = middle(user, "cam.end")
    diagonal = np.exp(-0.75j * np.pi)
    user.drag(axis + 82.0 * diagonal, axis + 90.0 * diagonal)
    assert user.design.drive.cam.outer_radius_mm == pytest.approx(90.0, abs=1.0)
    assert box(user, "cam.end").width() == pytest.approx(2.0 * user.design.drive.cam.outer_radius_mm, abs=0.01)
    user.choose("Edit", f"Undo {user.steps[-1]}")
    assert user.design == before
    user.drag(axis + 70.0 * diagonal, axis + 74.0 * diagonal)
    assert user.design.drive.cam.roller_inner_mm == pytest.approx(74.0, abs=1.0)


def test_a_roller_of_a_turret_has_its_number(open_user: Open) -> None:
    user = open_user(example("globoidal_indexer"))
    user.turn(0.0)
    user.drawing()
    assert menu_texts(user, middle(user, "roller3"))[0] == "Roller 3"
    assert menu_texts(user, middle(user, "turret") + 30.0j)[0] == "Turret"


def test_an_edit_is_drawn_and_the_pinned_variant_stays(open_user: Open) -> None:
    user = open_user(example("barrel_feeder"))
    user.choose("Edit", "Pin this variant")
    user.enter("cam.roller_radius_mm", "8")
    user.drawing()
    assert box(user, "roller1").width() == pytest.approx(16.0, abs=0.05)
    user.enter("cam.length_mm", "120")
    user.drawing()
    assert box(user, "cam").width() == pytest.approx(120.0, abs=0.01)
    user.enter("cam.bore_mm", "50")
    user.drawing()
    assert box(user, "bore").width() == pytest.approx(50.0, abs=5.0), "with its keyway"
    with_pin = user.drawing().canvas.grab().toImage()
    user.choose("Edit", "Unpin")
    settle()
    assert user.drawing().canvas.grab().toImage() != with_pin


def test_a_cam_that_is_not_possible_leaves_the_output_and_a_sentence(open_user: Open, tmp_path: Path) -> None:
    path = tmp_path / "short.toml"
    path.write_text(
        example("globoidal_indexer").read_text("utf-8").replace("length_mm = 100.0", "length_mm = 20.0"), "utf-8"
    )
    user = open_user(path)
    user.drawing()
    assert "cam" not in figures(user)
    assert "body.output" in figures(user)
    assert user.drawing().note.text().startswith("No cam: ")


def test_several_drives_are_drawn_together_and_turned_by_the_end_view(open_user: Open, tmp_path: Path) -> None:
    user = open_user(example("transfer_unit"))
    drives = user.window.show_view("drives")
    settle()
    menu = drives.buttons["add"].menu()
    menu.aboutToShow.emit()
    next(entry for entry in menu.actions() if entry.text() == "Barrel cam").trigger()
    settle()
    number = len(user.session.full_design.drives) - 1
    view = user.drawing()
    for arrangement in (SIDE_BY_SIDE, ON_SHAFT):
        view.strip.arrangements[arrangement].trigger()
        settle()
        view.pull()
        figure = view.assembly.figures[number]
        assert {"cam", "cam.end", "roller1"} <= {part.key for part in figure.parts}
        at = next(part for part in figure.parts if part.key == "cam.end").item.sceneBoundingRect().center()
        assert figure.axis == pytest.approx(complex(at.x(), at.y()))
    assert figure.axis == pytest.approx(0.0)
    view.strip.arrangements[SIDE_BY_SIDE].trigger()
    settle()
    view.pull()
    figure = view.assembly.figures[number]
    start = figure.axis + 60.0
    canvas = view.all_canvas
    phase = user.session.full_design.drives[number].phase_deg
    points = [pixel(canvas, figure.axis + 60.0 * np.exp(1j * np.deg2rad(a))) for a in (0.0, 10.0, 20.0)]
    QTest.mousePress(canvas.viewport(), LEFT, pos=pixel(canvas, start))
    for at in points[1:]:
        QTest.mouseMove(canvas.viewport(), at)
        settle()
    QTest.mouseRelease(canvas.viewport(), LEFT, pos=points[-1])
    wait_for(lambda: user.session.full_design.drives[number].phase_deg != phase)
    turned = user.session.full_design.drives[number].phase_deg - phase
    assert abs(abs((turned + 180.0) % 360.0 - 180.0) - 20.0) <= 3.0


def test_the_output_of_a_motion_alone_is_under_the_mouse_too(open_user: Open, tmp_path: Path) -> None:
    path = tmp_path / "feed.toml"
    text = example("barrel_feeder").read_text("utf-8")
    start, end = text.index("[cam]"), text.index("[shaft]")
    path.write_text(text[:start] + text[end:], "utf-8")
    user = open_user(path)
    user.turn(150.0)
    user.drawing()
    assert menu_texts(user, middle(user, "block.guide"))[:2] == ["Output", "Edit Driven mass"]
    assert "cam" not in figures(user)
