"""The .linkage2 files of Linkage: XML with connectors and links."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from typing import Any
from xml.parsers import expat

from core.bounds import NESTING, bounded_float
from core.linkage_programs.sketch import GROUND, PIN, SLIDING_PIN, LeftOut, Sketch, SketchJoint, refused

_SOURCE = "file"
_UNITS = {"millimeters": "mm", "inches": "in"}
_USUAL_RPM = 15.0


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
            raise refused(_SOURCE, "nested too deeply", f"at most {NESTING} elements in each other")
        element = _Element(name, attributes)
        stack[-1].children.append(element)
        stack.append(element)

    parser.StartDoctypeDeclHandler = doctype
    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: stack.pop()
    try:
        parser.Parse(text, True)
    except (expat.ExpatError, ValueError) as error:  # a text that is no UTF-8
        raise refused(_SOURCE, f"no XML: {error}", "a .linkage2 file") from None
    return stack[0].children[0]


def read(text: str) -> Sketch:
    """The joints of a file, named by their names or C and their number. Raises DesignError."""
    root = _parsed(text)
    if root.name != "linkage2":
        raise refused(_SOURCE, f"its root is {root.name}", "linkage2")
    program = next(root.all("program"), _Element("program", {}))
    scale = program.number("scalefactor", 1.0)
    rows = {each["id"]: each for each in root.all("connector") if each["layer"] in ("", "0")}
    drawn = [each["id"] for each in root.all("connector") if each["id"] not in rows]
    left = [LeftOut(f"connector {key}", "it is on the drawing's layer") for key in drawn]
    of_links: dict[str, list[str]] = {}
    welded: list[tuple[str, str]] = []
    actuators: list[tuple[str, float, float]] = []
    for row in root.all("link", "element"):
        key = f"link{row['id']}"
        of_links[key] = [each["id"] for each in row.all("connector", "fastenconnector") if each["id"] in rows]
        if row["fastenlink"]:
            welded.append((key, f"link{row['fastenlink']}"))
        if row.true("actuator"):
            actuators.append((key, scale * row.number("throw", 0.0), row.number("cpm", _USUAL_RPM)))
    wheels = []
    for ratio in (each for row in root.all("ratios") for each in row.all("ratio")):
        ends = [(f"link{each['id']}", each.number("size", 0.0)) for each in ratio.all("link")]
        if len(ends) == 2 and all(size > 0.0 for _, size in ends):
            turn = ends[0][1] / ends[1][1]
            wheels.append((ends[0][0], ends[1][0], turn if ratio["type"].lower() == "chain" else -turn))
        else:
            left.append(LeftOut(ratio["type"] or "gears", "it has no two sizes"))
    links: dict[str, list[str]] = {key: [GROUND] if row.true("anchor") else [] for key, row in rows.items()}
    for key, connectors in of_links.items():
        for each in connectors:
            links[each].append(key)
    for key, row in rows.items():
        if row["fastenlink"] and f"link{row['fastenlink']}" in of_links:
            links[key].append(f"link{row['fastenlink']}")
    names = {key: row["name"] or f"C{key}" for key, row in rows.items()}
    places = {key: scale * complex(row.number("x", 0.0), row.number("y", 0.0)) for key, row in rows.items()}
    joints = []
    for key, row in rows.items():
        kind, angle, on = PIN, 0.0, links[key]
        if row.true("slider"):
            limits = [each["id"] for each in row.all("slidelimit") if each["id"] in rows]
            carriers = [each for each in links[limits[0]] if each in links[limits[1]]] if len(limits) == 2 else []
            if row.number("slideradius", 0.0):
                left.append(LeftOut(f"slot of {names[key]}", "it is curved"))
            elif not carriers:
                left.append(LeftOut(f"slot of {names[key]}", "its two limits are on no common link"))
            else:
                kind, on = SLIDING_PIN, [carriers[0], *(each for each in on if each != carriers[0])]
                angle = math.degrees(cmath.phase(places[limits[1]] - places[limits[0]]))
        if on:
            joints.append(SketchJoint(names[key], places[key], tuple(dict.fromkeys(on)), kind, angle))
    driven = [row for row in rows.values() if row.true("input")]
    unit = _UNITS.get(program["units"].lower(), "")
    speeds = tuple(row.number("rpm", _USUAL_RPM) for row in driven)
    return Sketch(
        tuple(joints),
        tuple(welded),
        tuple(names[row["id"]] for row in driven),
        speeds,
        unit,
        tuple(left),
        tuple(wheels),
        tuple(actuators),
    )


__all__ = ["read"]
