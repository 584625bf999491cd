"""The report as one HTML file that opens anywhere without anything beside it: pictures as SVG, equations as MathML."""

from __future__ import annotations

import re
from base64 import b64encode
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from core.output.report.document import Document
from core.output.report.parts import Block, Number, ReportEquations, ReportPicture, ReportTable, Section, Sentences
from core.resources import resources

if TYPE_CHECKING:
    from jinja2 import Template

TEMPLATE = "report.html.jinja"
_HEAD = re.compile(r"^.*?(?=<svg\b)", re.DOTALL)  # XML declaration and document type
_IDS = re.compile(r'\bid="([^"]+)"')


def html(document: Document, pictures: Mapping[ReportPicture, str]) -> str:
    """The document with its pictures as SVG; a picture that is not there is left out, and the report says so."""
    drawn = {picture: inline_svg(text, f"p{number}-") for number, (picture, text) in enumerate(pictures.items(), 1)}
    chapters = numbered_chapters(document)
    missing = any(picture not in drawn for picture in document.pictures)
    logo = document.logo and f"data:{document.logo.kind};base64,{b64encode(document.logo.data).decode()}"
    return template_of(TEMPLATE).render(document=document, chapters=chapters, drawn=drawn, missing=missing, logo=logo)


def template_of(name: str) -> Template:
    """A page's template of the resources."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined  # no other command needs it

    loader = FileSystemLoader(str(resources()))
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, loader=loader
    )
    environment.globals |= {"kind": _kind, "number": _number}
    return environment.get_template(name)


def inline_svg(text: str, prefix: str) -> str:
    """An SVG as it may stand inside HTML: no declarations, its size left to the page, and names that no other picture has."""
    text = _HEAD.sub("", text, count=1)
    for name in dict.fromkeys(_IDS.findall(text)):
        text = text.replace(f'id="{name}"', f'id="{prefix}{name}"').replace(f"url(#{name})", f"url(#{prefix}{name})")
        text = text.replace(f'"#{name}"', f'"#{prefix}{name}"')
    opening, closing, rest = text.partition(">")
    opening = re.sub(r'\s(?:width|height)="[^"]*"', "", opening)
    return f"{opening}{closing}{rest}".strip()


def numbered_chapters(document: Document) -> list[tuple[str, Section, list[Section]]]:
    """Chapters with their numbers and the sections in them."""
    chapters: list[tuple[str, Section, list[Section]]] = []
    for each in document.sections:
        if each.level == 1 or not chapters:
            chapters.append((str(len(chapters) + 1), each, []))
        else:
            chapters[-1][2].append(each)
    return chapters


def _kind(block: Block) -> str:
    """How the template calls a block."""
    return {Sentences: "sentences", ReportTable: "table", ReportPicture: "picture", ReportEquations: "equations"}[
        type(block)
    ]


def _number(cell: Any) -> str | None:
    """The whole value of a computed number, as programs read it; None of any other cell."""
    if not isinstance(cell, Number):
        return None
    return "" if cell.value is None else repr(float(cell.value) + 0.0)


__all__ = ["html", "inline_svg", "numbered_chapters", "template_of"]
