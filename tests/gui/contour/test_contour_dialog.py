"""kindyna_gui.contour: a drawn cam becomes the motion the way a user does it."""

from collections.abc import Callable
from pathlib import Path

import pytest
from drawn_cams import NosedCam, drawn
from mechanisms import PUSHER, with_cam, with_follower
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from window_user import User, settle, wait_for

from core.contour import read_contour, trace
from core.project import save
from kindyna_gui import dialogs
from kindyna_gui.contour import CurveDialog

UP = with_cam(with_follower(PUSHER, offset_mm=5.0, direction_deg=90.0), roller_radius_mm=12.0)
CAM = drawn(*NosedCam().shapes, unit=0)


def click(widget: QWidget) -> None:
    assert widget.isEnabled()
    QTest.mouseClick(widget, Qt.MouseButton.LeftButton)
    settle()


def enter(user: User, box: QWidget, text: str) -> None:
    box.setFocus()
    QTest.keyClick(box, Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
    user.type(text)
    user.press(Qt.Key.Key_Return)


Opens = Callable[[bytes], tuple[User, CurveDialog]]


@pytest.fixture
def opened(open_user: Callable[..., User], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Opens:
    """A window, and the dialog of a drawing."""

    def opened(drawing: bytes) -> tuple[User, CurveDialog]:
        save(UP, tmp_path / "up.toml")
        (tmp_path / "tangent.dxf").write_bytes(drawing)
        monkeypatch.setattr(dialogs, "file_to_open", lambda *_: tmp_path / "tangent.dxf")
        user = open_user(tmp_path / "up.toml")
        user.choose("Make", "Motion from a DXF curve...")
        dialog = user.window.findChild(CurveDialog)
        assert isinstance(dialog, CurveDialog)
        wait_for(dialog.isVisible)
        return user, dialog

    return opened


def test_a_gap_is_joined_over_what_is_typed(opened: Opens) -> None:
    line, *others = NosedCam().shapes
    torn = drawn(("line", *((x + 0.005, y) for x, y in line[1:])), *others)
    user, dialog = opened(torn)
    before = user.design
    assert dialog.gap.text() == "0.002"
    assert "more than 0.002 mm" in dialog.message.text()
    enter(user, dialog.gap, "5")
    assert dialog.message.text().endswith("outside its range; allowed: 0 ... 1 mm, not 5 mm")
    assert (dialog.gap.text(), dialog.gap.is_refused) == ("5", True)
    assert list(dialog.message.buttons) == ["Use 1 mm", "Back to 0.002 mm"]
    assert not dialog.put_button.isEnabled()
    click(dialog.message.buttons["Back to 0.002 mm"])
    assert (dialog.gap.text(), dialog.gap.is_refused) == ("0.002", False)
    assert "more than 0.002 mm" in dialog.message.text()
    enter(user, dialog.gap, "0.01")
    click(dialog.put_button)
    assert user.design == trace(before, read_contour(torn, "tangent.dxf", gap_mm=0.01)).design


def test_a_drawn_cam_becomes_motion_and_base_radius_in_one_step(opened: Opens) -> None:
    user, dialog = opened(CAM)
    before = user.design
    assert dialog.message.text() == "Its header states no unit; state the unit: mm | cm | in"
    assert not dialog.put_button.isEnabled()

    dialog.unit.setFocus()
    QTest.keyClick(dialog.unit, Qt.Key.Key_Down)
    settle()
    assert dialog.unit.currentText() == "mm"
    wanted = trace(before, read_contour(CAM, "tangent.dxf", "mm"))
    assert [row.cells[0] for row in dialog.jumps.rows.rows] == [f"{jump.angle:.3f}" for jump in wanted.jumps]
    assert dialog.jumps.rows.rows[0].cells[1::3] == ("Acceleration", "mm/°²")
    plain = dialog.picture.grab().toImage()
    QTest.mouseClick(
        dialog.jumps.viewport(),
        Qt.MouseButton.LeftButton,
        pos=dialog.jumps.visualRect(dialog.jumps.rows.index(1, 0)).center(),
    )
    settle()
    assert dialog.plot.cursor_at == pytest.approx(wanted.jumps[1].angle)
    assert dialog.picture.grab().toImage() != plain, "the roller where the acceleration jumps"

    enter(user, dialog.centre[0], "100")
    assert "lies outside the curve" in dialog.message.text()
    assert dialog.isVisible(), "Enter confirms the number, not the dialog"
    enter(user, dialog.centre[0], "0")
    assert user.design == before, "nothing happens before it is put"
    click(dialog.put_button)
    assert user.design == wanted.design
    assert user.steps == ["Motion from tangent.dxf"]
    user.choose("Edit", "Undo Motion from tangent.dxf")
    assert user.design == before
