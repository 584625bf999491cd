"""What differs between systems: the user's folders, what a pipe is encoded in, and the names that Windows keeps for itself."""

import errno
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from core.file_names import file_name
from core.process import user_folder
from core.project import files, recovery

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


# -- files ------------------------------------------------------------------------------------------------

OPEN_FILES = Path("/proc/self/fd")


@pytest.fixture
def as_on_windows(monkeypatch: pytest.MonkeyPatch) -> None:
    """No open file is removed or moved, or replaced by another; locks are those of the module ``msvcrt``."""
    import fcntl

    def refused_where_open(call: Callable[..., None]) -> Callable[..., None]:
        def refusing(*paths: Any) -> None:
            opened = [os.stat(handle) for handle in OPEN_FILES.iterdir() if handle.exists()]
            for path in filter(os.path.lexists, paths):
                if any(os.path.samestat(os.lstat(path), status) for status in opened):
                    raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
            call(*paths)

        return refusing

    def locking(handle: int, mode: int, count: int) -> None:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES)) from error

    monkeypatch.setattr(os, "unlink", refused_where_open(os.unlink))
    monkeypatch.setattr(os, "replace", refused_where_open(os.replace))
    monkeypatch.setitem(sys.modules, "msvcrt", SimpleNamespace(LK_NBLCK=2, locking=locking))
    monkeypatch.setattr(sys, "platform", "win32")


windows = pytest.mark.skipif(not OPEN_FILES.exists(), reason="open files are listed by Linux alone")


@windows
@pytest.mark.usefixtures("as_on_windows")
def test_writing_on_windows_leaves_nothing_of_its_own_nor_of_a_killed_process(tmp_path: Path) -> None:
    run = "0123456789abcdef"
    (tmp_path / f".kindyna-{run}.tmp").write_text(f"KINDYNA write {run}\n.kindyna-{run}-1.tmp", "utf-8")
    (tmp_path / f".kindyna-{run}-1.tmp").write_text("half", "utf-8")
    (tmp_path / "a.csv").write_text("old", "utf-8")
    files.write_all(tmp_path, {"a.csv": "new", "b/c.csv": "c"})
    files.write(tmp_path / "a.csv", "newer")
    assert {path.name: path.read_text("utf-8") for path in tmp_path.rglob("*.*")} == {"a.csv": "newer", "c.csv": "c"}


@windows
@pytest.mark.usefixtures("as_on_windows")
def test_unsaved_work_on_windows_is_kept_while_needed_and_leaves_nothing(tmp_path: Path) -> None:
    living, text = recovery.RecoveryFile(tmp_path), EXAMPLE.read_text("utf-8")
    living.write(recovery.Unsaved(text, None))
    assert recovery.find(tmp_path) == [], "its process lives"
    (tmp_path / "00.toml").write_text(text, "utf-8")
    (found,) = recovery.find(tmp_path)
    assert recovery.find(tmp_path) == [], "it is being recovered"
    found.discard()
    living.close()
    assert list(tmp_path.iterdir()) == []
