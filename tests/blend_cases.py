"""Blending asked as a designer asks it, for motions drawn by chance from ``blends``; shared by the tests of blending."""

from __future__ import annotations

import random
from collections.abc import Mapping
from typing import Any

import numpy as np
from blends import FREEDOM, SEQUENCES, Motion, free_motion
from hypothesis import strategies as st

from core.blend import BlendError, BlendResult, Request, blend

ALL = [(kind, constant, name) for (kind, constant), names in SEQUENCES.items() for name in names]
SYMMETRIC = ("C1-H2-H3-C4", "C1-CV1-H2-H3-CV2-C4", "H1-CV1-H2-H3-CV2-H4")
Case = tuple[str, str, str, dict[str, Any], int]
"""Type of motion, constant velocity, sequence, what else ``free_motion`` takes, and the seed of the motion."""


def request(kind: str, constant: str, wanted: Mapping[str, float], **more: Any) -> Request:
    return Request(
        kind, constant=constant, settings=dict(wanted), **{"stroke": 20.0, "start": 30.0, "end": 330.0, **more}
    )


def attempted(wish: Request) -> tuple[BlendResult | None, Any]:
    """The answer, or the refusal."""
    try:
        return blend(wish), None
    except BlendError as error:
        return None, error


def as_motion(answer: BlendResult) -> Motion:
    """The segments alone, as the file would have them."""
    parts = answer.segments
    names = tuple(s.curve.law.upper() for s in parts)
    return Motion(names, tuple(abs(s.rise) for s in parts), tuple(s.span_deg for s in parts), answer.request.start)


def measurable(motion: Motion, kind: str) -> dict[str, float]:
    """What can be asked, as the command spells it."""
    return {k: v for k, v in motion.settings().items() if not (kind == "DRD-return" and k == "peak")}


def independent(name: str, asked: tuple[str, ...], case: dict[str, Any], seed: int) -> bool:
    """Whether the settings determine the motion hereabouts: of a cloud of motions beside it, no combination of the
    settings stays."""
    clouds = [measured_near(name, case, seed, k) for k in range(12)]
    rows = np.array([[c[n] for n in asked] for c in clouds])
    base = np.array([measured_near(name, case, seed, None)[n] for n in asked])
    spread = np.linalg.svd((rows - base) / (1e-7 * np.abs(base)), compute_uv=False)
    return bool(spread[-1] > 1e-3) if asked else True


class Shaken(random.Random):
    """The same numbers, each a little off."""

    def __init__(self, seed: int, shake: int | None) -> None:
        super().__init__(seed)
        self._shake = None if shake is None else random.Random(shake)

    def uniform(self, a: float, b: float) -> float:
        x = super().uniform(a, b)
        return x if self._shake is None else x * (1.0 + 1e-7 * self._shake.uniform(-1.0, 1.0))


def measured_near(name: str, case: dict[str, Any], seed: int, shake: int | None) -> dict[str, float]:
    return free_motion(name, Shaken(seed, shake), **case).settings()


@st.composite
def cases(draw: st.DrawFn) -> Case:
    kind, constant, name = draw(st.sampled_from(ALL))
    start = draw(st.floats(0.0, 200.0))
    span = draw(st.floats(20.0, 360.0 - start))
    stroke = draw(st.sampled_from([20.0, 1e-3, 350.0]))
    mirrored = name in SYMMETRIC and draw(st.booleans())
    back = stroke if mirrored else stroke * draw(st.sampled_from([1.0, 0.6, 1.9]))
    case = {"stroke": stroke, "back": back, "start": start, "span": span, "mirrored": mirrored}
    return kind, constant, name, case, draw(st.integers(0, 2**32))


def asked_for(kind: str, constant: str, name: str, case: dict[str, Any], wanted: Mapping[str, float]) -> Request:
    stroke = case["back"] if kind == "DRD-return" else case["stroke"]
    return Request(
        kind,
        stroke,
        case["start"],
        case["start"] + case["span"],
        constant,
        dict(wanted),
        return_stroke=case["back"],
        sequence=name,
        mirrored=case["mirrored"] if name in SYMMETRIC else None,
    )


def freedom(name: str, case: dict[str, Any]) -> int:
    return 2 if case["mirrored"] and name != "C1-H2-H3-C4" else 1 if case["mirrored"] else FREEDOM[name]


def solves(wish: Request, name: str, value: float) -> bool:
    try:
        blend(Request(**{**vars(wish), "settings": {**wish.settings, name: value}}))
    except BlendError:
        return False
    return True
