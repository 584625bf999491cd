"""The best design of a study with numbers that can be manufactured, judged again by the limits of the study."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from core.design import Design, get, varied
from core.find import rounded_values
from core.find.rounding import NO_ROUNDING, rounded_flywheel
from core.find.trial import FindingsCheck
from core.study import many
from core.varying.optimum import ROBUST_MACHINES, Optimum, waived, with_flywheel
from core.varying.request import StudyOfMany
from core.varying.space import Space, constant_column, is_discrete, with_words
from core.varying.tolerances import Scatter, bounds_of


def rounded_optimum(study: StudyOfMany, optimum: Optimum, step: float = 0.0) -> Optimum:
    """Return the best design with its numbers on multiples of a step, at which every limit holds and no finding is new.

    Parameters
    ----------
    study : StudyOfMany
    optimum : Optimum
        Its design; one that is not feasible, or not better than the design of the study, is returned as it is.
    step : float
        Step of all numbers, each in its unit; 0: that of each field.

    Returns
    -------
    Optimum
        With the exact values where none of the rounded ones satisfies the limits, and a note that says so.
    """
    axes = {axis.field: axis for axis in Space(study).axes if not is_discrete(axis.info)}
    exact = {path: float(optimum.answer[path]) for path in axes}
    words = {path: value for path, value in optimum.answer.items() if path not in axes}
    base = with_words(study.base, words)
    if not optimum.is_feasible or not optimum.is_better or not axes or base is None:
        return optimum
    has_fields = any(goal.field for goal in study.file.goals)
    check = FindingsCheck(study.base, waived=waived(study.file), notes=not has_fields)

    def judged(values: Mapping[str, float]) -> Optimum | None:
        if not all(axes[path].low <= value <= axes[path].high for path, value in values.items()):
            return None
        design = varied(base, values)
        reached = _reached(study, design)
        if not all(side * reached[limit.key] <= side * bound for limit, side, bound in bounds_of(study.file.limits)):
            return None
        machine, also_set = with_flywheel(design, study.base, rounded_flywheel)
        if check.new(machine):
            return None
        candidate = replace(optimum, design=machine, answer={**optimum.answer, **values}, also_set=also_set)
        candidate = replace(candidate, goals={goal.key: reached[goal.key] for goal in study.file.goals}, exact=exact)
        return _with_share(study, candidate)

    rounded = rounded_values(exact, judged, step)
    if rounded is None:
        return replace(optimum, exact=exact, note=NO_ROUNDING)
    before, after = _reached(study, optimum.design), _reached(study, rounded.result.design)
    return replace(rounded.result, rounding=rounded.steps, cost={key: (before[key], after[key]) for key in before})


def _reached(study: StudyOfMany, design: Design) -> Mapping[str, float]:
    """Figures of the goals and limits of a study, and its goals that are fields."""
    keys = [row.key for row in study.quantities]
    value = many(design, constant_column(design, 1), keys).value if keys else {}
    fields = {goal.field: float(get(design, goal.field)) for goal in study.file.goals if goal.field}
    return {key: float(np.asarray(value[key])[0]) for key in keys} | fields


def _with_share(study: StudyOfMany, optimum: Optimum) -> Optimum | None:
    """The optimum with the share of machines that keep the limits, where the study requires one; None below it."""
    if study.file.robust is None:
        return optimum
    share = Scatter(StudyOfMany(optimum.design, study.file, study.folder)).share(ROBUST_MACHINES, study.file.seed)
    return replace(optimum, share=share) if share.interval[0] >= study.file.robust else None
