"""One statement of a paper against the numbers that come out here; its verdict follows from these numbers alone."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import cached_property
from math import isnan
from typing import Any, NamedTuple

from core.frozen import frozen
from core.papers.examples import Examples
from core.papers.sheet import Drawing, Sheet, Table, table_of

AGREES, DIFFERS, MISPRINT = "agrees", "differs", "misprint"
Numbers = Mapping[str, Any]
Judgement = tuple[str, str]
"""Verdict and sentence."""
Judge = Callable[..., Judgement]


@frozen(eq=False)
class Row:
    """One row of a paper's table.

    where, says  the place and what stands there
    numbers      what is computed of the examples: all that verdict and sentence depend on
    judge        plain function of these numbers
    example      the file that it is about
    sheet        the figure or table that it belongs to; None: its own numbers are the table
    """

    where: str
    says: str
    numbers: Callable[[Examples], Numbers]
    judge: Judge
    example: str
    sheet: Sheet | None = None


@frozen(eq=False)
class Claim:
    """A row of a paper with the examples that it is computed of, each part when it is read."""

    paper: str
    row: Row
    examples: Examples
    given: Numbers | None = None

    @property
    def where(self) -> str:
        return self.row.where

    @property
    def says(self) -> str:
        return self.row.says

    @property
    def judge(self) -> Judge:
        return self.row.judge

    @cached_property
    def numbers(self) -> Numbers:
        if self.given is not None:
            return self.given
        made: Numbers = self.examples.once((self.paper, self.where), lambda: self.row.numbers(self.examples))
        return made

    @cached_property
    def judgement(self) -> Judgement:
        return self.row.judge(**self.numbers)

    @property
    def verdict(self) -> str:
        """Whether that is the same."""
        return self.judgement[0]

    @property
    def here(self) -> str:
        """What comes out here, in words."""
        return self.judgement[1]

    # -- its figure or table --------------------------------------------------------------------------------

    @property
    def name(self) -> str:
        """Of its files."""
        return slug(self.where) if self.row.sheet is None else self.row.sheet.name

    @property
    def title(self) -> str:
        return f"{self.where}: {self.says}" if self.row.sheet is None else self.row.sheet.title

    @cached_property
    def table(self) -> Table:
        return table_of(self.numbers, self.title) if self.row.sheet is None else self.row.sheet.table(self.examples)

    @cached_property
    def drawing(self) -> Drawing:
        """What is painted: the table itself where there is nothing else."""
        if self.row.sheet is None or self.row.sheet.drawing is None:
            return self.table
        return self.row.sheet.drawing(self.examples)


def slug(where: str) -> str:
    """``(18)`` -> ``eq_18``; ``Table 2, I_L`` -> ``table_2_i_l``."""
    text = where.replace("→", "to").replace("§", "section ")
    text = f"eq {text}" if text.startswith("(") else text
    return re.sub(r"\W+", "_", text.lower()).strip("_")


# -- what a verdict is made of ------------------------------------------------------------------------------


class Compared(NamedTuple):
    """A number as printed and as it comes out here, and how far apart they may be."""

    printed: float
    here: float
    within: float
    unit: str = ""

    @property
    def same(self) -> bool:
        return abs(self.here - self.printed) <= self.within


def agreement(kept: object) -> str:
    return AGREES if kept else DIFFERS


def misprint_or_not(wrong_as_printed: bool, wrong_as_corrected: bool) -> str:
    if not wrong_as_printed:
        return AGREES
    return DIFFERS if wrong_as_corrected else MISPRINT


def as_printed(**rows: Compared) -> Judgement:
    """Agrees where every number is the printed one."""
    parts = [f"{name} = {_figure(row.here)}{row.unit and ' ' + row.unit}" for name, row in rows.items()]
    apart = [f"{name} is printed {_figure(row.printed)}" for name, row in rows.items() if not row.same]
    return agreement(not apart), ", ".join(parts) + (f"; but {', '.join(apart)}" if apart else "")


def kept(sentence: str) -> Judge:
    """Agrees where ``off`` is not above ``bound``; the sentence is filled with the numbers."""

    def judge(off: float, bound: float, **more: Any) -> Judgement:
        return agreement(off <= bound), sentence.format(off=off, bound=bound, **more)

    return judge


def misprint(sentence: str) -> Judge:
    """A misprint where the formula as printed is off by more than ``bound`` and the corrected one is not: ``printed`` and
    ``corrected`` say by how much."""

    def judge(printed: float, corrected: float, bound: float, **more: Any) -> Judgement:
        verdict = misprint_or_not(not printed <= bound, not corrected <= bound)
        return verdict, sentence.format(printed=printed, corrected=corrected, bound=bound, **more)

    return judge


def _figure(value: float) -> str:
    return "nothing" if isnan(value) else f"{value:.10g}"
