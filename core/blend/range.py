"""What a setting may be: stretches of values with open and closed ends."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import isfinite

ALIKE = 1e-9  # two stretches that are nearer to each other are one
NOTHING = 1e-12  # a share of the upper end that is none
TIED = 1e-12  # values that are the same but for rounding


@dataclass(frozen=True)
class Range:
    """From low to high; an open end can only be approached."""

    low: float
    high: float
    low_open: bool = False
    high_open: bool = False

    def times(self, factor: float) -> Range:
        """In other units; a lower end that is 0 but for rounding is 0."""
        low = 0.0 if isfinite(self.high) and abs(self.low) <= NOTHING * abs(self.high) else self.low
        return Range(low * factor, self.high * factor, self.low_open, self.high_open)


def merged(ranges: Iterable[Range]) -> list[Range]:
    """The same stretches in order, those that meet made one."""
    found: list[Range] = []
    for r in sorted(ranges, key=lambda r: (r.low, r.low_open)):
        if found and r.low <= found[-1].high + ALIKE * abs(found[-1].high):
            last = found.pop()
            high = max(last.high, r.high)
            low_open = last.low_open and (r.low_open or not tied(r.low, last.low))
            open_ = all(q.high_open for q in (last, r) if tied(q.high, high))
            r = Range(last.low, high, low_open, open_)
        found.append(r)
    return found


def tied(a: float, b: float) -> bool:
    return a == b or (isfinite(a - b) and abs(a - b) <= TIED * max(abs(a), abs(b)))


def hull(ranges: Sequence[Range]) -> tuple[float, float]:
    """The ends of all of them."""
    return ranges[0].low, ranges[-1].high
