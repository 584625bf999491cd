"""The command ``optimise``: the best design of a study within its limits."""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from core.commands import DONE, DONE_WITH_ERRORS, NOTHING_DONE, Painter
from core.commands.common import as_json, ending_with, out_folder, studied
from core.design import drive_names
from core.design.fields import flag, whole
from core.errors import KindynaError
from core.findings import ERROR
from core.frozen import frozen
from core.motion import degrees
from core.output.export import csv
from core.output.lines import finding_line
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
    tolerance_study,
    workers,
    write_table,
)
from core.varying.space import PARQUET, headings
from core.varying.tolerances import MACHINES, PERCENTILES, SHARE, AllWaves

# -- the command ``optimise`` -----------------------------------------------------------------------------------


PATIENCE = 2.0  # seconds between two lines that say how far it is


@frozen(kw_only=True)
class OptimiseArguments:
    """Which study, and where the best design goes."""

    study: Path = text_option("study file (.toml) with [[goals]]", "STUDY", type=Path)
    into: Path | None = text_option("write the best design", default=None, type=Path, metavar="FILE")
    json: bool = as_json()


def run_optimise(arguments: OptimiseArguments, painter: Painter | None) -> int:
    """The best design, or that which misses the limits least."""
    if arguments.into is not None and arguments.into.resolve() == arguments.study.resolve():
        raise KindynaError(f"--into {arguments.into}: is the study that is read; choose another file")
    asked = load_study(arguments.study)
    found = optimise(asked, _Progress().tell)
    said = remarks(asked, found)
    print(to_json(_data(found, said)) if arguments.json else _optimum_text(found, said), end="")
    if not found.is_feasible:
        against = f": {found.rejection}" if found.rejection else ""
        print(
            f"optimise: no design keeps the limits; above stands the one that misses them least{against}",
            file=sys.stderr,
        )
        return NOTHING_DONE
    if arguments.into is not None:
        save(found.design, arguments.into)
    study = studied(found.design)
    errors = [each for each in findings_of(study) if each.severity == ERROR]
    for each in errors:
        print(finding_line(each, study.angle_name), file=sys.stderr)
    return DONE_WITH_ERRORS if errors else DONE


class _Progress:
    """Says now and then where the search is, to a reader at a terminal."""

    def __init__(self) -> None:
        self._last = time.monotonic()

    def tell(self, fields: Mapping[str, Any], goal: float, start: int) -> None:
        now = time.monotonic()
        if now - self._last > PATIENCE and sys.stderr.isatty():
            self._last = now
            print(f"start {start}: {goal:.6g} ...", file=sys.stderr)


def _data(found: Optimum, said: Sequence[str]) -> dict[str, Any]:
    return {
        "answer": dict(found.answer),
        "goal": next(iter(found.goals.values())) if len(found.goals) == 1 else dict(found.goals),
        "before": next(iter(found.before.values())) if len(found.before) == 1 else dict(found.before),
        "kept": found.is_feasible,
        "better": found.is_better,
        "binding": [{"limit": each.limit, "per_percent": each.per_percent} for each in found.binding],
        "starts": found.starts,
        "agreeing": found.agreeing,
        "front": [dict(point) for point in found.front],
        "share": None if found.share is None else {"share": found.share.value, "low": found.share.interval[0]},
        "taken": dict(found.also_set),
        "against": found.rejection,
        "remarks": list(said),
    }


def _optimum_text(found: Optimum, said: Sequence[str]) -> str:
    heading = "the best design:" if found.is_better else "nothing better was found; the design as it is:"
    lines = [heading if found.is_feasible else "the design that misses the limits least:"]
    lines += [
        f"  {path} = {value if isinstance(value, str) else f'{value:.9g}'}" for path, value in found.answer.items()
    ]
    for key, value in found.goals.items():
        lines.append(f"{key} = {value:.7g}, before {found.before[key]:.7g}")
    lines += [
        f"held by {each.limit}: 1 % more of it changes the goal by {each.per_percent:.4g}" for each in found.binding
    ]
    if found.is_better:
        lines.append(f"{found.agreeing} of {found.starts} starts met there")
    lines += [f"goes into the design: {path} = {value:.9g}" for path, value in found.also_set.items()]
    if found.front:
        points = "point: --json lists it" if len(found.front) == 1 else "points: --json lists them"
        lines.append(f"front of {len(found.front)} {points}")
    if found.share is not None:
        lines.append(
            f"{found.share.value:.2%} of random machines keep the limits, {found.share.interval[0]:.2%} at least with 95 %"
        )
    if found.rejection:
        lines.append(f"a better one was refused: {found.rejection}")
    lines += said
    return "\n".join(lines) + "\n"


# -- the command ``tolerance`` ----------------------------------------------------------------------------------


SENSITIVITY, BANDS, SUMMARY = "sensitivity.csv", "bands.csv", "summary.json"


@frozen(kw_only=True)
class ToleranceArguments:
    """Whose tolerances, where the files go, and how many machines are drawn by chance."""

    file: Path = text_option("design file with [[tolerances]], or study file of one (.toml)", "DESIGN|STUDY", type=Path)
    out: Path = out_folder("folder for the three files", default=Path())
    machines: int = whole("Machines", 2, 1_000_000, default=MACHINES, help="drawn by chance")
    seed: int | None = option(
        whole("Seed", 0, 2**32 - 1, default=None), help="of chance", default_text="that of the study, else 0"
    )


def run_tolerance(arguments: ToleranceArguments, painter: Painter | None) -> int:
    """The three files, and the share of machines within the limits on the terminal."""
    study = _study(arguments.file)
    scatter = Scatter(study)
    seed = study.file.seed if arguments.seed is None else arguments.seed
    slopes, bands = scatter.slopes(), scatter.bands(arguments.machines, seed)
    values = scatter.values(arguments.machines, seed)
    if np.isnan(values).all():
        raise KindynaError(
            f"tolerances: none of {arguments.machines} machines can be built; see that the design itself can, with check"
        )
    share = Share(int(scatter.within_limits(values).sum()), arguments.machines)
    tighter = scatter.tightened(arguments.machines, seed, slopes) if share.value < SHARE else None
    low, high = share.interval
    data: dict[str, Any] = {
        "machines": share.machines, "seed": seed, "within": share.within, "share": share.value, "low": low, "high": high,
        "limits": [
            {"quantity": limit.quantity, "of": limit.of, "bound": bound, "share": _alone(scatter, values, limit.key, side, bound)}
            for limit, side, bound in scatter.bounds()
        ],
        "worst": [
            {"quantity": each.limit.quantity, "of": each.limit.of, "linear": each.linear, "value": each.value, "within": each.within,
             "at": dict(each.at)}
            for each in scatter.corners(slopes)
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
    """Of a study file, or of a design by itself."""
    text = read_text(path)
    return tolerance_study(loads(text, str(path))) if "format" in parsed(text, str(path)) else load_study(path)


def _alone(scatter: Scatter, values: np.ndarray, key: str, side: float, bound: float) -> float:
    """Share of machines that keep one bound."""
    return float((side * values[scatter.keys.index(key)] <= side * bound).mean())


def _sensitivity(scatter: Scatter, slopes: np.ndarray) -> str:
    """Field, quantity, change of the quantity per unit of the field, part of its variance; of each quantity the largest part first."""
    parts, fields = scatter.parts(slopes), list(scatter.nominal)
    lines = ["field,quantity,per_unit,part_of_tolerance"]
    for q, row in enumerate(scatter.study.quantities):
        for i in sorted(range(len(fields)), key=lambda i: -parts[i, q]):
            if np.isfinite(slopes[i, q]):
                lines.append(f"{fields[i]},{row.column},{float(slopes[i, q])!r},{float(parts[i, q])!r}")
    return "\n".join(lines) + "\n"


def _tolerance_text(data: dict[str, Any], share: Share) -> str:
    low, high = share.interval
    lines = [
        f"{share.within:,} of {share.machines:,} machines keep all limits: {share.value:.2%} ({low:.2%} ... {high:.2%} with 95 %)"
    ]
    for each in data["worst"]:
        value = "cannot be built" if each["value"] is None else f"{each['value']:.6g}"
        lines.append(
            f"  worst case of {each['quantity']}: {value}, {'within' if each['within'] else 'beyond'} its limit"
        )
    for name, each in _by_drive(data["waviness"]):
        lines += _of_waves(name, each)
    if data["tighten"] is not None:
        sets = ", ".join(f"{path} / {2**times}" for path, times in data["tighten"]["halve"].items())
        lines.append(f"  tighten {sets}: {data['tighten']['share']:.2%} (cost {data['tighten']['cost']:g})")
    elif share.value < SHARE:
        lines.append(f"  no tolerances that are halved twice at most bring {SHARE:.2%} of machines within the limits")
    return "\n".join(lines)


def _summary(waves: AllWaves) -> dict[str, Any] | None:
    """What waves do; on a shaft of several drives by the name of each that has any."""
    if waves.design.listed:
        names = drive_names(waves.design)
        return {names[number or 0]: each.summary() for number, each in waves.by_drive.items()} or None
    return waves.by_drive[None].summary() if waves.by_drive else None


def _by_drive(found: dict[str, Any] | None) -> list[tuple[str, dict[str, float]]]:
    """The inverse; the name is empty where there is but one."""
    if found is None:
        return []
    return [("", found)] if "lift_error_mm" in found else [(f" of {name}", each) for name, each in found.items()]


def _of_waves(name: str, found: dict[str, float]) -> list[str]:
    lines = [f"  waves{name}: {found['lift_error_mm']:.4g} mm at the follower, {found['acceleration_mm_s2']:.5g} mm/s²"]
    if "contact_force_n" in found:
        least = found.get("least_contact_force_n")
        left = "" if least is None else "; the follower leaves the cam" if least < 0.0 else f"; {least:.5g} N are left"
        lines.append(f"    they ask {found['contact_force_n']:.5g} N of contact force{left}")
    if "amplified" in found:
        lines.append(
            f"    the elastic follower vibrates {found['amplified']:.4g} times as far at {found['amplified_lobes']} lobes (its own "
            f"frequency: {found['natural_lobes']:.4g}), {found['elastic_contact_force_n']:.5g} N"
        )
    return lines


# -- the command ``vary`` ---------------------------------------------------------------------------------------


MOST_WORKERS = 256


@frozen(kw_only=True)
class VaryArguments:
    """Which study, where its table goes, and who computes."""

    study: Path = text_option("study file (.toml)", "STUDY", type=Path)
    out: Path = text_option(
        "the table: a row for each design", type=ending_with("a table", ".csv", PARQUET), metavar="TABLE.csv|.parquet"
    )
    resume: bool = flag("Resume", help="go on where an earlier run of the same study was stopped")
    workers: int = whole("Processes", 1, MOST_WORKERS, default=1, help="processes that compute")
    scheduler: str = option(
        text_option("", default=""),
        help="compute on the Dask cluster of this scheduler (extra cluster)",
        metavar="ADDRESS",
    )
    json: bool = as_json()


def run_vary(arguments: VaryArguments, painter: Painter | None) -> int:
    """The table as a file, how many designs it holds and why some have no values on the terminal."""
    study = load_study(arguments.study)
    made = Run(study)
    progress = Progress()
    with workers(arguments.workers, arguments.scheduler) as (executor, ahead):
        made.compute(resume=arguments.resume, executor=executor, ahead=ahead, progress=progress.tell)
    reasons: Counter[str] = Counter()
    built = 0
    for block in made.blocks():
        built += int((~np.isnan(block.value).any(axis=0)).sum())
        reasons.update(block.reason[block.reason != ""].tolist())
    if not built:
        raise KindynaError(none_built_text(made.count, *reasons.most_common(1)[0]))
    write_table(made, arguments.out)
    if arguments.json:
        data = {
            "designs": made.count,
            "built": built,
            "reasons": dict(reasons.most_common()),
            "columns": headings(made),
        }
        print(to_json(data), end="")
    else:
        print(f"{made.count:,} designs, {built:,} of them with values; {arguments.out}")
        for code, count in reasons.most_common():
            print(f"  {code}: {count:,}")
    return DONE


class Progress:
    """Says now and then how many designs are done, how many a second, and how long the rest takes: at a terminal often, in a log
    seldom."""

    OFTEN, SELDOM = 2.0, 60.0  # seconds between two lines

    def __init__(self) -> None:
        self._start = self._last = time.monotonic()
        self._first: int | None = None

    def tell(self, done: int, count: int) -> None:
        """As ``Run.compute`` calls it."""
        now = time.monotonic()
        self._first = done if self._first is None else self._first
        pause = self.OFTEN if sys.stderr.isatty() else self.SELDOM
        if now - self._last < pause or done == self._first:
            return
        self._last = now
        rate = (done - self._first) / (now - self._start)
        print(
            f"{done:,} of {count:,} designs, {rate:,.0f} a second, {duration((count - done) / rate)} left",
            file=sys.stderr,
        )
