"""What an animation of one turn shall be like."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from types import MappingProxyType

from core.design.fields import choice, number, whole
from core.frozen import frozen
from core.requests import asked

FORMATS: Mapping[str, str] = MappingProxyType(
    {
        ".gif": "GIF animation",
        ".webp": "WebP animation",
        ".mp4": "MP4 film, by ffmpeg",
        ".png": "PNG pictures in a folder",
    }
)
"""By the ending of the file's name; pictures go into a folder of that name without it."""
TICK = 10  # milliseconds: what a GIF counts in
LEAST_DELAY = 20  # a viewer plays what is shorter at a speed of its own


@frozen
class Film:
    """What is wanted: ``.gif`` or ``.webp``, frames of the turn, size in pixels, seconds of the turn."""

    ending: str = asked(choice("Format", tuple(FORMATS), default=".gif"), None, words=FORMATS)
    frames: int = asked(whole("Frames per turn", 2, 360, default=72), help="per turn")
    width: int = 800
    height: int = 600
    seconds: float = asked(number("One turn takes, s", 0.2, 600.0, default=4.0), None)

    @property
    def delays(self) -> list[int]:
        """How long each frame stands [ms]: whole ticks that add up to the turn."""
        total = max(round(1000.0 * self.seconds / TICK), self.frames * LEAST_DELAY // TICK)
        marks = [total * i // self.frames for i in range(self.frames + 1)]
        return [(after - before) * TICK for before, after in pairwise(marks)]


__all__ = ["FORMATS", "Film"]
