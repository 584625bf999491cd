"""What of the drawn machine lies under the mouse, and the field that it stands for."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from PySide6.QtCore import QPointF

from core.design import entries
from core.followers.dragging import joints_of
from kindyna_gui.labels import name_of
from kindyna_gui.linkage.canvas import Canvas
from kindyna_gui.linkage.load_places import rows_at
from kindyna_gui.linkage.picking import Picker
from kindyna_gui.pictures.drawing.geometry import Geometry
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.drawing.profile_reading import on_cam
from kindyna_gui.touched import Thing

# -- what lies where ------------------------------------------------------------------------------------------

LINKS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "arm": ("follower.slider_arm_mm", "follower.arm_mm", "follower.face_offset_mm"),
        "rod": ("follower.rod_mm",),
        "slider": ("follower.guide_height_mm",),
        "follower": ("follower.offset_mm",),
    }
)
"""Body of a follower -> the fields that say how large it is, the first that a design has."""


def thing_at(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex) -> Thing | None:
    """The uppermost thing at a place [mm], with its field; None on the bare sheet."""
    geometry = scene.geometry
    if geometry is None:
        return None
    return next((found for look in LOOKS if (found := look(canvas, scene, picker, at, geometry)) is not None), None)


def _pin(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex, geometry: Geometry) -> Thing | None:
    name = canvas.joint_at(canvas.viewportTransform().map(QPointF(at.real, at.imag)), rims=False)
    drag = joints_of(geometry.study.design).get(name)
    return None if drag is None else Thing(drag.label[:1].upper() + drag.label[1:], drag.field, "pressure_angle")


def _load(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex, geometry: Geometry) -> Thing | None:
    rows = [row for row in rows_at(canvas, at) if row]
    return Thing(name_of(geometry.study.design, rows[0]), rows[0]) if rows else None


def _face(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex, geometry: Geometry) -> Thing | None:
    inside = abs(at - complex(geometry.reference[scene.index])) <= geometry.face_radius
    if not inside or geometry.face_radius == 0.0:
        return None
    noun = geometry.study.design.drive.face.noun
    return Thing(noun[:1].upper() + noun[1:], geometry.face_path, "contact_force")


def _link(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex, geometry: Geometry) -> Thing | None:
    name = picker.face_at(geometry, geometry.moving, at)
    if name is None:
        return None
    design = geometry.study.design
    number = next((n for n, body in geometry.study.mechanism.bodies.items() if body == name), 0)
    typed = [
        row.path for section in ("follower", "linkage") if section in design.tables for row in entries(design, section)
    ]
    links = design.drive.linkage.links if design.drive.links else ()
    own = [f"linkage.links[{i}].points" for i, link in enumerate(links) if link.number == number]
    path = next((path for path in LINKS.get(name, ()) if path in typed), "")
    path = path or next(
        (path for path in typed if own and path.startswith(own[0])), "follower" if not links else "linkage"
    )
    return Thing(f"Link {number}" if links else name[:1].upper() + name[1:], path)


def _cam(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex, geometry: Geometry) -> Thing | None:
    if not on_cam(geometry, scene.index, at):
        return None
    sized = hasattr(geometry.study.design.drive.cam, "base_radius_mm")
    return Thing("Cam", "cam.base_radius_mm" if sized else "cam", "pitch_curvature", profile=True)


LOOKS = (_pin, _load, _face, _link, _cam)
"""What may lie under the mouse, the uppermost first."""


__all__ = ["thing_at"]
