"""core.project.files: whole or not at all, nothing left behind, one clear line."""

import contextlib
import errno
import itertools
import os
import shutil
import socket
import stat
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

import pytest
from sampled import spread

from core.errors import FileError, KindynaError
from core.project import files

posix = pytest.mark.posix("links, permissions, pipes or signals")


def content(folder: Path) -> dict[str, bytes | None]:
    """Everything below a folder: name -> bytes, None for a folder."""
    return {
        str(path.relative_to(folder)): path.read_bytes() if path.is_file() else None
        for path in sorted(folder.rglob("*"))
    }


def refusal(call: Callable[..., Any], *arguments: Any) -> str:
    with pytest.raises(FileError) as caught:
        call(*arguments)
    line = str(caught.value)
    assert len(line.splitlines()) == 1
    assert line.isprintable()
    return line


@contextmanager
def as_ordinary_user() -> Iterator[None]:
    """Root may do anything: be nobody for a while."""
    if os.geteuid() != 0:
        yield
        return
    os.seteuid(65534)
    try:
        yield
    finally:
        os.seteuid(0)


@pytest.fixture
def open_folder() -> Iterator[Path]:
    """A folder that other users reach too, which they do not reach tmp_path."""
    folder = Path(tempfile.mkdtemp())
    folder.chmod(0o755)
    yield folder
    shutil.rmtree(folder)


@pytest.fixture
def tiny_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 64 kB."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(folder)]
    try:
        mounted = subprocess.run(mount, capture_output=True).returncode == 0
    except OSError:
        mounted = False
    if not mounted:
        pytest.skip("may not mount a disk here")
    yield folder
    subprocess.run(["umount", "-l", str(folder)], check=True)


# -- reading ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("data", "text"),
    [
        (b"", ""),
        ("φ = 35°, 캠\n".encode(), "φ = 35°, 캠\n"),
        (b"\xef\xbb\xbfname", "name"),
        (b"a\r\nb\rc\n", "a\r\nb\rc\n"),
        (b"\x00", "\x00"),
    ],
)
def test_reads_utf8(tmp_path: Path, data: bytes, text: str) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(data)
    assert files.read_text(path) == text
    assert files.read_text(str(path)) == text


def test_reads_up_to_the_limit(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(b"x" * 100)
    assert len(files.read_text(path, 100)) == 100
    assert "larger than" in refusal(files.read_text, path, 99)


def _missing(folder: Path) -> Path:
    return folder / "lift.toml"


def _folder(folder: Path) -> Path:
    return folder


def _below_a_file(folder: Path) -> Path:
    (folder / "file").touch()
    return folder / "file" / "lift.toml"


def _dangling(folder: Path) -> Path:
    (folder / "link").symlink_to("nowhere")
    return folder / "link"


def _circle(folder: Path) -> Path:
    (folder / "link").symlink_to("link")
    return folder / "link"


def _fifo(folder: Path) -> Path:
    os.mkfifo(folder / "fifo")
    return folder / "fifo"


def _socket(folder: Path) -> Path:
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(folder / "s"))
    return folder / "s"


def _huge(folder: Path) -> Path:
    with open(folder / "huge", "wb") as file:
        file.truncate(100_000_000)
    return folder / "huge"


def _utf16(folder: Path) -> Path:
    (folder / "a").write_text('name = "캠"', encoding="utf-16")
    return folder / "a"


def _latin1(folder: Path) -> Path:
    (folder / "a").write_bytes(b'name = "N\xe4he"')
    return folder / "a"


def _binary(folder: Path) -> Path:
    (folder / "a").write_bytes(bytes(range(256)) * 100)
    return folder / "a"


@posix
@pytest.mark.parametrize(
    ("place", "phrase"),
    [
        (_missing, "no such file"),
        (_folder, "a folder"),
        (_below_a_file, "there is a file instead of a folder"),
        (_dangling, "no such file"),
        (_circle, "circle"),
        (_fifo, "not an ordinary file"),
        (_socket, "not an ordinary file"),
        (lambda _: Path("/dev/zero"), "not an ordinary file"),
        (lambda _: Path("/dev/null"), "not an ordinary file"),
        (_huge, "larger than 64 MB"),
        (_utf16, "not UTF-8 text (byte 1)"),
        (_latin1, "not UTF-8 text (byte 10)"),
        (_binary, "not UTF-8 text"),
        (lambda folder: folder / ("x" * 300), "too long"),
        (lambda folder: folder / "a\0b", "no file name"),
        (lambda folder: folder / "a\nb", "no such file"),
        (lambda folder: folder / "\ud800", "UTF-8"),
    ],
)
def test_refuses_to_read(tmp_path: Path, place: Callable[[Path], Path], phrase: str) -> None:
    path = place(tmp_path)
    line = refusal(files.read_text, path)
    assert phrase in line
    assert "; " in line, "it says what to do"
    if str(path).isprintable():
        assert line.startswith(f"{path}: cannot be read: ")


@posix
def test_may_not_be_read(open_folder: Path) -> None:
    path = open_folder / "lift.toml"
    path.touch(mode=0o000)
    with as_ordinary_user():
        assert "permission denied" in refusal(files.read_text, path)


@pytest.mark.parametrize(
    ("number", "phrase"),
    [
        (errno.EACCES, "permission denied"),
        (errno.EIO, "does not respond"),
        (errno.ENOTCONN, os.strerror(errno.ENOTCONN)),
    ],
)
def test_every_failure_of_the_system_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int, phrase: str
) -> None:
    path = tmp_path / "lift.toml"
    path.touch()

    def fail(*_: Any) -> None:
        raise OSError(number, os.strerror(number), str(path))

    monkeypatch.setattr("builtins.open", fail)
    assert phrase in refusal(files.read_text, path)


def test_a_file_that_grows_is_not_read_beyond_the_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "log"
    path.write_bytes(b"x" * 100)
    before = os.stat(path)
    path.write_bytes(b"x" * 1000)
    monkeypatch.setattr(os, "stat", lambda *_, **__: before)
    assert "larger than" in refusal(files.read_text, path, 500)


# -- writing ----------------------------------------------------------------------------------------------

OLD: dict[str, bytes | None] = {"b.csv": b"old b", "c.csv": b"old c", "other": b"untouched"}
NEW: dict[str, bytes | str] = {"a.csv": "α\n", "b.csv": b"new b" * 1000, "c.csv": "", "d.csv": b"\x00\xff"}
WRITTEN = {name: data.encode() if isinstance(data, str) else data for name, data in NEW.items()}


def lay_out(folder: Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    for name, data in OLD.items():
        (folder / name).write_bytes(data or b"")


@pytest.fixture
def out(tmp_path: Path) -> Path:
    """A folder with two files that are to be replaced."""
    folder = tmp_path / "out"
    lay_out(folder)
    return folder


def test_writes_all(out: Path) -> None:
    files.write_all(out, NEW)
    assert content(out) == OLD | WRITTEN


def test_parts_are_written_as_they_come_and_a_part_that_fails_leaves_everything_as_it_was(out: Path) -> None:
    def parts(fails: bool) -> Iterator[bytes]:
        yield b"one\n"
        yield b""
        if fails:
            raise KindynaError("no third part")
        yield b"three\n"

    with pytest.raises(KindynaError, match="no third part"):
        files.write_all(out, {**NEW, "parts.csv": parts(True)})
    assert content(out) == OLD
    files.write_all(out, {"parts.csv": parts(False)})
    assert (out / "parts.csv").read_bytes() == b"one\nthree\n"


def test_creates_folders(tmp_path: Path) -> None:
    files.write_all(tmp_path / "x" / "y", {"a": "1", "sub/b": "2"})
    assert content(tmp_path) == {"x": None, "x/y": None, "x/y/a": b"1", "x/y/sub": None, "x/y/sub/b": b"2"}


def test_no_files(tmp_path: Path) -> None:
    files.write_all(tmp_path / "x", {})
    assert content(tmp_path) == {}


@pytest.mark.parametrize("data", [b"bytes\r\n", "text °\r\n", b"", b"x" * 3_000_000])
def test_writes_one(tmp_path: Path, data: bytes | str) -> None:
    path = tmp_path / ("n" * 250)  # no room for a longer name beside it
    files.write(path, "old")
    files.write(str(path), data)
    assert content(tmp_path) == {path.name: data.encode() if isinstance(data, str) else data}


def test_one_file_creates_no_folder(tmp_path: Path) -> None:
    assert "no such file or folder" in refusal(files.write, tmp_path / "x" / "a", "")
    assert content(tmp_path) == {}


@posix
@pytest.mark.parametrize("mode", [0o600, 0o644, 0o755, 0o640])
def test_keeps_permissions(tmp_path: Path, mode: int) -> None:
    path = tmp_path / "a"
    path.touch()
    path.chmod(mode)
    files.write(path, "new")
    files.write_all(tmp_path, {"a": "newer", "b": ""})
    assert stat.S_IMODE(path.stat().st_mode) == mode
    assert path.read_text("utf-8") == "newer"


@posix
def test_new_files_heed_the_umask(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        files.write(tmp_path / "a", "")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a").stat().st_mode) == 0o640


@posix
def test_follows_links(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "real" / "a").write_text("old", "utf-8")
    (tmp_path / "link").symlink_to("real/a")
    (tmp_path / "new").symlink_to("real/b")
    files.write(tmp_path / "link", "1")
    files.write(tmp_path / "new", "2")
    files.write_all(tmp_path, {"link": "3", "c": ""})
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "new").is_symlink()
    assert content(tmp_path / "real") == {"a": b"3", "b": b"2"}
    assert "circle" in refusal(files.write, _circle(tmp_path / "real"), "")


@posix
@pytest.mark.parametrize(
    ("place", "phrase"),
    [
        (_folder, "a folder"),
        (_below_a_file, "there is a file instead of a folder"),
        (_fifo, "not an ordinary file"),
        (lambda _: Path("/dev/null"), "not an ordinary file"),
        (lambda _: Path(""), "a folder"),
        (lambda folder: folder / ("x" * 300), "too long"),
        (lambda folder: folder / "a\0b", "no file name"),
        (lambda folder: folder / "\ud800", "UTF-8"),
        (lambda folder: folder / "x" / "a\nb", "no such file or folder"),
    ],
)
def test_refuses_to_write(tmp_path: Path, place: Callable[[Path], Path], phrase: str) -> None:
    path = place(tmp_path)
    before = sorted(os.listdir(tmp_path))
    line = refusal(files.write, path, "new")
    assert phrase in line
    assert "; " in line
    assert sorted(os.listdir(tmp_path)) == before


def test_text_that_utf8_cannot_hold(out: Path) -> None:
    assert "UTF-8" in refusal(files.write_all, out, {"b.csv": "new", "d.csv": "\ud800"})
    assert content(out) == OLD


@pytest.mark.parametrize("folder", ["b.csv", "b.csv/below", "b.csv/below/further"])
def test_a_file_where_the_folder_should_be(out: Path, folder: str) -> None:
    assert "there is a file instead of a folder" in refusal(files.write_all, out / folder, NEW)
    assert content(out) == OLD


def test_a_folder_where_a_file_should_be(out: Path) -> None:
    (out / "d.csv").mkdir()
    assert "d.csv: cannot be written: it is a folder" in refusal(files.write_all, out, NEW)
    assert content(out) == OLD | {"d.csv": None}


@posix
def test_write_protected(open_folder: Path) -> None:
    path = open_folder / "a"
    path.write_text("old", "utf-8")
    path.chmod(0o444)
    open_folder.chmod(0o777)
    with as_ordinary_user():
        assert "write-protected" in refusal(files.write, path, "new")
        assert "write-protected" in refusal(files.write_all, open_folder, {"b": "", "a": "new"})
    assert content(open_folder) == {"a": b"old"}


@posix
def test_folder_that_may_not_be_written(open_folder: Path) -> None:
    open_folder.chmod(0o555)
    with as_ordinary_user():
        assert "permission denied" in refusal(files.write, open_folder / "a", "new")
        assert "permission denied" in refusal(files.write_all, open_folder / "sub", NEW)
    assert content(open_folder) == {}


# -- trouble half-way -------------------------------------------------------------------------------------


def fail_at(monkeypatch: pytest.MonkeyPatch, name: str, number: int, error: BaseException) -> list[int]:
    """Let the n-th call of an os function fail."""
    right = getattr(os, name)
    calls = [0]

    def call(*arguments: Any, **options: Any) -> Any:
        calls[0] += 1
        if calls[0] == number:
            raise error
        return right(*arguments, **options)

    monkeypatch.setattr(os, name, call)
    return calls


@pytest.mark.parametrize("number", [1, 2, 3])
@pytest.mark.parametrize("name", ["open", "write", "fsync", "close", "replace"])
@pytest.mark.parametrize("folder", [".", "new/folder"])
@pytest.mark.parametrize("interrupted", [False, True])
def test_all_or_none(
    out: Path, monkeypatch: pytest.MonkeyPatch, name: str, number: int, folder: str, interrupted: bool
) -> None:
    full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    with monkeypatch.context() as trouble:
        calls = fail_at(trouble, name, number, KeyboardInterrupt() if interrupted else full)
        if interrupted:
            with pytest.raises(KeyboardInterrupt):
                files.write_all(out / folder, NEW)
        else:
            assert "the disk is full" in refusal(files.write_all, out / folder, NEW)
    assert calls[0] >= number
    assert content(out) == OLD


@pytest.mark.parametrize("name", ["open", "write", "fsync", "replace"])
def test_one_or_none(out: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    with monkeypatch.context() as trouble:
        fail_at(trouble, name, 1, OSError(errno.EDQUOT, "quota"))
        assert "your share of the disk is full" in refusal(files.write, out / "b.csv", "new")
    assert content(out) == OLD


def test_short_of_second_names(out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A disk without hard links: the old content is copied."""
    with monkeypatch.context() as trouble:
        fail_at(trouble, "link", 1, OSError(errno.EPERM, "no links"))
        fail_at(trouble, "replace", 3, OSError(errno.EIO, "gone"))
        assert "does not respond" in refusal(files.write_all, out, NEW)
    assert content(out) == OLD


def test_nothing_to_take_back_with(out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as trouble:
        fail_at(trouble, "link", 1, OSError(errno.EPERM, "no links"))
        full = OSError(errno.ENOSPC, "full")
        trouble.setattr(shutil, "copy2", lambda *_: (_ for _ in ()).throw(full))
        assert "the disk is full" in refusal(files.write_all, out, NEW)
    assert content(out) == OLD


def test_written_in_pieces(out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    right = os.write
    monkeypatch.setattr(os, "write", lambda handle, data: right(handle, data[:7]))
    files.write_all(out, NEW)
    assert content(out) == OLD | WRITTEN


def sweeping(frame: FrameType | None) -> bool:
    """Whether this is called at the end of a with statement."""
    while frame is not None and frame.f_code.co_filename != __file__:
        if frame.f_code.co_filename == contextlib.__file__ and frame.f_code.co_name == "__exit__":
            return True
        frame = frame.f_back
    return False


@pytest.mark.parametrize("folder", spread([".", "new/folder"], 1))
def test_interrupted_at_any_line(out: Path, folder: str) -> None:
    """Ctrl-C before any line of core.project.files that does not itself sweep up: all old or all new, nothing else."""
    below = {f"{folder}/{name}": data for name, data in WRITTEN.items()}
    all_new = OLD | (WRITTEN if folder == "." else {"new": None, folder: None} | below)
    for number in itertools.count(1):
        left = [number]

        def line(frame: FrameType, event: str, _: Any, left: list[int] = left) -> Any:
            if event == "call" and (frame.f_code.co_filename != files.__file__ or sweeping(frame)):
                return None
            if event == "line":
                left[0] -= 1
                if left[0] == 0:
                    raise KeyboardInterrupt
            return line

        before = sys.gettrace()
        sys.settrace(line)
        try:
            files.write_all(out / folder, NEW)
        except KeyboardInterrupt:
            pass
        finally:
            sys.settrace(before)
        if left[0] > 0:
            break
        assert content(out) in (OLD, all_new), f"line {number}"
        if content(out) != OLD:
            lay_out(out)
    assert number > 50


# -- what killed writes leave behind ------------------------------------------------------------------------

AT_THE_MOVE = """
import os, signal, sys
from core.project import files

def stop(*_):
    {stop}
    return right(*_)

right, os.replace = os.replace, stop
{call}
"""
WRITES = ("files.write('b.csv', 'of another')", "files.write_all('.', {'b.csv': 'of another', 'sub/c.csv': ''})")


def writing(folder: Path, call: str, stop: str) -> "subprocess.Popen[str]":
    """Another process that writes, stopped when it is about to move its first file into place."""
    code = AT_THE_MOVE.format(call=call, stop=stop)
    environment = os.environ | {"PYTHONPATH": str(Path(files.__file__).parents[1])}
    return subprocess.Popen(
        [sys.executable, "-c", code],
        cwd=folder,
        env=environment,
        text=True,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        encoding="utf-8",
    )


@posix
@pytest.mark.parametrize("call", spread(WRITES, 1))
def test_the_next_write_sweeps_up_what_a_killed_one_left(out: Path, call: str) -> None:
    (out / "sub").mkdir()
    (out / ".0123456789abcdef.tmp").write_text("of another program", "utf-8")
    before = content(out)
    writing(out, call, "os.kill(os.getpid(), signal.SIGKILL)").communicate()
    left = content(out).keys() - before.keys()
    assert left
    assert all(Path(name).name.startswith(".kindyna-") for name in left)
    files.write_all(out, {"b.csv": "new", "sub/d.csv": ""})
    assert content(out) == before | {"b.csv": b"new", "sub/d.csv": b""}


@posix
@pytest.mark.parametrize("call", spread(WRITES, 1))
def test_a_write_that_runs_is_not_swept_up(out: Path, call: str) -> None:
    (out / "sub").mkdir()
    other = writing(out, call, "print('here', flush=True); sys.stdin.readline()")
    assert other.stdout is not None
    assert other.stdout.readline() == "here\n"
    running = content(out).keys()
    files.write_all(out, {"b.csv": "new", "sub/d.csv": ""})
    assert content(out).keys() == running | {"sub/d.csv"}
    other.communicate("\n" * 9)
    assert other.returncode == 0
    assert (out / "b.csv").read_bytes() == b"of another", "what is written last stays"
    assert not [name for name in content(out) if name.endswith(".tmp")]


@posix
@pytest.mark.parametrize(
    "lock", ["none", "of the user", "empty", "a link", "a fifo", "a folder", "the mark of another"]
)
def test_files_of_the_user_that_are_named_like_leftovers_stay(out: Path, tmp_path: Path, lock: str) -> None:
    run = "0123456789abcdef"
    (tmp_path / "elsewhere").write_text(f"KINDYNA write {run}\n.kindyna-{run}-1.tmp", "utf-8")
    path = out / f".kindyna-{run}.tmp"
    if lock == "a link":
        path.symlink_to("../elsewhere")
    elif lock == "a fifo":
        os.mkfifo(path)
    elif lock == "a folder":
        path.mkdir()
    elif lock != "none":
        path.write_text(
            {"of the user": "mine", "empty": ""}.get(lock, "KINDYNA write 1\n") + f"\n.kindyna-{run}-1.tmp", "utf-8"
        )
    (out / f".kindyna-{run}-1.tmp").write_text("mine", "utf-8")
    (out / f".kindyna-{run}-2.tmp").symlink_to("c.csv")
    before = {name: data for name, data in content(tmp_path).items() if name != "out/b.csv"}
    files.write_all(out, {"b.csv": "new", "sub/d.csv": ""})
    after = content(tmp_path)
    assert {name: after.get(name) for name in before} == before
    assert path.is_symlink() == (lock == "a link")
    assert (out / f".kindyna-{run}-2.tmp").is_symlink()


@posix
def test_a_list_of_leftovers_takes_no_link_and_nothing_that_it_does_not_name(out: Path) -> None:
    run = "0123456789abcdef"
    lines = [f"KINDYNA write {run}", "b.csv", "../out/c.csv", *(f".kindyna-{run}-{n}.tmp" for n in (1, 2, 3))]
    (out / f".kindyna-{run}.tmp").write_text("\n".join(lines), "utf-8")
    (out / f".kindyna-{run}-1.tmp").write_text("left behind", "utf-8")
    (out / f".kindyna-{run}-2.tmp").symlink_to("c.csv")
    (out / f".kindyna-{run}-4.tmp").write_text("not listed", "utf-8")
    files.write(out / "a", "")
    assert sorted(path.name for path in out.iterdir()) == [
        f".kindyna-{run}-2.tmp", f".kindyna-{run}-4.tmp", "a", *OLD,
    ]  # fmt: skip


@posix
@pytest.mark.parametrize("what", ["file", "dangling", "folder", "outer folder"])
def test_names_that_the_program_chose_go_through_no_link(tmp_path: Path, what: str) -> None:
    out, mine = tmp_path / "out", tmp_path / "mine"
    out.mkdir()
    mine.mkdir()
    for name in ("a.csv", "notes"):
        (mine / name).write_text("mine", "utf-8")
    link, target = {
        "file": ("a.csv", "../mine/notes"),
        "dangling": ("a.csv", "../mine/new"),
        "folder": ("sub", "../mine"),
        "outer folder": ("sub", ".."),
    }[what]
    (out / link).symlink_to(target)
    before = content(tmp_path)
    assert "it is a symbolic link, or behind one" in refusal(
        files.write_into, out, {"a.csv": "new", "sub/a.csv": "new", "b.csv": ""}
    )
    assert content(tmp_path) == before
    (tmp_path / "link").symlink_to("out")
    files.write_into(tmp_path / "link", {"b.csv": "new"})
    assert (out / "b.csv").read_text("utf-8") == "new", "the folder itself was typed"


@posix
def test_a_name_that_was_typed_is_followed_and_what_comes_beside_it_is_not(tmp_path: Path) -> None:
    (tmp_path / "typed.csv").symlink_to("real.csv")
    files.write_into(tmp_path, {"typed.csv": "1", "typed.csv.json": "2"}, typed="typed.csv")
    assert (tmp_path / "real.csv").read_text("utf-8") == "1"
    (tmp_path / "typed.csv.json").unlink()
    (tmp_path / "typed.csv.json").symlink_to("notes")
    assert "link" in refusal(
        lambda: files.write_into(tmp_path, {"typed.csv": "3", "typed.csv.json": "4"}, typed="typed.csv")
    )
    assert (tmp_path / "real.csv").read_text("utf-8") == "1"


@posix
def test_full_disk(tiny_disk: Path) -> None:
    (tiny_disk / "a").write_bytes(b"old")
    assert "the disk is full" in refusal(files.write, tiny_disk / "a", b"x" * 100_000)
    assert "the disk is full" in refusal(files.write_all, tiny_disk / "sub", {str(i): b"x" * 20_000 for i in range(9)})
    assert content(tiny_disk) == {"a": b"old"}
    files.write(tiny_disk / "a", b"x" * 10_000)


@posix
def test_read_only_disk(tiny_disk: Path) -> None:
    (tiny_disk / "a").write_bytes(b"old")
    subprocess.run(["mount", "-o", "remount,ro", str(tiny_disk)], check=True)
    assert "read-only" in refusal(files.write, tiny_disk / "b", b"new")
    assert "cannot be written" in refusal(files.write, tiny_disk / "a", b"new")
    assert "read-only" in refusal(files.write_all, tiny_disk / "sub", NEW)
    assert content(tiny_disk) == {"a": b"old"}
