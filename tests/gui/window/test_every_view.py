"""Every view with every kind of design: it shows it, or says in words why not. Qt's and Python's complaints fail a test."""

import pytest
from PySide6.QtCore import Qt
from sampled import spread
from window_user import Open, settle

from core.project import load
from kindyna_gui.places import example
from kindyna_gui.window.docks import VIEWS

KINDS = ("transfer_lift", "four_bar_coupler_cam", "transfer_unit")
SIDES = sorted({row.area for row in VIEWS.values()}, key=lambda area: area.name)
AREAS = {area: [name for name, row in VIEWS.items() if row.area == area] for area in SIDES}


@pytest.mark.parametrize("area", spread(list(AREAS), 1), ids=lambda area: area.name)
def test_views_follow_from_kind_to_kind(open_user: Open, area: Qt.DockWidgetArea) -> None:
    """Those of one side of the window, one after the other; where they stand in front of each other, those behind catch up."""
    user = open_user()
    for kind in KINDS:  # and back to the first by undo
        user.session.put_full_design(load(example(kind)), f"Take {kind}")
        user.session.end_gesture()
        for name in AREAS[area]:
            view = user.window.show_view(name)
            settle()
            view.pull()
            user.turn(75.0)
            assert view.up_to_date, f"{name} with {kind}"
            if view.in_trouble:
                assert view.is_unavailable, f"{name} with {kind}: a fault is shown where there is none"
            assert not view.grab().toImage().isNull()
    while user.session.stack.canUndo():
        user.session.stack.undo()
        settle()
    for name in AREAS[area]:
        user.window.view(name).pull()
    assert user.session.full_design == load(example(KINDS[0]))
