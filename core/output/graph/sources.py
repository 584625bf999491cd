"""Sources of a graph's numbers: a table, or a design with its drives; each has columns by name."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import hypot
from pathlib import Path
from typing import Protocol

import numpy as np

from core.bounds import COLUMNS
from core.design import FRAME_LINK, Design, drive_names, only, split_unit
from core.design.topology import pins
from core.errors import KindynaError
from core.frozen import frozen
from core.measured.sheet import (
    DELIMITERS,
    LineRuns,
    RowFault,
    TableError,
    Worksheet,
    decode,
    number,
    read_sheet,
    require_cells,
    require_lines,
    split_cells,
)
from core.numerics.lazy import checkpoint
from core.output.channels import ACCELERATION, SPEED, channels, output_columns, travel_column
from core.output.export import camshaft_columns
from core.output.graph.model import (
    ALL,
    ANGLES,
    SHAFT,
    Graph,
    GraphAxis,
    GraphCurve,
    add_curve,
    unit_of_column,
    without_unit,
)
from core.project import load
from core.project.files import read_bytes
from core.study import Camshaft, Study
from core.study.quantities import label_of
from core.study.quantity_requests import path_drives
from core.units import quantity_kind

# -- text tables as numbers -------------------------------------------------------------------------------------


SAMPLE, LEAST_SAMPLE = 500, 50  # lines that determine header, delimiter and decimal mark, fewer of long lines
SAMPLE_TEXT = 100_000  # characters in these lines
LINES_AT_ONCE, CELLS_AT_ONCE = 20_000, 1_000_000  # between two checkpoints
FEW = 3  # wrong cells of a column that are quoted; further ones are counted
_COMMENTS = ("#", "%", "//")

Progress = Callable[[float], object]
"""Called with the completed part, 0 ... 1."""


@frozen(eq=False)
class NumberTable:
    """A table of numbers.

    Attributes
    ----------
    names : different names of the columns
    values : (columns, rows) numbers in the units of the columns, NaN in empty cells
    notes : lines on omitted cells
    """

    name: str
    names: tuple[str, ...]
    values: np.ndarray
    notes: tuple[str, ...]


def read_table_file(path: Path, progress: Progress = lambda part: None) -> NumberTable:
    """The table in a file. Raises FileError, TableError where no row holds two numbers."""
    return read_numbers(read_bytes(path), path.name, progress)


def read_numbers(data: bytes, name: str, progress: Progress = lambda part: None) -> NumberTable:
    """Numbers in the bytes of a table; delimiter, decimal mark and header are detected as in measured tables.

    Blocks of lines with numbers only are read at once, others line by line. Raises TableError.
    """
    text, _ = decode(data, name)
    require_lines(text, name)
    lines = re.split(r"\r\n|\r", text) if "\r" in text and "\n" not in text else text.replace("\r\n", "\n").split("\n")
    widest = max(map(len, lines[:LEAST_SAMPLE])) + 1
    sample = "\n".join(lines[: max(LEAST_SAMPLE, min(SAMPLE, SAMPLE_TEXT // widest))]).encode()
    sheet = read_sheet(sample, name)
    if wider := _wider(sheet, lines):
        sheet = read_sheet(sample, name, columns=wider)
    if sheet.columns > COLUMNS:
        raise TableError(name, [RowFault(0, f"more than {COLUMNS} columns; allowed: at most {COLUMNS}")])
    reader = _Reader(sheet.delimiter, sheet.decimal, sheet.columns)
    begin = sheet.rows[0].line - 1
    require_cells(len(lines) - begin, sheet.columns, name)
    values, count = np.empty((sheet.columns, len(lines) - begin)), 0
    step = min(LINES_AT_ONCE, max(1, CELLS_AT_ONCE // sheet.columns))
    for at in range(begin, len(lines), step):
        checkpoint()
        progress((at - begin) / max(1, len(lines) - begin))
        block = reader.block(lines[at : at + step], at)
        values[:, count : count + len(block)] = block.T
        count += len(block)
    values = values[:, :count] if count == values.shape[1] else values[:, :count].copy()
    names = _distinct_names(sheet.names)
    header = [] if any(sheet.names) else ["no header: columns are named by their numbers"]
    return NumberTable(name, names, values, (*header, *reader.notes(names)))


def _wider(sheet: Worksheet, lines: Sequence[str]) -> int:
    """Number of columns in the header, where it exceeds that of most rows and some row has as many; else 0.

    Columns at the end may be shorter, or rarely filled.
    """
    begin = sheet.rows[0].line - 1
    above = next((line for line in reversed(lines[:begin]) if line.strip()), "")
    count = len(split_cells(above.strip().lstrip("#%/"), sheet.delimiter))
    if sheet.delimiter == "spaces" or count <= sheet.columns:
        return 0
    mark = DELIMITERS[sheet.delimiter]
    return count if any(line.count(mark) >= count - 1 for line in lines[begin:]) else 0


def _distinct_names(headings: Sequence[str]) -> tuple[str, ...]:
    """Different names of the columns; a column without a name is named by its number."""
    counts = Counter(headings)
    return tuple(
        f"column {i}" if not name else name if counts[name] == 1 else f"column {i} {name}"
        for i, name in enumerate(headings, 1)
    )


@dataclass
class _Reader:
    """Converts lines to numbers, and counts the faults in them."""

    delimiter: str
    decimal: str
    columns: int
    wrong: dict[int, list[str]] = field(default_factory=dict)
    more: Counter[int] = field(default_factory=Counter)
    short: dict[int, LineRuns] = field(default_factory=dict)
    long: LineRuns = field(default_factory=LineRuns)
    empty: dict[int, LineRuns] = field(default_factory=dict)

    def block(self, lines: Sequence[str], at: int) -> np.ndarray:
        """Numbers (n, columns) of lines, from the line with index ``at`` on."""
        values = self._at_once(lines)
        return values if values is not None else self._one_by_one(lines, at)

    def _at_once(self, lines: Sequence[str]) -> np.ndarray | None:
        """Numbers of lines that hold nothing else; None for other lines."""
        if self.decimal == "comma":
            if any("." in line for line in lines):
                return None
            lines = [line.replace(",", ".") for line in lines]
        if not any(lines):
            return np.zeros((0, self.columns))
        mark = None if self.delimiter == "spaces" else DELIMITERS[self.delimiter]
        if mark is not None and lines[0].endswith(mark):  # some programs end every line with a delimiter
            lines = [line.rstrip(mark) for line in lines]
        try:
            values = np.loadtxt(lines, delimiter=mark, comments=None, ndmin=2)
        except ValueError:
            return None
        return values if values.shape[1] == self.columns and not np.isinf(values).any() else None

    def _one_by_one(self, lines: Sequence[str], at: int) -> np.ndarray:
        values = np.full((len(lines), self.columns), np.nan)
        is_row = np.zeros(len(lines), dtype=bool)
        for i, line in enumerate(lines):
            text = line.strip()
            if not text or text.startswith(_COMMENTS):
                continue
            cells = split_cells(
                re.split(r"#|%|//", line, maxsplit=1)[0] if re.match(r"\s*[-+.\d]", line) else line, self.delimiter
            )
            is_row[i] = True
            if len(cells) < self.columns:
                self.short.setdefault(len(cells), LineRuns()).add(at + i + 1)
            elif len(cells) > self.columns:
                self.long.add(at + i + 1)
            for column, cell in enumerate(cells[: self.columns]):
                value = number(cell, self.decimal)
                if value is not None and np.isfinite(value):
                    values[i, column] = value
                elif not cell:
                    self.empty.setdefault(column, LineRuns()).add(at + i + 1)
                elif cell.lower() not in ("nan", "-", "na", "n/a"):
                    shown = self.wrong.setdefault(column, [])
                    if len(shown) < FEW:
                        shown.append(f"line {at + i + 1}: {cell[:30]!r}")
                    else:
                        self.more[column] += 1
        return values[is_row]

    def notes(self, names: Sequence[str]) -> tuple[str, ...]:
        """A line for each kind of fault."""
        notes = []
        for column, cells in sorted(self.wrong.items()):
            more = f"; and {self.more[column]} more" if self.more[column] else ""
            notes.append(f"{names[column]}, {'; '.join(cells)}{more}: not a number, omitted")
        notes += [f"{names[column]}: empty in {lines}, a gap" for column, lines in sorted(self.empty.items())]
        for count, lines in sorted(self.short.items()):
            short = f"{lines} {'has' if lines.count == 1 else 'have'} {count} of {self.columns} columns"
            notes.append(f"{short}: further columns have a gap")
        if self.long.count:
            notes.append(f"{self.long}: more than {self.columns} columns; further cells are omitted")
        return tuple(notes)


# -- sources ----------------------------------------------------------------------------------------------------


MACHINE, TIME = "machine_angle_deg", "time_s"


@frozen
class ColumnHeading:
    """A column: its name in rows of a graph, its label, its unit, and the family that determines its colour."""

    name: str
    label: str
    unit: str
    family: str = ""


_FAMILIES = ("velocity", "acceleration", "jerk", "force", "torque", "stress", "curvature", "energy", "power")


def _heading(name: str) -> ColumnHeading:
    """Heading of a column of which only the name is known."""
    label, unit = without_unit(name), unit_of_column(name)
    kind = quantity_kind(unit).removeprefix("angular ")
    return ColumnHeading(
        name,
        label[:1].upper() + label[1:],
        unit,
        "displacement" if kind == "length" else kind if kind in _FAMILIES else "",
    )


def column_label(column: str) -> str:
    """Label of a column in any design."""
    return label_of(column) or _heading(column).label


class MissingColumn(KindynaError):
    """A design has no such column; ``description`` says so without names of files and commands."""

    def __init__(self, text: str, description: str) -> None:
        super().__init__(text)
        self.description = description


class Source(Protocol):
    """Source of curves.

    Attributes
    ----------
    name : name in the legend
    notes : lines on omitted parts
    drives : names of the drives, where there are several
    has_angle : whether its first column is the angle of a turn [deg]
    """

    has_angle: bool
    name: str
    notes: tuple[str, ...]
    drives: tuple[str, ...]

    def parts(self, drive: str) -> tuple[str, ...]:
        """Drives for a row's ``drive``: one, or all. Raises KindynaError."""

    def headings(self, drive: str) -> tuple[ColumnHeading, ...]:
        """Columns of a drive; the first is the default abscissa. Raises KindynaError."""

    def default_column(self, headings: Sequence[ColumnHeading]) -> int:
        """Index of the column that is drawn by default."""

    def values(self, drive: str, names: Sequence[str]) -> tuple[np.ndarray, ...]:
        """Columns by their names.

        Returns
        -------
        tuple of ndarray (n,) [units of the headings]

        Raises
        ------
        KindynaError
            The design cannot be computed, or lacks a column.
        """


class TableSource:
    """Columns of a table."""

    has_angle = False
    drives: tuple[str, ...] = ()

    def __init__(self, table: NumberTable) -> None:
        self.name, self.notes = Path(table.name).stem, table.notes
        self._values = dict(zip(table.names, table.values, strict=True))
        self._headings = tuple(_heading(name) for name in table.names)

    def parts(self, drive: str) -> tuple[str, ...]:
        """A table has no drives."""
        return ("",)

    def headings(self, drive: str) -> tuple[ColumnHeading, ...]:
        """Columns of the table."""
        return self._headings

    def default_column(self, headings: Sequence[ColumnHeading]) -> int:
        """The second column."""
        return 1

    def values(self, drive: str, names: Sequence[str]) -> tuple[np.ndarray, ...]:
        """Columns by their names.

        Returns
        -------
        tuple of ndarray (n,) [units of the headings]
        """
        return tuple(self._values[name] for name in names)


class DesignSource:
    """Channels of a design's drives and of its shaft."""

    has_angle = True
    notes: tuple[str, ...] = ()

    def __init__(self, design: Design, name: str = "", selected: str = "") -> None:
        """Use ``selected`` where a row names no drive."""
        self.design, self.name, self._selected = design, name or design.name, selected
        self.drives = drive_names(design) if len(design.drives) > 1 else ()

    @cached_property
    def shaft(self) -> Camshaft[Study]:
        """The shaft with all drives."""
        return Study(self.design).camshaft

    def parts(self, drive: str) -> tuple[str, ...]:
        """Drives for a row's ``drive``. Raises MissingColumn."""
        if not self.drives:
            return ("",)
        if drive == ALL:
            return self.drives
        name = drive or self._selected or self.drives[0]
        if name != SHAFT and name not in self.drives:
            text = f"{self.name} has no drive {name!r}; it has {', '.join(self.drives)}"
            raise MissingColumn(text, text)
        return (name,)

    def _study(self, drive: str) -> Study:
        return Study(only(self.design, self.drives.index(drive) if drive in self.drives else 0))

    def headings(self, drive: str) -> tuple[ColumnHeading, ...]:
        """Columns of a drive, or of the shaft."""
        machine = ColumnHeading(MACHINE, "Machine angle", "°")
        if drive == SHAFT:
            names = [name for name, _ in camshaft_columns(self.shaft)]
            sums = (
                ColumnHeading(row.name, row.label, unit_of_column(row.name), row.family)
                for row in output_columns(self.shaft)
            )
            return (machine, *map(_heading, names), *sums)
        study = self._study(drive)
        angle = study.angle_name
        first = [ColumnHeading(study.angle_column, angle[:1].upper() + angle[1:], "°")]
        first += [machine] if self.drives else []
        first += [ColumnHeading(TIME, "Time", "s")] if study.omega else []
        rows = (row for row in channels(study.design) if row.slug != study.angle_column)
        return (*first, *(ColumnHeading(row.slug, row.label, row.unit.symbol, row.family) for row in rows))

    def default_column(self, headings: Sequence[ColumnHeading]) -> int:
        """The displacement where there is one, else the first channel."""
        indices = [i for i, heading in enumerate(headings) if heading.family]
        displacements = (i for i in indices if split_unit(headings[i].name)[0] == "displacement")
        return next(displacements, indices[0] if indices else 1)

    def values(self, drive: str, names: Sequence[str]) -> tuple[np.ndarray, ...]:
        """Columns by their names.

        Returns
        -------
        tuple of ndarray (n,) [units of the headings]
        """
        columns = self._shaft_columns(names) if drive == SHAFT else self._drive_columns(drive, names)
        if MACHINE in names:
            order = np.argsort(columns[list(names).index(MACHINE)], kind="stable")
            return tuple(column[order] for column in columns)
        return columns

    def _shaft_columns(self, names: Sequence[str]) -> tuple[np.ndarray, ...]:
        rows = {row.name: row.values for row in output_columns(self.shaft)}
        if not {MACHINE, *rows}.issuperset(names):
            rows |= dict(camshaft_columns(self.shaft))
        return tuple(self.shaft.angle_degrees if name == MACHINE else rows[name](self.shaft) for name in names)

    def _drive_columns(self, drive: str, names: Sequence[str]) -> tuple[np.ndarray, ...]:
        study = self._study(drive)
        rows = {row.slug: row for row in channels(study.design)}
        computed = {
            study.angle_column: lambda: study.angle_degrees,
            TIME: lambda: np.deg2rad(study.angle_degrees) / abs(study.omega),
            MACHINE: lambda: np.mod(np.degrees(self.shaft.positions[drive].machine_angle(study.theta)), 360.0),
        }
        return tuple(computed[name]() if name in computed else rows[name].values(study) for name in names)


def read_source(path: Path, progress: Progress = lambda part: None) -> Source:
    """The source in a file: a design where its name ends in .toml, else a table. Raises KindynaError."""
    if path.suffix.lower() == ".toml":
        return DesignSource(load(path), path.stem)
    return TableSource(read_table_file(path, progress))


# -- ready graphs -----------------------------------------------------------------------------------------------


@frozen
class ReadyGraph:
    """A graph of the current design: its name in the command, text and tip of its menu entry."""

    name: str
    text: str
    tip: str
    graph: Graph


def ready_graphs(source: DesignSource) -> tuple[ReadyGraph, ...]:
    """Ready graphs of a design."""
    return (*_transfer_graphs(source), *_point_graphs(source))


def _graph(title: str, *curves: GraphCurve, across: str = "", left: str = "") -> Graph:
    graph = Graph(title=title, x=GraphAxis(across), left=GraphAxis(left))
    for curve in curves:
        graph = add_curve(graph, curve)
    return graph


def _transfer_graphs(source: DesignSource) -> Iterator[ReadyGraph]:
    """Path and speed of the object that several drives carry: the first drive across, the others upwards."""
    names = path_drives(source.shaft) if source.drives else ()
    if not names:
        return
    first, *ordinates = (travel_column(source.shaft, name) for name in names)
    paths = [
        GraphCurve(drive=SHAFT, x=first, y=ordinate, name=f"{name} over {names[0]}", mark=ANGLES, dash=dash)
        for name, ordinate, dash in zip(names[1:], ordinates, ("dashed", "solid"), strict=False)
    ]
    carried = f"the object that {', '.join(names[:-1])} and {names[-1]} carry together"
    path = _graph("Path of the transfer", *paths, across=names[0], left=", ".join(names[1:]))
    yield ReadyGraph("path", "Path of the transfer", f"The path of {carried}, marked by machine angle", path)
    along = (
        GraphCurve(drive=SHAFT, x=MACHINE, y=column, name=name)
        for column, name in ((SPEED, "Speed"), (ACCELERATION, "Acceleration"))
    )
    speed = _graph("Speed along the path", *along, left="Speed")
    yield ReadyGraph("speed", "Speed along the path", f"Speed and acceleration of {carried}", speed)


def _point_graphs(source: DesignSource) -> Iterator[ReadyGraph]:
    """Paths of all points of moving links that are not joints."""
    drive = source.design.drive if not source.drives else None
    if drive is None or not drive.links:
        return
    joints = {pin.name for pin in pins(drive.linkage)}
    rows = {row.name: row.slug for row in channels(source.design, ("linkage",))}
    for link in drive.linkage.links:
        for point in link.points if link.number != FRAME_LINK else ():
            if point.name in joints:
                continue
            name, along, height = point.name, rows[f"point.{point.name}_x"], rows[f"point.{point.name}_y"]
            angle = rows.get(f"link.{link.number}")
            path = _graph(f"Path of {name}", GraphCurve(x=along, y=height, name=f"Path of {name}", mark=ANGLES))
            yield ReadyGraph(
                f"path:{name}",
                f"Path of {name}",
                f"Path of {name} of link {link.number} over the turn, marked by angle",
                path,
            )
            curves = [GraphCurve(x=height, y=along, name=f"{name}, along", mark=ANGLES)]
            curves += [GraphCurve(x=height, y=angle, name=f"Link {link.number}, angle")] if angle else []
            tip = f"Displacement of {name} and rotation of link {link.number} over the height of {name}: the bump plot of a wheel"
            over = f"{name} over its height"
            yield ReadyGraph(f"height:{name}", over, tip, _graph(over, *curves, across=f"Height of {name}"))


@frozen
class PointValue:
    """A value at a point of a path: its name, value and unit."""

    name: str
    value: float
    unit: str


def path_values(source: Source, curve: GraphCurve, angle: float) -> tuple[PointValue, ...]:
    """Speed along a path and magnitude of the acceleration at an angle of the turn [deg]; empty where the curve is no path.

    A path has x and y of one point of a linkage, or two drives that carry an object together.
    """
    if not isinstance(source, DesignSource):
        return ()
    part = source.parts(curve.drive)[0]
    point = curve.x.removesuffix("_x_mm")
    if part == SHAFT and {curve.x, curve.y} <= {
        travel_column(source.shaft, name) for name in path_drives(source.shaft)
    }:
        columns: tuple[str, ...] = (SPEED, ACCELERATION)
    elif part != SHAFT and (curve.x, curve.y) == (f"{point}_x_mm", f"{point}_y_mm") and point:
        columns = tuple(f"{point}_{quantity}" for quantity in ("speed_mm_s", "ax_mm_s2", "ay_mm_s2"))
    else:
        return ()
    headings = source.headings(part)
    if not {heading.name for heading in headings}.issuperset(columns):
        return ()
    at, *values = source.values(part, (headings[0].name, *columns))
    speed, *acceleration = (float(np.interp(angle, at, column, period=360.0)) for column in values)
    return PointValue("speed", speed, "mm/s"), PointValue("acceleration", hypot(*acceleration), "mm/s²")
