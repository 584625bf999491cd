"""Forces that are seen: vectors on the mechanism and polygons of forces, held against the channels; computed only while drawn."""

import math

import numpy as np
import pytest
from window_user import Open, User, settle, wait_for

from core.output.channels import channel
from core.study import Study, evaluations
from kindyna_gui.linkage.mechanism_view import MechanismView
from kindyna_gui.linkage.polygon_view import PolygonView
from kindyna_gui.places import example

ANGLES = (20.0, 55.0, 300.0)


def of(study: Study, *slugs: str) -> complex:
    """Two channels of a study of one angle as x and y."""
    x, y = (float(channel(study.design, slug).values(study)[0]) for slug in slugs)
    return complex(x, y)


def forces_on(user: User, body: str) -> PolygonView:
    """Chosen in the menu, then in the list."""
    user.choose("Dyna", "Force polygon")
    view = user.window.view("polygon")
    assert isinstance(view, PolygonView)
    view.choice.setCurrentText(body)
    wait_for(lambda: view.up_to_date and view.on_screen())
    return view


def test_the_forces_on_the_arm_close_a_polygon_of_the_channels(user: User) -> None:
    sheet = forces_on(user, "Forces on arm").sheet
    for degrees in ANGLES:
        study = user.turn(degrees)
        drawn, (value, pixels) = sheet.vectors(), sheet.scale_bar
        assert drawn["F_arm pin"][1] == pytest.approx(of(study, "arm_pin_x_n", "arm_pin_y_n"), rel=1e-9)
        assert drawn["F_pivot"][1] == pytest.approx(of(study, "pivot_x_n", "pivot_y_n"), rel=1e-9)
        assert drawn["F_cam"][1] == pytest.approx(of(study, "bearing_x_n", "bearing_y_n"), rel=1e-9)
        assert drawn["G_arm"][1] == pytest.approx(-714.0 * 9.80665j, rel=1e-12)
        ends = [start + vector.conjugate() * pixels / value for start, vector in drawn.values()]
        starts = [start for start, _ in drawn.values()]
        assert ends == pytest.approx([*starts[1:], starts[0]], abs=1e-6)
        assert sheet.values["F_pivot"].startswith(f"{abs(drawn['F_pivot'][1]) / 1e3:.4g}"[:4])
        assert "closed to" in sheet.detail


def test_the_force_in_a_pin_runs_along_its_curve(user: User) -> None:
    sheet = forces_on(user, "Force at pivot over the turn").sheet
    for degrees in ANGLES:
        study = user.turn(degrees)
        force = sheet.vectors()["F_pivot"][1]
        size, way = (float(channel(study.design, slug).values(study)[0]) for slug in ("pivot_n", "pivot_direction_deg"))
        assert force == pytest.approx(size * np.exp(1j * math.radians(way)), rel=1e-9)
        assert np.abs(sheet.curve - force).min() <= 0.02 * size, "beside one of the turn's samples"
        assert f"at {abs(way):.1f}".replace("-", "") in sheet.detail.replace("\u2212", "")


def test_a_linkages_forces_wait_until_they_are_chosen(open_user: Open) -> None:
    user = open_user(example("slider_crank"))
    user.choose("Compo", "Velocity polygon")
    view = user.window.view("polygon")
    assert isinstance(view, PolygonView)
    wait_for(lambda: view.up_to_date and view.on_screen())
    assert view.stages == ("linkage",)
    view.choice.setCurrentText("Forces on link 4")
    wait_for(lambda: view.up_to_date)
    assert "dynamics" in view.stages
    study = user.turn(70.0)
    drawn = view.sheet.vectors()
    assert drawn["F_B"][1] == pytest.approx(of(study, "B_x_n", "B_y_n") * (1.0 if study.linkage.pairs["B"].body == "link4" else -1.0))
    assert {key[0] for key in drawn} >= {"F", "P", "G", "\u2212"}
    assert sum(vector for _, vector in drawn.values()) == pytest.approx(0.0, abs=1e-10)


def test_vectors_on_the_mechanism_are_the_channels_to_the_scale_of_the_corner(user: User) -> None:
    view = user.window.view("mechanism")
    assert isinstance(view, MechanismView)
    evaluations.clear()
    user.session.edit("follower.rod_mm", 846.0, "Change rod")
    settle()
    for action in view.layer_actions():
        if action.text() in ("Forces", "Weight and inertia forces"):
            action.trigger()
    settle()
    scene, scales = view.scene, []
    assert scene.overlay is not None
    assert [arrow.isVisible() for arrow in scene.overlay.vectors.values()] == [True, False], "one scale for both"
    for degrees in ANGLES:
        user.turn(degrees)
        study = scene.geometry.study.at_theta(scene.geometry.study.theta[scene.index : scene.index + 1])  # type: ignore[union-attr]
        forces = {"forces.pivot": "pivot", "forces.arm_pin": "arm_pin", "forces.bearing": "bearing"}
        drawn = {key: scene.item(key).path() for key in (*forces, "inertia.weight.arm")}  # type: ignore[attr-defined]
        for key, name in forces.items():
            start, tip = (drawn[key].elementAt(i) for i in (0, 3))
            vector = complex(tip.x - start.x, tip.y - start.y)
            scales.append(vector / of(study, f"{name}_x_n", f"{name}_y_n"))
        start, tip = (drawn["inertia.weight.arm"].elementAt(i) for i in (0, 3))
        scales.append(complex(tip.x - start.x, tip.y - start.y) / (-714.0 * 9.80665j))
    assert scales == pytest.approx([scales[0]] * len(scales), rel=1e-6), "one scale over the turn"
    assert scales[0].real > 0.0
    assert abs(scales[0].imag) < 1e-6 * scales[0].real
