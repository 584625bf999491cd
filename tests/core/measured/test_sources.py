"""core.measured: units, columns and lines of a table as they are typed, and tables of many rows."""

import json
import re
import subprocess
import sys
import tracemalloc
import zipfile
from pathlib import Path

import numpy as np
import pytest
from measured_tables import position, workbook
from mechanisms import levels
from sampled import spread

from core.__main__ import main
from core.measured import TableError, fit, layout, read_sheet, read_table

LIFT = levels(
    0.0, (60.0, 0.0, "dwell"), (80.0, 9.0, "4-5-6-7"), (60.0, 9.0, "dwell"), (100.0, 0.0, "3-4-5"), (60.0, 0.0, "dwell")
)
ANGLES = np.arange(0.0, 360.0)


def text(angles: np.ndarray, values: np.ndarray, header: str, form: str = "{:.10g},{:.10g}") -> str:
    rows = zip(angles.tolist(), values.tolist(), strict=True)
    return "\n".join([header, *(form.format(*row) for row in rows)])


def told(path: Path, capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, object]:
    assert main(["measured", str(path), "--json", *words]) == 0
    answer: dict[str, object] = json.loads(capsys.readouterr().out)
    return answer


SOURCES = {
    "1e-4 in": (text(ANGLES, np.round(position(LIFT, ANGLES) / 25.4e-4), "angle,lift (1e-4 in)"), []),
    "thou, crank degrees": (text(2.0 * ANGLES, position(LIFT, ANGLES) / 0.0254, "angle [deg],lift [thou]"), ["--half"]),
    "counts": (text(np.arange(0.0, 2048.0, 8.0), position(LIFT, np.arange(0.0, 2048.0, 8.0) * 360.0 / 2048.0), "n,lift [mm]"),
               ["--counts", "2048"]),
    "descending": (text(ANGLES[::-1], position(LIFT, ANGLES[::-1]), "angle [deg],lift [mm]"), []),
    "wrapped, last row repeated": (
        text(np.arange(-180.0, 181.0), position(LIFT, np.arange(-180.0, 181.0)), "angle [deg],lift [mm]"), []
    ),
    "two turns": (text(np.arange(720.0), position(LIFT, np.arange(720.0)), "angle [deg],lift [mm]"), []),
    "text above": ("Lobe 3, intake\nBase circle: 34 mm\n\n" + text(ANGLES, position(LIFT, ANGLES), "Deg\tLift mm", "{:g}\t{:.6f}"), []),
}  # fmt: skip


@pytest.mark.parametrize("case", spread(SOURCES, 3))
def test_the_same_lift_is_read_from_every_source(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    content, words = SOURCES[case]
    path = tmp_path / "lift.txt"
    path.write_text(content, "utf-8")
    answer = told(path, capsys, *words)
    segments = {(s["law"], round(s["rise"], 2)): s for s in answer["segments"] if s["rise"]}  # type: ignore[attr-defined]
    assert set(segments) == {("4-5-6-7", 9.0), ("3-4-5", -9.0)}
    assert segments["4-5-6-7", 9.0]["start_deg"] == pytest.approx(60.0, abs=0.1)
    assert segments["3-4-5", -9.0]["span_deg"] == pytest.approx(100.0, abs=0.2)


def test_a_multiple_of_a_unit_that_is_not_known_is_asked_about() -> None:
    sheet = read_sheet(
        text(ANGLES, position(LIFT, ANGLES), "angle [deg];lift (1/64 in)", "{:g};{:.4f}").encode(), "t.csv"
    )
    with pytest.raises(TableError, match=re.escape("unknown unit '1/64 in'")):
        layout(sheet)


def test_a_cell_that_is_no_number_is_left_out_by_its_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines = text(ANGLES, position(LIFT, ANGLES), "angle [deg],lift [mm]").splitlines()
    lines[100], lines[200], lines[201] = "99,ERR", "199,", "200,?"
    path = tmp_path / "t.csv"
    path.write_text("\n".join(lines), "utf-8")
    assert main(["measured", str(path)]) == 2
    refused = capsys.readouterr().err.splitlines()
    assert [line.partition(": ")[0] for line in refused] == [f"t.csv, line {n}" for n in (101, 201, 202)]
    answer = told(path, capsys, "--leave-out", "101,201-202")
    assert {s["law"] for s in answer["segments"]} == {"dwell", "4-5-6-7", "3-4-5"}  # type: ignore[attr-defined]
    assert len(answer["residuals"]) == 357  # type: ignore[arg-type]
    assert main(["measured", str(path), "--leave-out", "400"]) == 2
    assert "line 400 cannot be left out: the table has no row there" in capsys.readouterr().err
    assert main(["measured", str(path), "--leave-out", "4-x"]) == 2
    assert "allowed: 57,60-63" in capsys.readouterr().err


def test_spoiled_cells_are_told_with_what_was_expected(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    values = np.round(position(LIFT, ANGLES), 4)
    values[100] += 0.5
    path = tmp_path / "t.csv"
    path.write_text(text(ANGLES, values, "angle [deg],lift [mm]"), "utf-8")
    (spoiled,) = told(path, capsys)["spoiled"]  # type: ignore[misc]
    assert (spoiled["line"], spoiled["column"]) == (102, "column 2 (lift [mm])")
    assert spoiled["value"] == pytest.approx(values[100])
    assert spoiled["expected"] == pytest.approx(values[100] - 0.5, abs=1e-3)


def test_columns_and_their_errors_are_chosen_by_letter(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "t.csv"
    lift = position(LIFT, ANGLES)
    rows = [f"{a:g},{y:.6f},{y + 1:.6f},{3.0 * y:.6f}" for a, y in zip(ANGLES, lift, strict=True)]
    path.write_text("\n".join(["angle [deg],s [mm],x [mm],v [mm/deg]", *rows]), "utf-8")
    answer = told(path, capsys, "--columns", "s=x")
    assert [c["name"] for c in answer["columns"]] == ["column 3 (x [mm])"]  # type: ignore[attr-defined]
    answer = told(path, capsys, "--columns", "s=s,v=4", "--error", "s=0.001,v=0.02")
    assert [c["error"] for c in answer["columns"]] == [0.001, 0.02]  # type: ignore[attr-defined]
    assert any("contradicts" in note for note in answer["notes"])  # type: ignore[attr-defined]
    for wrong in (["--columns", "w=x"], ["--error", "s=much"], ["--error", "a=0.1"], ["--columns", "s=none"]):
        assert main(["measured", str(path), *wrong]) == 2
        assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.stress
def test_a_long_table_is_read_at_once(tmp_path: Path) -> None:
    """150,000 rows: the laws, less than 300 MB, and a cell far down that is no number is named with its line."""
    angles = 360.0 * np.arange(150_000) / 150_000
    data = text(angles, position(LIFT, angles), "angle [deg],lift [mm]").encode()
    tracemalloc.start()
    sheet = read_sheet(data, "t.csv")
    table = read_table(sheet, layout(sheet))
    found = fit(table, 0.0)
    assert tracemalloc.get_traced_memory()[1] < 40 * len(data), "of the lines only their places are kept"
    tracemalloc.stop()
    assert [s.law for s in found.segments] == ["4-5-6-7", "dwell", "3-4-5", "dwell"]
    assert np.abs(found.residuals).max() < 1e-7
    assert table.lines[-1] == 150_001
    spoiled = data.replace(b"\n180,", b"\nERR,")
    sheet = read_sheet(spoiled, "t.csv")
    with pytest.raises(TableError, match="line 75002: 'ERR' in column 1"):
        read_table(sheet, layout(sheet))


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1"])
def test_a_long_table_with_signs_above_its_numbers_is_read_at_once(encoding: str) -> None:
    """° and µ stand in the header, of whatever encoding: the numbers below are read like those of a plain one."""
    angles = 360.0 * np.arange(20_000) / 20_000
    data = text(angles, 1000.0 * position(LIFT, angles), "Cam angle °;Lift µm", "{:g};{:.4f}").encode(encoding)
    plain = text(angles, 1000.0 * position(LIFT, angles), "Cam angle deg;Lift um", "{:g};{:.4f}").encode()
    sheet = read_sheet(data, "t.csv")
    table = read_table(sheet, layout(sheet))
    assert sheet.numbers is not None, "at once, not row by row"
    assert sheet.numbers.shape == (20_000, 2)
    assert sheet.names == ("Cam angle °", "Lift µm")
    expected_sheet = read_sheet(plain, "t.csv")
    expected = read_table(expected_sheet, layout(expected_sheet))
    for own, wanted in (
        (table.lines, expected.lines),
        (table.angles, expected.angles),
        (table.values, expected.values),
    ):
        assert np.array_equal(own, wanted)
    assert (table.size, table.decimals) == (expected.size, expected.decimals)


@pytest.mark.stress
def test_a_hundred_megabytes_are_fitted_within_700(tmp_path: Path) -> None:
    """Beside numpy's own loading of the same file."""
    path, count = tmp_path / "long.csv", 3_590_000
    angles = 360.0 * np.arange(count) / count
    rows = np.array([angles, position(LIFT, angles)]).T
    np.savetxt(path, rows, fmt="%.17g", delimiter=",", header="angle [deg],lift [mm]", comments="")
    assert path.stat().st_size > 100e6
    program = """if True:
        import resource, sys, time
        from pathlib import Path
        import numpy as np
        from core.measured import fit, layout, read_sheet, read_table
        begin = time.process_time()
        sheet = read_sheet(Path(sys.argv[1]).read_bytes(), "t.csv")
        fit(read_table(sheet, layout(sheet)))
        ours, megabytes = time.process_time() - begin, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        begin = time.process_time()
        np.loadtxt(sys.argv[1], delimiter=",", skiprows=1)
        print(ours / (time.process_time() - begin), megabytes)
    """
    answer = subprocess.run(
        [sys.executable, "-c", program, str(path)], capture_output=True, text=True, check=True, encoding="utf-8"
    )
    ratio, megabytes = map(float, answer.stdout.split())
    assert ratio <= 40.0
    assert megabytes <= 700.0


# -- workbooks --------------------------------------------------------------------------------------------


def test_a_sheet_of_a_workbook_is_read_and_a_range_of_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("python_calamine")
    path = tmp_path / "lift.xlsx"
    table: list[list[object]] = [["Angle [deg]", "Lift [mm]", "remark"]]
    table += [[a, y, ""] for a, y in zip(ANGLES.tolist(), position(LIFT, ANGLES).tolist(), strict=True)]
    table[100][1] = "ERR"
    workbook(path, {"Notes": [["by Kim"], [2024.0]], "Lift": [["Machine 3"], *table]})
    assert main(["measured", str(path), "--sheet", "Lift"]) == 2
    assert "line 102: 'ERR' in column 2 (Lift [mm])" in capsys.readouterr().err, "as the spreadsheet counts its rows"
    answer = told(path, capsys, "--sheet", "Lift", "--leave-out", "102")
    assert {s["law"] for s in answer["segments"]} == {"dwell", "4-5-6-7", "3-4-5"}  # type: ignore[attr-defined]
    answer = told(path, capsys, "--sheet", "Lift", "--range", "A103:B362")
    assert len(answer["residuals"]) == 260  # type: ignore[arg-type]
    wrong = {
        "no sheet 'Lifts'; sheets: Notes, Lift": ["--sheet", "Lifts"],
        "no row contains two numbers": [],
        "as A1:C400": ["--sheet", "Lift", "--range", "A1"],
    }
    for said, words in wrong.items():
        assert main(["measured", str(path), *words]) == 2
        assert said in capsys.readouterr().err


def test_a_sheet_of_an_open_document_is_read_and_a_range_of_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("python_calamine", reason="the extra tables is not installed")
    kind, names = "application/vnd.oasis.opendocument.spreadsheet", "urn:oasis:names:tc:opendocument:xmlns"
    heading = "".join(
        f'<table:table-cell office:value-type="string"><text:p>{t}</text:p></table:table-cell>'
        for t in ("Angle [deg]", "Lift [mm]")
    )
    rows = "".join(
        "<table:table-row>"
        + "".join(f'<table:table-cell office:value-type="float" office:value="{v!r}"/>' for v in row)
        + "</table:table-row>"
        for row in zip(ANGLES.tolist(), position(LIFT, ANGLES).tolist(), strict=True)
    )
    spaces = " ".join(f'xmlns:{each}="{names}:{each}:1.0"' for each in ("office", "table", "text"))
    first = '<table:table table:name="Notes"><table:table-row/></table:table>'
    lift = f'<table:table table:name="Lift"><table:table-row>{heading}</table:table-row>{rows}</table:table>'
    path = tmp_path / "lift.ods"
    with zipfile.ZipFile(path, "w") as book:
        book.writestr("mimetype", kind)
        entry = f'<manifest:file-entry manifest:full-path="/" manifest:media-type="{kind}"/>'
        book.writestr(
            "META-INF/manifest.xml",
            f'<manifest:manifest xmlns:manifest="{names}:manifest:1.0">{entry}</manifest:manifest>',
        )
        body = f"<office:body><office:spreadsheet>{first}{lift}</office:spreadsheet></office:body>"
        book.writestr("content.xml", f"<office:document-content {spaces}>{body}</office:document-content>")
    answer = told(path, capsys, "--sheet", "Lift")
    assert {s["law"] for s in answer["segments"]} == {"dwell", "4-5-6-7", "3-4-5"}  # type: ignore[attr-defined]
    answer = told(path, capsys, "--sheet", "Lift", "--range", "A102:B361")
    assert len(answer["residuals"]) == 260  # type: ignore[arg-type]


def test_without_a_reader_of_workbooks_one_line_says_what_to_install(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "python_calamine", None)
    path = tmp_path / "lift.xlsx"
    workbook(path, {"Lift": [[0.0, 1.0]]})
    assert main(["measured", str(path)]) == 2
    assert (
        capsys.readouterr().err
        == "lift.xlsx: a workbook; pip install 'kindyna[tables]' to read it, or save it as CSV\n"
    )


@pytest.mark.parametrize(
    ("unit", "form", "said"),
    [
        (25.4e-4, "{:.0f} {:.0f}", "assumed to be in 1e-4in, a stroke of 8.999 mm; as mm it is 3543 mm"),
        (1e-3, "{:.0f} {:.0f}", "assumed to be in um, a stroke of 9 mm; as mm it is 9000 mm"),
        (25.4, "{:.0f} {:.4f}", "assumed to be in in, a stroke of 8.999 mm; as mm it is 0.3543 mm"),
        (1.0, "{:.0f} {:.4f}", "assumed to be in mm"),
    ],
)
def test_the_scale_of_a_lobe_table_without_units_is_guessed_and_said(
    unit: float, form: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "lobe.txt"
    path.write_text(text(ANGLES, position(LIFT, ANGLES) / unit, "LOBE 3\nGRIND 276", form), "utf-8")
    answer = told(path, capsys)
    notes = answer["notes"]
    assert f"the displacement is {said}" in notes  # type: ignore[operator]
    assert "angles from 0 to 359 are assumed to be in deg, a row every 1" in notes  # type: ignore[operator]
    assert answer["fit"]["stroke_mm"] == pytest.approx(9.0, abs=0.003)  # type: ignore[index]
    assert answer["velocity_jumps"] == []
