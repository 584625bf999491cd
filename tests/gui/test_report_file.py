"""The report to hand on with its pictures: HTML and PDF by the command, its pages, its text, the same bytes again."""

import re
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import pytest
from pdf_reader import page_texts
from PySide6.QtWidgets import QApplication

from core.output.report.document import PARTS, document
from core.output.summary import summary
from core.project import load
from core.study import Study
from kindyna_gui.__main__ import main
from kindyna_gui.pictures.report.pdf import HEIGHT, pages, strips_of
from kindyna_gui.places import example

LIFT = example("transfer_lift")


@pytest.fixture(autouse=True)
def platform(app: QApplication, monkeypatch: pytest.MonkeyPatch) -> None:
    """What the command does to the environment ends with the test."""
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")


def report(*words: object) -> int:
    return main(["--headless", "report", *map(str, words)])


@pytest.fixture(scope="module")
def written(app: QApplication, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("report") / "lift.pdf"
    assert report(LIFT, "--out", path) == 0
    return path.read_bytes()


def test_the_text_of_the_pdf_can_be_searched(written: bytes) -> None:
    texts = page_texts(written)
    whole, figures = "\n".join(texts), summary(Study(load(LIFT)), ("cam", "dynamics"))
    assert texts[0].startswith("REPORT\nTransfer unit, lift drive\n")
    letters = "".join(whole.split())
    for text in (
        "Cam-driven slider, roller, open cam", "Findings", "Slider arm L1", "1302.162", "Shin1995 (11), (12)",
        "κ = κ_p/(1 − R_r κ_p)", "φ̇ = L̇ cos β/(L₁ sin(β − φ))",
    ):  # fmt: skip
        assert "".join(text.split()) in letters
    for name in ("pressure_angle_deg", "contact_force_n", "drive_torque_nm"):
        assert f"{figures['extremes'][name]['max']['value']:.6g}" in whole
    assert [text.rpartition("\n")[2] for text in texts] == [f"{n} / {len(texts)}" for n in range(1, len(texts) + 1)]


def test_the_same_design_gives_the_same_bytes(written: bytes, tmp_path: Path) -> None:
    assert report(LIFT, "--out", tmp_path / "again.pdf") == 0
    assert (tmp_path / "again.pdf").read_bytes() == written
    assert b"CreationDate" not in written
    assert re.findall(rb"/MediaBox \[0 0 ([\d.]+) ([\d.]+)\]", written)[0] == (b"595.000000", b"842.000000")


def test_a_page_does_not_end_with_a_heading(app: QApplication) -> None:
    """What belongs to what follows it stands on the same page; nothing stands below the foot, and every strip once."""
    strips = list(strips_of(document(Study(load(LIFT)), [part for part in PARTS if part != "pictures"])))
    laid = pages(strips)
    for page in laid:
        assert not page[-1][0].joined
        assert page[-1][1] + page[-1][0].height <= HEIGHT
        assert all(a[1] + a[0].height <= b[1] + 1e-9 for a, b in pairwise(page))
    heads = {id(strip.head) for strip in strips if strip.head is not None}
    assert [id(strip) for page in laid for strip, _ in page if id(strip) not in heads] == [id(strip) for strip in strips]


def test_the_html_holds_its_pictures(tmp_path: Path) -> None:
    path = tmp_path / "lift.html"
    assert report(LIFT, "--out", path, "--without", "equations", "extremes") == 0
    page = path.read_text("utf-8")
    drawn = re.findall(r"<svg\b.*?</svg>", page, re.DOTALL)
    assert len(drawn) == page.count("<figure>") == 4
    for picture in drawn:
        root = ElementTree.fromstring(picture)
        assert root.get("width") is None
        assert len(list(root.iter("{http://www.w3.org/2000/svg}path"))) > 5
        assert "base64" not in picture
    assert "without its pictures" not in page
    assert "Displacement, mm" in page
    names = re.findall(r'\bid="([^"]+)"', page)
    assert len(names) == len(set(names))
