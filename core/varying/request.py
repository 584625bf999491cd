"""Study of many designs as a file, STUDY.toml; all faults of the file are reported at once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

from core.design import Design, all_paths, part_faults
from core.design.fields import FileLayout, Info, choice, flag, number, placed, whole
from core.design.paths import entry_at
from core.errors import MISSING, DesignError, Fault
from core.frozen import frozen
from core.laws import LAWS
from core.project import dumps_table, load, parsed
from core.project.files import AnyPath, read_text, write
from core.project.reading import Reader
from core.project.reading_faults import did_you_mean
from core.study.quantity_requests import STATISTICS, TOTALS, quantity_request
from core.units import split_unit

GRID, CURVE = 64, 64
"""Steps of a field with bounds only: of two such fields, and of a single one."""
POINTS = 4096
"""Sobol points of three or more such fields."""


@frozen
class VariedField:
    """A varied field: a number between bounds, in even steps or by Sobol's points, listed values, or a choice of words."""

    field: str = placed(FileLayout(missing="the path of a number or word of the design, as cam.base_radius_mm"))
    low: float | None = number("Lowest value", default=None)
    high: float | None = number("Highest value", default=None)
    steps: int | None = whole(
        "Values", 2, 10**12, default=None, help="number of values, evenly spaced from low to high"
    )
    points: int | None = whole("Points", 1, 10**12, default=None, help="number of points of Sobol's sequence")
    values: tuple[float, ...] = placed(FileLayout(each=float), ())
    choices: tuple[str, ...] = placed(FileLayout(each=str), ())


@frozen
class StudyQuantity:
    """A requested figure: a statistic ``of`` a quantity over the turn, by its column, or a total, without ``of``."""

    quantity: str = placed(FileLayout(missing="a column, as pressure_angle_deg, or a total"))
    of: str | None = choice("Of the turn", STATISTICS, default=None)

    @property
    def key(self) -> str:
        """Key of the figure for ``core.study.many``."""
        return self.quantity if self.of is None else f"{self.quantity}:{self.of}"

    @property
    def column(self) -> str:
        """Column of the figure in tables."""
        return self.quantity if self.of is None else f"{self.quantity}_{self.of}"


@frozen
class StudyLimit(StudyQuantity):
    """A limit of a figure: its least and greatest allowed value."""

    FILE_ORDER = ("quantity", "of", "min", "max")

    min: float | None = number("Least value", default=None)
    max: float | None = number("Greatest value", default=None)


@frozen
class Goal(StudyQuantity):
    """A figure, or a varied field in place of it, to be minimised or maximised."""

    FILE_ORDER = ("quantity", "of", "field", "minimise")

    quantity: str = placed(FileLayout(brief=True), "")
    field: str = placed(FileLayout(brief=True), "")
    minimise: bool = flag("Minimise", default=True)

    @property
    def key(self) -> str:
        """Key of the figure for ``core.study.many``, or the path of the field."""
        return self.field or super().key

    @property
    def column(self) -> str:
        """Column of the figure in tables, or the path of the field."""
        return self.field or super().column


@frozen(kw_only=True)
class StudyFile:
    """A study as typed.

    Attributes
    ----------
    design : str
        File of the design, relative to that of the study.
    robust : float or None
        Share of machines that must keep the limits, by the tolerances of the design.
    """

    design: str = placed(FileLayout(missing="a design file, relative to this one"))
    seed: int = whole("Seed", 0, 2**32 - 1, default=0)
    robust: float | None = number("Share within limits", 0.0, 0.99999, open_low=True, default=None)
    vary: tuple[VariedField, ...] = placed(FileLayout(VariedField), ())
    quantities: tuple[StudyQuantity, ...] = placed(FileLayout(StudyQuantity), ())
    limits: tuple[StudyLimit, ...] = placed(FileLayout(StudyLimit), ())
    goals: tuple[Goal, ...] = placed(FileLayout(Goal), ())


@frozen(eq=False)
class StudyOfMany:
    """A study with the design whose fields it varies; ``folder`` holds its saved results."""

    base: Design
    file: StudyFile
    folder: Path

    @cached_property
    def quantities(self) -> tuple[StudyQuantity, ...]:
        """Figures of every design, without repetition: the quantities, then those of limits and goals."""
        rows = (*self.file.quantities, *self.file.limits, *(goal for goal in self.file.goals if not goal.field))
        return tuple({row.key: row for row in reversed(rows)}[key] for key in dict.fromkeys(row.key for row in rows))

    @cached_property
    def infos(self) -> Mapping[str, Info]:
        """Varied field -> info of the field."""
        return {row.field: field_info(self.base, row.field) for row in self.file.vary}  # type: ignore[misc]


# -- the file ---------------------------------------------------------------------------------------------


def load_study(path: AnyPath) -> StudyOfMany:
    """Study in a file. Raises FileError where it or its design cannot be read, DesignError with all faults of either."""
    file, faults = _read(parsed(read_text(path), str(path)))
    if any(fault.path == "design" for fault in faults):
        raise DesignError(faults)
    design_path = Path(path).parent / file.design
    return _judged(file, faults, load(design_path), design_path.parent)


def file_of(table: Mapping[str, Any]) -> StudyFile:
    """Study in the tables of a file, checked without its design. Raises DesignError with all faults."""
    file, faults = _read(table)
    if faults:
        raise DesignError(faults)
    return file


def study_of(file: StudyFile, design: Design, folder: Path = Path()) -> StudyOfMany:
    """Study of a design. Raises DesignError with all faults of the file for this design."""
    return _judged(file, (), design, folder)


def study_of_table(table: Mapping[str, Any], design: Design) -> StudyOfMany:
    """Study of a design in the tables of a file. Raises DesignError with all faults, also those for this design."""
    file, faults = _read(table)
    return _judged(file, faults, design, Path())


def _judged(file: StudyFile, faults: Sequence[Fault], design: Design, folder: Path) -> StudyOfMany:
    """Study of a design. Raises DesignError with the faults of the file and those for this design."""
    if faults := [*faults, *_design_faults(file, design, faults)]:
        raise DesignError(faults)
    return StudyOfMany(design, file, folder)


def save_study(file: StudyFile, path: AnyPath, *, in_place: bool = False) -> str:
    """Write a study to a file, completely or not at all, and return the text of the file.

    Raises DesignError as ``file_of``, and FileError where the file cannot be written.
    """
    text = dumps_table(file)
    file_of(parsed(text, str(path)))
    write(path, text, in_place=in_place)
    return text


def _read(table: Mapping[str, Any]) -> tuple[StudyFile, list[Fault]]:
    """A study as far as it can be read, and its faults, without its design."""
    reader = Reader("")
    file: StudyFile = reader.part(StudyFile, table, "")
    faults = [replace(f, path=f.path.removeprefix(".")) for f in reader.with_rules(part_faults(file, ""), {})]
    for path, row in _rows(file, faults):
        faults += _ROW_FAULTS[type(row)](row, path)
    return file, [*faults, *_list_faults(file)]


def _rows(file: StudyFile, faults: Sequence[Fault]) -> Iterator[tuple[str, Any]]:
    """Path and row of all lists, of rows without these faults."""
    for name in ("vary", "quantities", "limits", "goals"):
        for i, row in enumerate(getattr(file, name)):
            path = f"{name}[{i}]"
            if not any(fault.path == path or fault.path.startswith(f"{path}.") for fault in faults):
                yield path, row


def _design_faults(file: StudyFile, design: Design, faults: Sequence[Fault]) -> list[Fault]:
    """Faults of rows for a design, of rows without faults so far."""
    new: list[Fault] = []
    seen: set[str] = set()
    for path, row in _rows(file, faults):
        if isinstance(row, VariedField):
            new += _field_faults(row, path, design)
            if row.field in seen:
                new.append(Fault(f"{path}.field", row.field, "varied twice", "every field once"))
            seen.add(row.field)
        elif isinstance(row, Goal) and row.field:
            new += _goal_field_faults(row, path, file, design)
        else:
            new += _quantity_faults(row, path, design)
    if file.robust is not None and not design.tolerances:
        allowed = "a design with tolerances, or leave it out"
        new.append(Fault("robust", file.robust, "its design has no [[tolerances]]", allowed))
    return new


# -- rules -------------------------------------------------------------------------------------------------


def _no_faults(row: Any, path: str) -> Iterator[Fault]:
    return iter(())


_VALUES = "low and high | values | choices"


def _field_row_faults(row: VariedField, path: str) -> Iterator[Fault]:
    """Keys of a varied field that are missing, or exclude each other."""
    has_bounds = row.low is not None or row.high is not None or row.steps is not None or row.points is not None
    given = [has_bounds, bool(row.values), bool(row.choices)]
    if sum(given) != 1:
        yield Fault(path, MISSING, "its values are given twice" if any(given) else "has no values", _VALUES)
        return
    if not has_bounds:
        return
    for name in ("low", "high"):
        if getattr(row, name) is None:
            yield Fault(f"{path}.{name}", MISSING, "missing", "any number")
    if row.low is not None and row.high is not None and not row.low < row.high:
        yield Fault(f"{path}.high", row.high, "bounds are reversed", f"> {row.low:g}")
    if row.steps is not None and row.points is not None:
        yield Fault(f"{path}.points", row.points, "cannot be combined with steps", "steps | points")


def _limit_faults(row: StudyLimit, path: str) -> Iterator[Fault]:
    if row.min is None and row.max is None:
        yield Fault(path, MISSING, "limits nothing", "min, max or both")
    elif row.min is not None and row.max is not None and row.min > row.max:
        yield Fault(f"{path}.max", row.max, "bounds are reversed", f">= {row.min:g}")


def _goal_faults(row: Goal, path: str) -> Iterator[Fault]:
    if row.field and (row.quantity or row.of is not None):
        yield Fault(f"{path}.field", row.field, "cannot be combined with a quantity", "field, or quantity and of")
    elif not (row.field or row.quantity):
        yield Fault(
            f"{path}.quantity", MISSING, "missing", "a column, as pressure_angle_deg, a total, or field = a path"
        )


def _list_faults(file: StudyFile) -> Iterator[Fault]:
    """Different numbers of points, since the fields share one sequence, and too many goals."""
    stated = [(i, row.points) for i, row in enumerate(file.vary) if row.points is not None]
    for i, points in stated[1:]:
        if points != stated[0][1]:
            first = f"as many as vary[{stated[0][0]}].points: {stated[0][1]}"
            yield Fault(f"vary[{i}].points", points, "the fields with points share one sequence", first)
    if len(file.goals) > 2:
        yield Fault("goals", MISSING, f"{len(file.goals)} goals are too many", "one goal, or two for a front")


_ROW_FAULTS: Mapping[type, Any] = {
    VariedField: _field_row_faults,
    StudyLimit: _limit_faults,
    StudyQuantity: _no_faults,
    Goal: _goal_faults,
}


def field_info(design: Design, path: str) -> Info | None:
    """Info of a field that can be varied, a number or a choice of words; None where the path has none."""
    if path.endswith(".law") and path in set(all_paths(design)):
        return Info("Law", choices=tuple(LAWS))
    entry = entry_at(design, path)
    return None if entry is None or entry.info.flag else entry.info


def _field_faults(row: VariedField, path: str, design: Design) -> Iterator[Fault]:
    """Values that a field does not accept."""
    info = field_info(design, row.field)
    if info is None:
        known = ((path, field_info(design, path)) for path in all_paths(design))
        near = did_you_mean(
            row.field, (path for path, other in known if other is not None and bool(other.choices) == bool(row.choices))
        )
        yield Fault(
            f"{path}.field", row.field, f"no number or word of this design{near}", "a path, as cam.base_radius_mm"
        )
        return
    words = bool(info.choices)
    if words != bool(row.choices):
        yield Fault(
            f"{path}.field",
            row.field,
            f"requires {'words' if words else 'numbers'}",
            "choices" if words else "low and high | values",
        )
        return
    unit = split_unit(row.field)[1]
    given = [(f"{path}.{name}", getattr(row, name)) for name in ("low", "high") if getattr(row, name) is not None]
    for name, rows in (("values", row.values), ("choices", row.choices)):
        given += [(f"{path}.{name}[{i}]", value) for i, value in enumerate(rows)]
    for at, value in given:
        if info.whole and value != int(value):
            yield Fault(at, value, "must be a whole number", info.allowed(unit))
        elif not info.admits(int(value) if info.whole else value):
            yield Fault(at, value, info.problem, info.allowed(unit))


def _goal_field_faults(row: Goal, path: str, file: StudyFile, design: Design) -> Iterator[Fault]:
    """A goal field that is not varied, or a word."""
    numbers = [vary.field for vary in file.vary if not vary.choices]
    allowed = " | ".join(numbers) or "a number under [[vary]]"
    if row.field not in (vary.field for vary in file.vary):
        problem = f"is not varied{did_you_mean(row.field, numbers)}"
        yield Fault(f"{path}.field", row.field, problem, allowed)
    elif (info := field_info(design, row.field)) is not None and info.choices:
        yield Fault(f"{path}.field", row.field, "is a word, which has no greatest or least", allowed)


def _quantity_faults(row: StudyQuantity, path: str, design: Design) -> Iterator[Fault]:
    """A statistic of a total, a quantity without a statistic, or a quantity that the design lacks."""
    if row.quantity in TOTALS and row.of is not None:
        yield Fault(f"{path}.of", row.of, f"{row.quantity} is a total of the turn", "leave it out")
        return
    if row.quantity not in TOTALS and row.of is None:
        yield Fault(f"{path}.of", MISSING, "missing", " | ".join(STATISTICS))
        return
    try:
        quantity_request(design, row.key)
    except ValueError as error:
        yield Fault(f"{path}.quantity", row.quantity, str(error).partition(": ")[2])
