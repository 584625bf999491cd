"""Study: numbers chosen in the forms by the mouse, the design drawn over their map, taken over, kept; nothing computed unseen."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linkages import geared
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QAction, QContextMenuEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QWidget
from window_user import Open, User, plain, settle, wait_for

from core.design import Tolerance, edited, get
from core.design.limits import Waviness
from core.number_text import NARROW_SPACE
from core.process import user_folder
from core.project import save
from core.study import evaluations
from core.varying import current_figures, load_study
from kindyna_gui.documents.pins import Pins
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.graph.curves_view import CurvesView
from kindyna_gui.help import HelpWindow
from kindyna_gui.motion.segments_table import LAW, RISE
from kindyna_gui.pictures.style import LIGHT
from kindyna_gui.places import example
from kindyna_gui.studies.plots import SurveyPlot
from kindyna_gui.studies.study_view import StudyView

X, Y, BASE = "follower.pivot_x_mm", "follower.pivot_y_mm", "cam.base_radius_mm"
TEETH = "linkage.drivers[0].teeth_second"
FORCE = "contact_force_n:abs"
PRESSURE, TORQUE = "pressure_angle_deg:abs", "drive_torque_nm:abs"


def menu_of(widget: QWidget) -> QMenu:
    """What opens at a right click."""
    at = widget.rect().center()
    QApplication.sendEvent(widget, QContextMenuEvent(QContextMenuEvent.Reason.Mouse, at, widget.mapToGlobal(at)))
    menu = QApplication.activePopupWidget()
    assert isinstance(menu, QMenu)
    return menu


def vary(user: User, path: str, part: Callable[[object], QWidget] = lambda field: field.label) -> StudyView:  # type: ignore[attr-defined]
    """Right click on the field's name, or on its number, then *Vary this*."""
    menu = menu_of(part(user.field(path)))
    entry: QAction = next(each for each in menu.actions() if plain(each.text()) == "Vary this")
    entry.trigger()
    menu.close()
    settle()
    return rested(user)


def rested(user: User) -> StudyView:
    view = user.window.view("study")
    assert isinstance(view, StudyView)
    wait_for(lambda: view.on_screen() and view.up_to_date and not view.busy)
    return view


def ask_alone(view: StudyView, key: str) -> None:
    """Take all that is asked away but this: what nobody reads takes time."""
    for each in list(view.request.figures):
        if each != key:
            QTest.mouseClick(view.figure_rows.removers[each], Qt.MouseButton.LeftButton)
            settle()


def type_into(box: NumberBox, text: str) -> None:
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, text)
    QTest.keyClick(box, Qt.Key.Key_Return)
    settle()


def bound(user: User, view: StudyView, path: str, low: str, high: str) -> None:
    type_into(view.rows.boxes[path, "low"], low)
    type_into(view.rows.boxes[path, "high"], high)
    rested(user)


def press(plot: SurveyPlot, at: tuple[float, float]) -> None:
    QTest.mousePress(plot.viewport(), Qt.MouseButton.LeftButton, pos=pixel(plot, at))


def pixel(plot: SurveyPlot, at: tuple[float, float]) -> QPoint:
    return plot.pixel(*at).toPoint()


def move(plot: SurveyPlot, at: tuple[float, float]) -> None:
    QTest.mouseMove(plot.viewport(), pixel(plot, at))
    settle()


def let_go(plot: SurveyPlot, at: tuple[float, float]) -> None:
    QTest.mouseRelease(plot.viewport(), Qt.MouseButton.LeftButton, pos=pixel(plot, at))
    settle()


@pytest.fixture
def user(open_user: Open) -> User:
    return open_user(example("transfer_lift"), whole=True, size=(1440, 900))


def pivot(user: User) -> tuple[float, float]:
    return get(user.design, X), get(user.design, Y)


@pytest.mark.stress
def test_f1_opens_the_page_on_studies(user: User) -> None:
    user.window.show_task("study")
    view = user.window.view("study")
    assert isinstance(view, StudyView)
    view.open.setFocus()
    user.press(Qt.Key.Key_F1)
    pages = user.window.findChild(HelpWindow)
    wait_for(pages.isVisible)
    assert "An example with the lift" in pages.text.toPlainText()
    pages.close()


@pytest.mark.stress
def test_teeth_are_varied_by_right_click_and_stand_as_steps(open_user: Open, tmp_path: Path) -> None:
    save(geared(kind="gear", teeth_first=18, teeth_second=12, module_mm=4.0), tmp_path / "geared.toml")
    user = open_user(tmp_path / "geared.toml", whole=True, size=(1280, 720))
    view = vary(user, TEETH)
    assert (view.request.spans[TEETH].low, view.request.spans[TEETH].high) == (7, 17)
    assert (TEETH, "width") not in view.rows.boxes, "no tolerance of a count"
    bound(user, view, TEETH, "10", "14")
    plot = view.pages.curves[0]
    x, y = plot.lines[0]
    assert [len(set(y[np.abs(x - count) < 0.45])) for count in (11, 12, 13)] == [1, 1, 1], "level about each count"
    assert len(set(y)) > 2
    height = 0.5 * sum(plot.getViewBox().viewRange()[1])
    press(plot, (12.0, height))
    move(plot, (13.3, height))
    let_go(plot, (13.3, height))
    assert get(user.design, TEETH) == 13
    assert plot.design_point is not None
    assert plot.design_point[0] == 13.0, "the line goes to what can be made"
    type_into(view.rows.boxes[TEETH, "low"], "10.5")
    assert view.rows.boxes[TEETH, "low"].text() == "10.5", "unfinished input stays"
    assert view.request.spans[TEETH].low == 10
    assert "must be a whole number; allowed: 0 ... 100\u202f000" in view.rows.message.text()


@pytest.mark.stress
def test_two_fields_by_right_click_then_the_cross_is_drawn_through_what_cannot_be_built_and_back(user: User) -> None:
    before = user.design
    view = vary(user, X)
    assert user.window.layouts.current == "study", "the task comes to the front"
    assert [plot.isVisible() for plot in view.pages.curves] == [True, True, True, False], "one number: curves"
    vary(user, Y, lambda field: field.editor.lineEdit())  # type: ignore[attr-defined]
    assert view.map.isVisible()
    bound(user, view, X, "300", "1600")
    bound(user, view, Y, "-600", "600")
    type_into(view.figure_rows.boxes[PRESSURE, "most"], "30")
    type_into(view.figure_rows.boxes[TORQUE, "most"], "7700")
    rested(user)
    assert {"Pressure angle 30°", "Cam torque 7700 N·m"} <= set(view.map.texts), "limits as lines with their value"
    assert view.map.design_point == pivot(user)
    assert view.surveys.survey.count == 64  # type: ignore[union-attr]
    assert view.surveys.survey.is_refined, "finer where limits run"  # type: ignore[union-attr]
    # all values where the mouse is, or why there is none
    move(view.map, (1500.0, 100.0))
    assert "cannot be assembled" in view.tip.text()
    move(view.map, (800.0, 0.0))
    assert view.tip.isVisible()
    assert [line.partition(" ")[0] for line in view.tip.text().splitlines()] == [
        "Pivot",
        "Pivot",
        "Pressure",
        "Cam",
        "Contact",
    ]
    # the design follows, stays the last good one where nothing can be built, and follows again
    press(view.map, pivot(user))
    move(view.map, (900.0, -60.0))
    near = pivot(user)
    assert near == pytest.approx((900.0, -60.0), abs=8.0)
    wait_for(lambda: user.window.view("mechanism").up_to_date)  # type: ignore[union-attr]
    move(view.map, (1500.0, 100.0))
    assert pivot(user) == near, "the last good design stays"
    assert "the roller cannot reach the base circle" in view.message.text()
    move(view.map, (760.0, 80.0))
    there = pivot(user)
    assert there == pytest.approx((760.0, 80.0), abs=8.0)
    let_go(view.map, (760.0, 80.0))
    assert user.steps == ["Vary pivot x and pivot y"], "one gesture, one step"
    assert view.map.design_point == there
    user.choose("Edit", "Undo Vary pivot x and pivot y")
    assert user.design == before
    assert rested(user).map.design_point == pivot(user)
    # a click takes over, Escape takes a drag back
    QTest.mouseClick(view.map.viewport(), Qt.MouseButton.LeftButton, pos=pixel(view.map, (850.0, -150.0)))
    settle()
    taken = pivot(user)
    assert taken == pytest.approx((850.0, -150.0), abs=8.0)
    press(view.map, taken)
    move(view.map, (700.0, 0.0))
    view.map.setFocus()
    QTest.keyClick(view.map, Qt.Key.Key_Escape)
    settle()
    assert pivot(user) == taken
    assert user.steps == ["Vary pivot x and pivot y"]
    let_go(view.map, (700.0, 0.0))


@pytest.mark.stress
def test_the_map_is_computed_anew_for_other_numbers_only_and_never_while_it_is_hidden(user: User) -> None:
    view = vary(user, X)
    vary(user, Y)
    first, counted = view.surveys.survey, evaluations["many"]
    press(view.map, pivot(user))
    for at in ((880.0, -60.0), (890.0, -50.0), (870.0, -70.0)):
        move(view.map, at)
    let_go(view.map, (870.0, -70.0))
    rested(user)
    assert pivot(user) == pytest.approx((870.0, -70.0), abs=2.0)
    assert view.surveys.survey is first, "the map does not depend on where the design stands in it"
    assert evaluations["many"] == counted
    user.session.put(edited(user.design, BASE, 430.0), "Base radius")
    rested(user)
    assert view.surveys.survey is not first
    assert evaluations["many"] == counted + 16 * 16 + view.surveys.survey.reason.size, (
        "coarse, then fine, then finer where limits run"
    )  # type: ignore[union-attr]
    user.window.show_task("kine")
    wait_for(lambda: not view.on_screen())
    counted = evaluations["many"]
    user.session.put(edited(user.design, BASE, 440.0), "Base radius")
    for _ in range(5):
        QTest.qWait(2)
        settle()
    assert not view.busy
    assert evaluations["many"] == counted, "nothing is computed that nobody sees"
    user.window.show_task("study")
    rested(user)
    assert evaluations["many"] == counted + 16 * 16 + view.surveys.survey.reason.size  # type: ignore[union-attr]


def test_one_number_is_drawn_along_its_curves(user: User) -> None:
    view = vary(user, BASE)
    plot = view.pages.curves[0]
    x, y = plot.lines[0]
    assert (x[0], x[-1], x.size) == (320.0, 480.0, 129)
    assert [rule.text for rule in plot.rules] == ["45°"]
    middle = 0.5 * (y.min() + y.max())
    press(plot, (get(user.design, BASE), middle))
    move(plot, (450.0, middle))
    let_go(plot, (450.0, middle))
    assert get(user.design, BASE) == pytest.approx(450.0, abs=2.0)
    assert user.steps == ["Vary base radius Br"]
    rested(user)
    assert view.figure_rows.values[PRESSURE].text().startswith(f"{y[abs(x - 450.0).argmin()]:.1f}"[:3])


@pytest.mark.stress
def test_more_numbers_are_brushed_and_a_line_taken_over(user: User) -> None:
    view = vary(user, X)
    for path in (Y, BASE):
        vary(user, path)
    plot = view.pages.parallel
    assert plot.isVisible()
    every = plot.selected.size
    place = plot.viewport()
    start, end = (plot.pixel(2, value).toPoint() for value in (330.0, 360.0))
    QTest.mousePress(place, Qt.MouseButton.LeftButton, pos=start)
    QTest.mouseMove(place, end)
    QTest.mouseRelease(place, Qt.MouseButton.LeftButton, pos=end)
    settle()
    radii = view.surveys.survey.points[2, plot.selected]  # type: ignore[union-attr]
    assert 0 < radii.size < 0.5 * every
    assert 328.0 <= radii.min() < radii.max() <= 362.0
    assert f"{radii.size} of 1024 designs selected" in plot.legend.text
    number = int(plot.selected[0])
    values = view.surveys.survey.points[:, number]  # type: ignore[union-attr]
    middle = 0.5 * (plot.pixel(0, values[0]) + plot.pixel(1, values[1]))
    QTest.mouseClick(place, Qt.MouseButton.LeftButton, pos=QPointF(middle).toPoint())
    settle()
    assert 328.0 <= get(user.design, BASE) <= 362.0, "of the designs that are kept"
    assert user.steps == ["Vary 3 numbers"]
    QTest.mouseClick(place, Qt.MouseButton.LeftButton, pos=start)
    settle()
    assert plot.selected.size == every, "a click on the axis takes its brush away"


def test_designs_are_kept_as_cards_sorted_and_reopened(user: User) -> None:
    view = vary(user, BASE)
    for radius in (400.0, 460.0, 340.0):
        user.session.put(edited(user.design, BASE, radius), "Base radius")
        rested(user)
        QTest.mouseClick(view.board.keep, Qt.MouseButton.LeftButton)
        settle()
    cards = view.board.list
    radii = lambda: [cards.item(i).text().splitlines()[0] for i in range(cards.count())]  # noqa: E731
    assert radii() == ["Base radius Br 400 mm", "Base radius Br 460 mm", "Base radius Br 340 mm"]
    assert "Pressure angle 17.605°" in cards.item(0).text()
    assert not cards.item(0).icon().isNull()
    row = view.board.sort.findText("by Base radius Br")
    view.board.sort.setFocus()
    for _ in range(row):
        QTest.keyClick(view.board.sort, Qt.Key.Key_Down)
    settle()
    assert radii() == ["Base radius Br 340 mm", "Base radius Br 400 mm", "Base radius Br 460 mm"]
    place = cards.visualItemRect(cards.item(1)).center()
    QTest.mouseClick(cards.viewport(), Qt.MouseButton.LeftButton, pos=place)
    QTest.mouseDClick(cards.viewport(), Qt.MouseButton.LeftButton, pos=place)
    settle()
    assert get(user.design, BASE) == 400.0
    assert user.steps[-1] == "Reopen a card"
    QTest.keyClick(cards, Qt.Key.Key_Delete)
    settle()
    assert radii() == ["Base radius Br 340 mm", "Base radius Br 460 mm"]
    cards.setCurrentRow(1)
    next(each for each in cards.actions() if each.text() == "Pin this variant").trigger()
    pinned = Pins.of(user.session).front
    assert pinned is not None
    assert (get(pinned.design, BASE), get(user.design, BASE)) == (460.0, 400.0)
    QTest.mouseClick(view.board.compare, Qt.MouseButton.LeftButton)
    rested(user)
    table = view.board.table
    assert table.isVisible()
    column = next(i for i in range(table.columnCount()) if table.horizontalHeaderItem(i).text() == "Base radius Br")
    assert [table.item(row, column).text() for row in range(3)] == ["400 mm", "340 mm (−60)", "460 mm (+60)"]


@pytest.mark.stress
def test_the_board_is_there_again_when_the_design_is_opened_again(open_user: Open, tmp_path: Path) -> None:
    own = tmp_path / "lift.toml"
    own.write_bytes(example("transfer_lift").read_bytes())
    user = open_user(own, whole=True, size=(1280, 720))
    view = vary(user, BASE)
    ask_alone(view, PRESSURE)
    QTest.mouseClick(view.board.keep, Qt.MouseButton.LeftButton)
    settle()
    card = view.board.list.item(0).text()
    user.session.put(edited(user.design, BASE, 410.0), "Base radius")
    user.session.save(tmp_path / "wider.toml")
    for name in ("lift.toml", "wider.toml"):
        again = open_user(tmp_path / name, whole=True, size=(1280, 720))
        again.window.show_task("study")
        board = rested(again).board
        assert [board.list.item(i).text() for i in range(board.list.count())] == [card], (
            "saved as another it takes them along"
        )
        assert get(board.cards[0].design, BASE) == 400.0
    QTest.keyClick(board.list, Qt.Key.Key_Delete)
    board.list.setCurrentRow(0)
    QTest.keyClick(board.list, Qt.Key.Key_Delete)
    again.session.open(tmp_path / "lift.toml")
    settle()
    assert len(rested(again).board.cards) == 1
    again.session.open(tmp_path / "wider.toml")
    settle()
    assert rested(again).board.cards == [], "what was taken away stays away"
    (kept,) = (each for each in (user_folder("state") / "boards").iterdir() if "lift.toml" in each.read_text("utf-8"))
    kept.write_text('{"cards": [{"design": "no design"}]}', "utf-8")
    again.session.open(tmp_path / "lift.toml")
    settle()
    assert rested(again).board.cards == [], "what cannot be read is left alone"


def test_what_is_typed_wrong_stays_and_says_what_is_allowed(user: User) -> None:
    view = vary(user, BASE)
    survey = view.surveys.survey
    for end, text, says in (
        ("low", "500", "bounds are reversed; allowed: below 480 mm, not 500 mm"),
        (
            "low",
            "-3",
            f"outside its range; allowed: above 0 ... 1{NARROW_SPACE}000{NARROW_SPACE}000{NARROW_SPACE}000 mm, not −3 mm",
        ),
        ("high", "many", "enter a number"),
    ):
        box = view.rows.boxes[BASE, end]
        type_into(box, text)
        assert box.is_refused
        assert says in view.rows.message.text()
        QTest.keyClick(box, Qt.Key.Key_Escape)
    assert rested(user).surveys.survey is survey
    type_into(view.figure_rows.boxes[PRESSURE, "least"], "60")
    message, most = view.figure_rows.message, view.figure_rows.boxes[PRESSURE, "most"].text()
    assert f"limits are reversed; allowed: ≤ {most}°, not 60°" in message.text()
    QTest.mouseClick(message.buttons[f"Use {most}°"], Qt.MouseButton.LeftButton)
    assert (view.figure_rows.boxes[PRESSURE, "least"].text(), message.isVisible()) == (most, False)
    QTest.mouseClick(view.rows.removers[BASE], Qt.MouseButton.LeftButton)
    settle()
    assert "Vary this" in view.map.message


@pytest.mark.stress
def test_the_share_of_machines_within_the_limits_stands_in_the_same_dock(user: User) -> None:
    view = vary(user, X)
    ask_alone(view, PRESSURE)
    vary(user, Y)
    type_into(view.figure_rows.boxes[PRESSURE, "most"], "30")
    assert "Enter a tolerance" in view.share.text()
    for path in (X, Y):
        type_into(view.rows.boxes[path, "width"], "0.05")
    rested(user)
    assert view.share.text().startswith("<b>100.00 % of 2000 machines keep the limits</b> (99.81 … 100.00 %)")
    assert "Worst case: pressure angle 17.6" in view.share.text()
    user.session.put(edited(user.design, X, 968.0), "Pivot")
    rested(user)
    tight = get_pressure(view)
    type_into(view.figure_rows.boxes[PRESSURE, "most"], f"{tight:.6f}")
    rested(user)
    assert 40.0 < float(view.share.text()[3:].partition(" ")[0]) < 60.0, "the limit lies at the nominal value"
    assert LIGHT.limit in view.share.text()
    assert user.design.tolerances == (Tolerance(X, 0.05), Tolerance(Y, 0.05)), "the design keeps them"
    assert user.steps[:2] == ["Tolerance of pivot x", "Tolerance of pivot y"]
    type_into(view.rows.boxes[X, "width"], "-1")
    assert view.rows.boxes[X, "width"].is_refused


def get_pressure(view: StudyView) -> float:
    """What stands beside the name, more exactly."""
    return current_figures(view.session.full_study, [PRESSURE])[0][PRESSURE]


def test_a_study_is_saved_for_the_commands(open_user: Open, tmp_path: Path) -> None:
    own = tmp_path / "lift.toml"
    own.write_bytes(example("transfer_lift").read_bytes())
    user = open_user(own, whole=True, size=(1440, 900))
    view = vary(user, X)
    type_into(view.figure_rows.boxes[PRESSURE, "most"], "30")
    suggested = user.picks("study_to_save", tmp_path / "pivot.toml")
    QTest.mouseClick(view.save, Qt.MouseButton.LeftButton)
    settle()
    assert suggested == [tmp_path / "lift_study.toml"]
    study = load_study(tmp_path / "pivot.toml")
    assert study.base == user.design
    assert [(row.field, row.low, row.high) for row in study.file.vary] == [(X, 700.0, 1050.0)]
    assert [row.key for row in study.file.quantities] == list(view.request.figures)
    assert [(row.key, row.max) for row in study.file.limits] == [(PRESSURE, 30.0)]


@pytest.mark.stress
def test_right_clicks_and_a_drag_lead_to_the_share_of_machines_in_twelve_actions(user: User) -> None:
    actions = 0

    def did(count: int) -> None:
        nonlocal actions
        actions += count

    vary(user, X)
    did(2)  # right click, Vary this
    view = vary(user, Y)
    did(2)
    type_into(view.figure_rows.boxes[PRESSURE, "most"], "30")
    did(1)
    type_into(view.figure_rows.boxes[TORQUE, "most"], "7550")
    did(1)
    rested(user)
    assert {"Pressure angle 30°", "Cam torque 7550 N·m"} <= set(view.map.texts)
    shown, before = user.drawing().canvas.grab().toImage(), pivot(user)
    press(view.map, before)
    move(view.map, (840.0, -60.0))
    assert user.drawing().canvas.grab().toImage() != shown, "the drawing follows while the cross is drawn"
    move(view.map, (860.0, -70.0))
    let_go(view.map, (860.0, -70.0))
    did(1)
    assert pivot(user) == pytest.approx((860.0, -70.0), abs=2.0)
    assert user.steps == ["Vary pivot x and pivot y"]
    for path in (X, Y):
        type_into(view.rows.boxes[path, "width"], "0.05")
        did(1)
    rested(user)
    assert view.share.text().startswith("<b>100.00 % of 2000 machines keep the limits</b> (99.81 … 100.00 %)")
    assert actions <= 12


@pytest.mark.stress
def test_a_cell_of_the_motion_and_a_word_are_varied_by_right_click(user: User) -> None:
    motion = user.motion()
    user.see("motion")
    for column in (RISE, LAW):
        cell = motion.table.visualRect(motion.model.index(1, column)).center()
        motion.table.customContextMenuRequested.emit(cell)
        menu = QApplication.activePopupWidget()
        assert isinstance(menu, QMenu)
        next(each for each in menu.actions() if plain(each.text()) == "Vary this").trigger()
        menu.close()
        settle()
        view = rested(user)
        user.see("motion")
    assert list(view.request.spans) == ["motion.segments[1].rise_mm"]
    law = "motion.segments[1].law"
    assert view.request.words[law] == ("cycloidal", "modified-sine", "modified-trapezoid", "3-4-5", "4-5-6-7")
    user.window.show_task("kine")
    layout = user.field("follower.face").editor
    assert "Vary this" in [plain(each.text()) for each in menu_of(layout).actions()]


@pytest.mark.stress
def test_bands_of_machines_are_shaded_in_the_plots_once_they_are_asked_for(user: User) -> None:
    view = vary(user, X)
    ask_alone(view, PRESSURE)
    type_into(view.rows.boxes[X, "width"], "8")
    plot = user.see("pressure_angle").plot  # type: ignore[attr-defined]
    rested(user)
    assert plot.bands == [], "nobody has asked"
    QTest.mouseClick(view.tabs.tabBar(), Qt.MouseButton.LeftButton, pos=view.tabs.tabBar().tabRect(1).center())
    QTest.mouseClick(
        view.tolerances.bands, Qt.MouseButton.LeftButton, pos=QPoint(8, view.tolerances.bands.height() // 2)
    )
    wait_for(lambda: not view.bands.busy)
    (band,) = plot.bands
    study = user.session.study
    own = np.rad2deg(study.at(study.program.angles(np.deg2rad(np.arange(360)))).cam.flanks[0].pressure_angle)
    assert (band[0] <= own + 1e-9).all()
    assert (own <= band[4] + 1e-9).all()
    assert np.ptp(band[:, 60]) == pytest.approx(6.0 * np.ptp(band[1:4, 60]) / (2 * 1.645), rel=0.2), (
        "nearly a normal one"
    )
    assert "Pivot x" in view.tolerances.parts.text()
    graph = user.see("curves")
    assert isinstance(graph, CurvesView)
    graph.show_channel("pressure_angle")
    at = next(i for i, each in enumerate(graph.data.series) if each.y_label == "Pressure angle")
    wait_for(lambda: at in graph.plot.bands)
    x, shaded = graph.plot.bands[at]
    assert (x[0], x[-1]) == (0.0, 360.0)
    np.testing.assert_array_equal(shaded[:, :-1], band)
    low, high = graph.plot.shown.values[graph.plot.axis_of(at)]
    assert low < band.min() <= band.max() < high, "all of it is in sight"
    shown = user.window.view("pressure_angle")
    with_bands = [each.picture(".svg") for each in (shown, graph)]
    diagram = user.motion().diagram
    user.session.put(replace(user.design, waviness=Waviness(amplitude_mm=0.5, lobes_from=5, lobes_to=9)), "Waves")
    wait_for(lambda: len(diagram.bands) == 1 and not view.bands.busy)
    (heights,) = diagram.bands
    study = user.session.study
    lift = study.at(study.program.angles(np.deg2rad(np.arange(360)))).motion.displacement[0]
    assert np.abs(heights[2] - 1e3 * lift).max() < 0.2, "mm"
    assert (heights[4] - heights[0] > 0.5).all()
    user.see("study")
    user.see("pressure_angle")
    user.session.put(edited(user.design, BASE, 430.0), "Base radius")
    settle()
    assert plot.bands == [], "those of another design are gone"
    wait_for(lambda: len(plot.bands) == 1 and not view.bands.busy)
    QTest.mouseClick(
        view.tolerances.bands, Qt.MouseButton.LeftButton, pos=QPoint(8, view.tolerances.bands.height() // 2)
    )
    settle()
    assert plot.bands == []
    user.see("curves")
    for each, picture in zip((shown, graph), with_bands, strict=True):
        assert picture.count(b"<path") > each.picture(".svg").count(b"<path"), "shaded on paper, too"


@pytest.mark.stress
def test_which_tolerance_to_tighten_is_told_where_too_few_machines_keep_the_limits(user: User) -> None:
    view = vary(user, X)
    ask_alone(view, PRESSURE)
    type_into(view.figure_rows.boxes[PRESSURE, "most"], "17.9")
    view.tabs.setCurrentIndex(1)
    view.tolerances.rows.add_requested.emit(X)
    settle()
    type_into(view.tolerances.rows.boxes[X, "plus"], "5")
    rested(user)
    assert "Tighten Pivot x to 1/2" in view.tolerances.tighter.text()
    type_into(view.tolerances.rows.boxes[X, "plus"], "0.1")
    rested(user)
    assert view.tolerances.tighter.text() == ""
    assert [row.plus for row in user.design.tolerances] == [0.1]
    QTest.mouseClick(view.tolerances.rows.removers[X], Qt.MouseButton.LeftButton)
    settle()
    assert user.design.tolerances == ()
    waves = view.tolerances.waves
    assert not waves.boxes["lobes_from", ""].isEnabled()
    type_into(waves.boxes["amplitude_mm", ""], "0.004")
    type_into(waves.boxes["lobes_to", ""], "5")
    assert "bounds are reversed; allowed: from 10" in waves.message.text()
    type_into(waves.boxes["lobes_to", ""], "30")
    assert user.design.waviness == Waviness(0.004, 10, 30)
    waves.boxes["amplitude_mm", ""].selectAll()
    QTest.keyClick(waves.boxes["amplitude_mm", ""], Qt.Key.Key_Delete)
    type_into(waves.boxes["amplitude_mm", ""], "")
    assert user.design.waviness is None


def study_entry(view: StudyView, text: str) -> QAction:
    """An entry of the menu of studies."""
    menu = view.open.menu()
    menu.aboutToShow.emit()
    return next(each for each in menu.actions() if text in each.text())


def numbers_of(view: StudyView) -> list[list[str]]:
    """Rows of the list of numbers below the result."""
    table = view.best.result_text.text().partition("<table")[2]
    return [re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row) for row in re.findall(r"<tr>(.*?)</tr>", table)]


@pytest.mark.stress
def test_a_ready_study_finds_the_smallest_cam_with_its_path_and_is_taken_over(user: User) -> None:
    user.window.show_task("study")
    view = user.window.view("study")
    assert isinstance(view, StudyView)
    assert not study_entry(view, "Least contact pressure").isEnabled(), "no width of the face is known"
    study_entry(view, "Smallest cam").trigger()
    rested(user)
    assert list(view.request.spans) == ["cam.base_radius_mm", X]
    assert view.request.goals == {"radius_mm:max": True}
    paths: list[int] = []
    view.best.stepped.connect(lambda: paths.append(len(view.map.path)))
    before = user.design
    QTest.mouseClick(view.best.start, Qt.MouseButton.LeftButton)
    assert view.best.stop.isVisible()
    wait_for(lambda: not view.best.busy)
    assert paths[0] == 0
    assert len(set(paths)) > 2, "the path grows while it runs"
    assert user.design == before, "nothing is taken over by itself"
    assert "Cam radius 399.01 mm</b>, before 475 mm (−16 %)" in view.best.result_text.text()
    assert "Limited by profile curvature" in view.best.result_text.text()
    assert numbers_of(view) == [
        ["", "before", "found", "taken", "held by"],
        ["Base radius Br", "400 mm", "323.724 mm", "323.8 mm", "profile curvature, greatest"],
        ["Pivot x", "873.746 mm", "847.593 mm", "847.6 mm", "profile curvature, greatest"],
    ]
    QTest.mouseClick(view.best.take, Qt.MouseButton.LeftButton)
    settle()
    assert (get(user.design, BASE), get(user.design, X)) == (323.8, 847.6)
    assert user.steps == ["Take over the best design"]
    user.choose("Edit", "Undo Take over the best design")
    assert user.design == before
    QTest.mouseClick(view.best.exact, Qt.MouseButton.LeftButton)
    assert "Cam radius 398.93 mm</b>, before 475 mm (−16 %)" in view.best.result_text.text()
    assert [row[3] for row in numbers_of(view)[1:]] == ["323.724 mm", "847.593 mm"]
    QTest.mouseClick(view.best.take, Qt.MouseButton.LeftButton)
    settle()
    assert get(user.design, BASE) == pytest.approx(323.7236, abs=1e-3)
    QTest.mouseClick(view.best.exact, Qt.MouseButton.LeftButton)


@pytest.mark.stress
def test_a_search_is_stopped_and_words_are_tried(user: User) -> None:
    user.window.show_task("study")
    view = user.window.view("study")
    assert isinstance(view, StudyView)
    study_entry(view, "All lengths together").trigger()
    rested(user)
    assert len(view.request.spans) == 9
    QTest.mouseClick(view.best.start, Qt.MouseButton.LeftButton)
    wait_for(lambda: len(view.best.path) > 1)
    assert view.pages.parallel.path.shape[1] == 9
    QTest.mouseClick(view.best.stop, Qt.MouseButton.LeftButton)
    wait_for(lambda: not view.best.busy)
    assert "Stopped after" in view.best.progress.text()
    assert not view.best.take.isVisible()
    study_entry(view, "The law with the least jerk").trigger()
    rested(user)
    assert view.request.words["motion.segments[3].law"] == ("modified-sine", "modified-trapezoid", "cycloidal", "3-4-5")
    QTest.mouseClick(view.best.start, Qt.MouseButton.LeftButton)
    wait_for(lambda: not view.best.busy)
    assert "Segment 2, law Cycloidal" in view.best.result_text.text()
    QTest.mouseClick(view.best.take, Qt.MouseButton.LeftButton)
    settle()
    assert [segment.curve.law for segment in user.design.drive.motion.segments][1::2] == ["cycloidal", "cycloidal"]


@pytest.mark.stress
def test_a_study_file_is_opened_with_its_design(open_user: Open, tmp_path: Path) -> None:
    own = tmp_path / "lift.toml"
    own.write_bytes(example("transfer_lift").read_bytes())
    (tmp_path / "study.toml").write_text(
        'design = "lift.toml"\nseed = 41\n'
        f'[[vary]]\nfield = "{X}"\nlow = 800\nhigh = 900\nsteps = 5\n[[limits]]\nquantity = "pressure_angle_deg"\n'
        'of = "max"\nmax = 30.0\n[[goals]]\nquantity = "contact_force_n"\nof = "max"\n',
        "utf-8",
    )
    user = open_user(example("four_bar"), whole=True, size=(1280, 720))
    user.window.show_task("study")
    view = user.window.view("study")
    assert isinstance(view, StudyView)
    view.open.opened.emit(tmp_path / "study.toml")
    rested(user)
    assert user.session.path == own
    assert [(span.low, span.high) for span in view.request.spans.values()] == [(800.0, 900.0)]
    assert view.request.figures == {"pressure_angle_deg:max": (None, 30.0), "contact_force_n:max": (None, None)}
    user.picks("study_to_save", tmp_path / "again.toml")
    QTest.mouseClick(view.save, Qt.MouseButton.LeftButton)
    again = load_study(tmp_path / "again.toml").file
    assert again.seed == 41
    assert [(row.low, row.high, row.steps) for row in again.vary] == [(800.0, 900.0, 5)]
    user.session.put(edited(user.design, BASE, 410.0), "Base radius")
    view.open.opened.emit(tmp_path / "study.toml")
    rested(user)
    assert get(user.design, BASE) == 410.0, "the design at hand stays, as the study names its file"
    (tmp_path / "study.toml").write_text(
        'design = "lift.toml"\n[[vary]]\nfield = "cam.bore"\nlow = 3\nhigh = 1\n', "utf-8"
    )
    view.open.opened.emit(tmp_path / "study.toml")
    ((what, lines),) = user.faults
    assert what == "study.toml cannot be opened."
    assert any("bounds are reversed" in line for line in lines)


@pytest.mark.fuzz
def test_two_goals_give_a_front_of_which_a_click_takes_one_over(user: User) -> None:
    view = vary(user, X)
    vary(user, BASE)
    view.tabs.setCurrentIndex(2)
    for word, key in zip(view.best.goals, (TORQUE, FORCE), strict=True):
        word.setCurrentIndex(word.findData(key))
        word.activated.emit(word.currentIndex())
        settle()
    assert list(view.request.goals) == [TORQUE, FORCE]
    QTest.mouseClick(view.best.start, Qt.MouseButton.LeftButton)
    wait_for(lambda: not view.best.busy)
    settle()
    assert view.pages.front.isVisible()
    front = view.best.optimum.front  # type: ignore[union-attr]
    assert len(front) >= 20
    assert (np.diff(view.pages.front.points[0]) >= 0.0).all()
    assert (np.diff(view.pages.front.points[1]) <= 0.0).all(), "none is dominated"
    number = len(front) // 2
    QTest.mouseClick(
        view.pages.front.viewport(), Qt.MouseButton.LeftButton, pos=view.pages.front.pixel(number).toPoint()
    )
    settle()
    assert get(user.design, BASE) == pytest.approx(front[number][BASE], abs=0.1)
    assert get(user.design, BASE) == round(get(user.design, BASE), 1)
    assert user.steps == ["Take over a design of the front"]


@pytest.mark.stress
def test_the_ready_study_of_the_top_speed_has_a_number_as_its_goal(user: User, tmp_path: Path) -> None:
    """With the way up of the lift alone, and a limit of the contact force typed next to its own."""
    design = user.design
    for i in (0, 1, 2):
        design = edited(design, f"motion.segments[{i}].fixed", True)
    user.session.put_full_design(design, "windows")
    user.window.show_task("study")
    view = user.window.view("study")
    assert isinstance(view, StudyView)
    study_entry(view, "Top speed of the machine").trigger()
    rested(user)
    assert list(view.request.spans) == ["shaft.speed_rpm", "motion.segments[3].span_deg"]
    assert view.request.goals == {"shaft.speed_rpm": False}
    assert [view.best.goals[0].currentText(), view.best.directions[0].currentText()] == ["Speed", "greatest"]
    view.request.set_words("motion.segments[3].law", ("modified-sine",))
    view.request.change_figure("contact_force_n:min", "contact_force_n:min", (500.0, None))
    rested(user)
    QTest.mouseClick(view.best.start, Qt.MouseButton.LeftButton)
    wait_for(lambda: not view.best.busy)
    text = view.best.result_text.text()
    assert re.search(r"<b>Speed \d+\.?\d* rpm</b>, before 20 rpm", text), text
    assert "Limited by contact force, least: 1 % more changes the goal by" in text
    before = user.design
    QTest.mouseClick(view.best.take, Qt.MouseButton.LeftButton)
    settle()
    assert get(user.design, "shaft.speed_rpm") > 40.0
    assert user.steps[-1] == "Take over the best design"
    assert [row.name for row in Pins.of(user.session).rows] == ["speed", "before speed"]
    user.session.stack.undo()
    assert user.design == before
