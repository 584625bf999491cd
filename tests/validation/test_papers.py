"""The claims of all four papers: verdicts that follow from their numbers and turn with them, against numbers from outside."""

import csv
import json
import math
import re
from collections import Counter
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from paper_claims import EXAMPLES, at, every_claim, turned

from core.__main__ import main
from core.design import put
from core.papers import PAPERS, Claim, Examples, claims
from core.papers.claim import Compared

MISPRINTS = {
    "shin1995": ("(7)", "(9)", "(10)", "(18)", "(19), (20)", "(23)", "(24)", "Table 2, IL", "Table 2, IA", "Table 3, IR", "§6.4, ω0",
                 "§6.4, Fig. 17"),
    "yang": ("Table 1, CV2", "Fig. 4", "§3.2, 3)"),
    "velocity": ("p. 11, link 3",),
    "kim1990": ("(3), Fig. 2", "(4), Fig. 2", "(5)", "(13)", "(14), Fig. 3", "(17)", "(18)", "(19)", "(22)", "(27), G0", "(27), Gk", "(28)",
                "(29)"),
}  # fmt: skip
DIFFERENT = {
    "shin1995": ("(21)",),
    "yang": ("(8)",),
    "velocity": (),
    "kim1990": ("(21) → (22)", "Figs. 6, 7, contact", "§6 (1)", "§6 (2)", "Fig. 8, §7, places", "Fig. 8", "Fig. 8, §7, speed", "Fig. 10",
                "Fig. 12", "§6, Figs. 9-12"),
}
LIFT, UNIT, SIX_BAR, PICKER, DRD = "transfer_lift", "transfer_unit", "lecture_six_bar", "card_picker", "dwell_rise_dwell"


def verdict(paper: str, where: str, example: str, **values: Any) -> str:
    """Of an example with some of its values changed, by their paths with __ for a dot."""
    design = EXAMPLES.design(example)
    for path, value in values.items():
        design = put(design, path.replace("__", "."), value)
    (claim,) = [c for c in claims(paper, Examples({example: design})) if c.where == where]
    return claim.verdict


@pytest.mark.parametrize("paper", PAPERS)
def test_every_misprint_and_every_difference_is_a_row_and_nothing_else_is(paper: str) -> None:
    found = {claim.where: claim.verdict for claim in every_claim() if claim.paper == paper}
    assert tuple(where for where, each in found.items() if each == "misprint") == MISPRINTS[paper]
    assert tuple(where for where, each in found.items() if each == "differs") == DIFFERENT[paper]
    assert len(found) == sum(claim.paper == paper for claim in every_claim()), "each place once"


def test_every_verdict_turns_with_its_numbers() -> None:
    for claim in every_claim():
        numbers = claim.numbers
        if {"printed", "corrected", "bound"} <= numbers.keys():
            assert turned(claim, printed=0.0) == "agrees", claim.where
            assert turned(claim, corrected=1e9) == "differs", claim.where
        elif {"off", "bound"} <= numbers.keys():
            assert turned(claim, off=1e9) == "differs", claim.where
            assert turned(claim, off=0.0) == "agrees", claim.where
        elif all(isinstance(value, Compared) for value in numbers.values()):
            for name, value in numbers.items():
                other = Compared(value.printed, value.here + 2.0 * value.within + 1e-6, value.within)
                assert turned(claim, **{name: other}) == "differs", (claim.where, name)


OTHERS: tuple[tuple[str, str, str, dict[str, Any]], ...] = (
    ("shin1995", "Table 1", "differs", {"found": {"MAIN.C": 1.0, "KINE.C": 0.0}}),
    ("shin1995", "Fig. 14, §6.1", "differs", {"names": ("feed", "clamp", "lift")}),
    ("shin1995", "Fig. 14, §6.1, motion", "differs", {"way": {"Lift": 150.0, "Clamp": 40.0}}),
    ("shin1995", "Fig. 15, §6.2", "differs", {"strokes": ((35.0, 76.5, -150.0),)}),
    ("shin1995", "Fig. 16", "differs", {"found": ("left", "below", "left")}),
    ("shin1995", "Fig. 1", "differs", {"force": {"a": -1.0}}),
    ("shin1995", "Fig. 19", "differs", {"motor_swing": 1e4}),
    ("shin1995", "Fig. 20", "differs", {"motor": 4000.0}),
    ("shin1995", "Fig. 20", "differs", {"runs": False}),
    ("yang", "Table 1", "differs", {"blending": False}),
    ("yang", "Fig. 1", "differs", {"curves": ("C1", "H1")}),
    ("yang", "Table 2", "differs", {"found": (("C1", "H1"), *18 * (("C1",),))[:18]}),
    ("yang", "§3.1", "differs", {"free": (1,)}),
    ("yang", "(8)", "agrees", {"low_open": False}),
    ("yang", "Fig. 3", "differs", {"fewest": 3}),
    ("yang", "§3.2, 4)", "differs", {"length": 149.0}),
    ("yang", "Concl.", "differs", {"kept": 0}),
    ("yang", "Concl.", "differs", {"errors": 1}),
    ("velocity", "p. 1", "differs", {"off": 0.01}),
    ("velocity", "p. 8", "differs", {"found": 14}),
    ("velocity", "p. 12", "differs", {"along": 0.0}),
    ("velocity", "p. 12", "differs", {"opposite": 0.0}),
    ("kim1990", "Fig. 3, §1", "differs", {"stroke": 0.0}),
    ("kim1990", "§6 (1)", "agrees", {"points": ((0.85, 0.1, 0.019),)}),
    ("kim1990", "§6, Figs. 9-12", "agrees", {"found": ((9, True, True), (12, False, False))}),
    ("kim1990", "§7", "differs", {"steps": 10.0}),
)


@pytest.mark.parametrize(("paper", "where", "wanted", "numbers"), OTHERS)
def test_the_other_verdicts_turn_too(paper: str, where: str, wanted: str, numbers: dict[str, Any]) -> None:
    claim = at(paper, where)
    assert claim.verdict != wanted
    assert turned(claim, **numbers) == wanted


def test_verdicts_turn_with_the_design() -> None:
    lift = partial(verdict, "shin1995", example=LIFT)
    drd, picker = (partial(verdict, "yang", example=name) for name in (DRD, PICKER))
    assert lift("(18)", shaft__rotation="cw") == "agrees", "φ' counted against a cam that turns clockwise is the printed one"
    assert lift("Table 2", follower__rod_mm=846.0) == "differs"
    assert lift("§6.4, Fig. 17", follower__layout="a") == lift("Fig. 16", follower__layout="a") == "differs"
    assert lift("Fig. 2, §6.4", follower__rod_mm=846.0) == "differs"
    assert lift("Fig. 19", shaft__flywheel_inertia_kg_m2=500.0) == "differs", "the motor stalls"
    assert lift("Fig. 20", shaft__flywheel_inertia_kg_m2=500.0) == "differs"
    assert lift("Fig. 20", shaft__flywheel_inertia_kg_m2=0.0) == "agrees", "then of the size that is needed"
    assert lift("Fig. 17", **{"motion__segments[1]__law": "parabolic"}) == "differs"
    assert lift("Table 2, IL", loads__arm_inertia_kg_m2=0.0016) == "differs"
    assert drd("(1)", **{"motion__segments[1]__rise_mm": 6.0, "motion__segments[2]__rise_mm": 9.0}) == "differs"
    assert picker("Fig. 4", **{"motion__segments[3]__span_deg": 14.0, "motion__segments[4]__span_deg": 97.5316460638}) == "differs"
    assert verdict("velocity", "p. 11, A", SIX_BAR, **{"linkage__links[2]__points__B": (69.0, 0.0)}) == "differs"
    assert verdict("shin1995", "Fig. 14, §6.1", UNIT, **{"drives[1]__name": "Press"}) == "differs"


# -- against numbers from outside ---------------------------------------------------------------------------


def test_numbers_from_outside() -> None:
    """By hand, or as the papers' other numbers say them."""
    centre, contact = at("shin1995", "(18)").numbers, at("shin1995", "(19), (20)").numbers
    assert centre["printed"] == pytest.approx(532.0, abs=0.2)
    assert contact["below"] == pytest.approx(2.0 * 150.0, abs=1e-9)
    arm, rod, roller = (at("shin1995", where).numbers for where in ("Table 2, IL", "Table 2, IA", "Table 3, IR"))
    assert arm["in_kgf"] == pytest.approx(16.588, abs=5e-4) == arm["taken"]
    assert rod["parallel_kgf"] == pytest.approx(2274.544, abs=5e-4), "to all digits of the print"
    assert rod["taken"] == pytest.approx(125.0 * 0.845**2 / 12.0, abs=5e-3)
    assert (roller["in_kgf"], roller["parallel"]) == pytest.approx((20.70, 21.20), abs=5e-3)
    assert at("shin1995", "(7)").numbers["denominator"] == 0.0
    speeds = at("shin1995", "(15)-(17), Fig. 4").numbers
    assert (speeds["centre"], speeds["roller"]) == pytest.approx((0.7130682, 0.3816007), abs=2e-7), "by a chain of one's own"
    twice = at("shin1995", "(24)").numbers["apart"]
    peak = EXAMPLES.study(LIFT).linkage.coordinates["phi"][2]
    assert twice == pytest.approx(50.0 * 0.651081**2 * float(np.abs(peak).max()) * (20.0 * math.pi / 30.0) ** 2, rel=1e-12)
    assert at("shin1995", "Fig. 17").numbers["velocity"] == pytest.approx(4.0 * math.pi / (4.0 + math.pi), rel=1e-9)
    assert at("yang", "Fig. 4").numbers["printed"] == pytest.approx(4e-4, abs=2e-5)
    assert at("yang", "§3.2, 3)").numbers["h3"] == pytest.approx(0.5707, abs=5e-5)
    coupler = at("velocity", "p. 11, link 3").numbers
    assert (coupler["asked"], coupler["rocker"]) == (pytest.approx(6.897436, abs=5e-7), pytest.approx(59.946, abs=5e-4))
    psi = at("kim1990", "(22)").numbers
    assert (psi["printed"], psi["trace"], psi["trace_as_printed"]) == pytest.approx((3.75, 2.0036, 1.925), abs=2e-4)
    assert at("kim1990", "(5)").numbers["ratio"] == pytest.approx(1.0, abs=1e-4)


# -- the command -------------------------------------------------------------------------------------------


def test_the_command_writes_every_row_with_its_table(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("core.commands.figures.Examples", lambda: EXAMPLES)
    assert main(["figures", "all", "--out", str(tmp_path), "--json"]) == 0
    printed = capsys.readouterr()
    rows = json.loads(printed.out)
    assert printed.err == "pictures left out: they need kindyna --headless\n"
    assert {tuple(row) for row in rows} == {("paper", "where", "says", "here", "verdict", "file")}
    assert [(row["paper"], row["where"], row["verdict"]) for row in rows] == [(c.paper, c.where, c.verdict) for c in every_claim()]
    assert Counter(row["verdict"] for row in rows)["misprint"] == sum(map(len, MISPRINTS.values()))
    files = {row["file"] for row in rows}
    assert {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()} == files
    for row in rows:
        assert not re.search(r"\b(nan|None)\b", row["here"]), row
        assert re.search(r"\d", row["here"]) or row["where"] in ("Fig. 16", "§6.4, Fig. 17"), row
    for name in files:
        names, *lines = list(csv.reader((tmp_path / name).read_text("utf-8").splitlines()))
        assert lines, name
        assert {len(line) for line in lines} == {len(names)}, name


def test_the_papers_own_figures_are_all_there() -> None:
    names = {paper: {claim.name for claim in every_claim() if claim.paper == paper} for paper in PAPERS}
    assert {f"figure_{n}" for n in (1, 2, 14, 16, 17, 18, 19, 20)} | {f"table_{n}" for n in (1, 2, 3)} <= names["shin1995"]
    assert {"table_1", "table_2", *(f"figure_{n}" for n in (1, 2, 3, 4))} <= names["yang"]
    assert {f"({n})" for n in range(1, 9)} <= {claim.where for claim in every_claim() if claim.paper == "yang"}
    assert {f"page_{page}_step_{n}" for page, last in ((6, 2), (7, 2), (8, 8)) for n in range(last + 1)} <= names["velocity"]
    assert {f"figure_{n}" for n in range(2, 13)} <= names["kim1990"]


def test_one_paper_as_text(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("core.commands.figures.Examples", lambda: EXAMPLES)
    assert main(["figures", "yang", "--out", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert text.startswith("Yang and Shon")
    assert text.count("the paper:") == sum(claim.paper == "yang" for claim in every_claim())
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
