"""Valve springs: reference numbers, the wave against finite differences in time, fatigue, findings, and files."""

import csv
import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from valve_trains import FLAT_TAPPET, LOBE_A

from core.__main__ import main
from core.design import Design, Engine, Valve, get, only, put, with_drive
from core.errors import DesignError
from core.find import available_searches, find
from core.project import dumps, load, loads, save
from core.study import Study, extremes_of, findings_of, many
from core.study.quantities import quantities_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
MM = 1e3
INCH, POUND = 25.4, 4.4482216152605
HEAD = (
    'format = 1\nname = "Springs"\n'
    + LOBE_A
    + FLAT_TAPPET
    + """[shaft]
rotation = "ccw"
speed_rpm = {rpm}
[engine]
stroke_mm = 84.0
rod_mm = 138.0
[valve]
centre_deg = 108.0
lash_mm = {lash}
[loads]
follower_mass_kg = 0.14
gravity_m_s2 = 0.0
"""
)
SPRING = """[[loads.valve_springs]]
wire_mm = 3.8
coil_mm = 24.0
active_coils = 5.0
total_coils = 7.0
free_mm = 51.5
installed_mm = 41.0
"""
THIRD = 33.562774e-3 / 3.0


def text(rpm: float = 2500.0, lash: float = 0.0, springs: str = SPRING) -> str:
    return HEAD.format(rpm=rpm, lash=lash) + springs


def design(**how: Any) -> Design:
    return loads(text(**how))


def value(study: Study, name: str) -> np.ndarray:
    return quantities_of(study)[name].value(study)


def codes(design: Design) -> dict[str, str]:
    return {finding.code: finding.field for finding in findings_of(Study(design))}


def card(design: Design, folder: Path, capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    save(design, folder / "train.toml")
    assert main(["valve", str(folder / "train.toml"), "--json"]) == 0
    return json.loads(capsys.readouterr().out)["valves"][0]


# -- figures ----------------------------------------------------------------------------------------------------


def test_the_reference_spring(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    valve = card(put(design(), "loads.valve_springs[0].tensile_mpa", 1900.0), tmp_path, capsys)
    (spring,) = valve["springs"]
    assert spring["rate_n_per_mm"] == pytest.approx(29.9029378, abs=5e-8)
    assert (spring["seat_n"], spring["open_n"]) == pytest.approx((313.9808, 583.1073), abs=1e-4)
    assert spring["stress_mpa"] == pytest.approx([428.246, 795.314], abs=1e-3)
    assert spring["natural_hz"] == pytest.approx(471.952192, abs=1e-6)
    assert spring["bind_mm"] == pytest.approx(41.0 - 9.0 - 7 * 3.8, abs=1e-12)
    sizes = {row["n"]: row["lift_mm"] for row in spring["harmonics"]}
    assert [sizes[n] for n in (1, 5, 8, 10, 12)] == pytest.approx(
        [3.325249, 0.076939, 0.004225, 0.066754, 0.038546], abs=1e-6
    )
    assert list(sizes) == list(range(1, 21))
    assert [row["resonance_rpm"] * row["n"] for row in spring["harmonics"]] == pytest.approx([56634.263] * 20, abs=1e-3)
    assert valve["float_rpm"] == pytest.approx(7830.5049, abs=2e-4)
    # Goodman with Zimmerli's limits of a peened spring, by hand
    low, high, strength = *spring["stress_mpa"], 0.67 * 1900.0
    endurance = 398.0 / (1.0 - 534.0 / strength)
    assert 1.0 / spring["goodman"] == pytest.approx(0.5 * (high - low) / endurance + 0.5 * (high + low) / strength)
    plain = put(put(design(), "loads.valve_springs[0].tensile_mpa", 1900.0), "loads.valve_springs[0].peened", False)
    endurance = 241.0 / (1.0 - 379.0 / strength)
    used = 0.5 * (high - low) / endurance + 0.5 * (high + low) / strength
    assert card(plain, tmp_path, capsys)["springs"][0]["goodman"] == pytest.approx(1.0 / used)
    assert "goodman" not in card(design(), tmp_path, capsys)["springs"][0]


def test_stresses_of_a_printed_example(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Norton, example 14-4: 60 and 105 lb, printed with the factor 1 + 0.5/C of direct shear alone."""
    wire, coil = 0.207 * INCH, 1.863 * INCH
    row = f"[[loads.valve_springs]]\nwire_mm = {wire}\ncoil_mm = {coil}\nactive_coils = 5.0\ntotal_coils = 7.0\nfree_mm = 100.0\n"
    rate = 79.3e3 * wire**4 / (8.0 * coil**3 * 5.0)
    row += f"installed_mm = {100.0 - 60.0 * POUND / rate!r}\n"
    motion = put(design(springs=row), "motion.lobe.lift_mm", 9.0)
    (spring,) = card(motion, tmp_path, capsys)["springs"]
    index = coil / wire
    factor = (4.0 * index + 2.0) / (4.0 * index - 3.0) / (1.0 + 0.5 / index)
    psi = POUND / INCH**2
    assert spring["seat_n"] == pytest.approx(60.0 * POUND)
    assert spring["stress_mpa"][0] / psi / factor == pytest.approx(33_875.0, rel=2e-5)
    assert spring["stress_mpa"][1] / psi / factor * 105.0 * POUND / spring["open_n"] == pytest.approx(
        59_281.0, rel=2e-5
    )


# -- forces -----------------------------------------------------------------------------------------------------


def test_contact_force_has_the_static_spring_and_a_third_of_its_mass() -> None:
    study = Study(design(lash=0.15))
    y, second = study.motion.displacement[0], study.motion.displacement[2]
    is_open = y > 0.15e-3 + 1e-9
    omega = 2500.0 * math.pi / 30.0
    force = 313.9808467881945 + 29902.937789351854 * (y - 0.15e-3) + (0.14 + THIRD) * omega**2 * second
    contact = value(study, "contact_force")
    assert contact[is_open] == pytest.approx(force[is_open], rel=1e-8)
    assert not contact[y < 0.15e-3 - 1e-9].any()


def test_surge_of_the_reference_spring(tmp_path: Path) -> None:
    study = Study(design(), samples=1440)
    force = value(study, "valve_spring_force")
    assert (force.min(), force.max()) == pytest.approx((270.7859, 592.4611), abs=1e-4)
    extremes = extremes_of(study, "dynamics", ("valve_spring_force",))["valve_spring_force"]
    assert (extremes.low.value, extremes.high.value) == pytest.approx((270.7709, 592.4631), abs=1e-4)
    save(design(), tmp_path / "train.toml")
    assert main(["export", str(tmp_path / "train.toml"), "--out", str(tmp_path / "out"), "--samples", "1440"]) == 0
    with (tmp_path / "out" / "dynamics.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["valve_spring_force_n"]) for row in rows] == pytest.approx(force.tolist(), rel=1e-9)


def in_time(
    study: Study, omega: float, cells: int, natural: float, damping: float, turns: int
) -> tuple[np.ndarray, np.ndarray]:
    """Angles and ℓ ∂u/∂x at the moved end, of u_tt + 2ζω₁ u_t = c² u_xx by central differences in time, in the last turn."""
    speed, dx = natural / math.pi, 1.0 / cells  # of a spring of length 1
    dt = dx / speed
    steps = math.ceil(turns * 2.0 * math.pi / omega / dt)
    theta = omega * dt * np.arange(steps + 1)
    y = value(study.at_theta(np.mod(theta, 2.0 * math.pi)), "valve_lift")
    before = now = y[0] * np.linspace(0.0, 1.0, cells + 1)
    drag, slope = natural * damping * dt, np.zeros(steps + 1)
    for i in range(1, steps + 1):
        after = np.empty_like(now)
        after[1:-1] = (2.0 * now[1:-1] - (1.0 - drag) * before[1:-1] + now[2:] - 2.0 * now[1:-1] + now[:-2]) / (
            1.0 + drag
        )
        after[0], after[-1] = 0.0, y[i]
        slope[i] = (1.5 * after[-1] - 2.0 * after[-2] + 0.5 * after[-3]) / dx
        before, now = now, after
    last = theta > theta[-1] - 2.0 * math.pi
    return np.mod(theta[last], 2.0 * math.pi), slope[last]


def test_surge_agrees_with_finite_differences_in_time() -> None:
    study, omega = Study(design()), 2500.0 * math.pi / 30.0
    natural = 2.0 * math.pi * 471.952192
    theta, slope = in_time(study, omega, 160, natural, 0.02, 10)
    force = 313.9808467881945 + 29902.937789351854 * slope
    exact = value(study.at_theta(theta), "valve_spring_force")
    static = 313.9808467881945 + 29902.937789351854 * value(study.at_theta(theta), "valve_lift")
    assert np.abs(exact - static).max() > 30.0
    assert np.abs(force - exact).max() < 0.6  # harmonics above the 100th


def test_at_resonance_the_wave_is_the_harmonic_over_the_damping() -> None:
    """At n ω = ω₁ the amplitude is k c_n/ζ."""
    for n in (10, 12):
        rpm = 56634.263 / n / 2.0
        study = Study(design(rpm=rpm), samples=3600)
        spectrum = 2.0 * np.abs(np.fft.rfft(value(study, "valve_spring_force")) / 3600)
        size = {10: 0.066754, 12: 0.038546}[n]
        assert spectrum[n] == pytest.approx(29902.937789 * 1e-3 * size / 0.02, rel=3e-3)


def test_nested_springs_add_up() -> None:
    inner = SPRING.replace("3.8", "2.8").replace("24.0", "17.0").replace("51.5", "46.0")
    one, two, both = (Study(design(springs=rows)) for rows in (SPRING, inner, SPRING + inner))
    force = value(one, "valve_spring_force") + value(two, "valve_spring_force")
    assert value(both, "valve_spring_force") == pytest.approx(force, rel=1e-12)
    added = value(one, "contact_force") + value(two, "contact_force")
    mass_alone = 0.14 * (2500.0 * math.pi / 30.0) ** 2 * one.motion.displacement[2]
    assert value(both, "contact_force") == pytest.approx(added - mass_alone, rel=1e-9, abs=1e-6)


def test_springs_of_a_pushrod_train_act_on_its_valve() -> None:
    typed = load(EXAMPLES / "pushrod_train.toml")
    plain = put(put(typed, "loads.spring_rate_n_per_mm", 0.0), "loads.preload_n", 0.0)
    sprung = put(plain, "loads.valve_springs", design().drive.loads.valve_springs)
    same = put(put(typed, "loads.spring_rate_n_per_mm", 29.902937789351854), "loads.preload_n", 313.9808467881945)
    same = put(same, "loads.valve_mass_kg", get(typed, "loads.valve_mass_kg") + THIRD)
    assert value(Study(sprung), "contact_force") == pytest.approx(value(Study(same), "contact_force"), rel=1e-7)
    lift = value(Study(typed), "valve_lift")
    slow = put(sprung, "shaft.speed_rpm", 1.0)
    assert value(Study(slow), "valve_spring_force") == pytest.approx(313.9808468 + 29902.93779 * lift, abs=0.02)


@pytest.mark.parametrize("field", ["valve_springs[0].installed_mm", "valve_springs[1].wire_mm"])
def test_many_nested_springs_are_those_one_by_one(field: str) -> None:
    """Stress of the spring that has the greatest, though one of them is the same in all designs."""
    inner = SPRING.replace("3.8", "2.8").replace("24.0", "17.0").replace("51.5", "46.0")
    nested, path = design(springs=SPRING + inner, lash=0.1), f"loads.{field}"
    values = get(nested, path) * np.array([0.96, 1.0, 1.02])
    result = many(nested, {path: values}, ["valve_spring_stress_mpa:max"]).value["valve_spring_stress_mpa:max"]
    for number, stress in zip(values.tolist(), result.tolist(), strict=True):
        study = Study(put(nested, path, number), samples=3600)
        assert stress == pytest.approx(1e-6 * value(study, "valve_spring_stress").max(), rel=1e-6)


def test_many_wires_are_those_one_by_one() -> None:
    wires = np.array([3.6, 3.8, 4.0])
    result = many(
        design(), {"loads.valve_springs[0].wire_mm": wires}, ["contact_force_n:max", "valve_spring_force_n:max"]
    )
    for i, wire in enumerate(wires):
        study = Study(put(design(), "loads.valve_springs[0].wire_mm", float(wire)))
        for name in ("contact_force", "valve_spring_force"):
            high = extremes_of(study, "dynamics", (name,))[name].high.value
            assert result.value[f"{name}_n:max"][i] == pytest.approx(high, rel=1e-9)


# -- findings ---------------------------------------------------------------------------------------------------


def test_a_spring_that_binds_is_an_error() -> None:
    bound = put(design(), "loads.valve_springs[0].installed_mm", 35.59)
    assert "coil-bind" not in codes(put(design(), "loads.valve_springs[0].installed_mm", 35.61))
    assert codes(bound)["coil-bind"] == "loads.valve_springs[0].installed_mm"


def test_stress_and_fatigue_are_warnings() -> None:
    assert not {"spring-stress", "spring-surge", "coil-bind"} & set(codes(design()))
    assert "spring-stress" not in codes(put(design(), "limits.spring_stress_mpa", 796.0))
    assert codes(put(design(), "limits.spring_stress_mpa", 795.0))["spring-stress"] == "limits.spring_stress_mpa"
    weak = put(design(), "loads.valve_springs[0].tensile_mpa", 950.0)
    assert codes(weak)["spring-stress"] == "loads.valve_springs[0].wire_mm"
    assert "spring-stress" not in codes(put(design(), "loads.valve_springs[0].tensile_mpa", 1900.0))


def test_surge_that_takes_the_follower_off_the_cam_is_a_warning() -> None:
    """Near float speed a resonance takes more than what the static spring leaves."""
    found = codes(put(design(rpm=3775.6), "loads.valve_springs[0].damping_ratio", 0.005))
    assert "separation" not in found
    assert found["spring-surge"] == "loads.valve_springs[0].active_coils"
    assert "spring-surge" not in codes(put(design(rpm=1500.0), "loads.valve_springs[0].damping_ratio", 0.02))


@pytest.mark.parametrize("name", ["finger_follower", "pushrod_train"])
def test_surge_takes_the_follower_of_a_train_off_the_cam_where_its_true_force_is_0(name: str) -> None:
    """The contact force is linear in the force at the valve: that without springs, and that of one newton times the true force."""
    plain = load(EXAMPLES / f"{name}.toml")
    plain = with_drive(
        replace(plain, engine=Engine(stroke_mm=84.0, rod_mm=138.0)), valve=Valve(centre_deg=108.0, lash_mm=0.1)
    )
    for path in ("loads.spring_rate_n_per_mm", "loads.preload_n", "loads.gravity_m_s2"):
        plain = put(plain, path, 0.0)
    springs = design(springs=SPRING + "damping_ratio = 0.02\n").drive.loads.valve_springs
    floats = Study(put(plain, "loads.valve_springs", springs)).lift_off.omega * 30.0 / math.pi
    for part, surges in ((0.8, False), (0.98, True)):
        still = put(plain, "shaft.speed_rpm", part * floats)
        sprung, pushed = put(still, "loads.valve_springs", springs), put(still, "loads.preload_n", 1.0)
        free, one, study = (Study(each, samples=18_000) for each in (still, pushed, sprung))
        is_open = value(study, "valve_lift") > 1e-6 / MM
        by_newton = value(one, "contact_force") - value(free, "contact_force")
        true = value(free, "contact_force") + by_newton * value(study, "valve_spring_force")
        assert value(study, "contact_force")[is_open].min() > 0.0
        assert (true[is_open].min() < 0.0) == surges
        found = [finding for finding in findings_of(study) if finding.code == "spring-surge"]
        assert [finding.values["force_n"] for finding in found] == (
            [pytest.approx(true[is_open].min(), rel=1e-4)] if surges else []
        )


# -- files ------------------------------------------------------------------------------------------------------


def test_springs_are_read_and_written() -> None:
    typed = design(springs=SPRING + SPRING.replace("24.0", "17.0") + "tensile_mpa = 1900.0\npeened = false\n")
    again = loads(dumps(typed))
    assert again.drive.loads.valve_springs == typed.drive.loads.valve_springs
    assert [row.peened for row in again.drive.loads.valve_springs] == [True, False]


@pytest.mark.parametrize(
    ("change", "field"),
    [
        (("free_mm = 51.5", "free_mm = 40.0"), "loads.valve_springs[0].free_mm"),
        (("coil_mm = 24.0", "coil_mm = 3.0"), "loads.valve_springs[0].coil_mm"),
        (("total_coils = 7.0", "total_coils = 4.0"), "loads.valve_springs[0].total_coils"),
        (("gravity_m_s2 = 0.0", "gravity_m_s2 = 0.0\npreload_n = 10.0"), "loads.preload_n"),
        (("gravity_m_s2 = 0.0", "gravity_m_s2 = 0.0\nspring_rate_n_per_mm = 1.0"), "loads.spring_rate_n_per_mm"),
        (("wire_mm = 3.8", "wire_mm = -3.8"), "loads.valve_springs[0].wire_mm"),
        (("wire_mm = 3.8\n", ""), "loads.valve_springs[0].wire_mm"),
        (("[valve]\ncentre_deg", "[valve]\nlash_mm_ = 1\ncentre_deg"), "valve.lash_mm_"),
        (("lash_mm = 0.0", "lash_mm = 9.5"), "valve.lash_mm"),
    ],
)
def test_bad_springs_are_one_line_with_the_field(
    change: tuple[str, str], field: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(text().replace(*change), encoding="utf-8")
    assert main(["check", str(path)]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    assert field in lines[0]


def test_springs_need_a_follower_that_opens_a_valve() -> None:
    oscillating = load(EXAMPLES / "finger_follower.toml")
    assert oscillating.drive.loads.valve_springs == ()
    with pytest.raises(DesignError, match="valve_springs"):
        loads(
            text()
            .replace(
                'kind = "translating"\nface = "flat"',
                'kind = "oscillating"\narm_mm = 40.0\npivot_x_mm = 60.0\npivot_y_mm = 0.0\nside = "left"',
            )
            .replace("follower_mass_kg = 0.14\n", "")
        )


# -- searches ---------------------------------------------------------------------------------------------------


def least_force(rate: float, compression: float, mass: float, rpm: float) -> float:
    """Least force [N] of a flat tappet on lobe A, F_0 + k y + m ω² y″, densely sampled."""
    motion = Study(design(), samples=36_000).motion.displacement
    return float((rate * (compression + motion[0]) + mass * (rpm * math.pi / 30.0) ** 2 * motion[2]).min())


def test_the_preload_of_a_valve_spring_is_its_installed_length() -> None:
    limits = {"loads.least_contact_force_n_min": 50.0, "shaft.speed_rpm_max": 3300.0}
    solution = find(design(), "preload", limits)
    ((path, installed),) = solution.answer.items()
    assert path == "loads.valve_springs[0].installed_mm"
    rate, mass = 29902.937789351854, 0.14 + THIRD
    assert least_force(rate, (51.5 - installed) / MM, mass, 3300.0) == pytest.approx(50.0, abs=1e-3)
    assert get(solution.design, path) == installed
    rounded = find(design(), "preload", limits, rounding=0.5).answer[path]
    assert rounded == math.floor(installed / 0.5) * 0.5, "a longer one has less preload"


def test_the_rate_of_a_valve_spring_is_its_wire() -> None:
    limits = {"loads.least_contact_force_n_min": 50.0, "shaft.speed_rpm_max": 3300.0}
    wire = find(design(), "spring", limits).answer["loads.valve_springs[0].wire_mm"]
    rate = 79.3e9 * (wire / MM) ** 4 / (8.0 * 0.024**3 * 5.0)
    active = 7850.0 * math.pi**2 * (wire / MM) ** 2 * 0.024 * 5.0 / 4.0
    assert least_force(rate, 10.5 / MM, 0.14 + active / 3.0, 3300.0) == pytest.approx(50.0, abs=1e-3)
    assert 3.0 < wire < 3.8


def test_a_spring_that_a_nested_one_replaces_is_no_thinner_than_it_can_be_wound() -> None:
    solution = find(design(springs=SPRING + SPRING), "spring", {})
    assert solution.answer == {"loads.valve_springs[0].wire_mm": 24.0 / 20.0}
    assert "its coil is 20 wires wide" in solution.end
    slender = design(springs=SPRING.replace("3.8", "1.1") + SPRING)
    assert find(slender, "spring", {}).answer == {"loads.valve_springs[0].wire_mm": 1.1}


def test_a_search_says_which_spring_would_bind(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    save(design(), tmp_path / "train.toml")
    command = ["find", str(tmp_path / "train.toml"), "preload", "--limit", "shaft.speed_rpm_max=5500"]
    assert main(command) == 2
    assert "the valve spring binds" in capsys.readouterr().err


def test_springs_and_typed_rates_offer_the_same_searches() -> None:
    assert available_searches(design()) == available_searches(design(springs=""))
    assert {"spring", "preload", "lift-off-speed"} <= set(available_searches(design()))


@pytest.mark.parametrize("what", ["base-radius", "roller-radius"])
def test_a_cam_is_searched_under_a_valve_with_a_piston(what: str) -> None:
    train = only(load(EXAMPLES / "valve_train.toml"), 0)
    solution = find(train, what, {})
    assert solution.is_valid
    assert solution.before["piston_clearance_mm"] == pytest.approx(
        MM * extremes_of(Study(train), "linkage")["piston_clearance"].low.value, rel=1e-9
    )
