"""The main window: menus above, the mechanism in the middle, docks around it.

Builds the parts, connects them to the session and the player, and has the slots that the menus call.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QAction, QCloseEvent, QCursor, QDragEnterEvent, QDropEvent, QPaintEvent, QShowEvent
from PySide6.QtWidgets import QApplication, QLayout, QMainWindow, QMenu, QTabWidget, QWidget

from core.design import Design, drive_at, with_only
from core.errors import KindynaError
from core.findings import Remedy
from core.process import keep_freed_memory, resources
from core.project import load, load_drawing
from kindyna_gui import dialogs
from kindyna_gui import settings as preferences
from kindyna_gui.background import Background, PendingResult
from kindyna_gui.documents.edits import Refusal
from kindyna_gui.documents.pins import Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.export import Exports
from kindyna_gui.files.file_actions import DiskButton, Documents, FileWatch, dropped_design
from kindyna_gui.files.recovery import Recovery, write_before_the_end
from kindyna_gui.look import apply_preferences
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.places import default_design, example
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import call_soon, connect_all, is_in_sight, scroll_to
from kindyna_gui.requirements import UNKNOWN_PREFERENCES
from kindyna_gui.settings import Settings
from kindyna_gui.view import ExplainableNumber, View
from kindyna_gui.window import menus
from kindyna_gui.window.actions import DesignActions
from kindyna_gui.window.base import CentralPages, Titles, Window
from kindyna_gui.window.docks import CENTRE, VIEWS, Dock
from kindyna_gui.window.faults import Faults
from kindyna_gui.window.layouts import Layouts
from kindyna_gui.window.status_line import StatusLine
from kindyna_gui.window.tabs import WindowTabs
from kindyna_gui.window.tasks import TASKS, TaskLayers

if TYPE_CHECKING:
    from kindyna_gui.help import HelpWindow
    from kindyna_gui.papers import FiguresWindow
    from kindyna_gui.window.finder import Finder
    from kindyna_gui.window.linkage_menus import LoadActions
    from kindyna_gui.window.welcome import Welcome

LARGEST = QSize(1920, 1080)  # first size on a larger screen, which leaves room for other programs
_FRAME = 40  # height of the desktop's frame around the window [pixels]


def first_size(room: QSize) -> QSize:
    """Return the first size of the window on a screen with this room."""
    return QSize(room.width(), room.height() - _FRAME).boundedTo(LARGEST)


class MainWindow(Window):
    """The window of one session and one player, which it owns.

    Signal ``furnished``: the drawing is on the screen and the docks are open.
    """

    furnished = Signal()

    def __init__(self, session: Session, player: Player, settings: Settings) -> None:
        super().__init__()
        self.session, self.player, self.settings = session, player, settings
        for owned in (session, player):
            owned.setParent(self)  # else their connections would keep the window alive
        session.full_design_changed.connect(self._place_drive)
        session.design_changed.connect(self._design_changed)  # before the views, which read the player's angle
        self._design_changed()
        self.documents = Documents(session, settings, self)
        self.recovery = Recovery(session, self.documents, self)
        self.exports = Exports(session, player, self)
        self.designing = DesignActions(self)
        self._painted = self._begun = False
        self._seen_tasks: set[str] = set()
        self._help: HelpWindow | None = None
        self._finder: Finder | None = None
        self._papers: FiguresWindow | None = None
        self.welcome: Welcome | None = None
        self.setAcceptDrops(True)
        self.setDockOptions(
            QMainWindow.DockOption.AllowTabbedDocks
            | QMainWindow.DockOption.AllowNestedDocks
            | QMainWindow.DockOption.GroupedDragging
        )
        layout = self.layout()
        assert layout is not None, "a main window has one"
        layout.setSizeConstraint(QLayout.SizeConstraint.SetNoConstraint)  # the window never grows by what it shows
        self.setTabPosition(Qt.DockWidgetArea.AllDockWidgetAreas, QTabWidget.TabPosition.North)
        self.setCorner(Qt.Corner.TopLeftCorner, Qt.DockWidgetArea.LeftDockWidgetArea)
        self.setCorner(Qt.Corner.TopRightCorner, Qt.DockWidgetArea.RightDockWidgetArea)
        self.setCorner(Qt.Corner.BottomLeftCorner, Qt.DockWidgetArea.LeftDockWidgetArea)
        self.setCorner(Qt.Corner.BottomRightCorner, Qt.DockWidgetArea.RightDockWidgetArea)
        self.actions_by_key: dict[str, QAction] = {}
        self.centre = CentralPages(session, player, self._make)
        self.bar = self.centre.bar
        self.setCentralWidget(self.centre)
        self.actions_by_key = menus.build(self)
        self.centre.begin()
        self.docks = {
            name: Dock(name, row, partial(self._make, name), self) for name, row in VIEWS.items() if row.area != CENTRE
        }
        self.addToolBar(menus.build_toolbar(self, self.actions_by_key))
        self.addToolBar(menus.build_tasks(self, self.actions_by_key))
        self.status = StatusLine(
            session,
            player,
            lambda: self.show_view("findings"),
            lambda: self.show_view("log"),
            lambda path, *_: self.focus_field(path),
            self.do,
        )
        self.setStatusBar(self.status)
        self.watch = FileWatch(session, self)
        self.disk = DiskButton(self.watch, self.documents)
        self.status.insertPermanentWidget(0, self.disk)
        self.titles = Titles(self)
        self.resize(first_size(self.screen().availableGeometry().size()))
        self.tabs = WindowTabs(self)
        self.layouts = Layouts(self)
        self.task_layers = TaskLayers(self)
        self.layouts.changed.connect(self._task_changed)
        self.layouts.begin()
        self._connect()
        self.faults = Faults(self)

    @cached_property
    def loads(self) -> LoadActions:
        """Edits of the loads' rows; imported at the first use."""
        from kindyna_gui.window.linkage_menus import LoadActions

        return LoadActions(self)

    def _make(self, name: str) -> View:
        view = VIEWS[name].make(self.session, self.player)
        view.setProperty(dialogs.HELP, VIEWS[name].help)
        view.belong_to(self)
        if hasattr(view, "show_section"):
            view.show_section(TASKS[self.layouts.current].section)
        if name == "mechanism":
            view.drawing_switched.connect(self._drawing_switched)  # type: ignore[attr-defined]
        menus.add_view_keys(view, name, self.actions_by_key)
        return view

    def _connect(self) -> None:
        session, player = self.session, self.player
        session.stages_on_screen = self.stages_on_screen
        connect_all(
            (session.started, partial(setattr, self, "_begun", True)),
            (session.drive_chosen, partial(setattr, self, "_begun", True)),
            (session.full_design_changed, self._follow_new_design),
            (session.file_changed, self._follow_new_design),
            (session.stack.indexChanged, self._steps_changed),
            (session.stack.cleanChanged, self._steps_changed),
            (session.refused, self._show_refusal),
            (session.vary_requested, self.vary),
            (self.documents.status_message, self.status.show_message),
            (self.exports.status_message, self.status.show_message),
            (self.disk.status_message, self.status.show_message),
            (self.recovery.status_message, self.status.show_message),
            (self.designing.status_message, self.status.show_message),
        )
        self.exports.layers, self.exports.view = self._layers, self.view
        connect_all(
            (QApplication.styleHints().colorSchemeChanged, self._desktop_changed),
            (player.playing_changed, self.actions_by_key["play"].setChecked),
            (player.forward_changed, lambda forward: self.actions_by_key["reverse"].setChecked(not forward)),
            (self.centre.tabs.currentChanged, lambda _: self.status.recount()),
        )
        for dock in self.docks.values():
            dock.pause(True)
            dock.seen.connect(self._docks_moved)
            dock.topLevelChanged.connect(self._docks_moved)
            dock.dockLocationChanged.connect(self._docks_moved)

    # -- views --------------------------------------------------------------------------------------------

    def show_view(self, name: str) -> View:
        """Bring a view to the front and return it."""
        if VIEWS[name].area == CENTRE:
            return self.centre.show_page(name)
        dock = self.docks[name]
        if dock.isHidden() and (task := VIEWS[name].task) and task != self.layouts.current:
            self.show_task(task)
        self.layouts.open(dock)
        dock.raise_()
        view = dock.build()
        view.wake()
        return view

    def explain(self, number: ExplainableNumber) -> None:
        """Explain a number, at its own angle or else at the current angle."""
        view: Any = self.show_view("explain")
        view.explain(number)

    def show_result(self, result: str) -> None:
        """Bring the curve of a result to the front."""
        from kindyna_gui.window.result_plots import show_result  # only where two variants are compared

        show_result(self, result)

    def explain_here(self) -> None:
        """Explain the number selected in the view with the focus; else show the last explanation."""
        view = self._view_in_focus()
        number = None if view is None else view.selected_number()
        if number is None:
            self.show_view("explain")
        else:
            self.explain(number)

    def _view_in_focus(self) -> View | None:
        focus = QApplication.focusWidget()
        return next((view for view in self._views() if focus is not None and view.isAncestorOf(focus)), None)

    def copy_picture(self) -> None:
        """Copy the view with the focus, else the page in the middle, to the clipboard."""
        if (view := self._view_in_focus() or self.centre.current) is not None:
            from kindyna_gui.saving import copy_picture

            copy_picture(view)

    def pin(self, design: Design | None = None) -> None:
        """Pin a design, by default the current one: later changes are compared with it."""
        row = Pins.of(self.session).pin(self.session.full_design if design is None else design)
        self.show_message(f"Pinned as {row.name}; plots show it dashed, the drawing in grey")

    def pin_before(self) -> None:
        """Compare the design with the one before the last step."""
        design = self.session.before
        if design is None:
            self.show_message("The design has not been changed yet")
            return
        if self.session.has_several_drives:
            design = with_only(self.session.full_design, self.session.chosen, design)
        row = Pins.of(self.session).pin(design, f"before: {self.session.stack.undoText()}")
        self.show_message(f"Pinned {row.name}; plots show it dashed, the drawing in grey")

    def pin_file(self) -> None:
        """Compare the design with another file."""
        path = dialogs.design_to_open(self, self.settings.folder)
        if path is None:
            return
        try:
            design = load(path)
        except KindynaError as error:
            dialogs.show_faults(self, f"{path.name} cannot be pinned.", [str(error)])
            return
        Pins.of(self.session).pin(design, path.stem)
        self.show_message(f"Pinned {path.name}; plots show it dashed, the drawing in grey")

    def unpin(self) -> None:
        """Stop comparing with the pinned variant."""
        Pins.of(self.session).unpin()

    def show_polygon(self, kind: str) -> None:
        """Show the polygon of velocities, or of the forces on a body."""
        view: Any = self.show_view("polygon")
        view.choose(kind)

    def show_search(self, what: str) -> None:
        """Show Find, set to calculate this quantity if the design has it."""
        view: Any = self.show_view("find")
        view.search_for(what)

    def vary(self, path: str) -> None:
        """Vary a value in Study; if that view is not visible, change to its task."""
        view: Any = self.docks["study"].build()
        view.vary(path)
        if not view.on_screen():
            self.show_task("study")
            self.show_view("study")

    def open_design(self, path: Path) -> bool:
        """Open a design, an example without its file; False if the current design stays."""
        before = self.session.document
        if path.is_relative_to(resources()):
            self.documents.open_example(path)
        else:
            self.documents.open_path(path)
        return self.session.document != before

    def apply_remedy(self, remedy: Remedy) -> None:
        """Carry out the remedy of a finding: show its field, and calculate its value if Find can."""
        self.focus_field(remedy.field)
        if remedy.masses:
            self.loads.give_masses()
        if remedy.find:
            view: Any = self.show_view("find")
            view.search_for(remedy.find, afresh=True)

    def can(self, entry: str) -> bool:
        """Whether an entry of the menus, or any entry of a submenu, can be chosen for the current design."""
        menu = self._menu_of(entry)
        if menu is None:
            return self.actions_by_key[entry].isEnabled()
        menu.aboutToShow.emit()
        return menu.menuAction().isVisible() and any(
            action.isEnabled() and not action.isChecked() for action in menu.actions()
        )

    def do(self, entry: str) -> None:
        """Trigger an entry of the menus by its key; open a submenu at the mouse."""
        menu = self._menu_of(entry)
        if menu is None:
            self.actions_by_key[entry].trigger()
        else:
            menu.popup(QCursor.pos())

    def _menu_of(self, entry: str) -> QMenu | None:
        menu = self.actions_by_key[entry].menu()
        return menu if isinstance(menu, QMenu) else None

    def show_message(self, text: str) -> None:
        """Show a message in the status line for a while."""
        self.status.show_message(text)

    def ask(self, text: str) -> None:
        """Show in the status line what to do next, until ``answered``."""
        self.status.ask(text)

    def answered(self, how: str) -> None:
        """End a request in the status line that was done or cancelled."""
        self.status.answered(how)

    def add_load(self, name: str) -> None:
        """Add a row of this kind to the loads; points are picked with the mouse."""
        self.loads.add(name)

    def pick_load(self, path: str, key: str) -> None:
        """Pick a new attachment of a load with the mouse."""
        self.loads.pick(path, key)

    def open_load(self, path: str) -> None:
        """Show the form of a row of the loads."""
        self.loads.open(path)

    def _views(self) -> Iterator[View]:
        yield from (dock.view for dock in self.docks.values() if dock.view is not None)
        yield from self.centre.views()

    def stages_on_screen(self) -> tuple[str, ...]:
        """Return the stages that views on screen read, in the order of computation, always with the motion.

        During a drag they are those of its beginning: each move of the mouse reads them.
        """
        session = self.session
        if session.drag_source is not None and session.stages_of_drag is not None:
            return session.stages_of_drag
        needed = {stage for view in self._views() if view.on_screen() for stage in view.stages}
        if needed:
            needed.add("motion")
        session.stages_of_drag = tuple(stage for stage in session.study.stages if stage in needed)
        return session.stages_of_drag

    def focus_field(self, path: str) -> None:
        """Show and focus the field of a path, or the fields of a section; selects the drive that has it."""
        in_drive = drive_at(path)
        if in_drive is not None:
            if not self.session.choose_drive(in_drive[0]):
                return
            path = in_drive[1]
        section = path.partition(".")[0].partition("[")[0]
        editor = self.view("motion")
        has_view = section in ("timing", "drives") or (
            section == "motion" and editor is not None and editor.on_screen()
        )
        section = "clearance" if section in ("outlines", "clearances") else section
        view: Any = self.show_view(section if has_view or section == "clearance" else "parameters")
        if not view.focus_field(path) and section == "motion" and view is not editor:
            view = self.show_view("motion")  # rows of a table, which the inspector does not have
            view.focus_field(path)

    def show_fields(self, section: str) -> None:
        """Show a section of the parameters if they are visible, without moving the focus."""
        parameters: Any = self.view("parameters")
        if parameters is not None and parameters.on_screen():
            parameters.show_section(section)

    def fit(self) -> None:
        """Zoom the page in the middle to all it shows."""
        if self.centre.current is not None:
            self.centre.current.fit()

    def draw(self, on: bool, tool: str = "choose") -> None:
        """Switch drawing with the mouse on or off."""
        view: Any = self.show_view("mechanism")
        self._drawing_switched(view.draw(on, tool) and on)

    def place_underlay(self) -> None:
        """Show the bar that places an image under the drawing."""
        view: Any = self.show_view("mechanism")
        view.place_underlay()

    def _drawing_switched(self, on: bool) -> None:
        self.actions_by_key["draw"].setChecked(on)

    def fit_centres(self) -> None:
        """Zoom the drawing to all instant centres of the linkage."""
        view: Any = self.show_view("mechanism")
        if any(action.objectName() == "layer:centres" for action in view.layer_actions()):
            view.fit_centres()
        else:
            self.show_view("centres")

    def _layers(self) -> dict[str, bool]:
        """Layers of the mechanism drawing, and whether each is shown."""
        view = self.view("mechanism")
        rows = view.layer_actions() if view is not None else []
        return {action.objectName().partition(":")[2]: action.isChecked() for action in rows}

    def add_drive_by_picture(self) -> None:
        """Add a drive chosen from images."""
        from kindyna_gui.window import shafts

        shafts.add_by_picture(self)

    def add_to_shaft(self) -> None:
        """Put the design on a shaft with other drives."""
        from kindyna_gui.window import shafts

        shafts.add_to_shaft(self)

    def export_picture(self, name: str) -> None:
        """Ask for a file and save the picture of a view in it."""
        view = self.view(name)
        if view is not None:
            from kindyna_gui.saving import save_picture

            save_picture(view, name)

    # -- tasks --------------------------------------------------------------------------------------------

    def show_task(self, name: str) -> None:
        """Show one of ``TASKS`` in the layout last used, with the focus in its main view."""
        self.layouts.show(name)
        self.actions_by_key[f"show_task:{name}"].setChecked(True)
        parameters: Any = self.view("parameters")
        if parameters is not None and name not in self._seen_tasks:
            parameters.show_section(TASKS[name].section)
        self._seen_tasks.add(name)
        dock = self.docks.get(TASKS[name].large)
        large = self.view(TASKS[name].large) if dock is None else dock.build()
        if large is not None:
            large.setFocus()

    def _task_changed(self, name: str) -> None:
        self.actions_by_key[f"show_task:{name}"].setChecked(True)
        self.task_layers.show(name)
        self._docks_moved()

    def _follow_new_design(self) -> None:
        """Adapt the layout to a design that has just been opened."""
        if self._begun:
            self._begun = False
            self.layouts.follow_design()

    # -- the design ---------------------------------------------------------------------------------------

    def enable_segment_edits(self, able: dict[str, bool]) -> None:
        """Enable the edits of the selected segment that are possible, by name."""
        for name, can in able.items():
            self.actions_by_key[f"designing.segment:{name}"].setEnabled(can)

    def _design_changed(self) -> None:
        study = self.session.study
        self.player.omega = study.omega
        self._place_drive()
        try:
            self.player.set_ranges(study.turn_ranges)
        except KindynaError:
            self.player.set_ranges(())  # the linkage has no position, which the views show

    def _place_drive(self) -> None:
        """Give the player the phase and rotation sign of the selected drive."""
        place = self.session.shaft_position
        self.player.show_drive(place.phase, place.rotation_sign)

    def _show_refusal(self, refusal: Refusal) -> None:
        self.status.refuse(f"{refusal.reasons[0][1]}: {refusal.reasons[0][2]}")

    def _steps_changed(self, *_: object) -> None:
        self.titles.steps_changed()
        if self.session.drag_source is None:  # else it follows at the end of the drag
            self.titles.name_window()

    def reverse(self, on: bool) -> None:
        """Play backwards."""
        self.player.set_forward(not on)

    # -- help ---------------------------------------------------------------------------------------------

    def find_anything(self) -> None:
        """Open the search line over the window."""
        if self._finder is None:
            from kindyna_gui.window.finder import Finder

            self._finder = Finder(self)
        self._finder.open()

    def prefer(self) -> None:
        """Ask for preferences, save them and apply them."""
        from kindyna_gui.window.preferences_dialog import change_preferences

        change_preferences(self)

    def _desktop_changed(self, scheme: Qt.ColorScheme) -> None:
        """Follow the desktop, which has changed to light or dark."""
        chosen, app = preferences.read(), QApplication.instance()
        if chosen.theme == "system" and isinstance(app, QApplication):
            apply_preferences(chosen, app, scheme)

    def help_here(self) -> None:
        """Show the page of the help on the field, or the view, with the focus."""
        self.show_help(*dialogs.help_on(QApplication.focusWidget() or self))

    def show_help(self, name: str, words: str = "") -> None:
        """Show a page of the help, scrolled to these words."""
        if self._help is None:
            from kindyna_gui.help import HelpWindow

            self._help = HelpWindow(self)
        self._help.open(name, words)

    def show_welcome(self) -> None:
        """Show the welcome page: examples, new design, recent files."""
        if self.welcome is None:
            from kindyna_gui.window.welcome import Welcome

            self.welcome = Welcome(self)
        self.welcome.open()

    def greet(self) -> None:
        """Offer unsaved work of an earlier run; else, if no file was opened, show the welcome page."""
        if not self.recovery.offer() and self.session.path is None and self.settings.welcome:
            self.show_welcome()

    def begin_tutorial(self, name: str) -> None:
        """Begin a tutorial in this window."""
        from kindyna_gui.window.tutorial import begin, read

        begin(self, read(name))

    def show_papers(self) -> None:
        """Show the figures of the papers, compared with values computed here."""
        if self._papers is None:
            from kindyna_gui.papers import FiguresWindow

            self._papers = FiguresWindow(self, lambda name: self.documents.open_example(example(name)))
        self._papers.open()

    def about(self) -> None:
        dialogs.about(self)

    # -- layout -------------------------------------------------------------------------------------------

    def reset_layout(self) -> None:
        """Restore the first layout of the current task."""
        self.layouts.reset()

    def save_layout(self) -> None:
        """Ask for a name and save the current layout under it."""
        name = dialogs.ask_layout_name(self, self.settings.named_layouts)
        if name:
            self.layouts.save_as(name)
            self.status.show_message(f"Saved layout {name} under Named layouts")

    def restore_layout(self, name: str) -> None:
        """Restore a saved layout."""
        try:
            self.layouts.restore(name)
        except ValueError as error:
            self.status.show_message(f"Layout {name} cannot be restored: {error}")

    def delete_layout(self, name: str) -> None:
        """Delete a saved layout."""
        self.settings.forget_layout(name)
        self.status.show_message(f"Deleted layout {name}")

    def _docks_moved(self, *_: object) -> None:
        self.titles.docks_moved()
        self.status.recount()

    # -- events -------------------------------------------------------------------------------------------

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        if not event.spontaneous():
            self.layouts.shown()
        if self.centre.current is not None and not event.spontaneous():
            self.centre.current.pull()

    def focusNextPrevChild(self, onwards: bool) -> bool:
        """Move the focus past docks in hidden tabs and unused tab bars, which Qt keeps outside the window."""
        before, passed = self.focusWidget(), set[QWidget]()
        by_key = before is not None and before.isVisibleTo(self) and before.isEnabled()  # else it has just been hidden
        while super().focusNextPrevChild(onwards):
            focus = self.focusWidget()
            part: QWidget | None = focus
            while part is not None and part.parentWidget() is not self:
                part = part.parentWidget()
            if focus is None or part is None or focus in passed or is_in_sight(part):
                if by_key:
                    scroll_to(focus)
                return True
            passed.add(focus)
        return False

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the mechanism first; the docks are created after that."""
        super().paintEvent(event)
        if not self._painted:
            self._painted = True
            call_soon(self, self._furnish)

    def _furnish(self) -> None:
        for dock in self.docks.values():
            dock.pause(False)
        self.layouts.furnish()
        if strange := preferences.not_understood():
            self.status.show_message(f"{UNKNOWN_PREFERENCES}{', '.join(strange)}")
        self.furnished.emit()

    def closeEvent(self, event: QCloseEvent) -> None:
        if not self.documents.may_leave():
            event.ignore()
            return
        self.player.play(False)
        self.layouts.save()
        for view in self.findChildren(View):
            view.leave()
        self.status.leave()
        for pending in self.session.findChildren(PendingResult):
            pending.close()
        for work in self.findChildren(Background):  # of pages and dialogs that are still open
            work.close()
        if self._papers is not None:
            self._papers.leave()
        self.recovery.close()
        event.accept()

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        if dropped_design(event) is not None:
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        path = dropped_design(event)
        if path is not None:
            event.acceptProposedAction()
            self.documents.open_path(path)


def open_window(app: QApplication, path: Path | None = None) -> MainWindow:
    """Return a window with a design, paused at cam angle 0, not shown yet.

    Without a path, or with the path of the default design, it has that example, which must be saved under another name.
    Raises DesignError, FileError.
    """
    keep_freed_memory()
    file = None if path is None or path == default_design() else path
    session = Session(load_drawing(file or default_design()), file)
    apply_preferences(preferences.read(), app)
    app.setApplicationName("KINDYNA")
    app.setDesktopFileName("kindyna")
    settings = Settings()
    if file is not None:
        settings.add_recent(file)
    window = MainWindow(session, Player(), settings)
    window.recovery.begin()
    return window


def run(path: Path | None = None) -> int:
    """Open the window, with a file if a path is given; return the exit code once it is closed.

    Raises DesignError, FileError if the file cannot be read.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl+C ends the program without a traceback
    app = ensure_app()
    window = open_window(app, path)
    write_before_the_end(app, window.recovery)
    window.furnished.connect(window.greet, Qt.ConnectionType.QueuedConnection)
    window.show()
    return QApplication.exec()


__all__ = ["MainWindow", "open_window", "run"]
