"""What is measured: kernels, and for each the methods that do its job. One row each; run.py walks them."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from benchmarks.exact import exact

SIZES = (360, 3600, 36_000, 360_000, 1_000_000)
USUAL = 3600
NO_SETTING = (None,)

Channels = Sequence[np.ndarray]
Solve = Callable[[Any, Any], Channels]


@dataclass(frozen=True)
class Method:
    """One way to do a kernel's job.

    name      as told in tables
    solve     what is timed: (what is given at n cam angles, setting) -> the kernel's channels, each (n,)
    settings  of what decides its error (step, points of a table, tolerance), the usual one first; ``knob`` names it
    ours      True for what KINDYNA does
    needs     packages it stands on that may not be there
    one_by_one  a Python loop over angles: not for a million of them
    """

    name: str
    solve: Solve
    settings: Sequence[Any] = NO_SETTING
    knob: str = ""
    ours: bool = False
    needs: tuple[str, ...] = ()
    one_by_one: bool = False

    @property
    def lacks(self) -> str:
        """The first package that is not there, '' where all are."""
        return next((package for package in self.needs if importlib.util.find_spec(package) is None), "")


@dataclass(frozen=True)
class Kernel:
    """One job.

    name     as in the CSV; title as in tables
    given    what every method starts from at cam angles (m,), or points of a chart, or times; not timed
    grid     the cam angles of a run with n of them, or the points, or the times of n turns (m,)
    methods  ours first
    roundings  of the numbers that go in and of what is made of them, in our method; with the condition of the exact values
               it bounds our error where no larger one is wanted
    digits   some four times our error, far below its bound: a digit that is lost is seen
    """

    name: str
    title: str
    given: Callable[[np.ndarray], Any]
    grid: Callable[[int], np.ndarray]
    methods: tuple[Method, ...]
    roundings: float
    digits: float
    sizes: tuple[int, ...] = SIZES
    usual: int = USUAL
    between: int = field(default=720)  # angles among which the exact ones stand, for methods that go from one to the next
    unit: str = "cam angles"  # what n counts

    @property
    def ours(self) -> Method:
        return self.methods[0]

    def bound(self, setting: Any = None) -> float:
        """What our error may be at most, relative to each channel's scale. A setting of ours is the error wanted."""
        return max(self.roundings * float(np.finfo(float).eps) * exact(self.name).condition, setting or 0.0)

    def error(self, method: Method, setting: Any) -> float:
        """The largest true error of a method, relative to each channel's scale."""
        there = exact(self.name)
        theta = np.union1d(self.grid(self.between), there.at) if self.between > 1 else there.at
        told = method.solve(self.given(theta), setting)
        at = np.searchsorted(theta, there.at)
        return there.error([np.broadcast_to(channel, theta.shape)[at] if self.between > 1 else channel for channel in told])


def kernels() -> tuple[Kernel, ...]:
    """All of them; later ones are further rows."""
    from benchmarks import blending, cams, dyads, flywheels, forces, hill, laws, linkages, windups

    return (
        laws.KERNEL, blending.KERNEL, linkages.KERNEL, dyads.KERNEL, cams.PROFILE, cams.CURVATURE, forces.KERNEL,
        flywheels.KERNEL, hill.TONGUES, hill.MONODROMY, windups.KERNEL,
    )  # fmt: skip
