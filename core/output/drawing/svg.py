"""SVG: elements, groups and documents; every SVG of the core is written here. The y axis of paper points down."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from html import escape
from unicodedata import category

import numpy as np

NAMESPACE = "http://www.w3.org/2000/svg"
DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>'
Value = str | float


def text_of(value: Value, decimals: int | None = None) -> str:
    """Value of an attribute: a text, or a number with all digits or with some decimals; never minus zero."""
    if isinstance(value, str):
        return escape(allowed(value))
    if decimals is None:
        return repr(float(value) + 0.0)
    text = f"{round(float(value), decimals) + 0.0:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if decimals else text


def allowed(text: str) -> str:
    """Text without the characters that XML does not allow."""
    return "".join(
        c if c.isprintable() or c == "\n" or category(c) == "Zs" else "\N{REPLACEMENT CHARACTER}" for c in text
    )


def element(tag: str, content: str = "", /, **attributes: Value | None) -> str:
    """One element; ``_`` in names of attributes stands for ``-``, and attributes of None are left out."""
    words = "".join(
        f' {name.rstrip("_").replace("_", "-")}="{text_of(value)}"'
        for name, value in attributes.items()
        if value is not None
    )
    return f"<{tag}{words}>{content}</{tag}>" if content else f"<{tag}{words}/>"


def text(label: str, **attributes: Value | None) -> str:
    """Element with a text."""
    return element("text", escape(allowed(label), quote=False), **attributes)


def point(z: complex, separator: str = " ", decimals: int | None = None) -> str:
    """Coordinates of a point whose y axis points up."""
    return f"{text_of(z.real, decimals)}{separator}{text_of(-z.imag, decimals)}"


def polyline(z: np.ndarray, is_closed: bool = False, decimals: int | None = None, **attributes: Value | None) -> str:
    """Lines from point to point.

    Parameters
    ----------
    z : ndarray (n,) complex [unit of the drawing]
        Points, with the y axis up.
    is_closed : bool
        Whether the last point is joined to the first.
    decimals : int, optional
        Decimals of the coordinates; all digits where None.
    """
    points = " ".join(point(at, ",", decimals) for at in z.tolist())
    return element("polygon" if is_closed else "polyline", points=points, **attributes)


def circle(centre: complex, radius: float, decimals: int | None = None, **attributes: Value | None) -> str:
    """Circle about a centre with the y axis up."""
    x, y = point(centre, " ", decimals).split()
    return element("circle", cx=x, cy=y, r=text_of(radius, decimals), **attributes)


def line(start: complex, end: complex, decimals: int | None = None, **attributes: Value | None) -> str:
    """Straight line between two points with the y axis up."""
    (x1, y1), (x2, y2) = (point(z, " ", decimals).split() for z in (start, end))
    return element("line", x1=x1, y1=y1, x2=x2, y2=y2, **attributes)


def group(lines: Iterable[str], **attributes: Value | None) -> list[str]:
    """Lines of a group."""
    return [element("g", **attributes).removesuffix("/>") + ">", *lines, "</g>"]


def document(
    lines: Iterable[str],
    box: tuple[float, float, float, float],
    size: tuple[str, str],
    title: str,
    about: str = "",
    comment: Sequence[str] = (),
    **attributes: Value | None,
) -> str:
    """Text of an SVG file.

    Parameters
    ----------
    lines : iterable of str
        Elements.
    box : tuple of float
        Left, top, width and height of the view box.
    size : tuple of str
        Width and height with their unit.
    title, about : str
        Title and description, which viewers and screen readers give.
    comment : sequence of str
        Lines of a comment.
    """
    view = " ".join(f"{value:.9g}" for value in box)
    remarks = ["<!--", *(re.sub("-(?=-)", "- ", allowed(remark)) for remark in comment), "-->"] if comment else []
    root = element("svg", xmlns=NAMESPACE, width=size[0], height=size[1], viewBox=view, **attributes)
    heads = [
        f"<{tag}>{escape(allowed(words), quote=False)}</{tag}>"
        for tag, words in (("title", title), ("desc", about))
        if words
    ]
    return "\n".join([DECLARATION, *remarks, root.removesuffix("/>") + ">", *heads, *lines, "</svg>\n"])
