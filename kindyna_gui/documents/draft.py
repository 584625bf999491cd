"""A motion that is not finished, beside the design whose last whole motion is still shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, cast

from core.design import Design, Motion, require_motion, with_motion
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.project import motion_from_table, motion_to_table

_MOTION = "motion."


@frozen
class Draft:
    """What has been typed of a motion so far.

    motion    as typed; it makes no turn, does not come back, a law does not fit its rise, or it has no answer
    assumed   the paths of the motion that are marked as assumed
    path      the value typed last, '' where none is
    reason    why a whole motion has no answer in this design; '' where it is not whole
    """

    motion: Motion
    assumed: tuple[str, ...] = ()
    path: str = ""
    reason: str = ""

    @classmethod
    def of(cls, design: Design, path: str = "", reason: str = "") -> Draft:
        """The motion of a design, with its marks."""
        assumed = tuple(each for each in design.assumed if each.startswith(_MOTION))
        return cls(require_motion(design), assumed, path, reason)

    def applied(self, design: Design) -> Design:
        """The design with this motion and its marks in place of its own."""
        others = tuple(each for each in design.assumed if not each.startswith(_MOTION))
        return with_motion(replace(design, assumed=(*self.assumed, *others)), self.motion)

    def state(self) -> dict[str, Any]:
        """As a plain dictionary of text, numbers and lists."""
        return {
            "unit": self.motion.unit,
            "motion": motion_to_table(self.motion),
            "assumed": list(self.assumed),
            "path": self.path,
            "reason": self.reason,
        }

    @classmethod
    def from_state(cls, state: Mapping[str, Any]) -> Draft:
        """Raises DesignError where the dictionary holds no motion."""
        try:
            motion = motion_from_table(state["motion"], state["unit"])
            texts = [state["path"], state["reason"], *state["assumed"]]
        except (KeyError, TypeError) as error:
            raise DesignError([Fault("draft", str(error), "cannot be read", "what Draft.state() gives")]) from error
        if not all(isinstance(text, str) for text in texts):
            raise DesignError([Fault("draft", texts, "must be text", "what Draft.state() gives")])
        path, reason, *assumed = cast(list[str], texts)
        return cls(motion, tuple(assumed), path, reason)


__all__ = ["Draft"]
