"""Topology of a linkage: pins, mobility, and the order in which its links are solved; independent of its lengths.

A pair is named by its pin, or by the number of the link that slides.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from functools import lru_cache
from itertools import combinations
from math import radians
from types import MappingProxyType

from core.design.linkage import FRAME_LINK, Linkage, SecondDriver, Slider
from core.frozen import frozen

GROUP, INPUT = "group", "input"
_MOST_SEARCHED = 14  # links among which the smallest group is searched; the number of subsets doubles with each link


@frozen
class Pin:
    """A revolute joint: its name and its links, lowest number first; n links make n - 1 pairs."""

    name: str
    links: tuple[int, ...]


@frozen
class SolutionStep:
    """Links that are solved together, after those of the previous steps.

    Attributes
    ----------
    kind : ``RRR``, RRP, RPR, PRP or RPP of a dyad, its pairs from the known end of the first link over the inner pair to
        the known end of the second; ``group`` of links without dyads; ``input`` of a second driving link
    links : in the same order; for a group lowest number first
    pairs : in the same order; for a group pins by name, then sliders by link
    """

    kind: str
    links: tuple[int, ...]
    pairs: tuple[str, ...]

    @property
    def joint(self) -> str:
        """Inner pair of a dyad."""
        return self.pairs[min(1, len(self.pairs) - 1)]


@frozen
class SolutionOrder:
    """Steps of the solution, links with redundant pairs, and undetermined links."""

    steps: tuple[SolutionStep, ...]
    redundant: tuple[int, ...] = ()
    undetermined: tuple[int, ...] = ()


@lru_cache(maxsize=64)
def pins(linkage: Linkage) -> tuple[Pin, ...]:
    """Pins: point names on two links or more, in the order of the file."""
    links_by_point: dict[str, list[int]] = {}
    for link in linkage.links:
        for point in link.points:
            links_by_point.setdefault(point.name, []).append(link.number)
    return tuple(Pin(name, tuple(sorted(links))) for name, links in links_by_point.items() if len(links) > 1)


def pair_count(linkage: Linkage) -> int:
    """Number of revolute and sliding pairs."""
    return sum(len(pin.links) - 1 for pin in pins(linkage)) + len(linkage.sliders)


def mobility(linkage: Linkage) -> int:
    """Mobility by Grübler's equation, 3(n - 1) - 2·pairs."""
    return 3 * (len(linkage.links) - 1) - 2 * pair_count(linkage)


def slider_of(linkage: Linkage, key: str) -> Slider:
    """Sliding pair by its name, the number of the link that slides."""
    return next(s for s in linkage.sliders if str(s.link) == key)


def is_pin(key: str) -> bool:
    """Whether a pair's name is that of a pin, not the number of a sliding link."""
    return not key.isdecimal()


def driver_pair(linkage: Linkage) -> str | None:
    """Single pair of the driving link with the frame, or with the link against which it is driven; None without a single one."""
    pairs = list(_ends(linkage, linkage.driver.link, {linkage.driver.on}))
    return pairs[0] if len(pairs) == 1 else None


def driver_turns(linkage: Linkage) -> bool:
    """Whether the driver turns, not slides."""
    pair = driver_pair(linkage)
    return pair is None or is_pin(pair)


def input_slides(linkage: Linkage, second: SecondDriver) -> bool:
    """Whether a second driving link slides on its reference link, as a rack does, not turns."""
    return any({s.link, s.on} == {second.link, second.on} for s in linkage.sliders)


def gains(linkage: Linkage) -> Mapping[int, float]:
    """Link of a second driver -> its ratio in SI [rad or m per rad or m of the driver]."""
    driver, ratios = _SI[driver_turns(linkage)], linkage.ratios
    return {
        row.link: ratios[row.link] * _SI[not input_slides(linkage, row)] / driver
        for row in linkage.drivers
        if row.link in ratios
    }


_SI = MappingProxyType({True: radians(1.0), False: 1e-3})
"""Whether a link turns -> its unit, deg or mm, in SI."""


@lru_cache(maxsize=64)
def solving_order(linkage: Linkage) -> SolutionOrder:
    """Order of solution: dyads as long as there is one, else the smallest group that the known links determine or overdetermine."""
    known = {FRAME_LINK, linkage.driver.link} if linkage.driver.on == FRAME_LINK else {FRAME_LINK}
    unknown = sorted(link.number for link in linkage.links if link.number not in known)
    redundant: list[int] = []
    steps: list[SolutionStep] = []
    driven = {row.link: row.on for row in linkage.drivers}
    while unknown:
        step = next(_inputs(linkage, unknown, known, driven), None)
        free = [n for n in unknown if n not in driven]
        if step is None:
            step = next(_dyads(linkage, free, known), None)
        if step is None:
            group, is_redundant = _smallest_group(linkage, free, known)
            if not group:
                return SolutionOrder(tuple(steps), tuple(redundant), tuple(unknown))
            if is_redundant:
                redundant += group
            step = SolutionStep(GROUP, group, _pairs_of(linkage, set(group), known))
        steps.append(step)
        known |= set(step.links)
        unknown = [n for n in unknown if n not in known]
    return SolutionOrder(tuple(steps), tuple(redundant))


def inner_pair(linkage: Linkage) -> str | None:
    """The driving pair, where it is between two moving links."""
    return driver_pair(linkage) if linkage.driver.on != FRAME_LINK else None


def _inputs(linkage: Linkage, unknown: list[int], known: Set[int], driven: Mapping[int, int]) -> Iterator[SolutionStep]:
    """Second driving links with a known reference link, and one pin on known links, or a slide on the reference link."""
    for link in unknown:
        if driven.get(link) in known:
            pairs = list(_ends(linkage, link, known))
            if len(pairs) == 1 and (is_pin(pairs[0]) or pairs == list(_ends(linkage, link, {driven[link]}))):
                yield SolutionStep(INPUT, (link,), (pairs[0],))


def _ends(linkage: Linkage, link: int, known: Set[int]) -> Iterator[str]:
    """Pairs of a link with known links."""
    yield from (pin.name for pin in pins(linkage) if link in pin.links and known & set(pin.links) - {link})
    yield from (
        str(slider.link)
        for slider in linkage.sliders
        if (slider.link == link and slider.on in known) or (slider.on == link and slider.link in known)
    )


def _between(linkage: Linkage, a: int, b: int, known: Set[int]) -> Iterator[str]:
    """Pairs of two unknown links with each other."""
    yield from (pin.name for pin in pins(linkage) if {a, b} <= set(pin.links) and not known & set(pin.links))
    yield from (str(slider.link) for slider in linkage.sliders if {slider.link, slider.on} == {a, b})


def _dyads(linkage: Linkage, unknown: list[int], known: Set[int]) -> Iterator[SolutionStep]:
    ends = {n: list(_ends(linkage, n, known)) for n in unknown}
    driven = inner_pair(linkage)
    for a, b in combinations([n for n in unknown if len(ends[n]) == 1], 2):
        inner = list(_between(linkage, a, b, known))
        if len(inner) == 1 and driven not in (*ends[a], *inner, *ends[b]):
            step = _ordered(linkage, (a, b), (ends[a][0], inner[0], ends[b][0]))
            if step.kind != "PPP":
                yield step


def _ordered(linkage: Linkage, links: tuple[int, int], pairs: tuple[str, str, str]) -> SolutionStep:
    """Dyad with a known pin before a guide; where a link slides on the second, the sliding link first."""
    kind = "".join("R" if is_pin(key) else "P" for key in pairs)
    is_reversed = kind in ("PRR", "PPR") or (kind == "RPR" and pairs[1] != str(links[0]))
    if is_reversed:
        return SolutionStep(kind[::-1], links[::-1], pairs[::-1])
    return SolutionStep(kind, links, pairs)


def _pairs_of(linkage: Linkage, group: Set[int], known: Set[int]) -> tuple[str, ...]:
    """Pairs within a group and with known links."""
    links = group | known
    names = [p.name for p in pins(linkage) if group & set(p.links) and len(links & set(p.links)) > 1]
    sliders = [str(s.link) for s in linkage.sliders if {s.link, s.on} <= links and {s.link, s.on} & group]
    return (*names, *sliders)


def _count(linkage: Linkage, group: Set[int], known: Set[int]) -> int:
    """Equations of the pairs within a group and with known links: two each, one more for the driving pair."""
    count = 2 * sum({s.link, s.on} <= group | known and bool({s.link, s.on} & group) for s in linkage.sliders)
    for pin in pins(linkage):
        inside, is_known = len(group & set(pin.links)), bool(known & set(pin.links))
        count += 2 * max(0, inside + is_known - 1)
    ends = {linkage.driver.link, linkage.driver.on}
    return count + (inner_pair(linkage) is not None and ends <= group | known and bool(ends & group))


def _smallest_group(linkage: Linkage, unknown: list[int], known: Set[int]) -> tuple[tuple[int, ...], bool]:
    """Smallest set of links with at least as many equations as coordinates, empty without one; and whether it has more."""
    if len(unknown) > _MOST_SEARCHED:
        surplus = _count(linkage, set(unknown), known) - 3 * len(unknown)
        return (tuple(unknown), surplus > 0) if surplus >= 0 else ((), False)
    for size in range(1, len(unknown) + 1):
        for group in combinations(unknown, size):
            surplus = _count(linkage, set(group), known) - 3 * size
            if surplus >= 0:
                return group, surplus > 0
    return (), False
