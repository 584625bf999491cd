"""The HTML and PDF report: a title block and chapters, some of which are optional."""

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
from core.number_text import input_text
from core.output.files.cam_drawing import mechanism_text
from core.output.files.sheet import Letterhead, Logo, read_logo
from core.output.lines import printable
from core.output.report import sections as content
from core.output.report.chapters import CHAPTERS, SHAFT, Subject, sections_of, subject_of
from core.output.report.parts import Block, Number, ReportEquations, ReportPicture, ReportTable, Section, Sentences
from core.process import resources
from core.requests import text_option
from core.study import Study, certificate_of, findings_of

if TYPE_CHECKING:
    from jinja2 import Template


# -- document ---------------------------------------------------------------------------------------------------


SENSES: Mapping[str, str] = MappingProxyType({"ccw": "counter-clockwise", "cw": "clockwise"})

PARTS: Mapping[str, str] = MappingProxyType(
    {
        "inputs": "Inputs, and what is assumed",
        "pictures": "Drawings and curves",
        "profile": "Table of the profile",
        "extremes": "Extremes of all quantities",
        "certificate": "Certificate with bounds",
        "equations": "Equations used, with their source",
        "papers": "Statements of the paper, for an example of a paper",
        "conventions": "Conventions and sources",
    }
)
"""Optional parts of a report; main figures, limits and findings are in every report."""


PAPERS: Mapping[str, tuple[float, float]] = MappingProxyType({"A4": (210.0, 297.0), "Letter": (215.9, 279.4)})
"""Name of a paper -> width and height [mm]."""


@frozen
class Cover(Letterhead):
    """Texts on the first page: customer, author, company, revision and date; and the paper of a PDF."""

    customer: str = text_option("customer, on the first page", default="", metavar="TEXT")
    revision: str = text_option("revision of the design, on the first page", default="", metavar="TEXT")
    date: str = text_option("date on the first page, as text; without it the page has none", default="", metavar="TEXT")
    paper: str = choice("Paper", tuple(PAPERS), default="A4", help="of a PDF")

    @property
    def rows(self) -> tuple[tuple[str, str], ...]:
        """Name and text of every entry that is given."""
        names = ("Customer", "Author", "Company", "Revision", "Date")
        texts = (self.customer, self.author, self.company, self.revision, self.date)
        return tuple((name, printable(text)) for name, text in zip(names, texts, strict=True) if text.strip())


@frozen(eq=False)
class Document:
    """A report as it is written to a file.

    Attributes
    ----------
    title : name of the design
    rows : name and text of the rows of the title block
    sections : sections; one of level 1 begins a chapter
    paper : name of the paper
    logo : logo on the first page
    lacking : why there is no logo, in one line
    """

    title: str
    rows: tuple[tuple[str, str], ...]
    sections: tuple[Section, ...]
    paper: str = "A4"
    logo: Logo | None = None
    lacking: str = ""

    @property
    def pictures(self) -> tuple[ReportPicture, ...]:
        """All pictures of the document, in order."""
        return tuple(block for part in self.sections for block in part.blocks if isinstance(block, ReportPicture))

    @property
    def equations(self) -> tuple[str, ...]:
        """All equations of the document as MathML, in order."""
        blocks = (block for part in self.sections for block in part.blocks if isinstance(block, ReportEquations))
        return tuple(line for block in blocks for row in block.rows for line in row.mathml)


@frozen(eq=False)
class Printed:
    """A document for a file with this ending."""

    document: Document
    ending: str


ENDINGS = (".html", ".pdf")


def document(study: Study, parts: Collection[str] = tuple(PARTS), cover: Cover = Cover()) -> Document:  # noqa: B008, frozen
    """The report of a design. Raises NoSolution where the design has none."""
    subject = subject_of(study, parts)
    sections = sections_of(CHAPTERS, subject)
    rows = (*cover.rows, *_title_rows(subject))
    return Document(printable(study.design.name), rows, tuple(sections), cover.paper, *read_logo(cover))


# -- title block --------------------------------------------------------------------------------------------


def _title_rows(subject: Subject) -> tuple[tuple[str, str], ...]:
    study, design = subject.study, subject.study.design
    findings, proof = findings_of(study, ()), certificate_of(study, ())
    counts = Counter(finding.severity for finding in findings)
    words = ", ".join(f"{counts[s]} {s}{'s' if counts[s] > 1 else ''}" for s in (ERROR, WARNING, NOTE) if counts[s])
    kept = sum(residual.kept for residual in proof.values())
    rows = [("Mechanism", _mechanism(subject)), ("Speed", f"{input_text(design.speed_rpm)} rpm{_sense(study)}")]
    assumed = len(design.assumed)
    rows += [("Assumed", f"{assumed} of the inputs, marked {content.ASSUMED}" if assumed else "none of the inputs")]
    rows += [("Findings", words or "none"), ("Certificate", f"{kept} of {len(proof)} residuals within their bounds")]
    return (*rows, ("Computed with", f"KINDYNA {__version__}"))


def _sense(study: Study) -> str:
    """The sense of rotation of the shaft; empty without a shaft."""
    return "" if study.design.shaft is None else f", {SENSES[study.design.shaft.rotation]}"


def _mechanism(subject: Subject) -> str:
    study = subject.study
    if subject.scope == SHAFT:
        balancer = " and a balance cam" if study.design.balancer is not None else ""
        return f"{len(study.drives)} drives on one shaft{balancer}"
    drive = study.design.drive
    return mechanism_text(study) + ("" if not drive.has_disk else f", {drive.face.noun}, {drive.cam.form.form} cam")


# -- HTML ---------------------------------------------------------------------------------------------------


TEMPLATE = "report.html.jinja"
_HEAD = re.compile(r"^.*?(?=<svg\b)", re.DOTALL)  # XML declaration and document type
_IDS = re.compile(r'\bid="([^"]+)"')


def html(document: Document, pictures: Mapping[ReportPicture, str]) -> str:
    """The document as one HTML file with its pictures as SVG; the report says which pictures are missing."""
    drawn = {picture: inline_svg(text, f"p{number}-") for number, (picture, text) in enumerate(pictures.items(), 1)}
    chapters = numbered_chapters(document)
    missing = any(picture not in drawn for picture in document.pictures)
    logo = document.logo and f"data:{document.logo.kind};base64,{b64encode(document.logo.data).decode()}"
    return template_of(TEMPLATE).render(document=document, chapters=chapters, drawn=drawn, missing=missing, logo=logo)


def template_of(name: str) -> Template:
    """The template of a page, from the resources."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined  # no other command needs it

    loader = FileSystemLoader(str(resources()))
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, loader=loader
    )
    environment.globals |= {"kind": _kind, "number": _number}
    return environment.get_template(name)


def inline_svg(text: str, prefix: str) -> str:
    """An SVG for use inside HTML: without declarations and size, and with names that no other picture has."""
    text = _HEAD.sub("", text, count=1)
    for name in dict.fromkeys(_IDS.findall(text)):
        text = text.replace(f'id="{name}"', f'id="{prefix}{name}"').replace(f"url(#{name})", f"url(#{prefix}{name})")
        text = text.replace(f'"#{name}"', f'"#{prefix}{name}"')
    opening, closing, rest = text.partition(">")
    opening = re.sub(r'\s(?:width|height)="[^"]*"', "", opening)
    return f"{opening}{closing}{rest}".strip()


def numbered_chapters(document: Document) -> list[tuple[str, Section, list[Section]]]:
    """Number, heading and sections of every chapter."""
    chapters: list[tuple[str, Section, list[Section]]] = []
    for part in document.sections:
        if part.level == 1 or not chapters:
            chapters.append((str(len(chapters) + 1), part, []))
        else:
            chapters[-1][2].append(part)
    return chapters


def _kind(block: Block) -> str:
    """Name of a block in the template."""
    return {Sentences: "sentences", ReportTable: "table", ReportPicture: "picture", ReportEquations: "equations"}[
        type(block)
    ]


def _number(cell: Any) -> str | None:
    """Full value of a computed number, for programs; None for any other cell."""
    if not isinstance(cell, Number):
        return None
    return "" if cell.value is None else repr(float(cell.value) + 0.0)
