"""Keeping contact: the speed of lift-off, and the spring that keeps a force up to a speed, against closed forms and dense scans."""

import json
import math
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from mechanisms import with_loads
from sampled import spread, stressed

from core.__main__ import main
from core.design import Design, edited, get
from core.dynamics import contact_map
from core.errors import KindynaError
from core.find import find
from core.project import from_table, load
from core.study import Study, extremes_of, findings_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
RPM = math.pi / 30.0
FORCE, SPEED = "loads.least_contact_force_n", "shaft.speed_rpm"


def harmonic(rate: float, preload: float) -> Design:
    """A centred follower of 2 kg that swings by 10 (1 - cos θ) mm, without weight: s and s'' in closed form."""
    design = load(EXAMPLES / "kim_1990.toml")
    return with_loads(
        design, follower_mass_kg=2.0, spring_rate_n_per_mm=rate, preload_n=preload, friction=0.0, gravity_m_s2=0.0
    )


def least_by_scan(design: Design, rpm: float, angles: int = 3600, speeds: int = 13) -> float:
    """The least contact force [N] of a design at many angles and speeds up to one."""
    theta = np.arange(angles) * 2.0 * math.pi / angles
    least = math.inf
    for speed in np.linspace(rpm / 1e6, rpm, speeds):
        least = min(least, float(Study(edited(design, SPEED, float(speed))).at_theta(theta).dynamics.contact.min()))
    return least


def test_lift_off_speed_of_a_harmonic_follower_in_closed_form() -> None:
    """Kim1990's cam, s = (h/2)(1 - cos 2θ) over half a turn: ω² = (F + k s)/(-m s'') is least at the top, where s'' = -2h."""
    design = harmonic(15.0, 20.0)
    h = extremes_of(Study(design), "motion", ("displacement",))["displacement"].high.value
    omega = math.sqrt((20.0 + 15e3 * h) / (2.0 * 2.0 * h))
    found = Study(design).lift_off
    assert found is not None
    assert found.omega == pytest.approx(omega, rel=1e-12)
    assert math.degrees(found.theta) == pytest.approx(90.0, abs=1e-5)
    for factor, leaves in ((1.0 - 1e-9, False), (1.0 + 1e-9, True)):
        findings = findings_of(Study(edited(design, SPEED, factor * omega / RPM)), ("dynamics",))
        told = [f for f in findings if f.code == "separation"]
        assert bool(told) == leaves
        for f in told:
            assert f.values["speed_rpm"] == pytest.approx(omega / RPM, rel=1e-9)
            assert f"at {omega / RPM:.4g} rpm and above" in f.message


@pytest.mark.parametrize("name", spread(["rocker_cam", "tappet_flat", "transfer_lift"], 1))
def test_at_the_speed_of_lift_off_the_least_force_is_the_one_that_was_to_be_kept(name: str) -> None:
    design = load(EXAMPLES / f"{name}.toml")
    solution = find(design, "lift-off-speed", {f"{FORCE}_min": 5.0})
    rpm = solution.answer[SPEED]
    force = extremes_of(Study(edited(design, SPEED, rpm)), "dynamics", ("contact_force",))["contact_force"].low.value
    size = extremes_of(Study(design), "dynamics", ("contact_force",))["contact_force"].high.value
    assert force == pytest.approx(5.0, abs=1e-9 * size)
    assert least_by_scan(design, rpm, 1200, 9) >= 5.0 - 1e-9 * size
    assert solution.reached[FORCE] == pytest.approx(5.0, abs=1e-9 * size)
    x, y = (np.array(part) for part in zip(*solution.curve, strict=True))
    assert x[np.flatnonzero(y < 5.0 - 1e-9 * size)[0] - 1] == pytest.approx(rpm), (
        "the curve passes the limit at the answer"
    )


@pytest.mark.parametrize(("name", "rpm"), [stressed("rocker_flat", 1500.0), ("tappet_knife", 2000.0)])
@pytest.mark.parametrize("what", ["preload", "spring"])
def test_the_spring_found_keeps_the_force_at_every_angle_and_speed(name: str, rpm: float, what: str) -> None:
    design = load(EXAMPLES / f"{name}.toml")
    stated = {f"{FORCE}_min": 2.0, f"{SPEED}_max": rpm}
    solution = find(design, what, stated)
    assert solution.is_valid
    ((path, value),) = solution.answer.items()
    dense = least_by_scan(solution.design, rpm)
    assert 2.0 - 1e-9 * value <= dense <= 2.0 + 0.02, "kept, and no more than it takes"
    assert get(solution.design, path) == value
    less = edited(solution.design, path, value * (1.0 - 1e-6))
    contact = Study(edited(less, SPEED, rpm)).contact_force
    assert contact.least(rpm * RPM).value < 2.0
    # the other of the two, with the answer in place, is the one that is there
    other = {"preload": "spring", "spring": "preload"}[what]
    back = find(solution.design, other, stated)
    ((path, again),) = back.answer.items()
    assert again == pytest.approx(get(design, path), rel=1e-6)


@pytest.mark.parametrize("rubs", spread([False, True], 1))
def test_dampers_process_forces_and_friction_of_pins_count(rubs: bool) -> None:
    table = tomllib.loads((EXAMPLES / "rocker_cam.toml").read_text(encoding="utf-8"))
    table["loads"]["torsion_springs"] = [
        {"link": 2, "on": 1, "rate_nm_per_rad": 6.0, "free_angle_deg": 162.0, "damping_nm_s_per_rad": 0.3}
    ]
    table["loads"]["process"] = [{"torque_nm": -4.0, "cam_from_deg": 200.0, "cam_to_deg": 260.0}]
    if rubs:
        table["loads"]["pair_friction"] = [{"pair": "pivot", "radius_mm": 8.0, "coefficient": 0.1}]
    design = from_table(table)
    found = Study(design).lift_off
    assert found is not None
    there = Study(edited(design, SPEED, found.omega / RPM))
    assert extremes_of(there, "dynamics", ("contact_force",))["contact_force"].low.value == pytest.approx(0.0, abs=1e-9)
    solution = find(design, "preload", {f"{FORCE}_min": 5.0, f"{SPEED}_max": 1500.0})
    assert 5.0 - 1e-6 <= least_by_scan(solution.design, 1500.0, 1800, 7) <= 5.05


def test_the_worst_speed_may_be_standstill() -> None:
    """A follower that hangs on its spring is pressed least where it stands, in a dwell at any speed."""
    design = with_loads(load(EXAMPLES / "card_picker.toml"), gravity_angle_deg=90.0)
    solution = find(design, "preload", {f"{FORCE}_min": 3.0, f"{SPEED}_max": 60.0})
    assert solution.answer["loads.preload_n"] == pytest.approx(
        3.0 + design.drive.loads.follower_mass_kg * 9.80665, rel=1e-9
    )


def test_what_cannot_be_kept_is_refused_with_what_stands_against_it() -> None:
    design = load(EXAMPLES / "card_picker.toml")
    solution = find(design, "preload", {f"{FORCE}_min": 5.0, f"{SPEED}_max": 900.0, "loads.preload_n_max": 100.0})
    assert not solution.is_valid
    assert solution.answer["loads.preload_n"] == 100.0
    needed = find(design, "preload", {f"{FORCE}_min": 5.0, f"{SPEED}_max": 900.0}).answer["loads.preload_n"]
    assert f"it requires loads.preload_n = {needed:.9g}" in solution.violations[0]
    solution = find(design, "spring", {f"{FORCE}_min": 500.0, f"{SPEED}_max": 60.0})
    assert not solution.is_valid
    assert "where the motion is 0" in solution.violations[0]
    assert solution.answer == {"loads.spring_rate_n_per_mm": design.drive.loads.spring_rate_n_per_mm}, (
        "none is better than the present one"
    )
    weak = with_loads(design, gravity_angle_deg=90.0, preload_n=0.0)
    with pytest.raises(KindynaError, match=r"at 0 deg and 0 rpm, limit 0 N.*find preload"):
        find(weak, "lift-off-speed", {})
    for name, what, message in (
        ("groove", "preload", "holds the follower from both sides"),
        ("transfer_lift", "preload", "no loads.preload_n"),
        ("cam_slider_linkage", "lift-off-speed", "nothing presses"),
        ("four_bar", "spring", "has no cam"),
    ):
        with pytest.raises(KindynaError, match=message):
            find(load(EXAMPLES / f"{name}.toml"), what, {})
    with pytest.raises(KindynaError, match="none of that name"):
        find(design, "lift-off-speed", {f"{SPEED}_max": 60.0})
    with pytest.raises(KindynaError, match=r"outside its range; allowed: >= 0 N"):
        find(design, "spring", {f"{FORCE}_min": -1.0})


@pytest.mark.stress
def test_where_a_rate_serves_nothing_the_angle_is_one_where_it_adds_nothing() -> None:
    """With friction too: what stands against it is the force that stays however stiff the spring is, and not that of the present one."""
    table = tomllib.loads((EXAMPLES / "rocker_cam.toml").read_text(encoding="utf-8"))
    table["loads"]["pair_friction"] = [{"pair": "pivot", "radius_mm": 8.0, "coefficient": 0.1}]
    design = from_table(table)
    against = find(design, "spring", {f"{FORCE}_min": 400.0, f"{SPEED}_max": 1500.0}).violations[0]
    found = re.match(
        r"contact force (\S+) N at (\S+) deg, limit 400 N: the spring's rate adds nothing where the motion is 0",
        against,
    )
    assert found is not None, against
    there = Study(edited(design, SPEED, 1500.0)).at_theta(np.radians([float(found[2])]))
    assert there.motion.displacement[0] == pytest.approx(0.0, abs=1e-6)
    assert there.dynamics.contact == pytest.approx(float(found[1]), rel=0.02)


def test_a_curve_goes_through_an_answer_that_a_limit_holds_and_no_other() -> None:
    design = load(EXAMPLES / "rocker_cam.toml")
    idle = find(design, "spring", {f"{FORCE}_min": 0.0, "loads.spring_rate_nm_per_rad_min": 0.0})
    assert idle.end
    assert idle.answer == {"loads.spring_rate_nm_per_rad": 0.0}
    preloads = [y for _, y in idle.curve]
    assert preloads == sorted(preloads, reverse=True)
    assert preloads[0] < 12.0, "less than the present preload, which is more than it takes"
    bound = find(design, "preload", {f"{FORCE}_min": 200.0})
    assert (bound.answer["loads.preload_nm"], 40.0) in bound.curve


def test_the_design_states_the_force_that_must_be_kept(tmp_path: Path) -> None:
    design = with_loads(load(EXAMPLES / "card_picker.toml"), least_contact_force_n=31.0)
    (low,) = [f for f in findings_of(Study(design), ("dynamics",)) if f.code == "contact-force-low"]
    assert (low.severity, low.field) == ("warning", FORCE)
    assert "limit" not in low.message
    assert "at least 31 N" in low.message
    solution = find(design, "preload", {})
    assert dict(solution.limits) == {FORCE: 31.0}
    assert not [f for f in findings_of(Study(solution.design), ("dynamics",)) if f.code == "contact-force-low"]


@pytest.mark.stress
def test_the_command_prints_the_answer(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = str(EXAMPLES / "rocker_cam.toml")
    assert main(["find", file, "lift-off-speed", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    found = Study(load(file)).lift_off
    assert found is not None
    assert data["answer"] == {SPEED: pytest.approx(found.omega / RPM, rel=1e-9)}
    for name in ("card_picker", "kim_1990", "rocker_flat"):
        for what in ("preload", "lift-off-speed"):  # at the very limit, whatever rounding makes of it
            assert main(["find", str(EXAMPLES / f"{name}.toml"), what]) == 0
    limits = ("--limit", "shaft.speed_rpm_max=1500", "--limit", f"{FORCE}_min=0")
    assert main(["find", file, "preload", *limits, "--into", str(tmp_path / "held.toml")]) == 0
    made = load(tmp_path / "held.toml")
    assert Study(edited(made, SPEED, 1500.0)).contact_force.least_at_speed(1500.0 * RPM).value == pytest.approx(
        0.0, abs=1e-6
    )


def test_the_map_has_the_force_of_every_speed_and_its_zero_line() -> None:
    theta = np.linspace(0.0, 2.0 * math.pi, 90, endpoint=False)
    for name, rpm, near in (
        ("rocker_cam", 2000.0, 1e-9),
        ("tappet_knife", 2000.0, 1e-2),
    ):  # a guide that rubs: between the speeds
        design = load(EXAMPLES / f"{name}.toml")
        found = contact_map(Study(design).contact_force, theta, np.linspace(0.05, 1.0, 21) * rpm * RPM)
        row = Study(edited(design, SPEED, float(found.omega[7] / RPM))).at_theta(theta).dynamics.contact
        assert found.force[7] == pytest.approx(row, rel=1e-9, abs=1e-9 * np.abs(found.force).max())
        lost = np.flatnonzero(np.isfinite(found.zero[0]) & (found.zero[0] < found.omega[-1]))
        assert lost.size > 5
        for i in lost[:: lost.size // 4]:
            at = (
                Study(edited(design, SPEED, float(found.zero[0, i] / RPM)))
                .at_theta(theta[i : i + 1])
                .dynamics.contact[0]
            )
            assert at == pytest.approx(0.0, abs=near * np.abs(found.force[:, i]).max())
        least = Study(design).lift_off
        assert least is not None
        assert np.nanmin(found.zero) >= least.omega * (1.0 - near)


def test_a_spring_that_is_not_needed_is_none_that_nobody_can_make() -> None:
    """Its force grows by a quarter of the preload, 12 N m, over the stroke of 18 deg; the present one may be softer."""
    design, path = load(EXAMPLES / "rocker_cam.toml"), "loads.spring_rate_nm_per_rad"
    softest = 0.25 * 12.0 / math.radians(18.0)
    found = find(design, "spring", {})
    assert found.answer[path] == pytest.approx(softest, rel=1e-9)
    assert "more than 4 strokes" in found.end
    soft = edited(design, path, 0.5 * softest)
    assert find(soft, "spring", {}).answer == {path: 0.5 * softest}
    assert find(soft, "spring", {f"{path}_min": 1.0}).answer == {path: 1.0}
    assert find(load(EXAMPLES / "transfer_lift.toml"), "spring", {}).answer == {"loads.spring_rate_n_per_mm": 0.0}
