"""Blending to the last digits: given heights, ends of ranges, and which of equally gentle motions is chosen."""

from itertools import pairwise

import mpmath
import pytest
from blend_cases import as_motion
from references import EPS, MP, off

from core.blend import Request, blend, feasible_ranges


def test_of_equally_gentle_motions_always_the_same_is_chosen() -> None:
    """A rise and the same run backwards have one acceleration: neither the stroke's size nor the span's chooses."""
    shares = []
    for stroke, span in ((20.0, 300.0), (7.3, 211.0), (1e-3, 299.9), (333.0, 17.0), (20.1, 123.4), (0.7, 262.01)):
        wanted = {"h2": 0.2 * stroke, "acceleration": 9.0 * stroke / span**2}
        answer = blend(Request("DRD", stroke, 0.0, span, "rise", wanted, sequence="C1-CV1-C2")).solution
        shares.append([h / stroke for h in answer.heights])
    assert shares[0][0] > 1.2 * shares[0][2], "of the two, that of the lower height at the top"
    for one, other in pairwise(shares):
        assert one == pytest.approx(other, rel=1e-11)


GIVEN = {
    "C1-CV1-C2": ("DRD", "rise", {"h1": 0.21, "h3": 0.13}),
    "C1-H2-H3-C4": ("DRRD", "none", {"h1": 0.37, "h6": 0.23}),
    "C1-CV1-H2-P2": ("DRRD", "rise", {"h1": 0.21, "h3": 0.13}),
    "C1-CV1-H2-H3-CV2-C4": ("DRRD", "both", {"h1": 0.21, "h3": 0.13, "h4": 0.17, "h6": 0.31}),
    "H1-CV1-H2-H3-H4": ("RRR", "rise", {"h1": 0.21, "h3": 0.13}),
}


@pytest.mark.parametrize("name", GIVEN)
def test_a_height_that_is_given_comes_back_to_the_last_bit(name: str) -> None:
    """It comes back through shares of the stroke and roots: 1.47 mm shall not be answered as 1.4699999999999998."""
    kind, constant, shares = GIVEN[name]
    for stroke in (7.0, 20.3, 33.33, 61.7, 89.9):
        wanted = {height: round(share * stroke, 2) for height, share in shares.items()}
        answer = as_motion(blend(Request(kind, stroke, 0.0, 300.0, constant, wanted, sequence=name))).settings()
        assert {height: answer[height] for height in wanted} == wanted


@pytest.mark.parametrize(
    ("ratio", "peak"), [(1.9, 0.33176846199487847), (1.0, 0.4063028646255184), (0.4, 0.55), (1.0, 0.42)]
)
def test_an_end_of_a_range_is_as_exact_as_the_settings(ratio: float, peak: float) -> None:
    """C1-CV1-H2-P2 with the span of its rise given: h1 is greatest where h2 = 0, in closed form from t = √h3. Of the first two
    rises hardly a shorter one is feasible: one rounding of the setting moves the end by a hundred millionth."""

    def end(share: mpmath.mpf) -> mpmath.mpf:
        joined, bent = share / (1 - share) * MP.sqrt(MP.mpf(216) / 41 * ratio), MP.pi / 2 - 1
        root = (MP.sqrt(joined**2 + 8 * (1 - bent)) - joined) / (2 * (1 - bent))  # joined t - 1 - bent t² = h1 = 1 - t²
        return 1 - root**2

    wanted = Request("DRRD", 1.0, 0.0, 1.0, "rise", {"peak": peak}, return_stroke=ratio, sequence="C1-CV1-H2-P2")
    found, exact = feasible_ranges(wanted, "h1")[0], end(MP.mpf(peak))
    moved = abs(end(MP.mpf(peak) * (1 + MP.mpf(EPS))) - exact)
    assert off(found.high, exact) <= 4.0 * float(moved) + 4.0 * EPS
