"""File > Import controller table: the window makes of a file what the command ``measured --controller`` makes of it."""

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from sampled import spread
from window_user import Open, User, wait_for

from core.__main__ import main
from core.project import load
from kindyna_gui import dialogs
from kindyna_gui.measured.sheet import ControllerTableDialog
from kindyna_gui.places import example


def opened(user: User, path: Path, monkeypatch: pytest.MonkeyPatch) -> ControllerTableDialog:
    monkeypatch.setattr(dialogs, "file_to_open", lambda *_: path)
    user.choose("File", "Import controller table...")
    dialog = user.window.findChild(ControllerTableDialog)
    assert isinstance(dialog, ControllerTableDialog)
    wait_for(dialog.isVisible)
    return dialog


@pytest.mark.parametrize(
    ("slug", "options", "segments"),
    spread(
        [
            ("codesys-xyva", (), 10),
            ("beckhoff-zebra", ("--error", "0.02"), None),
            ("schneider-asc", ("--points", "80"), 1),
        ],
        1,
    ),
)
def test_a_controllers_file_becomes_the_motion_that_the_command_makes_of_it(
    open_user: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, slug: str, options: tuple[str, ...], segments: int
) -> None:
    table, by_command = tmp_path / "table.txt", tmp_path / "by_command.toml"
    words = ["ecam", str(example("card_picker")), "--out", str(table), "--controller", slug, *options]
    assert main(words) == 0
    by_command.write_bytes(example("card_picker").read_bytes())
    assert main(["measured", str(table), "--controller", slug, "--into", str(by_command)]) == 0
    user = open_user(example("card_picker"))
    before = user.design
    dialog = opened(user, table, monkeypatch)
    assert dialog.controller.currentData() == slug, "the first that can read it"
    assert dialog.plot.lines
    QTest.mouseClick(dialog.put_button, Qt.MouseButton.LeftButton)
    assert user.design.drive.motion == load(by_command).drive.motion
    assert segments in (None, len(user.design.drive.motion.segments))
    user.choose("Edit", "Undo Import table.txt")
    assert user.design == before


def test_a_file_that_is_none_of_the_chosen_controller_says_so(
    open_user: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = tmp_path / "table.txt"
    assert main(["ecam", str(example("card_picker")), "--out", str(table), "--controller", "sew-tab"]) == 0
    dialog = opened(open_user(example("card_picker")), table, monkeypatch)
    assert dialog.controller.currentData() == "sew-tab"
    lines, rows = dialog.plot.lines, len(table.read_text("utf-8").splitlines()) - 1
    assert f"{rows} rows of SEW" in dialog.message.text()
    assert np.ptp(lines[0][1]) == pytest.approx(40.0, rel=0.5)
    dialog.controller.setFocus()
    QTest.keyClick(dialog.controller, Qt.Key.Key_Home)
    assert "choose a file of this controller" in dialog.message.text()
    assert not dialog.put_button.isEnabled()
    assert not dialog.plot.lines
    QTest.keyClick(dialog, Qt.Key.Key_Escape)
