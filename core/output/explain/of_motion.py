"""How displacement, its rates and the triangle of a cam-driven slider are worked out at one angle."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from types import MappingProxyType

import numpy as np

from core.numerics.vectors import cross
from core.output.explain.letters import (
    LINKAGE,
    MOTION,
    Maker,
    Working,
    by,
    first,
    known,
    letter,
    motion_unit,
    pin,
)
from core.study import Study


def _segment(study: Study) -> tuple[int, float, float]:
    """Number of the segment at the angle, displacement at its start and rise [m or rad]."""
    typed = study.program.motion
    at, start, theta = 0.0, typed.start * typed.scale, float(np.rad2deg(study.theta[0]))
    for number, each in enumerate(typed.segments):
        rise = each.rise * typed.scale
        if theta < at + each.span_deg - 1e-9 or number == len(typed.segments) - 1:
            return number, start, rise
        at, start = at + each.span_deg, start + rise
    raise AssertionError("a motion has segments")


def _displacement(study: Study, _: str) -> Working:
    number, start, rise = _segment(study)
    unit, path = motion_unit(study), f"motion.segments[{number}]"
    y = first(study.motion.displacement[0])
    law = study.program.motion.segments[number].curve.law
    begin = letter("y_0", "displacement at the start of the segment", start, unit, MOTION)
    if not rise:
        return Working(("y = y_0 + Δ",), (begin, letter("Δ", f"what the law {law} adds", y - start, unit, path)))
    share = letter("s", f"share of the rise by the law {law}", (y - start) / rise, "", f"{path}.law")
    return Working(
        ("y = y_0 + h s",), (begin, letter("h", "rise of the segment", rise, unit, f"{path}.rise_{unit}"), share)
    )


def _modulo(study: Study, _: str) -> Working:
    motion, unit = study.program.motion, motion_unit(study)
    here = first(study.motion.displacement[0])
    y = letter("y", "position", here, unit, MOTION)
    advance = abs(motion.gain) * motion.scale
    if not advance:
        return Working(("m = y",), (y,))
    turns = letter("k", "whole advances in it", float(np.floor(here / advance)), "", MOTION)
    return Working(
        ("m = y - k a",), (y, turns, letter("a", "advance of a turn", advance, unit, f"motion.advance_{unit}"))
    )


def _rate(study: Study, _: str, line: str, order: int) -> Working:
    """ω to the order times the derivative by cam angle."""
    number = _segment(study)[0]
    mark = "′″‴"[order - 1]
    unit = motion_unit(study)
    name = f"derivative of the motion by cam angle, {mark}"
    slope = letter(f"y{mark}", name, first(study.motion.displacement[order]), unit, f"motion.segments[{number}]")
    return Working((line,), (*known(study, "ω"), slope))


def _triangle(study: Study, _: str, of: str) -> Working:
    """An angle of the triangle of pivot, arm pin and slider pin, by the cosine rule; as all angles of it in the frame of the guide."""
    pivot, joint, end = (pin(*each)(study) for each in (("arm", "pivot"), ("arm", "arm_pin"), ("slider", "slider_pin")))
    toward = end - pivot
    side = np.sign(cross(np.array([toward]), np.array([joint - pivot]))[0])
    sign, mine, opposite = (side, "₁", "₂") if of == "phi" else (-side, "₂", "₁")
    symbol = "φ" if of == "phi" else "β"
    return Working(
        (f"{symbol} = atan2(H, L) + σ arccos((r² + L{mine}² - L{opposite}²)/(2 r L{mine}))",),
        (
            *known(study, "H L"),
            letter("σ", "side on which the arm pin lies, by the layout", sign, "", "follower.layout"),
            letter("r", "distance of the slider pin from the pivot", abs(toward), "mm", LINKAGE),
            *known(study, "L₁ L₂"),
        ),
    )


def _base(study: Study) -> float:
    """Slider position at motion 0."""
    return first(study.linkage.coordinates["slider_position"][0] - study.motion.displacement[0])


ROWS: Mapping[str, Maker] = MappingProxyType(
    {
        "displacement": _displacement,
        "velocity": partial(_rate, line="ẏ = ω y′", order=1),
        "acceleration": partial(_rate, line="ÿ = ω² y″", order=2),
        "position_modulo": _modulo,
        "jerk": partial(_rate, line="y⃛ = ω³ y‴", order=3),
        "slider_position": lambda s, _: Working(
            ("L = L_0 + y",),
            (letter("L_0", "slider position at motion 0", _base(s), "mm", "follower"),
             letter("y", "motion", first(s.motion.displacement[0]), "mm", MOTION)),
        ),
        "phi": partial(_triangle, of="phi"),
        "beta": partial(_triangle, of="beta"),
        "phi_velocity": by("φ̇ = L̇ cos β/(L₁ sin(β - φ))", "L̇ β φ L₁"),
        "beta_velocity": by("β̇ = L̇ cos φ/(L₂ sin(φ - β))", "L̇ β φ L₂"),
        "phi_acceleration": by("φ̈ = (L̈ cos β + L₁ φ̇² cos(φ - β) + L₂ β̇²)/(L₁ sin(β - φ))", "L̈ β φ L₁ L₂ φ̇ β̇"),
        "beta_acceleration": by("β̈ = (L̈ cos φ + L₂ β̇² cos(φ - β) + L₁ φ̇²)/(L₂ sin(φ - β))", "L̈ β φ L₁ L₂ φ̇ β̇"),
    }
)  # fmt: skip
"""Quantity, or row of the members of a linkage -> how it is worked out."""

__all__ = ["ROWS"]
