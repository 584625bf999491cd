"""What blending reads at one point, and what it does not compute there."""

import math
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from blend_cases import request
from references import EPS, MP, off

from core.blend import CONSTANT_VELOCITY, MOTION_TYPES, Family, Request, Task, blend, sequences
from core.blend.equations import Equations
from core.blend.metering import Meter
from core.blend.solver import Problem
from core.blend.wishes import Wish

FAMILIES = {
    str(s): Family(s)
    for kind, row in MOTION_TYPES.items()
    if row.rise
    for constant in CONSTANT_VELOCITY
    if row.back or constant not in ("return", "both")
    for s in sequences(kind, constant)
    if len(s.rise) > 1
}
RATIOS = (1.0, 1.3)


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.parametrize("ratio", RATIOS)
def test_one_point_is_read_as_many_are(name: str, ratio: float) -> None:
    equations = FAMILIES[name].equations(Task(1.0, ratio, 1.0))
    names, chance = tuple(equations.forms), np.random.default_rng(1995)
    t, x = chance.uniform(0.05, 3.0, 20), chance.uniform(0.0, 1.0, (len(equations.numbers), 20))
    values = equations.values(t, x)
    for i, (at, place) in enumerate(zip(t, x.T, strict=True)):
        terms = equations.terms(names, at, place)
        sizes = [math.fsum(map(abs, row)) for row in terms]
        assert (np.abs(equations.at(names, at, place) - values[:, i]) <= 4e-15 * np.array(sizes)).all()
        assert equations.at(["", names[-1], ""], at, place) == [1.0, equations.at(names, at, place)[-1], 1.0]


@pytest.mark.parametrize("t", [0.0, 5e-324, 1e-200, 1e200, math.inf])
def test_no_point_is_too_far_out_to_be_read(t: float) -> None:
    """What has no value there is infinite or none, and not feasible."""
    for family in FAMILIES.values():
        meter = Meter(family, Task(1.0, 1.3, 1.0))
        x = (0.5,) * len(meter.equations.numbers)
        assert len(meter.equations.at(meter.equations.forms, t, x)) == len(meter.equations.forms)
        if meter.equations.top == math.inf:
            assert not meter.is_feasible(t, x)


def test_a_wish_that_is_met_asks_for_no_derivatives(monkeypatch: pytest.MonkeyPatch) -> None:
    """Yang's card picker: the exact equations leave but a rounding, which is seen without them."""
    asked = []
    whole = Equations.unguarded_slopes

    def counted(self: Equations, t: float, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        asked.append(t)
        return whole(self, t, x)

    monkeypatch.setattr(Equations, "unguarded_slopes", counted)
    blend(request("DRRD", "rise", {"h1": 1.0, "h3": 1.0}))
    assert not asked
    blend(request("DRRD", "rise", {"h1": 1.0, "acceleration": 0.012}))
    assert asked, "an acceleration is polished"


def test_a_wish_that_is_missed_is_found_so_without_derivatives_too() -> None:
    """The short way answers as the long one: a miss of 1e-12 is polished away, what cannot be met is not met."""
    meter = Meter(FAMILIES["C1-CV1-H2-P2"], Task(20.0, 20.0, 300.0))
    wishes = [Wish("h1", 0.05), Wish("h3", 0.05)]
    exact = math.sqrt(0.05)
    for t in (exact, exact * (1.0 + 1e-12), exact * 1.1):
        found, x, met = meter.polished(wishes, t, (0.05,), 1e-4)
        assert met
        assert (found, *x) == pytest.approx((exact, 0.05), rel=1e-15)
    assert not meter.polished([Wish("h3", 0.05), Wish("h3", 0.06)], exact, (0.05,), 1e-4)[2]


def test_of_equally_gentle_motions_always_the_same_is_answered() -> None:
    """A rise and the same run backwards have one acceleration: neither the stroke's size nor the span's chooses."""
    shares = []
    for stroke, span in ((20.0, 300.0), (7.3, 211.0), (1e-3, 299.9), (333.0, 17.0), (20.1, 123.4), (0.7, 262.01)):
        wanted = {"h2": 0.2 * stroke, "acceleration": 9.0 * stroke / span**2}
        answer = blend(Request("DRD", stroke, 0.0, span, "rise", wanted, sequence="C1-CV1-C2")).solution
        shares.append([h / stroke for h in answer.heights])
    assert shares[0][0] > 1.2 * shares[0][2], "of the two, that of the lower height at the top"
    for one, other in pairwise(shares):
        assert one == pytest.approx(other, rel=1e-11)


ASKED = {
    "C1-CV1-C2": ("DRD", "rise", {"h1": 0.21, "h3": 0.13}),
    "C1-H2-H3-C4": ("DRRD", "none", {"h1": 0.37, "h6": 0.23}),
    "C1-CV1-H2-P2": ("DRRD", "rise", {"h1": 0.21, "h3": 0.13}),
    "C1-CV1-H2-H3-CV2-C4": ("DRRD", "both", {"h1": 0.21, "h3": 0.13, "h4": 0.17, "h6": 0.31}),
    "H1-CV1-H2-H3-H4": ("RRR", "rise", {"h1": 0.21, "h3": 0.13}),
}


@pytest.mark.parametrize("name", ASKED)
def test_a_height_that_is_asked_for_is_answered_to_the_last_bit(name: str) -> None:
    """It comes back through shares of the stroke and roots: 1.47 mm shall not be answered as 1.4699999999999998."""
    kind, constant, shares = ASKED[name]
    for stroke in (7.0, 20.3, 33.33, 61.7, 89.9):
        wanted = {height: round(share * stroke, 2) for height, share in shares.items()}
        answer = blend(Request(kind, stroke, 0.0, 300.0, constant, wanted, sequence=name)).solution
        told = dict(zip(FAMILIES[name].heights, answer.heights, strict=False))  # the one curve of a return has no name
        assert {height: told[height] for height in wanted} == wanted


@pytest.mark.parametrize(("ratio", "peak"), [(1.9, 0.33176846199487847), (1.0, 0.4063028646255184), (0.4, 0.55), (1.0, 0.42)])
def test_an_end_of_a_range_is_as_exact_as_what_is_asked(ratio: float, peak: float) -> None:
    """C1-CV1-H2-P2 with the span of its rise given: h1 is greatest where h2 = 0, in closed form from t = √h3. Of the first two
    rises hardly a shorter one is feasible: one rounding of what is asked moves the end by a hundred millionth."""

    def end(share: mpmath.mpf) -> mpmath.mpf:
        joined, bent = share / (1 - share) * MP.sqrt(MP.mpf(216) / 41 * ratio), MP.pi / 2 - 1
        root = (MP.sqrt(joined**2 + 8 * (1 - bent)) - joined) / (2 * (1 - bent))  # joined t - 1 - bent t² = h1 = 1 - t²
        return 1 - root**2

    problem = Problem(FAMILIES["C1-CV1-H2-P2"], Task(1.0, ratio, 1.0), [Wish("peak", peak), Wish("h1", 0.1)])
    found, exact = problem.ranges(1)[0], end(MP.mpf(peak))
    moved = abs(end(MP.mpf(peak) * (1 + MP.mpf(EPS))) - exact)
    assert off(found.high, exact) <= 4.0 * float(moved) + 4.0 * EPS
