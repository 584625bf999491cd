"""The painter that commands are handed: of whatever they have drawn, the files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from core.output.position import Snapshot
from core.study import Study
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.pictures.files import PICTURES, chart_file

if TYPE_CHECKING:
    from core.commands import Drawn


def paint(drawn: Drawn) -> dict[str, bytes]:
    """The pictures of a report, of a linkage at one angle, of a chart, of another figure, of a paper, of a graph: file name -> content;
    of a report to hand on: its ending -> content. Raises NoSolution where the design has none."""
    from core.output.report.document import Printed

    ensure_app(offscreen=True)
    if isinstance(drawn, Printed):
        from kindyna_gui.pictures.report.files import report_file

        return {drawn.ending: report_file(drawn.document, drawn.ending) or b""}
    if isinstance(drawn, Study):
        without = () if "cam" in drawn.stages else ("cam.png",)
        return {name: draw(drawn) for name, draw in PICTURES.items() if name not in without}
    if isinstance(drawn, Snapshot):
        from kindyna_gui.pictures.snapshots import SNAPSHOTS

        return {
            f"{name}{ending}": draw(drawn, ending) for name, draw in SNAPSHOTS.items() for ending in (".svg", ".png")
        }
    from core.output.graph.curves import GraphImage

    if isinstance(drawn, GraphImage):
        from kindyna_gui.pictures.graph_file import graph_file

        return {f"graph{drawn.ending}": graph_file(drawn)}
    from core.plot import Figure
    from core.stability import Chart
    from kindyna_gui.pictures.plots.sheets import figure_file

    if isinstance(drawn, Chart) and drawn.machine is not None:
        return {f"stability{ending}": chart_file(drawn, ending) for ending in (".svg", ".png")}
    if not isinstance(drawn, Figure):
        from kindyna_gui.pictures.paper_figures import paper_file

        if isinstance(drawn, Chart):
            return {f"stability{ending}": paper_file(drawn, ending) for ending in (".svg", ".png")}
        return {f"figure{ending}": paper_file(drawn, ending) for ending in (".svg", ".png")}
    return {f"{drawn.name}{ending}": figure_file(drawn, ending) for ending in (".svg", ".png")}
