"""What a study exceeds: the findings of each stage, from its refined extremes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import degrees, pi
from typing import TYPE_CHECKING

from core import cam, dynamics, mechanism, motion, shaft
from core.cam import Wall
from core.design import BALANCER, Design, contradiction, distances, excess, path_of, with_drive
from core.errors import KindynaError, NoSolution, NoStability
from core.findings import ERROR, NOTE, WARNING, Finding
from core.motion import program
from core.motion.extremes import Extreme, find_extremes, piecewise_angles
from core.study import cam_checks, quantity_requests
from core.study.camshaft import Camshaft
from core.study.drive_forces import has_servo, servo_part, servo_turn
from core.study.extremes import cam_extremes, extremes_of, search_together
from core.study.limits import own_findings
from core.study.quantities import TRANSMISSION, member_of, names_of, quantities_of, quantity, shape_of
from core.study.stages import memory
from core.study.study import Study

if TYPE_CHECKING:
    from core.stability import Stability


# -- what the servo's motor cannot give -------------------------------------------------------------------------


ROUNDING = 1e-9  # of a limit: less above it is none


def _largest(study: Study, *names: str) -> Extreme:
    """Of the quantities that the servo has, the largest size [SI]."""
    there = names_of(study.design)
    found = extremes_of(study, "dynamics", tuple(name for name in names if name in there))
    return max((end for each in found.values() for end in (each.low, each.high)), key=lambda end: abs(end.value))


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
"""Code, severity, field of [servo], unit, and what reaches it with its cam angle [deg]."""


def servo_findings(study: Study) -> Iterator[Finding]:
    """The limits of the motor that a design passes. Raises NoSolution as the stage dynamics does."""
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


# -- what a study exceeds ---------------------------------------------------------------------------------------


_ORDER = {ERROR: 0, WARNING: 1, NOTE: 2}
_CONTACT, _ELASTIC_CONTACT = ("contact_force",), ("elastic_contact_force",)


def findings_of(study: Study, stages: Sequence[str] = ()) -> tuple[Finding, ...]:
    """What the named stages (all, where none is named) exceed, the gravest first. Raises NoSolution as the stages do.

    Of a design that lists its drives: what each exceeds as far as it has answers, its name among the values and its field that of the
    whole file; why one has none; and what all do together.
    """
    found = list(_of_camshaft(study.camshaft, stages) if study.design.listed else _of_stages(study, stages))
    return tuple(sorted(found, key=lambda f: _ORDER[f.severity]))


def _of_stages(study: Study, stages: Sequence[str]) -> Iterator[Finding]:
    _search_together(study, stages or study.stages)
    for name in stages or study.stages:
        yield from _OF_STAGE[name](study)
        yield from own_findings(study, name)
        if name == "dynamics":
            yield from servo_findings(study)


# -- of one drive ------------------------------------------------------------------------------------------


def _of_motion(study: Study) -> list[Finding]:
    return motion.findings(program(study.design.drive.motion))


def _search_together(study: Study, stages: Sequence[str]) -> None:
    """The extremes that the findings of these stages ask for, so that the turn is gone through once for all of them."""
    drive, asked = study.design.drive, {}
    if "linkage" in stages:
        asked["linkage"] = _singular(study)
    if "cam" in stages:
        asked["cam"] = cam.limits_of(drive.face, drive.cam)
    if {"cam", "dynamics"} <= set(stages) and not study.is_form_closed:
        asked["dynamics"] = _CONTACT
    search_together(study, {stage: names for stage, names in asked.items() if names})


def _singular(study: Study) -> tuple[str, ...]:
    """Quantities of the linkage that must not vanish."""
    names = quantities_of(study, "linkage")
    return tuple(n for n in names if n in mechanism.SINGULAR or shape_of(n) == TRANSMISSION)


def _of_linkage(study: Study) -> list[Finding]:
    names = _singular(study)
    found = extremes_of(study, "linkage", names) if names else {}
    singular = {name: each for name, each in found.items() if name in mechanism.SINGULAR}
    transmission = {member_of(name): each for name, each in found.items() if name not in singular}
    return mechanism.findings(study.driver_ranges, singular, transmission, study.by_crank)


def _of_cam(study: Study) -> list[Finding]:
    drive, extremes = study.design.drive, cam_extremes(study)
    # where the search over the turn has solved it; of a general linkage the study itself asks whether a cam can push it
    there = study if study.mechanism.ranged else study.at(piecewise_angles(study.program))
    grounds = {flank.name: there.frame_pair_kind(flank.body) for flank in there.cam.flanks}

    def least_at(name: str, base_radius_mm: float) -> float:
        """The refined least value of a quantity of the cam with another base radius; NaN where there is none."""
        other = study.with_design(with_drive(study.design, cam=replace(drive.cam, base_radius_mm=base_radius_mm)))
        try:
            return find_extremes(lambda angles: {name: quantity(name).value(other.at(angles))}, other.program)[
                name
            ].low.value
        except NoSolution:
            return math.nan

    found = cam.findings(extremes, grounds[cam.INNER], drive.face, drive.cam, least_at)
    found += cam.further_findings(
        extremes, grounds, drive.face, drive.cam, cam.second_entry(drive.mechanism, drive.cam)
    )
    found += cam.wall_findings(_wall(study), drive.cam) if cam.OUTER in grounds else []
    return found + cam_checks.findings(study)


def _wall(study: Study) -> Wall | None:
    """The wall of a groove that is gone."""

    def compute() -> Wall | None:
        return cam.thinnest_wall(lambda theta: study.at_theta(theta).cam, study.cam, study.angles)

    wall: Wall | None = memory.get("wall", (study.depends_on("cam"), study.samples), compute)
    return wall


def _of_dynamics(study: Study) -> list[Finding]:
    drive, jam = study.design.drive, study.jam
    jams = [] if jam is None or study.loading.empty else [dynamics.jam_finding(jam, study.jamming_pair)]
    if "cam" not in study.stages:
        found = [*dynamics.findings(None, study.loading, "", lambda: 0.0), *jams]
    else:
        contact = None if study.is_form_closed else extremes_of(study, "dynamics", _CONTACT)["contact_force"]
        wanted = getattr(drive.loads, "least_contact_force_n", None)
        noun = "" if cam.row_of(drive.face).rolls else drive.face.noun
        found = [
            *dynamics.findings(contact, study.loading, noun, lambda: _lift_off_rpm(study), wanted),
            *jams,
        ]
        if study.is_form_closed and jam is None and not study.loading.empty:
            found += dynamics.change_findings(study.flank_impacts, drive.cam.form)
        found += (
            cam_checks.force_findings(study) + quantity_requests.pressure_findings(study) + _of_elastic_follower(study)
        )
    if study.undetermined and not study.loading.empty:
        pairs = ", ".join(name for name in study.linkage.pairs if name in study.undetermined)
        found.append(Finding("undetermined-reactions", NOTE, "linkage.links", None, {"pairs": pairs}))
    found += dynamics.element_findings(lambda angles: study.at(angles).linkage, study.program, study.loading)
    return [*found, *(shaft.findings(study.flywheel) if study.levels_torque and jam is None else [])]


def _lift_off_rpm(study: Study) -> float:
    """The speed from which on the follower leaves the cam, as it does at the design's own."""
    own = abs(study.omega)
    found = study.lift_off if study.jam is None else None
    return (own if found is None else min(found.omega, own)) * 30.0 / math.pi


def _of_elastic_follower(study: Study) -> list[Finding]:
    """That there is no steady response; that the elastic follower leaves a cam on which the rigid one would stay."""
    if not study.is_elastic:
        return []
    try:
        study.follower_response.require_steady()
    except NoSolution as error:
        return [Finding("no-elastic-follower", WARNING, error.field, None, {"why": error.problem, "hint": error.hint})]
    if study.is_form_closed or study.jam is not None or study.loading.empty:
        return []
    if extremes_of(study, "dynamics", _CONTACT)["contact_force"].low.value <= 0.0:  # the finding of separation says so
        return []
    least = extremes_of(study, "dynamics", _ELASTIC_CONTACT)["elastic_contact_force"].low
    if least.value > 0.0:
        return []
    values: dict[str, float | str] = {"force_n": least.value, "face": study.design.drive.face.noun}
    return [Finding("elastic-separation", WARNING, "loads", math.degrees(least.theta), values)]


def _of_stability(study: Study) -> list[Finding]:
    flexible = study.design.shaft is not None and study.design.shaft.elastic is not None
    return _of_flexible_shaft(study.flexible_shaft) if flexible else []


def _of_flexible_shaft(asked: Callable[[], Stability]) -> list[Finding]:
    from core.stability import findings

    try:
        return findings(asked())
    except NoStability as error:
        return [Finding("no-stability", NOTE, error.field, None, {"why": error.problem, "hint": error.hint})]


_OF_STAGE: Mapping[str, Callable[[Study], list[Finding]]] = {
    "motion": _of_motion,
    "linkage": _of_linkage,
    "cam": _of_cam,
    "dynamics": _of_dynamics,
    "stability": _of_stability,
}


# -- of several on a shaft ---------------------------------------------------------------------------------


def _of_camshaft(camshaft: Camshaft[Study], stages: Sequence[str]) -> Iterator[Finding]:
    for i, (name, study) in enumerate(camshaft.drives.items()):
        for f in _of_drive(study, stages):
            yield replace(f, field=path_of(i, f.field), values={**f.values, "drive": name})
    for name, error in camshaft.failures.items():
        yield _failure(name, error)
    if not stages or "motion" in stages:
        yield from _of_timing(camshaft.design)
    there = not camshaft.failures.keys() & set(camshaft.loading_drives)
    if there and (not stages or "dynamics" in stages):
        yield from _of_torque(camshaft)
    if there and camshaft.design.camshaft.elastic is not None and (not stages or "stability" in stages):
        yield from _of_flexible_shaft(camshaft.flexible_shaft)


def _of_drive(study: Study, stages: Sequence[str]) -> Iterator[Finding]:
    """Its findings, stage by stage as far as it has answers."""
    for stage in study.stages:
        if stages and stage not in stages:
            continue
        try:
            yield from findings_of(study, (stage,))
        except KindynaError:
            return


def _failure(name: str, error: NoSolution) -> Finding:
    at = error.cam_angles[0][0] if error.cam_angles else None
    return Finding("no-drive", ERROR, error.field, at, {"drive": name, "why": error.problem, "hint": error.hint})


def _of_timing(design: Design) -> Iterator[Finding]:
    for i, (row, at) in enumerate(zip(design.timing, distances(design), strict=True)):
        if not at.kept:
            values: dict[str, float | str] = {"first": row.first, "second": row.second, "after_deg": at.after_deg}
            values |= {"least_deg": row.least_deg, "first_deg": at.first_deg, "second_deg": at.second_deg}
            yield Finding("timing-broken", ERROR, f"timing[{i}]", None, values)
    if ring := contradiction(design):
        rows = ", ".join(f"timing[{i}]" for i in ring)
        too_much: dict[str, float | str] = {"rows": rows, "excess_deg": excess(design, ring)}
        yield Finding("timing-contradicts", ERROR, f"timing[{ring[0]}]", None, too_much)


def _of_torque(camshaft: Camshaft[Study]) -> Iterator[Finding]:
    """Of the balance cam and the flywheel."""
    try:
        study = camshaft.balancer
    except NoSolution as error:
        yield _failure("the balance cam", error)
        return
    if study is not None:
        for each in _of_drive(study, ()):
            yield replace(each, field=_of_balancer(each.field), values={**each.values, "drive": BALANCER})
    if camshaft.levels_torque:
        yield from shaft.findings(camshaft.flywheel)


def _of_balancer(field: str) -> str:
    """The balancer's field that a finding of it as a drive names."""
    table, _, key = field.partition(".")
    return f"{BALANCER}.{key}" if table in ("cam", "loads") else BALANCER
