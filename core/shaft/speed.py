"""The speed of a camshaft with a flywheel: the periodic solution of the nonlinear equation of motion.

E = ½(I + J_e(θ))ω², dE/dθ = T_m(ω) - T_s(θ), with the motor's T_m = T̄ + k(ω̄ - ω) and the static torque T_s of the load.
The torque that holds the speed constant is T_c = T_s + ½ω̄² J_e', so that the energy above that of the mean speed,
e = E - ½(I + J_e)ω̄², obeys

    e' = k(ω̄ - ω) - (T_c - T̄),    ω = √(ω̄² + 2e/(I + J_e)),

which loses no digit where the speed hardly changes. Where a turn is too short for the motor to follow, e = U + f with the energy U that
the load alone takes and gives back, U' = -(T_c - T̄), and f' = k(ω̄ - ω): beside a torque of any size none of the motor's is lost.
T_c, and so the friction μ|N| in T_s, are those of the mean speed: that |N| itself changes with the speed is left out.
Where J_e jumps, as it does with the motion's velocity only, the impulse is left out as T_c leaves it out.

The right-hand side falls as e grows and is convex in it: there is at most one periodic solution with ω > 0. Where there is
none the machine stalls.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from core.design.parts import LINEAR, Servo
from core.frozen import frozen
from core.motion import TURN
from core.shaft.curve import LoadCurve, by_blocks, placed, powers, to_powers

# -- A servo motor that makes a motion through a gear -----------------------------------------------------------


def lever(servo: Servo) -> float:
    """Motor turns per unit of the motion, as radians per radian or per metre; 1 of a linear motor."""
    return servo.gear_ratio * shaft_lever(servo)


def shaft_lever(servo: Servo) -> float:
    """The same of the output shaft."""
    if servo.kind == LINEAR or servo.travel_mm_per_turn is None:
        return 1.0
    return 2.0 * math.pi / (servo.travel_mm_per_turn * 1e-3)


def moved(servo: Servo) -> float:
    """What the servo moves besides the loads, at the motion [kg or kg m²]."""
    return (servo.mass_kg or 0.0) + (servo.inertia_kg_m2 or 0.0) * shaft_lever(servo) ** 2


@frozen(eq=False)
class MotorLoad:
    """What a motion asks of a motor.

    speed, acceleration  (n,) of the motion by time [m or rad]
    load, friction  (n,) on it, of the design's loads and masses, and of the servo's own friction [N or N m]
    losses  (n,) of the gear, by which force is more than they and the mass of the servo's own ask
    force  (n,) on it without the rotor, with the losses of the gear [N or N m]
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
    """Q = F + m ÿ + F_r sgn ẏ; a gear of efficiency η gives it as Q/η where the load is driven, Q ẏ > 0, and Q η where it brakes.

    force (n,) of the loads [N or N m]; sign (n,) of the velocity, as the segment states it.
    """
    friction = ((servo.friction_n or 0.0) + (servo.friction_nm or 0.0) * shaft_lever(servo)) * sign
    total = force + moved(servo) * acceleration + friction
    losses = np.where(total * speed >= 0.0, 1.0 / servo.efficiency, servo.efficiency)
    return MotorLoad(speed, acceleration, force, friction, losses, total * losses)


def motor_torque(servo: Servo, load: MotorLoad) -> np.ndarray:
    """T = J_r i ÿ + Q/i (n,) [N m; N of a linear motor], i motor turns per unit of the motion.

    References
    ----------
    Balance at the motor.
    """
    i = lever(servo)
    rotor = 0.0 if servo.kind == LINEAR else servo.rotor_inertia_kg_m2
    return np.asarray(rotor * i * load.acceleration + load.force / i)


def best_ratio(servo: Servo, acceleration_squared: float, force_squared: float) -> float:
    """The gear ratio of least rms torque: T² = J_r² i² ÿ² + 2 J_r ÿ Q + Q²/i² has its least mean where i⁴ = ⟨Q²⟩/(J_r² ⟨ÿ²⟩); on
    pure inertia i² = J_load/J_r. Of means over the time of a turn."""
    i = (force_squared / acceleration_squared) ** 0.25 / math.sqrt(servo.rotor_inertia_kg_m2)
    return i / shaft_lever(servo)


# -- the speed of a camshaft with a flywheel --------------------------------------------------------------------


NODES = 10  # of a panel, Radau's: the last one is the panel's end, so that what decays within a panel does so here too
ROUNDING = 1e-12  # of the largest torque: by which the mean may miss
STANDSTILL = 1e-6  # of ω²/ω̄²: below a thousandth of the mean speed the shaft counts as standing still
CLOSE = 1e-7  # of the mean speed: Newton's steps double their digits, so that the one after this is rounding
RESOLVED = 1e-11  # of the motor's torque: what the last coefficients of a panel may hold
ITERATIONS, ROUNDS = 60, 12
MOST_PANELS = 6  # times those of the load
FINEST_HALVING = 40
SAMPLES = 1440  # of a turn, between which extremes of the speed are refined:
TOPS, PARTS, PASSES = 6, 32, 4  # how many of them, into how many parts each side is cut, and how often


@frozen(eq=False)
class SpeedCurve:
    """The speed over one turn.

    start, width  (m,) of the panels [rad], those of the load or parts of them
    energy        (NODES + 1, m) coefficients of r**k, r = (θ - start)/width, of e above [J]
    load          what drives it; flywheel I [kg m²], mean ω̄ [rad/s]
    """

    start: np.ndarray
    width: np.ndarray
    energy: np.ndarray
    load: LoadCurve
    flywheel: float
    mean: float

    def deviation(self, theta: np.ndarray) -> np.ndarray:
        """ω - ω̄ (n,) [rad/s] at any cam angles (n,) [rad]."""
        return by_blocks(self._deviation, theta)

    def _deviation(self, theta: np.ndarray) -> np.ndarray:
        at, r = placed(self.start, self.width, theta)
        energy = (self.energy[:, at] * powers(r, NODES + 1)).sum(axis=0)
        at, r = placed(self.load.start, self.load.width, theta)
        inertia = self.flywheel + np.maximum((self.load.inertia[:, at] * powers(r)).sum(axis=0), 0.0)
        deviation, _ = _above_mean(energy, inertia, self.mean)
        return deviation


def deviation_range(speed: SpeedCurve) -> tuple[float, float]:
    """The least and the greatest ω - ω̄ over the turn [rad/s]: samples, of which the highest few are closed in on."""
    theta = np.arange(SAMPLES) * (TURN / SAMPLES)
    deviation = speed.deviation(theta)
    lowest = -_highest(lambda at: -speed.deviation(at), theta, -deviation)
    return lowest, _highest(speed.deviation, theta, deviation)


def speed_fluctuation(speed: SpeedCurve) -> float:
    """(ω_max - ω_min)/ω̄ over the turn."""
    low, high = deviation_range(speed)
    return (high - low) / speed.mean


def _highest(function: Callable[[np.ndarray], np.ndarray], theta: np.ndarray, value: np.ndarray) -> float:
    """The greatest value of a periodic function with samples (n,), kinks included."""
    tops = np.flatnonzero((value > np.roll(value, 1)) & (value >= np.roll(value, -1)))
    place, reach, best = theta[tops[np.argsort(value[tops])[-TOPS:]]], TURN / SAMPLES, float(value.max())
    for _ in range(PASSES if place.size else 0):
        closer = place[:, None] + reach * np.linspace(-1.0, 1.0, 2 * PARTS + 1)
        values = function(np.mod(closer.ravel(), TURN)).reshape(closer.shape)
        place, reach = closer[np.arange(place.size), np.argmax(values, axis=1)], reach / PARTS
        best = max(best, float(values.max()))
    return best


@frozen(eq=False)
class _Panels:
    """Parts of the load's panels and what the load is at their nodes.

    parent, low, share  (m,) panel of the load; where in it the part begins, and how much of it the part is, 0...1
    width               (m,) [rad]
    torque, inertia     (m, NODES) T_c - T̄ [N m] without what U takes, I + J_e [kg m²]
    given               (m, NODES) U at the nodes [J], and ``power`` (NODES + 1, m) the coefficients of its powers
    """

    parent: np.ndarray
    low: np.ndarray
    share: np.ndarray
    width: np.ndarray
    torque: np.ndarray
    inertia: np.ndarray
    given: np.ndarray
    power: np.ndarray


@lru_cache(maxsize=1)
def collocation() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Radau's nodes x of 0...1, the last of them 1; from values at them (NODES,): their integrals from 0 to each node,
    their Chebyshev coefficients, and the power coefficients (NODES + 1,) of the integral."""
    x = _radau(NODES)
    chebyshev = np.cos(np.arccos(x)[:, None] * np.arange(NODES + 1))
    to_chebyshev = np.linalg.inv(chebyshev[:, :-1])
    integral = 0.5 * _integrals(NODES) @ to_chebyshev
    return 0.5 + 0.5 * x, chebyshev @ integral, to_chebyshev, to_powers(NODES + 1) @ integral


def _radau(count: int) -> np.ndarray:
    """Radau's nodes (count,) of -1 ... 1, the last of them 1: the others are zeros of the polynomials that are orthogonal with
    the weight 1 - x, eigenvalues of the matrix of their recurrence."""
    k = np.arange(count - 1.0)
    matrix = np.diag(-1.0 / ((2.0 * k + 1.0) * (2.0 * k + 3.0)))
    matrix += np.diag(np.sqrt(k * (k + 1.0))[1:] / (2.0 * k + 1.0)[1:], -1)
    return np.append(np.linalg.eigvalsh(matrix), 1.0)


def _integrals(count: int) -> np.ndarray:
    """Chebyshev coefficients (count + 1, count) of the integrals from -1 of T_0 ... T_(count - 1)."""
    k = np.arange(1.0, count + 1.0)
    out = np.zeros((count + 1, count))
    out[1:] = np.diag(0.5 / k)
    out[1, 0] = 1.0
    out[1:-2, 2:] -= np.diag(0.5 / k[:-2])
    out[0] = -((-1.0) ** k) @ out[1:]
    return out


def _above_mean(energy: np.ndarray, inertia: np.ndarray, mean: float) -> tuple[np.ndarray, np.ndarray]:
    """ω - ω̄ and its derivative by e. From ``STANDSTILL`` down it goes on as a straight line: so there is a solution
    always, convex as it was, and the machine runs if it keeps above."""
    square = 1.0 + 2.0 * (energy / mean / mean) / inertia  # (ω/ω̄)²
    root = np.sqrt(np.maximum(square, STANDSTILL))
    rise = np.maximum(square, STANDSTILL) - 1.0
    beyond = np.minimum(square - STANDSTILL, 0.0)
    return mean * (rise / (1.0 + root) + 0.5 * beyond / root), 1.0 / (inertia * mean * root)


@np.errstate(over="ignore", invalid="ignore", divide="ignore")  # with a flywheel that is next to nothing
def steady_speed(load: LoadCurve, flywheel: float, slope: float, mean: float) -> SpeedCurve | None:
    """The speed that repeats each turn, about ω̄ = mean [rad/s], with a flywheel I [kg m²] > 0 and a motor that gives
    slope k [N m s/rad] more per rad/s of lost speed; None where there is none: the motor stalls.

    Collocation at Radau's nodes of each panel, all panels at once; Newton's method on the equation itself (each step a
    linear one, closed over the turn). The equation being convex, the steps rise to the solution from the second one on,
    wherever they begin. Panels whose last coefficients still count are cut, and the solution so far is the first guess on
    the new ones.
    """
    count = load.start.size
    apart = slope * TURN < flywheel * mean
    panels = _parts(load, np.arange(count), np.zeros(count), np.ones(count), flywheel, apart)
    energy = np.zeros_like(panels.given)
    for attempt in range(ROUNDS):
        energy, power = _solved(panels, energy, slope, mean)
        deviation, gain = _above_mean(energy, panels.inertia, mean)
        rough = _unresolved(slope * deviation, load.mean)
        more = bool(rough.any()) and panels.width.size < MOST_PANELS * count and attempt < ROUNDS - 1
        stalls = not float((1.0 + 2.0 * (energy / mean / mean) / panels.inertia).min()) > STANDSTILL  # nan is no speed
        if not more or (stalls and attempt):  # a second solution, finer where it matters
            break
        panels, energy = _cut(load, panels, rough, slope * gain, power, flywheel, apart)
    if stalls:
        return None
    start = load.start[panels.parent] + panels.low * load.width[panels.parent]
    return SpeedCurve(start, panels.width, power, load, flywheel, mean)


def _parts(
    load: LoadCurve, parent: np.ndarray, low: np.ndarray, share: np.ndarray, flywheel: float, apart: bool
) -> _Panels:
    """apart: U is the energy of the torque about its mean, which is 0 but for rounding; else U is 0."""
    x, _, _, _ = collocation()
    r = powers((low[:, None] + share[:, None] * x).ravel())
    at = np.repeat(parent, NODES)
    shape, width = (parent.size, NODES), share * load.width[parent]
    torque = ((load.torque[:, at] * r).sum(axis=0) - load.mean).reshape(shape)
    inertia = (np.maximum((load.inertia[:, at] * r).sum(axis=0), 0.0) + flywheel).reshape(shape)  # no rounding below 0
    if not apart:
        return _Panels(parent, low, share, width, torque, inertia, np.zeros(shape), np.zeros((NODES + 1, parent.size)))
    _, integrals, _, integral = collocation()
    taken = width[:, None] * (torque @ integrals.T)
    mean = float(taken[:, -1].sum()) / TURN
    torque, taken = torque - mean, taken - mean * width[:, None] * x
    begins = -np.append(0.0, np.cumsum(taken[:-1, -1]))
    power = -width * (integral @ torque.T)
    power[0] += begins
    left = np.full(shape, mean if abs(mean) > ROUNDING * float(np.abs(torque).max()) else 0.0)
    return _Panels(parent, low, share, width, left, inertia, begins[:, None] - taken, power)


def _solved(panels: _Panels, energy: np.ndarray, slope: float, mean: float) -> tuple[np.ndarray, np.ndarray]:
    """e at the nodes (m, NODES), and the coefficients of its powers (NODES + 1, m), from a first guess at the nodes.

    One step: with c = k dω/de, f' = -(T_c - T̄ + U') - k(ω - ω̄)(e₀) - c(f - f₀), which is linear; over a panel that begins
    with b it gives f = b p + q at the nodes, and b follows from panel to panel, closed over the turn. 1 - p at the end is
    taken from the integral of c p, so that no digit is lost where hardly anything decays.
    """
    _, integrals, _, integral = collocation()
    scaled = panels.width[:, None, None] * integrals
    kept = energy - panels.given
    for _ in range(ITERATIONS):
        deviation, gain = _above_mean(panels.given + kept, panels.inertia, mean)
        rate = slope * gain
        free = rate * kept - slope * deviation - panels.torque
        matrix = scaled * rate[:, None, :]
        matrix[:, np.arange(NODES), np.arange(NODES)] += 1.0
        sides = np.stack((np.ones_like(free), np.einsum("mij,mj->mi", scaled, free)), axis=2)
        decay, forced = np.moveaxis(np.linalg.solve(matrix, sides), 2, 0)
        begins = _closed(np.einsum("mj,mj->m", scaled[:, -1], rate * decay), forced[:, -1])
        before, kept = kept, begins[:, None] * decay + forced
        change = kept - before
        if float(np.abs(gain * change).max()) <= CLOSE * mean:
            break
    power = panels.width * (integral @ (free - rate * kept).T)
    power[0] += begins
    return panels.given + kept, panels.power + power


def _closed(lost: np.ndarray, gained: np.ndarray) -> np.ndarray:
    """Where each panel begins (m,), of b → (1 - lost) b + gained from panel to panel, so that the turn ends as it began."""
    end, begins, kept = 0.0, [], []
    whole = 1.0
    for less, more in zip(lost.tolist(), gained.tolist(), strict=True):
        begins.append(end)
        kept.append(whole)
        end += more - less * end
        whole *= 1.0 - less
    total = -np.expm1(np.log1p(-np.minimum(lost, 1.0 - 1e-16)).sum())
    return np.array(begins) + end / total * np.array(kept)


def _unresolved(torque: np.ndarray, mean: float) -> np.ndarray:
    """Panels (m,) whose last two Chebyshev coefficients, of the motor's torque (m, NODES) about its mean, still count. What a
    balance cam leaves is rounding against the mean, and no panel resolves it."""
    _, _, to_chebyshev, _ = collocation()
    last = np.abs(torque @ to_chebyshev[-2:].T).max(axis=1)
    return last > RESOLVED * (float(np.abs(torque).max()) + abs(mean))


def _cut(
    load: LoadCurve,
    panels: _Panels,
    rough: np.ndarray,
    rate: np.ndarray,
    power: np.ndarray,
    flywheel: float,
    apart: bool,
) -> tuple[_Panels, np.ndarray]:
    """The panels with the rough ones cut, and e at their nodes by the coefficients of its powers on the old ones.

    A rough panel is halved; one in which much decays is halved towards its start as often as that takes, for there, past
    a jump of the torque, the motor comes after it.
    """
    depth = np.ceil(np.log2(np.maximum(rate.max(axis=1) * panels.width, 1.0))).astype(int) + 1
    depth = np.where(rough, np.clip(depth, 1, FINEST_HALVING), 0)
    old = np.repeat(np.arange(depth.size), depth + 1)
    part = np.arange(old.size) - np.repeat(
        np.cumsum(depth + 1) - depth - 1, depth + 1
    )  # 0 at the start of the old panel
    share = np.where(part == 0, 0.5 ** depth[old], 0.5 ** (depth[old] - part + 1.0))
    low = np.where(part == 0, 0.0, share)
    made = _parts(
        load, panels.parent[old], panels.low[old] + low * panels.share[old], share * panels.share[old], flywheel, apart
    )
    x, _, _, _ = collocation()
    r = powers((low[:, None] + share[:, None] * x).ravel(), NODES + 1)
    return made, (power[:, np.repeat(old, NODES)] * r).sum(axis=0).reshape(-1, NODES)
