"""Outlines in the drawing, the nearest bodies with their distance, red where they meet."""

import math
from pathlib import Path

import pytest
from outlined import clearance, example, outline, slides, studied
from PySide6.QtCore import QPointF
from window_user import Open

from core.process import resources
from core.project import load
from core.study import Study
from kindyna_gui.pictures.drawing.assembly import Assembly
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.items import Tag

WALL = outline("frame", points=[[-20.0, 60.0], [30.0, 60.0], [30.0, 200.0], [-20.0, 200.0]])
CRANK = example("four_bar") + outline("link 2", round_mm=5.0) + WALL


def scene_of(text: str, angle: float) -> MechanismScene:
    scene = MechanismScene(studied(text))
    scene.set_angle(math.radians(angle))
    return scene


def distance_in(scene) -> str:
    texts = [
        item.text for item in scene.items() if isinstance(item, Tag) and (" – " in item.text or " meet" in item.text)
    ]
    (text,) = texts
    return text


def test_the_line_leads_between_the_nearest_bodies_while_the_mechanism_turns(app) -> None:
    """Crank upright below the wall at 60 mm: 25 mm, from its round end to the wall; then at 45 degrees."""
    scene = scene_of(CRANK, 90.0)
    assert distance_in(scene) == "link 2 – frame: 25 mm"
    line = scene.item("nearest.line").boundingRect()
    assert (line.top(), line.bottom()) == pytest.approx((35.0, 60.0))
    scene.set_angle(0.25 * math.pi)
    assert distance_in(scene) == f"link 2 – frame: {60.0 - 30.0 * math.sqrt(0.5) - 5.0:.4g} mm"


def test_an_outline_covers_its_grown_body_and_moves_with_it(app) -> None:
    scene = scene_of(CRANK, 90.0)
    shape = scene.item("outline.link2")
    for point, inside in ((0.0 + 34.9j, True), (0.0 + 35.2j, False), (4.9 + 15.0j, True), (5.1 + 15.0j, False)):
        assert shape.path().contains(shape.mapFromScene(QPointF(point.real, point.imag))) == inside
    assert scene.fit_rect().contains(scene.item("outline.frame").sceneBoundingRect())


def test_bodies_that_meet_or_are_too_near_are_marked(app) -> None:
    near = CRANK + clearance("link 2", "frame", 30.0)
    free, red = (scene_of(text, 90.0).item("nearest.line").pen().color() for text in (CRANK, near))
    assert free != red
    block = example("four_bar") + outline("link 2", round_mm=5.0) + outline("frame", points=[[0.0, 20.0]], round_mm=3.0)
    assert distance_in(scene_of(block, 90.0)) == "link 2 – frame meet"


def test_the_layer_hides_outlines_and_line_and_a_design_without_outlines_has_none(app) -> None:
    scene = scene_of(CRANK, 90.0)
    scene.set_layer("outlines", False)
    assert not scene.item("outline.link2").isVisible()
    assert not scene.item("nearest.line").isVisible()
    assert not [
        key for key in MechanismScene(studied(example("four_bar"))).parts if "outline" in key or "nearest" in key
    ]


def test_drives_about_their_shaft_show_the_nearest_bodies_of_the_machine(app) -> None:
    study = Study(load(resources() / "examples" / "transfer_unit_outlines.toml"))
    scene = Assembly()
    scene.show_shaft(study.camshaft, 0, about_shaft=True)
    scene.set_machine(math.radians(180.0))
    assert distance_in(scene) == "feed.arm – lift.arm: 40.76 mm"
    scene.show_shaft(study.camshaft, 0, about_shaft=False)
    assert not [item for item in scene.items() if isinstance(item, Tag) and "feed.arm" in item.text]


def test_a_single_outline_is_drawn_without_a_line(app) -> None:
    scene = MechanismScene(studied(example("four_bar") + outline("link 2", round_mm=5.0)))
    assert scene.item("outline.link2").isVisible()
    assert scene.item("nearest.line").boundingRect().isEmpty()


SLIDES = slides(40.0, 0.0, 90.0) + outline("frame", points=[[20.0, 60.0], [40.0, 60.0], [40.0, 90.0], [20.0, 90.0]])


@pytest.mark.parametrize(("mirrored", "ends"), [(False, (5.0, 20.0)), (True, (-20.0, -5.0))])
def test_one_drive_of_several_shows_its_outlines_and_its_nearest_bodies(
    same_window: Open, tmp_path: Path, mirrored: bool, ends: tuple[float, float]
) -> None:
    """A slide of 10 mm whose top rests at 60 mm, next to a wall that begins at that height, 15 mm away from its side."""
    path = tmp_path / "slides.toml"
    path.write_text(SLIDES.replace('name = "Left"', f'name = "Left"\nmirrored = {str(mirrored).lower()}'), "utf-8")
    user = same_window(path)
    scene = user.drawing().scene
    user.turn(330.0)
    assert distance_in(scene) == "left.follower – frame: 15 mm"
    line = scene.item("nearest.line").sceneBoundingRect()
    assert (line.left(), line.right()) == pytest.approx(ends)
    assert scene.item("outline.follower").isVisible()
    assert scene.item("outline.frame").sceneBoundingRect().center().x() == pytest.approx(-30.0 if mirrored else 30.0)
    user.session.choose_drive(1)
    user.turn(330.0)
    assert distance_in(user.drawing().scene).startswith("right.follower – frame")
