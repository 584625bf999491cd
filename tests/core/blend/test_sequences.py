"""core.blend against Yang's closed forms: sequences, spans and heights from the settings that determine them."""

import math
import random

import pytest
from blend_cases import ALL, SYMMETRIC, as_motion, request
from blends import FREEDOM, SEQUENCES, Motion, check_joins, free_motion
from sampled import spread

from core.blend import BlendError, blend, sequences

# -- sequences --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["DRD", "DRD-return", "DRRD", "RRR"])
@pytest.mark.parametrize("constant", ["none", "rise", "return", "both"])
def test_the_tables_admit_exactly_these_sequences(kind: str, constant: str) -> None:
    assert sorted(map(str, sequences(kind, constant))) == sorted(SEQUENCES.get((kind, constant), []))


@pytest.mark.parametrize(("kind", "constant", "name"), ALL)
def test_every_sequence_takes_its_number_of_settings(kind: str, constant: str, name: str) -> None:
    """Too few or too many: the error says how many."""
    count = FREEDOM[name] + 1 if name not in SYMMETRIC else 7
    wanted = dict.fromkeys(["h1", "h2", "h3", "h4", "h5", "h6", "vcv"][:count], 1.0)
    with pytest.raises(BlendError, match=f"{name} requires {FREEDOM[name]} setting") as caught:
        blend(request(kind, constant, wanted, sequence=name, mirrored=False))
    assert "\n" not in str(caught.value)


# -- closed forms -----------------------------------------------------------------------------------------

KAPPA, A, PI = math.sqrt(216 / 41), math.pi / 2 - 1, math.pi
H, SPAN = 20.0, 300.0


@pytest.mark.parametrize("v", [0.08, 0.1, 0.123, 2 * H / SPAN])
def test_drd_with_constant_velocity_and_its_speed_given(v: float) -> None:
    w = v * SPAN
    for wanted, h1 in ((0.5, 0.5), ((2 * (w - H)) / 3, 2 * (w - H) / 3)):
        got = blend(request("DRD", "rise", {"h1": wanted, "vcv": v})).solution
        assert got.heights[0] == pytest.approx(h1, rel=1e-12)
        assert (got.heights[1] if len(got.heights) == 3 else 0.0) == pytest.approx(2 * H - w, abs=1e-11)
        assert got.heights[-1] == pytest.approx(w - H - h1, rel=1e-12)


@pytest.mark.parametrize("rise", [0.3, 60.0, 150.0])
def test_drd_with_one_span_given(rise: float) -> None:
    """V = 2h/(β + β2)."""
    got = blend(request("DRD", "rise", {"length": rise, "h1": 1.0})).solution
    assert got.speed == pytest.approx(2 * H / (SPAN + rise), rel=1e-12)


@pytest.mark.parametrize("share", [0.02, 0.4, 0.9])
def test_card_picker_sequence_with_its_speed_given(share: float) -> None:
    h1 = 2.0
    q = share * (A * (H - h1) + KAPPA * math.sqrt(H * (H - h1)))
    w = q + H + h1
    root = 2 * q / (KAPPA * math.sqrt(H) + math.sqrt(KAPPA**2 * H + 4 * A * q))
    got = blend(request("DRRD", "rise", {"h1": h1, "vcv": w / SPAN}, sequence="C1-CV1-H2-P2")).solution
    assert got.heights[2] == pytest.approx(root**2, rel=1e-11)

    h2 = 7.0
    q = share * (KAPPA * math.sqrt(H * (H - h2)) - (1 - A) * (H - h2))
    w = q + 2 * H - h2
    root = 2 * q / (KAPPA * math.sqrt(H) + math.sqrt(KAPPA**2 * H - 4 * (1 - A) * q))
    got = blend(request("DRRD", "rise", {"h2": h2, "vcv": w / SPAN}, sequence="C1-CV1-H2-P2")).solution
    assert got.heights[2] == pytest.approx(root**2, rel=1e-11)

    h3 = 3.0
    h1 = share * (H - h3)
    w = H + h1 + A * h3 + KAPPA * math.sqrt(H * h3)
    got = blend(request("DRRD", "rise", {"h3": h3, "vcv": w / SPAN}, sequence="C1-CV1-H2-P2")).solution
    assert got.heights[0] == pytest.approx(h1, rel=1e-11)


@pytest.mark.parametrize(("given_name", "value"), [("h1", 1.5), ("h2", 12.0), ("h3", 4.0)])
def test_mirrored_six_curves_with_their_speed_given(given_name: str, value: float) -> None:
    w = {"h1": H + 1.5 + A * 6.0, "h2": 2 * H - 12.0 - (1 - A) * 5.0, "h3": H + 2.5 + A * 4.0}[given_name]
    other, height = {"h1": (2, (w - H - 1.5) / A), "h2": (2, (2 * H - 12.0 - w) / (1 - A)), "h3": (0, w - H - A * 4.0)}[
        given_name
    ]
    got = blend(request("DRRD", "both", {given_name: value, "vcv": 2 * w / SPAN})).solution
    assert str(got.sequence) == "C1-CV1-H2-H3-CV2-C4"
    assert got.heights[other] == pytest.approx(height, rel=1e-11)
    assert got.heights == pytest.approx(got.heights[::-1], rel=1e-14)
    assert got.spans == pytest.approx(got.spans[::-1], rel=1e-13)


def test_rise_return_rise_with_its_speed_given() -> None:
    w = 45.0
    root = 2 * (w - H) / (PI / 2 * math.sqrt(H) + math.sqrt(PI**2 / 4 * H + 4 * A * (w - H)))
    s = root**2
    got = blend(request("RRR", "rise", {"h1": 2.0, "vcv": w / SPAN}, sequence="H1-CV1-H2-H3-H4")).solution
    h1, h2, h3, h4, h5 = got.heights
    assert (h1 + h3, h2) == pytest.approx((s, H - s), rel=1e-11)
    assert (h4, h5) == pytest.approx((H * h3 / s, H * h1 / s), rel=1e-11)

    got = blend(request("RRR", "both", {"h1": 2.0, "vcv": w / SPAN})).solution
    assert got.heights[0] + got.heights[2] == pytest.approx((w / 2 - H) / A, rel=1e-11)


def test_rise_return_rise_with_one_return_curve() -> None:
    """W = h + (π-2) h1 + (π/2) √(2 h h1), h1 = h3."""
    h1 = 1.7
    w = H + (PI - 2) * h1 + PI / 2 * math.sqrt(2 * H * h1)
    got = blend(request("RRR", "rise", {"vcv": w / SPAN})).solution
    assert got.heights[:3] == pytest.approx((h1, H - 2 * h1, h1), rel=1e-11)


def test_six_curves_of_two_speeds() -> None:
    """a s r² + (h + a s - W) r + h = 0: two motions have the same h1, h2 and V; the gentler one is given."""
    h1, h2, r = 3.0, 10.0, 0.8
    s = H - h2
    w = H + A * s + (H + A * r * r * s) / r
    other = H / (A * s * r)  # the product of the roots is h/(a s)
    assert other**2 * s > H, "so only one of them is feasible here"
    wish = request("RRR", "both", {"h1": h1, "h2": h2, "vcv": w / SPAN}, mirrored=False)
    got = blend(wish).solution
    assert got.back_speed / got.speed == pytest.approx(r, rel=1e-11)


def test_what_leaves_no_freedom() -> None:
    assert blend(request("DRD", "none", {})).solution.spans == (300.0,)
    assert blend(request("DRRD", "none", {})).solution.spans == (150.0, 150.0)
    assert blend(request("RRR", "none", {})).curves == ("H5", "H6")
    one = blend(request("RRR", "none", {}, sequence="H1-H2-H6")).solution
    assert one.heights == pytest.approx((10.0, 10.0, 20.0), rel=1e-14), "collapses to H5-H6"
    assert one.spans == pytest.approx((75.0, 75.0, 150.0), rel=1e-13)
    parted = blend(request("DRRD", "none", {}, return_stroke=5.0)).solution
    assert parted.spans == pytest.approx((200.0, 100.0), rel=1e-14), "βs are as the roots of the strokes"


def test_a_return_alone_may_count_from_one() -> None:
    a = blend(request("DRD-return", "return", {"h1": 2.0, "vcv": 0.1}))
    b = blend(request("DRD-return", "return", {"h4": 2.0, "vcv2": 0.1}))
    assert a.solution == b.solution
    assert a.solution.heights[0] == 2.0
    assert all(s.rise < 0.0 for s in a.segments)


@pytest.mark.parametrize(
    ("first", "second", "value"), [("h1", "h6", 0.1), ("h2", "h5", 17.0), ("h3", "h4", 0.1), ("vcv", "vcv2", 0.1)]
)
def test_time_run_backwards(first: str, second: str, value: float) -> None:
    forth = blend(request("DRRD", "rise", {first: value, "peak": 290.0}, sequence="C1-CV1-H2-P2"))
    back = blend(request("DRRD", "return", {second: value, "peak": 70.0}, sequence="P1-H3-CV2-C4"))
    assert back.solution.heights == forth.solution.heights[::-1]
    assert back.solution.spans == forth.solution.spans[::-1]
    assert [s.rise for s in back.segments] == [-s.rise for s in reversed(forth.segments)]


def test_a_prescribed_peak_beside_unequal_strokes() -> None:
    got = as_motion(blend(request("DRRD", "rise", {"h1": 1.0, "peak": 250.0}, return_stroke=12.0)))
    assert sum(got.spans[:3]) == pytest.approx(220.0, rel=1e-12)
    check_joins(got, harmonic=False)


def test_pinned_ratio_of_the_speeds() -> None:
    """Two settings may fix the ratio of the speeds and leave the rest to the third: h4 = r² h3."""
    for pair in ({"h3": 4.0, "h4": 2.56}, {"vcv": 0.2, "vcv2": 0.16}):
        got = blend(request("RRR", "both", {**pair, "h1": 3.0}, mirrored=False)).solution
        assert got.back_speed / got.speed == pytest.approx(0.8, rel=1e-9)
        check_joins(Motion(got.sequence.curves, got.heights, got.spans), harmonic=True)


@pytest.mark.parametrize("seed", spread(range(6), 2))
def test_two_precision_points_are_passed(seed: int) -> None:
    numbers = {"stroke": 20.0, "back": 20.0, "start": 30.0, "span": 300.0}
    made = free_motion("C1-CV1-H2-P2", random.Random(seed), **numbers)
    points = tuple((at, made.level(at)) for at in (80.0, 270.0))
    got = as_motion(blend(request("DRRD", "rise", {}, points=points, sequence="C1-CV1-H2-P2")))
    assert [got.level(at) for at, _ in points] == pytest.approx([v for _, v in points], rel=1e-10)


def test_a_line_through_two_points() -> None:
    """Both on the constant velocity: its speed and place follow without any curve: 0.1 mm/deg through 8 mm at 120 deg."""
    got = blend(request("DRRD", "rise", {}, points=((120.0, 8.0), (180.0, 14.0)), sequence="C1-CV1-H2-P2"))
    assert got.solution.speed == pytest.approx(0.1, rel=1e-12)
    # C1 ends at (30 + 2 h1/V, h1): on the line 8 + (angle - 120)/10
    assert got.solution.heights[0] == pytest.approx(1.0, rel=1e-11)
