"""kindyna_gui.graph.curves_view: rows, form, axes, files that change and vanish, the data cursor, zoom and back, what goes out."""

import json
import math
import re
from collections.abc import Iterator
from pathlib import Path
from time import sleep

import numpy as np
import pytest
from PIL import Image
from PySide6.QtCore import QPoint, QPointF, QSize, Qt
from PySide6.QtGui import QColor, QGuiApplication, QImage, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from window_user import Alone, settle, wait_for

from core.numerics.lazy import checkpoint
from core.output.graph import DesignSource, GraphPoint, Progress, Source
from core.project import load
from core.study import Study
from kindyna_gui import dialogs
from kindyna_gui.__main__ import main
from kindyna_gui.documents.session import Session
from kindyna_gui.graph import graph_choice
from kindyna_gui.graph.curves_view import CurvesView
from kindyna_gui.pictures.plots.graph_ranges import GraphRange
from kindyna_gui.pictures.style import LIGHT
from kindyna_gui.places import example
from kindyna_gui.player import Player
from kindyna_gui.settings import Settings

LIFT = load(example("transfer_lift"))
TABLE = "angle_deg,lift_mm,force_kn\n0,10,1\n90,30,2\n180,20,4\n270,40,3\n360,10,1\n"


@pytest.fixture(scope="module")
def shared(app: QApplication) -> Iterator[list[CurvesView]]:
    """The view that the tests of this module share, once there is one."""
    kept: list[CurvesView] = []
    yield kept
    for view in kept:
        view.leave()
        view.close()
        view.deleteLater()


@pytest.fixture
def view(shared: list[CurvesView]) -> CurvesView:
    """With the graph that a user finds at first."""
    if not shared:
        Settings().graph = ""
        shared.append(CurvesView(Session(LIFT), Player()))
        shared[0].resize(1000, 620)
        shared[0].show()
        assert QTest.qWaitForWindowExposed(shared[0])
    view = shared[0]
    view.session.start(LIFT)
    while view.rows.buttons["undo"].isEnabled():
        view.undo()
    view.plot.set_points(())
    view.tabs.setCurrentIndex(0)
    settle()
    return view


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "measured.csv"
    path.write_text(TABLE, "utf-8")
    return path


def read(view: CurvesView) -> None:
    wait_for(lambda: not view.busy)
    settle()


def pick(view: CurvesView, box: str, value: str) -> None:
    """Choose in a box of the form, with the keys."""
    widget = view.form.boxes[box]
    index = widget.findData(value)
    assert index >= 0, [widget.itemData(i) for i in range(widget.count())]
    while widget.currentIndex() != index:
        QTest.keyClick(widget, Qt.Key.Key_Down if widget.currentIndex() < index else Qt.Key.Key_Up)
    settle()


def pixel(view: CurvesView, series: int, x: float) -> QPoint:
    return view.plot.pixel_of(GraphPoint(series, x, view.data.series[series].at(x))).toPoint()


def click(view: CurvesView, at: QPoint) -> None:
    QTest.mouseClick(view.plot.viewport(), Qt.MouseButton.LeftButton, pos=at)
    settle()


def drag(view: CurvesView, begin: QPoint, end: QPoint, button: Qt.MouseButton = Qt.MouseButton.LeftButton) -> None:
    area = view.plot.viewport()
    QTest.mousePress(area, button, pos=begin)
    QTest.mouseMove(area, end)
    QTest.mouseRelease(area, button, pos=end)
    settle()


def test_a_file_over_the_design_its_difference_and_the_steps_back(
    view: CurvesView, table: Path, tmp_path: Path
) -> None:
    view.add_files([table])
    read(view)
    pick(view, "y", "force_kn")
    pick(view, "side", "right")
    assert view.plot.titles == {"bottom": "Cam angle, °", "left": "Displacement, mm", "right1": "Force, kN"}
    pick(view, "y", "lift_mm")
    pick(view, "side", "auto")
    assert len(view.data.axes) == 1
    view.add_difference()
    read(view)
    assert view.data.faults == {}
    shown = view.data.series[2]
    inside = slice(0, np.searchsorted(shown.x, 359.0))
    lift = np.interp(shown.x, *(view.data.series[1].x, view.data.series[1].y))
    study = Study(LIFT)
    own = np.interp(shown.x, study.angle_degrees, 1e3 * study.motion.displacement[0])
    np.testing.assert_allclose(shown.y[inside], (lift - own)[inside], atol=1e-9)
    pick(view, "minus", "")
    assert view.rows.list.count() == 3
    QTest.keyClick(view.rows.list, Qt.Key.Key_Up, Qt.KeyboardModifier.AltModifier)
    assert [curve.y for curve in view.graph.curves] == ["displacement", "lift_mm", "lift_mm"]
    QTest.keyClick(view.rows.list, Qt.Key.Key_Delete)
    assert len(view.graph.curves) == 2
    while view.rows.buttons["undo"].isEnabled():
        QTest.mouseClick(view.rows.buttons["undo"], Qt.MouseButton.LeftButton)
    assert [curve.y for curve in view.graph.curves] == ["displacement"]
    while view.rows.buttons["redo"].isEnabled():
        QTest.keyClick(
            view.rows.list, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier
        )
        read(view)
    assert len(view.graph.curves) == 2


def test_a_file_that_changes_is_read_again_and_one_that_vanishes_stays_with_a_note(
    view: CurvesView, table: Path
) -> None:
    view.add_files([table])
    read(view)
    assert view.data.series[1].y.tolist() == [10, 30, 20, 40, 10]
    table.write_text(TABLE.replace("90,30", "90,abc"), "utf-8")
    view.sources.compare()
    read(view)
    np.testing.assert_array_equal(view.data.series[1].y, [10, np.nan, 20, 40, 10])
    assert "lift_mm, line 3: 'abc': not a number, omitted" in view.form.note.text()
    table.write_text("nothing of the kind\n", "utf-8")
    view.sources.compare()
    read(view)
    assert len(view.data.series) == 2, "as it was read last"
    assert "measured.csv has changed and cannot be read" in view.form.note.text()
    table.unlink()
    view.sources.compare()
    read(view)
    assert len(view.data.series) == 2
    assert view.form.note.text().startswith("measured.csv was removed")
    table.write_text(TABLE, "utf-8")
    view.sources.compare()
    read(view)
    assert view.form.note.text() == ""


def test_a_channel_that_the_design_has_no_longer_comes_back_with_it(view: CurvesView, table: Path) -> None:
    view.add_files([table])
    read(view)
    view.rows.list.setCurrentRow(0)
    pick(view, "y", "phi_deg")
    view.session.start(load(example("kim_1990")))
    settle()
    assert [each.name for each in view.data.series] == ["Lift, measured"]
    row = view.rows.list.item(0)
    assert row.text() == "1  Arm angle  (not in this design)"
    assert row.foreground().color() == QColor(LIGHT.quiet), "greyed, not wrong"
    assert view.form.fault.isHidden()
    wanted = f"{view.session.design.name} has no Arm angle; the curve is drawn again for a design that has it."
    assert view.form.note.text() == row.toolTip() == wanted
    assert view.form.boxes["y"].currentText() == "(Arm angle)"
    view.session.start(LIFT)
    settle()
    assert [each.name for each in view.data.series] == ["Arm angle", "Lift, measured"]
    assert view.rows.list.item(0).text() == "1  Arm angle"


def test_a_graph_that_changes_under_the_mouse_is_let_go(view: CurvesView) -> None:
    area, begin = view.plot.viewport(), pixel(view, 0, 120.0)
    QTest.mousePress(area, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.ShiftModifier, begin)
    view.session.start(load(example("four_bar")))
    read(view)
    assert view.data.series == ()
    QTest.mouseMove(area, begin + QPoint(40, 20))
    QTest.mouseRelease(area, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.ShiftModifier, begin + QPoint(40, 20))
    view.session.start(LIFT)
    read(view)
    assert view.plot.shown == view.plot.full_range()


def test_two_points_are_read_off_and_their_difference(view: CurvesView) -> None:
    for at in (55.0, 60.0):
        click(view, pixel(view, 0, at))
    a, b = view.plot.points
    assert (a.x, b.x) == (pytest.approx(55.0, abs=0.5), pytest.approx(60.0, abs=0.5))
    study = Study(LIFT).at_theta(np.deg2rad([a.x, b.x]))
    true = 1e3 * study.motion.displacement[0]
    assert [a.y, b.y] == pytest.approx(true, abs=1e-3)
    text = view.readout.text()
    assert f"slope {(b.y - a.y) / (b.x - a.x):.5f}"[:10] in text.replace("−", "-")
    QTest.keyClick(view.plot, Qt.Key.Key_Right)
    assert view.plot.points[1].x > b.x
    QTest.keyClick(view.plot, Qt.Key.Key_Escape)
    assert view.plot.points == ()
    assert view.readout.text().startswith("Click on a curve")


def test_zoom_move_wheel_and_back(view: CurvesView) -> None:
    whole = view.plot.shown
    drag(view, pixel(view, 0, 40.0), pixel(view, 0, 70.0))
    assert view.plot.shown.x == pytest.approx((40.0, 70.0), abs=0.5)
    assert view.plot.shown.values[0][1] - view.plot.shown.values[0][0] < 150.0
    zoomed = view.plot.shown
    middle = view.plot.viewport().rect().center()
    drag(view, middle, middle + QPoint(60, 0), Qt.MouseButton.MiddleButton)
    assert view.plot.shown.x[0] < zoomed.x[0]
    assert view.plot.shown.x[1] - view.plot.shown.x[0] == pytest.approx(zoomed.x[1] - zoomed.x[0])
    assert view.plot.shown.values == zoomed.values
    at = QPointF(middle)
    wheel = QWheelEvent(
        at,
        view.plot.mapToGlobal(at),
        QPoint(),
        QPoint(0, 120),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    wide = view.plot.shown.x[1] - view.plot.shown.x[0]
    QApplication.sendEvent(view.plot.viewport(), wheel)
    assert view.plot.shown.x[1] - view.plot.shown.x[0] < wide
    part = view.plot.shown
    view.session.edit("cam.base_radius_mm", 405.0, "Edit")
    assert view.plot.shown == part, "an edit leaves what is zoomed"
    for _ in range(3):
        assert view.back_button.isEnabled()
        QTest.mouseClick(view.back_button, Qt.MouseButton.LeftButton)
    assert view.plot.shown == whole
    assert not view.back_button.isEnabled()
    assert view.session.edit("motion.start_mm", 180.0, "Edit")
    assert view.plot.shown.values[0][1] > 180.0, "what is not zoomed follows its curves"


def test_axes_are_typed_and_logarithmic(view: CurvesView) -> None:
    view.tabs.setCurrentIndex(1)
    low = view.axes.ends["left", "low"]
    low.setFocus()
    QTest.keyClicks(low.lineEdit(), "10")
    QTest.keyClick(low, Qt.Key.Key_Return)
    QTest.mouseClick(
        view.axes.logs["left"], Qt.MouseButton.LeftButton, pos=QPoint(8, view.axes.logs["left"].height() // 2)
    )
    view.axes.titles["left"].setFocus()
    QTest.keyClicks(view.axes.titles["left"], "Height")
    QTest.keyClick(view.axes.titles["left"], Qt.Key.Key_Return)
    settle()
    assert view.plot.titles["left"] == "Height, mm"
    assert 10.0 ** view.plot.shown.values[0][0] == pytest.approx(10.0)
    assert [text for _, text in view.plot.getAxis("left").shown][:3] == ["10", "20", "50"]
    assert "values at or below 0 are not on the logarithmic axis" in view.form.note.text()
    high = view.axes.ends["left", "high"]
    high.setFocus()
    QTest.keyClicks(high.lineEdit(), "5")
    QTest.keyClick(high, Qt.Key.Key_Return)
    assert "more than 10" in view.axes.message.text()
    assert view.graph.left.high is None
    QTest.keyClick(high, Qt.Key.Key_Escape)
    log = view.axes.logs["left"]
    QTest.mouseClick(log, Qt.MouseButton.LeftButton, pos=QPoint(8, log.height() // 2))
    low.lineEdit().selectAll()
    QTest.keyClicks(low.lineEdit(), "-10")
    QTest.keyClick(low, Qt.Key.Key_Return)
    QTest.mouseClick(log, Qt.MouseButton.LeftButton, pos=QPoint(8, log.height() // 2))
    assert "a logarithmic axis has no values of 0 and less" in view.axes.message.text()
    while view.rows.buttons["undo"].isEnabled():
        QTest.mouseClick(view.rows.buttons["undo"], Qt.MouseButton.LeftButton)
    assert low.text() == "", "what is undone is seen in the field"
    low.setFocus()
    high.setFocus()
    assert view.graph.left.low is None, "and does not come back by going through it"


@pytest.mark.parametrize(("low", "high"), [("0", "1e6"), ("-1e308", "1e308")])
def test_a_range_far_wider_than_the_curves_leaves_them_to_be_seen(view: CurvesView, low: str, high: str) -> None:
    view.tabs.setCurrentIndex(1)
    for end, text in (("low", low), ("high", high)):
        box = view.axes.ends["x", end]
        box.setFocus()
        QTest.keyClicks(box.lineEdit(), text)
        QTest.keyClick(box, Qt.Key.Key_Return)
    settle()
    assert view.plot.shown.x == (max(float(low), -1e290), min(float(high), 1e290))
    ((_, y),) = view.plot.painted
    assert (np.nanmin(y), np.nanmax(y)) == pytest.approx((0.0, 150.0))


def test_where_pixels_are_beyond_the_digits_of_numbers_no_point_is_taken(view: CurvesView) -> None:
    view.plot.show_range(GraphRange((0.0, 90.0), ((69.0, 69.0 + 1e-13),)))
    settle()
    click(view, view.plot.viewport().rect().center())
    assert view.plot.points == ()


def test_picture_numbers_and_clipboard(
    view: CurvesView, table: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    view.add_files([table])
    read(view)
    for ending, begin in ((".png", b"\x89PNG"), (".svg", b"<?xml"), (".pdf", b"%PDF")):
        out = tmp_path / f"graph{ending}"
        monkeypatch.setattr(dialogs, "graph_picture_to_save", lambda *_, out=out: out)
        view.export_picture()
        assert out.read_bytes().startswith(begin)
    assert out.read_bytes() == view.picture(".pdf"), "the same graph, the same bytes"
    faults: list[str] = []
    monkeypatch.setattr(dialogs, "show_faults", lambda parent, what, lines: faults.extend([what, *lines]))
    monkeypatch.setattr(dialogs, "graph_picture_to_save", lambda *_: tmp_path / "no" / "graph.png")
    view.export_picture()
    assert faults[0] == "graph.png cannot be written."
    monkeypatch.setattr(dialogs, "table_to_save", lambda *_: tmp_path / "graph.csv")
    view.export_numbers()
    numbers = np.genfromtxt(tmp_path / "graph.csv", delimiter=",", names=True)
    assert numbers.dtype.names == ("cam_angle_deg", "displacement_mm", "lift_measured_mm")
    assert numbers["lift_measured_mm"][numbers["cam_angle_deg"] == 45.0] == 20.0
    view.copy_to_clipboard()
    data = QGuiApplication.clipboard().mimeData()
    assert data.text().splitlines()[0] == "cam_angle_deg\tdisplacement_mm\tlift_measured_mm"
    assert QImage(data.imageData()).size().width() > QSize(300, 200).width()


def test_single_values_are_seen_and_many_curves_of_a_quantity_told_apart(view: CurvesView, tmp_path: Path) -> None:
    paths = [tmp_path / f"lift_{i}.csv" for i in range(6)]
    for i, path in enumerate(paths):
        path.write_text(f"angle_deg,lift_mm\n200,{200 + 9 * i}\n", "utf-8")
    view.add_files(paths)
    read(view)
    colours = [view.plot.colour(i) for i in range(7)]
    assert len(set(colours)) == 7
    picture = view.plot.grab().toImage()
    for i in range(1, 7):
        at = view.plot.pixel_of(GraphPoint(i, 200.0, 191.0 + 9.0 * i)).toPoint()
        assert picture.pixelColor(at).name() == colours[i].lower(), "one value, a dot"


@pytest.mark.stress
def test_the_graph_is_kept_and_its_files_are_found_again(view: CurvesView, table: Path, alone: Alone) -> None:
    view.add_files([table])
    read(view)
    pick(view, "dash", "dashed")
    pick(view, "colour", "#D55E00")
    drag(view, pixel(view, 0, 40.0) + QPoint(0, 10), pixel(view, 0, 60.0) + QPoint(0, 10))
    part = view.plot.shown
    view.tabs.setCurrentIndex(1)
    QTest.keyClicks(view.axes.titles["x"], "Turn")
    QTest.keyClick(view.axes.titles["x"], Qt.Key.Key_Return)
    settle()
    assert view.plot.titles["bottom"] == "Turn, °"
    assert view.plot.shown == part, "a title does not change it"
    kept = view.graph
    view.hide()
    view.show()
    assert json.loads(Settings().graph)["graph"]["curves"][1]["dash"] == "dashed"
    again: CurvesView = alone(CurvesView(Session(LIFT), Player()), 800, 500)
    read(again)
    assert again.graph == kept
    assert len(again.data.series) == 2
    assert again.plot.shown == part, "the part that the mouse chose"
    QTest.mouseClick(again.back_button, Qt.MouseButton.LeftButton)
    assert again.plot.shown == again.plot.full_range()
    again.hide()
    table.unlink()
    later: CurvesView = alone(CurvesView(Session(LIFT), Player()), 800, 500)
    read(later)
    assert later.plot.shown.x == (0.0, 360.0), "all of it was shown last"
    assert len(later.graph.curves) == 2, "the row stays"
    assert "measured.csv" in later.data.faults[kept.curves[1].key]
    assert len(later.data.series) == 1


def test_a_design_without_displacement_begins_with_its_first_channel(view: CurvesView) -> None:
    view.add_files([example("lecture_six_bar")])
    read(view)
    assert view.data.faults == {}
    assert view.data.series[1].y_label == view.form.boxes["y"].currentText()
    view.session.start(load(example("four_bar")))
    read(view)
    pick(view, "source", "")
    assert list(view.data.faults) == [view.graph.curves[0].key], "only what stays of the other design"


def test_another_design_and_all_drives_of_a_shaft(view: CurvesView) -> None:
    view.add_files([example("transfer_unit")])
    read(view)
    pick(view, "drive", "(all)")
    pick(view, "x", "machine_angle_deg")
    assert view.data.faults == {}
    assert len(view.data.series) == 1 + len(load(example("transfer_unit")).drives)
    colours = [view.plot.colour(i) for i in range(len(view.data.series))]
    assert len(set(colours)) == len(colours)


def test_a_reading_that_takes_long_is_cancelled_and_begun_again(
    view: CurvesView, table: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def endless(path: Path, progress: Progress) -> Source:
        progress(0.5)
        while True:
            checkpoint()
            sleep(0.001)

    with monkeypatch.context() as patch:
        patch.setattr(graph_choice, "read_source", endless)
        view.add_files([table])
        wait_for(view.cancel_button.isVisible)
        QTest.mouseClick(view.cancel_button, Qt.MouseButton.LeftButton)
        read(view)
    assert "reading was cancelled" in view.form.fault.text()
    assert not view.cancel_button.isVisible()
    assert len(view.data.series) == 1, "nothing else is lost"
    view.sources.read_again()
    read(view)
    assert len(view.data.series) == 2


def test_an_outline_is_drawn_undistorted_at_any_size(view: CurvesView) -> None:
    pick(view, "y", "y_mm")
    pick(view, "x", "x_mm")
    for width in (1000, 800):
        view.resize(width, 620)
        settle()
        origin, right, above = (
            view.plot.getViewBox().mapViewToScene(QPointF(x, y)) for x, y in ((0, 0), (100, 0), (0, 100))
        )
        assert right.x() - origin.x() == pytest.approx(origin.y() - above.y(), rel=1e-6)
    view.resize(1000, 620)
    settle()


@pytest.mark.stress
def test_a_long_table_is_drawn_from_as_many_points_as_are_seen(view: CurvesView, tmp_path: Path) -> None:
    x = np.linspace(0.0, 360.0, 60_001)
    y = np.where(np.arange(x.size) == 34_567, 9.0, np.sin(np.radians(x)))
    path = tmp_path / "long.csv"
    path.write_bytes(b"a_deg,y\n" + b"\n".join(b"%.5f,%.6f" % row for row in zip(x, y, strict=True)))
    view.add_files([path])
    read(view)
    view.plot.grab()
    assert view.data.series[1].x.size == x.size
    assert sum(len(x) for x, _ in view.plot.painted) < 20_000
    assert max(float(np.nanmax(part)) for _, part in view.plot.painted if len(part)) >= 9.0, "no peak is lost"


def test_the_command_paints_what_the_page_does(table: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = [tmp_path / f"graph{ending}" for ending in (".png", ".svg", ".pdf", ".csv")]
    words = [
        example("transfer_lift"),
        table,
        "--title",
        "As built",
        "--curve",
        "displacement",
        "--curve",
        "file=2,y=lift_mm,mark=circle",
    ]
    files = [word for path in out for word in ("--out", path)]
    assert main(["--headless", "graph", *map(str, [*words, *files, "--size", "640x400"])]) == 0
    assert capsys.readouterr().out.split() == [str(path) for path in out]
    with Image.open(out[0]) as picture:
        assert picture.size == (1280, 800)
        assert len(picture.getcolors(100_000)) > 20
    assert "As built" in out[1].read_text("utf-8")
    before = out[2].read_bytes()
    assert main(["--headless", "graph", *map(str, [*words, "--out", out[2], "--size", "640x400"])]) == 0
    assert out[2].read_bytes() == before


def test_the_path_of_the_transfer_is_one_choice_and_its_points_say_their_angle(view: CurvesView) -> None:
    menu = view.ready_button.menu()
    assert not view.ready_button.isEnabled()
    view.session.start(load(example("transfer_unit")))
    settle()
    assert [action.text() for action in menu.actions()] == ["Path of the transfer", "Speed along the path"]
    menu.actions()[0].trigger()
    assert [(each.name, each.y_unit) for each in view.data.series] == [
        ("Clamp over Feed", "mm"),
        ("Lift over Feed", "mm"),
    ]
    top = view.plot.mapFromScene(view.plot.view_of(0).mapViewToScene(QPointF(160.0, 150.0)))
    click(view, QPoint(round(top.x()), round(top.y())))
    told = re.search(r" at ([\d.]+)°, speed ([\d.]+) mm/s, acceleration ([\d.]+) (m+)/s²", view.readout.text())
    assert told is not None
    angle, speed = float(told[1]), float(told[2])
    assert 0.0 < angle < 32.0, "the feed goes forwards until 32°, at the top from its middle at 0°"
    at, of_feed = DesignSource(load(example("transfer_unit"))).values("Feed", ("machine_angle_deg", "velocity_deg_s"))
    assert speed == pytest.approx(500.0 * math.radians(float(np.interp(angle, at, of_feed))), rel=1e-4), (
        "its lever has 500 mm"
    )
    view.undo()
    assert [curve.y for curve in view.graph.curves] == ["displacement"]
    view.session.start(load(example("rear_suspension")))
    settle()
    assert [action.text() for action in menu.actions()] == ["Path of W", "W over its height"]
