"""The chart in the words of a machine: revolutions per minute, forbidden bands of speed, the shaft that a speed needs."""

from __future__ import annotations

from dataclasses import fields, replace
from math import pi, sqrt

import numpy as np

from core.design import Design, ElasticShaft, with_assumed, with_elastic
from core.dynamics import Loading
from core.errors import NoStability
from core.frozen import frozen
from core.mechanism.kinematics import Kinematics
from core.stability.floquet import monodromy, tongues
from core.stability.hill.coefficients import EXACT, LOAD, LOAD_SLOPE, RETUNED, Coefficients
from core.stability.hill.edges import Tongues

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
