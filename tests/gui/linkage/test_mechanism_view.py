"""kindyna_gui.linkage.mechanism_view: the drawing follows the cam, keeps what is looked at, and computes only what it draws."""

from collections.abc import Callable
from io import BytesIO
from math import degrees, radians

import numpy as np
import pytest
from mechanisms import LIFT, PUSHER, with_follower
from PIL import Image
from plot_reading import labels
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from window_user import Alone, Open, User, plain, settle, wait_for

from core.design import Design
from core.study import evaluations
from kindyna_gui.documents.session import Session
from kindyna_gui.linkage.mechanism_view import MechanismView
from kindyna_gui.pictures.drawing.parts import LAYERS
from kindyna_gui.places import example
from kindyna_gui.player import Player

Show = Callable[..., MechanismView]


@pytest.fixture
def open_user(same_window: Open) -> Open:
    """One window for all tests of this file."""
    return same_window


@pytest.fixture
def show(alone: Alone) -> Show:
    """Shows the drawing of a design in a window of its own."""

    def make(design: Design = LIFT) -> MechanismView:
        return alone(MechanismView(Session(design), Player()), 640, 520)

    return make


def wheel(view: MechanismView, at: QPointF, notches: float) -> None:
    """Turn the wheel over a place of the drawing."""
    viewport = view.canvas.viewport()
    event = QWheelEvent(
        at,
        QPointF(viewport.mapToGlobal(at.toPoint())),
        QPoint(),
        QPoint(0, round(120 * notches)),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    QApplication.sendEvent(viewport, event)


def place(view: MechanismView, pixel: QPointF) -> complex:
    """The place of the mechanism [mm] under a pixel, by Qt's own account."""
    at = view.canvas.viewportTransform().inverted()[0].map(pixel)
    return complex(at.x(), at.y())


def drag(view: MechanismView, start: QPoint, end: QPoint, button: Qt.MouseButton) -> None:
    viewport = view.canvas.viewport()
    QTest.mousePress(viewport, button, pos=start)
    QTest.mouseMove(viewport, (start + end) / 2)
    QTest.mouseMove(viewport, end)
    QTest.mouseRelease(viewport, button, pos=end)


def look(view: MechanismView) -> tuple[float, float, float]:
    """Scale and centre of what is visible."""
    centre = view.canvas.visible.center()
    return view.canvas.scale_now, centre.x(), centre.y()


# -- motion -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("design", [LIFT, PUSHER], ids=lambda d: d.name)
def test_the_drawing_follows_the_cam(design: Design, show: Show) -> None:
    view = show(design)
    study = view.session.study
    for index in (0, 271, 900, 1799):
        view.player.set_theta(float(study.theta[index]))
        cam, roller = view.scene.item("cam"), view.scene.item("roller")
        assert cam.rotation() == pytest.approx(study.design.shaft.sense * degrees(study.theta[index]))
        centre = study.linkage.follower.z[0][index] * 1e3
        assert complex(roller.pos().x(), roller.pos().y()) == pytest.approx(centre, rel=1e-12)


def test_nothing_is_made_anew_in_motion(show: Show) -> None:
    view = show()
    before = [id(item) for item in view.scene.items()]
    evaluations.clear()
    for step in range(40):
        view.player.set_theta(0.1 * step)
        QApplication.processEvents()
    assert [id(item) for item in view.scene.items()] == before
    assert not evaluations


def test_the_angle_told_is_the_one_asked_for(show: Show) -> None:
    """Between the samples of the screen, too."""
    view = show()
    view.player.step(0.1)
    assert view.scene.overlay is not None
    assert view.scene.overlay.text == "Cam angle 0.1°"


# -- sight ------------------------------------------------------------------------------------------------


def test_the_mechanism_fits_when_it_is_first_seen(show: Show) -> None:
    view = show()
    whole, visible = view.scene.fit_rect(), view.canvas.visible
    assert view.canvas.fitted
    assert visible.contains(whole)
    assert max(whole.width() / visible.width(), whole.height() / visible.height()) > 0.8


def test_the_wheel_zooms_about_the_mouse(show: Show) -> None:
    view = show()
    at = QPointF(431.0, 117.0)
    before, scale = place(view, at), view.canvas.scale_now
    for notches in (1.0, 3.0, -2.0, 0.25):
        wheel(view, at, notches)
        assert place(view, at) == pytest.approx(before, abs=1.5 / view.canvas.scale_now)
    assert view.canvas.scale_now == pytest.approx(scale * 1.25**2.25)
    assert not view.canvas.fitted


def test_zoom_has_its_ends(show: Show) -> None:
    view = show()
    usual = view.canvas.scale_now
    wheel(view, QPointF(300.0, 200.0), 200.0)
    assert view.canvas.scale_now == pytest.approx(400.0 * usual)
    wheel(view, QPointF(300.0, 200.0), -400.0)
    assert view.canvas.scale_now == pytest.approx(0.05 * usual)


@pytest.mark.parametrize("button", [Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton])
def test_what_is_dragged_stays_under_the_mouse(button: Qt.MouseButton, show: Show) -> None:
    view = show()
    start, end = QPoint(200, 150), QPoint(287, 93)
    before, scale = place(view, QPointF(start)), view.canvas.scale_now
    drag(view, start, end, button)
    assert place(view, QPointF(end)) == pytest.approx(before, abs=1.5 / scale)
    assert view.canvas.scale_now == scale


@pytest.mark.parametrize("way", ["double click", "F", "menu"])
def test_fit_brings_everything_back(way: str, user: User) -> None:
    view = user.window.view("mechanism")
    assert isinstance(view, MechanismView)
    before = look(view)
    wheel(view, QPointF(50.0, 60.0), 7.0)
    drag(view, QPoint(100, 100), QPoint(180, 190), Qt.MouseButton.MiddleButton)
    assert look(view) != before
    if way == "double click":
        QTest.mouseDClick(view.canvas.viewport(), Qt.MouseButton.LeftButton, pos=QPoint(90, 90))
    elif way == "F":
        view.setFocus()
        user.press(Qt.Key.Key_F)
    else:
        user.choose("View", "Fit drawing")
    assert look(view) == pytest.approx(before)
    assert view.canvas.fitted


def test_an_edit_keeps_what_is_looked_at(show: Show) -> None:
    view = show()
    wheel(view, QPointF(321.0, 222.0), 4.0)
    before = look(view)
    for rod in (850.0, 900.0, 845.0):
        assert view.session.edit("follower.rod_mm", rod, "a")
    view.session.stack.undo()
    assert look(view) == before


def test_a_fitted_mechanism_that_outgrows_its_picture_is_fitted_anew(show: Show) -> None:
    view = show()
    before = look(view)
    assert view.session.edit("cam.base_radius_mm", 401.0, "a")
    assert look(view) == before, "a small edit moves nothing"
    larger = with_follower(LIFT, slider_arm_mm=2604.324, rod_mm=1690.0, guide_height_mm=2600.0, roller_arm_mm=1302.162)
    view.session.start(with_follower(larger, pivot_x_mm=1747.492, pivot_y_mm=-130.0))
    assert view.canvas.visible.contains(view.scene.fit_rect())


def test_another_design_is_fitted(user: User) -> None:
    view = user.window.view("mechanism")
    assert isinstance(view, MechanismView)
    wheel(view, QPointF(200.0, 200.0), 6.0)
    user.choose("File", "Examples", "Card picker")
    assert view.canvas.fitted
    assert view.canvas.visible.contains(view.scene.fit_rect())


def test_another_size_fits_what_was_fitted_and_keeps_what_was_not(show: Show) -> None:
    view = show()
    view.resize(500, 620)
    settle()
    assert view.canvas.visible.contains(view.scene.fit_rect())
    wheel(view, QPointF(100.0, 100.0), 3.0)
    before = look(view)
    view.resize(640, 500)
    settle()
    assert look(view) == pytest.approx(before)


def test_labels_keep_their_sides_while_editing_and_settle_afterwards(show: Show) -> None:
    view = show()
    sides = labels(view.scene)
    assert sides
    view.session.edit("follower.guide_height_mm", 1330.0, "a")
    assert labels(view.scene) == pytest.approx(sides, abs=0.1)
    wait_for(lambda: not view.canvas.rest.isActive())
    fresh = MechanismView(Session(view.session.design), Player())
    fresh.pull()
    fresh.scene.show_region(view.canvas.visible, view.canvas.scale_now)
    assert labels(view.scene) == pytest.approx(labels(fresh.scene), abs=0.1)
    fresh.deleteLater()


# -- layers -----------------------------------------------------------------------------------------------


def test_every_layer_has_its_action(show: Show) -> None:
    view = show()
    actions = view.layer_actions()
    without = (
        "twist",
        "modulo",
        "outlines",
    )  # of a flexible shaft, of a motion that does not come back, of bodies with outlines
    layers = {name: layer for name, layer in LAYERS.items() if name not in without}
    assert [action.text() for action in actions] == [layer.label for layer in layers.values()]
    for action, (name, layer) in zip(actions, layers.items(), strict=True):
        assert action.isCheckable()
        assert action.isChecked() == layer.shown == view.scene.layer_shown(name)
        action.trigger()
        settle()
        assert view.scene.layer_shown(name) is not layer.shown


def test_layers_are_switched_by_the_menu(user: User) -> None:
    view = user.window.view("mechanism")
    assert isinstance(view, MechanismView)
    assert view.scene.item("pitch").isVisible()
    assert user.entries("View", "Layers of the drawing") == [plain(a.text()) for a in view.layer_actions()] != []
    menu = user.action("View", "Layers of the drawing").menu()
    assert menu is not None
    menu.aboutToShow.emit()  # type: ignore[attr-defined]
    next(a for a in menu.actions() if plain(a.text()) == "Pitch curve").trigger()  # type: ignore[attr-defined]
    settle()
    assert not view.scene.item("pitch").isVisible()
    user.session.edit("follower.rod_mm", 850.0, "a")
    assert not view.scene.item("pitch").isVisible(), "an edit brings no layer back"


def test_forces_are_computed_only_while_they_are_drawn(show: Show) -> None:
    view = show()
    forces = next(a for a in view.layer_actions() if a.text() == "Forces")
    assert view.stages == ("linkage", "cam")
    view.session.edit("follower.rod_mm", 850.0, "a")
    assert evaluations["cam"]
    assert not evaluations["dynamics"]
    forces.trigger()
    settle()
    assert view.stages == ("linkage", "cam", "dynamics")
    assert evaluations["dynamics"] == 1
    assert any(key.startswith("forces.") for key in view.scene.parts)
    forces.trigger()
    settle()
    evaluations.clear()
    view.session.edit("follower.rod_mm", 860.0, "a")
    assert not evaluations["dynamics"]


def test_a_layer_switched_on_out_of_sight_waits(user: User) -> None:
    view = user.window.view("mechanism")
    assert isinstance(view, MechanismView)
    user.window.show_view("graph")
    settle()
    assert not view.on_screen()
    next(a for a in view.layer_actions() if a.text() == "Velocities").trigger()
    settle()
    assert not view.scene.layer_shown("velocities")
    user.window.show_view("mechanism")
    settle()
    assert view.scene.layer_shown("velocities")


# -- where there is no answer -----------------------------------------------------------------------------


def test_a_linkage_without_a_cam_is_drawn_and_says_why(show: Show) -> None:
    view = show(PUSHER)
    view.session.stages_on_screen = tuple
    assert view.session.edit("motion.start_mm", -1.1 * PUSHER.drive.cam.base_radius_mm, "a")
    settle()
    assert not view.in_trouble
    assert "roller covers the cam centre" in view.note.text()
    assert view.note.isVisible()
    view.session.stack.undo()
    assert not view.note.isVisible()


def test_without_a_linkage_the_view_says_why(show: Show) -> None:
    view = show()
    view.session.stages_on_screen = tuple
    assert view.session.put(with_follower(LIFT, rod_mm=400.0, guide_height_mm=600.0), "a")
    assert view.in_trouble
    view.session.stack.undo()
    assert not view.in_trouble


# -- keys and files ---------------------------------------------------------------------------------------


def test_the_player_obeys_keys_over_the_drawing(user: User) -> None:
    view = user.window.view("mechanism")
    assert view is not None
    QTest.mouseClick(view.canvas.viewport(), Qt.MouseButton.LeftButton, pos=QPoint(40, 40))  # type: ignore[attr-defined]
    player = user.window.player
    user.press(Qt.Key.Key_Right, Qt.Key.Key_Right)
    assert degrees(player.theta) == pytest.approx(2.0)
    user.press(Qt.Key.Key_Left, modifier=Qt.KeyboardModifier.ShiftModifier)
    assert degrees(player.theta) == pytest.approx(1.9)
    user.press(Qt.Key.Key_Right, modifier=Qt.KeyboardModifier.ControlModifier)
    assert degrees(player.theta) == pytest.approx(11.9)
    user.press(Qt.Key.Key_Space)
    assert player.playing
    user.press(Qt.Key.Key_Space)
    assert not player.playing


def test_the_picture_is_what_is_on_the_screen(show: Show) -> None:
    view = show()
    view.player.set_theta(radians(58.5))
    wheel(view, QPointF(300.0, 300.0), 2.0)
    view.settle()
    picture = Image.open(BytesIO(view.picture(".png"))).convert("RGB")
    viewport = view.canvas.viewport()
    assert picture.size == (2 * viewport.width(), 2 * viewport.height())
    small = np.asarray(picture.resize((viewport.width(), viewport.height()), Image.Resampling.BOX), dtype=int)
    grabbed = viewport.grab().toImage().convertToFormat(viewport.grab().toImage().Format.Format_RGB888)
    seen = np.frombuffer(grabbed.constBits(), np.uint8).reshape(grabbed.height(), grabbed.bytesPerLine())
    seen = seen[:, : 3 * grabbed.width()].reshape(grabbed.height(), grabbed.width(), 3).astype(int)
    assert np.mean(np.abs(small - seen).max(axis=2) > 90) < 0.02
    svg = view.picture(".svg")
    assert svg.startswith(b"<?xml")
    assert LIFT.name.encode() in svg


def test_a_window_obeys_the_players_keys_before_anything_is_clicked(open_user: Open) -> None:
    user = open_user(example("card_picker"))
    QTest.keyClick(user.window, Qt.Key.Key_Right)
    assert degrees(user.window.player.theta) == pytest.approx(1.0)
