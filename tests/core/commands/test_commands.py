"""python -m core: what it prints, writes and returns, from outside."""

import argparse
import contextlib
import io
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from mechanisms import LAYOUT_DESIGNS, LIFT, PUSHER, levels, with_cam, with_drive, with_follower, with_loads
from sampled import spread

from core import project
from core.__main__ import main
from core.commands import COMMANDS
from core.design import Design
from core.errors import DesignError
from core.requests import add_options

ROOT = Path(__file__).parents[3]
EXAMPLES = [
    p for p in sorted((ROOT / "resources" / "examples").glob("*.toml")) if "\n[follower]\n" in p.read_text("utf-8")
]
LAST = EXAMPLES[-1]
LIFT_FILE = ROOT / "resources/examples/transfer_lift.toml"
FILES = ["profile.csv", "kinematics.csv", "dynamics.csv", "summary.json"]


def process(folder: Path, *words: str | Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """The command as a process, run in a folder of its own."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8", **variables}
    command = [sys.executable, "-m", "core", *map(str, words)]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, encoding="utf-8")


def core(folder: Path, *words: str | Path) -> subprocess.CompletedProcess[str]:
    """The command in this process, which is quicker."""
    said, faults = io.StringIO(), io.StringIO()
    with contextlib.chdir(folder), contextlib.redirect_stdout(said), contextlib.redirect_stderr(faults):
        code = main([str(word) for word in words])
    return subprocess.CompletedProcess(words, code, said.getvalue(), faults.getvalue())


def saved(folder: Path, design: Design) -> Path:
    path = folder / "design.toml"
    project.save(design, path)
    return path


def content(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def check_refused(
    done: subprocess.CompletedProcess[str], folder: Path, before: dict[str, bytes], lines: int | None = 1
) -> str:
    """Exit code 2, the faults on stderr line by line, nothing on stdout, nothing written."""
    assert done.returncode == 2, done.stderr
    assert done.stdout == ""
    assert "Traceback" not in done.stderr
    assert "Warning" not in done.stderr
    told = done.stderr.splitlines()
    assert lines is None or len(told) == lines
    assert all(line.strip() for line in told)
    assert content(folder) == before
    return done.stderr


# -- what it does -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("command", "example"),
    spread([("check", p) for p in EXAMPLES] + [("report", p) for p in EXAMPLES[1::3]], 3),
    ids=lambda each: getattr(each, "stem", each),
)
def test_the_examples_are_checked_and_reported(tmp_path: Path, command: str, example: Path) -> None:
    run = process if example is LAST else core  # as a process too: the same exit code, nothing on stderr
    done = run(tmp_path, command, example)
    assert (done.returncode, done.stderr) == (0, "")
    assert project.load(example).name in done.stdout
    assert content(tmp_path) == {}
    assert "NOT KEPT" not in done.stdout
    if command == "check":
        assert re.search(r"(\d+) of \1 residuals within their bounds", done.stdout)
    else:
        for heading in ("Motion", "Extremes over one turn", "Flywheel", "Findings", "Certificate", "Base position"):
            assert f"\n{heading}\n{'-' * len(heading)}\n" in done.stdout


@pytest.mark.parametrize("example", EXAMPLES[::3], ids=lambda path: path.stem)
def test_an_export_writes_its_files_and_names_them(tmp_path: Path, example: Path) -> None:
    done = core(tmp_path, "export", example, "--out", tmp_path / "a" / "b", "--samples", "48")
    assert (done.returncode, done.stderr) == (0, "")
    elastic = project.load(example).shaft.elastic is not None
    names = [*FILES[:3], *(["orbit.csv", "tongues.csv"] if elastic else []), FILES[3]]
    assert [Path(line).name for line in done.stdout.splitlines()] == names
    assert all(Path(line).is_file() for line in done.stdout.splitlines())
    written = content(tmp_path)
    assert sorted(written) == sorted(f"a/b/{name}" for name in names)
    for name in FILES[:3]:
        assert written[f"a/b/{name}"].count(b"\n") == 49
        assert written[f"a/b/{name}"].startswith(b"cam_angle_deg,")
    assert json.loads(written["a/b/summary.json"])["name"] == project.load(example).name


def test_the_folder_and_the_number_of_samples_have_defaults(tmp_path: Path) -> None:
    assert core(tmp_path, "export", EXAMPLES[0]).returncode == 0
    assert set(content(tmp_path)) == {f"out/{name}" for name in FILES}
    assert content(tmp_path)["out/profile.csv"].count(b"\n") == 3600 + 1


def test_a_report_with_a_folder_is_written_and_printed(tmp_path: Path) -> None:
    printed = core(tmp_path, "report", EXAMPLES[1])
    done = core(tmp_path, "report", EXAMPLES[1], "--out", tmp_path / "r")
    assert done.returncode == 0
    assert done.stdout == printed.stdout
    assert "pictures left out" in done.stderr
    assert set(content(tmp_path)) == {"r/report.txt", "r/summary.json"}
    assert content(tmp_path)["r/report.txt"].decode() == printed.stdout


@pytest.mark.stress
def test_the_same_design_gives_the_same_bytes(tmp_path: Path) -> None:
    """Whatever the process, the hash seed, the folder, the time and the language."""
    one, other = tmp_path / "one", tmp_path / "other"
    core(tmp_path, "export", EXAMPLES[1], "--out", one, "--samples", "90")
    process(
        ROOT, "export", EXAMPLES[1], "--out", other, "--samples", "90", PYTHONHASHSEED="2", TZ="Asia/Seoul", LC_ALL="C"
    )
    assert content(one) == content(other) != {}
    again = process(tmp_path, "report", EXAMPLES[1], PYTHONHASHSEED="1", TZ="UTC")
    assert core(tmp_path, "report", EXAMPLES[1]).stdout == again.stdout != ""


def test_an_export_over_an_export_replaces_it_and_leaves_other_files_alone(tmp_path: Path) -> None:
    out = tmp_path / "out"
    core(tmp_path, "export", EXAMPLES[0], "--samples", "8")
    (out / "notes.txt").write_text("mine", "utf-8")
    core(tmp_path, "export", EXAMPLES[1], "--samples", "8")
    alone = tmp_path / "alone"
    core(tmp_path, "export", EXAMPLES[1], "--samples", "8", "--out", alone)
    assert content(out) == {**content(alone), "notes.txt": b"mine"}


@pytest.mark.parametrize(
    ("stages", "names"),
    [(["motion"], ["kinematics.csv", "summary.json"]), (["cam"], ["profile.csv", "summary.json"]),
     (["motion", "cam"], ["kinematics.csv", "profile.csv", "summary.json"]), (["dynamics"], ["dynamics.csv", "summary.json"])],
)  # fmt: skip
def test_only_the_stages_asked_for_are_written(tmp_path: Path, stages: list[str], names: list[str]) -> None:
    done = core(tmp_path, "export", EXAMPLES[1], "--samples", "8", "--only", *stages)
    assert done.returncode == 0
    assert sorted(content(tmp_path)) == [f"out/{name}" for name in names]


def test_a_motion_can_be_exported_of_a_linkage_that_cannot_be_built(tmp_path: Path) -> None:
    path = saved(tmp_path, with_follower(LIFT, roller_arm_mm=100.0))
    assert core(tmp_path, "export", path, "--only", "motion", "--samples", "8").returncode == 0
    assert core(tmp_path, "export", path, "--out", tmp_path / "all").returncode == 2
    assert not (tmp_path / "all").exists()


# -- findings ---------------------------------------------------------------------------------------------


def separating() -> Design:
    return with_loads(PUSHER, preload_n=-1000.0)


def test_an_error_among_the_findings_is_exit_code_one_and_all_files_are_written(tmp_path: Path) -> None:
    path = saved(tmp_path, separating())
    for words in (["report", path, "--samples", "72"], ["export", path, "--samples", "8"]):
        done = core(tmp_path, *words)
        assert done.returncode == 1
        assert done.stderr == ""
    assert {f"out/{name}" for name in FILES} <= set(content(tmp_path))
    done = process(tmp_path, "check", path)
    assert done.returncode == 1
    (told,) = [line for line in done.stdout.splitlines() if line.startswith("error:")]
    assert re.search(r"leaves the cam.* at cam angle [\d.]+ ° \[loads\]", told)


def test_a_warning_is_no_error(tmp_path: Path) -> None:
    harmonic = levels(0.0, (60.0, 0.0, "dwell"), (100.0, 20.0, "simple-harmonic"), (200.0, 0.0, "3-4-5"))
    done = core(tmp_path, "check", saved(tmp_path, with_drive(PUSHER, motion=harmonic)))
    assert (done.returncode, done.stderr) == (0, "")
    assert "warning: acceleration jumps" in done.stdout


def test_a_stage_that_is_not_asked_for_does_not_tell_its_errors(tmp_path: Path) -> None:
    path = saved(tmp_path, separating())
    assert core(tmp_path, "export", path, "--samples", "8", "--only", "cam").returncode == 0
    assert core(tmp_path, "export", path, "--samples", "8", "--only", "dynamics").returncode == 1


def test_a_jammed_guide_is_written_without_forces_and_without_a_word_on_stderr(tmp_path: Path) -> None:
    path = saved(tmp_path, with_loads(with_follower(PUSHER, offset_mm=0.0), friction=3.5))
    for words in (["check", path], ["report", path, "--samples", "72"], ["export", path, "--samples", "72"]):
        done = core(tmp_path, *words)
        assert (done.returncode, done.stderr) == (1, "")
    written = content(tmp_path)
    assert set(written) == {"design.toml", "out/profile.csv", "out/kinematics.csv", "out/summary.json"}
    assert "contact_force_n" not in json.loads(written["out/summary.json"])["extremes"]


JAMS_SHORTLY = with_drive(
        replace(with_follower(PUSHER, offset_mm=0.0, direction_deg=346.588), shaft=replace(PUSHER.shaft, speed_rpm=4729.0)),
        motion=levels(0.0, (34.056, -7.86, "freudenstein-1-3"), (49.0, -28.86, "2-3"), (66.805, -2.088, "cycloidal"),
                      (51.8, -38.088, "freudenstein-1-3"), (16.43958, -64.058, "3-4-5"), (32.818, -58.338, "freudenstein-1-3"),
                      (63.088, -38.906, "cycloidal"), (45.99342, 0.0, "cycloidal")),
        cam=replace(PUSHER.drive.cam, base_radius_mm=100.0561, roller_radius_mm=0.61367),
        loads=replace(PUSHER.drive.loads, friction=0.5, follower_mass_kg=0.343, spring_rate_n_per_mm=70.44, preload_n=135.5,
                      gravity_angle_deg=90.0),
)  # fmt: skip


@pytest.mark.parametrize("samples", [4, 72, 360])
def test_a_guide_jams_whether_or_not_a_sample_falls_there(samples: int, tmp_path: Path) -> None:
    """Within a degree or so of the turn, where 72 samples see nothing of it."""
    done = core(tmp_path, "export", saved(tmp_path, JAMS_SHORTLY), "--samples", str(samples))
    assert (done.returncode, done.stderr) == (1, "")
    written = content(tmp_path)
    assert set(written) == {"design.toml", "out/profile.csv", "out/kinematics.csv", "out/summary.json"}
    (jam,) = [f for f in json.loads(written["out/summary.json"])["findings"] if f["code"] == "jamming"]
    assert jam["values"]["factor"] > 1.0


# -- what it refuses: no answer ---------------------------------------------------------------------------

NO_ANSWER: dict[str, tuple[Design, tuple[str, ...]]] = {
    "roller out of reach": (
        with_follower(LIFT, roller_arm_mm=100.0),
        ("follower.roller_arm_mm", "cannot reach the base circle"),
    ),
    "rod too short": (with_follower(LIFT, rod_mm=400.0, guide_height_mm=600.0), ("follower.rod_mm", "does not reach")),
    "stroke too long": (
        with_drive(
            LIFT, motion=levels(0.0, (90.0, 0.0, "dwell"), (90.0, -1500.0, "cycloidal"), (180.0, 0.0, "cycloidal"))
        ),
        ("follower.rod_mm", "at cam angle "),
    ),
    "offset too large": (with_follower(PUSHER, offset_mm=57.0), ("follower.offset_mm",)),
    "radius used up": (
        with_drive(PUSHER, motion=levels(0.0, (180.0, -50.0, "cycloidal"), (180.0, 0.0, "cycloidal"))),
        ("cam.base_radius_mm", "at cam angle "),
    ),
    "roller over the cam centre": (
        with_drive(
            with_cam(PUSHER, base_radius_mm=1e-9, roller_radius_mm=57.0),
            motion=levels(0.0, (180.0, -0.5, "cycloidal"), (180.0, 0.0, "cycloidal")),
        ),
        ("cam.base_radius_mm", "radius turns negative"),
    ),
}


@pytest.mark.parametrize(
    ("command", "case"),
    spread([*(("check", case) for case in NO_ANSWER), ("report", "stroke too long"), ("export", "radius used up")], 1),
)
def test_a_design_without_an_answer_is_one_line_with_field_and_cam_angles(
    tmp_path: Path, command: str, case: str
) -> None:
    design, phrases = NO_ANSWER[case]
    path = saved(tmp_path, design)
    before = content(tmp_path)
    line = check_refused(core(tmp_path, command, path), tmp_path, before)
    assert all(phrase in line for phrase in phrases)


# -- what it refuses: files -------------------------------------------------------------------------------

BROKEN: dict[str, tuple[tuple[tuple[str, str], ...], tuple[str, ...]]] = {
    # what is replaced in the lift's file, and where each of the faults is told
    "spans": ((("span_deg = 207.0", "span_deg = 206.0"),), ("motion.segments",)),
    "rises": ((("rise_mm = -150.0", "rise_mm = -149.0"),), ("motion.segments",)),
    "negative length": ((("rod_mm = 845.0", "rod_mm = -845.0"),), ("follower.rod_mm",)),
    "zero length": ((("roller_radius_mm = 150.0", "roller_radius_mm = 0.0"),), ("cam.roller_radius_mm",)),
    "nan": ((("slider_arm_mm = 1302.162", "slider_arm_mm = nan"),), ("follower.slider_arm_mm",)),
    "infinity": ((("external_force_n = -20000.0", "external_force_n = -inf"),), ("loads.external_force_n",)),
    "unknown key": ((("rod_mm = 845.0", "rod_mm = 845.0\nrodd_mm = 1.0"),), ("follower.rodd_mm",)),
    "unknown table": ((("[shaft]", "[axle]\nx = 1\n[shaft]"),), ("axle",)),
    "unknown law": ((('law = "modified-sine"', 'law = "modified-sin"'),), ("motion.segments[1].law",)),
    "unknown layout": ((('layout = "b"', 'layout = "k"'),), ("follower.layout",)),
    "layout against the pivot": ((('layout = "b"', 'layout = "c"'),), ("follower.layout",)),
    "sense": ((('rotation = "ccw"', 'rotation = "left"'),), ("shaft.rotation",)),
    "word for a number": ((("speed_rpm = 20.0", 'speed_rpm = "fast"'),), ("shaft.speed_rpm",)),
    "missing": ((("base_radius_mm = 400.0\n", ""),), ("cam.base_radius_mm",)),
    "format": ((("format = 1", "format = 2"),), ("format",)),
    "standing shaft": ((("speed_rpm = 20.0", "speed_rpm = 0.0"),), ("shaft.speed_rpm",)),
    "several": ((("rod_mm = 845.0", "rod_mm = 0.0"), ("span_deg = 207.0", "span_deg = -1.0"), ("friction = 0.1", "friction = nan"),
                 ('layout = "b"', 'layout = "q"')),
                ("motion.segments[2].span_deg", "motion.segments", "follower.layout", "follower.rod_mm", "loads.friction")),
}  # fmt: skip


@pytest.mark.parametrize("case", BROKEN)
def test_every_fault_of_a_file_is_one_line_that_begins_with_its_place(tmp_path: Path, case: str) -> None:
    edits, places = BROKEN[case]
    text = (ROOT / "resources/examples/transfer_lift.toml").read_text(encoding="utf-8")
    for old, new in edits:
        assert old in text
        text = text.replace(old, new, 1)
    path = tmp_path / "bad.toml"
    path.write_text(text, encoding="utf-8")
    before = content(tmp_path)
    told = check_refused(core(tmp_path, "export", path), tmp_path, before, len(places))
    for place in places:
        assert any(line.startswith((f"{place} = ", f"{place}: ")) for line in told.splitlines()), place
    with pytest.raises(DesignError) as caught:
        project.load(path)
    assert told == str(caught.value) + "\n", "from Python the same"


def _not_there(folder: Path) -> Path:
    return folder / "lift.toml"


def _folder(folder: Path) -> Path:
    (folder / "d").mkdir()
    return folder / "d"


def _no_toml(folder: Path) -> Path:
    (folder / "a").write_text("φ = = 3\n", encoding="utf-8")
    return folder / "a"


def _empty(folder: Path) -> Path:
    (folder / "a").touch()
    return folder / "a"


def _binary(folder: Path) -> Path:
    (folder / "a").write_bytes(bytes(range(256)) * 4)
    return folder / "a"


def _huge(folder: Path) -> Path:
    with open(folder / "a", "wb") as file:
        file.truncate(100_000_000)
    return folder / "a"


def _pipe(folder: Path) -> Path:
    os.mkfifo(folder / "a")
    return folder / "a"


def _utf16(folder: Path) -> Path:
    (folder / "a").write_text('name = "lift"', encoding="utf-16")
    return folder / "a"


PIPE = pytest.param(_pipe, "not an ordinary file", 1, marks=pytest.mark.posix("pipes"))


@pytest.mark.parametrize(
    ("place", "phrase", "lines"),
    spread([(_not_there, "no such file", 1), (_folder, "folder", 1), (_no_toml, "not TOML", 1), (_empty, "format", None),
     (_binary, "not UTF-8", 1), (_huge, "larger than", 1), PIPE, (_utf16, "not UTF-8", 1)], 1),
)  # fmt: skip
def test_what_is_no_design_file_is_refused_in_one_line(
    tmp_path: Path, place: Any, phrase: str, lines: int | None
) -> None:
    path = place(tmp_path)
    before = content(tmp_path)
    done = core(tmp_path, "check", path)
    assert phrase in check_refused(done, tmp_path, before, lines)


@pytest.mark.posix("permissions")
def test_an_unreadable_file_is_refused_in_one_line(tmp_path: Path) -> None:
    path = saved(tmp_path, LIFT)
    before = content(tmp_path)
    path.chmod(0)
    done = core(tmp_path, "check", path)
    path.chmod(0o600)
    if os.geteuid() == 0:
        assert done.returncode == 0, "root reads everything"
    else:
        assert "permission denied" in check_refused(done, tmp_path, before)


ONTO_INPUTS: dict[str, tuple[str, ...]] = {
    "table.csv": ("graph", "table.csv", "--out", "table.csv"),
    "linked.csv": ("graph", "table.csv", "--out", "linked.csv"),
    "lift.csv": ("inspection", "design.toml", "--measured", "lift.csv", "--out", "lift.csv"),
    "design.csv": ("profile", "design.csv", "--out", "design.csv"),
    "design.csv.json": ("profile", "design.csv.json", "--out", "design.csv"),
    "curve.toml": ("motion-from", "design.toml", "curve.toml", "--out", "curve.toml"),
    "design.toml": ("find", "design.toml", "base-radius", "--into", "design.toml"),
}


@pytest.mark.posix("links")
@pytest.mark.parametrize("name", spread(list(ONTO_INPUTS), 4))
def test_no_command_writes_onto_a_file_that_it_reads(tmp_path: Path, name: str) -> None:
    """Under whatever name: of a link, of the facts beside a profile."""
    text = saved(tmp_path, PUSHER).read_text("utf-8")
    for copy in ("design.csv", "design.csv.json"):
        (tmp_path / copy).write_text(text, "utf-8")
    (tmp_path / "table.csv").write_text("angle_deg,x_mm\n0,1\n90,2\n180,4\n", "utf-8")
    (tmp_path / "lift.csv").write_text("".join(f"{angle},{angle / 100.0}\n" for angle in range(0, 360, 10)), "utf-8")
    if name == "curve.toml":
        assert main(["profile", str(tmp_path / "design.toml"), "--as", "arcs", "--out", str(tmp_path / "a.dxf")]) == 0
        (tmp_path / "a.dxf").rename(tmp_path / name)
    (tmp_path / "linked.csv").symlink_to("table.csv")
    before = content(tmp_path)
    done = core(tmp_path, *ONTO_INPUTS[name])
    assert (done.returncode, content(tmp_path)) == (2, before)
    assert done.stderr.splitlines() == [f"{name}: cannot be written: this command reads it; choose another name"]


def test_only_a_slip_of_a_word_is_asked_about(tmp_path: Path) -> None:
    """A sum told in words is no misspelled choice."""
    text = LIFT_FILE.read_text(encoding="utf-8")
    path = tmp_path / "bad.toml"
    path.write_text(text.replace("span_deg = 207.0", "span_deg = 206.0").replace('"open"', '"opne"'), encoding="utf-8")
    told = check_refused(core(tmp_path, "check", path), tmp_path, content(tmp_path), 2)
    assert "spans add up to 359 deg': must make one turn; allowed: a sum of 360 deg" in told
    assert "cam.form = 'opne': unknown word (did you mean 'open'?)" in told


# -- what it refuses: words -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "phrase"),
    [
        ([], "COMMAND"),
        (["chekc", LIFT_FILE], "chekc"),
        (["check"], "DESIGN"),
        (["check", LIFT_FILE, "more"], "more"),
        (["check", LIFT_FILE, "--samples", "8"], "--samples"),
        (["export", LIFT_FILE, "--samples", "3"], "4 ... 5000000"),
        (["export", LIFT_FILE, "--samples", "5000001"], "4 ... 5000000"),
        (["export", LIFT_FILE, "--samples", "-8"], "--samples"),
        (["export", LIFT_FILE, "--samples", "3.5"], "'3.5'"),
        (["export", LIFT_FILE, "--samples", "many"], "'many'"),
        (["export", LIFT_FILE, "--samples"], "--samples"),
        (["export", LIFT_FILE, "--only", "strength"], "'strength'"),
        (["export", LIFT_FILE, "--only", "motion", "cams"], "allowed: motion, linkage, cam, dynamics"),
        (["export", LIFT_FILE, "--only"], "--only"),
        (
            ["export", LIFT_FILE, "--sampl", "8"],
            "--sampl 8 (did you mean '--samples'?); see python -m core export --help",
        ),
        (["report", LIFT_FILE, "--samples", "nan"], "'nan'"),
        (
            ["centres", LIFT_FILE, "--angle", "1,5"],
            "'1,5': angle of the driver or the cam in degrees; allowed: any number",
        ),
        (
            ["blend", "--type", "DRD", "--stroke", "20,5", "--start", "0", "--end", "90"],
            "'20,5': stroke; allowed: 1e-09 ... 1e+09 (with a decimal",
        ),
        *(
            (
                ["blend", "--type", "DRD", "--stroke", "20", "--start", "0", "--end", "1e-300", *best],
                "start 0 deg, end 1e-300 deg: outside",
            )
            for best in ([], ["--best", "acceleration"])
        ),
        (
            ["blend", "--type", "DRRD", "--stroke", "1e-300", "--start", "0", "--end", "360", "--best", "jerk"],
            "stroke; allowed: 1e-09 ... 1e+09",
        ),
        (
            ["blend", "--type", "DRD", "--stroke", "20", "--start", "x", "--end", "90"],
            "'x': cam angle in degrees; allowed: 0 ... 360",
        ),
        (["measured", "t.csv", "--error", "-1"], "'-1': measuring error; allowed: >= 0"),
        (["stability", LIFT_FILE], "stiffness_nm_per_rad, or assume typical ones with --guess"),
    ],
)
def test_wrong_words_are_refused_in_one_line(tmp_path: Path, words: list[str | Path], phrase: str) -> None:
    assert phrase in check_refused(core(tmp_path, *words), tmp_path, {})


def test_the_help_says_that_a_length_is_the_least_where_the_best_is_wanted(tmp_path: Path) -> None:
    text = " ".join(core(tmp_path, "blend", "--help").stdout.split())
    assert "with --best the least span" in text


@pytest.mark.parametrize("words", [["--help"], ["check", "--help"], ["report", "--help"], ["export", "--help"]])
def test_help_is_given(tmp_path: Path, words: list[str]) -> None:
    done = core(tmp_path, *words)
    assert (done.returncode, done.stderr) == (0, "")
    assert "usage: python -m core" in done.stdout


@pytest.mark.parametrize("name", COMMANDS)
def test_the_help_of_an_option_names_what_it_is_of(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Stroke of the rise, not of the rise: there is no label of a form beside it."""
    monkeypatch.setenv("COLUMNS", "100000")
    parser = argparse.ArgumentParser()
    add_options(parser, COMMANDS[name].arguments())
    texts = re.findall(r"^  -\S.*?\s{2,}(\S.*)$", parser.format_help(), re.MULTILINE)
    assert texts
    assert not [text for text in texts if re.match(r"(at|between|from|if|in|of|on|per) ", text)]


# -- what it refuses: folders -----------------------------------------------------------------------------


@pytest.fixture
def read_only(tmp_path: Path) -> Iterator[Path]:
    """A folder that nobody may write to, root neither: a mounted disk."""
    folder = tmp_path / "disk"
    folder.mkdir()
    yield from _mounted(folder, "ro,size=64k")


@pytest.fixture
def full(tmp_path: Path) -> Iterator[Path]:
    folder = tmp_path / "disk"
    folder.mkdir()
    yield from _mounted(folder, "size=64k")


def _mounted(folder: Path, options: str) -> Iterator[Path]:
    try:
        mounted = (
            subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", folder], capture_output=True).returncode
            == 0
        )
    except OSError:
        mounted = False
    if not mounted:
        pytest.skip("may not mount a disk here")
    yield folder
    subprocess.run(["umount", "-l", folder], check=True)


@pytest.mark.posix("mounting")
@pytest.mark.parametrize("command", ["export", "report"])
def test_a_disk_that_may_not_be_written_is_refused_in_one_line(read_only: Path, command: str) -> None:
    done = core(ROOT, command, LIFT_FILE, "--out", read_only / "out", "--samples", "8")
    assert done.returncode == 2
    assert len([line for line in done.stderr.splitlines() if "pictures" not in line]) == 1
    assert "write-protected" in done.stderr or "read-only" in done.stderr.lower()
    assert list(read_only.iterdir()) == []


@pytest.mark.posix("mounting")
def test_a_full_disk_keeps_what_was_there(full: Path) -> None:
    assert core(ROOT, "export", LIFT_FILE, "--out", full, "--samples", "8").returncode == 0
    before = content(full)
    line = check_refused(process(ROOT, "export", LIFT_FILE, "--out", full, "--samples", "20000"), full, before)
    assert "disk is full" in line


def test_a_file_in_the_folders_place_is_refused(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("mine", "utf-8")
    line = check_refused(core(tmp_path, "export", LIFT_FILE, "--samples", "8"), tmp_path, {"out": b"mine"})
    assert str(tmp_path / "out") in line or "out" in line
    (tmp_path / "dir").mkdir()
    (tmp_path / "dir" / "dynamics.csv").mkdir()
    before = content(tmp_path)
    check_refused(core(tmp_path, "export", LIFT_FILE, "--out", tmp_path / "dir", "--samples", "8"), tmp_path, before)


@pytest.mark.stress
@pytest.mark.posix("pipes of a shell")
def test_a_reader_that_goes_away_is_no_fault(tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = f"{sys.executable} -m core report {LIFT_FILE} | head -n 1"
    done = subprocess.run(
        ["sh", "-c", command], cwd=tmp_path, env=environment, capture_output=True, text=True, encoding="utf-8"
    )
    assert done.stdout == "Transfer unit, lift drive\n"
    assert done.stderr == ""


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no device that is always full")
def test_what_cannot_be_printed_is_one_line(tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        done = subprocess.run(
            [sys.executable, "-m", "core", "laws"],
            cwd=tmp_path,
            env=environment,
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
        )
    assert done.stderr.startswith("standard output: no space left")
    assert len(done.stderr.splitlines()) == 1
    assert done.returncode == 2


INTERRUPTED = """
import os, runpy, signal, sys

module, package = sys.argv[1:3]
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored where the tests were started in the background

class Interrupt:
    def find_spec(self, name, path=None, target=None):
        if name == module:
            sys.meta_path.remove(self)
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Interrupt())

sys.argv[1:] = sys.argv[3:]
runpy.run_module(package, run_name="__main__", alter_sys=True)
"""


@pytest.mark.posix("signals")
@pytest.mark.parametrize(
    ("module", "command", "code", "line"),
    spread(
        [
            ("numpy", ["core", "report", str(LIFT_FILE)], 130, ""),
            ("core.study", ["core", "report", str(LIFT_FILE)], 2, "interrupted\n"),
            ("numpy", ["kindyna_gui", "--headless", "laws"], 130, ""),
            ("PySide6", ["kindyna_gui", "--headless", "selftest"], 130, ""),
            ("PySide6", ["kindyna_gui"], 130, ""),
        ],
        1,
    ),
)
def test_an_interrupt_while_the_program_starts_ends_it_without_a_traceback(
    module: str, command: list[str], code: int, line: str, tmp_path: Path
) -> None:
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "QT_QPA_PLATFORM": "offscreen"}
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED, module, *command],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=120,
        encoding="utf-8",
    )
    assert (done.returncode, done.stderr) == (code, line)


def test_a_name_in_any_language_is_written_and_printed(tmp_path: Path) -> None:
    design = Design("캠 구동 슬라이더 φ", LAYOUT_DESIGNS["a"].shaft, (LAYOUT_DESIGNS["a"].drive,))
    path = saved(tmp_path, design)
    assert "캠 구동 슬라이더 φ" in core(tmp_path, "check", path).stdout
    plain = process(tmp_path, "report", path, PYTHONIOENCODING="ascii")
    assert plain.returncode == 0
    assert "Traceback" not in plain.stderr
    core(tmp_path, "export", path, "--samples", "8")
    assert json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))["name"] == "캠 구동 슬라이더 φ"
