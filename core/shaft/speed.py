"""Speed of a camshaft with a flywheel: the periodic solution of the nonlinear equation of motion.

E = ½(I + J_e(θ))ω², dE/dθ = T_m(ω) - T_s(θ), with the motor's T_m = T̄ + k(ω̄ - ω) and the static torque T_s of the
load. The torque at constant speed is T_c = T_s + ½ω̄² J_e', so that the energy above that of the mean speed,
e = E - ½(I + J_e)ω̄², obeys

    e' = k(ω̄ - ω) - (T_c - T̄),    ω = √(ω̄² + 2e/(I + J_e)),

which loses no digit where the speed hardly changes. Where a turn is too short for the motor to follow, e = U + f with
the energy U of the load alone, U' = -(T_c - T̄), and f' = k(ω̄ - ω), so that next to a torque of any size no digit of
the motor's is lost. T_c, and so the friction μ|N| in T_s, are those of the mean speed: the change of |N| with the speed
is neglected. Where J_e jumps, which it does only with the motion's velocity, the impulse is neglected in e as in T_c.

The right-hand side decreases with e and is convex in it: there is at most one periodic solution with ω > 0. Where there
is none the machine stalls.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from core.design.parts import LINEAR, Servo
from core.frozen import frozen
from core.motion import TURN
from core.shaft.curve import LoadCurve, by_blocks, locate, powers, to_powers

# -- servo motor with a gear ------------------------------------------------------------------------------------


def lever(servo: Servo) -> float:
    """Motor rotation per unit of the motion [rad/rad or rad/m]; 1 for a linear motor."""
    return servo.gear_ratio * shaft_lever(servo)


def shaft_lever(servo: Servo) -> float:
    """Rotation of the output shaft per unit of the motion [rad/rad or rad/m]; 1 for a linear motor."""
    if servo.kind == LINEAR or servo.travel_mm_per_turn is None:
        return 1.0
    return 2.0 * math.pi / (servo.travel_mm_per_turn * 1e-3)


def moved_mass(servo: Servo) -> float:
    """Mass or inertia that the servo moves besides the loads, reduced to the motion [kg or kg m²]."""
    return (servo.mass_kg or 0.0) + (servo.inertia_kg_m2 or 0.0) * shaft_lever(servo) ** 2


@frozen(eq=False)
class MotorLoad:
    """Load of a motor by a motion.

    Attributes
    ----------
    speed, acceleration : ndarray (n,) [m/s, m/s² or rad/s, rad/s²]
        Of the motion.
    load, friction : ndarray (n,) [N or N m]
        Of the design's loads and masses, and friction of the servo.
    losses : ndarray (n,), dimensionless
        Factor of the gear on the force.
    force : ndarray (n,) [N or N m]
        On the motion without the rotor, with the losses of the gear.
    """

    speed: np.ndarray
    acceleration: np.ndarray
    load: np.ndarray
    friction: np.ndarray
    losses: np.ndarray
    force: np.ndarray


def motor_load(
    servo: Servo, speed: np.ndarray, acceleration: np.ndarray, force: np.ndarray, sign: np.ndarray
) -> MotorLoad:
    """Load of a motor, Q = F + m ÿ + F_r sgn ẏ, times 1/η where the motor drives, Q ẏ > 0, and times η where it brakes.

    Parameters
    ----------
    servo : Servo
        With the efficiency η of the gear.
    speed, acceleration : ndarray (n,) [m/s, m/s² or rad/s, rad/s²]
        Of the motion.
    force : ndarray (n,) [N or N m]
        Of the loads, F.
    sign : ndarray (n,), dimensionless
        Of the velocity, as the segment states it.

    Returns
    -------
    MotorLoad
    """
    friction = ((servo.friction_n or 0.0) + (servo.friction_nm or 0.0) * shaft_lever(servo)) * sign
    total = force + moved_mass(servo) * acceleration + friction
    losses = np.where(total * speed >= 0.0, 1.0 / servo.efficiency, servo.efficiency)
    return MotorLoad(speed, acceleration, force, friction, losses, total * losses)


def motor_torque(servo: Servo, load: MotorLoad) -> np.ndarray:
    """Motor torque T = J_r i ÿ + Q/i, i the motor rotation per unit of the motion.

    Parameters
    ----------
    servo : Servo
    load : MotorLoad

    Returns
    -------
    ndarray (n,) [N m], [N] for a linear motor

    References
    ----------
    Balance at the motor.
    """
    i = lever(servo)
    rotor = 0.0 if servo.kind == LINEAR else servo.rotor_inertia_kg_m2
    return np.asarray(rotor * i * load.acceleration + load.force / i)


def best_ratio(servo: Servo, acceleration_squared: float, force_squared: float) -> float:
    """Gear ratio of least rms torque, from means over the time of a turn.

    T² = J_r² i² ÿ² + 2 J_r ÿ Q + Q²/i² has its least mean where i⁴ = ⟨Q²⟩/(J_r² ⟨ÿ²⟩); with pure inertia i² =
    J_load/J_r.
    """
    i = (force_squared / acceleration_squared) ** 0.25 / math.sqrt(servo.rotor_inertia_kg_m2)
    return i / shaft_lever(servo)


# -- the speed of a camshaft with a flywheel --------------------------------------------------------------------


NODES = 10  # of a panel, Radau's: the last one is the panel's end, so that a fast decay stays a decay
ROUNDING = 1e-12  # of the largest torque: tolerance of the mean
STANDSTILL = 1e-6  # of ω²/ω̄²: below a thousandth of the mean speed the shaft counts as standing still
CLOSE = 1e-7  # of the mean speed: Newton's steps double their digits, so that the next one is rounding
RESOLVED = 1e-11  # of the motor's torque: largest last coefficients of a resolved panel
ITERATIONS, ROUNDS = 60, 12
MOST_PANELS = 6  # times those of the load
FINEST_HALVING = 40
SAMPLES = 1440  # of a turn, between which extremes of the speed are refined
TOPS, PARTS, PASSES = 6, 32, 4  # number of refined samples, parts of each side, passes


@frozen(eq=False)
class SpeedCurve:
    """Speed over one turn.

    Attributes
    ----------
    start, width : ndarray (m,) [rad]
        Of the panels, those of the load or parts of them.
    energy : ndarray (NODES + 1, m) [J]
        Coefficients of r**k, r = (θ - start)/width, of the energy e above that of the mean speed.
    load : LoadCurve
    flywheel : float
        Inertia I [kg m²].
    mean : float
        Mean speed ω̄ [rad/s].
    """

    start: np.ndarray
    width: np.ndarray
    energy: np.ndarray
    load: LoadCurve
    flywheel: float
    mean: float

    def deviation(self, theta: np.ndarray) -> np.ndarray:
        """Deviation ω - ω̄ from the mean speed.

        Parameters
        ----------
        theta : ndarray (n,) [rad]

        Returns
        -------
        ndarray (n,) [rad/s]
        """
        return by_blocks(self._deviation, theta)

    def _deviation(self, theta: np.ndarray) -> np.ndarray:
        panel, r = locate(self.start, self.width, theta)
        energy = (self.energy[:, panel] * powers(r, NODES + 1)).sum(axis=0)
        panel, r = locate(self.load.start, self.load.width, theta)
        inertia = self.flywheel + np.maximum((self.load.inertia[:, panel] * powers(r)).sum(axis=0), 0.0)
        deviation, _ = _above_mean(energy, inertia, self.mean)
        return deviation


def deviation_range(speed: SpeedCurve) -> tuple[float, float]:
    """Least and greatest ω - ω̄ over the turn [rad/s], refined from the highest samples."""
    theta = np.arange(SAMPLES) * (TURN / SAMPLES)
    deviation = speed.deviation(theta)
    lowest = -_highest(lambda angles: -speed.deviation(angles), theta, -deviation)
    return lowest, _highest(speed.deviation, theta, deviation)


def speed_fluctuation(speed: SpeedCurve) -> float:
    """Fluctuation (ω_max - ω_min)/ω̄ over the turn."""
    low, high = deviation_range(speed)
    return (high - low) / speed.mean


def _highest(function: Callable[[np.ndarray], np.ndarray], theta: np.ndarray, value: np.ndarray) -> float:
    """Greatest value of a periodic function with samples (n,), kinks included."""
    tops = np.flatnonzero((value > np.roll(value, 1)) & (value >= np.roll(value, -1)))
    top, reach, best = theta[tops[np.argsort(value[tops])[-TOPS:]]], TURN / SAMPLES, float(value.max())
    for _ in range(PASSES if top.size else 0):
        finer = top[:, None] + reach * np.linspace(-1.0, 1.0, 2 * PARTS + 1)
        values = function(np.mod(finer.ravel(), TURN)).reshape(finer.shape)
        top, reach = finer[np.arange(top.size), np.argmax(values, axis=1)], reach / PARTS
        best = max(best, float(values.max()))
    return best


@frozen(eq=False)
class _Panels:
    """Parts of the load's panels, with the load at their nodes.

    Attributes
    ----------
    parent, low, share : (m,) panel of the load, begin of the part in it, and its fraction of it, 0...1
    width : (m,) [rad]
    torque, inertia : (m, NODES) T_c - T̄ [N m] less U', and I + J_e [kg m²]
    load_energy : (m, NODES) U at the nodes [J]
    power : (NODES + 1, m) coefficients of the powers of U
    """

    parent: np.ndarray
    low: np.ndarray
    share: np.ndarray
    width: np.ndarray
    torque: np.ndarray
    inertia: np.ndarray
    load_energy: np.ndarray
    power: np.ndarray


@lru_cache(maxsize=1)
def collocation() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Radau's nodes of 0...1, the last of them 1, and matrices on values at them (NODES,).

    Returns
    -------
    nodes : ndarray (NODES,), dimensionless
    integrals : ndarray (NODES, NODES), dimensionless
        To integrals from 0 to each node.
    to_chebyshev : ndarray (NODES, NODES), dimensionless
        To Chebyshev coefficients.
    integral : ndarray (NODES + 1, NODES), dimensionless
        To power coefficients of the integral.
    """
    x = _radau(NODES)
    chebyshev = np.cos(np.arccos(x)[:, None] * np.arange(NODES + 1))
    to_chebyshev = np.linalg.inv(chebyshev[:, :-1])
    integral = 0.5 * _integrals(NODES) @ to_chebyshev
    return 0.5 + 0.5 * x, chebyshev @ integral, to_chebyshev, to_powers(NODES + 1) @ integral


def _radau(count: int) -> np.ndarray:
    """Radau's nodes (count,) of -1 ... 1, the last of them 1.

    The others are zeros of the orthogonal polynomials of the weight 1 - x: eigenvalues of the matrix of their
    recurrence.
    """
    k = np.arange(count - 1.0)
    matrix = np.diag(-1.0 / ((2.0 * k + 1.0) * (2.0 * k + 3.0)))
    matrix += np.diag(np.sqrt(k * (k + 1.0))[1:] / (2.0 * k + 1.0)[1:], -1)
    return np.append(np.linalg.eigvalsh(matrix), 1.0)


def _integrals(count: int) -> np.ndarray:
    """Chebyshev coefficients (count + 1, count) of the integrals from -1 of T_0 ... T_(count - 1)."""
    k = np.arange(1.0, count + 1.0)
    matrix = np.zeros((count + 1, count))
    matrix[1:] = np.diag(0.5 / k)
    matrix[1, 0] = 1.0
    matrix[1:-2, 2:] -= np.diag(0.5 / k[:-2])
    matrix[0] = -((-1.0) ** k) @ matrix[1:]
    return matrix


def _above_mean(energy: np.ndarray, inertia: np.ndarray, mean: float) -> tuple[np.ndarray, np.ndarray]:
    """ω - ω̄ and its derivative by e.

    From ``STANDSTILL`` down it continues as a straight line, so that a solution always exists and stays convex; the
    machine runs if the solution is above.
    """
    square = 1.0 + 2.0 * (energy / mean / mean) / inertia  # (ω/ω̄)²
    root = np.sqrt(np.maximum(square, STANDSTILL))
    rise = np.maximum(square, STANDSTILL) - 1.0
    below = np.minimum(square - STANDSTILL, 0.0)
    return mean * (rise / (1.0 + root) + 0.5 * below / root), 1.0 / (inertia * mean * root)


@np.errstate(over="ignore", invalid="ignore", divide="ignore")  # with a flywheel of nearly 0
def steady_speed(load: LoadCurve, flywheel: float, slope: float, mean: float) -> SpeedCurve | None:
    """Speed that repeats each turn, with a flywheel and a motor of linear characteristic; None where the motor stalls.

    Collocation at Radau's nodes of each panel, all panels at once; Newton's method on the equation itself (each step a
    linear one, closed over the turn). As the equation is convex, the steps rise to the solution from the second one on,
    from any start. Panels whose last coefficients are significant are divided, and the solution is the first guess on
    the new ones.

    load: torque and inertia; flywheel: I [kg m²], positive; slope: k, increase of the motor's torque per decrease of
    the speed [N m s/rad]; mean: ω̄ [rad/s].
    """
    count = load.start.size
    split = slope * TURN < flywheel * mean
    panels = _panels_of(load, np.arange(count), np.zeros(count), np.ones(count), flywheel, split)
    energy = np.zeros_like(panels.load_energy)
    for attempt in range(ROUNDS):
        energy, power = _solve(panels, energy, slope, mean)
        deviation, gain = _above_mean(energy, panels.inertia, mean)
        rough = _unresolved(slope * deviation, load.mean)
        refines = bool(rough.any()) and panels.width.size < MOST_PANELS * count and attempt < ROUNDS - 1
        stalls = (
            not float((1.0 + 2.0 * (energy / mean / mean) / panels.inertia).min()) > STANDSTILL
        )  # NaN counts as stalled
        if not refines or (stalls and attempt):  # stalled on refined panels too
            break
        panels, energy = _divide(load, panels, rough, slope * gain, power, flywheel, split)
    if stalls:
        return None
    start = load.start[panels.parent] + panels.low * load.width[panels.parent]
    return SpeedCurve(start, panels.width, power, load, flywheel, mean)


def _panels_of(
    load: LoadCurve, parent: np.ndarray, low: np.ndarray, share: np.ndarray, flywheel: float, split: bool
) -> _Panels:
    """Parts of the load's panels; split: U is the energy of the torque about its mean, otherwise 0."""
    x, _, _, _ = collocation()
    r = powers((low[:, None] + share[:, None] * x).ravel())
    panel = np.repeat(parent, NODES)
    shape, width = (parent.size, NODES), share * load.width[parent]
    torque = ((load.torque[:, panel] * r).sum(axis=0) - load.mean).reshape(shape)
    inertia = (np.maximum((load.inertia[:, panel] * r).sum(axis=0), 0.0) + flywheel).reshape(
        shape
    )  # no rounding below 0
    if not split:
        return _Panels(parent, low, share, width, torque, inertia, np.zeros(shape), np.zeros((NODES + 1, parent.size)))
    _, integrals, _, integral = collocation()
    work = width[:, None] * (torque @ integrals.T)
    mean = float(work[:, -1].sum()) / TURN
    torque, work = torque - mean, work - mean * width[:, None] * x
    begins = -np.append(0.0, np.cumsum(work[:-1, -1]))
    power = -width * (integral @ torque.T)
    power[0] += begins
    mean_torque = np.full(shape, mean if abs(mean) > ROUNDING * float(np.abs(torque).max()) else 0.0)
    return _Panels(parent, low, share, width, mean_torque, inertia, begins[:, None] - work, power)


def _solve(panels: _Panels, energy: np.ndarray, slope: float, mean: float) -> tuple[np.ndarray, np.ndarray]:
    """E at the nodes (m, NODES), and the coefficients of its powers (NODES + 1, m), from a first guess at the nodes.

    One step: with c = k dω/de, f' = -(T_c - T̄ + U') - k(ω - ω̄)(e₀) - c(f - f₀), which is linear; over a panel that
    begins with b it gives f = b p + q at the nodes, and b follows from panel to panel, closed over the turn. 1 - p at
    the end is computed from the integral of c p, so that no digit is lost where hardly anything decays.
    """
    _, integrals, _, integral = collocation()
    scaled = panels.width[:, None, None] * integrals
    f = energy - panels.load_energy
    for _ in range(ITERATIONS):
        deviation, gain = _above_mean(panels.load_energy + f, panels.inertia, mean)
        rate = slope * gain
        free = rate * f - slope * deviation - panels.torque
        matrix = scaled * rate[:, None, :]
        matrix[:, np.arange(NODES), np.arange(NODES)] += 1.0
        sides = np.stack((np.ones_like(free), np.einsum("mij,mj->mi", scaled, free)), axis=2)
        decay, forced = np.moveaxis(np.linalg.solve(matrix, sides), 2, 0)
        begins = _close_turn(np.einsum("mj,mj->m", scaled[:, -1], rate * decay), forced[:, -1])
        before, f = f, begins[:, None] * decay + forced
        change = f - before
        if float(np.abs(gain * change).max()) <= CLOSE * mean:
            break
    power = panels.width * (integral @ (free - rate * f).T)
    power[0] += begins
    return panels.load_energy + f, panels.power + power


def _close_turn(lost: np.ndarray, gained: np.ndarray) -> np.ndarray:
    """Values (m,) at the begins of the panels, from b → (1 - lost) b + gained per panel, equal after one turn."""
    end, begins, factors = 0.0, [], []
    factor = 1.0
    for loss, gain in zip(lost.tolist(), gained.tolist(), strict=True):
        begins.append(end)
        factors.append(factor)
        end += gain - loss * end
        factor *= 1.0 - loss
    total = -np.expm1(np.log1p(-np.minimum(lost, 1.0 - 1e-16)).sum())
    return np.array(begins) + end / total * np.array(factors)


def _unresolved(torque: np.ndarray, mean: float) -> np.ndarray:
    """Mask (m,) of panels where the last two Chebyshev coefficients of the motor's torque (m, NODES) are significant.

    The torque that a balance cam leaves is rounding relative to the mean, which no panel resolves.
    """
    _, _, to_chebyshev, _ = collocation()
    last = np.abs(torque @ to_chebyshev[-2:].T).max(axis=1)
    return last > RESOLVED * (float(np.abs(torque).max()) + abs(mean))


def _divide(
    load: LoadCurve,
    panels: _Panels,
    rough: np.ndarray,
    rate: np.ndarray,
    power: np.ndarray,
    flywheel: float,
    split: bool,
) -> tuple[_Panels, np.ndarray]:
    """The panels with the rough ones divided, and e at their nodes from the coefficients of its powers on the old ones.

    A rough panel is halved; one with a fast decay is halved towards its start as often as needed, for after a jump of
    the torque the motor follows there.
    """
    depth = np.ceil(np.log2(np.maximum(rate.max(axis=1) * panels.width, 1.0))).astype(int) + 1
    depth = np.where(rough, np.clip(depth, 1, FINEST_HALVING), 0)
    parent = np.repeat(np.arange(depth.size), depth + 1)
    part = np.arange(parent.size) - np.repeat(
        np.cumsum(depth + 1) - depth - 1, depth + 1
    )  # 0 at the start of the old panel
    share = np.where(part == 0, 0.5 ** depth[parent], 0.5 ** (depth[parent] - part + 1.0))
    low = np.where(part == 0, 0.0, share)
    divided = _panels_of(
        load,
        panels.parent[parent],
        panels.low[parent] + low * panels.share[parent],
        share * panels.share[parent],
        flywheel,
        split,
    )
    x, _, _, _ = collocation()
    r = powers((low[:, None] + share[:, None] * x).ravel(), NODES + 1)
    return divided, (power[:, np.repeat(parent, NODES)] * r).sum(axis=0).reshape(-1, NODES)
