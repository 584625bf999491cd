"""Texts about designs: what does not fit together and what would close a motion; values that differ between two designs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from core.design import (
    NO_UNIT,
    UNITS,
    Design,
    Motion,
    Segment,
    Unit,
    motion_of,
    require_motion,
    rise_gap,
    span_gap,
    split_unit,
)
from core.errors import MISSING, KindynaError
from core.motion import Join, program
from core.project import ValueDifference
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import choice_text, law_label, name_of, segment_of, sentence, value_text

WHOLE = "motion.segments"
"""Path of the faults of the whole motion: it makes no turn, or does not come back."""


NO_MECHANISM = "Not a mechanism yet"


def misses(session: Session) -> list[str]:
    """A sentence for each thing that does not fit together, what the motion of the chosen drive lacks first; none where all does."""
    if session.draft is not None and session.unfinished:
        from core.mechanism.unfinished import mobility

        return [sentence(row) for row in mobility(session.typed.drive.linkage).sentences] or [NO_MECHANISM]
    typed, misfit, motion = session.typed, session.misfit, motion_of(session.typed)
    rows = [] if motion is None or not misfit.reasons else _gaps(motion)
    rows += [f"{name}: {text}" for path, name, text in misfit.reasons if not (rows and path == WHOLE)]
    if rows and segment_of(misfit.path) is not None and not rows[0].startswith(name_of(typed, misfit.path)):
        rows[0] = f"{name_of(typed, misfit.path)}: {rows[0]}"
    return [sentence(row) for row in rows]


def waiting_text(session: Session) -> str:
    """What does not fit to the rest: ``Does not fit yet: Rod L2``; '' where all does."""
    if session.draft is not None and session.unfinished:
        return NO_MECHANISM
    names = dict.fromkeys(name for _, name, _ in session.misfit.reasons)
    return f"Does not fit yet: {', '.join(names)}" if names else ""


def _gaps(motion: Motion) -> list[str]:
    """By how much a motion makes no turn, and does not come back."""
    deg, own, rows = UNITS["deg"], UNITS[motion.unit], []
    if gap := span_gap(motion):
        total = value_text(360.0 + gap, deg)
        rows.append(
            f"spans add up to {total}, {value_text(abs(gap), deg)} {'more' if gap > 0.0 else 'less'} than a turn"
        )
    if gap := rise_gap(motion):
        rows.append(f"the follower ends {value_text(abs(gap), own)} {'above' if gap > 0.0 else 'below'} its start")
    return rows


def waiting_paths(session: Session) -> frozenset[str]:
    """The paths of the values that do not fit together, as far as they are known: those that are named, and the one typed last."""
    misfit = session.misfit
    return frozenset({path for path, _, _ in misfit.reasons if path != WHOLE} | {misfit.path} - {""})


def motion_waits(session: Session) -> bool:
    """Whether the motion that is typed is not in place."""
    return session.draft is not None and motion_of(session.typed) != motion_of(session.design)


def joins_of(motion: Motion) -> tuple[Join, ...]:
    """The joins of an unfinished motion; none where its spans make no turn, or a curve has no answer."""
    try:
        return () if span_gap(motion) else program(motion).joins
    except KindynaError:
        return ()


def closing_text(session: Session) -> str:
    """What would close the motion: ``segment 4: Modified sine, -40 mm``; '' where nothing simple would, or it is whole."""
    closing = session.closing
    if closing is None:
        return ""
    motion = require_motion(session.typed)
    before, after = list(motion.segments), list(require_motion(closing).segments)
    new = -1
    if len(after) > len(before):
        new = next((i for i, segment in enumerate(before) if segment != after[i]), len(before) - 1) + 1
        before.insert(new, after[new])
    rows = [
        f"{'a new ' if i == new else ''}segment {i + 1}: {_changes(None if i == new else before[i], segment, motion)}"
        for i, segment in enumerate(after)
        if i == new or segment != before[i]
    ]
    return "; ".join(rows)


def _changes(before: Segment | None, after: Segment, motion: Motion) -> str:
    """Law, span and rise of a segment, as far as they are others than before."""
    texts = [law_label(after.curve.law)] if before is None or before.curve.law != after.curve.law else []
    if before is None or before.span_deg != after.span_deg:
        texts.append(value_text(float(f"{after.span_deg:.6g}"), UNITS["deg"]))
    if before is None or before.rise != after.rise:
        texts.append(value_text(float(f"{after.rise:.6g}"), UNITS[motion.unit]))
    return ", ".join(texts)


NAMES = {"assumed": "Assumed values", "follower.kind": "Kind of follower"}
"""Of keys that no form shows."""


def difference_text(before: Design | None, after: Design, difference: ValueDifference) -> tuple[str, str, str]:
    """A value that differs between two designs: its name, what stands in the one, what in the other."""
    design = before if before is not None and difference.after is MISSING else after
    name = NAMES.get(difference.path) or name_of(design, difference.path)
    unit = split_unit(difference.path.rpartition(".")[2])[1] or NO_UNIT
    return name, _any_text(difference.before, unit), _any_text(difference.after, unit)


def _any_text(value: Any, unit: Unit) -> str:
    """A value of a file: a number, a word, a list or a table."""
    if value is MISSING:
        return "nothing"
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {_any_text(each, NO_UNIT)}" for key, each in value.items())
    if isinstance(value, list | tuple):
        return f"({', '.join(_any_text(each, NO_UNIT) for each in value)})"
    if isinstance(value, float):
        return value_text(value, unit)
    return choice_text(value) if isinstance(value, str) else str(value)


__all__ = ["closing_text", "difference_text", "joins_of", "misses", "motion_waits", "waiting_paths", "waiting_text"]
