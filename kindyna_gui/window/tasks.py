"""The tasks of the window: which views each one shows, on which side, and in which size.

A task is a layout and nothing more; every view can be shown in every task. The tasks are the modules of the program of
1995, with Study added.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from types import MappingProxyType

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction

from core.frozen import frozen
from kindyna_gui.window.base import Window
from kindyna_gui.window.docks import BOTTOM, CENTRE, LEFT, RIGHT, TOP, VIEWS

Area = Qt.DockWidgetArea

MOTION_CURVES = ("displacement", "velocity", "acceleration", "jerk")
CAM_CURVES = ("pressure_angle", "curvature")
FORCES = ("torque", "camshaft_speed", "contact_force", "contact_pressure", "contact", "vibration", "valve_springs")
CHECKS = ("findings", "certificate")
WIDE = 1800  # width of a window that has room for a column of docks on both sides [pixels]
INSPECTOR = 388
"""Width of the parameters in every task [pixels]."""
SEPARATOR = 5  # gap between the docks of a side and the middle [pixels]

# -- sides and groups of docks ---------------------------------------------------------------------------


@frozen
class DockGroup:
    """Docks in tabs at one position of a side.

    Attributes
    ----------
    names : tuple of str
        Docks open at first, the first one in front.
    more : tuple of str
        Docks that open here on request.
    part : float
        Share of the side's length, relative to the other groups.
    """

    area: Area
    names: tuple[str, ...] = ()
    more: tuple[str, ...] = ()
    part: float = 1.0


@frozen
class DockExtent:
    """Width or height of the docks of a side: a part of the window, at least ``least`` pixels."""

    part: float
    least: int = 0

    def size(self, total: int) -> int:
        """Extent [pixels] in a window of this width or height."""
        return max(self.least, 1, round(self.part * total))


DEFAULT_SIDES: Mapping[Area, DockExtent] = MappingProxyType(
    {
        LEFT: DockExtent(0.28, 384),
        RIGHT: DockExtent(0.0, INSPECTOR),
        TOP: DockExtent(0.42, 260),
        BOTTOM: DockExtent(0.23, 165),
    }
)
"""Width of the sides, height of top and bottom, unless a task gives its own."""

# -- tasks -----------------------------------------------------------------------------------------------


@frozen
class Task:
    """One layout.

    Attributes
    ----------
    large : str
        Main view, by its name in ``VIEWS``: a page in the middle, or a dock.
    groups : tuple of DockGroup
        Its docks; docks that no group names open in the last one.
    sides : Mapping of Area to DockExtent
    linkage_docks, shaft_docks : tuple of str
        Docks shown only with a linkage, or with several drives; the first one in front.
    section : str
        Section of the parameters in front when the task is first chosen; empty: no change.
    more_pages : tuple of str
        Pages in the middle, behind the main view.
    layers : tuple of str
        Layers of the drawing shown at first in this task.
    wide, wide_sides : as groups, sides
        Used in windows at least ``wide_from`` pixels wide; empty: as in others.
    by_hand : bool
        Whether the user has arranged it.
    """

    title: str
    tip: str
    large: str
    groups: tuple[DockGroup, ...]
    sides: Mapping[Area, DockExtent] = field(default_factory=lambda: DEFAULT_SIDES)
    linkage_docks: tuple[str, ...] = ()
    shaft_docks: tuple[str, ...] = ()
    section: str = ""
    more_pages: tuple[str, ...] = ()
    layers: tuple[str, ...] = ()
    wide: tuple[DockGroup, ...] = ()
    wide_sides: Mapping[Area, DockExtent] = field(default_factory=lambda: DEFAULT_SIDES)
    wide_from: int = WIDE
    by_hand: bool = False

    def at(self, width: int) -> Task:
        """Return the task for a window of this width."""
        return replace(self, groups=self.wide, sides=self.wide_sides) if self.is_wide(width) else self

    def is_wide(self, width: int) -> bool:
        """Whether the task has its wide layout in a window of this width."""
        return bool(self.wide) and width >= self.wide_from

    @property
    def kind_docks(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Docks shown only with a linkage, and docks shown only with several drives."""
        return self.linkage_docks, self.shaft_docks

    @property
    def pages(self) -> tuple[str, ...]:
        """Pages in the middle at first, the last one in front."""
        large = () if self.large == "mechanism" or VIEWS[self.large].area != CENTRE else (self.large,)
        return ("mechanism", *self.more_pages, *large)

    @property
    def all_docks(self) -> tuple[tuple[DockGroup, tuple[str, ...]], ...]:
        """Each group with all its docks, open or not."""
        named = {name for group in self.groups for name in (*group.names, *group.more)}
        others = tuple(name for name, row in VIEWS.items() if row.area != CENTRE and name not in named)
        last = self.groups[-1]
        return tuple((g, (*g.names, *g.more, *(others if g is last else ()))) for g in self.groups)


_WIDE_VIEWS = ("timing", "clearance", "compare", "explain")
"""Docks that need more width than the parameters."""

_PARAMETERS = DockGroup(RIGHT, ("parameters",), ("drives", "certificate"), 1.6)

_CLEAR = (
    DockGroup(LEFT, more=("find",)),
    DockGroup(LEFT, more=MOTION_CURVES),
    DockGroup(LEFT, more=CAM_CURVES),
    DockGroup(LEFT, more=FORCES),
    DockGroup(RIGHT, ("parameters",), ("motion", "drives")),
    DockGroup(BOTTOM, more=(*_WIDE_VIEWS, *CHECKS)),
)
"""Only the main view and the parameters; other docks open on request."""

TASKS: Mapping[str, Task] = MappingProxyType(
    {
        "make": Task(
            "&Make",
            "Design the motion: motion editor next to the mechanism",
            "motion",
            (
                DockGroup(RIGHT),
                DockGroup(LEFT, ("motion",), ("find",)),
                DockGroup(LEFT, part=0.5),
                DockGroup(TOP, ("parameters",), ("certificate", "pressure_angle")),
                DockGroup(BOTTOM, ("findings",)),
            ),
            MappingProxyType({**DEFAULT_SIDES, LEFT: DockExtent(1.0)}),
            wide=(
                DockGroup(LEFT, ("motion",), ("find",)),
                DockGroup(LEFT, part=0.5),
                DockGroup(RIGHT, ("parameters",), ("certificate", "pressure_angle")),
                DockGroup(BOTTOM, ("findings",)),
            ),
            wide_sides=MappingProxyType({**DEFAULT_SIDES, LEFT: DockExtent(0.52)}),
        ),
        "compo": Task(
            "&Compo",
            "Design the mechanism: its drawing next to lengths, centres and pressure angle",
            "mechanism",
            (
                DockGroup(LEFT, more=("motion", "find", "study")),
                DockGroup(BOTTOM, more=_WIDE_VIEWS),
                DockGroup(RIGHT, ("parameters",), ("find_linkage",), part=0.6),
                DockGroup(RIGHT, ("pressure_angle",), ("valve_figures",), part=0.4),
            ),
            linkage_docks=("centres", "circle"),
        ),
        "kine": Task(
            "&Kine",
            "Check the kinematics: the mechanism next to displacement, pressure angle and limits",
            "mechanism",
            (
                DockGroup(LEFT, more=("motion", "find", "study")),
                DockGroup(BOTTOM, more=_WIDE_VIEWS),
                _PARAMETERS,
                DockGroup(RIGHT, MOTION_CURVES),
                DockGroup(RIGHT, CAM_CURVES),
                DockGroup(RIGHT, ("findings",), part=0.2),
            ),
            shaft_docks=("drives",),
            wide=(
                DockGroup(LEFT, ("stack",), ("motion", "find", "study", *MOTION_CURVES)),
                DockGroup(BOTTOM, more=_WIDE_VIEWS),
                DockGroup(RIGHT, ("parameters",), ("certificate",), 1.6),
                DockGroup(RIGHT, more=("drives",), part=1.2),
                DockGroup(RIGHT, CAM_CURVES[1:], CAM_CURVES[:1]),
                DockGroup(RIGHT, ("findings",), part=0.2),
            ),
        ),
        "dyna": Task(
            "D&yna",
            "Check the forces: the mechanism next to torque, forces, loads and flywheel",
            "mechanism",
            (
                DockGroup(LEFT, more=("motion", "find", "study")),
                DockGroup(RIGHT, ("parameters", "flywheel", "findings"), ("drives", "valve_figures"), 1.7),
                DockGroup(RIGHT, ("torque",), ("camshaft_speed", "shaft_torque", "against_speed"), 1.7),
                DockGroup(BOTTOM, more=_WIDE_VIEWS),
                DockGroup(
                    RIGHT,
                    ("contact_force",),
                    ("contact_pressure", "contact", "vibration", "valve_springs", "shaft_figures"),
                    1.25,
                ),
            ),
            MappingProxyType({**DEFAULT_SIDES, BOTTOM: DockExtent(0.31, 226)}),
            shaft_docks=("drives", "timing", "shaft_torque", "against_speed", "shaft_figures"),
            section="loads",
            layers=("forces",),
            wide=(
                DockGroup(
                    LEFT, ("torque",), ("camshaft_speed", "shaft_torque", "against_speed", "motion", "find"), 1.15
                ),
                DockGroup(
                    LEFT,
                    ("contact_force",),
                    ("contact_pressure", "contact", "vibration", "valve_springs", "shaft_figures"),
                    1.15,
                ),
                DockGroup(BOTTOM, more=_WIDE_VIEWS),
                DockGroup(RIGHT, ("parameters", "flywheel", "findings"), part=1.2),
                DockGroup(RIGHT, more=("drives", "valve_figures"), part=0.7),
            ),
            wide_sides=MappingProxyType({**DEFAULT_SIDES, BOTTOM: DockExtent(0.31, 226)}),
        ),
        "stability": Task(
            "&Stability",
            "Check the flexible camshaft: stability chart with verdicts, wind-up and speeds",
            "stability",
            tuple(replace(group, names=(), more=(*group.names, *group.more)) for group in _CLEAR),
            wide=_CLEAR,
            wide_from=1400,
        ),
        "graph": Task(
            "&Graph",
            "Compare curves of channels, tables and other designs on one graph",
            "curves",
            _CLEAR,
            more_pages=("graph",),
        ),
        "study": Task(
            "St&udy",
            "Vary values of the design: map and board of the study next to the mechanism",
            "study",
            (
                DockGroup(RIGHT),
                DockGroup(LEFT, ("study",), ("motion", "find")),
                DockGroup(LEFT, part=0.5),
                DockGroup(TOP, ("parameters",)),
                DockGroup(BOTTOM, more=("pressure_angle", "torque", *CHECKS)),
            ),
            MappingProxyType({**DEFAULT_SIDES, LEFT: DockExtent(1.0)}),
            wide=(
                DockGroup(LEFT, ("study",), ("motion", "find")),
                DockGroup(LEFT, part=0.5),
                DockGroup(RIGHT, ("parameters",)),
                DockGroup(BOTTOM, more=("pressure_angle", "torque", *CHECKS)),
            ),
            wide_sides=MappingProxyType({**DEFAULT_SIDES, LEFT: DockExtent(0.52)}),
        ),
    }
)
"""Every task by the name that menus and settings use, in the order of buttons and keys."""


def task_with(name: str) -> str:
    """Return the first task whose first layout shows a view; else the first that has it in a tab, else the first."""
    for task, row in TASKS.items():
        if name in row.pages or any(name == group.names[0] for group in row.groups if group.names):
            return task
    behind = (
        task
        for task, row in TASKS.items()
        if name in row.shaft_docks or any(name in group.names for group in row.groups)
    )
    return next(behind, next(iter(TASKS)))


# -- layers of the drawing by task -------------------------------------------------------------------------

TASK_LAYERS = sorted({layer for row in TASKS.values() for layer in row.layers})


class TaskLayers:
    """Shows in each task of a window the layers last shown there; at first those of ``TASKS``."""

    def __init__(self, window: Window) -> None:
        self._window = window
        self._shown: dict[str, dict[str, bool]] = {}
        self._task = ""

    def show(self, task: str) -> None:
        """Note the layers of the previous task and show those of this one."""
        mechanism = self._window.view("mechanism")
        assert mechanism is not None
        actions = {
            layer: action
            for layer in TASK_LAYERS
            if (action := mechanism.findChild(QAction, f"layer:{layer}")) is not None
        }
        if self._task:
            self._shown[self._task] = {layer: action.isChecked() for layer, action in actions.items()}
        for layer, action in actions.items():
            action.setChecked(self._shown.get(task, {}).get(layer, layer in TASKS[task].layers))
        self._task = task
