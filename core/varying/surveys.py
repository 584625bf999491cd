"""Numbers of a design varied between bounds, and what is asked of each design: along a line, over a map, at Sobol's points."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import floor, log10

import numpy as np

from core.design import Design, Tolerance, drive_at, edited, entries, get, only, path_of, row_at
from core.frozen import frozen
from core.study.batches.asked import TORQUE, TOTALS, asked_of, columns_of, infos_of
from core.study.limits import LIMITS
from core.study.many import many
from core.study.study import Study
from core.units import split_unit
from core.varying.request import AskedFor, Bounded, StudyFile, Vary, study_of
from core.varying.space import sobol
from core.varying.tolerances import MACHINES, Corner, Scatter, Share

PART = 0.2  # of a number on either side of it, between which it is varied where nobody says
PART_OF_LARGEST = (
    0.05  # of the largest number of its table in the same unit: the least such part of one that may be negative
)
OF_ZERO = 10.0  # the same where all these are 0, in the unit
SUGGESTED = ("pressure_angle_deg:abs", "drive_torque_nm:abs", "driver_torque_nm:abs", "contact_force_n:abs")
ROUND = 2  # digits of such bounds
SEED = 1  # of the scrambled points


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

    Over a map the first number runs fastest: ``value[key].reshape(count, count)`` has it along its rows.
    """

    spans: tuple[Span, ...]
    count: int
    points: np.ndarray
    value: Mapping[str, np.ndarray]
    reason: np.ndarray

    def nearest(self, at: Sequence[float]) -> int:
        """Number of the design next to a place, counted in parts of the bounds."""
        low, high = (np.array([getattr(span, end) for span in self.spans])[:, None] for end in ("low", "high"))
        away = (self.points - np.array(at)[:, None]) / (high - low)
        return int(np.argmin((away * away).sum(axis=0)))


def usual_span(design: Design, path: str) -> Span:
    """Bounds about the number of the design, inside of the range of its field. Raises ValueError where it cannot be varied."""
    info, value = infos_of(design, [path])[path], get(design, path)
    if value is None:
        raise ValueError(f"{path}: has no value in this design")
    half = PART * abs(value)
    if info.low < 0.0:  # a place, or an angle: its size says nothing
        half = max(half, PART_OF_LARGEST * _largest_beside(design, path))
    half = half or (OF_ZERO if split_unit(path)[1].symbol else 1.0)
    power = floor(log10(half)) - ROUND + 1
    low, high = (round(value + side * half, -power) for side in (-1.0, 1.0))
    floor_of = info.low + 10.0**power if info.open_low else info.low
    return Span(path, max(low, floor_of), min(high, info.high))


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
    """Paths of the numbers that can be varied, in the order of the file."""
    for name in design.tables:
        for each in entries(design, name):
            info = each.info
            if type(each.value) in (int, float) and not (info.choices or info.whole or info.flag):
                yield each.path


def askable(design: Design) -> Iterator[str]:
    """Keys of what can be asked over the turn, without what of it (``pressure_angle_deg``, ``drives[0].…``), and totals."""
    yield from columns_of(design)
    for total in TOTALS:
        try:
            asked_of(design, total)
        except ValueError:
            continue
        yield total


def suggested(study: Study, path: str) -> Mapping[str, tuple[float | None, float | None]]:
    """Keys of what is asked first where a number at a path is varied, with the least and greatest values that are usual."""
    design, own = study.design, drive_at(path) if study.design.listed else None
    number = own[0] if own else 0
    drive = list(study.drives.values())[number]
    there, found = set(columns_of(only(design, number))), {}
    rows = SUGGESTED[:1] if drive.loading.empty else SUGGESTED  # no forces
    for key in (key for key in rows if key.partition(":")[0] in there):
        found[path_of(number, key) if design.listed else key] = (None, _usual(drive, key))
    if design.listed and any(each.loads_shaft for each in study.drives.values()):
        found[f"{TORQUE}:abs"] = (None, None)
    if found:
        return found
    columns = columns_of(design)
    turned = next((each for each in columns if "transmission" in each), "")
    return {f"{turned}:min" if turned else f"{columns[0]}:abs": (None, None)}


def _usual(drive: Study, key: str) -> float | None:
    if not key.startswith("pressure_angle"):
        return None
    stated = drive.design.drive.limits.pressure_angle_rise_deg
    usual = LIMITS["pressure_angle_rise_deg"].usual(drive)
    return stated if stated is not None else None if usual is None else usual.value


def points_of(spans: Sequence[Span], count: int) -> np.ndarray:
    """Numbers (p, m): evenly along one span, at a grid over two, count designs along each; of more Sobol's points, the next power of two
    from count² on."""
    low, high = (np.array([getattr(span, end) for span in spans])[:, None] for end in ("low", "high"))
    if len(spans) == 1:
        part = np.linspace(0.0, 1.0, count)[None, :]
    elif len(spans) == 2:
        even = np.linspace(0.0, 1.0, count)
        part = np.stack([np.tile(even, count), np.repeat(even, count)])
    else:
        part = sobol(len(spans), SEED, 0, 1 << (count * count - 1).bit_length()).T
    return np.asarray(low + (high - low) * part)


def survey(design: Design, spans: Sequence[Span], quantities: Sequence[str], count: int) -> Survey:
    """What is asked (keys of ``many``) of the designs with these numbers, extremes unpolished. Raises ValueError as ``many``, and where
    bounds are reversed or outside the range of their field."""
    for path, info in infos_of(design, [span.path for span in spans]).items():
        span = next(each for each in spans if each.path == path)
        if not span.low < span.high:
            raise ValueError(f"{path}: bounds are reversed: {span.low:g} is not below {span.high:g}")
        if not (info.admits(span.low) and info.admits(span.high)):
            raise ValueError(f"{path}: bounds {span.low:g} ... {span.high:g} outside the range of the field")
    points = points_of(spans, count)
    found = many(design, {span.path: row for span, row in zip(spans, points, strict=True)}, quantities, polish=False)
    return Survey(tuple(spans), count, points, found.value, found.reason)


def with_values(design: Design, values: Mapping[str, float]) -> Design:
    """The design with these numbers at their paths and what goes with them. It may have faults."""
    if design.listed:
        from core.study.batches.batch import with_numbers

        return with_numbers(design, list(values), list(values.values()))
    kept = {row_at(path)[1] for path in values if path.startswith("motion.")}
    for path, value in values.items():
        design = edited(design, path, value, kept)
    return design


def present(study: Study, quantities: Sequence[str]) -> tuple[Mapping[str, float], str]:
    """What is asked (keys of ``many``) of one design, extremes refined; and the code of why something of it has no value, else empty.
    Raises ValueError as ``many``."""
    from core.study.batches.batch import asked_of_study

    asked = [asked_of(study.design, key) for key in quantities]
    values, _, reason = asked_of_study(study, asked)
    return {each.key: value / each.unit for each, value in zip(asked, values, strict=True)}, reason


def file_of_survey(
    design: str, spans: Sequence[Span], asked: Mapping[str, tuple[float | None, float | None]]
) -> StudyFile:
    """The same as a study, for ``vary`` and ``tolerance``; design: its file, relative to the study's."""
    return StudyFile(
        design=design,
        vary=tuple(Vary(field=span.path, low=span.low, high=span.high) for span in spans),
        quantities=tuple(
            AskedFor(quantity=slug, of=of or None) for slug, _, of in (key.partition(":") for key in asked)
        ),
        limits=_bounded(asked),
    )


def _bounded(limits: Mapping[str, tuple[float | None, float | None]]) -> tuple[Bounded, ...]:
    held = ((key.partition(":"), ends) for key, ends in limits.items() if ends != (None, None))
    return tuple(Bounded(quantity=slug, of=of or None, min=least, max=most) for (slug, _, of), (least, most) in held)


def made_within(
    design: Design, limits: Mapping[str, tuple[float | None, float | None]], widths: Mapping[str, float]
) -> tuple[Share, list[Corner]]:
    """How many machines keep limits (keys of ``many`` -> least and greatest value), and the worst case of each limit; widths: path -> ±
    of its number (normal, 3σ), in place of the design's own tolerance of that number, which hold for all others.

    Raises KindynaError where nothing is limited or has a tolerance, where the limits do not fit the design, or it has no answer itself.
    """
    study = study_of(StudyFile(design="", limits=_bounded(limits)), design)
    others = [row for row in design.tolerances if row.field not in widths]
    scatter = Scatter(study, [*others, *(Tolerance(path, plus) for path, plus in widths.items())])
    return scatter.share(MACHINES, SEED), scatter.corners(scatter.slopes())


__all__ = [
    "Span",
    "Survey",
    "askable",
    "can_be_varied",
    "points_of",
    "present",
    "suggested",
    "survey",
    "usual_span",
    "with_values",
]
