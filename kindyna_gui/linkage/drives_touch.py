"""Several drives, loads under the mouse."""

from __future__ import annotations

from cmath import phase
from collections.abc import Callable, Mapping
from math import degrees
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QCursor, QKeyEvent
from PySide6.QtWidgets import QApplication

from core.design import drive_names, entries, phase_room, split_unit, turn_drive
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
from kindyna_gui.timing_canvas import FINE, STEP, DraggedDrive
from kindyna_gui.touch_targets import Answer, BesideMouse, Thing, open_menu, typed_on
from kindyna_gui.view import View

# -- touch -----------------------------------------------------------------------------------------------

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


# -- drives touch ----------------------------------------------------------------------------------------

REACH = 8.0  # pixels from a profile within which it is read


class DrivesTouch:
    """What the mouse does with the drives of a shaft that are drawn; the turn of one is a step.

    lines   what answers meanwhile, each with whether it is stopped there
    """

    def __init__(self, view: View, canvas: Canvas, drawn: Assembly, session: Session, player: Player) -> None:
        self._view, self._canvas, self._drawn, self._session, self._player = view, canvas, drawn, session, player
        self._held: DraggedDrive | None = None
        self._work: object = None
        self._typed, self._beside = "", BesideMouse(view)
        self.lines: list[Answer] = []
        self.began: Callable[[bool], object] = bool  # (True) something is held, (False) nothing any more
        canvas.runs = self._turn_from
        canvas.ran.connect(self.let_go)
        canvas.hovered.connect(self._read)
        canvas.asked.connect(self._ask)

    @property
    def holds(self) -> bool:
        """Whether a drive is held."""
        return self._held is not None

    def _read(self, at: complex | None) -> None:
        self._drawn.read_profile(at, REACH / self._canvas.scale_now)

    def _ask(self, place: QPointF, on_screen: QPoint) -> None:
        number, whole, host = self._drawn.number_at(place), self._session.full_design, self._view.host
        if host is None:
            return
        own = number is not None and number < len(whole.drives)
        thing = Thing(drive_names(whole)[number], f"drives[{number}].phase_deg") if own and number is not None else None
        open_menu(thing, self._view, host, on_screen)

    # -- a cam turned against the others ----------------------------------------------------------------------

    def _turn_from(self, at: complex) -> Callable[[complex], None] | None:
        """What turns the cam that is pressed there; None where there is none of a drive."""
        number = self._drawn.cam_at(at)
        if number is None or number >= len(self._session.full_design.drives):
            return None
        figure = self._drawn.figures[number]
        ahead = (
            -figure.shaft_position.rotation_sign * figure.geometry.rotation_sign * (-1.0 if figure.mirrored else 1.0)
        )
        last, turned = at - figure.corner, 0.0

        def run(to: complex) -> None:
            nonlocal last, turned
            if self._held is None and not self._take(number):
                return
            here = to - figure.corner
            fine = QApplication.keyboardModifiers() & Qt.KeyboardModifier.ControlModifier
            turned += ahead * degrees(phase(here / last)) * (FINE if fine else 1.0) if here and last else 0.0
            last = here
            if not self._typed:
                self._turn(turned, STEP * (FINE if fine else 1.0))

        return run

    def _take(self, number: int) -> bool:
        if self._session.drag_source is not None:
            return False
        whole = self._session.full_design
        self._player.play(False)
        self._session.begin_drag(self._view)
        self._work, self._typed = self._session.work, ""
        self._held = DraggedDrive(number, None, whole, whole.drives[number].phase_deg, phase_room(whole, number))
        self.began(True)
        return True

    def _turn(self, by: float, step: float) -> None:
        """Turn what is held by so much, in whole steps, as far as the timing lets it."""
        held = self._held
        assert held is not None
        wanted = round(round((held.at + by) / step) * step - held.at, 9)
        by, stop = held.room.within(wanted), held.room.stop(wanted)
        self._put(by)
        if stop is not None:
            row = held.design.timing[stop]
            self.lines.append((f"stops: {row.second} {short(row.least_deg)}° after {row.first}", True))
        self.tell()

    def _put(self, by: float) -> bool:
        held = self._held
        assert held is not None
        name, at = drive_names(held.design)[held.drive], short((held.at + by) % 360.0)
        done = self._session.put_full_design(
            turn_drive(held.design, held.drive, held.at + by), f"Turn {name} to {at}°", held.path
        )
        self.lines = [(f"{name} phase {at}°", False)]
        if "dynamics" in self._session.stages_on_screen() and np.isfinite(top := self._peak()):
            self.lines.append((f"Torque of the shaft {measure(top, 'N·m')}", False))
        return done

    def _peak(self) -> float:
        return float(np.abs(self._session.shaft.torque).max())

    def tell(self) -> None:
        """What answers, beside the mouse."""
        typed = [(f"{self._typed}_", False)] if self._typed else []
        self._beside.tell([*typed, *self.lines] if self.holds else [], QCursor.pos())

    def key(self, event: QKeyEvent) -> bool:
        """A phase that is typed while a drive is held goes in with Return; False: the key is another's."""
        from kindyna_gui.forms.number_box import parsed

        held = self._held
        if held is None:
            return False
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            value = parsed(self._typed, split_unit(held.path)[1]) if self._typed else None
            if value is not None and self._put(value - held.at):
                self.let_go()
            self._typed = ""
        else:
            typed = typed_on(self._typed, event)
            if typed is None:
                return False
            self._typed = typed
        self.tell()
        return True

    def let_go(self, back: bool = False) -> None:
        """Nothing is held any more; back: it goes back where it was."""
        held, self._held = self._held, None
        if held is None:
            return
        self._canvas.let_go()
        self._session.end_field_drag(held.path, self._work if back else None)
        self.began(False)
        self.tell()
