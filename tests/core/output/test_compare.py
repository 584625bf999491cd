"""Two designs held against each other: what differs, as text, JSON, CSV and page."""

import contextlib
import csv
import io
import json
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import pytest
from mechanisms import LIFT, with_cam, with_follower
from sampled import spread

from core import project
from core.__main__ import main
from core.design import Design, edited
from core.output.compare import Comparison, compare_designs, compared_design, comparison_csv, comparison_data
from core.study import Study

EXAMPLES = {path.stem: path for path in sorted((Path(__file__).parents[3] / "resources" / "examples").glob("*.toml"))}
WIDER = with_cam(LIFT, base_radius_mm=420.0)


def saved(folder: Path, name: str, design: Design) -> str:
    project.save(design, folder / name)
    return str(folder / name)


def held(one: Design, other: Design) -> Comparison:
    return compare_designs(compared_design(Study(one)), compared_design(Study(other)))


def said(*words: str) -> str:
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        assert main(["compare", *words]) == 0
    return out.getvalue()


def test_a_wider_cam_differs_in_one_input_and_the_results_are_those_of_either_design() -> None:
    found = held(LIFT, WIDER)
    assert [(row.quantity, row.a, row.b, row.change) for row in found.inputs] == [
        ("cam.base_radius_mm", 400.0, 420.0, pytest.approx(20.0))
    ]
    rows = {(row.quantity, row.of): row for row in found.results}
    radius = rows["radius_mm", "min"]
    assert (radius.a, radius.b) == (pytest.approx(400.0, abs=1e-9), pytest.approx(420.0, abs=1e-9))
    assert rows["displacement_mm", "max"].change == 0.0
    shares = [row.share for row in found.results]
    assert shares == sorted(shares, reverse=True)
    assert ("displacement_mm", "max") not in {(row.quantity, row.of) for row in found.changed}


def test_a_result_that_is_rounding_beside_its_size_is_shown_as_0() -> None:
    """The pressure angle of the rocker passes 0, but not on the wider cam."""
    rocker = project.load(EXAMPLES["rocker_cam"])
    found = held(rocker, with_cam(rocker, base_radius_mm=70.0))
    least = next(row for row in found.results if (row.quantity, row.of) == ("pressure_angle_deg", "min"))
    a, b, change = least.texts
    assert (a, b == change) == ("0", True)
    assert float(b) > 10.0


def test_a_mean_torque_that_is_rounding_has_not_changed() -> None:
    """Without friction the mean over the turn is 0, in digits that another base radius rounds otherwise."""
    rocker = project.load(EXAMPLES["rocker_cam"])
    for radius in (47.0, 50.0, 55.0):
        found = held(rocker, with_cam(rocker, base_radius_mm=radius))
        assert "mean_torque_nm" not in {row.quantity for row in found.changed}


def test_a_couple_on_a_guide_that_nothing_turns_has_not_changed() -> None:
    """It is rounding beside the torque of the cam."""
    picker = project.load(EXAMPLES["card_picker"])
    found = held(picker, with_cam(picker, base_radius_mm=70.0))
    (texts,) = {row.texts for row in found.results if row.quantity == "guide_couple_nm"}
    assert texts == ("0", "0", "0")
    assert "guide_couple_nm" not in {row.quantity for row in found.changed}


def test_findings_that_come_and_go_are_told_apart() -> None:
    sharp = with_cam(LIFT, base_radius_mm=150.0)
    there, back = held(LIFT, sharp), held(sharp, LIFT)
    assert there.new
    assert [each.code for each in there.new] == [each.code for each in back.gone]
    assert not {each.code for each in there.gone} & {each.code for each in there.new}


def test_a_design_is_the_same_as_itself_and_says_so(tmp_path: Path) -> None:
    file = saved(tmp_path, "a.toml", LIFT)
    assert said(file, file).endswith("The designs and their results are the same.\n")
    rows = json.loads(said(file, file, "--json"))
    assert rows["inputs"] == []
    assert rows["findings"] == {"gone": [], "new": []}
    assert all(row["change"] in (0.0, None) for row in rows["results"])


PAIRS = [
    pytest.param(["transfer_lift", "four_bar"], id="cam and linkage"),
    pytest.param(["tappet_flat", "groove"], id="faces and forms"),
    pytest.param(["transfer_unit", "transfer_lift"], id="camshaft and cam", marks=pytest.mark.stress),
    pytest.param(sorted(EXAMPLES), id="all", marks=pytest.mark.fuzz),
]


@pytest.mark.parametrize("names", spread(PAIRS, 1))
def test_any_two_examples_are_compared_by_what_both_have(names: list[str]) -> None:
    sides = [compared_design(Study(project.load(EXAMPLES[name]))) for name in names]
    for one, other in combinations(sides, 2):
        rows, back = comparison_data(compare_designs(one, other)), comparison_data(compare_designs(other, one))
        assert {row["path"] for row in rows["inputs"]} == {row["path"] for row in back["inputs"]} != set()
        changes = {(row["quantity"], row["of"]): row["change"] for row in rows["results"]}
        for row in back["results"]:
            change = changes[row["quantity"], row["of"]]
            assert change is None if row["change"] is None else change == -row["change"]


def test_the_table_holds_inputs_results_and_findings_and_the_page_stands_alone(tmp_path: Path) -> None:
    files = saved(tmp_path, "a.toml", LIFT), saved(tmp_path, "b.toml", replace(WIDER, name="<b>wider</b>"))
    said(*files, "--out", str(tmp_path / "c.csv"))
    said(*files, "--out", str(tmp_path / "c.html"))
    text = (tmp_path / "c.csv").read_text("utf-8")
    assert text == comparison_csv(held(*(project.load(Path(file)) for file in files)))
    table = list(csv.DictReader(io.StringIO(text)))
    assert {
        "what": "input",
        "quantity": "cam.base_radius_mm",
        "of": "",
        "a": "400.0",
        "b": "420.0",
        "change": "20.0",
    } in table
    assert {row["what"] for row in table} >= {"input", "result"}
    page = (tmp_path / "c.html").read_text("utf-8")
    assert "cam.base_radius_mm" in page
    assert "<b>wider</b>" not in page
    assert "http" not in page.replace("http://www.w3.org", "")


def test_what_was_typed_is_shown_as_it_was_typed(tmp_path: Path) -> None:
    """Whole numbers without decimals, lengths with all of theirs, lists to their end; computed results with the digits that matter."""
    longer = with_follower(LIFT, slider_arm_mm=1302.1625)
    fields = ("loads.slider_mass_kg", "loads.friction", "follower.rod_mm")
    files = saved(tmp_path, "a.toml", LIFT), saved(tmp_path, "b.toml", replace(longer, assumed=fields))
    text = said(*files)
    rows = {line.split()[0]: line.split()[1:] for line in text.splitlines()}
    assert rows["follower.slider_arm_mm"] == ["1302.162", "1302.1625", "0.0005"]
    assert f"  b: {', '.join(fields)}\n" in text
    wider = said(files[0], saved(tmp_path, "c.toml", WIDER)).splitlines()
    assert next(line.split() for line in wider if line.startswith("cam.base_radius_mm"))[1:] == ["400", "420", "20"]


def test_the_text_holds_the_twenty_results_that_moved_most_and_the_data_all(tmp_path: Path) -> None:
    files = saved(tmp_path, "a.toml", LIFT), saved(tmp_path, "b.toml", WIDER)
    changed = held(LIFT, WIDER).changed
    assert len(changed) > 20
    lines = said(*files).splitlines()
    rows = [tuple(line.split()[:2]) for line in lines if line.split()[1:2] in (["max"], ["min"])]
    assert rows == [(row.quantity, row.of) for row in changed if row.of][: len(rows)]
    totals = [row for row in changed[:20] if not row.of]
    assert len(rows) + len(totals) == 20
    assert f"{len(changed) - 20} more results changed less" in lines[-1]
    assert len(json.loads(said(*files, "--json"))["results"]) == len(held(LIFT, WIDER).results)


def test_a_change_is_given_in_percent_where_that_says_more() -> None:
    """Not for lengths and angles, nor beside a value that is small or changes its sign."""
    longer = replace(LIFT, name="a longer lift")
    longer = edited(longer, "motion.stroke_mm", 200.0)
    rows = {(row.quantity, row.of): row for row in held(LIFT, longer).results}
    assert rows["velocity_mm_s", "max"].percent == pytest.approx(100.0 / 3.0)
    assert rows["velocity_mm_s", "min"].percent == pytest.approx(-100.0 / 3.0)
    assert rows["displacement_mm", "max"].percent is None
    assert rows["pressure_angle_deg", "max"].percent is None
    assert rows["pivot_x_n", "max"].a < 0.0 < rows["pivot_x_n", "max"].b
    assert rows["pivot_x_n", "max"].percent is None


def test_of_two_files_the_one_without_an_answer_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, b = saved(tmp_path, "a.toml", LIFT), saved(tmp_path, "b.toml", with_follower(LIFT, slider_arm_mm=100.0))
    for files in ((a, b), (b, a)):
        assert main(["compare", *files]) == 2
        assert capsys.readouterr().err.startswith(f"{b}: ")


def test_what_cannot_be_compared_is_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, b = saved(tmp_path, "a.toml", LIFT), saved(tmp_path, "b.toml", WIDER)
    assert main(["compare", a, b, "--out", b]) == 2
    assert "allowed endings: .csv, .html" in capsys.readouterr().err
    assert main(["compare", a, str(tmp_path / "gone.toml")]) == 2
    assert "gone.toml" in capsys.readouterr().err
