"""What is continuous at a join and how far the rest jumps: marks for table and diagram, sentences for tips."""

from __future__ import annotations

from collections.abc import Sequence

from core.design import UNITS, Motion
from core.frozen import frozen
from core.motion import Join
from kindyna_gui.labels import sentence
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import MINUS, digits, with_unit

LETTERS = "svaj"
_PER = ("", "/rad", "/rad²", "/rad³")
_ORDERS = ("displacement", "velocity", "acceleration", "jerk")
_JERK = 3


@frozen
class JoinMark:
    """One quantity at a join: its letter; where it jumps the size of the jump, bare and with its unit; the tone of the theme.

    A jump of jerk is usual and stays quiet; every other one is red.
    """

    letter: str
    size: str = ""
    sized: str = ""
    tone: str = "good"

    @property
    def jumps(self) -> bool:
        """Whether the quantity jumps there."""
        return bool(self.size)

    @property
    def loud(self) -> bool:
        """Whether the jump is a fault, and not only worth knowing."""
        return self.tone == "limit"

    @property
    def colour(self) -> str:
        """The colour of that tone."""
        return str(getattr(SCREEN, self.tone))


def marks(join: Join, motion: Motion) -> tuple[JoinMark, ...]:
    """s, v, a and j at a join."""
    return tuple(_mark(join, motion, order) for order in range(4))


def _mark(join: Join, motion: Motion, order: int) -> JoinMark:
    if not join.jumps[order]:
        return JoinMark(LETTERS[order])
    size = jump_text(join, order, motion).lstrip(MINUS)
    sized = with_unit(size, UNITS[motion.unit].symbol + _PER[order])
    return JoinMark(LETTERS[order], size, sized, "quiet" if order == _JERK else "limit")


def jump_text(join: Join, order: int, motion: Motion) -> str:
    """The jump with its sign, in the motion's unit per radian of cam angle."""
    return digits(float(join.jump[order]) / motion.scale, 3)


FIRST = 3  # of the variants: the first loud jump with its size

Parts = tuple[tuple[str, str], ...]
"""Texts and their colours, from left to right."""


def variants(row: Sequence[JoinMark]) -> tuple[Parts, ...]:
    """The texts for the marks of a join, the longest first: every jump with its size and unit; only the loud ones;
    without units; only the first; none."""
    loud = next((mark for mark in row if mark.loud), None)
    return (
        tuple((_mark_text(mark, mark.sized), mark.colour) for mark in row),
        tuple((_mark_text(mark, mark.sized if mark.loud else ""), mark.colour) for mark in row),
        tuple((_mark_text(mark, mark.size if mark.loud else ""), mark.colour) for mark in row),
        tuple((_mark_text(mark, mark.size if mark is loud else ""), mark.colour) for mark in row),
        tuple((_mark_text(mark, ""), mark.colour) for mark in row),
    )


def _mark_text(mark: JoinMark, size: str) -> str:
    if not mark.jumps:
        return mark.letter
    return f"Δ{mark.letter}\u00a0{size}" if size else f"Δ{mark.letter}"


def join_text(join: Join, motion: Motion) -> str:
    """``s v a Δj``: a letter where the quantity is continuous, its jump where not; the first loud one with its size."""
    return " ".join(text for text, _ in variants(marks(join, motion))[FIRST])


def join_help(join: Join, motion: Motion) -> str:
    """The join in sentences: what is continuous there, and how far the rest jumps."""
    jumping = [k for k in range(4) if join.jumps[k]]
    smooth = [_ORDERS[k] for k in range(4) if k not in jumping]
    rows = [f"continuous in {', '.join(smooth)}"] if smooth else []
    unit = UNITS[motion.unit].symbol
    rows += [f"{_ORDERS[k]} jumps by {with_unit(jump_text(join, k, motion), unit + _PER[k])}" for k in jumping]
    return "\n".join(map(sentence, rows))


__all__ = ["FIRST", "LETTERS", "JoinMark", "Parts", "join_help", "join_text", "jump_text", "marks", "variants"]
