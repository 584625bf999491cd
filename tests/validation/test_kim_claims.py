"""The table of ``stability --claims``: every verdict follows from the numbers beside it, and turns when they do."""

import io
import re
from contextlib import redirect_stdout
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from paper_claims import EXAMPLES, of_paper, turned
from sampled import stressed

from core.__main__ import main
from core.papers import Claim
from core.papers.kim1990_chart import readings as kim_readings
from core.papers.kim1990_chart import shaft_of
from core.stability import Verdict
from kindyna_gui.stability_pages import verdict_table, waiting_text

EXAMPLE = Path(__file__).parents[2] / "resources" / "examples" / "kim_1990.toml"
STABLE, UNSTABLE, SILENT = Verdict("steady", True), Verdict("steady", False), Verdict("steady", None)
LEFT = Verdict("steady", True, contact_lost=0.5)


@cache
def command() -> str:
    """What ``stability --claims`` prints; its rows are those of the table."""
    text = io.StringIO()
    with redirect_stdout(text), pytest.MonkeyPatch.context() as patch:
        patch.setattr("core.papers.Examples", lambda designs: EXAMPLES)
        assert main(["stability", str(EXAMPLE), "--claims"]) == 0
    return text.getvalue()


def row(start: str) -> Claim:
    (claim,) = [claim for claim in of_paper("kim1990") if claim.says.startswith(start)]
    return claim


def changed(values: np.ndarray, **at: float) -> np.ndarray:
    """A copy with some tongues' values: n7=0.5 is the seventh's."""
    values = values.copy()
    for name, value in at.items():
        values[int(name[1:]) - 1] = value
    return values


def test_the_spring_as_printed_is_a_misprint_while_it_makes_the_shaft_run_away() -> None:
    claim = row("the spring's term")
    assert claim.numbers["printed"] == pytest.approx(2.0 * np.pi * 0.85)
    assert claim.verdict == "misprint"
    assert turned(claim, printed=0.0) == "agrees"
    assert turned(claim, corrected=0.1) == "differs"


def test_psi_as_printed_is_a_misprint_while_its_mean_is_not_zero() -> None:
    claim = row("ψ holds")
    # the mean over 2π of 2a (4 cos² 2θ + sin² 2θ) on 0 ... π is a (4 + 1)/2
    assert claim.numbers["printed"] == pytest.approx(3.75)
    assert claim.verdict == "misprint"
    assert turned(claim, printed=0.0) == "agrees"
    assert turned(claim, corrected=0.5) == "differs"


def test_22_stands_for_21_only_where_their_tongues_meet() -> None:
    claim = row("(22) stands for (21)")
    assert claim.verdict == "method"
    assert turned(claim, approximate=claim.numbers["exact"]) == "agrees"


def test_resonance_at_whole_numbers_only_where_nothing_is_open_between() -> None:
    claim = row("parametric resonance at 1/N")
    widths = claim.numbers["widths"].copy()
    assert claim.verdict == "differs"
    widths[::2] = 0.0
    assert turned(claim, widths=widths) == "agrees"
    assert turned(claim, widths=changed(widths, n11=1e-6)) == "differs"
    assert turned(claim, widths=changed(widths, n10=0.0)) == "differs"


def test_the_widest_tongues_are_at_1_and_2_only_where_both_exceed_every_other() -> None:
    """By (22), of which Fig. 8 is made, they are 0.0227 wide at 0.5 and 0.0328 at 1.5, and 0.0191 at 2."""
    claim = row("the tongues at η ≈ 1 and 2")
    widths = claim.numbers["widths"]
    assert widths[[0, 2, 3]] == pytest.approx([0.0227, 0.0328, 0.0191], abs=5e-5)
    assert claim.verdict == "differs"
    wide = changed(widths, n4=0.035)
    assert turned(claim, widths=wide) == "agrees"
    assert turned(claim, widths=changed(wide, n11=0.036)) == "differs"
    assert turned(claim, widths=changed(wide, n2=0.02)) == "differs"


def test_tongues_widen_with_q_where_every_one_does() -> None:
    claim = row("tongues widen with Q")
    small, large = claim.numbers["small"], claim.numbers["large"]
    assert claim.verdict == "agrees"
    assert turned(claim, large=changed(large, n6=small[5])) == "differs"


def test_tongues_widen_towards_small_eta_where_each_exceeds_the_next() -> None:
    claim = row("tongues widen towards")
    assert claim.verdict == "agrees", "by (22)"
    assert "3.68e-02 at η ≈ 1, 1.91e-02 at η ≈ 2, 2.36e-04 at η ≈ 3, 4.48e-05 at η ≈ 4, 3.00e-07 at η ≈ 5" in claim.here
    assert turned(claim, widths=claim.numbers["exact"]) == "differs", (
        "by (21) the one at 4 is twice as wide as that at 3"
    )


def test_eleven_by_eleven_is_held_against_the_width_of_each_tongue() -> None:
    claim = row("ten harmonics")
    off, widths = claim.numbers["off"], claim.numbers["widths"]
    assert off[7] / widths[7] == pytest.approx(0.5, abs=0.01), "half of the tongue at η ≈ 4"
    assert off.size == widths.size == 11
    assert claim.verdict == "differs"
    for word in ("0.5 of it at 4", "55 of it at 5", "at η ≈ 5.5 the matrix has one edge only"):
        assert word in claim.here
    near = 0.05 * widths
    assert turned(claim, off=near) == "agrees"
    for n in range(1, 12):
        assert turned(claim, off=changed(near, **{f"n{n}": 0.5 * widths[n - 1]})) == "differs"


@pytest.mark.stress
def test_the_mean_wind_up_stays_small_where_it_is_and_rises() -> None:
    claim = row("for Q up to 0.1")
    means, slopes = claim.numbers["means"], claim.numbers["slopes"]
    assert claim.verdict == "agrees"
    assert turned(claim, means=means + 0.001) == "differs"
    assert turned(claim, means=means[[1, 0, 2, 3, 4, 5]]) == "differs"
    assert turned(claim, slopes=slopes[[1, 0, 2, 3, 4, 5]]) == "differs"


@pytest.mark.stress
def test_the_follower_leaves_the_cam_above_a_tenth_only_where_it_does() -> None:
    claim = row("the follower stays")
    q, points = claim.numbers["q"], [(eta, each, None) for eta, each, _ in claim.numbers["later"]]
    assert claim.verdict == "differs"
    assert turned(claim, is_lost=q > 0.1, later=points) == "agrees"
    assert turned(claim, is_lost=q > 0.05, later=points) == "differs"
    assert turned(claim, is_lost=q > 0.1) == "differs", "Figs. 11 and 12 leave it later"


@pytest.mark.parametrize(("start", "stable", "state"), [
    ("η = 0.85", True, "stable"), ("η = 0.90", False, "stable"), ("η = 2.10", True, "stable"),
    stressed("η = 2.00", False, "contact lost"),
])  # fmt: skip
def test_a_point_of_the_chart_is_what_its_steady_response_is(start: str, stable: bool, state: str) -> None:
    claim = row(start)
    others = claim.numbers["models"][:-1]
    assert claim.numbers["stable"] is stable
    assert claim.numbers["models"][-1].state == state
    assert claim.verdict == ("agrees" if stable else "differs")
    assert turned(claim, stable=not stable) == ("agrees" if start == "η = 0.90" else "differs"), (
        "off the cam it is neither"
    )
    assert turned(claim, models=(*others, UNSTABLE)) == ("differs" if stable else "agrees")
    for other in (SILENT, LEFT):
        assert turned(claim, models=(*others, other)) == "differs"
    assert {turned(claim, models=(*others, each)) for each in (STABLE, UNSTABLE)} == {"agrees", "differs"}


@pytest.mark.stress
def test_fig_12_leaves_the_cam_in_every_turn_in_the_window_in_the_command_and_in_the_row(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Steady at (2.00, 0.05): the contact force of the turn, integrated apart, falls through zero at y = 0.0591598."""
    claim = row("η = 2.00")
    steady = claim.numbers["models"][-1]
    assert steady.contact_lost == pytest.approx(0.0591598, abs=1e-7)
    assert "steady response contact lost, it leaves the cam at y = 0.0592 of each turn" in claim.here
    assert '">contact lost' in verdict_table((steady,))
    assert waiting_text((steady,), False).startswith("steady: contact lost, ")
    assert main(["stability", str(EXAMPLE), "--at", "2,0.05"]) == 0
    (line,) = [
        line
        for line in capsys.readouterr().out.splitlines()
        if line.startswith("About the true steady") and "34.9270" in line
    ]
    assert "contact lost" in line


@pytest.mark.stress
def test_no_reading_of_the_print_makes_fig_10_unstable_and_one_that_did_would_be_named() -> None:
    claim = row("η = 0.90")
    readings = claim.numbers["readings"]
    assert len(readings) == 6
    assert "of 6 readings of the print none makes it so: " in claim.here
    told = replace(claim, given={**claim.numbers, "readings": {**readings, "(22) with X''X''": False}}).here
    assert "of 6 readings of the print (22) with X''X'' makes it so" in told
    assert "readings" not in row("η = 2.00").here, "(22) says what the paper says"
    coefficients = shaft_of(EXAMPLES).coefficients
    printed = kim_readings(coefficients, 2.0, 0.05)
    assert printed["(22) with X''X''"] is True, "trace 1.925"
    assert printed["(27) with 11 x 11 terms"] is printed["(17) with -Me"] is False, (
        "2.00 lies within the tongue of (22)"
    )


@pytest.mark.stress
def test_one_command_prints_the_papers_claims_against_ours() -> None:
    text = command()
    head, *rows, counts = text.strip().split("\n\n")
    assert "1990" in head
    verdicts = dict(row.splitlines()[0].rsplit(": ", 1) for row in rows)
    assert verdicts["(13)"] == verdicts["(22)"] == "misprint"
    assert verdicts["Fig. 9"] == verdicts["Fig. 11"] == "agrees"
    assert verdicts["Fig. 10"] == verdicts["Fig. 12"] == "differs"
    assert verdicts["(21) → (22)"] == "method"
    assert verdicts["Fig. 8"] == verdicts["§6 (2)"] == "differs"
    assert not re.search(r"\b(nan|None|inf)\b", text)
    assert text.count("    the paper:") == text.count("    here:") == len(rows) == len(of_paper("kim1990"))
    assert sum(int(line.split()[0]) for line in counts.splitlines()) == len(rows)
    assert max(map(len, text.splitlines())) <= 108
    plain = " ".join(text.split())
    assert "it leaves it from Q = 0.3 on" in plain
    assert "at most 0.0192 for" in plain
    assert "max|β| = 0.172438 in 30 turns" in plain
    assert "approximate (22) unstable, e^0.060 a turn; exact (21) stable; steady response contact lost" in plain
    assert plain.count("steady response stable") == 3, "the last word"
