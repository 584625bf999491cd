"""A linkage at one angle, as pictures: its centres, and its velocity polygon."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import radians
from types import MappingProxyType

import numpy as np

from core.instant_centres import velocity_polygon
from core.output.position import Snapshot
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.files import SHEET, MechanismSheet
from kindyna_gui.pictures.paper import ENLARGED, RATIO, png, svg
from kindyna_gui.pictures.style import LIGHT
from kindyna_gui.pictures.vector_polygon.sheet import PolygonSheet
from kindyna_gui.pictures.vector_polygon.velocities import velocity_box, velocity_diagram

SHEET_OF_POLYGON = (640, 560)  # pixels


def _centres_file(snapshot: Snapshot, ending: str) -> bytes:
    """The mechanism with all centres, the lines that find them and the velocity ratios from link to link."""
    vector = ending == ".svg"
    theme, closest = (LIGHT, ENLARGED) if vector else (replace(LIGHT, ratio=RATIO), 1.0)
    scene = MechanismScene(None, theme, closest, still=True)
    for layer in ("centres", "kennedy", "velocities", "chain"):
        scene.set_layer(layer, True)
    scene.update_study(snapshot.study)
    scene.set_angle(radians(snapshot.angle_deg))
    sheet = MechanismSheet(scene, *SHEET)
    return svg(sheet, snapshot.study.design.name) if vector else png(sheet)


def _polygon_file(snapshot: Snapshot, ending: str) -> bytes:
    """The velocity polygon."""
    study = snapshot.study
    sheet = PolygonSheet()
    sheet.resize(*SHEET_OF_POLYGON)
    sheet.frame_for(velocity_box(velocity_polygon(study.linkage), study.omega))
    at_angle = study.at_theta(np.array([radians(snapshot.angle_deg)]))
    name = study.angle_name.capitalize()
    sheet.show_diagram(
        velocity_diagram(velocity_polygon(at_angle.linkage), study.omega), f"{name} {snapshot.angle_deg:.1f}°"
    )
    return svg(sheet, study.design.name) if ending == ".svg" else png(sheet)


SNAPSHOTS: Mapping[str, Callable[[Snapshot, str], bytes]] = MappingProxyType(
    {"centres": _centres_file, "velocity_polygon": _polygon_file}
)
