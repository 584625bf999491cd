"""The expression of Pyslvs: M[ joint, ... ], joint J[type, A[deg], color[...], P[x, y], L[name, ...]]."""

from __future__ import annotations

import re

from core.bounds import bounded_float
from core.errors import DesignError
from core.linkage_programs.sketch import PIN, SLIDE, SLIDING_PIN, Sketch, SketchJoint, refused

_GRAMMAR = "M[J[R, P[x, y], L[ground, name]], ...]"
_WHOLE = re.compile(r"\s*M\s*\[(.*)\]\s*", re.DOTALL)
_JOINT = re.compile(r"\s*+J\s*+\[((?:[^\[\]]++|\[[^\[\]]*+\])*+)\]\s*+(?:,|\Z)")
_ENTRY = re.compile(r"\s*+([A-Za-z]++)\s*+(?:\[([^\[\]]*+)\]\s*+)?(?:,|\Z)")
_NAME = re.compile(r"[A-Za-z_]\w*")


def read(text: str) -> Sketch:
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


__all__ = ["read"]
