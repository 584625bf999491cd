"""The timing chart by mouse and keys: drives and joins are turned, stop at what must be kept, and can be typed."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QColor, QImage, QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from window_user import settle

from core.design import Design, TimingRow, distances, events, with_phase
from core.project import load, save
from kindyna_gui import screenshots
from kindyna_gui.__main__ import main
from kindyna_gui.pictures.paper.timing_chart import MILLISECONDS, TimingChart
from kindyna_gui.pictures.style import LIGHT
from kindyna_gui.places import example
from kindyna_gui.timing_canvas import TimingCanvas

UNIT = load(example("transfer_unit"))
FEED, CLAMP, LIFT, TORQUE = range(4)
LEFT, KEYS = Qt.MouseButton.LeftButton, Qt.KeyboardModifier


class Hand:
    """A chart of its own, and what a user does at it."""

    def __init__(self) -> None:
        self.design, self.steps, self.said = UNIT, [], []  # type: tuple[Design, list[str], list[object]]
        self.canvas = TimingCanvas(self.put)
        self.canvas.resize(900, 320)
        for name in ("drive_chosen", "row_chosen", "condition_drawn", "angle_chosen", "drag_ended"):
            getattr(self.canvas, name).connect(lambda *what, name=name: self.said.append((name, *what)))
        self.show(UNIT)
        self.canvas.show()

    def put(self, design: Design, label: str, path: str) -> bool:
        self.design = design
        self.steps.append(label)
        self.canvas.show_design(design)
        return True

    def show(self, design: Design) -> None:
        self.design = design
        self.canvas.forget()
        self.canvas.show_design(design)
        self.steps.clear()
        self.said.clear()

    def join(self, drive: int, join: int) -> QPoint:
        return self.canvas.chart.join_position(drive, join).toPoint()

    def band(self, drive: int, angle: float) -> QPoint:
        """A place of a band where nothing else is."""
        chart = self.canvas.chart
        return QPointF(chart.x(angle), chart.box(drive).center().y()).toPoint()

    def draw(
        self, place: QPoint, degrees: float, keys: Qt.KeyboardModifier = KEYS.NoModifier, drop: bool = True
    ) -> None:
        pixels = round(degrees * self.canvas.chart.degree)
        QTest.mousePress(self.canvas, LEFT, keys, place)
        for part in (pixels // 2, pixels):
            move(self.canvas, place + QPoint(part, 0), keys)
        if drop:
            QTest.mouseRelease(self.canvas, LEFT, keys, place + QPoint(pixels, 0))


def move(canvas: TimingCanvas, place: QPoint, keys: Qt.KeyboardModifier) -> None:
    at = QPointF(place)
    event = QMouseEvent(QEvent.Type.MouseMove, at, canvas.mapToGlobal(at), Qt.MouseButton.NoButton, LEFT, keys)
    QApplication.sendEvent(canvas, event)


@pytest.fixture(scope="module")
def owned(app: QApplication) -> Iterator[Hand]:
    hand = Hand()
    yield hand
    hand.canvas.close()
    hand.canvas.deleteLater()


@pytest.fixture
def hand(owned: Hand) -> Hand:
    owned.canvas.resize(900, 320)
    owned.show(UNIT)
    return owned


def phase(design: Design, drive: int) -> float:
    return design.drives[drive].phase_deg


def test_a_band_turns_its_drive_by_half_degrees_and_stops_at_what_must_be_kept(hand: Hand) -> None:
    hand.draw(hand.band(TORQUE, 150.0), 20.0)
    assert phase(hand.design, TORQUE) == pytest.approx(55.0, abs=0.5)
    assert phase(hand.design, TORQUE) % 0.5 == 0.0
    assert hand.steps[-1] == f"Turn Torque to {phase(hand.design, TORQUE):g}°"
    hand.draw(hand.band(CLAMP, 180.0), -20.0, drop=False)
    assert phase(hand.design, CLAMP) == 234.5
    assert [row.kept for row in distances(hand.design)] == [True] * 6
    assert "5° after Lift return 1 end" in hand.canvas.label
    assert "234.5°  1954 ms" in hand.canvas.label
    QTest.keyClick(hand.canvas, Qt.Key.Key_Escape)
    assert phase(hand.design, CLAMP) == 238.0
    assert not hand.canvas.is_dragging
    hand.draw(hand.band(CLAMP, 180.0), 20.0)
    assert phase(hand.design, CLAMP) == 240.5, "its rise must end 5° before the lift rises"


def test_with_ctrl_a_drive_turns_ten_times_finer(hand: Hand) -> None:
    hand.draw(hand.band(TORQUE, 150.0), 20.0, KEYS.ControlModifier)
    assert phase(hand.design, TORQUE) == pytest.approx(37.0, abs=0.11)


def test_a_start_or_an_end_is_turned_alone(hand: Hand) -> None:
    before = events(UNIT)
    hand.draw(hand.join(FEED, 3), -10.0)  # the end of its return, at 226
    moved = {name: angle for name, angle in events(hand.design).items() if angle != before[name]}
    assert moved == {"Feed.return.1.end": pytest.approx(216.0, abs=0.5)}
    hand.draw(hand.join(FEED, 0), 40.0)  # its rise starts at the drive's own cam angle 0
    assert events(hand.design)["Feed.rise.1.start"] == pytest.approx(8.0, abs=0.5)
    assert events(hand.design)["Feed.return.1.end"] == moved["Feed.return.1.end"]
    assert hand.steps[-1].startswith("Move Feed rise 1 start to ")
    hand.show(UNIT)
    hand.draw(hand.join(FEED, 2), -30.0)
    assert events(hand.design)["Feed.return.1.start"] == 128.0, "5° after the clamp has opened"


def test_rows_that_are_broken_do_not_hold_a_drive_back(hand: Hand) -> None:
    last = UNIT.timing[5]  # the lift rises at 283.5°, 5° after the clamp's rise at least
    contrary = TimingRow(last.second, last.first, 3.0)
    for rows in ((last,), (last, contrary)):
        hand.show(with_phase(replace(UNIT, timing=rows), CLAMP, 242.0))
        assert not any(row.kept for row in distances(hand.design))
        hand.draw(hand.band(CLAMP, 180.0), 6.0)
        assert phase(hand.design, CLAMP) == pytest.approx(248.0, abs=0.5)


def test_a_double_click_asks_for_the_angle_or_the_time(hand: Hand) -> None:
    canvas = hand.canvas

    def typed(place: QPoint, text: str) -> None:
        QTest.mouseDClick(canvas, LEFT, KEYS.NoModifier, place)
        assert canvas.typed.isVisible()
        canvas.typed.selectAll()
        QTest.keyClicks(canvas.typed, text)
        QTest.keyClick(canvas.typed, Qt.Key.Key_Return)

    typed(hand.band(TORQUE, 150.0), "12.25")
    assert phase(hand.design, TORQUE) == 12.25
    assert not canvas.typed.isVisible()
    typed(hand.join(LIFT, 1), "30")
    assert events(hand.design)["Lift.return.1.start"] == 30.0, "what is typed counts, though it breaks a distance"
    assert [row.kept for row in distances(hand.design)].count(False) == 1
    typed(hand.join(LIFT, 1), "100")
    assert canvas.typed.is_refused
    line = canvas.typed.refusal
    assert (canvas.typed.text(), line.isVisible()) == ("100", True)
    assert line.text().startswith("Outside its range; allowed: ")
    assert line.text().endswith("76°, between its neighbours, not 100°")
    assert list(line.buttons) == ["Use 76°", "Back to 30°"]
    QTest.mouseClick(line.buttons["Back to 30°"], Qt.MouseButton.LeftButton)
    assert (canvas.typed.text(), canvas.typed.is_refused, line.isVisible()) == ("30", False, False)
    QTest.keyClick(canvas.typed, Qt.Key.Key_Escape)
    assert events(hand.design)["Lift.return.1.start"] == 30.0
    canvas.set_unit(MILLISECONDS)
    typed(hand.join(CLAMP, 3), "1000 + 5 ms")
    assert events(hand.design)["Clamp.return.1.end"] == pytest.approx(120.6)
    canvas.set_unit("deg")


def test_from_event_to_event_with_shift_is_a_row_more(hand: Hand) -> None:
    canvas, start, end = hand.canvas, hand.join(FEED, 1), hand.join(CLAMP, 2)
    QTest.mousePress(canvas, LEFT, KEYS.ShiftModifier, start)
    move(canvas, (start + end) / 2, KEYS.ShiftModifier)
    move(canvas, end, KEYS.ShiftModifier)
    assert canvas.label == "Clamp return 1 start after Feed rise 1 end"
    QTest.mouseRelease(canvas, LEFT, KEYS.ShiftModifier, end)
    assert ("condition_drawn", "Feed.rise.1.end", "Clamp.return.1.start") in hand.said
    assert hand.design is UNIT


def test_clicks_choose_a_drive_a_row_and_an_angle(hand: Hand) -> None:
    canvas, chart = hand.canvas, hand.canvas.chart
    QTest.mouseClick(canvas, LEFT, KEYS.NoModifier, hand.band(LIFT, 180.0))
    assert ("drive_chosen", LIFT) in hand.said
    arrow = QPointF(
        chart.x(226.0), chart.y(FEED, 0.0) + 20.0
    ).toPoint()  # from the end of the feed's return down to the clamp
    QTest.mouseClick(canvas, LEFT, KEYS.NoModifier, arrow)
    assert hand.said[-1] == ("row_chosen", 4)
    QTest.mouseClick(canvas, LEFT, KEYS.NoModifier, QPointF(chart.x(90.0), chart.height - 10.0).toPoint())
    assert hand.said[-1] == ("angle_chosen", pytest.approx(90.0, abs=0.5))
    assert hand.steps == []


def test_a_drive_alone_has_no_phase_but_its_joins_can_be_turned(hand: Hand) -> None:
    alone = load(example("transfer_lift"))
    hand.show(alone)
    hand.draw(hand.band(0, 180.0), 20.0)
    assert hand.design is alone
    hand.draw(hand.join(0, 1), -10.0)
    assert hand.design.drive.motion is not None
    assert hand.design.drive.motion.segments[0].span_deg == pytest.approx(25.0, abs=0.5)


# -- files --------------------------------------------------------------------------------------------------


@pytest.fixture
def platform(app: QApplication, monkeypatch: pytest.MonkeyPatch) -> None:
    """The command sets it for the process."""
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")


@pytest.mark.usefixtures("platform")
def test_the_chart_as_vectors_picture_and_table(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def written(design: Path, name: str, *words: str) -> tuple[int, bytes]:
        code = main(["--headless", "timing", str(design), "--out", str(tmp_path / name), *words])
        return code, (tmp_path / name).read_bytes()

    unit = example("transfer_unit")
    code, drawn = written(unit, "chart.svg", "--axis", "ms")
    texts = "".join(ElementTree.fromstring(drawn).itertext())
    assert code == 0
    for text in (
        "Transfer unit",
        "Time [ms] at 20 rpm",
        "return 1  783.3 ms",
        "Feed rise 1 start after Lift rise 1 end: 25.0 ≥ 16.67 ms",
    ):
        assert text in texts
    assert b"<image" not in drawn, "lines and texts, no pixels"
    late = tmp_path / "late.toml"
    save(with_phase(UNIT, CLAMP, 241.0), late)
    code, page = written(late, "chart.pdf")
    assert code == 1, "a distance is broken"
    assert page.startswith(b"%PDF")
    assert written(late, "again.pdf")[1] == page
    assert written(unit, "chart.png")[1].startswith(b"\x89PNG")
    assert b"Clamp.return.1.end,123.0,1025.0\n" in written(unit, "events.csv")[1]
    monkeypatch.setattr(screenshots, "TASKS", {})  # one view is enough
    monkeypatch.setattr(screenshots, "VIEWS", {"timing": screenshots.VIEWS["timing"]})
    assert set(screenshots.shots(UNIT, (1280, 720))) == {"window.png", "timing.png"}
    capsys.readouterr()
    assert main(["--headless", "timing", str(unit), "--out", "chart.txt"]) == 2
    assert "allowed endings: .pdf, .svg, .png, .csv" in capsys.readouterr().err


@pytest.mark.parametrize("size", [(560, 170), (720, 190), (900, 320), (1400, 240)])
def test_no_distance_stands_on_a_curve_or_on_another(size: tuple[int, int], hand: Hand) -> None:
    """Where a curve can be seen without the distances, it can be seen with them."""

    def painted(design: Design) -> tuple[np.ndarray, TimingChart]:
        hand.canvas.resize(*size)
        hand.show(design)
        settle()
        picture = hand.canvas.grab().toImage().convertToFormat(QImage.Format.Format_RGB32)
        pixels = np.frombuffer(bytes(picture.constBits()), np.uint8).reshape(
            picture.height(), picture.bytesPerLine() // 4, 4
        )
        return pixels[:, :, :3].astype(int), hand.canvas.chart

    with_rows, chart = painted(UNIT)
    without, _ = painted(replace(UNIT, timing=()))
    for number in range(4):
        colour = QColor(LIGHT.drive(number))
        curve = (np.abs(without - [colour.blue(), colour.green(), colour.red()]) <= 24).all(axis=2)
        curve[:, : int(chart.left)] = False  # the names
        assert curve.sum() > 100
        paler = with_rows[curve].sum(axis=1) > without[curve].sum(axis=1) + 60
        assert paler.mean() < 0.01, "covered by the paper of a text"
