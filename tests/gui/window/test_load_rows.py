"""Dyna > Add to the loads, Remove from the loads: masses, springs and forces of any design by mouse and keys."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtWidgets import QApplication
from window_user import Open, User, settle

from core.design import TABLE as TABLE_WHEN
from core.design import get
from core.study import findings_of
from kindyna_gui.forms.form import POINT_FIELDS
from kindyna_gui.labels import heading_of
from kindyna_gui.places import example


def add(user: User, entry: str) -> None:
    """A row more, placed as it comes."""
    user.choose("Dyna", "Add to the loads", entry)
    if user.drawing().picker.active:
        user.press(Qt.Key.Key_Return)


def test_a_four_bar_gets_a_mass_a_spring_and_a_load_by_the_menu(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    before = user.window.session.design
    for entry in ("Mass", "Spring and damper", "Process force"):
        add(user, entry)
    user.enter("loads.springs[0].rate_n_per_mm", "7.5")
    design = user.window.session.design
    assert get(design, "loads.springs[0].rate_n_per_mm") == 7.5
    assert (len(design.drive.loads.springs), len(design.drive.loads.process)) == (1, 1)
    assert len(design.drive.loads.masses) == len(before.drive.loads.masses) + 1
    user.choose("Dyna", "Remove from the loads", "Spring 1")
    assert user.window.session.design.drive.loads.springs == ()
    for _ in range(5):
        user.window.session.stack.undo()
    assert user.window.session.design == before


@pytest.mark.stress
def test_a_follower_has_springs_and_friction_but_no_list_of_masses(same_window: Open) -> None:
    user = same_window(example("rocker_cam"))
    add(user, "Friction")
    assert user.window.session.design.drive.loads.pair_friction[0].pair == "pivot"
    user.choose("Dyna", "Remove from the loads", "Friction at pivot")


@pytest.mark.stress
def test_friction_that_is_there_already_is_named_as_the_form_does(same_window: Open) -> None:
    user = same_window(example("tappet_flat"))
    add(user, "Friction")
    assert "has its friction already, Guide friction = 0.06" in user.window.status.currentMessage()
    user.enter("loads.friction", "0")
    for _ in range(2):
        add(user, "Friction")
    assert len(user.design.drive.loads.pair_friction) == 1
    assert "has its friction already, in another row" in user.window.status.currentMessage()


@pytest.mark.stress
def test_the_form_shows_what_can_be_given(same_window: Open) -> None:
    user = same_window(example("slider_crank"))
    for _ in range(4):
        add(user, "Friction")
    shown = [path for path in user.parameters().forms["loads"].fields if "pair_friction" in path]
    assert [path.rpartition(".")[2] for path in shown if "[0]" in path] == ["coefficient", "radius_mm"]
    assert [path.rpartition(".")[2] for path in shown if "[3]" in path] == ["coefficient", "length_mm"]
    add(user, "Process force")
    add(user, "Spring and damper")
    paths = [path for path in user.parameters().forms["loads"].fields if "process" in path or "springs" in path]
    heads = {heading_of(user.design, path) for path in paths}
    assert heads == {"Process force 1", "Spring 1", "Spring 1, from"}


def test_a_spring_is_drawn_between_its_ends_and_stretches(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    add(user, "Spring and damper")
    scene = user.drawing().scene
    lengths = []
    for degrees in (0.0, 90.0):
        study = user.turn(degrees)
        item = scene.parts["spring.spring1"].item
        here = study.at_theta(np.deg2rad([degrees])).linkage.bodies["link4"].position("B")[0]
        ends = [item.mapToScene(QPointF(x, 0.0)) for x in (0.0, 1.0)]
        assert (ends[0].x(), ends[0].y()) == pytest.approx((-50.0, -50.0))
        assert complex(ends[1].x(), ends[1].y()) == pytest.approx(1e3 * complex(here), abs=1e-6)
        lengths.append(abs(here))
    assert lengths[0] != pytest.approx(lengths[1])


SPRING = (
    '[[loads.springs]]\nfrom = { link = 1, at = [5.0, 0.0] }\nto = { link = 2, point = "O2" }\nrate_n_per_mm = 1.0\n'
)
FRICTION = '[[loads.pair_friction]]\npair = "4"\ncoefficient = 0.1\n'
TABLE = (
    '[[loads.process]]\nlink = 3\npoint = "C"\ndirection_deg = 0.0\npoints = [[0.0, 1.0], [180.0, 5.0], [360.0, 1.0]]\n'
)


def with_rows(user: User, tmp_path: Path, rows: str, name: str = "four_bar") -> None:
    """Open an example with these rows in its file."""
    path = tmp_path / "rows.toml"
    path.write_text(example(name).read_text("utf-8") + rows, "utf-8")
    user.session.open(path)
    settle()


def codes(user: User) -> list[str]:
    findings: Any = user.see("findings")
    findings.settle()
    return [finding.code for finding in findings.findings]


def test_a_spring_without_length_and_a_damper_at_rest_are_named_as_they_are_typed(
    same_window: Open, tmp_path: Path
) -> None:
    user = same_window(example("four_bar"))
    with_rows(user, tmp_path, SPRING)
    assert codes(user) == []
    user.enter("loads.springs[0].from.x_mm", "0")
    assert codes(user) == ["spring-no-length"]
    user.enter("loads.springs[0].from.x_mm", "5")
    user.enter("loads.springs[0].damping_n_s_per_mm", "2")
    assert codes(user) == ["damper-still"]
    user.enter("loads.springs[0].rate_n_per_mm", "0")
    user.enter("loads.springs[0].damping_n_s_per_mm", "0")
    assert codes(user) == ["spring-idle", "no-load"]
    box = user.parameters().loads.attachments["loads.springs[0]"].boxes["to"]
    box.setCurrentIndex(box.findText("O4 of frame"))
    box.activated.emit(box.currentIndex())
    settle()
    assert (box.is_waiting, box.currentText()) == (True, "O4 of frame"), "what was chosen stays, and is marked"
    assert "both ends are on one link" in user.parameters().incomplete_bar.trouble.toolTip()
    user.session.stack.undo()
    settle()
    assert (box.is_waiting, box.currentText()) == (False, "O2 of link 2")


def test_a_table_that_is_not_closed_stays_as_typed_and_says_what_to_give(same_window: Open, tmp_path: Path) -> None:
    user = same_window(example("four_bar"))
    with_rows(user, tmp_path, TABLE)
    before = user.design
    user.enter("loads.process[0].points[2].value", "7")
    field = user.field("loads.process[0].points[2].value")
    assert "the table is not closed; allowed: 1, or remove the row at 360 deg" in field.trouble.replace("°", " deg")
    assert (user.number(field.spec.path).text(), user.design) == ("7", before)
    user.enter("loads.process[0].points[1].deg", "400")
    assert user.design == before
    user.session.drop_incomplete()
    page = user.parameters().loads
    when = page.whens["loads.process[0]"]
    assert when.box.currentData() == TABLE_WHEN
    when.more.click()
    assert [point.deg for point in user.design.drive.loads.process[0].points] == [0.0, 90.0, 180.0, 360.0]
    page.whens["loads.process[0]"].box.activated.emit(0)
    settle()
    row = user.design.drive.loads.process[0]
    assert (row.points, row.force_n, row.cam_from_deg, row.cam_to_deg) == ((), 5.0, 0.0, 90.0)


def test_friction_that_jams_is_named_with_its_pair_and_its_angle(same_window: Open, tmp_path: Path) -> None:
    user = same_window(example("slider_crank"))
    with_rows(user, tmp_path, FRICTION, "slider_crank")
    user.enter("loads.pair_friction[0].coefficient", "9")
    found = next(f for f in findings_of(user.session.study, ("dynamics",)) if f.code == "pair-jamming")
    assert found.field == "loads.pair_friction[0].coefficient"
    assert found.cam_angle_deg is not None
    assert "use a thinner pin or a longer slide" in found.message


def test_a_stress_without_material_or_thickness_says_what_to_give(same_window: Open) -> None:
    user = same_window(example("rocker_cam"))
    user.enter("limits.contact_pressure_mpa", "500")
    for path, text, wanted in (
        ("", "", "cam.thickness_mm"),
        ("cam.thickness_mm", "10", "cam.material"),
        ("cam.youngs_modulus_gpa", "210", "cam.roller_material"),
    ):
        if path:
            user.enter(path, text)
        found = next(f for f in findings_of(user.session.study, ("dynamics",)) if f.code == "no-contact-pressure")
        assert found.field == wanted
        assert user.field(found.field) is not None, "a click on it leads to the field"


@pytest.mark.stress
def test_a_press_stroke_comes_from_a_spreadsheet_and_goes_back_into_one(same_window: Open, tmp_path: Path) -> None:
    user = same_window(example("four_bar"))
    with_rows(user, tmp_path, TABLE)
    page, clipboard = user.parameters().loads, QApplication.clipboard()
    page.choose("loads.process[0]")
    before = user.design

    def paste(text: str) -> tuple[tuple[float, float], ...]:
        clipboard.setText(text)
        page.whens["loads.process[0]"].paste.click()
        settle()
        return tuple((point.deg, point.value) for point in user.design.drive.loads.process[0].points)

    kept = tuple((point.deg, point.value) for point in before.drive.loads.process[0].points)
    assert paste("angle;force\n0;-1,5\n120;-4,25\n") == ((0.0, -1.5), (120.0, -4.25))
    user.window.session.stack.undo()
    assert user.design == before
    assert paste("no numbers at all") == kept
    assert "no row contains two numbers" in user.window.status.currentMessage()
    assert paste("0\t1\n90\t2\nten\t3\n") == kept
    assert "line 3" in user.window.status.currentMessage()
    assert paste("0\t1\n90\t2\n80\t3\n") == kept, "angles rise"
    wave = [(float(deg), float(np.round(np.sin(np.radians(deg)), 9))) for deg in range(0, 360, 2)]
    assert paste("\n".join(f"{deg}\t{value}" for deg, value in wave)) == tuple(wave)
    assert len([path for path in page.form.fields if ".points[" in path]) == 2 * POINT_FIELDS
    assert "180 rows" in page.whens["loads.process[0]"].rest.text()
    page.whens["loads.process[0]"].copy.click()
    assert paste(clipboard.text()) == tuple(wave)
