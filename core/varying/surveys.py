"""Numbers of a design varied between bounds, and what is asked of each design: along a line, over a map, at Sobol's points."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from math import floor, log10
from pathlib import Path

import numpy as np

from core.design import Design, Info, drive_at, edited, entries, get, names_a_link, only, path_of, row_at
from core.frozen import frozen
from core.study.limits import LIMITS
from core.study.quantity_requests import TORQUE, TOTALS, quantity_request, request_columns
from core.study.study import Study
from core.units import split_unit
from core.varying.request import (
    Goal,
    StudyFile,
    StudyLimit,
    StudyOfMany,
    StudyQuantity,
    VariedField,
    field_info,
    study_of,
)
from core.varying.space import sobol, study_values
from core.varying.tolerances import MACHINES, SHARE, Corner, Scatter, Share, TightenedTolerances

PART = 0.2  # of a number on either side of it, between which it is varied where nobody says
PART_OF_LARGEST = (
    0.05  # of the largest number of its table in the same unit: the least such part of one that may be negative
)
FEW = 5  # whole numbers on either side of one, at least
OF_ZERO = 10.0  # the same where all these are 0, in the unit
SUGGESTED = ("pressure_angle_deg:abs", "drive_torque_nm:abs", "driver_torque_nm:abs", "contact_force_n:abs")
ROUND = 2  # digits of such bounds
SEED = 1  # of the scrambled points
FINER, MOST_CELLS = 4, 500  # parts of a cell along each number; cells
Limits = tuple[float | None, float | None]
"""The least and the greatest value that are allowed."""


@frozen
class Span:
    """A number of the design and its bounds, in the unit of its field."""

    path: str
    low: float
    high: float


@frozen(eq=False)
class Survey:
    """spans: of p numbers; count: designs along each of one or two; points: (p, m); value: what is asked -> (m,), NaN where there is
    none; reason: (m,) code of why a design has no value, or cannot be built by; else empty.

    Over a map the first number runs fastest. Behind the count² designs of its grid stand those of finer cells, ``FINER`` times along each
    number; finer: their places (2, r) in that finer grid, the second number first.
    """

    spans: tuple[Span, ...]
    count: int
    points: np.ndarray
    value: Mapping[str, np.ndarray]
    reason: np.ndarray
    finer: np.ndarray = field(default_factory=lambda: np.zeros((2, 0), dtype=int))

    @property
    def fine(self) -> bool:
        """Whether there are finer cells."""
        return bool(self.finer.size)

    def axes(self, fine: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """The numbers along a map (n,), or those of its finer grid."""
        count = FINER * (self.count - 1) + 1 if fine else self.count
        x, y = (np.linspace(span.low, span.high, count) for span in self.spans)
        return x, y

    def grid(self, values: np.ndarray, fine: bool = False) -> np.ndarray:
        """Values (m,) over a map, the second number first; on the finer grid linear between designs where its cells were not computed,
        NaN where one of these has none."""
        n = self.count
        plain = np.asarray(values[: n * n], dtype=float).reshape(n, n)
        if not fine:
            return plain
        found = _between_nodes(_between_nodes(plain).T).T
        found[tuple(self.finer)] = values[n * n :]
        return found

    def nearest(self, at: Sequence[float]) -> int:
        """Number of the design next to a place, counted in parts of the bounds."""
        low, high = (np.array([getattr(span, end) for span in self.spans])[:, None] for end in ("low", "high"))
        away = (self.points - np.array(at)[:, None]) / (high - low)
        return int(np.argmin((away * away).sum(axis=0)))


def default_span(design: Design, path: str) -> Span:
    """Bounds about the number of the design, inside of the range of its field. Raises ValueError where it cannot be varied."""
    info, value = _info(design, path), get(design, path)
    if value is None:
        raise ValueError(f"{path}: has no value in this design")
    if info.whole:
        around = info.numbers or (value - (few := max(FEW, round(PART * abs(value)))), value + few)
        return Span(path, max(min(around), info.low), min(max(around), info.high))
    half = PART * abs(value)
    if info.low < 0.0:  # a place, or an angle: its size says nothing
        half = max(half, PART_OF_LARGEST * _largest_beside(design, path))
    half = half or (OF_ZERO if split_unit(path)[1].symbol else 1.0)
    power = floor(log10(half)) - ROUND + 1
    low, high = (round(value + side * half, -power) for side in (-1.0, 1.0))
    floor_of = info.low + 10.0**power if info.open_low else info.low
    return Span(path, max(low, floor_of), min(high, info.high))


def _info(design: Design, path: str) -> Info:
    """What a number takes. Raises ValueError where there is none, or it names a part."""
    info = field_info(design, path)
    if info is None or info.choices or names_a_link(path, info):
        raise ValueError(f"{path}: only a number can be varied, and none that names a link")
    return info


def whole_numbers(design: Design, paths: Iterable[str]) -> dict[str, Info]:
    """Those of these paths at which whole numbers stand, each with what it takes."""
    rows = ((path, field_info(design, path)) for path in paths)
    return {path: info for path, info in rows if info is not None and info.whole}


def _stepped(info: Info, values: np.ndarray) -> np.ndarray:
    """The whole numbers next to values (m,), of those that the field takes."""
    if not info.numbers:
        return np.rint(values)
    each = np.array(sorted(info.numbers), dtype=float)
    return np.asarray(each[np.abs(values[:, None] - each).argmin(axis=1)])


def default_tolerance(design: Design, path: str) -> float:
    """± of a number of which nobody says it: 0.05 mm or °, else 1 % of it."""
    if split_unit(path)[1].symbol in ("mm", "°"):
        return 0.05
    value = abs(float(get(design, path)))
    return float(f"{0.01 * value:.1g}") if value else 0.01


def _largest_beside(design: Design, path: str) -> float:
    unit = split_unit(path)[1]
    rows = (
        get(design, each)
        for each in can_be_varied(design)
        if split_unit(each)[1] == unit and _table(each) == _table(path)
    )
    return max(map(abs, rows), default=0.0)


def _table(path: str) -> str:
    own = drive_at(path)
    return path.partition(".")[0] if own is None else f"{own[0]}.{own[1].partition('.')[0]}"


def can_be_varied(design: Design) -> Iterator[str]:
    """Paths of the numbers that can be varied, in the order of the file; whole numbers that name a link are none."""
    for name in design.tables:
        for each in entries(design, name):
            info = each.info
            if type(each.value) in (int, float) and not (info.choices or info.flag or names_a_link(each.path, info)):
                yield each.path


def request_keys(design: Design) -> Iterator[str]:
    """Keys of what can be asked over the turn, without what of it (``pressure_angle_deg``, ``drives[0].…``), and totals."""
    yield from request_columns(design)
    for total in TOTALS:
        try:
            quantity_request(design, total)
        except ValueError:
            continue
        yield total


def suggested_figures(study: Study, path: str) -> Mapping[str, Limits]:
    """Keys of what is asked first where a number at a path is varied, with the least and greatest values that are usual."""
    design, own = study.design, drive_at(path) if study.design.listed else None
    number = own[0] if own else 0
    drive = list(study.drives.values())[number]
    there, found = set(request_columns(only(design, number))), {}
    rows = SUGGESTED[:1] if drive.loading.is_empty else SUGGESTED  # no forces
    for key in (key for key in rows if key.partition(":")[0] in there):
        found[path_of(number, key) if design.listed else key] = (None, typical_limit(drive, key))
    if design.listed and any(each.loads_shaft for each in study.drives.values()):
        found[f"{TORQUE}:abs"] = (None, None)
    if found:
        return found
    columns = request_columns(design)
    turned = next((each for each in columns if "transmission" in each), "")
    return {f"{turned}:min" if turned else f"{columns[0]}:abs": (None, None)}


def typical_limit(drive: Study, key: str) -> float | None:
    """The greatest value of what is asked of a drive that its design states, or that is usual; None where there is none."""
    if not key.startswith("pressure_angle"):
        return None
    stated = drive.design.drive.limits.pressure_angle_rise_deg
    usual = LIMITS["pressure_angle_rise_deg"].typical(drive)
    return stated if stated is not None else None if usual is None else usual.value


def survey_points(spans: Sequence[Span], count: int, seed: int = SEED) -> np.ndarray:
    """Numbers (p, m): evenly along one span, at a grid over two, count designs along each; of more Sobol's points, the next power of two
    from count² on."""
    low, high = (np.array([getattr(span, end) for span in spans])[:, None] for end in ("low", "high"))
    if len(spans) == 1:
        part = np.linspace(0.0, 1.0, count)[None, :]
    elif len(spans) == 2:
        even = np.linspace(0.0, 1.0, count)
        part = np.stack([np.tile(even, count), np.repeat(even, count)])
    else:
        part = sobol(len(spans), seed, 0, 1 << (count * count - 1).bit_length()).T
    return np.asarray(low + (high - low) * part)


def survey(design: Design, spans: Sequence[Span], quantities: Sequence[str], count: int, seed: int = SEED) -> Survey:
    """What is asked (keys of ``many``) of the designs with these numbers, whole ones rounded, extremes unpolished. Raises ValueError as
    ``many``, and where bounds are reversed or outside the range of their field."""
    for span in spans:
        path, info = span.path, _info(design, span.path)
        if not span.low < span.high:
            raise ValueError(f"{path}: bounds are reversed: {span.low:g} is not below {span.high:g}")
        if not all(info.admits(round(end) if info.whole else end) for end in (span.low, span.high)):
            raise ValueError(f"{path}: bounds {span.low:g} ... {span.high:g} outside the range of the field")
    return Survey(tuple(spans), count, *_asked(design, spans, survey_points(spans, count, seed), quantities))


def _asked(
    design: Design, spans: Sequence[Span], points: np.ndarray, quantities: Sequence[str]
) -> tuple[np.ndarray, Mapping[str, np.ndarray], np.ndarray]:
    """Numbers (p, m), those that are whole next to these; what is asked of the designs, each computed once; why one has none (m,)."""
    rows = tuple(VariedField(field=span.path, low=span.low, high=span.high) for span in spans)
    wanted = tuple(StudyQuantity(*_parted(key)) for key in quantities)
    study = StudyOfMany(design, StudyFile(design="", vary=rows, quantities=wanted), Path())
    once, back = points, np.arange(points.shape[1])
    if whole := whole_numbers(design, study.infos):
        stepped = [
            _stepped(whole[s.path], row) if s.path in whole else row for s, row in zip(spans, points, strict=True)
        ]
        points = np.array(stepped)
        once, back = np.unique(points, axis=1, return_inverse=True)
    value, reason = study_values(study, {span.path: row for span, row in zip(spans, once, strict=True)}, polish=False)
    return points, dict(zip(quantities, value[:, back.ravel()], strict=True)), reason[back.ravel()]


def refined_survey(design: Design, found: Survey, limits: Mapping[str, Limits]) -> Survey:
    """A map with finer cells where a limit runs, and at the edge of what can be built; the cells of limits first, where there are too
    many."""
    n = found.count
    edges, cut = _mixed(found.grid(found.reason == "") > 0.0), np.zeros((n - 1, n - 1), dtype=bool)
    for key, ends in limits.items():
        value = found.grid(found.value[key])
        known = ~_mixed(np.isfinite(value)) & np.isfinite(value[:-1, :-1])
        for end in ends:
            if end is not None:
                cut |= known & _mixed(value > end)
    cells = np.concatenate([np.argwhere(cut), np.argwhere(edges & ~cut)])[:MOST_CELLS]
    if not cells.size:
        return found
    inside = np.stack(np.meshgrid(*(np.arange(FINER + 1),) * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    places = np.unique((FINER * cells[:, None] + inside).reshape(-1, 2), axis=0)
    places = places[(places % FINER).any(axis=1)].T
    x, y = found.axes(fine=True)
    points = np.stack([x[places[1]], y[places[0]]])
    points, more, reason = _asked(design, found.spans, points, list(found.value))
    every = {key: np.concatenate([row, more[key]]) for key, row in found.value.items()}
    return replace(
        found,
        points=np.hstack([found.points, points]),
        value=every,
        reason=np.concatenate([found.reason, reason]),
        finer=places,
    )


def _mixed(flags: np.ndarray) -> np.ndarray:
    """Cells (n - 1, n - 1) of a grid whose corners are not all the same."""
    corners = np.stack([flags[:-1, :-1], flags[:-1, 1:], flags[1:, :-1], flags[1:, 1:]])
    return np.asarray(corners.any(axis=0) & ~corners.all(axis=0))


def _between_nodes(rows: np.ndarray) -> np.ndarray:
    """Rows (m, n), linear at ``FINER`` places from each node to the next."""
    part = np.arange(FINER) / FINER
    ahead = rows[:, :-1, None] * (1.0 - part) + rows[:, 1:, None] * part
    ahead[:, :, 0] = rows[:, :-1]  # though the next one has no value
    return np.hstack([ahead.reshape(rows.shape[0], -1), rows[:, -1:]])


def with_values(design: Design, values: Mapping[str, float]) -> Design:
    """The design with these numbers at their paths, whole ones rounded, and what goes with them. It may have faults."""
    whole = whole_numbers(design, values)
    for path, info in whole.items():
        design = edited(design, path, int(_stepped(info, np.array([values[path]]))[0]))
    values = {path: value for path, value in values.items() if path not in whole}
    if design.listed:
        from core.study.batch import with_numbers

        return with_numbers(design, list(values), list(values.values()))
    kept = {row_at(path)[1] for path in values if path.startswith("motion.")}
    for path, value in values.items():
        design = edited(design, path, value, kept)
    return design


def current_figures(study: Study, quantities: Sequence[str]) -> tuple[Mapping[str, float], str]:
    """What is asked (keys of ``many``) of one design, extremes refined; and the code of why something of it has no value, else empty.
    Raises ValueError as ``many``."""
    from core.study.batch import study_figures

    asked = [quantity_request(study.design, key) for key in quantities]
    values, _, reason = study_figures(study, asked)
    return {each.key: value / each.unit for each, value in zip(asked, values, strict=True)}, reason


@frozen
class Question:
    """What a study asks, by path and key: numbers between bounds; words, of which some are tried; keys of ``many`` with their least and
    greatest value; goals, at most two, with whether they are made small; the share of machines that must keep the limits; and the rows
    of a file that list values, or state steps or points, which count as long as the bounds are theirs."""

    spans: tuple[Span, ...] = ()
    words: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    asked: Mapping[str, Limits] = field(default_factory=dict)
    goals: Mapping[str, bool] = field(default_factory=dict)
    robust: float | None = None
    typed: Mapping[str, VariedField] = field(default_factory=dict)
    seed: int = SEED

    def row(self, span: Span) -> VariedField:
        """As a file has it."""
        typed = self.typed.get(span.path)
        return typed if typed is not None and span_of(typed) == span else VariedField(span.path, span.low, span.high)


def span_of(row: VariedField) -> Span:
    """The bounds of a number, of values that are listed the least and the greatest."""
    ends = row.values or (row.low, row.high)
    return Span(row.field, min(ends), max(ends))  # type: ignore[type-var, arg-type]


def file_of_question(question: Question, design: str = "") -> StudyFile:
    """The same as a file; design: its file, relative to the study's."""
    return StudyFile(
        design=design,
        seed=question.seed,
        robust=question.robust,
        vary=(
            *(question.row(span) for span in question.spans),
            *(VariedField(field=path, choices=words) for path, words in question.words.items()),
        ),
        quantities=tuple(StudyQuantity(*_parted(key)) for key in question.asked),
        limits=_bounded(question.asked),
        goals=tuple(Goal(*_parted(key), minimise=small) for key, small in question.goals.items()),
    )


def question_of_file(file: StudyFile) -> Question:
    """The inverse."""
    spans: list[Span] = []
    words: dict[str, tuple[str, ...]] = {}
    asked: dict[str, Limits] = {}
    for row in file.vary:
        if row.choices:
            words[row.field] = row.choices
        else:
            spans.append(span_of(row))
    for each in (*file.limits, *file.quantities, *file.goals):
        least, most = asked.get(each.key, (None, None))
        asked[each.key] = (
            _of_two(max, least, getattr(each, "min", None)),
            _of_two(min, most, getattr(each, "max", None)),
        )
    typed = {row.field: row for row in file.vary if row.values or row.steps or row.points}
    goals = {goal.key: goal.minimise for goal in file.goals}
    return Question(tuple(spans), words, asked, goals, file.robust, typed, file.seed)


def _of_two(pick: Callable[[float, float], float], one: float | None, other: float | None) -> float | None:
    return other if one is None else one if other is None else pick(one, other)


def _parted(key: str) -> tuple[str, str | None]:
    slug, _, of = key.partition(":")
    return slug, of or None


def _bounded(limits: Mapping[str, Limits]) -> tuple[StudyLimit, ...]:
    return tuple(StudyLimit(*_parted(key), *ends) for key, ends in limits.items() if ends != (None, None))


@frozen(eq=False)
class ToleranceResult:
    """What the tolerances of a design do: how many machines keep the limits; the worst case of each limit; what is asked -> field ->
    (change of it per unit of the field, part of its variance that comes from there), the largest part first; and the cheapest tolerances
    to halve where fewer than 99.73 % keep the limits, None where they do, or no such set is found, or sought."""

    share: Share | None
    corners: Sequence[Corner]
    parts: Mapping[str, Mapping[str, tuple[float, float]]]
    tighter: TightenedTolerances | None = None


def tolerance_result(
    design: Design, asked: Mapping[str, Limits], tighten: bool = True, machines: int = MACHINES, seed: int = SEED
) -> ToleranceResult:
    """The machines that are made of a design, and of what is asked of them (keys of ``many`` -> least and greatest value); no share where
    nothing is limited. tighten: whether the tolerances to halve are sought, too.

    Raises KindynaError where the design has no tolerance, the limits do not fit it, or it has no answer itself.
    """
    scatter = Scatter(study_of(file_of_question(Question(asked=asked)), design))
    slopes = scatter.slopes()
    parts = scatter.parts(slopes)
    fields = list(scatter.nominal)
    by_key = {
        key: {fields[i]: (float(slopes[i, q]), float(parts[i, q])) for i in np.argsort(-parts[:, q], kind="stable")}
        for q, key in enumerate(scatter.keys)
    }
    if not scatter.study.file.limits:
        return ToleranceResult(None, (), by_key)
    share = scatter.share(machines, seed)
    tighter = scatter.tightened(machines, seed, slopes) if tighten and share.value < SHARE else None
    return ToleranceResult(share, scatter.corners(slopes), by_key, tighter)


__all__ = [
    "Limits",
    "Question",
    "Span",
    "Survey",
    "ToleranceResult",
    "can_be_varied",
    "current_figures",
    "default_span",
    "default_tolerance",
    "file_of_question",
    "question_of_file",
    "refined_survey",
    "request_keys",
    "suggested_figures",
    "survey",
    "survey_points",
    "tolerance_result",
    "typical_limit",
    "whole_numbers",
    "with_values",
]
