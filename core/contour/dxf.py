"""A DXF file in text form, tag by tag: the unit of its header, its layers, its blocks, and the entities of its model space. Of a file of
many thousand lines nothing else is looked at."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

from core.bounds import ROWS, bounded_float
from core.design.fields import LONGEST_MM
from core.frozen import frozen

COMMENT, UNIT_CODE, PAPER_SPACE = 999, "$INSUNITS", 67
_PARTS = ("VERTEX", "SEQEND")  # of the POLYLINE before them


class NoDrawing(ValueError):
    """The text is no DXF file; the message says why."""


@frozen(eq=False)
class Entity:
    """An entity: its tags in order, group code and text; parts: the vertices of a POLYLINE."""

    kind: str
    codes: Sequence[int]
    texts: Sequence[str]
    parts: list[Entity]

    @property
    def layer(self) -> str:
        """Name of the layer; ``0`` where the file states none."""
        return self.text(8, "0")

    def text(self, code: int, otherwise: str) -> str:
        """Of the first tag of a group code."""
        return self.texts[self.codes.index(code)].strip() if code in self.codes else otherwise

    def number(self, code: int, otherwise: float = 0.0) -> float:
        """The same as a number. Raises NoDrawing."""
        return as_number(self.text(code, str(otherwise)))

    def point(self, code: int) -> complex:
        """x and y: y's group code is 10 more."""
        return complex(self.number(code), self.number(code + 10))

    @property
    def upwards(self) -> tuple[float, float, float]:
        """The direction in which it is seen as it is drawn."""
        return self.number(210), self.number(220), self.number(230, 1.0)

    def numbers(self, code: int) -> list[float]:
        """The numbers of all tags of a group code. Raises NoDrawing."""
        return [as_number(text) for each, text in zip(self.codes, self.texts, strict=True) if each == code]


@frozen(eq=False)
class Drawing:
    """What is read of a file: $INSUNITS, 0 where it is not stated; entities of the model space; name of a block in capitals -> its
    entities, the first of which is the block itself; names in capitals of layers that are off or frozen."""

    unit: int
    entities: list[Entity]
    blocks: Mapping[str, list[Entity]]
    hidden: frozenset[str]


def as_number(text: str) -> float:
    """The number of a tag. Raises NoDrawing where it is none, or larger than any drawing's."""
    try:
        value = bounded_float(text)
    except ValueError:
        value = math.nan
    if not abs(value) <= LONGEST_MM:
        raise NoDrawing(f"{text.strip()[:40]} is no number of a drawing; allowed: {-LONGEST_MM:g} ... {LONGEST_MM:g}")
    return value


def read_dxf(text: str) -> tuple[int, list[Entity]]:
    """$INSUNITS, 0 where it is not stated, and the entities. Raises NoDrawing."""
    drawing = read_drawing(text)
    return drawing.unit, [each for each in drawing.entities if each.number(PAPER_SPACE) == 0.0]


def read_drawing(text: str) -> Drawing:
    """The drawing in a text, entities of the paper space among the others. Raises NoDrawing."""
    if max(text.count("\n"), text.count("\r")) > 2 * ROWS:
        raise NoDrawing(f"more than {ROWS} group codes; save what is needed of it alone")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\n").split("\n")
    try:
        codes = [int(line) for line in lines[::2]]
    except ValueError as error:
        raise NoDrawing(f"a group code is wanted: {str(error)[:80]}") from None
    texts = lines[1::2]
    unit, entities, inside = 0, list[Entity](), ""
    blocks, hidden = dict[str, list[Entity]](), set[str]()
    block: list[Entity] = []
    for kind, first, last in _blocks(codes, texts):
        if kind == "SECTION":
            inside = texts[first].strip() if first < last else ""
            if inside == "HEADER":
                unit = _unit(texts[first:last])
        elif kind == "ENDSEC":
            inside = ""
        elif inside in ("ENTITIES", "BLOCKS", "TABLES"):
            entity = Entity(kind, codes[first:last], texts[first:last], [])
            if inside == "TABLES":
                if kind == "LAYER" and _is_hidden(entity):
                    hidden.add(entity.text(2, "").upper())
                continue
            if kind == "BLOCK":
                block = blocks[entity.text(2, "").upper()] = []
            into = entities if inside == "ENTITIES" else block
            if kind not in _PARTS:
                into.append(entity)
            elif kind == "VERTEX" and into:
                into[-1].parts.append(entity)
    if inside or not codes or codes[0] not in (0, COMMENT):
        raise NoDrawing(f"section {inside} has no end" if inside else "it begins with no section")
    return Drawing(unit, entities, blocks, frozenset(hidden))


def _is_hidden(layer: Entity) -> bool:
    """Whether a layer is off, which its negative colour says, or frozen."""
    try:
        return layer.number(62) < 0.0 or bool(int(layer.number(70)) & 1)
    except NoDrawing:
        return False


def _blocks(codes: Sequence[int], texts: Sequence[str]) -> Iterator[tuple[str, int, int]]:
    """What group code 0 names, and from where to where its tags go."""
    begins = [i for i, code in enumerate(codes[: len(texts)]) if code == 0]
    for begin, end in pairwise([*begins, len(texts)]):
        yield texts[begin].strip().upper(), begin + 1, end


def _unit(header: Sequence[str]) -> int:
    for name, value in pairwise(header):
        if name.strip() == UNIT_CODE:
            return int(as_number(value))
    return 0


__all__ = ["Drawing", "Entity", "NoDrawing", "as_number", "read_drawing", "read_dxf"]
