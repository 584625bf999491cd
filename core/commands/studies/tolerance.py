"""The command ``tolerance``: what the tolerances of a design do to its quantities, and how many machines keep the limits."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from core.commands import DONE, Painter
from core.commands.common import out_folder
from core.design import drive_names
from core.design.fields import whole
from core.errors import KindynaError
from core.frozen import frozen
from core.motion import degrees
from core.output.export import csv
from core.output.summary import to_json
from core.project import loads, parsed
from core.project.files import read_text, write_into
from core.requests import asked, typed
from core.varying import Scatter, Share, StudyOfMany, load_study, tolerance_study
from core.varying.tolerances import MACHINES, PERCENTILES, SHARE
from core.varying.waves import AllWaves

SENSITIVITY, BANDS, SUMMARY = "sensitivity.csv", "bands.csv", "summary.json"


@frozen(kw_only=True)
class Arguments:
    """Whose tolerances, where the files go, and how many machines are drawn by chance."""

    file: Path = typed("design file with [[tolerances]], or study file of one (.toml)", "DESIGN|STUDY", type=Path)
    out: Path = out_folder("folder for the three files", default=Path())
    machines: int = whole("Machines", 2, 1_000_000, default=MACHINES, help="drawn by chance")
    seed: int | None = asked(
        whole("Seed", 0, 2**32 - 1, default=None), help="of chance", usual="that of the study, else 0"
    )


def run(arguments: Arguments, painter: Painter | None) -> int:
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
    share = Share(int(scatter.kept(values).sum()), arguments.machines)
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
    print(_text(data, share))
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
    parts, fields = scatter.parts(slopes), list(scatter.own)
    lines = ["field,quantity,per_unit,part_of_tolerance"]
    for q, row in enumerate(scatter.study.asked):
        for i in sorted(range(len(fields)), key=lambda i: -parts[i, q]):
            if np.isfinite(slopes[i, q]):
                lines.append(f"{fields[i]},{row.column},{float(slopes[i, q])!r},{float(parts[i, q])!r}")
    return "\n".join(lines) + "\n"


def _text(data: dict[str, Any], share: Share) -> str:
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
        return {names[number or 0]: each.summary() for number, each in waves.each.items()} or None
    return waves.each[None].summary() if waves.each else None


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
