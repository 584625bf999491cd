"""Inverse dynamics at constant speed: every reaction, the contact force and the cam's torque (Shin1995 §4).

Walks a Train from its outermost dyad to the body on the cam; each kind of dyad and of ground pair is one row.
Signs: a pair's force is the one on its outer side as named in the tables; F_c > 0 presses the roller on the cam.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from core.cam import CamShape
from core.dynamics.friction import GuideReaction, guide_reaction, jammed, limitless
from core.dynamics.loading import Loading
from core.train import REVOLUTE, SLIDING, Dyad, Pose, Train
from core.vectors import cross, dot


@dataclass(frozen=True, eq=False)
class Forces:
    """All forces at n cam angles, at constant speed ``omega`` [rad/s]; complex = global frame [N].

    pairs            pair name -> (n,) force: ``guide`` by the guide on its body, friction included; ``slider_pin``
                     by rod on slider; ``arm_pin`` by rod on arm; ``pivot`` by the frame on the arm; ``bearing`` by the
                     frame on the camshaft
    contact          (n,) F_c [N], > 0 presses the roller on the cam
    torque           (n,) T_c [N m], > 0 drives the cam (27)
    follower_torque  (n,) T_L [N m] that the contact gives the arm about its pivot (24); for a guide: force [N]
    guide            the guide's normal force, friction and jamming factor
    """

    omega: float
    pairs: Mapping[str, np.ndarray]
    contact: np.ndarray
    torque: np.ndarray
    follower_torque: np.ndarray
    guide: GuideReaction


@dataclass
class _Walk:
    """What the walk has found so far: ``passed`` is the force that the solved dyads put on the next body inwards, by
    point name."""

    train: Train
    loading: Loading
    omega: float
    pairs: dict[str, np.ndarray] = field(default_factory=dict)
    passed: dict[str, np.ndarray] = field(default_factory=dict)
    guide: GuideReaction | None = None

    def inertia_force(self, body: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """m(a - g) (n,), centre of mass (n,) and I α̈ (n,) of a body."""
        inertia, pose = self.loading.inertias[body], self.train.bodies[body]
        square = self.omega * self.omega
        return (
            inertia.mass * (square * pose.derivative(inertia.centre, 2) - self.loading.gravity),
            pose.derivative(inertia.centre, 0),
            inertia.about_centre * square * pose.turn[2],
        )


def _rod_and_slider(walk: _Walk, dyad: Dyad) -> None:
    """RRP: rod from the driving body's pin B to the slider pin A; the slider on a guide with friction.

    Slider: m_s L̈ = A_x + F + m_s g_x - μ|N| sgn L̇, 0 = A_y + N + m_s g_y (21), whose F_s is -A_x and whose μW is
    N = W. Rod: m_A a_G = B - A + m_A g, I_A β̈ = (r_B-r_G)×B + (r_A-r_G)×(-A) (22). With
    X = m_s L̈ - F - m_s g_x and E = [(r_B-r_G)×m_A(a_G-g) - I_A β̈]/L2:
    N0 = -(X sin β + E + m_s g_y cos β)/cos β, and friction adds tan β of each newton.
    """
    train = walk.train
    rod, slider = dyad.bodies
    inner, outer, sliding = dyad.pairs
    pin_b = train.bodies[rod].place(train.pairs[inner].point)
    pin_a = train.bodies[slider].place(train.pairs[outer].point)
    axis = train.pairs[sliding].axis
    length = np.abs(pin_a - pin_b)
    along = (pin_a - pin_b) * axis.conjugate() / length  # e^{iβ} in the guide's frame
    mass_force, centre, spin = walk.inertia_force(rod)
    slider_force, _, _ = walk.inertia_force(slider)
    in_guide = slider_force * axis.conjugate()
    x = in_guide.real - walk.loading.along_guide(train.motion.y[0])
    e = (cross(pin_b - centre, mass_force) - spin) / length
    # in_guide.imag is -m_s g_y: the slider does not accelerate across its guide
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = along.imag / along.real
        frictionless = -(x * along.imag + e) / along.real + in_guide.imag
    guide = guide_reaction(frictionless, train.motion.way, slope, walk.loading.friction)
    on_slider = (x - guide.friction + 1j * (in_guide.imag - guide.normal)) * axis
    on_rod = on_slider + mass_force
    walk.pairs[outer], walk.pairs[inner] = on_slider, -on_rod
    walk.pairs[sliding] = (guide.friction + 1j * guide.normal) * axis
    walk.passed[train.pairs[inner].point] = -on_rod
    walk.guide = guide


DYADS: Mapping[str, Callable[[_Walk, Dyad], None]] = MappingProxyType({"RRP": _rod_and_slider})


def _turning_follower(
    walk: _Walk, body: Pose, reference: np.ndarray, normal: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Arm about its pivot: J φ̈ = r_B×(-B) + r_G×mg - F_c (r_R×n) (24); I about mass centres, where the paper's text
    would count m r² twice. F_c from here, never from T_c, which is 0/0 in a dwell (25), (26)."""
    train = walk.train
    pair = train.pairs[train.ground]
    pivot = body.place(pair.point)
    mass_force, centre, spin = walk.inertia_force(pair.body)
    outer = np.zeros_like(reference)
    moment = -spin - cross(centre - pivot, mass_force)
    for point, force in walk.passed.items():
        moment = moment + cross(body.place(point) - pivot, force)
        outer = outer + force
    contact = moment / cross(reference - pivot, normal)
    walk.pairs[train.ground] = mass_force - outer + contact * normal
    return contact, -moment


def _sliding_follower(
    walk: _Walk, body: Pose, reference: np.ndarray, normal: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Follower along its guide e: m s̈ = -F_c n·e + F + m g·e - μ|N| sgn ṡ, 0 = -F_c n·ie + m g·ie + N."""
    train = walk.train
    pair = train.pairs[train.ground]
    mass_force, _, _ = walk.inertia_force(pair.body)
    in_guide = mass_force * pair.axis.conjugate()
    x = in_guide.real - walk.loading.along_guide(train.motion.y[0])
    forward, across = dot(normal, pair.axis), dot(normal, 1j * pair.axis)
    slope = across / forward
    guide = guide_reaction(-x * slope + in_guide.imag, train.motion.way, slope, walk.loading.friction)
    contact = (guide.friction - x) / forward
    walk.pairs[train.ground] = (guide.friction + 1j * guide.normal) * pair.axis
    walk.guide = guide
    return contact, -contact * forward


GROUNDS: Mapping[str, Callable[[_Walk, Pose, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]] = (
    MappingProxyType({REVOLUTE: _turning_follower, SLIDING: _sliding_follower})
)


def newton_euler(train: Train, shape: CamShape, loading: Loading, omega: float) -> Forces:
    """Forces at constant camshaft speed omega [rad/s, > 0], dyad by dyad from the output to the cam.

    Where the guide jams the forces are infinite; the findings say so. T_c = -d (R × F_c n) (27).
    """
    walk = _Walk(train, loading, omega)
    with np.errstate(invalid="ignore", over="ignore"):
        for dyad in train.dyads:
            DYADS[dyad.kind](walk, dyad)
        pair = train.pairs[train.ground]
        normal, reference = shape.flank.normal, shape.reference
        contact, follower = GROUNDS[pair.kind](walk, train.bodies[pair.body], reference, normal)
        pressing = contact * normal
        walk.pairs["bearing"] = -pressing
        torque = -shape.sense * cross(reference, pressing)
        assert walk.guide is not None
        told = Forces(omega, walk.pairs, contact, torque, follower, walk.guide)
        return _limitless(told) if jammed(walk.guide) else told


def _limitless(told: Forces) -> Forces:
    guide = replace(told.guide, normal=limitless(told.guide.normal), friction=limitless(told.guide.friction))
    pairs = {name: limitless(force) for name, force in told.pairs.items()}
    contact, torque, follower = (limitless(f) for f in (told.contact, told.torque, told.follower_torque))
    return Forces(told.omega, pairs, contact, torque, follower, guide)
