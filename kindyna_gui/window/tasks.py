"""TASKS."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from types import MappingProxyType

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction

from core.frozen import frozen
from kindyna_gui.window.base import Window
from kindyna_gui.window.docks import BOTTOM, CENTRE, LEFT, RIGHT, TOP, VIEWS

# -- tasks -----------------------------------------------------------------------------------------------

# They are the modules of the program of 1995. A task is a layout and nothing else: every view can be shown in every task.

Area = Qt.DockWidgetArea

MOTION_CURVES = ("displacement", "velocity", "acceleration", "jerk")
CAM_CURVES = ("pressure_angle", "curvature")
FORCES = ("torque", "camshaft_speed", "contact_force", "contact_pressure", "contact", "vibration")
CHECKS = ("findings", "certificate")
WIDE = 1800  # pixels of a window's width, from which on there is room for a column on both sides


@frozen
class DockGroup:
    """Docks behind each other at one place.

    names   those that are there at first, the first in front
    more    those that come here when they are asked for
    part    of the length of its side, next to those of the other groups
    """

    area: Area
    names: tuple[str, ...] = ()
    more: tuple[str, ...] = ()
    part: float = 1.0


@frozen
class DockExtent:
    """How far the docks of a side reach into the window: a part of its width or height, so many pixels at least; ``less`` what is left
    beside them."""

    part: float
    least: int = 0
    less: int = 0

    def size(self, whole: int) -> int:
        """Pixels of a window of this width or height."""
        return max(self.least, 1, round(self.part * whole) - self.less)


INSPECTOR = 388
"""Width of the parameters in every task [pixels]."""

SEPARATOR = 5  # pixels between the docks of a side and what stands beside them

USUAL: Mapping[Area, DockExtent] = MappingProxyType(
    {
        LEFT: DockExtent(0.28, 384),
        RIGHT: DockExtent(0.0, INSPECTOR),
        TOP: DockExtent(0.42, 260),
        BOTTOM: DockExtent(0.23, 165),
    }
)
"""Width of the sides, height of top and bottom, where a task does not say otherwise."""


@frozen
class Task:
    """One layout.

    large      the view for which it is made, by its name in ``VIEWS``: a page in the middle, or a dock
    groups     its docks; those that are not named come to the last one when they are asked for
    of_links   docks that are there with linkages only, the first of them in front
    of_several docks that are there with several drives only, likewise
    section    of the parameters, in front when the task is first chosen; empty: the one that was
    wide       groups and sides in a window of ``wide_from`` pixels and more; empty: the same
    beside     pages in the middle behind the large view
    layers     of the drawing, shown at first while the task is in place
    """

    title: str
    tip: str
    large: str
    groups: tuple[DockGroup, ...]
    sides: Mapping[Area, DockExtent] = field(default_factory=lambda: USUAL)
    of_links: tuple[str, ...] = ()
    of_several: tuple[str, ...] = ()
    section: str = ""
    beside: tuple[str, ...] = ()
    layers: tuple[str, ...] = ()
    wide: tuple[DockGroup, ...] = ()
    wide_sides: Mapping[Area, DockExtent] = field(default_factory=lambda: USUAL)
    wide_from: int = WIDE

    def at(self, width: int) -> Task:
        """The row as it is in a window of this width."""
        return replace(self, groups=self.wide, sides=self.wide_sides) if self.is_wide(width) else self

    def is_wide(self, width: int) -> bool:
        """Whether a window of this width has what stands in wide ones."""
        return bool(self.wide) and width >= self.wide_from

    @property
    def of_kinds(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """The docks that are there with linkages, and those with several drives."""
        return self.of_links, self.of_several

    @property
    def pages(self) -> tuple[str, ...]:
        """The pages in the middle at first."""
        own = () if self.large == "mechanism" or VIEWS[self.large].area != CENTRE else (self.large,)
        return ("mechanism", *self.beside, *own)

    @property
    def front(self) -> str:
        """The page in front at first."""
        return self.pages[-1]

    @property
    def places(self) -> tuple[tuple[DockGroup, tuple[str, ...]], ...]:
        """Each group with all its docks."""
        named = {name for group in self.groups for name in (*group.names, *group.more)}
        others = tuple(name for name, row in VIEWS.items() if row.area != CENTRE and name not in named)
        last = self.groups[-1]
        return tuple((g, (*g.names, *g.more, *(others if g is last else ()))) for g in self.groups)


_PARAMETERS = DockGroup(RIGHT, ("parameters",), ("drives", "certificate"), 1.6)

_CLEAR = (
    DockGroup(LEFT, more=("find",)),
    DockGroup(LEFT, more=MOTION_CURVES),
    DockGroup(LEFT, more=CAM_CURVES),
    DockGroup(LEFT, more=FORCES),
    DockGroup(RIGHT, ("parameters",), ("motion", "drives")),
    DockGroup(BOTTOM, more=CHECKS),
)
"""Nothing beside the large view and the parameters but what is asked for."""

TASKS: Mapping[str, Task] = MappingProxyType(
    {
        "make": Task(
            "&Make",
            "Lay out the motion: the motion editor, with the mechanism beside it",
            "motion",
            (
                DockGroup(LEFT, ("motion",), ("find",)),
                DockGroup(TOP, ("parameters",), ("certificate", "pressure_angle")),
                DockGroup(BOTTOM, ("findings",)),
            ),
            MappingProxyType({**USUAL, LEFT: DockExtent(1.0, less=INSPECTOR + SEPARATOR)}),
            wide=(
                DockGroup(LEFT, ("motion",), ("find",)),
                DockGroup(RIGHT, ("parameters",), ("certificate", "pressure_angle")),
                DockGroup(BOTTOM, ("findings",)),
            ),
            wide_sides=MappingProxyType({**USUAL, LEFT: DockExtent(0.52)}),
        ),
        "compo": Task(
            "&Compo",
            "Compose the mechanism: its drawing, with lengths, centres and pressure angle beside it",
            "mechanism",
            (
                DockGroup(RIGHT, ("parameters",), ("motion", "find"), 0.6),
                DockGroup(RIGHT, ("pressure_angle",), part=0.4),
            ),
            of_links=("centres", "circle"),
        ),
        "kine": Task(
            "&Kine",
            "See it move: the mechanism, with displacement, pressure angle and limits beside it",
            "mechanism",
            (
                DockGroup(LEFT, more=("motion", "find")),
                _PARAMETERS,
                DockGroup(RIGHT, MOTION_CURVES),
                DockGroup(RIGHT, CAM_CURVES),
                DockGroup(RIGHT, ("findings",), part=0.2),
            ),
            of_several=("drives",),
            wide=(
                DockGroup(LEFT, ("stack",), ("motion", "find", *MOTION_CURVES)),
                DockGroup(RIGHT, ("parameters",), ("certificate",), 1.6),
                DockGroup(RIGHT, more=("drives",), part=1.2),
                DockGroup(RIGHT, CAM_CURVES[1:], CAM_CURVES[:1]),
                DockGroup(RIGHT, ("findings",), part=0.2),
            ),
        ),
        "dyna": Task(
            "D&yna",
            "Read forces: the mechanism, with torque, forces, loads and flywheel beside it",
            "mechanism",
            (
                DockGroup(LEFT, more=("motion", "find")),
                DockGroup(RIGHT, ("parameters", "flywheel", "findings"), ("drives",), 1.7),
                DockGroup(RIGHT, ("torque",), ("camshaft_speed", "shaft_torque", "against_speed"), 1.7),
                DockGroup(BOTTOM, more=("timing",)),
                DockGroup(
                    RIGHT, ("contact_force",), ("contact_pressure", "contact", "vibration", "shaft_figures"), 1.25
                ),
            ),
            MappingProxyType({**USUAL, BOTTOM: DockExtent(0.31, 226)}),
            of_several=("drives", "timing", "shaft_torque", "against_speed", "shaft_figures"),
            section="loads",
            layers=("forces",),
            wide=(
                DockGroup(
                    LEFT, ("torque",), ("camshaft_speed", "shaft_torque", "against_speed", "motion", "find"), 1.15
                ),
                DockGroup(
                    LEFT, ("contact_force",), ("contact_pressure", "contact", "vibration", "shaft_figures"), 1.15
                ),
                DockGroup(BOTTOM, more=("timing",)),
                DockGroup(RIGHT, ("parameters", "flywheel", "findings"), part=1.2),
                DockGroup(RIGHT, more=("drives",), part=0.7),
            ),
            wide_sides=MappingProxyType({**USUAL, BOTTOM: DockExtent(0.31, 226)}),
        ),
        "stability": Task(
            "&Stability",
            "Judge the flexible camshaft: the chart of stability, with verdicts, wind-up and speeds below it",
            "stability",
            tuple(replace(group, names=(), more=(*group.names, *group.more)) for group in _CLEAR),
            wide=_CLEAR,
            wide_from=1400,
        ),
        "graph": Task(
            "&Graph",
            "Compare curves: channels, tables and other designs on one graph, as pictures and files",
            "curves",
            _CLEAR,
            beside=("graph",),
        ),
        "study": Task(
            "St&udy",
            "Vary numbers of the design: map and board of the study, with the mechanism and its numbers beside it",
            "study",
            (
                DockGroup(LEFT, ("study",), ("motion", "find")),
                DockGroup(TOP, ("parameters",)),
                DockGroup(BOTTOM, more=("pressure_angle", "torque", *CHECKS)),
            ),
            MappingProxyType({**USUAL, LEFT: DockExtent(1.0, less=INSPECTOR + SEPARATOR)}),
            wide=(
                DockGroup(LEFT, ("study",), ("motion", "find")),
                DockGroup(RIGHT, ("parameters",)),
                DockGroup(BOTTOM, more=("pressure_angle", "torque", *CHECKS)),
            ),
            wide_sides=MappingProxyType({**USUAL, LEFT: DockExtent(0.52)}),
        ),
    }
)
"""Every task by the name that menus and settings use, in the order of their buttons and keys."""


def task_with(name: str) -> str:
    """The first task in whose first layout a view can be seen; the first of all where there is none."""
    for task, row in TASKS.items():
        if name in row.pages or any(name == group.names[0] for group in row.groups if group.names):
            return task
    behind = (
        task
        for task, row in TASKS.items()
        if name in row.of_several or any(name in group.names for group in row.groups)
    )
    return next(behind, next(iter(TASKS)))


# -- task layers -----------------------------------------------------------------------------------------

ASKED_FOR = sorted({layer for row in TASKS.values() for layer in row.layers})


class TaskLayers:
    """Of one window; at first as the rows of ``TASKS`` have it."""

    def __init__(self, window: Window) -> None:
        self._window = window
        self._left: dict[str, dict[str, bool]] = {}
        self._task = ""

    def show(self, task: str) -> None:
        """A task is in place."""
        mechanism = self._window.view("mechanism")
        assert mechanism is not None
        actions = {
            layer: action
            for layer in ASKED_FOR
            if (action := mechanism.findChild(QAction, f"layer:{layer}")) is not None
        }
        if self._task:
            self._left[self._task] = {layer: action.isChecked() for layer, action in actions.items()}
        for layer, action in actions.items():
            action.setChecked(self._left.get(task, {}).get(layer, layer in TASKS[task].layers))
        self._task = task
