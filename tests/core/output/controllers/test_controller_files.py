"""Files of controllers against the small examples of their manuals' layouts, and the variants that readers take."""

import numpy as np
import pytest

from core.errors import KindynaError
from core.output.controllers.layout import FileTable, file_bytes, read_file, row_positions
from core.output.controllers.rows import controller, controllers

A = np.array
XYVA = """aFeed : ARRAY[0..2] OF SMC_CAMXYVA := [(dX := 0.0, dY := 0.0, dV := 0.0, dA := 0.0),
  (dX := 90.0, dY := 12.5, dV := 0.25, dA := 0.0), (dX := 360.0, dY := 0.0, dV := 0.0, dA := 0.0)];
feed : MC_CAM_REF := (byType := 3, xStart := 0.0, xEnd := 360.0, nElements := 3, pce := ADR(aFeed));
"""
ISG = """Tablename = Lift
Tabletype = 3 # one column
Table-ID = 7
Functiontype = 1
Lines = 4
Begintable
50000,0
100000,0
50000,0
0,0
EndTable
"""
FEED = FileTable(A([0.0, 90.0, 360.0]), A([0.0, 12.5, 0.0]), A([0.0, 0.25, 0.0]), A([0.0, 0.0, 0.0]))
LIFT = FileTable(A([90.0, 180.0, 270.0, 360.0]), A([5e4, 1e5, 5e4, 0.0]))
PAIRS = FileTable(A([0.0, 90.5, 360.0]), A([0.0, 12.25, 0.0]))
RISE = FileTable(A([0.0, 90.0, 360.0]), A([0.0, 5.0, 10.0]))
EXAMPLES = {
    "codesys-xyva": (FEED, "feed", XYVA),
    "beckhoff-ascii": (LIFT, "Lift", ISG),
    "sew-tab": (PAIRS, "", "3\n0\t0\n90.5\t12.25\n360\t0\n"),
    "sew-semicolon": (PAIRS, "", "3\n0;0\n90.5;12.25\n360;0\n"),
    "lenze-loader": (PAIRS, "", "0\t0\n90.5\t12.25\n360\t0\n"),
    "kollmorgen-csv": (PAIRS, "", "CYCLIC;YES;\nTABLE_BEGIN;;\n0;0;SPLINE\n90.5;12.25;SPLINE\n360;0;SPLINE\nTABLE_END;;\n"),
    "technosoft": (FileTable(A([0.0, 2.0, 4.0]), A([0.0, 7.0, 0.0])), "", "0\t0\n2\t7\n4\t0\n"),
    "inventor": (RISE, "", "0;0\n0.25;0.5\n1;1\n"),
    "schneider-asc": (
        FileTable(A([0.0, 180.0, 360.0]), A([1.0, 5.0, 1.0])),
        "lift",
        "Header=lift\r\nVersion=1\r\nYFactor=4\r\nXFactor=360\r\nYOffset=1\r\nXOffset=0\r\nStartSlope=0\r\nEndSlope=0\r\n"
        "InterpolationMode=1\r\nCamPoints\r\n0\r\n1\r\n0\r\n",
    ),
}  # fmt: skip


@pytest.mark.parametrize("slug", EXAMPLES)
def test_the_small_example_is_written_character_by_character(slug):
    row = controller(slug)
    table, name, text = EXAMPLES[slug]
    assert file_bytes(row, table, name, row.interpolation[0]).decode() == text


@pytest.mark.parametrize("slug", [slug for slug in EXAMPLES if slug != "inventor"])
def test_the_small_example_is_read(slug):
    table, name, text = EXAMPLES[slug]
    found = read_file(controller(slug), text.encode(), 360.0)
    assert found.master.tolist() == table.master.tolist()
    assert found.slave.tolist() == table.slave.tolist()
    assert found.name == name


@pytest.mark.parametrize(
    ("slug", "text", "master", "slave"),
    [
        ("sew-semicolon", "3\r\n0;0\r\n90,5;12,25\r\n360;0\r\n", [0.0, 90.5, 360.0], [0.0, 12.25, 0.0]),
        ("sew-tab", "3\n0\t0\n90.5\t12.25\n360\t0", [0.0, 90.5, 360.0], [0.0, 12.25, 0.0]),
        (
            "lenze-loader",
            "// lift\r\n0 0\r\n\r\n90,5   12,25 // top\r\n360\t0\r\n",
            [0.0, 90.5, 360.0],
            [0.0, 12.25, 0.0],
        ),
        (
            "beckhoff-ascii",
            "# of a cam\r\nTable-ID 7\r\nTablename\tLift\r\nLines = 4\r\nBegintable\r\n 1,5\r\n\r\n2.5 # top\r\n1,5\r\n0,0\r\nEndTable",
            [90.0, 180.0, 270.0, 360.0],
            [1.5, 2.5, 1.5, 0.0],
        ),
        ("codesys-xyva", XYVA.replace(" := ", ":=").replace("\n", "\r\n"), [0.0, 90.0, 360.0], [0.0, 12.5, 0.0]),
        ("technosoft", "0 0\n2 7\n4 0\n", [0.0, 2.0, 4.0], [0.0, 7.0, 0.0]),
    ],
)
def test_line_ends_marks_blanks_and_comments_may_be_others(slug, text, master, slave):
    found = read_file(controller(slug), text.encode(), 360.0)
    assert found.master.tolist() == master
    assert found.slave.tolist() == slave


@pytest.mark.parametrize(
    ("slug", "text", "says"),
    [
        ("sew-tab", "3\n0\t0\n90\t5\n", "states 3 rows and holds 2"),
        ("sew-tab", "2\n0\t0\n90\tfive\n", "line 3: '90\\tfive' is no row"),
        ("lenze-loader", "0 0\n90 5\n80 0\n", "row 3: the master does not rise, 80"),
        ("codesys-xyva", "VAR\nEND_VAR\n", "choose a file of this controller"),
        ("beckhoff-ascii", ISG.replace("EndTable", ""), "no end like 'EndTable'"),
        ("lenze-loader", "0 0\n90 5 7 8\n", "line 2: '7 8' follows the row"),
    ],
)
def test_what_is_no_such_file_is_said_with_its_line(slug, text, says):
    with pytest.raises(KindynaError, match=says.replace("\\", r"\\")):
        read_file(controller(slug), text.encode(), 360.0)


@pytest.mark.parametrize("slug", [slug for slug in controllers() if slug not in ("inventor", "technosoft")])
def test_every_row_reads_what_it_writes(slug):
    row = controller(slug)
    x = 360.0 * row_positions(row, 8)
    y = 20.0 + np.round(10.0 * np.sin(np.deg2rad(x)), 6)
    table = FileTable(x, y, 0.01 * y, 0.001 * y, (0.5, -0.25), range=(0.0, 360.0))
    found = read_file(row, file_bytes(row, table, "Main feed", row.interpolation[-1]), 360.0)
    last = row.unit if row.integer else 10.0 ** (3 - row.digits)
    assert np.abs(found.master - x).max() <= 0.51 * last
    assert np.abs(found.slave - y).max() <= 0.51 * last
    for name in ("velocity", "acceleration"):
        if name in row.columns:
            assert np.abs(getattr(found, name) - getattr(table, name)).max() <= 1e-12
    assert found.word == row.words.get(row.interpolation[-1], "")


def test_integers_beyond_32_bits_and_a_normalised_slave_that_returns_are_refused():
    with pytest.raises(
        KindynaError, match=r"allowed: integers of 32 bits, up to .-2147483647: choose a smaller --slave-scale"
    ):
        file_bytes(controller("technosoft"), FileTable(A([0.0, 1.0]), A([0.0, 2.0**31])), "", "linear")
    with pytest.raises(KindynaError, match="the slave must not end where it starts"):
        file_bytes(controller("inventor"), PAIRS, "", "unknown")
