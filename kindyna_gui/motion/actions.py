"""What can be done with a whole segment, a row each: buttons, menus and keys are made from this table."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import degrees
from types import MappingProxyType

from core.design import (
    Design,
    insert_segment,
    lacks,
    mirror_stroke,
    motion_of,
    remove_laid_out,
    require_motion,
)
from core.errors import KindynaError
from core.frozen import frozen
from core.motion.split import LEAST_CUT, copy_segment, split_segment
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import reason
from kindyna_gui.motion.grips import snapped_angle

Change = Callable[[Design, int, float | None], Design]
"""The design with a segment changed; a cam angle [deg] where that matters."""


@frozen
class SegmentAction:
    """One row.

    text    of a button; entry: of a menu
    step    name of the step of the undo stack; {n} is the segment's number
    able    whether it makes sense for a segment
    after   which segment is chosen then: so many further on
    whole   it takes a motion that is whole
    button  it has one below the table; else it stands in menus only
    """

    text: str
    entry: str
    tip: str
    icon: str
    step: str
    change: Change
    able: Callable[[Design, int], bool]
    after: int = 0
    whole: bool = False
    button: bool = True

    def makes_sense(self, design: Design, index: int) -> bool:
        """Whether it can be done with a segment of a design, whose motion need not be whole."""
        motion = motion_of(design)
        if motion is None or motion.follows is not None or index >= len(motion.segments):
            return False  # none, or one that is changed in other files
        return not (self.whole and lacks(design)) and self.able(design, index)


def _span(design: Design, index: int) -> float:
    return require_motion(design).segments[index].span_deg


def _has_room(design: Design, index: int) -> bool:
    return _span(design, index) > 2.0 * LEAST_CUT


ACTIONS: Mapping[str, SegmentAction] = MappingProxyType(
    {
        "insert": SegmentAction(
            "Insert",
            "Insert segment",
            "A dwell behind the chosen segment, of half its span (Ins)",
            "insert",
            "Insert segment behind segment {n}",
            lambda design, index, _: insert_segment(design, index),
            _has_room,
            after=1,
        ),
        "insert_before": SegmentAction(
            "Insert before",
            "Insert before",
            "A dwell before the chosen segment, of half its span",
            "insert",
            "Insert segment before segment {n}",
            lambda design, index, _: insert_segment(design, index, before=True),
            _has_room,
            button=False,
        ),
        "split": SegmentAction(
            "Split",
            "Split segment",
            "Cut the chosen segment where the cam stands, or in its middle. A dwell, constant velocity, a polynomial "
            "and a spline go on as before; of any other law both parts run from rest to rest, and the follower stands "
            "at the cut where it stood before",
            "split",
            "Split segment {n}",
            split_segment,
            _has_room,
            whole=True,
        ),
        "duplicate": SegmentAction(
            "Duplicate",
            "Duplicate segment",
            "A copy behind the chosen segment: both take half of its span and half of its rise, so no other join moves",
            "duplicate",
            "Duplicate segment {n}",
            lambda design, index, _: copy_segment(design, index),
            _has_room,
            after=1,
            whole=True,
        ),
        "mirror": SegmentAction(
            "Mirror",
            "Mirror stroke",
            "The next stroke the other way becomes the mirror image of this one: its curves backwards, its spans, its "
            "rises turned round. The dwells give or take the difference",
            "mirror",
            "Mirror the stroke of segment {n}",
            lambda design, index, _: mirror_stroke(design, index),
            lambda design, index: mirror_stroke(design, index) is not design,
            whole=True,
        ),
        "delete": SegmentAction(
            "Delete",
            "Delete segment",
            "Take the chosen segment away; the one before it gets its span (Del)",
            "delete",
            "Delete segment {n}",
            lambda design, index, _: remove_laid_out(design, index),
            lambda design, _: len(require_motion(design).segments) > 1,
        ),
    }
)


PATH = "motion.segments"
"""At which edits of whole segments are made, and refused."""


def perform(session: Session, name: str, index: int, theta: float) -> int | None:
    """Do one of ``ACTIONS`` with a segment as one step, at a cam angle [rad]; the number of the segment that is to be chosen then, None
    where it makes no sense or is refused."""
    action, design = ACTIONS[name], session.typed
    if not action.makes_sense(design, index):
        return None
    session.end_gesture()
    try:
        changed = action.change(design, index, snapped_angle(degrees(theta)))
    except KindynaError as error:
        session.refuse(PATH, reason(design, error))
        return None
    done = session.lay_out(changed, action.step.format(n=index + 1), PATH)
    session.end_gesture()
    return index + action.after if done else None


__all__ = ["ACTIONS", "PATH", "SegmentAction", "perform"]
