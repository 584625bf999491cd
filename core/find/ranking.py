"""Laws and blends compared in their design, which is studied with each of them at its own speed (Yang's verification).

The peaks of a law for unit rise and span leave out the other loads of the machine: the other segments, weight, springs,
the
geometry of the follower. The ranking contains them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import groupby
from math import isnan

from core.blend import BlendResult, best, blend, sequences
from core.cam import form_row
from core.design import Design, OptimalCurve, Segment, curve_of, edited, faults, require_motion, split_unit
from core.errors import DesignError, KindynaError, NoSolution
from core.findings import ERROR
from core.frozen import frozen
from core.laws import LAWS
from core.motion.extremes import Extremes
from core.numerics.lazy import checkpoint
from core.study import Study, extremes_of, findings_of, quantities_of, undercut_on
from core.study.drive_forces import PRESSURES, has_servo, pairings, servo_part, servo_turn
from core.study.extremes import extremes_beyond_lash
from core.study.stages import evaluations

ExtremesByName = Mapping[str, Extremes]
Candidate = Callable[[], Design]
"""Returns the design with a law or a blend; raises KindynaError where it cannot contain it."""


@frozen
class RankingColumn:
    """A column of the ranking.

    Attributes
    ----------
    key : str
        Name with the unit, as in JSON.
    title, help : str
    exists : callable
        Whether a design has the figure.
    value : callable
        Figure in SI units, from a study and the extremes of `quantities`; None where the figure does not exist.
    quantities : tuple of str
        Quantities of the stage dynamics whose extremes it reads.
    """

    key: str
    title: str
    help: str
    exists: Callable[[Study], bool]
    value: Callable[[Study, ExtremesByName], float | None]
    quantities: tuple[str, ...] = ()

    @property
    def symbol(self) -> str:
        """Symbol of the unit."""
        return split_unit(self.key)[1].symbol


@frozen
class RankingRow:
    """A candidate's figures in the order and units of the columns, None where one does not exist; or its problem."""

    name: str
    figures: tuple[float | None, ...]
    problem: str = ""


def _size(extremes: Extremes) -> float:
    return max(abs(extremes.low.value), abs(extremes.high.value))


def _wind_up(study: Study, extremes: ExtremesByName) -> float | None:
    steady = extremes_of(study, "stability")
    return _size(steady["wind_up"]) if "wind_up" in steady else None


def _residual(study: Study, extremes: ExtremesByName) -> float | None:
    """Amplitude of the residual vibration of the roller's centre (of the contact where the motion rotates)."""
    lever_arm = 1.0 if study.program.motion.unit == "mm" else study.elasticity.lever_arm
    return max((lever_arm * residual.from_rest for residual in study.follower_response.residuals), default=None)


def _least_contact(study: Study, extremes: ExtremesByName) -> float | None:
    """Least contact force, of the elastic follower in steady running where the design has one; None without damping.

    Of a valve train with lash it is that of the open valve.
    """
    if not study.is_elastic:
        return extremes_beyond_lash(study, "contact_force").low.value
    return extremes["elastic_contact_force"].low.value if "elastic_contact_force" in extremes else None


def _has_motor(study: Study) -> bool:
    return has_servo(study.design)


FIGURES: tuple[RankingColumn, ...] = (
    RankingColumn(
        "peak_torque_nm", "Peak torque", "Largest torque at the camshaft over the turn at this speed, by all loads",
        lambda study: study.has_disk and not study.loading.is_empty,
        lambda study, extremes: _size(extremes["drive_torque"]), ("drive_torque",),
    ),
    RankingColumn(
        "wind_up_deg", "Wind-up", "Largest wind-up of the elastic camshaft over a steady turn",
        lambda study: "stability" in study.stages and study.design.shaft is not None
        and study.design.shaft.elastic is not None, _wind_up,
    ),
    RankingColumn(
        "residual_mm", "Residual",
        "Amplitude of the elastic follower's vibration in the worst dwell, from a start at rest",
        lambda study: study.is_elastic, _residual,
    ),
    RankingColumn(
        "least_contact_force_n", "Least contact",
        "Least contact force over the turn, of an elastic follower in steady running: below 0 the follower leaves the cam",
        lambda study: study.has_disk and not study.is_form_closed and not study.loading.is_empty,
        _least_contact, ("contact_force", "elastic_contact_force"),
    ),
    RankingColumn(
        "contact_pressure_mpa", "Pressure", "Largest Hertz pressure between follower and cam over the turn",
        lambda study: study.has_disk and not study.loading.is_empty and bool(pairings(study)),
        lambda study, extremes: max((extremes[name].high.value for name in PRESSURES.values() if name in extremes), default=None),
        tuple(PRESSURES.values()),
    ),
    RankingColumn(
        "motor_rms_nm", "Motor rms", "Root mean square of the servo's torque over the turn", _has_motor,
        lambda study, extremes: servo_turn(study).rms,
    ),
    RankingColumn(
        "peak_power_w", "Peak power", "Largest power of the servo's motor", _has_motor,
        lambda study, extremes: _size(extremes["servo_power"]), ("servo_power",),
    ),
    RankingColumn(
        "energy_j", "Energy", "Energy of the servo's motor in a turn, less the regenerated part", _has_motor,
        lambda study, extremes: servo_turn(study).given - servo_turn(study).braked * servo_part(study).regenerates,
    ),
)  # fmt: skip
"""Figures of a study that are compared."""


def ranking_columns(design: Design) -> tuple[RankingColumn, ...]:
    """Columns that a design has: none without a cam and loads, or where it cannot be assembled."""
    study = Study(design)
    try:
        return tuple(figure for figure in FIGURES if figure.exists(study))
    except NoSolution:
        return ()


def ranking_row(name: str, candidate: Candidate, figures: Sequence[RankingColumn]) -> RankingRow:
    """Evaluate one candidate."""
    checkpoint()
    evaluations["ranking"] += 1
    try:
        design = candidate()
        if problems := faults(design):
            raise DesignError(problems)
        study = Study(design)
        _require_cam(study)
        names = {key for figure in figures for key in figure.quantities} & quantities_of(study, "dynamics").keys()
        extremes = extremes_of(study, "dynamics", tuple(sorted(names))) if names else {}
        return RankingRow(name, tuple(_value(figure, study, extremes) for figure in figures))
    except DesignError as error:
        return _failed_row(name, figures, "; ".join(fault.problem for fault in error.faults))
    except NoSolution as error:
        return _failed_row(name, figures, error.problem)
    except KindynaError as error:
        return _failed_row(name, figures, str(error).partition("\n")[0])


def _failed_row(name: str, figures: Sequence[RankingColumn], problem: str) -> RankingRow:
    return RankingRow(name, (None,) * len(figures), problem)


def _value(figure: RankingColumn, study: Study, extremes: ExtremesByName) -> float | None:
    """Figure in the unit of its column; None where it cannot be computed."""
    checkpoint()
    try:
        value = figure.value(study, extremes)
    except NoSolution:
        return None
    return None if value is None or isnan(value) else value / split_unit(figure.key)[1].factor


def _require_cam(study: Study) -> None:
    """Raise KindynaError where the velocity jumps, or no cam can be cut for this motion."""
    jumping = [finding for finding in findings_of(study, ("motion",)) if finding.severity == ERROR]
    if not jumping and study.has_disk:
        flanks = form_row(study.design.drive.cam.form).flanks
        if any(undercut_on(study, flank) for flank in flanks):
            jumping = [finding for finding in findings_of(study, ("cam",)) if finding.code.endswith("undercut")]
    if jumping:
        raise KindynaError(jumping[0].message)


def ranking(candidates: Mapping[str, Candidate], figures: Sequence[RankingColumn]) -> Iterator[RankingRow]:
    """Evaluate the candidates one after the other. Raises Cancelled where the calculation is cancelled."""
    return (ranking_row(name, candidate, figures) for name, candidate in candidates.items())


def sorted_rows(rows: Sequence[RankingRow], column: int, downwards: bool = False) -> list[RankingRow]:
    """Rows sorted by one of their figures, those without it last; equal ones in their present order."""
    complete = [row for row in rows if row.figures[column] is not None]
    without = [row for row in rows if row.figures[column] is None]
    return [*sorted(complete, key=lambda row: row.figures[column] or 0.0, reverse=downwards), *without]


# -- laws --------------------------------------------------------------------------------------------------


def moving_segments(design: Design) -> tuple[int, ...]:
    """Indices of the segments that move."""
    motion = design.drive.motion
    return () if motion is None else tuple(i for i, segment in enumerate(motion.segments) if segment.rise)


def law_candidates(design: Design, numbers: Sequence[int]) -> dict[str, Candidate]:
    """Designs with each moving law in place of the law of these segments; an optimal law keeps its settings."""
    slugs = (*(slug for slug, law in LAWS.items() if not law.is_dwell), OptimalCurve.law)
    return {slug: partial(_with_law, design, numbers, slug) for slug in slugs}


def _with_law(design: Design, numbers: Sequence[int], slug: str) -> Design:
    for number in numbers:
        motion = require_motion(design)
        if not (slug == OptimalCurve.law == motion.segments[number].curve.law):
            design = edited(design, f"motion.segments[{number}].law", slug)
    return design


# -- blends ------------------------------------------------------------------------------------------------


def blend_candidates(
    blended: BlendResult, put: Callable[[BlendResult], Design], goal: str = ""
) -> dict[str, Candidate]:
    """Designs with the blend, each other sequence for the same request, and each law in place of every rise and return.

    Parameters
    ----------
    blended : BlendResult
    put : callable
        Puts a blend into the design.
    goal : str
        Quantity that the blend minimises, empty where its settings leave nothing free.

    Returns
    -------
    dict
        Name -> function that returns the design.
    """
    own_name = "-".join(blended.curves)
    request = blended.request

    rows: dict[str, Candidate] = {own_name: partial(put, blended)}
    if request.type:  # of Yang's, which has other sequences

        def of_sequence(name: str) -> Design:
            changed = replace(request, sequence=name)
            return put(best(changed, goal) if goal else blend(changed))

        names = ["-".join(sequence.curves) for sequence in sequences(request.type, request.constant)]
        rows |= {name: partial(of_sequence, name) for name in names if name != own_name}
    strokes = _strokes(blended.segments)

    def of_law(slug: str) -> Design:
        parts = tuple(replace(stroke, curve=curve_of(slug)) for stroke in strokes)
        return put(replace(blended, segments=parts))

    slugs = (*(slug for slug, law in LAWS.items() if not (law.is_dwell or law.rises)), OptimalCurve.law)
    return rows | {slug: partial(of_law, slug) for slug in slugs}


def _strokes(segments: Sequence[Segment]) -> list[Segment]:
    """One segment for each rise or return."""
    runs = [list(run) for _, run in groupby(segments, key=lambda segment: segment.rise > 0.0)]
    return [replace(run[0], span_deg=sum(s.span_deg for s in run), rise=sum(s.rise for s in run)) for run in runs]
