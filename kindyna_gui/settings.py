"""Settings, preferences."""

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
from core.output.lines import shortest
from core.units import Unit, unit_kind

# -- units -----------------------------------------------------------------------------------------------

DIGITS = 10  # of a number that is shown in another unit than it is kept in


class _DisplayUnits(QObject):
    """changed: what is shown next is shown otherwise."""

    changed = Signal()


DISPLAY = _DisplayUnits()
_units: dict[str, str] = {}
_comma = False
_letters = 1.0
_kept: ContextVar[bool] = ContextVar("kept", default=False)


def choose(units: Mapping[str, str], comma: bool) -> None:
    """Show quantities of these kinds in these units, and numbers with a decimal comma; a unit that a kind lacks is left out."""
    global _comma
    known = {kind: symbol for kind, symbol in units.items() if symbol in unit_kind(symbol).sizes}
    if (known, comma) != (_units, _comma):
        _units.clear()
        _units.update(known)
        _comma = comma
        DISPLAY.changed.emit()


def is_default() -> bool:
    """Whether the window shows everything as files have it."""
    return not _units and not _comma and _letters == 1.0


@contextmanager
def in_file_units() -> Iterator[None]:
    """Inside, everything is shown as files have it: what is written leaves the window."""
    before = _kept.set(True)
    try:
        yield
    finally:
        _kept.reset(before)


def follows() -> bool:
    """Whether the preferences count here: what is computed beside the window may be a file."""
    return not _kept.get() and current_thread() is main_thread()


def symbol_of(symbol: str) -> str:
    """The unit that values in this one are shown in."""
    return _units.get(unit_kind(symbol).name, symbol) if _units and symbol and follows() else symbol


def size_of(symbol: str) -> float:
    """How many of a unit one of those is that it is shown in."""
    shown = symbol_of(symbol)
    sizes = unit_kind(symbol).sizes
    return 1.0 if shown == symbol else (sizes[shown] / sizes[symbol]).factor


def choose_font_scale(size: float) -> bool:
    """Draw letters so many times as large as usual; whether that is another size than before."""
    global _letters
    before, _letters = _letters, size
    return size != before


def sized(pixels: float) -> float:
    """So many pixels at the usual size of letters, at that of the window: of letters, and of the room that is kept for them."""
    return pixels * _letters if _letters != 1.0 and follows() else pixels


def point() -> str:
    """The decimal sign."""
    return "," if _comma and follows() else "."


def typed(text: str) -> str:
    """A typed number with a decimal point."""
    return text.replace(",", ".") if _comma else text


def number_text(value: float, unit: Unit) -> str:
    """A number as it is shown and typed: every digit of it, or those that count of one in another unit."""
    size = size_of(unit.symbol)
    text = shortest(value) if size == 1.0 else shortest(float(f"{value / size:.{DIGITS}g}"))
    return text.replace(".", point())


_NUMBER = r"[-\u2212]?\d+(?:[\u202f\u2009]\d{3})*(?:\.\d+)?(?:e[-+]?\d+)?"
_MEASURED = re.compile(rf"(?<![\w.])((?:{_NUMBER}\s?(?:\.\.\.|…|to)\s?)?{_NUMBER})\s?((?:1/)?[^\s\d,;:()]+)")


def in_units(text: str) -> str:
    """A sentence with the numbers in it, and their units, as they are shown: ``limit 30 mm`` -> ``limit 1.181 in``."""
    return _MEASURED.sub(_in_unit, text) if _units and follows() else text


def _in_unit(match: re.Match[str]) -> str:
    symbol = match[2].rstrip(".")
    shown, size = symbol_of(symbol), size_of(symbol)
    if shown == symbol:
        return match[0]
    numbers = re.sub(_NUMBER, lambda each: _scaled(each[0], size), match[1])
    return f"{numbers} {shown}{match[2][len(symbol) :]}"


def _scaled(text: str, size: float) -> str:
    plain = re.sub("[\u202f\u2009]", "", text).replace("\u2212", "-")
    figures = max(len(re.sub(r"\D", "", plain.partition("e")[0]).lstrip("0")), 4)
    scaled = shortest(float(f"{float(plain) / size:.{figures}g}"))
    return (scaled.replace("-", "\u2212") if "\u2212" in text else scaled).replace(".", point())


# -- kept ------------------------------------------------------------------------------------------------

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


def stored_value(kept: QSettings, key: str) -> Any:
    """What the settings hold under a key; None where that is nothing, or of a kind that cannot be read."""
    try:
        return kept.value(key)
    except Exception:  # the settings file may name any type of Qt's
        return None


def stored_text(kept: QSettings, key: str, usual: str = "", longest: int = LONGEST) -> str:
    """A text, or a number as text; the usual one where something else is there, or a text that is no name of anything."""
    value = stored_value(kept, key)
    text = str(value) if isinstance(value, str | int | float) else usual
    return text if len(text) <= longest and "\0" not in text else usual


def _word(kept: QSettings, key: str) -> Any:
    """One of its words as it is kept; the usual one where another stands there, of a newer version or broken."""
    found = str(stored_value(kept, key))
    return next((word for word in WORDS[key] if str(word) == found), WORDS[key][0])


def not_understood() -> list[str]:
    """What is kept and is none of the words of its key, of a newer version or broken: each with the word that is taken for it."""
    kept = QSettings("KINDYNA", "KINDYNA")
    return [
        f"{key} {stored_value(kept, key)!s:.40} (taken as {words[0]})"
        for key, words in WORDS.items()
        if kept.contains(key) and str(stored_value(kept, key)) not in map(str, words)
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
        *(stored_text(kept, TEXTS[name]) for name in ("author", "company", "logo")),
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
    choose(wanted.units, wanted.comma)
    for effect in (Qt.UIEffect.UI_AnimateMenu, Qt.UIEffect.UI_AnimateCombo, Qt.UIEffect.UI_AnimateTooltip):
        app.setEffectEnabled(effect, not wanted.still and app.isEffectEnabled(Qt.UIEffect.UI_General))


# -- settings --------------------------------------------------------------------------------------------

MOST_RECENT = 8


@frozen
class TaskLayout:
    """How a task was left: the docks, the pages in the middle and the one in front, whether docks of linkages are there, and of
    several drives."""

    state: QByteArray
    pages: tuple[str, ...]
    front: str
    links: bool
    several: bool = False


def _key(name: str) -> str:
    """A name without the signs that part the keys of settings."""
    return name.encode().hex()


class Settings:
    """A thin layer over QSettings."""

    VERSION = 6
    """Of the layouts, raised whenever docks come or go: those of another version are left alone, and not used."""

    def __init__(self) -> None:
        self._kept = QSettings("KINDYNA", "KINDYNA")

    def save_window(self, window: QMainWindow, task: str) -> None:
        """Keep place and size of the window, and the task that is in place."""
        self._kept.setValue("window/geometry", window.saveGeometry())
        self._kept.setValue("window/task", task)
        self._kept.sync()

    def restore_geometry(self, window: QMainWindow) -> bool:
        """False where nothing was kept; then nothing changes."""
        geometry = stored_value(self._kept, "window/geometry")
        return isinstance(geometry, QByteArray) and window.restoreGeometry(geometry)

    def written(self, name: str) -> str:
        """What a report's first page said the last time; empty where nothing."""
        return stored_text(self._kept, f"report/{name}")

    def write(self, name: str, text: str) -> None:
        """Keep it."""
        self._kept.setValue(f"report/{name}", text)

    @property
    def task(self) -> str:
        """The task of the last run; empty where there was none."""
        return stored_text(self._kept, "window/task")

    @property
    def named_layouts(self) -> list[str]:
        """The names under which the user keeps layouts, those of other versions too."""
        return self._texts("layouts/names")

    def _texts(self, key: str) -> list[str]:
        """A list of texts, of which Qt keeps one alone as a text; those that are none are left out."""
        kept = stored_value(self._kept, key)
        texts = [kept] if isinstance(kept, str) else kept if isinstance(kept, list) else []
        return [text for text in texts if isinstance(text, str) and text and len(text) <= LONGEST and "\0" not in text]

    def name_layout(self, name: str, task: str, layout: TaskLayout) -> None:
        """Keep the layout of a task under a name, in place of what was kept under it."""
        key = f"layouts/{_key(name)}"
        self._kept.setValue("layouts/names", sorted({*self.named_layouts, name}, key=str.casefold))
        self._kept.setValue(f"{key}/version", self.VERSION)
        self._kept.setValue(f"{key}/task", task)
        self._write_layout(key, layout)

    def forget_layout(self, name: str) -> None:
        self._kept.setValue("layouts/names", [each for each in self.named_layouts if each != name])
        self._kept.remove(f"layouts/{_key(name)}")

    def named_layout(self, name: str) -> tuple[str, TaskLayout]:
        """The task and its layout that are kept under a name. Raises ValueError, with the reason, where they cannot be used."""
        key = f"layouts/{_key(name)}"
        version, task = stored_text(self._kept, f"{key}/version"), stored_text(self._kept, f"{key}/task")
        if version != str(self.VERSION):
            newer = number_from_one(version, 10**9) > self.VERSION
            raise ValueError(
                "it is from a newer version of KINDYNA"
                if newer
                else "it is from an older version, which had other docks"
            )
        layout = self._read_layout(key)
        if layout is None:
            raise ValueError("it is damaged")
        return task, layout

    def save_layout(self, task: str, layout: TaskLayout) -> None:
        """Keep the layout of a task."""
        self._write_layout(f"layout{self.VERSION}/{task}", layout)

    def _write_layout(self, key: str, layout: TaskLayout) -> None:
        self._kept.setValue(f"{key}/docks", layout.state)
        self._kept.setValue(f"{key}/pages", " ".join((layout.front, *layout.pages)))
        self._kept.setValue(f"{key}/links", int(layout.links))
        self._kept.setValue(f"{key}/several", int(layout.several))

    def layout(self, task: str) -> TaskLayout | None:
        """The layout of a task; None where none of this version was kept."""
        return self._read_layout(f"layout{self.VERSION}/{task}")

    def _read_layout(self, key: str) -> TaskLayout | None:
        state, names = stored_value(self._kept, f"{key}/docks"), stored_text(self._kept, f"{key}/pages").split()
        if not isinstance(state, QByteArray) or not names:
            return None
        links, several = (stored_text(self._kept, f"{key}/{kind}") == "1" for kind in ("links", "several"))
        return TaskLayout(state, tuple(names[1:]), names[0], links, several)

    @property
    def graph(self) -> str:
        """The graph of the last run, as text; empty where there was none."""
        return stored_text(self._kept, "window/graph", longest=FIELD)

    @graph.setter
    def graph(self, text: str) -> None:
        self._kept.setValue("window/graph", text)

    @property
    def welcome(self) -> bool:
        """Whether the welcome page is shown where the program is started without a file."""
        return stored_text(self._kept, "window/welcome", "1") != "0"

    @welcome.setter
    def welcome(self, shown: bool) -> None:
        self._kept.setValue("window/welcome", "1" if shown else "0")

    @property
    def recent(self) -> list[Path]:
        """Files opened or saved, the latest first."""
        return [Path(name) for name in self._texts("files/recent")[:MOST_RECENT]]

    def add_recent(self, path: Path) -> None:
        """Put a file at the head of the recent ones; the next dialog begins in its folder."""
        path = path.absolute()
        self._set_recent([path, *(p for p in self.recent if p != path)])
        self._kept.setValue("files/folder", str(path.parent))

    def drop_recent(self, path: Path) -> None:
        self._set_recent([p for p in self.recent if p != path.absolute()])

    def clear_recent(self) -> None:
        self._set_recent([])

    def _set_recent(self, paths: list[Path]) -> None:
        self._kept.setValue("files/recent", [str(p) for p in paths[:MOST_RECENT]])

    @property
    def folder(self) -> Path:
        """Where the last file was."""
        folder = Path(stored_text(self._kept, "files/folder") or Path.home())
        return folder if folder.is_dir() else Path.home()

    @folder.setter
    def folder(self, folder: Path) -> None:
        self._kept.setValue("files/folder", str(folder))
