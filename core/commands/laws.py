"""The command ``laws``: the table of laws with their peak coefficients, and what each costs in a design."""

from __future__ import annotations

from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import as_json, drive_name, sorted_by
from core.errors import KindynaError
from core.frozen import frozen
from core.laws import LAWS, Peaks, peaks
from core.output.lines import columns, digits
from core.output.summary import to_json
from core.requests import typed


@frozen(kw_only=True)
class Arguments:
    """The table alone, or the design that the laws are ranked in."""

    design: Path | None = typed(
        "rank the laws by what each costs in this design at its speed: torque, wind-up, residual vibration, contact",
        "DESIGN",
        default=None,
        nargs="?",
        type=Path,
    )
    drive: str = drive_name()
    segment: tuple[int, ...] = typed(
        "the segment that takes the law, counted from 1; may be repeated",
        default=(),
        usual="all that move",
        action="append",
        type=int,
        metavar="N",
    )
    by: str = sorted_by()
    json: bool = as_json("print JSON; infinite = null")


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The table of laws with their peak coefficients, or ranked in a design."""
    if arguments.design is not None:
        _rank(arguments.design, arguments)
    elif arguments.segment or arguments.by or arguments.drive:
        raise KindynaError("--segment, --by, --drive: laws are ranked in a design; name its file")
    elif arguments.json:
        print(to_json([{"law": slug, **_coefficients(peaks(law))} for slug, law in LAWS.items()]), end="")
    else:
        print(_text(), end="")
    return DONE


def _rank(path: Path, arguments: Arguments) -> None:
    """Print what each law costs in the design. Raises KindynaError."""
    from core.commands.ranked import data_of, rows_of, text_of
    from core.design import only
    from core.find import law_candidates, moving_segments
    from core.project import load, number_of

    whole = load(path)
    design = only(whole, number_of(whole, arguments.drive))
    numbers = [number - 1 for number in arguments.segment] or moving_segments(design)
    moving = moving_segments(design)
    if not moving:
        raise KindynaError("laws: no segment of this design's motion moves; give it one with a rise")
    for number in numbers:
        if number not in moving:
            allowed = " | ".join(str(i + 1) for i in moving)
            raise KindynaError(f"--segment {number + 1}: none that moves; allowed: {allowed}")
    figures, rows = rows_of(design, law_candidates(design, numbers), arguments.by)
    if arguments.json:
        print(
            to_json(
                [{"law": row.name, **_coefficients(peaks(LAWS[row.name])), **data_of(figures, row)} for row in rows]
            ),
            end="",
        )
    else:
        print(text_of("law", figures, rows), end="")


def _coefficients(peak: Peaks) -> dict[str, float]:
    """For unit rise and span."""
    return {"cv": peak.cv, "ca": peak.ca, "cj": peak.cj, "cm": peak.cm}


def _text() -> str:
    rows: list[tuple[str, ...]] = [("law", "velocity", "acceleration", "jerk", "torque", "")]
    for slug, law in LAWS.items():
        peak = peaks(law)
        numbers = [digits(value) for value in _coefficients(peak).values()]
        rows.append((slug, *numbers, "acceleration jumps at an end" if peak.jumps_at_an_end else ""))
    return "\n".join(columns(rows)) + "\n"
