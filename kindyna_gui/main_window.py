"""The window by the name under which scripts open it: ``open_window(app, path)``."""

from kindyna_gui.window.main_window import MainWindow, open_window

__all__ = ["MainWindow", "open_window"]
