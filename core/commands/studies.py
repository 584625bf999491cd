"""Commands about studies of designs: optimise, tolerance and vary."""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from core.commands import DONE, NOTHING_DONE, Painter
from core.commands.common import (
    Progress,
    as_json,
    ending_with,
    out_folder,
    print_errors,
    rounding_data,
    rounding_lines,
    rounding_step,
    studied,
)
from core.design import drive_names
from core.design.fields import flag, whole
from core.errors import KindynaError
from core.findings import ERROR
from core.frozen import frozen
from core.motion import degrees
from core.number_text import count_text, result_text
from core.output.export import csv
from core.output.summary import to_json
from core.project import loads, parsed, save
from core.project.files import read_text, write_into
from core.requests import option, text_option
from core.study import findings_of
from core.varying import (
    Optimum,
    Run,
    Scatter,
    Share,
    StudyOfMany,
    duration,
    load_study,
    none_built_text,
    optimise,
    remarks,
    rounded_optimum,
    tolerance_study,
    workers,
    write_table,
)
from core.varying.descent import ProgressCallback
from core.varying.space import PARQUET, headings
from core.varying.tolerances import MACHINES, PERCENTILES, SHARE
from core.varying.waves import AllWaves

# -- the command ``optimise`` -----------------------------------------------------------------------------------


@frozen(kw_only=True)
class OptimiseArguments:
    """Arguments of ``optimise``: a study, and a file for the best design."""

    study: Path = text_option("study file (.toml) with [[goals]]", "STUDY", type=Path)
    into: Path | None = text_option("write the best design", default=None, type=Path, metavar="FILE")
    round: float | None = rounding_step()
    json: bool = as_json()


def run_optimise(arguments: OptimiseArguments, painter: Painter | None) -> int:
    """Print the best design, or the one that violates the limits least."""
    if arguments.into is not None and arguments.into.resolve() == arguments.study.resolve():
        raise KindynaError(f"--into {arguments.into}: is the study that is read; choose another file")
    study_file = load_study(arguments.study)
    progress = Progress()
    optimum, notes = best_design(
        study_file, arguments, lambda fields, goal, start: progress.report(f"start {start}: {result_text(goal)} ...")
    )
    print(
        to_json(optimum_data(optimum, notes)) if arguments.json else _optimum_text(optimum, notes, arguments.round),
        end="",
    )
    if not optimum.is_feasible:
        against = f": {optimum.rejection}" if optimum.rejection else ""
        print(
            f"optimise: no design satisfies the limits; the one above violates them least{against}",
            file=sys.stderr,
        )
        return NOTHING_DONE
    if arguments.into is not None:
        save(optimum.design, arguments.into)
    study = studied(optimum.design)
    return print_errors(study, (finding for finding in findings_of(study) if finding.severity == ERROR))


def best_design(
    study: StudyOfMany, arguments: OptimiseArguments, progress: ProgressCallback | None = None
) -> tuple[Optimum, Sequence[str]]:
    """Best design of a study, rounded where requested, and remarks on it; of an infeasible one the limits that it violates."""
    optimum = optimise(study, progress)
    if arguments.round is not None:
        optimum = rounded_optimum(study, optimum, arguments.round)
    return optimum, remarks(study, optimum)


def optimum_data(optimum: Optimum, notes: Sequence[str]) -> dict[str, Any]:
    """Data of a best design for JSON."""
    return {
        "answer": dict(optimum.answer),
        "goal": next(iter(optimum.goals.values())) if len(optimum.goals) == 1 else dict(optimum.goals),
        "before": next(iter(optimum.before.values())) if len(optimum.before) == 1 else dict(optimum.before),
        "kept": optimum.is_feasible,
        "better": optimum.is_better,
        "binding": [{"limit": bound.limit, "per_percent": bound.per_percent} for bound in optimum.binding],
        "starts": optimum.starts,
        "agreeing": optimum.agreeing,
        "front": [dict(point) for point in optimum.front],
        "share": None if optimum.share is None else {"share": optimum.share.value, "low": optimum.share.interval[0]},
        "taken": dict(optimum.also_set),
        "against": optimum.rejection,
        "remarks": [*notes, *([optimum.note] if optimum.note else [])],
        **rounding_data(optimum.exact, optimum.rounding, optimum.cost),
    }


def _optimum_text(optimum: Optimum, notes: Sequence[str], step: float | None) -> str:
    heading = "the best design:" if optimum.is_better else "no better design; the current one:"
    lines = [heading if optimum.is_feasible else "the design that violates the limits least:"]
    lines += [
        f"  {path} = {value if isinstance(value, str) else f'{value:.9g}'}" for path, value in optimum.answer.items()
    ]
    lines += rounding_lines(optimum.answer, optimum.exact, optimum.rounding, optimum.cost, step)
    lines += [optimum.note] if optimum.note else []
    lines.extend(
        f"{key} = {result_text(value)}, before {result_text(optimum.before[key])}"
        for key, value in optimum.goals.items()
    )
    lines += [
        f"at its limit {bound.limit}: 1 % more of it changes the goal by {result_text(bound.per_percent)}"
        for bound in optimum.binding
    ]
    if optimum.is_better:
        lines.append(f"{optimum.agreeing} of {optimum.starts} starts lead there")
    lines += [f"set in the design: {path} = {value:.9g}" for path, value in optimum.also_set.items()]
    if optimum.front:
        points = "point: --json lists it" if len(optimum.front) == 1 else "points: --json lists them"
        lines.append(f"front of {len(optimum.front)} {points}")
    if optimum.share is not None:
        lines.append(
            f"{optimum.share.value:.2%} of random machines keep the limits, {optimum.share.interval[0]:.2%} at least with 95 %"
        )
    if optimum.rejection:
        lines.append(f"a better one was refused: {optimum.rejection}")
    lines += notes
    return "\n".join(lines) + "\n"


# -- the command ``tolerance`` ----------------------------------------------------------------------------------


SENSITIVITY, BANDS, SUMMARY = "sensitivity.csv", "bands.csv", "summary.json"


@frozen(kw_only=True)
class ToleranceArguments:
    """Arguments of ``tolerance``: a design or study, a folder, and the number of random machines."""

    file: Path = text_option("design file with [[tolerances]], or study file of one (.toml)", "DESIGN|STUDY", type=Path)
    out: Path = out_folder("folder for the three files", default=Path())
    machines: int = whole("Machines", 2, 1_000_000, default=MACHINES, help="number of random machines")
    seed: int | None = option(
        whole("Seed", 0, 2**32 - 1, default=None),
        help="of the random numbers",
        default_text="that of the study, else 0",
    )


def run_tolerance(arguments: ToleranceArguments, painter: Painter | None) -> int:
    """Write the three files, and print the share of machines within the limits."""
    study = _study(arguments.file)
    scatter = Scatter(study)
    seed = study.file.seed if arguments.seed is None else arguments.seed
    slopes, bands = scatter.slopes(), scatter.bands(arguments.machines, seed)
    values = scatter.values(arguments.machines, seed)
    if np.isnan(values).all():
        raise KindynaError(
            f"tolerances: none of {arguments.machines} machines can be built; check the design with the command check"
        )
    share = Share(int(scatter.within_limits(values).sum()), arguments.machines)
    tighter = scatter.tightened(arguments.machines, seed, slopes) if share.value < SHARE else None
    low, high = share.interval
    data: dict[str, Any] = {
        "machines": share.machines, "seed": seed, "within": share.within, "share": share.value, "low": low, "high": high,
        "limits": [
            {
                "quantity": limit.quantity, "of": limit.of, "bound": bound,
                "share": float((side * values[scatter.keys.index(limit.key)] <= side * bound).mean()),
            }
            for limit, side, bound in scatter.bounds()
        ],
        "worst": [
            {"quantity": worst.limit.quantity, "of": worst.limit.of, "linear": worst.linear, "value": worst.value,
             "within": worst.within, "at": dict(worst.at)}
            for worst in scatter.corners(slopes)
        ],
        "tighten": None if tighter is None else {
            "halve": dict(tighter.halved), "cost": tighter.cost, "share": tighter.share.value, "low": tighter.share.interval[0],
        },
        "waviness": _summary(scatter.waves),
    }  # fmt: skip
    files = {SENSITIVITY: _sensitivity(scatter, slopes), SUMMARY: to_json(data)}
    if bands:
        names = [f"{slug}_{level}" for slug in bands for level in PERCENTILES]
        files[BANDS] = csv(["cam_angle_deg", *names], [degrees(360), *(row for rows in bands.values() for row in rows)])
    write_into(arguments.out, files)
    print(_tolerance_text(data, share))
    return DONE


def _study(path: Path) -> StudyOfMany:
    """The study of a study file, or the tolerance study of a design."""
    text = read_text(path)
    return tolerance_study(loads(text, str(path))) if "format" in parsed(text, str(path)) else load_study(path)


def _sensitivity(scatter: Scatter, slopes: np.ndarray) -> str:
    """CSV of field, quantity, change of the quantity per unit of the field and part of its variance, the largest part first."""
    parts, fields = scatter.parts(slopes), list(scatter.nominal)
    lines = ["field,quantity,per_unit,part_of_tolerance"]
    for q, row in enumerate(scatter.study.quantities):
        lines.extend(
            f"{fields[i]},{row.column},{float(slopes[i, q])!r},{float(parts[i, q])!r}"
            for i in sorted(range(len(fields)), key=lambda i: -parts[i, q])
            if np.isfinite(slopes[i, q])
        )
    return "\n".join(lines) + "\n"


def _tolerance_text(data: dict[str, Any], share: Share) -> str:
    low, high = share.interval
    lines = [
        f"{count_text(share.within)} of {count_text(share.machines)} machines keep all limits: "
        f"{share.value:.2%} ({low:.2%} ... {high:.2%} with 95 %)"
    ]
    for worst in data["worst"]:
        value = "cannot be built" if worst["value"] is None else result_text(worst["value"])
        lines.append(
            f"  worst case of {worst['quantity']}: {value}, {'within' if worst['within'] else 'beyond'} its limit"
        )
    for name, waves in _by_drive(data["waviness"]):
        lines += _wave_lines(name, waves)
    if data["tighten"] is not None:
        sets = ", ".join(f"{path} / {2**times}" for path, times in data["tighten"]["halve"].items())
        lines.append(f"  tighten {sets}: {data['tighten']['share']:.2%} (cost {data['tighten']['cost']:g})")
    elif share.value < SHARE:
        lines.append(f"  {SHARE:.2%} of machines within the limits need tolerances smaller than a quarter")
    return "\n".join(lines)


def _summary(waves: AllWaves) -> dict[str, Any] | None:
    """Effect of waviness; on a shaft with several drives by the name of the drive."""
    if waves.design.listed:
        names = drive_names(waves.design)
        return {names[number or 0]: drive.summary() for number, drive in waves.by_drive.items()} or None
    return waves.by_drive[None].summary() if waves.by_drive else None


def _by_drive(waves: dict[str, Any] | None) -> list[tuple[str, dict[str, float]]]:
    """Name of a drive in words, and its waviness; the name of a single drive is empty."""
    if waves is None:
        return []
    return [("", waves)] if "lift_error_mm" in waves else [(f" of {name}", drive) for name, drive in waves.items()]


def _wave_lines(name: str, waves: dict[str, float]) -> list[str]:
    lines = [
        f"  waves{name}: {result_text(waves['lift_error_mm'])} mm at the follower, {result_text(waves['acceleration_mm_s2'])} mm/s²"
    ]
    if "contact_force_n" in waves:
        least = waves.get("least_contact_force_n")
        left = (
            ""
            if least is None
            else "; the follower leaves the cam"
            if least < 0.0
            else f"; {result_text(least)} N remain"
        )
        lines.append(f"    they need {result_text(waves['contact_force_n'])} N of contact force{left}")
    if "amplified" in waves:
        lines.append(
            f"    the elastic follower vibrates {result_text(waves['amplified'])} times as far at "
            f"{waves['amplified_lobes']} lobes (natural "
            f"frequency: {result_text(waves['natural_lobes'])}), {result_text(waves['elastic_contact_force_n'])} N"
        )
    return lines


# -- the command ``vary`` ---------------------------------------------------------------------------------------


MOST_WORKERS = 256


@frozen(kw_only=True)
class VaryArguments:
    """Arguments of ``vary``: a study, its table, and the processes."""

    study: Path = text_option("study file (.toml)", "STUDY", type=Path)
    out: Path = text_option(
        "table with a row for every design", type=ending_with("a table", ".csv", PARQUET), metavar="TABLE.csv|.parquet"
    )
    resume: bool = flag("Resume", help="continue an interrupted run of the same study")
    workers: int = whole("Processes", 1, MOST_WORKERS, default=1, help="number of processes")
    scheduler: str = option(
        text_option("", default=""),
        help="compute on the Dask cluster of this scheduler (extra cluster)",
        metavar="ADDRESS",
    )
    json: bool = as_json()


def run_vary(arguments: VaryArguments, painter: Painter | None) -> int:
    """Write the table; print the number of designs, and why some have no values."""
    study = load_study(arguments.study)
    run = Run(study)
    progress = RunProgress()
    with workers(arguments.workers, arguments.scheduler) as (executor, ahead):
        run.compute(resume=arguments.resume, executor=executor, ahead=ahead, progress=progress.report)
    reasons: Counter[str] = Counter()
    built = 0
    for block in run.blocks():
        built += int((~np.isnan(block.value).any(axis=0)).sum())
        reasons.update(block.reason[block.reason != ""].tolist())
    if not built:
        raise KindynaError(none_built_text(run.count, *reasons.most_common(1)[0]))
    write_table(run, arguments.out)
    if arguments.json:
        data = {
            "designs": run.count,
            "built": built,
            "reasons": dict(reasons.most_common()),
            "columns": headings(run),
        }
        print(to_json(data), end="")
    else:
        print(f"{count_text(run.count)} designs, {count_text(built)} of them with values; {arguments.out}")
        for code, count in reasons.most_common():
            print(f"  {code}: {count_text(count)}")
    return DONE


class RunProgress:
    """Prints the number of designs, designs per second and the remaining time: often on a terminal, seldom in a log."""

    OFTEN, SELDOM = 2.0, 60.0  # seconds between two lines

    def __init__(self) -> None:
        self._start = self._last = time.monotonic()
        self._first: int | None = None

    def report(self, done: int, count: int) -> None:
        """Print the progress of ``Run.compute``."""
        now = time.monotonic()
        self._first = done if self._first is None else self._first
        pause = self.OFTEN if sys.stderr.isatty() else self.SELDOM
        if now - self._last < pause or done == self._first:
            return
        self._last = now
        rate = (done - self._first) / (now - self._start)
        print(
            f"{count_text(done)} of {count_text(count)} designs, {result_text(rate)} a second, {duration((count - done) / rate)} left",
            file=sys.stderr,
        )
