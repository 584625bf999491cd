"""python -m core stability: what it prints, writes and returns."""

import csv
import json
import os
import subprocess
import sys
from dataclasses import replace
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from mechanisms import PUSHER, levels, with_drive
from shafts import KIM, coefficients, with_elastic

from core import project
from core.__main__ import main
from core.output.export import csv as written
from core.stability import Chart, Figure, histories, history, mean_wind_up
from core.stability.critical_speeds import averages_columns, windup_columns
from core.study import Study

ROOT = Path(__file__).parents[3]
EXAMPLE = ROOT / "resources" / "examples" / "kim_1990.toml"
REFERENCE = json.loads((ROOT / "tests" / "validation" / "kim1990_tongues.json").read_text(encoding="utf-8"))
FILES = {
    "tongues.csv", "windup.csv", "windup_averages.csv", "coefficients.csv", "orbit.csv", "harmonics.csv", "report.txt", "summary.json",
}  # fmt: skip


def saved(folder: Path, design: object) -> Path:
    path = folder / "design.toml"
    project.save(design, path)
    return path


def rows(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(StringIO(text)))


@pytest.fixture
def few_averages(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("core.stability.windup.etas", lambda eta_max: np.arange(0.5, eta_max, 1.0))


def test_the_command_writes_the_tongues_of_every_row_and_the_forbidden_bands(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], few_averages: None
) -> None:
    out = tmp_path / "a" / "b"
    words = ["--q", "0.05", "--q", "0.1", "--at", "2.1,0.05", "--periods", "1"]
    code = main(["stability", str(EXAMPLE), "--out", str(out), *words])
    told = capsys.readouterr()
    assert code == 0
    assert told.err == "pictures left out: they need kindyna --headless\n"
    assert {p.name for p in out.iterdir()} == FILES
    table = rows((out / "tongues.csv").read_text(encoding="utf-8"))
    assert list(table[0]) == ["model", "q", "n", "eta_lo", "eta_hi"]
    assert [(r["model"], r["q"], int(r["n"])) for r in table] == [
        (model, q, n) for model in ("approx_22", "exact_21") for q in ("0.05", "0.1") for n in range(1, 12)
    ]
    for model in ("approx_22", "exact_21"):
        found = [r for r in table if (r["model"], r["q"]) == (model, "0.05")]
        for row, wanted in zip(found, REFERENCE[model], strict=True):
            assert int(row["n"]) == wanted["n"]
            assert float(row["eta_lo"]) == pytest.approx(float(wanted["lo"]), abs=1e-10)
            assert float(row["eta_hi"]) == pytest.approx(float(wanted["hi"]), abs=1e-10)
        digits = [len(row["eta_lo"].replace(".", "").lstrip("0")) for row in found]
        assert sorted(digits)[len(digits) // 2] >= 15, "all digits"  # but for a few that end with zeros
    report = (out / "report.txt").read_text(encoding="utf-8")
    assert "Stability of the flexible shaft" in told.out
    assert told.out.strip().splitlines()[-1] in report
    assert "Forbidden speeds" in report
    assert json.loads((out / "summary.json").read_text(encoding="utf-8"))["stability"]["bands"][0]["n"] == 1


def test_the_tables_hold_what_their_columns_say() -> None:
    found = Study(KIM).flexible_shaft()
    gone = histories(found.coefficients, np.array([2.1, 0.85]), np.array([0.05, 0.1]), 0.0, 2.0, contact=found.contact)
    table = rows(written(*windup_columns(gone)))
    assert [len([r for r in table if r["eta"] == eta]) for eta in ("2.1", "0.85")] == [201, 201]
    y = np.array([float(r["input_turns"]) for r in table[:201]])
    beta, slope = history(found.coefficients, 2.1, 0.05, 0.0, 2.0).at(y)
    assert np.abs(beta - [float(r["wind_up"]) for r in table[:201]]).max() < 1e-12
    assert np.abs(slope - [float(r["wind_up_slope"]) for r in table[:201]]).max() < 1e-10
    force = np.array([float(r["contact_force_ratio"]) for r in table[:201]])
    assert force[0] == pytest.approx(1.0, abs=1e-9), "M X'' θ̇² at the start of the rise"
    assert abs(force[75]) < 1e-12, "nothing in the dwell"
    eta = np.arange(0.5, 1.001, 0.05)
    means = rows(written(*averages_columns(mean_wind_up(found.coefficients, [0.05, 0.5], eta, contact=found.contact))))
    assert {r["leaves_cam"] for r in means[:11]} == {"0.0"}
    assert {r["leaves_cam"] for r in means[14:]} == {"1.0"}
    means = means[:11]
    assert [float(r["eta"]) for r in means] == pytest.approx(list(eta))
    assert float(means[-1]["mean_wind_up"]) == pytest.approx(
        history(found.coefficients, 1.0, 0.05, 0.0, 1.0).averages()[0], rel=1e-9
    )


@pytest.mark.stress
def test_the_shaft_that_a_speed_needs_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    found = Study(KIM).flexible_shaft()
    band = found.bands[1]
    speeds = [0.5 * (band.rpm_lo + band.rpm_hi), 1.01 * band.rpm_hi, 6000.0]
    assert main(["stability", str(EXAMPLE), *(word for rpm in speeds for word in ("--rpm", repr(rpm)))]) == 0
    inside, near, clear = [
        line for line in capsys.readouterr().out.splitlines() if line.startswith("At ") and " rpm the " in line
    ]
    needed = found.stiffness_for(speeds[0])
    assert f"needs at least {needed.stiffer:.6g} N·m/rad or at most {needed.softer:.6g}; the current 85" in inside
    assert inside.endswith("is in a forbidden band.")
    assert near.endswith("is too near a forbidden band.")
    assert clear == "At 6000 rpm the current 85 N·m/rad is outside every forbidden band."


@pytest.mark.stress
def test_the_lift_has_a_chart_of_its_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], few_averages: None
) -> None:
    """Its file says nothing of the shaft: a usual one is taken, and the chart shows the machine, at η = 10.25."""
    lift, given = ROOT / "resources" / "examples" / "transfer_lift.toml", []
    assert main(["stability", str(lift)]) == 2
    assert "the camshaft is rigid" in capsys.readouterr().err

    def painter(drawn: Chart | Figure) -> dict[str, bytes]:
        given.append(drawn)
        return {}

    words = ["--guess", "--out", str(tmp_path), "--periods", "1", "--q", "0.05"]
    assert main(["stability", str(lift), *words], painter=painter) == 0
    drawn = given[0]
    assert isinstance(drawn, Chart)
    assert drawn.machine is not None
    assert drawn.machine.eta == pytest.approx(10.25, rel=0.01)
    assert drawn.eta_max > drawn.machine.eta
    widths = np.diff(drawn.tongues["exact_21"].edges[-1], axis=1)
    assert (widths > 1e-4).all()
    assert "tongue 20" in (tmp_path / "report.txt").read_text(encoding="utf-8")


def test_without_a_folder_nothing_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["stability", str(EXAMPLE)]) == 0
    assert capsys.readouterr().out.startswith("Stability of the flexible shaft\n---")
    assert list(tmp_path.iterdir()) == []


def test_the_painter_is_given_the_chart_and_the_figures_and_their_pictures_are_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], few_averages: None
) -> None:
    given = []

    def painter(drawn: Chart | Figure) -> dict[str, bytes]:
        given.append(drawn)
        return {f"{drawn.name if isinstance(drawn, Figure) else 'stability'}.png": b"png"}

    words = [
        "stability",
        str(EXAMPLE),
        "--out",
        str(tmp_path / "o"),
        "--eta-max",
        "2.2",
        "--q",
        "0.4",
        "--periods",
        "1",
    ]
    assert main(words, painter=painter) == 0
    drawn, _, averages, windup, steady = given
    assert isinstance(drawn, Chart)
    assert (drawn.eta_max, drawn.marked, drawn.name) == (2.2, (0.4,), project.load(EXAMPLE).name)
    assert drawn.tongues["exact_21"].count == 4
    assert [figure.name for figure in given[1:]] == ["coefficients", "windup_averages", "windup", "steady"]
    assert [curve.label for curve in averages.plots[0].curves if curve.label] == ["Q = 0.4"]
    assert windup.plots[0].curves[0].x[-1] == 1.0
    assert [plot.upwards for plot in steady.plots] == ["Wind-up, °", "Follower's error, mm", "Wind-up, °"]
    assert [curve.label for curve in steady.plots[0].curves] == [
        "true steady response",
        "linear, exact (21)",
        "linear, approximate (22), (27)",
    ]
    assert {p.name for p in (tmp_path / "o").iterdir()} == FILES | {
        "stability.png",
        "coefficients.png",
        "windup_averages.png",
        "windup.png",
        "steady.png",
    }
    assert capsys.readouterr().err == ""


@pytest.mark.stress
def test_the_papers_figures_come_out_of_its_example(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, few_averages: None
) -> None:
    """Figs. 4 to 12, each a picture, and the tables they are drawn from."""
    given: dict[str, Chart | Figure] = {}

    def painter(drawn: Chart | Figure) -> dict[str, bytes]:
        name = drawn.name if isinstance(drawn, Figure) else "stability"
        given[name] = drawn
        return {f"{name}.svg": b"<svg/>", f"{name}.png": b"png"}

    monkeypatch.setattr("core.papers.claims", lambda *_: ())  # test_kim_claims has them
    assert main(["stability", str(EXAMPLE), "--claims", "--out", str(tmp_path), "--periods", "2"], painter=painter) == 0
    pictures = {f"figure_{n}{ending}" for n in range(4, 13) for ending in (".svg", ".png")}
    tables = {"claims.txt", "figure_4.csv", "tongues.csv", "windup.csv", "windup_averages.csv", "coefficients.csv"}
    assert {p.name for p in tmp_path.iterdir()} == pictures | tables
    x, velocity, acceleration = given["figure_4"].plots[0].curves
    theta = np.deg2rad(x.x)
    moving = theta < np.pi - 1e-9
    assert np.abs(x.y - np.where(moving, 0.5 - 0.5 * np.cos(2.0 * theta), 0.0)).max() < 1e-12
    assert np.abs(velocity.y - np.where(moving, np.sin(2.0 * theta), 0.0)).max() < 1e-12
    assert np.abs(acceleration.y - np.where(moving, np.cos(2.0 * theta), 0.0)).max() < 1e-12
    assert given["figure_5"].plots[0].curves[0].y.min() == pytest.approx(-6.0, abs=1e-12)
    labels = [curve.label for curve in given["figure_6"].plots[0].curves if curve.label]
    assert labels == ["Q = 0.05", "0.1", "0.2", "0.5", "1"]
    assert given["stability"].machine is None, "Fig. 8 is no machine's"
    for number, (eta, q) in {9: (0.85, 0.1), 10: (0.9, 0.1), 11: (2.1, 0.05), 12: (2.0, 0.05)}.items():
        curve = given[f"figure_{number}"].plots[0].curves[0]
        assert curve.label == f"η = {eta:g}, Q = {q:g}"
        assert (curve.x[0], curve.x[-1]) == (0.0, 2.0)
        assert curve.y[-1] == pytest.approx(history(coefficients(KIM), eta, q, 0.0, 2.0).at(np.array([2.0]))[0][0])
    kept = {(float(r["eta"]), float(r["q"])) for r in rows((tmp_path / "windup.csv").read_text(encoding="utf-8"))}
    assert len(kept) == 4


def test_a_machine_in_a_forbidden_band_is_exit_code_one_and_all_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], few_averages: None
) -> None:
    stiffness = KIM.shaft.elastic.camshaft_inertia_kg_m2 * (0.5 * Study(KIM, 4).omega) ** 2
    path = saved(tmp_path, with_elastic(KIM, stiffness_nm_per_rad=stiffness))
    assert main(["stability", str(path), "--out", str(tmp_path / "o"), "--periods", "1"]) == 1
    assert "error: 1500 rpm is in a forbidden band of speed" in capsys.readouterr().out
    assert {p.name for p in (tmp_path / "o").iterdir()} == FILES
    assert main(["check", str(path)]) == 1
    assert main(["export", str(path), "--out", str(tmp_path / "e"), "--samples", "8", "--only", "motion"]) == 0
    assert main(["export", str(path), "--out", str(tmp_path / "s"), "--samples", "8", "--only", "stability"]) == 1
    assert {p.name for p in (tmp_path / "s").iterdir()} == {"tongues.csv", "orbit.csv", "summary.json"}


def test_damping_leaves_closed_tongues_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = saved(tmp_path, with_elastic(KIM, damping_ratio=0.01))
    assert main(["export", str(path), "--out", str(tmp_path), "--samples", "8", "--only", "stability"]) == 0
    table = rows((tmp_path / "tongues.csv").read_text(encoding="utf-8"))
    assert [r["n"] for r in table if r["model"] == "exact_21"] == ["1", "2"]
    assert "nan" not in (tmp_path / "tongues.csv").read_text(encoding="utf-8")


NO_SHAFT = {
    "rigid": (PUSHER, "shaft: the camshaft is rigid; enter camshaft_inertia_kg_m2 and stiffness_nm_per_rad"),
    "soft": (
        with_elastic(KIM, spring="fixed", stiffness_nm_per_rad=1e-3),
        "shaft.stiffness_nm_per_rad: at Q = 0.05 the load",
    ),
    "too slow": (
        with_elastic(replace(KIM, shaft=replace(KIM.shaft, speed_rpm=1e-6))),
        "shaft.speed_rpm: the shaft swings 4.89e9 times a turn, more than the 10000",
    ),
    "still": (with_drive(KIM, motion=levels(0.0, (360.0, 0.0, "dwell"))), "motion.segments: nothing moves"),
}


@pytest.mark.parametrize("name", NO_SHAFT)
def test_a_design_without_an_answer_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    design, phrase = NO_SHAFT[name]
    path = saved(tmp_path, design)
    assert main(["stability", str(path), "--out", str(tmp_path / "o")]) == 2
    told = capsys.readouterr()
    assert (told.out, told.err.count("\n")) == ("", 1)
    assert told.err.startswith(phrase)
    assert not (tmp_path / "o").exists()


def test_a_camshaft_far_heavier_than_all_it_moves_has_bands_of_no_weight(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its tongues are as narrow as rounding: some do not grow at all, and are no bands."""
    heavy = with_elastic(KIM, camshaft_inertia_kg_m2=1e12)
    assert main(["stability", str(saved(tmp_path, heavy))]) == 0
    assert "keeps clear of the forbidden bands" in capsys.readouterr().out
    assert all(0.0 < band.growth < 1e-7 for band in Study(heavy).flexible_shaft().bands)


def test_a_speed_too_low_to_be_answered_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = saved(tmp_path, with_elastic(KIM, spring="fixed"))
    assert main(["stability", str(path), "--rpm", "1e-300"]) == 2
    told = capsys.readouterr()
    assert told.err.startswith("shaft.speed_rpm: at 1e\u2212300 rpm the shaft swings 4.891e303 times a turn")
    assert "rpm and more" in told.err
    assert told.err.count("\n") == 1


def test_claims_are_about_kims_cam_only(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = saved(tmp_path, with_elastic(KIM, spring_factor=1.6))
    assert main(["stability", str(path), "--claims"]) == 2
    assert "use the example kim_1990.toml" in capsys.readouterr().err
    assert coefficients(KIM).q == pytest.approx(0.05)


@pytest.mark.parametrize(
    ("words", "phrase"),
    [
        (["--q", "0"], "inertia ratio Q; allowed: above 0"),
        (["--q", "x"], "'x': inertia ratio Q"),
        (["--q", "nan"], "'nan': inertia ratio Q"),
        (["--eta-max", "1e9"], "frequency ratio; allowed: above 0 ... 60"),
        (["--at", "0.85"], "a point of the chart; allowed: ETA,Q"),
        (["--at", "0.85,-1"], "inertia ratio Q"),
        (["--periods", "0"], "turns; allowed: above 0"),
        (["--out", " "], "empty; give the path of a folder"),
        (["--rpm", "-5"], "speed; allowed: above 0"),
    ],
)
def test_wrong_words_are_refused_in_one_line(capsys: pytest.CaptureFixture[str], words: list[str], phrase: str) -> None:
    assert main(["stability", str(EXAMPLE), *words]) == 2
    told = capsys.readouterr()
    assert phrase in told.err
    assert told.err.count("\n") == 1


@pytest.mark.stress
def test_the_same_design_gives_the_same_bytes(tmp_path: Path) -> None:
    """Whatever the process and its hash seed."""
    words = ["stability", str(EXAMPLE), "--periods", "1", "--eta-max", "0.6", "--out"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONHASHSEED": "1"}
    subprocess.run(
        [sys.executable, "-m", "core", *words, str(tmp_path / "1")],
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        check=True,
        timeout=120,
    )
    assert main([*words, str(tmp_path / "2")]) == 0
    for file in FILES:
        assert (tmp_path / "1" / file).read_bytes() == (tmp_path / "2" / file).read_bytes(), file
