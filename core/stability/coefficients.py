"""Periodic coefficients of a flexible camshaft and of its Hill equations, with their Fourier coefficients.

The first follow in closed form from the energies of the complete mechanism (Kim1990 §3).

Lagrange's equation of the cam, whose mechanism has the kinetic energy J θ̇²/2 and the potential energy V, both
functions of
the cam angle, is (I_c + J) θ̈ + J' θ̇²/2 + V' = K_s (θ_i - θ). Divided by I_c ω² and with Q = max J / I_c it is
Kim1990 (13), whose single mass M_v is the case J = M_v X'²:

    D = 1 + Q d,  d = J / max J,    C = d'/2 (X'X''/X'm²),    κ = C',    Q U = V' / (I_c ω²),    ψ = U'.

Friction is left out: it would not be analytic, and Kim1990 has none.

The linear equations whose stability is computed are ζ'' + (η² w + p) 4π² ζ = 0, a prime denoting d/dy, y = θ_i/2π,
without
damping.

Fourier coefficients c_k = (1/2π) ∫ f e^{-ikθ} dθ to any order: the polynomial of each panel is integrated exactly
(Filon's
method). A panel of half width h around θ0 only needs the integrals of the polynomials times e^{-ikhx} over x = -1 ...
1,
and jumps at the ends of panels are exact.
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

# -- periodic coefficients -----------------------------------------------------------------------------------

FIXED, RETUNED = "fixed", "retuned"
INERTIA, CENTRIPETAL, LOAD, CURVATURE, LOAD_SLOPE = range(5)  # rows of the panels: d, C, U, κ, ψ

KinematicsAt = Callable[[Angles], Kinematics]


class MotionSizes(NamedTuple):
    """Scales of a motion: X_m, X'_m, X''_m and the lowest position."""

    stroke: float
    slope: float
    curvature: float
    lowest: float


@frozen(eq=False)
class Sizes:
    """Scales of the coefficients.

    Attributes
    ----------
    inertia : float
        max J [kg m²] over the turn.
    motion : MotionSizes
        Computed at the first access.
    stroke, slope, curvature : float
        X_m, X'_m, X''_m: stroke and largest |y'|, |y''| [m or rad].
    lowest : float
        Least y [m or rad], where Kim1990's valve spring is unloaded.
    """

    inertia: float
    motion: Lazy[MotionSizes] = Lazy()

    @property
    def stroke(self) -> float:
        """Stroke X_m [m or rad]."""
        return self.motion.stroke

    @property
    def slope(self) -> float:
        """Largest |y'|, X'_m [m or rad]."""
        return self.motion.slope

    @property
    def curvature(self) -> float:
        """Largest |y''|, X''_m [m or rad]."""
        return self.motion.curvature

    @property
    def lowest(self) -> float:
        """Least y [m or rad]."""
        return self.motion.lowest


NO_SIZES = Sizes(0.0, MotionSizes(1.0, 1.0, 0.0, 0.0))


@frozen(eq=False)
class Coefficients:
    """Coefficients d, C, U, κ, ψ over one turn, the rows of `panels`, for the machine's own Q.

    Attributes
    ----------
    panels : Panels
    sizes : Sizes
    spring : str
        `retuned`: U of Kim1990's valve spring, which is designed for each speed, K_v = a M_v X''m ω²/X_m.
        `fixed`: the design's own loads; U and ψ are then multiplied by η² (U = V'/(K_s Q)).
    q : float
        Q of the machine, max J / I_c. A different Q scales all masses and loads that the cam moves.
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
    """Panels on which nothing moves: D = 1 and C = ψ = 0.

    Returns
    -------
    ndarray (m,) of bool, dimensionless
    """
    return np.asarray(~panels.values.any(axis=(0, 2)))


@frozen(eq=False)
class DrivenMechanism:
    """A mechanism that the shaft drives.

    Attributes
    ----------
    kinematics_at : callable
        Its kinematics at its own angles.
    loading : Loading
    program : CompiledMotion
        Its motion: pieces and joins by its own angle.
    own : callable
        Its own angles at angles of the shaft.
    rotation_sign : float
        +1, or -1 where its own angle falls as the shaft rotates.
    path : str
        Prefix of its fields in the file: `drives[1].`
    """

    kinematics_at: KinematicsAt
    loading: Loading
    program: CompiledMotion
    own: Callable[[Angles], Angles] = lambda angles: angles
    rotation_sign: float = 1.0
    path: str = ""


def sizes(kinematics_at: KinematicsAt, loading: Loading, program: CompiledMotion) -> Sizes:
    """Refined maxima of inertia and motion over the turn.

    Raises
    ------
    NoStability
        Where nothing moves, or nothing that moves has mass.
    """
    result = Sizes(
        find_highest(lambda angles: {"": loading.inertia(kinematics_at(angles), 1)[0]}, program)[""].value,
        lambda: _motion_sizes(program),
    )
    if result.inertia > 0.0:
        return result
    if not result.stroke > 0.0:
        raise NoStability("nothing moves, so nothing excites the shaft", "motion.segments", "give a segment that rises")
    raise NoStability("nothing that moves has mass, so nothing excites the shaft", "loads", "give the moving masses")


def _motion_sizes(program: CompiledMotion) -> MotionSizes:
    def quantities(angles: Angles) -> dict[str, np.ndarray]:
        y = program.state(angles).displacement
        return {"y": y[0], "slope": np.abs(y[1]), "curvature": np.abs(y[2])}

    extremes = find_extremes(quantities, program)
    y, (slope, curvature) = extremes["y"], (extremes[name].high.value for name in ("slope", "curvature"))
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
    """Coefficients of a shaft that drives one mechanism; I_c in kg m², K_s in N m/rad.

    Raises
    ------
    NoStability
        Where nothing with mass moves, or where the velocity jumps.
    """
    driven = (DrivenMechanism(kinematics_at, loading, program),)
    return shaft_coefficients(driven, program, camshaft_inertia, stiffness, spring, spring_factor)


def shaft_coefficients(
    mechanisms: Sequence[DrivenMechanism],
    turn: Any,
    camshaft_inertia: float,
    stiffness: float,
    spring: str,
    spring_factor: float,
) -> Coefficients:
    """Coefficients of a shaft with all its mechanisms, J(θ) = Σ J_i, V = Σ V_i.

    Parameters
    ----------
    mechanisms : sequence of DrivenMechanism
    turn : object
        Pieces of the shaft's turn, `starts` and `ends`, inside which no mechanism has a join.
    camshaft_inertia : float
        I_c [kg m²].
    stiffness : float
        K_s [N m/rad].
    spring : str
        `FIXED` or `RETUNED`.
    spring_factor : float
        Factor a of the retuned valve spring, Kim1990 (7).

    Returns
    -------
    Coefficients

    Raises
    ------
    NoStability
        Where nothing with mass moves, the velocity jumps, or a fixed load jumps during a motion.
    """
    for mechanism in mechanisms:
        _require_no_impact(mechanism)
        if spring != RETUNED:
            _require_even_load(mechanism)
    member_sizes = _member_sizes(mechanisms)
    total = largest = max(member_sizes, key=lambda member: member.inertia)
    if len(mechanisms) > 1:  # the motion is that of the mechanism with the largest inertia
        total = Sizes(_greatest_inertia(mechanisms, turn), lambda: largest.motion)
    q = total.inertia / camshaft_inertia
    heaviest = max(1.0, 2.0 * q)

    def functions(angles: Angles) -> np.ndarray:
        inertia, load = np.zeros((3, angles.theta.size)), np.zeros((2, angles.theta.size))
        for mechanism, scale in zip(mechanisms, member_sizes, strict=True):
            kinematics = mechanism.kinematics_at(mechanism.own(angles))
            by_shaft = np.array([[1.0], [mechanism.rotation_sign], [1.0]])  # of a function and its derivatives
            inertia += mechanism.loading.inertia(kinematics) * by_shaft
            if spring == RETUNED:
                load_terms = _valve_spring(kinematics.motion.displacement, scale, spring_factor) * (
                    scale.inertia / total.inertia
                )
            else:
                load_terms = mechanism.loading.potential(kinematics) / (stiffness * q)
            load += load_terms * by_shaft[1:]
        d, d1, d2 = inertia / total.inertia
        # the last three make the panels short enough for the quotients of the Hill equation
        total_inertia = 1.0 + heaviest * d
        return np.array(
            [
                d,
                0.5 * d1,
                load[0],
                0.5 * d2,
                load[1],
                1.0 / total_inertia,
                load[1] / total_inertia,
                (heaviest * d1 / total_inertia) ** 2,
            ]
        )

    return Coefficients(fit(functions, turn, 5), total, spring, q)


def _require_no_impact(driven: DrivenMechanism) -> None:
    joins = driven.program.joins
    for i, join in enumerate(joins):
        if join.jumps[0] or join.jumps[1]:
            field = f"{driven.path}motion.segments[{(i + 1) % len(joins)}]"
            at = float(np.rad2deg(join.theta))
            raise NoStability(
                "the velocity jumps, an impact on the shaft", field, "make the velocity continuous", [(at, at)]
            )


EVEN = 1e-9  # relative to the largest V': a smaller jump is rounding


def _require_even_load(driven: DrivenMechanism) -> None:
    """Raise NoStability where a process force switches while its point moves: V' jumps, and V'' is infinite there."""
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
        problem = "a process force switches while its point of application moves, an impact on the shaft"
        raise NoStability(problem, f"{driven.path}loads.process", "switch it in a dwell", [(at, at)])


def driven_sizes(driven: DrivenMechanism) -> Sizes:
    """Sizes of a mechanism, `NO_SIZES` where nothing of it moves or nothing that moves has mass."""
    try:
        return sizes(driven.kinematics_at, driven.loading, driven.program)
    except NoStability:
        return NO_SIZES


def _member_sizes(mechanisms: Sequence[DrivenMechanism]) -> list[Sizes]:
    """Sizes of each mechanism, `NO_SIZES` without a moving mass. Raises NoStability where no mechanism has one."""
    result: list[Sizes] = []
    errors: list[NoStability] = []
    for mechanism in mechanisms:
        try:
            result.append(sizes(mechanism.kinematics_at, mechanism.loading, mechanism.program))
        except NoStability as error:
            errors.append(NoStability(error.problem, f"{mechanism.path}{error.field}", error.hint))
            result.append(NO_SIZES)
    if len(errors) == len(mechanisms):
        raise errors[0]
    return result


def _greatest_inertia(mechanisms: Sequence[DrivenMechanism], turn: Any) -> float:
    """Refined maximum of the sum of the mechanisms' J [kg m²]."""

    def inertia(angles: Angles) -> dict[str, np.ndarray]:
        return {
            "": np.asarray(
                sum(
                    mechanism.loading.inertia(mechanism.kinematics_at(mechanism.own(angles)), 1)[0]
                    for mechanism in mechanisms
                )
            )
        }

    return find_highest(inertia, turn)[""].value


def _valve_spring(y: Derivatives, size: Sizes, factor: float) -> np.ndarray:
    """U = a X''m X X'/(X_m X'm²) and ψ = U' (2, n), X counted from its lowest position (Kim1990 (7), (13))."""
    x = y[0] - size.lowest
    gain = factor * size.curvature / (size.stroke * size.slope**2)
    return gain * np.array([x * y[1], y[1] * y[1] + x * y[2]])


# -- Hill equations ------------------------------------------------------------------------------------------


EXACT, APPROXIMATE = "exact_21", "approx_22"

EQUATIONS: Mapping[str, str] = MappingProxyType(
    {EXACT: "Linearised, exact (21)", APPROXIMATE: "Linearised, approximate (22)"}
)
"""The linear equations and their titles: Kim1990 (21); (22) with X''X for its X''X''.

In (22) D → 1 and C is dropped, which is not consistent to first order in Q.
"""


def inertia_and_pull(
    coefficients: Coefficients, equation: str, q: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Terms D, Q C and Q ψ of the linear equation at the nodes; with a fixed spring Q ψ is divided by η².

    Parameters
    ----------
    coefficients : Coefficients
    equation : str
        Key of `EQUATIONS`.
    q : ndarray (rows,), dimensionless

    Returns
    -------
    inertia, centripetal, pull : ndarray (rows, m, NODES), dimensionless

    References
    ----------
    Kim (1990), eqs. (21), (22).
    """
    rows = coefficients.panels.values
    q = np.asarray(q, dtype=float)[:, None, None]
    pull = q * rows[LOAD_SLOPE]
    if equation == APPROXIMATE:
        return np.ones_like(pull), np.zeros_like(pull), pull
    return 1.0 + q * rows[INERTIA], q * rows[CENTRIPETAL], pull


def weight_and_potential(coefficients: Coefficients, equation: str, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Terms w and p of the Hill equation ζ'' + 4π²(η² w + p) ζ = 0, ζ = √D β.

    (21): w = 1/D, p = Qψ/D + (QC/D)²; with a fixed spring, whose ψ = η² ψ1: w = (1 + Qψ1)/D, p = (QC/D)².

    Parameters
    ----------
    coefficients : Coefficients
    equation : str
        Key of `EQUATIONS`.
    q : ndarray (rows,), dimensionless

    Returns
    -------
    weight, potential : ndarray (rows, m, NODES), dimensionless

    References
    ----------
    Kim (1990), eqs. (21), (22).
    """
    d, c, pull = inertia_and_pull(coefficients, equation, q)
    speed = (c / d) ** 2
    if coefficients.fixed:
        return (1.0 + pull) / d, speed
    return 1.0 / d, pull / d + speed


# -- Fourier coefficients ------------------------------------------------------------------------------------

MOST_CACHED = 2_000_000  # entries of a cached matrix, 32 MB
SAME = 4e-15  # [rad] widths that differ by less are equal
BLOCK = 64  # panels in one product where the matrix is too large to be cached


def _weights(start: np.ndarray, width: np.ndarray, highest: int) -> np.ndarray:
    """Fourier weights (highest + 1, m NODES) of panels with starts and widths (m,).

    A weight is the integral of the node's polynomial on the panel -1 ... 1 with e^{-izx}, z = k width/2, by as many
    Gauss-Legendre points as leave only rounding.
    """
    k = np.arange(highest + 1)
    half = 0.5 * width
    widths = np.sort(half)  # panels have few different widths, apart from rounding
    widths = widths[np.diff(widths, prepend=-1.0) > SAME]
    at = np.searchsorted(widths, half, side="right") - 1
    z = k[:, None] * widths
    pairs = math.ceil(0.5 * gauss_points(float(z.max())))  # of points x and -x, which share cosines and sines
    x, gauss = gauss_legendre(2 * pairs)
    interpolation = legendre(x, NODES).T @ to_legendre(NODES)  # the value at x of the polynomial that is 1 at one node
    interpolation *= 0.5 * gauss[:, None]
    positive, negative = interpolation[pairs:], interpolation[:pairs][::-1]
    angle = z[..., None] * x[pairs:]
    by_node = np.cos(angle) @ (positive + negative) - 1j * (np.sin(angle) @ (positive - negative))  # (k, widths, node)
    shift = np.exp(-1j * k[:, None] * (start + half)) * (2.0 * half / TURN)
    return np.ascontiguousarray((by_node[:, at] * shift[..., None]).reshape(k.size, -1))


def gauss_points(z: float) -> int:
    """Number of points that integrate a polynomial of the panels times e^{izx} to rounding.

    The part of degree d of e^{izx} is |j_d(z)|, below 1e-17 from d = z + 12 z^(1/3) + 20 on.
    """
    return math.ceil(0.5 * (NODES + z + 12.0 * z ** (1.0 / 3.0) + 20.0))


@lru_cache(maxsize=4)
def _cached_weights(panels: Panels) -> list[np.ndarray]:
    """The largest matrix of weights so far, which contains the smaller ones; empty at first."""
    return []


def fourier(panels: Panels, values: np.ndarray, highest: int) -> np.ndarray:
    """Fourier coefficients c_k = (1/2π) ∫ f e^{-ikθ} dθ, k = 0 ... highest; c_-k is the conjugate.

    They are exact for the polynomials of the panels; `truncation` bounds the remaining error. The matrix of weights is
    cached for the next row of a chart where it has at most `MOST_CACHED` entries.

    Parameters
    ----------
    panels : Panels
    values : ndarray (..., m, NODES), dimensionless
        Functions at the nodes; the result has their unit.
    highest : int

    Returns
    -------
    ndarray (..., highest + 1) complex, dimensionless
    """
    order = 64
    while order < highest:
        order *= 2
    if (order + 1) * panels.count * NODES <= MOST_CACHED:
        flat = values.reshape(*values.shape[:-2], -1)
        cached = _cached_weights(panels)
        if not cached or cached[0].shape[0] <= highest:
            cached[:] = [_weights(panels.start, panels.width, order)]
        return flat @ cached[0][: highest + 1].T
    out = np.zeros((*values.shape[:-2], highest + 1), dtype=complex)
    for first in range(0, panels.count, BLOCK):
        block = slice(first, first + BLOCK)
        flat = values[..., block, :].reshape(*values.shape[:-2], -1)
        out += flat @ _weights(panels.start[block], panels.width[block], highest).T
    return out


def truncation(panels: Panels, values: np.ndarray) -> np.ndarray:
    """Bound of the error of every Fourier coefficient: the mean of the |last Legendre coefficients|.

    Parameters
    ----------
    panels : Panels
    values : ndarray (..., m, NODES), dimensionless
        Functions at the nodes; the result has their unit.

    Returns
    -------
    ndarray (...), dimensionless
    """
    last = np.abs(values @ to_legendre(NODES)[-2:].T).sum(axis=-1)
    return last @ panels.width / TURN


# -- harmonic balance as matrices -------------------------------------------------------------------------------


@frozen(eq=False)
class Basis:
    """Harmonics cos(number θ) of the numbers `cosines`, followed by sin of `sines`.

    They are orthonormal in the mean over one turn, or over two where the numbers are half integers.

    Attributes
    ----------
    cosines, sines : ndarray (n,), dimensionless
    """

    cosines: np.ndarray
    sines: np.ndarray

    @property
    def numbers(self) -> np.ndarray:
        """Numbers (n,), dimensionless, of all harmonics."""
        return np.concatenate((self.cosines, self.sines))


@lru_cache(maxsize=128)
def basis(first: int, last: int, half: bool) -> Basis:
    """Harmonics above `first` (-1: with the constant) up to `last`; half integers: first + 1/2 ... last - 1/2."""
    if half:
        numbers = np.arange(max(first, 0), last) + 0.5
        return Basis(numbers, numbers)
    numbers = np.arange(first + 1, last + 1).astype(float)
    return Basis(numbers, numbers[numbers > 0.0])


@frozen(eq=False)
class _Parts:
    """Indices and weights of the two coefficients, c_|i-j| and c_{i+j}, whose sum is an entry of a block.

    Attributes
    ----------
    minus, plus : ndarray (left, right) of int
        Indices into (Re c, Im c).
    minus_weight, plus_weight : ndarray (left, right)
    """

    minus: np.ndarray
    plus: np.ndarray
    minus_weight: np.ndarray
    plus_weight: np.ndarray


@lru_cache(maxsize=128)
def _parts(left: Basis, right: Basis, count: int) -> _Parts:
    """Entries of the block for ``count`` coefficients."""
    i, j = left.numbers[:, None], right.numbers
    left_is_sine, right_is_sine = (np.arange(b.numbers.size) >= b.cosines.size for b in (left, right))
    mixed = left_is_sine[:, None] != right_is_sine
    half_root = np.sqrt(0.5)
    scale = np.where(i == 0.0, half_root, 1.0) * np.where(j == 0.0, half_root, 1.0)
    across = np.where(left_is_sine[:, None], np.sign(j - i), -np.sign(j - i))
    return _Parts(
        np.abs(i - j).astype(int) + count * mixed,
        (i + j).astype(int) + count * mixed,
        np.where(mixed, across, 1.0) * scale,
        np.where(left_is_sine[:, None] | right_is_sine, -1.0, 1.0) * scale,
    )


def product(c: np.ndarray, left: Basis, right: Basis) -> np.ndarray:
    """Matrices of the multiplication by functions with Fourier coefficients c, from one basis to another.

    <cos i, f cos j> = Re(c_{i-j} + c_{i+j}), <sin i, f sin j> = Re(c_{i-j} - c_{i+j}),
    <cos i, f sin j> = -Im(c_{j-i} + c_{i+j}).

    Parameters
    ----------
    c : ndarray (..., order + 1) complex, dimensionless
    left, right : Basis

    Returns
    -------
    ndarray (..., left, right), dimensionless
    """
    parts = _parts(left, right, c.shape[-1])
    real_and_imaginary = np.concatenate((c.real, c.imag), axis=-1)
    out = real_and_imaginary.take(parts.minus, axis=-1)
    out *= parts.minus_weight
    second = real_and_imaginary.take(parts.plus, axis=-1)
    second *= parts.plus_weight
    out += second
    return out


def toeplitz(c: np.ndarray, size: int) -> np.ndarray:
    """Hermitian matrix of the multiplication by a function, in the basis of complex exponentials.

    Parameters
    ----------
    c : ndarray (n,) complex, dimensionless
        Fourier coefficients, n ≥ size.
    size : int

    Returns
    -------
    ndarray (size, size) complex, dimensionless
    """
    difference = np.arange(size)[:, None] - np.arange(size)
    return np.asarray(np.where(difference >= 0, c[np.abs(difference)], c[np.abs(difference)].conj()))


# -- matrices of Kim1990: (27), (28) without their misprints, with harmonics -5 ... 5 for both periods --------------

KIM_ORDER = 5  # 11 x 11


def kim_matrix(coefficients: Coefficients, q: float, half: bool) -> np.ndarray:
    """Hermitian matrix whose eigenvalues are the η² at which the determinant |K| of (32) vanishes.

    It contains ρ_r and G_k without η². For γ = jπ (half) the harmonics are r + 1/2, one more above than below.

    Returns
    -------
    ndarray (11, 11) complex, dimensionless

    References
    ----------
    Kim (1990), eqs. (27), (28), (32).
    """
    r = np.arange(-KIM_ORDER, KIM_ORDER + 1) + (0.5 if half else 0.0)
    c = q * fourier(coefficients.panels, coefficients.panels.values[LOAD_SLOPE], 2 * KIM_ORDER)
    return np.diag(r * r).astype(complex) - toeplitz(c, r.size)


def kim_edges(coefficients: Coefficients, q: float, count: int = 2 * KIM_ORDER - 1) -> np.ndarray:
    """Edges η of the tongues 1 ... count as in Kim1990 Fig. 8: each pair of eigenvalues is one tongue.

    Returns
    -------
    ndarray (count, 2), dimensionless
        NaN where an eleventh eigenvalue has no partner; count ≤ 11.

    References
    ----------
    Kim (1990), eq. (32) and Fig. 8.
    """
    full_turn, two_turns = (
        np.sqrt(np.maximum(np.linalg.eigvalsh(kim_matrix(coefficients, q, g)), 0.0)) for g in (False, True)
    )
    values = [np.append(two_turns if n % 2 else full_turn, np.nan) for n in range(1, count + 1)]
    return np.array([row[n - 1 : n + 1] for n, row in enumerate(values, 1)])
