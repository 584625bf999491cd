"""core.instant_centres: velocity differences V_P = V_A + V_PA and their polygon, against closed forms and random linkages;
directed distances that tell velocity ratios."""

import cmath
import math

import numpy as np
import pytest
from assembled import cases
from linkages import KINDS, four_bar, link, slider_crank
from mechanisms import LIFT

from core.design import Design, Drive, Driver, Linkage, LinkageLoads, Slider
from core.instant_centres import POLE, PolygonTriangle, all_centres, ratio_arms, velocity_differences, velocity_polygon
from core.instant_centres.velocities import link_by_link, to_driver
from core.mechanism import driver_ranges_of, unit_speed_kinematics
from core.mechanism.kinematics import Kinematics
from core.study import Study

INVERTED = Design(
    "inverted",
    None,
    (
        Drive(
            None,
            Linkage(
                (
                    link(1, O2=(0, 0), O4=(0, -90)),
                    link(2, O2=(0, 0), A=(40, 0)),
                    link(3, A=(0, 0)),
                    link(4, O4=(0, 0), B=(160, 0)),
                ),
                (Slider(link=3, on=4),),
                Driver(2),
            ),
            None,
            LinkageLoads(),
        ),
    ),
)


def moving(design: Design, *angles: float) -> Kinematics:
    """At unit speed of the driver."""
    return unit_speed_kinematics(design.drive.mechanism, np.array(angles), driver_ranges_of(design.drive.mechanism))


def triangles(kinematics: Kinematics) -> dict[tuple[str, str, str], PolygonTriangle]:
    return {(d.body, d.a, d.p): d for d in velocity_differences(kinematics)}


@pytest.mark.parametrize("kind", KINDS)
def test_every_triangle_closes(kind: str) -> None:
    """V_A and V_P are those of the poses, V_PA that of the turning or of the guide alone."""
    for case in cases(kind):
        kinematics = case.kinematics
        rows = list(velocity_differences(kinematics))
        sliding = [d for d in rows if d.kind == "sliding"]
        assert len(sliding) == len(case.design.drive.mechanism.sliders)
        points = [
            len(body.points) - sum(p.isdecimal() for p in body.points)
            for n, body in kinematics.bodies.items()
            if n != "frame"
        ]
        assert len(rows) - len(sliding) == sum(n * (n - 1) // 2 for n in points)
        for d in rows:
            size = (
                float(np.abs(d.v_a[0]))
                + float(np.abs(d.v_p[0]))
                + 0.1 * (1.0 + float(np.abs(kinematics.bodies[d.body].angle[1, 0])))
            )
            assert d.gap[0] <= 1e-13 * size
            across = (d.v_pa * (d.at_p - d.at_a).conjugate()).real
            assert np.abs(across).max() <= 1e-13 * size, "across the line between them"


def test_the_four_bars_triangles() -> None:
    """V_A = iω r; V_B across the rocker, V_BA across the coupler: two unknown lengths from one complex equation."""
    kinematics = moving(four_bar(100.0, 30.0, 90.0, 70.0), 0.7, 2.0)
    rows = triangles(kinematics)
    assert set(rows) == {("link2", "O2", "A"), ("link3", "A", "B"), ("link4", "O4", "B")}
    for i, q in enumerate((0.7, 2.0)):
        a, b = 0.03 * cmath.exp(1j * q), complex(kinematics.bodies["link3"].point("B")[0, i])
        v_a, rocker, coupler = 1j * a, b - 0.1, b - a
        # V_A + iω3 (B - A) = iω4 (B - O4)
        w3, w4 = np.linalg.solve(
            [[(1j * coupler).real, -(1j * rocker).real], [(1j * coupler).imag, -(1j * rocker).imag]],
            [-v_a.real, -v_a.imag],
        )
        d = rows["link3", "A", "B"]
        assert complex(d.v_a[i]) == pytest.approx(v_a, abs=1e-16)
        assert complex(d.v_pa[i]) == pytest.approx(1j * w3 * coupler, abs=1e-15)
        assert complex(d.v_p[i]) == pytest.approx(1j * w4 * rocker, abs=1e-15)


@pytest.mark.parametrize("q", [0.4, 1.9, 4.4])
def test_the_slider_cranks_polygon(q: float) -> None:
    """v_B = -r sin θ - (r sin θ - e) r cos θ / √(l² - (r sin θ - e)²), all of it along the guide."""
    r, rod, e = 0.04, 0.14, 0.012
    kinematics = moving(slider_crank(40.0, 140.0, 12.0), q)
    drop = r * math.sin(q) - e
    v = -r * math.sin(q) - drop * r * math.cos(q) / math.sqrt(rod * rod - drop * drop)
    rows = triangles(kinematics)
    assert complex(rows["link4", "B", "B"].v_pa[0]) == pytest.approx(v, abs=1e-16)
    assert abs(rows["link4", "B", "B"].v_a[0]) == 0.0, "the guide stands still"
    polygon = velocity_polygon(kinematics)
    assert set(polygon.corners) == {("A", ""), ("B", "")}
    assert [(s.kind, s.start, s.end) for s in polygon.sides] == [
        ("absolute", POLE, ("A", "")),
        ("absolute", POLE, ("B", "")),
        ("turning", ("A", ""), ("B", "")),
    ]
    assert complex(polygon.sides[2].vector[0]) == pytest.approx(v - 1j * r * cmath.exp(1j * q), abs=1e-16)


@pytest.mark.parametrize("q", [0.4, 1.9, 4.4])
def test_a_block_on_a_turning_arm_slides_along_it(q: float) -> None:
    """Quick return: of V_A the arm has what is across it, and the block slides with the rest."""
    kinematics = moving(INVERTED, q)
    arm = 0.04 * cmath.exp(1j * q) + 0.09j
    v_a, along = 0.04j * cmath.exp(1j * q), arm / abs(arm)
    slide = (v_a * along.conjugate()).real
    (d,) = [d for d in velocity_differences(kinematics) if d.kind == "sliding"]
    assert (d.body, d.on, d.a, d.p) == ("link3", "link4", "A", "A")
    assert complex(d.v_p[0]) == pytest.approx(v_a, abs=1e-16)
    assert complex(d.v_pa[0]) == pytest.approx(slide * along, abs=1e-16)
    assert complex(d.v_a[0]) == pytest.approx(v_a - slide * along, abs=1e-16)
    polygon = velocity_polygon(kinematics)
    assert set(polygon.corners) == {("A", ""), ("B", ""), ("A", "link4")}
    assert ("sliding", ("A", "link4"), ("A", "")) in [(s.kind, s.start, s.end) for s in polygon.sides]


@pytest.mark.parametrize("kind", KINDS)
def test_the_polygon_is_one_picture_from_one_pole(kind: str) -> None:
    """Each vector leads from corner to corner; the image of a body is the body turned by a right angle, ω times its size."""
    for case in cases(kind):
        kinematics = case.kinematics
        polygon = velocity_polygon(kinematics)
        place = {POLE: np.zeros(1), **polygon.corners}
        size = float(polygon.longest.max()) + 0.1
        for side in polygon.sides:
            assert np.abs(place[side.start] + side.vector - place[side.end]).max() <= 1e-13 * size * (
                1.0 + float(np.abs(kinematics.bodies[side.body].angle[1]).max())
            )
        for name, corners in polygon.images.items():
            body = kinematics.bodies[name]
            own = [p for p in body.points if not p.isdecimal()]
            for one, other in ((0, 1), (1, 2)):
                between = 1j * body.angle[1] * (body.point(own[other])[0] - body.point(own[one])[0])
                assert np.abs(place[corners[other]] - place[corners[one]] - between).max() <= 1e-12 * size * (
                    1.0 + float(np.abs(body.angle[1]).max())
                )


def test_a_cams_follower_has_its_polygon_too() -> None:
    """Any mechanism: the lift's rod and arm, its slider on the guide."""
    rows = list(velocity_differences(Study(LIFT, 24).linkage))
    assert {d.kind for d in rows} == {"turning", "sliding"}
    for d in rows:
        assert d.gap.max() <= 1e-14
    assert max(float(np.abs(d.v_p).max()) for d in rows) > 0.05


# -- velocity ratios by distances -------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_directed_distances_give_the_ratio(kind: str) -> None:
    """Each way of comparing bodies reaches every one of them; distances are those between the centres."""
    for case in cases(kind):
        kinematics = case.kinematics
        table = case.table
        bodies = {name for name in kinematics.bodies if name not in ("frame", "link2")}
        for rows in (to_driver(table, "link2"), link_by_link(table, "link2")):
            assert {body for body, _ in rows} == bodies
            for body, base in rows:
                arms = ratio_arms(table, body, base)
                one, other = kinematics.bodies[body].angle[1, 0], kinematics.bodies[base].angle[1, 0]
                if not (np.isfinite(arms.base_arm[0]) and np.isfinite(arms.body_arm[0])) or arms.body_arm[0] == 0.0:
                    continue
                at = {key: table.centres[key].finite[0] for key in (arms.base_key, arms.body_key, arms.common_key)}
                assert arms.base_arm[0] == pytest.approx(
                    abs(at[arms.common_key] - at[arms.base_key]), rel=1e-6, abs=1e-12
                )
                assert abs(arms.body_arm[0]) == pytest.approx(
                    abs(at[arms.common_key] - at[arms.body_key]), rel=1e-6, abs=1e-12
                )
                assert arms.base_arm[0] * other == pytest.approx(
                    arms.body_arm[0] * one, rel=1e-8, abs=1e-9 * (1.0 + abs(arms.base_arm[0] * other))
                )


def test_a_sliders_velocity_is_a_distance_times_the_cranks() -> None:
    """v4 = (I12 I24) ω2: the lecture's p. 10."""
    kinematics = moving(slider_crank(40.0, 140.0), 1.0)
    arms = ratio_arms(all_centres(kinematics, 0.1), "link4", "link2")
    assert arms.body_arm[0] == math.inf
    assert arms.ratio[0] == 0.0
    assert arms.base_arm[0] == pytest.approx(abs(kinematics.bodies["link4"].point("B")[1, 0]), rel=1e-14)


def test_a_coupler_that_does_not_turn_has_an_infinite_arm() -> None:
    """A parallelogram's, by rounding never quite at infinity."""
    kinematics = moving(four_bar(100.0, 40.0, 100.0, 40.0), 0.3, 0.9, 2.1, 4.0)
    arms = ratio_arms(all_centres(kinematics, 0.1), "link3", "link2")
    assert np.isinf(arms.body_arm).all()
    assert arms.base_arm == pytest.approx(0.04, rel=1e-12)
    assert np.abs(arms.ratio).max() < 1e-12
