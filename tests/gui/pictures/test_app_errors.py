"""kindyna_gui.pictures.app: what C code raises in a handler of Qt reaches who called, and the process lives."""

from typing import Any

import pyqtgraph
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QComboBox, QDialog, QLabel, QLineEdit, QPushButton, QWidget
from shiboken6 import delete


def read_number(*_: object) -> None:
    int("x")


def beyond_the_end(*_: object) -> None:
    [][0]


def hide_what_has_gone(*_: object) -> None:
    gone = QLabel()
    delete(gone)
    gone.hide()


class Mixin:
    """Handles keys for classes of Qt."""

    deed: Any

    def keyPressEvent(self, event: object) -> None:
        self.deed()


class Line(Mixin, QLineEdit):
    """A line."""


class Box(Mixin, QComboBox):
    """A choice."""


class Plot(Mixin, pyqtgraph.PlotWidget):
    """A plot."""


@pytest.mark.parametrize("kind", [Line, Box, Plot])
@pytest.mark.parametrize("deed", [read_number, beyond_the_end, hide_what_has_gone])
def test_an_error_in_a_handler_is_raised_where_the_event_was_sent(app: QApplication, kind: Any, deed: Any) -> None:
    widget: QWidget = kind()
    widget.deed = deed  # type: ignore[attr-defined]
    with pytest.raises((ValueError, IndexError, RuntimeError), match=r"invalid literal|out of range|already deleted"):
        QTest.keyClick(widget, Qt.Key.Key_A)


def test_a_signal_hands_on_to_a_slot_of_ours_what_it_takes(app: QApplication) -> None:
    """``accept`` takes no value, and ``clicked`` has one."""

    class Dialog(QDialog):
        done_by = ""

        def accept(self) -> None:
            self.done_by = "accept"

    dialog = Dialog()
    button = QPushButton(dialog)
    button.clicked.connect(dialog.accept)
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    assert dialog.done_by == "accept"
