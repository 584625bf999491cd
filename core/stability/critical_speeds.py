"""The chart in the words of a machine: revolutions per minute, forbidden bands of speed, the shaft that a speed needs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from math import pi, sqrt

import numpy as np

from core.design import UNITS, Design, ElasticShaft, with_assumed, with_elastic
from core.dynamics import Loading
from core.errors import NoStability
from core.frozen import frozen
from core.mechanism.kinematics import Kinematics
from core.plot import Plot, PlotCurve
from core.stability.coefficients import APPROXIMATE, EXACT, LOAD, LOAD_SLOPE, RETUNED, Coefficients
from core.stability.floquet import monodromy, tongues
from core.stability.steady import SteadyTurn, sum_of
from core.stability.tongues import EDGE_ERROR, ETA_MAX, Tongues, count_up_to, harmonic_tongues
from core.stability.windup import Averages, History

# -- the chart in the words of a machine ------------------------------------------------------------------------


RPM = 30.0 / pi
SAMPLES = 9  # of η in each tongue, again and again closer
ROUNDS = 4
NOTICEABLE = 1e-3  # growth per turn below which a band is left to the smallest damping of any real shaft
CLEAR = 0.02  # relative distance from a band within which a speed is near it


@frozen
class Machine:
    """The numbers of a machine beside its coefficients.

    camshaft_inertia I_c [kg m²], stiffness K_s [N m/rad], omega [rad/s], damping ratio, q, largest J [kg m²]
    """

    camshaft_inertia: float
    stiffness: float
    omega: float
    damping: float
    q: float
    inertia: float

    @property
    def natural(self) -> float:
        """√(K_s/I_c) [rad/s]."""
        return sqrt(self.stiffness / self.camshaft_inertia)

    @property
    def eta(self) -> float:
        """η at the machine's own speed (Kim1990 (12))."""
        return self.natural / self.omega

    def omega_at(self, eta: float) -> float:
        """Speed [rad/s] at an η."""
        return self.natural / eta

    def rpm(self, eta: float) -> float:
        """Speed [1/min] at an η; infinite at 0."""
        return self.natural * RPM / eta if eta > 0.0 else float("inf")

    def eta_at(self, rpm: float) -> float:
        """η at a speed [1/min], which is above 0."""
        return self.natural * RPM / rpm

    def shaft_for(self, eta: float, q: float) -> tuple[float, float]:
        """I_c [kg m²] and K_s [N m/rad] that put the machine at (η, Q) of the chart at its own speed and masses."""
        inertia = self.inertia / q
        return inertia, inertia * (eta * self.omega) ** 2


@frozen
class ForbiddenBand:
    """A forbidden band of speed.

    n                 of the tongue
    eta_lo, eta_hi    its edges
    rpm_lo, rpm_hi    the same as speeds; the higher infinite where even the fastest shaft is unstable
    growth            ln of the largest growth per turn within; rate [1/s] the same by time at ``worst_rpm``
    """

    n: int
    eta_lo: float
    eta_hi: float
    rpm_lo: float
    rpm_hi: float
    growth: float
    worst_rpm: float

    @property
    def rate(self) -> float:
        """Growth by time at the worst speed [1/s]."""
        return self.growth * self.worst_rpm / 60.0

    def holds(self, rpm: float) -> bool:
        """Whether a speed [rpm] lies in the band."""
        return self.rpm_lo <= rpm <= self.rpm_hi

    def distance(self, rpm: float) -> float:
        """Relative distance of a speed from the band, 0 within."""
        return max(self.rpm_lo / rpm - 1.0, 1.0 - self.rpm_hi / rpm, 0.0)


LEAST_GROWTH = 1e-7  # per turn: half the trace shows half its square, of which rounding leaves nothing below


def bands(
    coefficients: Coefficients, machine: Machine, result: Tongues, row: int = 0, within: float | None = None
) -> tuple[ForbiddenBand, ...]:
    """The forbidden bands of one row of tongues, the fastest first; ``within``: only those no farther from the machine's own
    speed, as a relative distance (``ForbiddenBand.distance``)."""
    edges = result.edges[row]
    wanted = (edges[:, 1] > edges[:, 0]) & (edges[:, 1] > 0.0)  # nan is not
    if within is not None:
        wanted &= (machine.eta <= edges[:, 1] * (1.0 + within)) & (machine.eta >= edges[:, 0] * (1.0 - within))
    n = np.flatnonzero(wanted)
    if n.size == 0:
        return ()
    worst, rate = peaks(coefficients, edges[n], float(result.q[row]), result.equation, result.damping)
    columns = (each.tolist() for each in (n + 1, edges[n], rate, worst))
    return tuple(
        ForbiddenBand(k, lo, hi, machine.rpm(hi), machine.rpm(lo), growth, machine.rpm(peak))
        for k, (lo, hi), growth, peak in zip(*columns, strict=True)
        if growth > LEAST_GROWTH
    )


def peaks(
    coefficients: Coefficients, edges: np.ndarray, q: float, equation: str = EXACT, damping: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Where in tongues (n, 2) the growth per turn is largest, and its logarithm there (n,), refined."""
    low, high = edges[:, 0].copy(), edges[:, 1].copy()
    at = np.arange(low.size)
    part = np.linspace(0.0, 1.0, SAMPLES)
    eta, rate = 0.5 * (low + high), np.zeros(low.size)
    for _ in range(ROUNDS):
        samples = low[:, None] + (high - low)[:, None] * part
        rates = monodromy(coefficients, samples.ravel(), np.full(samples.size, q), equation, damping).growth.reshape(
            samples.shape
        )
        top = rates.argmax(axis=1)
        better = rates[at, top] >= rate
        eta, rate = np.where(better, samples[at, top], eta), np.maximum(rate, rates[at, top])
        low, high = samples[at, np.maximum(top - 1, 0)], samples[at, np.minimum(top + 1, SAMPLES - 1)]
    return eta, rate


def loads_at(coefficients: Coefficients, eta: float) -> Coefficients:
    """The coefficients of a fixed spring held at the speed of this η: K_s may then vary, and η² with it, and the loads
    stay; those of a retuned one unchanged."""
    if not coefficients.fixed:
        return coefficients
    values = coefficients.panels.values.copy()
    values[[LOAD, LOAD_SLOPE]] *= eta * eta
    return replace(coefficients, panels=replace(coefficients.panels, values=values), spring=RETUNED)


@frozen
class Stiffness:
    """The shafts that a speed allows.

    rpm        the speed
    forbidden  (n, K_lo, K_hi) [N m/rad] by tongue, for the tongues computed, the softest first
    now        K_s of the machine; ``allowed`` whether it keeps clear of what is forbidden
    stiffer    the least K_s above the present one that keeps clear, which may be the present one
    softer     the greatest below it, None where there is none
    """

    rpm: float
    forbidden: tuple[tuple[int, float, float], ...]
    now: float
    allowed: bool
    stiffer: float
    softer: float | None

    @property
    def inside(self) -> bool:
        """The machine's own stiffness lies in a forbidden band; else at most too near one."""
        return any(low <= self.now <= high for _, low, high in self.forbidden)


def stiffness_for(coefficients: Coefficients, machine: Machine, rpm: float, count: int) -> Stiffness:
    """How stiff the shaft must be to run at a speed [1/min], by the tongues 1 ... count; a tongue counts where it grows
    noticeably, and is kept clear of by ``CLEAR`` in η."""
    omega = rpm / RPM
    held = loads_at(coefficients, machine.natural / omega)
    result = tongues(held, np.array([machine.q]), count, EXACT, machine.damping)
    near = bands(held, replace(machine, omega=omega), result)
    unit = machine.camshaft_inertia * omega * omega
    taken = [b for b in near if b.growth >= NOTICEABLE]
    bottom = float(result.bottom[0])
    forbidden = [(0, 0.0, unit * bottom**2)] if bottom > 0.0 else []
    forbidden += [(b.n, unit * b.eta_lo**2, unit * b.eta_hi**2) for b in sorted(taken, key=lambda b: b.n)]
    wide = [(lo * (1.0 - CLEAR) ** 2, hi * (1.0 + CLEAR) ** 2) for _, lo, hi in forbidden]
    stiffer, softer = machine.stiffness, machine.stiffness
    for lo, hi in wide:  # upwards
        if lo < stiffer < hi:
            stiffer = hi
    for lo, hi in reversed(wide):
        if lo < softer < hi:
            softer = lo
    allowed = stiffer == machine.stiffness
    return Stiffness(rpm, tuple(forbidden), machine.stiffness, allowed, stiffer, softer if softer > 0.0 else None)


# -- a shaft to begin with, where nothing is known of it yet -----------------------------------------------

USUAL_Q, USUAL_ETA = 0.05, 10.25  # between two tongues, which stand at halves


def first_guess(kinematics: Kinematics, loading: Loading, omega: float) -> ElasticShaft | None:
    """A shaft at Q = 0.05 and η = 10.25, both usual: I_c = max J / Q, K_s = I_c (η ω)²; rounded to three digits, for it is a
    guess. None where nothing is moved. omega [rad/s]."""
    largest = float(loading.inertia(kinematics, 1)[0].max(initial=0.0))
    if largest <= 0.0:
        return None
    own = largest / USUAL_Q
    return ElasticShaft(float(f"{own:.3g}"), float(f"{own * (USUAL_ETA * omega) ** 2:.3g}"))


def flexible(design: Design, kinematics: Kinematics, loading: Loading, omega: float) -> Design:
    """The design with a first guess of its shaft's elasticity, marked as assumed; omega [rad/s]. Raises NoStability where
    nothing is moved."""
    guess = first_guess(kinematics, loading, omega)
    if guess is None:
        raise NoStability("nothing is moved that could twist the shaft", "loads", "give masses")
    design = with_elastic(design, guess)
    for field in fields(guess)[:2]:  # inertia and stiffness; the rest is no figure of the machine
        design = with_assumed(design, f"shaft.{field.name}", True)
    return design


# -- what is drawn of a flexible shaft, its chart and other plots, as plain data that a painter -----------------


DEGREES = np.linspace(0.0, 360.0, 721)
CAM_ANGLE = "Cam angle, °"
ROUNDING = 1e-9  # of a torque's amplitude: a mean below it is rounding
PER_TURN = 100  # samples of a history that is drawn
TERMS = (
    ("d", "inertia d"),
    ("C", "C"),
    ("U", "load U"),
    ("κ", "κ = C'"),
    ("ψ", "ψ = U'"),
)
"""Rows of ``Coefficients.panels`` as they are called in plots."""


def coefficients_plot(coefficients: Coefficients, only: Sequence[str] = ("ψ", "d", "C", "U")) -> Plot:
    """What the equation is made of by cam angle (Kim1990 Fig. 5 is ψ)."""
    values = coefficients.panels.at(np.deg2rad(DEGREES[:-1]), len(TERMS))
    rows = {short: (name, row) for (short, name), row in zip(TERMS, values, strict=True)}
    curves = tuple(
        PlotCurve(DEGREES, np.append(rows[short][1], rows[short][1][0]), rows[short][0], i)
        for i, short in enumerate(only)
    )
    return Plot(CAM_ANGLE, "Terms", curves)


def averages_plots(averages: Averages) -> tuple[Plot, Plot]:
    """Mean |β| and mean |β'| by η (Kim1990 Figs. 6, 7); dashed where the follower leaves the cam meanwhile."""
    note = "dashed: leaves the cam" if averages.lost is not None and averages.lost.any() else ""
    return (
        Plot("Frequency ratio η", "Mean |β|, turns", _by_contact(averages, averages.wind_up), note=note),
        Plot("Frequency ratio η", "Mean |dβ/dy|", _by_contact(averages, averages.slope), note=note),
    )


def _by_contact(averages: Averages, means: np.ndarray) -> tuple[PlotCurve, ...]:
    """Each row of Q solid where contact is kept, dashed where it is lost; the two meet halfway."""
    curves = []
    for number, (q, row) in enumerate(zip(averages.q, means, strict=True)):
        lost = np.zeros(row.size, dtype=bool) if averages.lost is None else averages.lost[number]
        label = f"{q:.3g}" if number else f"Q = {q:.3g}"
        curves.append(PlotCurve(averages.eta, np.where(lost, np.nan, row), label, number))
        if lost.any():
            # with the neighbours, so that no piece of the curve is missing
            near = lost | np.append(lost[1:], False) | np.append(False, lost[:-1])
            curves.append(PlotCurve(averages.eta, np.where(near, row, np.nan), "", number, dashed=True))
    return tuple(curves)


def history_plot(run: History) -> Plot:
    """The wind-up in time (Kim1990 Figs. 9 to 12); a mark where the follower leaves the cam."""
    y = np.linspace(0.0, run.ended, round(run.ended * PER_TURN) + 1)
    curve = PlotCurve(y, run.at(y)[0], f"η = {run.eta:.4g}, Q = {run.q:.4g}")
    return Plot("Turns of the input", "Twist β, turns", (curve,), contact_marks(run))


INPUT_ANGLE = "Input angle, °"
MODELS = (
    ("steady", "true steady response", 0, False),
    (EXACT, "linear, exact (21)", 1, True),
    (APPROXIMATE, "linear, approximate (22), (27)", 2, True),
)


def steady_plots(turn: SteadyTurn) -> tuple[Plot, ...]:
    """The steady response over a turn of the input: wind-up beside that of the linear forced responses, with the torque in the shaft;
    and each unit's followers' errors."""
    theta = np.deg2rad(DEGREES)
    made = {"steady": np.rad2deg(turn.wind_up(theta))} | {n: 360.0 * sum_of(c, theta) for n, c in turn.linear().items()}
    curves = tuple(
        PlotCurve(DEGREES, made[n], label, row, dashed)
        for n, label, row, dashed in MODELS
        if np.isfinite(made[n]).all()
    )
    mean = 0.0 if abs(turn.mean_torque) < ROUNDING * turn.torque_amplitude else turn.mean_torque
    note = f"torque in the shaft {mean:.3g} ± {turn.torque_amplitude:.3g} N·m"
    plots = [Plot(INPUT_ANGLE, "Wind-up, °", curves, note=note)]
    for unit in dict.fromkeys(each.unit for each in turn.followers):
        rows = [(i, each) for i, each in enumerate(turn.followers) if each.unit == unit]
        errors = tuple(PlotCurve(DEGREES, turn.error(theta, i) / UNITS[unit].factor, each.name, i) for i, each in rows)
        plots.append(Plot(INPUT_ANGLE, f"Follower's error, {UNITS[unit].symbol}", errors))
    return tuple(plots)


def harmonics_plot(turn: SteadyTurn) -> Plot:
    """Amplitudes of the wind-up's harmonics, the true ones as bars, beside those of the linear forced responses (Kim1990 (27), γ = 0)."""
    numbers = np.arange(1, turn.highest + 1)
    made = {"steady": turn.harmonics()} | dict(turn.linear())
    curves = []
    for name, label, row, _ in MODELS:
        size = 720.0 * np.abs(made[name][1:])
        if np.isfinite(size).all():
            place = numbers + 0.24 * (row - 1)  # beside each other
            x, y = np.repeat(place, 3), np.column_stack((0.0 * size, size, np.full(size.size, np.nan))).ravel()
            x, y = (
                np.append(x, (0.4, turn.highest + 0.6)),
                np.append(y, (np.nan, np.nan)),
            )  # room at both ends of the axis
            curves.append(PlotCurve(x, y, label, row, False))
    return Plot("Harmonic, × shaft speed", "Wind-up, °", tuple(curves))


def contact_marks(run: History) -> tuple[tuple[float, str], ...]:
    """Where a follower leaves its cam [turns], with a text; empty where none does."""
    if run.contact_lost is None:
        return ()
    who = f"{run.leaving} leaves its cam" if run.leaving else "leaves the cam"
    return ((run.contact_lost, f"{who} at {run.contact_lost:.4g}"),)


# -- the chart ---------------------------------------------------------------------------------------------

ROWS = 64
COARSE_ORDER = 32  # harmonics of a first picture
MOST_Q = 0.12  # of the chart of a machine of small Q (Kim1990 Fig. 8 goes to 0.1)
ROOM = 1.6  # above the machine's own Q


@frozen(eq=False)
class Chart:
    """Tongues over a range of Q, as edges.

    name         of the design
    q            (rows,) rising
    tongues      equation -> its tongues in all rows; edges (rows, n, 2), nan where damping has closed them
    eta_max      the η axis goes from 0 to here
    machine      None where the chart belongs to no machine; else its operating point is (``machine.eta``, ``machine.q``)
                 and it runs up along Q = ``machine.q`` from η = ∞
    marked       rows of Q that were requested
    """

    name: str
    q: np.ndarray
    tongues: dict[str, Tongues]
    eta_max: float
    machine: Machine | None
    marked: tuple[float, ...] = ()

    def outline(self, n: int, equation: str = EXACT) -> list[np.ndarray]:
        """Tongue n as closed polygons (k, 2) of (η, Q), one for each stretch of Q in which it is open; without damping the
        first starts at its tip, η = n/2 at Q = 0."""
        edges = self.tongues[equation].edges[:, n - 1]
        open_rows = np.isfinite(edges).all(axis=1)
        runs = np.split(np.arange(self.q.size), np.flatnonzero(np.diff(open_rows.astype(int))) + 1)
        drawn = []
        for run in runs:
            if not open_rows[run[0]]:
                continue
            left = np.column_stack((edges[run, 0], self.q[run]))
            right = np.column_stack((edges[run, 1], self.q[run]))[::-1]
            parts = [left, right]
            if run[0] == 0 and self.tongues[equation].damping == 0.0:
                parts.insert(0, np.array([[0.5 * n, 0.0]]))
            drawn.append(np.concatenate(parts))
        return drawn


def _top(coefficients: Coefficients, machine: Machine | None, marked: Sequence[float]) -> float:
    """How far the chart goes in Q: above the machine and the marked rows, but no farther than these where a fixed load
    would be stiffer than the shaft, 1 + Qψ1 < 0."""
    own = (machine.q,) if machine is not None else ()
    top = max((MOST_Q, *(ROOM * q for q in own), *(1.1 * q for q in marked)))
    softest = -float(coefficients.panels.values[LOAD_SLOPE].min()) if coefficients.fixed else 0.0
    return min(top, max((1.0 / softest, *own, *marked))) if softest > 0.0 else top


def chart(
    coefficients: Coefficients,
    machine: Machine | None,
    name: str = "",
    eta_max: float = ETA_MAX,
    rows: int = ROWS,
    damping: float = 0.0,
    marked: Sequence[float] = (),
    error: float = EDGE_ERROR,
    coarse: bool = False,
) -> Chart:
    """The chart of a machine: ``rows`` of Q from 0 to well above the machine's own.

    coarse: without damping and with few harmonics, however far from ``error`` that is: a first picture, at once.
    """
    q = _top(coefficients, machine, marked) * np.arange(1, rows + 1) / rows
    count = count_up_to(eta_max)
    if coarse:
        by_equation = {
            e: harmonic_tongues(coefficients, q, count, e, error, COARSE_ORDER) for e in (EXACT, APPROXIMATE)
        }
    else:
        by_equation = {e: tongues(coefficients, q, count, e, damping, error) for e in (EXACT, APPROXIMATE)}
    return Chart(name, q, by_equation, eta_max, machine, tuple(marked))


# -- what is tabled of a flexible shaft -------------------------------------------------------------------------


SAMPLES_PER_TURN = 100
COEFFICIENT_ROWS = 720

Columns = tuple[list[str], list[np.ndarray]]


def windup_columns(runs: Sequence[History]) -> Columns:
    """Histories from rest, one below the other: time in turns of the input, wind-up β and its slope β', contact force as a
    multiple of M X''m ω² where there is a cam."""
    parts = []
    for each in runs:
        y = np.arange(int(each.ended * SAMPLES_PER_TURN) + 1) / SAMPLES_PER_TURN
        beta, slope = each.at(y)
        parts.append([np.full(y.size, each.eta), np.full(y.size, each.q), y, beta, slope, each.force(y)])
    names = ["eta", "q", "input_turns", "wind_up", "wind_up_slope", "contact_force_ratio"]
    table = [np.concatenate(column) for column in zip(*parts, strict=True)]
    return (names[:-1], table[:-1]) if runs[0].contact is None else (names, table)


def averages_columns(means: Averages) -> Columns:
    """Means of |β| and |β'| by η (Kim1990 Figs. 6, 7), and 1 where the follower leaves the cam within the turn; what cannot
    be followed is left out."""
    there = np.isfinite(means.wind_up).ravel()
    columns = [
        np.repeat(means.q, means.eta.size),
        np.tile(means.eta, means.q.size),
        means.wind_up.ravel(),
        means.slope.ravel(),
    ]
    names = ["q", "eta", "mean_wind_up", "mean_wind_up_slope"]
    if means.lost is not None:
        names.append("leaves_cam")
        columns.append(means.lost.ravel().astype(float))
    return names, [column[there] for column in columns]


def coefficients_columns(coefficients: Coefficients) -> Columns:
    """What the equation is made of by cam angle (Kim1990 Fig. 5 is ψ): inertia share d, C, U, κ, ψ."""
    degrees = 360.0 * np.arange(COEFFICIENT_ROWS) / COEFFICIENT_ROWS
    rows = coefficients.panels.at(np.deg2rad(degrees), 5)
    return ["cam_angle_deg", "inertia", "centripetal", "load", "curvature", "psi"], [degrees, *rows]
