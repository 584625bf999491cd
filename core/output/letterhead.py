"""Who makes reports and drawings: author, company and its logo."""

from __future__ import annotations

import io
import warnings
from xml.parsers import expat

from core.bounds import NESTING, PIXELS
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
    kind = _svg(data) if data.lstrip()[:1] == b"<" else _image(data)
    if not kind:
        allowed = f"PNG or JPEG of at most {PIXELS / 1e6:g} megapixels, or SVG"
        return None, f"{head.logo}: is no picture that can be read; allowed: {allowed}; the logo is left out"
    return Logo(kind, data), ""


def _svg(data: bytes) -> str:
    """Media type of a picture in XML; empty of another, of what is broken, or nested too deeply."""
    parser, names = expat.ParserCreate(), list[str]()
    root: list[str] = []

    def start(name: str, attributes: dict[str, str]) -> None:
        root[:] = root or [name]
        names.append(name)
        if len(names) > NESTING:
            raise ValueError("nested too deeply")

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: names.pop()
    try:
        parser.Parse(data, True)
    except (expat.ExpatError, ValueError, LookupError):
        return ""
    return SVG if root[0].rpartition(":")[2] == "svg" else ""


def _image(data: bytes) -> str:
    """Media type of a PNG or JPEG; empty of another, of what is broken, or too large."""
    from PIL import Image  # loading it takes longer than a small report

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            with Image.open(io.BytesIO(data), formats=("PNG", "JPEG")) as picture:
                if picture.width * picture.height > PIXELS:
                    return ""
                picture.load()
                return str(picture.get_format_mimetype())
    except Exception:  # what is broken makes the decoders raise anything
        return ""


__all__ = ["SVG", "Letterhead", "Logo", "logo_of"]
