"""The section of a report that holds the example of a paper against what the paper says of it, figure by figure."""

from __future__ import annotations

from core.design import Design
from core.output.report.parts import Section, Sentences, section, table


def of_papers(design: Design) -> list[Section]:
    """A table for each paper of which the design is an example, unchanged; in the order of the paper."""
    from core.papers import PAPERS, Examples, claims  # only a report asks for them

    examples, sections = Examples(), list[Section]()
    for slug, paper in PAPERS.items():
        own = {row.example for row in paper.rows if examples.design(row.example) == design}
        rows = [
            (each.where, each.says, each.here, each.verdict)
            for each in claims(slug, examples)
            if each.row.example in own
        ]
        of = Sentences((f"{paper.label}: {paper.title}.",))
        sections += (
            section("", of, table(("where", "what it says", "here", "verdict"), rows, left=4, slug="paper"))
            if rows
            else []
        )
    return sections


__all__ = ["of_papers"]
