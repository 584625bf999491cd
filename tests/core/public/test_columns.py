"""Arrays of the library against the files of the command line, for examples and random designs of all kinds."""

import csv
import io
import json
import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from face_cases import CASES, random_design
from random_linkages import DRIVES, random_linkage

import kindyna as kd
from core.__main__ import main
from core.design import Design
from core.design.motion_edits import alone, of_motion
from core.project import dumps
from core.study import clear_caches, evaluations

EXAMPLES = ["transfer_lift", "lecture_six_bar", "groove", "transfer_unit", "inverted_slider_crank", "kim_1990"]
SYMBOLS = {
    "mm": "mm", "mm_s": "mm/s", "mm_s2": "mm/s²", "mm_s3": "mm/s³", "deg": "°", "deg_s": "°/s", "deg_s2": "°/s²", "deg_s3": "°/s³",
    "rad_s": "rad/s", "rad_s2": "rad/s²", "n": "N", "nm": "N·m", "w": "W", "j": "J", "mpa": "MPa", "per_mm": "1/mm", "rpm": "rpm",
    "m_s2": "m/s²",
}  # fmt: skip
"""End of a column's name -> symbol of its unit."""


def random_designs(seed: int) -> dict[str, Callable[[], Design]]:
    """A design of every follower, face, sense of rotation and driver of a linkage; a motion alone; a shaft of several drives."""
    rng = np.random.default_rng(seed)
    made = {}
    for follower, face, sense in CASES:
        made[f"{follower} {face} {sense}"] = replace(random_design(rng, follower, face, sense), assumed=())
    single = [random_design(rng, kind, "roller", "ccw") for kind in ("translating", "oscillating", "cam-slider")]
    made["motion"] = of_motion(single[0].drive.motion, "motion", 120.0)
    made["motion of a machine"] = alone(single[1])
    names = ("Feed", "Push 2", "넓이")
    drives = tuple(
        replace(design.drive, name=name, phase_deg=float(rng.uniform(0.0, 360.0)), mirrored=bool(rng.integers(2)))
        for name, design in zip(names, single, strict=True)
    )
    made["shaft"] = Design("shaft", single[0].shaft, drives)
    linkages = {drive: partial(random_linkage, seed, drive) for drive in DRIVES}  # which take long
    return {label: lambda design=design: design for label, design in made.items()} | linkages


def exported(folder: Path, design: kd.Design, samples: int) -> dict[str, str]:
    """File -> text of what the command ``export`` writes, with those of drives in their folders."""
    design.save(folder / "design.toml")
    words = ["export", str(folder / "design.toml"), "--out", str(folder / "out"), "--samples", str(samples)]
    assert main(words) in (0, 1)
    out = folder / "out"
    return {path.relative_to(out).as_posix(): path.read_text("utf-8") for path in out.rglob("*") if path.is_file()}


def assert_same(design: kd.Design, folder: Path, samples: int = 24) -> None:
    """Every column bit for bit, units as in the names, extremes, findings and certificate as in the summary."""
    texts, study = exported(folder, design, samples), design.study(samples)
    slugs = {re.sub(r"\W", "_", name.lower()): drive for name, drive in study.drives.items()}
    for part, of in {"": study, **(slugs if design.kind == "shaft" else {})}.items():
        names = set()
        for file, text in texts.items():
            if file.rpartition("/")[0] != part or not file.endswith(".csv") or file.endswith("tongues.csv"):
                continue
            header, *rows = csv.reader(io.StringIO(text))
            for name, values in zip(header, np.array(rows, dtype=float).T, strict=True):
                assert of[name].tobytes() == values.tobytes(), (file, name)
                names.add(name)
        assert names == set(of.channels)
        for name, channel in of.channels.items():
            assert channel.name == name
            ends = [end for end in SYMBOLS if name.endswith(f"_{end}")]
            assert channel.unit == (SYMBOLS[max(ends, key=len)] if ends else ""), name
        summary = json.loads(texts[f"{part}/summary.json".lstrip("/")])
        for name, row in summary["extremes"].items():
            for end in ("min", "max"):
                extreme = of.extreme(name, end)
                value = row[end]["value"]
                assert extreme.value == value if value is not None else np.isinf(extreme.value), name
                assert (extreme.angle_deg, extreme.unit) == (row[end]["cam_angle_deg"], of.channels[name].unit), name
        if not part:
            assert [row.message for row in of.findings] == [row["message"] for row in summary["findings"]]
            proof = {name: [row["value"], row["bound"]] for name, row in summary["certificate"].items()}
            assert {name: list(pair) for name, pair in of.certificate.items()} == proof


@pytest.mark.parametrize("slug", EXAMPLES)
def test_columns_of_examples_are_those_of_the_tables(slug: str, tmp_path: Path) -> None:
    assert_same(kd.example(slug), tmp_path)


SAMPLE = {"translating flat cw", "oscillating shoe ccw", "linkage knife ccw", "cylinder", "two", "motion", "shaft"}


@pytest.mark.parametrize("label", sorted(SAMPLE))
def test_columns_of_random_designs_are_those_of_the_tables(label: str, tmp_path: Path) -> None:
    assert_same(kd.design(dumps(random_designs(7)[label]())), tmp_path)


@pytest.mark.stress
@pytest.mark.parametrize("slug", kd.examples())
def test_columns_of_all_examples_are_those_of_the_tables(slug: str, tmp_path: Path) -> None:
    assert_same(kd.example(slug), tmp_path, 90)


@pytest.mark.stress
@pytest.mark.parametrize("seed", range(3))
def test_columns_of_a_hundred_random_designs_are_those_of_the_tables(seed: int, tmp_path: Path) -> None:
    designs = random_designs(seed)
    assert len(designs) >= 34
    for label, design in designs.items():
        folder = tmp_path / re.sub(r"\W", "_", label)
        folder.mkdir()
        assert_same(kd.design(dumps(design())), folder)


# -- what a channel computes --------------------------------------------------------------------------------------

STAGES = {"motion": {"motion"}, "linkage": {"motion", "linkage"}, "cam": {"motion", "linkage", "cam"}}
STAGES["dynamics"] = {*STAGES["cam"], "dynamics"}
MOTOR = {"motor_torque_nm", "linear_motor_torque_nm", "speed_rpm"}


@pytest.mark.parametrize("slug", ["transfer_lift", "rocker_cam", "tappet_flat", "conjugate", "lecture_six_bar"])
def test_a_channel_computes_no_other_stage(slug: str) -> None:
    design, counts = kd.example(slug), {}
    for name, channel in design.study(24).channels.items():
        clear_caches()
        study = design.study(24)
        evaluations.clear()
        assert study[name].size == 24
        counts[name] = dict(evaluations)
        allowed = STAGES[channel.stage] | ({"flywheel"} if name in MOTOR else set())
        assert set(evaluations) <= allowed, name
        evaluations.clear()
        assert study[name] is study[name]
        assert not evaluations
    assert len({frozenset(count) for count in counts.values()}) >= 2 or slug == "lecture_six_bar"


def test_a_drive_computes_no_forces_and_its_torque_no_flywheel() -> None:
    clear_caches()
    evaluations.clear()
    study = kd.example("transfer_unit").study(24)
    assert study.drives["Lift"]["x_mm"].size == 24
    assert evaluations.keys() == {"motion", "linkage", "cam"}
    assert study["lift_torque_nm"].size == 24
    assert "dynamics" in evaluations
    assert "flywheel" not in evaluations


@pytest.mark.stress
def test_channels_of_a_balanced_shaft_are_those_of_the_tables(tmp_path: Path) -> None:
    design = kd.example("transfer_unit").find("balancer").design
    assert_same(design, tmp_path)
    assert "balancer" in design.study(24).drives
