"""Where the numbers of a graph come from: a table, or a design with its drives; each gives columns by name."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Protocol

import numpy as np

from core.design import Design, drive_names, only, split_unit
from core.errors import KindynaError
from core.frozen import frozen
from core.output.channels import channels
from core.output.export import camshaft_columns
from core.output.graph.model import ALL, WHOLE
from core.output.graph.table import NumberTable, Progress, read_table_file
from core.output.graph.units import unit_of_column, without_unit
from core.output.shaft_outputs import outputs
from core.project import load
from core.study import Camshaft, Study
from core.study.quantities import label_of
from core.units import kind_of

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
    kind = kind_of(unit).removeprefix("angular ")
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
            MACHINE: lambda: np.mod(np.degrees(self.shaft.places[drive].machine(study.theta)), 360.0),
        }
        return tuple(own[name]() if name in own else rows[name].values(study) for name in names)


def read_source(path: Path, progress: Progress = lambda part: None) -> Source:
    """The source in a file: of a design where its name ends in .toml, else of a table. Raises KindynaError."""
    if path.suffix.lower() == ".toml":
        return DesignSource(load(path), path.stem)
    return TableSource(read_table_file(path, progress))


__all__ = [
    "MACHINE", "TIME", "ColumnHeading", "DesignSource", "MissingColumn", "Source", "TableSource", "read_source",
    "words_of",
]  # fmt: skip
