"""The chart for a machine: revolutions per minute, forbidden bands of speed, the stiffness that a speed needs."""

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
from core.number_text import result_text
from core.plot import Plot, PlotCurve
from core.stability.coefficients import APPROXIMATE, EXACT, LOAD, LOAD_SLOPE, RETUNED, Coefficients
from core.stability.floquet import monodromy, tongues
from core.stability.steady import SteadyTurn, fourier_sum
from core.stability.tongues import EDGE_ERROR, ETA_MAX, Tongues, count_up_to, harmonic_tongues
from core.stability.windup import Averages, History

# -- bands of speed ---------------------------------------------------------------------------------------------

RPM = 30.0 / pi
SAMPLES = 9  # of η in each tongue, in each round
ROUNDS = 4
NOTICEABLE = 1e-3  # growth per turn below which the smallest damping of any real shaft closes a band
CLEAR = 0.02  # relative distance from a band within which a speed is near it


@frozen
class Machine:
    """The figures of a machine that its dimensionless coefficients do not contain.

    Attributes
    ----------
    camshaft_inertia : float
        I_c [kg m²].
    stiffness : float
        K_s [N m/rad].
    omega : float
        Speed [rad/s].
    damping : float
        Damping ratio.
    q : float
        Q, max J / I_c.
    inertia : float
        max J [kg m²].

    References
    ----------
    Kim1990: Q = M_v X′_m²/I_c is the case of a single mass, max J = M_v X′_m².
    """

    camshaft_inertia: float
    stiffness: float
    omega: float
    damping: float
    q: float
    inertia: float

    @property
    def natural(self) -> float:
        """Natural frequency n_s = √(K_s/I_c) [rad/s]."""
        return sqrt(self.stiffness / self.camshaft_inertia)

    @property
    def eta(self) -> float:
        """Frequency ratio η at the machine's own speed (Kim1990 (12))."""
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

    Attributes
    ----------
    n : int
        Number of its tongue.
    eta_lo, eta_hi : float
        Edges of the tongue.
    rpm_lo, rpm_hi : float
        The edges as speeds; rpm_hi is infinite where even the fastest shaft is unstable.
    growth : float
        Logarithm of the largest growth per turn in the band.
    worst_rpm : float
        Speed of the largest growth.
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
        """Growth rate at the worst speed [1/s]."""
        return self.growth * self.worst_rpm / 60.0

    def contains(self, rpm: float) -> bool:
        """Whether a speed [1/min] is in the band."""
        return self.rpm_lo <= rpm <= self.rpm_hi

    def distance(self, rpm: float) -> float:
        """Relative distance of a speed from the band, 0 within."""
        return max(self.rpm_lo / rpm - 1.0, 1.0 - self.rpm_hi / rpm, 0.0)


LEAST_GROWTH = 1e-7  # per turn: half the trace exceeds 1 by half its square, which is rounding below this value


def bands(
    coefficients: Coefficients, machine: Machine, result: Tongues, row: int = 0, within: float | None = None
) -> tuple[ForbiddenBand, ...]:
    """Forbidden bands of one row of tongues, the fastest first.

    Where ``within`` is given, only those whose relative distance from the machine's own speed is at most this value.
    """
    edges = result.edges[row]
    is_open = (edges[:, 1] > edges[:, 0]) & (edges[:, 1] > 0.0)  # nan is not
    if within is not None:
        is_open &= (machine.eta <= edges[:, 1] * (1.0 + within)) & (machine.eta >= edges[:, 0] * (1.0 - within))
    n = np.flatnonzero(is_open)
    if n.size == 0:
        return ()
    worst, rate = peaks(coefficients, edges[n], float(result.q[row]), result.equation, result.damping)
    columns = (column.tolist() for column in (n + 1, edges[n], rate, worst))
    return tuple(
        ForbiddenBand(k, lo, hi, machine.rpm(hi), machine.rpm(lo), growth, machine.rpm(peak))
        for k, (lo, hi), growth, peak in zip(*columns, strict=True)
        if growth > LEAST_GROWTH
    )


def peaks(
    coefficients: Coefficients, edges: np.ndarray, q: float, equation: str = EXACT, damping: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Largest growth per turn in each tongue, refined.

    Parameters
    ----------
    coefficients : Coefficients
    edges : ndarray (n, 2), dimensionless
        Lower and upper η of the tongues.
    q : float
    equation : str
        Key of `EQUATIONS`.
    damping : float
        Damping ratio ζ.

    Returns
    -------
    eta : ndarray (n,), dimensionless
        Position of the largest growth.
    growth : ndarray (n,), dimensionless
        Its logarithm.
    """
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


def coefficients_at_speed(coefficients: Coefficients, eta: float) -> Coefficients:
    """Coefficients with the loads of the speed at this η, for a K_s that varies.

    A fixed spring's loads at that speed become those of a retuned spring, so that η² no longer multiplies them;
    coefficients
    of a retuned spring are returned unchanged.
    """
    if not coefficients.fixed:
        return coefficients
    values = coefficients.panels.values.copy()
    values[[LOAD, LOAD_SLOPE]] *= eta * eta
    return replace(coefficients, panels=replace(coefficients.panels, values=values), spring=RETUNED)


@frozen
class Stiffness:
    """Shaft stiffnesses that a speed allows.

    Attributes
    ----------
    rpm : float
        Speed [1/min].
    forbidden : tuple of (int, float, float)
        Number of the tongue and range of K_s [N m/rad], for the computed tongues, the softest first.
    current : float
        K_s of the machine.
    allowed : bool
        Whether the current K_s keeps clear of the forbidden ranges.
    stiffer : float
        Least allowed K_s not below the current one.
    softer : float or None
        Greatest allowed K_s not above the current one, None where none is allowed.
    """

    rpm: float
    forbidden: tuple[tuple[int, float, float], ...]
    current: float
    allowed: bool
    stiffer: float
    softer: float | None

    @property
    def inside(self) -> bool:
        """Whether the current stiffness is in a forbidden range, not only near one."""
        return any(low <= self.current <= high for _, low, high in self.forbidden)


def stiffness_for(coefficients: Coefficients, machine: Machine, rpm: float, count: int) -> Stiffness:
    """Stiffness of the shaft for a speed [1/min], by the tongues 1 ... count.

    A tongue counts where its growth is noticeable; the allowed stiffness is at least ``CLEAR`` away from it in η.
    """
    omega = rpm / RPM
    at_speed = coefficients_at_speed(coefficients, machine.natural / omega)
    result = tongues(at_speed, np.array([machine.q]), count, EXACT, machine.damping)
    near = bands(at_speed, replace(machine, omega=omega), result)
    inertia_scale = machine.camshaft_inertia * omega * omega
    noticeable = [b for b in near if b.growth >= NOTICEABLE]
    bottom = float(result.bottom[0])
    forbidden = [(0, 0.0, inertia_scale * bottom**2)] if bottom > 0.0 else []
    forbidden += [
        (b.n, inertia_scale * b.eta_lo**2, inertia_scale * b.eta_hi**2) for b in sorted(noticeable, key=lambda b: b.n)
    ]
    widened = [(lo * (1.0 - CLEAR) ** 2, hi * (1.0 + CLEAR) ** 2) for _, lo, hi in forbidden]
    stiffer, softer = machine.stiffness, machine.stiffness
    for lo, hi in widened:  # upwards
        if lo < stiffer < hi:
            stiffer = hi
    for lo, hi in reversed(widened):
        if lo < softer < hi:
            softer = lo
    allowed = stiffer == machine.stiffness
    return Stiffness(rpm, tuple(forbidden), machine.stiffness, allowed, stiffer, softer if softer > 0.0 else None)


# -- a first guess of an unknown shaft ---------------------------------------------------------------------

TYPICAL_Q, TYPICAL_ETA = 0.05, 10.25  # between two tongues, which are at half integers


def first_guess(kinematics: Kinematics, loading: Loading, omega: float) -> ElasticShaft | None:
    """A shaft of typical Q = 0.05 and η = 10.25: I_c = max J / Q, K_s = I_c (η ω)², rounded to three digits.

    None where no mass moves; omega in rad/s.
    """
    largest = float(loading.inertia(kinematics, 1)[0].max(initial=0.0))
    if largest <= 0.0:
        return None
    inertia = largest / TYPICAL_Q
    return ElasticShaft(float(f"{inertia:.3g}"), float(f"{inertia * (TYPICAL_ETA * omega) ** 2:.3g}"))


def with_flexible_shaft(design: Design, kinematics: Kinematics, loading: Loading, omega: float) -> Design:
    """Return the design with a first guess of its shaft's elasticity, marked as assumed; omega in rad/s.

    Raises
    ------
    NoStability
        Where no mass moves.
    """
    guess = first_guess(kinematics, loading, omega)
    if guess is None:
        raise NoStability("no moving mass twists the shaft", "loads", "give masses")
    design = with_elastic(design, guess)
    for field in fields(guess)[:2]:  # inertia and stiffness
        design = with_assumed(design, f"shaft.{field.name}", True)
    return design


# -- plots --------------------------------------------------------------------------------------------------

DEGREES = np.linspace(0.0, 360.0, 721)
CAM_ANGLE = "Cam angle, °"
ROUNDING = 1e-9  # of a torque's amplitude: a mean below it is rounding
PER_TURN = 100  # samples of a history's plot
TERMS = (
    ("d", "inertia d"),
    ("C", "C"),
    ("U", "load U"),
    ("κ", "κ = C'"),
    ("ψ", "ψ = U'"),
)
"""Symbols and titles in plots of the rows of ``Coefficients.panels``."""


def coefficients_plot(coefficients: Coefficients, only: Sequence[str] = ("ψ", "d", "C", "U")) -> Plot:
    """Terms of the equation by cam angle (Kim1990 Fig. 5 is ψ)."""
    values = coefficients.panels.at(np.deg2rad(DEGREES[:-1]), len(TERMS))
    rows = {short: (name, row) for (short, name), row in zip(TERMS, values, strict=True)}
    curves = tuple(
        PlotCurve(DEGREES, np.append(rows[short][1], rows[short][1][0]), rows[short][0], i)
        for i, short in enumerate(only)
    )
    return Plot(CAM_ANGLE, "Terms", curves)


def averages_plots(averages: Averages) -> tuple[Plot, Plot]:
    """Mean |β| and mean |β'| by η (Kim1990 Figs. 6, 7); dashed where the follower leaves the cam."""
    note = "dashed: leaves the cam" if averages.is_contact_lost is not None and averages.is_contact_lost.any() else ""
    return (
        Plot("Frequency ratio η", "Mean |β|, turns", _by_contact(averages, averages.wind_up), note=note),
        Plot("Frequency ratio η", "Mean |dβ/dy|", _by_contact(averages, averages.slope), note=note),
    )


def _by_contact(averages: Averages, means: np.ndarray) -> tuple[PlotCurve, ...]:
    """Each row of Q solid where contact is maintained, dashed where it is lost; the two meet halfway."""
    curves = []
    for number, (q, row) in enumerate(zip(averages.q, means, strict=True)):
        is_lost = (
            np.zeros(row.size, dtype=bool) if averages.is_contact_lost is None else averages.is_contact_lost[number]
        )
        label = result_text(q, 3) if number else f"Q = {result_text(q, 3)}"
        curves.append(PlotCurve(averages.eta, np.where(is_lost, np.nan, row), label, number))
        if is_lost.any():
            # with the neighbours, so that no piece of the curve is missing
            near = is_lost | np.append(is_lost[1:], False) | np.append(False, is_lost[:-1])
            curves.append(PlotCurve(averages.eta, np.where(near, row, np.nan), "", number, dashed=True))
    return tuple(curves)


def history_plot(run: History) -> Plot:
    """Wind-up in time (Kim1990 Figs. 9 to 12), with a mark where the follower leaves the cam."""
    y = np.linspace(0.0, run.ended, round(run.ended * PER_TURN) + 1)
    curve = PlotCurve(y, run.at(y)[0], f"η = {result_text(run.eta)}, Q = {result_text(run.q)}")
    return Plot("Turns of the input", "Twist β, turns", (curve,), contact_marks(run))


INPUT_ANGLE = "Input angle, °"
MODELS = (
    ("steady", "true steady response", 0, False),
    (EXACT, "linear, exact (21)", 1, True),
    (APPROXIMATE, "linear, approximate (22), (27)", 2, True),
)


def steady_plots(turn: SteadyTurn) -> tuple[Plot, ...]:
    """Plots of the steady response over a turn of the input.

    The wind-up together with that of the linear forced responses and the torque in the shaft; and, for each unit, the
    followers' errors.
    """
    theta = np.deg2rad(DEGREES)
    curves_by_model = {"steady": np.rad2deg(turn.wind_up(theta))} | {
        model: 360.0 * fourier_sum(c, theta) for model, c in turn.linear().items()
    }
    curves = tuple(
        PlotCurve(DEGREES, curves_by_model[model], label, row, dashed)
        for model, label, row, dashed in MODELS
        if np.isfinite(curves_by_model[model]).all()
    )
    mean = 0.0 if abs(turn.mean_torque) < ROUNDING * turn.torque_amplitude else turn.mean_torque
    note = f"torque in the shaft {result_text(mean, 3)} ± {result_text(turn.torque_amplitude, 3)} N·m"
    plots = [Plot(INPUT_ANGLE, "Wind-up, °", curves, note=note)]
    for unit in dict.fromkeys(follower.unit for follower in turn.followers):
        rows = [(i, follower) for i, follower in enumerate(turn.followers) if follower.unit == unit]
        errors = tuple(
            PlotCurve(DEGREES, turn.error(theta, i) / UNITS[unit].factor, follower.name, i) for i, follower in rows
        )
        plots.append(Plot(INPUT_ANGLE, f"Follower's error, {UNITS[unit].symbol}", errors))
    return tuple(plots)


def harmonics_plot(turn: SteadyTurn) -> Plot:
    """Amplitudes of the wind-up's harmonics as bars: the steady response and the linear ones (Kim1990 (27), γ = 0)."""
    numbers = np.arange(1, turn.highest + 1)
    coefficients_by_model = {"steady": turn.harmonics()} | dict(turn.linear())
    curves = []
    for name, label, row, _ in MODELS:
        size = 720.0 * np.abs(coefficients_by_model[name][1:])
        if np.isfinite(size).all():
            position = numbers + 0.24 * (row - 1)  # adjacent bars
            x, y = np.repeat(position, 3), np.column_stack((0.0 * size, size, np.full(size.size, np.nan))).ravel()
            x, y = (
                np.append(x, (0.4, turn.highest + 0.6)),
                np.append(y, (np.nan, np.nan)),
            )  # room at both ends of the axis
            curves.append(PlotCurve(x, y, label, row, False))
    return Plot("Harmonic, × shaft speed", "Wind-up, °", tuple(curves))


def contact_marks(run: History) -> tuple[tuple[float, str], ...]:
    """Turn at which a follower leaves its cam, with a text; empty where none does."""
    if run.contact_lost is None:
        return ()
    event = f"{run.leaving} leaves its cam" if run.leaving else "leaves the cam"
    return ((run.contact_lost, f"{event} at {result_text(run.contact_lost)}"),)


# -- the chart ---------------------------------------------------------------------------------------------

ROWS = 64
COARSE_ORDER = 32  # harmonics of a coarse chart
MOST_Q = 0.12  # of the chart of a machine of small Q (Kim1990 Fig. 8 goes to 0.1)
ROOM = 1.6  # above the machine's own Q


@frozen(eq=False)
class Chart:
    """Tongues over a range of Q, as edges.

    Attributes
    ----------
    name : str
        Name of the design.
    q : ndarray (rows,), dimensionless
        Rising.
    tongues : dict of Tongues
        By equation; edges (rows, n, 2), NaN where damping has closed them.
    eta_max : float
        Upper end of the η axis.
    machine : Machine or None
        Its operating point is (`machine.eta`, `machine.q`); it runs up along Q = `machine.q` from η = ∞.
    marked : tuple of float
        Requested rows of Q.
    """

    name: str
    q: np.ndarray
    tongues: dict[str, Tongues]
    eta_max: float
    machine: Machine | None
    marked: tuple[float, ...] = ()

    def outline(self, n: int, equation: str = EXACT) -> list[np.ndarray]:
        """Tongue n as closed polygons (η, Q), one for each range of Q in which it is open.

        Without damping the first polygon starts at the tip, η = n/2 at Q = 0.

        Returns
        -------
        list of ndarray (k, 2), dimensionless
        """
        edges = self.tongues[equation].edges[:, n - 1]
        open_rows = np.isfinite(edges).all(axis=1)
        runs = np.split(np.arange(self.q.size), np.flatnonzero(np.diff(open_rows.astype(int))) + 1)
        polygons = []
        for run in runs:
            if not open_rows[run[0]]:
                continue
            left = np.column_stack((edges[run, 0], self.q[run]))
            right = np.column_stack((edges[run, 1], self.q[run]))[::-1]
            parts = [left, right]
            if run[0] == 0 and self.tongues[equation].damping == 0.0:
                parts.insert(0, np.array([[0.5 * n, 0.0]]))
            polygons.append(np.concatenate(parts))
        return polygons


def _top(coefficients: Coefficients, machine: Machine | None, marked: Sequence[float]) -> float:
    """Upper end of the chart in Q: above the machine and the marked rows.

    It does not exceed these where a fixed load would be stiffer than the shaft, 1 + Qψ1 < 0.
    """
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
    """Chart of a machine: ``rows`` of Q from 0 to well above the machine's own.

    With ``coarse`` without damping and with few harmonics, whatever the error: an immediate first result.
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


# -- tables -----------------------------------------------------------------------------------------------------

SAMPLES_PER_TURN = 100
COEFFICIENT_ROWS = 720

Columns = tuple[list[str], list[np.ndarray]]


def windup_columns(runs: Sequence[History]) -> Columns:
    """Columns of histories from rest, one below the other.

    Time in turns of the input, wind-up β and its slope β', contact force as a multiple of M X''m ω² where there is a
    cam.
    """
    parts = []
    for run in runs:
        y = np.arange(int(run.ended * SAMPLES_PER_TURN) + 1) / SAMPLES_PER_TURN
        beta, slope = run.at(y)
        parts.append([np.full(y.size, run.eta), np.full(y.size, run.q), y, beta, slope, run.force(y)])
    names = ["eta", "q", "input_turns", "wind_up", "wind_up_slope", "contact_force_ratio"]
    table = [np.concatenate(column) for column in zip(*parts, strict=True)]
    return (names[:-1], table[:-1]) if runs[0].contact is None else (names, table)


def averages_columns(means: Averages) -> Columns:
    """Columns of the means of |β| and |β'| by η (Kim1990 Figs. 6, 7).

    The last column is 1 where the follower leaves the cam within the turn. Rows that could not be integrated are left
    out.
    """
    is_known = np.isfinite(means.wind_up).ravel()
    columns = [
        np.repeat(means.q, means.eta.size),
        np.tile(means.eta, means.q.size),
        means.wind_up.ravel(),
        means.slope.ravel(),
    ]
    names = ["q", "eta", "mean_wind_up", "mean_wind_up_slope"]
    if means.is_contact_lost is not None:
        names.append("leaves_cam")
        columns.append(means.is_contact_lost.ravel().astype(float))
    return names, [column[is_known] for column in columns]


def coefficients_columns(coefficients: Coefficients) -> Columns:
    """Columns of the terms of the equation by cam angle (Kim1990 Fig. 5 is ψ): inertia share d, C, U, κ, ψ."""
    degrees = 360.0 * np.arange(COEFFICIENT_ROWS) / COEFFICIENT_ROWS
    rows = coefficients.panels.at(np.deg2rad(degrees), 5)
    return ["cam_angle_deg", "inertia", "centripetal", "load", "curvature", "psi"], [degrees, *rows]
