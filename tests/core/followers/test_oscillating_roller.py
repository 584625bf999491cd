"""The oscillating roller follower: against circles at fifty digits, a linkage of the same lengths, and a pencil."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from references import EPS, MP

from core.design import Design, Link, Linkage, LinkPoint, Motion, NamedCurve, Roller, Segment, with_drive
from core.design.linkage import Driver, LinkageCam
from core.errors import NoAssembly
from core.project import dumps, load, loads
from core.study import Study, certificate_of

ROCKER = load(Path(__file__).parents[3] / "resources" / "examples" / "rocker_cam.toml")


def lengths(design: Design, **values: object) -> Design:
    return with_drive(design, mechanism=replace(design.drive.follower, **values))  # type: ignore[arg-type]


def turned(design: Design) -> Design:
    return replace(design, shaft=replace(design.camshaft, rotation="cw"))


ALL = {
    "right": ROCKER,
    "left": lengths(ROCKER, side="left"),
    "right, clockwise": turned(ROCKER),
    "left, clockwise": turned(lengths(ROCKER, side="left")),
    "far pivot": lengths(ROCKER, pivot_x_mm=-4000.0, pivot_y_mm=900.0, arm_mm=4080.0),
}


def direction(design: Design) -> tuple[object, object, int]:
    """α0, the angle from which the arm swings, at fifty digits; the pivot [m]; the sense of its swing."""
    f, cam = design.drive.follower, design.drive.cam
    pivot = MP.mpc(f.pivot_x_mm, f.pivot_y_mm) / 1000
    arm, reach = MP.mpf(f.arm_mm) / 1000, MP.mpf(cam.base_radius_mm + cam.roller_radius_mm) / 1000
    cosine = (arm**2 + abs(pivot) ** 2 - reach**2) / (2 * arm * abs(pivot))
    sense = 1 if f.side == "left" else -1
    return MP.arg(-pivot) + sense * MP.acos(cosine), pivot, sense


@pytest.mark.parametrize("name", ALL)
def test_the_roller_swings_about_its_pivot(name: str) -> None:
    """R = P + Zl e^{iα} with its derivatives; motion > 0 turns the arm away from the cam centre."""
    design = ALL[name]
    study = Study(design, 48)
    alpha0, pivot, sense = direction(design)
    arm, size = design.drive.follower.arm_mm * 1e-3, abs(complex(pivot))
    for i in range(0, 48, 5):
        y, v, a = (MP.mpf(float(row[i])) for row in study.motion.y[:3])
        e = MP.mpf(arm) * MP.expj(alpha0 + sense * y)
        exact = (pivot + e, 1j * sense * v * e, (1j * sense * a - v * v) * e)
        for row, wanted in zip(study.linkage.follower.z[:3, i], exact, strict=True):
            assert abs(complex(row) - complex(wanted)) <= 64 * EPS * (size + abs(complex(wanted)))
    distance = np.abs(study.linkage.follower.z[0])
    assert distance.argmax() in range(23, 31), "farthest from the cam centre while the motion dwells at its top"
    base = (design.drive.cam.base_radius_mm + design.drive.cam.roller_radius_mm) * 1e-3
    assert distance[0] == pytest.approx(base, rel=1e-12)


@pytest.mark.parametrize("name", ALL)
def test_a_linkage_of_one_link_has_the_same_cam_and_forces(name: str) -> None:
    """The arm laid out link by link, its motion counted from the frame's x axis."""
    design = ALL[name]
    f, cam = design.drive.follower, design.drive.cam
    alpha0, _, sense = direction(design)
    motion = design.drive.motion
    assert motion is not None
    start = math.degrees(float(alpha0)) + sense * motion.start
    segments = tuple(replace(s, rise=sense * s.rise) for s in motion.segments)
    links = (
        Link(1, (LinkPoint("P", f.pivot_x_mm, f.pivot_y_mm),)),
        Link(2, (LinkPoint("P", 0.0, 0.0), LinkPoint("R", f.arm_mm, 0.0))),
    )
    driver = Driver(2, "motion", design.camshaft.signed_rpm)
    plain = with_drive(
        design,
        mechanism=Linkage(links, (), driver),
        motion=Motion(start, segments, "deg"),
        cam=LinkageCam(link=2, point="R", face=Roller(cam.roller_radius_mm)),
    )
    from core.design import LinkageLoads

    plain = with_drive(plain, loads=LinkageLoads())
    ours, theirs = Study(design, 180), Study(plain, 180)
    size = np.abs(theirs.cam.flank.profile).max()
    assert np.abs(ours.cam.flank.profile - theirs.cam.flank.profile).max() <= 1e-12 * size
    assert np.abs(ours.cam.flank.pressure_angle - theirs.cam.flank.pressure_angle).max() <= 1e-10
    bend = np.abs(theirs.cam.flank.pitch_curvature)
    assert np.abs(ours.cam.flank.pitch_curvature - theirs.cam.flank.pitch_curvature).max() <= 1e-10 * bend.max()


@pytest.mark.parametrize("name", ALL)
def test_every_residual_is_kept(name: str) -> None:
    for residual in certificate_of(Study(ALL[name], 360)).values():
        assert residual.kept


@pytest.mark.parametrize("name", ALL)
def test_the_torque_is_what_energies_and_spring_ask_for(name: str) -> None:
    """T_c = d/dθ(½ J ω² + V), J the arm's about its pivot, V of the spring and of the weight; differentiated by hand."""
    design = ALL[name]
    loads_, f = design.drive.loads, design.drive.follower
    study = Study(design, 360)
    alpha0, _, sense = direction(design)
    y, v, a = study.motion.y[:3]
    arm, centre = f.arm_mm * 1e-3, loads_.arm_centre_mm * 1e-3
    inertia = (
        loads_.arm_inertia_kg_m2
        + loads_.arm_mass_kg * centre**2
        + loads_.roller_inertia_kg_m2
        + loads_.roller_mass_kg * arm**2
    )
    alpha = float(alpha0) + sense * y
    weight = loads_.gravity_m_s2 * (loads_.arm_mass_kg * centre + loads_.roller_mass_kg * arm) * np.cos(alpha) * sense
    spring = loads_.preload_nm + loads_.spring_rate_nm_per_rad * y
    expected = v * (inertia * study.omega**2 * a + weight + spring)
    assert np.abs(study.dynamics.torque - expected).max() <= 1e-11 * np.abs(expected).max()


def test_an_arm_that_does_not_reach_the_base_circle_is_named_with_what_would() -> None:
    with pytest.raises(NoAssembly, match=r"follower\.arm_mm: .* make the arm 42\.6.* \.\.\. 156\.6.* mm long"):
        _ = Study(lengths(ROCKER, arm_mm=20.0)).linkage


def test_it_is_written_and_read_as_it_is() -> None:
    assert loads(dumps(ROCKER)) == ROCKER
    assert [
        s.law for s in (segment.curve for segment in ROCKER.drive.motion.segments) if isinstance(s, NamedCurve)
    ] == [
        "dwell",
        "modified-sine",
        "dwell",
        "modified-sine",
    ]
    assert all(isinstance(s, Segment) for s in ROCKER.drive.motion.segments)
