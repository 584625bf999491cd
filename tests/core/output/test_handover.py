"""The hand-over of a design: its files are those that each command writes, its list says what they are, the same bytes each time."""

import hashlib
import json
import zipfile
from pathlib import Path

import ezdxf
import numpy as np
import pytest

from core.design import put
from core.errors import KindynaError
from core.output.controllers.row import controller
from core.output.handover import CONTENTS, HandoverFile, Request, handover
from core.project import load, loads
from core.study import Study
from kindyna_gui.__main__ import main

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
PICKER = EXAMPLES / "card_picker.toml"


def test_each_file_is_listed_with_its_deviation_and_its_hash(tmp_path: Path) -> None:
    made = handover(load(PICKER), Request(controller="codesys-xyva"))
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


def test_the_profile_of_the_folder_is_the_cams(tmp_path: Path) -> None:
    """Measured again by another reader: each vertex or control point of its curve's ends lies on the exact profile."""
    handover(load(PICKER), Request()).write(tmp_path / "out")
    space = ezdxf.readfile(tmp_path / "out" / "profile.dxf").modelspace()
    (curve,) = [each for each in space if each.dxf.layer == "PROFILE"]
    points = np.array([complex(p.x, p.y) for p in curve.flattening(1e-4)])
    exact = 1e3 * Study(load(PICKER), 36000).cam.flank.profile
    distance = np.array([np.abs(exact - point).min() for point in points[::7]])
    assert distance.max() < 0.01  # of samples that stand up to 10 micrometres apart


def test_four_drives_leave_as_four_folders_and_the_same_bytes(tmp_path: Path) -> None:
    design, request = load(EXAMPLES / "transfer_unit.toml"), Request(controller="sew-tab")
    for name in ("a.zip", "b.zip"):
        handover(design, request).write(tmp_path / name)
    assert (tmp_path / "a.zip").read_bytes() == (tmp_path / "b.zip").read_bytes()
    with zipfile.ZipFile(tmp_path / "a.zip") as archive:
        names = archive.namelist()
    ending = controller("sew-tab").extension
    for slug in ("feed", "clamp", "lift", "torque"):
        assert {f"{slug}/profile.dxf", f"{slug}/inspection.csv", f"{slug}/controller{ending}"} <= set(names)


def test_what_cannot_be_made_is_said_and_the_rest_is_there() -> None:
    """Where the velocity jumps the profile has a corner, which nobody can cut."""
    design = load(EXAMPLES / "dwell_rise_dwell.toml")
    moving = next(i for i, each in enumerate(design.drive.motion.segments) if each.rise)
    made = handover(put(design, f"motion.segments[{moving}].law", "constant-velocity"), Request())
    assert "profile" in {what for what, _ in made.left_out}
    assert {"design.toml", "machine.html"} <= {each.name for each in made.files}


def test_an_archive_is_replaced_by_a_later_one_and_a_file_that_is_none_is_left_alone(tmp_path: Path) -> None:
    made = handover(load(PICKER), Request())
    (tmp_path / "mine.zip").write_bytes(b"my own")
    with pytest.raises(KindynaError, match="is no hand-over; allowed: another name"):
        made.write(tmp_path / "mine.zip")
    assert (tmp_path / "mine.zip").read_bytes() == b"my own"
    made.with_files([HandoverFile("old.txt", "of before", b"")]).write(tmp_path / "x.zip")
    made.write(tmp_path / "x.zip")
    assert "old.txt" not in zipfile.ZipFile(tmp_path / "x.zip").namelist()


def test_a_folder_that_is_not_empty_is_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    assert main(["--headless", "handover", str(PICKER), "--out", str(tmp_path)]) == 2
    assert "this folder is not empty" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
    assert main(["--headless", "handover", str(PICKER), "--out", str(tmp_path / "x.zip"), "--controller", "nix"]) == 2
    assert "nix" in capsys.readouterr().err
