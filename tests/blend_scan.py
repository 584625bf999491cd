"""What settings of blended motions may be, found from outside: the motions that have all other settings are followed
along their curve, by Yang's equations and Newton's method alone. No formula of ``core`` stands here."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import exp, inf, log, pi, sqrt

import numpy as np
from blends import KAPPA, Motion

SPEED = {"C": 2.0, "H": pi / 2.0}
SMALL = 34.0  # a height of e^-34 of its stroke is none
STEP = 0.25
MOST = 1500
BACKWARDS = {"C3": "C2", "C4": "C1", "CV2": "CV1", "P1": "P2", "H3": "H2", "H4": "H1", "H5": "H6"}


@dataclass(frozen=True)
class Kind:
    """A sequence, its strokes and angles. Its motions are numbered by real numbers q: of the heights of a stroke the
    logarithms, but for a common summand."""

    name: str
    stroke: float
    back: float
    start: float
    span: float
    mirrored: bool = False

    @property
    def curves(self) -> tuple[str, ...]:
        return tuple(self.name.split("-"))

    @property
    def is_backwards(self) -> bool:
        """Whether the return has the more curves: then the motion is drawn as it runs backwards."""
        return self.curves[0] in ("C3", "P1", "H5")

    def motion(self, q: np.ndarray) -> Motion:
        if self.is_backwards:
            names = [BACKWARDS[c] for c in reversed(self.curves)]
            other = Kind("-".join(names), self.back, self.stroke, self.start, self.span).motion(q)
            return Motion(self.curves, other.heights[::-1], other.spans[::-1], self.start)
        up = [c for c in self.curves if c in ("C1", "C2", "H1", "H2", "CV1")]
        down = self.curves[len(up) :]
        heights, ratio, last = self._heights(up, down, list(q))
        works = [SPEED.get(c[0] if c[:2] != "CV" else "", 1.0) * h for c, h in zip(self.curves, heights, strict=True)]
        for i in range(len(up), len(works)):
            works[i] /= ratio
        if last:
            works[-1] = last
        return Motion(self.curves, tuple(heights), tuple(self.span * w / sum(works) for w in works), self.start)

    def _heights(self, up: list[str], down: tuple[str, ...], q: list[float]) -> tuple[list[float], float, float]:
        """Heights, speed of the return over that of the rise, and what the one curve of a return spans times the speed."""
        if down == ("H6",):
            rise = _shares(self.stroke, [0.0, 0.0] if len(up) == 2 else [0.0, q[0], 0.0])
        else:
            rise = _shares(self.stroke, [0.0, *q[: len(up) - 1]])
        if not down:
            return rise, 1.0, 0.0
        if len(down) == 1:
            factor = KAPPA if down == ("P2",) else pi / sqrt(2.0)
            return [*rise, self.back], 1.0, factor * sqrt(self.back * rise[-1])
        if self.mirrored:
            return rise + rise[::-1], 1.0, 0.0
        if down[-1] == "H4":
            share = 1.0 / (1.0 + exp(q[-1])) if len(down) == 3 else 1.0
            square = self.back * share / (rise[0] + rise[-1])
            middle = [self.back * exp(q[-1]) * share] if len(down) == 3 else []
            return [*rise, square * rise[-1], *middle, square * rise[0]], sqrt(square), 0.0
        back = _shares(self.back, [0.0, *q[len(up) - 1 :]])
        return rise + back, sqrt(back[0] / rise[-1]), 0.0

    def numbers(self, motion: Motion) -> np.ndarray:
        """q of a motion."""
        heights = list(motion.heights)
        if self.is_backwards:
            names = [BACKWARDS[c] for c in reversed(self.curves)]
            other = Motion(tuple(names), motion.heights[::-1], motion.spans[::-1], self.start)
            return Kind("-".join(names), self.back, self.stroke, self.start, self.span).numbers(other)
        rises = sum(motion.rises)
        up, down = heights[:rises], heights[rises:]
        if self.curves[-1] == "H6":
            return np.array([log(up[1] / up[0])] if rises == 3 else [])
        q = [log(h / up[0]) for h in up[1:]]
        if self.mirrored or len(down) < 2:
            return np.array(q)
        if self.curves[-1] == "H4":
            return np.array(q + ([log(down[1] / (down[0] + down[2]))] if len(down) == 3 else []))
        return np.array(q + [log(h / down[0]) for h in down[1:]])


def _shares(total: float, logarithms: list[float]) -> list[float]:
    top = max(logarithms)
    parts = [exp(v - top) for v in logarithms]
    return [total * p / sum(parts) for p in parts]


Asked = Callable[[Motion], float]


class Curve:
    """The motions of a kind that have all settings but one, from one of them on in both directions."""

    def __init__(self, kind: Kind, kept: list[Asked], made: Motion) -> None:
        self.kind, self.kept = kind, kept
        self.wanted = np.array([f(made) for f in kept])
        self.begin = kind.numbers(made)
        self.ends: list[bool] = []

    def missed(self, q: np.ndarray) -> np.ndarray:
        motion = self.kind.motion(q)
        return np.array([f(motion) for f in self.kept]) / self.wanted - 1.0

    def slopes(self, q: np.ndarray) -> np.ndarray:
        step = 1e-6
        columns = [(self.missed(q + step * e) - self.missed(q - step * e)) / (2.0 * step) for e in np.eye(q.size)]
        return np.array(columns).T.reshape(len(self.kept), q.size)

    def _along(self, q: np.ndarray, before: np.ndarray | None) -> np.ndarray:
        """Unit vector in which none of the kept settings changes."""
        if not self.kept:
            return np.array([1.0]) if before is None else before
        rows = self.slopes(q)
        size = np.linalg.norm(rows, axis=1, keepdims=True)
        along = np.linalg.svd(rows / np.where(size > 0.0, size, 1.0))[2][-1]
        return -along if before is not None and along @ before < 0.0 else along

    def corrected(self, q: np.ndarray) -> np.ndarray | None:
        """The nearest motion that has the settings."""
        for _ in range(12):
            miss = self.missed(q)
            if not np.isfinite(miss).all():
                return None
            if not self.kept or np.abs(miss).max() < 1e-13:
                return q
            move = np.linalg.lstsq(self.slopes(q), miss, rcond=1e-10)[0]
            if np.linalg.norm(move) < 1e-14:
                break
            q = q - move
        return q if np.abs(self.missed(q)).max() < 1e-9 else None

    def places(self) -> list[np.ndarray]:
        """Places one after the other, until a height is nothing or the curve closes."""
        ways = []
        for sign in (1.0, -1.0):
            ways.append(list(self._way(sign)))
            if len(ways[0]) > 2 and np.linalg.norm(ways[0][-1] - self.begin) < STEP and sign > 0.0:
                return [self.begin, *ways[0]]
        return [*reversed(ways[1]), self.begin, *ways[0]]

    def _way(self, sign: float) -> Iterator[np.ndarray]:
        q, along, step = self.begin, sign * self._along(self.begin, None), STEP
        for count in range(MOST):
            new = self.corrected(q + step * along)
            if new is None or np.linalg.norm(new - q) > 2.0 * step or np.linalg.norm(new - q) < 0.3 * step:
                step *= 0.5
                if step < 1e-6:
                    return
                continue
            along = self._along(new, (new - q) / np.linalg.norm(new - q))
            q, step = new, min(1.5 * step, STEP if np.abs(q).max() < 6.0 else 1.0)
            yield q
            if np.abs(q).max() > SMALL or (count > 8 and np.linalg.norm(q - self.begin) < 0.5 * STEP):
                return


def extent(kind: Kind, kept: list[Asked], asked: Asked, made: Motion) -> tuple[float, float]:
    """The least and the greatest value of a setting along the motions that have the others, from one that has them."""
    curve = Curve(kind, kept, made)
    places = curve.places()
    values = [asked(kind.motion(q)) for q in places]
    found = []
    for sign in (1.0, -1.0):
        signed = [sign * v for v in values]
        i = int(np.argmin(signed))
        best = signed[i]
        if 0 < i < len(places) - 1:
            best = min(best, _refined(curve, places[i - 1 : i + 2], lambda q, sign=sign: sign * asked(kind.motion(q))))
        found.append(sign * best)
    return found[0], found[1]


def _refined(curve: Curve, places: list[np.ndarray], measure: Callable[[np.ndarray], float]) -> float:
    """The least about the middle one of three places, by golden section along the curve."""

    def at(z: float) -> float:
        a, b = (places[0], places[1]) if z < 0.0 else (places[1], places[2])
        q = curve.corrected(a + (z + 1.0 if z < 0.0 else z) * (b - a))
        return inf if q is None else measure(q)

    low, high, share = -1.0, 1.0, (sqrt(5.0) - 1.0) / 2.0
    x, y = high - share * (high - low), low + share * (high - low)
    fx, fy = at(x), at(y)
    for _ in range(45):
        if fx < fy:
            high, y, fy = y, x, fx
            x = high - share * (high - low)
            fx = at(x)
        else:
            low, x, fx = x, y, fy
            y = low + share * (high - low)
            fy = at(y)
    return min(fx, fy)


FOLD = 1e-4


def lies_on_a_line(kind: Kind, kept: list[Asked], made: Motion) -> bool:
    """Whether other motions beside it have the same settings: their growth is dependent there.

    Within FOLD of that (least singular value of the growths of unit length) a second motion with the same settings is
    near, and the settings reach their ends: they are within FOLD² = 1e-8 of them, and rounding of 1e-13 moves the
    motion by 1e-13 / FOLD = 1e-9.
    """
    curve = Curve(kind, kept, made)
    rows = curve.slopes(curve.begin)
    size = np.linalg.norm(rows, axis=1)
    return bool((size < 1e-9).any() or np.linalg.svd(rows / size[:, None], compute_uv=False)[-1] < FOLD)
