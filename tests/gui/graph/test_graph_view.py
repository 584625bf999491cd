"""kindyna_gui.graph.graph_view, graph_choice, pictures.polar: any channels in any plots, straight and polar."""

from dataclasses import replace
from io import BytesIO
from math import degrees, hypot, pi, radians
from pathlib import Path

import numpy as np
import pytest
from mechanisms import LIFT, PUSHER, with_follower, with_loads
from PIL import Image
from plot_reading import message
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from sampled import spread
from window_user import Alone, User, settle, wait_for

from core.design import Tolerance, edited, get
from core.motion import degrees as grid
from core.output.channels import channels
from core.output.export import csv
from core.study import Study
from kindyna_gui import dialogs
from kindyna_gui.documents.session import Session
from kindyna_gui.graph.graph_choice import FIRST, ChannelTree, PlotSelection, tip_of
from kindyna_gui.graph.graph_view import EMPTY, GraphView
from kindyna_gui.graph.live_plot import LivePlot
from kindyna_gui.graph.live_polar import LivePolar
from kindyna_gui.pictures.paper.sheets import columns_for, polar_file
from kindyna_gui.pictures.plots.polar import PolarPlot
from kindyna_gui.pictures.units import legible
from kindyna_gui.player import Player

JAMMED = with_loads(with_follower(PUSHER, offset_mm=0.0), friction=3.5)
UNITS = {row.name: row.unit.symbol for row in channels(LIFT)}


@pytest.fixture
def graph(alone: Alone) -> GraphView:
    return alone(GraphView(Session(LIFT), Player()), 900, 620)


def tick(view: GraphView, *quantities: str) -> None:
    """Click the boxes of these channels."""
    for name in quantities:
        item = view.tree.item_of(name)
        view.tree.scrollToItem(item)
        box = view.tree.visualItemRect(item)
        # the box itself stands at the left end of its line
        QTest.mouseClick(view.tree.viewport(), Qt.MouseButton.LeftButton, pos=QPoint(box.left() + 9, box.center().y()))
        settle()


def ticked(tree: ChannelTree) -> set[str]:
    return {name for name in UNITS if tree.item_of(name).checkState(0) == Qt.CheckState.Checked}


# -- which channel in which plot --------------------------------------------------------------------------


def test_what_has_the_unit_of_the_active_plot_joins_it() -> None:
    choice = PlotSelection([["displacement"]])
    choice.tick("slider_position", UNITS)
    assert choice.plots == [["displacement", "slider_position"]]
    choice.tick("velocity", UNITS)
    assert choice.plots == [["displacement", "slider_position"], ["velocity"]]
    assert choice.active == 1
    choice.tick("velocity", UNITS)
    assert choice.quantities == ["displacement", "slider_position", "velocity"], "twice is once"


def test_an_empty_plot_takes_anything() -> None:
    choice = PlotSelection([["displacement"]])
    choice.add()
    choice.add()
    assert choice.plots == [["displacement"], []], "one empty plot is enough"
    choice.tick("slider_position", UNITS)
    assert choice.plots == [["displacement"], ["slider_position"]]


def test_plots_go_with_their_last_channel() -> None:
    choice = PlotSelection([["displacement", "slider_position"], ["velocity"], ["jerk"]], active=2)
    choice.untick("displacement")
    choice.untick("velocity")
    assert choice.plots == [["slider_position"], ["jerk"]]
    assert choice.active == 1
    choice.remove(1)
    assert choice.active == 0
    choice.untick("radius")
    assert choice.plots == [["slider_position"]], "what is not shown cannot go"


def test_another_kind_keeps_what_it_has() -> None:
    choice = PlotSelection([["phi"], ["displacement", "beta"]])
    choice.restrict_to({row.name for row in channels(PUSHER)})
    assert choice.plots == [["displacement"]]


# -- the tree ---------------------------------------------------------------------------------------------


def test_the_tree_lists_every_channel_with_symbol_and_unit(graph: GraphView) -> None:
    for row in channels(LIFT):
        item = graph.tree.item_of(row.name)
        assert [item.text(i) for i in range(3)] == [row.label, legible(row.symbol), row.unit.symbol]
        tip = item.toolTip(0)
        assert tip == tip_of(row)
        assert row.slug in tip
        assert "Source: " in tip
    assert ticked(graph.tree) == {name for plot in FIRST for name in plot}


def test_no_name_of_a_channel_is_cut(graph: GraphView) -> None:
    tree, box_and_sign = graph.tree, 40
    for row in channels(LIFT):
        width = tree.fontMetrics().horizontalAdvance(tree.item_of(row.name).text(0))
        assert width + box_and_sign <= tree.columnWidth(0), row.label


@pytest.mark.parametrize(
    ("symbol", "shown"),
    [
        ("ẏ", "ẏ"),
        ("y⃛", "d³y/dt³"),
        ("φ̇", "dφ/dt"),
        ("β̈", "d²β/dt²"),
        ("L1 φ̇² cos", "L1 (dφ/dt)² cos"),
        ("L̇ cos", "dL/dt cos"),
        ("z̈", "d²z/dt²"),
    ],
)
def test_dots_that_fonts_lose_are_written_out(symbol: str, shown: str) -> None:
    assert legible(symbol) == shown


def test_channels_are_ticked_with_the_mouse(graph: GraphView) -> None:
    tick(graph, "contact_force", "guide_force", "radius")
    assert graph.selection.plots == [*map(list, FIRST), ["contact_force", "guide_force"], ["radius"]]
    assert [len(panel.plot.readings()) for panel in graph.panels] == [1, 1, 1, 2, 1]
    tick(graph, "contact_force", "velocity")
    assert graph.selection.plots == [["displacement"], ["acceleration"], ["guide_force"], ["radius"]]
    assert ticked(graph.tree) == {"displacement", "acceleration", "guide_force", "radius"}


def test_a_click_beside_the_box_counts_too(graph: GraphView) -> None:
    box = graph.tree.visualItemRect(graph.tree.item_of("jerk"))
    unit = QPoint(graph.tree.header().sectionViewportPosition(2) + 5, box.center().y())
    QTest.mouseClick(graph.tree.viewport(), Qt.MouseButton.LeftButton, pos=unit)
    assert "jerk" in graph.selection.quantities


def test_what_the_design_lacks_is_told_in_place_of_its_curve(graph: GraphView) -> None:
    graph.session.start(PUSHER)
    tick(graph, "motor_torque")
    assert len(graph.panels[-1].plot.readings()) == 1
    graph.session.put(JAMMED, "a")
    settle()
    assert graph.panels[-1].plot.readings() == []
    plot = graph.panels[-1].plot
    assert isinstance(plot, LivePlot)
    assert "jam" in message(plot)
    assert "jam" in graph.tree.item_of("motor_torque").toolTip(0)
    assert "motor_torque" not in [row.name for row in graph.drawn]
    tick(graph, "motor_torque")
    assert "motor_torque" not in graph.selection.quantities
    graph.session.put(PUSHER, "b")
    assert "jam" not in graph.tree.item_of("motor_torque").toolTip(0)


def test_where_every_plot_has_gone_one_says_what_would_fill_it(graph: GraphView) -> None:
    """By another kind of follower, which has none of the channels; and by the mouse."""
    for name in ("displacement", "velocity", "acceleration"):
        tick(graph, name)
    assert [message(panel.plot) for panel in graph.panels] == [EMPTY]
    tick(graph, "phi", "beta")
    assert graph.selection.plots == [["phi", "beta"]]
    graph.session.put(PUSHER, "a")
    settle()
    assert [message(panel.plot) for panel in graph.panels] == [EMPTY]
    tick(graph, "displacement")
    assert graph.panels[0].plot.readings() == ["0 mm"]


# -- plots ------------------------------------------------------------------------------------------------


def test_plots_are_added_and_taken_away(graph: GraphView) -> None:
    QTest.mouseClick(graph.add_button, Qt.MouseButton.LeftButton)
    assert [len(names) for names in graph.selection.plots] == [1, 1, 1, 0]
    plot = graph.panels[-1].plot
    assert isinstance(plot, LivePlot)
    assert message(plot) == EMPTY
    tick(graph, "slider_position")
    assert graph.selection.plots[-1] == ["slider_position"], "though another plot has its unit"
    for _ in range(3):
        QTest.mouseClick(graph.panels[0].close_button, Qt.MouseButton.LeftButton)
        settle()
    assert graph.selection.plots == [["slider_position"]]
    assert not graph.panels[0].close_button.isVisible(), "the last plot stays"
    tick(graph, "slider_position")
    assert graph.selection.plots == [[]]


def test_a_click_makes_a_plot_the_active_one(graph: GraphView) -> None:
    plot = graph.panels[1].plot
    assert isinstance(plot, LivePlot)
    QTest.mouseClick(plot.viewport(), Qt.MouseButton.LeftButton, pos=plot.pixel_at(120.0).toPoint())
    assert [panel.active for panel in graph.panels] == [False, True, False]
    assert degrees(graph.player.theta) == pytest.approx(120.0, abs=1.0)


def test_only_the_first_plot_names_segments_and_only_the_last_angles(graph: GraphView) -> None:
    plots = [panel.plot for panel in graph.panels]
    assert [plot.getAxis("top").height() > 10 for plot in plots if isinstance(plot, LivePlot)] == [True, False, False]
    assert [plot.getAxis("bottom").height() > 10 for plot in plots if isinstance(plot, LivePlot)] == [
        False,
        False,
        True,
    ]


def test_an_edit_is_drawn_and_the_cursor_follows(graph: GraphView) -> None:
    graph.session.edit("motion.stroke", 160.0, "a")
    assert graph.panels[0].plot.readings() == ["160.0 mm"]
    graph.player.set_theta(radians(180.0))
    assert graph.panels[0].plot.readings() == ["0 mm"]


# -- polar ------------------------------------------------------------------------------------------------


def test_straight_and_polar(graph: GraphView) -> None:
    QTest.mouseClick(graph.form_buttons["polar"], Qt.MouseButton.LeftButton)
    settle()
    assert all(isinstance(panel.plot, LivePolar) for panel in graph.panels)
    straight = [panel.plot.readings() for panel in graph.panels]
    graph.set_form("straight")
    assert [panel.plot.readings() for panel in graph.panels] == straight


@pytest.mark.stress
def test_bands_of_machines_lie_round_about_the_curve(alone: Alone) -> None:
    base = "cam.base_radius_mm"
    session = Session(replace(LIFT, tolerances=(Tolerance(base, 8.0),)))
    graph = alone(GraphView(session, Player()), 900, 620)
    tick(graph, "pressure_angle")
    graph.set_form("polar")
    plot = graph.panels[-1].plot
    assert isinstance(plot, LivePolar)
    assert not plot.bands, "nobody has asked"
    graph.bands.set_shown(True)
    wait_for(lambda: len(plot.bands) == 1)
    (outer, _), (inner, _) = plot.areas
    for angle in (60.0, 100.0, 250.0):
        low, high = (
            Study(edited(LIFT, base, get(LIFT, base) + side), 720)
            .at_theta(np.array([radians(angle)]))
            .cam.flanks[0]
            .pressure_angle[0]
            for side in (-4.0, 4.0)
        )  # 1.5 standard deviations to either side
        for value in (low, high):
            place = plot.position(angle, plot.distance(degrees(value)))
            assert outer.contains(place)
            assert inner.contains(place)
        assert not outer.contains(plot.position(angle, plot.distance(degrees(high + 2.0 * (high - low)))))
    graph.bands.set_shown(False)
    assert not plot.bands


def polar_of(*quantities: str, size: int = 420) -> PolarPlot:
    rows = {row.name: row for row in channels(LIFT)}
    plot = PolarPlot()
    plot.resize(size, size)
    plot.set_curves(Study(LIFT, 720), [rows[name] for name in quantities])
    return plot


def test_a_value_stands_at_its_distance(app: QApplication) -> None:
    """Where no value is negative the centre is 0, so that the radius of the cam is drawn to scale."""
    plot = polar_of("radius")
    study = Study(LIFT, 720)
    radius = np.abs(study.cam.flank.profile) * 1e3
    assert plot.distance(0.0) == 0.0
    bounds = plot.paths[0].boundingRect()
    theta = study.theta
    x, y = radius * np.cos(theta), radius * np.sin(theta)
    scale = plot.distance(100.0) / 100.0
    assert (bounds.width(), bounds.height()) == pytest.approx((np.ptp(x) * scale, np.ptp(y) * scale), abs=0.5)
    assert plot.centre.x() - bounds.left() == pytest.approx(-x.min() * scale, abs=0.5)
    plot.deleteLater()


@pytest.mark.parametrize(
    ("quantity", "size"), [("displacement", 420), ("velocity", 420), ("velocity", 220), ("jerk", 900)]
)
def test_circles_are_round_values_that_hold_the_curve(quantity: str, size: int, app: QApplication) -> None:
    plot = polar_of(quantity, size=size)
    values = {row.name: row for row in channels(LIFT)}[quantity].values(Study(LIFT, 720)) / plot.display_unit.size
    circles = plot.circles
    assert circles[0] <= values.min()
    assert values.max() <= circles[-1]
    assert 0.0 in circles
    assert 2 <= len(circles) <= 8
    apart = np.diff([plot.distance(value) for value in circles])
    assert apart.min() > 24.0, "their values do not touch"
    mantissa = (circles[1] - circles[0]) / 10.0 ** np.floor(np.log10(circles[1] - circles[0]))
    assert round(mantissa, 9) in (1.0, 2.0, 5.0)
    plot.deleteLater()


@pytest.mark.parametrize("size", [220, 420])
@pytest.mark.parametrize("quantities", [("displacement",), ("slider_pin", "arm_pin", "pivot", "bearing")])
def test_the_values_of_the_cursor_cover_neither_scale_nor_each_other(
    quantities: tuple[str, ...], size: int, app: QApplication
) -> None:
    plot = polar_of(*quantities, size=size)
    for angle in range(0, 360, 5):
        plot.set_angle(radians(angle))
        boxes = [box for _, box in plot.readouts()]
        assert len(boxes) == len(quantities)
        for i, box in enumerate(boxes):
            assert plot.rect().toRectF().contains(box)
            assert not any(box.intersects(other) for _, other in plot.texts()), f"{angle} deg, {i}"
            assert not any(box.intersects(other) for other in boxes[:i]), f"{angle} deg, {i}"
    plot.deleteLater()


def test_infinite_values_are_gaps(app: QApplication) -> None:
    rows = {row.name: row for row in channels(JAMMED)}
    plot = PolarPlot()
    plot.set_curves(Study(JAMMED, 720), [rows["contact_force"]])
    values = rows["contact_force"].values(Study(JAMMED, 720))
    assert np.isinf(values).any()
    (path,) = plot.paths
    starts = sum(path.elementAt(i).type == path.elementAt(i).type.MoveToElement for i in range(path.elementCount()))
    assert starts >= 1
    assert path.elementCount() == np.isfinite(values).sum()
    plot.deleteLater()


@pytest.mark.parametrize("angle", spread([0.0, 75.0, 180.0, 300.0], 2))
def test_a_click_sets_the_angle_of_the_ray(angle: float, graph: GraphView) -> None:
    graph.set_form("polar")
    settle()
    plot = graph.panels[0].plot
    assert isinstance(plot, LivePolar)
    graph.player.set_theta(1.0)
    QTest.mouseClick(plot, Qt.MouseButton.LeftButton, pos=plot.position(angle, 0.8 * plot.radius).toPoint())
    apart = (degrees(graph.player.theta) - angle + 180.0) % 360.0 - 180.0
    assert apart == pytest.approx(0.0, abs=1.5)


def test_the_angle_goes_round_counter_clockwise(app: QApplication) -> None:
    plot = polar_of("radius")
    up = plot.position(90.0, 100.0)
    assert up.y() < plot.centre.y()
    assert hypot(*(up - plot.centre).toTuple()) == pytest.approx(100.0)
    assert plot.angle_at(QPointF(plot.centre.x() - 50.0, plot.centre.y())) == pytest.approx(180.0)
    plot.deleteLater()


def test_an_empty_polar_plot_says_what_would_fill_it(graph: GraphView) -> None:
    graph.set_form("polar")
    graph.add_plot()
    plot = graph.panels[-1].plot
    assert isinstance(plot, LivePolar)
    assert plot.message == EMPTY
    QTest.mouseClick(plot, Qt.MouseButton.LeftButton)
    assert graph.player.theta == 0.0


def test_polar_plots_share_the_room() -> None:
    assert [columns_for(n, 900.0, 600.0) for n in (1, 2, 3, 4, 6)] == [1, 2, 2, 2, 3]
    assert columns_for(3, 300.0, 900.0) == 1


# -- files ------------------------------------------------------------------------------------------------


def test_the_numbers_are_the_cores(graph: GraphView, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "g.csv"
    monkeypatch.setattr(dialogs, "table_to_save", lambda _, suggestion: path)
    tick(graph, "contact_force", "radius")
    graph.export_numbers()
    study = Study(LIFT)
    names = ["cam_angle_deg", "displacement_mm", "velocity_mm_s", "acceleration_mm_s2", "contact_force_n", "radius_mm"]
    rows = {row.slug: row for row in channels(LIFT)}
    assert path.read_text("utf-8") == csv(
        names, [grid(study.samples), *(rows[name].values(study) for name in names[1:])]
    )


@pytest.mark.parametrize("form", spread(["straight", "polar"], 1))
def test_the_picture_shows_every_plot(form: str, graph: GraphView) -> None:
    graph.set_form(form)
    tick(graph, "contact_force")
    picture = Image.open(BytesIO(graph.picture(".png"))).convert("RGB")
    counts, pixels = (np.array(each) for each in zip(*picture.getcolors(picture.width * picture.height), strict=True))
    for colour in ((0x00, 0x72, 0xB2), (0x00, 0x9E, 0x73), (0xD5, 0x5E, 0x00)):
        near = np.abs(pixels - colour).max(axis=1) < 40
        assert counts[near].sum() > 200, f"no curve of colour {colour}"
    svg = graph.picture(".svg").decode()
    for name in ("Displacement", "Velocity", "Acceleration", "Contact force"):
        assert name in svg
    assert "<image" not in svg


def test_the_same_design_gives_the_same_polar_bytes(app: QApplication) -> None:
    rows = [row for row in channels(LIFT) if row.name == "radius"]
    assert polar_file(Study(LIFT, 360), [rows], ".png") == polar_file(Study(LIFT, 360), [rows], ".png")


def test_nothing_drawn_exports_no_numbers(graph: GraphView, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dialogs, "table_to_save", lambda *_: pytest.fail("nothing to save"))
    for plot in FIRST:
        tick(graph, *plot)
    graph.export_numbers()
    assert graph.picture(".png").startswith(b"\x89PNG")


def test_the_graph_is_a_page_of_the_window(user: User) -> None:
    user.choose("Graph", "New graph...")
    view = user.window.view("graph")
    assert isinstance(view, GraphView)
    assert view.on_screen()
    user.window.player.set_theta(pi)
    settle()
    assert view.panels[0].plot.readings() == ["0 mm"]
