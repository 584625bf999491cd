"""Dyna > Keeping contact: the map of the contact force and the flights are the core's, computed while they can be seen."""

import math

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from window_user import Open, User, end_pauses, settle, wait_for

from core.project import load
from core.study import Study
from kindyna_gui.graph.flywheel_view import ContactView
from kindyna_gui.places import example


@pytest.fixture
def open_user(same_window: Open) -> Open:
    return same_window


def rested(view: ContactView) -> ContactView:
    wait_for(lambda: view.up_to_date and not view.busy)
    return view


def see(user: User) -> ContactView:
    user.choose("Dyna", "Keeping contact")
    view = user.window.view("contact")
    assert isinstance(view, ContactView)
    return rested(view)


def test_the_map_and_the_flight_are_shown(open_user: Open) -> None:
    user = open_user(example("rocker_cam"))
    view = see(user)
    found = Study(user.design).lift_off
    assert found is not None
    rpm = found.omega * 30.0 / math.pi
    assert f"it leaves the cam at {rpm:.4g} rpm and above" in view.text.text()
    zero = np.concatenate([y for _, y in view.plot.lines[1:]])
    assert rpm == pytest.approx(np.nanmin(zero), rel=1e-3)
    user.session.edit("shaft.speed_rpm", 1500.0, "Speed")
    user.session.end_gesture()
    rested(view)
    view.page.setFocus()
    QTest.keyClick(view.page, Qt.Key.Key_Down)
    settle()
    rested(view)
    flights = Study(user.design).flights()
    assert f"Lift-off at {math.degrees(flights.flights[0].lift):.2f}°" in view.text.text()
    assert f"{len(flights.flights)} flights per turn" in view.text.text()
    (x, y), way = view.plot.lines[0], view.plot.lines[1]
    assert way[0][0] == pytest.approx(math.degrees(flights.flights[0].lift))
    above = np.rad2deg(flights.flights[0].y) - np.interp(way[0], x, y)
    assert above.max() == pytest.approx(math.degrees(flights.flights[0].height), rel=1e-2)
    user.window.docks["contact"].hide()
    user.session.edit("shaft.speed_rpm", 300.0, "Speed")
    user.session.end_gesture()
    end_pauses()
    assert not view.busy
    see(user)
    assert "stays on the cam" in view.plot.message
    user.session.put(load(example("groove")), "Take the groove")
    wait_for(lambda: view.in_trouble)
    user.session.put(load(example("four_bar")), "Take the four-bar")
    wait_for(lambda: view.is_unavailable)


def test_a_pinned_variant_is_in_the_map_and_in_the_flight(open_user: Open) -> None:
    user = open_user(example("rocker_cam"))
    user.session.edit("shaft.speed_rpm", 1500.0, "Speed")
    user.choose("Edit", "Pin this variant")
    found = Study(user.design).lift_off
    assert found is not None
    user.session.edit("loads.spring_rate_nm_per_rad", 90.0, "Spring")
    user.session.end_gesture()
    view = see(user)
    QTest.keyClick(view.page, Qt.Key.Key_Home)
    rested(view)
    zero = [line for line in view.plot.shown if line.reference]
    assert {line.reference for line in zero} == {"variant 1"}
    assert min(np.nanmin(line.y) for line in zero) == pytest.approx(found.omega * 30.0 / math.pi, rel=1e-3)
    assert "variant 1" in view.plot.legend.text
    view.page.setFocus()
    QTest.keyClick(view.page, Qt.Key.Key_Down)
    rested(view)
    assert {line.reference for line in view.plot.shown} == {"", "variant 1"}
