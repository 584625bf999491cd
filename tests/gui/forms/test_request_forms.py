"""What a command asks for is said once, in a request: its options and its dialog's form follow."""

from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from window_user import Open, User, answering, wait_for

from core.__main__ import main
from core.commands.cams import InspectionArguments
from core.commands.export import ExportArguments as Tables
from core.design.fields import choice, flag, number
from core.frozen import frozen
from core.output.export import Film
from core.output.files.probe import InspectionRequest
from core.output.files.profile_request import Machining
from core.output.files.sheet import DrawingRequest
from core.requests import option
from kindyna_gui.forms.refusal import FloatingRefusal
from kindyna_gui.forms.request_form import RequestForm
from kindyna_gui.inspection import InspectionDialog
from kindyna_gui.places import example


@pytest.fixture
def open_user(same_window: Open) -> Open:
    """One window for all tests of this file."""
    return same_window


@frozen
class Strange(InspectionRequest):
    """An inspection for which a stranger wants to know more."""

    pace_mm_min: float = option(number("Pace of the probe", 1.0, 500.0, default=60.0, help="along the profile"))
    side: str = option(choice("Side", ("near", "far"), default="near", help="of the cam"), words={"far": "Far side"})
    dry: bool = flag("Without oil", help="wipe the cam first")


@frozen(kw_only=True)
class StrangeArguments(InspectionArguments):
    """The command's with this request."""

    request: Strange = Strange()


def test_a_field_of_a_stranger_is_an_option_and_stands_in_the_dialog(
    user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of the real command and the real dialog, from nothing but the request."""
    monkeypatch.setattr("core.commands.cams.InspectionArguments", StrangeArguments)
    monkeypatch.setattr("kindyna_gui.inspection.InspectionRequest", Strange)
    assert main(["inspection", "--help"]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "--pace MM/MIN along the profile (60)" in told
    assert "--side {near,far} side of the cam (near)" in told
    assert "--dry wipe the cam first" in told
    words = ["inspection", str(example("tappet_flat")), "--out", str(tmp_path / "cam.csv")]
    assert main([*words, "--pace", "501"]) == 2
    assert "argument --pace: '501': pace of the probe; allowed: 1 ... 500 mm/min" in capsys.readouterr().err
    taken: list[Any] = []
    monkeypatch.setattr(
        "core.commands.cams.run_inspection", lambda arguments, painter: taken.append(arguments.request) or 0
    )
    assert main([*words, "--pace", "90", "--side", "far", "--dry", "--samples", "72"]) == 0
    typed = (taken[0].pace_mm_min, taken[0].side, taken[0].dry, taken[0].samples, taken[0].flank)
    assert typed == (90.0, "far", True, 72, "inner")

    def act(dialog: InspectionDialog) -> None:
        pace, side, dry = (dialog.form.boxes[name] for name in ("pace_mm_min", "side", "dry"))
        labels = [dialog.form.rows.labelForField(box) for box in (pace, side)]
        assert [label.text() for label in labels] == ["Pace of the probe, mm/min", "Side"]
        assert (pace.text(), side.currentText(), dry.isChecked()) == ("60", "Near", False)
        assert "Allowed: 1 ... 500 mm/min" in pace.toolTip()
        pace.setFocus()
        pace.selectAll()
        QTest.keyClicks(pace, "501")
        (line,) = (line for line in dialog.findChildren(FloatingRefusal) if line.isVisible())
        assert line.text() == "Outside its range; allowed: 1 ... 500 mm/min, not 501 mm/min"
        assert list(line.buttons) == ["Use 500 mm/min", "Back to 60 mm/min"]
        assert (pace.text(), pace.is_refused) == ("501", True)
        assert (dialog.export.isEnabled(), dialog.copy.isEnabled()) == (False, False)
        QTest.mouseClick(line.buttons["Use 500 mm/min"], Qt.MouseButton.LeftButton)
        assert (pace.text(), pace.is_refused, line.isVisible()) == ("500", False, False)
        wait_for(lambda: dialog.export.isEnabled() and dialog.copy.isEnabled())
        pace.selectAll()
        QTest.keyClicks(pace, "45.5")
        QTest.keyClick(side, Qt.Key.Key_Down)
        dry.click()
        wait_for(lambda: dialog.computed is not None)
        taken.append(dialog.computed.setup.request)
        dialog.reject()

    with answering(InspectionDialog, act):
        user.choose("File", "Export", "Inspection table...")
    assert (taken[1].pace_mm_min, taken[1].side, taken[1].dry) == (45.5, "far", True)


@pytest.mark.parametrize("kind", [InspectionRequest, DrawingRequest, Machining, Film])
def test_a_form_begins_with_what_a_command_takes_as_usual(app: QApplication, kind: Any) -> None:
    assert RequestForm(kind).request == kind()


def test_files_and_texts_are_no_part_of_a_form(app: QApplication) -> None:
    """A dialog asks for them in its own way."""
    form = RequestForm(Tables)
    assert form.values == {"samples": 3600}
    form.show_value("samples", 72)
    assert form.values == {"samples": 72}
