"""The commands of the command line, one row each; the module of a command is imported when the command runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeAlias

from core.frozen import frozen
from core.process import without_garbage_collection

if TYPE_CHECKING:
    from core.output.graph.curves import GraphImage
    from core.output.position import Snapshot
    from core.output.report.document import Printed
    from core.papers import Drawing
    from core.stability import Chart, Figure
    from core.study import Study

DONE, DONE_WITH_ERRORS, NOTHING_DONE = 0, 1, 2
"""Exit codes: done; done and all files written, but a finding is an error; nothing done."""

Drawn: TypeAlias = "Study | Snapshot | Chart | Figure | GraphImage | Drawing | Printed"
"""Subjects of pictures: a study, a linkage at one angle, a chart or figure of stability, a graph, a figure of a paper, a report."""

Painter = Callable[[Drawn], Mapping[str, bytes]]
"""Paints a subject: file name -> content, of a report its ending -> content; empty where it cannot paint it, with a message."""


@frozen
class Command:
    """A command of the command line.

    Attributes
    ----------
    help : in one line
    arguments : function that imports and returns the dataclass of its arguments
    run : runs the command with its arguments and a painter, and returns the exit code
    """

    help: str
    arguments: Callable[[], type]
    run: Callable[[Any, Painter | None], int]


def _row(help: str, module: str, name: str) -> Command:
    """The command of a module of this package: its class ``<Name>Arguments`` and its function ``run_<name>``."""

    def attribute(spelled: str) -> Any:
        with without_garbage_collection():
            return getattr(import_module(f"{__name__}.{module}"), spelled)

    def run(arguments: Any, painter: Painter | None) -> int:
        code: int = attribute(f"run_{name}")(arguments, painter)
        return code

    return Command(help, lambda: attribute("".join(word.title() for word in name.split("_")) + "Arguments"), run)


COMMANDS: Mapping[str, Command] = MappingProxyType(
    {
        "check": _row("findings and proof of a design", "check", "check"),
        "report": _row("report of a design", "designs", "report"),
        "export": _row("tables as CSV and figures as JSON", "export", "export"),
        "profile": _row("the cam's profile, or its cutter's path, as CSV, DXF, SVG or G-code", "cams", "profile"),
        "surface": _row(
            "the surfaces of a cam or its solid, with bore, keyway and hub, as STEP, STL or CSV", "surfaces", "surface"
        ),
        "ecam": _row("a table for a servo controller, and the error of the controller's curve", "tables", "ecam"),
        "inspection": _row(
            "the lift that a probe measures on the cam, and whether a measured table keeps its tolerance",
            "cams",
            "inspection",
        ),
        "find": _row(
            "a dimension that just keeps its limits: base radius, offset, roller, span, face, pivot, arm, spring",
            "find",
            "find",
        ),
        "optimise": _row(
            "the best design of a study within its limits: any fields, one goal, or two and their front",
            "studies",
            "optimise",
        ),
        "tolerance": _row(
            "effect of tolerances: sensitivities, worst case, share of machines within limits, bands",
            "studies",
            "tolerance",
        ),
        "vary": _row("a table of many designs with varied fields", "studies", "vary"),
        "clearance": _row(
            "the least clearances of bodies with outlines over the turn, proven, and where they meet",
            "clearance",
            "clearance",
        ),
        "contact": _row(
            "the speed from which the follower leaves its cam, its flights, the contact force over angle and speed",
            "cams",
            "contact",
        ),
        "vibration": _row(
            "how an elastic follower vibrates in its dwells, and its response spectrum over speeds", "cams", "vibration"
        ),
        "valve": _row(
            "the valves of a valve train on the crank: events, overlap, velocities, radii, and a lift table",
            "valves",
            "valve",
        ),
        "centres": _row("instant centres and velocities of a linkage at one position", "linkages", "centres"),
        "compare": _row(
            "comparison of two designs: inputs that differ, results of both, new and removed findings",
            "designs",
            "compare",
        ),
        "explain": _row(
            "the origin of a number: its equation, with the values of its symbols and their origin",
            "designs",
            "explain",
        ),
        "graph": _row(
            "curves of tables and designs on one graph, as PNG, SVG, PDF or CSV, their differences and values",
            "graph",
            "graph",
        ),
        "laws": _row("the motion laws and their peak coefficients", "motions", "laws"),
        "blend": _row("a motion blended from elementary curves", "motions", "blend"),
        "motion": _row(
            "the motion of a design as a file or in another design, shifted in its turn", "motions", "motion"
        ),
        "indexer": _row("an indexer as a design: stops, index angle, dwell and law", "motions", "indexer"),
        "flying-shear": _row(
            "a flying shear as a design: length of a cut, synchronous window, return", "motions", "flying_shear"
        ),
        "scale": _row(
            "a design of another size: all lengths by a factor, masses and inertias by choice", "designs", "scale"
        ),
        "stability": _row("chart and forbidden speeds of a flexible camshaft", "stability", "stability"),
        "figures": _row(
            "figures and tables of the papers: printed values and computed values",
            "stability",
            "figures",
        ),
        "linkage-from": _row("a linkage from Pyslvs, PMKS+ or Linkage", "linkages", "linkage_from"),
        "synthesise": _row(
            "linkages for a task: poses of a body, a path, pairs of angles, or a swing", "synthesis", "synthesise"
        ),
        "circuits": _row("assemblies of a linkage, as drawn or by signs", "linkages", "circuits"),
        "curves": _row("curves of points of a linkage, as CSV, DXF or SVG", "linkages", "curves"),
        "pose": _row("links and cam at one angle, a layer each, as DXF or SVG", "linkages", "pose"),
        "measured": _row("a motion from a measured table", "tables", "measured"),
        "motion-from": _row(
            "a motion from a DXF curve: the follower rolled over closed lines and arcs", "motions", "motion_from"
        ),
    }
)
