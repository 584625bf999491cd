"""The window and each of its views as pictures, drawn without a display."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from math import pi
from typing import Any

from PySide6.QtCore import QCoreApplication, QEvent, Qt
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication, QTabWidget, QWidget

from core.design import Design, only
from core.study import Study, extremes_of
from kindyna_gui.documents.session import Session
from kindyna_gui.linkage.mechanism_view import MechanismView
from kindyna_gui.look import dress
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.pictures.drawing.parts import TWIST, available_layers
from kindyna_gui.pictures.painter import png_bytes
from kindyna_gui.player import Player
from kindyna_gui.settings import Settings
from kindyna_gui.view import View
from kindyna_gui.window.docks import VIEWS
from kindyna_gui.window.main_window import MainWindow
from kindyna_gui.window.tasks import TASKS, task_with

ROUNDS = 4  # of events, after which nothing is left to do: shown, laid out, pulled, drawn
PATIENCE, BREATH = 60.0, 0.005  # seconds
FLAT = Qt.ImageConversionFlag.ThresholdDither | Qt.ImageConversionFlag.AvoidDither
VECTORS = ("velocities", "forces")


class NoSettings(Settings):
    """Settings of a window that nobody has used before: nothing is read, nothing is kept."""

    def __init__(self) -> None:
        self._kept = _Nothing()  # type: ignore[assignment]


class _Nothing:
    def value(self, key: str, default: Any = None) -> Any:
        return default

    def setValue(self, key: str, value: Any) -> None:
        """Forgotten."""

    def sync(self) -> None:
        """Nothing to write."""


def hidden_window(design: Design, size: tuple[int, int]) -> MainWindow:
    """A window with a design that nobody sees, laid out and drawn."""
    app = ensure_app(offscreen=True)
    dress(app)
    window = MainWindow(Session(design), Player(), NoSettings())
    window.resize(*size)
    window.show()
    rest(window)
    return window


def dismiss(window: MainWindow) -> None:
    """Close a hidden window without a question."""
    window.session.stack.setClean()
    window.close()
    window.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)


def rest(window: MainWindow, patience: float = PATIENCE) -> None:
    """Let the window finish its pending work, without its pauses; what is computed beside it may take ``patience`` [s]."""
    late = time.monotonic() + patience
    for _ in range(ROUNDS):
        _catch_up(window)
    while any(view.busy for view in _catch_up(window)) and time.monotonic() < late:
        time.sleep(BREATH)  # for the other threads
    window.status.count_findings()
    QApplication.processEvents()


def _catch_up(window: MainWindow) -> list[View]:
    """The views on the screen, up to date but for what is computed beside them."""
    QApplication.processEvents()
    QCoreApplication.sendPostedEvents(
        None, QEvent.Type.DeferredDelete.value
    )  # without a loop of events nothing else does
    seen = [view for view in window.findChildren(View) if view.on_screen()]
    for view in seen:
        view.pull()
        view.settle()
    return seen


def png(widget: QWidget, small: bool = False) -> bytes:
    """A widget as it stands on the screen; small: in 256 colours, a fifth of the bytes."""
    image = widget.grab().toImage()
    return png_bytes(image.convertToFormat(QImage.Format.Format_Indexed8, FLAT) if small else image)


def picture_angle(study: Study) -> float:
    """The angle of the pictures [rad]: where the pressure angle is largest; of a linkage without a cam an eighth of a turn.

    Raises NoSolution.
    """
    if "cam" not in study.stages:
        return float(study.theta[min(study.theta.size - 1, study.samples // 8)])
    top: float = extremes_of(study, "cam", ("pressure_angle",))["pressure_angle"].high.theta
    return top


def shots(design: Design, size: tuple[int, int]) -> dict[str, bytes]:
    """File name -> picture of the window, as it opens and in each task, and of each view, where the pressure angle is largest, of
    several drives that of the first.

    Raises NoSolution.
    """
    top = picture_angle(Study(only(design, 0)))
    window = hidden_window(design, size)
    try:
        window.player.set_theta(round(top * 180.0 / pi, 1) * pi / 180.0)
        rest(window)
        made = {"window.png": png(window)}
        for task in TASKS:
            window.show_task(task)
            rest(window)
            made[f"window_{task}.png"] = png(window)
        for name in VIEWS:
            window.show_task(task_with(name))
            view = window.show_view(name)
            rest(window)
            for ending in (_as_it_is if view.is_unavailable else FORMS.get(name, _as_it_is))(view):
                rest(window)
                made[f"{name}{ending}.png"] = png(view)
    finally:
        dismiss(window)
    return made


# -- what a view is to be shown as: endings of the pictures' names; the picture is taken after each ------------


def _as_it_is(view: View) -> Iterator[str]:
    yield ""


def _with_vectors(view: View) -> Iterator[str]:
    """The mechanism, and again with velocities and forces, and with a flexible shaft."""
    assert isinstance(view, MechanismView)
    yield ""
    for name in VECTORS:
        view.show_layer(name, True)
    yield "_vectors"
    for name in VECTORS:
        view.show_layer(name, False)
    if TWIST in available_layers(view.session.study):
        view.show_layer(TWIST, True)
        yield "_shaft"
        view.show_layer(TWIST, False)


def _tab_by_tab(view: View) -> Iterator[str]:
    """The first page as the view itself, the others by their titles."""
    tabs = view.findChild(QTabWidget)
    assert tabs is not None
    pages = [page for page in range(tabs.count()) if tabs.isTabVisible(page)]
    for page in pages:
        tabs.setCurrentIndex(page)
        yield f"_{tabs.tabText(page).lower()}" if page != pages[0] else ""
    tabs.setCurrentIndex(pages[0])


def _straight_and_polar(view: View) -> Iterator[str]:
    from kindyna_gui.graph.graph_view import FORMS as GRAPHS
    from kindyna_gui.graph.graph_view import GraphView

    assert isinstance(view, GraphView)
    for form in GRAPHS:
        view.set_form(form)
        yield "" if form == "straight" else f"_{form}"
    view.set_form("straight")


FORMS: dict[str, Callable[[View], Iterator[str]]] = {
    "mechanism": _with_vectors,
    "parameters": _tab_by_tab,
    "graph": _straight_and_polar,
    "centres": _tab_by_tab,
}
"""Views that are taken more than once."""
