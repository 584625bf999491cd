"""kindyna_gui.linkage.drives_mouse: what the drawing's parts are, dragged, typed, clicked and asked what can be done with them."""

import cmath
import re

import numpy as np
import pytest
from plot_reading import box_of, limits
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QContextMenuEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QWidget
from sampled import spread, stressed
from window_user import Open, User, pixel, settle, wait_for

from core.design import get
from core.study import extremes_of
from core.units import UNITS
from kindyna_gui import settings
from kindyna_gui.drives_view import DrivesView
from kindyna_gui.graph.graph_view import GraphView
from kindyna_gui.graph.live_plot import LivePlot
from kindyna_gui.graph.plots_view import PlotView
from kindyna_gui.labels import value_text
from kindyna_gui.places import example
from kindyna_gui.timing_view import TimingView

LEFT, MM = Qt.MouseButton.LeftButton, UNITS["mm"]
BASE, ROLLER = "cam.base_radius_mm", "cam.roller_radius_mm"


@pytest.fixture
def rocker(same_window: Open) -> User:
    user = same_window(example("rocker_cam"), size=(1440, 900))
    user.see("torque")
    wait_for(lambda: user.window.view("torque") is not None and user.window.view("torque").up_to_date)  # type: ignore[union-attr]
    user.drawing()
    return user


def place(user: User, thing: str) -> complex:
    """Where the mouse finds it [mm]."""
    scene = user.drawing().scene
    geometry = scene.geometry
    assert geometry is not None
    centre, pivot = complex(geometry.reference[scene.index]), geometry.handles(scene.index).get("pivot", 0j)
    return {
        "base circle": geometry.base_radius * cmath.exp(2.5j),
        "rim": centre + geometry.face_radius * cmath.exp(1.2j),
        "roller": centre + 0.5j * geometry.face_radius,
        "arm": (2.0 * centre + 3.0 * pivot) / 5.0,
        "pivot": pivot,
        "cam": -0.4j * geometry.base_radius,
    }[thing]


def hold(user: User, start: complex, *way: complex) -> None:
    """Press there and move."""
    viewport = user.drawing().canvas.viewport()
    QTest.mousePress(viewport, LEFT, pos=pixel(user.drawing().canvas, start))
    for at in way:
        QTest.mouseMove(viewport, pixel(user.drawing().canvas, at))
    settle()


def drop(user: User) -> None:
    QTest.mouseRelease(user.drawing().canvas.viewport(), LEFT, pos=QPoint(5, 5))
    settle()


def beside(user: User) -> list[tuple[str, bool]]:
    held = user.drawing().drag
    assert held is not None
    return held.lines


def test_the_base_circle_is_dragged_with_answers_beside_the_mouse(rocker: User) -> None:
    assert rocker.session.edit("limits.pressure_angle_rise_deg", 20.0, "Limit")
    settle()
    before, start = get(rocker.design, BASE), place(rocker, "base circle")
    hold(rocker, start)
    inwards = [start * part for part in (0.9, 0.7, 0.5)]
    viewport = rocker.drawing().canvas.viewport()
    for at in inwards:
        QTest.mouseMove(viewport, pixel(rocker.drawing().canvas, at))
    now = get(rocker.design, BASE)
    assert now == pytest.approx(0.5 * before, abs=0.6)
    lines = beside(rocker)
    assert lines[0] == (f"Base radius Br {now:.10g} mm", False)
    top = float(abs(rocker.session.study.cam.flank.pressure_angle).max()) * 180.0 / cmath.pi
    (pressure,) = (line for line in lines if line[0].startswith("Pressure angle"))
    assert pressure == (f"Pressure angle {top:.2f}°, limit 20.00°", top > 20.0)
    assert pressure[1], "its limit is passed"
    assert [text.split()[0] for text, _ in lines] == ["Base", "Pressure", "Pitch", "Cam", "Contact"]
    drop(rocker)
    assert rocker.steps == ["Limit", "Change base radius Br"], "one step a drag"
    rocker.choose("Edit", "Undo Change base radius Br")
    assert get(rocker.design, BASE) == before


def test_escape_takes_a_drag_back(rocker: User) -> None:
    """Of a cam whose materials are known, so that the pressure of the contact answers, too."""
    for path, value in (("cam.thickness_mm", 12.0), ("cam.material", "16mncr5"), ("cam.roller_material", "100cr6")):
        assert rocker.session.edit(path, value, "Surfaces")
    settle()
    before = rocker.design
    hold(rocker, place(rocker, "base circle"), 60.0 * cmath.exp(2.5j))
    assert rocker.design != before
    top = max(float(stress.pressure.max()) for stress in rocker.session.study.stress.values()) / 1e6
    assert (f"Contact pressure {top:.1f} MPa, limit 1500 MPa", False) in beside(rocker)
    QTest.keyClick(rocker.drawing().canvas, Qt.Key.Key_Escape)
    settle()
    assert rocker.design == before
    QTest.mouseMove(rocker.drawing().canvas.viewport(), QPoint(300, 300))
    assert rocker.design == before, "the mouse holds nothing any more"
    drop(rocker)
    assert rocker.design == before


@pytest.mark.parametrize(
    ("thing", "path"), spread([("base circle", BASE), ("rim", ROLLER), ("pivot", "follower.pivot_x_mm")], 1)
)
def test_a_value_is_typed_while_the_mouse_holds_it(rocker: User, thing: str, path: str) -> None:
    start, wanted = place(rocker, thing), round(1.1 * get(rocker.design, path), 1)
    hold(rocker, start, start + 2.0 * cmath.exp(1.2j))
    QTest.keyClicks(rocker.drawing().canvas, f"{wanted / 10.0:.2f} cm")
    QTest.keyClick(rocker.drawing().canvas, Qt.Key.Key_Return)
    settle()
    assert get(rocker.design, path) == wanted
    drop(rocker)
    assert get(rocker.design, path) == wanted
    assert len(rocker.steps) == 1


@pytest.mark.stress
def test_what_stands_beside_the_mouse_is_in_the_units_that_are_preferred(rocker: User) -> None:
    settings.choose(settings.INCH, True)
    try:
        start = place(rocker, "base circle")
        hold(rocker, start, 0.9 * start)
        base, _, pitch = (text for text, _ in beside(rocker)[:3])
        assert base == f"Base radius Br {value_text(get(rocker.design, BASE), MM)}"
        assert re.fullmatch(r"Pitch radius 2,\d+ in, undercut below 0,4724 in", pitch)
        for typed, said in (
            ("2,5 kg", "enter a number, such as 12,5"),
            ("-1", "outside its range; allowed: above 0 ... 39\u202f370\u202f100 in, not \N{MINUS SIGN}1 in"),
        ):
            QTest.keyClicks(rocker.drawing().canvas, typed)
            QTest.keyClick(rocker.drawing().canvas, Qt.Key.Key_Return)
            assert f"Base radius Br: {said}" in rocker.window.status.currentMessage()
            for _ in typed:
                QTest.keyClick(rocker.drawing().canvas, Qt.Key.Key_Backspace)
        QTest.keyClicks(rocker.drawing().canvas, "1,75")
        QTest.keyClick(rocker.drawing().canvas, Qt.Key.Key_Return)
        drop(rocker)
        assert (get(rocker.design, BASE), rocker.steps) == (44.45, ["Change base radius Br"])
    finally:
        settings.choose({}, False)


def test_the_roller_grows_under_the_mouse(rocker: User) -> None:
    """By what the mouse goes outwards, though its centre moves away from the cam meanwhile."""
    before, start = get(rocker.design, ROLLER), place(rocker, "rim")
    step = 1.0 * cmath.exp(1.2j)
    hold(rocker, start, start + step, start + 2.0 * step, start + 3.0 * step)
    assert get(rocker.design, ROLLER) == pytest.approx(before + 3.0, abs=0.4)
    drop(rocker)
    hold(rocker, place(rocker, "rim"), place(rocker, "roller") - 0.5j * get(rocker.design, ROLLER))
    assert get(rocker.design, ROLLER) > 0.0
    drop(rocker)


@pytest.mark.parametrize(
    ("thing", "path"),
    spread([("cam", BASE), ("roller", ROLLER), ("arm", "follower.arm_mm")], 1),
)
def test_a_click_opens_the_fields_of_what_is_drawn(rocker: User, thing: str, path: str) -> None:
    QTest.mouseClick(rocker.drawing().canvas.viewport(), LEFT, pos=pixel(rocker.drawing().canvas, place(rocker, thing)))
    settle()
    field = rocker.parameters().field(path)
    assert field is not None
    assert field.editor is QApplication.focusWidget() or field.editor.isAncestorOf(QApplication.focusWidget())


def menu_at(view: QWidget, widget: QWidget, spot: QPoint) -> QMenu:
    """The menu that a right click on a widget of a view opens."""
    ask = QContextMenuEvent(QContextMenuEvent.Reason.Mouse, spot, widget.mapToGlobal(spot))
    QApplication.sendEvent(widget, ask)
    settle()
    (menu,) = (menu for menu in view.findChildren(QMenu) if menu.isVisible())
    return menu


def menu_of(user: User, at: complex) -> QMenu:
    canvas = user.drawing().canvas
    return menu_at(user.drawing(), canvas.viewport(), pixel(canvas, at))


def texts(menu: QMenu) -> list[str]:
    return [action.text() for action in menu.actions() if not action.isSeparator()]


@pytest.mark.parametrize(
    ("thing", "entries"),
    [
        ("cam", ["Edit Base radius Br", "Find Base radius Br...", "Vary Base radius Br", "Explain pitch curvature here",
                 "Copy 45 mm", "Export profile...", "Copy picture", "Fit"]),
        stressed("arm", ["Edit Arm", "Find Arm...", "Vary Arm", "Copy 90 mm", "Copy picture", "Fit"]),
        stressed("pivot", ["Edit Pivot x", "Vary Pivot x", "Explain pressure angle here", "Copy 95 mm", "Copy picture", "Fit"]),
    ],
)  # fmt: skip
def test_what_is_drawn_has_a_menu_of_what_can_be_done_with_it(rocker: User, thing: str, entries: list[str]) -> None:
    menu = menu_of(rocker, place(rocker, thing))
    actions = menu.actions()
    assert texts(menu) == entries
    copy = next(action for action in actions if action.text().startswith("Copy ") and "picture" not in action.text())
    copy.trigger()
    assert f"Copy {QApplication.clipboard().text()}" == copy.text()
    find = [action for action in actions if action.text().startswith("Find")]
    for action in find:
        action.trigger()
        settle()
        assert rocker.window.docks["find"].isVisible()
    menu.close()


@pytest.mark.stress
def test_a_plot_has_the_same_menu_before_its_own_entries(rocker: User) -> None:
    view = rocker.see("pressure_angle")
    assert isinstance(view, PlotView)
    menu = menu_at(view, view.plot.viewport(), view.plot.viewport().rect().center())
    value = view.plot.readings()[0]
    assert texts(menu)[:5] == [
        "Edit Base radius Br", "Find Base radius Br...", "Vary Base radius Br", f"Copy {value}", "Copy picture",
    ]  # fmt: skip
    assert {"Explain this value", "Export picture...", "Export numbers..."} <= set(texts(menu))
    menu.actions()[1].trigger()
    settle()
    field = rocker.parameters().field(BASE)
    assert field is not None
    assert field.editor is QApplication.focusWidget() or field.editor.isAncestorOf(QApplication.focusWidget())
    menu.close()
    graph = rocker.see("graph")
    assert isinstance(graph, GraphView)
    plot = graph.panels[0].plot
    assert isinstance(plot, LivePlot)
    menu = menu_at(graph, plot.viewport(), plot.viewport().rect().center())
    assert texts(menu)[:4] == [
        "Edit Segment 2, span",
        "Find Segment 2, span...",
        "Vary Segment 2, span",
        f"Copy {plot.readings()[0]}",
    ]
    menu.close()


def peak_of(user: User) -> tuple[PlotView, QPoint, float]:
    """The plot of the pressure angle, where its highest value is marked, and that value [deg]."""
    view = user.see("pressure_angle")
    assert isinstance(view, PlotView)
    wait_for(lambda: len(view.plot.marked()) == 2)
    highest = view.plot.marked()[1]
    place = view.plot.getViewBox().mapViewToScene(QPointF(highest.angle, highest.value))
    return view, view.plot.mapFromScene(place), highest.value


def highest(user: User) -> float:
    return float(np.rad2deg(user.session.study.cam.flank.pressure_angle.max()))


@pytest.mark.stress
def test_a_peak_of_the_pressure_angle_is_drawn_and_the_base_radius_follows(rocker: User) -> None:
    assert rocker.session.edit("limits.pressure_angle_rise_deg", 34.0, "Limit")
    before = rocker.design
    view, at, value = peak_of(rocker)
    plot, viewport = view.plot, view.plot.viewport()
    pixel_of = np.ptp(plot.getViewBox().viewRange()[1]) / plot.getViewBox().height()
    QTest.mousePress(viewport, LEFT, pos=at)
    for down in (2, 5, 9):
        QTest.mouseMove(viewport, at - QPoint(0, down))
        settle()
        assert highest(rocker) == pytest.approx(value + down * pixel_of, abs=0.05), "the peak is where the mouse is"
    assert get(rocker.design, BASE) != get(before, BASE)
    held = plot.peaks
    assert held is not None
    assert held.lines[0] == (f"Base radius Br {get(rocker.design, BASE):.10g} mm", False)
    top = highest(rocker)
    assert (f"Pressure angle {top:.2f}°, limit 34.00°", top > 34.0) in held.lines
    QTest.mouseRelease(viewport, LEFT, pos=at)
    settle()
    assert rocker.steps == ["Limit", "Change base radius Br"], "one step a drag"
    rocker.choose("Edit", "Undo Change base radius Br")
    assert rocker.design == before

    view, at, value = peak_of(rocker)
    QTest.mousePress(viewport, LEFT, pos=at)
    QTest.mouseMove(viewport, at - QPoint(0, 9))
    assert rocker.design != before
    QTest.mouseMove(viewport, at + QPoint(0, 2000))
    assert held.lines[-1][1], "no base radius gives this"
    assert "No base radius Br gives" in held.lines[-1][0]
    QTest.keyClick(plot, Qt.Key.Key_Escape)
    settle()
    assert rocker.design == before
    QTest.mouseRelease(viewport, LEFT, pos=at)

    view, at, value = peak_of(rocker)
    QTest.mousePress(viewport, LEFT, pos=at)
    QTest.keyClicks(plot, "33.5")
    QTest.keyClick(plot, Qt.Key.Key_Return)
    QTest.mouseRelease(viewport, LEFT, pos=at)
    settle()
    exact = extremes_of(rocker.session.study, "cam", ("pressure_angle",))["pressure_angle"].high.value
    assert np.deg2rad(33.5) * (1.0 - 1e-8) < exact <= np.deg2rad(33.5) * (1.0 + 1e-12), (
        "what is typed, from the safe side"
    )
    assert rocker.steps == ["Limit", "Change base radius Br"]


def test_a_click_on_a_limit_in_a_plot_opens_its_field(rocker: User) -> None:
    assert rocker.session.edit("limits.pressure_angle_return_deg", 38.0, "Limit")
    view = rocker.see("pressure_angle")
    assert isinstance(view, PlotView)
    for text, path in (
        ("typical limit", "limits.pressure_angle_rise_deg"),
        ("limit of", "limits.pressure_angle_return_deg"),
    ):
        tag = next(each for each in limits(view.plot) if each.text.startswith(text))
        at = view.plot.mapFromScene(box_of(tag).center())
        QTest.mouseMove(view.plot.viewport(), at)
        assert view.plot.viewport().cursor().shape() == Qt.CursorShape.PointingHandCursor
        before = rocker.window.player.theta
        QTest.mouseClick(view.plot.viewport(), LEFT, pos=at)
        settle()
        assert rocker.window.player.theta == before, "the cam stays where it is"
        field = rocker.parameters().field(path)
        assert field is not None
        assert field.editor.hasFocus() or field.editor.isAncestorOf(QApplication.focusWidget())


@pytest.mark.stress
def test_bars_and_points_of_the_timing_have_a_menu(open_user: Open) -> None:
    user = open_user(example("transfer_unit"), size=(1440, 900))
    view = user.see("timing")
    assert isinstance(view, TimingView)
    canvas, chart = view.canvas, view.canvas.chart
    band = next(
        QPoint(x, y) for y in range(0, chart.height, 4) for x in range(canvas.width() // 3, canvas.width(), 9)
        if canvas.path_at(QPointF(x, y)) == "drives[1].phase_deg"
    )  # fmt: skip
    menu = menu_at(view, canvas, band)
    assert texts(menu) == [
        "Edit Phase", "Find Phase...", "Vary Phase", "Copy 238°", "Copy picture",
    ]  # fmt: skip
    menu.actions()[1].trigger()
    settle()
    assert user.session.chosen == 1
    drives = user.window.view("drives")
    assert isinstance(drives, DrivesView)
    assert drives.isAncestorOf(QApplication.focusWidget())
    menu.close()
    menu = menu_at(view, canvas, chart.join_position(2, 1).toPoint())
    assert texts(menu)[0] == "Edit Lift: Segment 1, span"
    menu.actions()[1].trigger()
    settle()
    assert user.session.chosen == 2
    field = user.parameters().field("motion.segments[0].span_deg")
    assert field is not None
    assert field.editor.isAncestorOf(QApplication.focusWidget()) or field.editor.hasFocus()
    menu.close()
