"""Known linkages from five of their poses: found again, dyads counted by a resultant, defects seen on a walk of the driver."""

from __future__ import annotations

import cmath
from collections.abc import Iterator
from itertools import islice, pairwise
from math import degrees, pi, radians

import numpy as np
import pytest
from scipy.linalg import eig

from core.synthesis import Answer, BodyPose, Dyad, Task, synthesise
from core.synthesis.poses import pose_dyads

PIN, GUIDE, TURNING = "pin", "guide", "turning-guide"
ANGLES = (0.0, 0.2, 0.45, 0.6, 0.9)  # of the driver behind its first angle [rad]
WALK = 1440  # steps in a turn of the driver


class Links:
    """A driver pin with a second dyad, assembled at a pose by the formulas of this file.

    Fixed pivots g, moving pivots a in the frame of the body; of a guide g2 is a point of the line in the frame, of a turning guide a2 a
    point of the line in the body.
    """

    def __init__(self, kind: str, pivots: tuple[complex, ...], line: float, pose: tuple[complex, float]) -> None:
        self.kind, self.line = kind, line
        self.g1, self.a1, self.g2, self.a2 = pivots
        d, self.theta = pose
        pin = d + self.a1 * cmath.exp(1j * self.theta) - self.g1
        self.crank, self.start = abs(pin), cmath.phase(pin)
        self.radius = abs(d + self.a2 * cmath.exp(1j * self.theta) - self.g2)

    def origin(self, q: float, theta: float) -> complex:
        """Origin of the body with the driver at an angle and the body turned."""
        return self.g1 + self.crank * cmath.exp(1j * q) - self.a1 * cmath.exp(1j * theta)

    def error(self, q: float, theta: float) -> float:
        """Residual of the second dyad's condition."""
        turn, d = cmath.exp(1j * theta), self.origin(q, theta)
        if self.kind == PIN:
            return abs(d + self.a2 * turn - self.g2) - self.radius
        along = cmath.exp(1j * self.line)
        if self.kind == GUIDE:
            return ((d + self.a2 * turn - self.g2) / along).imag
        return (((self.g2 - d) / turn - self.a2) / along).imag

    def assembled(self, q: float, theta: float) -> tuple[float, float] | None:
        """Angle of the body by Newton's method, and the slope there; None where the links do not meet near it."""
        for _ in range(30):
            here = self.error(q, theta)
            slope = (self.error(q, theta + 1e-7) - here) / 1e-7
            if not slope or abs(here / slope) > 0.3:
                return None
            theta -= here / slope
            if abs(here / slope) < 1e-12:
                return theta, slope
        return None


def random_links(kind: str) -> Iterator[tuple[Links, list[tuple[complex, float]]]]:
    """Random linkages with five poses, without end; those whose links do not meet on the way are left out."""
    seed = -1
    while True:
        seed += 1
        rng = np.random.default_rng(seed)
        g1, a1, g2, a2, d = (complex(*rng.normal(size=2)) * size for size in (50, 40, 50, 40, 50))
        theta, line = rng.uniform(0.0, 6.0), rng.uniform(-1.5, 1.5)
        if kind == TURNING:  # its line passes through the fixed pivot at the first pose
            a2 = (g2 - d) / cmath.exp(1j * theta)
        if kind == GUIDE:
            g2 = d + a2 * cmath.exp(1j * theta)
        links = Links(kind, (g1, a1, g2, a2), line, (d, theta))
        poses: list[tuple[complex, float]] = []
        for before, after in pairwise((0.0, *ANGLES)):
            for q in np.linspace(before, after, 20):
                state = links.assembled(links.start + q, theta)
                if state is None:
                    break
                theta = state[0]
            else:
                poses.append((links.origin(links.start + after, theta), theta))
                continue
            break
        if len(poses) == len(ANGLES):
            yield links, poses


def body_poses(poses: list[tuple[complex, float]]) -> tuple[BodyPose, ...]:
    return tuple(BodyPose(d.real, d.imag, degrees(theta)) for d, theta in poses)


# -- found again ------------------------------------------------------------------------------------------------


def distance(dyad: Dyad, links: Links) -> float:
    """Distance of a dyad from the second one of a linkage [mm]; infinite for another kind."""
    if dyad.kind != links.kind:
        return float("inf")
    if dyad.kind == PIN:
        return abs(dyad.fixed - links.g2) + abs(dyad.moving - links.a2)
    turn = abs(np.sin(dyad.line - links.line)) * 50.0
    if dyad.kind == GUIDE:
        across = abs(((dyad.fixed - links.g2) * cmath.exp(-1j * links.line)).imag)
        return float(abs(dyad.moving - links.a2) + across + turn)
    across = abs(((dyad.moving - links.a2) * cmath.exp(-1j * links.line)).imag)
    return float(abs(dyad.fixed - links.g2) + across + turn)


@pytest.mark.parametrize("kind", [PIN, GUIDE, TURNING])
@pytest.mark.parametrize("count", [15, pytest.param(100, marks=pytest.mark.stress)])
def test_a_linkage_is_found_again_from_five_of_its_poses(kind: str, count: int) -> None:
    """Its poses are met to 1e-9 of its size by the solved kinematics."""
    for links, poses in islice(random_links(kind), count):
        task = Task(kind="poses", poses=body_poses(poses))
        dyads = pose_dyads(task).all
        assert min(distance(dyad, links) for dyad in dyads) < 1e-5
        assert min(abs(d.fixed - links.g1) + abs(d.moving - links.a1) for d in dyads if d.kind == PIN) < 1e-5
        synthesis = synthesise(task)
        assert synthesis.complete
        best = min(synthesis.answers, key=lambda answer: answer.error_mm)
        assert best.error_mm < 1e-9 * best.size_mm
        assert radians(best.error_deg) < 1e-9


# -- the number of dyads ----------------------------------------------------------------------------------------


def circle_points(poses: tuple[BodyPose, ...]) -> list[complex]:
    """Points of a body that are on a circle at five poses, in units of 50 mm, by the resultant of two cubics.

    The centre g of a circle through the positions p of a point satisfies 2Re(ḡ(p - p₀)) = |p|² - |p₀|² for the other four: a matrix
    (4, 3), linear in the coordinates x, y of the point, of rank 2. Two of its minors are cubics in x and y.
    """
    d = np.array([pose.z for pose in poses]) / 50.0
    turn = np.exp(1j * np.radians([pose.angle_deg for pose in poses]))

    def matrix(x: complex, y: complex) -> np.ndarray:
        shift, rotation = d[1:] - d[0], turn[1:] - turn[0]
        mixed = np.conj(d[1:]) * turn[1:] - np.conj(d[0]) * turn[0]
        square = np.abs(d[1:]) ** 2 - np.abs(d[0]) ** 2
        rows = [
            2.0 * (shift.real + rotation.real * x - rotation.imag * y),
            2.0 * (shift.imag + rotation.imag * x + rotation.real * y),
            square + 2.0 * (mixed.real * x - mixed.imag * y),
        ]
        return np.stack(rows, axis=-1)

    nodes = np.array([-1.5, -0.5, 0.5, 1.5])
    values = np.array([[matrix(x, y) for x in nodes] for y in nodes])
    powers = np.linalg.inv(np.vander(nodes, increasing=True))
    sylvester = np.zeros((4, 6, 6))  # by powers of y
    for first, rows in ((0, [0, 1, 2]), (3, [0, 1, 3])):
        minor = powers @ np.linalg.det(values[:, :, rows]) @ powers.T  # powers of y, powers of x
        for k in range(3):
            sylvester[:, first + k, k : k + 4] = minor[:, ::-1]
    left, right = np.zeros((18, 18)), np.eye(18)
    left[:6, 6:12] = left[6:12, 12:] = np.eye(6)
    left[12:] = -np.hstack(sylvester[:3])
    right[12:, 12:] = sylvester[3]
    points: list[complex] = []
    for y in eig(left, right, right=False):
        if not np.isfinite(y) or abs(y) > 1e3 or abs(y.imag) > 1e-6 * (1.0 + abs(y)):
            continue
        _, _, vectors = np.linalg.svd(sum(sylvester[k] * y.real**k for k in range(4)))
        x = vectors[-1][4] / vectors[-1][5]
        sizes = np.linalg.svd(matrix(x, y.real), compute_uv=False)
        if sizes[2] < 1e-6 * sizes[1] and all(abs(complex(x, y.real) - z) > 1e-4 for z in points):
            points.append(complex(x, y.real))
    return points


@pytest.mark.parametrize("count", [25, pytest.param(400, marks=pytest.mark.stress)])
def test_the_dyads_are_those_of_a_resultant(count: int) -> None:
    rng, counts = np.random.default_rng(11), set()
    for _ in range(count):
        poses = tuple(BodyPose(*(50.0 * rng.normal(size=2)).tolist(), float(rng.uniform(0.0, 360.0))) for _ in range(5))
        pins = [dyad.moving / 50.0 for dyad in pose_dyads(Task(kind="poses", poses=poses)).all]
        points = circle_points(poses)
        near = [z for z in pins if abs(z) < 1e2]
        assert len(near) == len([z for z in points if abs(z) < 1e2])
        assert all(min(abs(z - other) for other in points) < 1e-5 * (1.0 + abs(z)) for z in near)
        counts.add(len(pins))
    assert counts == {0, 2, 4}


# -- defects ----------------------------------------------------------------------------------------------------


def walked_defects(answer: Answer, poses: tuple[BodyPose, ...]) -> set[str]:
    """Defects of a linkage by a walk of its driver in both directions from the first pose, the assembly followed by continuity."""
    linkage = answer.candidate.linkage
    frame, body = linkage.by_number[1].places, linkage.by_number[3].places
    kind = {"four-bar": PIN, "slider-crank": GUIDE, "inverted-slider-crank": TURNING}[answer.candidate.kind]
    slider = next(iter(linkage.sliders), None)
    through = complex(slider.through_x_mm, slider.through_y_mm) if slider else 0j
    pivots = frame["O2"], body["A"], frame.get("O4", through), body.get("B", through)
    first = poses[0]
    links = Links(kind, pivots, radians(slider.angle_deg) if slider else 0.0, (first.z, radians(first.angle_deg)))
    turns = [cmath.exp(1j * radians(pose.angle_deg)) for pose in poses]
    targets = [cmath.phase(pose.z + pivots[1] * turn - pivots[0]) for pose, turn in zip(poses, turns, strict=True)]
    thetas: dict[int, float] = {0: links.theta}
    for way in (1.0, -1.0):
        ahead = {i: (way * (q - links.start)) % (2.0 * pi) for i, q in enumerate(targets) if i}
        theta, sign = links.theta, 0.0
        for step in range(1, WALK + 1):
            low, high = (2.0 * pi * k / WALK for k in (step - 1, step))
            for i in (i for i, at in ahead.items() if low <= at < high):
                state = links.assembled(links.start + way * ahead[i], theta)
                if state is not None and state[1] * sign >= 0.0:
                    thetas.setdefault(i, state[0])
            state = links.assembled(links.start + way * high, theta)
            if state is None or state[1] * sign < 0.0:
                break
            theta, sign = state
    defects = {"circuit"} if len(thetas) < len(poses) else set()
    errors = [abs(cmath.exp(1j * theta) - turns[i]) for i, theta in thetas.items()]
    return defects | ({"branch"} if max(errors) > 1e-4 else set())


@pytest.mark.parametrize("kind", [PIN, GUIDE, TURNING])
@pytest.mark.parametrize("count", [2, pytest.param(40, marks=pytest.mark.stress)])
def test_defects_are_those_of_a_walk(kind: str, count: int) -> None:
    """Linkages near a dead centre, or with links a hundred times the others, are left out: the steps of the walk do not resolve them."""
    seen: set[str] = set()
    for _, poses in islice(random_links(kind), count):
        rows = body_poses(poses)
        for answer in synthesise(Task(kind="poses", poses=rows)).answers:
            if answer.transmission_deg > 8.0 and answer.size_mm < 5000.0:
                expected = walked_defects(answer, rows)
                assert set(answer.defects) == expected
                seen |= expected or {"none"}
    assert seen >= ({"none", "branch"} if kind == PIN and count == 40 else {"none"})


def test_poses_in_two_ranges_of_the_driver_are_a_circuit_defect() -> None:
    """A double rocker of crank 60, coupler 20, rocker 55, frame 70 mm moves for 30 ... 70 deg and -70 ... -30 deg of the crank."""
    poses = []
    for q in np.radians([40.0, 50.0, 60.0, -40.0, -55.0]):
        pin = 60.0 * cmath.exp(1j * q)
        r = abs(70.0 - pin)
        x = (r * r + 20.0**2 - 55.0**2) / (2.0 * r)
        rod = (70.0 - pin) / r * complex(x, (20.0**2 - x * x) ** 0.5)
        poses.append((pin, cmath.phase(rod)))
    answers = synthesise(Task(kind="poses", poses=body_poses(poses))).answers
    frames = [answer.candidate.linkage.by_number[1].places.values() for answer in answers]
    same = [
        answer
        for answer, frame in zip(answers, frames, strict=True)
        if len(frame) == 2 and all(min(abs(z - pivot) for z in frame) < 1e-6 for pivot in (0.0, 70.0))
    ]
    assert len(same) == 1
    assert "circuit" in same[0].defects
    assert same[0].error_mm < 1e-7
