"""The tasks of the window as a table: what each shows large, and which docks stand beside it, of what size.

They are the modules of the program of 1995. A task is a layout and nothing else: every view can be shown in every task.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from types import MappingProxyType

from PySide6.QtCore import Qt

from core.frozen import frozen
from kindyna_gui.window.docks import BOTTOM, CENTRE, LEFT, RIGHT, VIEWS

Area = Qt.DockWidgetArea

MOTION_CURVES = ("displacement", "velocity", "acceleration", "jerk")
CAM_CURVES = ("pressure_angle", "curvature")
FORCES = ("torque", "camshaft_speed", "contact_force", "contact_pressure", "contact", "vibration")
CHECKS = ("findings", "certificate")
FORMS = ("parameters", "motion")
ON_THE_LEFT = (*FORMS, "find")


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
    """How far the docks of a side reach into the window: a part of its width or height, so many pixels at least."""

    part: float
    least: int = 0

    def size(self, whole: int) -> int:
        """Pixels of a window of this width or height."""
        return max(self.least, round(self.part * whole))


USUAL: Mapping[Area, DockExtent] = MappingProxyType(
    {LEFT: DockExtent(0.25, 384), RIGHT: DockExtent(0.303), BOTTOM: DockExtent(0.23, 165)}
)
"""Width of the sides, height of the bottom, where a task does not say otherwise."""


@frozen
class Task:
    """One layout.

    large      the view for which it is made, by its name in ``VIEWS``: a page in the middle, or a dock
    groups     its docks; those that are not named come to the last one when they are asked for
    of_links   docks that are there with linkages only, the first of them in front
    of_several docks that are there with several drives only, likewise
    section    of the parameters, in front when the task is chosen; empty: the one that was
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


_CLEAR = (
    DockGroup(LEFT, more=ON_THE_LEFT),
    DockGroup(RIGHT, more=MOTION_CURVES),
    DockGroup(RIGHT, more=CAM_CURVES),
    DockGroup(RIGHT, more=FORCES),
    DockGroup(BOTTOM, more=CHECKS),
)
"""Nothing beside the large view but what is asked for."""

TASKS: Mapping[str, Task] = MappingProxyType(
    {
        "make": Task(
            "&Make",
            "Lay out the motion: the motion editor, with the mechanism beside it",
            "motion",
            (
                DockGroup(LEFT, ("motion",), ("find",)),
                DockGroup(BOTTOM, more=("parameters",)),
                DockGroup(BOTTOM, (*CHECKS, "pressure_angle")),
            ),
            MappingProxyType({**USUAL, LEFT: DockExtent(0.6875)}),
        ),
        "compo": Task(
            "&Compo",
            "Compose the mechanism: its drawing, with lengths, centres and pressure angle beside it",
            "mechanism",
            (
                DockGroup(LEFT, ("parameters",), ("motion", "find"), 0.6),
                DockGroup(LEFT, ("pressure_angle",), part=0.4),
            ),
            of_links=("centres", "circle"),
        ),
        "kine": Task(
            "&Kine",
            "See it move: the mechanism, with displacement, pressure angle and limits beside it",
            "mechanism",
            (
                DockGroup(LEFT, more=ON_THE_LEFT),
                DockGroup(RIGHT, MOTION_CURVES),
                DockGroup(RIGHT, CAM_CURVES),
                DockGroup(RIGHT, CHECKS, ("drives",), 0.7),
            ),
            of_several=("drives",),
        ),
        "dyna": Task(
            "D&yna",
            "Read forces: the mechanism, with torque, forces, loads and flywheel beside it",
            "mechanism",
            (
                DockGroup(LEFT, more=("motion", "find")),
                DockGroup(RIGHT, ("torque",), ("camshaft_speed", "shaft_torque", "against_speed"), 1.15),
                DockGroup(RIGHT, ("contact_force",), ("contact_pressure", "contact", "vibration", "shaft_figures")),
                DockGroup(BOTTOM, more=("timing",)),
                DockGroup(RIGHT, ("parameters", "flywheel", "findings"), ("drives",), 1.9),
            ),
            MappingProxyType({**USUAL, BOTTOM: DockExtent(0.31, 226)}),
            of_several=("drives", "timing", "shaft_torque", "against_speed", "shaft_figures"),
            section="loads",
            layers=("forces",),
        ),
        "stability": Task(
            "&Stability",
            "Judge the flexible camshaft: the chart of stability, with verdicts, wind-up and speeds below it",
            "stability",
            _CLEAR,
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
                DockGroup(BOTTOM, ("parameters",), ("pressure_angle", "torque", *CHECKS)),
            ),
            MappingProxyType({**USUAL, LEFT: DockExtent(0.62), BOTTOM: DockExtent(0.42, 260)}),
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


__all__ = ["TASKS", "DockExtent", "DockGroup", "Task", "task_with"]
