"""Parts of the drawing under the mouse, and drives of a shaft turned with the mouse."""

from __future__ import annotations

from cmath import phase
from collections.abc import Callable, Mapping
from math import degrees
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QCursor, QKeyEvent
from PySide6.QtWidgets import QApplication

from core.design import FRAME_LINK, drive_names, entries, phase_path, phase_room, split_unit, turn_drive
from core.followers.dragging import joints_of
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import name_of
from kindyna_gui.linkage.canvas import Canvas
from kindyna_gui.linkage.picking import Picker, rows_at
from kindyna_gui.pictures.drawing.assembly import Assembly
from kindyna_gui.pictures.drawing.cam_parts import on_cam
from kindyna_gui.pictures.drawing.geometry import Geometry
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.units import measure, short
from kindyna_gui.player import Player
from kindyna_gui.timing_canvas import FINE, STEP
from kindyna_gui.timing_drags import DraggedDrive
from kindyna_gui.touch_targets import MouseReadout, MouseTarget, ReadoutLine, open_menu, typed_key
from kindyna_gui.view import View

READ_REACH = 8.0  # distance within which a profile is read, pixels

LINK_FIELDS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "arm": ("follower.slider_arm_mm", "follower.arm_mm", "follower.face_offset_mm"),
        "rod": ("follower.rod_mm",),
        "slider": ("follower.guide_height_mm",),
        "follower": ("follower.offset_mm",),
        "output": ("loads.mass_kg", "loads.inertia_kg_m2"),
    }
)
"""Body of a follower -> fields of its size; the first that a design has is used."""

# -- parts under the mouse -----------------------------------------------------------------------------------


def target_at(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex) -> MouseTarget | None:
    """Return the uppermost part at a position [mm], with its field; None if there is none."""
    geometry = scene.geometry
    if geometry is None:
        return None
    return next((part for hit in HIT_TESTS if (part := hit(canvas, scene, picker, at, geometry)) is not None), None)


def _pin(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex, geometry: Geometry) -> MouseTarget | None:
    name = canvas.joint_at(canvas.pixel_at(at), rims=False)
    drag = joints_of(geometry.study.design).get(name)
    if drag is None:
        return None
    drive = geometry.study.design.drive
    moving = (
        () if not drive.links else (p.name for k in drive.linkage.links if k.number != FRAME_LINK for p in k.points)
    )
    point = name if name in moving else ""
    return MouseTarget(drag.label[:1].upper() + drag.label[1:], drag.field, "pressure_angle", point=point)


def _load(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex, geometry: Geometry) -> MouseTarget | None:
    rows = [row for row in rows_at(canvas, at) if row]
    return MouseTarget(name_of(geometry.study.design, rows[0]), rows[0]) if rows else None


def _face(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex, geometry: Geometry) -> MouseTarget | None:
    is_inside = abs(at - complex(geometry.reference[scene.index])) <= geometry.face_radius
    if not is_inside or geometry.face_radius == 0.0:
        return None
    noun = geometry.study.design.drive.face.noun
    return MouseTarget(noun[:1].upper() + noun[1:], geometry.face_path, "contact_force")


def _link(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex, geometry: Geometry) -> MouseTarget | None:
    name = picker.face_at(geometry, geometry.moving, at)
    if name is None:
        return None
    design = geometry.study.design
    number = next((n for n, body in geometry.study.mechanism.bodies.items() if body == name), 0)
    fields = [
        row.path
        for section in ("follower", "linkage", "loads")
        if section in design.tables
        for row in entries(design, section)
    ]
    links = design.drive.linkage.links if design.drive.links else ()
    points = tuple(f"linkage.links[{i}].points" for i, link in enumerate(links) if link.number == number)[:1]
    path = next((path for path in LINK_FIELDS.get(name, ()) if path in fields), "")
    table = "linkage" if links else "loads" if design.drive.is_alone else "follower"
    path = path or next((path for path in fields if path.startswith(points)), table)
    return MouseTarget(f"Link {number}" if links else name[:1].upper() + name[1:], path)


def _cam(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex, geometry: Geometry) -> MouseTarget | None:
    if not on_cam(geometry, scene.index, at):
        return None
    sized = hasattr(geometry.study.design.drive.cam, "base_radius_mm")
    return MouseTarget("Cam", "cam.base_radius_mm" if sized else "cam", "pitch_curvature", export="exports.profile")


def _in_space(
    canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex, geometry: Geometry
) -> MouseTarget | None:
    if geometry.space is None:
        return None
    from core.spatial.kinds import KINDS  # few designs have a cam in space
    from kindyna_gui.pictures.drawing.spatial_parts import part_at

    name, cam = part_at(geometry, scene.index, at), geometry.study.design.drive.cam
    if name == "cam":
        return MouseTarget(cam.label, KINDS[cam.kind].size, "pressure_angle", export="exports.surfaces")
    if name == "turret":
        return MouseTarget("Turret", "cam.rollers", "displacement")
    return MouseTarget(name.capitalize(), "cam.roller_radius_mm", "contact_force") if name else None


HIT_TESTS = (_pin, _load, _face, _link, _in_space, _cam)
"""Hit tests of the parts, the uppermost first."""


# -- drives of a shaft ---------------------------------------------------------------------------------------


class DrivesMouse:
    """The mouse on the drawing of all drives: turns a drive relative to the others, reads profiles, opens menus.

    lines   read-out during a drag, each line with whether the timing stops the drive
    """

    def __init__(self, view: View, canvas: Canvas, drawn: Assembly, session: Session, player: Player) -> None:
        self._view, self._canvas, self._drawn, self._session, self._player = view, canvas, drawn, session, player
        self._drag: DraggedDrive | None = None
        self._work: object = None
        self._typed, self._readout = "", MouseReadout(view)
        self.lines: list[ReadoutLine] = []
        self.drag_changed: Callable[[bool], object] = bool  # (True) at the start of a drag, (False) at its end
        canvas.start_run = self._turn_from
        canvas.run_ended.connect(self.end_drag)
        canvas.hovered.connect(self._read)
        canvas.menu_requested.connect(self._open_menu)

    @property
    def is_dragging(self) -> bool:
        """Whether a drive is being turned."""
        return self._drag is not None

    def _read(self, at: complex | None) -> None:
        self._drawn.read_profile(at, READ_REACH / self._canvas.scale_now)

    def _open_menu(self, position: complex, on_screen: QPoint) -> None:
        design, host = self._session.full_design, self._view.host
        number = self._drawn.number_at(QPointF(position.real, position.imag))
        if host is None:
            return
        target = None
        if number is not None and number < len(design.drives):
            target = MouseTarget(drive_names(design)[number], phase_path(design, number))
        open_menu(target, self._view, host, on_screen)

    # -- turning a drive ----------------------------------------------------------------------------------------

    def _turn_from(self, at: complex) -> Callable[[complex], None] | None:
        """Return the function that turns the cam at a position; None if there is no cam of a drive."""
        number = self._drawn.cam_at(at)
        if number is None or number >= len(self._session.full_design.drives):
            return None
        figure = self._drawn.figures[number]
        ahead = (
            -figure.shaft_position.rotation_sign * figure.geometry.rotation_sign * (-1.0 if figure.mirrored else 1.0)
        )
        last, angle = at - figure.axis, 0.0

        def run(to: complex) -> None:
            nonlocal last, angle
            if self._drag is None and not self._start_drag(number):
                return
            arm = to - figure.axis
            factor = FINE if QApplication.keyboardModifiers() & Qt.KeyboardModifier.ControlModifier else 1.0
            angle += ahead * degrees(phase(arm / last)) * factor if arm and last else 0.0
            last = arm
            if not self._typed:
                self._turn(angle, STEP * factor)

        return run

    def _start_drag(self, number: int) -> bool:
        if self._session.drag_source is not None:
            return False
        design = self._session.full_design
        self._player.play(False)
        self._session.begin_drag(self._view)
        self._work, self._typed = self._session.work, ""
        self._drag = DraggedDrive(number, None, design, design.drives[number].phase, phase_room(design, number))
        self.drag_changed(True)
        return True

    def _turn(self, angle: float, step: float) -> None:
        """Turn the dragged drive by an angle [deg], in whole steps, as far as the timing allows."""
        drag = self._drag
        assert drag is not None
        angle = round(round((drag.at + angle) / step) * step - drag.at, 9)
        stop = drag.room.stop(angle)
        self._put(drag.room.within(angle))
        if stop is not None:
            row = drag.design.timing[stop]
            self.lines.append((f"stops: {row.second} {short(row.least_deg)}° after {row.first}", True))
        self._show_readout()

    def _put(self, angle: float) -> bool:
        drag = self._drag
        assert drag is not None
        name, at = drive_names(drag.design)[drag.drive], short((drag.at + angle) % 360.0)
        done = self._session.put_full_design(
            turn_drive(drag.design, drag.drive, drag.at + angle), f"Turn {name} to {at}°", drag.path
        )
        self.lines = [(f"{name} phase {at}°", False)]
        if "dynamics" in self._session.stages_on_screen():
            peak = float(np.abs(self._session.shaft.torque).max())
            if np.isfinite(peak):
                self.lines.append((f"Torque of the shaft {measure(peak, 'N·m')}", False))
        return done

    def _show_readout(self) -> None:
        typed = [(f"{self._typed}_", False)] if self._typed else []
        self._readout.show_lines([*typed, *self.lines] if self.is_dragging else [], QCursor.pos())

    def key(self, event: QKeyEvent) -> bool:
        """Type a phase during a drag, accepted with Return; False if the key has another meaning."""
        drag = self._drag
        if drag is None:
            return False

        def enter(value: float | None) -> bool:
            if value is not None and self._put(value - drag.at):
                self.end_drag()
            return True

        typed = typed_key(self._typed, event, split_unit(drag.path)[1], enter)
        self._typed = self._typed if typed is None else typed
        self._show_readout()
        return typed is not None

    def end_drag(self, back: bool = False) -> None:
        """End the drag; with ``back`` the drive returns to its phase before the drag."""
        drag, self._drag = self._drag, None
        if drag is None:
            return
        self._canvas.end_drag()
        self._session.end_field_drag(drag.path, self._work if back else None)
        self.drag_changed(False)
        self._show_readout()
