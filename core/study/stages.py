"""Results of the stages, remembered by the parts of the design that they depend on."""

from __future__ import annotations

from collections import Counter, OrderedDict
from collections.abc import Callable, Hashable, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from core.cam import envelope
from core.design import Elastic, si
from core.dynamics import Loading
from core.errors import NoStability
from core.mechanism import Course, CrankProgram, Mechanism, solve_mechanism
from core.motion import Angles, MotionState, degrees, program
from core.motion.cuts import CutProgram
from core.motion.turn import Place, Turn
from core.numerics.lazy import locked

if TYPE_CHECKING:  # a rigid shaft needs nothing of it
    from core.stability import Coefficients, Stability
    from core.stability.contact import Contact
    from core.study.study import Study

KEPT = 24  # results of each kind that are kept, so that undo computes nothing
evaluations: Counter[str] = Counter()
"""How often each stage was really computed; tests read it."""


class Memory:
    """Results by kind and by a key that names all they depend on; of each kind the last ``KEPT`` used are kept.

    Whoever gets a result shares it with others, so its arrays are read-only. ``computed`` counts those made, by kind.
    """

    def __init__(self) -> None:
        self._kept: dict[Hashable, OrderedDict[Hashable, Any]] = {}
        self.computed: Counter[Hashable] = Counter()

    def get(self, kind: Hashable, key: Hashable, compute: Callable[[], Any]) -> Any:
        kept = self._kept.setdefault(kind, OrderedDict())
        with suppress(KeyError):  # not computed yet, or forgotten by another thread just now
            kept.move_to_end(key)
            return kept[key]
        self.computed[kind] += 1
        value = kept[key] = locked(compute())
        if len(kept) > KEPT:
            kept.popitem(last=False)
        return value

    def clear(self) -> None:
        self._kept.clear()
        self.computed.clear()


memory = Memory()


def clear_caches() -> None:
    """Forget every result and count."""
    memory.clear()
    program.cache_clear()
    evaluations.clear()


def grid(motion: Any, samples: int) -> Angles:
    """Equally spaced cam angles over one turn, the same object for the same question."""

    def compute() -> Angles:
        return program(motion).angles(np.deg2rad(degrees(samples)), kept=True)

    return memory.get("grid", (motion, samples), compute)


def crank_grid(course: Course, samples: int) -> Angles:
    """Equally spaced driver angles over one turn, as far as the linkage can be assembled there."""
    run = CrankProgram(course)
    return memory.get("grid", (course, samples), lambda: run.angles(np.deg2rad(run.degrees(samples)), kept=True))


def cut_grid(cut: CutProgram, at: np.ndarray) -> Angles:
    """The angles [deg] (n,) of a turn that is cut, the same object for the same question."""
    return memory.get("grid", (cut, at.size), lambda: cut.angles(np.deg2rad(at), kept=True))


def crank_state(course: Course, angles: Angles) -> MotionState:
    """The crank's own angle in place of a motion."""

    def compute() -> MotionState:
        return CrankProgram(course).state(angles)

    return memory.get("crank", (course, angles), compute) if angles.kept else compute()


def shaft_coefficients(
    compiled: Any,
    mechanism: Mechanism,
    course: Course,
    loading: Loading,
    inertia: float,
    stiffness: float,
    spring: str,
    factor: float,
) -> Coefficients | NoStability:
    """The periodic coefficients of the flexible shaft, or why there are none."""
    from core.stability import coefficients

    try:
        return coefficients(
            lambda angles: solve_mechanism(mechanism, compiled.state(angles), course),
            loading,
            compiled,
            inertia,
            stiffness,
            spring,
            factor,
        )
    except NoStability as error:
        return error


def flexible_shaft(
    compiled: Any,
    mechanism: Mechanism,
    course: Course,
    loading: Loading,
    face: Any,
    cam: Any,
    sense: float,
    elastic: Elastic,
    omega: float,
    unit: str,
) -> Stability | NoStability:
    """The stage ``stability``, or why there is none: the coefficients do not depend on speed and damping, and are kept apart."""
    from core.stability import Follower, Touching, contact_forces, stability

    s = si(elastic)
    parts = (
        compiled,
        mechanism,
        course,
        loading,
        s.camshaft_inertia,
        s.stiffness,
        elastic.spring,
        elastic.spring_factor,
    )
    made = memory.get("coefficients", parts, lambda: shaft_coefficients(*parts))
    if isinstance(made, NoStability):
        return made

    def kinematics_and_shape(angles: Angles) -> tuple[Any, Any]:
        kinematics = solve_mechanism(mechanism, compiled.state(angles), course)
        return kinematics, envelope(kinematics, face, cam, sense)

    def displacement(theta: np.ndarray) -> np.ndarray:
        return np.asarray(compiled.state(compiled.angles(theta)).displacement[0])

    def contact() -> Contact | None:
        touching = [] if cam.form.holds else [Touching(kinematics_and_shape, loading, compiled, made.sizes)]
        return contact_forces(made, elastic, touching, compiled)

    return stability(made, elastic, omega, contact, lambda: (Follower("", unit, displacement, compiled.starts),))


def whole_shaft(
    names: Sequence[str], rows: Sequence[tuple[int, Study, Place]], elastic: Elastic, omega: float
) -> Stability | NoStability:
    """The stability of a shaft with several drives, or why there is none; names: of the drives; rows: number of each in the list, its
    study, its place."""
    from core.stability import Driven, Follower, Touching, coefficients_of_all, contact_forces, own_sizes, stability

    turn, s = Turn([(study.program, place) for _, study, place in rows]), si(elastic)

    def driven(at: int, number: int, study: Study, place: Place) -> Driven:
        return Driven(
            lambda angles: study.at(angles).linkage,
            study.loading,
            study.program,
            lambda angles: turn.own(at, angles),
            place.sense,
            f"drives[{number}].",
        )

    def touching(at: int, name: str, number: int, study: Study, place: Place) -> Touching:
        def kinematics_and_shape(angles: Angles) -> tuple[Any, Any]:
            there = study.at(angles)
            return there.linkage, there.cam

        sizes = own_sizes(driven(at, number, study, place))
        return Touching(
            kinematics_and_shape,
            study.loading,
            study.program,
            sizes,
            lambda angles: turn.own(at, angles),
            place.sense,
            name,
            number,
        )

    def contact(made: Coefficients) -> Contact | None:
        followers = [
            touching(at, name, *row)
            for at, (name, row) in enumerate(zip(names, rows, strict=True))
            if "cam" in row[1].stages and not row[1].holds
        ]
        return contact_forces(made, elastic, followers, turn)

    def follower(name: str, study: Study, place: Place) -> Follower:
        def displacement(theta: np.ndarray) -> np.ndarray:
            return np.asarray(study.program.state(study.program.angles(place.own(theta))).displacement[0])

        return Follower(name, study.design.drive.motion_unit, displacement, place.machine(study.program.starts))

    def followers() -> Sequence[Follower]:
        return [
            follower(name, study, place)
            for name, (_, study, place) in zip(names, rows, strict=True)
            if "motion" in study.stages
        ]

    parts = (
        *((study.depends_on("dynamics"), place) for _, study, place in rows), s.camshaft_inertia, s.stiffness, elastic.spring,
        elastic.spring_factor,
    )  # fmt: skip

    def compute() -> Coefficients | NoStability:
        try:
            made: Coefficients = coefficients_of_all(
                [driven(at, *row) for at, row in enumerate(rows)],
                turn,
                s.camshaft_inertia,
                s.stiffness,
                elastic.spring,
                elastic.spring_factor,
            )
            return made
        except NoStability as error:
            return error

    try:
        made = memory.get("coefficients", parts, compute)
        return (
            made if isinstance(made, NoStability) else stability(made, elastic, omega, lambda: contact(made), followers)
        )
    except NoStability as error:
        return error
