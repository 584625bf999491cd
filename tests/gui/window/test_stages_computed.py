"""Stages of views: what a view does not read is not computed, what an edit does not touch stays, what is hidden rests."""

from collections import Counter
from collections.abc import Callable
from threading import enumerate as enumerate_threads

import numpy as np
import pytest
from plot_reading import cursor, curves, readouts, tags
from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from sampled import stressed
from window_user import Open, User, settle, wait_for

from core.design import Design
from core.output.channels import channel
from core.project import load
from core.study import STAGES, clear_caches, evaluations
from core.study.stages import memory
from kindyna_gui.background import Worker
from kindyna_gui.graph.graph_view import GraphView
from kindyna_gui.graph.marked_view import marks_action
from kindyna_gui.graph.plots_view import PlotView
from kindyna_gui.motion.segments_view import SegmentsView
from kindyna_gui.pictures.plots.curves import CurvePlot
from kindyna_gui.pictures.plots.quantities import stages_of
from kindyna_gui.pictures.units import measure
from kindyna_gui.places import example
from kindyna_gui.requirements import lists_links
from kindyna_gui.view import View
from kindyna_gui.window.docks import VIEWS

NEEDS = {"motion": {"motion"}, "linkage": {"motion", "linkage"}, "cam": {"motion", "linkage", "cam"}}
NEEDS["dynamics"] = {*NEEDS["cam"], "dynamics"}
NEEDS["stability"] = set()  # of a rigid shaft nothing is computed
PLOTS = {name: row for name, row in VIEWS.items() if row.quantities}
ALL = ("motion", "linkage", "cam", "dynamics")


@pytest.fixture
def whole(open_user: Open) -> User:
    """Nothing has been seen in it before."""
    return open_user(whole=True)


@pytest.fixture
def user(whole: User) -> User:
    """At a window where every stage is in sight, and a form."""
    whole.choose("View", "Dyna")
    wait_for(
        lambda: whole.window.docks["contact_force"].view is not None and whole.window.view("contact_force").up_to_date
    )
    marks_action(whole.session).setChecked(False)  # extremes are looked for beside the window
    wait_for(lambda: not any(isinstance(each, Worker) for each in enumerate_threads()))
    return whole


def closure(read: tuple[str, ...]) -> set[str]:
    """Stages with all that they need."""
    return {need for stage in read for need in NEEDS[stage]}


def computed() -> set[str]:
    """What has been evaluated; the flywheel belongs to the dynamics."""
    return {"dynamics" if stage == "flywheel" else stage for stage in evaluations}


def tick(graph: GraphView, quantity: str, on: bool = True) -> None:
    """Tick the box of a channel, or untick it."""
    graph.tree.item_of(quantity).setCheckState(0, Qt.CheckState.Checked if on else Qt.CheckState.Unchecked)
    settle()


def empty(user: User) -> GraphView:
    """Everything closed but a graph that shows nothing."""
    while any(not dock.isHidden() for dock in user.window.docks.values()):
        for dock in user.window.docks.values():
            dock.hide()
        settle()  # one that had no room among the others comes back
    graph = user.window.show_view("graph")
    assert isinstance(graph, GraphView)
    settle()
    for name in list(graph.selection.quantities):
        tick(graph, name, False)
    return graph


@pytest.fixture
def alone(open_user: Open) -> User:
    """A window whose status line counts nothing by itself, so that what is seen is the view's own doing."""
    user = open_user()
    empty(user)
    user.window.session.stages_on_screen = tuple
    return user


SINGLE = [name for name, row in VIEWS.items() if not row.task]
"""Views that come alone: one with a task brings the docks of that task, and Find a linkage its sheet over the drawing."""


def views(user: User) -> dict[str, View]:
    return {name: user.window.show_view(name) for name in SINGLE}


class Heard(QObject):
    """What reaches the widgets of the application: (kind of event, class of the widget), but for what is inside one."""

    def __init__(self) -> None:
        super().__init__()
        self.events: set[tuple[str, str]] = set()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() in (QEvent.Type.Paint, QEvent.Type.LayoutRequest):
            self.events.add((event.type().name, type(watched).__name__))
        return False


@pytest.mark.stress
def test_an_edit_lays_out_nothing_anew_and_paints_only_what_changes(user: User, app: QApplication) -> None:
    assert user.session.edit("loads.slider_mass_kg", 199.0, "Change mass")
    wait_for(lambda: user.window.status.findings.text() == "no findings")
    settle()
    heard = Heard()
    app.installEventFilter(heard)
    assert user.session.edit("loads.slider_mass_kg", 198.0, "Change mass")
    settle()
    app.removeEventFilter(heard)
    assert ("Paint", "NumberBox") in heard.events, "the field of the value"
    assert {name for kind, name in heard.events if kind == "LayoutRequest"} == set()
    assert not {"MainWindow", "Centre", "PlayerBar", "AngleSlider", "QTabBar", "ParametersView"} & {
        n for _, n in heard.events
    }


class Paints(QObject):
    """Number of paints of each widget of the application, by name of its class."""

    def __init__(self) -> None:
        super().__init__()
        self.counts: Counter[str] = Counter()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() == QEvent.Type.Paint:
            self.counts[type(watched.parent() if type(watched) is QWidget else watched).__name__] += 1
        return False


def test_an_edit_paints_the_mechanism_once_and_no_reason_again(user: User, app: QApplication) -> None:
    """A view that goes on showing the same reason, with the same remedies, has nothing to paint."""
    view = user.see("contact_pressure")
    assert view.in_trouble
    settle()
    paints = Paints()
    app.installEventFilter(paints)
    for rod in (846.0, 847.0):
        assert user.session.edit("follower.rod_mm", rod, "Change rod")
        settle()
    app.removeEventFilter(paints)
    assert paints.counts["Canvas"] == 2
    assert paints.counts["ReasonPage"] == 0


def test_a_key_in_a_field_refreshes_only_the_plots_that_it_changes(
    open_user: Open, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The motion does not depend on a rod, nor a force on the flywheel; the cursor still has the exact value."""
    user = open_user(size=(1920, 1080))
    plots = {name: user.see(name) for name in ("displacement", "contact_force")}
    plots["motion"] = user.motion()
    user.parameters()  # all are called first: a view called lays the docks out
    dock = user.window.docks["contact_force"]
    user.window.removeDockWidget(dock)
    user.window.addDockWidget(Qt.DockWidgetArea.BottomDockWidgetArea, dock)  # not a tab in front of the other
    dock.show()
    user.see("displacement")
    refreshed: list[View] = []
    for kind in (PlotView, SegmentsView):

        def counted(view: View, study: object, refresh: Callable[[View, object], None] = kind.refresh) -> None:
            refreshed.append(view)
            refresh(view, study)

        monkeypatch.setattr(kind, "refresh", counted)
    for path, changed in (
        ("follower.rod_mm", {"contact_force"}),
        ("shaft.flywheel_inertia_kg_m2", set()),
        ("shaft.speed_rpm", set(plots)),
        ("limits.pressure_angle_rise_deg", set(plots)),
    ):
        user.number(path).setFocus()
        visible = {name: view for name, view in plots.items() if view.on_screen()}
        refreshed.clear()
        user.press(Qt.Key.Key_Up)
        assert {name for name, view in visible.items() if view in refreshed} == changed & set(visible), path
        assert all(view.up_to_date for view in visible.values())
    assert set(visible) == set(plots)
    user.turn(36.13)
    exact = channel(user.design, "displacement_mm").values(user.session.at(user.window.player.theta))
    plot = plots["displacement"]
    assert isinstance(plot, PlotView)
    assert plot.plot.readings() == [measure(float(exact[0]), "mm")]


@pytest.mark.stress
def test_a_view_reads_the_stages_of_what_it_shows(user: User) -> None:
    shown = views(user)
    for name in PLOTS:
        assert shown[name].stages == stages_of(shown[name].quantities), name  # type: ignore[attr-defined]
    assert shown["mechanism"].stages == ("linkage", "cam", "dynamics"), "as it is drawn where forces are read"
    assert shown["polygon"].stages == ("linkage", "cam", "dynamics"), "of a cam's follower: forces"
    assert user.window.bar.stages == shown["parameters"].stages == ()
    assert {stage for view in shown.values() for stage in view.stages} <= set(STAGES)


def opened_alone(user: User, name: str, design: Design) -> View:
    """A view that alone is on the screen, asked for everything it can be asked without an edit: shown, and the cam turned."""
    empty(user)
    if lists_links(design):  # of one a graph is never empty
        user.window.show_view("laws")
        settle()
    clear_caches()
    user.session.start(design)
    settle()
    assert computed() == set(), "neither laws nor an empty graph read anything"
    view = user.window.show_view(name)
    if name == "graph" and not lists_links(design):
        assert isinstance(view, GraphView)
        tick(view, "phi")
    wait_for(lambda: view.up_to_date and not view.busy)
    user.window.player.step(1.0)
    settle()
    assert view.on_screen()
    return view


BESIDE_STAGES = {"centres": {"cam centres"}, "against_speed": {"against speed"}, "find": {"dynamics"}}
"""What a view computes that is none of its stages: Find the torque that its usual limit of the shaft asks for."""


@pytest.mark.parametrize("names", [SINGLE[::8], stressed(SINGLE)], ids=["some", "all"])
def test_each_view_alone_computes_its_stages_and_no_others(alone: User, names: list[str]) -> None:
    design = load(example("transfer_lift"))
    for name in names:
        view = opened_alone(alone, name, design)
        # a cam has no linkage of its own for those that show linkages
        wanted = set() if view.is_unavailable else closure(view.stages)
        assert computed() == wanted | BESIDE_STAGES.get(name, set()), name


LINKAGE_VIEWS = ("mechanism", "graph", "motion", "centres", "circle", "polygon", "torque")


@pytest.mark.stress
def test_each_view_alone_computes_no_more_of_a_linkage(alone: User) -> None:
    """Of one that a cam drives, which has every stage but that of the shaft."""
    design = load(example("four_bar_coupler_cam"))
    for name in LINKAGE_VIEWS:
        view = opened_alone(alone, name, design)
        assert not view.is_unavailable
        # the circle diagram is of centres alone, which are those of the linkage at any speed
        wanted = {"motion"} if name == "circle" else closure(view.stages)
        more = {"circle": {"centres"}, "centres": {"centres", "cam centres"}}
        assert computed() == wanted | more.get(name, set()), name


@pytest.mark.stress
def test_a_flexible_shaft_is_computed_for_its_own_view_alone(alone: User) -> None:
    design = load(example("kim_1990"))
    for name in ("mechanism", "torque", "parameters", "stability"):
        view = opened_alone(alone, name, design)
        assert computed() == ({"stability"} if name == "stability" else closure(view.stages)), name


def test_an_empty_graph_computes_what_is_ticked(alone: User) -> None:
    clear_caches()
    alone.session.start(alone.design)
    settle()
    graph = alone.window.view("graph")
    assert isinstance(graph, GraphView)
    for name, wanted in (("displacement", {"motion"}), ("phi", NEEDS["linkage"]), ("radius", NEEDS["cam"])):
        tick(graph, name)
        assert computed() == wanted
        assert set(graph.stages) <= wanted


EDITS = {
    "name": ("name", "Another name", set()),
    "assumed": ("assumed", frozenset({"follower.rod_mm"}), set()),
    "flywheel": ("shaft.flywheel_inertia_kg_m2", 40.0, {"flywheel"}),
    "fluctuation": ("shaft.speed_fluctuation", 0.03, {"flywheel"}),
    "speed": ("shaft.speed_rpm", 21.0, {"dynamics", "flywheel"}),
    "mass": ("loads.arm_mass_kg", 600.0, {"dynamics", "flywheel"}),
    "friction": ("loads.friction", 0.01, {"dynamics", "flywheel"}),
    "rotation": ("shaft.rotation", "cw", {"cam", "dynamics", "flywheel"}),
    "base radius": ("cam.base_radius_mm", 402.0, {"linkage", "cam", "dynamics", "flywheel"}),
    "roller": ("cam.roller_radius_mm", 149.0, {"linkage", "cam", "dynamics", "flywheel"}),
    "rod": ("follower.rod_mm", 850.0, {"linkage", "cam", "dynamics", "flywheel"}),
    "stroke": ("motion.stroke", 151.0, {*ALL, "flywheel"}),
}
"""Path, value, what it recomputes, flywheel and motor included."""


def turns() -> dict[str, int]:
    """How often each stage has been computed for a whole turn; what is asked at one cam angle is not remembered."""
    return {name: memory.computed[name] for name in (*ALL, "flywheel")}


def test_an_edit_recomputes_only_what_depends_on_it(user: User) -> None:
    for name, (path, value, wanted) in EDITS.items():
        before = turns()
        assert user.session.edit(path, value, name)
        settle()
        after = turns()
        assert {stage for stage in after if after[stage] != before[stage]} == wanted, name
        assert all(after[stage] - before[stage] <= 1 for stage in after), "no stage twice"
        user.session.stack.undo()
        settle()
        assert turns() == after, f"{name}: an earlier design computes nothing"
        user.session.end_gesture()


@pytest.mark.parametrize("name", ["torque", "camshaft_speed"])
def test_the_flywheel_follows_once_the_keys_rest(name: str, user: User) -> None:
    """Until then its curve is that of before, without a number; all others follow each key."""
    view, force = user.see(name), user.window.view("contact_force")
    assert isinstance(view, PlotView)
    box = user.number("follower.rod_mm")
    wait_for(lambda: view.up_to_date and force.up_to_date)
    wait_for(lambda: not any(isinstance(each, Worker) for each in enumerate_threads()))
    before, (*_, curve) = turns(), curves(view.plot)
    drawn = curve.y.copy()
    assert readouts(view.plot)
    for _ in range(5):
        QTest.keyClick(box, Qt.Key.Key_Up)
        view.repaint()
        assert turns()["flywheel"] == before["flywheel"]
        assert not tags(view.plot), "neither a value at the cursor nor an extreme"
        assert not cursor(view.plot).isVisible()
        assert np.array_equal(curves(view.plot)[-1].y, drawn)
        assert force.up_to_date
    assert turns()["dynamics"] == before["dynamics"] + 5
    wait_for(lambda: view.up_to_date)
    assert turns()["flywheel"] == before["flywheel"] + 1
    stepped, value = curves(view.plot)[-1].y.copy(), user.session.study.design.drive.mechanism.rod_mm
    shown = [tag.text for tag in readouts(view.plot)]
    assert cursor(view.plot).isVisible()
    user.session.stack.undo()
    settle()
    assert np.array_equal(curves(view.plot)[-1].y, drawn)
    user.enter("follower.rod_mm", f"{value}")
    assert view.up_to_date, "what is typed is shown at once"
    assert np.array_equal(curves(view.plot)[-1].y, stepped)
    assert [tag.text for tag in readouts(view.plot)] == shown


@pytest.mark.stress
def test_one_step_of_the_cam_is_computed_once_for_all_that_follow_it(user: User) -> None:
    before = evaluations.copy()
    user.window.player.step(1.0)
    settle()
    assert dict(evaluations - before) == {"motion": 1, "linkage": 1, "cam": 1, "dynamics": 1}


# -- what is hidden rests -----------------------------------------------------------------------------------


@pytest.mark.stress
def test_what_cannot_be_seen_neither_follows_nor_computes_nor_draws(
    alone: User, monkeypatch: pytest.MonkeyPatch
) -> None:
    """First where nothing but the angle is new, then after an edit."""
    shown = views(alone)
    for view in shown.values():
        view.pull()
    empty(alone)
    followed: list[str] = []
    with monkeypatch.context() as patch:
        for name, view in shown.items():
            patch.setattr(view, "follow", lambda theta, name=name: followed.append(name))
        clear_caches()
        alone.window.player.step(5.0)
        settle()
    assert followed == ["graph"]
    assert computed() == set()
    drawn: list[str] = []
    monkeypatch.setattr(CurvePlot, "set_curves", lambda plot, *_: drawn.append("curves"))
    monkeypatch.setattr(CurvePlot, "set_angle", lambda plot, *_: drawn.append("angle"))
    monkeypatch.setattr(View, "pull", lambda view: drawn.append(type(view).__name__))
    painted = Painted()
    for dock in alone.window.docks.values():
        for widget in dock.findChildren(QWidget):
            widget.installEventFilter(painted)
    clear_caches()
    assert alone.session.edit("motion.stroke", 160.0, "a")
    alone.window.player.step(1.0)
    settle()
    assert set(drawn) <= {"GraphView", "PlayerBar", "angle"}
    assert computed() <= {"motion"}, "the empty graph follows no angle"
    assert painted.widgets == []


@pytest.mark.stress
def test_a_dock_behind_another_neither_computes_nor_paints(user: User) -> None:
    user.window.show_view("velocity")
    settle()
    user.window.show_view("displacement")
    settle()
    behind, painted = user.window.view("velocity"), Painted()
    assert isinstance(behind, PlotView)
    assert behind.up_to_date
    assert behind.isVisible(), "says Qt"
    angle = behind.plot.angle
    user.window.player.step(5.0)
    settle()
    assert behind.plot.angle == angle
    for widget in [behind, *behind.findChildren(QWidget)]:
        widget.installEventFilter(painted)
    user.session.edit("motion.stroke", 160.0, "a")
    user.window.player.step(5.0)
    settle()
    assert painted.widgets == []
    assert not behind.up_to_date


@pytest.mark.stress
def test_the_motion_is_not_painted_for_an_edit_of_another_part(whole: User) -> None:
    whole.window.show_task("make")
    settle()
    view, painted = whole.window.view("motion"), Painted()
    assert isinstance(view, SegmentsView)
    assert view.on_screen()
    for plot in (view.diagram, *view.derivatives.plots):
        plot.viewport().installEventFilter(painted)
    assert whole.session.edit("follower.rod_mm", 846.0, "Rod")
    settle()
    assert painted.widgets == []
    assert view.up_to_date
    assert whole.session.edit("motion.stroke", 160.0, "Stroke")
    settle()
    assert len(painted.widgets) >= 4
    assert view.diagram.motion == whole.session.design.drive.motion


class Painted(QObject):
    """Notes which widgets have been painted."""

    def __init__(self) -> None:
        super().__init__()
        self.widgets: list[str] = []

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() == QEvent.Type.Paint:
            self.widgets.append(type(watched).__name__)
        return False
