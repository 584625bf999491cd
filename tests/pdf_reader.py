"""The text of a PDF's pages as any program finds it: letters by each font's own table, in the order in which they were painted."""

from __future__ import annotations

import re
import zlib

HEX = re.compile(rb"<([0-9A-Fa-f]+)>")
WORDS = re.compile(
    rb"/F(\d+) |<([0-9A-Fa-f]{4})> Tj|\n(ET)\n"
)  # a font is chosen, a letter painted, a piece of text ended


def objects(data: bytes) -> dict[int, bytes]:
    """Number -> what stands between obj and endobj."""
    return {int(m[1]): m[2] for m in re.finditer(rb"\n(\d+) 0 obj\s(.*?)endobj", data, re.DOTALL)}


def stream(body: bytes) -> bytes:
    head, _, rest = body.partition(b"stream\n")
    content = rest.rpartition(b"\nendstream")[0]
    return zlib.decompress(content) if b"FlateDecode" in head else content


def letters(cmap: bytes) -> dict[int, str]:
    """Glyph -> letter, of one bfrange with a list."""
    made: dict[int, str] = {}
    for low, high, rest in re.findall(
        rb"<(\w+)> <(\w+)> (\[.*?\]|<\w+>)", cmap.partition(b"beginbfrange")[2], re.DOTALL
    ):
        codes = HEX.findall(rest)
        for number, glyph in enumerate(range(int(low, 16), int(high, 16) + 1)):
            made[glyph] = chr(int(codes[number if rest.startswith(b"[") else 0], 16))
    return made


def page_texts(data: bytes) -> list[str]:
    """A text for each page, a line for each piece of text that was painted."""
    found = objects(data)
    maps = {
        n: letters(stream(found[int(m[1])]))
        for n, body in found.items()
        if (m := re.search(rb"/ToUnicode (\d+) 0 R", body))
    }
    kids = re.search(rb"/Kids\s*\[(.*?)\]", data, re.DOTALL)
    assert kids is not None
    texts = []
    for page in (found[int(n)] for n in re.findall(rb"(\d+) 0 R", kids[1])):
        content = re.search(rb"/Contents (\d+) 0 R", page)
        assert content is not None
        lines, line, font = [], "", 0
        for name, glyph, ended in WORDS.findall(stream(found[int(content[1])])):
            font = int(name) if name else font
            line += maps[font].get(int(glyph, 16), "?") if glyph else ""
            if ended:
                lines.append(line)
                line = ""
        texts.append("\n".join(lines))
    return texts
