"""python -m core on linkages: what it prints, writes and returns, from outside."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from core.__main__ import main
from core.design import require_motion
from core.project import load

ROOT = Path(__file__).parents[3]
EXAMPLES = ROOT / "resources" / "examples"
SIX = EXAMPLES / "lecture_six_bar.toml"


@dataclass(frozen=True)
class Done:
    returncode: int
    stdout: str
    stderr: str


@pytest.fixture
def core(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Callable[..., Done]:
    """The command, run in a folder of its own."""

    def run(*words: str | Path) -> Done:
        monkeypatch.chdir(tmp_path)
        code = main([str(word) for word in words])
        told = capsys.readouterr()
        return Done(code, told.out, told.err)

    return run


def edited(folder: Path, old: str, new: str, source: Path = SIX) -> Path:
    text = source.read_text("utf-8")
    assert old in text
    path = folder / "design.toml"
    path.write_text(text.replace(old, new), encoding="utf-8")
    return path


def refused(done: Done, *phrases: str) -> None:
    assert done.returncode == 2
    assert done.stdout == ""
    assert "Traceback" not in done.stderr
    assert len(done.stderr.splitlines()) == 1
    for phrase in phrases:
        assert phrase in done.stderr


def test_check_report_and_export(tmp_path: Path, core: Callable[..., Done]) -> None:
    done = core("check", SIX)
    assert (done.returncode, done.stderr) == (0, "")
    assert "change point" in done.stdout
    assert "at driver angle 106.7 °" in done.stdout
    assert "4 of 4 residuals within their bounds" in done.stdout
    done = core("report", SIX, "--out", tmp_path / "r")
    assert done.returncode == 0
    assert "Solved as RRR 3-4, RRP 5-6" in done.stdout
    assert {p.name for p in (tmp_path / "r").iterdir()} == {"report.txt", "summary.json"}
    done = core("export", SIX, "--samples", "36")
    assert (done.returncode, done.stderr) == (0, "")
    assert {p.name for p in (tmp_path / "out").iterdir()} == {"linkage.csv", "dynamics.csv", "summary.json"}
    rows = (tmp_path / "out" / "linkage.csv").read_text("utf-8").splitlines()
    assert len(rows) == 37
    assert rows[0].startswith("driver_angle_deg,link3_deg,link3_rad_s,")
    assert ",B_x_mm," in rows[0]
    assert json.loads((tmp_path / "out" / "summary.json").read_text("utf-8"))["kind"] == "linkage"


def test_a_cam_under_a_coupler_is_exported(tmp_path: Path, core: Callable[..., Done]) -> None:
    done = core("export", EXAMPLES / "four_bar_coupler_cam.toml", "--samples", "90", "--only", "cam")
    assert (done.returncode, done.stderr) == (0, "")
    assert {p.name for p in (tmp_path / "out").iterdir()} == {"profile.csv", "summary.json"}
    assert (tmp_path / "out" / "profile.csv").read_text("utf-8").startswith("cam_angle_deg,x_mm,y_mm,pitch_x_mm,")


def test_stages_that_a_linkage_lacks(tmp_path: Path, core: Callable[..., Done]) -> None:
    for stage in ("cam", "motion", "stability"):
        refused(core("export", SIX, "--only", stage), repr(stage), "allowed: linkage, dynamics")
    assert not (tmp_path / "out").exists()


def test_a_crank_that_cannot_turn_is_written_with_exit_code_one(tmp_path: Path, core: Callable[..., Done]) -> None:
    path = edited(tmp_path, "A = [20.0, 0.0] }", "A = [40.0, 0.0] }")
    for words in (["check", path], ["report", path], ["export", path, "--samples", "72"]):
        done = core(*words)
        assert (done.returncode, done.stderr) == (1, "")
    rows = (tmp_path / "out" / "linkage.csv").read_text("utf-8").splitlines()
    assert 2 < len(rows) < 73
    assert "nan" not in "".join(rows)
    assert "inf" not in "".join(rows)


def test_a_linkage_that_stands_nowhere_is_one_line(tmp_path: Path, core: Callable[..., Done]) -> None:
    path = edited(tmp_path, "O2 = [60.0, 0.0] }", "O2 = [600.0, 0.0] }")
    for words in (["check", path], ["report", path], ["export", path], ["centres", path, "--angle", "45"]):
        refused(core(*words), "linkage.links: its links cannot be assembled", "linkage.branch")


def test_centres(core: Callable[..., Done]) -> None:
    done = core("centres", SIX, "--angle", "45")
    assert (done.returncode, done.stderr) == (0, "")
    told = json.loads(done.stdout)
    assert list(told) == ["angular_velocity_rad_s", "centres", "points", "velocity_ratios", "velocity_differences"]
    assert list(told["centres"]) == [f"{i},{j}" for i in range(1, 7) for j in range(i + 1, 7)]
    assert list(told["angular_velocity_rad_s"]) == ["1", "2", "3", "4", "5", "6"]
    assert set(told["points"]) == {"O1", "O2", "A", "B", "C", "D"}
    assert told["points"]["A"]["x_mm"] == pytest.approx(20.0 * 0.5**0.5)


def test_centres_in_a_dwell_of_the_motion(core: Callable[..., Done]) -> None:
    """Nothing moves, but the centres are where they are."""
    told = json.loads(core("centres", EXAMPLES / "four_bar_coupler_cam.toml", "--angle", "10").stdout)
    assert {w for body, w in told["angular_velocity_rad_s"].items() if body != "cam"} == {0.0}
    assert all(isinstance(c, list) or "direction_deg" in c for c in told["centres"].values())


def test_centres_refuses_what_it_cannot_do(tmp_path: Path, core: Callable[..., Done]) -> None:
    refused(core("centres", SIX, "--angle", "north"), "angle of the driver or the cam in degrees")
    refused(core("centres", SIX), "--angle")
    path = edited(tmp_path, "A = [20.0, 0.0] }", "A = [40.0, 0.0] }")
    refused(core("centres", path, "--angle", "0"), "do not meet at B at driver angle 0 deg", "within 24.71...335.3 deg")


def test_faults_of_a_linkage_are_lines(tmp_path: Path, core: Callable[..., Done]) -> None:
    path = edited(tmp_path, "link = 6\non = 1", "link = 7\non = 1")
    refused(core("check", path), "linkage.sliders[0].link = 7: no such link; allowed: 1 | 2 | 3 | 4 | 5 | 6")
    path = edited(tmp_path, "branch = { B = 1, D = 1 }", "branch = { B = 1, E = 1 }")
    refused(core("check", path), "linkage.branch.E = 1: no joint with two sides; allowed: B | D")


def test_a_blended_motion_goes_into_a_linkage_that_follows_one(tmp_path: Path, core: Callable[..., Done]) -> None:
    words = ["blend", "--type", "RRR", "--stroke", "10", "--start", "0", "--end", "360", "--into"]
    six = edited(tmp_path, "60.0, 0.0", "60.0, 0.0")
    refused(core(*words, six), "linkage.driver.kind = 'crank'", "allowed: motion")
    path = edited(tmp_path, "speed_rpm = 20.0", "speed_rpm = 30.0", EXAMPLES / "cam_slider_linkage.toml")
    assert core(*words, path).returncode == 0
    motion = require_motion(load(path))
    assert sum(s.rise for s in motion.segments if s.rise > 0.0) == pytest.approx(10.0)
    assert "dwell" not in [s.curve.law for s in motion.segments]


def test_circuits_are_listed_and_taken_as_drawn_or_by_signs(tmp_path: Path, core: Callable[..., Done]) -> None:
    watt = EXAMPLES / "watt_six_bar.toml"
    rows = json.loads(core("circuits", watt, "--json").stdout)["circuits"]
    assert [row["here"] for row in rows] == [True, False, False, False]
    assert rows[0]["driver_deg"] == [0.0, 360.0]
    assert core("circuits", watt, "--take", "3", "--as", "signs", "--out", tmp_path / "c.toml").returncode == 0
    assert core("circuits", watt, "--take", "3", "--out", tmp_path / "d.toml").returncode == 0
    signs, drawn = load(tmp_path / "c.toml").drive.linkage, load(tmp_path / "d.toml").drive.linkage
    assert signs.drawn is None
    assert drawn.branch == ()
    low, high = rows[2]["driver_deg"]
    assert low < drawn.drawn.driver_deg < high
    assert f"within {low:.4g}...{high:.4g} deg" in core("check", tmp_path / "c.toml").stdout
    done = core("circuits", watt, "--take", "5")
    assert (done.returncode, done.stderr) == (2, "circuit = 5: no such circuit; allowed: 1 ... 4\n")


def test_a_pose_has_ghosts_every_so_many_degrees(tmp_path: Path, core: Callable[..., Done]) -> None:
    assert core("pose", SIX, "--angle", "20", "--every", "90", "--out", tmp_path / "p.svg").returncode == 0
    ghosts = (tmp_path / "p.svg").read_text("utf-8").split('<g id="GHOSTS"')[1]
    lines = [line for line in ghosts.splitlines() if line.startswith("<poly")]
    assert len(lines) == 4 * 4  # links 2 to 5; the block has one point
    assert 'points="0.0,0.0 20.0,0.0"' in lines[0]
