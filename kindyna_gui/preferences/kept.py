"""What the user prefers: units and decimal sign on display, theme, letters, motion, paper, author, company, logo; kept in the settings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QSettings, Qt
from PySide6.QtWidgets import QApplication

from core.frozen import frozen
from kindyna_gui.preferences import units as units_shown

UNITS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "length": ("mm", "in"),
        "angle": ("°", "rad"),
        "velocity": ("mm/s", "in/s"),
        "acceleration": ("mm/s²", "in/s²"),
        "jerk": ("mm/s³", "in/s³"),
        "length by angle": ("mm/°", "in/°"),
        "length by angle²": ("mm/°²", "in/°²"),
        "angular velocity": ("rpm", "rad/s"),
        "force": ("N", "lbf"),
        "torque": ("N·m", "lbf·in"),
        "stiffness": ("N/mm", "lbf/in"),
        "stress": ("MPa", "psi"),
        "mass": ("kg", "lb"),
        "curvature": ("1/mm", "1/in"),
    }
)
"""Kind of unit -> that of the files, first, and what it can be shown in."""
INCH: Mapping[str, str] = MappingProxyType(
    {kind: units[1] for kind, units in UNITS.items() if kind not in ("angle", "angular velocity")}
)
THEMES: Mapping[str, str] = MappingProxyType({"light": "Light", "dark": "Dark", "system": "As the desktop"})
FONTS: Mapping[int, str] = MappingProxyType({100: "Usual", 110: "110 %", 125: "125 %", 150: "150 %"})
PAPERS = ("A4", "Letter")


@frozen
class Preferences:
    """units: kind -> unit on display, where not that of the files; comma: of decimals; font: %; still:
    nothing moves but what is played."""

    units: Mapping[str, str] = field(default_factory=dict)
    comma: bool = False
    theme: str = "light"
    font: int = 100
    still: bool = False
    paper: str = "A4"
    author: str = ""
    company: str = ""
    logo: str = ""


TEXTS: Mapping[str, str] = MappingProxyType(
    {"paper": "report/paper", "author": "report/author", "company": "report/company", "logo": "report/logo"}
)
"""Field -> key of the settings, which the dialog of the report reads too."""


WORDS: Mapping[str, Sequence[str | int]] = MappingProxyType(
    {
        **{f"units/{kind}": choices for kind, choices in UNITS.items()},
        "units/decimal": (".", ","),
        "look/theme": tuple(THEMES),
        "look/font": tuple(FONTS),
        "look/still": (0, 1),
        TEXTS["paper"]: PAPERS,
    }
)
"""Key of the settings -> what it may hold, the usual first."""


LONGEST = 4096
"""Characters of a text in the settings; the graph of the last run may have more."""


def kept_value(kept: QSettings, key: str) -> Any:
    """What the settings hold under a key; None where that is nothing, or of a kind that cannot be read."""
    try:
        return kept.value(key)
    except Exception:  # the settings file may name any type of Qt's
        return None


def kept_text(kept: QSettings, key: str, usual: str = "", longest: int = LONGEST) -> str:
    """A text, or a number as text; the usual one where something else is there, or a text that is no name of anything."""
    value = kept_value(kept, key)
    text = str(value) if isinstance(value, str | int | float) else usual
    return text if len(text) <= longest and "\0" not in text else usual


def _word(kept: QSettings, key: str) -> Any:
    """One of its words as it is kept; the usual one where another stands there, of a newer version or broken."""
    found = str(kept_value(kept, key))
    return next((word for word in WORDS[key] if str(word) == found), WORDS[key][0])


def not_understood() -> list[str]:
    """What is kept and is none of the words of its key, of a newer version or broken: each with the word that is taken for it."""
    kept = QSettings("KINDYNA", "KINDYNA")
    return [
        f"{key} {kept_value(kept, key)!s:.40} (taken as {words[0]})"
        for key, words in WORDS.items()
        if kept.contains(key) and str(kept_value(kept, key)) not in map(str, words)
    ]


def read() -> Preferences:
    """What is kept."""
    kept = QSettings("KINDYNA", "KINDYNA")
    units = {kind: _word(kept, f"units/{kind}") for kind in UNITS}
    return Preferences(
        MappingProxyType({kind: unit for kind, unit in units.items() if unit != UNITS[kind][0]}),
        _word(kept, "units/decimal") == ",",
        _word(kept, "look/theme"),
        _word(kept, "look/font"),
        _word(kept, "look/still") == 1,
        _word(kept, TEXTS["paper"]),
        *(kept_text(kept, TEXTS[name]) for name in ("author", "company", "logo")),
    )


def write(wanted: Preferences) -> None:
    """Keep it."""
    kept = QSettings("KINDYNA", "KINDYNA")
    for kind, choices in UNITS.items():
        kept.setValue(f"units/{kind}", wanted.units.get(kind, choices[0]))
    kept.setValue("units/decimal", "," if wanted.comma else ".")
    kept.setValue("look/theme", wanted.theme)
    kept.setValue("look/font", wanted.font)
    kept.setValue("look/still", int(wanted.still))
    for name, key in TEXTS.items():
        kept.setValue(key, getattr(wanted, name))
    kept.sync()


def apply(wanted: Preferences, app: QApplication) -> None:
    """Let the window follow: units and decimals, motion."""
    units_shown.choose(wanted.units, wanted.comma)
    for effect in (Qt.UIEffect.UI_AnimateMenu, Qt.UIEffect.UI_AnimateCombo, Qt.UIEffect.UI_AnimateTooltip):
        app.setEffectEnabled(effect, not wanted.still and app.isEffectEnabled(Qt.UIEffect.UI_General))


__all__ = ["FONTS", "INCH", "PAPERS", "THEMES", "UNITS", "Preferences", "apply", "read", "write"]
