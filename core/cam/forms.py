"""Forms of a cam, one row each: which flanks there are besides the first, and what touches each.

A form of a disk cam is its class with its word in ``core.design.forms``, named by the cams of ``core.design.parts`` that may have it, and
its row here; a flank of a new name is drawn by a row of ``FURTHER`` in the window's ``cam_parts``. What reads, proves, writes and
explains it follows from these.

A cam that does not turn in the plane of its follower, as a barrel, which slides past it once it is unrolled, is no further row here
alone. How a disk moves past the follower is said by ``relative_motion``, ``turned_back`` and ``sliding`` of ``core.cam.shape``, by the
turning of the face (``rate``) in ``core.cam.flat_face``, by ``_require_cam`` of ``round_face`` and ``flat_face`` and by
``cam_follower_centre``: these would ask the cam. Crossings, walls, the profile's files and its picture take the closed curve about the
origin that a disk has; a cam of another shape brings its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from core.cam.faces import row_of
from core.cam.round_face import round_envelope
from core.cam.shape import INNER, OUTER, SECOND, CamShape, Flank
from core.design import Conjugate, Face, Groove, LinkageConjugate, Open, Roller
from core.followers import SECOND_ROLLER
from core.mechanism.kinematics import FRAME, Kinematics, Pose
from core.mechanism.mechanism import body_name
from core.numerics.vectors import dot


class FormRow(NamedTuple):
    """What every form fills; ``form`` is its part of the design.

    flanks     names of its flanks, in the order of ``CamShape.flanks``
    further    kinematics, face, cam, sense -> the flanks besides the first; raises NoCam
    faces      face, form -> what touches each flank: of a groove the outer flank is touched by a roller that is larger by the
               play, of a conjugate pair the second cam by the second roller
    sides      what carries the follower, as messages say it, where it is held from both sides: by the first flank, by the other
    """

    flanks: tuple[str, ...]
    further: Callable[[Kinematics, Any, Any, float], tuple[Flank, ...]]
    faces: Callable[[Any, Any], tuple[Face, ...]]
    sides: tuple[str, ...] = ()


def _outer(kinematics: Kinematics, face: Roller, cam: Any, sense: float) -> tuple[Flank, ...]:
    """R - (Rr + play) n: the roller's centre keeps to the pitch curve of the inner flank."""
    offset = -1e-3 * (face.radius_mm + cam.form.play_mm)
    return (round_envelope(kinematics, face, cam, sense, offset, OUTER),)


def _second(kinematics: Kinematics, face: Roller, cam: Any, sense: float) -> tuple[Flank, ...]:
    """R₂ + (Rr₂ + play) n₂, of the second roller's own relative motion, by the equations of the first."""
    roller = Roller(cam.form.second.roller_radius_mm)
    there = second_kinematics(kinematics, *_place(cam.form))
    return (round_envelope(there, roller, cam, sense, 1e-3 * (roller.radius_mm + cam.form.play_mm), SECOND),)


def _place(form: Conjugate | LinkageConjugate) -> tuple[str, str]:
    """Body and point of the second roller's centre; the body's name empty where it is the one that carries the first."""
    return (
        (body_name(form.second.link), form.second.point) if isinstance(form, LinkageConjugate) else ("", SECOND_ROLLER)
    )


def second_kinematics(kinematics: Kinematics, body: str, point: str) -> Kinematics:
    """The same mechanism, as seen by a cam that acts on another point."""
    carrier = body or kinematics.carrier
    carrying = kinematics.bodies[carrier]
    at = carrying.points[point]
    pose = Pose(carrying.carried(at), carrying.turn, MappingProxyType({point: 0j}), lambda: carrying.unit)

    def travel() -> np.ndarray:
        path = kinematics.by_driver[carrier].carried(at)[1]
        return np.asarray(path / np.abs(path))

    bodies = {
        name: each for name, each in kinematics.bodies.items() if name != kinematics.follower_body or name == carrier
    }
    held = (name for name, pair in kinematics.pairs.items() if {pair.on, pair.body} == {FRAME, carrier})
    return Kinematics(
        kinematics.motion,
        MappingProxyType({**bodies, SECOND: pose}),
        kinematics.pairs,
        kinematics.dyads,
        kinematics.output,
        SECOND,
        next(held, ""),
        travel=travel,
        coordinates=lambda: kinematics.coordinates,
        base=lambda: kinematics.base,
        residual=lambda: kinematics.residual,
        condition=lambda: kinematics.condition,
        singular=lambda: kinematics.singular,
        transmission=lambda: kinematics.transmission,
        carrier=carrier,
        by_driver=lambda: kinematics.by_driver,
    )


def path_by_driver(kinematics: Kinematics, flank: Flank) -> np.ndarray:
    """Velocity (n,) complex of the reference point of a flank by the driver's coordinate; it exists in dwells too."""
    pose = kinematics.by_driver[flank.body]
    return np.asarray(pose.origin[1] + 1j * pose.turn[1] * (flank.reference - pose.origin[0]))


def forward_push(kinematics: Kinematics, flank: Flank) -> np.ndarray:
    """How much of one newton on a flank's roller pushes the driver forward (n,): -n·v, v the unit vector of where the roller's
    centre goes as the driver's coordinate grows."""
    path = path_by_driver(kinematics, flank)
    return -dot(flank.normal, path) / np.abs(path)


def _grooved(face: Roller, form: Groove) -> tuple[Face, ...]:
    return face, Roller(face.radius_mm + form.play_mm)


def _paired(face: Roller, form: Conjugate | LinkageConjugate) -> tuple[Face, ...]:
    return face, Roller(form.second.roller_radius_mm + form.play_mm)


_PAIR = FormRow((INNER, SECOND), _second, _paired, ("first roller", "second roller"))

FORMS: Mapping[type, FormRow] = MappingProxyType(
    {
        Open: FormRow((INNER,), lambda kinematics, face, cam, sense: (), lambda face, form: (face,)),
        Groove: FormRow((INNER, OUTER), _outer, _grooved, ("inner flank", "outer flank")),
        Conjugate: _PAIR,
        LinkageConjugate: _PAIR,
    }
)


def form_row(form: Any) -> FormRow:
    """The row of a form."""
    return FORMS[type(form)]


def envelope(kinematics: Kinematics, face: Any, cam: Any, sense: float) -> CamShape:
    """The cam that moves the follower body of the kinematics; sense: d = +1 counter-clockwise, -1 clockwise. Raises NoCam."""
    shape = row_of(face).envelope(kinematics, face, cam, sense)
    further = form_row(cam.form).further(kinematics, face, cam, sense)
    return CamShape((*shape.flanks, *further), sense) if further else shape


def faces_of(face: Any, cam: Any) -> Mapping[str, Face]:
    """What touches each flank, by the flank's name."""
    row = form_row(cam.form)
    return MappingProxyType(dict(zip(row.flanks, row.faces(face, cam.form), strict=True)))
