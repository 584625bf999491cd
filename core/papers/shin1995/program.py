"""Shin1995 Table 1: what each file of the program of 1995 does, and what does it here, tried on the example's lift."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any

import numpy as np

from core.design import all_paths
from core.errors import KindynaError
from core.laws import LAWS
from core.measured import ColumnChoice, fit, layout, read_sheet, read_table
from core.motion import program
from core.papers.examples import Examples
from core.papers.shin1995.cam import largest
from core.papers.shin1995.geometry import LIFT, base
from core.study import Study, names_of, quantity

Numbers = Mapping[str, Any]
EVERY = 2  # row of the study: 360 of a turn, one a degree
COLUMNS = {"displacement": "mm", "velocity": "mm_s", "acceleration": "mm_s2"}
ALIKE = 1e-6  # of the largest: an acceleration no farther off is that of the file


def data_file(examples: Examples) -> Numbers:
    """FILEIO.C: displacement, velocity and acceleration of the lift as a file with a row a degree, and the motion that is read from it: how
    many of the columns it is made of, and how far its own velocity [mm/s] and acceleration [mm/s²] are off the file's."""
    made: Numbers = examples.once("data file of the lift", lambda: _read(examples))
    return made


def _read(examples: Examples) -> Numbers:
    study = examples.study(LIFT)
    columns = np.array([study.angle_degrees, *(quantity(name).value(study) * 1e3 for name in COLUMNS)])[:, ::EVERY]
    heads = ("cam_angle_deg", *(f"{name}_{unit}" for name, unit in COLUMNS.items()))
    lines = "\n".join([",".join(heads), *(",".join(map(repr, row)) for row in columns.T.tolist())])
    rpm = study.design.speed_rpm
    sheet = read_sheet(lines.encode(), "lift.csv")
    how = layout(sheet, ColumnChoice(), "mm", rpm)
    fitted = fit(read_table(sheet, how, rpm), 0.0)
    read = program(fitted.motion)
    y = read.state(read.angles(np.deg2rad(columns[0]))).displacement
    off = [float(np.abs(y[k] * study.omega**k * 1e3 - columns[1 + k]).max()) for k in range(3)]
    return {
        "fitted": len(fitted.columns) - len(fitted.contradicted),
        "columns": len(COLUMNS),
        "rows": columns.shape[1],
        "off": off[2] / float(np.abs(columns[3]).max()),
        "bound": ALIKE,
        "velocity_off": off[1],
        "acceleration_off": off[2],
    }


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
    ("FILEIO.C", "calls a data file of displacement, velocity, acceleration", "columns of it that a motion is made of",
     lambda examples: float(data_file(examples)["fitted"])),
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
