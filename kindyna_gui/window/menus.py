"""Menus and toolbar as data. The menus keep the order of the program of 1995: MAKE, COMPO, KINE, DYNA, GRAPH."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from operator import attrgetter
from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QMenu, QToolBar, QWidget

from core.frozen import frozen
from kindyna_gui.look import icon, tool_bar
from kindyna_gui.rebuilt import clear_menu
from kindyna_gui.window import submenus
from kindyna_gui.window.base import Window
from kindyna_gui.window.docks import VIEWS
from kindyna_gui.window.tasks import TASKS

Keys = QKeySequence.StandardKey


@frozen
class Item:
    """One entry. slot: what of the window is called, ``documents.save``; with ``argument`` where there is one.

    name   key of the action, the slot itself where empty
    view   whose keys they are, by its name in ``VIEWS``: they act while the focus is in it; where empty, everywhere
    """

    text: str
    slot: str
    argument: Any = None
    keys: str | QKeySequence.StandardKey | None = None
    tip: str = ""
    icon: str = ""
    checkable: bool = False
    name: str = ""
    view: str = ""

    @property
    def key(self) -> str:
        return self.name or (self.slot if self.argument is None else f"{self.slot}:{self.argument}")


@frozen
class Submenu:
    """A menu whose entries depend on the state of things; ``fill`` makes them anew each time it opens."""

    text: str
    fill: Callable[[Window, QMenu], None]
    name: str = ""


def _later(module: str, name: str) -> Callable[[Window, QMenu], None]:
    """Fills a menu from a module that is imported when it is first opened."""

    def fill(window: Window, menu: QMenu) -> None:
        getattr(import_module(f"kindyna_gui.{module}"), name)(window, menu)

    return fill


def _view(name: str) -> Item:
    row = VIEWS[name]
    return Item(row.menu, "show_view", name, row.keys, row.tip, row.icon)


def _segment(text: str, name: str, keys: str, tip: str) -> Item:
    return Item(text, "designing.segment", name, keys, tip, name, view="motion")


def _field(text: str, path: str, tip: str) -> Item:
    return Item(text, "focus_field", path, None, tip)


SEPARATOR = None
Entry = Item | Submenu | None

MENUS: tuple[tuple[str, tuple[Entry, ...]], ...] = (
    (
        "&File",
        (
            Item("&New...", "designing.new_by_picture", None, Keys.New,
                 "Begin with a follower, its face and the form of its cam, or with a linkage, chosen by its picture"),
            Submenu("New of a &kind", submenus.fill_new, "new"),
            Item("&Open...", "documents.open_file", None, Keys.Open, "Open a design file", "open"),
            Submenu("Open &recent", submenus.fill_recent),
            Submenu("&Examples", submenus.fill_examples),
            SEPARATOR,
            Item("&Save", "documents.save", None, Keys.Save, "Save the design to its file", "save"),
            Item("Re&load", "documents.reload", None, None, "Read the design's file again; Undo brings back what was here"),
            Item("Save &as...", "documents.save_as", None, Keys.SaveAs, "Save the design to another file"),
            Item("Reco&ver unsaved work...", "recovery.offer_again", None, None,
                 "What was unsaved when KINDYNA ended without being closed"),
            SEPARATOR,
            Item("Add this desi&gn to a shaft...", "add_to_shaft", None, None,
                 "Make it the first of several drives on one shaft, or add it to a shaft; to a shaft at hand add the drives of a file"),
            Item("&Import measured motion...", "designing.import_measured", None, None,
                 "Fit a motion to a table of measured displacements, velocities or accelerations"),
            Item("I&mport linkage...", "designing.import_linkage", None, None,
                 "A linkage of Pyslvs, PMKS+ or Linkage, as text, address or file; what cannot be carried over is listed"),
            Item("Import &controller table...", "designing.import_controller", None, None,
                 "The table of a servo controller as the motion that the controller makes of it"),
            Submenu("Expor&t", submenus.fill_exports, "exports"),
            Item("Re&port...", "exports.report", None, "Ctrl+P",
                 "A report to hand on, as PDF or as HTML: inputs, drawings, curves, extremes, findings, certificate, equations"),
            SEPARATOR,
            Item("&Quit", "close", None, "Ctrl+Q", "Leave KINDYNA"),
        ),
    ),
    (
        "&Edit",
        (
            Item("&Undo", "session.stack.undo", None, Keys.Undo, "Take the last change back", "undo", name="undo"),
            Item("&Redo", "session.stack.redo", None, Keys.Redo, "Make the change again", "redo", name="redo"),
            SEPARATOR,
            Item("&Copy picture", "copy_picture", None, "Ctrl+Shift+C", "Of the view in focus, else of the drawing, to the clipboard"),
            SEPARATOR,
            Item("&Pin this variant", "pin", None, "Ctrl+Shift+P",
                 "Keep the design as it is: plots show it dashed, the drawing in grey, and a table what changes"),
            Item("Pin what was &before", "pin_before", None, None, "Hold the design against what it was before the last step"),
            Item("Pin a &file...", "pin_file", None, None, "Hold the design against another file"),
            Item("Unp&in", "unpin", None, None, "Let the pinned variant go"),
            _view("compare"),
            Item("&Explain a number", "explain_here", None, "Shift+F1", VIEWS["explain"].tip),
            SEPARATOR,
            Item("Find an&ything...", "find_anything", None, "Ctrl+K",
                 "Commands, fields, channels, examples, help and findings by words or symbols; a value behind a field's name sets it"),
            Item("&Scale the design...", "designing.scale", None, None, "All lengths by one factor, masses and inertias by choice"),
            Item("Prefere&nces...", "prefer", None, "Ctrl+,",
                 "Units on display, decimal sign, theme, letters, paper, author, company, logo"),
        ),
    ),
    (
        "&Make",
        (
            _view("motion"),
            _view("laws"),
            Item("&Blend...", "designing.blend", None, "Ctrl+B", "A motion of curves that are chosen and joined smoothly"),
            Item("Blend a se&quence...", "designing.blend_sequence", None, None,
                 "Any curves of the table in a row, as many as you like, with what is set of each"),
            Item("Motion &from a DXF curve...", "designing.motion_from_curve", None, None,
                 "Roll the follower over a closed curve of lines and arcs: a tangent cam, a three-arc cam, a digitised one"),
            SEPARATOR,
            _segment("&Insert segment", "insert", "Ctrl+I", "A dwell behind the chosen segment"),
            Item("Insert befor&e", "designing.segment", "insert_before", None, "A dwell before the chosen segment", "insert",
                 view="motion"),
            _segment("S&plit segment", "split", "Ctrl+Shift+I", "Cut the chosen segment where the cam stands"),
            _segment("D&uplicate segment", "duplicate", "Ctrl+Shift+D", "A copy behind the chosen segment"),
            _segment("Mi&rror stroke", "mirror", "Ctrl+Shift+M", "Make the return the mirror image of the rise"),
            _segment("&Delete segment", "delete", "Ctrl+D", "Take the chosen segment away"),
            SEPARATOR,
            Item("Se&gment from table...", "designing.segment_from_table", None, None,
                 "The first two columns of a table as the curve of the chosen segment, stretched to its span and rise or as they are"),
            Item("Segment from &clipboard", "designing.segment_from_clipboard", None, None,
                 "The same of what was copied from a spreadsheet"),
            Item("S&hift the motion by...", "designing.shift_motion", None, None,
                 "Let it do the same later or earlier in the turn; so does drawing along the names above the diagram"),
            Item("Save m&otion...", "designing.save_motion", None, None, "The motion in a file of its own"),
            Item("Motion from a desig&n or file...", "designing.take_motion", None, None,
                 "The motion of a drive of another design, or of a file of a motion, in place of this one"),
            Item("Motion that follo&ws from files...", "designing.follow_files", None, None,
                 "Of a table, the sum of several motions, or what a linkage's driver must do: read anew whenever they change"),
            SEPARATOR,
            _field("&Start", "motion.start", "Where the follower stands at cam angle 0"),
            _field("S&troke", "motion.stroke", "Highest minus lowest position of the follower"),
        ),
    ),
    (
        "&Compo",
        (
            _view("mechanism"),
            Item("Dra&w", "draw", None, "D", "Draw links, pins, sliders and loads with the mouse; D or Esc leaves", checkable=True,
                 name="draw", view="mechanism"),
            Submenu("Drawi&ng", _later("window.linkage_menus", "fill_drawing"), "drawing"),
            Item("Underla&y...", "place_underlay", None, None,
                 "A picture or a DXF under the drawing: place it, scale it by a known distance, and draw on its corners and centres"),
            Item("Circ&uits...", "designing.choose_circuit", None, None,
                 "The ways to put the linkage together, as pictures with the range of its driver, to choose from"),
            Item("&Save as signs", "designing.save_as_signs", None, None,
                 "Tell by signs, instead of by the drawing, in which way the linkage is put together"),
            SEPARATOR,
            Item("C&hoose a mechanism...", "designing.choose_mechanism", None, None,
                 "Followers with every face and form of cam, and linkages, as pictures to begin with; the motion is kept"),
            SEPARATOR,
            _field("&Follower", "follower", "Lengths of the follower"),
            _field("&Cam", "cam", "Base circle and roller"),
            Submenu("&Layout", submenus.fill_layouts, "layouts"),
            Submenu("Driv&er", _later("window.linkage_menus", "fill_drivers"), "drivers"),
            Submenu("Cam &roller", _later("window.linkage_menus", "fill_rollers"), "rollers"),
            _field("Lin&kage", "linkage", "Dimensions, driver and assembly of a linkage"),
            SEPARATOR,
            _view("centres"),
            Item("Fit cen&tres", "fit_centres", None, None,
                 "Show the instant centres of all links, and bring those outside the picture into it"),
            Item("&Velocity polygon", "show_polygon", "velocities", None,
                 "Velocities from one pole, V_P = V_A + V_PA, at the angle at hand"),
            _view("circle"),
        ),
    ),
    (
        "&Kine",
        (
            _view("stack"),
            _view("displacement"),
            _view("velocity"),
            _view("acceleration"),
            _view("jerk"),
            SEPARATOR,
            _view("pressure_angle"),
            _view("curvature"),
            _field("Li&mits", "limits", "Your own limits of pressure angle, radii of curvature and contact force"),
            _view("find"),
            _view("study"),
            Submenu("C&olour the profile", submenus.fill_colours, "colours"),
            Item("&Inspect a measured cam...", "designing.inspect_measured", None, None,
                 "Lay a measured table of lift on the profile: deviations, the largest, in or out of tolerance"),
            SEPARATOR,
            Item("P&lay", "player.play", None, "F5", "Turn the cam", checkable=True, name="play"),
            Item("Step &forward", "player.step", 1.0, "F7", "One degree forward"),
            Item("Step &back", "player.step", -1.0, "F6", "One degree back"),
            Item("&Reverse", "reverse", None, "F8", "Turn the other way round", checkable=True),
        ),
    ),
    (
        "&Dyna",
        (
            _view("drives"),
            _field("&Loads", "loads", "Masses, springs and forces"),
            Submenu("&Add to the loads", _later("window.load_rows", "fill_added"), "load rows"),
            Submenu("Ta&ke from the loads", _later("window.load_rows", "fill_taken"), "taken load rows"),
            Item("Fin&d closing spring", "show_search", "spring", None,
                 "The least rate of the spring that keeps the follower on its cam up to the speed, with the preload it is traded for"),
            SEPARATOR,
            _view("contact_force"),
            _view("contact"),
            Item("Force pol&ygon", "show_polygon", "body", None,
                 "All forces on a body end to end at the angle at hand, or the force in a pin or guide over the turn"),
            _view("vibration"),
            _view("contact_pressure"),
            _view("torque"),
            _view("flywheel"),
            _view("shaft_torque"),
            _view("shaft_figures"),
            _view("against_speed"),
            _view("timing"),
            _view("servo"),
            _view("camshaft_speed"),
            SEPARATOR,
            Item("&Give it a shaft", "designing.give_shaft", None, None,
                 "A shaft for a linkage: flywheel, motor and, under a cam, stability"),
            Item("Gi&ve it a servo", "designing.give_servo", None, None,
                 "A motor that makes the motion itself: its torque, speed and power stand beside those of the cam's shaft"),
            Item("Take the servo a&way", "designing.take_servo", None, None, "The drive without its servo"),
        ),
    ),
    (
        "&Stability",
        (
            _view("stability"),
            Item("&Flexible shaft", "designing.make_flexible", None, None,
                 "Give the camshaft a stiffness and an inertia, guessed from what it moves"),
            Item("&Rigid shaft", "designing.make_rigid", None, None, "Take the camshaft's flexibility out of the design"),
            Item("&Give it a shaft", "designing.give_shaft", None, None,
                 "A shaft for a linkage: flywheel, motor and, under a cam, stability"),
            SEPARATOR,
            _field("Camshaft &data", "shaft", "Speed, sense of rotation, flywheel and motor of the camshaft"),
        ),
    ),
    (
        "&Graph",
        (
            _view("curves"),
            _view("graph"),
            _view("space"),
            SEPARATOR,
            Submenu("Export &picture", submenus.fill_pictures),
            Item("Export &numbers...", "exports.tables", None, "Ctrl+E",
                 "Write profile, kinematics and dynamics as CSV tables", "export"),
            Item("Export pr&ofile...", "exports.profile", None, "Ctrl+Shift+E",
                 "The cam's profile, or the path of a cutter, as DXF, SVG, CSV or G-code"),
        ),
    ),
    (
        "&View",
        (
            *(Item(task.title, "show_task", name, f"Ctrl+{number}", task.tip) for number, (name, task) in enumerate(TASKS.items(), 1)),
            SEPARATOR,
            Submenu("&Docks", submenus.fill_docks),
            Submenu("&Layers of the drawing", submenus.fill_layers),
            Submenu("&Named layouts", submenus.fill_named_layouts),
            SEPARATOR,
            Item("&Fit drawing", "fit", None, "Ctrl+0", "Bring the whole mechanism into sight", "fit"),
            Item("&Reset layout", "reset_layout", None, None, "Put all docks of this task back to where they were at first"),
        ),
    ),
    (
        "&Help",
        (
            Item("&Welcome", "show_welcome", None, None, "Examples by subject, with pictures; a new design; files opened lately"),
            Item("Help on this fiel&d or view", "help_here", None, Keys.HelpContents, "On the field or the view that has the keys", "help"),
            Item("Shortc&uts", "show_help", "shortcuts", None, "Every key of the window"),
            Submenu("Tutoria&l", submenus.fill_tutorials),
            Item("&Tour", "show_help", "tour", None, "What is where, in five minutes"),
            Item("&Making a motion", "show_help", "making", None, "The motion editor by mouse and keys; measured tables"),
            Item("&Blended motions", "show_help", "blending", None, "Which curve follows which; the card picker twice"),
            Item("T&iming of several drives", "show_help", "timing", None, "The timing chart by mouse, and what must come after what"),
            Item("&Followers", "show_help", "followers", None, "Cam slider, translating and swinging follower"),
            Item("Fi&nding dimensions", "show_help", "finding", None, "The dimension that just keeps its limits, or the best of them"),
            Item("Studies of man&y designs", "show_help", "studies", None, "Tables of many designs, tolerances, the best of them"),
            Item("Lin&kages", "show_help", "linkages", None, "Links, pins and guides; centres and velocities"),
            Item("&Stability of the camshaft", "show_help", "stability", None, "Chart, verdicts, and Kim1990's claims against ours"),
            Item("Figures of the &papers...", "show_papers", None, None, "What the four papers say and draw, and what comes out here"),
            Item("T&he four papers", "show_help", "papers", None, "Kinds of verdict, and where print and truth part"),
            Item("C&ontrollers", "show_help", "controllers", None, "Electronic cams: what a servo controller makes of a table"),
            Item("Laws and con&ventions", "show_help", "laws", None, "Motion laws, signs, units, angles"),
            Item("&Run time against error", "show_help", "speed", None, "Every kernel beside what could be taken in its place"),
            Item("Ar&chitecture", "show_help", "architecture", None, "The floors of the program, and how a figure is proved"),
            Item("What has chang&ed", "show_help", "changes", None, "What is new for a user"),
            SEPARATOR,
            _view("log"),
            Item("&About KINDYNA", "about", None, None, "Version and origin"),
        ),
    ),
)  # fmt: skip

TOOLBAR = ("documents.open_file", "documents.save", None, "undo", "redo", None, "fit", "show_view:graph")


def build(window: Window) -> dict[str, QAction]:
    """Fill the window's menu bar; the actions by their keys, those of whole menus by their texts.

    The window must keep them all: once Python forgets a menu's action, it takes the menu for deleted.
    """
    actions: dict[str, QAction] = {}
    for title, entries in MENUS:
        menu = window.menuBar().addMenu(title)
        actions[title] = menu.menuAction()
        for entry in entries:
            if entry is SEPARATOR:
                menu.addSeparator()
            elif isinstance(entry, Submenu):
                _add_submenu(window, menu, entry, actions)
            else:
                actions[entry.key] = _add_action(window, menu, entry)
    return actions


def _add_action(window: Window, menu: QMenu, item: Item) -> QAction:
    action = menu.addAction(item.text)
    action.setObjectName(item.key)
    action.setCheckable(item.checkable)
    action.setStatusTip(item.tip)
    action.setToolTip(item.tip)
    if item.keys is not None:
        action.setShortcut(QKeySequence(item.keys))
    if item.view:
        action.setShortcutContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
    if item.icon:
        action.setIcon(icon(item.icon))
    slot = attrgetter(item.slot)
    if item.checkable:
        action.triggered.connect(lambda on: slot(window)(on))
    elif item.argument is None:
        action.triggered.connect(lambda: slot(window)())
    else:
        action.triggered.connect(lambda: slot(window)(item.argument))
    return action


def add_view_keys(view: QWidget, name: str, actions: dict[str, QAction]) -> None:
    """Give a view its own shortcuts; name: its name in ``VIEWS``."""
    rows = (row for _, entries in MENUS for row in entries if isinstance(row, Item) and row.view == name)
    view.addActions([actions[row.key] for row in rows])


def _add_submenu(window: Window, menu: QMenu, row: Submenu, actions: dict[str, QAction]) -> None:
    submenu = menu.addMenu(row.text)
    submenu.setToolTipsVisible(True)

    def refill() -> None:
        clear_menu(submenu)
        row.fill(window, submenu)

    # with the menu it stands in, so that an empty one can be greyed or left out
    menu.aboutToShow.connect(refill)
    submenu.aboutToShow.connect(refill)
    actions[row.name or row.text] = submenu.menuAction()


def build_toolbar(window: Window, actions: dict[str, QAction]) -> QToolBar:
    """The toolbar: some of the menus' actions."""
    bar = tool_bar("Toolbar")
    bar.setObjectName("toolbar")
    for key in TOOLBAR:
        if key is None:
            bar.addSeparator()
        else:
            bar.addAction(actions[key])
    return bar


def build_tasks(window: Window, actions: dict[str, QAction]) -> QToolBar:
    """The row of tasks: the menu's entries as buttons, of which one is down."""
    bar = tool_bar("Tasks")
    bar.setObjectName("tasks")
    bar.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
    bar.toggleViewAction().setVisible(False)  # else a task in which they are hidden would have no way out to be seen
    group = QActionGroup(window)
    for name in TASKS:
        action = actions[f"show_task:{name}"]
        action.setCheckable(True)
        group.addAction(action)
        bar.addAction(action)
    return bar
