"""A graph as a file: its rows and axes as JSON, the files of its rows by their paths from its own folder."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path

from core.bounds import bounded_json
from core.errors import KindynaError
from core.output.graph.model import Graph, from_data, to_data
from core.project.files import read_text, write

ENDING = ".graph.json"


def rooted(graph: Graph, folder: Path) -> Graph:
    """The same with paths from the root, of paths from a folder."""
    return replace(
        graph,
        curves=tuple(replace(c, source=str((folder / c.source).absolute()) if c.source else "") for c in graph.curves),
    )


def relative(graph: Graph, folder: Path | None) -> Graph:
    """The same with paths from a folder, where the files are inside it or beside it; those farther off stay whole."""

    def short(source: str) -> str:
        if not source or folder is None:
            return source
        try:
            text = os.path.relpath(source, folder)
        except ValueError:  # on another disk
            return source
        return source if text.startswith(os.path.join("..", "..")) else text

    return replace(graph, curves=tuple(replace(curve, source=short(curve.source)) for curve in graph.curves))


def save_setup(graph: Graph, path: Path) -> None:
    """Write the rows of a graph, not their numbers. Raises FileError."""
    data = to_data(relative(graph, path.absolute().parent))
    write(path, json.dumps(data, indent=1, ensure_ascii=False) + "\n")


def load_setup(path: Path) -> Graph:
    """Read them. Raises FileError, KindynaError where it is no such file."""
    try:
        data = bounded_json(read_text(path))
    except ValueError:
        data = None
    if not isinstance(data, dict) or "curves" not in data:
        raise KindynaError(f"{path.name}: no graph; wanted: a file that the graph page saved (*{ENDING})")
    return rooted(from_data(data), path.absolute().parent)


__all__ = ["ENDING", "load_setup", "relative", "rooted", "save_setup"]
