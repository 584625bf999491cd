"""Known machines by closed forms: Oldham's coupling turns alike, Jansen's leg walks where its circles meet."""

import numpy as np
from linkages import link

from core.design import Design, Drawn, Drive, Driver, Linkage, LinkageLoads, LinkPoint, Slider, faults
from core.study import Study


def meet(p: np.ndarray, r: float, q: np.ndarray, s: float, side: float) -> np.ndarray:
    """Where circles about p and q meet, left (+1) or right of the way from p to q."""
    way = q - p
    d = np.abs(way)
    x = (d * d + r * r - s * s) / (2.0 * d)
    return np.asarray(p + way / d * (x + 1j * side * np.sqrt(r * r - x * x)))


def test_oldhams_coupling_turns_both_shafts_alike() -> None:
    """Shafts 20 mm apart; the middle of the disc runs twice round its circle of 20 mm for one turn."""
    links = (
        link(1, O2=(0, 0), O4=(20, 0)),
        link(2, O2=(0, 0), P=(30, 0)),
        link(3, M=(0, 0)),
        link(4, O4=(0, 0), Q=(30, 0)),
    )
    sliders = (Slider(link=3, on=2), Slider(link=4, on=3, angle_deg=90.0))
    design = Design("Oldham", None, (Drive(None, Linkage(links, sliders, Driver(2)), None, LinkageLoads()),))
    assert faults(design) == []
    study = Study(design, 360)
    bodies, theta = study.linkage.bodies, study.theta
    turned = bodies["link4"].angle - bodies["link2"].angle
    assert np.ptp(turned[0]) < 1e-12
    assert np.abs(turned[1:]).max() < 1e-11
    middle = bodies["link3"].position("M")
    assert np.abs(middle - 10e-3 * (1.0 + np.exp(2j * theta))).max() < 1e-12 * 0.02


def test_jansens_leg_goes_where_its_circles_meet() -> None:
    b, c, d, e, f, g, h, i, j, k, m = 41.5, 39.3, 40.1, 55.8, 39.4, 36.7, 65.7, 49.0, 50.0, 61.9, 15.0
    pivot = -38.0 - 7.8j
    upper = complex(meet(np.array([0j]), d, np.array([b + 0j]), e, 1.0)[0])  # D of the triangle P B D, in its own frame
    lower = complex(meet(np.array([0j]), i, np.array([g + 0j]), h, 1.0)[0])  # F of the triangle C E F
    theta = np.deg2rad(np.arange(360.0))
    crank = m * np.exp(1j * theta)
    at_b = meet(np.full(360, pivot), b, crank, j, 1.0)
    at_c = meet(np.full(360, pivot), c, crank, k, -1.0)
    at_d = pivot + upper * (at_b - pivot) / b
    at_e = meet(at_d, f, at_c, g, -1.0)
    foot = at_c + lower * (at_e - at_c) / g
    links = (
        link(1, O=(0, 0), P=(-38.0, -7.8)),
        link(2, O=(0, 0), A=(m, 0)),
        link(3, A=(0, 0), B=(j, 0)),
        link(4, P=(0, 0), B=(b, 0), D=(upper.real, upper.imag)),
        link(5, A=(0, 0), C=(k, 0)),
        link(6, P=(0, 0), C=(c, 0)),
        link(7, D=(0, 0), E=(f, 0)),
        link(8, C=(0, 0), E=(g, 0), F=(lower.real, lower.imag)),
    )
    points = {"B": at_b[40], "C": at_c[40], "D": at_d[40], "E": at_e[40]}
    drawn = Drawn(40.0, None, tuple(LinkPoint(name, round(z.real), round(z.imag)) for name, z in points.items()))
    design = Design("Jansen", None, (Drive(None, Linkage(links, (), Driver(2), (), drawn), None, LinkageLoads()),))
    assert faults(design) == []
    study = Study(design, 360)
    assert not study.swings
    for name, wanted in (("B", at_b), ("C", at_c), ("D", at_d), ("E", at_e), ("F", foot)):
        found = study.linkage.bodies[study.linkage.body_of(name)].position(name) * 1e3
        assert np.abs(found - wanted).max() < 1e-12 * 150.0, name
    step = foot[foot.imag < foot.imag.min() + 3.0]
    assert foot.imag.min() < -80.0  # it walks below the crank,
    assert np.ptp(step.real) > 40.0  # in steps that are flat
