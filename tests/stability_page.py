"""The page of stability for tests of the window: how a user opens it, waits for it and points at its chart."""

from collections.abc import Iterator
from contextlib import contextmanager

from PySide6.QtCore import QPoint, Qt, QTimer
from window_user import User, wait_for

from kindyna_gui.places import example
from kindyna_gui.stability_view import StabilityView

KIM = example("kim_1990")
LEFT = Qt.MouseButton.LeftButton
TURNS = 3.0  # a shaft is followed from rest


def page(user: User, rest: bool = True) -> StabilityView:
    """The page as in the paper."""
    user.choose("Stability", "Chart")
    view = user.window.view("stability")
    assert isinstance(view, StabilityView)
    view.as_paper.setChecked(True)
    view.pages.show_page("Verdicts")
    wait_for(lambda: view.stability is not None)
    assert view.stability.turns == TURNS
    if rest:
        wait_for(lambda: not view.busy)
    return view


@contextmanager
def unhurried(view: StabilityView) -> Iterator[None]:
    """However slow the machine is, no pause of the user's ends meanwhile; what has begun by then ends as it usually does."""
    pauses = [each for each in view.findChildren(QTimer) if each.isSingleShot() and each.interval() > 0]
    usual = [each.interval() for each in pauses]
    for pause in pauses:
        pause.setInterval(60_000)
    yield
    for pause, interval in zip(pauses, usual, strict=True):
        pause.setInterval(interval)


def pixel(view: StabilityView, eta: float, q: float) -> QPoint:
    return view.chart.pixel(eta, q).toPoint()
