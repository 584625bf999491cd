"""The hand-over of a design: its files are those that each command writes, its list says what they are, the same bytes each time."""

import hashlib
import json
import zipfile
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from sampled import stressed

from core.design import put
from core.errors import KindynaError
from core.output.controllers.row import controller
from core.output.handover import CONTENTS, Handover, HandoverFile, Request, handover
from core.project import load, load_one, loads
from core.study import Study
from kindyna_gui.__main__ import main

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
PICKER = EXAMPLES / "card_picker.toml"


@pytest.fixture(scope="module")
def made() -> Handover:
    """The picker's, as it is without further words."""
    return handover(load(PICKER), Request())


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


@pytest.mark.stress
def test_the_transfer_unit_leaves_as_four_folders_with_what_each_of_its_readers_asks_for(tmp_path: Path) -> None:
    """Each file is the one that is listed, and a profile that was unpacked is the cam's."""
    handover(load(EXAMPLES / "transfer_unit.toml"), Request(controller="sew-tab")).write(tmp_path / "a.zip")
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
        handover(load(EXAMPLES / f"{name}.toml"), Request()).write(tmp_path / file)
    assert (tmp_path / "a.zip").read_bytes() == (tmp_path / "b.zip").read_bytes()


def test_what_cannot_be_made_is_said_and_the_rest_is_there() -> None:
    """Where the velocity jumps the profile has a corner, which nobody can cut."""
    design = load(EXAMPLES / "dwell_rise_dwell.toml")
    moving = next(i for i, each in enumerate(design.drive.motion.segments) if each.rise)
    made = handover(put(design, f"motion.segments[{moving}].law", "constant-velocity"), Request())
    assert "profile" in {what for what, _ in made.left_out}
    assert {"design.toml", "machine.html"} <= {each.name for each in made.files}


def test_an_archive_is_replaced_by_a_later_one_and_a_file_that_is_none_is_left_alone(
    made: Handover, tmp_path: Path
) -> None:
    (tmp_path / "mine.zip").write_bytes(b"my own")
    with pytest.raises(KindynaError, match="is no hand-over; allowed: another name"):
        made.write(tmp_path / "mine.zip")
    assert (tmp_path / "mine.zip").read_bytes() == b"my own"
    made.with_files([HandoverFile("old.txt", "of before", b"")]).write(tmp_path / "x.zip")
    made.write(tmp_path / "x.zip")
    assert "old.txt" not in zipfile.ZipFile(tmp_path / "x.zip").namelist()


def test_a_folder_that_is_not_empty_is_left_alone(
    made: Handover, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(KindynaError, match="this folder is not empty"):
        made.write(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
    assert main(["--headless", "handover", str(PICKER), "--out", str(tmp_path / "x.zip"), "--controller", "nix"]) == 2
    assert "nix" in capsys.readouterr().err
