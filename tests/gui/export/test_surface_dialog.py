"""File > Export > Solid and surfaces: what the dialog writes are the command's bytes, and the drawing is turned by the mouse."""

import re
from pathlib import Path

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QComboBox
from step_reader import StepFile, check_topology
from window_user import Open, User, answering, wait_for

from core.__main__ import main
from core.project import load, save
from kindyna_gui.cam_dialogs.surface_dialog import SurfaceDialog
from kindyna_gui.places import example
from kindyna_gui.settings import choose

PATH = ("File", "Export", "Solid and surfaces...")
FIELDS = {
    "cam.thickness_mm": "70", "cam.bore_mm": "120", "cam.keyway_width_mm": "32", "cam.keyway_depth_mm": "7.4",
    "cam.keyway_angle_deg": "90", "cam.hub_mm": "200", "cam.hub_length_mm": "110",
}  # fmt: skip


@pytest.fixture
def open_user(same_window: Open) -> Open:
    """One window for all tests of this file."""
    return same_window


def computed(dialog: SurfaceDialog) -> str:
    """What the dialog says once the file is calculated."""
    wait_for(lambda: not dialog.result.text().startswith("Calculating"))
    return dialog.result.text()


def pick(box: QComboBox, text: str) -> None:
    """By the arrow keys."""
    box.setFocus()
    for _ in range(box.count()):
        QTest.keyClick(box, Qt.Key.Key_Up)
    while text not in box.currentText():
        before = box.currentIndex()
        QTest.keyClick(box, Qt.Key.Key_Down)
        assert box.currentIndex() > before, f"{text}: not offered"


def test_the_lifts_cam_goes_from_typed_dimensions_into_a_solid(user: User, tmp_path: Path) -> None:
    """Thickness, bore, keyway and hub are typed under Parameters; the file has the body of the command, closed."""
    for path, value in FIELDS.items():
        user.enter(path, value)
    assert not user.faults

    def act(dialog: SurfaceDialog) -> None:
        text = computed(dialog)
        assert text.startswith("15 faces, ")
        assert dialog.format.currentData() == ".step"
        assert dialog.form.boxes["solid"].isChecked()
        picture = dialog.picture
        seen = picture.grab().toImage()
        colours = {seen.pixelColor(x, y).name() for x in range(0, seen.width(), 4) for y in range(0, seen.height(), 4)}
        assert len(colours) > 10, "shaded"
        turn = picture.turn
        middle = picture.rect().center()
        QTest.mousePress(picture, Qt.MouseButton.LeftButton, pos=middle)
        QTest.mouseMove(picture, middle + QPoint(40, 10))
        QTest.mouseRelease(picture, Qt.MouseButton.LeftButton, pos=middle + QPoint(40, 10))
        assert picture.turn == pytest.approx((turn - 20.0) % 360.0)
        assert picture.grab().toImage() != seen
        QTest.mouseDClick(picture, Qt.MouseButton.LeftButton)
        assert picture.grab().toImage() == seen
        QTest.mouseClick(dialog.export, Qt.MouseButton.LeftButton)

    suggested = user.picks("surfaces_to_save", tmp_path / "cam.step")
    with answering(SurfaceDialog, act):
        user.choose(*PATH)
    assert suggested[0].suffix == ".step"
    assert user.window.status.currentMessage() == f"Wrote {tmp_path / 'cam.step'}"
    save(user.design, tmp_path / "design.toml")
    words = ["surface", tmp_path / "design.toml", "--out", tmp_path / "again.step", "--solid"]
    assert main([str(word) for word in words]) == 0
    assert (tmp_path / "cam.step").read_bytes() == (tmp_path / "again.step").read_bytes()
    (faces,) = StepFile((tmp_path / "cam.step").read_bytes()).shells.values()
    check_topology(faces, is_closed=True)


def test_what_a_solid_lacks_is_named_and_formats_show_their_fields(user: User) -> None:
    def act(dialog: SurfaceDialog) -> None:
        assert computed(dialog).startswith("cam.thickness_mm: missing")
        assert not dialog.export.isEnabled()
        boxes = dialog.form.boxes
        assert boxes["tolerance_mm"].isVisible()
        assert not boxes["samples"].isVisible()
        pick(dialog.format, "CSV")
        assert boxes["samples"].isVisible()
        assert not boxes["tolerance_mm"].isVisible()
        assert not boxes["solid"].isEnabled()
        pick(dialog.format, "STL")
        assert boxes["solid"].isChecked(), "a table has no solid, and leaves the choice as it was"
        dialog.reject()

    with answering(SurfaceDialog, act):
        user.choose(*PATH)


def test_a_table_and_one_flank_of_a_groove(user: User, tmp_path: Path) -> None:
    user.session.start(load(example("groove")))

    def act(dialog: SurfaceDialog) -> None:
        pick(dialog.format, "CSV")
        pick(dialog.form.boxes["flank"], "Outer")
        dialog.form.show_value("samples", 36)
        assert computed(dialog) == "756 points with their normals, on the exact surface."
        QTest.mouseClick(dialog.export, Qt.MouseButton.LeftButton)

    user.picks("surfaces_to_save", tmp_path / "flank.csv")
    with answering(SurfaceDialog, act):
        user.choose(*PATH)
    assert len((tmp_path / "flank.csv").read_text("utf-8").splitlines()) == 1 + 36 * 21


def test_tolerance_and_deviation_have_one_unit(user: User) -> None:
    user.session.start(load(example("conjugate")))
    said = []

    def act(dialog: SurfaceDialog) -> None:
        if dialog.form.boxes["solid"].isChecked():
            dialog.form.boxes["solid"].click()
        found = re.search(r"at most ([\d.e-]+) (\w+) from the exact surface", computed(dialog).replace("−", "-"))
        assert found is not None, dialog.result.text()
        said.append((float(found[1]), found[2]))
        dialog.reject()

    for units in ({}, {"length": "in"}):
        choose(units, comma=False)
        try:
            with answering(SurfaceDialog, act):
                user.choose(*PATH)
        finally:
            choose({}, comma=False)
    (millimetres, _), (inches, unit) = said
    assert unit == "in"
    assert inches == pytest.approx(millimetres / 25.4, rel=1e-3)


@pytest.mark.stress
def test_flanks_of_a_cam_in_space(user: User, tmp_path: Path) -> None:
    user.session.start(load(example("barrel_feeder")))

    def act(dialog: SurfaceDialog) -> None:
        assert computed(dialog).startswith("21 faces, "), "the solid of a slide's groove"
        assert dialog.picture.shown.is_closed, "what is written is drawn"
        dialog.form.boxes["solid"].click()
        assert computed(dialog).startswith("8 faces, at most ")
        pick(dialog.form.boxes["flank"], "Ahead")
        assert computed(dialog).startswith("4 faces, at most ")
        seen = dialog.picture.grab().toImage()
        colours = {seen.pixelColor(x, y).name() for x in range(0, seen.width(), 4) for y in range(0, seen.height(), 4)}
        assert len(colours) > 10, "shaded"
        QTest.mouseClick(dialog.export, Qt.MouseButton.LeftButton)

    user.picks("surfaces_to_save", tmp_path / "barrel.step")
    with answering(SurfaceDialog, act):
        user.choose(*PATH)
    assert (tmp_path / "barrel.step").read_bytes().startswith(b"ISO-10303-21;")


@pytest.mark.stress
def test_a_globoid_is_drawn_next_to_the_rims_of_its_blank(user: User, tmp_path: Path) -> None:
    user.session.start(load(example("globoidal_indexer")))

    def act(dialog: SurfaceDialog) -> None:
        assert "the blank is not cut" not in computed(dialog)
        flanks = dialog.picture.grab().toImage()
        dialog.form.boxes["solid"].click()
        assert computed(dialog).endswith("flanks and blank are side by side: the blank is not cut.")
        assert dialog.picture.grab().toImage() != flanks
        QTest.mouseClick(dialog.export, Qt.MouseButton.LeftButton)

    user.picks("surfaces_to_save", tmp_path / "cam.step")
    with answering(SurfaceDialog, act):
        user.choose(*PATH)
    words = ["surface", example("globoidal_indexer"), "--out", tmp_path / "again.step", "--solid"]
    assert main([str(word) for word in words]) == 0
    assert (tmp_path / "cam.step").read_bytes() == (tmp_path / "again.step").read_bytes()


def test_the_path_of_a_cutter_for_a_barrel(user: User, tmp_path: Path) -> None:
    user.session.start(load(example("barrel_feeder")))

    def act(dialog: SurfaceDialog) -> None:
        boxes = dialog.form.boxes
        assert not boxes["feed_mm_min"].isVisible()
        pick(dialog.format, "G-code")
        assert boxes["feed_mm_min"].isVisible()
        assert not boxes["flank"].isEnabled(), "it cuts both"
        dialog.form.show_value("feed_mm_min", 300.0)
        assert "points of the cutter's path" in computed(dialog)
        QTest.mouseClick(dialog.export, Qt.MouseButton.LeftButton)

    user.picks("surfaces_to_save", tmp_path / "cam.nc")
    with answering(SurfaceDialog, act):
        user.choose(*PATH)
    words = ["surface", example("barrel_feeder"), "--out", tmp_path / "again.nc", "--feed", "300"]
    assert main([str(word) for word in words]) == 0
    assert (tmp_path / "cam.nc").read_bytes() == (tmp_path / "again.nc").read_bytes()
