"""The benchmark's page of charts: painted as PNG and SVG, whatever is missing."""

import math

import pytest
from benchmarks import page
from benchmarks.chart import COLOURS, LIMIT, power
from benchmarks.measuring import Row
from benchmarks.stress import Look
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication
from stress_cases import Sample

ROWS = [
    Row("law", "KINDYNA", n, 1e-4, 1e-15, 0.1 * n / 360, "", 1.0, 1.0, "") for n in (360, 3600, 1_000_000)
] + [
    Row("law", "finite differences", 3600, 3e-4, 10.0**-k, 0.1, f"1e-{k}", 3.0, 3.0, "") for k in (2, 5, 9)
] + [
    Row("law", "absent", 3600, math.nan, math.nan, math.nan, "", math.nan, math.nan, "is not installed"),
    Row("law", "broken", 3600, 1e-3, math.inf, math.nan, "", 9.0, 9.0, ""),
]  # fmt: skip
LOOKS = [
    Look("Dead centre", "distance", 10.0**-k, Sample(1e-16, 1e-15, math.inf if k > 3 else 1e-12)) for k in range(1, 6)
]


def test_the_page_is_painted_as_png_and_svg(app: QApplication) -> None:
    made = page.painted(ROWS, LOOKS)
    assert set(made) == {"bench.png", "bench.svg"}
    image = QImage.fromData(made["bench.png"])
    assert image.width() == round(2 * page.EDGE + page.ACROSS * page.WIDE) * page.RATIO
    # our curve, one of the others and the limit where the first chart stands, paper at the edge
    colours = {image.pixelColor(x, y).name() for x in range(60, 690) for y in range(150, 600)}
    assert {"#ffffff", "#000000", COLOURS[1].lower(), LIMIT.lower()} <= colours
    assert image.pixelColor(2, image.height() - 2).name() == "#ffffff"
    svg = made["bench.svg"].decode()
    for text in (
        "Run time against true error",
        "Law: s, v, a",
        "Growth",
        "Memory",
        "Dead centre",
        "finite differences",
    ):
        assert text in svg
    assert "absent" not in svg


@pytest.mark.parametrize(("exponent", "text"), [(0, "1"), (1, "10"), (-3, "10⁻³"), (12, "10¹²")])
def test_powers_of_ten_are_written_as_readers_know_them(exponent: int, text: str) -> None:
    assert power(exponent) == text
