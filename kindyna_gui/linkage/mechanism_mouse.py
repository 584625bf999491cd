"""The mouse on the mechanism: drags joints and circles, runs the machine by a link, picks attachments, opens menus."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from math import ceil, log10
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QPoint, Qt, Signal
from PySide6.QtGui import QKeyEvent, QKeySequence, QPainter, QShortcut

from core.design import AttachedEnd, Target, entry_at, put, split_unit
from core.errors import KindynaError
from kindyna_gui.documents.edits import Refusal
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import allowed_text, no_number, reason, value_text
from kindyna_gui.linkage.canvas import Canvas, draggable_circles
from kindyna_gui.linkage.picking import Picker, PickFunction, next_row, paint_row, rows_at
from kindyna_gui.pictures.drawing.geometry import MM
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.player import Player, obey
from kindyna_gui.rebuilt import connect_all
from kindyna_gui.view import View, ViewHost

if TYPE_CHECKING:  # imported when first used
    from kindyna_gui.linkage.drives_mouse import DrivesMouse
    from kindyna_gui.touch_targets import MouseTarget, ReadoutLine

REFUSAL_LENGTH = 42  # of a line of the read-out that says why a value is refused, characters
PROFILE_REACH = 8.0  # distance within which a profile is read, pixels
RUN_PARTS = 12  # one move of the mouse runs the machine by at most this part of a turn


class JointDrag:
    """A joint or a circle that is being dragged.

    name     name of the joint, or path of the circle
    field    path of the field that changes
    work     all work before the drag
    rim      centre and radius of a circle [mm]
    pressed  position of the press [mm]
    at       position of the mouse [mm]
    typed    number typed during the drag
    lines    read-out next to the mouse
    refusal  why the last position or number was refused
    """

    def __init__(
        self, name: str, field: str, work: object, rim: tuple[complex, float] | None, pressed: complex
    ) -> None:
        self.name, self.field, self.work, self.rim, self.pressed = name, field, work, rim, pressed
        self.at, self.typed, self.refusal = pressed, "", ""
        self.lines: list[ReadoutLine] = []

    @property
    def shown(self) -> list[ReadoutLine]:
        """Lines of the read-out and of the refusal; a typed number replaces the first."""
        from textwrap import wrap  # imported here to save start-up time

        lines = [(f"{self.typed}_", False), *self.lines[1:]] if self.typed else self.lines
        return [*lines, *((line, True) for line in wrap(self.refusal, REFUSAL_LENGTH))]


class MechanismMouseView(View):
    """Drawing of one mechanism that responds to the mouse.

    load_opened  (path): a row of the loads was clicked; empty for a load without a row
    is_stale     the drawing shows the last valid design, not the typed one
    """

    load_opened = Signal(str)

    def __init__(self, session: Session, player: Player) -> None:
        self.scene = MechanismScene()
        self.canvas = Canvas(self.scene)
        super().__init__(session, player)
        self.is_stale = self._layout_shown = False
        self.drag: JointDrag | None = None
        session.refused.connect(self._show_refusal)
        session.accepted.connect(self._clear_refusal)
        self.picker = Picker(self.canvas, self.scene)
        self._drives: DrivesMouse | None = None  # created when all drives are first drawn
        self._escape = QShortcut(QKeySequence(Qt.Key.Key_Escape), self, context=Qt.ShortcutContext.WindowShortcut)
        self._escape.setEnabled(False)
        connect_all(
            (self._escape.activated, self._cancel),
            (self.canvas.joint_pressed, self._start_drag),
            (self.canvas.joint_dragged, self._drag_joint),
            (self.canvas.joint_released, lambda _: self._end_drag()),
            (self.canvas.hovered, self._read_profile),
            (self.canvas.hovered, self.picker.hover),
            (self.canvas.clicked, self._click),
            (self.canvas.menu_requested, self._open_menu),
        )
        self.canvas.start_run = self._run_from
        connect_all(
            (self.picker.prompted, lambda _: self._escape.setEnabled(True)),
            (self.picker.ended, lambda _: self._escape.setEnabled(False)),
            (session.load_chosen, self.canvas.viewport().update),
            (session.full_design_changed, partial(self.picker.end, "the design has changed")),
        )

    def belong_to(self, window: ViewHost) -> None:
        super().belong_to(window)
        self.load_opened.connect(window.open_load)
        self.picker.prompted.connect(window.ask)
        self.picker.ended.connect(window.answered)

    @property
    def shows_layout(self) -> bool:
        """Whether the linkage is shown as drawn: while drawing, and if it is incomplete.

        A follower has no layout, even before the view follows a design that was opened in place of a linkage.
        """
        return self._layout_shown and bool(self.session.typed.drive.links)

    @property
    def _shows_solution(self) -> bool:
        return self.up_to_date and not self.in_trouble

    def _read_profile(self, at: complex | None) -> None:
        """Show the values of the profile under the mouse."""
        if self._shows_solution:
            self.scene.read_profile(at, PROFILE_REACH / self.canvas.scale_now)

    # -- running the machine by a link ------------------------------------------------------------------------

    def _run_from(self, at: complex) -> Callable[[complex], None] | None:
        """Return the function that moves the link at a position to the mouse; None if there is no link."""
        geometry, index = self.scene.geometry, self.scene.index
        if geometry is None or self.shows_layout or self.is_stale or not self.session.design.drive.links:
            return None
        name = self.picker.face_at(geometry, geometry.moving, at)
        if name is None:
            return None
        self.player.play(False)
        body = geometry.bodies[name]
        track = body.track((at - complex(body.z[index])) * body.turn[index].conjugate())

        def run(to: complex) -> None:
            reach = geometry.samples // RUN_PARTS
            near = self.scene.index + np.arange(-reach, reach + 1)
            near = near % geometry.samples if geometry.is_full_turn else np.clip(near, 0, geometry.samples - 1)
            theta = float(np.deg2rad(geometry.cam_angle[near[np.argmin(np.abs(track[near] - to))]]))
            self.player.set_theta(theta, self.player.turn)

        return run

    # -- dragging a joint or a circle -------------------------------------------------------------------------

    def _start_drag(self, name: str) -> None:
        from core.followers.dragging import joints_of

        self.player.play(False)
        self.player.set_theta(self.player.theta)  # the edit changes the first turn
        self.session.begin_drag(self)
        joints = joints_of(self.session.design)
        field = joints[name].field if name in joints else name
        rim = draggable_circles(self.scene).get(name)
        self.drag = JointDrag(name, field, self.session.work, rim, self.canvas.pressed_position)
        self._escape.setEnabled(True)

    def _drag_joint(self, name: str, position: complex) -> None:
        """Move the joint to the mouse at the current angle; if that is not valid, the last valid design stays."""
        drag = self.drag
        if drag is None or drag.typed:
            return
        drag.at = position
        decimals = max(0, ceil(log10(self.canvas.scale_now)) + 1)
        if drag.rim is None:
            self._move_joint(name, position, decimals)
        else:  # by the outward movement of the mouse, as the centre may move while the circle grows
            centre, radius = drag.rim
            self._set_field(drag, radius + abs(position - centre) - abs(drag.pressed - centre), decimals)

    def _move_joint(self, name: str, position: complex, decimals: int) -> None:
        from core.followers.dragging import joints_of, move_joint

        design, joint = self.session.design, joints_of(self.session.design)[name]
        kinematics = self.session.at(self.player.theta).linkage
        try:
            moved_design = move_joint(design, kinematics, name, position / MM, decimals)
        except KindynaError as error:
            self.session.refuse(joint.field, reason(design, error))
        else:
            self.session.put(moved_design, f"Move {joint.label}", joint.field)

    def _set_field(self, drag: JointDrag, value: float, decimals: int) -> bool:
        """Set the dragged field to a value in the unit of its file."""
        unit, entry = split_unit(drag.field)[1], entry_at(self.session.design, drag.field)
        assert entry is not None
        info = entry.info
        value = round(value, decimals) + 0.0
        if not info.admits(value):
            self.session.refuse(
                drag.field,
                f"outside its range; allowed: {allowed_text(info, unit)}, not {value_text(value, unit)}",
            )
            return False
        return self.session.put(put(self.session.design, drag.field, value), f"Change {info.in_sentence}", drag.field)

    def _show_refusal(self, refusal: Refusal) -> None:
        """Show next to the mouse why the dragged value is refused."""
        if self.drag is not None:
            self.drag.refusal = refusal.at(refusal.path)
            self.canvas.viewport().update()

    def _clear_refusal(self, _: str) -> None:
        if self.drag is not None:
            self.drag.refusal = ""

    def _update_readout(self) -> None:
        """Compute the read-out of the drag for the current design."""
        if self.drag is not None:
            from kindyna_gui.touch_targets import readout_lines

            self.drag.lines = readout_lines(self.session.study, self.drag.field, tuple(self.session.stages_on_screen()))

    def _type(self, event: QKeyEvent) -> bool:
        """Type a number during a drag, set with Return; False if the key has another meaning."""
        from kindyna_gui.touch_targets import typed_key

        drag = self.drag
        if drag is None:
            return False

        def enter(value: float | None) -> bool:
            if value is None:
                self.session.refuse(drag.field, no_number(drag.typed))
            elif self._set_field(drag, value, 12):
                self._end_drag()
            return False  # a number that was refused can be corrected

        typed = typed_key(drag.typed, event, split_unit(drag.field)[1], enter)
        drag.typed = drag.typed if typed is None else typed
        self.canvas.viewport().update()
        return typed is not None

    def _end_drag(self, back: bool = False) -> None:
        """End the drag; with ``back`` the design returns to its state before the drag."""
        drag, self.drag = self.drag, None
        if drag is not None:
            self.canvas.end_drag()
            self._escape.setEnabled(self.picker.active)
            self.session.end_field_drag(drag.field, drag.work if back else None)
            self.canvas.viewport().update()

    def _cancel(self) -> None:
        """Cancel the drag, else the picking."""
        if self._drives is not None and self._drives.is_dragging:
            self._drives.end_drag(back=True)
        elif self.drag is not None:
            self._end_drag(back=True)
        else:
            self.picker.end("Nothing was selected")

    # -- clicks -----------------------------------------------------------------------------------------------

    def pick(
        self,
        what: str,
        ends: Sequence[AttachedEnd],
        accept: PickFunction,
        is_optional: bool = False,
        other_ends: Sequence[Target | None] = (),
    ) -> None:
        """Let the user pick attachments on the current drive, with the cam at rest; see ``Picker.start``."""
        self.player.play(False)
        self.leave_sheet()
        self.show_drive_alone()
        self.pull()
        self.picker.start(what, ends, accept, is_optional, other_ends)
        self.canvas.setFocus()

    def show_drive_alone(self) -> None:
        """Draw only the current drive."""

    def leave_sheet(self) -> None:
        """Let the sheet over the drawing be removed."""

    def _click(self, at: complex) -> None:
        """Pick an attachment, else open the row of the loads or the field at a position."""
        if self.picker.active:
            self.picker.click(at)
        elif self._shows_solution and (rows := rows_at(self.canvas, at)):
            self.load_opened.emit(next_row(rows, self.session.load))
        elif (target := self._target_at(at)) is not None and self._host is not None:
            self._host.focus_field(target.path)

    def _target_at(self, at: complex) -> MouseTarget | None:
        from kindyna_gui.linkage.drives_mouse import target_at

        if not self._shows_solution or self.shows_layout:
            return None
        return target_at(self.canvas, self.scene, self.picker, at)

    def _open_menu(self, at: complex, on_screen: QPoint) -> None:
        """Open the context menu of the part at a position."""
        from kindyna_gui.touch_targets import open_menu

        if not self.shows_layout and self._host is not None:
            open_menu(self._target_at(at), self, self._host, on_screen)

    # -- painting and keys ------------------------------------------------------------------------------------

    def _paint_mouse(self, painter: QPainter) -> None:
        """Paint the selected row of the loads, the candidates of the picker, and the read-out of the drag."""
        paint_row(self.canvas, painter, self.session.load)
        self.picker.paint(painter)
        if self.drag is not None:
            from kindyna_gui.touch_targets import paint_readout

            pixel = self.canvas.pixel_at(self.drag.at)
            paint_readout(painter, self.drag.shown, pixel, self.canvas.viewport().rect())

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if self._type(event) or (self._drives is not None and self._drives.key(event)):
            return
        if self.picker.active and event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.picker.skip()
        elif event.key() == Qt.Key.Key_F and not event.modifiers():
            self.fit()
        elif not obey(self.player, event):
            super().keyPressEvent(event)
