"""Where a study keeps its blocks: nothing but the program's own is deleted or replaced, and a damaged block is computed again."""

import io
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from folders import content
from sampled import spread

from core.__main__ import main
from core.process import resources

STUDY = """
design = "lift.toml"
[[vary]]
field = "cam.base_radius_mm"
values = [{radius}, 430.0, 460.0]
[[quantities]]
quantity = "pressure_angle_deg"
of = "max"
"""
CACHE = ".kindyna-studies"

pytestmark = pytest.mark.posix("links")


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A folder with a design, and beside it one of the user's with files."""
    folder = tmp_path / "project"
    folder.mkdir()
    shutil.copy(resources() / "examples" / "transfer_lift.toml", folder / "lift.toml")
    (tmp_path / "precious").mkdir()
    for name in ("a.txt", "b.npz", "00000.npz", "kindyna-run"):
        (tmp_path / "precious" / name).write_text(f"{name} of the user\n", "utf-8")
    return folder


def vary(project: Path, *options: str, radius: float = 400.0) -> bytes:
    """The table of a study."""
    (project / "study.toml").write_text(STUDY.format(radius=radius), "utf-8")
    assert main(["vary", str(project / "study.toml"), "--out", str(project / "table.csv"), *options]) == 0
    return (project / "table.csv").read_bytes()


def runs(folder: Path) -> list[Path]:
    """The folders below another that hold a block of the program's."""
    return [path.parent for path in folder.glob("*/kindyna-run") if path.read_text("utf-8").startswith("KINDYNA")]


# -- what is the user's stays ----------------------------------------------------------------------------------


def links_named_like_runs(project: Path) -> None:
    (project / CACHE).mkdir()
    for number in range(1, 13):
        (project / CACHE / f"{number:024}").symlink_to("../../precious")


def folders_named_like_runs(project: Path) -> None:
    for number in range(1, 13):
        shutil.copytree(project.parent / "precious", project / CACHE / f"{number:024}")


def files_named_like_runs(project: Path) -> None:
    (project / CACHE).mkdir()
    for number in range(1, 13):
        (project / CACHE / f"{number:024}").write_text("of the user", "utf-8")


def runs_with_a_file_of_the_users(project: Path) -> None:
    """Copies of a run of the program's, whose list is that of another folder, or names other files."""
    vary(project, radius=300.0)
    (run,) = runs(project / CACHE)
    for number in range(1, 13):
        other = shutil.copytree(run, run.with_name(f"{number:024}"))
        (other / "notes.npz").write_text("of the user", "utf-8")
        text = (other / "kindyna-run").read_text("utf-8")
        own = text if number % 2 else text.replace(run.name, other.name).replace("00000.npz", "../../lift.toml")
        (other / "kindyna-run").write_text(own, "utf-8")
    shutil.rmtree(run)


def a_link_in_place_of_all_runs(project: Path) -> None:
    (project / CACHE).symlink_to("../precious")
    for number in range(1, 13):
        (project.parent / "precious" / f"{number:024}").mkdir()


def a_file_in_place_of_all_runs(project: Path) -> None:
    (project / CACHE).write_text("of the user", "utf-8")


@pytest.mark.parametrize(
    "lay_out",
    [
        links_named_like_runs,
        folders_named_like_runs,
        files_named_like_runs,
        runs_with_a_file_of_the_users,
        a_link_in_place_of_all_runs,
        a_file_in_place_of_all_runs,
    ],
)
def test_nothing_of_the_users_goes_however_often_a_study_runs(project: Path, lay_out: Callable[[Path], None]) -> None:
    whole = vary(project)
    shutil.rmtree(project / CACHE)
    (project / "table.csv").unlink()
    lay_out(project)
    before = content(project.parent)
    assert vary(project, radius=410.0) != whole
    vary(project, radius=420.0)
    assert vary(project) == whole
    assert vary(project, "--resume") == whole
    own = ("study.toml", "table.csv")
    after = content(project.parent)
    assert {name: after.get(name) for name in before if not name.endswith(own)} == {
        name: data for name, data in before.items() if not name.endswith(own)
    }


@pytest.mark.parametrize("kind", ["link", "folder", "file", "list of another", "block that is a link", "another file"])
def test_a_run_whose_place_is_taken_is_kept_in_the_users_cache(project: Path, own_settings: Path, kind: str) -> None:
    whole = vary(project)
    (run,) = runs(project / CACHE)
    if kind == "another file":
        (run / "00001.npz").write_text("of the user", "utf-8")
    elif kind == "list of another":
        (run / "kindyna-run").write_text(
            (run / "kindyna-run").read_text("utf-8").replace("KINDYNA", "KINDYMA"), "utf-8"
        )
    elif kind == "block that is a link":
        (run / "00000.npz").unlink()
        (run / "00000.npz").symlink_to(project.parent / "precious" / "00000.npz")
    else:
        shutil.rmtree(run)
        if kind == "link":
            run.symlink_to(project.parent / "precious")
        elif kind == "folder":
            shutil.copytree(project.parent / "precious", run)
        else:
            run.write_text("of the user", "utf-8")
    before = content(project.parent)
    for options in ((), ("--resume",), ()):
        assert vary(project, *options) == whole
    assert content(project.parent) == before
    assert [each.name for each in runs(own_settings / ".cache" / "KINDYNA" / "studies")] == [run.name]


@pytest.mark.parametrize("through", ["its own name", "a link"])
def test_a_design_that_ships_with_the_program_has_nothing_left_beside_it(
    tmp_path: Path, own_settings: Path, through: str
) -> None:
    before = set(resources().rglob("*"))
    (tmp_path / "link").symlink_to(resources() / "examples")
    folder = str(resources() / "examples") if through == "its own name" else "link"
    (tmp_path / "study.toml").write_text(STUDY.format(radius=400.0).replace("lift", f"{folder}/transfer_lift"), "utf-8")
    assert main(["vary", str(tmp_path / "study.toml"), "--out", str(tmp_path / "a.csv")]) == 0
    assert set(resources().rglob("*")) == before
    assert len(runs(own_settings / ".cache" / "KINDYNA" / "studies")) == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv", "link", "study.toml"]


def test_eight_runs_are_kept_and_the_oldest_goes_with_what_its_list_names_alone(project: Path) -> None:
    made: list[Path] = []
    for number in range(10):
        vary(project, radius=300.0 + number)
        (newest,) = set(runs(project / CACHE)).difference(made)
        made.append(newest)
        if number == 1:
            (newest / "notes.txt").write_text("of the user", "utf-8")
        os.utime(newest, (number, number))
    left = {path.name for path in (project / CACHE).iterdir()}
    assert left == {path.name for path in [made[1], *made[2:]]}
    assert sorted(path.name for path in made[1].iterdir()) == ["kindyna-run", "notes.txt"]
    assert all((path / "00000.npz").is_file() for path in made[2:])


# -- a damaged block -------------------------------------------------------------------------------------------


def flipped(bit: int) -> Callable[[bytes], bytes]:
    def change(data: bytes) -> bytes:
        at = bit * len(data) * 8 // 40 + bit % 8
        return data[: at // 8] + bytes([data[at // 8] ^ 1 << at % 8]) + data[at // 8 + 1 :]

    return change


def lying(shape: str) -> Callable[[bytes], bytes]:
    """A block whose arrays say that they are larger than they are, with all check sums right."""

    def change(data: bytes) -> bytes:
        file = io.BytesIO()
        np.savez(file, value=np.zeros((1, 3)), reason=np.array(["", "", ""]))
        import zipfile

        made = io.BytesIO()
        with zipfile.ZipFile(file) as old, zipfile.ZipFile(made, "w") as new:
            for name in old.namelist():
                new.writestr(name, old.read(name).replace(b"(1, 3)", shape.encode()).replace(b"(3,)", b"(9,)"))
        return made.getvalue()

    return change


DAMAGES = [
    *((f"bit {bit}", flipped(bit)) for bit in range(40)),
    ("empty", lambda data: b""),
    ("cut", lambda data: data[:-100]),
    ("cut to the half", lambda data: data[: len(data) // 2]),
    ("longer", lambda data: data + b"\0"),
    ("zeros", lambda data: bytes(len(data))),
    ("shape", lying("(3, 1)")),
    ("large shape", lying("(9, 9999999999)")),
    ("another block", lambda data: lying("(1, 3)")(data)),
    ("text", lambda data: b"of nobody"),
]


@pytest.mark.parametrize(("name", "change"), spread(DAMAGES, 12))
def test_a_damaged_block_is_computed_again(project: Path, name: str, change: Callable[[bytes], bytes]) -> None:
    whole = vary(project)
    (block,) = (project / CACHE).glob("*/00000.npz")
    right = block.read_bytes()
    block.write_bytes(change(right))
    for _ in range(2):
        assert vary(project, "--resume") == whole
        assert block.read_bytes() == right


@pytest.mark.parametrize("change", ["flip", "cut", "twice", "empty"])
def test_a_damaged_list_of_blocks_gives_the_same_table(project: Path, change: str) -> None:
    whole = vary(project)
    (path,) = (project / CACHE).glob("*/kindyna-run")
    text = path.read_text("utf-8")
    path.write_text(
        {"flip": text.replace("00000.npz", "00001.npz"), "cut": text[:-3], "twice": text * 2, "empty": ""}[change],
        "utf-8",
    )
    assert vary(project, "--resume") == whole
    assert vary(project, "--resume") == whole


def test_only_what_is_damaged_is_computed_again(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    values = ", ".join(str(400.0 + 0.01 * number) for number in range(2100))
    text = STUDY.format(radius=300.0).replace("[300.0, 430.0, 460.0]", f"[{values}]")
    (project / "study.toml").write_text(text, "utf-8")
    words = ["vary", str(project / "study.toml"), "--out", str(project / "table.csv"), "--json"]
    assert main(words) == 0
    whole = (project / "table.csv").read_bytes()
    blocks = sorted((project / CACHE).glob("*/*.npz"))
    assert len(blocks) == 3
    blocks[1].write_bytes(blocks[1].read_bytes()[:-1])
    before = [block.stat().st_ino for block in blocks]
    capsys.readouterr()
    assert main([*words, "--resume"]) == 0
    assert json.loads(capsys.readouterr().out)["designs"] == 2100
    assert (project / "table.csv").read_bytes() == whole
    after = [block.stat().st_ino for block in blocks]
    assert (after[0], after[2]) == (before[0], before[2])
