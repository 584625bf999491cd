"""A graph to be painted as a file."""

from __future__ import annotations

from core.frozen import frozen
from core.output.graph.curves import Plotted
from core.output.graph.model import Graph

ENDINGS = (".png", ".svg", ".pdf")
USUAL_SIZE = (960, 600)
LEAST_SIDE, MOST_SIDE = 240, 8000


@frozen(eq=False)
class GraphPicture:
    """The graph, its numbers, the ending of the file, its size in pixels; name: for the title of the file."""

    graph: Graph
    found: Plotted
    ending: str
    width: int = USUAL_SIZE[0]
    height: int = USUAL_SIZE[1]
    name: str = "Graph"


__all__ = ["ENDINGS", "LEAST_SIDE", "MOST_SIDE", "USUAL_SIZE", "GraphPicture"]
