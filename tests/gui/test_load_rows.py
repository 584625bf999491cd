"""Dyna > Add to the loads, Take from the loads: masses, springs and forces of any design by mouse and keys."""

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt
from window_user import Open, User

from core.design import get
from kindyna_gui.labels import heading_of
from kindyna_gui.places import example


def add(user: User, entry: str) -> None:
    """A row more, placed as it comes."""
    user.choose("Dyna", "Add to the loads", entry)
    if user.drawing().picker.active:
        user.press(Qt.Key.Key_Return)


def test_a_four_bar_gets_a_mass_a_spring_and_a_load_by_the_menu(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    before = user.window.session.design
    for entry in ("Mass", "Spring and damper", "Process force"):
        add(user, entry)
    user.enter("loads.springs[0].rate_n_per_mm", "7.5")
    design = user.window.session.design
    assert get(design, "loads.springs[0].rate_n_per_mm") == 7.5
    assert (len(design.drive.loads.springs), len(design.drive.loads.process)) == (1, 1)
    assert len(design.drive.loads.masses) == len(before.drive.loads.masses) + 1
    user.choose("Dyna", "Take from the loads", "Spring 1")
    assert user.window.session.design.drive.loads.springs == ()
    for _ in range(5):
        user.window.session.stack.undo()
    assert user.window.session.design == before


def test_a_follower_has_springs_and_friction_but_no_list_of_masses(same_window: Open) -> None:
    user = same_window(example("rocker_cam"))
    add(user, "Friction")
    assert user.window.session.design.drive.loads.pair_friction[0].pair == "pivot"
    user.choose("Dyna", "Take from the loads", "Friction at pivot")


def test_the_form_shows_what_can_be_given(same_window: Open) -> None:
    user = same_window(example("slider_crank"))
    for _ in range(4):
        add(user, "Friction")
    shown = [path for path in user.parameters().forms["loads"].fields if "pair_friction" in path]
    assert [path.rpartition(".")[2] for path in shown if "[0]" in path] == ["coefficient", "radius_mm"]
    assert [path.rpartition(".")[2] for path in shown if "[3]" in path] == ["coefficient", "length_mm"]
    add(user, "Process force")
    add(user, "Spring and damper")
    paths = [path for path in user.parameters().forms["loads"].fields if "process" in path or "springs" in path]
    heads = {heading_of(user.design, path) for path in paths}
    assert heads == {"Process force 1", "Spring 1", "Spring 1, from"}


def test_a_spring_is_drawn_between_its_ends_and_stretches(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    add(user, "Spring and damper")
    scene = user.drawing().scene
    lengths = []
    for degrees in (0.0, 90.0):
        study = user.turn(degrees)
        item = scene.parts["spring.spring1"].item
        here = study.at_theta(np.deg2rad([degrees])).linkage.bodies["link4"].place("B")[0]
        ends = [item.mapToScene(QPointF(x, 0.0)) for x in (0.0, 1.0)]
        assert (ends[0].x(), ends[0].y()) == pytest.approx((-50.0, -50.0))
        assert complex(ends[1].x(), ends[1].y()) == pytest.approx(1e3 * complex(here), abs=1e-6)
        lengths.append(abs(here))
    assert lengths[0] != pytest.approx(lengths[1])
