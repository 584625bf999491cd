"""The report to hand on as a file of either ending."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from core.output.report.document import ENDINGS, Document
from core.output.report.html import html
from kindyna_gui.pictures.report.pdf import pdf
from kindyna_gui.pictures.report.vectors import svg, vector


def with_pictures(document: Document) -> bytes:
    """As HTML with its pictures. Raises NoAnswer."""
    return html(document, {picture: svg(vector(picture), picture.caption) for picture in document.pictures}).encode()


FILES: Mapping[str, Callable[[Document], bytes]] = MappingProxyType({".html": with_pictures, ".pdf": pdf})
assert tuple(FILES) == ENDINGS

__all__ = ["FILES", "with_pictures"]
