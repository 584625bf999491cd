"""The report to hand on: its numbers are those of summary.json, its equations those of the design, its file whole or not there."""

import math
import re
import unicodedata
from dataclasses import dataclass, field, replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from sampled import spread

from core.__main__ import main
from core.design import Balancer, edited, entries, put
from core.laws import LAWS
from core.output.export import SHAFT_QUANTITIES
from core.output.report import report
from core.output.report.document import PARTS, document, html, inline_svg
from core.output.report.equations import equations, equations_of
from core.output.report.formula import mathml
from core.output.summary import summary
from core.papers import claims
from core.project import load, loads
from core.project.reading_faults import reason
from core.study import Study
from core.study.formulas import FORMULAS

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
LIFT, UNIT = EXAMPLES / "transfer_lift.toml", EXAMPLES / "transfer_unit.toml"


@dataclass
class Read:
    """A table as it stands in the page: what it is of, its rows by key, each with its texts and its whole numbers."""

    chapter: str
    slug: str
    rows: dict[str, tuple[list[str], list[float | None]]] = field(default_factory=dict)


class Reader(HTMLParser):
    """Reads a report as any program would."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tables: list[Read] = []
        self.headings: list[str] = []
        self.texts: list[str] = []
        self.opened: list[str] = []
        self.row: tuple[list[str], list[float | None]] = ([], [])
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        given = dict(attributes)
        if tag not in ("meta",):
            self.opened.append(tag)
        if tag in ("h1", "h2", "h3"):
            self.headings.append("")
        if tag == "table":
            self.tables.append(Read(self.headings[-1] if self.headings else "", given.get("data-table") or ""))
        if tag == "tr":
            self.row = ([], [])
            self.tables[-1].rows[given.get("data-row") or str(len(self.tables[-1].rows))] = self.row
        if tag in ("td", "th"):
            self.row[0].append("")
        if tag == "data":
            self.row[1].append(float(given["value"] or "nan"))

    def handle_endtag(self, tag: str) -> None:
        assert self.opened.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append(data)
        if self.opened and self.opened[-1] in ("h1", "h2", "h3"):
            self.headings[-1] += data
        if "td" in self.opened[-2:]:
            self.row[0][-1] += data

    def table(self, slug: str, number: int = 0) -> Read:
        return [table for table in self.tables if table.slug == slug][number]


@pytest.fixture(scope="module")
def lift() -> Study:
    return Study(load(LIFT))


@pytest.fixture(scope="module")
def page(lift: Study) -> str:
    return html(document(lift), {})


@pytest.fixture(scope="module")
def unit() -> Study:
    """Two drives of the transfer unit on a stiff shaft with a balance cam."""
    design = load(UNIT)
    assert design.shaft is not None
    stiff = replace(design.shaft, elastic=None)
    balancer = Balancer(spring_rate_n_per_mm=20.0, preload_n=20000.0, base_radius_mm=250.0, roller_radius_mm=60.0)
    return Study(replace(design, drives=design.drives[1:3], timing=(), shaft=stiff, balancer=balancer, assumed=()))


def ends(row: dict[str, Any]) -> list[float]:
    return [row[end][name] for end in ("min", "max") for name in ("value", "cam_angle_deg")]


# -- numbers ----------------------------------------------------------------------------------------------


def test_the_numbers_are_those_of_the_summary(lift: Study, page: str) -> None:
    figures, read = summary(lift, lift.stages), Reader(page)
    assert not read.opened
    main_figures, others = (
        {key: numbers for key, (_, numbers) in read.table(slug).rows.items() if numbers}
        for slug in ("main", "extremes")
    )
    assert {"contact_force_n", "drive_torque_nm", "motor_torque_nm"} <= set(main_figures)
    assert not main_figures.keys() & others.keys(), "each stands once"
    limited = {"pressure_angle_deg", "speed_rpm"}  # beside its limit, and beside the flywheel
    assert {**main_figures, **others} == {
        slug: ends(row) for slug, row in figures["extremes"].items() if slug not in limited
    }
    limits = [numbers for _, numbers in read.table("limits").rows.values() if numbers]
    assert limits == [
        [v for v in (row["value"], row["cam_angle_deg"], row["limit"]) if v is not None] for row in figures["limits"]
    ]
    wheel = read.table("flywheel").rows
    for key in ("mean_torque_nm", "energy_swing_j", "needed_inertia_kg_m2", "min_speed_rpm"):
        assert wheel[key][1] == [figures["flywheel"][key]]
    proof = read.table("certificate").rows
    for name, residual in figures["certificate"].items():
        assert proof[name][0][3] == "kept"
        for text, key in zip(proof[name][0][1:3], ("value", "bound"), strict=True):
            assert f"{read_number(text):.2e}" == f"{residual[key]:.2e}"


def test_what_rounding_leaves_of_a_zero_reads_as_zero() -> None:
    read = Reader(html(document(Study(load(LIFT.with_name("card_picker.toml"))), ()), {}))
    texts, numbers = read.table("main").rows["displacement_mm"]
    assert 0.0 < abs(numbers[0]) < 1e-12, "of 20 mm"
    assert texts[2] == "0"


def read_number(text: str) -> float:
    return float(text.replace("\u202f", "").replace("\u2212", "-"))


def test_inputs_stand_with_their_units_and_what_is_assumed_with_its_reason(lift: Study, page: str) -> None:
    rows: dict[str, list[str]] = {}
    for table in Reader(page).tables:
        if table.slug == "inputs":
            rows |= {key: texts for key, (texts, _) in table.rows.items()}
    known = {
        entry.path: entry for name in ("follower", "cam", "shaft", "loads") for entry in entries(lift.design, name)
    }
    assert set(rows) == {path for path, entry in known.items() if entry.value is not None}
    for path, texts in rows.items():
        value = known[path].value
        assert (read_number(texts[1]) if isinstance(value, float) else texts[1]) == value
        assert not known[path].unit.symbol or known[path].unit.symbol in texts
    assert {path for path, texts in rows.items() if "*" in texts} == set(lift.design.assumed)
    for path in lift.design.assumed:
        assert rows[path][-1] == reason(lift.design, path) != ""


def test_the_whole_and_each_drive_of_a_shaft(unit: Study) -> None:
    made, figures = document(unit, ["extremes", "certificate"]), summary(unit)
    read = Reader(html(made, {}))
    torque = {key: numbers for key, (_, numbers) in read.table("torque").rows.items()}
    assert torque == {key: [figures["torque"][key]] for key in ("mean_nm", "rms_nm", "peak_nm", "peak_power_w")}
    assert read.table("flywheel").rows["needed_inertia_kg_m2"][1] == [figures["flywheel"]["needed_inertia_kg_m2"]]
    for key, (_, numbers) in read.table("drives").rows.items():
        assert not numbers or numbers == ends(figures["extremes"][key])
    for number, (name, each) in enumerate(unit.drives.items()):
        tables = (read.table(slug, number).rows.items() for slug in ("main", "extremes"))
        own = {key: numbers for rows in tables for key, (_, numbers) in rows if numbers}
        figures_of_it = summary(each, each.stages, SHAFT_QUANTITIES)["extremes"]
        assert own == {
            slug: ends(row) for slug, row in figures_of_it.items() if slug not in ("pressure_angle_deg", "speed_rpm")
        }
        assert any(f"Drive {name}" in heading for heading in read.headings)
    assert [each.title for each in made.sections if each.level == 1][-2:] == ["Balance cam", "Certificate"]
    assert "Balance cam" in {row.name for row in equations_of(unit)}
    assert dict(made.rows)["Mechanism"] == "2 drives on one shaft and a balance cam"
    assert set(figures["certificate"]) == set(read.table("certificate").rows) - {"0"}


def test_what_is_rounding_beside_the_torque_of_a_drive_is_nothing(unit: Study) -> None:
    """The couple on a guide that nothing turns, though the torque stands beside the drives."""
    rows = [line.split()[5:] for line in report(unit).splitlines() if line.startswith("Couple on the guide")]
    assert rows
    assert all(row[0::2] == ["0", "0"] for row in rows)


def test_a_drive_without_an_answer_is_told_and_the_others_have_their_chapters(unit: Study) -> None:
    study = Study(put(unit.design, "drives[1].follower.roller_arm_mm", 100.0))
    made = document(study, ["equations"])
    chapters = [each.title for each in made.sections if each.level == 1]
    assert chapters == ["At a glance", "Drives", "Timing", "Drive Clamp", "Equations used"]
    assert dict(made.rows)["Findings"] == "1 error"
    assert not {"Flywheel", "Balance cam"} & {row.name for row in equations_of(study)}


@pytest.mark.stress
def test_chapters_stand_in_one_order_for_one_drive_all_and_each(lift: Study, unit: Study) -> None:
    order = (
        "At a glance", "Drives", "Main figures", "Inputs", "Inputs of the shaft", "Timing", "Motion", "Mechanism and cam", "Mechanism",
        "Forces and torque", "Torque of the shaft", "Drive Clamp", "Drive Lift", "Balance cam",
        "Profile", "Extremes over one turn of all other quantities", "Certificate", "Equations used", "Comparison with the paper",
        "Conventions and sources",
    )  # fmt: skip
    of_one, of_all = ([each.title for each in document(study).sections if each.level == 1] for study in (lift, unit))
    assert of_one == [title for title in order if title in of_one]
    assert of_all == [title for title in order if title in of_all]
    assert set(of_one) | set(of_all) == set(order) - {"Mechanism"}
    sections = [each.title for each in document(unit).sections]
    of_drive = sections[sections.index("Drive Clamp") + 1 : sections.index("Drive Lift")]
    assert [title for title in of_drive if title in order] == [title for title in order if title in of_drive]
    assert {"Inputs: cam", "Motion", "Mechanism", "Forces and torque", "Keeping contact"} <= set(of_drive)


# -- equations --------------------------------------------------------------------------------------------


def value(node: ElementTree.Element, u: float) -> str:
    """A MathML element as an expression of Python: what stands side by side is a product."""
    tag, inside = node.tag.rpartition("}")[2], [each for each in node if not each.tag.endswith("}mspace")]
    if tag == "mfrac":
        return f"(({value(inside[0], u)})/({value(inside[1], u)}))"
    if tag == "msup":
        return f"({value(inside[0], u)})**({value(inside[1], u)})"
    if tag in ("mi", "mn"):
        return {"π": "math.pi", "u": repr(u), "sin": "math.sin", "cos": "math.cos"}.get(
            node.text or "", node.text or ""
        )
    made, before = "", False
    for each in inside:
        sign = each.tag.endswith("}mo")
        text = {"−": "-", "\u2061": ""}.get(each.text or "", each.text or "") if sign else value(each, u)
        made += ("*" if before and (not sign or text == "(") else "") + text
        before = (not sign or text == ")") and not text.startswith("math.s")
        if tag == "mrow" and inside[0].text in ("sin", "cos") and each is inside[0]:
            before = False
    return f"({made})" if tag == "mrow" else made


def holds(range_: str, u: float) -> bool:
    """``u ≤ 1/8``, ``1/8 ≤ u ≤ 7/8``, ``u ≥ 7/8``, or no range at all."""
    return not range_ or bool(eval(range_.replace("≤", "<=").replace("≥", ">="), {"u": u}))


@pytest.mark.parametrize("slug", [slug for slug, law in LAWS.items() if "s = " in "".join(law.formula)])
def test_the_formula_that_is_typeset_is_the_laws_curve(slug: str) -> None:
    law = LAWS[slug]
    places = np.array([0.05, 0.31, 0.77, 0.93])
    for u, s in zip(places.tolist(), law(places)[0].tolist(), strict=True):
        for line in law.formula:
            formula, _, range_ = line.removeprefix("s = ").partition(", ")
            if holds(range_, u):
                got = eval(value(ElementTree.fromstring(mathml(formula)), u), {"math": math})
                assert got == pytest.approx(s, abs=1e-12)


def test_every_equation_is_mathml_of_its_line() -> None:
    """Nothing of a line is lost but its brackets, and its letters stay in their order."""
    for row in equations(FORMULAS.values()):
        assert row.source, row.name
        assert row.where, row.name
        for line, typeset in zip(row.lines, row.mathml, strict=True):
            root = ElementTree.fromstring(typeset)
            assert root.get("alttext") == line
            letters = re.sub(r"[^A-Za-zα-ω]", "", "".join(root.itertext()))
            assert sorted(letters) == sorted(re.sub(r"[^A-Za-zα-ω]", "", unicodedata.normalize("NFD", line))), line


@pytest.mark.parametrize(
    ("example", "there", "not_there"),
    [
        (
            "transfer_lift",
            {"Triangle of arm and rod", "Motion law: Modified sine", "Flywheel"},
            {"Transmission angle", "Balance cam"},
        ),
        (
            "tappet_flat",
            {"Profile under a straight face", "Contact force on a guide"},
            {"Pitch curve", "Triangle of arm and rod"},
        ),
        ("kim_1990", {"Wind-up of the shaft, Hill's form", "Motion law: Simple harmonic"}, {"Outer flank"}),
        (
            "lecture_six_bar",
            {"Velocities of points", "Transmission angle"},
            {"Displacement over a segment", "Profile", "Flywheel"},
        ),
    ],
)
def test_only_the_equations_that_the_design_used(example: str, there: set[str], not_there: set[str]) -> None:
    names = {row.name for row in equations_of(Study(load(EXAMPLES / f"{example}.toml")))}
    assert there <= names
    assert not names & not_there


# -- files ------------------------------------------------------------------------------------------------


def test_the_file_is_the_same_again_and_needs_nothing_beside_it(
    lift: Study, page: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["report", str(LIFT), "--out", str(tmp_path / "r.HTML")]) == 0
    said = capsys.readouterr()
    assert (tmp_path / "r.HTML").read_text("utf-8") == page
    assert said.out == f"{tmp_path / 'r.HTML'}\n"
    assert said.err == "pictures left out: they need kindyna --headless\n"
    assert "written without its pictures" in page
    assert re.findall(r"""(?:src|href)=["'](?!#)[^"']*|url\((?!#)""", page) == []


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("r.pdf", "needs kindyna --headless"),
        ("missing/r.html", "no such file or folder"),
        ("file/r.html", "there is a file instead of a folder"),
    ],
)
def test_what_cannot_be_written_is_told_in_one_line(
    name: str, wrong: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("", "utf-8")
    assert (
        main(["report", str(EXAMPLES / "slider_crank.toml"), "--out", str(tmp_path / name), "--without", *PARTS]) == 2
    )
    said = capsys.readouterr()
    assert wrong in said.err
    assert len([line for line in said.err.splitlines() if "left out" not in line]) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_parts_that_are_not_wanted_are_left_out(lift: Study) -> None:
    least = document(lift, ())
    titles = [each.title for each in least.sections]
    assert "Main figures" in titles
    assert "Findings" in titles
    assert not {"Inputs", "Equations used", "Certificate", "Conventions and sources"} & set(titles)
    assert least.pictures == ()
    assert {picture.name for picture in document(lift, ["pictures"]).pictures} == {
        "glance",
        "motion",
        "mechanism",
        "cam",
        "forces",
    }


def test_an_example_of_a_paper_is_held_against_it(lift: Study) -> None:
    """In the order of the paper, with the verdicts of its claims; a design that differs from the example is none of its."""
    rows = list(Reader(html(document(lift, ["papers"]), {})).table("paper").rows.values())[1:]
    expected = [each for each in claims("shin1995") if each.row.example == "transfer_lift"]
    assert [texts[:2] for texts, _ in rows] == [[each.where, each.says] for each in expected]
    for (texts, _), each in zip(rows[:6], expected, strict=False):
        assert texts[2:] == [each.here, each.verdict]
    other = Study(put(lift.design, "cam.base_radius_mm", 410.0))
    assert "Comparison with the paper" not in [each.title for each in document(other, ["papers"]).sections]


@pytest.mark.parametrize(("unit", "symbol"), [("mm", "mm"), ("deg", "°")])
def test_a_motion_alone_has_no_follower_and_no_links(unit: str, symbol: str) -> None:
    """Its velocity may jump, which is of another unit than a jump of its acceleration."""
    rows = "".join(
        f'[[motion.segments]]\nlaw = "{law}"\nspan_deg = 180.0\nrise_{unit} = {rise}\n'
        for law, rise in (("parabolic", 10.0), ("constant-velocity", -10.0))
    )
    inertia = "mass_kg" if unit == "mm" else "inertia_kg_m2"
    design = loads(
        f'format = 1\nname = "Axis"\n[motion]\nstart_{unit} = 0.0\n{rows}[loads]\n{inertia} = 2.0\n'
        '[shaft]\nrotation = "ccw"\nspeed_rpm = 60.0\n'
    )
    made = document(Study(design))
    words = " ".join([*Reader(html(made, {})).texts, *(picture.caption for picture in made.pictures)])
    assert not re.search(r"follower|\blinks?\b|machine,|linkage", words)
    (header,) = (
        block.header for part in made.sections for block in part.blocks if getattr(block, "slug", "") == "joins"
    )
    assert header[1:] == tuple(
        f"{letter} {symbol}{per}" for letter, per in zip("svaj", ("", "/rad", "/rad²", "/rad³"), strict=True)
    )


def test_a_name_is_no_markup() -> None:
    named = Study(replace(load(EXAMPLES / "slider_crank.toml"), name="<b>A & B</b>"))
    assert "<b>" not in html(document(named, ()), {})


def test_pictures_keep_their_names_apart() -> None:
    drawn = inline_svg(
        '<?xml?>\n<svg width="2mm" height="3mm" viewBox="0 0 1 1"><a id="x"/><b fill="url(#x)"/></svg>', "p1-"
    )
    assert drawn == '<svg viewBox="0 0 1 1"><a id="p1-x"/><b fill="url(#p1-x)"/></svg>'


# -- each number once -------------------------------------------------------------------------------------

NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?![\w.])")


@pytest.mark.parametrize("name", spread(["transfer_lift", "rocker_cam", "kim_1990", "conjugate"], 1))
def test_a_number_that_was_computed_stands_once(name: str) -> None:
    """No row of a table repeats all figures of another, be it in other digits; figures of five digits and more."""
    study = Study(
        edited(
            load(LIFT.with_name(f"{name}.toml")), "shaft.flywheel_inertia_kg_m2", 0.3 if name == "rocker_cam" else 0.0
        )
    )
    for lines in (report(study).splitlines(), rows_of(html(document(study, ["extremes"]), {}))):
        there: dict[frozenset[str], str] = {}
        for line in lines:
            found = frozenset(
                f"{abs(float(text)):.4g}" for text in NUMBER.findall(line) if len(text) > 5 and float(text)
            )
            label = re.split(r"  +|\t", line.strip())[0]
            if found and label[:1].isalpha() and label != line and not label.startswith(SAME_BY_NATURE):
                assert found not in there, f"{there[found]!r} and {line!r}"
                there[found] = line


def rows_of(page: str) -> list[str]:
    """The rows of a page's tables, cells apart by tabs."""
    tables = (
        table for table in Reader(page).tables if table.slug != "glance"
    )  # the first page says again what matters
    return ["\t".join(texts) for table in tables for texts, _ in table.rows.values()]


SAME_BY_NATURE = ("Camshaft bearing", "Guide", "Velocity of", "Instant centre", "Power", "Pitch", "Profile", "Smallest", "alternating",
                  "Cam radius", "Pressure angle, r")  # fmt: skip  # a symmetric motion rises and returns alike
"""Quantities that one machine has the same size of: forces against each other, places on one line, a radius that is an input."""
