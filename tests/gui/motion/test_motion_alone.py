"""A motion without a mechanism in the window: every view bears it, its advance is edited, and it is begun by two dialogs."""

from pathlib import Path

import numpy as np
import pytest
from feeds import FEED
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPushButton
from window_user import Open, User, answering, settle, wait_for

from core.project import load
from core.study import findings_of
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.forms.refusal import FloatingRefusal
from kindyna_gui.graph.plots_view import PlotView
from kindyna_gui.motion.diagram import join_positions
from kindyna_gui.motion.laws_plot import NewMotionDialog
from kindyna_gui.settings import choose
from kindyna_gui.window.tasks import TASKS


@pytest.fixture
def user(same_window: Open, tmp_path: Path) -> User:
    file = tmp_path / "feed.toml"
    file.write_text(FEED, encoding="utf-8")
    return same_window(file)


@pytest.mark.stress
def test_every_view_shows_it_or_says_why_not(user: User) -> None:
    for task in TASKS:
        user.window.show_task(task)
        settle()
    troubled = set()
    for name in (
        "motion",
        "mechanism",
        "displacement",
        "torque",
        "graph",
        "certificate",
        "findings",
        "timing",
        "polygon",
    ):
        if user.see(name).in_trouble:
            troubled.add(name)
    assert not troubled


def test_its_advance_is_a_field_beside_start_and_stroke(user: User) -> None:
    assert set(user.motion().header.fields) == {"motion.start_mm", "motion.advance_mm", "motion.stroke_mm"}
    user.enter("motion.advance_mm", "280")
    assert [s.rise for s in user.design.drive.motion.segments] == [150.0, 0.0, 130.0, 0.0]
    user.choose("File", "Save")
    assert load(user.session.path) == user.design
    # the diagram goes on to where the next turn begins
    diagram = user.motion().diagram
    scale = diagram.scale_now()
    *_, (join, x, y) = join_positions(user.design.drive.motion, scale)
    assert (join, x, y) == (0, scale.x(360.0), scale.y(290.0))


def test_force_and_power_stand_where_a_cam_has_torque_and_contact_force(user: User) -> None:
    plot = user.see("torque")
    assert isinstance(plot, PlotView)
    assert user.window.docks["torque"].windowTitle() == "Force"
    wait_for(lambda: len(plot.plot.marked()) == 2)
    high = max(each.value for each in plot.plot.marked())
    seconds = 1.0 / 3.0
    cycloid = 12.0 * 2.0 * np.pi * 0.150 / seconds**2
    assert high == pytest.approx(cycloid + 20.0 + 15.0, rel=1e-9)


def test_the_ends_of_a_table_are_chosen_above_its_rows(same_window: Open, tmp_path: Path) -> None:
    table = 'law = "table"\npoints = [[0.0, 0.0], [40.0, 60.0], [120.0, 150.0]]'
    file = tmp_path / "table.toml"
    file.write_text(
        FEED.replace('law = "3-4-5"', table).replace('"cycloidal"', '"constant-velocity"'), encoding="utf-8"
    )
    user = same_window(file)
    user.motion().choose(0)
    settle()
    assert user.motion().curve.points is not None
    for end, word in (("start", "free"), ("end", "joined")):
        box = user.motion().curve.fields[f"motion.segments[0].{end}"].editor
        assert isinstance(box, WordBox)
        box.setCurrentIndex(box.findData(word))
        box.activated.emit(box.currentIndex())
        settle()
        assert getattr(user.design.drive.motion.segments[0].curve, end) == word
    user.choose("File", "Save")
    assert load(user.session.path) == user.design


def type_number(dialog: NewMotionDialog, name: str, text: str) -> None:
    box = dialog.form.boxes[name]
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, text)
    settle()


def test_an_indexer_is_begun(user: User) -> None:
    def act(dialog: NewMotionDialog) -> None:
        type_number(dialog, "stops", "8")
        type_number(dialog, "dwell_deg", "100")
        assert not dialog.accept_button.isEnabled()
        (line,) = (line for line in dialog.findChildren(FloatingRefusal) if line.isVisible())
        assert "Index angle and dwell add up to 370" in line.text()
        assert dialog.form.boxes["dwell_deg"].is_refused
        assert list(line.buttons) == ["Back to 90°"]
        type_number(dialog, "index_deg", "260")
        assert not line.isVisible()
        assert "advance 45" in dialog.summary.text()
        next(b for b in dialog.findChildren(QPushButton) if b.text() == "Copy as command").click()
        dialog.accept_button.click()

    with answering(NewMotionDialog, act):
        user.choose("File", "New by type", "Indexer...")
    words = "kindyna --headless indexer --stops 8 --index 260.0 --dwell 100.0 --out indexer.toml"
    assert QApplication.clipboard().text() == words
    motion = user.design.drive.motion
    assert (motion.advance, [s.rise for s in motion.segments]) == (45.0, [45.0, 0.0])
    assert user.session.study.stages == ("motion",)


def test_a_flying_shear_runs_with_its_material(user: User) -> None:
    with answering(NewMotionDialog, lambda dialog: dialog.accept_button.click()):
        user.choose("File", "New by type", "Flying shear...")
    study = user.session.study.full_turn
    theta = np.rad2deg(study.theta)
    window = (theta > 71.0) & (theta < 129.0)
    assert study.motion.y[1][window] * 2.0 * np.pi == pytest.approx(0.5, rel=1e-12)  # 500 mm a turn
    assert findings_of(study) == ()


def test_the_figures_of_a_turn_stand_above_the_diagram(user: User) -> None:
    text = user.motion().header.cycle.text()
    assert text.startswith(
        "Mean speed 300 mm/s; index error 0 mm; rms 64.63 N; energy 15.03 J a turn, 10.5 J with recovery"
    )
    assert user.motion().header.cycle.isVisible()


def test_the_figures_of_a_turn_have_the_units_on_display(user: User) -> None:
    choose({"velocity": "in/s", "force": "lbf"}, comma=False)
    try:
        text = user.motion().header.cycle.text()
    finally:
        choose({}, comma=False)
    assert text.startswith("Mean speed 11.81 in/s; index error 0 mm; rms 14.53 lbf; ")


def test_the_drawing_goes_on_turn_by_turn_or_comes_back(user: User) -> None:
    view = user.drawing()

    def place() -> float:
        view.pull()
        ((body),) = (b for b in view.scene.geometry.moving.values())
        z = body.z[view.scene.index]
        return float(z.real + z.imag)  # along one of the axes

    user.turn(200.0)
    first = place()
    for _ in range(4):
        user.window.player.step(90.0)
    assert place() - first == pytest.approx(300.0, abs=1e-9)
    assert view.scene.overlay.text == "Cam angle 200.0° + 1 turn"
    for _ in range(8):
        user.window.player.step(-90.0)
    assert place() - first == pytest.approx(-300.0, abs=1e-9)
    view.show_layer("modulo", True)
    settle()
    assert place() == pytest.approx(first, abs=1e-9)
    view.show_layer("modulo", False)
    settle()
    assert place() - first == pytest.approx(-300.0, abs=1e-9)
    user.turn(200.0)
    assert place() == pytest.approx(first, abs=1e-9)
