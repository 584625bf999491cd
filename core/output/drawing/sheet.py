"""Sheets of paper for pictures: colours that follow light and dark paper, widths and texts in pixels, a document.

An element has its colours on light paper as attributes and a class for each, ``kd-f-cam`` for a fill and ``kd-s-ink`` for a line.
The style of the document has the colours of these classes on dark paper, the colour of the paper among them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

from core.output.drawing import svg
from core.output.drawing.palette import DARK, FAMILIES, LIGHT, Palette, family_colour

FONTS = "DejaVu Sans, Noto Sans, Liberation Sans, Segoe UI, Helvetica, Arial, sans-serif"
TEXT, SMALL = 12.0, 11.0  # sizes of texts, pixels
THIN, OUTLINE = 1.0, 1.4  # widths of lines, pixels
CHAIN, DOTTED, DASHED = (10.0, 3.0, 1.5, 3.0), (1.5, 3.0), (6.0, 4.0)  # dashes and gaps, pixels
_WIDE = 0.6  # mean width of a character, relative to the size of the text
_CLASS = re.compile(r"kd-([fs])-([a-z0-9-]+)")


def role_colour(role: str, palette: Palette) -> str:
    """Colour of a role: a field of the palette, ``link-2`` for a link's fill, or a family of quantities."""
    if role.startswith("link-"):
        return palette.links[int(role.removeprefix("link-")) % len(palette.links)]
    if role in FAMILIES:
        return family_colour(role, palette)
    colour: str = getattr(palette, role.replace("-", "_"))
    return colour


def paint(fill: str = "none", stroke: str = "none") -> dict[str, svg.Value | None]:
    """Attributes for a fill and a line in the colours of their roles."""
    classes = [f"kd-{kind}-{role}" for kind, role in (("f", fill), ("s", stroke)) if role != "none"]
    colours = {
        name: role if role == "none" else role_colour(role, LIGHT)
        for name, role in (("fill", fill), ("stroke", stroke))
    }
    return {"class_": " ".join(classes) or None, **colours}


def dark_style(lines: Sequence[str]) -> str:
    """Style element with the colours of all classes in the lines on dark paper."""
    used = sorted({match for line in lines for match in _CLASS.findall(line)})
    words = {"f": "fill", "s": "stroke"}
    rules = "".join(f".kd-{kind}-{role}{{{words[kind]}:{role_colour(role, DARK)}}}" for kind, role in used)
    return f"<style>@media (prefers-color-scheme:dark){{{rules}}}</style>"


def text_width(label: str, size: float = SMALL) -> float:
    """Approximate width of a text [pixels]."""
    return _WIDE * size * len(label)


def picture(
    lines: Iterable[str], width: float, height: float, title: str, about: str, box: Mapping[str, float] | None = None
) -> str:
    """Document with its own paper, of a size in pixels.

    Parameters
    ----------
    lines : iterable of str
        Elements.
    width, height : float [pixels]
    title, about : str
        Title and description.
    box : mapping, optional
        Left, top, width and height of the view box; by default that of the pixels.
    """
    frame = box or {"x": 0.0, "y": 0.0, "width": width, "height": height}
    drawn = [svg.element("rect", **frame, **paint("paper")), *lines]
    return svg.document(
        [dark_style(drawn), *drawn],
        (frame["x"], frame["y"], frame["width"], frame["height"]),
        (f"{width:g}", f"{height:g}"),
        title,
        about,
        font_family=FONTS,
        role="img",
    )
