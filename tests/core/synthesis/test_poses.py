"""Linkages that guide a body through poses: found again, counted, judged, and refused."""

import cmath
import json
from itertools import pairwise
from math import degrees, radians
from pathlib import Path

import numpy as np
import pytest

from core.__main__ import main
from core.errors import DesignError
from core.project import load
from core.study import Study
from core.synthesis import AnswerLimits, Area, BodyPose, Dyad, Pivot, Task, synthesise, task_of
from core.synthesis.poses import pose_dyads

PIN, GUIDE, TURNING = "pin", "guide", "turning-guide"
ANGLES = (0.0, 0.2, 0.45, 0.6, 0.9)  # of the driver behind its first angle [rad]


class Machine:
    """A random driver pin with a random second dyad, assembled by its own formulas for a turn of the driver."""

    def __init__(self, seed: int, kind: str) -> None:
        rng = np.random.default_rng(seed)
        draw = lambda size: complex(*rng.normal(size=2)) * size  # noqa: E731
        self.kind, self.g1, self.a1, self.g2, self.a2 = kind, draw(50), draw(40), draw(50), draw(40)
        self.d0, self.theta0, self.line = draw(50), rng.uniform(0.0, 6.0), rng.uniform(-1.5, 1.5)
        if kind == TURNING:  # its line passes through the fixed pivot at the first pose
            self.a2 = (self.g2 - self.d0) / cmath.exp(1j * self.theta0)
        if kind == GUIDE:
            self.g2 = self.d0 + self.a2 * cmath.exp(1j * self.theta0)
        self.crank = abs(self.d0 + self.a1 * cmath.exp(1j * self.theta0) - self.g1)
        self.start = cmath.phase(self.d0 + self.a1 * cmath.exp(1j * self.theta0) - self.g1)
        self.radius = abs(self.d0 + self.a2 * cmath.exp(1j * self.theta0) - self.g2)

    def error(self, d: complex, theta: float) -> float:
        """What is left of the second dyad's condition."""
        turn = cmath.exp(1j * theta)
        if self.kind == PIN:
            return abs(d + self.a2 * turn - self.g2) - self.radius
        along = cmath.exp(1j * self.line)
        if self.kind == GUIDE:
            return ((d + self.a2 * turn - self.g2) / along).imag
        return (((self.g2 - d) / turn - self.a2) / along).imag

    def poses(self) -> list[tuple[complex, float]] | None:
        """Five poses, by Newton's method from one to the next; None where the links do not meet on the way."""
        poses, theta = [], self.theta0
        for before, after in pairwise((0.0, *ANGLES)):
            for q in np.linspace(before, after, 20):
                pin = self.g1 + self.crank * cmath.exp(1j * (self.start + q))
                for _ in range(30):
                    here = self.error(pin - self.a1 * cmath.exp(1j * theta), theta)
                    slope = (self.error(pin - self.a1 * cmath.exp(1j * (theta + 1e-7)), theta + 1e-7) - here) / 1e-7
                    if not slope or abs(here / slope) > 0.3:
                        return None
                    theta -= here / slope
                    if abs(here) < 1e-13:
                        break
            poses.append((pin - self.a1 * cmath.exp(1j * theta), theta))
        return poses


def machines(kind: str, count: int) -> list[tuple[Machine, list[tuple[complex, float]]]]:
    result, seed = [], 0
    while len(result) < count:
        machine = Machine(seed, kind)
        poses = machine.poses()
        if poses is not None:
            result.append((machine, poses))
        seed += 1
    return result


def body_poses(poses: list[tuple[complex, float]]) -> tuple[BodyPose, ...]:
    return tuple(BodyPose(d.real, d.imag, degrees(theta)) for d, theta in poses)


def distance(dyad: Dyad, machine: Machine) -> float:
    """Distance of a dyad from the second one of a machine [mm]; infinite for another kind."""
    if dyad.kind != machine.kind:
        return float("inf")
    if dyad.kind == PIN:
        return abs(dyad.fixed - machine.g2) + abs(dyad.moving - machine.a2)
    turn = abs(np.sin(dyad.line - machine.line)) * 50.0
    if dyad.kind == GUIDE:
        across = abs(((dyad.fixed - machine.g2) * cmath.exp(-1j * machine.line)).imag)
        return float(abs(dyad.moving - machine.a2) + across + turn)
    across = abs(((dyad.moving - machine.a2) * cmath.exp(-1j * machine.line)).imag)
    return float(abs(dyad.fixed - machine.g2) + across + turn)


@pytest.mark.parametrize("kind", [PIN, GUIDE, TURNING])
@pytest.mark.parametrize("count", [15, pytest.param(100, marks=pytest.mark.stress)])
def test_a_linkage_is_found_again_from_five_of_its_poses(kind: str, count: int) -> None:
    for machine, poses in machines(kind, count):
        task = Task(kind="poses", poses=body_poses(poses))
        dyads = pose_dyads(task).all
        assert min(distance(dyad, machine) for dyad in dyads) < 1e-5
        driver = min(abs(d.fixed - machine.g1) + abs(d.moving - machine.a1) for d in dyads if d.kind == PIN)
        assert driver < 1e-5
        synthesis = synthesise(task)
        assert synthesis.complete
        best = min(synthesis.answers, key=lambda answer: answer.error_mm)
        assert best.error_mm < 1e-7
        assert best.error_deg < 1e-8


def resultant_count(poses: tuple[BodyPose, ...]) -> int:
    """Number of real circles through five positions of a body's points, from the elimination of both pivots' equations.

    Differences of |d + aU - g|² to the first pose are linear in g: two of them give g, the other two are polynomials in a.
    """
    from scipy.optimize import fsolve

    d = np.array([complex(p.x_mm, p.y_mm) for p in poses]) / 50.0
    u = np.exp(1j * np.radians([p.angle_deg for p in poses]))
    roots: list[np.ndarray] = []

    def equations(x: np.ndarray) -> np.ndarray:
        a, g = complex(x[0], x[1]), complex(x[2], x[3])
        square = np.abs(d + a * u - g) ** 2
        return square[1:] - square[0]

    rng = np.random.default_rng(0)
    for _ in range(400):
        x, _, flag, _ = fsolve(equations, rng.normal(size=4) * 3.0, full_output=True, xtol=1e-13)
        is_root = flag == 1 and np.abs(equations(x)).max() < 1e-9 and np.abs(x).max() < 1e3
        if is_root and all(np.abs(x - other).max() > 1e-4 for other in roots):
            roots.append(x)
    return len(roots)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_number_of_dyads_is_that_of_a_search_from_many_starts(seed: int) -> None:
    _, poses = machines(PIN, seed + 1)[seed]
    pins = [dyad for dyad in pose_dyads(Task(kind="poses", poses=body_poses(poses))).all if dyad.kind == PIN]
    near = [dyad for dyad in pins if max(abs(dyad.fixed), abs(dyad.moving)) < 1e3]
    assert len(near) == resultant_count(body_poses(poses))


THREE = (BodyPose(0.0, 0.0, 0.0), BodyPose(30.0, 10.0, 20.0), BodyPose(60.0, 15.0, 45.0))


def test_pivots_are_where_they_were_typed(tmp_path: Path) -> None:
    pivots = Pivot(dyad=1, of="fixed", x_mm=0.0, y_mm=-50.0), Pivot(dyad=2, of="fixed", x_mm=60.0, y_mm=-50.0)
    synthesis = synthesise(Task(kind="poses", poses=THREE, pivots=pivots))
    (answer,) = synthesis.answers
    assert synthesis.complete
    assert synthesis.hidden == 0
    frame = answer.candidate.linkage.by_number[1].places
    assert sorted(frame.values(), key=lambda z: z.real) == [-50j, 60 - 50j]


def test_pivots_lie_on_their_lines() -> None:
    line = (0.0, -40.0, 15.0)
    pivots = (Pivot(of="fixed", line=line),)
    synthesis = synthesise(Task(kind="poses", poses=THREE, pivots=pivots))
    along = cmath.exp(1j * radians(line[2]))
    for answer in synthesis.answers[: synthesis.shown]:
        for z in answer.candidate.linkage.by_number[1].places.values():
            assert abs(((z - complex(line[0], line[1])) / along).imag) < 1e-9


@pytest.mark.parametrize("at", [(0.0, -50.0), (400.0, 90.0)])
def test_one_typed_pivot_leaves_as_many_linkages_as_none(at: tuple[float, float]) -> None:
    for poses in (THREE, THREE[:2]):
        synthesis = synthesise(
            Task(kind="poses", poses=poses, pivots=(Pivot(dyad=2, of="fixed", x_mm=at[0], y_mm=at[1]),))
        )
        shown = synthesis.answers[: synthesis.shown]
        assert len(shown) >= 20
        assert max(answer.error_mm for answer in shown) < 1e-9 * 400.0
        for answer in shown:
            assert complex(*at) in answer.candidate.linkage.by_number[1].places.values()


def test_a_body_that_only_shifts_is_moved_by_parallelograms_that_swing_between_their_dead_positions() -> None:
    poses = BodyPose(0.0, 0.0), BodyPose(30.0, 10.0), BodyPose(60.0, 0.0)
    synthesis = synthesise(Task(kind="poses", poses=poses))
    best = synthesis.answers[0]
    assert synthesis.shown >= 20
    assert not best.turns_fully
    assert best.transmission_deg > 45.0
    linkage = best.candidate.linkage
    (o2, o4), (a, b) = (linkage.by_number[1].places.values(), (linkage.by_number[3].places[name] for name in "AB"))
    assert abs((o4 - o2) - (b - a)) < 1e-9 * 60.0


def test_poses_that_no_linkage_passes_in_their_order_have_linkages_with_that_defect() -> None:
    poses = THREE[0], THREE[2], THREE[1], BodyPose(90.0, 5.0, 60.0)
    synthesis = synthesise(Task(kind="poses", poses=poses, limits=AnswerLimits(order=True)))
    assert synthesis.shown == 0
    assert synthesis.answers[0].defects == ("order",)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_fewer_poses_are_swept_and_met_by_the_solved_linkage(count: int, tmp_path: Path) -> None:
    poses = (*THREE, BodyPose(90.0, 5.0, 60.0))[:count]
    synthesis = synthesise(Task(kind="poses", poses=poses))
    assert not synthesis.complete
    assert 12 <= synthesis.shown <= 24
    worst = max(max(answer.error_mm, answer.error_deg) for answer in synthesis.answers[: synthesis.shown])
    assert worst < 1e-9 * 100.0
    angles = [answer.transmission_deg for answer in synthesis.answers[:5]]
    assert angles == sorted(angles, reverse=True)


@pytest.mark.parametrize("direction", [0.0, 20.0, 45.0, 90.0])
@pytest.mark.stress
def test_two_poses_without_a_turn_have_linkages(direction: float) -> None:
    along = 40.0 * cmath.exp(1j * radians(direction))
    poses = BodyPose(0.0, 0.0, 0.0), BodyPose(along.real, along.imag, 0.0)
    synthesis = synthesise(Task(kind="poses", poses=poses))
    assert synthesis.shown >= 12
    assert max(answer.error_mm for answer in synthesis.answers) < 1e-9 * 40.0


def walk_defects(design, poses, steps: int = 100_000) -> set[str]:
    """Defects of a four-bar by a walk of the driver from the first pose, with the assembly followed by continuity."""
    linkage = design.drive.linkage
    frame, rocker = linkage.by_number[1].places, linkage.by_number[4].places
    crank = abs(linkage.by_number[2].places["A"])
    local_a, local_b = (linkage.by_number[3].places[name] for name in "AB")
    coupler, arm = local_b - local_a, abs(rocker["B"])
    o2, o4 = frame["O2"], frame["O4"]

    def body(q: float, sign: float) -> float | None:
        pin = o2 + crank * cmath.exp(1j * q)
        u = (pin - o4).conjugate() * coupler
        v = 0.5 * (arm**2 - abs(pin - o4) ** 2 - abs(coupler) ** 2)
        return None if abs(v) > abs(u) else -cmath.phase(u) + sign * np.arccos(v / abs(u))

    def pin_angle(pose: BodyPose) -> float:
        z = complex(pose.x_mm, pose.y_mm) + local_a * cmath.exp(1j * radians(pose.angle_deg))
        return cmath.phase(z - o2)

    def fits(q: float, sign: float, pose: BodyPose) -> bool:
        angle = body(q, sign)
        return angle is not None and abs(cmath.phase(cmath.exp(1j * (angle - radians(pose.angle_deg))))) < 1e-4

    targets = [pin_angle(pose) for pose in poses]
    sign = next(s for s in (1.0, -1.0) if fits(targets[0], s, poses[0]))
    reached = {0}
    for way in (1.0, -1.0):
        ahead = 2.0 * np.pi * np.arange(1, steps + 1) / steps
        pins = o2 + crank * np.exp(1j * (targets[0] + way * ahead))
        across = np.abs(pins - o4)
        meets = np.abs(arm**2 - across**2 - abs(coupler) ** 2) <= 2.0 * across * abs(coupler)
        steps_on = steps if meets.all() else int(np.argmin(meets))
        reached |= {
            i
            for i, q in enumerate(targets)
            if (way * (q - targets[0])) % (2.0 * np.pi) <= 2.0 * np.pi * steps_on / steps
        }
    defects = set()
    if len(reached) < len(poses):
        defects.add("circuit")
    if any(
        not fits(target, sign, pose)
        for i, (target, pose) in enumerate(zip(targets, poses, strict=True))
        if i in reached
    ):
        defects.add("branch")
    return defects


def test_defects_are_those_of_a_walk() -> None:
    seen: set[str] = set()
    for _, poses in machines(PIN, 20):
        rows = body_poses(poses)
        for answer in synthesise(Task(kind="poses", poses=rows)).answers:
            if (
                answer.candidate.kind == "four-bar" and answer.transmission_deg > 1.0
            ):  # a walk cannot resolve poses at a dead centre
                expected = walk_defects(answer.candidate.design, rows)
                assert set(answer.defects) == expected
                seen |= expected or {"none"}
    assert seen == {"none", "branch"}


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


def test_a_written_answer_runs_through_the_poses(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    task, out = tmp_path / "task.toml", tmp_path / "out"
    lines = [f"[[poses]]\nx_mm = {p.x_mm}\ny_mm = {p.y_mm}\nangle_deg = {p.angle_deg}" for p in THREE]
    task.write_text('kind = "poses"\n' + "\n".join(lines), "utf-8")
    assert main(["synthesise", str(task), "--out", str(out), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert {"answers", "dyads", "hidden", "complete"} == set(data)
    first = data["answers"][0]
    assert first["rank"] == 1
    assert first["design"] == "rank1.toml"
    assert first["error_mm"] < 1e-9
    header, row, *_ = (out / "answers.csv").read_text("utf-8").splitlines()
    assert (
        header == "rank,kind,design,error_mm,error_deg,defects,transmission_deg,grashof,length_ratio,size_mm,cognates"
    )
    assert row.startswith("1,")
    design = load(out / "rank1.toml")
    assert main(["check", str(out / "rank1.toml")]) == 0
    linkage = design.drive.linkage
    pose = THREE[1]
    a = linkage.by_number[3].places["A"]
    q = cmath.phase(
        complex(pose.x_mm, pose.y_mm) + a * cmath.exp(1j * radians(pose.angle_deg)) - linkage.by_number[1].places["O2"]
    )
    study = Study(design)
    crank = study.linkage.bodies["link2"].angle[0]
    nearest = int(np.abs(np.exp(1j * crank) - cmath.exp(1j * q)).argmin())
    body = study.linkage.bodies["link3"]
    assert abs(1e3 * body.fixed_point(0j)[0][nearest] - complex(pose.x_mm, pose.y_mm)) < 2.0


EQUAL = [{"x_mm": 1.0, "y_mm": 2.0, "angle_deg": 3.0}] * 2
ROWS = [{"x_mm": p.x_mm, "y_mm": p.y_mm, "angle_deg": p.angle_deg} for p in THREE]


@pytest.mark.parametrize(
    ("table", "field"),
    [
        ({"poses": EQUAL}, r"poses\[1\]: is equal to poses\[0\]"),
        ({"poses": ROWS[:1]}, "poses: 1 pose; allowed: 2 ... 5"),
        ({"poses": [dict(row, x_mm=k * 9.0) for k, row in enumerate(ROWS * 2)]}, "poses: 6 poses; allowed: 2 ... 5"),
        (
            {"poses": [{"x_mm": x, "y_mm": 2.0 * x} for x in (0.0, 10.0, 30.0)]},
            "poses: are all on one line without a turn",
        ),
        (
            {
                "poses": [{"x_mm": 5.0 - y, "y_mm": y, "angle_deg": a} for y, a in ((0.0, 0.0), (5.0, 90.0))]
                + [{"x_mm": 0.0, "y_mm": -5.0, "angle_deg": -90.0}]
            },
            r"poses: are turns about one point, where a single pivot guides the body: \(0, 0\) mm; allowed: a shift of one pose",
        ),
        (
            {"poses": ROWS, "pivots": [{"of": "fixed", "x_mm": 0.0, "y_mm": 0.0}] * 2},
            r"pivots\[1\]: the fixed pivot of dyad 1",
        ),
        (
            {
                "poses": ROWS,
                "pivots": [{"of": "fixed", "x_mm": 0.0, "y_mm": 0.0}, {"of": "moving", "line": [0.0, 0.0, 9.0]}],
            },
            r"pivots\[1\]: the pivots of dyad 1 set 3 conditions, 3 poses leave 2",
        ),
        ({"poses": ROWS, "pivots": [{"of": "fixed", "line": [0.0, 1.0]}]}, r"pivots\[0\].line"),
        (
            {"poses": ROWS, "path": {"points": [[0.0, 0.0], [1.0, 2.0], [3.0, 1.0]]}},
            "path: is not used by a task of kind poses",
        ),
        ({"poses": ROWS, "area": {"low": [5.0, 0.0], "high": [1.0, 9.0]}}, "area.high"),
        (
            {"poses": ROWS, "pivots": [{"of": "fixed", "x_mm": 0.0, "y_mm": 0.0}]},
            r"pivots\[0\].dyad: missing, two dyads have no pivot at one position; allowed: 1 | 2",
        ),
        (
            {
                "poses": ROWS,
                "pivots": [{"dyad": 2, "of": "fixed", "x_mm": 0.0, "y_mm": 70.0}],
                "area": {"low": [-90.0, -90.0], "high": [90.0, 60.0]},
            },
            r"pivots\[0\].y_mm = 70.0: is outside of the area; allowed: -90 ... 60 mm",
        ),
    ],
)
def test_bad_tasks_are_refused_with_their_field(table: dict[str, object], field: str) -> None:
    with pytest.raises(DesignError, match=field) as refused:
        synthesise(task_of({"kind": "poses", **table}))
    assert len(str(refused.value).splitlines()) == 1


def test_poses_without_dyads_name_the_change_that_gives_some(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rng = np.random.default_rng(3)
    for _ in range(200):
        poses = tuple(BodyPose(*map(float, rng.normal(size=2) * 50.0), float(rng.uniform(0, 360))) for _ in range(5))
        if not pose_dyads(Task(kind="poses", poses=poses)).all:
            break
    task = tmp_path / "task.toml"
    lines = [f"[[poses]]\nx_mm = {p.x_mm}\ny_mm = {p.y_mm}\nangle_deg = {p.angle_deg}" for p in poses]
    task.write_text('kind = "poses"\n' + "\n".join(lines), "utf-8")
    assert main(["synthesise", str(task)]) == 2
    message = capsys.readouterr().err
    assert "poses: have no two dyads; allowed: poses[" in message
    assert len(message.splitlines()) == 1


def test_the_curve_of_dyads_through_four_poses_is_swept_in_both_directions() -> None:
    """Exchanging x and y of all poses and turning the other way round mirrors the dyads; a sweep along x alone would not."""
    poses = ((0.0, 0.0, 0.0), (60.0, 20.0, 30.0), (110.0, 10.0, 60.0), (140.0, -20.0, 80.0))
    area = Area(-300.0, -300.0, 300.0, 300.0)
    there = Task(kind="poses", poses=tuple(BodyPose(*pose) for pose in poses), area=area)
    mirrored = Task(kind="poses", poses=tuple(BodyPose(y, x, 90.0 - a) for x, y, a in poses), area=area)
    fixed, swapped = (sorted((d.fixed for d in pose_dyads(task).all), key=abs) for task in (there, mirrored))
    assert len(fixed) == len(swapped) > 60
    for z in fixed:
        assert min(abs(complex(z.imag, z.real) - other) for other in swapped) < 1e-5
