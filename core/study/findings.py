"""What a study exceeds: the findings of each stage, from its refined extremes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from core import cam, dynamics, mechanism, motion, shaft
from core.cam import Wall
from core.design import with_drive
from core.errors import NoAnswer, NoStability
from core.findings import ERROR, NOTE, WARNING, Finding
from core.motion import program
from core.motion.extremes import find_extremes
from core.study import cam_checks, contact_stress
from core.study.quantities import quantity
from core.study.stages import memory

if TYPE_CHECKING:
    from core.study.study import Study

_ORDER = {ERROR: 0, WARNING: 1, NOTE: 2}
_CONTACT, _ELASTIC_CONTACT = ("contact_force",), ("elastic_contact_force",)


def findings(study: Study, stages: tuple[str, ...]) -> tuple[Finding, ...]:
    """Of the named stages, the gravest first. Raises NoAnswer as the stages do."""
    found = [f for name in stages for f in _OF_STAGE[name](study)]
    return tuple(sorted(found, key=lambda f: _ORDER[f.severity]))


def _of_motion(study: Study) -> list[Finding]:
    return motion.findings(program(study.design.drive.motion))


def _of_linkage(study: Study) -> list[Finding]:
    names = [n for n in study.quantities("linkage") if n in mechanism.SINGULAR or n.startswith("transmission.")]
    extremes = study.extremes("linkage", tuple(names)) if names else {}
    return mechanism.findings(study.course, extremes, study.by_crank)


def _of_cam(study: Study) -> list[Finding]:
    drive, extremes = study.design.drive, study.cam_extremes
    grounds = {flank.name: study.held_by(flank.body) for flank in study.cam.flanks}

    def least_at(name: str, base_radius_mm: float) -> float:
        """The refined least value of a quantity of the cam with another base radius; NaN where there is none."""
        other = study.of(with_drive(study.design, cam=replace(drive.cam, base_radius_mm=base_radius_mm)))
        try:
            return find_extremes(lambda angles: {name: quantity(name).value(other.at(angles))}, other.program)[
                name
            ].low.value
        except NoAnswer:
            return math.nan

    found = cam.findings(extremes, grounds[cam.INNER], drive.face, drive.cam, least_at)
    found += cam.further_findings(
        extremes, grounds, drive.face, drive.cam, cam.second_entry(drive.mechanism, drive.cam)
    )
    found += cam.wall_findings(_wall(study), drive.cam) if any(f.name == cam.OUTER for f in study.cam.flanks) else []
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
        contact = None if study.holds else study.extremes("dynamics", _CONTACT)["contact_force"]
        wanted = getattr(drive.loads, "least_contact_force_n", None)
        found = [
            *dynamics.findings(contact, study.loading, drive.face.noun, lambda: _lift_off_rpm(study), wanted),
            *jams,
        ]
        if study.holds and jam is None and not study.loading.empty:
            found += dynamics.change_findings(study.flank_impacts, drive.cam.form)
        found += cam_checks.force_findings(study) + contact_stress.findings(study) + _of_elastic_follower(study)
    found += dynamics.element_findings(lambda angles: study.at(angles).linkage, study.program, study.loading)
    return [*found, *(shaft.findings(study.flywheel) if study.levelled and jam is None else [])]


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
    except NoAnswer as error:
        return [Finding("no-elastic-follower", WARNING, error.field, None, {"why": error.problem, "hint": error.hint})]
    if study.holds or study.jam is not None or study.loading.empty:
        return []
    if study.extremes("dynamics", _CONTACT)["contact_force"].low.value <= 0.0:  # the finding of separation says so
        return []
    least = study.extremes("dynamics", _ELASTIC_CONTACT)["elastic_contact_force"].low
    if least.value > 0.0:
        return []
    values: dict[str, float | str] = {"force_n": least.value, "face": study.design.drive.face.noun}
    return [Finding("elastic-separation", WARNING, "loads", math.degrees(least.theta), values)]


def _of_stability(study: Study) -> list[Finding]:
    if study.design.shaft is None or study.design.shaft.elastic is None:
        return []
    from core.stability import findings

    try:
        return findings(study.flexible_shaft())
    except NoStability as error:
        return [Finding("no-stability", NOTE, error.field, None, {"why": error.problem, "hint": error.hint})]


_OF_STAGE: Mapping[str, Callable[[Study], list[Finding]]] = {
    "motion": _of_motion,
    "linkage": _of_linkage,
    "cam": _of_cam,
    "dynamics": _of_dynamics,
    "stability": _of_stability,
}
