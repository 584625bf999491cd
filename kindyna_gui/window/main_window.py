"""The window: menus above, the mechanism in the middle, docks around it."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QAction, QCloseEvent, QCursor, QDragEnterEvent, QDropEvent, QPaintEvent, QShowEvent
from PySide6.QtWidgets import QApplication, QMainWindow, QMenu, QTabWidget, QWidget

from core.design import Design, drive_at, with_only
from core.errors import KindynaError
from core.findings import Remedy
from core.process import keep_freed_memory, resources
from core.project import load, load_drawing
from kindyna_gui import dialogs
from kindyna_gui import settings as preferences
from kindyna_gui.documents.edits import Refusal
from kindyna_gui.documents.pins import Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.export import Exports
from kindyna_gui.files.file_actions import DiskButton, Documents, FileWatch, dropped_design
from kindyna_gui.files.recovery import Recovery, write_before_the_end
from kindyna_gui.look import wear
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.places import default_design, example
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import soon
from kindyna_gui.requirements import STRANGE
from kindyna_gui.saving import copy_picture, save_picture
from kindyna_gui.settings import Settings
from kindyna_gui.view import ExplainableNumber, View, is_in_sight, scroll_to
from kindyna_gui.window import menus
from kindyna_gui.window.actions import DesignActions
from kindyna_gui.window.base import CentralPages, Titles, Window
from kindyna_gui.window.docks import CENTRE, VIEWS, Dock, DockShares
from kindyna_gui.window.faults import Faults
from kindyna_gui.window.layouts import Layouts
from kindyna_gui.window.status_line import StatusLine
from kindyna_gui.window.tasks import TASKS, TaskLayers

if TYPE_CHECKING:
    from kindyna_gui.help import HelpWindow
    from kindyna_gui.papers import FiguresWindow
    from kindyna_gui.window.finder import Finder
    from kindyna_gui.window.linkage_menus import LoadActions
    from kindyna_gui.window.welcome import Welcome

LARGEST = QSize(1920, 1080)  # at first; on a larger screen a user may want to see something else too
_FRAME = 40  # pixels a desktop takes for the window's own frame


def first_size(room: QSize) -> QSize:
    """The size of a window that nobody has sized yet, on a screen with this room."""
    return QSize(room.width(), room.height() - _FRAME).boundedTo(LARGEST)


class MainWindow(Window):
    """The window over one session and one player, which end with it.

    furnished   the first picture is on the screen, and the docks are there
    """

    furnished = Signal()

    def __init__(self, session: Session, player: Player, settings: Settings) -> None:
        super().__init__()
        self.session, self.player, self.settings = session, player, settings
        for owned in (session, player):
            owned.setParent(self)  # else what is connected to them would keep the window for ever
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
        self.shares = DockShares(self, self.docks.values())
        self.layouts = Layouts(self)
        self.task_layers = TaskLayers(self)
        self.layouts.changed.connect(self._task_changed)
        self.layouts.begin()
        self._connect()
        self.faults = Faults(self)

    @cached_property
    def loads(self) -> LoadActions:
        """What adds rows to the loads; imported when a view or a menu asks for it."""
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
        session.started.connect(partial(setattr, self, "_begun", True))
        session.drive_chosen.connect(partial(setattr, self, "_begun", True))
        session.full_design_changed.connect(self._suit_design)
        session.file_changed.connect(self._suit_design)
        session.stack.indexChanged.connect(self._steps_changed)
        session.stack.cleanChanged.connect(self._steps_changed)
        session.refused.connect(self._show_refusal)
        session.vary_requested.connect(self.vary)
        self.documents.status_message.connect(self.status.show_message)
        self.exports.status_message.connect(self.status.show_message)
        self.disk.status_message.connect(self.status.show_message)
        self.recovery.status_message.connect(self.status.show_message)
        self.designing.status_message.connect(self.status.show_message)
        self.exports.layers, self.exports.view = self._layers, self.view
        QApplication.styleHints().colorSchemeChanged.connect(self._desktop_changed)
        player.playing_changed.connect(self.actions_by_key["play"].setChecked)
        player.forward_changed.connect(lambda forward: self.actions_by_key["reverse"].setChecked(not forward))
        self.centre.tabs.currentChanged.connect(lambda _: self.status.recount())
        for dock in self.docks.values():
            dock.pause(True)
            dock.seen.connect(self._docks_moved)
            dock.topLevelChanged.connect(self._docks_moved)
            dock.dockLocationChanged.connect(self._docks_moved)

    # -- views --------------------------------------------------------------------------------------------

    def view(self, name: str) -> View | None:
        """A view by its name in ``VIEWS``; None where it has not been seen yet."""
        dock = self.docks.get(name)
        return dock.view if dock is not None else self.centre.page(name)

    def show_view(self, name: str) -> View:
        """Bring a view to the front, made now where it is not there yet."""
        if VIEWS[name].area == CENTRE:
            return self.centre.show_page(name)
        dock = self.docks[name]
        self.layouts.open(dock)
        dock.raise_()
        view = dock.build()
        view.wake()
        return view

    def explain(self, number: ExplainableNumber) -> None:
        """Show where a number comes from, at its own angle, else at the angle at hand."""
        view: Any = self.show_view("explain")
        view.explain(number)

    def explain_here(self) -> None:
        """Show where the number comes from that is chosen where the focus is; where none is, the last one that was explained."""
        view = self._view_in_focus()
        number = None if view is None else view.selected_number()
        if number is None:
            self.show_view("explain")
        else:
            self.explain(number)

    def _view_in_focus(self) -> View | None:
        at = QApplication.focusWidget()
        return next((view for view in self._views() if at is not None and view.isAncestorOf(at)), None)

    def copy_picture(self) -> None:
        """Of the view that the focus is in, else of the one in the middle, to the clipboard."""
        if (view := self._view_in_focus() or self.centre.current) is not None:
            copy_picture(view)

    def pin(self, design: Design | None = None) -> None:
        """Keep a design as it is, that at hand where none is named: what is changed then is held against it."""
        row = Pins.of(self.session).pin(self.session.full_design if design is None else design)
        self.show_message(f"Pinned as {row.name}; plots show it dashed, the drawing in grey")

    def pin_before(self) -> None:
        """Hold the design against what it was before the last step."""
        design = self.session.before
        if design is None:
            self.show_message("Nothing was changed yet")
            return
        if self.session.several:
            design = with_only(self.session.full_design, self.session.chosen, design)
        row = Pins.of(self.session).pin(design, f"before: {self.session.stack.undoText()}")
        self.show_message(f"Pinned {row.name}; plots show it dashed, the drawing in grey")

    def pin_file(self) -> None:
        """Hold the design against another file."""
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
        """Let the variant in front go."""
        Pins.of(self.session).unpin()

    def show_polygon(self, kind: str) -> None:
        """The polygon of velocities, or of the forces on a body."""
        view: Any = self.show_view("polygon")
        view.choose(kind)

    def show_search(self, what: str) -> None:
        """Find, with this wanted where the design has it."""
        view: Any = self.show_view("find")
        view.search_for(what)

    def vary(self, path: str) -> None:
        """Study, with this number varied: where it is not in sight the task of that name."""
        view: Any = self.docks["study"].build()
        view.vary(path)
        if not view.on_screen():
            self.show_task("study")
            self.show_view("study")

    def open_design(self, path: Path) -> bool:
        """Open the file of a design in place of the one at hand, an example without its file; False where it stays."""
        before = self.session.document
        if path.is_relative_to(resources()):
            self.documents.open_example(path)
        else:
            self.documents.open_path(path)
        return self.session.document != before

    def apply_remedy(self, remedy: Remedy) -> None:
        """Do what mends a finding: seek the value under the limits of the design, or lead to the field."""
        self.focus_field(remedy.field)
        if remedy.masses:
            self.loads.give_masses()
        if remedy.find:
            view: Any = self.show_view("find")
            view.search_for(remedy.find, afresh=True)

    def can(self, entry: str) -> bool:
        """Whether an entry of the menus can be chosen for the design at hand; of a menu, whether it has one that can."""
        menu = self._menu_of(entry)
        if menu is None:
            return self.actions_by_key[entry].isEnabled()
        menu.aboutToShow.emit()
        return menu.menuAction().isVisible() and any(
            action.isEnabled() and not action.isChecked() for action in menu.actions()
        )

    def do(self, entry: str) -> None:
        """Choose an entry of the menus, by its key there; of a menu, open it under the mouse."""
        menu = self._menu_of(entry)
        if menu is None:
            self.actions_by_key[entry].trigger()
        else:
            menu.popup(QCursor.pos())

    def _menu_of(self, entry: str) -> QMenu | None:
        menu = self.actions_by_key[entry].menu()
        return menu if isinstance(menu, QMenu) else None

    def show_message(self, text: str) -> None:
        """A word in the status line."""
        self.status.show_message(text)

    def ask(self, text: str) -> None:
        """A request in the status line, which stays until it is answered."""
        self.status.ask(text)

    def answered(self, how: str) -> None:
        """What was asked in the status line has been done, or given up."""
        self.status.answered(how)

    def add_load(self, name: str) -> None:
        """Add a row of this kind to the loads, by the mouse where it needs places."""
        self.loads.add(name)

    def pick_load(self, path: str, key: str) -> None:
        """Choose a place of a row of the loads with the mouse."""
        self.loads.pick(path, key)

    def open_load(self, path: str) -> None:
        """Bring the form of a row of the loads before the reader."""
        self.loads.open(path)

    def _views(self) -> Iterator[View]:
        yield from (dock.view for dock in self.docks.values() if dock.view is not None)
        yield from self.centre.views()

    def stages_on_screen(self) -> tuple[str, ...]:
        """The stages that views on screen read, in the order they need each other; with the motion, from which all are computed.
        While something is held with the mouse they are those of when it was taken: each of its moves asks for them."""
        session = self.session
        if session.drag_source is not None and session.stages_of_drag is not None:
            return session.stages_of_drag
        wanted = {stage for view in self._views() if view.on_screen() for stage in view.stages}
        if wanted:
            wanted.add("motion")
        session.stages_of_drag = tuple(stage for stage in session.study.stages if stage in wanted)
        return session.stages_of_drag

    def focus_field(self, path: str) -> None:
        """Bring the field of a path, or of a section, before the reader; of a drive that is not shown, the drive too."""
        own = drive_at(path)
        if own is not None:
            if not self.session.choose_drive(own[0]):
                return
            path = own[1]
        head = path.partition(".")[0].partition("[")[0]
        editor = self.view("motion")
        elsewhere = head in ("timing", "drives") or (head == "motion" and editor is not None and editor.on_screen())
        view: Any = self.show_view(head if elsewhere else "parameters")
        if not view.focus_field(path) and head == "motion" and view is not editor:
            view = self.show_view("motion")  # rows of a table, which the inspector has not
            view.focus_field(path)

    def show_fields(self, section: str) -> None:
        """Bring the page of a section of the parameters to the front, where they are in sight; the keys stay where they are."""
        parameters: Any = self.view("parameters")
        if parameters is not None and parameters.on_screen():
            parameters.show_section(section)

    def fit(self) -> None:
        """Bring the whole of the picture in the middle into sight."""
        if self.centre.current is not None:
            self.centre.current.fit()

    def draw(self, on: bool, tool: str = "choose") -> None:
        """Begin to draw the linkage with the mouse, or leave it."""
        view: Any = self.show_view("mechanism")
        self._drawing_switched(view.draw(on, tool) and on)

    def place_underlay(self) -> None:
        """Show what places a picture under the drawing."""
        view: Any = self.show_view("mechanism")
        view.place_underlay()

    def _drawing_switched(self, on: bool) -> None:
        self.actions_by_key["draw"].setChecked(on)

    def fit_centres(self) -> None:
        """Bring the instant centres of a linkage into the drawing, however far away they are."""
        view: Any = self.show_view("mechanism")
        if any(action.objectName() == "layer:centres" for action in view.layer_actions()):
            view.fit_centres()
        else:
            self.show_view("centres")

    def _layers(self) -> dict[str, bool]:
        """What the drawing of the mechanism shows, by layer."""
        view = self.view("mechanism")
        rows = view.layer_actions() if view is not None else []
        return {action.objectName().partition(":")[2]: action.isChecked() for action in rows}

    def add_drive_by_picture(self) -> None:
        """One drive more, chosen by its picture."""
        from kindyna_gui.window import shafts

        shafts.add_by_picture(self)

    def add_to_shaft(self) -> None:
        """Put the design on a shaft of several, or the drives of a file on this one."""
        from kindyna_gui.window import shafts

        shafts.add_to_shaft(self)

    def export_picture(self, name: str) -> None:
        """Ask for a file and write the picture of a view there."""
        view = self.view(name)
        if view is not None:
            save_picture(view, name)

    # -- tasks --------------------------------------------------------------------------------------------

    def show_task(self, name: str) -> None:
        """Show one of ``TASKS`` as it was left, with the keys at its large view."""
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

    def _suit_design(self) -> None:
        """Another design has begun, and is in place."""
        if self._begun:
            self._begun = False
            self.layouts.suit()

    # -- the design ---------------------------------------------------------------------------------------

    def enable_segment_edits(self, able: dict[str, bool]) -> None:
        """Which edits of the chosen segment are possible now, by their names."""
        for name, on in able.items():
            self.actions_by_key[f"designing.segment:{name}"].setEnabled(on)

    def _design_changed(self) -> None:
        study = self.session.study
        self.player.omega = study.omega
        self._place_drive()
        try:
            self.player.set_ranges(study.turn_ranges)
        except KindynaError:
            self.player.set_ranges(())  # no position at all, which the views show

    def _place_drive(self) -> None:
        """The angle of the drive that is shown follows from the machine's."""
        place = self.session.place
        self.player.show_drive(place.phase, place.rotation_sign)

    def _show_refusal(self, refusal: Refusal) -> None:
        self.status.refuse(f"{refusal.reasons[0][1]}: {refusal.reasons[0][2]}")

    def _steps_changed(self, *_: object) -> None:
        self.titles.name_steps()
        self.titles.name_window()

    def reverse(self, on: bool) -> None:
        """Play backwards."""
        self.player.set_forward(not on)

    # -- help ---------------------------------------------------------------------------------------------

    def find_anything(self) -> None:
        """A line for words, over the window."""
        if self._finder is None:
            from kindyna_gui.window.finder import Finder

            self._finder = Finder(self)
        self._finder.open()

    def prefer(self) -> None:
        """Ask what the user prefers, and follow it."""
        from kindyna_gui.window.preferences_dialog import preferences_wanted

        wanted = preferences_wanted(self, preferences.read())
        if wanted is not None:
            preferences.write(wanted)
            self._follow(wanted)

    def _follow(self, wanted: preferences.Preferences) -> None:
        app = QApplication.instance()
        assert isinstance(app, QApplication)
        wear(wanted, app)

    def _desktop_changed(self, scheme: Qt.ColorScheme) -> None:
        """The desktop has turned light or dark."""
        wanted, app = preferences.read(), QApplication.instance()
        if wanted.theme == "system" and isinstance(app, QApplication):
            wear(wanted, app, scheme)

    def help_here(self) -> None:
        """The page of the help on the field, or the view, that has the keys."""
        self.show_help(*dialogs.help_on(QApplication.focusWidget() or self))

    def show_help(self, name: str, words: str = "") -> None:
        """A page of the help, at these words."""
        if self._help is None:
            from kindyna_gui.help import HelpWindow

            self._help = HelpWindow(self)
        self._help.open(name, words)

    def show_welcome(self) -> None:
        """Examples with pictures, a new design, files opened lately."""
        if self.welcome is None:
            from kindyna_gui.window.welcome import Welcome

            self.welcome = Welcome(self)
        self.welcome.open()

    def greet(self) -> None:
        """At the start: offer unsaved work of an earlier run; else, where no file was named, the welcome page."""
        if not self.recovery.offer() and self.session.path is None and self.settings.welcome:
            self.show_welcome()

    def begin_tutorial(self, name: str) -> None:
        """A lesson at this window, step by step."""
        from kindyna_gui.window.tutorial import begin, read

        begin(self, read(name))

    def show_papers(self) -> None:
        """Figures of the papers, with what they say against what comes out here."""
        if self._papers is None:
            from kindyna_gui.papers import FiguresWindow

            self._papers = FiguresWindow(self, lambda name: self.documents.open_example(example(name)))
        self._papers.open()

    def about(self) -> None:
        dialogs.about(self)

    # -- layout -------------------------------------------------------------------------------------------

    def reset_layout(self) -> None:
        """All docks of the task back to where they were at first."""
        self.layouts.reset()

    def keep_layout(self) -> None:
        """Ask for a name, and keep the layout at hand under it."""
        name = dialogs.layout_name_wanted(self, self.settings.named_layouts)
        if name:
            self.layouts.keep(name)
            self.status.show_message(f"Layout {name} is kept among the named layouts")

    def take_layout(self, name: str) -> None:
        """A layout that was kept under a name."""
        try:
            self.layouts.take(name)
        except ValueError as error:
            self.status.show_message(f"Layout {name} is left as it is: {error}")

    def forget_layout(self, name: str) -> None:
        """Do without a layout that was kept under a name."""
        self.settings.forget_layout(name)
        self.status.show_message(f"Layout {name} is forgotten")

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
        """Past what Qt keeps beyond the edge of the window: docks behind others, and bars of tabs that no dock needs at present."""
        held, passed = self.focusWidget(), set[QWidget]()
        by_key = held is not None and held.isVisibleTo(self) and held.isEnabled()  # else it has just been hidden
        while super().focusNextPrevChild(onwards):
            at = self.focusWidget()
            part: QWidget | None = at
            while part is not None and part.parentWidget() is not self:
                part = part.parentWidget()
            if at is None or part is None or at in passed or is_in_sight(part):
                if by_key:
                    scroll_to(at)
                return True
            passed.add(at)
        return False

    def paintEvent(self, event: QPaintEvent) -> None:
        """The first thing that is seen is the mechanism; the docks around it come next."""
        super().paintEvent(event)
        if not self._painted:
            self._painted = True
            soon(self, self._furnish)

    def _furnish(self) -> None:
        for dock in self.docks.values():
            dock.pause(False)
        self.layouts.furnish()
        if strange := preferences.not_understood():
            self.status.show_message(f"{STRANGE}{', '.join(strange)}")
        self.furnished.emit()

    def closeEvent(self, event: QCloseEvent) -> None:
        if not self.documents.may_leave():
            event.ignore()
            return
        self.player.play(False)
        self.layouts.save()
        for view in self.findChildren(View):
            view.leave()
        self.session.pending.close()
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
    """The window with a design, paused at cam angle 0; not shown yet.

    path: the file to open; None, or the default design: an example, saved under a name of its own. Raises
    DesignError, FileError.
    """
    keep_freed_memory()
    own = None if path is None or path == default_design() else path
    session = Session(load_drawing(own or default_design()), own)
    wear(preferences.read(), app)
    app.setApplicationName("KINDYNA")
    app.setDesktopFileName("kindyna")
    settings = Settings()
    if own is not None:
        settings.add_recent(own)
    window = MainWindow(session, Player(), settings)
    window.recovery.begin()
    return window


def run(path: Path | None = None) -> int:
    """Open the window, with this file where one is named, and stay until it is closed; the exit code.

    Raises DesignError, FileError where the file is wrong.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl+C while the window is being made ends it without a word
    app = ensure_app()
    window = open_window(app, path)
    write_before_the_end(app, window.recovery)
    window.furnished.connect(window.greet, Qt.ConnectionType.QueuedConnection)
    window.show()
    return QApplication.exec()


__all__ = ["MainWindow", "open_window", "run"]
