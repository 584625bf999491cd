"""core.shaft: flywheel and motor, against closed forms of single waves and steps and against an integrated motor."""

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mechanisms import (
    LAYOUT_DESIGNS,
    LIFT,
    PUSHER,
    buildable,
    levels,
    with_drive,
    with_follower,
    with_loads,
    with_shaft,
)
from references import EPS, MP
from sampled import spread, stressed
from scipy.integrate import solve_ivp
from scipy.optimize import bisect

from core.design import Design, Shaft
from core.motion import TURN, Angles, CompiledMotion
from core.output.channels import channels, existing
from core.shaft import Flywheel, LoadCurve, load_curve, panel_angles, periodic_response
from core.shaft.flywheel import phi
from core.study import Study
from core.study.stages import evaluations

# Between ten values and a polynomial through them stand two sums of ten and Lebesgue's constant of 2.5; from panel to
# panel, some 200 of them, roundings add up.
PANEL = (2 * 10 * 2.5 + 200) * EPS

FREE_PUSHER = with_loads(PUSHER, friction=0.0)

EVEN = CompiledMotion(levels(0.0, *[(45.0, 10.0 * (i % 2), "cycloidal") for i in range(7)], (45.0, 0.0, "cycloidal")))
HALVES = CompiledMotion(levels(0.0, (180.0, 10.0, "cycloidal"), (180.0, 0.0, "cycloidal")))
UNEVEN = CompiledMotion(
    levels(0.0, (1e-3, 0.0, "dwell"), (120.0, 10.0, "3-4-5"), (0.5, 10.0, "dwell"), (239.499, 0.0, "cycloidal"))
)

Torque = Callable[[Angles], np.ndarray]


def shaft(inertia: float = 0.0, slope: float = 50.0, speed: float = 60.0, share: float = 0.02) -> Shaft:
    return Shaft("ccw", speed, inertia, share, slope)


def wave(n: int, cosine: float, sine: float, level: float = 0.0) -> Torque:
    return lambda a: level + cosine * np.cos(n * a.theta) + sine * np.sin(n * a.theta)


def torque_curve(
    torque: Torque, program: CompiledMotion, switch: Torque | None = None, inertia: float = 0.0
) -> LoadCurve:
    """Of a load that is worth the same inertia all round."""
    return load_curve(lambda a: np.array([torque(a), np.full(a.theta.size, inertia)]), program, switch)


def every(program: CompiledMotion, count: int = 500) -> Angles:
    return program.angles(np.arange(count) * (TURN / count))


# -- mean and energy --------------------------------------------------------------------------------------


@pytest.mark.parametrize("program", [EVEN, HALVES, UNEVEN], ids=["even", "halves", "uneven"])
@pytest.mark.parametrize("n", [1, 2, 7, 25])
def test_a_wave_has_its_mean_and_swings_by_twice_its_integral(n: int, program: CompiledMotion) -> None:
    """A cos nθ + B sin nθ: the energy goes up and down by hypot(A, B)/n either way."""
    curve = torque_curve(wave(n, 3.0, -4.0, level=11.0), program)
    assert curve.mean == pytest.approx(11.0, abs=PANEL * 16.0)
    wheel = Flywheel(wave(n, 3.0, -4.0, level=11.0), curve, shaft())
    assert wheel.energy_swing == pytest.approx(2 * 5.0 / n, abs=PANEL * 16.0)
    assert wheel.mean_torque == curve.mean


def test_the_energy_is_the_integral_of_the_torque_above_its_mean() -> None:
    energy = periodic_response(torque_curve(wave(3, 3.0, -4.0, level=11.0), UNEVEN), 0.0)
    theta = np.linspace(0.0, TURN, 101)
    assert energy(theta) == pytest.approx(np.sin(3 * theta) - 4 / 3 * (1 - np.cos(3 * theta)), abs=PANEL * 16.0)


def test_a_step_swings_by_its_area_however_the_steps_stand() -> None:
    """+A over one half, -A over the other: A pi; and 7 over a third against a mean of 7/3."""
    steps = torque_curve(lambda a: np.where(a.piece == 0, 5.0, -5.0), HALVES)
    assert steps.mean == pytest.approx(0.0, abs=PANEL * 5.0)
    assert Flywheel(wave(1, 0, 0), steps, shaft()).energy_swing == pytest.approx(5.0 * math.pi, rel=PANEL)
    thirds = CompiledMotion(levels(0.0, (120.0, 10.0, "cycloidal"), (240.0, 0.0, "cycloidal")))
    pulse = torque_curve(lambda a: np.where(a.piece == 0, 7.0, 0.0), thirds)
    assert pulse.mean == pytest.approx(7.0 / 3.0, rel=PANEL)
    assert Flywheel(wave(1, 0, 0), pulse, shaft()).energy_swing == pytest.approx(7.0 * (2 / 3) * TURN / 3, rel=PANEL)


def test_a_jolt_within_a_thousandth_of_a_degree_is_not_lost() -> None:
    """One whole sine wave of 1 MN m within it: its lobe is width/pi times its height."""
    width = math.radians(1e-3)
    jolt = torque_curve(lambda a: np.where(a.piece == 0, 1e6 * np.sin(TURN * a.theta / width), 0.0), UNEVEN)
    assert jolt.mean == pytest.approx(0.0, abs=PANEL * 1e6 * width)
    # ten coefficients on a sixteenth of a wave: the eleventh term of its series is (2 pi/16/4)^10/10! x 2
    left_out = 2 * (TURN / 16 / 4) ** 10 / math.factorial(10)
    assert Flywheel(wave(1, 0, 0), jolt, shaft()).energy_swing == pytest.approx(
        1e6 * width / math.pi, rel=left_out + PANEL
    )


def turns_of_the_guide(study: Study, piece: int) -> list[float]:
    """Where the guide's force changes sides within a piece, by the interval that is halved."""

    def normals(theta: np.ndarray) -> np.ndarray:
        return study.at(Angles(theta, np.full(theta.size, piece))).dynamics.guide.normal

    def normal(theta: float) -> float:
        return float(normals(np.array([theta]))[0])

    if study.program.velocity_signs[piece] == 0.0:
        return []
    theta = np.linspace(study.program.starts[piece], study.program.ends[piece], 500)[1:-1]
    values = normals(theta)
    return [
        bisect(normal, a, b, xtol=1e-15)
        for (a, b), (x, y) in zip(pairwise(theta), pairwise(values), strict=True)
        if x * y < 0.0
    ]


def by_gauss(function: Callable[[np.ndarray], np.ndarray], start: float, end: float) -> float:
    """The integral of a smooth function by Gauss' rule of 20 points on ever smaller parts, until it stands."""
    nodes, weights = np.polynomial.legendre.leggauss(20)
    sums: list[float] = []
    for parts in (16, 32, 64, 128):
        half = (end - start) / parts / 2.0
        middles = start + half * (2.0 * np.arange(parts) + 1.0)
        values = function((middles[:, None] + half * nodes).ravel()).reshape(parts, -1)
        sums.append(float(half * math.fsum(values @ weights)))
        if len(sums) > 1 and abs(sums[-1] - sums[-2]) <= 1e-14 * half * parts * np.abs(values).max():
            return sums[-1]
    raise AssertionError(f"no integral: {sums}")


@pytest.mark.parametrize(
    "design", [LIFT, FREE_PUSHER, PUSHER, LAYOUT_DESIGNS["f"]], ids=["lift", "free pusher", "pusher", "f"]
)
def test_mean_and_swing_of_a_design_are_those_of_the_quadrature(design: Design) -> None:
    """By Gauss' rule between joins and between the angles where the guide's force turns round, and friction with it;
    the energy's extremes off 20 samples a degree."""
    study = Study(design)
    program = study.program

    pieces = [
        (i, a, b)
        for i, (begin, end) in enumerate(zip(program.starts, program.ends, strict=True))
        for a, b in pairwise([begin, *(turns_of_the_guide(study, i) if design.drive.loads.friction else []), end])
    ]
    if design is PUSHER:
        assert len(pieces) > program.starts.size, "friction does turn round"
    peak = np.abs(study.dynamics.torque).max()
    areas = [
        by_gauss(lambda theta, i=i: study.at(Angles(theta, np.full(theta.size, i))).dynamics.torque, a, b)
        for i, a, b in pieces
    ]
    mean = sum(areas) / TURN
    assert study.flywheel.mean_torque == pytest.approx(mean, abs=1e-13 * peak)
    # the energy by Simpson's rule: steps of a twentieth of a degree leave h^4/180 of the fourth derivative
    low = high = at = 0.0
    for i, a, b in pieces:
        n = 2 * math.ceil(math.degrees(b - a) * 20 / 2)
        theta = np.linspace(a, b, 2 * n + 1)
        t = study.at(Angles(theta, np.full(theta.size, i))).dynamics.torque - mean
        step = (b - a) / n
        energy = at + np.cumsum(step / 6 * (t[:-2:2] + 4 * t[1:-1:2] + t[2::2]))
        low, high, at = min(low, energy.min()), max(high, energy.max()), energy[-1]
    assert at == pytest.approx(0.0, abs=1e-9 * peak), "what goes in comes out"
    # an extreme between samples is missed by half a step squared of the torque's slope
    slope = np.abs(np.diff(study.dynamics.torque)).max() / (TURN / 3600)
    assert study.flywheel.energy_swing == pytest.approx(high - low, abs=2 * slope * math.radians(0.025) ** 2 / 2)
    assert study.flywheel.energy_swing >= high - low - 1e-9 * peak


@pytest.mark.parametrize("shift", [0.0, 0.9, 0.999999])
@pytest.mark.parametrize("place", [0.1, 1.0, 3.3])
def test_a_kink_ends_a_panel_and_costs_nothing(place: float, shift: float) -> None:
    """|sin θ - shift| cut where it turns round, however near together: mean, energy and motor torque in closed form."""

    def sine(angles: Angles) -> np.ndarray:
        return np.sin(angles.theta - place) - shift

    curve = torque_curve(lambda a: np.abs(sine(a)), EVEN, sine)
    first = math.asin(shift)
    # inside the two roots sin θ - shift is positive: 2 cos(first) - shift (π - 2 first); over the turn it sums to -2π shift
    inside = 2.0 * math.cos(first) - shift * (math.pi - 2.0 * first)
    assert curve.mean == pytest.approx((2.0 * inside + TURN * shift) / TURN, abs=PANEL)
    for root in (place + first, place + math.pi - first):
        assert np.abs(curve.start - root % TURN).min() <= 4 * EPS * TURN / max(math.cos(first), 1e-3)
    assert curve.start.size == torque_curve(sine, EVEN).start.size + 2
    energy = periodic_response(curve, 0.0)
    roots = sorted(r % TURN for r in (place + first, place + math.pi - first))

    def exact(theta: float) -> float:
        """The area from root to root, each with its own sign."""
        edges = [0.0, *(r for r in roots if r < theta), theta]
        areas = [math.cos(a - place) - math.cos(b - place) - shift * (b - a) for a, b in pairwise(edges)]
        return math.fsum(map(abs, areas)) - curve.mean * theta

    for theta in (0.5, 2.0, 4.0, 6.0):
        assert float(energy(np.array([theta]))[0]) == pytest.approx(exact(theta), abs=4 * PANEL)


def test_friction_that_rests_or_never_turns_cuts_no_panel() -> None:
    """No friction, no cut; in a dwell the guide's force may change sides without any rubbing."""

    def uncut(program: CompiledMotion) -> int:
        return load_curve(lambda a: np.ones((2, a.theta.size)), program, even_at_rest=True).start.size

    panels = uncut(Study(PUSHER).program)
    assert panels < torque_curve(wave(1, 1.0, 0.0), Study(PUSHER).program).start.size  # few in a dwell
    assert Study(FREE_PUSHER).flywheel.load.start.size == panels
    assert Study(PUSHER).flywheel.load.start.size == panels + 2
    still = with_loads(with_follower(PUSHER, direction_deg=90.0), preload_n=0.0)
    rests = Study(with_drive(still, motion=levels(3.0, (360.0, 3.0, "dwell"))))
    assert rests.flywheel.load.start.size == uncut(rests.program)


def test_the_estimated_inertia_keeps_the_speed_within_the_share_by_the_energy() -> None:
    """½I(ω_max² - ω_min²) = ΔE about the middle speed ω̄: (ω_max - ω_min)/ω̄ is the share asked for."""
    for share, speed in ((0.02, 60.0), (0.3, 600.0), (2.0, 1.0)):
        wheel = Flywheel(wave(2, 300.0, 0.0), torque_curve(wave(2, 300.0, 0.0), EVEN), shaft(share=share, speed=speed))
        middle = speed * math.pi / 30
        spread = 2 * 300.0 / 2 / wheel.estimated_inertia  # (ω_max² - ω_min²)/2 = ω̄ (ω_max - ω_min)
        assert spread / middle / middle == pytest.approx(share, rel=1e-11)


# -- the motor, linear: of small changes of speed ---------------------------------------------------------


@pytest.mark.parametrize("n", [1, 3, 12])
@pytest.mark.parametrize("inertia", [1e-9, 1e-3, 0.5, 20.0, 1e4, 1e12])
@pytest.mark.parametrize("program", [EVEN, UNEVEN], ids=["even", "uneven"])
def test_a_wave_of_torque_comes_to_the_motor_smaller_and_later(program: CompiledMotion, inertia: float, n: int) -> None:
    """T_n/(1 + i n I ω̄/k): of 5 cos(nθ - 0.7) about a mean of 8."""
    torque = wave(n, 5.0 * math.cos(0.7), 5.0 * math.sin(0.7), level=8.0)
    s = shaft(inertia, slope=50.0, speed=60.0)
    motor = Flywheel(torque, torque_curve(torque, program), s).linear_motor_torque(every(program))
    factor = 1.0 / (1.0 + 1j * n * inertia * TURN / 50.0)
    wanted = 8.0 + 5.0 * (factor * np.exp(1j * (n * every(program).theta - 0.7))).real
    assert motor == pytest.approx(wanted, abs=PANEL * 13.0)


@pytest.mark.parametrize("inertia", [1e-6, 0.01, 1.0, 100.0, 1e8])
def test_a_step_of_torque_reaches_the_motor_exponentially(inertia: float) -> None:
    """+5, -5 by halves: x = 5 - (5 + x0) e^{-rθ} with x(π) = x0's opposite, x0 = -5 tanh(rπ/2)."""
    s = shaft(inertia, slope=50.0, speed=60.0)
    steps: Torque = lambda a: np.where(a.piece == 0, 5.0, -5.0)  # noqa: E731
    motor = Flywheel(steps, torque_curve(steps, HALVES), s).linear_motor_torque(every(HALVES))
    rate = 50.0 / (inertia * TURN)
    begin = -5.0 * math.tanh(rate * math.pi / 2)
    theta = np.mod(every(HALVES).theta, math.pi)
    half = 5.0 - (5.0 - begin) * np.exp(-rate * theta)
    wanted = np.where(every(HALVES).theta < math.pi, half, -half)
    assert motor == pytest.approx(wanted, abs=PANEL * 5.0)


def _integrated(study: Study, inertia: float, slope: float, theta: np.ndarray) -> np.ndarray:
    """I ω̄ dω/dθ + k(ω - ω̄) = -(T - T̄) over one turn, begun so that it ends as it began; the motor's T̄ - k(ω - ω̄)."""
    program, omega, mean = study.program, study.omega, study.flywheel.mean_torque

    def run(begin: float) -> tuple[np.ndarray, float]:
        x, out = begin, np.empty_like(theta)
        for i, (a, b) in enumerate(zip(program.starts, program.ends, strict=True)):

            def rate(t: float, y: np.ndarray, i: int = i) -> np.ndarray:
                torque = study.at(Angles(np.array([t]), np.array([i]))).dynamics.torque[0]
                return -(torque - mean + slope * y) / (inertia * omega)

            told = solve_ivp(rate, (a, b), [x], method="DOP853", rtol=1e-11, atol=1e-12, dense_output=True)
            inside = (theta >= a) & (theta < b)
            out[inside] = told.sol(theta[inside])[0]
            x = float(told.y[0, -1])
        return out, x

    zero, end = run(0.0)
    decay = math.exp(-slope * TURN / (inertia * omega))
    begin = end / (1.0 - decay)
    return mean - slope * (zero + begin * np.exp(-slope * theta / (inertia * omega)))


@pytest.mark.stress
@pytest.mark.parametrize(
    ("design", "inertia"), [stressed(FREE_PUSHER, 0.05), (LAYOUT_DESIGNS["f"], 0.4)], ids=["pusher", "f"]
)
def test_the_motor_torque_is_that_of_the_integrated_motor(design: Design, inertia: float) -> None:
    fitted = with_shaft(design, flywheel_inertia_kg_m2=inertia, motor_slope_nm_s_per_rad=2.0)
    study = Study(fitted, 48)
    motor = study.flywheel.linear_motor_torque(study.angles)
    wanted = _integrated(study, inertia, 2.0, study.theta)
    assert np.ptp(wanted) > 0.05 * np.ptp(study.dynamics.torque), "it moves"
    assert motor == pytest.approx(wanted, abs=1e-9 * np.abs(study.dynamics.torque).max())


def test_the_motor_torque_of_the_lift_is_the_sum_of_its_harmonics() -> None:
    """T_n by quadrature on every segment; what is left off beyond n = 600 is its jumps' J k/(pi I ω̄ 600)."""
    inertia, slope, most = 300.0, 50.0, 600
    study = Study(with_shaft(LIFT, flywheel_inertia_kg_m2=inertia, motor_slope_nm_s_per_rad=slope), 48)
    x, weights = np.polynomial.legendre.leggauss(400)
    n = np.arange(1, most + 1)
    harmonics = np.zeros(most, dtype=complex)
    for i, (a, b) in enumerate(zip(study.program.starts, study.program.ends, strict=True)):
        theta = (a + b) / 2 + (b - a) / 2 * x
        torque = study.at(Angles(theta, np.full(theta.size, i))).dynamics.torque
        harmonics += (b - a) / 2 * (np.exp(-1j * n[:, None] * theta) * (torque * weights)).sum(axis=1) / TURN
    answer = harmonics / (1.0 + 1j * n * inertia * study.omega / slope)
    motor = study.flywheel.mean_torque + 2.0 * (answer * np.exp(1j * n * study.theta[:, None])).real.sum(axis=1)
    jumps = sum(abs(_jump(study, i)) for i in range(len(study.program.starts)))
    tail = jumps * slope / (math.pi * inertia * study.omega * most)
    assert (
        np.abs(study.flywheel.linear_motor_torque(study.angles) - motor).max()
        <= tail + 1e-9 * np.abs(study.dynamics.torque).max()
    )
    assert tail < 0.01 * np.ptp(motor)


def _jump(study: Study, piece: int) -> float:
    """Of the torque where a piece begins."""
    starts, ends = study.program.starts, study.program.ends
    after = study.at(Angles(starts[[piece]], np.array([piece]))).dynamics.torque[0]
    before = study.at(Angles(ends[[piece - 1]], np.array([(piece - 1) % ends.size]))).dynamics.torque[0]
    return float(after - before)


@settings(max_examples=10)
@given(buildable(), st.floats(-3.0, 3.0))
def test_without_flywheel_the_motor_gives_the_cams_torque_and_with_a_huge_one_the_mean(
    design: Design, power: float
) -> None:
    design = with_loads(design, friction=0.0)
    study = Study(with_shaft(design, flywheel_inertia_kg_m2=0.0), 36)
    torque, wheel = study.dynamics.torque, study.flywheel
    assert wheel.motor_torque(study.angles).tolist() == torque.tolist()
    peak = np.abs(torque).max()
    whole = Study(with_shaft(design, flywheel_inertia_kg_m2=1e12), 36)
    still = whole.flywheel.linear_motor_torque(whole.angles)
    # what remains is k/(I ω̄) of the energy swing, and the rounding of the mean
    rate = 50.0 / (1e12 * whole.omega)
    assert np.abs(still - wheel.mean_torque).max() <= rate * wheel.energy_swing + PANEL * peak
    # any flywheel leaves mean, energy and size alone
    some = Study(with_shaft(design, flywheel_inertia_kg_m2=10.0**power), 36)
    assert some.flywheel.energy_swing == wheel.energy_swing
    assert some.flywheel.mean_torque == wheel.mean_torque
    # a mean of the torque over the time past, it never passes the peak (of 3600 samples)
    assert (
        np.abs(some.flywheel.linear_motor_torque(some.angles)).max()
        <= np.abs(Study(some.design).dynamics.torque).max() * 1.001
    )


def test_a_light_flywheel_follows_the_torque_and_is_late_by_its_time_constant() -> None:
    """x = T - T'/r + ..., r = k/(I ω̄): to second order in 1/r."""
    torque = wave(2, 5.0, 1.0, level=3.0)
    rate = 50.0 / (1e-4 * TURN)
    motor = Flywheel(torque, torque_curve(torque, EVEN), shaft(1e-4)).linear_motor_torque(every(EVEN))
    theta = every(EVEN).theta
    late = torque(every(EVEN)) - (-10.0 * np.sin(2 * theta) + 2.0 * np.cos(2 * theta)) / rate
    assert np.abs(motor - late).max() <= 4 * math.hypot(5, 1) / rate**2 * 1.01 + PANEL * 9


def test_the_motor_torque_does_not_jump_where_the_cams_torque_does() -> None:
    """Steps of 10 N m: over 2e-9 rad the motor gains no more than 10 r 2e-9."""
    steps: Torque = lambda a: np.where(a.piece % 2 == 0, 5.0, -5.0)  # noqa: E731
    wheel = Flywheel(steps, torque_curve(steps, EVEN), shaft(0.3))
    for join in EVEN.starts:
        beside = np.mod(np.array([join - 1e-9, join + 1e-9]), TURN)
        before, after = wheel.linear_motor_torque(EVEN.angles(beside))
        assert abs(after - before) <= 2e-9 * 10.0 * 50.0 / (0.3 * TURN) * 1.1


# -- the panels -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "program", [EVEN, HALVES, UNEVEN, Study(LIFT).program], ids=["even", "halves", "uneven", "lift"]
)
def test_panels_tile_the_turn_and_never_cross_a_join(program: CompiledMotion) -> None:
    start, width, angles = panel_angles(program)
    assert start[0] == 0.0
    assert start[1:] == pytest.approx(start[:-1] + width[:-1], rel=4 * EPS)
    assert start[-1] + width[-1] == pytest.approx(TURN, rel=EPS)
    assert set(program.starts) <= set(start)
    assert width.max() <= math.radians(2.0) + 2 * EPS * TURN  # a difference of two angles
    inside = angles.theta.reshape(start.size, -1)
    assert (inside > start[:, None]).all()
    assert (inside < (start + width)[:, None]).all()
    piece = angles.piece.reshape(start.size, -1)
    assert (program.starts[piece] <= inside).all()
    assert (inside <= program.ends[piece]).all()


def test_what_the_motor_does_not_give_the_flywheel_does() -> None:
    """Torque balance at every angle: T_m - T_c = I ω̄ dω/dθ, with ω - ω̄ = (T̄ - T_m)/k, by central differences."""
    inertia, slope = 0.8, 50.0
    torque = wave(1, 5.0, 2.0, level=3.0)
    wheel = Flywheel(torque, torque_curve(torque, EVEN), shaft(inertia, slope))
    theta = np.linspace(0.1, 6.1, 61)
    step = 1e-4
    before, here, after = (wheel.linear_motor_torque(EVEN.angles(theta + h)) for h in (-step, 0.0, step))
    gained = inertia * TURN * -(after - before) / (2 * step) / slope
    # the difference leaves step²/6 of the third derivative and 1e-16/step of rounding
    assert here - torque(EVEN.angles(theta)) == pytest.approx(gained, abs=5.4 * (step**2 + PANEL / step))


# -- digits, and nothing for nobody -----------------------------------------------------------------------


@pytest.mark.parametrize(
    "z", spread([1e-300, 1e-12, 1e-3, 0.4, 1.0, 1.0 + 1e-9, 2.7, 4.0, 4.0 + 1e-9, 8.5, 30.0, 240.0, 1e5], 3)
)
def test_what_the_flywheel_does_within_a_panel_keeps_its_digits(z: float) -> None:
    """∫ e^{-z(1-s)} s^k ds over 0 ... 1 = e^{-z} Σ z^n/(n! (n+k+1)). Three roundings a step, which the recurrence carries on
    as it is told there."""
    roundings = 4 if z <= 1.0 else 3 * 15 if z < 8.0 else 8
    told = phi(np.array([z]))[:, 0]
    m = MP.mpf(z)
    assert told.size > 1
    for k in range(told.size):
        if z < 50.0:
            terms = (m**n / MP.factorial(n) / (n + k + 1) for n in range(260))
            exact = MP.exp(-m) * MP.fsum(terms)
        else:  # by parts: an asymptotic series that ends, but for e^{-z}
            exact = MP.fsum((-1) ** j * MP.factorial(k) / MP.factorial(k - j) / m ** (j + 1) for j in range(k + 1))
        assert abs(told[k] - exact) <= roundings * EPS * exact, k


def test_without_a_flywheel_nothing_of_it_is_computed_for_the_torque() -> None:
    study = Study(LIFT, 90)
    rows = existing(study, channels(LIFT, ("dynamics",)))
    motor = next(row for row in rows if row.slug == "motor_torque_nm")
    torque = next(row for row in rows if row.slug == "drive_torque_nm")
    assert motor.values(study).tolist() == torque.values(study).tolist()
    assert evaluations["flywheel"] == 0
    assert study.flywheel.energy_swing > 0.0
    assert evaluations["flywheel"] == 1
    levelled = Study(with_shaft(LIFT, flywheel_inertia_kg_m2=3000.0), 90)
    assert motor in existing(levelled, rows)
    assert evaluations["flywheel"] == 2
    assert not np.array_equal(motor.values(levelled), torque.values(levelled))
    assert "energy_swing" not in vars(levelled.flywheel), "made when it is asked for"
