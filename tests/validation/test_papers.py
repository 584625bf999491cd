"""The claims of all four papers: verdicts that follow from their numbers and turn with them, against numbers from outside."""

import csv
import json
import math
import re
import unicodedata
from collections import Counter
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from paper_claims import EXAMPLES, SLOW, at, every_claim, quick_claims, turned
from sampled import stressed

from core.__main__ import main
from core.design import put
from core.papers import PAPERS, VERDICTS, Claim, Examples, claims
from core.papers.claim import ComparedNumber
from core.process import resources

OTHER_THAN_AGREES = {
    "shin1995": {
        "differs": ("(21)",),
        "misprint": ("(23)", "Table 2, IL", "Table 2, IA", "Table 3, IR", "§6.4, ω0", "§6.4, Fig. 17"),
        "method": ("(24)",), "convention": ("(18)",), "limit": ("(7)", "(9)", "(10)", "(19), (20)"),
    },
    "yang": {
        "differs": ("(8)",), "misprint": ("Table 1, CV2",), "method": ("§3.1, Cv",), "rounded": ("Fig. 4", "Fig. 4, table"),
        "contradiction": ("§3.2, 3)",),
    },
    "velocity": {"rounded": ("p. 11, A", "p. 11, D", "p. 11, link 3")},
    "kim1990": {
        "differs": ("Figs. 6, 7, contact", "§6 (1)", "§6 (2)", "Fig. 8, §7, places", "Fig. 8", "Fig. 10", "Fig. 12", "§6, Figs. 9-12"),
        "misprint": (
            "(4), Fig. 2", "(5)", "(8)", "(13)", "(13), right side", "(14), Fig. 3", "(17)", "(18)", "(22)", "(27), G0", "(27), Gk",
        ),
        "method": ("(21) → (22)",), "as-scanned": ("(1)", "(3), Fig. 2", "(15), (16), (20)", "(19)", "(28)", "(29)"),
    },
}  # fmt: skip
"""Paper -> verdict -> where, in the order of the paper; every other row agrees."""
LIFT, UNIT, SIX_BAR, PICKER, DRD = (
    "transfer_lift",
    "transfer_unit",
    "lecture_six_bar",
    "card_picker",
    "dwell_rise_dwell",
)


def verdict(paper: str, where: str, example: str, **values: Any) -> str:
    """Of an example with some of its values changed, by their paths with __ for a dot."""
    design = EXAMPLES.design(example)
    for path, value in values.items():
        design = put(design, path.replace("__", "."), value)
    (claim,) = [c for c in claims(paper, Examples({example: design})) if c.where == where]
    return claim.verdict


@pytest.mark.parametrize("paper", PAPERS)
def test_each_place_where_print_and_truth_part_has_its_kind_and_no_other_place_has_one(paper: str) -> None:
    found = {claim.where: claim.verdict for claim in quick_claims() if claim.paper == paper}
    kinds = {
        kind: tuple(where for where, each in found.items() if each == kind) for kind in VERDICTS if kind != "agrees"
    }
    assert {kind: rows for kind, rows in kinds.items() if rows} == {
        kind: tuple(where for where in rows if (paper, where) not in SLOW)
        for kind, rows in OTHER_THAN_AGREES[paper].items()
    }
    assert len(found) == sum(claim.paper == paper for claim in quick_claims()), "each place once"


@pytest.mark.stress
def test_the_slow_places_have_their_kind_too() -> None:
    differing = OTHER_THAN_AGREES["kim1990"]["differs"]
    for paper, where in SLOW:
        assert at(paper, where).verdict == ("differs" if where in differing else "agrees"), where


def test_every_verdict_turns_with_its_numbers() -> None:
    for claim in quick_claims():
        numbers = claim.numbers
        if {"printed", "corrected", "bound"} <= numbers.keys():
            assert turned(claim, printed=0.0) == "agrees", claim.where
            assert turned(claim, corrected=1e9) == "differs", claim.where
        elif {"used", "elsewhere", "bound"} <= numbers.keys():
            assert turned(claim, elsewhere=0.0) == "agrees", claim.where
            assert turned(claim, used=1.0) == "differs", claim.where
        elif {"symbol", "needed", "known", "bound"} <= numbers.keys():
            (right,) = numbers["known"]
            assert turned(claim, symbol=right) == "agrees", claim.where
            assert turned(claim, needed=1.01 * numbers["needed"]) == "differs", claim.where
        elif {"radius", "example_radius", "digits"} <= numbers.keys():
            assert turned(claim, radius=numbers["example_radius"]) == "agrees", claim.where
            assert turned(claim, digits=2) == "differs", claim.where
            assert turned(claim, example_radius=numbers["radius"]) == "differs", claim.where
        elif {"off", "bound"} <= numbers.keys() and "carried" not in numbers:
            assert turned(claim, off=1e9) == "differs", claim.where
            assert turned(claim, off=0.0) == "agrees", claim.where
        elif all(isinstance(value, ComparedNumber) for value in numbers.values()):
            for name, value in numbers.items():
                far = value.printed + 2.0 * max(value.within, value.rounded) + 1e-6
                other = ComparedNumber(value.printed, far, value.within, value.unit, value.rounded)
                assert turned(claim, **{name: other}) == "differs", (claim.where, name)


OTHERS: tuple[tuple[str, str, str, dict[str, Any]], ...] = (
    ("shin1995", "Table 1", "differs", {"measures": {"MAIN.C": 1.0, "KINE.C": 0.0}}),
    ("shin1995", "Fig. 14, §6.1", "differs", {"names": ("feed", "clamp", "lift")}),
    ("shin1995", "Fig. 14, §6.1, motion", "differs", {"travel": {"Lift": 150.0, "Clamp": 40.0}}),
    ("shin1995", "Fig. 15, §6.2", "differs", {"strokes": ((35.0, 76.5, -150.0),)}),
    ("shin1995", "Fig. 16", "differs", {"layout": ("left", "below", "left")}),
    ("shin1995", "Fig. 1", "differs", {"force": {"a": -1.0}}),
    ("shin1995", "Fig. 19", "differs", {"motor_swing": 1e4}),
    ("shin1995", "Fig. 20", "differs", {"motor": 4000.0}),
    ("shin1995", "Fig. 20", "differs", {"runs": False}),
    ("yang", "Table 1", "differs", {"blending": False}),
    ("yang", "Fig. 1", "differs", {"curves": ("C1", "H1")}),
    ("yang", "Table 2", "differs", {"compatible": (("C1", "H1"), *18 * (("C1",),))[:18]}),
    ("yang", "§3.1", "differs", {"free": (1,)}),
    ("shin1995", "§6.4, Fig. 17", "agrees", {"shown": (16, 17)}),
    ("shin1995", "§6.4, Fig. 17", "differs", {"shown": ()}),
    ("yang", "§3.1, Cv", "agrees", {"determining": ("h1", "h2", "h3")}),
    ("yang", "§3.1, Cv", "differs", {"determining": ()}),
    ("yang", "(8)", "agrees", {"low_open": False}),
    ("yang", "Fig. 4", "agrees", {"spans": (18.846, 169.613, 14.801, 96.740)}),
    ("yang", "Fig. 4", "differs", {"carried": (18.847, 169.613, 14.801, 96.740)}),
    ("yang", "Fig. 4", "differs", {"off": 1e-3}),
    ("yang", "Fig. 4, table", "agrees", {"rows": {"C1 to": (48.85, 48.8468, 48.8459, 5e-3)}}),
    ("yang", "Fig. 4, table", "differs", {"rows": {"C1 to": (48.85, 48.86, 48.86, 5e-3)}}),
    ("velocity", "p. 11, A", "agrees", {"I12I13": ComparedNumber(20.07, 20.074, 5e-3, "cm", 1e-2)}),
    ("yang", "Fig. 3", "differs", {"fewest": 3}),
    ("yang", "§3.2, 4)", "differs", {"length": 149.0}),
    ("yang", "Concl.", "differs", {"passed": 0}),
    ("yang", "Concl.", "differs", {"errors": 1}),
    ("velocity", "p. 1", "differs", {"off": 0.01}),
    ("velocity", "p. 8", "differs", {"count": 14}),
    ("velocity", "p. 12", "differs", {"along": 0.0}),
    ("velocity", "p. 12", "differs", {"opposite": 0.0}),
    ("kim1990", "Fig. 3, §1", "differs", {"stroke": 0.0}),
    ("kim1990", "§6 (1)", "agrees", {"points": ((0.85, 0.1, 0.019),)}),
    ("kim1990", "§6, Figs. 9-12", "agrees", {"points": ((9, "stable", "stable"), (12, "unstable", "unstable"))}),
)


@pytest.mark.parametrize(("paper", "where", "wanted", "numbers"), OTHERS)
def test_the_other_verdicts_turn_too(paper: str, where: str, wanted: str, numbers: dict[str, Any]) -> None:
    claim = at(paper, where)
    assert claim.verdict != wanted
    assert turned(claim, **numbers) == wanted


def test_verdicts_turn_with_the_design() -> None:
    lift = partial(verdict, "shin1995", example=LIFT)
    drd, picker = (partial(verdict, "yang", example=name) for name in (DRD, PICKER))
    assert lift("(18)", shaft__rotation="cw") == "agrees", (
        "φ' counted against a cam that turns clockwise is the printed one"
    )
    assert lift("Table 2, IA", follower__rod_mm=846.0) == "differs", "m (L2/2)²/9.81 is another number then"
    assert lift("Table 3, IR", follower__roller_arm_mm=650.0) == "differs"
    assert lift("Table 2", follower__rod_mm=846.0) == "differs"
    assert lift("§6.4, Fig. 17", follower__layout="a") == lift("Fig. 16", follower__layout="a") == "differs"
    assert lift("Fig. 2, §6.4", follower__rod_mm=846.0) == "differs"
    assert lift("Fig. 19", shaft__flywheel_inertia_kg_m2=500.0) == "differs", "the motor stalls"
    assert lift("Fig. 20", shaft__flywheel_inertia_kg_m2=500.0) == "differs"
    assert lift("Fig. 20", shaft__flywheel_inertia_kg_m2=0.0) == "agrees", "then of the size that is needed"
    assert lift("Fig. 17", **{"motion__segments[1]__law": "parabolic"}) == "differs"
    assert lift("Table 2, IL", loads__arm_inertia_kg_m2=0.0016) == "differs"
    assert drd("(1)", **{"motion__segments[1]__rise_mm": 6.0, "motion__segments[2]__rise_mm": 9.0}) == "differs"
    assert (
        picker("Fig. 4", **{"motion__segments[3]__span_deg": 14.0, "motion__segments[4]__span_deg": 97.5316460638})
        == "differs"
    )
    assert verdict("velocity", "p. 11, A", SIX_BAR, **{"linkage__links[2]__points__B": (69.0, 0.0)}) == "differs"
    assert verdict("shin1995", "Fig. 14, §6.1", UNIT, **{"drives[1]__name": "Press"}) == "differs"


# -- against numbers from outside ---------------------------------------------------------------------------


def test_numbers_from_outside() -> None:
    """By hand, or as the papers' other numbers say them."""
    centre, contact = at("shin1995", "(18)").numbers, at("shin1995", "(19), (20)").numbers
    assert centre["printed"] == pytest.approx(532.0, abs=0.2)
    assert (contact["below"], contact["axes"]) == (pytest.approx(2.0 * 150.0, abs=1e-9), pytest.approx(3.85, abs=5e-3))
    assert max(contact["used"], contact["corrected"]) < 1e-12
    arm, rod, roller = (at("shin1995", where).numbers for where in ("Table 2, IL", "Table 2, IA", "Table 3, IR"))
    assert (arm["in_kgf"], arm["taken"], arm["r"]) == pytest.approx((16.588, 16.588, 158.084), abs=5e-4)
    assert arm["centre"] == 0.0
    assert (rod["decoded"], rod["digits"], rod["r"]) == (2274.544, 0, 422.5), "to all digits of the print"
    assert rod["taken"] == pytest.approx(125.0 * 0.845**2 / 12.0, abs=5e-3)
    assert (roller["decoded"], roller["digits"], roller["value"]) == (2160.577, 1, 2110.577)
    substituted = at("shin1995", "(7)").numbers
    assert substituted["denominator"] == 0.0
    assert f"{substituted['in_doubles']:.14f}" == "-179.99995659200766"
    assert substituted["in_doubles"] == pytest.approx(-179.99995659200765, abs=6e-14), "fifty digits: none is lost"
    assert max(at("shin1995", where).numbers["used"] for where in ("(9)", "(10)")) < 1e-12
    read = at("shin1995", "Table 1, FILEIO.C").numbers
    assert (read["fitted"], read["columns"], read["rows"]) == (3, 3, 360)
    assert read["off"] < 1e-9
    speeds = at("shin1995", "(15)-(17), Fig. 4").numbers
    assert (speeds["centre"], speeds["roller"]) == pytest.approx((0.7130682, 0.3816007), abs=2e-7), (
        "by a chain of one's own"
    )
    twice = at("shin1995", "(24)").numbers["difference"]
    peak = EXAMPLES.study(LIFT).linkage.coordinates["phi"][2]
    assert twice == pytest.approx(
        50.0 * 0.651081**2 * float(np.abs(peak).max()) * (20.0 * math.pi / 30.0) ** 2, rel=1e-12
    )
    assert at("shin1995", "Fig. 17").numbers["velocity"] == pytest.approx(4.0 * math.pi / (4.0 + math.pi), rel=1e-9)
    picker = at("yang", "Fig. 4").numbers
    assert picker["spans"] == pytest.approx((18.8468353936, 169.621518543, 14.8022699040, 96.7293761598), abs=1e-9)
    assert [round(span, 3) for span in picker["carried"]] == [18.846, 169.613, 14.801, 96.740]
    assert (picker["end"], picker["end_carried"]) == (pytest.approx(216.0 / 41.0, rel=1e-14), 5.27)
    assert at("yang", "§3.2, 3)").numbers["h3"] == pytest.approx(0.5707, abs=5e-5)
    coupler = at("velocity", "p. 11, link 3").numbers
    assert (coupler["required"], coupler["rocker"]) == (
        pytest.approx(6.897436, abs=5e-7),
        pytest.approx(59.946, abs=5e-4),
    )
    psi = at("kim1990", "(22)").numbers
    assert (psi["printed"], psi["trace"], psi["trace_as_printed"]) == pytest.approx((3.75, 2.0036, 1.925), abs=2e-4)
    assert (at("kim1990", "(5)").numbers["needed"], at("kim1990", "(5)").numbers["factor"]) == pytest.approx(
        (0.2, 1.0), abs=1e-9
    )
    assert at("kim1990", "(1)").numbers["needed"] == pytest.approx(0.85**2, abs=1e-6)
    assert at("kim1990", "(13), right side").numbers["times"] == pytest.approx(1.0 / 0.009**2)
    widths = at("kim1990", "Fig. 8, §7, speed").numbers["widths"][1::2]
    assert widths == pytest.approx([3.68e-2, 1.91e-2, 2.36e-4, 4.48e-5, 3.0e-7], rel=5e-3), "of (22), with 34 digits"


# -- the command -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("paper", ["shin1995", stressed("all")])
def test_the_command_writes_every_row_with_its_table(
    paper: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("core.papers.Examples", lambda: EXAMPLES)
    assert main(["figures", paper, "--out", str(tmp_path), "--json"]) == 0
    printed = capsys.readouterr()
    rows = json.loads(printed.out)
    assert printed.err == "pictures left out: they need kindyna --headless\n"
    assert {tuple(row) for row in rows} == {("paper", "where", "says", "here", "verdict", "file")}
    assert [(row["paper"], row["where"], row["verdict"]) for row in rows] == [
        (c.paper, c.where, c.verdict) for c in every_claim() if paper in (c.paper, "all")
    ]
    assert paper != "all" or {row["verdict"] for row in rows} == set(VERDICTS), "a row of every kind"
    files = {row["file"] for row in rows}
    assert {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()} == files
    for row in rows:
        assert not re.search(r"\b(nan|None)\b", row["here"]), row
        assert not any(unicodedata.combining(letter) for letter in row["says"] + row["here"]), "dots that fonts lose"
        assert re.search(r"\d", row["here"]) or row["where"] == "Fig. 16", row
    for name in files:
        names, *lines = list(csv.reader((tmp_path / name).read_text("utf-8").splitlines()))
        assert lines, name
        assert {len(line) for line in lines} == {len(names)}, name


@pytest.mark.parametrize("paper", PAPERS)
def test_a_paper_lists_the_examples_of_its_claims(paper: str) -> None:
    assert set(PAPERS[paper].examples) == {row.example for row in PAPERS[paper].rows}


def test_the_papers_own_figures_are_all_there() -> None:
    names = {paper: {claim.name for claim in every_claim() if claim.paper == paper} for paper in PAPERS}
    assert {f"figure_{n}" for n in (1, 2, 14, 16, 17, 18, 19, 20)} | {f"table_{n}" for n in (1, 2, 3)} <= names[
        "shin1995"
    ]
    assert {"table_1", "table_2", *(f"figure_{n}" for n in (1, 2, 3, 4))} <= names["yang"]
    assert {f"({n})" for n in range(1, 9)} <= {claim.where for claim in every_claim() if claim.paper == "yang"}
    assert {f"page_{page}_step_{n}" for page, last in ((6, 2), (7, 2), (8, 8)) for n in range(last + 1)} <= names[
        "velocity"
    ]
    assert {f"figure_{n}" for n in range(2, 13)} <= names["kim1990"]


def test_one_paper_as_text(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("core.papers.Examples", lambda: EXAMPLES)
    assert main(["figures", "yang", "--out", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert text.startswith("Yang and Shon")
    assert text.count("the paper:") == sum(claim.paper == "yang" for claim in every_claim())
    counts = Counter(claim.verdict for claim in every_claim() if claim.paper == "yang")
    assert [line.split(maxsplit=2) for line in text.rsplit("\n\n", 1)[1].splitlines()] == [
        [str(counts[verdict]), verdict, meaning] for verdict, meaning in VERDICTS.items() if counts[verdict]
    ]


def test_help_has_every_kind_of_verdict_in_the_words_of_the_list() -> None:
    page = (resources() / "help" / "papers.md").read_text("utf-8")
    rows = [
        tuple(cell.strip() for cell in line.strip("|").split("|")) for line in page.splitlines() if line.startswith("|")
    ]
    assert rows[2:] == list(VERDICTS.items())


def test_a_paper_that_there_is_none_of_is_refused(tmp_path: Path) -> None:
    assert main(["figures", "euler", "--out", str(tmp_path)]) == 2


def test_nothing_is_computed_of_a_row_that_is_not_read() -> None:
    made: list[str] = []

    class Watched(Examples):
        def design(self, name: str) -> Any:
            made.append(name)
            return super().design(name)

    rows: list[Claim] = [claim for paper in PAPERS for claim in claims(paper, Watched())]
    assert [claim.title for claim in rows]
    assert made == []
