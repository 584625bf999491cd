"""Style of all drawings: themes, colours by quantity, pens, brushes and fonts; and the size below which a value is zero.

The mechanism and the curves carry the colour, everything else is quiet. The colours of the quantities are those of
Okabe and Ito, which colour-blind readers can distinguish; a family of `core.output.channels` has the same colour in
every drawing and plot.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache, partial, wraps
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QBrush, QColor, QFont, QIcon, QPen

from core.dynamics import Forces
from core.frozen import frozen
from core.study import Quantity, Study
from kindyna_gui.settings import sized

# -- size below which a value is zero --------------------------------------------------------------------

# In a dwell the contact normal passes through the cam's centre. The torque is then the difference of two equal
# products, and an axis fitted to it would show nothing but rounding noise.

ROUNDING = 256.0 * np.finfo(float).eps  # rounding error of a zero, in natural sizes
_ORDERS: Mapping[str, int] = MappingProxyType({"/s": 1, "/s²": 2, "/s³": 3})


def _reach(study: Study) -> float:
    """Length characteristic of the mechanism's size [m]."""
    return study.driver_ranges.plan.size if study.mechanism.ranged else study.reach


def _stroke(study: Study) -> float:
    """Greatest displacement of the motion [m or rad]."""
    return float(np.abs(study.motion.displacement[0]).max())


@lru_cache(maxsize=4)
def force_size(forces: Forces) -> float:
    """Largest finite force on any pair [N]."""
    rows = np.array(list(forces.pairs.values()))
    squares = rows.real**2 + rows.imag**2
    return float(np.sqrt(squares.max(where=np.isfinite(squares), initial=0.0)))


def torque_size(study: Study) -> float:
    """Torque of the largest force on the arm of the follower's reference point [N m]."""
    return force_size(study.dynamics) * _reach(study)


_SIZES: Mapping[str, Callable[[Study], float]] = MappingProxyType(
    {
        "mm": _reach,
        "1/mm": lambda study: 1.0 / _reach(study),
        "N": lambda study: force_size(study.dynamics),
        "N·m": torque_size,
    }
)
"""Unit of a channel, without the time of a rate -> natural size of the quantity [SI]; 1 for angles and ratios."""


def floor_of(study: Study, row: Quantity) -> float:
    """Size below which a channel's values count as zero, in the channel's unit.

    Raises
    ------
    NoSolution
        Where the channel's stage has no solution.
    """
    symbol, slash, rate = row.unit.symbol.partition("/s")
    order = _ORDERS.get(slash + rate, 0)
    natural_size = _stroke if row.stage == "motion" else _SIZES.get(symbol, lambda study: 1.0)
    return ROUNDING * natural_size(study) * abs(study.omega) ** order / row.unit.factor


def without_noise(values: np.ndarray, floor: float) -> np.ndarray:
    """Values (n,), replaced by zeros where none exceeds the floor."""
    return values if bool((np.abs(values) > floor).any()) else np.where(np.isnan(values), values, 0.0)


# -- colours and themes ----------------------------------------------------------------------------------

BLACK, ORANGE, SKY, GREEN, YELLOW = "#000000", "#E69F00", "#56B4E9", "#009E73", "#F0E442"
BLUE, VERMILION, PURPLE = "#0072B2", "#D55E00", "#CC79A7"
WHITE = "#FFFFFF"

FAMILIES: Mapping[str, str] = MappingProxyType(
    {
        "displacement": BLUE,
        "velocity": GREEN,
        "speed": "#00694D",
        "acceleration": VERMILION,
        "jerk": PURPLE,
        "pressure-angle": ORANGE,
        "force": BLACK,
        "torque": SKY,
        "stress": "#9E2A63",
        "curvature": "#8C6D1F",
        "length": "#5A6B7B",
        "angle": "#6A51A3",
        "energy": "#A6761D",
        "power": "#B0305C",
        "ratio": "#7A7A7A",
    }
)
"""Family of a channel -> colour. Black turns white on dark paper."""


DRIVES = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK)
"""Colours of the drives on one shaft, in the order of their list."""
BALANCE = "#5A6B7B"
"""Colour of the balance cam."""

READABLE = 4.5  # least contrast of a colour with dark paper, as WCAG 2 requires for texts
THIN, OUTLINE = 1.0, 1.5  # widths in pixels at every zoom


@frozen
class Theme:
    """Colours of paper and drawing.

    Attributes
    ----------
    paper, ink : background; outlines of the mechanism and texts
    quiet, faint, hair : axes, hatching and construction lines; grid; finer grid of a drawing
    band, dwell : every second segment of a plot; dwells next to the player
    limit : limits, and values that exceed them
    cam, second, roller, slider, shaft, links : fills of the mechanism; second: the other cam of a conjugate pair
    cam_line, second_line : outlines of the cams
    desk, line : window around the papers; frames
    chosen, chosen_row, idle : selection; its row in a table; selection in a window without focus
    assumed, good, greyed : assumed values; signs of success; disabled texts
    title, button, row, tip : title bars, buttons, every second row of a table, tips
    light, midlight, mid, dark, shadow : edges of Qt's style
    ratio : dots per pixel of the device; Qt counts the width of cosmetic pens in dots
    """

    paper: str
    ink: str
    quiet: str
    faint: str
    band: str
    limit: str
    cam: str
    cam_line: str
    second: str
    second_line: str
    roller: str
    slider: str
    shaft: str
    links: tuple[str, ...]
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
        return self.ink if colour == BLACK else _lightened(colour, self.paper)

    @property
    def is_dark(self) -> bool:
        """Whether the paper is dark."""
        return QColor(self.paper).lightnessF() < 0.5


LIGHT = Theme(
    paper=WHITE,
    ink="#1C2126",
    quiet="#6E7780",
    faint="#E3E6E9",
    band="#F4F5F6",
    limit="#C62828",
    cam="#F7EFD9",
    cam_line="#6B5416",
    second="#E1E8EE",
    second_line="#4A6072",
    roller="#FFFFFF",
    slider="#DCE8DF",
    shaft="#D5D8DB",
    links=("#D6E3EE", "#E9DDEA", "#F3E0D2", "#DDE7D3"),
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
    paper="#1B1F23",
    ink="#F2F4F5",
    quiet="#9AA4AD",
    faint="#30363C",
    band="#22272C",
    limit="#FF6B6B",
    cam="#3A3524",
    cam_line="#D9C68A",
    second="#2B3640",
    second_line="#8FA9BF",
    roller="#262B30",
    slider="#2C3A31",
    shaft="#454C53",
    links=("#2B3A47", "#3B2F3D", "#43352A", "#323B29"),
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


def contrast(colour: str, paper: str) -> float:
    """Contrast ratio of two colours, 1 ... 21 (WCAG 2, relative luminance)."""
    darker, lighter = sorted(0.05 + _luminance(QColor(tone)) for tone in (colour, paper))
    return lighter / darker


def _luminance(colour: QColor) -> float:
    rgb = (colour.redF(), colour.greenF(), colour.blueF())
    parts = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in rgb]
    return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2]


@lru_cache(maxsize=256)
def _lightened(colour: str, paper: str) -> str:
    """Colour made lighter until its contrast to the paper suffices."""
    lighter = QColor(colour)
    hue, saturation, lightness = lighter.hslHueF(), lighter.hslSaturationF(), lighter.lightnessF()
    while contrast(lighter.name(), paper) < READABLE and lightness < 1.0:
        lightness = min(lightness + 0.02, 1.0)
        lighter = QColor.fromHslF(max(hue, 0.0), saturation, lightness)
    return lighter.name() if lighter != QColor(colour) else colour


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
