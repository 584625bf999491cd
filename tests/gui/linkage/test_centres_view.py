"""The lecture's figures on the screen: instant centres, Kennedy's construction, velocities, the circle diagram."""

import math
import re
from typing import Any

import pytest
from PySide6.QtCore import QModelIndex, Qt
from PySide6.QtWidgets import QApplication
from sampled import spread
from window_user import Open, User, settle, wait_for

from kindyna_gui.forms.tables import RowsModel, RowsTable
from kindyna_gui.linkage.centres_view import CentresView, CircleView
from kindyna_gui.pictures.drawing.centre_parts import CentreMarks, KennedyLines
from kindyna_gui.places import example


def centres(user: User) -> CentresView:
    view = user.see("centres")
    assert isinstance(view, CentresView)
    wait_for(lambda: not view.busy)
    return view


def circle(user: User) -> CircleView:
    view = user.see("circle")
    assert isinstance(view, CircleView)
    return view


def number(text: str) -> float:
    return float(re.sub(r"[^0-9.\-]", "", text.replace("\u2212", "-")))


def cells(view: CentresView, table: str) -> dict[str, tuple[str, ...]]:
    """First cell -> the others."""
    return {row.cells[0]: row.cells[1:] for row in view.page(table).rows.rows}


def distance(view: CentresView, one: str, other: str) -> float:
    for box, text in ((view.first, one), (view.second, other)):
        box.setCurrentIndex(box.findText(text))
        box.activated.emit(box.currentIndex())
    return number(view.distance.text())


def test_the_six_bars_numbers_stand_on_the_screen(six_bar: User) -> None:
    """Velocity, p. 11, in four significant digits."""
    view = centres(six_bar)
    links, points = cells(view, "links"), cells(view, "points")
    assert [number(links[n][1]) for n in "345"] == [-6.638, 20.57, -20.57]
    assert points["D"][2] == "\u2212223.8"
    assert distance(view, "I12", "I13") == 200.8
    assert distance(view, "I14", "I13") == 163.9
    assert distance(view, "I12", "I14") == 60.0
    assert len(cells(view, "centres")) == 15
    assert cells(view, "centres")["I16"][:2] == ("at infinity", "90.00°")


def test_the_differences_in_the_table_close_their_triangles(six_bar: User) -> None:
    """V_B = V_A + V_BA, V_D = V_C + V_DC, as read from the cells; the block slides on the frame with all of V_D."""
    view = centres(six_bar)
    points = {name: complex(number(row[2]), number(row[3])) for name, row in cells(view, "points").items()}
    rows = cells(view, "differences")
    told = {name: complex(number(row[1]), number(row[2])) for name, row in rows.items()}
    for name in ("BA", "CB", "DC"):
        assert told[f"V {name}"] == pytest.approx(points[name[0]] - points[name[1]], abs=0.1)
    assert rows["V DC"][0] == "5"
    assert told["V D6D1"] == -223.8 + 0j
    assert number(rows["V D6D1"][3]) / 10.0 == pytest.approx(22.39, abs=0.02)


def test_the_table_follows_the_player(six_bar: User) -> None:
    view = centres(six_bar)
    before = cells(view, "links")["4"]
    six_bar.window.player.step(10.0)
    wait_for(lambda: not view.busy)
    after = cells(view, "links")["4"]
    study = six_bar.session.at(six_bar.window.player.theta)
    assert study.design.drive.is_linkage
    assert after != before
    assert number(after[0]) == pytest.approx(float(study.angular_velocities()[4][0]), rel=2e-4)


@pytest.mark.parametrize(("name", "count"), [("slider_crank", 6), ("lecture_six_bar", 15)])
def test_all_centres_are_drawn_where_they_are(name: str, count: int, open_user: Open) -> None:
    user = open_user(example(name))
    view = user.drawing()
    user.action("View", "Layers of the drawing", "Instant centres of all links").trigger()
    user.turn(40.0)
    marks: CentreMarks = view.scene.linkage_layers.marks  # type: ignore[assignment]
    assert len(marks.marks) == count
    table = user.session.study.centres
    for mark in marks.marks:
        found = table.centres[mark.key]
        i = view.scene.index
        far = bool(found.is_far(table.size)[i])
        assert mark.dot.isVisible() != mark.arrow.isVisible()
        assert mark.tag.text == mark.name + (" ∞" if far else "")
        if mark.dot.isVisible():
            place = complex(mark.dot.pos().x(), mark.dot.pos().y())
            assert place == pytest.approx(complex(found.finite[i]) * 1e3, abs=1e-9)


def test_a_centre_at_infinity_is_an_arrow_at_the_edge(open_user: Open) -> None:
    user = open_user(example("slider_crank"))
    view = user.drawing()
    view.show_layer("centres", True)
    user.turn(40.0)
    assert view.scene.linkage_layers is not None
    assert view.scene.linkage_layers.marks is not None
    mark = next(m for m in view.scene.linkage_layers.marks.marks if m.name == "14")
    assert mark.arrow.isVisible()
    assert mark.arrow.rotation() == pytest.approx(-90.0)  # across the guide
    edge = view.canvas.visible.bottom() - mark.arrow.pos().y()
    assert 0.0 < edge * view.canvas.scale_now < 60.0


def test_kennedys_lines_run_through_the_three_centres(six_bar: User) -> None:
    view = six_bar.drawing()
    six_bar.action("View", "Layers of the drawing", "Kennedy's construction").trigger()
    settle()
    lines: KennedyLines = view.scene.linkage_layers.kennedy  # type: ignore[assignment]
    table, i = six_bar.session.study.centres, view.scene.index
    tried = 0
    for step, _, item in lines.rows:
        centre = complex(table.centres[step.key].finite[i]) * 1e3
        if item.isVisible() and math.isfinite(abs(centre)):
            one, other = item.line().p1(), item.line().p2()
            along = complex(other.x() - one.x(), other.y() - one.y())
            off = ((centre - complex(one.x(), one.y())) * along.conjugate()).imag / abs(along)
            assert abs(off) < 1e-6 * (1.0 + abs(centre)), step.key
            tried += 1
    assert tried > 8


def test_layers_of_linkages_go_on_and_off(open_user: Open) -> None:
    user = open_user(example("four_bar"))
    view = user.drawing()
    assert "Cam" not in user.entries("View", "Layers of the drawing")
    for text, key in (("Coupler curves", "coupler.C"), ("Velocities", "velocities.link3.C")):
        user.choose("View", "Layers of the drawing", text)
        assert view.scene.item(key).isVisible()
        user.choose("View", "Layers of the drawing", text)
        assert not view.scene.item(key).isVisible()


def test_the_circle_diagram_finds_one_centre_after_the_other(open_user: Open) -> None:
    """Known ones solid, wanted dotted, each from its two triangles, whose lines are drawn in the mechanism."""
    six_bar = open_user(example("lecture_six_bar"))
    six_bar.turn(45.0)
    view = circle(six_bar)
    plan = six_bar.session.study.centres.construction
    assert len(view.diagram.solid) == 7
    assert len(view.diagram.dotted) == 8
    assert not view.back.isEnabled()
    for step in range(1, 9):
        view.next.click()
        settle()
        wanted = plan.steps[step - 1]
        assert view.diagram.target == wanted
        assert wanted.key in view.diagram.dotted
        for triangle in wanted.triangles[:2]:
            assert triangle.first in view.diagram.solid
            assert triangle.second in view.diagram.solid
        scene = six_bar.drawing().scene
        assert scene.linkage_layers is not None
        assert scene.linkage_layers.kennedy is not None
        assert {row[0].key for row in scene.linkage_layers.kennedy.rows if row[2].isVisible()} <= {wanted.key}
        assert view.count.text() == f"{step} of 8"
    assert not view.next.isEnabled()
    view.back.click()
    assert six_bar.session.step == 7
    view.end.click()
    settle()
    assert not six_bar.drawing().scene.layer_shown("kennedy")


def test_the_first_wanted_centre_of_the_four_bar_is_told_as_the_lecture_does(open_user: Open) -> None:
    user = open_user(example("four_bar"))
    view = circle(user)
    view.next.click()
    assert (
        view.text.text()
        == "13 is the intersection of the lines 12\u201323 (links 1, 2, 3) and 14\u201334 (links 1, 3, 4)."
    )


def test_a_cam_design_has_its_centres_listed_and_no_circle_diagram(user: User) -> None:
    """The lift: cam and arm move alike at Q, on the line from the cam centre to the pivot."""
    view = user.window.show_view("circle")
    wait_for(lambda: view.up_to_date)
    assert view.is_unavailable
    listed = centres(user)
    user.window.player.set_theta(math.radians(50.0))
    wait_for(lambda: "-284.4" in cells(listed, "centres")["arm, cam"][0].replace("\u2212", "-"))
    rows = cells(listed, "centres")
    assert len(rows) == 10
    assert rows["arm, cam"][1] == "21.16"
    assert rows["frame, slider"][:2] == ("at infinity", "90.00°")
    assert rows["arm, cam"][2] == "frame, arm\u2013frame, cam \u00d7 contact normal"
    assert rows["rod, cam"][2] == "frame, rod\u2013frame, cam \u00d7 rod, arm\u2013arm, cam"
    assert distance(listed, "frame, cam", "arm, cam") == 285.2
    assert number(cells(listed, "links")["cam"][0]) == 2.094
    assert number(cells(listed, "links")["arm"][2]) == 0.2456
    assert "roller" in cells(listed, "points")


class Asked:
    """Which cells of a table Qt asks for, frame by frame."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.cells: set[tuple[int, int]] = set()
        self.count = 0
        data = RowsModel.data

        def counted(model: RowsModel, index: QModelIndex, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
            self.count += 1
            self.cells.add((index.row(), index.column()))
            return data(model, index, role)

        monkeypatch.setattr(RowsModel, "data", counted)

    def clear(self) -> None:
        self.cells.clear()
        self.count = 0


def texts(table: RowsTable) -> dict[tuple[int, int], str]:
    return {(i, j): text for i, row in enumerate(table.rows.rows) for j, text in enumerate(row.cells)}


@pytest.mark.parametrize("name", spread(["lecture_six_bar", "stephenson_six_bar"], 1))
def test_a_frame_asks_only_for_cells_in_sight_whose_text_changes(
    name: str, open_user: Open, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(CentresView, "reading_ms", 0)
    asked = Asked(monkeypatch)
    user = open_user(example(name), size=(1440, 900))
    table = centres(user).page("centres")
    settle()
    before, roles = texts(table), 12
    asked.clear()
    for _ in range(6):
        user.window.player.step(3.0)
        settle()
        now = texts(table)
        changed = {cell for cell in now if now[cell] != before[cell]}
        seen = {
            cell for cell in changed if table.visualRect(table.rows.index(*cell)).intersects(table.viewport().rect())
        }
        assert asked.cells <= changed
        assert seen <= asked.cells, "what has changed is drawn"
        assert asked.count <= roles * len(changed)
        asked.clear()
        before = now
    assert seen


def test_while_playing_the_numbers_change_now_and_then_and_end_right(
    open_user: Open, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(CentresView, "reading_ms", 60_000)  # however slow the machine is
    asked = Asked(monkeypatch)
    user = open_user(example("lecture_six_bar"), size=(1440, 900))
    table, player = centres(user).page("centres"), user.window.player
    settle()
    asked.clear()
    shown = {tuple(texts(table).values())}
    player.set_speed(1e-9)  # frames by hand
    player.play()
    for _ in range(12):
        player.set_theta(player.theta + 0.05)
        QApplication.processEvents()
        shown.add(tuple(texts(table).values()))
    assert asked.count < 400, "in twelve frames, of which one is shown in the table"
    assert len(shown) == 2
    player.play(False)
    played, theta = texts(table), player.theta
    for other in (theta + 1.0, theta):
        player.set_theta(other)
        user.window.view("centres").settle()
    assert texts(table) == played, "the last angle of what was played"


def test_a_wider_number_widens_its_column_and_none_is_cut(open_user: Open) -> None:
    user = open_user(example("lecture_six_bar"), size=(1440, 900))
    table = centres(user).page("centres")
    settle()
    widths = [table.columnWidth(column) for column in (0, 1, 2)]
    for _ in range(24):
        user.window.player.step(15.0)
        user.window.view("centres").settle()
        settle()
        now = [table.columnWidth(column) for column in (0, 1, 2)]
        assert all(a >= b for a, b in zip(now, widths, strict=True)), "no column jumps back"
        widths = now
        for (row, column), text in texts(table).items():
            if column < 3 and table.rowViewportPosition(row) < table.viewport().height():
                assert table.fontMetrics().horizontalAdvance(text) <= table.columnWidth(column), text
