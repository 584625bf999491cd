"""The command ``optimise``: the best design of a study within its limits."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from core.commands import DONE, DONE_WITH_ERRORS, NOTHING_DONE, Painter
from core.commands.common import as_json, studied
from core.errors import KindynaError
from core.findings import ERROR
from core.frozen import frozen
from core.output.lines import finding_line
from core.output.summary import to_json
from core.project import save
from core.requests import typed
from core.study import findings_of
from core.varying import Optimum, load_study, optimise, remarks

PATIENCE = 2.0  # seconds between two lines that say how far it is


@frozen(kw_only=True)
class Arguments:
    """Which study, and where the best design goes."""

    study: Path = typed("study file (.toml) with [[goals]]", "STUDY", type=Path)
    into: Path | None = typed("write the best design", default=None, type=Path, metavar="FILE")
    json: bool = as_json()


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The best design, or that which misses the limits least."""
    if arguments.into is not None and arguments.into.resolve() == arguments.study.resolve():
        raise KindynaError(f"--into {arguments.into}: is the study that is read; choose another file")
    asked = load_study(arguments.study)
    found = optimise(asked, _Progress().tell)
    said = remarks(asked, found)
    print(to_json(_data(found, said)) if arguments.json else _text(found, said), end="")
    if not found.kept:
        against = f": {found.against}" if found.against else ""
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
        "kept": found.kept,
        "better": found.better,
        "binding": [{"limit": each.limit, "per_percent": each.per_percent} for each in found.binding],
        "starts": found.starts,
        "agreeing": found.agreeing,
        "front": [dict(point) for point in found.front],
        "share": None if found.share is None else {"share": found.share.value, "low": found.share.interval[0]},
        "taken": dict(found.taken),
        "against": found.against,
        "remarks": list(said),
    }


def _text(found: Optimum, said: Sequence[str]) -> str:
    heading = "the best design:" if found.better else "nothing better was found; the design as it is:"
    lines = [heading if found.kept else "the design that misses the limits least:"]
    lines += [
        f"  {path} = {value if isinstance(value, str) else f'{value:.9g}'}" for path, value in found.answer.items()
    ]
    for key, value in found.goals.items():
        lines.append(f"{key} = {value:.7g}, before {found.before[key]:.7g}")
    lines += [
        f"held by {each.limit}: 1 % more of it changes the goal by {each.per_percent:.4g}" for each in found.binding
    ]
    if found.better:
        lines.append(f"{found.agreeing} of {found.starts} starts met there")
    lines += [f"goes into the design: {path} = {value:.9g}" for path, value in found.taken.items()]
    if found.front:
        points = "point: --json lists it" if len(found.front) == 1 else "points: --json lists them"
        lines.append(f"front of {len(found.front)} {points}")
    if found.share is not None:
        lines.append(
            f"{found.share.value:.2%} of random machines keep the limits, {found.share.interval[0]:.2%} at least with 95 %"
        )
    if found.against:
        lines.append(f"a better one was refused: {found.against}")
    lines += said
    return "\n".join(lines) + "\n"
