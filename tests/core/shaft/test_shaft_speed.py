"""core.shaft: the speed of a shaft with a flywheel, against closed forms and against an independent integration."""

import json
import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from mechanisms import LAYOUT_DESIGNS, LIFT, PUSHER, levels, with_loads, with_shaft
from numpy.polynomial import Chebyshev
from sampled import stressed
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from core.__main__ import main
from core.design import Design, si
from core.errors import NoSolution
from core.findings import ERROR
from core.motion import TURN, Angles, CompiledMotion
from core.output.export import files
from core.output.report import report
from core.output.summary import summary
from core.project import dumps, load, loads, save
from core.shaft import LoadCurve, SpeedCurve, load_curve, steady_speed
from core.study import Study, extremes_of, findings_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
FREE_LIFT = with_loads(LIFT, friction=0.0)
EVEN = CompiledMotion(levels(0.0, *[(45.0, 10.0 * (i % 2), "cycloidal") for i in range(7)], (45.0, 0.0, "cycloidal")))
HALVES = CompiledMotion(levels(0.0, (180.0, 10.0, "cycloidal"), (180.0, 0.0, "cycloidal")))

Curve = Callable[[np.ndarray], np.ndarray]


def of(torque: Curve, inertia: Curve, program: CompiledMotion = EVEN) -> LoadCurve:
    """A load by its torque at constant speed and its inertia at the camshaft."""
    return load_curve(lambda a: np.array([torque(a.theta), inertia(a.theta)]), program)


def none(theta: np.ndarray) -> np.ndarray:
    return 0.0 * theta


def rising(theta: np.ndarray) -> np.ndarray:
    return 10.0 + 100.0 * np.sin(theta)


def share(speed: SpeedCurve, count: int = 20_000) -> np.ndarray:
    """ω/ω̄ (count,)."""
    return 1.0 + speed.deviation(np.arange(count) * (TURN / count)) / speed.mean


# -- closed forms -----------------------------------------------------------------------------------------


def test_a_motor_of_too_little_speed_stalls_and_a_faster_one_runs() -> None:
    """Mean 10 N m, amplitude 100, 110 N m at standstill, 5 kg m²: at 3 rad/s it stalls, at 5 it runs from 0.207 to 1.566."""
    assert steady_speed(of(rising, none), 5.0, 100.0 / 3.0, 3.0) is None
    runs = steady_speed(of(rising, none), 5.0, 100.0 / 5.0, 5.0)
    assert runs is not None
    ratio = share(runs)
    assert (round(ratio.min(), 3), round(ratio.max(), 3)) == (0.207, 1.566)


@pytest.mark.parametrize("slope", [0.5, 20.0, 3e3, 2e6])
def test_between_steps_the_speed_is_that_of_the_closed_form(slope: float) -> None:
    """I ω ω' = k(a - ω) with a the speed that the motor would come to: -kθ/I = ω + a ln|a - ω|, over each half turn;
    from hardly any decay to one within a millionth of a degree."""
    load = load_curve(lambda a: np.array([np.where(a.piece == 0, 0.06, -0.06) * slope, 0.0 * a.theta]), HALVES)
    speed = steady_speed(load, 3.0, slope, 2.0)
    assert speed is not None
    for begin, end_speed in ((0.0, 2.0 - 0.06), (math.pi, 2.0 + 0.06)):
        reach = min(math.pi, 5.0 * 3.0 * 2.0 / slope)  # then nothing is left to tell
        theta = begin + reach * np.array([0.0, 0.01, 0.1, 0.4, 0.9])
        omega = 2.0 + speed.deviation(theta)
        past = omega + end_speed * np.log(np.abs(end_speed - omega))
        # a - ω has lost the digits that it shares with a
        lost = 4e-16 * 2.0 * end_speed / np.abs(end_speed - omega).min()
        assert -np.diff(past) * 3.0 / slope == pytest.approx(np.diff(theta), abs=3.0 / slope * (1e-9 + 10.0 * lost))


@pytest.mark.parametrize("size", [1e3, 1e12, 1e20])
def test_beside_a_torque_of_any_size_the_motor_holds_the_mean(size: float) -> None:
    """Σ T sin θ gives and takes 2 T: with I = 2 T/(0.02 ω̄²) the speed goes ± 1 % about a mean that k∮(ω̄ - ω) = 0 fixes, however
    small k is beside T."""
    speed = steady_speed(of(lambda theta: size * np.sin(theta), none), 2.0 * size / 0.02 / 100.0, 50.0, 10.0)
    assert speed is not None
    ratio = share(speed)
    assert ratio.mean() == pytest.approx(1.0, abs=1e-9)
    assert ratio.max() - ratio.min() == pytest.approx(0.02, rel=1e-3)


@pytest.mark.parametrize("flywheel", [1e3, 1e6, 1e12])
def test_a_huge_flywheel_leaves_the_mean_and_the_small_rest_is_the_linear_one(flywheel: float) -> None:
    """ω - ω̄ by the harmonic k/(k + i n I ω̄) of the torque; the square of the fluctuation apart."""
    speed = steady_speed(of(rising, none), flywheel, 50.0, 20.0)
    assert speed is not None
    theta = np.linspace(0.0, 6.2, 63)
    answer = 100.0 / (1.0 + 1j * flywheel * 20.0 / 50.0)
    linear = -(answer * np.exp(1j * theta)).imag / 50.0
    ripple = abs(answer) / 50.0 / 20.0
    assert speed.deviation(theta) == pytest.approx(
        linear, abs=20.0 * (2.0 * ripple**2 + 1e-15) + 1e-9 * np.abs(linear).max()
    )


@pytest.mark.parametrize("flywheel", [0.0001, 0.3, 40.0])
def test_an_inertia_that_changes_with_the_angle_is_part_of_the_energy(flywheel: float) -> None:
    """Without a slope worth speaking of the energy is kept: a load that is nothing but an inertia, T_c = ½ω̄²J', turns at
    √(2E/(I + J))."""
    speed = steady_speed(
        of(lambda t: 0.5 * 49.0 * 0.9 * np.sin(3 * t), lambda t: 0.5 - 0.3 * np.cos(3 * t)), flywheel, 1e-5, 7.0
    )
    assert speed is not None
    theta = np.linspace(0.0, 6.2, 200)
    energy = (7.0 + speed.deviation(theta)) ** 2 * (flywheel + 0.5 - 0.3 * np.cos(3 * theta))
    assert np.ptp(energy) <= 1e-5 * energy.max()
    whole = 7.0 + speed.deviation(np.arange(3000) * (TURN / 3000))
    assert whole.mean() == pytest.approx(7.0, rel=1e-8), "so that the motor gives the mean torque"


@pytest.mark.parametrize(("flywheel", "slope"), [(6.0, 20.0), (50.0, 300.0), (0.01, 4000.0), (1e7, 20.0)])
def test_over_a_turn_the_motor_gives_what_the_load_takes(flywheel: float, slope: float) -> None:
    """The mean of T_m by the angle is T̄, so that of the speed is ω̄."""
    speed = steady_speed(of(rising, none), flywheel, slope, 5.0)
    assert speed is not None
    edges = np.append(speed.start, TURN)
    x, weight = np.polynomial.legendre.leggauss(12)
    total = sum((b - a) / 2 * (weight @ speed.deviation((a + b) / 2 + (b - a) / 2 * x)) for a, b in pairwise(edges))
    assert total == pytest.approx(0.0, abs=1e-10 * 5.0 * TURN)


# -- against an integration of its own --------------------------------------------------------------------


class Integrated:
    """The energy of the shaft by DOP853, from forces alone: at two speeds the torque that holds them gives T_s and J_e',
    and J_e is 0 in the dwell that the turn begins with."""

    def __init__(self, design: Design) -> None:
        self.study = Study(design, 72)
        s = si(design.shaft)
        self.flywheel, self.slope, self.mean = s.flywheel_inertia, s.motor_slope, s.speed
        self.pieces, worth = [], 0.0
        mean = 0.0
        for i, (a, b) in enumerate(zip(self.study.program.starts, self.study.program.ends, strict=True)):
            torque, still = (self._torque(speed, i, a, b) for speed in (design.shaft.speed_rpm, 1e-6))
            slope = (torque - still) * (2.0 / self.mean**2)
            inertia = slope.integ(1, lbnd=a, k=worth)
            worth = float(inertia(b))
            mean += float(torque.integ(1, lbnd=a)(b)) / TURN
            self.pieces.append((a, b, still, inertia))
        self.level = mean
        assert worth == pytest.approx(0.0, abs=1e-9 * max(abs(float(p[3](0.5 * (p[0] + p[1])))) for p in self.pieces))

    def _torque(self, speed: float, piece: int, a: float, b: float) -> Chebyshev:
        study = Study(with_shaft(self.study.design, speed_rpm=speed), 72)

        def value(theta: np.ndarray) -> np.ndarray:
            return study.at(Angles(np.clip(theta, a, b), np.full(theta.size, piece))).dynamics.torque

        return Chebyshev.interpolate(value, 80, domain=(a, b))

    def turn(self, energy: float, theta: np.ndarray) -> tuple[float, np.ndarray, float]:
        """Energy after a turn, ω at the angles, and how far it came before it stood still [rad]."""
        omega = np.zeros(theta.size)
        for a, b, still, inertia in self.pieces:

            def rate(t: float, e: np.ndarray, still: Chebyshev = still, inertia: Chebyshev = inertia) -> np.ndarray:
                speed = np.sqrt(np.maximum(2.0 * e / (self.flywheel + inertia(t)), 0.0))
                return self.level + self.slope * (self.mean - speed) - still(t)

            def stands(t: float, e: np.ndarray) -> float:
                return float(e[0] - 1e-9 * self.flywheel * self.mean**2)

            stands.terminal = True  # type: ignore[attr-defined]
            gone = solve_ivp(rate, (a, b), [energy], "DOP853", dense_output=True, events=stands, rtol=1e-11, atol=1e-10)
            inside = (theta >= a) & (theta < min(b, gone.t[-1]))
            if inside.any():
                omega[inside] = np.sqrt(2.0 * gone.sol(theta[inside])[0] / (self.flywheel + inertia(theta[inside])))
            if gone.status == 1:
                return 0.0, omega, float(gone.t[-1])
            energy = float(gone.y[0, -1])
        return energy, omega, TURN

    def steady(self, theta: np.ndarray) -> np.ndarray:
        """ω of the turn that repeats itself (n,)."""
        top = 0.5 * self.flywheel * self.mean**2

        def gained(energy: float) -> float:
            """Over a turn; where it stood still, less was too little too."""
            end, _, came = self.turn(energy, np.zeros(0))
            return end - energy if came == TURN else top

        begin = brentq(gained, 0.05 * top, 3.0 * top, rtol=1e-13, xtol=1e-12 * top)
        return self.turn(begin, theta)[1]


@pytest.mark.parametrize(
    ("design", "flywheel", "slope"),
    [
        stressed(FREE_LIFT, 2000.0, 3000.0),
        (FREE_LIFT, 1000.0, 50.0),
        stressed(with_loads(LAYOUT_DESIGNS["f"], friction=0.0), 0.2, 8.0),
    ],
    ids=["lift", "lift near its stall", "f"],
)
def test_speed_and_motor_torque_are_those_of_the_integrated_shaft(
    design: Design, flywheel: float, slope: float
) -> None:
    fitted = with_shaft(design, flywheel_inertia_kg_m2=flywheel, motor_slope_nm_s_per_rad=slope)
    study, own = Study(fitted, 144), Integrated(fitted)
    omega = own.steady(study.theta)
    assert np.ptp(omega) > 0.1 * own.mean, "it changes"
    assert study.flywheel.speed(study.angles) == pytest.approx(omega, rel=1e-8)
    assert study.flywheel.motor_torque(study.angles) == pytest.approx(
        own.level + slope * (own.mean - omega), abs=1e-7 * slope
    )


@pytest.mark.stress
def test_where_the_motor_stalls_the_integrated_shaft_stands_still_and_with_the_least_flywheel_it_does_not() -> None:
    stalling = with_shaft(FREE_LIFT, flywheel_inertia_kg_m2=500.0, motor_slope_nm_s_per_rad=50.0)
    wheel = Study(stalling).flywheel
    assert not wheel.runs
    least = wheel.least_inertia
    for inertia, runs in ((500.0, False), (0.985 * least, False), (least, True)):
        shaft = Integrated(with_shaft(stalling, flywheel_inertia_kg_m2=inertia))
        energy, came = 0.5 * inertia * shaft.mean**2, TURN
        for _ in range(25):
            energy, _, came = shaft.turn(energy, np.zeros(0))
            if came < TURN:
                break
        assert (came == TURN) == runs, inertia


def test_the_lift_of_the_paper_with_a_small_flywheel() -> None:
    """2000 kg m² and 3000 N m s/rad: 1951 N m where the linear equation says 1701, and 0.691 to 1.201 of the mean speed."""
    study = Study(with_shaft(LIFT, flywheel_inertia_kg_m2=2000.0, motor_slope_nm_s_per_rad=3000.0))
    found = extremes_of(study, "dynamics", ("camshaft_speed", "motor_torque", "linear_motor_torque"))
    assert found["motor_torque"].high.value == pytest.approx(1951.0, abs=0.5)
    assert found["linear_motor_torque"].high.value == pytest.approx(1701.0, abs=0.5)
    assert found["camshaft_speed"].low.value / study.omega == pytest.approx(0.691, abs=5e-4)
    assert found["camshaft_speed"].high.value / study.omega == pytest.approx(1.201, abs=5e-4)


# -- what is said of it -----------------------------------------------------------------------------------


def test_a_speed_less_even_than_wanted_is_noted_with_a_flywheel_that_keeps_it() -> None:
    """At half the flywheel of the paper the speed goes up and down by twice as much."""
    study = Study(with_shaft(LIFT, flywheel_inertia_kg_m2=17410.0), 720)
    (note,) = [f for f in findings_of(study) if f.code == "speed-fluctuates"]
    found = extremes_of(study, "dynamics", ("camshaft_speed",))["camshaft_speed"]
    assert note.values["percent"] == pytest.approx(100.0 * (found.high.value - found.low.value) / study.omega, rel=1e-6)
    assert note.values["wanted_percent"] == 2.0
    kept = Study(with_shaft(LIFT, flywheel_inertia_kg_m2=note.values["inertia_kg_m2"]), 72)
    assert 0.0 <= 0.02 - kept.flywheel.fluctuation <= 1e-9
    assert "speed-fluctuates" not in [f.code for f in findings_of(kept)]


def test_a_motor_that_stalls_is_an_error_that_names_the_flywheel_it_takes() -> None:
    study = Study(with_shaft(LIFT, flywheel_inertia_kg_m2=500.0), 72)
    (stalls,) = [f for f in findings_of(study) if f.code == "motor-stalls"]
    assert (stalls.severity, stalls.field) == (ERROR, "shaft.flywheel_inertia_kg_m2")
    assert stalls.values["inertia_kg_m2"] == 500.0
    theta = np.linspace(0.0, 2.0 * np.pi, 7201)
    torque = study.at_theta(theta[:-1]).shaft_torque
    given = np.concatenate(([0.0], np.cumsum(torque - torque.mean())))
    assert stalls.cam_angle_deg == pytest.approx(np.rad2deg(theta[given.argmax()]), abs=0.2), "where it runs slowest"
    least = float(stalls.values["least_kg_m2"])
    assert f"{least:.3g} kg·m²" in stalls.message
    assert Study(with_shaft(LIFT, flywheel_inertia_kg_m2=least)).flywheel.runs
    assert not Study(with_shaft(LIFT, flywheel_inertia_kg_m2=0.985 * least)).flywheel.runs
    with pytest.raises(NoSolution, match=r"shaft\.flywheel_inertia_kg_m2: the motor stalls"):
        study.flywheel.motor_torque(study.angles)


@pytest.mark.parametrize(("flywheel", "columns"), [(500.0, ()), (0.0, ("motor_torque_nm", "speed_rpm")),
                                                   (3000.0, ("motor_torque_nm", "speed_rpm", "linear_motor_torque_nm"))])  # fmt: skip
def test_motor_columns_stand_where_the_motor_runs(flywheel: float, columns: tuple[str, ...]) -> None:
    head, *rows = files(Study(with_shaft(LIFT, flywheel_inertia_kg_m2=flywheel), 72))["dynamics.csv"].splitlines()
    names = head.split(",")
    assert tuple(n for n in names if "motor" in n or "speed" in n) == columns
    if flywheel == 0.0:
        table = [dict(zip(names, row.split(","), strict=True)) for row in rows]
        assert {float(row["speed_rpm"]) for row in table} == {20.0}
        assert [row["motor_torque_nm"] for row in table] == [row["drive_torque_nm"] for row in table]


def test_the_lift_carries_the_flywheel_of_its_own_sizing() -> None:
    """34,945 kg m² for 2 %; by the energy alone it would be 34,820."""
    design = load(EXAMPLES / "transfer_lift.toml")
    study = Study(design)
    assert not design.drive.is_linkage
    assert design.shaft.flywheel_inertia_kg_m2 == pytest.approx(study.flywheel.needed_inertia, rel=1e-4)
    assert "shaft.flywheel_inertia_kg_m2" in design.assumed
    found = extremes_of(study, "dynamics", ("camshaft_speed",))["camshaft_speed"]
    reached = (found.high.value - found.low.value) / study.omega
    assert 0.01999 < reached <= 0.02


@pytest.fixture(scope="module")
def rocker() -> Design:
    """The rocker cam with a flywheel too small for its 2 %."""
    return with_shaft(load(EXAMPLES / "rocker_cam.toml"), flywheel_inertia_kg_m2=0.3)


@pytest.mark.stress
def test_the_least_flywheel_is_that_of_the_integrated_shaft(rocker: Design) -> None:
    """With 0.3298 kg m² the true speed keeps 2 %; ΔE/(C_s ω̄²), 0.297, makes it 2.2 %."""
    wheel = Study(rocker, 72).flywheel
    for inertia, reached in ((wheel.needed_inertia, 0.02), (wheel.estimated_inertia, 0.0220)):
        own = Integrated(with_shaft(rocker, flywheel_inertia_kg_m2=inertia))
        omega = own.steady(np.linspace(0.0, TURN, 40_001)[:-1])
        assert np.ptp(omega) / own.mean == pytest.approx(reached, rel=1e-6 if reached == 0.02 else 5e-3)
    assert wheel.needed_inertia == pytest.approx(0.329825, rel=1e-5)


def test_report_summary_finding_and_search_name_one_flywheel(
    rocker: Design, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "rocker.toml"
    save(rocker, file)
    assert main(["find", str(file), "flywheel", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)["answer"]["shaft.flywheel_inertia_kg_m2"]
    study = Study(rocker, 72)
    figures = summary(study, study.stages)
    assert figures["flywheel"]["needed_inertia_kg_m2"] == answer
    (note,) = [f for f in figures["findings"] if f["code"] == "speed-fluctuates"]
    assert note["values"]["inertia_kg_m2"] == answer
    assert note["values"]["percent"] == 100.0 * figures["flywheel"]["fluctuation"]
    lines = [line.split() for line in report(study).splitlines()]
    assert [line[-2] for line in lines if line[:3] == ["Flywheel", "for", "2"]] == ["0.3298"]
    assert [line[-2] for line in lines if line[:4] == ["Estimate", "of", "it", "by"]] == ["0.2973"]
    assert "a flywheel of 0.3299 kg·m² keeps it within the limit" in note["message"]


def test_where_no_flywheel_is_needed_what_is_reached_without_one_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    """The card picker's motor keeps its speed alone; beside one that hardly weighs anything no difference is seen."""
    file = EXAMPLES / "card_picker.toml"
    assert main(["find", str(file), "flywheel", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["answer"] == {"shaft.flywheel_inertia_kg_m2": 0.0}
    study = Study(with_shaft(load(file), flywheel_inertia_kg_m2=1e-9), 72)
    speed = extremes_of(study, "dynamics", ("camshaft_speed",))["camshaft_speed"]
    reached = (speed.high.value - speed.low.value) / study.omega
    assert found["reached"]["shaft.speed_fluctuation"] == pytest.approx(reached, rel=1e-6)
    assert reached < 0.005


def test_a_motor_slope_that_nobody_gave_is_assumed_wherever_it_enters(
    rocker: Design, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """In the design that is read, beside the flywheel of the report, and below the answer of the search; a given one is not."""
    text = dumps(rocker)
    given, silent = tmp_path / "given.toml", tmp_path / "silent.toml"
    given.write_text(text, "utf-8")
    silent.write_text(text.replace("motor_slope_nm_s_per_rad = 5.0\n", ""), "utf-8")
    path = "shaft.motor_slope_nm_s_per_rad"
    for file, assumed in ((given, False), (silent, True)):
        design = load(file)
        assert (path in design.assumed) == assumed
        assert loads(dumps(design)) == design, "saved, it stays so"
        lines = report(Study(design, 72)).splitlines()
        assert any(line.startswith("Motor slope") and line.endswith("*") for line in lines) == assumed
        assert any(line.startswith("Flywheel for 2 %") and "motor slope *" in line for line in lines) == assumed
        assert main(["find", str(file), "flywheel"]) == 0
        assert (f"it depends on {path} = 50, which is assumed" in capsys.readouterr().out) == assumed
        assert main(["find", str(file), "flywheel", "--json"]) == 0
        assert json.loads(capsys.readouterr().out)["assumed"] == ({path: 50.0} if assumed else {})


def test_a_pusher_that_jams_has_no_speed_either() -> None:
    study = Study(with_shaft(with_loads(PUSHER, friction=3.5), flywheel_inertia_kg_m2=1.0), 72)
    assert "motor-stalls" not in [f.code for f in findings_of(study)]
    with pytest.raises(NoSolution, match="jams"):
        _ = study.flywheel
