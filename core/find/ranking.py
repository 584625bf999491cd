"""Laws and blends compared where they are chosen: each put into this design, which is then studied at its own speed.

Yang's verification. The peaks of a law for unit rise and span leave out what else acts on the machine: the other segments, weight,
springs, the geometry of the follower. Here stands what is left of the difference.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import groupby
from math import isnan

from core.blend import BlendResult, Request, best, blend, sequences
from core.cam import form_row
from core.design import Design, NamedCurve, Segment, edited, faults, split_unit
from core.errors import DesignError, KindynaError, NoSolution
from core.findings import ERROR
from core.frozen import frozen
from core.laws import LAWS
from core.motion.extremes import Extremes
from core.numerics.lazy import checkpoint
from core.study import Study, extremes_of, findings_of, quantities_of, undercut_on
from core.study.drive_forces import PRESSURES, has_servo, pairings, servo_part, servo_turn
from core.study.stages import evaluations

ExtremesByName = Mapping[str, Extremes]
Candidate = Callable[[], Design]
"""Makes the design with a law or a blend in it; raises KindynaError where it takes none."""


@frozen
class RankingColumn:
    """One column.

    key         name with the unit, as JSON has it; title as a heading
    exists      whether a design has such a figure
    value       [SI] of a study and of the extremes of ``quantities``, those of the stage dynamics that it reads; None where there is none
    """

    key: str
    title: str
    help: str
    exists: Callable[[Study], bool]
    value: Callable[[Study, ExtremesByName], float | None]
    quantities: tuple[str, ...] = ()

    @property
    def symbol(self) -> str:
        """Symbol of its unit."""
        return split_unit(self.key)[1].symbol


@frozen
class Ranked:
    """A row: figures in the order and the units of their columns, None where there is none; problem: why the design cannot take it."""

    name: str
    figures: tuple[float | None, ...]
    problem: str = ""


def _size(found: Extremes) -> float:
    return max(abs(found.low.value), abs(found.high.value))


def _wind_up(study: Study, found: ExtremesByName) -> float | None:
    steady = extremes_of(study, "stability")
    return _size(steady["wind_up"]) if "wind_up" in steady else None


def _residual(study: Study, found: ExtremesByName) -> float | None:
    """Of the roller's centre (of the contact) where the motion turns."""
    way = 1.0 if study.program.motion.unit == "mm" else study.elasticity.lever_arm
    return max((way * each.from_rest for each in study.follower_response.residuals), default=None)


def _pressure(study: Study, found: ExtremesByName) -> float | None:
    return max((found[name].high.value for name in PRESSURES.values() if name in found), default=None)


def _least_contact(study: Study, found: ExtremesByName) -> float | None:
    """Of the elastic follower in steady running where there is one: None where nothing damps its vibration."""
    if not study.is_elastic:
        return found["contact_force"].low.value
    return found["elastic_contact_force"].low.value if "elastic_contact_force" in found else None


def _is_open(study: Study) -> bool:
    return "cam" in study.stages and not study.is_form_closed and not study.loading.is_empty


def _is_stressed(study: Study) -> bool:
    return "cam" in study.stages and not study.loading.is_empty and bool(pairings(study))


def _has_motor(study: Study) -> bool:
    return has_servo(study.design)


FIGURES: tuple[RankingColumn, ...] = (
    RankingColumn(
        "peak_torque_nm", "Peak torque", "Largest torque at the camshaft over the turn at this speed, of all that acts on it",
        lambda study: "cam" in study.stages and not study.loading.is_empty,
        lambda study, found: _size(found["drive_torque"]), ("drive_torque",),
    ),
    RankingColumn(
        "wind_up_deg", "Wind-up", "Largest wind-up of the elastic camshaft over a steady turn",
        lambda study: "stability" in study.stages and study.design.shaft is not None and study.design.shaft.elastic is not None, _wind_up,
    ),
    RankingColumn(
        "residual_mm", "Residual", "Amplitude with which the elastic follower vibrates in the worst of the dwells, begun at rest",
        lambda study: study.is_elastic, _residual,
    ),
    RankingColumn(
        "least_contact_force_n", "Least contact", "Least contact force over the turn, of an elastic follower in steady running: below 0 "
        "the follower leaves the cam", _is_open, _least_contact, ("contact_force", "elastic_contact_force"),
    ),
    RankingColumn(
        "contact_pressure_mpa", "Pressure", "Largest Hertz pressure between follower and cam over the turn",
        _is_stressed, _pressure, tuple(PRESSURES.values()),
    ),
    RankingColumn(
        "motor_rms_nm", "Motor rms", "Root mean square of the servo's torque over the turn", _has_motor,
        lambda study, found: servo_turn(study).rms,
    ),
    RankingColumn(
        "peak_power_w", "Peak power", "Largest power of the servo's motor", _has_motor,
        lambda study, found: _size(found["servo_power"]), ("servo_power",),
    ),
    RankingColumn(
        "energy_j", "Energy", "What the servo's motor takes in a turn, less what it gives back where it regenerates", _has_motor,
        lambda study, found: servo_turn(study).given - servo_turn(study).braked * servo_part(study).regenerates,
    ),
)  # fmt: skip
"""Quantity, unit, and how it is read of a study."""


def figures_of(design: Design) -> tuple[RankingColumn, ...]:
    """The columns that a design has: none without a cam and loads; without what cannot be assembled as it is."""
    study = Study(design)
    try:
        return tuple(figure for figure in FIGURES if figure.exists(study))
    except NoSolution:
        return ()


def ranked(name: str, candidate: Candidate, figures: Sequence[RankingColumn]) -> Ranked:
    """One row, computed now."""
    checkpoint()
    evaluations["ranking"] += 1
    try:
        design = candidate()
        if wrong := faults(design):
            raise DesignError(wrong)
        study = Study(design)
        _require_cam(study)
        wanted = {name for figure in figures for name in figure.quantities} & quantities_of(study, "dynamics").keys()
        found = extremes_of(study, "dynamics", tuple(sorted(wanted))) if wanted else {}
        return Ranked(name, tuple(_value(figure, study, found) for figure in figures))
    except DesignError as error:
        return _none(name, figures, "; ".join(fault.problem for fault in error.faults))
    except NoSolution as error:
        return _none(name, figures, error.problem)
    except KindynaError as error:
        return _none(name, figures, str(error).partition("\n")[0])


def _none(name: str, figures: Sequence[RankingColumn], problem: str) -> Ranked:
    return Ranked(name, (None,) * len(figures), problem)


def _value(figure: RankingColumn, study: Study, found: ExtremesByName) -> float | None:
    """In the unit of its column; None where this part of the machine has no answer with it."""
    checkpoint()
    try:
        value = figure.value(study, found)
    except NoSolution:
        return None
    return None if value is None or isnan(value) else value / split_unit(figure.key)[1].factor


def _require_cam(study: Study) -> None:
    """Raises KindynaError where the velocity jumps, or no cam can be cut that gives this motion."""
    jumping = [finding for finding in findings_of(study, ("motion",)) if finding.severity == ERROR]
    if not jumping and "cam" in study.stages:
        flanks = form_row(study.design.drive.cam.form).flanks
        if any(undercut_on(study, flank) for flank in flanks):
            jumping = [finding for finding in findings_of(study, ("cam",)) if finding.code.endswith("undercut")]
    if jumping:
        raise KindynaError(jumping[0].message)


def ranking(candidates: Mapping[str, Candidate], figures: Sequence[RankingColumn]) -> Iterator[Ranked]:
    """Row after row. Raises Cancelled where they are no longer wanted."""
    return (ranked(name, candidate, figures) for name, candidate in candidates.items())


def in_order(rows: Sequence[Ranked], column: int, downwards: bool = False) -> list[Ranked]:
    """By one of their figures, those without it last; alike ones as they stood."""
    having = [row for row in rows if row.figures[column] is not None]
    without = [row for row in rows if row.figures[column] is None]
    return [*sorted(having, key=lambda row: row.figures[column] or 0.0, reverse=downwards), *without]


# -- laws --------------------------------------------------------------------------------------------------


def moving_segments(design: Design) -> tuple[int, ...]:
    """Numbers of the segments that move, from 0."""
    motion = design.drive.motion
    return () if motion is None else tuple(i for i, segment in enumerate(motion.segments) if segment.rise)


def law_candidates(design: Design, numbers: Sequence[int]) -> dict[str, Candidate]:
    """Every law that moves, in place of the law of these segments."""
    return {slug: partial(_with_law, design, numbers, slug) for slug, law in LAWS.items() if not law.is_dwell}


def _with_law(design: Design, numbers: Sequence[int], slug: str) -> Design:
    for number in numbers:
        design = edited(design, f"motion.segments[{number}].law", slug)
    return design


# -- blends ------------------------------------------------------------------------------------------------


def blend_candidates(
    blended: BlendResult, place: Callable[[BlendResult], Design], goal: str = ""
) -> dict[str, Candidate]:
    """The blend itself, every other sequence that answers the same request, and every law for rises and returns in place of each stroke.

    place  puts a blend into the design; goal: what the blend makes least, empty where its settings leave nothing free
    """
    own = "-".join(blended.curves)
    request = blended.request

    rows: dict[str, Candidate] = {own: partial(place, blended)}
    if isinstance(request, Request):  # of one of Yang's types, which has other sequences

        def of_sequence(name: str) -> Design:
            other = replace(request, sequence=name)
            return place(best(other, goal) if goal else blend(other))

        names = ["-".join(sequence.curves) for sequence in sequences(request.type, request.constant)]
        rows |= {name: partial(of_sequence, name) for name in names if name != own}
    strokes = _strokes(blended.segments)

    def of_law(slug: str) -> Design:
        parts = tuple(replace(stroke, curve=NamedCurve(slug)) for stroke in strokes)
        return place(replace(blended, segments=parts))

    return rows | {slug: partial(of_law, slug) for slug, law in LAWS.items() if not (law.is_dwell or law.rises)}


def _strokes(segments: Sequence[Segment]) -> list[Segment]:
    """One segment for each rise or return."""
    runs = [list(run) for _, run in groupby(segments, key=lambda segment: segment.rise > 0.0)]
    return [replace(run[0], span_deg=sum(s.span_deg for s in run), rise=sum(s.rise for s in run)) for run in runs]
