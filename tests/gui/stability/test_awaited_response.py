"""kindyna_gui.background: a steady response that takes long is looked for beside the window, shown once it is known, and given up."""

from collections.abc import Iterator
from time import sleep
from typing import Any

import numpy as np
import pytest
from plot_reading import curves
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from window_user import Open, User, settle, wait_for

from core.numerics.lazy import checkpoint
from core.stability import stage
from core.stability.steady import steady_turn
from core.study.stages import memory
from kindyna_gui.pictures.items import Tag
from kindyna_gui.places import example


class Search:
    """A search for a steady response that does not end before it is let go, or cancelled."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.found, self.begun, self.ended = False, 0, 0
        true = steady_turn

        def search(*arguments: Any) -> Any:
            self.begun += 1
            try:
                while not self.found:
                    checkpoint()
                    sleep(0.001)
            finally:
                self.ended += 1
            return true(*arguments)

        monkeypatch.setattr(stage, "steady_turn", search)


@pytest.fixture
def search(monkeypatch: pytest.MonkeyPatch) -> Iterator[Search]:
    memory.clear()
    yield Search(monkeypatch)
    memory.clear()


@pytest.fixture
def kim(open_user: Open, search: Search) -> User:
    user: User = open_user(example("kim_1990"))
    return user


def click(widget: QWidget) -> None:
    QTest.mouseClick(widget, Qt.MouseButton.LeftButton)
    settle()


def message(user: User) -> str:
    """In the plot of a graph."""
    graph: Any = user.window.view("graph")
    return " ".join(
        tag.text for tag in graph.panels[-1].plot.items() if isinstance(tag, Tag) and tag.isVisible()
    ).replace("\n", " ")


def test_a_graph_waits_for_the_steady_response_and_the_window_does_not(kim: User, search: Search) -> None:
    graph: Any = kim.see("graph")
    graph.tree.item_of("wind_up").setCheckState(0, Qt.CheckState.Checked)
    wait_for(lambda: search.begun == 1)
    assert "the steady response is being calculated" in message(kim)
    assert graph.up_to_date
    cancel = kim.window.status.pending
    assert (cancel.text(), cancel.isVisible()) == ("Stop calculating the steady response", True)
    click(cancel)
    wait_for(lambda: search.ended == 1)
    assert "the steady response was cancelled" in message(kim)
    kim.turn(40.0)
    graph.tree.item_of("velocity").setCheckState(0, Qt.CheckState.Unchecked)
    settle()
    assert search.begun == 1, "it is not begun again by what else is done"

    assert cancel.text() == "Calculate again"
    click(cancel)
    wait_for(lambda: search.begun == 2)
    assert "is being calculated" in message(kim)
    search.found = True
    wait_for(lambda: not cancel.isVisible())
    (curve,) = curves(graph.panels[-1].plot)
    assert float(np.ptp(curve.y)) > 0.0


@pytest.mark.stress
def test_a_drawing_waits_for_its_twist_and_another_design_ends_the_search(kim: User, search: Search) -> None:
    drawing = kim.drawing()
    drawing.show_layer("twist", True)
    wait_for(lambda: search.begun == 1)
    text = drawing.scene.item("twist.text")
    assert isinstance(text, Tag)
    assert text.text == "The steady response is being calculated"
    search.found = True
    wait_for(lambda: "twist.spring" in drawing.scene.parts)
    search.found = False
    kim.enter("shaft.speed_rpm", "300")
    wait_for(lambda: search.begun == 2)
    kim.session.stack.setClean()
    kim.window.documents.open_path(example("transfer_lift"))
    wait_for(lambda: search.ended == search.begun)
    assert not kim.window.status.pending.isVisible()
