"""The command clearance: its JSON, its table, exit codes, findings, and one line for wrong input."""

import csv
import json
from itertools import pairwise
from pathlib import Path

import pytest
from drawn_cams import drawn
from outlined import clearance, example, outline, slides

from core.__main__ import main
from core.project import dumps, load, loads, save

BAR = example("four_bar") + outline("link 2", round_mm=5.0)
WALL = outline("frame", points=[[-20.0, 60.0], [30.0, 60.0], [30.0, 100.0], [-20.0, 100.0]])


@pytest.fixture
def run(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    def command(text: str, *options: str) -> tuple[int, str, str]:
        path = tmp_path / "design.toml"
        path.write_text(text, "utf-8")
        code = main(["clearance", str(path), *options])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return command


def test_the_least_clearance_of_a_crank_and_a_wall(run) -> None:
    """The crank of 30 mm with a round end of 5 mm below a wall at 60 mm: 25 mm, upright."""
    code, out, _ = run(BAR + WALL, "--json")
    (row,) = json.loads(out)
    assert code == 0
    assert row["pair"] == ["link 2", "frame"]
    assert row["least_mm"] == pytest.approx(25.0, abs=1e-9)
    assert 24.999 <= row["at_least_mm"] <= 25.0
    assert row["cam_angle_deg"] == pytest.approx(90.0)
    assert row["points"] == [pytest.approx([0.0, 35.0]), pytest.approx([0.0, 60.0])]
    assert row["collides"] == []
    code, out, _ = run(BAR + WALL, "--json", "--tolerance", "1e-5")
    assert 24.99999 <= json.loads(out)[0]["at_least_mm"] <= 25.0


def test_exit_1_where_a_pair_is_nearer_than_it_may_be_or_meets(run) -> None:
    assert run(BAR + WALL, "--least", "24.9")[0] == 0
    code, out, _ = run(BAR + WALL, "--least", "25.1")
    assert code == 1
    assert "LESS than 25.1 mm" in out
    assert run(BAR + WALL + clearance("frame", "link 2", 26.0))[0] == 1
    code, out, _ = run(BAR + outline("frame", points=[[0.0, 30.0], [9.0, 30.0], [9.0, 40.0]]), "--json")
    assert code == 1
    (row,) = json.loads(out)
    assert (row["least_mm"], row["at_least_mm"]) == (0.0, 0.0)
    (begin, end), *_ = row["collides"]
    assert begin < 90.0 < end


def test_the_table_has_a_column_a_pair_by_driver_or_machine_angle(run, tmp_path: Path) -> None:
    out = tmp_path / "distances.csv"
    run(BAR + WALL + outline("link 4", round_mm=5.0), "--pair", "frame,link 2", "--out", str(out))
    rows = list(csv.reader(out.read_text("utf-8").splitlines()))
    assert rows[0] == ["driver_angle_deg", "link_2__frame_mm"]
    assert len(rows) == 3601
    assert float(rows[901][1]) == pytest.approx(25.0)
    run(slides(0.0, 100.0, 40.0), "--out", str(out))
    assert out.read_text("utf-8").startswith("machine_angle_deg,left_follower__right_follower_mm\n")


def test_export_has_the_table_and_the_extremes(run, tmp_path: Path) -> None:
    path, out = tmp_path / "slides.toml", tmp_path / "out"
    path.write_text(slides(0.0, 100.0, 40.0), "utf-8")
    assert main(["export", str(path), "--out", str(out), "--samples", "360"]) == 0
    values = [float(line.split(",")[1]) for line in (out / "clearance.csv").read_text("utf-8").splitlines()[1:]]
    extremes = json.loads((out / "summary.json").read_text("utf-8"))["extremes"]["left_follower__right_follower_mm"]
    assert len(values) == 360
    assert min(values) - 0.02 <= extremes["min"]["value"] <= min(values)
    assert max(values) <= extremes["max"]["value"] <= max(values) + 0.02


def test_check_reports_a_clearance_and_a_collision_with_their_remedies(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "slides.toml"
    path.write_text(slides(0.0, 100.0, 40.0) + clearance("left.follower", "right.follower", 20.0), "utf-8")
    assert main(["check", str(path)]) == 0
    warning = capsys.readouterr().out.splitlines()[0]
    assert warning.startswith("warning: left.follower and right.follower come within ")
    assert "they must keep 20 mm" in warning
    assert warning.endswith("[drives[1].phase_deg]")
    path.write_text(slides(0.0, 100.0, 10.0), "utf-8")
    assert main(["check", str(path)]) == 1
    assert capsys.readouterr().out.startswith("error: left.follower and right.follower meet at ")


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        (example("four_bar"), (), "outlines: the design has none"),
        (BAR, (), "outlines: no two bodies"),
        (BAR + WALL, ("--pair", "link 2,link 2"), "link 2 and link 2 are the same body; allowed: two of link 2 | frame"),
        (BAR + WALL, ("--pair", "link 2,link 3"), "'link 3' is no body with an outline; allowed: link 2 | frame"),
        (BAR + outline("link 9", round_mm=1.0), (), "outlines[1].of = 'link 9': unknown body"),
        (BAR + outline("frame", points=[[0.0, 0.0], [5.0, 0.0]]), (), "outlines[1].points = '2 points': the outline is open"),
        (
            BAR + outline("frame", points=[[0.0, 0.0], [5.0, 5.0], [5.0, 0.0], [0.0, 5.0]]), (),
            "outlines[1].points = '4 points': crosses itself",
        ),
        (BAR + outline("frame", file="missing.dxf"), (), "missing.dxf"),
        (
            example("four_bar") + outline("link 2", round_mm=5.0, layer_to_mm=5.0)
            + outline("frame", points=[[0.0, 60.0]], round_mm=1.0, layer_from_mm=5.0), (), "outlines: no two bodies",
        ),
        (BAR + WALL + clearance("link 2", "cam", 1.0), (), "clearances[0].between = 'cam': unknown body"),
        (BAR + WALL + clearance("link 2", "frame", -1.0), (), "clearances[0].least_mm = -1.0: outside its range"),
        (slides(0.0, 0.0, 9.0) + outline("follower", round_mm=1.0), (), "outlines[2].drive: missing"),
    ],
)  # fmt: skip
def test_wrong_input_is_one_line_and_exit_2(run, text: str, options: tuple[str, ...], message: str) -> None:
    code, out, err = run(text, *options)
    assert (code, out) == (2, "")
    assert message in err
    assert len(err.splitlines()) == 1


def test_a_drawing_gives_lines_and_arcs_wherever_it_is(run, tmp_path: Path) -> None:
    """A bar with a round end of 10 mm as DXF, far from the origin of its body, whose end passes the crank's pin by hand."""
    corners = [(200.0, 90.0), (240.0, 90.0), (240.0, 110.0), (200.0, 110.0)]
    lines = [("line", a, b) for a, b in pairwise(corners)]
    (tmp_path / "bar.dxf").write_bytes(drawn(*lines, ("arc", (200.0, 100.0), 10.0, 90.0, 270.0), unit=0))
    code, out, _ = run(BAR + outline("frame", file="bar.dxf"), "--json")
    (row,) = json.loads(out)
    assert code == 0
    assert row["least_mm"] == pytest.approx(abs(200.0 + 100.0j) - 30.0 - 5.0 - 10.0, abs=1e-3)


def test_a_saved_design_finds_its_drawing_from_another_folder(tmp_path: Path) -> None:
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
    (tmp_path / "first" / "bar.dxf").write_bytes(drawn(("circle", (100.0, 0.0), 10.0)))
    path = tmp_path / "first" / "design.toml"
    path.write_text(BAR + outline("frame", file="bar.dxf"), "utf-8")
    moved = tmp_path / "second" / "design.toml"
    save(load(path), moved)
    assert 'file = "../first/bar.dxf"' in moved.read_text("utf-8")
    assert main(["clearance", str(moved)]) == 0
    text = BAR + WALL + clearance("link 2", "frame", 3.0)
    assert loads(dumps(loads(text))) == loads(text)
