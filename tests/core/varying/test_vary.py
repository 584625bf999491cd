"""A study of many designs: its file, its table, and a run that is stopped, killed, and goes on."""

import csv
import importlib.util
import json
import os
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from core.__main__ import main
from core.design import edited, put
from core.errors import DesignError
from core.process import resources
from core.project import load
from core.study import Study, extremes_of, many
from core.varying import Run, load_study, save_study, workers

TABLE = """
design = "lift.toml"
seed = 7
[[vary]]
field = "cam.base_radius_mm"
values = [400.0, 430.0, 460.0]
[[vary]]
field = "motion.segments[1].law"
choices = ["modified-sine", "cycloidal"]
[[vary]]
field = "follower.pivot_x_mm"
low = 800.0
high = 950.0
points = {points}
[[vary]]
field = "follower.pivot_y_mm"
low = -90.0
high = -40.0
points = {points}
[[quantities]]
quantity = "pressure_angle_deg"
of = "max"
[[limits]]
quantity = "acceleration_mm_s2"
of = "abs"
max = 9e3
"""


QUICK = (
    TABLE.format(points=1200)
    .replace('"modified-sine", "cycloidal"', '"cycloidal"')
    .replace("pressure_angle_deg", "jerk_mm_s3")
)


@pytest.fixture
def place(tmp_path):
    shutil.copy(resources() / "examples" / "transfer_lift.toml", tmp_path / "lift.toml")
    (tmp_path / "study.toml").write_text(TABLE.format(points=300), "utf-8")
    return tmp_path


def vary(place, *options, study="study.toml"):
    return main(["vary", str(place / study), "--out", str(place / "table.csv"), *options])


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_the_table_holds_each_design_with_its_own_values(place, capsys):
    assert vary(place, "--json") == 0
    told = json.loads(capsys.readouterr().out)
    table = rows(place / "table.csv")
    assert told["designs"] == told["built"] == len(table) == 3 * 2 * 300
    assert list(table[0]) == [
        "cam.base_radius_mm", "motion.segments[1].law", "follower.pivot_x_mm", "follower.pivot_y_mm",
        "pressure_angle_deg_max", "acceleration_mm_s2_abs", "reason",
    ]  # fmt: skip
    laws = [row["motion.segments[1].law"] for row in table]
    assert laws == (["modified-sine"] * 300 + ["cycloidal"] * 300) * 3
    x = np.array([float(row["follower.pivot_x_mm"]) for row in table])
    assert np.array_equal(x[:300], x[300:600])  # the same points at each combination of the grid
    cells = np.floor((x[:256] - 800.0) / 150.0 * 256)  # of Sobol's first 2^k points one lies in each of 2^k cells
    assert np.array_equal(np.sort(cells), np.arange(256))
    for i in (0, 777, 1799):
        design = load(place / "lift.toml")
        for path in ("cam.base_radius_mm", "follower.pivot_x_mm", "follower.pivot_y_mm"):
            design = put(design, path, float(table[i][path]))
        study = Study(edited(design, "motion.segments[1].law", laws[i]))
        steepest = np.rad2deg(extremes_of(study, "cam", ("pressure_angle",))["pressure_angle"].high.value)
        assert float(table[i]["pressure_angle_deg_max"]) == pytest.approx(steepest, rel=1e-9)


def test_grids_bounds_and_whole_ranges(place):
    text = 'design = "lift.toml"\n[[vary]]\nfield = "cam.base_radius_mm"\nlow = 400.0\nhigh = 500.0\n{}\n' + (
        '[[quantities]]\nquantity = "energy_j"\n'
    )
    (place / "study.toml").write_text(text.format("steps = 5"), "utf-8")
    space = Run(load_study(place / "study.toml")).space
    assert space.columns(1, 5)["cam.base_radius_mm"].tolist() == [425.0, 450.0, 475.0, 500.0]
    (place / "study.toml").write_text(text.format(""), "utf-8")
    assert Run(load_study(place / "study.toml")).count == 64


def test_faults_of_a_study_are_all_named(place):
    (place / "study.toml").write_text(
        TABLE.format(points=8)
        .replace("high = 950.0", "high = 700.0")
        .replace("high = -40.0", "high = -40.0\nspan = 3")
        .replace("cam.base_radius_mm", "cam.base_radios_mm")
        .replace("cycloidal", "cyclodal")
        .replace('of = "abs"\nmax = 9e3', 'of = "most"')
        .replace("seed = 7", "seed = 7\nrobust = 0.9973"),
        "utf-8",
    )
    with pytest.raises(DesignError) as error:
        load_study(place / "study.toml")
    assert {fault.path for fault in error.value.faults} == {
        "vary[2].high", "vary[3].span", "vary[0].field", "vary[1].choices[1]", "limits[0].of", "robust",
    }  # fmt: skip
    assert "did you mean 'cam.base_radius_mm'" in str(error.value)
    assert vary(place) == 2
    assert sorted(path.name for path in place.iterdir()) == ["lift.toml", "study.toml"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("points = 300", "steps = 20000", ("2\u202f400\u202f000\u202f000 designs", "a second", "points = 4096")),
        ("points = 300", "points = 1000000000", ("6\u202f000\u202f000\u202f000 designs", "a second", "fewer points")),
        ("low = 800.0\nhigh = 950.0", "low = 3000.0\nhigh = 3100.0", ("none of the 1800 designs", "no-assembly")),
        ('quantity = "pressure', 'quantity = "pleasure', ("quantities[0].quantity", "no such column")),
    ],
)
def test_what_cannot_be_is_one_line_and_nothing_is_written(place, capsys, old, new, words):
    text = (place / "study.toml").read_text("utf-8")
    (place / "study.toml").write_text(text.replace(old, new), "utf-8")
    assert vary(place) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    for word in words:
        assert word in said
    assert not (place / "table.csv").exists()


def test_a_study_written_is_the_study_read(place):
    file = load_study(place / "study.toml").file
    save_study(file, place / "again.toml")
    assert load_study(place / "again.toml").file == file


def test_a_run_that_is_stopped_keeps_what_is_done(place):
    assert vary(place) == 0
    whole = (place / "table.csv").read_bytes()
    study = load_study(place / "study.toml")

    class Enough(Exception):
        pass

    def stop(done, count):
        if done > 1000:
            raise Enough

    run = Run(study)
    with pytest.raises(Enough):
        run.compute(progress=stop)
    told = []
    Run(study).compute(resume=True, progress=lambda done, count: told.append(done))
    assert told[0] > 1000
    assert vary(place, "--resume", "--workers", "2") == 0
    assert (place / "table.csv").read_bytes() == whole
    put_in = put(study.base, "cam.roller_radius_mm", 140.0)
    assert Run(type(study)(put_in, study.file, study.folder)).folder != run.folder  # another design, another key


def started(place, *options):
    command = [
        sys.executable,
        "-m",
        "core",
        "vary",
        str(place / "study.toml"),
        "--out",
        str(place / "table.csv"),
        *options,
    ]
    return subprocess.Popen(command, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)


def whole_table(place):
    """Its bytes; the table and what is kept for it are taken away again."""
    (place / "study.toml").write_text(QUICK, "utf-8")
    assert vary(place) == 0
    data = (place / "table.csv").read_bytes()
    start_again(place)
    return data


def start_again(place):
    shutil.rmtree(place / ".kindyna-studies")
    (place / "table.csv").unlink()


@pytest.mark.stress
def test_killed_with_a_block_kept_and_resumed_the_table_has_the_same_bytes(place):
    whole = whole_table(place)
    process = started(place)
    while process.poll() is None and not list(place.glob(".kindyna-studies/*/*.npz")):
        time.sleep(0.01)
    process.kill()
    process.wait()
    assert not (place / "table.csv").exists() or (place / "table.csv").read_bytes() == whole
    assert vary(place, "--resume") == 0
    assert (place / "table.csv").read_bytes() == whole
    assert sorted(each.name for each in place.iterdir()) == [".kindyna-studies", "lift.toml", "study.toml", "table.csv"]


@pytest.mark.fuzz
def test_killed_fifty_times_at_any_moment(place):
    whole, killed = whole_table(place), 0
    start = time.perf_counter()
    assert started(place).wait(60.0) == 0
    full = time.perf_counter() - start
    start_again(place)
    for at in np.random.default_rng(2).uniform(0.3 * full, full, 50):
        process = started(place, "--resume")
        try:
            process.wait(at)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        if process.returncode == 0:
            assert (place / "table.csv").read_bytes() == whole
            start_again(place)
        else:
            killed += 1
            assert not (place / "table.csv").exists() or (place / "table.csv").read_bytes() == whole
    assert killed > 10
    assert vary(place, "--resume") == 0
    assert (place / "table.csv").read_bytes() == whole
    assert sorted(each.name for each in place.iterdir()) == [".kindyna-studies", "lift.toml", "study.toml", "table.csv"]


@pytest.mark.skipif(importlib.util.find_spec("pyarrow") is None, reason="the extra parquet")
def test_parquet_holds_the_same_table(place):
    from pyarrow import parquet

    (place / "study.toml").write_text(
        TABLE.format(points=40).replace("800.0", "1.0"), "utf-8"
    )  # some without an assembly
    assert vary(place) == 0
    assert main(["vary", str(place / "study.toml"), "--out", str(place / "t.parquet"), "--resume"]) == 0
    table = parquet.read_table(place / "t.parquet").to_pylist()
    assert [{key: "" if cell is None else str(cell) for key, cell in row.items()} for row in table] == rows(
        place / "table.csv"
    )
    assert any(row["pressure_angle_deg_max"] is None for row in table)


@pytest.mark.skipif(importlib.util.find_spec("distributed") is None, reason="the extra cluster")
@pytest.mark.filterwarnings("ignore")
def test_a_cluster_one_of_whose_processes_dies_gives_the_same_bytes(place):
    from distributed import LocalCluster

    (place / "study.toml").write_text(QUICK, "utf-8")
    assert vary(place) == 0
    whole = (place / "table.csv").read_bytes()
    (place / "table.csv").unlink()
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        study = load_study(place / "study.toml")
        victims = [each.pid for each in cluster.workers.values()]
        with workers(1, cluster.scheduler_address) as (executor, ahead):

            def kill_one(done, count):
                if done and victims:
                    os.kill(victims.pop(), signal.SIGKILL)
                    victims.clear()

            Run(study).compute(executor=executor, ahead=ahead, progress=kill_one)
        assert not victims
    assert vary(place, "--resume") == 0
    assert (place / "table.csv").read_bytes() == whole


def test_a_cluster_that_does_not_answer_is_one_line(place, capsys, monkeypatch):
    monkeypatch.setattr("core.varying.space.CONNECT_TIMEOUT", 0.5)
    if importlib.util.find_spec("distributed") is None:
        assert vary(place, "--scheduler", "tcp://127.0.0.1:9") == 2
        assert "install the extra cluster" in capsys.readouterr().err
        return
    assert vary(place, "--scheduler", "tcp://127.0.0.1:9") == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "does not answer" in said


def test_what_stands_for_a_design_does_not_depend_on_its_neighbours(place):
    study = load_study(place / "study.toml")
    columns = Run(study).space.columns(890, 940)
    numbers = {path: column for path, column in columns.items() if column.dtype == float}
    every = many(study.base, numbers, ["pressure_angle_deg:max"]).value["pressure_angle_deg:max"]
    one = many(study.base, {path: column[7:8] for path, column in numbers.items()}, ["pressure_angle_deg:max"])
    assert every[7] == one.value["pressure_angle_deg:max"][0]
