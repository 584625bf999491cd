"""Top speed of a slide on a screw, within the limits of its servo, by closed forms of the law 3-4-5 on pure inertia."""

from dataclasses import replace
from math import pi, sqrt

import pytest

from core.design import Design, get
from core.project import loads
from core.varying import VariedField, find_top_speed, top_speed_study

SPEED = "shaft.speed_rpm"
MASS, STROKE, SPAN, TRAVEL, RATIO = 6.0, 0.03, 90.0, 0.01, 2.0  # kg, m, deg, m, turns of the motor per turn
MOVES = "".join(
    f'[[motion.segments]]\nlaw = "{law}"\nspan_deg = {SPAN}\n{rise}'
    for law, rise in (("3-4-5", "rise_mm = 30.0\n"), ("dwell", ""), ("3-4-5", "rise_mm = -30.0\n"), ("dwell", ""))
)
SCREW = (
    'format = 1\nname = "Screw"\n[motion]\nstart_mm = 0.0\n' + MOVES
    + f'[servo]\nkind = "rotary"\nmass_kg = {MASS}\ntravel_mm_per_turn = {TRAVEL * 1e3}\ngear_ratio = {RATIO}\n'
)  # fmt: skip
SHAFT = '[shaft]\nrotation = "ccw"\nspeed_rpm = 60.0\n'
ROWS = {  # limit of the servo -> the figure that it bounds, its coefficient, and the power of the time of the rise
    "peak_torque_nm": ("servo_torque_nm_abs", MASS * 10.0 / sqrt(3.0) * STROKE * TRAVEL / (2.0 * pi * RATIO), 2),
    "rated_torque_nm": ("servo_torque_nm_rms", MASS * sqrt(60.0 / 7.0) * STROKE * TRAVEL / (2.0 * pi * RATIO), 2),
    "rated_rpm": ("servo_speed_rpm_abs", 15.0 / 8.0 * STROKE / TRAVEL * RATIO * 60.0, 1),
}


def screw(**limits: float) -> Design:
    return loads(SCREW + "".join(f"{name} = {value}\n" for name, value in limits.items()) + SHAFT)


def speed_at(name: str, limit: float, span: float = SPAN) -> float:
    """Speed [rpm] at which the figure is at its limit: c/Tᵏ with the time T = span/(6 n) of a rise."""
    _, coefficient, power = ROWS[name]
    return span / 6.0 * (limit / coefficient) ** (1.0 / power)


@pytest.mark.parametrize(("name", "limit"), [("peak_torque_nm", 0.4), ("rated_torque_nm", 0.2), ("rated_rpm", 3000.0)])
def test_every_limit_of_a_servo_bounds_the_speed(name: str, limit: float) -> None:
    figure, _, power = ROWS[name]
    solution = find_top_speed(screw(**{name: limit}), {}, (VariedField(SPEED, 6.0, 6000.0),))
    exact = speed_at(name, limit)
    assert exact * (1.0 - 2e-6) <= solution.answer[SPEED] <= exact
    ((holds, per_percent),) = solution.binding
    assert holds == figure
    assert per_percent == pytest.approx(0.01 * exact / power, rel=1e-4)


def test_the_tightest_limit_of_a_servo_holds_and_a_stated_one_replaces_it() -> None:
    limits = {"peak_torque_nm": 0.4, "rated_torque_nm": 0.2, "rated_rpm": 12000.0}
    design, vary = screw(**limits), (VariedField(SPEED, 6.0, 6000.0),)
    rows = {limit.key.replace(":", "_"): limit.max for limit in top_speed_study(design).limits}
    assert {figure: rows[figure] for figure, _, _ in ROWS.values()} == dict(zip(
        (ROWS[name][0] for name in limits), limits.values(), strict=True
    ))  # fmt: skip
    tightest = min(speed_at(name, limit) for name, limit in limits.items())
    assert find_top_speed(design, {}, vary).answer[SPEED] == pytest.approx(tightest, rel=2e-6)
    stated = find_top_speed(design, {"servo.rated_torque_nm": 0.05}, vary)
    assert get(stated.machine, SPEED) == pytest.approx(speed_at("rated_torque_nm", 0.05), rel=2e-6)
    assert stated.binding[0][0] == "servo_torque_nm_rms"


def test_bounds_that_must_be_relieved_together_give_nothing_alone() -> None:
    """The motor turns as fast in the rise as in the return: a longer span of one of both gains no speed."""
    paths = tuple(f"motion.segments[{i}].span_deg" for i in (0, 2))
    vary = (VariedField(SPEED, 6.0, 6000.0), *(VariedField(path, 60.0, 100.0) for path in paths))
    solution = find_top_speed(screw(rated_rpm=3000.0), {}, vary)
    exact = speed_at("rated_rpm", 3000.0, 100.0)
    assert exact * (1.0 - 2e-6) <= solution.answer[SPEED] <= exact
    assert [get(solution.machine, path) for path in paths] == [100.0, 100.0]
    gains = dict(solution.binding)
    assert gains.pop("servo_speed_rpm_abs") == pytest.approx(0.01 * exact, rel=1e-4)
    assert set(gains) <= set(paths)
    assert all(abs(gain) < 1e-6 * exact for gain in gains.values())
    wide = replace(vary[1], high=101.0)
    assert find_top_speed(screw(rated_rpm=3000.0), {}, (vary[0], wide, vary[2])).answer[SPEED] <= exact
