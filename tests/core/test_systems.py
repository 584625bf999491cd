"""What differs between systems: the user's folders, what a pipe is encoded in, and the names that Windows keeps for itself."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from core.file_names import file_name
from core.process import user_folder

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "resources/examples/four_bar.toml"


@pytest.mark.parametrize(
    ("system", "settings", "cache", "state"),
    [
        ("linux", ".config/KINDYNA", ".cache/KINDYNA", ".local/state/kindyna"),
        ("win32", "AppData/Roaming/KINDYNA", "AppData/Local/KINDYNA/Cache", "AppData/Local/KINDYNA"),
        ("darwin", "Library/Preferences/KINDYNA", "Library/Caches/KINDYNA", "Library/Application Support/KINDYNA"),
    ],
)
@pytest.mark.parametrize("named", [True, False])
def test_the_users_folders_are_where_each_system_has_them(
    own_settings: Path, monkeypatch: pytest.MonkeyPatch, system: str, settings: str, cache: str, state: str, named: bool
) -> None:
    """The environment may name others, by a whole path; a part of one is ignored."""
    if not named:
        for variable in ("APPDATA", "LOCALAPPDATA"):
            monkeypatch.delenv(variable)
        for variable in ("XDG_CONFIG_HOME", "XDG_CACHE_HOME", "XDG_STATE_HOME"):
            monkeypatch.setenv(variable, "here")
    monkeypatch.setattr(sys, "platform", system)
    assert user_folder("settings") == own_settings / settings
    assert user_folder("cache") == own_settings / cache
    assert user_folder("state") == own_settings / state


def test_the_environment_names_another_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "a"))
    monkeypatch.setenv("APPDATA", str(tmp_path / "b"))
    for system, folder in (("linux", "a"), ("win32", "b")):
        monkeypatch.setattr(sys, "platform", system)
        assert user_folder("settings") == tmp_path / folder / "KINDYNA"


# A pipe is ASCII, as it is a code page on Windows, and the program is told the system once its modules are imported.
ON_A_SYSTEM = """
import sys
from core.__main__ import main
from core.commands import check
sys.platform = sys.argv.pop(1)
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.posix("an ASCII locale")
@pytest.mark.parametrize(
    ("system", "encoding", "shown"),
    [("win32", "", "캠 φ"), ("win32", "ascii", "? ?"), ("win32", "cp949", "캠 φ"), ("linux", "", "? ?")],
)
def test_a_pipe_of_windows_gets_utf8_unless_another_encoding_is_asked_for(
    tmp_path: Path, system: str, encoding: str, shown: str
) -> None:
    path = tmp_path / "a.toml"
    path.write_text(EXAMPLE.read_text("utf-8").replace("Four-bar", "캠 φ", 1), "utf-8")
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    environment |= {"LC_ALL": "POSIX", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "PYTHONPATH": str(ROOT)}
    environment |= {"PYTHONIOENCODING": encoding} if encoding else {}
    words = [sys.executable, "-c", ON_A_SYSTEM, system, "report", str(path)]
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.decode(encoding or "utf-8").splitlines()[0] == f"{shown}, crank-rocker"


@pytest.mark.parametrize("name", ["CON", "conin$", "CONOUT$", "lpt¹", "Com0"])
def test_a_device_of_windows_is_no_file_name(name: str) -> None:
    assert file_name(name) == f"{name}_"
    assert file_name(f"{name}.csv") == f"{name}_.csv"
