"""The address of PMKS+: what stands behind its question mark, packed text with a checksum."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence

from core.linkage_programs.sketch import (
    GROUND,
    PIN,
    SLIDE,
    LeftOut,
    Sketch,
    SketchForce,
    SketchInput,
    SketchJoint,
    SketchMass,
    distinct,
    refused,
)

_ALPHABET = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-"
_VALUE = {character: value for value, character in enumerate(_ALPHABET)}
_CHECKED = 62  # characters of the checksum's alphabet
_SCALE = 1000.0
_SLIDES, _INPUT, _GROUNDED, _WELDED = 1, 2, 4, 8  # 16: the path of the joint is shown
_UNITS = ("in", "cm", "m")
_POUND, _INCH = 0.45359237, 0.0254
_MASSES = (("lb and lb in²", _POUND, _POUND * _INCH**2), ("g and kg cm²", 1e-3, 1e-4), ("kg and kg m²", 1.0, 1.0))
"""Of mass [kg] and inertia [kg m²], in the order of ``_UNITS``: the program has one system for all."""
_FORCES = (4.4482216152605, 1.0)  # N: of pounds, of newtons
_LOCAL, _OUTWARD = 1, 2
_LONGEST = 20  # characters of a number: the program writes whole numbers of 53 bits
_MOST_PARTS = 2000
_CLOCKWISE, _NO_GRAVITY = 0, 8  # numbers of flags
_SOURCE = "address"


def read(text: str) -> Sketch:
    """The joints of an address. Raises DesignError where it is none, or its checksum is wrong."""
    body = text.strip().split("?", 1)[-1]
    if body.startswith("j=") or "&l=" in body:
        problem = "an address of PMKS+ of 2023 or before (?j=...&l=...), another format"
        raise refused(_SOURCE, problem, "an address of today: open this one in PMKS+ and share it again")
    if len(body) < 2 or set(body) - {*_ALPHABET, ".", ","}:
        raise refused(_SOURCE, "no address of PMKS+", "the whole text, from the question mark on")
    if body[-1] != _ALPHABET[(len(body) - 1) % _CHECKED]:
        wanted = _ALPHABET[(len(body) - 1) % _CHECKED]
        raise refused(_SOURCE, f"its checksum is {body[-1]!r}, of its length follows {wanted!r}", "the whole address")
    parts = body[:-1].split(".")
    if len(parts) > _MOST_PARTS:
        raise refused(_SOURCE, f"{len(parts)} parts", f"at most {_MOST_PARTS}")
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
        _UNITS[length] if 0 <= length < len(_UNITS) else "",
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
        left.append(LeftOut("unit of masses", f"the address has none: read as {text}, which go with {_UNITS[length]}"))
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


__all__ = ["read"]
