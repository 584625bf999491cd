"""A block of many designs: of all at once what ``together`` says can be, the rest design by design."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from core import dynamics
from core.design import Design, Motion, edited, put, row_at
from core.errors import NoAnswer
from core.study.asked import TOTALS, Asked, mean_of, of_range
from core.study.extremes import exists, extremes_of, undercut_on
from core.study.highest import nodes_of
from core.study.quantities import OF_MOTOR, quantity
from core.study.study import Study
from core.study.together import UNDERCUT, Results, Together

NO_VALUE, OUT_OF_RANGE = "no-value", "out-of-range"
"""Reasons beside the codes of errors and findings: the design has no such quantity, as a stress where nothing fits; a number lies outside
the range of its field."""

POINTS = 60_000  # cam angles of a block: its arrays stay in the cache, and take far less than 256 MiB

_MOTION = "motion."
_VARIED = ("follower.", "cam.", "loads.", "shaft.", _MOTION)
_SWITCHES = re.compile(r"loads\.process\[\d+\]\.(cam_|position_|points)")
"""When a process force works, by which the turn is cut into pieces."""
_READS_CENTRES = frozenset({"instant_centre", "instant_centre_x", "instant_centre_y", "instant_centre_velocity"})


def together(design: Design, paths: Sequence[str], asked: Asked) -> bool:
    """Whether what is asked of designs that differ in these paths is computed of all at once: lengths, angles, masses, springs,
    friction and speed of a follower, and quantities that follow at each angle by itself."""
    if design.listed or design.drive.links or not asked.name:
        return False
    row = quantity(asked.name)
    return (
        all(path.startswith(_VARIED) and not _SWITCHES.match(path) for path in paths)
        and not (design.drive.loads.process and any(path.startswith(_MOTION) for path in paths))
        and row.stage in ("motion", "linkage", "cam", "dynamics")
        and asked.name not in OF_MOTOR | _READS_CENTRES
        and not row.needs.startswith("elastic")
    )


def block(
    design: Design, infos: Mapping[str, Any], asked: tuple[Asked, ...], polish: bool, rows: np.ndarray
) -> Results:
    """What is asked of the designs with these numbers (p, m)."""
    paths, m = tuple(infos), rows.shape[1]
    found = Results(np.full((len(asked), m), np.nan), np.full((len(asked), m), np.nan), np.full(m, "", dtype=object))
    inside = np.all([_admitted(info, row) for info, row in zip(infos.values(), rows, strict=True)], axis=0)
    moving = any(path.startswith(_MOTION) for path in paths)
    motions: dict[int, Motion] = {}
    for k in np.flatnonzero(inside).tolist() if moving else ():
        motions[k] = motion = _own_motion(design, paths, rows[:, k])
        inside[k] = all(segment.span_deg > 0.0 for segment in motion.segments)
    found.reason[~inside] = OUT_OF_RANGE
    good = np.flatnonzero(inside)
    if not good.size:
        return found
    chosen = np.array([together(design, paths, each) for each in asked])
    at_once, alone = np.flatnonzero(chosen), np.flatnonzero(~chosen)
    further = {int(k): alone for k in good} if alone.size else {}
    if at_once.size:
        one = Together(design, _fixed(paths, rows[:, good]), [motions[k] for k in good.tolist()] if moving else ())
        part = one.results([asked[i] for i in at_once], polish)
        found.value[np.ix_(at_once, good)], found.theta[np.ix_(at_once, good)] = part.value, part.theta
        found.reason[good] = part.reason
        for k in good[one.turns_back].tolist():
            further[k], found.reason[k] = np.arange(len(asked)), ""
    for k, which in further.items():
        values, thetas, reason = _one(_varied(design, paths, rows[:, k].tolist()), [asked[i] for i in which])
        found.value[which, k], found.theta[which, k] = values, thetas
        found.reason[k] = found.reason[k] or reason
    return found


def _varied(design: Design, paths: Sequence[str], numbers: Sequence[Any]) -> Design:
    """The design with these numbers; a span or a rise takes from segments that are not varied what it gains, as where it is typed."""
    kept = {row_at(path)[1] for path in paths if path.startswith(_MOTION)}
    for path, number in zip(paths, numbers, strict=True):
        change = path.startswith(_MOTION)
        design = edited(design, path, number, kept) if change else put(design, path, number)
    return design


def _own_motion(design: Design, paths: Sequence[str], numbers: np.ndarray) -> Motion:
    """The motion with those of the numbers (p,) that are its."""
    moving = [(path, float(number)) for path, number in zip(paths, numbers, strict=True) if path.startswith(_MOTION)]
    motion = _varied(design, *zip(*moving, strict=True)).drive.motion
    assert motion is not None, "a path of a motion"
    return motion


def _fixed(paths: Sequence[str], rows: np.ndarray) -> dict[str, np.ndarray]:
    """Path -> its numbers (m,), of those that are none of the motion's."""
    return {path: row for path, row in zip(paths, rows, strict=True) if not path.startswith(_MOTION)}


def at_once(design: Design, paths: Sequence[str], rows: np.ndarray) -> Together:
    """The designs with these numbers (p, m), whatever the ranges of their fields."""
    moving = any(path.startswith(_MOTION) for path in paths)
    return Together(design, _fixed(paths, rows), [_own_motion(design, paths, row) for row in rows.T] if moving else ())


def _admitted(info: Any, row: np.ndarray) -> np.ndarray:
    """Whether each number (m,) lies in the range of its field."""
    above = row > info.low if info.open_low else row >= info.low
    return np.asarray(above & (row <= info.high) & np.isfinite(row))


def block_size(design: Design) -> int:
    """Designs of a block; it depends on nothing that is varied."""
    motion = design.drives[0].motion
    points = 128 if motion is None or len(design.drives) > 1 else nodes_of(Study(design).uncut)[0].theta.size
    return max(1, POINTS // points)


# -- design by design --------------------------------------------------------------------------------------


def _one(design: Design, asked: Sequence[Asked]) -> tuple[list[float], list[float], str]:
    """Values, cam angles [rad] and reason of a single design."""
    study, reasons = Study(design), []
    values, thetas = [np.nan] * len(asked), [np.nan] * len(asked)
    for i, each in enumerate(asked):
        try:
            values[i], thetas[i] = _asked_of_one(study, each)
        except NoAnswer as error:
            reasons.append(error.code)
        except _NoValue as error:
            reasons.append(str(error))
    if (
        not reasons
        and "cam" in study.stages
        and any(a.name and quantity(a.name).stage in ("cam", "dynamics") for a in asked)
    ):
        reasons += [UNDERCUT for flank in study.cam.flanks if undercut_on(study, flank.name)]
    return values, thetas, reasons[0] if reasons else ""


class _NoValue(Exception):
    """A design that could have a value has none; its reason."""


def _asked_of_one(study: Study, asked: Asked) -> tuple[float, float]:
    if not asked.name:
        return float(TOTALS[asked.of](study)), np.nan
    row = quantity(asked.name)
    if row.stage == "dynamics" and study.jam is not None:
        raise _NoValue(dynamics.jam_finding(study.jam, study.jamming_pair).code)
    if not exists(study, row):
        raise _NoValue(UNDERCUT if row.fitting else NO_VALUE)
    if asked.of in ("rms", "mean"):
        angles, weight = nodes_of(study.program)
        return mean_of(np.broadcast_to(row.value(study.at(angles)), angles.theta.size), weight, asked.of), np.nan
    found = extremes_of(study, row.stage, (asked.name,))[asked.name]
    value, theta = of_range(asked.of, *((each.value, each.theta) for each in (found.low, found.high)))
    return float(value), float(theta)
