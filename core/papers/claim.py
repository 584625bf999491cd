"""One statement of a paper against the numbers that come out here; its verdict follows from these numbers alone."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import cached_property
from math import isnan
from types import MappingProxyType
from typing import Any, NamedTuple

from core.frozen import frozen
from core.papers.examples import Examples
from core.papers.sheet import Drawing, FigureTable, PaperFigure, table_of

AGREES, DIFFERS, MISPRINT, METHOD, CONVENTION = "agrees", "differs", "misprint", "method", "convention"
LIMIT, ROUNDED, CONTRADICTION, AS_SCANNED = "limit", "rounded", "contradiction", "as-scanned"
VERDICTS: Mapping[str, str] = MappingProxyType({
    AGREES: "what comes out here is what the paper says",
    DIFFERS: "what comes out here is something else",
    MISPRINT: "wrong as the text reads",
    METHOD: "an error of the authors' reasoning",
    CONVENTION: "right in its own convention of signs",
    LIMIT: "right where it is used, singular or approximate elsewhere",
    ROUNDED: "right but for the digits that are printed or carried",
    CONTRADICTION: "the paper against itself",
    AS_SCANNED: "wrong as the text reads, in dots, primes, indices, ρ or j that the scan may have lost",
})  # fmt: skip
"""Kind of verdict -> what it means."""

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
    sheet: PaperFigure | None = None


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
    def table(self) -> FigureTable:
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


class ComparedNumber(NamedTuple):
    """A number as printed and as it comes out here, how far apart they may be, and how far where the print is rounded on the way."""

    printed: float
    here: float
    within: float
    unit: str = ""
    rounded: float = 0.0

    @property
    def apart(self) -> float:
        return abs(self.here - self.printed)

    @property
    def same(self) -> bool:
        return self.apart <= self.within


def agreement(kept: object) -> str:
    """The word for a statement that is kept, or is not."""
    return AGREES if kept else DIFFERS


def parted(kind: str, wrong_as_printed: bool, wrong_as_corrected: bool) -> str:
    """Of this kind where the print is wrong and what should stand there is not."""
    if not wrong_as_printed:
        return AGREES
    return DIFFERS if wrong_as_corrected else kind


def as_printed(**rows: ComparedNumber) -> Judgement:
    """Agrees where every number is the printed one; rounded where some are so but for a rounding on the way."""
    parts = [f"{name} = {_figure(row.here)}{row.unit and ' ' + row.unit}" for name, row in rows.items()]
    apart = {name: row for name, row in rows.items() if not row.same}
    rounded = all(row.apart <= row.rounded for row in apart.values())
    verdict = AGREES if not apart else ROUNDED if rounded else DIFFERS
    words = ", ".join(f"{name} is printed {_figure(row.printed)}" for name, row in apart.items())
    return verdict, ", ".join(parts) + (f"; {'rounded on the way,' if rounded else 'but'} {words}" if apart else "")


def kept(sentence: str) -> Judge:
    """Agrees where ``off`` is not above ``bound``; the sentence is filled with the numbers."""

    def judge(off: float, bound: float, **more: Any) -> Judgement:
        return agreement(off <= bound), sentence.format(off=off, bound=bound, **more)

    return judge


def mended(kind: str, sentence: str) -> Judge:
    """Of this kind where the print is off by more than ``bound`` and what should stand there is not: ``printed`` and ``corrected`` say by
    how much."""

    def judge(printed: float, corrected: float, bound: float, **more: Any) -> Judgement:
        verdict = parted(kind, not printed <= bound, not corrected <= bound)
        return verdict, sentence.format(printed=printed, corrected=corrected, bound=bound, **more)

    return judge


def limited(sentence: str) -> Judge:
    """A limit where the print is off by no more than ``bound`` as it is ``used``, and by more ``elsewhere``."""

    def judge(used: float, elsewhere: float, bound: float, **more: Any) -> Judgement:
        verdict = parted(LIMIT, not max(used, elsewhere) <= bound, not used <= bound)
        return verdict, sentence.format(used=used, elsewhere=elsewhere, bound=bound, **more)

    return judge


def named(kind: str, sentence: str) -> Judge:
    """Of this kind where the printed ``symbol`` is not that of the quantity that belongs there, ``needed``: of those in ``known``,
    symbol -> value, one must be that within ``bound`` of it."""

    def judge(symbol: str, needed: float, known: Mapping[str, float], bound: float, **more: Any) -> Judgement:
        fitting = [each for each, value in known.items() if abs(needed / value - 1.0) <= bound]
        verdict = parted(kind, symbol not in fitting, not fitting)
        return verdict, sentence.format(symbol=symbol, needed=needed, fitting=" or ".join(fitting) or "nothing", **more)

    return judge


def _figure(value: float) -> str:
    return "nothing" if isnan(value) else f"{value:.10g}"
