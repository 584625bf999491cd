"""What the benchmark measures errors against: values at fifty digits, rounded to floats, frozen in exact.json.

Of motion, linkage, cam and forces they come from power series about each cam angle (tests/references.py), of the four-bar from two
circles that meet, of the flywheel from collocation at 30 nodes a piece, of the flexible shaft from power series in time.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from mechanisms import LIFT, with_shaft

FILE = Path(__file__).with_name("exact.json")
LAW = "modified-sine"
FITTED = with_shaft(LIFT, flywheel_inertia_kg_m2=2000.0, motor_slope_nm_s_per_rad=3000.0)
"""The lift with a flywheel that levels some of its torque; its speed changes by half."""
LENGTHS = (100.0, 30.0, 90.0, 70.0)  # of the four-bar: ground, crank, coupler, rocker [mm]
Q, SAFETY, DAMPING = 0.05, 1.5, 0.02  # of Kim1990's shaft
ETAS = (0.31373, 5.49517)  # of the first and the last monodromy matrix
SPEED = 1.3  # η of the wind-up
TURNS = 5


@dataclass(frozen=True)
class Exact:
    """Values of one kernel: where (m,), what (c, m), how large each channel gets (c,)."""

    at: np.ndarray
    values: np.ndarray
    scale: np.ndarray

    def error(self, told: Sequence[np.ndarray]) -> float:
        """The largest error of channels (c, m), relative to the channel's scale; inf where a value is none."""
        off = [np.abs(np.asarray(row) - values) for row, values in zip(told, self.values, strict=True)]
        worst = max(float(row.max()) / scale for row, scale in zip(off, self.scale.tolist(), strict=True))
        return worst if math.isfinite(worst) else math.inf


@cache
def exact(kernel: str) -> Exact:
    rows = json.loads(FILE.read_text(encoding="utf-8"))[kernel]
    values = np.array(rows["values"])
    if values.ndim == 3:  # real and imaginary part
        values = values[..., 0] + 1j * values[..., 1]
    return Exact(np.array(rows["at"]), values, np.array(rows["scale"]))
