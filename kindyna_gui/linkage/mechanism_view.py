"""The mechanism to scale, as it moves: fit, zoom, pan, layers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from math import ceil, log10
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QCoreApplication, QEvent, QPoint, QPointF, Qt, Signal
from PySide6.QtGui import QAction, QActionGroup, QColor, QKeyEvent, QKeySequence, QPainter, QShortcut
from PySide6.QtWidgets import QStackedWidget, QVBoxLayout

from core.design import AttachedEnd, Target, entry_at, put, split_unit, turns_on
from core.errors import KindynaError, NoSolution
from core.instant_centres import CHAINS
from core.numerics.lazy import postponing
from core.study import Study
from kindyna_gui.documents.pins import Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import misfit_sentences
from kindyna_gui.drives import ON_SHAFT, ONE, DriveStrip, drive_rows
from kindyna_gui.labels import allowed_text, no_number, reason, value_text
from kindyna_gui.linkage.canvas import Canvas, Ghost, paint_ghost, rims_now
from kindyna_gui.linkage.picking import Picker, Taken, next_row, paint_row, rows_at
from kindyna_gui.look import Note, linked
from kindyna_gui.pictures.drawing.assembly import DRIVE_LAYERS, SELECTED_LAYERS, Assembly
from kindyna_gui.pictures.drawing.geometry import MM
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.drawing.parts import (
    BODY_FORCE_LAYERS,
    COLOUR_LAYERS,
    DIMENSIONS,
    EVERY_LAYER,
    FORCE_LAYERS,
    MODULO,
    STEP_LAYERS,
    TWIST,
    available_layers,
    has_advance,
)
from kindyna_gui.pictures.style import LIGHT, SCREEN
from kindyna_gui.player import Player, obey
from kindyna_gui.requirements import ONLY_LINKAGES, why_no_forces, why_no_pressure
from kindyna_gui.view import View, ViewHost

if TYPE_CHECKING:  # made when it is first wanted
    from kindyna_gui.linkage.drawing_mode import DrawingMode
    from kindyna_gui.linkage.drives_touch import DrivesTouch
    from kindyna_gui.linkage.underlay import UnderlayDesk
    from kindyna_gui.touch_targets import Thing

PROFILE_REACH = 8.0  # pixels from the profile within which it is read
RUN_PARTS = 12  # of a turn: what one move of the mouse may run the machine
UNDERLAY = ".underlay.toml"  # ending of the file beside a design's
VEIL = 165  # of 255: how much of the paper lies over a machine that is not the one typed


class Hold:
    """What the mouse holds: its name among joints and circles, its field, all work as it was, of a circle centre and radius, and the
    place where it was taken [mm].

    at     where the mouse is now
    typed  what is typed meanwhile
    lines  what answers
    """

    def __init__(
        self, name: str, field: str, work: object, rim: tuple[complex, float] | None, pressed: complex
    ) -> None:
        self.name, self.field, self.work, self.rim, self.pressed = name, field, work, rim, pressed
        self.at, self.typed = pressed, ""
        self.lines: list[tuple[str, bool]] = []

    @property
    def shown(self) -> list[tuple[str, bool]]:
        """The lines beside the mouse; what is typed stands in place of the first."""
        return [(f"{self.typed}_", False), *self.lines[1:]] if self.typed else self.lines


class MechanismView(View):
    """The drawing in the middle of the window: of the chosen drive, or of all on the shaft.

    load_opened       (path): a row of the loads was clicked; empty: a load that has no row
    drawing_switched  (on): drawing with the mouse has begun, or ended
    """

    load_opened = Signal(str)
    drawing_switched = Signal(bool)

    is_design_wide = True

    def __init__(self, session: Session, player: Player) -> None:
        self.scene = MechanismScene()
        self.canvas = Canvas(self.scene)
        super().__init__(session, player)
        self.note = Note()
        self.strip = DriveStrip()
        self._drawing: DrawingMode | None = None
        self._underlay: UnderlayDesk | None = None
        self.shows_sheet = False  # the linkage as drawn: while it is drawn, and where it is no mechanism yet
        self.assembly = Assembly()
        self.all_canvas = Canvas(self.assembly)
        self._drives: DrivesTouch | None = None  # made when all are first drawn
        self._arrangement = ONE
        self._pale = False  # what is drawn is not what is typed
        self._layers_drawn: tuple[str, ...] = ()
        self._pages = QStackedWidget()
        self._pages.addWidget(self.canvas)
        self._pages.addWidget(self.all_canvas)
        self.set_column(self.strip, self._pages, self.note, grows=self._pages)
        self.setFocusProxy(self.canvas)
        self._fit_wanted = True
        self._layers_wanted = {name: layer.shown for name, layer in EVERY_LAYER.items()}
        self._actions = {name: self._action(name, layer.label) for name, layer in EVERY_LAYER.items()}
        one_of = QActionGroup(self)
        one_of.setExclusionPolicy(QActionGroup.ExclusionPolicy.ExclusiveOptional)
        for name in COLOUR_LAYERS:
            one_of.addAction(self._actions[name])
        session.started.connect(self._another_design)
        session.drive_chosen.connect(self._another_design)
        session.step_changed.connect(self._show_step)
        session.full_design_changed.connect(self._name_drives)
        session.incomplete_changed.connect(self.invalidate)
        session.file_changed.connect(self._look_for_underlay)
        self.strip.chosen.connect(self._choose_drive)
        self.strip.arranged.connect(self.arrange)
        self.all_canvas.clicked.connect(self._click_drive)
        self._name_drives()
        self._look_for_underlay()
        self.canvas.taken.connect(self._take_joint)
        self.canvas.dragged.connect(self._drag_joint)
        self.canvas.dropped.connect(self._drop_joint)
        self.canvas.hovered.connect(self._read_profile)
        self.picker = Picker(self.canvas, self.scene)
        self.canvas.hovered.connect(self.picker.hover)
        self.canvas.clicked.connect(self._click)
        self.canvas.asked.connect(self._open_menu)
        self.held: Hold | None = None
        self._ghost: Ghost | None = None
        Pins.of(session).changed.connect(self.canvas.viewport().update)
        self.canvas.runs = self._run_from
        self.canvas.over, self.all_canvas.over = self._paint_over, self._paint_veil
        self._escape = QShortcut(QKeySequence(Qt.Key.Key_Escape), self, context=Qt.ShortcutContext.WindowShortcut)
        self._escape.setEnabled(False)
        self._escape.activated.connect(self._take_back)
        self.picker.prompted.connect(lambda _: self._escape.setEnabled(True))
        self.picker.over.connect(lambda _: self._escape.setEnabled(False))
        session.load_chosen.connect(self.canvas.viewport().update)
        session.full_design_changed.connect(partial(self.picker.end, "another design is in place"))

    def belong_to(self, window: ViewHost) -> None:
        super().belong_to(window)
        self.load_opened.connect(window.open_load)
        self.note.linkActivated.connect(window.do)
        self.picker.prompted.connect(window.ask)
        self.picker.over.connect(window.answered)

    def _action(self, name: str, label: str) -> QAction:
        action = QAction(label, self, checkable=True, checked=self._layers_wanted[name])
        action.setObjectName(f"layer:{name}")
        action.setStatusTip(f"Show or hide in the drawing: {label.lower()}")
        action.toggled.connect(partial(self.show_layer, name))
        return action

    # -- a picture below it ----------------------------------------------------------------------------------

    @property
    def underlay(self) -> UnderlayDesk:
        """What lies under the drawing; made when it is first wanted."""
        if self._underlay is None:
            from kindyna_gui.linkage.underlay import UnderlayDesk

            self._underlay = UnderlayDesk(self.canvas, self.session, self)
            self._underlay.told.connect(self.status_message)
        return self._underlay

    def _look_for_underlay(self) -> None:
        """A design's file with an underlay beside it shows it."""
        path = self.session.path
        if self._underlay is not None:
            self._underlay.follow_file()
        elif path is not None and path.with_suffix(UNDERLAY).exists():
            self.underlay.follow_file()

    def place_underlay(self) -> None:
        """Show what places the picture under the drawing."""
        self.strip.arrangements[ONE].setChecked(True)
        self.arrange(ONE)
        self.underlay.show_panel()

    # -- a linkage that is drawn ----------------------------------------------------------------------------

    @property
    def drawing(self) -> DrawingMode:
        """What draws with the mouse; made when it is first wanted."""
        if self._drawing is None:
            from kindyna_gui.linkage.drawing_mode import DrawingMode

            self._drawing = DrawingMode(self.canvas, self.session, self.player, self)
            column = self.content.layout()
            assert isinstance(column, QVBoxLayout)
            column.insertWidget(0, self._drawing.bar)
            self._drawing.switched.connect(self._switch_drawing)
            self._drawing.switched.connect(self.drawing_switched)
            self._drawing.message.connect(self.status_message)
        return self._drawing

    @property
    def draws(self) -> bool:
        """Whether a linkage is being drawn with the mouse."""
        return self._drawing is not None and self._drawing.active

    def _wants_sheet(self) -> bool:
        typed = self.session.typed.drive
        if self.draws or not typed.links or typed.linkage.drawn is None:
            return self.draws
        waits = self.session.incomplete is not None and typed.linkage != self.session.design.drive.mechanism
        return waits or self.session.is_incomplete_linkage

    def draw(self, on: bool, tool: str = "choose") -> bool:
        """Begin to draw with the mouse, or leave it; False where there is no linkage."""
        if not on:
            if self.draws:
                self.drawing.stop()
        elif not self.session.typed.drive.links:
            self.status_message.emit(ONLY_LINKAGES)
            return False
        else:
            self.strip.arrangements[ONE].setChecked(True)
            self.arrange(ONE)
            self.picker.end("drawing begins")
            self.drawing.start(tool)
        return True

    def _switch_drawing(self, on: bool) -> None:
        self._fit_wanted = self._fit_wanted or not on
        self.invalidate()
        self.pull()

    @property
    def stages(self) -> tuple[str, ...]:  # type: ignore[override]
        """Forces, and the twist of the shaft, are computed only while they are drawn."""
        if self.shows_sheet:
            return ()
        forces = ("dynamics",) if any(self._layers_wanted[name] for name in FORCE_LAYERS) else ()
        return ("linkage", "cam", *forces, *(("stability",) if self._layers_wanted[TWIST] else ()))

    # -- drives -------------------------------------------------------------------------------------------

    def _name_drives(self) -> None:
        """The strip names the drives, where there are several."""
        self.strip.setVisible(self.session.several)
        if self.session.several:
            self.strip.show_drives(drive_rows(self.session), self.session.chosen)

    def update_style(self) -> None:
        """Theme or letters have changed."""
        self._name_drives()

    def _choose_drive(self, number: int) -> None:
        if not self.session.choose_drive(number):
            self._name_drives()

    @property
    def draws_all(self) -> bool:
        """Whether all drives are drawn, and not the chosen one alone."""
        return not self.strip.isHidden() and self._arrangement != ONE

    def arrange(self, name: str) -> None:
        """Draw the chosen drive, or all, in one of ``ARRANGEMENTS``."""
        if name != self._arrangement:
            self._arrangement, self._fit_wanted = name, True
            self.invalidate()

    def _click_drive(self, place: QPointF) -> None:
        number = self.assembly.number_at(place)
        if number is not None:
            self._choose_drive(number)

    @property
    def _layers_of_all(self) -> tuple[str, ...]:
        """The layers that are shown while all drives are drawn."""
        return tuple(name for name in (*DRIVE_LAYERS, *SELECTED_LAYERS) if self._layers_wanted[name])

    def _show_all(self) -> None:
        self._pages.setCurrentWidget(self.all_canvas)
        if self._drives is None:
            from kindyna_gui.linkage.drives_touch import DrivesTouch

            self._drives = DrivesTouch(self, self.all_canvas, self.assembly, self.session, self.player)
            self._drives.began = self._escape.setEnabled
        self._layers_drawn = self._layers_of_all
        self.assembly.show_shaft(
            self.session.shaft, self.session.chosen, self._arrangement == ON_SHAFT, self._layers_drawn
        )
        missing = self.assembly.missing
        self.note.show_message(
            f"No answer, and not drawn: {', '.join(missing)}" if missing else self._what_is_missing(self.session.study)
        )
        if self._fit_wanted:
            self.all_canvas.fit()
            self._fit_wanted = False
        else:
            self.all_canvas.show_again()

    # -- what is drawn ------------------------------------------------------------------------------------

    def refresh(self, study: Study) -> None:
        session = self.session
        self._pale = session.incomplete is not None and (self.draws_all or session.typed != session.design)
        if self.draws:
            self.drawing.refresh()
        self.shows_sheet = self._wants_sheet()
        if self.draws_all:
            self._show_all()
            return
        self._pages.setCurrentWidget(self.canvas)
        if self.shows_sheet:
            self._show_sheet()
            return
        self._draw(study)

    def _draw(self, study: Study) -> None:
        """The mechanism of this turn."""
        self._take_layers()
        if self.held is not None:  # before it is painted
            self._answer(self.held)
        self._show_missing_cam(study)
        self.scene.show_step(
            self.session.step if set(STEP_LAYERS) <= set(available_layers(study)) else None, draw=False
        )
        self.scene.update_study(self._in_turn(study), keep_labels=True, lay=not self._fit_wanted)
        self.canvas.rest.start()
        if self._fit_wanted:
            self.canvas.fit()
            self._fit_wanted = False
        else:
            self.canvas.show_again()

    def _show_sheet(self) -> None:
        """The linkage as drawn, mechanism or not."""
        self.note.show_message(self._note_of_underlay if self.draws else self.drawing.state_text())
        if self._fit_wanted:
            self._fit_wanted = False
            self.drawing.fit()
        self.canvas.viewport().update()

    @property
    def _turn(self) -> int:
        """Which turn is drawn: the first, where all are alike or wanted so."""
        return self.player.turn if has_advance(self.session.study) and not self._layers_wanted[MODULO] else 0

    def _in_turn(self, study: Study) -> Study:
        """The study of a design so many turns later; where its links do not meet any more that of the first turn, and a note."""
        self.scene.turn = self._turn
        later = study.with_design(turns_on(study.design, self._turn)) if self._turn else study
        try:
            _ = later.linkage
        except KindynaError as error:
            if later is study:
                raise
            self.note.show_message(f"Drawn is the first turn; in this one: {reason(later.design, error)}")
            return study
        return later

    def _show_missing_cam(self, study: Study) -> None:
        """A linkage without a cam is still drawn, with the reason below it; so is a cam whose pressure cannot be shown."""
        self.note.show_message(linked(self._what_is_missing(study)))

    def _what_is_missing(self, study: Study) -> str:
        """What does not fit together, so that the last machine that did is drawn; else cam, pressure or forces that are wanted, and
        why they are not drawn; empty where nothing is missing."""
        if self._pale:
            return f"Drawn is the last machine that fits together. {misfit_sentences(self.session)[0]}"
        text = ""
        try:
            _ = study.cam if "cam" in study.stages else None
            text = why_no_pressure(study) if self._layers_wanted["stress_colours"] and "cam" in study.stages else ""
        except NoSolution as error:
            text = f"No cam: {reason(study.design, error)}"
        if not text and any(self._layers_wanted[name] for name in BODY_FORCE_LAYERS):
            try:
                text = why_no_forces(study)
            except NoSolution as error:
                text = f"No forces: {reason(study.design, error)}"
        return text or self._note_of_underlay

    @property
    def _note_of_underlay(self) -> str:
        """Why the picture under the drawing is not shown."""
        return self._underlay.missing if self._underlay is not None else ""

    def follow(self, theta: float) -> None:
        if self.draws_all:
            if self._layers_of_all != self._layers_drawn:
                self._show_all()
            self.assembly.set_machine(self.player.machine)
            return
        if self.shows_sheet:
            self.drawing.refresh()
            return
        if self.scene.turn != self._turn:
            self._fit_wanted = self._fit_wanted or self.canvas.fitted  # it goes out of the picture
            self._draw(self.session.study)
        self._take_layers()
        self.scene.set_angle(theta)

    def fit(self) -> None:
        if self.shows_sheet and not self.draws_all:
            self.drawing.fit()
            return
        if self.up_to_date and not self.in_trouble:
            (self.all_canvas if self.draws_all else self.canvas).fit()
        else:
            self._fit_wanted = True

    def fit_centres(self) -> None:
        """Show the instant centres, and bring those outside the picture into it."""
        self.strip.arrangements[ONE].setChecked(True)
        self.arrange(ONE)
        self._actions["centres"].setChecked(True)
        self.pull()
        if not self.in_trouble:
            visible, scale = self.scene.fit_centres(self.canvas.viewport().width(), self.canvas.viewport().height())
            self.canvas.show_region(visible.center(), scale, keep_labels=True)
            self.canvas.fitted = False

    def _read_profile(self, at: complex | None) -> None:
        """The values of the profile under the mouse."""
        if self.up_to_date and not self.in_trouble:
            self.scene.read_profile(at, PROFILE_REACH / self.canvas.scale_now)

    # -- a link that is drawn runs the machine ----------------------------------------------------------------

    def _run_from(self, at: complex) -> Callable[[complex], None] | None:
        """What brings the place of a link that is pressed under the mouse, as near as it comes; None where there is no link."""
        geometry, index = self.scene.geometry, self.scene.index
        if geometry is None or self.shows_sheet or self._pale or not self.session.design.drive.links:
            return None
        name = self.picker.face_at(geometry, geometry.moving, at)
        if name is None:
            return None
        self.player.play(False)
        body = geometry.bodies[name]
        track = body.track((at - complex(body.z[index])) * np.exp(-1j * np.deg2rad(body.angle[index])))

        def run(to: complex) -> None:
            reach = geometry.samples // RUN_PARTS
            near = self.scene.index + np.arange(-reach, reach + 1)
            near = near % geometry.samples if geometry.is_full_turn else np.clip(near, 0, geometry.samples - 1)
            theta = float(np.deg2rad(geometry.cam_angle[near[np.argmin(np.abs(track[near] - to))]]))
            self.player.set_theta(theta, self.player.turn)

        return run

    # -- joints and circles ---------------------------------------------------------------------------------

    def _take_joint(self, name: str) -> None:
        from core.followers.dragging import joints_of

        self.player.play(False)
        self.player.set_theta(self.player.theta)  # what is changed is the first turn
        self.session.begin_drag(self)
        rim, joints = rims_now(self.scene).get(name), joints_of(self.session.design)
        field = name if name not in joints else joints[name].field
        self.held = Hold(name, field, self.session.work, rim, self.canvas.pressed_place)
        self._escape.setEnabled(True)

    def _drag_joint(self, name: str, place: complex) -> None:
        """Put what is held where the mouse is at this angle; what cannot be is refused, and the last good design stays."""
        hold = self.held
        if hold is None or hold.typed:
            return
        hold.at = place
        decimals = max(0, ceil(log10(self.canvas.scale_now)) + 1)
        if hold.rim is None:
            self._move_joint(name, place, decimals)
        else:  # by as much as the mouse has gone outwards: the circle itself may move while it grows
            centre, radius = hold.rim
            self._set_held(radius + abs(place - centre) - abs(hold.pressed - centre), decimals)

    def _move_joint(self, name: str, place: complex, decimals: int) -> None:
        from core.followers.dragging import joints_of, move_joint

        design, joint = self.session.design, joints_of(self.session.design)[name]
        kinematics = self.session.at(self.player.theta).linkage
        try:
            moved = move_joint(design, kinematics, name, place / MM, decimals)
        except KindynaError as error:
            self.session.refuse(joint.field, reason(design, error))
        else:
            self.session.put(moved, f"Move {joint.label}", joint.field)
            # shown at once: a paint that a plot waits for would show it first, and one of its own again
            QCoreApplication.sendPostedEvents(self.scene, QEvent.Type.MetaCall)

    def _set_held(self, value: float, decimals: int) -> bool:
        """Give the field of what is held a value, in the unit of its file."""
        assert self.held is not None
        path = self.held.field
        unit = split_unit(path)[1]
        entry = entry_at(self.session.design, path)
        assert entry is not None
        info = entry.info
        value = round(value, decimals) + 0.0
        if not info.admits(value):
            self.session.refuse(path, f"{value_text(value, unit)} is not {allowed_text(info, unit)}")
            return False
        return self.session.put(put(self.session.design, path, value), f"Change {info.in_sentence}", path)

    def _answer(self, hold: Hold) -> None:
        """What stands beside the mouse while something is held."""
        from kindyna_gui.touch_targets import answers

        hold.lines = answers(self.session.study, hold.field, tuple(self.session.stages_on_screen()))

    def _type(self, event: QKeyEvent) -> bool:
        """A number typed while something is held goes to its field with Return."""
        from kindyna_gui.touch_targets import typed_on

        hold = self.held
        if hold is None:
            return False
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            from kindyna_gui.forms.number_box import parsed

            value = parsed(hold.typed, split_unit(hold.field)[1]) if hold.typed else None
            if value is None:
                self.session.refuse(hold.field, no_number(hold.typed))
            elif self._set_held(value, 12):
                self._let_go()
        else:
            typed = typed_on(hold.typed, event)
            if typed is None:
                return False
            hold.typed = typed
        self.canvas.viewport().update()
        return True

    def _let_go(self) -> None:
        """What was held stays where it is."""
        hold, self.held = self.held, None
        self.canvas.let_go()
        self._escape.setEnabled(self.picker.active)
        self.session.end_drag()
        if hold is not None:
            self.session.withdraw(hold.field)
        self.canvas.viewport().update()

    def _take_back(self) -> None:
        """What is held goes back where it was; else what is asked for is given up."""
        hold = self.held
        if self._drives is not None and self._drives.holds:
            self._drives.let_go(back=True)
            return
        if hold is None:
            self.picker.end("Nothing was chosen")
            return
        self._let_go()
        if self.session.work != hold.work:
            self.session.stack.undo()

    def _drop_joint(self, name: str) -> None:
        self._let_go()

    def _another_design(self) -> None:
        self._fit_wanted = not self.draws_all or self._fit_wanted

    def _show_step(self) -> None:
        if self.up_to_date and not self.in_trouble:
            self.scene.show_step(self.session.step)

    # -- loads --------------------------------------------------------------------------------------------

    def pick(
        self,
        what: str,
        holds: Sequence[AttachedEnd],
        taken: Taken,
        can_be_left: bool = False,
        beside: Sequence[Target | None] = (),
    ) -> None:
        """Let places of the chosen drive be clicked, one after the other, with the cam at rest."""
        self.player.play(False)
        self.strip.arrangements[ONE].setChecked(True)
        self.arrange(ONE)
        self.pull()
        self.picker.ask(what, holds, taken, can_be_left, beside)
        self.canvas.setFocus()

    def _click(self, place: QPointF) -> None:
        """What is asked for, else a row of the loads that stands there."""
        at = complex(place.x(), place.y())
        if self.picker.active:
            self.picker.click(at)
        elif self.up_to_date and not self.in_trouble and (rows := rows_at(self.canvas, at)):
            self.load_opened.emit(next_row(rows, self.session.load))
        elif (thing := self._thing_at(at)) is not None and self._host is not None:
            self._host.focus_field(thing.path)

    def _thing_at(self, at: complex) -> Thing | None:
        from kindyna_gui.linkage.drives_touch import thing_at

        if not self.up_to_date or self.in_trouble or self.shows_sheet:
            return None
        return thing_at(self.canvas, self.scene, self.picker, at)

    def _open_menu(self, place: QPointF, on_screen: QPoint) -> None:
        """What can be done with what lies under the mouse."""
        from kindyna_gui.touch_targets import open_menu

        if not self.shows_sheet and self._host is not None:
            open_menu(self._thing_at(complex(place.x(), place.y())), self, self._host, on_screen)

    def _paint_veil(self, painter: QPainter) -> None:
        """The last machine that fitted is pale while what is typed does not."""
        if self._pale:
            veil = QColor(SCREEN.paper)
            veil.setAlpha(VEIL)
            painter.fillRect(self.rect(), veil)

    def _paint_over(self, painter: QPainter) -> None:
        if self.shows_sheet:
            self.drawing.paint(painter)
            return
        self._paint_veil(painter)
        if self.up_to_date and not self.in_trouble:
            if (ghost := self._ghost_now()) is not None:
                paint_ghost(painter, ghost, self.player.theta, self.canvas.viewportTransform())
            paint_row(self.canvas, painter, self.session.load)
            self.picker.paint(painter)
            if self.held is not None:
                from kindyna_gui.touch_targets import paint_beside

                here = self.canvas.viewportTransform().map(QPointF(self.held.at.real, self.held.at.imag))
                paint_beside(painter, self.held.shown, here, self.canvas.viewport().rect())

    def _ghost_now(self) -> Ghost | None:
        """Of the pinned variant; made when it is first drawn."""
        study = Pins.of(self.session).study
        if study is None:
            self._ghost = None
        elif self._ghost is None or self._ghost.study is not study:
            self._ghost = Ghost(study)
        return self._ghost

    # -- layers -------------------------------------------------------------------------------------------

    def layer_actions(self) -> list[QAction]:
        return [self._actions[name] for name in available_layers(self.session.study)]

    def show_layer(self, name: str, shown: bool) -> None:
        """Show or hide one of ``EVERY_LAYER``."""
        self._layers_wanted[name] = shown
        self.wake()

    def _take_layers(self) -> None:
        for name, shown in self._layers_wanted.items():
            if self.scene.layer_selected(name) != shown:
                self.scene.set_layer(name, shown)
                if name in FORCE_LAYERS:
                    self._show_missing_cam(self.session.study)
                if self.canvas.fitted and name in (*CHAINS, DIMENSIONS):  # they need room beside or above the mechanism
                    self.canvas.fit(keep_labels=True)

    # -- as a file ----------------------------------------------------------------------------------------

    def settle(self) -> None:
        """Do now what waits until all is at rest."""
        if self.canvas.rest.isActive():
            self.canvas.rest.stop()
            self.scene.lay_labels()

    def picture(self, ending: str) -> bytes:
        """What is visible, in the size it has on the screen; a PNG has twice the dots."""
        from kindyna_gui.pictures.painter import ENLARGED, RATIO, MechanismSheet, png, svg

        self.pull()
        vector = ending == ".svg"
        canvas = self.all_canvas if self.draws_all else self.canvas
        look = None if canvas.fitted else (canvas.visible, canvas.scale_now)
        size = canvas.viewport().width(), canvas.viewport().height()
        theme = LIGHT if vector else replace(LIGHT, ratio=RATIO)
        if self.draws_all:
            shaft, name = self.session.shaft, self.session.full_design.name
            drives = Assembly(theme)
            drives.show_shaft(shaft, self.session.chosen, self._arrangement == ON_SHAFT, self._layers_drawn)
            drives.set_machine(self.player.machine)
            return (
                svg(MechanismSheet(drives, *size, look), name) if vector else png(MechanismSheet(drives, *size, look))
            )
        scene = MechanismScene(None, theme, ENLARGED if vector else 1.0)
        for name, shown in self._layers_wanted.items():
            scene.set_layer(name, shown)
        with postponing(self.session.pending.later):
            scene.update_study(self.session.study)
        scene.set_angle(self.player.theta)
        sheet = MechanismSheet(scene, *size, look)
        return svg(sheet, self.session.design.name) if vector else png(sheet)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if self._type(event) or (self._drives is not None and self._drives.key(event)):
            return
        if self.picker.active and event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.picker.leave()
        elif event.key() == Qt.Key.Key_F and not event.modifiers():
            self.fit()
        elif not obey(self.player, event):
            super().keyPressEvent(event)


__all__ = ["Canvas", "MechanismView"]
