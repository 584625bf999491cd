"""Claims of four papers, compared with the results here, and the figures and tables to which they belong.

Every verdict is a function of numbers, and every number is computed from a study of an example file.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from types import MappingProxyType

from core.frozen import frozen
from core.papers.claim import (
    VERDICTS,
    Claim,
    Drawing,
    Examples,
    FigureTable,
    MechanismPicture,
    MechanismRow,
    PaperFigure,
    Polygon,
    Row,
    ShaftPicture,
)

__all__ = [
    "PAPERS", "VERDICTS", "Claim", "Drawing", "Examples", "FigureTable", "MechanismPicture", "MechanismRow", "Paper",
    "PaperFigure", "Polygon", "Row", "ShaftPicture", "claims",
]  # fmt: skip


@frozen
class Paper:
    """A paper: slug of its module, label in a list, full title, and names of the example files of its claims."""

    slug: str
    label: str
    title: str
    examples: tuple[str, ...]

    @property
    def rows(self) -> tuple[Row, ...]:
        """Rows of claims in the order of the paper."""
        rows: tuple[Row, ...] = import_module(f"{__package__}.{self.slug}").ROWS
        return rows


_ALL = (
    Paper(
        "shin1995",
        "Shin, Kim and Ha 1995",
        "A Study on the Kinetodynamic Analysis for General Disk Cam Driving Slider Mechanisms",
        ("transfer_lift", "transfer_unit"),
    ),
    Paper(
        "yang",
        "Yang and Shon",
        "Study on Blended Cam Design",
        ("card_picker", "dwell_rise_dwell", "card_picker_peak_250"),
    ),
    Paper(
        "velocity",
        "Lecture, chapter 6",
        "Velocity Analysis",
        ("lecture_six_bar", "four_bar", "slider_crank", "rear_suspension"),
    ),
    Paper(
        "kim1990",
        "Kim, Jeon, Lee and Park 1990",
        "Dynamic Stability Analysis of a Single Cam Drive Mechanism",
        ("kim_1990",),
    ),
)
PAPERS: Mapping[str, Paper] = MappingProxyType({paper.slug: paper for paper in _ALL})


def claims(paper: str, examples: Examples | None = None) -> tuple[Claim, ...]:
    """Claims of a paper in its order, each computed at its first access. Raises KeyError for an unknown paper."""
    shared = Examples() if examples is None else examples
    return tuple(Claim(paper, row, shared) for row in PAPERS[paper].rows)
