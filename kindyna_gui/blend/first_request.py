"""What the blend wizard begins with: the motion about the chosen segment, asked anew. No Qt."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import fsum

from core.blend import candidates
from core.design import Motion, Segment, join_angles
from core.design.edits import is_dwell
from kindyna_gui.blend.request import OF_A_RETURN, WizardRequest, plan

CONSTANT = ("cv1", "cv2")


def first_request(motion: Motion, chosen: int) -> WizardRequest:
    """What a motion is like about the chosen segment, or the next that moves, asked anew: its stroke, its angles, and
    where it is a blend its sequence and heights. A motion that stands still is asked for a card picker's."""
    moving = [not is_dwell(s) and s.rise != 0.0 for s in motion.segments]
    count = len(moving)
    at = next((i for k in range(count) if moving[i := (chosen + k) % count]), None)
    if at is None:
        return WizardRequest(unit=motion.unit)
    run = _about(at, moving)
    stroke = _about(
        at, [on and s.rise * motion.segments[at].rise > 0.0 for on, s in zip(moving, motion.segments, strict=True)]
    )
    runs = [run, stroke] if list(_directions([motion.segments[i] for i in run])) in ([1], [-1], [1, -1]) else [stroke]
    requests = [_request_of(motion, part) for part in runs]
    return next((request for request, blended in requests if blended), requests[0][0])


def _about(at: int, on: Sequence[bool]) -> list[int]:
    """The run of segments about one, all of which are on."""
    first, last = at, at
    while first > 0 and on[first - 1]:
        first -= 1
    while last + 1 < len(on) and on[last + 1]:
        last += 1
    return list(range(first, last + 1))


def _request_of(motion: Motion, run: Sequence[int]) -> tuple[WizardRequest, bool]:
    """A run of segments as it is asked for, and whether it is a blend."""
    segments = [motion.segments[i] for i in run]
    begins = (*join_angles(motion), 360.0)
    whole = len(run) == len(motion.segments)
    kind = {(1,): "DRD", (-1,): "DRD-return"}.get(tuple(_directions(segments)), "RRR" if whole else "DRRD")
    rise, back = (abs(fsum(s.rise for s in segments if s.rise * direction > 0.0)) for direction in (1, -1))
    equal = abs(rise - back) <= 1e-9 or not (rise and back)
    request = WizardRequest(
        type=kind,
        constant=_constant(segments),
        stroke=round(rise or back, 9),
        return_stroke=0.0 if equal else round(back, 9),
        start=begins[run[0]],
        end=begins[run[-1] + 1],
        unit=motion.unit,
    )
    as_blend = _as_blend(request, segments)
    return (replace(request, constant="none"), False) if as_blend is None else (as_blend, True)


def _directions(segments: Sequence[Segment]) -> Iterator[int]:
    """1 up, -1 down, once for each stretch."""
    before = 0
    for segment in segments:
        direction = 1 if segment.rise > 0.0 else -1
        if direction != before:
            yield direction
        before = direction


def _constant(segments: Sequence[Segment]) -> str:
    laws = {s.curve.law for s in segments}
    return {(True, False): "rise", (False, True): "return", (True, True): "both"}.get(
        (CONSTANT[0] in laws, CONSTANT[1] in laws), "none"
    )


def _as_blend(request: WizardRequest, segments: Sequence[Segment]) -> WizardRequest | None:
    """With sequence and heights, where the segments are the curves of a sequence; else None."""
    name = "-".join(s.curve.law.upper() for s in segments)
    rows = [row for row in candidates(replace(request, sequence=name).solver_request) if not row.family.mirrored]
    if not rows:
        return None
    candidate = rows[0]
    heights = [abs(s.rise) for s in segments]
    rise, back = heights[: len(candidate.sequence.rise)], heights[len(candidate.sequence.rise) :]
    given: list[tuple[str, float]] = []
    for part, first, last in ((rise, "h1", "h3"), (back, "h4", "h6")):
        if len(part) > 1:
            given.append((first, part[0]))
        if len(part) > 2:
            given.append((last, part[-1]))
    renamed = OF_A_RETURN if not rise else {}
    kept = tuple((renamed.get(n, n), h) for n, h in given[: candidate.freedom])
    plain = replace(request, given=kept)
    if plan(plain).target == candidate:
        return plain
    return replace(plain, sequence=name, mirrored=False)


__all__ = ["first_request"]
