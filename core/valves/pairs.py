"""An inlet and an exhaust valve of one cylinder: separation, advance, overlap and its area."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from core.frozen import frozen
from core.numerics.lazy import lazy
from core.numerics.roots import BracketEnds, bracketed_root, gauss
from core.valves.timing import LOBE, VALVE, ValveTiming

NODES = 24  # of the quadrature on a piece, where both lifts are smooth


@frozen
class Overlap:
    """Overlap of both valves at a lift [crank deg], negative where the exhaust closes before the inlet opens."""

    of: str
    at_mm: float
    deg: float


@frozen(eq=False)
class ValvePair:
    """Inlet and exhaust valve of one cylinder."""

    inlet: ValveTiming
    exhaust: ValveTiming

    @property
    def separation(self) -> float:
        """Lobe separation [cam deg]."""
        return 0.5 * (self.inlet.centre - self.exhaust.centre)

    @property
    def advance(self) -> float:
        """Advance of both lobes against equal centres [deg]."""
        return self.separation - self.inlet.centre

    def overlaps(self, lifts: Sequence[float]) -> list[Overlap]:
        """Overlap of the lobes, and of the valves, at lifts [mm]."""
        result = []
        for lift in lifts:
            for of in (LOBE, VALVE):
                inlet, exhaust = self.inlet.event(of, lift), self.exhaust.event(of, lift)
                if inlet is not None and exhaust is not None:
                    result.append(Overlap(of, lift, exhaust.closes_deg - inlet.opens_deg))
        return result

    @lazy
    def overlap_area(self) -> float | None:
        """Integral of the smaller valve lift from the opening of the inlet to the closing of the exhaust [mm deg of the crank]."""
        if not (self.inlet.has_valve_lift and self.exhaust.has_valve_lift):
            return None
        opens, closes = (_seat(timing) for timing in (self.inlet, self.exhaust))
        if opens is None or closes is None:
            return None
        low, high = opens[0], closes[1]
        if high <= low:
            return 0.0
        ends = {low, high, *(c for timing in (self.inlet, self.exhaust) for c in _joins(timing) if low < c < high)}
        cuts = sorted(ends)
        cuts = sorted({*cuts, *self._equal_lifts(cuts)})
        x, weight = gauss(NODES)
        total = 0.0
        for a, b in pairwise(cuts):
            crank = a + (b - a) * x
            lift = np.minimum(self.inlet.valve_lift(crank), self.exhaust.valve_lift(crank))
            total += (b - a) * float(weight @ lift)
        return total

    def _equal_lifts(self, cuts: Sequence[float]) -> list[float]:
        """Crank angles between cuts at which both lifts are equal [deg]."""

        def difference(crank: float) -> float:
            at = np.array([crank])
            return float(self.inlet.valve_lift(at)[0] - self.exhaust.valve_lift(at)[0])

        values = [difference(cut) for cut in cuts]
        return [
            bracketed_root(difference, BracketEnds(cuts[k], values[k], cuts[k + 1], values[k + 1])).b
            for k in range(len(cuts) - 1)
            if values[k] * values[k + 1] < 0.0
        ]


def _seat(timing: ValveTiming) -> tuple[float, float] | None:
    """Crank angles between which the valve is open [deg]: at the lash, or where the lobe leaves its base."""
    if timing.valve.lash_mm > 0.0:
        return timing.passes(timing.lobe_lift_at(timing.valve.lash_mm))
    compiled = timing.compiled
    moving = np.flatnonzero(compiled.velocity_signs != 0.0)
    if not moving.size:
        return None
    nose = timing.nose
    before = ((nose - np.rad2deg(compiled.starts[compiled.velocity_signs > 0.0])) % 360.0).max(initial=0.0)
    after = ((np.rad2deg(compiled.ends[compiled.velocity_signs < 0.0]) - nose) % 360.0).max(initial=0.0)
    return timing.crank_angle(-float(before)), timing.crank_angle(float(after))


def _joins(timing: ValveTiming) -> list[float]:
    """Crank angles of the ends of the pieces of a motion, within one cycle about the nose [deg]."""
    half = 180.0
    distances = (np.rad2deg(timing.compiled.starts) - timing.nose + half) % 360.0 - half
    return [timing.crank_angle(float(d)) for d in distances]


def valve_pairs(timings: Sequence[ValveTiming]) -> tuple[ValvePair, ...]:
    """Every inlet valve (centre after TDC of overlap) with every exhaust valve (before it) of the same cylinder.

    Valves belong to one cylinder where their TDCs of overlap agree; they recur after 720° of the crank.
    """
    return tuple(
        ValvePair(inlet, exhaust)
        for inlet in timings
        for exhaust in timings
        if inlet.centre > 0.0 > exhaust.centre and inlet.cylinder == exhaust.cylinder
    )
