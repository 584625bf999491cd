"""kindyna_gui.window.docks: docks keep their part of the window when it shrinks and grows."""

import pytest
from window_user import Open, User, settle

from kindyna_gui.window.docks import LEFT
from kindyna_gui.window.tasks import TASKS

NAMES = ("parameters", "displacement", "pressure_angle", "torque", "findings")


def sizes(user: User) -> dict[str, tuple[int, int]]:
    return {name: user.window.docks[name].size().toTuple() for name in NAMES}


def resize(user: User, width: int, height: int) -> None:
    user.window.resize(width, height)
    for _ in range(3):
        settle()


@pytest.fixture
def user(open_user: Open) -> User:
    """With forms on the right, plots on the left, and findings below."""
    made = open_user(size=(1440, 900), whole=True)
    made.choose("View", "Graph")
    for name in NAMES:
        made.window.show_view(name)
    for _ in range(3):
        settle()
    return made


def near(one: dict[str, tuple[int, int]], other: dict[str, tuple[int, int]]) -> bool:
    return all(abs(a - b) <= 2 for name in NAMES for a, b in zip(one[name], other[name], strict=True))


@pytest.mark.stress
def test_a_window_that_shrinks_and_grows_again_looks_as_before(user: User) -> None:
    before = sizes(user)
    for way in ([(1024, 640)], [(1280, 720), (1000, 700)], [(1800, 1000), (1000, 640), (1300, 800)]):
        for width, height in way:
            resize(user, width, height)
            assert sizes(user)["displacement"] != before["displacement"]
        resize(user, 1440, 900)
        assert near(sizes(user), before)


def test_plots_take_their_part_of_a_larger_window_and_forms_what_they_need(user: User) -> None:
    before = sizes(user)
    resize(user, 1900, 1000)
    after = sizes(user)
    assert after["displacement"][0] == pytest.approx(TASKS["graph"].sides[LEFT].part * 1900, abs=2)
    assert after["parameters"][0] == before["parameters"][0]
    assert after["findings"][1] == before["findings"][1]


@pytest.mark.stress
def test_a_width_that_the_user_has_drawn_is_kept(user: User) -> None:
    dock = user.window.docks["pressure_angle"]
    drawn = dock.width() + 100
    user.drag_width("pressure_angle", drawn)
    assert dock.width() == pytest.approx(drawn, abs=1)
    resize(user, 1100, 700)
    assert dock.width() < drawn
    resize(user, 1440, 900)
    assert dock.width() == pytest.approx(drawn, abs=2)


@pytest.mark.stress
def test_another_dock_is_no_reason_to_move_the_others(user: User) -> None:
    resize(user, 1200, 760)
    before = sizes(user)["parameters"][0]
    user.window.docks["torque"].hide()
    settle()
    user.window.docks["torque"].show()
    for _ in range(3):
        settle()
    assert sizes(user)["parameters"][0] == before


@pytest.mark.stress
def test_the_first_layout_comes_back_from_the_menu(user: User) -> None:
    names = ("displacement", "pressure_angle", "findings")
    user.choose("View", "Kine")
    for _ in range(3):
        settle()

    def widths() -> list[int]:
        return [user.window.docks[name].width() for name in names]

    before = widths()
    user.drag_width("findings", 560)
    for _ in range(3):
        settle()
    assert user.window.docks["findings"].width() == 560
    user.choose("View", "Reset layout")
    for _ in range(3):
        settle()
    assert widths() == before
    resize(user, 1100, 700)
    resize(user, 1440, 900)
    assert widths() == before
