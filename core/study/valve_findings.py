"""Findings of a valve train: its lash against the ramps of the lobe; and extremes of forces while it is not loose."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

import numpy as np

from core.findings import WARNING, Finding
from core.motion import Angles
from core.motion.extremes import Extremes, find_extremes
from core.study.extremes import extremes_of
from core.study.quantities import quantity
from core.study.stages import memory
from core.study.study import Study

MM = 1e3
ROUNDING = 1e-9  # of a ramp: a smaller excess of the lash is rounding


def extremes_beyond_lash(study: Study, name: str) -> Extremes:
    """Refined extremes of a force in SI units; with lash only where the train is not loose."""
    if study.lash is None:
        return extremes_of(study, "dynamics", (name,))[name]
    row = quantity(name)

    def force(angles: Angles) -> dict[str, np.ndarray]:
        at = study.at(angles)
        return {"": np.where(at.loading.acting(at.linkage), row.value(at), np.nan)}

    def compute() -> Extremes:
        return find_extremes(force, study.program)[""]

    extremes: Extremes = memory.get(("beyond lash", name), study.depends_on("dynamics"), compute)
    return extremes


def lash_findings(study: Study) -> Iterator[Finding]:
    """A lash that a ramp of the lobe does not take up, so that the valve opens or seats on the flank."""
    motion, lash = study.design.drive.motion, study.lash
    if lash is None or motion is None or motion.lobe is None or not isfinite(lash.at_motion):
        return
    lobe = motion.lobe
    closing = lobe.closing.ramp_mm if lobe.closing is not None else None
    lift = MM * lash.at_motion - motion.start
    sides = (("opens", "ramp_mm", lobe.ramp_mm), ("seats", "closing.ramp_mm", closing))
    too_low = [(verb, key, ramp) for verb, key, ramp in sides if ramp is not None and lift > ramp * (1.0 + ROUNDING)]
    for verb, key, ramp in too_low[:1]:
        verb = "opens and seats" if closing is None or len(too_low) == 2 else verb
        values: dict[str, float | str] = {"verb": verb, "lash_mm": lift, "ramp_mm": ramp}
        yield Finding("lash-beyond-ramp", WARNING, f"motion.lobe.{key}", None, values)
