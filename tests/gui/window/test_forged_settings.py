"""Settings that somebody, or another program, has written: whatever kind a value is of, the window opens as without it."""

from pathlib import Path
from random import Random

import pytest
from PySide6.QtWidgets import QApplication
from window_user import settle

from kindyna_gui import settings
from kindyna_gui.settings import Settings, settings_file
from kindyna_gui.window.main_window import open_window

KEYS = (
    *settings.WORDS, *settings.TEXTS.values(), "window/geometry", "window/task", "window/graph",
    "window/welcome", "files/recent", "files/folder",
    "layouts/names", "layouts/61/version", "layouts/61/task", "layouts/61/docks", f"layout{Settings.VERSION}/stroke/docks",
    f"layout{Settings.VERSION}/stroke/pages", f"layout{Settings.VERSION}/stroke/links",
)  # fmt: skip
_GRAPHS = (
    '"{\\"graph\\": [[[[]]], 7]}"',
    '"{\\"graph\\": {\\"curves\\": [7, {\\"key\\": \\"c1\\", \\"source\\": \\"a\\\\u0000b\\"}]}, \\"folder\\": [1], \\"part\\": 3}"',
)
VALUES = (
    "a, b, 7", "@ByteArray(\\0\\xff\\x1)", "@Variant(\\0\\0\\0\\x9\\0)", "@Size(1 2)", "@Rect(1 2 3 4)", "@Point(1 2)", "@Invalid()",
    "@String(x)", "@DateTime(\\0)", "-1", "99999999999999999999", "nan", "a\\0b", "{", *_GRAPHS, "x" * 50_000, ", ".join("ab" * 2000),
)  # fmt: skip


def _forge(value_of: dict[str, str]) -> None:
    """Write the settings' file by hand: a section for each part before the slash."""
    path = Path(settings_file().fileName())
    path.parent.mkdir(parents=True, exist_ok=True)
    sections: dict[str, list[str]] = {}
    for key, value in value_of.items():
        section, _, name = key.partition("/")
        sections.setdefault(section, []).append(f"{name.replace('/', chr(92))}={value}")
    path.write_text("".join(f"[{name}]\n" + "\n".join(lines) + "\n" for name, lines in sections.items()), "utf-8")
    settings_file().sync()


def _opens(app: QApplication) -> None:
    window = open_window(app)
    window.show()
    settle()
    assert window.isVisible()
    assert isinstance(Settings().folder, Path)
    assert isinstance(Settings().recent, list)
    assert isinstance(settings.read(), settings.Preferences)
    window.close()
    window.deleteLater()
    settle()


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.fuzz) for seed in range(1, 60))])
def test_settings_of_forged_kinds_are_as_none(app: QApplication, seed: int) -> None:
    rng = Random(seed)
    _forge({key: rng.choice(VALUES) for key in KEYS})
    _opens(app)


def test_preferences_of_forged_kinds_are_the_usual_ones(app: QApplication) -> None:
    for value in VALUES:
        _forge(dict.fromkeys((*settings.WORDS, "files/folder", "files/recent"), value))
        read = settings.read()
        assert (read.units, read.comma, read.theme, read.font) == ({}, False, "light", 100)
        assert Settings().folder == Path.home()
