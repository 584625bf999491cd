"""The periodic coefficients of a flexible camshaft, those of its Hill equations, and their Fourier coefficients.

The first follow from the energies of the whole mechanism in closed form (Kim1990 §3).

Lagrange's equation of the cam, whose mechanism has the kinetic energy J θ̇²/2 and the potential energy V, both functions of
its angle: (I_c + J) θ̈ + J' θ̇²/2 + V' = K_s (θ_i - θ). Divided by I_c ω² and with Q = max J / I_c it is Kim1990 (13),
whose single mass M_v is the case J = M_v X'²:

    D = 1 + Q d,  d = J / max J,    C = d'/2 (X'X''/X'm²),    κ = C',    Q U = V' / (I_c ω²),    ψ = U'.

Friction is left out: it would not be analytic, and Kim1990 has none.

The linear equations whose stability is computed are ζ'' + (η² w + p) 4π² ζ = 0, a dot-less ' by y = θ_i/2π, before damping.

Fourier coefficients c_k = (1/2π) ∫ f e^{-ikθ} dθ to any order: the polynomial of each panel is integrated exactly (Filon's
idea). On a panel of half width h around θ0 that needs the integrals of the polynomials times e^{-ikhx} over x = -1 ... 1
alone, and jumps at the ends of panels cost nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from core.dynamics import Loading
from core.errors import NoStability
from core.frozen import frozen
from core.mechanism.kinematics import Kinematics
from core.motion import TURN, Angles, CompiledMotion
from core.motion.extremes import find_extremes, find_highest
from core.numerics.derivatives import Derivatives
from core.numerics.lazy import Lazy
from core.numerics.roots import gauss_legendre, legendre
from core.stability.panels import NODES, Panels, fit, to_legendre

# -- the periodic coefficients of a flexible camshaft, those of its Hill equations, and their -------------------


FIXED, RETUNED = "fixed", "retuned"
INERTIA, CENTRIPETAL, LOAD, CURVATURE, LOAD_SLOPE = range(5)  # rows of the panels: d, C, U, κ, ψ

KinematicsAt = Callable[[Angles], Kinematics]


class MotionSizes(NamedTuple):
    """Those of ``Sizes`` that are the motion's."""

    stroke: float
    slope: float
    curvature: float
    lowest: float


@frozen(eq=False)
class Sizes:
    """What the coefficients are measured in.

    inertia  max J [kg m²] over the turn
    motion   searched when it is read:
    stroke, slope, curvature   X_m, X'_m, X''_m: stroke and largest |y'|, |y''| [m or rad]
    lowest   least y: where Kim1990's valve spring is at rest
    """

    inertia: float
    motion: Lazy[MotionSizes] = Lazy()

    @property
    def stroke(self) -> float:
        return self.motion.stroke

    @property
    def slope(self) -> float:
        return self.motion.slope

    @property
    def curvature(self) -> float:
        return self.motion.curvature

    @property
    def lowest(self) -> float:
        return self.motion.lowest


NO_SIZES = Sizes(0.0, MotionSizes(1.0, 1.0, 0.0, 0.0))


@frozen(eq=False)
class Coefficients:
    """d, C, U, κ, ψ over one turn (rows of ``panels``) for the machine's own Q.

    spring  ``retuned``: U of Kim1990's valve spring, which is made anew for each speed, K_v = a M_v X''m ω²/X_m;
            ``fixed``: the design's own loads; then U and ψ are to be multiplied by η² (U = V'/(K_s Q))
    q       Q of the machine, max J / I_c; for another Q all that the cam moves, masses and loads, is made so much heavier
    """

    panels: Panels
    sizes: Sizes
    spring: str
    q: float

    @property
    def fixed(self) -> bool:
        """Whether the spring stiffness is fixed along the chart."""
        return self.spring == FIXED


def is_dwell(panels: Panels) -> np.ndarray:
    """True (m,) where nothing moves: D = 1 and C = ψ = 0 on the whole panel."""
    return np.asarray(~panels.values.any(axis=(0, 2)))


@frozen(eq=False)
class DrivenMechanism:
    """One of the mechanisms that a shaft drives.

    kinematics_at  its kinematics at any of its own angles
    program        what drives it: pieces and joins by its own angle
    own            its own angles at those of the shaft, and +1, or -1 where they fall as the shaft turns
    path           of its tables in the file: ``drives[1].``
    """

    kinematics_at: KinematicsAt
    loading: Loading
    program: CompiledMotion
    own: Callable[[Angles], Angles] = lambda angles: angles
    sense: float = 1.0
    path: str = ""


def sizes(kinematics_at: KinematicsAt, loading: Loading, program: CompiledMotion) -> Sizes:
    """The refined extremes. Raises NoStability where nothing moves or nothing that moves has mass."""

    found = Sizes(
        find_highest(lambda angles: {"": loading.inertia(kinematics_at(angles), 1)[0]}, program)[""].value,
        lambda: _motion_sizes(program),
    )
    if found.inertia > 0.0:
        return found
    if not found.stroke > 0.0:
        raise NoStability("nothing moves, so nothing excites the shaft", "motion.segments", "give a segment that rises")
    raise NoStability("nothing that moves has mass, so nothing excites the shaft", "loads", "give the moved masses")


def _motion_sizes(program: CompiledMotion) -> MotionSizes:
    def quantities(angles: Angles) -> dict[str, np.ndarray]:
        y = program.state(angles).displacement
        return {"y": y[0], "slope": np.abs(y[1]), "curvature": np.abs(y[2])}

    found = find_extremes(quantities, program)
    y, (slope, curvature) = found["y"], (found[name].high.value for name in ("slope", "curvature"))
    return MotionSizes(y.high.value - y.low.value, slope, curvature, y.low.value)


def coefficients(
    kinematics_at: KinematicsAt,
    loading: Loading,
    program: CompiledMotion,
    camshaft_inertia: float,
    stiffness: float,
    spring: str,
    spring_factor: float,
) -> Coefficients:
    """The coefficients of a machine; I_c [kg m²], K_s [N m/rad].

    Raises NoStability where nothing with mass moves, or where the velocity jumps: a blow that no shaft survives.
    """
    driven = (DrivenMechanism(kinematics_at, loading, program),)
    return coefficients_of_all(driven, program, camshaft_inertia, stiffness, spring, spring_factor)


def coefficients_of_all(
    driven: Sequence[DrivenMechanism],
    turn: Any,
    camshaft_inertia: float,
    stiffness: float,
    spring: str,
    spring_factor: float,
) -> Coefficients:
    """The same of all that one shaft drives: J(θ) = Σ J_i, V = Σ V_i, each by its own angle; turn: pieces of the shaft's turn (starts,
    ends), in none of which one of them has a join."""
    for each in driven:
        _require_no_blow(each)
        if spring != RETUNED:
            _require_even_load(each)
    own = _sizes_of_each(driven)
    size = own[0] if len(driven) == 1 else _of_all(max(own, key=lambda s: s.inertia), _most_inertia(driven, turn))
    q = size.inertia / camshaft_inertia
    heaviest = max(1.0, 2.0 * q)

    def functions(angles: Angles) -> np.ndarray:
        inertia, load = np.zeros((3, angles.theta.size)), np.zeros((2, angles.theta.size))
        for each, part in zip(driven, own, strict=True):
            kinematics = each.kinematics_at(each.own(angles))
            by_shaft = np.array([[1.0], [each.sense], [1.0]])  # of a function and its derivatives
            inertia += each.loading.inertia(kinematics) * by_shaft
            if spring == RETUNED:
                u = _valve_spring(kinematics.motion.displacement, part, spring_factor) * (part.inertia / size.inertia)
            else:
                u = each.loading.potential(kinematics) / (stiffness * q)
            load += u * by_shaft[1:]
        d, d1, d2 = inertia / size.inertia
        # the last ones only see to panels on which the quotients of the Hill equation are polynomials too
        big = 1.0 + heaviest * d
        return np.array([d, 0.5 * d1, load[0], 0.5 * d2, load[1], 1.0 / big, load[1] / big, (heaviest * d1 / big) ** 2])

    return Coefficients(fit(functions, turn, 5), size, spring, q)


def _require_no_blow(driven: DrivenMechanism) -> None:
    joins = driven.program.joins
    for i, join in enumerate(joins):
        if join.jumps[0] or join.jumps[1]:
            field = f"{driven.path}motion.segments[{(i + 1) % len(joins)}]"
            at = float(np.rad2deg(join.theta))
            raise NoStability("the velocity jumps, a blow on the shaft", field, "mend the join", [(at, at)])


EVEN = 1e-9  # of the largest V': a jump below it is rounding


def _require_even_load(driven: DrivenMechanism) -> None:
    """Raises NoStability where a force of the process switches while its point moves: V' jumps, and V'' is infinite there."""
    program, pieces = driven.program, np.arange(driven.program.starts.size)
    if driven.loading.cuts(program).size == 0:
        return
    before, after = (
        driven.loading.potential(driven.kinematics_at(Angles(at, pieces)))[0] for at in (program.ends, program.starts)
    )
    jump = np.abs(np.roll(after, -1) - before)
    worst = int(jump.argmax())
    if jump[worst] > EVEN * float(np.abs(before).max()):
        at = float(np.rad2deg(np.mod(program.ends[worst], TURN)))
        problem = "a force of the process switches while what it acts on moves, a blow on the shaft"
        raise NoStability(problem, f"{driven.path}loads.process", "switch it in a dwell", [(at, at)])


def own_sizes(driven: DrivenMechanism) -> Sizes:
    """Those of one of several; without inertia where nothing of it moves, or nothing that moves has mass."""
    try:
        return sizes(driven.kinematics_at, driven.loading, driven.program)
    except NoStability:
        return NO_SIZES


def _sizes_of_each(driven: Sequence[DrivenMechanism]) -> list[Sizes]:
    """Of those that move and have mass; of several drives some may not. Raises NoStability where none does."""
    found: list[Sizes] = []
    errors: list[NoStability] = []
    for each in driven:
        try:
            found.append(sizes(each.kinematics_at, each.loading, each.program))
        except NoStability as error:
            errors.append(NoStability(error.problem, f"{each.path}{error.field}", error.hint))
            found.append(NO_SIZES)
    if len(errors) == len(driven):
        raise errors[0]
    return found


def _of_all(heaviest: Sizes, inertia: float) -> Sizes:
    return Sizes(inertia, lambda: heaviest.motion)


def _most_inertia(driven: Sequence[DrivenMechanism], turn: Any) -> float:
    """Refined max J of all together [kg m²]."""

    def inertia(angles: Angles) -> dict[str, np.ndarray]:
        return {
            "": np.asarray(sum(each.loading.inertia(each.kinematics_at(each.own(angles)), 1)[0] for each in driven))
        }

    return find_highest(inertia, turn)[""].value


def _valve_spring(y: Derivatives, size: Sizes, factor: float) -> np.ndarray:
    """U = a X''m X X'/(X_m X'm²) and ψ = U' (2, n), X counted from its lowest place (Kim1990 (7), (13))."""
    x = y[0] - size.lowest
    gain = factor * size.curvature / (size.stroke * size.slope**2)
    return gain * np.array([x * y[1], y[1] * y[1] + x * y[2]])


# -- Hill equations ------------------------------------------------------------------------------------------


EXACT, APPROXIMATE = "exact_21", "approx_22"

EQUATIONS: Mapping[str, str] = MappingProxyType(
    {EXACT: "Linearised, exact (21)", APPROXIMATE: "Linearised, approximate (22)"}
)
"""The linear equations and what they are called: Kim1990 (21); (22) with X''X for its X''X'', where D → 1 and C is dropped,
which is not consistent to first order in Q."""


def inertia_and_pull(
    coefficients: Coefficients, equation: str, q: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """D, Q C and Q ψ (rows, m, NODES) for Q (rows,); with a fixed spring Q ψ is still to be multiplied by η²."""
    rows = coefficients.panels.values
    q = np.asarray(q, dtype=float)[:, None, None]
    pull = q * rows[LOAD_SLOPE]
    if equation == APPROXIMATE:
        return np.ones_like(pull), np.zeros_like(pull), pull
    return 1.0 + q * rows[INERTIA], q * rows[CENTRIPETAL], pull


def weight_and_potential(coefficients: Coefficients, equation: str, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """w and p (rows, m, NODES) of ζ'' + 4π²(η² w + p) ζ = 0, ζ = √D β.

    (21): w = 1/D, p = Qψ/D + (QC/D)²; a fixed spring, whose ψ = η² ψ1: w = (1 + Qψ1)/D, p = (QC/D)².
    """
    d, c, pull = inertia_and_pull(coefficients, equation, q)
    speed = (c / d) ** 2
    if coefficients.fixed:
        return (1.0 + pull) / d, speed
    return 1.0 / d, pull / d + speed


# -- Fourier coefficients ------------------------------------------------------------------------------------

MOST_KEPT = 2_000_000  # entries of a matrix that is kept, 32 MB
SAME = 4e-15  # [rad]
BLOCK = 64  # panels that are worked on at once where there are so many that none is kept


def _weights(start: np.ndarray, width: np.ndarray, highest: int) -> np.ndarray:
    """Of panels with starts and widths (m,): (highest + 1, m NODES).

    Of a polynomial through the nodes of a panel -1 ... 1 the integral with e^{-izx}, z = k width/2, by as many points of
    Gauss and Legendre as leave rounding alone.
    """
    k = np.arange(highest + 1)
    half = 0.5 * width
    widths = np.sort(half)  # panels come in few widths, but for rounding
    widths = widths[np.diff(widths, prepend=-1.0) > SAME]
    at = np.searchsorted(widths, half, side="right") - 1
    z = k[:, None] * widths
    pairs = math.ceil(0.5 * gauss_points(float(z.max())))  # of points x and -x, which share cosines and sines
    x, gauss = gauss_legendre(2 * pairs)
    between = legendre(x, NODES).T @ to_legendre(NODES)  # the value at x of what is 1 at one node
    between *= 0.5 * gauss[:, None]
    ahead, behind = between[pairs:], between[:pairs][::-1]
    angle = z[..., None] * x[pairs:]
    by_node = np.cos(angle) @ (ahead + behind) - 1j * (np.sin(angle) @ (ahead - behind))  # (k, widths, node)
    shift = np.exp(-1j * k[:, None] * (start + half)) * (2.0 * half / TURN)
    return np.ascontiguousarray((by_node[:, at] * shift[..., None]).reshape(k.size, -1))


def gauss_points(z: float) -> int:
    """How many points integrate a polynomial of the panels times e^{izx}: the part of degree d of the latter is |j_d(z)|,
    below 1e-17 from d = z + 12 z^(1/3) + 20 on."""
    return math.ceil(0.5 * (NODES + z + 12.0 * z ** (1.0 / 3.0) + 20.0))


@lru_cache(maxsize=4)
def _kept(panels: Panels) -> list[np.ndarray]:
    """The largest of these matrices so far, which holds the others."""
    return []


def fourier(panels: Panels, values: np.ndarray, highest: int) -> np.ndarray:
    """c_0 ... c_highest (..., highest + 1) of functions given at the nodes (..., m, NODES); c_-k is the conjugate.

    Exact for the panel's polynomials: what these leave of the function stands in ``truncation``. The matrix is kept for the
    next row of a chart, where it is not larger than ``MOST_KEPT``.
    """
    enough = 64
    while enough < highest:
        enough *= 2
    if (enough + 1) * panels.count * NODES <= MOST_KEPT:
        flat = values.reshape(*values.shape[:-2], -1)
        kept = _kept(panels)
        if not kept or kept[0].shape[0] <= highest:
            kept[:] = [_weights(panels.start, panels.width, enough)]
        return flat @ kept[0][: highest + 1].T
    out = np.zeros((*values.shape[:-2], highest + 1), dtype=complex)
    for first in range(0, panels.count, BLOCK):
        some = slice(first, first + BLOCK)
        flat = values[..., some, :].reshape(*values.shape[:-2], -1)
        out += flat @ _weights(panels.start[some], panels.width[some], highest).T
    return out


def truncation(panels: Panels, values: np.ndarray) -> np.ndarray:
    """What the panels' polynomials leave of functions (..., m, NODES), as the mean of |last Legendre coefficients|: no
    Fourier coefficient is wrong by more."""
    last = np.abs(values @ to_legendre(NODES)[-2:].T).sum(axis=-1)
    return last @ panels.width / TURN


# -- harmonic balance as matrices -------------------------------------------------------------------------------


@frozen(eq=False)
class Basis:
    """Harmonics from ``first`` to ``last``: cos(number θ) of the numbers ``cosines``, then sin of ``sines``; orthonormal
    in the mean over a turn, or two where the numbers are halves."""

    cosines: np.ndarray
    sines: np.ndarray

    @property
    def numbers(self) -> np.ndarray:
        """(n,) of all of them."""
        return np.concatenate((self.cosines, self.sines))


@lru_cache(maxsize=128)
def basis(first: int, last: int, half: bool) -> Basis:
    """Harmonics above ``first`` (-1: the constant too) up to ``last``; halves: first + 1/2 ... last - 1/2."""
    if half:
        numbers = np.arange(max(first, 0), last) + 0.5
        return Basis(numbers, numbers)
    numbers = np.arange(first + 1, last + 1).astype(float)
    return Basis(numbers, numbers[numbers > 0.0])


@frozen(eq=False)
class _Parts:
    """An entry of a block is the sum of two coefficients, c_|i-j| and c_{i+j}, real or imaginary parts: where they stand in
    (Re c, Im c), and with which weights."""

    minus: np.ndarray
    plus: np.ndarray
    of_minus: np.ndarray
    of_plus: np.ndarray


@lru_cache(maxsize=128)
def _parts(left: Basis, right: Basis, count: int) -> _Parts:
    """For ``count`` coefficients."""
    i, j = left.numbers[:, None], right.numbers
    sine, other = (np.arange(b.numbers.size) >= b.cosines.size for b in (left, right))
    mixed = sine[:, None] != other
    half_root = np.sqrt(0.5)
    scale = np.where(i == 0.0, half_root, 1.0) * np.where(j == 0.0, half_root, 1.0)
    across = np.where(sine[:, None], np.sign(j - i), -np.sign(j - i))
    return _Parts(
        np.abs(i - j).astype(int) + count * mixed,
        (i + j).astype(int) + count * mixed,
        np.where(mixed, across, 1.0) * scale,
        np.where(sine[:, None] | other, -1.0, 1.0) * scale,
    )


def product(c: np.ndarray, left: Basis, right: Basis) -> np.ndarray:
    """Matrices (..., left, right) of multiplying by functions with Fourier coefficients c (..., order + 1).

    <cos i, f cos j> = Re(c_{i-j} + c_{i+j}), <sin i, f sin j> = Re(c_{i-j} - c_{i+j}), <cos i, f sin j> = -Im(c_{j-i} + c_{i+j}).
    """
    at = _parts(left, right, c.shape[-1])
    both = np.concatenate((c.real, c.imag), axis=-1)
    out = both.take(at.minus, axis=-1)
    out *= at.of_minus
    more = both.take(at.plus, axis=-1)
    more *= at.of_plus
    out += more
    return out


def toeplitz(c: np.ndarray, size: int) -> np.ndarray:
    """Hermitian matrix (size, size) of multiplying by a function with Fourier coefficients c (size or more,), by exponentials."""
    apart = np.arange(size)[:, None] - np.arange(size)
    return np.asarray(np.where(apart >= 0, c[np.abs(apart)], c[np.abs(apart)].conj()))


# -- Kim1990's own matrices: (27), (28) without their misprints, with harmonics -5 ... 5 whichever the period is -----

KIM_ORDER = 5  # 11 x 11


def kim_matrix(coefficients: Coefficients, q: float, half: bool) -> np.ndarray:
    """The Hermitian matrix (11, 11) whose eigenvalues are the η² at which the determinant |K| of (32) vanishes: ρ_r and G_k
    without η². For γ = jπ (half) the harmonics are r + 1/2, one more above than below."""
    r = np.arange(-KIM_ORDER, KIM_ORDER + 1) + (0.5 if half else 0.0)
    c = q * fourier(coefficients.panels, coefficients.panels.values[LOAD_SLOPE], 2 * KIM_ORDER)
    return np.diag(r * r).astype(complex) - toeplitz(c, r.size)


def kim_edges(coefficients: Coefficients, q: float, count: int = 2 * KIM_ORDER - 1) -> np.ndarray:
    """Edges (count, 2) of the tongues 1 ... count, count ≤ 11, as Kim1990 Fig. 8 has them: each pair of eigenvalues one
    tongue; nan where an eleventh value is left without a second."""
    whole, half = (np.sqrt(np.maximum(np.linalg.eigvalsh(kim_matrix(coefficients, q, g)), 0.0)) for g in (False, True))
    values = [np.append(half if n % 2 else whole, np.nan) for n in range(1, count + 1)]
    return np.array([row[n - 1 : n + 1] for n, row in enumerate(values, 1)])
