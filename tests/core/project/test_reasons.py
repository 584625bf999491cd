"""Why values of the examples are what they are: resources/reasons.toml, by path and value, in the report."""

from dataclasses import replace
from pathlib import Path

import pytest

from core.design import all_paths, put
from core.output.report import report
from core.output.report.parts import ReportTable
from core.output.report.sections import table_sections
from core.project import load
from core.project.reading_faults import reason, reasons, reasons_of
from core.study import Study

EXAMPLES = {
    path.stem: load(path) for path in sorted((Path(__file__).parents[3] / "resources" / "examples").glob("*.toml"))
}
OF_PAPERS = ("transfer_lift", "card_picker", "card_picker_peak_250", "dwell_rise_dwell", "kim_1990", "rear_suspension", "lecture_six_bar",
             "slider_crank")  # fmt: skip


@pytest.mark.parametrize("name", OF_PAPERS)
def test_every_assumed_value_of_a_papers_example_has_its_reason(name: str) -> None:
    design = EXAMPLES[name]
    assert [path for path in design.assumed if not reason(design, path)] == []


def test_every_reason_is_about_a_value_of_an_example() -> None:
    used = {(path, text) for design in EXAMPLES.values() for path, text in reasons_of(design)}
    assert {row.text for row in reasons()} == {text for _, text in used}


def test_a_reason_holds_for_its_value_alone() -> None:
    """16.588 is the printed 1691.509 as kgf·mm·s²; any other inertia is the user's own."""
    lift, path = EXAMPLES["transfer_lift"], "loads.arm_inertia_kg_m2"
    assert "1691.509" in reason(lift, path)
    assert reason(put(lift, path, 17.0), path) == ""
    assert reason(replace(lift, name="My lift"), path) == ""
    unit = EXAMPLES["transfer_unit"]
    assert reason(unit, "drives[2].loads.arm_inertia_kg_m2") == reason(lift, path)
    assert reason(unit, "drives[0].loads.arm_inertia_kg_m2") == ""
    assert {path for path, _ in reasons_of(lift)} <= set(all_paths(lift))


def test_the_report_says_why() -> None:
    text = report(Study(EXAMPLES["lecture_six_bar"], 8))
    assert "requires 6.897436 cm" in text
    text = report(Study(EXAMPLES["card_picker"], 8))
    assert text.count("Yang has no forces.") == 1, "one line for all values with one reason"
    assert "Span of segment 2, span of segment 3" in text


def test_a_reason_of_many_values_stands_once_in_a_table_and_a_place_is_marked_by_both_its_coordinates() -> None:
    (loads,) = table_sections(EXAMPLES["lecture_six_bar"], ["loads"], why=True)
    rows = [row for block in loads.blocks if isinstance(block, ReportTable) for row in block.rows]
    marked = [row for row in rows if row[3] == "*"]
    assert (
        [row[0] for row in marked].count("Centre of mass x")
        == [row[0] for row in marked].count("Centre of mass y")
        == 3
    )
    assert "flat steel bars" in str(marked[0][4])
    assert {row[4] for row in marked[1:]} == {"as above"}
