"""Limits of the forces: separation, jamming, nothing to move, elements that cannot act as they should."""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import numpy as np

from core.dynamics.elements import Friction, Loading, ScheduledForce, Spring, Torsion
from core.dynamics.schedule import OverMotion
from core.findings import ERROR, NOTE, WARNING, Finding
from core.mechanism.kinematics import Kinematics
from core.motion import TURN, Angles
from core.motion.extremes import Extreme, Pieces, Range, find_extremes, piecewise_angles

_STILL = 1e-9  # of a length, or [rad], per radian of the turn: less is rounding
_MEET = 1e-6  # of the way of the links: ends that come so near meet
KEPT = 1e-9  # of the least contact force wanted: by which it may be missed
At = Callable[[Angles], Kinematics]


def findings(
    contact: Range | None, loading: Loading, noun: str, lift_off_rpm: Callable[[], float], wanted: float | None = None
) -> list[Finding]:
    """What the refined extremes of the contact force [N] exceed; contact: None where no follower can leave a cam; noun: of a face that does
    not roll; lift_off_rpm: the speed from which the follower leaves the cam, asked for where it does; wanted: the least contact force
    that is to be kept."""
    if loading.empty:
        return [Finding("no-load", NOTE, "loads", None)]
    found = []
    face = {"face": noun} if noun else {}
    least = None if contact is None else contact.low
    if least is not None and math.isfinite(least.value) and least.value <= 0.0:  # an infinite one is the jam's
        lifted: dict[str, float | str] = {"force_n": least.value, "speed_rpm": lift_off_rpm(), **face}
        found.append(Finding("separation", ERROR, "loads", math.degrees(least.theta), lifted))
    elif least is not None and wanted and math.isfinite(least.value) and least.value < wanted * (1.0 - KEPT):
        values = {"value": least.value, "limit": wanted}
        found.append(
            Finding("contact-force-low", WARNING, "loads.least_contact_force_n", math.degrees(least.theta), values)
        )
    return found


def jam_finding(jam: Extreme, friction: Friction | None) -> Finding:
    """Where friction jams hardest, and what: the pair that has the largest part in it, None: the face on the cam."""
    at, values = math.degrees(jam.theta), {"factor": jam.value}
    if friction is None:
        return Finding("contact-jamming", ERROR, "loads.contact_friction", at, values)
    if friction.own:
        return Finding("jamming", ERROR, friction.field, at, values)
    return Finding("pair-jamming", ERROR, friction.field, at, {**values, "pair": friction.pair})


def element_findings(at: At, program: Pieces, loading: Loading) -> list[Finding]:
    """Springs that have nothing to pull with, no length, or ends that meet, so that their force has no direction; torsion springs
    that are wound up with every turn or whose links do not turn; dampers between which nothing moves; process forces that never work.
    ``at`` gives the kinematics at any cam angles."""
    every = [element for element in loading.others if isinstance(element, Spring | Torsion)]
    processes = [element for element in loading.others if isinstance(element, ScheduledForce)]
    found = [Finding("spring-idle", WARNING, row.field, None, {"name": _words(row)}) for row in every if not row.acts]
    rows = [row for row in every if row.acts]
    found += [
        Finding("process-idle", WARNING, each.field, None, {"name": _words(each)})
        for each in processes
        if not each.acts
    ]
    processes = [each for each in processes if each.acts]
    if not rows and not processes:
        return found
    angles = piecewise_angles(program)
    kinematics = at(angles)
    motion = kinematics.motion
    for each in processes:
        if not each.schedule.value(motion)[0].any():
            code = "process-never" if isinstance(each.schedule, OverMotion) else "process-idle"
            found.append(Finding(code, WARNING, each.field, None, {"name": _words(each)}))
    size = max(
        float(np.abs(pose.origin[0] - pose.origin[0][0]).max(initial=0.0)) for pose in kinematics.bodies.values()
    )
    for row in rows:
        if isinstance(row, Spring) and _coincide(row, kinematics, size):
            found.append(Finding("spring-no-length", ERROR, row.field, None, {"name": _words(row)}))
            continue
        if isinstance(row, Torsion) and _still(row, kinematics):
            found.append(Finding("torsion-still", WARNING, row.field, None, {"name": _words(row)}))
            continue
        if row.damping and _still(row, kinematics):
            found.append(
                Finding("damper-still", WARNING, f"{row.field}.{row.damping_key}", None, {"name": _words(row)})
            )
        if isinstance(row, Torsion):
            turns = round(float(row.angle(kinematics)[-1] - row.angle(kinematics)[0]) / TURN)
            if row.rate and turns:
                found.append(
                    Finding("spring-winds-up", ERROR, row.field, None, {"name": _words(row), "turns": float(turns)})
                )
        elif row.length or row.damping:
            least = find_extremes(lambda there, row=row: {"": np.abs(row.between(at(there)))}, program)[""].low  # type: ignore[misc]
            if least.value <= _MEET * max(size, row.length):
                found.append(
                    Finding("spring-ends-meet", ERROR, row.field, math.degrees(least.theta), {"name": _words(row)})
                )
    return found


def _words(row: Spring | Torsion | ScheduledForce) -> str:
    word = "process_force" if isinstance(row, ScheduledForce) else ""
    return re.sub(r"(?=\d)", " ", re.sub(r"^process", word, row.name), count=1).replace("_", " ")


def _coincide(row: Spring, kinematics: Kinematics, size: float) -> bool:
    """Whether both ends stand in one place at every angle, but for rounding."""
    return bool((np.abs(row.between(kinematics)) <= _MEET * max(size, row.length)).all())


def _still(row: Spring | Torsion, kinematics: Kinematics) -> bool:
    """Whether what a damper works on moves nowhere, but for rounding."""
    if isinstance(row, Torsion):
        return bool((np.abs(row.angle(kinematics, 1)) <= _STILL).all())
    return bool((np.abs(row.stretch(kinematics)) <= _STILL * np.abs(row.between(kinematics)).max(initial=0.0)).all())
