"""A lesson played to its end with mouse and keys, each step held to what it says."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from kindyna_gui.window.tutorial.conditions import met
from kindyna_gui.window.tutorial.deeds import CannotDo, play, settle, wait_for
from kindyna_gui.window.tutorial.lessons import Step
from kindyna_gui.window.tutorial.strip import TutorialStrip


def steps_played(strip: TutorialStrip) -> Iterator[tuple[int, Step]]:
    """Number, from 1, and step, each when it is done and before the strip goes on. Raises CannotDo with the step that fails."""
    window = strip.host
    strip.hold()
    while (step := strip.step) is not None:
        number = strip.number + 1
        try:
            if met(window, step.until):
                raise CannotDo("what it ends with is so before it is done")
            play(window, step.do)
            wait_for(partial(met, window, step.until), "what must be so")
        except CannotDo as error:
            raise CannotDo(f"step {number} of {len(strip.lesson.steps)}: {error}") from None
        settle()
        strip.show_mark()
        yield number, step
        strip.go_on()
