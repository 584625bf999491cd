"""Theme and size of letters: what is open changes where it stands, as if it had been opened so; pictures stay light."""

import re
from collections.abc import Iterator

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QObject, QPointF, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QApplication,
    QComboBox,
    QDialogButtonBox,
    QLabel,
    QLineEdit,
    QPushButton,
    QToolButton,
    QWidget,
)
from window_user import Open, User, answering, settle

from kindyna_gui import settings
from kindyna_gui.look import apply_preferences
from kindyna_gui.pictures.plots.plot import FixedPlot
from kindyna_gui.places import example
from kindyna_gui.saving import copy_picture
from kindyna_gui.screenshots import rest
from kindyna_gui.settings import in_file_units
from kindyna_gui.view import View
from kindyna_gui.window.preferences_dialog import PreferencesDialog

DARK = settings.Preferences(theme="dark")
TASKS = ("make", "dyna")
SEEN = 24  # of 255: what differs by less nobody sees


@pytest.fixture(autouse=True)
def usual_again(app: QApplication) -> Iterator[None]:
    yield
    apply_preferences(settings.Preferences(), app)
    settle()


def prefer(user: User, theme: str) -> None:
    """Edit > Preferences, the theme, OK."""

    def answer(dialog: PreferencesDialog) -> None:
        dialog.theme.setCurrentIndex(dialog.theme.findData(theme))
        QTest.mouseClick(dialog.buttons.button(QDialogButtonBox.StandardButton.Ok), Qt.MouseButton.LeftButton)

    with answering(PreferencesDialog, answer):
        user.choose("Edit", "Preferences...")
    settle()


def pixels(image: QImage) -> np.ndarray:
    """Red, green and blue (height, width, 3)."""
    flat = image.convertToFormat(QImage.Format.Format_RGB32)
    rows = np.frombuffer(bytes(flat.constBits()), np.uint8).reshape(flat.height(), flat.bytesPerLine() // 4, 4)
    return rows[:, : flat.width(), :3].astype(int)


def tasks(window: QWidget) -> dict[str, np.ndarray]:
    """The window in some of its tasks."""
    made = {}
    for task in TASKS:
        window.show_task(task)
        rest(window)
        made[task] = pixels(window.grab().toImage())
    return made


def differing(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> dict[str, int]:
    """Pixels that anybody would see to differ, of tasks that have any."""
    counts = {task: int((np.abs(one[task] - other[task]).max(axis=2) > SEEN).sum()) for task in one}
    return {task: count for task, count in counts.items() if count}


def bright(image: QImage) -> float:
    """Part of a picture that is lighter than a mid grey."""
    return float((pixels(image).mean(axis=2) > 127).mean())


def texts_of_file(view: View) -> list[str]:
    """Every text of a view's picture as SVG, each with its place and its size."""
    with in_file_units():
        return re.findall(r"<text.*?</text>", view.picture(".svg").decode(), flags=re.DOTALL)


@pytest.mark.stress
def test_the_theme_changes_where_the_window_stands(open_user: Open) -> None:
    user = open_user(whole=True)
    tasks(user.window)  # from now on each has been seen, and its section of the parameters
    light = tasks(user.window)
    prefer(user, "dark")
    live = tasks(user.window)
    assert all((picture.mean(axis=2) > 127).mean() < 0.1 for picture in live.values())
    other = open_user(whole=True)
    tasks(other.window)
    assert differing(live, tasks(other.window)) == {}, "as a window that was opened in the dark"
    user.window.activateWindow()
    prefer(user, "light")
    assert differing(tasks(user.window), light) == {}
    assert user.steps == []


class StyleChanges(QObject):
    """Counts the widgets that are styled again, each with its rules of the style sheet."""

    count = 0

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        self.count += event.type() == QEvent.Type.StyleChange
        return False


@pytest.mark.stress
def test_a_change_of_theme_styles_no_widget_again(app: QApplication, user: User) -> None:
    styled = StyleChanges(app)
    app.installEventFilter(styled)
    try:
        for theme in ("dark", "light", "dark"):
            apply_preferences(settings.Preferences(theme=theme), app)
            settle()
    finally:
        app.removeEventFilter(styled)
    assert styled.count == 0
    assert bright(user.window.grab().toImage()) < 0.1


def styled_plots(monkeypatch: pytest.MonkeyPatch) -> list[FixedPlot]:
    """The plots that are styled from now on, each as often as it is."""
    styled = []
    update_style = FixedPlot.update_style

    def counted(plot: FixedPlot) -> None:
        styled.append(plot)
        update_style(plot)

    monkeypatch.setattr(FixedPlot, "update_style", counted)
    return styled


def test_a_plot_behind_a_tab_changes_its_theme_when_it_is_shown(
    app: QApplication, user: User, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("velocity", "acceleration", "jerk"):
        user.window.show_view(name)
        settle()
    hidden, shown = (user.window.view(name) for name in ("velocity", "jerk"))
    assert shown.on_screen()
    assert not hidden.on_screen()
    styled = styled_plots(monkeypatch)
    for theme in ("light", "dark", "light", "dark"):
        apply_preferences(settings.Preferences(theme=theme), app)
        settle()
    plots = [plot for view in (shown, hidden) for plot in view.findChildren(FixedPlot)]
    assert [styled.count(plot) for plot in plots] == [3, 0]
    user.window.show_view("velocity")
    settle()
    assert [styled.count(plot) for plot in plots] == [3, 1]
    assert bright(hidden.grab().toImage()) < 0.1


def test_titles_of_plots_that_are_named_once_follow_the_theme(app: QApplication, open_user: Open) -> None:
    """Those of the law table, whose axes never change."""
    user = open_user()
    laws = user.see("laws").findChildren(FixedPlot)
    apply_preferences(DARK, app)
    settings.write(DARK)
    settle()
    dark = {str(i): pixels(plot.grab().toImage()) for i, plot in enumerate(laws)}
    fresh = open_user().see("laws").findChildren(FixedPlot)
    assert differing(dark, {str(i): pixels(plot.grab().toImage()) for i, plot in enumerate(fresh)}) == {}


def test_a_floating_view_is_styled_once(app: QApplication, user: User, monkeypatch: pytest.MonkeyPatch) -> None:
    user.window.docks["velocity"].setFloating(True)
    plot = user.see("velocity").findChild(FixedPlot)
    styled = styled_plots(monkeypatch)
    apply_preferences(DARK, app)
    settle()
    assert styled.count(plot) == 1


@pytest.mark.stress
def test_what_is_zoomed_and_half_typed_outlives_a_change_of_theme(app: QApplication, user: User) -> None:
    canvas = user.drawing().canvas
    canvas.zoom(2.0, QPointF(canvas.rect().center()))
    box = user.number("cam.base_radius_mm")
    box.selectAll()
    user.type("41")
    before = canvas.scale_now
    apply_preferences(DARK, app)
    settle()
    assert (box.text(), canvas.scale_now) == ("41", before)
    user.type("0")
    user.press(Qt.Key.Key_Return)
    assert user.design.drive.cam.base_radius_mm == 410.0


@pytest.mark.stress
def test_as_the_desktop_follows_the_desktop(app: QApplication, user: User) -> None:
    prefer(user, "system")
    told = app.styleHints().colorSchemeChanged
    told.emit(Qt.ColorScheme.Dark)
    rest(user.window)
    assert bright(user.window.grab().toImage()) < 0.1
    told.emit(Qt.ColorScheme.Light)
    rest(user.window)
    assert bright(user.window.grab().toImage()) > 0.8
    prefer(user, "light")
    told.emit(Qt.ColorScheme.Dark)
    rest(user.window)
    assert bright(user.window.grab().toImage()) > 0.8, "who chose a theme keeps it"


@pytest.mark.stress
@pytest.mark.parametrize(
    ("name", "views"),
    [
        ("transfer_unit", ("shaft_figures", "timing", "mechanism")),
        ("lecture_six_bar", ("polygon", "laws", "mechanism")),
    ],
)
def test_pictures_stay_light(app: QApplication, same_window: Open, name: str, views: tuple[str, ...]) -> None:
    user = same_window(example(name))
    apply_preferences(settings.Preferences(theme="dark", font=125), app)
    for each in views:
        view = user.window.show_view(each)
        rest(user.window)
        with in_file_units():
            image = QImage.fromData(view.picture(".png"))
        assert bright(image) > 0.6, each
        rest(user.window)
        assert bright(view.grab().toImage()) < 0.3, f"{each} itself is dark again"
    copy_picture(user.window.view("mechanism"))
    assert bright(app.clipboard().image()) > 0.7


def test_letters_grow_everywhere_and_files_do_not_see_it(app: QApplication, user: User) -> None:
    view = user.see("pressure_angle")
    before = texts_of_file(view)
    usual = app.font().pixelSize()
    room = {plot: plot.getAxis("left").width() for plot in user.window.findChildren(FixedPlot)}
    apply_preferences(settings.Preferences(font=125), app)
    rest(user.window)
    grown = round(1.25 * usual)
    kinds = (QLabel, QLineEdit, QComboBox, QPushButton, QToolButton)
    read = [widget for kind in kinds for widget in user.window.findChildren(kind)]
    small = {
        type(widget).__name__: widget.font().pixelSize()
        for widget in read
        if widget.isVisible() and widget.font().pixelSize() < 1.2 * (usual - 1) and "qt_" not in widget.objectName()
    }
    assert (app.font().pixelSize(), small) == (grown, {})
    assert all(plot.getAxis("left").width() == pytest.approx(1.25 * width) for plot, width in room.items() if width)
    assert texts_of_file(view) == before
    apply_preferences(settings.Preferences(), app)
    rest(user.window)
    assert {plot: plot.getAxis("left").width() for plot in room} == room
