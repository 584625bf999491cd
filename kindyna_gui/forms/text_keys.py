"""Which keys a field that is typed into keeps for itself, and which go on as shortcuts.

Shortcuts of the window act everywhere. Those of a view (``Qt.WidgetWithChildrenShortcut``) act in it, but not while a
text inside it is being edited: Ctrl+D typed into the start of the motion deletes no segment. Keys that edit text are the
field's own.
"""

from __future__ import annotations

from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QKeyEvent, QKeySequence
from PySide6.QtWidgets import QWidget

Keys = QKeySequence.StandardKey
EDITING = (Keys.SelectAll, Keys.Copy, Keys.Cut, Keys.Paste, Keys.Undo, Keys.Redo)
_CTRL = Qt.KeyboardModifier.ControlModifier
_VIEW = Qt.ShortcutContext.WidgetWithChildrenShortcut


class TextKeys:
    """For fields: a mixin before the class of Qt."""

    def event(self, event: QEvent) -> bool:
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent):
            assert isinstance(self, QWidget)
            if is_view_shortcut(self, event):
                event.accept()
                return True
            if is_window_shortcut(event):
                event.ignore()
                return False
        return bool(super().event(event))  # type: ignore[misc]


def is_view_shortcut(field: QWidget, event: QKeyEvent) -> bool:
    """Whether a key is a shortcut of a view around the field."""
    keys, at = QKeySequence(event.keyCombination()), field.parentWidget()
    while at is not None:
        if any(action.shortcutContext() == _VIEW and action.shortcut() == keys for action in at.actions()):
            return True
        at = None if at.isWindow() else at.parentWidget()
    return False


def is_window_shortcut(event: QKeyEvent) -> bool:
    """Whether a key may be a shortcut of the window: Ctrl and a letter or a digit that edits no text. A line of text
    would claim some of these too, on X11 Ctrl+E for its end."""
    letter = 0 <= event.key() < 0x80 and chr(event.key()).isalnum()
    return bool(event.modifiers() & _CTRL) and letter and not any(event.matches(key) for key in EDITING)


__all__ = ["TextKeys", "is_view_shortcut", "is_window_shortcut"]
