"""File > Export > Profile: what the dialog shows is what the core computes, and what it writes are the core's bytes."""

from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QComboBox
from window_user import Open, User, answering, wait_for

from core.__main__ import main
from core.output.files.files import files
from core.output.files.profile_files import layers
from core.project import load, save
from kindyna_gui.cam_dialogs.profile_dialogs import ProfileDialog
from kindyna_gui.pictures.style import LIGHT
from kindyna_gui.places import example

WAY = ("File", "Export", "Profile...")


@pytest.fixture
def open_user(same_window: Open) -> Open:
    """One window for all tests of this file."""
    return same_window


def pick(box: QComboBox, text: str) -> None:
    """By the arrow keys."""
    box.setFocus()
    for _ in range(box.count()):
        QTest.keyClick(box, Qt.Key.Key_Up)
    while text not in box.currentText():
        before = box.currentIndex()
        QTest.keyClick(box, Qt.Key.Key_Down)
        assert box.currentIndex() > before, f"{text}: not offered"


def type_number(box: Any, text: str) -> None:
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, text)


def chosen(dialog: ProfileDialog) -> Any:
    """The box of the way in which points are chosen."""
    return dialog.form.boxes[dialog.form.chosen("Points")]


def computed(dialog: ProfileDialog) -> str:
    """What the dialog says once the preview is there."""
    wait_for(lambda: not dialog.result.text().startswith("Calculating"))
    return dialog.result.text()


def test_a_profile_goes_from_the_dialog_into_a_file(user: User, tmp_path: Path) -> None:
    def act(dialog: ProfileDialog) -> None:
        pick(dialog.form.boxes["fit"], "Tangent arcs")
        type_number(chosen(dialog), "0.02")
        assert not dialog.export.isEnabled(), "nothing can be written before it is computed"
        text = computed(dialog)
        assert "at most 0.02 mm" in text
        assert dialog.picture.shown.points.size == int(text.split()[0])
        QTest.mouseClick(dialog.export, Qt.MouseButton.LeftButton)

    suggested = user.picks("profile_to_save", tmp_path / "cam.dxf")
    with answering(ProfileDialog, act):
        user.choose(*WAY)
    assert suggested[0].suffix == ".dxf"
    assert user.window.status.currentMessage() == f"Wrote {tmp_path / 'cam.dxf'} and {tmp_path / 'cam.dxf.json'}"
    save(user.design, tmp_path / "design.toml")
    words = [
        "profile",
        tmp_path / "design.toml",
        "--out",
        tmp_path / "again.dxf",
        "--as",
        "arcs",
        "--tolerance",
        "0.02",
    ]
    assert main([str(word) for word in words]) == 0
    assert (tmp_path / "cam.dxf").read_bytes() == (tmp_path / "again.dxf").read_bytes()


def test_formats_points_and_cutters_are_chosen_and_refused(user: User, tmp_path: Path) -> None:
    user.session.edit("cam.cutter_radius_mm", 12.5, "Cutter")

    def act(dialog: ProfileDialog) -> None:
        assert dialog.form.boxes["cutter_mm"].number == 12.5, "the design's own"
        type_number(dialog.form.boxes["cutter_mm"], "0")
        pick(dialog.format, "CSV")
        assert [dialog.form.boxes["fit"].itemText(i) for i in range(dialog.form.boxes["fit"].count())] == [
            "Closed polyline"
        ]
        pick(dialog.form.boxes["Points"], "At equal cam angles")
        type_number(chosen(dialog), "90")
        assert computed(dialog).startswith("90 points on")
        pick(dialog.form.boxes["Points"], "At equal arc lengths")
        type_number(chosen(dialog), "20")
        pick(dialog.form.boxes["Points"], "At equal cam angles")
        assert chosen(dialog).number == 90, "each keeps its value"
        type_number(dialog.form.boxes["cutter_mm"], "2000")
        assert "cutter: a radius of 2000 mm does not reach all of the profile" in computed(dialog)
        assert LIGHT.limit.lower() in dialog.result.palette().windowText().color().name()
        assert not dialog.export.isEnabled()
        type_number(dialog.form.boxes["cutter_mm"], "30")
        assert computed(dialog).startswith("90 points on")
        assert len(dialog.picture.shown.profiles) == 1, "the profile beside the path"
        feed = dialog.form.boxes["feed_mm_min"]
        assert not feed.isVisible()
        pick(dialog.format, "G-code")
        pick(dialog.form.boxes["Points"], "The fewest that keep a tolerance")
        type_number(chosen(dialog), "0.01")
        type_number(feed, "450")
        assert "at most 0.01 mm from the exact curve" in computed(dialog)
        assert b"F450.\n" in files(dialog.computed.job, Path("cam.nc"))["cam.nc"]
        type_number(dialog.form.boxes["cutter_mm"], "0")
        assert "G-code needs the radius of a cutter" in computed(dialog)
        dialog.grab()
        QTest.keyClick(dialog, Qt.Key.Key_Escape)

    with answering(ProfileDialog, act):
        user.choose(*WAY)
    assert list(tmp_path.iterdir()) == []
    assert user.faults == []


@pytest.mark.stress
def test_a_program_of_arcs_is_that_of_the_command(user: User, tmp_path: Path) -> None:
    """And its facts stand beside it under its own name; nothing else in the folder is touched."""

    def act(dialog: ProfileDialog) -> None:
        pick(dialog.format, "G-code")
        pick(dialog.form.boxes["fit"], "Tangent arcs")
        type_number(dialog.form.boxes["cutter_mm"], "20")
        type_number(chosen(dialog), "0.01")
        dialog.form.boxes["conventional"].click()
        computed(dialog)
        QTest.mouseClick(dialog.export, Qt.MouseButton.LeftButton)

    (tmp_path / "summary.json").write_text("{}", "utf-8")
    user.picks("profile_to_save", tmp_path / "cam.nc")
    with answering(ProfileDialog, act):
        user.choose(*WAY)
    save(user.design, tmp_path / "design.toml")
    (tmp_path / "again").mkdir()
    words = [
        "profile",
        tmp_path / "design.toml",
        "--out",
        tmp_path / "again/cam.nc",
        "--as",
        "arcs",
        "--tolerance",
        "0.01",
    ]
    assert main([str(word) for word in (*words, "--cutter", "20", "--conventional")]) == 0
    assert b"\nG3 " in (tmp_path / "cam.nc").read_bytes()
    for name in ("cam.nc", "cam.nc.json"):
        assert (tmp_path / name).read_bytes() == (tmp_path / "again" / name).read_bytes()
    assert (tmp_path / "summary.json").read_text("utf-8") == "{}"
    assert user.faults == []


@pytest.mark.stress
def test_both_flanks_of_a_groove_are_shown_and_drawn(user: User, tmp_path: Path) -> None:
    user.session.start(load(example("groove")))

    def act(dialog: ProfileDialog) -> None:
        type_number(dialog.form.boxes["cutter_mm"], "0")
        pick(dialog.form.boxes["flank"], "Outer")
        computed(dialog)
        assert len(dialog.picture.shown.profiles) == 1
        assert {"PROFILE_INNER", "PROFILE_OUTER"} <= set(layers(dialog.computed.job))
        dialog.reject()

    with answering(ProfileDialog, act):
        user.choose(*WAY)


def test_a_design_without_a_cam_has_no_profile(user: User) -> None:
    user.session.start(load(example("four_bar")))
    action = user.action(*WAY)
    assert not action.isEnabled()
    assert action.statusTip() == "This design has no cam"
