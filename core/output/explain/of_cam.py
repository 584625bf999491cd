"""How the cam's shape and its instant centre are worked out at one angle."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from types import MappingProxyType

import numpy as np

from core.cam import SECOND
from core.mechanism.kinematics import SLIDING
from core.output.explain.letters import (
    CAM,
    LINKAGE,
    Letter,
    Maker,
    Working,
    by,
    either,
    first,
    known,
    letter,
    other,
)
from core.study import Study, quantities_of, quantity
from core.study.values import line_of_centres


def _turned_back(axis: str, x: str, y: str) -> str:
    """A coordinate of a point of the global frame in the cam's own."""
    return f"({x}) cos(d θ) + ({y}) sin(d θ)" if axis == "x" else f"({y}) cos(d θ) - ({x}) sin(d θ)"


def _place(study: Study, _: str, symbol: str, axis: str, offset: str, letters: str, second: bool = False) -> Working:
    index = "2" if second else ""
    beside = f" + {offset} n_{index}" if offset else ""
    parts = (f"R_{index}{part}{beside}{part if offset else ''}" for part in "xy")
    line = _turned_back(axis, *parts)
    used = known(study, f"{'R_2x R_2y' if second else 'R_x R_y'} {letters} d θ".strip())
    normals: tuple[Letter, ...] = ()
    if offset:
        flank = study.cam.only(SECOND).flank if second else study.cam.flank
        t = complex(np.atleast_1d(flank.relative_velocity)[0])
        n = -1j * study.sense * t / abs(t)
        mark = "n_2" if second else "n_"
        normals = tuple(
            letter(f"{mark}{part}", f"unit normal of the pitch curve, {part}", value, "", CAM)
            for part, value in (("x", n.real), ("y", n.imag))
        )
    return Working((f"{symbol} = {line}",), (*used, *normals))


def _flat_place(symbol: str, axis: str) -> Maker:
    line = _turned_back(axis, "m_x h - m_y h_ν", "m_y h + m_x h_ν")
    return by(f"{symbol} = {line}", "m_x m_y h h_ν d θ")


def _pressure_angle(study: Study, _: str, second: bool = False) -> Working:
    flank = study.cam.only(SECOND).flank if second else study.cam.flank
    index = "₂" if second else ""
    way = _way(study, second)
    n = complex(np.atleast_1d(flank.normal)[0])
    rows = (("n_x", n.real, "normal of the cam, x"), ("n_y", n.imag, "normal of the cam, y"),
            ("v_x", way.real, "unit vector along the travel of the follower's point, x"),
            ("v_y", way.imag, "unit vector along the travel of the follower's point, y"))  # fmt: skip
    letters = tuple(letter(symbol, meaning, value, "", CAM) for symbol, value, meaning in rows)
    return Working((f"ψ{index} = atan2(|n_x v_y - n_y v_x|, |n_x v_x + n_y v_y|)",), letters)


def _way(study: Study, second: bool) -> complex:
    """Unit vector along which the point that touches, or the centre of the round, travels."""
    kinematics = study.linkage
    flank = study.cam.only(SECOND).flank if second else study.cam.flank
    if not flank.straight and not second:
        return complex(np.atleast_1d(kinematics.travel)[0])
    pair = kinematics.pairs[kinematics.ground]
    if pair.kind == SLIDING:
        return complex(np.atleast_1d(kinematics.line(pair))[0])
    at = flank.contact if flank.straight else flank.reference
    arm = complex(np.atleast_1d(at - kinematics.bodies[pair.body].place(pair.point))[0])
    return 1j * arm / abs(arm)


def _pitch_curvature(study: Study, _: str, second: bool = False) -> Working:
    flank = study.cam.only(SECOND).flank if second else study.cam.flank
    t = complex(np.atleast_1d(flank.relative_velocity)[0])
    bend = complex(1.0)
    speed = abs(t)
    # w from its own equation for the first roller; of the second one from what bends its pitch curve
    along = first(flank.pitch_curvature) * speed * speed
    index = "₂" if second else ""
    w = known(study, "w_x w_y") if not second else ()
    if second:
        bend = -study.sense * 1j * t / speed * along
        w = tuple(
            letter(f"w_{part}", f"R₂″ - 2 i d R₂′ - R₂ across t, {part}", value, "mm", LINKAGE)
            for part, value in (("x", bend.real), ("y", bend.imag))
        )
    parts = tuple(
        letter(f"t_{part}", f"velocity of the roller's centre against the cam, by cam angle, {part}", value, "mm", CAM)
        for part, value in (("x", t.real), ("y", t.imag))
    )
    symbol = "κ_p2" if index else "κ_p"
    return Working((f"{symbol} = -d (t_x w_y - t_y w_x)/(t_x² + t_y²)^(3/2)",), (*known(study, "d"), *parts, *w))


def _beside(study: Study, _: str, line: str, of: str, letters: str) -> Working:
    """The curvature of the curve beside another one."""
    return Working((line,), (other(study, of, "κ_p2" if "κ_p2" in line else "κ_p"), *known(study, letters)))


def _from(line: str, **others: str) -> Maker:
    """An equation in other quantities: letter -> name of the quantity."""
    return lambda study, _: Working((line,), tuple(other(study, name, symbol) for symbol, name in others.items()))


def _polar(study: Study, _: str) -> Working:
    x, y = (other(study, name, symbol) for name, symbol in (("profile_x", "x"), ("profile_y", "y")))
    whole = 1.0 if y.value < 0.0 else 0.0
    turns = letter("k", "1 where that is negative", whole, "", CAM)
    return Working(("ϑ = atan2(y, x) + 2 π k",), (y, x, turns))


def _on_face(study: Study, _: str) -> Working:
    return Working(("x_f = h_ν - (m_x R_y - m_y R_x)",), known(study, "h_ν m_x m_y R_x R_y"))


def _centre_distance(study: Study, _: str) -> Working:
    along = complex(line_of_centres(study)[0])
    rows = known(study, "R_x R_y R′_x R′_y φ′ d")
    unit = tuple(
        letter(f"e_{part}", f"direction in which Q is counted, {part}", value, "", LINKAGE)
        for part, value in (("x", along.real), ("y", along.imag))
    )
    return Working(("Q = (e_x (R′_y - φ′ R_x) - e_y (R′_x + φ′ R_y))/(d - φ′)",), (*rows, *unit))


def _centre_velocity(study: Study, _: str) -> Working:
    if "instant_centre" in quantities_of(study, "cam"):
        return Working(("V_Q = ω Q",), known(study, "ω Q"))
    q = complex(np.atleast_1d(study.cam.flank.centre.finite)[0])
    return Working(
        ("V_Q = ω Q",), (*known(study, "ω"), letter("Q", "distance of Q from the cam centre", abs(q), "mm", CAM))
    )


def _reference_velocity(study: Study, _: str) -> Working:
    slope = first(quantity("reference_velocity").value(study)) / study.omega
    there = complex(np.atleast_1d(study.linkage.follower.origin[1])[0])
    sign = letter("σ", "+1 where it goes as Q does", np.sign(slope) if slope else 1.0, "", LINKAGE)
    parts = tuple(
        letter(f"R′_{part}", f"velocity of the roller's centre by cam angle, {part}", value, "mm", LINKAGE)
        for part, value in (("x", there.real), ("y", there.imag))
    )
    return Working(("V_R = σ ω √(R′_x² + R′_y²)",), (sign, *known(study, "ω"), *parts))


ROWS: Mapping[str, Maker] = MappingProxyType(
    {
        "profile_x": either(_flat_place("x", "x"), partial(_place, symbol="x", axis="x", offset="R_r", letters="R_r")),
        "profile_y": either(_flat_place("y", "y"), partial(_place, symbol="y", axis="y", offset="R_r", letters="R_r")),
        "pitch_x": partial(_place, symbol="x_p", axis="x", offset="", letters=""),
        "pitch_y": partial(_place, symbol="y_p", axis="y", offset="", letters=""),
        "outer_x": partial(_place, symbol="x_o", axis="x", offset="(-R_r - s_p)", letters="R_r s_p"),
        "outer_y": partial(_place, symbol="y_o", axis="y", offset="(-R_r - s_p)", letters="R_r s_p"),
        "second_x": partial(_place, symbol="x₂", axis="x", offset="(R_r2 + s_p)", letters="R_r2 s_p", second=True),
        "second_y": partial(_place, symbol="y₂", axis="y", offset="(R_r2 + s_p)", letters="R_r2 s_p", second=True),
        "second_pitch_x": partial(_place, symbol="x_p2", axis="x", offset="", letters="", second=True),
        "second_pitch_y": partial(_place, symbol="y_p2", axis="y", offset="", letters="", second=True),
        "pressure_angle": _pressure_angle,
        "second_pressure_angle": partial(_pressure_angle, second=True),
        "pitch_curvature": _pitch_curvature,
        "second_pitch_curvature": partial(_pitch_curvature, second=True),
        "profile_curvature": either(by("κ = 1/ρ", "ρ"),
                                    partial(_beside, line="κ = κ_p/(1 - R_r κ_p)", of="pitch_curvature", letters="R_r")),
        "outer_curvature": partial(_beside, line="κ_o = κ_p/(1 + (R_r + s_p) κ_p)", of="pitch_curvature", letters="R_r s_p"),
        "second_profile_curvature": partial(_beside, line="κ₂ = κ_p2/(1 - (R_r2 + s_p) κ_p2)",
                                           of="second_pitch_curvature", letters="R_r2 s_p"),
        "radius": _from("r = √(x² + y²)", x="profile_x", y="profile_y"),
        "polar_angle": _polar,
        "contact_on_face": _on_face,
        "instant_centre": _centre_distance,
        "instant_centre_x": by("Q_x = (R′_y - φ′ R_x)/(d - φ′)", "R_x R′_y φ′ d"),
        "instant_centre_y": by("Q_y = -(R′_x + φ′ R_y)/(d - φ′)", "R_y R′_x φ′ d"),
        "instant_centre_velocity": _centre_velocity,
        "reference_velocity": _reference_velocity,
    }
)  # fmt: skip
"""Quantity, or row of the members of a linkage -> how it is worked out."""

__all__ = ["ROWS"]
