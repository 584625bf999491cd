"""A cam in space in the window: new by type, edited in its form, drawn, turned with the mouse."""

from __future__ import annotations

from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPointF, Qt
from PySide6.QtGui import QColor, QMouseEvent
from window_user import Open, User, settle, wait_for

from core.spatial import SpatialShape
from core.study import Study, findings_of
from kindyna_gui.__main__ import main
from kindyna_gui.places import example
from kindyna_gui.spatial import view as view_module
from kindyna_gui.spatial.view import SpatialView

BUTTON = Qt.MouseButton.LeftButton
NO_KEYS = Qt.KeyboardModifier.NoModifier


def view_of(user: User) -> SpatialView:
    view = user.window.show_view("surface")
    assert isinstance(view, SpatialView)
    settle()
    view.pull()
    return view


def image_of(widget) -> np.ndarray:
    image = widget.grab().toImage().convertToFormat(widget.grab().toImage().Format.Format_RGB32)
    return np.frombuffer(image.constBits(), dtype=np.uint32).reshape(image.height(), -1).copy()


def drag(canvas, start: QPointF, end: QPointF) -> None:
    steps = ((QEvent.Type.MouseButtonPress, start), (QEvent.Type.MouseMove, end), (QEvent.Type.MouseButtonRelease, end))
    for kind, at in steps:
        event = QMouseEvent(kind, at, canvas.mapToGlobal(at), BUTTON, BUTTON, NO_KEYS)
        {QEvent.Type.MouseButtonPress: canvas.mousePressEvent, QEvent.Type.MouseMove: canvas.mouseMoveEvent,
         QEvent.Type.MouseButtonRelease: canvas.mouseReleaseEvent}[kind](event)  # fmt: skip


@pytest.mark.parametrize(("entry", "kind"), [("Barrel cam", "barrel"), ("Globoidal cam", "globoidal")])
def test_a_new_cam_in_space_is_complete_and_has_no_finding(user: User, entry: str, kind: str) -> None:
    user.choose("File", "New by type", entry)
    assert user.design.drive.kind == kind
    assert findings_of(Study(user.design)) == ()
    view = view_of(user)
    assert not view.is_unavailable
    assert view.solid.cam is not None
    assert len(view.solid.cam.corners) + len(view.solid.rollers.corners) <= 5000


def test_a_drag_turns_the_shaded_picture_and_a_double_click_turns_it_back(open_user: Open) -> None:
    view = view_of(open_user(example("barrel_feeder")))
    (turn_before, tilt_before), before = (view.solid.turn, view.solid.tilt), image_of(view.solid)
    drag(view.solid, QPointF(100.0, 100.0), QPointF(160.0, 130.0))
    turn, tilt = view.solid.turn, view.solid.tilt
    assert (turn_before - turn) % 360.0 == pytest.approx(30.0)
    assert tilt - tilt_before == pytest.approx(15.0)
    assert (image_of(view.solid) != before).mean() > 0.02
    view.solid.mouseDoubleClickEvent(None)
    assert np.array_equal(image_of(view.solid), before)


def test_the_map_reads_the_pressure_angle_of_the_table(open_user: Open) -> None:
    user = open_user(example("barrel_feeder"))
    view = view_of(user)
    view.tabs.setCurrentWidget(view.unrolled)
    settle()
    # cycloidal rise of 40 mm over 120°, at its middle: tan ψ = 2 h/(β u)
    for part, u in ((0.0, 70.0), (1.0, 84.0)):
        expected = np.rad2deg(np.arctan(2.0 * 40.0 / np.deg2rad(120.0) / u))
        assert view.unrolled.value_at(0, 60.0, part) == pytest.approx(expected, abs=1e-6)
    room = view.unrolled.room_of(1)
    at = QPointF(room.left() + room.width() / 6.0, room.bottom() - 1.0)
    view.unrolled.mouseMoveEvent(QMouseEvent(QEvent.Type.MouseMove, at, at, BUTTON, BUTTON, NO_KEYS))
    assert view.unrolled.under_mouse is not None
    assert view.unrolled.under_mouse[0] == 1
    assert view.unrolled.under_mouse[1] == pytest.approx(60.0)


def test_the_cam_turns_with_the_player_and_the_roller_moves(open_user: Open) -> None:
    user = open_user(example("barrel_feeder"))
    view = view_of(user)
    heights = []
    for degrees in (0.0, 150.0):
        user.window.player.set_theta(np.deg2rad(degrees))
        settle()
        view.follow(np.deg2rad(degrees))
        heights.append(view.solid.rollers.corners[..., 2].mean())
        assert view.solid.angle == pytest.approx(np.deg2rad(degrees))
    assert heights[1] - heights[0] == pytest.approx(0.04, abs=1e-9)


def test_a_pressure_angle_beyond_the_limit_is_red_in_the_map(open_user: Open, tmp_path: Path) -> None:
    path = tmp_path / "steep.toml"
    text = example("barrel_feeder").read_text("utf-8").replace("roller_inner_mm = 70.0", "roller_inner_mm = 50.0")
    path.write_text(text.replace("bore_mm = 35.0", "bore_mm = 20.0"), "utf-8")
    view = view_of(open_user(path))
    view.tabs.setCurrentWidget(view.unrolled)
    settle()
    room, shown = view.unrolled.room_of(0), view.unrolled.grab().toImage()
    steep, flat = (
        QColor(shown.pixel(int(room.left() + room.width() * degrees / 360.0), int(room.bottom()) - 3))
        for degrees in (60.0, 150.0)
    )
    assert steep.red() > steep.green() + 80
    assert steep.red() > steep.blue() + 80
    assert abs(flat.red() - flat.blue()) < 40


def test_a_disk_cam_has_a_sentence_in_place_of_the_picture(user: User) -> None:
    view = view_of(user)
    assert view.is_unavailable


def test_a_drive_with_a_cam_in_space_is_added_to_a_shaft(open_user: Open) -> None:
    user = open_user(example("transfer_unit"))
    count = len(user.session.full_design.drives)
    drives = user.window.show_view("drives")
    settle()
    menu = drives.buttons["add"].menu()
    menu.aboutToShow.emit()
    next(entry for entry in menu.actions() if entry.text() == "Globoidal cam").trigger()
    settle()
    assert len(user.session.full_design.drives) == count + 1
    assert user.session.full_design.drives[-1].kind == "globoidal"


def test_the_page_opens_with_a_cam_in_space_and_closes_with_it(user: User) -> None:
    window = user.window
    window.show_task("kine")
    user.choose("File", "New by type", "Barrel cam")
    assert window.centre.open_pages == (("mechanism", "surface"), "mechanism")
    window.show_task("compo")
    assert window.centre.open_pages[0] == ("mechanism", "surface")
    user.choose("File", "New by type", "Translating follower")
    assert window.centre.open_pages == (("mechanism",), "mechanism")


def test_an_edit_of_the_roller_is_one_step_that_undo_takes_back(open_user: Open) -> None:
    user = open_user(example("barrel_feeder"))
    view, before = view_of(user), user.design
    first = view.solid.rollers.corners
    user.enter("cam.roller_radius_mm", "6")
    assert user.design.drive.cam.roller_radius_mm == 6.0
    view.pull()
    view.follow(0.0)
    assert np.ptp(view.solid.rollers.corners[..., 2]) == pytest.approx(0.012)
    user.choose("Edit", f"Undo {user.steps[-1]}")
    assert user.design == before
    view.pull()
    view.follow(0.0)
    assert np.ptp(view.solid.rollers.corners[..., 2]) == pytest.approx(np.ptp(first[..., 2]))


def test_the_report_has_the_curves_of_the_cam(tmp_path: Path) -> None:
    out = tmp_path / "report.html"
    assert main(["--headless", "report", str(example("barrel_feeder")), "--out", str(out)]) == 0
    text = out.read_text("utf-8")
    assert "Pressure angle, curvature and sliding over one turn" in text
    assert "Sliding of the roller" in text
    assert "in side view and end view" in text
    assert text.count("<svg") == 5, "the machine, motion, views, curves of the cam, forces"
    assert "End view" in text


def test_only_the_page_that_is_seen_is_computed(open_user: Open, monkeypatch: pytest.MonkeyPatch) -> None:
    """Facets of the cam once a design, and of its rollers while their page is in front; nothing behind the mechanism."""
    counts = {"cam_facets": 0, "roller_facets": 0, "along_length": 0}

    def counted(owner: Any, name: str) -> None:
        compute = getattr(owner, name)

        def call(*arguments: Any) -> Any:
            counts[name] += 1
            return compute(*arguments)

        monkeypatch.setattr(owner, name, call)

    counted(view_module, "cam_facets")
    counted(view_module, "roller_facets")
    counted(SpatialShape, "along_length")
    user = open_user(example("globoidal_indexer"))
    window = user.window

    def play() -> None:
        for degrees in (250.0, 280.0, 310.0):
            user.turn(degrees)

    window.show_view("mechanism")
    play()
    assert counts == {"cam_facets": 0, "roller_facets": 0, "along_length": 0}
    view = view_of(user)
    play()
    assert counts["cam_facets"] == 1
    assert counts["along_length"] == 0
    before = dict(counts)
    view.solid.look(10.0, 20.0)
    settle()
    assert counts == before, "a turn of the picture computes nothing"
    view.tabs.setCurrentWidget(view.unrolled)
    wait_for(lambda: counts["along_length"] == 1)
    play()
    view.tabs.setCurrentWidget(view.solid)
    settle()
    assert counts["cam_facets"] == 1
    assert counts["along_length"] == 1


def test_a_picture_has_as_many_brushes_as_colours_and_no_seams(open_user: Open) -> None:
    """The disc of a turret is one plane: one colour in the picture."""
    user = open_user(example("globoidal_indexer"))
    view = view_of(user)
    view.solid.look(0.0, 0.0)
    shown = view.solid.grab().toImage()
    disc = view.solid.rollers.corners.reshape(-1, 3).mean(axis=0)
    assert disc[0] == pytest.approx(0.12, abs=2e-3)
    colours = [shown.pixelColor(x, shown.height() // 2).name() for x in range(shown.width())]
    longest = max(len(list(run)) for _, run in groupby(colour for colour in colours if colour != colours[0]))
    assert longest > 60
