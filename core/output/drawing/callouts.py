"""Dimensions of the view: a text beside the view with a leader to what it names, placed so that nothing lies over another."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import combinations

import numpy as np

from core.frozen import frozen
from core.numerics.vectors import cross
from core.output.drawing.paper import Box
from core.output.drawing.sheet import THIN, ArrowHead, Item, SheetLine, SheetText

WIDE = 0.84  # mean width of a letter, of the height of its capitals
ROUNDS = 3  # in which every text looks for a better place
CROSSING, COVERING, NEARNESS = (
    1e3,
    1e4,
    40.0,
)  # what is worst: texts over lines; then lines over lines; then leaders that lie close
TIP = 0.02  # of a leader: where it may touch the outline
ABOVE, BELOW = (2.1, 0.5), (-1.5, -3.1)  # baselines of two lines beyond a shoulder, in heights of capitals
CLOSE = 3.0  # mm between a leader and another's tip

Segment = tuple[complex, complex]


@frozen
class Callout:
    """
    lines   of text, both beyond the leader's shoulder, so that no leader runs through them
    tips    where its arrow may point: places on the sheet [mm]
    centre  of a radius, which is drawn from there to the tip; None where the arrow comes from outside
    """

    lines: tuple[str, ...]
    tips: tuple[complex, ...]
    centre: complex | None = None

    def width(self, height: float) -> float:
        """Room of its texts [mm]."""
        return WIDE * height * max(len(line) for line in self.lines) + height


@frozen
class _Placed:
    """A callout at one of its tips; its leader comes from ``end`` of its shoulder."""

    callout: Callout
    tip: complex
    shoulder: Segment
    end: complex

    @property
    def segments(self) -> list[Segment]:
        inner = [] if self.callout.centre is None else [(self.callout.centre, self.tip)]
        return [(self.end, self.tip), *inner]


@frozen
class Surroundings:
    """Where callouts are placed: along the top and the foot of ``field``, on the side of ``middle`` (y) where their tips are;
    height of their letters [mm]; ``kept``: lines that no leader shall cross; ``edge`` (n,): the closed outline of the part, which
    none shall cross without need."""

    field: Box
    middle: float
    height: float
    kept: Sequence[Segment]
    edge: np.ndarray

    @property
    def rows(self) -> Box:
        """Its top and foot are where shoulders lie."""
        texts = 4.0 * self.height
        return Box(self.field.left, self.field.bottom + texts, self.field.right, self.field.top - texts)

    def entered(self, end: complex, tip: complex) -> int:
        """How often a leader crosses the outline, its tip aside."""
        a, along = end, (1.0 - TIP) * (tip - end)
        c, d = self.edge, np.roll(self.edge, -1)
        apart = (cross(along, c - a) > 0.0) != (cross(along, d - a) > 0.0)
        return int(np.count_nonzero(apart & ((cross(d - c, a - c) > 0.0) != (cross(d - c, a + along - c) > 0.0))))


def callouts(wanted: Sequence[Callout], around: Surroundings) -> list[Item]:
    """All of them drawn.

    Each tries its tips in turn and keeps the one with which leaders cross least, others' choices standing, until none changes.
    """
    chosen = [0] * len(wanted)

    def cost(choice: Sequence[int]) -> float:
        return _cost(_placed(wanted, choice, around), around)

    order = sorted(range(len(wanted)), key=lambda i: len(wanted[i].tips))
    for _ in range(ROUNDS):
        before = list(chosen)
        for i in order:
            chosen[i] = min(range(len(wanted[i].tips)), key=lambda tip: cost([*chosen[:i], tip, *chosen[i + 1 :]]))
        if chosen == before:
            break
    return [item for each in _placed(wanted, chosen, around) for item in _drawn(each, around.height)]


def _placed(wanted: Sequence[Callout], choice: Sequence[int], around: Surroundings) -> list[_Placed]:
    """Texts in their rows above and below, in the order of their tips from left to right, as near to them as there is room."""
    made, rows, height = [], around.rows, around.height
    for y, above in ((rows.top, True), (rows.bottom, False)):
        here = []
        for each, tip in zip(wanted, [each.tips[i] for each, i in zip(wanted, choice, strict=True)], strict=True):
            if (tip.imag >= around.middle) == above:
                end, width = _best_end(tip, each.centre, rows, y), each.width(height)
                begin = end - width if tip.real < rows.middle.real else end
                here.append((end, begin, width, tip, each))
        here.sort(key=lambda row: row[:2])
        starts = _in_a_row([begin for _, begin, *_ in here], [width for _, _, width, *_ in here], rows, 2.0 * height)
        for (_, _, width, tip, each), start in zip(here, starts, strict=True):
            shoulder = complex(start, y), complex(start + width, y)
            made.append(_Placed(each, tip, shoulder, min(shoulder, key=partial(_detour, tip, around))))
    return made


def _detour(tip: complex, around: Surroundings, end: complex) -> tuple[int, float]:
    """How often a leader from that end crosses the outline, and how long it is."""
    return around.entered(end, tip), abs(end - tip)


def _best_end(tip: complex, centre: complex | None, rows: Box, y: float) -> float:
    """Where a leader would best reach its text: where the radius meets the row, else a little outside of the tip."""
    if centre is not None and abs(tip.imag - centre.imag) > 1e-6:
        along = (tip - centre) / (tip.imag - centre.imag)
        return min(max((centre + along * (y - centre.imag)).real, rows.left), rows.right)
    return tip.real + 0.4 * (tip.real - rows.middle.real)


def _in_a_row(wanted: Sequence[float], widths: Sequence[float], rows: Box, gap: float) -> list[float]:
    """Left ends of texts that shall begin there, moved apart and into the row."""
    starts: list[float] = []
    edge = rows.left
    for begin, width in zip(wanted, widths, strict=True):
        starts.append(max(edge, begin))
        edge = starts[-1] + width + gap
    edge = rows.right
    for i in range(len(starts) - 1, -1, -1):
        starts[i] = min(starts[i], edge - widths[i])
        edge = starts[i] - gap
    return starts


def _cost(placed: Sequence[_Placed], around: Surroundings) -> float:
    total = 0.0
    for each in placed:
        total += sum(abs(b - a) for a, b in each.segments)
        total += CROSSING * sum(_crosses(segment, other) for segment in each.segments for other in around.kept)
        total += CROSSING * around.entered(each.end, each.tip)
        total += COVERING * max(0.0, around.field.left - each.shoulder[0].real)
    for one, other in combinations(placed, 2):
        total += CROSSING * sum(_crosses(a, b) for a in one.segments for b in other.segments)
        total += NEARNESS * (_beside(one, other.tip) + _beside(other, one.tip))
        total += COVERING * sum(_crosses(a, other.shoulder) for a in one.segments)
        total += COVERING * sum(_crosses(b, one.shoulder) for b in other.segments)
    return total


def _beside(one: _Placed, tip: complex) -> bool:
    return any(_distance(segment, tip) < CLOSE for segment in one.segments)


def _distance(segment: Segment, point: complex) -> float:
    a, b = segment
    along, away = b - a, point - a
    part = (away * along.conjugate()).real / max(abs(along) ** 2, 1e-12)
    return abs(away - min(max(part, 0.0), 1.0) * along)


def _crosses(one: Segment, other: Segment) -> bool:
    """Whether two segments cross inside; those that begin at the same place do not."""
    (a, b), (c, d) = one, other
    if {a, b} & {c, d}:
        return False
    return _side(a, b, c) * _side(a, b, d) < 0.0 and _side(c, d, a) * _side(c, d, b) < 0.0


def _side(a: complex, b: complex, c: complex) -> float:
    """Positive where c is to the left of the way from a to b."""
    return ((b - a).conjugate() * (c - a)).imag


def _drawn(each: _Placed, height: float) -> list[Item]:
    (left, right), end, tip, centre = each.shoulder, each.end, each.tip, each.callout.centre
    items: list[Item] = [SheetLine((right if end == left else left, end, tip), THIN)]
    origin = end if centre is None else centre
    if centre is not None:
        items.append(SheetLine((centre, tip), THIN))
    items.append(ArrowHead(tip, (tip - origin) / abs(tip - origin), 1.2 * height))
    room = (right - left).real - 0.5 * height
    middle = 0.5 * (left + right)
    heights = ABOVE if tip.imag < end.imag else BELOW
    for line, y in zip(each.callout.lines, heights, strict=True):
        items.append(SheetText(middle + 1j * y * height, line, height, room, 0.5))
    return items


__all__ = ["Callout", "Segment", "Surroundings", "callouts"]
