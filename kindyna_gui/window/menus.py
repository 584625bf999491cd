"""The menu bar, the toolbar and the row of tasks.

``MENUS`` has one row for each entry: its text, the slot of the window that it calls, its keys, tip and icon. Submenus
whose entries depend on the design or on files are filled each time they open.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib import import_module
from operator import attrgetter
from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QMenu, QToolBar, QWidget

from core.design import LAYOUTS
from core.design.follower_kinds import KIND_LABELS
from core.frozen import frozen
from core.project.reading_faults import subjects
from kindyna_gui.labels import choice_tip
from kindyna_gui.look import icon, tool_bar
from kindyna_gui.places import lessons
from kindyna_gui.rebuilt import add_entry, clear_menu
from kindyna_gui.window.base import Window, title_of, why_absent
from kindyna_gui.window.docks import VIEWS
from kindyna_gui.window.tasks import TASKS

Keys = QKeySequence.StandardKey
SEPARATOR = None

# -- submenus filled when they open ----------------------------------------------------------------------


def fill_new(window: Window, menu: QMenu) -> None:
    """Add an entry for each kind of design, and one for a shaft of several drives."""
    for slug, label in KIND_LABELS.items():
        add_entry(menu, label, partial(window.documents.new, slug), f"Begin a new design: {label}")
    add_entry(
        menu,
        "Linkage by drawing",
        partial(new_drawing, window),
        "Begin with an empty canvas and draw links, pins and sliders with the mouse",
    )
    for name, title, tip in MOTIONS:
        add_entry(menu, title, partial(new_motion, window, name), tip)
    add_entry(
        menu,
        "Camshaft...",
        partial(new_shaft, window),
        "Begin a camshaft with several drives: choose the first from images, add others in the list of drives",
    )
    add_entry(
        menu,
        "Valve train...",
        window.designing.new_valve_train,
        "Begin with inlet and exhaust valve by their cam card: durations, centres or opening and closing, lash, ratio",
    )


MOTIONS = (
    ("indexer", "Indexer...", "Begin with the motion of an indexing table: stops, index angle, dwell, law"),
    (
        "flying_shear",
        "Flying shear...",
        "Begin with the motion of a carriage that moves with its material: length, synchronous window, return",
    ),
)
"""Name in ``motion.laws_plot.NEW_MOTIONS``, entry of the menu and its tip."""


def new_motion(window: Window, name: str) -> None:
    """Begin a design with the motion of a dialog, which is imported only here."""
    from kindyna_gui.motion.laws_plot import NEW_MOTIONS, ask_new_motion

    if window.documents.may_leave():
        design = ask_new_motion(window, name)
        if design is not None:
            window.documents.begin(design, NEW_MOTIONS[name].title)


def new_shaft(window: Window) -> None:
    """Begin a shaft of several drives."""
    from kindyna_gui.window import shafts

    shafts.new_shaft(window)


def new_drawing(window: Window) -> None:
    """Begin with an empty canvas."""
    if window.documents.new_drawing():
        window.show_task("compo")
        window.draw(True, "bar")


def fill_recent(window: Window, menu: QMenu) -> None:
    """Add an entry for each file opened or saved recently."""
    for number, path in enumerate(window.settings.recent, 1):
        text, tip = f"&{number}  {_plain(path.name)}", str(path)
        add_entry(menu, text, partial(window.documents.open_path, path), tip).setToolTip(tip)
    empty = menu.isEmpty()
    menu.menuAction().setEnabled(not empty)
    if not empty:
        menu.addSeparator()
        add_entry(menu, "&Clear list", window.settings.clear_recent)


def fill_examples(window: Window, menu: QMenu) -> None:
    """Add the examples of the installation by subject, each with its paper."""
    from core.papers import PAPERS  # needed only once the menu opens

    for subject, rows in subjects():
        menu.addSection(_plain(subject))
        for row in rows:
            paper = PAPERS[row.paper].label if row.paper else ""
            text = _plain(f"{row.name}\t{paper}" if paper else row.name)
            add_entry(menu, text, partial(window.documents.open_example, row.path), row.text).setToolTip(row.text)


def fill_tutorials(window: Window, menu: QMenu) -> None:
    """Add an entry for each tutorial."""
    for name, title in lessons():
        add_entry(
            menu,
            title,
            partial(window.begin_tutorial, name),
            "Step by step in this window: shows what to do and where, and continues when a step is done",
        )


def fill_layouts(window: Window, menu: QMenu) -> None:
    """Add the layouts of the follower; the menu is hidden where its kind has none."""
    design = window.session.typed
    layout = getattr(design.drive.mechanism, "layout", None)
    menu.menuAction().setVisible(layout is not None)
    if layout is None:
        return
    group = QActionGroup(menu)
    for letter in LAYOUTS:
        action = add_entry(
            menu,
            f"&{letter}  {choice_tip(letter)}",
            partial(choose_layout, window, letter),
            f"Layout {letter}: {choice_tip(letter)}; moves pivot and guide to their sides",
            checked=letter == layout,
        )
        group.addAction(action)


def choose_layout(window: Window, letter: str) -> None:
    """Change the layout of the follower, as its field does."""
    window.session.edit("follower.layout", letter, f"Change layout to {letter}")
    window.session.end_gesture()


def fill_exports(window: Window, menu: QMenu) -> None:
    """Add an entry for each kind of file that can be exported."""
    if not window.session.has_laws:
        add_entry(menu, WAITS, lambda: None).setEnabled(False)
        return
    for row in window.exports.rows():
        in_bar = window.actions_by_key.get(f"exports.{row.act.__name__}")
        keys = in_bar.shortcut().toString(QKeySequence.SequenceFormat.NativeText) if in_bar is not None else ""
        text = f"{row.text}\t{keys}" if keys else row.text
        add_entry(menu, text, row.act, row.why_not or row.tip, enabled=not row.why_not)


def fill_pictures(window: Window, menu: QMenu) -> None:
    """Add an entry for each picture on the screen."""
    for name, row in VIEWS.items():
        view = window.view(name)
        if row.picture and view is not None and view.on_screen():
            title = title_of(name, window.session.design)
            tip = view.no_picture.replace("\n", " ") or f"Export the view {title} as PNG or SVG"
            add_entry(menu, f"{title}...", partial(window.export_picture, name), tip, enabled=not view.no_picture)
    menu.menuAction().setEnabled(not menu.isEmpty())


def fill_docks(window: Window, menu: QMenu) -> None:
    """Add an entry for each dock, checked while the dock is shown."""
    for dock in window.docks.values():
        action = dock.toggleViewAction()
        why = why_absent(dock.objectName(), window.session.design)
        action.setText(dock.title)  # Qt's is that of the tab
        action.setStatusTip(why or f"Show or hide {dock.title}")
        action.setEnabled(action.isChecked() or not why)
        menu.addAction(action)


def fill_named_layouts(window: Window, menu: QMenu) -> None:
    """Add the entry that saves the current layout, and for each saved layout those that restore and delete it."""
    tip = "Save docks, pages and task under a name, also for the next start"
    add_entry(menu, "&Save this layout...", window.save_layout, tip)
    names = window.settings.named_layouts
    if not names:
        return
    menu.addSeparator()
    for name in names:
        tip = f"Restore docks, pages and task saved as {name}"
        add_entry(menu, _plain(name), partial(window.restore_layout, name), tip)
    menu.addSeparator()
    for name in names:
        add_entry(menu, _plain(f"Delete {name}"), partial(window.delete_layout, name), f"Delete the layout {name}")


def fill_layers(window: Window, menu: QMenu) -> None:
    """Add an entry for each layer of the mechanism drawing."""
    view = window.view("mechanism")
    for action in view.layer_actions() if view is not None else ():
        menu.addAction(action)
    menu.menuAction().setVisible(not menu.isEmpty())


def fill_colours(window: Window, menu: QMenu) -> None:
    """Add the layers that colour the profile; the menu is hidden where there is no cam."""
    view = window.view("mechanism")
    for action in view.layer_actions() if view is not None else ():
        if action.actionGroup() is not None:
            menu.addAction(action)
    menu.menuAction().setVisible(not menu.isEmpty())


def _plain(text: str) -> str:
    """Return a text in which & is no access key."""
    return text.replace("&", "&&")


# -- rows of the menu bar --------------------------------------------------------------------------------


@frozen
class Item:
    """One entry of a menu.

    Attributes
    ----------
    slot : str
        Dotted path of the method called, from the window: ``documents.save``.
    argument : Any
        Its argument; None to call it without one.
    name : str
        Key of the action; empty: the slot and its argument.
    view : str
        View, by its name in ``VIEWS``, in which the keys act; empty: everywhere.
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
    """A menu whose entries ``fill`` adds each time it opens."""

    text: str
    fill: Callable[[Window, QMenu], None]
    name: str = ""


def _later(module: str, name: str) -> Callable[[Window, QMenu], None]:
    """Return a function that fills a menu; its module is imported when the menu first opens."""

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


Entry = Item | Submenu | None

MENUS: tuple[tuple[str, tuple[Entry, ...]], ...] = (
    (
        "&File",
        (
            Item("&New...", "designing.new_by_picture", None, Keys.New,
                 "Begin a new design: choose a follower with its face and cam form, a cam in space, or a linkage, from images"),
            Submenu("New b&y type", fill_new, "new"),
            Item("&Open...", "documents.open_file", None, Keys.Open, "Open a design file", "open"),
            Submenu("Open &recent", fill_recent),
            Submenu("&Examples", fill_examples),
            SEPARATOR,
            Item("&Save", "documents.save", None, Keys.Save, "Save the design to its file", "save"),
            Item("Re&load", "documents.reload", None, None, "Reload the file from disk (can be undone)"),
            Item("Save &as...", "documents.save_as", None, Keys.SaveAs, "Save the design to another file"),
            Item("Reco&ver unsaved work...", "recovery.offer_again", None, None,
                 "Restore work that was unsaved when KINDYNA ended without being closed"),
            SEPARATOR,
            Item("Add this desi&gn to a shaft...", "add_to_shaft", None, None,
                 "Put this design on a shaft with other drives"),
            Item("&Import measured motion...", "designing.import_measured", None, None,
                 "Fit a motion to a table of measured displacements, velocities or accelerations"),
            Item("I&mport linkage...", "designing.import_linkage", None, None,
                 "Import a linkage of Pyslvs, PMKS+ or Linkage from text, web address or file; parts that cannot be imported are listed"),
            Item("Import &controller table...", "designing.import_controller", None, None,
                 "Import the table of a servo controller as the motion that results from the controller's interpolation"),
            Submenu("Expor&t", fill_exports, "exports"),
            Item("Re&port...", "exports.report", None, "Ctrl+P",
                 "Write a report as PDF or HTML: inputs, drawings, curves, extremes, findings, certificate, equations"),
            SEPARATOR,
            Item("&Quit", "close", None, "Ctrl+Q", "Close KINDYNA"),
        ),
    ),
    (
        "&Edit",
        (
            Item("&Undo", "session.stack.undo", None, Keys.Undo, "Undo the last change", "undo", name="undo"),
            Item("&Redo", "session.stack.redo", None, Keys.Redo, "Repeat the change that was undone", "redo", name="redo"),
            SEPARATOR,
            Item("&Copy picture", "copy_picture", None, "Ctrl+Shift+C", "Copy the selected view as a picture"),
            SEPARATOR,
            Item("&Pin this variant", "pin", None, "Ctrl+Shift+P",
                 "Pin the current design: dashed in plots, grey in the drawing, listed in What changed"),
            Item("Compare with the &last step", "pin_before", None, None,
                 "Show the design before the last change, dashed, in every plot"),
            Item("Compare with another &file...", "pin_file", None, None, "Show the design of another file, dashed, in every plot"),
            Item("Unp&in", "unpin", None, None, "Stop comparing with the pinned variant"),
            _view("compare"),
            Item("&Explain a number", "explain_here", None, "Shift+F1", VIEWS["explain"].tip),
            SEPARATOR,
            Item("Find an&ything...", "find_anything", None, "Ctrl+K",
                 "Search commands, fields, channels, examples, help and findings; a value after the name of a field sets it"),
            Item("&Scale the design...", "designing.scale", None, None,
                 "Multiply all lengths by one factor, and masses and inertias if you choose"),
            Item("Prefere&nces...", "prefer", None, "Ctrl+,",
                 "Units, decimal sign, theme, font size, paper size, author, company, logo"),
        ),
    ),
    (
        "&Make",
        (
            _view("motion"),
            _view("laws"),
            Item("&Blend...", "designing.blend", None, "Ctrl+B", "Build a motion from standard curves that join smoothly"),
            Item("Blend a se&quence...", "designing.blend_sequence", None, None,
                 "Join any number of curves, each with its own settings"),
            Item("Motion &from a DXF curve...", "designing.motion_from_curve", None, None,
                 "Calculate the motion of a follower on a closed curve of lines and arcs: tangent cam, three-arc cam, digitised cam"),
            SEPARATOR,
            _segment("&Insert segment", "insert", "Ctrl+I", "Insert a dwell after the selected segment"),
            Item("Insert befor&e", "designing.segment", "insert_before", None, "Insert a dwell before the selected segment", "insert",
                 view="motion"),
            _segment("S&plit segment", "split", "Ctrl+Shift+I", "Split the segment at the current cam angle"),
            _segment("D&uplicate segment", "duplicate", "Ctrl+Shift+D", "Insert a copy after the selected segment"),
            _segment("Mi&rror stroke", "mirror", "Ctrl+Shift+M", "Make the return the mirror image of the rise"),
            _segment("&Delete segment", "delete", "Ctrl+D", "Delete the selected segment"),
            SEPARATOR,
            Item("Se&gment from table...", "designing.segment_from_table", None, None,
                 "Replace the selected segment by the first two columns of a table, fitted to its span and rise or unchanged"),
            Item("Segment from &clipboard", "designing.segment_from_clipboard", None, None,
                 "Replace the selected segment by two columns copied from a spreadsheet"),
            Item("S&hift the motion by...", "designing.shift_motion", None, None,
                 "Shift the whole motion in cam angle; or drag the segment names"),
            Item("Sa&ve motion...", "designing.save_motion", None, None, "Save the motion without the mechanism in a file"),
            Item("Motion from a desig&n or file...", "designing.take_motion", None, None,
                 "Replace the motion by that of another design's drive, or of a motion file"),
            Item("Motion that follo&ws from files...", "designing.follow_files", None, None,
                 "Link the motion to files: a table, a sum of motions, or the inverse of a linkage; updated when the files change"),
            Item("L&obe to segments", "designing.lobe_to_segments", None, None,
                 "Replace the lobe of a valve train by the segments that it gives, which can then be edited"),
            SEPARATOR,
            _field("&Start", "motion.start", "Edit the position of the follower at cam angle 0"),
            _field("S&troke", "motion.stroke", "Edit the stroke: highest minus lowest position of the follower"),
        ),
    ),
    (
        "&Compo",
        (
            _view("mechanism"),
            Item("Dra&w", "draw", None, "D", "Draw links, pins, sliders and loads with the mouse; D or Esc ends drawing", checkable=True,
                 name="draw", view="mechanism"),
            Submenu("Drawi&ng", _later("window.linkage_menus", "fill_drawing"), "drawing"),
            Item("Underla&y...", "place_underlay", None, None,
                 "Place an image or a DXF under the drawing, scale it by a known distance, and draw on its corners and centres"),
            Item("Circ&uits...", "designing.choose_circuit", None, None,
                 "Choose the circuit in which the linkage is assembled, from images with the range of the driver"),
            Item("&Save as signs", "designing.save_as_signs", None, None,
                 "Store the assembly as branch signs (+1/\u22121) instead of the drawn pose"),
            SEPARATOR,
            Item("C&hoose a mechanism...", "designing.choose_mechanism", None, None,
                 "Begin with another follower, cam form or linkage, chosen from images; the motion is kept"),
            _view("find_linkage"),
            Item("V&alve train...", "designing.edit_valve_train", None, None,
                 "Edit inlet and exhaust valve by their cam card, with lift, velocity, acceleration and timing diagram"),
            _view("valve_figures"),
            SEPARATOR,
            _field("&Follower", "follower", "Edit the dimensions of the follower"),
            _field("&Cam", "cam", "Edit base circle and roller"),
            Submenu("&Layout", fill_layouts, "layouts"),
            Submenu("Driv&er", _later("window.linkage_menus", "fill_drivers"), "drivers"),
            Submenu("Cam &roller", _later("window.linkage_menus", "fill_rollers"), "rollers"),
            _field("Lin&kage", "linkage", "Edit dimensions, driver and assembly of the linkage"),
            SEPARATOR,
            _view("centres"),
            Item("Fit cen&tres", "fit_centres", None, None,
                 "Show the instant centres of all links, and zoom to all of them"),
            Item("Velocity &polygon", "show_polygon", "velocities", None,
                 "Draw the velocities from one pole, V_P = V_A + V_PA, at the current angle"),
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
            _field("Li&mits", "limits", "Edit your limits of pressure angle, radius of curvature and contact force"),
            _view("find"),
            _view("study"),
            _view("clearance"),
            Submenu("C&olour the profile", fill_colours, "colours"),
            Item("&Inspect a measured cam...", "designing.inspect_measured", None, None,
                 "Compare a measured table of lift with the profile: deviations, the largest one, in or out of tolerance"),
            SEPARATOR,
            Item("P&lay", "player.play", None, "F5", "Play or stop the motion", checkable=True, name="play"),
            Item("Step &forward", "player.step", 1.0, "F7", "Turn one degree forward"),
            Item("Step &back", "player.step", -1.0, "F6", "Turn one degree back"),
            Item("Play bac&kwards", "reverse", None, "F8", "Play the motion backwards", checkable=True),
        ),
    ),
    (
        "&Dyna",
        (
            _view("drives"),
            _field("&Loads", "loads", "Edit masses, springs and forces"),
            Submenu("&Add to the loads", _later("window.linkage_menus", "fill_additions"), "load rows"),
            Submenu("Remo&ve from the loads", _later("window.linkage_menus", "fill_removals"), "taken load rows"),
            Item("&Find closing spring", "show_search", "spring", None,
                 "Calculate the smallest spring rate that keeps the follower on the cam, and plot it against the preload"),
            SEPARATOR,
            _view("contact_force"),
            _view("contact"),
            Item("Force pol&ygon", "show_polygon", "body", None,
                 "Draw all forces on one body at the current angle, or the force in a pin or guide over the turn"),
            _view("vibration"),
            _view("valve_springs"),
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
            Item("Add a s&haft", "designing.give_shaft", None, None,
                 "Add a shaft to a linkage, with flywheel and motor; with a cam, stability is calculated too"),
            Item("A&dd a servo", "designing.give_servo", None, None,
                 "Add a servo motor that drives the motion directly; its torque, speed and power are compared with those of the camshaft"),
            Item("R&emove the servo", "designing.take_servo", None, None, "Remove the servo from the drive"),
        ),
    ),
    (
        "&Stability",
        (
            _view("stability"),
            Item("&Flexible shaft", "designing.make_flexible", None, None,
                 "Give the camshaft a stiffness and an inertia, estimated from its loads"),
            Item("&Rigid shaft", "designing.make_rigid", None, None, "Calculate with a rigid camshaft again"),
            Item("Add a s&haft", "designing.give_shaft", None, None,
                 "Add a shaft to a linkage, with flywheel and motor; with a cam, stability is calculated too"),
            SEPARATOR,
            _field("Camshaft &data", "shaft", "Edit speed, sense of rotation, flywheel and motor of the camshaft"),
        ),
    ),
    (
        "&Graph",
        (
            _view("curves"),
            _view("graph"),
            _view("space"),
            _view("surface"),
            SEPARATOR,
            Submenu("Export &picture", fill_pictures),
            Item("Export &numbers...", "exports.tables", None, "Ctrl+E",
                 "Export profile, kinematics and dynamics as CSV tables", "export"),
            Item("Export pr&ofile...", "exports.profile", None, "Ctrl+Shift+E",
                 "Export the cam profile, or the path of a cutter, as DXF, SVG, CSV or G-code"),
            Item("Export sol&id and surfaces...", "exports.surfaces", None, "",
                 "Export the solid cam or its flanks as STEP, STL or CSV, or the G-code of a barrel cam's groove"),
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
            Item("&Fit drawing", "fit", None, "Ctrl+0", "Zoom to the whole mechanism", "fit"),
            Item("&Reset layout", "reset_layout", None, None, "Restore the default layout of this task"),
        ),
    ),
    (
        "&Help",
        (
            Item("&Welcome", "show_welcome", None, None, "Open the welcome page: examples by subject, new design, recent files"),
            Item("Help on this fiel&d or view", "help_here", None, Keys.HelpContents, "Open the help of the current field or view", "help"),
            Item("Shortc&uts", "show_help", "shortcuts", None, "Every key of the window"),
            Submenu("Tutoria&l", fill_tutorials),
            Item("&Tour", "show_help", "tour", None, "The window in five minutes"),
            Item("&Making a motion", "show_help", "making", None, "The motion editor by mouse and keyboard; measured tables"),
            Item("&Blended motions", "show_help", "blending", None, "Which curve may follow which; the card picker as an example"),
            Item("T&iming of several drives", "show_help", "timing", None, "The timing chart by mouse; sequence conditions"),
            Item("Valve trains of &4-stroke engines", "show_help", "valves", None, "From a cam card to both valves over the crank"),
            Item("&Followers", "show_help", "followers", None, "Cam slider, translating and swinging followers"),
            Item("Fi&nding dimensions", "show_help", "finding", None, "The smallest dimension within your limits, or the best one"),
            Item("Studies of man&y designs", "show_help", "studies", None, "Tables of many designs, tolerances, the best design"),
            Item("Lin&kages", "show_help", "linkages", None, "Links, pins and guides; centres and velocities"),
            Item("&Stability of the camshaft", "show_help", "stability", None, "Chart and verdicts; the claims of Kim (1990) checked"),
            Item("Figures of the &papers...", "show_papers", None, None, "Figures and statements of the papers, compared with KINDYNA"),
            Item("T&he four papers", "show_help", "papers", None, "The papers: claims checked, and misprints"),
            Item("C&ontrollers", "show_help", "controllers", None, "Electronic cams: tables for servo controllers, and their errors"),
            Item("Laws and con&ventions", "show_help", "laws", None, "Motion laws, signs, units, angles"),
            Item("&Run time against error", "show_help", "speed", None, "Speed and accuracy compared with alternatives"),
            Item("Ar&chitecture", "show_help", "architecture", None, "The layers of the program, and how its results are checked"),
            Item("What has chang&ed", "show_help", "changes", None, "What is new in each version"),
            SEPARATOR,
            _view("log"),
            Item("&About KINDYNA", "about", None, None, "Version and origin of KINDYNA"),
        ),
    ),
)  # fmt: skip

TOOLBAR = ("documents.open_file", "documents.save", None, "undo", "redo", None, "fit", "show_view:graph")


def build(window: Window) -> dict[str, QAction]:
    """Fill the window's menu bar and return its actions by key; those of menus by their text.

    The window must store them all: once Python drops a menu's action, PySide takes the menu for deleted.
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

    def trigger(on: bool) -> None:
        if _must_wait(window, item.slot):
            window.status.show_message(WAITS)
        elif item.checkable:
            slot(window)(on)
        elif item.argument is None:
            slot(window)()
        else:
            slot(window)(item.argument)

    action.triggered.connect(trigger)
    return action


WAITS = "The laws of the motion are being calculated; this is possible once they are known"
BEGINNINGS = ("designing.new_by_picture", "designing.import_linkage")


def _must_wait(window: Window, slot: str) -> bool:
    """Whether an entry reads results or edits the design, whose laws are not known yet."""
    reads = slot.startswith(("exports.", "designing.", "pin")) and slot not in BEGINNINGS
    return reads and not window.session.has_laws


def add_view_keys(view: QWidget, name: str, actions: dict[str, QAction]) -> None:
    """Give a view, named as in ``VIEWS``, the shortcuts that act only in it."""
    rows = (row for _, entries in MENUS for row in entries if isinstance(row, Item) and row.view == name)
    view.addActions([actions[row.key] for row in rows])


def _add_submenu(window: Window, menu: QMenu, row: Submenu, actions: dict[str, QAction]) -> None:
    submenu = menu.addMenu(row.text)
    submenu.setToolTipsVisible(True)

    def refill() -> None:
        clear_menu(submenu)
        row.fill(window, submenu)

    # also with the menu above it, so that an empty one can be greyed or hidden
    menu.aboutToShow.connect(refill)
    submenu.aboutToShow.connect(refill)
    actions[row.name or row.text] = submenu.menuAction()


def build_toolbar(window: Window, actions: dict[str, QAction]) -> QToolBar:
    """Build the toolbar from some of the menus' actions."""
    bar = tool_bar("Toolbar")
    bar.setObjectName("toolbar")
    for key in TOOLBAR:
        if key is None:
            bar.addSeparator()
        else:
            bar.addAction(actions[key])
    return bar


def build_tasks(window: Window, actions: dict[str, QAction]) -> QToolBar:
    """Build the row of tasks: entries of the View menu as buttons, of which one is checked."""
    bar = tool_bar("Tasks")
    bar.setObjectName("tasks")
    bar.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
    bar.toggleViewAction().setVisible(False)  # hidden buttons would leave no visible path to another task
    group = QActionGroup(window)
    for name in TASKS:
        action = actions[f"show_task:{name}"]
        action.setCheckable(True)
        group.addAction(action)
        bar.addAction(action)
    return bar
