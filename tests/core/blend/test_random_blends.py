"""core.blend against motions drawn at random from Yang's equations: what is feasible is solved, what is not names its
range, and a scan from outside finds the same range."""

import math
import random
import re
from dataclasses import replace

import pytest
from blend_cases import (
    Case,
    as_motion,
    asked_for,
    attempted,
    cases,
    freedom,
    independent,
    measurable,
    measured_near,
    solves,
)
from blend_scan import Kind, extent, lies_on_a_line
from blends import Motion, check_joins, free_motion, same
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from core.blend import SETTINGS, Request, SettingRange, blend, feasible_ranges, open_settings


def check_motion(got: Motion, case: Case) -> None:
    """Yang's sequence, joins continuous to 1e-12, totals exact, every height above 0."""
    kind, _, name, numbers, _ = case
    assert "-".join(got.curves) == name
    check_joins(got, harmonic=kind == "RRR")
    assert math.isclose(math.fsum(got.spans), numbers["span"], rel_tol=1e-12)
    for total, stroke in ((got.stroke, numbers["stroke"]), (got.return_stroke, numbers["back"])):
        assert total == 0.0 or math.isclose(total, stroke, rel_tol=1e-12)
    assert all(h > 0.0 for h in got.heights)


def drawn(case: Case) -> Motion:
    *_, name, numbers, seed = case
    return free_motion(name, random.Random(seed), **numbers)


@settings(max_examples=60)
@given(cases(), st.randoms(use_true_random=False))
def test_what_is_feasible_is_solved(case: Case, pick: random.Random) -> None:
    """Of a motion made from free heights, as many settings as it takes give it back, or a gentler one that has them too:
    no root is missed."""
    kind, constant, name, numbers, seed = case
    made = drawn(case)
    told, count = measurable(made, kind), freedom(name, numbers)
    assume(count <= len(told))
    asked = tuple(pick.sample(sorted(told), k=count))
    assume(independent(name, asked, numbers, seed))
    got = as_motion(blend(asked_for(kind, constant, name, numbers, {n: told[n] for n in asked})))
    check_motion(got, case)
    back = got.settings()
    assert all(same(back[n], told[n], 1e-9) for n in asked), (asked, back, told)
    assert got.acceleration <= made.acceleration * (1.0 + 1e-9)


@settings(max_examples=25)
@given(cases(), st.randoms(use_true_random=False), st.lists(st.floats(0.05, 0.95), min_size=1, max_size=2))
def test_points_are_passed(case: Case, pick: random.Random, shares: list[float]) -> None:
    """One or two beside other settings, an acceleration among them at times; refused only where many motions pass, or two
    nearly meet."""
    kind, constant, name, numbers, _ = case
    made = drawn(case)
    told, count = measurable(made, kind), freedom(name, numbers)
    angles = [numbers["start"] + numbers["span"] * share for share in shares]
    assume(count >= len(angles) and len({round(a, 3) for a in angles}) == len(angles))
    able = sorted(set(told) - ({"acceleration"} if len(angles) > 1 else set()))
    asked = pick.sample(able, k=count - len(angles))
    points = tuple((a, made.level(a)) for a in angles)
    wish = asked_for(kind, constant, name, numbers, {n: told[n] for n in asked})
    answer, refusal = attempted(replace(wish, points=points))
    shape = Kind(name, numbers["stroke"], numbers["back"], numbers["start"], numbers["span"], numbers["mirrored"])
    kept = [lambda m, n=n: m.settings()[n] for n in asked]
    kept += [lambda m, a=a: m.level(a) + numbers["stroke"] for a in angles]
    if answer is None:
        assert lies_on_a_line(shape, kept, made), str(refusal)
        return
    got = as_motion(answer)
    check_motion(got, case)
    for at, level in points:
        assert abs(got.level(at) - level) <= 1e-9 * numbers["stroke"]
    if got.acceleration > made.acceleration * (1.0 + 1e-9):  # rounding alone, where two motions nearly meet
        assert lies_on_a_line(shape, kept, made)
        assert got.acceleration <= made.acceleration * (1.0 + 1e-7)


# -- ranges -----------------------------------------------------------------------------------------------


def check_ends(wish: Request, name: str, ranges: list[SettingRange]) -> None:
    """A millionth of its width inside both ends of a range it solves, a millionth outside it fails. Inside an open end a
    ten-thousandth: there a curve vanishes, at times with the square of the distance, of which rounding leaves nothing."""
    for i, found in enumerate(ranges):
        high = min(found.high, 10.0 * abs(found.low) + 10.0)
        step = 1e-6 * (high - found.low)
        if step <= 1e-11 * abs(high):
            continue
        assert solves(wish, name, found.low + (1e2 if found.low_open else 1.0) * step), (name, found)
        assert solves(wish, name, high - (1e2 if found.high_open else 1.0) * step), (name, found)
        if i == 0 and found.low > step:
            assert not solves(wish, name, found.low - step), (name, found)
        if i == len(ranges) - 1 and found.high < math.inf:
            assert not solves(wish, name, found.high + step), (name, found)


@pytest.mark.stress
@settings(max_examples=20)
@given(cases(), st.randoms(use_true_random=False), st.floats(0.02, 50.0))
def test_ranges_are_those_of_a_scan_from_outside(case: Case, pick: random.Random, factor: float) -> None:
    """All settings but one from a feasible motion. The motions that have them are followed by Newton's method from there
    to both ends: the range that is told is as wide; blending solves inside and fails outside."""
    kind, constant, name, numbers, seed = case
    count = freedom(name, numbers)
    assume(count >= 1)
    made = drawn(case)
    told = measurable(made, kind)
    kept = pick.sample(sorted(set(told) - {"acceleration"}), k=count - 1)
    last = pick.choice(sorted(set(told) - set(kept)))
    assume(independent(name, (*kept, last), numbers, seed))
    wish = asked_for(kind, constant, name, numbers, {n: told[n] for n in (*kept, last)})
    ranges = feasible_ranges(wish, last)
    width = 1e-9 * abs(told[last])
    here = [r for r in ranges if r.low - width <= told[last] <= r.high + width]
    assert len(here) == 1
    check_ends(wish, last, ranges)

    shape = Kind(name, numbers["stroke"], numbers["back"], numbers["start"], numbers["span"], numbers["mirrored"])
    low, high = extent(shape, [lambda m, n=n: m.settings()[n] for n in kept], lambda m: m.settings()[last], made)
    if here[0].high < math.inf:
        assert abs(low - here[0].low) <= 1e-6 * (here[0].high - here[0].low)
        assert abs(high - here[0].high) <= 1e-6 * (here[0].high - here[0].low)
    else:
        assert abs(low - here[0].low) <= 1e-6 * told[last]
        assert high > 1e3 * told[last]

    value = told[last] * factor
    if not any(r.low - width <= value <= r.high + width for r in ranges):
        answer, error = attempted(replace(wish, settings={**wish.settings, last: value}))
        assert answer is None
        text = str(error)
        assert "\n" not in text
        assert f"{last} = {value:.9g}" in text
        assert error.setting == last
        assert error.allowed == (ranges[0].low, ranges[-1].high)
        unit = {
            "length": "deg",
            "length2": "deg",
            "peak": "deg",
            "vcv": "mm/deg",
            "vcv2": "mm/deg",
            "acceleration": "mm/deg^2",
        }
        assert text.endswith(f" {unit.get(last, 'mm')}")


@settings(max_examples=30)
@given(cases(), st.randoms(use_true_random=False), st.lists(st.floats(0.01, 30.0), min_size=4, max_size=4))
def test_nonsense_is_always_refused_with_a_range(case: Case, pick: random.Random, factors: list[float]) -> None:
    """Every setting off by a factor of its own: solved rightly, or refused in one line whose range is kept by all that
    is feasible with the settings beside it."""
    kind, constant, name, numbers, seed = case
    count = freedom(name, numbers)
    assume(count >= 1)
    told = measurable(drawn(case), kind)
    assume(count <= len(told))
    asked = pick.sample(sorted(told), k=count)
    wanted = {n: told[n] * f for n, f in zip(asked, factors, strict=False)}
    answer, error = attempted(asked_for(kind, constant, name, numbers, wanted))
    if answer is not None:
        got = as_motion(answer)
        back = got.settings()
        # a stretch of constant velocity that came out as 0 is no curve
        assert all(n not in back or same(back[n], wanted[n], 1e-9) for n in asked)
        check_joins(got, harmonic=kind == "RRR")
        return
    text = str(error)
    assert "\n" not in text
    assert error.setting in asked, text
    assert error.allowed is not None, text
    low, high = error.allowed
    if "determined" in text:
        assert not independent(name, tuple(asked), numbers, seed) or same(low, high, 1e-8), text
        return
    assert told_ranges(text) or " >" in text
    in_a_gap = " or " in text
    assert in_a_gap or not low * (1 + 1e-9) < wanted[error.setting] < high * (1 - 1e-9), text
    if " with " not in text:  # drawn freely, no motion lies outside of what is said to be all
        for k in range(20):
            other = measured_near(name, numbers, seed + k, None)[error.setting]
            assert low * (1 - 1e-9) <= other <= high * (1 + 1e-9), text


def told_ranges(text: str) -> list[tuple[float, float]]:
    """The ranges that an error's one line names."""
    number = r"([-+.\de]+)"
    return [(float(a), float(b)) for a, b in re.findall(rf"{number} <=? \w+ <=? {number}", text)]


def new_settings(wish: Request) -> list[str]:
    """Those that some sequence still takes."""
    named = {n for opening in open_settings(wish) for n in opening.settings}
    return [n for n in SETTINGS if n in named]


# -- one setting after the other --------------------------------------------------------------------------


@settings(max_examples=30)
@given(cases(), st.integers(0, 2**32))
def test_whatever_is_typed_within_the_ranges_shown_is_blended(case: Case, order: int) -> None:
    """Settings in any order, each anywhere in the range that those before it leave, close to its ends too: none is ever
    without a range, and in the end there is a motion that has them all."""
    kind, constant, name, numbers, _ = case
    pick, usual = random.Random(order), measurable(drawn(case), kind)
    wish = asked_for(kind, constant, name, numbers, {})
    sizes = {}
    while {o.missing for o in open_settings(wish)} != {0}:
        setting = pick.choice([n for n in new_settings(wish) if n != "acceleration" or pick.random() < 0.3])
        ranges = feasible_ranges(wish, setting)
        assert ranges, (wish.settings, setting)
        low, high = ranges[-1].low, min(ranges[-1].high, 3.0 * max(ranges[-1].low, usual[setting]))
        assert high > low, "it says something new"
        narrow = high - low < 1e-6 * high
        value = low + (high - low) * (0.5 if narrow else pick.choice([1e-3, 1.0 - 1e-3, pick.random(), pick.random()]))
        sizes[setting] = high
        wish = replace(wish, settings={**wish.settings, setting: value})
    got = as_motion(blend(wish))
    back = got.settings()
    for n, v in wish.settings.items():
        assert n not in back or abs(back[n] - v) <= 1e-9 * v + 1e-13 * sizes[n], (n, back, wish)
    check_motion(got, case)


@settings(max_examples=10)
@given(cases(), st.randoms(use_true_random=False))
def test_no_motion_lies_outside_the_range_of_what_is_still_to_come(case: Case, pick: random.Random) -> None:
    """Motions drawn freely, and those that have what is set, keep to every range."""
    kind, constant, name, numbers, _ = case
    told = measurable(drawn(case), kind)
    count = freedom(name, numbers)
    assume(count >= 2)
    kept = pick.sample(sorted(told), k=pick.randrange(count - 1))
    wish = asked_for(kind, constant, name, numbers, {n: told[n] for n in kept})
    for setting in pick.sample(sorted(set(told) - set(kept)), k=2):
        ranges = feasible_ranges(wish, setting)
        room = 1e-7 * abs(told[setting])
        if setting in new_settings(wish):
            assert any(r.low - room <= told[setting] <= r.high + room for r in ranges), (kept, setting, ranges)
