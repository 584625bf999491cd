"""Shin1995 Table 1: what each file of the program of 1995 does, and what does it here, tried on the example's lift."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any

import numpy as np

from core.design import all_paths
from core.errors import KindynaError
from core.laws import LAWS
from core.papers.examples import Examples
from core.papers.shin1995.cam import largest
from core.papers.shin1995.geometry import LIFT, base
from core.project import dumps, loads
from core.study import Study, names_of

Numbers = Mapping[str, Any]


def _read_back(examples: Examples) -> float:
    design = examples.design(LIFT)
    return float(loads(dumps(design)) == design)


def _smooth_joins(study: Study) -> float:
    """Joins at which neither velocity nor acceleration jumps."""
    return float(sum(not join.jumps[1:3].any() for join in study.program.joins))


def _of_lift(measure: Callable[[Study], float]) -> Callable[[Examples], float]:
    return lambda examples: measure(examples.study(LIFT))


FILES: tuple[tuple[str, str, str, Callable[[Examples], float]], ...] = (
    ("MAIN.C", "calls each program, makes the menus", "stages of a study", _of_lift(lambda s: float(len(s.stages)))),
    ("INPUT.C", "screen input and output", "values that a form takes", _of_lift(lambda s: float(len(list(all_paths(s.design)))))),
    ("MOTION.C", "follower displacement, velocity, acceleration", "motion laws", lambda _: float(len(LAWS))),
    ("MAKE.C", "makes the displacement curve, decides its continuity", "joins without a jump of v and a", _of_lift(_smooth_joins)),
    ("FILEIO.C", "reads a data file", "file written and read back the same (1: yes)", _read_back),
    ("COMPO.C", "geometric form, basic position", "L0, mm", lambda examples: base(examples)["slider"]),
    ("KINE.C", "shape of the cam, pressure angle diagram", "largest pressure angle, °",
     _of_lift(lambda s: float(np.rad2deg(largest(s, "cam", "pressure_angle"))))),
    ("DYNA.C", "cam contact forces and torque", "largest torque, N·m", _of_lift(lambda s: largest(s, "dynamics", "drive_torque"))),
    ("GRAPH.C", "draws graphs", "quantities that a graph can show", _of_lift(lambda s: float(len(names_of(s.design))))),
)  # fmt: skip
"""File -> its key point in Table 1, what is tried here, and what comes out."""


def _tried(measure: Callable[[Examples], float], examples: Examples) -> float:
    try:
        return measure(examples)
    except KindynaError:
        return 0.0


def files(examples: Examples) -> Numbers:
    return {"found": {name: _tried(measure, examples) for name, _, _, measure in FILES}}


def all_there(found: Mapping[str, float]) -> tuple[str, str]:
    """Whether each has something to show for itself."""
    without = [name for name, value in found.items() if not isfinite(value) or value == 0.0]
    words = f"{len(found) - len(without)} of {len(found)} files have their counterpart, tried on the lift"
    return ("differs" if without else "agrees"), words + (f"; not {', '.join(without)}" if without else "")
