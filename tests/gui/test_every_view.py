"""Every view with every kind of design: it shows it, or says in words why not. Qt's and Python's complaints fail a test."""

from pathlib import Path

import pytest
from window_user import Open, settle

from core.project import load
from kindyna_gui.places import example
from kindyna_gui.window.docks import VIEWS

KINDS = ("transfer_lift", "lecture_six_bar", "four_bar_coupler_cam")


@pytest.mark.parametrize("name", VIEWS)
def test_a_view_follows_from_kind_to_kind(open_user: Open, name: str, tmp_path: Path) -> None:
    user = open_user()
    for kind in (*KINDS, KINDS[0]):
        user.session.put(load(example(kind)), f"Take {kind}")
        user.session.end_gesture()
        view = user.window.show_view(name)
        settle()
        view.pull()
        for degrees in (75.0, 359.0):
            user.window.player.set_theta(degrees / 57.29577951308232)
            settle()
        assert view.up_to_date
        if view.in_trouble:
            assert view.not_here, f"{name} with {kind}: a fault is shown where there is none"
        assert not view.grab().toImage().isNull()
    while user.session.stack.canUndo():
        user.session.stack.undo()
        settle()
        view.pull()
    assert user.design == load(example(KINDS[0]))
