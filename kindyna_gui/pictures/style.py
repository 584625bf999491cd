"""Style of the window and its drawings: themes, pens, brushes and fonts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial, wraps
from typing import Any, TypeVar

from PySide6.QtCore import Qt
from PySide6.QtGui import QBrush, QColor, QFont, QIcon, QPen

from core.frozen import frozen
from core.output.drawing import palette
from core.output.drawing.palette import (
    BLACK,
    BLUE,
    FAMILIES,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    Palette,
    lightened,
)
from kindyna_gui.settings import sized

# -- colours and themes ----------------------------------------------------------------------------------

DRIVES = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK)
"""Colours of the drives on one shaft, in the order of their list."""
BALANCE = "#5A6B7B"
"""Colour of the balance cam."""

THIN, OUTLINE = 1.0, 1.5  # widths in pixels at every zoom


@frozen
class Theme(Palette):
    """Colours of paper, drawing and window.

    Attributes
    ----------
    desk, line : window around the papers; frames
    chosen, chosen_row, idle : selection; its row in a table; selection in a window without focus
    assumed, good, greyed : assumed values; signs of success; disabled texts
    title, button, row, tip : title bars, buttons, every second row of a table, tips
    dwell : dwells next to the player
    hair : finer grid of a drawing
    light, midlight, mid, dark, shadow : edges of Qt's style
    ratio : dots per pixel of the device; Qt counts the width of cosmetic pens in dots
    """

    desk: str
    line: str
    chosen: str
    chosen_row: str
    assumed: str
    good: str
    title: str
    button: str
    row: str
    tip: str
    greyed: str
    dwell: str
    hair: str
    light: str
    midlight: str
    mid: str
    dark: str
    shadow: str
    idle: str
    ratio: float = 1.0

    def link(self, number: int) -> str:
        """Fill of a link, the same in every drawing."""
        return self.links[(number - 2) % len(self.links)]

    def pen(self, colour: str, width: float = THIN, dash: tuple[float, ...] = ()) -> QPen:
        """Pen with a width in pixels at every zoom; dashes in pixels."""
        return QPen(_pen(colour, width, dash, self.ratio))

    def text_colour(self, colour: str) -> str:
        """Colour of the same hue for texts, dark enough to be read on light paper."""
        base = QColor(self.seen(colour))
        light = 0.2126 * base.redF() + 0.7152 * base.greenF() + 0.0722 * base.blueF()
        pale = QColor(self.paper).lightnessF() > 0.5 and light > 0.5
        return base.darker(140).name() if pale else base.name()

    def family(self, name: str) -> str:
        """Colour of a family of quantities on this paper."""
        colour = FAMILIES.get(name, self.quiet)
        return self.ink if colour == BLACK else self.seen(colour)

    def drive(self, number: int) -> str:
        """Colour of a drive, numbered from 0, on this paper; after the last colour, shades of the colours follow."""
        round_number, index = divmod(number, len(DRIVES))
        return self.seen(shade(DRIVES[index], round_number))

    def seen(self, colour: str) -> str:
        """Colour of the same hue with enough contrast to dark paper; on light paper the colour itself."""
        if not self.is_dark:
            return colour
        return self.ink if colour == BLACK else lightened(colour, self.paper)

    @property
    def is_dark(self) -> bool:
        """Whether the paper is dark."""
        return QColor(self.paper).lightnessF() < 0.5


def _colours(paper: Palette) -> dict[str, Any]:
    return {name: getattr(paper, name) for name in Palette.__dataclass_fields__}


LIGHT = Theme(
    **_colours(palette.LIGHT),
    desk="#F1F1EF",
    line="#C9CBCC",
    chosen="#2F6690",
    chosen_row="#E4ECF2",
    assumed="#A05A00",
    good="#2E7D32",
    title="#E6E7E6",
    button="#F4F4F2",
    row="#F7F7F5",
    tip="#FFFDF2",
    greyed="#9A9EA2",
    dwell="#DFE2E4",
    hair="#ECEEEF",
    light="#FFFFFF",
    midlight="#E8E8E5",
    mid="#B9BBBB",
    dark="#9A9C9D",
    shadow="#6E7072",
    idle="#B8CAD8",
)
DARK = Theme(
    **_colours(palette.DARK),
    desk="#2A2F35",
    line="#4A525A",
    chosen="#6DB3E0",
    chosen_row="#2C4356",
    assumed="#E5A550",
    good="#6FCF75",
    title="#343A41",
    button="#363C43",
    row="#20252A",
    tip="#3A3A2E",
    greyed="#6C757D",
    dwell="#3A4148",
    hair="#262B31",
    light="#4A525A",
    midlight="#3E454C",
    mid="#2A3036",
    dark="#1C2024",
    shadow="#101214",
    idle="#3B5163",
)


SCREEN = replace(LIGHT)
"""Theme of everything in the window, changed by ``draw_in``; files and reports are always in ``LIGHT``."""

# -- objects that depend on the theme --------------------------------------------------------------------

Result = TypeVar("Result")
_ICON_MAKERS: dict[int, Callable[[], Any]] = {}


def cached_by_theme(make: Callable[..., Result]) -> Callable[..., Result]:
    """Cache the results of a function, such as icons, for each theme."""

    @lru_cache(maxsize=512)
    def of_theme(_: str, *arguments: Any) -> Result:
        result: Any = make(*arguments)
        if isinstance(result, QIcon):
            _ICON_MAKERS[result.cacheKey()] = partial(cached, *arguments)
        return result

    @wraps(make)
    def cached(*arguments: Any) -> Result:
        return of_theme(SCREEN.paper, *arguments)

    return cached


def icon_maker(key: int) -> Callable[[], Any] | None:
    """Function that makes an icon, given by its cache key, in the current theme; None for other icons."""
    return _ICON_MAKERS.get(key)


def draw_in(theme: Theme) -> None:
    """Draw the window in the colours of this theme from now on."""
    vars(SCREEN).clear()
    vars(SCREEN).update(vars(theme))


# -- pens, brushes and fonts -----------------------------------------------------------------------------

# dashes and gaps, pixels
DASHED = (7.0, 4.0)  # pinned variant
CHAIN = (10.0, 3.0, 1.5, 3.0)  # pitch curve, centre lines
DOTTED = (1.5, 3.0)  # base circle
SPARSE = (2.0, 4.0)  # construction lines

TEXT, SMALL = 12, 11  # font sizes, pixels
SERIF = ("DejaVu Serif", "Noto Serif", "Liberation Serif", "Cambria", "Times New Roman")
"""Fonts of equations; others lose the dots of derivatives."""
FONTS = ("DejaVu Sans", "Noto Sans", "Liberation Sans", "Segoe UI", "Helvetica Neue", "Arial", "NanumGothic")

# Pens and brushes are cached because every edit needs the same few dozens of them; a copy costs next to nothing.


@lru_cache(maxsize=256)
def _pen(colour: str, width: float, dash: tuple[float, ...], ratio: float) -> QPen:
    pen = QPen(QColor(colour), width * ratio)
    pen.setCosmetic(True)
    pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    pen.setCapStyle(Qt.PenCapStyle.FlatCap if dash else Qt.PenCapStyle.RoundCap)
    if dash:
        pen.setDashPattern([part / width for part in dash])
    return pen


def no_pen() -> QPen:
    """Pen that draws nothing."""
    return QPen(Qt.PenStyle.NoPen)


def rgb(colour: str) -> tuple[int, int, int]:
    """Red, green and blue of a colour, 0 ... 255."""
    parts = QColor(colour)
    return parts.red(), parts.green(), parts.blue()


def brush(colour: str, opacity: float = 1.0) -> QBrush:
    """Brush for a fill of this colour and opacity."""
    return QBrush(_brush(colour, opacity))


@lru_cache(maxsize=256)
def _brush(colour: str, opacity: float) -> QBrush:
    fill = QColor(colour)
    fill.setAlphaF(opacity)
    return QBrush(fill)


def font(pixels: int = TEXT, bold: bool = False) -> QFont:
    """Font of all drawings, the first of ``FONTS`` that is installed; its size in pixels at 100 % font size."""
    return QFont(_font(round(sized(pixels)), bold))


@lru_cache(maxsize=16)
def _font(pixels: int, bold: bool) -> QFont:
    result = QFont()
    result.setFamilies(list(FONTS))
    result.setPixelSize(pixels)
    result.setBold(bold)
    return result


@lru_cache(maxsize=64)
def shade(colour: str, number: int) -> str:
    """Colour of the curve with this number (0, 1, ...) among the curves of one family in a plot.

    Shades are darker and lighter alternately; of a dark colour only lighter.
    """
    base = QColor(colour)
    if number == 0:
        return base.name()
    if base.lightnessF() < 0.2:
        return QColor.fromHsvF(0.0, 0.0, min(0.75, 0.3 + 0.15 * number)).name()
    steps = (200, 62, 330)  # per cent; below 100 the colour becomes lighter
    return base.darker(steps[(number - 1) % len(steps)]).name()
