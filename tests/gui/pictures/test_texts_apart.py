"""Texts of the drawing over the whole turn, by their boxes: on none of the others, and off the curves, as far as a crank that goes all
round leaves room for them."""

from itertools import combinations

import numpy as np
import pytest
from plot_reading import box_in_mm
from PySide6.QtCore import QRectF
from sampled import stressed

from core.project import load
from core.study import Study
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.items import Tag
from kindyna_gui.places import examples
from kindyna_gui.requirements import lists_links

pytestmark = pytest.mark.usefixtures("app")

SAMPLES, EVERY = 180, 9
TOUCHES = 1.5  # pixels by which two boxes may overlap
OVER, CROSSED = 0.003, 0.025  # of the boxes, at all angles together: over another, over a curve

STUDIES = [study for _, path in examples() for study in Study(load(path), SAMPLES).drives.values()]


def boxes(scene: MechanismScene, scale: float, prefix: str = "") -> dict[str, QRectF]:
    """Of the texts that are seen [mm]."""
    found = {}
    for key, part in scene.parts.items():
        tag = part.item
        if isinstance(tag, Tag) and tag.isVisible() and tag.opacity() > 0.5 and tag.text and key.startswith(prefix):
            found[key] = box_in_mm(tag, scale)
    return found


@pytest.mark.parametrize("size", [(1200, 900), stressed((640, 480))])
def test_no_text_stands_over_another(size: tuple[int, int]) -> None:
    over, count = [], 0
    for study in STUDIES:
        scene = MechanismScene(study)
        visible, scale = scene.fit(*size)
        scene.show_region(visible, scale)
        for i in range(0, SAMPLES, EVERY):
            scene.set_index(i)
            there = boxes(scene, scale)
            count += len(there)
            for (one, box), (other, behind) in combinations(there.items(), 2):
                both = box.intersected(behind)
                if min(both.width(), both.height()) * scale > TOUCHES:
                    over.append((study.design.name, i, one, other))
    assert len(over) <= OVER * count, over
    assert [row for row in over if not row[1]] == [], "where the drawing begins"


@pytest.mark.parametrize("size", [stressed((1200, 900)), (640, 480)])
def test_names_keep_clear_of_coupler_curves(size: tuple[int, int]) -> None:
    over, count = 0, 0
    for study in (each for each in STUDIES if lists_links(each.design)):
        scene = MechanismScene(study)
        scene.set_layer("coupler", True)
        visible, scale = scene.fit(*size)
        scene.show_region(visible, scale)
        assert scene.geometry is not None
        bodies = scene.geometry.bodies.values()
        drawn = {key.removeprefix("coupler.") for key in scene.parts if key.startswith("coupler.")}
        curves = [body.track(place) for body in bodies for name, place in body.points.items() if name in drawn]
        assert curves
        for i in range(0, SAMPLES, EVERY):
            scene.set_index(i)
            for box in boxes(scene, scale, "label.").values():
                x, y = (np.concatenate([part(curve) for curve in curves]) for part in (np.real, np.imag))
                count += 1
                over += bool(((x > box.left()) & (x < box.right()) & (y > box.top()) & (y < box.bottom())).any())
    assert over <= CROSSED * count
