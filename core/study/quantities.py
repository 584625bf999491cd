"""Every scalar that can be read from a study, as one table: which stage it needs and where it stands there (SI).

Those of a linkage's links, slides, points and joints are made by name: ``link.3_velocity``, ``point.B_x``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import lru_cache, partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from core import dynamics
from core.cam import OUTER, SECOND, form_row, forward_push, row_of
from core.design import FOLLOWER_KINDS, FRAME_LINK, Design
from core.design.topology import GROUP, driver_pair, is_pin, solving_order
from core.dynamics import GuideReaction, loading_of
from core.frozen import frozen
from core.mechanism import SINGULAR, mechanism_of
from core.mechanism.kinematics import SLIDING
from core.motion import Angles
from core.shaft import Flywheel
from core.stress import pairings, ratings
from core.study.study import Study
from core.study.touching import ROLLERS, roller_speed

if TYPE_CHECKING:
    from core.stability import SteadyTurn

FOLLOWERS = frozenset(FOLLOWER_KINDS)
ALL_KINDS = FOLLOWERS | {"linkage"}
SLIDER = frozenset({"cam-slider"})
GUIDED = frozenset({"cam-slider", "translating"})
PIVOTED = frozenset({"cam-slider", "oscillating"})


def _is_rated(roller: str, design: Design) -> bool:
    return design.drive.cam is not None and roller in ratings(design.drive.face, design.drive.cam)


NEEDS: Mapping[str, Callable[[Design], bool]] = MappingProxyType(
    {
        "": lambda design: True,
        "motion": lambda design: design.drive.motion is not None,
        "cam": lambda design: design.drive.cam is not None,
        "pitch": lambda design: design.drive.cam is not None and "pitch_curvature" in row_of(design.drive.face).limits,
        "straight": lambda design: design.drive.cam is not None and design.drive.face.straight,
        OUTER: lambda design: design.drive.cam is not None and OUTER in form_row(design.drive.cam.form).flanks,
        SECOND: lambda design: design.drive.cam is not None and SECOND in form_row(design.drive.cam.form).flanks,
        "stress": lambda design: design.drive.cam is not None and bool(pairings(design.drive.face, design.drive.cam)),
        "second stress": lambda design: NEEDS[SECOND](design) and NEEDS["stress"](design),
        **{f"{roller} rating": partial(_is_rated, roller) for roller in ROLLERS},
        "elastic": lambda design: design.drive.cam is not None and bool(design.drive.loads.follower_stiffness_n_per_mm),
        "elastic open": lambda design: NEEDS["elastic"](design) and not design.drive.cam.form.holds,
        "elastic shaft": lambda design: (
            design.drive.cam is not None and design.shaft is not None and design.shaft.elastic is not None
        ),
        "shaft": lambda design: design.shaft is not None and (design.drive.cam is not None or design.by_crank),
    }
)
"""What a design must hold for a quantity."""


def _always(study: Study) -> bool:
    return True


def _motor_runs(study: Study) -> bool:
    """Not where the guide jams, nor where the motor stalls."""
    return study.jam is None and (not study.levelled or study.flywheel.runs)


def _by_motor(torque: Callable[[Flywheel, Angles], np.ndarray]) -> Callable[[Study], np.ndarray]:
    """That of the cam where no flywheel levels it. Raises NoAnswer where the guide jams or the motor stalls."""
    return lambda s: torque(s.flywheel, s.angles) if s.levelled or s.jam is not None else s.shaft_torque


def _speed(study: Study) -> np.ndarray:
    """Constant where no flywheel lets it change."""
    if study.levelled or study.jam is not None:
        return study.flywheel.speed(study.angles)
    return np.full(study.theta.size, study.omega)


@frozen
class Quantity:
    """stage it needs; value (n,) in SI by time where it is a rate; kinds of mechanism that have it; ``needs``: what else the
    design must hold (row of ``NEEDS``); ``turns`` marks an angle that goes round, which has no extremes; ``exists`` says
    whether a design that could have it does, ``fitting`` that it does only where what touches fits the profile
    (``extremes.exists`` asks both)."""

    stage: str
    value: Callable[[Study], np.ndarray]
    kinds: frozenset[str] = ALL_KINDS
    needs: str = ""
    turns: bool = False
    exists: Callable[[Study], bool] = _always
    fitting: bool = False


def _guide(study: Study) -> GuideReaction:
    guide = study.dynamics.guide
    assert guide is not None, "the mechanism has no guide"
    return guide


_RATES = ("", "_velocity", "_acceleration")
_MOTION = ("displacement", "velocity", "acceleration", "jerk")
_FORCES: Mapping[str, frozenset[str]] = MappingProxyType(
    {"slider_pin": SLIDER, "arm_pin": SLIDER, "pivot": PIVOTED, "bearing": FOLLOWERS, "guide": GUIDED}
)
"""Pairs of followers whose forces are tabled, and the kinds that have them."""


def _of_motion(order: int) -> Callable[[Study], np.ndarray]:
    return lambda s: s.motion.displacement[order] * s.omega**order


def _singular(code: str) -> Callable[[Study], np.ndarray]:
    return lambda s: s.linkage.singular[code]


def _coordinate_of(name: str, order: int) -> Callable[[Study], np.ndarray]:
    return lambda s: s.linkage.coordinates[name][order] * s.omega**order


Part = Callable[[np.ndarray], np.ndarray]
_OF_POINT: Mapping[str, tuple[int, Part]] = MappingProxyType(
    {"x": (0, np.real), "y": (0, np.imag), "vx": (1, np.real), "vy": (1, np.imag), "ax": (2, np.real), "ay": (2, np.imag),
     "speed": (1, np.abs)}
)  # fmt: skip
_OF_FORCE: Mapping[str, Part] = MappingProxyType({"x": np.real, "y": np.imag, "size": np.abs, "direction": np.angle})
_GOES_ROUND = frozenset({"direction"})
"""Parts of a force that have no extremes, since they go round."""


def _point_part(name: str, what: str) -> Callable[[Study], np.ndarray]:
    order, part = _OF_POINT[what]

    def value(study: Study) -> np.ndarray:
        pose = study.linkage.bodies[study.linkage.body_of(name)]
        return part(pose.place(name, order) * study.omega**order)

    return value


def _force_part(name: str, what: str) -> Callable[[Study], np.ndarray]:
    part = _OF_FORCE[what]
    return lambda s: part(s.dynamics.pairs[name])


def _of_flank(name: str, value: Callable[[Any], np.ndarray]) -> Quantity:
    """A figure of a flank that not every cam has."""
    return Quantity("cam", lambda s: value(s.cam.only(name).flank), needs=name)


def _second_push(study: Study) -> np.ndarray:
    """What one newton on the second roller pushes forward, times what one on the first does, as parts of that newton (n,):
    negative where they push opposite ways."""
    shape = study.cam
    return forward_push(study.linkage, shape.flank) * forward_push(study.linkage, shape.only(SECOND).flank)


def _stress(part: str, second: bool = False) -> Quantity:
    """Of what the first roller or face touches, in a groove the flank that carries; or of the second roller."""

    def value(study: Study) -> np.ndarray:
        parts = [getattr(each, part) for name, each in study.stress.items() if (name == SECOND) == second]
        return np.asarray(sum(parts[1:], parts[0]))

    return Quantity("dynamics", value, needs="second stress" if second else "stress", fitting=True)


def _elastic(value: Callable[[Study], np.ndarray], needs: str = "elastic") -> Quantity:
    """Of a follower that is not rigid, where it does the same every turn."""
    return Quantity("dynamics", value, needs=needs, exists=lambda s: s.vibrates)


def _roller_speed(roller: str) -> Quantity:
    return Quantity("dynamics", lambda s: roller_speed(s, roller), needs=f"{roller} rating")


_STRESSES = {
    "contact_pressure": "pressure", "subsurface_shear": "shear", "subsurface_shear_depth": "depth", "contact_half_width": "half_width",
}  # fmt: skip


def _steady(value: Callable[[SteadyTurn, np.ndarray], np.ndarray]) -> Quantity:
    """Of the flexible shaft's steady response, by the angle of its input."""

    def exists(study: Study) -> bool:
        return study.stability is not None and study.stability.steady_turn is not None

    return Quantity("stability", lambda s: value(s.steady_turn, s.theta), needs="elastic shaft", exists=exists)


def _line_of_centres(study: Study) -> np.ndarray:
    """Unit vector (1,) from the cam centre along which Q is counted: to the follower's pivot; across a guide so that Q = y'."""
    kinematics = study.linkage
    pair = kinematics.pairs[kinematics.ground]
    if pair.kind == SLIDING:
        return -1j * study.sense * kinematics.line(pair)
    pivot = kinematics.bodies[pair.body].place(pair.point)[:1]
    return np.asarray(pivot / np.abs(pivot))


def _centre_distance(study: Study) -> np.ndarray:
    centre = study.cam.flank.centre
    with np.errstate(divide="ignore"):
        return np.asarray((np.conj(_line_of_centres(study)) * centre.point).real / centre.weight)


def _centre_velocity(study: Study) -> np.ndarray:
    """V_Q = Q θ̇; its size, where the follower's pole moves and Q with it off any line."""
    held = study.kind in FOLLOWERS
    return study.omega * (_centre_distance(study) if held else np.abs(study.cam.flank.centre.finite))


def _reference_velocity(study: Study) -> np.ndarray:
    """Of the roller's centre, > 0 where V_Q is, which carries it along; its size, where the pole moves."""
    kinematics = study.linkage
    moved = study.omega * kinematics.follower.origin[1]
    if study.kind not in FOLLOWERS:
        return np.asarray(np.abs(moved))
    pair = kinematics.pairs[kinematics.ground]
    if pair.kind == SLIDING:
        return np.asarray((np.conj(kinematics.line(pair)) * moved).real)
    arm = kinematics.follower.origin[0] - kinematics.bodies[pair.body].place(pair.point)
    return np.asarray((np.conj(-1j * study.sense * arm / np.abs(arm)) * moved).real)


def _polar_angle(study: Study) -> np.ndarray:
    """0 ... 2π, 2π itself never."""
    angle = np.mod(np.angle(study.cam.flank.profile), 2.0 * np.pi)
    return np.where(angle >= 2.0 * np.pi, 0.0, angle)


QUANTITIES: Mapping[str, Quantity] = MappingProxyType(
    {
        **{name: Quantity("motion", _of_motion(order), needs="motion") for order, name in enumerate(_MOTION)},
        "slider_position": Quantity("linkage", _coordinate_of("slider_position", 0), SLIDER),
        **{
            name + rate: Quantity("linkage", _coordinate_of(name, order), SLIDER)
            for name in ("phi", "beta")
            for order, rate in enumerate(_RATES)
        },
        **{code: Quantity("linkage", _singular(code), SLIDER) for code in SINGULAR},
        "profile_x": Quantity("cam", lambda s: s.cam.flank.profile.real, needs="cam"),
        "profile_y": Quantity("cam", lambda s: s.cam.flank.profile.imag, needs="cam"),
        "pitch_x": Quantity("cam", lambda s: s.cam.flank.pitch.real, needs="pitch"),
        "pitch_y": Quantity("cam", lambda s: s.cam.flank.pitch.imag, needs="pitch"),
        "pressure_angle": Quantity("cam", lambda s: s.cam.flank.pressure_angle, needs="cam"),
        "pitch_curvature": Quantity("cam", lambda s: s.cam.flank.pitch_curvature, needs="pitch"),
        "profile_curvature": Quantity("cam", lambda s: s.cam.flank.profile_curvature, needs="cam"),
        "profile_radius": Quantity("cam", lambda s: s.cam.flank.profile_radius, needs="straight"),
        "contact_on_face": Quantity("cam", lambda s: s.cam.flank.on_face, needs="straight"),
        "radius": Quantity("cam", lambda s: np.abs(s.cam.flank.profile), needs="cam"),
        "instant_centre": Quantity("cam", _centre_distance, FOLLOWERS, needs="cam"),
        "instant_centre_x": Quantity("cam", lambda s: s.cam.flank.centre.finite.real, needs="cam"),
        "instant_centre_y": Quantity("cam", lambda s: s.cam.flank.centre.finite.imag, needs="cam"),
        "instant_centre_velocity": Quantity("cam", _centre_velocity, needs="cam"),
        "reference_velocity": Quantity("cam", _reference_velocity, needs="pitch"),
        "polar_angle": Quantity("cam", _polar_angle, needs="cam", turns=True),
        "outer_x": _of_flank(OUTER, lambda flank: flank.profile.real),
        "outer_y": _of_flank(OUTER, lambda flank: flank.profile.imag),
        "outer_curvature": _of_flank(OUTER, lambda flank: flank.profile_curvature),
        "second_x": _of_flank(SECOND, lambda flank: flank.profile.real),
        "second_y": _of_flank(SECOND, lambda flank: flank.profile.imag),
        "second_pitch_x": _of_flank(SECOND, lambda flank: flank.pitch.real),
        "second_pitch_y": _of_flank(SECOND, lambda flank: flank.pitch.imag),
        "second_pressure_angle": _of_flank(SECOND, lambda flank: flank.pressure_angle),
        "second_pitch_curvature": _of_flank(SECOND, lambda flank: flank.pitch_curvature),
        "second_profile_curvature": _of_flank(SECOND, lambda flank: flank.profile_curvature),
        "second_roller_distance": _of_flank(SECOND, lambda flank: np.abs(flank.reference) - flank.radius),
        "second_push": Quantity("cam", _second_push, needs=SECOND),
        "contact_force": Quantity("dynamics", lambda s: s.dynamics.contact, needs="cam"),
        "second_contact_force": Quantity("dynamics", lambda s: s.dynamics.contacts[1].force, needs=SECOND),
        "drive_torque": Quantity("dynamics", lambda s: s.dynamics.torque, needs="cam"),
        "motor_torque": Quantity("dynamics", _by_motor(Flywheel.motor_torque), needs="shaft", exists=_motor_runs),
        "linear_motor_torque": Quantity(
            "dynamics",
            _by_motor(Flywheel.linear_motor_torque),
            needs="shaft",
            exists=lambda s: s.levelled and _motor_runs(s),
        ),
        "camshaft_speed": Quantity("dynamics", _speed, needs="shaft", exists=_motor_runs),
        "elastic_displacement": _elastic(lambda s: s.motion.displacement[0] + s.elastic_error()),
        "elastic_error": _elastic(lambda s: s.elastic_error()),
        "elastic_acceleration": _elastic(lambda s: s.motion.displacement[2] * s.omega**2 + s.elastic_error(2)),
        "elastic_contact_force": _elastic(lambda s: s.elastic_contact_force, "elastic open"),
        "follower_torque": Quantity("dynamics", lambda s: s.dynamics.follower_torque, PIVOTED),
        "guide_force": Quantity("dynamics", lambda s: _guide(s).normal, GUIDED),
        "jam_factor": Quantity("dynamics", lambda s: _guide(s).jam, GUIDED),
        **{
            f"{name}_{what}": Quantity("dynamics", _force_part(name, what), kinds, turns=what in _GOES_ROUND)
            for name, kinds in _FORCES.items()
            for what in ("x", "y", "direction")
        },
        "guide_couple": Quantity("dynamics", lambda s: s.dynamics.couples["guide"], GUIDED),
        **{name: Quantity("dynamics", _force_part(name, "size"), kinds) for name, kinds in _FORCES.items()},
        **{name: _stress(part) for name, part in _STRESSES.items()},
        **{f"second_{name}": _stress(part, second=True) for name, part in _STRESSES.items()},
        "roller_speed": _roller_speed("first"),
        "second_roller_speed": _roller_speed("second"),
        "wind_up": _steady(lambda turn, theta: turn.wind_up(theta)),
        "follower_error": _steady(lambda turn, theta: turn.error(theta)),
        "shaft_torque": _steady(lambda turn, theta: turn.torque(theta)),
    }
)

OF_MOTOR = frozenset({"motor_torque", "linear_motor_torque", "camshaft_speed"})
"""Those of the stage ``dynamics`` that flywheel and motor change; forces are those of a constant speed."""

OF_CONTACT = frozenset({f"{of}{name}" for of in ("", "second_") for name in (*_STRESSES, "roller_speed")})
"""Those of it that what cam and roller are made of changes."""

OF_SPEED = frozenset({"instant_centre_velocity", "reference_velocity"})
"""Those of the stage ``cam`` that the machine's speed changes; its shape is the same at any."""


# -- of a linkage, by name -----------------------------------------------------------------------------------

# pattern of the name -> stage, and what gives the value for what the pattern catches
_PATTERNS: tuple[tuple[str, str, Callable[..., Callable[[Study], np.ndarray]]], ...] = (
    (r"(link|slide)\.(\d+)(|_velocity|_acceleration)", "linkage",
     lambda of, number, rate: _coordinate_of(f"{of}{number}", _RATES.index(rate))),
    (rf"point\.(\w+)_({'|'.join(_OF_POINT)})", "linkage", _point_part),
    (r"transmission\.(\w+)", "linkage", lambda joint: lambda s: np.arcsin(np.minimum(s.linkage.singular[joint], 1.0))),
    (rf"force\.(\w+)_({'|'.join(_OF_FORCE)})", "dynamics", _force_part),
    (r"couple\.(\w+)", "dynamics", lambda name: lambda s: s.dynamics.couples[name]),
    (r"driver_(?:torque|force)", "dynamics", lambda: lambda s: s.dynamics.driver),
    (r"kinetic_energy(?:\.(\w+))?", "dynamics", lambda body: lambda s: dynamics.kinetic_energy(s.linkage, s.loading, s.omega, body)),
    (r"power\.drive", "dynamics", lambda: lambda s: dynamics.power_given(s.linkage, s.dynamics)),
    (r"power\.gravity", "dynamics", lambda: lambda s: dynamics.power_of_gravity(s.linkage, s.loading, s.omega)),
    (r"power\.friction_(\w+)", "dynamics", lambda pair: lambda s: -s.dynamics.rubbing[pair]),
    (r"power\.(\w+)", "dynamics", lambda name: lambda s: dynamics.power_of(s.loading.named[name], s.linkage, s.omega)),
)  # fmt: skip


@lru_cache(maxsize=1024)
@lru_cache(maxsize=1024)
def quantity(name: str) -> Quantity:
    """The row of a quantity's name: of the table, or ``link.3_velocity``, ``point.B_x``, ``transmission.B``.

    Raises KeyError.
    """
    if name in QUANTITIES:
        return QUANTITIES[name]
    for pattern, needed, make in _PATTERNS:
        match = re.fullmatch(pattern, name)
        if match:
            return Quantity(
                needed, make(*match.groups()), turns=bool(match.groups()) and match.groups()[-1] in _GOES_ROUND
            )
    raise KeyError(name)


# -- of a study, and of a design -----------------------------------------------------------------------------


def quantities_of(study: Study, stage: str | None = None) -> Mapping[str, Quantity]:
    """The scalars that can be read, of one stage or of all."""
    rows = {name: quantity(name) for name in names_of(study.design)}
    found = {name: row for name, row in rows.items() if stage in (None, row.stage)}
    if stage in (None, "linkage") and study.mechanism.ranged:
        for link, turning in study.course.turning.items():
            name = f"link.{link}"
            if turning.turns and name in found:
                found[name] = replace(found[name], turns=True)
    return found


@lru_cache(maxsize=64)
def names_of(design: Design) -> tuple[str, ...]:
    """Every quantity that a design can have, in the order of the tables."""
    links = tuple(_links(design)) if design.drive.links else ()
    pairs = tuple(_pairs(design)) if design.drive.links else ()
    stages: Mapping[str, tuple[str, ...]] = {"linkage": links, "dynamics": (*pairs, *_energies(design))}
    names: list[str] = []
    kind = design.drive.kind
    for stage in ("motion", "linkage", "cam", "dynamics", "stability"):
        rows = ((name, row) for name, row in QUANTITIES.items() if row.stage == stage)
        names += [name for name, row in rows if kind in row.kinds and NEEDS[row.needs](design)]
        names += stages.get(stage, ())
    return tuple(names)


def _links(design: Design) -> Iterator[str]:
    """Of the moving links, slides, points and joints."""
    linkage = design.drive.linkage
    for number in sorted(linkage.by_number):
        if number != FRAME_LINK and not (design.by_crank and number == linkage.driver.link):
            yield from (f"link.{number}{rate}" for rate in _RATES)
    for slider in linkage.sliders:
        yield from (f"slide.{slider.link}{rate}" for rate in _RATES)
    fixed = linkage.by_number[FRAME_LINK].places
    for point in dict.fromkeys(p.name for link in linkage.links for p in link.points if p.name not in fixed):
        yield from (f"point.{point}_{what}" for what in ("x", "y", "vx", "vy", "ax", "ay", "speed"))
    yield from (f"transmission.{step.joint}" for step in solving_order(linkage).steps if step.kind != GROUP)


def _energies(design: Design) -> Iterator[str]:
    """Kinetic energy of all, and of each body where there are several; power of the drive, of gravity, of each force element and of
    friction."""
    loads = design.drive.loads
    loading = loading_of(design.drive.mechanism, loads)
    moved = [mass.body for mass in loading.masses if mass.acts]
    if moved:
        yield "kinetic_energy"
    yield from (f"kinetic_energy.{body}" for body in moved if len(moved) > 1)
    yield "power.drive"
    if any(mass.inertia.mass and mass.gravity for mass in loading.masses):
        yield "power.gravity"
    yield from (f"power.{element.name}" for element in loading.elements if element.name)
    for list_name, name in (("springs", "spring"), ("torsion_springs", "torsion_spring"), ("process", "process")):
        yield from (f"power.{name}{i}" for i, _ in enumerate(getattr(loads, list_name), 1))
    yield from (f"power.friction_{friction.pair}" for friction in loading.frictions)
    yield from (f"power.friction_{dynamics.CAM_FACE}" for _ in range(loading.contact_friction > 0.0))
    yield from (f"power.friction_{name}" for name in _rubbing(design))


def _rubbing(design: Design) -> Iterator[str]:
    """The pairs that rub by a row of the loads, as the forces name them."""
    rows = design.drive.loads.pair_friction
    if not design.drive.links:
        yield from (row.pair for row in rows)
        return
    for row in rows:
        named, links = mechanism_of(design.drive.linkage).pair_names, {row.link, row.other} - {None}
        joined = (name for j, name in named.items() if j.name == row.pair and links <= {j.first.link, j.second.link})
        yield from list(joined)[:1]


def _pairs(design: Design) -> Iterator[str]:
    """Of the driver, where no cam moves it, and of every pair."""
    linkage = design.drive.linkage
    pair = driver_pair(linkage)
    if design.drive.cam is None:
        yield "driver_torque" if pair is not None and is_pin(pair) else "driver_force"
    for joint, name in mechanism_of(linkage).pair_names.items():
        yield from (f"force.{name}_{what}" for what in _OF_FORCE)
        if not joint.revolute:
            yield f"couple.{name}"
