"""Colours of a cam in space: pressure angles by their part of the limit, and shaded facets."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from PySide6.QtGui import QBrush, QColor

from core.output.drawing.palette import ORANGE
from kindyna_gui.pictures.style import SCREEN

STEPS, LEVELS = 24, 16  # of colours up to the limit, of brightness
PALE, MIDDLE = "#DDE7EF", "#F3DFA8"  # no pressure angle, half of the limit
DARKEST = 0.45  # brightness of a facet in the shade


def scale_rgb(part: np.ndarray) -> np.ndarray:
    """Colours of values by their part of the limit: pale, sand, orange at the limit, red beyond it.

    Parameters
    ----------
    part : ndarray (...), dimensionless
        Value over limit.

    Returns
    -------
    ndarray (..., 3) of uint8, dimensionless
    """
    stops = np.array([_rgb(PALE), _rgb(MIDDLE), _rgb(ORANGE)], dtype=float)
    inside = np.clip(np.nan_to_num(part), 0.0, 1.0)
    rgb = np.stack([np.interp(inside, (0.0, 0.5, 1.0), stops[:, k]) for k in range(3)], axis=-1)
    rgb[part > 1.0] = _rgb(SCREEN.limit)
    return rgb.astype(np.uint8)


def _rgb(colour: str) -> tuple[int, int, int]:
    seen = QColor(colour)
    return seen.red(), seen.green(), seen.blue()


@lru_cache(maxsize=4096)
def _brush(colour: tuple[int, int, int], level: int) -> QBrush:
    bright = DARKEST + (1.0 - DARKEST) * level / (LEVELS - 1)
    return QBrush(QColor(*(round(part * bright) for part in colour)))


def shaded_brushes(
    is_flank: np.ndarray, is_roller: np.ndarray, part: np.ndarray, brightness: np.ndarray
) -> list[QBrush]:
    """Brush of every facet.

    Parameters
    ----------
    is_flank, is_roller : ndarray (k,) of bool, dimensionless
        Sort of the facets; the others belong to the blank.
    part : ndarray (k,), dimensionless
        Pressure angle over its limit, of flanks.
    brightness : ndarray (k,), dimensionless
        0 in the shade, 1 towards the light.

    Returns
    -------
    list of QBrush
    """
    # on dark paper the blank is a light body too: a shaded picture needs room for shadows
    blank, roller = _rgb("#D8D4C8"), _rgb("#B9CBD8")
    coarse = np.where(part > 1.0, 2.0, np.round(np.nan_to_num(part) * STEPS) / STEPS)
    colours = scale_rgb(coarse).tolist()
    levels = np.round(np.clip(brightness, 0.0, 1.0) * (LEVELS - 1)).astype(int).tolist()
    rows = zip(colours, is_flank.tolist(), is_roller.tolist(), levels, strict=True)
    return [
        _brush(tuple(colour) if flank else roller if of_roller else blank, level)
        for colour, flank, of_roller, level in rows
    ]
