"""Formulas of a cam in space and their symbols, for the line of contact where a figure is worst along the roller."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from core.spatial import AHEAD, BEHIND, SpatialFlank, sliding, sliding_parts
from core.study.study import SURFACE, Study
from core.study.symbols import CAM, DYNAMICS, Formula, SymbolSource, first, motion_unit, quantity_symbol

_CONTACT, _SHAPE = "spatial.contact", "spatial.shape"
_WORST = "the largest along the roller, on either flank"

SPATIAL_FORMULAS: tuple[Formula, ...] = (
    Formula(f"pressure_angle{SURFACE}", "Pressure angle of a cam in space",
            ("tan ψ = |n × v|/|n · v|", "n = cos τ e + sin τ a", "e · w = -tan τ (a · w)"),
            "ψ n.space v.space τ.space e.space a.space w.space", "Litvin and Fuentes, equation of meshing", f"{_CONTACT}.flank",
            working="ψ = atan2(s, g)", values="s.space g.space", remark=_WORST),
    Formula("sliding", "Sliding of the roller", ("v_s = ω |w_C + Ω r (a × e)|",), "v_s.space ω w_C.space Ω.space r.space a.space e.space",
            "rolling in the middle of the roller", f"{_CONTACT}.sliding", working="v_s = ω √(v_1² + v_2²)",
            values="ω v_1.space v_2.space", remark=_WORST),
    Formula("surface_curvature", "Curvature of the flank", ("κ = -(∂n/∂T · T)",), "κ.space n.space T.space", "normal curvature",
            f"{_CONTACT}.SpatialFlank.curvature", working="κ = -k/t", values="k.space t.space",
            remark=f"T: unit tangent across the line of contact; positive where the cam is convex; {_WORST}"),
    Formula(f"contact_force{SURFACE}", "Contact force", ("F_c = Q/|∂p/∂y · n|",), "F_c Q.space p.space y n.space", "Virtual power",
            "dynamics.forces.with_cam_in_space", working="F_c = Q/g", values="Q.space g.middle",
            remark="positive on the flank behind the roller, negative on the flank ahead; in the roller's middle"),
    Formula("roller_pv", "PV of the roller", ("PV = |F_c| v_s/(d L)",), "PV.space F_c v_s.largest d.space L.space",
            "specific load times sliding speed", "study.drive_forces.roller_pv"),
    Formula(f"drive_torque{SURFACE}", "Cam torque", ("T_c = Q y′",), "T_c Q.space y′", "Virtual power",
            "dynamics.forces.with_cam_in_space"),
)  # fmt: skip


def _line(
    figure: Callable[[SpatialFlank], np.ndarray], read: Callable[[SpatialFlank], np.ndarray]
) -> Callable[[Study, str], float]:
    """Value at the line of contact where a figure is largest along the roller, at the study's angle."""
    return lambda study, _: float(read(study.surface.worst_line(figure)).ravel()[0])


def _steepest(read: Callable[[SpatialFlank], np.ndarray]) -> Callable[[Study, str], float]:
    return _line(lambda flank: flank.pressure_angle, read)


def _sharpest(read: Callable[[SpatialFlank], np.ndarray]) -> Callable[[Study, str], float]:
    return _line(lambda flank: flank.curvature, read)


def _across(flank: SpatialFlank) -> np.ndarray:
    """|n × ∂p/∂y|."""
    return np.asarray(np.linalg.norm(np.cross(flank.normal, flank.moving, axis=0), axis=0))


def _slip(part: int) -> Callable[[Study, str], float]:
    """Part of the largest sliding by cam angle: along the axis (0), around it (1)."""

    def value(study: Study, _: str) -> float:
        shape = study.surface
        lines = [(shape.at_ends(side), shape.in_middle(side)) for side, _ in shape.tracks]
        ends, middle = max(lines, key=lambda pair: float(sliding(*pair)[:, 0].max()))
        return float(sliding_parts(ends, middle)[part][int(np.argmax(sliding(ends, middle)[:, 0])), 0])

    return value


def _effort(study: Study, _: str) -> float:
    """Q: force or torque that makes the motion."""
    return study.mechanism.driver_sign * first(study.dynamics.driver)


def _middle_gain(study: Study, _: str) -> float:
    side = BEHIND if _effort(study, "") >= 0.0 else AHEAD
    return float(study.surface.in_middle(side).gain[0, 0])


def _per_motion(study: Study) -> str:
    return "" if motion_unit(study) == "mm" else "mm"


def _effort_unit(study: Study) -> str:
    return "n" if motion_unit(study) == "mm" else "nm"


SPATIAL_LETTERS: Mapping[str, SymbolSource] = {
    "n.space": SymbolSource("normal of the flank, from the roller into the cam"),
    "v.space": SymbolSource("direction in which the roller moves, ∂p/∂y"),
    "τ.space": SymbolSource("half angle of the roller's cone"),
    "e.space": SymbolSource("direction from the roller's axis to the line of contact"),
    "a.space": SymbolSource("direction of the roller's axis"),
    "w.space": SymbolSource("velocity of the roller's axis against the cam, by cam angle"),
    "s.space": SymbolSource("|n × ∂p/∂y|", _per_motion, _steepest(_across), CAM),
    "g.space": SymbolSource("|n · ∂p/∂y|", _per_motion, _steepest(lambda flank: flank.gain), CAM),
    "v_s.space": SymbolSource("sliding of the roller on the flank"),
    "w_C.space": SymbolSource("velocity of the contact against the cam, of a roller that does not turn, by cam angle"),
    "Ω.space": SymbolSource("rotation of the roller by cam angle, with which its middle rolls"),
    "r.space": SymbolSource("radius of the roller at the contact"),
    "v_1.space": SymbolSource("sliding along the roller's axis by cam angle", "mm", _slip(0), CAM),
    "v_2.space": SymbolSource("sliding around the roller by cam angle", "mm", _slip(1), CAM),
    "κ.space": quantity_symbol("curvature of the flank", "curvature_per_mm", lambda s: s.surface.curvature, CAM),
    "T.space": SymbolSource("unit tangent across the line of contact"),
    "k.space": SymbolSource("∂n/∂θ · T, less the part along the line of contact", "", _sharpest(lambda flank: flank.turning), CAM),
    "t.space": SymbolSource("∂p/∂θ · T", "mm", _sharpest(lambda flank: flank.stretch), CAM),
    "Q.space": SymbolSource("force or torque that makes the motion", _effort_unit, _effort, DYNAMICS),
    "PV.space": SymbolSource("specific load of the roller times its sliding speed"),
    "v_s.largest": quantity_symbol("largest sliding of the roller", "sliding_mm_s", lambda s: s.surface.sliding * abs(s.omega), CAM),
    "d.space": SymbolSource("diameter of the roller in its middle", "mm",
                            lambda s, _: 2.0 * float(s.machine.roller_radius(s.machine.middle)), "cam.roller_radius_mm"),
    "L.space": SymbolSource("length of the roller", "mm", lambda s, _: s.machine.outer - s.machine.inner, "cam.roller_length_mm"),
    "p.space": SymbolSource("point of the roller's axis"),
    "g.middle": SymbolSource("|n · ∂p/∂y| in the roller's middle", _per_motion, _middle_gain, CAM),
}  # fmt: skip
