"""What core.blend refuses: every error names the setting, what it may be and what to do."""

import math
from typing import Any

import pytest
from blend_cases import request, solves
from sampled import spread

from core.blend import BlendError, Request, blend, feasible_ranges

KAPPA, A, PI = math.sqrt(216 / 41), math.pi / 2 - 1, math.pi
H, SPAN = 20.0, 300.0


def hull(wish: Request, name: str) -> tuple[float, float]:
    """The ends of all that a setting may be."""
    ranges = feasible_ranges(wish, name)
    return ranges[0].low, ranges[-1].high


# -- one setting that says nothing new --------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "constant", "kept", "name", "value", "name_of_sequence"),
    [
        ("DRD", "rise", ("h2", 5.0), "vcv", (2 * H - 5.0) / SPAN, ""),
        ("DRD", "rise", ("vcv", 0.1), "h2", 2 * H - 30.0, ""),
        ("DRD", "rise", ("length", 100.0), "vcv", 0.1, ""),
        ("DRRD", "both", ("h1", 1.0), "h6", 1.0, ""),
        ("DRRD", "both", ("h1", 1.0), "peak", 180.0, ""),
        ("RRR", "rise", ("h2", 8.0), "vcv", (H + A * 12.0 + PI / 2 * math.sqrt(H * 12.0)) / SPAN, "H1-CV1-H2-H3-H4"),
        ("RRR", "both", ("h2", 8.0), "vcv", 2 * (H + A * 12.0) / SPAN, ""),
    ],
)
@pytest.mark.parametrize("factor", [1.0, 1.05])
def test_a_setting_that_the_others_determine_is_refused_with_its_value(
    kind: str, constant: str, kept: tuple[str, float], name: str, value: float, name_of_sequence: str, factor: float
) -> None:
    """Whether or not it agrees: taken silently it would leave the motion undetermined."""
    wish = request(kind, constant, {kept[0]: kept[1], name: factor * value}, sequence=name_of_sequence)
    with pytest.raises(BlendError) as caught:
        blend(wish)
    assert caught.value.setting == name
    assert caught.value.allowed == pytest.approx((value, value), rel=1e-9)
    assert "already determined" in str(caught.value)
    assert f"{value:.6g}"[:6] in str(caught.value)


# -- what is not feasible ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("settings_", "name", "low", "high"),
    [
        ({"h1": 2.0, "vcv": 0.5}, "vcv", (H + 2) / SPAN, 2 * H / SPAN),
        ({"h1": 25.0, "vcv": 0.1}, "h1", 0.0, 10.0),
        ({"h1": 25.0, "h3": 40.0}, "h1", 0.0, 20.0),
        ({"vcv": 5.0, "h1": 40.0}, "vcv", H / SPAN, 2 * H / SPAN),
        ({"length": 299.0, "h1": 19.0}, "h1", 0.0, 20 * 1 / 299.5 / 2 * 1.0 + 0.0),
    ],
)
def test_ranges_of_drd(settings_: dict[str, float], name: str, low: float, high: float) -> None:
    """h/β < V ≤ 2h/β, h + h1 < W; where both are impossible the first is told."""
    if name == "h1" and "length" in settings_:
        v = 2 * H / (SPAN + settings_["length"])
        high = v * SPAN - H
    with pytest.raises(BlendError) as caught:
        blend(request("DRD", "rise", settings_))
    assert caught.value.setting == name
    assert caught.value.allowed == pytest.approx((low, high), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("h1", [0.5, 5.0, 15.0])
def test_ranges_of_the_card_picker_sequence(h1: float) -> None:
    wish = request("DRRD", "rise", {"h1": h1, "vcv": 9.9}, sequence="C1-CV1-H2-P2")
    top = (H + h1 + A * (H - h1) + KAPPA * math.sqrt(H * (H - h1))) / SPAN
    assert hull(wish, "vcv") == pytest.approx(((H + h1) / SPAN, top), rel=1e-9)
    with pytest.raises(BlendError, match=r"^vcv = 9\.9 mm/deg is not feasible with h1 = .*; feasible: ") as caught:
        blend(wish)
    assert caught.value.allowed == hull(wish, "vcv")


def test_ranges_where_the_settings_are_still_to_come() -> None:
    """With more freedom than settings a range is what anything leaves."""
    assert hull(request("DRD", "rise", {}), "vcv") == pytest.approx((H / SPAN, 2 * H / SPAN), rel=1e-12)
    assert hull(request("DRD", "rise", {}), "h1") == pytest.approx((0.0, H), abs=1e-9)
    assert hull(request("DRRD", "rise", {}), "peak") == pytest.approx((30.0, 330.0), rel=1e-2)


def test_the_end_of_a_range_that_is_told_can_be_typed() -> None:
    """Closed ends are rounded inwards; open ones say <."""
    with pytest.raises(BlendError) as caught:
        blend(request("DRD", "rise", {"h1": 2.0, "vcv": 0.5}))
    assert "feasible: 0.0733333333 < vcv <= 0.133333333 mm/deg" in str(caught.value)
    assert solves(request("DRD", "rise", {"h1": 2.0}), "vcv", 0.133333333)


def test_the_least_acceleration_is_an_end() -> None:
    """It may be reached from either side of the gentlest motion; below it there is none."""
    wish = request("DRD", "rise", {"h1": 2.0, "acceleration": 1e-9})
    with pytest.raises(BlendError) as caught:
        blend(wish)
    assert caught.value.setting == "acceleration"
    low, high = caught.value.allowed
    assert high == math.inf
    # π V²/(4 h_i) of the lesser height, W = h + 2 + h3: least where h3 = h1, for (h + 2 + h3)²/h3 falls until then
    assert low == pytest.approx(math.pi / 4 * ((H + 4.0) / SPAN) ** 2 / 2.0, rel=1e-9)
    assert solves(wish, "acceleration", low * (1 + 1e-6))
    assert not solves(wish, "acceleration", low * (1 - 1e-6))
    assert "acceleration >= " in str(caught.value)


@pytest.mark.parametrize(
    ("change", "phrase"),
    [
        ({"type": "XYZ"}, "type 'XYZ': unknown; allowed: DRD | DRD-return | DRRD | RRR"),
        ({"stroke": -1.0}, "stroke = -1: outside its range; allowed: 1e-09 ... 1e+09 mm"),
        ({"stroke": math.nan}, "stroke = nan"),
        ({"return_stroke": -2.0}, "return stroke = -2"),
        ({"start": 300.0, "end": 100.0}, "start 300 deg, end 100 deg: outside their range"),
        ({"end": 400.0}, "allowed: 0 <= start < end <= 360 deg"),
        ({"constant": "sometimes"}, "constant velocity 'sometimes': unknown; allowed: none | rise | return | both"),
        ({"type": "DRD", "constant": "return"}, "constant velocity return: DRD has no return"),
        ({"type": "DRD-return", "constant": "both"}, "constant velocity both: DRD-return has no rise"),
        ({"settings": {"h9": 1.0}}, "h9: unknown setting; allowed: h1 | "),
        ({"settings": {"h1": 0.0}}, "h1 = 0: outside its range; allowed: > 0 mm"),
        ({"settings": {"vcv": math.inf}}, "vcv = inf: outside its range; allowed: > 0 mm/deg"),
        (
            {"sequence": "C1-C1"},
            "sequence 'C1-C1': no sequence of this motion; allowed: C1-CV1-H2-P2 | C1-CV1-H2-H3-C4",
        ),
        (
            {"type": "DRD-return", "constant": "return", "settings": {"vcv": 0.1, "vcv2": 0.2}},
            "vcv, vcv2: two names of the same setting of a return; give one",
        ),
        (
            {"constant": "both", "settings": {"h1": 1.0, "h3": 1.0, "peak": 200.0}},
            "C1-CV1-H2-H3-CV2-C4 (mirrored) requires 2 settings; C1-CV1-H2-H3-CV2-C4 requires 4 settings",
        ),
        (
            {"settings": {"h1": 1.0, "h5": 2.0}},
            "C1-CV1-H2-H3-C4 requires 3 settings; h5: not a setting of these curves; allowed: h1 | h2 | h3 | h4 | h6 | vcv | vcv2 | ",
        ),
        (
            {"type": "DRD", "settings": {"h1": 1.0, "peak": 200.0}},
            "h1, peak; C1-CV1-C2 requires 2 settings; peak: not a setting of these curves;"
            " allowed: h1 | h2 | h3 | vcv | length | acceleration",
        ),
        ({"settings": {"h2": -1.0}}, "h2 = -1: outside its range; allowed: >= 0 mm"),
        ({"points": ((10.0, 5.0),)}, "point at 10 deg = 5: outside its range; allowed: 30 < angle < 330 deg"),
        ({"settings": {"h1": 1.0, "h2": 1.0, "h3": 1.0, "h4": 1.0}}, "settings given: h1, h2, h3, h4; "),
    ],
)
def test_a_wish_without_sense(change: dict[str, Any], phrase: str) -> None:
    fields = {"type": "DRRD", "stroke": 20.0, "start": 30.0, "end": 330.0, "constant": "rise", **change}
    with pytest.raises(BlendError) as caught:
        blend(Request(**fields))
    assert phrase in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("kind", "constant", "given", "curves"),
    [
        ("DRD", "rise", {"h2": 0.0, "h1": 5.0}, "c1 c2"),
        ("DRD-return", "return", {"length": 0.0, "h1": 3.0}, "c3 c4"),
        ("DRRD", "rise", {"h2": 0.0, "h1": 5.0}, "c1 h2 p2"),
        ("RRR", "both", {"h2": 0.0, "h1": 3.0}, "h1 h2 h3 h4"),
    ],
)
def test_no_length_of_constant_velocity_is_the_end_of_the_range(
    kind: str, constant: str, given: dict[str, float], curves: str
) -> None:
    wish = request(kind, constant, given)
    name = next(iter(given))
    found = feasible_ranges(wish, name)[0]
    assert (found.low, found.low_open) == (0.0, False)
    made = blend(wish).segments
    assert " ".join(s.curve.law for s in made) == curves
    near = blend(request(kind, constant, {**given, name: 1e-9})).segments
    spans = [s.span_deg for s in near if s.curve.law not in ("cv1", "cv2")]
    assert [s.span_deg for s in made] == pytest.approx(spans, abs=1e-6)


def test_an_end_that_is_nothing_but_rounding_is_none() -> None:
    given = {"length": 1.8921432953866058, "h2": 0.06133885217638034}
    found = feasible_ranges(Request("DRRD", 0.09095859025469943, 0.0, 158.90470856369362, "rise", given), "h1")
    assert [r.low for r in found] == [0.0]


def test_the_greater_of_two_accelerations_is_not_determined_by_the_less() -> None:
    """Height and span of the rise say what its acceleration is; that of the return may still be greater."""
    given = {"h1": 15.4886802, "peak": 6.4848472}
    wish = Request("DRRD", 20.0, 0.0, 20.0, "return", {**given, "acceleration": 4.0})
    with pytest.raises(BlendError, match=r"not feasible with .*; feasible: acceleration >= 7\.63694") as caught:
        blend(wish)
    assert caught.value.allowed is not None
    least, most = caught.value.allowed
    assert most == math.inf
    assert solves(wish, "acceleration", least * (1 + 1e-6))
    assert not solves(wish, "acceleration", least * (1 - 1e-6))


@pytest.mark.parametrize(
    ("kind", "constant", "name", "setting"),
    [
        ("DRRD", "rise", "C1-CV1-H2-H3-C4", "length"),
        ("DRRD", "return", "C1-H2-H3-CV2-C4", "h5"),
        ("RRR", "rise", "H1-CV1-H2-H3-H4", "h2"),
    ],
)
def test_a_constant_velocity_may_vanish_whatever_is_still_to_come(
    kind: str, constant: str, name: str, setting: str
) -> None:
    """Some motion of the sequence has none: the range starts at 0, which is reached, and nowhere else."""
    (found,) = feasible_ranges(request(kind, constant, {}, sequence=name, return_stroke=12.0), setting)
    assert (found.low, found.low_open) == (0.0, False)


@pytest.mark.parametrize("level", spread([7.0, 12.6], 1))
def test_an_acceleration_beside_a_point_has_a_least_value(level: float) -> None:
    wish = request("DRD-return", "return", {}, points=((165.0, level),))
    (found,) = feasible_ranges(wish, "acceleration")
    assert (found.low_open, found.high) == (False, math.inf)
    assert solves(wish, "acceleration", found.low * (1 + 1e-6))
    assert not solves(wish, "acceleration", found.low * (1 - 1e-6))
