"""core.output.graph and the command ``graph``: columns of tables and designs, units, differences, values read off, bad tables."""

import contextlib
import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.__main__ import main
from core.errors import KindynaError
from core.output.graph import (
    DesignSource,
    Graph,
    GraphCurve,
    Source,
    TableSource,
    add_curve,
    angle_marks,
    copy_curve,
    from_data,
    graph_data,
    move_curve,
    read_numbers,
    ready_graphs,
    remove_curve,
    to_data,
    unit_of_column,
    with_curve,
)
from core.output.graph.model import load_setup, save_setup
from core.project import load

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
LIFT, UNIT = EXAMPLES / "transfer_lift.toml", EXAMPLES / "transfer_unit.toml"


def run(*words: object) -> tuple[int, str, str]:
    """The command in this process: exit code, what it printed, its faults."""
    out, faults = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(faults):
        code = main(["graph", *map(str, words)])
    return code, out.getvalue(), faults.getvalue()


def file(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.write_text(text, "utf-8")
    return path


def rows(*lines: object) -> str:
    return "".join(f"{line}\n" for line in lines)


def test_a_difference_stands_at_every_x_of_either_in_the_units_of_the_first(tmp_path: Path) -> None:
    """x² sampled coarsely less 1000·x, in kN over rad, sampled elsewhere: by hand."""
    one = file(tmp_path, "one.csv", rows("angle_deg,force_n", "0,0", "90,8100", "180,32400"))
    other = file(
        tmp_path,
        "other.csv",
        rows("a [rad];F [kN]", *(f"{float(np.deg2rad(x))!r};{x!r}" for x in (-45.0, 45.0, 135.0))),
    )
    out = tmp_path / "out.csv"
    code, said, faults = run(
        one,
        other,
        "--curve",
        "force_n",
        "--curve",
        "file=2,y=2",
        "--curve",
        "force_n,minus=2",
        "--out",
        out,
        "--at",
        90,
        "--to",
        120,
    )
    assert (code, faults) == (0, "")
    table = np.genfromtxt(out, delimiter=",", names=True)
    assert table.dtype.names == ("angle_deg", "force_one_n", "f_other_n", "force_one_minus_f_other_n"), (
        "units that read back"
    )
    np.testing.assert_allclose(table["angle_deg"], [-45, 0, 45, 90, 135, 180])
    np.testing.assert_allclose(table["f_other_n"], [-45e3, 0.0, 45e3, 90e3, 135e3, np.nan], atol=1e-9)
    apart = [np.nan, 0.0, 4050 - 45e3, 8100 - 90e3, 20250 - 135e3, np.nan]
    np.testing.assert_allclose(table["force_one_minus_f_other_n"], apart, atol=1e-9)
    assert "Force, one: 8100 N at 90 °, 16\u202f200 N at 120 °; Δx 30, Δy 8100, slope 270" in said


def test_a_design_less_its_own_export_is_nothing_and_shifted_speed_is_seen(tmp_path: Path) -> None:
    study = DesignSource(load(LIFT))
    x, y = study.values("", ("cam_angle_deg", "velocity_mm_s"))
    lines = (f"{a!r},{v * 1e-3 + 0.25!r}" for a, v in zip(x.tolist(), y.tolist(), strict=True))
    table = file(tmp_path, "v.csv", rows("cam_angle_deg,velocity_m_s", *lines))
    code, said, _ = run(
        LIFT,
        table,
        "--json",
        "--curve",
        "velocity",
        "--curve",
        "file=2,y=2,unit=m/s",
        "--curve",
        "velocity,minus=2",
        "--at",
        63.2,
    )
    assert code == 0
    own, measured, difference = json.loads(said)["curves"]
    assert own["unit"] == measured["unit"] == difference["unit"] == "mm/s", "one axis has one unit"
    assert measured["y"] - own["y"] == pytest.approx(250.0, abs=1e-9)
    assert difference["y"] == pytest.approx(-250.0, abs=1e-9)


def test_every_drive_and_the_shaft_of_several(tmp_path: Path) -> None:
    code, said, faults = run(
        UNIT,
        "--json",
        "--at",
        100,
        "--curve",
        "drive_torque,drive=(all),x=machine_angle_deg",
        "--curve",
        "torque,drive=(shaft)",
        "--curve",
        "torque,drive=Nobody",
    )
    assert code == 1
    assert "has no drive 'Nobody'" in faults
    *drives, shaft = json.loads(said)["curves"]
    assert len(drives) > 2
    assert sum(each["y"] for each in drives) == pytest.approx(shaft["y"], rel=1e-3), "linear between samples"


MODIFIED_SINE = 4.0 * np.pi / (np.pi + 4.0)
"""Peak velocity of a modified sine by its mean velocity."""


def test_the_path_of_the_transfer_and_the_speed_along_it(tmp_path: Path) -> None:
    """Rises by hand: a lever of 500 mm by 24°, 40 mm and 150 mm, at 120° a second; one drive at a time, so the speed is that one's."""
    out = tmp_path / "path.csv"
    assert run(UNIT, "--ready", "path", "--out", out)[0] == 0
    path = np.genfromtxt(out, delimiter=",", names=True)
    assert path.dtype.names == ("feed_travel_mm", "clamp_over_feed_mm", "lift_over_feed_mm")
    feed, clamp, lift = (path[name] for name in path.dtype.names)
    forwards = 500.0 * np.deg2rad(24.0)
    assert [(c.min(), c.max()) for c in (feed, clamp, lift)] == [
        pytest.approx((0.0, h), abs=1e-9) for h in (forwards, 40.0, 150.0)
    ]
    between = (feed > 1e-6) & (feed < forwards - 1e-6)
    high = np.deg2rad(np.arange(feed.size) * 360.0 / feed.size)
    ahead = between & (np.cos(high) > 0.0)  # the feed goes forwards around 0°, back around 180°
    np.testing.assert_allclose(lift[ahead], 150.0)
    np.testing.assert_allclose(lift[between & ~ahead], 0.0, atol=1e-9)
    code, said, _ = run(UNIT, "--ready", "speed", "--json", "--at", 0, "--to", 55.8)
    assert code == 0
    speed = json.loads(said)["curves"][0]
    assert speed["y"] == pytest.approx(MODIFIED_SINE * forwards / (64.0 / 120.0), rel=1e-6)
    assert speed["to_y"] == pytest.approx(MODIFIED_SINE * 150.0 / (41.5 / 120.0), rel=1e-4)


def test_how_the_wheel_moves_with_its_height_and_what_is_not_ready() -> None:
    code, said, _ = run(EXAMPLES / "rear_suspension.toml", "--ready", "height:W", "--json", "--at", 0)
    along, turned = json.loads(said)["curves"]
    assert (code, along["unit"], turned["unit"]) == (0, "mm", "°")
    there = DesignSource(load(EXAMPLES / "rear_suspension.toml"))
    x, y, angle = there.values("", ("W_x_mm", "W_y_mm", "link3_deg"))
    nearest = int(np.abs(y).argmin())
    assert (along["y"], turned["y"]) == pytest.approx((x[nearest], angle[nearest]))
    for file, name, words in ((LIFT, "path", "none"), (UNIT, "path:W", "path, speed")):
        code, _, fault = run(file, "--ready", name)
        assert code == 2
        assert f"--ready {name}: {file.stem} has no such graph; allowed: {words}" in fault


def test_angles_along_a_path_stand_once_at_each_place() -> None:
    source: Source = DesignSource(load(UNIT))
    rows = {each.name: each.graph for each in ready_graphs(source)}
    clamp, lift = graph_data(rows["path"], lambda _: source).series
    marked = {text: (x, y) for x, y, text in angle_marks(lift)}
    assert marked["90-120°"] == pytest.approx((500.0 * np.deg2rad(24.0), 0.0), abs=1e-6)
    assert marked["0°"] == pytest.approx((500.0 * np.deg2rad(12.0), 150.0), abs=1e-6)
    assert [text for *_, text in angle_marks(clamp)][:2] == ["0°", "30-90°"]
    assert len(marked) < 12


@pytest.mark.parametrize(
    ("header", "first", "says"),
    [
        ("Cam angle;Lift;Force\n[deg];[mm];[kN]", "lift_t_mm,force_t_kn", "cam_angle_deg"),
        ("Cam angle;Lift;Force\ndeg;mm;N", "lift_t_mm,force_t_n", "cam_angle_deg"),
        ("Winkel °;Hub in mm;Hub mm", "hub_t_mm,2_hub_t_mm", "winkel_deg"),
        ("angle_deg;lift_mm;lift_mm", "column_2_lift_t_mm,column_3_lift_t_mm", "angle_deg"),
    ],
)
def test_names_and_units_stand_above_a_column_in_one_line_or_two(
    tmp_path: Path, header: str, first: str, says: str
) -> None:
    table, out = file(tmp_path, "t.csv", f"{header}\n0;1;2\n1;2;3\n"), tmp_path / "out.csv"
    assert run(table, "--out", out)[0] == 0
    assert out.read_text("utf-8").splitlines()[0] == f"{says},{first}"


def test_a_column_with_a_value_in_every_tenth_row_is_joined_and_says_so(tmp_path: Path) -> None:
    lines = (f"{i},{i},{3 * i if i % 10 == 0 else ''}" for i in range(201))
    code, said, faults = run(file(tmp_path, "slow.csv", rows("t,a,b", *lines)), "--curve", "b", "--at", 25)
    assert (code, said) == (0, "B, slow: 75 at 25\n")
    assert "B has values in 21 of 201 rows, all isolated: joined across the gaps" in faults


@pytest.mark.parametrize("entry", ['"width": -5, "colour": "red"', '"side": "up", "dash": 3', '"width": NaN'])
def test_a_setup_with_entries_that_cannot_be_is_drawn_with_the_usual_ones(tmp_path: Path, entry: str) -> None:
    file(tmp_path, "t.csv", "x,y\n0,1\n1,2\n")
    row = f'{{"key": "1", "source": "t.csv", {entry}}}'
    setup = file(tmp_path, "a.graph.json", f'{{"curves": [{row}], "x": {{"low": NaN, "high": 1e999}}}}')
    graph = load_setup(setup)
    assert graph.x == Graph().x
    assert replace(graph.curves[0], key="", source="") == GraphCurve()
    assert run("--setup", setup, "--at", 0.5)[:2] == (0, "Y, t: 1.5 at 0.5\n")
    assert (
        run("--setup", file(tmp_path, "b.graph.json", '{"curves": []}'))[2]
        == "b.graph.json: has no curve that is shown\n"
    )


@pytest.mark.parametrize(
    ("text", "values", "note"),
    [
        ("x,y\n1,2\n2,abc\n3,4\n", [2, np.nan, 4], "y, line 3: 'abc': not a number, omitted"),
        ("x,y\n1,2\n2\n3,4\n", [2, np.nan, 4], "line 3 has 1 of 2 columns: further columns have a gap"),
        ("x,y,z\n1,2,3\n2,,3\n3,,3\n", [2, np.nan, np.nan], "y: empty in lines 3-4, a gap"),
        ("1;2,5\n2;3,5\n", [2.5, 3.5], "no header: columns are named by their numbers"),
        ("x,y\n1,2\n2,3,9\n", [2, 3], "line 3: more than 2 columns; further cells are omitted"),
    ],
)
def test_what_is_wrong_in_a_table_leaves_a_gap_and_a_line(text: str, values: list[float], note: str) -> None:
    table = read_numbers(text.encode(), "t.csv")
    np.testing.assert_array_equal(table.values[1], values)
    assert table.notes == (note,)


def test_a_long_table_is_read_whole_with_progress_and_its_wrong_rows_named() -> None:
    lines = [f"{i},{2 * i}" for i in range(50_000)]
    lines[30_000] = "30000,broken"
    seen: list[float] = []
    table = read_numbers(("x,y\n" + "\n".join(lines)).encode(), "long.csv", seen.append)
    assert table.values.shape == (2, 50_000)
    assert np.flatnonzero(np.isnan(table.values[1])).tolist() == [30_000]
    assert table.notes == ("y, line 30002: 'broken': not a number, omitted",)
    assert seen == sorted(seen)
    assert len(seen) > 2


def test_a_name_that_a_spreadsheet_would_compute_is_read_back_as_it_was(tmp_path: Path) -> None:
    table = file(tmp_path, "t.csv", rows("angle_deg,force_n", "0,1", "90,2", "180,4"))
    assert run(table, "--curve", "y=force_n,name==cmd|calc!a0", "--out", tmp_path / "out.csv")[0] == 0
    first, *_ = (tmp_path / "out.csv").read_text("utf-8").splitlines()
    assert first.split(",")[1].startswith("'=cmd|calc!a0")
    assert read_numbers((tmp_path / "out.csv").read_bytes(), "out.csv").names[1] == first.split(",")[1].removeprefix(
        "'"
    )


@pytest.mark.stress
def test_of_very_many_columns_those_that_are_named_are_drawn(tmp_path: Path) -> None:
    wide = file(
        tmp_path,
        "wide.csv",
        rows(",".join(f"c{i}_mm" for i in range(16_000)), *(",".join([str(i)] * 16_000) for i in range(4))),
    )
    code, out, faults = run(wide, "--out", tmp_path / "all.csv")
    assert (code, out, faults) == (
        2,
        "",
        "15999 curves are too many for one graph; allowed: 200; choose some with --curve\n",
    )
    code, out, _ = run(wide, "--curve", "c15999_mm", "--curve", "7", "--at", 2)
    assert (code, out.splitlines()) == (0, ["C15999, wide: 2 mm at 2 mm", "C6, wide: 2 mm at 2 mm"])


def test_what_cannot_be_drawn_is_a_line_and_loses_nothing_else(tmp_path: Path) -> None:
    table = file(tmp_path, "t.csv", rows("x [s],y", "0,1", "1,2"))
    gone, out = tmp_path / "gone.csv", tmp_path / "no" / "out.csv"
    code, _, faults = run(
        LIFT,
        table,
        gone,
        "--curve",
        "velocity",
        "--curve",
        "nothing",
        "--curve",
        "y,file=2",
        "--curve",
        "file=3,y=2",
        "--curve",
        "velocity,minus=2",
    )
    assert code == 1
    assert [line[:9] for line in faults.splitlines()] == ["curve 2: ", "curve 3: ", "curve 4: ", "curve 5: "]
    assert "no column 'nothing'" in faults
    assert "x is in s, that of the first curve in °" in faults
    assert "gone.csv" in faults
    code, _, faults = run(LIFT, "--curve", "velocity", "--out", out)
    assert (code, faults.count("\n")) == (2, 1)
    code, _, faults = run(LIFT, "--curve", "velocity", "--out", tmp_path / "p.png")
    assert (code, faults) == (2, "p.png: pictures need kindyna --headless; a table (.csv) does not\n")
    code, _, faults = run(file(tmp_path, "words.csv", "no numbers\nat all\n"))
    assert (code, faults.count("\n")) == (2, 1)


def test_rows_are_copied_moved_and_removed_and_name_each_other(tmp_path: Path) -> None:
    graph = add_curve(add_curve(Graph(title="T"), GraphCurve(y="velocity_mm_s", width=2.0)), GraphCurve(y="jerk_mm_s3"))
    first, second = (curve.key for curve in graph.curves)
    graph = with_curve(copy_curve(graph, 0), 1, GraphCurve(y="velocity_mm_s", minus=second))
    graph = move_curve(graph, 1, 2)
    assert [curve.minus for curve in graph.curves] == ["", "", second]
    with pytest.raises(KindynaError, match="minus leads back to itself"):
        with_curve(graph, 1, GraphCurve(y="jerk_mm_s3", minus=graph.curves[2].key))
    assert from_data(json.loads(json.dumps(to_data(graph)))) == graph
    older = {"curves": [{"key": "c1", "width": "wide", "dash": "wavy", "y": "a"}, 7], "x": 3}
    assert from_data(older) == Graph(curves=(GraphCurve("c1", y="a"),))
    shorter = remove_curve(graph, 1)
    source: Source = DesignSource(load(LIFT))
    found = graph_data(shorter, lambda name: source)
    assert [each.key for each in found.series] == [first]
    assert "has been removed" in found.faults[graph.curves[2].key]
    file(tmp_path, "t.csv", "x,y\n1,2\n2,3\n")
    saved = add_curve(shorter, GraphCurve(source=str(tmp_path / "t.csv"), y="2"))
    save_setup(saved, tmp_path / "a.graph.json")
    assert '"source": "t.csv"' in (tmp_path / "a.graph.json").read_text("utf-8"), (
        "the files of a folder that moves stay together"
    )
    assert load_setup(tmp_path / "a.graph.json") == saved
    code, said, _ = run(LIFT, "--setup", tmp_path / "a.graph.json", "--curve", "jerk", "--json")
    assert code == 1, "a curve that was removed is still subtracted"
    assert [row["name"] for row in json.loads(said)["curves"]] == ["Velocity", "Y, t", "Jerk, transfer_lift"]
    assert found.faults.keys() == {graph.curves[2].key}
    code, _, faults = run("--setup", tmp_path / "a.graph.json")
    assert (code, faults) == (2, "a.graph.json: has curves of the current design; give the file of a design\n")


def test_axes_by_unit_and_a_profile_over_itself(tmp_path: Path) -> None:
    table = TableSource(read_numbers(b"x_mm,y_mm,f_n,g_kn,e_j\n3,1,2,3,4\n1,1,2,3,4\n2,5,6,7,8\n", "t.csv"))
    graph = Graph()
    for name in ("y_mm", "f_n", "g_kn", "e_j"):
        graph = add_curve(graph, GraphCurve(y=name))
    found = graph_data(graph, lambda name: table)
    axes = [(axis.side, axis.unit, axis.series) for axis in found.axes]
    assert axes == [("left", "mm", (0,)), ("right", "N", (1, 2)), ("right", "J", (3,))]
    np.testing.assert_array_equal(found.series[2].y, [3000.0, 3000.0, 7000.0])
    assert not found.series[0].is_ordered
    with_minus = with_curve(graph, 0, GraphCurve(y="y_mm", minus=graph.curves[1].key))
    assert "x decreases" in graph_data(with_minus, lambda name: table).faults[graph.curves[0].key]


@pytest.mark.parametrize(
    ("name", "unit"),
    [("force_n", "N"), ("Force [kN]", "kN"), ("speed_rpm", "rpm"), ("w (rad/s)", "rad/s"), ("a [m/s^2]", "m/s²"), ("T [Nm]", "N·m"),
     ("x", ""), ("Temperature [K]", "K"), ("kappa_per_mm", "1/mm"), ("lift (um)", "µm")],
)  # fmt: skip
def test_units_are_read_off_names(name: str, unit: str) -> None:
    assert unit_of_column(name) == unit
