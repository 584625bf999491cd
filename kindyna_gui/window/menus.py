"""Menus."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib import import_module
from operator import attrgetter
from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QMenu, QToolBar, QWidget

from core.design import FOLLOWER_KINDS, LAYOUTS
from core.frozen import frozen
from core.project.reading_faults import subjects
from kindyna_gui.labels import choice_tip
from kindyna_gui.look import icon, tool_bar
from kindyna_gui.places import lessons
from kindyna_gui.rebuilt import clear_menu
from kindyna_gui.window.base import Window, title_of, why_absent
from kindyna_gui.window.docks import VIEWS
from kindyna_gui.window.tasks import TASKS

# -- submenus --------------------------------------------------------------------------------------------


def fill_new(window: Window, menu: QMenu) -> None:
    """A design of each kind, or a shaft of several drives."""
    for slug, row in FOLLOWER_KINDS.items():
        action = menu.addAction(row.label)
        action.setStatusTip(f"Begin a design of this kind: {row.label}")
        action.triggered.connect(partial(_without_state, window.documents.new, slug))
    action = menu.addAction("Linkage by drawing")
    action.setStatusTip("Begin with an empty sheet, on which links, pins and sliders are drawn with the mouse")
    action.triggered.connect(partial(_without_state, new_drawing, window))
    for name, title, tip in MOTIONS:
        action = menu.addAction(title)
        action.setStatusTip(tip)
        action.triggered.connect(partial(_without_state, partial(new_motion, window), name))
    action = menu.addAction("Shaft of cams...")
    action.setStatusTip(
        "Begin a shaft of several drives with one chosen by its picture; the list of drives adds others"
    )
    action.triggered.connect(partial(_without_state, new_shaft, window))


MOTIONS = (
    ("indexer", "Indexer...", "Begin with the steps of a table: stops, index angle, dwell, law"),
    (
        "flying_shear",
        "Flying shear...",
        "Begin with a carriage that runs with its material: length, synchronous window, return",
    ),
)
"""Name in ``motion.begin_dialog.BEGINNINGS``, entry of the menu, and its sentence: the dialog is imported when it is opened."""


def new_motion(window: Window, name: str) -> None:
    """Ask for a motion to begin with."""
    from kindyna_gui.motion.laws_plot import BEGINNINGS, beginning_wanted

    if window.documents.may_leave():
        design = beginning_wanted(window, name)
        if design is not None:
            window.documents.begin(design, BEGINNINGS[name].title)


def new_shaft(window: Window) -> None:
    """Begin a shaft of several drives."""
    from kindyna_gui.window import shafts

    shafts.new_shaft(window)


def new_drawing(window: Window) -> None:
    """Begin with an empty sheet."""
    if window.documents.new_drawing():
        window.draw(True, "bar")


def fill_recent(window: Window, menu: QMenu) -> None:
    """Files opened or saved lately."""
    for number, path in enumerate(window.settings.recent, 1):
        action = menu.addAction(f"&{number}  {_plain(path.name)}")
        action.setToolTip(str(path))
        action.setStatusTip(str(path))
        action.triggered.connect(partial(_without_state, window.documents.open_path, path))
    empty = menu.isEmpty()
    menu.menuAction().setEnabled(not empty)
    if not empty:
        menu.addSeparator()
        menu.addAction("&Clear list").triggered.connect(lambda: window.settings.clear_recent())


def fill_examples(window: Window, menu: QMenu) -> None:
    """The examples that come with the program, by subject, each with its paper."""
    from core.papers import PAPERS  # before the menu opens nobody asks for them

    for subject, rows in subjects():
        menu.addSection(_plain(subject))
        for row in rows:
            paper = PAPERS[row.paper].label if row.paper else ""
            action = menu.addAction(_plain(f"{row.name}\t{paper}" if paper else row.name))
            action.setStatusTip(row.text)
            action.setToolTip(row.text)
            action.triggered.connect(partial(_without_state, window.documents.open_example, row.path))


def fill_tutorials(window: Window, menu: QMenu) -> None:
    """Lessons at the window."""
    for name, title in lessons():
        action = menu.addAction(title)
        action.setStatusTip("Step by step at this window: what to do, where, and on as soon as it is done")
        action.triggered.connect(partial(_without_state, window.begin_tutorial, name))


def fill_layouts(window: Window, menu: QMenu) -> None:
    """The layouts of the follower, where its kind has any."""
    design = window.session.typed
    layout = getattr(design.drive.mechanism, "layout", None)
    menu.menuAction().setVisible(layout is not None)
    if layout is None:
        return
    group = QActionGroup(menu)
    for letter in LAYOUTS:
        action = menu.addAction(f"&{letter}  {choice_tip(letter)}")
        action.setCheckable(True)
        action.setChecked(letter == layout)
        action.setStatusTip(f"Layout {letter}: {choice_tip(letter)}; pivot and guide go to their sides")
        group.addAction(action)
        action.triggered.connect(partial(_without_state, partial(choose_layout, window), letter))


def choose_layout(window: Window, letter: str) -> None:
    """Another layout of the follower, as its field chooses it."""
    window.session.edit("follower.layout", letter, f"Change layout to {letter}")
    window.session.end_gesture()


def fill_exports(window: Window, menu: QMenu) -> None:
    """Everything that can be written besides the design."""
    for row in window.exports.rows():
        same = window.actions_by_key.get(f"exports.{row.act.__name__}")
        keys = same.shortcut().toString(QKeySequence.SequenceFormat.NativeText) if same is not None else ""
        action = menu.addAction(f"{row.text}\t{keys}" if keys else row.text)
        action.setEnabled(not row.why_not)
        action.setStatusTip(row.why_not or row.tip)
        action.triggered.connect(partial(_without_state, lambda call: call(), row.act))


def fill_pictures(window: Window, menu: QMenu) -> None:
    """The pictures that are on the screen."""
    for name, row in VIEWS.items():
        view = window.view(name)
        if row.picture and view is not None and view.on_screen():
            title = title_of(name, window.session.design)
            action = menu.addAction(f"{title}...")
            action.setEnabled(not view.no_picture)
            action.setStatusTip(view.no_picture.replace("\n", " ") or f"Write the picture {title} as PNG or SVG")
            action.triggered.connect(partial(_without_state, window.export_picture, name))
    menu.menuAction().setEnabled(not menu.isEmpty())


def fill_docks(window: Window, menu: QMenu) -> None:
    """Every dock, checked where it is shown."""
    for dock in window.docks.values():
        action = dock.toggleViewAction()
        why = why_absent(dock.objectName(), window.session.design)
        action.setStatusTip(why or f"Show or hide {dock.windowTitle()}")
        action.setEnabled(action.isChecked() or not why)
        menu.addAction(action)


def fill_named_layouts(window: Window, menu: QMenu) -> None:
    """Layouts that the user has kept, and the way to keep one more, or one less."""
    action = menu.addAction("&Keep this layout...")
    action.setStatusTip("Keep docks, pages and task as they stand under a name, for this run and the next")
    action.triggered.connect(lambda: window.keep_layout())
    names = window.settings.named_layouts
    if not names:
        return
    menu.addSeparator()
    for name in names:
        action = menu.addAction(_plain(name))
        action.setStatusTip(f"Docks, pages and task as they were kept under the name {name}")
        action.triggered.connect(partial(_without_state, window.take_layout, name))
    menu.addSeparator()
    for name in names:
        action = menu.addAction(_plain(f"Forget {name}"))
        action.setStatusTip(f"Do without the layout {name}")
        action.triggered.connect(partial(_without_state, window.forget_layout, name))


def fill_layers(window: Window, menu: QMenu) -> None:
    """What the drawing of the mechanism can show and hide."""
    view = window.view("mechanism")
    for action in view.layer_actions() if view is not None else ():
        menu.addAction(action)
    menu.menuAction().setVisible(not menu.isEmpty())


def fill_colours(window: Window, menu: QMenu) -> None:
    """The layers that colour the profile, where there is a cam."""
    view = window.view("mechanism")
    for action in view.layer_actions() if view is not None else ():
        if action.actionGroup() is not None:
            menu.addAction(action)
    menu.menuAction().setVisible(not menu.isEmpty())


def _without_state(slot: object, argument: object, *_: object) -> None:
    """Call a slot without the checked state that ``triggered`` brings."""
    assert callable(slot)
    slot(argument)


def _plain(text: str) -> str:
    """A text without keys of access."""
    return text.replace("&", "&&")


# -- menus -----------------------------------------------------------------------------------------------

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
            Submenu("New of a &kind", fill_new, "new"),
            Item("&Open...", "documents.open_file", None, Keys.Open, "Open a design file", "open"),
            Submenu("Open &recent", fill_recent),
            Submenu("&Examples", fill_examples),
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
            Submenu("Expor&t", fill_exports, "exports"),
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
            Submenu("&Layout", fill_layouts, "layouts"),
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
            Submenu("C&olour the profile", fill_colours, "colours"),
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
            Submenu("&Add to the loads", _later("window.linkage_menus", "fill_added"), "load rows"),
            Submenu("Ta&ke from the loads", _later("window.linkage_menus", "fill_taken"), "taken load rows"),
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
            Submenu("Export &picture", fill_pictures),
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
            Submenu("&Docks", fill_docks),
            Submenu("&Layers of the drawing", fill_layers),
            Submenu("&Named layouts", fill_named_layouts),
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
            Submenu("Tutoria&l", fill_tutorials),
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
