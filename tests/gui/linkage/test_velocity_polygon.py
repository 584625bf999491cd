"""The velocity polygon and the velocity ratios on the screen: opened from the menus, moving with the crank; and from
the command line."""

import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QRectF
from PySide6.QtGui import QImage
from sampled import spread
from window_user import Open, User, settle, wait_for

from kindyna_gui.__main__ import main
from kindyna_gui.linkage import centres_view
from kindyna_gui.linkage.centres_view import PolygonView
from kindyna_gui.pictures.drawing.labels import drawing_dots
from kindyna_gui.pictures.drawing.polygons import NameLayout, PlacedName
from kindyna_gui.places import example

CM = 10.0  # mm/s in cm/s


def polygon(user: User) -> PolygonView:
    """Chosen in the menu."""
    user.choose("Compo", "Velocity polygon")
    view = user.window.view("polygon")
    assert isinstance(view, PolygonView)
    wait_for(lambda: view.up_to_date and view.on_screen())
    return view


def test_a_drawing_that_has_just_begun_has_no_forces_to_choose(open_user: Open) -> None:
    user = open_user(whole=True)
    user.choose("Dyna", "Force polygon")
    view = user.window.view("polygon")
    assert isinstance(view, PolygonView)
    wait_for(lambda: view.up_to_date and view.on_screen())
    user.choose("File", "New by type", "Linkage by drawing")
    user.window.status.count_findings()
    assert [view.choice.itemText(i) for i in range(view.choice.count())] == ["Velocities"]
    assert user.window.status.findings.text() == "cannot be calculated"


# -- the polygon ------------------------------------------------------------------------------------------


def test_the_six_bars_polygon_is_the_lectures(six_bar: User) -> None:
    """V_A = 2·2π across the crank; b, c and o in line, oc = 1.5 ob; V_D = V_C + V_DC along the guide, 22.38 cm/s."""
    sheet = polygon(six_bar).sheet
    told = {name: vector * 1e3 / CM for name, (_, vector) in sheet.vectors().items()}
    assert set(told) == {"V_A", "V_B", "V_C", "V_D", "V_BA", "V_CB", "V_DC"}
    assert told["V_A"] == pytest.approx(4.0 * math.pi * np.exp(0.75j * math.pi), abs=1e-12)
    w4 = 20.566558 * math.pi / 30.0
    assert told["V_B"] == pytest.approx(4.0 * w4 * np.exp(5j * math.pi / 6.0), abs=1e-6)
    assert told["V_C"] == pytest.approx(1.5 * told["V_B"], abs=1e-12)
    assert told["V_D"] == pytest.approx(-22.382166, abs=1e-6)
    assert told["V_BA"] == pytest.approx(told["V_B"] - told["V_A"], abs=1e-12)
    assert told["V_DC"] == pytest.approx(told["V_D"] - told["V_C"], abs=1e-12)


def test_the_six_bars_differences_are_found_step_by_step(six_bar: User) -> None:
    """One vector per step: V_A, V_BA from its end, V_B = V_A + V_BA, and so on to the slider."""
    view = polygon(six_bar)
    whole, told, drawn = view.sheet.vectors(), [], []
    view.next.click()
    assert view.sheet.vectors() == {}
    while view.next.isEnabled():
        view.next.click()
        told.append(view.step_label.text().partition(": ")[2])
        drawn.append(set(view.sheet.vectors()))
    assert told == [
        "V_A from the pole",
        "V_BA across the line from A to B",
        "V_B = V_A + V_BA",
        "V_CB across the line from B to C",
        "V_C = V_B + V_CB",
        "V_DC across the line from C to D",
        "V_D = V_C + V_DC",
    ]
    assert [len(each) for each in drawn] == [1, 2, 3, 4, 5, 6, 7]
    assert view.sheet.vectors() == whole
    view.back.click()
    assert set(whole) - set(view.sheet.vectors()) == {"V_D"}
    view.all.click()
    assert (view.sheet.vectors(), view.step_label.text()) == (whole, "")


@pytest.mark.parametrize("name", spread(["inverted_slider_crank", "rear_suspension", "stephenson_six_bar"], 1))
def test_vectors_are_drawn_head_to_tail_to_the_scale(name: str, open_user: Open) -> None:
    """Absolute ones from the pole; each difference leads from one end to another; all of it on the sheet."""
    user = open_user(example(name))
    sheet = polygon(user).sheet
    for degrees in (20.0, 140.0, 250.0):
        study = user.turn(degrees)
        drawn, (value, length) = sheet.vectors(), sheet.scale_bar
        per_mm_s = length / value
        pole = sheet.frame.pole
        ends = {key: start + vector.conjugate() * 1e3 * per_mm_s for key, (start, vector) in drawn.items()}
        absolute = {key: end for key, end in ends.items() if drawn[key][0] == pole}
        for point, (_, speed) in study.points().items():
            if f"V_{point}" in absolute:
                assert absolute[f"V_{point}"] == pytest.approx(
                    pole + complex(speed[0]).conjugate() * 1e3 * per_mm_s, abs=1e-6
                )
        for key, (start, _) in drawn.items():
            assert any(abs(start - end) < 1e-6 for end in [pole, *absolute.values()]), key
            assert any(abs(ends[key] - end) < 1e-6 for end in absolute.values()), key
            assert -1.0 <= ends[key].real <= sheet.width() + 1.0
            assert -1.0 <= ends[key].imag <= sheet.height() + 1.0
    assert re.fullmatch(r"[125]0*(\.0)?|0\.\d*[125]", f"{value:g}"), "a round velocity"


def test_a_sliding_blocks_difference_lies_along_its_arm(open_user: Open) -> None:
    user = open_user(example("inverted_slider_crank"))
    sheet = polygon(user).sheet
    study = user.turn(70.0)
    vector = sheet.vectors()["V_A3A4"][1]
    arm = study.linkage.bodies["link4"].angle[0, 0]
    assert (vector * np.exp(-1j * arm)).imag == pytest.approx(0.0, abs=1e-15)
    slide = study.linkage.coordinates["slide3"][1][0] * study.omega
    assert (vector * np.exp(-1j * arm)).real == pytest.approx(slide, rel=1e-12)


def test_the_polygon_follows_the_crank_and_only_while_it_is_seen(
    six_bar: User, monkeypatch: pytest.MonkeyPatch
) -> None:
    view, computed = polygon(six_bar), []
    made = centres_view.velocity_polygon
    monkeypatch.setattr(
        centres_view, "velocity_polygon", lambda kinematics: computed.append(kinematics) or made(kinematics)
    )
    before = view.sheet.vectors()["V_A"][1]
    six_bar.window.player.step(10.0)
    settle()
    assert view.sheet.vectors()["V_A"][1] == pytest.approx(before * np.exp(1j * math.radians(10.0)), abs=1e-12)
    assert len(computed) == 1
    six_bar.window.show_view("centres")
    settle()
    six_bar.window.player.step(10.0)
    settle()
    assert len(computed) == 1, "behind another tab nothing is computed"


def test_in_a_dwell_nothing_moves_and_the_polygon_says_so(open_user: Open) -> None:
    user = open_user(example("four_bar_coupler_cam"))
    sheet = polygon(user).sheet
    user.turn(10.0)
    assert sheet.is_empty
    assert sheet.vectors() == {}
    user.turn(130.0)
    assert not sheet.is_empty


def test_a_cam_has_its_velocities_in_the_mechanism(user: User) -> None:
    view = polygon(user)
    assert "the mechanism shows the velocities" in view.note.text()


def test_the_polygon_is_written_as_a_picture(six_bar: User) -> None:
    view = polygon(six_bar)
    image = QImage.fromData(view.picture(".png"))
    assert image.width() == 2 * view.content.width()
    colours = {image.pixelColor(x, y).name() for x in range(0, image.width(), 2) for y in range(0, image.height(), 2)}
    assert "#009e73" in colours, "velocities in their colour"
    assert b"<svg" in view.picture(".svg")


def test_names_keep_off_vectors_and_each_other() -> None:
    """A name stands on the free side of its vector, and two at one place part."""
    sheet = QRectF(0.0, 0.0, 200.0, 200.0)
    side = PlacedName("side", "V", "A", 100 + 100j, 1j, "#000000", 14.0, 10.0, along=120 + 0j)
    corners = [PlacedName("corner", name, "", 100 + 100j, 1 + 0j, "#000000", 10.0, 10.0) for name in "ab"]
    laid = NameLayout().place([*corners, side], [(40 + 100j, 160 + 100j), (40 + 112j, 160 + 112j)], sheet)
    boxes = [QRectF(t.middle.real - t.width / 2, t.middle.imag - t.height / 2, t.width, t.height) for t in laid]
    assert not any(a.intersects(b) for i, a in enumerate(boxes) for b in boxes[:i])
    assert laid[2].middle.imag < 95.0, "above, for below there is another vector"


# -- velocity ratios --------------------------------------------------------------------------------------


def test_ratios_are_read_off_the_drawing_link_by_link(six_bar: User) -> None:
    """As the lecture goes through its six-bar: ω3 by I23, ω4 by I34, ω5 by I45, the slider by I56."""
    view = six_bar.drawing()
    six_bar.choose("View", "Layers of the drawing", "Velocity ratios from link to link")
    assert view.scene.linkage_layers is not None
    drawn = view.scene.linkage_layers.ratios["chain"]
    assert drawn.texts == [
        "ω3/ω2 = I12I23 / I13I23 = 20.00 / −180.8 mm = −0.1106",
        "ω4/ω3 = I13I34 / I14I34 = 123.9 / −40.00 mm = −3.098",
        "ω5/ω4 = I14I45 / I15I45 = 60.00 / −60.00 mm = −1.000",
        "v6 = ω5 · I15I56 = −2.154 rad/s × 103.9 mm = 223.8 mm/s",
    ]
    lengths = [d.tag.text for _, lines, _ in drawn.rows for d in lines if d.line.isVisible()]
    assert "I12I23 20.00 mm" in lengths
    assert "I14I34 −40.00 mm" in lengths
    six_bar.choose("View", "Layers of the drawing", "Velocity ratios from link to link")
    assert not drawn.item.isVisible()


@pytest.mark.parametrize("name", spread(["inverted_slider_crank", "lecture_six_bar"], 1))
def test_dimensions_run_beside_their_centres(name: str, open_user: Open) -> None:
    """Parallel to the line of the three centres, from abreast of one to abreast of the other; and they move."""
    user = open_user(example(name))
    view = user.drawing()
    view.show_layer("ratios", True)
    tried = 0
    for degrees in (35.0, 215.0):
        study = user.turn(degrees)
        assert view.scene.linkage_layers is not None
        drawn = view.scene.linkage_layers.ratios["ratios"]
        for arms, lines, _ in drawn.rows:
            if np.isfinite(study.angular_velocities()[int(arms.body[-1])][0]) and math.isfinite(
                arms.body_arm[view.scene.index]
            ):
                told = float(study.angular_velocities()[int(arms.body[-1])][0] / study.angular_velocities()[2][0])
                assert arms.ratio[view.scene.index] == pytest.approx(told, rel=0.05, abs=0.01)
            for line in lines:
                if not line.line.isVisible():
                    continue
                path = line.line.path()
                one, other = (complex(path.elementAt(i).x, path.elementAt(i).y) for i in (0, 1))
                table = user.session.study.centres
                ends = [complex(table.centres[key].finite[view.scene.index]) * 1e3 for key in (line.start, line.end)]
                along = (ends[1] - ends[0]) / abs(ends[1] - ends[0])
                assert ((other - one) / along).imag == pytest.approx(0.0, abs=1e-6 * abs(ends[1] - ends[0]))
                if all(view.scene.viewport.holds(e, 60.0) for e in ends):
                    tried += 1
                    assert abs(other - one) == pytest.approx(abs(ends[1] - ends[0]), rel=1e-9)
                    off = abs(((one - ends[0]) / along).imag) * view.canvas.scale_now
                    assert 14.0 < off < 60.0
    assert tried


def test_ratios_are_read_when_they_are_first_shown(six_bar: User) -> None:
    scene = six_bar.drawing().scene
    assert scene.linkage_layers is not None
    assert scene.linkage_layers.ratios == {}
    assert scene.linkage_layers.marks is None


def test_the_list_of_ratios_stands_above_the_mechanism(six_bar: User) -> None:
    """The mechanism makes room for it, and it covers nothing."""
    view = six_bar.drawing()
    scale = view.canvas.scale_now
    six_bar.choose("View", "Layers of the drawing", "Velocity ratios to the driver")
    scene = view.scene
    assert scene.linkage_layers is not None
    (drawn,) = scene.linkage_layers.ratios.values()
    assert view.canvas.scale_now <= scale
    lowest = min(tag.pos().y() - tag.size[1] / view.canvas.scale_now for _, _, tag in drawn.rows)
    highest = max(float(track.imag.max()) for track in scene.geometry.tracks())  # type: ignore[union-attr]
    assert lowest > highest


def test_arrows_at_the_edge_stand_off_the_list(open_user: Open) -> None:
    user = open_user(example("stephenson_six_bar"))
    view = user.drawing()
    for layer in ("centres", "chain"):
        view.show_layer(layer, True)
    arrows = 0
    for degrees in (80.0, 100.0, 120.0):
        user.turn(degrees)
        scale, made = view.canvas.scale_now, view.scene.linkage_layers
        assert made is not None
        assert made.marks is not None
        tags = [tag for _, _, tag in made.ratios["chain"].rows]
        boxes = [tag.pixel_box().translated(tag.pos().x() * scale, -tag.pos().y() * scale) for tag in tags]
        for mark in made.marks.marks:
            if mark.arrow.isVisible():
                arrows += 1
                assert not any(
                    box.contains(mark.arrow.pos().x() * scale, -mark.arrow.pos().y() * scale) for box in boxes
                )
    assert arrows


# -- numbers never stand on parts -------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["slider_crank", "lecture_six_bar"])
def test_numbers_of_centres_cover_neither_parts_nor_each_other(name: str, open_user: Open) -> None:
    user = open_user(example(name))
    view = user.drawing()
    view.show_layer("centres", True)
    covered = seen = 0
    for degrees in (15.0, 75.0, 160.0, 290.0):
        user.turn(degrees)
        scene, scale = view.scene, view.canvas.scale_now
        assert scene.linkage_layers is not None
        assert scene.linkage_layers.marks is not None
        tags = [m.tag for m in scene.linkage_layers.marks.marks if m.tag.isVisible()]
        boxes = [t.pixel_box().translated(t.pos().x() * scale, -t.pos().y() * scale) for t in tags]
        assert not any(a.intersects(b) for i, a in enumerate(boxes) for b in boxes[:i])
        dots = drawing_dots(scene.geometry, np.array([scene.index]), ())  # type: ignore[arg-type]
        for box in boxes:
            seen += 1
            x = np.maximum(np.abs(dots.points[0].real * scale - box.center().x()) - box.width() / 2, 0.0)
            y = np.maximum(np.abs(-dots.points[0].imag * scale - box.center().y()) - box.height() / 2, 0.0)
            covered += bool((np.hypot(x, y) < dots.radius * scale).any())
    assert seen >= 20
    assert covered <= 0.05 * seen


# -- without a window -------------------------------------------------------------------------------------


def test_the_command_draws_centres_and_polygon(tmp_path: Path, app: object, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--headless", "centres", str(example("lecture_six_bar")), "--angle", "45", "--out", str(tmp_path / "out")]
    assert main(words) == 0
    told = capsys.readouterr()
    assert told.err == ""
    made = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    assert set(made) == {"centres.json", "centres.png", "centres.svg", "velocity_polygon.png", "velocity_polygon.svg"}
    assert json.loads(made["centres.json"]) == json.loads(told.out)
    drawn = made["centres.svg"].decode()
    for text in ("I12I23 / I13I23 = 20.00 / ", "I14I34", "Driver angle 45.0°"):
        assert text in drawn
    assert "20 mm/s" in made["velocity_polygon.svg"].decode()


def test_without_the_window_the_numbers_are_written_and_pictures_left_out(tmp_path: Path) -> None:
    words = [sys.executable, "-m", "core", "centres", str(example("four_bar")), "--angle", "20", "--out", "out"]
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[3])}
    done = subprocess.run(
        words, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False, encoding="utf-8"
    )
    assert (done.returncode, done.stderr) == (0, "pictures left out: they need kindyna --headless\n")
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["centres.json"]
    rows = json.loads(done.stdout)["velocity_differences"]
    for row in rows:
        for part in (0, 1):
            whole = row["v_from_mm_s"][part] + row["v_difference_mm_s"][part]
            assert row["v_to_mm_s"][part] == pytest.approx(whole, abs=1e-9)
    assert [(row["link"], row["from"], row["to"]) for row in rows] == [
        (2, "O2", "A"),
        (3, "A", "B"),
        (3, "A", "C"),
        (3, "B", "C"),
        (4, "O4", "B"),
    ]
