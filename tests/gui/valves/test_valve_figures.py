"""Compo > Valve figures: the figures of the command valve for both valves, which follow every edit."""

from pathlib import Path

import pytest
from window_user import Open, User, wait_for

from core.valves import LIFTS, valve_data, valve_timings
from kindyna_gui.settings import choose
from kindyna_gui.valves.figures import ValveFiguresView

EXAMPLE = Path(__file__).parents[3] / "resources" / "examples" / "valve_train.toml"


@pytest.fixture
def user(same_window: Open) -> User:
    return same_window(EXAMPLE)


def table(view: ValveFiguresView) -> dict[str, tuple[str, str]]:
    rows = view.table.rows
    cells = [[str(rows.data(rows.index(r, c))) for c in range(3)] for r in range(rows.rowCount())]
    return {label: (inlet, exhaust) for label, inlet, exhaust in cells}


def opened(user: User) -> ValveFiguresView:
    user.choose("Compo", "Valve figures")
    view = user.see("valve_figures")
    assert isinstance(view, ValveFiguresView)
    return view


def test_the_figures_are_those_of_the_command(user: User) -> None:
    view = opened(user)
    shown, data = table(view), valve_data(valve_timings(user.session.full_design), LIFTS)
    valves = data["valves"]
    assert shown["Duration, lobe, 0.050 in"] == ("210.0°", "206.0°")
    assert shown["Opens, lobe, 0.050 in"] == ("3.0° ATDC", "33.0° BBDC")
    at_1_mm = [
        event["duration_deg"]
        for v in valves
        for event in v["events"]
        if (event["of"], event["at_mm"]) == ("valve", 1.0)
    ]
    assert shown["Duration, valve, 1 mm"] == tuple(f"{value:.1f}°" for value in at_1_mm)
    assert shown["Left to coil bind"] == ("5.52 mm", "6.08 mm")
    assert shown["Float speed, engine"] == tuple(f"{v['float_rpm']:.0f} rpm" for v in valves)
    assert shown["Piston clearance"] == tuple(f"{v['clearance']['least_mm']:.3g} mm" for v in valves)
    assert shown["Separation"][0] == "109.0°"
    assert view.answer.text().startswith("Clearance to the piston 4.86 mm, left to coil bind 5.52 mm, float speed")


def test_another_centre_moves_overlap_and_clearance(user: User) -> None:
    view = opened(user)
    before = table(view)
    assert user.session.edit("valve.centre_deg", 100.0, "Change centre")
    wait_for(lambda: view.up_to_date)
    after = table(view)
    assert after["Separation"][0] == "105.0°"
    assert after["Overlap, lobe, 0.050 in"][0] == "−2.0°"
    assert after["Duration, lobe, 0.050 in"] == before["Duration, lobe, 0.050 in"]
    assert after["Piston clearance"][0] != before["Piston clearance"][0]
    assert after["Piston clearance"][1] == before["Piston clearance"][1]


def test_a_valve_that_hits_the_piston_is_the_first_word(user: User) -> None:
    view = opened(user)
    assert user.session.edit("valve.clearance_mm", 0.5, "Change clearance")
    wait_for(lambda: view.up_to_date)
    assert view.answer.text().startswith("Inlet: clearance to the piston −0.64")


def test_a_design_without_valves_says_what_to_do(same_window: Open) -> None:
    view = opened(same_window())
    assert view.no_picture.startswith("No drive of this design moves a valve.")


def test_the_overlap_area_is_in_the_preferred_unit(user: User) -> None:
    millimetres = float(table(opened(user))["Overlap area"][0].split()[0])
    choose({"length": "in"}, comma=False)
    try:
        inches, unit = table(opened(user))["Overlap area"][0].split()
    finally:
        choose({}, comma=False)
    assert unit == "in·°"
    assert float(inches) == pytest.approx(millimetres / 25.4, rel=1e-3)
