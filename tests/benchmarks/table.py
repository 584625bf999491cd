"""What is measured: kernels, and for each the methods that do its job. One row each; measuring.py walks them."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
from benchmarks.exact import Exact, exact

from core.motion import TURN
from core.study.stages import clear_caches

USUAL = 3600
NO_SETTING = (None,)
BY_HAND = ("numpy by hand", None)

Channels = Sequence[np.ndarray]
Solve = Callable[[Any, Any], Channels]


@dataclass(frozen=True)
class Method:
    """One way to do a kernel's job.

    name      as told in tables
    solve     what is timed: (what is given at n cam angles, setting) -> the kernel's channels, each (n,); where the method
              keeps something, that is handed in place of the setting
    settings  of what decides its error (step, points of a table, tolerance), the usual one first; ``knob`` names it
    ours      True for what KINDYNA does
    keeps     (what is given, setting) -> what may be kept from call to call of the same design: a table, a matrix, samples.
              A warm run finds it made; a cold run makes it
    needs     packages it stands on that may not be there
    special   worked out for this one mechanism, law, sequence of curves or cam; the others, as ours, do any
    on_grid   it takes neighbours among the cam angles that are given, so its error is that of an even grid of them
    """

    name: str
    solve: Solve
    settings: Sequence[Any] = NO_SETTING
    knob: str = ""
    ours: bool = False
    keeps: Callable[[Any, Any], Any] | None = None
    needs: tuple[str, ...] = ()
    special: bool = False
    on_grid: bool = False

    @property
    def lacks(self) -> str:
        """The first package that is not there, '' where all are."""
        return next((package for package in self.needs if importlib.util.find_spec(package) is None), "")

    def kept(self, there: Any, setting: Any) -> Any:
        """What ``solve`` takes beside what is given."""
        return self.keeps(there, setting) if self.keeps else setting

    def cold(self, there: Any, setting: Any) -> Channels:
        """With nothing kept."""
        return self.solve(there, self.kept(there, setting))


@dataclass(frozen=True, eq=False)
class Kernel:
    """One job.

    name     as in the CSV; title as in tables
    given    what every method starts from at cam angles (m,), or points of a chart, or times; not timed
    grid     the cam angles of a run with n of them, or the points, or the times of n turns (m,)
    methods  ours first
    handed   in words: what every method is given; ``warm``: what each may keep from run to run
    again    the same once more as nobody has read it yet, so that no run finds what an earlier one has made
    usual    how many of them a run has
    rival    the method, with its setting, by which ``make bench-check`` goes; values: kernel whose 50-digit values are these too
    """

    name: str
    title: str
    given: Callable[[np.ndarray], Any]
    grid: Callable[[int], np.ndarray]
    methods: tuple[Method, ...]
    handed: str
    warm: str
    again: Callable[[Any], Any] = field(default=lambda there: there)
    usual: int = USUAL
    between: int = field(
        default=720
    )  # angles among which the exact ones stand, for methods that go from one to the next
    unit: str = "cam angles"  # what n counts
    rival: tuple[str, Any] = BY_HAND
    values: str = ""

    @property
    def exact(self) -> Exact:
        return exact(self.values or self.name)

    @property
    def ours(self) -> Method:
        return self.methods[0]

    def error(self, method: Method, setting: Any) -> float:
        """The largest true error of a method, relative to each channel's scale."""
        there = self.exact
        if method.on_grid:
            return self._error_on_grids(method, setting)
        given = _among(self)
        told = method.cold(given.there, setting)
        if self.between == 1:
            return there.error(told)
        return there.error([np.broadcast_to(channel, given.theta.shape)[given.at] for channel in told])

    def _error_on_grids(self, method: Method, setting: Any) -> float:
        """Each exact value by the even grid of the usual size that holds its angle."""
        told = [
            [np.broadcast_to(channel, grid.theta.shape)[grid.at] for channel in method.cold(grid.there, setting)]
            for grid in _grids(self)
        ]
        return self.exact.error([np.array(channel) for channel in zip(*told, strict=True)])


@dataclass(frozen=True)
class _Given:
    """Angles, where among them the exact ones stand, and what is given there."""

    theta: np.ndarray
    at: Any
    there: Any


Give = Callable[[np.ndarray], Any]


def _among(kernel: Kernel) -> _Given:
    at = kernel.exact.at
    theta = np.union1d(kernel.grid(kernel.between), at) if kernel.between > 1 else at
    return _given_among(kernel.given, theta.tobytes(), at.tobytes())


def _grids(kernel: Kernel) -> tuple[_Given, ...]:
    return _given_on_grids(kernel.given, kernel.usual, kernel.exact.at.tobytes())


@cache
def _given_among(given: Give, theta: bytes, at: bytes) -> _Given:
    """The same for all kernels that are given the same."""
    angles = np.frombuffer(theta)
    return _Given(angles, np.searchsorted(angles, np.frombuffer(at)), given(angles))


@cache
def _given_on_grids(given: Give, n: int, at: bytes) -> tuple[_Given, ...]:
    made, step = [], TURN / n
    for angle in np.frombuffer(at).tolist():
        index = int(angle // step)
        theta = angle - index * step + step * np.arange(n)
        theta[index] = angle
        made.append(_Given(theta, index, given(theta)))
    return tuple(made)


def forget() -> None:
    """Everything that KINDYNA keeps from call to call, whatever it depends on: what a cold run starts from."""
    clear_caches()
    for name, module in list(sys.modules.items()):
        if name == "core" or name.startswith("core."):
            for value in list(vars(module).values()):
                clear = getattr(value, "cache_clear", None)
                if callable(clear) and not isinstance(value, type):
                    clear()


def kernels() -> tuple[Kernel, ...]:
    """All of them; later ones are further rows."""
    from benchmarks import blending, cams, dyads, flywheels, forces, hill, laws, linkages, windups

    return (
        laws.KERNEL,
        blending.KERNEL,
        linkages.KERNEL,
        dyads.KERNEL,
        cams.PROFILE,
        cams.CURVATURE,
        forces.KERNEL,
        forces.CHAIN,
        flywheels.KERNEL,
        hill.TONGUES,
        hill.MONODROMY,
        windups.KERNEL,
    )
