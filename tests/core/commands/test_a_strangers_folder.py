"""A stranger's folder, full of files, links and names that look like the program's, after any sequence of commands: each byte that no
command was told to write is the same, and nothing is beside it."""

import io
import os
import re
import shutil
import time
import zipfile
from collections.abc import Callable, Iterator
from itertools import count
from pathlib import Path
from random import Random

import pytest
from folders import content

from core.__main__ import main as core
from core.process import resources
from kindyna_gui.__main__ import main

BUDGET_S = float(os.environ.get("KINDYNA_FUZZ_SECONDS", "600"))
CACHE = ".kindyna-studies"
STUDY = """design = "lift.toml"
[[vary]]
field = "cam.base_radius_mm"
values = [{radius}, 430.0]
[[quantities]]
quantity = "pressure_angle_deg"
of = "max"
"""
RUN = "0123456789abcdef"
LOOK_ALIKES = (
    "notes.txt", "summary.json", "contents.json", "report.txt", "kinematics.csv", "kindyna-run", "00000.npz", "lift.dxf.json",
    f".kindyna-{RUN}.tmp", f".kindyna-{RUN}-1.tmp", "0" * 24, f"{1:024}", "a.dxf", "a.dxf.json", "a.csv", "a.zip", "controller.txt",
    "design.toml", "lift.underlay.toml", "x", "con", "drive",
)  # fmt: skip
FOLDERS = ("", "out", "tables", "hand", CACHE, f"{CACHE}/{'a' * 24}", "sub/sub")
DATA = (b"mine\n", b"{}", b'{"files": []}', b"", b"KINDYNA\n")


def archive(name: str) -> bytes:
    """One of the stranger's, with a list of contents."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as file:
        file.writestr("contents.json", '{"files": []}')
        file.writestr(name, "mine")
    return made.getvalue()


class Stranger:
    """A folder, another that links lead to, and what is known of both."""

    def __init__(self, folder: Path, rng: Random) -> None:
        self.folder, self.rng = folder, rng
        self.project, self.elsewhere = folder / "project", folder / "elsewhere"
        for place in ("sub", "deep/er"):
            (self.elsewhere / place).mkdir(parents=True)
        for name in ("a.txt", "sub/00000.npz", "summary.json", "sub/kindyna-run"):
            (self.elsewhere / name).write_text("mine", "utf-8")
        self.project.mkdir()
        for name, example in (("lift", "transfer_lift"), ("four", "four_bar")):
            shutil.copy(resources() / "examples" / f"{example}.toml", self.project / f"{name}.toml")
        (self.project / "data.csv").write_text("angle_deg,x_mm\n0,1\n90,2\n180,4\n270,2\n", "utf-8")
        if rng.random() < 0.2:
            (self.project / CACHE).symlink_to("../elsewhere")
        for _ in range(40):
            self.put()
        self.written: set[str] = set()  # by the program, as it is

    def put(self) -> None:
        """Something of the stranger's, where nothing is yet."""
        rng = self.rng
        name = rng.choice([*LOOK_ALIKES, f"{rng.randrange(16**24):024x}"])
        path = self.project / rng.choice(FOLDERS) / name
        if os.path.lexists(path):
            return
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            kind = rng.randrange(6)
            if kind == 0:
                path.symlink_to(
                    rng.choice(["nowhere", *map(str, self.elsewhere.rglob("*")), str(self.project / "lift.toml")])
                )
            elif kind == 1:
                shutil.copytree(self.elsewhere / "sub", path)
            elif kind == 2:
                os.link(self.elsewhere / "a.txt", path)
            else:
                path.write_bytes(archive(name) if path.suffix == ".zip" else rng.choice(DATA))
        except (FileExistsError, NotADirectoryError):  # another thing of the stranger's is in its way
            return

    def change(self) -> None:
        """A file that the program has written becomes the stranger's."""
        files = [name for name in sorted(self.written) if not name.endswith(".npz") and (self.folder / name).is_file()]
        if files:
            name = self.rng.choice(files)
            (self.folder / name).write_text("changed by me", "utf-8")
            self.written.discard(name)

    def target(self, *endings: str) -> Path:
        """Where a command is told to write."""
        place = self.project / self.rng.choice(FOLDERS[:-2] if endings else FOLDERS[1:4])
        name = self.rng.choice(["a", "lift", "new", f"new{self.rng.randrange(99)}"])
        return place / f"{name}{self.rng.choice(endings)}" if endings else place


Told = tuple[list[str], Callable[[str, set[str]], bool]]
"""Words of a command, and whether it was told to write a name, of all that there were."""


def commands(at: Stranger) -> Iterator[Told]:
    """One after the other, chosen at random."""
    lift, four, rng = str(at.project / "lift.toml"), str(at.project / "four.toml"), at.rng

    def named(path: Path, *beside: str) -> Callable[[str, set[str]], bool]:
        typed = {os.path.relpath(each, at.folder) for each in (path, path.resolve())}
        others = {os.path.relpath(path.parent.resolve() / name, at.folder) for name in beside}
        return lambda name, before: name in typed or (name in others and (name in at.written or name not in before))

    def into(folder: Path, *replaced: str) -> Callable[[str, set[str]], bool]:
        """Files that were not there, that the program has written, or that it is said to replace: never through a link in it."""
        start = os.path.relpath(folder.resolve(), at.folder) + "/"

        def told(name: str, before: set[str]) -> bool:
            file = name.removeprefix(start)
            own = name not in before or name in at.written or (file in replaced and not (at.folder / name).is_symlink())
            return name == start[:-1] or (name.startswith(start) and own)

        return told

    def whole(path: Path) -> Callable[[str, set[str]], bool]:
        """A hand-over: nothing where anything of the stranger's is in it."""
        start = os.path.relpath(path, at.folder)
        inside = [name for name in content(at.folder) if name == start or name.startswith(start + "/")]
        own = all(name in at.written or (at.folder / name).is_dir() for name in inside) and not path.is_symlink()
        return lambda name, before: own and (name == start or name.startswith(start + "/"))

    def studies(name: str, before: set[str]) -> bool:
        return bool(re.match(rf"project/{CACHE}($|/[0-9a-f]{{24}})", name)) and (
            name not in before or name in at.written
        )

    while True:
        kind = rng.choice(("vary", "vary", "vary", "export", "report", "page", "profile", "inspection", "ecam", "pose",
                           "centres", "compare", "check", "measured", "handover", "change", "put", "put"))  # fmt: skip
        if kind in ("change", "put"):
            getattr(at, kind)()
        elif kind == "vary":
            study, out = at.project / "study.toml", at.target(".csv")
            study.write_text(STUDY.format(radius=rng.choice((400.0 + rng.randrange(30), 400.0))), "utf-8")
            words = ["vary", str(study), "--out", str(out), *rng.choice(([], ["--resume"]))]
            typed = named(out)
            yield words, lambda name, before, typed=typed: typed(name, before) or studies(name, before)
        elif kind == "export":
            out = at.target()
            yield ["export", lift, "--samples", "36", "--out", str(out)], into(out, "summary.json", "kinematics.csv")
        elif kind == "report":
            out = at.target()
            yield ["report", lift, "--samples", "36", "--out", str(out)], into(out, "summary.json", "report.txt")
        elif kind == "centres":
            out = at.target()
            yield ["centres", four, "--angle", "45", "--out", str(out)], into(out)
        elif kind == "handover":
            out = rng.choice((at.target(), at.target(".zip")))
            yield ["handover", lift, "--error", "0.1", "--out", str(out)], whole(out)
        elif kind == "check":
            yield ["check", rng.choice((lift, four, str(at.project / "notes.txt")))], lambda name, before: False
        else:
            ending = {"page": ".html", "profile": ".dxf", "pose": ".dxf", "measured": ".toml"}.get(kind, ".csv")
            out = at.target(ending)
            words = {
                "page": ["report", four, "--out", str(out)],
                "profile": ["profile", lift, "--tolerance", "0.1", "--out", str(out)],
                "inspection": ["inspection", lift, "--out", str(out)],
                "ecam": ["ecam", lift, "--controller", "general", "--points", "40", "--out", str(out)],
                "pose": ["pose", four, "--angle", "30", "--out", str(out)],
                "compare": ["compare", lift, lift, "--out", str(out)],
                "measured": ["measured", str(at.project / "data.csv"), "--into", str(out), "--as", "motion"],
            }[kind]
            yield words, named(out, {"profile": f"{out.name}.json", "inspection": "summary.json"}.get(kind, ""))


def lived_through(at: Stranger, steps: Iterator[Told], without: tuple[str, ...] = ()) -> int:
    """Run them, and compare after each."""
    done = 0
    for words, told in steps:
        if words[0] in without:
            continue
        before = content(at.folder)
        code = main(["--headless", *words]) if words[0] == "handover" else core(words)
        after = content(at.folder)
        changed = {name for name in before.keys() | after.keys() if before.get(name, 0) != after.get(name, 0)}
        wrong = sorted(name for name in changed if not told(name, set(before)))
        assert not wrong, (code, words, wrong)
        assert code in (0, 1, 2)
        at.written |= {name for name in changed if name in after}
        done += 1
    return done


@pytest.mark.posix("links")
def test_a_strangers_folder_survives_some_commands(tmp_path: Path) -> None:
    at = Stranger(tmp_path, Random(3))
    steps = commands(at)
    assert lived_through(at, (next(steps) for _ in range(12)), without=("handover", "page")) > 7


@pytest.mark.fuzz
@pytest.mark.posix("links")
def test_a_strangers_folder_survives_any_commands(tmp_path: Path) -> None:
    end = time.monotonic() + BUDGET_S / 4
    for seed in count():
        print(f"seed {seed}")
        at = Stranger(tmp_path / str(seed), Random(seed))
        steps = commands(at)
        lived_through(at, (next(steps) for _ in range(30)))
        shutil.rmtree(tmp_path / str(seed))
        if time.monotonic() > end:
            break
