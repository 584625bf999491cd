"""Parts of a room that few commands need: imported when the first of their names is read."""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any


def late(room: str, *modules: str) -> Callable[[str], Any]:
    """``__getattr__`` of a room whose other modules offer names too, imported one after the other until one has the name. The
    room lists these names for readers and the type check where ``TYPE_CHECKING``. None may be that of a module."""

    def read(name: str) -> Any:
        if not name.startswith("__"):
            for module in modules:
                there = import_module(f"{room}.{module}")
                if hasattr(there, name):
                    setattr(sys.modules[room], name, found := getattr(there, name))
                    return found
        raise AttributeError(f"module {room!r} has no attribute {name!r}")

    return read
