"""File > Import linkage: text pasted or a file opened, inputs chosen, what is left out said, a design begun that Undo takes back."""

from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from window_user import Open, answering

from core.design import faults
from kindyna_gui import dialogs
from kindyna_gui.files.beginnings import LinkageDialog

BAR = """M[J[R, P[0, 0], L[ground, crank]], J[R, P[0, 20], L[crank, rod]], J[R, P[50, 40], L[rod, rocker]],
J[R, P[60, 0], L[ground, rocker]]]"""
SLOT = """<linkage2><program units="Millimeters" scalefactor="1"/>
<connector id="0" x="0" y="0" anchor="true" input="true" rpm="30"/><connector id="1" x="20" y="0"/>
<connector id="2" x="60" y="40"/><connector id="3" x="60" y="0" anchor="true"/>
<connector id="4" x="90" y="9" layer="1"/>
<Link id="0"><connector id="0"/><connector id="1"/></Link><Link id="1"><connector id="1"/><connector id="2"/></Link>
<Link id="2"><connector id="2"/><connector id="3"/></Link></linkage2>"""


@pytest.fixture
def open_user(same_window: Open) -> Open:
    return same_window


def test_a_pasted_expression_begins_a_design_with_the_input_chosen(open_user: Open) -> None:
    user = open_user()
    before = user.session.full_design

    def answer(dialog: LinkageDialog) -> None:
        assert not dialog.ok.isEnabled()
        dialog.text.setPlainText("M[J[R")
        assert not dialog.ok.isEnabled()
        assert "Expression" in dialog.message.text()
        dialog.text.setPlainText(BAR)
        names = [dialog.inputs.item(i).text() for i in range(dialog.inputs.count())]
        assert names == ["P0", "P3"]
        assert not dialog.picture.pixmap().isNull()
        assert "4 links, 4 joints" in dialog.message.text()
        assert "Not imported: unit of length" in dialog.message.text()
        dialog.units.setCurrentText("cm")
        dialog.inputs.item(0).setCheckState(Qt.CheckState.Unchecked)
        dialog.inputs.item(1).setCheckState(Qt.CheckState.Checked)
        assert "unit of length" not in dialog.message.text()
        dialog.accept()

    with answering(LinkageDialog, answer):
        user.choose("File", "Import linkage...")
    linkage = user.session.design.drive.linkage
    assert faults(user.session.design) == []
    assert set(linkage.by_number[linkage.driver.link].places) == {"P2", "P3"}
    assert linkage.by_number[1].places["P3"] == 600.0
    user.session.stack.undo()
    assert user.session.full_design == before


def test_a_file_is_opened_and_named_after(open_user: Open, tmp_path: Path, monkeypatch) -> None:
    path = tmp_path / "press.linkage2"
    path.write_text(SLOT, encoding="utf-8")
    monkeypatch.setattr(dialogs, "file_to_open", lambda *_: path)
    user = open_user()

    def answer(dialog: LinkageDialog) -> None:
        dialog.open_button.click()
        assert "Not imported: connector 4: it is on the drawing's layer" in dialog.message.text()
        dialog.accept()

    with answering(LinkageDialog, answer):
        user.choose("File", "Import linkage...")
    assert user.session.design.name == "press"
    assert user.session.design.drive.linkage.driver.speed_rpm == -30.0
