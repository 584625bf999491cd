"""Pictures of the window and each of its views, drawn without a display."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from math import pi
from typing import Any, Literal

import numpy as np
from PySide6.QtCore import QCoreApplication, QEvent
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication, QTabWidget, QWidget

from core.design import Design, only
from core.study import Study, extremes_of
from kindyna_gui.documents.session import Session
from kindyna_gui.linkage.mechanism_view import MechanismView
from kindyna_gui.look import apply_style
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.pictures.drawing.parts import TWIST, available_layers
from kindyna_gui.pictures.painter import image_bytes, png_bytes
from kindyna_gui.player import Player
from kindyna_gui.settings import Settings
from kindyna_gui.view import View
from kindyna_gui.window.docks import VIEWS
from kindyna_gui.window.main_window import MainWindow
from kindyna_gui.window.tasks import TASKS, task_with

ROUNDS = 4  # of events: shown, laid out, refreshed, drawn
PATIENCE, BREATH = 60.0, 0.005  # seconds
COLOURS, FREQUENT, NEAR = (
    256,
    4000,
    24,
)  # of a table; pixels whose colour remains; difference of 255 that is not noticed
VECTORS = ("velocities", "forces")


class NoSettings(Settings):
    """Settings of a new user: nothing is read or stored."""

    def __init__(self) -> None:
        self._store = _EmptyStore()  # type: ignore[assignment]


class _EmptyStore:
    def value(self, key: str, default: Any = None) -> Any:
        return default

    def setValue(self, key: str, value: Any) -> None:
        """Store nothing."""

    def sync(self) -> None:
        """Write nothing."""


def hidden_window(design: Design, size: tuple[int, int]) -> MainWindow:
    """Return a window with a design that is laid out and drawn, but not shown."""
    app = ensure_app(offscreen=True)
    apply_style(app)
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
    """Finish the pending work of a window without its pauses; background work may take ``patience`` [s]."""
    deadline = time.monotonic() + patience
    for _ in range(ROUNDS):
        _catch_up(window)
    while any([window.session.laws.busy, *(view.busy for view in _catch_up(window))]) and time.monotonic() < deadline:
        time.sleep(BREATH)  # for the other threads
    window.status.count_findings()
    QApplication.processEvents()


def _catch_up(window: MainWindow) -> list[View]:
    """Bring the views on the screen up to date, except for their background work, and return them."""
    QApplication.processEvents()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)  # needed without an event loop
    visible = [view for view in window.findChildren(View) if view.on_screen()]
    for view in visible:
        view.pull()
        view.settle()
    return visible


def png(widget: QWidget, small: bool = False) -> bytes:
    """Return a widget as PNG; ``small``: in few colours, a third of the bytes."""
    image = widget.grab().toImage()
    return small_file(image, "PNG") if small else png_bytes(image)


def webp(widget: QWidget) -> bytes:
    """Return a widget in few colours as WebP, a fifth of the bytes of a PNG."""
    return small_file(widget.grab().toImage(), "WEBP")


def small_file(image: QImage, kind: Literal["PNG", "WEBP"]) -> bytes:
    """Return an image in few colours as a file of the least size."""
    quality = {"PNG": 0, "WEBP": 100}[kind]  # of Qt: the most effort of zlib; without loss
    return image_bytes(few_colours(image), kind, quality)


def few_colours(image: QImage) -> QImage:
    """Return an image with at most 256 colours, without dither.

    The colours of areas and lines remain as they are. A colour that few pixels have, as those of smoothed edges, becomes the
    nearest more frequent colour where red, green and blue differ by no more than ``NEAR``.
    """
    image = image.convertToFormat(QImage.Format.Format_RGB32)
    pixels = np.frombuffer(image.constBits(), np.uint32).reshape(image.height(), -1)[:, : image.width()] & 0xFFFFFF
    values, index, counts = np.unique(pixels, return_inverse=True, return_counts=True)
    colours = np.stack([values >> shift & 255 for shift in (16, 8, 0)], axis=1).astype(int)
    table, entry = np.empty((0, 3), dtype=int), np.zeros(values.size, dtype=np.uint8)
    for i in np.argsort(-counts, kind="stable").tolist():
        distances = np.abs(table - colours[i]).max(axis=1, initial=0)
        is_full = len(table) == COLOURS
        if len(table) and (is_full or (counts[i] < FREQUENT and distances.min() <= NEAR)):
            entry[i] = distances.argmin()
        else:
            entry[i], table = len(table), np.vstack((table, colours[i]))
    rows = np.ascontiguousarray(entry[index].reshape(pixels.shape))
    result = QImage(rows.data, image.width(), image.height(), image.width(), QImage.Format.Format_Indexed8)
    result.setColorTable([0xFF000000 | r << 16 | g << 8 | b for r, g, b in table.tolist()])
    return result.copy()  # which owns its pixels


def picture_angle(study: Study) -> float:
    """Return the angle of the pictures [rad]: that of the largest pressure angle, or an eighth of a turn without a cam.

    Raises NoSolution where the motion or the cam has none.
    """
    if not study.has_disk:
        return float(study.theta[min(study.theta.size - 1, study.samples // 8)])
    angle: float = extremes_of(study, "cam", ("pressure_angle",))["pressure_angle"].high.theta
    return angle


def shots(design: Design, size: tuple[int, int]) -> dict[str, bytes]:
    """Return pictures by file name: the window as it opens and in each task, and each view.

    The angle is that of the largest pressure angle of the (first) drive. Raises NoSolution where the drive has none.
    """
    angle = picture_angle(Study(only(design, 0)))
    window = hidden_window(design, size)
    try:
        window.player.set_theta(round(angle * 180.0 / pi, 1) * pi / 180.0)
        rest(window)
        pictures = {"window.png": png(window, small=True)}  # of README and help
        for task in TASKS:
            window.show_task(task)
            rest(window)
            pictures[f"window_{task}.png"] = png(window)
        for name in VIEWS:
            window.show_task(task_with(name))
            view = window.show_view(name)
            rest(window)
            for ending in (_once if view.is_unavailable else FORMS.get(name, _once))(view):
                rest(window)
                pictures[f"{name}{ending}.png"] = png(view)
    finally:
        dismiss(window)
    return pictures


# -- forms of a view: each yields the ending of a picture's name, and the picture is taken after it ------------


def _once(view: View) -> Iterator[str]:
    yield ""


def _with_vectors(view: View) -> Iterator[str]:
    """Show the mechanism, then with velocities and forces, then with the twist of a flexible shaft."""
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
    """Show each page; the first without an ending, the others with their titles."""
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
"""Views with several pictures."""
