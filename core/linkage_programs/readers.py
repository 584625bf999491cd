"""The .linkage2 files of Linkage: XML with connectors and links."""

from __future__ import annotations

import cmath
import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any
from xml.parsers import expat

from core.bounds import NESTING, bounded_float
from core.errors import MISSING, DesignError, Fault
from core.frozen import frozen

# -- what every program's linkage comes down to -----------------------------------------------------------------


GROUND = "ground"
PIN, SLIDE, SLIDING_PIN = "R", "P", "RP"
PIXEL = "1/96 in"
"""Unit of a drawing on the screen."""


@frozen
class LeftOut:
    """What could not be carried over, and why."""

    what: str
    why: str


@frozen
class SketchJoint:
    """A joint where it stands, in the program's own unit: a pin of all its links (of one: a point that is followed), or along a line
    at ``angle_deg`` of the first of them, with the others: as a slide they do not turn on it, as a sliding pin they do. ``through``: a
    point of that line, where the joint is on it but for the rounding of the text."""

    name: str
    at: complex
    links: tuple[str, ...]
    kind: str = PIN
    angle_deg: float = 0.0
    through: complex | None = None


@frozen
class Swing:
    """Motion out and back at constant speed, ``cycles`` a minute: ``stroke`` [deg, or the program's unit]; ``start``: how much of out and
    back is behind it as drawn; ``sign`` of the way out."""

    stroke: float
    start: float
    cycles: float
    sign: float = 1.0


@frozen(kw_only=True)
class SketchInput:
    """What drives: the joint of this name, or, with ``length``, the link of two joints whose length changes. Speed [rpm] of what turns,
    None where it is unknown; ``swing`` of what moves out and back; manual: the program turns it by hand only."""

    name: str
    rpm: float | None = None
    swing: Swing | None = None
    length: bool = False
    manual: bool = False

    @property
    def label(self) -> str:
        """Its name for the user."""
        return f"actuator {self.name.removeprefix('link')}" if self.length else self.name

    @property
    def joint(self) -> str:
        """Name of the joint where it drives; of a length the slide between tube and rod."""
        return f"{self.name}_slide" if self.length else self.name


@frozen
class Wheels:
    """Two links that turn against their carrier, ``ratio`` of the second for one of the first."""

    first: str
    second: str
    carrier: str
    ratio: float

    def on(self, merged: Mapping[str, str]) -> Wheels:
        """Of links that are one with others: of those."""
        first, second, carrier = (merged[link] for link in (self.first, self.second, self.carrier))
        return Wheels(first, second, carrier, self.ratio)


@frozen
class SketchMass:
    """Mass of a link [kg], its moment of inertia about its centre of mass [kg m²], and where that is, in the program's own unit."""

    link: str
    mass_kg: float
    inertia_kg_m2: float
    at: complex


@frozen
class SketchForce:
    """A force [N] that keeps its direction, at a place of a link, in the program's own unit."""

    name: str
    link: str
    at: complex
    newton: complex


@frozen
class Sketch:
    """Joints; ``welded``: pairs of links that are one; inputs in the order of the text; unit of lengths, empty where it is unknown."""

    joints: tuple[SketchJoint, ...]
    welded: tuple[tuple[str, str], ...] = ()
    inputs: tuple[SketchInput, ...] = ()
    unit: str = ""
    left_out: tuple[LeftOut, ...] = ()
    wheels: tuple[Wheels, ...] = ()
    masses: tuple[SketchMass, ...] = ()
    forces: tuple[SketchForce, ...] = ()
    gravity: bool = True


def refused(source: str, problem: str, allowed: str) -> DesignError:
    """A text that is no linkage of this program."""
    return DesignError([Fault(source, MISSING, problem, allowed)])


def distinct(names: Iterable[str]) -> list[str]:
    """The names, one that is there already with a number behind it."""
    taken: set[str] = set()
    counts: Counter[str] = Counter()
    result = []
    for name in names:
        unique = name
        while unique in taken:
            counts[name] += 1
            unique = f"{name}_{counts[name] + 1}"
        taken.add(unique)
        result.append(unique)
    return result


# -- the .linkage2 files of Linkage -----------------------------------------------------------------------------


_LINKAGE2_SOURCE = "file"
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
            raise refused(_LINKAGE2_SOURCE, f"{where}: {key} = {text[:40]!r} is no number", "a number") from None


def _parsed(text: str) -> _Element:
    """The root. Raises DesignError for what is no XML, and for a DOCTYPE, which may name other files."""
    parser, stack = expat.ParserCreate(), [_Element("", {})]

    def doctype(*_: Any) -> None:
        raise refused(_LINKAGE2_SOURCE, "it has a DOCTYPE", "a file as Linkage writes it, without one")

    def start(name: str, attributes: dict[str, str]) -> None:
        if len(stack) > NESTING:
            raise refused(_LINKAGE2_SOURCE, "its elements are nested too deep", f"at most {NESTING} levels")
        element = _Element(name, attributes)
        stack[-1].children.append(element)
        stack.append(element)

    parser.StartDoctypeDeclHandler = doctype
    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: stack.pop()
    try:
        parser.Parse(_AMPERSAND.sub("&amp;", _JOINED.sub(r"\1 ", text)), True)
    except (expat.ExpatError, ValueError) as error:  # a text that is no UTF-8
        raise refused(_LINKAGE2_SOURCE, f"no XML: {error}", "a .linkage2 file") from None
    return stack[0].children[0]


def read_linkage2(text: str) -> Sketch:
    """The joints of a file, named by their names or C and their number. Raises DesignError."""
    root = _parsed(text)
    if root.name != "linkage2":
        raise refused(_LINKAGE2_SOURCE, f"its root is {root.name}", "linkage2")
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
            raise refused(_LINKAGE2_SOURCE, f"{len(rows)} links are too many", f"at most {_LINKS}")
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


# -- the address of PMKS+ ---------------------------------------------------------------------------------------


_ALPHABET = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-"
_VALUE = {character: value for value, character in enumerate(_ALPHABET)}
_CHECKED = 62  # characters of the checksum's alphabet
_SCALE = 1000.0
_SLIDES, _INPUT, _GROUNDED, _WELDED = 1, 2, 4, 8  # 16: the path of the joint is shown
_PMKS_UNITS = ("in", "cm", "m")
_POUND, _INCH = 0.45359237, 0.0254
_MASSES = (("lb and lb in²", _POUND, _POUND * _INCH**2), ("g and kg cm²", 1e-3, 1e-4), ("kg and kg m²", 1.0, 1.0))
"""Of mass [kg] and inertia [kg m²], in the order of ``_UNITS``: the program has one system for all."""
_FORCES = (4.4482216152605, 1.0)  # N: of pounds, of newtons
_LOCAL, _OUTWARD = 1, 2
_LONGEST = 20  # characters of a number: the program writes whole numbers of 53 bits
_MOST_PARTS = 2000
_CLOCKWISE, _NO_GRAVITY = 0, 8  # numbers of flags
_PMKS_SOURCE = "address"


def read_pmks(text: str) -> Sketch:
    """The joints of an address. Raises DesignError where it is none, or its checksum is wrong."""
    body = text.strip().split("?", 1)[-1]
    if body.startswith("j=") or "&l=" in body:
        problem = "an address of PMKS+ of 2023 or before (?j=...&l=...), another format"
        raise refused(_PMKS_SOURCE, problem, "an address of today: open this one in PMKS+ and share it again")
    if len(body) < 2 or set(body) - {*_ALPHABET, ".", ","}:
        raise refused(_PMKS_SOURCE, "no address of PMKS+", "the whole text, from the question mark on")
    if body[-1] != _ALPHABET[(len(body) - 1) % _CHECKED]:
        wanted = _ALPHABET[(len(body) - 1) % _CHECKED]
        raise refused(
            _PMKS_SOURCE, f"its checksum is {body[-1]!r}, of its length follows {wanted!r}", "the whole address"
        )
    parts = body[:-1].split(".")
    if len(parts) > _MOST_PARTS:
        raise refused(_PMKS_SOURCE, f"{len(parts)} parts", f"at most {_MOST_PARTS}")
    try:
        flags, _, integers, enums, *rest = parts
        end = rest.index("")
        rows, links, forces = rest[:end], *_groups(rest[end + 1 :])
        joined = [_Link(row) for row in links]
        return _sketch(flags, integers.split(","), enums, [row.split(",") for row in rows if row], joined, forces)
    except (ValueError, IndexError, KeyError) as error:
        raise refused(_PMKS_SOURCE, f"its parts do not fit together ({error})", "the whole address") from None


def _groups(parts: Sequence[str]) -> tuple[list[str], list[str]]:
    """Links, then forces, each ended by an empty part."""
    end = list(parts).index("")
    forces = list(parts[end + 1 : -1])
    return list(parts[:end]), [each for each in forces if each]


class _Link:
    """A link: its name among the joints, whether it is a piston, and no part of another; mass and inertia, where; names of joints, and
    of the links that are parts of it."""

    def __init__(self, row: str) -> None:
        head, self.name, mass, inertia, x, y, _, *names = row.split(",")
        self.mass, self.inertia = _whole(mass) / _SCALE, _whole(inertia) / _SCALE
        self.centre = complex(_whole(x), _whole(y)) / _SCALE
        self.root, self.piston = head[0] == "Y", head[1] == "P"
        self.id = head[2:]
        end = names.index("") if "" in names else len(names)
        self.joints, self.parts = names[:end], [each for each in names[end:] if each]


def _whole(text: str) -> int:
    """A number in base 64; behind a leading 0 negative. Raises ValueError for one that no program writes."""
    if len(text) > _LONGEST:
        raise ValueError(f"{text[:_LONGEST]!r}... is no number")
    value = 0
    for character in text.removeprefix("0"):
        value = 64 * value + _VALUE[character]
    return -value if text.startswith("0") else value


def _sketch(
    flags: str,
    integers: Sequence[str],
    enums: str,
    rows: Sequence[Sequence[str]],
    links: Sequence[_Link],
    forces: Sequence[str],
) -> Sketch:
    setting = sum(_VALUE[character] << 6 * i for i, character in enumerate(reversed(flags)))
    speed = _whole(integers[0]) * (-1.0 if setting >> _CLOCKWISE & 1 else 1.0)
    length = _VALUE[enums[0]] if enums else -1
    joints, inputs, welded = [], [], []
    masses, acting, left = _loads(links, forces, length, _VALUE[enums[2]] if len(enums) > 2 else -1)
    roots = [link for link in links if link.root]
    at = {row[0][1:]: complex(_whole(row[2]), _whole(row[3])) / _SCALE for row in rows}
    of_joint: dict[str, list[_Link]] = {key: [] for key in at}
    for link in roots:
        for key in dict.fromkeys(link.joints):
            of_joint[key].append(link)
    carriers = {part: link for link in roots for part in (link.id, *link.parts)}
    named = dict(zip(at, distinct(row[1] for row in rows), strict=True))
    for row in rows:
        mark, key = _VALUE[row[0][0]], row[0][1:]
        name, angle = named[key], _whole((*row[4:5], "0")[0]) / _SCALE
        on = [link.id for link in of_joint[key]]
        grounded = [GROUND] if mark & _GROUNDED else []
        slot = _slot(row, name, carriers, at)
        if mark & _INPUT:
            inputs.append(SketchInput(name=name, rpm=speed))
        if mark & _WELDED:
            welded += [(on[0], other) for other in on[1:]]
        if mark & _SLIDES:
            pistons = [link.id for link in of_joint[key] if link.piston]
            carrier = [slot[0]] if slot else grounded or [each for each in on if each not in pistons][:1]
            carried = [each for each in on if each not in carrier]
            through = at[slot[1]] if slot else None
            direction = math.degrees(cmath.phase(at[slot[2]] - at[slot[1]]) if slot else angle)
            joints.append(SketchJoint(name, at[key], (*carrier, *carried), SLIDE, direction, through))
        else:
            joints.append(SketchJoint(name, at[key], (*grounded, *on), PIN))
    return Sketch(
        tuple(joints),
        tuple(welded),
        tuple(inputs),
        _PMKS_UNITS[length] if 0 <= length < len(_PMKS_UNITS) else "",
        tuple(left),
        masses=masses,
        forces=acting,
        gravity=not setting >> _NO_GRAVITY & 1,
    )


def _slot(
    row: Sequence[str], name: str, links: Mapping[str, _Link], at: Mapping[str, complex]
) -> tuple[str, str, str] | None:
    """Link that carries a joint's slot, and its two joints through which the slot goes. Raises DesignError for a part of one."""
    parts = [each for each in row[5:8] if each]
    if not parts:
        return None
    allowed = (
        "none, or a link and two joints of it apart from each other, of a joint that slides and is not on the frame"
    )
    carrier = links.get(parts[0])
    if len(parts) != 3 or carrier is None or _VALUE[row[0][0]] & (_SLIDES | _GROUNDED) != _SLIDES:
        raise refused(f"slot of joint {name}", f"no slot in a link ({','.join(row[5:8])[:60]})", allowed)
    _, one, other = parts
    if not {one, other} <= set(carrier.joints) or at[one] == at[other]:
        raise refused(f"slot of joint {name}", f"link {carrier.id} has no two joints {one} and {other}", allowed)
    return carrier.id, one, other


def _loads(
    links: Sequence[_Link], forces: Sequence[str], length: int, unit: int
) -> tuple[tuple[SketchMass, ...], tuple[SketchForce, ...], list[LeftOut]]:
    """Masses, and forces that keep their direction; what is assumed of them, and what cannot be carried over."""
    left: list[LeftOut] = []
    masses: list[SketchMass] = []
    heavy = [link for link in links if link.root and (link.mass or link.inertia)]
    if heavy and 0 <= length < len(_MASSES):
        text, kg, kg_m2 = _MASSES[length]
        masses = [SketchMass(link.id, link.mass * kg, link.inertia * kg_m2, link.centre) for link in heavy]
        left.append(
            LeftOut("unit of masses", f"the address has none: read as {text}, which go with {_PMKS_UNITS[length]}")
        )
    elif heavy:
        left.append(LeftOut("masses of the links", "their unit is not in the address: give them in [[loads.masses]]"))
    carried: list[SketchForce] = []
    for row in forces:
        head, link, name, *places, size = row.split(",")
        x0, y0, x1, y1 = (_whole(each) / _SCALE for each in places)
        along, mark = complex(x1 - x0, y1 - y0), _VALUE[head[0]]
        if not 0 <= unit < len(_FORCES):
            left.append(LeftOut(f"force {name}", "its unit is not in the address"))
        elif mark & _LOCAL:
            left.append(LeftOut(f"force {name}", "it turns with its link: forces here keep their direction"))
        elif not mark & _OUTWARD or not along:
            left.append(LeftOut(f"force {name}", "its sense is not in the address: give it in [[loads.forces]]"))
        else:
            newton = _whole(size) / _SCALE * _FORCES[unit] * along / abs(along)
            carried.append(SketchForce(name, link, complex(x0, y0), newton))
    return tuple(masses), tuple(carried), left


# -- the expression of Pyslvs -----------------------------------------------------------------------------------


_GRAMMAR = "M[J[R, P[x, y], L[ground, name]], ...]"
_WHOLE = re.compile(r"\s*M\s*\[(.*)\]\s*", re.DOTALL)
_JOINT = re.compile(r"\s*+J\s*+\[((?:[^\[\]]++|\[[^\[\]]*+\])*+)\]\s*+(?:,|\Z)")
_ENTRY = re.compile(r"\s*+([A-Za-z]++)\s*+(?:\[([^\[\]]*+)\]\s*+)?(?:,|\Z)")
_NAME = re.compile(r"[A-Za-z_]\w*")


def read_pyslvs(text: str) -> Sketch:
    """The joints of an expression, named P0, P1, ... in their order. Raises DesignError."""
    whole = _WHOLE.fullmatch(_uncommented(text))
    if whole is None:
        raise refused("expression", "no list of joints", _GRAMMAR)
    inside, at = whole[1], 0
    joints: list[SketchJoint] = []
    while match := _JOINT.match(inside, at):
        joints.append(_joint(f"P{len(joints)}", match[1]))
        at = match.end()
    if rest := inside[at:].strip():
        raise refused("expression", f"behind {len(joints)} joints stands {rest[:30]!r}", _GRAMMAR)
    return Sketch(tuple(joints))


def _uncommented(text: str) -> str:
    """The text without its comments: from #[ to #], else from # to the end of the line."""
    parts, at, last = [], 0, text.rfind("#]")
    while (begin := text.find("#", at)) >= 0:
        parts.append(text[at:begin])
        if text.startswith("#[", begin) and begin + 2 <= last:
            at = text.index("#]", begin + 2) + 2
        else:
            at = end if (end := text.find("\n", begin)) >= 0 else len(text)
    return " ".join([*parts, text[at:]])


def _joint(name: str, body: str) -> SketchJoint:
    kind, entries, at = "", {}, 0
    while match := _ENTRY.match(body, at):
        word, inside = match.groups()
        if inside is None and word in (PIN, SLIDE, SLIDING_PIN):
            kind = word
        elif inside is not None and word in ("A", "P", "L", "color"):
            entries[word] = [each for part in inside.split(",") if (each := part.strip())]
        else:
            raise _wrong(name, f"{word!r} is unknown")
        at = match.end()
    if body[at:].strip():
        raise _wrong(name, f"{body[at:].strip()[:30]!r} is unknown")
    place, angle = (_numbers(name, entries.get(key, [])) for key in ("P", "A"))
    links = entries.get("L", [])
    if not kind or len(place) != 2 or len(angle) != (kind != PIN) or not links:
        raise _wrong(name, "its type, angle, place or links lack, or are too many")
    for link in links:
        if not _NAME.fullmatch(link):
            raise _wrong(name, f"{link!r} is no name of a link")
    return SketchJoint(name, complex(*place), tuple(links), kind, angle[0] if angle else 0.0)


def _numbers(name: str, texts: list[str]) -> list[float]:
    try:
        return [bounded_float(each) for each in texts]
    except ValueError:
        raise _wrong(name, f"{', '.join(texts)[:60]!r} are no numbers") from None


def _wrong(name: str, problem: str) -> DesignError:
    return refused(f"joint {name}", problem, "R | P | RP, A[deg], color[...], P[x, y], L[name, ...]")
