"""A motion's turn, or a crank's, cut at further angles: where loads switch, or friction turns round."""

from __future__ import annotations

from typing import Any

import numpy as np

from core.motion.program import SNAP, Angles, MotionState
from core.motion.turn import CLOSEST


class CutProgram:
    """A program with more pieces: looks like the one that it is made of, whose joins it keeps.

    starts, ends  (m,) angles [rad] of its pieces
    """

    def __init__(self, program: Any, cuts: tuple[float, ...]) -> None:
        """cuts: angles [rad] in rising order; those at an end of a piece add nothing."""
        self._program = program
        at, starts, ends, of = np.array(cuts), [], [], []
        for i, (a, b) in enumerate(zip(program.starts.tolist(), program.ends.tolist(), strict=True)):
            inside = at[(at > a + CLOSEST) & (at < b - CLOSEST)]
            edges = np.concatenate(([a], inside[np.diff(inside, prepend=a) > CLOSEST], [b]))
            starts.append(edges[:-1])
            ends.append(edges[1:])
            of.append(np.full(edges.size - 1, i))
        self.starts, self.ends, self._of = np.concatenate(starts), np.concatenate(ends), np.concatenate(of)
        middle = Angles(0.5 * (self.starts + self.ends), self._of)
        self._middle = np.array([middle.theta, program.state(middle).displacement[0]])

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self._program, name)

    @property
    def velocity_signs(self) -> np.ndarray:
        """Sign (m,) of the velocity on each piece: -1, 0 or 1."""
        return np.asarray(self._program.velocity_signs[self._of])

    @property
    def segment(self) -> np.ndarray:
        """(m,) the segment that each piece belongs to."""
        return np.asarray(self._program.segment[self._of])

    def angles(self, theta: np.ndarray, kept: bool = False) -> Angles:
        """Any angles (n,) [rad], each with the piece right of it."""
        inner = self._program.angles(theta)
        piece = np.searchsorted(self.starts - SNAP, inner.theta, side="right") - 1
        return Angles(inner.theta, np.clip(piece, 0, None), kept)

    def uncut(self, angles: Angles) -> Angles:
        """The same, with the pieces of the program that it is made of."""
        return Angles(angles.theta, self._of[angles.piece], unit=lambda: angles.unit)

    def state(self, angles: Angles) -> MotionState:
        """The motion at these angles."""
        state = self._program.state(self.uncut(angles))
        return MotionState(angles, state.displacement, state.velocity_sign, self._middle[:, angles.piece])
