"""Where the numbers of a graph come from: a table, or a design with its drives; each gives columns by name."""

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
    decoded,
    number,
    read_sheet,
    require_cells,
    require_lines,
    split,
)
from core.numerics.lazy import checkpoint
from core.output.channels import ACCELERATION, SPEED, channels, outputs, travel_column
from core.output.export import camshaft_columns
from core.output.graph.model import (
    ALL,
    ANGLES,
    WHOLE,
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

# -- all columns of a text table as numbers, however long it is -------------------------------------------------


SAMPLE, LEAST_SAMPLE = 500, 50  # lines by which header, delimiter and decimal mark are found, fewer of long ones
SAMPLE_TEXT = 100_000  # characters of them
LINES_AT_ONCE, CELLS_AT_ONCE = 20_000, 1_000_000  # between two looks at whether the table is still wanted
FEW = 3  # cells that are no numbers, of one column, before the rest is counted
_COMMENTS = ("#", "%", "//")

Progress = Callable[[float], object]
"""Is called with how much is done, 0 ... 1."""


@frozen(eq=False)
class NumberTable:
    """A table. names: of its columns, each once; values (columns, rows), nan where nothing stands; notes: a line for whatever was
    left out."""

    name: str
    names: tuple[str, ...]
    values: np.ndarray
    notes: tuple[str, ...]


def read_table_file(path: Path, progress: Progress = lambda part: None) -> NumberTable:
    """The table in a file. Raises FileError where it cannot be read, TableError where no row holds two numbers."""
    return read_numbers(read_bytes(path), path.name, progress)


def read_numbers(data: bytes, name: str, progress: Progress = lambda part: None) -> NumberTable:
    """The numbers in a table's bytes; its delimiter, decimal mark and header are found as for measured tables.

    Blocks of lines that hold numbers and nothing else are read at once, others line by line. Raises TableError.
    """
    text, _ = decoded(data, name)
    require_lines(text, name)
    lines = re.split(r"\r\n|\r", text) if "\r" in text and "\n" not in text else text.replace("\r\n", "\n").split("\n")
    widest = max(map(len, lines[:LEAST_SAMPLE])) + 1
    sample = "\n".join(lines[: max(LEAST_SAMPLE, min(SAMPLE, SAMPLE_TEXT // widest))]).encode()
    sheet = read_sheet(sample, name)
    if wider := _wider(sheet, lines):
        sheet = read_sheet(sample, name, columns=wider)
    if sheet.columns > COLUMNS:
        raise TableError(name, [RowFault(0, f"more than {COLUMNS} columns; wanted: at most {COLUMNS}")])
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
    names = _named(sheet.names)
    header = [] if any(sheet.names) else ["there is no header: columns are called by their numbers"]
    return NumberTable(name, names, values, (*header, *reader.notes(names)))


def _wider(sheet: Worksheet, lines: Sequence[str]) -> int:
    """Columns of the header where it has more than most rows, and some row as many: those at the end are shorter, or rarely filled. 0
    where it has not."""
    begin = sheet.rows[0].line - 1
    above = next((line for line in reversed(lines[:begin]) if line.strip()), "")
    wide = len(split(above.strip().lstrip("#%/"), sheet.delimiter))
    if sheet.delimiter == "spaces" or wide <= sheet.columns:
        return 0
    mark = DELIMITERS[sheet.delimiter]
    return wide if any(line.count(mark) >= wide - 1 for line in lines[begin:]) else 0


def _named(headings: Sequence[str]) -> tuple[str, ...]:
    """Each name once; a column without one is called by its number."""
    counts = Counter(headings)
    return tuple(
        f"column {i}" if not name else name if counts[name] == 1 else f"column {i} {name}"
        for i, name in enumerate(headings, 1)
    )


@dataclass
class _Reader:
    """Lines to numbers; what was wrong in them is gathered."""

    delimiter: str
    decimal: str
    columns: int
    wrong: dict[int, list[str]] = field(default_factory=dict)
    more: Counter[int] = field(default_factory=Counter)
    short: dict[int, LineRuns] = field(default_factory=dict)
    long: LineRuns = field(default_factory=LineRuns)
    empty: dict[int, LineRuns] = field(default_factory=dict)

    def block(self, lines: Sequence[str], at: int) -> np.ndarray:
        """The rows (n, columns) of lines; at: the number of the first, from 0."""
        made = self._at_once(lines)
        return made if made is not None else self._one_by_one(lines, at)

    def _at_once(self, lines: Sequence[str]) -> np.ndarray | None:
        """None where anything but numbers stands there."""
        if self.decimal == "comma":
            if any("." in line for line in lines):
                return None
            lines = [line.replace(",", ".") for line in lines]
        if not any(lines):
            return np.zeros((0, self.columns))
        mark = None if self.delimiter == "spaces" else DELIMITERS[self.delimiter]
        if mark is not None and lines[0].endswith(mark):  # as some programs end every line
            lines = [line.rstrip(mark) for line in lines]
        try:
            made = np.loadtxt(lines, delimiter=mark, comments=None, ndmin=2)
        except ValueError:
            return None
        return made if made.shape[1] == self.columns and not np.isinf(made).any() else None

    def _one_by_one(self, lines: Sequence[str], at: int) -> np.ndarray:
        made = np.full((len(lines), self.columns), np.nan)
        used = np.zeros(len(lines), dtype=bool)
        for i, line in enumerate(lines):
            text = line.strip()
            if not text or text.startswith(_COMMENTS):
                continue
            cells = split(
                re.split(r"#|%|//", line, maxsplit=1)[0] if re.match(r"\s*[-+.\d]", line) else line, self.delimiter
            )
            used[i] = True
            if len(cells) < self.columns:
                self.short.setdefault(len(cells), LineRuns()).add(at + i + 1)
            elif len(cells) > self.columns:
                self.long.add(at + i + 1)
            for column, cell in enumerate(cells[: self.columns]):
                value = number(cell, self.decimal)
                if value is not None and np.isfinite(value):
                    made[i, column] = value
                elif not cell:
                    self.empty.setdefault(column, LineRuns()).add(at + i + 1)
                elif cell.lower() not in ("nan", "-", "na", "n/a"):
                    shown = self.wrong.setdefault(column, [])
                    if len(shown) < FEW:
                        shown.append(f"line {at + i + 1}: {cell[:30]!r}")
                    else:
                        self.more[column] += 1
        return made[used]

    def notes(self, names: Sequence[str]) -> tuple[str, ...]:
        """A line for each kind of fault."""
        made = []
        for column, cells in sorted(self.wrong.items()):
            more = f"; and {self.more[column]} more" if self.more[column] else ""
            made.append(f"{names[column]}, {'; '.join(cells)}{more}: no number, left out")
        made += [f"{names[column]}: nothing in {lines}, a gap" for column, lines in sorted(self.empty.items())]
        for count, lines in sorted(self.short.items()):
            short = f"{lines} {'has' if lines.count == 1 else 'have'} {count} of {self.columns} columns"
            made.append(f"{short}: those behind end, or have a gap, there")
        if self.long.count:
            made.append(f"{self.long}: more than {self.columns} columns; what is behind them is left out")
        return tuple(made)


# -- where the numbers of a graph come from ---------------------------------------------------------------------


MACHINE, TIME = "machine_angle_deg", "time_s"


@frozen
class ColumnHeading:
    """A column: its name, as rows of a graph have it, in words, its unit, the family that sets its colour."""

    name: str
    label: str
    unit: str
    family: str = ""


_FAMILIES = ("velocity", "acceleration", "jerk", "force", "torque", "stress", "curvature", "energy", "power")


def _heading(name: str) -> ColumnHeading:
    """Of a column of which no more than the name is known."""
    label, unit = without_unit(name), unit_of_column(name)
    kind = quantity_kind(unit).removeprefix("angular ")
    return ColumnHeading(
        name,
        label[:1].upper() + label[1:],
        unit,
        "displacement" if kind == "length" else kind if kind in _FAMILIES else "",
    )


def words_of(column: str) -> str:
    """A column of some design in words."""
    return label_of(column) or _heading(column).label


class MissingColumn(KindynaError):
    """A design does not have what is to be drawn of it; ``words`` says so without the names of files and commands."""

    def __init__(self, text: str, words: str) -> None:
        super().__init__(text)
        self.words = words


class Source(Protocol):
    """What curves are drawn from.

    name     in words, for the legend
    notes    what was left out of it
    drives   names of drives; none where there is but one, or none at all
    turns    whether its first column is the angle of a turn [deg]
    """

    turns: bool
    name: str
    notes: tuple[str, ...]
    drives: tuple[str, ...]

    def parts(self, drive: str) -> tuple[str, ...]:
        """The drives that a row's ``drive`` means: one, or each. Raises KindynaError."""

    def headings(self, drive: str) -> tuple[ColumnHeading, ...]:
        """The columns of one of them; the first is what the others are usually drawn over. Raises KindynaError."""

    def usual(self, headings: Sequence[ColumnHeading]) -> int:
        """The place of the column that is drawn where none is named."""

    def values(self, drive: str, names: Sequence[str]) -> tuple[np.ndarray, ...]:
        """Those columns, row by row (n,). Raises KindynaError."""


class TableSource:
    """The columns of a table."""

    turns = False
    drives: tuple[str, ...] = ()

    def __init__(self, table: NumberTable) -> None:
        self.name, self.notes = Path(table.name).stem, table.notes
        self._values = dict(zip(table.names, table.values, strict=True))
        self._headings = tuple(_heading(name) for name in table.names)

    def parts(self, drive: str) -> tuple[str, ...]:
        """Names of the drives that a row stands for."""
        return ("",)

    def headings(self, drive: str) -> tuple[ColumnHeading, ...]:
        """Its columns, for a drive of the design."""
        return self._headings

    def usual(self, headings: Sequence[ColumnHeading]) -> int:
        return 1

    def values(self, drive: str, names: Sequence[str]) -> tuple[np.ndarray, ...]:
        """Columns (n,) by their names, in the units of the headings."""
        return tuple(self._values[name] for name in names)


class DesignSource:
    """The channels of a design's drives, and of its shaft. chosen: the drive that an empty name means."""

    turns = True
    notes: tuple[str, ...] = ()

    def __init__(self, design: Design, name: str = "", chosen: str = "") -> None:
        self.design, self.name, self._chosen = design, name or design.name, chosen
        self.drives = drive_names(design) if len(design.drives) > 1 else ()

    @cached_property
    def shaft(self) -> Camshaft[Study]:
        """All drives together."""
        return Study(self.design).camshaft

    def parts(self, drive: str) -> tuple[str, ...]:
        """Names of the drives that a row stands for."""
        if not self.drives:
            return ("",)
        if drive == ALL:
            return self.drives
        name = drive or self._chosen or self.drives[0]
        if name != WHOLE and name not in self.drives:
            text = f"{self.name} has no drive {name!r}; it has {', '.join(self.drives)}"
            raise MissingColumn(text, text)
        return (name,)

    def _study(self, drive: str) -> Study:
        return Study(only(self.design, self.drives.index(drive) if drive in self.drives else 0))

    def headings(self, drive: str) -> tuple[ColumnHeading, ...]:
        """Its columns, for a drive of the design."""
        machine = ColumnHeading(MACHINE, "Machine angle", "°")
        if drive == WHOLE:
            names = [name for name, _ in camshaft_columns(self.shaft)]
            own = (
                ColumnHeading(row.name, row.label, unit_of_column(row.name), row.family) for row in outputs(self.shaft)
            )
            return (machine, *map(_heading, names), *own)
        study = self._study(drive)
        angle = study.angle_name
        first = [ColumnHeading(study.angle_column, angle[:1].upper() + angle[1:], "°")]
        first += [machine] if self.drives else []
        first += [ColumnHeading(TIME, "Time", "s")] if study.omega else []
        rows = (row for row in channels(study.design) if row.slug != study.angle_column)
        return (*first, *(ColumnHeading(row.slug, row.label, row.unit.symbol, row.family) for row in rows))

    def usual(self, headings: Sequence[ColumnHeading]) -> int:
        """The displacement where there is one, else the first channel."""
        places = [i for i, each in enumerate(headings) if each.family]
        named = (i for i in places if split_unit(headings[i].name)[0] == "displacement")
        return next(named, places[0] if places else 1)

    def values(self, drive: str, names: Sequence[str]) -> tuple[np.ndarray, ...]:
        """Columns (n,) by their names, in the units of the headings."""
        found = self._of_shaft(names) if drive == WHOLE else self._of_drive(drive, names)
        if MACHINE in names:
            order = np.argsort(found[list(names).index(MACHINE)], kind="stable")
            return tuple(column[order] for column in found)
        return found

    def _of_shaft(self, names: Sequence[str]) -> tuple[np.ndarray, ...]:
        rows = {row.name: row.values for row in outputs(self.shaft)}
        if not {MACHINE, *rows}.issuperset(names):
            rows |= dict(camshaft_columns(self.shaft))
        return tuple(self.shaft.angle_degrees if name == MACHINE else rows[name](self.shaft) for name in names)

    def _of_drive(self, drive: str, names: Sequence[str]) -> tuple[np.ndarray, ...]:
        study = self._study(drive)
        rows = {row.slug: row for row in channels(study.design)}
        own = {
            study.angle_column: lambda: study.angle_degrees,
            TIME: lambda: np.deg2rad(study.angle_degrees) / abs(study.omega),
            MACHINE: lambda: np.mod(np.degrees(self.shaft.positions[drive].machine_angle(study.theta)), 360.0),
        }
        return tuple(own[name]() if name in own else rows[name].values(study) for name in names)


def read_source(path: Path, progress: Progress = lambda part: None) -> Source:
    """The source in a file: of a design where its name ends in .toml, else of a table. Raises KindynaError."""
    if path.suffix.lower() == ".toml":
        return DesignSource(load(path), path.stem)
    return TableSource(read_table_file(path, progress))


# -- graphs that are ready to be shown --------------------------------------------------------------------------


@frozen
class ReadyGraph:
    """name: as the command calls it; text and tip: as a menu does; graph: of the design at hand."""

    name: str
    text: str
    tip: str
    graph: Graph


def ready(source: DesignSource) -> tuple[ReadyGraph, ...]:
    """Those that this design has."""
    return (*_of_shaft(source), *_of_points(source))


def _graph(title: str, *curves: GraphCurve, across: str = "", left: str = "") -> Graph:
    made = Graph(title=title, x=GraphAxis(across), left=GraphAxis(left))
    for curve in curves:
        made = add_curve(made, curve)
    return made


def _of_shaft(source: DesignSource) -> Iterator[ReadyGraph]:
    """The first drive across, those behind it upwards."""
    names = path_drives(source.shaft) if source.drives else ()
    if not names:
        return
    first, *others = (travel_column(source.shaft, name) for name in names)
    paths = [
        GraphCurve(drive=WHOLE, x=first, y=other, name=f"{name} over {names[0]}", mark=ANGLES, dash=dash)
        for name, other, dash in zip(names[1:], others, ("dashed", "solid"), strict=False)
    ]
    led = f"what {', '.join(names[:-1])} and {names[-1]} carry together"
    path = _graph("Path of the transfer", *paths, across=names[0], left=", ".join(names[1:]))
    yield ReadyGraph("path", "Path of the transfer", f"The path of {led}, marked by machine angle", path)
    along = (
        GraphCurve(drive=WHOLE, x=MACHINE, y=column, name=name)
        for column, name in ((SPEED, "Speed"), (ACCELERATION, "Acceleration"))
    )
    speed = _graph("Speed along the path", *along, left="Speed")
    yield ReadyGraph("speed", "Speed along the path", f"Speed and acceleration of {led}", speed)


def _of_points(source: DesignSource) -> Iterator[ReadyGraph]:
    """Of every point that is no joint, of a link that moves."""
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
            turned = rows.get(f"link.{link.number}")
            path = _graph(f"Path of {name}", GraphCurve(x=along, y=height, name=f"Path of {name}", mark=ANGLES))
            yield ReadyGraph(
                f"path:{name}",
                f"Path of {name}",
                f"Where {name} of link {link.number} is over the turn, marked by angle",
                path,
            )
            moved = [GraphCurve(x=height, y=along, name=f"{name}, along", mark=ANGLES)]
            moved += [GraphCurve(x=height, y=turned, name=f"Link {link.number}, angle")] if turned else []
            tip = f"How far {name} moves along, and link {link.number} turns, with the height of {name}: of a wheel its bump plot"
            over = f"{name} over its height"
            yield ReadyGraph(f"height:{name}", over, tip, _graph(over, *moved, across=f"Height of {name}"))


@frozen
class PointValue:
    """What is read at a point of a path: its name, value and unit."""

    name: str
    value: float
    unit: str


def on_path(source: Source, curve: GraphCurve, angle: float) -> tuple[PointValue, ...]:
    """Speed along a path and size of the acceleration on it where the angle of the turn is so [deg]; nothing where the curve is no path:
    neither x and y of one point of a linkage, nor two outputs that lead what several drives carry."""
    if not isinstance(source, DesignSource):
        return ()
    part = source.parts(curve.drive)[0]
    point = curve.x.removesuffix("_x_mm")
    if part == WHOLE and {curve.x, curve.y} <= {
        travel_column(source.shaft, name) for name in path_drives(source.shaft)
    }:
        columns: tuple[str, ...] = (SPEED, ACCELERATION)
    elif part != WHOLE and (curve.x, curve.y) == (f"{point}_x_mm", f"{point}_y_mm") and point:
        columns = tuple(f"{point}_{what}" for what in ("speed_mm_s", "ax_mm_s2", "ay_mm_s2"))
    else:
        return ()
    headings = source.headings(part)
    if not {each.name for each in headings}.issuperset(columns):
        return ()
    at, *values = source.values(part, (headings[0].name, *columns))
    speed, *acceleration = (float(np.interp(angle, at, each, period=360.0)) for each in values)
    return PointValue("speed", speed, "mm/s"), PointValue("acceleration", hypot(*acceleration), "mm/s²")
