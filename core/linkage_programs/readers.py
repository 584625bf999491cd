"""Readers of the linkages of other programs: .linkage2 files, PMKS+ addresses, Pyslvs expressions."""

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

# -- common form of the imported linkages -----------------------------------------------------------------------


GROUND = "ground"
PIN, SLIDE, SLIDING_PIN = "R", "P", "RP"
PIXEL = "1/96 in"
"""Unit of a drawing on the screen."""


@frozen
class LeftOut:
    """An item that was not imported, and the reason."""

    what: str
    why: str


@frozen
class SketchJoint:
    """A joint at its drawn position, in the unit of the text.

    A pin of all its links (of a single link: a traced point), or a slide along a line at ``angle_deg`` of the first
    link: the others cannot turn on it as a slide, but can as a sliding pin. ``through``: a point of that line, where
    the joint is on it but for rounding.
    """

    name: str
    at: complex
    links: tuple[str, ...]
    kind: str = PIN
    angle_deg: float = 0.0
    through: complex | None = None


@frozen
class Swing:
    """Reciprocating motion at constant speed, ``cycles`` per minute.

    ``stroke`` [deg, or the unit of the text]; ``start``: the part of a cycle before the drawn position; ``sign`` of the
    first half.
    """

    stroke: float
    start: float
    cycles: float
    sign: float = 1.0


@frozen(kw_only=True)
class SketchInput:
    """An input: a joint, or, with ``length``, a link of two joints whose length changes.

    rpm: speed of a rotating input, None where it is unknown; swing: of a reciprocating one; manual: operated by hand
    only.
    """

    name: str
    rpm: float | None = None
    swing: Swing | None = None
    length: bool = False
    manual: bool = False

    @property
    def label(self) -> str:
        """Name for the user."""
        return f"actuator {self.name.removeprefix('link')}" if self.length else self.name

    @property
    def joint(self) -> str:
        """Name of the driven joint; for a changing length the slide between tube and rod."""
        return f"{self.name}_slide" if self.length else self.name


@frozen
class WheelPair:
    """Two links that rotate relative to their carrier, with the ratio of the second rotation to the first."""

    first: str
    second: str
    carrier: str
    ratio: float

    def on(self, merged: Mapping[str, str]) -> WheelPair:
        """The pair with merged links replaced."""
        first, second, carrier = (merged[link] for link in (self.first, self.second, self.carrier))
        return WheelPair(first, second, carrier, self.ratio)


@frozen
class SketchMass:
    """Mass of a link [kg], inertia about its centre of mass [kg m²], and that centre in the unit of the text."""

    link: str
    mass_kg: float
    inertia_kg_m2: float
    at: complex


@frozen
class SketchForce:
    """A force [N] of constant direction at a point of a link, in the unit of the text."""

    name: str
    link: str
    at: complex
    newton: complex


@frozen
class Sketch:
    """An imported linkage.

    Attributes
    ----------
    joints : of the linkage
    welded : pairs of rigidly connected links
    inputs : in the order of the text
    unit : of lengths, empty where it is unknown
    """

    joints: tuple[SketchJoint, ...]
    welded: tuple[tuple[str, str], ...] = ()
    inputs: tuple[SketchInput, ...] = ()
    unit: str = ""
    left_out: tuple[LeftOut, ...] = ()
    wheels: tuple[WheelPair, ...] = ()
    masses: tuple[SketchMass, ...] = ()
    forces: tuple[SketchForce, ...] = ()
    gravity: bool = True


def import_error(source: str, problem: str, allowed: str) -> DesignError:
    """Error for a text that is not a linkage of its program."""
    return DesignError([Fault(source, MISSING, problem, allowed)])


def distinct(names: Iterable[str]) -> list[str]:
    """The names, with a number appended to repeated ones."""
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


# -- .linkage2 files of Linkage ---------------------------------------------------------------------------------


_LINKAGE2_SOURCE = "file"
_RPM = 15.0  # and strokes per minute, where the file states none
_DEG_PER_REVOLUTION = 360.0
_MECHANISM = ~0xF  # bits of a layer; without one it belongs to the mechanism
_LEAST_ARC = 0.0009  # least excess of a curved slot's radius over half the distance of its ends
_LINKS, _RATIO = 1000, 1e6  # at most
_JOINED = re.compile(r'(="[^"]*")(?=\w)')  # attributes without a blank between them, from older versions
_AMPERSAND = re.compile(r"&(?!#?\w{1,31};)")  # names are not escaped


class _Element:
    """An XML element with its attributes and children."""

    def __init__(self, name: str, attributes: dict[str, str]) -> None:
        self.name, self.attributes, self.children = name.lower(), attributes, list[_Element]()

    def all(self, *names: str) -> Iterator[_Element]:
        return (child for child in self.children if child.name in names)

    def __getitem__(self, key: str) -> str:
        return self.attributes.get(key, "")

    def is_true(self, key: str) -> bool:
        return self[key].lower() == "true"

    @property
    def is_mechanism(self) -> bool:
        """Whether it is on a layer of the mechanism; layer 1 is the drawing's."""
        return not self["layer"] or (layer := int(self.number("layer", 0.0))) == 0 or bool(layer & _MECHANISM)

    def number(self, key: str, default: float) -> float:
        text = self[key]
        try:
            return bounded_float(text) if text else default
        except ValueError:
            label = f"{self.name} {self['id'][:20]}"
            raise import_error(_LINKAGE2_SOURCE, f"{label}: {key} = {text[:40]!r} is no number", "a number") from None


def _parse_xml(text: str) -> _Element:
    """Root element. Raises DesignError for a text that is not XML, and for a DOCTYPE, which may name other files."""
    parser, stack = expat.ParserCreate(), [_Element("", {})]

    def doctype(*_: Any) -> None:
        raise import_error(_LINKAGE2_SOURCE, "it has a DOCTYPE", "a file as Linkage writes it, without one")

    def start(name: str, attributes: dict[str, str]) -> None:
        if len(stack) > NESTING:
            raise import_error(_LINKAGE2_SOURCE, "its elements are nested too deep", f"at most {NESTING} levels")
        element = _Element(name, attributes)
        stack[-1].children.append(element)
        stack.append(element)

    parser.StartDoctypeDeclHandler = doctype
    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: stack.pop()
    try:
        parser.Parse(_AMPERSAND.sub("&amp;", _JOINED.sub(r"\1 ", text)), True)
    except (expat.ExpatError, ValueError) as error:  # a text that is not UTF-8
        raise import_error(_LINKAGE2_SOURCE, f"no XML: {error}", "a .linkage2 file") from None
    return stack[0].children[0]


def read_linkage2(text: str) -> Sketch:
    """Sketch of a .linkage2 file, with joints named as in the file, or C and their number. Raises DesignError."""
    root = _parse_xml(text)
    if root.name != "linkage2":
        raise import_error(_LINKAGE2_SOURCE, f"its root is {root.name}", "linkage2")
    return _File(root).sketch()


class _File:
    """Connectors and links of a file on layers of the mechanism.

    A repeated id of a connector means the first one; repeated links are all imported.
    """

    def __init__(self, root: _Element) -> None:
        connectors: dict[str, _Element] = {}
        for row in root.all("connector"):
            connectors.setdefault(row["id"], row)
        self.rows = {key: row for key, row in connectors.items() if row.is_mechanism}
        self.omitted = [
            LeftOut(f"connector {key}", "it is on the drawing's layer") for key in connectors if key not in self.rows
        ]
        named = distinct(row["name"].strip() or f"C{key}" for key, row in self.rows.items())
        self.names = dict(zip(self.rows, named, strict=True))
        self.at = {key: complex(row.number("x", 0.0), row.number("y", 0.0)) for key, row in self.rows.items()}
        rows = [row for row in root.all("link", "element") if row.is_mechanism]
        if len(rows) > _LINKS:
            raise import_error(_LINKAGE2_SOURCE, f"{len(rows)} links are too many", f"at most {_LINKS}")
        self.links = dict(zip(distinct(f"link{row['id']}" for row in rows), rows, strict=True))
        self.on = {key: dict.fromkeys([GROUND] * row.is_true("anchor")) for key, row in self.rows.items()}
        self.connectors = {link: self._connectors(row) for link, row in self.links.items()}
        for link, keys in self.connectors.items():
            for key in keys:
                self.on[key][link] = None
        self.wheels = tuple(self._wheels(root))
        self.welded = [*self._fastened_pairs()]
        self.welded += [*self._input_pairs()]

    def _connectors(self, row: _Element) -> list[str]:
        keys = (child["id"] for child in row.all("connector", "fastenconnector"))
        return list(dict.fromkeys(key for key in keys if key in self.rows))

    def _is_frame(self, keys: list[str]) -> bool:
        return len({self.at[key] for key in keys if self.rows[key].is_true("anchor")}) > 1

    def _fastened_pairs(self) -> Iterator[tuple[str, str]]:
        """Links rigidly connected with a link, with the frame at an anchor, or with the link of another connector."""
        for link, row in self.links.items():
            yield from ((link, fastened) for fastened in self._links_fastened_to(row) if fastened != link)

    def _links_fastened_to(self, row: _Element) -> Iterator[str]:
        """Links to which a link or a connector is fastened."""
        link, connector = f"link{row['fastenlink'] or row['fasten']}", row["fastenconnector"]
        yield from (target for target in [link] if target in self.links)
        for target in [*self.on.get(connector, ())][:1]:
            yield target
            if target != GROUND:
                label, name = f"{row.name} {row['id']}", self.names[connector]
                self.omitted.append(LeftOut(label, f"fastened to {name}: imported as rigid with its first link"))

    def _input_pairs(self) -> Iterator[tuple[str, str]]:
        """All links on a driven anchor rotate with it, except those of the frame."""
        frame = {GROUND, *(link for link, target in self.welded if target == GROUND)}
        frame |= {link for link, keys in self.connectors.items() if self._is_frame(keys)}
        for key, row in self.rows.items():
            if row.is_true("input") and row.is_true("anchor"):
                driven = [link for link in self.on[key] if link not in frame]
                yield from ((driven[0], target) for target in driven[1:])

    def _wheels(self, root: _Element) -> Iterator[WheelPair]:
        """Gears and chains, each with the link that carries both wheels."""
        neighbours: dict[str, dict[str, None]] = {}  # link -> the links on its connectors
        for ratio in (child for row in root.all("ratios") for child in row.all("ratio")):
            kind = ratio["type"].lower() or "chain"
            ends = [(f"link{wheel['id']}", wheel.number("size", 0.0)) for wheel in ratio.all("link")]
            if (
                len(ends) != 2
                or not {ends[0][0], ends[1][0]} <= self.links.keys()
                or any(size <= 0.0 for _, size in ends)
            ):
                self.omitted.append(LeftOut(kind, "it has no two wheels with sizes"))
                continue
            (first, first_size), (second, second_size) = ends
            for link in {first, second} - neighbours.keys():
                neighbours[link] = dict.fromkeys(near for key in self.connectors[link] for near in self.on[key])
            common = [link for link in neighbours[first] if link in neighbours[second] and link not in (first, second)]
            if not 1.0 / _RATIO < first_size / second_size < _RATIO:
                self.omitted.append(
                    LeftOut(f"{kind} of {first} and {second}", f"their sizes differ {_RATIO:g} times or more")
                )
            elif not common:
                self.omitted.append(LeftOut(f"{kind} of {first} and {second}", "no link carries both wheels"))
            else:
                yield WheelPair(
                    first, second, common[0], -first_size / second_size if kind == "gears" else first_size / second_size
                )

    def _carrier(self, first: str, second: str) -> str | None:
        """The link, or frame, that contains two connectors."""
        return next((link for link in self.on[first] if link in self.on[second]), None)

    def sketch(self) -> Sketch:
        """The sketch; links on a single connector are dots of the drawing, except wheels and fastened ones."""
        fastened = {key: [*self._links_fastened_to(row)] for key, row in self.rows.items()}
        used = {GROUND, *(link for pair in self.welded for link in pair)}
        used |= {link for links in fastened.values() for link in links}
        used |= {link for pair in self.wheels for link in (pair.first, pair.second)}
        used |= {link for link, keys in self.connectors.items() if len(keys) > 1}
        joints: list[SketchJoint] = []
        for key in self.rows:
            joints += self._joints(key, [*(link for link in self.on[key] if link in used), *fastened[key]])
        inputs = (*self._pin_inputs(), *self._actuator_inputs())
        joined = (joint for joint in joints if joint.links)
        return Sketch(tuple(joined), tuple(self.welded), inputs, PIXEL, tuple(self.omitted), self.wheels)

    def _joints(self, key: str, on: list[str]) -> Iterator[SketchJoint]:
        """Joints of a connector: a pin, a pin in a slot, or the end of an arm about the centre of a curved slot."""
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
        """Link that carries a connector's slot, and the two ends of the slot."""
        limits = [limit["id"] for limit in row.all("slidelimit") if limit["id"] in self.rows][:2]
        if not row.is_true("slider"):
            return None
        carrier = self._carrier(*limits) if len(limits) == 2 else None
        if carrier is None or self.at[limits[0]] == self.at[limits[1]]:
            why = "its two limits are on no common link" if len(limits) == 2 else "it has no two limits"
            self.omitted.append(LeftOut(f"slot of {name}", f"{why}: the joint is free"))
            return None
        return carrier, self.at[limits[0]], self.at[limits[1]]

    def _pin_inputs(self) -> Iterator[SketchInput]:
        """Inputs at connectors; a positive speed is clockwise."""
        for key, row in self.rows.items():
            if not row.is_true("input"):
                continue
            rpm, limit = -self._per_minute(row, "rpm", f"speed of {self.names[key]}"), row.number("limitangle", 0.0)
            swing = None
            if limit > 0.0:
                cycles = abs(rpm) * _DEG_PER_REVOLUTION / (2.0 * limit)
                swing = Swing(limit, row.number("startoffset", 0.0), cycles, math.copysign(1.0, rpm))
            yield SketchInput(name=self.names[key], rpm=rpm, swing=swing, manual=row.is_true("alwaysmanual"))

    def _actuator_inputs(self) -> Iterator[SketchInput]:
        """Links of two connectors whose length changes, first shorter where the strokes per minute are negative."""
        for link, row in self.links.items():
            if row.is_true("actuator") and len(self.connectors[link]) == 2:
                cpm = self._per_minute(row, "cpm", f"strokes of actuator {link.removeprefix('link')}")
                stroke, start = abs(row.number("throw", 0.0)), row.number("startoffset", 0.0)
                if not stroke:
                    self.omitted.append(
                        LeftOut(f"actuator {link.removeprefix('link')}", "it has no throw: it is a bar")
                    )
                    continue
                swing = Swing(stroke, start, abs(cpm), math.copysign(1.0, cpm))
                yield SketchInput(name=link, swing=swing, length=True, manual=row.is_true("alwaysmanual"))

    def _per_minute(self, row: _Element, key: str, label: str) -> float:
        """Revolutions or strokes per minute, or the default."""
        value = row.number(key, _RPM)
        if not value:
            self.omitted.append(LeftOut(label, f"it is 0 in the file: read as {_RPM:g} a minute"))
        return value or _RPM


# -- address of PMKS+ -------------------------------------------------------------------------------------------


_ALPHABET = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-"
_VALUE = {character: value for value, character in enumerate(_ALPHABET)}
_CHECKED = 62  # characters of the checksum's alphabet
_SCALE = 1000.0
_SLIDES, _INPUT, _GROUNDED, _WELDED = 1, 2, 4, 8  # 16: the path of the joint is drawn
_PMKS_UNITS = ("in", "cm", "m")
_POUND, _INCH = 0.45359237, 0.0254
_MASSES = (("lb and lb in²", _POUND, _POUND * _INCH**2), ("g and kg cm²", 1e-3, 1e-4), ("kg and kg m²", 1.0, 1.0))
"""Units of mass [kg] and inertia [kg m²], in the order of ``_PMKS_UNITS``: the program has one system of units."""
_FORCES = (4.4482216152605, 1.0)  # N: of pounds, of newtons
_LOCAL, _OUTWARD = 1, 2
_LONGEST = 20  # characters of a number: the program writes integers of 53 bits
_MOST_PARTS = 2000
_CLOCKWISE, _NO_GRAVITY = 0, 8  # numbers of flags
_PMKS_SOURCE = "address"


def read_pmks(text: str) -> Sketch:
    """Sketch of an address. Raises DesignError where it is none, or its checksum is wrong."""
    body = text.strip().split("?", 1)[-1]
    if body.startswith("j=") or "&l=" in body:
        problem = "an address of PMKS+ of 2023 or before (?j=...&l=...), another format"
        raise import_error(_PMKS_SOURCE, problem, "a current address: open this one in PMKS+ and share it again")
    if len(body) < 2 or set(body) - {*_ALPHABET, ".", ","}:
        raise import_error(_PMKS_SOURCE, "no address of PMKS+", "the whole text, from the question mark on")
    if body[-1] != _ALPHABET[(len(body) - 1) % _CHECKED]:
        expected = _ALPHABET[(len(body) - 1) % _CHECKED]
        raise import_error(
            _PMKS_SOURCE, f"its checksum is {body[-1]!r}, of its length follows {expected!r}", "the whole address"
        )
    parts = body[:-1].split(".")
    if len(parts) > _MOST_PARTS:
        raise import_error(_PMKS_SOURCE, f"{len(parts)} parts", f"at most {_MOST_PARTS}")
    try:
        flags, _, integers, enums, *rest = parts
        end = rest.index("")
        rows, links, forces = rest[:end], *_groups(rest[end + 1 :])
        joined = [_Link(row) for row in links]
        return _pmks_sketch(flags, integers.split(","), enums, [row.split(",") for row in rows if row], joined, forces)
    except (ValueError, IndexError, KeyError) as error:
        raise import_error(_PMKS_SOURCE, f"its parts do not fit together ({error})", "the whole address") from None


def _groups(parts: Sequence[str]) -> tuple[list[str], list[str]]:
    """Links, then forces, each list ended by an empty part."""
    end = list(parts).index("")
    forces = list(parts[end + 1 : -1])
    return list(parts[:end]), [force for force in forces if force]


class _Link:
    """A link: mass, inertia and centre of mass, names of its joints, and of the links that are parts of it.

    root: it is no part of another link; piston: it is a piston.
    """

    def __init__(self, row: str) -> None:
        flags, self.name, mass, inertia, x, y, _, *names = row.split(",")
        self.mass, self.inertia = _whole(mass) / _SCALE, _whole(inertia) / _SCALE
        self.centre = complex(_whole(x), _whole(y)) / _SCALE
        self.root, self.piston = flags[0] == "Y", flags[1] == "P"
        self.id = flags[2:]
        end = names.index("") if "" in names else len(names)
        self.joints, self.parts = names[:end], [part for part in names[end:] if part]


def _whole(text: str) -> int:
    """Integer in base 64, negative after a leading 0. Raises ValueError for a longer one than the program writes."""
    if len(text) > _LONGEST:
        raise ValueError(f"{text[:_LONGEST]!r}... is not a number")
    value = 0
    for character in text.removeprefix("0"):
        value = 64 * value + _VALUE[character]
    return -value if text.startswith("0") else value


def _pmks_sketch(
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
    masses, point_forces, omitted = _loads(links, forces, length, _VALUE[enums[2]] if len(enums) > 2 else -1)
    roots = [link for link in links if link.root]
    at = {row[0][1:]: complex(_whole(row[2]), _whole(row[3])) / _SCALE for row in rows}
    of_joint: dict[str, list[_Link]] = {key: [] for key in at}
    for link in roots:
        for key in dict.fromkeys(link.joints):
            of_joint[key].append(link)
    carriers = {part: link for link in roots for part in (link.id, *link.parts)}
    named = dict(zip(at, distinct(row[1] for row in rows), strict=True))
    for row in rows:
        bits, key = _VALUE[row[0][0]], row[0][1:]
        name, angle = named[key], _whole((*row[4:5], "0")[0]) / _SCALE
        on = [link.id for link in of_joint[key]]
        grounded = [GROUND] if bits & _GROUNDED else []
        slot = _slot(row, name, carriers, at)
        if bits & _INPUT:
            inputs.append(SketchInput(name=name, rpm=speed))
        if bits & _WELDED:
            welded += [(on[0], link) for link in on[1:]]
        if bits & _SLIDES:
            pistons = [link.id for link in of_joint[key] if link.piston]
            carrier = [slot[0]] if slot else grounded or [link for link in on if link not in pistons][:1]
            guided = [link for link in on if link not in carrier]
            through = at[slot[1]] if slot else None
            direction = math.degrees(cmath.phase(at[slot[2]] - at[slot[1]]) if slot else angle)
            joints.append(SketchJoint(name, at[key], (*carrier, *guided), SLIDE, direction, through))
        else:
            joints.append(SketchJoint(name, at[key], (*grounded, *on), PIN))
    return Sketch(
        tuple(joints),
        tuple(welded),
        tuple(inputs),
        _PMKS_UNITS[length] if 0 <= length < len(_PMKS_UNITS) else "",
        tuple(omitted),
        masses=masses,
        forces=point_forces,
        gravity=not setting >> _NO_GRAVITY & 1,
    )


def _slot(
    row: Sequence[str], name: str, links: Mapping[str, _Link], at: Mapping[str, complex]
) -> tuple[str, str, str] | None:
    """Link with a joint's slot, and its two joints that define the slot. Raises DesignError for an incomplete slot."""
    parts = [part for part in row[5:8] if part]
    if not parts:
        return None
    allowed = (
        "none, or a link and two of its joints at different positions, of a sliding joint that is not on the frame"
    )
    carrier = links.get(parts[0])
    if len(parts) != 3 or carrier is None or _VALUE[row[0][0]] & (_SLIDES | _GROUNDED) != _SLIDES:
        raise import_error(f"slot of joint {name}", f"no slot in a link ({','.join(row[5:8])[:60]})", allowed)
    _, first, second = parts
    if not {first, second} <= set(carrier.joints) or at[first] == at[second]:
        raise import_error(
            f"slot of joint {name}", f"link {carrier.id} has no two joints {first} and {second}", allowed
        )
    return carrier.id, first, second


def _loads(
    links: Sequence[_Link], forces: Sequence[str], length: int, unit: int
) -> tuple[tuple[SketchMass, ...], tuple[SketchForce, ...], list[LeftOut]]:
    """Masses, forces of constant direction, and the items that are assumed or not imported."""
    omitted: list[LeftOut] = []
    masses: list[SketchMass] = []
    with_mass = [link for link in links if link.root and (link.mass or link.inertia)]
    if with_mass and 0 <= length < len(_MASSES):
        text, kg, kg_m2 = _MASSES[length]
        masses = [SketchMass(link.id, link.mass * kg, link.inertia * kg_m2, link.centre) for link in with_mass]
        omitted.append(
            LeftOut("unit of masses", f"the address has none: read as {text}, which go with {_PMKS_UNITS[length]}")
        )
    elif with_mass:
        omitted.append(
            LeftOut("masses of the links", "their unit is not in the address: give them in [[loads.masses]]")
        )
    imported: list[SketchForce] = []
    for row in forces:
        flags, link, name, *coordinates, size = row.split(",")
        x0, y0, x1, y1 = (_whole(value) / _SCALE for value in coordinates)
        along, bits = complex(x1 - x0, y1 - y0), _VALUE[flags[0]]
        if not 0 <= unit < len(_FORCES):
            omitted.append(LeftOut(f"force {name}", "its unit is not in the address"))
        elif bits & _LOCAL:
            omitted.append(LeftOut(f"force {name}", "it turns with its link: imported forces keep their direction"))
        elif not bits & _OUTWARD or not along:
            omitted.append(LeftOut(f"force {name}", "its direction is not in the address: give it in [[loads.forces]]"))
        else:
            newton = _whole(size) / _SCALE * _FORCES[unit] * along / abs(along)
            imported.append(SketchForce(name, link, complex(x0, y0), newton))
    return tuple(masses), tuple(imported), omitted


# -- expression of Pyslvs ---------------------------------------------------------------------------------------


_GRAMMAR = "M[J[R, P[x, y], L[ground, name]], ...]"
_WHOLE = re.compile(r"\s*M\s*\[(.*)\]\s*", re.DOTALL)
_JOINT = re.compile(r"\s*+J\s*+\[((?:[^\[\]]++|\[[^\[\]]*+\])*+)\]\s*+(?:,|\Z)")
_ENTRY = re.compile(r"\s*+([A-Za-z]++)\s*+(?:\[([^\[\]]*+)\]\s*+)?(?:,|\Z)")
_NAME = re.compile(r"[A-Za-z_]\w*")


def read_pyslvs(text: str) -> Sketch:
    """Sketch of an expression, with joints P0, P1, ... in their order. Raises DesignError."""
    expression = _WHOLE.fullmatch(_uncommented(text))
    if expression is None:
        raise import_error("expression", "no list of joints", _GRAMMAR)
    body, position = expression[1], 0
    joints: list[SketchJoint] = []
    while match := _JOINT.match(body, position):
        joints.append(_joint(f"P{len(joints)}", match[1]))
        position = match.end()
    if rest := body[position:].strip():
        raise import_error("expression", f"unexpected {rest[:30]!r} after {len(joints)} joints", _GRAMMAR)
    return Sketch(tuple(joints))


def _uncommented(text: str) -> str:
    """The text without its comments: from #[ to #], or from # to the end of the line."""
    parts, position, last = [], 0, text.rfind("#]")
    while (begin := text.find("#", position)) >= 0:
        parts.append(text[position:begin])
        if text.startswith("#[", begin) and begin + 2 <= last:
            position = text.index("#]", begin + 2) + 2
        else:
            position = end if (end := text.find("\n", begin)) >= 0 else len(text)
    return " ".join([*parts, text[position:]])


def _joint(name: str, body: str) -> SketchJoint:
    kind, entries, position = "", {}, 0
    while match := _ENTRY.match(body, position):
        word, values = match.groups()
        if values is None and word in (PIN, SLIDE, SLIDING_PIN):
            kind = word
        elif values is not None and word in ("A", "P", "L", "color"):
            entries[word] = [entry for part in values.split(",") if (entry := part.strip())]
        else:
            raise _wrong(name, f"{word!r} is unknown")
        position = match.end()
    if body[position:].strip():
        raise _wrong(name, f"{body[position:].strip()[:30]!r} is unknown")
    point, angle = (_numbers(name, entries.get(key, [])) for key in ("P", "A"))
    links = entries.get("L", [])
    if not kind or len(point) != 2 or len(angle) != (kind != PIN) or not links:
        raise _wrong(name, "its type, angle, position or links are missing, or are too many")
    for link in links:
        if not _NAME.fullmatch(link):
            raise _wrong(name, f"{link!r} is not a name of a link")
    return SketchJoint(name, complex(*point), tuple(links), kind, angle[0] if angle else 0.0)


def _numbers(name: str, texts: list[str]) -> list[float]:
    try:
        return [bounded_float(text) for text in texts]
    except ValueError:
        raise _wrong(name, f"{', '.join(texts)[:60]!r} are not numbers") from None


def _wrong(name: str, problem: str) -> DesignError:
    return import_error(f"joint {name}", problem, "R | P | RP, A[deg], color[...], P[x, y], L[name, ...]")
