"""The mechanism to scale, as it moves: current drive or all drives, layers, underlay, linkages being drawn, images."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication, QEvent, QPointF, Signal
from PySide6.QtGui import QAction, QActionGroup, QColor, QPainter
from PySide6.QtWidgets import QStackedWidget, QVBoxLayout, QWidget

from core.design import turns_on
from core.design.fields import in_sentence
from core.errors import KindynaError, NoSolution
from core.numerics.lazy import postponing
from core.study import Study
from kindyna_gui.documents.pins import Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import misfit_sentences
from kindyna_gui.drives import ON_SHAFT, ONE, DriveStrip, drive_rows
from kindyna_gui.labels import reason
from kindyna_gui.linkage.canvas import Canvas, PinnedOutline, paint_pinned
from kindyna_gui.linkage.mechanism_mouse import MechanismMouseView
from kindyna_gui.look import Note, linked
from kindyna_gui.pictures.drawing.assembly import DRIVE_LAYERS, SELECTED_LAYERS, Assembly
from kindyna_gui.pictures.drawing.geometry import OutlinedDrive
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.drawing.parts import (
    BODY_FORCE_LAYERS,
    COLOUR_LAYERS,
    DIMENSIONS,
    EVERY_LAYER,
    FORCE_LAYERS,
    MODULO,
    OUTLINE_LAYER,
    STEP_LAYERS,
    TWIST,
    available_layers,
    has_advance,
)
from kindyna_gui.pictures.style import LIGHT, SCREEN
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import connect_all
from kindyna_gui.requirements import ONLY_LINKAGES, why_no_forces, why_no_pressure
from kindyna_gui.view import ViewHost

if TYPE_CHECKING:  # imported when first used
    from kindyna_gui.drawing_overlay import DrawingOverlay
    from kindyna_gui.linkage.drawing_mode import DrawingMode
    from kindyna_gui.linkage.point_paths import PointPaths
    from kindyna_gui.linkage.underlay import UnderlayDesk

UNDERLAY = ".underlay.toml"  # ending of the file next to the design's file
VEIL = 165  # opacity of the veil over a stale drawing, of 255


class MechanismView(MechanismMouseView):
    """The drawing in the middle of the window: the current drive, or all drives of the shaft.

    drawing_switched  (on): drawing with the mouse has started or ended
    """

    drawing_switched = Signal(bool)

    is_design_wide = True

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.note = Note()
        self.strip = DriveStrip()
        self._drawing: DrawingMode | None = None
        self._paths: PointPaths | None = None
        self._underlay: UnderlayDesk | None = None
        self._sheet: DrawingOverlay | None = None
        self._is_blank = False  # below the sheet: the mechanism has no position
        self.assembly = Assembly()
        self.all_canvas = Canvas(self.assembly)
        self._arrangement = ONE
        self._layers_drawn: tuple[str, ...] = ()
        self._pages = QStackedWidget()
        self._pages.addWidget(self.canvas)
        self._pages.addWidget(self.all_canvas)
        self.set_column(self.strip, self._pages, self.note, grows=self._pages)
        self.setFocusProxy(self.canvas)
        self._needs_fit = True
        self._layer_states = {name: layer.shown for name, layer in EVERY_LAYER.items()}
        self._actions = {name: self._action(name, layer.label) for name, layer in EVERY_LAYER.items()}
        colours = QActionGroup(self)
        colours.setExclusionPolicy(QActionGroup.ExclusionPolicy.ExclusiveOptional)
        for name in COLOUR_LAYERS:
            colours.addAction(self._actions[name])
        connect_all(
            (session.started, self._request_fit),
            (session.drive_chosen, self._request_fit),
            (session.step_changed, self._show_step),
            (session.full_design_changed, self._update_strip),
            (session.incomplete_changed, self.invalidate),
            (session.file_changed, self._load_underlay),
            (self.strip.chosen, self._choose_drive),
            (self.strip.arranged, self.arrange),
            (self.all_canvas.clicked, self._click_drive),
        )
        self._update_strip()
        self._load_underlay()
        self._pinned: PinnedOutline | None = None
        Pins.of(session).changed.connect(self.canvas.viewport().update)
        self.canvas.over, self.all_canvas.over = self._paint_over, self._paint_veil

    def belong_to(self, window: ViewHost) -> None:
        super().belong_to(window)
        self.note.linkActivated.connect(window.do)

    def _action(self, name: str, label: str) -> QAction:
        action = QAction(label, self, checkable=True, checked=self._layer_states[name])
        action.setObjectName(f"layer:{name}")
        action.setStatusTip(f"Show or hide in the drawing: {in_sentence(label)}")
        action.toggled.connect(partial(self.show_layer, name))
        return action

    # -- underlay ---------------------------------------------------------------------------------------------

    @property
    def underlay(self) -> UnderlayDesk:
        """The underlay, created when first used."""
        if self._underlay is None:
            from kindyna_gui.linkage.underlay import UnderlayDesk

            self._underlay = UnderlayDesk(self.canvas, self.session, self)
            self._underlay.message.connect(self.status_message)
        return self._underlay

    def _load_underlay(self) -> None:
        """Load the underlay that is saved next to the design's file."""
        path = self.session.path
        if self._underlay is not None:
            self._underlay.follow_file()
        elif path is not None and path.with_suffix(UNDERLAY).exists():
            self.underlay.follow_file()

    def place_underlay(self) -> None:
        """Open the panel that places the image under the drawing."""
        self.show_drive_alone()
        self.underlay.show_panel()

    # -- drawing a linkage ------------------------------------------------------------------------------------

    @property
    def drawing(self) -> DrawingMode:
        """The drawing mode, created when first used."""
        if self._drawing is None:
            from kindyna_gui.linkage.drawing_mode import DrawingMode

            self._drawing = DrawingMode(self.canvas, self.session, self.player, self.paths, self)
            column = self.content.layout()
            assert isinstance(column, QVBoxLayout)
            column.insertWidget(0, self._drawing.bar)
            self._drawing.switched.connect(self._switch_drawing)
            self._drawing.switched.connect(self.drawing_switched)
            self._drawing.message.connect(self.status_message)
        return self._drawing

    @property
    def paths(self) -> PointPaths:
        """The points of a linkage that show their paths, created when first used."""
        if self._paths is None:
            from kindyna_gui.linkage.point_paths import PointPaths

            self._paths = PointPaths(self.session)
            self._paths.changed.connect(self._show_paths)
        return self._paths

    @property
    def draws(self) -> bool:
        """Whether a linkage is being drawn with the mouse."""
        return self._drawing is not None and self._drawing.active

    def _has_to_show_layout(self) -> bool:
        typed = self.session.typed.drive
        if self.draws or not typed.links or typed.linkage.drawn is None:
            return self.draws
        is_refused = self.session.incomplete is not None and typed.linkage != self.session.design.drive.mechanism
        return is_refused or self.session.is_incomplete_linkage

    def draw(self, on: bool, tool: str = "choose") -> bool:
        """Start or end drawing with the mouse; False if the design is no linkage."""
        if not on:
            if self.draws:
                self.drawing.stop()
        elif not self.session.typed.drive.links:
            self.status_message.emit(ONLY_LINKAGES)
            return False
        else:
            self.leave_sheet()
            self.show_drive_alone()
            self.picker.end("drawing has started")
            self.drawing.start(tool)
        return True

    # -- a sheet over the drawing -------------------------------------------------------------------------

    def cover(self, sheet: DrawingOverlay, above: QWidget, below: QWidget) -> None:
        """Lay a sheet over the drawing, which is faint and at rest below it; with a bar above it and a strip below."""
        self.leave_sheet()
        self.draw(False)
        self.picker.end("a sheet has been laid over the drawing")
        self.player.play(False)
        self.show_drive_alone()
        column = self.content.layout()
        assert isinstance(column, QVBoxLayout)
        if column.indexOf(above) < 0:
            column.insertWidget(0, above)
            column.addWidget(below)
        self._sheet, self._sheet_parts = sheet, (above, below)
        for part in self._sheet_parts:
            part.show()
        sheet.start(self.canvas)
        self.invalidate()
        self.pull()

    def uncover(self, sheet: DrawingOverlay) -> None:
        """Remove a sheet; the running machine is shown again."""
        if sheet is not self._sheet:
            return
        sheet.stop()
        for part in self._sheet_parts:
            part.hide()
        self._sheet, self._needs_fit = None, True
        self.invalidate()
        self.pull()

    def leave_sheet(self) -> None:
        """Let the sheet over the drawing be removed: the drawing is needed for something else."""
        if self._sheet is not None:
            self._sheet.leave()

    def _draw_behind(self, study: Study) -> None:
        """Draw the mechanism below the sheet; where it has no position there is nothing."""
        self._is_blank = False
        try:
            self._draw(study)
        except KindynaError:
            self._is_blank = True
        if self.canvas.fitted and self._sheet is not None:
            self._sheet.fit()
        self.canvas.viewport().update()

    def joints(self) -> dict[str, complex]:
        """Names of the joints of the mechanism as drawn, and their present positions [mm]."""
        geometry = self.scene.geometry
        if geometry is None or self._is_blank:
            return {}
        return {joint.name: complex(joint.track[self.scene.index]) for joint in geometry.joints}

    def _paint_sheet(self, painter: QPainter, sheet: DrawingOverlay) -> None:
        veil = QColor(SCREEN.paper)
        veil.setAlpha(255 if self._is_blank else VEIL)
        painter.fillRect(self.canvas.viewport().rect(), veil)
        self.canvas.paint_under(painter)
        sheet.paint(painter)

    def _switch_drawing(self, on: bool) -> None:
        self._needs_fit = self._needs_fit or not on
        self.invalidate()
        self.pull()

    @property
    def stages(self) -> tuple[str, ...]:  # type: ignore[override]
        """Stages that are drawn; forces and the twist of the shaft are computed only if their layers are shown."""
        if self.shows_layout or self._sheet is not None:
            return ()
        forces = ("dynamics",) if any(self._layer_states[name] for name in FORCE_LAYERS) else ()
        return ("linkage", "cam", *forces, *(("stability",) if self._layer_states[TWIST] else ()))

    # -- drives -------------------------------------------------------------------------------------------

    def _update_strip(self) -> None:
        """Show the names of the drives in the strip, if there are several."""
        self.strip.setVisible(self.session.has_several_drives)
        if self.session.has_several_drives:
            self.strip.show_drives(drive_rows(self.session), self.session.chosen)

    def update_style(self) -> None:
        """Apply a change of theme or font."""
        self._update_strip()

    def _choose_drive(self, number: int) -> None:
        if not self.session.choose_drive(number):
            self._update_strip()

    @property
    def draws_all(self) -> bool:
        """Whether all drives are drawn, not only the current one."""
        return not self.strip.isHidden() and self._arrangement != ONE

    def arrange(self, name: str) -> None:
        """Draw the current drive, or all, in one of ``ARRANGEMENTS``."""
        if name != self._arrangement:
            self._arrangement, self._needs_fit = name, True
            self.invalidate()

    def show_drive_alone(self) -> None:
        self.strip.arrangements[ONE].setChecked(True)
        self.arrange(ONE)

    def _click_drive(self, position: complex) -> None:
        number = self.assembly.number_at(QPointF(position.real, position.imag))
        if number is not None:
            self._choose_drive(number)

    @property
    def _all_drive_layers(self) -> tuple[str, ...]:
        """Layers that are shown while all drives are drawn."""
        return tuple(name for name in (*DRIVE_LAYERS, *SELECTED_LAYERS, *OUTLINE_LAYER) if self._layer_states[name])

    def _show_all(self) -> None:
        self._pages.setCurrentWidget(self.all_canvas)
        if self._drives is None:
            from kindyna_gui.linkage.drives_mouse import DrivesMouse

            self._drives = DrivesMouse(self, self.all_canvas, self.assembly, self.session, self.player)
            self._drives.drag_changed = self._escape.setEnabled
        self._layers_drawn = self._all_drive_layers
        self.assembly.show_shaft(
            self.session.shaft, self.session.chosen, self._arrangement == ON_SHAFT, self._layers_drawn
        )
        missing = self.assembly.missing
        self.note.show_message(
            f"Not drawn: {', '.join(missing)}" if missing else self._missing_text(self.session.study)
        )
        self._fit_or_keep(self.all_canvas)

    # -- refresh and follow -------------------------------------------------------------------------------

    def refresh(self, study: Study) -> None:
        session = self.session
        self.is_stale = session.incomplete is not None and (self.draws_all or session.typed != session.design)
        if self.draws:
            self.drawing.refresh()
        self._layout_shown = self._has_to_show_layout()
        if self.draws_all:
            self._show_all()
            return
        self._pages.setCurrentWidget(self.canvas)
        if self._sheet is not None:
            self._draw_behind(study)
        elif self.shows_layout:
            self._show_layout()
        else:
            self._draw(study)

    def _draw(self, study: Study) -> None:
        """Draw the mechanism in the current turn."""
        self._apply_layers()
        self._update_readout()
        self._update_note(study)
        self.scene.show_step(
            self.session.step if set(STEP_LAYERS) <= set(available_layers(study)) else None, draw=False
        )
        self._show_paths()
        self.scene.outlined = self._outlined_drive()
        self.scene.update_study(self._in_turn(study), keep_labels=True, lay=not self._needs_fit)
        self.canvas.rest.start()
        self._fit_or_keep(self.canvas)

    def _outlined_drive(self) -> OutlinedDrive | None:
        """The selected drive among the outlines of all drives; None where there are none, or a drive has no solution."""
        session, last = self.session, self.scene.outlined
        if not session.has_several_drives or not session.full_design.outlines or session.is_on_balancer:
            return None
        if session.shaft.failures:
            return None
        shown = OutlinedDrive(session.full_study.clearances, session.chosen, session.shaft_position)
        return last if last is not None and last.is_like(shown) else shown

    def _show_paths(self) -> None:
        """Show the paths of the points that trace one, or that the user has chosen."""
        drive = self.session.design.drive
        is_drawn = bool(drive.links) and (self._paths is not None or drive.linkage.drawn is not None)
        self.scene.show_paths(self.paths.shown(drive.linkage) if is_drawn else ())

    def _fit_or_keep(self, canvas: Canvas) -> None:
        if self._needs_fit:
            canvas.fit()
            self._needs_fit = False
        else:
            canvas.show_again()

    def _show_layout(self) -> None:
        """Show the linkage as drawn, also if it is incomplete."""
        self.note.show_message(self._underlay_note if self.draws else self._fault_of_layout())
        if self._needs_fit:
            self._needs_fit = False
            self.drawing.fit()
        self.canvas.viewport().update()

    def _fault_of_layout(self) -> str:
        """What the drawing lacks to be a mechanism, or, where it is one, the value that does not fit."""
        if self.drawing.mobility.is_finished and (sentences := misfit_sentences(self.session)):
            return sentences[0]
        return self.drawing.state_text()

    @property
    def _turn(self) -> int:
        """Number of the turn that is drawn; 0 if all turns are equal, or the layer shows the first."""
        return self.player.turn if has_advance(self.session.study) and not self._layer_states[MODULO] else 0

    def _in_turn(self, study: Study) -> Study:
        """Study of the design in the current turn; if it has no solution, the first turn, with a note."""
        self.scene.turn = self._turn
        study_in_turn = study.with_design(turns_on(study.design, self._turn)) if self._turn else study
        try:
            _ = study_in_turn.linkage
        except KindynaError as error:
            if study_in_turn is study:
                raise
            self.note.show_message(
                f"Showing the first turn. In the current turn: {reason(study_in_turn.design, error)}"
            )
            return study
        return study_in_turn

    def _update_note(self, study: Study) -> None:
        """Show a note on what cannot be drawn."""
        self.note.show_message(linked(self._missing_text(study)))

    def _missing_text(self, study: Study) -> str:
        """Reason why the drawing is stale, or why cam, pressure, forces or underlay are not drawn; else empty."""
        if self.is_stale:
            version = "version" if self.session.waits_for.reasons else "version that can be assembled"
            return f"Showing the last {version}. {misfit_sentences(self.session)[0]}"
        text = ""
        try:
            _ = study.cam if "cam" in study.stages else None
            text = why_no_pressure(study) if self._layer_states["stress_colours"] and study.has_disk else ""
        except NoSolution as error:
            text = f"No cam: {reason(study.design, error)}"
        if not text and any(self._layer_states[name] for name in BODY_FORCE_LAYERS):
            try:
                text = why_no_forces(study)
            except NoSolution as error:
                text = f"No forces: {reason(study.design, error)}"
        return text or self._underlay_note

    @property
    def _underlay_note(self) -> str:
        """Text that says why the underlay is not shown."""
        return self._underlay.missing if self._underlay is not None else ""

    def follow(self, theta: float) -> None:
        if self.draws_all:
            if self._all_drive_layers != self._layers_drawn:
                self._show_all()
            self.assembly.set_machine(self.player.machine)
            return
        if self._sheet is not None and self._is_blank:
            return
        if self.shows_layout:
            self.drawing.refresh()
            return
        if self.scene.turn != self._turn:
            self._needs_fit = self._needs_fit or self.canvas.fitted  # the mechanism leaves the visible region
            self._draw(self.session.study)
        self._apply_layers()
        self.scene.set_angle(theta)
        # draws the scene now: otherwise a repaint triggered by a plot draws it first, and then it is drawn again
        QCoreApplication.sendPostedEvents(self.scene, QEvent.Type.MetaCall)

    def fit(self) -> None:
        if self._sheet is not None and not self.draws_all:
            self._sheet.fit()
            return
        if self.shows_layout and not self.draws_all:
            self.drawing.fit()
            return
        if self.up_to_date and not self.in_trouble:
            (self.all_canvas if self.draws_all else self.canvas).fit()
        else:
            self._needs_fit = True

    def fit_centres(self) -> None:
        """Show the instant centres, and zoom so that they are visible."""
        self.show_drive_alone()
        self._actions["centres"].setChecked(True)
        self.pull()
        if not self.in_trouble:
            visible, scale = self.scene.fit_centres(self.canvas.viewport().width(), self.canvas.viewport().height())
            self.canvas.show_region(visible.center(), scale, keep_labels=True)
            self.canvas.fitted = False

    def _request_fit(self) -> None:
        self._needs_fit = not self.draws_all or self._needs_fit

    def _show_step(self) -> None:
        if self.up_to_date and not self.in_trouble:
            self.scene.show_step(self.session.step)

    # -- painting -----------------------------------------------------------------------------------------

    def _paint_veil(self, painter: QPainter) -> None:
        """Paint a veil over a stale drawing."""
        if self.is_stale:
            veil = QColor(SCREEN.paper)
            veil.setAlpha(VEIL)
            painter.fillRect(self.rect(), veil)

    def _paint_over(self, painter: QPainter) -> None:
        if self._sheet is not None:
            self._paint_sheet(painter, self._sheet)
            return
        if self.shows_layout:
            self.drawing.paint(painter)
            return
        self._paint_veil(painter)
        if self.up_to_date and not self.in_trouble:
            if (pinned := self._pinned_outline()) is not None:
                paint_pinned(painter, pinned, self.player.theta, self.canvas.viewportTransform())
            self._paint_mouse(painter)

    def _pinned_outline(self) -> PinnedOutline | None:
        """Outline of the pinned variant, created when first drawn."""
        study = Pins.of(self.session).study
        if study is None:
            self._pinned = None
        elif self._pinned is None or self._pinned.study is not study:
            self._pinned = PinnedOutline(study)
        return self._pinned

    # -- layers -------------------------------------------------------------------------------------------

    def layer_actions(self) -> list[QAction]:
        """Return the actions that show or hide the layers of the current design."""
        names = available_layers(self.session.study)
        of_machine = OUTLINE_LAYER if self.session.has_several_drives and self.session.full_design.outlines else ()
        return [self._actions[name] for name in (*of_machine, *names)]

    def show_layer(self, name: str, shown: bool) -> None:
        """Show or hide one of ``EVERY_LAYER``."""
        self._layer_states[name] = shown
        self.wake()

    def _apply_layers(self) -> None:
        for name, shown in self._layer_states.items():
            if self.scene.layer_selected(name) != shown:
                from core.instant_centres import CHAINS  # imported here to save start-up time

                self.scene.set_layer(name, shown)
                if name in FORCE_LAYERS:
                    self._update_note(self.session.study)
                if self.canvas.fitted and name in (*CHAINS, DIMENSIONS):  # these need room around the mechanism
                    self.canvas.fit(keep_labels=True)

    # -- images -------------------------------------------------------------------------------------------

    def settle(self) -> None:
        """Place the labels now, without the delay."""
        if self.canvas.rest.isActive():
            self.canvas.rest.stop()
            self.scene.lay_labels()

    def picture(self, ending: str) -> bytes:
        """Image of the visible region in its size on the screen; a PNG has twice the pixels."""
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
            sheet = MechanismSheet(drives, *size, look)
            return svg(sheet, name) if vector else png(sheet)
        scene = MechanismScene(None, theme, ENLARGED if vector else 1.0)
        for name, shown in self._layer_states.items():
            scene.set_layer(name, shown)
        scene.show_paths(self.scene.paths)
        scene.outlined = self.scene.outlined
        with postponing(self.session.pending.later):
            scene.update_study(self.session.study)
        scene.set_angle(self.player.theta)
        sheet = MechanismSheet(scene, *size, look)
        return svg(sheet, self.session.design.name) if vector else png(sheet)
