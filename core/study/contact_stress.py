"""Stress where the follower touches the cam, over the turn of a study: its worst, its limits, and the life of the rollers."""

from __future__ import annotations

from collections.abc import Mapping

from core import stress
from core.findings import Finding
from core.motion.extremes import Extreme
from core.stress import RollerLife
from core.study.extremes import extremes_of, fits
from core.study.stages import memory
from core.study.study import Study
from core.study.touching import PRESSURES, pairings, pressing, ratings, roller_speed


def worst(study: Study) -> Mapping[str, Extreme]:
    """First flank of each roller -> the greatest contact pressure [Pa], refined; empty where there is none."""
    there = pairings(study)
    if not there or study.loading.empty or study.jam is not None or not fits(study):
        return {}
    names = {flank: name for flank, name in PRESSURES.items() if flank in there}
    found = extremes_of(study, "dynamics", tuple(names.values()))
    return {flank: found[name].high for flank, name in names.items()}


def findings(study: Study) -> list[Finding]:
    """Pressures beyond their limits, or why there are none where they are asked for."""
    drive = study.design.drive
    if study.loading.empty or study.jam is not None:
        return []
    if lacking := stress.missing_findings(drive.face, drive.cam, drive.limits):
        return lacking
    there = pairings(study)
    if not there:
        return []
    if not fits(study):
        return (
            [stress.unfit_finding(drive.face.noun, drive.limits)] if stress.asked_for(drive.cam, drive.limits) else []
        )
    return stress.pressure_findings(worst(study), there, drive.limits)


def borne(study: Study) -> tuple[float | None, str]:
    """The least pressure [Pa] that one of the materials bears, and where that stands; None where none is known."""
    rows = [each for pair in pairings(study).values() for each in pair.surfaces if each.allowable is not None]
    least = min(rows, key=lambda each: each.allowable or 0.0, default=None)
    return (None, "") if least is None else (least.allowable, least.source)


def roller_lives(study: Study) -> tuple[RollerLife, ...]:
    """The life of every roller whose load rating is stated; none where nothing loads the cam, or friction jams."""
    stated = ratings(study)
    if not stated or study.loading.empty or study.jam is not None:
        return ()

    def compute() -> tuple[RollerLife, ...]:
        angles, weight = stress.turn_nodes(study.program, tuple(change.theta for change in study.flank_changes))
        there = study.at(angles)
        found = []
        for roller, rating in stated.items():
            speed = roller_speed(there, roller) / study.omega
            found.append(stress.life_of(roller, rating, pressing(there, roller), speed, weight, study.omega))
        return tuple(found)

    key = study.depends_on("dynamics"), tuple(stated.items())
    found: tuple[RollerLife, ...] = memory.get("rolling life", key, compute)
    return found
