"""The .linkage2 files of Linkage: XML with connectors and links."""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Iterator
from typing import Any
from xml.parsers import expat

from core.bounds import NESTING, bounded_float
from core.linkage_programs.sketch import (
    GROUND,
    PIXEL,
    SLIDING_PIN,
    LeftOut,
    Sketch,
    SketchInput,
    SketchJoint,
    Swing,
    Wheels,
    distinct,
    refused,
)

_SOURCE = "file"
_RPM = 15.0  # and strokes a minute, where the file has none
_DEG_PER_REVOLUTION = 360.0
_MECHANISM = ~0xF  # bits of a layer; without a layer it is the mechanism
_LEAST_ARC = 0.0009  # of a curved slot: by so much its radius exceeds half the distance of its ends
_LINKS, _RATIO = 1000, 1e6  # at most
_JOINED = re.compile(r'(="[^"]*")(?=\w)')  # attributes without a blank between them, as older versions write them
_AMPERSAND = re.compile(r"&(?!#?\w{1,31};)")  # names are written as typed


class _Element:
    """An element with its attributes and its children."""

    def __init__(self, name: str, attributes: dict[str, str]) -> None:
        self.name, self.attributes, self.children = name.lower(), attributes, list[_Element]()

    def all(self, *names: str) -> Iterator[_Element]:
        return (each for each in self.children if each.name in names)

    def __getitem__(self, key: str) -> str:
        return self.attributes.get(key, "")

    def true(self, key: str) -> bool:
        return self[key].lower() == "true"

    @property
    def of_mechanism(self) -> bool:
        """Whether a layer of it is one of the mechanism's; layer 1 is the drawing's."""
        return not self["layer"] or (layer := int(self.number("layer", 0.0))) == 0 or bool(layer & _MECHANISM)

    def number(self, key: str, usual: float) -> float:
        text = self[key]
        try:
            return bounded_float(text) if text else usual
        except ValueError:
            where = f"{self.name} {self['id'][:20]}"
            raise refused(_SOURCE, f"{where}: {key} = {text[:40]!r} is no number", "a number") from None


def _parsed(text: str) -> _Element:
    """The root. Raises DesignError for what is no XML, and for a DOCTYPE, which may name other files."""
    parser, stack = expat.ParserCreate(), [_Element("", {})]

    def doctype(*_: Any) -> None:
        raise refused(_SOURCE, "it has a DOCTYPE", "a file as Linkage writes it, without one")

    def start(name: str, attributes: dict[str, str]) -> None:
        if len(stack) > NESTING:
            raise refused(_SOURCE, "its elements are nested too deep", f"at most {NESTING} levels")
        element = _Element(name, attributes)
        stack[-1].children.append(element)
        stack.append(element)

    parser.StartDoctypeDeclHandler = doctype
    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: stack.pop()
    try:
        parser.Parse(_AMPERSAND.sub("&amp;", _JOINED.sub(r"\1 ", text)), True)
    except (expat.ExpatError, ValueError) as error:  # a text that is no UTF-8
        raise refused(_SOURCE, f"no XML: {error}", "a .linkage2 file") from None
    return stack[0].children[0]


def read(text: str) -> Sketch:
    """The joints of a file, named by their names or C and their number. Raises DesignError."""
    root = _parsed(text)
    if root.name != "linkage2":
        raise refused(_SOURCE, f"its root is {root.name}", "linkage2")
    return _File(root).sketch()


class _File:
    """A file's connectors and links on layers of the mechanism. Of connectors and links of the same id the first is meant by it; links
    are kept all."""

    def __init__(self, root: _Element) -> None:
        every: dict[str, _Element] = {}
        for row in root.all("connector"):
            every.setdefault(row["id"], row)
        self.rows = {key: row for key, row in every.items() if row.of_mechanism}
        self.left = [
            LeftOut(f"connector {key}", "it is on the drawing's layer") for key in every if key not in self.rows
        ]
        named = distinct(row["name"].strip() or f"C{key}" for key, row in self.rows.items())
        self.names = dict(zip(self.rows, named, strict=True))
        self.at = {key: complex(row.number("x", 0.0), row.number("y", 0.0)) for key, row in self.rows.items()}
        rows = [row for row in root.all("link", "element") if row.of_mechanism]
        if len(rows) > _LINKS:
            raise refused(_SOURCE, f"{len(rows)} links are too many", f"at most {_LINKS}")
        self.links = dict(zip(distinct(f"link{row['id']}" for row in rows), rows, strict=True))
        self.on = {key: dict.fromkeys([GROUND] * row.true("anchor")) for key, row in self.rows.items()}
        self.connectors = {link: self._connectors(row) for link, row in self.links.items()}
        for link, keys in self.connectors.items():
            for key in keys:
                self.on[key][link] = None
        self.wheels = tuple(self._wheels(root))
        self.welded = [*self._fastened()]
        self.welded += [*self._driven_together()]

    def _connectors(self, row: _Element) -> list[str]:
        keys = (each["id"] for each in row.all("connector", "fastenconnector"))
        return list(dict.fromkeys(key for key in keys if key in self.rows))

    def _is_frame(self, keys: list[str]) -> bool:
        return len({self.at[key] for key in keys if self.rows[key].true("anchor")}) > 1

    def _fastened(self) -> Iterator[tuple[str, str]]:
        """Links that are one with what they are fastened to: a link, the frame at an anchor, the link of another connector."""
        for link, row in self.links.items():
            yield from ((link, other) for other in self._fastened_to(row) if other != link)

    def _fastened_to(self, row: _Element) -> Iterator[str]:
        """The link to which a link or a connector is fastened."""
        link, connector = f"link{row['fastenlink'] or row['fasten']}", row["fastenconnector"]
        yield from (other for other in [link] if other in self.links)
        for other in [*self.on.get(connector, ())][:1]:
            yield other
            if other != GROUND:
                what, where = f"{row.name} {row['id']}", self.names[connector]
                self.left.append(LeftOut(what, f"fastened to {where}: read as one with the first link there"))

    def _driven_together(self) -> Iterator[tuple[str, str]]:
        """All links on an anchor that is driven turn with it, but for those of the frame."""
        frame = {GROUND, *(link for link, other in self.welded if other == GROUND)}
        frame |= {link for link, keys in self.connectors.items() if self._is_frame(keys)}
        for key, row in self.rows.items():
            if row.true("input") and row.true("anchor"):
                turning = [link for link in self.on[key] if link not in frame]
                yield from ((turning[0], other) for other in turning[1:])

    def _wheels(self, root: _Element) -> Iterator[Wheels]:
        """Gears and chains, each with what carries both of its wheels."""
        near: dict[str, dict[str, None]] = {}  # link -> the links on its connectors
        for ratio in (each for row in root.all("ratios") for each in row.all("ratio")):
            kind = ratio["type"].lower() or "chain"
            ends = [(f"link{each['id']}", each.number("size", 0.0)) for each in ratio.all("link")]
            if (
                len(ends) != 2
                or not {ends[0][0], ends[1][0]} <= self.links.keys()
                or any(size <= 0.0 for _, size in ends)
            ):
                self.left.append(LeftOut(kind, "it has no two wheels with sizes"))
                continue
            (first, one), (second, other) = ends
            for link in {first, second} - near.keys():
                near[link] = dict.fromkeys(each for key in self.connectors[link] for each in self.on[key])
            common = [link for link in near[first] if link in near[second] and link not in (first, second)]
            if not 1.0 / _RATIO < one / other < _RATIO:
                self.left.append(
                    LeftOut(f"{kind} of {first} and {second}", f"their sizes differ {_RATIO:g} times or more")
                )
            elif not common:
                self.left.append(LeftOut(f"{kind} of {first} and {second}", "no link carries both wheels"))
            else:
                yield Wheels(first, second, common[0], -one / other if kind == "gears" else one / other)

    def _carrier(self, one: str, other: str) -> str | None:
        """The link on which two connectors are, or the frame."""
        return next((link for link in self.on[one] if link in self.on[other]), None)

    def sketch(self) -> Sketch:
        """All of it; links that one connector alone holds are dots of the drawing, but for wheels and what is fastened."""
        fastened = {key: [*self._fastened_to(row)] for key, row in self.rows.items()}
        kept = {GROUND, *(link for pair in self.welded for link in pair)}
        kept |= {link for links in fastened.values() for link in links}
        kept |= {link for each in self.wheels for link in (each.first, each.second)}
        kept |= {link for link, keys in self.connectors.items() if len(keys) > 1}
        joints: list[SketchJoint] = []
        for key in self.rows:
            joints += self._joints(key, [*(link for link in self.on[key] if link in kept), *fastened[key]])
        inputs = (*self._pins_driven(), *self._actuators())
        joined = (joint for joint in joints if joint.links)
        return Sketch(tuple(joined), tuple(self.welded), inputs, PIXEL, tuple(self.left), self.wheels)

    def _joints(self, key: str, on: list[str]) -> Iterator[SketchJoint]:
        """A connector as a pin, as one in a slot, or at the end of an arm about the centre of a curved slot."""
        row, name, at = self.rows[key], self.names[key], self.at[key]
        slot = self._slot(row, name)
        others = tuple(dict.fromkeys(link for link in on if slot is None or link != slot[0]))
        if slot is None or not others:
            yield SketchJoint(name, at, tuple(dict.fromkeys(on)))
            return
        carrier, start, end = slot
        half, radius = abs(end - start) / 2.0, row.number("slideradius", 0.0)
        if not radius:
            angle = math.degrees(cmath.phase(end - start))
            yield SketchJoint(name, at, (carrier, *others), SLIDING_PIN, angle, start)
            return
        longest = max(abs(radius), half + _LEAST_ARC)
        height = math.sqrt((longest - half) * (longest + half))
        centre = (start + end) / 2.0 + 1j * math.copysign(height, radius) * (end - start) / (2.0 * half)
        yield SketchJoint(f"{name}_centre", centre, (carrier, f"arm of {name}"))
        yield SketchJoint(name, at, (f"arm of {name}", *others))

    def _slot(self, row: _Element, name: str) -> tuple[str, complex, complex] | None:
        """What carries a connector's slot, and its two ends."""
        limits = [each["id"] for each in row.all("slidelimit") if each["id"] in self.rows][:2]
        if not row.true("slider"):
            return None
        carrier = self._carrier(*limits) if len(limits) == 2 else None
        if carrier is None or self.at[limits[0]] == self.at[limits[1]]:
            why = "its two limits are on no common link" if len(limits) == 2 else "it has no two limits"
            self.left.append(LeftOut(f"slot of {name}", f"{why}: the joint is free"))
            return None
        return carrier, self.at[limits[0]], self.at[limits[1]]

    def _pins_driven(self) -> Iterator[SketchInput]:
        """Connectors that turn; a positive speed is clockwise."""
        for key, row in self.rows.items():
            if not row.true("input"):
                continue
            rpm, limit = -self._per_minute(row, "rpm", f"speed of {self.names[key]}"), row.number("limitangle", 0.0)
            swing = None
            if limit > 0.0:
                cycles = abs(rpm) * _DEG_PER_REVOLUTION / (2.0 * limit)
                swing = Swing(limit, row.number("startoffset", 0.0), cycles, math.copysign(1.0, rpm))
            yield SketchInput(name=self.names[key], rpm=rpm, swing=swing, manual=row.true("alwaysmanual"))

    def _actuators(self) -> Iterator[SketchInput]:
        """Links of two connectors whose length changes, shorter first where the strokes a minute are negative."""
        for link, row in self.links.items():
            if row.true("actuator") and len(self.connectors[link]) == 2:
                cpm = self._per_minute(row, "cpm", f"strokes of actuator {link.removeprefix('link')}")
                stroke, start = abs(row.number("throw", 0.0)), row.number("startoffset", 0.0)
                if not stroke:
                    self.left.append(LeftOut(f"actuator {link.removeprefix('link')}", "it has no throw: it is a bar"))
                    continue
                swing = Swing(stroke, start, abs(cpm), math.copysign(1.0, cpm))
                yield SketchInput(name=link, swing=swing, length=True, manual=row.true("alwaysmanual"))

    def _per_minute(self, row: _Element, key: str, what: str) -> float:
        """Turns or strokes a minute, those of the program where there are none."""
        value = row.number(key, _RPM)
        if not value:
            self.left.append(LeftOut(what, f"it is 0 in the file: read as {_RPM:g} a minute"))
        return value or _RPM


__all__ = ["read"]
