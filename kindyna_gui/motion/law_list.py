"""The laws in the groups of the picker, with their peaks, and the search by any word of their names."""

from __future__ import annotations

import numpy as np

from core.laws import law_groups, named_law, peaks
from kindyna_gui.labels import law_label, sentence
from kindyna_gui.pictures.units import short

MOVING = 1e-9  # a velocity at an end above this is one [rise/span]


def matching(text: str) -> dict[str, tuple[str, ...]]:
    """The groups with those laws that have all words of a text in their name or that of their group."""
    words = text.lower().split()
    kept = {}
    for name, slugs in law_groups().items():
        hits = tuple(s for s in slugs if all(w in f"{s} {law_label(s)} {name}".lower() for w in words))
        if hits:
            kept[name] = hits
    return kept


def peaks_text(slug: str) -> str:
    """``Cv 1.76  Ca 5.53  Cj 69.5``; what the law has instead where there are none."""
    law = named_law(slug)
    if law.is_dwell or not law.pieces:
        return law.own
    own = peaks(law)
    rows = (("Cv", own.cv), ("Ca", own.ca), ("Cj", own.cj))
    return "  ".join(f"{name} {short(value, 3)}" for name, value in rows)


def law_tip(slug: str) -> str:
    """What a law is, in a line or two."""
    law = named_law(slug)
    text = sentence(law.help or law.source)
    if law.pieces and not law.is_dwell:
        text += "\nPeaks for unit rise and span; jerk counts the inside of the law only"
        if float(np.abs(law(np.array([0.0, 1.0]))[1]).max()) > MOVING:
            text += "\nIt begins or ends in motion: the velocity jumps where it meets a dwell"
        elif peaks(law).jumps_at_an_end:
            text += "\nIts acceleration jumps where it meets a dwell"
    return text


__all__ = ["law_tip", "matching", "peaks_text"]
