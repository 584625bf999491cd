"""From File > New to the files of a cam in space: a barrel cam as solid and G-code, an indexer as flanks, its torque on a shaft."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QListWidget
from window_user import Open, User, answering, settle, wait_for

from core.design import only
from core.study import Study
from kindyna_gui.cam_dialogs.surface_dialog import SurfaceDialog
from kindyna_gui.drives_view import DrivesView
from kindyna_gui.shaft import ShaftTorqueView
from kindyna_gui.window.gallery import Gallery

LEFT = Qt.MouseButton.LeftButton
SURFACES = ("File", "Export", "Solid and surfaces...")


def click_item(rows: QListWidget, text: str) -> None:
    (item,) = rows.findItems(text, Qt.MatchFlag.MatchExactly)
    rows.scrollToItem(item)
    QTest.mouseClick(rows.viewport(), LEFT, pos=rows.visualItemRect(item).topLeft() + QPoint(40, 12))
    settle()


def begin(group: str, picture: str) -> Callable[[Gallery], None]:
    """Click a kind of cam, a picture and Begin."""

    def act(dialog: Gallery) -> None:
        click_item(dialog.names, group)
        click_item(dialog.shown, picture)
        QTest.mouseClick(dialog.ok, LEFT)

    return act


def write(user: User, path: Path, text: str, format: str = "STEP") -> None:
    """Choose a format in the dialog of surfaces, wait for its result in words, and write the file."""

    def act(dialog: SurfaceDialog) -> None:
        dialog.format.setFocus()
        while format not in dialog.format.currentText():
            QTest.keyClick(dialog.format, Qt.Key.Key_Down)
        wait_for(dialog.export.isEnabled)
        assert re.match(text, dialog.result.text()), dialog.result.text()
        QTest.mouseClick(dialog.export, LEFT)

    user.picks("surfaces_to_save", path)
    with answering(SurfaceDialog, act):
        user.choose(*SURFACES)
    wait_for(path.exists)


def test_a_new_barrel_cam_leaves_as_solid_and_as_g_code(same_window: Open, tmp_path: Path) -> None:
    """Six choices: New, kind, picture, Begin; Export and Save for each file."""
    user = same_window()
    with answering(Gallery, begin("Barrel cam", "Slide in a groove")):
        user.choose("File", "New...")
    assert user.design.drive.kind == "barrel"
    assert {"cam", "cam.end", "roller1"} <= user.drawing().scene.parts.keys()
    write(user, tmp_path / "cam.step", r"\d+ faces, [\d\u202f]+ mm³, at most [\d.e-]+ mm")
    step = (tmp_path / "cam.step").read_text("ascii")
    assert "AUTOMOTIVE_DESIGN" in step
    assert "CLOSED_SHELL" in step
    write(user, tmp_path / "cam.nc", r"\d+ points of the cutter's path, flanks at most 0\.00[01]\d* mm", "G-code")
    assert "G93" in (tmp_path / "cam.nc").read_text("ascii")


def test_a_six_stop_indexer_leaves_two_micrometres_true_and_its_torque_is_in_the_sum(
    same_window: Open, tmp_path: Path
) -> None:
    user = same_window()
    with answering(Gallery, begin("Globoidal cam", "Indexing turret")):
        user.choose("File", "New...")
    assert user.design.drive.cam.rollers == 6

    def act(dialog: SurfaceDialog) -> None:
        assert not any("G-code" in dialog.format.itemText(k) for k in range(dialog.format.count()))
        wait_for(dialog.export.isEnabled)
        deviation = re.search(r"at most ([\d.e-]+) mm", dialog.result.text())
        assert deviation is not None
        assert float(deviation[1]) <= 0.002
        QTest.mouseClick(dialog.export, LEFT)

    user.picks("surfaces_to_save", tmp_path / "indexer.step")
    with answering(SurfaceDialog, act):
        user.choose(*SURFACES)
    assert "B_SPLINE_SURFACE" in (tmp_path / "indexer.step").read_text("ascii")

    user.clicks("New shaft")
    user.choose("File", "Add this design to a shaft...")
    drives = user.see("drives")
    assert isinstance(drives, DrivesView)
    menu = drives.buttons["add"].menu()
    menu.aboutToShow.emit()
    next(entry for entry in menu.actions() if entry.text() == "Translating follower").trigger()
    settle()
    view = user.see("shaft_torque")
    assert isinstance(view, ShaftTorqueView)
    design = user.session.full_design
    assert [drive.kind for drive in design.drives] == ["globoidal", "translating"]
    degrees, total = view.sums.lines[0]
    disk = Study(only(design, 1), total.size - 1).dynamics.torque
    assert total[:-1] - disk == pytest.approx(indexer_torque(degrees[:-1]), abs=1e-6)


def indexer_torque(degrees: np.ndarray) -> np.ndarray:
    """Torque y' (J ω² y'' + M) of the new indexer [N·m]: 60° by the modified sine from 240°, 100 rpm, 0.05 kg m², friction 2 N·m."""
    u, scale = np.clip((degrees - 240.0) / 120.0, 0.0, 1.0), 1.0 / (4.0 + np.pi)
    is_end = (u < 0.125) | (u > 0.875)
    slow, fast = (4.0 * np.pi * u + np.pi) / 3.0, 4.0 * np.pi * u
    v = scale * np.pi * np.where(is_end, 1.0 - np.cos(fast), 1.0 - 3.0 * np.cos(slow))
    a = scale * 4.0 * np.pi**2 * np.where(is_end, np.sin(fast), np.sin(slow))
    span, rise, omega = np.deg2rad(120.0), np.deg2rad(60.0), 100.0 * np.pi / 30.0
    v, a = rise / span * v, rise / span**2 * a
    return v * (0.05 * omega**2 * a + 2.0)
