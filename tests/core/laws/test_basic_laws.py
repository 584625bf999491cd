"""core.laws against fifty-digit values of the textbooks' definitions, and against published peaks."""

import csv
import math
import random
from pathlib import Path

import numpy as np
import pytest
from references import EPS, LAW_SLUGS, LAW_TERMS, MP, law, law_joins
from sampled import spread

from core.laws import ALIASES, LAWS, Acceleration, Law, find_law, integrate, scca

MOVING = [slug for slug in LAW_SLUGS if not LAWS[slug].is_dwell]

# A value is reached over at most so many roundings of its terms: Horner's rule takes two for each of 7 powers, a sine
# six (frequency, product, phase, sum, function, amplitude), and a coefficient of ``integrate`` comes of a dozen.
ROUNDINGS = 16


def places() -> list[float]:
    """Cam angles 0 ... 1: anywhere, at and beside every join, and as near to the ends as anybody comes."""
    chance = random.Random(1)
    near = [10.0**-k for k in (3, 6, 9, 12)]
    at = [0.0, 0.125, 0.375, 0.5, 0.625, 0.875, 1.0]
    beside = [math.nextafter(u, side) for u in at[1:-1] for side in (0.0, 1.0)]
    return [*at, *beside, *near, *(1.0 - u for u in near), *(chance.random() for _ in range(20))]


def test_the_basic_laws_have_their_references_here() -> None:
    """The others have theirs in test_law_table."""
    assert set(LAWS) >= set(LAW_SLUGS) == set(LAW_TERMS)


@pytest.mark.parametrize("slug", LAW_SLUGS)
def test_a_law_and_its_three_derivatives_keep_to_the_textbook(slug: str) -> None:
    u = np.array(places())
    got = LAWS[slug](u)
    assert got.shape == (4, u.size)
    # the nearest float to a join may be its own right-hand limit: 1/8, 3/8 ... are exact
    for i, x in enumerate(u):
        for k, exact in enumerate(law(slug, x)):
            assert abs(got[k, i] - exact) <= ROUNDINGS * EPS * LAW_TERMS[slug][k], (x, k)


@pytest.mark.parametrize("slug", ["modified-sine", "modified-trapezoid"])
def test_pieces_of_a_law_meet_in_displacement_velocity_and_acceleration(slug: str) -> None:
    """From the left of a join to the right of it is one ulp, over which the next derivative moves little."""
    for join in law_joins(slug)[1:-1]:
        right = float(join)
        left = math.nextafter(right, 0.0)
        below, above = LAWS[slug](np.array([left, right])).T
        for k in range(3):
            bound = 2 * ROUNDINGS * EPS * LAW_TERMS[slug][k] + (right - left) * LAW_TERMS[slug][k + 1]
            assert abs(above[k] - below[k]) <= bound, (right, k)


@pytest.mark.parametrize("slug", MOVING)
def test_a_law_falls_as_it_rises(slug: str) -> None:
    """s(u) + s(1-u) = 1: the rise turned by half a turn is the rise."""
    u = np.linspace(0.0, 1.0, 65)  # exact, and so is 1 - u
    forth, back = LAWS[slug](u), LAWS[slug](1.0 - u)
    bound = 2 * ROUNDINGS * EPS * np.array(LAW_TERMS[slug])
    assert np.abs(forth[0] + back[0] - 1.0).max() <= bound[0]
    assert np.abs(forth[1] - back[1]).max() <= bound[1]
    assert np.abs(forth[2] + back[2])[1:-1].max() <= bound[2]


# -- published peaks --------------------------------------------------------------------------------------

ROWS = {
    row["law"]: row
    for row in csv.DictReader(Path(__file__).with_name("law_coefficients.csv").read_text(encoding="utf-8").splitlines())
}


def mcv(share: float) -> Law:
    """The modified sine with a share of constant velocity put into its middle."""
    return Law("mcv", "", "", scca((1 - share) / 4, 0.0, 3 * (1 - share) / 4), (), "")


PUBLISHED = {
    "3-4-5": LAWS["3-4-5"],
    "4-5-6-7": LAWS["4-5-6-7"],
    "simple harmonic": LAWS["simple-harmonic"],
    "cycloidal (inclined sine / Bestehorn)": LAWS["cycloidal"],
    "modified sine (SCCA)": LAWS["modified-sine"],
    "modified trapezoid (SCCA)": LAWS["modified-trapezoid"],
    "modified sine + CV 20% (SCCA; MCV/MSC)": mcv(0.2),
    "modified sine + CV 33% (SCCA; MCV/MSC)": mcv(1 / 3),
    "modified sine + CV 50% (SCCA; MCV/MSC)": mcv(0.5),
    "modified sine + CV 67% (SCCA; MCV/MSC)": mcv(2 / 3),
    "parabolic (constant acc)": Law("parabolic", "", "", scca(0.0, 1.0, 0.0), (), ""),
}


@pytest.mark.parametrize("name", spread(list(PUBLISHED), 2))
def test_peaks_are_the_published_ones(name: str) -> None:
    """To the last printed digit. Cm is the largest |v a|; the jerk is that of the inside."""
    row, rise = ROWS[name], PUBLISHED[name]
    # a peak between samples 5e-6 apart is missed by less than 5e-6² x the third derivative of its curve
    cuts = sorted({*np.linspace(0.0, 1.0, 200_001), *(p.start for p in rise.pieces)})
    s, v, a, j = rise(np.array(cuts[:-1]))
    assert s[0] == 0.0
    told = {"Cv": v, "Ca": a, "Cj": j, "Cm=max|va|": v * a}
    for column, values in told.items():
        if row[column] == "inf":
            continue
        printed = row[column].partition(".")[2]
        assert np.abs(values).max() == pytest.approx(float(row[column]), abs=0.51 * 10.0 ** -len(printed)), column
    width = np.diff(cuts)
    rms = math.sqrt(float((a * a * width).sum()))  # a rectangle rule: off by 5e-6 of the jump of a² at the ends
    assert rms == pytest.approx(float(row["a_rms"]), abs=2e-4)
    jumps = abs(float(a[0])) > 1e-9
    assert jumps == (row["a_jumps_at_an_end"] == "yes")


# -- the family -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("widths", "slug"),
    [((0.25, 0.5, 0.25), "modified-trapezoid"), ((0.25, 0.0, 0.75), "modified-sine"), ((0.5, 0.0, 0.5), "cycloidal"),
     ((0.0, 0.0, 1.0), "simple-harmonic")],
)  # fmt: skip
def test_the_sine_constant_cosine_family_holds_the_named_laws(widths: tuple[float, float, float], slug: str) -> None:
    u = np.array([x for x in places() if x < 1.0])
    got = Law("member", "", "", scca(*widths), (), "")(u)
    for i, x in enumerate(u):
        joins = [float(j) for j in law_joins(slug)]
        if any(0.0 < abs(x - j) < 1e-12 for j in joins):
            continue  # the member's joins stand where its own sum of widths puts them
        for k, exact in enumerate(law(slug, x)):
            # the integrated member has more pieces, each of the size of the law
            assert abs(got[k, i] - exact) <= 4 * ROUNDINGS * EPS * LAW_TERMS[slug][k], (x, k)


def test_integration_leaves_out_what_has_no_width() -> None:
    rows = [Acceleration(0.5, level=1.0), Acceleration(0.0, level=7.0), Acceleration(0.5, level=-1.0)]
    pieces = integrate(rows)
    assert [p.start for p in pieces] == [0.0, 0.5]
    assert Law("x", "", "", pieces, (), "")(np.array([0.25, 0.5, 1.0]))[0] == pytest.approx(
        [0.125, 0.5, 1.0], abs=4 * EPS
    )


def test_names_and_aliases() -> None:
    assert all(find_law(slug) is LAWS[slug] for slug in LAWS)
    assert all(find_law(alias) is LAWS[slug] for alias, slug in ALIASES.items())
    assert find_law("harmonic") is LAWS["simple-harmonic"]
    assert find_law("Cycloidal") is None
    assert find_law("") is None


def test_the_modified_sine_in_the_form_of_its_table() -> None:
    """k(πu - sin(4πu)/4), k(2 + πu - (9/4) sin(4πu/3 + π/3)), k(4 + πu - sin(4πu)/4) with k = 1/(4+π)."""
    k, pi = 1 / (4 + MP.pi), MP.pi
    closed = (
        lambda u: k * (pi * u - MP.sin(4 * pi * u) / 4),
        lambda u: k * (2 + pi * u - MP.mpf(9) / 4 * MP.sin(4 * pi * u / 3 + pi / 3)),
        lambda u: k * (4 + pi * u - MP.sin(4 * pi * u) / 4),
    )
    for u in places():
        part = closed[0] if u < 0.125 else closed[1] if u < 0.875 else closed[2]
        exact = part(MP.mpf(u))
        assert abs(law("modified-sine", u)[0] - exact) < MP.mpf(10) ** -45, "two definitions of one law"
        assert (
            abs(LAWS["modified-sine"](np.array([u]))[0, 0] - exact) <= ROUNDINGS * EPS * LAW_TERMS["modified-sine"][0]
        )
