"""Giving up a long computation: between its steps it looks at a flag, and ends where that is set.

Who computes calls ``checkpoint`` in the loops that may take long; who no longer wants the result sets the flag that was named to
``cancellable`` in the thread of the computation. Without one a checkpoint does nothing.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from threading import Event


class Cancelled(Exception):
    """The result is no longer wanted."""


_FLAG: ContextVar[Event | None] = ContextVar("flag", default=None)


@contextmanager
def cancellable(flag: Event) -> Iterator[None]:
    """What is computed inside, in this thread, raises Cancelled at its next checkpoint once the flag is set."""
    token = _FLAG.set(flag)
    try:
        yield
    finally:
        _FLAG.reset(token)


def checkpoint() -> None:
    """Raises Cancelled where the flag of the computation at hand is set."""
    flag = _FLAG.get()
    if flag is not None and flag.is_set():
        raise Cancelled


__all__ = ["Cancelled", "cancellable", "checkpoint"]
