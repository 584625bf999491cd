"""kindyna_gui.forms.number_box: every digit is shown, none that was not touched is changed."""

from collections.abc import Callable, Iterator

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QAction, QHelpEvent, QKeySequence, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPushButton, QStyle, QStyleOptionSpinBox, QToolTip, QVBoxLayout, QWidget

from core.design import UNITS, Info
from core.number_text import shortest
from kindyna_gui.forms.number_box import NumberBox

LENGTH = Info("Length", low=0.0, high=1e9, open_low=True)
SHARE = Info("Share", low=0.0, high=1.0, step=0.05)


class Bench:
    """Two boxes in a window, and all they say."""

    def __init__(self) -> None:
        self.window = QWidget()
        self.length, self.share = NumberBox(LENGTH, UNITS["mm"]), NumberBox(SHARE)
        self.length.show_value(1302.162)
        self.share.show_value(0.5)
        self.said: list[object] = []
        layout = QVBoxLayout(self.window)
        for box in (self.length, self.share):
            layout.addWidget(box)
            box.entered.connect(self.said.append)
            for name in ("unreadable", "finished", "withdrawn"):
                getattr(box, name).connect(lambda name=name: self.said.append(name))
        self.window.show()
        self.window.activateWindow()
        assert QTest.qWaitForWindowActive(self.window)
        self.length.setFocus()
        self.length.selectAll()

    def type(self, text: str, *keys: Qt.Key) -> None:
        QTest.keyClicks(self.length, text)
        for key in keys:
            QTest.keyClick(self.length, key)


@pytest.fixture
def bench(app: QApplication) -> Iterator[Bench]:
    made = Bench()
    yield made
    made.window.close()
    made.window.deleteLater()


def wheel(box: NumberBox, clicks: float, held: Qt.KeyboardModifier = Qt.KeyboardModifier.NoModifier) -> None:
    where = QPointF(5.0, 5.0)
    event = QWheelEvent(
        where,
        box.mapToGlobal(where),
        QPoint(),
        QPoint(0, round(120 * clicks)),
        Qt.MouseButton.NoButton,
        held,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    QApplication.sendEvent(box, event)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(value=st.floats(-1e12, 1e12))
def test_shown_values_are_exact(app: QApplication, value: float) -> None:
    box = NumberBox(Info("Any"))
    box.show_value(value)
    box.confirm()
    assert box.value == value
    assert float(box.text()) == value
    box.deleteLater()


def test_looking_and_leaving_changes_nothing(bench: Bench) -> None:
    bench.length.show_value(0.1 + 0.2)
    QTest.keyClick(bench.length, Qt.Key.Key_Return)
    QTest.keyClick(bench.length, Qt.Key.Key_Tab)
    assert set(bench.said) == {"finished"}
    assert bench.length.value == 0.1 + 0.2


def test_a_typed_number_counts_on_enter(bench: Bench) -> None:
    bench.type("12.5")
    assert (bench.said, bench.length.is_typing, bench.length.pending) == ([], True, True)
    bench.type("", Qt.Key.Key_Return)
    assert bench.said == [12.5, "finished"]


def test_a_typed_number_counts_when_the_focus_leaves(bench: Bench) -> None:
    bench.type("12.5 mm", Qt.Key.Key_Tab)
    assert bench.said == [12.5, "finished"]


def test_another_spelling_of_the_same_number(bench: Bench) -> None:
    bench.type("1302.1620", Qt.Key.Key_Return)
    assert bench.said == [1302.162, "finished"]


def test_what_is_no_number_stays_and_is_told(bench: Bench) -> None:
    bench.type("12,5", Qt.Key.Key_Return)
    assert bench.said == ["unreadable", "finished"]
    assert (bench.length.text(), bench.length.value) == ("12,5", 1302.162)


def test_escape_takes_back_what_was_typed(bench: Bench) -> None:
    bench.type("99", Qt.Key.Key_Escape)
    assert (bench.said, bench.length.text()) == (["withdrawn"], "1302.162")


def test_undo_while_typing_takes_back_what_was_typed(bench: Bench) -> None:
    bench.type("99")
    QTest.keyClick(bench.length, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert (bench.said, bench.length.text()) == (["withdrawn"], "1302.162")


@pytest.mark.parametrize(
    ("start", "steps", "end"),
    [(845.0, 1, 855.0), (86.0, 1, 87.0), (1302.162, 1, 1312.162), (1302.162, -1, 1292.162), (0.1, 3, 0.103), (0.3, -1, 0.298),
     (-65.0, 1, -64.5), (-20000.0, 1, -19800.0), (0.0, 1, 1.0), (7.44, 10, 7.94)],
)  # fmt: skip
def test_steps_are_as_large_as_the_number_asks(app: QApplication, start: float, steps: int, end: float) -> None:
    box = NumberBox(Info("Any"))
    box.show_value(start)
    box.stepBy(steps)
    assert box.text() == f"{end:g}" or float(box.text()) == end
    box.deleteLater()


@pytest.mark.parametrize(
    ("modifier", "end"),
    [("NoModifier", 87.0), ("ControlModifier", 86.1), ("ShiftModifier", 96.0)],
)
def test_wheel_arrow_keys_and_arrows_step_by_a_tenth_with_ctrl_and_tenfold_with_shift(
    bench: Bench, modifier: str, end: float
) -> None:
    held = Qt.KeyboardModifier[modifier]
    option = QStyleOptionSpinBox()
    bench.length.initStyleOption(option)
    part = QStyle.SubControl.SC_SpinBoxUp
    arrow = bench.length.style().subControlRect(QStyle.ComplexControl.CC_SpinBox, option, part, bench.length).center()
    gestures: tuple[Callable[[], object], ...] = (
        lambda: wheel(bench.length, 1, held),
        lambda: QTest.keyClick(bench.length, Qt.Key.Key_Up, held),
        lambda: QTest.mouseClick(bench.length, Qt.MouseButton.LeftButton, held, arrow),
    )
    for gesture in gestures:
        bench.length.show_value(86.0)
        bench.said.clear()
        gesture()
        assert bench.said[0] == end


def test_half_a_notch_of_the_wheel_waits_for_the_other_half(bench: Bench) -> None:
    bench.length.show_value(86.0)
    wheel(bench.length, 0.5)
    assert bench.said == []
    wheel(bench.length, 0.5)
    assert bench.said == [87.0]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("3*12", 36.0),
        ("1 in", 25.4),
        ("25.4 mm", 25.4),
        ("(86+2)/4 cm", 220.0),
        ("0.1+0.2", 0.3),
        ("1/8 in", 3.175),
        ("12 ft", 3657.6),
    ],
)
def test_a_calculation_and_other_units_count_as_what_they_come_to(bench: Bench, text: str, value: float) -> None:
    bench.type(text, Qt.Key.Key_Return)
    assert bench.said[0] == value


@pytest.mark.parametrize("text", ["1/0", "2**3", "3 rpm", "import os", "3*", "1_000", "9" * 101 + "+1"])
def test_what_comes_to_nothing_stays_as_it_was_typed(bench: Bench, text: str) -> None:
    bench.type(text, Qt.Key.Key_Return)
    assert bench.said[0] == "unreadable"
    assert bench.length.text() == text


def test_steps_of_the_field_stay_in_its_range(bench: Bench) -> None:
    bench.share.stepBy(1)
    assert bench.said == [0.55]
    bench.share.stepBy(100)
    bench.share.stepBy(1)
    assert bench.said == [0.55, 1.0]
    for _ in range(30):
        bench.share.stepBy(-1)
    assert bench.share.text() == "0"


def test_a_length_never_steps_to_nothing(bench: Bench) -> None:
    assert bench.length.stepped(0.5, -1000) == 0.5
    assert bench.length.stepped(1e9, 5) == 1e9


def test_arrow_keys_and_pages(bench: Bench) -> None:
    for key in (Qt.Key.Key_Up, Qt.Key.Key_PageUp, Qt.Key.Key_Down):
        QTest.keyClick(bench.length, key)
    assert bench.said == [1312.162, 1412.162, 1402.162]


def test_the_wheel_counts_only_in_the_chosen_box(bench: Bench) -> None:
    wheel(bench.share, 1)
    assert bench.said == []
    wheel(bench.length, 1)
    assert bench.said == [1312.162]


def test_a_click_on_the_arrow_is_a_gesture(bench: Bench) -> None:
    look = QStyleOptionSpinBox()
    bench.share.initStyleOption(look)
    up = bench.share.style().subControlRect(
        QStyle.ComplexControl.CC_SpinBox, look, QStyle.SubControl.SC_SpinBoxUp, bench.share
    )
    QTest.mouseClick(bench.share, Qt.MouseButton.LeftButton, pos=up.center())
    assert bench.said == ["finished", 0.55, "finished"]  # the other box was left first


def test_a_refused_box_has_a_red_frame(bench: Bench) -> None:
    def reddest() -> float:
        picture = bench.length.grab().toImage()
        colours = [picture.pixelColor(x, 0) for x in range(10, picture.width() - 10)]
        return max(c.red() - max(c.green(), c.blue()) for c in colours)

    before = reddest()
    bench.length.set_refused(True)
    assert reddest() > before + 50
    bench.length.show_value(1.0)
    assert not bench.length.is_refused


# -- a field narrower than its number ---------------------------------------------------------------------

LONG = -0.011057542284900001


def narrow(bench: Bench, value: float) -> NumberBox:
    """The second box, 100 pixels wide and without the focus."""
    bench.share.setFixedWidth(100)
    bench.share.show_value(value)
    QApplication.processEvents()
    return bench.share


@pytest.mark.parametrize("value", [LONG, 24.999999999999996, 1e-12 / 3.0, 754222849754222.8, -1e300 / 3.0])
def test_a_number_too_long_for_its_field_is_seen_rounded_from_its_front(bench: Bench, value: float) -> None:
    box = narrow(bench, value)
    assert float(box.shortened) == pytest.approx(value, rel=0.06)
    line = box.lineEdit()
    assert line.fontMetrics().horizontalAdvance(box.shortened) <= line.width()
    assert box.value == float(box.text()) == value


def test_what_is_seen_is_the_rounded_number(bench: Bench) -> None:
    """The picture is that of the rounded number typed in full, but for a pixel of its place."""
    box = narrow(bench, LONG)
    seen = ink(box)
    short = float(box.shortened)
    box.show_value(short)
    assert box.shortened == ""
    QApplication.processEvents()
    other = ink(box)
    assert abs(seen[0] - other[0]) <= 2
    assert abs(seen[1] - other[1]) <= 2


def ink(box: NumberBox) -> tuple[int, int]:
    """First and last column of pixels of the line that hold ink."""
    image = box.lineEdit().grab().toImage()
    dark = [
        x for x in range(image.width()) if any(image.pixelColor(x, y).lightness() < 110 for y in range(image.height()))
    ]
    return dark[0], dark[-1]


def test_the_whole_number_is_there_to_be_typed_over_and_looking_changes_nothing(bench: Bench) -> None:
    box = narrow(bench, LONG)
    box.setFocus()
    assert box.shortened == ""
    assert float(box.text()) == LONG
    bench.length.setFocus()
    assert box.shortened
    assert box.value == LONG
    assert set(bench.said) == {"finished"}


def test_a_step_starts_from_the_whole_number(bench: Bench) -> None:
    box = narrow(bench, 0.123456789012345)
    box.stepBy(1)
    assert bench.said == [0.173456789012345]


def test_the_tip_of_a_rounded_number_is_the_whole_one(bench: Bench) -> None:
    box = narrow(bench, LONG)
    box.setToolTip("its help")
    QApplication.sendEvent(box, QHelpEvent(QEvent.Type.ToolTip, QPoint(5, 5), box.mapToGlobal(QPoint(5, 5))))
    assert QToolTip.text() == f"{shortest(LONG)}<br>its help".replace("-", "\u2212")
    QToolTip.hideText()


# -- shortcuts --------------------------------------------------------------------------------------------


def test_shortcuts_of_a_view_do_not_act_while_its_field_is_typed_into(bench: Bench) -> None:
    acted: list[str] = []
    action = QAction(bench.window)
    action.setShortcut(QKeySequence("Ctrl+D"))
    action.setShortcutContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
    action.triggered.connect(lambda: acted.append("view"))
    inner, button = QWidget(), QPushButton("beside")
    column = QVBoxLayout(inner)
    column.addWidget(bench.share)
    column.addWidget(button)
    layout = bench.window.layout()
    assert layout is not None
    layout.addWidget(inner)
    inner.addAction(action)
    QApplication.processEvents()
    for widget in (bench.share, bench.length, button):
        widget.setFocus()
        QTest.keyClick(widget, Qt.Key.Key_D, Qt.KeyboardModifier.ControlModifier)
    assert acted == ["view"], "from the button only"
