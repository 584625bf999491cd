"""Graph > Path in space: the part that the drives of the transfer unit carry together, turned by the mouse."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from window_user import Open, settle

from core.study import Study
from kindyna_gui.drives import ON_SHAFT, SIDE_BY_SIDE
from kindyna_gui.places import example
from kindyna_gui.space_view import NO_PART


@pytest.fixture
def open_user(same_window: Open) -> Open:
    return same_window


def test_the_path_of_the_part_is_drawn_to_scale_and_turns_by_the_mouse(open_user: Open) -> None:
    user = open_user(example("transfer_unit"))
    user.choose("Graph", "Path in space")
    view = user.see("space")
    canvas = view.canvas
    wanted = Study(user.session.full_design, 3600).camshaft.transfer_path * 1e3
    assert np.ptp(canvas.path, axis=0) == pytest.approx(np.ptp(wanted, axis=0), abs=1e-6)
    user.window.player.set_machine(np.deg2rad(90.0))
    settle()
    assert canvas.part == pytest.approx(wanted[900], abs=1e-6)
    ends = canvas.path.min(axis=0) + 100.0 * np.vstack((np.zeros(3), np.eye(3)))
    start, *tips = canvas.pixels(ends)
    assert np.abs(np.array(tips) - start) == pytest.approx(np.full(3, abs(tips[0] - start)))  # isometric
    assert (tips[2] - start).real == pytest.approx(0.0, abs=1e-9)
    assert (tips[2] - start).imag < 0.0  # z is upwards
    QTest.mousePress(canvas, Qt.MouseButton.LeftButton, pos=QPoint(200, 200))
    QTest.mouseMove(canvas, QPoint(290, 129))
    QTest.mouseRelease(canvas, Qt.MouseButton.LeftButton, pos=QPoint(290, 129))
    assert canvas.turn == pytest.approx(0.0, abs=1e-9)  # 90 pixels are 45 degrees
    assert abs(canvas.tilt) < 0.3
    start, *tips = canvas.pixels(ends)
    assert abs((tips[1] - start) / (tips[0] - start)) < 0.01  # seen along y, from the side
    QTest.mouseDClick(canvas, Qt.MouseButton.LeftButton)
    assert canvas.turn == 45.0
    assert view.picture(".png")[:4] == b"\x89PNG"


def test_a_machine_that_carries_nothing_says_how_it_could(open_user: Open) -> None:
    user = open_user()
    user.choose("Graph", "Path in space")
    view = user.window.view("space")
    assert view.in_trouble
    assert view.no_picture == NO_PART


def test_the_path_stands_beside_the_cams_and_the_part_runs_on_it(open_user: Open) -> None:
    """Under the isometric view x goes right and down, y right and up, z up, all axes as long: √(2/3) of their length."""
    user = open_user(example("transfer_unit"))
    view = user.drawing()
    QTest.mouseClick(
        view.strip.arrangement_bar.widgetForAction(view.strip.arrangements[SIDE_BY_SIDE]), Qt.MouseButton.LeftButton
    )
    settle()
    scene, path = view.assembly, Study(user.session.full_design, 360).camshaft.transfer_path * 1e3
    axes = np.array([[0.5**0.5, 0.5**0.5, 0.0], [-(6.0**-0.5), 6.0**-0.5, (2.0 / 3.0) ** 0.5]])
    places = []
    for degree in (0, 130):
        user.window.player.set_machine(np.deg2rad(degree))
        settle()
        at = scene.transfer.part.scenePos()
        places.append(np.array([at.x(), at.y()]))
    assert places[1] - places[0] == pytest.approx(axes @ (path[130] - path[0]), abs=1e-6)
    assert np.abs(places[1] - places[0]).max() > 10.0
    own = scene.transfer.rect.translated(scene.transfer.corner.real, scene.transfer.corner.imag)
    others = [f.rect.translated(f.corner.real, f.corner.imag) for f in scene.figures.values()]
    assert not any(own.intersects(other) for other in others)
    assert scene.fit_rect().contains(own)
    QTest.mouseClick(
        view.strip.arrangement_bar.widgetForAction(view.strip.arrangements[ON_SHAFT]), Qt.MouseButton.LeftButton
    )
    settle()
    assert scene.transfer is None
