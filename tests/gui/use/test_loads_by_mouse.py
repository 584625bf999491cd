"""Loads with the mouse alone: a mass, a spring and a load of a four-bar, clicked in its drawing, dragged, chosen and picked anew."""

from typing import Any

import numpy as np
import pytest
from plot_reading import curves
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QMenu, QStyle, QStyleOptionSpinBox, QWidget
from window_user import Open, User, pixel, plain, settle, wait_for

from core.design import Attachment, get
from core.output.load_text import attachment_text
from core.project import dumps, loads
from core.study import Study
from kindyna_gui.documents.edits import SAMPLES
from kindyna_gui.forms.loads_page import LoadsPage
from kindyna_gui.places import example

LEFT = Qt.MouseButton.LeftButton


def click(widget: QWidget, at: QPoint | None = None) -> None:
    QTest.mouseClick(widget, LEFT, pos=widget.rect().center() if at is None else at)
    settle()


def menu(user: User, *way: str) -> None:
    """Click from menu to menu."""
    place: Any = user.window.menuBar()
    for text in way:
        action = next(a for a in place.actions() if plain(a.text()) == text)
        QTest.mouseClick(place, LEFT, pos=place.actionGeometry(action).center())
        settle()
        if isinstance(action.menu(), QMenu):
            place = action.menu()
            wait_for(place.isVisible)


def point(user: User, name: str) -> complex:
    """Where a point, or the end of a spring, stands in the drawing now [mm]."""
    scene = user.drawing().scene
    assert scene.geometry is not None
    return scene.geometry.handles(scene.index)[name]


def click_at(user: User, at: complex) -> None:
    """Click a place of the drawing [mm]."""
    canvas = user.drawing().canvas
    click(canvas.viewport(), pixel(canvas, at))


def page(user: User) -> LoadsPage:
    return user.parameters().loads


def names(user: User) -> list[str]:
    return [row.cells[0] for row in page(user).table.rows.rows]


def arrow_up(user: User, path: str, times: int) -> None:
    box = user.parameters().field(path).editor  # type: ignore[union-attr]
    for _ in range(times):
        option = QStyleOptionSpinBox()
        box.initStyleOption(option)  # type: ignore[arg-type]
        part = QStyle.SubControl.SC_SpinBoxUp
        click(box, box.style().subControlRect(QStyle.ComplexControl.CC_SpinBox, option, part, box).center())


@pytest.mark.stress
def test_a_four_bar_gets_a_mass_a_spring_and_a_load_with_the_mouse_alone(open_user: Open) -> None:
    user = open_user(size=(1280, 720), whole=True)
    menu(user, "File", "Examples", "Four bar")
    menu(user, "View", "Dyna")
    menu(user, "Dyna", "Add to the loads", "Mass")
    assert "click a link" in user.window.status.currentMessage()
    click_at(user, (point(user, "A") + point(user, "B")) / 2.0)
    menu(user, "Dyna", "Add to the loads", "Spring and damper")
    click_at(user, complex(20.0, -30.0))
    assert "click the second point" in user.window.status.currentMessage()
    click_at(user, point(user, "B"))
    menu(user, "Dyna", "Add to the loads", "Process force")
    click_at(user, point(user, "C"))
    arrow_up(user, "loads.process[0].force_n", 2)

    drive = user.design.drive.loads
    assert [(m.link, m.centre_x_mm, m.centre_y_mm) for m in drive.masses] == [(3, 45.0, 0.0)]
    assert drive.springs[0].from_ == Attachment(link=1, x_mm=20.0, y_mm=-30.0)
    assert (drive.springs[0].to.point, drive.process[0].link, drive.process[0].point) == ("B", 3, "C")
    assert drive.process[0].force_n != -100.0
    assert names(user) == ["General values", "Mass of link 3", "Spring 1", "Process force 1"]

    torque: Any = user.window.view("torque")
    wait_for(lambda: torque.on_screen() and torque.up_to_date)
    (curve,) = curves(torque.plot)
    study = Study(loads(dumps(user.design)), SAMPLES)
    angle = np.rad2deg(study.theta)
    smooth = np.abs(angle % 90.0 - 45.0) < 44.0  # away from where the force switches
    assert np.interp(angle, curve.x, curve.y)[smooth] == pytest.approx(
        study.dynamics.driver[smooth], rel=1e-9, abs=1e-9
    )
    assert np.ptp(study.dynamics.driver) > 1.0


def test_a_mass_is_clicked_anywhere_on_the_face_of_a_link(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    user.choose("Dyna", "Add to the loads", "Mass")
    a, b, c = (point(user, name) for name in "ABC")
    click_at(user, (a + b + c) / 3.0)  # the middle of the coupler, a plate
    mass = user.design.drive.loads.masses[0]
    assert mass.link == 3
    assert point(user, "loads.masses[0]") == pytest.approx((a + b + c) / 3.0, abs=0.5)

    user.choose("Dyna", "Add to the loads", "Mass")
    o4 = point(user, "O4")
    beside = (o4 + b) / 2.0 + 3.5j * (b - o4) / abs(
        b - o4
    ) / user.drawing().canvas.scale_now  # in the bar, off its line
    click_at(user, beside)
    assert [m.link for m in user.design.drive.loads.masses] == [3, 4]
    assert point(user, "loads.masses[1]") == pytest.approx(beside, abs=0.5)

    user.session.stack.setClean()
    user.window.documents.open_path(example("lecture_six_bar"))
    user.choose("Dyna", "Add to the loads", "Mass")
    block = user.drawing().scene.item("block.6").sceneBoundingRect()
    click_at(user, complex(block.left() + 0.2 * block.width(), block.center().y()))
    assert user.design.drive.loads.masses[-1].link == 6


def test_a_free_end_is_dragged_in_one_step_and_a_click_chooses_the_row(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    user.choose("Dyna", "Add to the loads", "Spring and damper")
    click_at(user, complex(60.0, -20.0))
    click_at(user, (2.0 * point(user, "A") + point(user, "C")) / 3.0)  # a place on the coupler's edge
    held = user.design.drive.loads.springs[0].to
    assert (held.link, held.point) == (3, None)
    steps = len(user.steps)
    user.drag(point(user, "loads.springs[0].from"), complex(80.0, -40.0))
    assert get(user.design, "loads.springs[0].from.at") == pytest.approx((80.0, -40.0), abs=0.3)
    user.turn(70.0)
    before = point(user, "loads.springs[0].to")
    user.drag(before, before + 10j)  # at another angle: in the frame of the link
    assert point(user, "loads.springs[0].to") == pytest.approx(before + 10j, abs=0.3)
    assert user.steps[steps:] == ["Move first end of spring 1", "Move second end of spring 1"]

    user.session.choose_load("")
    click_at(user, (point(user, "loads.springs[0].from") + 2.0 * point(user, "loads.springs[0].to")) / 3.0)
    assert user.session.load == "loads.springs[0]"
    field = user.parameters().field("loads.springs[0].rate_n_per_mm")
    assert field is not None
    assert field.editor.isVisible()


def test_escape_adds_nothing_and_pick_attaches_elsewhere(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    for _ in range(2):
        user.choose("Dyna", "Add to the loads", "Spring and damper")
        user.press(Qt.Key.Key_Escape)
        assert user.design.drive.loads.springs == ()
        assert not user.drawing().picker.active
    user.choose("Dyna", "Add to the loads", "Spring and damper")
    user.press(Qt.Key.Key_Return)
    user.parameters()
    rows = page(user).attachments["loads.springs[0]"]
    click(rows.buttons["to"])
    click_at(user, complex(5.0, -5.0))  # the first end is on the ground already
    assert "Nothing to select here" in user.window.status.currentMessage()
    click_at(user, point(user, "C"))
    assert attachment_text(user.design, user.design.drive.loads.springs[0].to) == "C of link 3"
    assert user.steps[-1] == "Spring 1: second end C of link 3"


def test_points_keep_their_capitals_in_the_undo_list(same_window: Open) -> None:
    user = same_window(example("slider_crank"))
    force = next(name for name in names(user) if name.startswith("Force at B"))
    user.choose("Dyna", "Remove from the loads", force)
    assert user.steps[-1] == f"Remove f{force[1:]}"


@pytest.mark.stress
def test_rows_are_copied_moved_removed_and_come_back(same_window: Open) -> None:
    user = same_window(example("rocker_cam"))
    for entry in ("Friction", "Spring and damper", "Spring and damper"):
        user.choose("Dyna", "Add to the loads", entry)
        user.press(Qt.Key.Key_Return)
    user.enter("loads.springs[1].rate_n_per_mm", "3")
    both = user.design.drive.loads.springs
    buttons = page(user).buttons
    click(buttons["up"])
    assert user.design.drive.loads.springs == both[::-1]
    assert user.session.load == "loads.springs[0]"
    click(buttons["copy"])
    assert [s.rate_n_per_mm for s in user.design.drive.loads.springs] == [3.0, 3.0, 1.0]
    page(user).table.setFocus()
    user.press(Qt.Key.Key_Delete)
    user.press(Qt.Key.Key_Up, modifier=Qt.KeyboardModifier.AltModifier)
    assert user.design.drive.loads.springs == both
    for _ in range(8):
        user.session.stack.undo()
    assert names(user) == ["General values"]


def test_that_nothing_has_mass_leads_to_the_first_mass(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    findings: Any = user.see("findings")
    wait_for(lambda: bool(findings.findings))
    assert findings.findings[0].code == "no-load"
    button = findings.table.indexWidget(findings.table.rows.index(0, 1))
    assert button.text() == "Add masses"
    click(button)
    assert "Add mass" in user.window.status.currentMessage()
    click_at(user, (point(user, "O4") + point(user, "B")) / 2.0)
    assert user.design.drive.loads.masses[0].link == 4
    user.turn(40.0)
    wanted = (2.0 * point(user, "O4") + point(user, "B")) / 3.0 + 4.0
    user.drag(point(user, "loads.masses[0]"), wanted)  # it is drawn, and moves on its link
    assert point(user, "loads.masses[0]") == pytest.approx(wanted, abs=0.3)
    assert user.steps[-1] == "Move centre of mass of link 4"
    user.choose("Dyna", "Add to the loads", "Mass")
    click_at(user, (2.0 * point(user, "O4") + point(user, "B")) / 3.0)
    assert (len(user.design.drive.loads.masses), user.session.load) == (1, "loads.masses[0]"), "each link has one"
    assert "exists already" in user.window.status.currentMessage()
    wait_for(lambda: not findings.findings)


def test_a_click_on_an_arrow_or_a_spiral_chooses_its_row(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    for entry in ("Force", "Torsion spring and damper"):
        user.choose("Dyna", "Add to the loads", entry)
        user.press(Qt.Key.Key_Return)
    scene = user.drawing().scene
    force = user.design.drive.loads.forces[0]
    arrow = scene.item("load.force1").sceneBoundingRect()
    assert force.y_n == 0.0
    click_at(user, complex(arrow.center().x(), arrow.center().y()))
    assert user.session.load == "loads.forces[0]"
    spiral = scene.item("spring.torsion_spring1").sceneBoundingRect()
    click_at(user, complex(spiral.center().x(), spiral.top() + 0.1))
    assert user.session.load == "loads.torsion_springs[0]"


@pytest.mark.stress
def test_a_click_on_the_closing_spring_leads_to_its_fields(same_window: Open) -> None:
    user = same_window(example("rocker_cam"))
    user.choose("Dyna", "Add to the loads", "Friction")
    user.press(Qt.Key.Key_Return)
    spiral = user.drawing().scene.item("spring.load").sceneBoundingRect()
    click_at(user, complex(spiral.center().x(), spiral.top() + 0.3))
    assert user.session.load == ""
    field = user.parameters().field("loads.spring_rate_nm_per_rad")
    assert field is not None
    assert field.editor.isVisible()
