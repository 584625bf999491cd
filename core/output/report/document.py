"""The report to hand on: a title block and chapters, some of which may be left out."""

from __future__ import annotations

import re
from base64 import b64encode
from collections import Counter
from collections.abc import Collection, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from core import __version__
from core.design.fields import choice
from core.findings import ERROR, NOTE, WARNING
from core.frozen import frozen
from core.output.files.cam_drawing import mechanism_text
from core.output.files.sheet import Letterhead, Logo, read_logo
from core.output.lines import printable
from core.output.report import sections as of_study
from core.output.report.chapters import CHAPTERS, SHAFT, Subject, sections_of, subject_of
from core.output.report.parts import Block, Number, ReportEquations, ReportPicture, ReportTable, Section, Sentences
from core.process import resources
from core.requests import text_option
from core.study import Study, certificate_of, findings_of

if TYPE_CHECKING:
    from jinja2 import Template


# -- the report to hand on --------------------------------------------------------------------------------------


SENSES: Mapping[str, str] = MappingProxyType({"ccw": "counter-clockwise", "cw": "clockwise"})

PARTS: Mapping[str, str] = MappingProxyType(
    {
        "inputs": "Inputs, and what is assumed",
        "pictures": "Drawings and curves",
        "profile": "Table of the profile",
        "extremes": "Extremes of all quantities",
        "certificate": "Certificate with bounds",
        "equations": "Equations used, with their source",
        "papers": "What a paper says, of a paper's example",
        "conventions": "Conventions and sources",
    }
)
"""What may be left out of a report; the main figures, limits and findings always stand in it."""


PAPERS: Mapping[str, tuple[float, float]] = MappingProxyType({"A4": (210.0, 297.0), "Letter": (215.9, 279.4)})
"""Size of a page, mm."""


@frozen
class Cover(Letterhead):
    """What stands on the first page besides what is computed: for whom, by whom, which revision and which day, as text; the paper."""

    customer: str = text_option("for whom, on the first page", default="", metavar="TEXT")
    revision: str = text_option("of the design, on the first page", default="", metavar="TEXT")
    date: str = text_option("as it shall stand on the first page; without, none does", default="", metavar="TEXT")
    paper: str = choice("Paper", tuple(PAPERS), default="A4", help="of a PDF")

    @property
    def rows(self) -> tuple[tuple[str, str], ...]:
        """Name and text of what is given."""
        names = ("Customer", "Author", "Company", "Revision", "Date")
        texts = (self.customer, self.author, self.company, self.revision, self.date)
        return tuple((name, printable(text)) for name, text in zip(names, texts, strict=True) if text.strip())


@frozen(eq=False)
class Document:
    """title: the design's name; rows: of the title block, name and text; sections: those of level 1 begin a chapter; paper: of pages;
    logo: on the first; lacking: why it is not there, in a line."""

    title: str
    rows: tuple[tuple[str, str], ...]
    sections: tuple[Section, ...]
    paper: str = "A4"
    logo: Logo | None = None
    lacking: str = ""

    @property
    def pictures(self) -> tuple[ReportPicture, ...]:
        """Every picture of the document, in order."""
        return tuple(block for each in self.sections for block in each.blocks if isinstance(block, ReportPicture))


@frozen(eq=False)
class Printed:
    """A document that is to be a file of this ending."""

    document: Document
    ending: str


ENDINGS = (".html", ".pdf")


def document(study: Study, parts: Collection[str] = tuple(PARTS), cover: Cover = Cover()) -> Document:  # noqa: B008, frozen
    """The report of a design or of a shaft with several drives. Raises NoSolution where it has none."""
    whole = subject_of(study, parts)
    sections = sections_of(CHAPTERS, whole)
    rows = (*cover.rows, *_title_rows(whole))
    return Document(printable(study.design.name), rows, tuple(sections), cover.paper, *read_logo(cover))


# -- title block --------------------------------------------------------------------------------------------


def _title_rows(whole: Subject) -> tuple[tuple[str, str], ...]:
    study, design = whole.study, whole.study.design
    findings, proof = findings_of(study, ()), certificate_of(study, ())
    counts = Counter(each.severity for each in findings)
    found = ", ".join(f"{counts[s]} {s}{'s' if counts[s] > 1 else ''}" for s in (ERROR, WARNING, NOTE) if counts[s])
    kept = sum(each.kept for each in proof.values())
    rows = [("Mechanism", _mechanism(whole)), ("Speed", f"{design.speed_rpm:.10g} rpm{_sense(study)}")]
    assumed = len(design.assumed)
    rows += [("Assumed", f"{assumed} of the inputs, marked {of_study.ASSUMED}" if assumed else "none of the inputs")]
    rows += [("Findings", found or "none"), ("Certificate", f"{kept} of {len(proof)} residuals within their bounds")]
    return (*rows, ("Computed with", f"KINDYNA {__version__}"))


def _sense(study: Study) -> str:
    """The sense of the shaft, of a design that has one."""
    return "" if study.design.shaft is None else f", {SENSES[study.design.shaft.rotation]}"


def _mechanism(whole: Subject) -> str:
    study = whole.study
    if whole.of == SHAFT:
        balanced = " and a balance cam" if study.design.balancer is not None else ""
        return f"{len(study.drives)} drives on one shaft{balanced}"
    drive = study.design.drive
    return mechanism_text(study) + ("" if drive.cam is None else f", {drive.face.noun}, {drive.cam.form.form} cam")


# -- the report as one HTML file that opens anywhere without anything beside it ---------------------------------


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
