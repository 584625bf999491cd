"""Which channels of a design can be drawn, and sentences why others cannot."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from core.errors import KindynaError
from core.output.channels import Channel, channels, existing
from core.study import STAGES, Study, quantity
from kindyna_gui.labels import reason
from kindyna_gui.pictures.plots.curves import different


def rows_of(study: Study, quantities: Iterable[str]) -> list[Channel]:
    """The channels of these quantities that this kind of design can have, in the given order."""
    there = {row.quantity: row for row in channels(study.design)}
    return [there[name] for name in quantities if name in there]


def stages_of(quantities: Iterable[str]) -> tuple[str, ...]:
    """The stages that these quantities need, each once, in the order of a study."""
    wanted = {quantity(name).stage for name in quantities}
    return tuple(stage for stage in STAGES if stage in wanted)


def split(study: Study, rows: Sequence[Channel]) -> tuple[list[Channel], list[str]]:
    """Those rows that can be drawn, without any that equals one before it; and a line for each that is left out, but for
    what only stands beside another for comparison.

    Raises NoAnswer where a stage that all of them need has none.
    """
    there = existing(study, rows)
    drawn = different(study, there)
    reasons = [why_missing(study, row) for row in rows if row not in there and not row.beside]
    reasons += [f"{row.label} is the same curve" for row in there if row not in drawn and not row.beside]
    return drawn, reasons


def why_missing(study: Study, row: Channel) -> str:
    """Why this design has no such channel."""
    try:
        row.values(study)
    except KindynaError as error:
        return f"No {row.label[:1].lower()}{row.label[1:]}: {reason(study.design, error)}"
    return f"No {row.label[:1].lower()}{row.label[1:]} exists here"
