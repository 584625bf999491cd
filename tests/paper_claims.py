"""The claims of all papers on the examples as they ship, computed once for all tests, and verdicts on other numbers."""

from dataclasses import replace
from functools import cache
from typing import Any

from core.papers import PAPERS, Claim, Examples, claims

EXAMPLES = Examples()


@cache
def of_paper(paper: str) -> tuple[Claim, ...]:
    return claims(paper, EXAMPLES)


def every_claim() -> list[Claim]:
    return [claim for paper in PAPERS for claim in of_paper(paper)]


SLOW = {("kim1990", where) for where in ("Figs. 6, 7", "Figs. 6, 7, contact", "Fig. 12")}
"""Claims that integrate the means of eleven Q, and a steady turn without contact: two thirds of the time of all."""


def quick_claims() -> list[Claim]:
    """Every claim but ``SLOW``."""
    return [claim for claim in every_claim() if (claim.paper, claim.where) not in SLOW]


def at(paper: str, where: str) -> Claim:
    (claim,) = [claim for claim in of_paper(paper) if claim.where == where]
    return claim


def turned(claim: Claim, **changed: Any) -> str:
    """Its verdict on other numbers."""
    return replace(claim, given={**claim.numbers, **changed}).verdict
