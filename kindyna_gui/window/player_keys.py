"""The keys that move the cam, the same in every view that shows it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from PySide6.QtCore import Qt
from PySide6.QtGui import QKeyEvent

from kindyna_gui.window.player import Player

PLAY = Qt.Key.Key_Space
DIRECTIONS: Mapping[int, float] = MappingProxyType({Qt.Key.Key_Left: -1.0, Qt.Key.Key_Right: 1.0})
DEGREES: Mapping[Qt.KeyboardModifier, float] = MappingProxyType(
    {
        Qt.KeyboardModifier.NoModifier: 1.0,
        Qt.KeyboardModifier.ShiftModifier: 0.1,
        Qt.KeyboardModifier.ControlModifier: 10.0,
    }
)
"""Modifier -> degrees of a step by an arrow key."""

KEYS_HELP = "Space plays and pauses; Left and Right step by 1°, with Shift by 0.1°, with Ctrl by 10°"


def step_of(modifiers: Qt.KeyboardModifier) -> float:
    """Degrees of a step with these modifiers; 0 where they mean something else."""
    return DEGREES.get(modifiers & ~Qt.KeyboardModifier.KeypadModifier, 0.0)


def obey(player: Player, event: QKeyEvent) -> bool:
    """Do what a key asks of the player; False where it asks nothing of it."""
    step = step_of(event.modifiers())
    direction = DIRECTIONS.get(event.key(), 0.0)
    if event.key() == PLAY and step == 1.0:
        if not event.isAutoRepeat():
            player.play(not player.playing)
    elif direction and step:
        player.step(direction * step)
    else:
        return False
    event.accept()
    return True
