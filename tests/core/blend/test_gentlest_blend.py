"""The gentlest of all blended motions, against motions drawn by chance and closed forms."""

import math
import random
from typing import Any

import numpy as np
import pytest
from blend_cases import as_motion, request
from blends import SEQUENCES, Motion, check_joins, free_motion
from sampled import spread

from core.blend import GOALS, BlendError, Request, best, blend

PI = math.pi
H, SPAN = 20.0, 300.0

COEFFICIENTS = {
    "acceleration": {"C": math.pi, "H": math.pi**2 / 4, "C5": 2 * math.pi, "H5": math.pi**2 / 2, "P": 216 / 41},
    "jerk": {"C": math.pi**2, "H": math.pi**3 / 8, "C5": 4 * math.pi**2, "H5": math.pi**3 / 2, "P": 36.58536585},
    # max of |v a|: (1 - cos x) π sin x at x = 2π/3, sin x cos x π³/8, ...
    "torque": {"C": math.pi * 1.5 * math.sin(2 * math.pi / 3), "H": math.pi**3 / 16, "C5": 8.1620971, "H5": math.pi**3 / 8,
               "P": 5.86208785},
}  # fmt: skip
POWERS = {"acceleration": (1, 2), "jerk": (1, 3), "torque": (2, 3)}


def cost(motion: Motion, goal: str) -> float:
    rows = COEFFICIENTS[goal]
    i, k = POWERS[goal]
    alike = {"C6": "C5", "H6": "H5"}
    return max(
        rows.get(alike.get(c, c), rows[c[0]]) * h**i / b**k
        for c, h, b in zip(motion.curves, motion.heights, motion.spans, strict=True)
        if not c.startswith("CV")
    )


def test_the_coefficients_of_this_file() -> None:
    u = np.linspace(0.0, 1.0, 200_001)
    p = np.polynomial.Polynomial([0, 0, 0, 250, 0, -852, 1096, -558, 105]) / 41
    assert np.abs(p.deriv(3)(u)).max() == pytest.approx(COEFFICIENTS["jerk"]["P"], rel=1e-8)
    assert np.abs(p.deriv(1)(u) * p.deriv(2)(u)).max() == pytest.approx(COEFFICIENTS["torque"]["P"], rel=1e-7)
    cycloid = (1 - np.cos(2 * PI * u)) * 2 * PI * np.sin(2 * PI * u)
    assert cycloid.max() == pytest.approx(COEFFICIENTS["torque"]["C5"], rel=1e-7)


SOUGHT = [(*each, goal) for each in SEQUENCES if each[1] in ("none", "rise") for goal in GOALS]


@pytest.mark.parametrize(("kind", "constant", "goal"), spread(SOUGHT, 2))
def test_the_best_is_no_worse_than_any_drawn(goal: str, kind: str, constant: str) -> None:
    """With at least 60 deg of constant velocity where it is asked for."""
    wanted = {"length": 60.0} if constant != "none" else {}
    found = as_motion(best(request(kind, constant, wanted), goal))
    check_joins(found, harmonic=kind == "RRR")
    least, chance = cost(found, goal), random.Random(7)
    if wanted:
        assert found.settings()["length"] >= 60.0 * (1 - 1e-9)
    numbers = {"stroke": H, "back": H, "start": 30.0, "span": SPAN}
    for name in SEQUENCES[kind, constant]:
        for _ in range(1500):
            other = free_motion(name, chance, **numbers)
            if not wanted or other.settings().get("length", 0.0) >= 60.0:
                assert cost(other, goal) >= least * (1 - 1e-9), (name, other)


@pytest.mark.parametrize("goal", GOALS)
def test_the_best_stands_still(goal: str) -> None:
    """No motion of its sequence with a height moved by a hundred thousandth is better."""
    found = as_motion(best(request("DRRD", "none", {}, sequence="C1-H2-P2"), goal))
    least = cost(found, goal)
    for share in (1e-5, 1e-4, 1e-3, 1e-2):
        for sign in (1, -1):
            h1 = found.heights[0] * (1 + sign * share)
            other = blend(request("DRRD", "none", {"h1": h1}, sequence="C1-H2-P2"))
            assert cost(as_motion(other), goal) >= least * (1 - 1e-10)


def test_the_best_of_least_torque_has_a_constant_velocity_of_its_own() -> None:
    """DRD, y = h1 + h3 with h1 = h3: torque ~ (h + y)³/y is least at y = h/2, so β2 = (h/2) β/(3h/2) = 100 deg: a lesser
    length is no hindrance, a greater one is kept."""
    for least, length in ((20.0, 100.0), (100.0, 100.0), (150.0, 150.0)):
        got = best(request("DRD", "rise", {"length": least}), "torque").solution
        assert got.spans[1] == pytest.approx(length, rel=1e-6), least
    assert best(request("DRD", "rise", {}), "torque").solution.spans[1] == pytest.approx(100.0, rel=1e-6)


def test_the_best_keeps_what_is_set() -> None:
    got = best(request("DRRD", "rise", {"h1": 1.0, "length": 150.0}), "acceleration").solution
    assert got.heights[0] == 1.0
    assert got.spans[1] >= 150.0 * (1 - 1e-12)
    got = best(request("DRRD", "rise", {"acceleration": 0.02, "length": 100.0}), "jerk").solution
    assert got.peak_acceleration == pytest.approx(0.02, rel=1e-9)
    point = best(request("DRRD", "rise", {"length": 100.0}, points=((150.0, 9.0),)), "acceleration")
    assert as_motion(point).level(150.0) == pytest.approx(9.0, rel=1e-9)


def test_both_constant_velocities_last_as_long_as_given() -> None:
    with pytest.raises(BlendError, match="no constant velocity left on the return; give length2 or h5"):
        best(request("DRRD", "both", {"length": 40.0}), "acceleration")
    got = best(request("DRRD", "both", {"length": 40.0, "length2": 25.0}), "acceleration").solution
    assert (got.spans[1], got.spans[4]) == (pytest.approx(40.0, rel=1e-9), pytest.approx(25.0, rel=1e-9))
    exact = {"length": 40.0, "length2": 70.0, "h1": 4.0, "h6": 3.0}
    got = blend(request("DRRD", "both", exact)).solution
    assert (got.heights[0], got.heights[5], got.spans[1], got.spans[4]) == pytest.approx(
        (4.0, 3.0, 40.0, 70.0), rel=1e-12
    )


def test_of_equally_gentle_motions_one_keeps_its_constant_velocity() -> None:
    """The torque is that of the rise, whose speed and length are set: that of the return leaves room for its CV2."""
    given = {"vcv": 0.7758022957, "length": 6.9081050623}
    wish = Request("DRRD", 20.0, 149.70505, 220.53792, "both", given, return_stroke=12.0, mirrored=False)
    found = as_motion(best(wish, "torque"))
    check_joins(found, harmonic=False)
    assert found.settings()["h5"] > 0.0
    rise = Motion(found.curves[:3], found.heights[:3], found.spans[:3])
    assert cost(found, "torque") == pytest.approx(cost(rise, "torque"), rel=1e-12)


@pytest.mark.parametrize(
    ("wish", "phrase"),
    [
        (
            {"settings": {}},
            "best acceleration: the optimum has no constant velocity left on the rise; give length or h2",
        ),
        ({"settings": {"length": 320.0}}, "length = 320 deg is not feasible; feasible: "),
        ({"settings": {"h1": 30.0}}, "h1 = 30 mm is not feasible; feasible: 0 < h1 < 20 mm"),
        ({"settings": {"h5": 3.0}}, "no sequence of this motion accepts these settings: h5"),
    ],
)
def test_no_best(wish: dict[str, Any], phrase: str) -> None:
    with pytest.raises(BlendError) as caught:
        best(Request("DRD", 20.0, 30.0, 330.0, "rise", **wish), "acceleration")
    assert phrase in str(caught.value)


def test_an_unknown_goal() -> None:
    with pytest.raises(BlendError, match=r"best 'noise': unknown; allowed: acceleration \| jerk \| torque"):
        best(request("DRD", "none", {}), "noise")
