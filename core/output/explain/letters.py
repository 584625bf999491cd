"""The letters of equations: what each means, its value at one angle of a study, and where that comes from."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from core.cam import SECOND, Flank
from core.design import UNITS, get
from core.frozen import frozen
from core.numerics.derivatives import cross
from core.study import Study, quantity

MOTION, LINKAGE, CAM, DYNAMICS, STABILITY, LOADS = "motion", "linkage", "cam", "dynamics", "stability", "loads"


@frozen
class Letter:
    """One letter of an equation: as it is written, what it means, its value in the unit, the field's path or the stage it comes from;
    column: of the quantity that it is, which can be explained in turn."""

    symbol: str
    meaning: str
    value: float
    unit: str
    origin: str
    column: str = ""


@frozen
class Known:
    """How a letter is read of a study at one angle: value in SI units; unit: key of ``UNITS``, empty: a plain number, or SI as
    ``shown`` calls it."""

    meaning: str
    unit: str
    value: Callable[[Study], float]
    origin: str | Callable[[Study], str]
    shown: str = ""
    column: str = ""

    def of(self, study: Study, symbol: str) -> Letter:
        """The letter with its value there."""
        origin = self.origin if isinstance(self.origin, str) else self.origin(study)
        return letter(symbol, self.meaning, float(self.value(study)), self.unit, origin, self.shown, self.column)


def letter(
    symbol: str,
    meaning: str,
    value: float,
    unit: str = "",
    origin: str = DYNAMICS,
    shown: str = "",
    column: str = "",
) -> Letter:
    """A letter by its value in SI units."""
    factor, name = (UNITS[unit].factor, UNITS[unit].symbol) if unit else (1.0, shown)
    return Letter(symbol, meaning, float(value) / factor + 0.0, name, origin, column)


def first(values: np.ndarray) -> float:
    """The one value of a study at one angle."""
    return float(np.atleast_1d(values)[0])


def of_quantity(name: str, meaning: str = "", unit: str = "") -> Known:
    """A letter that is a quantity itself."""
    row = quantity(name)

    def value(study: Study) -> float:
        return first(row.value(study))

    return Known(meaning or row.label.lower(), unit or _unit(row.slug), value, row.stage, column=row.slug)


def _unit(slug: str) -> str:
    return next((key for key in sorted(UNITS, key=len, reverse=True) if slug.endswith(f"_{key}")), "")


def of_field(path: str, meaning: str, unit: str = "") -> Known:
    """A number that is typed."""
    factor = UNITS[unit].factor if unit else 1.0
    return Known(meaning, unit, lambda study: factor * float(get(study.design, path) or 0.0), path)


def speed_field(study: Study) -> str:
    """Where the speed is typed."""
    return "linkage.driver.speed_rpm" if study.by_crank and study.design.shaft is None else "shaft.speed_rpm"


def motion_unit(study: Study) -> str:
    """mm or deg."""
    return study.design.drive.motion_unit


def _flank(of: Callable[[Flank], np.ndarray | complex], name: str = "") -> Callable[[Study], complex]:
    def value(study: Study) -> complex:
        flank = study.cam.only(name).flank if name else study.cam.flank
        return complex(np.atleast_1d(of(flank))[0])

    return value


def _x(value: Callable[[Study], complex]) -> Callable[[Study], float]:
    return lambda study: value(study).real


def _y(value: Callable[[Study], complex]) -> Callable[[Study], float]:
    return lambda study: value(study).imag


def _vector(
    name: str, meaning: str, unit: str, value: Callable[[Study], complex], origin: str = CAM
) -> dict[str, Known]:
    """Both parts of a vector."""
    mark = name if "_" in name else f"{name}_"
    return {
        f"{mark}x": Known(f"{meaning}, x", unit, _x(value), origin),
        f"{mark}y": Known(f"{meaning}, y", unit, _y(value), origin),
    }


def inner_normal(flank: Flank, study: Study) -> np.ndarray:
    """-i d t/|t|, which for the outer flank of a groove is not its own normal."""
    t = flank.relative_velocity
    return np.asarray((-1j * study.sense) * t / np.abs(t))


def bend(study: Study) -> complex:
    """w = R'' - 2 i d R' - R."""
    r, d = study.linkage.follower.origin, study.sense
    return complex(np.atleast_1d(r[2] - 2j * d * r[1] - r[0])[0])


def face_normal(study: Study) -> complex:
    """m of a straight face, from the cam to the face."""
    return complex(-np.atleast_1d(study.cam.flank.normal)[0])


def support_slope(study: Study) -> float:
    """h_ν = h'/(φ' - d)."""
    return first(study.cam.flank.on_face) + cross_with_reference(study)


def cross_with_reference(study: Study) -> float:
    """Im(m̄ R)."""
    return first(cross(np.array([face_normal(study)]), np.atleast_1d(study.cam.flank.reference)))


def turned(study: Study) -> float:
    """φ', of the body that the cam moves, by cam angle."""
    return first(np.broadcast_to(study.linkage.follower.turn[1], 1))


def reference_slope(study: Study) -> complex:
    """R'."""
    return complex(np.atleast_1d(study.linkage.follower.origin[1])[0])


def carrying(study: Study) -> int:
    """Number of the flank that carries."""
    forces = [abs(first(each.force)) for each in study.dynamics.contacts]
    return int(np.argmax(forces))


def pressing(study: Study) -> complex:
    """n + μ v̂ on the flank that carries."""
    return complex(np.atleast_1d(study.dynamics.contacts[carrying(study)].pressing)[0])


def pressed(study: Study) -> complex:
    """Where the flank that carries is touched [m]."""
    return complex(np.atleast_1d(study.dynamics.contacts[carrying(study)].at)[0])


def pressing_force(study: Study) -> float:
    """On the flank that carries."""
    return first(study.dynamics.contacts[carrying(study)].force)


def play(study: Study) -> float:
    """Between roller and groove, or of a conjugate pair."""
    return 1e-3 * float(getattr(study.design.drive.cam.form, "play_mm", 0.0))


def guide_line(study: Study) -> complex:
    """Unit vector along the guide of the follower's output."""
    return complex(np.atleast_1d(study.linkage.line(study.linkage.driver_pair))[0])


def pin(body: str, point: str) -> Callable[[Study], complex]:
    """Where a point of a body stands."""
    return lambda study: complex(np.atleast_1d(study.linkage.bodies[body].position(point))[0])


LETTERS: Mapping[str, Known] = MappingProxyType(
    {
        "ω": Known("angular velocity of the shaft or crank", "rad_s", lambda s: s.omega, speed_field),
        "d": Known("sense of rotation: +1 counter-clockwise, -1 clockwise", "", lambda s: s.sense, "shaft.rotation"),
        "θ": Known("cam angle", "deg", lambda s: first(s.theta), "--at"),
        "L": of_quantity("slider_position"),
        "φ": of_quantity("phi"),
        "β": of_quantity("beta"),
        "φ̇": of_quantity("phi_velocity"),
        "β̇": of_quantity("beta_velocity"),
        "L̇": of_quantity("velocity", "velocity of the slider", "mm_s"),
        "L̈": of_quantity("acceleration", "acceleration of the slider", "mm_s2"),
        "L₁": of_field("follower.slider_arm_mm", "slider arm", "mm"),
        "L₂": of_field("follower.rod_mm", "rod", "mm"),
        "H": of_field("follower.guide_height_mm", "height of the guide over the pivot", "mm"),
        "R_r": Known("radius of roller, shoe or edge", "mm", lambda s: s.cam.flank.radius, "cam.roller_radius_mm"),
        "R_r2": Known("radius of the second roller", "mm", lambda s: s.cam.only(SECOND).flank.radius, "cam.second.roller_radius_mm"),
        "s_p": Known("play", "mm", play, "cam.form"),
        **_vector("R", "centre of the roller, or the face's reference point", "mm", _flank(lambda f: f.reference)),
        **_vector("R_2", "centre of the second roller", "mm", _flank(lambda f: f.reference, SECOND)),
        **_vector("t", "its velocity against the cam, by cam angle", "mm", _flank(lambda f: f.relative_velocity)),
        **_vector("w", "R″ - 2 i d R′ - R, by cam angle", "mm", bend),
        **_vector("v", "unit vector along its travel", "", lambda s: complex(np.atleast_1d(s.linkage.travel)[0]), LINKAGE),
        **_vector("m", "unit normal of the face, away from the cam", "", face_normal),
        "h": Known("distance of the face from the cam centre", "mm", lambda s: first(s.cam.flank.support), CAM),
        "h_ν": Known("its derivative by the angle of the normal", "mm", support_slope, CAM),
        "ρ": Known("radius of curvature, h + h_νν", "mm", lambda s: first(s.cam.flank.profile_radius), CAM),
        "κ_p": of_quantity("pitch_curvature"),
        "φ′": Known("turning of the follower, by cam angle", "", turned, LINKAGE),
        **_vector("R′", "velocity of the reference point, by cam angle", "mm", reference_slope, LINKAGE),
        "Q": of_quantity("instant_centre"),
        **_vector("C", "where the cam is touched", "mm", pressed, CAM),
        **_vector("p", "force on the cam for one newton, friction of the face included (a unit vector without)", "", pressing, CAM),
        "F": Known("force on the flank that carries", "n", pressing_force, DYNAMICS, column="contact_force_n"),
        "F_c": of_quantity("contact_force"),
    }
)  # fmt: skip
"""Letters that mean the same in every equation."""

# -- equations in them ---------------------------------------------------------------------------------------

Maker = Callable[[Study, str], "Working"]
"""Of a study at one angle and a member of its linkage, empty of what has none."""


@frozen
class Working:
    """The equation, its further lines, and its letters."""

    lines: tuple[str, ...]
    letters: tuple[Letter, ...]


def by(lines: str | tuple[str, ...], letters: str) -> Maker:
    """An equation whose letters are rows of ``LETTERS``."""
    all_lines = (lines,) if isinstance(lines, str) else lines
    return lambda study, _: Working(all_lines, tuple(LETTERS[each].of(study, each) for each in letters.split()))


def known(study: Study, letters: str) -> tuple[Letter, ...]:
    return tuple(LETTERS[each].of(study, each) for each in letters.split())


def either(straight: Maker, round_: Maker) -> Maker:
    """Under a straight face, or under a round."""
    return lambda study, member: (straight if study.design.drive.face.straight else round_)(study, member)


def other(study: Study, name: str, symbol: str) -> Letter:
    """Another quantity as a letter."""
    row = quantity(name)
    key = next((key for key in sorted(UNITS, key=len, reverse=True) if UNITS[key] == row.unit), "")
    return letter(symbol, row.label.lower(), first(row.value(study)), key, row.stage, row.unit.symbol, row.slug)


__all__ = [
    "LETTERS", "Known", "Letter", "Maker", "Working", "by", "either", "first", "known", "letter", "motion_unit", "other", "pin",
    "speed_field",
]  # fmt: skip
