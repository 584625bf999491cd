"""What is said of the best design of a study beside it: how much of a torque no length changes, and which law gives more; of one that
misses the limits by how much."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from core.design import Design, all_paths, get, only
from core.find.checked import FindingsCheck
from core.laws import LAWS
from core.study import Study, many
from core.study.batches.asked import asked_of
from core.study.quantities import quantity
from core.units import split_unit
from core.varying.optimum import Optimum, waived, with_flywheel
from core.varying.request import Goal, StudyOfMany
from core.varying.space import as_it_is, with_words
from core.varying.tolerances import bounds_of

TORQUE, POWER = "drive_torque", "power.load"
PEAKS = ("max", "abs")
MORE = 0.01  # of the goal: a law that gives no more than that is not worth a word
WHOLE = 1000.0  # N·m, from which on a torque is said without decimals
DWELL = "dwell"


def remarks(study: StudyOfMany, found: Optimum) -> tuple[str, ...]:
    """Sentences about an answer that keeps the limits, which cost a design of each law; the limits missed by one that does not."""
    if not found.kept:
        return tuple(_missed(study, found))
    said = [_fixed(found, goal) for goal in study.file.goals]
    return tuple(each for each in (*said, _law(study, found)) if each)


def _missed(study: StudyOfMany, found: Optimum) -> Iterator[str]:
    """What the design reaches of each limit that it does not keep."""
    bounds = list(bounds_of(study.file.limits))
    reached = many(found.design, as_it_is(found.design, 1), [limit.key for limit, _, _ in bounds]).value
    for limit, side, bound in bounds:
        value = float(reached[limit.key][0])
        if not side * value <= side * bound:
            yield f"{limit.key} = {value:.7g}, {'most' if side > 0.0 else 'least'} {bound:g}"


def _fixed(found: Optimum, goal: Goal) -> str:
    """Of a peak torque what a force on the follower takes: T_F = -F y', by the balance of power at constant speed."""
    asked = asked_of(found.design, goal.key)
    if asked.name != TORQUE or asked.of not in PEAKS or not goal.minimise:
        return ""
    design = found.design if asked.drive is None else only(found.design, asked.drive)
    peak = many(found.design, as_it_is(found.design, 1), [goal.key])
    there = Study(design).at_theta(np.deg2rad(peak.angle_deg[goal.key]))
    torque, power = (float(quantity(name).value(there)[0]) for name in (TORQUE, POWER))
    held = -power / there.omega
    if held * torque <= 0.0:
        return ""
    part = f"{_newton_metres(held)} of {_newton_metres(torque)} N·m are force times y'"
    if abs(held) > abs(torque):  # masses and friction take some off
        part = f"force times y' alone is {_newton_metres(held)} N·m, more than all {_newton_metres(torque)} N·m,"
    at = peak.angle_deg[goal.key][0]
    return f"{quantity(TORQUE).label}: {part} at {at:.2f}°, which motion and load fix, whatever the lengths"


def _newton_metres(torque: float) -> str:
    """Four digits of a small one, a large one to 1 N·m."""
    return f"{abs(torque):,.0f}" if abs(torque) >= WHOLE else f"{abs(torque):.4g}"


def _law(study: StudyOfMany, found: Optimum) -> str:
    """The law that, put in for those of all rises with the same numbers, makes the first goal best and brings no new finding."""
    goal, design = study.file.goals[0], found.design
    laws = [path for path in all_paths(design) if path.endswith(".law")]
    moved = [path for path in laws if get(design, path) != DWELL]
    if not moved or any(row.field in laws for row in study.file.vary):
        return ""
    side, own = 1.0 if goal.minimise else -1.0, found.goals[goal.key]
    check = FindingsCheck(design, waived=waived(study.file))
    for value, law, made in sorted(_others(study, design, moved), key=lambda row: side * row[0]):
        if side * (own - value) <= MORE * abs(own):
            break
        if not check.new(with_flywheel(made, design)[0]):
            label, unit = LAWS[law].label, split_unit(goal.quantity)[1].symbol
            return (
                f"Another law, {label} ({law}), with the same numbers brings the first goal to {value:.5g}"
                f"{f' {unit}' if unit else ''} ({100.0 * (value / own - 1.0):+.1f} %)"
            )
    return ""


def _others(study: StudyOfMany, design: Design, paths: Sequence[str]) -> Iterator[tuple[float, str, Design]]:
    """The first goal with each law that keeps the limits, the law, and the design."""
    keys = [row.key for row in study.asked]
    for law in LAWS:
        made = with_words(design, dict.fromkeys(paths, law)) if law != DWELL else None
        if made is None:
            continue
        value = many(made, as_it_is(made, 1), keys).value
        if all(side * value[limit.key][0] <= side * bound for limit, side, bound in bounds_of(study.file.limits)):
            goal = float(value[study.file.goals[0].key][0])
            if math.isfinite(goal):
                yield goal, law, made
