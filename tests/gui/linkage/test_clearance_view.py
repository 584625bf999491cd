"""Kine > Clearances of bodies: outlines are added, typed, copied and removed, pairs get what they must keep; each is one undo step."""

from pathlib import Path

import pytest
from drawn_cams import drawn
from outlined import example, outline
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from window_user import Open, User, plain, settle, wait_for

from core.project import load
from kindyna_gui.linkage.clearance_view import ClearanceView

WALL = outline("frame", points=[[-20.0, 60.0], [30.0, 60.0], [30.0, 100.0], [-20.0, 100.0]])


@pytest.fixture
def design(tmp_path: Path) -> Path:
    path = tmp_path / "bars.toml"
    path.write_text(example("four_bar") + outline("link 2", round_mm=5.0) + WALL, "utf-8")
    return path


def opened(user: User) -> ClearanceView:
    user.choose("Kine", "Clearances of bodies")
    view = user.see("clearance")
    assert isinstance(view, ClearanceView)
    wait_for(lambda: view.up_to_date and not view.busy)
    return view


def cells(table) -> list[tuple[str, ...]]:
    return [row.cells for row in table.rows.rows]


def typed(user: User, editor, text: str) -> None:
    editor.setFocus()
    editor.selectAll()
    user.type(text)
    user.press(Qt.Key.Key_Return)


def settled(view: ClearanceView) -> None:
    settle()
    wait_for(lambda: view.up_to_date and not view.busy)


def test_outlines_and_pairs_are_listed_and_a_typed_growth_changes_the_clearance(
    same_window: Open, design: Path
) -> None:
    user = same_window(design)
    view = opened(user)
    assert cells(view.outlines) == [("link 2", "its points + 5 mm", ""), ("frame", "4 corners", "")]
    assert cells(view.pairs) == [("link 2 – frame", "25 mm", "90°", "")]
    view.outlines.selectRow(0)
    typed(user, view.boxes["round_mm"], "8")
    settled(view)
    assert cells(view.pairs) == [("link 2 – frame", "22 mm", "90°", "")]
    user.session.stack.undo()
    settled(view)
    assert cells(view.pairs)[0][1] == "25 mm"


def test_a_clearance_that_is_not_kept_is_red_and_a_finding(same_window: Open, design: Path) -> None:
    user = same_window(design)
    view = opened(user)
    place = view.pairs.visualRect(view.pairs.rows.index(0, 0)).center()
    QTest.mouseClick(view.pairs.viewport(), Qt.MouseButton.LeftButton, pos=place)
    assert user.window.player.theta == pytest.approx(1.5708, abs=1e-3)  # the machine shows the least clearance
    typed(user, view.least, "30")
    settled(view)
    (row,) = view.pairs.rows.rows
    assert row.cells[-1] == "30 mm"
    assert row.colour
    assert user.session.full_design.clearances[0].least_mm == 30.0
    QTest.keyClick(view.pairs, Qt.Key.Key_Delete)
    settled(view)
    assert user.session.full_design.clearances == ()


def test_outlines_are_added_copied_and_removed(same_window: Open, design: Path) -> None:
    user = same_window(design)
    view = opened(user)
    view.menu.aboutToShow.emit()
    entry = next(action for action in view.menu.actions() if plain(action.text()) == "link 4")
    entry.trigger()
    settled(view)
    assert cells(view.outlines)[-1] == ("link 4", "its points + 10 mm", "")
    QTest.mouseClick(view.buttons["copy"], Qt.MouseButton.LeftButton)
    settled(view)
    assert len(user.session.full_design.outlines) == 4
    view.outlines.selectRow(1)
    QTest.keyClick(view.outlines, Qt.Key.Key_Delete)
    settled(view)
    assert [row.of for row in user.session.full_design.outlines] == ["link 2", "link 4", "link 4"]
    for _ in range(3):
        user.session.stack.undo()
    settled(view)
    assert [row.of for row in user.session.full_design.outlines] == ["link 2", "frame"]


def test_corners_are_typed_and_refused_where_they_cross(same_window: Open, design: Path) -> None:
    user = same_window(design)
    view = opened(user)
    view.outlines.selectRow(1)
    typed(user, view.corners, "-20, 50; 30, 50; 30, 100")
    settled(view)
    assert cells(view.pairs)[0][1] == "15 mm"
    typed(user, view.corners, "0, 50; 30, 80; 30, 50; 0, 80")
    assert view.message.text().startswith(
        "Outline 2, points: crosses itself: the side from corner 1 meets the side from corner 3;"
    )
    assert len(user.session.full_design.outlines[1].points) == 3
    typed(user, view.corners, "here")
    assert "pairs of numbers" in view.message.text()
    view.outlines.selectRow(0)
    assert view.message.text() == "", "it belongs to the other outline"


def test_an_outline_is_taken_from_a_drawing_and_saved_with_the_design(same_window: Open, design: Path) -> None:
    (design.parent / "post.dxf").write_bytes(drawn(("circle", (0.0, 50.0), 10.0)))
    user = same_window(design)
    view = opened(user)
    view.outlines.selectRow(1)
    view.take_file(str(design.parent / "post.dxf"))
    settled(view)
    assert cells(view.outlines)[1] == ("frame", "post.dxf", "")
    assert cells(view.pairs)[0][1] == "5 mm"
    user.choose("File", "Save")
    assert load(design).outlines[1].file == "post.dxf"


def test_without_outlines_the_view_says_how_to_begin(same_window: Open, tmp_path: Path) -> None:
    path = tmp_path / "bar.toml"
    path.write_text(example("four_bar"), "utf-8")
    view = opened(same_window(path))
    assert "Press Add" in view.message.text()
    assert not view.form.isVisible()
