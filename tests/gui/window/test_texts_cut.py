"""No text of a control is cut in the smallest window, in whatever letters, and the window keeps its size: every task is walked through."""

from collections.abc import Iterator

import pytest
from PySide6.QtWidgets import QAbstractButton, QApplication, QCheckBox, QLabel, QRadioButton, QToolButton, QWidget
from sampled import stressed
from window_user import Open

from kindyna_gui import settings
from kindyna_gui.look import apply_preferences
from kindyna_gui.places import example, examples
from kindyna_gui.screenshots import rest
from kindyna_gui.window.tasks import TASKS

SMALL = (1280, 720)
ROOM = 8  # pixels that a button has beside its text at the least
EVERY = [stressed(path.stem, font) for _, path in examples() for font in (100, 125)]


@pytest.fixture(autouse=True)
def usual_again(app: QApplication) -> Iterator[None]:
    yield
    apply_preferences(settings.Preferences(), app)


def cut(root: QWidget) -> list[str]:
    """Texts in sight that want more room than they have."""
    found = []
    for each in root.findChildren(QWidget):
        if each.visibleRegion().isEmpty():
            continue
        if isinstance(each, QLabel) and each.text() and each.pixmap().isNull():
            if each.wordWrap():
                high = each.heightForWidth(each.width()) > each.height() + 1
                found += [f"too low: {each.text()}"] if high else []
            elif each.sizeHint().width() > each.width() + 1 and not each.toolTip():  # else what is cut is in the tip
                found.append(f"too narrow: {each.text()}")
        elif isinstance(each, QAbstractButton) and each.text() and _shows_its_text(each):
            wanted = each.sizeHint().width()
            if not isinstance(each, QToolButton | QCheckBox | QRadioButton):  # Qt's own would rather be wider
                wanted = each.fontMetrics().horizontalAdvance(each.text().replace("&", "")) + ROOM
            found += [f"too narrow: {each.text()}"] if wanted > each.width() + 1 else []
    return found


def _shows_its_text(button: QAbstractButton) -> bool:
    return (
        not isinstance(button, QToolButton) or button.toolButtonStyle() != button.toolButtonStyle().ToolButtonIconOnly
    )


@pytest.mark.parametrize(("name", "font"), [("lecture_six_bar", 125), *EVERY])
def test_no_text_is_cut_in_any_task(app: QApplication, open_user: Open, name: str, font: int) -> None:
    apply_preferences(settings.Preferences(font=font), app)
    window = open_user(example(name), size=SMALL, whole=True).window
    wrong = {}
    for task in TASKS:
        window.show_task(task)
        rest(window)
        larger = [] if (window.width(), window.height()) == SMALL else [f"the window is {window.size()}"]
        wrong[task] = cut(window) + larger
    assert {task: lines for task, lines in wrong.items() if lines} == {}
