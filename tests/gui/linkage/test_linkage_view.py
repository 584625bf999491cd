"""General linkages in the window: opened, drawn, edited, dragged, exported; beside cams without a stumble."""

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from plot_reading import labels, tags
from PySide6.QtCore import QPointF, Qt
from PySide6.QtWidgets import QLabel
from window_user import Open, User, end_pauses, settle, wait_for

from core.__main__ import main
from core.design import faults
from core.followers.dragging import move_joint
from core.output.export import files
from core.project import load
from core.study import Study, findings_of
from kindyna_gui import dialogs, export_dialogs
from kindyna_gui.export_dialogs import TablesRequest
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.plots.curves import CurvePlot
from kindyna_gui.places import example, single_examples

LINKAGES = [path.stem for _, path in single_examples() if load(path).drive.is_linkage]


def there(user: User) -> Study:
    study = user.session.at(user.window.player.theta)
    assert study.design.drive.is_linkage
    return study


def place(user: User, point: str) -> complex:
    """Where a point stands [mm]."""
    return complex(there(user).points()[point][0][0]) * 1e3


# -- opened and drawn -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["slider_crank", "lecture_six_bar", "four_bar_coupler_cam"])
def test_a_linkage_opens_and_moves(name: str, same_window: Open) -> None:
    """Each link is drawn where the core has it, at every tenth of a turn."""
    user = same_window(example(name))
    view = user.drawing()
    assert not view.in_trouble
    for step in range(10):
        user.turn(36.0 * step)
        assert view.scene.geometry is not None
        study, index = user.session.study, view.scene.index
        for body, pose in study.linkage.bodies.items():
            key = f"body.{body}"
            if key in view.scene.parts:
                item = view.scene.item(key)
                assert complex(item.pos().x(), item.pos().y()) == pytest.approx(pose.z[0, index] * 1e3, abs=1e-9)
                over = item.rotation() - math.degrees(pose.angle[0, index])
                assert math.remainder(over, 360.0) == pytest.approx(0.0, abs=1e-9)
    assert {f"label.pin.{n}" for n in ("A", "B")} & set(view.scene.parts)


def test_a_slider_is_a_block_on_the_link_that_carries_it(same_window: Open) -> None:
    user = same_window(example("inverted_slider_crank"))
    user.turn(70.0)
    block = user.drawing().scene.item("block.3")
    at = block.mapToScene(block.boundingRect().center())
    assert complex(at.x(), at.y()) == pytest.approx(place(user, "A"), abs=0.2)


def test_the_coupler_cam_is_drawn_and_exported(
    same_window: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    user = same_window(example("four_bar_coupler_cam"))
    view = user.drawing()
    for key in ("cam", "pitch", "roller", "normal", "centre"):
        assert view.scene.item(key).isVisible(), key
    user.turn(130.0)
    roller = view.scene.item("roller").pos()
    assert complex(roller.x(), roller.y()) == pytest.approx(place(user, "C"), abs=0.05)
    monkeypatch.setattr(export_dialogs, "ask_tables", lambda *_: TablesRequest(tmp_path, 3600))
    user.choose("File", "Export", "Tables...")
    wanted = files(Study(load(example("four_bar_coupler_cam"))))
    assert {"profile.csv", "linkage.csv", "summary.json"} <= {path.name for path in tmp_path.iterdir()}
    for name, text in wanted.items():
        assert (tmp_path / name).read_text(encoding="utf-8") == text


def test_a_linkage_that_cannot_turn_fully_swings(same_window: Open, tmp_path: Path) -> None:
    """Crank longer than what lets it turn: the player stays where the linkage can stand, and turns back there."""
    path = tmp_path / "rocker.toml"
    text = example("four_bar").read_text(encoding="utf-8").replace("A = [30.0, 0.0]", "A = [95.0, 0.0]")
    path.write_text(text, encoding="utf-8")
    user = same_window(path)
    user.window.docks["centres"].hide()
    player = user.window.player
    (low, high), *_ = player.ranges
    assert 0.0 <= low < high <= math.tau
    player.set_theta(0.5 * (low + high))
    ways = set()
    for _ in range(120):
        before = player.theta
        player.advance(0.01 / player.speed)
        assert any(a <= player.theta <= b for a, b in player.ranges)
        assert player.theta != before
        ways.add(player.theta > before)
    assert ways == {True, False}, "it turns back at the ends"
    assert not user.drawing().in_trouble
    assert user.faults == []


# -- parameters and plots ---------------------------------------------------------------------------------


def test_dimensions_are_edited_and_undone(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    path = "linkage.links[3].points.B.x_mm"
    before = user.design
    user.enter(path, "75")
    assert user.design.drive.mechanism.by_number[4].places["B"] == 75.0
    assert user.steps[-1] == "Change B x to 75 mm"
    assert abs(place(user, "B") - 100.0) == pytest.approx(75.0, abs=1e-9)
    user.choose("Edit", user.entries("Edit")[0])
    assert user.design == before


def test_a_length_that_cannot_be_waits_with_the_reason_beside_its_field(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    before = user.design
    user.enter("linkage.links[2].points.B.x_mm", "300")
    assert user.design == before
    assert (
        "do not meet" in user.field("linkage.links[2].points.B.x_mm").trouble
        or "cannot be assembled" in user.field("linkage.links[2].points.B.x_mm").trouble
    )
    assert user.steps == ["Change B x to 300 mm"]


def test_the_other_way_of_assembly_is_chosen(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    above = place(user, "B").imag
    editor = user.field("linkage.branch.B").editor
    editor.setCurrentIndex(editor.findData(-1))  # type: ignore[union-attr]
    editor.activated.emit(editor.currentIndex())  # type: ignore[union-attr]
    settle()
    assert user.design.drive.mechanism.sides["B"] == -1
    assert above > 0.0 > place(user, "B").imag


def test_the_plots_show_what_the_links_do(same_window: Open) -> None:
    user = same_window(example("lecture_six_bar"))
    user.turn(45.0)
    view = user.window.show_view("velocity")
    wait_for(lambda: view.up_to_date and view.on_screen())
    assert [row.name for row in view.rows] == ["link.3_velocity", "link.4_velocity", "link.5_velocity"]  # type: ignore[attr-defined]
    assert view.plot.readings()[1].startswith("2.154")  # type: ignore[attr-defined]  # 20.566558 rpm
    graph = user.window.show_view("graph")
    wait_for(lambda: graph.up_to_date and graph.on_screen())
    graph.tree.item_of("point.D_vx").setCheckState(0, Qt.CheckState.Checked)  # type: ignore[attr-defined]
    settle()
    assert "point.D_vx" in [row.name for row in graph.drawn]  # type: ignore[attr-defined]


@pytest.mark.stress
def test_empty_plots_name_the_angle_too(same_window: Open) -> None:
    """A crank has no curvature: the plot says so over the driver's angle; back at a cam, over the cam's."""
    user = same_window(example("four_bar"))
    for name, told in (
        ("four_bar", "Driver angle, °"),
        ("transfer_lift", "Cam angle, °"),
        ("slider_crank", "Driver angle, °"),
    ):
        user.session.start(load(example(name)))
        settle()
        for dock in ("curvature", "jerk", "velocity"):
            view = user.window.show_view(dock)
            wait_for(lambda view=view: view.up_to_date and view.on_screen())  # type: ignore[misc]
            assert view.plot.getAxis("bottom").labelText == told, dock  # type: ignore[attr-defined]
    graph = user.window.show_view("graph")
    wait_for(lambda: graph.up_to_date and graph.on_screen())
    graph.add_plot()  # type: ignore[attr-defined]
    settle()
    assert not graph.panels[-1].plot.readings()  # type: ignore[attr-defined]
    assert graph.panels[-1].plot.getAxis("bottom").labelText == "Driver angle, °"  # type: ignore[attr-defined]


@pytest.mark.stress
def test_docks_are_called_after_what_they_show(open_user: Open) -> None:
    """Titles, tabs, the menu of docks and that of pictures alike; a cam has its own names back."""
    user = open_user(example("four_bar"), whole=True)
    user.choose("View", "Kine")
    docks = ("displacement", "velocity", "acceleration", "pressure_angle", "torque", "contact_force")
    wanted = {
        "four_bar": ("Angle", "Angular velocity", "Angular accel.", "Transmission angle", "Driver torque", "Joint forces"),
        "rear_suspension": ("Displacement", "Velocity", "Acceleration", "Transmission angle", "Driver torque", "Joint forces"),
        "cam_slider_linkage":
            ("Displacement", "Velocity", "Acceleration", "Pressure angle", "Torque", "Contact force"),
        "transfer_lift": ("Displacement", "Velocity", "Acceleration", "Pressure angle", "Torque", "Contact force"),
    }  # fmt: skip
    for name, titles in wanted.items():
        user.session.start(load(example(name)))
        settle()
        assert tuple(user.window.docks[dock].windowTitle() for dock in docks) == titles, name
        assert set(titles) <= set(user.entries("View", "Docks"))
        assert f"{titles[0]}..." in user.entries("Graph", "Export picture")


@pytest.mark.stress
def test_a_linkage_is_drawn_where_its_cam_cannot_be(same_window: Open, tmp_path: Path) -> None:
    text = example("cam_slider_linkage").read_text("utf-8")
    (tmp_path / "wide.toml").write_text(text.replace("roller_radius_mm = 150.0", "roller_radius_mm = 600.0"), "utf-8")
    user = same_window(tmp_path / "wide.toml")
    drawing = user.drawing()
    assert not drawing.in_trouble
    assert "body.link3" in drawing.scene.parts
    assert drawing.note.text().startswith("No cam: Cam roller: the roller covers the cam centre")


@pytest.mark.stress
def test_a_linkage_without_a_cam_is_not_told_of_contact(open_user: Open) -> None:
    user = open_user(example("four_bar"), size=(1440, 900), whole=True)
    for task in ("Compo", "Kine", "Dyna", "Graph"):
        user.choose("View", task)
        end_pauses()
        told = [label.text() for label in user.window.findChildren(QLabel) if label.isVisible()]
        told += [dock.windowTitle() for dock in user.window.docks.values() if dock.isVisible()]
        told += [tag.text for plot in user.window.findChildren(CurvePlot) if plot.isVisible() for tag in tags(plot)]
        assert [text for text in told if "contact" in text.lower()] == [], task
    findings: Any = user.see("findings")
    assert [row.cells[0] for row in findings.table.rows.rows] == [
        "No masses and no forces are given: all forces and the torque are zero"
    ]
    assert "Contact force" not in user.entries("Dyna")
    user.choose("Dyna", "Joint forces")
    assert user.window.docks["contact_force"].isVisible()
    for way in (
        ("Kine", "Curvature"),
        ("Dyna", "Keeping contact"),
        ("Dyna", "Contact pressure"),
        ("Dyna", "Response spectrum"),
        ("View", "Docks", "Keeping contact"),
    ):
        action = user.action(*way)
        assert (action.isEnabled(), action.statusTip()) == (False, "This design has no cam")
    user.session.start(load(example("transfer_lift")))
    for way in (
        ("Kine", "Pressure angle"),
        ("Dyna", "Contact force"),
        ("Dyna", "Keeping contact"),
        ("View", "Docks", "Keeping contact"),
    ):
        assert user.action(*way).isEnabled()


def test_what_a_linkage_lacks_is_said_in_a_sentence(same_window: Open) -> None:
    user = same_window(example("lecture_six_bar"))
    for name in ("motion", "flywheel"):
        view = user.window.show_view(name)
        wait_for(lambda view=view: view.up_to_date)  # type: ignore[misc]
        assert view.is_unavailable
        assert view.no_picture.endswith(".")


# -- joints drawn elsewhere -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "point", "way"), [("four_bar", "B", 8 + 5j), ("four_bar", "C", -9 + 4j), ("watt_six_bar", "D", 6 - 7j)]
)
def test_a_joint_that_is_dragged_follows_the_mouse_in_one_step(
    name: str, point: str, way: complex, same_window: Open
) -> None:
    user = same_window(example(name))
    view = user.drawing()
    user.turn(60.0)
    before, start = user.design, place(user, point)
    user.drag(start, start + way)
    assert place(user, point) == pytest.approx(start + way, abs=1.5 / view.canvas.scale_now)
    assert user.steps == [f"Move joint {point}"]
    assert faults(user.design) == []
    user.session.stack.undo()
    assert user.design == before


def test_a_crank_is_lengthened_along_itself(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    user.turn(90.0)
    user.drag(place(user, "A"), place(user, "A") + 6.0 + 10.0j)
    assert place(user, "A") == pytest.approx(40.0j, abs=1.0)
    assert user.design.drive.mechanism.by_number[2].places["A"].imag == 0.0
    assert user.design.drive.mechanism.by_number[3].places["A"] == 0.0
    assert user.design.drive.mechanism.by_number[3].places["B"].imag == 0.0


def test_a_joint_cannot_be_dragged_to_where_nothing_fits(same_window: Open) -> None:
    """The ground pivot goes as far as the links, which keep their lengths, can be put together; beyond it is refused."""
    user = same_window(example("four_bar"))
    view = user.drawing()
    view.canvas.zoom(0.3, QPointF(200.0, 200.0))
    refused: list[object] = []
    user.session.refused.connect(refused.append)
    user.drag(100.0 + 0j, 400.0 + 0j)
    assert refused
    assert not view.in_trouble
    pivot = user.design.drive.mechanism.by_number[1].places["O4"]
    assert pivot.real < 30.0 + 90.0 + 70.0
    assert user.design.drive.mechanism.by_number[4] == load(example("four_bar")).drive.mechanism.by_number[4]


def test_only_what_meets_at_the_joint_changes() -> None:
    """Poses at this angle stay; the joint is where it was wanted to the last bits."""
    design = load(example("stephenson_six_bar"))
    study = Study(design).at_theta(np.array([1.2]))
    bodies = study.linkage.bodies
    wanted = complex(bodies["link5"].point("D")[0, 0]) + 0.004 - 0.003j
    moved = move_joint(design, study.linkage, "D", wanted, 12)
    after = Study(moved).at_theta(np.array([1.2])).linkage.bodies
    assert complex(after["link5"].point("D")[0, 0]) == pytest.approx(wanted, abs=1e-13)
    for body in ("link2", "link3", "link4"):
        assert after[body].z[0, 0] == bodies[body].z[0, 0]
    changed = [
        a.number for a, b in zip(design.drive.mechanism.links, moved.drive.mechanism.links, strict=True) if a != b
    ]
    assert changed == [5, 6]


# -- among other designs ----------------------------------------------------------------------------------


@pytest.mark.stress
def test_cams_and_linkages_follow_each_other(user: User) -> None:
    """With every dock looked at, undo between, and all layers on."""
    names = ["lecture_six_bar", "transfer_lift", "four_bar_coupler_cam"]
    for dock in user.window.docks:
        user.window.show_view(dock)
    for before, name in pairwise([*names, names[0]]):
        user.window.documents.open_example(example(name))
        settle()
        for action in user.drawing().layer_actions():
            action.setChecked(True)
        user.window.show_view("graph")
        settle()
        user.window.show_view("mechanism")
        user.turn(50.0)
        path = "linkage.driver.speed_rpm" if user.design.drive.is_linkage else "shaft.speed_rpm"
        assert user.session.edit(path, 31.0, "Change speed"), (before, name)
        settle()
        user.session.stack.undo()
        settle()
        assert not user.drawing().in_trouble
    assert user.faults == []


def test_a_crank_carries_its_number_round_with_it(open_user: Open) -> None:
    """At every angle the number of a link that turns fully stands clear of the link's own pins and of its bar."""
    user = open_user(example("four_bar"), size=(1280, 720))
    view = user.drawing()
    tag, scale = view.scene.item("label.link2"), view.canvas.scale_now
    for step in range(24):
        user.turn(15.0 * step)
        shown = tag.pixel_box()  # type: ignore[attr-defined]
        corners = [
            complex(tag.pos().x() + x / scale, tag.pos().y() - y / scale)
            for x in (shown.left(), shown.right())
            for y in (shown.top(), shown.bottom())
        ]
        start, end = place(user, "O2"), place(user, "A")
        along = (end - start) / abs(end - start)
        beside = [((corner - start) * along.conjugate()) for corner in corners]
        assert min(abs(b.imag) for b in beside) * scale > 5.0, 15.0 * step  # pixels from the middle of the bar
        assert len({math.copysign(1.0, b.imag) for b in beside}) == 1
        assert 0.0 < min(b.real for b in beside) < max(b.real for b in beside) < abs(end - start)


def test_a_label_finds_another_side_where_its_link_no_longer_goes_round(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    user.session.edit("linkage.links[1].points.A.x_mm", 90.0, "A long crank")
    user.session.end_gesture()
    settle()
    assert findings_of(Study(user.design))[0].code == "crank-cannot-turn"
    user.session.edit("linkage.links[1].points.A.x_mm", 9.0, "A short crank")
    user.session.stack.undo()
    user.session.stack.undo()
    assert not user.drawing().in_trouble
    canvas = user.drawing().canvas
    wait_for(lambda: not canvas.rest.isActive())
    fresh = MechanismScene(user.session.study)
    fresh.show_region(canvas.visible, canvas.scale_now)
    assert labels(user.drawing().scene) == pytest.approx(labels(fresh), abs=0.1)


def test_a_crank_that_can_hardly_move_leaves_the_last_drawing(same_window: Open) -> None:
    """The last design that can be drawn stays, and every view with it."""
    user = same_window(example("four_bar"))
    before = user.design
    longest = 30.0 + 120.0 + 70.0
    user.session.edit("linkage.links[0].points.O4.y_mm", math.sqrt((longest - 1e-7) ** 2 - 100.0**2), "Far away")
    settle()
    assert user.design == before
    user.turn(200.0)
    assert not user.drawing().in_trouble


def test_a_plot_with_nothing_to_show_says_so_in_the_menu_and_when_it_is_exported(
    same_window: Open, tmp_path: Path
) -> None:
    user = same_window(example("four_bar"))
    user.see("curvature")
    entry = user.action("Graph", "Export picture", "Curvature...")
    assert not entry.isEnabled()
    assert entry.statusTip().startswith("This linkage has no cam")
    user.picks("picture_to_save", tmp_path / "curvature.png")
    for action in user.window.show_view("curvature").plot.actions():  # type: ignore[attr-defined]
        action.trigger()
    assert [what for what, _ in user.faults] == ["There is no picture to export.", "There are no numbers to export."]
    assert all(lines[0].startswith("This linkage has no cam") for _, lines in user.faults)
    assert list(tmp_path.iterdir()) == []


def test_the_flywheel_of_a_crank_shows_the_torque_of_the_driver(same_window: Open) -> None:
    user = same_window(example("watt_six_bar"))
    user.choose("Stability", "Add a shaft")
    view = user.see("flywheel")
    labels = [row.cells[0] for row in view.table.rows.rows]  # type: ignore[attr-defined]
    assert "Driver torque, highest" in labels
    assert not any(label.startswith("Cam torque") for label in labels)


@pytest.mark.stress
def test_pose_and_curves_leave_the_window_as_the_commands_write_them(
    open_user: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    user, design = open_user(example("four_bar")), str(example("four_bar"))
    user.turn(30.0)
    for entry, name, command in (
        ("Pose of the links...", "pose.dxf", ("pose", design, "--angle", "30")),
        ("Pose of the links...", "pose.svg", ("pose", design, "--angle", "30")),
        ("Curves of points...", "curves.csv", ("curves", design)),
        ("Curves of points...", "curves.dxf", ("curves", design)),
    ):
        monkeypatch.setattr(dialogs, "links_to_save", lambda *_, name=name, **__: tmp_path / name)
        user.choose("File", "Export", entry)
        wait_for((tmp_path / name).exists)
        assert main([*command, "--out", str(tmp_path / f"own_{name}")]) == 0
        assert (tmp_path / name).read_bytes() == (tmp_path / f"own_{name}").read_bytes(), name
