"""What a random user chooses from: actions and how often, keys, texts for fields, questions of menus, sizes."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from PySide6.QtCore import Qt

WEIGHTS: Mapping[str, int] = MappingProxyType(
    {
        "menu": 14, "open_example": 6, "new_design": 2, "open_file": 3, "question": 6, "keys": 12, "field": 14, "button": 9, "table": 10,
        "mouse": 8, "drag": 5, "drag_join": 6, "drag_joint": 6, "wheel": 5, "undo_redo": 7, "resize": 2, "dock": 4, "play": 3,
        "view": 4, "task": 6, "curves": 6, "draw": 6, "empty_lines": 10, "lesson": 5, "study": 8, "variants": 5, "close_and_open": 1,
    }
)  # fmt: skip
"""Name of an action -> how often it is chosen."""

NUMBERS = ("0", "1", "12.5", "-3", "90", "360", "1e-9", "1e9", "-1e308", "1e400", "nan", "inf", "", "abc", "12,5", "1/3",
           "3 mm", "--", "0.1", "25", "40", "2000", "0x10", "1e", " 7 ")  # fmt: skip
NO, SHIFT, CTRL, ALT = (
    Qt.KeyboardModifier.NoModifier,
    Qt.KeyboardModifier.ShiftModifier,
    Qt.KeyboardModifier.ControlModifier,
    Qt.KeyboardModifier.AltModifier,
)
K = Qt.Key
KEYS = (
    *((key, NO) for key in (K.Key_Space, K.Key_Left, K.Key_Right, K.Key_Up, K.Key_Down, K.Key_PageUp, K.Key_PageDown, K.Key_Home,
                            K.Key_End, K.Key_Tab, K.Key_Return, K.Key_Escape, K.Key_Insert, K.Key_Delete, K.Key_Backspace,
                            K.Key_F1, K.Key_F2, K.Key_F5, K.Key_F6, K.Key_F7, K.Key_F8, K.Key_A, K.Key_5, K.Key_Minus)),
    *((key, CTRL) for key in (K.Key_Z, K.Key_Z, K.Key_Y, K.Key_A, K.Key_C, K.Key_V, K.Key_X, K.Key_I, K.Key_K, K.Key_D, K.Key_E,
                              K.Key_G, K.Key_T, K.Key_L, K.Key_M, K.Key_B, K.Key_O, K.Key_S, K.Key_0, K.Key_1, K.Key_2, K.Key_3,
                              K.Key_4, K.Key_5, K.Key_6, K.Key_Tab, K.Key_Home, K.Key_End, K.Key_PageDown)),
    *((key, CTRL | SHIFT) for key in (K.Key_Z, K.Key_D, K.Key_M, K.Key_S, K.Key_Tab)),
    *((key, SHIFT) for key in (K.Key_Tab, K.Key_Left, K.Key_Right, K.Key_Up, K.Key_Down)),
    *((key, ALT) for key in (K.Key_Left, K.Key_Right, K.Key_Up, K.Key_Down)),
)  # fmt: skip
ENDS = (K.Key_Return, K.Key_Return, K.Key_Tab, K.Key_Escape)
"""Keys that end what is typed into a line."""
DRAWING = (
    *((key, NO) for key in (*map(K, b"VPBBBLSGGTRWMFKC"), K.Key_Return, K.Key_Delete, K.Key_Escape)),
    *((key, CTRL) for key in map(K, b"DJWRACVZZY")),
    *((key, CTRL | SHIFT) for key in map(K, b"MJGL")),
    *((key, SHIFT) for key in (K.Key_S, K.Key_Return)),
)
"""Keys of the tools and deeds while a linkage is drawn."""
AREAS = (Qt.DockWidgetArea.LeftDockWidgetArea, Qt.DockWidgetArea.RightDockWidgetArea, Qt.DockWidgetArea.BottomDockWidgetArea,
         Qt.DockWidgetArea.TopDockWidgetArea)  # fmt: skip
QUESTIONS = (
    ("Make", "Blend..."),
    ("Make", "Blend..."),
    ("File", "Import measured motion..."),
    ("File", "Import measured motion..."),
    ("File", "Export", "Tables..."),
    ("File", "Export", "Report as text..."),
    ("File", "Report..."),
    ("File", "Export", "Animation..."),
    ("File", "New..."),
    ("File", "Import linkage..."),
    ("File", "Import controller table..."),
    ("File", "Add this design to a shaft..."),
    ("Edit", "Compare with another file..."),
    ("Edit", "Scale the design..."),
    ("Edit", "Preferences..."),
    ("Make", "Blend a sequence..."),
    ("Make", "Motion from a DXF curve..."),
    ("Make", "Segment from table..."),
    ("Make", "Motion from a design or file..."),
    ("Make", "Motion that follows from files..."),
    ("Compo", "Underlay..."),
    ("Compo", "Circuits..."),
    ("Compo", "Choose a mechanism..."),
    ("Compo", "Layout"),
    ("Compo", "Driver"),
    ("Compo", "Cam roller"),
    ("Stability", "Flexible shaft"),
    ("Graph", "Export picture"),
)
SIZES = ((1440, 900), (1280, 720), (1280, 800), (1024, 700), (800, 600), (1920, 1200))

__all__ = ["AREAS", "CTRL", "DRAWING", "ENDS", "KEYS", "NO", "NUMBERS", "QUESTIONS", "SHIFT", "SIZES", "WEIGHTS", "K"]
