"""``make bench-check``: our times by those of rivals that stand in this repository, in the same run, against limits.json.

A rival is plain numpy by hand of the same job, or a solver of scipy; of the window a bare repaint of the same widgets. What is
written in limits.json is raised only by a commit of its own that says why; to slow a rival counts as raising a limit.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks import designs, forces, laws, plain, processes
from benchmarks.table import Kernel, kernels
from benchmarks.timing import Fresh, Run, measure
from linkages import chain

from core.design import Design, OptimalCurve, Outline, OutlinePoint, Segment, get, only, put, require_motion, with_drive
from core.design.curves import segment_shape
from core.design.engine import Lobe, LobeRow
from core.design.lobe import lobe_sides
from core.mechanism.drivers import with_drawn_pose
from core.mechanism.unfinished import mobility
from core.motion.tables import lobe_to_segments
from core.output.solids.surface import SurfaceRequest, surface_job
from core.process import keep_freed_memory
from core.project import load
from core.spatial import flank
from core.study import Study, certificate_of, clear_caches, findings_of
from core.synthesis import BodyPose, Task, load_task, synthesise
from core.valves import LIFTS, valve_data, valve_timings
from core.varying import Goal, StudyFile, StudyLimit, VariedField, optimise, study_of

FILE = Path(__file__).with_name("limits.json")
WORSE = 1.3  # times what it takes today: of a row that does not keep its limit yet, too much
TRIES = 6
SECONDS = 0.6  # for one row
ROUNDS = 7  # of the window
STARTS = 9  # of it, and of an empty one

START = "start with the lift, settled, by an empty window"
RANK = "rank of a drawing: twelve links"
FINDINGS = "findings: a new lift"
LOBE = "lobe: a new duration, by a law"
VALVES = "valve: two drives, by their check"
DRAGGED = "chain after a dragged duration, by a dragged join"
TORQUE_LAW = "optimal law of least torque of the lift, by one of least jerk"
OPTIMUM = "optimal law of 60 intervals, by sines of 3,600 angles"
FLANK = "flank of a barrel, 3,600 × 20 points with angle and curvature, by the profile of the lift"
SURFACES = {
    "STEP of a globoidal indexer at 2 µm, by the profile of the lift": ("globoidal_indexer.toml", False),
    "STEP of a groove cam, solid, at 2 µm, by the profile of the lift": ("groove.toml", True),
    "STEP of a barrel cam, solid, at 2 µm, by the profile of the lift": ("barrel_feeder.toml", True),
}
POSES = "linkages for five poses, by a fresh study of the four-bar"
PATH = "linkages for a path, by a fresh study of the four-bar"
CLEARANCES = "least clearances of 20 pairs of 8 sides, proven, by a fresh study of the four-bar"
TOP = "top speed of the lift with four variables, by the same study with a quantity as its goal"
DURATIONS = count(1)  # solved lobes and laws are remembered
DURATION = "motion.lobe.duration[1].crank_deg"
JOIN = ("motion.segments[0].span_deg", "motion.segments[1].span_deg")  # of a dwell and the run-up
EXAMPLES = Path(__file__).parents[2] / "resources" / "examples"
EXAMPLE = EXAMPLES / "transfer_lift.toml"
VALVE_TRAIN = EXAMPLES / "valve_train.toml"

Limits = Mapping[str, Mapping[str, Any]]
"""Row -> its limit; of one that does not keep it yet also what it takes today, and why."""


def keys() -> dict[str, Callable[[], float]]:
    """What is checked, and how it is looked at: every kernel, many designs at once, and the window."""
    made = {kernel.name: partial(look, kernel) for kernel in kernels()}
    return {
        **made,
        **{f"many: {row.name}": partial(look_at_many, row) for row in designs.ROWS},
        **{f"many, by one force: {row.name}": partial(look_at_totals, row) for row in designs.TOTALS},
        **{
            f"chain after a new {what}, {angles} angles": partial(look_at_edit, path, angles)
            for what, path in forces.EDITS.items()
            for angles in (36, 3600)
        },
        RANK: look_at_rank,
        FINDINGS: look_at_findings,
        LOBE: look_at_lobe,
        VALVES: look_at_valves,
        DRAGGED: look_at_dragged_duration,
        OPTIMUM: look_at_optimum,
        TORQUE_LAW: look_at_torque_law,
        TOP: look_at_top_speed,
        FLANK: look_at_flank,
        **{row: partial(look_at_surface, *file) for row, file in SURFACES.items()},
        POSES: partial(look_at_task, five_poses),
        PATH: partial(look_at_task, hoeken_path),
        CLEARANCES: look_at_clearances,
        **{f"{name}, by import numpy": partial(processes.document, name, 4) for name in processes.DOCUMENTS},
        START: partial(processes.start, STARTS),
        **{
            f"optimise: {name}, by import numpy": partial(processes.by_numpy, command, 4)
            for name, command in processes.OPTIMA.items()
        },
        **windows(),
    }


def windows() -> dict[str, Callable[[], float]]:
    """Edits, drags and frames with twelve plots by a bare repaint; one measurement serves each of them once."""
    from benchmarks import window

    known: dict[str, float] = {}

    def told(name: str) -> float:
        if name not in known:
            rows = window.measure(ROUNDS, (window.MANY,), more=False)
            bare = {row.kernel: row.seconds for row in rows if row.method == window.BARE}
            known.update({f"{r.kernel}: {r.method}": r.seconds / bare[r.kernel] for r in rows})
        return known.pop(name)

    return {name: partial(told, name) for name in window.names()}


def look(kernel: Kernel, seconds: float = SECONDS) -> float:
    """Time of our method by that of the kernel's rival."""
    there, setting = kernel.given(kernel.grid(kernel.usual)), kernel.ours.settings[0]
    name, of_rival = kernel.rival
    rival = next(method for method in kernel.methods if method.name == name)
    ours = Fresh(lambda: partial(kernel.ours.cold, kernel.again(there), setting))
    theirs = Fresh(lambda: partial(rival.cold, kernel.again(there), of_rival))
    told = measure({"ours": ours, "rival": theirs}, seconds).seconds
    return told["ours"] / told["rival"]


def look_at_rank(seconds: float = SECONDS) -> float:
    """What a drawing of twelve links lacks to be a mechanism, by one solution of it at 3,600 angles; of other lengths each time."""
    design = chain(12)
    drawn, lengths = with_drawn_pose(design, Study(design, 1).linkage), count(1)

    def another() -> Design:
        return put(drawn, "linkage.links[2].points.B1.x_mm", 102.0 + 1e-6 * next(lengths))

    ours = Fresh(lambda: partial(mobility, another().drive.linkage))
    theirs = Fresh(lambda: partial(getattr, Study(another(), 3600), "linkage"))
    told = measure({"ours": ours, "rival": theirs}, seconds).seconds
    return told["ours"] / told["rival"]


def look_at_findings(seconds: float = 2.0 * SECONDS) -> float:
    """All findings of the lift with a flywheel, with other lengths and another motion each time, by its forces by hand."""
    design, theta = load(EXAMPLE), plain.turn(3600)
    ours = Fresh(lambda: partial(findings_of, Study(forces.anew(design))))
    told = measure({"ours": ours, "rival": partial(forces.at_knots, theta)}, seconds).seconds
    return told["ours"] / told["rival"]


def look_at_lobe(seconds: float = SECONDS) -> float:
    """Both sides of a lobe on the default ramp, of another duration each time, by a law at 3,600 angles."""

    def another() -> Lobe:
        return Lobe(lift_mm=7.75, duration=(LobeRow(0.1524, 268.0), LobeRow(1.27, 218.0 + 1e-6 * next(DURATIONS))))

    ours = Fresh(lambda: partial(lobe_sides, another()))
    told = measure({"ours": ours, "rival": partial(laws.ours, laws.KERNEL.grid(3600), None)}, seconds).seconds
    return told["ours"] / told["rival"]


def look_at_valves(seconds: float = 2.0 * SECONDS) -> float:
    """Figures of both valves of a train, of other durations each time, by its findings and certificate."""
    train = load(VALVE_TRAIN)

    def another() -> Design:
        longer = 1e-6 * next(DURATIONS)
        return put(put(train, f"drives[0].{DURATION}", 210.0 + longer), f"drives[1].{DURATION}", 206.0 + longer)

    def check(design: Design) -> None:
        study = Study(design)
        findings_of(study)
        certificate_of(study)

    ours = Fresh(lambda: partial(lambda design: valve_data(valve_timings(design), LIFTS), another()))
    told = measure({"ours": ours, "rival": Fresh(lambda: partial(check, another()))}, seconds).seconds
    return told["ours"] / told["rival"]


def look_at_dragged_duration(seconds: float = SECONDS) -> float:
    """Forces and cam of a valve train after another duration of its lobe, by those after another join of the same segments."""
    train = only(load(VALVE_TRAIN), 0)
    segments = lobe_to_segments(train)
    first, second = (get(segments, path) for path in JOIN)

    def dragged(longer: float) -> Design:
        return put(put(segments, JOIN[0], first + longer), JOIN[1], second - longer)

    def chain(design: Design) -> None:
        study = Study(design)
        _ = study.dynamics.contact, study.dynamics.torque, study.cam.flank.profile

    ours = Fresh(lambda: partial(chain, put(train, DURATION, 210.0 + 1e-6 * next(DURATIONS))))
    theirs = Fresh(lambda: partial(chain, dragged(1e-6 * next(DURATIONS))))
    told = measure({"ours": ours, "rival": theirs}, seconds).seconds
    return told["ours"] / told["rival"]


def look_at_top_speed(seconds: float = 10.0 * SECONDS) -> float:
    """The fastest lift whose contact force stays within 0 and 60 kN, and the one of least torque within them; of another mass each time."""
    speed, masses = "shaft.speed_rpm", count(1)
    ranges = {
        speed: (10.0, 200.0),
        **{f"motion.segments[{i}].span_deg": (30.0, 80.0) for i in (1, 3)},
        "cam.base_radius_mm": (380.0, 480.0),
    }
    limits = (
        StudyLimit("contact_force_n", "abs", max=60e3),
        StudyLimit("contact_force_n", "min", min=0.0),
        StudyLimit("pressure_angle_deg", "max", max=45.0),
    )

    def search(goal: Goal) -> Fresh:
        file = StudyFile(
            design="",
            vary=tuple(VariedField(path, *ends) for path, ends in ranges.items()),
            limits=limits,
            goals=(goal,),
        )

        def make() -> Run:
            study = study_of(file, put(load(EXAMPLE), "loads.slider_mass_kg", 200.0 + 1e-6 * next(masses)))
            return lambda: optimise(study)

        return Fresh(make)

    told = measure(
        {"ours": search(Goal(field=speed, minimise=False)), "rival": search(Goal("drive_torque_nm", "abs"))}, seconds
    ).seconds
    return told["ours"] / told["rival"]


def look_at_optimum(seconds: float = SECONDS) -> float:
    """The law of least jerk with 60 intervals, with other cycles of a follower at rest each time, by numpy's sines of 3,600 angles."""
    angles = np.deg2rad(np.arange(3600) / 10.0)

    def another() -> Segment:
        return Segment(90.0, 1.0, OptimalCurve(minimise="jerk", vibration_free=(3.3 + 1e-6 * next(DURATIONS),)))

    ours = Fresh(lambda: partial(segment_shape, another(), False, "segment"))
    told = measure({"ours": ours, "rival": partial(np.sin, angles)}, seconds).seconds
    return told["ours"] / told["rival"]


def look_at_torque_law(seconds: float = 2.0 * SECONDS) -> float:
    """The law of least torque of the lift at another speed each time, by the law of least jerk with other cycles each time."""
    lift = put(load(EXAMPLE), "motion.segments[1].law", "optimal")
    lift = put(lift, "motion.segments[1].minimise", "torque")

    def torque() -> Segment:
        design = put(lift, "shaft.speed_rpm", 20.0 + 1e-6 * next(DURATIONS))
        return require_motion(design).segments[1]

    def jerk() -> Segment:
        return Segment(90.0, 1.0, OptimalCurve(minimise="jerk", vibration_free=(3.3 + 1e-6 * next(DURATIONS),)))

    ours, rival = (Fresh(lambda law=law: partial(segment_shape, law(), False, "segment")) for law in (torque, jerk))
    told = measure({"ours": ours, "rival": rival}, seconds).seconds
    return told["ours"] / told["rival"]


def look_at_flank(seconds: float = SECONDS) -> float:
    """Points of a flank of the barrel with pressure angle and curvature, by profile and pressure angle of the lift at 3,600 angles."""
    shape = Study(load(EXAMPLES / "barrel_feeder.toml"), 3600).surface
    side, motion = shape.tracks[0]
    along = np.linspace(shape.machine.inner, shape.machine.outer, 20)[:, None]

    def ours() -> object:
        surface = flank(shape.machine, motion, along, shape.sense, side)
        return surface.cam_point, surface.pressure_angle, surface.curvature

    return by_profile(ours, seconds)


def by_profile(ours: Callable[[], object], seconds: float) -> float:
    """A time by that of profile and pressure angle of the lift at 3,600 angles."""
    kernel = next(kernel for kernel in kernels() if kernel.name == "profile")
    there = kernel.given(kernel.grid(3600))
    rival = Fresh(lambda: partial(kernel.ours.cold, kernel.again(there), None))
    told = measure({"ours": ours, "rival": rival}, seconds).seconds
    return told["ours"] / told["rival"]


def look_at_surface(name: str, is_solid: bool, seconds: float = 4.0 * SECONDS) -> float:
    """The STEP file of a design at the tolerance of 2 µm; nothing of an earlier file is remembered."""
    design = load(EXAMPLES / name)
    if is_solid and design.drive.has_disk:
        form = replace(design.drive.cam.form, outer_radius_mm=160.0, groove_depth_mm=18.0)
        design = with_drive(design, cam=replace(design.drive.cam, form=form))

    def ours() -> object:
        clear_caches()
        return surface_job(Study(design), Path("cam.step"), SurfaceRequest(solid=is_solid)).content

    return by_profile(ours, seconds)


def five_poses() -> Task:
    """Five poses on the coupler of the four-bar, a little different each time."""
    more = 1e-9 * next(DURATIONS)
    angles = np.radians([10.0, 30.0, 55.0, 80.0, 120.0])
    body = Study(load(EXAMPLES / "four_bar.toml")).at_theta(angles).linkage.bodies["link3"]
    z, turn = 1e3 * body.fixed_point(0j)[0], np.degrees(body.angle[0])
    return Task(kind="poses", poses=tuple(BodyPose(p.real + more, p.imag, t) for p, t in zip(z, turn, strict=True)))


def hoeken_path() -> Task:
    """The path of the ready task of Hoeken's line."""
    return load_task(EXAMPLES.parent / "tasks" / "hoeken_line.toml")


def look_at_task(task: Callable[[], Task], seconds: float = 2.0 * SECONDS) -> float:
    """Judged answers of a task, by all positions, velocities and forces of the four-bar at 3,600 angles with another length."""
    synthesise(hoeken_path())  # the list of curves is calculated once
    told = measure({"ours": Fresh(lambda: partial(synthesise, task())), "rival": Fresh(studied_bar)}, seconds).seconds
    return told["ours"] / told["rival"]


def another_bar() -> Design:
    """The four-bar with a length of its own."""
    return put(load(EXAMPLES / "four_bar.toml"), "linkage.links[2].points.B.x_mm", 90.0 + 1e-6 * next(DURATIONS))


def studied_bar() -> Callable[[], None]:
    """All positions, velocities and forces of the four-bar at 3,600 angles with another length."""
    design = another_bar()

    def study() -> None:
        fresh = Study(design, 3600)
        for body in fresh.linkage.bodies.values():
            _ = [(body.x[order], body.y[order], body.angle[order]) for order in range(3)]
        _ = fresh.dynamics.torque

    return study


OCTAGONS = (
    ("link 2", 30.0, 0.0),
    ("link 3", 45.0, 40.0),
    ("link 4", 70.0, 0.0),
    ("frame", 20.0, 110.0),
    ("frame", -40.0, 60.0),
)
"""Body, centre x and y [mm] of octagons on the four-bar: a pin, the coupler, the rocker, and two posts."""


def look_at_clearances(seconds: float = 2.0 * SECONDS) -> float:
    """Least clearances of the six pairs of four bodies with octagons, as 20 of them, by a study of the four-bar."""
    corners = [(8.0 * np.cos(turn), 8.0 * np.sin(turn)) for turn in np.arange(8) * np.pi / 4.0]

    def outlined() -> Callable[[], None]:
        outlines = [
            Outline(of=of, points=tuple(OutlinePoint(float(x + dx), float(y + dy)) for dx, dy in corners))
            for of, x, y in OCTAGONS
        ]
        design = replace(another_bar(), outlines=tuple(outlines))

        def compute() -> None:
            clearances = Study(design).clearances
            assert len([clearances.least(pair) for pair in clearances.pairs]) == 6

        return compute

    told = measure({"ours": Fresh(outlined), "rival": Fresh(studied_bar)}, seconds).seconds
    return 20.0 / 6.0 * told["ours"] / told["rival"]


def look_at_edit(path: str, angles: int, seconds: float = SECONDS) -> float:
    """Time of the chain after one number of the lift has been changed, by that of the lift by hand at 3,600 angles.

    Both run once in their turn: five times in a row the rival would find its arrays and code in the processor's cache.
    """
    ours, theirs = Fresh(lambda: forces.after_edit(path, angles)), Fresh(lambda: forces.lift_by_hand)
    told = measure({"ours": ours, "rival": theirs}, seconds).seconds
    return told["ours"] / told["rival"]


def look_at_many(row: designs.Designs, seconds: float = 2.0 * SECONDS) -> float:
    told = measure({"ours": row.ours, "rival": row.by_hand}, seconds).seconds
    return told["ours"] / told["rival"]


def look_at_totals(row: designs.Totals, seconds: float = 4.0 * SECONDS) -> float:
    told = measure({"ours": row.ours, "force": row.by_force}, seconds).seconds
    return told["ours"] / told["force"]


def allowed(limit: Mapping[str, Any]) -> float:
    """The limit, or where it is not kept yet, not much more than today."""
    return max(limit.get("limit", 0.0), WORSE * limit.get("today", 0.0))


def failing(limits: Limits, told: Callable[[str], float], names: Sequence[str], tries: int = TRIES) -> dict[str, float]:
    """The best of several looks at each name that stays beyond what is allowed. Who is beyond is looked at again, so that a
    machine that was busy for a while fails nobody."""
    best: dict[str, float] = {}
    left = list(names)
    for _ in range(tries):
        for name in left:
            best[name] = min(best.get(name, float("inf")), told(name))
        left = [name for name in left if best[name] > allowed(limits.get(name, {}))]
        if not left:
            break
    return {name: best[name] for name in left}


def main(argv: Sequence[str] | None = None) -> int:
    words = argparse.ArgumentParser(prog="make bench-check", description="Fails where a kernel has become slower.")
    words.add_argument("--only", nargs="+", metavar="NAME", help="look at these alone, as this process finds them")
    asked = words.parse_args(argv)
    keep_freed_memory()
    every, limits = keys(), json.loads(FILE.read_text(encoding="utf-8"))

    def told(name: str) -> float:
        value, limit = every[name](), limits.get(name, {})
        what = (
            f"not yet {limit['limit']:g}: {limit['why']}" if "today" in limit else f"limit {limit.get('limit', 0.0):g}"
        )
        print(f"{name}: {value:.2f} times its rival, {what}", flush=True)
        return value

    slow = failing(limits, told, asked.only or list(every))
    if slow and not asked.only:  # where memory lies may slow a whole process: another one shall say the same
        again = [sys.executable, str(FILE.with_name("run.py")), "--check", "--only", *slow]
        return subprocess.run(again, check=False).returncode
    for name, value in slow.items():
        print(f"SLOWER: {name}: {value:.2f} times its rival, allowed are {allowed(limits.get(name, {})):.2f}")
    stale = sorted(set(limits) - set(every))
    for name in stale:
        print(f"limits.json: {name} is no longer measured")
    return 1 if slow or stale else 0
