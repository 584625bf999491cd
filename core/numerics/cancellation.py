"""Giving up a long computation: between its steps it looks at a flag, and ends where that is set; and leaving it to another thread.

Who computes calls ``checkpoint`` in the loops that may take long; who no longer wants the result sets the flag that was named to
``cancellable`` in the thread of the computation. Without one a checkpoint does nothing. Who must not wait names to ``postponing``
who else computes; what may take long asks there by ``postpone``.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from threading import Event
from typing import Any

from core.errors import NotYet


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


Later = Callable[[Hashable, Callable[[], Any]], str]
"""Lets what a key names be computed elsewhere; what has become of that, empty where it is there by now."""
_LATER: ContextVar[Later | None] = ContextVar("later", default=None)


@contextmanager
def postponing(later: Later) -> Iterator[None]:
    """What takes long is not computed inside, in this thread, but raises NotYet."""
    token = _LATER.set(later)
    try:
        yield
    finally:
        _LATER.reset(token)


def postpone(what: str, key: Hashable, compute: Callable[[], Any], field: str) -> None:
    """Before something that may take long, and that ``compute`` keeps where it is found. Raises NotYet, which names a field, where
    this thread must not wait for it and it is not there yet."""
    later = _LATER.get()
    state = "" if later is None else later(key, compute)
    if state:
        raise NotYet(f"{what} {state}", field, "the button in the status line ends the search, or begins it anew")


__all__ = ["Cancelled", "Later", "cancellable", "checkpoint", "postpone", "postponing"]
