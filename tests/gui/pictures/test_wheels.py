"""Wheels of second inputs in the drawing: pitch circles that touch and turn in their ratio, a belt that touches both."""

import numpy as np
import pytest
from linkages import geared
from PySide6.QtCore import QPointF
from PySide6.QtWidgets import QApplication

from core.mechanism.drivers import wheel_pairs
from core.study import Study
from kindyna_gui.pictures.drawing.mechanism import MechanismScene


def test_pitch_circles_touch_and_turn_in_their_ratio(app: QApplication) -> None:
    scene = MechanismScene(Study(geared(kind="gear", teeth_first=18, teeth_second=12, module_mm=4.0), 360))
    first, second = (scene.item(f"wheel1.{name}") for name in ("first", "second"))
    for index in (0, 50):
        scene.set_index(index)
        one, other = (item.mapToScene(item.path()).boundingRect() for item in (first, second))  # type: ignore[attr-defined]
        assert (one.width(), other.width()) == pytest.approx((72.0, 48.0), abs=0.05)
        assert one.right() == pytest.approx(other.left(), abs=0.05)
        assert second.rotation() - first.rotation() == pytest.approx(
            -2.5 * 2.0 * index, abs=1e-6
        )  # a cycle is two turns
    assert scene.fit(800, 600)[0].contains(second.mapToScene(second.path()).boundingRect())  # type: ignore[attr-defined]
    assert "wheel1.belt" not in scene.parts


def test_a_belt_touches_both_pulleys(app: QApplication) -> None:
    scene = MechanismScene(Study(geared(kind="belt", radius_first_mm=16.0, radius_second_mm=8.0), 36))
    path = scene.item("wheel1.belt").path()  # type: ignore[attr-defined]
    ends = [QPointF(path.elementAt(i).x, path.elementAt(i).y) for i in range(path.elementCount())]
    for i, (centre, radius) in enumerate(((0j, 16.0), (60 + 0j, 8.0)) * 2):
        assert abs(complex(ends[i].x(), ends[i].y()) - centre) == pytest.approx(radius)
    way = complex(ends[1].x() - ends[0].x(), ends[1].y() - ends[0].y())
    assert (way.conjugate() * complex(ends[0].x(), ends[0].y())).real == pytest.approx(0.0, abs=1e-9)
    assert np.isclose(abs(way), np.sqrt(60.0**2 - 8.0**2))


def test_teeth_without_a_module_have_no_circle() -> None:
    assert list(wheel_pairs(geared(kind="gear", teeth_first=18, teeth_second=12).drive.linkage)) == []
