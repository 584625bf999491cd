"""Whether a window can be opened here. Nothing of Qt is imported before that is known."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path

PATIENCE = 2.0  # for a display on another machine, seconds
X_PORT = 6000


def obstacle(environment: Mapping[str, str] | None = None, platform: str = sys.platform) -> str:
    """Why no window can be opened, in a few words; empty where one can be tried.

    Qt ends the whole program where a display is named but does not answer, so the display is tried here first.
    """
    env = os.environ if environment is None else environment
    if env.get("QT_QPA_PLATFORM") or not platform.startswith("linux"):
        return ""
    if env.get("WAYLAND_DISPLAY") and _answers_wayland(env["WAYLAND_DISPLAY"], env.get("XDG_RUNTIME_DIR", "")):
        return ""
    display = env.get("DISPLAY", "")
    if display:
        return "" if _answers_x(display) else f"the display {display} does not answer"
    if env.get("WAYLAND_DISPLAY"):
        return f"the display {env['WAYLAND_DISPLAY']} does not answer"
    return "no display (neither DISPLAY nor WAYLAND_DISPLAY is set)"


def missing_library(environment: Mapping[str, str] | None = None) -> str:
    """The library that is missing to show a window on X, in the loader's words; empty where none is.

    Qt ends the whole program where it cannot load this plugin of its own. Raises ImportError without Qt.
    """
    env = os.environ if environment is None else environment
    if not sys.platform.startswith("linux") or env.get("WAYLAND_DISPLAY") or env.get("QT_QPA_PLATFORM"):
        return ""
    from PySide6.QtCore import QLibraryInfo, QPluginLoader

    plugin = Path(QLibraryInfo.path(QLibraryInfo.LibraryPath.PluginsPath)) / "platforms" / "libqxcb.so"
    loader = QPluginLoader(str(plugin))
    if loader.load():
        return ""
    text = loader.errorString()
    return (text.partition(f"{plugin.name}: ")[2] or text).strip("()")


def _answers_wayland(name: str, folder: str) -> bool:
    return _connects(str(Path(folder) / name))


def _answers_x(display: str) -> bool:
    """``:0``, ``unix:0``, ``host:0.0``."""
    host, _, rest = display.rpartition(":")
    number = rest.partition(".")[0]
    if not number.isdigit():
        return False
    if host in ("", "unix"):
        path = f"/tmp/.X11-unix/X{number}"
        return _connects(path) or _connects(f"\0{path}") or (not host and _reaches("localhost", int(number)))
    return _reaches(host.strip("[]"), int(number))


def _connects(path: str) -> bool:
    import socket

    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as link:
            link.settimeout(PATIENCE)
            link.connect(path)
    except (OSError, ValueError):
        return False
    return True


def _reaches(host: str, number: int) -> bool:
    import socket

    try:
        socket.create_connection((host, X_PORT + number), PATIENCE).close()
    except (OSError, ValueError, OverflowError):
        return False
    return True
