"""Errors for the user: each names the field or the cam angle, the value, the allowed range and the remedy.

An exception means that no solution exists; limits that are merely exceeded are findings.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, Protocol

import numpy as np

from core.frozen import frozen
from core.number_text import distinct_texts


def _value_text(value: Any) -> str:
    try:
        text = repr(value)
    except (RecursionError, ValueError):  # nested, or an integer, beyond what Python prints
        text = f"({type(value).__name__} too large to show)"
    return text if len(text) <= 60 else text[:57] + "..."


@frozen
class Fault:
    """One wrong entry of a design.

    Attributes
    ----------
    path : field, spelled as in the file: ``motion.segments[2].span_deg``
    value : its value, ``MISSING`` where the file gives none
    problem : why the value is wrong
    allowed : the allowed values
    """

    path: str
    value: Any
    problem: str
    allowed: str = ""

    def __str__(self) -> str:
        entry = self.path if self.value is MISSING else f"{self.path} = {_value_text(self.value)}"
        text = f"{entry}: {self.problem}" if entry else self.problem
        return f"{text}; allowed: {self.allowed}" if self.allowed else text


class _Missing:
    def __repr__(self) -> str:
        return "(nothing)"


MISSING = _Missing()


class AnyFault(Protocol):
    """A wrong entry, which ``str()`` describes in one line; ``path`` says where it is."""

    @property
    def path(self) -> str:
        """Where the entry is in its file."""


class KindynaError(Exception):
    """Base of all errors for the user; ``str()`` gives one line per fault.

    Attributes
    ----------
    faults : wrong entries of a design, each with its ``path`` and, by ``str()``, its sentence; empty for another error

    Examples
    --------
    >>> import kindyna as kd
    >>> try:
    ...     kd.example("transfer_lift").edit({"cam.base_radius_mm": -1.0, "follower.rod_mm": 0.0})
    ... except kd.KindynaError as error:
    ...     print(sorted(fault.path for fault in error.faults))
    ['cam.base_radius_mm', 'follower.rod_mm']
    """

    faults: tuple[AnyFault, ...] = ()


class DesignError(KindynaError):
    """The design has wrong values; ``faults`` lists all of them."""

    faults: tuple[Fault, ...]

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__("\n".join(str(f) for f in self.faults))


class FileError(KindynaError):
    """A file or folder cannot be read or written."""


class NoSuchStage(KindynaError):
    """The kind of design has no stage of that name."""

    def __init__(self, stage: str, stages: Sequence[str]) -> None:
        self.stage = stage
        super().__init__(f"stage {stage!r}: this kind of design has none of that name; allowed: {', '.join(stages)}")


class NoSolution(KindynaError):
    """The mechanism has no position, cam or force at some cam angles.

    Attributes
    ----------
    field : path of the length that most likely remedies it
    cam_angles : ranges (from, to) [deg], a single angle is (a, a); empty where it fails at all angles
    exact : whether the ranges are independent of the sampling
    code : the reason in tables of many designs
    """

    angle, code, exact = "cam angle", "no-answer", False

    def __init__(self, problem: str, field: str, hint: str, cam_angles: Sequence[tuple[float, float]] = ()) -> None:
        self.problem, self.field, self.hint = problem, field, hint
        self.cam_angles = tuple(cam_angles)
        where = f" at {self.angle} {angle_list(cam_angles)}" if cam_angles else ""
        super().__init__(f"{field}: {problem}{where}; {hint}")

    @classmethod
    def raise_where(cls, failed: Any, error: Callable[[], NoSolution]) -> None:
        """Raise the error where the computation failed; inside of `collecting_failures` report it instead.

        Parameters
        ----------
        failed : bool or ndarray (n,), dimensionless
            Whether the computation failed, at each position.
        error : callable
            Builds the error, an instance of this class.
        """
        report = _REPORT.get()
        if report is not None:
            report(cls.code, failed)
        elif failed.any() if isinstance(failed, np.ndarray) else failed:
            raise error()


_REPORT: ContextVar[Callable[[str, Any], None] | None] = ContextVar("report", default=None)


@contextmanager
def collecting_failures(report: Callable[[str, Any], None]) -> Iterator[None]:
    """Report failures inside the block by their code and their mask, instead of raising NoSolution."""
    token = _REPORT.set(report)
    try:
        yield
    finally:
        _REPORT.reset(token)


class NoAssembly(NoSolution):
    """The linkage cannot be assembled at these cam angles."""

    code = "no-assembly"


class NoPosition(NoAssembly):
    """The links cannot be assembled at these driver angles."""

    angle = "driver angle"


class NoCam(NoSolution):
    """No cam can drive the follower at these cam angles."""

    code = "no-cam"


class NoStability(NoSolution):
    """The stability of this shaft cannot be determined."""


class ResultPending(NoStability):
    """The result takes long to compute, and another thread computes it."""


def at_angles(error: NoSolution, cam_angles: Sequence[tuple[float, float]]) -> NoSolution:
    """Copy of the error with exact ranges of cam angles [deg]."""
    result = type(error)(error.problem, error.field, error.hint, cam_angles)
    result.exact = True
    return result


def angle_list(ranges: Sequence[tuple[float, float]], most: int = 4, unit: str = "deg") -> str:
    """Text for ranges of cam angles, or of another quantity: ``35...76.5, 283.5...325 deg``."""
    texts = ["...".join(dict.fromkeys(distinct_texts(ends))) for ends in ranges[:most]]
    more = len(ranges) - most
    return ", ".join(texts) + (f" and {more} more ranges" if more > 0 else "") + f" {unit}"


def angle_ranges(theta: np.ndarray, mask: np.ndarray) -> list[tuple[float, float]]:
    """Ranges of cam angles over which a condition holds.

    Parameters
    ----------
    theta : ndarray (n,) [rad]
        Cam angles, ascending.
    mask : ndarray (n,), dimensionless
        Whether the condition holds.

    Returns
    -------
    list of (float, float) [deg]
        First and last angle of each run of True.
    """
    indices = np.flatnonzero(mask)
    if indices.size == 0:
        return []
    breaks = np.flatnonzero(np.diff(indices) > 1)
    first = indices[np.concatenate(([0], breaks + 1))]
    last = indices[np.concatenate((breaks, [indices.size - 1]))]
    degrees = np.rad2deg(theta)
    return [(float(degrees[a]), float(degrees[b])) for a, b in zip(first, last, strict=True)]
