"""The application object that Qt wants before anything is drawn, with or without a window."""

from __future__ import annotations

import os
import sys

from PySide6.QtGui import QFontDatabase
from PySide6.QtWidgets import QApplication

from kindyna_gui.gc_timer import tidy_in_this_thread
from kindyna_gui.pictures.overrides import let_errors_through
from kindyna_gui.pictures.style import font


def ensure_app(offscreen: bool = False) -> QApplication:
    """The one application; made now where there is none yet.

    offscreen: draw without any display, so that pictures are the same on every machine. Without a display on Linux
    this is so anyway.
    """
    existing = QApplication.instance()
    if isinstance(existing, QApplication):
        return existing
    displays = ("DISPLAY", "WAYLAND_DISPLAY")
    if offscreen or (sys.platform.startswith("linux") and not any(os.environ.get(name) for name in displays)):
        os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    app = QApplication([sys.argv[0] or "kindyna"])
    tidy_in_this_thread(app)
    let_errors_through()
    app.setFont(font())
    if not QFontDatabase.families():
        print("no fonts on this machine, texts are missing in pictures: install fonts-dejavu-core", file=sys.stderr)
    return app
