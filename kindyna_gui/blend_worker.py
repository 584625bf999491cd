"""What the blend wizard computes beside the window, and may end at any moment."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from threading import Thread

from core.blend import Blended, Request, best
from kindyna_gui.background import Background, Job, Worker


@cache
def _loader() -> Thread:
    """Imports what ``best`` needs, in a thread that is never ended: a module must not be left half imported."""
    thread = Thread(target=lambda: [import_module(name) for name in ("numpy.random", "scipy.optimize")], daemon=True)
    thread.start()
    return thread


def best_answer(request: Request, goal: str) -> Blended:
    """``best``, for a thread that may be ended at any moment."""
    _loader().join()
    return best(request, goal)


__all__ = ["Background", "Job", "Worker", "best_answer"]
