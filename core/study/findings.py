"""Findings of a study: the limits that the refined extremes of each stage exceed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from math import degrees, pi
from typing import TYPE_CHECKING

from core import cam, dynamics, mechanism, motion, shaft
from core.cam import Wall
from core.design import BALANCER, STAGES, Design, contradiction, distances, excess, path_of, with_drive
from core.errors import KindynaError, NoSolution, NoStability
from core.findings import ERROR, NOTE, WARNING, Finding
from core.motion import program
from core.motion.extremes import Extreme, find_extremes, piecewise_angles
from core.study import cam_checks, quantity_requests
from core.study.camshaft import Camshaft
from core.study.drive_forces import has_servo, servo_part, servo_turn
from core.study.extremes import cam_extremes, extremes_beyond_lash, extremes_of, near_singular, search_together
from core.study.limits import limit_findings
from core.study.quantities import TRANSMISSION, member_of, names_of, quantities_of, quantity, shape_of
from core.study.stages import memory
from core.study.study import Study

if TYPE_CHECKING:
    from core.stability import Stability


# -- limits of the servo motor ----------------------------------------------------------------------------------


ROUNDING = 1e-9  # of a limit: a smaller excess is rounding


def _largest(study: Study, *names: str) -> Extreme:
    """Extreme of largest magnitude [SI units] among the named quantities that the design has."""
    present = names_of(study.design)
    extremes = extremes_of(study, "dynamics", tuple(name for name in names if name in present))
    return max((side for e in extremes.values() for side in (e.low, e.high)), key=lambda side: abs(side.value))


def _peak(study: Study) -> tuple[float, float | None]:
    worst = _largest(study, "servo_torque", "servo_force")
    return abs(worst.value), degrees(worst.theta)


def _rms(study: Study) -> tuple[float, float | None]:
    return servo_turn(study).rms, None


def _speed(study: Study) -> tuple[float, float | None]:
    worst = _largest(study, "servo_speed")
    return abs(worst.value) * RPM, degrees(worst.theta)


RPM = 30.0 / pi  # of one rad/s
LIMITS: tuple[tuple[str, str, str, str, Callable[[Study], tuple[float, float | None]]], ...] = (
    ("servo-peak", ERROR, "peak_torque_nm", "N·m", _peak),
    ("servo-rms", ERROR, "rated_torque_nm", "N·m", _rms),
    ("servo-speed", WARNING, "rated_rpm", "rpm", _speed),
)
"""Code, severity, field of [servo], unit, and function of a study: value and cam angle [deg]."""


def servo_findings(study: Study) -> Iterator[Finding]:
    """Limits of the motor that a design exceeds. Raises NoSolution where the stage ``dynamics`` has none."""
    if not has_servo(study.design) or study.jam is not None:
        return
    servo = servo_part(study)
    for code, severity, field, unit, reach in LIMITS:
        limit = getattr(servo, field)
        if limit is None:
            continue
        value, angle = reach(study)
        if value > limit * (1.0 + ROUNDING):
            yield Finding(code, severity, f"servo.{field}", angle, {"value": value, "limit": limit, "unit": unit})


# -- findings of all stages -------------------------------------------------------------------------------------


_ORDER = {ERROR: 0, WARNING: 1, NOTE: 2}


def findings_of(study: Study, stages: Sequence[str] = ()) -> tuple[Finding, ...]:
    """Findings of the named stages, or of all stages, errors first. Raises NoSolution where a stage has none.

    A design that lists its drives has the findings of every drive and of the shaft. The finding of a drive has the drive's name
    among its values, and its field is a path in the file of the design. A drive without a solution has the findings of the
    stages before, and one that says why.
    """
    findings = list(
        _camshaft_findings(study.camshaft, stages) if study.design.listed else _stage_findings(study, stages)
    )
    return tuple(sorted(findings, key=lambda f: _ORDER[f.severity]))


def _stage_findings(study: Study, stages: Sequence[str]) -> Iterator[Finding]:
    with suppress(KindynaError):  # the stages report it
        _search_together(study, stages or study.stages, has_load=False)
    for name in stages or study.stages:
        yield from _FINDINGS[name](study)
        yield from limit_findings(study, name)
        if name == "dynamics":
            yield from servo_findings(study)


# -- one drive ---------------------------------------------------------------------------------------------


def _motion_findings(study: Study) -> list[Finding]:
    return motion.findings(program(study.design.drive.motion))


def _search_together(study: Study, stages: Sequence[str], has_load: bool) -> None:
    """Search the extremes of all quantities that these findings need in one pass.

    The linkage is first solved at all cam angles at which findings and certificate read the study, in one call; with
    ``has_load`` also at those of the load on the shaft.
    """

    def solve() -> None:
        last = max((stage for stage in stages if stage != "stability"), key=STAGES.index)
        further = [study.angles] if set(stages) >= set(study.stages) else []
        study.solve_turn(last, *further, *near_singular(study), has_load=has_load)

    search_together(study, _requested(study, stages), solve)


def _requested(study: Study, stages: Sequence[str]) -> Mapping[str, tuple[str, ...]]:
    """Stage -> quantities whose extremes the findings of these stages need."""
    drive, names = study.design.drive, {}
    if "linkage" in stages:
        names["linkage"] = _singular(study)
    if "cam" in stages:
        if study.has_surface:
            from core.study.spatial_checks import checked_quantities  # few designs have a cam in space

            names["cam"] = checked_quantities(study)
        else:
            names["cam"] = cam.limits_of(drive.face, drive.cam)
    if {"cam", "dynamics"} <= set(stages) and not study.is_form_closed:
        names["dynamics"] = ("contact_force",)
    return names


def _singular(study: Study) -> tuple[str, ...]:
    """Quantities of the linkage that must not vanish."""
    return tuple(n for n in quantities_of(study, "linkage") if n in mechanism.SINGULAR or shape_of(n) == TRANSMISSION)


def _linkage_findings(study: Study) -> list[Finding]:
    names = _singular(study)
    extremes = extremes_of(study, "linkage", names) if names else {}
    singular = {name: e for name, e in extremes.items() if name in mechanism.SINGULAR}
    transmission = {member_of(name): e for name, e in extremes.items() if name not in singular}
    findings = mechanism.findings(study.driver_ranges, singular, transmission, study.by_crank)
    findings += _clearance_findings(study.camshaft) if study.design.outlines else []
    if not study.design.drive.has_valve:
        return findings
    from core.study.valve_findings import lash_findings, piston_findings  # few designs have a valve

    return [*findings, *lash_findings(study), *piston_findings(study)]


def _cam_findings(study: Study) -> list[Finding]:
    if study.has_surface:
        from core.study.spatial_checks import spatial_findings  # as above

        return [*spatial_findings(study), *cam_checks.surface_limit_findings(study)]
    drive, extremes = study.design.drive, cam_extremes(study)
    # at the angles of the search, which are solved; of a linkage the study checks whether a cam can drive it
    solved = study if study.mechanism.ranged else study.at(piecewise_angles(study.program))
    pair_kinds = {flank.name: solved.frame_pair_kind(flank.body) for flank in solved.cam.flanks}

    def least_at(name: str, base_radius_mm: float) -> float:
        """Refined least value of a quantity of the cam with another base radius; NaN where it has none."""
        other = study.with_design(with_drive(study.design, cam=replace(drive.cam, base_radius_mm=base_radius_mm)))
        try:
            row = quantity(name)
            return find_extremes(lambda angles: {name: row.value(other.at(angles))}, other.program)[name].low.value
        except NoSolution:
            return math.nan

    findings = cam.findings(extremes, pair_kinds[cam.INNER], drive.face, drive.cam, least_at)
    second = cam.second_entry(drive.mechanism, drive.cam)
    findings += cam.further_findings(extremes, pair_kinds, drive.face, drive.cam, second)
    findings += cam.wall_findings(_thinnest_wall(study), drive.cam) if cam.OUTER in pair_kinds else []
    return findings + cam_checks.cam_findings(study)


def _clearance_findings(camshaft: Camshaft[Study]) -> list[Finding]:
    from core.study.clearances import Clearances, clearance_findings  # few designs have outlines

    return clearance_findings(Clearances(camshaft))


def _thinnest_wall(study: Study) -> Wall | None:
    """Thinnest wall between two parts of a groove, if its thickness is negative; else None."""

    def compute() -> Wall | None:
        return cam.thinnest_wall(lambda theta: study.at_theta(theta).cam, study.cam, study.angles)

    wall: Wall | None = memory.get("wall", (study.depends_on("cam"), study.samples), compute)
    return wall


def _dynamics_findings(study: Study) -> list[Finding]:
    drive, jam = study.design.drive, study.jam
    jams = [] if jam is None or study.loading.is_empty else [dynamics.jam_finding(jam, study.jamming_pair)]
    if not study.has_disk:
        findings = [*dynamics.findings(None, study.loading, "", lambda: 0.0), *jams]
    else:
        contact = None if study.is_form_closed else extremes_beyond_lash(study, "contact_force")
        limit = getattr(drive.loads, "least_contact_force_n", None)
        noun = "" if cam.row_of(drive.face).rolls else drive.face.noun
        findings = [*dynamics.findings(contact, study.loading, noun, lambda: _lift_off_rpm(study), limit), *jams]
        if study.is_form_closed and jam is None and not study.loading.is_empty:
            findings += dynamics.change_findings(study.flank_impacts, drive.cam.form)
        findings += cam_checks.shaft_room_findings(study)
        findings += quantity_requests.pressure_findings(study) + _elastic_follower_findings(study)
    if study.undetermined and not study.loading.is_empty:
        pairs = ", ".join(name for name in study.linkage.pairs if name in study.undetermined)
        findings.append(Finding("undetermined-reactions", NOTE, "linkage.links", None, {"pairs": pairs}))
    findings += dynamics.element_findings(lambda angles: study.at(angles).linkage, study.program, study.loading)
    if getattr(drive.loads, "valve_springs", ()):
        from core.study.valve_findings import spring_findings  # as above

        findings += spring_findings(study)
    return [*findings, *(shaft.findings(study.flywheel) if study.levels_torque and jam is None else [])]


def _lift_off_rpm(study: Study) -> float:
    """Lift-off speed of a follower that leaves the cam at the speed of the design [rpm]."""
    speed = abs(study.omega)
    lift_off = study.lift_off if study.jam is None else None
    return (speed if lift_off is None else min(lift_off.omega, speed)) * 30.0 / math.pi


def _elastic_follower_findings(study: Study) -> list[Finding]:
    """An elastic follower without a steady response, or one that leaves a cam on which a rigid follower would stay."""
    if not study.is_elastic:
        return []
    try:
        study.follower_response.require_steady()
    except NoSolution as error:
        return [Finding("no-elastic-follower", WARNING, error.field, None, {"why": error.problem, "hint": error.hint})]
    if study.is_form_closed or study.jam is not None or study.loading.is_empty:
        return []
    if extremes_beyond_lash(study, "contact_force").low.value <= 0.0:  # reported as separation
        return []
    least = extremes_beyond_lash(study, "elastic_contact_force").low
    if least.value > 0.0:
        return []
    values: dict[str, float | str] = {"force_n": least.value, "face": study.design.drive.face.noun}
    return [Finding("elastic-separation", WARNING, "loads", math.degrees(least.theta), values)]


def _stability_findings(study: Study) -> list[Finding]:
    is_flexible = study.design.shaft is not None and study.design.shaft.elastic is not None
    return _flexible_shaft_findings(study.flexible_shaft) if is_flexible else []


def _flexible_shaft_findings(stability: Callable[[], Stability]) -> list[Finding]:
    from core.stability import findings

    try:
        return findings(stability())
    except NoStability as error:
        return [Finding("no-stability", NOTE, error.field, None, {"why": error.problem, "hint": error.hint})]


_FINDINGS: Mapping[str, Callable[[Study], list[Finding]]] = {
    "motion": _motion_findings,
    "linkage": _linkage_findings,
    "cam": _cam_findings,
    "dynamics": _dynamics_findings,
    "stability": _stability_findings,
}


# -- several drives on a shaft -----------------------------------------------------------------------------


def _camshaft_findings(camshaft: Camshaft[Study], stages: Sequence[str]) -> Iterator[Finding]:
    for i, (name, study) in enumerate(camshaft.drives.items()):
        for finding in _drive_findings(study, stages):
            yield replace(finding, field=path_of(i, finding.field), values={**finding.values, "drive": name})
    for name, error in camshaft.failures.items():
        yield _failure(name, error)
    if not stages or "motion" in stages:
        yield from _timing_findings(camshaft.design)
    if camshaft.design.outlines and not camshaft.failures and (not stages or "linkage" in stages):
        yield from _clearance_findings(camshaft)
    has_torque = not camshaft.failures.keys() & set(camshaft.loading_drives)
    if has_torque and (not stages or "dynamics" in stages):
        yield from _torque_findings(camshaft)
    if has_torque and camshaft.design.camshaft.elastic is not None and (not stages or "stability" in stages):
        yield from _flexible_shaft_findings(camshaft.flexible_shaft)


def _drive_findings(study: Study, stages: Sequence[str]) -> Iterator[Finding]:
    """Findings of a drive, stage by stage up to the first that has no solution."""
    with suppress(KindynaError):  # the stages report it
        _search_together(study, stages or study.stages, has_load=True)
    for stage in study.stages:
        if stages and stage not in stages:
            continue
        try:
            yield from findings_of(study, (stage,))
        except KindynaError:
            return


def _failure(name: str, error: NoSolution) -> Finding:
    """A drive without a solution."""
    at = error.cam_angles[0][0] if error.cam_angles else None
    return Finding("no-drive", ERROR, error.field, at, {"drive": name, "why": error.problem, "hint": error.hint})


def _timing_findings(design: Design) -> Iterator[Finding]:
    """Sequence conditions that are broken, and conditions that contradict each other."""
    for i, (row, at) in enumerate(zip(design.timing, distances(design), strict=True)):
        if not at.kept:
            values: dict[str, float | str] = {"first": row.first, "second": row.second, "after_deg": at.after_deg}
            values |= {"least_deg": row.least_deg, "first_deg": at.first_deg, "second_deg": at.second_deg}
            yield Finding("timing-broken", ERROR, f"timing[{i}]", None, values)
    if ring := contradiction(design):
        rows = ", ".join(f"timing[{i}]" for i in ring)
        too_much: dict[str, float | str] = {"rows": rows, "excess_deg": excess(design, ring)}
        yield Finding("timing-contradicts", ERROR, f"timing[{ring[0]}]", None, too_much)


def _torque_findings(camshaft: Camshaft[Study]) -> Iterator[Finding]:
    """Findings of the balance cam and the flywheel."""
    try:
        study = camshaft.balancer
    except NoSolution as error:
        yield _failure("the balance cam", error)
        return
    if study is not None:
        for finding in _drive_findings(study, ()):
            field = _balancer_field(finding.field)
            yield replace(finding, field=field, values={**finding.values, "drive": BALANCER})
    if camshaft.levels_torque:
        yield from shaft.findings(camshaft.flywheel)


def _balancer_field(field: str) -> str:
    """Field of [balancer] for a field of the balance cam as a drive."""
    table, _, key = field.partition(".")
    return f"{BALANCER}.{key}" if table in ("cam", "loads") else BALANCER
