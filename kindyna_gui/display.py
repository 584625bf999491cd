"""Whether a window can be opened on this machine, checked before Qt is imported."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

PATIENCE = 2.0  # seconds for a display on another machine
X_PORT = 6000


def obstacle(environment: Mapping[str, str] | None = None, platform: str = sys.platform) -> str:
    """Return why no window can be opened, in a few words; empty where it may be possible.

    Qt ends the program where a display is named but does not respond, so this connects to the display first.
    """
    env = os.environ if environment is None else environment
    if env.get("QT_QPA_PLATFORM") or not platform.startswith("linux"):
        return ""
    if env.get("WAYLAND_DISPLAY") and _is_socket(str(Path(env.get("XDG_RUNTIME_DIR", ""), env["WAYLAND_DISPLAY"]))):
        return ""
    display = env.get("DISPLAY", "")
    if display:
        return "" if _is_x_display(display) else f"the display {display} does not respond"
    if env.get("WAYLAND_DISPLAY"):
        return f"the display {env['WAYLAND_DISPLAY']} does not respond"
    return "no display (neither DISPLAY nor WAYLAND_DISPLAY is set)"


def missing_library(environment: Mapping[str, str] | None = None, platform: str = sys.platform) -> str:
    """Return the library that is missing for a window on X, in the loader's words; empty where none is.

    Qt ends the program where it cannot load its X plugin. Raises ImportError without Qt.
    """
    env = os.environ if environment is None else environment
    if not platform.startswith("linux") or env.get("WAYLAND_DISPLAY") or env.get("QT_QPA_PLATFORM"):
        return ""
    from PySide6.QtCore import QLibraryInfo, QPluginLoader

    plugin = Path(QLibraryInfo.path(QLibraryInfo.LibraryPath.PluginsPath)) / "platforms" / "libqxcb.so"
    loader = QPluginLoader(str(plugin))
    if loader.load():
        return ""
    text = loader.errorString()
    return (text.partition(f"{plugin.name}: ")[2] or text).strip("()")


def _is_x_display(display: str) -> bool:
    """Whether an X display responds: ``:0``, ``unix:0``, ``host:0.0``."""
    host, _, rest = display.rpartition(":")
    number = rest.partition(".")[0]
    if not number.isdigit():
        return False
    if host in ("", "unix"):
        path = f"/tmp/.X11-unix/X{number}"
        return _is_socket(path) or _is_socket(f"\0{path}") or (not host and _is_port("localhost", int(number)))
    return _is_port(host.strip("[]"), int(number))


def _is_socket(path: str) -> bool:
    import socket

    if sys.platform != "win32":
        with suppress(OSError, ValueError), socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as link:
            link.settimeout(PATIENCE)
            link.connect(path)
            return True
    return False


def _is_port(host: str, number: int) -> bool:
    import socket

    try:
        socket.create_connection((host, X_PORT + number), PATIENCE).close()
    except (OSError, ValueError, OverflowError):
        return False
    return True
