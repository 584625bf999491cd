"""What can go wrong: each error names the field or the cam angle, the value, the allowed range
and what to do. An exception means that no answer exists; limits that are merely exceeded are findings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

import numpy as np

from core.frozen import frozen


def _shown(value: Any) -> str:
    try:
        text = repr(value)
    except (RecursionError, ValueError):  # nested, or an integer, beyond what Python prints
        text = f"({type(value).__name__} too large to show)"
    return text if len(text) <= 60 else text[:57] + "..."


@frozen
class Fault:
    """One wrong entry of a design.

    path     where it stands, spelled as in the file: ``motion.segments[2].span_deg``
    value    what stands there (``MISSING`` where nothing does)
    problem  what is wrong with it
    allowed  what would be right
    """

    path: str
    value: Any
    problem: str
    allowed: str = ""

    def __str__(self) -> str:
        place = self.path if self.value is MISSING else f"{self.path} = {_shown(self.value)}"
        text = f"{place}: {self.problem}" if place else self.problem
        return f"{text}; allowed: {self.allowed}" if self.allowed else text


class _Missing:
    def __repr__(self) -> str:
        return "(nothing)"


MISSING = _Missing()


class KindynaError(Exception):
    """Base of all errors that are meant for the user; ``str()`` gives one clear line per fault."""


class DesignError(KindynaError):
    """The design holds wrong values; ``faults`` lists all of them."""

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__("\n".join(str(f) for f in self.faults))


class FileError(KindynaError):
    """A file or folder cannot be read or written."""


class NoSuchStage(KindynaError):
    """This kind of design has no such stage."""

    def __init__(self, stage: str, stages: Sequence[str]) -> None:
        self.stage = stage
        super().__init__(f"stage {stage!r}: this kind of design has none of that name; allowed: {', '.join(stages)}")


class NoAnswer(KindynaError):
    """The mechanism has no position, cam or force at some cam angles.

    field         path of the length most likely to mend it
    cam_angles    ranges (from, to) in degrees, a single angle being (a, a); empty where it fails everywhere
    exact         True where they do not depend on a sampling
    code          what it is called where many designs are computed at once
    """

    angle, code, exact = "cam angle", "no-answer", False

    def __init__(self, problem: str, field: str, hint: str, cam_angles: Sequence[tuple[float, float]] = ()) -> None:
        self.problem, self.field, self.hint = problem, field, hint
        self.cam_angles = tuple(cam_angles)
        where = f" at {self.angle} {angle_list(cam_angles)}" if cam_angles else ""
        super().__init__(f"{field}: {problem}{where}; {hint}")

    @classmethod
    def where(cls, lost: Any, error: Callable[[], NoAnswer]) -> None:
        """Raise the error, of this class, where anything is lost: a truth, or those of all positions (n,). While many designs are
        computed at once it is noted which of them are lost, and the others go on."""
        note = _NOTE.get()
        if note is not None:
            note(cls.code, lost)
        elif lost.any() if isinstance(lost, np.ndarray) else lost:
            raise error()


_NOTE: ContextVar[Callable[[str, Any], None] | None] = ContextVar("note", default=None)


@contextmanager
def noting(note: Callable[[str, Any], None]) -> Iterator[None]:
    """What has no answer inside is given to ``note`` by its code and where it is lost, and does not raise."""
    token = _NOTE.set(note)
    try:
        yield
    finally:
        _NOTE.reset(token)


class NoAssembly(NoAnswer):
    """The linkage cannot be put together at these cam angles."""

    code = "no-assembly"


class NoPosition(NoAssembly):
    """The links cannot be put together at these positions of the driver."""

    angle = "driver angle"


class NoCam(NoAnswer):
    """No cam can drive the follower at these cam angles."""

    code = "no-cam"


class NoStability(NoAnswer):
    """Nothing can be said of the stability of this shaft."""


class NotYet(NoStability):
    """It takes long, and is computed elsewhere first."""


def at_angles(error: NoAnswer, cam_angles: Sequence[tuple[float, float]]) -> NoAnswer:
    """The same error with its cam angles to the last digit."""
    found = type(error)(error.problem, error.field, error.hint, cam_angles)
    found.exact = True
    return found


def angle_list(ranges: Sequence[tuple[float, float]], most: int = 4, unit: str = "deg") -> str:
    """``35...76.5, 283.5...325 deg``: a short text for ranges of cam angles, or of another quantity in its unit."""
    texts = [f"{a:.6g}" if a == b else f"{a:.6g}...{b:.6g}" for a, b in ranges[:most]]
    more = len(ranges) - most
    return ", ".join(texts) + (f" and {more} more ranges" if more > 0 else "") + f" {unit}"


def angle_ranges(theta: np.ndarray, bad: np.ndarray) -> list[tuple[float, float]]:
    """Runs of True in ``bad`` (n,) as ranges of the cam angles ``theta`` (n,) [rad], given in degrees."""
    where = np.flatnonzero(bad)
    if where.size == 0:
        return []
    breaks = np.flatnonzero(np.diff(where) > 1)
    first = where[np.concatenate(([0], breaks + 1))]
    last = where[np.concatenate((breaks, [where.size - 1]))]
    degrees = np.rad2deg(theta)
    return [(float(degrees[a]), float(degrees[b])) for a, b in zip(first, last, strict=True)]
