"""Linkages for pairs of angles, and crank-rockers of a swing: exact values, least squares, refusals."""

from math import acos, cos, degrees, log10, pi, radians, sin

import numpy as np
import pytest

from core.errors import DesignError
from core.mechanism.driver_ranges import driver_ranges_of
from core.mechanism.solving import unit_speed_kinematics
from core.synthesis import Answer, synthesise, task_of

# Freudenstein's example: y = log10 x for 1 <= x <= 2, 60 deg of both links, three pairs at Chebyshev's spacing
X = [1.5 - 0.5 * cos(pi * (2 * k - 1) / 6) for k in (1, 2, 3)]
LOG_PAIRS = [[45.0 + 60.0 * (x - 1.0), 0.0 + 60.0 * log10(x) / log10(2.0)] for x in X]


def output_angles(answer: Answer, driver: list[float]) -> np.ndarray:
    """Angles of link 4 [deg] by the solved kinematics with link 2 at these angles."""
    linkage = answer.candidate.linkage
    body = unit_speed_kinematics(linkage, np.radians(driver), driver_ranges_of(linkage)).bodies["link4"]
    return np.degrees(body.angle[0])


def test_three_pairs_are_met_exactly() -> None:
    synthesis = synthesise(task_of({"kind": "angles", "angles": {"pairs": LOG_PAIRS, "frame_mm": 100.0}}))
    (answer,) = synthesis.answers
    assert synthesis.complete
    assert answer.error_deg < 1e-9
    assert not answer.defects
    turn = output_angles(answer, [pair[0] for pair in LOG_PAIRS]) - [pair[1] for pair in LOG_PAIRS]
    assert np.abs((turn + 180.0) % 360.0 - 180.0).max() < 1e-9


def test_the_links_of_three_pairs_are_those_of_a_hand_solution() -> None:
    (answer,) = synthesise(task_of({"kind": "angles", "angles": {"pairs": LOG_PAIRS, "frame_mm": 100.0}})).answers
    linkage = answer.candidate.linkage
    a = linkage.by_number[2].places["A"].real
    c = linkage.by_number[4].places["B"].real
    b = abs(linkage.by_number[3].places["B"])
    for phi, psi in np.radians(LOG_PAIRS):  # the coupler's length by coordinates
        x, y = 100.0 + c * cos(psi) - a * cos(phi), c * sin(psi) - a * sin(phi)
        assert x * x + y * y == pytest.approx(b * b, rel=1e-12)


@pytest.mark.stress
def test_more_pairs_are_met_in_the_least_squares_of_the_output() -> None:
    x = np.linspace(1.0, 2.0, 9)
    pairs = np.column_stack((60.0 * (x - 1.0), 60.0 * np.log10(x) / log10(2.0))).tolist()
    free = synthesise(task_of({"kind": "angles", "angles": {"pairs": pairs, "frame_mm": 100.0, "free": True}})).answers[
        0
    ]
    shifted = [[a + 45.0, b] for a, b in pairs]
    fixed = synthesise(task_of({"kind": "angles", "angles": {"pairs": shifted, "frame_mm": 100.0}})).answers[0]
    assert free.error_deg < 0.01 < fixed.error_deg
    turn = output_angles(free, [pair[0] for pair in pairs]) - [pair[1] for pair in pairs]
    turn = (turn + 180.0) % 360.0 - 180.0
    assert np.abs(turn).max() == pytest.approx(free.error_deg, rel=1e-6)


def test_pairs_over_a_full_turn_have_a_linkage_of_links_that_can_be_built() -> None:
    pairs = [[float(t), 90.0 - 25.0 * cos(radians(t))] for t in range(0, 360, 45)]
    best = synthesise(task_of({"kind": "angles", "angles": {"pairs": pairs, "frame_mm": 100.0}})).answers[0]
    assert not best.defects
    assert best.length_ratio <= 10.0
    turn = output_angles(best, [pair[0] for pair in pairs]) - [pair[1] for pair in pairs]
    assert np.abs((turn + 180.0) % 360.0 - 180.0).max() == pytest.approx(best.error_deg, rel=1e-6)
    assert best.error_deg < 8.0


@pytest.mark.parametrize("free", [True, False])
@pytest.mark.parametrize("count", [3, 4])
def test_an_output_that_turns_as_the_driver_is_that_of_a_parallelogram(free: bool, count: int) -> None:
    pairs = [[30.0 * k, 30.0 * k] for k in range(1, count + 1)]
    angles = {"pairs": pairs, "frame_mm": 100.0, "free": free}
    best = synthesise(task_of({"kind": "angles", "angles": angles, "limits": {"transmission_deg_min": 25.0}})).answers[
        0
    ]
    assert best.is_good
    assert best.error_deg < 1e-9
    lengths = [abs(best.candidate.linkage.by_number[number].places[name]) for number, name in ((2, "A"), (4, "B"))]
    assert lengths[0] == pytest.approx(lengths[1], rel=1e-9)


@pytest.mark.stress
def test_no_free_pairs_are_met_by_links_without_end() -> None:
    straight = [[5.0 * k, 1.5 * k] for k in range(12)]
    swung = [[float(t), 90.0 + 30.0 * sin(radians(t))] for t in range(0, 360, 30)]
    for pairs, error in ((straight, 0.002), (swung, 0.7)):
        angles = {"pairs": pairs, "frame_mm": 100.0, "free": True}
        answers = synthesise(task_of({"kind": "angles", "angles": angles})).answers
        assert answers[0].error_deg < error
        assert max(answer.length_ratio for answer in answers) <= 10.0


def test_a_slider_follows_three_angles() -> None:
    pairs = [[10.0, 140.0], [60.0, 120.0], [120.0, 80.0]]
    (answer,) = synthesise(task_of({"kind": "angles", "angles": {"pairs": pairs, "output": "slider"}})).answers
    assert answer.candidate.kind == "slider-crank"
    assert answer.error_mm < 1e-9
    linkage = answer.candidate.linkage
    a, b = linkage.by_number[2].places["A"].real, linkage.by_number[3].places["B"].real
    offset = linkage.sliders[0].through_y_mm
    for angle, s in pairs:
        phi = radians(angle)
        assert (s - a * cos(phi)) ** 2 + (offset - a * sin(phi)) ** 2 == pytest.approx(b * b, rel=1e-12)


def swing_and_ratio(answer: Answer) -> tuple[float, float]:
    """Swing [deg] and time ratio of a crank-rocker by the law of cosines at its dead centres."""
    linkage = answer.candidate.linkage
    a, c = abs(linkage.by_number[2].places["A"]), abs(linkage.by_number[4].places["B"])
    coupler = linkage.by_number[3].places
    b = abs(coupler["B"] - coupler["A"])
    frame = linkage.by_number[1].places
    d = abs(frame["O4"] - frame["O2"])
    rocker = [acos((c * c + d * d - r * r) / (2.0 * c * d)) for r in (b + a, b - a)]
    crank = [acos((r * r + d * d - c * c) / (2.0 * r * d)) for r in (b + a, b - a)]
    forward = pi + (crank[1] - crank[0])
    ratio = forward / (2.0 * pi - forward)
    return degrees(abs(rocker[0] - rocker[1])), max(ratio, 1.0 / ratio)


def least_transmission(answer: Answer) -> float:
    linkage = answer.candidate.linkage
    a, c = abs(linkage.by_number[2].places["A"]), abs(linkage.by_number[4].places["B"])
    coupler, frame = linkage.by_number[3].places, linkage.by_number[1].places
    b, d = abs(coupler["B"] - coupler["A"]), abs(frame["O4"] - frame["O2"])
    return min(degrees(acos(abs(b * b + c * c - (d + s * a) ** 2) / (2.0 * b * c))) for s in (1, -1))


@pytest.mark.parametrize(("swing", "ratio"), [(60.0, 1.0), (50.0, 1.25), (30.0, 1.5), (80.0, 1.1)])
def test_a_crank_rocker_has_its_swing_and_time_ratio(swing: float, ratio: float) -> None:
    table = {"kind": "rocker", "rocker": {"swing_deg": swing, "time_ratio": ratio, "frame_mm": 120.0}}
    synthesis = synthesise(task_of(table))
    best = synthesis.answers[0]
    assert synthesis.complete
    assert not best.defects
    assert best.turns_fully
    assert swing_and_ratio(best) == (pytest.approx(swing, abs=1e-9), pytest.approx(ratio, abs=1e-9))
    frame = best.candidate.linkage.by_number[1].places
    assert (frame["O2"], frame["O4"]) == (0j, 120.0 + 0j)
    assert best.transmission_deg == pytest.approx(least_transmission(best), abs=1e-9)
    assert best.length_ratio <= 6.0 * (1.0 + 1e-9)


def test_no_other_crank_rocker_of_the_swing_transmits_better() -> None:
    """A crank-rocker of equal times has a² + d² = b² + c² and a = c sin(Ψ/2): one ratio is left to scan."""
    best = synthesise(task_of({"kind": "rocker", "rocker": {"swing_deg": 60.0, "frame_mm": 100.0}})).answers[0]
    values = []
    for c in np.linspace(0.02, 0.999, 4000):
        a = c * sin(radians(30.0))
        b = (a * a + 1.0 - c * c) ** 0.5
        if max(a, b, c, 1.0) <= 6.0 * min(a, b, c, 1.0) and a == min(a, b, c, 1.0):
            values.append(
                min(degrees(acos(min(1.0, abs(b * b + c * c - (1.0 + s * a) ** 2) / (2.0 * b * c)))) for s in (1, -1))
            )
    assert best.transmission_deg == pytest.approx(max(values), abs=0.05)
    assert best.transmission_deg > max(values) - 1e-9


@pytest.mark.parametrize("count", [5, pytest.param(150, marks=pytest.mark.stress)])
def test_no_random_crank_rocker_transmits_better_at_its_swing_and_time_ratio(count: int) -> None:
    """Swing, time ratio and transmission angle by the law of cosines, with frame 1; each answer has no defect."""
    rng = np.random.default_rng(5)
    while count:
        a, b, c = rng.uniform(0.17, 2.5, 3).tolist()
        shortest, *middle, longest = sorted((a, b, c, 1.0))
        if shortest != a or longest > 6.0 * a or shortest + longest > sum(middle) - 0.02:
            continue
        rocker, crank = (
            [acos((side**2 + 1.0 - far**2) / (2.0 * side)) for side, far in rows]
            for rows in (((c, b + a), (c, b - a)), ((b + a, c), (b - a, c)))
        )
        swing, turn = abs(rocker[0] - rocker[1]), abs(crank[0] - crank[1])
        ratio = (pi + turn) / (pi - turn)
        if ratio >= 2.99:
            continue
        least = min(degrees(acos(abs(b * b + c * c - (1.0 + s * a) ** 2) / (2.0 * b * c))) for s in (1, -1))
        table = {"swing_deg": degrees(swing), "time_ratio": ratio, "frame_mm": 1.0}
        answers = synthesise(task_of({"kind": "rocker", "rocker": table})).answers
        assert [answer.defects for answer in answers] == [()] * len(answers)
        assert answers[0].transmission_deg > least - 1e-7
        count -= 1


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"kind": "angles", "angles": {"pairs": LOG_PAIRS[:2], "frame_mm": 9.0}}, "angles.pairs: 2 pairs"),
        ({"kind": "angles", "angles": {"pairs": LOG_PAIRS}}, "angles.frame_mm: missing"),
        (
            {"kind": "angles", "angles": {"pairs": [LOG_PAIRS[0]] * 3, "frame_mm": 9.0}},
            r"angles.pairs\[1\] = .*given twice",
        ),
        (
            {"kind": "angles", "angles": {"pairs": LOG_PAIRS, "frame_mm": 9.0, "output": "slider"}},
            "angles.frame_mm = 9.0",
        ),
        (
            {"kind": "rocker", "rocker": {"swing_deg": 180.0, "frame_mm": 9.0}},
            r"rocker.swing_deg = 180.0: outside its range; allowed: above 0 \.\.\. below 180 °",
        ),
        ({"kind": "rocker", "rocker": {"swing_deg": 0.0, "frame_mm": 9.0}}, "rocker.swing_deg = 0.0"),
        (
            {"kind": "rocker", "rocker": {"swing_deg": 40.0, "frame_mm": 9.0, "time_ratio": 3.0}},
            r"rocker.time_ratio = 3.0: outside its range; allowed: 1 \.\.\. below 3$",
        ),
        (
            {"kind": "rocker", "rocker": {"swing_deg": 40.0, "frame_mm": 9.0, "time_ratio": 0.9}},
            r"rocker.time_ratio = 0.9: outside its range; allowed: 1 \.\.\. below 3$",
        ),
        ({"kind": "rocker"}, "rocker: missing"),
        ({"kind": "spiral"}, "kind = 'spiral': unknown word; allowed: poses | path | angles | rocker"),
    ],
)
def test_bad_tasks_are_refused_with_their_field(table: dict[str, object], message: str) -> None:
    with pytest.raises(DesignError, match=message):
        synthesise(task_of(table))


def test_a_small_swing_names_the_ratio_of_lengths_that_it_needs() -> None:
    rocker = {"swing_deg": 1.0, "frame_mm": 100.0}
    with pytest.raises(
        DesignError, match=r"limits.length_ratio_max = 6.0: no crank-rocker .*; allowed: >= 114.6"
    ) as refused:
        synthesise(task_of({"kind": "rocker", "rocker": rocker}))
    ratio = float(str(refused.value).split(">=")[1])
    answer = synthesise(task_of({"kind": "rocker", "rocker": rocker, "limits": {"length_ratio_max": ratio}})).answers[0]
    assert answer.is_good
    assert swing_and_ratio(answer) == pytest.approx((1.0, 1.0), abs=1e-9)


def test_every_value_outside_its_range_is_named_once() -> None:
    table = {"kind": "rocker", "rocker": {"swing_deg": -5.0, "frame_mm": 0.0}, "limits": {"length_ratio_max": 0.5}}
    with pytest.raises(DesignError) as error:
        task_of(table)
    paths = [fault.path for fault in error.value.faults]
    assert paths == ["rocker.swing_deg", "rocker.frame_mm", "limits.length_ratio_max"]
