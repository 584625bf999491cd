"""File > Export > Controller: what the dialog shows is what the core computes, and what it writes is the command's file."""

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from window_user import Open, answering, wait_for

from core.__main__ import main
from kindyna_gui.cam_dialogs.profile_dialogs import ControllerDialog
from kindyna_gui.places import example

WAY = ("File", "Export", "Controller...")


@pytest.fixture
def open_user(same_window: Open) -> Open:
    """One window for all tests of this file."""
    return same_window


def computed(dialog: ControllerDialog) -> str:
    """What the dialog says once the table is there."""
    wait_for(lambda: not dialog.result.text().startswith("Calculating"))
    return dialog.result.text()


def pick(dialog: ControllerDialog, slug: str) -> None:
    box = dialog.controller
    box.setFocus()
    QTest.keyClick(box, Qt.Key.Key_Home)
    while box.currentData() != slug:
        before = box.currentIndex()
        QTest.keyClick(box, Qt.Key.Key_Down)
        assert box.currentIndex() > before, f"{slug}: not offered"


@pytest.mark.stress
def test_the_card_picker_leaves_as_eleven_rows(open_user: Open, tmp_path: Path) -> None:
    user = open_user(example("card_picker"))

    def act(dialog: ControllerDialog) -> None:
        assert computed(dialog).startswith("11 rows for CODESYS")
        (line,) = [xy for xy in dialog.plots[0].lines if xy[0].size > 2]
        stated = dialog.computed.table.deviation.values[0]
        assert np.abs(line[1]).max() == pytest.approx(1e3 * stated, rel=0.02)
        assert dialog.plots[0].dots[0].x.size == 11
        QTest.mouseClick(dialog.export, Qt.MouseButton.LeftButton)

    suggested = user.picks("controller_table_to_save", tmp_path / "cam.st")
    with answering(ControllerDialog, act):
        user.choose(*WAY)
    assert suggested[0].name == "card_picker.st"
    assert user.window.status.currentMessage() == f"Wrote {tmp_path / 'cam.st'}"
    words = ["ecam", str(example("card_picker")), "--out", str(tmp_path / "again.st"), "--controller", "codesys-xyva"]
    assert main(words) == 0
    assert (tmp_path / "cam.st").read_bytes() == (tmp_path / "again.st").read_bytes()


@pytest.mark.stress
def test_the_error_over_the_number_of_rows_is_read_off_and_a_click_takes_one(open_user: Open) -> None:
    user = open_user(example("transfer_lift"))

    def act(dialog: ControllerDialog) -> None:
        computed(dialog)
        x, y = dialog.curve.lines[0]
        assert 10.0 ** x[-1] == pytest.approx(5000.0)
        assert y[0] > 3.0 > -3.0 > y[-1]  # more than 1 mm with a row at each join, less than 0.001 µm with many
        viewport = dialog.curve.viewport()
        place = QPoint(viewport.width() // 2, viewport.height() // 2)
        wanted = round(10.0 ** dialog.curve.across_at(place))
        QTest.mouseClick(viewport, Qt.MouseButton.LeftButton, pos=place)
        assert computed(dialog).startswith(f"{wanted} rows")
        assert dialog.form.boxes["points"].number == wanted
        pick(dialog, "kollmorgen-csv")
        assert "not certified: how this controller interpolates is not published" in computed(dialog)
        assert dialog.curve.message.startswith("not certified")
        pick(dialog, "sew-tab")
        assert "open: units, line end" in computed(dialog)
        QTest.keyClick(dialog, Qt.Key.Key_Escape)

    with answering(ControllerDialog, act):
        user.choose(*WAY)
