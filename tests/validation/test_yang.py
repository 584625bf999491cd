"""Yang and Shon's paper, Tables 1 and 2, Figs. 1 and 4, and the relations between heights and speeds that follow from its
joining conditions: solved here in 40 digits from the curves' formulas alone."""

from __future__ import annotations

import random
from functools import lru_cache
from typing import Any

import mpmath as mp
import pytest
from blends import FREEDOM, SEQUENCES, free_motion
from mpmath import mpf, pi, sin, sqrt
from sampled import spread

from core.blend import ELEMENTS, BlendError, CurveSequence, Request, blend, sequences

DIGITS = 40
TIGHT = mpf(10) ** -35

# -- Table 1: signs of velocity and acceleration at start and end, and what is usable next, as printed ------------

TABLE_1 = {
    "C1": ("0+", "00", "C2 H2 CV1"), "C2": ("+0", "00", "C1 C3 C5 C6 P1"), "C3": ("0-", "00", "C4 H4 CV2"),
    "C4": ("-0", "00", "C1 C3 C5 C6 P1"), "C5": ("00", "00", "C1 C3 C6 P1"), "C6": ("00", "00", "C1 C3 C5 P1"),
    "H1": ("0+", "+0", "C2 H2 CV1"), "H2": ("+0", "0-", "H3 H6 P2"), "H3": ("0-", "-0", "C4 H4 CV2"),
    "H4": ("-0", "0+", "H1 H5"), "H5": ("00", "+-", "H3 H6 P2"), "H6": ("00", "-+", "H1 H5"),
    "P1": ("00", "0-", "H3 H6 P2"), "P2": ("00", "-0", "C1 C3 C5 C6 P1"), "CV1": ("++", "00", "C2 H2"),
    "CV2": ("--", "00", "C4 H4"),
}  # fmt: skip
SIGN = {"0": 0, "+": 1, "-": -1}
RISES = ("C1", "C2", "C5", "H1", "H2", "H5", "P1", "CV1")


@pytest.mark.parametrize("curve", TABLE_1)
def test_table_1(curve: str) -> None:
    """V and A at both ends; usable next is every other curve that starts as this one ends."""
    v, a, following = TABLE_1[curve]
    row = ELEMENTS[curve]
    assert row.start == (SIGN[v[0]], SIGN[a[0]])
    assert row.end == (SIGN[v[1]], SIGN[a[1]])
    assert row.velocity_sign == (1 if curve in RISES else -1)
    others = {n for n in ELEMENTS if n != curve and ELEMENTS[n].start == row.end}
    assert others == set(following.split())


# Table 2: for each place in a motion (way, whether it starts and ends at rest, acceleration there) the one curve.
TABLE_2 = {
    "DRD": [("C1", 1, "00", "+"), ("C2", 1, "+", "00"), ("C5", 1, "00", "00"), ("C6", -1, "00", "00"),
            ("C3", -1, "00", "-"), ("C4", -1, "-", "00")],
    "DRRD": [("C1", 1, "00", "+"), ("H2", 1, "+", "0-"), ("P1", 1, "00", "0-"), ("P2", -1, "0-", "00"),
             ("H3", -1, "0-", "-"), ("C4", -1, "-", "00")],
    "RRR": [("H1", 1, "0+", "+"), ("H2", 1, "+", "0-"), ("H5", 1, "0+", "0-"), ("H6", -1, "0-", "0+"),
            ("H3", -1, "0-", "-"), ("H4", -1, "-", "0+")],
}  # fmt: skip


@pytest.mark.parametrize("kind", TABLE_2)
def test_table_2(kind: str) -> None:
    """ "Only one curve can be used at a given place"."""
    for curve, way, start, end in TABLE_2[kind]:
        fitting = [
            n
            for n, (v, a, _) in TABLE_1.items()
            if (n in RISES) == (way > 0)
            and not n.startswith("CV")
            and start == (v[0] if v[0] != "0" else "0" + a[0])
            and end == (v[1] if v[1] != "0" else "0" + a[1])
        ]
        assert fitting == [curve]


# Fig. 1: states at the start, at the top and at the end
MOTIONS = {
    "DRD": ("00", "00", None),
    "DRD-return": (None, "00", "00"),
    "DRRD": ("00", "0-", "00"),
    "RRR": ("0+", "0-", "0+"),
}


def strokes(start: str | None, end: str | None, rising: bool) -> list[tuple[str, ...]]:
    """Chains of Table 1 of one way between two states, that stand still only there."""
    if start is None or end is None:
        return [()]
    found, chains = [], [(n,) for n, (v, a, _) in TABLE_1.items() if v[0] + a[0] == start]
    while chains:
        chain = chains.pop()
        v, a, following = TABLE_1[chain[-1]]
        if (chain[-1] in RISES) != rising:
            continue
        if v[1] != "0":
            chains += [(*chain, n) for n in following.split()]
        elif v[1] + a[1] == end:
            found.append(chain)
    return found


@pytest.mark.parametrize("kind", MOTIONS)
@pytest.mark.parametrize("constant", ["none", "rise", "return", "both"])
def test_the_sequences_of_every_type_of_motion(kind: str, constant: str) -> None:
    start, top, end = MOTIONS[kind]
    chains = [(*r, *b) for r in strokes(start, top, True) for b in strokes(top, end, False)]
    wanted = {"none": [], "rise": ["CV1"], "return": ["CV2"], "both": ["CV1", "CV2"]}[constant]
    expected = {"-".join(c) for c in chains if [n for n in c if n.startswith("CV")] == wanted}
    assert {str(s) for s in sequences(kind, constant)} == expected
    assert sorted(expected) == sorted(SEQUENCES.get((kind, constant), []))


# -- the joining conditions in 40 digits --------------------------------------------------------------------------

FORMULAS = {
    "C1": lambda u: u - sin(pi * u) / pi, "C2": lambda u: u + sin(pi * u) / pi, "C5": lambda u: u - sin(2 * pi * u) / (2 * pi),
    "H1": lambda u: 1 - mp.cos(pi * u / 2), "H2": lambda u: sin(pi * u / 2), "H5": lambda u: (1 - mp.cos(pi * u)) / 2,
    "P1": lambda u: (250 * u**3 - 852 * u**5 + 1096 * u**6 - 558 * u**7 + 105 * u**8) / 41, "CV1": lambda u: u,
}  # fmt: skip
TURNED = {"C3": "C1", "C4": "C2", "C6": "C5", "H3": "H1", "H4": "H2", "H6": "H5", "CV2": "CV1"}


@lru_cache
def ends(curve: str) -> tuple[mpf, ...]:
    """v and a at both ends for unit height and span: (v0, v1, a0, a1)."""
    with mp.workdps(DIGITS + 20):
        if curve == "P2":
            formula = lambda u: FORMULAS["P1"](1 - u)  # noqa: E731
        elif curve in TURNED:
            formula = lambda u: 1 - FORMULAS[TURNED[curve]](u)  # noqa: E731
        else:
            formula = FORMULAS[curve]
        found = tuple(mp.diff(formula, at, k, h=mpf(10) ** -18) for k in (1, 2) for at in (0, 1))
        return tuple(mpf(0) if abs(v) < mpf(10) ** -30 else v for v in found)


def conditions(curves: tuple[str, ...], stroke: Any, back: Any, span: Any) -> list[Any]:
    """Equations (1)-(5) for heights and spans z = (h_1 ... h_n, β_1 ... β_n)."""
    n = len(curves)
    rows: list[Any] = [lambda z: sum(z[n:]) - span]
    for way, total in ((True, stroke), (False, back)):
        which = [i for i, c in enumerate(curves) if (c in RISES) == way]
        if which:
            rows.append(lambda z, which=which, total=total: sum(z[i] for i in which) - total)
    joins = [(i, i + 1) for i in range(n - 1)] + ([(n - 1, 0)] if curves[0][0] == "H" else [])
    for i, j in joins:
        for k in (0, 2):
            left, right = ends(curves[i])[k + 1], ends(curves[j])[k]
            if left or right:
                order = 1 + k // 2
                rows.append(
                    lambda z, i=i, j=j, a=left, b=right, order=order: (
                        a * z[i] / z[n + i] ** order - b * z[j] / z[n + j] ** order
                    )
                )
    return rows


def solved(
    curves: tuple[str, ...], fixed: dict[int, Any], guess: list[float], stroke: Any, back: Any, span: Any
) -> list[Any]:
    """Heights and spans in 40 digits with some of them given."""
    rows = conditions(curves, stroke, back, span)
    rows += [lambda z, i=i, v=v: z[i] - v for i, v in fixed.items()]
    assert len(rows) == 2 * len(curves), "as many equations as unknowns: so many settings are free"
    found = mp.findroot(
        lambda *z: [row(z) for row in rows], [mpf(v) for v in guess], tol=mpf(10) ** -(2 * DIGITS - 6), maxsteps=60
    )
    return list(found)


def names_of(curves: tuple[str, ...]) -> dict[str, int]:
    """h1, h2, h3 before, of and after the constant velocity of the rise; h6, h5, h4 their time mirror."""
    rise = [i for i, c in enumerate(curves) if c in RISES]
    back = [i for i, c in enumerate(curves) if c not in RISES]
    found = {}
    for which, names in ((rise, ("h1", "h2", "h3")), (back, ("h4", "h5", "h6"))):
        found.update(zip(names if len(which) == 3 else names[::2], which, strict=False))
    return found


A = lambda: pi / 2 - 1  # noqa: E731
K = lambda: sqrt(mpf(216) / 41)  # noqa: E731

# by sequence: what must vanish, of the heights, of W = Vβ, r = V2/V and h the stroke
RELATIONS: dict[str, list[Any]] = {
    "C1-C2": [lambda m: m["h1"] / m["b1"] - m["h"] / m["span"], lambda m: m["h3"] / m["b3"] - m["h"] / m["span"]],
    "C1-CV1-C2": [lambda m: m["W"] - (2 * m["h"] - m["h2"])],
    "C1-H2-P2": [lambda m: m["W"] - (m["h"] + m["h1"] + A() * m["h3"] + K() * sqrt(m["h"] * m["h3"]))],
    "C1-CV1-H2-P2": [lambda m: m["W"] - (m["h"] + m["h1"] + A() * m["h3"] + K() * sqrt(m["h"] * m["h3"]))],
    "C1-H2-H3-C4": [
        lambda m: m["h4"] - m["r"] ** 2 * m["h3"],
        lambda m: m["W"] - (m["h"] + m["h1"] + A() * m["h3"] + (m["h"] + m["h6"] + A() * m["h4"]) / m["r"]),
    ],
    "H1-H2-H6": [lambda m: m["h1"] - m["h"] / 2, lambda m: m["b1"] - m["span"] / 4, lambda m: m["b3"] - m["span"] / 4],
    "H1-H2-H3-H4": [lambda m: m["h1"] - 2 * m["h"] * m["b1"] / m["span"], lambda m: m["h6"] - m["h1"], lambda m: m["h4"] - m["h3"]],
    "H1-CV1-H2-H6": [
        lambda m: m["h1"] - m["h3"],
        lambda m: m["W"] - (m["h"] + (pi - 2) * m["h1"] + pi / 2 * sqrt(2 * m["h"] * m["h1"])),
    ],
    "H1-CV1-H2-H3-H4": [
        lambda m: m["h4"] - m["h"] * m["h3"] / (m["h1"] + m["h3"]),
        lambda m: m["h6"] - m["h"] * m["h1"] / (m["h1"] + m["h3"]),
        lambda m: m["W"] - (m["h"] + A() * (m["h1"] + m["h3"]) + pi / 2 * sqrt(m["h"] * (m["h1"] + m["h3"]))),
    ],
    "H1-CV1-H2-H3-CV2-H4": [
        lambda m: m["h4"] - m["r"] ** 2 * m["h3"],
        lambda m: m["h6"] - m["r"] ** 2 * m["h1"],
        lambda m: m["W"] - (m["h"] + A() * s(m) + (m["h"] + A() * m["r"] ** 2 * s(m)) / m["r"]),
        lambda m: A() * s(m) * m["r"] ** 2 + (m["h"] + A() * s(m) - m["W"]) * m["r"] + m["h"],
    ],
}  # fmt: skip
for _name in ("C1-CV1-H2-H3-C4", "C1-H2-H3-CV2-C4", "C1-CV1-H2-H3-CV2-C4"):
    RELATIONS[_name] = RELATIONS["C1-H2-H3-C4"]
RELATIONS["H1-H2-H3-CV2-H4"] = RELATIONS["H1-CV1-H2-H3-CV2-H4"]
# these run backwards: h1 for h6, h2 for h5, h3 for h4
BACKWARDS = {
    "C3-C4": "C1-C2", "C3-CV2-C4": "C1-CV1-C2", "P1-H3-C4": "C1-H2-P2", "P1-H3-CV2-C4": "C1-CV1-H2-P2",
    "H5-H3-H4": "H1-H2-H6", "H5-H3-CV2-H4": "H1-CV1-H2-H6",
}  # fmt: skip


def s(m: dict[str, Any]) -> Any:
    return m["h1"] + m["h3"]


def measures(curves: tuple[str, ...], z: list[Any], span: Any) -> dict[str, Any]:
    """Heights, spans b1 ..., W, r and h, all in 40 digits, of a motion or of the same run backwards."""
    where, n = names_of(curves), len(curves)
    found: dict[str, Any] = {"span": span}
    for name, i in where.items():
        found[name], found["b" + name[1]] = z[i], z[n + i]
    if curves[0] in ("C3", "P1", "H5"):
        mirror = str.maketrans("123456", "654321")
        found = {"span": span, **{k.translate(mirror): v for k, v in found.items() if k != "span"}}
    found["h"] = sum(found.get(k, 0) for k in ("h1", "h2", "h3"))
    first, last = (curves[0], curves[-1]) if curves[0] not in ("C3", "P1", "H5") else (curves[-1], curves[0])
    found["W"] = span * abs(max(ends(first)[:2], key=abs)) * found["h1"] / found["b1"]
    if "b6" in found and "h6" in found and len([c for c in (last,) if c in ("C4", "H4")]):
        found["r"] = span * abs(max(ends(last)[:2], key=abs)) * found["h6"] / found["b6"] / found["W"]
    return found


TABLE = [n for names in SEQUENCES.values() for n in names if n in RELATIONS or n in BACKWARDS]


@pytest.mark.parametrize("name", spread(TABLE, 8))
@pytest.mark.parametrize("seed", [1, 2])
def test_the_relations_of_every_sequence(name: str, seed: int) -> None:
    """Against the joining conditions solved with as many heights given as are free; and blending gives that motion."""
    curves = tuple(name.split("-"))
    made = free_motion(name, random.Random(seed), 20.0, 20.0, 0.0, 300.0)
    where = names_of(curves)
    given = dict(list(where.items())[: FREEDOM[name]]) if FREEDOM[name] else {}
    rise, back = (("h1", "h2", "h3"), ("h4", "h5", "h6"))
    order = [n for n in ("h1", "h3", "h6", "h4", "h2", "h5") if n in where]
    given = {}
    for n in order:
        alike = rise if n in rise else back
        if len(given) < FREEDOM[name] and sum(m in given for m in alike) < sum(m in where for m in alike) - 1:
            given[n] = where[n]
    with mp.workdps(DIGITS):
        fixed = {i: mpf(made.heights[i]) for i in given.values()}
        z = solved(curves, fixed, [*made.heights, *made.spans], mpf(20), mpf(20), mpf(300))
        m = measures(curves, z, mpf(300))
        for relation in RELATIONS[BACKWARDS.get(name, name)]:
            assert abs(relation(m)) < TIGHT * m["W"]
        settings = {n: made.heights[i] for n, i in given.items()}
        kind, constant = next(k for k, names in SEQUENCES.items() if name in names)
        got = blend(Request(kind, 20.0, 0.0, 300.0, constant, settings, sequence=name, mirrored=False)).solution
        for value, exact in zip((*got.heights, *got.spans), z, strict=True):
            assert abs(mpf(value) - exact) <= 4e-13 * abs(exact)


@pytest.mark.parametrize(("name", "wanted"), [
    ("C1-CV1-H2-H3-CV2-C4", lambda m: 2 * (m["h"] + m["h1"] + A() * m["h3"])),
    ("H1-CV1-H2-H3-CV2-H4", lambda m: 2 * (m["h"] + A() * s(m))),
])  # fmt: skip
def test_the_relation_of_mirrored_six_curves(name: str, wanted: Any) -> None:
    curves = tuple(name.split("-"))
    made = free_motion(name, random.Random(5), 20.0, 20.0, 0.0, 300.0, mirrored=True)
    with mp.workdps(DIGITS):
        values = [mpf(made.heights[0]), mpf(made.heights[2])]
        fixed = {0: values[0], 2: values[1], 5: values[0]}
        if name[0] == "C":
            fixed[3] = values[1]
        z = solved(curves, fixed, [*made.heights, *made.spans], mpf(20), mpf(20), mpf(300))
        m = measures(curves, z, mpf(300))
        assert abs(m["W"] - wanted(m)) < TIGHT * m["W"]
        assert abs(m["r"] - 1) < TIGHT


# -- the card picker ----------------------------------------------------------------------------------------------

PICKER = {"type": "DRRD", "stroke": 20.0, "start": 30.0, "end": 330.0, "constant": "rise"}
EXACT = (18.8468353936, 169.621518543, 14.8022699040, 96.7293761598)
PRINTED = (18.846, 169.613, 14.801, 96.740)


def test_the_card_picker() -> None:
    """Fig. 4: h1 = h3 = 1 mm. The exact spans to the last digit told, and in 40 digits from the joining conditions."""
    got = blend(Request(**PICKER, settings={"h1": 1.0, "h3": 1.0})).solution
    assert str(got.sequence) == "C1-CV1-H2-P2"
    assert got.heights == pytest.approx((1.0, 18.0, 1.0, 20.0), rel=1e-14)
    assert got.spans == pytest.approx(EXACT, abs=1e-9)
    assert got.speed == pytest.approx(0.106118611333, abs=1e-12)
    with mp.workdps(DIGITS):
        z = solved(got.sequence.curves, {0: mpf(1), 2: mpf(1)}, [1, 18, 1, 20, *PRINTED], mpf(20), mpf(20), mpf(300))
        assert [float(v) for v in z[4:]] == pytest.approx(got.spans, rel=1e-14)


def test_the_card_picker_as_printed() -> None:
    """The print is 0.01 deg off: its spans miss the join of the accelerations at the top, between H2 and P2, by 4 parts in
    10,000 of either, though they meet those of the velocities to their last digit. They are those of 5.27 for P2's 216/41."""
    got = blend(Request(**PICKER, settings={"h1": 1.0, "h3": 1.0})).solution
    assert got.spans == pytest.approx(PRINTED, abs=0.02)
    assert max(abs(a - b) for a, b in zip(got.spans, PRINTED, strict=True)) > 0.01, "not by rounding the spans"
    b1, b2, b3, b4 = PRINTED
    assert sum(PRINTED) == pytest.approx(300.0, abs=1e-9)
    speeds = (2 * 1 / b1, 18 / b2, pi / 2 * 1 / b3)
    assert [float(v / speeds[1]) for v in speeds] == pytest.approx([1, 1, 1], abs=1e-4)
    harmonic, polynomial = float(pi**2 / 4 * 1 / mpf(b3) ** 2), 216 / 41 * 20 / b4**2
    assert harmonic / polynomial - 1 == pytest.approx(4e-4, abs=1e-5)
    exact = float(pi**2 / 4 / mpf(got.spans[2]) ** 2), 216 / 41 * 20 / got.spans[3] ** 2
    assert exact[0] == pytest.approx(exact[1], rel=1e-13)
    lengths = [2, 18, pi / 2, mp.sqrt(mpf("5.27") * 20)]
    assert [round(float(300 * each / sum(lengths)), 3) for each in lengths] == list(PRINTED)


def test_the_table_of_fig_4() -> None:
    """Start and end of every curve, angles in degrees and displacements in millimetres."""
    table = [
        ("C1", 30.0, 0.0, 48.85, 1.0),
        ("CV1", 48.85, 1.0, 218.46, 19.0),
        ("H2", 218.46, 19.0, 233.26, 20.0),
        ("P2", 233.26, 20.0, 330.0, 0.0),
    ]
    answer = blend(Request(**PICKER, settings={"h1": 1.0, "h3": 1.0}))
    angle, level = 30.0, 0.0
    for segment, (curve, begins, low, finishes, high) in zip(answer.segments, table, strict=True):
        assert segment.curve.law == curve.lower()
        assert (angle, level) == (pytest.approx(begins, abs=0.02), pytest.approx(low, abs=1e-12))
        angle, level = angle + segment.span_deg, level + segment.rise
        assert (angle, level) == (pytest.approx(finishes, abs=0.02), pytest.approx(high, abs=1e-12))


def test_the_text_asks_for_another_peak_than_fig_4_has() -> None:
    """The text: rise from 30 to 250 deg, constant velocity over at least 150 deg. Fig. 4: top at 233.3 deg."""
    fig_4 = blend(Request(**PICKER, settings={"h1": 1.0, "h3": 1.0})).solution
    assert 30.0 + sum(fig_4.spans[:3]) == pytest.approx(233.3, abs=0.05)
    assert fig_4.spans[1] >= 150.0
    asked = blend(Request(**PICKER, settings={"h1": 1.0, "peak": 250.0})).solution
    assert asked.spans == pytest.approx((20.632304, 190.118963, 9.248733, 80.0), abs=1e-6)
    assert asked.heights[2] == pytest.approx(0.5707, abs=5e-5)
    with mp.workdps(DIGITS):
        curves = asked.sequence.curves
        z = solved(curves, {0: mpf(1), 7: mpf(80)}, [*asked.heights, *EXACT], mpf(20), mpf(20), mpf(300))
        assert [float(v) for v in z[4:]] == pytest.approx(asked.spans, rel=1e-13)


def test_both_heights_and_the_peak_want_a_curve_more() -> None:
    """The four curves of Fig. 4 take two settings; five reach 250 deg with h1 = h3 = 1 mm too."""
    settings = {"h1": 1.0, "h3": 1.0, "peak": 250.0}
    with pytest.raises(BlendError, match="C1-CV1-H2-P2 requires 2 settings"):
        blend(Request(**PICKER, settings=settings, sequence="C1-CV1-H2-P2"))
    five = blend(Request(**PICKER, settings=settings)).solution
    assert five.sequence == CurveSequence(("C1", "CV1", "H2"), ("H3", "C4"))
    assert five.heights[:3] == pytest.approx((1.0, 18.0, 1.0), rel=1e-14)
    assert 30.0 + sum(five.spans[:3]) == pytest.approx(250.0, rel=1e-14)
    assert five.spans[1] >= 150.0


def test_the_range_of_the_constant_velocity_of_a_rise() -> None:
    """Eqs. (7), (8): β2 = 2h/C - β, so h/β < C <= 2h/β."""
    from core.blend import feasible_ranges

    wish = Request("DRD", 20.0, 30.0, 330.0, "rise", {})
    (found,) = feasible_ranges(wish, "vcv")
    assert (found.low, found.high) == pytest.approx((20 / 300, 40 / 300), rel=1e-13)
    assert (found.low_open, found.high_open) == (True, False)
    for speed in (0.07, 0.1, 0.13):
        got = blend(Request("DRD", 20.0, 30.0, 330.0, "rise", {"vcv": speed, "h1": 0.4})).solution
        assert got.spans[1] == pytest.approx(2 * 20 / speed - 300, rel=1e-11)
