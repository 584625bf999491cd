"""The loads in words: what each list holds, and a line for each row with where it acts and its value."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from core.design import Design, Entry, Process, entries, get, load_lists
from core.frozen import frozen
from core.output.lines import shortest
from core.output.load_text import row_attachments, row_name
from kindyna_gui.labels import value_text

WHAT = {
    "masses": ("&Mass", "A mass and an inertia on a link"),
    "forces": ("&Force", "A constant force and a torque on a link"),
    "springs": ("&Spring and damper", "Between two points of links, or of a link and the frame"),
    "torsion_springs": ("&Torsion spring and damper", "Between two links"),
    "pair_friction": ("F&riction", "In a pin or along a slide"),
    "process": ("&Process force", "Over a part of the turn, at a part of the motion, or as a table"),
}
"""List of the loads -> its entry in the menu, and what it is."""
GENERAL = "In general"
_ROW = re.compile(r"(loads\.\w+\[\d+\])")
MOST = 3  # values that a line names


@frozen
class LoadRow:
    """A row of the list: its path, empty for what belongs to no list; name, place and value; all of them as a tip."""

    path: str
    cells: tuple[str, str, str]
    tip: str = ""


def what_of(name: str) -> str:
    """What a row of a list is called in a sentence: ``spring and damper``."""
    return WHAT[name][0].replace("&", "").lower()


def lines_of(design: Design) -> tuple[LoadRow, ...]:
    """Of what belongs to no list, then of each row."""
    texts: dict[str, list[str]] = {}
    for entry in entries(design, "loads"):
        if _is_size(entry):
            row = row_of(entry.path)
            text = value_text(entry.value, entry.unit)
            texts.setdefault(row, []).append(text if row else f"{entry.info.in_sentence} {text}")
    own = texts.get("", [])
    return (
        LoadRow("", (GENERAL, ", ".join(own[:MOST]), ""), ", ".join(own) or "Nothing is given"),
        *_rows(design, texts),
    )


def row_of(path: str) -> str:
    """The row of the loads that a path leads into; empty for what belongs to no list."""
    match = _ROW.match(path)
    return match[1] if match else ""


def _rows(design: Design, texts: Mapping[str, list[str]]) -> Iterator[LoadRow]:
    for name in load_lists(design.drive):
        for i, row in enumerate(getattr(design.drive.loads, name)):
            path = f"loads.{name}[{i}]"
            where = row_attachments(design, path)
            value = _process_text(row) if isinstance(row, Process) else ", ".join(texts.get(path, [])[:MOST])
            cells = (row_name(design, path), where, value)
            yield LoadRow(path, cells, ": ".join(cell for cell in cells if cell))


def _is_size(entry: Entry) -> bool:
    """Whether an entry says how large a load is, not where it is."""
    key = entry.path.rpartition(".")[2]
    place = key in ("x_mm", "y_mm", "centre_x_mm", "centre_y_mm") or key.startswith("gravity") or "_centre" in key
    return isinstance(entry.value, float) and entry.value != 0.0 and not place


def _process_text(row: Process) -> str:
    """``-100 N from 0° to 90°``."""
    size = ", ".join(
        f"{shortest(value)} {unit}" for value, unit in ((row.force_n, "N"), (row.torque_nm, "N·m")) if value
    )
    if row.points:
        return f"table of {len(row.points)} rows"
    for unit, low, high in (
        ("°", row.cam_from_deg, row.cam_to_deg),
        (" mm", row.position_from_mm, row.position_to_mm),
        ("° of motion", row.position_from_deg, row.position_to_deg),
    ):
        if low is not None and high is not None:
            return f"{size or '0 N'} from {shortest(low)} to {shortest(high)}{unit}"
    return size


def first_field(design: Design, path: str) -> str:
    """The path of the first value of a row that says how large it is, else of its first."""
    own = [entry for entry in entries(design, "loads") if entry.path.startswith(f"{path}.")]
    sizes = [entry.path for entry in own if entry.value is not None and _is_size(entry)]
    if isinstance(get(design, path), Process):
        sizes = [each for each in sizes if each.endswith(("force_n", "torque_nm"))]
    return next(iter(sizes), next((entry.path for entry in own), path))


__all__ = ["WHAT", "LoadRow", "first_field", "lines_of", "row_of", "what_of"]
