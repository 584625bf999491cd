"""Surveys: figures of a design over one or more varied numbers, along a line, over a map, or at Sobol's points."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from math import floor, log10
from pathlib import Path

import numpy as np

from core.design import Design, Info, drive_at, edited, entries, get, names_a_link, only, path_of, varied
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

PART = 0.2  # of a number: default bounds on both sides of it
PART_OF_LARGEST = 0.05  # of the largest number of its table in the same unit: at least, for one that may be negative
FEW = 5  # whole numbers on both sides of one, at least
AROUND_ZERO = 10.0  # in the unit, where all these are 0
SUGGESTED = ("pressure_angle_deg:abs", "drive_torque_nm:abs", "driver_torque_nm:abs", "contact_force_n:abs")
DIGITS = 2  # of default bounds
SEED = 1  # of the scrambled points
FINER, MAX_CELLS = 4, 500  # parts of a cell along every number; cells
Limits = tuple[float | None, float | None]
"""Least and greatest allowed value."""


@frozen
class Span:
    """Path of a number and its bounds, in the unit of the field."""

    path: str
    low: float
    high: float


@frozen(eq=False)
class Survey:
    """Figures of m designs that differ in p numbers.

    Over a map the first number runs fastest. The count² designs of its grid are followed by those of finer cells, with
    ``FINER`` times as many steps along every number.

    Attributes
    ----------
    spans : tuple of Span
        Bounds of the p numbers.
    count : int
        Number of designs along each of one or two numbers.
    points : ndarray (p, m)
        The numbers, in the units of their fields.
    value : mapping of str -> ndarray (m,)
        Key of a figure -> its values; NaN where a design has none.
    reason : ndarray (m,)
        Code that says why a design has no value; else empty.
    finer : ndarray (2, r)
        Indices of the finer designs in the finer grid, the second number first.
    """

    spans: tuple[Span, ...]
    count: int
    points: np.ndarray
    value: Mapping[str, np.ndarray]
    reason: np.ndarray
    finer: np.ndarray = field(default_factory=lambda: np.zeros((2, 0), dtype=int))

    @property
    def is_refined(self) -> bool:
        """Whether the map has finer cells."""
        return bool(self.finer.size)

    def axes(self, fine: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Numbers along the two axes of a map, or of its finer grid.

        Parameters
        ----------
        fine : bool
            Take the finer grid.

        Returns
        -------
        x, y : ndarray (n,) [unit of the field]
        """
        count = FINER * (self.count - 1) + 1 if fine else self.count
        x, y = (np.linspace(span.low, span.high, count) for span in self.spans)
        return x, y

    def grid(self, values: np.ndarray, fine: bool = False) -> np.ndarray:
        """Values over a map, the second number first.

        Parameters
        ----------
        values : ndarray (m,) [unit of the figure]
        fine : bool
            Take the finer grid; where it was not computed values are linear between designs, and NaN next to a NaN.

        Returns
        -------
        ndarray (n, n) [unit of the figure]
        """
        n = self.count
        coarse = np.asarray(values[: n * n], dtype=float).reshape(n, n)
        if not fine:
            return coarse
        result = _interpolated(_interpolated(coarse).T).T
        result[tuple(self.finer)] = values[n * n :]
        return result

    def nearest(self, at: Sequence[float]) -> int:
        """Number of the design nearest to a point, measured in parts of the bounds."""
        low, high = (np.array([getattr(span, end) for span in self.spans])[:, None] for end in ("low", "high"))
        distance = (self.points - np.array(at)[:, None]) / (high - low)
        return int(np.argmin((distance * distance).sum(axis=0)))


def default_span(design: Design, path: str) -> Span:
    """Default bounds about a number, within the range of its field. Raises ValueError where it cannot be varied."""
    info, value = _info(design, path), get(design, path)
    if value is None:
        raise ValueError(f"{path}: has no value in this design")
    if info.whole:
        around = info.numbers or (value - (few := max(FEW, round(PART * abs(value)))), value + few)
        return Span(path, max(min(around), info.low), min(max(around), info.high))
    half = PART * abs(value)
    if info.low < 0.0:  # a coordinate or an angle: its size has no meaning
        half = max(half, PART_OF_LARGEST * _largest_number(design, path))
    half = half or (AROUND_ZERO if split_unit(path)[1].symbol else 1.0)
    power = floor(log10(half)) - DIGITS + 1
    low, high = (round(value + side * half, -power) for side in (-1.0, 1.0))
    lowest = info.low + 10.0**power if info.open_low else info.low
    return Span(path, max(low, lowest), min(high, info.high))


def _info(design: Design, path: str) -> Info:
    """Info of a number. Raises ValueError where the path has no number, or the number names a link."""
    info = field_info(design, path)
    if info is None or info.choices or names_a_link(path, info):
        raise ValueError(f"{path}: only a number can be varied, except the number of a link")
    return info


def whole_numbers(design: Design, paths: Iterable[str]) -> dict[str, Info]:
    """Path -> info of its field, of those paths that have whole numbers."""
    rows = ((path, field_info(design, path)) for path in paths)
    return {path: info for path, info in rows if info is not None and info.whole}


def _whole_values(info: Info, values: np.ndarray) -> np.ndarray:
    """Nearest whole numbers (m,) to values (m,), of those that the field allows."""
    if not info.numbers:
        return np.rint(values)
    allowed = np.array(sorted(info.numbers), dtype=float)
    return np.asarray(allowed[np.abs(values[:, None] - allowed).argmin(axis=1)])


def default_tolerance(design: Design, path: str) -> float:
    """Default tolerance ± of a number: 0.05 mm or 0.05°, else 1 % of it."""
    if split_unit(path)[1].symbol in ("mm", "°"):
        return 0.05
    value = abs(float(get(design, path)))
    return float(f"{0.01 * value:.1g}") if value else 0.01


def _largest_number(design: Design, path: str) -> float:
    """Largest size of the numbers in the same table and unit."""
    unit, table = split_unit(path)[1], _table(path)
    paths = (p for p in can_be_varied(design) if split_unit(p)[1] == unit and _table(p) == table)
    return max((abs(get(design, p)) for p in paths), default=0.0)


def _table(path: str) -> str:
    at = drive_at(path)
    return path.partition(".")[0] if at is None else f"{at[0]}.{at[1].partition('.')[0]}"


def can_be_varied(design: Design) -> Iterator[str]:
    """Paths of the numbers that can be varied, in the order of the file, without numbers of links."""
    for name in design.tables:
        for entry in entries(design, name):
            info = entry.info
            if type(entry.value) in (int, float) and not (info.choices or info.flag or names_a_link(entry.path, info)):
                yield entry.path


def request_keys(design: Design) -> Iterator[str]:
    """Columns that have statistics over the turn (``pressure_angle_deg``, ``drives[0].…``), and totals of a design."""
    yield from request_columns(design)
    for total in TOTALS:
        try:
            quantity_request(design, total)
        except ValueError:
            continue
        yield total


def suggested_figures(study: Study, path: str) -> Mapping[str, Limits]:
    """Figures to begin with where the number at a path is varied, with their typical limits."""
    design, at = study.design, drive_at(path) if study.design.listed else None
    number = at[0] if at else 0
    drive = list(study.drives.values())[number]
    columns, figures = set(request_columns(only(design, number))), {}
    rows = SUGGESTED[:1] if drive.loading.is_empty else SUGGESTED  # no forces
    for key in (key for key in rows if key.partition(":")[0] in columns):
        figures[path_of(number, key) if design.listed else key] = (None, typical_limit(drive, key))
    if design.listed and any(drive.loads_shaft for drive in study.drives.values()):
        figures[f"{TORQUE}:abs"] = (None, None)
    if figures:
        return figures
    first, *_ = slugs = request_columns(design)
    transmission = next((slug for slug in slugs if "transmission" in slug), "")
    return {f"{transmission}:min" if transmission else f"{first}:abs": (None, None)}


def typical_limit(drive: Study, key: str) -> float | None:
    """Greatest allowed value of a figure by its key: the limit of the design, else the typical one; None where it has none."""
    if not key.startswith("pressure_angle"):
        return None
    limit = drive.design.drive.limits.pressure_angle_rise_deg
    if limit is not None:
        return limit
    typical = LIMITS["pressure_angle_rise_deg"].typical(drive)
    return None if typical is None else typical.value


def survey_points(spans: Sequence[Span], count: int, seed: int = SEED) -> np.ndarray:
    """Numbers of the designs of a survey.

    They are even along one span, a grid over two, and of more spans Sobol's points, the next power of two from count² on.

    Parameters
    ----------
    spans : sequence of Span
        Bounds of p numbers.
    count : int
        Number of designs along one number.
    seed : int

    Returns
    -------
    ndarray (p, m) [unit of the field]
    """
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
    """Survey of figures (keys as for ``many``) over numbers between bounds; whole numbers are rounded, extremes not refined.

    Raises ValueError as ``many``, and where bounds are reversed or outside the range of their field.
    """
    for span in spans:
        path, info = span.path, _info(design, span.path)
        if not span.low < span.high:
            raise ValueError(f"{path}: bounds are reversed: {span.low:g} is not below {span.high:g}")
        if not all(info.admits(round(end) if info.whole else end) for end in (span.low, span.high)):
            raise ValueError(f"{path}: bounds {span.low:g} ... {span.high:g} are outside the range of the field")
    return Survey(tuple(spans), count, *_figures(design, spans, survey_points(spans, count, seed), quantities))


def _figures(
    design: Design, spans: Sequence[Span], points: np.ndarray, quantities: Sequence[str]
) -> tuple[np.ndarray, Mapping[str, np.ndarray], np.ndarray]:
    """Numbers (p, m) with whole ones rounded, figures of the designs, computed without repetition, and reasons (m,)."""
    rows = tuple(VariedField(field=span.path, low=span.low, high=span.high) for span in spans)
    figures = tuple(StudyQuantity(*split_key(key)) for key in quantities)
    study = StudyOfMany(design, StudyFile(design="", vary=rows, quantities=figures), Path())
    distinct, inverse = points, np.arange(points.shape[1])
    if whole_infos := whole_numbers(design, study.infos):
        rounded = [
            _whole_values(whole_infos[s.path], row) if s.path in whole_infos else row
            for s, row in zip(spans, points, strict=True)
        ]
        points = np.array(rounded)
        distinct, inverse = np.unique(points, axis=1, return_inverse=True)
    results = study_values(study, {span.path: row for span, row in zip(spans, distinct, strict=True)}, polish=False)
    which = inverse.ravel()
    return points, {key: results.value[key][which] for key in quantities}, results.reason[which]


def refined_survey(design: Design, survey: Survey, limits: Mapping[str, Limits]) -> Survey:
    """A map with finer cells at the curves of limits and at the edge of the buildable region; those of limits first."""
    n = survey.count
    edges, cut = _mixed(survey.grid(survey.reason == "") > 0.0), np.zeros((n - 1, n - 1), dtype=bool)
    for key, ends in limits.items():
        value = survey.grid(survey.value[key])
        known = ~_mixed(np.isfinite(value)) & np.isfinite(value[:-1, :-1])
        for end in ends:
            if end is not None:
                cut |= known & _mixed(value > end)
    cells = np.concatenate([np.argwhere(cut), np.argwhere(edges & ~cut)])[:MAX_CELLS]
    if not cells.size:
        return survey
    inside = np.stack(np.meshgrid(*(np.arange(FINER + 1),) * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    indices = np.unique((FINER * cells[:, None] + inside).reshape(-1, 2), axis=0)
    indices = indices[(indices % FINER).any(axis=1)].T
    x, y = survey.axes(fine=True)
    points = np.stack([x[indices[1]], y[indices[0]]])
    points, finer_values, reason = _figures(design, survey.spans, points, list(survey.value))
    values = {key: np.concatenate([row, finer_values[key]]) for key, row in survey.value.items()}
    return replace(
        survey,
        points=np.hstack([survey.points, points]),
        value=values,
        reason=np.concatenate([survey.reason, reason]),
        finer=indices,
    )


def _mixed(flags: np.ndarray) -> np.ndarray:
    """Mask (n - 1, n - 1) of the cells of a grid (n, n) whose corners differ."""
    corners = np.stack([flags[:-1, :-1], flags[:-1, 1:], flags[1:, :-1], flags[1:, 1:]])
    return np.asarray(corners.any(axis=0) & ~corners.all(axis=0))


def _interpolated(rows: np.ndarray) -> np.ndarray:
    """Rows (m, n) with ``FINER`` linear steps from every node to the next."""
    part = np.arange(FINER) / FINER
    ahead = rows[:, :-1, None] * (1.0 - part) + rows[:, 1:, None] * part
    ahead[:, :, 0] = rows[:, :-1]  # even where the next node has no value
    return np.hstack([ahead.reshape(rows.shape[0], -1), rows[:, -1:]])


def with_values(design: Design, values: Mapping[str, float]) -> Design:
    """The design with numbers at paths, whole ones rounded, and with the edits that follow from them; it may have faults."""
    whole_infos = whole_numbers(design, values)
    for path, info in whole_infos.items():
        design = edited(design, path, int(_whole_values(info, np.array([values[path]]))[0]))
    values = {path: value for path, value in values.items() if path not in whole_infos}
    return varied(design, values)


def current_figures(study: Study, quantities: Sequence[str]) -> tuple[Mapping[str, float], str]:
    """Figures of a single design (keys as for ``many``), extremes refined, and the code that says why one has no value, or "".

    Raises ValueError as ``many``.
    """
    from core.study.batch import study_figures

    requests = [quantity_request(study.design, key) for key in quantities]
    values, _, reason = study_figures(study, requests)
    return {request.key: value / request.unit for request, value in zip(requests, values, strict=True)}, reason


@frozen
class Question:
    """A study as the window has it.

    Attributes
    ----------
    spans : tuple of Span
        Varied numbers with their bounds.
    words : mapping of str -> tuple of str
        Path -> words to try.
    figures : mapping of str -> Limits
        Key of a figure -> its least and greatest allowed value.
    goals : mapping of str -> bool
        Key of a goal, a figure or the path of a varied number, at most two -> whether it is minimised.
    robust : float or None
        Share of machines that must keep the limits.
    typed : mapping of str -> VariedField
        Rows of a file with listed values, steps or points, valid as long as the bounds are theirs.
    seed : int
    """

    spans: tuple[Span, ...] = ()
    words: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    figures: Mapping[str, Limits] = field(default_factory=dict)
    goals: Mapping[str, bool] = field(default_factory=dict)
    robust: float | None = None
    typed: Mapping[str, VariedField] = field(default_factory=dict)
    seed: int = SEED

    def row(self, span: Span) -> VariedField:
        """Row of a number in a study file."""
        typed = self.typed.get(span.path)
        return typed if typed is not None and span_of(typed) == span else VariedField(span.path, span.low, span.high)


def span_of(row: VariedField) -> Span:
    """Bounds of a row; of listed values the least and the greatest."""
    ends = row.values or (row.low, row.high)
    return Span(row.field, min(ends), max(ends))  # type: ignore[type-var, arg-type]


def file_of_question(question: Question, design: str = "") -> StudyFile:
    """Study file of a question; ``design`` is the file of the design, relative to that of the study."""
    varied_paths = {span.path for span in question.spans}
    return StudyFile(
        design=design,
        seed=question.seed,
        robust=question.robust,
        vary=(
            *(question.row(span) for span in question.spans),
            *(VariedField(field=path, choices=words) for path, words in question.words.items()),
        ),
        quantities=tuple(StudyQuantity(*split_key(key)) for key in question.figures),
        limits=_limit_rows(question.figures),
        goals=tuple(
            Goal(field=key, minimise=small) if key in varied_paths else Goal(*split_key(key), minimise=small)
            for key, small in question.goals.items()
        ),
    )


def question_of_file(file: StudyFile) -> Question:
    """Question of a study file, the inverse of ``file_of_question``."""
    spans: list[Span] = []
    words: dict[str, tuple[str, ...]] = {}
    figures: dict[str, Limits] = {}
    for row in file.vary:
        if row.choices:
            words[row.field] = row.choices
        else:
            spans.append(span_of(row))
    for figure in (*file.limits, *file.quantities, *(goal for goal in file.goals if not goal.field)):
        least, greatest = figures.get(figure.key, (None, None))
        figures[figure.key] = (
            _stricter(max, least, getattr(figure, "min", None)),
            _stricter(min, greatest, getattr(figure, "max", None)),
        )
    typed = {row.field: row for row in file.vary if row.values or row.steps or row.points}
    goals = {goal.key: goal.minimise for goal in file.goals}
    return Question(tuple(spans), words, figures, goals, file.robust, typed, file.seed)


def _stricter(pick: Callable[[float, float], float], first: float | None, second: float | None) -> float | None:
    return second if first is None else first if second is None else pick(first, second)


def split_key(key: str) -> tuple[str, str | None]:
    """Column and statistic of the key of a figure; a total has no statistic."""
    slug, _, of = key.partition(":")
    return slug, of or None


def _limit_rows(limits: Mapping[str, Limits]) -> tuple[StudyLimit, ...]:
    return tuple(StudyLimit(*split_key(key), *ends) for key, ends in limits.items() if ends != (None, None))


@frozen(eq=False)
class ToleranceResult:
    """Effects of the tolerances of a design.

    Attributes
    ----------
    share : Share or None
        Share of random machines that keep the limits; None without limits.
    corners : sequence of Corner
        Worst case of every limit.
    parts : mapping of str -> mapping of str -> (float, float)
        Key of a figure -> field -> derivative of the figure by the field, and its part of the variance, the largest first.
    tighter : TightenedTolerances or None
        Cheapest tolerances to halve where fewer than 99.73 % keep the limits.
    """

    share: Share | None
    corners: Sequence[Corner]
    parts: Mapping[str, Mapping[str, tuple[float, float]]]
    tighter: TightenedTolerances | None = None


def tolerance_result(
    design: Design, figures: Mapping[str, Limits], tighten: bool = True, machines: int = MACHINES, seed: int = SEED
) -> ToleranceResult:
    """Simulate machines built to a design's tolerances, for figures (keys as for ``many``) with their limits.

    With ``tighten`` the tolerances to halve are calculated, too. Raises KindynaError where the design has no tolerances, lacks a
    figure, or has no solution itself.
    """
    scatter = Scatter(study_of(file_of_question(Question(figures=figures)), design))
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
