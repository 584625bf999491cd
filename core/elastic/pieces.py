"""The motion as pieces with their coefficients, and the exact answer of the one mass over a piece.

With e = z - s, ' by cam angle θ, δ = c/(2mω), Ω² = (k + ks)/(mω²), Ω_s² = ks/(mω²):

    e'' + 2δ e' + Ω² e = f(θ) = -(s'' + 2δ s' + Ω_s² s),   Y = e' - λ̄ e,  λ = -δ + i√(Ω² - δ²):   Y' = λ Y + f.

s is Σ c_k w^k + Σ A sin(a w + p) on each piece, w = θ - θ_0, and ∫ e^{λ(w-τ)} f(τ) dτ follows in closed form from
∫ e^{λ(w-τ)} τ^k/k! dτ = w^{k+1} φ_{k+1}(λw) and ∫ e^{λ(w-τ)} e^{iaτ} dτ = (e^{iaw} - e^{λw})/(ia - λ).
"""

from __future__ import annotations

from math import comb, factorial
from typing import NamedTuple

import numpy as np

from core.frozen import frozen
from core.motion import Program

SERIES = 40  # terms of a power series at the most
SMALL = 1e-17  # of its first term: what is left out


class Oscillator(NamedTuple):
    """S oscillators, each (S, 1): λ complex, δ and Ω_s² [per radian of cam angle]."""

    root: np.ndarray
    decay: np.ndarray
    closing: np.ndarray

    @property
    def conjugate(self) -> np.ndarray:
        """λ̄, real parts negative."""
        return np.conj(self.root)

    def errors(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """e and e' (S, n) of the states Y (S, n)."""
        e = y.imag / self.root.imag
        return e, y.real - self.decay * e

    def resting(self, s: np.ndarray) -> np.ndarray:
        """The state Y in which it stands still in a dwell at s: e = -ks/(k + ks) s."""
        square = self.root.real**2 + self.root.imag**2
        return np.asarray(self.conjugate * (self.closing / square) * s)


@frozen(eq=False)
class MotionPieces:
    """n pieces of the motion, SI by cam angle: where each starts, how wide it is (n,), coefficients of its powers (k, n), and
    amplitude, frequency and phase of its sines (3, j, n)."""

    starts: np.ndarray
    widths: np.ndarray
    powers: np.ndarray
    sines: np.ndarray

    @staticmethod
    def of(program: Program) -> MotionPieces:
        """Those of a compiled motion."""
        return MotionPieces(program.starts, program.ends - program.starts, program.powers, program.sines)

    def only(self, at: np.ndarray, widths: np.ndarray | None = None) -> MotionPieces:
        """The pieces ``at`` (m,), indices, as wide as said."""
        wide = self.widths[at] if widths is None else widths
        return MotionPieces(self.starts[at], wide, self.powers[:, at], self.sines[:, :, at])

    def cut(self, step: float) -> tuple[MotionPieces, np.ndarray]:
        """Each in equal parts no wider than step [rad]; and the numbers (m,) of the pieces that the parts are of."""
        counts = np.ceil(self.widths / step).astype(int)
        of = np.repeat(np.arange(counts.size), counts)
        part = np.arange(of.size) - np.repeat(np.cumsum(counts) - counts, counts)
        widths = (self.widths / counts)[of]
        by, powers = part * widths, self.powers[:, of]
        moved = np.zeros_like(powers)
        for j in range(powers.shape[0]):
            for k in range(powers.shape[0] - 1, j - 1, -1):
                moved[j] = moved[j] * by + comb(k, j) * powers[k]
        sines = self.sines[:, :, of]
        sines[2] += sines[1] * by
        return MotionPieces(self.starts[of] + by, widths, moved, sines), of

    def at_end(self, order: int) -> np.ndarray:
        """s, s' or s'' (n,) at the ends of the pieces."""
        return self._value(self.widths, order)

    def at_start(self, order: int) -> np.ndarray:
        """s, s' or s'' (n,) at their starts."""
        return self._value(np.zeros(self.widths.size), order)

    def _value(self, w: np.ndarray, order: int) -> np.ndarray:
        total = np.zeros(w.size)
        for k in range(self.powers.shape[0] - 1, order - 1, -1):
            total = total * w + self.powers[k] * (factorial(k) // factorial(k - order))
        amplitude, frequency, phase = self.sines
        waves = amplitude * frequency**order * np.sin(frequency * w + phase + 0.5 * np.pi * order)
        return np.asarray(total + waves.sum(axis=0))

    @np.errstate(under="ignore")
    def driven(self, oscillator: Oscillator) -> tuple[np.ndarray, np.ndarray]:
        """Over each piece Y -> E Y + G: both (S, n)."""
        lam, decay, closing = oscillator
        w, powers = self.widths, self.powers
        most = powers.shape[0]
        wide, of = np.unique(w, return_inverse=True)  # parts of one piece are equally wide
        phi = [row[:, of] for row in _phi(lam * wide, most)]
        total = np.zeros((lam.shape[0], w.size), dtype=complex)
        for k in range(most):
            forcing = closing * powers[k]
            if k + 1 < most:
                forcing = forcing + 2.0 * (k + 1) * decay * powers[k + 1]
            if k + 2 < most:
                forcing = forcing + (k + 1) * (k + 2) * powers[k + 2]
            total -= (factorial(k) * w ** (k + 1)) * forcing * phi[k + 1]
        for amplitude, frequency, phase in zip(*self.sines, strict=True):
            has = np.flatnonzero(amplitude)
            if has.size:
                a = frequency[has]
                forced = -amplitude[has] * (closing - a * a + 2j * decay * a) * np.exp(1j * phase[has])
                same, of = np.unique(w[has] + 1j * a, return_inverse=True)
                up, down = (_beat(lam, sign * same.imag, same.real)[:, of] for sign in (1.0, -1.0))
                total[:, has] += (forced * up - np.conj(forced) * down) / 2j
        return phi[0], total


def _beat(lam: np.ndarray, frequency: np.ndarray, w: np.ndarray) -> np.ndarray:
    """∫ e^{λ(w-τ)} e^{iaτ} dτ over 0 ... w (S, n), also where λ is near ia."""
    apart, decayed = 1j * frequency - lam, np.exp(lam * w)
    x = apart * w
    near, zero = np.abs(x) < 1.0, x == 0.0
    inner = np.where(near & ~zero, x, 1.0)
    close = decayed * w * np.where(zero, 1.0, np.expm1(inner) / inner)
    far = (np.exp(1j * frequency * w) - decayed) / np.where(near, 1.0, apart)
    return np.where(near, close, far)


def _phi(x: np.ndarray, most: int) -> list[np.ndarray]:
    """φ_0 = e^x, φ_k(x) = Σ x^j/(j + k)! for k = 0 ... most: by φ_{k+1} = (φ_k - 1/k!)/x upwards as long as |x| > k, else
    downwards from the series of the last."""
    size = np.abs(x)
    up = [np.exp(x)]
    safe = np.where(size < 1.0, 1.0, x)
    for k in range(most):
        up.append((up[-1] - 1.0 / factorial(k)) / safe)
    small = size < most + 1.0
    if not small.any():
        return up
    inner, least = x[small], size[small]
    down = _phi_series(inner, most)
    for k in range(most, 0, -1):
        up[k][small] = np.where(least < k, down, up[k][small])
        down = inner * down + 1.0 / factorial(k - 1)
    return up


def _phi_series(x: np.ndarray, k: int) -> np.ndarray:
    """φ_k by its power series: for |x| up to about k."""
    term = np.full(x.shape, 1.0 / factorial(k), dtype=complex)
    total = term.copy()
    largest = float(np.abs(x).max(initial=0.0))
    bound = 1.0
    for j in range(1, SERIES):
        term = term * x / (j + k)
        total += term
        bound *= largest / (j + k)
        if bound < SMALL:
            break
    return total
