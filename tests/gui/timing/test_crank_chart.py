"""The timing chart over the crank: centres and durations by mouse and keys, dead centres, overlap, and files."""

import json
import math
from pathlib import Path
from xml.etree import ElementTree

import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from window_user import Open, User, settle

from core.__main__ import main as command
from core.design import Design
from core.output.crank_timing import crank_curves
from core.project import load
from core.study import Study, quantity
from kindyna_gui.__main__ import main
from kindyna_gui.pictures.style import LIGHT
from kindyna_gui.places import example
from kindyna_gui.timing_view import TimingView

INLET, EXHAUST = 0, 1
LEFT, KEYS = Qt.MouseButton.LeftButton, Qt.KeyboardModifier
DURATIONS = "duration = [[0.1524, 268.0], [1.27, 218.0]]\n"
SIDES = "to_nose = [[0.1524, 134.0], [1.27, 109.0]]\n[drives.motion.lobe.closing]\nto_nose = [[1.27, 112.0]]\n"
ENGINE = "[engine]\nstroke_mm = 84.0\nrod_mm = 138.0\n"
DRIVE = """[[drives]]
name = "{name}"
[drives.motion]
start_mm = 0.0
[drives.motion.lobe]
lift_mm = 9.0
{lobe}[drives.follower]
kind = "translating"
face = "flat"
[drives.cam]
base_radius_mm = 18.0
[drives.valve]
centre_deg = {centre}
{valve}[drives.loads]
follower_mass_kg = 0.14
spring_rate_n_per_mm = 30.0
preload_n = 300.0
"""


def text(exhaust: str = SIDES, cylinder: str = "") -> str:
    drives = DRIVE.format(name="Inlet", lobe=DURATIONS, centre=108.0, valve=cylinder)
    drives += DRIVE.format(name="Exhaust", lobe=exhaust, centre=-112.0, valve=cylinder)
    return f'format = 1\nname = "Head"\n[shaft]\nrotation = "ccw"\nspeed_rpm = 3000.0\n{ENGINE}{drives}'


@pytest.fixture
def head(tmp_path: Path) -> Path:
    path = tmp_path / "head.toml"
    path.write_text(text(), encoding="utf-8")
    return path


def crank_view(user: User) -> TimingView:
    """Timing chart in which the user has chosen the last entry of the list of axes."""
    view = user.window.show_view("timing")
    settle()
    assert isinstance(view, TimingView)
    view.unit.setFocus()
    QTest.keyClick(view.unit, Qt.Key.Key_End)
    settle()
    assert view.unit.currentText() == "crank degrees"
    return view


def design(user: User) -> Design:
    full: Design = user.session.full_design
    return full


def centre(user: User, drive: int) -> float:
    valve = design(user).drives[drive].valve
    assert valve is not None
    return valve.centre_deg


def rows(user: User, drive: int) -> tuple[list[float], list[float], list[float]]:
    """Crank degrees of the rows: durations, opening side, closing side."""
    motion = design(user).drives[drive].motion
    assert motion is not None
    lobe = motion.lobe
    assert lobe is not None
    closing = () if lobe.closing is None else lobe.closing.to_nose
    duration, to_nose, closing_rows = (
        [row.crank_deg for row in rows] for rows in (lobe.duration, lobe.to_nose, closing)
    )
    return duration, to_nose, closing_rows


def place(view: TimingView, drive: int, crank: float, lift: float) -> QPoint:
    """Pixel of a crank angle and a lift of a drive, from the axes of the chart."""
    chart = view.canvas.chart
    high = chart.y(drive, 9.0 / 9.0)
    low = chart.y(drive, 0.0)
    return QPointF(chart.x(crank), low + (high - low) * lift / 9.0).toPoint()


def draw(
    view: TimingView, start: QPoint, degrees: float, keys: Qt.KeyboardModifier = KEYS.NoModifier, drop: bool = True
) -> None:
    pixels = round(degrees * view.canvas.chart.degree)
    QTest.mousePress(view.canvas, LEFT, keys, start)
    for part in (pixels // 2, pixels):
        at = QPointF(start + QPoint(part, 0))
        event = QMouseEvent(QEvent.Type.MouseMove, at, view.canvas.mapToGlobal(at), Qt.MouseButton.NoButton, LEFT, keys)
        QApplication.sendEvent(view.canvas, event)
        settle()
    if drop:
        QTest.mouseRelease(view.canvas, LEFT, keys, start + QPoint(pixels, 0))
        settle()


# -- axis -----------------------------------------------------------------------------------------------


def test_crank_degrees_are_offered_where_there_is_an_engine(same_window: Open, head: Path) -> None:
    user = same_window(head)
    view = crank_view(user)
    assert not view.rows.isVisible()
    QTest.mouseClick(
        view.canvas, LEFT, KEYS.NoModifier, QPointF(view.canvas.chart.x(90.0), view.canvas.height() - 6.0).toPoint()
    )
    settle()
    assert user.window.player.machine == pytest.approx(0.785398, abs=0.02), (
        "a quarter turn of the crank is half that of the cam"
    )
    user.session.start(load(example("transfer_unit")))
    settle()
    assert [view.unit.itemText(i) for i in range(view.unit.count())] == ["degrees", "milliseconds"]
    assert view.unit.currentText() == "degrees"
    assert view.rows.isVisible()
    assert len(view.canvas.chart.bands) == 4


# -- drags ----------------------------------------------------------------------------------------------


def test_a_valve_is_dragged_along_its_centre(same_window: Open, head: Path) -> None:
    user = same_window(head)
    view = crank_view(user)
    draw(view, place(view, INLET, 100.0, 4.0), 12.0)
    moved = centre(user, INLET)
    assert moved == pytest.approx(120.0, abs=1.0)
    assert moved % 0.5 == 0.0
    assert centre(user, EXHAUST) == -112.0
    assert user.steps == [f"Change Inlet centre to {moved:g}°"]
    draw(view, place(view, EXHAUST, -112.0, 4.0), -20.0, KEYS.ControlModifier)
    assert centre(user, EXHAUST) == pytest.approx(-114.0, abs=0.2), "ten times finer"
    draw(view, place(view, INLET, moved, 4.0), 30.0, drop=False)
    assert centre(user, INLET) > 140.0
    assert view.canvas.label == f"Inlet centre  {centre(user, INLET):g}°"
    QTest.keyClick(view.canvas, Qt.Key.Key_Escape)
    settle()
    assert centre(user, INLET) == moved
    QTest.mouseRelease(view.canvas, LEFT)
    user.session.stack.undo()
    user.session.stack.undo()
    assert (centre(user, INLET), centre(user, EXHAUST)) == (108.0, -112.0)


def test_an_edge_writes_its_row_of_the_lobe(same_window: Open, head: Path) -> None:
    """A duration grows by twice the angle of its edge, an angle from one side to the nose by the same angle."""
    user = same_window(head)
    view = crank_view(user)
    draw(view, place(view, INLET, 108.0 + 109.0, 1.27), 3.0)
    (ramp, duration), _, _ = rows(user, INLET)
    assert ramp == 268.0
    assert duration == pytest.approx(224.0, abs=1.5)
    assert duration % 1.0 == 0.0
    assert centre(user, INLET) == 108.0
    assert user.steps == [f"Change Inlet duration at 1.27 mm to {duration:g}°"]
    draw(view, place(view, INLET, 108.0 - 134.0, 0.1524), -6.0)
    assert rows(user, INLET)[0] == [pytest.approx(280.0, abs=1.5), duration], "the opening edge, towards earlier angles"
    draw(view, place(view, EXHAUST, -112.0 - 109.0, 1.27), -3.0)
    assert rows(user, EXHAUST) == ([], [134.0, pytest.approx(112.0, abs=0.75)], [112.0])
    draw(view, place(view, EXHAUST, -112.0 + 112.0, 1.27), 4.0)
    assert rows(user, EXHAUST)[2] == [pytest.approx(116.0, abs=0.75)]
    assert rows(user, EXHAUST)[1][1] == pytest.approx(112.0, abs=0.75)
    assert len(user.steps) == 4


def test_a_lobe_that_cannot_be_is_not_taken(same_window: Open, head: Path) -> None:
    user = same_window(head)
    view = crank_view(user)
    draw(view, place(view, INLET, 108.0 + 109.0, 1.27), 40.0, drop=False)
    assert view.canvas.label.endswith("not possible")
    QTest.mouseRelease(view.canvas, LEFT)
    settle()
    assert rows(user, INLET)[0][1] < 268.0


def test_a_double_click_types_the_centre_or_the_duration(same_window: Open, head: Path) -> None:
    user = same_window(head)
    view = crank_view(user)
    canvas = view.canvas

    def typed(at: QPoint, name: str, value: str) -> None:
        QTest.mouseDClick(canvas, LEFT, KEYS.NoModifier, at)
        assert canvas.typed.isVisible()
        assert canvas.typed.accessibleName() == name
        QTest.keyClicks(canvas.typed, value)
        QTest.keyClick(canvas.typed, Qt.Key.Key_Return)
        settle()

    typed(place(view, INLET, 90.0, 3.0), "Inlet centre", "106.25")
    assert centre(user, INLET) == 106.25
    typed(place(view, INLET, 106.25 - 109.0, 1.27), "Inlet duration at 1.27 mm", "215.3")
    assert rows(user, INLET)[0] == [268.0, 215.3]
    typed(place(view, EXHAUST, -112.0 + 112.0, 1.27), "Exhaust from 1.27 mm to the nose", "114")
    assert rows(user, EXHAUST)[2] == [114.0]
    typed(place(view, INLET, 106.25 + 107.65, 1.27), "Inlet duration at 1.27 mm", "300")
    assert canvas.typed.is_refused
    assert "allowed" in canvas.typed.refusal.text()
    assert "268" in canvas.typed.refusal.text()
    assert rows(user, INLET)[0] == [268.0, 215.3]


# -- what is drawn --------------------------------------------------------------------------------------


def svg_texts(data: bytes) -> list[tuple[str, float]]:
    """Texts of a chart and their left ends, in the units of the drawing."""
    found = []

    def walk(element: ElementTree.Element, across: float) -> None:
        transform = element.get("transform", "")
        if transform.startswith("matrix("):
            across = float(transform[7:-1].split(",")[4])
        if element.tag.endswith("text"):
            found.append(("".join(element.itertext()).strip(), across + float(element.get("x", "0"))))
        for child in element:
            walk(child, across)

    walk(ElementTree.fromstring(data), 0.0)
    return found


def test_the_picture_has_dead_centres_and_the_figures_of_the_card(
    same_window: Open, head: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    user = same_window(head)
    data = crank_view(user).picture(".svg")
    texts = svg_texts(data)
    assert [word for word, _ in sorted(texts, key=lambda row: row[1]) if word in ("TDC", "BDC")] == [
        "TDC", "BDC", "TDC", "BDC", "TDC",
    ]  # fmt: skip
    assert command(["valve", str(head), "--at", "1", "--json"]) == 0
    card = json.loads(capsys.readouterr().out)
    words = " ".join(word for word, _ in texts)
    assert "separation 110°" in words
    assert "advance 2°" in words
    (overlap,) = [row["deg"] for row in card["pairs"][0]["overlap"] if row["of"] == "valve"]
    assert f"overlap {overlap:.4g}°" in words
    out = tmp_path / "chart.svg"
    assert main(["--headless", "timing", str(head), "--axis", "crank", "--out", str(out)]) == 0
    assert [word for word, _ in svg_texts(out.read_bytes())] == [word for word, _ in texts]


def test_curves_pass_through_the_typed_rows_and_the_overlap_is_shaded(same_window: Open, head: Path) -> None:
    view = crank_view(same_window(head))
    picture = view.canvas.grab().toImage()
    ratio = picture.devicePixelRatio()

    def colour(crank: float, lift: float, drive: int = INLET) -> tuple[int, int, int]:
        at = place(view, drive, crank, lift) * ratio
        seen = picture.pixelColor(at.x(), at.y())
        return seen.red(), seen.green(), seen.blue()

    paper = tuple(int(LIGHT.paper[k : k + 2], 16) for k in (1, 3, 5))
    shaded, single = colour(-6.0, 0.5), colour(60.0, 0.5)
    assert shaded[0] - shaded[2] > 25, "reddish where both valves are open"
    assert single[2] >= single[0], "bluish below the inlet alone"
    assert colour(-290.0, 4.0) == paper
    joins = view.canvas.chart.bands[INLET].joins
    assert sorted(joins) == pytest.approx([108.0 - 134.0, 108.0 - 109.0, 108.0, 108.0 + 109.0, 108.0 + 134.0], abs=1e-6)


def test_another_cylinder_has_its_own_dead_centres(same_window: Open, tmp_path: Path) -> None:
    path = tmp_path / "second.toml"
    path.write_text(text(cylinder="cylinder_deg = 90.0\n"), encoding="utf-8")
    user = same_window(path)
    view = crank_view(user)
    marks = {word for word, _ in svg_texts(view.picture(".svg"))}
    assert {"TDC", "BDC"} <= marks
    assert view.canvas.chart.bands[INLET].joins[0] == pytest.approx(198.0)
    draw(view, place(view, INLET, 198.0, 4.0), 10.0)
    assert centre(user, INLET) == pytest.approx(118.0, abs=1.0), "from TDC of overlap of its own cylinder"


def test_a_pushrod_train_shows_the_lift_of_its_valve(same_window: Open, tmp_path: Path) -> None:
    """The lobe lifts 7 mm and the valve more; a lash is taken off."""
    path = tmp_path / "pushrod.toml"
    train = example("pushrod_train").read_text(encoding="utf-8")
    path.write_text(f"{train}\n{ENGINE}[valve]\ncentre_deg = 110.0\nlash_mm = 0.2\n", encoding="utf-8")
    user = same_window(path)
    view = crank_view(user)
    (band,) = view.canvas.chart.bands
    lift = quantity("valve_lift").values(Study(load(path), 3600))
    assert band.stroke == pytest.approx(lift.max(), rel=1e-4)
    assert band.stroke > 8.0
    draw(view, view.canvas.chart.join_position(0, 0).toPoint() + QPoint(0, 20), -20.0)
    assert centre(user, 0) == pytest.approx(90.0, abs=1.0), "a drive alone, against the crank"
    assert user.steps == [f"Change Pushrod train centre to {centre(user, 0):g}°"]


def test_the_piston_is_the_least_clearance_above_the_valve(
    same_window: Open, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A flat crown: the clearance is along the cylinder, the lift along the valve."""
    path = example("valve_train")
    view = crank_view(same_window(path))
    assert command(["valve", str(path), "--json"]) == 0
    inlet = json.loads(capsys.readouterr().out)["valves"][0]
    words = " ".join(word for word, _ in svg_texts(view.picture(".svg")))
    assert f"Inlet: least clearance to the piston {inlet['clearance']['least_mm']:.4g} mm" in words
    curve = crank_curves(load(path))[INLET]
    assert curve.clearance is not None
    assert curve.piston is not None
    k = int(curve.clearance.argmin())
    assert curve.crank[k] == pytest.approx(inlet["clearance"]["crank_deg"], abs=1.0)
    assert curve.piston[k] - curve.lift[k] == pytest.approx(
        inlet["clearance"]["least_mm"] / math.cos(math.radians(15.0)), rel=1e-3
    )


# -- lobes over the machine angle -------------------------------------------------------------------------------


def machine_view(user: User, axis: str) -> TimingView:
    """Timing chart over the machine angle in degrees or milliseconds."""
    view = crank_view(user)
    view.unit.setFocus()
    QTest.keyClick(view.unit, Qt.Key.Key_Home)
    if axis == "milliseconds":
        QTest.keyClick(view.unit, Qt.Key.Key_Down)
    settle()
    assert view.unit.currentText() == axis
    return view


def on_curve(view: TimingView, drive: int, machine: float, lift: float) -> QPoint:
    """Pixel of a machine angle and a lift of a drive."""
    return QPointF(view.canvas.chart.x(machine), view.canvas.chart.y(drive, lift / 9.0)).toPoint()


@pytest.mark.parametrize("axis", ["degrees", "milliseconds"])
def test_an_edge_of_a_lobe_is_dragged_over_the_machine_angle(same_window: Open, head: Path, axis: str) -> None:
    """2° of the machine later are 4° of the crank, on one of both sides: 8° of the whole duration."""
    user = same_window(head)
    view = machine_view(user, axis)
    closes = on_curve(view, INLET, (108.0 + 109.0) / 2.0, 1.27)
    draw(view, closes, 2.0)
    durations, *_ = rows(user, INLET)
    assert durations[0] == 268.0
    assert durations[1] == pytest.approx(226.0, abs=1.0)
    assert user.steps[-1].startswith("Change Inlet duration at 1.27 mm to ")
    user.choose("Edit", f"Undo {user.steps[-1]}")
    assert rows(user, INLET)[0] == [268.0, 218.0]


def test_the_end_of_a_lobe_moves_its_lowest_row_and_the_nose_its_centre(same_window: Open, head: Path) -> None:
    user = same_window(head)
    view = machine_view(user, "degrees")
    chart = view.canvas.chart
    joins = chart.bands[INLET].joins
    end = max(range(len(joins)), key=lambda k: joins[k] if joins[k] < 200.0 else 0.0)
    draw(view, chart.join_position(INLET, end).toPoint(), 2.0)
    durations, *_ = rows(user, INLET)
    assert durations[0] == pytest.approx(276.0, abs=1.0)
    assert durations[1] == 218.0
    before = centre(user, INLET)
    nose = on_curve(view, INLET, before / 2.0, 9.0)
    draw(view, nose, 3.0)
    assert centre(user, INLET) == pytest.approx(before + 6.0, abs=1.0)
    assert rows(user, INLET)[0] == durations


def test_a_duration_is_typed_at_its_point_over_the_machine_angle(same_window: Open, head: Path) -> None:
    user = same_window(head)
    view = machine_view(user, "milliseconds")
    QTest.mouseDClick(view.canvas, LEFT, pos=on_curve(view, INLET, (108.0 + 109.0) / 2.0, 1.27))
    settle()
    assert view.canvas.typed.text() == "218"
    QTest.keyClicks(view.canvas.typed, "222")
    QTest.keyClick(view.canvas.typed, Qt.Key.Key_Return)
    settle()
    assert rows(user, INLET)[0] == [268.0, 222.0]
