"""core.project.differences and core.project.on_disk: what differs between two designs, and has a file been changed?"""

import tomllib
from dataclasses import replace
from pathlib import Path

import pytest

from core.design import edited, insert_segment, put, with_elastic
from core.errors import MISSING, FileError
from core.project import dumps, load
from core.project.differences import differences
from core.project.on_disk import DesignFiles, OnDisk
from kindyna_gui.places import example, examples

LIFT = load(example("transfer_lift"))
EVERY = [path for _, path in examples()]


def told(before, after):
    return [tuple(each) for each in differences(before, after)]


@pytest.mark.parametrize("path", EVERY, ids=lambda path: path.stem)
def test_nothing_differs_from_itself(path: Path) -> None:
    assert differences(load(path), load(path)) == []


def test_values_in_the_order_of_the_file() -> None:
    after = edited(edited(LIFT, "loads.friction", 0.2), "follower.rod_mm", 850.0)
    assert told(LIFT, replace(after, name="Other")) == [
        ("name", LIFT.name, "Other"),
        ("follower.rod_mm", 845.0, 850.0),
        ("loads.friction", 0.1, 0.2),
    ]


def test_a_segment_in_the_midst_is_one_difference() -> None:
    after = insert_segment(LIFT, 2)
    found = told(LIFT, after)
    rows = tomllib.loads(dumps(after))["motion"]["segments"]
    assert ("motion.segments[3]", MISSING, rows[3]) in found
    assert len(found) == 2, "it takes its span from the one before"
    assert found[0][0] == "motion.segments[2].span_deg"
    assert [path for path, _, new in told(after, LIFT) if new is MISSING] == ["motion.segments[3]"]


def test_rows_that_stay_are_compared_with_themselves() -> None:
    after = put(insert_segment(LIFT, 0), "motion.segments[4].law", "cycloidal")
    paths = [path for path, _, _ in differences(LIFT, after)]
    assert paths == ["motion.segments[0].span_deg", "motion.segments[1]", "motion.segments[4].law"]


def test_tables_that_come() -> None:
    six = load(example("lecture_six_bar"))
    moved = put(six, "linkage.links[1].points.A.x_mm", 21.0)
    ((path, old, new),) = told(six, moved)
    assert path == "linkage.links[1].points.A"
    assert new == [21.0, old[1]]
    found = told(LIFT, six)
    assert ("follower.rod_mm", 845.0, MISSING) in found
    assert [path for path, old, _ in found if path.startswith("linkage.driver")]
    elastic = load(example("kim_1990"))
    paths = [path for path, _, new in told(elastic, with_elastic(elastic, None)) if new is MISSING]
    assert "shaft.stiffness_nm_per_rad" in paths


def test_all_of_a_design_that_has_none_before() -> None:
    found = {path: new for path, old, new in told(None, LIFT) if old is MISSING}
    assert found["follower.rod_mm"] == 845.0
    assert found["motion.segments[1]"]["rise_mm"] == -150.0
    assert "format" not in found


def test_a_file_is_compared_by_what_it_holds(tmp_path: Path) -> None:
    files, path = DesignFiles(), tmp_path / "a.toml"
    assert files.state(path) is OnDisk.SAME
    with pytest.raises(FileError):
        files.read(path)
    files.write(LIFT, path)
    assert files.read(path) == LIFT
    path.touch()
    assert files.state(path) is OnDisk.SAME
    for other in (dumps(edited(LIFT, "loads.friction", 0.2)).encode(), b"\xff", b"x" * 11_000_000):
        path.write_bytes(other)
        assert files.state(path) is OnDisk.CHANGED
    path.unlink()
    assert files.state(path) is OnDisk.GONE
    path.mkdir()
    assert files.state(path) is OnDisk.CHANGED
    path.rmdir()
    files.write(LIFT, path)
    assert files.state(path) is OnDisk.SAME
