"""The hand-over of a design: its files are those that each command writes, its list says what they are, the same bytes each time."""

import hashlib
import json
import os
import zipfile
from collections.abc import Callable
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from folders import content
from sampled import stressed
from step_reader import StepFile

from core.design import put
from core.errors import KindynaError
from core.output.controllers.rows import controller
from core.output.handover import CONTENTS, Handover, HandoverFile, HandoverRequest, handover
from core.project import load, load_one, loads
from core.study import Study
from kindyna_gui.__main__ import main

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
PICKER = EXAMPLES / "card_picker.toml"


@pytest.fixture(scope="module")
def made() -> Handover:
    """The picker's, as it is without further words."""
    return handover(Study(load(PICKER)), HandoverRequest())


def test_each_file_is_listed_with_its_deviation_and_its_hash(tmp_path: Path) -> None:
    made = handover(Study(load(PICKER)), HandoverRequest(controller="codesys-xyva"))
    made.write(tmp_path / "out")
    listed = json.loads((tmp_path / "out" / CONTENTS).read_text("utf-8"))
    rows = {row["name"]: row for row in listed["files"]}
    there = {
        str(path.relative_to(tmp_path / "out")): path.read_bytes()
        for path in (tmp_path / "out").rglob("*")
        if path.is_file()
    }
    assert rows.keys() == there.keys() - {CONTENTS}
    assert all(hashlib.sha256(there[name]).hexdigest() == row["sha256"] for name, row in rows.items())
    assert loads(there["design.toml"].decode()) == load(PICKER)
    assert 0.0 < rows["profile.dxf"]["deviation"] <= 1e-3
    table = next(row for name, row in rows.items() if name.startswith("controller.") and row["deviation"] is not None)
    assert 0.0 < table["deviation"] <= 1e-3
    assert listed["left_out"] == []


def distance_from(exact: np.ndarray, dxf: Path, layer: str = "PROFILE") -> float:
    """The largest of the curve in a file, by another reader, from the chords of exact points (n,) [mm]."""
    (curve,) = [each for each in ezdxf.readfile(dxf).modelspace() if each.dxf.layer == layer]
    points = np.array([complex(p.x, p.y) for p in curve.flattening(1e-4)])
    points = points[:: 1 + points.size // 3000]
    nearest = np.array([np.abs(exact - point).argmin() for point in points])
    sides = []
    for step in (-1, 1):
        a = exact[nearest]
        b = exact[(nearest + step) % exact.size]
        along = np.clip(((points - a) / (b - a)).real, 0.0, 1.0)
        sides.append(np.abs(points - a - along * (b - a)))
    return float(np.minimum(*sides).max())


def test_the_profile_of_the_folder_is_the_cams_to_its_stated_deviation(made: Handover, tmp_path: Path) -> None:
    made.write(tmp_path / "out")
    (row,) = [each for each in made.contents["files"] if each["name"] == "profile.dxf"]
    exact = 1e3 * Study(load(PICKER), 18000).cam.flank.profile
    assert distance_from(exact, tmp_path / "out" / "profile.dxf") <= row["deviation"] + 1.1e-4


@pytest.mark.parametrize(
    ("name", "solids", "sheets"),
    [
        ("conjugate", 2, 0),
        ("groove", 0, 0),
        ("barrel_feeder", 1, 0),
        ("globoidal_indexer", 0, 6),
        ("card_picker", 0, 0),
    ],
)
@pytest.mark.stress
def test_a_cam_with_its_dimensions_leaves_as_a_solid_too(name: str, solids: int, sheets: int) -> None:
    """A groove without the dimensions of its blank has none, and nothing of it is left out."""
    made = handover(Study(load(EXAMPLES / f"{name}.toml")), HandoverRequest())
    files = [file for file in made.files if file.name == "cam.step"]
    assert len(files) == (solids + sheets > 0)
    assert not made.left_out
    for file in files:
        step = StepFile(file.data)
        assert len(list(step.all("MANIFOLD_SOLID_BREP"))) == solids
        assert len(list(step.all("SHELL_BASED_SURFACE_MODEL"))) == sheets
        assert file.deviation is not None
        assert 0.0 < file.deviation[0] <= 1e-3


@pytest.mark.stress
def test_a_groove_that_leaves_its_blank_leaves_as_flanks_with_the_reason(tmp_path: Path) -> None:
    text = (EXAMPLES / "barrel_feeder.toml").read_text("utf-8").replace("length_mm = 110.0", "length_mm = 50.0")
    (tmp_path / "short.toml").write_text(text, "utf-8")
    made = handover(Study(load(tmp_path / "short.toml")), HandoverRequest())
    (file,) = [file for file in made.files if file.name == "cam.step"]
    assert list(StepFile(file.data).shells) == ["ahead 1", "behind 1"]
    assert "no solid: cam.length_mm: 50 mm: the groove reaches" in file.what
    assert not made.left_out


@pytest.mark.stress
def test_the_transfer_unit_leaves_as_four_folders_with_what_each_of_its_readers_asks_for(tmp_path: Path) -> None:
    """Each file is the one that is listed, and a profile that was unpacked is the cam's."""
    handover(Study(load(EXAMPLES / "transfer_unit.toml")), HandoverRequest(controller="sew-tab")).write(
        tmp_path / "a.zip"
    )
    with zipfile.ZipFile(tmp_path / "a.zip") as archive:
        archive.extractall(tmp_path / "out")
    listed = json.loads((tmp_path / "out" / CONTENTS).read_text("utf-8"))
    rows = {row["name"]: row for row in listed["files"]}
    for name, row in rows.items():
        assert hashlib.sha256((tmp_path / "out" / name).read_bytes()).hexdigest() == row["sha256"]
    workshop, controls = ("profile.dxf", "inspection.csv"), (f"controller{controller('sew-tab').extension}",)
    for slug in ("feed", "clamp", "lift", "torque"):
        for name in (*workshop, *controls, "controller.json"):
            assert f"{slug}/{name}" in rows
        assert json.loads((tmp_path / "out" / slug / "controller.json").read_text("utf-8"))["certified"] is True
        assert 0.0 < rows[f"{slug}/profile.dxf"]["deviation"] <= 1e-3
    assert {"design.toml", "machine.html"} <= rows.keys()
    assert listed["left_out"] == []
    exact = 1e3 * Study(load_one(EXAMPLES / "transfer_unit.toml", "lift"), 18000).cam.flank.profile
    assert (
        distance_from(exact, tmp_path / "out" / "lift" / "profile.dxf")
        <= rows["lift/profile.dxf"]["deviation"] + 1.1e-4
    )


@pytest.mark.stress
@pytest.mark.parametrize("name", ["card_picker", stressed("transfer_unit")])
def test_a_design_is_handed_over_in_the_same_bytes_each_time(tmp_path: Path, name: str) -> None:
    for file in ("a.zip", "b.zip"):
        handover(Study(load(EXAMPLES / f"{name}.toml")), HandoverRequest()).write(tmp_path / file)
    assert (tmp_path / "a.zip").read_bytes() == (tmp_path / "b.zip").read_bytes()


def test_what_cannot_be_made_is_said_and_the_rest_is_there() -> None:
    """Where the velocity jumps the profile has a corner, which nobody can cut."""
    design = load(EXAMPLES / "dwell_rise_dwell.toml")
    moving = next(i for i, each in enumerate(design.drive.motion.segments) if each.rise)
    made = handover(Study(put(design, f"motion.segments[{moving}].law", "constant-velocity")), HandoverRequest())
    assert "profile" in {what for what, _ in made.left_out}
    assert {"design.toml", "machine.html"} <= {each.name for each in made.files}


def test_an_archive_is_replaced_by_a_later_one_and_a_file_that_is_none_is_left_alone(
    made: Handover, tmp_path: Path
) -> None:
    (tmp_path / "mine.zip").write_bytes(b"my own")
    with pytest.raises(KindynaError, match="is not, or not only, a hand-over; allowed: another name"):
        made.write(tmp_path / "mine.zip")
    assert (tmp_path / "mine.zip").read_bytes() == b"my own"
    made.with_files([HandoverFile("old.txt", "of before", b"")]).write(tmp_path / "x.zip")
    made.write(tmp_path / "x.zip")
    assert "old.txt" not in zipfile.ZipFile(tmp_path / "x.zip").namelist()


def test_a_folder_that_is_not_empty_is_left_alone(
    made: Handover, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.txt").write_text("mine", "utf-8")
    with pytest.raises(KindynaError, match="this folder is not empty"):
        made.write(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
    assert main(["--headless", "handover", str(PICKER), "--out", str(tmp_path / "x.zip"), "--controller", "nix"]) == 2
    assert "nix" in capsys.readouterr().err


# -- a hand-over of before -----------------------------------------------------------------------------------

SMALL = Handover((HandoverFile("design.toml", "the design", b"a"), HandoverFile("feed/b.csv", "a table", b"bb")), ())
LATER = Handover((HandoverFile("design.toml", "the design", b"later"),), ())


def rezipped(path: Path, change: Callable[[dict[str, bytes]], None], comment: bytes = b"") -> None:
    """An archive with its files changed."""
    with zipfile.ZipFile(path) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    change(files)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.comment = comment
        for name, data in files.items():
            archive.writestr(zipfile.ZipInfo(name), data, zipfile.ZIP_DEFLATED)


def _contents(text: str) -> Callable[[dict[str, bytes]], None]:
    return lambda files: files.update({CONTENTS: text.encode()})


CHANGES: dict[str, Callable[[dict[str, bytes]], object]] = {
    "a file added": lambda files: files.update({"notes.txt": b"mine"}),
    "a file in a folder added": lambda files: files.update({"feed/notes.txt": b"mine"}),
    "a file changed": lambda files: files.update({"feed/b.csv": b"b2"}),
    "a file changed at the same length": lambda files: files.update({"design.toml": b"b"}),
    "a file gone": lambda files: files.pop("design.toml"),
    "no list": lambda files: files.pop(CONTENTS),
    "another list": _contents('{"files": [], "left_out": []}'),
    "a list of the wrong kind": _contents("[1]"),
    "a list that names what is elsewhere": _contents('{"files": [{"name": "../x", "sha256": "0"}]}'),
    "a list of numbers": _contents('{"files": [1, 2]}'),
    "a list without end": _contents("[" * 100_000),
    "no JSON": _contents("\0"),
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_handover_that_was_changed_is_left_alone_as_archive_and_as_folder(tmp_path: Path, name: str) -> None:
    SMALL.write(tmp_path / "a.zip")
    rezipped(tmp_path / "a.zip", CHANGES[name])
    with zipfile.ZipFile(tmp_path / "a.zip") as archive:
        archive.extractall(tmp_path / "out")
    before = content(tmp_path)
    for out in ("a.zip", "out"):
        with pytest.raises(KindynaError, match="is not, or not only, a hand-over; allowed: "):
            LATER.write(tmp_path / out)
    assert content(tmp_path) == before


SPECIAL = [pytest.param(what, marks=pytest.mark.posix("links and pipes")) for what in ("link", "fifo")]


@pytest.mark.parametrize("what", ["comment", "in front", "behind", "twice", "folder", *SPECIAL, "cut"])
def test_an_archive_that_holds_anything_else_is_left_alone(tmp_path: Path, what: str) -> None:
    path = tmp_path / "a.zip"
    SMALL.write(path)
    data = path.read_bytes()
    if what == "comment":
        rezipped(path, lambda files: None, b"mine")
    elif what == "folder":
        rezipped(path, lambda files: files.update({"mine/": b""}))
    elif what == "twice":
        with zipfile.ZipFile(path, "a") as archive, pytest.warns(UserWarning, match="Duplicate"):
            archive.writestr("design.toml", b"a")
    elif what == "link":
        path.rename(tmp_path / "elsewhere.zip")
        path.symlink_to("elsewhere.zip")
    elif what == "fifo":
        path.unlink()
        os.mkfifo(path)
    else:
        path.write_bytes({"in front": b"mine" + data, "behind": data + b"mine", "cut": data[:-30]}[what])
    before = content(tmp_path)
    with pytest.raises(KindynaError, match="is not, or not only, a hand-over; allowed: another name"):
        LATER.write(path)
    assert content(tmp_path) == before


@pytest.mark.posix("links")
@pytest.mark.parametrize("what", ["empty folder", "link", "link to a folder", "link for a file", "link to it all"])
def test_a_folder_that_holds_anything_else_is_left_alone(tmp_path: Path, what: str) -> None:
    out = tmp_path / "out"
    SMALL.write(out)
    if what == "empty folder":
        (out / "mine").mkdir()
    elif what == "link":
        (out / "mine").symlink_to(tmp_path)
    elif what == "link to a folder":
        (out / "feed").rename(tmp_path / "feed")
        (out / "feed").symlink_to(tmp_path / "feed")
    elif what == "link for a file":
        (out / "design.toml").rename(tmp_path / "design.toml")
        (out / "design.toml").symlink_to(tmp_path / "design.toml")
    else:
        out.rename(tmp_path / "elsewhere")
        out.symlink_to("elsewhere")
    before = content(tmp_path)
    with pytest.raises(KindynaError, match="is not, or not only, a hand-over; allowed: an empty or new one"):
        LATER.write(out)
    assert content(tmp_path) == before


def test_a_handover_as_it_was_written_is_replaced_with_nothing_of_it_left(tmp_path: Path) -> None:
    for out in ("a.zip", "out"):
        SMALL.write(tmp_path / out)
        LATER.write(tmp_path / out)
        LATER.write(tmp_path / out)
    assert sorted(zipfile.ZipFile(tmp_path / "a.zip").namelist()) == [CONTENTS, "design.toml"]
    assert sorted(path.name for path in (tmp_path / "out").rglob("*")) == [CONTENTS, "design.toml"]
    assert (tmp_path / "out" / "design.toml").read_bytes() == b"later"


@pytest.mark.stress
def test_the_command_leaves_a_foreign_archive_alone_and_replaces_its_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.zip"
    words = ["--headless", "handover", str(PICKER), "--out", str(path)]
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(CONTENTS, "{}")
        archive.writestr("thesis.tex", "mine")
    data = path.read_bytes()
    assert main(words) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert path.read_bytes() == data
    path.unlink()
    assert main(words) == 0
    assert main(words) == 0
