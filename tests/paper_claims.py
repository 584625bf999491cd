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


def at(paper: str, where: str) -> Claim:
    (claim,) = [claim for claim in of_paper(paper) if claim.where == where]
    return claim


def turned(claim: Claim, **changed: Any) -> str:
    """Its verdict on other numbers."""
    return replace(claim, given={**claim.numbers, **changed}).verdict
