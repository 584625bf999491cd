"""Lobes of cams as they are listed: about the peak, from 0, by negative angles, half of them, with or without the base circle, in mm or
inches, rounded, by cam or crank degrees; each made from a seed."""

from dataclasses import dataclass
from math import sqrt

import numpy as np
from measured_tables import position
from mechanisms import levels

from core.design import Motion

LAWS = (
    "parabolic", "simple-harmonic", "double-harmonic", "cycloidal", "modified-sine", "modified-trapezoid", "3-4-5", "4-5-6-7", "5-6-7-8-9",
    "2-3", "gutman-1-3", "freudenstein-1-3",
)  # fmt: skip
ORDERS = ("about the peak", "from 0", "negative", "anywhere", "falling")
HALVES = ("", "", "", "", "to the peak", "from the peak")
POWERS = ((2, 6, 8, 10), (2, 10, 12, 14), (2, 8, 14, 20), (2, 10, 18, 26))


@dataclass(frozen=True)
class LobeTable:
    """A lobe whose peak is at cam angle 0 of ``lift``, listed as ``text``.

    half   it is listed to its peak, or from it; empty: whole
    turn   cam angle of the table where that of the lobe is 0 [deg]
    error  of a row [mm]
    laws   of both flanks; none of a lobe that is no law
    words  options that the table needs
    """

    text: str
    flanks: tuple[float, float]
    height: float
    motion: Motion | None
    powers: tuple[int, ...]
    turn: float
    half: str
    error: float
    words: tuple[str, ...]
    about: str

    def lift(self, angles: np.ndarray) -> np.ndarray:
        """At cam angles of the table [deg], by both flanks, or by the listed one and its reflection."""
        x = np.mod(angles - self.turn + 180.0, 360.0) - 180.0
        x = -np.abs(x) if self.half == "to the peak" else np.abs(x) if self.half else x
        return self._lift(x)

    def _lift(self, x: np.ndarray) -> np.ndarray:
        """At angles from the peak [deg]."""
        return lobe(self.motion, self.powers, self.flanks, self.height, x)


def lobe(
    motion: Motion | None, powers: tuple[int, ...], flanks: tuple[float, float], height: float, x: np.ndarray
) -> np.ndarray:
    """The lift at angles (n,) from the peak, -180 ... 180 [deg]: of a motion that peaks at 180, or of a polydyne over both flanks."""
    if motion is not None:
        return position(motion, np.mod(x + 180.0, 360.0))
    p = np.array(powers, dtype=float)
    ends = np.array([p**0, p, p * (p - 1.0), p * (p - 1.0) * (p - 2.0)])
    c = np.linalg.solve(ends, [-height, 0.0, 0.0, 0.0])
    u = np.abs(x) / np.where(x < 0.0, *flanks)
    return np.where(u < 1.0, height + (c * np.minimum(u, 1.0)[:, None] ** p).sum(axis=1), 0.0)


def lobe_table(seed: int) -> LobeTable:
    """A lobe of 4 ... 40 mm over flanks of 45 ... 120 cam degrees, in steps of 0.5 ... 2."""
    chance = np.random.default_rng(seed)

    def one(*choices: object) -> object:
        return choices[int(chance.integers(len(choices)))]

    height, left = round(float(chance.uniform(4.0, 40.0)), 2), float(chance.integers(45, 121))
    right = left if chance.random() < 0.5 else float(chance.integers(45, 121))
    between = chance.random() < 0.4  # flanks end between two rows
    left, right = (each + (round(float(chance.uniform(0.05, 0.45)), 2) if between else 0.0) for each in (left, right))
    names = [str(one(*LAWS)), str(one(*LAWS))]
    no_law = bool(chance.random() < 0.25)
    dwell = ((180.0 - left, 0.0, "dwell"), (180.0 - right, 0.0, "dwell"))
    motion = None if no_law else levels(0.0, dwell[0], (left, height, names[0]), (right, 0.0, names[1]), dwell[1])
    powers = POWERS[int(chance.integers(len(POWERS)))]
    step, order, half = float(one(0.5, 1.0, 1.0, 2.0)), str(one(*ORDERS)), str(one(*HALVES))  # type: ignore[arg-type]
    base, inch, crank = bool(chance.random() < 0.5), bool(chance.random() < 0.3), bool(chance.random() < 0.25)
    rows = np.arange(-180.0, 180.0, step)
    if not base:  # to the last row at 0, or a few beyond
        more = step * float(chance.integers(0, 4))
        rows = rows[(rows >= -np.ceil(left / step) * step - more) & (rows <= np.ceil(right / step) * step + more)]
    if half:
        rows = np.append(rows[rows < 0.0], 0.0) if half == "to the peak" else rows[rows >= 0.0]
    y = lobe(motion, powers, (left, right), height, rows)
    turn = {"about the peak": 0.0, "falling": 0.0, "from 0": -float(rows[0]), "negative": -float(rows[-1]) - step}.get(
        order, float(chance.integers(0, 360))
    )
    angles = rows + turn
    if order == "anywhere":  # as a degree wheel has it
        angles = np.mod(angles, 360.0)
    if order == "falling":
        angles, y = angles[::-1], y[::-1]
    noise = float(one(0.0, 0.0, 1e-3, 4e-3))  # type: ignore[arg-type]
    y = y + noise * chance.normal(size=y.size)
    decimals = int(chance.integers(4, 7)) if inch else int(chance.integers(3, 6))
    unit = 25.4 if inch else 1.0
    head = "crank angle (deg)" if crank else "cam angle (deg)"
    text = f"{head},lift ({'in' if inch else 'mm'})\n" + "".join(
        f"{(2.0 if crank else 1.0) * a:.10g},{v / unit:.{decimals}f}\n" for a, v in zip(angles, y, strict=True)
    )
    error = float(np.hypot(noise, unit * 10.0**-decimals / sqrt(12.0)))
    words = ("--half",) if crank else ()
    listed = f"{order}, {half or 'whole'}, {'base' if base else 'no base'}, step {step:g}, {unit:g}e-{decimals}, noise {noise:g}"
    about = f"{listed}, {names if motion else powers}, {left}, {right}, {height}"
    return LobeTable(text, (left, right), height, motion, powers, turn, half, error, words, about)
