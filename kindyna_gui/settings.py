"""Units and numbers on display, the user's preferences, and what the window stores between runs.

Values are stored and computed in the units of files; only texts of the window use the units on display. Inside
``in_file_units``, and in other threads, texts have the units of files.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import field
from pathlib import Path
from threading import current_thread, main_thread
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QByteArray, QObject, QSettings, Qt, Signal
from PySide6.QtWidgets import QApplication, QMainWindow

from core.bounds import FIELD, number_from_one
from core.frozen import frozen
from core.number_text import MINUS, MOST_DIGITS, NARROW_SPACE, RESULT_DIGITS, result_text, shortest
from core.process import user_folder
from core.units import Unit, unit_kind

DIGITS = 10  # of a number in another unit than that of files
TYPED_DIGITS = 8  # most digits of such a number that was typed in this unit; one with more was converted


class _DisplayUnits(QObject):
    """Signals ``changed`` when units, decimal sign or font size on display change."""

    changed = Signal()


DISPLAY = _DisplayUnits()
_units: dict[str, str] = {}
_comma = False
_font_scale = 1.0
_in_files: ContextVar[bool] = ContextVar("in_files", default=False)


def choose(units: Mapping[str, str], comma: bool) -> None:
    """Set the units of kinds of quantities, and the decimal sign; units that a kind does not have are left out."""
    global _comma
    known = {kind: symbol for kind, symbol in units.items() if symbol in unit_kind(symbol).sizes}
    if (known, comma) != (_units, _comma):
        _units.clear()
        _units.update(known)
        _comma = comma
        DISPLAY.changed.emit()


def is_default() -> bool:
    """Whether the window shows everything as files do."""
    return not _units and not _comma and _font_scale == 1.0


@contextmanager
def in_file_units() -> Iterator[None]:
    """Use the units of files inside the context, for texts and images that leave the window."""
    before = _in_files.set(True)
    try:
        yield
    finally:
        _in_files.reset(before)


def uses_preferences() -> bool:
    """Whether the preferences apply here: not in ``in_file_units``, and not in a worker, which may write a file."""
    return not _in_files.get() and current_thread() is main_thread()


def symbol_of(symbol: str) -> str:
    """Return the unit on display for values in a unit of files."""
    return _units.get(unit_kind(symbol).name, symbol) if _units and symbol and uses_preferences() else symbol


def size_of(symbol: str) -> float:
    """Return the size of the unit on display, in a unit of files."""
    shown = symbol_of(symbol)
    sizes = unit_kind(symbol).sizes
    return 1.0 if shown == symbol else (sizes[shown] / sizes[symbol]).factor


def choose_font_scale(scale: float) -> bool:
    """Set the scale of the font, and return whether it changes."""
    global _font_scale
    before, _font_scale = _font_scale, scale
    return scale != before


def sized(pixels: float) -> float:
    """Return a size in pixels of letters, or of the room for them, at the font scale of the window."""
    return pixels * _font_scale if _font_scale != 1.0 and uses_preferences() else pixels


def point() -> str:
    """Return the decimal sign."""
    return "," if _comma and uses_preferences() else "."


def typed(text: str) -> str:
    """Return a typed number with a decimal point."""
    return text.replace(",", ".") if _comma else text


def number_text(value: float, unit: Unit) -> str:
    """Return a number as it was typed, with all digits; six where it was converted to another unit."""
    size = size_of(unit.symbol)
    text = shortest(value if size == 1.0 else float(f"{value / size:.{DIGITS}g}"))
    if size != 1.0 and sum(map(str.isdigit, text.partition("e")[0].lstrip("-0."))) > TYPED_DIGITS:
        text = shortest(float(f"{value / size:.{MOST_DIGITS}g}"))
    return text.replace(".", point())


_NUMBER = rf"[-{MINUS}]?\d+(?:{NARROW_SPACE}\d{{3}})*(?:\.\d+)?(?:e[-+{MINUS}]?\d+)?"
_MEASURED = re.compile(rf"(?<![\w.])((?:{_NUMBER}\s?(?:\.\.\.|…|to)\s?)?{_NUMBER})\s?((?:1/)?[^\s\d,;:()]+)")


def in_units(text: str) -> str:
    """Return a sentence with its quantities in the units on display: ``limit 30 mm`` -> ``limit 1.181 in``."""
    return _MEASURED.sub(_in_unit, text) if _units and uses_preferences() else text


def _in_unit(match: re.Match[str]) -> str:
    symbol = match[2].rstrip(".")
    shown, size = symbol_of(symbol), size_of(symbol)
    if shown == symbol:
        return match[0]
    numbers = re.sub(_NUMBER, lambda number: _scaled(number[0], size), match[1])
    return f"{numbers} {shown}{match[2][len(symbol) :]}"


def _scaled(text: str, size: float) -> str:
    plain = text.replace(NARROW_SPACE, "").replace(MINUS, "-")
    figures = max(len(re.sub(r"\D", "", plain.partition("e")[0]).lstrip("0")), RESULT_DIGITS)
    return result_text(float(plain) / size, min(figures, MOST_DIGITS)).replace(".", point())


# -- preferences -----------------------------------------------------------------------------------------

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
        "torsional stiffness": ("N·m/rad", "lbf·in/rad"),
        "damping": ("N·s/mm", "lbf·s/in"),
        "torsional damping": ("N·m·s/rad", "lbf·in·s/rad"),
        "mass": ("kg", "lb"),
        "inertia": ("kg·m²", "lb·in²"),
        "curvature": ("1/mm", "1/in"),
    }
)
"""Kind of quantity -> its unit in files, then the units in which it can be shown."""
INCH: Mapping[str, str] = MappingProxyType(
    {kind: units[1] for kind, units in UNITS.items() if kind not in ("angle", "angular velocity")}
)
THEMES: Mapping[str, str] = MappingProxyType({"light": "Light", "dark": "Dark", "system": "As the desktop"})
FONTS: Mapping[int, str] = MappingProxyType({100: "Default", 110: "110 %", 125: "125 %", 150: "150 %"})
PAPERS = ("A4", "Letter")


@frozen
class Preferences:
    """The user's preferences.

    ``units`` maps kinds of quantities to units on display that differ from those of files; ``comma``: decimal comma;
    ``font``: font size [%]; ``still``: nothing moves except an animation.
    """

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
"""Key of the settings -> its possible values, the default first."""
LONGEST = 4096
"""Characters of a text in the settings; the graph of the last run may have more."""


def settings_file() -> QSettings:
    """Return the settings: a file on every system, not the registry of Windows, so that it can be copied and removed."""
    return QSettings(str(user_folder("settings") / "KINDYNA.conf"), QSettings.Format.IniFormat)


def stored_value(store: QSettings, key: str) -> Any:
    """Return the stored value of a key; None where there is none, or its type cannot be read."""
    try:
        return store.value(key)
    except Exception:  # the settings file may name any Qt type
        return None


def stored_text(store: QSettings, key: str, default: str = "", longest: int = LONGEST) -> str:
    """Return a stored text, or number as text; the default where the value is of another type, too long, or has a NUL."""
    value = stored_value(store, key)
    text = str(value) if isinstance(value, str | int | float) else default
    return text if len(text) <= longest and "\0" not in text else default


def _word(store: QSettings, key: str) -> Any:
    """Return the stored word of a key; the default where it is of a newer version or broken."""
    text = str(stored_value(store, key))
    return next((word for word in WORDS[key] if str(word) == text), WORDS[key][0])


def not_understood() -> list[str]:
    """Return the stored words that are not possible, of a newer version or broken, each with the word used instead."""
    store = settings_file()
    return [
        f"{key} {stored_value(store, key)!s:.40} (using {words[0]})"
        for key, words in WORDS.items()
        if store.contains(key) and str(stored_value(store, key)) not in map(str, words)
    ]


def read() -> Preferences:
    """Return the stored preferences."""
    store = settings_file()
    units = {kind: _word(store, f"units/{kind}") for kind in UNITS}
    return Preferences(
        MappingProxyType({kind: unit for kind, unit in units.items() if unit != UNITS[kind][0]}),
        _word(store, "units/decimal") == ",",
        _word(store, "look/theme"),
        _word(store, "look/font"),
        _word(store, "look/still") == 1,
        _word(store, TEXTS["paper"]),
        *(stored_text(store, TEXTS[name]) for name in ("author", "company", "logo")),
    )


def write(preferences: Preferences) -> None:
    """Store the preferences."""
    store = settings_file()
    for kind, choices in UNITS.items():
        store.setValue(f"units/{kind}", preferences.units.get(kind, choices[0]))
    store.setValue("units/decimal", "," if preferences.comma else ".")
    store.setValue("look/theme", preferences.theme)
    store.setValue("look/font", preferences.font)
    store.setValue("look/still", int(preferences.still))
    for name, key in TEXTS.items():
        store.setValue(key, getattr(preferences, name))
    store.sync()


def apply(preferences: Preferences, app: QApplication) -> None:
    """Apply the preferences to the window: units, decimal sign, animated menus."""
    choose(preferences.units, preferences.comma)
    for effect in (Qt.UIEffect.UI_AnimateMenu, Qt.UIEffect.UI_AnimateCombo, Qt.UIEffect.UI_AnimateTooltip):
        app.setEffectEnabled(effect, not preferences.still and app.isEffectEnabled(Qt.UIEffect.UI_General))


MOST_RECENT = 8  # recent files

# -- what the window stores between runs -----------------------------------------------------------------


@frozen
class TaskLayout:
    """The layout of a task: docks, central pages, the page in front, and which optional docks are shown.

    ``links`` and ``several`` say whether the docks of linkages and of several drives are shown, ``by_hand`` whether the user
    has arranged the docks.
    """

    state: QByteArray
    pages: tuple[str, ...]
    front: str
    links: bool
    several: bool = False
    by_hand: bool = True


def _key(name: str) -> str:
    """Return a name without the characters that separate keys of settings."""
    return name.encode().hex()


class Settings:
    """What the window stores between runs, in QSettings."""

    VERSION = 6
    """Version of layouts, raised with new or removed docks; layouts of other versions are ignored."""

    def __init__(self) -> None:
        self._store = settings_file()

    def save_window(self, window: QMainWindow, task: str) -> None:
        """Store position, size and current task of the window."""
        self._store.setValue("window/geometry", window.saveGeometry())
        self._store.setValue("window/task", task)
        self._store.sync()

    def restore_geometry(self, window: QMainWindow) -> bool:
        """Restore position and size of the window; False where none are stored."""
        geometry = stored_value(self._store, "window/geometry")
        return isinstance(geometry, QByteArray) and window.restoreGeometry(geometry)

    def written(self, name: str) -> str:
        """Return a text of the last report's first page; empty where there was none."""
        return stored_text(self._store, f"report/{name}")

    def write(self, name: str, text: str) -> None:
        """Store a text of a report's first page."""
        self._store.setValue(f"report/{name}", text)

    @property
    def task(self) -> str:
        """The task of the last run; empty where there was none."""
        return stored_text(self._store, "window/task")

    @property
    def named_layouts(self) -> list[str]:
        """Names of the user's layouts, including those of other versions."""
        return self._texts("layouts/names")

    def _texts(self, key: str) -> list[str]:
        """Return a list of texts, which Qt stores as a text where there is only one; other values are left out."""
        value = stored_value(self._store, key)
        texts = [value] if isinstance(value, str) else value if isinstance(value, list) else []
        return [text for text in texts if isinstance(text, str) and text and len(text) <= LONGEST and "\0" not in text]

    def name_layout(self, name: str, task: str, layout: TaskLayout) -> None:
        """Store the layout of a task under a name, and replace a layout of that name."""
        key = f"layouts/{_key(name)}"
        self._store.setValue("layouts/names", sorted({*self.named_layouts, name}, key=str.casefold))
        self._store.setValue(f"{key}/version", self.VERSION)
        self._store.setValue(f"{key}/task", task)
        self._write_layout(key, layout)

    def forget_layout(self, name: str) -> None:
        """Remove a named layout."""
        self._store.setValue("layouts/names", [other for other in self.named_layouts if other != name])
        self._store.remove(f"layouts/{_key(name)}")

    def named_layout(self, name: str) -> tuple[str, TaskLayout]:
        """Return the task and layout of a name. Raises ValueError with the reason where they cannot be used."""
        key = f"layouts/{_key(name)}"
        version, task = stored_text(self._store, f"{key}/version"), stored_text(self._store, f"{key}/task")
        if version != str(self.VERSION):
            newer = number_from_one(version, 10**9) > self.VERSION
            raise ValueError(
                "it is from a newer version of KINDYNA" if newer else "it is from an older version with other docks"
            )
        layout = self._read_layout(key)
        if layout is None:
            raise ValueError("it is damaged")
        return task, layout

    def save_layout(self, task: str, layout: TaskLayout) -> None:
        """Store the layout of a task."""
        self._write_layout(f"layout{self.VERSION}/{task}", layout)

    def _write_layout(self, key: str, layout: TaskLayout) -> None:
        self._store.setValue(f"{key}/docks", layout.state)
        self._store.setValue(f"{key}/pages", " ".join((layout.front, *layout.pages)))
        self._store.setValue(f"{key}/links", int(layout.links))
        self._store.setValue(f"{key}/several", int(layout.several))
        self._store.setValue(f"{key}/by_hand", int(layout.by_hand))

    def layout(self, task: str) -> TaskLayout | None:
        """Return the layout of a task; None where none of this version is stored."""
        return self._read_layout(f"layout{self.VERSION}/{task}")

    def _read_layout(self, key: str) -> TaskLayout | None:
        state, names = stored_value(self._store, f"{key}/docks"), stored_text(self._store, f"{key}/pages").split()
        if not isinstance(state, QByteArray) or not names:
            return None
        links, several = (stored_text(self._store, f"{key}/{kind}") == "1" for kind in ("links", "several"))
        by_hand = stored_text(self._store, f"{key}/by_hand", "1") != "0"
        return TaskLayout(state, tuple(names[1:]), names[0], links, several, by_hand)

    @property
    def graph(self) -> str:
        """The graph of the last run, as text; empty where there was none."""
        return stored_text(self._store, "window/graph", longest=FIELD)

    @graph.setter
    def graph(self, text: str) -> None:
        self._store.setValue("window/graph", text)

    @property
    def welcome(self) -> bool:
        """Whether the welcome page is shown where the program is started without a file."""
        return stored_text(self._store, "window/welcome", "1") != "0"

    @welcome.setter
    def welcome(self, shown: bool) -> None:
        self._store.setValue("window/welcome", "1" if shown else "0")

    @property
    def as_in_paper(self) -> bool:
        """Whether the stability is shown by η and Q, with the verdicts of all models."""
        return stored_text(self._store, "stability/as_in_paper") == "1"

    @as_in_paper.setter
    def as_in_paper(self, shown: bool) -> None:
        self._store.setValue("stability/as_in_paper", "1" if shown else "0")

    @property
    def exact(self) -> bool:
        """Whether results of searches are taken over with all their digits."""
        return stored_text(self._store, "find/exact", "0") == "1"

    @exact.setter
    def exact(self, on: bool) -> None:
        self._store.setValue("find/exact", "1" if on else "0")

    @property
    def recent(self) -> list[Path]:
        """Files opened or saved, the latest first."""
        return [Path(name) for name in self._texts("files/recent")[:MOST_RECENT]]

    def add_recent(self, path: Path) -> None:
        """Make a file the first of the recent ones, and its folder that of the next dialog."""
        path = path.absolute()
        self._set_recent([path, *(p for p in self.recent if p != path)])
        self._store.setValue("files/folder", str(path.parent))

    def drop_recent(self, path: Path) -> None:
        """Remove a file from the recent ones."""
        self._set_recent([p for p in self.recent if p != path.absolute()])

    def clear_recent(self) -> None:
        """Remove all recent files."""
        self._set_recent([])

    def _set_recent(self, paths: list[Path]) -> None:
        self._store.setValue("files/recent", [str(p) for p in paths[:MOST_RECENT]])

    @property
    def folder(self) -> Path:
        """Folder of the last file."""
        folder = Path(stored_text(self._store, "files/folder") or Path.home())
        return folder if folder.is_dir() else Path.home()

    @folder.setter
    def folder(self, folder: Path) -> None:
        self._store.setValue("files/folder", str(folder))
