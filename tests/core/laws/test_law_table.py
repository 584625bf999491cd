"""The laws beyond the basic ones against textbook formulas in 50-digit arithmetic, and their published peaks."""

import csv
import math
from collections.abc import Callable
from pathlib import Path

import mpmath
import numpy as np
import pytest

from core.design import CURVES
from core.laws import EVERY_LAW, LAWS, Law, asymmetric, named_law, peaks

EPS = float(np.finfo(float).eps)
pi = mpmath.pi


def _poly(*terms: tuple[int, int], over: int = 1) -> Callable[[mpmath.mpf], mpmath.mpf]:
    return lambda u: sum(c * u**k for c, k in terms) / over


P1 = _poly((250, 3), (-852, 5), (1096, 6), (-558, 7), (105, 8), over=41)
C1, C2 = (lambda u: u - mpmath.sin(pi * u) / pi), (lambda u: u + mpmath.sin(pi * u) / pi)
C5 = lambda u: u - mpmath.sin(2 * pi * u) / (2 * pi)  # noqa: E731
H1, H2 = (lambda u: 1 - mpmath.cos(pi * u / 2)), (lambda u: mpmath.sin(pi * u / 2))
H5 = lambda u: (1 - mpmath.cos(pi * u)) / 2  # noqa: E731


def _inclined(*weights: tuple[int, float]) -> Callable[[mpmath.mpf], mpmath.mpf]:
    """u - c sum w_k sin(2 pi k u), c such that it starts at rest."""
    c = 1 / sum(2 * pi * k * mpmath.mpf(w) for k, w in weights)
    return lambda u: u - c * sum(mpmath.mpf(w) * mpmath.sin(2 * pi * k * u) for k, w in weights)


FORMULAS = {
    "double-harmonic": lambda u: ((1 - mpmath.cos(pi * u)) - (1 - mpmath.cos(2 * pi * u)) / 4) / 2,
    "2-3": _poly((3, 2), (-2, 3)),
    "5-6-7-8-9": _poly((126, 5), (-420, 6), (540, 7), (-315, 8), (70, 9)),
    "freudenstein-1-3": _inclined((1, mpmath.mpf(1)), (3, mpmath.mpf(1) / 81)),
    "freudenstein-1-3-5": _inclined((1, mpmath.mpf(1)), (3, mpmath.mpf(1) / 54), (5, mpmath.mpf(1) / 1250)),
    "gutman-1-3": _inclined((1, mpmath.mpf(15) / 32), (3, mpmath.mpf(1) / 96)),
    "c1": C1, "c2": C2, "c3": C1, "c4": C2, "c5": C5, "c6": C5,
    "h1": H1, "h2": H2, "h3": H1, "h4": H2, "h5": H5, "h6": H5,
    "p1": P1, "p2": lambda u: 1 - P1(1 - u), "cv1": lambda u: u, "cv2": lambda u: u,
}  # fmt: skip
PUBLISHED = {
    "2-3 (cubic)": "2-3", "3-4-5": "3-4-5", "4-5-6-7": "4-5-6-7", "5-6-7-8-9": "5-6-7-8-9",
    "parabolic (constant acc)": "parabolic", "simple harmonic": "simple-harmonic",
    "cycloidal (inclined sine / Bestehorn)": "cycloidal", "Gutman 1-3": "gutman-1-3",
    "Freudenstein 1-3": "freudenstein-1-3", "Freudenstein 1-3-5": "freudenstein-1-3-5",
    "modified sine (SCCA)": "modified-sine", "modified trapezoid (SCCA)": "modified-trapezoid",
    "modified sine + CV 20% (SCCA; MCV/MSC)": "mcv20", "modified sine + CV 33% (SCCA; MCV/MSC)": "mcv33",
    "modified sine + CV 50% (SCCA; MCV/MSC)": "mcv50", "modified sine + CV 67% (SCCA; MCV/MSC)": "mcv66",
    "KM C1 (half cycloid, accel)": "c1", "KM H1 (half harmonic, accel)": "h1", "KM P1 eighth-degree": "p1",
    "double harmonic (rise, DRRD)": "double-harmonic",
}  # fmt: skip
ROWS = {
    row["law"]: row
    for row in csv.DictReader(Path(__file__).with_name("law_coefficients.csv").read_text("utf-8").splitlines())
}


@pytest.mark.parametrize("slug", FORMULAS)
def test_a_law_and_its_derivatives_keep_to_the_textbook(slug: str) -> None:
    places = [1e-9, 0.03, 0.125, 0.31, 0.5, 0.77, 1.0 - 1e-9]
    got = LAWS[slug](np.array(places))
    with mpmath.workdps(50):
        for order in range(4):
            for i, u in enumerate(places):
                exact = mpmath.diff(FORMULAS[slug], mpmath.mpf(u), order) if order else FORMULAS[slug](mpmath.mpf(u))
                # the sums of an eighth or ninth degree cancel: their terms reach some thousand times the peak
                assert abs(got[order, i] - float(exact)) <= 64 * EPS * 10.0 ** (order + 1)


@pytest.mark.parametrize("name", PUBLISHED)
def test_peaks_are_the_published_ones(name: str) -> None:
    row, found = ROWS[name], peaks(LAWS[PUBLISHED[name]])
    for column, value in (("Cv", found.cv), ("Ca", found.ca), ("Cj", found.cj), ("Cm=max|va|", found.cm)):
        # the table's P1 comes from rounded coefficients
        rounding = 2e-4 if "P1" in name else 0.51 * 10.0 ** -len(row[column].partition(".")[2])
        if row[column] == "inf":
            assert math.isinf(value)
        else:
            assert abs(value - float(row[column])) <= rounding
    assert found.jumps_at_an_end == (row["a_jumps_at_an_end"] == "yes")


def test_every_row_of_the_table_is_tested() -> None:
    assert set(PUBLISHED) == set(ROWS)
    basic = {"dwell", "constant-velocity", "simple-harmonic", "cycloidal", "modified-sine", "modified-trapezoid"}
    tested = basic | {"3-4-5", "4-5-6-7"} | set(FORMULAS) | set(PUBLISHED.values())
    assert set(LAWS) == tested


@pytest.mark.parametrize("crossover", [0.2, 0.4, 0.5, 0.75])
@pytest.mark.parametrize("slug", ["modified-sine", "modified-trapezoid", "cycloidal", "3-4-5", "4-5-6-7"])
def test_an_asymmetric_law_is_smooth_at_its_crossover(slug: str, crossover: float) -> None:
    law = Law("x", "x", "", asymmetric(LAWS[slug].pieces, crossover), (), "")
    ends = law(np.array([0.0, 1.0]))
    assert abs(ends[0, 0]) <= 8 * EPS
    assert abs(ends[0, 1] - 1.0) <= 8 * EPS
    before, after = law(np.array([math.nextafter(crossover, 0.0), crossover])).T
    assert np.abs(before - after)[:3].max() <= 1e-12
    assert after[0] == pytest.approx(crossover, abs=8 * EPS)
    assert np.abs(law(np.linspace(0.0, crossover, 50))[2, 1:-1]).min() > 0.0


def test_every_curve_has_a_short_name_of_its_own() -> None:
    """Also those with keys of their own, and by their other spellings; Yang's go by their slugs."""
    assert {*EVERY_LAW} == {*LAWS, *CURVES}
    names = [law.short_name for law in EVERY_LAW.values()]
    assert len(set(names)) == len(names)
    assert max(len(name) for name in names) <= 5
    assert named_law("c3").short_name == "C3"
    assert named_law("harmonic").short_name == named_law("simple-harmonic").short_name == "SH"


@pytest.mark.parametrize("slug", ["p1", "p2"])
def test_the_eighth_degree_accelerates_most_inside_its_span(slug: str) -> None:
    """Its end has 216/41 = 5.268292683, a place at 0.241682 of the span a little more."""
    polynomial = np.polynomial.Polynomial([0, 0, 0, 250, 0, -852, 1096, -558, 105]) / 41
    inside = max(abs(polynomial.deriv(2)(u.real)) for u in polynomial.deriv(3).roots() if 0.1 < u.real < 0.9)
    assert peaks(LAWS[slug]).ca == pytest.approx(inside, rel=1e-12)
    assert peaks(LAWS[slug]).ca == pytest.approx(5.268301041, abs=5e-10)


@pytest.mark.parametrize("slug", sorted(LAWS))
def test_no_place_of_a_law_exceeds_its_peaks(slug: str) -> None:
    """Several tops may be nearly as high, and the highest one fall between two samples."""
    u = np.linspace(0.0, 1.0, 20_001)
    _, v, a, j = LAWS[slug](u)
    found = peaks(LAWS[slug])
    for values, peak in ((v, found.cv), (a, found.ca), (j, found.cj), (v * a, found.cm)):
        assert np.abs(values).max() <= peak * (1.0 + 1e-12)
