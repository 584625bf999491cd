"""The laws in the groups of the picker, with their peaks, and the search by any word of their names."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from core.design import CURVES
from core.laws import LAWS, find_law, peaks
from kindyna_gui.labels import law_label, sentence
from kindyna_gui.pictures.units import short

MOVING = 1e-9  # a velocity at an end above this is one [rise/span]

_GROUPS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "Standing still, constant velocity": ("dwell", "constant-velocity"),
        "Standard laws": (
            "cycloidal",
            "modified-sine",
            "modified-trapezoid",
            "simple-harmonic",
            "double-harmonic",
            "parabolic",
        ),
        "Polynomials": ("2-3", "3-4-5", "4-5-6-7", "5-6-7-8-9", "polynomial"),
        "With constant velocity in the middle": ("mcv20", "mcv33", "mcv50", "mcv66", "scca"),
        "Harmonic series": ("freudenstein-1-3", "freudenstein-1-3-5", "gutman-1-3"),
        "Elementary curves for blending: rise": ("c1", "c2", "c5", "h1", "h2", "h5", "p1", "cv1"),
        "Elementary curves for blending: return": ("c3", "c4", "c6", "h3", "h4", "h6", "p2", "cv2"),
        "Through points": ("spline", "table"),
    }
)

OWN: Mapping[str, str] = MappingProxyType(
    {
        "scca": "own widths",
        "polynomial": "own ends",
        "spline": "own points",
        "table": "own rows",
    }
)
"""What a law with parameters of its own has in place of peaks."""

_SOURCES: Mapping[str, str] = MappingProxyType(
    {
        "scca": "sine, constant and cosine acceleration with widths to choose, and constant velocity in the middle",
        "polynomial": "velocity, acceleration and jerk at both ends to choose",
        "spline": "least jerk through points to choose; periodic where it takes the whole turn",
        "table": "least jerk through rows of a table: measured, or rolled off a drawing",
    }
)


_SHORT: Mapping[str, str] = MappingProxyType(
    {
        "constant-velocity": "Const. v.",
        "simple-harmonic": "Harmonic",
        "double-harmonic": "Double h.",
        "modified-sine": "Mod. sine",
        "modified-trapezoid": "Mod. trap.",
        "2-3": "Poly. 2-3",
        "3-4-5": "Poly. 3-4-5",
        "4-5-6-7": "P. 4-5-6-7",
        "5-6-7-8-9": "P. 5-...-9",
        "freudenstein-1-3": "Freud. 1-3",
        "freudenstein-1-3-5": "Freud. 1-5",
        "gutman-1-3": "Gutman",
        "polynomial": "Polynom.",
        **{slug: slug.upper() for slug in ("c1", "c2", "c3", "c4", "c5", "c6", "h1", "h2", "h3", "h4", "h5", "h6")},
        **{slug: slug.upper() for slug in ("p1", "p2", "cv1", "cv2", "mcv20", "mcv33", "mcv50", "mcv66")},
    }
)


def short_label(slug: str) -> str:
    """The name of a law where there is little room; the whole one where none is shorter."""
    return _SHORT.get(slug, law_label(slug))


def groups() -> dict[str, tuple[str, ...]]:
    """Heading -> laws; every law stands in one of them."""
    grouped = {slug for slugs in _GROUPS.values() for slug in slugs}
    others = tuple(slug for slug in (*LAWS, *CURVES) if slug not in grouped)
    rows = {name: tuple(s for s in slugs if s in LAWS or s in CURVES) for name, slugs in _GROUPS.items()}
    return {**rows, "Others": others} if others else rows


def matching(text: str) -> dict[str, tuple[str, ...]]:
    """The groups with those laws that have all words of a text in their name or that of their group."""
    words = text.lower().split()
    kept = {}
    for name, slugs in groups().items():
        hits = tuple(s for s in slugs if all(w in f"{s} {law_label(s)} {name}".lower() for w in words))
        if hits:
            kept[name] = hits
    return kept


def peaks_text(slug: str) -> str:
    """``Cv 1.76  Ca 5.53  Cj 69.5``; what the law has instead where there are none."""
    law = find_law(slug)
    if slug in OWN or law is None or law.is_dwell:
        return OWN.get(slug, "")
    own = peaks(law)
    rows = (("Cv", own.cv), ("Ca", own.ca), ("Cj", own.cj))
    return "  ".join(f"{name} {short(value, 3)}" for name, value in rows)


def law_tip(slug: str) -> str:
    """What a law is, in a line or two."""
    law = find_law(slug)
    text = sentence(law.source if law is not None else _SOURCES.get(slug, ""))
    if law is not None and not law.is_dwell:
        text += "\nPeaks for unit rise and span; jerk counts the inside of the law only"
        if float(np.abs(law(np.array([0.0, 1.0]))[1]).max()) > MOVING:
            text += "\nIt begins or ends in motion: the velocity jumps where it meets a dwell"
        elif peaks(law).jumps_at_an_end:
            text += "\nIts acceleration jumps where it meets a dwell"
    return text


__all__ = ["OWN", "groups", "law_tip", "matching", "peaks_text", "short_label"]
