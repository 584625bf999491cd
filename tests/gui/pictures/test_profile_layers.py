"""The profile in colours, its values under the mouse, and dimensions: layers of the drawing that cost nothing until they are shown."""

from html import unescape
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QRectF, Qt
from PySide6.QtGui import QColor, QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from window_user import Open, User, pixel, settle

from core.design import Design, edited, get
from core.output.drawing.palette import SKY, VERMILION
from core.project import load
from core.study import Study, roller_lives
from kindyna_gui.files.beginnings import beginning
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.items import Tag
from kindyna_gui.pictures.painter import MechanismSheet, png
from kindyna_gui.pictures.style import LIGHT
from kindyna_gui.places import example

pytestmark = pytest.mark.usefixtures("app")

BY_PRESSURE, BY_CURVATURE = "Profile coloured by pressure angle", "Profile coloured by curvature"
BY_STRESS = "Profile coloured by contact pressure"
WIDTH, HEIGHT = 900, 675


@pytest.fixture
def user(open_user: Open) -> User:
    """A window of its own: the mouse is read."""
    return open_user()


def scene_of(design: Design, *layers: str) -> MechanismScene:
    scene = MechanismScene()
    for layer in layers:
        scene.set_layer(layer, True)
    scene.update_study(Study(design, 720))
    scene.set_index(0)
    return scene


def texts(scene: MechanismScene, layer: str) -> list[str]:
    items = [part.item for key, part in scene.parts.items() if key.startswith(f"{layer}.")]
    return [item.text for item in items if isinstance(item, Tag)]


# -- colours ------------------------------------------------------------------------------------------------


def colour_at(scene: MechanismScene, place: complex, wanted: QColor) -> QColor:
    """What is painted at a place [mm], or a pixel or two beside it, that is most like the colour wanted: the line is four wide."""
    image = QImage.fromData(png(MechanismSheet(scene, WIDTH, HEIGHT), 1.0))
    visible, scale = scene.fit(WIDTH, HEIGHT)
    x, y = int((place.real - visible.left()) * scale), int(HEIGHT - (place.imag - visible.top()) * scale)
    near = [image.pixelColor(x + i, y + k) for i in (-1, 0, 1) for k in (-1, 0, 1)]
    return min(near, key=lambda colour: unlike(colour, wanted))


def unlike(one: QColor, other: QColor) -> int:
    return max(abs(one.red() - other.red()), abs(one.green() - other.green()), abs(one.blue() - other.blue()))


@pytest.mark.parametrize("changes", [{"follower.face": "knife"}, {"cam.form": "groove"}])
def test_each_flank_has_the_colour_of_its_pressure_angle(changes: dict[str, str]) -> None:
    design = edited(beginning("translating", changes), "motion.stroke", 64.0)
    scene, study = scene_of(design, "pressure_colours"), Study(design, 720)
    for layer in ("pitch", "base", "roller", "linkage", "loads", "normal", "centre", "labels"):
        scene.set_layer(layer, False)
    for flank in study.cam.flanks:
        angle = np.rad2deg(flank.pressure_angle)
        at = {
            wanted: flank.profile[int(np.abs(angle - value).argmin())] * 1e3
            for wanted, value in ((SKY, 0.0), (VERMILION, 29.9))
        }
        for wanted, place in at.items():
            assert unlike(colour_at(scene, complex(place), QColor(wanted)), QColor(wanted)) < 25, (flank.name, wanted)
        beyond = flank.profile[int(angle.argmax())] * 1e3
        assert angle.max() > 30.5
        assert unlike(colour_at(scene, complex(beyond), QColor(LIGHT.limit)), QColor(LIGHT.limit)) < 25
    assert scene.overlay is not None
    assert scene.overlay.colours["pressure_colours"].texts == [
        "Pressure angle up to the typical limit",
        "0°",
        "15°",
        "30°",
    ]


def test_each_flank_has_the_colour_of_its_contact_pressure_and_other_loads_change_it() -> None:
    design = load(example("groove"))
    pressed = {
        "cam.material": "16mncr5",
        "cam.roller_material": "100cr6",
        "cam.thickness_mm": 20.0,
        "limits.contact_pressure_mpa": 100.0,
    }
    for path, value in pressed.items():
        design = edited(design, path, value)
    scene, study = scene_of(design, "stress_colours"), Study(design, 720)
    for layer in ("pitch", "base", "roller", "linkage", "loads", "normal", "centre", "labels"):
        scene.set_layer(layer, False)
    for flank in study.cam.flanks:
        pressure = study.stress[flank.name].pressure / 1e6
        for wanted, value in ((SKY, 25.0), (VERMILION, 99.0), (LIGHT.limit, pressure.max())):
            place = flank.profile[int(np.abs(pressure - value).argmin())] * 1e3
            assert unlike(colour_at(scene, complex(place), QColor(wanted)), QColor(wanted)) < 60, (flank.name, wanted)
    assert scene.overlay is not None
    assert scene.overlay.colours["stress_colours"].texts == [
        "Contact pressure up to the allowable value",
        "0",
        "50",
        "100 MPa",
    ]
    before = set(scene.item("stress_colours.inner").colours)
    scene.update_study(Study(edited(design, "cam.thickness_mm", 200.0), 720))
    assert set(scene.item("stress_colours.inner").colours) != before
    scene.update_study(Study(edited(design, "cam.thickness_mm", None), 720))
    assert not any(key.startswith("stress_colours") for key in scene.parts), "nothing to show"


def test_curvature_tells_concave_from_convex_by_its_radius() -> None:
    flat = scene_of(beginning("translating", {"follower.face": "flat"}), "curvature_colours")
    assert flat.overlay is not None
    radius = (
        1.0 / Study(beginning("translating", {"follower.face": "flat"}), 720).cam.flank.profile_curvature.max() * 1e3
    )
    name, low, high = flat.overlay.colours["curvature_colours"].texts
    assert (name, low) == ("Radius of curvature, mm", "straight")
    assert float(high.removeprefix("convex R ")) == pytest.approx(radius, rel=0.1)
    hollow = scene_of(edited(beginning("translating"), "motion.stroke", 60.0), "curvature_colours")
    assert hollow.overlay is not None
    bar = hollow.overlay.colours["curvature_colours"]
    assert bar.texts[1].startswith("concave R ")
    name, *ticks = (item.pixel_box().translated(item.pos()) for item in bar.childItems() if isinstance(item, Tag))
    for one, other in pairwise(sorted(ticks, key=QRectF.left)):
        assert one.right() < other.left(), "their texts stand clear of each other"
    assert ticks[0].left() == pytest.approx(-bar.width)
    assert ticks[-1].right() == pytest.approx(0.0)


def test_layers_that_are_not_shown_are_not_made() -> None:
    design = beginning("oscillating", {"cam.form": "conjugate"})
    scene = scene_of(design)
    lazy = ("pressure_colours", "curvature_colours", "dimensions")
    assert scene.overlay is not None
    assert not any(key.startswith(lazy) for key in scene.parts)
    assert scene.overlay.colours == {}
    for layer in lazy:
        scene.set_layer(layer, True)
        made = {key: part.item for key, part in scene.parts.items() if key.startswith(layer)}
        assert made
        scene.set_layer(layer, False)
        assert not any(item.isVisible() for item in made.values())
        scene.set_layer(layer, True)
        assert all(scene.item(key) is item for key, item in made.items()), "the same items come back"
        scene.set_layer(layer, False)
    scene.update_study(Study(edited(design, "cam.base_radius_mm", 46.0), 720))
    assert not any(key.startswith(lazy) for key in scene.parts), "an edit makes none that is hidden"


def test_colours_are_chosen_one_at_a_time_in_the_menu_of_layers(user: User) -> None:
    by_pressure, by_curvature = (
        user.action("View", "Layers of the drawing", text) for text in (BY_PRESSURE, BY_CURVATURE)
    )
    scene = user.drawing().scene
    for chosen, other in ((by_pressure, by_curvature), (by_curvature, by_pressure)):
        chosen.trigger()
        settle()
        user.drawing()
        assert (chosen.isChecked(), other.isChecked()) == (True, False)
        shown = {
            key.partition(".")[0] for key, part in scene.parts.items() if part.item.isVisible() and "_colours" in key
        }
        assert shown == {chosen.objectName().removeprefix("layer:")}
    by_curvature.trigger()
    settle()
    user.drawing()
    assert not any(part.item.isVisible() for key, part in scene.parts.items() if "_colours" in key), "plain again"
    assert user.entries("Kine", "Colour the profile") == [BY_PRESSURE, BY_CURVATURE, BY_STRESS], "and where the task is"


# -- values under the mouse -----------------------------------------------------------------------------------


def hover(user: User, at: complex) -> str:
    """Move the mouse to a place of the drawing [mm]; what is read there."""
    canvas = user.drawing().canvas
    QTest.mouseMove(canvas.viewport(), pixel(canvas, at))
    settle()
    overlay = user.drawing().scene.overlay
    assert overlay is not None
    return overlay.reading_text


def test_the_mouse_over_the_profile_reads_its_values(open_user: Open) -> None:
    user = open_user()
    for changes, name in (
        ({}, "Profile"),
        ({"cam.form": "groove"}, "Outer flank"),
        ({"cam.form": "conjugate"}, "Second cam"),
    ):
        user.session.start(beginning("oscillating", changes))
        study = user.turn(40.0)
        drawing, whole = user.drawing(), user.session.study
        flank, i = whole.cam.flanks[-1], 3 * whole.theta.size // 5
        turned = np.exp(1j * study.sense * user.window.player.theta)
        text = hover(user, complex(flank.profile[i] * turned) * 1e3)
        assert text.startswith(f"{name} at ")
        values = [float(word.rstrip("°:,")) for word in text.split() if word[0].isdigit()]
        angle, radius, pressure, curved = values
        assert angle == pytest.approx(np.rad2deg(whole.theta[i]), abs=1.5)
        assert radius == pytest.approx(abs(flank.profile[i]) * 1e3, abs=0.5)
        assert pressure == pytest.approx(np.rad2deg(flank.pressure_angle[i]), abs=0.6)
        assert curved == pytest.approx(1e3 / abs(flank.profile_curvature[i]), rel=0.05)
        scene = drawing.scene
        box = next(item for item in scene.items() if isinstance(item, Tag) and item.text.startswith(name))
        top = drawing.canvas.viewport().mapFromGlobal(drawing.canvas.viewport().mapToGlobal(QPoint(0, 0)))
        read = box.pixel_box().translated(drawing.canvas.viewportTransform().map(box.scenePos()))
        drawn = drawing.canvas.viewportTransform().mapRect(scene.fit_rect())
        assert not QRectF(read).intersects(drawn), "it covers nothing"
        assert read.left() > top.x()
        before = text
        user.turn(90.0)
        assert hover(user, 0j) == "" != before
    QApplication.sendEvent(user.drawing().canvas, QEvent(QEvent.Type.Leave))
    assert hover(user, 1000.0 + 0j) == ""


# -- dimensions -------------------------------------------------------------------------------------------------

DIMENSIONED: dict[str, tuple[Design, dict[str, str]]] = {
    "cam-slider": (
        load(example("transfer_lift")),
        {"L1 ": "follower.slider_arm_mm", "L2 ": "follower.rod_mm", "Zl ": "follower.roller_arm_mm", "γ ": "follower.fixed_angle_deg",
         "H ": "follower.guide_height_mm", "x ": "follower.pivot_x_mm", "y ": "follower.pivot_y_mm", "Br ": "cam.base_radius_mm",
         "Rr ": "cam.roller_radius_mm"},
    ),
    "offset": (
        edited(beginning("translating"), "follower.offset_mm", -15.0),
        {"e ": "follower.offset_mm", "Br ": "cam.base_radius_mm", "Rr ": "cam.roller_radius_mm"},
    ),
    "tilted": (
        edited(beginning("translating", {"follower.face": "flat"}), "follower.face_tilt_deg", -10.0),
        {"": "follower.face_tilt_deg", "Br ": "cam.base_radius_mm"},
    ),
    "flat rocker": (
        edited(beginning("oscillating", {"follower.face": "flat"}), "follower.face_offset_mm", 6.0),
        {"f ": "follower.face_offset_mm", "x ": "follower.pivot_x_mm", "y ": "follower.pivot_y_mm", "Br ": "cam.base_radius_mm"},
    ),
    "conjugate rocker": (
        beginning("oscillating", {"cam.form": "conjugate"}),
        {"Zl ": "follower.arm_mm", "Zl₂ ": "follower.second.arm_mm", "": "follower.second.angle_deg", "x ": "follower.pivot_x_mm",
         "y ": "follower.pivot_y_mm", "Br ": "cam.base_radius_mm", "Rr ": "cam.roller_radius_mm", "Rr₂ ": "cam.second.roller_radius_mm"},
    ),
    "conjugate slide": (
        beginning("translating", {"cam.form": "conjugate"}),
        {"": "follower.second.distance_mm", "Br ": "cam.base_radius_mm", "Rr ": "cam.roller_radius_mm",
         "Rr₂ ": "cam.second.roller_radius_mm"},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", DIMENSIONED)
def test_the_dimensions_are_those_that_were_typed(name: str) -> None:
    design, wanted = DIMENSIONED[name]
    scene = scene_of(design, "dimensions")
    values = {symbol: get(design, path) for symbol, path in wanted.items()}
    signed = {path for path in wanted.values() if path.endswith("_deg")}
    shown = [
        f"{symbol}{value if wanted[symbol] in signed else abs(value):.9g}{'°' if wanted[symbol] in signed else ''}"
        for symbol, value in values.items()
    ]
    assert sorted(text.replace("−", "-") for text in texts(scene, "dimensions")) == sorted(shown)


def test_the_dimension_of_an_arm_goes_with_it() -> None:
    design = beginning("oscillating")
    scene = scene_of(design, "dimensions")
    number = next(
        key.split(".")[1]
        for key, part in scene.parts.items()
        if key.endswith(".text") and getattr(part.item, "text", "") == "Zl 90"
    )
    lines: Any = scene.item(f"dimensions.{number}.lines")
    at: list[float] = []
    for index in (0, 300):
        scene.set_index(index)
        path = lines.sceneTransform().map(lines.path())
        ends = [complex(path.elementAt(i).x, path.elementAt(i).y) for i in range(2)]
        assert abs(ends[1] - ends[0]) == pytest.approx(90.0, abs=1e-6)
        arm = Study(design, 720).linkage.bodies["arm"]
        bar = arm.position("roller")[index] - arm.position("pivot")[index]
        assert abs(((ends[1] - ends[0]) / bar).imag) < 1e-6, "parallel to the arm"
        at.append(float(np.angle(ends[1] - ends[0])))
    assert abs(np.rad2deg(at[1] - at[0])) == pytest.approx(18.0, abs=0.1)


def test_dimensions_are_in_the_picture_when_they_are_shown(user: User) -> None:
    drawing = user.drawing()
    user.choose("View", "Layers of the drawing", "Dimensions")
    user.drawing()
    assert drawing.canvas.fitted
    standing = [
        part.item for key, part in drawing.scene.parts.items() if key.startswith("dimensions.") and part.move is None
    ]
    assert standing
    assert all(drawing.canvas.visible.contains(item.sceneBoundingRect()) for item in standing)
    QTest.keyClick(drawing.canvas, Qt.Key.Key_F)


def test_a_pressure_that_cannot_be_shown_says_what_to_give_and_a_material_chosen_in_the_form_shows_it(
    user: User,
) -> None:
    user.action("View", "Layers of the drawing", BY_STRESS).trigger()
    settle()
    view = user.drawing()
    plot = user.see("contact_pressure")
    said = "give the thickness of the cam, and the material of the cam, or its Young's modulus, and the material of the roller"
    assert said in unescape(view.note.text())
    assert said in plot.message
    user.enter("cam.thickness_mm", "80")
    for path in ("cam.material", "cam.roller_material"):
        box = user.field(path).editor
        assert (box.itemText(0), box.currentData()) == ("–", None)
        box.setFocus()
        QTest.keyClicks(box, "16Mn")
        assert get(user.design, path) == "16mncr5"
        assert "ISO 6336-2" in box.toolTip()
    view, plot = user.drawing(), user.see("contact_pressure")
    assert not view.note.isVisible()
    assert view.scene.overlay.colours["stress_colours"].texts[-1] == "1500 MPa"
    assert [row.slug for row in plot.rows] == ["contact_pressure_mpa"]
    user.enter("cam.roller_load_rating_n", "500000")
    (life,) = roller_lives(user.session.study)
    said = user.see("contact_pressure").note.text().replace("\u202f", "")
    assert f"{float(f'{life.million_turns:.4g}'):.0f} million turns, {float(f'{life.hours:.4g}'):.0f} h" in said
    user.field("cam.roller_material")
    box.setFocus()
    QTest.keyClick(box, Qt.Key.Key_Home)
    assert get(user.design, "cam.roller_material") is None, "and not known again"
