"""Layers of the drawing that a task asks for: shown or hidden in each task as they were left there."""

from __future__ import annotations

from PySide6.QtGui import QAction

from kindyna_gui.window.base import Window
from kindyna_gui.window.tasks import TASKS

ASKED_FOR = sorted({layer for row in TASKS.values() for layer in row.layers})


class TaskLayers:
    """Of one window; at first as the rows of ``TASKS`` have it."""

    def __init__(self, window: Window) -> None:
        self._window = window
        self._left: dict[str, dict[str, bool]] = {}
        self._task = ""

    def show(self, task: str) -> None:
        """A task is in place."""
        mechanism = self._window.view("mechanism")
        assert mechanism is not None
        actions = {
            layer: action
            for layer in ASKED_FOR
            if (action := mechanism.findChild(QAction, f"layer:{layer}")) is not None
        }
        if self._task:
            self._left[self._task] = {layer: action.isChecked() for layer, action in actions.items()}
        for layer, action in actions.items():
            action.setChecked(self._left.get(task, {}).get(layer, layer in TASKS[task].layers))
        self._task = task


__all__ = ["TaskLayers"]
