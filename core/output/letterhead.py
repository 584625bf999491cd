"""Who makes reports and drawings: author, company and its logo."""

from __future__ import annotations

import io
from xml.etree import ElementTree

from core.errors import FileError
from core.frozen import frozen
from core.project.files import read_bytes
from core.requests import typed

SVG = "image/svg+xml"


@frozen(eq=False)
class Logo:
    """A picture file: its media type and its bytes."""

    kind: str
    data: bytes


@frozen
class Letterhead:
    """As text; logo: a file."""

    author: str = typed("by whom", default="", metavar="TEXT")
    company: str = typed("of which company", default="", metavar="TEXT")
    logo: str = typed("its logo: PNG, JPEG or SVG", default="", metavar="FILE")


def logo_of(head: Letterhead) -> tuple[Logo | None, str]:
    """The logo, and in a line why there is none where one was named: what is written is written without it."""
    if not head.logo.strip():
        return None, ""
    try:
        data = read_bytes(head.logo)
    except FileError as error:
        return None, f"{error}; the logo is left out"
    kind = _kind(data)
    if not kind:
        return None, f"{head.logo}: is no picture that can be read; allowed: PNG, JPEG or SVG; the logo is left out"
    return Logo(kind, data), ""


def _kind(data: bytes) -> str:
    """Media type; empty of what is none of the three, or broken."""
    if data.lstrip()[:1] == b"<":
        try:
            root = ElementTree.fromstring(data)
        except ElementTree.ParseError:
            return ""
        return SVG if root.tag.rpartition("}")[2] == "svg" else ""
    from PIL import Image  # loading it takes longer than a small report

    try:
        with Image.open(io.BytesIO(data), formats=("PNG", "JPEG")) as picture:
            picture.load()
            return str(picture.get_format_mimetype())
    except (OSError, SyntaxError, ValueError):
        return ""


__all__ = ["SVG", "Letterhead", "Logo", "logo_of"]
