"""The program as its users start it: with and without a display, headless, with wrong words, without Qt."""

import json
import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from mechanisms import LIFT, PUSHER

from core import __version__
from core.design import TranslatingLoads, with_drive
from core.process import resources
from core.project import save
from core.study import Study
from kindyna_gui import __main__ as entry
from kindyna_gui.display import missing_library, obstacle
from kindyna_gui.places import default_design, example, examples, help_text, icon_file

PICTURES = {"mechanism.png", "mechanism.svg", "motion.png", "cam.png", "forces.png"}
TABLES = {"profile.csv", "kinematics.csv", "dynamics.csv", "summary.json"}
NO_DISPLAY = ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM", "XDG_RUNTIME_DIR")


def run(*words: str, folder: Path, code: str | None = None, **environment: str) -> subprocess.CompletedProcess[str]:
    """The program in a process of its own, without a display unless one is named."""
    env = {name: value for name, value in os.environ.items() if name not in NO_DISPLAY} | environment
    start = ["-m", "kindyna_gui", *words] if code is None else ["-c", code, *words]
    return subprocess.run(
        [sys.executable, *start],
        cwd=folder,
        env=env,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        encoding="utf-8",
    )


@pytest.fixture
def lift(tmp_path: Path) -> Path:
    path = tmp_path / "lift.toml"
    save(LIFT, path)
    return path


# -- without a display ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def started(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, subprocess.CompletedProcess[str]]:
    """The program without a word and without a display, and the folder where it was started."""
    folder = tmp_path_factory.mktemp("started")
    homes = {name: str(tmp_path_factory.mktemp("home")) for name in ("HOME", "XDG_CONFIG_HOME", "XDG_STATE_HOME")}
    return folder, run(folder=folder, **homes)


def test_without_a_display_the_main_job_is_done(started: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    folder, done = started
    first, rest = done.stdout.split("\n", 1)
    assert "no display" in first
    assert "out/" in first
    assert rest.startswith("Transfer unit, lift drive\n====")
    assert done.stderr == ""
    assert done.returncode == 0
    made = {path.name for path in (folder / "out").iterdir()}
    assert made == PICTURES | TABLES | {"report.txt"}
    assert (folder / "out" / "report.txt").read_text(encoding="utf-8") == rest
    assert json.loads((folder / "out" / "summary.json").read_text(encoding="utf-8"))["kind"] == "cam"
    assert len((folder / "out" / "profile.csv").read_text("utf-8").splitlines()) == 3601


@pytest.mark.stress
def test_a_design_with_an_error_is_written_whole_and_answers_1(tmp_path: Path) -> None:
    """And a display that does not respond is none."""
    path = tmp_path / "pusher.toml"
    save(with_drive(replace(PUSHER, name="loose"), loads=TranslatingLoads(follower_mass_kg=1.5)), path)
    done = run(str(path), folder=tmp_path, DISPLAY=":9731")
    assert done.returncode == 1
    assert done.stdout.startswith("the display :9731 does not respond")
    assert "leaves the cam" in done.stdout
    assert {path.name for path in (tmp_path / "out").iterdir()} == PICTURES | TABLES | {"report.txt"}


@pytest.fixture
def without_display(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """This process, as if it had been started in the folder on a machine without a display."""
    for name in NO_DISPLAY:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.chdir(tmp_path)


@pytest.mark.usefixtures("without_display")
@pytest.mark.parametrize("text", [None, "format = 1\n", "format = 1\nname = 'x'\n[follower]\nkind = 'translating'\n"])
def test_a_bad_file_leaves_nothing_behind(text: str | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    if text is not None:
        (tmp_path / "bad.toml").write_text(text, encoding="utf-8")
    assert entry.main(["bad.toml"]) == 2
    assert capsys.readouterr().err.strip()
    assert not (tmp_path / "out").exists()


@pytest.mark.stress
@pytest.mark.usefixtures("without_display")
def test_a_place_that_cannot_be_written_leaves_nothing_behind(
    lift: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "out").write_text("a file stands here", "utf-8")
    assert entry.main([str(lift)]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert (tmp_path / "out").read_text("utf-8") == "a file stands here"


def test_a_reader_that_goes_away_is_no_fault(lift: Path, tmp_path: Path) -> None:
    env = {name: value for name, value in os.environ.items() if name not in NO_DISPLAY}
    process = subprocess.Popen(
        [sys.executable, "-m", "kindyna_gui", str(lift)],
        cwd=tmp_path,
        env=env,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.close()
    told = process.stderr.read().decode()
    process.stderr.close()
    assert process.wait(timeout=120) == 0
    assert told == ""


# -- headless ---------------------------------------------------------------------------------------------


@pytest.mark.stress
def test_headless_report_paints_pictures_which_are_the_same_with_and_without_a_display(
    started: tuple[Path, subprocess.CompletedProcess[str]], tmp_path: Path
) -> None:
    done = run("--headless", "report", str(default_design()), "--out", "two", folder=tmp_path, DISPLAY=":9731")
    assert (done.returncode, done.stderr) == (0, "")
    one, two = started[0] / "out", tmp_path / "two"
    assert {path.name for path in two.iterdir()} == PICTURES | {"report.txt", "summary.json"}
    assert (two / "mechanism.png").read_bytes().startswith(b"\x89PNG")
    for picture in PICTURES:
        assert (one / picture).read_bytes() == (two / picture).read_bytes()


WITHOUT_PICTURES = """
import sys
from core.study import evaluations
from kindyna_gui.__main__ import main

for words in (["export", "lift.toml", "--only", "motion"], ["check", "lift.toml"], ["report", "lift.toml"], ["--help"]):
    code = main(["--headless", *words])
    loaded = {name.split(".")[0] for name in sys.modules} & {"PySide6", "shiboken6", "pyqtgraph", "scipy", "PIL"}
    print("LOADED", words[0], code, sorted(loaded))
    if "motion" in words:
        assert set(evaluations) == {"motion"}, "nothing else is computed"
"""


def test_qt_is_imported_only_for_pictures(lift: Path, tmp_path: Path) -> None:
    done = run(folder=tmp_path, code=WITHOUT_PICTURES)
    told = [line for line in done.stdout.splitlines() if line.startswith("LOADED")]
    assert told == [f"LOADED {command} 0 []" for command in ("export", "check", "report", "--help")], done.stderr


def test_headless_exit_codes(lift: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for words in (["report", "missing.toml"], ["nonsense"], [], ["export", str(lift), "--only", "blend"]):
        assert entry.main(["--headless", *words]) == 2
        told = capsys.readouterr()
        assert len(told.err.splitlines()) == 1
        assert told.out == ""
    assert run("--headless", "nonsense", folder=tmp_path).returncode == 2


# -- words ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("words", [["a", "b"], ["--nonsense"], ["a.toml", "--headless", "check"], ["--head"]])
def test_wrong_words_are_told_in_one_line(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert entry.main(words) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
    assert err.startswith("kindyna: ")
    assert "--help" in err


def test_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert entry.main(["--help"]) == 0
    out = capsys.readouterr().out
    assert "kindyna [DESIGN]" in out
    assert "--headless" in out


@pytest.mark.parametrize("words", [["--version"], ["--headless", "--version"]])
def test_version(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert entry.main(words) == 0
    assert capsys.readouterr().out == f"kindyna {__version__}\n"


# -- without Qt -------------------------------------------------------------------------------------------

NO_QT = """
import sys
class Without:
    def find_spec(self, name, path=None, target=None):
        if name.startswith(("PySide6", "shiboken6", "pyqtgraph")):
            raise ImportError("libEGL.so.1: cannot open shared object file: No such file or directory")
sys.meta_path.insert(0, Without())
from kindyna_gui.__main__ import main
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.stress
def test_without_the_libraries_of_qt_report_and_tables_are_made(lift: Path, tmp_path: Path) -> None:
    done = run(str(lift), folder=tmp_path, code=NO_QT)
    assert done.returncode == 0
    (told,) = done.stderr.splitlines()
    assert told.startswith("pictures left out: libEGL.so.1")
    assert "libegl1" in told
    assert {path.name for path in (tmp_path / "out").iterdir()} == TABLES | {"report.txt"}


@pytest.mark.stress
def test_a_window_without_the_libraries_of_qt_is_replaced_by_the_report(lift: Path, tmp_path: Path) -> None:
    done = run(str(lift), folder=tmp_path, code=NO_QT, QT_QPA_PLATFORM="xcb")
    assert done.returncode == 0
    first = done.stdout.splitlines()[0]
    assert "libEGL.so.1" in first
    assert "libxcb-cursor0" in first


@pytest.mark.parametrize(
    ("system", "reason", "remedy"),
    [
        ("linux", "libEGL.so.1: cannot open shared object file", "on Debian: apt install libegl1"),
        ("win32", "DLL load failed while importing QtCore: The specified module could not be found.", "pip install"),
        ("darwin", "dlopen(QtCore.abi3.so, 0x0002): Library not loaded: libpyside6.dylib", "pip install"),
    ],
)
def test_a_library_that_cannot_be_loaded_is_named_with_its_remedy(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], system: str, reason: str, remedy: str
) -> None:
    def import_qt() -> None:
        raise ImportError(reason)

    monkeypatch.setattr(entry, "import_qt", import_qt)
    monkeypatch.setattr(sys, "platform", system)
    assert entry.paint(Study(LIFT, 36)) == {}
    assert capsys.readouterr().err.startswith(f"pictures left out: {reason}; {remedy}")


def test_a_mistake_of_our_own_is_not_taken_for_a_missing_library(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "kindyna_gui.pictures.film", None)
    with pytest.raises(ImportError):
        entry.paint(Study(LIFT, 36))


# -- displays ---------------------------------------------------------------------------------------------


@pytest.fixture
def wayland(tmp_path: Path) -> Iterator[Path]:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as server:
        server.bind(str(tmp_path / "wayland-0"))
        server.listen()
        yield tmp_path


@pytest.mark.posix("sockets with a path")
def test_what_counts_as_a_display(wayland: Path) -> None:
    assert obstacle({}, "linux").startswith("no display")
    assert obstacle({}, "darwin") == ""
    assert obstacle({"QT_QPA_PLATFORM": "offscreen"}, "linux") == ""
    assert obstacle({"WAYLAND_DISPLAY": "wayland-0", "XDG_RUNTIME_DIR": str(wayland)}, "linux") == ""
    assert obstacle({"WAYLAND_DISPLAY": "wayland-1", "XDG_RUNTIME_DIR": str(wayland)}, "linux") == (
        "the display wayland-1 does not respond"
    )
    for name in (":9731", "unix:9731.0", "localhost:9731.0", "nonsense", ":x", "::1"):
        assert obstacle({"DISPLAY": name}, "linux") == f"the display {name} does not respond"


def test_a_display_over_the_network_answers() -> None:
    with socket.socket() as server:
        for number in range(3700, 3760):
            try:
                server.bind(("127.0.0.1", 6000 + number))
                break
            except OSError:
                continue
        server.listen()
        assert obstacle({"DISPLAY": f"localhost:{number}.0"}, "linux") == ""


def test_the_plugin_of_qt_is_only_tried_for_x() -> None:
    assert missing_library({"QT_QPA_PLATFORM": "offscreen"}) == ""
    assert missing_library({"WAYLAND_DISPLAY": "wayland-0"}) == ""


# -- places -----------------------------------------------------------------------------------------------


def test_the_programs_own_files_are_found() -> None:
    assert default_design() == example("transfer_lift")
    assert default_design().is_file()
    assert (resources() / "examples") == default_design().parent
    assert default_design() in [path for _, path in examples()]
    assert icon_file("no such icon") == ""
    assert "missing" in help_text("no such page")
