"""Laws of least torque, contact force or motor torque in their design: closed forms, starts, neighbours, files, bad input."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mechanisms import with_loads

from core.__main__ import main
from core.design import (
    ComputedCurve,
    Design,
    OptimalCurve,
    SplinePoint,
    Tolerance,
    edited,
    faults,
    merged,
    only,
    require_motion,
    with_motion,
)
from core.errors import DesignError
from core.laws import Piece
from core.project import dumps, load, loads
from core.study import Study, certificate_of, law_in_machine, many
from core.varying.tolerances import Scatter, tolerance_study

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
PATH = "motion.segments[1]"
KINEMATIC = ("acceleration", "jerk", "velocity", "rms_acceleration", "rms_jerk")


def optimal(design: Design, minimise: str, **settings: Any) -> Design:
    design = edited(edited(design, f"{PATH}.law", "optimal"), f"{PATH}.minimise", minimise)
    settings = {"intervals": 20, **settings}
    for name, value in settings.items():
        design = edited(design, f"{PATH}.{name.replace('__', '.')}", value)
    return design


def in_segment(design: Design, segment: int = 1) -> Study:
    """Study at 20,001 angles of the segment."""
    spans = [s.span_deg for s in require_motion(design).segments]
    begin = sum(spans[:segment])
    u = np.linspace(1e-9, 1.0 - 1e-9, 20001)
    return Study(design).at_theta(np.deg2rad(begin + u * spans[segment]))


def peak(design: Design, aim: str) -> float:
    forces = in_segment(design).dynamics
    return float(np.abs(forces.torque if aim == "torque" else forces.contact).max())


def inertia_alone() -> Design:
    """A mass in a groove, without friction and weight: T = m ω² y' y''."""
    loads_ = {"friction": 0.0, "gravity_m_s2": 0.0, "follower_mass_kg": 8.0}
    return with_loads(load(EXAMPLES / "groove.toml"), **loads_)


# -- closed forms -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("intervals", [20, 40, pytest.param(120, marks=pytest.mark.stress)])
def test_least_torque_of_an_inertia_approaches_its_closed_form_from_above(intervals: int) -> None:
    """With ẏ ÿ = ±c the kinetic energy is linear: ẏ = √(2cu) up to the middle, c = 9/4."""
    design = optimal(inertia_alone(), "torque", intervals=intervals)
    segment = require_motion(design).segments[1]
    omega, beta = 180.0 / 60.0 * 2.0 * math.pi, math.radians(segment.span_deg)
    unit = 8.0 * omega**2 * (segment.rise * 1e-3) ** 2 / beta**3
    assert 2.25 <= peak(design, "torque") / unit <= 2.25 * (1.0 + 1.8 / intervals)


def test_searches_from_several_laws_agree() -> None:
    for design in (inertia_alone(), load(EXAMPLES / "tappet_flat.toml"), load(EXAMPLES / "rocker_cam.toml")):
        segment = require_motion(optimal(design, "torque")).segments[1]
        starts = law_in_machine(segment, whole_turn=False).starts
        assert len(starts) == 5
        ends = np.array([end for _, end in starts])
        assert np.ptp(ends) <= 1e-6 * ends.min()
        assert all(end < 0.9 * begin for begin, end in starts)


def test_least_motor_torque_of_an_inertia_is_the_law_of_least_acceleration() -> None:
    """The servo's torque is proportional to ÿ: the cubic."""
    servo = '[servo]\nkind = "rotary"\ngear_ratio = 5.0\nrotor_inertia_kg_m2 = 0.002\ninertia_kg_m2 = 0.3\n'
    rows = ("dwell", "", 90.0), ("3-4-5", "rise_deg = 30.0\n", 90.0), ("3-4-5", "rise_deg = -30.0\n", 180.0)
    text = 'format = 1\nname = "a"\n[motion]\nstart_deg = 0.0\n' + "".join(
        f'[[motion.segments]]\nlaw = "{law}"\nspan_deg = {span}\n{rise}' for law, rise, span in rows
    )
    design = loads(f'{text}[shaft]\nrotation = "ccw"\nspeed_rpm = 60.0\n{servo}')
    ours, cubic = (in_segment(optimal(design, aim)).motion.y for aim in ("motor_rms", "rms_acceleration"))
    assert np.abs(ours[0] - cubic[0]).max() <= 1e-6 * np.ptp(cubic[0])


# -- never worse, and no neighbour is better --------------------------------------------------------------------


@pytest.mark.parametrize(
    "name",
    [
        "tappet_flat",
        *(pytest.param(name, marks=pytest.mark.stress) for name in ("rocker_cam", "groove", "transfer_lift")),
    ],
)
@pytest.mark.parametrize("aim", ["torque", "contact_force"])
def test_no_optimal_law_of_the_motion_is_better(name: str, aim: str) -> None:
    design = load(EXAMPLES / f"{name}.toml")
    least = peak(optimal(design, aim), aim)
    assert all(least <= peak(optimal(design, other), aim) * (1.0 + 1e-6) for other in KINEMATIC)


@pytest.mark.parametrize("aim", ["torque", "contact_force"])
def test_an_open_cam_still_presses_its_follower(aim: str) -> None:
    for name in ("tappet_flat", "transfer_lift"):
        contact = in_segment(optimal(load(EXAMPLES / f"{name}.toml"), aim)).dynamics.contact
        assert contact.min() >= -1e-4 * contact.max()


@pytest.mark.stress
def test_no_neighbour_with_the_same_limits_is_better() -> None:
    design = optimal(load(EXAMPLES / "tappet_flat.toml"), "torque", limits__velocity=1.7)
    segment, least = require_motion(design).segments[1], peak(design, "torque")
    law = law_in_machine(segment, whole_turn=False)
    chance = np.random.default_rng(3)
    u = np.array([piece.start for piece in law.pieces])
    ends = [*u[1:], 1.0]
    for _ in range(15):
        k, size = int(chance.integers(1, 6)), 10.0 ** chance.uniform(-4.0, -2.0) * chance.choice([-1.0, 1.0])
        # s + size sin²(kπu) in powers of the distance from the start of each piece
        bent = [piece_with(p, size, k, end - p.start) for p, end in zip(law.pieces, ends, strict=True)]
        changed = replace(segment, curve=ComputedCurve(tuple(bent)), rise=segment.rise)
        curve = ComputedCurve(tuple(Piece(p.start, tuple(segment.rise * c for c in p.polynomial)) for p in bent))
        motion = require_motion(design)
        neighbour = with_motion(
            design,
            replace(motion, segments=(motion.segments[0], replace(changed, curve=curve), *motion.segments[2:])),
        )
        study = in_segment(neighbour)
        v = np.abs(study.motion.y[1]).max() * math.radians(segment.span_deg) / (segment.rise * 1e-3)
        if v <= 1.7:
            assert np.abs(study.dynamics.torque).max() >= least * (1.0 - 1e-4)


def piece_with(piece: Piece, size: float, k: int, width: float) -> Piece:
    """A piece with the bump size sin²(kπu) added, as its Taylor polynomial of degree 7."""
    omega = 2.0 * math.pi * k
    bump = [
        0.5 * size * ((1.0 if i == 0 else 0.0) - omega**i * math.cos(omega * piece.start + 0.5 * math.pi * i))
        / math.factorial(i)
        for i in range(8)
    ]  # fmt: skip
    own = [*piece.polynomial, *[0.0] * (8 - len(piece.polynomial))]
    return Piece(piece.start, tuple(a + b for a, b in zip(own, bump, strict=True)))


# -- the design and its law ---------------------------------------------------------------------------------------


def test_limits_obstacles_and_points_are_kept() -> None:
    design = optimal(load(EXAMPLES / "tappet_flat.toml"), "torque", limits__velocity=1.7, limits__acceleration=8.0)
    design = edited(design, f"{PATH}.points", (SplinePoint(50.0, 3.0),))
    study, segment = in_segment(design), require_motion(design).segments[1]
    beta, rise = math.radians(segment.span_deg), segment.rise * 1e-3
    assert np.abs(study.motion.y[1]).max() * beta / rise <= 1.7 * (1.0 + 1e-8)
    assert np.abs(study.motion.y[2]).max() * beta**2 / rise <= 8.0 * (1.0 + 1e-8)
    at = Study(design).at_theta(np.deg2rad(np.array([190.0])))
    assert at.motion.y[0][0] == pytest.approx(3e-3, abs=1e-10)


def test_the_law_follows_the_machine() -> None:
    """Another speed, mass or base radius has another law; the file keeps what was typed."""
    design = optimal(load(EXAMPLES / "rocker_cam.toml"), "torque")
    y = in_segment(design).motion.y[0]
    for path, value in (("shaft.speed_rpm", 900.0), ("loads.arm_inertia_kg_m2", 0.02), ("cam.base_radius_mm", 60.0)):
        changed = edited(design, path, value)
        assert np.abs(in_segment(changed).motion.y[0] - y).max() > 1e-6
        assert peak(changed, "torque") <= peak(with_motion(changed, plain_motion(design)), "torque") * (1.0 + 1e-6)
    text = dumps(design)
    assert loads(text) == design
    assert "machine" not in text
    assert len(text.splitlines()) < len(dumps(load(EXAMPLES / "rocker_cam.toml")).splitlines()) + 12


def plain_motion(design: Design) -> Any:
    """The motion of a design with its present law as fixed pieces."""
    motion = require_motion(design)
    segment = motion.segments[1]
    pieces = (
        Piece(p.start, tuple(segment.rise * c for c in p.polynomial)) for p in law_in_machine(segment, False).pieces
    )
    changed = replace(segment, curve=ComputedCurve(tuple(pieces)))
    return replace(motion, segments=(motion.segments[0], changed, *motion.segments[2:]))


def test_rise_and_return_have_their_own_laws() -> None:
    design = optimal(load(EXAMPLES / "tappet_flat.toml"), "torque")
    alone = peak(design, "torque")
    both = edited(edited(design, "motion.segments[2].law", "optimal"), "motion.segments[2].minimise", "torque")
    assert peak(both, "torque") == pytest.approx(alone, rel=1e-9)
    back = np.abs(in_segment(both, 2).dynamics.torque).max()
    assert back < np.abs(in_segment(design, 2).dynamics.torque).max()


def test_each_drive_of_a_shaft_has_its_law() -> None:
    design = load(EXAMPLES / "transfer_unit.toml")
    index = next(i for i, drive in enumerate(design.drives) if drive.cam is not None and drive.motion is not None)
    motion = require_motion(only(design, index))
    k = next(i for i, s in enumerate(motion.segments) if s.rise)
    path = f"drives[{index}].motion.segments[{k}]"
    both = edited(edited(design, f"{path}.law", "optimal"), f"{path}.minimise", "torque")
    ours, before = (np.abs(Study(only(d, index)).dynamics.torque).max() for d in (both, design))
    assert ours != before
    assert loads(dumps(both)) == both
    assert certificate_of(Study(both), ("motion",))


def test_a_study_of_designs_solves_each_law() -> None:
    design = optimal(load(EXAMPLES / "tappet_flat.toml"), "torque")
    path, torque = "loads.preload_n", "drive_torque_nm:abs"
    values = np.array([120.0, 160.0])
    result = many(design, {path: values}, [torque]).value[torque]
    for value, figure in zip(values.tolist(), result.tolist(), strict=True):
        alone = Study(edited(design, path, value)).dynamics.torque
        assert figure == pytest.approx(np.abs(alone).max(), rel=1e-3)


def test_machines_are_built_with_the_law_of_the_design() -> None:
    """A tolerance does not change the law: the torque of a machine is that of the nominal cam."""
    design = optimal(load(EXAMPLES / "tappet_flat.toml"), "torque")
    design = replace(design, tolerances=(Tolerance("loads.preload_n", 10.0),))
    scatter = Scatter(tolerance_study(design))
    slope = scatter.slopes()[0][scatter.keys.index("drive_torque_nm:abs")]
    fixed = with_motion(replace(design, tolerances=()), plain_motion(design))
    values = [peak_of_turn(edited(fixed, "loads.preload_n", 140.0 + step)) for step in (-0.01, 0.01)]
    assert slope == pytest.approx((values[1] - values[0]) / 0.02, rel=1e-4)
    assert not np.allclose(values[1], peak_of_turn(edited(design, "loads.preload_n", 150.0)), rtol=1e-6)


def peak_of_turn(design: Design) -> float:
    return float(
        many(design, {"shaft.speed_rpm": np.array([1200.0])}, ["drive_torque_nm:abs"]).value["drive_torque_nm:abs"][0]
    )


def test_edits_of_loads_keep_an_incomplete_motion() -> None:
    base = optimal(load(EXAMPLES / "tappet_flat.toml"), "torque")
    mine, theirs = edited(base, f"{PATH}.intervals", 30), edited(base, "loads.preload_n", 200.0)
    both = merged(base, mine, theirs)
    curve = require_motion(both).segments[1].curve
    assert isinstance(curve, OptimalCurve)
    assert (curve.intervals, both.drive.loads.preload_n) == (30, 200.0)


def test_a_machine_without_a_solution_keeps_a_law() -> None:
    """The stage that fails reports it, not the motion."""
    design = optimal(load(EXAMPLES / "rocker_cam.toml"), "torque")
    impossible = edited(design, "follower.arm_mm", 400.0)
    assert np.isfinite(Study(impossible).motion.y[0]).all()


def test_the_certificate_says_that_the_law_is_local() -> None:
    design = optimal(load(EXAMPLES / "tappet_flat.toml"), "torque", intervals=30)
    proof = certificate_of(Study(design), ("motion",))["optimum_gap_2"]
    assert proof.value <= proof.bound == 1e-3
    assert proof.note == "local: best of 5 starts, 30 intervals"


# -- bad input ------------------------------------------------------------------------------------------------------


MOVES = (
    'format = 1\nname = "a"\n[motion]\nstart_mm = 0.0\n'
    '[[motion.segments]]\nlaw = "dwell"\nspan_deg = 160.0\n'
    '[[motion.segments]]\nlaw = "optimal"\nminimise = "AIM"\nspan_deg = 100.0\nrise_mm = 10.0\n'
    '[[motion.segments]]\nlaw = "3-4-5"\nspan_deg = 100.0\nrise_mm = -10.0\n'
)


@pytest.mark.parametrize(
    ("aim", "needs"),
    [("contact_force", "a cam"), ("motor_rms", "[servo]"), ("torque", "a cam, a motion in degrees, or [servo]")],
)
def test_an_effect_that_the_design_lacks(aim: str, needs: str, tmp_path: Path, capsys: Any) -> None:
    (tmp_path / "a.toml").write_text(MOVES.replace("AIM", aim), "utf-8")
    assert main(["check", str(tmp_path / "a.toml")]) == 2
    line = capsys.readouterr().err.splitlines()[0]
    assert line.startswith(
        f"{PATH}.minimise = '{aim}': needs {needs}, which this design does not have; allowed: acceleration |"
    )


def test_limits_that_no_law_keeps_name_the_least_one() -> None:
    design = optimal(load(EXAMPLES / "tappet_flat.toml"), "torque", limits__acceleration=3.0)
    with pytest.raises(
        DesignError, match=r"segments\[1\]\.limits\.acceleration = 3\.0: no law keeps .*>= 4\.0"
    ) as error:
        _ = Study(design).motion
    least = float(error.value.faults[0].allowed.removeprefix(">= "))
    assert np.isfinite(peak(optimal(design, "torque", limits__acceleration=least), "torque"))


# -- every mechanism --------------------------------------------------------------------------------------------


@pytest.mark.stress
@pytest.mark.parametrize("file", sorted(EXAMPLES.glob("*.toml")), ids=lambda file: file.stem)
def test_searches_agree_in_every_example(file: Path) -> None:
    """Each drive with a rise: the law is better than every start, and the searches lead to one optimum."""
    design = load(file)
    for number, drive in enumerate(design.drives):
        if drive.motion is None or drive.motion.is_computed:
            continue
        rises = [i for i, segment in enumerate(drive.motion.segments) if segment.rise]
        for aim in ("torque", "contact_force") if rises else ():
            changed = edited(only(design, number), f"motion.segments[{rises[0]}].law", "optimal")
            changed = edited(
                edited(changed, f"motion.segments[{rises[0]}].minimise", aim),
                f"motion.segments[{rises[0]}].intervals",
                20,
            )
            if faults(changed):
                continue
            segments = require_motion(changed).segments
            law = law_in_machine(segments[rises[0]], len(segments) == 1)
            begins, ends = np.array(law.starts).T
            assert law.value <= (1.0 + 1e-4) * min(begins)
            assert np.ptp(ends) <= 1e-4 * ends.min()
            assert law.value <= (1.0 + 1e-3) * law.least
