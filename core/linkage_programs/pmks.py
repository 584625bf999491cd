"""The address of PMKS+: what stands behind its question mark, packed text with a checksum."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from core.linkage_programs.sketch import GROUND, PIN, SLIDE, LeftOut, Sketch, SketchJoint, refused

_ALPHABET = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-"
_VALUE = {character: value for value, character in enumerate(_ALPHABET)}
_CHECKED = 62  # characters of the checksum's alphabet
_SCALE = 1000.0
_SLIDES, _INPUT, _GROUNDED, _WELDED, _CURVE = 1, 2, 4, 8, 16
_UNITS = ("in", "cm", "m")
_CLOCKWISE = 0  # number of a flag
_SOURCE = "address"


def read(text: str) -> Sketch:
    """The joints of an address. Raises DesignError where it is none, or its checksum is wrong."""
    body = text.strip().split("?", 1)[-1]
    if len(body) < 2 or set(body) - {*_ALPHABET, ".", ","}:
        raise refused(_SOURCE, "no address of PMKS+", "the whole text, from the question mark on")
    if body[-1] != _ALPHABET[(len(body) - 1) % _CHECKED]:
        wanted = _ALPHABET[(len(body) - 1) % _CHECKED]
        raise refused(_SOURCE, f"its checksum is {body[-1]!r}, of its length follows {wanted!r}", "the whole address")
    parts = body[:-1].split(".")
    try:
        flags, _, integers, enums, *rest = parts
        end = rest.index("")
        rows, links, forces = rest[:end], *_groups(rest[end + 1 :])
        joined = [_Link(row) for row in links]
        return _sketch(flags, integers.split(","), enums, [row.split(",") for row in rows if row], joined, forces)
    except (ValueError, IndexError, KeyError) as error:
        raise refused(_SOURCE, f"its parts do not fit together ({error})", "the whole address") from None


def _groups(parts: Sequence[str]) -> tuple[list[str], list[str]]:
    """Links, then forces, each ended by an empty part."""
    end = list(parts).index("")
    forces = list(parts[end + 1 : -1])
    return list(parts[:end]), [each for each in forces if each]


class _Link:
    """A link: its name among the joints, whether it is a piston, mass and inertia, names of joints."""

    def __init__(self, row: str) -> None:
        head, self.name, self.mass, self.inertia, _, _, _, *names = row.split(",")
        self.piston = head[1] == "P"
        self.id = head[2:]
        self.joints = names[: names.index("")] if "" in names else names


def _whole(text: str) -> int:
    """A number in base 64; behind a leading 0 negative."""
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
    clockwise = bool(_VALUE[flags[-1]] >> _CLOCKWISE & 1)
    speed = float(_whole(integers[0])) * (-1.0 if clockwise else 1.0)
    length = _VALUE[enums[0]] if enums else -1
    joints, inputs, welded = [], [], []
    left = list(_left_out(links, forces))
    for row in rows:
        mark, key, name = _VALUE[row[0][0]], row[0][1:], row[1]
        x, y, angle = (_whole(each) / _SCALE for each in (*row[2:5], "0")[:3])
        on = [link.id for link in links if key in link.joints]
        grounded = [GROUND] if mark & _GROUNDED else []
        if mark & _CURVE:
            left.append(LeftOut(f"slot of joint {name}", "it is curved"))
        if mark & _INPUT:
            inputs.append(name)
        if mark & _WELDED:
            welded += [(on[0], other) for other in on[1:]]
        carrier = [row[5]] if len(row) > 5 and row[5] in {link.id for link in links} else []
        if mark & _SLIDES:
            pistons = [link.id for link in links if link.id in on and link.piston]
            others = grounded or carrier or [each for each in on if each not in pistons]
            carried = [each for each in on if each not in others]
            joints.append(SketchJoint(name, complex(x, y), (*others[:1], *carried), SLIDE, math.degrees(angle)))
        else:
            joints.append(SketchJoint(name, complex(x, y), (*grounded, *on), PIN))
    unit = _UNITS[length] if 0 <= length < len(_UNITS) else ""
    return Sketch(tuple(joints), tuple(welded), tuple(inputs), (speed,) * len(inputs), unit, tuple(left))


def _left_out(links: Sequence[_Link], forces: Sequence[str]) -> Iterator[LeftOut]:
    if any(_whole(link.mass) for link in links):
        yield LeftOut("masses of the links", "their unit is not in the address: give them in [[loads.masses]]")
    yield from (LeftOut(f"force {force.split(',')[0][1:]}", "its unit is not in the address") for force in forces)


__all__ = ["read"]
