"""kindyna_gui.window.room: no dock is laid below its least size; what does not fit is a tab, and the parameters keep their width."""

import random
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import pytest
from PySide6.QtWidgets import QApplication, QTabBar
from room import unreadable
from sampled import spread
from window_user import Open, User, settle

from core.design import edited
from core.project import load, save
from kindyna_gui.findings import FindingsView
from kindyna_gui.forms.tab_bars import TabList
from kindyna_gui.look import apply_preferences
from kindyna_gui.places import example
from kindyna_gui.screenshots import rest
from kindyna_gui.settings import INCH, Preferences
from kindyna_gui.view import ReasonPage
from kindyna_gui.window.docks import BOTTOM, CENTRE, LEFT, RIGHT, TOP, VIEWS, Need
from kindyna_gui.window.room import Plan, plan_docks
from kindyna_gui.window.tasks import INSPECTOR, SEPARATOR, TASKS

SIZES = (1280, 720), (1440, 900), (1920, 1080)
BARS, BAR, TITLE = 86, 36, 26  # menus, tools and status line; player; title or tabs [pixels]
NEEDS = {name: Need(*row.least, tab=7 * len(row.title) + 26) for name, row in VIEWS.items()}
KINDS = "one drive", "several drives", "a linkage"
PAGES = [name for name, row in VIEWS.items() if row.area == CENTRE]


def planned(
    task: str, size: tuple[int, int], kind: str, called: str = "", middle: tuple[int, int] | None = None
) -> Plan:
    middle = page(task, called) if middle is None else middle
    row = TASKS[task].at(size[0])
    opened = [name for group in row.groups for name in group.names]
    opened += {"one drive": (), "several drives": row.shaft_docks, "a linkage": row.linkage_docks}[kind]
    if called and called not in PAGES:
        opened.append(called)
    fronts = [group.names[0] for group in row.groups if group.names]
    room, names = (size[0], size[1] - BARS), tuple(dict.fromkeys(opened))
    return plan_docks(row, NEEDS, middle, room, names, in_front=fronts, called=called)


def page(task: str, called: str) -> tuple[int, int]:
    """Least size of the middle with the page called, or that of the task, in front; above the player."""
    front = called if called in PAGES else TASKS[task].pages[-1]
    width, height = VIEWS[front].least
    tabs = len({*TASKS[task].pages, front}) > 1
    return max(width, 330), height + BAR + TITLE * tabs


def too_small(plan: Plan, size: tuple[int, int], middle: tuple[int, int]) -> Iterator[str]:
    """Each dock, and the middle, below its least size; each side beyond the window."""
    for group in plan.groups:
        across, along = plan.extents[group.area], group.length
        width, height = (across, along) if group.area in (LEFT, RIGHT) else (along, across)
        for name in group.names:
            if width < NEEDS[name].width or height - TITLE < NEEDS[name].height:
                yield f"{name}: {width} x {height - TITLE}"
            if name == "parameters" and abs(width - INSPECTOR) > 6:
                yield f"parameters: {width} wide"
    for area in (LEFT, RIGHT):
        lengths = [group.length for group in plan.groups if group.area == area]
        if lengths and sum(lengths) + SEPARATOR * (len(lengths) - 1) != size[1] - BARS:
            yield f"{area}: {lengths}"
    columns = sum(plan.extents[area] + SEPARATOR for area in (LEFT, RIGHT) if area in plan.extents)
    rows = sum(plan.extents[area] + SEPARATOR for area in (TOP, BOTTOM) if area in plan.extents)
    if size[0] - columns < middle[0] or size[1] - BARS - rows < middle[1]:
        yield f"middle: {size[0] - columns} x {size[1] - BARS - rows}"


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("task", TASKS)
def test_nothing_is_laid_below_its_least_size_whatever_is_called(task: str, size: tuple[int, int]) -> None:
    wrong = {}
    for kind in KINDS:
        for called in ("", *VIEWS):
            middle = page(task, called)
            plan = planned(task, size, kind, called)
            if not plan.fits:  # then the page of the task is a tab behind the mechanism
                middle = page("make", "mechanism")
                plan = planned(task, size, kind, called, middle)
            lines = [*too_small(plan, size, middle)]
            if called and called not in PAGES and called not in plan.fronts:
                lines.append("the view called is not in front")
            wrong[kind, called] = lines
    assert {case: lines for case, lines in wrong.items() if lines} == {}


@pytest.mark.parametrize("size", SIZES)
def test_what_a_task_opens_is_open_and_its_large_view_last_to_be_a_tab(size: tuple[int, int]) -> None:
    for task, row in TASKS.items():
        for kind in KINDS:
            plan = planned(task, size, kind)
            names = {name for group in plan.groups for name in group.names}
            assert names == {*plan.names}, "nothing is left out"
            large = [group.names for group in plan.groups if row.large in group.names]
            assert large in ([], [(row.large,)]), "nothing is behind the large view"


def test_a_view_that_needs_more_width_does_not_widen_the_parameters() -> None:
    for task in TASKS:
        for called in ("compare", "explain", "timing"):
            plan = planned(task, SIZES[0], "one drive", called)
            group = next(group for group in plan.groups if called in group.names)
            assert plan.sizes[group.front][0] >= VIEWS[called].least[0], (task, called)
            assert "parameters" not in group.names


def test_what_is_behind_tabs_in_a_small_window_is_next_to_it_in_a_large_one() -> None:
    small, large = (len(planned("kine", size, "one drive").groups) for size in (SIZES[0], SIZES[1]))
    assert small < large


# -- in a window -------------------------------------------------------------------------------------------

CALLED = ("", "explain", "compare", "timing", "find", "velocity", "certificate", "stability", "laws")
LIGHT, DARK_INCH = Preferences(), Preferences(units=dict(INCH), theme="dark")
NAMES = "transfer_lift", "transfer_unit", "lecture_six_bar"
OPENED = [
    (name, size, look)
    for look, names in ((LIGHT, NAMES[::2]), (DARK_INCH, NAMES[1::2]))
    for size in SIZES
    for name in names
]
WALKS = [(name, size) for size in SIZES for name in NAMES]


@pytest.fixture
def look(app: QApplication) -> Iterator[Callable[[Preferences], None]]:
    """Applies preferences; at the end those of a new user."""
    yield lambda preferences: apply_preferences(preferences, app)
    apply_preferences(LIGHT, app)


def walk(
    user: User, size: tuple[int, int], tasks: Iterable[str], called: Iterable[str]
) -> dict[tuple[str, str], list[str]]:
    """What cannot be read in these tasks, with each of these views called in their first layouts."""
    window, wrong = user.window, {}
    for task in tasks:
        for name in called:
            window.show_task(task)
            window.reset_layout()
            rest(window, 0.0)
            if name:
                window.show_view(name)
            rest(window, 1.0)
            lines = unreadable(window, name)
            if window.size().toTuple() != size:
                lines.append(f"the window is {window.size()}")
                window.resize(*size)
            wrong[task, name] = lines
    return {case: lines for case, lines in wrong.items() if lines}


@pytest.mark.parametrize(("name", "size", "preferences"), spread(OPENED, 3))
def test_all_tasks_can_be_read_as_they_open(
    open_user: Open,
    look: Callable[[Preferences], None],
    name: str,
    size: tuple[int, int],
    preferences: Preferences,
) -> None:
    user = open_user(example(name), size=size, whole=True)
    look(preferences)
    assert walk(user, size, TASKS, ("",)) == {}


@pytest.mark.stress
@pytest.mark.parametrize(("name", "size"), WALKS)
def test_all_tasks_can_be_read_with_a_view_called_after_any_order_of_tasks(
    open_user: Open, look: Callable[[Preferences], None], name: str, size: tuple[int, int]
) -> None:
    user, chance = open_user(example(name), size=size, whole=True), random.Random(f"{name} {size}")
    for preferences in (LIGHT, DARK_INCH):
        look(preferences)
        assert walk(user, size, chance.sample(list(TASKS), k=len(TASKS)), CALLED) == {}, preferences.theme


def test_explain_is_read_in_make_and_the_parameters_keep_their_width(open_user: Open) -> None:
    user = open_user(size=SIZES[0], whole=True)
    assert walk(user, SIZES[0], ("make", "kine"), ("explain", "timing")) == {}


@pytest.mark.parametrize("task", ["kine", "dyna"])
def test_the_parameters_are_in_front_of_the_drives(open_user: Open, task: str) -> None:
    user = open_user(example("transfer_unit"), size=SIZES[0], whole=True)
    user.window.show_task(task)
    rest(user.window, 1.0)
    view = user.window.view("parameters")
    assert view is not None
    assert view.on_screen()


def test_long_sentences_come_to_rest_where_they_have_room(open_user: Open) -> None:
    """In a row they have fewer lines than in a column: what is laid in the row must not go back for that."""
    user = open_user(example("lecture_six_bar"), size=SIZES[0], whole=True)
    window = user.window
    assert walk(user, SIZES[0], ("make",), ("velocity", "findings", "laws")) == {}
    assert walk(user, SIZES[0], ("kine",), ("",)) == {}
    areas = set()
    for _ in range(6):
        settle()
        areas.add(window.dockWidgetArea(window.docks["findings"]))
    assert len(areas) == 1


def test_an_open_view_called_stays_in_front_when_its_content_needs_more_room(open_user: Open) -> None:
    user = open_user(example("lecture_six_bar"), size=SIZES[0], whole=True)
    assert walk(user, SIZES[0], ("make",), ("findings",)) == {}


def test_a_page_called_comes_to_the_front_over_a_dock_called_before(open_user: Open) -> None:
    user = open_user(example("transfer_unit"), size=(1440, 900), whole=True)
    user.choose("Stability", "Chart")
    user.choose("Edit", "What changed")
    user.choose("Stability", "Chart")
    assert user.window.centre.open_pages[1] == "stability"
    view = user.window.view("stability")
    assert view is not None
    assert view.on_screen()


@pytest.mark.stress
def test_findings_stand_by_themselves_again_when_a_design_has_none(open_user: Open) -> None:
    """Those of the design before needed more room than there was, and made the dock a tab."""
    user = open_user(example("groove"), size=SIZES[0], whole=True)
    user.window.show_task("make")
    rest(user.window, 1.0)
    assert user.window.tabifiedDockWidgets(user.window.docks["findings"])
    user.session.start(load(example("transfer_lift")))
    user.window.reset_layout()
    rest(user.window, 1.0)
    assert not user.window.tabifiedDockWidgets(user.window.docks["findings"])
    view = user.see("findings")
    assert isinstance(view, FindingsView)
    assert view.empty.isVisible()
    assert view.empty.height() >= view.empty.sizeHint().height()


def test_a_reason_in_place_of_the_findings_has_its_lines(open_user: Open, tmp_path: Path) -> None:
    save(edited(load(example("slide_past_tool")), "motion.segments[1].limits.jerk", 20.0), tmp_path / "hard.toml")
    user = open_user(tmp_path / "hard.toml", size=SIZES[0], whole=True)
    user.window.show_task("make")
    rest(user.window, 1.0)
    view = user.window.view("findings")
    assert view is not None
    assert view.on_screen()
    assert view.in_trouble
    (page,) = (area for area in view.findChildren(ReasonPage) if area.isVisible())
    assert page.verticalScrollBar().maximum() == 0


# -- tabs --------------------------------------------------------------------------------------------------


def bar_of(user: User, name: str) -> QTabBar:
    """The tabs above a dock."""
    dock = user.window.docks[name]
    bars = [bar for bar in user.window.findChildren(QTabBar) if bar.parentWidget() is user.window and bar.isVisible()]
    return next(bar for bar in bars if dock.windowTitle() in [bar.tabText(i) for i in range(bar.count())])


def test_a_dock_without_tabs_has_its_full_title(open_user: Open) -> None:
    user = open_user(size=SIZES[0], whole=True)
    for task in TASKS:
        user.window.show_task(task)
        rest(user.window, 1.0)
        titled = [dock for dock in user.window.docks.values() if dock.isVisible() and dock.titleBarWidget() is None]
        assert [dock.windowTitle() for dock in titled] == [dock.title for dock in titled], task


def test_every_dock_has_one_row_of_tabs(open_user: Open) -> None:
    """Qt leaves a row of tabs where docks were before another one was opened."""
    user = open_user(example("four_bar"), size=SIZES[0], whole=True)
    user.window.show_task("compo")
    for name in ("polygon", "find_linkage"):
        user.window.show_view(name)
        rest(user.window, 1.0)
        bars = [b for b in user.window.findChildren(QTabBar) if b.parentWidget() is user.window and b.isVisible()]
        titles = [b.tabText(i) for b in bars if b.geometry().right() > 0 for i in range(b.count())]
        assert len(titles) == len(set(titles)), name


def test_names_of_tabs_are_shortened_before_tabs_are_in_a_list(open_user: Open) -> None:
    """Dragged behind the parameters, one dock after another; the list brings a view to the front."""
    user = open_user(size=SIZES[1], whole=True)
    window = user.window
    window.show_task("kine")
    docks, seen = ("certificate", "contact_force", "camshaft_speed", "contact_pressure", "vibration", "torque"), []
    for name in docks:
        window.tabifyDockWidget(window.docks["parameters"], window.docks[name])
        window.docks[name].show()
        rest(window, 1.0)
        bar = bar_of(user, "parameters")
        assert bar.count() == len(seen) + 2
        texts = [bar.tabText(i) for i in range(bar.count()) if bar.isTabVisible(i)]
        is_short = any(bar.tabText(i) != bar.tabToolTip(i) for i in range(bar.count()))
        seen.append((len(texts), bar.count(), is_short))
        assert unreadable(window) == [], name
        assert bar.tabToolTip(0) == "Parameters", "the tip is the full name"
    assert seen[0] == (2, 2, False)
    assert any(shown == count and is_short for shown, count, is_short in seen), "shortened, and all in sight"
    assert seen[-1][0] < seen[-1][1], "some are in the list"
    hidden = next(i for i in range(bar.count()) if not bar.isTabVisible(i))
    (button,) = [button for button in bar.findChildren(TabList) if button.isVisible()]
    menu = button.menu()
    menu.aboutToShow.emit()
    assert button.text() == f"{len(menu.actions())} more"
    title = bar.tabToolTip(hidden)
    next(action for action in menu.actions() if action.text() == title).trigger()
    settle()
    assert bar.currentIndex() == hidden
    assert bar.isTabVisible(hidden)
    assert unreadable(window) == []


# -- the user's own arrangement ------------------------------------------------------------------------------


def test_a_view_called_or_closed_leaves_the_width_that_the_user_has_drawn(open_user: Open) -> None:
    user = open_user(size=(1920, 1080), whole=True)
    user.window.show_task("kine")
    rest(user.window, 1.0)
    user.drag_width("stack", 700)
    for act in (lambda: user.choose("Make", "Motion table"), lambda: user.window.docks["findings"].close()):
        act()
        rest(user.window, 1.0)
        assert user.window.docks["motion"].isVisible()
        assert user.window.docks["motion"].width() == pytest.approx(700, abs=2)
        assert unreadable(user.window) == []
    user.choose("View", "Reset layout")
    rest(user.window, 1.0)
    assert user.window.docks["stack"].width() == pytest.approx(0.28 * 1920, abs=2)


@pytest.mark.stress
def test_docks_dropped_elsewhere_stay_there_and_can_be_read_in_every_size(open_user: Open) -> None:
    """The parameters at the left, as a drop with the mouse leaves them."""
    user = open_user(size=SIZES[1], whole=True)
    window = user.window
    window.show_task("kine")
    rest(window, 1.0)
    parameters = window.docks["parameters"]
    window.addDockWidget(LEFT, parameters)
    for size in (*SIZES, SIZES[1]):
        window.resize(*size)
        window.show_task("dyna")
        window.show_task("kine")
        window.show_view("explain")
        rest(window, 1.0)
        assert unreadable(window, "explain") == []
        assert parameters.geometry().left() == 0
        assert window.size().toTuple() == size
    user.choose("View", "Reset layout")
    rest(window, 1.0)
    assert parameters.geometry().right() == SIZES[1][0] - 1
