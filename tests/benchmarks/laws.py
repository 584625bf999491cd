"""Law evaluation: displacement, velocity and acceleration of the modified sine."""

from __future__ import annotations

from typing import Any

import numpy as np
from benchmarks import compiled
from benchmarks.exact import LAW
from benchmarks.plain import FEW, by_table, hermite, knots, law
from benchmarks.table import Channels, Kernel, Method

from core.laws import LAWS


def ours(u: np.ndarray, setting: None) -> Channels:
    curve = LAWS[LAW].at(u)
    return [curve[order] for order in range(3)]


def by_hand(u: np.ndarray, setting: None) -> Channels:
    """The same with one sine and one cosine an angle: what differs between the branches is looked up."""
    return law(u)


def quintic(u: np.ndarray, points: int) -> Any:
    at = knots(points, 1.0)
    return hermite(at, *by_hand(at, None))


KERNEL = Kernel(
    "law",
    "Law: s, v, a",
    given=lambda u: u,
    grid=lambda n: np.arange(n) / n,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("numpy by hand", by_hand, special=True),
        Method("compiled by numba", compiled.law, special=True, needs=("numba",)),
        *by_table(lambda at: by_hand(at, None), where=lambda u: u, end=1.0),
        Method("quintic table", lambda u, table: table.at(u, 0, 1, 2), FEW, "points", keeps=quintic),
    ),
    handed="the parts of the segment",
    warm="tables",
)
