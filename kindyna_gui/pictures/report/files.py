"""The report to hand on as a file of either ending."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from core.frozen import frozen
from core.output.report.document import ENDINGS, Document, html
from core.output.report.parts import ReportPicture
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.pictures.report.pdf import SCALE, pdf
from kindyna_gui.pictures.report.vectors import Vector, svg, vector

GoOn = Callable[[int], bool]
"""Takes the number of pictures that are drawn; whether to go on."""


@frozen(eq=False)
class PictureKind:
    """A row: the scale that its pictures are drawn for, and what writes it with them."""

    scale: float
    write: Callable[[Document, Mapping[ReportPicture, Vector]], bytes]


def with_pictures(document: Document, drawn: Mapping[ReportPicture, Vector]) -> bytes:
    """As HTML."""
    return html(document, {picture: svg(each, picture.caption) for picture, each in drawn.items()}).encode()


KINDS: Mapping[str, PictureKind] = MappingProxyType(
    {".html": PictureKind(1.0, with_pictures), ".pdf": PictureKind(SCALE, pdf)}
)
assert tuple(KINDS) == ENDINGS


def report_file(document: Document, ending: str, go_on: GoOn = lambda done: True) -> bytes | None:
    """The file of a row of ``KINDS``; None where it was not to go on. Raises NoSolution where a picture has none."""
    ensure_app(offscreen=True)
    kind, drawn = KINDS[ending], {}
    for done, picture in enumerate(document.pictures):
        if not go_on(done):
            return None
        drawn[picture] = vector(picture, kind.scale)
    return kind.write(document, drawn) if go_on(len(drawn)) else None


__all__ = ["KINDS", "report_file"]
