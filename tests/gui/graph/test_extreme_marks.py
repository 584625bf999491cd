"""Plots mark where their curves are highest and lowest; a spike is cut off, and shown in full at a click."""

import re
from collections import Counter
from collections.abc import Sequence
from itertools import combinations
from math import inf, radians
from pathlib import Path

import numpy as np
import pytest
from plot_reading import box_of, curves, is_limit, marks, readouts, tags
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QAccessible
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from window_user import Alone, Open, User, settle, wait_for

from core.design import edited
from core.motion.extremes import Extremes
from core.output.channels import channels
from core.output.drawing.turn import readable_range, typical_range
from core.project import load
from core.study import Quantity, Study
from kindyna_gui.documents.session import Session
from kindyna_gui.graph.graph_view import GraphView
from kindyna_gui.graph.live_plot import LivePlot
from kindyna_gui.graph.live_polar import LivePolar
from kindyna_gui.graph.plots_view import PlotView
from kindyna_gui.pictures.plots.quantities import channel_extremes
from kindyna_gui.places import example
from kindyna_gui.player import Player

LIFT = example("transfer_lift")
MASS = """
[[loads.masses]]
link = {}
centre = [35.0, 0.0]
mass_kg = 1.0
inertia_kg_m2 = 0.001
"""


def plot_view(user: User, name: str) -> PlotView:
    view = user.see(name)
    assert isinstance(view, PlotView)
    wait_for(lambda: view.up_to_date and not view.busy)
    return view


def locking(folder: Path) -> Path:
    """A four-bar whose crank comes to dead centres, with masses on coupler and rocker."""
    text = example("four_bar").read_text("utf-8")
    text = text.replace("A = [30.0, 0.0]", "A = [60.0, 0.0]").replace("B = [90.0, 0.0], C", "B = [50.0, 0.0], C")
    path = folder / "locking.toml"
    path.write_text(text + "\n[loads]\n" + MASS.format(3) + MASS.format(4), "utf-8")
    return path


def densely(study: Study, view: PlotView, sign: float) -> float:
    """The highest value of a plot's first channel, times a sign, by sampling ever more densely; in its unit."""
    (row, *_), low, high = view.rows, 0.0, 2.0 * np.pi
    for _ in range(4):
        theta = np.linspace(low, high, 1001)
        values = sign * row.values(study.at_theta(np.mod(theta, 2.0 * np.pi)))
        top = int(np.nanargmax(values))
        low, high = theta[max(top - 1, 0)], theta[min(top + 1, theta.size - 1)]
    return float(values[top])


@pytest.mark.stress
def test_an_edit_keeps_the_items_of_a_plot(open_user: Open) -> None:
    """Its marks are hidden until the new extremes are known, and are then the same items at other places."""
    user = open_user(LIFT, size=(1440, 900), whole=True)
    user.choose("View", "Dyna")
    view = plot_view(user, "acceleration")
    drawn, marked = view.plot.scene().items(), view.plot.marked()
    assert marked
    user.session.edit("shaft.speed_rpm", 1.25 * user.design.shaft.speed_rpm, "Change")
    assert not view.plot.marked()
    assert not marks(view.plot)
    assert view.plot.scene().items() == drawn
    wait_for(lambda: bool(view.plot.marked()))
    assert view.plot.marked() != marked
    assert view.plot.scene().items() == drawn


def test_the_marks_stand_at_the_true_extremes(open_user: Open) -> None:
    user = open_user(LIFT, size=(1440, 900), whole=True)
    user.choose("View", "Dyna")  # where plots are high enough for their marks
    for name in ("acceleration", "pressure_angle", "torque"):
        view = plot_view(user, name)
        study, size, row = user.session.study, view.plot.display_unit.size, view.rows[0]
        low, high, *_ = view.plot.marked()
        assert (low.highest, high.highest) == (False, True)
        true = {-1.0: -densely(study, view, -1.0), 1.0: densely(study, view, 1.0)}
        near = 1e-8 * (true[1.0] - true[-1.0])
        for mark, sign in ((low, -1.0), (high, 1.0)):
            assert mark.value * size == pytest.approx(true[sign], abs=near), name
            there = row.values(study.at_theta(np.array([radians(mark.angle)])))[0]
            assert there == pytest.approx(true[sign], abs=near), name
    assert any(tag.text == "7.511 at 302.72°" for tag in marks(plot_view(user, "torque").plot))
    spoken = QAccessible.queryAccessibleInterface(plot_view(user, "pressure_angle").plot)
    assert spoken.text(QAccessible.Text.Name) == "Plot of pressure angle"
    marked = {m.highest: m for m in plot_view(user, "pressure_angle").plot.marked()}
    said = spoken.text(QAccessible.Text.Description)
    assert re.fullmatch(r"pressure angle, \S+ to \S+°, largest at \S+°", said)
    largest = max(marked.values(), key=lambda m: abs(m.value))
    assert float(said.split()[-1][:-1]) == pytest.approx(largest.angle, rel=1e-3)


@pytest.mark.stress
def test_the_texts_cover_neither_curves_nor_each_other(open_user: Open) -> None:
    user = open_user(LIFT, size=(1440, 900), whole=True)
    user.choose("View", "Dyna")  # where plots are high enough for their marks
    read = 0
    for name in ("displacement", "velocity", "pressure_angle", "curvature", "torque", "contact_force"):
        plot = plot_view(user, name).plot
        texts = marks(plot)
        boxes = [box_of(tag).adjusted(0.0, 2.0, 0.0, -2.0) for tag in (*texts, *(t for t in tags(plot) if is_limit(t)))]
        assert not any(one.intersects(other) for one, other in combinations(boxes, 2)), name
        paper = plot.getViewBox().sceneBoundingRect()
        low, high = plot.getViewBox().viewRange()[1]
        for line in curves(plot):
            x = paper.left() + line.x / 360.0 * paper.width()
            y = paper.bottom() - (line.y - low) / (high - low) * paper.height()
            for box in boxes[: len(texts)]:
                assert paper.adjusted(-1.0, -3.0, 1.0, 3.0).contains(box), name
                assert not ((box.left() < x) & (x < box.right()) & (box.top() < y) & (y < box.bottom())).any(), name
        read += len(texts)
    assert read >= 8


def test_a_text_gives_way_to_what_is_read_at_the_cursor_in_a_low_plot(open_user: Open) -> None:
    user = open_user(example("lecture_six_bar"), size=(1280, 720))
    plot = plot_view(user, "displacement").plot
    plot.setFixedSize(388, 130)  # as where findings stand below
    settle()
    shown = {}
    for angle in range(0, 360, 30):
        user.turn(angle)
        boxes = [(tag.text, box_of(tag)) for tag in (*readouts(plot), *marks(plot))]
        for (one, box), (other, behind) in combinations(boxes, 2):
            both = box.intersected(behind)
            assert min(both.width(), both.height()) <= 4.5, f"{one} over {other} at {angle}"
        shown[angle] = len(marks(plot))
    assert 0 < max(shown.values()) != min(shown.values()), "what had to go comes back"


def test_a_spike_near_a_dead_centre_is_cut_and_a_click_shows_it(open_user: Open, tmp_path: Path) -> None:
    user = open_user(locking(tmp_path), size=(1440, 900))
    view = plot_view(user, "torque")
    plot = view.plot
    values = view.rows[0].values(user.session.study)
    assert np.abs(values).max() > 1e4
    cut = plot.getViewBox().viewRange()[1]
    assert max(map(abs, cut)) * plot.display_unit.size < 10.0, "the torque in between can be read"
    assert [mark.value for mark in plot.marked()] == [-inf, inf], "at a dead centre it grows without limit"
    locks = sorted(np.rad2deg(end) for r in user.session.study.driver_ranges.ranges for end in (r.low, r.high))
    assert all(min(abs(mark.angle - lock) for lock in locks) < 1e-6 for mark in plot.marked())
    assert len(marks(plot)) == 2
    forces = [tag.text for tag in marks(plot_view(user, "contact_force").plot)]
    assert len(set(forces)) == len(forces), "what several curves share is written once"
    view = plot_view(user, "torque")
    button = plot.full_range_button
    assert button is not None
    assert button.isVisible()
    for click in (lambda: QTest.mouseClick(button, Qt.MouseButton.LeftButton), lambda: _click_arrow(view)):
        click()
        settle()
        low, high = plot.getViewBox().viewRange()[1]
        assert low * plot.display_unit.size <= values.min()
        assert high * plot.display_unit.size >= values.max()
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)
        settle()
        assert plot.getViewBox().viewRange()[1] == cut
        assert len(plot.marked()) == 2


def _click_arrow(view: PlotView) -> None:
    theta = view.player.theta
    place = box_of(marks(view.plot)[0]).center()
    QTest.mouseClick(view.plot.viewport(), Qt.MouseButton.LeftButton, pos=QPoint(round(place.x()), round(place.y())))
    assert view.player.theta == theta, "it is no click for another angle"


def test_what_is_no_spike_is_shown_in_full(open_user: Open) -> None:
    user = open_user(LIFT, size=(1440, 900))
    for name in ("jerk", "torque"):
        plot = plot_view(user, name).plot
        assert plot.full_range_button is not None
        assert not plot.full_range_button.isVisible(), name
    moving = np.ones(1800, dtype=bool)
    narrow = np.zeros(1800)
    narrow[100:121] = np.sin(np.linspace(0.0, np.pi, 21))
    assert readable_range(narrow, narrow != 0.0) == typical_range(narrow), "a short stroke between dwells"
    wave = np.sin(np.linspace(0.0, 2.0 * np.pi, 1800))
    wave[500] = 90.0
    low, high = readable_range(wave, moving)
    assert low == wave.min()
    assert 1.0 < high < 3.0


def test_extremes_are_refined_for_plots_in_sight_alone_and_never_by_a_frame_or_an_edit(
    open_user: Open, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: Counter[str] = Counter()

    def counted(study: Study, rows: Sequence[Quantity]) -> dict[str, Extremes]:
        asked.update(row.name for row in rows)
        return channel_extremes(study, rows)

    monkeypatch.setattr("kindyna_gui.graph.marked_view.channel_extremes", counted)
    user = open_user(LIFT, size=(1440, 900))
    view = plot_view(user, "pressure_angle")
    assert dict(asked) == {"pressure_angle": 1}
    before = view.plot.marked()
    for _ in range(5):
        user.window.player.step(1.0)
        settle()
    assert dict(asked) == {"pressure_angle": 1}
    for length in (846.0, 847.0):
        assert user.session.edit("follower.rod_mm", length, "Change rod")
        assert dict(asked) == {"pressure_angle": 1}, "an edit waits for none"
        assert view.plot.marked() == [], "nor does a mark stand where it no longer belongs"
    wait_for(lambda: not view.busy)
    assert dict(asked) == {"pressure_angle": 2}
    assert len(view.plot.marked()) == 2
    assert view.plot.marked() != before


@pytest.mark.stress
def test_one_switch_hides_the_marks_of_all_plots(open_user: Open) -> None:
    user = open_user(LIFT, size=(1440, 900), whole=True)
    user.choose("View", "Dyna")  # where plots are high enough for their marks
    views = [plot_view(user, name) for name in ("velocity", "pressure_angle", "torque")]
    assert all(marks(view.plot) for view in views)
    (action,) = (a for a in views[0].plot.actions() if a.text() == "Mark extremes")
    action.trigger()
    settle()
    assert not any(marks(view.plot) or view.plot.marked() for view in views)
    assert user.session.edit("follower.rod_mm", 846.0, "Change rod")
    settle()
    assert not any(view.busy or view.plot.marked() for view in views)
    action.trigger()
    seen = [view for view in views if view.on_screen()]
    assert seen
    wait_for(lambda: all(marks(view.plot) for view in seen))
    for view in views:
        plot_view(user, view.names[0] if view.names[0] != "drive_torque" else "torque")
        wait_for(lambda view=view: bool(marks(view.plot)))  # type: ignore[misc]


def test_a_coupler_curve_is_seen_over_its_plate(open_user: Open) -> None:
    user = open_user(example("four_bar"))
    view = user.drawing()
    view.show_layer("coupler", True)
    settle()
    scene = view.scene
    plate = scene.item("body.link3")
    assert scene.item("coupler.C").zValue() > plate.zValue()
    assert scene.item("coupler.A").zValue() < plate.zValue(), "the paths of pins stay behind"
    assert scene.item("pin.A").zValue() > scene.item("coupler.C").zValue()


def test_a_picture_of_a_plot_has_the_marks_that_the_screen_has(open_user: Open) -> None:
    view = plot_view(open_user(LIFT, size=(1440, 900)), "torque")
    assert "302.72°" in view.picture(".svg").decode()
    (action,) = (a for a in view.plot.actions() if a.text() == "Mark extremes")
    action.trigger()
    assert "302.72°" not in view.picture(".svg").decode()


def test_a_curvature_is_infinite_at_its_cusp_whatever_the_samples_there_are(app: QApplication) -> None:
    """Until its extremes are refined an arrow without a number says that a peak is cut off; then it is infinite, right where
    the pitch curve's radius is the roller's."""
    study = Study(edited(load(LIFT), "cam.base_radius_mm", 86.0), 1800)
    rows = {row.name: row for row in channels(study.design)}
    row, roller = rows["profile_curvature"], study.design.drive.face.radius_mm * 1e-3
    plot = LivePlot()
    plot.resize(420, 300)
    plot.set_curves(study, [row])
    assert np.isfinite(row.values(study)).all()
    assert len(plot.marked()) == 2
    assert marks(plot) == [], "no figure of a sample"
    plot.show_extremes(channel_extremes(study, [row]))
    low, high = plot.marked()
    assert (low.value, high.value) == (-inf, inf)
    assert {tag.text for tag in marks(plot)} == {f"\u2212\u221e at {low.angle:.2f}°", f"\u221e at {high.angle:.2f}°"}
    for mark in (low, high):
        there = study.at_theta(np.array([radians(mark.angle)])).cam.flank.pitch_curvature[0]
        assert abs(there) * roller == pytest.approx(1.0, abs=1e-4)
    polar = LivePolar()
    polar.resize(420, 420)
    polar.set_curves(study, [row])
    polar.show_extremes(channel_extremes(study, [row]))
    assert {mark.text for mark in polar.marks} == {tag.text for tag in marks(plot)}
    plot.deleteLater()
    polar.deleteLater()


@pytest.fixture
def polar(alone: Alone) -> GraphView:
    """The lift's first graph, in polar form."""
    graph: GraphView = alone(GraphView(Session(load(LIFT)), Player()), 900, 620)
    graph.set_form("polar")
    wait_for(lambda: graph.up_to_date and not graph.busy)
    return graph


def polar_plots(graph: GraphView) -> list[LivePolar]:
    return [panel.plot for panel in graph.panels if isinstance(panel.plot, LivePolar)]


def test_polar_plots_mark_what_straight_ones_do(polar: GraphView) -> None:
    found = [plot.marked() for plot in polar_plots(polar)]
    assert all(len(marked) >= 2 for marked in found)
    (switch,) = (a for a in polar_plots(polar)[0].actions() if a.text() == "Mark extremes")
    picture = polar.picture(".svg").decode()
    assert all(mark.text in picture for plot in polar_plots(polar) for mark in plot.marks if not mark.box.isEmpty())
    switch.trigger()
    settle()
    assert not any(plot.marked() or plot.marks for plot in polar_plots(polar))
    assert " at " not in polar.picture(".svg").decode()
    switch.trigger()
    wait_for(lambda: not polar.busy)
    assert [plot.marked() for plot in polar_plots(polar)] == found
    polar.set_form("straight")
    wait_for(lambda: not polar.busy)
    assert [panel.plot.marked() for panel in polar.panels] == found


@pytest.mark.stress
def test_the_texts_of_polar_marks_stand_beside_their_places_and_cover_nothing(polar: GraphView) -> None:
    laid = 0
    for plot in polar_plots(polar):
        plot.set_angle(radians(plot.marked()[0].angle))
        boxes = [mark.box for mark in plot.marks if not mark.box.isEmpty()]
        others = [box for _, box in plot.texts()] + [box for _, box in plot.readouts()]
        assert not any(one.intersects(other) for one, other in combinations(boxes, 2))
        assert not any(box.intersects(other) for box in boxes for other in others)
        for mark, extreme in zip(plot.marks, plot.marked(), strict=True):
            assert mark.at == plot.position(extreme.angle, plot.distance(extreme.value))
            assert not any(
                mark.box.contains(path.pointAtPercent(i / 3000.0)) for path in plot.paths for i in range(3001)
            )
        laid += len(boxes)
    assert laid >= 3
