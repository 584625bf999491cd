"""Colours of all drawings and plots, on light and on dark paper.

The mechanism and the curves carry the colour, everything else is quiet. The colours of the quantities are those of Okabe
and Ito, which colour-blind readers can distinguish; a family of `core.output.channels` has the same colour in every drawing
and plot.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from types import MappingProxyType

from core.frozen import frozen

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


@frozen
class Palette:
    """Colours of paper and drawing.

    Attributes
    ----------
    paper, ink : background; outlines of the mechanism and texts
    quiet, faint : axes, hatching and construction lines; grid
    band : every second segment of a plot
    limit : limits, and values that exceed them
    cam, second, roller, slider, shaft, links : fills of the mechanism; second: the other cam of a conjugate pair
    cam_line, second_line : outlines of the cams
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


LIGHT = Palette(
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
)
DARK = Palette(
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
)

READABLE = 4.5  # least contrast of a colour with dark paper, as WCAG 2 requires for texts
_STEP = 0.02  # of the lightness


def contrast(colour: str, paper: str) -> float:
    """Contrast ratio of two colours, 1 ... 21 (WCAG 2, relative luminance)."""
    darker, lighter = sorted(0.05 + _luminance(tone) for tone in (colour, paper))
    return lighter / darker


def _parts(colour: str) -> tuple[float, ...]:
    """Red, green and blue, 0 ... 1."""
    return tuple(int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5))


def _luminance(colour: str) -> float:
    parts = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in _parts(colour)]
    return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2]


@lru_cache(maxsize=256)
def lightened(colour: str, paper: str) -> str:
    """Colour made lighter until its contrast to dark paper is ``READABLE``."""
    from colorsys import hls_to_rgb, rgb_to_hls  # imported here to save start-up time

    hue, lightness, saturation = rgb_to_hls(*_parts(colour))
    while contrast(colour, paper) < READABLE and lightness < 1.0:
        lightness = min(lightness + _STEP, 1.0)
        colour = "#" + "".join(f"{round(255.0 * part):02x}" for part in hls_to_rgb(hue, lightness, saturation))
    return colour


def family_colour(name: str, palette: Palette) -> str:
    """Colour of a family of quantities on a paper."""
    colour = FAMILIES.get(name, palette.quiet)
    if colour == BLACK:
        return palette.ink
    return colour if palette is LIGHT else lightened(colour, palette.paper)
