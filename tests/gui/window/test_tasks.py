"""kindyna_gui.window.tasks, layouts: a layout for each, each remembered as it was left; nothing is computed for what is not seen."""

from collections import Counter

import pytest
from PySide6.QtCore import QByteArray, QEvent, QObject, QPoint, QRect, QSize, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractItemView, QApplication, QInputDialog, QToolBar, QToolButton, QWidget
from window_user import Open, User, answering, settle, wait_for

from core.project import load
from core.study import STAGES, clear_caches, evaluations
from core.study.stages import memory
from kindyna_gui.look import apply_preferences
from kindyna_gui.motion.segments_table import SPAN
from kindyna_gui.motion.segments_view import SegmentsView
from kindyna_gui.places import example
from kindyna_gui.settings import Preferences, settings_file
from kindyna_gui.view import View
from kindyna_gui.window.docks import CENTRE, VIEWS
from kindyna_gui.window.main_window import LARGEST, first_size
from kindyna_gui.window.tasks import INSPECTOR, TASKS

TITLES = ["Make", "Compo", "Kine", "Dyna", "Stability", "Graph", "Study"]
KEYS = tuple(Qt.Key(Qt.Key.Key_1 + i) for i in range(len(TITLES)))
CTRL = Qt.KeyboardModifier.ControlModifier
SMALL, USUAL = (1280, 720), (1440, 900)


def buttons(user: User) -> list[QToolButton]:
    bar = user.window.findChild(QToolBar, "tasks")
    assert isinstance(bar, QToolBar)
    return [bar.widgetForAction(action) for action in bar.actions()]  # type: ignore[misc]


def press(user: User, task: str) -> None:
    """The task's keys, and all that follows."""
    user.press(KEYS[list(TASKS).index(task)], modifier=CTRL)
    rest(user)


def rest(user: User) -> None:
    for _ in range(3):
        QTest.qWait(1)
        settle()
    wait_for(
        lambda: all(
            view.up_to_date for view in user.window.findChildren(View) if view.on_screen() and not view.pause_ms
        )
    )


def places(user: User) -> dict[str, QRect]:
    """Where everything stands that can be seen of the layout."""
    found = {
        name: dock.geometry()
        for name, dock in user.window.docks.items()
        if dock.view is not None and dock.view.on_screen()
    }
    return {**found, "middle": user.window.centre.geometry()}


# -- switching ----------------------------------------------------------------------------------------------


def test_tasks_are_buttons_under_the_menus_keys_and_entries(whole: User) -> None:
    assert [button.text() for button in buttons(whole)] == TITLES
    assert all(button.isVisible() and button.toolTip() for button in buttons(whole))
    assert [button.isChecked() for button in buttons(whole)] == [True, *[False] * 6], (
        "a motion is begun where it is made"
    )
    bar = buttons(whole)[0].parent()
    assert isinstance(bar, QWidget)
    assert bar.mapTo(whole.window, QPoint(0, 0)).y() == whole.window.menuBar().height()
    for number, (name, button) in enumerate(zip(TASKS, buttons(whole), strict=True)):
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)
        rest(whole)
        large = whole.window.view(TASKS[name].large)
        assert large is not None
        assert large.on_screen()
        assert large.isAncestorOf(QApplication.focusWidget()) or large is QApplication.focusWidget(), "keys go on there"
        assert [each.isChecked() for each in buttons(whole)] == [i == number for i in range(7)]
    for number, name in reversed(list(enumerate(TASKS))):
        press(whole, name)
        assert buttons(whole)[number].isChecked()
        assert whole.action("View", TITLES[number]).isChecked()
        assert whole.action("View", TITLES[number]).shortcut().toString() == f"Ctrl+{number + 1}"


def test_every_dock_has_one_place_in_every_task() -> None:
    docks = {name for name, row in VIEWS.items() if row.area != CENTRE}
    for task in TASKS.values():
        named = Counter(name for _, names in task.all_docks for name in names)
        assert set(named) == docks
        assert set(named.values()) == {1}


@pytest.mark.stress
def test_a_linkage_without_a_motion_begins_in_its_drawing(open_user: Open) -> None:
    user = open_user(example("lecture_six_bar"), whole=True)
    assert user.window.layouts.current == "compo"
    wait_for(lambda: user.window.docks["centres"].view is not None and user.window.docks["centres"].view.on_screen())
    user.choose("File", "Examples", "Transfer lift")
    assert user.window.docks["centres"].isHidden()
    press(user, "make")
    user.choose("File", "Examples", "Four bar")
    assert user.window.layouts.current == "compo", "there is nothing to be made of a crank"
    wait_for(lambda: user.window.docks["centres"].view.on_screen())  # type: ignore[union-attr]


def whole_turns() -> Counter[str]:
    """How often each stage has been computed for a whole turn, rather than at the angle at hand."""
    return Counter({name: memory.computed[name] for name in (*STAGES, "flywheel")})


class Refreshed:
    """Counts how often each view is made up to date."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self.names: list[str] = []
        pull = View.pull

        def noted(view: View) -> None:
            stale = not view.up_to_date
            pull(view)
            if stale:
                self.names.append(type(view).__name__)

        patch.setattr(View, "pull", noted)


@pytest.mark.stress
def test_switching_computes_nothing_that_does_not_come_into_view(whole: User, monkeypatch: pytest.MonkeyPatch) -> None:
    whole.window.session.stages_on_screen = tuple  # the count of findings is another matter
    whole.window.docks["findings"].hide()
    whole.window.docks["certificate"].hide()
    whole.window.show_view("pressure_angle")
    clear_caches()
    before = whole_turns()
    assert whole.session.edit("follower.rod_mm", 846.0, "Change rod")
    rest(whole)
    turns = whole_turns()
    assert turns - before == Counter(motion=1, linkage=1, cam=1), "what the mechanism and the pressure angle need"
    refreshed = Refreshed(monkeypatch)
    press(whole, "compo")
    assert whole_turns() == turns, "mechanism, forms and pressure angle need nothing new"
    assert refreshed.names == ["ParametersView"], "the drawing and the pressure angle show this design already"
    refreshed.names.clear()
    for task in ("make", "compo"):
        press(whole, task)
    assert refreshed.names == []
    press(whole, "stability")
    assert whole_turns() == turns, "the shaft is rigid"
    press(whole, "dyna")
    assert whole_turns() - turns == Counter(dynamics=1, flywheel=1)
    assert refreshed.names == ["StabilityView", "PlotView", "PlotView"]
    refreshed.names.clear()
    turns, once = whole_turns(), evaluations.copy()
    for task in ("stability", "compo", "make", "dyna"):
        press(whole, task)
    assert refreshed.names == []
    assert whole_turns() == turns
    assert evaluations.keys() == once.keys()


class Painted(QObject):
    def __init__(self, widgets: list[QWidget]) -> None:
        super().__init__()
        self.count = 0
        for widget in widgets:
            widget.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        self.count += event.type() == QEvent.Type.Paint
        return False


def test_what_another_task_shows_rests(whole: User) -> None:
    """It is neither painted nor computed while the design changes and the cam turns."""
    press(whole, "dyna")
    press(whole, "make")
    whole.window.docks["findings"].hide()
    whole.window.docks["certificate"].hide()
    whole.window.session.stages_on_screen = tuple
    rest(whole)
    views = [whole.window.view(name) for name in ("torque", "contact_force")]
    painted = Painted([widget for view in views if view is not None for widget in (view, *view.findChildren(QWidget))])
    before = evaluations.copy()
    assert whole.session.edit("follower.rod_mm", 847.0, "Change rod")
    whole.window.player.step(5.0)
    rest(whole)
    assert painted.count == 0
    assert "dynamics" not in evaluations - before
    assert not any(view.up_to_date for view in views if view is not None)


@pytest.mark.stress
def test_forces_are_drawn_where_they_are_read_and_each_task_keeps_what_was_shown_in_it(whole: User) -> None:
    drawn = whole.window.view("mechanism").scene.layer_selected  # type: ignore[union-attr]
    assert not drawn("forces")
    press(whole, "dyna")
    assert drawn("forces")
    parameters = whole.window.view("parameters")
    assert parameters.tabs.currentWidget() is parameters.pages["loads"], "in front of the first form that is made, too"  # type: ignore[union-attr]
    press(whole, "kine")
    assert not drawn("forces")
    whole.choose("View", "Layers of the drawing", "Forces")
    press(whole, "dyna")
    whole.choose("View", "Layers of the drawing", "Forces")
    assert not drawn("forces")
    press(whole, "kine")
    assert drawn("forces")


# -- layouts ------------------------------------------------------------------------------------------------


@pytest.mark.stress
@pytest.mark.parametrize("size", [SMALL, USUAL, (1920, 1080)])
def test_each_task_shows_its_large_view_at_half_of_the_window_and_the_parameters_in_one_corner(
    open_user: Open, size: tuple[int, int]
) -> None:
    """These at the upper right, of one width, which follows the hand; only the chart of stability needs a small window whole. A
    reset moves nothing."""
    user = open_user(size=size, whole=True)
    wide, small = INSPECTOR, size == SMALL
    wide_page_goes = 2 * ("stability", "study") if small else ()
    for name in (*wide_page_goes, *TASKS, "make", "kine"):
        press(user, name)
        box = user.window.docks["parameters"].geometry()
        if name != "stability" or not small:
            assert (box.left() + box.width(), box.width()) == (size[0], pytest.approx(wide, abs=1)), name
            assert box.top() <= user.window.centre.geometry().top() + 26, (
                f"{name}: at the top, below tabs where it has any"
            )
        if wide == INSPECTOR and size[0] < 1920:
            shows_half(user, name, size)
        if name == "study" and size == USUAL:
            wide = 450
            user.drag_width("study", size[0] - wide - 5)
            rest(user)


def shows_half(user: User, name: str, size: tuple[int, int]) -> None:
    """The large view of a task has half of the window, and nothing is clipped; a reset moves nothing."""
    assert user.window.size().toTuple() == size, name
    large = user.window.view(TASKS[name].large)
    assert large is not None
    assert large.width() * large.height() >= 0.5 * size[0] * size[1], name
    for view in user.window.findChildren(View):
        if view.on_screen():
            least = view.minimumSizeHint()
            assert least.width() <= view.width(), f"{type(view).__name__} is clipped in {name}"
            assert least.height() <= view.height(), f"{type(view).__name__} is clipped in {name}"
    first = places(user)
    for _ in range(2 if size == USUAL else 0):
        user.choose("View", "Reset layout")
        rest(user)
        assert places(user) == first, name


@pytest.mark.stress
def test_a_small_window_with_large_letters_keeps_its_size(open_user: Open, app: QApplication) -> None:
    user = open_user(size=SMALL, whole=True)
    apply_preferences(Preferences(font=125), app)
    try:
        for name in 2 * ("study", "kine"):
            press(user, name)
            assert user.window.size().toTuple() == SMALL, name
    finally:
        apply_preferences(Preferences(), app)


@pytest.mark.stress
def test_an_empty_list_of_findings_takes_a_line(open_user: Open) -> None:
    user = open_user(size=USUAL, whole=True)
    press(user, "kine")
    findings = user.see("findings")
    rest(user)
    line = findings.fontMetrics().height()
    assert line <= findings.height() <= 3 * line
    assert user.session.edit("limits.pressure_angle_rise_deg", 5.0, "Limit")
    wait_for(lambda: findings.maximumHeight() > 1000)
    rest(user)
    assert findings.table.rowHeight(0) <= findings.table.viewport().height(), "a finding is read whole"  # type: ignore[attr-defined]


@pytest.mark.stress
def test_a_wide_window_stacks_motion_and_pressure_angle_on_one_axis(open_user: Open) -> None:
    user = open_user(size=(1920, 1080), whole=True)
    press(user, "kine")
    plots = list(user.see("stack").plots.values())  # type: ignore[attr-defined]
    assert len(plots) == 5
    assert all(plot.isVisible() and plot.height() > 100 for plot in plots)
    for angle in (0.0, 120.0, 360.0):
        over = {round(plot.mapTo(user.window, plot.pixel_at(angle).toPoint()).x()) for plot in plots}
        assert max(over) - min(over) <= 1, angle
    QTest.mouseClick(plots[3].viewport(), Qt.MouseButton.LeftButton, pos=plots[3].pixel_at(90.0).toPoint())
    assert user.window.player.theta == pytest.approx(1.5708, abs=0.03)
    assert len({plot.angle for plot in plots}) == 1


@pytest.mark.stress
def test_sections_and_scroll_are_remembered_for_each_drive(open_user: Open) -> None:
    user = open_user(example("transfer_unit"), size=SMALL, whole=True)
    view = user.parameters()
    view.show_section("cam")
    form = view.forms["cam"]
    form.more.click()
    rest(user)
    assert form.verticalScrollBar().maximum() > 40
    form.verticalScrollBar().setValue(40)
    assert user.session.choose_drive(2)
    rest(user)
    view.show_section("shaft")
    assert user.session.choose_drive(0)
    rest(user)
    wait_for(lambda: view.tabs.currentWidget() is view.pages["cam"] and form.verticalScrollBar().value() == 40)
    assert user.session.choose_drive(2)
    rest(user)
    assert view.tabs.currentWidget() is view.pages["shaft"]


@pytest.mark.stress
def test_figures_of_a_shaft_are_read_in_a_small_window(open_user: Open) -> None:
    user = open_user(example("transfer_unit"), size=SMALL, whole=True)
    press(user, "dyna")
    drives = user.window.view("drives").table  # type: ignore[union-attr]
    assert sum(map(drives.rowHeight, range(4))) <= drives.viewport().height()
    for plot in user.window.view("shaft_torque").plots:  # type: ignore[union-attr]
        assert plot.getViewBox().height() >= 80.0
    for name in ("drives", "shaft_torque", "timing"):
        assert user.window.view(name).on_screen(), name  # type: ignore[union-attr]
    table = user.see("shaft_figures").table  # type: ignore[attr-defined]
    wait_for(lambda: table.model().rowCount() == 6)
    rest(user)
    assert sum(map(table.rowHeight, range(6))) <= table.viewport().height(), "four drives, their shaft and its motor"
    assert user.window.size().toTuple() == SMALL


@pytest.mark.stress
def test_the_chart_of_stability_has_half_of_the_window(open_user: Open) -> None:
    user = open_user(example("kim_1990"), size=SMALL, whole=True)
    press(user, "stability")
    view = user.window.view("stability")
    chart = view.chart  # type: ignore[union-attr]
    assert chart.width() * chart.height() >= 0.5 * SMALL[0] * SMALL[1]
    below = view.pages.mapTo(view, QPoint(0, 0)).y() - chart.mapTo(view, QPoint(0, 0)).y() - chart.height()  # type: ignore[union-attr]
    assert below <= 10, "nothing but the line that parts them stands between chart and verdicts"
    view.leave()  # type: ignore[union-attr]


def test_a_first_window_uses_the_screen() -> None:
    assert first_size(QSize(1920, 1080)).width() == 1920
    assert first_size(QSize(1920, 1080)).height() >= 1000
    assert first_size(QSize(1440, 900)).width() == 1440
    assert first_size(QSize(3840, 2160)) == LARGEST


@pytest.mark.stress
def test_each_task_is_found_as_it_was_left_also_in_the_next_session(open_user: Open) -> None:
    user = open_user(size=USUAL, whole=True)
    left: dict[str, dict[str, QRect]] = {}
    for name in ("make", "compo", "kine", "graph"):
        press(user, name)
        if name == "compo":
            user.window.docks["pressure_angle"].close()
            user.drag_width("parameters", 470)
        if name == "kine":
            user.choose("Kine", "Velocity")
            user.choose("Make", "Law table")
        rest(user)
        left[name] = places(user)
    for name in ("kine", "compo", "graph"):
        press(user, name)
        assert places(user) == left[name], name
    press(user, "make")
    assert not user.window.view("laws").on_screen()  # type: ignore[union-attr]
    user.choose("View", "Reset layout")
    press(user, "compo")
    assert places(user).keys() == left["compo"].keys(), "only the task in place is laid out anew"
    assert places(user)["parameters"].width() == INSPECTOR, "but the parameters are as wide in every task"
    user.window.close()
    again = open_user(size=None)
    assert again.window.layouts.current == "compo"
    assert [button.text() for button in buttons(again) if button.isChecked()] == ["Compo"]
    assert again.window.docks["pressure_angle"].isHidden()
    press(again, "kine")
    assert again.window.view("velocity").on_screen()  # type: ignore[union-attr]
    assert again.window.view("laws").on_screen()  # type: ignore[union-attr]
    assert again.window.view("graph") is None


@pytest.mark.stress
def test_settings_that_make_no_sense_are_passed_over(open_user: Open, whole: User) -> None:
    whole.window.close()
    kept = settings_file()
    for key in kept.allKeys():
        kept.setValue(key, "nonsense")
    kept.sync()
    again = open_user(size=None)
    assert again.window.layouts.current == "make"
    press(again, "compo")
    assert again.window.view("parameters").on_screen()  # type: ignore[union-attr]


# -- the motion table ---------------------------------------------------------------------------------------


def motion(user: User) -> SegmentsView:
    view = user.see("motion")
    assert isinstance(view, SegmentsView)
    rest(user)
    return view


def rows_in_sight(view: SegmentsView) -> int:
    return view.table.viewport().height() // view.table.verticalHeader().defaultSectionSize()


@pytest.mark.stress
@pytest.mark.parametrize("size", [SMALL, USUAL])
def test_the_motion_table_shows_its_rows_in_every_task(open_user: Open, size: tuple[int, int]) -> None:
    """With a message below it, and without; a rise that does not come back leaves the motion unfinished."""
    user = open_user(size=size, whole=True)
    for name in ("make", "compo", "kine", "graph") if size == SMALL else ("make", "dyna"):  # each has it elsewhere
        press(user, name)
        view = motion(user)
        assert user.window.size().toTuple() == size, name
        assert rows_in_sight(view) == view.model.rowCount() or name not in ("make", "study"), "four rows take four rows"
        user.enter_cell(1, SPAN, "300")
        rest(user)
        assert view.incomplete_bar.isVisible(), name
        assert view.table.verticalScrollBar().maximum() == 0, name
        assert view.incomplete_bar.close_button.visibleRegion().boundingRect().height() > 10, (
            f"{name}: it can be reached"
        )
        assert rows_in_sight(view) >= view.model.rowCount(), name
        user.session.drop_incomplete()
        rest(user)


def where(view: SegmentsView) -> list[QPoint]:
    """Of what the mouse may be over: the rows, the diagram, the fields above, the buttons below."""
    heads = [field.editor for field in view.header.fields.values()]
    widgets = [view.table.viewport(), view.diagram, *heads, *view.bar.buttons.values(), view.derivatives]
    at = [widget.mapTo(view.window(), QPoint(0, 0)) for widget in widgets]
    sizes = [QPoint(widget.width(), widget.height()) for widget in widgets if widget is not view.table.viewport()]
    return [*at, *sizes, QPoint(0, view.table.verticalScrollBar().value())]


@pytest.mark.stress
@pytest.mark.parametrize("task", ["make", "compo"])
def test_no_text_moves_what_is_under_the_mouse(open_user: Open, task: str) -> None:
    user = open_user(size=SMALL, whole=True)
    press(user, task)
    view = motion(user)
    before = where(view)
    for row in range(view.model.rowCount()):  # a dwell takes nothing more, a modified sine its crossover
        view.choose(row)
        rest(user)
        assert where(view) == before, f"row {row + 1} is chosen"
    user.enter_cell(3, SPAN, "0")
    rest(user)
    assert view.message.isVisible()
    assert where(view) == before, "something is refused"
    user.press(Qt.Key.Key_Escape)
    user.enter_cell(3, SPAN, "300")
    rest(user)
    assert view.incomplete_bar.isVisible()
    assert where(view) == before, "the motion does not come back"
    user.session.drop_incomplete()
    user.enter("motion.stroke_mm", "-3")
    rest(user)
    assert view.header.fields["motion.stroke_mm"].message.isVisible()
    assert where(view) == before, "a stroke is refused"
    user.press(Qt.Key.Key_Escape)
    for law in ("polynomial", "spline"):
        assert user.session.edit("motion.segments[3].law", law, "Change law")
        user.session.end_gesture()
        view.choose(3)
        rest(user)
        assert where(view) == before, law


@pytest.mark.stress
def test_a_second_double_click_hits_the_same_row_under_a_text(open_user: Open) -> None:
    """The first edit is refused, with a sentence below the table; the mouse stays where it is."""
    user = open_user(size=SMALL, whole=True)
    view = motion(user)
    table = view.table
    place = table.visualRect(view.model.index(3, SPAN)).center()
    on_screen = table.viewport().mapToGlobal(place)

    def double_click() -> tuple[int, int]:
        at = table.viewport().mapFromGlobal(on_screen)
        QTest.mouseClick(table.viewport(), Qt.MouseButton.LeftButton, pos=at)
        QTest.mouseDClick(table.viewport(), Qt.MouseButton.LeftButton, pos=at)
        wait_for(lambda: table.state() == QAbstractItemView.State.EditingState)
        return table.currentIndex().row(), table.currentIndex().column()

    assert double_click() == (3, SPAN)
    user.type("0")
    user.press(Qt.Key.Key_Return)
    rest(user)
    assert view.message.isVisible()
    assert double_click() == (3, SPAN)
    user.type("41.5")
    user.press(Qt.Key.Key_Return)
    rest(user)
    assert not view.message.isVisible()


@pytest.mark.stress
def test_velocity_acceleration_and_jerk_stand_below_the_displacement_on_one_axis(open_user: Open) -> None:
    user = open_user(size=SMALL, whole=True)
    view = motion(user)
    assert [plot.isVisible() for plot in view.derivatives.plots] == [True] * 3
    user.turn(60.0)
    study = user.session.at(user.window.player.theta)
    assert [plot.angle for plot in view.derivatives.plots] == [user.window.player.theta] * 3
    assert all(plot.readings() for plot in view.derivatives.plots)
    assert study.motion.y[1] != 0.0
    wait_for(lambda: not any(plot.lacks_extremes for plot in view.derivatives.plots))
    scale = view.diagram.scale_now()
    for angle in (0.0, 120.0, 360.0):
        over = {round(plot.mapTo(view, plot.pixel_at(angle).toPoint()).x()) for plot in view.derivatives.plots}
        here = view.diagram.mapTo(view, view.diagram.position_of(angle, (scale.low + scale.high) / 2.0).toPoint()).x()
        assert all(abs(x - here) <= 1 for x in over), angle
    plot = view.derivatives.plots[1]
    QTest.mouseClick(plot.viewport(), Qt.MouseButton.LeftButton, pos=plot.pixel_at(90.0).toPoint())
    assert user.window.player.theta == pytest.approx(1.5708, abs=0.03)
    user.window.docks["motion"].setFloating(True)
    user.window.docks["motion"].resize(384, 420)
    wait_for(lambda: not view.derivatives.shown)
    before = view.derivatives.plots[0].angle
    user.turn(200.0)
    assert view.derivatives.plots[0].angle == before, "what cannot be seen rests"
    assert view.diagram.angle == user.window.player.theta


@pytest.mark.stress
def test_the_certificate_shows_more_than_three_rows(open_user: Open) -> None:
    user = open_user(size=SMALL, whole=True)
    table = user.see("certificate").table  # type: ignore[attr-defined]
    rest(user)
    heights = [table.rowHeight(row) for row in range(table.model().rowCount())]
    assert len(heights) >= 4
    assert sum(heights[:4]) <= table.viewport().height()


@pytest.mark.stress
def test_a_long_name_is_not_cut(open_user: Open) -> None:
    user = open_user(size=SMALL, whole=True)
    press(user, "compo")
    box = user.parameters().name
    for name in ("kim_1990", "rear_suspension", "four_bar_coupler_cam"):
        user.session.start(load(example(name)))
        settle()
        assert box.text() == user.design.name
        assert box.fontMetrics().horizontalAdvance(box.text()) <= box.width() - 12, name
        assert box.toolTip().startswith(user.design.name)


def test_layouts_are_named_and_come_back_and_what_cannot_is_told_in_a_line(open_user: Open) -> None:
    user = open_user()
    window = user.window
    user.choose("View", "Kine")
    dock = window.docks["findings"]
    dock.show()
    dock.setFloating(True)
    settle()

    def name(dialog: QInputDialog) -> None:
        dialog.setTextValue("Two screens / left")
        dialog.accept()

    with answering(QInputDialog, name):
        user.choose("View", "Named layouts", "Save this layout...")
    user.choose("View", "Reset layout")
    assert not dock.isFloating()
    user.choose("View", "Dyna")
    user.choose("View", "Named layouts", "Two screens / left")
    settle()
    assert window.layouts.current == "kine"
    assert dock.isFloating()
    assert window.settings.named_layouts == ["Two screens / left"]  # for the next run, too
    kept = settings_file()
    (key,) = (key for key in kept.allKeys() if key.startswith("layouts/") and key.endswith("/version"))
    user.choose("View", "Reset layout")
    for value, said in ((999, "newer version"), (window.settings.VERSION, "damaged")):
        kept.setValue(key, value)
        kept.setValue(key.replace("version", "docks"), QByteArray(b"nonsense"))
        kept.sync()
        user.choose("View", "Named layouts", "Two screens / left")
        assert said in window.statusBar().currentMessage()
        assert not dock.isFloating()
    user.choose("View", "Named layouts", "Delete Two screens / left")
    assert window.settings.named_layouts == []
