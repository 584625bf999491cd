"""kindyna_gui.graph.plots_view, live_plot, shown: curves in docks, and the cam angle set by the mouse."""

from collections.abc import Callable
from io import BytesIO
from math import degrees, radians
from pathlib import Path

import numpy as np
import pytest
from mechanisms import LIFT, PUSHER, with_follower, with_loads, with_shaft
from PIL import Image
from plot_reading import message
from PySide6.QtCore import QBuffer, QEvent, QObject, QPoint, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from window_user import Alone, User, settle, wait_for

from core.design import Design
from core.output.channels import channel
from core.output.export import files
from core.study import Study
from kindyna_gui import dialogs
from kindyna_gui.documents.session import Session
from kindyna_gui.graph.marked_view import marks_action
from kindyna_gui.graph.plots_view import PlotView
from kindyna_gui.pictures.units import measure, readable
from kindyna_gui.player import Player
from kindyna_gui.saving import numbers

Show = Callable[..., PlotView]
JAMMED = with_loads(with_follower(PUSHER, offset_mm=0.0), friction=3.5)


@pytest.fixture
def show(alone: Alone) -> Show:
    """Shows a plot in a window of its own."""

    def make(*quantities: str, design: Design = LIFT) -> PlotView:
        return alone(PlotView(Session(design), Player(), quantities), 520, 280)

    return make


def pixel(view: PlotView, angle: float) -> QPoint:
    return view.plot.pixel_at(angle).toPoint()


# -- what is drawn ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("quantities", "stages"),
    [
        (("displacement",), ("motion",)),
        (("phi",), ("linkage",)),
        (("pitch_curvature", "profile_curvature"), ("cam",)),
        (("drive_torque", "motor_torque"), ("dynamics",)),
        (("jerk", "contact_force"), ("motion", "dynamics")),
    ],
)
def test_the_stages_are_those_of_the_channels(quantities: tuple[str, ...], stages: tuple[str, ...], show: Show) -> None:
    assert show(*quantities).stages == stages


def test_an_edit_is_drawn_at_once(show: Show) -> None:
    view = show("displacement")
    before = view.plot.readings()
    view.session.edit("motion.stroke", 160.0, "a")
    assert view.plot.readings() != before
    assert view.plot.readings() == ["160.0 mm"]
    view.session.stack.undo()
    assert view.plot.readings() == before


def test_a_small_edit_leaves_the_axis_and_a_large_one_does_not(show: Show) -> None:
    """The curve is another one each time, within its axis; little of that is empty."""
    view = show("contact_force")
    ranges = []
    for mass in (200.0, 200.5, 201.0, 600.0):
        view.session.edit("loads.slider_mass_kg", mass, "a")
        values = channel(LIFT, "contact_force_n").values(view.session.study) / 1e3
        low, high = view.plot.getViewBox().viewRange()[1]
        assert low < min(values.min(), 0.0)
        assert values.max() < high < 1.3 * values.max()
        ranges.append((low, high))
    assert ranges[0] == ranges[1] == ranges[2] != ranges[3]


@pytest.mark.parametrize("slug", ["velocity_mm_s", "pressure_angle_deg", "contact_force_n", "drive_torque_nm"])
def test_the_value_at_the_cursor_is_exact(slug: str, show: Show) -> None:
    """Not that of the nearest sample: a tenth of a degree beside it the velocity is another."""
    row = channel(LIFT, slug)
    view = show(row.name)
    for angle in (0.0, 36.13, 57.31, 300.07, 359.99):
        view.player.set_theta(radians(angle))
        value = float(row.values(Study(LIFT).at_theta(np.array([view.player.theta])))[0])
        peak = float(np.abs(row.values(view.session.study)).max())
        display_unit = readable(row.unit.symbol, peak)
        assert view.plot.readings() == [measure(value / display_unit.size, display_unit.symbol)]


# -- what is missing is told ------------------------------------------------------------------------------


def test_where_the_guide_jams_the_motor_torque_is_missed_in_words(show: Show) -> None:
    view = show("drive_torque", "motor_torque", design=JAMMED)
    assert not view.in_trouble
    assert [row.name for row in view.rows] == ["drive_torque"]
    assert view.note.isVisible()
    assert view.note.text().startswith("No motor torque with flywheel: ")
    assert "jam" in view.note.text()


def test_a_plot_of_nothing_but_what_is_missing_says_why(show: Show) -> None:
    view = show("motor_torque", design=JAMMED)
    assert view.rows == ()
    assert view.plot.readings() == []
    assert "jam" in message(view.plot)
    view.player.step(1.0)
    assert view.plot.readings() == []


def test_another_kind_of_follower_has_other_quantities(show: Show) -> None:
    view = show("phi", "beta", design=PUSHER)
    assert "this mechanism has no phi nor beta" in message(view.plot).lower()


def test_equal_curves_are_drawn_once_and_named(show: Show) -> None:
    view = show("drive_torque", "motor_torque")
    assert len(view.plot.readings()) == 1
    assert view.note.text() == "Motor torque with flywheel equals a curve that is shown"
    view.session.put(with_shaft(LIFT, flywheel_inertia_kg_m2=2000.0), "a")
    assert len(view.plot.readings()) == 2
    assert not view.note.isVisible()


def test_without_a_linkage_the_plot_says_why(show: Show) -> None:
    view = show("phi")
    view.session.put(with_follower(LIFT, rod_mm=400.0, guide_height_mm=600.0), "a")
    assert view.in_trouble
    view.session.stack.undo()
    assert not view.in_trouble
    assert view.plot.readings()


# -- the mouse --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", [0.0, 45.0, 200.5, 359.0])
def test_a_click_sets_the_cam_angle(angle: float, show: Show) -> None:
    view = show("displacement")
    view.player.play(True)
    QTest.mouseClick(view.plot.viewport(), Qt.MouseButton.LeftButton, pos=pixel(view, angle))
    assert degrees(view.player.theta) == pytest.approx(angle, abs=1.0)
    assert not view.player.playing


def test_a_drag_draws_the_cursor(show: Show) -> None:
    view = show("acceleration")
    told: list[float] = []
    view.player.angle_changed.connect(told.append)
    viewport = view.plot.viewport()
    QTest.mousePress(viewport, Qt.MouseButton.LeftButton, pos=pixel(view, 50.0))
    for angle in (80.0, 120.0, 160.0):
        QTest.mouseMove(viewport, pixel(view, angle))
    QTest.mouseRelease(viewport, Qt.MouseButton.LeftButton, pos=pixel(view, 160.0))
    assert np.rad2deg(told) == pytest.approx([50.0, 80.0, 120.0, 160.0], abs=1.0)
    assert degrees(view.plot.angle) == pytest.approx(degrees(view.player.theta))


def test_beside_the_axes_a_drag_stays_at_their_ends(show: Show) -> None:
    view = show("displacement")
    assert view.plot.angle_at(QPointF(1.0, 50.0)) == 0.0
    assert view.plot.angle_at(QPointF(view.plot.width() - 1.0, 50.0)) == 360.0


def test_other_buttons_move_nothing(show: Show) -> None:
    view = show("displacement")
    for button in (Qt.MouseButton.RightButton, Qt.MouseButton.MiddleButton):
        QTest.mousePress(view.plot.viewport(), button, pos=pixel(view, 90.0))
        QTest.mouseRelease(view.plot.viewport(), button, pos=pixel(view, 90.0))
    assert view.player.theta == 0.0


def test_a_plot_without_curves_moves_nothing(show: Show) -> None:
    view = show("motor_torque", design=JAMMED)
    QTest.mouseClick(view.plot.viewport(), Qt.MouseButton.LeftButton, pos=QPoint(300, 100))
    assert view.player.theta == 0.0


def test_keys_over_a_plot_are_the_players(show: Show) -> None:
    view = show("displacement")
    QTest.keyClick(view.plot, Qt.Key.Key_Right, Qt.KeyboardModifier.ControlModifier)
    assert degrees(view.player.theta) == pytest.approx(10.0)


# -- files ------------------------------------------------------------------------------------------------


@pytest.fixture
def picks(monkeypatch: pytest.MonkeyPatch) -> Callable[[str, Path | None], list[Path]]:
    """What the user will pick in a dialog; what was suggested is noted."""

    def pick(dialog: str, path: Path | None) -> list[Path]:
        suggested: list[Path] = []

        def answer(_: object, suggestion: Path) -> Path | None:
            suggested.append(suggestion)
            return path

        monkeypatch.setattr(dialogs, dialog, answer)
        return suggested

    return pick


def as_shown(widget: QWidget) -> bytes:
    """A widget as it stands on the screen, as PNG."""
    data = QBuffer()
    widget.grab().save(data, "PNG")
    return bytes(data.data().data())


def act(view: PlotView, text: str) -> None:
    """An entry of the menu that a right click opens."""
    assert view.plot.contextMenuPolicy() == Qt.ContextMenuPolicy.CustomContextMenu
    next(a for a in view.plot.actions() if a.text() == text).trigger()


def test_the_numbers_are_those_of_the_core(show: Show, tmp_path: Path, picks: Callable[..., list[Path]]) -> None:
    view = show("pressure_angle")
    told: list[str] = []
    view.status_message.connect(told.append)
    suggested = picks("table_to_save", tmp_path / "p.csv")
    act(view, "Export numbers...")
    text = (tmp_path / "p.csv").read_text("utf-8")
    assert suggested[0].name == "pressure_angle.csv"
    assert told == [f"Wrote {tmp_path / 'p.csv'}"]
    whole = files(Study(LIFT), ("cam",))["profile.csv"]
    names, *rows = [line.split(",") for line in whole.splitlines()]
    at = [names.index(name) for name in ("cam_angle_deg", "pressure_angle_deg")]
    assert text == "\n".join(",".join(row[i] for i in at) for row in [names, *rows]) + "\n"


def test_numbers_of_several_channels_stand_side_by_side() -> None:
    rows = [channel(LIFT, slug) for slug in ("phi_deg", "contact_force_n")]
    lines = numbers(LIFT, rows).splitlines()
    assert lines[0] == "cam_angle_deg,phi_deg,contact_force_n"
    assert len(lines) == 3601


@pytest.mark.parametrize("ending", [".png", ".svg"])
def test_the_picture_is_the_plot_on_paper(
    ending: str, show: Show, tmp_path: Path, picks: Callable[..., list[Path]]
) -> None:
    view = show("velocity")
    picks("picture_to_save", tmp_path / f"v{ending}")
    act(view, "Export picture...")
    data = (tmp_path / f"v{ending}").read_bytes()
    if ending == ".png":
        assert np.asarray(Image.open(BytesIO(data)).convert("L")).min() < 100
    else:
        assert b"Velocity" in data
        assert LIFT.name.encode() in data


def test_a_cancelled_dialog_writes_nothing(show: Show, tmp_path: Path, picks: Callable[..., list[Path]]) -> None:
    view = show("velocity")
    told: list[str] = []
    view.status_message.connect(told.append)
    picks("table_to_save", None)
    picks("picture_to_save", None)
    act(view, "Export numbers...")
    act(view, "Export picture...")
    assert told == []
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_cannot_be_written_is_told(
    show: Show, tmp_path: Path, picks: Callable[..., list[Path]], monkeypatch: pytest.MonkeyPatch
) -> None:
    view = show("velocity")
    shown: list[str] = []
    monkeypatch.setattr(dialogs, "show_faults", lambda _, what, lines: shown.append(what))
    picks("table_to_save", tmp_path / "nowhere" / "v.csv")
    act(view, "Export numbers...")
    assert shown == ["v.csv cannot be written."]


# -- in the window ----------------------------------------------------------------------------------------


def test_one_angle_for_all(whole: User) -> None:
    whole.choose("View", "Dyna")
    for name in ("displacement", "pressure_angle"):
        view = whole.see(name)
    assert isinstance(view, PlotView)
    QTest.mouseClick(view.plot.viewport(), Qt.MouseButton.LeftButton, pos=pixel(view, 300.0))
    settle()
    theta = whole.window.player.theta
    assert degrees(theta) == pytest.approx(300.0, abs=1.0)
    for name in ("torque", "contact_force"):
        other = whole.see(name)
        assert isinstance(other, PlotView)
        assert other.plot.angle == theta


@pytest.mark.stress
def test_what_was_written_is_told_in_the_status_line(whole: User, tmp_path: Path) -> None:
    view = whole.see("displacement")
    assert isinstance(view, PlotView)
    whole.picks("table_to_save", tmp_path / "d.csv")
    act(view, "Export numbers...")
    assert whole.window.status.currentMessage() == f"Wrote {tmp_path / 'd.csv'}"


def test_an_edit_paints_each_plot_once_and_those_it_leaves_alone_not_at_all(whole: User) -> None:
    painted: list[str] = []

    class Watch(QObject):
        def eventFilter(self, watched: QObject, event: QEvent) -> bool:
            if event.type() == QEvent.Type.Paint:
                painted.append(watched.objectName())
            return False

    watch = Watch()
    marks_action(whole.session).setChecked(False)  # they come later
    whole.choose("View", "Dyna")
    whole.window.docks["displacement"].setParent(None)
    whole.window.addDockWidget(Qt.DockWidgetArea.RightDockWidgetArea, whole.window.docks["displacement"])
    whole.number("follower.rod_mm")
    for name in ("displacement", "torque", "contact_force"):
        view = whole.see(name)
        assert isinstance(view, PlotView)
        view.plot.viewport().setObjectName(name)
        view.plot.viewport().installEventFilter(watch)
    settle()
    painted.clear()
    assert whole.session.edit("follower.rod_mm", 850.0, "a")
    settle()
    assert sorted(painted) == ["contact_force", "torque"]


@pytest.mark.stress
def test_a_plot_after_edits_is_what_a_fresh_plot_shows(show: Show) -> None:
    """However much of it is kept on the way."""
    view = show("pitch_curvature", "profile_curvature")
    other = show("drive_torque", "motor_torque")
    edits = (
        ("cam.base_radius_mm", 380.0),
        ("cam.roller_radius_mm", 120.0),
        ("shaft.flywheel_inertia_kg_m2", 900.0),
        ("motion.stroke", 120.0),
        ("shaft.flywheel_inertia_kg_m2", 0.0),
    )
    for path, value in edits:
        for plot in (view, other):
            plot.session.edit(path, value, "a")
            fresh = PlotView(plot.session, plot.player, plot.quantities)
            fresh.resize(plot.size())
            fresh.show()
            settle()
            for shown in (fresh, plot):
                shown.settle()
            wait_for(lambda fresh=fresh, plot=plot: not fresh.busy and not plot.busy)  # type: ignore[misc]
            settle()
            one, two = (Image.open(BytesIO(as_shown(widget))).convert("RGB") for widget in (fresh, plot))
            apart = np.abs(np.asarray(one, dtype=int) - np.asarray(two, dtype=int)).max(axis=2) > 0
            assert apart[:, :-20].sum() == 0, path
            assert apart.sum() < 400, "the last line of the grid may stand a pixel beside"
            fresh.close()
            fresh.deleteLater()
