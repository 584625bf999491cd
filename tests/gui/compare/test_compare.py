"""A pinned variant in plots, drawing and table, and where a number comes from, by menus, mouse and keys."""

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QAction
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from window_user import Open, User, settle, wait_for

from core import project
from core.design import get, only, put
from core.output.channels import channels
from core.output.explain import explained
from core.shaft import rms
from core.study import Study, evaluations
from kindyna_gui.compare import CompareView, ExplainView
from kindyna_gui.dialogs import SaveAnswer
from kindyna_gui.graph.curves_view import CurvesView
from kindyna_gui.graph.graph_view import GraphView
from kindyna_gui.graph.live_polar import LivePolar
from kindyna_gui.graph.plots_view import PlotView, StackView
from kindyna_gui.motion.segments_view import SegmentsView
from kindyna_gui.pictures.plots.curves import CurvePlot
from kindyna_gui.pictures.plots.lines import CurveLine
from kindyna_gui.places import example
from kindyna_gui.shaft import AgainstSpeedView, ShaftTorqueView
from kindyna_gui.timing_view import TimingView
from kindyna_gui.view import ExplainableNumber

BASE = "cam.base_radius_mm"


def shown(user: User, name: str) -> list[tuple[str, ...]]:
    view = user.window.show_view(name)
    wait_for(lambda: view.up_to_date)
    assert isinstance(view, CompareView | ExplainView)
    return [row.cells for row in view.table.rows.rows]


@pytest.mark.stress
def test_two_base_radii_are_compared_in_every_plot_after_one_pin_and_one_edit(user: User) -> None:
    user.choose("Edit", "Pin this variant")
    user.session.edit(BASE, 420.0, "a")
    plot = user.window.show_view("pressure_angle")
    assert isinstance(plot, PlotView)
    wait_for(lambda: plot.up_to_date)
    assert "variant " in plot.plot.legend.text
    rows = shown(user, "compare")
    inputs = [row for row in rows if row[1] == "input"]
    assert [row[2:] for row in inputs] == [("400", "420", "20")]
    changed = {(row[0], row[1]) for row in rows}
    assert ("Cam radius, mm", "min") in changed
    assert ("Displacement, mm", "max") not in changed
    user.choose("Edit", "Unpin")
    user.window.show_view("pressure_angle")
    wait_for(lambda: plot.up_to_date)
    assert "variant " not in plot.plot.legend.text


def test_a_number_that_was_found_leaves_room_for_the_names(user: User) -> None:
    user.choose("Edit", "Pin this variant")
    user.session.edit(BASE, 425.4531315784769, "a")
    assert shown(user, "compare")[0] == ("Base radius Br", "input", "400", "425.453", "25.4531")
    view = user.window.view("compare")
    assert isinstance(view, CompareView)
    assert "400 → 425.4531315784769" in view.table.rows.rows[0].tip


STROKE = "motion.stroke_deg"


def pinned_unit(open_user: Open) -> tuple[User, CompareView]:
    """The transfer unit on 1440 × 900, pinned by keys, then with a longer stroke that is typed; what that changed."""
    user = open_user(example("transfer_unit"), (1440, 900), whole=True)
    user.press(Qt.Key.Key_P, modifier=Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier)
    user.enter(STROKE, "26")
    user.choose("Edit", "What changed")
    view = user.window.view("compare")
    assert isinstance(view, CompareView)
    wait_for(lambda: view.up_to_date and not view.in_trouble)
    return user, view


@pytest.mark.stress
def test_what_changed_shows_the_input_at_once_and_never_that_nothing_changed(open_user: Open) -> None:
    """Results of four drives take seconds; the inputs do not wait for them."""
    user = open_user(example("transfer_unit"), (1440, 900), whole=True)
    user.choose("Edit", "Pin this variant")
    assert shown(user, "compare") == [("No difference from the pinned variant.", "", "", "", "")]
    view = user.window.view("compare")
    assert isinstance(view, CompareView)
    assert view.choice.currentText() == "variant 1"
    user.enter(STROKE, "26")
    seen: list[list[tuple[str, ...]]] = []

    def is_first_row_known() -> bool:
        rows = [row.cells for row in view.table.rows.rows]
        seen.extend([rows] if not seen or seen[-1] != rows else [])
        return view.up_to_date and len(rows) > 20

    wait_for(is_first_row_known)
    stroke = ("Feed: Segment 1, rise", "input", "24", "26", "2")
    first = next(rows for rows in seen if rows[0] == stroke)
    assert first[-1][0] == "Comparing with the pinned variant …"
    assert all(rows[0] == stroke for rows in seen[seen.index(first) :])


def click_row(view: CompareView, row: int) -> None:
    at = view.table.rows.index(row, 0)
    view.table.scrollTo(at)
    QTest.mouseClick(view.table.viewport(), Qt.MouseButton.LeftButton, pos=view.table.visualRect(at).center())
    settle()


def test_what_changed_reads_inputs_then_twenty_results_and_leads_to_their_curves(open_user: Open) -> None:
    user, view = pinned_unit(open_user)
    rows = [row.cells for row in view.table.rows.rows]
    kinds = [row[1] for row in rows]
    assert rows[0] == ("Feed: Segment 1, rise", "input", "24", "26", "2")
    assert kinds.index("new") > kinds.count("input") - 1
    results = [row for row in rows if row[1] in ("max", "min", "")]
    assert len(results) == 20
    assert rows[-20:] == results
    assert ("Feed: Velocity, °/s", "max", "79.18", "85.78", "8.33 %") in rows
    assert ("Feed: Displacement, °", "max", "24", "26", "2") in rows
    assert view.table.horizontalScrollBar().maximum() == 0, "every number is read without widening"
    QTest.mouseClick(view.all, Qt.MouseButton.LeftButton)
    everything = [row.cells for row in view.table.rows.rows]
    assert everything[: len(rows)] == rows
    assert len(everything) > len(rows) + 20
    QTest.mouseClick(view.all, Qt.MouseButton.LeftButton)
    assert [row.cells for row in view.table.rows.rows] == rows
    click_row(view, rows.index(next(row for row in rows if row[:2] == ("Feed: Pressure angle, °", "max"))))
    plot = user.window.view("pressure_angle")
    assert isinstance(plot, PlotView)
    wait_for(lambda: plot.up_to_date and plot.on_screen())
    assert "variant 1" in plot.plot.legend.text
    click_row(view, rows.index(next(row for row in rows if row[0] == "Torque of Feed, N·m")))
    shaft = user.window.view("shaft_torque")
    assert shaft is not None
    assert shaft.on_screen()


def dashed(plot: CurvePlot) -> list[CurveLine]:
    items = [item for item in plot.scene().items() if isinstance(item, CurveLine)]
    return [item for item in items if item.pen().style() == Qt.PenStyle.CustomDashLine]


def test_both_variants_are_in_every_plot(open_user: Open) -> None:
    """Motion editor, motion and pressure angle, single plots, all drives, the shaft, graph, polar graph and curves."""
    user, _ = pinned_unit(open_user)
    before = Study(only(project.load(example("transfer_unit")), 0))
    motion, stack = user.see("motion"), user.see("stack")
    assert isinstance(motion, SegmentsView)
    assert isinstance(stack, StackView)
    plots = dict(zip(("velocity", "acceleration", "jerk"), motion.derivatives.plots, strict=True))
    for name, plot in [*plots.items(), *stack.plots.items()]:
        assert "variant 1" in plot.legend.text, name
        (line,) = dashed(plot)
        row = next(row for row in channels(before.design) if row.name == name)
        assert line.y.max() == pytest.approx(row.values(before).max() / plot.display_unit.size, rel=1e-3), name
    assert "variant 1" in motion.diagram.legend.text
    torque = user.see("torque")
    assert isinstance(torque, PlotView)
    assert len(dashed(torque.plot)) == len(torque.rows)
    torque.all_drives.trigger()
    wait_for(lambda: torque.up_to_date)
    drives = torque.drives_plot
    assert drives.legend.text.count("variant 1") == 1
    assert [line.label for line in drives.shown if not line.reference] == ["Feed", "Clamp", "Lift", "Torque", "Shaft"]
    pinned = [line for line in drives.shown if line.reference == "variant 1"]
    assert len(pinned) == 5
    assert all(line.dash for line in pinned)
    shaft = user.see("shaft_torque")
    wait_for(lambda: not shaft.busy)
    assert isinstance(shaft, ShaftTorqueView)
    assert all("variant 1" in plot.legend.text for plot in shaft.plots)
    graph = user.see("graph")
    assert isinstance(graph, GraphView)
    for form in ("straight", "polar"):
        graph.set_form(form)
        for panel in graph.panels:
            if isinstance(panel.plot, LivePolar):
                assert len(panel.plot.references) == len(panel.plot.paths)
            else:
                assert "variant 1" in panel.plot.legend.text
    curves = user.see("curves")
    assert isinstance(curves, CurvesView)
    assert "variant 1" in curves.plot.legend.text
    assert curves.plot.references[0].y.max() == pytest.approx(24.0)
    user.choose("Edit", "Unpin")
    for name in ("motion", "stack", "torque", "curves"):
        user.see(name)
    assert "variant" not in motion.diagram.legend.text + curves.plot.legend.text + drives.legend.text
    assert not any(dashed(plot) for plot in stack.plots.values())


PICTURES = {
    "torque": "Torque",
    "stack": "Motion and pressure angle",
    "graph": "Graph",
    "curves": "Curves",
    "timing": "Timing",
}
"""View -> its entry in the menu Export picture."""


def exported(user: User, name: str, to: Path) -> str:
    """The picture of a view, exported by the menu."""
    user.picks("picture_to_save", to)
    user.see(name)
    user.choose("Graph", "Export picture", f"{PICTURES[name]}...")
    return to.read_text("utf-8")


@pytest.mark.stress
def test_both_variants_are_in_pictures_that_are_exported(open_user: Open, tmp_path: Path) -> None:
    """Until another design is opened; also from the menu of the timing chart while its view is closed."""
    user, _ = pinned_unit(open_user)
    user.picks("timing_to_save", tmp_path / "closed.svg")
    user.choose("File", "Export", "Timing chart...")
    assert "variant 1" in (tmp_path / "closed.svg").read_text("utf-8")
    for name in PICTURES:
        picture = exported(user, name, tmp_path / f"{name}.svg")
        assert "variant 1" in picture, name
        assert "stroke-dasharray" in picture, name
    graph = user.window.view("graph")
    assert isinstance(graph, GraphView)
    graph.set_form("polar")
    assert "variant 1" in exported(user, "graph", tmp_path / "polar.svg")
    user.answers(SaveAnswer.DISCARD)
    user.window.open_design(example("transfer_lift"))
    for name in PICTURES:
        assert "variant" not in exported(user, name, tmp_path / f"{name}.svg"), name


@pytest.mark.stress
def test_the_timing_chart_has_both_variants_at_one_scale(open_user: Open) -> None:
    user, _ = pinned_unit(open_user)
    view = user.see("timing")
    assert isinstance(view, TimingView)
    chart = view.canvas.chart
    assert chart.reference_name == "variant 1"
    assert sorted(chart.dashed) == [0, 1, 2, 3]
    feed, pinned = chart.bands[0], chart.dashed[0]
    assert (feed.stroke, pinned.stroke) == pytest.approx((26.0, 24.0))
    assert (feed.level.max(), pinned.level.max()) == pytest.approx((1.0, 24.0 / 26.0))
    user.choose("Edit", "Unpin")
    wait_for(lambda: view.up_to_date)
    assert not view.canvas.chart.dashed


@pytest.mark.stress
def test_torque_against_speed_has_both_variants(open_user: Open) -> None:
    user, _ = pinned_unit(open_user)
    view = user.see("against_speed")
    assert isinstance(view, AgainstSpeedView)
    wait_for(lambda: not view.busy)
    before, now = Study(project.load(example("transfer_unit"))).camshaft, user.session.shaft
    for plot in (view.torque, view.fluctuation):
        assert plot.legend.text.count("variant 1") == 1
    lines = view.torque.shown
    both = [lines[1], [line for line in lines if line.reference == "variant 1"][1]]
    drawn, pinned = (np.interp(before.design.speed_rpm, line.x, line.y) for line in both)
    assert lines[1].label == "RMS"
    assert pinned / drawn == pytest.approx(rms(before.load) / rms(now.load), rel=1e-6)
    assert pinned < drawn
    user.choose("Edit", "Unpin")
    wait_for(lambda: view.up_to_date and not view.busy)
    assert "variant" not in view.torque.legend.text + view.fluctuation.legend.text


@pytest.mark.stress
def test_the_table_stays_until_the_next_one_is_known(open_user: Open) -> None:
    """Also where the steady response of the shaft, which takes long, belongs to it."""
    user, view = pinned_unit(open_user)
    user.enter(STROKE, "27")
    seen = set()
    while (row := view.table.rows.rows[0].cells)[3] == "26" or not view.up_to_date:
        seen.add((view.in_trouble, row[3]))
        QTest.qWait(5)
    assert seen <= {(False, "26"), (False, "27")}
    assert view.table.rows.rows[0].cells == ("Feed: Segment 1, rise", "input", "24", "27", "3")


@pytest.mark.stress
def test_a_row_of_another_drive_selects_it_and_one_without_a_plot_goes_to_the_graph(open_user: Open) -> None:
    user, view = pinned_unit(open_user)
    user.session.put_full_design(put(user.session.full_design, "drives[1].cam.base_radius_mm", 300.0), "a")
    wait_for(lambda: view.up_to_date and any(row.cells[0].startswith("Clamp: ") for row in view.table.rows.rows))
    rows = [row.cells for row in view.table.rows.rows]
    click_row(view, next(i for i, row in enumerate(rows) if row[0].startswith("Clamp: ") and row[1] == "input"))
    assert user.session.names[user.session.chosen] == "Clamp"
    user.session.choose_drive(0)
    wait_for(lambda: view.up_to_date)
    QTest.mouseClick(view.all, Qt.MouseButton.LeftButton)
    names = [row.cells[0] for row in view.table.rows.rows]
    click_row(view, names.index("Clamp: Guide force, N"))
    assert user.session.names[user.session.chosen] == "Clamp"
    graph = user.window.view("curves")
    assert isinstance(graph, CurvesView)
    wait_for(lambda: graph.up_to_date and graph.on_screen())
    assert any(series.name.startswith("Guide force") for series in graph.data.series)


def test_nothing_of_a_variant_is_computed_while_nothing_shows_it(user: User) -> None:
    views = [user.window.show_view(name) for name in ("pressure_angle", "torque")]
    settle()
    wait_for(lambda: not any(view.busy for view in views))
    before = dict(evaluations)
    user.choose("Edit", "Pin this variant")
    settle()
    wait_for(lambda: not any(view.busy for view in views))
    assert dict(evaluations) == before, "the variant is the design at hand, whose results are known"


def test_a_file_is_pinned_and_saved_as_a_page(user: User, tmp_path: Path) -> None:
    project.save(user.design, tmp_path / "other.toml")
    user.session.edit(BASE, 430.0, "a")
    user.picks("design_to_open", tmp_path / "other.toml")
    user.choose("Edit", "Compare with another file...")
    rows = shown(user, "compare")
    assert any(row[2:4] == ("400", "430") for row in rows)
    user.picks("comparison_to_save", tmp_path / "c.html")
    view = user.window.show_view("compare")
    assert isinstance(view, CompareView)
    QTest.mouseClick(view.save, Qt.MouseButton.LeftButton)
    assert "430" in (tmp_path / "c.html").read_text("utf-8")


def test_what_was_before_the_last_step_is_pinned(user: User) -> None:
    user.session.edit(BASE, 425.0, "Change base radius")
    user.choose("Edit", "Compare with the last step")
    rows = shown(user, "compare")
    assert any(row[2:4] == ("400", "425") for row in rows)
    view = user.window.show_view("compare")
    assert isinstance(view, CompareView)
    assert view.choice.currentText() == "before: Change base radius"


def test_a_pinned_variant_without_an_answer_is_said_to_be_the_pinned_one(user: User, tmp_path: Path) -> None:
    """The curves of the design at hand stay; plot and table say that it is the variant, and why."""
    project.save(put(user.design, "follower.slider_arm_mm", 100.0), tmp_path / "short.toml")
    user.picks("design_to_open", tmp_path / "short.toml")
    user.choose("Edit", "Compare with another file...")
    plot = user.window.show_view("pressure_angle")
    assert isinstance(plot, PlotView)
    wait_for(lambda: plot.up_to_date)
    assert not plot.in_trouble
    assert plot.note.text().startswith("Pinned short: ")
    view = user.window.show_view("compare")
    wait_for(lambda: view.up_to_date)
    assert view.in_trouble
    assert view.no_picture.startswith("Pinned short: ")


@pytest.mark.parametrize("way", ["file", "example", "new", "step"])
def test_a_pin_goes_with_its_design(open_user: Open, tmp_path: Path, way: str) -> None:
    """Also another example and a new design; undoing the step that began one does not bring it back."""
    user = open_user()
    user.answers(SaveAnswer.DISCARD)
    project.save(user.design, tmp_path / "other.toml")
    user.choose("Edit", "Pin this variant")
    plot = user.window.show_view("velocity")
    assert isinstance(plot, PlotView)
    wait_for(lambda: plot.up_to_date)
    assert "variant 1" in plot.plot.legend.text
    if way == "file":
        user.window.open_design(tmp_path / "other.toml")
    elif way == "example":
        user.window.open_design(example("transfer_lift"))
    elif way == "new":
        user.window.documents.new("oscillating")
    else:
        user.window.documents.begin(put(user.design, BASE, 410.0), "another")
    wait_for(lambda: plot.up_to_date)
    assert "variant" not in plot.plot.legend.text
    if way == "step":
        user.choose("Edit", "Undo Begin with another")
        wait_for(lambda: plot.up_to_date)
        assert "variant" not in plot.plot.legend.text
    assert shown(user, "compare") == []


def test_a_pin_stays_when_its_file_is_read_again(open_user: Open, tmp_path: Path) -> None:
    user = open_user()
    user.session.save(tmp_path / "lift.toml")
    user.choose("Edit", "Pin this variant")
    user.session.edit(BASE, 420.0, "a")
    user.session.save(tmp_path / "renamed.toml")
    project.save(put(user.design, BASE, 430.0), tmp_path / "renamed.toml")
    user.session.reload()
    assert any(row[2:4] == ("400", "430") for row in shown(user, "compare"))


def test_the_oldest_of_four_variants_goes(open_user: Open) -> None:
    user = open_user()
    for radius in (401.0, 402.0, 403.0, 404.0):
        user.session.edit(BASE, radius, "a")
        user.choose("Edit", "Pin this variant")
    shown(user, "compare")
    view = user.window.show_view("compare")
    assert isinstance(view, CompareView)
    assert [view.choice.itemText(i) for i in range(view.choice.count())] == ["variant 4", "variant 3", "variant 2"]


def test_a_right_click_on_the_torque_explains_it_at_the_angle_at_hand(user: User) -> None:
    plot = user.window.show_view("torque")
    assert isinstance(plot, PlotView)
    wait_for(lambda: plot.up_to_date)
    user.window.player.set_theta(1.0)
    action = next(
        each for each in plot.plot.actions() if isinstance(each, QAction) and each.text() == "Explain this value"
    )
    action.trigger()
    view = user.window.show_view("explain")
    assert isinstance(view, ExplainView)
    wait_for(lambda: view.up_to_date)
    wanted = explained(Study(user.design), "drive_torque_nm", 180.0 / 3.141592653589793)
    assert [row.cells[0] for row in view.table.rows.rows] == [each.symbol for each in wanted.letters]
    assert wanted.lines[0] in view.header.text()
    assert "Shin1995 (27)" in view.header.text()
    assert "residual" in view.proof.text()


def test_a_letter_that_is_typed_leads_to_its_field(user: User, app: QApplication) -> None:
    user.window.explain(ExplainableNumber("phi_rad_s"))
    view = user.window.show_view("explain")
    assert isinstance(view, ExplainView)
    wait_for(lambda: view.up_to_date)
    row = next(i for i, each in enumerate(view.table.rows.rows) if each.cells[-1] == "follower.slider_arm_mm")
    asked: list[str] = []
    view.field_requested.connect(asked.append)
    view.table.clicked.emit(view.table.rows.index(row, 0))
    assert asked == ["follower.slider_arm_mm"]


def test_a_pin_and_an_edit_compare_two_base_radii_in_every_plot_in_four_actions(user: User) -> None:
    """Ctrl+Shift+P, a click into the field, the radius, Enter."""
    box = user.number(BASE)
    user.press(Qt.Key.Key_P, modifier=Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier)
    QTest.mouseDClick(box, Qt.MouseButton.LeftButton)
    user.type("420")
    user.press(Qt.Key.Key_Return)
    assert get(user.design, BASE) == 420.0
    for name in ("displacement", "pressure_angle", "curvature", "contact_force", "torque"):
        view = user.window.show_view(name)
        assert isinstance(view, PlotView)
        wait_for(lambda view=view: view.up_to_date)  # type: ignore[misc]
        assert "variant " in view.plot.legend.text


@pytest.mark.stress
def test_the_largest_torque_is_followed_down_to_typed_lengths_in_five_actions(user: User) -> None:
    """A right click on it in the flywheel's table, Explain, a click on the contact force in it, one on the lever: the cam's fields."""
    table = user.window.show_view("flywheel")
    wait_for(lambda: table.up_to_date)
    rows = table.table.rows.rows
    row = next(i for i, each in enumerate(rows) if each.cells[0] == "Cam torque, highest")
    QTest.mouseClick(
        table.table.viewport(),
        Qt.MouseButton.RightButton,
        pos=table.table.visualRect(table.table.rows.index(row, 0)).center(),
    )
    next(each for each in table.table.actions() if each.text() == "Explain this value").trigger()
    view = user.window.show_view("explain")
    assert isinstance(view, ExplainView)
    wait_for(lambda: view.up_to_date)
    assert "Cam torque at 302.72°: 7511 N·m" in view.header.text()

    def click(symbol: str) -> None:
        number = next(i for i, each in enumerate(view.table.rows.rows) if each.cells[0] == symbol)
        place = view.table.visualRect(view.table.rows.index(number, 0)).center()
        QTest.mouseClick(view.table.viewport(), Qt.MouseButton.LeftButton, pos=place)
        settle()
        wait_for(lambda: view.up_to_date)

    click("F")
    assert view.header.text().startswith("Contact force at 302.72°: 43\u202f480 N")
    asked: list[str] = []
    view.field_requested.connect(asked.append)
    click("l")
    assert asked == ["cam"]
    assert user.number(BASE).isVisible()


def test_shift_f1_explains_what_is_chosen_where_the_focus_is(user: User) -> None:
    view = user.window.show_view("certificate")
    wait_for(lambda: view.up_to_date)
    row = next(i for i, each in enumerate(view.table.rows.rows) if each.cells[0] == "Power balance")
    view.table.setFocus()
    view.table.selectRow(row)
    user.window.actions_by_key["explain_here"].trigger()
    shown = user.window.show_view("explain")
    assert isinstance(shown, ExplainView)
    wait_for(lambda: shown.up_to_date)
    assert shown.header.text().startswith("Cam torque at")


@pytest.mark.stress
def test_the_peak_of_a_shaft_is_explained_at_its_machine_angle(open_user: Open) -> None:
    user = open_user(example("transfer_unit"))
    figures = user.window.show_view("shaft_figures")
    wait_for(lambda: figures.up_to_date and not figures.busy)
    row = next(i for i, each in enumerate(figures.table.rows.rows) if each.cells[0] == "Shaft")
    figures.table.selectRow(row)
    user.window.explain(figures.selected_number())
    view = user.window.show_view("explain")
    assert isinstance(view, ExplainView)
    wait_for(lambda: view.up_to_date)
    wanted = explained(user.session.full_study, "torque_nm")
    assert view.header.text().startswith(wanted.headline(4))
    assert [each.cells[3] for each in view.table.rows.rows][:2] == ["Torque of Feed", "Torque of Clamp"]


def test_every_number_of_the_design_can_be_chosen(user: User) -> None:
    user.window.explain(ExplainableNumber("drive_torque_nm"))
    view = user.window.show_view("explain")
    assert isinstance(view, ExplainView)
    wait_for(lambda: view.up_to_date)
    place = next(i for i in range(view.choice.count()) if "(needed_inertia_kg_m2)" in view.choice.itemText(i))
    view.choice.activated.emit(place)
    wait_for(lambda: view.up_to_date)
    assert view.header.text().startswith("Flywheel needed")
    assert view.header.text().split(":")[1].split(" ")[1] == "34\u202f940"


def test_a_picture_is_copied_twice_as_fine_as_the_screen(user: User, app: QApplication) -> None:
    view = user.window.centre.current
    assert view is not None
    view.setFocus()
    user.choose("Edit", "Copy picture")
    image = app.clipboard().image()
    assert image.width() >= 2 * view.content.width() - 4
    assert image.height() >= view.content.height()
