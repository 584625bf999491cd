"""Motions of many designs in one table, and unwrapped angles of their links."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from core.design import Motion
from core.design.curves import has_common_pieces
from core.mechanism.drivers import with_margin
from core.motion import TURN, Angles, CompiledMotion, MotionState
from core.numerics.derivatives import Derivatives
from core.numerics.lazy import map_columns, one_design


class BlockMotions:
    """Compiled motions of m designs, one after the other in one table; ``plain`` is the motion without varied numbers.

    Attributes
    ----------
    differing : ndarray (m,)
        Designs whose motion has another number of pieces than the plain one, which replaces it.
    starts, ends : ndarray (m, p) [rad]
        Ends of the pieces.
    """

    def __init__(self, plain: CompiledMotion, motion: Motion, count: int) -> None:
        """Compile the motion, which has a column (count,) for each varied number."""
        self._plain, self.differing = plain, np.zeros(count, dtype=bool)
        self._has_common_pieces = has_common_pieces(motion)
        if self._has_common_pieces:
            self._stacked = CompiledMotion.from_columns(motion, count)
        else:  # the pieces depend on span and rise, or on a number of the curve
            self._stacked = self._one_by_one([CompiledMotion(map_columns(motion, one_design(k))) for k in range(count)])
        self.starts, self.ends = (row.reshape(count, -1) for row in (self._stacked.starts, self._stacked.ends))
        self.pieces = self.starts.shape[1]

    def _one_by_one(self, programs: Sequence[CompiledMotion]) -> CompiledMotion:
        self.differing = np.array([motion.starts.size != self._plain.starts.size for motion in programs])
        return CompiledMotion.stacked(
            [
                self._plain if differs else motion
                for motion, differs in zip(programs, self.differing.tolist(), strict=True)
            ]
        )

    @property
    def corners(self) -> np.ndarray:
        """Mask (m,) of motions whose displacement or velocity jumps; none where every segment begins and ends at rest."""
        if self._has_common_pieces and self._plain.is_rest_to_rest:
            return np.zeros(self.starts.shape[0], dtype=bool)
        _, _, jumps = self._stacked.jumps(self.starts.shape[0], orders=2)
        return np.asarray(jumps.reshape(2, self.starts.shape[0], -1).any(axis=(0, 2)))

    def span_ratios(self) -> np.ndarray:
        """Spans of the pieces over those of the plain motion.

        Returns
        -------
        ndarray (m, p), dimensionless
        """
        return np.asarray((self.ends - self.starts) / (self._plain.ends - self._plain.starts))

    def cam_angles(self, theta: np.ndarray, piece: np.ndarray, owner: np.ndarray) -> np.ndarray:
        """Cam angles of designs at the same parts of their pieces as angles of the plain motion.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Cam angles of the plain motion.
        piece : ndarray (n,), dimensionless
            Numbers of their pieces.
        owner : ndarray (n,) or (m, 1), dimensionless
            Numbers of the designs.

        Returns
        -------
        ndarray (n,) or (m, n) [rad]
        """
        at, plain = self._piece_values(piece, owner), self._plain
        part = (theta - plain.starts[piece]) / (plain.ends - plain.starts)[piece]
        result = at(self.starts) + at(self.ends - self.starts) * part
        last = theta == plain.ends[piece]
        design = owner if owner.ndim > 1 else np.broadcast_to(owner, last.shape)[last]
        result[..., last] = self.ends[design, piece[last]]
        return result

    def _piece_values(self, piece: np.ndarray, owner: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """Function that takes values of all pieces, (m, p) or (m p,), at pieces (n,) of the designs ``owner`` (n,) or (m, 1)."""
        if owner.ndim > 1:
            first = np.flatnonzero(np.diff(piece, prepend=-1))  # stretches of angles within one piece
            lengths, index = np.diff(first, append=piece.size), (owner, piece[first])
            return lambda row: np.repeat(row.reshape(-1, self.pieces)[index], lengths, axis=1)
        at = owner * self.pieces + piece
        return lambda row: row.ravel()[at]

    def state(self, angles: Angles, owner: np.ndarray) -> MotionState:
        """Motions of designs where the plain motion is at given angles.

        Parameters
        ----------
        angles : Angles (n,)
            Angles of the plain motion.
        owner : ndarray (n,) or (m, 1), dimensionless
            Numbers of the designs.

        Returns
        -------
        MotionState
            Of (n,) or (m, n) positions.
        """
        at_design = Angles(
            lambda: self.cam_angles(angles.theta, angles.piece, owner), owner * self.pieces + angles.piece
        )
        if self._has_common_pieces:
            return self._stacked.state_from_curve(
                self._plain.curve(angles), at_design, self._piece_values(angles.piece, owner)
            )
        flat = self._stacked.state(Angles(at_design.theta.ravel(), at_design.piece.ravel()))
        displacement = Derivatives(lambda order: flat.displacement[order].reshape(at_design.theta.shape))
        return MotionState(at_design, displacement, flat.velocity_sign.reshape(at_design.theta.shape))

    def motion_extent(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest position of each motion, with the margin of ``with_margin``.

        Returns
        -------
        low, high : ndarray (m,) [m or rad]
        """
        every = np.arange(self.starts.size)
        ends = (self._stacked.state(Angles(theta.ravel(), every)) for theta in (self.starts, self.ends))
        return with_margin(np.concatenate([e.displacement[0].reshape(self.starts.shape) for e in ends], axis=1))


class AngleAboutMiddle:
    """Unwrapped angle of a link of m designs, each within half a turn of the middle (m,) [rad] of its swing."""

    def __init__(self, middle: Callable[[], np.ndarray], owner: np.ndarray) -> None:
        self._middle, self._owner = middle, owner

    def unwrapped(self, q: Derivatives, angle: Derivatives) -> Derivatives:
        """The angle without jumps at driver positions q, as by `UnwrappedAngle.unwrapped`."""

        def first() -> np.ndarray:
            wrapped = angle[0]
            return np.asarray(wrapped - TURN * np.rint((wrapped - self._middle()[self._owner]) / TURN))

        return Derivatives(lambda order: angle[order] if order else first())


class AngleAlongSamples:
    """Unwrapped angle of a link of m designs, by samples (m, k) of driver position and angle [rad]."""

    def __init__(self, at: np.ndarray, angle: Callable[[], np.ndarray], owner: np.ndarray) -> None:
        self._at, self._angle, self._owner = at, angle, owner

    def unwrapped(self, q: Derivatives, angle: Derivatives) -> Derivatives:
        """The angle without jumps at driver positions q, as by `UnwrappedAngle.unwrapped`."""

        def first() -> np.ndarray:
            owner, low, last = self._owner, self._at[self._owner, 0], self._at.shape[1] - 1
            part = (q[0] - low) / ((self._at[owner, -1] - low) / last)
            i = np.clip(np.floor(part), 0, last - 1).astype(int)
            sampled = self._angle()
            estimate = sampled[owner, i] + (part - i) * (sampled[owner, i + 1] - sampled[owner, i])
            return np.asarray(angle[0] + TURN * np.rint((estimate - angle[0]) / TURN))

        return Derivatives(lambda order: angle[order] if order else first())
