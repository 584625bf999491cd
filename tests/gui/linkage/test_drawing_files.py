"""A drawing is saved whatever it lacks, and is opened, recovered and undone as it was drawn."""

from __future__ import annotations

from pathlib import Path

import pytest
from pen import CTRL, Key, Pen, start
from PySide6.QtCore import QPointF
from window_user import Open, settle, wait_for

from core.__main__ import main
from kindyna_gui.files.recovery import recovery_folder


def two_loose_bars(open_user: Open) -> Pen:
    pen = start(open_user)
    pen.drag(0j, 40 + 10j)
    pen.drag(-20 + 40j, 60 + 50j)
    return pen


def test_two_loose_bars_are_saved_opened_and_undone(
    open_user: Open, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pen, file = two_loose_bars(open_user), tmp_path / "loose.toml"
    drawn, places = pen.design.drive.mechanism, dict(pen.places)
    pen.user.picks("design_to_save", file)
    pen.user.choose("File", "Save as...")
    assert not pen.user.session.modified
    assert "points = {}" in file.read_text("utf-8")
    assert main(["check", str(file)]) == 2
    assert "6 degrees of freedom without a driver: ground a point" in capsys.readouterr().err
    other = Pen(open_user(file))
    assert other.design.drive.mechanism == drawn
    other.user.drawing().canvas.setFocus()
    other.key(Key.Key_D)
    assert other.places == pytest.approx(places)
    other.key(Key.Key_B)
    other.drag("B", "C")
    assert set(other.shape(4)) == {"B", "C"}
    other.key(Key.Key_Z, CTRL)
    assert other.design.drive.mechanism == drawn
    while pen.user.session.stack.canUndo():
        pen.user.session.stack.undo()
    assert pen.places == {}
    pen.user.choose("File", "Save")
    assert Pen(open_user(file)).places == {}


def test_two_loose_bars_are_recovered_after_a_crash(open_user: Open) -> None:
    """The recovery file of a process that has died is offered by the next window."""
    pen = two_loose_bars(open_user)
    drawn = pen.design.drive.mechanism
    wait_for(lambda: any(recovery_folder().glob("*.toml")))
    (file,) = recovery_folder().glob("*.toml")
    wait_for(lambda: "number = 3" in file.read_text("utf-8"))
    text = file.read_text("utf-8")
    pen.user.session.stack.setClean()
    wait_for(lambda: not file.exists())
    file.with_name("left.toml").write_text(text, "utf-8")
    other = open_user()
    other.clicks("Recover")
    other.window.recovery.offer()
    settle()
    assert other.session.typed.drive.mechanism == drawn
    assert other.drawing().shows_layout
    again = Pen(other)
    other.choose("Compo", "Draw")
    other.drawing().drawing.choose_tool("bar")
    again.drag("B", "C")
    assert set(again.shape(4)) == {"B", "C"}
    other.session.stack.undo()
    assert again.design.drive.mechanism == drawn


def test_a_four_bar_that_looks_joined_is_joined(open_user: Open, tmp_path: Path) -> None:
    """With clicks a few pixels off every pin and saved half-way: one degree of freedom, a coupler curve, no field in red."""
    pen = start(open_user, whole=True, size=(1440, 900))
    pen.canvas.show_region(QPointF(40.0, 20.0), 2.3)
    pen.key(Key.Key_G)
    pen.click(-10 + 0j)
    pen.click(90 + 0j)
    pen.key(Key.Key_B)
    pen.click(-10 + 4j)
    pen.click(-10 + 30j)
    pen.click(-6 + 34j)
    pen.type("75", "30")
    file = tmp_path / "half.toml"
    pen.user.picks("design_to_save", file)
    pen.user.choose("File", "Save as...")
    assert not pen.user.session.modified
    assert main(["check", str(file)]) == 2
    pen.key(Key.Key_B)
    pen.click(pen.places["B"] + 3 - 3j)
    pen.click(86 - 4j)
    assert [list(pen.shape(n)) for n in (2, 3, 4)] == [["O1", "A"], ["A", "B"], ["B", "O2"]]
    assert pen.user.session.incomplete is None
    pen.key(Key.Key_T)
    pen.click((pen.places["A"] + pen.places["B"]) / 2.0)
    pen.type("40", "25")
    view = pen.user.drawing()
    assert view.drawing.paths.drawn()["C"].is_driven
    for name, at in pen.places.items():
        others = [abs(at - other) * pen.canvas.scale_now for n, other in pen.places.items() if n != name]
        assert min(others) > 8.0, "pins that overlap would look like one"
    pen.key(Key.Key_Escape)
    pen.key(Key.Key_Escape)
    assert view.scene.item("coupler.C").isVisible()
    assert not any(form.in_trouble for form in pen.user.parameters().forms.values())
    pen.user.choose("File", "Save")
    assert main(["check", str(file)]) == 0
