"""A point on a link shows its path at once: while it is drawn and after, also before anything drives."""

from __future__ import annotations

import numpy as np
import pytest
from pen import CTRL, Key, Pen, four_bar, start
from PySide6.QtCore import QPointF
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication, QMenu
from window_user import Open, plain, settle

from core.output.drawing.palette import BLUE
from core.study import Study
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.window.finder import Finder


def trace(pen: Pen) -> str:
    """A point on the rod, by the tool; its name."""
    pen.key(Key.Key_T)
    pen.click((pen.places["A"] + pen.places["B"]) / 2.0)
    pen.type("45", "40")
    return list(pen.shape(3))[-1]


def off(pen: Pen, name: str, at: complex) -> float:
    """Distance of a position from the drawn path of a point [mm]."""
    return float(np.abs(pen.user.drawing().drawing.paths.drawn()[name].positions - at).min())


def seen(pen: Pen) -> int:
    """How many pixels of the drawing have the colour of a path."""
    image = pen.canvas.grab().toImage().convertToFormat(QImage.Format.Format_RGB32)
    values = np.frombuffer(image.constBits(), np.uint32).reshape(image.height(), -1) & 0xFFFFFF
    return int((values == int(SCREEN.seen(BLUE)[1:], 16)).sum())


def test_a_new_linkage_opens_in_compo(open_user: Open) -> None:
    user = open_user(whole=True)
    user.window.show_task("graph")
    user.choose("File", "New by type", "Linkage by drawing")
    assert user.window.layouts.current == "compo"
    assert user.action("Compo", "Draw").isChecked()
    assert user.drawing().draws


def test_a_traced_point_shows_its_path_while_drawing_and_after(open_user: Open) -> None:
    pen = four_bar(open_user)
    before = seen(pen)
    name = trace(pen)
    path = pen.user.drawing().drawing.paths.drawn()[name]
    study = Study(pen.design, 360).linkage
    true = study.bodies["link3"].position(name) * 1e3
    assert path.is_driven
    assert max(np.abs(path.positions - at).min() for at in true) < 1.0
    assert seen(pen) > 2 * before
    pen.key(Key.Key_Escape)
    pen.key(Key.Key_Escape)
    view = pen.user.drawing()
    assert not view.draws
    assert view.scene.item(f"coupler.{name}").isVisible()
    assert not view.scene.layer_selected("coupler")
    assert not view.scene.item("coupler.A").isVisible()
    with_path = view.picture(".svg")
    view.paths.toggle(name)
    assert len(view.picture(".svg")) < len(with_path), "the copied picture shows what is seen"


def test_before_anything_drives_the_path_is_dotted(open_user: Open) -> None:
    """Three bars between two pivots, none of which drives; and a crank with a loose rod."""
    pen = start(open_user)
    pen.drag(0j, 30j)
    pen.drag("B", 80 + 70j)
    pen.key(Key.Key_T)
    pen.click((pen.places["B"] + pen.places["C"]) / 2.0)
    pen.type("40", "30")
    paths = pen.user.drawing().drawing.paths
    assert paths.drawn() == {}, "it can be moved anywhere"
    pen.key(Key.Key_G)
    pen.click("A")
    assert not paths.drawn()["D"].is_driven
    assert off(pen, "D", pen.places["D"]) < 3.0
    pen.key(Key.Key_B)
    pen.drag("C", 100 + 0j)
    pen.key(Key.Key_G)
    pen.click(100 + 0j)
    assert pen.user.session.typed.drive.linkage.driver.link == 1
    path = paths.drawn()["D"]
    assert not path.is_driven
    assert np.ptp(path.positions.imag) > 20.0
    assert off(pen, "D", pen.places["D"]) < 2.0
    pen.key(Key.Key_R)
    pen.click(15j)
    assert paths.drawn()["D"].is_driven


def entry(menu: QMenu, text: str) -> object:
    return next(action for action in menu.actions() if plain(action.text()) == text)


def test_show_path_is_in_the_menu_of_a_point(open_user: Open) -> None:
    """While drawing and after; it shows the path of a pin too, and hides that of a traced point."""
    pen = four_bar(open_user)
    name = trace(pen)
    drawing = pen.user.drawing().drawing
    transform = pen.canvas.viewportTransform()
    for point, was in ((name, True), ("A", False)):
        menu = drawing.menu_at(transform.map(QPointF(pen.places[point].real, pen.places[point].imag)))
        action = entry(menu, "Show path")
        assert action.isChecked() is was
        action.trigger()
        assert (point in drawing.paths.drawn()) is not was
    pen.key(Key.Key_Escape)
    pen.key(Key.Key_Escape)
    view = pen.user.drawing()
    assert view.scene.item("coupler.A").isVisible()
    assert not view.scene.item(f"coupler.{name}").isVisible()
    for target in (name, "A"):
        at = view.scene.geometry.handles(view.scene.index)[target]
        view.canvas.menu_requested.emit(at, view.canvas.mapToGlobal(view.canvas.rect().center()))
        settle()
        menu = QApplication.activePopupWidget()
        assert isinstance(menu, QMenu)
        shown = view.scene.item(f"coupler.{target}").isVisible()
        action = entry(menu, "Show path")
        assert action.isChecked() is shown
        action.trigger()
        menu.close()
        settle()
        assert view.scene.item(f"coupler.{target}").isVisible() is not shown


@pytest.mark.parametrize("words", ["path", "trace", "coupler curve"])
@pytest.mark.stress
def test_the_path_of_a_point_is_found_by_its_words(open_user: Open, words: str) -> None:
    pen = four_bar(open_user)
    name = trace(pen)
    pen.user.drawing().paths.toggle(name)
    pen.key(Key.Key_K, CTRL)
    finder = pen.user.window.findChild(Finder)
    finder.line.insert(words)
    settle()
    titles = [match.title for match in finder.shown]
    assert f"Path of {name}" in titles
    next(match for match in finder.shown if match.title == f"Path of {name}").act()
    assert name in pen.user.drawing().drawing.paths.drawn()


@pytest.mark.stress
def test_links_have_one_colour_in_both_modes(open_user: Open) -> None:
    """Also after another link has been deleted."""
    pen = start(open_user)
    pen.drag(-60 + 0j, -60 + 40j)
    pen.key(Key.Key_G)
    pen.click(0j)
    pen.click(100 + 0j)
    pen.key(Key.Key_B)
    pen.drag("O1", 30j)
    pen.drag("C", 80 + 70j)
    pen.drag("D", "O2")
    pen.key(Key.Key_Escape)
    pen.click(-60 + 20j)
    pen.key(Key.Key_Delete)
    pen.click(-60 - 40j)

    def colours() -> dict[int, str]:
        image, ratio = pen.canvas.grab().toImage(), pen.canvas.devicePixelRatioF()
        bars = {n: [pen.places[name] for name in pen.shape(n)] for n in (3, 4, 5)}
        return {n: image.pixelColor(pen.at(0.35 * a + 0.65 * b) * ratio).name() for n, (a, b) in bars.items()}

    pen.user.choose("View", "Fit drawing")
    drawn = colours()
    pen.key(Key.Key_Escape)
    assert not pen.user.drawing().draws
    assert colours() == drawn
    assert len(set(drawn.values())) == 3
