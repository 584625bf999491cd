"""The chapter of a valve train in text, HTML and the hand-over: the figures of the command ``valve``."""

import json
import re
from pathlib import Path

import pytest

from core.__main__ import main
from core.output.report import report
from core.output.report.document import document, html
from core.output.report.parts import Number, ReportTable
from core.project import load, loads
from core.study import Study
from kindyna_gui.__main__ import main as window_main
from kindyna_gui.places import example

DRIVE = """[[drives]]
name = "{name}"
[drives.motion]
start_mm = 0.0
[drives.motion.lobe]
lift_mm = 9.0
duration = [[0.1524, 268.0], [1.27, 218.0]]
[drives.follower]
kind = "translating"
face = "flat"
[drives.cam]
base_radius_mm = 18.0
[drives.valve]
centre_deg = {centre}
lash_mm = {lash}
[drives.loads]
follower_mass_kg = 0.14
spring_rate_n_per_mm = 30.0
preload_n = 300.0
"""
HEAD = 'format = 1\nname = "Head"\n[shaft]\nrotation = "ccw"\nspeed_rpm = 3000.0\n[engine]\nstroke_mm = 84.0\nrod_mm = 138.0\n'
TEXT = HEAD + DRIVE.format(name="Inlet", centre=108.5, lash=0.1) + DRIVE.format(name="Exhaust", centre=-112.5, lash=0.0)


@pytest.fixture(scope="module")
def head(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("head") / "head.toml"
    path.write_text(TEXT, encoding="utf-8")
    return path


def card(path: Path, capsys: pytest.CaptureFixture[str]) -> dict:
    assert main(["valve", str(path), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def tables(path: Path) -> dict[str, ReportTable]:
    sections = document(Study(load(path)), []).sections
    (first,) = (i for i, part in enumerate(sections) if part.title == "Valve train")
    rest = next(i for i in range(first + 1, len(sections)) if sections[i].level == 1)
    return {
        block.slug: block for part in sections[first:rest] for block in part.blocks if isinstance(block, ReportTable)
    }


def numbers(table: ReportTable, label: str) -> list[float]:
    (row,) = (row for row in table.rows if row[0] == label)
    return [
        float(cell.value or 0.0) if isinstance(cell, Number) else float(cell.replace("−", "-")) for cell in row[1:-1]
    ]


def test_the_figures_are_those_of_the_command(head: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data, chapter = card(head, capsys), tables(head)
    valves = chapter["valves"]
    assert valves.header == ("", "Inlet", "Exhaust", "")
    for label, key in (
        ("lobe centre", "centre_deg"),
        ("lash", "lash_mm"),
        ("valve lift", "valve_lift_mm"),
        ("valve lift at TDC", "lift_at_tdc_mm"),
        ("seating velocity", "seating_velocity_mm_s"),
        ("float speed of the engine", "float_rpm"),
    ):
        assert numbers(valves, label) == [valve[key] for valve in data["valves"]], label
    assert numbers(valves, "greatest velocity") == [valve["velocity_mm_per_deg"][1] for valve in data["valves"]]
    pairs = {str(row[1]): row[2] for row in chapter["valve_pairs"].rows}
    assert [pairs[key].value for key in ("separation, cam °", "advance, cam °")] == [110.5, 2.0]
    assert pairs["overlap area, mm·crank °"].value == data["pairs"][0]["overlap_area_mm_deg"]


def test_the_events_are_those_of_a_card(head: Path) -> None:
    """268° about 108.5° is 25.5/62.5; without a lash valve and lobe open together."""
    rows = [tuple(map(str, row)) for row in tables(head)["valve_events"].rows]
    assert ("Inlet", "lobe", "0.1524", "25.50 BTDC", "62.50 ABDC", "268.0") in rows
    assert ("Exhaust", "lobe, valve", "1.27", "41.50 BBDC", "3.50 BTDC", "218.0") in rows
    assert [row[1] for row in rows if row[0] == "Inlet"] == ["lobe", "valve"] * 3
    assert [row[1] for row in rows if row[0] == "Exhaust"] == ["lobe, valve"] * 3


@pytest.mark.stress
def test_text_page_and_handover_have_the_chapter(head: Path, tmp_path: Path) -> None:
    study = Study(load(head))
    text = report(study)
    assert re.search(r"^Valve train\n-----------\n", text, re.MULTILINE)
    assert "66.00 BBDC" in text or "66.50 BBDC" in text
    page = html(document(study), {})
    assert 'data-table="valve_events"' in page
    assert window_main(["--headless", "handover", str(head), "--out", str(tmp_path / "out")]) == 0
    handed = [path.read_text("utf-8") for path in (tmp_path / "out").rglob("*.html")]
    assert any("Valve events, crank degrees" in page for page in handed)


def test_a_design_without_valves_has_no_such_chapter() -> None:
    bare = re.sub(r"\[drives\.valve\]\ncentre_deg = \S+\nlash_mm = \S+\n", "phase_deg = 10.0\n", TEXT)
    bare = bare.replace('name = "Inlet"\n', 'name = "Inlet"\nphase_deg = 0.0\n').replace("phase_deg = 10.0\n", "")
    bare = bare.replace('name = "Exhaust"\n', 'name = "Exhaust"\nphase_deg = 90.0\n')
    sections = document(Study(loads(bare)), []).sections
    assert "Valve train" not in [part.title for part in sections]


def test_springs_and_piston_clearance_are_in_the_chapter(capsys: pytest.CaptureFixture[str]) -> None:
    path = example("valve_train")
    data, chapter = card(path, capsys), tables(path)
    inlet, exhaust = data["valves"]
    both = [valve["clearance"]["least_mm"] for valve in (inlet, exhaust)]
    assert numbers(chapter["valves"], "least clearance to the piston") == both
    springs = [spring for valve in (inlet, exhaust) for spring in valve["springs"]]
    table = chapter["valve_springs"]
    assert numbers(table, "rate") == [spring["rate_n_per_mm"] for spring in springs]
    assert numbers(table, "travel left to coil bind") == [spring["bind_mm"] for spring in springs]
    assert numbers(table, "corrected stress, at the greatest lift") == [spring["stress_mpa"][1] for spring in springs]
