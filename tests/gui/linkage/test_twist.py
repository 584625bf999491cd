"""The flexible shaft in the drawing: pulley, spring and cam, with the twist made visible and its scale stated."""

import re

import numpy as np
import pytest
from window_user import Open, User, settle, wait_for

from core.study import Study
from kindyna_gui.linkage.mechanism_view import MechanismView
from kindyna_gui.pictures.drawing.parts import magnification
from kindyna_gui.places import example

LAYER = "Flexible shaft and its twist"


def stated(view: MechanismView) -> tuple[float, float]:
    """Twist [deg] and how many times as large it is drawn, by the sentence in the drawing."""
    text = view.scene.item("twist.text").text.replace("\u2212", "-")  # type: ignore[attr-defined]
    found = re.fullmatch(r"Twist (\S+)°, drawn (\S+) × as large", text)
    assert found is not None, text
    return float(found[1]), float(found[2])


def test_the_pulley_goes_ahead_of_the_cam_as_the_shaft_twists(open_user: Open) -> None:
    user: User = open_user(example("kim_1990"))
    view = user.window.show_view("mechanism")
    assert isinstance(view, MechanismView)
    action = next(each for each in view.layer_actions() if each.text() == LAYER)
    assert "twist.pulley" not in view.scene.parts, "not made before it is asked for"
    action.trigger()
    wait_for(lambda: "twist.pulley" in view.scene.parts)
    turn = user.session.study.steady_turn
    for degrees in (58, 122, 300):
        user.window.player.set_theta(np.deg2rad(degrees))
        settle()
        twist, times = stated(view)
        cam, pulley = (view.scene.item(f"twist.{name}").rotation() for name in ("cam", "input"))
        assert cam == pytest.approx(degrees)
        assert times == 20.0
        true = (pulley - cam) / times
        assert twist == pytest.approx(true, rel=1e-2)
        assert np.rad2deg(turn.wind_up(np.deg2rad([cam + true]))) == pytest.approx(true, abs=1e-9), "of the input there"
    user.session.edit("shaft.stiffness_nm_per_rad", 850.0, "Change stiffness")
    wait_for(lambda: view.up_to_date and "being calculated" not in view.scene.item("twist.text").text)  # type: ignore[attr-defined]
    assert stated(view)[1] > 20.0
    largest = np.rad2deg(Study(user.session.design).steady_turn.wind_up_range.high.value)
    assert 10.0 < largest * stated(view)[1] <= 30.0
    user.session.edit("shaft.stiffness_nm_per_rad", 31000.0, "Change stiffness")
    wait_for(lambda: view.scene.item("twist.text").text.startswith("The flexible shaft has no steady"))  # type: ignore[attr-defined]
    action.trigger()
    wait_for(lambda: not view.scene.item("twist.text").isVisible())


def test_a_twist_that_is_seen_as_it_is_is_not_drawn_larger() -> None:
    assert [magnification(np.array([0.0, -most])) for most in (0.0, 0.02, 1.02, 17.0, 90.0)] == [
        1.0,
        1000.0,
        20.0,
        1.0,
        1.0,
    ]


def test_a_rigid_shaft_has_no_such_layer(user: User) -> None:
    view = user.window.show_view("mechanism")
    assert isinstance(view, MechanismView)
    assert LAYER not in [each.text() for each in view.layer_actions()]
