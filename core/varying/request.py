"""What a study of many designs asks, as its file has it: STUDY.toml, with all faults of the file reported at once."""

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
"""Steps of a field of which bounds alone are given, where there are two, and where it is the only one."""
POINTS = 4096
"""Sobol points of three such fields or more."""


@frozen
class Vary:
    """A field that is varied: a number between bounds, in even steps or by Sobol's points, or of listed values; or a word of choices."""

    field: str = placed(FileLayout(missing="the path of a number or word of the design, as cam.base_radius_mm"))
    low: float | None = number("Lowest value", default=None)
    high: float | None = number("Highest value", default=None)
    steps: int | None = whole("Values", 2, 10**12, default=None, help="so many, evenly spaced from low to high")
    points: int | None = whole("Points", 1, 10**12, default=None, help="so many, of Sobol's sequence")
    values: tuple[float, ...] = placed(FileLayout(each=float), ())
    choices: tuple[str, ...] = placed(FileLayout(each=str), ())


@frozen
class AskedFor:
    """What is asked of each design: of a quantity over the turn, by its column, or a total, which has no ``of``."""

    quantity: str = placed(FileLayout(missing="a column, as pressure_angle_deg, or a total"))
    of: str | None = choice("Of the turn", STATISTICS, default=None)

    @property
    def key(self) -> str:
        """As ``core.study.many`` is asked."""
        return self.quantity if self.of is None else f"{self.quantity}:{self.of}"

    @property
    def column(self) -> str:
        """Heading in tables."""
        return self.quantity if self.of is None else f"{self.quantity}_{self.of}"


@frozen
class Bounded(AskedFor):
    """A limit: what it is of, and between which values that must lie."""

    FILE_ORDER = ("quantity", "of", "min", "max")

    min: float | None = number("Least value", default=None)
    max: float | None = number("Greatest value", default=None)


@frozen
class Goal(AskedFor):
    """What is made as small as can be, or as large."""

    FILE_ORDER = ("quantity", "of", "minimise")

    minimise: bool = flag("Minimise", default=True)


@frozen(kw_only=True)
class StudyFile:
    """A study as typed. design: its file, relative to the study's; robust: share of machines within the limits, by the tolerances
    of the design."""

    design: str = placed(FileLayout(missing="a design file, relative to this one"))
    seed: int = whole("Seed", 0, 2**32 - 1, default=0)
    robust: float | None = number("Share within limits", 0.0, 0.99999, open_low=True, default=None)
    vary: tuple[Vary, ...] = placed(FileLayout(Vary), ())
    quantities: tuple[AskedFor, ...] = placed(FileLayout(AskedFor), ())
    limits: tuple[Bounded, ...] = placed(FileLayout(Bounded), ())
    goals: tuple[Goal, ...] = placed(FileLayout(Goal), ())


@frozen(eq=False)
class StudyOfMany:
    """A study with the design whose numbers it varies. folder: where results that are kept stand."""

    base: Design
    file: StudyFile
    folder: Path

    @cached_property
    def asked(self) -> tuple[AskedFor, ...]:
        """What is asked of each design: the quantities, then those of limits and goals, each once."""
        rows = (*self.file.quantities, *self.file.limits, *self.file.goals)
        return tuple({row.key: row for row in reversed(rows)}[key] for key in dict.fromkeys(row.key for row in rows))

    @cached_property
    def infos(self) -> Mapping[str, Info]:
        """Of each field that is varied, what it takes."""
        return {row.field: field_info(self.base, row.field) for row in self.file.vary}  # type: ignore[misc]


# -- the file ---------------------------------------------------------------------------------------------


def load_study(path: AnyPath) -> StudyOfMany:
    """The study in a file. Raises FileError where it or its design cannot be read, DesignError with all faults of either."""
    file, found = _read(parsed(read_text(path), str(path)))
    if any(fault.path == "design" for fault in found):
        raise DesignError(found)
    beside = Path(path).parent / file.design
    design = load(beside)
    if found := [*found, *_unfit(file, design, found)]:
        raise DesignError(found)
    return StudyOfMany(design, file, beside.parent)


def file_of(table: Mapping[str, Any]) -> StudyFile:
    """The study in the tables of a file, as far as that can be told without its design. Raises DesignError with all faults."""
    file, found = _read(table)
    if found:
        raise DesignError(found)
    return file


def study_of(file: StudyFile, design: Design, folder: Path = Path()) -> StudyOfMany:
    """The study of a design. Raises DesignError with all that does not fit it."""
    if found := _unfit(file, design, ()):
        raise DesignError(found)
    return StudyOfMany(design, file, folder)


def save_study(file: StudyFile, path: AnyPath, *, in_place: bool = False) -> str:
    """Write a study, whole or not at all; the text that the file holds now. Raises as ``file_of``, FileError where it cannot be
    written."""
    text = dumps_table(file)
    file_of(parsed(text, str(path)))
    write(path, text, in_place=in_place)
    return text


def _read(table: Mapping[str, Any]) -> tuple[StudyFile, list[Fault]]:
    """A study as far as it can be read, and what is wrong with it by itself."""
    reader = Reader("")
    file: StudyFile = reader.part(StudyFile, table, "")
    found = [replace(f, path=f.path.removeprefix(".")) for f in reader.with_rules(part_faults(file, ""), {})]
    for path, row in _rows(file, found):
        found += _OWN[type(row)](row, path)
    return file, [*found, *_one_number_of_points(file)]


def _rows(file: StudyFile, found: Sequence[Fault]) -> Iterator[tuple[str, Any]]:
    """The rows of its lists that have none of these faults, each with its path."""
    for name in ("vary", "quantities", "limits", "goals"):
        for i, row in enumerate(getattr(file, name)):
            path = f"{name}[{i}]"
            if not any(fault.path == path or fault.path.startswith(f"{path}.") for fault in found):
                yield path, row


def _unfit(file: StudyFile, design: Design, found: Sequence[Fault]) -> list[Fault]:
    """What does not fit the design, of the rows that have no fault yet."""
    new: list[Fault] = []
    seen: set[str] = set()
    for path, row in _rows(file, found):
        if isinstance(row, Vary):
            new += _field_faults(row, path, design)
            if row.field in seen:
                new.append(Fault(f"{path}.field", row.field, "varied twice", "each field once"))
            seen.add(row.field)
        else:
            new += _asked_faults(row, path, design)
    if file.robust is not None and not design.tolerances:
        allowed = "a design with them, or leave it out"
        new.append(Fault("robust", file.robust, "its design has no [[tolerances]]", allowed))
    return new


# -- rules -------------------------------------------------------------------------------------------------


def _nothing(row: Any, path: str) -> Iterator[Fault]:
    return iter(())


_WAYS = "low and high | values | choices"


def _one_way(row: Vary, path: str) -> Iterator[Fault]:
    """What is said of a field fits together."""
    between = row.low is not None or row.high is not None or row.steps is not None or row.points is not None
    ways = [between, bool(row.values), bool(row.choices)]
    if sum(ways) != 1:
        yield Fault(path, MISSING, "takes exactly one of its ways" if any(ways) else "says no values", _WAYS)
        return
    if not between:
        return
    for name in ("low", "high"):
        if getattr(row, name) is None:
            yield Fault(f"{path}.{name}", MISSING, "missing", "any number")
    if row.low is not None and row.high is not None and not row.low < row.high:
        yield Fault(f"{path}.high", row.high, "bounds are reversed", f"> {row.low:g}")
    if row.steps is not None and row.points is not None:
        yield Fault(f"{path}.points", row.points, "stands beside steps", "steps | points")


def _two_bounds(row: Bounded, path: str) -> Iterator[Fault]:
    if row.min is None and row.max is None:
        yield Fault(path, MISSING, "limits nothing", "min, max or both")
    elif row.min is not None and row.max is not None and row.min > row.max:
        yield Fault(f"{path}.max", row.max, "bounds are reversed", f">= {row.min:g}")


def _one_number_of_points(file: StudyFile) -> Iterator[Fault]:
    """The points of several fields are those of one sequence."""
    stated = [(i, row.points) for i, row in enumerate(file.vary) if row.points is not None]
    for i, points in stated[1:]:
        if points != stated[0][1]:
            first = f"as many as vary[{stated[0][0]}].points: {stated[0][1]}"
            yield Fault(f"vary[{i}].points", points, "the fields with points share one sequence", first)
    if len(file.goals) > 2:
        yield Fault("goals", MISSING, f"{len(file.goals)} goals are too many", "one, or two, which give a front")


_OWN: Mapping[type, Any] = {Vary: _one_way, Bounded: _two_bounds, AskedFor: _nothing, Goal: _nothing}


def field_info(design: Design, path: str) -> Info | None:
    """What a field takes that can be varied: a number, or a word of some; None where there is none at the path."""
    if path.endswith(".law") and path in set(all_paths(design)):
        return Info("Law", choices=tuple(LAWS))
    entry = entry_at(design, path)
    return None if entry is None or entry.info.flag else entry.info


def _field_faults(row: Vary, path: str, design: Design) -> Iterator[Fault]:
    """What a field does not take."""
    info = field_info(design, row.field)
    if info is None:
        known = ((path, field_info(design, path)) for path in all_paths(design))
        near = did_you_mean(
            row.field, (path for path, each in known if each is not None and bool(each.choices) == bool(row.choices))
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
            f"takes {'words' if words else 'numbers'}",
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


def _asked_faults(row: AskedFor, path: str, design: Design) -> Iterator[Fault]:
    """What a design lacks of which something is asked."""
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
