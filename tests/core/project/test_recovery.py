"""core.project.recovery: unsaved work on the disk, and whose process is dead."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from core.errors import FileError
from core.project import dumps, load, loads, recovery
from core.project.recovery import RecoveryFile, Unsaved, find
from kindyna_gui.places import example

DESIGN = dumps(load(example("transfer_lift")))
DRAFT = {
    "unit": "mm",
    "motion": {"start_mm": 0.0, "segments": [{"law": "dwell", "span_deg": 12.5}]},
    "path": "캠 \x7f\n#",
}
WRITER = f"""
import sys
from pathlib import Path
from core.project.recovery import RecoveryFile, Unsaved
file = RecoveryFile(Path(sys.argv[1]))
file.write(Unsaved(sys.argv[2], Path("/a/b.toml"), {DRAFT!r}, 17.5, 2))
print("written", flush=True)
sys.stdin.readline()
file.close()
"""


@pytest.fixture
def writer(tmp_path: Path) -> Iterator["subprocess.Popen[str]"]:
    """A process that has unsaved work; a line ends it."""
    environment = os.environ | {"PYTHONPATH": str(Path(recovery.__file__).parents[1])}
    process = subprocess.Popen(
        [sys.executable, "-c", WRITER, str(tmp_path), DESIGN],
        env=environment,
        text=True,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        encoding="utf-8",
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "written\n"
    yield process
    process.kill()
    process.communicate()


def test_a_living_process_keeps_its_work(tmp_path: Path, writer: "subprocess.Popen[str]") -> None:
    assert find(tmp_path) == []
    writer.communicate("\n")
    assert list(tmp_path.iterdir()) == [], "closed in order: nothing stays"


@pytest.mark.posix("signals")
@pytest.mark.parametrize("by", ["SIGKILL", "SIGABRT"])
def test_the_work_of_a_dead_process_is_found_once(tmp_path: Path, writer: "subprocess.Popen[str]", by: str) -> None:
    writer.send_signal(signal.Signals[by])
    writer.wait()
    (found,) = find(tmp_path)
    assert found.unsaved == Unsaved(DESIGN, Path("/a/b.toml"), DRAFT, 17.5, 2)
    assert loads(found.file.read_text("utf-8")) == loads(DESIGN), "it can be opened as any design"
    assert find(tmp_path) == [], "it is being dealt with"
    found.release()
    (again,) = find(tmp_path)
    assert again.unsaved == found.unsaved
    again.discard()
    assert list(tmp_path.iterdir()) == []


def test_written_again_cleared_and_closed(tmp_path: Path) -> None:
    file = RecoveryFile(tmp_path / "state" / "recovery")
    assert list(tmp_path.iterdir()) == [], "nothing is unsaved yet"
    assert find(tmp_path / "state" / "recovery") == []
    for design in ("a = 1", "b = 2"):
        file.write(Unsaved(design, None))
    (path,) = (tmp_path / "state" / "recovery").glob("*.toml")
    assert path.read_text("utf-8").endswith("\nb = 2")
    file.clear()
    assert not path.exists()
    file.clear()
    file.write(Unsaved("c = 3", None))
    assert path.exists()
    file.close()
    assert list((tmp_path / "state" / "recovery").iterdir()) == []


def test_what_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    file = RecoveryFile(tmp_path / "file" / "recovery")
    with pytest.raises(FileError, match="cannot be written"):
        file.write(Unsaved("a = 1", None))
    (tmp_path / "file").unlink()
    file.write(Unsaved("a = 1", None))
    file.close()


def test_the_latest_comes_first_and_leftovers_go(tmp_path: Path) -> None:
    for number, time in enumerate((5.0, 9.0, 7.0)):
        file = RecoveryFile(tmp_path / "other")
        file.write(Unsaved(f"n = {number}", None, None, time))
        (path,) = (tmp_path / "other").glob("*.toml")
        path.rename(tmp_path / path.name)  # without a lock, as after a restart of the machine
        file.close()
    (tmp_path / "0.lock").touch()
    (tmp_path / ".kindyna-0123456789abcdef-1.tmp").touch()
    (tmp_path / "damaged.toml").write_text("name = 1", "utf-8")
    found = find(tmp_path)
    assert [each.unsaved.design for each in found] == ["n = 1", "n = 2", "n = 0", "name = 1"]
    for each in found:
        each.discard()
    assert [path.name for path in tmp_path.iterdir()] == ["other"]
