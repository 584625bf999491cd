"""Menus whose entries depend on the state of things; each is made anew when it opens."""

from __future__ import annotations

from functools import partial

from PySide6.QtGui import QActionGroup, QKeySequence
from PySide6.QtWidgets import QMenu

from core.design import FOLLOWER_KINDS, LAYOUTS
from core.project.reading_faults import subjects
from kindyna_gui.labels import choice_tip
from kindyna_gui.places import lessons
from kindyna_gui.window.base import Window
from kindyna_gui.window.docks import VIEWS
from kindyna_gui.window.titles import title_of, why_absent


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
    from kindyna_gui.motion.begin_dialog import BEGINNINGS, beginning_wanted

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
